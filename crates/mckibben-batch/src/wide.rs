//! Vectors of lanes: several elements of a batch as one scalar, in one register.
//!
//! A vector carries the proof that its instructions exist on this machine, a value without size; an operation is one
//! instruction, and rounds like the same operation on one number. A constant has no operand, so it takes the
//! proof from the thread, where [`compiled`] has left it.

use mckibben::scalar::{Mask, Real, Scalar, Work};
use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::{Simd, WithSimd};
use std::cell::Cell;
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A number that lanes hold.
pub(crate) trait Number: Real + PartialEq + Send + Sync {}
impl Number for f64 {}

/// A scalar of several lanes that can be looked at one by one.
pub(crate) trait Wide: Scalar<Mask: Send + Sync> + Send + Sync {
    /// What a lane holds.
    type Lane: Number;
    /// The instructions that it needs.
    type Instructions: Instructions;
    /// How many lanes there are.
    const LANES: usize;

    /// Lanes from a function of their index.
    fn from_lanes(lane: impl FnMut(usize) -> Self::Lane) -> Self;
    /// What a lane holds.
    fn lane(&self, lane: usize) -> Self::Lane;
    /// Changes what a lane holds.
    fn put(&mut self, lane: usize, value: Self::Lane);

    /// Notes of a lane, in a number that becomes a mask, whether something holds: 1 where it does, else 0.
    fn mark(&mut self, lane: usize, holds: bool) {
        self.put(lane, Self::Lane::constant(if holds { 1.0 } else { 0.0 }));
    }
    /// Whether something holds in any lane.
    fn is_marked(&self) -> bool {
        (0..Self::LANES).any(|lane| Self::Lane::constant(0.0).lt(self.lane(lane)))
    }
}

/// Vector instructions that a thread can be set to.
pub(crate) trait Instructions: Simd {
    /// A value without size that stands where a register would: at an address that it loads from at once.
    type Place: Copy + Debug + Default + Send + Sync + 'static;

    /// Proof that the machine has them.
    fn detect() -> Option<Self>;
    /// Leaves the proof with the thread.
    fn keep(self);
    /// The proof, in work that is [`compiled`].
    fn present() -> Self;
}

/// Work that is compiled for the instructions of a vector.
pub(crate) trait Compiled {
    /// The vector.
    type Wide: Wide;
    /// What comes out of it.
    type Output;
    /// Does the work.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

struct Vectorized<K>(K);

impl<K: Compiled> WithSimd for Vectorized<K> {
    type Output = K::Output;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> K::Output {
        self.0.run(simd)
    }
}

struct Apart<W>(W);

impl<W: Work> WithSimd for Apart<W> {
    type Output = W::Output;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> W::Output {
        self.0.done()
    }
}

/// Does work with the instructions that it is compiled for; vectors may be made of nothing in it.
///
/// Blocks are made only of vectors whose instructions the machine has.
pub(crate) fn compiled<K: Compiled>(work: K) -> K::Output {
    match <<K::Wide as Wide>::Instructions as Instructions>::detect() {
        Some(instructions) => {
            Instructions::keep(instructions);
            instructions.vectorize(Vectorized(work))
        }
        None => unreachable!("a batch is made of vectors that the machine has"),
    }
}

/// Where a register of 256 bits stands.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub(crate) struct Place256;

/// Where a register of 512 bits stands.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Place512;

macro_rules! instructions {
    ($($simd:path, $place:ty, $proof:ident, $detect:expr);* $(;)?) => {$(
        std::thread_local! {
            static $proof: Cell<Option<$simd>> = const { Cell::new(None) };
        }
        impl Instructions for $simd {
            type Place = $place;
            fn detect() -> Option<Self> {
                $detect
            }
            fn keep(self) {
                $proof.set(Some(self));
            }
            #[inline(always)]
            fn present() -> Self {
                match $proof.get() {
                    Some(proof) => proof,
                    None => unreachable!("a vector is made only in work that is compiled for it"),
                }
            }
        }
    )*};
}
#[cfg(target_arch = "x86_64")]
instructions! {
    pulp::x86::V3, Place256, AVX2, pulp::x86::V3::try_new();
    pulp::x86::V4, Place512, AVX512, pulp::x86::V4::try_new();
}

macro_rules! operators {
    ($wide:ident: $($trait:ident $method:ident $operation:ident),*) => {$(
        impl<S: Instructions> $trait for $wide<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { lanes: self.simd.$operation(self.lanes, other.lanes), ..self }
            }
        }
    )*};
}

