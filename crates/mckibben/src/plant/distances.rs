//! How far apart the ends of the actuators of a plant are, how fast they part, and with them lengths and chambers.
//!
//! ```text
//! of a coordinate itself      x = q                 ẋ = q̇
//! of a motion that is given   x = x(t)              ẋ = dx/dt
//! across joints               x(q), J = ∂x/∂q       ẋ = J q̇
//! on a tendon                 the length is a state of the actuator; without one it is x
//! ```
//!
//! Source: virtual work, [`Coupling`]. Checked by `tests/joint.rs` and `tests/chain.rs`.

use super::Plant;
use super::evaluation::{Evaluation, System, Unit};
use super::formulas::Formulas;
use super::wire::{Span, Wire};
use crate::load::MomentArm;
use crate::mechanism::coupling::ArmPieces;
use crate::mechanism::{Coupling, Mechanism};
use crate::scalar::{Over, Scalar};

/// The moment arms of an actuator as a discrete state knows them.
pub(super) struct ArmsOf<'m, F> {
    pub(super) mode: &'m F,
    /// The first of them among those of all actuators.
    pub(super) first: usize,
}

impl<S: Scalar, F: Formulas<S>> ArmPieces<S> for ArmsOf<'_, F> {
    #[inline(always)]
    fn arm<T: Over<S>>(&self, number: usize, arm: &MomentArm<S>, angle: T) -> [T; 2] {
        self.mode.arm(self.first + number, arm, angle)
    }
}

impl<R: Scalar> System<R> {
    /// Computes distances and chambers.
    #[inline(always)]
    pub(super) fn compute_distances<T: Over<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        let Evaluation { units, chambers, gradient, directions, .. } = at;
        for m in 0..self.assemblies.len() {
            self.enter_directions(m, state, directions);
        }
        for (i, wire) in self.wires.iter().enumerate() {
            let into = (&mut units[i], &mut gradient[..]);
            let [length, velocity] = self.enter_ends(wire, time, (state, directions), mode, into);
            let [pressure, mass] = wire.air(state);
            chambers[i] = wire.member.actuator.chamber(length, velocity, pressure, mass, mode.is_slack(i));
        }
    }

    /// Computes distance, length and their rates of an actuator.
    #[inline(always)]
    pub fn enter_ends_of<T: Over<R>>(
        &self,
        i: usize,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        if let Coupling::Points(_) = self.plant.actuators[i].coupling {
            self.enter_directions(self.wires[i].mechanism, state, &mut at.directions);
        }
        let into = (&mut at.units[i], &mut at.gradient[..]);
        self.enter_ends(&self.wires[i], time, (state, &at.directions), mode, into);
    }

    /// Computes distances, lengths and their rates of the actuators on a mechanism.
    #[inline(always)]
    pub(super) fn enter_ends_on<T: Over<R>>(
        &self,
        m: usize,
        time: T,
        state: &[T],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<T>,
    ) {
        self.enter_directions(m, state, &mut at.directions);
        for &i in &self.assemblies[m].members {
            let into = (&mut at.units[i], &mut at.gradient[..]);
            self.enter_ends(&self.wires[i], time, (state, &at.directions), mode, into);
        }
    }

    /// Enters the directions of the segments of a mechanism that is a chain.
    #[inline(always)]
    pub(super) fn enter_directions<T: Over<R>>(&self, m: usize, state: &[T], directions: &mut [[T; 2]]) {
        let assembly = &self.assemblies[m];
        if let Mechanism::Chain(chain) = &assembly.mechanism {
            let (angle, _) = assembly.places.of(state);
            chain.enter_directions(angle, &mut directions[assembly.places.accelerations()]);
        }
    }

    /// Writes distance, length and their rates of an actuator; returns the last two.
    #[inline(always)]
    fn enter_ends<T: Over<R>>(
        &self,
        wire: &Wire<R>,
        time: T,
        (state, directions): (&[T], &[[T; 2]]),
        mode: &impl Formulas<R>,
        (unit, gradient): (&mut Unit<T>, &mut [T]),
    ) -> [T; 2] {
        let [distance, rate] = match wire.span {
            Span::Direct { position, rate } => {
                [state[position], T::select(mode.is_frozen(wire.mechanism), T::zero(), state[rate])]
            }
            Span::Fixed { position } => [state[position], T::zero()],
            Span::Prescribed => match &self.plant.mechanisms[wire.mechanism] {
                Mechanism::Prescribed(motion) => {
                    let [length, velocity, _] = mode.motion(wire.mechanism, motion, time);
                    [length, velocity]
                }
                _ => [T::zero(); 2],
            },
            Span::Coupled => self.span(wire.index, (state, directions), mode, gradient),
        };
        let (length, velocity) = match wire.places.length {
            Some(place) => (state[place], T::zero()),
            None => (distance, T::select(mode.is_stuck(wire.index), T::zero(), rate)),
        };
        (unit.distance, unit.rate, unit.length, unit.velocity) = (distance, rate, length, velocity);
        [length, velocity]
    }

    /// Distance and its rate of an actuator that spans joints; its gradient is written.
    #[inline(always)]
    fn span<T: Over<R>>(
        &self,
        i: usize,
        (state, directions): (&[T], &[[T; 2]]),
        mode: &impl Formulas<R>,
        gradients: &mut [T],
    ) -> [T; 2] {
        let Plant { actuators, mechanisms, places, .. } = &*self.plant;
        let (mounted, here) = (&actuators[i], &places.actuators[i]);
        let its = places.mechanisms[mounted.mechanism];
        let (position, rates) = its.of(state);
        let chain = match &mechanisms[mounted.mechanism] {
            Mechanism::Chain(chain) => Some(chain),
            _ => None,
        };
        let gradient = &mut gradients[here.gradient..here.gradient + position.len()];
        let pieces = ArmsOf { mode, first: here.arms };
        let at = (position, &directions[its.accelerations()]);
        let distance = mounted.coupling.distance(chain, at, pieces, gradient);
        let rate = super::dense::dot(gradient, rates);
        [distance, T::select(mode.is_frozen(mounted.mechanism), T::zero(), rate)]
    }
}
