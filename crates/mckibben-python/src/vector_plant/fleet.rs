//! Plants of a file that are stepped together: their commands, their clock, and which begin again.

use super::columns;
use super::file::{Begin, File};
use crate::pace::{Pace, Span};
use mckibben::parameter;
use mckibben::plant::{PlantRow, PlantRun, TimeStepping};
use mckibben_batch::{PlantBatch, Precision};
use mckibben_run::failure::Failure;
use mckibben_run::host::CommandMode;
use rayon::prelude::*;

/// Numbers that the stages of a step keep for each state of a plant, and bytes of what the parts of a plant are.
const PER_STATE: usize = 64;

/// Plants of one file that go through time together. An error stands with the number of its plant.
pub(super) struct Fleet {
    file: File,
    /// The file's plant at t = 0, and it as a row, which plants that are alike begin as.
    first: PlantRun,
    row: PlantRow,
    pace: Pace,
    batch: PlantBatch,
    /// Room for the ends of steps, and for the states of one plant.
    ends: Vec<f64>,
    state: Vec<f64>,
}

impl Fleet {
    /// None yet, of this file.
    pub(super) fn new(file: File, precision: Precision) -> Result<Self, Failure> {
        let first = run(&file, file.begin()).map_err(|error| file.failed(&error))?;
        let none = std::iter::empty::<PlantRow>();
        let batch = PlantBatch::with_precision(none, precision).map_err(|error| file.failed(&error))?;
        let (row, state) = (first.row(file.method()), first.state().to_vec());
        Ok(Self { file, first, row, pace: Pace::default(), batch, ends: Vec::new(), state })
    }

    /// The file.
    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// The numbers that the plants are stepped in.
    pub(super) fn precision(&self) -> Precision {
        self.batch.precision()
    }

    /// How many valves actions go to.
    pub(super) fn valves(&self) -> usize {
        self.file.valves.len()
    }

    /// Bytes that each takes at least.
    pub(super) fn bytes(&self) -> usize {
        size_of::<PlantRow>() + PER_STATE * size_of::<f64>() * self.first.state().len()
    }

    /// A plant with these values, which begins at a time in s.
    fn begun(&self, values: &[f64], time: f64) -> Result<PlantRow, Failure> {
        if self.file.are_alike() && time == 0.0 {
            return Ok(self.row.clone());
        }
        let begun = if self.file.are_alike() {
            self.first.begin_again(&self.file.begin().start, time)
        } else {
            let begin = self.file.with(values)?;
            run(&self.file, &begin).and_then(|run| match time {
                0.0 => Ok(run),
                time => run.begin_again(&begin.start, time),
            })
        };
        begun.map(|run| run.row(self.file.method())).map_err(|error| self.file.failed(&error))
    }

    /// Those plants that have these numbers, with these values, which begin at a time in s.
    fn begun_rows(
        &self,
        rows: &[(usize, &[f64])],
        time: f64,
        keeps: bool,
    ) -> Result<Vec<(usize, PlantRow)>, (usize, Failure)> {
        let begun = |(row, values): &(usize, &[f64])| match self.begun(values, time) {
            Ok(begun) => Ok((*row, begun)),
            Err(failure) => Err((*row, failure)),
        };
        match keeps {
            true => rows.iter().map(begun).collect(),
            false => rows.par_iter().map(begun).collect(),
        }
    }

    /// All begin at t = 0, as many as there are rows of values, on the threads of the pool or on the caller's own.
    pub(super) fn begin(&mut self, values: &[&[f64]], keeps: bool) -> Result<(), (usize, Failure)> {
        let rows: Vec<(usize, &[f64])> = values.iter().copied().enumerate().collect();
        let rows = self.begun_rows(&rows, 0.0, keeps)?.into_iter().map(|(_, row)| row);
        self.batch.replace(rows).map_err(|error| (0, self.file.failed(&error)))?;
        self.pace = Pace::default();
        Ok(())
    }

    /// Some begin again, with nothing commanded of their valves, on the threads of the pool or on the caller's own; the others go on.
    pub(super) fn restart(&mut self, rows: &[(usize, &[f64])], keeps: bool) -> Result<(), (usize, Failure)> {
        let begun = self.begun_rows(rows, self.batch.time(), keeps)?;
        for (row, its) in begun {
            self.batch.restart(row, its).map_err(|error| (row, self.file.failed(&error)))?;
        }
        Ok(())
    }

