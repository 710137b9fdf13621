//! The values that fit best, how certain they are, and what is not identifiable from the data.
//!
//! ```text
//! minimise  ½ Σ ρ(rᵢ²)  over the unknowns within their bounds        rᵢ = (modelᵢ − measuredᵢ)/scaleᵢ
//! ```
//!
//! with the loss ρ of [`Loss`]. Where the scales are not known, a loss that spares outliers takes its measure from the
//! residuals themselves: from the median of their sizes, first by squares and then by the loss until it stays. A prior is one
//! more residual. The steps are a trust-region reflective method's (the crate `basin`), in unknowns divided by their own
//! size, from several starts on request; what is made of the minimum is [`Fit`]'s.
//!
//! A sum of squares may have kinks, as at a stop, at sticking or at slack, where derivatives lead no further. With
//! [`Search::any_end`] steps without derivatives go on from there, and the best values are returned wherever a search ends:
//! [`Ending`] says where, and only a minimum has intervals.
//!
//! | file | what it holds |
//! |---|---|
//! | this | models, unknowns, losses, fits from one start |
//! | `monitor` | progress, interruption and the time limit |
//! | `starts` | fits from several starts, and the other minima |
//! | `solver` | steps by derivatives, and where they end |
//! | `poll` | steps without derivatives |
//! | `statistics` | standard errors, intervals, and what is not identifiable |
//!
//! Checked by `tests/least_squares.rs`: certified values and standard errors of the NIST's reference data sets, and how often an
//! interval holds the truth; `tests/ends.rs`: kinks, limits, interruptions and several minima, against closed forms.

mod monitor;
mod poll;
mod solver;
mod starts;
mod statistics;

pub use monitor::Monitor;
pub use starts::{Found, Minimum, fit_from};
pub(crate) use statistics::typical;
pub use statistics::{Direction, Estimate, Fit, exceeds_scales};

use crate::median;
use thiserror::Error;

/// How often the standard deviation of the residuals is estimated again where it is not known: it settles at once where outliers
/// are few.
const PASSES: usize = 3;

/// Part of the larger of its bounds that the size of an unknown is at least.
const LEAST_SIZE: f64 = 1e-7;

/// A model of measurements: how far it is from each of them.
pub trait Model {
    /// How many residuals there are.
    fn residuals(&self) -> usize;

    /// The residuals at values of the unknowns, and their derivatives, row by row: of the residual `i` by the unknown `j`
    /// at `i · unknowns + j`. A place where the model has no value may hold anything that is not finite; the step there is
    /// shortened.
    fn evaluate(&self, values: &[f64]) -> Evaluation;

    /// The residuals alone, for places that are only tried.
    fn residuals_at(&self, values: &[f64]) -> Vec<f64> {
        self.evaluate(values).residuals
    }

    /// The relative change of the sum of squares below which it is the model's own rounding.
    fn rounding(&self) -> f64 {
        1e-16
    }

    /// The size of a residual that is the error of the model itself, as of a simulated trajectory: residuals of this size have no
    /// direction at a minimum.
    fn error(&self) -> f64 {
        0.0
    }

    /// How exact the derivatives are, as a part of their size: a direction with a smaller singular value is not
    /// identifiable.
    fn precision(&self) -> f64 {
        1e-9
    }
}

/// Residuals of a model and their derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// One for each measurement.
    pub residuals: Vec<f64>,
    /// Derivatives, row by row.
    pub slopes: Vec<f64>,
}

/// A number that is to be found.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// What it is called in results.
    pub name: String,
    /// The unit of its values.
    pub unit: &'static str,
    /// Where the search begins, within the bounds.
    pub start: f64,
    /// The least and the largest value; infinite where there is none.
    pub bounds: [f64; 2],
    /// What is known of it beforehand: a mean and a standard deviation.
    pub prior: Option<[f64; 2]>,
}

impl Unknown {
    /// One without bounds or prior.
    pub fn new(name: impl Into<String>, unit: &'static str, start: f64) -> Self {
        Self { name: name.into(), unit, start, bounds: [f64::NEG_INFINITY, f64::INFINITY], prior: None }
    }

    /// Bounds the unknown by two values.
    pub fn between(self, least: f64, largest: f64) -> Self {
        Self { bounds: [least, largest], ..self }
    }

    /// What its value is divided by in the search. A start that an earlier search has left near zero is no size.
    fn size(&self) -> f64 {
        let widest =
            self.bounds.iter().filter(|bound| bound.is_finite()).fold(0.0_f64, |size, bound| size.max(bound.abs()));
        match (self.start.abs(), widest) {
            (start, widest) if start > 0.0 => start.max(LEAST_SIZE * widest),
            (_, widest) if widest > 0.0 => widest,
            _ => 1.0,
        }
    }

    /// The bound that a value rests on, if it rests on one.
    pub fn bound_of(&self, value: f64) -> Option<f64> {
        self.rests(value).into_iter().zip(self.bounds).find(|(rests, _)| *rests).map(|(_, bound)| bound)
    }

