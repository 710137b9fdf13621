//! A table as CSV, by the crate `csv`.

use super::{Cell, Column};
use std::fmt::Write as _;
use std::io::Write;

pub(super) struct Rows<W: Write> {
    writer: csv::Writer<W>,
    /// The digits of a number, kept for the next.
    digits: String,
}

impl<W: Write> Rows<W> {
    pub(super) fn begin(columns: &[Column], sink: W) -> Result<Self, csv::Error> {
        let mut writer = csv::Writer::from_writer(sink);
        writer.write_record(columns.iter().map(|column| &column.name))?;
        Ok(Self { writer, digits: String::new() })
    }

    pub(super) fn row(&mut self, cells: &[Cell<'_>]) -> Result<(), csv::Error> {
        for cell in cells {
            self.digits.clear();
            // Writing to a string cannot fail. The debug form of a number is the shortest that reads back the same.
            let field = match cell {
                Cell::Word(word) => word,
                Cell::Nothing => "",
                Cell::Count(count) => {
                    let _ = write!(self.digits, "{count}");
                    &self.digits
                }
                Cell::Number(number) => {
                    let _ = write!(self.digits, "{number:?}");
                    &self.digits
                }
            };
            self.writer.write_field(field)?;
        }
        self.writer.write_record(None::<&[u8]>)
    }

    pub(super) fn finish(self) -> std::io::Result<W> {
        self.writer.into_inner().map_err(csv::IntoInnerError::into_error)
    }
}
