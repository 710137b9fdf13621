//! A run as CSV.
//!
//! Numbers have a point or an exponent and the fewest digits that give the same 64 bits back, so no digit is lost and
//! the same run gives the same bytes.

use super::Rows;
use super::field::{Field, Value};
use crate::failure::Failure;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

pub(super) fn write<S>(
    fields: &[Field<S>],
    rows: Rows<'_, S>,
    path: &Path,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let failed = |error: csv::Error| Failure::output(path, error);
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(fields.iter().map(|field| &field.name)).map_err(failed)?;
    let (mut number, mut row) = (String::new(), 0);
    rows(&mut |sample| {
        row += 1;
        for field in fields {
            match &field.value {
                Value::Number(value) => {
                    number.clear();
                    // Writing to a string cannot fail. The debug form is the shortest that reads back the same.
                    let _ = write!(number, "{:?}", field.finite(value(sample), row)?);
                    writer.write_field(&number).map_err(failed)?;
                }
                Value::Word(value) => writer.write_field(value(sample)).map_err(failed)?,
            }
        }
        writer.write_record(None::<&[u8]>).map_err(failed)
    })?;
    writer.flush().map_err(|error| Failure::output(path, error))
}
