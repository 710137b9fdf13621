//! The numbers that the physics is written over.
//!
//! Each law is written once, generic over its scalar, and serves
//!
//! | scalar | use |
//! |---|---|
//! | `f64` | simulation |
//! | [`Dual`](crate::Dual) | exact derivatives, with respect to a state or to a parameter |
//! | a vector of lanes | batches: each lane is another actuator with its own parameters |
//!
//! A comparison gives a [`Mask`], a choice between two values is [`Scalar::select`]: there is no branch on a value, so
//! that lanes may differ. [`Real`] is a scalar that does have one value to branch on; the adaptive integrator needs
//! that, the laws do not.
//!
//! Parameters are held in one scalar `S`, and a law may be evaluated at arguments of another scalar `T` that extends it
//! ([`Over`]): `f64` parameters at dual arguments give `∂F/∂L` without a second copy of any formula.
//!
//! Checked by `tests/scalar.rs` (dual against finite differences, lanes of eight against `f64`, bit for bit).

use core::fmt::Debug;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// The answer of a comparison, one truth value for each lane.
pub trait Mask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// One truth value in every lane.
    fn splat(value: bool) -> Self;
    /// Whether it holds in at least one lane.
    fn any(self) -> bool;
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
}

/// Work too long to be copied to wherever it is done.
pub trait Work {
    /// What comes out of it.
    type Output;
    /// Does it.
    fn done(self) -> Self::Output;
}

/// A function of one number whose derivative is known in closed form, and costs less than that of the way to its value.
pub trait Function {
    /// Its value.
    fn value<S: Scalar>(argument: S) -> S;
    /// Its derivative, from the argument and the value.
    fn slope<S: Scalar>(argument: S, value: S) -> S;
}

/// A number, or several side by side, with the operations that the laws need.
pub trait Scalar:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The answer of a comparison.
    type Mask: Mask;

    /// Whether it is one number: what only a few elements of a batch need is left out of the code for all of its lanes.
    const IS_ONE: bool = false;

    /// Adding and subtracting it rounds a number to a whole one: one and a half times two to the power of the digits behind the first.
    const ROUNDS: f64 = 1.5 * (1_u64 << 52) as f64;

    /// A number known when the program is written, the same in every lane.
    fn constant(value: f64) -> Self;
    /// The square root; the argument must not be negative where the result is used.
    fn sqrt(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The exponential function.
    fn exp(self) -> Self;
    /// The exponential function less one, exact near zero.
    fn exp_m1(self) -> Self;
    /// The sine of an angle in radians.
    fn sin(self) -> Self;
    /// The cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Whether `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether `self ≤ other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `yes` where the mask holds, `no` elsewhere. What is not chosen may be anything, NaN included.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Does work on such numbers in a separate function: what only some actuators need is compiled once, not into every
    /// stage of every engine. Lanes have it compiled for their instructions.
    #[inline(never)]
    fn apart<W: Work>(work: W) -> W::Output {
        work.done()
    }

    /// The value of a function.
    #[inline(always)]
    fn by<F: Function>(self) -> Self {
        F::value(self)
    }
    /// `self · factor + addend`, each rounded: the same number on any machine and in any lane.
    ///
    /// Fused, in vector registers, a batch of plain actuators took no less time (AVX-512: 39.5 ns a step, fused 39.9); and a program
    /// for any x86-64 machine would call a function for each.
    #[inline(always)]
    fn multiply_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::constant(0.0)
    }
    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::constant(1.0)
    }
    /// The smaller of two numbers.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// The larger of two numbers.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }
    /// The absolute value.
    #[inline(always)]
    fn magnitude(self) -> Self {
        Self::select(self.lt(Self::zero()), -self, self)
    }
    /// −1, 0 or +1.
    #[inline(always)]
    fn sign(self) -> Self {
        let positive = Self::select(Self::zero().lt(self), Self::one(), Self::zero());
        Self::select(self.lt(Self::zero()), -Self::one(), positive)
    }
    /// `self` to the power of `exponent`, for `self > 0`.
    #[inline(always)]
    fn power(self, exponent: Self) -> Self {
        (self.ln() * exponent).exp()
    }
}

/// A scalar with one value to branch on: not lanes.
pub trait Real: Scalar<Mask = bool> + PartialEq {
    /// Whether it carries derivatives besides its value.
    const HAS_DERIVATIVES: bool = Self::SLOPES > 0;
    /// Directions of its derivatives.
    const SLOPES: usize = 0;

    /// The value without any derivative.
    fn value(self) -> f64;

    /// Its derivative in a direction.
    #[inline(always)]
    fn slope(self, _direction: usize) -> f64 {
        0.0
    }
}

/// A scalar that extends `S`: arguments of this type may meet parameters of type `S`.
pub trait Over<S: Scalar>: Scalar<Mask = S::Mask> {
    /// A parameter as a constant of the wider scalar.
    fn of(parameter: S) -> Self;
}

impl<S: Scalar> Over<S> for S {
    #[inline(always)]
    fn of(parameter: S) -> S {
        parameter
    }
}

/// A scalar over `S` that can take one derivative more.
pub trait Differentiable<S: Scalar>: Over<S> {
    /// The scalar with a derivative.
    type Dual: Over<S>;

    /// A number that changes by `slope`.
    fn along(self, slope: Self) -> Self::Dual;
    /// A number and how it changes.
    fn split(dual: Self::Dual) -> [Self; 2];
}

#[cfg(feature = "std")]
macro_rules! mathematics {
    ($($method:ident => $libm:path),*) => {
        $(#[inline(always)] fn $method(self) -> Self { f64::$method(self) })*
    };
}

#[cfg(all(not(feature = "std"), feature = "libm"))]
macro_rules! mathematics {
    ($($method:ident => $libm:path),*) => {
        $(#[inline(always)] fn $method(self) -> Self { $libm(self) })*
    };
}

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("without the feature `std`, the feature `libm` is needed for the square root and the exponential");

impl Scalar for f64 {
    type Mask = bool;
    const IS_ONE: bool = true;
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn sin(self) -> Self {
        crate::trigonometry::sine(self)
    }
    #[inline(always)]
    fn cos(self) -> Self {
        crate::trigonometry::cosine(self)
    }
    mathematics!(sqrt => libm::sqrt, ln => libm::log, exp => libm::exp, exp_m1 => libm::expm1);
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}

impl Real for f64 {
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
}
