//! The range of an axis, from the data and from the ends that the axis fixes, on a linear or a logarithmic scale.
//!
//! A range is kept in coordinates of the scale, so that margins, places and the drawn lengths follow one rule for both
//! scales and both directions.

use super::axis::{Axis, Scale};

/// Larger values are drawn as if they were this: differences of two such still are numbers.
const HUGE: f64 = 1e300;
/// Differences below this are none: their reciprocals would not be numbers.
const TINY: f64 = 1e-290;
/// Logarithms beyond this, and differences of logarithms below that, are drawn as if they were these.
const DECADES: (f64, f64) = (300.0, 1e-12);

/// An interval of an axis with `low < high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    /// The scale of the axis.
    pub(super) scale: Scale,
    /// The coordinates of the ends on the scale.
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Range {
    /// The range of an axis over data between the two values of `length_regime`, with a margin of `pad` times the span on
    /// each side that the axis does not fix. What hardly changes is shown as a level line in the middle. The values
    /// have places on the scale of the axis.
    pub(super) fn new(length_regime: Option<(f64, f64)>, axis: &Axis, pad: f64) -> Self {
        let scale = axis.scale;
        let coordinate = |value: f64| match scale {
            Scale::Linear => value.clamp(-HUGE, HUGE),
            Scale::Logarithmic => scale.coordinate(value).clamp(-DECADES.0, DECADES.0),
        };
        let (low, high) = length_regime.map_or((0.0, 1.0), |(low, high)| (coordinate(low), coordinate(high)));
        let (span, largest) = (high - low, low.abs().max(high.abs()));
        let margin = match scale {
            Scale::Linear if span >= TINY && span > 1e-12 * largest => pad * span,
            Scale::Linear if largest < TINY => 1.0,
            Scale::Linear => 0.05 * largest,
            Scale::Logarithmic if span > DECADES.1 => pad * span,
            Scale::Logarithmic => 0.5,
        };
        let low = axis.min.map_or(low - margin, coordinate);
        let high = axis.max.map_or(high + margin, coordinate);
        let (least, width) = match scale {
            Scale::Linear => (TINY.max(1e-14 * low.abs()), if low.abs() < TINY { 1.0 } else { 0.1 * low.abs() }),
            Scale::Logarithmic => (DECADES.1, 1.0),
        };
        let (low, high) = match high - low > least {
            true => (low, high),
            // The data lie wholly beyond the end that the axis fixes: an empty interval next to that end.
            false if axis.min.is_some() => (low, low + width),
            false => (high - width, high),
        };
        Self { scale, low, high }
    }

    /// Where a value lies, 0 at the low end and 1 at the high one. A value that is too low for the scale lies infinitely
    /// far below.
    pub(super) fn place(&self, value: f64) -> f64 {
        (self.scale.coordinate(value) - self.low) / (self.high - self.low)
    }

    /// Whether a value lies between the ends, with a share of the span beyond each.
    pub(super) fn contains(&self, value: f64, beyond: f64) -> bool {
        (-beyond..=1.0 + beyond).contains(&self.place(value))
    }

    /// The values at the ends.
    pub(super) fn ends(&self) -> (f64, f64) {
        (self.scale.value(self.low), self.scale.value(self.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_line_lies_in_the_middle() {
        let range = Range::new(Some((200.0, 200.0)), &Axis::default(), 0.05);
        assert_eq!((range.low, range.high), (190.0, 210.0));
        assert_eq!(range.place(200.0), 0.5);
        let zero = Range::new(Some((0.0, 0.0)), &Axis::default(), 0.05);
        assert_eq!((zero.low, zero.high), (-1.0, 1.0));
        let decade = Range::new(Some((100.0, 100.0)), &Axis::logarithmic("", ""), 0.05);
        assert_eq!((decade.low, decade.high, decade.place(100.0)), (1.5, 2.5, 0.5));
    }

    /// `(log v − log low) / (log high − log low)`.
    #[test]
    fn equal_ratios_are_equally_long() {
        let range = Range::new(None, &Axis::logarithmic("", "").starting_at(0.1).ending_at(1000.0), 0.0);
        for (value, place) in [(0.1, 0.0), (1.0, 0.25), (10.0, 0.5), (20.0, 0.575_257_498_915_995), (1000.0, 1.0)] {
            assert!((range.place(value) - place).abs() < 1e-14, "{value}: {}", range.place(value));
        }
        assert_eq!([0.0, -5.0].map(|value| range.place(value)), [f64::NEG_INFINITY; 2]);
        assert!(range.place(f64::NAN).is_nan() && !range.contains(f64::NAN, 0.0));
    }

    #[test]
    fn the_margin_is_a_share_of_the_drawn_length() {
        let range = Range::new(Some((1.0, 100.0)), &Axis::logarithmic("", ""), 0.05);
        assert!((range.low + 0.1).abs() < 1e-14 && (range.high - 2.1).abs() < 1e-14, "{range:?}");
        let (low, high) = range.ends();
        assert!((low - 10_f64.powf(-0.1)).abs() < 1e-14 && (high / 10_f64.powf(2.1) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn data_beyond_a_fixed_end_leave_a_decade_next_to_it() {
        let axis = Axis::logarithmic("", "").starting_at(100.0);
        assert_eq!(Range::new(Some((1.0, 5.0)), &axis, 0.0).ends(), (100.0, 1000.0));
        let axis = Axis::logarithmic("", "").ending_at(100.0);
        assert_eq!(Range::new(Some((1e4, 1e5)), &axis, 0.0).ends(), (10.0, 100.0));
    }
}
