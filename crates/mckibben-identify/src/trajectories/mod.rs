//! Any numbers of a scenario from courses in time: length, gauge pressure and tension as a rig recorded them, of a joint
//! angle, angular velocity, torque, and those of both actuators.
//!
//! ```text
//! r = (y(t_k; θ) − y_k)/s_y        for each reading y_k of each course, at its own time t_k
//! ```
//!
//! A run is of a plant: one actuator with its load, a joint, or any that a file gives names. The course y(t; θ) is the
//! event-located engine's, and its derivatives by θ are exact: they come with the run in
//! dual numbers, through every stick, slip and switching of the valve. Runs go side by side on all cores.
//!
//! The scale s of a quantity is the deviation of its readings where that is known. Else a first fit weighs each
//! quantity by its span, and a second by the scatter that the first has left: so a poor pressure sensor does not
//! outweigh a good length sensor.
//!
//! A start far off may lie in another valley, since an oscillation of the wrong frequency falls out of step. Then
//! give more starts, or let the horizon grow: [`Horizon::Growing`] fits a short beginning first and lengthens it,
//! each stage from where the one before has ended.
//!
//! Where an oscillation is so sensitive that a whole run is of no use, [`Horizon::Segments`] fits it in short segments that
//! must join.
//!
//! Checked by `tests/trajectories.rs`: numbers put in come back out of noisy courses, several runs, what cannot be told
//! apart, and a start from which the growing horizon finds what the whole does not. That derivatives are those of
//! differences is held by the scenario crate's `tests/place.rs`.

mod held_out;
mod observed;
mod rest;
mod sampling;
mod search;
mod shooting;
mod simulated;
mod step_info;
mod subject;

pub use held_out::HeldOutRun;
pub use observed::{Observed, ObservedColumn};
pub use rest::{Drift, Unexplained};
pub use sampling::Sampling;
pub use search::{Horizon, Identified, Task, TrajectoryError};
pub use simulated::{Simulated, SimulatedReader, Watch};
pub use step_info::StepInfo;
pub use subject::{AdjustablePlant, Described, Subject, SubjectError};

