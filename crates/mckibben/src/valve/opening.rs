//! How far the passages are open, and to what, as a known function of time until the next instant.
//!
//! ```text
//! ṁ = λ_supply(t) · ṁ_supply(open) + λ_exhaust(t) · ṁ_exhaust(open)
//! ```
//!
//! Of seats under way ([`Ramp`](super::Ramp)) λ is a straight line; of a spool ([`Spool`]) it follows the closed form of its
//! motion between its edges. Of a pressure regulator ([`Regulator`]) λ is one, and what is known is the pressure beyond the
//! passage. The instants at which that ends, or turns into another, are
//! known beforehand, so that within a part of a run between two of them every λ and that pressure are smooth.
//!
//! Checked by `tests/ramped_rig.rs`, `tests/spool_rig.rs` and `tests/regulated_rig.rs`.

use super::ramp::Stroke;
use super::regulator::{Regulated, Regulator};
use super::solenoid::ValveKind;
use super::spool::{Spool, SpoolMotion};
use crate::scalar::{Over, Scalar};

/// How far the passages to the supply and to the surroundings are open, and to what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Openings<S = f64> {
    /// Each wholly or not at all, as the [`Ports`](super::Ports) say.
    Whole,
    /// Shares that stay the same.
    Shares([S; 2]),
    /// By seats, of which at least one is under way.
    Seats {
        /// How the passages are arranged.
        kind: ValveKind,
        /// The strokes of both seats; of most kinds the first alone counts.
        strokes: [Stroke<S>; 2],
    },
    /// By a spool under way.
    Spool {
        /// The spool.
        spool: Spool<S>,
        /// Its motion, in which no stop is met.
        motion: SpoolMotion<S>,
    },
    /// Wholly, to what a pressure regulator makes.
    Regulated {
        /// The regulator.
        regulator: Regulator<S>,
        /// Its pressure, of which no set point changes the course.
        course: Regulated<S>,
    },
    /// Wholly, to an absolute pressure in Pa that stays the same.
    At(S),
}

impl<S: Scalar> Openings<S> {
    /// The shares λ of the passages to the supply and to the surroundings at a time in s; none where they are whole.
    #[inline(always)]
    pub fn at<T: Over<S>>(&self, time: T) -> Option<[T; 2]> {
        match self {
            Self::Whole | Self::Regulated { .. } | Self::At(_) => None,
            Self::Shares(shares) => Some(shares.map(T::of)),
            Self::Seats { kind, strokes } => Some(kind.shares(strokes.map(|stroke| stroke.opening(time)))),
            Self::Spool { spool, motion } => Some(spool.openings(spool.at(motion, time)[0])),
        }
    }

    /// The absolute pressure in Pa beyond the passage at a time in s; none where it is the supply's.
    #[inline(always)]
    pub fn pressure<T: Over<S>>(&self, time: T) -> Option<T> {
        match self {
            Self::Regulated { regulator, course } => Some(regulator.pressure(course, time)),
            Self::At(pressure) => Some(T::of(*pressure)),
            Self::Whole | Self::Shares(_) | Self::Seats { .. } | Self::Spool { .. } => None,
        }
    }

    /// The same for a stable step of `step` s from a time in s, where the pressure beyond the passage changes: with that
    /// of the middle of the step. So the order stays 2, and no flow overshoots the port.
    #[inline(always)]
    pub(crate) fn midway(&self, time: S, step: S) -> Option<Self> {
        self.pressure(step.multiply_add(S::constant(0.5), time)).map(Self::At)
    }

    /// The shares that they come to at a time in s, where they are under way.
    #[inline(always)]
    pub(crate) fn come_to(&self, time: S) -> Option<Self> {
        self.at(time).map(Self::Shares)
    }

    /// The same over another scalar.
    pub(crate) fn map<T: Scalar>(&self, number: impl Fn(S) -> T) -> Openings<T> {
        match self {
            Self::Whole => Openings::Whole,
            Self::Shares(shares) => Openings::Shares(shares.map(number)),
            Self::Seats { kind, strokes } => {
                Openings::Seats { kind: *kind, strokes: strokes.map(|stroke| stroke.map(&number)) }
            }
            Self::Spool { spool, motion } => Openings::Spool { spool: spool.map(&number), motion: motion.map(&number) },
            Self::Regulated { regulator, course } => {
                Openings::Regulated { regulator: regulator.map(&number), course: course.map(&number) }
            }
            Self::At(pressure) => Openings::At(number(*pressure)),
        }
    }
}
