//! How far fixed steps lie from the event-located engine, and the step that an accuracy needs.
//!
//! Both engines start from the same state. At the end of every step the states of mechanisms, actuators and nodes are compared, and
//! each has its error
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
//! The second term stands in where a state hardly moves; the share of no range would mean nothing. The error of a run is the
//! largest of all.
//!
//! A step is chosen by trying: the recording interval whole, then in 2, 5, 10, 20, 50, … parts, until the error that is
//! measured is at most the accuracy. A step that fails is left at the first state that lies too far off, and so costs little.
//! Only the first [`PILOT`] seconds of a run are compared and no step below [`SHORTEST`] is tried: the cost is bounded, and what
//! happens later in the run is not seen.
//!
//! Checked by `tests/accuracy.rs` and `tests/plant_steps.rs`; the figures for the examples are in `docs/accuracy.md`.

use super::super::Plant;
use super::super::evaluation::{Evaluation, System};
use super::super::run::PlantRun;
use super::super::start::PlantStart;
use super::super::trajectory::PlantTrajectory;
use super::TimeStepping;
use crate::command::Driver;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::simulation::{Method, steps_between};
use alloc::vec;
use alloc::vec::Vec;

/// The time in s from the start over which a step is tried.
pub const PILOT: f64 = 10.0;
/// The shortest step in s that is tried.
pub const SHORTEST: f64 = 1e-6;
/// Part of a state's usual size that its range counts for at least.
const LEAST_RANGE: f64 = 1e-3;
/// Relative tolerance of the reference as a part of the accuracy, and its bounds.
const REFERENCE: (f64, f64, f64) = (1e-3, 1e-12, 1e-7);
/// Points of each step of the reference at which ranges are looked for.
const POINTS: usize = 5;

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

/// A run of the event-located engine that fixed steps are compared with.
pub struct PlantReference<'p> {
    start: &'p PlantStart,
    plant: &'p Plant,
    drivers: &'p dyn Fn() -> Vec<Driver>,
    trajectory: PlantTrajectory,
    /// The range that each state counts for; none for one that is not compared.
    sizes: Vec<Option<f64>>,
}

impl core::fmt::Debug for PlantReference<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("PlantReference").field("trajectory", &self.trajectory).finish_non_exhaustive()
    }
}

