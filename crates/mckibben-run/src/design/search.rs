//! The least of a function over the unit box, under constraints, without derivatives and within a number of evaluations.
//!
//! | step | what is done | share of the evaluations |
//! |---|---|---|
//! | screening | points of the R sequence, that fills the box evenly and begins in its middle | two fifths |
//! | local searches | COBYLA from the best points that lie apart, each independent of the others | three quarters of the rest |
//! | last search | COBYLA in small steps about the best point so far | what is left |
//!
//! The R sequence is `x_k = ½ + k·(1/φ, 1/φ², …) mod 1` with `φ^(n+1) = φ + 1` (M. Roberts, "The unreasonable effectiveness of
//! quasirandom sequences", 2018). COBYLA (M. J. D. Powell, "A direct search optimization method that models the objective and
//! constraint functions by linear interpolation", in Advances in Optimization and Numerical Analysis, 1994, 51–67; the crate
//! `basin`) steps by linear models of cost and constraints in a trust region that shrinks. Both are deterministic, and what one
//! local search finds does not hang on another: results are equal on any number of threads.
//!
//! Cost and constraints are divided by their spread over the screening. A point at which nothing can be evaluated counts as worse
//! than all that were screened.
//!
//! Checked by the tests below.

use super::cobyla;
use rayon::prelude::*;
use std::collections::HashSet;

/// Part of its scale by which a constraint may be broken and counts as met.
pub const TOLERANCE: f64 = 1e-6;
/// Local searches at most.
const MOST_STARTS: usize = 4;
/// Evaluations that a local search should have for each coordinate and one more.
const WORTH: usize = 15;
/// Distance in the box below which two starts are the same.
const APART: f64 = 0.15;
/// The cost of breaking a constraint by its whole spread, in spreads of the cost, where starts are chosen.
const PENALTY: f64 = 10.0;
/// The first and the last radius of the last search.
const LAST_RADII: [f64; 2] = [0.01, 1e-5];
/// The last radius of a local search.
const LAST_RADIUS: f64 = 1e-4;

/// What a point of the box is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Worth {
    /// What is made least.
    pub cost: f64,
    /// By how much each constraint is broken; at or below zero where it is met.
    pub excess: Vec<f64>,
}

/// An evaluated point; `None` where nothing could be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The point in the unit box.
    pub at: Vec<f64>,
    /// What it is worth.
    pub worth: Option<Worth>,
}

impl Trial {
    /// By how much the constraint that is broken most is broken, in parts of its scale; not finite where nothing was evaluated.
    pub fn violation(&self, scales: &[f64]) -> f64 {
        self.worth.as_ref().map_or(f64::INFINITY, |worth| {
            worth.excess.iter().zip(scales).fold(0.0, |most: f64, (excess, scale)| most.max(excess / scale))
        })
    }

    /// Whether it meets every constraint.
    pub fn is_feasible(&self, scales: &[f64]) -> bool {
        self.violation(scales) <= TOLERANCE
    }
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Searched {
    /// The points in the order of the steps of the search, each once.
    pub trials: Vec<Trial>,
    /// The place of the best among them: of those that meet every constraint the least cost, else the least violation.
    pub best: usize,
    /// What one part of each constraint is.
    pub scales: Vec<f64>,
    /// Whether the last search came to its last radius before the evaluations were used up.
    pub is_converged: bool,
}

/// A problem over the unit box.
pub struct Problem<'p> {
    /// Number of coordinates.
    pub coordinates: usize,
    /// What one part of each constraint is, such as the size of its bound; where it is zero the largest size of its excess in the
    /// screening.
    pub scales: &'p [f64],
    /// Evaluates a point.
    pub evaluate: &'p (dyn Fn(&[f64]) -> Option<Worth> + Sync),
}

/// Searches with at most so many evaluations, of which there must be one.
pub fn search(problem: &Problem<'_>, evaluations: usize) -> Searched {
    let screened = (2 * evaluations).div_ceil(5).max(evaluations.min(4)).max(1);
    let points = (0..screened).map(|place| point(problem.coordinates, place));
    let mut trials: Vec<Trial> = points.collect::<Vec<_>>().into_par_iter().map(|at| trial(problem, at)).collect();
    let scaling = Scaling::of(problem, &trials);
    let rest = evaluations.saturating_sub(screened);

    let each = WORTH * (problem.coordinates + 1);
    let starts = starts(&trials, &scaling, (3 * rest / 4 / each).clamp(1, MOST_STARTS));
    let budget = if starts.is_empty() { 0 } else { 3 * rest / 4 / starts.len() };
    // Half of what lies between the points of the screening.
    let radius = (0.5 * (screened as f64).powf(-1.0 / problem.coordinates as f64)).clamp(0.05, 0.25);
    let local = |start: Trial| {
        let known = vec![start.clone()];
        cobyla::search(problem, &scaling, (&start, known), [radius, LAST_RADIUS], budget)
    };
    let found: Vec<Vec<Trial>> = starts.into_par_iter().map(local).collect();
    trials.extend(found.into_iter().flatten());

    let left = evaluations.saturating_sub(trials.len());
    let best = best(&trials, &scaling.scales);
    let mut is_converged = false;
    if trials[best].worth.is_some() {
        let last = cobyla::search(problem, &scaling, (&trials[best], trials.clone()), LAST_RADII, left);
        is_converged = last.len() < left;
        trials.extend(last);
    }
    let mut seen = HashSet::new();
    trials.retain(|trial| seen.insert(trial.at.iter().map(|x| x.to_bits()).collect::<Vec<_>>()));
    Searched { best: self::best(&trials, &scaling.scales), trials, scales: scaling.scales, is_converged }
}

