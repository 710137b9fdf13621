//! The clock of plants that go on by equal spans.

/// How far plants go on, and in how many equal steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    /// Duration in s.
    pub(crate) duration: f64,
    pub(crate) steps: u64,
}

/// Numbers of a clock: its origin and the duration of a span in s, and how many spans have passed.
pub(crate) const PACE_PARTS: usize = 3;

/// A clock that is not summed: after as many equal spans it is at as many times a span.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pace {
    origin: f64,
    duration: f64,
    count: u64,
}

impl Pace {
    /// The clock of a saved state; none where its numbers are those of no clock.
    pub(crate) fn of_parts([origin, duration, count]: [f64; PACE_PARTS]) -> Option<Self> {
        // Up to 2⁵³ a float holds each whole number.
        let is_clock = origin.is_finite() && duration.is_finite() && origin >= 0.0 && duration >= 0.0;
        let is_count = (0.0..=9_007_199_254_740_992.0).contains(&count) && count.fract() == 0.0;
        (is_clock && is_count).then_some(Self { origin, duration, count: count as u64 })
    }

    /// What a saved state holds of the clock: a clock that began at its time would round later times in another way.
    pub(crate) fn parts(&self) -> [f64; PACE_PARTS] {
        [self.origin, self.duration, self.count as f64]
    }

    /// The clock after another span.
    #[must_use]
    pub(crate) fn on(&self, Span { duration, .. }: Span) -> Self {
        match duration == self.duration {
            true => Self { count: self.count + 1, ..*self },
            false => Self { origin: self.now(), duration, count: 1 },
        }
    }

    /// The end in s of a step within the last span, as those of a run from the origin by steps of that length.
    pub(crate) fn within(&self, Span { duration, steps }: Span, step: u64) -> f64 {
        match step < steps {
            true => self.origin + ((self.count - 1) * steps + step) as f64 * (duration / steps as f64),
            false => self.now(),
        }
    }

    /// The time in s.
    pub(crate) fn now(&self) -> f64 {
        self.origin + self.count as f64 * self.duration
    }
}
