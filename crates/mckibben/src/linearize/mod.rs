//! The rig near an operating point: `dx/dt = A x + B u`, `y = C x + D u`, by exact derivatives.
//!
//! ```text
//! x = (δL, δv, δP, δm)        A = ∂f/∂x, B = ∂f/∂u of the four rates f        C = ∂g/∂x, D = ∂g/∂u of the outputs g
//!
//! held valve     f by the flow that is given:      u = (ṁ, W)
//! averaged PWM   f by the mean flow of a period:   u = (d, ṁ, W)
//!
//! P (V/m)^κ = const   →   δm = m (V′ δL/V + δP/(κ P))        one state less serves: [`Linearization::minimal`]
//! c_eq = 4 Q k_sec/(π ω X)                                    Coulomb friction at amplitude X
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | L, v, P, m | the four states, as differences from the operating point | m, m/s, Pa, kg |
//! | ṁ | `mass_flow`, into the actuator, beside that of the valve | kg/s |
//! | W | `force`, on the load, beside its own pull; positive when it stretches the actuator | N |
//! | d | `duty`, as commanded | – |
//! | L, v, P, F | the outputs, F the tension | m, m/s, Pa, N |
//! | Q k_sec | `coulomb_bound` | N |
//! | X, ω | `amplitude`, `angular_frequency` | m, rad/s |
//!
//! Nothing here is differentiated by hand: the rates are those of the simulation, evaluated at dual numbers.
//!
//! Every process but the energy balance keeps `P (V/m)^κ`, whatever the valve does. That is a pole at zero in the four
//! states, which no input reaches; without the air mass as a state it is gone. With the valve held the air itself is
//! an integrator too: a pole at zero that the mass flow does reach.
//!
//! Valid near the point. Sliding without Coulomb friction: under ± Q k_sec the load sticks and no linear model moves it;
//! above, the describing function c_eq has the same loss in a cycle of amplitude X. The point must not be at rest on the
//! shortest length, nor slack. Beyond the longest length the taut braid is part of the model, as long as it stays taut.
//! Under the energy balance ṁ brings air at the supply's temperature; air that leaves takes the actuator's own.
//!
//! Source: differentiation of (12) to (21) of Colbrunn, Nelson & Quinn (2001); c_eq: Gelb & Vander Velde, Multiple-Input
//! Describing Functions (1968), for an ideal relay. Checked by `tests/linearize.rs`: closed forms of a sealed and of a
//! held pressure, finite differences of simulated trajectories, the invariant's pole.

#[cfg(feature = "analysis")]
mod analysis;
mod averaged;
mod joint;
mod point;
mod rates;
mod state_space;
mod tendon;

pub use crate::valve::Interval;
#[cfg(feature = "analysis")]
pub use analysis::{Controllability, Phasor, Pole};
pub use averaged::{Aim, Averaged, average};
pub use joint::{JointBalance, JointLinearization, average_joint, linearize_joint};
pub use point::{Balance, Content, OperatingPoint};
pub use state_space::{Signal, StateSpace};

use crate::dual::Dual;
use crate::error::Error;
use crate::parameter::{Parameter, Range};
use crate::simulation::Rig;
use alloc::vec::Vec;
use core::f64::consts::PI;

/// A rig near an operating point.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// Where.
    pub point: OperatingPoint,
    /// All states that can move: the four, or pressure and air mass where both ends are held; on a tendon the load's beside the
    /// actuator's.
    pub system: StateSpace,
    /// The valve's mean flow, if that is part of the model.
    pub averaged: Option<Averaged>,
}

/// Linearises a rig with its valve held shut; the mass flow is an input.
///
/// # Errors
/// As [`OperatingPoint::held`].
pub fn linearize(rig: &Rig, balance: Balance, content: Content) -> Result<Linearization, Error> {
    let point = OperatingPoint::held(rig, balance, content)?;
    Ok(Linearization::at(point, None, 0.0))
}

impl Linearization {
    fn at(point: OperatingPoint, averaged: Option<Averaged>, viscous: f64) -> Self {
        let seats = averaged.as_ref().map_or(Vec::new(), |averaged| averaged.seats(rates::DUTY));
        let system = rates::derivatives(&point, &seats, viscous, averaged.is_some());
        Self { point, system, averaged }
    }

    /// The same with Coulomb friction replaced by the viscous damping that takes as much energy from an oscillation of
    /// `amplitude` (m) at `angular_frequency` (rad/s), both above zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn with_equivalent_damping(&self, amplitude: f64, angular_frequency: f64) -> Result<Self, Error> {
        let viscous = self.equivalent_damping(amplitude, angular_frequency)?;
        Ok(Self::at(self.point.clone(), self.averaged.clone(), viscous))
    }

    /// `c_eq` in N·s/m, for an oscillation of `amplitude` (m) at `angular_frequency` (rad/s), both above zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn equivalent_damping(&self, amplitude: f64, angular_frequency: f64) -> Result<f64, Error> {
        let (amplitude, frequency) = (AMPLITUDE.check(amplitude)?, ANGULAR_FREQUENCY.check(angular_frequency)?);
        Ok(4.0 * self.point.coulomb_bound() / (PI * frequency * amplitude))
    }

    /// The model without the air mass, where the process keeps `P (V/m)^κ` and the air mass follows from pressure and
    /// length: the same inputs, outputs and poles, less the invariant's at zero. Under the energy balance all states are
    /// needed, and this is the whole model.
    pub fn minimal(&self) -> StateSpace {
        let (rig, state) = (&self.point.rig, &self.point.state);
        if !point::keeps_content(rig) {
            return self.system.clone();
        }
        let follow: Dual<f64, 2> = point::mass_of_content(
            rig.actuator(),
            state,
            Dual::variable(state.length, 0),
            Dual::variable(state.pressure.0, 1),
        );
        let system = &self.system;
        // The length may be a state, or follow from others, or be held.
        let of_length = system.output("length").map(|row| &system.c[row]);
        let per_state = |name: &str| {
            let column = system.states.iter().position(|signal| signal.name == name);
            let by_length = of_length.zip(column).map_or(0.0, |(row, column)| follow.slope[0] * row[column]);
            if name == "pressure" { follow.slope[1] + by_length } else { by_length }
        };
        system.without("air_mass", per_state)
    }
}

pub(crate) static AMPLITUDE: Parameter = Parameter {
    key: "linearize.amplitude",
    symbol: "X",
    unit: "m",
    range: Range::POSITIVE,
    default: None,
    meaning: "Amplitude of the oscillation whose loss to Coulomb friction is to be met.",
    source: "definition",
    remedy: "give an amplitude above zero",
};

pub(crate) static ANGULAR_FREQUENCY: Parameter = Parameter {
    key: "linearize.angular_frequency",
    symbol: "ω",
    unit: "rad/s",
    range: Range::POSITIVE,
    default: None,
    meaning: "Angular frequency of that oscillation.",
    source: "definition",
    remedy: "give a frequency above zero, such as that of the model's lightly damped poles",
};
