//! What a person asks to be varied: `links.thigh.mass=1.0..2.0:0.1`.

use piaffe_model::digits::digits;
use std::str::FromStr;

/// More values than this are a slip of the pen.
const MOST: usize = 1_000_000;

/// A number of the specification, and what it is to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Vary {
    /// As in `links.thigh.mass`; several at once with braces, `links.{left,right}_shin.mass`.
    pub name: String,
    pub over: Over,
}

/// The values that a number is to have.
#[derive(Clone, Debug, PartialEq)]
pub enum Over {
    /// These, in this order: `1,2,4` or `1..2:0.5`.
    Values(Vec<f64>),
    /// Some between these, as a sample has them: `1..2`.
    Between(f64, f64),
}

impl FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> Result<Vary, String> {
        let (name, over) =
            text.split_once('=').ok_or("write NAME=FROM..TO:STEP, for example links.thigh.mass=1.0..2.0:0.1")?;
        Ok(Vary { name: name.trim().into(), over: over.parse()? })
    }
}

impl FromStr for Over {
    type Err = String;

    fn from_str(text: &str) -> Result<Over, String> {
        let number = |text: &str| match text.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!("`{}` is no number; write for example 1.0..2.0:0.1, 1.0..2.0 or 1.0,1.5", text.trim())),
        };
        let Some((from, rest)) = text.split_once("..") else {
            return Ok(Over::Values(text.split(',').map(number).collect::<Result<_, _>>()?));
        };
        let (to, step) = rest.split_once(':').map_or((rest, None), |(to, step)| (to, Some(step)));
        let (from, to) = (number(from)?, number(to)?);
        if to < from {
            return Err(format!("the range ends below its beginning: write {}..{}", digits(to), digits(from)));
        }
        let Some(step) = step else { return Ok(Over::Between(from, to)) };
        let step = number(step)?;
        if step <= 0.0 {
            return Err(format!("a step of {} leads nowhere: it must be positive", digits(step)));
        }
        let count = steps(from, to, step);
        if count >= MOST as f64 || (count > 0.0 && from + step == from) {
            return Err(format!("the range has more than {MOST} values: take a greater step"));
        }
        Ok(Over::Values(multiples(from, step, count as usize)))
    }
}

/// How many whole steps a range has; one that ends a rounding before its last has that too.
pub fn steps(from: f64, to: f64, step: f64) -> f64 {
    ((to - from) / step + 1e-9).floor()
}

/// Values that follow each other by a step, `count` of them after the first: free of accumulated rounding, with the digits that a
/// person may have meant.
pub fn multiples(from: f64, step: f64, count: usize) -> Vec<f64> {
    let rounded = |number: f64| format!("{number:.11e}").parse().unwrap_or(number);
    (0..=count).map(|k| rounded(from + k as f64 * step)).collect()
}

#[cfg(test)]
mod tests {
    use super::{Over, Vary};

    #[test]
    fn ranges_lists_and_intervals_are_told_apart() {
        let vary: Vary = "links.thigh.mass=1.0..1.4:0.1".parse().unwrap();
        assert_eq!(vary, Vary { name: "links.thigh.mass".into(), over: Over::Values(vec![1.0, 1.1, 1.2, 1.3, 1.4]) });
        assert_eq!("a=-2,0,3e1".parse::<Vary>().unwrap().over, Over::Values(vec![-2.0, 0.0, 30.0]));
        assert_eq!("a=-2..-1".parse::<Vary>().unwrap().over, Over::Between(-2.0, -1.0));
        assert_eq!("a=1..1:1".parse::<Vary>().unwrap().over, Over::Values(vec![1.0]));
        for bad in
            ["a", "a=", "a=1..", "a=2..1", "a=1..2:0", "a=1..2:-1", "a=1..2:x", "a=nan", "a=1..inf", "a=0..1:1e-9"]
        {
            assert!(bad.parse::<Vary>().is_err(), "{bad}");
        }
    }
}
