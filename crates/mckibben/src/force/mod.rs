//! Static force: how hard the gas pulls the ends together.
//!
//! One trait, [`StaticForce`], is the question; each law is a file. A correction wraps the law that it corrects:
//! [`Effectiveness`] multiplies any law by a measured ratio (9). [`LengthLimits`] adds the end effects (10)(11)(14).

mod effectiveness;
mod ideal;
mod limits;

pub use effectiveness::{Effective, Effectiveness, MAX_COEFFICIENTS, MAX_KNOTS};
pub use ideal::IdealBraid;
pub use limits::LengthLimits;

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
