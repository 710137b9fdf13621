//! A range from one value to another, evenly spaced in the value or in its logarithm.

use crate::choice::Spacing;

/// The ends of a range in SI, in either order; both above zero when the spacing is logarithmic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) spacing: Spacing,
}

impl Ends {
    /// The value at a share of the way from one end to the other; at 0 and 1 the ends to the bit.
    pub(super) fn at(&self, share: f64) -> f64 {
        let Self { from, to, spacing } = *self;
        if share == 1.0 {
            return to;
        }
        let value = match spacing {
            Spacing::Linear => from + (to - from) * share,
            Spacing::Logarithmic => from * (to / from).powf(share),
        };
        // A rounding must not carry the value past an end, which may be the end of what is admissible.
        value.clamp(from.min(to), from.max(to))
    }

    /// The value of a step, counted from 0, when the range has `count` of them; the first is `from`, the last `to`.
    pub(super) fn step(&self, step: u64, count: u64) -> f64 {
        if step == 0 { self.from } else { self.at(step as f64 / (count - 1) as f64) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_even_and_end_at_the_ends() {
        let linear = Ends { from: 0.1, to: 0.7, spacing: Spacing::Linear };
        assert_eq!(
            [0, 1, 2, 3].map(|step| linear.step(step, 4)).map(|value| (value * 1e12).round()),
            [1e11, 3e11, 5e11, 7e11]
        );
        assert_eq!((linear.step(0, 4), linear.step(3, 4), linear.step(0, 1)), (0.1, 0.7, 0.1));
        let falling = Ends { from: 1000.0, to: 1.0, spacing: Spacing::Logarithmic };
        for (step, expected) in [1000.0, 100.0, 10.0, 1.0].into_iter().enumerate() {
            assert!((falling.step(step as u64, 4) / expected - 1.0_f64).abs() < 1e-14);
        }
    }
}
