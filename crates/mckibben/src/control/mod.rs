//! Control: what the valve is to do, from what is measured, at a stated rate.
//!
//! ```text
//! measurement at t = k/f_s   →  sensor (step, range)  →  controller  →  command from t = (k + d)/f_s until the next
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | f_s | `rate` of [`Sampling`] | Hz |
//! | d | `delay` of [`Sampling`] | sampling instants |
//!
//! A [`Controller`] is parameters and one function, from a [`Measurement`] and its own memory to a [`Drive`]. The memory is
//! a plain value that belongs to the caller, as the state of the actuator does: a run can be restarted from it, the rows of
//! a batch each carry their own, and dual numbers in it are derivatives. A controller of your own:
//!
//! ```
//! use mckibben::control::{Controller, Drive, Measurement};
//! use mckibben::valve::Request;
//!
//! /// Fills for `pulses` samples, then holds.
//! struct Puff {
//!     pulses: u32,
//! }
//!
//! impl Controller for Puff {
//!     type Memory = u32;
//!
//!     fn begin(&self) -> u32 {
//!         0
//!     }
//!
//!     fn decide(&self, _seen: &Measurement, taken: &mut u32) -> Drive {
//!         *taken += 1;
//!         Drive::Steady(if *taken <= self.pulses { Request::Fill } else { Request::Hold })
//!     }
//! }
//! ```
//!
//! | law | what it does |
//! |---|---|
//! | [`Tracker`] | keeps pressure, length, air mass or tension at a [`SetPoint`] |
//! | [`JointTracker`] | keeps a joint at an angle: the agonist follows the request, the antagonist the opposite one |
//! | [`FeedForward`] | gives the pressure that a static model needs for a force at a length |
//! | [`AirMass`] | gives the mass of air that the model needs there |
//!
//! The last two are of one actuator with a [`StaticAim`], of a joint with a [`JointAim`]: an angle and a stiffness.
//!
//! Each of these hands what is wanted and what is measured to a [`Regulator`]: a [`Relay`] (bang-bang with a dead band) or a
//! [`Pid`], whose duty cycle is followed by pulse-width modulation. Two controllers of one actuator each, `[a, b]`, are a
//! [`JointController`].
//!
//! Sources are with each law. Checked by `tests/control.rs`, `tests/pid.rs` and `tests/inverse.rs`.

mod air_mass;
mod feed_forward;
mod inverse;
mod joint_aim;
mod modulator;
mod pair;
mod pid;
mod quantity;
mod relay;
mod sampling;
mod sensor;
mod set_point;
mod tracker;

pub use air_mass::AirMass;
pub use feed_forward::{FeedForward, Place, StaticAim};
pub use joint_aim::JointAim;
pub use modulator::Modulator;
pub use pair::{AntagonisticPair, Held};
pub use pid::{Output, Pid, PidMemory};
pub use quantity::{Quantity, Rows};
pub use relay::{Between, Relay};
pub use sampling::{MAX_DELAY, Sampled, Sampling};
pub use sensor::{JointSensors, Sensor, Sensors};
pub use set_point::SetPoint;
pub use tracker::{JointTracker, Regulator, RegulatorMemory, Tracker};

use crate::pressure::GaugePressure;
use crate::scalar::{Real, Scalar};
use crate::valve::Request;
use core::fmt::Debug;

/// What a controller knows of one actuator at a sampling instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement<R = f64> {
    /// The sampling instant in s.
    pub time: R,
    /// Distance between the attachments in m.
    pub length: R,
    /// Its rate in m/s, positive when the actuator lengthens.
    pub velocity: R,
    /// Gauge pressure, as a transducer measures it.
    pub pressure: GaugePressure<R>,
    /// Mass of the air in kg.
    pub air_mass: R,
    /// Tension in N.
    pub tension: R,
}

/// What a controller knows of a joint at a sampling instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMeasurement<R = f64> {
    /// The sampling instant in s.
    pub time: R,
    /// Angle in rad, growing the way that the agonist turns.
    pub angle: R,
    /// Angular velocity in rad/s.
    pub angular_velocity: R,
    /// Agonist and antagonist.
    pub actuators: [Measurement<R>; 2],
}

