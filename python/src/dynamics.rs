//! The kernels of a gait over batches of states.

use crate::bytes::{bytes, doubles, rows};
use crate::error::Error;
use crate::robot::Gait;
use piaffe::export::table::coordinates;
use piaffe::interpreter::Interpreted;
use piaffe::model::shape::Block;
use piaffe::model::{Description, Gait as _, Mode};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::sync::Arc;

/// What a kernel gives for every state: the doubles of each block, block by block.
type Blocks<'py> = Vec<Bound<'py, PyBytes>>;

/// Evaluates a kernel at every row of its inputs.
fn batch<'py, const N: usize>(
    py: Python<'py>,
    inputs: [(&str, &[u8], usize); N],
    blocks: &[Block],
    length: usize,
    kernel: impl Fn([&[f64]; N], &mut [f64]) + Sync,
) -> PyResult<Blocks<'py>> {
    let numbers = inputs.map(|(_, bytes, _)| doubles(bytes));
    let columns: [_; N] = std::array::from_fn(|k| (inputs[k].0, &numbers[k][..], inputs[k].2));
    let count = rows(columns)?;
    let found = py.detach(|| {
        let mut out = vec![0.0; length];
        let mut found: Vec<Vec<f64>> = blocks.iter().map(|block| Vec::with_capacity(count * block.len())).collect();
        for row in 0..count {
            kernel(columns.map(|(_, numbers, width)| &numbers[row * width..][..width]), &mut out);
            for (block, found) in blocks.iter().zip(&mut found) {
                found.extend_from_slice(block.of(&out));
            }
        }
        found
    });
    Ok(found.iter().map(|numbers| bytes(py, numbers)).collect())
}

/// What stands: virtual leg 1 or 2, or in flight nothing.
fn mode(d: &Description, stance: Option<usize>) -> PyResult<Mode> {
    let mode = match stance {
        None => Mode::Flight,
        Some(leg @ (1 | 2)) => Mode::Stance(leg - 1),
        Some(leg) => return Err(Error::new_err(format!("`stance` is {leg}: give 1 or 2, or None in flight"))),
    };
    let has = mode != Mode::Flight || d.has(mode);
    has.then_some(mode).ok_or_else(|| Error::new_err(format!("the {} has no flight: `stance` must be 1 or 2", d.gait)))
}

/// A vector or matrix that is all that a kernel gives.
fn whole(rows: usize, columns: usize) -> ([Block; 1], usize) {
    ([Block::new(0, rows, columns)], rows * columns)
}

/// An index of the legs from 0.
fn leg(leg: usize) -> PyResult<usize> {
    matches!(leg, 1 | 2).then(|| leg - 1).ok_or_else(|| Error::new_err(format!("`leg` is {leg}: give 1 or 2")))
}

/// The kernels of a gait. Every one gives a list of blocks.
#[pyclass(frozen, module = "piaffe")]
pub struct Kernels(Arc<Interpreted>);

#[pymethods]
impl Kernels {
    #[new]
    fn new(gait: &Gait) -> Kernels {
        Kernels(gait.derived())
    }

    /// Names of p and of q, which of q no actuator drives, and names of the joints.
    fn names(&self) -> (Vec<&'static str>, Vec<String>, usize, Vec<&'static str>) {
        let d = self.0.description();
        let joints = d.joints.iter().map(|joint| joint.name).collect();
        (["x", "y", "z"][..d.positions()].to_vec(), coordinates(d), d.unactuated, joints)
    }

