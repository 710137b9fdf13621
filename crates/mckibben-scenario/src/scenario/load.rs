//! What the actuator moves.

use super::{Actuator, Command, Hose, PressureSeries, Supply, Valve};

/// An elastic tendon between actuator and load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesTendon {
    /// Stiffness k in N/m.
    pub stiffness: f64,
    /// Length ℓ without tension in m.
    pub rest_length: f64,
}

/// What the actuator pulls on.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// A mass that hangs from the actuator.
    HangingMass {
        /// Mass M in kg.
        mass: f64,
        /// Acceleration of gravity g in m/s² along the actuator.
        gravity: f64,
    },
    /// A mass that a constant force pulls.
    ConstantForce {
        /// The force in N, positive when it stretches the actuator.
        force: f64,
        /// Mass M in kg.
        mass: f64,
    },
    /// The length is fixed at the initial one.
    Isometric,
    /// The length is a given function of time.
    PrescribedMotion(Motion),
    /// A joint that two actuators turn against each other.
    AntagonisticJoint(Joint),
}

/// A joint that the scenario's actuator, the agonist, and a second one turn against each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Mass M of the limb in kg.
    pub mass: f64,
    /// Acceleration of gravity g in m/s².
    pub gravity: f64,
    /// Distance d in m of the limb's centre of mass from the axis.
    pub distance: f64,
    /// Moment of inertia I of the limb about its centre of mass in kg·m².
    pub inertia: f64,
    /// Angle θ_0 in rad at which the limb hangs straight down.
    pub hanging_angle: f64,
    /// Constant torque W in N·m.
    pub torque: f64,
    /// Viscous damping c in N·m·s/rad.
    pub damping: f64,
    /// Angle in rad of the lower stop, if there is one.
    pub min_angle: Option<f64>,
    /// Angle in rad of the upper stop, if there is one.
    pub max_angle: Option<f64>,
    /// Stiffness K_stop of the stops in N·m/rad.
    pub stop_stiffness: f64,
    /// Damping C_stop of the stops in N·m·s/rad.
    pub stop_damping: f64,
    /// How the agonist is led over the joint.
    pub tendon: Tendon,
    /// Angle at the start.
    pub angle: InitialAngle,
    /// Angular velocity at the start in rad/s.
    pub angular_velocity: f64,
    /// The second actuator.
    pub antagonist: Box<Antagonist>,
}

/// How an actuator is led over a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Tendon {
    /// Its moment arm.
    pub arm: MomentArm,
    /// Distance in m between the attachments at angle zero.
    pub rest_length: f64,
}

/// The moment arm of an actuator about a joint.
#[derive(Clone, Debug, PartialEq)]
pub enum MomentArm {
    /// A pulley of this radius in m.
    Pulley(f64),
    /// A monotone cubic through moment arms in m.
    Table {
        /// Rising joint angles in rad.
        angle: Vec<f64>,
        /// The arm at each, above zero.
        arm: Vec<f64>,
    },
}

/// Angle of a joint at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialAngle {
    /// Where the torques balance at the initial pressures.
    Equilibrium,
    /// This angle in rad.
    At(f64),
}

/// The second actuator of a joint; what the file does not say of it is as of the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Antagonist {
    /// The braided actuator.
    pub actuator: Actuator,
    /// The air behind the valve.
    pub supply: Option<Supply>,
    /// The valve.
    pub valve: Option<Valve>,
    /// Whether it draws from a separate supply, which the file then describes for it; else both draw from one.
    pub has_own_supply: bool,
    /// The hose from its valve.
    pub hose: Option<Hose>,
    /// The command to the valve.
    pub command: Option<Command>,
    /// The pressure over time, where it is given; in place of a valve.
    pub pressure: Option<PressureSeries>,
    /// How it is led over the joint.
    pub tendon: Tendon,
    /// The elastic tendon between it and the joint, if there is one.
    pub series_tendon: Option<SeriesTendon>,
    /// Gauge pressure at the start in Pa; where it is not said, that of the first row of a pressure that is given.
    pub gauge_pressure: Option<f64>,
    /// Temperature of the air at the start in K.
    pub temperature: f64,
}

/// A length as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// L(t) = L_0 + A sin(2π f t + φ).
    Sinusoid {
        /// Mean length L_0 in m.
        length: f64,
        /// Amplitude A in m, less than the mean length.
        amplitude: f64,
        /// Frequency f in Hz.
        frequency: f64,
        /// Phase φ in rad.
        phase: f64,
    },
    /// Straight lines between points, constant outside.
    Table {
        /// Times in s, strictly increasing, from zero on.
        time: Vec<f64>,
        /// Lengths in m.
        length: Vec<f64>,
    },
}