use crate::least_squares::{Evaluation, Model, Monitor};
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
    /// Its courses.
    pub courses: Vec<TimeSeries>,
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
    /// The time of the last reading up to a horizon in s.
    fn duration(&self, until: f64) -> f64 {
        let times = self.courses.iter().flat_map(|course| &course.times).filter(|time| **time <= until);
        times.fold(0.0, |last, time| time.max(last))
    }

    /// The run at values of all unknowns, with only some of these looked for, which are then all.
    fn only(&self, unknowns: &[usize], values: &[f64]) -> Result<Self, Error> {
        let place = |(number, unknown): (usize, &usize)| Some((number, unknowns.iter().position(|of| of == unknown)?));
        let (numbers, unknowns): (Vec<usize>, Vec<usize>) = self.unknowns.iter().enumerate().filter_map(place).unzip();
        Ok(Self { subject: self.subject.only(&numbers, &self.own(values))?, unknowns, ..self.clone() })
    }

    /// The run with values of all unknowns.
    fn built(&self, values: &[f64]) -> Result<Built, SubjectError> {
        self.subject.built(&self.own(values))
    }

    /// The run as it is simulated with values of all unknowns, up to its last reading.
    fn simulated(&self, values: &[f64], tolerance: f64) -> Result<Simulated, TrajectoryError> {
        let duration = self.duration(f64::INFINITY).max(1e-9);
        let run = |built: Built| Ok(built.ready()?.simulate(duration, tolerance, &|_| Ok(()))?);
        self.built(values).and_then(run).map_err(|error| self.failed(error))
    }

    /// That it cannot be simulated.
    fn failed(&self, error: impl Into<SubjectError>) -> TrajectoryError {
        TrajectoryError::AtStart { run: self.name.clone(), error: error.into() }
    }

    /// Values of its own numbers out of those of all unknowns.
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
    /// Times and values of the readings of a run, course by course.
    fn readings<'r>(&'r self, run: &'r Recorded) -> impl Iterator<Item = (f64, f64)> + 'r {
        run.courses.iter().flat_map(|course| self.within(course))
    }

    /// Times and values of the readings of a course.
    fn within<'r>(&'r self, course: &'r TimeSeries) -> impl Iterator<Item = (f64, f64)> + 'r {
        let readings = course.times.iter().copied().zip(course.values.iter().copied());
        readings.filter(|(time, _)| *time <= self.until)
    }

    /// By what the residuals of a quantity are divided.
    fn scale(&self, observed: &Observed) -> f64 {
        self.scales.iter().find(|(of, _)| of == observed).map_or(1.0, |(_, scale)| *scale)
    }

    /// Residuals of one run and their derivatives by its own numbers; what has no value is not a number.
    fn of_run(&self, run: &Recorded, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (count, width) = (self.readings(run).count(), run.unknowns.len());
        let (mut residuals, mut slopes) = (vec![f64::NAN; count], vec![0.0; count * width]);
        let Ok(built) = run.built(values) else { return (residuals, slopes) };
        for first in run.subject.passes() {
            let mut row = 0;
            let full = built.seeded(&run.subject, first).and_then(|ready| {
                Ok(self.course(run, &ready, |residual| {
                    residuals[row] = residual.value;
                    run.subject.spread(first, &residual.slope, &mut slopes[row * width..][..width]);
                    row += 1;
                })?)
            });
            if full.is_err() {
                return (vec![f64::NAN; count], slopes);
            }
        }
        (residuals, slopes)
    }

    /// Residuals of one run alone.
    fn tried(&self, run: &Recorded, values: &[f64]) -> Vec<f64> {
        let mut residuals = Vec::new();
        let course = |built: Built| Ok(self.course(run, &built.ready()?, |residual| residuals.push(residual))?);
        match run.built(values).and_then(course) {
            Ok(()) => residuals,
            Err(_) => vec![f64::NAN; self.readings(run).count()],
        }
    }

    /// Runs a plant and visits each reading with its residual, over any scalar.
    fn course<R: Instantiate>(&self, run: &Recorded, ready: &Ready<R>, visit: impl FnMut(R)) -> Result<(), Error> {
        let duration = run.duration(self.until).max(1e-9);
        let watch = |time: f64| match self.monitor.is_stopped() {
            true => Err(Error::Interrupted { time }),
            false => Ok(()),
        };
        self.compare(run, &ready.simulate(R::constant(duration), self.tolerance, &watch)?, visit);
        Ok(())
    }

    /// Visits each reading with its residual.
    fn compare<R: Instantiate>(&self, run: &Recorded, simulated: &Simulated<R>, mut visit: impl FnMut(R)) {
        let mut reading = SimulatedReader::new(simulated);
        for course in &run.courses {
            let scale = R::constant(self.scale(&course.observed));
            for (time, value) in self.within(course) {
                let simulated = reading.read(&course.observed, R::constant(time));
                visit((simulated - R::constant(value)) / scale);
            }
        }
    }

    /// Root mean square residual of each quantity that has readings, in scales.
    pub(crate) fn scatter(&self, residuals: &[f64]) -> Vec<(Observed, f64)> {
        let mut sums: Vec<(Observed, f64, u32)> = observed_in(self.runs).into_iter().map(|of| (of, 0.0, 0)).collect();
        let mut residuals = residuals.iter();
        for course in self.runs.iter().flat_map(|run| &run.courses) {
            let Some((_, squares, count)) = sums.iter_mut().find(|(of, ..)| *of == course.observed) else { continue };
            for (_, residual) in self.within(course).zip(residuals.by_ref()) {
                (*squares, *count) = (*squares + residual * residual, *count + 1);
            }
        }
        let read = sums.into_iter().filter(|(.., count)| *count > 0);
        read.map(|(of, squares, count)| (of, (squares / f64::from(count)).sqrt())).collect()
    }
}

/// The quantities of which there are courses: those of one actuator or joint in their order, then columns in that of the runs.
fn observed_in(runs: &[Recorded]) -> Vec<Observed> {
    let mut found: Vec<Observed> = Vec::new();
    for course in runs.iter().flat_map(|run| &run.courses) {
        if !found.contains(&course.observed) {
            found.push(course.observed.clone());
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
        let parts: Vec<(Vec<f64>, Vec<f64>)> = self.runs.par_iter().map(|run| self.of_run(run, values)).collect();
        let (mut residuals, mut slopes) = (Vec::new(), Vec::new());
        for (run, (own_residuals, own_slopes)) in self.runs.iter().zip(parts) {
            let width = run.unknowns.len();
            for row in 0..own_residuals.len() {
                let begin = slopes.len();
                slopes.resize(begin + values.len(), 0.0);
                for (unknown, slope) in run.unknowns.iter().zip(&own_slopes[row * width..][..width]) {
                    slopes[begin + unknown] = *slope;
                }
            }
            residuals.extend(own_residuals);
        }
        Evaluation { residuals, slopes }
    }
}
