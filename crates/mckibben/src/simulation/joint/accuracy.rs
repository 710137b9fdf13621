//! The step that a joint needs for an accuracy: as for a rig ([`crate::simulation::accuracy`]), over six states.
//!
//! The usual sizes are those by which the event-located engine scales its own errors.
//!
//! Checked by `tests/joint_stepper.rs`.

use super::stepper::JointStepper;
use super::{JointRig, JointState};
use crate::error::Error;
use crate::parameter;
use crate::plant::JointPlant;
use crate::simulation::accuracy::{LEAST_RANGE, PILOT, REFERENCE, longest_step};
use crate::simulation::kernel::Method;
use crate::simulation::sample::SampleTimes;
use alloc::vec::Vec;

/// The step of a joint, and its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointStepError {
    /// The step in s: no step was longer.
    pub step: f64,
    /// The time in s from the start over which the engines were compared.
    pub compared: f64,
    /// The largest difference of a state from the event-located engine's, as a share of the range that the state covers.
    pub greatest: f64,
}

/// The longest step with which a joint that is recorded every `interval` s has an error of at most `accuracy` over its first
/// [`PILOT`] seconds, with the error that was measured. The steps divide the interval.
///
/// # Errors
/// [`Error::OutOfRange`] for an accuracy or interval outside its range; as [`JointPlant::simulate`];
/// [`Error::Inconsistent`] when even the shortest step is not accurate enough; [`Error::NotImplemented`] as
/// [`JointStepper::new`].
pub fn joint_step_for_accuracy(
    rig: &JointRig,
    start: JointState,
    (duration, interval): (f64, f64),
    method: Method,
    accuracy: f64,
) -> Result<JointStepError, Error> {
    parameter::ACCURACY.check(accuracy)?;
    parameter::SAMPLE_INTERVAL.check(interval)?;
    let stepper = JointStepper::new(rig.clone(), method)?;
    let (part, tightest, loosest) = REFERENCE;
    let (compared, tolerance) = (duration.min(PILOT), (part * accuracy).clamp(tightest, loosest));
    let joint = JointPlant::new(rig)?;
    let reference = joint.simulate(&start, compared, tolerance)?;
    let times = SampleTimes::new(compared, interval);
    let expected: Vec<[f64; 6]> = reference.samples(interval).map(|sample| sample.state().to_array()).collect();
    let usual = joint.usual_sizes(&start, tolerance)?;
    let scales: [f64; 6] = core::array::from_fn(|n| {
        let values = expected.iter().map(|state| state[n]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        (high - low).max(LEAST_RANGE * usual[n])
    });
    let error_of = |step: f64, allowed: f64| {
        let (mut course, mut rows, mut worst) = (stepper.begin(start), expected.iter().skip(1), 0.0_f64);
        for (time, recorded) in times.steps(step) {
            stepper.advance_to(&mut course, time)?;
            let Some(expected) = recorded.then(|| rows.next()).flatten() else { continue };
            let ours = course.state().to_array();
            worst = (0..6).fold(worst, |worst, n| worst.max((ours[n] - expected[n]).abs() / scales[n]));
            if worst > allowed {
                break;
            }
        }
        Ok(JointStepError { step, compared, greatest: worst })
    };
    longest_step(accuracy, interval, |error: &JointStepError| error.greatest, error_of)
}
