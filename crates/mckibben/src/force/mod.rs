//! Static force: how hard the gas pulls the ends together.
//!
//! One trait, [`StaticForce`], is the question; each law is a file, and a [`Characteristic`] puts one on a braid. A
//! correction wraps what it corrects: a [`Bladder`] adds its elasticity, a [`Wall`] and a [`Taper`] of the ends take room from
//! the gas; [`Effectiveness`] multiplies any law by a measured ratio (9). [`LengthLimits`] adds the end effects (10)(11)(14).

mod bladder;
mod bolen;
mod characteristic;
mod effectiveness;
mod extensible;
mod ideal;
mod limits;
#[cfg(feature = "alloc")]
mod map;
mod martens_boblan;
mod monotone;
mod polynomial;
mod sarosi;
mod taper;
mod tondu_lopez;
mod wall;

pub use bladder::{Bladder, BladderForm};
pub use bolen::Bolen;
pub use characteristic::{Characteristic, Law, Piece};
pub use effectiveness::{Effective, Effectiveness, MAX_COEFFICIENTS, MAX_KNOTS};
pub use extensible::ExtensibleBraid;
pub use ideal::IdealBraid;
pub use limits::LengthLimits;
#[cfg(feature = "alloc")]
pub use map::{ForceMap, MAX_MAP};
pub use martens_boblan::MartensBoblan;
pub(crate) use monotone::Knots;
pub use polynomial::{MAX_POWERS, Polynomial};
pub use sarosi::Sarosi;
pub use taper::Taper;
pub use tondu_lopez::{Coefficients, EndFactor, TonduLopez};
pub use wall::Wall;

use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar};

/// A law for the tension that the gas holds at rest, at a length and a gauge pressure.
///
/// Tension is positive. Evaluated at [`Dual`](crate::Dual) arguments a law gives its exact `∂F/∂L` and `∂F/∂P_g`.
pub trait StaticForce<S: Scalar> {
    /// The force `F_s` in N at `length` (m) and `gauge` pressure (Pa).
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T;

    /// The secant stiffness `(F_s(L) − F_s(from))/(L − from)` in N/m, (13), without a 0/0 at `L = from`.
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T;
}

/// Everything static about an actuator: its law of force, and the volume of its gas.
pub trait Statics<S: Scalar>: StaticForce<S> {
    /// Whether a rig with this law named may have an air line: code for one is compiled only then.
    const MAY_HAVE_LINE: bool = true;

    /// Length in m at which the model ends.
    fn end_length(&self) -> S;

    /// Volume of the gas in m³ at a length in m, and its slope over length in m²: negative where the gas pulls the ends
    /// together.
    fn volume_and_slope<T: Over<S>>(&self, length: T) -> [T; 2];

    /// Volume of the gas in m³ at a length in m.
    #[inline(always)]
    fn volume<T: Over<S>>(&self, length: T) -> T {
        self.volume_and_slope(length)[0]
    }

    /// Slope of that volume over length in m².
    #[inline(always)]
    fn volume_slope<T: Over<S>>(&self, length: T) -> T {
        self.volume_and_slope(length)[1]
    }
}

/// `(e^z − 1)/z`, which is 1 at zero: what a secant of an exponential is made of.
#[inline(always)]
pub(crate) fn relative_exponential<S: Scalar>(z: S) -> S {
    // Below a half the series is exact to rounding after fifteen terms, and so are its derivatives.
    const TERMS: usize = 15;
    let mut series = S::one();
    for term in (2..=TERMS).rev() {
        series = S::one() + z * series / S::constant(term as f64);
    }
    S::select(z.magnitude().lt(S::constant(0.5)), series, z.exp_m1() / z)
}
