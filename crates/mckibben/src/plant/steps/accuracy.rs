//! How far fixed steps lie from the event-located engine, and the step that an accuracy needs.
//!
//! Both engines start from the same state. At every recorded sample the states of mechanisms, actuators and nodes are compared,
//! and each has its error
//!
//! ```text
//! e = max |y − y*| / max(y*_max − y*_min, Y/1000)
//! ```
//!
//! | symbol | what |
//! |---|---|
//! | y, y* | a state by the fixed-step engine, and by the event-located one |
//! | y*_max − y*_min | the range that the state covers over the time compared |
//! | Y | its usual size, by which the event-located engine scales its own errors |
//!
//! The error of a run is the largest of all. A step is chosen by trying, as of one actuator: see
//! [`simulation::accuracy`](crate::simulation::accuracy).
//!
//! Checked by `tests/plant_steps.rs`.

use super::super::Plant;
use super::super::run::PlantRun;
use super::super::start::PlantStart;
use super::TimeStepping;
use crate::command::Driver;
use crate::error::Error;
use crate::parameter;
use crate::simulation::accuracy::{LEAST_RANGE, PILOT, REFERENCE, longest_step};
use crate::simulation::{Method, SampleTimes, steps_between};
use alloc::vec::Vec;

/// The step of a plant, and its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantStepError {
    /// The step in s: no step was longer.
    pub step: f64,
    /// The time in s from the start over which the engines were compared.
    pub compared: f64,
    /// The largest difference of a state from the event-located engine's, as a share of the range that the state covers.
    pub greatest: f64,
}

/// The longest step with which a plant that is recorded every `interval` s has an error of at most `accuracy` over its first
/// [`PILOT`] seconds, with the error that was measured. The steps divide the interval. `drivers` makes its drivers anew.
///
/// # Errors
/// [`Error::OutOfRange`] for an accuracy or interval outside its range; as [`PlantRun::with_drivers`] and
/// [`PlantRun::advance_to`]; [`Error::Inconsistent`] when even the shortest step is not accurate enough.
pub fn plant_step_for_accuracy(
    (plant, start): (&Plant, &PlantStart),
    drivers: &dyn Fn() -> Vec<Driver>,
    (duration, interval): (f64, f64),
    method: Method,
    accuracy: f64,
) -> Result<PlantStepError, Error> {
    parameter::ACCURACY.check(accuracy)?;
    parameter::SAMPLE_INTERVAL.check(interval)?;
    let (part, tightest, loosest) = REFERENCE;
    let (compared, tolerance) = (duration.min(PILOT), (part * accuracy).clamp(tightest, loosest));
    let times = SampleTimes::new(compared, interval);
    let mut reference = PlantRun::with_drivers(plant, start, tolerance, drivers())?;
    let usual = reference.scales();
    let mut expected = Vec::new();
    for time in times.times() {
        reference.advance_to(time)?;
        expected.push(reference.state().to_vec());
    }
    let size = |place: usize| {
        let values = expected.iter().map(|state| state[place]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        (place, (high - low).max(LEAST_RANGE * usual[place]))
    };
    let compare: Vec<(usize, f64)> = plant.places().compared().map(size).collect();
    let error_of = |step: f64, allowed: f64| {
        let step = interval / steps_between(0.0, interval, step) as f64;
        let mut run = PlantRun::with_drivers(plant, start, TimeStepping::Fixed { method, step }, drivers())?;
        let mut greatest = 0.0_f64;
        for (time, expected) in times.times().zip(&expected) {
            run.advance_to(time)?;
            let errors = compare.iter().map(|(place, size)| (run.state()[*place] - expected[*place]).abs() / size);
            greatest = errors.fold(greatest, f64::max);
            if greatest > allowed {
                break;
            }
        }
        Ok(PlantStepError { step, compared, greatest })
    };
    longest_step(accuracy, interval, |error: &PlantStepError| error.greatest, error_of)
}
