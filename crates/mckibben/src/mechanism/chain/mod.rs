//! A planar chain of revolute joints: an arm, a leg, a single joint.
//!
//! ```text
//! ψ_i = Σ_{j ≤ i} θ_j − θ₀                                inclination of segment i from where gravity pulls
//!
//! T = ½ Σ_ij c_ij cos(ψ_i − ψ_j) ψ̇_i ψ̇_j                 U = −g Σ_i μ_i cos ψ_i
//! c_ii = I_i + m_i d_i² + l_i² Σ_{k>i} m_k                μ_i = m_i d_i + l_i Σ_{k>i} m_k
//! c_ij = l_i (m_j d_j + l_j Σ_{k>j} m_k),  i < j
//!
//! Q_k = W_k − c_k θ̇_k − S_k                               torque about joint k, besides that of the actuators
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | θ, ψ | joint angle, inclination | rad |
//! | l, m, d, I | `length`, `mass`, `distance` of the centre of mass from the joint above, `inertia` about it | m, kg, m, kg·m² |
//! | g, θ₀ | `gravity`, `hanging_angle`: sum of angles at which the first segment hangs straight down | m/s², rad |
//! | W_k, c_k | `torque`, `damping` of a joint | N·m, N·m·s/rad |
//! | K_stop, C_stop | stiffness and damping of its stops | N·m/rad, N·m·s/rad |
//! | k_b, c_b, μ, v_s | stiffness, damping, friction and slipping speed of the belt | N/m, N·s/m, –, m/s |
//!
//! The chain hangs from a fixed axis. Its stops and the belt push and never pull: whether they press is a
//! part of the mode ([`Contact`]).
//!
//! Source: Lagrange's equations; the paper's legs are chains of this kind. Checked by `tests/plant_linear_closed_forms.rs` and
//! `tests/plant_linear_analysis.rs`: frequencies of pendulums; by `tests/joint.rs` and `tests/plant_ledger.rs`.

mod contacts;

pub use contacts::{Belt, Contact, Contacts, Presses};

use super::parameter as own;
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::plant::Part;
use crate::scalar::{Mask, Over, Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;
use contacts::OUTWARDS;

/// A rigid segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainSegment<S = f64> {
    /// From its joint to the next, or to the foot, in m; of the last segment zero where nothing is there.
    pub length: S,
    /// Mass in kg.
    pub mass: S,
    /// From its joint to its centre of mass in m.
    pub distance: S,
    /// Moment of inertia about the centre of mass in kg·m².
    pub inertia: S,
}

/// Where a joint ends, and how it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointStops<S = f64> {
    /// The least and the greatest angle in rad, as far as there are such.
    pub ends: [Option<S>; 2],
    /// Stiffness in N·m/rad.
    pub stiffness: S,
    /// Damping in N·m·s/rad.
    pub damping: S,
}

/// A revolute joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Revolute<S = f64> {
    /// Constant torque in N·m towards greater angles.
    pub torque: S,
    /// Viscous damping in N·m·s/rad.
    pub damping: S,
    /// Its stops.
    pub stops: JointStops<S>,
}

/// Powers of a chain in W besides those of the actuators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainPowers<T = f64> {
    /// Lost in the damping of the joints.
    pub damping: T,
    /// Lost in the stops: their damping and rebound.
    pub stops: T,
    /// Lost between belt and foot: damping, rebound and slipping.
    pub belt: T,
    /// What the drive of the belt puts in.
    pub belt_drive: T,
}

/// A chain of revolute joints in a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain<S = f64> {
    segments: Vec<ChainSegment<S>>,
    joints: Vec<Revolute<S>>,
    gravity: S,
    hanging_angle: S,
    belt: Option<Belt<S>>,
    /// `c_ij`, row by row.
    couplings: Vec<S>,
    /// `g μ_i` in N·m.
    weights: Vec<S>,
}