    fn inertia<'py>(&self, py: Python<'py>, q: &[u8]) -> PyResult<Blocks<'py>> {
        let gait = &self.0;
        let d = gait.description();
        let n = d.positions() + d.orientations();
        let (blocks, length) = whole(n, n);
        batch(py, [("q", q, d.orientations())], &blocks, length, |[q], out| gait.inertia(q, out))
    }

    fn bias<'py>(&self, py: Python<'py>, q: &[u8], qd: &[u8]) -> PyResult<Blocks<'py>> {
        let gait = &self.0;
        let d = gait.description();
        let (blocks, length) = whole(d.positions() + d.orientations(), 1);
        let inputs = [("q", q, d.orientations()), ("qd", qd, d.orientations())];
        batch(py, inputs, &blocks, length, |[q, qd], out| gait.bias(q, qd, out))
    }

    fn energy<'py>(&self, py: Python<'py>, x: &[u8], xd: &[u8]) -> PyResult<Blocks<'py>> {
        let gait = &self.0;
        let d = gait.description();
        let (n, shape) = (d.positions() + d.orientations(), d.shapes.energy);
        let blocks = [shape.kinetic, shape.potential];
        batch(py, [("x", x, n), ("xd", xd, n)], &blocks, shape.len, |[x, xd], out| gait.energy(x, xd, out))
    }

    fn centre_of_mass<'py>(&self, py: Python<'py>, x: &[u8], xd: &[u8]) -> PyResult<Blocks<'py>> {
        let gait = &self.0;
        let d = gait.description();
        let (n, shape) = (d.positions() + d.orientations(), d.shapes.centre_of_mass);
        let blocks = [shape.position, shape.velocity];
        batch(py, [("x", x, n), ("xd", xd, n)], &blocks, shape.len, |[x, xd], out| gait.centre_of_mass(x, xd, out))
    }

    fn foot<'py>(&self, py: Python<'py>, leg: usize, x: &[u8]) -> PyResult<Blocks<'py>> {
        let (gait, leg) = (&self.0, self::leg(leg)?);
        let d = gait.description();
        let (blocks, length) = whole(d.positions(), 1);
        let n = d.positions() + d.orientations();
        batch(py, [("x", x, n)], &blocks, length, |[x], out| gait.foot(leg, x, out))
    }

    fn foot_jacobian<'py>(&self, py: Python<'py>, leg: usize, q: &[u8]) -> PyResult<Blocks<'py>> {
        let (gait, leg) = (&self.0, self::leg(leg)?);
        let d = gait.description();
        let (blocks, length) = whole(d.positions() + d.orientations(), d.positions());
        batch(py, [("q", q, d.orientations())], &blocks, length, |[q], out| gait.foot_jacobian(leg, q, out))
    }

    /// Ẍ, Γ (what moves the robot, without friction), F.
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        stance: Option<usize>,
        q: &[u8],
        qd: &[u8],
        actuated_dd: &[u8],
    ) -> PyResult<Blocks<'py>> {
        let gait = &self.0;
        let d = gait.description();
        let (mode, n) = (mode(d, stance)?, d.orientations());
        let shape = d.shape(mode).inverse;
        let inputs = [("q", q, n), ("qd", qd, n), ("actuated_dd", actuated_dd, d.prescribed())];
        let blocks = [shape.xdd, shape.gamma, shape.f];
        batch(py, inputs, &blocks, shape.len, |[q, qd, qdd], out| gait.inverse(mode, q, qd, qdd, out))
    }

    /// ∂Γ/∂w, ∂F/∂w, ∂balance/∂w.
    fn inverse_jacobian<'py>(
        &self,
        py: Python<'py>,
        stance: Option<usize>,
        q: &[u8],
        qd: &[u8],
        actuated_dd: &[u8],
    ) -> PyResult<Blocks<'py>> {
        let gait = &self.0;
        let d = gait.description();
        let (mode, n) = (mode(d, stance)?, d.orientations());
        let shape = d.shape(mode).inverse_jacobian;
        let inputs = [("q", q, n), ("qd", qd, n), ("actuated_dd", actuated_dd, d.prescribed())];
        let blocks = [shape.gamma_w, shape.f_w, shape.balance_w];
        batch(py, inputs, &blocks, shape.len, |[q, qd, qdd], out| gait.inverse_jacobian(mode, q, qd, qdd, out))
    }
}
