//! Which formulas hold, as an [evaluation](super::evaluation) needs them.
//!
//! An evaluation puts a plant together; it does not know how the discrete state is kept. In a [`PlantMode`] each law says which
//! of its pieces holds, smoothly continued beyond its ends, as an integrator of high order wants it. Answers are masks, so that
//! numbers side by side may differ in them.

use super::evaluation::{Evaluation, System, Unit};
use super::mode::PlantMode;
use super::wire::Wire;
use crate::air::Chamber;
use crate::friction::Deflections;
use crate::load::{MomentArm, Motion};
use crate::mechanism::Mechanism;
use crate::mechanism::chain::{ChainMotion, Contacts};
use crate::network::formulas::FlowFormulas;
use crate::network::mode::NetworkMode;
use crate::scalar::{Differentiable, Over, Real, Scalar};
use crate::simulation::{LengthRegime, Sliding};

/// The discrete state of a plant as an evaluation needs it.
pub trait Formulas<S: Scalar> {
    /// The network's.
    type Flows: FlowFormulas<S>;

    /// Which formulas hold in the network.
    fn flows(&self) -> &Self::Flows;

    /// Takes the pieces of all laws that hold in a state, where it is the discrete state that knows them.
    fn enter_pieces(&mut self, system: &System<S>, time: S, state: &[S], at: &mut Evaluation<S>);

    /// Whether an actuator is shorter than its shortest, so that it hangs slack.
    fn is_slack(&self, actuator: usize) -> S::Mask;

    /// Whether friction holds the ends of an actuator at their distance.
    fn is_stuck(&self, actuator: usize) -> S::Mask;

    /// Whether friction holds all of a mechanism.
    fn is_frozen(&self, mechanism: usize) -> S::Mask;

    /// Arm in m and excursion in m of a moment arm, the one of a number among all of the plant's, at an angle in rad.
    fn arm<T: Over<S>>(&self, number: usize, arm: &MomentArm<S>, angle: T) -> [T; 2];

    /// Length (m), velocity (m/s) and acceleration (m/s²) of a mechanism whose motion is given.
    fn motion<T: Over<S>>(&self, mechanism: usize, motion: &Motion<S>, time: T) -> [T; 3];

    /// Torques in N·m on a chain besides those of the actuators, less what its motion itself needs.
    fn torques<T: Over<S>>(&self, system: &System<S>, mechanism: usize, motion: ChainMotion<'_, T>, torque: &mut [T]);

    /// How the torques on a chain answer to angles and rates where that is stiff, by two matrices row by row.
    fn stiff_torques(&self, system: &System<S>, mechanism: usize, motion: (&[S], &[S]), answers: (&mut [S], &mut [S]));

    /// The rate in Pa/s of a pressure that is given.
    fn given_rate<T: Over<S>>(&self, system: &System<S>, actuator: usize, time: T) -> T;

    /// Tension in N of an actuator without a tendon, at its length, velocity and pressure; zero where it sticks.
    fn tension<T: Over<S>>(&self, wire: &Wire<S>, ends: [T; 3], deflections: Deflections<T>) -> T;

    /// Rate of the bristles of an actuator in m/s.
    fn bristle_rate<T: Over<S>>(&self, wire: &Wire<S>, deflection: T, velocity: T) -> T;

    /// The sum of the forces of an actuator in N at its length, velocity and pressure, as long as it slides.
    fn signed_force<T: Over<S>>(&self, wire: &Wire<S>, ends: [T; 3], deflections: Deflections<T>) -> T;

    /// The way that an actuator slides: −1, 0 or +1.
    fn direction(&self, actuator: usize) -> S;

    /// Whether the tendon of an actuator hangs loose.
    fn is_loose(&self, actuator: usize) -> S::Mask;

    /// Whether the velocity of an actuator's end on a tendon follows from the balance of both tensions at once.
    fn is_damped(&self, system: &System<S>, actuator: usize) -> S::Mask;

    /// That velocity in m/s where dry friction falls with it, so that it is searched for; none elsewhere.
    fn searched_velocity<T: Differentiable<S>>(
        &self,
        system: &System<S>,
        actuator: usize,
        at: (&Unit<T>, &Chamber<T>),
        deflections: Deflections<T>,
    ) -> Option<T>;

    /// How many independent distances of a chain that moves on do not change, since their actuators stick.
    fn held_count(&self, mechanism: usize) -> usize;

    /// Writes the gradient of one of them, of all gradients, to `row`; where there is one.
    fn enter_held<T: Over<S>>(&self, system: &System<S>, of: (usize, usize), gradients: &[T], row: &mut [T])
    -> S::Mask;

    /// `J̇ q̇` of one of them in m/s².
    fn held_bending<T: Differentiable<S>>(&self, system: &System<S>, of: (usize, usize), state: &[T]) -> T;
}

impl<R: Real> Formulas<R> for PlantMode<R> {
    type Flows = NetworkMode<R>;

