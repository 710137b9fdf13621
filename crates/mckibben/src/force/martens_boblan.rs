//! The law of Martens & Boblan: the gas on the braid, and a rubber membrane that the braid is embedded in.
//!
//! ```text
//! F   = −P_g dV/dL + F_m(L)
//! F_m = σ_P π H L dD/dL − σ_L π D H
//! σ_L = E(L) (L − L₀)/L₀        σ_P = E(L) (D − D₀)/D₀        E(L) = c₀ + c₁ L + c₂ L² + c₃ L³
//! ```
//!
//! With the braid's `D = r/(nπ)`, `r = √(b² − L²)`, the membrane's part is
//! `F_m = (H/n) E(L) [L² (1/r − 1/r₀) + r (L₀ − L)/L₀]`.
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | L₀, D₀ | `rest_length`, the braid's diameter there | m |
//! | H | `thickness` of the membrane, the same at any length | m |
//! | E | modulus of the rubber | Pa |
//! | c₀ … c₃ | `modulus[0]` … `modulus[3]` | Pa, Pa/m, Pa/m², Pa/m³ |
//! | F_m | `membrane` | N |
//!
//! The braid is that of the muscle: an angle `θ₀` at `L₀` and a diameter `D₀` make `b = L₀/cos θ₀` and
//! `n = L₀ tan θ₀/(π D₀)`. The membrane's part depends on the length alone, so it takes work and gives it back: with the
//! braid's volume, or the gas's inside a wall, the law is conservative. Its energy has no elementary form and is
//! integrated by Gauss's rule of 16 points.
//!
//! Holds for the lengths that `E` was fitted to, a cubic in them. Fluidic muscles embed their fibres in rubber; a braid that
//! slides on its bladder is another muscle.
//!
//! Source: M. Martens & I. Boblan, "Modeling the Static Force of a Festo Pneumatic Muscle Actuator: A New Approach and a
//! Comparison to Existing Models", Actuators 6(4), 33 (2017), doi:10.3390/act6040033. The equations were read from a public
//! implementation of them (Bipedal_Robot of the Agile and Adaptive Robotics group, `ModelComparison2.m`), not from the
//! article. That they are the article's, the sign of the second term included, is seen from its numbers: its coefficients
//! give its measurements to the errors that it states, if the correction of the angle is taken in radians.
//! Checked by `tests/measured_muscles.rs`: the published coefficients and a fit against the published measurements;
//! `tests/laws.rs`: energy, closed cycle, dual against finite difference, secant.

use crate::braid::Braid;
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// The rubber membrane of the law of Martens & Boblan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MartensBoblan<S = f64> {
    rest_length: S,
    thickness: S,
    modulus: [S; 4],
    /// `b²` in m².
    squared_thread: S,
    /// `1/r₀` in 1/m.
    per_rest: S,
    /// `H/n` in m.
    per_turn: S,
}

impl MartensBoblan {
    /// The membrane of a muscle on `braid` that is at rest at `rest_length` (m, above zero and below the thread length), of a
    /// `thickness` (m, above zero) and a `modulus` whose coefficients of rising powers of the length are in Pa, Pa/m, Pa/m²
    /// and Pa/m³.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a number is outside its range; [`Error::Inconsistent`] unless the rest length is below the
    /// thread length.
    pub fn new(braid: &Braid, rest_length: f64, thickness: f64, modulus: [f64; 4]) -> Result<Self, Error> {
        parameter::MAX_LENGTH.check(rest_length)?;
        parameter::MEMBRANE_THICKNESS.check(thickness)?;
        for coefficient in modulus {
            parameter::MEMBRANE_MODULUS.check(coefficient)?;
        }
        if rest_length >= braid.thread_length() {
            return Err(Error::Inconsistent {
                parameter: &parameter::MAX_LENGTH,
                value: rest_length,
                requirement: Requirement {
                    relation: "must be less than",
                    other: parameter::THREAD_LENGTH.key,
                    value: braid.thread_length(),
                    unit: "m",
                },
                remedy: "shorten max_length or give a longer thread",
            });
        }
        Ok(Self::assemble(braid, rest_length, thickness, modulus))
    }
}

