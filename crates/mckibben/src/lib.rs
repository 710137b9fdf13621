#![doc = include_str!("../README.md")]
//!
//! # The equations on one screen
//!
//! ```text
//! geometry   cos θ = L/b                                                              (2)   braid
//!            V = L(b² − L²)/(4πn²)        dV/dL = (b² − 3L²)/(4πn²)                   (20)
//! statics    F_s = Eff(P_g) P_g (3L² − b²)/(4πn²)                                     (3)(9)  force
//!            k = 3 P_g L/(2πn²)                                                       (7)
//! limits     F = 0 below L_min,   + K_braid (x − L_max) + C_braid v above L_max       (10)(14)
//! friction   c v + Q k_sec sgn(v),   k_sec = (F_s(L) − F_s(L_min))/(L − L_min)        (12)(13)  friction
//! load       M dv/dt = M g − F                                                        (15)  load
//! air        dP/dt = γ P (ṁ/m − V̇/V),   and three other processes                    (19)  air
//! valve      ṁ = η A_p C_q P_up C_m(P_down/P_up)/√T_up                                (21)(23)  valve
//! solenoid   opens t_open after the coil, closes t_close after it                     valve
//! pulses     open for d − (t_open − t_close) f of the time                            valve::actual_duty_cycle
//! joints     M(q) q̈ + h(q, q̇) = τ − Σ J_iᵀ F_i                                        mechanism, plant
//! ```
//!
//! `docs/equations.md` leads from each equation of the paper, and from those that it lacks, to a function and a test.
//!
//! # The map
//!
//! | module | what |
//! |---|---|
//! | [`scalar`], [`Dual`] | the numbers that the physics is written over |
//! | [`parameter`] | the one table of parameters |
//! | [`AbsolutePressure`], [`GaugePressure`] | two pressures, two types |
//! | [`Braid`] | geometry |
//! | [`force`] | laws of static force, bladder and wall, effectiveness, length limits |
//! | [`friction`] | viscous and Coulomb friction |
//! | [`air`] | the processes of the air |
//! | [`valve`] | flow law, solenoid, commands |
//! | [`mod@line`] | hose, leak, reservoir, regulator |
//! | [`Actuator`] | all of these composed: valve state in, force out |
//! | [`load`] | what the actuator pulls on |
//! | [`control`] | controllers that sample the state at a stated rate |
//! | [`simulation`] | two ways through time |
//! | [`linearize`] | the rig near an operating point, and the valve under PWM on average |
//! | [`ring_down`] | damping from the peaks of a ring-down |
//!
//! Everything is in SI. Tension is positive; velocity is positive when the actuator lengthens; mass flow is positive
//! into the actuator.

#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

pub mod air;
#[cfg(feature = "alloc")]
pub mod command;
pub mod control;
#[cfg(feature = "alloc")]
pub mod engine;
pub mod force;
pub mod friction;
pub mod limit;
pub mod line;
#[cfg(feature = "alloc")]
pub mod linearize;
pub mod load;
#[cfg(feature = "alloc")]
pub mod mechanism;
#[cfg(feature = "alloc")]
pub mod network;
pub mod parameter;
#[cfg(feature = "alloc")]
pub mod plant;
pub mod ring_down;
pub mod scalar;
pub mod simulation;
pub mod valve;

mod actuator;
mod braid;
mod convert;
mod dual;
mod equilibrium;
mod error;
#[cfg(feature = "alloc")]
mod instantiate;
#[cfg(feature = "alloc")]
pub use instantiate::Instantiate;
#[doc(hidden)]
pub mod internals;
mod nested;
#[cfg(feature = "alloc")]
mod numbered;
mod pressure;
mod root;
mod straight;
mod trigonometry;

pub use actuator::{Actuator, ActuatorState, Response};
pub use braid::Braid;
pub use dual::{DIRECTIONS, Dual, Seeded};
pub use error::{Count, Error, Requirement};
pub use nested::Nested;
pub use pressure::{AbsolutePressure, GaugePressure};
pub use scalar::{Differentiable, Function, Mask, Over, Real, Scalar, Work};
