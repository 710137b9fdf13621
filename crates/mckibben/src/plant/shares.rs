//! How actuators that stick share what they hold together.
//!
//! At rest the tensions of redundant actuators are set-valued: friction lets each take any value between two bounds, and only
//! `J_Sᵀ F = R` is known. Of all tensions that hold, those are reported that lie closest to the middles of their bounds:
//!
//! ```text
//! min Σ (F_i − c̄_i)²/β_i     with  J_Sᵀ F = R,  |F_i − c̄_i| ≤ β_i           c̄ = (ℓ + u)/2,  β = (u − ℓ)/2
//!
//! F_i = c̄_i + β_i ξ_i         ξ_i = clip(J_i z, −1, 1)                       z by  Σ J_iᵀ β_i ξ_i = R − Σ J_iᵀ c̄_i
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | F, ℓ, u | tension, the least and the largest that can be held | N |
//! | J_S | gradients of the distances of the actuators that stick | m per unit of the coordinate |
//! | R | what they hold together: the force on each coordinate | N or N·m |
//!
//! The choice does not depend on the coordinates, is continuous, and gives actuators of equal moment arms the same share ξ of
//! what each can hold. It is the minimum of a convex, piecewise quadratic function of z, found by Newton's method with an
//! exact line search in finitely many steps. Each bound is wider by the band by which the guards of the release are. Where
//! the gradients are independent, `J_Sᵀ F = R` alone decides.
//!
//! No power goes with the choice: what sticks does not move.
//!
//! Source: the complementarity problem of set-valued friction. Checked by `tests/plant_sample.rs`.

