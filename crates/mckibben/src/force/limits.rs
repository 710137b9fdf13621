//! End effects: the tendon goes slack below the shortest length, the braid is taut above the longest.
//!
//! For the distance `x` between the attachments (10)(11)(14):
//!
//! ```text
//! x < L_min :  F = 0, and the actuator rests at L_min
//! x > L_max :  F_limit = max(0, K_braid (x − L_max) + C_braid v)
//! ```
//!
//! The taut braid never pushes the ends apart on rebound: the sum of its two terms is not allowed below zero. Nor is
//! the whole tension, since a tendon can only pull.
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | L_min, L_max | `min_length`, `max_length` | m |
//! | K_braid | `stiffness` | N/m |
//! | C_braid | `damping` | N·s/m |
//!
//! A braid pulls above `b/√3`, where its angle is below 54.7°, and pushes below. An actuator whose longest length lies
//! below that pushes wherever it is (an extensile muscle); on a tendon, which cannot push, it would never do anything, so
//! such limits are refused. A shortest length below `b/√3` is allowed: there the gas pushes and the tension is zero.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 2.1 and (14). Checked by `tests/force.rs` and `tests/limits.rs`.

use crate::braid::Braid;
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter::{self, Parameter};
use crate::scalar::{Over, Scalar};

/// The lengths between which the braid alone decides, and what happens beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LengthLimits<S = f64> {
    min_length: S,
    max_length: S,
    stiffness: S,
    damping: S,
}

impl LengthLimits {
    /// Limits for `braid`: full contraction at `min_length` (m; `b/√3` when `None`), taut at `max_length` (m), with the
    /// taut braid's `stiffness` (N/m) and `damping` (N·s/m).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] unless
    /// `0 < min_length < max_length < thread length` and `thread length/√3 < max_length`: a braid that pushes wherever it
    /// is does nothing on a tendon.
    pub fn new(
        braid: &Braid,
        min_length: Option<f64>,
        max_length: f64,
        stiffness: f64,
        damping: f64,
    ) -> Result<Self, Error> {
        let max_length = parameter::MAX_LENGTH.check(max_length)?;
        let min_length = parameter::MIN_LENGTH.check(min_length.unwrap_or(braid.neutral_length()))?;
        if max_length >= braid.thread_length() {
            return Err(Error::Inconsistent {
                parameter: &parameter::MAX_LENGTH,
                value: max_length,
                requirement: less_than(&parameter::THREAD_LENGTH, braid.thread_length()),
                remedy: "shorten max_length or give a longer thread",
            });
        }
        if max_length <= braid.neutral_length() {
            return Err(Error::Inconsistent {
                parameter: &parameter::MAX_LENGTH,
                value: max_length,
                requirement: Requirement {
                    relation: "must be greater than",
                    other: "actuator.thread_length/sqrt(3)",
                    value: braid.neutral_length(),
                    unit: "m",
                },
                remedy: "lengthen max_length or shorten the thread: a braid whose angle is above 54.7 degrees at its longest \
                         pushes, and a tendon cannot",
            });
        }
        if min_length >= max_length {
            return Err(Error::Inconsistent {
                parameter: &parameter::MIN_LENGTH,
                value: min_length,
                requirement: less_than(&parameter::MAX_LENGTH, max_length),
                remedy: "shorten min_length",
            });
        }
        Ok(Self {
            min_length,
            max_length,
            stiffness: parameter::LIMIT_STIFFNESS.check(stiffness)?,
            damping: parameter::LIMIT_DAMPING.check(damping)?,
        })
    }
}

fn less_than(other: &'static Parameter, value: f64) -> Requirement {
    Requirement { relation: "must be less than", other: other.key, value, unit: other.unit }
}

impl<S: Scalar> LengthLimits<S> {
    /// Contraction of a length L in m, `(L_max − L)/L_max`: 0 at the longest, rising as the actuator shortens.
    pub fn contraction(&self, length: S) -> S {
        (self.max_length - length) / self.max_length
    }
}

impl<S: Scalar> LengthLimits<S> {
    /// Converts the limits to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> LengthLimits<T> {
        LengthLimits {
            min_length: convert.parameter(&parameter::MIN_LENGTH, self.min_length),
            max_length: convert.parameter(&parameter::MAX_LENGTH, self.max_length),
            stiffness: convert.parameter(&parameter::LIMIT_STIFFNESS, self.stiffness),
            damping: convert.parameter(&parameter::LIMIT_DAMPING, self.damping),
        }
    }

    /// Length of full contraction `L_min` in m.
    #[inline(always)]
    pub fn min_length(&self) -> S {
        self.min_length
    }

    /// Length at which the braid is taut `L_max` in m.
    #[inline(always)]
    pub fn max_length(&self) -> S {
        self.max_length
    }

    /// Stiffness of the taut braid `K_braid` in N/m.
    #[inline(always)]
    pub fn stiffness(&self) -> S {
        self.stiffness
    }

    /// Damping of the taut braid `C_braid` in N·s/m.
    pub fn damping(&self) -> S {
        self.damping
    }

    /// `K_braid (x − L_max) + C_braid v` in N before it is kept from pushing; only meaningful beyond `L_max`.
    #[inline(always)]
    pub fn taut_force<T: Over<S>>(&self, distance: T, velocity: T) -> T {
        T::of(self.stiffness) * (distance - T::of(self.max_length)) + T::of(self.damping) * velocity
    }

    /// `F_limit` in N, (14): zero up to `L_max` and never negative.
    #[inline(always)]
    pub fn force<T: Over<S>>(&self, distance: T, velocity: T) -> T {
        let beyond = T::of(self.max_length).lt(distance);
        T::select(beyond, self.taut_force(distance, velocity).larger(T::zero()), T::zero())
    }

    /// Energy in J stored in the taut braid.
    pub fn stored_energy<T: Over<S>>(&self, distance: T) -> T {
        let stretch = (distance - T::of(self.max_length)).larger(T::zero());
        T::constant(0.5) * T::of(self.stiffness) * stretch * stretch
    }

    /// Whether the tendon is slack at this distance between the attachments.
    #[inline(always)]
    pub fn is_slack<T: Over<S>>(&self, distance: T) -> S::Mask {
        distance.lt(T::of(self.min_length))
    }

    /// Length of the actuator itself in m: the distance, or `L_min` when the tendon is slack.
    #[inline(always)]
    pub fn actuator_length<T: Over<S>>(&self, distance: T) -> T {
        distance.larger(T::of(self.min_length))
    }
}
