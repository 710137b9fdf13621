//! A run as CSV.
//!
//! Numbers have a point or an exponent and the fewest digits that give the same 64 bits back, so no digit is lost and
//! the same run gives the same bytes.

use super::{COLUMNS, VALVE};
use crate::engine::Outcome;
use crate::failure::Failure;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

pub(super) fn write(outcome: &Outcome<'_>, interval: f64, path: &Path, out: &mut dyn Write) -> Result<(), Failure> {
    let failed = |error: csv::Error| Failure::output(path, error);
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS.iter().map(|column| column.name).chain([VALVE])).map_err(failed)?;
    let mut number = String::new();
    outcome.each_sample(interval, &mut |sample| {
        for column in &COLUMNS {
            number.clear();
            // Writing to a string cannot fail. The debug form is the shortest that reads back the same.
            let _ = write!(number, "{:?}", (column.value)(sample));
            writer.write_field(&number).map_err(failed)?;
        }
        writer.write_record([sample.ports.name()]).map_err(failed)
    })?;
    writer.flush().map_err(|error| Failure::output(path, error))
}
