//! One key that varies: what values it takes, and which one in each row.

use super::design::{Draw, Sampler};
use super::distribution::Distribution;
use super::field::Field;
use super::spacing::Ends;
use crate::choice::Spacing;
use crate::place::List;
use crate::quantity;
use crate::scenario::Scenario;
use mckibben::parameter::Parameter;
use std::fmt::Write;

/// A key that varies.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Path of the key, such as `load.mass`.
    pub path: String,
    /// What its values are.
    pub kind: AxisKind,
    pub(super) values: Values,
    pub(super) sampler: Sampler,
    /// Whether the scenario is read again for each value.
    pub(super) read_each_row: bool,
    pub(super) target: Option<Target>,
}

/// What the values of an axis are.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum AxisKind {
    /// Numbers.
    Quantity {
        /// SI unit; empty for a pure number.
        unit: &'static str,
        /// Name of the column in a table, such as `load_mass_kg`.
        column: String,
    },
    /// Words, such as those of `air.process`.
    Word,
}

/// The value of an axis in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisValue<'a> {
    /// A number in the axis' SI unit.
    Number(f64),
    /// A word as the file has it.
    Word(&'a str),
}

/// The number of the scenario that an axis sets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    pub(super) parameter: &'static Parameter,
    /// None of what describes a muscle at rest, which is no number of the scenario.
    pub(super) field: Option<Field>,
    /// The list and the place in it, of an entry of a list.
    pub(super) entry: Option<(List, usize)>,
}

impl Target {
    /// The number in a scenario, if it has one.
    pub(super) fn slot(self, scenario: &mut Scenario) -> Option<&mut f64> {
        match self.entry {
            Some((list, index)) => list(scenario)?.get_mut(index),
            None => self.field.and_then(|field| field(scenario)),
        }
    }
}

/// What there is to take from, numbers in SI.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    /// Numbers one by one.
    Numbers(Vec<f64>),
    /// Words one by one.
    Words(Vec<String>),
    /// Evenly spaced numbers.
    Steps(Ends, u64),
    /// All numbers, some likelier than others.
    Continuous(Distribution),
}

impl Values {
    /// How many there are; `None` for a continuum.
    pub(super) fn count(&self) -> Option<u64> {
        match self {
            Self::Numbers(list) => Some(list.len() as u64),
            Self::Words(list) => Some(list.len() as u64),
            Self::Steps(_, count) => Some(*count),
            Self::Continuous(_) => None,
        }
    }

    /// The step that a draw takes; steps have equal odds.
    fn step(&self, draw: Draw) -> u64 {
        let count = self.count().unwrap_or(1);
        match draw {
            Draw::Step(step) => step % count,
            // Below 1 times a count is below the count, but for a rounding.
            Draw::Unit(share) => ((share * count as f64) as u64).min(count - 1),
        }
    }

    fn at(&self, draw: Draw) -> AxisValue<'_> {
        let step = self.step(draw);
        match (self, draw) {
            (Self::Numbers(list), _) => AxisValue::Number(list[step as usize]),
            (Self::Words(list), _) => AxisValue::Word(&list[step as usize]),
            (Self::Steps(ends, count), _) => AxisValue::Number(ends.step(step, *count)),
            (Self::Continuous(distribution), Draw::Unit(share)) => AxisValue::Number(distribution.quantile(share)),
            // A grid has no continuous axes, which the reading sees to; its middle is as good as any.
            (Self::Continuous(distribution), Draw::Step(_)) => AxisValue::Number(distribution.quantile(0.5)),
        }
    }
}

impl Axis {
    /// Name of the column in a table, such as `load_mass_kg` or `air_process`.
    pub fn column(&self) -> String {
        match &self.kind {
            AxisKind::Quantity { column, .. } => column.clone(),
            AxisKind::Word => column_of(&self.path, ""),
        }
    }

    /// Whether the values are spaced or distributed evenly in their logarithm, so that a figure has a logarithmic axis for them:
    /// a range or a uniform distribution with logarithmic spacing, or a log-normal distribution. All values are positive then.
    pub fn is_logarithmic(&self) -> bool {
        match &self.values {
            Values::Steps(ends, _) | Values::Continuous(Distribution::Uniform(ends)) => {
                ends.spacing == Spacing::Logarithmic
            }
            Values::Continuous(Distribution::LogNormal { .. }) => true,
            Values::Numbers(_) | Values::Words(_) | Values::Continuous(Distribution::Normal { .. }) => false,
        }
    }

    /// The value in a row.
    pub(super) fn value(&self, row: u64) -> AxisValue<'_> {
        self.values.at(self.sampler.draw(row))
    }

    /// Which value a row takes, counted from 0, when the scenario is read again for each.
    pub(super) fn base(&self, row: u64) -> Option<u64> {
        self.read_each_row.then(|| self.values.step(self.sampler.draw(row)))
    }

    /// The axis as a line of text that identifies it.
    pub(super) fn fingerprint(&self, text: &mut String) {
        let unit = match &self.kind {
            AxisKind::Quantity { unit, .. } => *unit,
            AxisKind::Word => "",
        };
        let number = |value: f64| quantity::format(value, unit);
        let between =
            |ends: &Ends| format!("from {} to {} {}", number(ends.from), number(ends.to), ends.spacing.name());
        let values = match &self.values {
            Values::Numbers(list) => list.iter().map(|value| number(*value)).collect::<Vec<_>>().join(", "),
            Values::Words(list) => format!("{list:?}"),
            Values::Steps(ends, count) => format!("{count} {}", between(ends)),
            Values::Continuous(Distribution::Uniform(ends)) => format!("uniform {}", between(ends)),
            Values::Continuous(Distribution::Normal { mean, deviation }) => {
                format!("normal mean {} deviation {}", number(*mean), number(*deviation))
            }
            Values::Continuous(Distribution::LogNormal { median, factor }) => {
                format!("log-normal median {} factor {factor}", number(*median))
            }
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "vary {}: {values}", self.path);
    }
}

/// A column's name: the path, with the place of an entry of a list, and the unit in lower case, joined by `_`.
pub fn column_of(path: &str, unit: &str) -> String {
    let unit = unit.to_lowercase().replace(['(', ')', '^'], "").replace(['*', '/'], "_");
    let path = path.replace(['.', '-', '['], "_").replace(']', "");
    if unit.is_empty() { path } else { format!("{path}_{unit}") }
}
