//! What dry friction of several actuators holds together: a box problem, solved exactly.
//!
//! ```text
//! q̈ = argmin ½ (a − a₀)ᵀ M (a − a₀) + Σ_i σ_i(J_i a + γ_i)        σ_i(s) = max(u_i s, ℓ_i s)
//!
//! dual:  min ½ Fᵀ W F − cᵀ F,   ℓ ≤ F ≤ u        W = J M⁻¹ Jᵀ,   c = J a₀ + γ,   r = c − W F = L̈
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | M, J | inertia over the coordinates, gradients of the distances | kg or kg·m², m per unit |
//! | a₀ | accelerations of the coordinates without tensions at rest | m/s² or rad/s² |
//! | γ | `J̇ q̇`, or the acceleration of a given motion | m/s² |
//! | F, ℓ, u | tension, the least and the largest that can be held | N |
//! | r | acceleration L̈ of the distance | m/s² |
//!
//! An actuator at rest can hold any tension from ℓ to u. Its distance accelerates by `r`: it stays at rest where `r` is zero,
//! lengthens where `r > 0` (then `F = u`), shortens where `r < 0` (then `F = ℓ`). Accelerations are unique; tensions are up
//! to what gives no force on the mechanism.
//!
//! An active set is built up from one violated bound after the other: exact after finitely many pivots, the same in every
//! run, without a tolerance but that of rounding.
//!
//! Source: the complementarity problem of set-valued friction at rest; J. J. Moreau, "Unilateral contact and dry
//! friction in finite freedom dynamics" (1988), for the variational form.
//! Checked below by the conditions of a solution, and by `tests/plant_reference.rs`.

use alloc::vec;
use alloc::vec::Vec;

/// Pivots after which the problem is taken for unsolvable: a hundred times what has been seen.
const MOST_PIVOTS: usize = 4000;
/// Pivots after which the violated bound of the lowest index is taken, and not the worst.
const GREEDY: usize = 200;
/// Part of the terms of a sum below which it is rounding.
const ROUNDING: f64 = 1e-13;

/// Where a tension lies in its box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Least,
    Between,
    Most,
}

