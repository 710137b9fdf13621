//! Force maps: tensions at held pressures and lengths, to any law of static force.
//!
//! ```text
//! r_i = (F(L_i, P_i) − F_i)/s             where the muscle held a tension
//! r_i = max(F(L_i, P_i), 0)/s             where it was slack: the law may not pull; how far below zero is unknown
//! ```
//!
//! Slack points are censored in this one-sided way: one where the law pushes counts for nothing, neither in the sum
//! nor in the degrees of freedom.
//!
//! | module | what it holds |
//! |---|---|
//! | this | points, the fit of one candidate, its errors |
//! | [`candidates`] | every law with the combinations of its parameters that are identifiable from a force map |
//! | [`held_out`] | errors at lengths, pressures or runs that the fit has not seen |
//! | [`effectiveness`] | measured over ideal force at each pressure (9) |
//! | [`units`] | whether the tensions are those of the muscle in other units |
//!
//! Errors are of the tensions that were held, in parts of the largest of them.
//! Checked by `tests/statics.rs`: numbers put in come back out, slack is no zero, and two measured muscles.

pub mod candidates;
pub mod effectiveness;
pub mod held_out;
pub mod units;

use crate::adjustable::{Adjustable, Seeded};
use crate::least_squares::{self, Evaluation, Fit, FitError, Model, Search, Unknown};
use mckibben::{Actuator, Over};
use mckibben_scenario::Scenario;
use thiserror::Error;

/// One place of a force map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Gauge pressure in Pa.
    pub gauge_pressure: f64,
    /// Length in m.
    pub length: f64,
    /// Tension in N; of a slack muscle without meaning.
    pub tension: f64,
    /// Whether no tension was held.
    pub slack: bool,
    /// Which run it is of.
    pub run: usize,
}

/// Why there is no fit of a force map.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StaticError {
    /// Nothing was held.
    #[error("no point holds a tension; give a force map with points that are not slack")]
    AllSlack,
    /// A number is not finite or no physical one.
    #[error("point {point} has {what}; leave it out")]
    BadPoint {
        /// Counted from 1.
        point: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// No search ended at a minimum.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// A force map.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceMap {
    points: Vec<Point>,
    largest: f64,
}

impl ForceMap {
    /// A force map of points.
    ///
    /// # Errors
    /// [`StaticError::BadPoint`] for numbers that are not finite, lengths that are not above zero and tensions below zero that
    /// are not marked as slack; [`StaticError::AllSlack`] when no tension was held.
    pub fn new(points: Vec<Point>) -> Result<Self, StaticError> {
        for (place, point) in points.iter().enumerate() {
            let bad = |what| Err(StaticError::BadPoint { point: place + 1, what });
            if ![point.gauge_pressure, point.length].iter().all(|number| number.is_finite()) {
                return bad("a pressure or length that is not finite");
            }
            if point.length <= 0.0 {
                return bad("a length that is not above zero");
            }
            let is_tension = point.tension.is_finite() && point.tension > 0.0;
            if !point.slack && !is_tension {
                return bad("a tension that is not above zero, and is not marked as slack");
            }
        }
        let held = points.iter().filter(|point| !point.slack);
        let largest = held.fold(0.0_f64, |largest, point| largest.max(point.tension));
        if largest == 0.0 {
            return Err(StaticError::AllSlack);
        }
        Ok(Self { points, largest })
    }

    /// The points.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Those with a tension.
    pub fn held(&self) -> impl Iterator<Item = &Point> + Clone {
        self.points.iter().filter(|point| !point.slack)
    }

    /// The largest tension in N.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// The points for which something holds, in parts of the same largest tension; `None` when none of them holds a
    /// tension.
    pub fn only(&self, keep: impl Fn(&Point) -> bool) -> Option<Self> {
        let points: Vec<Point> = self.points.iter().copied().filter(|point| keep(point)).collect();
        points.iter().any(|point| !point.slack).then_some(Self { points, largest: self.largest })
    }

    /// How far an actuator is from the tensions that were held.
    pub fn errors(&self, actuator: &Actuator) -> Errors {
        Errors::of(self.held().map(|point| (force(actuator, point) - point.tension) / self.largest))
    }
}

/// Static force in N at a point.
pub fn force(actuator: &Actuator, point: &Point) -> f64 {
    actuator.static_force(point.length, point.gauge_pressure + actuator.air().atmosphere().0)
}

