//! A rig and a joint as plants that are stepped at fixed steps, read as what they are.

use mckibben::Error;
use mckibben::plant::{JointPlant, PlantRun, PlantSteps, PlantView, RigPlant};
use mckibben::simulation::{JointRig, JointState, Method, Rig, Sample, State};

/// Steps of a plant that is read as something smaller.
#[derive(Clone, Debug)]
pub(crate) struct ViewSteps<V> {
    pub(crate) view: V,
    pub(crate) steps: PlantSteps,
}

/// Steps of a rig.
pub(crate) type RigSteps = ViewSteps<RigPlant>;
/// Steps of a joint.
pub(crate) type JointSteps = ViewSteps<JointPlant>;

impl<V: PlantView> ViewSteps<V> {
    /// From a state at t = 0.
    fn of(view: V, start: &V::State, method: Method) -> Self {
        let run = PlantRun::new(view.plant(), &view.start(start), 1e-9).expect("a start");
        Self { steps: run.steps(method), view }
    }

    pub(crate) fn advance_to(&mut self, until: f64) -> Result<(), Error> {
        self.steps.advance_to(until)
    }

    pub(crate) fn time(&self) -> f64 {
        self.steps.time()
    }

    pub(crate) fn sample(&self) -> V::Sample {
        self.view.sample(&self.steps.sample())
    }
}

impl RigSteps {
    /// From a state at t = 0.
    pub(crate) fn new(rig: &Rig, start: State, method: Method) -> Self {
        Self::of(RigPlant::new(rig), &start, method)
    }

    pub(crate) fn state(&self) -> State {
        let Sample { length, velocity, pressure, air_mass, .. } = self.sample();
        State { length, velocity, pressure, air_mass }
    }
}

impl JointSteps {
    /// From a state at t = 0.
    pub(crate) fn new(rig: &JointRig, start: JointState, method: Method) -> Self {
        Self::of(JointPlant::new(rig).expect("a plant"), &start, method)
    }

    pub(crate) fn state(&self) -> JointState {
        self.sample().state()
    }
}
