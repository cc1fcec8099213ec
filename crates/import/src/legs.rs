//! The chains of bodies that hang on the root: the legs, each with its foot.

use super::ImportError;
use super::tree::Tree;
use nalgebra::Vector3;

/// A chain of bodies from the platform to a foot.
pub struct Leg {
    pub name: String,
    /// Indices into the tree's bodies.
    pub chain: Vec<usize>,
    /// In the specification's axes from the root's origin, all joints at zero, m.
    pub foot: Vector3<f64>,
    pub foot_link: String,
}

/// Names by which feet go.
const FEET: [&str; 5] = ["foot", "toe", "tip", "contact", "sole"];

pub fn find(tree: &Tree) -> Result<Vec<Leg>, ImportError> {
    let below =
        |b: usize| -> Vec<usize> { (0..tree.bodies.len()).filter(|k| tree.bodies[*k].parent == Some(b)).collect() };
    let mut legs: Vec<Leg> = Vec::new();
    for first in below(0) {
        let mut chain = vec![first];
        let mut last = first;
        loop {
            match below(last)[..] {
                [] => break,
                [next] => {
                    chain.push(next);
                    last = next;
                }
                ref several => {
                    let joints: Vec<_> = several.iter().map(|b| joint_name(tree, *b)).collect();
                    return Err(ImportError::Branch {
                        link: tree.bodies[last].name.clone(),
                        joints: joints.join(", "),
                    });
                }
            }
        }
        if let Some(massless) = chain.iter().find(|b| tree.bodies[**b].rigid.mass <= 0.0) {
            return Err(ImportError::Massless(tree.bodies[*massless].name.clone()));
        }
        let (foot_link, foot) = foot(tree, last)?;
        let name = name(tree, &chain, &foot_link);
        let name = if legs.iter().any(|l| l.name == name) { identifier(&foot_link) } else { name };
        legs.push(Leg { name, chain, foot, foot_link });
    }
    if legs.len() < 2 {
        return Err(ImportError::TooFewLegs(legs.len()));
    }
    Ok(legs)
}

fn joint_name(tree: &Tree, body: usize) -> String {
    tree.bodies[body].joint.as_ref().map(|j| j.name.clone()).unwrap_or_default()
}

/// The link at the end of the chain that goes by a foot's name, or else the lowest one.
fn foot(tree: &Tree, body: usize) -> Result<(String, Vector3<f64>), ImportError> {
    let carried = &tree.bodies[body].carried;
    let called = |name: &str| FEET.iter().any(|f| name.to_lowercase().contains(f));
    let lowest = |feet: Vec<&(String, Vector3<f64>)>| feet.into_iter().min_by(|a, b| a.1.y.total_cmp(&b.1.y)).cloned();
    lowest(carried.iter().filter(|(name, _)| called(name)).collect())
        .or_else(|| lowest(carried.iter().collect()))
        .ok_or_else(|| ImportError::NoFoot(tree.bodies[body].name.clone()))
}

/// What the joints' names of the chain begin with, or else the foot's name.
fn name(tree: &Tree, chain: &[usize], foot: &str) -> String {
    let names: Vec<String> = chain.iter().map(|b| joint_name(tree, *b)).collect();
    let common = names.iter().skip(1).fold(names[0].clone(), |common, name| {
        common.chars().zip(name.chars()).take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
    });
    let common = if chain.len() > 1 { common.trim_end_matches(['_', '-', '.']) } else { "" };
    identifier(if common.is_empty() { foot } else { common })
}

/// A name that the specification admits.
pub fn identifier(name: &str) -> String {
    let cleaned: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if cleaned.starts_with(|c: char| c.is_ascii_alphabetic()) { cleaned } else { format!("a_{cleaned}") }
}
