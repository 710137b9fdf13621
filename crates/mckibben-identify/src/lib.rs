//! From a rig's data to a model: parameters with their uncertainty.
//!
//! | module | what it holds |
//! |---|---|
//! | [`adjustable`] | a scenario some of whose numbers are looked for |
//! | [`study`] | measured data: what was measured, and what is wrong with it |
//! | [`statics`] | force maps to any law of static force, with errors where the fit has not looked |
//! | [`loops`] | tension over length to and fro: friction and hysteresis |
//! | [`trajectories`] | any parameters of a scenario from time series |
//! | [`least_squares`] | the values that fit best, how certain they are, and what is not identifiable from the data |
//! | [`ring_down`] | friction from a ring-down, by four estimators |
//! | [`valve`] | flow coefficients of a valve, volume of a tank, delays of a poppet |
#![forbid(unsafe_code)]

pub mod adjustable;
pub mod least_squares;
pub mod loops;
mod median;
mod motion;
mod path;
mod polynomial;
mod propagation;
pub mod ring_down;
mod series;
pub mod statics;
pub mod study;
pub mod trajectories;
pub mod valve;

pub use series::SeriesError;
