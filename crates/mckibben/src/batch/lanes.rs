//! Vectors of lanes: several rows of a batch as one scalar.
//!
//! [`Lanes`] is an array whose every operation goes over all lanes. In a function that is compiled for a wide
//! instruction set the array becomes one or two registers and each operation one or two instructions; nothing here is
//! particular to a machine.
//!
//! `multiply_add` rounds once where `FUSED`, twice where not. Every other operation rounds once on any machine, so a row
//! has the same bits whatever its lane.

use crate::scalar::{Mask, Real, Scalar, Vector};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A floating-point type that lanes are made of.
pub trait Number: Real + PartialOrd {
    /// `self · factor + addend` with one rounding.
    fn fused(self, factor: Self, addend: Self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn fused(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
}

impl Number for f32 {
    #[inline(always)]
    fn fused(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
}

/// `N` lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<F, const N: usize, const FUSED: bool>([F; N]);

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

impl<F: Number, const N: usize, const FUSED: bool> Lanes<F, N, FUSED> {
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
        impl<F: Number, const N: usize, const FUSED: bool> $trait for Lanes<F, N, FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| $trait::$method(a, b))
            }
        }
    )*};
}
operator!(Add add, Sub sub, Mul mul, Div div);

impl<F: Number, const N: usize, const FUSED: bool> Neg for Lanes<F, N, FUSED> {
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

impl<F: Number, const N: usize, const FUSED: bool> Scalar for Lanes<F, N, FUSED> {
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

macro_rules! vector {
    ($number:ident) => {
        impl<const N: usize, const FUSED: bool> Vector for Lanes<$number, N, FUSED> {
            type Lane = f64;
            type Time = Lanes<f64, N, FUSED>;
            const LANES: usize = N;

            #[inline(always)]
            fn from_lanes(mut lane: impl FnMut(usize) -> f64) -> Self {
                let mut out = [0.0; N];
                for n in 0..N {
                    out[n] = lane(n) as $number;
                }
                Self(out)
            }
            #[inline(always)]
            fn lane(&self, lane: usize) -> f64 {
                self.0[lane] as f64
            }
            #[inline(always)]
            fn mask(mut lane: impl FnMut(usize) -> bool) -> LaneMask<N> {
                let mut out = [false; N];
                for n in 0..N {
                    out[n] = lane(n);
                }
                LaneMask(out)
            }
            #[inline(always)]
            fn holds(mask: LaneMask<N>, lane: usize) -> bool {
                mask.0[lane]
            }
            #[inline(always)]
            fn of_time(time: Self::Time) -> Self {
                let mut out = [0.0; N];
                for n in 0..N {
                    out[n] = time.0[n] as $number;
                }
                Self(out)
            }
            #[inline(always)]
            fn to_time(self) -> Self::Time {
                let mut out = [0.0; N];
                for n in 0..N {
                    out[n] = self.0[n] as f64;
                }
                Lanes(out)
            }
        }
    };
}
vector!(f64);
vector!(f32);
