//! Where the lines of a sweep go: nowhere, into one file, or into the parts of a folder.

use super::folder::{FAILED, Folder, PART, ROWS};
use super::plan::{Plan, Unit};
use super::rows::Simulated;
use super::table::{self, LAYOUT};
use super::warned::{WARNINGS, WarnedRuns};
use crate::failure::Failure;
use crate::output::Pending;
use crate::table::{Column, Format, Writer};
use mckibben_scenario::Sweep;
use std::path::Path;

/// Where the lines go.
#[derive(Debug)]
pub enum Place {
    /// Nowhere.
    Nowhere,
    /// Into one file with all rows in order.
    File(Box<Writer<Pending>>),
    /// Into parts.
    Folder(Folder),
}

impl Place {
    /// A file that is begun, so that a path that cannot be written to is known before any work is done.
    ///
    /// # Errors
    /// [`Failure::output`] when it cannot be written.
    pub fn file(path: &Path, format: Format, columns: &[Column]) -> Result<Self, Failure> {
        Ok(Self::File(Box::new(Writer::begin(format, columns.to_vec(), LAYOUT, path, Pending::create(path)?)?)))
    }
}

/// A place that lines are being written to.
#[derive(Debug)]
pub struct Destination<'a> {
    sweep: &'a Sweep,
    plan: Plan,
    columns: Vec<Column>,
    /// What is said about the sweep in each file.
    notes: Vec<(String, String)>,
    place: Place,
    /// The part under way.
    part: Option<Writer<Pending>>,
    /// Failed runs in the file under way.
    failed: u64,
    /// The warnings of the runs in it.
    warned: WarnedRuns,
}

impl<'a> Destination<'a> {
    /// Begins to write to a place.
    pub fn new(sweep: &'a Sweep, plan: Plan, notes: Vec<(String, String)>, place: Place) -> Self {
        Self {
            sweep,
            plan,
            columns: table::columns(sweep),
            notes,
            place,
            part: None,
            failed: 0,
            warned: WarnedRuns::default(),
        }
    }

    /// Writes what the rows of a unit came to; units come in the order of their rows.
    ///
    /// # Errors
    /// [`Failure::output`] when they cannot be written.
    pub fn write(&mut self, unit: &Unit, simulated: &Simulated) -> Result<(), Failure> {
        let rows = self.plan.rows_of(unit.part);
        let writer = match &mut self.place {
            Place::Nowhere => return Ok(()),
            Place::File(writer) => writer,
            Place::Folder(folder) => match &mut self.part {
                Some(writer) => writer,
                part => {
                    let path = folder.part(unit.part);
                    let file = Pending::create(&path)?;
                    part.insert(Writer::parquet(self.columns.clone(), LAYOUT, &path, file)?)
                }
            },
        };
        for (row, outcome, warnings) in simulated.rows(unit.rows.clone()) {
            self.failed += table::write(self.sweep, row, (outcome, warnings), writer)?;
            self.warned.see(row, warnings);
        }
        if matches!(self.place, Place::Folder(_))
            && unit.rows.end == rows.end
            && let Some(part) = self.part.take()
        {
            let found = (self.failed, &self.warned);
            part.finish(&about(&self.notes, unit.part, rows, found))?.commit()?;
            (self.failed, self.warned) = (0, WarnedRuns::default());
        }
        Ok(())
    }

    /// Completes what is not complete yet.
    ///
    /// # Errors
    /// [`Failure::output`] when it cannot be written.
    pub fn finish(self) -> Result<(), Failure> {
        match self.place {
            Place::File(writer) => {
                let found = (self.failed, &self.warned);
                writer.finish(&about(&self.notes, 0, 0..self.plan.rows, found))?.commit()
            }
            Place::Folder(folder) => {
                folder.clear_remains();
                Ok(())
            }
            Place::Nowhere => Ok(()),
        }
    }

    /// What failed while writing here, with what stays.
    pub fn failed(&self, failure: Failure) -> Failure {
        match &self.place {
            Place::Folder(folder) => failure.staying(|| folder.stays(&self.plan)),
            Place::File(_) | Place::Nowhere => failure,
        }
    }
}

/// What is said in a file: about the sweep, and about the rows in it.
pub(super) fn about(
    notes: &[(String, String)],
    part: u64,
    rows: std::ops::Range<u64>,
    (failed, warned): (u64, &WarnedRuns),
) -> Vec<(String, String)> {
    let of_part = [
        (PART, part.to_string()),
        (ROWS, format!("{}..{}", rows.start, rows.end)),
        (FAILED, failed.to_string()),
        (WARNINGS, warned.to_json()),
    ];
    notes.iter().cloned().chain(of_part.map(|(key, value)| (key.to_owned(), value))).collect()
}
