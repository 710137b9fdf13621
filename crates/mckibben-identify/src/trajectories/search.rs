//! The search: scales of the quantities, starts, and a horizon that grows.

use super::shooting::{self, Shot};
use super::{Amount, Described, Observed, Recorded, Runs, Simulated, SubjectError, TimeSeries, observed_in};
use crate::adjustable::SwitchedOff;
use crate::least_squares::{
    self, Ending, Estimate, Evaluation, Fit, FitError, Found, Loss, Model, Monitor, Search, Unknown,
};
use crate::series;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use thiserror::Error as ThisError;

/// How much of the runs is fitted.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Horizon {
    /// All of them at once.
    #[default]
    Whole,
    /// The first so many seconds, then more of them, then all.
    Growing(Vec<f64>),
    /// All at once, in segments of so many seconds that must join: for runs that are too sensitive to be fitted whole.
    Segments(f64),
}

/// Segments into which a run may be divided: the unknowns of their joints are solved for densely.
const MOST_SEGMENTS: f64 = 500.0;
/// Fits at most in which quantities are weighed by their residuals, after the one in which they are weighed by their spans.
const WEIGHINGS: usize = 6;
/// Ratio of a residual and its scale up to which the scale has settled. Values change with the square of what is left, and standard
/// errors by as much.
const SETTLED: f64 = 1.1;
/// Part of its span below which what is left of a quantity is no noise, and no measure of a weight; and the least scale.
const NOISELESS: [f64; 2] = [1e-6, 1e-9];

/// Ratio of what a whole run and its segments leave, up to which they are alike; and the probability of the F distribution beyond which
/// their difference is no chance.
const ALIKE: f64 = 1.01;
const NO_CHANCE: f64 = 0.999;

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
    /// What each run is of, with these values.
    pub scenarios: Vec<Described>,
    /// Root mean square residual of each quantity, in its unit.
    pub left: Vec<(Observed, f64)>,
    /// Scale by which each quantity was weighed.
    pub scales: Vec<(Observed, f64)>,
    /// Whether the search was ended from outside while quantities without a known deviation were still weighed by their spans.
    pub weighed_by_spans: bool,
    /// Quantities without a known deviation whose scale and residual differ although they were weighed again and again.
    pub unsettled: Vec<Observed>,
    /// The runs with these values, up to their last reading.
    pub simulated: Vec<Simulated>,
    /// Duration in s of the segments of which the runs are made, where they could not be fitted whole.
    pub segments: Option<f64>,
    /// What ended the search from outside before it was done, if something did: an interruption, or the limit of time.
    pub stopped: Option<Ending>,
}

/// Why nothing was found.
#[derive(Clone, Debug, PartialEq, ThisError)]
pub enum TrajectoryError {
    /// No readings.
    #[error(
        "there are no readings of length, pressure, tension, temperature or mass flow, nor of a joint; name their columns in [columns]"
    )]
    NoReadings,
    /// Readings of a joint in a run of one actuator.
    #[error(
        "the run `{run}` has readings of the {}, which only a joint has; leave them out, or set load.kind = \"antagonistic-joint\"",
        observed.words()
    )]
    NoJoint {
        /// The run.
        run: String,
        /// Of what.
        observed: Observed,
    },
    /// Readings of a column that the plant of a run does not have.
    #[error("the run `{run}` has readings of the {}, which its plant does not have; name a column of its parts", observed.words())]
    NoColumn {
        /// The run.
        run: String,
        /// Of what.
        observed: Observed,
    },
    /// Times that are no times.
    #[error("the {} of the run `{run}`: {why}", observed.words())]
    BadSeries {
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
        /// What is wrong with the values.
        error: SubjectError,
    },
    /// A number that the model does not have at its start.
    #[error("`{path}` changes no reading where it starts, at {start}; readings end at {until} s: {}", silence(path, *until))]
    Silent {
        /// The number.
        path: String,
        /// Its start, in its SI unit.
        start: f64,
        /// The time of the last reading in s.
        until: f64,
    },
    /// A number at whose start its part is switched off, in every run that has it.
    #[error(transparent)]
    SwitchedOff(#[from] SwitchedOff),
    /// No more readings that the unknowns change than there are unknowns.
    #[error(
        "{changed} of {readings} readings depend on the {unknowns} parameters of [fit], and cannot determine them; readings end at {until} s: \
         record longer or sample faster, or fit fewer parameters"
    )]
    FewReadings {
        /// How many of the readings depend on a parameter.
        changed: usize,
        /// How many there are.
        readings: usize,
        /// How many parameters.
        unknowns: usize,
        /// The time of the last reading in s.
        until: f64,
    },
    /// Numbers of sensors in segments.
    #[error(
        "numbers of sensors are not looked for in segments; fit the runs whole, or give the numbers in [columns] and leave them out \
         of [fit]"
    )]
    SensorsInSegments,
    /// Segments that are none.
    #[error(
        "segments of {every} s do not divide a run of {duration} s; give a duration above zero, shorter than the run, in which a run has at most {MOST_SEGMENTS}"
    )]
    Segments {
        /// Their duration in s.
        every: f64,
        /// The duration of the longest run in s.
        duration: f64,
    },
    /// The search found no minimum.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// Why a parameter may change no reading, and what to do about it.
