//! A leg in the plane: two segments, three antagonistic pairs, and a belt under the foot.
//!
//! ```text
//! hip ●───────── thigh, a₁ from straight down ─────────● knee
//!                                                        ╲ shank, a₂ = a₁ + θ₂        θ₁ = a₁
//!                                                          ╲
//!                                                            ● foot
//!
//! A ä₁ + C cos(a₁ − a₂) ä₂ + C sin(a₁ − a₂) ȧ₂² + (M₁ d₁ + M₂ l₁) g sin a₁ = T₁ − T₂ + f·∂p/∂a₁
//! C cos(a₁ − a₂) ä₁ + B ä₂ − C sin(a₁ − a₂) ȧ₁² + M₂ d₂ g sin a₂           = T₂ + f·∂p/∂a₂
//! A = I₁ + M₁ d₁² + M₂ l₁²        B = I₂ + M₂ d₂²        C = M₂ l₁ d₂
//!
//! T_j = Σ R_ij F_i − c_j θ̇_j − S_j        L_i = ℓ_i − R_i1 θ₁ − R_i2 θ₂
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | θ₁, θ₂ | angles of hip and knee, growing forward | rad |
//! | l, M, d, I | `length`, `mass`, `distance` of the centre of mass from the joint above, `inertia` about it | m, kg, m, kg·m² |
//! | R_ij, ℓ_i | `arms`, `rest_length` of a [`Strand`]: one actuator | m |
//! | c_j | `damping` of a joint | N·m·s/rad |
//! | S_j | torque of a stop, as of a [`Joint`](super::Joint) | N·m |
//! | p, f | place of the foot from the hip, and the belt's force on it | m, N |
//!
//! An actuator with an arm about both joints spans both, as the thigh's long muscles do. The hip is held: the leg walks on a
//! [`Belt`], which presses the foot as a spring and damper press and drags it with
//! `μ N s/√(s² + v_s²)`, where s is the speed at which the belt runs ahead of the foot.
//!
//! Source: elementary mechanics; three pairs in the plane as on the leg that the paper's actuators were for. Checked by
//! `tests/leg.rs`: energy, equations of Lagrange by dual numbers, balance of work of each strand.

pub mod parameter;
mod small_dog;

use crate::error::{Error, Requirement};
use crate::parameter::{
    GRAVITY, JOINT_DAMPING, LIMB_DISTANCE, LIMB_INERTIA, MAX_ANGLE, MIN_ANGLE, REST_LENGTH, STOP_DAMPING,
    STOP_STIFFNESS,
};
use crate::scalar::{Over, Scalar};

/// Actuators of a leg: agonist and antagonist of each pair.
pub const STRANDS: usize = 6;

/// One segment of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<S = f64> {
    /// Length l in m from joint to joint, or to the foot.
    pub length: S,
    /// Mass M in kg.
    pub mass: S,
    /// Distance d in m of the centre of mass from the joint above.
    pub distance: S,
    /// Moment of inertia I in kg·m² about the centre of mass.
    pub inertia: S,
}

/// How one actuator runs along the leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strand<S = f64> {
    /// Moment arms in m about hip and knee; an actuator with a positive arm turns that joint forward.
    pub arms: [S; 2],
    /// Distance in m between the attachments with both joints at zero.
    pub rest_length: S,
}

/// Where the range of a joint ends, and how hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range<S = f64> {
    /// Lower and upper end in rad.
    pub ends: [S; 2],
    /// Viscous damping within it in N·m·s/rad.
    pub damping: S,
    /// Stiffness of the stops in N·m/rad.
    pub stop_stiffness: S,
    /// Damping of the stops in N·m·s/rad.
    pub stop_damping: S,
}

/// A belt that runs under the foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belt<S = f64> {
    /// How far under the hip it is, in m.
    pub depth: S,
    /// Its velocity in m/s, forward.
    pub velocity: S,
    /// Stiffness in N/m.
    pub stiffness: S,
    /// Damping in N·s/m.
    pub damping: S,
    /// Coefficient μ of dry friction.
    pub friction: S,
    /// Speed v_s in m/s at which the foot slips: slower, it is dragged nearly in proportion.
    pub slipping_speed: S,
}

/// A leg in the plane whose hip is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg<S = f64> {
    /// Thigh and shank.
    pub segments: [Segment<S>; 2],
    /// Gravity in m/s².
    pub gravity: S,
    /// Hip and knee.
    pub ranges: [Range<S>; 2],
    /// The actuators: agonist and antagonist of the hip, of the knee, and of both.
    pub strands: [Strand<S>; STRANDS],
    /// What the foot walks on, if anything.
    pub belt: Option<Belt<S>>,
}

/// Where a leg is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegState<S = f64> {
    /// Angles of hip and knee in rad.
    pub angles: [S; 2],
    /// Their rates in rad/s.
    pub rates: [S; 2],
}