    /// Whether a value rests on the least or the largest, as near as a search comes to a bound.
    fn rests(&self, value: f64) -> [bool; 2] {
        self.bounds.map(|bound| bound.is_finite() && (value - bound).abs() <= 1e-6 * bound.abs().max(self.size()))
    }
}

/// The unknowns, each starting at a given value.
pub(crate) fn starting_at(unknowns: &[Unknown], values: &[f64]) -> Vec<Unknown> {
    unknowns.iter().zip(values).map(|(unknown, start)| Unknown { start: *start, ..unknown.clone() }).collect()
}

/// How much a large residual counts, by its size in standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Loss {
    /// By its square.
    #[default]
    Squares,
    /// By its square up to this many standard deviations and linearly beyond (Huber).
    Huber(f64),
    /// By the logarithm of its square beyond so many standard deviations (Cauchy): an outlier hardly counts.
    Cauchy(f64),
}

impl Loss {
    /// Weight of a residual: the slope of ρ by its square.
    fn weight(self, residual: f64) -> f64 {
        match self {
            Self::Squares => 1.0,
            Self::Huber(scale) => (scale / residual.abs()).min(1.0),
            Self::Cauchy(scale) => 1.0 / (1.0 + (residual / scale) * (residual / scale)),
        }
    }

    /// How the weighted residual goes with the residual: the derivative ψ' of ψ = w r.
    fn bend(self, residual: f64) -> f64 {
        let over = |scale: f64| (residual / scale).powi(2);
        match self {
            Self::Squares => 1.0,
            Self::Huber(scale) => f64::from(u8::from(over(scale) <= 1.0)),
            Self::Cauchy(scale) => (1.0 - over(scale)) / (1.0 + over(scale)).powi(2),
        }
    }

    /// Half the sum ρ over residuals; infinite where one is not finite.
    pub(crate) fn cost(self, residuals: &[f64]) -> f64 {
        let of = |residual: &f64| match self {
            Self::Squares => residual * residual,
            Self::Huber(scale) if residual.abs() > scale => scale * (2.0 * residual.abs() - scale),
            Self::Huber(_) => residual * residual,
            Self::Cauchy(scale) => scale * scale * (residual / scale).powi(2).ln_1p(),
        };
        let cost = 0.5 * residuals.iter().map(of).sum::<f64>();
        if cost.is_finite() { cost } else { f64::INFINITY }
    }

    /// The loss of residuals with this standard deviation.
    fn of_deviation(self, deviation: f64) -> Self {
        match self {
            Self::Squares => Self::Squares,
            Self::Huber(scale) => Self::Huber(scale * deviation),
            Self::Cauchy(scale) => Self::Cauchy(scale * deviation),
        }
    }
}

/// How the minimum is looked for.
#[derive(Clone, Debug)]
pub struct Search {
    /// How much a large residual counts.
    pub loss: Loss,
    /// Whether the scales of the residuals are their standard deviations. If not, the scatter about the model says how
    /// large they are.
    pub known_scales: bool,
    /// Steps after which a search ends.
    pub most_steps: u64,
    /// Of more starts than the first, how many are searched from: those of least cost. All of them, unless given.
    pub refined: Option<usize>,
    /// Whether a search has a result wherever it ends: the best values, without intervals unless it ends at a minimum. Where steps
    /// by derivatives end at a kink, steps without derivatives go on. Without it such an end is [`FitError::NoMinimum`].
    pub any_end: bool,
    /// Follows the search, and may end it: [`Ending::Interrupted`] and [`Ending::Time`].
    pub monitor: Monitor,
}

impl Search {
    /// The loss of residuals in their scales: its measure is their standard deviation, by the median of their sizes where the scales are
    /// not known.
    pub(crate) fn loss_of(&self, residuals: &[f64]) -> Loss {
        let deviation = if self.known_scales { 1.0 } else { median::deviation(residuals.iter().copied()) };
        // Half of the residuals are nothing: there is no measure of an outlier.
        if deviation > 0.0 { self.loss.of_deviation(deviation) } else { Loss::Squares }
    }
}

impl Default for Search {
    fn default() -> Self {
        Self {
            loss: Loss::Squares,
            known_scales: false,
            most_steps: 500,
            refined: None,
            any_end: false,
            monitor: Monitor::default(),
        }
    }
}

