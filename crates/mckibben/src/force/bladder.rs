//! The bladder: rubber that resists contraction with its elastic energy.
//!
//! ```text
//! form            tension                    stored energy
//! linear          −K₀ ε                      K₀ L₀ ε²/2
//! saturating      −K₀ (1 − e^(−ε/s))         K₀ L₀ (ε − s (1 − e^(−ε/s)))
//! exponential     −K₀ (e^(ε/s) − 1)          K₀ L₀ (s (e^(ε/s) − 1) − ε)             ε = (L₀ − L)/L₀
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | K₀ | `force` | N |
//! | s | `scale`, contraction over which it saturates or stiffens | – |
//! | L₀ | `rest_length`, the length at which the braid is taut | m |
//!
//! The tension is the derivative of the energy by length, whatever the pressure, so the bladder takes work and gives it
//! back: a braid with a bladder is conservative. It counts on top of any law, and an effectiveness multiplies the sum.
//! Where it pushes harder than the gas pulls, the tension is zero: a tendon cannot push.
//!
//! The forms are assumed, as the simplest of their kind, after no publication; K₀ and s are fitted to the force that is
//! missing at rest.
//! Checked by `tests/laws.rs`: transcription, energy against force, closed cycle, limits of `s`, dual against finite
//! difference, secant.

use super::relative_exponential;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// How the bladder's resistance grows with contraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BladderForm {
    /// In proportion to contraction.
    Linear,
    /// Up to a largest force.
    Saturating,
    /// Ever more steeply.
    Exponential,
}

/// An elastic bladder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bladder<S = f64> {
    form: BladderForm,
    rest_length: S,
    force: S,
    scale: S,
}

impl Bladder {
    /// A bladder without tension at `rest_length` (m, above zero), of a `force` `K₀` (N, zero or more), and for the forms
    /// that are not linear a `scale` `s` (above zero).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a number is outside its range.
    pub fn new(form: BladderForm, rest_length: f64, force: f64, scale: f64) -> Result<Self, Error> {
        Ok(Self {
            form,
            rest_length: parameter::MAX_LENGTH.check(rest_length)?,
            force: parameter::BLADDER_FORCE.check(force)?,
            scale: parameter::BLADDER_SCALE.check(scale)?,
        })
    }
}

impl<S: Scalar> Bladder<S> {
    /// Converts the bladder to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Bladder<T> {
        Bladder {
            form: self.form,
            rest_length: convert.parameter(&parameter::MAX_LENGTH, self.rest_length),
            force: convert.parameter(&parameter::BLADDER_FORCE, self.force),
            scale: convert.parameter(&parameter::BLADDER_SCALE, self.scale),
        }
    }

    #[inline(always)]
    fn contraction<T: Over<S>>(&self, length: T) -> T {
        let rest = T::of(self.rest_length);
        (rest - length) / rest
    }

    /// Its tension in N at a length in m: negative below the rest length.
    #[inline(always)]
    pub fn tension<T: Over<S>>(&self, length: T) -> T {
        let (force, contraction) = (T::of(self.force), self.contraction(length));
        match self.form {
            BladderForm::Linear => -force * contraction,
            BladderForm::Saturating => force * (-contraction / T::of(self.scale)).exp_m1(),
            BladderForm::Exponential => -force * (contraction / T::of(self.scale)).exp_m1(),
        }
    }

    /// The secant of its tension over length in N/m.
    #[inline(always)]
    pub fn secant_stiffness<T: Over<S>>(&self, length: T, from: T) -> T {
        let slope = T::of(self.force) / T::of(self.rest_length);
        let scale = T::of(self.scale);
        let (end, start) = (self.contraction(length) / scale, self.contraction(from) / scale);
        match self.form {
            BladderForm::Linear => slope,
            BladderForm::Saturating => slope / scale * (-start).exp() * relative_exponential(start - end),
            BladderForm::Exponential => slope / scale * start.exp() * relative_exponential(end - start),
        }
    }

    /// Its energy in J, zero at the rest length.
    pub fn stored_energy<T: Over<S>>(&self, length: T) -> T {
        let (contraction, scale) = (self.contraction(length), T::of(self.scale));
        let per_force = match self.form {
            BladderForm::Linear => T::constant(0.5) * contraction * contraction,
            BladderForm::Saturating => contraction + scale * (-contraction / scale).exp_m1(),
            BladderForm::Exponential => scale * (contraction / scale).exp_m1() - contraction,
        };
        T::of(self.force) * T::of(self.rest_length) * per_force
    }
}
