//! What is known at an instant, whichever engine computed it.

use crate::air::Flow;
use crate::pressure::AbsolutePressure;
use crate::scalar::Scalar;
use crate::valve::Ports;

/// Everything that is known at an instant: the columns of a result file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<R = f64> {
    /// Time in s.
    pub time: R,
    /// Distance between the attachments in m.
    pub length: R,
    /// Its rate in m/s.
    pub velocity: R,
    /// Absolute pressure.
    pub pressure: AbsolutePressure<R>,
    /// Mass of the air in kg.
    pub air_mass: R,
    /// Temperature of the air in K.
    pub temperature: R,
    /// Volume of the air, braid and hose, in m³.
    pub volume: R,
    /// Tension in N.
    pub tension: R,
    /// Net mass flow into the actuator in kg/s.
    pub mass_flow: R,
    /// Which passages of the valve are open.
    pub ports: Ports,
}

impl<R: Scalar> Sample<R> {
    /// The sample of four states with what has been computed from them.
    pub(super) fn new(
        time: R,
        &[length, velocity, pressure, air_mass]: &[R; 4],
        tension: R,
        volume: R,
        temperature: R,
        flow: &Flow<R>,
        ports: Ports,
    ) -> Self {
        let tension = tension.larger(R::zero());
        let (pressure, mass_flow) = (AbsolutePressure(pressure), flow.net());
        Self { time, length, velocity, pressure, air_mass, temperature, volume, tension, mass_flow, ports }
    }
}
