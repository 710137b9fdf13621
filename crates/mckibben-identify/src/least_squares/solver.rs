//! The minimum, by the crate `basin`: its problem is ours with every unknown divided by its size. Where steps by derivatives end
//! elsewhere, steps without them go on in turn with these, until neither finds a smaller sum.

use super::{Ending, Evaluation, Fit, FitError, Loss, Model, Search, Unknown, poll};
use basin::{
    BoxBounds, CauchyLoss, ConstraintDescription, ConstraintSet, Constraints, DenseMatrix, Executor, HuberLoss,
    Jacobian, LossFunction, Residual, RobustLeastSquares, Termination, TrustRegionReflective,
};
use nalgebra::{DMatrix, DVector};
use std::cell::RefCell;
use std::convert::Infallible;

/// Change of an unknown, over its size, below which a search has come to its end.
const RESOLVED: f64 = 1e-13;
/// The cosine between residuals and the derivative with respect to an unknown above which the place is no minimum.
const STATIONARY: f64 = 1e-5;
/// The step that is left to an unknown, over its size, below which the place is one all the same.
const STEP_RESOLVED: f64 = 1e-7;
/// The step that is left to all unknowns, in standard errors, below which a place about which polls find nothing is a minimum.
const OFFSET: f64 = 1e-3;
/// Steps with derivatives after which polls take over, unless the cost has fallen by such a part in them.
const STEPS_WITHOUT_PROGRESS: u64 = 40;
const PROGRESS: f64 = 0.01;
/// How often polls are followed by steps with derivatives.
const ROUNDS: usize = 10;
/// Steps of Gauss and Newton at an end, and how often each is halved at most.
const LEVELLING: usize = 8;
const HALVINGS: i32 = 6;
/// Steps after which a decomposition is given up, far more than one takes.
const MOST_SWEEPS: usize = 100_000;
/// The part of the cost by which a poll must lower it to be followed.
const WORTH: f64 = 1e-6;

/// Where a search has ended.
struct End {
    values: Vec<f64>,
    /// Derivatives only at a minimum.
    there: Evaluation,
    ending: Ending,
}

/// The least cost that a search has seen.
#[derive(Default)]
struct Seen(RefCell<Option<Best>>);

#[derive(Clone)]
struct Best {
    cost: f64,
    /// Over the sizes.
    at: Vec<f64>,
    residuals: Vec<f64>,
}

impl Seen {
    /// The cost of residuals at a place, which is kept where it is the least.
    fn cost(&self, at: &[f64], residuals: &[f64], loss: Loss) -> f64 {
        let cost = loss.cost(residuals);
        let mut best = self.0.borrow_mut();
        if cost.is_finite() && best.as_ref().is_none_or(|best| cost < best.cost) {
            *best = Some(Best { cost, at: at.to_vec(), residuals: residuals.to_vec() });
        }
        cost
    }

    fn best(&self) -> Result<Best, FitError> {
        self.0.borrow().clone().ok_or(FitError::NoStart)
    }
}

/// The fit from one start. An end that is no minimum says too what is not identifiable there: a sum of squares that is level along a
/// line may end a search as a kink does.
pub(super) fn fit(model: &dyn Model, unknowns: &[Unknown], search: &Search) -> Result<Fit, FitError> {
    let end = ended(model, unknowns, search, if search.any_end { Steps::Both } else { Steps::ByDerivatives })?;
    let fit = of(model, unknowns, search, end);
    Ok(match fit.ending {
        Ending::Kink | Ending::Numbers => fit.with_unidentifiable(model, unknowns, search),
        _ => fit,
    })
}

/// The fit from one start, by steps with derivatives alone, wherever they end.
pub(super) fn ended_by_derivatives(model: &dyn Model, unknowns: &[Unknown], search: &Search) -> Result<Fit, FitError> {
    super::check(model, unknowns)?;
    let loss = if search.known_scales { search.loss } else { Loss::Squares };
    let search = Search { loss, ..search.clone() };
    Ok(of(model, unknowns, &search, ended(model, unknowns, &search, Steps::UntilTheyStall)?))
}

/// The values where steps by derivatives end, be it a minimum or not.
pub(super) fn descended(model: &dyn Model, unknowns: &[Unknown], search: &Search) -> Result<Vec<f64>, FitError> {
    Ok(ended(model, unknowns, &Search { any_end: true, ..search.clone() }, Steps::ByDerivatives)?.values)
}

