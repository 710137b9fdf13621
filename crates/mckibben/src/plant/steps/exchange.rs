//! A plant whose host integrates: rates and guards of the mode that holds, events at the instants that the host locates.
//!
//! ```text
//! place        time and states that the host has come to; the mode stays
//! rates        ẏ in that mode, smoothly continued beyond its end
//! guards       positive while the mode lasts; the host locates where one comes down through zero
//! update       what follows there: guards that have fired, then what is due, until nothing changes; the next instant
//! pass_due     that much of an update as comes before commands and parameters that are set at this instant
//! scales       the usual sizes of the states, for tolerances
//! rates_along, guards_along, sample_along    exact derivatives in a direction of the states
//! ```
//!
//! The mode and its rules are those of the event-located engine: see [`crate::engine::Hybrid`]. A host differs in one thing:
//! it comes to an event from either side of the root, by its own tolerance, and may step over several borders at once. When a
//! guard has fired is in [`fired`]; an update crosses until none has. A guard at zero is written as the least positive number:
//! the mode lasts there, and the host sees the guard leave it.
//!
//! One mode ends here alone. An actuator whose given rate is zero rests, without dry friction. In every other engine the rates of
//! given ends are constant between events; here they leave zero smoothly. So a guard that only this list has ends the rest:
//!
//! ```text
//! guard of rest:  v₀ − |v|        v₀ the velocity by which a reversal passes zero, a part of the longest length in a second
//! ```
//!
//! Source: FMI 3.0.2, section 3, for what a host requires. Checked by `tests/plant_exchange.rs`, and by `tests/abi.rs` of
//! `mckibben-fmu`.

mod fired;

use super::super::crossing::{Part, PlantEventKind};
use super::super::evaluation::{Evaluation, System};
use super::super::guard::PlantGuard;
use super::super::mode::PlantMode;
use super::super::sample::PlantSample;
use super::PlantSteps;
use crate::dual::Dual;
use crate::engine::GuardForm;
use crate::engine::Halt;
use crate::error::Error;
use crate::mechanism::Mechanism;
use crate::parameter;
use crate::scalar::Scalar as _;
use crate::simulation::{EventKind, Guard, LengthRegime, Sliding};
use alloc::vec;
use alloc::vec::Vec;
use fired::Fired;

/// The time in s within which the rate of a guard brings it to zero, for it to have fired; and by which pulses are laid out
/// ahead of the time that has been reached.
const NEAR: f64 = 1e-10;
/// By how much a time in s may miss an instant and be taken for it, relative to a time of one second or more.
const ROUNDING: f64 = 10.0 * NEAR;
/// The time in s by which an update may miss an instant.
const LATE: f64 = 1.0;
/// Events in one instant that are taken for chatter.
const MOST_EVENTS: u32 = 100;

type Along = Dual<f64, 1>;

/// What an update has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventUpdate {
    /// Events that were crossed and instants that were passed.
    pub events: u32,
    /// Whether a state has another value than before.
    pub has_moved: bool,
    /// The next instant in s at which something is due; infinite when there is none.
    pub next: f64,
}

impl EventUpdate {
    /// This update and a later one of the same instant as one.
    #[must_use]
    pub fn and(self, later: Self) -> Self {
        let (events, has_moved) = (self.events + later.events, self.has_moved || later.has_moved);
        Self { events, has_moved, next: later.next }
    }
}

/// Evaluates a plant in the mode of its [`PlantSteps`], for a host that integrates.
#[derive(Clone, Debug)]
pub struct PlantExchange {
    system: System<f64>,
    at: Evaluation<f64>,
    along: Evaluation<Along>,
    guards: Vec<(PlantGuard, GuardForm)>,
    seeded: Vec<Along>,
    seeded_rates: Vec<Along>,
    rates: Vec<f64>,
    before: Vec<f64>,
    /// The mode with the pieces that hold beyond its end.
    beyond: Option<PlantMode>,
    next: f64,
    /// The time of the last update.
    updated: f64,
    /// Whether an update of this instant has begun that is yet to end, and has crossed or passed something.
    is_within: bool,
}

