//! What can go wrong, said so that it can be mended.
//!
//! Every parameter is validated when a value is constructed, so the laws themselves cannot fail. Each message names
//! the parameter, its value, the range that is valid, the unit and a remedy. Nothing is repaired in silence.

use crate::parameter::{self, Parameter};
use thiserror::Error;

/// A rejected parameter or a simulation that cannot go on.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// One parameter lies outside its own range.
    #[error("{name} = {value}{unit} is outside its range ({range}); {remedy}",
        name = .parameter.key, unit = Behind(.parameter.unit), range = .parameter.range, remedy = .parameter.remedy)]
    OutOfRange {
        /// The row of the parameter table.
        parameter: &'static Parameter,
        /// The value that was refused, in the SI unit of the parameter.
        value: f64,
    },
    /// Two parameters contradict each other.
    #[error("{name} = {value}{unit} contradicts {requirement}; {remedy}", name = .parameter.key, unit = Behind(.parameter.unit))]
    Inconsistent {
        /// The parameter that is to be changed first.
        parameter: &'static Parameter,
        /// Its value in its SI unit.
        value: f64,
        /// What it must satisfy, in words, with the other parameter's name and value.
        requirement: Requirement,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A parameter requests more samples, steps or pulses than a run may have.
    #[error("{name} = {value}{unit} makes {} {counted}, more than {}; {remedy}", Count(*.count), Count(parameter::MAX_COUNT),
        name = .parameter.key, unit = Behind(.parameter.unit))]
    TooMany {
        /// The parameter that is to be changed first.
        parameter: &'static Parameter,
        /// Its value in its SI unit.
        value: f64,
        /// How many it would be.
        count: f64,
        /// Of what, in the plural.
        counted: &'static str,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A table or list has the wrong shape: unsorted, too short, too long.
    #[error("{name}: {problem} (entry {entry}); {remedy}")]
    Table {
        /// The scenario key or argument that holds the table.
        name: &'static str,
        /// What is wrong with it.
        problem: &'static str,
        /// The first entry at fault, counted from 1.
        entry: usize,
        /// What to do about it.
        remedy: &'static str,
    },
    /// What has no meaning, such as `hold` on a three-way valve or a part that is not there.
    #[error("{what}; {remedy}")]
    Misuse {
        /// What was requested and why it cannot be.
        what: &'static str,
        /// What to request instead.
        remedy: &'static str,
    },
    /// Two features that make sense together and do not work together yet.
    #[error("{0}")]
    NotImplemented(&'static crate::limit::Limit),
    /// The requested state has no solution, such as an equilibrium of a plant that has none.
    #[error("{what}; {remedy}")]
    NoSolution {
        /// What was requested and why there is none.
        what: &'static str,
        /// What to request instead.
        remedy: &'static str,
    },
    /// The simulation stopped before its end.
    #[error("the simulation stopped at t = {time} s: {reason} ({quantity} = {value}{}); {remedy}", Behind(.unit))]
    Stopped {
        /// When, in s.
        time: f64,
        /// Why.
        reason: &'static str,
        /// The quantity in which it appears.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The SI unit of the value.
        unit: &'static str,
        /// What to change.
        remedy: &'static str,
    },
    /// The observer of the simulation ended it.
    #[error("the simulation was interrupted at t = {time} s")]
    Interrupted {
        /// When, in s.
        time: f64,
    },
}

/// A unit behind its number, with a space before it where there is one.
struct Behind(&'static str);

impl core::fmt::Display for Behind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, " {}", self.0) }
    }
}

/// A number of things as it is written in a message: to four digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count(pub f64);

impl core::fmt::Display for Count {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self(count) = *self;
        if count.is_finite() { write!(f, "{count:.3e}") } else { write!(f, "over {:e}", 1e308) }
    }
}

/// The other half of an [`Error::Inconsistent`]: a relation to a second quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Requirement {
    /// The relation, for instance "must be less than".
    pub relation: &'static str,
    /// The other quantity's name.
    pub other: &'static str,
    /// The other quantity's value in SI.
    pub value: f64,
    /// The SI unit.
    pub unit: &'static str,
}

impl core::fmt::Display for Requirement {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the rule that it {} {} = {}{}", self.relation, self.other, self.value, Behind(self.unit))
    }
}
