//! What all plants have in common, whatever they are.

use mckibben_cli::failure::Failure;

/// How far plants go on, and in how many equal steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Duration in s.
    pub(super) duration: f64,
    pub(super) steps: u64,
}

/// Plants of one kind that go through time together. An error stands with the number of its plant.
pub(super) trait Fleet: Send + Sync {
    /// What is shown of each, by the names of the columns of a run.
    fn columns(&self) -> Vec<String>;

    /// How many valves each has.
    fn valves(&self) -> usize;

    /// All begin at t = 0, as many as there are rows of values.
    fn begin(&mut self, values: &[&[f64]]) -> Result<(), (usize, Failure)>;

    /// One begins anew, with nothing asked of its valves; the others go on.
    fn restart(&mut self, row: usize, values: &[f64]) -> Result<(), Failure>;

    /// Whether the valves can be asked for this: a number for each valve of each plant.
    fn check(&self, asked: &[f64]) -> Result<(), (usize, Failure)>;

    /// Asks this of the valves, which has been checked, and goes on. Those that leave the physics stop there.
    fn step(&mut self, span: Span, asked: &[f64]) -> Result<(), (usize, Failure)>;

    /// Writes what one shows; `false`, and nothing, where it has stopped.
    fn show(&self, row: usize, into: &mut [f64]) -> bool;
}