impl PlantExchange {
    /// Evaluates the plant of these steps, for a host that integrates with a relative tolerance: borders between modes are as
    /// wide as its noise.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tolerance outside its range.
    pub fn new(steps: &PlantSteps, relative_tolerance: f64) -> Result<Self, Error> {
        parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
        let plant = &steps.system.plant;
        let (states, zero) = (plant.indices().states, Along::constant(0.0));
        let system = System::new(plant, relative_tolerance);
        let next = next_of(&system, steps);
        Ok(Self {
            system,
            at: Evaluation::new(plant),
            along: Evaluation::new(plant),
            guards: Vec::new(),
            seeded: vec![zero; states],
            seeded_rates: vec![zero; states],
            rates: vec![0.0; states],
            before: vec![0.0; states],
            beyond: None,
            next,
            updated: steps.time(),
            is_within: false,
        })
    }

    /// The most guards that a mode is expected to have. Where one has more, the last value is the least of the rest.
    pub fn guard_count(&self) -> usize {
        let plant = &self.system.plant;
        let coordinates: usize = plant.indices().mechanisms.iter().map(|here| here.coordinates).sum();
        let network = plant.network();
        12 * plant.actuators().len() + 6 * coordinates + 2 * (network.branches.len() + network.nodes.len())
    }

    /// The time in s of the last update, from which on the mode holds; a nanosecond or less after that of the host.
    pub fn updated(&self) -> f64 {
        self.updated
    }

    /// Takes on a time in s and the states that `write` sets, in the mode that holds.
    pub fn place(&self, steps: &mut PlantSteps, time: f64, write: impl FnOnce(&mut [f64])) {
        let (own, state, _) = steps.row.reached.parts();
        *own = time;
        write(state);
        steps.row.forget_guards();
    }

    /// Writes the rates of all states per second in the mode that holds, one for each state. A host tries states far beyond the
    /// end of a mode, where a law may have no continuation; there each law takes the piece of its state.
    ///
    /// # Errors
    /// [`Error::Table`] for more or fewer rates.
    pub fn rates(&mut self, steps: &PlantSteps, rates: &mut [f64]) -> Result<(), Error> {
        check_count("rates", rates.len(), self.rates.len())?;
        let (time, state) = (steps.time(), steps.state());
        self.system.rates(time, state, steps.mode(), &mut self.at, rates);
        if rates.iter().any(|rate| !rate.is_finite()) {
            let mode = match &mut self.beyond {
                Some(mode) => {
                    mode.clone_from(steps.mode());
                    mode
                }
                None => self.beyond.insert(steps.mode().clone()),
            };
            self.system.enter_pieces(time, state, mode, &mut self.at);
            self.system.rates(time, state, mode, &mut self.at, rates);
        }
        Ok(())
    }

    /// Writes the guards of the mode that holds; none is zero. Values beyond its guards are one; where there are more guards than
    /// values the last value is the least of the rest.
    pub fn guards(&mut self, steps: &PlantSteps, values: &mut [f64]) {
        values.fill(1.0);
        let Some(last) = values.len().checked_sub(1) else { return };
        self.list(steps.mode());
        for place in 0..self.guards.len() {
            let value = self.value(steps, self.guards[place]);
            let value = if value == 0.0 { f64::MIN_POSITIVE } else { value };
            if place <= last {
                values[place] = value;
            } else {
                values[last] = values[last].min(value);
            }
        }
    }

