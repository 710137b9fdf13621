//! What a driver knows of a plant at a sampling instant, and the sensors that it knows it by.

use crate::control::{JointMeasurement, Measurement, Sensor, Sensors};
use crate::pressure::GaugePressure;
use crate::scalar::Real;
use alloc::vec::Vec;

/// What there is to measure of a plant at a sampling instant.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantMeasurement<R = f64> {
    /// The sampling instant in s.
    pub time: R,
    /// Of each actuator: the distance between its attachments, its rate, gauge pressure, mass of air and tension.
    pub actuators: Vec<Measurement<R>>,
    /// Coordinates of each mechanism, in m or rad.
    pub positions: Vec<Vec<R>>,
    /// Their rates, in m/s or rad/s.
    pub rates: Vec<Vec<R>>,
    /// Gauge pressure of each node of the network.
    pub nodes: Vec<GaugePressure<R>>,
}

impl<R: Real> PlantMeasurement<R> {
    /// What there is to measure of a joint `(mechanism, coordinate)` with its agonist and antagonist, where the plant has
    /// these.
    pub fn of_joint(
        &self,
        (mechanism, coordinate): (usize, usize),
        [agonist, antagonist]: [usize; 2],
    ) -> Option<JointMeasurement<R>> {
        Some(JointMeasurement {
            time: self.time,
            angle: *self.positions.get(mechanism)?.get(coordinate)?,
            angular_velocity: *self.rates.get(mechanism)?.get(coordinate)?,
            actuators: [*self.actuators.get(agonist)?, *self.actuators.get(antagonist)?],
        })
    }
}

/// Sensors of a coordinate of a mechanism and of its rate.
type OfCoordinate<R> = ((usize, usize), [Sensor<R>; 2]);

/// The sensors of a driver; a quantity without a sensor is measured exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantSensors<R = f64> {
    actuators: Vec<(usize, Sensors<R>)>,
    coordinates: Vec<OfCoordinate<R>>,
    nodes: Vec<(usize, Sensor<R>)>,
}

impl<R> PlantSensors<R> {
    /// Sensors that show everything as it is.
    pub fn perfect() -> Self {
        Self { actuators: Vec::new(), coordinates: Vec::new(), nodes: Vec::new() }
    }

    /// These with sensors of an actuator.
    pub fn with_actuator(mut self, actuator: usize, sensors: Sensors<R>) -> Self {
        self.actuators.push((actuator, sensors));
        self
    }

    /// These with sensors of a coordinate and of its rate, by `(mechanism, coordinate)`.
    pub fn with_coordinate(mut self, coordinate: (usize, usize), sensors: [Sensor<R>; 2]) -> Self {
        self.coordinates.push((coordinate, sensors));
        self
    }

    /// These with a sensor of the gauge pressure of a node of the network.
    pub fn with_node(mut self, node: usize, sensor: Sensor<R>) -> Self {
        self.nodes.push((node, sensor));
        self
    }
}

impl<R: Real> PlantSensors<R> {
    /// What the sensors show of the truth; sensors of parts that are not there show nothing.
    pub fn show(&self, mut truth: PlantMeasurement<R>) -> PlantMeasurement<R> {
        for (actuator, sensors) in &self.actuators {
            if let Some(of_actuator) = truth.actuators.get_mut(*actuator) {
                *of_actuator = sensors.show(of_actuator);
            }
        }
        for ((mechanism, coordinate), [position, rate]) in &self.coordinates {
            let of = |list: &mut Vec<Vec<R>>, sensor: &Sensor<R>| {
                if let Some(value) = list.get_mut(*mechanism).and_then(|list| list.get_mut(*coordinate)) {
                    *value = sensor.show(*value);
                }
            };
            of(&mut truth.positions, position);
            of(&mut truth.rates, rate);
        }
        for (node, sensor) in &self.nodes {
            if let Some(gauge) = truth.nodes.get_mut(*node) {
                gauge.0 = sensor.show(gauge.0);
            }
        }
        truth
    }
}