/// What the valve is to do until the next command takes effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive<R = f64> {
    /// A constant request.
    Steady(Request),
    /// Pulse-width modulation; the pulse starts each period.
    Pulses {
        /// Share of each period in which `pulse` is requested, 0 to 1.
        duty: R,
        /// The request during the pulse.
        pulse: Request,
        /// The request during the rest of the period.
        rest: Request,
    },
}

impl<R: Scalar> Drive<R> {
    /// The opposite: fill for exhaust and exhaust for fill.
    pub fn mirrored(self) -> Self {
        match self {
            Self::Steady(request) => Self::Steady(request.opposite()),
            Self::Pulses { duty, pulse, rest } => Self::Pulses { duty, pulse: pulse.opposite(), rest: rest.opposite() },
        }
    }
}

/// A controller of one actuator.
pub trait Controller<R: Real = f64> {
    /// What it remembers from one sampling instant to the next; it belongs to the caller.
    type Memory: Copy + Debug;

    /// The memory before the first sampling instant.
    fn begin(&self) -> Self::Memory;

    /// What the valve is to do, from what is measured.
    fn decide(&self, seen: &Measurement<R>, memory: &mut Self::Memory) -> Drive<R>;

    /// What it tries to reach at a sampling instant and in which quantity, if it has such an aim.
    fn aim(&self, seen: &Measurement<R>) -> Option<(Quantity, R)> {
        let _ = seen;
        None
    }
}

impl<R: Real, C: Controller<R>> Controller<R> for &C {
    type Memory = C::Memory;

    fn begin(&self) -> Self::Memory {
        C::begin(self)
    }

    fn decide(&self, seen: &Measurement<R>, memory: &mut Self::Memory) -> Drive<R> {
        C::decide(self, seen, memory)
    }

    fn aim(&self, seen: &Measurement<R>) -> Option<(Quantity, R)> {
        C::aim(self, seen)
    }
}

/// A controller of a joint that two actuators turn.
pub trait JointController<R: Real = f64> {
    /// What it remembers from one sampling instant to the next; it belongs to the caller.
    type Memory: Copy + Debug;

    /// The memory before the first sampling instant.
    fn begin(&self) -> Self::Memory;

    /// What the valves of agonist and antagonist are to do, from what is measured.
    fn decide(&self, seen: &JointMeasurement<R>, memory: &mut Self::Memory) -> [Drive<R>; 2];

    /// What it tries to reach at a sampling instant and in which quantity, for the joint or for agonist and antagonist.
    fn aim(&self, seen: &JointMeasurement<R>) -> [Option<(Quantity, R)>; 2] {
        let _ = seen;
        [None; 2]
    }
}

impl<R: Real, C: JointController<R>> JointController<R> for &C {
    type Memory = C::Memory;

    fn begin(&self) -> Self::Memory {
        C::begin(self)
    }

    fn decide(&self, seen: &JointMeasurement<R>, memory: &mut Self::Memory) -> [Drive<R>; 2] {
        C::decide(self, seen, memory)
    }

    fn aim(&self, seen: &JointMeasurement<R>) -> [Option<(Quantity, R)>; 2] {
        C::aim(self, seen)
    }
}

impl<R: Real, C: Controller<R>> JointController<R> for [C; 2] {
    type Memory = [C::Memory; 2];

    fn begin(&self) -> Self::Memory {
        self.each_ref().map(C::begin)
    }

    fn decide(&self, seen: &JointMeasurement<R>, memory: &mut Self::Memory) -> [Drive<R>; 2] {
        let [agonist, antagonist] = memory;
        [self[0].decide(&seen.actuators[0], agonist), self[1].decide(&seen.actuators[1], antagonist)]
    }

    fn aim(&self, seen: &JointMeasurement<R>) -> [Option<(Quantity, R)>; 2] {
        [0, 1].map(|i| self[i].aim(&seen.actuators[i]))
    }
}
