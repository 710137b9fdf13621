//! The requested operating point.

use super::{Measure, Request};
use crate::failure::Failure;
use crate::quantities::given;
use mckibben::linearize::{Aim, Balance, Content, Linearization, linearize, linearize_driven};
use mckibben::load::Load;
use mckibben::simulation::Rig;
use mckibben::{Error, GaugePressure, parameter};
use mckibben_scenario::Experiment;

/// The requested linear model.
pub(super) fn linearization(request: &Request, experiment: &Experiment) -> Result<Linearization, Failure> {
    let rig = match request.load {
        Some(load) => loaded(&experiment.rig, load)?,
        None => experiment.rig.clone(),
    };
    let content = match request.temperature {
        Some(kelvin) => Content::Temperature(kelvin),
        None => Content::Of(experiment.start),
    };
    let is_held = matches!(rig.load(), Load::Isometric);
    let length = request.length.or(is_held.then_some(experiment.start.length));
    if request.load.is_some() && length.is_some() && (request.gauge_pressure.is_some() || request.duty.is_some()) {
        return Err(Failure::input(
            "pressure, length and load cannot all be given: two of them give the third",
            "leave out one of `length`, `load`, and `gauge_pressure` or `duty`",
        ));
    }
    let atmosphere = rig.actuator().air().atmosphere();
    let initial = experiment.start.pressure.gauge(atmosphere);
    let pressure = request.gauge_pressure.map(GaugePressure);
    let balance = match (pressure, length) {
        (Some(gauge), Some(length)) => Balance::AtBoth(gauge, length),
        (None, Some(length)) if is_held => Balance::AtBoth(initial, length),
        (None, Some(length)) => Balance::AtLength(length),
        (gauge, None) => Balance::AtPressure(gauge.unwrap_or(initial)),
    };
    // A command that a linear model has as an input gives the pressure, unless that or the length is given.
    let own = rig.actuation().is_some_and(|actuation| actuation.command.is_continuous());
    let found = match (request.duty, length) {
        _ if request.pwm => linearize_driven(&rig, Aim::Balance(balance), content),
        (Some(duty), Some(length)) => linearize_driven(&rig, Aim::DutyAtLength(duty, length), content),
        (Some(duty), None) => linearize_driven(&rig, Aim::Duty(duty), content),
        (None, _) if !own || pressure.is_some() || request.length.is_some() => linearize(&rig, balance, content),
        (None, Some(length)) => linearize_driven(&rig, Aim::CommandAtLength(length), content),
        (None, None) => linearize_driven(&rig, Aim::Command, content),
    };
    found.map_err(|error| match error {
        // The length of a start has no part in a point, which is in balance.
        Error::NoSolution { what, remedy } if remedy.contains(parameter::INITIAL_LENGTH.key) => Failure::input(
            what,
            "give a load that pulls, such as load.force = \"5 N\", or `length` with `gauge_pressure`, which give the \
             load",
        ),
        error => of_request(request, error),
    })
}

/// An error of the core, in which a requested length has the name of the request: the core calls it after the key of a start.
fn of_request(request: &Request, error: Error) -> Failure {
    match (request.length, error) {
        (Some(length), Error::Inconsistent { parameter, requirement, remedy, .. })
            if parameter.key == parameter::INITIAL_LENGTH.key =>
        {
            Failure::input(format!("`length` = {} contradicts {requirement}", given(length, "m")), remedy)
        }
        (Some(length), Error::OutOfRange { parameter, .. }) if parameter.key == parameter::INITIAL_LENGTH.key => {
            let title = format!("`length` = {} is outside its range ({})", given(length, "m"), parameter.range);
            Failure::input(title, parameter.remedy)
        }
        (_, error) => error.into(),
    }
}

/// The rig with another load of its kind.
fn loaded(rig: &Rig, load: Measure) -> Result<Rig, Failure> {
    let changed = match (rig.load(), load) {
        // The mass that follows has another name and value than what was requested.
        (Load::HangingMass { .. }, Measure::Force(force)) if force.is_finite() && force <= 0.0 => {
            let title = format!("`load` = {} is outside its range (greater than 0): the load hangs", given(force, "N"));
            return Err(Failure::input(title, "give a force above zero, or a mass such as \"2 kg\""));
        }
        (Load::HangingMass { gravity, .. }, Measure::Mass(mass)) => Load::hanging_mass(mass, *gravity)?,
        (Load::HangingMass { gravity, .. }, Measure::Force(force)) => Load::hanging_mass(force / gravity, *gravity)?,
        (Load::ConstantForce { mass, .. }, Measure::Force(force)) => Load::constant_force(*mass, force)?,
        (Load::ConstantForce { .. }, Measure::Mass(_)) => {
            return Err(Failure::input(
                "the scenario's load is a constant force, and `load` is a mass",
                "give a force, such as 40 N, or set load.mass in the scenario",
            ));
        }
        (Load::Isometric | Load::Prescribed(_), _) => {
            return Err(Failure::input(
                "the scenario's ends are held or moved, whatever `load` is",
                "leave `load` out, or set load.kind to \"hanging-mass\" or \"constant-force\"",
            ));
        }
    };
    Ok(rig.clone().with_load(changed))
}
