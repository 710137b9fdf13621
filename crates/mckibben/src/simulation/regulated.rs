//! What a pressure regulator makes over time by its closed form, for fixed steps.

#[cfg(feature = "alloc")]
use super::joint::{Driven, JointRig};
use super::rig::Rig;
use crate::pressure::AbsolutePressure;
use crate::scalar::Real;
use crate::valve::{Port, RegulatorClock, Valve};

impl<R: Real> Rig<R> {
    /// What a pressure regulator does over time by its closed form, with a pressure in Pa in the actuator at the start.
    pub(crate) fn regulator_clock(&self, pressure: R) -> Option<RegulatorClock<R>> {
        self.regulator().and(self.actuator().valve()).map(|valve| clock(valve, pressure))
    }
}

#[cfg(feature = "alloc")]
impl<R: Real> JointRig<R> {
    /// That of one of the actuators of a joint.
    pub(super) fn regulator_clock(&self, actuator: usize, pressure: R) -> Option<RegulatorClock<R>> {
        let Driven { actuator, actuation } = &self.driven()[actuator];
        actuation.as_ref()?.solenoid.regulator().and(actuator.valve()).map(|valve| clock(valve, pressure))
    }
}

/// A regulator that rests at the pressure in its actuator, between those of its ports.
fn clock<R: Real>(valve: &Valve<R>, pressure: R) -> RegulatorClock<R> {
    let at_rest = pressure.larger(valve.port_pressure(Port::Exhaust)).smaller(valve.port_pressure(Port::Supply));
    RegulatorClock::resting(AbsolutePressure(at_rest), AbsolutePressure(valve.port_pressure(Port::Exhaust)))
}
