//! The run of a joint that two actuators turn: in words, as a log of events and as a figure.

pub(crate) mod control;
pub mod events;
pub mod observation;
pub(crate) mod pair;

/// What the two actuators are called.
pub const NAMES: [&str; 2] = ["agonist", "antagonist"];