impl Chain {
    /// A chain of at least one segment, with one joint above each, under `gravity` (m/s²) that pulls the first segment
    /// towards `hanging_angle` (rad).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] for a lower stop above the upper one or
    /// a chain whose mass matrix is singular in some posture; [`Error::Table`] unless there is one joint for each segment, and at
    /// most [`MAX_JOINTS`] of them.
    pub fn new(
        segments: Vec<ChainSegment>,
        joints: Vec<Revolute>,
        [gravity, hanging_angle]: [f64; 2],
        belt: Option<Belt>,
    ) -> Result<Self, Error> {
        let refused = |problem, entry, remedy| Err(Error::Table { name: "mechanism.joints", problem, entry, remedy });
        let count = joints.len();
        if segments.is_empty() || segments.len() != count {
            let remedy = "give as many joints as segments, at least one";
            return refused("there is not one joint for each segment", segments.len().min(count) + 1, remedy);
        }
        if count > MAX_JOINTS {
            let remedy = "join segments that hardly bend, or divide the chain into several mechanisms";
            return refused("a chain has at most eight joints", MAX_JOINTS + 1, remedy);
        }
        parameter::GRAVITY.check(gravity)?;
        parameter::HANGING_ANGLE.check(hanging_angle)?;
        for (index, segment) in segments.iter().enumerate() {
            let is_last = index + 1 == segments.len();
            if !(is_last && segment.length == 0.0) {
                own::SEGMENT_LENGTH.check(segment.length)?;
            }
            parameter::MASS.check(segment.mass)?;
            parameter::LIMB_DISTANCE.check(segment.distance)?;
            parameter::LIMB_INERTIA.check(segment.inertia)?;
        }
        for Revolute { torque, damping, stops } in &joints {
            parameter::JOINT_TORQUE.check(*torque)?;
            parameter::JOINT_DAMPING.check(*damping)?;
            parameter::STOP_STIFFNESS.check(stops.stiffness)?;
            parameter::STOP_DAMPING.check(stops.damping)?;
            let [low, high] = stops.ends;
            low.map(|angle| parameter::MIN_ANGLE.check(angle)).transpose()?;
            high.map(|angle| parameter::MAX_ANGLE.check(angle)).transpose()?;
            if let (Some(low), Some(high)) = (low, high)
                && low >= high
            {
                return Err(Error::Inconsistent {
                    parameter: &parameter::MIN_ANGLE,
                    value: low,
                    requirement: Requirement {
                        relation: "must be less than",
                        other: parameter::MAX_ANGLE.key,
                        value: high,
                        unit: "rad",
                    },
                    remedy: "lower min_angle or raise max_angle",
                });
            }
        }
        if let Some(belt) = &belt {
            own::BELT_DEPTH.check(belt.depth)?;
            own::BELT_VELOCITY.check(belt.velocity)?;
            own::BELT_STIFFNESS.check(belt.stiffness)?;
            own::BELT_DAMPING.check(belt.damping)?;
            own::BELT_FRICTION.check(belt.friction)?;
            own::SLIPPING_SPEED.check(belt.slipping_speed)?;
        }
        let last = segments[segments.len() - 1];
        if last.inertia + last.mass * last.distance * last.distance <= 0.0 {
            return Err(Error::Inconsistent {
                parameter: &parameter::LIMB_INERTIA,
                value: last.inertia,
                requirement: Requirement {
                    relation: "with the mass at its distance must be above",
                    other: "the moment of inertia about the axis of",
                    value: 0.0,
                    unit: "kg*m^2",
                },
                remedy: "give the limb a moment of inertia, or a distance from the axis",
            });
        }
        if let Some(index) = without_inertia(&segments) {
            return Err(Error::Inconsistent {
                parameter: &parameter::LIMB_INERTIA,
                value: segments[index].inertia,
                requirement: Requirement {
                    relation: "with the mass at its distance, or the inertia of the next segment, must be above: stretched out, \
                               the chain would turn without",
                    other: "inertia, and not only",
                    value: 0.0,
                    unit: "kg*m^2",
                },
                remedy: "give the segment a moment of inertia, or its mass a distance from the joint",
            });
        }
        Ok(Self::assemble(segments, joints, [gravity, hanging_angle], belt))
    }
}

/// A segment that could turn in some posture without anything of mass moving, so that the mass matrix is singular there: it
/// has no inertia about its joint, and what hangs on it turns back with its mass at rest.
fn without_inertia(segments: &[ChainSegment]) -> Option<usize> {
    let about_joint = |segment: &ChainSegment| segment.inertia + segment.mass * segment.distance * segment.distance;
    // Whether all behind a joint that moves can stay without energy: each turns about its mass until one's end rests too.
    let can_rest = |behind: &[ChainSegment]| {
        for (index, segment) in behind.iter().enumerate() {
            if segment.inertia > 0.0 || segment.distance == 0.0 {
                return false;
            }
            if index + 1 == behind.len() || segment.distance == segment.length {
                return true;
            }
        }
        true
    };
    (0..segments.len()).find(|&k| about_joint(&segments[k]) <= 0.0 && can_rest(&segments[k + 1..]))
}

