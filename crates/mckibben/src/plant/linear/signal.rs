//! What the states, inputs and outputs of a plant's linear model are.
//!
//! Each is a difference from its value at the operating point. Actuators, mechanisms, nodes, branches and valves are counted
//! as in the [`Plant`], so that a caller with names for them can name every row and column.

use crate::mechanism::Mechanism;
use crate::plant::Plant;
use crate::valve::Port;

/// A state of a plant's linear model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PlantState {
    /// A coordinate of a mechanism, in m or rad.
    Position {
        /// The mechanism.
        mechanism: usize,
        /// Its coordinate.
        coordinate: usize,
    },
    /// The rate of a coordinate, in m/s or rad/s.
    Velocity {
        /// The mechanism.
        mechanism: usize,
        /// Its coordinate.
        coordinate: usize,
    },
    /// Absolute pressure in an actuator, in Pa.
    Pressure {
        /// The actuator.
        actuator: usize,
    },
    /// Mass of the air in an actuator, in kg.
    AirMass {
        /// The actuator.
        actuator: usize,
    },
    /// Length in m of an actuator on a tendon, where viscous friction makes it a state.
    Length {
        /// The actuator.
        actuator: usize,
    },
    /// Deflection in m of the bristles of LuGre's law.
    Bristles {
        /// The actuator.
        actuator: usize,
    },
    /// Relaxed length in m of a viscoelastic branch.
    Branch {
        /// The actuator.
        actuator: usize,
        /// Its branch.
        branch: usize,
    },
    /// Absolute pressure in Pa of a hose's volume or cell, a reservoir, a regulator's outlet or a regulated port.
    NodePressure {
        /// The node.
        node: usize,
    },
    /// Flow in kg/s out of a cell of a distributed hose.
    BranchFlow {
        /// The branch.
        branch: usize,
    },
    /// Position of a proportional spool, from −1 to 1.
    SpoolPosition {
        /// The valve.
        valve: usize,
    },
    /// Velocity of a proportional spool in 1/s.
    SpoolVelocity {
        /// The valve.
        valve: usize,
    },
}

/// An input of a plant's linear model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PlantInput {
    /// Commanded duty of a pulsed valve, from 0 to 1.
    Duty {
        /// The valve.
        valve: usize,
    },
    /// Set point of a proportional pressure regulator, in Pa.
    SetPoint {
        /// The valve.
        valve: usize,
    },
    /// Commanded position of a proportional spool, from −1 to 1.
    SpoolCommand {
        /// The valve.
        valve: usize,
    },
    /// Opening of a valve's flow paths to one of its ports, from 0 to 1.
    Opening {
        /// The valve.
        valve: usize,
        /// The port.
        port: Port,
    },
    /// Pressure in Pa of a source, or what the regulator of an outlet is set to.
    SupplyPressure {
        /// The node.
        node: usize,
    },
    /// Mass flow in kg/s into an actuator, in addition to that through its valve and leak.
    MassFlow {
        /// The actuator.
        actuator: usize,
    },
    /// Mass flow in kg/s into a reservoir, in addition to that of its branches: what a compressor delivers on average.
    NodeFlow {
        /// The node.
        node: usize,
    },
    /// Force in N or torque in N·m along a coordinate, in addition to the mechanism's own.
    Force {
        /// The mechanism.
        mechanism: usize,
        /// Its coordinate.
        coordinate: usize,
    },
    /// A coordinate in m whose motion is given: of a prescribed motion or a host simulator.
    Motion {
        /// The mechanism.
        mechanism: usize,
        /// Its coordinate.
        coordinate: usize,
    },
    /// The rate in m/s of such a coordinate: the derivative of [`PlantInput::Motion`], which the model does not form.
    MotionRate {
        /// The mechanism.
        mechanism: usize,
        /// Its coordinate.
        coordinate: usize,
    },
    /// Absolute pressure in Pa in an actuator whose pressure is given over time.
    GivenPressure {
        /// The actuator.
        actuator: usize,
    },
}

