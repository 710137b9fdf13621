//! Sensors: what of a quantity arrives at the controller.
//!
//! ```text
//! y = min(y_max, max(y_min, q ⌊x/q + ½⌋))
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | q | `step`; zero for a perfect sensor | the quantity's |
//! | y_min, y_max | `range` | the quantity's |
//!
//! The step is that of an analogue-to-digital converter or of an encoder; the error is at most `q/2` inside the range. What
//! has been rounded or cut off no longer depends on the quantity: its derivative is zero.

use super::{JointMeasurement, Measurement, Quantity};
use crate::error::{Error, Requirement};
use crate::pressure::GaugePressure;
use crate::scalar::{Real, Scalar};

/// A sensor of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor<S = f64> {
    step: S,
    range: Option<(S, S)>,
}

impl Sensor {
    /// A sensor that reports whole multiples of `step` (zero for any value) inside `range`, in the unit of its
    /// quantity.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a step that is negative or a number that is not finite; [`Error::Inconsistent`] when the
    /// range does not rise.
    pub fn new(quantity: Quantity, step: f64, range: Option<(f64, f64)>) -> Result<Self, Error> {
        let rows = quantity.rows();
        rows.resolution.check(step)?;
        if let Some((low, high)) = range {
            rows.range.check(low)?;
            rows.range.check(high)?;
            if low >= high {
                return Err(Error::Inconsistent {
                    parameter: &rows.range,
                    value: low,
                    requirement: Requirement {
                        relation: "must be less than",
                        other: "the upper end",
                        value: high,
                        unit: rows.range.unit,
                    },
                    remedy: rows.range.remedy,
                });
            }
        }
        Ok(Self { step, range })
    }
}

impl<S: Scalar> Sensor<S> {
    /// A sensor that reports every value unchanged.
    pub fn perfect() -> Self {
        Self { step: S::zero(), range: None }
    }

    /// Converts the sensor to another scalar type.
    pub fn map<T: Scalar>(&self, mut function: impl FnMut(S) -> T) -> Sensor<T> {
        Sensor { step: function(self.step), range: self.range.map(|(low, high)| (function(low), function(high))) }
    }
}

impl<R: Real> Sensor<R> {
    /// The sensor's reading of a value.
    pub fn show(&self, value: R) -> R {
        let step = self.step.value();
        let shown = if step > 0.0 { self.step * R::constant(nearest_whole(value.value() / step)) } else { value };
        match self.range {
            Some((low, high)) => shown.larger(low).smaller(high),
            None => shown,
        }
    }
}

/// The whole number nearest to a number, halves upwards.
fn nearest_whole(number: f64) -> f64 {
    // From 2⁵² on every number is whole.
    if number.is_nan() || number.abs() >= 4_503_599_627_370_496.0 {
        return number;
    }
    let towards_zero = number as i64 as f64;
    let below = if towards_zero > number { towards_zero - 1.0 } else { towards_zero };
    if number - below >= 0.5 { below + 1.0 } else { below }
}

/// The sensors of one actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors<S = f64> {
    /// Of the distance between the attachments, in m.
    pub length: Sensor<S>,
    /// Of its rate, in m/s.
    pub velocity: Sensor<S>,
    /// Of the gauge pressure, in Pa.
    pub pressure: Sensor<S>,
    /// Of the air mass, in kg.
    pub air_mass: Sensor<S>,
    /// Of the tension, in N.
    pub tension: Sensor<S>,
}

impl<S: Scalar> Sensors<S> {
    /// Sensors that show everything as it is.
    pub fn perfect() -> Self {
        let [length, velocity, pressure, air_mass, tension] = [Sensor::perfect(); 5];
        Self { length, velocity, pressure, air_mass, tension }
    }
}

impl<R: Real> Sensors<R> {
    /// What the sensors show of the truth.
    pub fn show(&self, truth: &Measurement<R>) -> Measurement<R> {
        Measurement {
            time: truth.time,
            length: self.length.show(truth.length),
            velocity: self.velocity.show(truth.velocity),
            pressure: GaugePressure(self.pressure.show(truth.pressure.0)),
            air_mass: self.air_mass.show(truth.air_mass),
            tension: self.tension.show(truth.tension),
        }
    }
}

/// The sensors of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSensors<S = f64> {
    /// Of the angle, in rad.
    pub angle: Sensor<S>,
    /// Of the angular velocity, in rad/s.
    pub angular_velocity: Sensor<S>,
    /// Of agonist and antagonist.
    pub actuators: [Sensors<S>; 2],
}

impl<S: Scalar> JointSensors<S> {
    /// Sensors that show everything as it is.
    pub fn perfect() -> Self {
        Self { angle: Sensor::perfect(), angular_velocity: Sensor::perfect(), actuators: [Sensors::perfect(); 2] }
    }
}

impl<R: Real> JointSensors<R> {
    /// What the sensors show of the truth.
    pub fn show(&self, truth: &JointMeasurement<R>) -> JointMeasurement<R> {
        JointMeasurement {
            time: truth.time,
            angle: self.angle.show(truth.angle),
            angular_velocity: self.angular_velocity.show(truth.angular_velocity),
            actuators: [0, 1].map(|i| self.actuators[i].show(&truth.actuators[i])),
        }
    }
}
