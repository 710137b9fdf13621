//! Tracking: a quantity is kept at its set point.
//!
//! What is wanted and what is measured go to a [`Regulator`]. More air makes a muscle shorter and everything else more:
//! for a length both change their sign first, so that an error above zero always requests air.

use super::{
    Controller, Drive, JointController, JointMeasurement, Measurement, Pid, PidMemory, Quantity, Relay, SetPoint,
};
use crate::error::Error;
use crate::parameter::Parameter;
use crate::scalar::{Real, Scalar};
use crate::valve::Request;

/// From what is wanted and what is measured to what the valve is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regulator<S = f64> {
    /// Bang-bang with a dead band.
    Relay(Relay<S>),
    /// Pulse-width modulation whose duty cycle a PID controller sets.
    Pid(Pid<S>),
}

/// What a regulator remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RegulatorMemory<R = f64> {
    /// The last request of the relay.
    Relay(Request),
    /// Integral and derivative.
    Pid(PidMemory<R>),
}

impl<S: Scalar> Regulator<S> {
    /// Converts the regulator for an error of `quantity` to another scalar type; `function` receives each number with
    /// its parameter.
    pub fn map<T: Scalar>(&self, quantity: Quantity, function: impl FnMut(&'static Parameter, S) -> T) -> Regulator<T> {
        match self {
            Self::Relay(relay) => Regulator::Relay(relay.map(quantity, function)),
            Self::Pid(pid) => Regulator::Pid(pid.map(quantity, function)),
        }
    }

    /// The memory before the first sample.
    pub fn begin(&self) -> RegulatorMemory<S> {
        match self {
            Self::Relay(relay) => RegulatorMemory::Relay(relay.begin()),
            Self::Pid(pid) => RegulatorMemory::Pid(pid.begin()),
        }
    }
}

impl<R: Real> Regulator<R> {
    /// What the valve is to do at `time` in s, when `measured` is to become `target` and more air makes more of it exactly
    /// if `rises`. A memory of another regulator is reset.
    pub fn regulate(
        &self,
        time: R,
        [target, measured]: [R; 2],
        rises: bool,
        memory: &mut RegulatorMemory<R>,
    ) -> Drive<R> {
        let [target, measured] = if rises { [target, measured] } else { [-target, -measured] };
        match self {
            Self::Relay(relay) => {
                let before = if let RegulatorMemory::Relay(before) = memory { *before } else { relay.begin() };
                let request = relay.decide(target - measured, before);
                *memory = RegulatorMemory::Relay(request);
                Drive::Steady(request)
            }
            Self::Pid(pid) => {
                let mut own = if let RegulatorMemory::Pid(own) = memory { *own } else { pid.begin() };
                let output = pid.act(time, target, measured, &mut own);
                *memory = RegulatorMemory::Pid(own);
                pid.drive(output)
            }
        }
    }
}

/// Keeps a quantity of one actuator at its set point.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracker<S = f64> {
    quantity: Quantity,
    set_point: SetPoint<S>,
    regulator: Regulator<S>,
}

impl<S: Scalar> Tracker<S> {
    /// Keeps pressure, length, air mass or tension at a set point.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a quantity that one actuator does not have.
    pub fn new(quantity: Quantity, set_point: SetPoint<S>, regulator: Regulator<S>) -> Result<Self, Error> {
        match quantity {
            Quantity::Pressure | Quantity::Length | Quantity::AirMass | Quantity::Force => {
                Ok(Self { quantity, set_point, regulator })
            }
            Quantity::Angle | Quantity::Torque | Quantity::Stiffness => Err(Error::Misuse {
                what: "one actuator alone has no joint angle, torque or stiffness to control",
                remedy: "control its pressure, length, air mass or tension, or give a joint",
            }),
        }
    }

    /// Converts the tracker to another scalar type; `function` receives each number with its parameter.
    pub fn map<T: Scalar>(&self, mut function: impl FnMut(&'static Parameter, S) -> T) -> Tracker<T> {
        Tracker {
            quantity: self.quantity,
            set_point: self.set_point.map(self.quantity, &mut function),
            regulator: self.regulator.map(self.quantity, &mut function),
        }
    }
}

impl<R: Real> Controller<R> for Tracker<R> {
    type Memory = RegulatorMemory<R>;

    fn begin(&self) -> RegulatorMemory<R> {
        self.regulator.begin()
    }

    fn decide(&self, seen: &Measurement<R>, memory: &mut RegulatorMemory<R>) -> Drive<R> {
        let target = self.set_point.at(seen.time);
        let measured = self.quantity.of(seen).unwrap_or(target);
        self.regulator.regulate(seen.time, [target, measured], self.quantity.rises(), memory)
    }

    fn aim(&self, seen: &Measurement<R>) -> Option<(Quantity, R)> {
        Some((self.quantity, self.set_point.at(seen.time)))
    }
}

/// Keeps a joint at an angle: the agonist does what the regulator says, the antagonist the opposite.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTracker<S = f64> {
    /// The angle in rad over time.
    pub angle: SetPoint<S>,
    /// From the error of the angle to what the agonist's valve is to do.
    pub regulator: Regulator<S>,
}

impl<R: Real> JointController<R> for JointTracker<R> {
    type Memory = RegulatorMemory<R>;

    fn begin(&self) -> RegulatorMemory<R> {
        self.regulator.begin()
    }

    fn decide(&self, seen: &JointMeasurement<R>, memory: &mut RegulatorMemory<R>) -> [Drive<R>; 2] {
        let angles = [self.angle.at(seen.time), seen.angle];
        let drive = self.regulator.regulate(seen.time, angles, Quantity::Angle.rises(), memory);
        [drive, drive.mirrored()]
    }

    fn aim(&self, seen: &JointMeasurement<R>) -> [Option<(Quantity, R)>; 2] {
        [Some((Quantity::Angle, self.angle.at(seen.time))), None]
    }
}
