//! A local search by COBYLA, of the crate `basin`, in the unit box.
//!
//! The method may request points beyond the box; such a point is taken to the nearest one of the box, and a constraint for each
//! bound leads back. So that the first simplex lies in the box, coordinates run from the bound that is farther from the start.

use super::search::{Problem, Scaling, Trial, Worth, trial};
use basin::{
    Cobyla, ConstraintDescription, ConstraintSet, ConstraintSolveError, Constraints, CostFunction, Executor, NoBounds,
    NoLinearConstraints, NoNonlinearBlock, NonlinearBlock, NonlinearBlocks, NonlinearInequalityValues,
};
use std::cell::RefCell;
use std::fmt;

/// The points that a search evaluates, at most so many, with its first and last radius. What is known, the start among it, is none of
/// them.
pub(super) fn search(
    problem: &Problem<'_>,
    scaling: &Scaling,
    (start, known): (&Trial, Vec<Trial>),
    [first, last]: [f64; 2],
    evaluations: usize,
) -> Vec<Trial> {
    if evaluations == 0 {
        return Vec::new();
    }
    let is_mirrored: Vec<bool> = start.at.iter().map(|x| *x > 0.5).collect();
    let count = known.len();
    let trials = RefCell::new(known);
    let local = Local { problem, scaling, is_mirrored, most: count + evaluations, trials: &trials };
    let method = Cobyla::new().with_initial_radius(first).with_final_radius(last);
    let start = local.mirrored(&start.at);
    // The steps of the method also end where they request known points only.
    let most = u64::try_from(4 * evaluations + 1).unwrap_or(u64::MAX);
    // That the evaluations are used up ends it by an error; what was evaluated is all that is wanted.
    let _ = Executor::from_start(local, method, start).max_cost_evals(most).run();
    trials.into_inner().split_off(count)
}

struct Local<'a, 'p> {
    problem: &'a Problem<'p>,
    scaling: &'a Scaling,
    /// The coordinates that run from the upper bound.
    is_mirrored: Vec<bool>,
    /// How many points there may be.
    most: usize,
    /// What was known and what was evaluated.
    trials: &'a RefCell<Vec<Trial>>,
}

impl Local<'_, '_> {
    fn mirrored(&self, at: &[f64]) -> Vec<f64> {
        at.iter().zip(&self.is_mirrored).map(|(x, is_mirrored)| if *is_mirrored { 1.0 - x } else { *x }).collect()
    }

    /// The scaled worth of a point, evaluated unless it is known.
    fn worth(&self, at: &[f64]) -> Result<Worth, Spent> {
        let inside: Vec<f64> = self.mirrored(at).into_iter().map(|x| x.clamp(0.0, 1.0)).collect();
        let scaled = |trial: &Trial| {
            trial.worth.as_ref().map_or_else(|| self.scaling.of_failure(), |worth| self.scaling.scaled(worth))
        };
        let mut trials = self.trials.borrow_mut();
        if let Some(known) = trials.iter().find(|trial| trial.at == inside) {
            return Ok(scaled(known));
        }
        if trials.len() >= self.most {
            return Err(Spent);
        }
        trials.push(trial(self.problem, inside));
        trials.last().map(scaled).ok_or(Spent)
    }
}

impl Constraints for Local<'_, '_> {
    type Set = ConstraintSet<NoBounds, NoLinearConstraints, NonlinearBlocks<NoNonlinearBlock, NonlinearBlock>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_nonlinear_inequalities(self.problem.scales.len() + 2 * self.problem.coordinates)
    }
}

impl CostFunction for Local<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Spent;

    fn cost(&self, at: &Vec<f64>) -> Result<f64, Spent> {
        Ok(self.worth(at)?.cost)
    }
}

impl NonlinearInequalityValues for Local<'_, '_> {
    type Param = Vec<f64>;
    type Values = Vec<f64>;
    type Error = Spent;

    fn nonlinear_inequalities(&self, at: &Vec<f64>) -> Result<Vec<f64>, ConstraintSolveError<Spent>> {
        let mut excess = self.worth(at).map_err(ConstraintSolveError::Evaluation)?.excess;
        excess.extend(at.iter().flat_map(|x| [-x, x - 1.0]));
        Ok(excess)
    }
}

/// That the evaluations are used up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spent;

impl fmt::Display for Spent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the evaluations are used up")
    }
}

impl std::error::Error for Spent {}
