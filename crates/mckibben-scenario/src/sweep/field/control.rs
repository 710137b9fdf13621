//! Where the quantities of a controller stand in the plain scenario.

use super::Field;
use crate::scenario::{Aim, Command, Controller, Regulator, Scenario};
use mckibben::control::{Quantity, SetPoint};
use mckibben::parameter as p;

/// The key of each and its place; of some keys the unit is that of what is regulated.
static FIELDS: &[(&str, Field)] = &[
    (p::SET_GAUGE_PRESSURE.key, |s| level(s, Quantity::Pressure)),
    (p::SET_LENGTH.key, |s| level(s, Quantity::Length)),
    (p::SET_AIR_MASS.key, |s| level(s, Quantity::AirMass)),
    (p::SET_FORCE.key, |s| level(s, Quantity::Force)),
    (p::SET_ANGLE.key, |s| level(s, Quantity::Angle)),
    (p::SET_STIFFNESS.key, |s| level(s, Quantity::Stiffness)),
    ("controller.amplitude", |s| wave(s).map(|[amplitude, ..]| amplitude)),
    (p::SET_FREQUENCY.key, |s| wave(s).map(|[_, frequency, _]| frequency)),
    (p::SET_PHASE.key, |s| wave(s).map(|[.., phase]| phase)),
    (p::CONTROL_RATE.key, |s| Some(&mut controller(s)?.rate)),
    (p::PULSE_FREQUENCY.key, |s| controller(s)?.pulse_frequency.as_mut()),
    ("controller.resolution", |s| Some(&mut controller(s)?.resolution)),
    ("controller.dead_band", |s| match &mut controller(s)?.regulator {
        Regulator::Relay { dead_band, .. } => Some(dead_band),
        Regulator::Pid { .. } => None,
    }),
    ("controller.hysteresis", |s| match &mut controller(s)?.regulator {
        Regulator::Relay { hysteresis, .. } => Some(hysteresis),
        Regulator::Pid { .. } => None,
    }),
    ("controller.proportional_band", |s| match &mut controller(s)?.regulator {
        Regulator::Pid { proportional_band, .. } => Some(proportional_band),
        Regulator::Relay { .. } => None,
    }),
    (p::INTEGRAL_TIME.key, |s| match &mut controller(s)?.regulator {
        Regulator::Pid { integral_time, .. } => integral_time.as_mut(),
        Regulator::Relay { .. } => None,
    }),
    (p::DERIVATIVE_TIME.key, |s| match &mut controller(s)?.regulator {
        Regulator::Pid { derivative_time, .. } => Some(derivative_time),
        Regulator::Relay { .. } => None,
    }),
    (p::DERIVATIVE_FILTER.key, |s| match &mut controller(s)?.regulator {
        Regulator::Pid { derivative_filter, .. } => Some(derivative_filter),
        Regulator::Relay { .. } => None,
    }),
    (p::SET_POINT_WEIGHT.key, |s| match &mut controller(s)?.regulator {
        Regulator::Pid { set_point_weight, .. } => Some(set_point_weight),
        Regulator::Relay { .. } => None,
    }),
    (p::TRACKING_TIME.key, |s| match &mut controller(s)?.regulator {
        Regulator::Pid { tracking_time, .. } => tracking_time.as_mut(),
        Regulator::Relay { .. } => None,
    }),
    (p::BIAS.key, |s| match &mut controller(s)?.regulator {
        Regulator::Pid { bias, .. } => Some(bias),
        Regulator::Relay { .. } => None,
    }),
    (p::HIGHEST_GAUGE_PRESSURE.key, |s| match &mut controller(s)?.aim {
        Aim::Model { highest_gauge_pressure, .. } | Aim::Joint { highest_gauge_pressure, .. } => {
            Some(highest_gauge_pressure)
        }
        Aim::Track { .. } => None,
    }),
    (p::CONTROL_TEMPERATURE.key, |s| match &mut controller(s)?.aim {
        Aim::Model { temperature, .. } | Aim::Joint { temperature, .. } => temperature.as_mut(),
        Aim::Track { .. } => None,
    }),
];

/// The place of the quantity with a key.
pub(super) fn field_of(key: &str) -> Option<Field> {
    FIELDS.iter().find(|(of, _)| *of == key).map(|(_, field)| *field)
}

fn controller(s: &mut Scenario) -> Option<&mut Controller> {
    match s.command.as_mut()? {
        Command::Controller(controller) => Some(controller),
        _ => None,
    }
}

fn set_point(s: &mut Scenario, of: Quantity) -> Option<&mut SetPoint> {
    match (&mut controller(s)?.aim, of) {
        (Aim::Track { quantity, set_point }, _) if *quantity == of => Some(set_point),
        (Aim::Model { force, .. }, Quantity::Force) => Some(force),
        (Aim::Model { length, .. }, Quantity::Length) => length.as_mut(),
        (Aim::Joint { angle, .. }, Quantity::Angle) => Some(angle),
        (Aim::Joint { stiffness, .. }, Quantity::Stiffness) => Some(stiffness),
        _ => None,
    }
}

/// The value of a constant set point, or the mean of a sinusoid.
fn level(s: &mut Scenario, of: Quantity) -> Option<&mut f64> {
    match set_point(s, of)? {
        SetPoint::Constant(value) | SetPoint::Sinusoid { mean: value, .. } => Some(value),
        _ => None,
    }
}

/// Amplitude, frequency and phase of a set point that is a sinusoid.
fn wave(s: &mut Scenario) -> Option<[&mut f64; 3]> {
    match &mut controller(s)?.aim {
        Aim::Track { set_point: SetPoint::Sinusoid { amplitude, frequency, phase, .. }, .. } => {
            Some([amplitude, frequency, phase])
        }
        _ => None,
    }
}
