//! Any parameters of a scenario from time series: length, gauge pressure and tension as a rig recorded them, of a joint
//! angle, angular velocity, torque, and those of both actuators.
//!
//! ```text
//! r = (y(t_k; θ) − y_k)/s_y        for each reading y_k of each time series, at its time t_k
//! ```
//!
//! A run is of a plant: one actuator with its load, a joint, or any that a file gives names. The trajectory y(t; θ) is
//! the event-located engine's, and its derivatives with respect to θ are exact: they come with the run in
//! dual numbers, through every stick, slip and switching of the valve. Runs go side by side on all cores.
//!
//! The scale s of a quantity is the standard deviation of its readings where that is known. Else a first fit weighs each
//! quantity by its span, and a second by the scatter that the first has left: so a poor pressure sensor does not
//! outweigh a good length sensor. Under a loss that spares outliers the scatter is that of the median residual. Where the second leaves another scatter than that, as when the first has ended in a poor
//! place, further fits follow until the scales are what is left; [`Identified::unsettled`] names those that are not.
//!
//! A start far off may lie in another valley, since an oscillation of the wrong frequency falls out of step. Then
//! give more starts, or let the horizon grow: [`Horizon::Growing`] fits a short beginning first and lengthens it,
//! each stage from where the one before has ended.
//!
//! Where an oscillation is so sensitive that a whole run is of no use, [`Horizon::Segments`] fits it in short segments that
//! must join.
//!
//! Checked by `tests/trajectories.rs`: parameters put in come back out of noisy time series, several runs, what is not
//! identifiable, and a start from which the growing horizon finds what the whole does not. That derivatives are those
//! of differences is held by the scenario crate's `tests/place.rs`.

mod held_out;
mod observed;
mod rest;
mod sampling;
mod search;
mod sensor;
mod shooting;
mod simulated;
mod step_info;
mod subject;

pub use held_out::HeldOutRun;
pub use observed::{Observed, ObservedColumn};
pub use rest::{Drift, Understated, Unexplained};
pub use sampling::Sampling;
pub use search::{Horizon, Identified, Task, TrajectoryError};
pub use sensor::{AMOUNTS, Amount, Sensor, sample};
pub use simulated::{Simulated, SimulatedReader, Watch};
pub use step_info::StepInfo;
pub use subject::{AdjustablePlant, Described, Subject, SubjectError};

use crate::least_squares::{self, Evaluation, Loss, Model, Monitor};
use mckibben::Error;
use mckibben::Instantiate;
use rayon::prelude::*;
use simulated::{Built, Ready};

/// Readings of one quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeSeries {
    /// What was read.
    pub observed: Observed,
    /// When, in s from the start of the run; rising, the first not below zero.
    pub times: Vec<f64>,
    /// The readings in SI.
    pub values: Vec<f64>,
    /// Standard deviation of a reading, where it is known.
    pub deviation: Option<f64>,
    /// What the sensor makes of it.
    pub sensor: Sensor,
}

impl TimeSeries {
    /// Takes each sample that the sensor holds as one reading: the mean of its readings, at the mean of their times. A table has such a
    /// sample many times, and its repetitions know no more of it than the first.
    pub fn without_repetitions(mut self) -> Self {
        let Some(interval) = self.sensor.hold else { return self };
        let readings = self.times.iter().copied().zip(self.values.iter().copied());
        let mut samples: Vec<(f64, [f64; 3])> = Vec::new();
        for (time, value) in readings {
            let sample = sample(interval, time);
            match samples.last_mut() {
                Some((last, [count, times, values])) if *last == sample => {
                    (*count, *times, *values) = (*count + 1.0, *times + time, *values + value);
                }
                _ => samples.push((sample, [1.0, time, value])),
            }
        }
        let means = samples.into_iter().map(|(_, [count, times, values])| (times / count, values / count));
        (self.times, self.values) = means.unzip();
        self
    }
}

