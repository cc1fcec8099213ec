//! Axes: from a quantity to a place, and the round numbers in between.

#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// The quantity at both ends.
    pub domain: [f64; 2],
    /// Where they are drawn, points.
    pub range: [f64; 2],
}

impl Scale {
    pub fn at(&self, value: f64) -> f64 {
        let [a, b] = self.domain;
        let [from, to] = self.range;
        from + (value - a) / (b - a) * (to - from)
    }

    /// Round numbers within the domain, about `count`.
    pub fn ticks(&self, count: usize) -> Vec<f64> {
        let [a, b] = self.domain;
        let step = round_step((b - a) / count as f64);
        let first = (a / step - 1e-9).ceil() as i64;
        let last = (b / step + 1e-9).floor() as i64;
        (first..=last).map(|k| k as f64 * step).collect()
    }

    /// A tick in words, with as many digits as tell neighbours apart.
    pub fn label(&self, tick: f64, count: usize) -> String {
        let step = round_step((self.domain[1] - self.domain[0]) / count as f64);
        let digits = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
        let text = format!("{:.digits$}", tick.abs());
        if tick < -1e-9 * step { format!("−{text}") } else { text }
    }
}

/// 1, 2 or 5 times a power of ten: the least that is no less than `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * power >= rough * (1.0 - 1e-9)).unwrap_or(10.0);
    factor * power
}

/// The domain that holds all values, with some room, and zero where that is near.
pub fn domain(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for v in values.filter(|v| v.is_finite()) {
        (low, high) = (low.min(v), high.max(v));
    }
    if low > high {
        return [0.0, 1.0];
    }
    let span = (high - low).max(1e-6 * (1.0 + high.abs()));
    let room = 0.06 * span;
    let bottom = if low >= 0.0 && low < span { 0.0 } else { low - room };
    let top = if high <= 0.0 && -high < span { 0.0 } else { high + room };
    [bottom, top]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ticks_are_round_within_the_domain_and_about_as_many_as_asked(a in -1e3..1e3f64, span in 1e-4..1e4f64) {
            let scale = Scale { domain: [a, a + span], range: [0.0, 1.0] };
            let ticks = scale.ticks(5);
            prop_assert!((1..=6).contains(&ticks.len()), "{:?}", ticks);
            let slack = 1e-6 * span;
            prop_assert!(ticks.iter().all(|t| (a - slack..=a + span + slack).contains(t)));
            let labels: Vec<String> = ticks.iter().map(|t| scale.label(*t, 5)).collect();
            let mut unique = labels.clone();
            unique.dedup();
            prop_assert_eq!(labels, unique);
        }

        #[test]
        fn a_domain_holds_its_values(values in proptest::collection::vec(-1e6..1e6f64, 1..20)) {
            let [low, high] = domain(values.iter().copied());
            prop_assert!(values.iter().all(|v| (low..=high).contains(v)) && low < high);
        }
    }
}
