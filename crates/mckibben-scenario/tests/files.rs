//! Scenario files: what they may say, and what is made of them.
//!
//! One program: what the tests share is compiled and linked once. `cargo test --test files NAME::` runs one file.

mod controller;
mod diagnostics;
mod each_parameter;
mod force;
mod friction;
mod joint_fittings;
mod moving_valves;
mod muscle;
mod place;
mod plant;
mod quantity;
mod regulator;
mod scenario;
mod sweep;
mod tables;
mod tendon;
mod valves;
