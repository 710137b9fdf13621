//! A run as columns in memory: the numbers and words of its files, before they are written.

use super::Rows;
use super::field::{Field, Value};
use crate::failure::Failure;

/// A column with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Filled {
    /// Its name, with the unit at its end.
    pub name: String,
    /// Its unit; empty for words.
    pub unit: &'static str,
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
    let mut columns: Vec<Values> = fields.iter().map(|field| empty(&field.value)).collect();
    let mut row = 0;
    rows(&mut |sample| {
        row += 1;
        for (field, column) in fields.iter().zip(&mut columns) {
            match (&field.value, column) {
                (Value::Number(value), Values::Numbers(numbers)) => numbers.push(field.finite(value(sample), row)?),
                (Value::Word(value), Values::Words(words)) => words.push(value(sample)),
                // The columns were made from the fields.
                _ => {}
            }
        }
        Ok(())
    })?;
    let of = |(field, values): (Field<S>, Values)| Filled { name: field.name, unit: field.unit, values };
    Ok(fields.into_iter().zip(columns).map(of).collect())
}

fn empty<S>(value: &Value<S>) -> Values {
    match value {
        Value::Number(_) => Values::Numbers(Vec::new()),
        Value::Word(_) => Values::Words(Vec::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Format, Provenance, Target, write};
    use mckibben_scenario::Document;
    use std::path::Path;

    fn fields() -> Vec<Field<f64>> {
        vec![Field { name: "length_m".to_owned(), unit: "m", value: Value::Number(Box::new(|value| *value)) }]
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
