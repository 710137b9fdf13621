//! A run in segments: at given instants its four states are reset, while valve and command go on.
//!
//! Fitting a model to a measured trajectory needs this: over a whole run a small error in a number may grow beyond all
//! bounds, as when a load bounces on a taut braid; over a short segment it does not. With the states at the joints as
//! further unknowns, and the condition that each segment ends where the next one starts, this is multiple shooting (Bock,
//! 1983).
//!
//! Checked by `tests/segments.rs`: joints that change nothing, and derivatives with respect to the state at a joint.

use super::{RigPlant, RigTrajectory};
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::parameter;
use crate::plant::{PlantRun, PlantTrajectory};
use crate::simulation::{Rig, State};
use alloc::vec;

/// Simulates a rig as [`simulate`](super::simulate) does, and at each of the `joints`, times in s that rise from zero to the
/// duration, goes on from the state that `next_start` makes of the number of the joint and the state that was reached.
///
/// # Errors
/// As [`simulate`](super::simulate); [`Error::Stopped`] also for a state at a joint that no actuator can be in, and
/// [`Error::NotImplemented`] for a rig that remembers more than its four states: with an air line, a pressure regulator,
/// a tendon in series or hysteresis.
pub fn simulate_in_segments<R: Instantiate>(
    rig: &Rig<R>,
    start: State<R>,
    (duration, relative_tolerance): (R, f64),
    joints: &[f64],
    mut next_start: impl FnMut(usize, State<R>) -> State<R>,
) -> Result<RigTrajectory<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
    rig.check_counts(duration.value())?;
    let remembers = rig.actuator().friction().hysteresis().is_some() || rig.tendon().is_some();
    if rig.has_air_network() || remembers {
        return Err(Error::NotImplemented(&crate::limit::SEGMENTS_MEMORY));
    }
    let view = RigPlant::new(rig);
    let places = [view.plant().indices().mechanisms[0].first, view.plant().indices().actuators[0].pressure];
    let places = [places[0], places[0] + 1, places[1], places[1] + 1];
    let mut run = PlantRun::with_drivers(view.plant(), &view.start(&start), relative_tolerance, vec![])?;
    let mut kept = PlantTrajectory::begin(&run);
    for (place, joint) in joints.iter().enumerate() {
        kept.keep(&mut run, R::constant(*joint), &mut |_| Ok(()))?;
        let state = next_start(place, State::from_array(places.map(|place| run.state()[place])));
        check(*joint, &state)?;
        let mut states = run.state().to_vec();
        for (place, number) in places.into_iter().zip(state.to_array()) {
            states[place] = number;
        }
        run.go_on_from(&states);
    }
    kept.keep(&mut run, duration, &mut |_| Ok(()))?;
    Ok(RigTrajectory::of(&view, kept))
}

/// That an actuator can be in a state at a joint.
fn check<R: Instantiate>(time: f64, state: &State<R>) -> Result<(), Error> {
    let State { length, velocity, pressure, air_mass } = state;
    let numbers = [
        ("length", length.value(), "m", length.value() > 0.0),
        ("velocity", velocity.value(), "m/s", true),
        ("absolute pressure", pressure.0.value(), "Pa", pressure.0.value() > 0.0),
        ("mass of the air", air_mass.value(), "kg", air_mass.value() > 0.0),
    ];
    match numbers.into_iter().find(|(_, value, _, good)| !(*good && value.is_finite())) {
        None => Ok(()),
        Some((quantity, value, unit, _)) => Err(Error::Stopped {
            time,
            reason: "no actuator can be in the state that is set there",
            quantity,
            value,
            unit,
            remedy: "give finite states; length, pressure and mass of the air above zero",
        }),
    }
}