/// The most joints that a chain may have.
pub const MAX_JOINTS: usize = 8;

impl<S: Scalar> Chain<S> {
    /// A chain of numbers that are within their ranges.
    pub(crate) fn assemble(
        segments: Vec<ChainSegment<S>>,
        joints: Vec<Revolute<S>>,
        [gravity, hanging_angle]: [S; 2],
        belt: Option<Belt<S>>,
    ) -> Self {
        let count = segments.len();
        // Mass beyond segment i.
        let mut carried = vec![S::zero(); count];
        for i in (0..count.saturating_sub(1)).rev() {
            carried[i] = carried[i + 1] + segments[i + 1].mass;
        }
        let moment = |i: usize| segments[i].mass * segments[i].distance + segments[i].length * carried[i];
        let mut couplings = vec![S::zero(); count * count];
        for i in 0..count {
            let ChainSegment { length, mass, distance, inertia } = segments[i];
            couplings[i * count + i] = inertia + mass * distance * distance + length * length * carried[i];
            for j in i + 1..count {
                let coupling = length * moment(j);
                couplings[i * count + j] = coupling;
                couplings[j * count + i] = coupling;
            }
        }
        let weights = (0..count).map(|i| gravity * moment(i)).collect();
        Self { segments, joints, gravity, hanging_angle, belt, couplings, weights }
    }

    pub(crate) fn convert<T: Scalar>(&self, index: usize, convert: &mut impl Convert<S, T>) -> Chain<T> {
        let (mut segments, mut joints) = (Vec::new(), Vec::new());
        for (place, (segment, joint)) in self.segments.iter().zip(&self.joints).enumerate() {
            convert.turn_to(Some(Part::Joint(index, place)));
            let mut number = |row, value| convert.parameter(row, value);
            segments.push(ChainSegment {
                length: number(&own::SEGMENT_LENGTH, segment.length),
                mass: number(&parameter::MASS, segment.mass),
                distance: number(&parameter::LIMB_DISTANCE, segment.distance),
                inertia: number(&parameter::LIMB_INERTIA, segment.inertia),
            });
            joints.push(Revolute {
                torque: number(&parameter::JOINT_TORQUE, joint.torque),
                damping: number(&parameter::JOINT_DAMPING, joint.damping),
                stops: JointStops {
                    ends: [
                        joint.stops.ends[0].map(|angle| number(&parameter::MIN_ANGLE, angle)),
                        joint.stops.ends[1].map(|angle| number(&parameter::MAX_ANGLE, angle)),
                    ],
                    stiffness: number(&parameter::STOP_STIFFNESS, joint.stops.stiffness),
                    damping: number(&parameter::STOP_DAMPING, joint.stops.damping),
                },
            });
        }
        convert.turn_to(Some(Part::Mechanism(index)));
        let mut number = |row, value| convert.parameter(row, value);
        let base = [number(&parameter::GRAVITY, self.gravity), number(&parameter::HANGING_ANGLE, self.hanging_angle)];
        let belt = self.belt.map(|belt| Belt {
            depth: number(&own::BELT_DEPTH, belt.depth),
            velocity: number(&own::BELT_VELOCITY, belt.velocity),
            stiffness: number(&own::BELT_STIFFNESS, belt.stiffness),
            damping: number(&own::BELT_DAMPING, belt.damping),
            friction: number(&own::BELT_FRICTION, belt.friction),
            slipping_speed: number(&own::SLIPPING_SPEED, belt.slipping_speed),
        });
        Chain::assemble(segments, joints, base, belt)
    }

    /// The segments, from the fixed axis on.
    pub fn segments(&self) -> &[ChainSegment<S>] {
        &self.segments
    }

    /// The joints, each above the segment of its index.
    pub fn joints(&self) -> &[Revolute<S>] {
        &self.joints
    }

    /// Acceleration of gravity in m/s².
    pub fn gravity(&self) -> S {
        self.gravity
    }

    /// Angle in rad of the first joint at which the first segment points where gravity pulls.
    pub fn hanging_angle(&self) -> S {
        self.hanging_angle
    }

    /// The belt, if there is one.
    pub fn belt(&self) -> Option<&Belt<S>> {
        self.belt.as_ref()
    }

    /// Inclination of segment `index` from where gravity pulls, in rad.
    #[inline(always)]
    fn inclination<T: Over<S>>(&self, index: usize, angle: &[T]) -> T {
        let mut inclination = -T::of(self.hanging_angle);
        for angle in &angle[..=index] {
            inclination = inclination + *angle;
        }
        inclination
    }

