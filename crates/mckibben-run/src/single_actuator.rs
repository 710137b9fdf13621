//! An actuator on its load, with its controller if it has one, as the subject of a run.

use crate::closed_loop::{self, Goal, Goals};
use crate::engine::Subject;
use crate::observation::Observer;
use crate::record::{Field, of_controlled};
use mckibben::Error;
use mckibben::command::Driver;
use mckibben::plant::{PlantStepError, RigPlant, TimeStepping};
use mckibben::simulation::{Decision, Rig, Sample, State};
use mckibben_scenario::{ControlledExperiment, Experiment, Run};

/// One actuator of a scenario.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SingleActuator<'e> {
    experiment: &'e Experiment,
    control: Option<&'e ControlledExperiment>,
}

impl<'e> From<&'e Experiment> for SingleActuator<'e> {
    fn from(experiment: &'e Experiment) -> Self {
        Self { experiment, control: None }
    }
}

impl<'e> From<&'e ControlledExperiment> for SingleActuator<'e> {
    fn from(of: &'e ControlledExperiment) -> Self {
        Self { experiment: &of.experiment, control: Some(of) }
    }
}

impl Subject for SingleActuator<'_> {
    type View = RigPlant;
    type Observer = Observer;

    fn plan(&self) -> &Run {
        &self.experiment.run
    }

    fn view(&self) -> Result<RigPlant, Error> {
        Ok(RigPlant::new(&self.experiment.rig))
    }

    fn start(&self) -> &State {
        &self.experiment.start
    }

    fn stepping(&self) -> Result<(TimeStepping, Option<PlantStepError>), Error> {
        self.control.map_or_else(|| self.experiment.stepping(), ControlledExperiment::stepping)
    }

    fn driver(&self, view: &RigPlant) -> Result<Option<Driver>, Error> {
        self.control.map(|control| control.driver(view)).transpose()
    }

    fn goals(&self) -> Option<Vec<Goal>> {
        self.control.map(closed_loop::begin_goals)
    }

    fn add(&self, goals: &mut [Goal], decision: &Decision) {
        if let Some(control) = self.control {
            closed_loop::add(goals, control, decision);
        }
    }

    fn requests(rig: &Rig) -> Vec<usize> {
        vec![closed_loop::requests(rig.actuation())]
    }

    fn fields(rig: &Rig, goals: &Goals) -> Vec<Field<Sample>> {
        of_controlled(rig, goals)
    }
}
