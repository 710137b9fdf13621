//! A straight line in time, such as a piece of a table between two of its rows.
//!
//! ```text
//! x(t) = x₀ + s (t − t₀)
//! ```
//!
//! | symbol | name in code | |
//! |---|---|---|
//! | t₀, x₀ | `start`, `from` | where it begins; in s, and in the unit of x |
//! | s | `slope` | its rate in that unit over s; zero of what stays |

use crate::scalar::{Over, Scalar};

/// A straight line in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightLine<S = f64> {
    /// When it begins, in s.
    pub start: S,
    /// Its value then.
    pub from: S,
    /// Its rate in 1/s.
    pub slope: S,
}

impl<S: Scalar> StraightLine<S> {
    /// What stays.
    pub fn constant(value: S) -> Self {
        Self { start: S::zero(), from: value, slope: S::zero() }
    }

    /// From one row of a table to another, each a time in s and a value.
    pub fn between([start, from]: [S; 2], [end, to]: [S; 2]) -> Self {
        Self { start, from, slope: (to - from) / (end - start) }
    }

    /// Value and rate at a time in s.
    #[inline(always)]
    pub fn at<T: Over<S>>(&self, time: T) -> [T; 2] {
        let slope = T::of(self.slope);
        [T::of(self.from) + slope * (time - T::of(self.start)), slope]
    }
}
