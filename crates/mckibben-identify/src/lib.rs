//! From a rig's data to a model: parameters with their uncertainty.
//!
//! | module | what it holds |
//! |---|---|
//! | [`least_squares`] | the values that fit best, how sure they are, and what the data cannot tell apart |
//! | [`ring_down`] | friction from a ring-down, by four estimators |
//! | [`valve`] | flow coefficients of a valve, volume of a tank, delays of a seat |
#![forbid(unsafe_code)]

pub mod least_squares;
mod propagation;
pub mod ring_down;
mod series;
pub mod valve;

pub use series::SeriesError;
