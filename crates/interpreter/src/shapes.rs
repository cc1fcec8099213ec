//! Where everything stands among the kernels' numbers.

use piaffe_codegen::dynamics::{Block, Kernel};
use piaffe_model::shape;
use std::collections::BTreeMap;

/// Blocks by the names under which the runtime's shapes ask for them: `curvature.gradient`, `curvature.n.torque`.
#[derive(Default)]
pub struct Shapes(BTreeMap<String, shape::Block>);

impl Shapes {
    /// Of kernels that give several things or take weights of several kinds, as a build has them. Twins have the same.
    pub fn new(kernels: &[Kernel]) -> Shapes {
        let mut shapes = Shapes::default();
        for kernel in kernels {
            let path = base_name(&kernel.name).0;
            let outputs: Vec<Block> = kernel.outputs.iter().map(|o| Block { name: o.name, shape: o.shape }).collect();
            if outputs.len() > 1 || kernel.inputs.iter().any(|input| !input.blocks.is_empty()) {
                shapes.insert(path, &outputs);
            }
            kernel.inputs.iter().for_each(|input| shapes.insert(&format!("{path}.{}", input.name), &input.blocks));
        }
        shapes
    }

    fn insert(&mut self, path: &str, blocks: &[Block]) {
        let mut at = 0;
        for block in blocks {
            let (rows, columns) = block.shape.size();
            self.0.insert(format!("{path}.{}", block.name), shape::Block::new(at, rows, columns));
            at += block.count();
        }
    }

    /// Nothing where the gait has no such block.
    pub fn block(&self, name: &str) -> shape::Block {
        self.0.get(name).copied().unwrap_or(shape::Block::NONE)
    }
}

/// `inverse_jacobian2` → (`inverse_jacobian`, Some(1)): kernels of a leg end in the leg's number.
pub fn base_name(name: &str) -> (&str, Option<usize>) {
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    (base, name[base.len()..].parse::<usize>().ok().and_then(|number| number.checked_sub(1)))
}
