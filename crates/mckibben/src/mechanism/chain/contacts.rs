//! What a chain touches: the stops of its joints and the belt under its foot.
//!
//! ```text
//! S = max(0, K_stop δ + C_stop u)                         at a stop that is passed by δ and pressed at the rate u, against it
//!
//! belt:  N = max(0, k_b δ − c_b ṗ_y)                      where the foot is δ below the belt
//!        f = μ N s/√(s² + v_s²)                           s = u_b − ṗ_x: the speed at which the belt runs ahead of the foot
//! ```
//!
//! Symbols are those of the [chain](super). A stop never holds the segment back on rebound, and the belt never pulls: whether they
//! press is a part of the mode ([`Contact`]).
//!
//! Source: this project's choice, springs and dampers that only push. Checked by `tests/plant_ledger.rs` and `crates/mckibben-batch/tests/plant_batch.rs`.

use super::{Chain, MAX_JOINTS};
use crate::scalar::{Mask, Over, Scalar};

/// A belt under the end of the last segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belt<S = f64> {
    /// How far it is under the first joint in m.
    pub depth: S,
    /// Its velocity in m/s, positive in the direction in which positive angles swing.
    pub velocity: S,
    /// Stiffness of belt and foot together in N/m.
    pub stiffness: S,
    /// Damping of both in N·s/m.
    pub damping: S,
    /// Coefficient of dry friction.
    pub friction: S,
    /// Speed in m/s over which the friction changes its sign.
    pub slipping_speed: S,
}

impl<S: Scalar> Belt<S> {
    /// Normal force in N on a foot that is `depth` (m) below it and comes up at a velocity in m/s, before it is kept from pulling.
    #[inline(always)]
    pub(crate) fn press<T: Over<S>>(&self, depth: T, up: T) -> T {
        T::of(self.stiffness) * depth - T::of(self.damping) * up
    }
}

/// How something that only pushes touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contact {
    /// It is out of reach.
    #[default]
    None,
    /// It presses.
    Pressed,
    /// It is passed and does not press: the other side comes back faster than it springs.
    Rebound,
}

/// The contacts of a chain: both stops of each joint, and the belt.
#[derive(Clone, Copy, Debug)]
pub struct Contacts<'a> {
    /// At the least and the greatest angle of each joint.
    pub stops: &'a [[Contact; 2]],
    /// Of the foot with the belt.
    pub foot: Contact,
}

/// Which contacts of a chain press: masks, so that chains side by side may differ.
pub trait Presses<M> {
    /// Whether a joint presses the stop at its least (0) or its greatest angle (1).
    fn stop(&self, joint: usize, end: usize) -> M;
    /// Whether the foot presses the belt.
    fn foot(&self) -> M;
}

impl<M: Mask> Presses<M> for Contacts<'_> {
    #[inline(always)]
    fn stop(&self, joint: usize, end: usize) -> M {
        M::splat(self.stops[joint][end] == Contact::Pressed)
    }

    #[inline(always)]
    fn foot(&self) -> M {
        M::splat(self.foot == Contact::Pressed)
    }
}

/// The direction outwards of the least and of the greatest angle.
pub(super) const OUTWARDS: [f64; 2] = [-1.0, 1.0];

impl<S: Scalar> Chain<S> {
    /// Torque in N·m of a stop against a joint that presses it, before it is kept from pulling; zero where there is no stop.
    #[inline(always)]
    pub fn stop_torque<T: Over<S>>(&self, joint: usize, end: usize, angle: T, rate: T) -> T {
        let stops = &self.joints[joint].stops;
        let Some(stop) = stops.ends[end] else { return T::zero() };
        T::constant(OUTWARDS[end]) * (T::of(stops.stiffness) * (angle - T::of(stop)) + T::of(stops.damping) * rate)
    }

    /// How far in rad a joint is beyond a stop; negative before it.
    #[inline(always)]
    pub fn beyond_stop<T: Over<S>>(&self, joint: usize, end: usize, angle: T) -> T {
        match self.joints[joint].stops.ends[end] {
            Some(stop) => T::constant(OUTWARDS[end]) * (angle - T::of(stop)),
            None => -T::one(),
        }
    }

    /// Enters the directions of its segments at the angles of its joints: sine and cosine of how far each is inclined from where
    /// gravity pulls.
    #[inline(always)]
    pub fn enter_directions<T: Over<S>>(&self, angle: &[T], directions: &mut [[T; 2]]) {
        let mut inclination = -T::of(self.hanging_angle);
        for (direction, angle) in directions.iter_mut().zip(angle) {
            inclination = inclination + *angle;
            *direction = [inclination.sin(), inclination.cos()];
        }
    }

    /// How far a contact is passed (rad or m, negative before it) and how hard it would press (N·m or N, before it is kept from
    /// pulling): that of a joint with one of its stops, or of the foot with the belt.
    #[doc(hidden)]
    #[inline(always)]
    pub fn contact<T: Over<S>>(&self, stop: Option<(usize, usize)>, angle: &[T], rate: &[T]) -> [T; 2] {
        if let Some((k, end)) = stop {
            return [self.beyond_stop(k, end, angle[k]), self.stop_torque(k, end, angle[k], rate[k])];
        }
        match (&self.belt, self.foot(angle, rate)) {
            (Some(belt), Some((depth, [_, up]))) => [depth, belt.press(depth, up)],
            _ => [-T::one(), T::zero()],
        }
    }

