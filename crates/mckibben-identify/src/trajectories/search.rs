//! The search: scales of the quantities, starts, and a horizon that grows.

use super::{Course, Observed, Recorded, Runs};
use crate::least_squares::{self, Evaluation, FitError, Found, Model, Search, Unknown};
use crate::series;
use mckibben::Error;
use mckibben_scenario::Scenario;
use thiserror::Error as ThisError;

/// How much of the runs is fitted.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Horizon {
    /// All of them at once.
    #[default]
    Whole,
    /// The first so many seconds, then more of them, then all.
    Growing(Vec<f64>),
}

/// What is to be found, from what.
#[derive(Clone, Debug)]
pub struct Task {
    /// The runs.
    pub runs: Vec<Recorded>,
    /// The numbers that are looked for.
    pub unknowns: Vec<Unknown>,
    /// More starts than the first.
    pub starts: Vec<Vec<f64>>,
    /// How much of the runs is fitted.
    pub horizon: Horizon,
    /// How the minimum is looked for.
    pub search: Search,
    /// Relative tolerance of a run.
    pub tolerance: f64,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Identified {
    /// Values with their uncertainty, and how many starts agreed.
    pub found: Found,
    /// The scenario of each run with these values.
    pub scenarios: Vec<Scenario>,
    /// Root mean square of what is left of each quantity, in its unit.
    pub left: Vec<(Observed, f64)>,
    /// Scale by which each quantity was weighed.
    pub scales: Vec<(Observed, f64)>,
}

/// Why nothing was found.
#[derive(Clone, Debug, PartialEq, ThisError)]
pub enum TrajectoryError {
    /// No readings.
    #[error("there are no readings of length, gauge pressure or tension; name their columns in [columns]")]
    NoReadings,
    /// Times that are no times.
    #[error("the {} of the run `{run}`: {why}; mend the table", observed.quantity().words())]
    BadCourse {
        /// The run.
        run: String,
        /// Of what.
        observed: Observed,
        /// What is wrong.
        why: String,
    },
    /// The rig cannot be built or run at the start.
    #[error("the run `{run}` cannot be simulated with the values of the start: {error}")]
    AtStart {
        /// The run.
        run: String,
        /// The core's error.
        error: Error,
    },
    /// A number that the model does not have at its start.
    #[error(
        "`{path}` does nothing where it starts: the part that it belongs to is absent at zero, or acts in none of the runs; start elsewhere, or hold it"
    )]
    Silent {
        /// The number.
        path: String,
    },
    /// The search found no minimum.
    #[error(transparent)]
    Fit(#[from] FitError),
}

impl Task {
    /// Looks for the values.
    ///
    /// # Errors
    /// [`TrajectoryError`], which says what to do.
    pub fn identify(&self) -> Result<Identified, TrajectoryError> {
        self.check()?;
        let spans = Observed::ALL.map(|observed| self.scale(observed));
        let (scales, known) = (spans.map(|(scale, _)| scale), spans.map(|(_, known)| known));
        let all_known = Observed::ALL.into_iter().zip(known).all(|(of, known)| known || !self.has(of));
        let search = Search { known_scales: all_known, ..self.search };
        let mut runs = Runs { runs: &self.runs, scales, until: f64::INFINITY, tolerance: self.tolerance };
        let mut unknowns = self.unknowns.clone();
        let mut starts = self.starts.clone();
        if let Horizon::Growing(ends) = &self.horizon {
            for end in ends {
                runs.until = *end;
                let found = least_squares::fit_from(&runs, &unknowns, &starts, &search)?;
                for (unknown, value) in unknowns.iter_mut().zip(found.fit.values()) {
                    unknown.start = value;
                }
                starts.clear();
            }
            runs.until = f64::INFINITY;
        }
        let mut found = least_squares::fit_from(&runs, &unknowns, &starts, &search)?;
        if !all_known {
            // Weigh each quantity by what is left of it, and go on from there.
            let scatter = runs.scatter(&found.fit.residuals);
            let rough = runs.scales;
            for (place, left) in scatter.into_iter().enumerate().filter(|(place, _)| !known[*place]) {
                // What is left of noiseless data says nothing: its scale is the span's rounding.
                runs.scales[place] = (left.unwrap_or(1.0) * rough[place]).max(1e-9 * rough[place]);
            }
            for (unknown, value) in unknowns.iter_mut().zip(found.fit.values()) {
                unknown.start = value;
            }
            let polished = least_squares::fit(&runs, &unknowns, &search);
            match polished {
                Ok(fit) => found.fit = fit,
                // Readings without noise leave nothing to weigh by.
                Err(_) => runs.scales = rough,
            }
        }
        let values = found.fit.values();
        let scenario = |run: &Recorded| {
            let failed = |error| TrajectoryError::AtStart { run: run.name.clone(), error };
            run.adjustable.at(&run.own(&values)).map_err(failed)
        };
        let scenarios = self.runs.iter().map(scenario).collect::<Result<_, _>>()?;
        let scatter = runs.scatter(&found.fit.residuals);
        let scaled = |factor: &dyn Fn(usize) -> Option<f64>| {
            let of = |(place, observed): (usize, Observed)| Some((observed, factor(place)? * runs.scales[place]));
            Observed::ALL.into_iter().enumerate().filter_map(of).collect()
        };
        let left = scaled(&|place| scatter[place]);
        let scales = scaled(&|place| scatter[place].map(|_| 1.0));
        Ok(Identified { found, scenarios, left, scales })
    }