use super::dense::{dot, factor, solve};
use super::evaluation::{Evaluation, System};
use super::mode::PlantMode;
use super::sliding::Facet;
use crate::scalar::{Over, Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// Newton steps to the shares: many more than ever taken.
const MOST_STEPS: usize = 100;
/// Steps at the end, at the pieces that were found: each carries the derivatives one order further.
const LAST_STEPS: usize = 3;
/// Part of the curvature of all pieces that is added to that of those between their bounds, lest there be none.
const FLAT: f64 = 1e-9;
/// Part of the terms of a sum below which it is rounding.
const ROUNDING: f64 = 1e-14;

impl<R: Real> System<R> {
    /// Enters the tensions of the actuators of a mechanism that stick, once everything else at an instant is computed.
    pub(crate) fn share_tensions<T: Over<R> + Real>(
        &self,
        m: usize,
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) {
        let of_mechanism = &mode.mechanisms[m];
        if !of_mechanism.frozen && of_mechanism.facets.is_empty() {
            return;
        }
        let places = &self.plant.places;
        let count = places.mechanisms[m].coordinates;
        if of_mechanism.frozen {
            // What moves not at all and holds nothing pulls with its force at rest.
            for &i in &places.members[m] {
                if self.plant.actuators[i].tendon.is_none() {
                    at.units[i].tension = self.unstuck_tension(i, state, mode, at.units[i].length);
                }
            }
        }
        self.enter_force(m, state, mode, at);
        let mut held = at.force[..count].to_vec();
        if !of_mechanism.frozen {
            let mut matrix = vec![T::zero(); count * count];
            self.mass_matrix(m, &at.directions, &mut matrix);
            let first = self.plant.places.mechanisms[m].acceleration;
            for (k, held) in held.iter_mut().enumerate() {
                let row = &matrix[k * count..(k + 1) * count];
                *held = *held - dot(row, &at.acceleration[first..first + count]);
            }
        }
        for (index, facet) in of_mechanism.facets.iter().enumerate() {
            // Facets of a block stand one behind the other.
            if index == 0 || of_mechanism.facets[index - 1].block != facet.block {
                self.share_block(facet, &held, state, mode, at);
            }
        }
    }

    /// Enters the tensions of a block of actuators that hold `held` together.
    fn share_block<T: Over<R> + Real>(
        &self,
        facet: &Facet,
        held: &[T],
        state: &[T],
        mode: &PlantMode<R>,
        at: &mut Evaluation<T>,
    ) {
        let Facet { span, block, .. } = facet;
        let gradient = |i: usize| self.gradient(i, &at.gradient);
        let rows: Vec<T> =
            block.iter().flat_map(|&i| span.iter().map(move |&b| dot(gradient(i), gradient(b)))).collect();
        let mut load: Vec<T> = span.iter().map(|&b| dot(gradient(b), held)).collect();
        let rank = span.len();
        if rank == block.len() && rank > 0 {
            let mut matrix = rows;
            factor(&mut matrix, rank);
            solve(&matrix, rank, &mut load);
            for (&i, tension) in block.iter().zip(load) {
                at.units[i].tension = tension;
            }
            return;
        }
        let half = T::constant(0.5);
        let bounds: Vec<[T; 2]> = block
            .iter()
            .map(|&i| {
                let (least, most) = self.holdable(i, state, mode, at.units[i].length);
                [half * (least + most), half * (most - least) + T::constant(self.wires[i].member.force_band)]
            })
            .collect();
        for (a, [middle, _]) in bounds.iter().enumerate() {
            for (b, load) in load.iter_mut().enumerate() {
                *load = *load - rows[a * rank + b] * *middle;
            }
        }
        let widths: Vec<T> = bounds.iter().map(|[_, width]| *width).collect();
        let shares = shares(&rows, &widths, &load);
        for ((&i, [middle, width]), share) in block.iter().zip(bounds).zip(shares) {
            at.units[i].tension = (middle + width * share).larger(T::zero());
        }
    }
}

/// The shares ξ of what each actuator can hold: `rows` are its gradients over a basis, `widths` β, `load` what is left over
/// the middles, over the same basis. What lies beyond the bounds of all is held up to them.
fn shares<R: Real>(rows: &[R], widths: &[R], load: &[R]) -> Vec<R> {
    let values = |numbers: &[R]| numbers.iter().map(|number| number.value()).collect::<Vec<f64>>();
    let weights = weights(&values(rows), &values(widths), &values(load));
    let rank = load.len();
    let row = |a: usize| &rows[a * rank..(a + 1) * rank];
    // The pieces stay: what lies between its bounds, and at which bound the others do.
    let sides: Vec<f64> = (0..widths.len())
        .map(|a| dot(&values(row(a)), &weights).clamp(-1.0, 1.0))
        .map(|share| if Scalar::magnitude(share) < 1.0 { 0.0 } else { share })
        .collect();
    let mut weights: Vec<R> = weights.into_iter().map(R::constant).collect();
    for _ in 0..LAST_STEPS {
        let mut left = load.to_vec();
        let mut matrix = vec![R::zero(); rank * rank];
        for (a, (width, side)) in widths.iter().zip(&sides).enumerate() {
            let between = *side == 0.0;
            let share = if between { dot(row(a), &weights) } else { R::constant(*side) };
            add(&mut matrix, row(a), *width * R::constant(if between { 1.0 } else { FLAT }));
            for (left, entry) in left.iter_mut().zip(row(a)) {
                *left = *left - *entry * *width * share;
            }
        }
        factor(&mut matrix, rank);
        solve(&matrix, rank, &mut left);
        for (weight, step) in weights.iter_mut().zip(left) {
            *weight = *weight + step;
        }
    }
    let one = R::one();
    let share = |(a, side): (usize, &f64)| match *side {
        0.0 => dot(row(a), &weights).smaller(one).larger(-one),
        side => R::constant(side),
    };
    sides.iter().enumerate().map(share).collect()
}

/// The weights w of the basis in `z = Σ w_b J_b`, by values.
fn weights(rows: &[f64], widths: &[f64], load: &[f64]) -> Vec<f64> {
    let rank = load.len();
    let row = |a: usize| &rows[a * rank..(a + 1) * rank];
    let mut weights = vec![0.0; rank];
    for _ in 0..MOST_STEPS {
        let mut left = load.to_vec();
        let mut size: Vec<f64> = load.iter().map(|load| load.abs()).collect();
        let mut matrix = vec![0.0; rank * rank];
        for (a, width) in widths.iter().enumerate() {
            let share = dot(row(a), &weights);
            add(&mut matrix, row(a), width * if share.abs() < 1.0 { 1.0 } else { FLAT });
            for (b, entry) in row(a).iter().enumerate() {
                let force = entry * width * share.clamp(-1.0, 1.0);
                left[b] -= force;
                size[b] += force.abs();
            }
        }
        if left.iter().zip(&size).all(|(left, size)| left.abs() <= ROUNDING * size) {
            break;
        }
        factor(&mut matrix, rank);
        let mut step = left.clone();
        solve(&matrix, rank, &mut step);
        let Some(length) = step_length(rows, widths, &weights, &step, dot(&left, &step)) else { break };
        for (weight, step) in weights.iter_mut().zip(&step) {
            *weight += length * step;
        }
    }
    weights
}

/// How far along a step the function is least that falls by `fall` at its beginning; none where it does not fall. Its slope
/// grows along straight lines between the places at which a share comes to or leaves its bound.
fn step_length(rows: &[f64], widths: &[f64], weights: &[f64], step: &[f64], mut fall: f64) -> Option<f64> {
    if fall.is_nan() || fall <= 0.0 {
        return None;
    }
    let rank = weights.len();
    let mut bends = Vec::new();
    let mut curvature = 0.0;
    for (a, width) in widths.iter().enumerate() {
        let row = &rows[a * rank..(a + 1) * rank];
        let (share, rate) = (dot(row, weights), dot(row, step));
        if rate == 0.0 {
            continue;
        }
        // Between −1 and 1 the slope grows.
        let [enters, leaves] = [(-rate.signum() - share) / rate, (rate.signum() - share) / rate];
        let growth = width * rate * rate;
        if enters > 0.0 {
            bends.push((enters, growth));
        } else if leaves > 0.0 {
            curvature += growth;
        }
        if leaves > 0.0 {
            bends.push((leaves, -growth));
        }
    }
    bends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut reached = 0.0;
    for (at, growth) in bends {
        let falls_by = curvature * (at - reached);
        if falls_by >= fall {
            break;
        }
        fall -= falls_by;
        (reached, curvature) = (at, curvature + growth);
    }
    let rest = if curvature > 0.0 { fall / curvature } else { 0.0 };
    (rest.is_finite() && reached + rest > 0.0).then_some(reached + rest)
}

/// Adds the product of a row with itself.
fn add<T: Scalar>(matrix: &mut [T], row: &[T], weight: T) {
    let count = row.len();
    for i in 0..count {
        for j in 0..count {
            matrix[i * count + j] = matrix[i * count + j] + weight * row[i] * row[j];
        }
    }
}
