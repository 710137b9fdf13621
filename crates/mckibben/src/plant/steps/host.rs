//! The external mechanism in a custom loop: it takes where the ends are, and returns tensions.
//!
//! ```text
//! set       what a valve does from now on
//! move_to   all ends that a host moves go in straight lines to where they are at the end of the step; air, valves, hoses,
//!           tendons, friction and controllers follow, with every event at its instant within the step
//! compute   the tension of an actuator and its derivatives, while its ends move as they do now
//!
//! Plant::rest_distance   how far apart the ends of an actuator are where it does not pull
//! compute_at  the tensions and their derivatives of all actuators, with the ends elsewhere and moving at other rates
//! derivative  the rates of all states
//! set_rates   how fast the ends move from now on
//! set_pressure  another pressure of the air in an actuator
//! save        where everything is
//! restore     back to there, as for a step that is only tried
//! state_size, save_to, restore_from   as numbers in the caller's memory
//! reset       back to where the steps began
//! limit_step  the longest part of a step that is taken in one go
//! ```
//!
//! A robot's simulator knows how long each actuator is and wants to know how hard it pulls; everything else is kept here, for
//! any number of actuators with the network that they share. What moves without the host, such as another mass of the
//! plant, goes on by its own forces.
//!
//! A host gets the tensions where the ends are, takes its own step with them, and moves the ends to where they are
//! then. A host that moves first, to where the ends were, has tensions that lag its lengths by a step, which makes a
//! stiff end unstable.
//!
//! ```
//! use mckibben::plant::{Plant, PlantRun, PlantStart};
//! use mckibben::simulation::Method;
//! use mckibben::valve::Request;
//!
//! # fn lifts(plant: &Plant, start: &PlantStart) -> Result<(), mckibben::Error> {
//! let mut steps = PlantRun::new(plant, start, 1e-6)?.steps(Method::Stable);
//! steps.set(0, Request::Fill)?;
//! let (mass, step, mut velocity) = (2.0, 1e-3, 0.0);
//! let mut distance = steps.state()[plant.indices().mechanisms[0].position(0)];
//! for count in 1..=1000 {
//!     velocity += (9.81 - steps.compute(0)?.tension / mass) * step;
//!     distance += velocity * step;
//!     steps.move_to(f64::from(count) * step, &[distance])?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! At rest the dry friction of (12) is set-valued and the response has its middle, zero: a load that it would hold creeps,
//! until the host treats it as stuck. An actuator on an elastic tendon sticks without the host.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 4, the modular actuator. Checked by `tests/plant_host.rs` and
//! `tests/plant_host_pulses.rs`.

use super::super::run::PlantRun;
use super::super::sample::ActuatorSample;
use super::super::{MechanismIndices, Mounted, Plant, PlantStart};
use super::{Method, NARROW, PlantRow, PlantSteps, part};
use crate::error::Error;
use crate::force::Statics;
use crate::instantiate::Instantiate;
use crate::mechanism::{Coupling, Mechanism};
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::Scalar;
use crate::valve::below_vacuum;
use alloc::vec;

/// What is said of an actuator that is not there.
pub const NO_ACTUATOR: Error = Error::Misuse {
    what: "there is no actuator of this number",
    remedy: "name one of the plant's actuators, counted from zero",
};

/// Parts of a move, and edges of pulses within it, at most: more would take minutes, and is a mistake.
pub const MOST_PARTS: f64 = 1e7;

/// What is said of a step with more.
pub(crate) const TOO_MANY_PARTS: Error = Error::Misuse {
    what: "a step has more than ten million parts and edges of pulses",
    remedy: "take a shorter step, pulses of a lower frequency, or longer parts",
};

/// A part that is this much longer than the longest is as long.
const ROUNDING: f64 = 1e-9;