/// Tensions at rest, and the accelerations that they leave.
#[derive(Clone, Debug)]
pub(crate) struct Resting {
    pub(crate) tension: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

/// Solves the box problem: `weights` is W row by row, `pull` is c, `least` and `most` are the bounds. `None` if no solution
/// was found.
pub(crate) fn solve(weights: &[f64], pull: &[f64], least: &[f64], most: &[f64]) -> Option<Resting> {
    let count = pull.len();
    let mut tension: Vec<f64> = (0..count).map(|j| if pull[j] > 0.0 { most[j] } else { least[j] }).collect();
    let mut bound: Vec<Side> = (0..count).map(|j| if pull[j] > 0.0 { Side::Most } else { Side::Least }).collect();
    let row = |j: usize| &weights[j * count..(j + 1) * count];
    let left = |tension: &[f64], j: usize| {
        let terms = row(j).iter().zip(tension).map(|(w, f)| w * f);
        let size = terms.clone().fold(pull[j].abs(), |sum, term| sum + term.abs());
        let rest = pull[j] - terms.sum::<f64>();
        if rest.abs() <= ROUNDING * size { 0.0 } else { rest }
    };
    for pivot in 0..MOST_PIVOTS {
        let violation = |j: usize| match (bound[j], left(&tension, j)) {
            (Side::Most, rest) if rest < 0.0 && most[j] > least[j] => rest * rest / weights[j * count + j],
            (Side::Least, rest) if rest > 0.0 && most[j] > least[j] => rest * rest / weights[j * count + j],
            _ => 0.0,
        };
        let mut worst = None;
        for j in 0..count {
            let size = violation(j);
            if size > worst.map_or(0.0, |(_, size)| size) {
                worst = Some((j, size));
                if pivot > GREEDY {
                    break;
                }
            }
        }
        let Some((j, _)) = worst else {
            let acceleration =
                (0..count).map(|j| if bound[j] == Side::Between { 0.0 } else { left(&tension, j) }).collect();
            return Some(Resting { tension, acceleration });
        };
        enter(weights, (least, most), j, left(&tension, j), &mut tension, &mut bound);
        // What lies between is computed again, so that rounding does not add up.
        let free: Vec<usize> = (0..count).filter(|&k| bound[k] == Side::Between).collect();
        let fixed = |k: usize| {
            let others = (0..count).filter(|&l| bound[l] != Side::Between);
            pull[k] - others.map(|l| weights[k * count + l] * tension[l]).sum::<f64>()
        };
        let right: Vec<f64> = free.iter().map(|&k| fixed(k)).collect();
        if let Some(solved) = solve_free(weights, count, &free, right) {
            for (&k, value) in free.iter().zip(solved) {
                tension[k] = value.clamp(least[k], most[k]);
            }
        }
    }
    None
}

/// Moves the tension of `j` off its bound until its acceleration is zero or a bound is met, by as many steps as it takes.
fn enter(
    weights: &[f64],
    (least, most): (&[f64], &[f64]),
    j: usize,
    mut rest: f64,
    tension: &mut [f64],
    bound: &mut [Side],
) {
    let count = tension.len();
    let sign = rest.signum();
    for _ in 0..=count {
        let free: Vec<usize> = (0..count).filter(|&k| bound[k] == Side::Between).collect();
        let right: Vec<f64> = free.iter().map(|&k| -sign * weights[k * count + j]).collect();
        let moves = solve_free(weights, count, &free, right).unwrap_or_else(|| vec![0.0; free.len()]);
        let own = weights[j * count + j];
        let curvature = free.iter().zip(&moves).fold(own, |sum, (&k, by)| sum + sign * weights[j * count + k] * by);
        let wanted = if curvature > ROUNDING * own { rest.abs() / curvature } else { f64::INFINITY };
        let room = |k: usize, by: f64| {
            if by > 0.0 {
                (most[k] - tension[k]) / by
            } else if by < 0.0 {
                (least[k] - tension[k]) / by
            } else {
                f64::INFINITY
            }
        };
        let (mut allowed, mut blocked) = (room(j, sign), j);
        for (&k, by) in free.iter().zip(&moves) {
            let room = room(k, *by).max(0.0);
            if room < allowed {
                (allowed, blocked) = (room, k);
            }
        }
        let step = wanted.min(allowed);
        tension[j] += sign * step;
        for (&k, by) in free.iter().zip(&moves) {
            tension[k] += by * step;
        }
        rest -= sign * curvature * step;
        if wanted <= allowed {
            bound[j] = Side::Between;
            return;
        }
        let at_most = if blocked == j {
            sign > 0.0
        } else {
            tension[blocked] - least[blocked] > most[blocked] - tension[blocked]
        };
        (tension[blocked], bound[blocked]) =
            if at_most { (most[blocked], Side::Most) } else { (least[blocked], Side::Least) };
        if blocked == j {
            return;
        }
    }
}

/// Solves `W_ff x = right` over the free actuators; `None` when the matrix is singular.
fn solve_free(weights: &[f64], count: usize, free: &[usize], mut right: Vec<f64>) -> Option<Vec<f64>> {
    let size = free.len();
    let mut matrix: Vec<f64> = free.iter().flat_map(|&a| free.iter().map(move |&b| weights[a * count + b])).collect();
    super::dense::factor(&mut matrix, size);
    let is_regular = super::dense::pivots_exceed(&matrix, size, |k| ROUNDING * weights[free[k] * count + free[k]]);
    super::dense::solve(&matrix, size, &mut right);
    (is_regular && right.iter().all(|value| value.is_finite())).then_some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random numbers between −1 and 1 that are the same in every run.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// The conditions of a solution, for up to eight actuators on up to three coordinates, redundant ones included.
    #[test]
    fn a_solution_meets_its_conditions() {
        for seed in 1..4000 {
            let mut number = numbers(seed);
            let coordinates = 1 + seed as usize % 3;
            let count = 1 + seed as usize % 8;
            let rows: Vec<Vec<f64>> = (0..count)
                .map(|_| (0..coordinates).map(|_| if seed % 5 == 0 { number().round() } else { number() }).collect())
                .collect();
            let mut weights = vec![0.0; count * count];
            for a in 0..count {
                for b in 0..count {
                    weights[a * count + b] = (0..coordinates).map(|k| rows[a][k] * rows[b][k]).sum::<f64>();
                }
                weights[a * count + a] += if rows[a].iter().all(|entry| *entry == 0.0) { 1.0 } else { 0.0 };
            }
            let free: Vec<f64> = (0..coordinates).map(|_| 5.0 * number()).collect();
            let pull: Vec<f64> =
                (0..count).map(|a| (0..coordinates).map(|k| rows[a][k] * free[k]).sum::<f64>()).collect();
            let least: Vec<f64> = (0..count).map(|_| number().abs()).collect();
            let most: Vec<f64> = least.iter().map(|least| least + 2.0 * number().abs()).collect();
            let held = solve(&weights, &pull, &least, &most).unwrap_or_else(|| panic!("seed {seed}"));
            let scale = 1.0 + pull.iter().fold(0.0, |sum: f64, p| sum + p.abs());
            for j in 0..count {
                let taken: f64 = (0..count).map(|k| weights[j * count + k] * held.tension[k]).sum();
                let rest = pull[j] - taken;
                assert!((rest - held.acceleration[j]).abs() < 1e-11 * scale, "seed {seed}: {rest} is left of {j}");
                assert!(least[j] <= held.tension[j] && held.tension[j] <= most[j], "seed {seed}");
                assert!(rest < 1e-11 * scale || held.tension[j] == most[j], "seed {seed}: {j} could hold more");
                assert!(rest > -1e-11 * scale || held.tension[j] == least[j], "seed {seed}: {j} could hold less");
            }
        }
    }
}
