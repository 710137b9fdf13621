//! Searches from several starts: the best of them, and the other minima that they led to.
//!
//! The first start is always searched from. Of the others the cost alone is evaluated, and the searches go from those of least
//! cost, as many as [`Search::refined`] says: a start in a poor valley costs one evaluation in place of a search.

use super::{Ending, Fit, FitError, Loss, Model, Search, Unknown, fit, solver, starting_at, tried};
use rayon::prelude::*;

/// The part of the least cost by which two costs differ that are one.
const ALIKE: f64 = 1e-6;
/// The difference of a value over its size below which two ends are one.
const CLOSE: f64 = 1e-4;
/// Residuals, in their scales, that are nothing: two ends which leave less are alike.
const NOTHING: f64 = 1e-6;

/// The best of several fits.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The fit of the least cost.
    pub fit: Fit,
    /// Half the sum of squares where its search ended among the others, in the weights that all of them had.
    pub cost: f64,
    /// From how many starts it was searched.
    pub tried: usize,
    /// How many of these searches led to it.
    pub agreeing: usize,
    /// How many more starts were evaluated, of which the searches went from the best.
    pub screened: usize,
    /// How many searches ended without values, as where the model cannot be evaluated.
    pub failed: usize,
    /// The other ends of the searches, the least cost first.
    pub others: Vec<Minimum>,
}

/// Where another search has ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// The values of the unknowns, in their order.
    pub values: Vec<f64>,
    /// Half the sum of squares there.
    pub cost: f64,
    /// What ended the search.
    pub ending: Ending,
    /// How many searches ended there.
    pub searches: usize,
}

impl Found {
    /// A fit from its only start.
    pub(crate) fn only(fit: Fit) -> Self {
        Self { cost: fit.cost, fit, tried: 1, agreeing: 1, screened: 0, failed: 0, others: Vec::new() }
    }
}

