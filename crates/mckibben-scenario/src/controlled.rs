//! From a controller in a file to the core's: the same numbers, in the core's types.

use crate::choice::{CommandState, ValveKind};
use crate::diagnostic::Diagnostics;
use crate::document::Document;
use crate::model::Experiment;
use crate::scenario::{Aim, Command, Controller, Load, Regulator, Scenario};
use mckibben::command::Driver;
use mckibben::control::{
    self, AirMass, Between, Drive, FeedForward, Measurement, Output, Pid, Place, Quantity, RegulatorMemory, Relay,
    Sampling, Sensor, Sensors, SetPoint, StaticAim, Tracker,
};
use mckibben::plant::{PlantStepError, RigPlant, TimeStepping};
use mckibben::{Actuator, Error, GaugePressure, parameter};

/// The greatest gauge pressure that a controller may request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GreatestRequest {
    /// The key that says so.
    pub key: &'static str,
    /// The pressure in Pa.
    pub gauge_pressure: f64,
}

impl Aim {
    /// The greatest gauge pressure that it may request, where it requests any.
    pub fn greatest_request(&self) -> Option<GreatestRequest> {
        match self {
            Self::Track { quantity: Quantity::Pressure, set_point } => {
                Some(GreatestRequest { key: parameter::SET_GAUGE_PRESSURE.key, gauge_pressure: set_point.ends()[1] })
            }
            Self::Track { .. } => None,
            Self::Model { highest_gauge_pressure, .. } | Self::Joint { highest_gauge_pressure, .. } => {
                Some(GreatestRequest {
                    key: parameter::HIGHEST_GAUGE_PRESSURE.key,
                    gauge_pressure: *highest_gauge_pressure,
                })
            }
        }
    }
}

/// A scenario with a controller ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlledExperiment {
    /// What is controlled; its valve has no command but the controller's.
    pub experiment: Experiment,
    /// The controller.
    pub law: ControlLaw,
    /// When it samples.
    pub sampling: Sampling,
    /// What it sees.
    pub sensors: Sensors,
    /// What it regulates.
    pub regulated: Quantity,
    /// The set points of the file.
    pub set_points: Vec<(Quantity, SetPoint)>,
    /// The greatest gauge pressure that it may request, where it requests any.
    pub greatest_request: Option<GreatestRequest>,
}

impl ControlledExperiment {
    /// The controller as the driver of the valve of its plant.
    ///
    /// # Errors
    /// As [`RigPlant::driver`].
    pub fn driver(&self, of: &RigPlant) -> Result<Driver, Error> {
        let driver = of.driver(self.law.clone(), (self.sampling, self.sensors))?;
        Ok(driver.with_set_points(self.set_points.iter().map(|(_, set_point)| set_point)))
    }

    /// How it goes through time: see [`Experiment::stepping`].
    ///
    /// # Errors
    /// As [`Experiment::stepping`].
    pub fn stepping(&self) -> Result<(TimeStepping, Option<PlantStepError>), Error> {
        let of = RigPlant::new(&self.experiment.rig);
        let driver = self.driver(&of)?;
        self.experiment.run.stepping_of((of.plant(), &of.start(&self.experiment.start)), &|| vec![driver.clone()])
    }
}

/// The controller of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub enum ControlLaw {
    /// A quantity is kept at its set point.
    Tracker(Tracker),
    /// The pressure that the model needs.
    FeedForward(Box<FeedForward>),
    /// The mass of air that the model needs.
    AirMass(Box<AirMass>),
}

impl control::Controller for ControlLaw {
    type Memory = RegulatorMemory;

    fn begin(&self) -> RegulatorMemory {
        match self {
            Self::Tracker(law) => law.begin(),
            Self::FeedForward(law) => law.begin(),
            Self::AirMass(law) => law.begin(),
        }
    }

    fn decide(&self, seen: &Measurement, memory: &mut RegulatorMemory) -> Drive {
        match self {
            Self::Tracker(law) => law.decide(seen, memory),
            Self::FeedForward(law) => law.decide(seen, memory),
            Self::AirMass(law) => law.decide(seen, memory),
        }
    }

    fn aim(&self, seen: &Measurement) -> Option<(Quantity, f64)> {
        match self {
            Self::Tracker(law) => law.aim(seen),
            Self::FeedForward(law) => law.aim(seen),
            Self::AirMass(law) => law.aim(seen),
        }
    }
}

impl Scenario {
    /// Builds what the scenario describes and its controller, or `None` when it has none, or one of a joint.
    ///
    /// # Errors
    /// What the core finds contradictory, as [`Scenario::experiment`].
    pub fn controlled_experiment(&self) -> Result<Option<ControlledExperiment>, Error> {
        match (&self.command, &self.load) {
            (Some(Command::Controller(_)), Load::AntagonisticJoint(_)) => Ok(None),
            (Some(Command::Controller(controller)), _) => controlled(self, controller).map(Some),
            _ => Ok(None),
        }
    }

    /// The scenario without its controller: the valve has no command where the controller would give one.
    pub fn open_loop(&self) -> Self {
        let mut open = self.clone();
        let still = |command: &mut Option<Command>| {
            if let Some(command) = command.as_mut().filter(|command| matches!(command, Command::Controller(_))) {
                *command = Command::Constant(CommandState::Exhaust);
            }
        };
        still(&mut open.command);
        if let Load::AntagonisticJoint(joint) = &mut open.load {
            still(&mut joint.antagonist.command);
        }
        open
    }
}

