//! The columns of a sweep, and a run as lines of them.
//!
//! | column | holds |
//! |---|---|
//! | `run` | the row of the sweep, from 0 |
//! | one for each varied key | its value: a number in SI, with the unit at the end of the name, or a word |
//! | one for each reduction; or those of `mckibben simulate` | a number, or nothing |
//! | `error` | why the run failed; nothing when it did not |
//!
//! With reductions a run is one line; with samples or trajectories it is one line for each sample. A run that failed is
//! one line without results.

use super::rows::{Outcome, SampleCell};
use super::sheet::Sheet;
use crate::failure::Failure;
use crate::record::{Field, Value, of_actuator, of_joint_alone};
use mckibben_scenario::{AxisKind, AxisValue, PlantColumn, Record, Sweep};

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
    /// Whether a line may have nothing in it.
    pub optional: bool,
}

/// What stands in a line under a column.
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

impl From<Option<f64>> for Cell<'_> {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Nothing, Self::Number)
    }
}

/// The column of the row's index.
pub const RUN: &str = "run";
/// The column of the reason.
pub const ERROR: &str = "error";

/// The columns of a sweep in their order.
pub fn columns(sweep: &Sweep) -> Vec<Column> {
    let column = |name: &str, unit: &str, kind, optional| Column {
        name: name.to_owned(),
        unit: unit.to_owned(),
        kind,
        optional,
    };
    let mut columns = vec![column(RUN, "", Kind::Count, false)];
    for axis in sweep.axes() {
        columns.push(match &axis.kind {
            AxisKind::Quantity { unit, .. } => column(&axis.column(), unit, Kind::Number, false),
            AxisKind::Word => column(&axis.column(), "", Kind::Word, false),
        });
    }
    match sweep.record() {
        Record::Reductions(_) | Record::PlantReductions(_) => {
            let reduced = sweep.record().reduced().unwrap_or_default();
            columns.extend(reduced.iter().map(|of| column(&of.column, of.unit, Kind::Number, true)));
        }
        Record::Samples(_) | Record::Trajectories => {
            columns.extend(sampled(sweep).into_iter().map(|(name, unit, kind)| column(&name, unit, kind, true)));
        }
    }
    columns.push(column(ERROR, "", Kind::Word, true));
    columns
}

/// Name, unit and kind of the columns of samples.
fn sampled(sweep: &Sweep) -> Vec<(String, &'static str, Kind)> {
    fn of<S>(fields: Vec<Field<S>>) -> Vec<(String, &'static str, Kind)> {
        let kind = |value: &Value<S>| if matches!(value, Value::Word(_)) { Kind::Word } else { Kind::Number };
        fields.into_iter().map(|field| (field.name, field.unit, kind(&field.value))).collect()
    }
    if sweep.is_plant() {
        let kind = |of: &PlantColumn| if of.quantity().is_some() { Kind::Number } else { Kind::Word };
        let time = ("time_s".to_owned(), "s", Kind::Number);
        let columns = sweep.plant_columns().iter().map(|of| (of.title(), of.unit, kind(of)));
        return std::iter::once(time).chain(columns).collect();
    }
    // Names and units do not depend on the atmosphere.
    match sweep.has_joint() {
        true => of(of_joint_alone(0.0)),
        false => of(of_actuator(0.0)),
    }
}

/// Writes the lines of a run; 1 if it failed, to be counted.
///
/// # Errors
/// As [`Sheet::line`].
pub fn write(sweep: &Sweep, row: u64, outcome: &Outcome, sheet: &mut dyn Sheet) -> Result<u64, Failure> {
    lines(sweep, row, outcome, &mut |cells| sheet.line(cells))?;
    Ok(u64::from(matches!(outcome, Outcome::Failed(_))))
}

/// Hands the lines of a run to `each`.
fn lines(
    sweep: &Sweep,
    row: u64,
    outcome: &Outcome,
    each: &mut dyn FnMut(&[Cell<'_>]) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let values: Vec<AxisValue<'_>> = (0..sweep.axes().len()).map(|axis| sweep.value(axis, row)).collect();
    let mut line = vec![Cell::Count(row)];
    line.extend(values.iter().map(|value| match value {
        AxisValue::Number(number) => Cell::Number(*number),
        AxisValue::Word(word) => Cell::Word(word),
    }));
    let head = line.len();
    match outcome {
        Outcome::Reduced(values) => {
            line.extend(values.iter().copied().map(Cell::from));
            line.push(Cell::Nothing);
            each(&line)
        }
        Outcome::Sampled(rows) => rows.iter().try_for_each(|row| {
            line.truncate(head);
            line.extend(row.iter().map(|cell| match cell {
                SampleCell::Number(value) => Cell::Number(*value),
                SampleCell::Word(word) => Cell::Word(word),
            }));
            line.push(Cell::Nothing);
            each(&line)
        }),
        Outcome::Failed(reason) => {
            let results = match sweep.record() {
                Record::Reductions(reductions) => reductions.len(),
                Record::PlantReductions(reductions) => reductions.len(),
                Record::Samples(_) | Record::Trajectories => sampled(sweep).len(),
            };
            line.extend(std::iter::repeat_n(Cell::Nothing, results));
            line.push(Cell::Word(reason));
            each(&line)
        }
    }
}
