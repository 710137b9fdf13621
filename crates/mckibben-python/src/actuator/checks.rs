//! What a step of an actuator is refused for, in the words of its arguments.

use crate::arguments;
use mckibben::parameter;
use mckibben::plant::PlantSteps;
use mckibben::simulation::MOST_PARTS;
use mckibben_run::failure::Failure;

/// Rates of change of a length in m/s beyond which nothing is believed.
const SWIFTEST: f64 = 1e6;

/// Refuses a distance between the ends that is none; one that the actuator cannot be stretched to stops it.
pub(crate) fn check_length(of: &PlantSteps, name: &str, length: f64) -> Result<(), Failure> {
    reach(of.plant().end_distance(0)?, name, length)
}

/// Refuses a distance between the ends that is none, and one from the named limit on.
pub(crate) fn reach(limit: Option<(&'static str, f64)>, name: &str, length: f64) -> Result<(), Failure> {
    arguments::number(name, length, "m", "a distance between the ends in m above zero", length > 0.0)?;
    let Some((limit, end)) = limit.filter(|(_, end)| length >= *end) else { return Ok(()) };
    let limit = if limit == parameter::THREAD_LENGTH.key { "its thread" } else { limit };
    let longer = format!("{name} = {length:?} m is longer than {limit} of {:.1} mm", 1e3 * end);
    Err(Failure::stopped(format!("{longer}: keep the ends closer together")))
}

/// Refuses a duration that no step can have.
pub(crate) fn check_dt(dt: f64) -> Result<(), Failure> {
    let title = format!("dt = {dt:?} s is no step in time: it must be above zero and finite");
    if dt > 0.0 && dt.is_finite() {
        Ok(())
    } else {
        Err(Failure::input(title, "give a time in s above zero, such as 1e-3"))
    }
}

/// The longest part of a step in s, without end where none is given.
pub(crate) fn longest_part(max_step: Option<f64>) -> Result<f64, Failure> {
    let Some(longest) = max_step else { return Ok(f64::INFINITY) };
    arguments::number(
        "max_step",
        longest,
        "s",
        "a time in s above zero, such as 1e-4, or None for whole steps",
        longest > 0.0,
    )?;
    Ok(longest)
}

/// Refuses more parts than a step may have.
pub(crate) fn check_parts(parts: f64, dt: f64) -> Result<(), Failure> {
    if parts <= MOST_PARTS {
        return Ok(());
    }
    Err(Failure::input(
        format!(
            "dt = {dt:?} s would be divided into {parts:.3e} parts by pulses and max_step, more than {MOST_PARTS:e}"
        ),
        "give a smaller dt, a lower pulse_frequency or a longer max_step",
    ))
}

/// Refuses a velocity of the ends that is none.
pub(crate) fn check_velocity(name: &str, velocity: f64) -> Result<(), Failure> {
    let is_in = velocity.abs() <= SWIFTEST;
    arguments::number(name, velocity, "m/s", "a velocity in m/s between -1e6 and 1e6", is_in)
}
