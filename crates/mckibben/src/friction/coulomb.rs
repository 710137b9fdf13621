//! Dry friction: Coulomb's, as the paper has it, and what others add to it.
//!
//! ```text
//! F_dry   = F_c · s(v) · sgn(v)
//! F_c     = Q k_sec⁺ + F₀ + A P_g⁺                       Q k_sec is the paper's (12)
//! s(v)    = 1 + (ρ − 1) exp(−(v/v_s)²)                   Stribeck
//! at rest any force between ± ρ F_c
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | Q = μN/k | `width` | m |
//! | F₀ | `force`, the same at any pressure | N |
//! | A | `force_per_pressure` | m² |
//! | ρ | `static_ratio`, of the force at break-away to that in motion; 1 for Coulomb's law | 1 |
//! | v_s | `stribeck_velocity`, over which the force falls from the one to the other | m/s |
//!
//! `x⁺` is the larger of x and zero: with the bladder sucked off the braid nothing presses the threads together.
//! `sgn` is set-valued at zero: the time stepper decides which way it slides, or that it sticks.
//!
//! A force that falls with velocity feeds a load on a spring: below the velocity at which c outweighs the fall,
//! `c < −F_c s′(v)`, motion is by stick and slip.
//!
//! Sources: Colbrunn, Nelson & Quinn (2001), (12); the falling part in this form is that of Armstrong-Hélouvry, Dupont &
//! Canudas de Wit, Automatica 30 (1994). Checked by `tests/friction.rs` and `tests/hysteresis.rs`.

use super::NormalLoad;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};

/// Dry friction of bladder and braid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb<S = f64> {
    width: S,
    /// `F₀` and `A`, where there are such.
    beside: Option<[S; 2]>,
    /// `ρ − 1` and `v_s`, where the force falls with velocity.
    stribeck: Option<[S; 2]>,
    acts: bool,
}

impl Coulomb {
    /// The paper's: a `width` Q in m, zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when it is negative or not finite.
    pub fn new(width: f64) -> Result<Self, Error> {
        let width = parameter::COULOMB_WIDTH.check(width)?;
        Ok(Self { width, beside: None, stribeck: None, acts: width > 0.0 })
    }

    /// Adds a force in N and one for the gauge pressure in m², both zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when one is negative or not finite.
    pub fn with_force(self, force: f64, force_per_pressure: f64) -> Result<Self, Error> {
        let force = parameter::COULOMB_FORCE.check(force)?;
        let force_per_pressure = parameter::COULOMB_FORCE_PER_PRESSURE.check(force_per_pressure)?;
        let is_there = force > 0.0 || force_per_pressure > 0.0;
        let beside = is_there.then_some([force, force_per_pressure]);
        Ok(Self { beside, acts: self.width > 0.0 || is_there, ..self })
    }

    /// Adds a force at break-away that is `static_ratio` (1 or more) times that in motion, and falls to it over
    /// `stribeck_velocity` in m/s.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn with_stribeck(self, static_ratio: f64, stribeck_velocity: f64) -> Result<Self, Error> {
        let excess = parameter::STATIC_RATIO.check(static_ratio)? - 1.0;
        let velocity = parameter::STRIBECK_VELOCITY.check(stribeck_velocity)?;
        Ok(Self { stribeck: (excess > 0.0).then_some([excess, velocity]), ..self })
    }

    /// No dry friction.
    pub const NONE: Self = Self { width: 0.0, beside: None, stribeck: None, acts: false };
}

impl<S: Scalar> Coulomb<S> {
    /// Converts the Coulomb friction to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Coulomb<T> {
        let width = convert.parameter(&parameter::COULOMB_WIDTH, self.width);
        let beside = self.beside.map(|[force, per_pressure]| {
            [
                convert.parameter(&parameter::COULOMB_FORCE, force),
                convert.parameter(&parameter::COULOMB_FORCE_PER_PRESSURE, per_pressure),
            ]
        });
        let stribeck = self.stribeck.map(|[excess, velocity]| {
            let ratio = convert.parameter(&parameter::STATIC_RATIO, excess + S::one());
            [ratio - T::one(), convert.parameter(&parameter::STRIBECK_VELOCITY, velocity)]
        });
        Coulomb { width, beside, stribeck, acts: self.acts }
    }

    /// Whether there is any, and so sticking.
    #[inline(always)]
    pub fn acts(&self) -> bool {
        self.acts
    }

    /// Whether the force falls with velocity.
    #[cfg(feature = "alloc")]
    #[doc(hidden)]
    pub fn falls(&self) -> bool {
        self.acts && self.stribeck.is_some()
    }

    /// The force `F_c` in N, in motion fast enough, by what presses the threads together.
    #[inline(always)]
    pub fn kinetic<T: Over<S>>(&self, pressing: NormalLoad<T>) -> T {
        let bound = T::of(self.width) * pressing.secant_stiffness();
        match self.beside {
            Some([force, per_pressure]) => bound + T::of(force) + T::of(per_pressure) * pressing.gauge(),
            None => bound,
        }
    }

    /// The largest force at rest, of one in motion of `kinetic`, both in N.
    #[inline(always)]
    pub fn holding<T: Over<S>>(&self, kinetic: T) -> T {
        match self.stribeck {
            Some([excess, _]) => kinetic + T::of(excess) * kinetic,
            None => kinetic,
        }
    }

    /// The force in N that slides in a `direction` (−1, 0, +1) at a velocity in m/s, of `kinetic` N when fast enough.
    #[inline(always)]
    pub fn sliding<T: Over<S>>(&self, direction: T, velocity: T, kinetic: T) -> T {
        let force = direction * kinetic;
        match self.stribeck {
            Some([excess, scale]) => {
                let ratio = velocity / T::of(scale);
                force + force * (T::of(excess) * (-(ratio * ratio)).exp())
            }
            None => force,
        }
    }
}

impl<R: Real> Coulomb<R> {
    /// The steepest fall in N·s/m of the force with velocity, `√(2/e) (ρ − 1) F_c/v_s`, at a kinetic force in N; zero where
    /// it does not fall.
    #[cfg(feature = "alloc")]
    pub(crate) fn steepest_fall(&self, kinetic: f64) -> f64 {
        /// `√(2/e)`: the steepest slope of `exp(−x²)`.
        const STEEPEST: f64 = 0.857_763_884_960_706_8;
        self.stribeck.map_or(0.0, |[excess, velocity]| STEEPEST * excess.value() * kinetic / velocity.value())
    }
}
