//! Where each actuator takes its numbers from, resolved once for a run: what every evaluation would look up again.

use super::Plant;
use crate::actuator::Actuator;
use crate::mechanism::{Coupling, Mechanism};
use crate::scalar::Real;

/// How the distance of an actuator follows from the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Span {
    /// It is a state, and its rate another.
    Direct {
        /// Place of the distance.
        position: usize,
        /// Place of its rate.
        rate: usize,
    },
    /// It is a state that does not change.
    Fixed {
        /// Place of the distance.
        position: usize,
    },
    /// It is given over time.
    Prescribed,
    /// It is computed by a coupling from several states.
    Coupled,
}

/// An actuator, its states and what it spans.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wire<'a, R: Real> {
    pub(crate) actuator: &'a Actuator<R>,
    pub(crate) mechanism: usize,
    pub(crate) span: Span,
    /// Place of the pressure; that of the mass of the air is the next.
    pub(crate) pressure: usize,
    /// Places of the length on a tendon, and of the bristles.
    pub(crate) length: Option<usize>,
    pub(crate) bristles: Option<usize>,
    /// The node of the network that is its chamber.
    pub(crate) chamber: Option<usize>,
    /// Whether its pressure is given over time.
    pub(crate) is_given: bool,
}

impl<'a, R: Real> Wire<'a, R> {
    /// Those of all actuators of a plant.
    pub(crate) fn all(plant: &'a Plant<R>) -> alloc::vec::Vec<Self> {
        let places = &plant.places;
        let wire = |(i, mounted): (usize, &'a super::Mounted<R>)| {
            let here = &places.actuators[i];
            let of_mechanism = &places.mechanisms[mounted.mechanism];
            let span = match (&plant.mechanisms[mounted.mechanism], &mounted.coupling) {
                (Mechanism::Prescribed(_), _) => Span::Prescribed,
                (Mechanism::Fixed, Coupling::Direct { coordinate }) => {
                    Span::Fixed { position: of_mechanism.position(*coordinate) }
                }
                (_, Coupling::Direct { coordinate }) => {
                    Span::Direct { position: of_mechanism.position(*coordinate), rate: of_mechanism.rate(*coordinate) }
                }
                (_, Coupling::Arms { .. } | Coupling::Points(_)) => Span::Coupled,
            };
            Self {
                actuator: &mounted.actuator,
                mechanism: mounted.mechanism,
                span,
                pressure: here.pressure,
                length: here.length,
                bristles: here.bristles,
                chamber: places.chambers[i],
                is_given: mounted.pressure.is_some(),
            }
        };
        plant.actuators.iter().enumerate().map(wire).collect()
    }
}
