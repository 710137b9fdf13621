//! Gauge and absolute pressure as two types.
//!
//! Force follows the gauge pressure `P_g = P − P_atm`, gas follows the absolute pressure `P`. No unit distinguishes the
//! two, and confusing them is this field's commonest mistake, so the compiler keeps them apart.
//!
//! ```
//! use mckibben::{AbsolutePressure, GaugePressure};
//! let atmosphere = AbsolutePressure(101_325.0);
//! let gauge = GaugePressure(400_000.0);
//! assert_eq!(gauge.absolute(atmosphere), AbsolutePressure(501_325.0));
//! assert_eq!(gauge.absolute(atmosphere).gauge(atmosphere), gauge);
//! ```

use crate::scalar::Scalar;

/// Pressure above that of the atmosphere, in Pa; below zero for a vacuum.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct GaugePressure<S = f64>(pub S);

/// Pressure above empty space, in Pa; always positive in a gas.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct AbsolutePressure<S = f64>(pub S);

impl<S: Scalar> GaugePressure<S> {
    /// `P = P_g + P_atm`.
    #[inline(always)]
    pub fn absolute(self, atmosphere: AbsolutePressure<S>) -> AbsolutePressure<S> {
        AbsolutePressure(self.0 + atmosphere.0)
    }
}

impl<S: Scalar> AbsolutePressure<S> {
    /// `P_g = P − P_atm`.
    #[inline(always)]
    pub fn gauge(self, atmosphere: AbsolutePressure<S>) -> GaugePressure<S> {
        GaugePressure(self.0 - atmosphere.0)
    }
}
