//! How the joint turns: whether it sticks, and which way it goes when it does not.
//!
//! Sliding is decided once for the joint: at rest each actuator can hold any tension from its least to its largest, and so
//! the two together any torque from `r₁ F₁,least − r₂ F₂,most` to `r₁ F₁,most − r₂ F₂,least`. The joint sticks while the
//! rest of the torque is balanced by one between; with free tendons that is within `r₁ Q₁ k₁ + r₂ Q₂ k₂` of the balance
//! without friction. Stuck, both use the same share of what they can hold: the tensions themselves are indeterminate.

use super::mode::{JointMode, Turning};
use super::system::{ANGLE, JointSystem, Traces, VELOCITY};
use crate::load::SIGN;
use crate::scalar::{Over, Real};
use crate::simulation::mode::Extent;

impl<R: Real> JointSystem<'_, R> {
    /// Tensions in N of both actuators while the joint sticks: of what each can hold, the share that balances the joint.
    pub(super) fn shared_tensions<const N: usize>(
        &self,
        state: &[R; N],
        mode: &JointMode,
        traces: &Traces<R>,
    ) -> [R; 2] {
        let held = [0, 1].map(|i| self.holdable(i, state, mode, traces));
        let (least, most) = self.torques_at_rest(state, mode, traces);
        let width = most - least;
        let share = if width.value() > 0.0 { -least / width } else { R::constant(0.5) };
        let share = share.larger(R::zero()).smaller(R::one());
        let [(least, most), (other_least, other_most)] = held;
        [least + share * (most - least), other_most - share * (other_most - other_least)]
    }

    /// The least and the largest tension in N that an actuator can hold at rest.
    fn holdable<T: Over<R>, const N: usize>(
        &self,
        i: usize,
        state: &[T; N],
        mode: &JointMode,
        traces: &Traces<R>,
    ) -> (T, T) {
        if mode.actuators[i].extent == Extent::Slack {
            return (T::zero(), T::zero());
        }
        let [length, _, pressure] = self.ends(i, state, mode.arm_pieces);
        let above = T::constant(SIGN[i]) * (state[ANGLE] - T::of(self.limits[i][0]));
        let remembered = self.remembered(i, state, traces);
        let rubbing = self.members[i].rubbing([length, T::zero()], &mode.actuators[i], remembered);
        self.members[i].actuator.holdable(length, pressure, above.le(T::zero()), rubbing)
    }

    /// The least and the largest torque in N·m on the joint at rest.
    pub(super) fn torques_at_rest<T: Over<R>, const N: usize>(
        &self,
        state: &[T; N],
        mode: &JointMode,
        traces: &Traces<R>,
    ) -> (T, T) {
        let [(least, most), (other_least, other_most)] = [0, 1].map(|i| self.holdable(i, state, mode, traces));
        let load = self.load_torque(state[ANGLE], T::zero(), mode.contact);
        let leverage = self.leverage(state[ANGLE], mode.arm_pieces);
        (leverage.torque_of([least, other_most]) + load, leverage.torque_of([most, other_least]) + load)
    }

    fn has_coulomb(&self, i: usize) -> bool {
        self.members[i].actuator.friction().has_coulomb()
    }

    fn has_direction(&self, i: usize) -> bool {
        self.members[i].actuator.friction().has_direction()
    }

    /// Whether an actuator rests, or could rest, on its shortest length.
    fn on_the_shortest<const N: usize>(&self, i: usize, state: &[R; N], mode: &JointMode) -> bool {
        mode.actuators[i].extent != Extent::Slack && state[ANGLE].value() == self.limits[i][0].value()
    }

    /// Sets how the joint turns, and with it how both actuators slide.
    pub(super) fn turn<const N: usize>(
        &self,
        state: &[R; N],
        mode: &mut JointMode,
        traces: &Traces<R>,
        turning: Turning,
    ) {
        mode.turning = turning;
        let pieces = mode.arm_pieces;
        for i in 0..2 {
            let member = &mut mode.actuators[i];
            member.sliding = turning.sliding(self.has_direction(i), SIGN[i]);
            self.members[i].enter_clamp(self.ends(i, state, pieces), member, self.remembered(i, state, traces));
        }
    }

    /// Sets the joint turning the way that the sign of `heading` says; an actuator on its shortest length that this would
    /// shorten falls slack.
    pub(super) fn head<const N: usize>(&self, state: &[R; N], mode: &mut JointMode, traces: &Traces<R>, heading: f64) {
        for i in 0..2 {
            if heading * SIGN[i] < 0.0 && self.on_the_shortest(i, state, mode) {
                mode.actuators[i].extent = Extent::Slack;
            }
        }
        let turning = match (self.has_direction(0) || self.has_direction(1), heading < 0.0) {
            (false, _) => Turning::Frictionless,
            (true, true) => Turning::Backward,
            (true, false) => Turning::Forward,
        };
        self.turn(state, mode, traces, turning);
    }

    /// How a joint turns in a state that may be at rest: from there it sticks if the torque can be held.
    pub(super) fn enter_turning<const N: usize>(&self, state: &[R; N], mode: &mut JointMode, traces: &Traces<R>) {
        let velocity = state[VELOCITY].value();
        if velocity != 0.0 {
            return self.head(state, mode, traces, velocity);
        }
        let holds = |i: usize| {
            let slack = mode.actuators[i].extent == Extent::Slack;
            !slack && (self.has_coulomb(i) || self.on_the_shortest(i, state, mode))
        };
        let can_stick = holds(0) || holds(1);
        let (least, most) = self.torques_at_rest(state, mode, traces);
        let middle = 0.5 * (least.value() + most.value());
        if !can_stick {
            self.head(state, mode, traces, middle);
        } else if most.value() < -self.torque_band {
            self.head(state, mode, traces, -1.0);
        } else if least.value() > self.torque_band {
            self.head(state, mode, traces, 1.0);
        } else {
            self.turn(state, mode, traces, Turning::Stuck);
        }
    }

    /// Whether the joint, arriving where an actuator is at its shortest, comes to rest there: the torque can be held, and
    /// it turns too slowly to be told from rest, or would bounce less than the tolerance of its angle.
    pub(super) fn rests_on_the_shortest<const N: usize>(
        &self,
        i: usize,
        state: &[R; N],
        mode: &JointMode,
        traces: &Traces<R>,
    ) -> bool {
        let with = |extent| {
            let mut mode = *mode;
            mode.actuators[i].extent = extent;
            let (least, most) = self.torques_at_rest(state, &mode, traces);
            (least.value(), most.value())
        };
        let (slack, free) = (with(Extent::Slack), with(Extent::Free));
        if free.0 > 0.0 || free.1 < 0.0 {
            return false;
        }
        let velocity = state[VELOCITY].value();
        // Back as it is slack, and against as it pulls with all its force, whatever the friction of the other.
        let (back, against) = if SIGN[i] > 0.0 { (slack.0, -free.0) } else { (-slack.1, free.1) };
        let acceleration = back.min(against) * self.per_inertia.value();
        let bounce = 2.0 * acceleration * self.members[i].band * self.angle_scales[0];
        velocity.abs() <= self.rest_band() || (acceleration > 0.0 && velocity * velocity <= bounce)
    }
}
