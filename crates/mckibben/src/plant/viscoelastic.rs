//! Forces and powers of the viscoelastic branches of a plant's actuators.
//!
//! ```text
//! F_b L̇ = d/dt ½ Σ k (L − z)²  −  ½ Σ k̇ (L − z)²  +  Σ k (L − z)²/τ
//! ```
//!
//! What they store, what a change of the pressure makes of that, and what they dissipate; k is `kᵢ + wᵢ k_sec⁺`.
//!
//! Source: [`crate::friction::Viscoelastic`]. Checked by `tests/viscoelastic.rs`.

use super::Plant;
use super::evaluation::{System, Unit};
use super::mode::PlantMode;
use crate::air::Chamber;
use crate::dual::Dual;
use crate::friction::{NormalLoad, SlidingState};
use crate::scalar::{Over, Real};
use crate::simulation::LengthRegime;

/// Powers of the branches of an actuator in W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BranchPowers {
    /// Dissipated, never less than zero.
    pub(super) dissipated: f64,
    /// What a change of their stiffness takes from what they store; negative where it adds to that.
    pub(super) exchanged: f64,
}

impl<R: Real> Plant<R> {
    /// Stretches the viscoelastic branches of all actuators, which are relaxed, as they start.
    pub(super) fn stretch_branches(&self, state: &mut [R]) {
        for (own, mounted) in self.places.actuators.iter().zip(&self.actuators) {
            let Some(law) = mounted.actuator.friction().viscoelastic() else { continue };
            for (branch, place) in own.branches().enumerate() {
                state[place] = state[place] - law.initial_stretch(branch);
            }
        }
    }

    /// Relaxes the viscoelastic branches of all actuators at their lengths in m.
    pub(super) fn relax_branches(&self, lengths: impl Iterator<Item = R>, state: &mut [R]) {
        for ((own, mounted), length) in self.places.actuators.iter().zip(&self.actuators).zip(lengths) {
            state[own.branches()].fill(mounted.actuator.limits().actuator_length(length));
        }
    }
}

impl<R: Real> System<R> {
    /// What presses the threads together at the length and pressure of an actuator.
    fn normal_load_of<T: Over<R>>(&self, i: usize, mode: &PlantMode<R>, [length, pressure]: [T; 2]) -> NormalLoad<T> {
        self.wires[i].member.actuator.normal_load(length, pressure, mode.actuators[i].mode.touch())
    }

    /// Force in N of the branches of an actuator at its length in m and absolute pressure in Pa; zero while it is slack.
    pub(super) fn branch_force(&self, i: usize, state: &[R], mode: &PlantMode<R>, ends: [R; 2]) -> R {
        let law = self.wires[i].member.actuator.friction().viscoelastic();
        if law.is_none() || mode.actuators[i].mode.length_regime == LengthRegime::Slack {
            return R::zero();
        }
        let at_rest: SlidingState<R> = R::zero().into();
        let of_branches = at_rest.with_branches(law, ends[0], self.deflections(i, state).branches);
        of_branches.held_force(self.normal_load_of(i, mode, ends)).unwrap_or_else(R::zero)
    }
}

impl System<f64> {
    /// Powers of the branches of an actuator that has been evaluated.
    pub(super) fn branch_powers(
        &self,
        i: usize,
        state: &[f64],
        mode: &PlantMode,
        (unit, chamber): (&Unit<f64>, &Chamber<f64>),
    ) -> BranchPowers {
        let mut powers = BranchPowers::default();
        let wire = &self.wires[i];
        let Some(law) = wire.member.actuator.friction().viscoelastic() else { return powers };
        let is_slack = mode.actuators[i].mode.length_regime == LengthRegime::Slack;
        let length = wire.resting_length(is_slack, unit.length);
        let velocity = if is_slack { 0.0 } else { unit.velocity };
        let moving: [Dual<f64, 1>; 2] =
            [Dual { value: length, slope: [velocity] }, Dual { value: chamber.pressure, slope: [unit.pressure_rate] }];
        let secant = self.normal_load_of(i, mode, moving).secant_stiffness();
        for (branch, place) in wire.places.branches().enumerate() {
            let stretch = length - state[place];
            let stiffness = law.stiffness_at(branch, secant);
            powers.dissipated += stiffness.value * stretch * stretch / law.relaxation_time(branch);
            powers.exchanged -= 0.5 * stiffness.slope[0] * stretch * stretch;
        }
        powers
    }
}
