//! What a batch goes through in one go.

/// Equal steps from one time in s to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) until: f64,
    pub(super) steps: u64,
}

impl Span {
    /// The time in s at the end of a step, counted from one.
    pub(super) fn end_of(&self, step: u64) -> f64 {
        if step == self.steps {
            self.until
        } else {
            self.from + (self.until - self.from) * (step as f64 / self.steps as f64)
        }
    }
}