/// One run of the rig.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// What it is called.
    pub name: String,
    /// What it is of, and the numbers that are looked for in it.
    pub subject: Subject,
    /// Which unknown each of these numbers is.
    pub unknowns: Vec<usize>,
    /// Its time series.
    pub time_series: Vec<TimeSeries>,
}

/// All runs, as far as a horizon.
pub(crate) struct Runs<'a> {
    pub(crate) runs: &'a [Recorded],
    /// Scale of each quantity; 1 where there is none.
    pub(crate) scales: Vec<(Observed, f64)>,
    /// Readings after this time in s do not count.
    pub(crate) until: f64,
    pub(crate) tolerance: f64,
    /// Ends a run between two of its steps.
    pub(crate) monitor: Monitor,
}

impl Recorded {
    /// How long the run must be in s for all readings up to a horizon, with values of all unknowns.
    fn duration(&self, until: f64, values: &[f64]) -> f64 {
        let of_course = |series: &TimeSeries| {
            let sensor = series.sensor.at(values);
            let times = series.times.iter().filter(|time| **time <= until);
            times.fold(0.0, |last: f64, time| sensor.until(*time).max(last))
        };
        self.time_series.iter().map(of_course).fold(0.0, f64::max)
    }

    /// The unknowns that are looked for in the run: those of its subject, then those of its sensors.
    pub(crate) fn all_unknowns(&self) -> Vec<usize> {
        let mut all = self.unknowns.clone();
        let sensors: std::collections::BTreeSet<usize> =
            self.time_series.iter().flat_map(|series| series.sensor.unknowns()).collect();
        all.extend(sensors);
        all
    }

    /// What a simulated run with values of all unknowns says that the sensor of a time series reads at times that do
    /// not fall.
    pub fn readings(&self, series: &TimeSeries, (simulated, values): (&Simulated, &[f64]), times: &[f64]) -> Vec<f64> {
        let mut readings = Vec::with_capacity(times.len());
        let sensor = series.sensor.at(values);
        sensor.read(simulated, &series.observed, times.iter().copied(), |reading| readings.push(reading.value));
        readings
    }

    /// The run at values of all unknowns, with only some of these looked for, which are then all.
    fn only(&self, unknowns_of: &[usize], values: &[f64]) -> Result<Self, Error> {
        let place =
            |(number, unknown): (usize, &usize)| Some((number, unknowns_of.iter().position(|of| of == unknown)?));
        let (numbers, unknowns): (Vec<usize>, Vec<usize>) = self.unknowns.iter().enumerate().filter_map(place).unzip();
        let mut time_series = self.time_series.clone();
        for amount in time_series.iter_mut().flat_map(|series| series.sensor.amounts_mut()) {
            if let Amount::Unknown(unknown) = amount {
                *amount = match unknowns_of.iter().position(|of| of == unknown) {
                    Some(place) => Amount::Unknown(place),
                    None => Amount::Known(values[*unknown]),
                };
            }
        }
        let subject = self.subject.only(&numbers, &self.own(values))?;
        Ok(Self { name: self.name.clone(), subject, unknowns, time_series })
    }

    /// The run with values of all unknowns.
    fn built(&self, values: &[f64]) -> Result<Built, SubjectError> {
        self.subject.built(&self.own(values))
    }

    /// The run as it is simulated with values of all unknowns, up to its last reading.
    fn simulated(&self, values: &[f64], tolerance: f64) -> Result<Simulated, TrajectoryError> {
        let duration = self.duration(f64::INFINITY, values).max(1e-9);
        let run = |built: Built| Ok(built.ready()?.simulate(duration, tolerance, &|_| Ok(()))?);
        self.built(values).and_then(run).map_err(|error| self.failed(error))
    }

    /// That it cannot be simulated.
    fn failed(&self, error: impl Into<SubjectError>) -> TrajectoryError {
        TrajectoryError::AtStart { run: self.name.clone(), error: error.into() }
    }

    /// Values of its parameters out of those of all unknowns.
    fn own(&self, values: &[f64]) -> Vec<f64> {
        self.unknowns.iter().map(|unknown| values[*unknown]).collect()
    }
}

