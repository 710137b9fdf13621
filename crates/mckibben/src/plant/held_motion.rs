//! What sticking actuators take from the motion of a chain that moves on: accelerations along their distances, and rates.
//!
//! ```text
//! q̈ = q̈₀ − M⁻¹ Jᵀ λ        λ = W⁻¹ (J q̈₀ + J̇ q̇)        W = J M⁻¹ Jᵀ
//! q̇ = q̇₀ − M⁻¹ Jᵀ μ        μ = W⁻¹ J q̇₀                the least change in kinetic energy
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | q, M | coordinates of the chain and its mass matrix | rad, kg·m² |
//! | J | gradients of the distances that do not change, of those that are independent | m/rad |
//! | λ, μ | tensions and impulses that hold them | N, N·s |
//!
//! Which actuators stick is the discrete state's to say, by a list of rows of J. Of plants side by side each has its own list;
//! rows beyond its end are zero and hold nothing.
//!
//! Source: Gauss's principle of least constraint. Checked by `tests/plant_reference.rs`.

use super::Plant;
use super::dense::{dot, factor, solve};
use super::distances::ArmsOf;
use super::evaluation::{Evaluation, System};
use super::formulas::Formulas;
use crate::mechanism::Mechanism;
use crate::mechanism::chain::MAX_JOINTS;
use crate::scalar::{Differentiable, Mask, Over, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// The rows of what sticks, and the system for what holds them.
#[derive(Clone, Debug)]
pub(crate) struct Holding<T: Scalar> {
    /// J and M⁻¹ Jᵀ, row by row.
    rows: Vec<T>,
    moves: Vec<T>,
    /// W, factored.
    weights: Vec<T>,
    /// λ or μ.
    pulls: Vec<T>,
    /// Where there is a row.
    used: Vec<T::Mask>,
}

impl<T: Scalar> Holding<T> {
    /// Room for a mechanism of so many coordinates.
    pub(super) fn new(coordinates: usize) -> Self {
        let zeros = vec![T::zero(); coordinates * coordinates];
        Self {
            rows: zeros.clone(),
            moves: zeros.clone(),
            weights: zeros,
            pulls: vec![T::zero(); coordinates],
            used: vec![T::Mask::splat(false); coordinates],
        }
    }

    /// Enters so many rows, of a chain with a factored mass matrix.
    #[inline(always)]
    fn enter<R: Scalar>(
        &mut self,
        (system, m, held): (&System<R>, usize, usize),
        mode: &impl Formulas<R>,
        (factors, gradient): (&[T], &[T]),
    ) where
        T: Over<R>,
    {
        let count = system.plant.places.mechanisms[m].coordinates;
        for a in 0..held {
            let its = a * count..(a + 1) * count;
            self.used[a] = mode.enter_held(system, (m, a), gradient, &mut self.rows[its.clone()]);
            self.moves[its.clone()].copy_from_slice(&self.rows[its.clone()]);
            solve(&factors[..count * count], count, &mut self.moves[its]);
        }
        for a in 0..held {
            for b in 0..held {
                let (row, moved) = (&self.rows[a * count..(a + 1) * count], &self.moves[b * count..(b + 1) * count]);
                self.weights[a * held + b] = dot(row, moved);
            }
            self.weights[a * held + a] = T::select(self.used[a], self.weights[a * held + a], T::one());
        }
        factor(&mut self.weights[..held * held], held);
    }

    /// Takes from a vector over the coordinates what the rows hold, whose right side is in `pulls`.
    #[inline(always)]
    fn take_from(&mut self, vector: &mut [T], held: usize) {
        solve(&self.weights[..held * held], held, &mut self.pulls[..held]);
        let count = vector.len();
        for b in 0..held {
            for k in 0..count {
                let left = vector[k] - self.moves[b * count + k] * self.pulls[b];
                vector[k] = T::select(self.used[b], left, vector[k]);
            }
        }
    }
}

impl<R: Scalar> System<R> {
    /// Takes from the accelerations of a chain what sticking actuators hold; its mass matrix is factored.
    #[inline(always)]
    pub(super) fn hold<T: Differentiable<R>>(
        &self,
        m: usize,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        let (here, held) = (self.plant.places.mechanisms[m], mode.held_count(m));
        if held == 0 {
            return;
        }
        let Evaluation { gradient, acceleration, matrix, holding, .. } = at;
        let acceleration = &mut acceleration[here.acceleration..here.acceleration + here.coordinates];
        holding.enter((self, m, held), mode, (matrix, gradient));
        for a in 0..held {
            let row = &holding.rows[a * here.coordinates..(a + 1) * here.coordinates];
            holding.pulls[a] = dot(row, acceleration) + mode.held_bending(self, (m, a), state);
        }
        holding.take_from(acceleration, held);
    }

    /// Brings the rates of a chain to where its sticking actuators are at rest, by the least change in kinetic energy. Distances
    /// have been entered.
    #[inline(always)]
    pub fn hold_rates(&self, m: usize, state: &mut [R], mode: &impl Formulas<R>, at: &mut Evaluation<R>) {
        let (here, held) = (self.plant.places.mechanisms[m], mode.held_count(m));
        if held == 0 {
            return;
        }
        let count = here.coordinates;
        let Evaluation { gradient, directions, matrix, holding, .. } = at;
        self.mass_matrix(m, directions, &mut matrix[..count * count]);
        factor(&mut matrix[..count * count], count);
        holding.enter((self, m, held), mode, (matrix, gradient));
        let rates = &mut state[here.rate(0)..here.rate(0) + count];
        for a in 0..held {
            holding.pulls[a] = dot(&holding.rows[a * count..(a + 1) * count], rates);
        }
        holding.take_from(rates, held);
    }

    /// Enters as forces what sticking actuators hold of a mechanism that has been computed: `τ − h − Σ Jᵀ F − M q̈`, with the
    /// tensions of all others.
    #[inline(always)]
    pub fn enter_load<T: Over<R>>(&self, m: usize, state: &[T], mode: &impl Formulas<R>, at: &mut Evaluation<T>) {
        let here = self.plant.places.mechanisms[m];
        let count = here.coordinates;
        self.enter_force(m, state, mode, at);
        let Evaluation { force, directions, matrix, acceleration, .. } = at;
        self.mass_matrix(m, directions, &mut matrix[..count * count]);
        let acceleration = &acceleration[here.acceleration..here.acceleration + count];
        for k in 0..count {
            force[k] = force[k] - dot(&matrix[k * count..(k + 1) * count], acceleration);
        }
    }

    /// `J̇ q̇` of an actuator in m/s²: what its distance accelerates by at constant rates.
    #[inline(always)]
    pub fn bending<T: Differentiable<R>>(&self, i: usize, state: &[T], mode: &impl Formulas<R>) -> T {
        let Plant { actuators, mechanisms, places, .. } = &*self.plant;
        let (m, coupling) = (actuators[i].mechanism, &actuators[i].coupling);
        let Mechanism::Chain(chain) = &mechanisms[m] else { return T::zero() };
        if coupling.is_linear() {
            return T::zero();
        }
        let (position, rates) = places.mechanisms[m].of(state);
        let still = T::zero().along(T::zero());
        let (mut along, mut gradient) = ([still; MAX_JOINTS], [still; MAX_JOINTS]);
        for k in 0..position.len() {
            along[k] = position[k].along(rates[k]);
        }
        let pieces = ArmsOf { mode, first: places.actuators[i].arms };
        let (along, mut directions) = (&along[..position.len()], [[still; 2]; MAX_JOINTS]);
        chain.enter_directions(along, &mut directions);
        let _ = coupling.distance(Some(chain), (along, &directions), pieces, &mut gradient[..position.len()]);
        let mut sum = T::zero();
        for (entry, rate) in gradient.iter().zip(rates) {
            sum = sum + T::split(*entry)[1] * *rate;
        }
        sum
    }
}
