//! A joint as a view of its plant.

use super::{JointEvent, JointMode, JointPlant};
use crate::air::Flow;
use crate::command::PlantDecision;
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::network::Network;
use crate::plant::view::PlantView;
use crate::plant::{Plant, PlantEvent, PlantMode, PlantSample, PlantStart};
use crate::simulation::{JointDecision, JointRig, JointSample, JointState};

impl<R: Instantiate> PlantView<R> for JointPlant<R> {
    type Rig = JointRig<R>;
    type State = JointState<R>;
    type Sample = JointSample<R>;
    type Mode = JointMode;
    type Event = JointEvent<R>;
    type Decision = JointDecision<R>;
    type Flows = [[Flow<R>; 2]; 2];

    fn rig(&self) -> &JointRig<R> {
        Self::rig(self)
    }

    fn plant(&self) -> &Plant<R> {
        Self::plant(self)
    }

    fn start(&self, state: &JointState<R>) -> PlantStart<R> {
        Self::start(self, state)
    }

    fn check_counts(&self, duration: f64) -> Result<(), Error> {
        self.rig.check_counts(duration)
    }

    fn sample(&self, of: &PlantSample<R>) -> JointSample<R> {
        Self::sample(self, of)
    }

    fn valve_flows(&self, of: &PlantSample<R>) -> [[Flow<R>; 2]; 2] {
        Self::valve_flows(self, of)
    }

    fn mode(&self, of: &PlantMode<R>) -> JointMode {
        Self::mode(self, of)
    }

    fn event(&self, of: &PlantEvent<R>, modes: [&PlantMode<R>; 2]) -> Option<JointEvent<R>> {
        let kind = self.event_kind(of.kind)?;
        let [before, after] = modes.map(|mode| Self::mode(self, mode));
        Some(JointEvent { time: of.time, kind, before, after })
    }

    fn decision(&self, of: &PlantDecision<R>) -> Option<JointDecision<R>> {
        Self::decision(self, of)
    }

    fn commanded(&self, network: &Network<R>) -> JointRig<R> {
        self.rig_commanded(network)
    }
}
