//! From a controller of a joint in a file to the core's: the same numbers, in the core's types.

use crate::controlled::{GreatestRequest, core_regulator, core_sampling, ways};
use crate::diagnostic::Diagnostics;
use crate::document::Document;
use crate::model::JointExperiment;
use crate::scenario::{Aim, Command, Controller, Load, Scenario};
use mckibben::command::Driver;
use mckibben::control::{
    AirMass, Between, Drive, FeedForward, JointAim, JointController, JointMeasurement, JointSensors, JointTracker,
    Output, Quantity, RegulatorMemory, Sampling, Sensor, SetPoint,
};
use mckibben::plant::{JointPlant, PlantStepError, TimeStepping};
use mckibben::simulation::JointRig;
use mckibben::{Error, GaugePressure};

/// A joint with a controller ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlledJointExperiment {
    /// What is controlled; its valves have no commands but the controller's.
    pub experiment: JointExperiment,
    /// The controller.
    pub law: JointLaw,
    /// When it samples.
    pub sampling: Sampling,
    /// What it sees.
    pub sensors: JointSensors,
    /// What it regulates: the angle, or the pressures or air masses of both actuators.
    pub regulated: Quantity,
    /// The set points of the file.
    pub set_points: Vec<(Quantity, SetPoint)>,
    /// The greatest gauge pressure that it may request, where it requests any.
    pub greatest_request: Option<GreatestRequest>,
}

impl ControlledJointExperiment {
    /// The controller as the driver of both valves of its plant.
    ///
    /// # Errors
    /// As [`JointPlant::driver`].
    pub fn driver(&self, of: &JointPlant) -> Result<Driver, Error> {
        let driver = of.driver(self.law.clone(), (self.sampling, self.sensors))?;
        Ok(driver.with_set_points(self.set_points.iter().map(|(_, set_point)| set_point)))
    }

    /// How it goes through time: see [`JointExperiment::stepping`].
    ///
    /// # Errors
    /// As [`JointExperiment::stepping`].
    pub fn stepping(&self) -> Result<(TimeStepping, Option<PlantStepError>), Error> {
        let of = JointPlant::new(&self.experiment.rig)?;
        let driver = self.driver(&of)?;
        self.experiment.run.stepping_of((of.plant(), &of.start(&self.experiment.start)), &|| vec![driver.clone()])
    }
}

/// The controller of a scenario with a joint.
#[derive(Clone, Debug, PartialEq)]
pub enum JointLaw {
    /// The angle is kept at its set point.
    Tracker(Box<JointTracker>),
    /// The pressures that the model needs for angle and stiffness.
    FeedForward(Box<FeedForward<JointAim>>),
    /// The masses of air that the model needs for angle and stiffness.
    AirMass(Box<AirMass<JointAim>>),
}

impl JointController for JointLaw {
    type Memory = [RegulatorMemory; 2];

    fn begin(&self) -> Self::Memory {
        match self {
            Self::Tracker(law) => [law.begin(); 2],
            Self::FeedForward(law) => law.begin(),
            Self::AirMass(law) => law.begin(),
        }
    }

    fn decide(&self, seen: &JointMeasurement, memory: &mut Self::Memory) -> [Drive; 2] {
        match self {
            Self::Tracker(law) => law.decide(seen, &mut memory[0]),
            Self::FeedForward(law) => law.decide(seen, memory),
            Self::AirMass(law) => law.decide(seen, memory),
        }
    }

    fn aim(&self, seen: &JointMeasurement) -> [Option<(Quantity, f64)>; 2] {
        match self {
            Self::Tracker(law) => law.aim(seen),
            Self::FeedForward(law) => law.aim(seen),
            Self::AirMass(law) => law.aim(seen),
        }
    }
}

impl Scenario {
    /// Builds the joint and the controller that the scenario describes, or `None` when it has not both.
    ///
    /// # Errors
    /// What the core finds contradictory, as [`Scenario::experiment`].
    pub fn controlled_joint_experiment(&self) -> Result<Option<ControlledJointExperiment>, Error> {
        let (Load::AntagonisticJoint(_), Some(Command::Controller(of))) = (&self.load, &self.command) else {
            return Ok(None);
        };
        let Some(experiment) = self.open_loop().joint_experiment()? else { return Ok(None) };
        controlled(self, of, experiment).map(Some)
    }
}

