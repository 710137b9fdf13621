//! What ends the mode that holds, where a host has come to.
//!
//! | | at first | in a mode that has begun in this instant |
//! |---|---|---|
//! | a guard below zero | has fired | has fired where it lies below zero by more than its rounding, or descends |
//! | at zero | has fired where it descends, or neither has a rate nor rises by its second derivative | has fired where it descends |
//! | above zero | has fired where its rate brings it to zero within [`NEAR`] | the host will see it fall |
//!
//! A host that steps over several borders at once leaves several guards below zero, and those of the next mode too: each is crossed,
//! until none is. Borders between pieces of a law come first, since forces and flows follow from the pieces; where more of them were
//! passed than one, all laws take the pieces of the state. So they do where a guard has no value, since a law was continued too far.

use super::super::pieces::is_between_pieces;
use super::{Along, NEAR, PlantExchange, PlantSteps};
use crate::engine::GuardForm;
use crate::plant::guard::PlantGuard;
use alloc::vec;

/// The error of a guard by rounding, in roundings of the states that it follows from.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// What ends a mode.
pub(super) enum Fired {
    /// A guard.
    Guard(PlantGuard),
    /// The laws have left their pieces by more than one border.
    Pieces,
}

impl PlantExchange {
    /// What has fired: of guards the one that comes to zero first, where `is_new` says whether the mode has begun in this instant.
    /// With `may_enter` all pieces of laws may be entered at once.
    pub(super) fn fired(&mut self, steps: &PlantSteps, is_new: bool, may_enter: bool) -> Option<Fired> {
        self.list(steps.mode());
        self.system.rates(steps.time(), steps.state(), steps.mode(), &mut self.at, &mut self.rates);
        self.seed_with_rates(steps);
        let mut first: Option<(PlantGuard, (bool, f64))> = None;
        for place in 0..self.guards.len() {
            let guard = self.guards[place];
            let (value, rate) = (self.value(steps, guard), self.value_along(steps, guard, 1.0));
            let descends = rate < 0.0 && value + rate * NEAR < 0.0;
            let is_beyond = is_new && value < 0.0 && value < -self.rounding(steps, guard);
            if may_enter && (value.is_nan() || (is_beyond && is_between_pieces(guard.0))) {
                return Some(Fired::Pieces);
            }
            let has_fired = if is_new {
                is_beyond || (descends && value <= 0.0)
            } else {
                descends || value < 0.0 || (value == 0.0 && rate == 0.0 && !self.rises_from_rest(steps, guard))
            };
            let order = (!is_between_pieces(guard.0), if descends { -value / rate } else { 0.0 });
            if has_fired && first.is_none_or(|(_, earlier)| order < earlier) {
                first = Some((guard.0, order));
            }
        }
        first.map(|(guard, _)| Fired::Guard(guard))
    }

    /// Whether a guard without a rate rises by the second derivatives of the states, which are seeded with their rates.
    fn rises_from_rest(&mut self, steps: &PlantSteps, guard: (PlantGuard, GuardForm)) -> bool {
        let time = Along { value: steps.time(), slope: [1.0] };
        self.system.rates(time, &self.seeded, steps.mode(), &mut self.along, &mut self.seeded_rates);
        let second = core::mem::take(&mut self.seeded_rates);
        self.seed(steps, |place| second[place].slope[0]);
        self.seeded_rates = second;
        let rate = self.value_along(steps, guard, 0.0);
        self.seed_with_rates(steps);
        rate > 0.0
    }

    /// By how much a guard may err by the rounding of the states, which are seeded with their rates.
    fn rounding(&mut self, steps: &PlantSteps, guard: (PlantGuard, GuardForm)) -> f64 {
        let mut sizes = vec![0.0; self.rates.len()];
        self.system.scales(steps.state(), steps.mode(), &mut sizes);
        let mut sum = 0.0;
        for (moved, (size, state)) in sizes.iter().zip(steps.state()).enumerate() {
            self.seed(steps, |place| if place == moved { 1.0 } else { 0.0 });
            let slope = self.value_along(steps, guard, 0.0).abs();
            // One without bounds, as at the root of a flow, says nothing of the rounding.
            if slope.is_finite() {
                sum += slope * size.max(state.abs());
            }
        }
        self.seed_with_rates(steps);
        ROUNDINGS * sum
    }
}