/// Finds the values that fit best from the start of the unknowns and from more starts, each the values of all unknowns. A start
/// outside the bounds is taken to the nearest bound.
///
/// # Errors
/// [`FitError`] of the first start, when none of them leads to a result.
pub fn fit_from(
    model: &(dyn Model + Sync),
    unknowns: &[Unknown],
    starts: &[Vec<f64>],
    search: &Search,
) -> Result<Found, FitError> {
    let within = |start: &Vec<f64>| -> Vec<f64> {
        let within = |(unknown, start): (&Unknown, &f64)| start.clamp(unknown.bounds[0], unknown.bounds[1]);
        unknowns.iter().zip(start).map(within).collect()
    };
    let starts: Vec<Vec<f64>> = starts.iter().map(within).collect();
    // Steps without derivatives go on from the best end only.
    let by_derivatives = Search { any_end: false, ..search.clone() };
    let ended = |unknowns: &[Unknown]| match search.any_end {
        true => solver::ended_by_derivatives(model, unknowns, search),
        false => fit(model, unknowns, &by_derivatives),
    };
    // Searches share the cores: one from another start may be ended before the first has judged where it begins.
    let begun = (search.any_end && !starts.is_empty()).then(|| begun(model, unknowns));
    let mut screened = 0;
    let mut from = vec![unknowns.to_vec()];
    from.extend(
        best_of(model, unknowns, starts, search, &mut screened).iter().map(|start| starting_at(unknowns, start)),
    );
    // Each for itself, so that they share the cores; a search that has not begun when they are to end is none.
    let searched = |(place, unknowns): (usize, &Vec<Unknown>)| {
        (place == 0 || !search.monitor.is_stopped()).then(|| ended(unknowns))
    };
    let mut ends: Vec<Result<Fit, FitError>> = from.par_iter().enumerate().filter_map(searched).collect();
    if let (Some(Err(FitError::Interrupted)), Some(begun), Some(ending)) =
        (ends.first(), begun, search.monitor.ending())
    {
        ends[0] = begun.map(|fit| Fit { ending, ..fit });
    }
    let (tried, first) = (ends.len(), ends.first().and_then(|first| first.as_ref().err().cloned()));
    let fits: Vec<Fit> = ends.into_iter().flatten().collect();
    let failed = tried - fits.len();
    let floor = 0.5 * NOTHING * NOTHING * model.residuals() as f64;
    let least = fits.iter().fold(f64::INFINITY, |least, fit| least.min(fit.cost));
    // Of ends of one cost, the one that is a minimum.
    let is_least = |fit: &&Fit| fit.cost <= least * (1.0 + ALIKE);
    let rank = |fit: &&Fit| (fit.ending != Ending::Minimum, fit.cost);
    let before = |a: &&Fit, b: &&Fit| rank(a).0.cmp(&rank(b).0).then(a.cost.total_cmp(&b.cost));
    let Some(best) = fits.iter().filter(is_least).min_by(before) else {
        return Err(first.unwrap_or(FitError::NoStart));
    };
    let is_same = |a: &Minimum, b: &Minimum| {
        let close = |((a, b), unknown): ((&f64, &f64), &Unknown)| {
            (a - b).abs() <= CLOSE * a.abs().max(b.abs()).max(1e-3 * unknown.size())
        };
        (a.cost - b.cost).abs() <= ALIKE * a.cost.min(b.cost) + floor
            || a.values.iter().zip(&b.values).zip(unknowns).all(close)
    };
    let end = |fit: &Fit| Minimum { values: fit.values(), cost: fit.cost, ending: fit.ending, searches: 1 };
    let mut ends = vec![end(best)];
    let mut sorted: Vec<&Fit> = fits.iter().filter(|fit| !std::ptr::eq(*fit, best)).collect();
    sorted.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    for other in sorted.into_iter().map(end) {
        match ends.iter_mut().find(|of| is_same(of, &other)) {
            Some(of) => of.searches += 1,
            None => ends.push(other),
        }
    }
    let agreeing = ends.remove(0).searches;
    let may_go_on = search.any_end && best.ending != Ending::Minimum && !best.ending.is_early();
    let fit = match may_go_on || search.any_end && has_unknown_scale(search) {
        // An interruption before the first step leaves what there is.
        true => fit(model, &starting_at(unknowns, &best.values()), search).unwrap_or_else(|_| best.clone()),
        false => best.clone(),
    };
    Ok(Found { cost: best.cost, fit, tried, agreeing, screened, failed, others: ends })
}

/// The start of the unknowns as the best values of a search that is ended there.
fn begun(model: &dyn Model, unknowns: &[Unknown]) -> Result<Fit, FitError> {
    let values: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
    let residuals = tried(model, unknowns, &values);
    let has_value = residuals.iter().all(|residual| residual.is_finite());
    let fit = || Fit::without_intervals(unknowns, &values, &residuals, model.residuals(), Ending::Interrupted);
    has_value.then(fit).ok_or(FitError::Interrupted)
}

/// Whether the loss takes its measure from the residuals.
fn has_unknown_scale(search: &Search) -> bool {
    !search.known_scales && search.loss != Loss::Squares
}

/// Those of more starts to search from.
fn best_of(
    model: &(dyn Model + Sync),
    unknowns: &[Unknown],
    starts: Vec<Vec<f64>>,
    search: &Search,
    screened: &mut usize,
) -> Vec<Vec<f64>> {
    let Some(refined) = search.refined.filter(|refined| *refined < starts.len()) else { return starts };
    let loss = if has_unknown_scale(search) { Loss::Squares } else { search.loss };
    let judge = |start: Vec<f64>| search.monitor.goes_on().then(|| (loss.cost(&tried(model, unknowns, &start)), start));
    let mut judged: Vec<(f64, Vec<f64>)> = starts.into_par_iter().filter_map(judge).collect();
    *screened = judged.len();
    judged.retain(|(cost, _)| cost.is_finite());
    judged.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    judged.into_iter().take(refined).map(|(_, start)| start).collect()
}