impl Plant {
    /// The plant with one external mechanism in place of all its mechanisms, and its start: a host moves the ends of
    /// each actuator, whose distance is the coordinate of its index.
    ///
    /// # Errors
    /// As [`PlantRun::new`].
    pub fn to_external(&self, start: &PlantStart) -> Result<(Plant, PlantStart), Error> {
        let at_start = PlantRun::new(self, start, NARROW)?.steps(Method::Stable).sample();
        let count = self.actuators().len();
        let mounted = self.actuators().iter().enumerate().map(|(coordinate, mounted)| Mounted {
            mechanism: 0,
            coupling: Coupling::Direct { coordinate },
            ..mounted.clone()
        });
        let plant =
            Plant::new(mounted.collect(), self.network().clone(), vec![Mechanism::External { distances: count }])?;
        let of_each = |value: fn(&ActuatorSample) -> f64| vec![at_start.actuators.iter().map(value).collect()];
        let (positions, rates) = (of_each(|its| its.distance), of_each(|its| its.rate));
        Ok((plant, PlantStart { positions, rates, ..start.clone() }))
    }
}

/// The mechanisms whose ends a host moves, with their numbers.
pub fn host_mechanisms<R: Scalar>(plant: &Plant<R>) -> impl Iterator<Item = (usize, MechanismIndices)> + '_ {
    let is_hosts = |m: &usize| matches!(plant.mechanisms()[*m], Mechanism::External { .. });
    (0..plant.mechanisms().len()).filter(is_hosts).map(|m| (m, plant.indices().mechanisms[m]))
}

/// Parts of a move of a span in s, none of them longer than `longest` in s.
pub fn parts_of(span: f64, longest: f64) -> u64 {
    ((span / longest - ROUNDING) as u64).saturating_add(1)
}

/// That a length in s limits the parts of moves, or infinity that leaves them whole.
///
/// # Errors
/// [`Error::OutOfRange`] unless it is above zero.
pub fn check_longest_part(longest: f64) -> Result<(), Error> {
    if longest == f64::INFINITY { Ok(()) } else { parameter::STEP.check(longest).map(drop) }
}

/// That a move of a span in s can be taken, in so many parts with the edges of pulses.
///
/// # Errors
/// [`Error::Misuse`] for no span and for too many parts; [`Error::OutOfRange`] for one without end.
pub fn check_move(span: f64, parts: impl FnOnce() -> f64) -> Result<(), Error> {
    if span <= 0.0 {
        return Err(Error::Misuse {
            what: "the ends of actuators cannot be moved back in time or in no time",
            remedy: "give a time later than the last",
        });
    }
    parameter::DURATION.check(span)?;
    if parts() > MOST_PARTS { Err(TOO_MANY_PARTS) } else { Ok(()) }
}

/// Where a part of a move ends that begins at `from` and takes a span, all in s.
pub fn part_end<R: Scalar>(from: R, span: R, (part, parts): (u64, u64)) -> R {
    if part == parts { from + span } else { from + span * R::constant(part as f64 / parts as f64) }
}

impl<R: Instantiate> Plant<R> {
    /// The longest distance in m between the ends of an actuator, with its tendon, at which it does not pull: at rest at a
    /// gauge pressure, without friction.
    ///
    /// # Errors
    /// As [`Actuator::rest_length`](crate::Actuator::rest_length); [`Error::Misuse`] when there is no such actuator.
    pub fn rest_distance(&self, actuator: usize, gauge: GaugePressure<R>) -> Result<R, Error> {
        let mounted = self.actuators.get(actuator).ok_or(NO_ACTUATOR)?;
        let length = mounted.actuator.rest_length(gauge)?;
        Ok(mounted.tendon.as_ref().map_or(length, |tendon| length + tendon.rest_length()))
    }