    #[inline(always)]
    fn flows(&self) -> &Self::Flows {
        &self.network
    }

    fn enter_pieces(&mut self, system: &System<R>, time: R, state: &[R], at: &mut Evaluation<R>) {
        system.enter_pieces(time, state, self, at);
    }

    #[inline(always)]
    fn is_slack(&self, actuator: usize) -> bool {
        self.actuators[actuator].mode.length_regime == LengthRegime::Slack
    }

    #[inline(always)]
    fn is_stuck(&self, actuator: usize) -> bool {
        self.actuators[actuator].mode.sliding == Sliding::Stuck
    }

    #[inline(always)]
    fn is_frozen(&self, mechanism: usize) -> bool {
        self.mechanisms[mechanism].frozen
    }

    #[inline(always)]
    fn arm<T: Over<R>>(&self, number: usize, arm: &MomentArm<R>, angle: T) -> [T; 2] {
        arm.in_piece(self.arms[number], angle)
    }

    #[inline(never)]
    fn motion<T: Over<R>>(&self, mechanism: usize, motion: &Motion<R>, time: T) -> [T; 3] {
        motion.at(time, self.mechanisms[mechanism].corners_passed)
    }

    fn torques<T: Over<R>>(&self, system: &System<R>, m: usize, motion: ChainMotion<'_, T>, torque: &mut [T]) {
        let its = &self.mechanisms[m];
        if let Mechanism::Chain(chain) = &system.plant.mechanisms[m] {
            chain.torques(motion, &Contacts { stops: &its.stops, foot: its.foot }, torque);
        }
    }

    fn stiff_torques(&self, system: &System<R>, m: usize, (angle, rate): (&[R], &[R]), answers: (&mut [R], &mut [R])) {
        let its = &self.mechanisms[m];
        if let Mechanism::Chain(chain) = &system.plant.mechanisms[m] {
            chain.stiffness(angle, rate, &Contacts { stops: &its.stops, foot: its.foot }, answers);
        }
    }

    #[inline(never)]
    fn given_rate<T: Over<R>>(&self, system: &System<R>, i: usize, time: T) -> T {
        let series = system.plant.actuators[i].pressure.as_ref();
        series.map_or(T::zero(), |series| series.at(time, self.actuators[i].rows_passed)[1])
    }

    #[inline(always)]
    fn tension<T: Over<R>>(&self, wire: &Wire<R>, ends: [T; 3], deflections: Deflections<T>) -> T {
        let its = &self.actuators[wire.index];
        match its.mode.sliding {
            Sliding::Stuck => T::zero(),
            _ => wire.member.tension(ends, &its.mode, (&its.trace, deflections)),
        }
    }

    #[inline(always)]
    fn bristle_rate<T: Over<R>>(&self, wire: &Wire<R>, deflection: T, velocity: T) -> T {
        wire.bristle_rate(deflection, velocity, &self.actuators[wire.index])
    }

    #[inline(always)]
    fn signed_force<T: Over<R>>(&self, wire: &Wire<R>, ends: [T; 3], deflections: Deflections<T>) -> T {
        let its = &self.actuators[wire.index];
        wire.member.signed_force(ends, &its.mode, (&its.trace, deflections))
    }

    #[inline(always)]
    fn direction(&self, actuator: usize) -> R {
        R::constant(self.actuators[actuator].mode.sliding.direction())
    }

    #[inline(always)]
    fn is_loose(&self, actuator: usize) -> bool {
        self.actuators[actuator].loose
    }

    #[inline(always)]
    fn is_damped(&self, system: &System<R>, actuator: usize) -> bool {
        let is_taut = self.actuators[actuator].mode.length_regime == LengthRegime::Taut;
        super::tendon::is_damped(&system.plant.actuators[actuator].actuator, is_taut)
    }

    fn searched_velocity<T: Differentiable<R>>(
        &self,
        system: &System<R>,
        i: usize,
        at: (&Unit<T>, &Chamber<T>),
        deflections: Deflections<T>,
    ) -> Option<T> {
        system.searched_velocity(i, self, at, deflections)
    }

    #[inline(always)]
    fn held_count(&self, mechanism: usize) -> usize {
        self.mechanisms[mechanism].basis.len()
    }

    #[inline(always)]
    fn enter_held<T: Over<R>>(
        &self,
        system: &System<R>,
        (m, place): (usize, usize),
        gradients: &[T],
        row: &mut [T],
    ) -> bool {
        row.copy_from_slice(system.gradient(self.mechanisms[m].basis[place], gradients));
        true
    }

    #[inline(never)]
    fn held_bending<T: Differentiable<R>>(&self, system: &System<R>, (m, place): (usize, usize), state: &[T]) -> T {
        system.bending(self.mechanisms[m].basis[place], state, self)
    }
}
