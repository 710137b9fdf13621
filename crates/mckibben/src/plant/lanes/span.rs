//! What a batch goes through in one go.

/// Steps from one time in s on, by the times in s at which they end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span<'s> {
    pub(super) from: f64,
    /// Rising.
    pub(super) ends: &'s [f64],
}

impl Span<'_> {
    /// The time in s at which it ends.
    pub(super) fn until(&self) -> f64 {
        self.ends.last().copied().unwrap_or(self.from)
    }
}
