//! Plants: those of one actuator are their rigs, those of a joint their joints.

mod common;

mod plant_control;
mod plant_dead_time;
mod plant_ends;
mod plant_ledger;
mod plant_linear;
#[cfg(feature = "analysis")]
mod plant_linear_analysis;
mod plant_linear_closed_forms;
mod plant_linear_pulses;
mod plant_of_joint;
mod plant_of_rig;
mod plant_progress;
mod plant_random;
mod plant_reference;
mod plant_refused;
mod plant_sample;
mod plant_sensitivities;
mod plant_span;
mod plant_start_friction;
mod plant_stream;
