//! Hysteresis of Bouc and Wen with exponent one, and of Dahl: a loop with rounded corners.
//!
//! ```text
//! F_h = k_sec⁺ W (β + γ) z        dz/dt = v − β |v| z − γ v |z|
//!
//! ζ = ± z along the way x:    dζ/dx = 1 − (β + γ) ζ  loading, ζ ≥ 0        dζ/dx = 1 − (β − γ) ζ  unloading, ζ < 0
//! ζ(x) = ζ₀ + (1 − μ ζ₀) (1 − e^{−μx})/μ                                        μ the factor of the piece
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | W | `width`: the force in steady sliding over the secant stiffness, as the Q of Coulomb's law (12) | m |
//! | β, γ | `beta`, `gamma` | 1/m |
//! | z | the deflection: the memory | m |
//! | k_sec | secant stiffness (13) | N/m |
//!
//! After a turn the force first follows a stiffness of `k_sec W (β + γ)` and comes to `k_sec W` over lengths of `1/(β + γ)`.
//! γ = 0 is Dahl's law; with γ = β unloading is a straight line; β must not be less than |γ|, or a cycle would yield work. It
//! depends on the path of the length and not on its speed, and each piece has the closed form above: both engines follow
//! it exactly, and no step is too long for it. Other exponents have none, and are not here.
//!
//! Unlike [elements that slip](super::MaxwellSlip), small inner loops do not close: they creep towards the middle, the known
//! defect of this law.
//!
//! Friction dissipates `k_sec W (β + γ) (β ± γ) z² |dL| ≥ 0`; the rest is stored in the deflection.
//!
//! Sources: Bouc, Acustica 24 (1971); Wen, J. Eng. Mech. Div. 102 (1976); Dahl, Aerospace Report TOR-158 (1968); the bound of
//! γ: Erlicher & Point, C. R. Mécanique 332 (2004). The scale by (13) is this project's. Checked by `tests/bouc_wen.rs`.

use super::memory::{Branch, Memory};
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::force::relative_exponential;
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};

/// The hysteresis of Bouc and Wen with exponent one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoucWen<S = f64> {
    width: S,
    beta: S,
    gamma: S,
}

impl BoucWen {
    /// A loop that slides at `width` (m, above zero), with `beta` (1/m, above zero) and `gamma` (1/m, from above −β to β).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] when `gamma` is not from above −β to β.
    pub fn new(width: f64, beta: f64, gamma: f64) -> Result<Self, Error> {
        parameter::HYSTERESIS_WIDTH.check(width)?;
        parameter::HYSTERESIS_BETA.check(beta)?;
        parameter::HYSTERESIS_GAMMA.check(gamma)?;
        if -beta < gamma && gamma <= beta {
            return Ok(Self { width, beta, gamma });
        }
        Err(Error::Inconsistent {
            parameter: &parameter::HYSTERESIS_GAMMA,
            value: gamma,
            requirement: Requirement {
                relation: if gamma > 0.0 { "must be at most" } else { "must be, without its sign, less than" },
                other: parameter::HYSTERESIS_BETA.key,
                value: beta,
                unit: "m^-1",
            },
            remedy: "raise beta, or bring gamma nearer to zero: otherwise a cycle would yield work",
        })
    }
}

impl<S: Scalar> BoucWen<S> {
    pub(super) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> BoucWen<T> {
        BoucWen {
            width: convert.parameter(&parameter::HYSTERESIS_WIDTH, self.width),
            beta: convert.parameter(&parameter::HYSTERESIS_BETA, self.beta),
            gamma: convert.parameter(&parameter::HYSTERESIS_GAMMA, self.gamma),
        }
    }

    /// The factors μ of loading and of unloading in 1/m.
    #[inline(always)]
    fn factors(&self) -> [S; 2] {
        [self.beta + self.gamma, self.beta - self.gamma]
    }

    /// Force over the secant stiffness for the deflection.
    #[inline(always)]
    fn ratio(&self) -> S {
        self.width * (self.beta + self.gamma)
    }

    /// The deflection in m when the length has moved on by `displacement` m in one direction.
    #[inline(always)]
    fn after<T: Over<S>>(&self, memory: &Memory<S>, displacement: T) -> T {
        let [loading, unloading] = self.factors().map(T::of);
        let sign = T::select(displacement.lt(T::zero()), -T::one(), T::one());
        let (start, way) = (sign * T::of(memory.elements[0]), sign * displacement);
        // First back to zero, as far as that is not reached, then on.
        let deflected = start.smaller(T::zero());
        let back = way_back(-deflected, unloading);
        let reaches = back.le(way);
        let returned = along(deflected, unloading, way.smaller(back));
        let begun = T::select(reaches, start.larger(T::zero()), returned);
        let on = T::select(reaches, way - back, T::zero());
        sign * T::select(reaches, along(begun, loading, on), begun)
    }

    /// The force over the secant stiffness in m at an actuator length in m.
    #[inline(always)]
    pub(super) fn width<T: Over<S>>(&self, memory: &Memory<S>, length: T) -> T {
        T::of(self.ratio()) * self.after(memory, length - T::of(memory.at))
    }

    #[inline(always)]
    pub(super) fn moved(&self, memory: &mut Memory<S>, length: S) {
        memory.elements[0] = self.after(memory, length - memory.at);
        memory.at = length;
    }
}

impl<R: Real> BoucWen<R> {
    pub(super) fn branch(&self, memory: &Memory<R>, direction: f64) -> Branch<R> {
        let ([loading, unloading], sign) = (self.factors(), R::constant(direction));
        let start = sign * memory.elements[0];
        let unloads = start.value() < 0.0;
        let factor = if unloads { unloading } else { loading };
        let ratio = self.ratio();
        Branch {
            from: memory.at,
            width: ratio * memory.elements[0],
            slope: ratio * (R::one() - factor * start),
            decay: sign * factor,
            slipping: R::zero(),
            wear: factor / ratio,
            end: unloads.then(|| memory.at + sign * way_back(-start, unloading)),
        }
    }

    /// At the end of its branch the deflection is zero.
    pub(super) fn slip(&self, memory: &mut Memory<R>, length: R) {
        (memory.at, memory.elements[0]) = (length, R::zero());
    }
}

/// `ζ(x)` on a piece with the factor μ, from a deflection.
#[inline(always)]
fn along<T: Scalar>(from: T, factor: T, way: T) -> T {
    from + (T::one() - factor * from) * way * relative_exponential(-factor * way)
}

/// How far it is from a deflection of `−depth` to zero: `ln(1 + μ depth)/μ`.
#[inline(always)]
fn way_back<T: Scalar>(depth: T, factor: T) -> T {
    // With u = y/(2 + y) it is 2 artanh(u)/μ, whose series is exact to rounding after this many terms up to y = 1/2.
    const TERMS: usize = 12;
    let y = factor * depth;
    let u = y / (T::constant(2.0) + y);
    let square = u * u;
    let mut series = T::zero();
    for term in (0..TERMS).rev() {
        series = series.multiply_add(square, T::constant(1.0 / (2 * term + 1) as f64));
    }
    let near = T::constant(2.0) * depth / (T::constant(2.0) + y) * series;
    let far = (T::one() + y.larger(T::zero())).ln() / factor;
    T::select(y.lt(T::constant(0.5)), near, far)
}
