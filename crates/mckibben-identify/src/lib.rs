//! From a rig's data to a model: parameters with their uncertainty.
//!
//! | module | what it holds |
//! |---|---|
//! | [`least_squares`] | the values that fit best, how sure they are, and what the data cannot tell apart |
#![forbid(unsafe_code)]

pub mod least_squares;
