//! Sárosi's law of six coefficients: a surface through the measured forces of a fluidic muscle.
//!
//! ```text
//! F = (a₁ P_g + a₂) e^(a₃ κ) + a₄ κ P_g + a₅ P_g + a₆        κ = 100 (L₀ − L)/L₀
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | κ | contraction | % |
//! | L₀ | `initial_length` | m |
//! | a₁, a₅ | `coefficients[0]`, `[4]` | N/Pa |
//! | a₂, a₆ | `coefficients[1]`, `[5]` | N |
//! | a₃ | `coefficients[2]` | 1/% |
//! | a₄ | `coefficients[3]` | N/(Pa %) |
//!
//! The contraction is in percent. The law holds within the pressures and contractions that its
//! coefficients were fitted to, and says nothing of the muscle's volume: no potential of the air gives it, so a cycle in
//! pressure and length gains or loses energy against the air, and the energy audit says how much.
//!
//! Source: after J. Sárosi, "Elimination of the hysteresis effect of PAM actuator: modelling and experimental studies",
//! Tehnički vjesnik 22(6), 1489–1494 (2015), doi:10.17559/TV-20140716143627, of which only the abstract was at hand. The
//! formula, term by term, is that of a public implementation (Bipedal_Robot of the Agile and Adaptive Robotics group,
//! `ModelComparison2.m`), which has it over bar and names two of his papers of 2012 for its coefficients.
//! Checked by `tests/laws.rs`: transcription in kPa, dual against finite difference, secant; `tests/measured_muscles.rs`: an
//! independent fit to published measurements.

use super::{StaticForce, relative_exponential};
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar};

/// Sárosi's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sarosi<S = f64> {
    initial_length: S,
    coefficients: [S; 6],
}

impl Sarosi {
    /// The law of a muscle of `initial_length` (m, above zero) with its `coefficients`, for pressures in Pa, forces in N
    /// and contractions in percent.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a number is not finite or the length is not above zero.
    pub fn new(initial_length: f64, coefficients: [f64; 6]) -> Result<Self, Error> {
        for coefficient in coefficients {
            parameter::SAROSI_COEFFICIENTS.check(coefficient)?;
        }
        Ok(Self { initial_length: parameter::MAX_LENGTH.check(initial_length)?, coefficients })
    }
}

impl<S: Scalar> Sarosi<S> {
    /// Converts the law to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Sarosi<T> {
        Sarosi {
            initial_length: convert.parameter(&parameter::MAX_LENGTH, self.initial_length),
            coefficients: self.coefficients.map(|a| convert.parameter(&parameter::SAROSI_COEFFICIENTS, a)),
        }
    }

    /// Contraction in percent.
    #[inline(always)]
    fn contraction<T: Over<S>>(&self, length: T) -> T {
        let initial = T::of(self.initial_length);
        T::constant(100.0) * ((initial - length) / initial)
    }
}

impl<S: Scalar> StaticForce<S> for Sarosi<S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        let a = |n: usize| T::of(self.coefficients[n]);
        let (contraction, pressure) = (self.contraction(length), gauge.0);
        (a(0) * pressure + a(1)) * (a(2) * contraction).exp() + (a(3) * contraction + a(4)) * pressure + a(5)
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        let a = |n: usize| T::of(self.coefficients[n]);
        let (contraction, start) = (self.contraction(length), self.contraction(from));
        let rise = a(2) * (a(2) * start).exp() * relative_exponential(a(2) * (contraction - start));
        let per_contraction = (a(0) * gauge.0 + a(1)) * rise + a(3) * gauge.0;
        -per_contraction * T::constant(100.0) / T::of(self.initial_length)
    }
}
