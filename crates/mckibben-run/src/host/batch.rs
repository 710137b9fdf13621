//! Plants of one kind that a host steps together, side by side in the registers of the processor.
//!
//! All arrays have a row for each plant, one after the other. Each plant is bit-identical to a [`HostPlant`] alone, on any
//! number of threads.
//!
//! What does not fit is refused before anything has changed. A plant that leaves the physics stops, and touches no other:
//! [`HostBatch::failure`] says why, and [`HostBatch::begin_row`], [`HostBatch::begin_at`] or [`HostBatch::restore`] bring it back.
//!
//! Checked by `tests/host/batch.rs`.

use super::model::{HostModel, Motion};
use super::plant::{HostPlant, of_saving};
use crate::failure::Failure;
use mckibben::plant::{PlantRow, PlantSampler};
use mckibben::{Error, Response};
use mckibben_batch::{PlantBatch, Precision};
use rayon::prelude::*;
use std::sync::Arc;

/// Plants whose outputs a thread reads one after the other.
const READ_TOGETHER: usize = 64;

/// Plants that a host steps together.
#[derive(Debug)]
pub struct HostBatch {
    models: Vec<Arc<HostModel>>,
    batch: PlantBatch,
    /// Where the ends of all plants are in m and how they move in m/s.
    ends: [Vec<f64>; 2],
    /// The ends of the scenario's own steps in s.
    steps: Vec<f64>,
    /// That of the plant whose outputs were read last on the caller's thread.
    sampler: Sampler,
    state_size: usize,
}

/// Reads the outputs of plants of one model, if there is one.
type Sampler = Option<(Arc<HostModel>, PlantSampler)>;

impl Clone for HostBatch {
    fn clone(&self) -> Self {
        let Self { models, batch, ends, steps, sampler: _, state_size } = self;
        Self {
            models: models.clone(),
            batch: batch.clone(),
            ends: ends.clone(),
            steps: steps.clone(),
            sampler: None,
            state_size: *state_size,
        }
    }
}

impl HostBatch {
    /// Plants that go on together from where they are. They are of one scenario, or of scenarios that differ in numbers.
    ///
    /// # Errors
    /// Where there is no plant, and where they differ in time, actuators, valves, outputs, states or steps.
    pub fn new(plants: impl IntoIterator<Item = HostPlant>) -> Result<Self, Failure> {
        Self::with_precision(plants, Precision::Double)
    }

    /// Plants that go on together as in [`HostBatch::new`], in numbers of a precision.
    ///
    /// # Errors
    /// As there, and where this program is built without that precision.
    pub fn with_precision(plants: impl IntoIterator<Item = HostPlant>, precision: Precision) -> Result<Self, Failure> {
        Self::of(&mut plants.into_iter(), precision)
    }

    fn of(plants: &mut dyn Iterator<Item = HostPlant>, precision: Precision) -> Result<Self, Failure> {
        let (mut models, mut state_size): (Vec<Arc<HostModel>>, usize) = (Vec::new(), 0);
        let mut differs = None;
        // Each is taken when the batch asks for it: what a plant computes with is there once at a time.
        let rows = plants.map_while(|mut plant| {
            let size = plant.state_size();
            if let Some(first) = models.first() {
                let of_kind = if Arc::ptr_eq(&plant.model, first) { None } else { plant.model.difference(first) };
                differs = of_kind.or_else(|| {
                    (size != state_size).then(|| {
                        let title = format!("its state is {size} numbers, that of the first plant {state_size}");
                        (title, "let them have equal parts, and a dead time of zero in all of them or in none")
                    })
                });
            }
            state_size = size;
            models.push(plant.model);
            differs.is_none().then_some(plant.steps)
        });
        let made = PlantBatch::with_precision(rows, precision);
        if let Some((title, help)) = differs {
            return Err(Failure::input(title, help).of(&format!("plant {}", models.len() - 1)));
        }
        let (mut batch, Some(first)) = (made?, models.first()) else {
            return Err(Failure::input("there is no plant to step", "give one or more"));
        };
        batch.limit_step(first.longest)?;
        let ends = all_ends(first, &mut batch);
        Ok(Self { models, batch, ends, steps: Vec::new(), sampler: None, state_size })
    }

    /// How many plants there are.
    pub fn count(&self) -> usize {
        self.models.len()
    }

    /// What the first plant is for a host: names, commands and outputs are those of all.
    pub fn model(&self) -> &HostModel {
        &self.models[0]
    }

