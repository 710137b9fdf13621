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
    rows(&mut |sample| {
        for (field, column) in fields.iter().zip(&mut columns) {
            match (&field.value, column) {
                (Value::Number(value), Values::Numbers(numbers)) => numbers.push(value(sample)),
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
