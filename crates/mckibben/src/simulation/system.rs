//! The contract between a hybrid system and the integrator that steps it through time.
//!
//! A [`HybridSystem`] is smooth while its mode lasts. Its `rates` in a mode are that mode's formulas, smoothly continued
//! beyond the mode's own region, so that no step ever spans a kink. The mode says two things about its own end:
//!
//! * an *instant*: a time, known in advance, at which something switches (a valve seat, a corner of a table);
//! * *guards*: functions of the state that are positive while the mode lasts.
//!
//! What happens at the end of a mode is the system's to say ([`HybridSystem::cross`], [`HybridSystem::pass_instant`]);
//! when it happens is the integrator's to find, by the rules of [`event`](super::event).

use crate::dual::Dual;
use crate::error::Error;
use crate::scalar::{Differentiable, Over, Real};
use core::fmt::Debug;

/// The largest number of guards that a mode may have.
pub const MAX_GUARDS: usize = 40;

/// How a guard is computed from the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GuardForm {
    /// `y[index] − bound`: the mode lasts while the state is above the bound.
    Above {
        /// Which state.
        index: usize,
        /// The bound in the state's unit.
        bound: f64,
    },
    /// `bound − y[index]`: the mode lasts while the state is below the bound.
    Below {
        /// Which state.
        index: usize,
        /// The bound in the state's unit.
        bound: f64,
    },
    /// [`HybridSystem::guard`], which is asked.
    Function,
}

/// The guards of one mode.
#[derive(Clone, Copy, Debug)]
pub struct Guards<G> {
    entries: [Option<(G, GuardForm)>; MAX_GUARDS],
    length: usize,
}

impl<G: Copy> Guards<G> {
    /// No guards.
    pub fn new() -> Self {
        Self { entries: [None; MAX_GUARDS], length: 0 }
    }

    /// Adds a guard. When two fire in one instant, the one that was added first is crossed first.
    pub fn add(&mut self, guard: G, form: GuardForm) {
        if let Some(entry) = self.entries.get_mut(self.length) {
            *entry = Some((guard, form));
            self.length += 1;
        } else {
            debug_assert!(false, "a mode has more than {MAX_GUARDS} guards");
        }
    }

    /// The guards in the order of their addition.
    pub fn iter(&self) -> impl Iterator<Item = (G, GuardForm)> {
        self.entries.iter().copied().flatten()
    }
}

impl<G: Copy> Default for Guards<G> {
    fn default() -> Self {
        Self::new()
    }
}

/// Whether `N` states have room for more than a system's `OWN`: known where it is compiled, so that one which has no more does
/// not carry their code.
pub(super) struct Room<const N: usize, const OWN: usize>;

impl<const N: usize, const OWN: usize> Room<N, OWN> {
    pub(super) const BESIDE: bool = N > OWN;
}

/// A system of `N` states that is smooth between events.
pub trait HybridSystem<R: Real, const N: usize> {
    /// The discrete state: which formulas hold, and what a clock remembers.
    type Mode: Copy + Debug;
    /// The name of a guard.
    type Guard: Copy + Debug + PartialEq;
    /// What an event was, for the log.
    type Kind: Copy + Debug;

    /// How many of the states have a meaning: the first ones.
    fn states(&self) -> usize {
        N
    }

    /// Time derivatives of the states by the formulas of `mode`.
    fn rates<T: Differentiable<R>>(&self, time: T, state: &[T; N], mode: &Self::Mode) -> [T; N];

    /// The fastest rate in 1/s at which a state settles by itself, zero when none does: the largest negative diagonal term
    /// of the Jacobian, unless the system knows better.
    fn settling_rate(&self, time: R, state: &[R; N], mode: &Self::Mode) -> f64 {
        let constants = state.map(Dual::<R, 1>::of);
        (0..self.states()).fold(0.0, |fastest: f64, n| {
            let mut seeded = constants;
            seeded[n] = Dual::variable(state[n], 0);
            fastest.max(-self.rates(Dual::of(time), &seeded, mode)[n].slope[0].value())
        })
    }

    /// Scales of the states, above zero: the relative tolerance times its scale is the error that a step may make in a state.
    fn scales(&self, state: &[R; N], mode: &Self::Mode) -> [f64; N];

    /// The next instant in s, up to and with `until`, at which `mode` ends by itself.
    fn next_instant(&self, mode: &Self::Mode, until: R) -> Option<R>;

    /// Passes the instant that [`HybridSystem::next_instant`] gave.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the system cannot go on.
    fn pass_instant(&self, time: R, state: &mut [R; N], mode: &mut Self::Mode) -> Result<Self::Kind, Error>;

    /// The guards of `mode`.
    fn guards(&self, mode: &Self::Mode) -> Guards<Self::Guard>;

    /// Value of a guard, positive while the mode lasts.
    fn guard<T: Differentiable<R>>(&self, guard: Self::Guard, time: T, state: &[T; N], mode: &Self::Mode) -> T;

    /// Crosses a guard that has come down through zero: the mode and, where it is reset, the state after it.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the system cannot go on.
    fn cross(
        &self,
        guard: Self::Guard,
        time: R,
        state: &mut [R; N],
        mode: &mut Self::Mode,
    ) -> Result<Self::Kind, Error>;

    /// Restores what a step knows exactly, such as a prescribed motion; nothing by default.
    fn project(&self, _time: R, _state: &mut [R; N], _mode: &Self::Mode) {}

    /// The error of a step that has become too small to go on.
    fn stuck(&self, time: R, state: &[R; N], mode: &Self::Mode) -> Error;
}