    /// The mass matrix over the joints' angles, row by row, in kg·m², by the [directions](Chain::enter_directions) of its segments.
    #[inline(always)]
    pub fn mass_matrix<T: Over<S>>(&self, directions: &[[T; 2]], matrix: &mut [T]) {
        let count = self.segments.len();
        if let [only] = matrix {
            *only = T::of(self.couplings[0]);
            return;
        }
        for i in 0..count {
            matrix[i * count + i] = T::of(self.couplings[i * count + i]);
            for j in i + 1..count {
                let [_, cosine] = turned(directions[i], directions[j]);
                let coupling = T::of(self.couplings[i * count + j]) * cosine;
                (matrix[i * count + j], matrix[j * count + i]) = (coupling, coupling);
            }
        }
        // An angle turns all segments beyond its joint: sums from the end on, along both directions.
        for i in 0..count {
            for j in (0..count - 1).rev() {
                matrix[i * count + j] = matrix[i * count + j] + matrix[i * count + j + 1];
            }
        }
        for i in (0..count - 1).rev() {
            for j in 0..count {
                matrix[i * count + j] = matrix[i * count + j] + matrix[(i + 1) * count + j];
            }
        }
    }

    /// Torques in N·m about the joints besides those of the actuators, less what the motion itself needs: `τ − h`.
    #[inline(always)]
    pub fn torques<T: Over<S>>(
        &self,
        ChainMotion { directions, angle, rate }: ChainMotion<'_, T>,
        presses: &impl Presses<T::Mask>,
        torque: &mut [T],
    ) {
        let count = self.segments.len();
        let (mut along, mut turning) = (T::zero(), T::zero());
        for i in 0..count {
            torque[i] = -T::of(self.weights[i]) * directions[i][0];
        }
        match (&self.belt, presses.foot()) {
            (Some(belt), on_foot) if on_foot.any() => {
                let [across, up] = self.belt_force(belt, directions, rate);
                for i in 0..count {
                    let [sine, cosine] = directions[i];
                    let pushed = torque[i] + T::of(self.segments[i].length) * (across * cosine + up * sine);
                    torque[i] = T::select(on_foot, pushed, torque[i]);
                }
            }
            _ => {}
        }
        for i in 0..count {
            turning = turning + rate[i];
            let mut other = turning;
            for j in i + 1..count {
                other = other + rate[j];
                // Each of two segments pulls the other along.
                let [sine, _] = turned(directions[i], directions[j]);
                let coupling = T::of(self.couplings[i * count + j]) * sine;
                torque[i] = torque[i] + coupling * other * other;
                torque[j] = torque[j] - coupling * turning * turning;
            }
        }
        for k in (0..count).rev() {
            along = along + torque[k];
            let joint = &self.joints[k];
            torque[k] = along + T::of(joint.torque) - T::of(joint.damping) * rate[k];
            for end in 0..2 {
                let on_stop = presses.stop(k, end);
                if on_stop.any() {
                    let push = T::constant(OUTWARDS[end]) * self.stop_torque(k, end, angle[k], rate[k]);
                    torque[k] = T::select(on_stop, torque[k] - push, torque[k]);
                }
            }
        }
    }

    /// The size in N·m of its weight and constant torques.
    pub(crate) fn usual_torque(&self) -> f64
    where
        S: Real,
    {
        let weight = self.weights.iter().map(|weight| weight.value().abs()).sum::<f64>();
        self.joints.iter().fold(weight, |sum, joint| sum + joint.torque.value().abs())
    }

    /// Place in m of a point on a segment, or on the ground: across and up, from the first joint.
    pub fn point<T: Over<S>>(&self, segment: Option<usize>, place: [T; 2], angle: &[T]) -> [T; 2] {
        let mut directions = [[T::zero(); 2]; MAX_JOINTS];
        self.enter_directions(angle, &mut directions);
        self.reach(0, segment, place, &directions)
    }

    /// Place in m of a joint, or of the last segment's tip: across and up, from the first joint.
    pub fn joint_place<T: Over<S>>(&self, joint: usize, angle: &[T]) -> [T; 2] {
        match joint.checked_sub(1) {
            Some(above) => self.point(Some(above), [T::of(self.segments[above].length), T::zero()], angle),
            None => [T::zero(); 2],
        }
    }

