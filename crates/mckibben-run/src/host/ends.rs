//! Where a host may put the ends of actuators, and how fast they may move.
//!
//! A distance is above zero. Without a tendon the braid ends it: at the length of its thread, or where a fitting or a wall comes
//! first. A step that goes beyond stops the plant, and nothing can be computed there.

use super::model::{HostModel, Motion};
use crate::failure::Failure;
use crate::quantities::given;
use mckibben::plant::Plant;
use mckibben::{Error, parameter};

/// The greatest distance in m and rate in m/s: what follows from them, such as the force of viscous friction, is a finite number.
pub const GREATEST_MOTION: f64 = 1e100;

/// The distances in m at which the actuators end, with the names of what ends them; none with a tendon.
pub(super) fn limits(plant: &Plant) -> Result<Vec<Option<(&'static str, f64)>>, Error> {
    (0..plant.actuators().len()).map(|actuator| plant.end_distance(actuator)).collect()
}

impl HostModel {
    /// That there is a distance in m above zero between the ends of an actuator, by its place among those of one plant or more.
    ///
    /// # Errors
    /// With the actuator.
    pub(super) fn check_distance(&self, place: usize, distance: f64) -> Result<(), Failure> {
        if distance > 0.0 && distance <= GREATEST_MOTION {
            return Ok(());
        }
        let title = format!("a distance of {distance:?} m between the ends is none");
        let remedy = format!("give a number in m above zero and up to {GREATEST_MOTION:e}");
        Err(Failure::input(title, remedy).of(self.actuator(place)))
    }

    /// That the ends of an actuator can move at a rate in m/s.
    ///
    /// # Errors
    /// With the actuator.
    pub(super) fn check_rate(&self, place: usize, rate: f64) -> Result<(), Failure> {
        if rate.abs() <= GREATEST_MOTION {
            return Ok(());
        }
        let title = format!("the ends cannot move at {rate:?} m/s");
        let remedy =
            format!("give a number from -{GREATEST_MOTION:e} to {GREATEST_MOTION:e} in m/s, or more time to move");
        Err(Failure::input(title, remedy).of(self.actuator(place)))
    }

    /// Both, of all actuators of a plant.
    ///
    /// # Errors
    /// As those, and unless there are as many numbers as actuators.
    pub(super) fn check_ends(&self, distances: &[f64], rates: &[f64]) -> Result<(), Failure> {
        for (name, numbers) in [("distances", distances), ("rates", rates)] {
            self.check_count(name, numbers.len())?;
        }
        (0..).zip(distances).try_for_each(|(place, its)| self.check_distance(place, *its))?;
        (0..).zip(rates).try_for_each(|(place, its)| self.check_rate(place, *its))
    }

    /// That a step from one time to another in s has an end, and does not go back.
    ///
    /// # Errors
    /// With both times.
    pub(super) fn check_time(&self, from: f64, until: f64) -> Result<(), Failure> {
        if !until.is_finite() {
            return Err(Failure::input(format!("a step to {until:?} s has no end"), "give a finite time in s"));
        }
        // By its own steps a plant goes on to where it is as well.
        let is_later = until > from || (until == from && self.motion() == Motion::Scenario);
        if is_later {
            return Ok(());
        }
        Err(Failure::input(
            format!("a step to {until:?} s does not go on: the plant is at {from:?} s"),
            "give a later time, or restore a state that was saved before",
        ))
    }

    /// That no distance in m lies where an actuator has ended.
    ///
    /// # Errors
    /// With the actuator, and what ends it.
    pub(super) fn check_reach(&self, distances: &[f64]) -> Result<(), Failure> {
        for (place, (distance, limit)) in distances.iter().zip(self.limits.iter().cycle()).enumerate() {
            let Some((limit, end)) = limit.filter(|(_, end)| distance >= end) else { continue };
            let limit = if limit == parameter::THREAD_LENGTH.key { "its thread" } else { limit };
            let end = given(end, "m");
            let title = format!("a distance of {distance:?} m between the ends is beyond {limit} of {end}");
            return Err(Failure::input(title, "keep the ends closer together").of(self.actuator(place)));
        }
        Ok(())
    }

    /// That there are so many numbers, one for each actuator whose ends the host moves.
    ///
    /// # Errors
    /// Otherwise; where the scenario moves the ends, with a sentence on that.
    pub(super) fn check_count(&self, name: &str, count: usize) -> Result<(), Failure> {
        let due = self.distance_count();
        if count == due {
            return Ok(());
        }
        if self.motion() == Motion::Scenario {
            return Err(Failure::input(
                format!("{count} {name} are given, but the scenario moves the ends"),
                "give none, or read the scenario with the motion of the host",
            ));
        }
        Err(Failure::input(format!("{count} {name} are given for {due}"), "give one for each actuator, in their order"))
    }

    fn actuator(&self, place: usize) -> &str {
        &self.actuators()[place % self.actuators().len()]
    }
}
