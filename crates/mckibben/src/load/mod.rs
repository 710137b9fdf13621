//! What the actuator pulls on.
//!
//! ```text
//! hanging mass     M dv/dt = M g − F       (15)(16)
//! constant force   M dv/dt = W − F
//! isometric        v = 0
//! prescribed       x = x(t)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | M | `mass` | kg |
//! | g | `gravity` | m/s², positive when it stretches the actuator |
//! | W | `pull` | N, positive when it stretches the actuator |
//! | F | tension | N, positive when the actuator pulls |
//!
//! A [`Joint`] is turned by two actuators, so it is no [`Load`] of one.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), (15) and (16). Checked by `tests/simulation.rs`.

mod joint;
mod moment_arm;
mod motion;
mod series_tendon;

pub(crate) use joint::SIGN;
pub use joint::{Joint, Leverage, Limb, Stops, Tendon};
pub use moment_arm::{ArmTable, MAX_ARMS, MomentArm};
pub use motion::Motion;
pub use series_tendon::SeriesTendon;

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Scalar};

/// What the actuator pulls on.
#[derive(Clone, Debug, PartialEq)]
pub enum Load<S = f64> {
    /// A mass that hangs from the actuator.
    HangingMass {
        /// Mass in kg.
        mass: S,
        /// Gravity in m/s².
        gravity: S,
    },
    /// A mass that a constant force pulls away.
    ConstantForce {
        /// Mass in kg.
        mass: S,
        /// Force in N.
        force: S,
    },
    /// Both ends are held where they start.
    Isometric,
    /// The distance between the attachments is a function of time.
    Prescribed(Motion<S>),
}

/// The inertia and the pull of a load that moves freely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia<S = f64> {
    /// Mass in kg.
    pub mass: S,
    /// Force in N that stretches the actuator.
    pub pull: S,
}

impl<S: Scalar> Inertia<S> {
    /// Acceleration of lengthening in m/s² against a tension in N, (16).
    #[inline(always)]
    pub fn acceleration<T: Over<S>>(&self, tension: T) -> T {
        (T::of(self.pull) - tension) * T::of(S::one() / self.mass)
    }
}

impl Load {
    /// A hanging `mass` (kg, above zero) under `gravity` (m/s²).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn hanging_mass(mass: f64, gravity: f64) -> Result<Self, Error> {
        Ok(Self::HangingMass { mass: parameter::MASS.check(mass)?, gravity: parameter::GRAVITY.check(gravity)? })
    }

    /// A `mass` (kg, above zero) pulled by a constant `force` (N, positive when it stretches the actuator).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn constant_force(mass: f64, force: f64) -> Result<Self, Error> {
        Ok(Self::ConstantForce { mass: parameter::MASS.check(mass)?, force: parameter::LOAD_FORCE.check(force)? })
    }
}

impl<S: Scalar> Load<S> {
    /// Converts the load to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Load<T> {
        match self {
            Self::HangingMass { mass, gravity } => Load::HangingMass {
                mass: convert.parameter(&parameter::MASS, *mass),
                gravity: convert.parameter(&parameter::GRAVITY, *gravity),
            },
            Self::ConstantForce { mass, force } => Load::ConstantForce {
                mass: convert.parameter(&parameter::MASS, *mass),
                force: convert.parameter(&parameter::LOAD_FORCE, *force),
            },
            Self::Isometric => Load::Isometric,
            Self::Prescribed(motion) => Load::Prescribed(motion.convert(convert)),
        }
    }

    /// The prescribed motion, if it is one.
    pub fn motion(&self) -> Option<&Motion<S>> {
        match self {
            Self::Prescribed(motion) => Some(motion),
            _ => None,
        }
    }

    /// Mass and pull; `None` when the motion is given.
    #[inline(always)]
    pub fn inertia(&self) -> Option<Inertia<S>> {
        match self {
            Self::HangingMass { mass, gravity } => Some(Inertia { mass: *mass, pull: *mass * *gravity }),
            Self::ConstantForce { mass, force } => Some(Inertia { mass: *mass, pull: *force }),
            Self::Isometric | Self::Prescribed(_) => None,
        }
    }
}
