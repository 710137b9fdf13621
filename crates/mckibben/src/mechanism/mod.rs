//! Mechanisms: what actuators pull on.
//!
//! A mechanism has generalised coordinates `q` and their rates `q̇`. Each actuator on it spans a distance `x_i(q)`, and its
//! tension `F_i` enters by virtual work:
//!
//! ```text
//! M(q) q̈ + h(q, q̇) = τ(q, q̇) − Σ J_iᵀ F_i          J_i = ∂x_i/∂q,   ẋ_i = J_i q̇
//! ```
//!
//! | mechanism | coordinates | dynamics |
//! |---|---|---|
//! | [`Mechanism::Mass`] | the distance | `M q̈ = W − k (q − q₀) − Σ F_i` (15)(16) |
//! | [`Mechanism::Chain`] | joint angles | a planar chain with gravity, damping, stops and a belt ([`chain`]) |
//! | [`Mechanism::Prescribed`] | the distance | a given function of time |
//! | [`Mechanism::Fixed`] | the distance | at rest |
//! | [`Mechanism::External`] | one distance for each actuator | a host simulator owns the motion |
//!
//! How an actuator spans the mechanism is its [`Coupling`].
//!
//! Source: Colbrunn, Nelson & Quinn (2001), (15) and (16); Lagrange's equations of the second kind. Checked by
//! `tests/simulation.rs`, `tests/joint.rs` and `tests/plant_linear_closed_forms.rs`.

pub mod chain;
pub(crate) mod coupling;
pub mod parameter;

pub use crate::load::Motion;
pub use chain::{Belt, Chain, ChainPowers, ChainSegment, Contact, JointStops, Revolute};
pub use coupling::{Arm, Attachment, Coupling};

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter as table;
use crate::plant::Part;
use crate::scalar::{Over, Scalar};

/// What pulls the attachments of a mass apart, other than a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pull<S = f64> {
    /// Weight under an acceleration in m/s², positive when it stretches the actuators.
    Gravity(S),
    /// A constant force in N, positive when it stretches the actuators.
    Force(S),
}

/// A spring that pulls the mass towards a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring<S = f64> {
    /// Stiffness in N/m.
    pub stiffness: S,
    /// The distance in m at which it is relaxed.
    pub rest_length: S,
}

/// A mass in translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass<S = f64> {
    mass: S,
    pull: Pull<S>,
    spring: Option<Spring<S>>,
    per_mass: S,
}

impl Mass {
    /// A mass in kg under a pull.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a mass that is not above zero, or a pull or spring outside its range.
    pub fn new(mass: f64, pull: Pull, spring: Option<Spring>) -> Result<Self, Error> {
        table::MASS.check(mass)?;
        match pull {
            Pull::Gravity(gravity) => table::GRAVITY.check(gravity)?,
            Pull::Force(force) => table::LOAD_FORCE.check(force)?,
        };
        if let Some(Spring { stiffness, rest_length }) = spring {
            parameter::SPRING_STIFFNESS.check(stiffness)?;
            parameter::SPRING_REST_LENGTH.check(rest_length)?;
        }
        Ok(Self { mass, pull, spring, per_mass: 1.0 / mass })
    }
}

impl<S: Scalar> Mass<S> {
    /// A mass of numbers that have been checked, without a spring.
    pub(crate) fn assemble(mass: S, pull: Pull<S>) -> Self {
        Self { mass, pull, spring: None, per_mass: S::one() / mass }
    }

    /// The mass in kg.
    pub fn mass(&self) -> S {
        self.mass
    }

    /// The constant pull W in N.
    pub fn pull(&self) -> S {
        match self.pull {
            Pull::Gravity(gravity) => self.mass * gravity,
            Pull::Force(force) => force,
        }
    }

    /// The spring, if there is one.
    pub fn spring(&self) -> Option<&Spring<S>> {
        self.spring.as_ref()
    }