    /// Lists the guards of a mode: those of the plant, then those of actuators that rest where a host moves their ends.
    fn list(&mut self, mode: &PlantMode) {
        self.system.guards(mode, &mut self.guards);
        let plant = &*self.system.plant;
        for (i, mounted) in plant.actuators().iter().enumerate() {
            let its = &mode.actuators[i].mode;
            let is_moved = matches!(plant.mechanisms()[mounted.mechanism], Mechanism::External { .. });
            let may_slide = mounted.tendon.is_none() && mounted.actuator.friction().has_direction();
            // A slack one has no force, and slides by its rate once it is no longer slack.
            if is_moved && may_slide && its.sliding == Sliding::Held && its.length_regime != LengthRegime::Slack {
                self.guards.push((PlantGuard::Of(i, Guard::Rest), GuardForm::Function));
            }
        }
    }

    /// The value of a guard where the steps are.
    fn value(&mut self, steps: &PlantSteps, (guard, form): (PlantGuard, GuardForm)) -> f64 {
        match form {
            GuardForm::Above { index, bound } => steps.state()[index] - bound,
            GuardForm::Below { index, bound } => bound - steps.state()[index],
            GuardForm::Function => self.system.guard(guard, steps.time(), steps.state(), steps.mode(), &mut self.at),
        }
    }

    /// The derivative of a guard in the direction of the seeded states, and of time by `per_time`.
    fn value_along(&mut self, steps: &PlantSteps, (guard, form): (PlantGuard, GuardForm), per_time: f64) -> f64 {
        match form {
            GuardForm::Above { index, .. } => self.seeded[index].slope[0],
            GuardForm::Below { index, .. } => -self.seeded[index].slope[0],
            GuardForm::Function => {
                let time = Along { value: steps.time(), slope: [per_time] };
                self.system.guard(guard, time, &self.seeded, steps.mode(), &mut self.along).slope[0]
            }
        }
    }

    /// Seeds the states with a direction.
    fn seed(&mut self, steps: &PlantSteps, seed: impl Fn(usize) -> f64) {
        for (place, (into, value)) in self.seeded.iter_mut().zip(steps.state()).enumerate() {
            *into = Along { value: *value, slope: [seed(place)] };
        }
    }

    /// Seeds the states with the rates that were computed.
    fn seed_with_rates(&mut self, steps: &PlantSteps) {
        let rates = core::mem::take(&mut self.rates);
        self.seed(steps, |place| rates[place]);
        self.rates = rates;
    }

    /// Crosses the guards that have fired and passes what is due, until nothing changes. A time that lies less than a
    /// nanosecond before the next instant is taken for that instant.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the plant cannot go on, or when events follow each other without end; [`Error::Misuse`] for a
    /// time more than a second before the last update, or after the next instant.
    pub fn update(&mut self, steps: &mut PlantSteps) -> Result<EventUpdate, Error> {
        self.pass(steps, true)
    }

    /// Crosses the guards that have fired and passes what is due, before commands and parameters that are set at this instant:
    /// a poppet that arrives now has arrived. An update follows. A pulse that begins now is left to it, since a command at
    /// that instant comes first.
    ///
    /// # Errors
    /// As [`PlantExchange::update`].
    pub fn pass_due(&mut self, steps: &mut PlantSteps) -> Result<EventUpdate, Error> {
        self.pass(steps, false)
    }

