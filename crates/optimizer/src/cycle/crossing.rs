//! How a phase ends: a foot lands or leaves, and what of the next one's beginning follows.

use piaffe_model::shape::{Block, Shapes};
use piaffe_model::{Description, FORWARD, Gait, Transition, UP};

/// The transition of the last simulated motion, and its derivatives of the last linearization.
pub struct Crossing {
    pub transition: Transition,
    shapes: &'static Shapes,
    /// Of the kernel.
    results: Vec<f64>,
    /// What an impact gives beside q̇⁺, in the order of the weights of its curvature's kernel.
    pub outputs: Vec<f64>,
    /// Velocity of the mass centre before a landing, m/s, and its gradients in Θ.
    centre: [f64; 2],
    centre_by_theta: [Vec<f64>; 2],
}

impl Crossing {
    /// After phase `k` of a gait with `n` variables.
    pub fn new(d: &Description, k: usize, n: usize) -> Crossing {
        let (transition, shapes) = (d.transition(k), d.shapes);
        let (results, outputs) = match transition {
            Transition::Touchdown(_) => (shapes.touchdown.zeros(), shapes.touchdown_curvature.outputs.zeros()),
            Transition::Landing(_) => (shapes.landing.zeros(), shapes.landing_curvature.outputs.zeros()),
            Transition::TakeOff(_) => (shapes.takeoff.zeros(), Vec::new()),
        };
        let flies = matches!(transition, Transition::Landing(_));
        let gradient = || if flies { vec![0.0; n] } else { Vec::new() };
        Crossing { transition, shapes, results, outputs, centre: [0.0; 2], centre_by_theta: [gradient(), gradient()] }
    }

    /// From the wanted end of the phase; `centre` is the mass centre's velocity, if that is not known by the state, m/s.
    pub fn evaluate(&mut self, gait: &dyn Gait, q: &[f64], qd: &[f64], centre: [f64; 2], still: &[f64]) {
        self.centre = centre;
        match self.transition {
            Transition::Touchdown(leg) => gait.touchdown(leg, q, qd, &mut self.results),
            Transition::Landing(leg) => gait.landing(leg, q, &centre, qd, &mut self.results),
            Transition::TakeOff(leg) => gait.takeoff(leg, q, qd, still, &mut self.results),
        }
        for [to, from, _] in self.of_impact() {
            to.of_mut(&mut self.outputs).copy_from_slice(from.of(&self.results));
        }
    }

    /// q̇⁺ after an impact, before the legs exchange names; none after a take-off, which changes no velocity.
    pub fn qd_plus(&self) -> Option<&[f64]> {
        match self.transition {
            Transition::Touchdown(_) => Some(self.shapes.touchdown.qd_plus.of(&self.results)),
            Transition::Landing(_) => Some(self.shapes.landing.qd_plus.of(&self.results)),
            Transition::TakeOff(_) => None,
        }
    }

    /// ∂/∂w of an entry of q̇⁺: w is what the impact is a function of, (q, q̇⁻) or (q, v⁻, q̇⁻).
    pub fn qd_plus_row(&self, k: usize) -> &[f64] {
        match self.transition {
            Transition::Landing(_) => self.shapes.landing.qd_plus_w.row(&self.results, k),
            _ => self.shapes.touchdown.qd_plus_w.row(&self.results, k),
        }
    }

    /// ∂/∂w of an entry of `outputs`.
    pub fn output_row(&self, i: usize) -> &[f64] {
        let found = self.of_impact().into_iter().find(|[to, ..]| to.range().contains(&i));
        let [to, _, rows] = found.unwrap_or([Block::NONE; 3]);
        rows.row(&self.results, i - to.range().start)
    }

    /// Where in `outputs` something of an impact stands, where in `results`, and where its gradients do there.
    fn of_impact(&self) -> [[Block; 3]; 5] {
        match self.transition {
            Transition::Touchdown(_) => {
                let (to, from) = (&self.shapes.touchdown_curvature.outputs, &self.shapes.touchdown);
                [
                    [to.impulse, from.impulse, from.impulse_w],
                    [to.leaving, from.leaving, from.leaving_w],
                    [to.landing, from.landing, from.landing_w],
                    [to.couple, from.couple, from.couple_w],
                    [to.pitch, from.pitch, from.pitch_w],
                ]
            }
            Transition::Landing(_) => {
                let (to, from) = (&self.shapes.landing_curvature.outputs, &self.shapes.landing);
                let none = [Block::NONE; 3];
                [
                    [to.impulse, from.impulse, from.impulse_w],
                    [to.landing, from.landing, from.landing_w],
                    none,
                    none,
                    none,
                ]
            }
            Transition::TakeOff(_) => [[Block::NONE; 3]; 5],
        }
    }

