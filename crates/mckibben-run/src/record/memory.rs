//! A run as columns in memory: the numbers and words of its files, before they are written.

use super::Rows;
use super::field::Field;
use crate::failure::Failure;
use crate::table::{Cell, Kind};

/// A column with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Filled {
    /// Its name, with the unit at its end.
    pub name: String,
    /// Its unit; empty for words.
    pub unit: String,
    /// What it holds, row by row.
    pub values: Values,
}

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers in the column's unit.
    Numbers(Vec<f64>),
    /// Words.
    Words(Vec<&'static str>),
}

/// Fills the columns with the samples of a run.
pub(crate) fn filled<S>(fields: Vec<Field<S>>, rows: Rows<'_, S>) -> Result<Vec<Filled>, Failure> {
    let mut columns: Vec<Values> = fields.iter().map(|field| Values::of(field.column.kind)).collect();
    let mut row = 0;
    rows(&mut |sample| {
        row += 1;
        for (Field { column, cell }, values) in fields.iter().zip(&mut columns) {
            let cell = cell(sample);
            column.check(&cell, row)?;
            values.push(cell);
        }
        Ok(())
    })?;
    let of =
        |(Field { column, .. }, values): (Field<S>, Values)| Filled { name: column.name, unit: column.unit, values };
    Ok(fields.into_iter().zip(columns).map(of).collect())
}

impl Values {
    fn of(kind: Kind) -> Self {
        match kind {
            Kind::Number | Kind::Count => Self::Numbers(Vec::new()),
            Kind::Word => Self::Words(Vec::new()),
        }
    }

    fn push(&mut self, cell: Cell<'static>) {
        match (self, cell) {
            (Self::Numbers(numbers), Cell::Number(number)) => numbers.push(number),
            (Self::Words(words), Cell::Word(word)) => words.push(word),
            // A sample has neither counts nor gaps, and each cell was checked against its column.
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Format, Provenance, Target, number, write};
    use mckibben_scenario::Document;
    use std::path::Path;

    fn fields() -> Vec<Field<f64>> {
        vec![number("length_m", "m", |value| *value)]
    }

    /// In memory, as CSV and as Parquet: the column and the row are named.
    #[test]
    fn a_number_that_is_not_finite_is_an_error_in_every_form() {
        let text = "[load]\nkind = \"isometric\"\n[initial]\nlength = \"3.5 in\"\n[run]\nduration = \"1 s\"";
        let document = Document::parse(text, "muscle.toml").unwrap();
        let provenance = Provenance { document: &document, set: &[], scenario: Some(&document.scenario().unwrap()) };
        for bad in [f64::NAN, f64::INFINITY] {
            let mut rows = |each: &mut dyn FnMut(&f64) -> Result<(), Failure>| [1.0, bad].iter().try_for_each(each);
            let path = Path::new("run.csv");
            let mut failures = vec![filled(fields(), &mut rows).unwrap_err()];
            for format in [Format::Csv, Format::Parquet] {
                let target = Target { provenance: &provenance, path, format, out: &mut std::io::sink() };
                failures.push(write(&fields(), &mut rows, target).unwrap_err());
            }
            for failure in failures {
                assert_eq!(failure.code(), 3);
                assert!(failure.to_string().contains(&format!("column length_m, row 2: {bad}")), "{failure}");
            }
        }
    }
}