impl Document {
    /// Reads the scenario and builds what it describes and its controller, or `None` when it has none, or one of a joint.
    ///
    /// # Errors
    /// Every mistake in the file; then, if there is none, the first contradiction that the model finds, with its place
    /// in the file.
    pub fn controlled_experiment(&self) -> Result<Option<ControlledExperiment>, Diagnostics> {
        self.scenario()?.controlled_experiment().map_err(|error| self.diagnose(&error).into())
    }
}

fn controlled(scenario: &Scenario, of: &Controller) -> Result<ControlledExperiment, Error> {
    let ways = ways(scenario)?;
    let experiment = scenario.open_loop().experiment()?;
    let ActuatorLoop { law, sampling, sensors, regulated, set_points, greatest_request } =
        loop_of(of, ways, experiment.rig.actuator(), experiment.run.duration)?;
    Ok(ControlledExperiment { experiment, law, sampling, sensors, regulated, set_points, greatest_request })
}

/// A controller of one actuator, with when and what it measures.
pub(crate) struct ActuatorLoop {
    pub(crate) law: ControlLaw,
    pub(crate) sampling: Sampling,
    pub(crate) sensors: Sensors,
    pub(crate) regulated: Quantity,
    pub(crate) set_points: Vec<(Quantity, SetPoint)>,
    pub(crate) greatest_request: Option<GreatestRequest>,
}

/// Builds the controller of an actuator for a run of `duration` s.
pub(crate) fn loop_of(
    of: &Controller,
    ways: (Between, Output),
    actuator: &Actuator,
    duration: f64,
) -> Result<ActuatorLoop, Error> {
    let regulated = of.aim.regulated();
    let regulator = core_regulator(&of.regulator, regulated, ways)?;
    let law = match &of.aim {
        Aim::Track { quantity, set_point } => {
            ControlLaw::Tracker(Tracker::new(*quantity, set_point.clone(), regulator)?)
        }
        Aim::Joint { .. } => return Err(without_joint()),
        Aim::Model { force, length, highest_gauge_pressure, temperature } => {
            let place = length.clone().map_or(Place::Measured, Place::Wanted);
            let highest = GaugePressure(*highest_gauge_pressure);
            let aim = StaticAim::new(actuator.clone(), force.clone(), place, highest)?;
            match temperature {
                Some(temperature) => ControlLaw::AirMass(Box::new(AirMass::new(aim, *temperature, regulator)?)),
                None => ControlLaw::FeedForward(Box::new(FeedForward { aim, regulator })),
            }
        }
    };
    let sampling = core_sampling(of)?;
    sampling.check_counts(duration)?;
    let sensor = Sensor::new(regulated, of.resolution, None)?;
    let mut sensors = Sensors::perfect();
    match regulated {
        Quantity::Pressure => sensors.pressure = sensor,
        Quantity::Length => sensors.length = sensor,
        Quantity::AirMass => sensors.air_mass = sensor,
        _ => sensors.tension = sensor,
    }
    let set_points = match &of.aim {
        Aim::Track { quantity, set_point } => vec![(*quantity, set_point.clone())],
        Aim::Model { force, length, .. } => {
            let length = length.clone().map(|length| (Quantity::Length, length));
            length.into_iter().chain([(Quantity::Force, force.clone())]).collect()
        }
        Aim::Joint { .. } => Vec::new(),
    };
    let greatest_request = of.aim.greatest_request();
    Ok(ActuatorLoop { law, sampling, sensors, regulated, set_points, greatest_request })
}

/// An aim of a joint where there is none; a file is refused before.
fn without_joint() -> Error {
    Error::Misuse { what: "an aim of a joint is given, but there is no joint", remedy: "choose another load.kind" }
}

/// What a relay and a PID controller can command a valve to do.
pub(crate) fn ways(scenario: &Scenario) -> Result<(Between, Output), Error> {
    match scenario.valve.map(|valve| valve.kind) {
        Some(ValveKind::ThreeWay | ValveKind::ThreeWayNormallyOpen) => Ok((Between::Keep, Output::FillExhaust)),
        Some(ValveKind::FillHoldExhaust) => Ok((Between::Hold, Output::FillHoldExhaust)),
        _ => Err(Error::NotImplemented(&mckibben::limit::CONTROLLER_VALVE)),
    }
}

pub(crate) fn core_sampling(of: &Controller) -> Result<Sampling, Error> {
    let sampling = Sampling::new(of.rate, of.delay)?;
    of.pulse_frequency.map_or(Ok(sampling), |frequency| sampling.with_pulse_frequency(frequency))
}

pub(crate) fn core_regulator(
    of: &Regulator,
    regulated: Quantity,
    (between, output): (Between, Output),
) -> Result<control::Regulator, Error> {
    match *of {
        Regulator::Relay { dead_band, hysteresis } => {
            Relay::new(regulated, dead_band, hysteresis, between).map(control::Regulator::Relay)
        }
        Regulator::Pid {
            proportional_band,
            integral_time,
            derivative_time,
            derivative_filter,
            set_point_weight,
            tracking_time,
            bias,
        } => {
            let pid = Pid::new(regulated, proportional_band, output)?
                .with_derivative(derivative_time, derivative_filter)?
                .with_set_point_weight(set_point_weight)?
                .with_bias(bias)?;
            let pid = integral_time.map_or(Ok(pid), |time| pid.with_integral(time))?;
            let pid = tracking_time.map_or(Ok(pid), |time| pid.with_tracking(time))?;
            Ok(control::Regulator::Pid(pid))
        }
    }
}