impl Leg {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range, [`Error::Inconsistent`] for stops in the wrong order.
    pub fn checked(self) -> Result<Self, Error> {
        GRAVITY.check(self.gravity)?;
        for segment in &self.segments {
            parameter::SEGMENT_LENGTH.check(segment.length)?;
            parameter::SEGMENT_MASS.check(segment.mass)?;
            LIMB_DISTANCE.check(segment.distance)?;
            LIMB_INERTIA.check(segment.inertia)?;
        }
        for range in &self.ranges {
            JOINT_DAMPING.check(range.damping)?;
            STOP_STIFFNESS.check(range.stop_stiffness)?;
            STOP_DAMPING.check(range.stop_damping)?;
            let low = MIN_ANGLE.check(range.ends[0])?;
            let high = MAX_ANGLE.check(range.ends[1])?;
            if low >= high {
                return Err(Error::Inconsistent {
                    parameter: &MIN_ANGLE,
                    value: low,
                    requirement: Requirement {
                        relation: "must be less than",
                        other: MAX_ANGLE.key,
                        value: high,
                        unit: "rad",
                    },
                    remedy: "lower min_angle or raise max_angle",
                });
            }
        }
        for strand in &self.strands {
            REST_LENGTH.check(strand.rest_length)?;
            for arm in strand.arms {
                parameter::MOMENT_ARM.check(arm)?;
            }
        }
        if let Some(belt) = &self.belt {
            parameter::BELT_DEPTH.check(belt.depth)?;
            parameter::BELT_VELOCITY.check(belt.velocity)?;
            parameter::BELT_STIFFNESS.check(belt.stiffness)?;
            parameter::BELT_DAMPING.check(belt.damping)?;
            parameter::BELT_FRICTION.check(belt.friction)?;
            parameter::SLIPPING_SPEED.check(belt.slipping_speed)?;
        }
        Ok(self)
    }
}

impl<S: Scalar> Leg<S> {
    /// Distances in m between the attachments of each actuator.
    pub fn lengths<T: Over<S>>(&self, angles: &[T; 2]) -> [T; STRANDS] {
        self.strands.map(|strand| T::of(strand.rest_length) - along(&strand.arms, angles))
    }

    /// Their rates in m/s.
    pub fn velocities<T: Over<S>>(&self, rates: &[T; 2]) -> [T; STRANDS] {
        self.strands.map(|strand| -along(&strand.arms, rates))
    }

    /// Torques in N·m about hip and knee that tensions in N make.
    pub fn torques<T: Over<S>>(&self, tensions: &[T; STRANDS]) -> [T; 2] {
        let about = |joint: usize| {
            let pairs = self.strands.iter().zip(tensions);
            pairs.fold(T::zero(), |sum, (strand, tension)| sum + T::of(strand.arms[joint]) * *tension)
        };
        [about(0), about(1)]
    }

    /// Knee and foot in m from the hip, forward and up.
    pub fn places<T: Over<S>>(&self, angles: &[T; 2]) -> [[T; 2]; 2] {
        let [thigh, shank] = self.segments.map(|segment| T::of(segment.length));
        let [of_thigh, of_shank] = inclinations(angles);
        let knee = [thigh * of_thigh.sin(), -thigh * of_thigh.cos()];
        [knee, [knee[0] + shank * of_shank.sin(), knee[1] - shank * of_shank.cos()]]
    }

    /// Force in N of the belt on the foot, forward and up.
    pub fn belt_force<T: Over<S>>(&self, state: &LegState<T>) -> [T; 2] {
        let Some(belt) = &self.belt else { return [T::zero(); 2] };
        let [_, [_, height]] = self.places(&state.angles);
        let [across, up] = self.foot_velocity(state);
        let depth = -height - T::of(belt.depth);
        let press = (T::of(belt.stiffness) * depth - T::of(belt.damping) * up).larger(T::zero());
        let normal = T::select(T::zero().lt(depth), press, T::zero());
        let (slip, slow) = (T::of(belt.velocity) - across, T::of(belt.slipping_speed));
        let drag = T::of(belt.friction) * normal * slip / (slip * slip + slow * slow).sqrt();
        [drag, normal]
    }

    fn foot_velocity<T: Over<S>>(&self, state: &LegState<T>) -> [T; 2] {
        let [thigh, shank] = self.segments.map(|segment| T::of(segment.length));
        let [of_thigh, of_shank] = inclinations(&state.angles);
        let [rate_of_thigh, rate_of_shank] = inclinations(&state.rates);
        let (by_thigh, by_shank) = (thigh * rate_of_thigh, shank * rate_of_shank);
        [by_thigh * of_thigh.cos() + by_shank * of_shank.cos(), by_thigh * of_thigh.sin() + by_shank * of_shank.sin()]
    }

