//! What all plants have in common, whatever they are.

use mckibben_cli::failure::Failure;

/// How far plants go on, and in how many equal steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Duration in s.
    pub(super) duration: f64,
    pub(super) steps: u64,
}

/// A clock that is not summed: after as many equal spans it shows what as many times a span is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    origin: f64,
    duration: f64,
    count: u64,
}

impl Pace {
    /// The clock after another span.
    #[must_use]
    pub(super) fn on(&self, Span { duration, .. }: Span) -> Self {
        match duration == self.duration {
            true => Self { count: self.count + 1, ..*self },
            false => Self { origin: self.now(), duration, count: 1 },
        }
    }

    /// The time in s that it shows.
    pub(super) fn now(&self) -> f64 {
        self.origin + self.count as f64 * self.duration
    }
}

/// Plants of one kind that go through time together. An error stands with the number of its plant.
pub(super) trait Fleet: Send + Sync {
    /// What is shown of each, by the names of the columns of a run.
    fn columns(&self) -> Vec<String>;

    /// How many valves each has.
    fn valves(&self) -> usize;

    /// Bytes that each takes at least.
    fn bytes(&self) -> usize;

    /// All begin at t = 0, as many as there are rows of values.
    fn begin(&mut self, values: &[&[f64]]) -> Result<(), (usize, Failure)>;

    /// Some begin anew, with nothing asked of their valves; the others go on.
    fn restart(&mut self, rows: &[(usize, &[f64])]) -> Result<(), (usize, Failure)>;

    /// Whether the valves can be asked for this: a number for each valve of each plant.
    fn check(&self, asked: &[f64]) -> Result<(), (usize, Failure)>;

    /// Asks this of the valves, which has been checked, goes on, and writes what each shows, and which have left the physics and
    /// stopped: of those nothing is written.
    fn step(&mut self, span: Span, asked: &[f64], shown: &mut [f64], stopped: &mut [bool]);

    /// Whether plants with these two sets of values differ in anything but the commands of their valves.
    fn differ(&self, values: [&[f64]; 2]) -> Result<bool, Failure>;

    /// The time in s of one plant, which its pulses follow.
    fn time(&self, row: usize) -> f64;

    /// Writes what one shows; nothing where it has stopped.
    fn show(&self, row: usize, into: &mut [f64]);
}