    fn pass(&mut self, steps: &mut PlantSteps, is_last: bool) -> Result<EventUpdate, Error> {
        let (time, state, _) = steps.row.reached.parts();
        if (*time - self.next).abs() < ROUNDING * (1.0 + time.abs()) {
            *time = self.next;
        }
        let time = *time;
        // What is not a number is refused as well.
        if !(self.updated - LATE..=self.next + LATE).contains(&time) {
            return Err(Error::Misuse {
                what: "an event is updated at a time before the last one, or long after something was due",
                remedy: "stop at the next instant that the last update has given; to go back, restore what was saved",
            });
        }
        self.before.copy_from_slice(state);
        let (mut events, mut is_new) = (0, self.is_within && time == self.updated);
        // Once in an update: where entering all pieces has not brought a guard above zero, it is crossed as others are.
        let mut may_enter = true;
        loop {
            let kind = if let Some(fired) = self.fired(steps, is_new, may_enter) {
                let (_, state, mode) = steps.row.reached.parts();
                self.system.project(time, state, mode, &mut self.at);
                match fired {
                    Fired::Pieces => {
                        may_enter = false;
                        self.system.enter_pieces(time, state, mode, &mut self.at);
                        self.system.follow_all(time, state, mode, &mut self.at, None);
                        self.system.settle_ends(time, state, mode, &mut self.at);
                        self.system.check_jumps(time, state, mode, &mut self.at)?;
                        None
                    }
                    Fired::Guard(PlantGuard::Of(i, Guard::Rest)) if mode.actuators[i].mode.sliding == Sliding::Held => {
                        let m = self.system.plant.actuators()[i].mechanism;
                        self.system.enter_given_rates(m, time, state, mode, &mut self.at);
                        Some(PlantEventKind { part: Part::Actuator(i), kind: EventKind::BreakAway })
                    }
                    Fired::Guard(guard) => Some(self.system.cross(guard, time, state, mode, &mut self.at)?),
                }
            } else {
                if is_last {
                    steps.row.reached.pulse(&self.system.plant, time + NEAR * (1.0 + time.abs()))?;
                }
                let (_, state, mode) = steps.row.reached.parts();
                if self.system.next_instant(mode, time).is_none() {
                    break;
                }
                Some(self.system.pass_instant(time, state, mode, &mut self.at)?)
            };
            is_new = true;
            events += 1;
            if events > MOST_EVENTS {
                return Err(self.system.halts(time, steps.state(), Halt::Events, kind));
            }
        }
        steps.row.forget_guards();
        (self.next, self.updated, self.is_within) = (next_of(&self.system, steps), time, is_new && !is_last);
        Ok(EventUpdate { events, has_moved: self.before != steps.state(), next: self.next })
    }

    /// Enters the modes that follow from rates and distances of the external mechanisms that have jumped.
    pub fn enter_motion(&mut self, steps: &mut PlantSteps) {
        let (time, state, mode) = steps.row.reached.parts();
        for m in 0..self.system.plant.mechanisms().len() {
            if matches!(self.system.plant.mechanisms()[m], Mechanism::External { .. }) {
                self.system.enter_jumped_ends(m, *time, state, mode, &mut self.at);
            }
        }
        steps.row.forget_guards();
    }

    /// Writes the usual sizes of the states in the mode that holds, one for each state.
    ///
    /// # Errors
    /// [`Error::Table`] for more or fewer sizes.
    pub fn scales(&self, steps: &PlantSteps, scales: &mut [f64]) -> Result<(), Error> {
        check_count("scales", scales.len(), self.rates.len())?;
        self.system.scales(steps.state(), steps.mode(), scales);
        Ok(())
    }

    /// Writes the derivatives of all rates in the direction `seed` of the states, in the mode that holds: exact.
    ///
    /// # Errors
    /// [`Error::Table`] for more or fewer numbers than states.
    pub fn rates_along(&mut self, steps: &PlantSteps, seed: &[f64], rates: &mut [f64]) -> Result<(), Error> {
        check_count("seed", seed.len(), self.rates.len())?;
        check_count("rates", rates.len(), self.rates.len())?;
        self.seed(steps, |place| seed[place]);
        let time = Along::constant(steps.time());
        self.system.rates(time, &self.seeded, steps.mode(), &mut self.along, &mut self.seeded_rates);
        for (into, rate) in rates.iter_mut().zip(&self.seeded_rates) {
            *into = rate.slope[0];
        }
        Ok(())
    }

