//! Everything that steps through time.
//!
//! One program: what the tests share, the engines above all, is compiled once. `cargo test --test runs NAME::` runs one file.

mod common;

mod accuracy;
mod air;
mod bouc_wen;
mod circuit;
mod closed_loop;
mod critical_ratio_of_zero;
mod dense_output_overshoot;
mod events;
mod exhaust;
mod false_descent;
mod fixed_step;
mod force_map;
mod friction;
mod hysteresis;
mod integrator;
mod laws;
mod line_rig;
mod line_step;
mod line_study;
mod line_supply;
mod loose_tolerance;
mod lugre;
mod pressure_series;
mod properties;
mod ramped_rig;
mod regulated_rig;
mod run;
mod segments;
mod simulation;
mod solenoid;
mod spool_rig;
mod stiff;
mod stops;
mod taut_chatter;
mod tendon_control;
mod tendon_located;
mod tendon_rig;
mod viscoelastic;
