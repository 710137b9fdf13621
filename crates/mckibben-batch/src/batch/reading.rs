//! What is known of the rows of a batch.

use super::{ANSWER, PlantBatch};
use crate::group::Group;
use crate::row::{Change, Row, Rows};
use mckibben::internals::NO_ACTUATOR;
use mckibben::plant::{PlantRow, PlantSample, PlantSteps};
use mckibben::{Error, Response};

/// A row is named that the batch has not got.
const NO_ROW: Error = Error::Misuse {
    what: "a row is meant that the batch has not got",
    remedy: "count the rows from zero and stay below their number",
};

impl PlantBatch {
    /// A row, as it is now.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no such row; what stopped it.
    pub fn row(&mut self, row: usize) -> Result<&PlantRow, Error> {
        self.living(row).map(|(row, _)| &*row.steps)
    }

    /// Why a row has stopped.
    pub fn fault(&self, row: usize) -> Option<Error> {
        self.of_living(row).err()
    }

    /// Saves a row as numbers.
    ///
    /// # Errors
    /// As [`PlantSteps::save_to`] and [`PlantBatch::row`].
    pub fn save(&mut self, row: usize, numbers: &mut [f64]) -> Result<(), Error> {
        let (row, desk) = self.living(row)?;
        desk.visit(&mut row.steps, |steps| steps.save_to(numbers))
    }

    /// Writes the states of a row, in the places that [`Plant::indices`] says, without bringing more of it up to date.
    ///
    /// [`Plant::indices`]: mckibben::plant::Plant::indices
    ///
    /// # Errors
    /// As [`PlantBatch::row`]; [`Error::Misuse`] where there is not one number for each state.
    pub fn read(&self, row: usize, state: &mut [f64]) -> Result<(), Error> {
        let (Group { rows, lanes, .. }, lane) = self.of_living(row)?;
        let row = &rows.list[lane];
        if state.len() != row.steps.state().len() {
            return Err(Error::Misuse {
                what: "the states of an element are requested in a slice whose length is not their number",
                remedy: "give as many numbers as the plant has states",
            });
        }
        match lanes {
            Some(lanes) if row.change == Change::None => lanes.read(lane, state),
            _ => state.copy_from_slice(row.steps.state()),
        }
        Ok(())
    }

    /// What the actuators of a row answered when they were last computed; nothing before.
    ///
    /// # Errors
    /// As [`PlantBatch::row`].
    pub fn responses(&self, row: usize) -> Result<&[Response], Error> {
        let (Group { rows, responses, .. }, lane) = self.of_living(row)?;
        let count = responses.len() / rows.list.len();
        Ok(&responses[count * lane..count * (lane + 1)])
    }

    /// The absolute pressure in Pa of an actuator of a row.
    ///
    /// # Errors
    /// As [`PlantBatch::row`]; [`Error::Misuse`] when there is no such actuator.
    pub fn pressure(&self, row: usize, actuator: usize) -> Result<f64, Error> {
        let (Group { rows, lanes, .. }, lane) = self.of_living(row)?;
        let row = &rows.list[lane];
        let Some(here) = row.steps.plant().indices().actuators.get(actuator) else { return Err(NO_ACTUATOR) };
        Ok(match lanes {
            Some(lanes) if row.change == Change::None => lanes.read_one(lane, here.pressure),
            _ => row.steps.state()[here.pressure],
        })
    }

    /// All rows as they are now, or why they have stopped.
    pub fn rows(&mut self) -> Vec<Result<&PlantRow, Error>> {
        self.each(self.takes(ANSWER), |group| {
            (0..group.rows.list.len()).for_each(|lane| {
                group.bring(lane);
            });
        });
        let steps = |row| self.of_living(row).map(|(group, lane)| &*group.rows.list[lane].steps);
        (0..self.len()).map(steps).collect()
    }

    /// Everything that is known of every row, or why it has stopped.
    pub fn samples(&mut self) -> Vec<Result<PlantSample, Error>> {
        self.rows().into_iter().map(|row| row.map(PlantRow::sample)).collect()
    }

    pub(super) fn place(&self, row: usize) -> Result<[usize; 2], Error> {
        self.places.get(row).copied().ok_or(NO_ROW)
    }

    /// The group of a row that has not stopped, and its lane there, without bringing it up to date.
    pub(super) fn of_living(&self, row: usize) -> Result<(&Group, usize), Error> {
        let [group, lane] = self.place(row)?;
        let group = &self.groups[group];
        group.rows.list[lane].fault.clone().map_or(Ok((group, lane)), Err)
    }

    /// A row that has not stopped, as it is now, and what it computes with.
    pub(super) fn living(&mut self, row: usize) -> Result<(&mut Row, &mut PlantSteps), Error> {
        let [group, lane] = self.place(row)?;
        let group = &mut self.groups[group];
        group.bring(lane);
        let Rows { list, desk } = &mut group.rows;
        let row = &mut list[lane];
        match &row.fault {
            Some(fault) => Err(fault.clone()),
            None => Ok((row, desk)),
        }
    }
}
