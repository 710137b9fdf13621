//! Many actuators side by side.
pub mod lanes;
