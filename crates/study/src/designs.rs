//! The robots of a study: the base robot with other numbers where these stand in its specification.

use crate::vary::{Over, Vary};
use piaffe_codegen::{RobotFiles, SpecFile, spec};
use piaffe_interpreter::{Robot, Unloadable};
use piaffe_model::digits::digits;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// More designs than this are a slip of the pen.
const MOST: usize = 10_000_000;

/// What is varied, and the values that each design has of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Designs {
    /// Names of the numbers, as in `links.thigh.mass`.
    names: Vec<String>,
    /// Design by design, a value for each name.
    values: Vec<f64>,
    count: usize,
}

impl Designs {
    /// The base robot alone.
    pub fn base() -> Designs {
        Designs { names: Vec::new(), values: Vec::new(), count: 1 }
    }

    /// Every combination of the values; the last number varies fastest.
    ///
    /// # Errors
    /// If a number has an interval instead of values, or there are too many combinations.
    pub fn grid(varied: &[Vary]) -> Result<Designs, String> {
        let values = |vary: &Vary| match &vary.over {
            Over::Values(values) => Ok(values.clone()),
            Over::Between(from, to) => Err(format!(
                "{} has no values between {from} and {to}: give a step, {0}={from}..{to}:{}, or a number of samples",
                vary.name,
                digits((to - from) / 10.0),
                from = digits(*from),
                to = digits(*to)
            )),
        };
        let axes = together(varied.iter().map(values))?;
        let count = axes.iter().try_fold(1_usize, |count, axis| count.checked_mul(axis.len()));
        let count =
            count.filter(|count| *count <= MOST).ok_or_else(|| format!("these are more than {MOST} designs"))?;
        let mut all = Vec::with_capacity(count * axes.len());
        for mut k in 0..count {
            let first = all.len();
            for axis in axes.iter().rev() {
                all.push(axis[k % axis.len()]);
                k /= axis.len();
            }
            all[first..].reverse();
        }
        Ok(Designs { names: names(varied), values: all, count })
    }

    /// So many designs, spread evenly over the intervals: the sequence R_d of Roberts (2018), whose k-th point has the coordinates
    /// k φ⁻ʲ + ½ mod 1 with φ^(d+1) = φ + 1. It has no random numbers, and more samples begin with the fewer ones.
    ///
    /// # Errors
    /// If a number has values instead of an interval, or there are too many designs.
    pub fn sample(varied: &[Vary], count: usize) -> Result<Designs, String> {
        if count > MOST {
            return Err(format!("these are more than {MOST} designs"));
        }
        let interval = |vary: &Vary| match vary.over {
            Over::Between(from, to) => Ok((from, to)),
            Over::Values(_) => {
                Err(format!("of {} samples are to be taken: give its interval, as in 1.0..2.0", vary.name))
            }
        };
        let intervals = together(varied.iter().map(interval))?;
        let steps = steps(intervals.len());
        let at = |k: usize, j: usize| {
            let (from, to) = intervals[j];
            from + (to - from) * (0.5 + (k + 1) as f64 * steps[j]).fract()
        };
        let values =
            (0..count).flat_map(|k| (0..intervals.len()).map(move |j| (k, j))).map(|(k, j)| at(k, j)).collect();
        Ok(Designs { names: names(varied), values, count })
    }

    /// A row of numbers for each design, in the order of the names.
    ///
    /// # Errors
    /// If a row has not a number for each name.
    pub fn listed(names: Vec<String>, rows: &[Vec<f64>]) -> Result<Designs, String> {
        let odd = rows.iter().position(|row| row.len() != names.len() || row.iter().any(|number| !number.is_finite()));
        match odd {
            Some(k) => Err(format!("design {k} must have {} finite numbers", names.len())),
            None => Ok(Designs { names, values: rows.concat(), count: rows.len() }),
        }
    }

    /// Rows that are known to have a finite number for each name.
    pub(crate) fn of(names: Vec<String>, rows: impl Iterator<Item = Vec<f64>>) -> Designs {
        let rows: Vec<Vec<f64>> = rows.collect();
        Designs { names, values: rows.concat(), count: rows.len() }
    }

    pub fn names(&self) -> &[String] {
        &self.names
    }

    pub fn count(&self) -> usize {
        self.count
    }

    /// Its numbers, in the order of the names.
    pub fn numbers(&self, design: usize) -> &[f64] {
        &self.values[design * self.names.len()..][..self.names.len()]
    }

    /// The robot of a design.
    ///
    /// # Errors
    /// If there is no such number, or no such robot.
    pub fn robot(&self, base: &Robot, design: usize) -> Result<Robot, Unloadable> {
        self.robot_with(base, self.numbers(design))
    }

    /// The robot with these numbers, in the order of the names.
    ///
    /// # Errors
    /// As for [`Designs::robot`].
    pub fn robot_with(&self, base: &Robot, numbers: &[f64]) -> Result<Robot, Unloadable> {
        let mut files = placeless(base.files());
        let numbers = self.names.iter().map(String::as_str).zip(numbers.iter().copied());
        files.set_all(numbers).map_err(|faults| Unloadable::Specification(faults.join("\n")))?;
        Robot::new(files)
    }

