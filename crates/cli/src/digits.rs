//! Numbers as a person reads them.

/// A number with so many decimals, or with more where it has fewer significant digits than that; with a power of ten where
/// plain digits would be many.
pub fn decimal(x: f64, decimals: usize) -> String {
    at_least(x, decimals, decimals.max(1))
}

/// The same with at least so many significant digits.
pub fn at_least(x: f64, decimals: usize, digits: usize) -> String {
    let magnitude = x.abs();
    if magnitude == 0.0 || !magnitude.is_finite() {
        return format!("{x:.decimals$}");
    }
    // Of the number as it is printed: 0.00099996 may round to 0.0010000.
    let exponent = format!("{magnitude:.*e}", digits - 1);
    let exponent: i32 = exponent.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    match exponent {
        7.. | ..-3 => format!("{x:.digits$e}"),
        _ => format!("{x:.*}", decimals.max((digits as i32 - 1 - exponent).max(0) as usize)),
    }
}

#[cfg(test)]
mod tests {
    use super::{at_least, decimal};

    #[test]
    fn a_number_keeps_its_significant_digits() {
        for (x, decimals, text) in [
            (15.598231, 4, "15.5982"),
            (334.57561, 4, "334.5756"),
            (0.2185931, 4, "0.2186"),
            (0.0541234, 4, "0.05412"),
            (0.0541234, 1, "0.05"),
            (6.7598158e-4, 4, "6.7598e-4"),
            (0.00099996, 3, "0.00100"),
            (-0.0123456, 3, "-0.0123"),
            (0.0, 4, "0.0000"),
            (1.5598231e9, 4, "1.5598e9"),
            (40.0, 1, "40.0"),
        ] {
            assert_eq!(decimal(x, decimals), text, "{x}");
        }
        for (x, text) in [(40.0, "40.0"), (0.32, "0.320"), (0.0008, "8.000e-4"), (6e4, "60000.0"), (6e9, "6.000e9")] {
            assert_eq!(at_least(x, 1, 3), text, "{x}");
        }
    }
}
