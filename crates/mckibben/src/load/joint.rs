//! A joint that two antagonistic actuators turn, each by its moment arm.
//!
//! ```text
//! J dω/dt = r₁(θ) F₁ − r₂(θ) F₂ + W − M g d sin(θ − θ₀) − c ω − S        J = I + M d²
//! L₁ = ℓ₁ − e₁(θ)        L₂ = ℓ₂ + e₂(θ)        e = ∫₀^θ r dθ        (see `moment_arm`)
//! S = max(0, K_stop δ + C_stop u)  at a stop that is passed by δ and pressed at the rate u, against it
//! ```
//!
//! The first actuator, the agonist, turns the joint towards greater angles, the second, the antagonist, back. A stop
//! never holds the limb back on rebound, as the taut braid (14).
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | θ, ω | `angle`, `angular_velocity` | rad, rad/s |
//! | r, ℓ | `arm`, `rest_length`, the distance between the attachments at angle zero | m |
//! | M, d | `mass`, `distance` of the centre of mass from the axis | kg, m |
//! | I, J | `inertia` about the centre of mass, and about the axis | kg·m² |
//! | g, θ₀ | `gravity`, `hanging_angle` at which the limb hangs straight down | m/s², rad |
//! | W | `torque`, constant | N·m |
//! | c | `damping` | N·m·s/rad |
//! | K_stop, C_stop | `stiffness`, `damping` of the stops | N·m/rad, N·m·s/rad |
//!
//! Source: elementary mechanics. Checked by `tests/joint.rs`.

use super::moment_arm::MomentArm;
#[cfg(feature = "alloc")]
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};

/// The limb that a joint carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb<S = f64> {
    /// Mass M in kg.
    pub mass: S,
    /// Distance d of the centre of mass from the axis in m.
    pub distance: S,
    /// Moment of inertia I about the centre of mass in kg·m².
    pub inertia: S,
    /// Gravity g in m/s².
    pub gravity: S,
    /// Angle θ₀ in rad at which the limb hangs straight down.
    pub hanging_angle: S,
}

/// How one actuator is led over the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tendon<S = f64> {
    /// Its moment arm.
    pub arm: MomentArm<S>,
    /// Distance ℓ in m between the attachments at angle zero.
    pub rest_length: S,
}

/// Where a joint's range ends, and how hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops<S = f64> {
    /// Lower and upper end of the range in rad; without one the joint turns freely that way.
    pub ends: [Option<S>; 2],
    /// Stiffness K_stop in N·m/rad.
    pub stiffness: S,
    /// Damping C_stop in N·m·s/rad.
    pub damping: S,
}

/// Where agonist and antagonist pull at an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leverage<S = f64> {
    /// Distances in m between the attachments.
    pub lengths: [S; 2],
    /// Moment arms in m.
    pub arms: [S; 2],
}

impl<S: Scalar> Leverage<S> {
    /// `dL/dθ` of each actuator in m: `−r₁` and `r₂`.
    #[inline(always)]
    pub fn slopes(&self) -> [S; 2] {
        [-self.arms[0], self.arms[1]]
    }

    /// Torque in N·m of two tensions in N.
    #[inline(always)]
    pub fn torque_of(&self, tensions: [S; 2]) -> S {
        self.arms[0] * tensions[0] - self.arms[1] * tensions[1]
    }
}

/// A joint that two antagonistic actuators turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint<S = f64> {
    limb: Limb<S>,
    tendons: [Tendon<S>; 2],
    torque: S,
    damping: S,
    stops: Stops<S>,
}

impl Joint {
    /// A joint of a limb and the tendons of agonist and antagonist, with a constant `torque` (N·m), viscous `damping`
    /// (N·m·s/rad) and stops.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] for a limb without inertia about the
    /// axis, or when the lower stop is not below the upper.
    pub fn new(limb: Limb, tendons: [Tendon; 2], torque: f64, damping: f64, stops: Stops) -> Result<Self, Error> {
        parameter::MASS.check(limb.mass)?;
        parameter::LIMB_DISTANCE.check(limb.distance)?;
        parameter::LIMB_INERTIA.check(limb.inertia)?;
        parameter::GRAVITY.check(limb.gravity)?;
        parameter::HANGING_ANGLE.check(limb.hanging_angle)?;
        for tendon in tendons {
            tendon.arm.check()?;
            parameter::REST_LENGTH.check(tendon.rest_length)?;
        }
        parameter::JOINT_TORQUE.check(torque)?;
        parameter::JOINT_DAMPING.check(damping)?;
        parameter::STOP_STIFFNESS.check(stops.stiffness)?;
        parameter::STOP_DAMPING.check(stops.damping)?;
        if let Some(angle) = stops.ends[0] {
            parameter::MIN_ANGLE.check(angle)?;
        }
        if let Some(angle) = stops.ends[1] {
            parameter::MAX_ANGLE.check(angle)?;
        }
        if let [Some(low), Some(high)] = stops.ends
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
        let joint = Self { limb, tendons, torque, damping, stops };
        if joint.inertia() > 0.0 {
            return Ok(joint);
        }
        Err(Error::Inconsistent {
            parameter: &parameter::LIMB_INERTIA,
            value: limb.inertia,
            requirement: Requirement {
                relation: "with the mass at its distance must be above",
                other: "the moment of inertia about the axis of",
                value: 0.0,
                unit: "kg*m^2",
            },
            remedy: "give the limb a moment of inertia, or a distance from the axis",
        })
    }
}

/// `dL/dθ` has this sign for the agonist and the antagonist.
pub(crate) const SIGN: [f64; 2] = [-1.0, 1.0];