/// Why there is no fit.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FitError {
    /// Fewer measurements than unknowns.
    #[error("{measurements} measurements cannot determine {unknowns} unknowns; measure more, or fix some of them")]
    TooFew {
        /// How many measurements there are.
        measurements: usize,
        /// How many unknowns.
        unknowns: usize,
    },
    /// A start that is not between its bounds.
    #[error("{name} starts at {start}, which is not between {} and {}; start within the bounds", bounds[0], bounds[1])]
    OutsideBounds {
        /// The unknown.
        name: String,
        /// Its start.
        start: f64,
        /// Its bounds.
        bounds: [f64; 2],
    },
    /// The model has no value at the start.
    #[error("the model has no finite value at the start; start elsewhere")]
    NoStart,
    /// The search was ended by its [`Monitor`] before it had values.
    #[error("the search was interrupted, or its time was over, before it had a result")]
    Interrupted,
    /// The search did not end at a minimum.
    #[error(
        "the search found no minimum: {why}; start nearer to it, give bounds, or fix what the data cannot determine"
    )]
    NoMinimum {
        /// What ended it.
        why: Ending,
    },
}

/// What ended a search.
#[derive(Clone, Copy, Debug, Eq, Error, PartialEq)]
pub enum Ending {
    /// The sum of squares is level.
    #[error("it is at a minimum")]
    Minimum,
    /// The sum of squares is not level, and no step makes it smaller.
    #[error(
        "it came to rest where the sum of squares is not level, as at a kink or an edge of the model or where its derivatives are rounded"
    )]
    Kink,
    /// It took all its steps.
    #[error("it was not there after {most} steps")]
    Steps {
        /// How many it may take.
        most: u64,
    },
    /// The numbers at hand do not give a step.
    #[error("the residuals or their derivatives are too large, too small or not finite for a step")]
    Numbers,
    /// The time of the search was over.
    #[error("its time was over")]
    Time,
    /// It was interrupted.
    #[error("it was interrupted")]
    Interrupted,
}

impl Ending {
    /// Whether the search could have gone on: its steps or its time were over, or it was interrupted.
    pub fn is_early(self) -> bool {
        matches!(self, Self::Steps { .. } | Self::Time | Self::Interrupted)
    }
}

/// Finds the values that fit best from one start.
///
/// # Errors
/// [`FitError`], when there is nothing to find or it is not found.
pub fn fit(model: &dyn Model, unknowns: &[Unknown], search: &Search) -> Result<Fit, FitError> {
    check(model, unknowns)?;
    if search.known_scales || search.loss == Loss::Squares {
        return solver::fit(model, unknowns, search);
    }
    let squares = Search { loss: Loss::Squares, ..search.clone() };
    let mut found = solver::fit(model, unknowns, &squares)?;
    for _ in 0..PASSES {
        let deviation = median::deviation(found.residuals.iter().copied());
        // Half of the measurements are met exactly: there is no scale for an outlier.
        if deviation == 0.0 || search.monitor.is_stopped() {
            break;
        }
        let from = starting_at(unknowns, &found.values());
        let search = Search { loss: search.loss.of_deviation(deviation), ..search.clone() };
        found = solver::fit(model, &from, &search)?;
    }
    Ok(found)
}

/// That there is something to find, from starts within their bounds.
fn check(model: &dyn Model, unknowns: &[Unknown]) -> Result<(), FitError> {
    let measurements = model.residuals() + unknowns.iter().filter(|unknown| unknown.prior.is_some()).count();
    if measurements <= unknowns.len() {
        return Err(FitError::TooFew { measurements, unknowns: unknowns.len() });
    }
    for Unknown { name, start, bounds, .. } in unknowns {
        if !(start.is_finite() && bounds[0] <= *start && *start <= bounds[1]) {
            return Err(FitError::OutsideBounds { name: name.clone(), start: *start, bounds: *bounds });
        }
    }
    Ok(())
}

/// What a fit says of values at which a search of these unknowns has ended.
pub(crate) fn fitted(model: &dyn Model, unknowns: &[Unknown], search: &Search, values: Vec<f64>) -> Fit {
    let there = with_priors(model, unknowns, &values);
    Fit::new(model, unknowns, search, (values, there))
}

/// The values where steps by derivatives end from one start, be it a minimum or not: a stage on the way to one.
pub(crate) fn descended(model: &dyn Model, unknowns: &[Unknown], search: &Search) -> Result<Vec<f64>, FitError> {
    solver::descended(model, unknowns, search)
}

/// The residuals of a model with those of the priors behind them, without derivatives.
fn tried(model: &dyn Model, unknowns: &[Unknown], values: &[f64]) -> Vec<f64> {
    let mut residuals = model.residuals_at(values);
    let priors = unknowns.iter().zip(values).filter_map(|(unknown, value)| Some((value, unknown.prior?)));
    residuals.extend(priors.map(|(value, [mean, deviation])| (value - mean) / deviation));
    residuals
}

/// The residuals of a model with those of the priors behind them.
fn with_priors(model: &dyn Model, unknowns: &[Unknown], values: &[f64]) -> Evaluation {
    let mut evaluation = model.evaluate(values);
    for (place, unknown) in unknowns.iter().enumerate() {
        let Some([mean, deviation]) = unknown.prior else { continue };
        evaluation.residuals.push((values[place] - mean) / deviation);
        evaluation.slopes.extend((0..values.len()).map(|of| if of == place { 1.0 / deviation } else { 0.0 }));
    }
    evaluation
}
