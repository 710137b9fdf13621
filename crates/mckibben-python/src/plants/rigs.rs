//! Actuators with their loads, in the lanes of a batch.

use super::asked::Asked;
use super::fleet::{Fleet, Pace, Span};
use super::numbers::Numbers;
use mckibben::batch::{Batch, Row};
use mckibben::parameter;
use mckibben::simulation::Method;
use mckibben::valve::Solenoid;
use mckibben_cli::failure::Failure;
use rayon::prelude::*;
use std::sync::OnceLock;

const COLUMNS: &[&str] = &["length_m", "velocity_m_s", "pressure_pa", "air_mass_kg"];

/// Actuators with their loads.
pub(super) struct Rigs {
    numbers: Numbers,
    method: Method,
    asked: Asked,
    /// What valves can do, whatever their numbers.
    valve: Option<Solenoid>,
    /// The row that all are, where none has values of its own.
    only: OnceLock<Row>,
    pace: Pace,
    batch: Batch,
}

impl Rigs {
    pub(super) fn new(numbers: Numbers, method: Method, asked: Asked, valve: Option<Solenoid>) -> Self {
        Self {
            numbers,
            method,
            asked,
            valve,
            only: OnceLock::new(),
            pace: Pace::default(),
            batch: Batch::new(Vec::new(), method),
        }
    }

    fn row(&self, values: &[f64]) -> Result<Row, Failure> {
        if let Some(row) = self.only.get() {
            return Ok(row.clone());
        }
        let experiment = self.numbers.with(values, |scenario| scenario.experiment())?;
        let row = Row { rig: experiment.rig, start: experiment.start };
        if self.numbers.are_given() {
            // Another thread may have been faster with the same.
            let _ = self.only.set(row.clone());
        }
        Ok(row)
    }
}

impl Fleet for Rigs {
    fn columns(&self) -> Vec<String> {
        COLUMNS.iter().map(|name| (*name).to_owned()).collect()
    }

    fn valves(&self) -> usize {
        1
    }

    fn bytes(&self) -> usize {
        // A row, and what the batch keeps of it.
        2 * size_of::<Row>()
    }

    fn begin(&mut self, values: &[&[f64]]) -> Result<(), (usize, Failure)> {
        let of_row = |(row, values): (usize, &&[f64])| self.row(values).map_err(|failure| (row, failure));
        let rows = values.par_iter().enumerate().map(of_row).collect::<Result<Vec<_>, _>>()?;
        (self.batch, self.pace) = (Batch::new(rows, self.method), Pace::default());
        Ok(())
    }

    fn restart(&mut self, rows: &[(usize, &[f64])]) -> Result<(), (usize, Failure)> {
        let of_row = |(row, values): &(usize, &[f64])| match self.row(values) {
            Ok(anew) => Ok((*row, anew)),
            Err(failure) => Err((*row, failure)),
        };
        let anew = rows.par_iter().map(of_row).collect::<Result<Vec<_>, _>>()?;
        let first = rows.first().map_or(0, |(row, _)| *row);
        self.batch.restart_all(anew).map_err(|error| (first, self.numbers.failed(&error)))
    }

    fn check(&self, asked: &[f64]) -> Result<(), (usize, Failure)> {
        // Duty cycles within their range differ in nothing that a valve would mind.
        let asked = match self.asked {
            Asked::Duty(_) if asked.iter().all(|duty| parameter::DUTY.range.contains(*duty)) => {
                &asked[..asked.len().min(1)]
            }
            _ => asked,
        };
        let can = |demand| self.valve.as_ref().map_or(Ok(()), |valve| valve.check_demand(&demand));
        let wrong = |(row, number): (usize, &f64)| Some((row, self.asked.demand(*number).and_then(can).err()?));
        let wrong = asked.iter().enumerate().find_map(wrong);
        wrong.map_or(Ok(()), |(row, error)| Err((row, error.into())))
    }

    fn step(&mut self, span: Span, asked: &[f64], shown: &mut [f64], stopped: &mut [bool]) {
        self.pace = self.pace.on(span);
        let demand = |row: usize| self.asked.demand(asked[row]).ok();
        // What is asked has been checked, and there are as many places as rows.
        let (shown, _) = shown.as_chunks_mut();
        let _ = self.batch.go(self.pace.now(), span.steps, demand, (shown, stopped));
    }

    fn differ(&self, values: [&[f64]; 2]) -> Result<bool, Failure> {
        let [one, other] = values.map(|values| {
            self.numbers.with(values, |scenario| {
                let mut scenario = scenario.clone();
                scenario.command.clone_from(&self.numbers.base().command);
                let experiment = scenario.experiment()?;
                Ok(format!("{:?} {:?}", experiment.rig, experiment.start))
            })
        });
        Ok(one? != other?)
    }

    fn time(&self, _: usize) -> f64 {
        self.pace.now()
    }

    fn show(&self, row: usize, into: &mut [f64]) {
        if let Ok(state) = self.batch.state(row) {
            into.copy_from_slice(&state.to_array());
        }
    }
}
