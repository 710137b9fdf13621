//! The quantities of the command line, and the operating point that they ask for.

use super::LinearizeArguments;
use crate::failure::Failure;
use mckibben::GaugePressure;
use mckibben::linearize::{Aim, Balance, Content, Linearization, linearize, linearize_driven};
use mckibben::load::Load;
use mckibben::simulation::Rig;
use mckibben_scenario::{Experiment, quantity};

/// A load as it can be given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Mass in kg.
    Mass(f64),
    /// Force in N.
    Force(f64),
}

/// A quantity in the SI unit that it must have the dimension of.
fn measured(text: &str, what: &str, unit: &str, example: &str) -> Result<f64, String> {
    let read = quantity::parse(text).map_err(|error| error.to_string())?;
    let (dimension, _) = quantity::parse_unit(unit).map_err(|error| error.to_string())?;
    if read.has_unit && read.dimension == dimension {
        return Ok(read.value);
    }
    Err(format!("`{text}` is no {what}; write a number with its unit, as in \"{example}\""))
}

pub(super) fn pressure(text: &str) -> Result<f64, String> {
    measured(text, "pressure", "Pa", "60 psi")
}

pub(super) fn length(text: &str) -> Result<f64, String> {
    measured(text, "length", "m", "85 mm")
}

pub(super) fn angle(text: &str) -> Result<f64, String> {
    measured(text, "angle", "rad", "20 deg")
}

pub(super) fn stiffness(text: &str) -> Result<f64, String> {
    measured(text, "stiffness of a joint", "N*m/rad", "2 N*m/rad")
}

pub(super) fn temperature(text: &str) -> Result<f64, String> {
    measured(text, "temperature", "K", "293 K")
}

pub(super) fn load(text: &str) -> Result<Measure, String> {
    let force = measured(text, "mass or force", "N", "10 lb\" or \"40 N").map(Measure::Force);
    force.or_else(|fault| measured(text, "mass", "kg", "10 lb").map(Measure::Mass).map_err(|_| fault))
}

/// The linear model that the arguments ask for.
pub(super) fn linearization(arguments: &LinearizeArguments, experiment: &Experiment) -> Result<Linearization, Failure> {
    let rig = match arguments.load {
        Some(load) => loaded(&experiment.rig, load)?,
        None => experiment.rig.clone(),
    };
    let content = match arguments.temperature {
        Some(kelvin) => Content::Temperature(kelvin),
        None => Content::Of(experiment.start),
    };
    let is_held = matches!(rig.load(), Load::Isometric);
    let length = arguments.length.or(is_held.then_some(experiment.start.length));
    if arguments.load.is_some() && length.is_some() && (arguments.pressure.is_some() || arguments.duty.is_some()) {
        return Err(Failure::input(
            "pressure, length and load cannot all be given: two of them give the third",
            "leave out one of --length, --load, and --pressure or --duty",
        ));
    }
    let atmosphere = rig.actuator().air().atmosphere();
    let initial = experiment.start.pressure.gauge(atmosphere);
    let pressure = arguments.pressure.map(GaugePressure);
    let balance = match (pressure, length) {
        (Some(gauge), Some(length)) => Balance::AtBoth(gauge, length),
        (None, Some(length)) if is_held => Balance::AtBoth(initial, length),
        (None, Some(length)) => Balance::AtLength(length),
        (gauge, None) => Balance::AtPressure(gauge.unwrap_or(initial)),
    };
    // A command that a linear model has as an input gives the pressure, unless that or the length is given.
    let own = rig.actuation().is_some_and(|actuation| actuation.command.is_continuous());
    Ok(match (arguments.duty, length) {
        _ if arguments.pwm => linearize_driven(&rig, Aim::Balance(balance), content)?,
        (Some(duty), Some(length)) => linearize_driven(&rig, Aim::DutyAtLength(duty, length), content)?,
        (Some(duty), None) => linearize_driven(&rig, Aim::Duty(duty), content)?,
        (None, _) if !own || pressure.is_some() || arguments.length.is_some() => linearize(&rig, balance, content)?,
        (None, Some(length)) => linearize_driven(&rig, Aim::CommandAtLength(length), content)?,
        (None, None) => linearize_driven(&rig, Aim::Command, content)?,
    })
}

/// The rig with another load of its kind.
fn loaded(rig: &Rig, load: Measure) -> Result<Rig, Failure> {
    let changed = match (rig.load(), load) {
        (Load::HangingMass { gravity, .. }, Measure::Mass(mass)) => Load::hanging_mass(mass, *gravity)?,
        (Load::HangingMass { gravity, .. }, Measure::Force(force)) => Load::hanging_mass(force / gravity, *gravity)?,
        (Load::ConstantForce { mass, .. }, Measure::Force(force)) => Load::constant_force(*mass, force)?,
        (Load::ConstantForce { .. }, Measure::Mass(_)) => {
            return Err(Failure::input(
                "--load: the scenario's load is a constant force, and a mass was given",
                "give a force, as in --load '40 N', or set load.mass with --set",
            ));
        }
        (Load::Isometric | Load::Prescribed(_), _) => {
            return Err(Failure::input(
                "--load: the scenario's ends are held or moved, whatever the load",
                "leave --load out, or set load.kind to \"hanging-mass\" or \"constant-force\"",
            ));
        }
    };
    Ok(rig.clone().with_load(changed))
}
