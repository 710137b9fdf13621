//! Borders between pieces of a law that agree there: each stage takes the piece of its state.
//!
//! In the event-located engine a mode lasts up to such a border, and each step keeps to one piece, smoothly continued. A
//! fixed step crosses these borders without an event: what it loses there is of the order of its error.

use super::super::evaluation::{Evaluation, System};
use super::super::guard::PlantGuard;
use super::super::mode::PlantMode;
use crate::mechanism::Coupling;
use crate::network::BranchKind;
use crate::network::guard::NetworkGuard;
use crate::scalar::Real;
use crate::simulation::Guard;

/// Whether a guard ends a mode at a border where two pieces of a law agree, so that no step is divided there.
pub(super) fn is_between_pieces(guard: PlantGuard) -> bool {
    match guard {
        PlantGuard::Arm { .. } => true,
        PlantGuard::Network(guard) => matches!(guard, NetworkGuard::Zone { .. } | NetworkGuard::Regime { .. }),
        PlantGuard::Of(_, guard) => matches!(
            guard,
            Guard::PieceDown
                | Guard::PieceUp
                | Guard::MapDown
                | Guard::MapUp
                | Guard::MapShorter
                | Guard::MapLonger
                | Guard::PressDown
                | Guard::PressUp
        ),
        PlantGuard::ThreadContact { .. } | PlantGuard::Jump(_) | PlantGuard::Release { .. } => false,
    }
}

impl<R: Real> System<R> {
    /// Takes the pieces of all laws that hold in a state.
    pub(in super::super) fn enter_pieces(&self, time: R, state: &[R], mode: &mut PlantMode<R>, at: &mut Evaluation<R>) {
        let network = &self.plant.network;
        self.piping.enter_pressures(state, &mut at.network);
        for (index, branch) in network.branches.iter().enumerate() {
            let pressure = [branch.from, branch.to].map(|node| at.network.nodes[node].pressure);
            match &branch.kind {
                BranchKind::Path { law, .. } => {
                    let is_open = network.is_open(index, &mode.network);
                    mode.network.branches[index].zone = is_open.then(|| law.zone(pressure[0], pressure[1]));
                }
                BranchKind::Check { law } => {
                    let zone = law.zone(pressure[0], pressure[1]);
                    mode.network.branches[index].zone = Some(zone).filter(|zone| zone.is_inward());
                }
                BranchKind::Loss(_) => network.enter_branch(index, pressure, &mut mode.network),
                BranchKind::Inertia(_) | BranchKind::Leak(_) | BranchKind::Compressor => {}
            }
        }
        self.enter_actuator_pieces(time, state, mode, at);
    }

    /// Takes the pieces of arms and of the laws of actuators: what lengths, volumes and tensions follow from.
    pub(in super::super) fn enter_actuator_pieces(
        &self,
        time: R,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) {
        self.enter_arms(state, mode);
        for (i, wire) in self.wires.iter().enumerate() {
            let [pressure, _] = wire.air(state);
            let its = &mut mode.actuators[i].mode;
            its.effectiveness_piece = wire.member.effectiveness_piece(pressure);
            its.pressed = wire.member.pressed(pressure);
            let law = &wire.member.actuator.law().law;
            if law.length_bounds(0).1.is_some() || law.pressure_bounds(0).1.is_some() {
                self.enter_ends_of(i, time, state, mode, at);
                mode.actuators[i].mode.force_piece = wire.member.force_piece(at.units[i].length, pressure);
            }
        }
    }

    /// Enters the pieces of moment arms in a state.
    fn enter_arms(&self, state: &[R], mode: &mut PlantMode<R>) {
        for (mounted, here) in self.plant.actuators.iter().zip(&self.plant.places.actuators) {
            if let Coupling::Arms { arms, .. } = &mounted.coupling {
                let (position, _) = self.plant.places.mechanisms[mounted.mechanism].of(state);
                mounted.coupling.pieces(position, &mut mode.arms[here.arms..here.arms + arms.len()]);
            }
        }
    }
}
