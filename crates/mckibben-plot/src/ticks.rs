//! The round values of an axis, and how they are written.
//!
//! A tick of a linear axis is a whole number n times a step m·10^k with m one of 1, 2, 5. It is kept as n·m and k and written by moving
//! the decimal point, so a label never shows the rounding of a float: 0.3 stays "0.3".
//!
//! * Values beyond 10⁴ or below 10⁻² are divided by a power of 1000. Where the unit takes an SI prefix it gets one
//!   (0.002 m becomes 2 mm); otherwise the power stands before the unit, as in (10⁶ mm).
//! * Where ticks would need more than six digits because a large value hardly changes, a round part is taken off and
//!   said so in the label: "pressure − 101325 Pa (mPa)".

use super::axis::{Axis, Scale};
use super::decades::logarithmic;
use super::range::Range;

/// More digits than this are unreadable beside an axis.
const DIGITS: i32 = 6;

/// The round values of an axis and its label.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// Value and label, rising.
    pub(super) at: Vec<(f64, String)>,
    /// The values of small ticks without a label, rising.
    pub(super) minor: Vec<f64>,
    /// The label of the axis, with the unit that the tick labels are in.
    pub(super) label: String,
}

impl Ticks {
    /// The values with labels.
    pub(super) fn values(&self) -> Vec<f64> {
        self.at.iter().map(|tick| tick.0).collect()
    }
}

/// Round values on an axis of a length, whose labels need a spacing, both in pt.
pub(super) fn ticks(axis: &Axis, range: Range, length: f64, spacing: f64) -> Ticks {
    if !axis.words.is_empty() {
        let mut at: Vec<_> = axis.words.iter().filter(|(value, _)| range.contains(*value, 0.0)).cloned().collect();
        at.sort_by(|a, b| a.0.total_cmp(&b.0));
        return Ticks { at, minor: Vec::new(), label: label(axis, None, 0) };
    }
    match range.scale {
        Scale::Linear => linear(axis, range.ends(), length / spacing),
        Scale::Logarithmic => logarithmic(axis, range, length, spacing, false),
    }
}

/// As [`ticks`]; on a logarithmic axis all labels are powers of ten, as another axis of the figure needs them.
pub(super) fn ticks_in_powers(axis: &Axis, range: Range, length: f64, spacing: f64) -> Ticks {
    match (range.scale, axis.words.is_empty()) {
        (Scale::Logarithmic, true) => logarithmic(axis, range, length, spacing, true),
        _ => ticks(axis, range, length, spacing),
    }
}

impl Ticks {
    /// Whether labels are powers of ten.
    pub(super) fn has_powers(&self) -> bool {
        self.at.iter().any(|(_, label)| {
            label.contains("10") && label.contains(['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'])
        })
    }
}

/// At most `most` round values between two ends, equally far apart, and at least two where a step allows.
pub(super) fn linear(axis: &Axis, (low, high): (f64, f64), most: f64) -> Ticks {
    let span = high - low;
    let largest = low.abs().max(high.abs());
    let (mut unit, mut k) = step(span / most.max(1.0));
    if multiples((low, high), unit, k).len() < 2 {
        (unit, k) = step(span / (1.8 * most.max(1.0)));
    }
    // A round part to take off, as a whole number of powers of ten next above the span.
    let offset = (decade(largest) - k >= DIGITS).then(|| {
        let power = decade(span) + 1;
        (((low / 2.0 + high / 2.0) / decimal(1, power)).round() as i64, power)
    });
    let base = offset.map_or(0.0, |(n, power)| decimal(n, power));
    let shifted = (low - base, high - base);
    let exponent = engineering(shifted.0.abs().max(shifted.1.abs()));
    let multiples = multiples(shifted, unit, k);
    let at = multiples.into_iter().map(|n| (base + decimal(n, k), written(n, k - exponent))).collect();
    Ticks { at, minor: Vec::new(), label: label(axis, offset, exponent) }
}

