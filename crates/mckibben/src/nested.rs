//! One derivative more than a number has.
//!
//! Where a rate follows from a balance, it is a derivative of the balance's forces; its own derivatives, which a Jacobian or a
//! parameter needs, are then second ones. A dual number over a dual number carries both. It is a separate type, so that
//! a dual number's parameters stay those that it is over.
//!
//! Checked by `tests/tendon_located.rs`: derivatives with respect to parameters, through balances.

use crate::dual::Dual;
use crate::scalar::{Differentiable, Function, Over, Scalar, Work};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A dual number with one derivative more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nested<S, const K: usize>(Dual<Dual<S, K>, 1>);

macro_rules! operators {
    ($($operator:ident $method:ident),*) => {$(
        impl<S: Scalar, const K: usize> $operator for Nested<S, K> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div);

impl<S: Scalar, const K: usize> Neg for Nested<S, K> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

macro_rules! functions {
    ($($method:ident),*) => {$(
        #[inline(always)]
        fn $method(self) -> Self {
            Self(self.0.$method())
        }
    )*};
}

impl<S: Scalar, const K: usize> Scalar for Nested<S, K> {
    type Mask = S::Mask;
    const IS_ONE: bool = S::IS_ONE;

    functions!(sqrt, ln, exp, exp_m1, sin, cos);

    #[inline(always)]
    fn apart<W: Work>(work: W) -> W::Output {
        S::apart(work)
    }
    #[inline(always)]
    fn by<F: Function>(self) -> Self {
        Self(self.0.by::<F>())
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(Dual::constant(value))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> S::Mask {
        self.0.lt(other.0)
    }
    #[inline(always)]
    fn le(self, other: Self) -> S::Mask {
        self.0.le(other.0)
    }
    #[inline(always)]
    fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self(Dual::select(mask, yes.0, no.0))
    }
}

impl<S: Scalar, const K: usize> Over<S> for Nested<S, K> {
    #[inline(always)]
    fn of(parameter: S) -> Self {
        let parameter = Dual { value: parameter, slope: [S::zero(); K] };
        Self(Dual { value: parameter, slope: [Dual::zero()] })
    }
}

impl<S: Scalar> Differentiable<S> for S {
    type Dual = Dual<S, 1>;
    #[inline(always)]
    fn along(self, slope: Self) -> Dual<S, 1> {
        Dual { value: self, slope: [slope] }
    }
    #[inline(always)]
    fn split(Dual { value, slope: [slope] }: Dual<S, 1>) -> [Self; 2] {
        [value, slope]
    }
}

impl<S: Scalar, const K: usize> Differentiable<S> for Dual<S, K> {
    type Dual = Nested<S, K>;
    #[inline(always)]
    fn along(self, slope: Self) -> Nested<S, K> {
        Nested(Dual { value: self, slope: [slope] })
    }
    #[inline(always)]
    fn split(Nested(Dual { value, slope: [slope] }): Nested<S, K>) -> [Self; 2] {
        [value, slope]
    }
}