fn silence(path: &str, until: f64) -> &'static str {
    match path.contains("_delay") || path.contains("dead_time") {
        _ if until <= 0.0 => "there are no readings after the start of a run; record longer",
        true => {
            "a valve whose delay is longer than its pulses never moves; start below the shortest pulse, or give longer records or pulses"
        }
        false => {
            "the part that it belongs to is absent at zero, or acts later or in none of the runs; start elsewhere, record longer, or hold it"
        }
    }
}

impl Runs<'_> {
    /// The starts of the unknowns as the values that a search had reached when it was ended from outside.
    fn unfinished(&self, unknowns: &[Unknown], ending: Ending) -> Fit {
        let values: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
        let calm = Runs { scales: self.scales.clone(), monitor: Monitor::default(), ..*self };
        let residuals = calm.residuals_at(&values);
        Fit::without_intervals(unknowns, &values, &residuals, residuals.len(), ending)
    }
}

/// The span of each quantity, or its known deviation, and whether that is one.
type Spans = [(Observed, (f64, bool))];

/// The scales of all quantities, of those without a known deviation by the residuals of a fit under a loss.
fn weighed(runs: &Runs<'_>, spans: &Spans, residuals: &[f64], loss: Loss) -> Vec<(Observed, f64)> {
    let (typical, mean) = (runs.scatter(residuals, loss), runs.scatter(residuals, Loss::Squares));
    let of_quantity = |sizes: &[(Observed, f64)], of: &Observed| {
        sizes.iter().find(|(other, _)| other == of).map_or(1.0, |(_, size)| *size)
    };
    let mut weighed = Vec::with_capacity(spans.len());
    for ((of, scale), (_, (span, known))) in runs.scales.iter().zip(spans) {
        let typical = scale * of_quantity(&typical, of);
        // Half of the readings are met exactly, as those of a muscle at rest: the others are no outliers.
        let left = if typical > NOISELESS[0] * span { typical } else { scale * of_quantity(&mean, of) };
        // The residual of noiseless data says nothing: its scale is the span's rounding.
        weighed.push((of.clone(), if *known { *scale } else { left.max(NOISELESS[1] * span) }));
    }
    weighed
}

/// The quantities without a known deviation whose scale is not what a fit leaves of them, unless both are no noise.
fn unsettled_in(scales: &[(Observed, f64)], left: &[(Observed, f64)], spans: &Spans) -> Vec<Observed> {
    let mut found = Vec::new();
    for (((of, scale), (_, left)), (_, (span, is_known))) in scales.iter().zip(left).zip(spans) {
        let ratio = (left / scale).max(scale / left);
        if !is_known && ratio > SETTLED && left.max(*scale) > NOISELESS[0] * span {
            found.push(of.clone());
        }
    }
    found
}

/// Whether the initial states of segments explain more of the readings than as many unknowns do by chance. If not, the whole run, which
/// has none of them, is as good: what it leaves is more by a hundredth at most, or by what the F test of nested models leaves to chance
/// (the extra sum of squares; Bates & Watts 1988, Nonlinear Regression Analysis and Its Applications, chapter 3).
fn is_needed(states: usize, joined: &Fit, whole: &Fit, search: &Search) -> bool {
    let loss = search.loss_of(&joined.residuals);
    let [of_joined, of_whole] = [joined, whole].map(|fit| loss.cost(&fit.residuals));
    if of_whole <= ALIKE * of_joined {
        return false;
    }
    let (states, rest) = (states.max(1) as f64, joined.degrees_of_freedom.max(1) as f64);
    let ratio = (of_whole - of_joined) / states / (of_joined / rest);
    FisherSnedecor::new(states, rest).is_ok_and(|chance| chance.cdf(ratio) > NO_CHANCE)
}

