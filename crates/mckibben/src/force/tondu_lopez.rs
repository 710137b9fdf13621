//! The law of Tondu & Lopez: a cylinder whose ends taper, by a factor on the contraction.
//!
//! ```text
//! F    = π r₀² P_g [a (1 − k ε)² − b]        ε = (L₀ − L)/L₀
//! a    = 3/tan² α₀        b = 1/sin² α₀
//! k(P) = k + k_r e^(−P_g/P_k)
//! ```
//!
//! With `k = 1` and the `a`, `b` and `r₀` of a braid it is the ideal law, written over contraction. A real muscle
//! tapers towards its fittings, so that its middle contracts more than its ends show: `k` above 1 says by how much, and
//! lowers the largest contraction to `(1 − √(b/a))/k`. At low pressure the bladder holds back more than later; then `k`
//! falls with pressure to its limit.
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | r₀ | `radius`, of the braid at L₀ | m |
//! | a, b | `a`, `b` | – |
//! | L₀ | `initial_length`, the length at which the braid is taut | m |
//! | k, k_r | `limit`, `rise` of the [`EndFactor`] | – |
//! | P_k | `pressure` of the [`EndFactor`] | Pa |
//! | α₀ | initial braid angle, `cos α₀ = L₀/b` | rad |
//!
//! Where the coefficients are not given they are those of the braid: `π r₀² a = 3 L₀²/(4πn²)`, `π r₀² b = b²/(4πn²)`.
//!
//! It is the gradient of `P_g` times a separate volume, `V(L₀ (1 − k ε))/k`, not the braid's: with `k ≠ 1` a cycle
//! in pressure and length gains or loses energy against the air, and the energy audit says how much.
//!
//! Source: B. Tondu & P. Lopez, "Modeling and control of McKibben artificial muscle robot actuators", IEEE Control
//! Systems Magazine 20(2), 15–38 (2000), doi:10.1109/37.833638, for the law with `k = 1`, `a` and `b`, which two public
//! implementations repeat; the article itself was not at hand. Assumed: that `k` stands where it does here, and the
//! exponential fall with pressure.
//! Checked by `tests/laws.rs`: transcription, the ideal braid at `k = 1`, its largest contraction, dual against finite
//! difference, secant.

use super::StaticForce;
use crate::braid::Braid;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar};
use core::f64::consts::PI;

/// The factor `k` by which the middle of a muscle contracts more than its ends show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndFactor<S = f64> {
    limit: S,
    rise: S,
    pressure: S,
    falls: bool,
}

impl EndFactor {
    /// A limit that is constant over pressure, above zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when it is not a positive number.
    pub fn constant(limit: f64) -> Result<Self, Error> {
        Self::falling(limit, 0.0, parameter::END_FACTOR_PRESSURE.default.unwrap_or(1e5))
    }

    /// `limit` (above zero) at high pressure and `rise` more at none, falling by 1/e every `pressure` (Pa, above zero).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a number is outside its range.
    pub fn falling(limit: f64, rise: f64, pressure: f64) -> Result<Self, Error> {
        Ok(Self {
            limit: parameter::END_FACTOR.check(limit)?,
            rise: parameter::END_FACTOR_RISE.check(rise)?,
            pressure: parameter::END_FACTOR_PRESSURE.check(pressure)?,
            falls: rise != 0.0,
        })
    }
}

impl<S: Scalar> EndFactor<S> {
    /// The factor at a gauge pressure.
    #[inline(always)]
    pub fn at<T: Over<S>>(&self, gauge: GaugePressure<T>) -> T {
        match self.falls {
            true => T::of(self.limit) + T::of(self.rise) * (-gauge.0 / T::of(self.pressure)).exp(),
            false => T::of(self.limit),
        }
    }

    fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> EndFactor<T> {
        EndFactor {
            limit: convert.parameter(&parameter::END_FACTOR, self.limit),
            rise: convert.parameter(&parameter::END_FACTOR_RISE, self.rise),
            pressure: convert.parameter(&parameter::END_FACTOR_PRESSURE, self.pressure),
            falls: self.falls,
        }
    }
}

/// Measured coefficients, where they are not those of the braid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients<S = f64> {
    /// Radius `r₀` in m at the initial length.
    pub radius: S,
    /// Factor `a` of the term that pulls.
    pub a: S,
    /// Factor `b` of the term that pushes.
    pub b: S,
}

