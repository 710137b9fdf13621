//! The minimum, by the crate `basin`: its problem is ours with every unknown divided by its size.

use super::{Ending, Evaluation, FitError, Loss, Model, Monitor, Search, Unknown};
use basin::{
    BoxBounds, CauchyLoss, ConstraintDescription, ConstraintSet, Constraints, DenseMatrix, Executor, HuberLoss,
    Jacobian, Residual, RobustLeastSquares, Termination, TrustRegionReflective,
};
use std::convert::Infallible;

/// Change of an unknown, over its size, below which a search has come to its end.
const RESOLVED: f64 = 1e-13;
/// The cosine between residuals and the derivative by an unknown above which the place is no minimum.
const STATIONARY: f64 = 1e-5;
/// The step that is left to an unknown, over its size, below which the place is one all the same.
const STEP_RESOLVED: f64 = 1e-7;

/// The values at the minimum, and the model there.
pub(super) fn minimum(
    model: &impl Model,
    unknowns: &[Unknown],
    search: &Search,
) -> Result<(Vec<f64>, Evaluation), FitError> {
    let (values, why) = descended(model, unknowns, search)?;
    let there = super::with_priors(model, unknowns, &values);
    match Scaled::new(model, unknowns, &search.monitor).is_stationary(&values, &there, search.loss) {
        true => Ok((values, there)),
        false => Err(FitError::NoMinimum { why }),
    }
}

/// The values where the search ends, be it a minimum or not, and what ended it.
pub(super) fn descended(
    model: &impl Model,
    unknowns: &[Unknown],
    search: &Search,
) -> Result<(Vec<f64>, Ending), FitError> {
    let scaled = || Scaled::new(model, unknowns, &search.monitor);
    let problem = scaled();
    let start: Vec<f64> = unknowns.iter().zip(&problem.sizes).map(|(unknown, size)| unknown.start / size).collect();
    if !problem.residuals_at(&start).iter().all(|residual| residual.is_finite()) {
        return Err(if search.monitor.is_stopped() { FitError::Interrupted } else { FitError::NoStart });
    }
    let method = TrustRegionReflective::new()
        .with_absolute_scaled_gradient_tolerance(0.0)
        .with_relative_cost_change_tolerance(model.rounding())
        .with_relative_step_tolerance(RESOLVED);
    macro_rules! run {
        ($problem:expr) => {
            match Executor::from_start($problem, method, start).max_iter(search.most_steps).run() {
                Ok(result) => (result.param().clone(), ending(&result.report.termination, search)),
                Err(_) if search.monitor.is_stopped() => return Err(FitError::Interrupted),
                Err(_) => return Err(FitError::NoMinimum { why: Ending::Numbers }),
            }
        };
    }
    let (end, why) = match search.loss {
        Loss::Squares => run!(scaled()),
        Loss::Huber(scale) => run!(RobustLeastSquares::new(scaled(), HuberLoss).with_scale(scale)),
        Loss::Cauchy(scale) => run!(RobustLeastSquares::new(scaled(), CauchyLoss).with_scale(scale)),
    };
    match search.monitor.is_stopped() {
        true => Err(FitError::Interrupted),
        false => Ok((problem.values(&end), why)),
    }
}

/// What ended a search, in the words of this crate.
fn ending(by: &Termination, search: &Search) -> Ending {
    match by {
        Termination::Limit(_) => Ending::Steps { most: search.most_steps },
        Termination::Stalled(_) => Ending::Stalled,
        Termination::Failed(_) => Ending::Numbers,
        _ => Ending::NotStationary,
    }
}

/// A model with its priors, in unknowns divided by their sizes.
#[derive(Debug)]
struct Scaled<'a, M> {
    model: &'a M,
    unknowns: &'a [Unknown],
    monitor: &'a Monitor,
    sizes: Vec<f64>,
    least: Vec<f64>,
    largest: Vec<f64>,
}

