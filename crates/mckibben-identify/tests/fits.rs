//! Fits: to made data whose truth is known, and to reference data.
//!
//! One program: what the tests share is compiled and linked once. `cargo test --test fits NAME::` runs one file.

mod noise;

mod dirty_rig;
mod ends;
mod follow;
mod least_squares;
mod loops;
mod plant;
mod ring_down;
mod sensors;
mod statics;
mod step_info;
mod study;
mod trajectories;
mod valve;