impl<'a> Runs<'a> {
    /// From beginning to end.
    pub(crate) fn whole(runs: &'a [Recorded], scales: Vec<(Observed, f64)>, tolerance: f64, monitor: &Monitor) -> Self {
        Self { runs, scales, until: f64::INFINITY, tolerance, monitor: monitor.clone() }
    }
}

impl Runs<'_> {
    /// Times and values of the readings of a run, time series by time series.
    fn readings<'r>(&'r self, run: &'r Recorded) -> impl Iterator<Item = (f64, f64)> + 'r {
        run.time_series.iter().flat_map(|series| self.within(series))
    }

    /// Times and values of the readings of a time series.
    fn within<'r>(&'r self, series: &'r TimeSeries) -> impl Iterator<Item = (f64, f64)> + 'r {
        let readings = series.times.iter().copied().zip(series.values.iter().copied());
        readings.filter(|(time, _)| *time <= self.until)
    }

    /// By what the residuals of a quantity are divided.
    fn scale(&self, observed: &Observed) -> f64 {
        self.scales.iter().find(|(of, _)| of == observed).map_or(1.0, |(_, scale)| *scale)
    }

    /// Residuals of one run and their derivatives with respect to its own unknowns, in the order of
    /// [`Recorded::all_unknowns`]; what has no value is not a number.
    fn of_run(&self, run: &Recorded, own: &[usize], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (count, width) = (self.readings(run).count(), own.len());
        let (mut residuals, mut slopes) = (vec![f64::NAN; count], vec![0.0; count * width]);
        let by_sensor = |row: &mut [f64], of_sensor: &[(usize, f64)]| {
            for (unknown, slope) in of_sensor {
                if let Some(place) = own.iter().position(|of| of == unknown) {
                    row[place] = *slope;
                }
            }
        };
        let mut fill = || -> Result<(), SubjectError> {
            let built = run.built(values)?;
            if run.subject.width() == 0 {
                return Ok(self.series(run, &built.ready()?, values, |row, residual, of_sensor| {
                    residuals[row] = residual;
                    by_sensor(&mut slopes[row * width..][..width], of_sensor);
                })?);
            }
            for first in run.subject.passes() {
                self.series(run, &built.seeded(&run.subject, first)?, values, |row, residual, of_sensor| {
                    let slopes = &mut slopes[row * width..][..width];
                    residuals[row] = residual.value;
                    run.subject.spread(first, &residual.slope, &mut slopes[..run.unknowns.len()]);
                    by_sensor(slopes, of_sensor);
                })?;
            }
            Ok(())
        };
        match fill() {
            Ok(()) => (residuals, slopes),
            Err(_) => (vec![f64::NAN; count], slopes),
        }
    }

    /// Residuals of one run alone.
    fn tried(&self, run: &Recorded, values: &[f64]) -> Vec<f64> {
        let mut residuals = Vec::new();
        let series =
            |built: Built| Ok(self.series(run, &built.ready()?, values, |_, residual, _| residuals.push(residual))?);
        match run.built(values).and_then(series) {
            Ok(()) => residuals,
            Err(_) => vec![f64::NAN; self.readings(run).count()],
        }
    }

    /// Runs a plant and visits each reading with its residual, over any scalar: see [`Runs::compare`].
    fn series<R: Instantiate>(
        &self,
        run: &Recorded,
        ready: &Ready<R>,
        values: &[f64],
        visit: impl FnMut(usize, R, &[(usize, f64)]),
    ) -> Result<(), Error> {
        let duration = run.duration(self.until, values).max(1e-9);
        let watch = |time: f64| match self.monitor.is_stopped() {
            true => Err(Error::Interrupted { time }),
            false => Ok(()),
        };
        self.compare(run, &ready.simulate(R::constant(duration), self.tolerance, &watch)?, values, visit);
        Ok(())
    }

    /// Visits each reading, by its index in the run, with its residual and its derivatives with respect to the unknowns
    /// of its sensor.
    fn compare<R: Instantiate>(
        &self,
        run: &Recorded,
        simulated: &Simulated<R>,
        values: &[f64],
        mut visit: impl FnMut(usize, R, &[(usize, f64)]),
    ) {
        let mut row = 0;
        for series in &run.time_series {
            let scale = self.scale(&series.observed);
            let readings: Vec<(f64, f64)> = self.within(series).collect();
            let mut measured = readings.iter().map(|(_, value)| *value);
            let times = readings.iter().map(|(time, _)| *time);
            series.sensor.at(values).read(simulated, &series.observed, times, |reading| {
                let measured = R::constant(measured.next().unwrap_or(f64::NAN));
                let by_amount = series.sensor.amounts().into_iter().zip(reading.by_amounts);
                let by_sensor: Vec<(usize, f64)> = by_amount
                    .filter_map(|(amount, slope)| match amount {
                        Amount::Unknown(unknown) => Some((unknown, slope / scale)),
                        Amount::Known(_) => None,
                    })
                    .collect();
                visit(row, (reading.value - measured) / R::constant(scale), &by_sensor);
                row += 1;
            });
        }
    }

    /// The size of the residuals of each quantity that has readings, in scales: the root mean square, or, under a loss that spares
    /// outliers, a size that these do not change.
    pub(crate) fn scatter(&self, residuals: &[f64], loss: Loss) -> Vec<(Observed, f64)> {
        let mut own: Vec<(Observed, Vec<f64>)> =
            observed_in(self.runs).into_iter().map(|of| (of, Vec::new())).collect();
        let mut residuals = residuals.iter();
        for series in self.runs.iter().flat_map(|run| &run.time_series) {
            let Some((_, own)) = own.iter_mut().find(|(of, _)| *of == series.observed) else { continue };
            own.extend(self.within(series).zip(residuals.by_ref()).map(|(_, residual)| *residual));
        }
        let read = own.into_iter().filter(|(_, own)| !own.is_empty());
        read.map(|(of, own)| (of, least_squares::typical(own.into_iter(), loss))).collect()
    }
}