impl<'a, M: Model> Scaled<'a, M> {
    fn new(model: &'a M, unknowns: &'a [Unknown], monitor: &'a Monitor) -> Self {
        let sizes: Vec<f64> = unknowns.iter().map(Unknown::size).collect();
        let bound =
            |side: usize| unknowns.iter().zip(&sizes).map(|(unknown, size)| unknown.bounds[side] / size).collect();
        Self { model, unknowns, monitor, least: bound(0), largest: bound(1), sizes }
    }

    fn values(&self, at: &[f64]) -> Vec<f64> {
        at.iter().zip(&self.sizes).map(|(part, size)| part * size).collect()
    }

    fn residuals_at(&self, at: &[f64]) -> Vec<f64> {
        if !self.monitor.goes_on() {
            return self.nowhere();
        }
        super::tried(self.model, self.unknowns, &self.values(at))
    }

    /// Residuals of a place where the model has no value. They end a search.
    fn nowhere(&self) -> Vec<f64> {
        let priors = self.unknowns.iter().filter(|unknown| unknown.prior.is_some()).count();
        vec![f64::NAN; self.model.residuals() + priors]
    }

    fn evaluate(&self, at: &[f64]) -> Evaluation {
        if !self.monitor.goes_on() {
            let residuals = self.nowhere();
            return Evaluation { slopes: vec![f64::NAN; residuals.len() * at.len()], residuals };
        }
        let mut evaluation = super::with_priors(self.model, self.unknowns, &self.values(at));
        for row in evaluation.slopes.chunks_mut(self.sizes.len().max(1)) {
            row.iter_mut().zip(&self.sizes).for_each(|(slope, size)| *slope *= size);
        }
        evaluation
    }

    /// Whether no free unknown would make the sum smaller: residuals and derivatives are at right angles.
    fn is_stationary(&self, values: &[f64], there: &Evaluation, loss: Loss) -> bool {
        let Evaluation { residuals, slopes } = there;
        if !residuals.iter().chain(slopes).all(|number| number.is_finite()) {
            return false;
        }
        let weights: Vec<f64> = residuals.iter().map(|residual| loss.weight(*residual)).collect();
        let length = norm(residuals.iter().zip(&weights).map(|(residual, weight)| residual * weight.sqrt()));
        (0..values.len()).all(|unknown| {
            let scaled = |slope: &f64| slope * self.sizes[unknown];
            let column = || slopes.iter().skip(unknown).step_by(values.len()).map(scaled).zip(&weights);
            let along: f64 = column().zip(residuals).map(|((slope, weight), residual)| slope * weight * residual).sum();
            let size = norm(column().map(|(slope, weight)| slope * weight.sqrt()));
            let [on_least, on_largest] = self.unknowns[unknown].rests(values[unknown]);
            let outwards = (on_least && along > 0.0) || (on_largest && along < 0.0);
            if !(along.is_finite() && size.is_finite() && length.is_finite()) {
                return false;
            }
            // A perfect fit has no direction left to be at right angles to, only the rounding of the model.
            outwards || along.abs() <= STATIONARY * size * length || along.abs() <= STEP_RESOLVED * size * size
        })
    }
}

fn norm(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.map(|number| number * number).sum::<f64>().sqrt()
}

impl<M: Model> Constraints for Scaled<'_, M> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;
    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.least), Some(&self.largest)))
    }
}

impl<M: Model> Residual for Scaled<'_, M> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = Infallible;
    fn residual(&self, at: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        Ok(self.residuals_at(at))
    }
}

impl<M: Model> Jacobian for Scaled<'_, M> {
    type Jacobian = DenseMatrix;
    fn jacobian(&self, at: &Vec<f64>) -> Result<DenseMatrix, Infallible> {
        let Evaluation { residuals, slopes } = self.evaluate(at);
        Ok(DenseMatrix::from_row_slice(residuals.len(), at.len(), &slopes))
    }
}