impl Task {
    /// Searches for the values that fit best. Where the search does not end at a minimum, or is ended by its monitor, the result
    /// has the best values without intervals, and says so: [`Fit::ending`], [`Identified::stopped`].
    ///
    /// # Errors
    /// [`TrajectoryError`], which says what to do.
    pub fn identify(&self) -> Result<Identified, TrajectoryError> {
        self.check()?;
        let spans: Vec<(Observed, (f64, bool))> = observed_in(&self.runs)
            .into_iter()
            .filter(|of| self.has(of))
            .map(|of| (of.clone(), self.scale(&of)))
            .collect();
        let scales = spans.iter().map(|(of, (scale, _))| (of.clone(), *scale)).collect();
        let all_known = spans.iter().all(|(_, (_, known))| *known);
        let search = Search { known_scales: all_known, any_end: true, ..self.search.clone() };
        let mut runs = Runs::whole(&self.runs, scales, self.tolerance, &self.search.monitor);
        let mut unknowns = self.unknowns.clone();
        let mut starts = self.starts.as_slice();
        let mut first: Option<Found> = None;
        if let Horizon::Growing(ends) = &self.horizon {
            for end in ends {
                runs.until = *end;
                let found = match least_squares::fit_from(&runs, &unknowns, starts, &search) {
                    Err(FitError::Interrupted) if first.is_some() => break,
                    found => found?,
                };
                unknowns = least_squares::starting_at(&unknowns, &found.fit.values());
                starts = &[];
                // What the starts led to is said of the beginning, from which the later stages go on.
                first.get_or_insert(found);
            }
            runs.until = f64::INFINITY;
        }
        let mut found = match (search.monitor.ending(), &first) {
            (Some(ending), Some(_)) => (Found::only(runs.unfinished(&unknowns, ending)), None),
            _ => self.searched(&runs, &unknowns, starts, &search)?,
        };
        if let Some(first) = first {
            found.0 = Found { fit: found.0.fit, ..first };
        }
        // Weigh each quantity by its residual, and go on from there. A fit that leaves a poor place behind leaves other residuals than
        // those that it was weighed by, so that they are weighed again.
        let mut unsettled = Vec::new();
        let mut is_weighed = all_known;
        for weighing in 0..=WEIGHINGS {
            if all_known || search.monitor.is_stopped() {
                break;
            }
            let (rough, weighed) = (runs.scales.clone(), weighed(&runs, &spans, &found.0.fit.residuals, search.loss));
            unsettled = unsettled_in(&rough, &weighed, &spans);
            if weighing == WEIGHINGS || (weighing > 0 && unsettled.is_empty()) {
                break;
            }
            // A search that may take no more steps does not take them by other weights.
            if weighing > 0 && matches!(found.0.fit.ending, Ending::Steps { .. }) {
                unsettled.clear();
                break;
            }
            // Readings without noise leave nothing to weigh by.
            let noisy: Vec<Observed> = weighed
                .iter()
                .zip(&spans)
                .filter(|((_, left), (_, (span, _)))| *left > NOISELESS[0] * span)
                .map(|((of, _), _)| of.clone())
                .collect();
            unsettled.retain(|of| noisy.contains(of));
            runs.scales = weighed;
            unknowns = least_squares::starting_at(&unknowns, &found.0.fit.values());
            let was_minimum = found.0.fit.ending == Ending::Minimum;
            let polish = |any_end: bool| self.searched(&runs, &unknowns, &[], &Search { any_end, ..search.clone() });
            let polished = match polish(!was_minimum) {
                // Steps by derivatives alone may stall short of a minimum to which steps without them lead.
                Err(_) if was_minimum && !noisy.is_empty() => {
                    polish(true).ok().filter(|(polished, _)| polished.fit.ending == Ending::Minimum)
                }
                polished => polished.ok(),
            };
            let Some((polished, joined)) = polished else {
                runs.scales = rough;
                break;
            };
            is_weighed = true;
            found = (Found { fit: polished.fit, ..found.0 }, joined);
        }
        let weighed_by_spans = !is_weighed && search.monitor.is_stopped();
        if search.monitor.is_stopped() {
            unsettled.clear();
        }
        let (mut found, joined) = found;
        // In segments the runs are simulated already, with the values as they were found.
        if joined.is_none() {
            let calm = Runs { scales: runs.scales.clone(), monitor: Monitor::default(), ..runs };
            found.fit = self.with_lags_at_zero(found.fit.on_bounds(&calm), &calm, &search);
        }
        let values = found.fit.values();
        let scenario = |run: &Recorded| run.subject.at(&run.own(&values)).map_err(|error| run.failed(error));
        let scenarios = self.runs.iter().map(scenario).collect::<Result<_, _>>()?;
        let segments = match (&self.horizon, &joined) {
            (Horizon::Segments(every), Some(_)) => Some(*every),
            _ => None,
        };
        let whole = || self.runs.iter().map(|run| run.simulated(&values, self.tolerance)).collect();
        let simulated = joined.map_or_else(whole, Ok)?;
        let scatter = runs.scatter(&found.fit.residuals, Loss::Squares);
        let left = scatter.into_iter().map(|(of, residual)| (of.clone(), residual * runs.scale(&of))).collect();
        let scales = runs.scales;
        let stopped = self.search.monitor.ending();
        Ok(Identified { found, scenarios, left, scales, weighed_by_spans, unsettled, simulated, segments, stopped })
    }

