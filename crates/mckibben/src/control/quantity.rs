//! What can be controlled, and the rows of the parameters that have its unit.

use super::{JointMeasurement, Measurement};
use crate::parameter::{self, Parameter, Range};

/// A quantity with a set point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Gauge pressure of the actuator's air, in Pa.
    Pressure,
    /// Distance between the attachments, in m.
    Length,
    /// Mass of the actuator's air, in kg.
    AirMass,
    /// Tension of the actuator, in N.
    Force,
    /// Angle of a joint, in rad.
    Angle,
    /// Torque of both actuators on a joint, in N·m.
    Torque,
    /// Stiffness that both actuators give a joint, in N·m/rad.
    Stiffness,
}

/// The rows of the parameters that have a quantity's unit.
#[derive(Debug)]
pub struct Rows {
    /// The set point.
    pub set_point: &'static Parameter,
    /// Amplitude of a sinusoidal set point.
    pub amplitude: Parameter,
    /// Error within which a relay does nothing.
    pub dead_band: Parameter,
    /// By how much the error must come back before a relay lets go.
    pub hysteresis: Parameter,
    /// Error at which the proportional action alone is the full output.
    pub proportional_band: Parameter,
    /// Step between two values that the sensor can show.
    pub resolution: Parameter,
    /// Lowest and highest value that the sensor can show.
    pub range: Parameter,
}

const fn rows(set_point: &'static Parameter) -> Rows {
    const fn row(
        [key, symbol, meaning, remedy]: [&'static str; 4],
        unit: &'static str,
        range: Range,
        default: Option<f64>,
    ) -> Parameter {
        Parameter { key, symbol, unit, range, default, meaning, source: "choice of the experiment", remedy }
    }
    let unit = set_point.unit;
    Rows {
        set_point,
        amplitude: row(
            ["controller.amplitude", "A_set", "Amplitude of a sinusoidal set point.", "give zero or more"],
            unit,
            Range::NON_NEGATIVE,
            None,
        ),
        dead_band: row(
            [
                "controller.dead_band",
                "delta",
                "Error, either way, within which a bang-bang controller requests nothing.",
                "give a band above what one sample at full flow moves",
            ],
            unit,
            Range::NON_NEGATIVE,
            None,
        ),
        hysteresis: row(
            [
                "controller.hysteresis",
                "h",
                "Part of the dead band that the error must come back before a bang-bang controller lets go.",
                "give zero or more, and at most the dead band",
            ],
            unit,
            Range::NON_NEGATIVE,
            Some(0.0),
        ),
        proportional_band: row(
            [
                "controller.proportional_band",
                "B",
                "Error at which the proportional action alone gives the full output; the gain is 1/B.",
                "give a band above zero",
            ],
            unit,
            Range::POSITIVE,
            None,
        ),
        resolution: row(
            [
                "controller.resolution",
                "q",
                "Step between two values that the sensor can show; zero for a perfect sensor.",
                "give zero or more",
            ],
            unit,
            Range::NON_NEGATIVE,
            Some(0.0),
        ),
        range: row(
            [
                "controller.sensor_range",
                "y_min, y_max",
                "Lowest and highest value that the sensor can show.",
                "give the lower end first",
            ],
            unit,
            Range::FINITE,
            None,
        ),
    }
}

static PRESSURE: Rows = rows(&parameter::SET_GAUGE_PRESSURE);
static LENGTH: Rows = rows(&parameter::SET_LENGTH);
static AIR_MASS: Rows = rows(&parameter::SET_AIR_MASS);
static FORCE: Rows = rows(&parameter::SET_FORCE);
static ANGLE: Rows = rows(&parameter::SET_ANGLE);
static TORQUE: Rows = rows(&parameter::SET_TORQUE);
static STIFFNESS: Rows = rows(&parameter::SET_STIFFNESS);

impl Quantity {
    /// Every quantity.
    pub const ALL: [Self; 7] =
        [Self::Pressure, Self::Length, Self::AirMass, Self::Force, Self::Angle, Self::Torque, Self::Stiffness];

    /// The rows of the parameters that have its unit.
    pub fn rows(self) -> &'static Rows {
        match self {
            Self::Pressure => &PRESSURE,
            Self::Length => &LENGTH,
            Self::AirMass => &AIR_MASS,
            Self::Force => &FORCE,
            Self::Angle => &ANGLE,
            Self::Torque => &TORQUE,
            Self::Stiffness => &STIFFNESS,
        }
    }

    /// Name in results, such as `gauge_pressure` or `force`: that of its key in `[controller]`.
    pub fn name(self) -> &'static str {
        let key = self.rows().set_point.key;
        key.rsplit_once('.').map_or(key, |(_, name)| name)
    }

    /// Whether more air makes more of it; for an angle, more air in the agonist.
    pub fn rises(self) -> bool {
        self != Self::Length
    }

    /// Its value in a measurement of a joint; `None` for a quantity of each actuator, or one that is not measured.
    pub fn of_joint<R: Copy>(self, seen: &JointMeasurement<R>) -> Option<R> {
        (self == Self::Angle).then_some(seen.angle)
    }

    /// Its value in a measurement of one actuator; `None` for what only a joint has.
    pub fn of<R: Copy>(self, seen: &Measurement<R>) -> Option<R> {
        match self {
            Self::Pressure => Some(seen.pressure.0),
            Self::Length => Some(seen.length),
            Self::AirMass => Some(seen.air_mass),
            Self::Force => Some(seen.tension),
            Self::Angle | Self::Torque | Self::Stiffness => None,
        }
    }
}
