//! Integrals of what is known on a uniform grid.
//!
//! Each interval takes the cubic through its four nearest points, so the error falls with the fourth
//! power of the spacing. For ∫|w| (eq. 14) an interval in which w changes sign is split at the root
//! of its cubic, so that the kinks cost no accuracy. Dry friction c changes its sign with a joint's rate: where it does, intervals are
//! split at the root of the rate's cubic too.

/// ∫ w dt of at least four values, `spacing` apart.
pub fn integral(values: &[f64], spacing: f64) -> f64 {
    intervals(values).map(|interval| interval.whole()).sum::<f64>() * spacing
}

/// ∫ |w| dt of at least four values, `spacing` apart.
pub fn integral_of_magnitude(values: &[f64], spacing: f64) -> f64 {
    intervals(values).map(|interval| interval.magnitude()).sum::<f64>() * spacing
}

/// A joint with dry friction.
pub struct Dry<'g> {
    /// c, N·m.
    pub coulomb: f64,
    /// q̇, rad/s.
    pub rates: &'g [f64],
    /// Whether the joint rests all the while: then it asks nothing of the motor.
    pub rests: bool,
    pub spacing: f64,
}

impl Dry<'_> {
    /// ∫ |w + c |q̇|| dt, w the power without it.
    pub fn energy(&self, powers: &[f64]) -> f64 {
        let of_interval = |(power, rate): (Interval, Interval)| {
            let on = |side: f64| power.plus(self.coulomb * side, &rate);
            match self.motion(&rate) {
                Motion::OneWay(side) => on(side).magnitude(),
                Motion::Turns(at, side) => {
                    magnitude(&on(side).cubic(), [0.0, at]) + magnitude(&on(-side).cubic(), [at, 1.0])
                }
            }
        };
        intervals(powers).zip(intervals(self.rates)).map(of_interval).sum::<f64>() * self.spacing
    }

    /// ∫ ((Γ + c sign q̇)² − Γ²) dt.
    pub fn torque(&self, torques: &[f64]) -> f64 {
        let c = self.coulomb;
        // Over a share of the interval, where the torque's integral is this.
        let on = |side: f64, share: f64, torque: f64| c * side * (2.0 * torque + c * side * share);
        let of_interval = |(torque, rate): (Interval, Interval)| match self.motion(&rate) {
            Motion::OneWay(side) => on(side, 1.0, torque.whole()),
            Motion::Turns(at, side) => {
                let first = primitive(&torque.cubic(), at);
                on(side, at, first) + on(-side, 1.0 - at, torque.whole() - first)
            }
        };
        intervals(torques).zip(intervals(self.rates)).map(of_interval).sum::<f64>() * self.spacing
    }

    fn motion(&self, rate: &Interval) -> Motion {
        let [first, last] = [0, 1].map(|k| rate.values[rate.begin + k]);
        match self.rests {
            true => Motion::OneWay(0.0),
            false if rate.changes_sign() => Motion::Turns(root(&rate.cubic(), [0.0, 1.0]), first.signum()),
            false => Motion::OneWay((first + last).signum()),
        }
    }
}

/// How a joint moves over an interval.
enum Motion {
    /// With this sign of its rate; 0 at rest.
    OneWay(f64),
    /// There its rate changes its sign, which was this.
    Turns(f64, f64),
}

/// One interval of the grid, of unit length, with the four values nearest to it.
struct Interval {
    values: [f64; 4],
    /// Which of them it begins at: the first and the last interval have no outer neighbour.
    begin: usize,
}

fn intervals(values: &[f64]) -> impl Iterator<Item = Interval> + '_ {
    let count = values.len().saturating_sub(1);
    (0..count).filter_map(move |i| {
        let first = i.saturating_sub(1).min(values.len().checked_sub(4)?);
        Some(Interval { values: values[first..first + 4].try_into().ok()?, begin: i - first })
    })
}

impl Interval {
    fn changes_sign(&self) -> bool {
        self.values[self.begin] * self.values[self.begin + 1] < 0.0
    }

    /// The integral of the cubic's magnitude.
    fn magnitude(&self) -> f64 {
        let whole = self.whole();
        if !self.changes_sign() {
            return whole.abs();
        }
        let cubic = self.cubic();
        let first = primitive(&cubic, root(&cubic, [0.0, 1.0]));
        first.abs() + (whole - first).abs()
    }

    /// With `factor` times another one added.
    fn plus(&self, factor: f64, other: &Interval) -> Interval {
        Interval { values: std::array::from_fn(|k| self.values[k] + factor * other.values[k]), begin: self.begin }
    }

    /// The integral of the cubic.
    fn whole(&self) -> f64 {
        let [a, b, c, d] = self.values;
        let sum = match self.begin {
            0 => 9.0 * a + 19.0 * b - 5.0 * c + d,
            1 => 13.0 * (b + c) - (a + d),
            _ => a - 5.0 * b + 19.0 * c + 9.0 * d,
        };
        sum / 24.0
    }

    /// Coefficients 1, u, u², u³ of the cubic, u from 0 to 1 over the interval.
    fn cubic(&self) -> [f64; 4] {
        let [a, b, c, d] = self.values;
        let [first_difference, second, third] = [b - a, c - 2.0 * b + a, d - 3.0 * (c - b) - a];
        // a + f x + s x(x−1)/2 + t x(x−1)(x−2)/6 in powers of x = u + begin.
        let [s, t] = [second / 2.0, third / 6.0];
        let by_x = [a, first_difference - s + 2.0 * t, s - 3.0 * t, t];
        let o = self.begin as f64;
        [
            by_x[0] + o * (by_x[1] + o * (by_x[2] + o * by_x[3])),
            by_x[1] + o * (2.0 * by_x[2] + 3.0 * o * by_x[3]),
            by_x[2] + 3.0 * o * by_x[3],
            by_x[3],
        ]
    }
}

fn value(c: &[f64; 4], u: f64) -> f64 {
    c[0] + u * (c[1] + u * (c[2] + u * c[3]))
}

fn primitive(c: &[f64; 4], u: f64) -> f64 {
    u * (c[0] + u * (c[1] / 2.0 + u * (c[2] / 3.0 + u * c[3] / 4.0)))
}

/// A root between two places where the cubic has opposite signs.
fn root(c: &[f64; 4], [mut low, mut high]: [f64; 2]) -> f64 {
    let first = value(c, low);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if value(c, middle) * first > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The integral of a cubic's magnitude between two places.
fn magnitude(c: &[f64; 4], [from, to]: [f64; 2]) -> f64 {
    let between = |a: f64, b: f64| primitive(c, b) - primitive(c, a);
    if value(c, from) * value(c, to) >= 0.0 {
        return between(from, to).abs();
    }
    let root = root(c, [from, to]);
    between(from, root).abs() + between(root, to).abs()
}