    /// The time in s that all plants have reached which have not stopped.
    pub fn time(&self) -> f64 {
        self.batch.time()
    }

    /// The distances in m between the ends of all actuators whose ends the host moves; none where the scenario moves them.
    pub fn distances(&self) -> &[f64] {
        &self.ends[0]
    }

    /// Whether the caller's own thread does all: see [`PlantBatch::keep_to_thread`].
    pub fn keep_to_thread(&mut self, keeps: bool) {
        self.batch.keep_to_thread(keeps);
    }

    /// Whether a step of all plants takes much longer than to wake other threads.
    pub fn is_much(&self) -> bool {
        self.batch.is_much(1)
    }

    /// Sets what the valves do from now on: one number for each command of each plant. Those of plants that have stopped are not
    /// used.
    ///
    /// # Errors
    /// Unless there are as many, and for a number that a valve does not take. Then nothing has changed.
    pub fn command(&mut self, numbers: &[f64]) -> Result<(), Failure> {
        let inputs = self.model().commands().len();
        self.check_count("commands", numbers.len(), inputs)?;
        if inputs == 0 {
            return Ok(());
        }
        for (row, (model, numbers)) in self.models.iter().zip(numbers.chunks(inputs)).enumerate() {
            for (input, number) in numbers.iter().enumerate() {
                model.check_command(input, *number).map_err(|failure| self.of_row(failure, row))?;
            }
        }
        let Self { models, batch, .. } = self;
        for input in 0..inputs {
            let valve = models[0].commands()[input].valve;
            let command = |row: usize| models[row].commands()[input].mode.command(numbers[inputs * row + input]).ok();
            batch.set_each(valve, command).map_err(|(row, error)| of_row(error.into(), row, models.len()))?;
        }
        Ok(())
    }

    /// Goes on to `until` in s; the ends go in straight lines to `distances` in m: one for each actuator of each plant, none where
    /// the scenario moves. Nothing where that time has been reached.
    ///
    /// # Errors
    /// Unless there are as many distances; for one that is none, a time that is not later, and more than ten million parts of a
    /// step. Then nothing has changed.
    pub fn advance(&mut self, until: f64, distances: &[f64]) -> Result<(), Failure> {
        let from = self.time();
        if self.model().motion() == Motion::Scenario {
            self.model().check_count("distances", distances.len())?;
            self.steps.clear();
            self.steps.extend(self.models[0].step_ends(from, until)?);
            if !self.steps.is_empty() {
                self.batch.advance_through(&self.steps)?;
            }
            return Ok(());
        }
        self.model().check_time(from, until)?;
        let span = until - from;
        self.check_count("distances", distances.len(), self.model().distance_count())?;
        self.each_of(distances, HostModel::check_distance)?;
        for (place, (to, at)) in distances.iter().zip(&self.ends[0]).enumerate() {
            self.of_place(place, self.model().check_rate(place, (to - at) / span))?;
        }
        self.batch.move_to(until, distances)?;
        let [at, rates] = &mut self.ends;
        for ((at, rate), to) in at.iter_mut().zip(rates).zip(distances) {
            (*at, *rate) = (*to, (to - *at) / span);
        }
        Ok(())
    }

    /// Computes the responses of all actuators with the ends at `distances` in m and moving at `rates` in m/s.
    /// [`HostBatch::responses`] has them.
    ///
    /// # Errors
    /// Unless there is one of each for each actuator whose ends the host moves, and for one that is none.
    pub fn compute_at(&mut self, distances: &[f64], rates: &[f64]) -> Result<(), Failure> {
        self.check_ends(distances, rates)?;
        for (row, (model, distances)) in self.models.iter().zip(distances.chunks(self.width())).enumerate() {
            if self.batch.fault(row).is_none() {
                model.check_reach(distances).map_err(|failure| self.of_row(failure, row))?;
            }
        }
        Ok(self.batch.compute_at(distances, rates)?)
    }

    /// Computes the responses of all actuators where the ends are, and while they move as they do now.
    ///
    /// # Errors
    /// As [`HostBatch::compute_at`].
    pub fn compute(&mut self) -> Result<(), Failure> {
        let [distances, rates] = &self.ends;
        Ok(self.batch.compute_at(distances, rates)?)
    }

    /// The responses of a plant that were computed last.
    ///
    /// # Errors
    /// What has stopped the plant.
    pub fn responses(&self, row: usize) -> Result<&[Response], Failure> {
        self.batch.responses(row).map_err(|error| self.of_row(error.into(), row))
    }