fn of(model: &dyn Model, unknowns: &[Unknown], search: &Search, End { values, there, ending }: End) -> Fit {
    match ending {
        Ending::Minimum => Fit::new(model, unknowns, search, (values, there)),
        _ => Fit::without_intervals(unknowns, &values, &there.residuals, model.residuals(), ending),
    }
}

/// The steps of a search.
#[derive(Clone, Copy, Eq, PartialEq)]
enum Steps {
    /// By derivatives, as many as it may take.
    ByDerivatives,
    /// By derivatives, until they lower the cost no more.
    UntilTheyStall,
    /// Likewise, with steps without derivatives in turn.
    Both,
}

/// Where a search ends.
fn ended(model: &dyn Model, unknowns: &[Unknown], search: &Search, steps: Steps) -> Result<End, FitError> {
    let seen = Seen::default();
    let problem = Scaled::new(model, unknowns, search, &seen);
    let mut from: Vec<f64> = unknowns.iter().zip(&problem.sizes).map(|(unknown, size)| unknown.start / size).collect();
    if !problem.residuals_at(&from).iter().all(|residual| residual.is_finite()) {
        return Err(if search.monitor.is_stopped() { FitError::Interrupted } else { FitError::NoStart });
    }
    let bare = |best: Best, ending: Ending| End {
        values: problem.values(&best.at),
        there: Evaluation { residuals: best.residuals, slopes: Vec::new() },
        ending,
    };
    let mut round = 0;
    let mut last: Option<Vec<f64>> = None;
    let mut left = search.most_steps;
    let ending = loop {
        let begun = seen.best()?.cost;
        let most = if steps == Steps::ByDerivatives { left } else { left.min(STEPS_WITHOUT_PROGRESS) };
        let (end, ending, taken) = problem.descended(from, most);
        left = left.saturating_sub(taken.max(1));
        if let Some(ending) = search.monitor.ending() {
            break ending;
        }
        let values = problem.values(&end);
        let there = super::with_priors(model, unknowns, &values);
        if problem.is_stationary(&values, &there) {
            return Ok(End { values, there, ending: Ending::Minimum });
        }
        // That evaluation may have been cut short.
        if let Some(ending) = search.monitor.ending() {
            break ending;
        }
        let ending = match ending {
            Ending::Steps { .. } if left > 0 => {
                if seen.best()?.cost < begun * (1.0 - PROGRESS) {
                    from = end;
                    continue;
                }
                // To and fro across a kink.
                Ending::Kink
            }
            ending => ending,
        };
        if steps != Steps::Both || ending.is_early() || round == ROUNDS {
            break ending;
        }
        let before = seen.best()?;
        let there = problem.evaluate(&before.at);
        let cost = |at: &[f64]| search.loss.cost(&problem.residuals_at(&problem.within(at)));
        poll::around(&before.at, &there, search.most_steps, cost);
        let polled = seen.best()?;
        if polled.cost < before.cost {
            poll::onwards(&before.at, (&polled.at, polled.cost), cost);
        }
        if let Some(ending) = search.monitor.ending() {
            break ending;
        }
        let after = seen.best()?;
        // From one kink to the next the moves lie along it.
        if let Some(last) = last.replace(after.at.clone())
            && after.cost < before.cost
        {
            poll::onwards(&last, (&after.at, after.cost), cost);
        }
        let after = seen.best()?;
        if after.cost >= before.cost * (1.0 - WORTH) {
            let (values, there) = problem.levelled(problem.values(&after.at));
            if problem.left(&values, &there).is_some_and(|(offset, _)| offset < OFFSET) {
                return Ok(End { values, there, ending: Ending::Minimum });
            }
            // A method may fail at a kink by its numbers too. Where there are derivatives they were not what ended it.
            let has_slopes = there.slopes.iter().all(|slope| slope.is_finite());
            break if ending == Ending::Numbers && !has_slopes { ending } else { Ending::Kink };
        }
        from = after.at;
        round += 1;
    };
    match search.any_end {
        true => Ok(bare(seen.best()?, ending)),
        false if matches!(ending, Ending::Interrupted | Ending::Time) => Err(FitError::Interrupted),
        false => Err(FitError::NoMinimum { why: ending }),
    }
}

/// What ended a search, in the words of this crate.
fn ending(by: &Termination, search: &Search) -> Ending {
    match by {
        Termination::Limit(_) => Ending::Steps { most: search.most_steps },
        Termination::Failed(_) => Ending::Numbers,
        _ => Ending::Kink,
    }
}

/// A model with its priors, in unknowns divided by their sizes.
#[derive(Clone)]
struct Scaled<'a> {
    model: &'a dyn Model,
    unknowns: &'a [Unknown],
    search: &'a Search,
    seen: &'a Seen,
    sizes: Vec<f64>,
    least: Vec<f64>,
    largest: Vec<f64>,
}

