//! A rig and a joint as plants that are stepped at fixed steps, read as what they are.

use mckibben::Error;
use mckibben::plant::{JointPlant, PlantRun, PlantSteps, PlantView as _, RigPlant};
use mckibben::simulation::{JointRig, JointSample, JointState, Method, Rig, Sample, State};

/// Steps of a rig.
#[derive(Clone, Debug)]
pub(crate) struct RigSteps {
    pub(crate) view: RigPlant,
    pub(crate) steps: PlantSteps,
}

impl RigSteps {
    /// From a state at t = 0.
    pub(crate) fn new(rig: &Rig, start: State, method: Method) -> Self {
        let view = RigPlant::new(rig);
        let run = PlantRun::new(view.plant(), &view.start(&start), 1e-9).expect("a start");
        Self { steps: run.steps(method), view }
    }

    pub(crate) fn advance_to(&mut self, until: f64) -> Result<(), Error> {
        self.steps.advance_to(until)
    }

    pub(crate) fn time(&self) -> f64 {
        self.steps.time()
    }

    pub(crate) fn sample(&self) -> Sample {
        self.view.sample(&self.steps.sample())
    }

    pub(crate) fn state(&self) -> State {
        let Sample { length, velocity, pressure, air_mass, .. } = self.sample();
        State { length, velocity, pressure, air_mass }
    }
}

/// Steps of a joint.
#[derive(Clone, Debug)]
pub(crate) struct JointSteps {
    pub(crate) view: JointPlant,
    pub(crate) steps: PlantSteps,
}

impl JointSteps {
    /// From a state at t = 0.
    pub(crate) fn new(rig: &JointRig, start: JointState, method: Method) -> Self {
        let view = JointPlant::new(rig).expect("a plant");
        let run = PlantRun::new(view.plant(), &view.start(&start), 1e-9).expect("a start");
        Self { steps: run.steps(method), view }
    }

    pub(crate) fn advance_to(&mut self, until: f64) -> Result<(), Error> {
        self.steps.advance_to(until)
    }

    pub(crate) fn time(&self) -> f64 {
        self.steps.time()
    }

    pub(crate) fn sample(&self) -> JointSample {
        self.view.sample(&self.steps.sample())
    }

    pub(crate) fn state(&self) -> JointState {
        self.sample().state()
    }
}