    /// Angular accelerations of hip and knee in rad/s² under the tensions of the actuators in N.
    pub fn accelerations<T: Over<S>>(&self, state: &LegState<T>, tensions: &[T; STRANDS]) -> [T; 2] {
        let [of_thigh, of_shank] = inclinations(&state.angles);
        let [rate_of_thigh, rate_of_shank] = inclinations(&state.rates);
        let gravity = T::of(self.gravity);
        let [hip, knee] = self.joint_torques(state, tensions);
        let [across, up] = self.belt_force(state);
        let levers = self.segments.map(|segment| T::of(segment.length));
        let by_belt = |lever: T, inclination: T| lever * (across * inclination.cos() + up * inclination.sin());
        let [of_first, of_second, coupling] = self.inertias().map(T::of);
        let [first_moment, second_moment] = self.moments().map(T::of);
        let apart = of_thigh - of_shank;
        let (near, turned) = (coupling * apart.cos(), coupling * apart.sin());
        let on_thigh = hip - knee + by_belt(levers[0], of_thigh)
            - turned * rate_of_shank * rate_of_shank
            - first_moment * gravity * of_thigh.sin();
        let on_shank = knee + by_belt(levers[1], of_shank) + turned * rate_of_thigh * rate_of_thigh
            - second_moment * gravity * of_shank.sin();
        let per_determinant = T::one() / (of_first * of_second - near * near);
        let thigh = (of_second * on_thigh - near * on_shank) * per_determinant;
        let shank = (of_first * on_shank - near * on_thigh) * per_determinant;
        [thigh, shank - thigh]
    }

    /// Torques in N·m about hip and knee: of the actuators, the damping and the stops.
    fn joint_torques<T: Over<S>>(&self, state: &LegState<T>, tensions: &[T; STRANDS]) -> [T; 2] {
        let pulled = self.torques(tensions);
        let about = |joint: usize| {
            let (range, angle, rate) = (&self.ranges[joint], state.angles[joint], state.rates[joint]);
            pulled[joint] - T::of(range.damping) * rate + range.push(angle, rate)
        };
        [about(0), about(1)]
    }

    /// `A`, `B` and `C` in kg·m².
    fn inertias(&self) -> [S; 3] {
        let [thigh, shank] = &self.segments;
        let about = |segment: &Segment<S>| segment.inertia + segment.mass * segment.distance * segment.distance;
        let carried = shank.mass * thigh.length * thigh.length;
        [about(thigh) + carried, about(shank), shank.mass * thigh.length * shank.distance]
    }

    /// `M₁ d₁ + M₂ l₁` and `M₂ d₂` in kg·m.
    fn moments(&self) -> [S; 2] {
        let [thigh, shank] = &self.segments;
        [thigh.mass * thigh.distance + shank.mass * thigh.length, shank.mass * shank.distance]
    }

    /// Kinetic energy, and the potential one of weight, stops and belt, in J.
    pub fn energies<T: Over<S>>(&self, state: &LegState<T>) -> [T; 2] {
        let half = T::constant(0.5);
        let [of_thigh, of_shank] = inclinations(&state.angles);
        let [rate_of_thigh, rate_of_shank] = inclinations(&state.rates);
        let [of_first, of_second, coupling] = self.inertias().map(T::of);
        let kinetic = half * (of_first * rate_of_thigh * rate_of_thigh + of_second * rate_of_shank * rate_of_shank)
            + coupling * (of_thigh - of_shank).cos() * rate_of_thigh * rate_of_shank;
        let [first_moment, second_moment] = self.moments().map(T::of);
        let weight = -T::of(self.gravity) * (first_moment * of_thigh.cos() + second_moment * of_shank.cos());
        let stop = |joint: usize| {
            let range = &self.ranges[joint];
            let passed = range.passed(state.angles[joint]);
            half * T::of(range.stop_stiffness) * (passed[0] * passed[0] + passed[1] * passed[1])
        };
        let pressed = self.belt.as_ref().map_or(T::zero(), |belt| {
            let [_, [_, height]] = self.places(&state.angles);
            let depth = (-height - T::of(belt.depth)).larger(T::zero());
            half * T::of(belt.stiffness) * depth * depth
        });
        [kinetic, weight + stop(0) + stop(1) + pressed]
    }
}

impl<S: Scalar> Range<S> {
    /// By how much the lower and the upper end are passed, in rad.
    fn passed<T: Over<S>>(&self, angle: T) -> [T; 2] {
        [(T::of(self.ends[0]) - angle).larger(T::zero()), (angle - T::of(self.ends[1])).larger(T::zero())]
    }

    /// Torque in N·m of the stops, forward; they never hold the joint back on rebound.
    fn push<T: Over<S>>(&self, angle: T, rate: T) -> T {
        let [below, above] = self.passed(angle);
        let pushes = |passed: T, outwards: T| {
            let push = (T::of(self.stop_stiffness) * passed + T::of(self.stop_damping) * outwards).larger(T::zero());
            T::select(T::zero().lt(passed), push, T::zero())
        };
        pushes(below, -rate) - pushes(above, rate)
    }
}

/// `R₁ x₁ + R₂ x₂`.
fn along<S: Scalar, T: Over<S>>(arms: &[S; 2], numbers: &[T; 2]) -> T {
    T::of(arms[0]) * numbers[0] + T::of(arms[1]) * numbers[1]
}

/// From hip and knee to thigh and shank: of angles, and of their rates.
fn inclinations<T: Scalar>([hip, knee]: &[T; 2]) -> [T; 2] {
    [*hip, *hip + *knee]
}
