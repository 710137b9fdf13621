//! Which instructions a batch is compiled for, chosen when the program runs.

use crate::simulation::course::{Instructions, Kernel, Ordinary};
use alloc::vec::Vec;

/// The width of the vector instructions that a batch uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Width {
    /// What every machine of this kind has; a product and a sum are rounded one after the other.
    Baseline,
    /// 256 bits with fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 512 bits with fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Width {
    /// Every width that this machine has, the narrowest first.
    pub fn available() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        let found = [
            Some(Self::Baseline),
            pulp::x86::V3::try_new().map(|_| Self::Avx2),
            pulp::x86::V4::try_new().map(|_| Self::Avx512),
        ];
        #[cfg(not(target_arch = "x86_64"))]
        let found = [Some(Self::Baseline)];
        found.into_iter().flatten().collect()
    }

    /// The widest that this machine has.
    pub fn widest() -> Self {
        Self::available().pop().unwrap_or(Self::Baseline)
    }

    /// Whether a product and a sum are one operation with one rounding.
    pub fn is_fused(self) -> bool {
        self != Self::Baseline
    }

    /// Runs work that is compiled anew for these instructions.
    #[inline(always)]
    pub(super) fn run<W: Work>(self, work: W) -> W::Output {
        #[cfg(target_arch = "x86_64")]
        match self {
            Self::Baseline => {}
            Self::Avx2 => {
                if let Some(simd) = pulp::x86::V3::try_new() {
                    return pulp::Simd::vectorize(simd, Compiled(work));
                }
            }
            Self::Avx512 => {
                if let Some(simd) = pulp::x86::V4::try_new() {
                    return pulp::Simd::vectorize(simd, Compiled(work));
                }
            }
        }
        work.run(Ordinary)
    }
}

/// Work that hands its instructions on to the kernels it runs.
pub(super) trait Work {
    /// What comes out of it.
    type Output;
    /// Does the work.
    fn run(self, instructions: impl Instructions) -> Self::Output;
}

struct Compiled<W>(W);

impl<W: Work> pulp::WithSimd for Compiled<W> {
    type Output = W::Output;
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) -> W::Output {
        self.0.run(Wide(simd))
    }
}

#[derive(Clone, Copy, Debug)]
struct Wide<S>(S);

impl<S: pulp::Simd> Instructions for Wide<S> {
    #[inline(always)]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        self.0.vectorize(Inner(kernel))
    }
}

struct Inner<K>(K);

impl<K: Kernel> pulp::WithSimd for Inner<K> {
    type Output = K::Output;
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) -> K::Output {
        self.0.run()
    }
}