    /// `1/M` in 1/kg.
    #[inline(always)]
    pub(crate) fn per_mass(&self) -> S {
        self.per_mass
    }

    /// Force in N on the mass at a distance in m, without the actuators; positive when it stretches them.
    #[inline(always)]
    pub fn force<T: Over<S>>(&self, distance: T) -> T {
        let pull = T::of(self.pull());
        match &self.spring {
            Some(Spring { stiffness, rest_length }) => pull - T::of(*stiffness) * (distance - T::of(*rest_length)),
            None => pull,
        }
    }

    /// Potential energy in J at a distance in m.
    pub fn potential<T: Over<S>>(&self, distance: T) -> T {
        let lifted = -T::of(self.pull()) * distance;
        match &self.spring {
            Some(Spring { stiffness, rest_length }) => {
                let stretch = distance - T::of(*rest_length);
                lifted + T::constant(0.5) * T::of(*stiffness) * stretch * stretch
            }
            None => lifted,
        }
    }

    fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Mass<T> {
        let mass = convert.parameter(&table::MASS, self.mass);
        Mass {
            mass,
            pull: match self.pull {
                Pull::Gravity(gravity) => Pull::Gravity(convert.parameter(&table::GRAVITY, gravity)),
                Pull::Force(force) => Pull::Force(convert.parameter(&table::LOAD_FORCE, force)),
            },
            spring: self.spring.map(|Spring { stiffness, rest_length }| Spring {
                stiffness: convert.parameter(&parameter::SPRING_STIFFNESS, stiffness),
                rest_length: convert.parameter(&parameter::SPRING_REST_LENGTH, rest_length),
            }),
            per_mass: T::one() / mass,
        }
    }
}

/// What one or several actuators pull on.
#[derive(Clone, Debug, PartialEq)]
pub enum Mechanism<S = f64> {
    /// A mass in translation.
    Mass(Mass<S>),
    /// Revolute joints in a planar chain.
    Chain(Chain<S>),
    /// A distance that is given over time.
    Prescribed(Motion<S>),
    /// A distance that stays as it starts.
    Fixed,
    /// Distances that a host simulator gives, one for each actuator.
    External {
        /// How many.
        distances: usize,
    },
}

impl<S: Scalar> Mechanism<S> {
    /// How many generalised coordinates it has.
    pub fn coordinates(&self) -> usize {
        match self {
            Self::Mass(_) | Self::Prescribed(_) | Self::Fixed => 1,
            Self::Chain(chain) => chain.joints().len(),
            Self::External { distances } => *distances,
        }
    }

    /// Whether its motion follows from forces.
    pub fn is_dynamic(&self) -> bool {
        matches!(self, Self::Mass(_) | Self::Chain(_))
    }

    /// The mechanism over another scalar; `index` is its own in the plant.
    pub(crate) fn convert<T: Scalar>(&self, index: usize, convert: &mut impl Convert<S, T>) -> Mechanism<T> {
        convert.turn_to(Some(Part::Mechanism(index)));
        match self {
            Self::Mass(mass) => Mechanism::Mass(mass.convert(convert)),
            Self::Chain(chain) => Mechanism::Chain(chain.convert(index, convert)),
            Self::Prescribed(motion) => Mechanism::Prescribed(motion.convert(convert)),
            Self::Fixed => Mechanism::Fixed,
            Self::External { distances } => Mechanism::External { distances: *distances },
        }
    }

    /// Kinetic and potential energy in J at coordinates and rates: gravity, constant forces, springs, stops and the belt.
    pub fn energies<T: Over<S>>(&self, position: &[T], rate: &[T]) -> [T; 2] {
        match self {
            Self::Mass(mass) => [T::constant(0.5) * T::of(mass.mass) * rate[0] * rate[0], mass.potential(position[0])],
            Self::Chain(chain) => chain.energies(position, rate),
            Self::Prescribed(_) | Self::Fixed | Self::External { .. } => [T::zero(); 2],
        }
    }
}
