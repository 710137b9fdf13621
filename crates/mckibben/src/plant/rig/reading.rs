//! What a plant of one actuator is, seen as a rig: samples, modes, events, decisions.

use super::{RigPlant, RigTrajectory};
use crate::air::Flow;
use crate::command::PlantDecision;
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::network::{BranchKind, Network};
use crate::plant::view::PlantView;
use crate::plant::{Part, Plant, PlantEvent, PlantMode, PlantSample, PlantStart};
use crate::simulation::{Decision, EventKind, Mode, Rig, Sample, State};
use alloc::vec::Vec;

/// A change of mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigEvent<R = f64> {
    /// When, in s.
    pub time: R,
    /// What happened.
    pub kind: EventKind,
    /// The mode before.
    pub before: Mode,
    /// The mode after.
    pub after: Mode,
}

impl<R: Instantiate> PlantView<R> for RigPlant<R> {
    type Rig = Rig<R>;
    type State = State<R>;
    type Sample = Sample<R>;
    type Mode = Mode;
    type Event = RigEvent<R>;
    type Decision = Decision<R>;
    type Flows = [Flow<R>; 2];

    fn rig(&self) -> &Rig<R> {
        Self::rig(self)
    }

    fn plant(&self) -> &Plant<R> {
        Self::plant(self)
    }

    fn start(&self, state: &State<R>) -> PlantStart<R> {
        Self::start(self, state)
    }

    fn check_counts(&self, duration: f64) -> Result<(), Error> {
        self.rig.check_counts(duration)
    }

    fn sample(&self, of: &PlantSample<R>) -> Sample<R> {
        self.feed.sample(&self.plant, 0, of)
    }

    fn valve_flows(&self, of: &PlantSample<R>) -> [Flow<R>; 2] {
        self.feed.flows(of)
    }

    fn mode(&self, of: &PlantMode<R>) -> Mode {
        self.feed.mode(0, of)
    }

    fn event(&self, of: &PlantEvent<R>, modes: [&PlantMode<R>; 2]) -> Option<RigEvent<R>> {
        if let Part::Driver(_) = of.kind.part {
            return None;
        }
        let [before, after] = modes.map(|mode| self.mode(mode));
        Some(RigEvent { time: of.time, kind: of.kind.kind, before, after })
    }

    fn decision(&self, of: &PlantDecision<R>) -> Option<Decision<R>> {
        Some(Decision { seen: *of.seen.actuators.first()?, aim: of.aims.first().copied(), drive: of.drive(0)? })
    }

    fn commanded(&self, network: &Network<R>) -> Rig<R> {
        let command = self.feed.valve.map(|valve| network.valves[valve].command.clone());
        command.map_or_else(|| self.rig.clone(), |command| self.rig.commanded(command))
    }
}

impl<R: Instantiate> RigTrajectory<R> {
    /// The least and the greatest value of length (m), velocity of the load (m/s), absolute pressure (Pa) and mass of the air
    /// (kg), at five points of each step.
    pub fn ranges(&self) -> [(f64, f64); 4] {
        let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 4];
        let last = self.duration();
        for of in self.at_each(self.plant().points(5).into_iter().chain([last])) {
            for (range, value) in ranges.iter_mut().zip([of.length, of.load_velocity, of.pressure.0, of.air_mass]) {
                *range = (range.0.min(value.value()), range.1.max(value.value()));
            }
        }
        ranges
    }

    /// The states of the air line at `time` in s, in the order of its parts: the pressures (Pa, absolute) of the hose's
    /// volumes from the valve on, the flows (kg/s) out of the cells of a distributed hose, the pressures of reservoir and
    /// regulator, or of a regulated port. As far as there are such parts.
    pub fn line_at(&self, time: R) -> Vec<R> {
        let (plant, feed) = (self.view().plant(), self.view().feed);
        let (state, _) = self.plant().at(time);
        let (network, places) = (plant.network(), plant.indices());
        let hose = feed.hose.map_or(0..0, |[first, count]| first..first + count);
        let volumes = hose.filter_map(|node| places.nodes[node]);
        let cells = network.branches.iter().zip(&places.branches);
        let cells = cells.filter(|(branch, _)| matches!(branch.kind, BranchKind::Inertia(_)));
        let supply = feed.supply.map_or([None; 2], |supply| [supply.reservoir, Some(supply.outlet)]);
        let mut others: Vec<usize> = supply.into_iter().chain([feed.port]).flatten().collect();
        others.dedup();
        let others = others.into_iter().filter_map(|node| places.nodes[node]);
        volumes.chain(cells.filter_map(|(_, place)| *place)).chain(others).map(|place| state[place]).collect()
    }

    /// The deflection in m of the bristles of LuGre's law at `time` in s, if that is the rig's friction.
    pub fn bristles_at(&self, time: R) -> Option<R> {
        let place = self.view().plant().indices().actuators[0].bristles?;
        Some(self.plant().at(time).0[place])
    }
}