    /// What has stopped a plant.
    pub fn failure(&self, row: usize) -> Option<Failure> {
        self.batch.fault(row).map(|error| self.of_row(error.into(), row))
    }

    /// What has stopped the first plant that has stopped.
    pub fn first_failure(&self) -> Option<Failure> {
        (0..self.count()).find_map(|row| self.failure(row))
    }

    /// Writes the outputs of all plants; nothing of those that have stopped.
    ///
    /// # Errors
    /// Unless there is one number for each output of each plant.
    pub fn read_outputs(&mut self, into: &mut [f64]) -> Result<(), Failure> {
        let width = self.model().outputs().len();
        self.check_count("outputs", into.len(), width)?;
        let is_shared = !self.batch.keeps_to_thread() && self.is_much();
        let Self { models, batch, sampler, .. } = self;
        let (rows, width) = (batch.rows(), width.max(1));
        let read =
            |sampler: &mut Sampler, models: &[Arc<HostModel>], rows: &[Result<&PlantRow, Error>], into: &mut [f64]| {
                for ((model, row), into) in models.iter().zip(rows).zip(into.chunks_mut(width)) {
                    let Ok(row) = row else { continue };
                    if !sampler.as_ref().is_some_and(|(of, _)| Arc::ptr_eq(of, model)) {
                        *sampler = Some((Arc::clone(model), PlantSampler::new(row)));
                    }
                    if let Some((_, sampler)) = sampler {
                        model.write_outputs((row.plant(), sampler.read(row, row.time())), into)?;
                    }
                }
                Ok(())
            };
        if !is_shared {
            return read(sampler, models, &rows, into);
        }
        let parts = models.par_chunks(READ_TOGETHER).zip(rows.par_chunks(READ_TOGETHER));
        let parts = parts.zip(into.par_chunks_mut(READ_TOGETHER * width));
        parts.try_for_each(|((models, rows), into)| read(&mut None, models, rows, into))
    }

    /// A plant, where it is.
    ///
    /// # Errors
    /// What has stopped the plant.
    pub fn plant(&mut self, row: usize) -> Result<HostPlant, Failure> {
        let count = self.count();
        let its = self.batch.row(row).map_err(|error| of_row(error.into(), row, count))?;
        let model = Arc::clone(&self.models[row]);
        let steps = model.steps_of(its.clone())?;
        Ok(HostPlant::of(model, steps))
    }

    /// All begin again at t = 0, with the ends at `distances` in m and moving at `rates` in m/s: see [`HostPlant::begin_at`].
    ///
    /// # Errors
    /// As there. Then nothing has changed.
    pub fn begin_at(&mut self, distances: &[f64], rates: &[f64]) -> Result<(), Failure> {
        self.check_ends(distances, rates)?;
        let each = self.model().distance_count();
        let begin = |(row, model): (usize, &Arc<HostModel>)| {
            let its = each * row..each * (row + 1);
            let begun = model.begin_at(&distances[its.clone()], &rates[its], &[], 0.0);
            begun.map_err(|failure| self.of_row(failure, row))
        };
        let begun: Result<Vec<PlantRow>, Failure> = match self.batch.keeps_to_thread() {
            true => self.models.iter().enumerate().map(begin).collect(),
            false => self.models.par_iter().enumerate().map(begin).collect(),
        };
        self.batch.replace(begun?)?;
        self.ends = all_ends(&self.models[0], &mut self.batch);
        Ok(())
    }

    /// One plant begins again now, while the others go on; its valves are commanded nothing.
    ///
    /// # Errors
    /// As [`HostBatch::begin_at`], and where there is no such plant. Then nothing has changed.
    pub fn begin_row(&mut self, row: usize, distances: &[f64], rates: &[f64]) -> Result<(), Failure> {
        let Some(model) = self.models.get(row) else {
            return Err(Failure::input(
                format!("there is no plant {row}: the batch has {}", self.count()),
                "count the plants from 0",
            ));
        };
        for (name, numbers) in [("distances", distances), ("rates", rates)] {
            check_count(name, numbers.len(), model.distance_count())?;
        }
        let begun = model.begin_at(distances, rates, &[], self.time()).map_err(|failure| self.of_row(failure, row))?;
        self.batch.restart(row, begun)?;
        let its = distances.len() * row..distances.len() * (row + 1);
        for (ends, new) in self.ends.iter_mut().zip([distances, rates]) {
            ends[its.clone()].copy_from_slice(new);
        }
        Ok(())
    }

    /// How many numbers the state of a plant is.
    pub fn state_size(&self) -> usize {
        self.state_size
    }