impl<S: Scalar> MartensBoblan<S> {
    fn assemble(braid: &Braid<S>, rest_length: S, thickness: S, modulus: [S; 4]) -> Self {
        let squared_thread = braid.thread_length() * braid.thread_length();
        let per_rest = S::one() / (squared_thread - rest_length * rest_length).sqrt();
        Self { rest_length, thickness, modulus, squared_thread, per_rest, per_turn: thickness / braid.turns() }
    }

    /// Converts the membrane to another scalar type, on the braid that has been converted before.
    pub(crate) fn convert<T: Scalar>(&self, braid: &Braid<T>, convert: &mut impl Convert<S, T>) -> MartensBoblan<T> {
        let rest_length = convert.parameter(&parameter::MAX_LENGTH, self.rest_length);
        let thickness = convert.parameter(&parameter::MEMBRANE_THICKNESS, self.thickness);
        let modulus = self.modulus.map(|c| convert.parameter(&parameter::MEMBRANE_MODULUS, c));
        match convert.carry() {
            Some(mut carry) => MartensBoblan {
                rest_length,
                thickness,
                modulus,
                squared_thread: carry(self.squared_thread),
                per_rest: carry(self.per_rest),
                per_turn: carry(self.per_turn),
            },
            None => MartensBoblan::assemble(braid, rest_length, thickness, modulus),
        }
    }

    /// Modulus `E` of the rubber in Pa at a length in m.
    #[inline(always)]
    pub fn modulus<T: Over<S>>(&self, length: T) -> T {
        let [c0, c1, c2, c3] = self.modulus.map(T::of);
        ((c3 * length + c2) * length + c1) * length + c0
    }

    /// `r = √(b² − L²)` in m.
    #[inline(always)]
    fn root<T: Over<S>>(&self, length: T) -> T {
        (T::of(self.squared_thread) - length * length).sqrt()
    }

    /// `F_m/((H/n) E)` in m.
    #[inline(always)]
    fn shape<T: Over<S>>(&self, length: T) -> T {
        let (rest, root) = (T::of(self.rest_length), self.root(length));
        length * length * (T::one() / root - T::of(self.per_rest)) + root * (rest - length) / rest
    }

    /// The membrane's part of the force in N at a length in m: negative below the rest length.
    #[inline(always)]
    pub fn membrane<T: Over<S>>(&self, length: T) -> T {
        T::of(self.per_turn) * self.modulus(length) * self.shape(length)
    }

    /// The secant of that part over length in N/m.
    #[inline(always)]
    pub fn membrane_secant<T: Over<S>>(&self, length: T, from: T) -> T {
        let (end, start) = (self.root(length), self.root(from));
        let (rest, sum) = (T::of(self.rest_length), length + from);
        let [_, c1, c2, c3] = self.modulus.map(T::of);
        let of_modulus = c1 + c2 * sum + c3 * (length * sum + from * from);
        // Of r: r² falls as L² rises.
        let of_root = -sum / (end + start);
        let of_shape = sum * (T::one() / end - T::of(self.per_rest)) - from * from * of_root / (end * start)
            + (of_root * (rest - length) - start) / rest;
        T::of(self.per_turn) * (of_modulus * self.shape(length) + self.modulus(from) * of_shape)
    }

    /// The membrane's energy in J, zero at the rest length.
    pub fn stored_energy<T: Over<S>>(&self, length: T) -> T {
        let half = T::constant(0.5) * (length - T::of(self.rest_length));
        let middle = T::of(self.rest_length) + half;
        let mut sum = T::zero();
        for [node, weight] in GAUSS {
            let reach = half * T::constant(node);
            sum = sum + T::constant(weight) * (self.membrane(middle + reach) + self.membrane(middle - reach));
        }
        half * sum
    }
}

/// Positive nodes and weights of Gauss's rule of 16 points on −1 to 1.
const GAUSS: [[f64; 2]; 8] = [
    [0.095_012_509_837_637_44, 0.189_450_610_455_068_5],
    [0.281_603_550_779_258_9, 0.182_603_415_044_923_58],
    [0.458_016_777_657_227_37, 0.169_156_519_395_002_54],
    [0.617_876_244_402_643_8, 0.149_595_988_816_576_74],
    [0.755_404_408_355_003, 0.124_628_971_255_533_88],
    [0.865_631_202_387_831_8, 0.095_158_511_682_492_79],
    [0.944_575_023_073_232_6, 0.062_253_523_938_647_894],
    [0.989_400_934_991_649_9, 0.027_152_459_411_754_096],
];
