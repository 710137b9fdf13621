//! Geometry of the braid: length ↔ interweave angle ↔ diameter ↔ volume.
//!
//! The actuator is a cylinder of zero wall thickness. A thread of fixed length `b` winds `n` times around it, so its
//! length alone fixes everything else (paper, Fig. 2):
//!
//! ```text
//! cos θ = L/b                       (2)
//! D     = √(b² − L²)/(nπ)
//! V     = L(b² − L²)/(4πn²)
//! dV/dL = (b² − 3L²)/(4πn²)         (20)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | b | `thread_length` | m |
//! | n | `turns` | – |
//! | θ | `interweave_angle` | rad, between the thread and the long axis |
//! | L | `length` | m |
//! | D | `diameter` | m |
//! | V | `volume` | m³ |
//!
//! Valid for `0 < L < b`. The volume is largest, and the ideal braid stops pulling, at `L = b/√3` (θ = 54.7°).
//! Source: Colbrunn, Nelson & Quinn (2001) after Chou & Hannaford (1996).
//! Checked by `tests/braid.rs`: closed forms, dV/dL against the dual derivative of V, the cylinder's own volume.

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};
use core::f64::consts::PI;

/// A braid of inextensible threads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Braid<S = f64> {
    thread_length: S,
    turns: S,
    /// `1/(4πn²)`, which every formula has.
    per_turns: S,
}

impl Braid {
    /// A braid with threads of `thread_length` (m, above zero) that make `turns` turns (above zero).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when either is not a positive number.
    pub fn new(thread_length: f64, turns: f64) -> Result<Self, Error> {
        Ok(Self::assemble(parameter::THREAD_LENGTH.check(thread_length)?, parameter::TURNS.check(turns)?))
    }
}

impl<S: Scalar> Braid<S> {
    fn assemble(thread_length: S, turns: S) -> Self {
        let per_turns = S::one() / (S::constant(4.0 * PI) * turns * turns);
        Self { thread_length, turns, per_turns }
    }

    /// Converts the braid to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Braid<T> {
        let thread_length = convert.parameter(&parameter::THREAD_LENGTH, self.thread_length);
        let turns = convert.parameter(&parameter::TURNS, self.turns);
        match convert.carry() {
            Some(mut carry) => Braid { thread_length, turns, per_turns: carry(self.per_turns) },
            None => Braid::assemble(thread_length, turns),
        }
    }

    /// Thread length `b` in m.
    #[inline(always)]
    pub fn thread_length(&self) -> S {
        self.thread_length
    }

    /// Turns of one thread `n`.
    pub fn turns(&self) -> S {
        self.turns
    }

    /// `1/(4πn²)`, the factor of volume and force.
    #[inline(always)]
    pub fn per_turns(&self) -> S {
        self.per_turns
    }

    /// Length `b/√3` in m at which the volume is largest and the ideal force is zero.
    pub fn neutral_length(&self) -> S {
        self.thread_length / S::constant(3.0).sqrt()
    }

    /// Cosine of the interweave angle, (2).
    pub fn cosine<T: Over<S>>(&self, length: T) -> T {
        length / T::of(self.thread_length)
    }

    /// Diameter `D` in m.
    #[inline(always)]
    pub fn diameter<T: Over<S>>(&self, length: T) -> T {
        let b = T::of(self.thread_length);
        (b * b - length * length).sqrt() / (T::of(self.turns) * T::constant(PI))
    }

    /// Volume `V` in m³.
    #[inline(always)]
    pub fn volume<T: Over<S>>(&self, length: T) -> T {
        let b = T::of(self.thread_length);
        length * (b * b - length * length) * T::of(self.per_turns)
    }

    /// `dV/dL` in m², (20): negative where the gas pulls the ends together.
    #[inline(always)]
    pub fn volume_slope<T: Over<S>>(&self, length: T) -> T {
        let b = T::of(self.thread_length);
        (b * b - T::constant(3.0) * length * length) * T::of(self.per_turns)
    }
}

#[cfg(any(feature = "std", feature = "libm"))]
impl Braid {
    /// Interweave angle `θ` in rad between the threads and the long axis, (2); NaN-free: the cosine is kept in [−1, 1].
    pub fn interweave_angle(&self, length: f64) -> f64 {
        let cosine = self.cosine(length).clamp(-1.0, 1.0);
        #[cfg(feature = "std")]
        return cosine.acos();
        #[cfg(not(feature = "std"))]
        return libm::acos(cosine);
    }
}
