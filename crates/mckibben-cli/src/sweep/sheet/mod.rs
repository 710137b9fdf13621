//! A table as a file that is whole or not there: CSV or Parquet.

mod csv;
mod parquet;

use super::table::{Cell, Column};
use crate::failure::Failure;
use crate::output::Pending;
use crate::record::Format;

/// A file of lines under way.
pub trait Sheet: std::fmt::Debug {
    /// Adds a line with one cell for each column.
    ///
    /// # Errors
    /// [`Failure::output`] when it cannot be written.
    fn line(&mut self, cells: &[Cell<'_>]) -> Result<(), Failure>;

    /// Completes the file with words about it, for the formats that have a place for them, and gives it its name.
    ///
    /// # Errors
    /// [`Failure::output`] when it cannot be written.
    fn finish(self: Box<Self>, notes: &[(String, String)]) -> Result<(), Failure>;
}

/// Begins a file of these columns.
///
/// # Errors
/// [`Failure::output`] when it cannot be written.
pub fn begin(format: Format, columns: &[Column], file: Pending) -> Result<Box<dyn Sheet>, Failure> {
    Ok(match format {
        Format::Csv => Box::new(csv::CsvSheet::begin(columns, file)?),
        Format::Parquet => Box::new(parquet::ParquetSheet::begin(columns, file)?),
    })
}
