//! A surface that is polynomial in contraction and affine in gauge pressure, through measured forces.
//!
//! ```text
//! F = P_g Σᵢ aᵢ εⁱ − Σⱼ bⱼ εʲ        ε = (L₀ − L)/L₀,  i, j = 0 … 5
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | L₀ | `initial_length` | m |
//! | aᵢ | `pressure_coefficients[i]`, of what the pressure pulls | m² |
//! | bⱼ | `passive_coefficients[j]`, of what resists without pressure | N |
//!
//! The passive part depends on the length alone: it stores energy and gives it back. The other follows a separate
//! volume, and is the gas's where it is the braid's: the ideal braid is `a = [3L₀² − b², −6L₀², 3L₀²]/(4πn²)`. Any
//! other takes or gains energy against the air in a cycle of pressure and length, and the energy audit says how much.
//!
//! Holds for the contractions that it was fitted to, and no further: of all laws polynomials fit best where there are
//! measurements and go astray most where there are none.
//!
//! Source: the form is that of models of fluidic muscles in control: A. Hildebrandt, O. Sawodny, R. Neumann & A. Hartmann,
//! "Cascaded control concept of a robot with two degrees of freedom driven by four artificial pneumatic muscle actuators",
//! American Control Conference (2005); H. Aschemann & D. Schindele, "Sliding-mode control of a high-speed linear axis driven
//! by pneumatic muscle actuators", IEEE Transactions on Industrial Electronics 55(11) (2008), with degrees 3 and 4 in the
//! change of length. Neither article was at hand; the form is known from citations.
//! Checked by `tests/laws.rs`: transcription power by power, the ideal braid with a linear bladder as a member, energy, dual
//! against finite difference, secant; `tests/measured_muscles.rs`: independent fits, and lengths held out of them.

use super::StaticForce;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter::{self, Parameter};
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar};

/// The most coefficients that either polynomial takes: degree 5.
pub const MAX_POWERS: usize = 6;

/// A polynomial surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial<S = f64> {
    initial_length: S,
    pressure: [S; MAX_POWERS],
    passive: [S; MAX_POWERS],
}

impl Polynomial {
    /// The law of a muscle of `initial_length` (m, above zero) with the coefficients of rising powers of contraction: those of
    /// pressure in m², at least one, and the passive ones in N, if any.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a number is not finite or the length is not above zero; [`Error::Table`] when a list is too
    /// long, or that of pressure empty.
    pub fn new(initial_length: f64, pressure: &[f64], passive: &[f64]) -> Result<Self, Error> {
        if pressure.is_empty() {
            return Err(Error::Table {
                name: parameter::PRESSURE_COEFFICIENTS.key,
                problem: "it has no entry",
                entry: 1,
                remedy: "give at least the coefficient without contraction",
            });
        }
        Ok(Self {
            initial_length: parameter::MAX_LENGTH.check(initial_length)?,
            pressure: padded(&parameter::PRESSURE_COEFFICIENTS, pressure)?,
            passive: padded(&parameter::PASSIVE_COEFFICIENTS, passive)?,
        })
    }
}

/// A list, checked, with zeros for the powers that it has not.
fn padded(row: &'static Parameter, list: &[f64]) -> Result<[f64; MAX_POWERS], Error> {
    if list.len() > MAX_POWERS {
        return Err(Error::Table {
            name: row.key,
            problem: "it has too many entries",
            entry: MAX_POWERS + 1,
            remedy: "keep to 6 coefficients, degree 5",
        });
    }
    let mut padded = [0.0; MAX_POWERS];
    for (place, coefficient) in list.iter().enumerate() {
        padded[place] = row.check(*coefficient)?;
    }
    Ok(padded)
}

impl<S: Scalar> Polynomial<S> {
    /// Converts the law to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Polynomial<T> {
        Polynomial {
            initial_length: convert.parameter(&parameter::MAX_LENGTH, self.initial_length),
            pressure: self.pressure.map(|a| convert.parameter(&parameter::PRESSURE_COEFFICIENTS, a)),
            passive: self.passive.map(|b| convert.parameter(&parameter::PASSIVE_COEFFICIENTS, b)),
        }
    }

    #[inline(always)]
    fn contraction<T: Over<S>>(&self, length: T) -> T {
        let initial = T::of(self.initial_length);
        (initial - length) / initial
    }

    /// The coefficient of a power of contraction in the force at a pressure, in N.
    #[inline(always)]
    fn coefficient<T: Over<S>>(&self, power: usize, gauge: GaugePressure<T>) -> T {
        gauge.0 * T::of(self.pressure[power]) - T::of(self.passive[power])
    }

    /// Energy in J that the passive part holds at a length in m, zero at the initial length.
    pub fn stored_energy<T: Over<S>>(&self, length: T) -> T {
        let contraction = self.contraction(length);
        let mut sum = T::zero();
        for power in (0..MAX_POWERS).rev() {
            let over = T::of(self.passive[power]) / T::constant((power + 1) as f64);
            sum = sum * contraction + over;
        }
        T::of(self.initial_length) * contraction * sum
    }
}

impl<S: Scalar> StaticForce<S> for Polynomial<S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        let contraction = self.contraction(length);
        let mut sum = T::zero();
        for power in (0..MAX_POWERS).rev() {
            sum = sum * contraction + self.coefficient(power, gauge);
        }
        sum
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        let (contraction, start) = (self.contraction(length), self.contraction(from));
        // Horner's scheme at the start leaves the coefficients of the divided difference.
        let (mut at_start, mut difference) = (T::zero(), T::zero());
        for power in (0..MAX_POWERS).rev() {
            difference = difference * contraction + at_start;
            at_start = at_start * start + self.coefficient(power, gauge);
        }
        -difference / T::of(self.initial_length)
    }
}
