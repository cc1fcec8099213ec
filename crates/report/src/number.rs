//! Numbers as a reader wants them: with as many digits as mean something, and a power of ten where zeros would have to be counted.

use maud::{Markup, html};

/// Decimals are written from this on, and below a million.
const SMALLEST_DECIMAL: f64 = 1e-3;
const LARGEST_DECIMAL: f64 = 1e6;

/// A number in words: a decimal, and the power of ten that it is multiplied by, if any.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Number {
    decimal: String,
    power: Option<i32>,
}

impl Number {
    /// `value` with that many significant digits.
    pub fn new(value: f64, digits: usize) -> Number {
        if value == 0.0 || !value.is_finite() {
            let decimal = if value.is_nan() { "–".into() } else { format!("{}", value.abs()) };
            return Number { decimal: if value < 0.0 { format!("−{decimal}") } else { decimal }, power: None };
        }
        // Rounded first: 0.99996 has the digits of 1.
        let text = format!("{:.*e}", digits.max(1) - 1, value);
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        let rounded: f64 = text.parse().unwrap_or(value);
        if (SMALLEST_DECIMAL..LARGEST_DECIMAL).contains(&rounded.abs()) {
            let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
            return Number { decimal: signed(&format!("{value:.decimals$}")), power: None };
        }
        Number { decimal: signed(mantissa), power: Some(exponent) }
    }

    /// The same without the zeros at its end, for what was asked for rather than found.
    pub fn trimmed(value: f64, digits: usize) -> Number {
        let Number { decimal, power } = Number::new(value, digits);
        let short = if decimal.contains('.') { decimal.trim_end_matches('0').trim_end_matches('.') } else { &decimal };
        Number { decimal: short.into(), power }
    }

    /// For a drawing or a line of text.
    pub fn text(&self) -> String {
        match self.power {
            Some(power) => format!("{}e{}", self.decimal, signed(&power.to_string())),
            None => self.decimal.clone(),
        }
    }

    /// For a page.
    pub fn markup(&self) -> Markup {
        html! { (self.decimal) @if let Some(power) = self.power { "·10" sup { (signed(&power.to_string())) } } }
    }
}

/// With the minus sign of a reader.
fn signed(text: &str) -> String {
    text.replace('-', "−")
}

/// In a drawing or a line of text: `value` with that many significant digits.
pub fn significant(value: f64, digits: usize) -> String {
    Number::new(value, digits).text()
}

/// The same on a page.
pub fn digits(value: f64, digits: usize) -> Markup {
    Number::new(value, digits).markup()
}

/// A number that was given, with the digits that it has, six at most.
pub fn given(value: f64) -> String {
    Number::trimmed(value, 6).text()
}

/// Nothing, in natural units: what rounding leaves of a zero.
const ROUNDING: f64 = 1e-16;

/// How far from zero something in natural units is: two digits and a power of ten.
pub fn scientific(value: f64) -> Markup {
    if value.abs() < ROUNDING {
        return digits(0.0, 2);
    }
    if !value.is_finite() {
        return digits(value, 2);
    }
    let text = format!("{value:.1e}");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    Number { decimal: signed(mantissa), power: power.parse().ok() }.markup()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_that_mean_something_of_numbers_of_any_size() {
        let four = |value: f64| significant(value, 4);
        assert_eq!(
            [6600.0, 0.139, -0.261_84, 0.0, 12_345.6, 0.000_412_34, 0.999_96, 6.759_8e-4, 2.5e9].map(four),
            ["6600", "0.1390", "−0.2618", "0", "12346", "4.123e−4", "1.000", "6.760e−4", "2.500e9"]
        );
        assert_eq!(
            [0.6, 1.426_562_5, 0.103_923_048, 2.0, 1e-9, 100.0].map(given),
            ["0.6", "1.42656", "0.103923", "2", "1e−9", "100"]
        );
        assert_eq!(digits(6.759_8e-4, 3).into_string(), "6.76·10<sup>−4</sup>");
        assert_eq!(scientific(3.4e-9).into_string(), "3.4·10<sup>−9</sup>");
        assert_eq!([0.0, -1e-139].map(|zero| scientific(zero).into_string()), ["0", "0"]);
        assert_eq!([f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(four), ["–", "inf", "−inf"]);
    }
}
