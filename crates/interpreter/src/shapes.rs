//! Where everything stands among the kernels' numbers.

use piaffe_codegen::dynamics::{Block, Kernel};
use piaffe_codegen::mechanism::Mode;
use piaffe_model::shape;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Blocks by the names under which the runtime's shapes ask for them: `curvature.gradient`, `curvature.n.torque`.
#[derive(Default, Serialize, Deserialize)]
pub struct Shapes(BTreeMap<String, Place>);

/// Where a block begins, its rows and its columns.
type Place = [usize; 3];

impl Shapes {
    /// Of kernels that give several things or take weights of several kinds, as a build has them. Twins have the same.
    pub fn new(kernels: &[Kernel]) -> Shapes {
        let mut shapes = Shapes::default();
        for kernel in kernels {
            let path = match kernel.mode() {
                Some(Mode::Stance(_)) => format!("stance.{}", kernel.what),
                Some(Mode::Flight) => format!("flight.{}", kernel.what),
                None => kernel.what.clone(),
            };
            let outputs: Vec<Block> = kernel.outputs.iter().map(|o| Block { name: o.name, shape: o.shape }).collect();
            if kernel.has_shape() {
                shapes.insert(&path, &outputs);
            }
            kernel.inputs.iter().for_each(|input| shapes.insert(&format!("{path}.{}", input.name), &input.blocks));
        }
        shapes
    }

    fn insert(&mut self, path: &str, blocks: &[Block]) {
        let mut at = 0;
        for block in blocks {
            let (rows, columns) = block.shape.size();
            let place = self.0.entry(format!("{path}.{}", block.name)).or_default();
            // Of twins the longer one counts: what is known early can be more for one leg than for the other.
            if place[1] * place[2] <= rows * columns {
                *place = [at, rows, columns];
            }
            at += block.count();
        }
    }

    /// Nothing where the gait has no such block.
    pub fn block(&self, name: &str) -> shape::Block {
        self.0.get(name).map_or(shape::Block::NONE, |[at, rows, columns]| shape::Block::new(*at, *rows, *columns))
    }
}
