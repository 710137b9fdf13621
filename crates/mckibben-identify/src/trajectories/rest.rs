//! The residuals of the time series: whether they drift, and whether they are more than the noise of the readings.
//!
//! A sensor drifts, the scenario lacks a part of the rig, or the search has ended in a valley that is not the deepest: each
//! leaves residuals that are no noise, and makes intervals that are too short. The noise of a reading is estimated from
//! its neighbours, whatever the model: by how far it lies from a parabola through three of them.

use super::{Identified, Observed, Runs, Task};
use crate::least_squares;
use crate::series::{self, Polynomial};

/// Standard errors of its slope above which the residual of a time series drifts.
const SIGNIFICANT: f64 = 8.0;
/// Change over the time series, in scatters of a reading about the line, below which it is not reported.
const SIZE: f64 = 1.0;

/// A time series whose residuals drift.
#[derive(Clone, Debug, PartialEq)]
pub struct Drift {
    /// The run.
    pub run: String,
    /// What was read.
    pub observed: Observed,
    /// Change of measured less simulated from the first reading to the last, in the SI unit, by a straight line.
    pub change: f64,
    /// Scatter of a reading about that line.
    pub scatter: f64,
}

/// A quantity of which more is left than its noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Unexplained {
    /// What was read.
    pub observed: Observed,
    /// Root mean square of the residuals, in the SI unit.
    pub left: f64,
    /// Standard deviation of the noise of a reading.
    pub noise: f64,
}

/// A quantity of which more is left than the standard deviation that is stated of its readings.
#[derive(Clone, Debug, PartialEq)]
pub struct Understated {
    /// What was read.
    pub observed: Observed,
    /// The size of its residuals, in the SI unit.
    pub left: f64,
    /// The standard deviation that is stated.
    pub deviation: f64,
}

impl Task {
    /// The quantities of which the model leaves more than the noise of their readings.
    pub fn unexplained(&self, found: &Identified) -> Vec<Unexplained> {
        let of = |(observed, scale): &(Observed, f64)| {
            let series = self.series_of(observed).map(|recorded| (&recorded.times[..], &recorded.values[..]));
            let left = self.typical(found, observed)? * scale;
            let noise = series::beyond_noise(left, series)?;
            Some(Unexplained { observed: observed.clone(), left, noise })
        };
        found.scales.iter().filter_map(of).collect()
    }

    /// The quantities of which the model leaves more than the standard deviation that is stated of their readings, beyond chance.
    pub fn understated(&self, found: &Identified) -> Vec<Understated> {
        let of = |(observed, _): &(Observed, f64)| {
            let (deviation, is_known) = self.scale(observed);
            let scale = found.scales.iter().find(|(of, _)| of == observed)?.1;
            let left = self.typical(found, observed)? * scale;
            let readings = self.series_of(observed).map(|recorded| recorded.values.len()).sum();
            let is_more = is_known && least_squares::exceeds_scales(left / deviation, readings);
            is_more.then(|| Understated { observed: observed.clone(), left, deviation })
        };
        found.left.iter().filter_map(of).collect()
    }

    /// The size of the residuals of a quantity in its scale: outliers that the search spares do not count to it. `None` without readings.
    fn typical(&self, found: &Identified, observed: &Observed) -> Option<f64> {
        let runs = Runs::whole(&self.runs, Vec::new(), self.tolerance, &self.search.monitor);
        let sizes = runs.scatter(&found.found.fit.residuals, self.search.loss);
        sizes.into_iter().find(|(of, _)| of == observed).map(|(_, size)| size)
    }

    /// The time series whose residuals drift from the first reading to the last.
    pub fn drifts(&self, found: &Identified) -> Vec<Drift> {
        let runs = Runs::whole(&self.runs, Vec::new(), self.tolerance, &self.search.monitor);
        let values = found.found.fit.values();
        let mut drifts = Vec::new();
        for (run, simulated) in self.runs.iter().zip(&found.simulated) {
            let mut residuals = Vec::new();
            runs.compare(run, simulated, &values, |_, residual, _| residuals.push(residual));
            let mut rest = residuals.as_slice();
            for recorded in &run.time_series {
                let (own, behind) = rest.split_at(recorded.times.len());
                rest = behind;
                let (Some(first), Some(last)) = (recorded.times.first(), recorded.times.last()) else { continue };
                let Some(line) = Polynomial::fit(&recorded.times, own, 0.5 * (first + last), 1) else { continue };
                let scatter = (line.squares / line.degrees_of_freedom.max(1) as f64).sqrt();
                let (slope, deviation) = (line.coefficients[1], scatter * line.standard_error(&[0.0, 1.0]));
                let change = -slope * (last - first);
                if slope.abs() > SIGNIFICANT * deviation && change.abs() > SIZE * scatter {
                    drifts.push(Drift { run: run.name.clone(), observed: recorded.observed.clone(), change, scatter });
                }
            }
        }
        drifts
    }
}