    /// The best values from these starts, with the runs in segments where they cannot be fitted whole.
    fn searched(
        &self,
        runs: &Runs<'_>,
        unknowns: &[Unknown],
        starts: &[Vec<f64>],
        search: &Search,
    ) -> Result<(Found, Option<Vec<Simulated>>), TrajectoryError> {
        let Horizon::Segments(every) = self.horizon else {
            return Ok((least_squares::fit_from(runs, unknowns, starts, search)?, None));
        };
        let (joined, simulated, states) = match shooting::fit(runs, unknowns, every, search)? {
            Shot::Joined(fit, simulated, states) => (fit, simulated, states),
            Shot::Stopped(values, ending) => {
                let reached = least_squares::starting_at(unknowns, &values);
                return Ok((Found::only(runs.unfinished(&reached, ending)), None));
            }
        };
        let from = least_squares::starting_at(unknowns, &joined.values());
        // From there a run that can be fitted whole is, in a few steps.
        let few = Search { most_steps: search.most_steps.min(20), any_end: false, ..search.clone() };
        match least_squares::fit(runs, &from, &few) {
            Ok(fit) if !is_needed(states, &joined, &fit, search) => Ok((Found::only(fit), None)),
            _ => Ok((Found::only(joined), Some(simulated))),
        }
    }

    /// With an interval from zero on of each lag of a sensor that came out as zero: as far as the readings would let it go. Zero is no
    /// choice of the study: a lag has no lesser value.
    fn with_lags_at_zero(&self, mut fit: Fit, runs: &Runs<'_>, search: &Search) -> Fit {
        let series = || self.runs.iter().flat_map(|run| &run.time_series);
        let is_lag = |unknown: usize| series().any(|series| series.sensor.lag == Amount::Unknown(unknown));
        let is_at_zero = |unknown: &usize| is_lag(*unknown) && fit.estimates[*unknown].bound == Some(0.0);
        let lags: Vec<usize> = (0..self.unknowns.len()).filter(is_at_zero).collect();
        if lags.is_empty() || fit.ending != Ending::Minimum {
            return fit;
        }
        let mut unknowns = self.unknowns.clone();
        lags.iter().for_each(|lag| unknowns[*lag].bounds[0] = f64::NEG_INFINITY);
        let search = Search { loss: search.loss_of(&fit.residuals), ..search.clone() };
        let open = least_squares::fitted(runs, &unknowns, &search, fit.values());
        for lag in lags {
            let Estimate { value, confidence_interval, .. } = &open.estimates[lag];
            fit.estimates[lag].confidence_interval = confidence_interval.map(|[_, most]| [*value, most]);
        }
        fit
    }

    pub(super) fn series_of<'s>(&'s self, observed: &'s Observed) -> impl Iterator<Item = &'s TimeSeries> {
        self.runs.iter().flat_map(|run| &run.time_series).filter(move |recorded| recorded.observed == *observed)
    }

    fn has(&self, observed: &Observed) -> bool {
        self.series_of(observed).any(|recorded| !recorded.values.is_empty())
    }

    /// The standard deviation of a quantity's readings and that it is known, or their span.
    pub(super) fn scale(&self, observed: &Observed) -> (f64, bool) {
        let deviations: Vec<f64> = self.series_of(observed).filter_map(|recorded| recorded.deviation).collect();
        if let Some(deviation) = deviations.first().filter(|_| deviations.len() == self.series_of(observed).count()) {
            return (*deviation, true);
        }
        let values = || self.series_of(observed).flat_map(|recorded| recorded.values.iter().copied());
        let span = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        (if span.is_finite() && span > 0.0 { span } else { 1.0 }, false)
    }

