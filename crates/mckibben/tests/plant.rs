//! Plants: those of one actuator are their rigs; a joint is a plant.
//!
//! One program: the engine of plants is compiled once. `cargo test --test plant NAME::` runs one file.

mod common;

mod chain;
mod joint;
mod joint_circuit;
mod joint_control;
mod joint_fittings;
mod joint_located;
mod joint_steps;
mod linearize;
mod linearize_analysis;
mod linearize_joint;
mod linearize_line;
mod linearize_pwm;
mod linearize_tendon;
mod moment_arm;
#[cfg(feature = "analysis")]
mod orbit;
mod plant_control;
mod plant_dead_time;
mod plant_ends;
mod plant_exchange;
mod plant_given_tendon;
mod plant_host;
mod plant_host_pulses;
mod plant_ledger;
mod plant_linear;
#[cfg(feature = "analysis")]
mod plant_linear_analysis;
mod plant_linear_closed_forms;
mod plant_linear_pulses;
mod plant_progress;
mod plant_random;
mod plant_reference;
mod plant_refused;
mod plant_sample;
mod plant_saved;
mod plant_sensitivities;
mod plant_span;
mod plant_start_friction;
mod plant_steps;
mod plant_stream;
