//! How sure a search is that it has seen the best optimum.

use serde::{Deserialize, Serialize};

/// Fewer starts settle nothing: neither that all lead to one optimum nor that none leads to any.
pub const LEAST: usize = 12;

/// How widely a search has looked, and what for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Effort {
    /// Starts that know of no optimum: the default walk and random ones.
    pub starts: usize,
    /// How many of them led to an optimum.
    #[serde(default)]
    pub successes: usize,
    /// Further starts, from or near optima that were known.
    #[serde(default)]
    pub informed: usize,
    /// Different optima to which all these led.
    #[serde(default)]
    pub optima: usize,
}

impl Effort {
    /// How many optima there are to be expected, seen or not; `None` where so few starts tell nothing.
    ///
    /// Starts that know nothing of each other end in each optimum with a probability that nobody knows. If any number of optima
    /// and any such probabilities are equally likely beforehand, w different ones from n starts let expect
    /// w (n − 1) / (n − w − 2) (Boender and Rinnooy Kan). Optima that only informed starts led to are counted in w as well: where
    /// there are such, more are expected than the estimate by itself would say.
    pub fn expected_optima(&self) -> Option<f64> {
        let Effort { successes: n, optima: w, .. } = *self;
        (n > w + 2).then(|| (w * (n - 1)) as f64 / (n - w - 2) as f64)
    }

    /// How many more starts it takes at least until further ones hardly pay: so many would have to lead to optima that are known.
    pub fn missing(&self) -> usize {
        let more = |more: &usize| Effort { starts: self.starts + more, successes: self.successes + more, ..*self };
        (0..).find(|count| more(count).is_enough()).unwrap_or_default()
    }

    /// Together with a search whose optima are these, as far as is known.
    pub fn with(self, other: Effort) -> Effort {
        Effort {
            starts: self.starts + other.starts,
            successes: self.successes + other.successes,
            informed: self.informed + other.informed,
            optima: self.optima.max(other.optima),
        }
    }

    /// Whether further starts hardly pay: less than half an optimum is yet to be seen, or no start led to any.
    pub fn is_enough(&self) -> bool {
        let settled = |expected: f64| expected <= self.optima as f64 + 0.5;
        self.starts >= LEAST && (self.successes == 0 || self.expected_optima().is_some_and(settled))
    }
}

#[cfg(test)]
mod tests {
    use super::Effort;

    /// The estimate against its definition: the posterior mean of the number of cells after n throws hit w of them.
    #[test]
    fn expected_optima_are_the_mean_of_their_distribution() {
        for (w, n) in [(1, 8), (2, 12), (3, 9), (5, 40)] {
            // A number k of optima, each share of the starts equally likely: w of them are seen with a probability in
            // proportion to C(k, w) / C(n + k − 1, n). All k are equally likely beforehand.
            let mut weight = 1.0;
            let (mut total, mut mean) = (0.0, 0.0);
            for k in w..400_000 {
                total += weight;
                mean += weight * k as f64;
                let k = k as f64;
                weight *= (k + 1.0) / (k + 1.0 - w as f64) * k / (n as f64 + k);
            }
            let effort = Effort { starts: n, successes: n, informed: 0, optima: w };
            let expected = effort.expected_optima().unwrap();
            assert!((mean / total / expected - 1.0).abs() < 1e-4, "{w} of {n}: {} {expected}", mean / total);
        }
    }
}