    /// Whether so many steps of all take much longer than to wake other threads.
    pub(super) fn is_much(&self, steps: u64) -> bool {
        self.batch.is_much(steps as usize)
    }

    /// From now on the caller's own thread steps all, or the threads of the pool share them.
    pub(super) fn keep_to_thread(&mut self, keeps: bool) {
        self.batch.keep_to_thread(keeps);
    }

    /// Whether the valves can be commanded this: a number for each valve of each plant, or of that of the file where there are none.
    pub(super) fn check(&self, actions: &[f64]) -> Result<(), (usize, Failure)> {
        let valves = self.valves().max(1);
        // Duty cycles within their range differ in nothing that a valve would mind.
        let actions = match self.file.modes.first() {
            Some(CommandMode::Duty(_)) if actions.iter().all(|duty| parameter::DUTY.range.contains(*duty)) => {
                &actions[..actions.len().min(valves)]
            }
            _ => actions,
        };
        for (row, actions) in actions.chunks(valves).enumerate() {
            let network = self.batch.plant(row).unwrap_or(&self.file.begin().plant).network();
            let its = self.file.valves.iter().zip(&self.file.modes).zip(&self.file.owners);
            for (number, ((valve, mode), owner)) in actions.iter().zip(its) {
                let commanded = mode.command(*number);
                let checked = commanded.and_then(|commanded| network.check_command(*valve, &commanded));
                let of_valve = |failure: Failure| match valves {
                    1 => failure,
                    _ => failure.of(&format!("the valve of {owner}")),
                };
                checked.map_err(|error| (row, of_valve(error.into())))?;
            }
        }
        Ok(())
    }

    /// The least and the greatest command of each valve of each plant: all least ones first.
    pub(super) fn command_range(&self) -> Vec<f64> {
        let of_row = |row: usize| {
            let network = self.batch.plant(row).unwrap_or(&self.file.begin().plant).network();
            let mode = |(valve, mode): (&usize, &CommandMode)| {
                network.feed_of(*valve).map_or(*mode, |feed| mode.fed_at(feed)).range()
            };
            self.file.valves.iter().zip(&self.file.modes).map(mode)
        };
        let ranges: Vec<_> = (0..self.batch.len()).flat_map(of_row).collect();
        let ends = ranges.iter().map(|(low, ..)| *low).chain(ranges.iter().map(|(_, high, _)| *high));
        ends.collect()
    }

    /// Sets the valves to what has been checked, goes on, and writes the columns, and which have left the physics and stopped:
    /// of those nothing is written.
    pub(super) fn step(&mut self, span: Span, actions: &[f64], observations: &mut [f64], stopped: &mut [bool]) {
        let Self { file, pace, batch, ends, state, .. } = self;
        let width = file.valves.len();
        for (place, (valve, mode)) in file.valves.iter().zip(&file.modes).enumerate() {
            // They have been checked.
            let _ = batch.set_each(*valve, |row| mode.command(actions[width * row + place]).ok());
        }
        *pace = pace.on(span);
        ends.clear();
        ends.extend((1..=span.steps).map(|step| pace.within(span, step)));
        // The times are finite and rise, which has been checked.
        let _ = batch.advance_through(ends);
        let width = file.columns.len().max(1);
        for (row, (observations, stopped)) in observations.chunks_mut(width).zip(stopped).enumerate() {
            *stopped = columns::write(&file.columns, (&mut *batch, row), state, observations).is_err();
        }
    }

    /// Whether plants with these two sets of values differ in anything but the commands of their valves.
    pub(super) fn differ(&self, [one, other]: [&[f64]; 2]) -> Result<bool, Failure> {
        Ok(self.file.with(one)? != self.file.with(other)?)
    }

    /// The time in s, which pulses follow.
    pub(super) fn time(&self) -> f64 {
        self.pace.now()
    }

    /// Writes the columns of one; nothing where it has stopped.
    pub(super) fn observe(&mut self, row: usize, into: &mut [f64]) {
        let Self { file, batch, state, .. } = self;
        // What has stopped has no observation.
        let _ = columns::write(&file.columns, (batch, row), state, into);
    }
}

/// A run of a plant from t = 0 by the file's steps.
fn run(file: &File, begin: &Begin) -> Result<PlantRun, mckibben::Error> {
    PlantRun::new(&begin.plant, &begin.start, TimeStepping::Fixed { method: file.method(), step: file.step })
}
