//! How far the flow paths are open, as a known function of time until the next instant.
//!
//! ```text
//! ṁ = λ_supply(t) · ṁ_supply(open) + λ_exhaust(t) · ṁ_exhaust(open)
//! ```
//!
//! Of poppets under way ([`Ramp`](super::Ramp)) λ is a straight line; of a spool ([`Spool`]) it follows the closed form of its
//! motion between its edges. The instants at which that ends, or turns into another, are known beforehand, so that within
//! a part of a run between two of them every λ is smooth.
//!
//! Checked by `tests/ramped_rig.rs` and `tests/spool_rig.rs`.

use super::ramp::Stroke;
use super::solenoid::ValveKind;
use super::spool::{Spool, SpoolMotion};
use crate::scalar::{Over, Scalar};

/// Openings of the flow paths to the supply and to the atmosphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Openings<S = f64> {
    /// Each wholly or not at all, as the [`Ports`](super::Ports) say.
    Whole,
    /// Shares that stay the same.
    Shares([S; 2]),
    /// By poppets, of which at least one is under way.
    Poppets {
        /// How the flow paths are arranged.
        kind: ValveKind,
        /// The strokes of both poppets; of most kinds the first alone counts.
        strokes: [Stroke<S>; 2],
    },
    /// By a spool under way.
    Spool {
        /// The spool.
        spool: Spool<S>,
        /// Its motion, in which no stop is met.
        motion: SpoolMotion<S>,
    },
}

impl<S: Scalar> Openings<S> {
    /// The shares λ of the flow paths to the supply and to the atmosphere at a time in s; none where they are whole.
    #[inline(always)]
    pub fn at<T: Over<S>>(&self, time: T) -> Option<[T; 2]> {
        match self {
            Self::Whole => None,
            Self::Shares(shares) => Some(shares.map(T::of)),
            Self::Poppets { kind, strokes } => Some(kind.shares(strokes.map(|stroke| stroke.opening(time)))),
            Self::Spool { spool, motion } => Some(spool.openings(spool.at(motion, time)[0])),
        }
    }
}