    /// Residuals at values of the unknowns, each over the scale of its quantity, with their exact derivatives.
    pub fn evaluate(&self, values: &[f64]) -> Evaluation {
        let scales = Observed::ALL.map(|observed| self.scale(observed).0);
        Runs { runs: &self.runs, scales, until: f64::INFINITY, tolerance: self.tolerance }.evaluate(values)
    }

    fn courses(&self, observed: Observed) -> impl Iterator<Item = &Course> {
        self.runs.iter().flat_map(|run| &run.courses).filter(move |course| course.observed == observed)
    }

    fn has(&self, observed: Observed) -> bool {
        self.courses(observed).any(|course| !course.values.is_empty())
    }

    /// The deviation of a quantity's readings and that it is known, or their span.
    fn scale(&self, observed: Observed) -> (f64, bool) {
        let deviations: Vec<f64> = self.courses(observed).filter_map(|course| course.deviation).collect();
        if let Some(deviation) = deviations.first().filter(|_| deviations.len() == self.courses(observed).count()) {
            return (*deviation, true);
        }
        let values = || self.courses(observed).flat_map(|course| course.values.iter().copied());
        let span = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        (if span.is_finite() && span > 0.0 { span } else { 1.0 }, false)
    }

    /// That there is something to fit, and that it can be run from the start.
    fn check(&self) -> Result<(), TrajectoryError> {
        if !Observed::ALL.into_iter().any(|observed| self.has(observed)) {
            return Err(TrajectoryError::NoReadings);
        }
        for run in &self.runs {
            for course in &run.courses {
                let observed = course.observed;
                let bad = |why| TrajectoryError::BadCourse { run: run.name.clone(), observed, why };
                series::check(&course.times, &course.values, observed.quantity().words(), 0)
                    .map_err(|error| bad(error.to_string()))?;
                if let Some(first) = course.times.first().filter(|first| **first < 0.0) {
                    return Err(bad(format!("its first time is {first} s, before the start of the run at zero")));
                }
            }
            let first: Vec<f64> = self.unknowns.iter().map(|unknown| unknown.start).collect();
            let own = run.own(&first);
            let failed = |error| TrajectoryError::AtStart { run: run.name.clone(), error };
            run.built(&own).map_err(failed)?;
        }
        let runs = Runs { runs: &self.runs, scales: [1.0; 3], until: f64::INFINITY, tolerance: self.tolerance };
        if runs.residuals() == 0 {
            return Err(TrajectoryError::NoReadings);
        }
        let first: Vec<f64> = self.unknowns.iter().map(|unknown| unknown.start).collect();
        let Evaluation { residuals, slopes } = runs.evaluate(&first);
        if !residuals.iter().all(|residual| residual.is_finite()) {
            return Err(FitError::NoStart.into());
        }
        let silent = |unknown: &usize| slopes.iter().skip(*unknown).step_by(first.len()).all(|slope| *slope == 0.0);
        match (0..first.len()).find(silent) {
            Some(unknown) => Err(TrajectoryError::Silent { path: self.unknowns[unknown].name.clone() }),
            None => Ok(()),
        }
    }
}