/// The smallest round step that is no smaller than `least`, as m and k of m·10^k.
fn step(least: f64) -> (i64, i32) {
    let k = decade(least);
    match [1, 2, 5].into_iter().find(|m| decimal(*m, k) >= least * (1.0 - 1e-9)) {
        Some(m) => (m, k),
        None => (1, k + 1),
    }
}

/// The multiples of m·10^k within a range, in units of 10^k.
fn multiples((low, high): (f64, f64), m: i64, k: i32) -> Vec<i64> {
    let step = decimal(m, k);
    // The slack admits an end that is a multiple but for rounding.
    let (first, last) = ((low / step - 1e-6).ceil(), (high / step + 1e-6).floor());
    if !(first.abs() < 1e15 && last.abs() < 1e15) {
        return Vec::new();
    }
    (first as i64..=last as i64).take(200).map(|n| n * m).collect()
}

/// The exponent of a value in scientific notation; 0 for 0.
fn decade(value: f64) -> i32 {
    // Formatting is exact where a logarithm is not: log10(1000) may fall short of 3.
    let text = format!("{value:e}");
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

/// n·10^k, correctly rounded.
pub(super) fn decimal(n: i64, k: i32) -> f64 {
    format!("{n}e{k}").parse().unwrap_or(0.0)
}

/// The power of ten, a multiple of 3, that labels are divided by.
fn engineering(largest: f64) -> i32 {
    let decade = decade(largest);
    if (-2..=3).contains(&decade) { 0 } else { decade.div_euclid(3) * 3 }
}

/// n·10^shift in figures, with a minus sign as long as a plus.
pub(super) fn written(n: i64, shift: i32) -> String {
    if n == 0 {
        return "0".to_string();
    }
    let sign = if n < 0 { "−" } else { "" };
    let digits = n.unsigned_abs().to_string();
    let places = shift.unsigned_abs() as usize;
    if shift >= 0 {
        return format!("{sign}{digits}{}", "0".repeat(places));
    }
    let digits = format!("{digits:0>width$}", width = places + 1);
    let (whole, part) = digits.split_at(digits.len() - places);
    format!("{sign}{whole}.{part}")
}

/// The label of an axis: quantity, what was taken off, unit.
pub(super) fn label(axis: &Axis, offset: Option<(i64, i32)>, exponent: i32) -> String {
    // An axis without a name stands beside one with a name and the same values.
    if axis.label.is_empty() && axis.unit.is_empty() {
        return String::new();
    }
    let mut text = axis.label.clone();
    if let Some((n, power)) = offset.filter(|(n, _)| *n != 0) {
        let sign = if n < 0 { '+' } else { '−' };
        let size = n.abs();
        let (mut n, mut power) = (size, power);
        while n % 10 == 0 {
            (n, power) = (n / 10, power + 1);
        }
        let figures = match power {
            -6..=6 => written(n, power),
            _ => format!("{n}·10{}", raised(power)),
        };
        let unit = if axis.unit.is_empty() { String::new() } else { format!(" {}", axis.unit) };
        text = format!("{text} {sign} {figures}{unit}");
    }
    let unit = match (exponent, axis.unit.as_str()) {
        (0, unit) => unit.to_string(),
        (_, "") => format!("×10{}", raised(exponent)),
        (_, unit) => match prefix(exponent).filter(|_| takes_prefix(unit)) {
            Some(prefix) => format!("{prefix}{unit}"),
            None => format!("10{} {unit}", raised(exponent)),
        },
    };
    match (text.is_empty(), unit.is_empty()) {
        (_, true) => text,
        (true, false) => format!("({unit})"),
        (false, false) => format!("{text} ({unit})"),
    }
}

fn prefix(exponent: i32) -> Option<&'static str> {
    let names = [(-12, "p"), (-9, "n"), (-6, "µ"), (-3, "m"), (3, "k"), (6, "M"), (9, "G"), (12, "T")];
    names.iter().find(|(e, _)| *e == exponent).map(|(_, name)| *name)
}

