//! A table as CSV: numbers in the fewest digits that give the same 64 bits back, nothing as an empty field.

use super::Sheet;
use crate::failure::Failure;
use crate::output::Pending;
use crate::sweep::table::{Cell, Column};
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(Debug)]
pub(super) struct CsvSheet {
    path: PathBuf,
    writer: csv::Writer<Pending>,
    number: String,
}

impl CsvSheet {
    pub(super) fn begin(columns: &[Column], file: Pending) -> Result<Self, Failure> {
        let path = file.path().to_owned();
        let mut writer = csv::Writer::from_writer(file);
        let header = columns.iter().map(|column| &column.name);
        writer.write_record(header).map_err(|error| Failure::output(&path, error))?;
        Ok(Self { path, writer, number: String::new() })
    }
}

impl Sheet for CsvSheet {
    fn line(&mut self, cells: &[Cell<'_>]) -> Result<(), Failure> {
        for cell in cells {
            self.number.clear();
            let field = match cell {
                Cell::Word(word) => word,
                Cell::Nothing => "",
                // Writing to a string cannot fail. The debug form is the shortest that reads back the same.
                Cell::Count(count) => {
                    let _ = write!(self.number, "{count}");
                    &self.number
                }
                Cell::Number(number) => {
                    let _ = write!(self.number, "{number:?}");
                    &self.number
                }
            };
            self.writer.write_field(field).map_err(|error| Failure::output(&self.path, error))?;
        }
        self.writer.write_record(None::<&[u8]>).map_err(|error| Failure::output(&self.path, error))
    }

    fn finish(self: Box<Self>, _: &[(String, String)]) -> Result<(), Failure> {
        let Self { path, writer, .. } = *self;
        writer.into_inner().map_err(|error| Failure::output(&path, error.error()))?.commit()
    }
}