    /// Writes the derivatives of the guards in the direction `seed` of the states, zero beyond the guards of the mode; of those
    /// that do not fit none.
    ///
    /// # Errors
    /// [`Error::Table`] for more or fewer numbers than states.
    pub fn guards_along(&mut self, steps: &PlantSteps, seed: &[f64], values: &mut [f64]) -> Result<(), Error> {
        check_count("seed", seed.len(), self.rates.len())?;
        self.seed(steps, |place| seed[place]);
        self.list(steps.mode());
        values.fill(0.0);
        for place in 0..self.guards.len().min(values.len()) {
            values[place] = self.value_along(steps, self.guards[place], 0.0);
        }
        Ok(())
    }

    /// Writes the derivatives of a sample in the direction `seed` of the states: of actuators, coordinates and pressures of
    /// nodes; the rest of the sample stays.
    ///
    /// # Errors
    /// [`Error::Table`] for more or fewer numbers than states.
    pub fn sample_along(&mut self, steps: &PlantSteps, seed: &[f64], sample: &mut PlantSample) -> Result<(), Error> {
        check_count("seed", seed.len(), self.rates.len())?;
        self.seed(steps, |place| seed[place]);
        let (time, mode) = (Along::constant(steps.time()), steps.mode());
        self.system.evaluate(time, &self.seeded, mode, &mut self.along);
        for m in 0..self.system.plant.mechanisms().len() {
            self.system.share_tensions(m, &self.seeded, mode, &mut self.along);
        }
        let (plant, at) = (&*self.system.plant, &self.along);
        for (i, its) in sample.actuators.iter_mut().enumerate() {
            let (unit, chamber, air) = (&at.units[i], &at.chambers[i], plant.actuators()[i].actuator.air());
            let rests = mode.actuators[i].mode.length_regime == LengthRegime::Slack;
            let moved = |number: Along| if rests { 0.0 } else { number.slope[0] };
            (its.distance, its.rate) = (unit.distance.slope[0], unit.rate.slope[0]);
            (its.length, its.velocity) = (moved(unit.length), moved(unit.velocity));
            its.pressure.0 = chamber.pressure.slope[0];
            (its.air_mass, its.volume) = (chamber.mass.slope[0], chamber.volume.slope[0]);
            its.temperature = air.temperature(chamber).slope[0];
            its.tension = if unit.tension.value > 0.0 { unit.tension.slope[0] } else { 0.0 };
            its.mass_flow = unit.flow.net().slope[0];
        }
        for (m, its) in sample.mechanisms.iter_mut().enumerate() {
            let (position, rate) = plant.indices().mechanisms[m].of(&self.seeded);
            for k in 0..position.len() {
                (its.position[k], its.rate[k]) = (position[k].slope[0], rate[k].slope[0]);
            }
            its.actuator_force.fill(0.0);
            for &i in &plant.indices().members[m] {
                let tension = at.units[i].tension.larger(Along::constant(0.0));
                for (force, entry) in its.actuator_force.iter_mut().zip(self.system.gradient(i, &at.gradient)) {
                    *force -= (*entry * tension).slope[0];
                }
            }
        }
        for (its, node) in sample.nodes.iter_mut().zip(&at.network.nodes) {
            its.pressure.0 = node.pressure.slope[0];
        }
        Ok(())
    }
}

/// The next instant in s at which something is due; infinite when there is none.
fn next_of(system: &System<f64>, steps: &PlantSteps) -> f64 {
    let mode = steps.mode();
    let instant = system.next_instant(mode, f64::INFINITY).unwrap_or(f64::INFINITY);
    let edge = mode.network.pulse_edge();
    // Something that was set and is not yet laid out is due at once.
    instant.min(if edge == f64::NEG_INFINITY { steps.time() } else { edge })
}

/// That there is one number for each state.
fn check_count(name: &'static str, given: usize, states: usize) -> Result<(), Error> {
    if given == states {
        return Ok(());
    }
    Err(Error::Table {
        name,
        problem: "there is not one number for each state",
        entry: given.min(states) + 1,
        remedy: "give as many numbers as `Plant::indices` has states",
    })
}
