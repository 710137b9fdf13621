//! Progress of searches, and what ends them from outside: an interruption or a limit of time.

use super::Ending;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Follows searches from another thread, and ends them. Clones share one state.
#[derive(Clone, Debug, Default)]
pub struct Monitor(Arc<State>);

#[derive(Debug)]
struct State {
    stopped: AtomicBool,
    evaluations: AtomicU64,
    made: Instant,
    /// When searches end, in ns after it was made.
    until: AtomicU64,
}

impl Default for State {
    fn default() -> Self {
        Self {
            stopped: AtomicBool::new(false),
            evaluations: AtomicU64::new(0),
            made: Instant::now(),
            until: AtomicU64::new(u64::MAX),
        }
    }
}

impl Monitor {
    /// Ends every search that has this monitor, at its next evaluation of the model.
    pub fn stop(&self) {
        self.0.stopped.store(true, Ordering::Relaxed);
    }

    /// Ends every search that has this monitor after so long from now.
    pub fn stop_after(&self, time: Duration) {
        let until = self.0.made.elapsed().saturating_add(time).as_nanos();
        self.0.until.store(u64::try_from(until).unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    /// Whether searches are to end.
    pub fn is_stopped(&self) -> bool {
        self.ending().is_some()
    }

    /// What ends searches, if something does: [`Ending::Interrupted`] or [`Ending::Time`].
    pub fn ending(&self) -> Option<Ending> {
        if self.0.stopped.load(Ordering::Relaxed) {
            return Some(Ending::Interrupted);
        }
        let until = self.0.until.load(Ordering::Relaxed);
        (until != u64::MAX && self.0.made.elapsed().as_nanos() >= u128::from(until)).then_some(Ending::Time)
    }

    /// How often models have been evaluated so far.
    pub fn evaluations(&self) -> u64 {
        self.0.evaluations.load(Ordering::Relaxed)
    }

    /// Counts an evaluation; `false` where the search is to end.
    pub fn goes_on(&self) -> bool {
        self.0.evaluations.fetch_add(1, Ordering::Relaxed);
        !self.is_stopped()
    }
}