impl Document {
    /// Reads the scenario and builds its joint and its controller, or `None` when it has not both.
    ///
    /// # Errors
    /// Every mistake in the file; then, if there is none, the first contradiction that the model finds, with its place
    /// in the file.
    pub fn controlled_joint_experiment(&self) -> Result<Option<ControlledJointExperiment>, Diagnostics> {
        let scenario = self.scenario()?;
        let (Load::AntagonisticJoint(_), Some(Command::Controller(of))) = (&scenario.load, &scenario.command) else {
            return Ok(None);
        };
        let Some(experiment) = self.joint_of(&scenario.open_loop())? else { return Ok(None) };
        controlled(&scenario, of, experiment).map(Some).map_err(|error| self.diagnose(&error).into())
    }
}

fn controlled(
    scenario: &Scenario,
    of: &Controller,
    experiment: JointExperiment,
) -> Result<ControlledJointExperiment, Error> {
    let own = ways(scenario)?;
    if let Some(second) = scenario.of_antagonist()
        && ways(&second)? != own
    {
        return Err(Error::Misuse {
            what: "one controller drives both actuators of a joint, and their valves are of different kinds",
            remedy: "remove valve.kind from [antagonist.valve]",
        });
    }
    let JointLoop { law, sampling, sensors, regulated, set_points, greatest_request } =
        joint_loop(of, own, || Ok(experiment.rig.clone()), experiment.run.duration)?;
    Ok(ControlledJointExperiment { experiment, law, sampling, sensors, regulated, set_points, greatest_request })
}

/// A controller of two actuators about a joint, with when and what it measures.
pub(crate) struct JointLoop {
    pub(crate) law: JointLaw,
    pub(crate) sampling: Sampling,
    pub(crate) sensors: JointSensors,
    pub(crate) regulated: Quantity,
    pub(crate) set_points: Vec<(Quantity, SetPoint)>,
    pub(crate) greatest_request: Option<GreatestRequest>,
}

/// Builds the controller of a joint for a run of `duration` s; `model` is the joint that a law by the model needs.
pub(crate) fn joint_loop(
    of: &Controller,
    ways: (Between, Output),
    model: impl FnOnce() -> Result<JointRig, Error>,
    duration: f64,
) -> Result<JointLoop, Error> {
    let regulated = of.aim.regulated();
    let regulator = core_regulator(&of.regulator, regulated, ways)?;
    let sensor = Sensor::new(regulated, of.resolution, None)?;
    let mut sensors = JointSensors::perfect();
    let mut set_points = Vec::new();
    let law = match &of.aim {
        Aim::Joint { angle, stiffness, highest_gauge_pressure, temperature } => {
            set_points.extend([(Quantity::Angle, angle.clone()), (Quantity::Stiffness, stiffness.clone())]);
            for of in &mut sensors.actuators {
                match regulated {
                    Quantity::AirMass => of.air_mass = sensor,
                    _ => of.pressure = sensor,
                }
            }
            let rig = model()?;
            if rig.fittings().iter().any(|of| of.tendon.is_some()) {
                return Err(Error::NotImplemented(&mckibben::limit::PLANT_MODEL));
            }
            let actuators = rig.driven().each_ref().map(|driven| driven.actuator.clone());
            let highest = GaugePressure(*highest_gauge_pressure);
            let aim = [angle.clone(), stiffness.clone()];
            let aim = JointAim::new(actuators, *rig.joint(), aim, highest)?;
            match temperature {
                Some(temperature) => JointLaw::AirMass(Box::new(AirMass::new(aim, *temperature, regulator)?)),
                None => JointLaw::FeedForward(Box::new(FeedForward { aim, regulator })),
            }
        }
        Aim::Track { set_point, .. } => {
            set_points.push((Quantity::Angle, set_point.clone()));
            sensors.angle = sensor;
            JointLaw::Tracker(Box::new(JointTracker { angle: set_point.clone(), regulator }))
        }
        Aim::Model { .. } => {
            return Err(Error::Misuse {
                what: "an aim of one actuator is given, but there is a joint",
                remedy: "choose another load.kind",
            });
        }
    };
    let sampling = core_sampling(of)?;
    sampling.check_counts(duration)?;
    let greatest_request = of.aim.greatest_request();
    Ok(JointLoop { law, sampling, sensors, regulated, set_points, greatest_request })
}
