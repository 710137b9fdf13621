//! The truth: event-located runs of some of the rows.

use crate::work::{Row, STEP, STEPS};
use mckibben::simulation::simulate;

/// Tolerance of the runs that stand for the truth.
const TOLERANCE: f64 = 1e-11;

/// Length and pressure of some rows at the end.
pub struct Reference {
    ends: Vec<[f64; 2]>,
    /// Range of either over all these runs.
    range: [f64; 2],
}

/// How far an answer is from the truth: the larger of the errors in length and pressure, each over its range.
#[derive(Clone, Copy, Debug)]
pub struct Error {
    /// Of the middle row.
    pub median: f64,
    /// Of the worst row.
    pub worst: f64,
}

impl Error {
    /// Whether neither is above that of `other`.
    pub fn is_within(self, other: Self) -> bool {
        self.median <= other.median && self.worst <= other.worst
    }
}

impl Reference {
    /// Runs each row to the end of [`STEPS`].
    ///
    /// # Errors
    /// When a run fails.
    pub fn new(rows: &[Row]) -> Result<Self, String> {
        let mut ends = Vec::new();
        let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
        for row in rows {
            let run =
                simulate(&row.rig, row.start, STEPS as f64 * STEP, TOLERANCE).map_err(|error| error.to_string())?;
            let mut end = [f64::NAN; 2];
            for sample in run.samples(1e-3) {
                end = [sample.length, sample.pressure.0];
                low = [0, 1].map(|n| low[n].min(end[n]));
                high = [0, 1].map(|n| high[n].max(end[n]));
            }
            ends.push(end);
        }
        Ok(Self { ends, range: [high[0] - low[0], high[1] - low[1]] })
    }

    /// Errors of the last states of the same rows; infinite when a row is missing or not a number.
    pub fn error(&self, states: &[[f64; 4]]) -> Error {
        let mut errors: Vec<f64> =
            self.ends.iter().enumerate().map(|(row, end)| self.of_row(end, states.get(row))).collect();
        errors.sort_by(f64::total_cmp);
        Error { median: errors[errors.len() / 2], worst: errors[errors.len() - 1] }
    }

    fn of_row(&self, end: &[f64; 2], state: Option<&[f64; 4]>) -> f64 {
        let Some([length, _, pressure, _]) = state else { return f64::INFINITY };
        let errors = [(length - end[0]) / self.range[0], (pressure - end[1]) / self.range[1]];
        if errors.iter().any(|error| error.is_nan()) { f64::INFINITY } else { errors[0].abs().max(errors[1].abs()) }
    }
}
