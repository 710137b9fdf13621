//! The ideal braid: virtual work of the gas on an inextensible braid without wall or friction.
//!
//! ```text
//! F     = P_g (3L² − b²)/(4πn²) = −P_g dV/dL          (1)(3)
//! k     = ∂F/∂L at constant P_g = 3 P_g L/(2πn²)      (7)
//! k_sec = 3 P_g (L + L₀)/(4πn²)                       (13) with F(L₀) taken where it stands
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | F | `force` | N, positive when it pulls the ends together |
//! | P_g | `gauge` | Pa |
//! | L | `length` | m |
//! | b, n | of the [`Braid`] | m, – |
//!
//! Valid for `0 < L < b`; below `b/√3` the ideal braid pushes.
//! Source: Colbrunn, Nelson & Quinn (2001), equations (1) to (8).
//! Checked by `tests/force.rs`: transcription of (1), (3), (7) and (8), virtual work, dual against finite difference.

use super::{StaticForce, Statics};
use crate::braid::Braid;
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar};

/// The ideal law on a braid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdealBraid<S = f64> {
    /// The braid's geometry.
    pub braid: Braid<S>,
}

impl<S: Scalar> StaticForce<S> for IdealBraid<S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        -gauge.0 * self.braid.volume_slope(length)
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        T::constant(3.0) * gauge.0 * (length + from) * T::of(self.braid.per_turns())
    }
}

impl<S: Scalar> Statics<S> for IdealBraid<S> {
    const MAY_HAVE_LINE: bool = false;

    #[inline(always)]
    fn end_length(&self) -> S {
        self.braid.thread_length()
    }

    #[inline(always)]
    fn volume_and_slope<T: Over<S>>(&self, length: T) -> [T; 2] {
        [self.braid.volume(length), self.braid.volume_slope(length)]
    }
}
