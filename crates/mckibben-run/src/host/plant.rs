//! One scenario that a host steps.

use super::model::{CommandInput, HostModel, HostOptions, Motion};
use crate::failure::Failure;
use mckibben::plant::{PlantSampler, PlantSteps};
use mckibben::{Error, Response, limit};
use mckibben_scenario::Document;
use std::ops::Deref;
use std::sync::Arc;

/// A scenario that a host steps: its [`HostModel`], and where it is.
#[derive(Debug)]
pub struct HostPlant {
    pub(super) model: Arc<HostModel>,
    pub(super) steps: PlantSteps,
    sampler: PlantSampler,
    /// Where the scenario's steps began, to return there if one fails.
    before: Vec<f64>,
}

impl Clone for HostPlant {
    fn clone(&self) -> Self {
        Self::of(Arc::clone(&self.model), self.steps.clone())
    }
}

impl Deref for HostPlant {
    type Target = HostModel;

    fn deref(&self) -> &HostModel {
        &self.model
    }
}

impl HostPlant {
    /// Reads the plant of a scenario. The actuators' own commands and the controllers are not used; supplies follow theirs.
    ///
    /// # Errors
    /// Every mistake in the scenario, with its place; a mode that a valve does not take; an option that is out of
    /// range.
    pub fn read(document: &Document, options: &HostOptions<'_>) -> Result<Self, Failure> {
        let model = HostModel::read(document, options)?;
        let steps = model.begin().map_err(|error| Failure::of_core(&error, document))?;
        Ok(Self::of(Arc::new(model), steps))
    }

    /// A plant where these steps are.
    pub(super) fn of(model: Arc<HostModel>, mut steps: PlantSteps) -> Self {
        let (sampler, before) = (PlantSampler::new(&steps), vec![0.0; steps.state_size()]);
        Self { model, steps, sampler, before }
    }

    /// The plant where it is.
    pub fn steps(&self) -> &PlantSteps {
        &self.steps
    }

    /// The plant where it is, to be computed.
    pub fn steps_mut(&mut self) -> &mut PlantSteps {
        &mut self.steps
    }

    /// The distance in m between the ends of an actuator whose ends the host moves, with its tendon.
    pub fn distance(&self, actuator: usize) -> f64 {
        self.steps.state()[self.steps.plant().indices().mechanisms[0].position(actuator)]
    }

    /// Sets what a valve does from now on. A number that it has been set to already changes nothing.
    ///
    /// # Errors
    /// When there is no such valve, and for a number that it does not take, with those that it takes. Then nothing has changed.
    pub fn command(&mut self, input: usize, number: f64) -> Result<(), Failure> {
        let command = self.model.check_command(input, number)?;
        let CommandInput { name, valve, .. } = self.model.input(input)?;
        self.steps.set(*valve, command).map_err(|error| Failure::from(error).of(name))
    }

    /// Goes on to `until` in s; the ends go in straight lines to `distances` in m: one for each actuator, none where the scenario
    /// moves. Nothing where that time has been reached.
    ///
    /// # Errors
    /// For a distance that an actuator cannot have, a time that is not later, more than ten million steps of the scenario, and
    /// when the plant leaves the physics. Then the plant is where it was.
    pub fn advance(&mut self, until: f64, distances: &[f64]) -> Result<(), Failure> {
        match self.model.motion() {
            Motion::Host => {
                self.check_move(until, distances)?;
                Ok(self.steps.move_to(until, distances)?)
            }
            Motion::Scenario => {
                self.model.check_count("distances", distances.len())?;
                self.go_on(until)
            }
        }
    }

    /// That the ends can go to `distances` in m until a time in s.
    fn check_move(&self, until: f64, distances: &[f64]) -> Result<(), Failure> {
        self.model.check_count("distances", distances.len())?;
        let from = self.steps.time();
        self.model.check_time(from, until)?;
        for (actuator, distance) in distances.iter().enumerate() {
            self.model.check_distance(actuator, *distance)?;
            self.model.check_rate(actuator, (distance - self.distance(actuator)) / (until - from))?;
        }
        Ok(())
    }

