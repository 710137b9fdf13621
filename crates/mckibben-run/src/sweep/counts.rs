//! What is printed and drawn of the runs: how many, why some failed, the range of each reduction.
//!
//! Its size does not depend on the number of runs: of many, a figure keeps every second, third, … by its row.

use super::rows::Outcome;
use super::warned::WarnedRuns;
use mckibben_scenario::{ReducedColumn, Sweep};
use std::collections::BTreeMap;

/// Runs that a figure keeps at most.
const DRAWN: u64 = 40_000;
/// Reasons that are printed.
const REPORTED: usize = 3;

/// What has been seen of the runs.
#[derive(Clone, Debug)]
pub struct SweepCounts {
    reductions: Vec<ReducedColumn>,
    runs: u64,
    failed: u64,
    reasons: BTreeMap<u64, String>,
    spreads: Vec<Spread>,
    /// Which rows are kept for a figure: those that this divides; none where there is no figure.
    stride: Option<u64>,
    kept: BTreeMap<u64, Vec<f64>>,
    warned: WarnedRuns,
}

/// Least, sum and greatest of a reduction, and how many runs have it.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// The least.
    pub least: f64,
    /// The sum.
    pub sum: f64,
    /// The greatest.
    pub greatest: f64,
    /// How many runs have it.
    pub runs: u64,
}

impl SweepCounts {
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
            warned: WarnedRuns::default(),
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
                if self.reasons.len() > REPORTED {
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

    /// Takes the warnings of runs.
    pub fn warn(&mut self, warned: &WarnedRuns) {
        self.warned.add_all(warned);
    }

    /// The warnings by their codes: of how many runs, and the first of each.
    pub fn warned(&self) -> &WarnedRuns {
        &self.warned
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

    /// The range of each reduction that any run has.
    pub fn ranges(&self) -> impl Iterator<Item = (&ReducedColumn, Spread)> {
        self.reductions.iter().zip(self.spreads.iter().copied()).filter(|(_, spread)| spread.runs > 0)
    }

    /// The first runs that failed, with the reasons, where they are known.
    pub fn reasons(&self) -> impl Iterator<Item = (u64, &str)> {
        self.reasons.iter().map(|(row, reason)| (*row, reason.as_str()))
    }
}
