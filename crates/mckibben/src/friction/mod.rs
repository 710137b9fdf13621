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
//! | Q = μN/k | `coulomb_width` | m |
//! | k_sec | `secant_stiffness` | N/m |
//!
//! `sgn` is set-valued at zero: the actuator sticks while the rest of the balance lies within `± Q k_sec`. Who steps
//! time decides which it is, so this law takes the direction of sliding as an argument: +1 lengthening, −1 shortening,
//! 0 at rest. With the bladder sucked off the braid (negative gauge pressure) nothing presses the threads together and
//! the Coulomb term is zero.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3; Q and c are averages of its ring-down tests.
//! Checked by `tests/friction.rs`: decrement 4Q per cycle, exponential decay, never negative dissipation.

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// Viscous and Coulomb friction of bladder and braid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<S = f64> {
    viscous: S,
    coulomb_width: S,
    has_coulomb: bool,
}

impl Friction {
    /// `viscous` damping `c` in N·s/m and `coulomb_width` `Q` in m, both zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when one is negative or not finite.
    pub fn new(viscous: f64, coulomb_width: f64) -> Result<Self, Error> {
        Ok(Self {
            viscous: parameter::VISCOUS.check(viscous)?,
            coulomb_width: parameter::COULOMB_WIDTH.check(coulomb_width)?,
            has_coulomb: coulomb_width > 0.0,
        })
    }

    /// No friction.
    pub const NONE: Self = Self { viscous: 0.0, coulomb_width: 0.0, has_coulomb: false };
}

impl<S: Scalar> Friction<S> {
    /// The same friction over another scalar.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Friction<T> {
        Friction {
            viscous: convert.parameter(&parameter::VISCOUS, self.viscous),
            coulomb_width: convert.parameter(&parameter::COULOMB_WIDTH, self.coulomb_width),
            has_coulomb: self.has_coulomb,
        }
    }

    /// Whether there is Coulomb friction, and so sticking.
    #[inline(always)]
    pub fn has_coulomb(&self) -> bool {
        self.has_coulomb
    }

    /// Viscous damping `c` in N·s/m.
    pub fn viscous(&self) -> S {
        self.viscous
    }

    /// Viscous part `c v` in N.
    #[inline(always)]
    pub fn viscous_force<T: Over<S>>(&self, velocity: T) -> T {
        T::of(self.viscous) * velocity
    }

    /// Largest Coulomb force `Q k_sec` in N at a secant stiffness in N/m.
    #[inline(always)]
    pub fn coulomb_bound<T: Over<S>>(&self, secant_stiffness: T) -> T {
        T::of(self.coulomb_width) * secant_stiffness.larger(T::zero())
    }
}