    /// Goes on by the scenario's own steps.
    fn go_on(&mut self, until: f64) -> Result<(), Failure> {
        let Self { model, steps, before, .. } = self;
        let mut ends = model.step_ends(steps.time(), until)?;
        // A state with more commands on their way than a row of numbers has places for is kept as it is.
        let kept = steps.save_to(before).is_err().then(|| steps.save());
        let gone = ends.try_for_each(|end| steps.advance_to(end));
        if gone.is_err() {
            match kept {
                Some(kept) => steps.restore(&kept)?,
                None => steps.restore_from(before)?,
            }
        }
        Ok(gone?)
    }

    /// Begins again at t = 0, with the ends of all actuators at `distances` in m and moving at `rates` in m/s, and all else as the
    /// scenario starts. Allocates.
    ///
    /// # Errors
    /// For distances that the actuators cannot have, and where the scenario moves the ends.
    pub fn begin_at(&mut self, distances: &[f64], rates: &[f64]) -> Result<(), Failure> {
        self.steps = self.model.steps_of(self.model.begin_at(distances, rates, &[], 0.0)?)?;
        Ok(())
    }

    /// Begins again as [`HostPlant::begin_at`], with the gauge pressure in Pa of each actuator in place of that of the scenario
    /// where one is given. Hoses begin at the pressure of the actuator that they lead to. Allocates.
    ///
    /// # Errors
    /// As there, and for a pressure that is none.
    pub fn begin_with_pressures(
        &mut self,
        distances: &[f64],
        rates: &[f64],
        gauges: &[Option<f64>],
    ) -> Result<(), Failure> {
        self.steps = self.model.steps_of(self.model.begin_at(distances, rates, gauges, 0.0)?)?;
        Ok(())
    }

    /// Returns to where the plant began.
    pub fn reset(&mut self) {
        self.steps.reset();
    }

    /// Responses of all actuators with the ends at `distances` in m and moving at `rates` in m/s: see
    /// [`PlantSteps::compute_at`].
    ///
    /// # Errors
    /// As there.
    pub fn compute_at(&mut self, distances: &[f64], rates: &[f64], responses: &mut [Response]) -> Result<(), Failure> {
        self.model.check_ends(distances, rates)?;
        self.model.check_reach(distances)?;
        Ok(self.steps.compute_at(distances, rates, responses)?)
    }

    /// Writes the outputs where the plant is.
    ///
    /// # Errors
    /// Unless there is one number for each of [`HostModel::outputs`].
    pub fn read_outputs(&mut self, into: &mut [f64]) -> Result<(), Failure> {
        let sample = self.sampler.read(&self.steps, self.steps.time());
        self.model.write_outputs((self.steps.plant(), sample), into)
    }

    /// Writes the outputs that follow from the states as a host that integrates has placed them: see
    /// [`PlantSampler::read_placed`].
    ///
    /// # Errors
    /// As [`HostPlant::read_outputs`].
    pub fn read_placed_outputs(&mut self, into: &mut [f64]) -> Result<(), Failure> {
        let sample = self.sampler.read_placed(&self.steps);
        self.model.write_outputs((self.steps.plant(), sample), into)
    }

    /// How many numbers a state is.
    pub fn state_size(&mut self) -> usize {
        self.steps.state_size()
    }

    /// Saves the whole state as numbers: see [`PlantSteps::save_to`].
    ///
    /// # Errors
    /// As there.
    pub fn save(&mut self, numbers: &mut [f64]) -> Result<(), Failure> {
        self.steps.save_to(numbers).map_err(of_saving)
    }

    /// Returns to a state that a plant of the same scenario has saved.
    ///
    /// # Errors
    /// As [`PlantSteps::restore_from`].
    pub fn restore(&mut self, numbers: &[f64]) -> Result<(), Failure> {
        Ok(self.steps.restore_from(numbers)?)
    }
}

/// Why a state cannot be numbers, in the words of a host, which has no other way to keep it.
pub(super) fn of_saving(error: Error) -> Failure {
    if error != Error::NotImplemented(&limit::SAVE_COMMANDS) {
        return error.into();
    }
    Failure::input(
        "more than 64 commands of one valve are on their way, and a state has places for 64",
        "shorten valve.dead_time, or let more time pass between commands that differ, as by longer steps",
    )
}
