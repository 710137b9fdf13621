//! The clock of plants that go on by equal spans.

/// How far plants go on, and in how many equal steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    /// Duration in s.
    pub(crate) duration: f64,
    pub(crate) steps: u64,
}

/// Origin and duration of a span of a clock in s, and how many spans have passed.
pub(crate) type PaceParts = (f64, f64, u64);

/// A clock that is not summed: after as many equal spans it is at as many times a span.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pace {
    origin: f64,
    duration: f64,
    count: u64,
}

impl Pace {
    /// The clock at a time in s.
    pub(crate) fn at(origin: f64) -> Self {
        Self { origin, ..Self::default() }
    }

    /// The clock of a pickle.
    pub(crate) fn of_parts((origin, duration, count): PaceParts) -> Self {
        Self { origin, duration, count }
    }

    /// What a pickle holds of the clock.
    pub(crate) fn parts(&self) -> PaceParts {
        (self.origin, self.duration, self.count)
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