/// Whether a prefix before the whole unit means what it says: it begins with a bare SI unit, not with a power of it.
fn takes_prefix(unit: &str) -> bool {
    let end = unit.find(|c: char| !c.is_alphabetic()).unwrap_or(unit.len());
    let (first, rest) = unit.split_at(end);
    let bare = rest.is_empty() || rest.starts_with([' ', '/', '·']);
    bare && ["m", "s", "N", "Pa", "J", "W", "V", "A", "Hz", "K", "mol", "L", "Ω"].contains(&first)
}

pub(super) fn raised(n: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
    };
    n.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, unit: &str) -> (Vec<String>, String) {
        let ticks = linear(&Axis::new("q", unit), (low, high), 5.0);
        (ticks.at.into_iter().map(|t| t.1).collect(), ticks.label)
    }

    #[test]
    fn round_values_without_the_rounding_of_floats() {
        assert_eq!(labels(0.0, 1.0, "s").0, ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-0.31, 0.31, "m").0, ["−0.2", "0", "0.2"]);
        assert_eq!(labels(150.0, 260.0, "mm").0, ["150", "200", "250"]);
        let at = linear(&Axis::new("q", ""), (0.0, 1.0), 10.0).at;
        assert_eq!(at[3], (0.3, "0.3".to_string()));
    }

    #[test]
    fn large_and_small_values_take_a_prefix_or_a_power() {
        assert_eq!(labels(0.0, 3e-9, "m"), (vec!["0".into(), "1".into(), "2".into(), "3".into()], "q (nm)".into()));
        assert_eq!(labels(0.0, 3e9, "Pa").1, "q (GPa)");
        assert_eq!(labels(0.0, 3e-3, "N m").1, "q (mN m)");
        assert_eq!(labels(0.0, 3e9, "mm").1, "q (10⁹ mm)");
        assert_eq!(labels(0.0, 3e-9, "m²").1, "q (10⁻⁹ m²)");
        assert_eq!(labels(0.0, 3e9, "").1, "q (×10⁹)");
        assert_eq!(label(&Axis::new("", ""), Some((1, 3)), 9), "");
        assert_eq!(labels(0.0, 3e-20, "m").1, "q (10⁻²¹ m)");
        assert_eq!(labels(0.0, 9000.0, "N").1, "q (N)");
    }

    #[test]
    fn a_large_value_that_hardly_changes_is_shown_as_a_difference() {
        let (ticks, label) = labels(101_324.999_9, 101_325.000_1, "Pa");
        assert_eq!(label, "q − 101325 Pa (µPa)");
        assert_eq!(ticks, ["−100", "−50", "0", "50", "100"]);
        assert_eq!(labels(-1e9 - 1.0, -1e9 + 1.0, "m").1, "q + 1·10⁹ m (m)");
    }

    #[test]
    fn no_range_is_empty_and_no_axis_without_labels() {
        let ends = [0.0, -0.0, 1.0, 1e-9, -1e9, 1e300, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324, 1.0 + 1e-15];
        for a in ends {
            for b in ends {
                for axis in
                    [Axis::new("q", "m"), Axis::new("q", "m").starting_at(0.0), Axis::new("q", "m").ending_at(1.0)]
                {
                    let range = Range::new(Some((a.min(b), a.max(b))), &axis, 0.05);
                    assert!(range.low < range.high && (range.high - range.low).is_finite(), "{a} {b} {range:?}");
                    let ticks = ticks(&axis, range, 50.0, 10.0);
                    assert!((1..=12).contains(&ticks.at.len()), "{a} {b} {range:?} {ticks:?}");
                    assert!(ticks.at.iter().all(|t| t.0.is_finite() && t.1.chars().count() < 10), "{ticks:?}");
                }
            }
        }
    }

    #[test]
    fn words_replace_numbers() {
        let axis = Axis::new("valve", "").words([(1.0, "open"), (0.0, "closed"), (9.0, "never")]);
        let at = ticks(&axis, Range { scale: Scale::Linear, low: -0.2, high: 1.2 }, 50.0, 10.0).at;
        assert_eq!(at, [(0.0, "closed".to_string()), (1.0, "open".to_string())]);
    }
}
