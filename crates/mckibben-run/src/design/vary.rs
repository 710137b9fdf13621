//! A key that varies between two values, and where in between a coordinate from 0 to 1 lies.
//!
//! ```text
//! value = low + x·(high − low)            evenly spaced
//! value = low·(high/low)^x                on a logarithmic scale: where low > 0 and high/low > 10, in SI
//! ```
//!
//! A value is rounded to nine digits in the unit that the ends were written in, so that what was simulated is what is printed
//! and written to a file.

use crate::units::degrees_without_offset;
use mckibben_scenario::{Dimension, list_and_entry, quantity};
use std::fmt;
use std::str::FromStr;

/// Significant digits of a value.
const DIGITS: usize = 9;
/// A range over a larger ratio has a logarithmic scale.
const DECADE: f64 = 10.0;

/// A key and the range within which its value is looked for: `supply.gauge_pressure=3..7 bar`.
#[derive(Clone, Debug, PartialEq)]
pub struct Vary {
    /// Path of the key, such as `command.duty`; of an entry of a list with its place counted from 0, as in `relaxation_time[0]`.
    pub key: String,
    /// The unit as it was written; empty for a pure number.
    pub unit: String,
    /// The ends in that unit.
    pub ends: [f64; 2],
    /// The dimension of the unit.
    pub(super) dimension: Dimension,
    scale: UnitScale,
}

/// How a number in a unit is one in SI: `si = zero + size·number`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UnitScale {
    zero: f64,
    size: f64,
}

impl UnitScale {
    /// The scale of a unit and its dimension.
    pub(super) fn of(unit: &str) -> Result<(Self, Dimension), String> {
        let at = |number: &str| quantity::parse(&format!("{number} {unit}")).map_err(|error| error.to_string());
        let (none, one) = (at("0")?, at("1")?);
        Ok((Self { zero: none.value, size: one.value - none.value }, one.dimension))
    }

    /// The unit of differences in a unit of this scale: kelvins are as large as °C, and degrees Rankine as °F.
    pub(super) fn unit_of_differences(self, unit: &str) -> &str {
        if self.zero == 0.0 { unit } else { degrees_without_offset(self.size) }
    }

    /// A number in SI.
    pub(super) fn to_si(self, number: f64) -> f64 {
        self.zero + self.size * number
    }

    /// A number in the unit of a value in SI.
    pub(super) fn number(self, si: f64) -> f64 {
        (si - self.zero) / self.size
    }

    /// A difference in the unit of one in SI.
    pub(super) fn difference(self, si: f64) -> f64 {
        si / self.size
    }
}

impl Vary {
    /// Whether the scale is logarithmic.
    pub fn is_logarithmic(&self) -> bool {
        let [low, high] = self.ends.map(|end| self.scale.to_si(end));
        low > 0.0 && high / low > DECADE
    }

    /// The number in the unit at a coordinate from 0 to 1.
    pub(super) fn number(&self, coordinate: f64) -> f64 {
        let [low, high] = self.ends.map(|end| self.scale.to_si(end));
        match coordinate {
            x if x <= 0.0 => self.ends[0],
            x if x >= 1.0 => self.ends[1],
            x if self.is_logarithmic() => rounded(self.scale.number(low * (high / low).powf(x))),
            x => rounded(self.scale.number(low + x * (high - low))),
        }
    }

    /// A number in SI.
    pub fn in_si(&self, number: f64) -> f64 {
        self.scale.to_si(number)
    }

    /// The ends in SI.
    pub(super) fn ends_in_si(&self) -> [f64; 2] {
        self.ends.map(|end| self.in_si(end))
    }

    /// A number with its unit, as it stands in a scenario file.
    pub(super) fn text(&self, number: f64) -> String {
        if self.unit.is_empty() { format!("{number}") } else { format!("{number} {}", self.unit) }
    }

    /// A number with its unit as TOML: a string where there is a unit.
    pub(super) fn toml(&self, number: f64) -> String {
        if self.unit.is_empty() { float(number) } else { toml_edit::Value::from(self.text(number)).to_string() }
    }

    /// The path of the list and the place in it, where the key is an entry of a list.
    pub(super) fn entry(&self) -> Option<(&str, usize)> {
        let (list, place) = list_and_entry(&self.key)?;
        Some((list, place.parse().ok()?))
    }

    /// The ends with their unit, as in `3..7 bar`.
    pub fn range(&self) -> String {
        let gap = if self.unit.is_empty() { "" } else { " " };
        format!("{}..{}{gap}{}", self.ends[0], self.ends[1], self.unit)
    }
}

