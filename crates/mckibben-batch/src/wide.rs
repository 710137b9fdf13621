//! Vectors of lanes: several elements of a batch as one scalar.
//!
//! A vector carries the proof that its instructions exist on this machine, a value without size; an operation is one
//! instruction, and rounds like the same operation on one number. A constant has no operand, so it takes the
//! proof from the thread, where [`compiled`] has left it.

use mckibben::scalar::{Scalar, Work};
use pulp::{Simd, WithSimd};
use std::cell::Cell;

/// A scalar of several lanes that can be looked at one by one. What a lane holds is rounded to its numbers.
pub(crate) trait Wide: Scalar<Mask: Send + Sync> + Send + Sync {
    /// The instructions that it needs.
    type Instructions: Instructions;
    /// How many lanes there are.
    const LANES: usize;
    /// The largest number of a lane, and the smallest above zero that has all of its digits.
    const LARGEST: f64;
    const SMALLEST: f64;
    /// Part of a sum by which it must keep away from a bound, so that no rounding decides.
    const MARGIN: f64;
    /// The longest time in s of which lanes have digits enough: later times are counted from a later origin.
    const LONGEST: f64;
    /// The least number of rows that go on side by side after an event; fewer are scalar instances, which is less work. A row of lower
    /// precision must not depend on how many stand beside it, and never is one.
    const FEW: usize;

    /// Lanes from a function of their index.
    fn from_lanes(lane: impl FnMut(usize) -> f64) -> Self;
    /// What a lane holds.
    fn lane(&self, lane: usize) -> f64;
    /// Changes what a lane holds.
    fn put(&mut self, lane: usize, value: f64);
    /// The largest number of a lane below another.
    fn below(bound: f64) -> f64;

    /// Notes of a lane, in a number that becomes a mask, whether something holds: 1 where it does, else 0.
    fn mark(&mut self, lane: usize, holds: bool) {
        self.put(lane, if holds { 1.0 } else { 0.0 });
    }
    /// Whether something holds in any lane.
    fn is_marked(&self) -> bool {
        (0..Self::LANES).any(|lane| 0.0 < self.lane(lane))
    }
}

/// Vector instructions that a thread can be set to.
pub(crate) trait Instructions: Simd {
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

/// Work in a separate function.
pub(crate) struct Apart<W>(pub(crate) W);

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

macro_rules! instructions {
    ($($simd:path, $proof:ident);* $(;)?) => {$(
        std::thread_local! {
            static $proof: Cell<Option<$simd>> = const { Cell::new(None) };
        }
        impl Instructions for $simd {
            fn detect() -> Option<Self> {
                <$simd>::try_new()
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
    pulp::x86::V3, AVX2;
    pulp::x86::V4, AVX512;
}
