//! Numbers in words: what was given with all its digits, what was computed with a few.

/// Characters of a number without an exponent.
const LONGEST: usize = 24;

/// All digits of a number, as many as it takes to read it back. Far from 1 that would be hundreds of zeros: there it has an exponent.
pub fn digits(number: f64) -> String {
    let plain = number.to_string();
    if plain.len() > LONGEST { format!("{number:e}") } else { plain }
}

/// A number with four digits, without zeros at its end.
pub fn few(number: f64) -> String {
    digits(format!("{number:.3e}").parse().unwrap_or(number))
}

/// A positive number with four digits, rounded up or down: what is printed is what was tried, or is within a bound.
pub fn legible(number: f64, up: bool) -> f64 {
    let unit = 10f64.powf(number.log10().floor() - 3.0);
    let digits = if up { (number / unit).ceil() } else { (number / unit).floor() };
    format!("{:.3e}", digits * unit).parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::{digits, legible};

    #[test]
    fn no_zeros_have_to_be_counted_and_no_digit_is_lost() {
        for (number, text) in
            [(0.6, "0.6"), (4.0, "4"), (1e5, "100000"), (1e-300, "1e-300"), (f64::MAX, "1.7976931348623157e308")]
        {
            assert_eq!(digits(number), text);
            assert_eq!(digits(number).parse(), Ok(number));
        }
        assert_eq!(digits(-1e-300), "-1e-300");
    }

    #[test]
    fn few_digits_stay_on_their_side() {
        for number in [135.8786, 1.0866, 2.5e-7, 9.9999e4] {
            let (down, up) = (legible(number, false), legible(number, true));
            assert!(down <= number && number <= up && up - down < 2e-3 * number, "{down} {number} {up}");
        }
    }
}