impl<'a> Scaled<'a> {
    fn new(model: &'a dyn Model, unknowns: &'a [Unknown], search: &'a Search, seen: &'a Seen) -> Self {
        let sizes: Vec<f64> = unknowns.iter().map(Unknown::size).collect();
        let bound =
            |side: usize| unknowns.iter().zip(&sizes).map(|(unknown, size)| unknown.bounds[side] / size).collect();
        Self { model, unknowns, search, seen, least: bound(0), largest: bound(1), sizes }
    }

    /// Where so many steps by derivatives end, and how many were taken.
    fn descended(&self, start: Vec<f64>, most: u64) -> (Vec<f64>, Ending, u64) {
        let method = TrustRegionReflective::new()
            .with_absolute_scaled_gradient_tolerance(0.0)
            .with_relative_cost_change_tolerance(self.model.rounding())
            .with_relative_step_tolerance(RESOLVED);
        macro_rules! run {
            ($problem:expr) => {
                match Executor::from_start($problem, method, start.clone()).max_iter(most).run() {
                    Ok(result) => {
                        (result.param().clone(), ending(&result.report.termination, self.search), result.iter())
                    }
                    Err(_) => (start, Ending::Numbers, 1),
                }
            };
        }
        // One type for both: the method is compiled again for each.
        let (loss, scale): (&dyn LossFunction, f64) = match self.search.loss {
            Loss::Squares => return run!(self.clone()),
            Loss::Huber(scale) => (&HuberLoss, scale),
            Loss::Cauchy(scale) => (&CauchyLoss, scale),
        };
        run!(RobustLeastSquares::new(self.clone(), loss).with_scale(scale))
    }

    fn values(&self, at: &[f64]) -> Vec<f64> {
        at.iter().zip(&self.sizes).map(|(part, size)| part * size).collect()
    }

    /// The nearest place within the bounds.
    fn within(&self, at: &[f64]) -> Vec<f64> {
        let bounds = self.least.iter().zip(&self.largest);
        at.iter().zip(bounds).map(|(at, (least, largest))| at.max(*least).min(*largest)).collect()
    }

    fn residuals_at(&self, at: &[f64]) -> Vec<f64> {
        if !self.search.monitor.goes_on() {
            return self.nowhere();
        }
        let residuals = super::tried(self.model, self.unknowns, &self.values(at));
        self.seen.cost(at, &residuals, self.search.loss);
        residuals
    }

    /// Residuals of a place where the model has no value. They end a search.
    fn nowhere(&self) -> Vec<f64> {
        let priors = self.unknowns.iter().filter(|unknown| unknown.prior.is_some()).count();
        vec![f64::NAN; self.model.residuals() + priors]
    }

    fn evaluate(&self, at: &[f64]) -> Evaluation {
        if !self.search.monitor.goes_on() {
            let residuals = self.nowhere();
            return Evaluation { slopes: vec![f64::NAN; residuals.len() * at.len()], residuals };
        }
        let mut evaluation = super::with_priors(self.model, self.unknowns, &self.values(at));
        for row in evaluation.slopes.chunks_mut(self.sizes.len().max(1)) {
            row.iter_mut().zip(&self.sizes).for_each(|(slope, size)| *slope *= size);
        }
        evaluation
    }

