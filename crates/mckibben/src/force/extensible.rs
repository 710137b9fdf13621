//! A braid whose threads stretch.
//!
//! ```text
//! F = P_g (3L² − b²)/(4πn²)        b = b₀/(1 − P_g L/(2πn² K))
//! ```
//!
//! Pressure pulls on the threads; they lengthen until `K (b − b₀) = P_g ∂V/∂b = P_g L b/(2πn²)`, which is solved above. A
//! longer thread means a larger angle, so the muscle pulls less, at high pressure above all, and stops pulling at a smaller
//! contraction.
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | b, b₀ | length of a thread; unstretched, that of the [`Braid`] | m |
//! | K | `thread_stiffness`, of all threads side by side: their number times E A/b₀ | N/m |
//! | n | turns, of the [`Braid`] | – |
//!
//! The volume that the threads enclose, `V = L (b² − L²)/(4πn²)`, depends on pressure too. Force and volume come from one
//! potential, `F = ∂Φ/∂L` and `V = −∂Φ/∂P_g`, so a cycle in pressure and length costs the gas what the load gains. The
//! actuator's air, though, has the volume of the unstretched braid, and the energy audit names what lies between.
//!
//! Holds while `P_g L < 2πn² K`, of which a thread's own strength takes a small part: at a stretch of 5 % it is a twentieth.
//! With stiff threads it is the ideal braid.
//! Source: derived here, by virtual work with linear threads. That stretch matters: "Analysis of Pneumatic Artificial Muscles
//! and the Inelastic Braid Assumption", Actuators 11(8), 219 (2022), of which the abstract was at hand: the inextensible braid
//! can put the diameter too low by up to 30 % and the force too high by up to 70 %.
//! Checked by `tests/laws.rs`: equilibrium of the threads against a minimum of the energy, stiff threads, equality of the
//! mixed derivatives, closed cycle, dual against finite difference, secant.

use super::StaticForce;
use crate::braid::Braid;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar};

/// The law of a braid whose threads stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtensibleBraid<S = f64> {
    braid: Braid<S>,
    thread_stiffness: S,
    /// `1/(2πn² K)` in 1/(Pa m).
    per_pressure: S,
}

impl ExtensibleBraid {
    /// The law on `braid`, unstretched, with the `thread_stiffness` (N/m, above zero) of all its threads together.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the stiffness is above zero.
    pub fn new(braid: Braid, thread_stiffness: f64) -> Result<Self, Error> {
        Ok(Self::assemble(braid, parameter::THREAD_STIFFNESS.check(thread_stiffness)?))
    }
}

impl<S: Scalar> ExtensibleBraid<S> {
    fn assemble(braid: Braid<S>, thread_stiffness: S) -> Self {
        let per_pressure = S::constant(2.0) * braid.per_turns() / thread_stiffness;
        Self { braid, thread_stiffness, per_pressure }
    }

    /// Converts the law to another scalar type, on the braid that has been converted before.
    pub(crate) fn convert<T: Scalar>(&self, braid: &Braid<T>, convert: &mut impl Convert<S, T>) -> ExtensibleBraid<T> {
        let thread_stiffness = convert.parameter(&parameter::THREAD_STIFFNESS, self.thread_stiffness);
        match convert.carry() {
            Some(mut carry) => {
                ExtensibleBraid { braid: *braid, thread_stiffness, per_pressure: carry(self.per_pressure) }
            }
            None => ExtensibleBraid::assemble(*braid, thread_stiffness),
        }
    }

    /// `b₀/b`: 1 without stretch.
    #[inline(always)]
    fn shortness<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        T::one() - gauge.0 * length * T::of(self.per_pressure)
    }

    /// Length `b` of a thread in m.
    #[inline(always)]
    pub fn thread_length<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        T::of(self.braid.thread_length()) / self.shortness(length, gauge)
    }

    /// Volume in m³ that the threads enclose.
    pub fn volume<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        let thread = self.thread_length(length, gauge);
        length * (thread * thread - length * length) * T::of(self.braid.per_turns())
    }
}

impl<S: Scalar> StaticForce<S> for ExtensibleBraid<S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        let thread = self.thread_length(length, gauge);
        gauge.0 * (T::constant(3.0) * length * length - thread * thread) * T::of(self.braid.per_turns())
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        let (end, start) = (self.shortness(length, gauge), self.shortness(from, gauge));
        let thread = T::of(self.braid.thread_length()) / (end * start);
        let of_thread = thread * thread * gauge.0 * T::of(self.per_pressure) * (end + start);
        gauge.0 * (T::constant(3.0) * (length + from) - of_thread) * T::of(self.braid.per_turns())
    }
}