    /// From a joint to a point on its segment or on one behind it: across and up in m. A point on the ground is counted from the
    /// first joint.
    #[inline(always)]
    pub(super) fn reach<T: Over<S>>(
        &self,
        joint: usize,
        segment: Option<usize>,
        [along, across]: [T; 2],
        directions: &[[T; 2]],
    ) -> [T; 2] {
        let Some(segment) = segment else { return [across, -along] };
        let [sine, cosine] = directions[segment];
        let mut reach = [along * sine + across * cosine, across * sine - along * cosine];
        for between in joint..segment {
            let (length, [sine, cosine]) = (T::of(self.segments[between].length), directions[between]);
            reach = [reach[0] + length * sine, reach[1] - length * cosine];
        }
        reach
    }

    /// Powers in W that the mechanism loses, and that which the belt puts in, at angles and rates.
    pub fn powers<T: Over<S>>(&self, angle: &[T], rate: &[T], contacts: Contacts<'_>) -> ChainPowers<T> {
        let zero = T::zero();
        let mut powers = ChainPowers { damping: zero, stops: zero, belt: zero, belt_drive: zero };
        for (k, joint) in self.joints.iter().enumerate() {
            powers.damping = powers.damping + T::of(joint.damping) * rate[k] * rate[k];
            for end in 0..2 {
                let beyond = self.beyond_stop(k, end, angle[k]).larger(zero);
                let spring = T::of(joint.stops.stiffness) * beyond;
                let outwards = T::constant(OUTWARDS[end]) * rate[k];
                let push = match contacts.stops[k][end] {
                    Contact::Pressed => self.stop_torque(k, end, angle[k], rate[k]),
                    Contact::None | Contact::Rebound => zero,
                };
                // What the stop stores is its spring alone.
                powers.stops = powers.stops + (push - spring) * outwards;
            }
        }
        if let (Some(belt), Some((depth, [across, up]))) = (&self.belt, self.foot(angle, rate)) {
            let spring = T::of(belt.stiffness) * depth.larger(zero);
            let mut directions = [[zero; 2]; MAX_JOINTS];
            self.enter_directions(angle, &mut directions);
            let [drag, normal] = match contacts.foot {
                Contact::Pressed => self.belt_force(belt, &directions, rate),
                Contact::None | Contact::Rebound => [zero; 2],
            };
            powers.belt = (spring - normal) * up + drag * (T::of(belt.velocity) - across);
            powers.belt_drive = drag * T::of(belt.velocity);
        }
        powers
    }

    /// Kinetic and potential energy in J, the springs of stops and belt included.
    pub fn energies<T: Over<S>>(&self, angle: &[T], rate: &[T]) -> [T; 2] {
        let count = self.segments.len();
        let half = T::constant(0.5);
        let (mut kinetic, mut potential) = (T::zero(), T::zero());
        let mut turning = T::zero();
        for i in 0..count {
            turning = turning + rate[i];
            let inclination = self.inclination(i, angle);
            potential = potential - T::of(self.weights[i]) * inclination.cos();
            let mut other = T::zero();
            for j in 0..count {
                other = other + rate[j];
                let apart = self.inclination(j, angle) - inclination;
                kinetic = kinetic + half * T::of(self.couplings[i * count + j]) * apart.cos() * turning * other;
            }
            let joint = &self.joints[i];
            potential = potential - T::of(joint.torque) * angle[i];
            for end in 0..2 {
                let depth = self.beyond_stop(i, end, angle[i]).larger(T::zero());
                potential = potential + half * T::of(joint.stops.stiffness) * depth * depth;
            }
        }
        if let (Some(belt), Some((depth, _))) = (&self.belt, self.foot(angle, rate)) {
            let depth = depth.larger(T::zero());
            potential = potential + half * T::of(belt.stiffness) * depth * depth;
        }
        [kinetic, potential]
    }
}

/// How a chain moves.
#[derive(Clone, Copy, Debug)]
pub struct ChainMotion<'a, T> {
    /// The [directions](Chain::enter_directions) of its segments.
    pub directions: &'a [[T; 2]],
    /// The angles of its joints in rad.
    pub angle: &'a [T],
    /// Their rates in rad/s.
    pub rate: &'a [T],
}

/// Sine and cosine of the angle from one direction to another.
#[inline(always)]
fn turned<T: Scalar>([from_sine, from_cosine]: [T; 2], [sine, cosine]: [T; 2]) -> [T; 2] {
    [sine * from_cosine - cosine * from_sine, cosine * from_cosine + sine * from_sine]
}
