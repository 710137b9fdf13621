//! What a scenario file says, as plain validated values in SI.
//!
//! Units, presets and defaults are resolved: every field is a number in the unit its sentence names, or one of a few
//! choices. Each number is within the range of its row in the core's parameter table. What takes the model to judge
//! (whether the braid's lengths fit each other, say) is judged by the constructors of the core, whose errors
//! [`Document::diagnose`](crate::Document::diagnose) locates in the file.

mod actuator;
mod air;
mod load;
mod valve;

pub use actuator::{
    Actuator, Bladder, Effectiveness, Force, Friction, Hysteresis, Limit, Taper, TonduLopezCoefficients, Viscoelastic,
};
pub use air::{Air, Compressor, Hose, PressureRegulator, PressureSensor, PressureSeries, Process, Reservoir, Supply};
pub use load::{Antagonist, InitialAngle, Joint, Load, MomentArm, Motion, SeriesTendon, Tendon};
pub use valve::{Aim, Command, Controller, FlowPath, ProportionalRegulator, Regulator, Spool, Valve};

use crate::choice::{Engine, Method};
use crate::diagnostic::Diagnostics;
use crate::document::Document;
use mckibben::plant::InitialFriction;
use std::path::Path;

/// One experiment: what is built, what drives it, what is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The braided actuator.
    pub actuator: Actuator,
    /// The gas in the actuator and around it.
    pub air: Air,
    /// The air behind the valve; always there when `valve` is.
    pub supply: Option<Supply>,
    /// The valve; without one the actuator is sealed.
    pub valve: Option<Valve>,
    /// The hose from the valve to the actuator; there only with a valve.
    pub hose: Option<Hose>,
    /// The command to the valve; there exactly when `valve` is.
    pub command: Option<Command>,
    /// The pressure in the actuator over time, where it is given; in place of a valve.
    pub pressure: Option<PressureSeries>,
    /// The elastic tendon between actuator and load, if there is one.
    pub tendon: Option<SeriesTendon>,
    /// What the actuator pulls on.
    pub load: Load,
    /// The state at the start.
    pub initial: Initial,
    /// How long to simulate and what to record.
    pub run: Run,
}

/// The state at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Initial {
    /// Gauge pressure in the actuator in Pa; where it is not said, that of the first row of a pressure that is given.
    pub gauge_pressure: Option<f64>,
    /// Temperature of the actuator's air in K.
    pub temperature: f64,
    /// Distance between the attachments.
    pub length: InitialLength,
    /// Velocity of lengthening in m/s.
    pub velocity: f64,
    /// Where friction with a memory starts; relaxed in a file of one actuator.
    pub friction: InitialFriction,
}

/// Distance between the attachments at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialLength {
    /// Where the load is balanced at the initial pressure.
    Equilibrium,
    /// This length in m; always so with an isometric load.
    At(f64),
    /// What the prescribed motion says at t = 0; always and only so with that load.
    OfMotion,
    /// What the joint's angle says; always and only so with an antagonistic joint.
    OfJoint,
}

/// How long to simulate and what to record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Simulated time in s.
    pub duration: f64,
    /// Time between two written samples in s, not above the duration.
    pub sample_interval: f64,
    /// How the simulation goes through time.
    pub engine: Engine,
    /// Relative error that the event-located integrator allows a step.
    pub relative_tolerance: f64,
    /// Formula of the fixed-step engine.
    pub method: Method,
    /// Step of the fixed-step engine in s; when absent it follows from the accuracy.
    pub step: Option<f64>,
    /// Largest error of the fixed-step engine as a share of each state's range; without effect when a step is given.
    pub accuracy: f64,
}

impl Scenario {
    /// Whether two actuators turn a joint.
    pub fn has_joint(&self) -> bool {
        matches!(self.load, Load::AntagonisticJoint(_))
    }

    /// Whether both actuators of a joint draw from one supply.
    pub fn shares_supply(&self) -> bool {
        match &self.load {
            Load::AntagonisticJoint(joint) => {
                !joint.antagonist.has_own_supply && joint.antagonist.supply == self.supply
            }
            _ => false,
        }
    }

    /// Whether a controller drives the valve.
    pub fn has_controller(&self) -> bool {
        matches!(self.command, Some(Command::Controller(_)))
    }

    /// Reads a scenario from text; `file_name` stands in messages.
    ///
    /// # Errors
    /// Every mistake in the text.
    pub fn from_str(text: &str, file_name: &str) -> Result<Self, Diagnostics> {
        Document::parse(text, file_name)?.scenario()
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    /// When the file cannot be read, or every mistake in it.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Diagnostics> {
        Document::load(path)?.scenario()
    }
}
