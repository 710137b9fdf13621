//! What controllers have decided.

use crate::control::{Drive, JointMeasurement, Measurement, Quantity};
use crate::error::Error;

/// What a controller saw at a sampling instant and what it decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision<R = f64> {
    /// What the sensors showed; its time is the sampling instant.
    pub seen: Measurement<R>,
    /// What the controller tried to reach and in which quantity, if it has such an aim.
    pub aim: Option<(Quantity, R)>,
    /// What the valve is to do once the decision takes effect.
    pub drive: Drive<R>,
}

/// What a controller of a joint saw at a sampling instant and what it decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointDecision<R = f64> {
    /// What the sensors showed; its time is the sampling instant.
    pub seen: JointMeasurement<R>,
    /// What the controller tried to reach and in which quantity, for the joint or for agonist and antagonist.
    pub aim: [Option<(Quantity, R)>; 2],
    /// What the valves of agonist and antagonist are to do once the decision takes effect.
    pub drive: [Drive<R>; 2],
}

/// The valve that a controller drives, which must have seats.
///
/// # Errors
/// [`Error::Misuse`] when there is no valve, or one without seats.
pub(crate) fn with_poppets<V>(valve: Option<V>, has_poppets: impl FnOnce(&V) -> bool) -> Result<V, Error> {
    match valve {
        None => Err(Error::Misuse {
            what: "a controller is given, but the actuator has no valve",
            remedy: "give the actuator a valve, or simulate it without a controller",
        }),
        Some(valve) if has_poppets(&valve) => Ok(valve),
        Some(_) => Err(Error::Misuse {
            what: "a controller drives the seats of a valve, and a pressure regulator or a proportional spool has none",
            remedy: "choose a valve such as valve.kind = \"three-way\", or give set points or positions",
        }),
    }
}