    /// Saves the states of all plants as numbers: see [`HostPlant::save`].
    ///
    /// # Errors
    /// As there, unless there is room for [`HostBatch::state_size`] numbers of each plant, and what has stopped a plant.
    pub fn save(&mut self, numbers: &mut [f64]) -> Result<(), Failure> {
        let (size, count) = (self.state_size, self.count());
        self.check_count("numbers of states", numbers.len(), size)?;
        for (row, numbers) in numbers.chunks_mut(size).enumerate() {
            self.batch.save(row, numbers).map_err(|error| of_row(of_saving(error), row, count))?;
        }
        Ok(())
    }

    /// Brings all plants to states of one time that plants of the same scenarios have saved.
    ///
    /// # Errors
    /// As [`HostPlant::restore`], and where the states are of different times. Then nothing has changed.
    pub fn restore(&mut self, numbers: &[f64]) -> Result<(), Failure> {
        self.check_count("numbers of states", numbers.len(), self.state_size)?;
        let Self { models, batch, ends, state_size, .. } = self;
        let mut first = None;
        batch.change(|row, steps| {
            let its = &numbers[*state_size * row..*state_size * (row + 1)];
            let taken = steps.restore_from(its).map_err(Failure::from);
            let (time, first) = (steps.time(), *first.get_or_insert(steps.time()));
            let is_of_one_time = || match time == first {
                true => Ok(()),
                false => Err(Failure::input(
                    format!(
                        "the states are of different times: this one of {time:?} s, that of plant 0 of {first:?} s"
                    ),
                    "give states that were saved together; to begin one plant again, restart it alone",
                )),
            };
            taken.and_then(|()| is_of_one_time()).map_err(|failure| of_row(failure, row, models.len()))
        })?;
        *ends = all_ends(&models[0], batch);
        Ok(())
    }

    /// That there are so many numbers for each plant.
    fn check_count(&self, name: &str, given: usize, each: usize) -> Result<(), Failure> {
        check_count(name, given, self.count() * each)
    }

    /// That there is a distance and a rate for each actuator whose ends the host moves.
    fn check_ends(&self, distances: &[f64], rates: &[f64]) -> Result<(), Failure> {
        for (name, numbers) in [("distances", distances), ("rates", rates)] {
            self.check_count(name, numbers.len(), self.model().distance_count())?;
        }
        self.each_of(distances, HostModel::check_distance)?;
        self.each_of(rates, HostModel::check_rate)
    }

    /// That something holds for the numbers of all actuators, by their places.
    fn each_of(
        &self,
        numbers: &[f64],
        check: impl Fn(&HostModel, usize, f64) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        (0..).zip(numbers).try_for_each(|(place, number)| self.of_place(place, check(self.model(), place, *number)))
    }

    /// What was found of an actuator, by its place among those of all plants.
    fn of_place(&self, place: usize, found: Result<(), Failure>) -> Result<(), Failure> {
        found.map_err(|failure| self.of_row(failure, place / self.width()))
    }

    /// Numbers that a plant has of its ends.
    fn width(&self) -> usize {
        self.model().distance_count().max(1)
    }

    fn of_row(&self, failure: Failure, row: usize) -> Failure {
        of_row(failure, row, self.count())
    }
}

/// A failure of one of so many plants.
fn of_row(failure: Failure, row: usize, count: usize) -> Failure {
    if count == 1 { failure } else { failure.of(&format!("plant {row}")) }
}

/// That there are so many numbers.
fn check_count(name: &str, given: usize, due: usize) -> Result<(), Failure> {
    if given == due {
        return Ok(());
    }
    Err(Failure::input(
        format!("{given} {name} are given for {due}"),
        "give one row for each plant, one after the other",
    ))
}

/// Where the ends of all plants are that a host moves, and how fast they move, one plant after the other.
fn all_ends(model: &HostModel, batch: &mut PlantBatch) -> [Vec<f64>; 2] {
    match model.motion() {
        Motion::Host => {
            batch.rows().into_iter().flatten().flat_map(ends_of).map(|ends| (ends[0], ends[1])).unzip().into()
        }
        Motion::Scenario => [Vec::new(), Vec::new()],
    }
}

/// Where the ends are that a host moves and how fast they move, one after the other.
fn ends_of(row: &PlantRow) -> impl Iterator<Item = [f64; 2]> + '_ {
    let here = row.plant().indices().mechanisms[0];
    (0..here.coordinates).map(move |k| [row.state()[here.position(k)], row.state()[here.rate(k)]])
}
