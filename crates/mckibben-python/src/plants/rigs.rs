//! Actuators with their loads, in the lanes of a batch.

use super::asked::Asked;
use super::fleet::{Fleet, Pace, Span};
use super::numbers::Numbers;
use mckibben::batch::{Batch, Row};
use mckibben::simulation::{Method, State};
use mckibben_cli::failure::Failure;
use rayon::prelude::*;

const COLUMNS: &[&str] = &["length_m", "velocity_m_s", "pressure_pa", "air_mass_kg"];

/// Actuators with their loads.
pub(super) struct Rigs {
    numbers: Numbers,
    method: Method,
    asked: Asked,
    pace: Pace,
    batch: Batch,
}

impl Rigs {
    pub(super) fn new(numbers: Numbers, method: Method, asked: Asked) -> Self {
        Self { numbers, method, asked, pace: Pace::default(), batch: Batch::new(Vec::new(), method) }
    }

    fn row(&self, values: &[f64]) -> Result<Row, Failure> {
        let experiment = self.numbers.with(values, |scenario| scenario.experiment())?;
        Ok(Row { rig: experiment.rig, start: experiment.start })
    }
}

impl Fleet for Rigs {
    fn columns(&self) -> Vec<String> {
        COLUMNS.iter().map(|name| (*name).to_owned()).collect()
    }

    fn valves(&self) -> usize {
        1
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
        let wrong = |(row, number): (usize, &f64)| Some((row, self.asked.demand(*number).err()?));
        let wrong = asked.iter().enumerate().find_map(wrong);
        wrong.map_or(Ok(()), |(row, error)| Err((row, self.numbers.failed(&error))))
    }

    fn step(&mut self, span: Span, asked: &[f64]) -> Result<(), Failure> {
        // What is asked has been checked.
        let told = self.batch.tell_all(|row| self.asked.demand(asked[row]).ok());
        told.map_err(|error| self.numbers.failed(&error))?;
        self.pace = self.pace.on(span);
        self.batch.advance(self.pace.now(), span.steps);
        Ok(())
    }

    fn show(&self, row: usize, into: &mut [f64]) -> bool {
        let Ok(State { length, velocity, pressure, air_mass }) = self.batch.state(row) else { return false };
        into.copy_from_slice(&[length, velocity, pressure.0, air_mass]);
        true
    }
}