impl<'p> PlantReference<'p> {
    /// Runs a plant by the event-located engine for `duration` s with a relative tolerance for each step. `drivers` makes its
    /// drivers, again for each run.
    ///
    /// # Errors
    /// As [`PlantRun::with_drivers`] and [`PlantRun::record_to`].
    pub fn new(
        (plant, start): (&'p Plant, &'p PlantStart),
        drivers: &'p dyn Fn() -> Vec<Driver>,
        duration: f64,
        relative_tolerance: f64,
    ) -> Result<Self, Error> {
        let mut run = PlantRun::with_drivers(plant, start, relative_tolerance, drivers())?;
        let usual = run.scales();
        let trajectory = run.record_to(duration, &mut |_| Ok(()))?;
        let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); usual.len()];
        let mut states = States::new(&trajectory);
        for time in trajectory.points(POINTS).into_iter().chain([duration]) {
            for (range, value) in ranges.iter_mut().zip(states.at(time)) {
                *range = (range.0.min(*value), range.1.max(*value));
            }
        }
        let mut sizes = vec![None; usual.len()];
        for place in plant.indices().compared() {
            let (low, high) = ranges[place];
            sizes[place] = Some((high - low).max(LEAST_RANGE * usual[place]));
        }
        Ok(Self { plant, start, drivers, trajectory, sizes })
    }

    /// The error of each state, in the places that [`Plant::indices`] says, of steps of `step` s; the last one ends with the run and
    /// may be shorter. A state that is not compared has none.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a step outside its range; [`Error::Stopped`] where the steps leave the physics.
    pub fn errors(&self, method: Method, step: f64) -> Result<Vec<f64>, Error> {
        self.measure(method, step, f64::INFINITY)
    }

    /// The longest step with an error of at most `accuracy`, of those that divide `interval` s into 1, 2, 5, 10, 20, … parts
    /// and are not below [`SHORTEST`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for an accuracy or interval outside its range; [`Error::Inconsistent`], which says what can be
    /// reached, or [`Error::Stopped`] when even the shortest step is not accurate enough or leaves the physics.
    pub fn step_for(&self, method: Method, accuracy: f64, interval: f64) -> Result<PlantStepError, Error> {
        parameter::ACCURACY.check(accuracy)?;
        parameter::SAMPLE_INTERVAL.check(interval)?;
        let measure = |step: f64, allowed: f64| {
            let step = interval / steps_between(0.0, interval, step) as f64;
            let greatest = self.measure(method, step, allowed)?.into_iter().fold(0.0, f64::max);
            Ok(PlantStepError { step, compared: self.trajectory.duration(), greatest })
        };
        let mut shortest = interval;
        for step in parts().map(|parts| interval / parts) {
            // A quotient of two decimal numbers may lie a rounding below the whole one.
            if step < SHORTEST * (1.0 - 1e-12) {
                break;
            }
            shortest = step;
            match measure(step, accuracy) {
                Ok(error) if error.greatest <= accuracy => return Ok(error),
                Ok(_) | Err(Error::Stopped { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        let reached = measure(shortest, f64::INFINITY)?;
        Err(Error::Inconsistent {
            parameter: &parameter::ACCURACY,
            value: accuracy,
            requirement: Requirement {
                relation: "must be at least",
                other: "the error of the shortest step that is tried",
                value: reached.greatest,
                unit: "",
            },
            remedy: "loosen run.accuracy, set run.engine = \"event-located\", or give run.step for a step on your own account",
        })
    }

    /// The errors of the states, up to the first that lies off by more than `allowed`.
    fn measure(&self, method: Method, step: f64, allowed: f64) -> Result<Vec<f64>, Error> {
        let stepping = TimeStepping::Fixed { method, step };
        let mut steps = PlantRun::with_drivers(self.plant, self.start, stepping, (self.drivers)())?.steps(method);
        let mut states = States::new(&self.trajectory);
        let mut errors = vec![0.0_f64; self.sizes.len()];
        let end = self.trajectory.duration();
        while steps.time() < end {
            steps.advance_to(stepping.step_end(steps.time(), end))?;
            let pairs = steps.state().iter().zip(states.at(steps.time())).zip(&self.sizes);
            let mut is_off = false;
            for (((ours, theirs), size), error) in pairs.zip(&mut errors) {
                if let Some(size) = size {
                    *error = error.max((ours - theirs).abs() / size);
                    is_off |= *error > allowed;
                }
            }
            if is_off {
                break;
            }
        }
        Ok(errors)
    }
}

/// Reads states of a run at times that do not fall.
struct States<'t> {
    trajectory: &'t PlantTrajectory,
    system: System<f64>,
    at: Evaluation<f64>,
    state: Vec<f64>,
    begun: usize,
}

impl<'t> States<'t> {
    fn new(trajectory: &'t PlantTrajectory) -> Self {
        let plant = trajectory.shared_plant();
        let (system, at) = (System::new(plant, trajectory.relative_tolerance()), Evaluation::new(plant));
        Self { trajectory, system, at, state: vec![0.0; plant.indices().states], begun: 0 }
    }

    fn at(&mut self, time: f64) -> &[f64] {
        let Self { trajectory, system, at, state, begun } = self;
        *begun = trajectory.begun(*begun, time);
        trajectory.read(system, *begun, time, state, at);
        state
    }
}

/// 1, 2, 5, 10, 20, 50, …
fn parts() -> impl Iterator<Item = f64> {
    core::iter::successors(Some(1.0), |decade| Some(decade * 10.0))
        .flat_map(|decade: f64| [1.0, 2.0, 5.0].map(|mantissa| mantissa * decade))
}

/// The longest step with which a plant that is recorded every `interval` s has an error of at most `accuracy` over its first
/// [`PILOT`] seconds, with the error that was measured. The steps divide the interval. `drivers` makes its drivers, again for each
/// run.
///
/// # Errors
/// As [`PlantReference::new`] and [`PlantReference::step_for`].
pub fn plant_step_for_accuracy(
    of: (&Plant, &PlantStart),
    drivers: &dyn Fn() -> Vec<Driver>,
    (duration, interval): (f64, f64),
    method: Method,
    accuracy: f64,
) -> Result<PlantStepError, Error> {
    parameter::ACCURACY.check(accuracy)?;
    let (part, tightest, loosest) = REFERENCE;
    let tolerance = (part * accuracy).clamp(tightest, loosest);
    PlantReference::new(of, drivers, duration.min(PILOT), tolerance)?.step_for(method, accuracy, interval)
}
