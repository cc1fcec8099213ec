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

/// A number with four digits, rounded up or down: what is printed is what was tried, or is within a bound.
pub fn legible(number: f64, up: bool) -> f64 {
    // What is printed is rounded to nearest: on the wrong side of the number by less than a unit of its last digit.
    let Some((digits, power)) = parts(number) else { return number };
    let nearest = value(digits, power);
    let wrong = if up { nearest < number } else { nearest > number };
    let step = if up { 1 } else { -1 };
    if wrong { value(digits + step, power) } else { nearest }
}

/// The four digits of a number and the power of ten of the last; none of what has none.
fn parts(number: f64) -> Option<(i64, i32)> {
    let text = format!("{number:.3e}");
    let (digits, power) = text.split_once('e')?;
    Some((digits.replace('.', "").parse().ok()?, power.parse::<i32>().ok()? - 3))
}

fn value(digits: i64, power: i32) -> f64 {
    format!("{digits}e{power}").parse().unwrap_or(f64::NAN)
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
            assert_eq!([legible(-number, true), legible(-number, false)], [-down, -up]);
        }
        for number in [0.0, 0.6, -1e-300, 135.8, f64::INFINITY] {
            assert_eq!([legible(number, true), legible(number, false)], [number; 2]);
        }
        assert!(legible(f64::NAN, true).is_nan());
    }
}
