//! The ticks of a logarithmic axis.
//!
//! Labels stand at powers of ten, at every second, third, fifth … where all of them have no room. An axis of less than
//! [`SHORT`] decades, or with a single power of ten on it, has 2 and 5 too. Where even these are fewer than two, the labels
//! are those of a linear axis, at their logarithmic places.
//!
//! All labels of a figure are written in one way: as 0.1, 1, 10 from 0.001 to 10000, and as 10⁻⁴, 10⁰, 2·10⁵ where one of
//! them on any of its axes lies beyond.

use super::axis::Axis;
use super::range::Range;
use super::ticks::{Ticks, decimal, label, linear, raised, written};

/// In decades.
const SHORT: f64 = 1.5;
/// The digits with labels on a short axis, and on another one.
const DIGITS: [&[i64]; 2] = [&[1, 2, 5], &[1]];
/// From 2 to 5 and from 5 to 10 is more than from 1 to 2, in decades.
const LEAST_GAP: f64 = std::f64::consts::LOG10_2;
/// From one power of ten with a label to the next.
const STRIDES: [i32; 8] = [1, 2, 3, 5, 10, 20, 50, 100];
/// The powers of ten that are written out.
const PLAIN: std::ops::RangeInclusive<i32> = -3..=4;
/// The least length of a decade in pt with minor ticks, which leaves 0.9 pt from 9 to 10; and of a decade that is one.
const MINOR: (f64, f64) = (20.0, 3.0);

/// The ticks of an axis of a length, whose labels need a spacing, both in pt. There are at least two.
pub(super) fn logarithmic(axis: &Axis, range: Range, length: f64, spacing: f64, powers_of_ten: bool) -> Ticks {
    let decade = length / (range.high - range.low);
    let powers = within(range, &[1], 1).len();
    let mut choices: Vec<(f64, Vec<(i64, i32)>)> =
        STRIDES.iter().map(|stride| (f64::from(*stride), within(range, DIGITS[1], *stride))).collect();
    if range.high - range.low < SHORT || powers < 2 {
        choices.insert(0, (LEAST_GAP, within(range, DIGITS[0], 1)));
    }
    choices.retain(|(_, ticks)| ticks.len() > 1);
    let roomy = choices.iter().position(|(gap, _)| gap * decade >= spacing);
    let labelled = match (roomy, choices.pop()) {
        (Some(index), Some(last)) => choices.into_iter().nth(index).unwrap_or(last).1,
        // No room for any of them: the first and the last, which are farthest apart.
        (None, Some((_, ticks))) => ticks.first().into_iter().chain(ticks.last()).copied().collect(),
        (_, None) => Vec::new(),
    };
    let plain = !powers_of_ten && labelled.iter().all(|(_, k)| PLAIN.contains(k));
    let text = |n: i64, k: i32| match (plain, n) {
        (true, _) => written(n, k),
        (false, 1) => format!("10{}", raised(k)),
        (false, _) => format!("{n}·10{}", raised(k)),
    };
    let mut ticks = match labelled.is_empty() {
        true => even(axis, range, length / spacing),
        false => Ticks {
            at: labelled.into_iter().map(|(n, k)| (decimal(n, k), text(n, k))).collect(),
            minor: Vec::new(),
            label: label(axis, None, 0),
        },
    };
    let minor = match decade {
        decade if decade >= MINOR.0 => within(range, &[1, 2, 3, 4, 5, 6, 7, 8, 9], 1),
        decade if decade >= MINOR.1 => within(range, &[1], 1),
        _ => Vec::new(),
    };
    let minor = minor.into_iter().map(|(n, k)| decimal(n, k));
    ticks.minor = minor.filter(|value| ticks.at.iter().all(|(labelled, _)| labelled != value)).collect();
    ticks
}

/// About `most` ticks at equal differences, and at least two.
fn even(axis: &Axis, range: Range, most: f64) -> Ticks {
    let of = |finer: f64| linear(axis, range.ends(), finer * most.max(2.0));
    [1.0, 2.0].map(of).into_iter().find(|ticks| ticks.at.len() > 1).unwrap_or_else(|| of(4.0))
}

