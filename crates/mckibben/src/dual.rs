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
use core::marker::PhantomData;
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

    #[inline(always)]
    fn operate(self, other: Self, operation: impl Operation<S>) -> Self {
        if S::IS_ONE && size_of::<Self>() > MOST_INLINE {
            self.operate_apart(&other, operation)
        } else {
            operation.done(&self, &other)
        }
    }

    /// Derivatives of derivatives are more numbers than there are registers: whole operations on them are separate functions, and
    /// the engines take much less time to compile.
    #[inline(never)]
    fn operate_apart(&self, other: &Self, operation: impl Operation<S>) -> Self {
        operation.done(self, other)
    }
}

/// What is done with two operands, or with the first alone. No closure: it would be compiled separately, without the
/// instructions of a batch.
trait Operation<S: Scalar> {
    fn done<const K: usize>(self, first: &Dual<S, K>, second: &Dual<S, K>) -> Dual<S, K>;
}

/// An operation from its value, and its derivative from those of the operands.
macro_rules! operations {
    ($($name:ident$(<$function:ident>)?($a:ident, $b:ident; $from_a:ident, $from_b:ident) {
        $(let $known:ident = $by:expr;)*
        $value:expr => $slope:expr
    })*) => {$(
        struct $name$(<$function>(PhantomData<$function>))?;

        impl<S: Scalar, $($function: Function)?> Operation<S> for $name$(<$function>)? {
            #[inline(always)]
            fn done<const K: usize>(self, first: &Dual<S, K>, second: &Dual<S, K>) -> Dual<S, K> {
                let ($a, $b) = (first.value, second.value);
                $(let $known = $by;)*
                let mut slope = first.slope;
                for i in 0..K {
                    let ($from_a, $from_b) = (first.slope[i], second.slope[i]);
                    slope[i] = $slope;
                }
                Dual { value: $value, slope }
            }
        }
    )*};
}

operations! {
    Sum(a, b; da, db) { a + b => da + db }
    Difference(a, b; da, db) { a - b => da - db }
    Product(a, b; da, db) { a * b => da * b + db * a }
    Quotient(a, b; da, db) {
        let quotient = a / b;
        let inverse = S::one() / b;
        quotient => (da - quotient * db) * inverse
    }
    Root(a, _b; da, _db) {
        let root = a.sqrt();
        let per = S::constant(0.5) / root;
        root => da * per
    }
    Logarithm(a, _b; da, _db) {
        let per = S::one() / a;
        a.ln() => da * per
    }
    Exponential(a, _b; da, _db) {
        let exponential = a.exp();
        exponential => da * exponential
    }
    ExponentialLessOne(a, _b; da, _db) {
        let per = a.exp();
        a.exp_m1() => da * per
    }
    Sine(a, _b; da, _db) {
        let per = a.cos();
        a.sin() => da * per
    }
    Cosine(a, _b; da, _db) {
        let per = -a.sin();
        a.cos() => da * per
    }
    Of<F>(a, _b; da, _db) {
        let value = a.by::<F>();
        let per = F::slope(a, value);
        value => da * per
    }
}

/// The first where the mask holds.
struct Choice<M>(M);

impl<S: Scalar> Operation<S> for Choice<S::Mask> {
    #[inline(always)]
    fn done<const K: usize>(self, first: &Dual<S, K>, second: &Dual<S, K>) -> Dual<S, K> {
        let mut slope = first.slope;
        for i in 0..K {
            slope[i] = S::select(self.0, first.slope[i], second.slope[i]);
        }
        Dual { value: S::select(self.0, first.value, second.value), slope }
    }
}

macro_rules! operators {
    ($($operator:ident $method:ident $operation:ident),*) => {$(
        impl<S: Scalar, const K: usize> $operator for Dual<S, K> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.operate(other, $operation)
            }
        }
    )*};
}

operators!(Add add Sum, Sub sub Difference, Mul mul Product, Div div Quotient);

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

macro_rules! functions {
    ($($function:ident $operation:ident),*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            self.operate(self, $operation)
        }
    )*};
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
        self.operate(self, Of::<F>(PhantomData))
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value: S::constant(value), slope: [S::zero(); K] }
    }
    functions!(sqrt Root, ln Logarithm, exp Exponential, exp_m1 ExponentialLessOne, sin Sine, cos Cosine);
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
        yes.operate(no, Choice(mask))
    }
}

impl<S: Real, const K: usize> Real for Dual<S, K> {
    const SLOPES: usize = K;
    #[inline(always)]
    fn value(self) -> f64 {
        self.value.value()
    }
    #[inline(always)]
    fn slope(self, direction: usize) -> f64 {
        self.slope[direction].value()
    }
}

impl<S: Scalar, const K: usize> Over<S> for Dual<S, K> {
    #[inline(always)]
    fn of(parameter: S) -> Self {
        Self { value: parameter, slope: [S::zero(); K] }
    }
}
