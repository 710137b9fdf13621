//! Friction: what the actuator loses in motion (12).
//!
//! ```text
//! F_friction = c v + Q k_sec sgn(v)       (12)
//! k_sec      = secant stiffness           (13)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | c | `viscous` | N·s/m |
//! | Q = μN/k | width of [`Coulomb`] | m |
//! | k_sec | `secant_stiffness` | N/m |
//!
//! That is the paper's law, and the default. Beside it stand what other authors put in place of its last term: a force that
//! falls with velocity or has another scale ([`Coulomb`]), and hysteresis that remembers ([`Hysteresis`]).
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3; Q and c are averages of its ring-down tests.
//! Checked by `tests/friction.rs`: decrement 4Q per cycle, exponential decay, never negative dissipation; and
//! `tests/hysteresis.rs`, `tests/bouc_wen.rs` and `tests/lugre.rs`.

mod bouc_wen;
mod coulomb;
#[cfg(feature = "alloc")]
mod initial;
mod lugre;
mod maxwell_slip;
mod memory;

pub use bouc_wen::BoucWen;
pub use coulomb::Coulomb;
pub use lugre::LuGre;
pub use maxwell_slip::MaxwellSlip;
pub use memory::{Branch, Hysteresis, MAX_ELEMENTS, Memory};

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// Friction of bladder and braid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<S = f64> {
    viscous: S,
    coulomb: Coulomb<S>,
    hysteresis: Option<Hysteresis<S>>,
}

/// What friction depends on beside the state of the actuator: how it slides, and what it remembers.
#[derive(Clone, Copy, Debug)]
pub struct SlidingState<T> {
    /// Direction of sliding: −1 shortening, 0 at rest, +1 lengthening.
    pub direction: T,
    /// Force of the hysteresis over the secant stiffness in m, where there is such a law.
    pub width: Option<T>,
    /// Whether the gas presses the threads together.
    pub touch: ThreadContact,
}

/// Whether the gas presses the threads together: with the bladder sucked off the braid they do not rub.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThreadContact {
    /// Where the gauge pressure is above zero.
    ByPressure,
    /// They are pressed, by a formula that goes on smoothly below zero gauge pressure.
    Pressed,
    /// They are not.
    Apart,
}

/// What presses the threads together.
#[derive(Clone, Copy, Debug)]
pub struct NormalLoad<T> {
    secant_stiffness: T,
    gauge: T,
    touch: ThreadContact,
}

impl<T: Scalar> NormalLoad<T> {
    /// By a secant stiffness (N/m) and a gauge pressure (Pa).
    #[inline(always)]
    pub fn new(secant_stiffness: T, gauge: T, touch: ThreadContact) -> Self {
        Self { secant_stiffness, gauge, touch }
    }

    /// Secant stiffness `k_sec⁺` in N/m.
    #[inline(always)]
    pub fn secant_stiffness(&self) -> T {
        self.part(self.secant_stiffness)
    }

    /// Gauge pressure `P_g⁺` in Pa.
    #[inline(always)]
    pub fn gauge(&self) -> T {
        self.part(self.gauge)
    }

    #[inline(always)]
    fn part(&self, number: T) -> T {
        match self.touch {
            ThreadContact::ByPressure => number.larger(T::zero()),
            ThreadContact::Pressed => number,
            ThreadContact::Apart => T::zero(),
        }
    }
}

impl<T: Scalar> From<T> for SlidingState<T> {
    /// A direction of sliding without hysteresis.
    #[inline(always)]
    fn from(direction: T) -> Self {
        Self { direction, width: None, touch: ThreadContact::ByPressure }
    }
}

impl Friction {
    /// The paper's: `viscous` damping `c` in N·s/m and `coulomb_width` `Q` in m, both zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when one is negative or not finite.
    pub fn new(viscous: f64, coulomb_width: f64) -> Result<Self, Error> {
        Self::with_coulomb(viscous, Coulomb::new(coulomb_width)?)
    }

    /// `viscous` damping in N·s/m, zero or more, and a law of dry friction.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when the damping is negative or not finite.
    pub fn with_coulomb(viscous: f64, coulomb: Coulomb) -> Result<Self, Error> {
        Ok(Self { viscous: parameter::VISCOUS.check(viscous)?, coulomb, hysteresis: None })
    }

    /// The same with a law of hysteresis beside.
    pub fn with_hysteresis(self, hysteresis: Hysteresis) -> Self {
        Self { hysteresis: Some(hysteresis), ..self }
    }

    /// No friction.
    pub const NONE: Self = Self { viscous: 0.0, coulomb: Coulomb::NONE, hysteresis: None };
}

impl<S: Scalar> Friction<S> {
    /// The same friction over another scalar.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Friction<T> {
        Friction {
            viscous: convert.parameter(&parameter::VISCOUS, self.viscous),
            coulomb: self.coulomb.convert(convert),
            hysteresis: self.hysteresis.as_ref().map(|hysteresis| hysteresis.convert(convert)),
        }
    }

    /// Whether there is dry friction, and so sticking.
    #[inline(always)]
    pub fn has_coulomb(&self) -> bool {
        self.coulomb.acts()
    }

    /// Whether the force depends on the direction of motion.
    #[inline(always)]
    pub fn has_direction(&self) -> bool {
        self.has_coulomb() || self.hysteresis.is_some()
    }

    /// Viscous damping `c` in N·s/m.
    pub fn viscous(&self) -> S {
        self.viscous
    }

    /// The dry friction.
    #[inline(always)]
    pub fn coulomb(&self) -> &Coulomb<S> {
        &self.coulomb
    }

    /// The hysteresis, if there is any.
    #[inline(always)]
    pub fn hysteresis(&self) -> Option<&Hysteresis<S>> {
        self.hysteresis.as_ref()
    }

    /// LuGre's law, if that is the hysteresis.
    #[inline(always)]
    pub fn lugre(&self) -> Option<&LuGre<S>> {
        match &self.hysteresis {
            Some(Hysteresis::LuGre(law)) => Some(law),
            _ => None,
        }
    }

    /// Viscous part `c v` in N.
    #[inline(always)]
    pub fn viscous_force<T: Over<S>>(&self, velocity: T) -> T {
        T::of(self.viscous) * velocity
    }

    /// Everything but the viscous part in N, at a velocity (m/s).
    #[inline(always)]
    pub fn dry_force<T: Over<S>>(&self, rubbing: SlidingState<T>, velocity: T, pressing: NormalLoad<T>) -> T {
        let mut force = T::zero();
        if self.has_coulomb() {
            force = self.coulomb.sliding(rubbing.direction, velocity, self.coulomb.kinetic(pressing));
        }
        match rubbing.width {
            Some(width) => force + pressing.secant_stiffness() * width,
            None => force,
        }
    }
}
