//! Two actuators that turn a joint, with their controller if they have one, as what is run.

use super::control;
use super::observation::Observer;
use crate::closed_loop::{Goal, Goals, requests};
use crate::engine::Subject;
use crate::record::{Field, of_joint};
use mckibben::Error;
use mckibben::command::Driver;
use mckibben::plant::{JointPlant, PlantStepError, TimeStepping};
use mckibben::simulation::{JointDecision, JointRig, JointSample, JointState};
use mckibben_scenario::{ControlledJointExperiment, JointExperiment, Run};

/// The joint of a scenario.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<'e> {
    experiment: &'e JointExperiment,
    control: Option<&'e ControlledJointExperiment>,
}

impl<'e> From<&'e JointExperiment> for Pair<'e> {
    fn from(experiment: &'e JointExperiment) -> Self {
        Self { experiment, control: None }
    }
}

impl<'e> From<&'e ControlledJointExperiment> for Pair<'e> {
    fn from(of: &'e ControlledJointExperiment) -> Self {
        Self { experiment: &of.experiment, control: Some(of) }
    }
}

impl Subject for Pair<'_> {
    type View = JointPlant;
    type Observer = Observer;

    fn plan(&self) -> &Run {
        &self.experiment.run
    }

    fn view(&self) -> Result<JointPlant, Error> {
        JointPlant::new(&self.experiment.rig)
    }

    fn start(&self) -> &JointState {
        &self.experiment.start
    }

    fn stepping(&self) -> Result<(TimeStepping, Option<PlantStepError>), Error> {
        self.control.map_or_else(|| self.experiment.stepping(), ControlledJointExperiment::stepping)
    }

    fn driver(&self, view: &JointPlant) -> Result<Option<Driver>, Error> {
        self.control.map(|control| control.driver(view)).transpose()
    }

    fn goals(&self) -> Option<Vec<Goal>> {
        self.control.map(control::begin_goals)
    }

    fn add(&self, goals: &mut [Goal], decision: &JointDecision) {
        if let Some(of) = self.control {
            control::add(goals, of, &self.experiment.rig, decision);
        }
    }

    fn requests(rig: &JointRig) -> Vec<usize> {
        rig.driven().iter().map(|driven| requests(driven.actuation.as_ref())).collect()
    }

    fn fields(rig: &JointRig, goals: &Goals) -> Vec<Field<JointSample>> {
        of_joint(rig, goals)
    }
}
