//! Flow in the cells of a distributed hose no faster than sound.
//!
//! ```text
//! −κ A P_{i+1}/c ≤ w_i ≤ κ A P_i/c
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | w_i | flow out of cell i, towards the actuator | kg/s |
//! | P_i | absolute pressure of cell i | Pa |
//! | κ, A, c | polytropic index, cross-section and speed of sound of the [hose](crate::line::Hose) | –, m², m/s |
//!
//! The inertia of a cell's air knows nothing of how much air there is: behind a sudden exhaust it would draw more out of the cell
//! before than that holds, and its pressure would come to zero. At the speed of sound the flow follows the pressure of the
//! cell that it leaves, which then falls no faster than exponentially, until the pressures slow it down by more than that.
//!
//! Source: `w = ρ c A` with the density `P/(RT)` of the cell. Checked by `tests/plant_progress.rs`.

use super::flow::NetworkState;
use super::{Branch, BranchKind, Network};
use crate::scalar::{Over, Real};

impl<R: Real> Network<R> {
    /// The node that a flow through a cell leaves, and the flow in kg/s over that node's pressure at the speed of sound, with
    /// its sign.
    pub(crate) fn sonic<T: Over<R>>(&self, branch: usize, forwards: bool) -> Option<(usize, T)> {
        let Branch { from, to, kind: BranchKind::Inertia(hose) } = &self.branches[branch] else { return None };
        let per_pressure = hose.sonic_flow(T::one());
        Some(if forwards { (*from, per_pressure) } else { (*to, -per_pressure) })
    }

    /// By how much in kg/s² the pressures drive the flow through a cell beyond what keeps it at the speed of sound, where the
    /// pressure behind it changes at `rate` (Pa/s).
    pub(crate) fn sonic_drive<T: Over<R>>(&self, branch: usize, forwards: bool, rate: T, at: &NetworkState<T>) -> T {
        let Some((_, per_pressure)) = self.sonic::<T>(branch, forwards) else { return T::one() };
        let beyond = self.branch_rate(branch, at) - per_pressure * rate;
        if forwards { beyond } else { -beyond }
    }
}