    /// The step that is left to the unknowns within their bounds: in standard errors, the relative offset of Bates & Watts (1981,
    /// Technometrics 23, 179–183), and in their units, the step of Gauss and Newton. Directions that are not identifiable take no
    /// part: the sum of squares is level along them. `None` where the numbers do not give it.
    fn left(&self, values: &[f64], there: &Evaluation) -> Option<(f64, Vec<f64>)> {
        let Evaluation { residuals, slopes } = there;
        if !residuals.iter().chain(slopes).all(|number| number.is_finite()) {
            return None;
        }
        let roots = residuals.iter().map(|residual| self.search.loss.weight(*residual).sqrt());
        let weighted = DVector::from_iterator(residuals.len(), residuals.iter().zip(roots).map(|(r, w)| r * w));
        let rows = DMatrix::from_row_slice(residuals.len(), values.len(), slopes);
        let is_free = |unknown: &usize| {
            let along = rows.column(*unknown).dot(&weighted);
            let [on_least, on_largest] = self.unknowns[*unknown].rests(values[*unknown]);
            !((on_least && along > 0.0) || (on_largest && along < 0.0))
        };
        let free: Vec<usize> = (0..values.len()).filter(is_free).collect();
        let mut step = vec![0.0; values.len()];
        if free.is_empty() {
            return Some((0.0, step));
        }
        if residuals.len() <= free.len() {
            return None;
        }
        let mut own = rows.select_columns(&free);
        for (mut row, residual) in own.row_iter_mut().zip(residuals) {
            row *= self.search.loss.weight(*residual).sqrt();
        }
        // Of an unknown without effect the norm is zero, and any will do.
        let norms: Vec<f64> = own.column_iter().map(|column| column.norm()).collect();
        let norms: Vec<f64> = norms.into_iter().map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        for (mut column, norm) in own.column_iter_mut().zip(&norms) {
            column /= *norm;
        }
        let decomposed = own.qr();
        let along = decomposed.q().tr_mul(&weighted);
        let svd = decomposed.r().try_svd(true, true, f64::EPSILON, MOST_SWEEPS)?;
        let (left, right) = (svd.u?, svd.v_t?);
        let largest = svd.singular_values.iter().copied().fold(0.0, f64::max);
        let (mut within, mut directions) = (0.0, 0_usize);
        for (k, value) in svd.singular_values.iter().enumerate() {
            if *value > self.model.precision() * largest {
                let part = left.column(k).dot(&along);
                within += part * part;
                directions += 1;
                for (place, unknown) in free.iter().enumerate() {
                    step[*unknown] -= right[(k, place)] * part / (value * norms[place]);
                }
            }
        }
        if directions == 0 {
            return Some((0.0, step));
        }
        let beyond = (weighted.norm_squared() - within).max(0.0) / (residuals.len() - directions) as f64;
        let offset = (within / directions as f64 / beyond).sqrt();
        (offset.is_finite() && step.iter().all(|part| part.is_finite())).then_some((offset, step))
    }

    /// Values with what is left of the way to a minimum taken, where it is one: by steps of Gauss and Newton in the directions that are
    /// identifiable, each shortened until the cost falls. Beside a direction along which nothing changes a method may stop short.
    fn levelled(&self, mut values: Vec<f64>) -> (Vec<f64>, Evaluation) {
        let cost = |there: &Evaluation| self.search.loss.cost(&there.residuals);
        let mut there = super::with_priors(self.model, self.unknowns, &values);
        for _ in 0..LEVELLING {
            let Some((offset, step)) = self.left(&values, &there) else { break };
            if offset < OFFSET {
                break;
            }
            let least = cost(&there);
            let shortened = |halvings: i32| {
                let part = 0.5_f64.powi(halvings);
                let moved =
                    values.iter().zip(&step).zip(&self.sizes).map(|((value, step), size)| (value + part * step) / size);
                self.within(&moved.collect::<Vec<f64>>())
            };
            let falls = |at: &Vec<f64>| self.search.loss.cost(&self.residuals_at(at)) < least;
            let Some(next) = (0..HALVINGS).map(shortened).find(falls) else { break };
            values = self.values(&next);
            there = super::with_priors(self.model, self.unknowns, &values);
        }
        (values, there)
    }

    /// Whether no free unknown would make the sum smaller: residuals and derivatives are at right angles.
    fn is_stationary(&self, values: &[f64], there: &Evaluation) -> bool {
        let loss = self.search.loss;
        let Evaluation { residuals, slopes } = there;
        if !residuals.iter().chain(slopes).all(|number| number.is_finite()) {
            return false;
        }
        let weights: Vec<f64> = residuals.iter().map(|residual| loss.weight(*residual)).collect();
        let length = norm(residuals.iter().zip(&weights).map(|(residual, weight)| residual * weight.sqrt()));
        // What the error of the model makes of residuals that are to be zero.
        let rounded = self.model.error() * (residuals.len() as f64).sqrt();
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
            outwards
                || along.abs() <= size * rounded.max(STATIONARY * length)
                || along.abs() <= STEP_RESOLVED * size * size
        })
    }
}

fn norm(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.map(|number| number * number).sum::<f64>().sqrt()
}

impl Constraints for Scaled<'_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;
    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.least), Some(&self.largest)))
    }
}

impl Residual for Scaled<'_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = Infallible;
    fn residual(&self, at: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        Ok(self.residuals_at(at))
    }
}

impl Jacobian for Scaled<'_> {
    type Jacobian = DenseMatrix;
    fn jacobian(&self, at: &Vec<f64>) -> Result<DenseMatrix, Infallible> {
        let Evaluation { residuals, slopes } = self.evaluate(at);
        Ok(DenseMatrix::from_row_slice(residuals.len(), at.len(), &slopes))
    }
}
