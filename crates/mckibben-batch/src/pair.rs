//! Pairs of registers as vectors: one type for each set of instructions and each kind of number.
//!
//! A rate is one long chain, in which each result waits for the one before; with two chains side by side the processor
//! works at one while the other waits.
//!
//! An operation of a pair is two instructions with no function between: with functions around each, the compiler takes twice as long and
//! twice the memory.

use crate::group::FEW;
use crate::wide::{Apart, Instructions, Wide};
use mckibben::scalar::{Mask, Scalar, Work};
use pulp::Simd;
use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::x86::{V3, V4};
#[cfg(feature = "f32")]
use std::arch::x86_64::{__m256, __m512, __mmask16};
use std::arch::x86_64::{__m256d, __m512d, __mmask8, _CMP_LE_OQ, _CMP_LT_OQ};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use std::slice;

macro_rules! binary {
    ($wide:ident, $part:ident: $($trait:ident $method:ident $operation:ident),*) => {$(
        impl $trait for $wide {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let simd = self.simd;
                Self { one: simd.$part.$operation(self.one, other.one), two: simd.$part.$operation(self.two, other.two), simd }
            }
        }
    )*};
}

/// What comes of the first registers of two pairs, and of the second.
macro_rules! both {
    ($mask:ident, ($these:expr, $those:expr), |$s:ident, $x:ident, $y:ident| $work:expr) => {{
        let $s = $these.simd;
        let one = {
            let ($x, $y) = ($these.one, $those.one);
            $work
        };
        let two = {
            let ($x, $y) = ($these.two, $those.two);
            $work
        };
        $mask { one, two, simd: $s }
    }};
}

macro_rules! one_by_one {
    ($($function:ident),*) => {$(
        fn $function(self) -> Self {
            Self::from_lanes(|lane| Scalar::$function(self.lane(lane)))
        }
    )*};
}

/// A pair of registers of some numbers, and a pair of truth values for each of them.
macro_rules! pair {
    ($wide:ident, $mask:ident, $number:ident in $register:ty, $flags:ty, $simd:ty;
     $part:ident: $add:ident $sub:ident $mul:ident $div:ident $min:ident $max:ident $sqrt:ident $splat:ident;
     $bits:ident: $xor:ident;
     margin $margin:literal, longest $longest:expr;
     |$s:ident, $x:ident, $y:ident, $m:ident|
     lt $lt:expr, le $le:expr, select $select:expr, and $and:expr, or $or:expr, not $not:expr, any $any:expr) => {
        #[doc = concat!("Two registers of `", stringify!($number), "`.")]
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $wide {
            one: $register,
            two: $register,
            simd: $simd,
        }

        #[doc = concat!("Truth values for two registers of `", stringify!($number), "`.")]
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $mask {
            one: $flags,
            two: $flags,
            simd: $simd,
        }

        binary!($wide, $part: Add add $add, Sub sub $sub, Mul mul $mul, Div div $div);

        impl Neg for $wide {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let (simd, sign) = (self.simd, self.simd.$part.$splat(-0.0));
                Self { one: simd.$bits.$xor(self.one, sign), two: simd.$bits.$xor(self.two, sign), simd }
            }
        }

        impl BitAnd for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                both!($mask, (self, other), |$s, $x, $y| $and)
            }
        }

        impl BitOr for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                both!($mask, (self, other), |$s, $x, $y| $or)
            }
        }

        impl Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                let $s = self.simd;
                let (one, two) = ({ let $x = self.one; $not }, { let $x = self.two; $not });
                Self { one, two, simd: $s }
            }
        }

        impl Mask for $mask {
            #[inline(always)]
            fn splat(value: bool) -> Self {
                $wide::zero().lt($wide::constant(if value { 1.0 } else { 0.0 }))
            }
            #[inline(always)]
            #[allow(unused_variables)]
            fn any(self) -> bool {
                let $s = self.simd;
                let $x = { let ($x, $y) = (self.one, self.two); $or };
                $any
            }
        }

        impl Scalar for $wide {
            type Mask = $mask;
            const ROUNDS: f64 = 1.5 * (1_u64 << ($number::MANTISSA_DIGITS - 1)) as f64;

            #[inline(always)]
            fn apart<W: Work>(work: W) -> W::Output {
                Simd::vectorize(<$simd>::present(), Apart(work))
            }
            #[inline(always)]
            fn constant(value: f64) -> Self {
                let simd = <$simd>::present();
                let both = simd.$part.$splat(value as $number);
                Self { one: both, two: both, simd }
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                let simd = self.simd;
                Self { one: simd.$part.$sqrt(self.one), two: simd.$part.$sqrt(self.two), simd }
            }
            one_by_one!(ln, exp, exp_m1);
            #[inline(always)]
            fn sin(self) -> Self {
                mckibben::internals::sine(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                mckibben::internals::cosine(self)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $mask {
                both!($mask, (self, other), |$s, $x, $y| $lt)
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask {
                both!($mask, (self, other), |$s, $x, $y| $le)
            }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                let $s = yes.simd;
                let one = { let ($m, $x, $y) = (mask.one, yes.one, no.one); $select };
                let two = { let ($m, $x, $y) = (mask.two, yes.two, no.two); $select };
                Self { one, two, simd: $s }
            }
            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                // A register's minimum is its second number where the two do not compare, as it is here.
                let simd = self.simd;
                Self { one: simd.$part.$min(self.one, other.one), two: simd.$part.$min(self.two, other.two), simd }
            }
            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                let simd = self.simd;
                Self { one: simd.$part.$max(other.one, self.one), two: simd.$part.$max(other.two, self.two), simd }
            }
        }

        impl Wide for $wide {
            type Instructions = $simd;
            const LANES: usize = 2 * size_of::<$register>() / size_of::<$number>();
            const LARGEST: f64 = $number::MAX as f64;
            const SMALLEST: f64 = $number::MIN_POSITIVE as f64;
            const MARGIN: f64 = $margin;
            const LONGEST: f64 = $longest;
            const FEW: usize = if size_of::<$number>() < size_of::<f64>() { 1 } else { FEW };

            #[inline(always)]
            fn from_lanes(mut lane: impl FnMut(usize) -> f64) -> Self {
                let mut wide = Self::constant(0.0);
                for index in 0..Self::LANES {
                    wide.put(index, lane(index));
                }
                wide
            }
            #[inline(always)]
            fn lane(&self, lane: usize) -> f64 {
                let each = Self::LANES / 2;
                let register = if lane < each { &self.one } else { &self.two };
                cast_slice::<_, $number>(slice::from_ref(register))[lane % each] as f64
            }
            #[inline(always)]
            fn put(&mut self, lane: usize, value: f64) {
                let each = Self::LANES / 2;
                let register = if lane < each { &mut self.one } else { &mut self.two };
                cast_slice_mut::<_, $number>(slice::from_mut(register))[lane % each] = value as $number;
            }
            fn below(bound: f64) -> f64 {
                let nearest = bound as $number;
                (if (nearest as f64) < bound { nearest } else { nearest.next_down() }) as f64
            }
        }
    };
}

