//! What is told and drawn of the runs: how many, why some failed, the range of each reduction.
//!
//! Its size does not depend on the number of runs: of many, a figure keeps every second, third, … by its row.

use super::rows::Outcome;
use crate::quantities::{common_prefix, count, digits};
use crate::terminal::{FAINT, HEADING, NOTABLE, styled, width, wrap};
use mckibben_scenario::{ReducedColumn, Sweep};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Runs that a figure keeps at most.
const DRAWN: u64 = 40_000;
/// Reasons that are told.
const TOLD: usize = 3;

/// What has been seen of the runs.
#[derive(Clone, Debug)]
pub struct Tally {
    reductions: Vec<ReducedColumn>,
    runs: u64,
    failed: u64,
    reasons: BTreeMap<u64, String>,
    spreads: Vec<Spread>,
    /// Which rows are kept for a figure: those that this divides; none where there is no figure.
    stride: Option<u64>,
    kept: BTreeMap<u64, Vec<f64>>,
}

/// Least, sum and greatest of a reduction, and how many runs have it.
#[derive(Clone, Copy, Debug)]
struct Spread {
    least: f64,
    sum: f64,
    greatest: f64,
    runs: u64,
}

impl Tally {
    /// Begins to look at a sweep; with a figure, its values are kept.
    pub fn new(sweep: &Sweep, is_drawn: bool) -> Self {
        let reductions = sweep.record().reduced().unwrap_or_default();
        let nothing = Spread { least: f64::INFINITY, sum: 0.0, greatest: f64::NEG_INFINITY, runs: 0 };
        Self {
            spreads: vec![nothing; reductions.len()],
            reductions,
            runs: 0,
            failed: 0,
            reasons: BTreeMap::new(),
            stride: is_drawn.then(|| sweep.rows().div_ceil(DRAWN).max(1)),
            kept: BTreeMap::new(),
        }
    }

    /// Sees a run.
    pub fn see(&mut self, row: u64, outcome: &Outcome) {
        self.runs += 1;
        if self.stride.is_some_and(|stride| row.is_multiple_of(stride)) {
            let values = match outcome {
                Outcome::Reduced(values) => values.iter().map(|value| value.unwrap_or(f64::NAN)).collect(),
                Outcome::Failed(_) | Outcome::Sampled(_) => vec![f64::NAN; self.reductions.len()],
            };
            self.kept.insert(row, values);
        }
        match outcome {
            Outcome::Failed(reason) => {
                self.failed += 1;
                self.reasons.insert(row, reason.clone());
                if self.reasons.len() > TOLD {
                    self.reasons.pop_last();
                }
            }
            Outcome::Reduced(values) => {
                for (spread, value) in self.spreads.iter_mut().zip(values) {
                    if let Some(value) = value {
                        spread.least = spread.least.min(*value);
                        spread.greatest = spread.greatest.max(*value);
                        spread.sum += value;
                        spread.runs += 1;
                    }
                }
            }
            Outcome::Sampled(_) => {}
        }
    }

    /// Counts runs of which nothing but their number is known.
    pub fn count(&mut self, runs: u64, failed: u64) {
        self.runs += runs;
        self.failed += failed;
    }

    /// How many runs there were.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// How many of them failed.
    pub fn failed(&self) -> u64 {
        self.failed
    }

    /// The reason of the first run that failed, where it is known.
    pub fn first_reason(&self) -> Option<&str> {
        self.reasons.values().next().map(String::as_str)
    }

    /// The values kept for a figure by their rows, not a number where there is none, and every how many rows there is one.
    pub fn kept(&self) -> (&BTreeMap<u64, Vec<f64>>, u64) {
        (&self.kept, self.stride.unwrap_or(1))
    }

    /// The range of each reduction as a table.
    pub fn ranges(&self) -> String {
        let mut text = String::new();
        let known = || self.reductions.iter().zip(&self.spreads).filter(|(_, spread)| spread.runs > 0);
        if known().next().is_none() {
            return text;
        }
        let names = known().map(|(reduction, _)| reduction.name.len()).max().unwrap_or(0);
        // Room for ten characters of digits and prefix before the longest unit.
        let width = known().map(|(reduction, _)| 10 + reduction.unit.len()).max().unwrap_or(0).max(14);
        put(&mut text, format_args!("\n{}\n", styled(HEADING, "Reductions")));
        let head = format!("  {:<names$}{:>width$}{:>width$}{:>width$}", "", "least", "mean", "greatest");
        put(&mut text, format_args!("{}\n", styled(FAINT, head)));
        for (reduction, spread) in known() {
            let values = [spread.least, spread.sum / spread.runs as f64, spread.greatest];
            let [least, mean, greatest] = values.map(told(&values, reduction.unit));
            let missing = self.runs - self.failed - spread.runs;
            let note = if missing > 0 { format!("  none in {} runs", count(missing)) } else { String::new() };
            put(
                &mut text,
                format_args!(
                    "  {:<names$}{least:>width$}{mean:>width$}{greatest:>width$}{}\n",
                    reduction.name,
                    styled(FAINT, note)
                ),
            );
        }
        text
    }

    /// The runs that failed, with the first reasons.
    pub fn failures(&self) -> String {
        if self.failed == 0 {
            return String::new();
        }
        let heading = format!("{} of {} runs failed", count(self.failed), count(self.runs));
        let mut text = format!("\n{}\n", styled(NOTABLE, heading));
        for (row, reason) in &self.reasons {
            let reason = reason.split_whitespace().collect::<Vec<_>>().join(" ");
            put(&mut text, format_args!("{}\n", wrap(&format!("run {row}: {reason}"), "  ", width())));
        }
        if self.reasons.len() as u64 != self.failed {
            text.push_str("  the column `error` has the others\n");
        }
        text
    }
}

/// Values under one prefix.
fn told<'a>(values: &[f64], unit: &'a str) -> impl Fn(f64) -> String + use<'a> {
    // The kilogram has a prefix of its own, which only the gram can lose; what has no unit takes no prefix.
    let (scale, unit) = match unit.strip_prefix("kg") {
        Some(rest) => (1e3, format!("g{rest}")),
        None => (1.0, unit.to_owned()),
    };
    let scaled: Vec<f64> = values.iter().map(|value| value * scale).collect();
    let (factor, prefix) = if unit.is_empty() { (1.0, "") } else { common_prefix(&scaled) };
    move |value| format!("{} {prefix}{unit}", digits(value * scale * factor)).trim_end().to_owned()
}

fn put(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(arguments);
}
