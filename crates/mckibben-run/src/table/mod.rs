//! Tables of numbers and words: one model of their columns, and one writer of them as CSV, as Parquet and as a MAT-file.
//!
//! A run, a sweep, a log of events, the numbers of a figure and the tables of a report are all [`Column`]s with rows of [`Cell`]s.
//! A [`Writer`] takes the rows one by one and keeps no more than a row group of them; for a MAT-file it keeps all.
//!
//! | cell | in CSV | in Parquet | in a MAT-file |
//! |---|---|---|---|
//! | [`Cell::Number`] | the fewest digits that give the same 64 bits back, with a point or an exponent | `DOUBLE` | double |
//! | [`Cell::Count`] | its digits | `INT64`, unsigned | double |
//! | [`Cell::Word`] | the word, in quotes where it has a comma, a quote or a line end | `BYTE_ARRAY`, UTF-8 | text in a cell array |
//! | [`Cell::Nothing`] | an empty field | null | NaN, an empty text |
//!
//! Every number in a file is finite. Equal rows give equal bytes. A table that users request as a file is in the units
//! that they chose ([`crate::units`]): [`Writer::begin`] and [`Writer::csv`]. The parts of a sweep in a folder are read
//! back, and stay in SI.

mod csv;
mod mat;
mod parquet;
mod sealed;
#[cfg(test)]
mod tests;

pub use parquet::Layout;
pub use sealed::{CHECKSUM, Seal, seal};

use crate::failure::Failure;
use crate::units::{self, Shown};
use std::io::Write;
use std::path::{Path, PathBuf};

/// What a column holds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Kind {
    /// Whole numbers from 0.
    Count,
    /// Numbers.
    Number,
    /// Words.
    Word,
}

/// A column.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Column {
    /// Its name, with the unit at its end.
    pub name: String,
    /// Its unit; empty for words and plain numbers.
    pub unit: String,
    /// What it holds.
    pub kind: Kind,
    /// Whether a row may have nothing in it.
    pub optional: bool,
}

impl Column {
    /// A column of whole numbers from 0.
    pub fn count(name: impl Into<String>) -> Self {
        Self { name: name.into(), unit: String::new(), kind: Kind::Count, optional: false }
    }

    /// A column of numbers in a unit, which is empty for plain numbers.
    pub fn number(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), kind: Kind::Number, optional: false }
    }

    /// A column of words.
    pub fn word(name: impl Into<String>) -> Self {
        Self { name: name.into(), unit: String::new(), kind: Kind::Word, optional: false }
    }

    /// The column with rows that may have nothing in it.
    #[must_use]
    pub fn optional(self) -> Self {
        Self { optional: true, ..self }
    }

    /// Checks that a cell is one of this column, and finite; `row` counts from 1.
    ///
    /// # Errors
    /// [`Failure::not_finite`] with the column and the row; [`Failure::stopped`] for a cell of another kind.
    pub fn check(&self, cell: &Cell<'_>, row: u64) -> Result<(), Failure> {
        match (self.kind, cell) {
            (Kind::Number, Cell::Number(value)) if !value.is_finite() => {
                Err(Failure::not_finite(&format!("column {}, row {row}: {value}", self.name)))
            }
            (Kind::Number, Cell::Number(_)) | (Kind::Count, Cell::Count(_)) | (Kind::Word, Cell::Word(_)) => Ok(()),
            (_, Cell::Nothing) if self.optional => Ok(()),
            _ => Err(Failure::stopped(format!("column {}, row {row}: {cell:?} is no cell of it", self.name))),
        }
    }
}

/// What a row has in a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// A whole number.
    Count(u64),
    /// A number.
    Number(f64),
    /// A word.
    Word(&'a str),
    /// Nothing.
    Nothing,
}

impl Cell<'_> {
    /// The cell with its number in a unit.
    fn shown(self, unit: &Shown) -> Self {
        match self {
            Self::Number(value) => Self::Number(unit.written(value)),
            other => other,
        }
    }
}

impl From<Option<f64>> for Cell<'_> {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Nothing, Self::Number)
    }
}

/// How a table is written.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Format {
    /// Text with commas, each number in the fewest digits that identify it.
    Csv,
    /// Apache Parquet.
    Parquet,
    /// MAT-file of level 5, for MATLAB, Octave and SciPy.
    Mat,
}

impl Format {
    /// The format that a file's ending stands for.
    ///
    /// # Errors
    /// [`Failure::input`] for another ending.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        match ending(path).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            Some("mat") => Ok(Self::Mat),
            _ => Err(Failure::input(
                format!("`{}` does not say how to write the run", path.display()),
                "end its name with .csv, .parquet or .mat",
            )),
        }
    }
}