    /// What the distance in m between the ends of an actuator must be less than, and the name of that limit: the length of a
    /// thread, where no wall and no fitting comes before it. None with a tendon, which takes up what is beyond.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no such actuator.
    pub fn end_distance(&self, actuator: usize) -> Result<Option<(&'static str, R)>, Error> {
        let mounted = self.actuators.get(actuator).ok_or(NO_ACTUATOR)?;
        let law = &mounted.actuator.law().law;
        Ok(mounted.tendon.is_none().then(|| (law.end_name(), law.end_length())))
    }
}

impl<R: Instantiate> PlantSteps<R> {
    /// Divides every step from now on into equal parts no longer than `longest` in s; infinity leaves steps whole. Along them
    /// the distances are interpolated linearly, so that a host with long steps has the air of one with short steps.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless `longest` is above zero. Then nothing has changed.
    pub fn limit_step(&mut self, longest: f64) -> Result<(), Error> {
        check_longest_part(longest)?;
        self.row.longest_part = longest;
        Ok(())
    }

    /// Parts that a move to `until` in s takes, counted before they are taken: those of [`PlantSteps::limit_step`], and the edges
    /// of the pulses that valves have been set to.
    pub fn parts_until(&self, until: R) -> f64 {
        let span = (until - self.time()).value();
        parts_of(span, self.longest_part) as f64 + self.edge_rate() * span
    }

    /// The ends of all external mechanisms go in straight lines to `distances` in m at `until` in s: one distance for each
    /// coordinate, in the order of the mechanisms.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a time that is not later than the last, and for more than [`MOST_PARTS`] parts and edges
    /// of pulses;
    /// [`Error::Table`] unless there is one distance for each coordinate; [`Error::OutOfRange`] for a number that is not
    /// finite; [`Error::Stopped`] when the plant leaves the physics. The steps then stay where they were.
    pub fn move_to(&mut self, until: R, distances: &[R]) -> Result<(), Error> {
        R::move_plant_steps(self, until, distances)
    }

    pub(crate) fn generic_move_to(&mut self, until: R, distances: &[R]) -> Result<(), Error> {
        let from = self.time();
        let span = until - from;
        check_move(span.value(), || self.parts_until(until))?;
        let parts = parts_of(span.value(), self.longest_part);
        self.check_moves(span, distances)?;
        self.work.begin(from, self.row.state());
        let moved = self.go_along(from, span, parts, distances);
        if moved.is_err() {
            let PlantRow { reached, course, .. } = &mut *self.row;
            self.work.return_to_begin(reached, course);
        }
        moved
    }

    /// That there is one distance for each coordinate that a host moves, and that it can be reached.
    #[doc(hidden)]
    pub fn check_moves(&self, span: R, distances: &[R]) -> Result<(), Error> {
        self.check_count("distances", distances.len())?;
        let mut left = distances.iter();
        for (_, here) in host_mechanisms(self.plant()) {
            for (k, distance) in (0..here.coordinates).zip(left.by_ref()) {
                let rate = (*distance - self.state()[here.position(k)]) / span;
                parameter::INITIAL_VELOCITY.check(rate.value())?;
            }
        }
        Ok(())
    }

    /// Sets all rates and goes on, in so many parts, to where the distances are.
    fn go_along(&mut self, from: R, span: R, parts: u64, distances: &[R]) -> Result<(), Error> {
        self.generic_begin_move(span, distances);
        let Self { row, work, .. } = self;
        let PlantRow { system, method, reached, course, .. } = &mut **row;
        for part in 1..=parts {
            let end = part_end(from, span, (part, parts));
            reached.pulse(&system.plant, end)?;
            part::advance(system, *method, reached, end, (&mut *work, &mut *course), None)?;
        }
        self.end_move(distances);
        Ok(())
    }

    fn generic_begin_move(&mut self, span: R, distances: &[R]) {
        let Self { row, work, .. } = self;
        let PlantRow { system, reached, course, .. } = &mut **row;
        let (time, state, mode) = reached.parts();
        work.rates_jump(mode);
        let mut first = 0;
        for (m, here) in host_mechanisms(&system.plant) {
            for k in 0..here.coordinates {
                state[here.rate(k)] = (distances[first + k] - state[here.position(k)]) / span;
            }
            first += here.coordinates;
            system.enter_given_rates(m, *time, state, mode, &mut work.at);
        }
        if work.has_turned(mode) {
            course.forget_guards();
        }
    }