/// A point of the R sequence, from 0: the middle of the box.
pub fn point(coordinates: usize, place: usize) -> Vec<f64> {
    let ratio = (0..64).fold(2.0_f64, |ratio, _| (1.0 + ratio).powf(1.0 / (coordinates as f64 + 1.0)));
    let step = |coordinate: usize| ratio.powi(-(coordinate as i32 + 1));
    (0..coordinates).map(|coordinate| (0.5 + place as f64 * step(coordinate)).fract()).collect()
}

pub(super) fn trial(problem: &Problem<'_>, at: Vec<f64>) -> Trial {
    let worth = (problem.evaluate)(&at);
    Trial { worth, at }
}

/// How cost and constraints are scaled in local searches.
pub(super) struct Scaling {
    /// What one part of each constraint is.
    scales: Vec<f64>,
    cost: [f64; 2],
    spreads: Vec<f64>,
    /// The worst scaled excess of the screening; the worst scaled cost is 1.
    worst: f64,
}

impl Scaling {
    fn of(problem: &Problem<'_>, trials: &[Trial]) -> Self {
        let worths = || trials.iter().filter_map(|trial| trial.worth.as_ref());
        let excess = |constraint: usize| worths().map(move |worth| worth.excess[constraint]);
        let largest = |place: usize| excess(place).fold(0.0, |most: f64, excess| most.max(excess.abs()));
        let or_one = |size: f64| if size > 0.0 && size.is_finite() { size } else { 1.0 };
        let scale = |(place, scale): (usize, &f64)| or_one(if *scale > 0.0 { *scale } else { largest(place) });
        let scales: Vec<f64> = problem.scales.iter().enumerate().map(scale).collect();
        let [least, greatest] = ends(worths().map(|worth| worth.cost));
        // What does not change in the screening keeps its own size.
        let spread = |ends: [f64; 2], size: f64| if ends[1] > ends[0] { ends[1] - ends[0] } else { or_one(size) };
        let of_constraint = |(place, scale): (usize, &f64)| spread(ends(excess(place)), *scale);
        let mut scaling = Self {
            spreads: scales.iter().enumerate().map(of_constraint).collect(),
            cost: [if least.is_finite() { least } else { 0.0 }, spread([least, greatest], least.abs())],
            scales,
            worst: 0.0,
        };
        let all: Vec<Worth> = worths().map(|worth| scaling.scaled(worth)).collect();
        scaling.worst = all.iter().flat_map(|worth| &worth.excess).fold(0.0, |most: f64, of| most.max(*of));
        scaling
    }

    /// Cost and constraints of the size of one; the constraints aim within half of the tolerance.
    pub(super) fn scaled(&self, worth: &Worth) -> Worth {
        let sizes = self.scales.iter().zip(&self.spreads);
        let excess = worth.excess.iter().zip(sizes);
        Worth {
            cost: (worth.cost - self.cost[0]) / self.cost[1],
            excess: excess.map(|(excess, (scale, spread))| (excess + 0.5 * TOLERANCE * scale) / spread).collect(),
        }
    }

    /// What stands in for a point at which nothing could be evaluated.
    pub(super) fn of_failure(&self) -> Worth {
        Worth { cost: 2.0, excess: vec![self.worst + 1.0; self.scales.len()] }
    }
}

fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)])
}

/// The most promising points that lie apart.
fn starts(trials: &[Trial], scaling: &Scaling, most: usize) -> Vec<Trial> {
    let merit = |worth: &Worth| {
        let scaled = scaling.scaled(worth);
        let broken: f64 = scaled.excess.iter().fold(0.0, |most, excess| most.max(*excess));
        scaled.cost + PENALTY * broken
    };
    let evaluated = trials.iter().filter_map(|trial| Some((merit(trial.worth.as_ref()?), trial)));
    let mut ranked: Vec<(f64, &Trial)> = evaluated.collect();
    ranked.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut chosen: Vec<Trial> = Vec::new();
    for (_, trial) in ranked {
        let apart = |start: &Trial| start.at.iter().zip(&trial.at).any(|(one, other)| (one - other).abs() > APART);
        if chosen.len() < most && chosen.iter().all(apart) {
            chosen.push(trial.clone());
        }
    }
    chosen
}

