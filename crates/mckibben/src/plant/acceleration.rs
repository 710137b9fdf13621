//! Forces on the coordinates of the mechanisms of a plant, their accelerations, and what they add to the rates of its states.
//!
//! ```text
//! M q̈ = τ − h − Σ Jᵀ F      (16), with what friction holds at rest
//! ```
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.1, for a mass; virtual work for joints. Checked by `tests/joint.rs`
//! and, against an independent program, `tests/plant_reference.rs`.

use super::evaluation::{Evaluation, System};
use super::formulas::Formulas;
use super::wire::Assembly;
use crate::mechanism::Mechanism;
use crate::mechanism::chain::{Chain, ChainMotion};
use crate::scalar::{Differentiable, Mask, Over, Scalar};

impl<R: Scalar> System<R> {
    /// Computes the accelerations of a mechanism.
    #[inline(always)]
    pub(super) fn accelerate<T: Differentiable<R>>(
        &self,
        assembly: &Assembly<R>,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        match &assembly.mechanism {
            Mechanism::Mass(mass) => {
                let mut force = mass.force(state[assembly.places.first]);
                for &i in &assembly.members {
                    force = force - at.units[i].tension;
                }
                let acceleration = force * T::of(mass.per_mass());
                at.acceleration[assembly.places.acceleration] =
                    T::select(mode.is_frozen(assembly.index), T::zero(), acceleration);
            }
            _ => self.accelerate_other(assembly, time, state, mode, at),
        }
    }

    /// Computes the accelerations of a mechanism that is no mass.
    #[inline(always)]
    fn accelerate_other<T: Differentiable<R>>(
        &self,
        &Assembly { index, ref mechanism, places, .. }: &Assembly<R>,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        let its = places.accelerations();
        let frozen = mode.is_frozen(index);
        if !(!frozen).any() {
            at.acceleration[its].fill(T::zero());
            return;
        }
        match mechanism {
            Mechanism::Chain(chain) => {
                self.accelerate_chain(index, chain, state, mode, at);
                for acceleration in &mut at.acceleration[its] {
                    *acceleration = T::select(frozen, T::zero(), *acceleration);
                }
            }
            Mechanism::Prescribed(motion) => at.acceleration[its.start] = mode.motion(index, motion, time)[2],
            Mechanism::Mass(_) | Mechanism::Fixed | Mechanism::External { .. } => at.acceleration[its].fill(T::zero()),
        }
    }

    /// Computes the accelerations of a chain.
    #[inline(always)]
    fn accelerate_chain<T: Differentiable<R>>(
        &self,
        m: usize,
        chain: &Chain<R>,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        let (places, first) = (&self.plant.places.mechanisms[m], self.plant.places.mechanisms[m].acceleration);
        let count = places.coordinates;
        self.enter_force(m, state, mode, at);
        let matrix = &mut at.matrix[..count * count];
        chain.mass_matrix(&at.directions[places.accelerations()], matrix);
        if let [inertia] = matrix {
            at.acceleration[first] = at.force[0] / *inertia;
            return;
        }
        super::dense::factor(matrix, count);
        let acceleration = &mut at.acceleration[first..first + count];
        acceleration.copy_from_slice(&at.force[..count]);
        super::dense::solve(&at.matrix[..count * count], count, acceleration);
        self.hold(m, state, mode, at);
    }

    /// Generalised forces on a mechanism, of all but sticking actuators without a tendon: `τ − h − Σ Jᵀ F`.
    #[inline(always)]
    pub(crate) fn enter_force<T: Over<R>>(
        &self,
        m: usize,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        let places = &self.plant.places;
        let (position, rates) = places.mechanisms[m].of(state);
        let force = &mut at.force[..position.len()];
        match &self.plant.mechanisms[m] {
            Mechanism::Mass(mass) => force[0] = mass.force(position[0]),
            Mechanism::Chain(_) => {
                let directions = &at.directions[places.mechanisms[m].accelerations()];
                mode.torques(self, m, ChainMotion { directions, angle: position, rate: rates }, force);
            }
            Mechanism::Prescribed(_) | Mechanism::Fixed | Mechanism::External { .. } => force.fill(T::zero()),
        }
        for &i in &places.members[m] {
            let gradient = self.gradient(i, &at.gradient);
            for (force, entry) in force.iter_mut().zip(gradient) {
                *force = *force - *entry * at.units[i].tension;
            }
        }
    }

    /// Writes the rates of a mechanism's states, whose accelerations are known.
    #[inline(always)]
    pub(super) fn enter_motion<T: Differentiable<R>>(
        &self,
        assembly: &Assembly<R>,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        acceleration: &[T],
        rates: &mut [T],
    ) {
        let places = assembly.places;
        let (from, frozen) = (places.first, mode.is_frozen(assembly.index));
        match &assembly.mechanism {
            Mechanism::Mass(_) => {
                rates[from] = T::select(frozen, T::zero(), state[from + 1]);
                rates[from + 1] = acceleration[places.acceleration];
            }
            Mechanism::Fixed => (rates[from], rates[from + 1]) = (T::zero(), T::zero()),
            Mechanism::Prescribed(motion) => {
                let [_, velocity, acceleration] = mode.motion(assembly.index, motion, time);
                (rates[from], rates[from + 1]) = (velocity, acceleration);
            }
            Mechanism::Chain(_) | Mechanism::External { .. } => {
                for k in 0..places.coordinates {
                    rates[places.position(k)] = T::select(frozen, T::zero(), state[places.rate(k)]);
                    rates[places.rate(k)] = acceleration[places.acceleration + k];
                }
            }
        }
    }
}