/// The law of Tondu & Lopez.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TonduLopez<S = f64> {
    initial_length: S,
    end_factor: EndFactor<S>,
    given: Option<Coefficients<S>>,
    /// `π r₀² a` in m².
    pull: S,
    /// `π r₀² b` in m².
    push: S,
}

impl TonduLopez {
    /// The law on `braid` that is taut at `initial_length` (m, above zero); its coefficients are the braid's unless others
    /// are `given`, each above zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a number is not positive.
    pub fn new(
        braid: &Braid,
        initial_length: f64,
        end_factor: EndFactor,
        given: Option<Coefficients>,
    ) -> Result<Self, Error> {
        parameter::MAX_LENGTH.check(initial_length)?;
        if let Some(Coefficients { radius, a, b }) = given {
            parameter::INITIAL_RADIUS.check(radius)?;
            parameter::TONDU_LOPEZ_A.check(a)?;
            parameter::TONDU_LOPEZ_B.check(b)?;
        }
        Ok(Self::assemble(braid, initial_length, end_factor, given))
    }
}

impl Coefficients {
    /// Those of a braid at an initial length in m, with which the law is that of the ideal braid: `a = 3/tan² α₀` and
    /// `b = 1/sin² α₀` on its radius there.
    pub fn of(braid: &Braid, initial_length: f64) -> Self {
        let radius = 0.5 * braid.diameter::<f64>(initial_length);
        let [pull, push] = factors(braid, initial_length);
        let area = PI * radius * radius;
        Self { radius, a: pull / area, b: push / area }
    }
}

/// What stands before `(1 − kε)²` and before 1, in m², of the ideal braid.
fn factors<S: Scalar>(braid: &Braid<S>, initial_length: S) -> [S; 2] {
    let (per_turns, thread) = (braid.per_turns(), braid.thread_length());
    [S::constant(3.0) * initial_length * initial_length * per_turns, thread * thread * per_turns]
}

impl<S: Scalar> TonduLopez<S> {
    fn assemble(braid: &Braid<S>, initial_length: S, end_factor: EndFactor<S>, given: Option<Coefficients<S>>) -> Self {
        let (pull, push) = match given {
            Some(Coefficients { radius, a, b }) => {
                let area = S::constant(PI) * radius * radius;
                (area * a, area * b)
            }
            None => factors(braid, initial_length).into(),
        };
        Self { initial_length, end_factor, given, pull, push }
    }

    /// Converts the law to another scalar type, on the braid that has been converted before.
    pub(crate) fn convert<T: Scalar>(&self, braid: &Braid<T>, convert: &mut impl Convert<S, T>) -> TonduLopez<T> {
        let initial_length = convert.parameter(&parameter::MAX_LENGTH, self.initial_length);
        let end_factor = self.end_factor.convert(convert);
        let given = self.given.map(|given| Coefficients {
            radius: convert.parameter(&parameter::INITIAL_RADIUS, given.radius),
            a: convert.parameter(&parameter::TONDU_LOPEZ_A, given.a),
            b: convert.parameter(&parameter::TONDU_LOPEZ_B, given.b),
        });
        match convert.carry() {
            Some(mut carry) => {
                TonduLopez { initial_length, end_factor, given, pull: carry(self.pull), push: carry(self.push) }
            }
            None => TonduLopez::assemble(braid, initial_length, end_factor, given),
        }
    }

    /// The end factor.
    pub fn end_factor(&self) -> &EndFactor<S> {
        &self.end_factor
    }

    /// `1 − k ε`: the share of its initial length that the middle of the muscle has.
    #[inline(always)]
    fn share<T: Over<S>>(&self, length: T, end_factor: T) -> T {
        let initial = T::of(self.initial_length);
        T::one() - end_factor * ((initial - length) / initial)
    }
}

impl<S: Scalar> StaticForce<S> for TonduLopez<S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        let share = self.share(length, self.end_factor.at(gauge));
        gauge.0 * (T::of(self.pull) * share * share - T::of(self.push))
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        let end_factor = self.end_factor.at(gauge);
        let sum = self.share(length, end_factor) + self.share(from, end_factor);
        gauge.0 * T::of(self.pull) * end_factor * sum / T::of(self.initial_length)
    }
}
