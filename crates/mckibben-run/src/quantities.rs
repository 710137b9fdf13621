//! Numbers for people: four digits, in the units of [`crate::units`].

use crate::units::units;
use mckibben_scenario::quantity;

/// A value with its unit: four significant digits, in the units that were chosen.
pub fn quantity(value: f64, unit: &str) -> String {
    units().quantity(value, unit)
}

/// A value that a user gave: as [`quantity()`], without zeros that say nothing.
pub fn given(value: f64, unit: &str) -> String {
    units().given(value, unit)
}

/// A ratio that a user gave, in percent.
pub fn given_percent(value: f64) -> String {
    format!("{} %", plain(&digits(value * 100.0)))
}

/// A number without the zeros behind its last digit.
pub fn plain(number: &str) -> &str {
    if number.contains('.') && !number.contains('e') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

/// A ratio in percent.
pub fn percent(value: f64) -> String {
    format!("{} %", digits(value * 100.0))
}

/// A whole number with thin groups of three.
pub fn count(value: u64) -> String {
    let plain = value.to_string();
    let mut grouped = String::new();
    for (place, digit) in plain.chars().enumerate() {
        if place > 0 && (plain.len() - place).is_multiple_of(3) && plain.len() > 4 {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

/// A number of things with its noun: `1 run`, `3 runs`. The plural of the noun ends in `s`.
pub fn counted(value: u64, noun: &str) -> String {
    format!("{} {noun}{}", count(value), if value == 1 { "" } else { "s" })
}

/// A value within this factor of a power of ten rounds up to it in four digits.
const ROUNDS_UP: f64 = 1.00005;

/// Prefixes with their powers of ten.
const PREFIXES: [(i32, &str); 10] =
    [(9, "G"), (6, "M"), (3, "k"), (0, ""), (-3, "m"), (-6, "µ"), (-9, "n"), (-12, "p"), (-15, "f"), (-18, "a")];

/// A number between 1 and 1000 and the prefix that makes it the value.
pub(crate) fn prefixed(value: f64) -> (f64, &'static str) {
    let size = value.abs();
    // A value just below a power of ten rounds up to it and then belongs to the larger prefix.
    let rounded = size * ROUNDS_UP;
    let found = PREFIXES.iter().find(|(power, _)| rounded >= 10f64.powi(*power));
    match found {
        Some((power, prefix)) => (value / 10f64.powi(*power), prefix),
        None => (value, ""),
    }
}

/// Four significant digits; what is too small or too large for plain digits has an exponent.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.2e}");
    }
    // Below 1 the leading zeros do not count; what rounds up to the next power of ten has its digits.
    let decimals = 3 - (size * ROUNDS_UP).log10().floor() as i32;
    let text = format!("{value:.*}", decimals.clamp(0, 8) as usize);
    if text.trim_start_matches(['-', '0', '.']).is_empty() { "0".to_owned() } else { text }
}

/// A quantity with a unit as users write it, in the SI unit that it must have the dimension of.
///
/// # Errors
/// What is wrong, in words, with `what` it should be and an `example` of it.
pub fn read(text: &str, what: &str, unit: &str, example: &str) -> Result<f64, String> {
    let read = quantity::parse(text).map_err(|error| error.to_string())?;
    let (dimension, _) = quantity::parse_unit(unit).map_err(|error| error.to_string())?;
    if read.has_unit && read.dimension == dimension {
        return Ok(read.value);
    }
    Err(format!("`{text}` is no {what}; write a number with its unit, as in \"{example}\""))
}

/// A share as users write it: a number, or one in percent.
///
/// # Errors
/// What is wrong, in words, with what is expected.
pub fn read_share(text: &str) -> Result<f64, String> {
    let expected = || format!("`{text}` is no share; write a number such as 0.8, or one in percent, \"80 %\"");
    let read = quantity::parse(text).map_err(|_| expected())?;
    if read.dimension == quantity::parse("1").map_err(|error| error.message)?.dimension {
        Ok(read.value)
    } else {
        Err(expected())
    }
}

/// Several quantities in a list such as `35,45,55psi`, each with its label in its unit. A number without a unit has that of the next;
/// behind the last it has `usual`, where there is one.
///
/// # Errors
/// What is wrong, in words, with `what` each should be, which `unit` has the dimension of, and some `units` of it.
pub(crate) fn read_list(
    text: &str,
    [what, unit, units]: [&str; 3],
    usual: Option<&str>,
) -> Result<Vec<(f64, String)>, String> {
    let (dimension, _) = quantity::parse_unit(unit).map_err(|error| error.message)?;
    let mut found = Vec::new();
    let mut unit = usual.unwrap_or_default();
    // From the right, because a number without a unit has that of the next.
    for item in text.rsplit(',').map(str::trim) {
        let (number, own) = split(item).ok_or_else(|| format!("`{item}` is not a number with a unit of {what}"))?;
        unit = if own.is_empty() { unit } else { own };
        let label = format!("{number} {unit}");
        let read = quantity::parse(&label).map_err(|error| error.message)?;
        if read.dimension != dimension {
            return Err(format!("`{item}` is no {what}; write a unit such as {units} behind the last number"));
        }
        found.push((read.value, label));
    }
    found.reverse();
    Ok(found)
}

/// The number at the beginning of a text and what follows it.
fn split(item: &str) -> Option<(&str, &str)> {
    let mut ends = item.char_indices().map(|(at, c)| at + c.len_utf8());
    let end = ends.rfind(|end| item[..*end].trim_end().parse::<f64>().is_ok_and(f64::is_finite))?;
    Some((item[..end].trim_end(), item[end..].trim_start()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits_and_a_prefix() {
        let cases = [
            ((0.084_12, "m"), "84.12 mm"),
            ((413_685.4, "Pa"), "4.137 bar"),
            ((2.267_96, "kg"), "2.268 kg"),
            ((7.304e-6, "kg"), "7.304 mg"),
            ((-0.0123, "m/s"), "-12.30 mm/s"),
            ((0.0, "N"), "0 N"),
            ((0.999_999, "N"), "1.000 N"),
            ((26.689, "N"), "26.69 N"),
        ];
        for ((value, unit), text) in cases {
            assert_eq!(quantity(value, unit), text);
        }
    }

    #[test]
    fn shares_are_numbers_or_percent() {
        assert_eq!(["0.8", "80%", "80 %", "1"].map(|text| read_share(text).ok()), [0.8, 0.8, 0.8, 1.0].map(Some));
        for text in ["80 mm", "much", "", "80 psi"] {
            assert!(read_share(text).is_err_and(|error| error.contains("80 %")), "{text}");
        }
    }

    #[test]
    fn what_was_given_has_no_idle_zeros() {
        assert_eq!([given(25.0, "Hz"), given(2.0, "s"), given(100.0, "N")], ["25 Hz", "2 s", "100 N"]);
        assert_eq!([given(3000.0, "s"), given(0.001, "s")], ["3000 s", "1 ms"]);
        assert_eq!([given(0.0, "Pa"), given_percent(0.425)], ["0 bar", "42.5 %"]);
    }

    #[test]
    fn one_thing_is_singular() {
        let texts = [0, 1, 2, 12_345].map(|value| counted(value, "run"));
        assert_eq!(texts, ["0 runs", "1 run", "2 runs", "12 345 runs"]);
    }

    #[test]
    fn groups_of_three() {
        assert_eq!([count(0), count(1234), count(12345), count(1_234_567)], ["0", "1234", "12 345", "1 234 567"]);
    }
}