/// The place of the best trial, the first of equals.
pub fn best(trials: &[Trial], scales: &[f64]) -> usize {
    let rank = |trial: &Trial| match trial.violation(scales) {
        violation if violation <= TOLERANCE => (0.0, trial.worth.as_ref().map_or(f64::INFINITY, |worth| worth.cost)),
        violation => (violation, 0.0),
    };
    let ranks = trials.iter().map(rank).enumerate();
    let less = |one: (f64, f64), other: (f64, f64)| one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1));
    ranks.min_by(|(_, one), (_, other)| less(*one, *other)).map_or(0, |(place, _)| place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn run(
        coordinates: usize,
        scales: &[f64],
        evaluations: usize,
        evaluate: &(dyn Fn(&[f64]) -> Option<Worth> + Sync),
    ) -> Searched {
        let count = AtomicUsize::new(0);
        let counted = |at: &[f64]| {
            count.fetch_add(1, Ordering::Relaxed);
            assert!(at.iter().all(|x| (0.0..=1.0).contains(x)), "{at:?} is outside the box");
            evaluate(at)
        };
        let searched = search(&Problem { coordinates, scales, evaluate: &counted }, evaluations);
        assert!(count.into_inner() <= evaluations && searched.trials.len() <= evaluations);
        searched
    }

    /// A disc about (0.3, 0.6) of radius 0.2 and the least of x + y in it: on its edge, at 45° (the multiplier of Lagrange).
    #[test]
    fn an_active_constraint_is_met_at_the_point_of_tangency() {
        let found = run(2, &[0.04], 200, &|at| {
            let (x, y) = (at[0] - 0.3, at[1] - 0.6);
            Some(Worth { cost: at[0] + at[1], excess: vec![x * x + y * y - 0.04] })
        });
        let best = &found.trials[found.best];
        let due = [0.3 - 0.2 / 2f64.sqrt(), 0.6 - 0.2 / 2f64.sqrt()];
        assert!(best.is_feasible(&found.scales) && found.is_converged);
        assert!(best.at.iter().zip(due).all(|(x, due)| (x - due).abs() < 1e-4), "{best:?}, not {due:?}");
    }

    #[test]
    fn a_corner_of_the_box_is_reached() {
        let found = run(3, &[], 120, &|at| Some(Worth { cost: at[0] - 2.0 * at[1] + at[2] * at[2], excess: vec![] }));
        assert_eq!(found.trials[found.best].at, [0.0, 1.0, 0.0]);
    }

    /// Half of the box cannot be evaluated, and the least lies on the edge of the other half.
    #[test]
    fn failures_count_as_worse_than_all_else() {
        let found =
            run(1, &[], 100, &|at| (at[0] >= 0.5).then(|| Worth { cost: (at[0] - 0.2).powi(2), excess: vec![] }));
        let best = &found.trials[found.best];
        assert!(best.at[0] >= 0.5 && best.at[0] < 0.505, "{best:?}");
        assert!(found.trials.iter().any(|trial| trial.worth.is_none()));
    }

    #[test]
    fn infeasible_constraints_give_the_least_violation() {
        // x ≥ 0.7 and x ≤ 0.4, each in parts of 1: the middle breaks both the least.
        let found = run(1, &[1.0, 1.0], 60, &|at| Some(Worth { cost: at[0], excess: vec![0.7 - at[0], at[0] - 0.4] }));
        let best = &found.trials[found.best];
        assert!(!best.is_feasible(&found.scales) && (best.at[0] - 0.55).abs() < 1e-3, "{best:?}");
    }

    /// Few evaluations are used to the last: the start of a local search is known and takes none.
    #[test]
    fn few_evaluations_are_all_made() {
        for evaluations in [1, 2, 3, 4, 5, 6, 8, 12] {
            let evaluate = |at: &[f64]| Some(Worth { cost: (5.0 * at[0]).sin(), excess: vec![0.21 - at[0]] });
            let found = run(1, &[0.21], evaluations, &evaluate);
            assert_eq!((found.trials.len(), found.is_converged), (evaluations, false));
        }
    }

    #[test]
    fn any_number_of_threads_and_evaluations_has_its_one_result() {
        let evaluate = |at: &[f64]| {
            let cost = (5.0 * at[0]).sin() + (7.0 * at[1]).cos() + at[0] * at[1];
            (at[0] + at[1] > 0.2).then(|| Worth { cost, excess: vec![0.3 - at[0] * at[1]] })
        };
        for evaluations in [1, 2, 3, 7, 20, 150] {
            let results = [1, 4].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| run(2, &[0.3], evaluations, &evaluate))
            });
            assert_eq!(results[0], results[1]);
            assert!(evaluations > 20 || !results[0].is_converged);
        }
        assert!(run(2, &[0.3], 10, &|_| None).trials.iter().all(|trial| trial.worth.is_none()));
    }

    #[test]
    fn the_sequence_begins_in_the_middle_and_fills_a_line_evenly() {
        assert_eq!(point(3, 0), [0.5; 3]);
        // The golden ratio: of n points no gap is wider than 3/n (three-distance theorem).
        let mut line: Vec<f64> = (0..89).map(|place| point(1, place)[0]).collect();
        line.sort_by(f64::total_cmp);
        assert!(line.windows(2).all(|pair| pair[1] - pair[0] < 3.0 / 89.0));
    }
}
