//! What a batch goes through in one go.

/// Steps from one time in s on, by the times in s at which they end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span<'s> {
    pub(crate) from: f64,
    /// Rising.
    pub(crate) ends: &'s [f64],
    /// Where the ends that a host moves go meanwhile, in m: for each coordinate of each row. They stay where none are given.
    pub(crate) distances: Option<&'s [f64]>,
}

impl Span<'_> {
    /// The time in s at which it ends.
    pub(crate) fn until(&self) -> f64 {
        self.ends.last().copied().unwrap_or(self.from)
    }
}
