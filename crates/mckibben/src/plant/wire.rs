//! Where each actuator and mechanism takes its numbers from, resolved once for a run: what every evaluation would look up again.

use super::{ActuatorIndices, MechanismIndices, Plant};
use crate::mechanism::{Coupling, Mechanism};
use crate::scalar::{Over, Scalar};
use crate::simulation::member::Member;
use alloc::vec::Vec;

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
#[derive(Clone, Debug)]
pub struct Wire<R: Scalar> {
    /// Which of the plant.
    pub index: usize,
    /// The actuator with the tolerances of its events.
    pub member: Member<R>,
    /// Where its states are.
    pub places: ActuatorIndices,
    pub(crate) mechanism: usize,
    pub(crate) span: Span,
    /// The node of the network that is its chamber.
    pub(crate) chamber: Option<usize>,
    /// Whether its pressure is given over time.
    pub(crate) is_given: bool,
    /// Whether a state answers to its tension: what it spans moves by its forces.
    pub(crate) is_answered: bool,
}

/// A mechanism, its states and the actuators at it.
#[derive(Clone, Debug)]
pub struct Assembly<R: Scalar> {
    /// Which of the plant.
    pub(crate) index: usize,
    pub(crate) mechanism: Mechanism<R>,
    pub(crate) places: MechanismIndices,
    pub(crate) members: Vec<usize>,
}

impl<R: Scalar> Assembly<R> {
    /// That of a mechanism of a plant.
    pub(crate) fn new(plant: &Plant<R>, index: usize) -> Self {
        let places = &plant.places;
        Self {
            index,
            mechanism: plant.mechanisms[index].clone(),
            places: places.mechanisms[index],
            members: places.members[index].clone(),
        }
    }
}

impl<R: Scalar> Wire<R> {
    /// Pressure in Pa and mass in kg of its air.
    #[inline(always)]
    pub(crate) fn air<T: Copy>(&self, state: &[T]) -> [T; 2] {
        let from = self.places.pressure;
        [state[from], state[from + 1]]
    }

    /// The length in m of its braid at a distance in m: a slack one rests at its shortest.
    #[inline(always)]
    pub(crate) fn resting_length<T: Over<R>>(&self, slack: R::Mask, distance: T) -> T {
        T::select(slack, T::of(self.member.actuator.limits().min_length()), distance)
    }

    /// Place of its length among the states, where it is one.
    pub fn length_place(&self) -> Option<usize> {
        match (self.places.length, self.span) {
            (Some(place), _) | (None, Span::Direct { position: place, .. }) => Some(place),
            _ => None,
        }
    }

    /// That of an actuator of a plant.
    pub(crate) fn new(plant: &Plant<R>, index: usize, member: Member<R>) -> Self {
        let (mounted, places) = (&plant.actuators[index], &plant.places);
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
            index,
            member,
            places: places.actuators[index],
            mechanism: mounted.mechanism,
            span,
            chamber: places.chambers[index],
            is_given: mounted.pressure.is_some(),
            is_answered: plant.mechanisms[mounted.mechanism].is_dynamic(),
        }
    }
}
