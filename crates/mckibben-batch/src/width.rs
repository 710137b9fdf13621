//! Which instructions a batch uses, chosen when the program runs.

use crate::wide::Instructions;

/// The vector instructions of a batch. In double precision its results do not depend on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Width {
    /// What every machine of this kind has: one row after the other.
    Baseline,
    /// 256 bits: eight rows of double precision at once, in two registers.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 512 bits: sixteen rows of double precision at once, in two registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Width {
    /// Every width that this machine has, the narrowest first.
    pub fn available() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        let found = [
            Some(Self::Baseline),
            pulp::x86::V3::detect().map(|_| Self::Avx2),
            pulp::x86::V4::detect().map(|_| Self::Avx512),
        ];
        #[cfg(not(target_arch = "x86_64"))]
        let found = [Some(Self::Baseline)];
        found.into_iter().flatten().collect()
    }

    /// The widest that this machine has.
    pub fn widest() -> Self {
        Self::available().pop().unwrap_or(Self::Baseline)
    }

    /// How many rows of double precision are stepped at once: a batch of no more is one block, which one thread steps.
    pub fn rows(self) -> usize {
        match self {
            Self::Baseline => 1,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => 8,
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => 16,
        }
    }

    /// This width, or the widest where the machine has not got it.
    pub(crate) fn or_widest(self) -> Self {
        if Self::available().contains(&self) { self } else { Self::widest() }
    }
}
