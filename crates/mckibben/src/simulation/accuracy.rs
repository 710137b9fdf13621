//! How far the fixed-step engine lies from the event-located one, and the step that an accuracy asked for needs.
//!
//! Both engines start from the same state. At the end of every step the four states are compared, and each has its error
//!
//! ```text
//! e = max |y − y*| / max(y*_max − y*_min, Y/1000)
//! ```
//!
//! | symbol | what |
//! |---|---|
//! | y, y* | a state by the fixed-step engine, and by the event-located one |
//! | y*_max − y*_min | the range that the state covers over the time compared |
//! | Y | its usual size: `L_max`, `L_max` in a second, the atmosphere's pressure, the air in the longest braid at it |
//!
//! The second term stands in where a state hardly moves; the share of no range would mean nothing. The error of a run is
//! the largest of the four.
//!
//! A step is chosen by trying: the recording interval whole, then in 2, 5, 10, 20, 50, … parts, until the error that is
//! measured is at most the accuracy asked for. A step that fails is left at the first state that lies too far off, and so
//! costs little. Only the first [`PILOT`] seconds of a run are compared and no step below [`SHORTEST`] is tried: the cost
//! is bounded, and what happens later in the run is not seen.
//!
//! Checked by `tests/accuracy.rs`; the figures for the examples are in `docs/accuracy.md`.

use super::fixed_step::FixedStepper;
use super::kernel::Method;
use super::member::Member;
use super::rig::{Rig, State};
use super::sample::SampleTimes;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::plant::four;
use crate::plant::{RigReader, RigTrajectory, simulate};

/// The time in s from the start over which a step is tried.
pub const PILOT: f64 = 10.0;
/// The shortest step in s that is tried.
pub const SHORTEST: f64 = 1e-6;
/// Part of a state's usual size that its range counts for at least.
pub(crate) const LEAST_RANGE: f64 = 1e-3;
/// Relative tolerance of the reference as a part of the accuracy, and its bounds.
pub(crate) const REFERENCE: (f64, f64, f64) = (1e-3, 1e-12, 1e-7);

/// The error of the fixed-step engine: for each state the largest difference from the event-located engine, as a share of
/// the range that the state covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepError {
    /// The step in s: no step was longer.
    pub step: f64,
    /// The time in s from the start over which the engines were compared.
    pub compared: f64,
    /// Error of the length.
    pub length: f64,
    /// Error of the velocity; of the load's with a tendon in series.
    pub velocity: f64,
    /// Error of the pressure.
    pub pressure: f64,
    /// Error of the air mass.
    pub air_mass: f64,
}

impl StepError {
    /// The errors of length, velocity, pressure and air mass.
    pub fn states(&self) -> [f64; 4] {
        [self.length, self.velocity, self.pressure, self.air_mass]
    }

    /// The largest of the four.
    pub fn greatest(&self) -> f64 {
        self.states().into_iter().fold(0.0, f64::max)
    }
}

/// A run of the event-located engine that the fixed-step engine is compared with.
#[derive(Clone, Debug)]
pub struct Reference {
    trajectory: RigTrajectory,
    start: State,
    scales: [f64; 4],
}

impl Reference {
    /// Runs the event-located engine for `duration` s with a relative tolerance for each step.
    ///
    /// # Errors
    /// As [`simulate`].
    pub fn new(rig: &Rig, start: State, duration: f64, relative_tolerance: f64) -> Result<Self, Error> {
        let trajectory = simulate(rig, start, duration, relative_tolerance)?;
        let magnitudes = Member::new(rig.actuator(), relative_tolerance, 0.0).magnitudes();
        let ranges = trajectory.ranges();
        let scales = core::array::from_fn(|n| (ranges[n].1 - ranges[n].0).max(LEAST_RANGE * magnitudes[n]));
        Ok(Self { trajectory, start, scales })
    }

    /// The error of steps of `step` s; the last one ends with the run and may be shorter.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a step outside its range; [`Error::Stopped`] where the steps leave the physics.
    pub fn error(&self, method: Method, step: f64) -> Result<StepError, Error> {
        parameter::STEP.check(step)?;
        self.measure(&SampleTimes::new(self.trajectory.duration(), step), method, step, f64::INFINITY)
    }

