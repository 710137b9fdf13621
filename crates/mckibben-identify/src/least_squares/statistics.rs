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
//! linear over the interval. Under a loss that spares outliers the residuals are not of one scatter, and
//!
//! ```text
//! C = m/(m − n) A⁻¹ (Σ ψ² jᵀj) A⁻¹,   A = Σ ψ' jᵀj        j: a row of J, ψ = w r
//! ```
//!
//! the sandwich of Huber (1967, Proc. Fifth Berkeley Symp. 1, 221–233) and White (1980, Econometrica 48, 817–838).
//!
//! Each column of √W J is divided by its own norm, which is the effect of the unknown on the weighted residuals: so neither
//! the unit of an unknown nor a value near zero counts. The singular values decide which combinations of unknowns hardly
//! change the data: below the model's precision, as a part of the largest, is nothing. An unknown that changes the
//! residuals by their rounding over its whole range has no effect. An unknown with a share in such a combination, or
//! without effect, has no interval; one that rests on a bound has none either and takes no part.

use super::{Ending, Evaluation, Loss, Model, Search, Unknown};
use crate::median;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Share of an unknown in a direction from which on it is named.
const NAMED: f64 = 0.1;
/// Part of the largest effect on the residuals at which the effect of an unknown over its whole range is rounding.
const ROUNDING: f64 = 1e-12;
/// Steps after which a decomposition is given up, far more than one takes.
const MOST_SWEEPS: usize = 100_000;

/// Residuals over scales that were stated above which the scales are doubted, and the normal quantile beyond which that is no chance.
const BEYOND_SCALE: f64 = 1.5;
const NO_CHANCE: f64 = 3.09;

