//! A table as a file that is whole or not there: CSV or Parquet.

mod csv;
mod parquet;
mod sealed;

pub use sealed::{CHECKSUM, Seal, seal};

use super::table::{Cell, Column};
use crate::failure::Failure;
use crate::output::Pending;
use crate::record::Format;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

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

/// Where the bytes of a sheet go.
pub trait Sink: Write + Send {
    /// The file that they are to be, for messages.
    fn path(&self) -> &Path;

    /// Makes of the bytes what they are to be.
    ///
    /// # Errors
    /// [`Failure::output`] when that cannot be.
    fn commit(self) -> Result<(), Failure>;
}

impl Sink for Pending {
    fn path(&self) -> &Path {
        Self::path(self)
    }

    fn commit(self) -> Result<(), Failure> {
        Self::commit(self)
    }
}

/// Bytes that stay in memory, for whoever has a clone.
#[derive(Clone, Debug, Default)]
pub struct Kept(Arc<Mutex<Vec<u8>>>);

impl Kept {
    /// The bytes so far; none are left.
    pub fn take(&self) -> Vec<u8> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Kept {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Sink for Kept {
    fn path(&self) -> &Path {
        Path::new("memory")
    }

    fn commit(self) -> Result<(), Failure> {
        Ok(())
    }
}

/// Begins Parquet of these columns.
///
/// # Errors
/// [`Failure::output`] when it cannot be written.
pub fn parquet(columns: &[Column], sink: impl Sink + 'static) -> Result<Box<dyn Sheet>, Failure> {
    Ok(Box::new(parquet::ParquetSheet::begin(columns, sink)?))
}

/// Begins a file of these columns.
///
/// # Errors
/// [`Failure::output`] when it cannot be written.
pub fn begin(format: Format, columns: &[Column], file: Pending) -> Result<Box<dyn Sheet>, Failure> {
    Ok(match format {
        Format::Csv => Box::new(csv::CsvSheet::begin(columns, file)?),
        Format::Parquet => return parquet(columns, file),
    })
}
