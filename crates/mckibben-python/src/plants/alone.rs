//! Plants that go through time each by itself: joints and legs.

use super::asked::Asked;
use super::fleet::{Fleet, Span};
use mckibben::Error;
use mckibben::control::Drive;
use mckibben_cli::failure::Failure;
use rayon::prelude::*;

/// Rows that a thread takes together at least.
const TOGETHER: usize = 4;

/// How plants of a kind are made, driven, stepped and shown, `VALVES` valves each.
pub(super) trait Kind<const VALVES: usize>: Send + Sync {
    /// One of them.
    type Plant: Send + Sync;

    fn columns(&self) -> Vec<String>;

    /// One with its values at t = 0.
    fn begin(&self, values: &[f64]) -> Result<Self::Plant, Failure>;

    fn drive(plant: &mut Self::Plant, drives: [Drive; VALVES]) -> Result<(), Error>;

    fn time(plant: &Self::Plant) -> f64;

    fn advance_to(plant: &mut Self::Plant, until: f64) -> Result<(), Error>;

    fn show(plant: &Self::Plant, into: &mut [f64]);

    /// An error of the core, in the scenario's words.
    fn failed(&self, error: &Error) -> Failure;
}

/// Plants of a kind, each with a clock of its own, and whether it has stopped.
pub(super) struct Alone<K: Kind<VALVES>, const VALVES: usize> {
    kind: K,
    asked: Asked,
    plants: Vec<(K::Plant, bool)>,
}

impl<K: Kind<VALVES>, const VALVES: usize> Alone<K, VALVES> {
    pub(super) fn new(kind: K, asked: Asked) -> Self {
        Self { kind, asked, plants: Vec::new() }
    }

    fn drives(&self, asked: &[f64]) -> Result<[Drive; VALVES], Error> {
        let mut drives = [Drive::Steady(mckibben::valve::Request::Hold); VALVES];
        for (drive, number) in drives.iter_mut().zip(asked) {
            *drive = self.asked.drive(*number)?;
        }
        Ok(drives)
    }
}

impl<K: Kind<VALVES>, const VALVES: usize> Fleet for Alone<K, VALVES> {
    fn columns(&self) -> Vec<String> {
        self.kind.columns()
    }

    fn valves(&self) -> usize {
        VALVES
    }

    fn begin(&mut self, values: &[&[f64]]) -> Result<(), (usize, Failure)> {
        let of_row = |(row, values): (usize, &&[f64])| {
            let plant = self.kind.begin(values).map_err(|failure| (row, failure))?;
            Ok((plant, false))
        };
        self.plants = values.par_iter().enumerate().map(of_row).collect::<Result<_, _>>()?;
        Ok(())
    }

    fn restart(&mut self, row: usize, values: &[f64]) -> Result<(), Failure> {
        self.plants[row] = (self.kind.begin(values)?, false);
        Ok(())
    }

    fn check(&self, asked: &[f64]) -> Result<(), (usize, Failure)> {
        let wrong = |(row, asked): (usize, &[f64])| Some((row, self.drives(asked).err()?));
        let wrong = asked.chunks(VALVES).enumerate().find_map(wrong);
        wrong.map_or(Ok(()), |(row, error)| Err((row, self.kind.failed(&error))))
    }

    fn step(&mut self, span: Span, asked: &[f64]) -> Result<(), (usize, Failure)> {
        let mut plants = core::mem::take(&mut self.plants);
        let of_row = |(row, ((plant, stopped), asked)): (usize, (&mut (K::Plant, bool), &[f64]))| {
            if *stopped {
                return Ok(());
            }
            self.drives(asked).and_then(|drives| K::drive(plant, drives)).map_err(|error| (row, error))?;
            let from = K::time(plant);
            let part = |step: u64| from + span.duration * (step as f64 / span.steps as f64);
            *stopped = (1..=span.steps).try_for_each(|step| K::advance_to(plant, part(step))).is_err();
            Ok(())
        };
        let rows = plants.par_iter_mut().zip(asked.par_chunks(VALVES)).enumerate().with_min_len(TOGETHER);
        let went = rows.map(of_row).collect::<Result<(), _>>();
        self.plants = plants;
        went.map_err(|(row, error)| (row, self.kind.failed(&error)))
    }

    fn show(&self, row: usize, into: &mut [f64]) -> bool {
        let (plant, stopped) = &self.plants[row];
        if !stopped {
            K::show(plant, into);
        }
        !stopped
    }
}
