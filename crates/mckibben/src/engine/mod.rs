//! The event-located engine: adaptive steps of high order that end where a mode ends.
//!
//! A hybrid system is smooth while its mode lasts. Its rates in a mode are that mode's formulas, smoothly continued
//! beyond the mode's own region, so that no step ever spans a kink. The mode says two things about its own end: an *instant*,
//! known beforehand, and *guards*, functions of the state that are positive while the mode lasts. What happens at the end of
//! a mode is the system's to say; when it happens is the integrator's to find, by the rules of
//! [`event`].
//!
//! States lie in slices: how many there are is a number and no type.

mod allowed;
pub(crate) mod arc;
pub(crate) mod bernstein;
pub mod event;
pub(crate) mod explicit;
pub(crate) mod implicit;
mod integrator;

pub use arc::Arc;
pub(crate) use integrator::Pace;
pub use integrator::Statistics;
pub use integrator::{Integrator, Piece};

use crate::error::Error;
use crate::scalar::{Differentiable, Over, Real, Scalar};
use alloc::vec::Vec;
use core::fmt::Debug;

/// How a guard is computed from the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GuardForm<R = f64> {
    /// `y[index] − bound`: the mode lasts while the state is above the bound.
    Above {
        /// Which state.
        index: usize,
        /// The bound in the state's unit.
        bound: R,
    },
    /// `bound − y[index]`: the mode lasts while the state is below the bound.
    Below {
        /// Which state.
        index: usize,
        /// The bound in the state's unit.
        bound: R,
    },
    /// [`Hybrid::guard`], which is evaluated.
    Function,
}

impl<R> GuardForm<R> {
    /// A bound on a state, for a mode that lasts above or below it.
    pub(crate) fn on(index: usize, bound: R, lasts_above: bool) -> Self {
        if lasts_above { Self::Above { index, bound } } else { Self::Below { index, bound } }
    }
}

/// A system that is smooth between events.
pub trait Hybrid<R: Real> {
    /// The discrete state.
    type Mode: Clone + Debug;
    /// The name of a guard.
    type Guard: Copy + Debug + PartialEq;
    /// What an event was.
    type Kind: Copy + Debug;
    /// Room for what is computed on the way to the rates.
    type Work<T: Scalar>;

    /// How many states there are.
    fn states(&self) -> usize;

    /// Room for an evaluation.
    fn work<T: Over<R>>(&self) -> Self::Work<T>;

    /// Time derivatives of the states by the formulas of `mode`.
    fn rates<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &Self::Mode,
        work: &mut Self::Work<T>,
        rates: &mut [T],
    );

    /// The fastest rate in 1/s at which a state settles; `work` holds the evaluation at the state.
    fn settling_rate(&self, state: &[R], mode: &Self::Mode, work: &mut Self::Work<R>) -> f64;

    /// Scales of the states, above zero.
    fn scales(&self, state: &[R], mode: &Self::Mode, scales: &mut [f64]);

    /// The largest part by which a number of the system changes with each direction of its derivatives.
    fn influences(&self) -> &[f64] {
        &[]
    }

    /// The next instant in s, up to and with `until`, at which `mode` ends without an event of a guard.
    fn next_instant(&self, mode: &Self::Mode, until: R) -> Option<R>;

    /// Passes what is due at an instant.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the system cannot go on.
    fn pass_instant(
        &self,
        time: R,
        state: &mut [R],
        mode: &mut Self::Mode,
        work: &mut Self::Work<R>,
    ) -> Result<Self::Kind, Error>;

    /// Lists the guards of `mode`.
    fn guards(&self, mode: &Self::Mode, guards: &mut Vec<(Self::Guard, GuardForm<R>)>);

    /// Value of a guard, positive while the mode lasts.
    fn guard<T: Differentiable<R>>(
        &self,
        guard: Self::Guard,
        time: T,
        state: &[T],
        mode: &Self::Mode,
        work: &mut Self::Work<T>,
    ) -> T;

    /// Whether the rates are continuous where a guard is crossed, as at the border of two pieces of a curve. When it is crossed
    /// then changes no derivative.
    fn is_smooth(&self, _guard: Self::Guard) -> bool {
        false
    }

    /// Crosses a guard that has come down through zero.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the system cannot go on.
    fn cross(
        &self,
        guard: Self::Guard,
        time: R,
        state: &mut [R],
        mode: &mut Self::Mode,
        work: &mut Self::Work<R>,
    ) -> Result<Self::Kind, Error>;

    /// Restores what a step knows exactly.
    fn project(&self, time: R, state: &mut [R], mode: &Self::Mode, work: &mut Self::Work<R>);

    /// The error of a run that does not go on, with the event that ended the last step.
    fn halts(&self, time: R, state: &[R], why: Halt, event: Option<Self::Kind>) -> Error;
}

/// Why a run does not go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Halt {
    /// Many steps have brought the time on by so much in s alone.
    Crawls(f64),
    /// Events follow each other at one instant without end.
    Events,
    /// No step is short enough: the state at this place changes fastest for its scale, or has no rate.
    Step(usize),
}