/// An output of a plant's linear model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PlantOutput {
    /// Length of an actuator in m.
    Length {
        /// The actuator.
        actuator: usize,
    },
    /// Rate of an actuator's length in m/s.
    LengthRate {
        /// The actuator.
        actuator: usize,
    },
    /// Absolute pressure in an actuator, in Pa.
    Pressure {
        /// The actuator.
        actuator: usize,
    },
    /// Tension of an actuator, and of the tendon in series, in N.
    Tension {
        /// The actuator.
        actuator: usize,
    },
    /// A coordinate of a mechanism, in m or rad.
    Position {
        /// The mechanism.
        mechanism: usize,
        /// Its coordinate.
        coordinate: usize,
    },
    /// The rate of a coordinate, in m/s or rad/s.
    Velocity {
        /// The mechanism.
        mechanism: usize,
        /// Its coordinate.
        coordinate: usize,
    },
    /// Force in N or torque in N·m of all actuators along a coordinate.
    ActuatorForce {
        /// The mechanism.
        mechanism: usize,
        /// Its coordinate.
        coordinate: usize,
    },
    /// Absolute pressure in Pa of a node whose pressure is a state.
    NodePressure {
        /// The node.
        node: usize,
    },
}

impl PlantState {
    /// Its SI unit; empty for a pure number.
    pub fn unit(&self, plant: &Plant) -> &'static str {
        match *self {
            Self::Position { mechanism, .. } => position_unit(plant, mechanism),
            Self::Velocity { mechanism, .. } => rate_unit(plant, mechanism),
            Self::Pressure { .. } | Self::NodePressure { .. } => "Pa",
            Self::AirMass { .. } => "kg",
            Self::Length { .. } | Self::Bristles { .. } | Self::Branch { .. } => "m",
            Self::BranchFlow { .. } => "kg/s",
            Self::SpoolPosition { .. } => "",
            Self::SpoolVelocity { .. } => "1/s",
        }
    }

    /// Whether it is the rate of another state.
    pub fn is_rate(&self) -> bool {
        matches!(self, Self::Velocity { .. } | Self::SpoolVelocity { .. })
    }
}

impl PlantInput {
    /// Its SI unit; empty for a pure number.
    pub fn unit(&self, plant: &Plant) -> &'static str {
        match *self {
            Self::Duty { .. } | Self::SpoolCommand { .. } | Self::Opening { .. } => "",
            Self::SetPoint { .. } | Self::SupplyPressure { .. } | Self::GivenPressure { .. } => "Pa",
            Self::MassFlow { .. } | Self::NodeFlow { .. } => "kg/s",
            Self::Force { mechanism, .. } => force_unit(plant, mechanism),
            Self::Motion { mechanism, .. } => position_unit(plant, mechanism),
            Self::MotionRate { mechanism, .. } => rate_unit(plant, mechanism),
        }
    }
}

impl PlantOutput {
    /// Its SI unit.
    pub fn unit(&self, plant: &Plant) -> &'static str {
        match *self {
            Self::Length { .. } => "m",
            Self::LengthRate { .. } => "m/s",
            Self::Pressure { .. } | Self::NodePressure { .. } => "Pa",
            Self::Tension { .. } => "N",
            Self::Position { mechanism, .. } => position_unit(plant, mechanism),
            Self::Velocity { mechanism, .. } => rate_unit(plant, mechanism),
            Self::ActuatorForce { mechanism, .. } => force_unit(plant, mechanism),
        }
    }
}

fn turns(plant: &Plant, mechanism: usize) -> bool {
    matches!(plant.mechanisms().get(mechanism), Some(Mechanism::Chain(_)))
}

fn position_unit(plant: &Plant, mechanism: usize) -> &'static str {
    if turns(plant, mechanism) { "rad" } else { "m" }
}

fn rate_unit(plant: &Plant, mechanism: usize) -> &'static str {
    if turns(plant, mechanism) { "rad/s" } else { "m/s" }
}

fn force_unit(plant: &Plant, mechanism: usize) -> &'static str {
    if turns(plant, mechanism) { "N*m" } else { "N" }
}