/// Whether so many residuals of this size, in scales that are known, are more than these scales leave to chance: the test of χ² at a
/// thousandth, by the approximation of Wilson & Hilferty (1931, Proc. Natl. Acad. Sci. 17, 684–688).
pub fn exceeds_scales(size: f64, count: usize) -> bool {
    let part = 2.0 / (9.0 * count.max(1) as f64);
    size > BEYOND_SCALE && size * size > (1.0 - part + NO_CHANCE * part.sqrt()).powi(3)
}

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
    /// The 95 % confidence interval, likewise; of a sensor's lag that rests on zero from there on.
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
    /// The unknowns in it with their shares, each relative to the unknown's size; those above a tenth, there or of the effect on
    /// the residuals.
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
    /// Largest over least singular value of the derivatives, each column over its norm; infinite when one is zero.
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

    /// The size of a residual in its scale: the root mean square; under a loss that spares outliers by the median, which these do not
    /// change. Censored residuals do not count.
    pub fn typical_residual(&self, loss: Loss) -> f64 {
        typical(self.residuals.iter().copied().filter(|residual| *residual != 0.0), loss)
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
        let free = free(unknowns, &values);
        let weights: Vec<f64> = evaluation.residuals.iter().map(|residual| search.loss.weight(*residual)).collect();
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
        let (mut sensitivity, slopes) = Sensitivity::of(model, unknowns, &free, &weights, (&values, &evaluation));
        match search.loss {
            Loss::Squares if search.known_scales => sensitivity.estimate(1.0),
            Loss::Squares => sensitivity.estimate(scatter * scatter),
            loss => {
                let inflated = speaking as f64 / degrees_of_freedom.max(1) as f64;
                let of_row = |(row, residual): (usize, &f64)| {
                    let bend = loss.bend(*residual);
                    // A prior is as certain as it says, however near to it the value lies, and so is a reading that is not spared.
                    match row >= model.residuals() || (search.known_scales && bend == 1.0) {
                        true => [1.0; 2],
                        false => [bend, inflated * (loss.weight(*residual) * residual).powi(2)],
                    }
                };
                let of_rows: Vec<[f64; 2]> = evaluation.residuals.iter().enumerate().map(of_row).collect();
                sensitivity.estimate_sandwich(&slopes, &of_rows);
            }
        }
        let quantile =
            StudentsT::new(0.0, 1.0, degrees_of_freedom.max(1) as f64).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
        let estimate = |unknown: usize| {
            let value = values[unknown];
            let place = free.iter().position(|place| *place == unknown);
            let standard_error =
                place.and_then(|place| sensitivity.standard_error(place)).filter(|error| error.is_finite());
            Estimate {
                name: unknowns[unknown].name.clone(),
                unit: unknowns[unknown].unit,
                value,
                standard_error,
                confidence_interval: standard_error.map(|error| [value - quantile * error, value + quantile * error]),
                on_bound: place.is_none(),
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

    /// With what is not identifiable at the values, where there are derivatives.
    pub(super) fn with_unidentifiable(self, model: &dyn Model, unknowns: &[Unknown], search: &Search) -> Self {
        let values = self.values();
        let evaluation = super::with_priors(model, unknowns, &values);
        if !evaluation.residuals.iter().chain(&evaluation.slopes).all(|number| number.is_finite()) {
            return self;
        }
        let free = free(unknowns, &values);
        let weights: Vec<f64> = evaluation.residuals.iter().map(|residual| search.loss.weight(*residual)).collect();
        let (sensitivity, _) = Sensitivity::of(model, unknowns, &free, &weights, (&values, &evaluation));
        let names: Vec<&str> = free.iter().map(|unknown| unknowns[*unknown].name.as_str()).collect();
        Self { unidentifiable: sensitivity.unidentifiable(&names), ..self }
    }

    /// With values that rest on a bound taken to it, where the model has a value there: what a search leaves of the way is its
    /// rounding. A bound that a parameter does not reach, as zero of a time constant, is left.
    pub(crate) fn on_bounds(mut self, model: &dyn Model) -> Self {
        let taken: Vec<f64> = self.estimates.iter().map(|estimate| estimate.bound.unwrap_or(estimate.value)).collect();
        if taken != self.values() && model.residuals_at(&taken).iter().all(|residual| residual.is_finite()) {
            self.estimates.iter_mut().zip(taken).for_each(|(estimate, value)| estimate.value = value);
        }
        self
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

/// The size of residuals under a loss: see [`Fit::typical_residual`].
pub(crate) fn typical(residuals: impl Iterator<Item = f64>, loss: Loss) -> f64 {
    let residuals: Vec<f64> = residuals.collect();
    match loss {
        Loss::Squares => {
            let squares = residuals.iter().map(|residual| residual * residual).sum::<f64>();
            (squares / residuals.len().max(1) as f64).sqrt()
        }
        _ => median::deviation(residuals),
    }
}

/// The places of the unknowns that do not rest on a bound.
fn free(unknowns: &[Unknown], values: &[f64]) -> Vec<usize> {
    let rests = |place: &usize| unknowns[*place].rests(values[*place]).contains(&true);
    (0..unknowns.len()).filter(|place| !rests(place)).collect()
}

/// The size of an unknown at a value, which a share is relative to: the value, or the one of the search where it is zero. A value
/// that may have either sign is no size where its bounds say one.
fn magnitude(value: f64, unknown: &Unknown) -> f64 {
    let [least, largest] = unknown.bounds;
    match value {
        _ if least < 0.0 && largest > 0.0 && largest - least < f64::INFINITY => largest.max(-least),
        0.0 => unknown.size(),
        value => value.abs(),
    }
}

/// The largest size that an unknown may have: that of the search where no bound and no value is any.
fn reach(value: f64, unknown: &Unknown) -> f64 {
    let bounds = unknown.bounds.iter().filter(|bound| bound.is_finite());
    let reach = bounds.chain([&value, &unknown.start]).fold(0.0, |reach: f64, number| reach.max(number.abs()));
    if reach > 0.0 { reach } else { unknown.size() }
}

/// The singular values of the weighted derivatives by the free unknowns, each column over its norm, with the direction of each.
struct Sensitivity {
    /// The place of each free unknown among those that have an effect.
    acting: Vec<Option<usize>>,
    /// Norm and size of each of these.
    norms: Vec<f64>,
    sizes: Vec<f64>,
    values: DVector<f64>,
    directions: DMatrix<f64>,
    /// The part of the largest below which a singular value is nothing.
    least: f64,
    /// Covariance of the acting unknowns, each times its norm, by the directions that are identifiable.
    covariance: DMatrix<f64>,
}

impl Sensitivity {
    /// Of the free unknowns at values, with the derivatives with respect to these.
    fn of(
        model: &dyn Model,
        unknowns: &[Unknown],
        free: &[usize],
        weights: &[f64],
        (values, evaluation): (&[f64], &Evaluation),
    ) -> (Self, DMatrix<f64>) {
        let (rows, columns) = (evaluation.residuals.len(), unknowns.len());
        let slopes = DMatrix::from_fn(rows, free.len(), |row, place| evaluation.slopes[row * columns + free[place]]);
        (Self::new(&slopes, weights, model, free.iter().map(|of| (&unknowns[*of], values[*of]))), slopes)
    }

    fn new<'a>(
        slopes: &DMatrix<f64>,
        weights: &[f64],
        model: &dyn Model,
        unknowns: impl Iterator<Item = (&'a Unknown, f64)> + Clone,
    ) -> Self {
        let norm = |column: usize, rows: usize| {
            (0..rows).map(|row| weights[row] * slopes[(row, column)].powi(2)).sum::<f64>().sqrt()
        };
        let of_all = |column: usize| norm(column, slopes.nrows());
        // Effects on the readings alone: a narrow prior says nothing of the others.
        let effects = unknowns.clone().enumerate();
        let effects = effects.map(|(column, (_, value))| norm(column, model.residuals()) * value.abs());
        let rounding = ROUNDING * effects.fold(0.0, f64::max);
        let acts = |(column, (unknown, value)): (usize, (&Unknown, f64))| {
            let effect = of_all(column) * reach(value, unknown);
            slopes.iter().all(|slope| slope.is_finite()) && effect > 0.0 && effect > rounding
        };
        let columns: Vec<usize> =
            unknowns.clone().enumerate().filter(|of| acts(*of)).map(|(column, _)| column).collect();
        let count = columns.len();
        let acting = (0..slopes.ncols()).map(|column| columns.iter().position(|of| *of == column)).collect();
        let norms: Vec<f64> = columns.iter().map(|column| of_all(*column)).collect();
        let sizes: Vec<f64> = unknowns.map(|(unknown, value)| magnitude(value, unknown)).collect();
        let scaled = DMatrix::from_fn(slopes.nrows(), count, |row, place| {
            weights[row].sqrt() * slopes[(row, columns[place])] / norms[place]
        });
        // Where nothing acts there is nothing to decompose.
        let decomposed = if scaled.is_empty() { None } else { scaled.try_svd(false, true, f64::EPSILON, MOST_SWEEPS) };
        let (values, directions) = match decomposed {
            Some(svd) => (svd.singular_values, svd.v_t.unwrap_or_else(|| DMatrix::identity(count, count))),
            None => (DVector::zeros(count), DMatrix::identity(count, count)),
        };
        Self {
            sizes: columns.iter().map(|column| sizes[*column]).collect(),
            least: model.precision(),
            covariance: DMatrix::zeros(count, count),
            acting,
            norms,
            values,
            directions,
        }
    }

    fn largest(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }

    fn is_identifiable(&self, direction: usize) -> bool {
        self.values[direction] > self.least * self.largest()
    }

    /// The identifiable directions as columns, each over its singular value.
    fn basis(&self) -> DMatrix<f64> {
        let identifiable: Vec<usize> = (0..self.values.len()).filter(|k| self.is_identifiable(*k)).collect();
        DMatrix::from_fn(self.norms.len(), identifiable.len(), |place, column| {
            let k = identifiable[column];
            self.directions[(k, place)] / self.values[k]
        })
    }

    /// Takes the covariance of residuals that scatter alike, with this variance.
    fn estimate(&mut self, variance: f64) {
        let basis = self.basis();
        self.covariance = &basis * basis.transpose() * variance;
    }

    /// Takes the covariance of residuals each of which scatters in its own way: ψ' and ψ² of each.
    fn estimate_sandwich(&mut self, slopes: &DMatrix<f64>, of_rows: &[[f64; 2]]) {
        let columns: Vec<usize> = (0..self.acting.len()).filter(|column| self.acting[*column].is_some()).collect();
        let mut own = slopes.select_columns(&columns);
        for (mut column, norm) in own.column_iter_mut().zip(&self.norms) {
            column /= *norm;
        }
        let basis = self.basis();
        let own = own * &basis;
        let weighted = |which: usize| {
            let scaled =
                DMatrix::from_fn(own.nrows(), own.ncols(), |row, column| of_rows[row][which] * own[(row, column)]);
            own.tr_mul(&scaled)
        };
        // Without outliers it is one; where too many are spared to determine it, too.
        let bread = weighted(0).cholesky().map(|bend| bend.inverse());
        let bread = bread.unwrap_or_else(|| DMatrix::identity(basis.ncols(), basis.ncols()));
        self.covariance = &basis * &bread * weighted(1) * bread * basis.transpose();
    }

    /// The share of an acting unknown in a direction: of the effect on the residuals, and relative to the unknown's size.
    fn shares(&self, k: usize, place: usize) -> [f64; 2] {
        let of = |place: usize| self.directions[(k, place)] / (self.norms[place] * self.sizes[place]);
        let length = (0..self.norms.len()).map(|place| of(place).powi(2)).sum::<f64>().sqrt();
        [self.directions[(k, place)], of(place) / length]
    }

    /// Whether an acting unknown has no interval because of a direction: beyond the error of the direction.
    fn is_in(&self, k: usize, place: usize) -> bool {
        let [of_effect, of_size] = self.shares(k, place).map(f64::abs);
        !self.is_identifiable(k) && (of_effect > self.least.sqrt() || (of_effect > self.least && of_size > NAMED))
    }

    fn standard_error(&self, unknown: usize) -> Option<f64> {
        let place = self.acting[unknown]?;
        let is_free = !(0..self.values.len()).any(|k| self.is_in(k, place));
        is_free.then(|| self.covariance[(place, place)].sqrt() / self.norms[place])
    }

    fn correlation(&self, i: usize, j: usize) -> f64 {
        match (self.standard_error(i).zip(self.acting[i]), self.standard_error(j).zip(self.acting[j])) {
            (Some((of, i)), Some((with, j))) if of > 0.0 && with > 0.0 => {
                self.covariance[(i, j)] / (of * self.norms[i]) / (with * self.norms[j])
            }
            _ => f64::from(u8::from(i == j)),
        }
    }

    fn condition(&self) -> f64 {
        let least = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        match self.acting.iter().all(Option::is_some) {
            true if self.values.is_empty() => 1.0,
            true => self.largest() / least,
            false => f64::INFINITY,
        }
    }

    fn unidentifiable(&self, names: &[&str]) -> Vec<Direction> {
        let silent = names.iter().zip(&self.acting).filter(|(_, place)| place.is_none());
        let silent = silent.map(|(name, _)| Direction { strength: 0.0, shares: vec![((*name).to_owned(), 1.0)] });
        let direction = |k: usize| {
            let share = |(name, place): (&&str, &Option<usize>)| {
                let [of_effect, of_size] = self.shares(k, (*place)?);
                let is_named = of_effect.abs() > NAMED || (of_effect.abs() > self.least && of_size.abs() > NAMED);
                is_named.then(|| ((*name).to_owned(), of_size))
            };
            let largest = self.largest();
            let strength = if largest > 0.0 { self.values[k] / largest } else { 0.0 };
            Direction { strength, shares: names.iter().zip(&self.acting).filter_map(share).collect() }
        };
        silent.chain((0..self.values.len()).filter(|k| !self.is_identifiable(*k)).map(direction)).collect()
    }
}
