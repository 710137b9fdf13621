//! A plant of several actuators as a file says it.
//!
//! ```text
//! [supplies.tank]                  a tree of air: sources, reservoirs, regulators, manifolds, each fed by one before it
//! [mechanism] [mechanism.joints.elbow]
//! [valve] [command] [coupling] …   what every actuator has unless its own say otherwise
//! [actuators.biceps]               keys of [actuator], and below it its sections
//! ```
//!
//! | file | its idea |
//! |---|---|
//! | `parts` | the document as it stands for one actuator, one supply, one mechanism |
//! | `read::plant`, `read::mechanism` | what the file says, as plain values |
//! | `network` | the supplies and what the actuators draw from them |
//! | `build` | from those to the core's plant and its start |
//! | `control` | its controllers |
//! | `columns` | what there is to record of it, by names |
//! | `names` | what it calls its parts |
//! | `adjust` | other values of its parameters, and derivatives with respect to them |
//!
//! Checked by `tests/plant.rs`.

mod adjust;
mod build;
pub(crate) mod columns;
mod control;
mod names;
mod network;
pub(crate) mod parts;

use crate::diagnostic::{Diagnostics, Place};
use crate::document::Document;
use crate::keys;
use crate::scenario::{Air, Command, Controller, FlowPath, Hose, Motion, Run, Scenario, Supply, Valve};
use mckibben::Error;
use mckibben::command::Driver;
use mckibben::mechanism::Mechanism;
use mckibben::plant::{Plant, PlantStart, PlantStepError, TimeStepping};

pub use adjust::{AdjustedPlant, PlantOver, PlantPlace};
pub use columns::{Coordinate, PlantColumn, PlantContent, PlantQuantity};
pub use control::{ActuatorControl, JointControl, PlantControl};
pub use names::{MechanismNames, PlantNames};

/// A plant ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantExperiment {
    /// Actuators, air and mechanisms.
    pub plant: Plant,
    /// The state at the start.
    pub start: PlantStart,
    /// How long to simulate and what to record.
    pub run: Run,
    /// What the file calls the parts.
    pub names: PlantNames,
    /// The controllers.
    pub controls: Vec<PlantControl>,
}

impl PlantExperiment {
    /// How it goes through time. A fixed step that no one gives is the longest that the accuracy allows, with its error.
    ///
    /// # Errors
    /// As [`plant_step_for_accuracy`](mckibben::plant::plant_step_for_accuracy), when a step is chosen.
    pub fn stepping(&self) -> Result<(TimeStepping, Option<PlantStepError>), Error> {
        self.run.stepping_of((&self.plant, &self.start), &|| self.drivers())
    }

    /// The step in s of fixed steps: the one that is given, or the longest that the accuracy allows.
    ///
    /// # Errors
    /// As [`plant_step_for_accuracy`](mckibben::plant::plant_step_for_accuracy), when a step is chosen.
    pub fn fixed_step(&self) -> Result<f64, Error> {
        self.run.step_of((&self.plant, &self.start), &|| self.drivers()).map(|(step, _)| step)
    }

    /// Its controllers before their first samples.
    pub fn drivers(&self) -> Vec<Driver> {
        self.controls.iter().map(PlantControl::driver).collect()
    }
}

/// What a file says of one actuator of a plant.
#[derive(Clone, Debug)]
pub(crate) struct Member {
    pub(crate) name: String,
    /// Actuator, valve, hose, command and start as if it were alone; its load, where it is on no mechanism.
    pub(crate) alone: Scenario,
    /// The supply that its valve draws from.
    pub(crate) supply: Option<String>,
    /// Which output of a five-way valve drives it.
    pub(crate) output: usize,
    pub(crate) mount: Mount,
}

/// What an actuator pulls on.
#[derive(Clone, Debug)]
pub(crate) enum Mount {
    /// Its own load.
    Own,
    /// A mechanism, whose coordinate is its distance.
    Direct { mechanism: usize },
    /// A chain, by moment arms: the joint, the angles and the arms, one arm alone where it is a pulley's.
    Arms { mechanism: usize, rest_length: f64, arms: Vec<(usize, Vec<f64>, Vec<f64>)> },
    /// A chain, between two points: the segment, if it is not the ground, along and across.
    Points { mechanism: usize, ends: [(Option<usize>, [f64; 2]); 2] },
}

/// What a file says of one supply.
#[derive(Clone, Debug)]
pub(crate) struct Store {
    pub(crate) name: String,
    pub(crate) supply: Supply,
    /// The supply that feeds it, by its index, which is less than its own.
    pub(crate) from: Option<usize>,
    pub(crate) inlet: Option<Inlet>,
    /// A valve in its place, and its command.
    pub(crate) valve: Option<(Valve, Command)>,
    /// A hose behind either.
    pub(crate) hose: Option<Hose>,
}

/// A fixed flow path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inlet {
    pub(crate) one_way: bool,
    pub(crate) flow_path: FlowPath,
    pub(crate) efficiency: f64,
    pub(crate) laminar_ratio: f64,
}

/// What a file says of one mechanism.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) name: String,
    pub(crate) mechanism: Mechanism,
    /// Its motion, where that is given; the actuators say how long it may become.
    pub(crate) motion: Option<Motion>,
    pub(crate) joints: Vec<String>,
    pub(crate) segments: Vec<String>,
    pub(crate) positions: Vec<f64>,
    pub(crate) rates: Vec<f64>,
    pub(crate) controllers: Vec<JointController>,
}

/// What a file says of the controller of a joint.
#[derive(Clone, Debug)]
pub(crate) struct JointController {
    pub(crate) joint: usize,
    /// The names of agonist and antagonist, and where they stand.
    pub(crate) actuators: [String; 2],
    pub(crate) places: [Place; 2],
    pub(crate) place: Place,
    pub(crate) controller: Controller,
}

/// A plant as a file says it.
#[derive(Clone, Debug)]
pub(crate) struct PlantScenario {
    pub(crate) members: Vec<Member>,
    pub(crate) stores: Vec<Store>,
    pub(crate) frames: Vec<Frame>,
    pub(crate) air: Air,
    pub(crate) run: Run,
}

impl Document {
    /// Whether the file describes a plant: it names actuators, supplies or mechanisms.
    pub fn is_plant(&self) -> bool {
        [keys::ACTUATORS, keys::SUPPLIES, keys::MECHANISM, keys::MECHANISMS]
            .iter()
            .any(|section| self.contains(section))
    }

    /// Reads the plant that the document describes and builds it, or `None` when it describes no plant.
    ///
    /// # Errors
    /// Every mistake in the file; then, if there is none, the first contradiction that the model finds of each actuator and each
    /// supply; then of each controller; then of the start. Each has its place in the file.
    pub fn plant_experiment(&self) -> Result<Option<PlantExperiment>, Diagnostics> {
        if !self.is_plant() {
            return Ok(None);
        }
        let scenario = self.read_plant()?;
        self.build_plant(scenario).map(Some)
    }
}