    /// Depth in m of the foot under the belt, and its velocity in m/s across and up; none without a belt.
    #[inline(always)]
    pub fn foot<T: Over<S>>(&self, angle: &[T], rate: &[T]) -> Option<(T, [T; 2])> {
        let belt = self.belt.as_ref()?;
        let mut directions = [[T::zero(); 2]; MAX_JOINTS];
        self.enter_directions(angle, &mut directions);
        Some(self.foot_along(belt, &directions, rate))
    }

    /// Depth and velocity of the foot, by the sines and cosines of the segments' inclinations.
    #[inline(always)]
    fn foot_along<T: Over<S>>(&self, belt: &Belt<S>, directions: &[[T; 2]], rate: &[T]) -> (T, [T; 2]) {
        let (mut height, mut turning, mut velocity) = (T::zero(), T::zero(), [T::zero(); 2]);
        for (i, segment) in self.segments.iter().enumerate() {
            turning = turning + rate[i];
            let (length, [sine, cosine]) = (T::of(segment.length), directions[i]);
            height = height - length * cosine;
            velocity = [velocity[0] + length * turning * cosine, velocity[1] + length * turning * sine];
        }
        (-height - T::of(belt.depth), velocity)
    }

    /// Normal force in N between belt and foot before it is kept from pulling.
    #[inline(always)]
    pub fn foot_press<T: Over<S>>(&self, angle: &[T], rate: &[T]) -> T {
        match (&self.belt, self.foot(angle, rate)) {
            (Some(belt), Some((depth, [_, up]))) => belt.press(depth, up),
            _ => T::zero(),
        }
    }

    /// Force in N of the belt on a foot that presses it, across and up.
    #[inline(always)]
    pub(super) fn belt_force<T: Over<S>>(&self, belt: &Belt<S>, directions: &[[T; 2]], rate: &[T]) -> [T; 2] {
        let (depth, [across, up]) = self.foot_along(belt, directions, rate);
        let normal = belt.press(depth, up);
        let (slip, slow) = (T::of(belt.velocity) - across, T::of(belt.slipping_speed));
        [T::of(belt.friction) * normal * slip / (slip * slip + slow * slow).sqrt(), normal]
    }

    /// How the torques about the joints answer to angles (N·m/rad) and to rates (N·m·s/rad) where that is stiff, row by row: the
    /// damping of joints, and contacts that press. Both matrices are positive semidefinite.
    ///
    /// ```text
    /// joint k    C_kk = c_k                        at a stop that presses  S_kk = K_stop, C_kk = c_k + C_stop
    /// foot       S = k_b u uᵀ                      C = c_b u uᵀ + μ N v_s²/(s² + v_s²)^(3/2) a aᵀ
    /// a, u       how far the foot goes across and up with each angle, in m/rad
    /// ```
    #[doc(hidden)]
    #[inline(always)]
    pub fn stiffness(
        &self,
        angle: &[S],
        rate: &[S],
        presses: &impl Presses<S::Mask>,
        (by_angle, by_rate): (&mut [S], &mut [S]),
    ) {
        let (count, zero) = (self.segments.len(), S::zero());
        by_angle.fill(zero);
        by_rate.fill(zero);
        for (k, joint) in self.joints.iter().enumerate() {
            let place = k * count + k;
            by_rate[place] = joint.damping;
            for end in 0..2 {
                let presses = presses.stop(k, end);
                by_angle[place] = by_angle[place] + S::select(presses, joint.stops.stiffness, zero);
                by_rate[place] = by_rate[place] + S::select(presses, joint.stops.damping, zero);
            }
        }
        let (Some(belt), true) = (&self.belt, presses.foot().any()) else { return };
        let mut directions = [[zero; 2]; MAX_JOINTS];
        self.enter_directions(angle, &mut directions);
        let (depth, [across, up]) = self.foot_along(belt, &directions, rate);
        let (slip, slow) = (belt.velocity - across, belt.slipping_speed * belt.slipping_speed);
        let size = slip * slip + slow;
        let drag = belt.friction * belt.press(depth, up).larger(zero) * slow / (size * size.sqrt());
        let mut lever = [[zero; 2]; MAX_JOINTS];
        let mut beyond = [zero; 2];
        for k in (0..count).rev() {
            let (length, [sine, cosine]) = (self.segments[k].length, directions[k]);
            beyond = [beyond[0] + length * cosine, beyond[1] + length * sine];
            lever[k] = beyond;
        }
        for row in 0..count {
            for column in 0..count {
                let place = row * count + column;
                let (across, up) = (lever[row][0] * lever[column][0], lever[row][1] * lever[column][1]);
                let by_depth = S::select(presses.foot(), belt.stiffness * up, zero);
                let by_speed = S::select(presses.foot(), belt.damping * up + drag * across, zero);
                by_angle[place] = by_angle[place] + by_depth;
                by_rate[place] = by_rate[place] + by_speed;
            }
        }
    }
}
