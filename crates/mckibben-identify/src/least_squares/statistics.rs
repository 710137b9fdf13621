//! How certain a fit is: standard errors, confidence intervals, correlations, and what is not identifiable from the
//! data.
//!
//! ```text
//! C  = s² (JᵀWJ)⁻¹          J: derivatives of the residuals by the free unknowns at the minimum, W: weights of the loss
//! s² = Σ w r²/(m − n)       of m residuals and n free unknowns; 1 where the scales are known
//! interval = value ± t(0.975, m − n) √C_jj
//! ```
//!
//! It is exact for a model that is linear in its unknowns and normal errors, and good where the model is nearly
//! linear over the interval. The singular values of J, its columns times the size of each unknown, decide which
//! combinations of unknowns the data hardly change: below the model's precision, as a part of the largest, is
//! nothing. An unknown with a share in such a combination has no interval; one that rests on a bound has none either
//! and takes no part.

use super::{Ending, Evaluation, Model, Search, Unknown};
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Share of an unknown in a direction from which on it is named.
const NAMED: f64 = 0.1;
/// Steps after which a decomposition is given up, far more than one takes.
const MOST_SWEEPS: usize = 100_000;

/// One unknown after the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// What it is called.
    pub name: String,
    /// The unit of its values.
    pub unit: &'static str,
    /// The value at the minimum.
    pub value: f64,
    /// Its standard error; `None` where the unknown is not identifiable from the data or rests on a bound.
    pub standard_error: Option<f64>,
    /// The 95 % confidence interval, likewise.
    pub confidence_interval: Option<[f64; 2]>,
    /// Whether it rests on one of its bounds.
    pub on_bound: bool,
    /// The bound that it rests on, which its value is but for rounding.
    pub bound: Option<f64>,
}

/// A combination of unknowns and how well the data determine it.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// Its singular value over the largest.
    pub strength: f64,
    /// The unknowns in it with their shares, each relative to the unknown's size; those above a tenth.
    pub shares: Vec<(String, f64)>,
}

/// Values that fit best, and how certain they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The unknowns in their order.
    pub estimates: Vec<Estimate>,
    /// Residuals at the minimum in their scales, without those of priors.
    pub residuals: Vec<f64>,
    /// Half the sum that was made least, by squares.
    pub cost: f64,
    /// Residuals that say something, priors included, less free unknowns.
    pub degrees_of_freedom: usize,
    /// Standard deviation of a residual: 1 would be its scale.
    pub scatter: f64,
    /// Correlations of the unknowns, row by row; NaN never: zero where there is none.
    pub correlations: Vec<Vec<f64>>,
    /// Largest over least singular value of the derivatives, each by the size of its unknown; infinite when one is zero.
    pub condition: f64,
    /// The combinations that are not identifiable.
    pub unidentifiable: Vec<Direction>,
    /// Where the search has ended; only a minimum has intervals.
    pub ending: Ending,
}

impl Fit {
    /// The values in the order of the unknowns.
    pub fn values(&self) -> Vec<f64> {
        self.estimates.iter().map(|estimate| estimate.value).collect()
    }

    pub(super) fn new(model: &dyn Model, unknowns: &[Unknown], search: &Search, at: (Vec<f64>, Evaluation)) -> Self {
        Self::of_eliminated(model, unknowns, search, at, 0)
    }

    /// As [`Fit::new`], with `others` unknowns more that are eliminated and not reported: the derivatives are those
    /// that remain when these others follow.
    pub(crate) fn of_eliminated(
        model: &dyn Model,
        unknowns: &[Unknown],
        search: &Search,
        (values, evaluation): (Vec<f64>, Evaluation),
        others: usize,
    ) -> Self {
        let (rows, columns) = (evaluation.residuals.len(), unknowns.len());
        let on_bound: Vec<bool> =
            unknowns.iter().zip(&values).map(|(unknown, value)| unknown.rests(*value).contains(&true)).collect();
        let free: Vec<usize> = (0..columns).filter(|unknown| !on_bound[*unknown]).collect();
        let sizes: Vec<f64> = unknowns.iter().zip(&values).map(|(unknown, value)| magnitude(*value, unknown)).collect();
        let weights: Vec<f64> = evaluation.residuals.iter().map(|residual| search.loss.weight(*residual)).collect();
        let slopes = DMatrix::from_fn(rows, free.len(), |row, place| {
            weights[row].sqrt() * evaluation.slopes[row * columns + free[place]] * sizes[free[place]]
        });
        // A residual that is zero and stays so is no measurement: a censored one says nothing.
        let silent = |row: usize| {
            let row_slopes = &evaluation.slopes[row * columns..][..columns];
            evaluation.residuals[row] == 0.0 && row_slopes.iter().all(|slope| *slope == 0.0)
        };
        let speaking = (0..rows).filter(|row| !silent(*row)).count();
        let degrees_of_freedom = speaking.saturating_sub(free.len() + others);
        let squares: f64 =
            evaluation.residuals.iter().zip(&weights).map(|(residual, weight)| weight * residual * residual).sum();
        let scatter = (squares / degrees_of_freedom.max(1) as f64).sqrt();
        let sensitivity = Sensitivity::new(slopes, model.precision());
        let spread = if search.known_scales { 1.0 } else { scatter };
        let quantile =
            StudentsT::new(0.0, 1.0, degrees_of_freedom.max(1) as f64).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
        let estimate = |unknown: usize| {
            let value = values[unknown];
            let of_size =
                free.iter().position(|place| *place == unknown).and_then(|place| sensitivity.standard_error(place));
            let standard_error = of_size.map(|error| error * spread * sizes[unknown]).filter(|error| error.is_finite());
            Estimate {
                name: unknowns[unknown].name.clone(),
                unit: unknowns[unknown].unit,
                value,
                standard_error,
                confidence_interval: standard_error.map(|error| [value - quantile * error, value + quantile * error]),
                on_bound: on_bound[unknown],
                bound: unknowns[unknown].bound_of(value),
            }
        };
        let mut correlations = vec![vec![0.0; columns]; columns];
        for (i, of) in free.iter().enumerate() {
            for (j, with) in free.iter().enumerate() {
                correlations[*of][*with] = sensitivity.correlation(i, j);
            }
        }
        let names: Vec<&str> = free.iter().map(|unknown| unknowns[*unknown].name.as_str()).collect();
        Self {
            estimates: (0..columns).map(estimate).collect(),
            residuals: evaluation.residuals[..model.residuals()].to_vec(),
            cost: 0.5 * evaluation.residuals.iter().map(|residual| residual * residual).sum::<f64>(),
            degrees_of_freedom,
            scatter,
            correlations,
            condition: sensitivity.condition(),
            unidentifiable: sensitivity.unidentifiable(&names),
            ending: Ending::Minimum,
        }
    }