impl<S: Scalar> Joint<S> {
    /// Converts the joint to another scalar type.
    #[cfg(feature = "alloc")]
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Joint<T> {
        let limb = &self.limb;
        Joint {
            limb: Limb {
                mass: convert.parameter(&parameter::MASS, limb.mass),
                distance: convert.parameter(&parameter::LIMB_DISTANCE, limb.distance),
                inertia: convert.parameter(&parameter::LIMB_INERTIA, limb.inertia),
                gravity: convert.parameter(&parameter::GRAVITY, limb.gravity),
                hanging_angle: convert.parameter(&parameter::HANGING_ANGLE, limb.hanging_angle),
            },
            tendons: core::array::from_fn(|i| {
                let Tendon { arm, rest_length } = &self.tendons[i];
                #[cfg(feature = "alloc")]
                convert.turn_to(Some(crate::plant::Part::Actuator(i)));
                let arm = arm.convert(convert);
                Tendon { arm, rest_length: convert.parameter(&parameter::REST_LENGTH, *rest_length) }
            }),
            torque: {
                #[cfg(feature = "alloc")]
                convert.turn_to(None);
                convert.parameter(&parameter::JOINT_TORQUE, self.torque)
            },
            damping: convert.parameter(&parameter::JOINT_DAMPING, self.damping),
            stops: Stops {
                ends: [
                    self.stops.ends[0].map(|angle| convert.parameter(&parameter::MIN_ANGLE, angle)),
                    self.stops.ends[1].map(|angle| convert.parameter(&parameter::MAX_ANGLE, angle)),
                ],
                stiffness: convert.parameter(&parameter::STOP_STIFFNESS, self.stops.stiffness),
                damping: convert.parameter(&parameter::STOP_DAMPING, self.stops.damping),
            },
        }
    }

    /// The limb.
    pub fn limb(&self) -> &Limb<S> {
        &self.limb
    }

    /// The tendons of agonist and antagonist.
    pub fn tendons(&self) -> &[Tendon<S>; 2] {
        &self.tendons
    }

    /// Constant torque W in N·m.
    pub fn torque(&self) -> S {
        self.torque
    }

    /// Viscous damping c in N·m·s/rad.
    pub fn damping(&self) -> S {
        self.damping
    }

    /// The stops.
    pub fn stops(&self) -> &Stops<S> {
        &self.stops
    }

    /// Moment of inertia J about the axis in kg·m².
    pub fn inertia(&self) -> S {
        let Limb { mass, distance, inertia, .. } = self.limb;
        inertia + mass * distance * distance
    }

    /// Largest torque of gravity `M g d` in N·m.
    pub fn weight(&self) -> S {
        self.limb.mass * self.limb.gravity * self.limb.distance
    }

    /// Where both actuators pull at an angle in rad.
    #[inline(always)]
    pub fn leverage<T: Over<S>>(&self, angle: T) -> Leverage<T> {
        let [[arm, excursion], [other_arm, other_excursion]] =
            self.tendons.each_ref().map(|tendon| tendon.arm.at(angle));
        let [agonist, antagonist] = self.tendons.each_ref().map(|tendon| T::of(tendon.rest_length));
        Leverage { lengths: [agonist - excursion, antagonist + other_excursion], arms: [arm, other_arm] }
    }

    /// Distance in m between the attachments of each actuator at an angle in rad.
    #[inline(always)]
    pub fn lengths<T: Over<S>>(&self, angle: T) -> [T; 2] {
        self.leverage(angle).lengths
    }

    /// What turns the joint besides actuators and stops, in N·m: `W − M g d sin(θ − θ₀) − c ω`.
    #[inline(always)]
    pub fn other_torque<T: Over<S>>(&self, angle: T, angular_velocity: T) -> T {
        let swing = (angle - T::of(self.limb.hanging_angle)).sin();
        T::of(self.torque) - T::of(self.weight()) * swing - T::of(self.damping) * angular_velocity
    }

    /// `K_stop δ + C_stop u` in N·m at the stop of index `end` (0 lower, 1 upper) before it is kept from holding back; zero
    /// where there is none.
    #[inline(always)]
    pub fn stop_torque<T: Over<S>>(&self, end: usize, angle: T, angular_velocity: T) -> T {
        let Some(stop) = self.stops.ends[end] else { return T::zero() };
        let outwards = T::constant(SIGN[end]);
        outwards * (T::of(self.stops.stiffness) * (angle - T::of(stop)) + T::of(self.stops.damping) * angular_velocity)
    }

    /// Energy in J of the limb and of pressed stops: kinetic, and potential against gravity, the constant torque and stops.
    pub fn energy(&self, angle: S, angular_velocity: S) -> S {
        let half = S::constant(0.5);
        let swing = (angle - self.limb.hanging_angle).cos();
        let stored = (0..2).filter_map(|end| {
            let depth = (S::constant(SIGN[end]) * (angle - self.stops.ends[end]?)).larger(S::zero());
            Some(half * self.stops.stiffness * depth * depth)
        });
        let limb = half * self.inertia() * angular_velocity * angular_velocity - self.weight() * swing;
        stored.fold(limb - self.torque * angle, |sum, energy| sum + energy)
    }
}

impl<S: Real> Joint<S> {
    /// The angle in rad at which an actuator, 0 or 1, has a length in m.
    pub(crate) fn angle_at(&self, actuator: usize, length: S) -> S {
        let Tendon { arm, rest_length } = &self.tendons[actuator];
        arm.angle_of(S::constant(SIGN[actuator]) * (length - *rest_length))
    }
}