    /// Height of the mass centre over the ground at a take-off, m, and its velocity, m/s.
    pub fn parabola(&self) -> (f64, [f64; 2]) {
        let shape = &self.shapes.takeoff;
        let (r, v) = (shape.r.of(&self.results), shape.v.of(&self.results));
        (r[UP], [v[FORWARD], v[UP]])
    }

    /// ∂(height)/∂q of [`Crossing::parabola`].
    pub fn height_gradient(&self) -> &[f64] {
        self.shapes.takeoff.r_q.row(&self.results, UP)
    }

    /// ∂(a component of the velocity)/∂(q, q̇) of [`Crossing::parabola`].
    pub fn velocity_gradient(&self, component: usize) -> &[f64] {
        self.shapes.takeoff.v_w.row(&self.results, component)
    }

    /// Of a landing: what the mass centre's velocity before it is as a function of Θ.
    pub fn set_centre_gradient(&mut self, component: usize, write: impl FnOnce(&mut [f64])) {
        write(&mut self.centre_by_theta[component]);
    }

    /// Adds `scale` times the gradient in Θ of something with the gradient `by` in w. `place` tells which variable is which entry of
    /// (q, q̇).
    pub fn add_gradient(&self, by: &[f64], scale: f64, place: impl Fn(usize) -> usize, row: &mut [f64]) {
        let (nq, components) = ((by.len() - self.components()) / 2, self.components());
        let (by_q, rest) = by.split_at(nq);
        let (by_centre, by_qd) = rest.split_at(components);
        for (k, by) in by_q.iter().chain(by_qd).enumerate() {
            row[place(k)] += scale * by;
        }
        for (by, gradient) in by_centre.iter().zip(&self.centre_by_theta) {
            row.iter_mut().zip(gradient).for_each(|(slot, x)| *slot += scale * by * x);
        }
    }

    /// Adds a symmetric matrix of second derivatives in w as one in Θ; `line` is room for a gradient in Θ.
    pub fn add_matrix(&self, matrix: &[f64], place: impl Fn(usize) -> usize, line: &mut [f64], out: &mut [f64]) {
        let (size, n) = (matrix.len().isqrt(), line.len());
        let (nq, components) = ((size - self.components()) / 2, self.components());
        for (i, row) in matrix.chunks(size).enumerate() {
            line.fill(0.0);
            self.add_gradient(row, 1.0, &place, line);
            let mut add = |variable: usize, by: f64| {
                out[variable * n..][..n].iter_mut().zip(&*line).for_each(|(slot, x)| *slot += by * x);
            };
            match i.checked_sub(nq) {
                None => add(place(i), 1.0),
                Some(component) if component < components => {
                    let gradient = self.centre_by_theta[component].iter().enumerate();
                    gradient.filter(|(_, by)| **by != 0.0).for_each(|(variable, by)| add(variable, *by));
                }
                Some(_) => add(place(i - components), 1.0),
            }
        }
    }

    /// Entries of w between q and q̇: the mass centre's velocity, where the state does not tell it.
    pub fn components(&self) -> usize {
        match self.transition {
            Transition::Landing(_) => 2,
            _ => 0,
        }
    }

    /// Second derivatives (q·q, q·(others of w), q·q̇⁺) of an impact's weighted results.
    pub fn curvature<'k>(
        &self,
        gait: &dyn Gait,
        q: &[f64],
        qd: &[f64],
        xi: &[f64],
        outputs: &[f64],
        kernel: &'k mut [f64],
    ) -> [&'k [f64]; 3] {
        let (touchdown, landing) = (&self.shapes.touchdown_curvature, &self.shapes.landing_curvature);
        let blocks = match self.transition {
            Transition::Touchdown(leg) => {
                gait.touchdown_curvature(leg, q, qd, xi, outputs, kernel);
                [touchdown.q_q, touchdown.q_qd, touchdown.q_plus]
            }
            Transition::Landing(leg) => {
                gait.landing_curvature(leg, q, &self.centre, qd, xi, outputs, kernel);
                [landing.q_q, landing.q_v, landing.q_plus]
            }
            Transition::TakeOff(_) => [Block::NONE; 3],
        };
        blocks.map(|block| block.of(kernel))
    }

    /// ∂/∂v⁻ of q̇⁺ and the outputs of a landing, weighted.
    pub fn by_centre(&self, xi: &[f64], outputs: &[f64]) -> [f64; 2] {
        [0, 1].map(|component| {
            let at = xi.len() + component;
            let of_rates: f64 = xi.iter().enumerate().map(|(k, weight)| weight * self.qd_plus_row(k)[at]).sum();
            let of_outputs: f64 = outputs.iter().enumerate().map(|(i, weight)| weight * self.output_row(i)[at]).sum();
            of_rates + of_outputs
        })
    }
}
