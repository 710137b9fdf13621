//! A leak of the actuator to the atmosphere: air that seeps through walls and past fittings.
//!
//! ```text
//! ṁ = k (P² − P_atm²)/(2 R T_up)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | k | `conductance`: flow of volume, at the mean pressure, over the difference of pressure | m³/(s·Pa) |
//! | P, P_atm | absolute pressures of the actuator and of the atmosphere | Pa |
//! | R, T_up | gas constant; temperature of the air upstream: the chamber's for a flow outwards, the atmosphere's inwards | J/(kg·K), K |
//!
//! It is the laminar law of [`Tube`](super::Tube) for a flow path whose shape is not known: a narrow one, since a leak
//! that is worth modelling is slow. Below atmospheric pressure air seeps in.
//!
//! Source: Hagen–Poiseuille with the mean density, textbook. Checked by `tests/line_rig.rs`: the decay of a fixed volume.

#[cfg(feature = "alloc")]
use crate::air::Flow;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// A laminar leak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leakage<S = f64> {
    conductance: S,
}

impl Leakage {
    /// A leak of `conductance` in m³/(s·Pa).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a negative or infinite conductance.
    pub fn new(conductance: f64) -> Result<Self, Error> {
        Ok(Self { conductance: parameter::LEAKAGE.check(conductance)? })
    }
}

impl<S: Scalar> Leakage<S> {
    /// Converts the leak to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Leakage<T> {
        Leakage { conductance: convert.parameter(&parameter::LEAKAGE, self.conductance) }
    }

    /// Flow in kg/s from an absolute pressure (Pa) to another; `content` is `R T` of the air upstream in J/kg.
    #[inline(always)]
    pub fn between<T: Over<S>>(&self, from: T, to: T, content: T) -> T {
        T::of(self.conductance) * T::constant(0.5) * (from - to) * (from + to) / content
    }
}

/// A net flow by its direction.
#[cfg(feature = "alloc")]
#[inline(always)]
pub(crate) fn split<T: Scalar>(net: T) -> Flow<T> {
    let outwards = net.lt(T::zero());
    Flow { inward: T::select(outwards, T::zero(), net), outward: T::select(outwards, -net, T::zero()) }
}
