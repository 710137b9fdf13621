//! What an actuator of a joint has in addition to its valve: its air line, an elastic tendon, a pressure that is given
//! over time.
//!
//! A joint with any of these is run as a plant: see [`JointPlant`](crate::plant::JointPlant).

#[cfg(feature = "alloc")]
use super::Driven;
use super::JointRig;
#[cfg(feature = "alloc")]
use crate::convert::Convert;
#[cfg(feature = "alloc")]
use crate::error::Error;
use crate::line::{Line, SupplyLine};
#[cfg(feature = "alloc")]
use crate::load::Joint;
use crate::load::SeriesTendon;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::{Real, Scalar};
use crate::simulation::pressure_series::PressureSeries;
#[cfg(feature = "alloc")]
use crate::simulation::rig::check_line;

/// What an actuator of a joint has in addition to its valve.
#[derive(Clone, Debug, PartialEq)]
pub struct Fittings<S = f64> {
    /// Its hose, its leak, and the reservoir and regulator of its supply.
    pub line: Line<S>,
    /// The elastic tendon between the actuator and the joint.
    pub tendon: Option<SeriesTendon<S>>,
    /// Its gauge pressure over time, or that at the inlet of its hose if it has one, in place of a valve.
    pub pressure: Option<PressureSeries<S>>,
}

impl<S> Fittings<S> {
    /// None at all: the valve joins the actuator to a supply of constant pressure.
    pub const NONE: Self = Self { line: Line::NONE, tendon: None, pressure: None };
}

#[cfg(feature = "alloc")]
impl<S: Scalar> Fittings<S> {
    /// These over another scalar.
    pub(super) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Fittings<T> {
        Fittings {
            line: self.line.convert(convert),
            tendon: self.tendon.as_ref().map(|tendon| tendon.convert(convert)),
            pressure: self.pressure.as_ref().map(|series| series.convert(convert)),
        }
    }
}

/// What the two actuators of a joint draw from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointSupply {
    /// Each has a separate supply.
    Separate,
    /// One reservoir, regulator or both feed the two.
    Shared,
}

#[cfg(feature = "alloc")]
impl JointRig {
    /// A joint with its agonist and its antagonist and what these have in addition to their valves. The reservoir and
    /// regulator of a [shared](JointSupply::Shared) supply are the agonist's; with N for its
    /// [number of actuators](SupplyLine::actuators), N such joints draw from it.
    ///
    /// # Errors
    /// As [`JointRig::new`]; [`Error::Misuse`] for a hose or a supply without a valve, a pressure that is given in
    /// addition to a valve or a leak, and a shared supply that the antagonist states again or states otherwise;
    /// [`Error::Inconsistent`] for a pressure below vacuum; [`Error::NotImplemented`] for a reservoir or a regulator
    /// before a valve that makes a pressure itself.
    pub fn fitted(
        driven: [Driven; 2],
        joint: Joint,
        fittings: [Fittings; 2],
        supply: JointSupply,
    ) -> Result<Self, Error> {
        let shared = match supply {
            JointSupply::Separate => None,
            JointSupply::Shared => fittings[0].line.supply,
        };
        if supply == JointSupply::Shared && fittings[1].line.supply.is_some() {
            return Err(Error::Misuse {
                what: "one supply feeds both actuators of a joint, and the antagonist is given another",
                remedy: "give the antagonist none, or each its own",
            });
        }
        for (Driven { actuator, actuation }, Fittings { line, pressure, .. }) in driven.iter().zip(&fittings) {
            // Of a shared supply the one that has a valve draws.
            let own = if shared.is_some() { None } else { line.supply };
            let line = Line { supply: own, ..*line };
            match pressure {
                Some(series) => series.check(actuator, &line)?,
                None => check_line(actuator, actuation.as_ref(), &line)?,
            }
        }
        if shared.is_some() {
            check_shared(&driven, shared)?;
        }
        Self { driven, joint, fittings, supply }.checked()
    }
}

/// Checks that a valve draws from the shared supply, and that it has one pressure and one temperature.
#[cfg(feature = "alloc")]
fn check_shared(driven: &[Driven; 2], shared: Option<SupplyLine>) -> Result<(), Error> {
    let valves = || driven.iter().filter_map(|of| Some((of, of.actuator.valve()?)));
    for (Driven { actuator, actuation }, _) in valves() {
        check_line(actuator, actuation.as_ref(), &Line { supply: shared, ..Line::NONE })?;
    }
    let mut supplies = valves().map(|(_, valve)| valve.supply);
    match (supplies.next(), supplies.next()) {
        (None, _) => Err(Error::Misuse {
            what: "a reservoir or a regulator is given, but neither actuator of the joint has a valve",
            remedy: "give an actuator a valve, or leave the supply out",
        }),
        (Some(first), Some(second)) if first != second => Err(Error::Misuse {
            what: "one supply feeds both actuators of a joint, and their valves have it at different pressures or \
                   temperatures",
            remedy: "give both valves the same supply, or each actuator its own",
        }),
        _ => Ok(()),
    }
}

impl<S: Scalar> JointRig<S> {
    /// What agonist and antagonist have in addition to their valves.
    pub fn fittings(&self) -> &[Fittings<S>; 2] {
        &self.fittings
    }

    /// The supply that both draw from, where it is one whose pressure changes.
    pub fn shared_supply(&self) -> Option<&SupplyLine<S>> {
        match self.supply {
            JointSupply::Shared => self.fittings[0].line.supply.as_ref(),
            JointSupply::Separate => None,
        }
    }
}

impl<S: Real> JointRig<S> {
    /// Lengths in m of both actuators at an angle in rad and absolute pressures: what the joint leaves them, on a tendon where
    /// actuator and tendon balance without friction.
    pub fn lengths(&self, angle: S, pressure: [AbsolutePressure<S>; 2]) -> [S; 2] {
        let distances = self.joint.lengths(angle);
        core::array::from_fn(|i| match &self.fittings[i].tendon {
            Some(tendon) => tendon.balance(&self.driven[i].actuator, distances[i], pressure[i].0),
            None => distances[i],
        })
    }

    /// The absolute pressure at the start: where it is given over time, that of t = 0.
    pub(super) fn first_pressure(&self, i: usize, gauge: GaugePressure<S>) -> AbsolutePressure<S> {
        let Fittings { line, pressure, .. } = &self.fittings[i];
        let gauge = match pressure.as_ref().filter(|_| line.hose.is_none()) {
            Some(series) => GaugePressure(series.gauge_at(S::zero())),
            None => gauge,
        };
        gauge.absolute(self.driven[i].actuator.air().atmosphere())
    }
}