/// The values n·10^k within a range, rising, with k a multiple of a stride.
fn within(range: Range, digits: &[i64], stride: i32) -> Vec<(i64, i32)> {
    let (first, last) = (range.low.floor() as i32, range.high.ceil() as i32);
    let powers = (first..=last).filter(|k| k % stride == 0);
    let all = powers.flat_map(|k| digits.iter().map(move |n| (*n, k)));
    // The slack admits an end that is a power of ten but for rounding.
    all.filter(|(n, k)| range.contains(decimal(*n, *k), 1e-9)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(low: f64, high: f64, length: f64) -> Ticks {
        let axis = Axis::logarithmic("gain", "mm").starting_at(low).ending_at(high);
        logarithmic(&axis, Range::new(None, &axis, 0.0), length, 15.0, false)
    }

    #[test]
    fn labels_stand_at_round_values() {
        let cases: [(f64, f64, f64, &[&str]); 15] = [
            (0.01, 1000.0, 100.0, &["0.01", "0.1", "1", "10", "100", "1000"]),
            (1e-3, 1e4, 200.0, &["0.001", "0.01", "0.1", "1", "10", "100", "1000", "10000"]),
            (1.0, 1e5, 100.0, &["10⁰", "10¹", "10²", "10³", "10⁴", "10⁵"]),
            (0.03, 300.0, 100.0, &["0.1", "1", "10", "100"]),
            // No room for every power of ten.
            (1e-8, 2.0, 100.0, &["10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"]),
            (1e-300, 1e300, 100.0, &["10⁻³⁰⁰", "10⁻²⁰⁰", "10⁻¹⁰⁰", "10⁰", "10¹⁰⁰", "10²⁰⁰", "10³⁰⁰"]),
            // Less than 1.5 decades.
            (1.0, 20.0, 100.0, &["1", "2", "5", "10", "20"]),
            (0.03, 0.8, 100.0, &["0.05", "0.1", "0.2", "0.5"]),
            (3e5, 3e6, 100.0, &["5·10⁵", "10⁶", "2·10⁶"]),
            // One power of ten only.
            (0.2, 9.0, 100.0, &["0.2", "0.5", "1", "2", "5"]),
            // Within a decade, without two of 1, 2, 5.
            (6.0, 9.5, 100.0, &["6", "7", "8", "9"]),
            (30.0, 95.0, 100.0, &["30", "40", "50", "60", "70", "80", "90"]),
            (1.01, 1.04, 100.0, &["1.010", "1.015", "1.020", "1.025", "1.030", "1.035", "1.040"]),
            // No room at all.
            (1.0, 20.0, 12.0, &["1", "10"]),
            (6.0, 9.5, 12.0, &["6", "8"]),
        ];
        for (low, high, length, expected) in cases {
            let ticks = of(low, high, length);
            let labels: Vec<&str> = ticks.at.iter().map(|tick| tick.1.as_str()).collect();
            assert_eq!(labels, expected, "{low} to {high}");
            assert_eq!(ticks.label, "gain (mm)");
        }
    }

    #[test]
    fn minor_ticks_stand_between_labels() {
        let minor = |low, high, length| of(low, high, length).minor;
        assert_eq!(minor(1.0, 100.0, 100.0)[..8], [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        assert_eq!(minor(1.0, 100.0, 100.0).len(), 16);
        assert_eq!(minor(1.0, 10.0, 100.0), [3.0, 4.0, 6.0, 7.0, 8.0, 9.0]);
        // Decades of 10 pt are minor ticks where they have no label; those of 1 pt are not.
        assert_eq!(minor(1e-2, 1e8, 100.0), [0.1, 10.0, 1e3, 1e5, 1e7]);
        assert!(minor(1e-50, 1e50, 100.0).is_empty());
    }

    #[test]
    fn every_axis_has_at_least_two_labels_and_not_too_many() {
        let ends = [1e-320, 1e-300, 3e-7, 0.99, 1.0, 1.0 + 1e-15, 1.001, 1.7, 9.9, 10.0, 101.0, 7e22, 1e300, f64::MAX];
        for (index, low) in ends.iter().enumerate() {
            for high in &ends[index..] {
                for pad in [0.0, 0.06] {
                    for length in [11.0, 40.0, 90.0, 700.0] {
                        let axis = Axis::logarithmic("gain", "");
                        let range = Range::new(Some((*low, *high)), &axis, pad);
                        let ticks = logarithmic(&axis, range, length, 15.5, false);
                        let case = format!("{low} {high} {length} {ticks:?}");
                        assert!(ticks.at.len() >= 2 && ticks.at.len() as f64 <= (length / 10.0).max(4.0), "{case}");
                        assert!(ticks.at.windows(2).all(|pair| pair[0].0 < pair[1].0), "{case}");
                        assert!(ticks.at.iter().all(|(at, _)| range.contains(*at, 1e-6)), "{case}");
                        assert!(ticks.minor.len() < 400, "{case}");
                    }
                }
            }
        }
    }
}