    /// That no number starts where its part is switched off in every run.
    fn check_switches(&self, first: &[f64]) -> Result<(), TrajectoryError> {
        let of_run = |run: &Recorded| run.subject.check_derivatives(&run.own(first)).err();
        let off: Vec<SwitchedOff> = self.runs.iter().map(of_run).collect::<Option<_>>().unwrap_or_default();
        match off.split_first() {
            Some((one, others)) if others.iter().all(|other| other.path == one.path) => {
                Err(TrajectoryError::SwitchedOff(one.clone()))
            }
            _ => Ok(()),
        }
    }

    /// That there is something to fit, and that it can be run from the start.
    fn check(&self) -> Result<(), TrajectoryError> {
        if !observed_in(&self.runs).iter().any(|observed| self.has(observed)) {
            return Err(TrajectoryError::NoReadings);
        }
        let first: Vec<f64> = self.unknowns.iter().map(|unknown| unknown.start).collect();
        for run in &self.runs {
            for recorded in &run.time_series {
                let observed = &recorded.observed;
                let bad = |why| TrajectoryError::BadSeries { run: run.name.clone(), observed: observed.clone(), why };
                series::check(&recorded.times, &recorded.values, observed.quantity().words(), 0)
                    .map_err(|error| bad(error.to_string()))?;
                if let Some(first) = recorded.times.first().filter(|first| **first < 0.0) {
                    return Err(bad(format!(
                        "its first time is {first} s, before the start of the run at zero; leave it out, or begin the run earlier"
                    )));
                }
            }
            let built = run.built(&first).and_then(|built| Ok(built.ready()?)).map_err(|error| run.failed(error))?;
            if let Some(recorded) =
                run.time_series.iter().find(|recorded| recorded.observed.place(&built.plant).is_none())
            {
                let (run, observed) = (run.name.clone(), recorded.observed.clone());
                return Err(match observed.is_of_joint() {
                    true => TrajectoryError::NoJoint { run, observed },
                    false => TrajectoryError::NoColumn { run, observed },
                });
            }
        }
        if let Horizon::Segments(every) = self.horizon {
            if self.runs.iter().any(|run| run.all_unknowns() != run.unknowns) {
                return Err(TrajectoryError::SensorsInSegments);
            }
            let duration =
                self.runs.iter().fold(0.0_f64, |longest, run| longest.max(run.duration(f64::INFINITY, &first)));
            if !(every > duration / MOST_SEGMENTS && every < duration) {
                return Err(TrajectoryError::Segments { every, duration });
            }
        }
        let runs = Runs::whole(&self.runs, Vec::new(), self.tolerance, &self.search.monitor);
        if runs.residuals() == 0 {
            return Err(TrajectoryError::NoReadings);
        }
        self.check_switches(&first)?;
        let Evaluation { residuals, slopes } = runs.evaluate(&first);
        if !residuals.iter().all(|residual| residual.is_finite()) {
            let is_stopped = self.search.monitor.is_stopped();
            return Err(if is_stopped { FitError::Interrupted } else { FitError::NoStart }.into());
        }
        let width = first.len();
        let until = self.runs.iter().flat_map(|run| &run.time_series).filter_map(|series| series.times.last());
        let until = until.copied().fold(0.0, f64::max);
        let silent = |unknown: &usize| slopes.iter().skip(*unknown).step_by(first.len()).all(|slope| *slope == 0.0);
        match (0..first.len()).find(silent) {
            Some(unknown) => {
                let Unknown { name, start, .. } = &self.unknowns[unknown];
                Err(TrajectoryError::Silent { path: name.clone(), start: *start, until })
            }
            None => {
                let changed = slopes.chunks(width.max(1)).filter(|row| row.iter().any(|slope| *slope != 0.0)).count();
                let priors = self.unknowns.iter().filter(|unknown| unknown.prior.is_some()).count();
                let (readings, unknowns) = (residuals.len(), self.unknowns.len());
                // Too few readings in all are refused where the search begins.
                match changed + priors <= unknowns && readings + priors > unknowns {
                    true => Err(TrajectoryError::FewReadings { changed, readings, unknowns, until }),
                    false => Ok(()),
                }
            }
        }
    }
}