/// The quantities of which there are time series: those of one actuator or joint in their order, then columns in that
/// of the runs.
fn observed_in(runs: &[Recorded]) -> Vec<Observed> {
    let mut found: Vec<Observed> = Vec::new();
    for series in runs.iter().flat_map(|run| &run.time_series) {
        if !found.contains(&series.observed) {
            found.push(series.observed.clone());
        }
    }
    found.sort_by_key(|of| of.index().unwrap_or(Observed::ALL.len()));
    found
}

impl Model for Runs<'_> {
    fn residuals_at(&self, values: &[f64]) -> Vec<f64> {
        self.runs.par_iter().map(|run| self.tried(run, values)).collect::<Vec<_>>().concat()
    }

    fn rounding(&self) -> f64 {
        // The steps of a run change with its numbers, and its error with them.
        1e-1 * self.tolerance
    }

    fn precision(&self) -> f64 {
        // The derivatives of a run are less exact than the run.
        1e2 * self.tolerance
    }

    fn residuals(&self) -> usize {
        self.runs.iter().map(|run| self.readings(run).count()).sum()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let of_run = |run: &Recorded| {
            let own = run.all_unknowns();
            let (residuals, slopes) = self.of_run(run, &own, values);
            (own, residuals, slopes)
        };
        let parts: Vec<(Vec<usize>, Vec<f64>, Vec<f64>)> = self.runs.par_iter().map(of_run).collect();
        let (mut residuals, mut slopes) = (Vec::new(), Vec::new());
        for (own, own_residuals, own_slopes) in parts {
            let width = own.len();
            for row in 0..own_residuals.len() {
                let begin = slopes.len();
                slopes.resize(begin + values.len(), 0.0);
                for (unknown, slope) in own.iter().zip(&own_slopes[row * width..][..width]) {
                    slopes[begin + unknown] = *slope;
                }
            }
            residuals.extend(own_residuals);
        }
        Evaluation { residuals, slopes }
    }
}
