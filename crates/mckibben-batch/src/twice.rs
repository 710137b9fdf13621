//! Two registers as one vector.
//!
//! A rate is one long chain, in which each result waits for the one before; with two chains side by side the processor
//! works at one while the other waits.

use crate::wide::Wide;
use mckibben::scalar::{Mask, Scalar, Work};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Two vectors of the same kind, the lanes of one after those of the other.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Twice<V>(V, V);

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {$(
        impl<V: $trait<Output = V>> $trait for Twice<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0), $trait::$method(self.1, other.1))
            }
        }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor);

impl<V: Neg<Output = V>> Neg for Twice<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<M: Not<Output = M>> Not for Twice<M> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

impl<M: Mask> Mask for Twice<M> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(M::splat(value), M::splat(value))
    }
    #[inline(always)]
    fn any(self) -> bool {
        (self.0 | self.1).any()
    }
}

macro_rules! of_both {
    ($($function:ident),*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            Self(self.0.$function(), self.1.$function())
        }
    )*};
}

impl<V: Scalar> Scalar for Twice<V> {
    type Mask = Twice<V::Mask>;

    #[inline(always)]
    fn apart<W: Work>(work: W) -> W::Output {
        V::apart(work)
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        let both = V::constant(value);
        Self(both, both)
    }
    of_both!(sqrt, ln, exp, exp_m1, sin, cos);
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        Twice(self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        Twice(self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(V::select(mask.0, yes.0, no.0), V::select(mask.1, yes.1, no.1))
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self(self.0.smaller(other.0), self.1.smaller(other.1))
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(self.0.larger(other.0), self.1.larger(other.1))
    }
}

impl<V: Wide> Wide for Twice<V> {
    type Lane = V::Lane;
    type Instructions = V::Instructions;
    const LANES: usize = 2 * V::LANES;

    #[inline(always)]
    fn from_lanes(mut lane: impl FnMut(usize) -> V::Lane) -> Self {
        let both = V::constant(0.0);
        let mut wide = Self(both, both);
        for index in 0..Self::LANES {
            wide.put(index, lane(index));
        }
        wide
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> V::Lane {
        if lane < V::LANES { self.0.lane(lane) } else { self.1.lane(lane - V::LANES) }
    }
    #[inline(always)]
    fn put(&mut self, lane: usize, value: V::Lane) {
        if lane < V::LANES { self.0.put(lane, value) } else { self.1.put(lane - V::LANES, value) }
    }
}
