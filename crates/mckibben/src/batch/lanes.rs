//! Vectors of lanes: several rows of a batch as one scalar.
//!
//! [`Lanes`] is an array whose every operation goes over all lanes. In a function that is compiled for a wide
//! instruction set the array becomes a register and each operation one instruction; nothing here is particular to a
//! machine. [`Pair`] puts two of them side by side, so that one may be computed while the other waits for a root or a
//! quotient, and [`One`] is a single lane with the same arithmetic, for a row that goes on alone.
//!
//! `multiply_add` rounds once where `FUSED`, twice where not. Every other operation rounds once on any machine, so a row
//! has the same bits whatever the number of lanes.

use crate::scalar::{Mask, Real, Scalar};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A floating-point type that lanes are made of.
pub trait Float: Real + PartialOrd + Default + Send + Sync {
    /// `self · factor + addend` with one rounding.
    fn fused(self, factor: Self, addend: Self) -> Self;
    /// The nearest value of this type.
    fn nearest(value: f64) -> Self;
}

impl Float for f64 {
    #[inline(always)]
    fn fused(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
    #[inline(always)]
    fn nearest(value: f64) -> Self {
        value
    }
}

impl Float for f32 {
    #[inline(always)]
    fn fused(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
    #[inline(always)]
    fn nearest(value: f64) -> Self {
        value as f32
    }
}

/// A scalar made of lanes.
pub trait Vector: Scalar {
    /// What a lane holds.
    type Float: Float;
    /// One lane by itself, with the same arithmetic.
    type Single: Real;
    /// How many lanes there are.
    const LANES: usize;

    /// Lanes from a function of their index.
    fn from_lanes(lane: impl FnMut(usize) -> Self::Float) -> Self;
    /// What a lane holds.
    fn lane(&self, lane: usize) -> Self::Float;
    /// Whether the mask holds in a lane.
    fn holds(mask: Self::Mask, lane: usize) -> bool;
    /// A mask from a function of the lane's index.
    fn mask(lane: impl FnMut(usize) -> bool) -> Self::Mask;
    /// One lane's number as a scalar of its own.
    fn single(value: Self::Float) -> Self::Single;
    /// The number of a single lane.
    fn number(single: Self::Single) -> Self::Float;
}

/// `N` lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<F, const N: usize, const FUSED: bool>(pub(crate) [F; N]);

/// Truth values of `N` lanes.
#[derive(Clone, Copy, Debug)]
pub struct LaneMask<const N: usize>([bool; N]);

impl<const N: usize> LaneMask<N> {
    #[inline(always)]
    fn zip(self, other: Self, combine: impl Fn(bool, bool) -> bool) -> Self {
        let mut out = [false; N];
        for n in 0..N {
            out[n] = combine(self.0[n], other.0[n]);
        }
        Self(out)
    }
}

impl<const N: usize> BitAnd for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        self.zip(other, |a, b| a & b)
    }
}
impl<const N: usize> BitOr for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        self.zip(other, |a, b| a | b)
    }
}
impl<const N: usize> Not for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        self.zip(self, |a, _| !a)
    }
}
impl<const N: usize> Mask for LaneMask<N> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn any(self) -> bool {
        let mut any = false;
        for n in 0..N {
            any |= self.0[n];
        }
        any
    }
}

impl<F: Float, const N: usize, const FUSED: bool> Lanes<F, N, FUSED> {
    #[inline(always)]
    fn each(self, function: impl Fn(F) -> F) -> Self {
        let mut out = self.0;
        for n in 0..N {
            out[n] = function(self.0[n]);
        }
        Self(out)
    }
    #[inline(always)]
    fn zip(self, other: Self, combine: impl Fn(F, F) -> F) -> Self {
        let mut out = self.0;
        for n in 0..N {
            out[n] = combine(self.0[n], other.0[n]);
        }
        Self(out)
    }
    #[inline(always)]
    fn compare(self, other: Self, holds: impl Fn(&F, &F) -> bool) -> LaneMask<N> {
        let mut out = [false; N];
        for n in 0..N {
            out[n] = holds(&self.0[n], &other.0[n]);
        }
        LaneMask(out)
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {$(
        impl<F: Float, const N: usize, const FUSED: bool> $trait for Lanes<F, N, FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| $trait::$method(a, b))
            }
        }
    )*};
}
operator!(Add add, Sub sub, Mul mul, Div div);

impl<F: Float, const N: usize, const FUSED: bool> Neg for Lanes<F, N, FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(|a| -a)
    }
}

macro_rules! functions {
    ($($function:ident),*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            self.each(Scalar::$function)
        }
    )*};
}

