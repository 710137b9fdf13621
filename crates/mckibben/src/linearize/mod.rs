//! One actuator or a joint near an operating point: `dx/dt = A x + B u`, `y = C x + D u`, by exact derivatives.
//!
//! ```text
//! one actuator   x = (δL, δv, δP, δm)                    u = (ṁ, W)            y = (δL, δv, δP, δF)
//! a joint        x = (δθ, δω, δP₁, δm₁, δP₂, δm₂)        u = (ṁ₁, ṁ₂, W)       y = (δθ, δω, δP₁, δP₂, δτ)
//!
//! P (V/m)^κ = const   →   δm = m (V′ δL/V + δP/(κ P))        one state less serves: [`Linearization::minimal`]
//! c_eq = 4 F̄/(π ω X)                                          Coulomb friction at amplitude X, F̄ the mean of F_c s(v)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | L, v, P, m | the four states, as differences from the operating point | m, m/s, Pa, kg |
//! | ṁ | `mass_flow`, into the actuator, in addition to that of the valve | kg/s |
//! | W | `force` or `torque`, on the load, in addition to its own pull; a force is positive when it stretches the actuator | N, N·m |
//! | d | `duty`, as commanded: the first input of a pulsed valve | – |
//! | F, τ | `tension`; torque of both actuators | N, N·m |
//! | ρ F_c | `coulomb_bounds`, Q k_sec in the paper's law | N |
//! | X, ω | `amplitude`, `angular_frequency` | m, rad/s |
//!
//! Both are [plants](crate::plant): their model is that of [`linearize_plant`](crate::plant::linearize_plant), with all that a
//! file says of hoses, leaks, supplies, regulators, tendons, spools and given pressures, in the words of one actuator or of
//! agonist and antagonist. What those add stands behind the states, inputs and outputs above. This module says where the point
//! is: two of pressure, length and load give the third, a stiffness gives a joint's pressures, a command what it makes of both.
//! How far a pulsed valve is described by its mean flow, [`ValveAverage`](crate::plant::ValveAverage) says.
//!
//! Every process but the energy balance keeps `P (V/m)^κ`, whatever the valve does. That is a pole at zero in the four
//! states, which no input reaches; without the air mass as a state it is gone. With the valve held the air itself is
//! an integrator too: a pole at zero that the mass flow does reach.
//!
//! Valid near the point. Sliding without Coulomb friction: under ± ρ F_c the load sticks and no linear model moves it;
//! above, the describing function c_eq has an equal loss in a cycle of amplitude X and the angular frequency ω of the mode in which
//! the actuator takes part most (`PlantLinearization::oscillation`). The point must not be at rest on the
//! shortest length, nor slack. Beyond the longest length the taut braid is part of the model, as long as it stays taut.
//! Under the energy balance ṁ brings air at the supply's temperature; air that leaves takes the actuator's own.
//!
//! Source: differentiation of (12) to (21) of Colbrunn, Nelson & Quinn (2001); c_eq: Gelb & Vander Velde, Multiple-Input
//! Describing Functions (1968), for an ideal relay. Checked by `tests/linearize.rs`, `tests/linearize_pwm.rs`,
//! `tests/linearize_tendon.rs`, `tests/linearize_joint.rs` and `tests/linearize_line.rs`: closed forms, finite differences of
//! simulated trajectories, the invariant's pole.

#[cfg(feature = "analysis")]
mod analysis;
mod state_space;

pub use crate::plant::joint_linear::{JointBalance, JointLinearization, linearize_driven_joint, linearize_joint};
pub use crate::plant::rig_linear::{Aim, Linearization, linearize, linearize_driven};
pub use crate::plant::rig_point::{Balance, Content, OperatingPoint};
pub use crate::valve::Interval;
#[cfg(feature = "analysis")]
pub(crate) use analysis::UsualSize;
#[cfg(feature = "analysis")]
pub use analysis::{Controllability, Phasor, Pole};
pub use state_space::{Signal, StateSpace};

use crate::parameter::{Parameter, Range};

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