    /// Puts all ends exactly to where they have come, so that nothing adds up over many steps.
    #[doc(hidden)]
    pub fn end_move(&mut self, distances: &[R]) {
        let PlantRow { system, reached, .. } = &mut *self.row;
        let mut first = 0;
        for (_, here) in host_mechanisms(&system.plant) {
            let (_, state, _) = reached.parts();
            state[here.first..here.first + here.coordinates]
                .copy_from_slice(&distances[first..first + here.coordinates]);
            first += here.coordinates;
        }
    }

    /// That there is one number for each coordinate that a host moves.
    pub(super) fn check_count(&self, name: &'static str, given: usize) -> Result<(), Error> {
        let count: usize = host_mechanisms(self.plant()).map(|(_, here)| here.coordinates).sum();
        if count == given {
            return Ok(());
        }
        Err(Error::Table {
            name,
            problem: "there is not one for each coordinate of the external mechanisms",
            entry: given.min(count) + 1,
            remedy: "give as many as the external mechanisms have coordinates",
        })
    }
}

impl PlantSteps {
    /// Sets the rates by which all ends come to where the distances are within a span in s.
    #[doc(hidden)]
    pub fn begin_move(&mut self, span: f64, distances: &[f64]) {
        self.generic_begin_move(span, distances);
    }

    /// Lets the actuators whose ends a host moves slide the way of the rates that they have come to, where nothing else of their
    /// modes changes.
    #[doc(hidden)]
    pub fn turn(&mut self) {
        let Self { row, work, .. } = self;
        let PlantRow { system, reached, course, .. } = &mut **row;
        let (time, state, mode) = reached.parts();
        for (m, _) in host_mechanisms(&system.plant) {
            if system.follow_rates(m, *time, state, mode, &mut work.at) {
                course.forget_guards();
            }
        }
    }

    /// Replaces the air in an actuator by air of another gauge pressure, at the temperature that it has: its mass changes in
    /// proportion to the absolute pressure. A host that keeps pressures among its own states sets them by this.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] and [`Error::Inconsistent`] for a pressure that is not finite or is vacuum; [`Error::Misuse`]
    /// when there is no such actuator, when its pressure is given, and when no host moves its ends. Then nothing has changed.
    pub fn set_pressure(&mut self, actuator: usize, gauge: GaugePressure) -> Result<(), Error> {
        let Self { row, work, .. } = self;
        let PlantRow { system, reached, course, .. } = &mut **row;
        let plant = &*system.plant;
        let mounted = plant.actuators().get(actuator).ok_or(NO_ACTUATOR)?;
        let is_moved = matches!(plant.mechanisms()[mounted.mechanism], Mechanism::External { .. });
        if mounted.pressure.is_some() || !is_moved {
            return Err(Error::Misuse {
                what: "a pressure is set of an actuator that has a given one, or whose ends no host moves",
                remedy: "set that of an actuator on an external mechanism, whose pressure follows from its air",
            });
        }
        let air = mounted.actuator.air();
        parameter::INITIAL_GAUGE_PRESSURE.check(gauge.0)?;
        let pressure = gauge.absolute(air.atmosphere()).0;
        if pressure <= 0.0 {
            return Err(below_vacuum(&parameter::INITIAL_GAUGE_PRESSURE, gauge, air));
        }
        let here = plant.indices().actuators[actuator];
        let (time, state, mode) = reached.parts();
        state[here.mass()] *= pressure / state[here.pressure];
        state[here.pressure] = pressure;
        course.forget_guards();
        system.enter_jumped_ends(mounted.mechanism, *time, state, mode, &mut work.at);
        Ok(())
    }
}
