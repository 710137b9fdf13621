//! The reductions of a finished part, back from its file, for the summary and the figure of the whole sweep.

use super::rows::Outcome;
use super::table::{ERROR, RUN};
use crate::failure::Failure;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, Row};
use std::fs::File;
use std::path::Path;

/// Hands the row and the outcome of each run of a part with reductions to `each`. `results` names the columns.
///
/// # Errors
/// [`Failure::input`] when the file cannot be read.
pub fn reductions(path: &Path, results: &[String], each: &mut dyn FnMut(u64, &Outcome)) -> Result<(), Failure> {
    let failed = |error: ParquetError| {
        let title = format!("`{}` cannot be read: {error}", path.display());
        Failure::input(title, "delete it, and what was in it will be done again")
    };
    let file = File::open(path).map_err(|error| failed(error.into()))?;
    let reader = SerializedFileReader::new(file).map_err(failed)?;
    for row in reader.get_row_iter(None).map_err(failed)? {
        let (run, outcome) = outcome(&row.map_err(failed)?, results);
        each(run, &outcome);
    }
    Ok(())
}

fn outcome(row: &Row, results: &[String]) -> (u64, Outcome) {
    let mut run = 0;
    let mut values = vec![None; results.len()];
    let mut reason = None;
    for (name, field) in row.get_column_iter() {
        match field {
            Field::ULong(index) if name == RUN => run = *index,
            Field::Str(text) if name == ERROR => reason = Some(text.clone()),
            Field::Double(value) => {
                if let Some(place) = results.iter().position(|result| result == name) {
                    values[place] = Some(*value);
                }
            }
            _ => {}
        }
    }
    (run, reason.map_or(Outcome::Reduced(values), Outcome::Failed))
}