impl FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const WRITE: &str = "write KEY=LOW..HIGH UNIT, as in supply.gauge_pressure=3..7 bar";
        let (key, range) = text.split_once('=').ok_or(WRITE)?;
        let (key, (low, high)) = (key.trim(), range.split_once("..").ok_or(WRITE)?);
        if key.is_empty() {
            return Err(format!("a key must stand before the =: {WRITE}"));
        }
        let parts = [low, high].map(|end| number_and_unit(end).ok_or_else(|| no_number(end, WRITE)));
        let [(low, of_low), (high, of_high)] = match parts {
            [Ok(low), Ok(high)] => [low, high],
            [Err(words), _] | [_, Err(words)] => return Err(words),
        };
        // The unit of either end holds for both.
        let unit = if of_high.is_empty() { of_low } else { of_high };
        let (scale, dimension) = UnitScale::of(unit)?;
        let low = match of_low {
            "" => low,
            other if other == unit => low,
            other => {
                let (from, of) = UnitScale::of(other)?;
                if of != dimension {
                    return Err(format!("the ends of {key} have units of two kinds, `{other}` and `{unit}`: {WRITE}"));
                }
                rounded(scale.number(from.to_si(low)))
            }
        };
        if low >= high {
            return Err(format!("{key} has no range from {low} to {high} {unit}: the lower value stands first"));
        }
        Ok(Self { key: key.to_owned(), unit: unit.to_owned(), ends: [low, high], dimension, scale })
    }
}

impl fmt::Display for Vary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.range())
    }
}

fn no_number(text: &str, write: &str) -> String {
    format!("`{}` begins with no number: {write}", text.trim())
}

/// A number and the unit behind it, which may be empty.
pub(super) fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let is_of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '+' | '-' | 'e' | 'E');
    let most = text.find(|c| !is_of_number(c)).unwrap_or(text.len());
    // A unit may begin with an `e`.
    let ends = (1..=most).rev().filter(|end| text.is_char_boundary(*end));
    ends.map(|end| text.split_at(end)).find_map(|(number, unit)| {
        let value = number.parse::<f64>().ok().filter(|value| value.is_finite())?;
        Some((value, unit.trim()))
    })
}

/// A number to [`DIGITS`] significant digits.
pub(super) fn rounded(number: f64) -> f64 {
    format!("{number:.*e}", DIGITS - 1).parse().unwrap_or(number)
}

/// A pure number as TOML: whole ones without a point, as people write them.
fn float(number: f64) -> String {
    let text = format!("{number}");
    // TOML has no bare whole numbers beyond 64 bits.
    if text.contains('.') || number.abs() < 1e15 { text } else { format!("{number:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vary {
        text.parse().unwrap_or_else(|words| panic!("{text}: {words}"))
    }

    #[test]
    fn a_unit_may_stand_on_either_end_or_both() {
        for text in ["a.b=3..7 bar", "a.b=3 bar..7", "a.b = 3 bar .. 7 bar", "a.b=300 kPa..7 bar", "a.b=3e0..7.0e0bar"]
        {
            let vary = read(text);
            assert_eq!((vary.key.as_str(), vary.unit.as_str(), vary.ends), ("a.b", "bar", [3.0, 7.0]), "{text}");
            assert_eq!(vary.toml(vary.number(0.5)), "\"5 bar\"");
        }
        let duty = read("command.duty=10..90 %");
        assert_eq!((duty.toml(duty.number(0.25)), duty.range()), ("\"30 %\"".to_owned(), "10..90 %".to_owned()));
        assert_eq!(read("a=0.1..0.9").toml(0.5), "0.5");
        assert_eq!(read("a=-2..3 mm").number(0.5), 0.5);
        assert_eq!(read("a=20..60 degC").number(0.5), 40.0);
        assert_eq!(read("a.b[1]=1..2 s").entry(), Some(("a.b", 1)));
    }

    #[test]
    fn more_than_a_decade_above_zero_is_logarithmic() {
        let conductance = read("valve.sonic_conductance=1..100 L/(min*bar)");
        assert!(conductance.is_logarithmic());
        assert!((conductance.number(0.5) - 10.0).abs() < 1e-8);
        assert_eq!([conductance.number(0.0), conductance.number(1.0)], [1.0, 100.0]);
        for text in ["a=1..10 bar", "a=0..100 bar", "a=-1..100 bar", "a=1..60 degC"] {
            assert!(!read(text).is_logarithmic(), "{text}");
        }
    }

    #[test]
    fn what_is_no_range_is_refused_with_the_remedy() {
        for (text, words) in [
            ("supply.gauge_pressure", "KEY=LOW..HIGH UNIT"),
            ("supply.gauge_pressure=3 bar", "KEY=LOW..HIGH UNIT"),
            ("=3..7 bar", "a key must stand before"),
            ("a=x..7 bar", "`x` begins with no number"),
            ("a=7..3 bar", "the lower value stands first"),
            ("a=3..3 bar", "the lower value stands first"),
            ("a=3 mm..7 bar", "units of two kinds"),
            ("a=3..7 baz", "baz"),
            ("a=nan..7 bar", "begins with no number"),
        ] {
            let found = text.parse::<Vary>().expect_err(text);
            assert!(found.contains(words), "{text}: {found}");
        }
    }
}
