//! The columns of a sweep, and a run as lines of them.
//!
//! | column | holds |
//! |---|---|
//! | `run` | the row of the sweep, from 0 |
//! | one for each varied key | its value: a number in SI, with the unit at the end of the name, or a word |
//! | one for each reduction; or those of `mckibben simulate` | a number, or nothing |
//! | `warnings` | the codes of the run's warnings, such as `thrown`; nothing where there is none |
//! | `error` | why the run failed; nothing when it did not |
//!
//! With reductions a run is one line; with samples or trajectories it is one line for each sample. A run that failed is
//! one line without results.

use super::rows::Outcome;
use super::warned::codes;
use crate::failure::Failure;
use crate::record::{Field, of_actuator, of_joint_alone};
use crate::table::{Cell, Column, Layout, Writer};
use crate::warnings::Warning;
use mckibben_scenario::{AxisKind, AxisValue, PlantColumn, Record, Sweep};
use std::io::Write;

/// The Parquet files of sweeps.
pub(super) const LAYOUT: Layout = Layout { schema: "sweep", group: 1 << 16, sealed: true };

/// The column of the row's index.
pub const RUN: &str = "run";
/// The column of the codes of warnings.
pub const WARNINGS: &str = "warnings";
/// The column of the reason.
pub const ERROR: &str = "error";

/// The columns of a sweep in their order.
pub fn columns(sweep: &Sweep) -> Vec<Column> {
    let mut columns = vec![Column::count(RUN)];
    columns.extend(sweep.axes().iter().map(|axis| match &axis.kind {
        AxisKind::Quantity { unit, .. } => Column::number(axis.column(), unit.to_string()),
        AxisKind::Word => Column::word(axis.column()),
    }));
    match sweep.record() {
        Record::Reductions(_) | Record::PlantReductions(_) => {
            let reduced = sweep.record().reduced().unwrap_or_default();
            columns.extend(reduced.iter().map(|of| Column::number(&of.column, of.unit).optional()));
        }
        Record::Samples(_) | Record::Trajectories => columns.extend(sampled(sweep).into_iter().map(Column::optional)),
    }
    columns.push(Column::word(WARNINGS).optional());
    columns.push(Column::word(ERROR).optional());
    columns
}

/// The columns of samples.
fn sampled(sweep: &Sweep) -> Vec<Column> {
    fn of<S>(fields: Vec<Field<S>>) -> Vec<Column> {
        fields.into_iter().map(|field| field.column).collect()
    }
    if sweep.is_plant() {
        let of = |of: &PlantColumn| match of.quantity() {
            Some(_) => Column::number(of.title(), of.unit),
            None => Column::word(of.title()),
        };
        let columns = sweep.plant_columns().iter().map(of);
        return std::iter::once(Column::number("time_s", "s")).chain(columns).collect();
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
/// As [`Writer::row`].
pub fn write<W: Write + Send>(
    sweep: &Sweep,
    row: u64,
    (outcome, warnings): (&Outcome, &[Warning]),
    writer: &mut Writer<W>,
) -> Result<u64, Failure> {
    lines(sweep, row, (outcome, warnings), &mut |cells| writer.row(cells))?;
    Ok(u64::from(matches!(outcome, Outcome::Failed(_))))
}

/// Hands the lines of a run to `each`.
fn lines(
    sweep: &Sweep,
    row: u64,
    (outcome, warnings): (&Outcome, &[Warning]),
    each: &mut dyn FnMut(&[Cell<'_>]) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let values: Vec<AxisValue<'_>> = (0..sweep.axes().len()).map(|axis| sweep.value(axis, row)).collect();
    let mut line = vec![Cell::Count(row)];
    line.extend(values.iter().map(|value| match value {
        AxisValue::Number(number) => Cell::Number(*number),
        AxisValue::Word(word) => Cell::Word(word),
    }));
    let head = line.len();
    let codes = codes(warnings);
    let warned = if codes.is_empty() { Cell::Nothing } else { Cell::Word(&codes) };
    match outcome {
        Outcome::Reduced(values) => {
            line.extend(values.iter().copied().map(Cell::from));
            line.extend([warned, Cell::Nothing]);
            each(&line)
        }
        Outcome::Sampled(rows) => rows.iter().try_for_each(|row| {
            line.truncate(head);
            line.extend(row);
            line.extend([warned, Cell::Nothing]);
            each(&line)
        }),
        Outcome::Failed(reason) => {
            let results = match sweep.record() {
                Record::Reductions(reductions) => reductions.len(),
                Record::PlantReductions(reductions) => reductions.len(),
                Record::Samples(_) | Record::Trajectories => sampled(sweep).len(),
            };
            line.extend(std::iter::repeat_n(Cell::Nothing, results));
            line.extend([warned, Cell::Word(reason)]);
            each(&line)
        }
    }
}