    /// Everything that is wrong with the names.
    pub fn faults(&self, base: &Robot) -> Vec<String> {
        let mut known: BTreeMap<String, &str> = BTreeMap::new();
        let mut faults = Vec::new();
        for name in &self.names {
            for single in spec::alternatives(name) {
                match known.insert(single.clone(), name) {
                    Some(other) if other == name => faults.push(format!("{name} is varied twice")),
                    Some(other) => faults.push(format!("{single} is varied twice: by {other} and by {name}")),
                    None => {}
                }
            }
        }
        // What is twice is told.
        let singles = known.keys().map(|name| (name.as_str(), 1.0));
        faults.extend(base.files().clone().set_all(singles).err().into_iter().flatten());
        faults
    }

    /// Names of the numbers that are not the same in all designs, or need not be.
    pub fn varied(&self) -> BTreeSet<String> {
        self.names.iter().flat_map(|name| spec::alternatives(name)).collect()
    }

    /// Designs that have all that differs: of each number those in which it is least and greatest.
    pub fn extremes(&self) -> Vec<usize> {
        let mut designs: Vec<usize> = Vec::new();
        for j in 0..self.names.len() {
            let value = |design: &usize| self.numbers(*design)[j];
            let by_value = |a: &usize, b: &usize| value(a).total_cmp(&value(b));
            designs.extend((0..self.count).min_by(by_value));
            designs.extend((0..self.count).max_by(by_value));
        }
        designs.sort_unstable();
        designs.dedup();
        designs
    }
}

/// Files whose names do not say where they are, so that nothing depends on that.
pub(crate) fn placeless(files: &RobotFiles) -> RobotFiles {
    let file = |file: &SpecFile| {
        let name = Path::new(&file.path).file_name().unwrap_or_default();
        SpecFile { path: name.to_string_lossy().into_owned(), text: file.text.clone() }
    };
    RobotFiles {
        module: files.module.clone(),
        robot: file(&files.robot),
        gaits: files.gaits.iter().map(file).collect(),
    }
}

fn names(varied: &[Vary]) -> Vec<String> {
    varied.iter().map(|vary| vary.name.clone()).collect()
}

/// All of them, or all that is wrong with them.
fn together<T>(all: impl Iterator<Item = Result<T, String>>) -> Result<Vec<T>, String> {
    let (good, bad): (Vec<_>, Vec<_>) = all.partition(Result::is_ok);
    let bad: Vec<String> = bad.into_iter().filter_map(Result::err).collect();
    if bad.is_empty() { Ok(good.into_iter().filter_map(Result::ok).collect()) } else { Err(bad.join("\n")) }
}

/// φ⁻¹, φ⁻², … for the φ > 1 with φ^(d+1) = φ + 1.
fn steps(dimensions: usize) -> Vec<f64> {
    let mut phi = 2.0_f64;
    // A contraction: after so many rounds nothing changes.
    for _ in 0..100 {
        phi = libm::pow(1.0 + phi, 1.0 / (dimensions as f64 + 1.0));
    }
    (1..=dimensions).map(|j| phi.powi(-(j as i32))).collect()
}

#[cfg(test)]
mod tests {
    use super::{Designs, steps};

    fn varied(texts: &[&str]) -> Vec<crate::Vary> {
        texts.iter().map(|text| text.parse().unwrap()).collect()
    }

    #[test]
    fn a_grid_has_every_combination_once() {
        let grid = Designs::grid(&varied(&["a=1,2", "b=1..3:1", "c=5"])).unwrap();
        let all: Vec<&[f64]> = (0..grid.count()).map(|k| grid.numbers(k)).collect();
        assert_eq!(all[..3], [[1.0, 1.0, 5.0], [1.0, 2.0, 5.0], [1.0, 3.0, 5.0]]);
        assert_eq!((all.len(), all[5]), (6, &[2.0, 3.0, 5.0][..]));
        assert!(Designs::grid(&varied(&["a=1..2", "b=1..3"])).unwrap_err().lines().count() == 2, "both are told");
        assert!(Designs::grid(&varied(&["a=0..1:1e-5", "b=0..1:1e-5"])).is_err());
    }

    /// The defining property: in every box there are about as many samples as its share of the whole.
    #[test]
    fn samples_are_spread_more_evenly_than_random_ones() {
        let count = 1000;
        let sample = Designs::sample(&varied(&["a=0..1", "b=10..20", "c=-1..1"]), count).unwrap();
        let unit = |k: usize| {
            let n = sample.numbers(k);
            [n[0], (n[1] - 10.0) / 10.0, (n[2] + 1.0) / 2.0]
        };
        for [x, y, z] in [[0.3, 0.7, 0.5], [0.5, 0.5, 1.0], [0.9, 0.2, 0.8], [1.0, 0.35, 0.6]] {
            let inside = (0..count).filter(|k| unit(*k).iter().zip([x, y, z]).all(|(u, end)| *u < end)).count();
            // Random samples are off by 0.015 here.
            assert!((inside as f64 / count as f64 - x * y * z).abs() < 0.008, "{inside} in {x} × {y} × {z}");
        }
        let fewer = Designs::sample(&varied(&["a=0..1", "b=10..20", "c=-1..1"]), 10).unwrap();
        assert!((0..10).all(|k| fewer.numbers(k) == sample.numbers(k)));
    }

    #[test]
    fn steps_are_powers_of_the_generalized_golden_ratio() {
        let phi = 1.0 / steps(2)[0];
        assert!((phi.powi(3) - phi - 1.0).abs() < 1e-14);
        assert!((1.0 / steps(1)[0] - 0.5 * (1.0 + 5.0_f64.sqrt())).abs() < 1e-14);
    }
}
