//! Axes: from a quantity to a place, the round numbers in between, and the power of ten that their labels leave out.

#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// The quantity at both ends.
    pub domain: [f64; 2],
    /// Where they are drawn, points.
    pub range: [f64; 2],
}

/// Round numbers along an axis, each with its label.
#[derive(Clone, Debug)]
pub struct Ticks {
    pub list: Vec<(f64, String)>,
    /// The labels are in units of this power of ten; 0 where the numbers are of a size that one reads.
    pub power: i32,
}

impl Scale {
    pub fn at(&self, value: f64) -> f64 {
        let [a, b] = self.domain;
        let [from, to] = self.range;
        from + (value - a) / (b - a) * (to - from)
    }

    /// Round numbers within the domain, about `count`.
    pub fn ticks(&self, count: usize) -> Ticks {
        let [a, b] = self.domain;
        let step = round_step((b - a) / count as f64);
        let power = power(a.abs().max(b.abs()));
        // As many digits as tell neighbours apart.
        let digits = (f64::from(power) - (step.log10() + 1e-9).floor()).max(0.0) as usize;
        let label = |tick: f64| {
            let text = format!("{:.digits$}", tick.abs() / 10f64.powi(power));
            if tick < -1e-9 * step { format!("−{text}") } else { text }
        };
        let (first, last) = ((a / step - 1e-9).ceil(), (b / step + 1e-9).floor());
        let count = (last - first).max(0.0) as usize;
        let list = (0..=count).map(|k| (first + k as f64) * step).map(|tick| (tick, label(tick))).collect();
        Ticks { list, power }
    }

    /// Round numbers, at most about `count`, whose labels leave a gap between each other; `width` tells how wide a label is.
    pub fn roomy_ticks(&self, count: usize, width: impl Fn(&str) -> f64) -> Ticks {
        let roomy = |ticks: &Ticks| {
            ticks.list.windows(2).all(|pair| {
                let apart = (self.at(pair[1].0) - self.at(pair[0].0)).abs();
                apart >= 0.5 * (width(&pair[0].1) + width(&pair[1].1)) + GAP
            })
        };
        let found = (2..=count).rev().map(|count| self.ticks(count)).find(roomy);
        found.unwrap_or_else(|| self.ticks(1))
    }
}

/// Between two labels, points.
const GAP: f64 = 8.0;

/// The power of ten, a multiple of three, that labels of numbers up to `most` leave out: none from a hundredth to 100 000.
fn power(most: f64) -> i32 {
    if most == 0.0 || (1e-2..1e5).contains(&most) { 0 } else { 3 * (most.log10() / 3.0).floor() as i32 }
}

/// 1, 2 or 5 times a power of ten: the least that is no less than `rough`.
pub fn round_step(rough: f64) -> f64 {
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
    if low > high || (low == 0.0 && high == 0.0) {
        return [0.0, 1.0];
    }
    // What differs by rounding only is level.
    let span = (high - low).max(1e-6 * high.abs().max(low.abs()));
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
            let ticks = scale.ticks(5).list;
            prop_assert!((1..=6).contains(&ticks.len()), "{:?}", ticks);
            let slack = 1e-6 * span;
            prop_assert!(ticks.iter().all(|(t, _)| (a - slack..=a + span + slack).contains(t)));
            let labels: Vec<String> = ticks.into_iter().map(|(_, label)| label).collect();
            let mut unique = labels.clone();
            unique.dedup();
            prop_assert_eq!(labels, unique);
        }

        #[test]
        fn a_label_times_its_power_is_its_tick_and_short_at_any_size(exponent in -30..30i32, mantissa in 1.0..10.0f64) {
            let most = mantissa * 10f64.powi(exponent);
            let ticks = Scale { domain: [0.0, most], range: [0.0, 1.0] }.ticks(5);
            prop_assert!(ticks.list.len() > 2);
            for (tick, label) in ticks.list {
                prop_assert!(label.len() <= 6, "{}", label);
                let told = label.parse::<f64>().unwrap() * 10f64.powi(ticks.power);
                prop_assert!((told - tick).abs() <= 1e-6 * most, "{} {}", label, tick);
            }
        }

        #[test]
        fn roomy_labels_do_not_touch(a in -1e3..1e3f64, span in 1e-6..1e6f64, width in 20.0..400.0f64) {
            let scale = Scale { domain: [a, a + span], range: [0.0, width] };
            let wide = |label: &str| 6.0 * label.chars().count() as f64;
            let ticks = scale.roomy_ticks(6, wide).list;
            for pair in ticks.windows(2).filter(|_| ticks.len() > 2) {
                let apart = scale.at(pair[1].0) - scale.at(pair[0].0);
                prop_assert!(apart >= 0.5 * (wide(&pair[0].1) + wide(&pair[1].1)));
            }
        }

        #[test]
        fn a_domain_holds_its_values(values in proptest::collection::vec(-1e6..1e6f64, 1..20), exponent in -30..30i32) {
            let values: Vec<f64> = values.into_iter().map(|v| v * 10f64.powi(exponent)).collect();
            let [low, high] = domain(values.iter().copied());
            prop_assert!(values.iter().all(|v| (low..=high).contains(v)) && low < high);
            // They fill it, however small they are.
            let most = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            prop_assert!(high - low <= 2.5 * most, "{} {} {}", low, high, most);
        }
    }
}