    /// The longest step with an error of at most `accuracy`, of those that divide `interval` s into 1, 2, 5, 10, 20, …
    /// parts and are not below [`SHORTEST`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for an accuracy or interval outside its range; [`Error::Inconsistent`], which says what can
    /// be reached, or [`Error::Stopped`] when even the shortest step is not accurate enough or leaves the physics.
    pub fn step_for(&self, method: Method, accuracy: f64, interval: f64) -> Result<StepError, Error> {
        let times = SampleTimes::new(self.trajectory.duration(), interval);
        longest_step(accuracy, interval, StepError::greatest, |step, allowed| {
            self.measure(&times, method, step, allowed)
        })
    }

    /// The error of steps that are not longer than `step`, up to the first state that lies off by more than `allowed`.
    fn measure(&self, times: &SampleTimes, method: Method, step: f64, allowed: f64) -> Result<StepError, Error> {
        let mut stepper = FixedStepper::new(self.trajectory.rig(), self.start, method);
        let mut reference = RigReader::new(&self.trajectory);
        let mut errors = [0.0_f64; 4];
        for (time, _) in times.steps(step) {
            stepper.advance_to(time)?;
            let (mut ours, theirs) = (stepper.state().to_array(), four(&reference.read(time)));
            if self.trajectory.rig().tendon().is_some() {
                ours[1] = stepper.sample().load_velocity;
            }
            for n in 0..4 {
                errors[n] = errors[n].max((ours[n] - theirs[n]).abs() / self.scales[n]);
            }
            if errors.iter().any(|error| *error > allowed) {
                break;
            }
        }
        let [length, velocity, pressure, air_mass] = errors;
        Ok(StepError { step, compared: self.trajectory.duration(), length, velocity, pressure, air_mass })
    }
}

/// The error of the longest step that is at most `accuracy`, of those that divide `interval` s into 1, 2, 5, 10, 20, … parts
/// and are not below [`SHORTEST`]. `measure` gives the error of a step, up to where it exceeds what is allowed.
///
/// # Errors
/// As [`Reference::step_for`].
pub(crate) fn longest_step<E>(
    accuracy: f64,
    interval: f64,
    greatest: impl Fn(&E) -> f64,
    measure: impl Fn(f64, f64) -> Result<E, Error>,
) -> Result<E, Error> {
    parameter::ACCURACY.check(accuracy)?;
    parameter::SAMPLE_INTERVAL.check(interval)?;
    let mut shortest = interval;
    for step in parts().map(|parts| interval / parts) {
        // A quotient of two decimal numbers may lie a rounding below the whole one.
        if step < SHORTEST * (1.0 - 1e-12) {
            break;
        }
        shortest = step;
        match measure(step, accuracy) {
            Ok(error) if greatest(&error) <= accuracy => return Ok(error),
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
            value: greatest(&reached),
            unit: "",
        },
        remedy: "loosen run.accuracy, set run.engine = \"event-located\", or give run.step for a step on your own account",
    })
}

/// 1, 2, 5, 10, 20, 50, …
fn parts() -> impl Iterator<Item = f64> {
    core::iter::successors(Some(1.0), |decade| Some(decade * 10.0))
        .flat_map(|decade: f64| [1.0, 2.0, 5.0].map(|mantissa| mantissa * decade))
}

/// The error of a run of `duration` s in steps of `step` s, against the event-located engine at a relative tolerance of
/// 1e-12.
///
/// # Errors
/// As [`Reference::new`] and [`Reference::error`].
pub fn fixed_step_error(rig: &Rig, start: State, duration: f64, method: Method, step: f64) -> Result<StepError, Error> {
    Reference::new(rig, start, duration, REFERENCE.1)?.error(method, step)
}

/// The longest step with which a run that is recorded every `interval` s has an error of at most `accuracy` over its first
/// [`PILOT`] seconds, with the error that was measured. The steps divide the interval.
///
/// # Errors
/// As [`Reference::new`] and [`Reference::step_for`].
pub fn step_for_accuracy(
    rig: &Rig,
    start: State,
    (duration, interval): (f64, f64),
    method: Method,
    accuracy: f64,
) -> Result<StepError, Error> {
    parameter::ACCURACY.check(accuracy)?;
    let (part, tightest, loosest) = REFERENCE;
    let relative_tolerance = (part * accuracy).clamp(tightest, loosest);
    Reference::new(rig, start, duration.min(PILOT), relative_tolerance)?.step_for(method, accuracy, interval)
}
