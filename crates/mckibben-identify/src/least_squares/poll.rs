//! Steps without derivatives, for a sum of squares with kinks: mesh adaptive direct search (the crate `basin`).
//!
//! ```text
//! x = x₀ + Σ_k v_k h_k z_k        polled in z, from z = 0
//! h_k = s/σ_k                     σ_k, v_k: singular values and directions of the derivatives, s: the scatter of the residuals
//! ```
//!
//! So one unit of every z is a standard error, in whichever combination of unknowns, as far as the derivatives on one side of
//! the kink determine it. The poll ends where its steps are a thousandth of that. Values beyond a bound are taken to
//! it.
//!
//! The method converges on functions with kinks (Audet & Dennis 2006, SIAM J. Optim. 17, 188–217; Abramson, Audet, Dennis & Le
//! Digabel 2009, SIAM J. Optim. 20, 948–966), where a simplex may collapse. It needs no random numbers.

use super::Evaluation;
use basin::{CostFunction, Executor, Mads};
use nalgebra::DMatrix;
use std::convert::Infallible;

/// The first and the last size of a poll, in standard errors; a poll that succeeds is followed by one of twice the size.
const POLLS: [f64; 2] = [0.25, 1e-4];
/// The most that a standard error is, in sizes of the unknowns: where the data hardly determine a direction.
const MOST: f64 = 1.0;
/// Evaluations for each unknown.
const EVALUATIONS: u64 = 150;
/// The most evaluations of a move along a line, and the part of the move at which it ends.
const MOVES: usize = 30;
const LAST_MOVE: f64 = 1e-3;
/// Steps after which a decomposition is given up, far more than one takes.
const MOST_SWEEPS: usize = 100_000;

/// The cost in polled coordinates.
struct Polled<'a, F> {
    origin: &'a [f64],
    /// A row for each unknown, a column for each coordinate.
    directions: DMatrix<f64>,
    cost: F,
}

impl<F: Fn(&[f64]) -> f64> Polled<'_, F> {
    fn place(&self, at: &[f64]) -> Vec<f64> {
        let moved = |(row, origin): (usize, &f64)| {
            origin + at.iter().enumerate().map(|(column, z)| self.directions[(row, column)] * z).sum::<f64>()
        };
        self.origin.iter().enumerate().map(moved).collect()
    }
}

impl<F: Fn(&[f64]) -> f64> CostFunction for Polled<'_, F> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;
    fn cost(&self, at: &Vec<f64>) -> Result<f64, Infallible> {
        Ok((self.cost)(&self.place(at)))
    }
}

/// Polls about a place for a smaller cost, which sees every place that it evaluates; what it finds is the caller's to
/// keep. `there` are the residuals with their derivatives at the place, each unknown divided by its size, as the place
/// is.
pub(super) fn around(origin: &[f64], there: &Evaluation, most_steps: u64, cost: impl Fn(&[f64]) -> f64) {
    if origin.is_empty() {
        return;
    }
    let method = Mads::new().with_initial_poll_size(POLLS[0]).with_minimum_poll_size(POLLS[1]);
    let polled = Polled { origin, directions: directions(origin.len(), there), cost };
    let start = vec![0.0; origin.len()];
    let run = Executor::from_start(polled, method, start);
    // Nothing in it can fail.
    let _ = run.max_iter(most_steps).max_cost_evals(EVALUATIONS * origin.len() as u64).run();
}

/// Goes on in the direction of a move that has led from one place to another, of this cost: along a kink where both places are on
/// it (the pattern move of Hooke & Jeeves 1961, J. ACM 8, 212–229). Returns nothing for the reason that [`around`] does not.
pub(super) fn onwards(before: &[f64], (after, least): (&[f64], f64), cost: impl Fn(&[f64]) -> f64) {
    let (mut at, mut least, mut part) = (after.to_vec(), least, 1.0_f64);
    for _ in 0..MOVES {
        let moved = |((at, before), after): ((&f64, &f64), &f64)| at + part * (after - before);
        let ahead: Vec<f64> = at.iter().zip(before).zip(after).map(moved).collect();
        let there = cost(&ahead);
        // Twice as far after a success, else half as far to the other side.
        part *= if there < least { 2.0 } else { -0.5 };
        if there < least {
            (at, least) = (ahead, there);
        }
        if part.abs() < LAST_MOVE {
            break;
        }
    }
}

/// A standard error in every direction that the data determine, and no more than a part of the sizes in the others.
fn directions(unknowns: usize, there: &Evaluation) -> DMatrix<f64> {
    let plain = || DMatrix::identity(unknowns, unknowns) * MOST;
    let rows = there.residuals.len();
    if rows == 0 || !there.residuals.iter().chain(&there.slopes).all(|number| number.is_finite()) {
        return plain();
    }
    let squares: f64 = there.residuals.iter().map(|residual| residual * residual).sum();
    let scatter = (squares / rows.saturating_sub(unknowns).max(1) as f64).sqrt();
    let slopes = DMatrix::from_row_slice(rows, unknowns, &there.slopes);
    // As many directions as unknowns, whatever the number of rows.
    let normal = slopes.tr_mul(&slopes);
    if !normal.iter().all(|number| number.is_finite()) {
        return plain();
    }
    let Some(svd) = normal.try_svd(false, true, f64::EPSILON, MOST_SWEEPS) else { return plain() };
    let Some(transposed) = svd.v_t else { return plain() };
    let mut directions = transposed.transpose();
    for (mut column, square) in directions.column_iter_mut().zip(svd.singular_values.iter()) {
        let step = scatter / square.sqrt();
        column *= if step.is_finite() { step.clamp(1e-9, MOST) } else { MOST };
    }
    directions
}