pair! {
    Doubles256, DoubleMask256, f64 in __m256d, __m256d, V3;
    avx: _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_min_pd _mm256_max_pd _mm256_sqrt_pd _mm256_set1_pd;
    avx: _mm256_xor_pd;
    margin 1e-9, longest f64::INFINITY;
    |s, x, y, m|
    lt s.avx._mm256_cmp_pd::<_CMP_LT_OQ>(x, y), le s.avx._mm256_cmp_pd::<_CMP_LE_OQ>(x, y),
    select s.avx._mm256_blendv_pd(y, x, m), and s.avx._mm256_and_pd(x, y), or s.avx._mm256_or_pd(x, y),
    not s.avx._mm256_xor_pd(x, s.avx._mm256_castsi256_pd(s.avx._mm256_set1_epi64x(-1))), any s.avx._mm256_movemask_pd(x) != 0
}
pair! {
    Doubles512, DoubleMask512, f64 in __m512d, __mmask8, V4;
    avx512f: _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_min_pd _mm512_max_pd _mm512_sqrt_pd _mm512_set1_pd;
    avx512dq: _mm512_xor_pd;
    margin 1e-9, longest f64::INFINITY;
    |s, x, y, m|
    lt s.avx512f._mm512_cmp_pd_mask::<_CMP_LT_OQ>(x, y), le s.avx512f._mm512_cmp_pd_mask::<_CMP_LE_OQ>(x, y),
    select s.avx512f._mm512_mask_blend_pd(m, y, x), and x & y, or x | y, not !x, any x != 0
}

// The last digit of a number is 6e-8 of it: of times up to two seconds that is 1e-7 s. Whether something holds takes five digits to say.
#[cfg(feature = "f32")]
pair! {
    Singles256, SingleMask256, f32 in __m256, __m256, V3;
    avx: _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_min_ps _mm256_max_ps _mm256_sqrt_ps _mm256_set1_ps;
    avx: _mm256_xor_ps;
    margin 1e-5, longest 2.0;
    |s, x, y, m|
    lt s.avx._mm256_cmp_ps::<_CMP_LT_OQ>(x, y), le s.avx._mm256_cmp_ps::<_CMP_LE_OQ>(x, y),
    select s.avx._mm256_blendv_ps(y, x, m), and s.avx._mm256_and_ps(x, y), or s.avx._mm256_or_ps(x, y),
    not s.avx._mm256_xor_ps(x, s.avx._mm256_castsi256_ps(s.avx._mm256_set1_epi64x(-1))), any s.avx._mm256_movemask_ps(x) != 0
}
#[cfg(feature = "f32")]
pair! {
    Singles512, SingleMask512, f32 in __m512, __mmask16, V4;
    avx512f: _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_min_ps _mm512_max_ps _mm512_sqrt_ps _mm512_set1_ps;
    avx512dq: _mm512_xor_ps;
    margin 1e-5, longest 2.0;
    |s, x, y, m|
    lt s.avx512f._mm512_cmp_ps_mask::<_CMP_LT_OQ>(x, y), le s.avx512f._mm512_cmp_ps_mask::<_CMP_LE_OQ>(x, y),
    select s.avx512f._mm512_mask_blend_ps(m, y, x), and x & y, or x | y, not !x, any x != 0
}