impl<F: Float, const N: usize, const FUSED: bool> Scalar for Lanes<F, N, FUSED> {
    type Mask = LaneMask<N>;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([F::constant(value); N])
    }
    functions!(sqrt, ln, exp, exp_m1, sin, cos);
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<N> {
        self.compare(other, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> LaneMask<N> {
        self.compare(other, |a, b| a <= b)
    }
    #[inline(always)]
    fn select(mask: LaneMask<N>, yes: Self, no: Self) -> Self {
        let mut out = no.0;
        for n in 0..N {
            out[n] = if mask.0[n] { yes.0[n] } else { no.0[n] };
        }
        Self(out)
    }
    #[inline(always)]
    fn multiply_add(self, factor: Self, addend: Self) -> Self {
        if !FUSED {
            return self * factor + addend;
        }
        let mut out = addend.0;
        for n in 0..N {
            out[n] = self.0[n].fused(factor.0[n], addend.0[n]);
        }
        Self(out)
    }
}

/// A single lane with the arithmetic of [`Lanes`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct One<F, const FUSED: bool>(pub(crate) F);

macro_rules! operator_of_one {
    ($($trait:ident $method:ident),*) => {$(
        impl<F: Float, const FUSED: bool> $trait for One<F, FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}
operator_of_one!(Add add, Sub sub, Mul mul, Div div);

impl<F: Float, const FUSED: bool> Neg for One<F, FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

macro_rules! functions_of_one {
    ($($function:ident),*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            Self(Scalar::$function(self.0))
        }
    )*};
}

impl<F: Float, const FUSED: bool> Scalar for One<F, FUSED> {
    type Mask = bool;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(F::constant(value))
    }
    functions_of_one!(sqrt, ln, exp, exp_m1, sin, cos);
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.0 < other.0
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self.0 <= other.0
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn multiply_add(self, factor: Self, addend: Self) -> Self {
        Self(if FUSED { self.0.fused(factor.0, addend.0) } else { self.0 * factor.0 + addend.0 })
    }
}

impl<F: Float, const FUSED: bool> Real for One<F, FUSED> {
    #[inline(always)]
    fn value(self) -> f64 {
        self.0.value()
    }
}

impl<F: Float, const N: usize, const FUSED: bool> Vector for Lanes<F, N, FUSED> {
    type Float = F;
    type Single = One<F, FUSED>;
    const LANES: usize = N;

    #[inline(always)]
    fn from_lanes(lane: impl FnMut(usize) -> F) -> Self {
        Self(core::array::from_fn(lane))
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> F {
        self.0[lane]
    }
    #[inline(always)]
    fn holds(mask: LaneMask<N>, lane: usize) -> bool {
        mask.0[lane]
    }
    #[inline(always)]
    fn mask(lane: impl FnMut(usize) -> bool) -> LaneMask<N> {
        LaneMask(core::array::from_fn(lane))
    }
    #[inline(always)]
    fn single(value: F) -> One<F, FUSED> {
        One(value)
    }
    #[inline(always)]
    fn number(single: One<F, FUSED>) -> F {
        single.0
    }
}

/// Two vectors side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Pair<L>(L, L);

impl<M: BitAnd<Output = M>> BitAnd for Pair<M> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0, self.1 & other.1)
    }
}
impl<M: BitOr<Output = M>> BitOr for Pair<M> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0, self.1 | other.1)
    }
}
impl<M: Not<Output = M>> Not for Pair<M> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}
impl<M: Mask> Mask for Pair<M> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(M::splat(value), M::splat(value))
    }
    #[inline(always)]
    fn any(self) -> bool {
        (self.0 | self.1).any()
    }
}

macro_rules! operator_of_pair {
    ($($trait:ident $method:ident),*) => {$(
        impl<L: Scalar> $trait for Pair<L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0), $trait::$method(self.1, other.1))
            }
        }
    )*};
}
operator_of_pair!(Add add, Sub sub, Mul mul, Div div);

impl<L: Scalar> Neg for Pair<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

macro_rules! functions_of_pair {
    ($($function:ident),*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            Self(self.0.$function(), self.1.$function())
        }
    )*};
}

impl<L: Scalar> Scalar for Pair<L> {
    type Mask = Pair<L::Mask>;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(L::constant(value), L::constant(value))
    }
    functions_of_pair!(sqrt, ln, exp, exp_m1, sin, cos);
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        Pair(self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        Pair(self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(L::select(mask.0, yes.0, no.0), L::select(mask.1, yes.1, no.1))
    }
    #[inline(always)]
    fn multiply_add(self, factor: Self, addend: Self) -> Self {
        Self(self.0.multiply_add(factor.0, addend.0), self.1.multiply_add(factor.1, addend.1))
    }
}

impl<L: Vector> Vector for Pair<L> {
    type Float = L::Float;
    type Single = L::Single;
    const LANES: usize = 2 * L::LANES;

    #[inline(always)]
    fn from_lanes(mut lane: impl FnMut(usize) -> L::Float) -> Self {
        Self(L::from_lanes(&mut lane), L::from_lanes(|n| lane(n + L::LANES)))
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> L::Float {
        if lane < L::LANES { self.0.lane(lane) } else { self.1.lane(lane - L::LANES) }
    }
    #[inline(always)]
    fn holds(mask: Self::Mask, lane: usize) -> bool {
        if lane < L::LANES { L::holds(mask.0, lane) } else { L::holds(mask.1, lane - L::LANES) }
    }
    #[inline(always)]
    fn mask(mut lane: impl FnMut(usize) -> bool) -> Self::Mask {
        Pair(L::mask(&mut lane), L::mask(|n| lane(n + L::LANES)))
    }
    #[inline(always)]
    fn single(value: L::Float) -> L::Single {
        L::single(value)
    }
    #[inline(always)]
    fn number(single: L::Single) -> L::Float {
        L::number(single)
    }
}