/// How far a law is from measurements, as parts of the largest of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// The largest.
    pub worst: f64,
    /// The root of their mean square.
    pub root_mean_square: f64,
    /// Of how many.
    pub count: usize,
}

impl Errors {
    /// Of some errors.
    pub fn of(errors: impl Iterator<Item = f64>) -> Self {
        let (worst, squares, count) = errors.fold((0.0_f64, 0.0, 0), |(worst, squares, count), error| {
            (worst.max(error.abs()), squares + error * error, count + 1)
        });
        Self { worst, root_mean_square: (squares / f64::from(count.max(1))).sqrt(), count: count as usize }
    }

    /// Of two sets together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let count = self.count + other.count;
        let squares = |of: Self| of.root_mean_square * of.root_mean_square * of.count as f64;
        let mean = (squares(self) + squares(other)) / count.max(1) as f64;
        Self { worst: self.worst.max(other.worst), root_mean_square: mean.sqrt(), count }
    }
}

/// A law with the numbers of it that are looked for.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What it is called.
    pub name: String,
    /// The scenario and its numbers.
    pub adjustable: Adjustable,
    /// Bounds, priors and the first start of each number.
    pub unknowns: Vec<Unknown>,
    /// More starts.
    pub starts: Vec<Vec<f64>>,
}

/// The fit of one candidate.
#[derive(Clone, Debug)]
pub struct StaticFit {
    /// Values with their uncertainty.
    pub fit: Fit,
    /// The scenario with these values.
    pub scenario: Scenario,
    /// Errors at the points it was fitted to.
    pub errors: Errors,
    /// How many starts were tried, and how many of them came to this minimum.
    pub starts: [usize; 2],
}

impl Candidate {
    /// Fits to a force map. `deviation` is that of a tension in N, where it is known.
    ///
    /// # Errors
    /// [`StaticError::Fit`] when no start leads to a minimum.
    pub fn fit(&self, map: &ForceMap, deviation: Option<f64>, search: &Search) -> Result<StaticFit, StaticError> {
        let scale = deviation.unwrap_or(map.largest);
        let model = StaticModel { adjustable: &self.adjustable, map, scale };
        let search = Search { known_scales: deviation.is_some(), ..search.clone() };
        let mut found = least_squares::fit_from(&model, &self.unknowns, &self.starts, &search)?;
        found.fit = found.fit.on_bounds(&model);
        let scenario = self.adjustable.at(&found.fit.values()).map_err(|_| FitError::NoStart)?;
        let driven = scenario.driven().map_err(|_| FitError::NoStart)?;
        let errors = map.errors(&driven.actuator);
        Ok(StaticFit { fit: found.fit, scenario, errors, starts: [found.tried, found.agreeing] })
    }
}

/// The residuals of a force map.
struct StaticModel<'a> {
    adjustable: &'a Adjustable,
    map: &'a ForceMap,
    /// N.
    scale: f64,
}

impl Model for StaticModel<'_> {
    fn residuals(&self) -> usize {
        self.map.points.len()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let unknowns = values.len();
        let mut residuals = vec![f64::NAN; self.residuals()];
        let mut slopes = vec![0.0; self.residuals() * unknowns];
        // Where there is no such actuator there is no residual, and the step is shortened.
        let Ok(driven) = self.adjustable.at(values).and_then(|scenario| scenario.driven()) else {
            return Evaluation { residuals, slopes };
        };
        for first in self.adjustable.passes() {
            let mut seeds = self.adjustable.seeds(first);
            let actuator: Actuator<Seeded> = driven.actuator.map(|parameter, value| seeds.over(parameter, value));
            for (place, point) in self.map.points.iter().enumerate() {
                let pressure = Seeded::of(point.gauge_pressure) + actuator.air().atmosphere().0;
                let force = actuator.static_force(Seeded::of(point.length), pressure);
                let counts = !point.slack || force.value > 0.0;
                let measured = if point.slack { 0.0 } else { point.tension };
                residuals[place] = if counts { (force.value - measured) / self.scale } else { 0.0 };
                let row = &mut slopes[place * unknowns..][..unknowns];
                if counts {
                    self.adjustable.spread(first, &force.slope, 1.0 / self.scale, row);
                }
            }
        }
        Evaluation { residuals, slopes }
    }
}