macro_rules! one_by_one {
    ($($function:ident),*) => {$(
        fn $function(self) -> Self {
            Self::from_lanes(|lane| Scalar::$function(self.lane(lane)))
        }
    )*};
}

macro_rules! wide {
    ($number:ident, $wide:ident($lanes:ident), $mask:ident($mask_lanes:ident);
     $add:ident $sub:ident $mul:ident $div:ident $xor:ident $sqrt:ident $splat:ident $lt:ident $le:ident $select:ident
     $min:ident $max:ident $and:ident $or:ident $not:ident $first:ident) => {
        #[doc = concat!("A register of `", stringify!($number), "`.")]
        #[derive(Clone, Copy, Debug)]
        #[repr(C)]
        pub(crate) struct $wide<S: Instructions> {
            simd: S,
            place: S::Place,
            lanes: S::$lanes,
        }

        #[doc = concat!("Truth values for the lanes of a register of `", stringify!($number), "`.")]
        #[derive(Clone, Copy, Debug)]
        #[repr(C)]
        pub(crate) struct $mask<S: Instructions> {
            simd: S,
            lanes: S::$mask_lanes,
        }

        operators!($wide: Add add $add, Sub sub $sub, Mul mul $mul, Div div $div);
        operators!($mask: BitAnd bitand $and, BitOr bitor $or);

        impl<S: Instructions> Neg for $wide<S> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // The library's own function is not always inlined, and then knows nothing of the instructions.
                Self { lanes: self.simd.$xor(self.lanes, self.simd.$splat(-0.0)), ..self }
            }
        }

        impl<S: Instructions> Not for $mask<S> {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self { lanes: self.simd.$not(self.lanes), ..self }
            }
        }

        impl<S: Instructions> Mask for $mask<S> {
            #[inline(always)]
            fn splat(value: bool) -> Self {
                $wide::zero().lt($wide::constant(if value { 1.0 } else { 0.0 }))
            }
            #[inline(always)]
            fn any(self) -> bool {
                self.simd.$first(self.lanes) < $wide::<S>::LANES
            }
        }

        impl<S: Instructions> Scalar for $wide<S> {
            type Mask = $mask<S>;

            #[inline(always)]
            fn apart<W: Work>(work: W) -> W::Output {
                S::present().vectorize(Apart(work))
            }
            #[inline(always)]
            fn constant(value: f64) -> Self {
                let simd = S::present();
                Self { simd, place: S::Place::default(), lanes: simd.$splat(value as $number) }
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self { lanes: self.simd.$sqrt(self.lanes), ..self }
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
            fn lt(self, other: Self) -> $mask<S> {
                $mask { simd: self.simd, lanes: self.simd.$lt(self.lanes, other.lanes) }
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask<S> {
                $mask { simd: self.simd, lanes: self.simd.$le(self.lanes, other.lanes) }
            }
            #[inline(always)]
            fn select(mask: $mask<S>, yes: Self, no: Self) -> Self {
                Self { lanes: yes.simd.$select(mask.lanes, yes.lanes, no.lanes), ..yes }
            }
            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                // A register's minimum is its second number where the two do not compare, as it is here.
                Self { lanes: self.simd.$min(self.lanes, other.lanes), ..self }
            }
            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                Self { lanes: self.simd.$max(other.lanes, self.lanes), ..self }
            }
        }

        impl<S: Instructions> Wide for $wide<S> {
            type Lane = $number;
            type Instructions = S;
            const LANES: usize = size_of::<S::$lanes>() / size_of::<$number>();

            #[inline(always)]
            fn from_lanes(mut lane: impl FnMut(usize) -> $number) -> Self {
                let mut wide = Self::constant(0.0);
                for (index, value) in cast_slice_mut::<_, $number>(std::slice::from_mut(&mut wide.lanes)).iter_mut().enumerate() {
                    *value = lane(index);
                }
                wide
            }
            #[inline(always)]
            fn lane(&self, lane: usize) -> $number {
                cast_slice::<_, $number>(std::slice::from_ref(&self.lanes))[lane]
            }
            #[inline(always)]
            fn put(&mut self, lane: usize, value: $number) {
                cast_slice_mut::<_, $number>(std::slice::from_mut(&mut self.lanes))[lane] = value;
            }
        }
    };
}

wide! {
    f64, Doubles(f64s), DoubleMask(m64s);
    add_f64s sub_f64s mul_f64s div_f64s xor_f64s sqrt_f64s splat_f64s less_than_f64s less_than_or_equal_f64s select_f64s
    min_f64s max_f64s and_m64s or_m64s not_m64s first_true_m64s
}