    /// The best values of a search that has ended elsewhere than at a minimum, with the residuals there, those of priors behind the
    /// model's own.
    pub(crate) fn without_intervals(
        unknowns: &[Unknown],
        values: &[f64],
        residuals: &[f64],
        own: usize,
        ending: Ending,
    ) -> Self {
        let estimate = |(unknown, value): (&Unknown, &f64)| Estimate {
            name: unknown.name.clone(),
            unit: unknown.unit,
            value: *value,
            standard_error: None,
            confidence_interval: None,
            on_bound: unknown.rests(*value).contains(&true),
            bound: unknown.bound_of(*value),
        };
        let degrees_of_freedom = residuals.len().saturating_sub(unknowns.len());
        let squares = residuals.iter().map(|residual| residual * residual).sum::<f64>();
        let row = |of: usize| (0..unknowns.len()).map(|with| f64::from(u8::from(of == with))).collect();
        Self {
            estimates: unknowns.iter().zip(values).map(estimate).collect(),
            residuals: residuals[..own.min(residuals.len())].to_vec(),
            cost: 0.5 * squares,
            degrees_of_freedom,
            scatter: (squares / degrees_of_freedom.max(1) as f64).sqrt(),
            correlations: (0..unknowns.len()).map(row).collect(),
            condition: f64::INFINITY,
            unidentifiable: Vec::new(),
            ending,
        }
    }
}

/// The size of an unknown at a value: its own, or the one of the search where it is zero.
fn magnitude(value: f64, unknown: &Unknown) -> f64 {
    if value == 0.0 { unknown.size() } else { value.abs() }
}

/// The singular values of the derivatives, largest first, with the direction of each.
struct Sensitivity {
    values: DVector<f64>,
    directions: DMatrix<f64>,
    /// The part of the largest below which a singular value is nothing.
    least: f64,
}

impl Sensitivity {
    fn new(slopes: DMatrix<f64>, least: f64) -> Self {
        let columns = slopes.ncols();
        // Where every unknown rests on a bound there is nothing to decompose.
        let decomposed = match slopes.is_empty() || !slopes.iter().all(|slope| slope.is_finite()) {
            true => None,
            false => slopes.try_svd(false, true, f64::EPSILON, MOST_SWEEPS),
        };
        match decomposed {
            Some(svd) => Self {
                directions: svd.v_t.unwrap_or_else(|| DMatrix::identity(columns, columns)),
                values: svd.singular_values,
                least,
            },
            None => Self { values: DVector::zeros(columns), directions: DMatrix::identity(columns, columns), least },
        }
    }

    fn largest(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }

    fn is_identifiable(&self, direction: usize) -> bool {
        self.values[direction] > self.least * self.largest()
    }

    /// Covariance of two unknowns, in their sizes, by the directions that are identifiable.
    fn covariance(&self, i: usize, j: usize) -> f64 {
        let part = |k: usize| (self.directions[(k, i)] / self.values[k]) * (self.directions[(k, j)] / self.values[k]);
        (0..self.values.len()).filter(|k| self.is_identifiable(*k)).map(part).sum()
    }

    fn standard_error(&self, place: usize) -> Option<f64> {
        let unidentifiable =
            |k: usize| !self.is_identifiable(k) && self.directions[(k, place)].abs() > self.least.sqrt();
        (!(0..self.values.len()).any(unidentifiable)).then(|| self.covariance(place, place).sqrt())
    }

    fn correlation(&self, i: usize, j: usize) -> f64 {
        match (self.standard_error(i), self.standard_error(j)) {
            (Some(of), Some(with)) if of > 0.0 && with > 0.0 => self.covariance(i, j) / (of * with),
            _ => f64::from(u8::from(i == j)),
        }
    }

    fn condition(&self) -> f64 {
        let least = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        if self.values.is_empty() { 1.0 } else { self.largest() / least }
    }

    fn unidentifiable(&self, names: &[&str]) -> Vec<Direction> {
        let direction = |k: usize| {
            let share = |(place, name): (usize, &&str)| ((*name).to_owned(), self.directions[(k, place)]);
            let shares = names.iter().enumerate().map(share).filter(|(_, share)| share.abs() > NAMED).collect();
            let largest = self.largest();
            Direction { strength: if largest > 0.0 { self.values[k] / largest } else { 0.0 }, shares }
        };
        (0..self.values.len()).filter(|k| !self.is_identifiable(*k)).map(direction).collect()
    }
}
