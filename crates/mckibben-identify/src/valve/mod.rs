//! Flow coefficients and delays of a valve from measurements.
//!
//! | from | gives | where |
//! |---|---|---|
//! | steady flow | efficiency η or flow coefficient C_q of (22) | [`efficiency`], [`flow_coefficient`] |
//! | a flow curve | C and b of ISO 6358-1 | [`FlowCurve`] |
//! | a tank that is charged or discharged | C and b as ISO 6358-2 does, or by the trajectory; the tank's volume | [`Tank`] |
//! | the pressure under a pulse train | delays of the poppet, effective duty | [`Delays`], [`delay_difference`] |
//!
//! Pressures are absolute. The flow law, the air and its processes are the core's. Every result has a 95 % interval from
//! the scatter of the measurements about the model: it holds their noise, not an error of a gauge.
//!
//! Left out: the subsonic index and the cracking pressure, with which ISO 6358-1:2013 describes other shapes of curve; the
//! core's law is the quarter ellipse.
//!
//! Checked by `tests/valve.rs`: how often intervals hold the truth, closed forms, and every refusal.

mod delays;
mod flow_curve;
mod steady;
mod tank;

pub use delays::{Delays, DutyPoint, Onset, PulseTrain, Windows, delay_difference};
pub use flow_curve::FlowCurve;
pub use steady::{Efficiency, Scatter, SteadyPoint, efficiency, flow_coefficient};
pub use tank::{Tank, TankFit, TankRecord, TankUnknown, Transfer};

use crate::least_squares::FitError;
use crate::series::SeriesError;
use thiserror::Error;

/// Why nothing of a valve can be estimated from measurements.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ValveError {
    /// The samples are no series.
    #[error(transparent)]
    Series(#[from] SeriesError),
    /// Fewer points than it takes.
    #[error("there are {points} points of steady flow; it takes at least {least}: measure more")]
    TooFewPoints {
        /// How many there are.
        points: usize,
        /// The least number that will do.
        least: usize,
    },
    /// A number that cannot be what it is said to be.
    #[error("{what} of point {point} is {value} {unit}, {problem}; {remedy}")]
    Implausible {
        /// What it is.
        what: &'static str,
        /// Which point or sample, counted from 1.
        point: usize,
        /// Its value in its unit.
        value: f64,
        /// The SI unit it is taken in.
        unit: &'static str,
        /// What is wrong with it.
        problem: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// No point at or below the critical ratio.
    #[error(
        "no point is choked: the least pressure ratio is {least}, the critical one about {critical}; C is not identifiable. Measure with a \
         higher upstream or a lower downstream pressure"
    )]
    NoChoked {
        /// The least ratio of downstream to upstream pressure.
        least: f64,
        /// The critical ratio that fits best.
        critical: f64,
    },
    /// No point where the downstream pressure counts.
    #[error(
        "all points are choked: the flow over the upstream pressure is the same up to the largest pressure ratio, {largest}; \
         b is not identifiable. Measure with a higher downstream pressure"
    )]
    NoSubsonic {
        /// The largest ratio of downstream to upstream pressure.
        largest: f64,
    },
    /// A critical ratio that no flow path has.
    #[error(
        "the critical ratio comes out as {value}, outside 0 to 1; check the units, and that both pressures are absolute: a gauge \
         pressure lacks the atmosphere's{}",
        line_of(*value)
    )]
    CriticalRatio {
        /// What came out.
        value: f64,
    },
    /// The pressure does not answer to the coil.
    #[error(
        "the pressure does not respond after any of {edges} times the coil was {coil}; check the times of the command, that \
         the pulses are longer than the delay, and the noise"
    )]
    NoOnset {
        /// `energised` or `released`.
        coil: &'static str,
        /// How often it was.
        edges: usize,
    },
    /// Too few samples between the edges to see the pressure answer.
    #[error(
        "only {samples} samples of the pressure lie between the middle of the pause before the coil was {coil} and the next edge, at {coarse} of \
         {edges} times, and it takes {least} to see when the pressure responds; sample at {} Hz or more, or pulse more slowly",
        rate.ceil()
    )]
    Coarse {
        /// `energised` or `released`.
        coil: &'static str,
        /// How often it was.
        edges: usize,
        /// At how many of these there are too few.
        coarse: usize,
        /// The most that there are at one of these.
        samples: usize,
        /// How many it takes.
        least: usize,
        /// The rate in Hz at which there are as many.
        rate: f64,
    },
    /// A request that has no answer.
    #[error("{what}; {remedy}")]
    Misuse {
        /// What was requested.
        what: &'static str,
        /// What to do instead.
        remedy: &'static str,
    },
    /// A parameter outside its range, or a simulation that stopped.
    #[error(transparent)]
    Physics(#[from] mckibben::Error),
    /// Nothing fits.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// What a critical ratio below zero is the signature of.
fn line_of(value: f64) -> &'static str {
    match value < 0.0 {
        true => {
            ". Below 0 a flow falls with every rise of the downstream pressure, as through a line: measure the pressures at the valve \
             itself, or describe the line by [hose]"
        }
        false => "",
    }
}
