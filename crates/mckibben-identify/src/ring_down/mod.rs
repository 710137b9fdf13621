//! Friction from a ring-down: Q and c by four estimators, each with its 95 % interval.
//!
//! A mass that hangs on a sealed actuator is pulled out of its rest position and let go; its length is recorded.
//!
//! | estimator | from | assumes |
//! |---|---|---|
//! | [`Estimator::PaperTwoCycles`] | the first and the last cycle, (25)–(31) | linear spring, small damping |
//! | [`Estimator::ExactTwoCycles`] | the same two cycles, exact recursion | linear spring |
//! | [`Estimator::AllTurns`] | every peak and trough, least squares | a spring that is nearly linear |
//! | [`Estimator::Waveform`] | every sample, least squares on the simulated trajectory | the actuator is known |
//!
//! ```no_run
//! use mckibben::simulation::{Initial, Rig};
//! use mckibben_identify::ring_down::{Free, Record, RingDownError, compare};
//!
//! fn friction(time: Vec<f64>, length: Vec<f64>, rig: &Rig, start: &Initial) -> Result<(), RingDownError> {
//!     let comparison = compare(&Record::new(time, length)?, 2.7, Some((rig, start, Free::ALL)))?;
//!     for row in &comparison.rows {
//!         println!("{:?}: c = {} N s/m, {:?}", row.estimator, row.viscous.value, row.viscous.confidence_interval);
//!     }
//!     Ok(())
//! }
//! ```
//!
//! What the first three show is the Q of an equal linear spring. The friction of (12) is `Q k_sec` while the mass feels the
//! tangent stiffness `k_t` with the valve shut, so the Q of (12) is [`Restoring::law_width`] of what they show.
//!
//! How the intervals come about is said where each estimator stands: [`Decrement`] and [`Waveform`].
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.3; the equations are in [`mckibben::ring_down`]. Checked by
//! `tests/ring_down.rs`: closed form of the oscillator, how often intervals hold the truth, and every refusal.

mod compare;
mod decrement;
mod record;
mod turns;
mod waveform;

pub use compare::{Comparison, Estimator, Row, compare};
pub use decrement::{Decrement, Equivalent};
pub use record::Record;
pub use turns::{Turn, Turns};
pub use waveform::{Free, Restoring, Waveform};

use crate::least_squares::FitError;
use crate::series::SeriesError;
use thiserror::Error;

/// Why no friction can be estimated from a ring-down.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RingDownError {
    /// The samples are no series.
    #[error(transparent)]
    Series(#[from] SeriesError),
    /// Peaks are cut off.
    #[error(
        "{samples} samples from {time} s on are all {limit} m, the end of the range: the sensor is saturated; release the \
         mass less far out, or move the sensor"
    )]
    Saturated {
        /// The value at which it stays, in m.
        limit: f64,
        /// For how many samples in a row.
        samples: usize,
        /// From when on, in s.
        time: f64,
    },
    /// The record has less than two cycles.
    #[error(
        "the record has {turns} peaks and troughs, and two cycles have {least}; record longer, or release the mass farther \
         out so that the swings stand out from the noise"
    )]
    TooFewTurns {
        /// How many were found.
        turns: usize,
        /// How many it takes.
        least: usize,
    },
    /// The mass came to rest before it had swung twice.
    #[error(
        "the mass stuck near {time} s after {turns} peaks and troughs, before two cycles; release it farther out, or hang \
         up a heavier one"
    )]
    Stuck {
        /// How many were found.
        turns: usize,
        /// When the last was, in s.
        time: f64,
    },
    /// The record begins before the release.
    #[error("the mass is still held at {time} s; begin the record at its release")]
    Held {
        /// The first time of the record in s.
        time: f64,
    },
    /// Two masses for one.
    #[error("the mass is given as {given} kg, but {hung} kg hang from the rig; give the same")]
    Mass {
        /// As given in kg.
        given: f64,
        /// The rig's in kg.
        hung: f64,
    },
    /// The samples are too far apart to see a peak.
    #[error("there are {samples} samples in a cycle of {period} s; sample at least twenty times a cycle")]
    TooCoarse {
        /// How many there are about a turn.
        samples: usize,
        /// The period in s.
        period: f64,
    },
    /// The rig has nothing that could ring down.
    #[error("the rig cannot ring down: {what}")]
    Rig {
        /// What is missing, and what to do.
        what: &'static str,
    },
    /// The amplitudes fit no damping, or a parameter is outside its range.
    #[error(transparent)]
    Physics(#[from] mckibben::Error),
    /// Nothing fits.
    #[error(transparent)]
    Fit(#[from] FitError),
}