/// The ending of a file's name in small letters.
pub fn ending(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

/// The units of the columns of numbers as JSON, which files have as `mckibben.units`.
fn units_of(columns: &[Column]) -> String {
    let numbers = columns.iter().filter(|column| column.kind == Kind::Number);
    let units: serde_json::Map<String, serde_json::Value> =
        numbers.map(|column| (column.name.clone(), column.unit.clone().into())).collect();
    serde_json::Value::Object(units).to_string()
}

/// Writes rows of cells to a sink of bytes.
pub struct Writer<W: Write + Send> {
    path: PathBuf,
    columns: Vec<Column>,
    /// What makes the number in a column's unit of one in SI.
    shown: Vec<Shown>,
    rows: u64,
    form: Form<W>,
}

enum Form<W: Write + Send> {
    Csv(Box<csv::Rows<W>>),
    Parquet(Box<parquet::Rows<W>>),
    Mat(Box<mat::Rows<W>>),
}

impl<W: Write + Send> Writer<W> {
    /// Begins a table as CSV, in the units that were chosen; messages name `path`.
    ///
    /// # Errors
    /// [`Failure::output`] when the head cannot be written.
    pub fn csv(columns: Vec<Column>, path: &Path, sink: W) -> Result<Self, Failure> {
        let (columns, shown) = units::columns(columns);
        let form = csv::Rows::begin(&columns, sink).map_err(|error| Failure::output(path, error))?;
        Ok(Self { path: path.to_owned(), columns, shown, rows: 0, form: Form::Csv(Box::new(form)) })
    }

    /// Begins a table as Parquet, in SI; messages name `path`.
    ///
    /// # Errors
    /// [`Failure::output`] when the head cannot be written.
    pub fn parquet(columns: Vec<Column>, layout: Layout, path: &Path, sink: W) -> Result<Self, Failure> {
        let form = parquet::Rows::begin(&columns, layout, sink).map_err(|error| Failure::output(path, error))?;
        Ok(Self { path: path.to_owned(), columns, shown: Vec::new(), rows: 0, form: Form::Parquet(Box::new(form)) })
    }

    /// Begins a table in a format, in the units that were chosen; `layout` is that of Parquet.
    ///
    /// # Errors
    /// [`Failure::output`] when the head cannot be written.
    pub fn begin(format: Format, columns: Vec<Column>, layout: Layout, path: &Path, sink: W) -> Result<Self, Failure> {
        match format {
            Format::Csv => Self::csv(columns, path, sink),
            Format::Parquet => {
                let (columns, shown) = units::columns(columns);
                Ok(Self { shown, ..Self::parquet(columns, layout, path, sink)? })
            }
            Format::Mat => {
                let (columns, shown) = units::columns(columns);
                let form = mat::Rows::begin(&columns, sink).map_err(|error| Failure::output(path, error))?;
                Ok(Self { path: path.to_owned(), columns, shown, rows: 0, form: Form::Mat(Box::new(form)) })
            }
        }
    }

    /// Adds a row with one cell for each column.
    ///
    /// # Errors
    /// [`Failure::not_finite`] for a number that is not finite; [`Failure::output`] when the row cannot be written.
    pub fn row(&mut self, cells: &[Cell<'_>]) -> Result<(), Failure> {
        self.rows += 1;
        if cells.len() != self.columns.len() {
            let (found, expected) = (cells.len(), self.columns.len());
            return Err(Failure::stopped(format!("row {} has {found} cells for {expected} columns", self.rows)));
        }
        for (column, cell) in self.columns.iter().zip(cells) {
            column.check(cell, self.rows)?;
        }
        let shown: Vec<Cell<'_>> = cells.iter().zip(&self.shown).map(|(cell, shown)| cell.shown(shown)).collect();
        let cells = if shown.is_empty() { cells } else { &shown };
        match &mut self.form {
            Form::Csv(form) => form.row(cells).map_err(|error| Failure::output(&self.path, error)),
            Form::Parquet(form) => form.row(cells).map_err(|error| Failure::output(&self.path, error)),
            Form::Mat(form) => form.row(cells).map_err(|error| Failure::output(&self.path, error)),
        }
    }

    /// Completes the table with notes about it, as keys and values, for the formats that have a place for them; the sink with all
    /// bytes.
    ///
    /// # Errors
    /// [`Failure::output`] when the last bytes cannot be written.
    pub fn finish(self, notes: &[(String, String)]) -> Result<W, Failure> {
        let Self { path, columns, form, .. } = self;
        let all = || [notes, &[("mckibben.units".to_owned(), units_of(&columns))]].concat();
        match form {
            Form::Csv(form) => form.finish().map_err(|error| Failure::output(&path, error)),
            Form::Mat(form) => form.finish(&all()).map_err(|error| Failure::output(&path, error)),
            Form::Parquet(form) => form.finish(&all()).map_err(|error| Failure::output(&path, error)),
        }
    }
}

impl<W: Write + Send> std::fmt::Debug for Writer<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Writer").field("path", &self.path).field("rows", &self.rows).finish_non_exhaustive()
    }
}
