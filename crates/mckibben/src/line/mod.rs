//! The air line: what lies between a source of air and the actuator.
//!
//! ```text
//!   compressor → reservoir → regulator → valve → hose → actuator → leak
//! ```
//!
//! Every part may be left out; without any of them the valve joins the actuator to a supply of constant pressure.
//!
//! | part | what it adds | where |
//! |---|---|---|
//! | [`Hose`], lumped | a second volume, a friction loss, a delay: one state | both engines, batches |
//! | [`Hose`], distributed | waves: two states for each cell | both engines, batches |
//! | [`Leakage`] | a laminar flow from the actuator to the atmosphere | both engines, batches |
//! | [`Reservoir`], [`Compressor`] | a supply that sags, and is filled up between two pressures: one state | both engines, batches |
//! | [`Regulator`] | droop, dead band and lag: one state | both engines, batches |
//!
//! [`Tube`] is the friction law of a hose and [`linear`] the closed form that a distributed hose approaches.
//! `docs/air-line.md` says when to choose what. Several actuators
//! on one supply are a [plant](crate::plant).

mod friction;
mod hose;
mod leakage;
pub mod linear;
mod regulator;
mod reservoir;
mod supply;

pub use friction::{FlowRegime, LAMINAR_END, TURBULENT_START, Tube, drive_at, reynolds_at};
pub use hose::{Hose, HoseKind, MAX_CELLS};
pub use leakage::Leakage;
#[cfg(feature = "alloc")]
pub(crate) use leakage::split;
pub use regulator::{Poppet, Regulator};
pub use reservoir::{Compressor, Reservoir};
pub use supply::SupplyLine;

use crate::convert::Convert;
use crate::scalar::Scalar;

/// The parts of an air line that a rig has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<S = f64> {
    /// The hose from the valve to the actuator.
    pub hose: Option<Hose<S>>,
    /// The leak of the actuator.
    pub leakage: Option<Leakage<S>>,
    /// What feeds the valve, where that is not a supply of constant pressure.
    pub supply: Option<SupplyLine<S>>,
}

impl<S> Line<S> {
    /// No part at all.
    pub const NONE: Self = Self { hose: None, leakage: None, supply: None };

    /// Whether there is no part at all.
    pub fn is_none(&self) -> bool {
        self.hose.is_none() && self.leakage.is_none() && self.supply.is_none()
    }
}

impl<S: Scalar> Line<S> {
    /// Converts the air line to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Line<T> {
        Line {
            hose: self.hose.as_ref().map(|hose| hose.convert(convert)),
            leakage: self.leakage.as_ref().map(|leakage| leakage.convert(convert)),
            supply: self.supply.as_ref().map(|supply| supply.convert(convert)),
        }
    }
}
