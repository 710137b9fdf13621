//! Dual numbers: a value together with its exact derivatives.
//!
//! `a + a′ε` with `ε² = 0`, for `K` directions at once. Every operation carries the chain rule, so a law evaluated at
//! dual arguments gives its own exact derivative (forward mode):
//!
//! ```
//! use mckibben::{Dual, Scalar};
//! let length: Dual<f64, 1> = Dual::variable(3.0, 0);
//! let square = length * length;
//! assert_eq!((square.value, square.slope[0]), (9.0, 6.0));
//! ```
//!
//! Comparisons use the value alone, and a choice takes the derivative of the branch that was chosen. The scalar
//! underneath may itself be dual (second derivatives) or a vector of lanes.

use crate::scalar::{Function, Over, Real, Scalar, Work};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Directions of [`Seeded`] numbers.
pub const DIRECTIONS: usize = 8;

/// Numbers with derivatives in up to [`DIRECTIONS`] directions: those for which the engines are compiled.
pub type Seeded = Dual<f64, DIRECTIONS>;

/// Up to so many bytes of a number, its operations are compiled into whatever they stand in.
const MOST_INLINE: usize = (1 + DIRECTIONS) * size_of::<f64>();

/// A value and its derivatives in `K` directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S, const K: usize> {
    /// The value.
    pub value: S,
    /// The derivatives, in the unit of the value over that of each direction.
    pub slope: [S; K],
}

impl<S: Scalar, const K: usize> Dual<S, K> {
    /// The independent variable of direction `direction`: derivative 1 there and 0 elsewhere.
    #[inline(always)]
    pub fn variable(value: S, direction: usize) -> Self {
        let mut slope = [S::zero(); K];
        if let Some(one) = slope.get_mut(direction) {
            *one = S::one();
        }
        Self { value, slope }
    }

    /// A function of one argument by its value and its derivative there.
    #[inline(always)]
    fn chain(self, value: S, derivative: S) -> Self {
        self.combine(self, value, Scaled(derivative))
    }

    #[inline(always)]
    fn combine(self, other: Self, value: S, rule: impl Rule<S>) -> Self {
        if S::IS_ONE && size_of::<Self>() > MOST_INLINE {
            self.combine_apart(&other, value, rule)
        } else {
            self.combine_here(&other, value, rule)
        }
    }

    #[inline(always)]
    fn combine_here(&self, other: &Self, value: S, rule: impl Rule<S>) -> Self {
        let mut slope = self.slope;
        for i in 0..K {
            slope[i] = rule.slope(self.slope[i], other.slope[i]);
        }
        Self { value, slope }
    }

    /// Derivatives of derivatives are more numbers than there are registers: in separate functions they take no longer,
    /// and the engines half as long to compile.
    #[inline(never)]
    fn combine_apart(&self, other: &Self, value: S, rule: impl Rule<S>) -> Self {
        self.combine_here(other, value, rule)
    }
}

/// The derivative of a result from those of two operands. No closure: it would be compiled separately, without the instructions
/// of a batch.
trait Rule<S> {
    fn slope(&self, a: S, b: S) -> S;
}

struct Sum;
struct Difference;
/// Of two values.
struct Product<S>(S, S);
/// The quotient, and one over the divisor.
struct Quotient<S>(S, S);
/// By the derivative of a function of the first operand.
struct Scaled<S>(S);
/// Of the first operand where the mask holds.
struct Choice<M>(M);

impl<S: Scalar> Rule<S> for Sum {
    #[inline(always)]
    fn slope(&self, a: S, b: S) -> S {
        a + b
    }
}

impl<S: Scalar> Rule<S> for Difference {
    #[inline(always)]
    fn slope(&self, a: S, b: S) -> S {
        a - b
    }
}

impl<S: Scalar> Rule<S> for Product<S> {
    #[inline(always)]
    fn slope(&self, a: S, b: S) -> S {
        a * self.1 + b * self.0
    }
}

impl<S: Scalar> Rule<S> for Quotient<S> {
    #[inline(always)]
    fn slope(&self, a: S, b: S) -> S {
        (a - self.0 * b) * self.1
    }
}

impl<S: Scalar> Rule<S> for Scaled<S> {
    #[inline(always)]
    fn slope(&self, a: S, _: S) -> S {
        a * self.0
    }
}

impl<S: Scalar> Rule<S> for Choice<S::Mask> {
    #[inline(always)]
    fn slope(&self, a: S, b: S) -> S {
        S::select(self.0, a, b)
    }
}

impl<S: Scalar, const K: usize> Add for Dual<S, K> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, Sum)
    }
}

impl<S: Scalar, const K: usize> Sub for Dual<S, K> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, Difference)
    }
}

impl<S: Scalar, const K: usize> Mul for Dual<S, K> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, Product(self.value, other.value))
    }
}

impl<S: Scalar, const K: usize> Div for Dual<S, K> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (quotient, inverse) = (self.value / other.value, S::one() / other.value);
        self.combine(other, quotient, Quotient(quotient, inverse))
    }
}

impl<S: Scalar, const K: usize> Neg for Dual<S, K> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut slope = self.slope;
        for i in 0..K {
            slope[i] = -slope[i];
        }
        Self { value: -self.value, slope }
    }
}

impl<S: Scalar, const K: usize> Scalar for Dual<S, K> {
    type Mask = S::Mask;
    const IS_ONE: bool = S::IS_ONE;

    #[inline(always)]
    fn apart<W: Work>(work: W) -> W::Output {
        S::apart(work)
    }

    #[inline(always)]
    fn by<F: Function>(self) -> Self {
        let value = self.value.by::<F>();
        self.chain(value, F::slope(self.value, value))
    }

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value: S::constant(value), slope: [S::zero(); K] }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, S::constant(0.5) / root)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), S::one() / self.value)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let exponential = self.value.exp();
        self.chain(exponential, exponential)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        self.chain(self.value.exp_m1(), self.value.exp())
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }
    #[inline(always)]
    fn lt(self, other: Self) -> S::Mask {
        self.value.lt(other.value)
    }
    #[inline(always)]
    fn le(self, other: Self) -> S::Mask {
        self.value.le(other.value)
    }
    #[inline(always)]
    fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        yes.combine(no, S::select(mask, yes.value, no.value), Choice(mask))
    }
}

impl<S: Real, const K: usize> Real for Dual<S, K> {
    const HAS_DERIVATIVES: bool = true;
    #[inline(always)]
    fn value(self) -> f64 {
        self.value.value()
    }
}

impl<S: Scalar, const K: usize> Over<S> for Dual<S, K> {
    #[inline(always)]
    fn of(parameter: S) -> Self {
        Self { value: parameter, slope: [S::zero(); K] }
    }
}
