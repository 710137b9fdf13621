//! A joint that two antagonistic actuators turn about a pulley each.
//!
//! ```text
//! J dω/dt = r₁ F₁ − r₂ F₂ + W − M g d sin(θ − θ₀) − c ω − S        J = I + M d²
//! L₁ = ℓ₁ − r₁ θ        L₂ = ℓ₂ + r₂ θ
//! S = max(0, K_stop δ + C_stop u)  at a stop that is passed by δ and pressed at the rate u, against it
//! ```
//!
//! The first actuator, the agonist, turns the joint towards greater angles, the second, the antagonist, back. A stop
//! never holds the limb back on rebound, as the taut braid (14).
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | θ, ω | `angle`, `angular_velocity` | rad, rad/s |
//! | r, ℓ | `radius`, `rest_length`, the distance between the attachments at angle zero | m |
//! | M, d | `mass`, `distance` of the centre of mass from the axis | kg, m |
//! | I, J | `inertia` about the centre of mass, and about the axis | kg·m² |
//! | g, θ₀ | `gravity`, `hanging_angle` at which the limb hangs straight down | m/s², rad |
//! | W | `torque`, constant | N·m |
//! | c | `damping` | N·m·s/rad |
//! | K_stop, C_stop | `stiffness`, `damping` of the stops | N·m/rad, N·m·s/rad |
//!
//! Source: elementary mechanics. Checked by `tests/joint.rs`.

use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::scalar::{Over, Scalar};

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

/// The pulley of one actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulley<S = f64> {
    /// Radius r in m.
    pub radius: S,
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

/// A joint that two antagonistic actuators turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint<S = f64> {
    limb: Limb<S>,
    pulleys: [Pulley<S>; 2],
    torque: S,
    damping: S,
    stops: Stops<S>,
}

impl Joint {
    /// A joint of a limb and the pulleys of agonist and antagonist, with a constant `torque` (N·m), viscous `damping`
    /// (N·m·s/rad) and stops.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] for a limb without inertia about the
    /// axis, or when the lower stop is not below the upper.
    pub fn new(limb: Limb, pulleys: [Pulley; 2], torque: f64, damping: f64, stops: Stops) -> Result<Self, Error> {
        parameter::MASS.check(limb.mass)?;
        parameter::LIMB_DISTANCE.check(limb.distance)?;
        parameter::LIMB_INERTIA.check(limb.inertia)?;
        parameter::GRAVITY.check(limb.gravity)?;
        parameter::HANGING_ANGLE.check(limb.hanging_angle)?;
        for pulley in pulleys {
            parameter::PULLEY_RADIUS.check(pulley.radius)?;
            parameter::REST_LENGTH.check(pulley.rest_length)?;
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
        let joint = Self { limb, pulleys, torque, damping, stops };
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
    /// The same joint over another scalar.
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
            pulleys: self.pulleys.map(|pulley| Pulley {
                radius: convert.parameter(&parameter::PULLEY_RADIUS, pulley.radius),
                rest_length: convert.parameter(&parameter::REST_LENGTH, pulley.rest_length),
            }),
            torque: convert.parameter(&parameter::JOINT_TORQUE, self.torque),
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

    /// The pulleys of agonist and antagonist.
    pub fn pulleys(&self) -> &[Pulley<S>; 2] {
        &self.pulleys
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

    /// Distance in m between the attachments of each actuator at an angle.
    #[inline(always)]
    pub fn lengths<T: Over<S>>(&self, angle: T) -> [T; 2] {
        let arms = self.slopes();
        core::array::from_fn(|i| T::of(self.pulleys[i].rest_length) + T::of(arms[i]) * angle)
    }

    /// `dL/dθ` of each actuator in m: `−r₁` and `r₂`.
    #[inline(always)]
    pub fn slopes(&self) -> [S; 2] {
        [-self.pulleys[0].radius, self.pulleys[1].radius]
    }

    /// The angle in rad at which an actuator, 0 or 1, has a length in m.
    pub(crate) fn angle_at(&self, actuator: usize, length: S) -> S {
        (length - self.pulleys[actuator].rest_length) / self.slopes()[actuator]
    }

    /// Torque in N·m of two tensions in N.
    #[inline(always)]
    pub fn torque_of<T: Over<S>>(&self, tensions: [T; 2]) -> T {
        T::of(self.pulleys[0].radius) * tensions[0] - T::of(self.pulleys[1].radius) * tensions[1]
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
