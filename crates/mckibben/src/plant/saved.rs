//! The state of a plant as numbers in a row, as many for each plant, whatever state it is in.
//!
//! They hold all that a step goes on from: time, states, what each actuator and mechanism is doing, what a hysteresis remembers,
//! coils, poppets and spools, and what valves have been set to. The pieces of laws that hold follow from the states.
//!
//! Checked by `tests/plant_saved.rs`.

use super::Plant;
use super::evaluation::{Evaluation, System};
use super::mode::{ActuatorMode, MechanismMode, PlantMode};
use super::run::PlantSnapshot;
use super::sliding::Facet;
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::limit;
use crate::mechanism::{Contact, Mechanism};
use crate::numbered::{Counted, Kept, PutBack, Row};
use crate::simulation::{LengthRegime, Sliding};
use alloc::vec::Vec;

const CONTACTS: [Contact; 3] = [Contact::None, Contact::Pressed, Contact::Rebound];

/// What is said of numbers that are no state.
const NO_STATE: Error = Error::Misuse {
    what: "these numbers are no state of this plant",
    remedy: "give those that steps of an equal plant saved in this version, all of them in their order",
};

impl<R: Instantiate> Plant<R> {
    /// The most facets of what sticking actuators of a mechanism can hold: as many as there are ways to choose actuators for a
    /// facet, and one for each actuator that is on none.
    fn most_facets(&self, mechanism: usize) -> usize {
        if !self.mechanisms[mechanism].is_dynamic() {
            return 0;
        }
        let members = self.places.members[mechanism].iter();
        let sticking = members.filter(|member| self.places.actuators[**member].length.is_none()).count();
        let coordinates = self.places.mechanisms[mechanism].coordinates;
        let (mut choices, mut most) = (1_usize, 1);
        for chosen in 1..coordinates.min(sticking) {
            choices = choices.saturating_mul(sticking + 1 - chosen) / chosen;
            most = most.max(choices);
        }
        most.min(super::sliding::MOST_FACETS) + sticking
    }
}

impl<R: Instantiate> System<R> {
    /// How many numbers a state is.
    pub(super) fn saved_size(&self, snapshot: &mut PlantSnapshot<R>) -> usize {
        let mut size = Counted::default();
        self.each_number(snapshot, &mut size);
        size.0
    }

    /// Saves a snapshot as numbers.
    pub(super) fn save_to(&self, snapshot: &mut PlantSnapshot<R>, numbers: &mut [R], size: usize) -> Result<(), Error> {
        let (time, _, mode) = snapshot.parts();
        if !mode.drivers.is_empty() {
            return Err(Error::NotImplemented(&limit::SAVE_DRIVERS));
        }
        if numbers.len() != size {
            return Err(Error::Misuse {
                what: "a state is saved to more or fewer numbers than it has",
                remedy: "give as many as `PlantSteps::state_size` says",
            });
        }
        self.plant.network.forget_passed(*time, &mut mode.network);
        let mut row = Kept::into(numbers);
        self.each_number(snapshot, &mut row);
        // All else that a state may hold has its places.
        if row.is_whole() { Ok(()) } else { Err(Error::NotImplemented(&limit::SAVE_COMMANDS)) }
    }

    /// Makes a snapshot of this plant what gave numbers; it is to be thrown away where that fails.
    pub(super) fn restore_from(
        &self,
        snapshot: &mut PlantSnapshot<R>,
        numbers: &[R],
        at: &mut Evaluation<R>,
    ) -> Result<(), Error> {
        if !snapshot.mode().drivers.is_empty() {
            return Err(Error::NotImplemented(&limit::SAVE_DRIVERS));
        }
        let mut row = PutBack::from(numbers);
        self.each_number(snapshot, &mut row);
        let (time, state, mode) = snapshot.parts();
        let is_whole = row.is_whole() && time.value() >= 0.0;
        if !is_whole || self.check_step(*time, state).is_err() || self.lacks_distance(state) {
            return Err(NO_STATE);
        }
        self.enter_pieces(*time, state, mode, at);
        Ok(())
    }

    /// Whether an actuator whose ends a host moves has a distance that is not above zero.
    fn lacks_distance(&self, state: &[R]) -> bool {
        let mechanisms = &self.plant.places.mechanisms;
        let mut of_ends = self.plant.mechanisms.iter().zip(mechanisms).flat_map(|(mechanism, its)| {
            let distances = if let Mechanism::External { distances } = mechanism { *distances } else { 0 };
            (0..distances).map(|coordinate| its.position(coordinate))
        });
        of_ends.any(|place| state[place].value() <= 0.0)
    }

    /// All that differs from one state of the plant to another.
    fn each_number(&self, snapshot: &mut PlantSnapshot<R>, row: &mut impl Row<R>) {
        let (time, state, mode) = snapshot.parts();
        row.number(time);
        row.numbers(state);
        let PlantMode { actuators, mechanisms, network, arms: _, drivers: _ } = mode;
        for (mounted, its) in self.plant.actuators.iter().zip(actuators) {
            let ActuatorMode { mode, on_stop, loose, trace, isothermal, rows_passed } = its;
            row.choice(
                &mut mode.length_regime,
                [LengthRegime::Slack, LengthRegime::Free, LengthRegime::Taut, LengthRegime::Rebound],
            );
            let all = [Sliding::Lengthening, Sliding::Shortening, Sliding::Stuck, Sliding::Held, Sliding::Frictionless];
            row.choice(&mut mode.sliding, all);
            [&mut mode.clamped, on_stop, loose].into_iter().for_each(|truth| row.truth(truth));
            if let Some(trace) = trace {
                trace.each_number(row);
            }
            if let Some(content) = isothermal {
                row.number(content);
            }
            let rows = mounted.pressure.as_ref().map_or(0, |series| series.rows());
            row.index(rows_passed, rows + 1);
        }
        for (m, its) in mechanisms.iter_mut().enumerate() {
            self.each_number_of_mechanism(m, its, row);
        }
        self.plant.network.each_number(*time, network, row);
    }

    fn each_number_of_mechanism(&self, m: usize, its: &mut MechanismMode, row: &mut impl Row<R>) {
        let MechanismMode { frozen, stops, foot, basis, facets, corners_passed } = its;
        row.truth(frozen);
        for contact in stops.iter_mut().flatten().chain([foot]) {
            row.choice(contact, CONTACTS);
        }
        let corners = match &self.plant.mechanisms[m] {
            Mechanism::Prescribed(motion) => motion.corners(),
            _ => 0,
        };
        row.index(corners_passed, corners + 1);
        let members = &self.plant.places.members[m];
        let (count, all) = (members.len(), self.wires.len());
        row.indices(basis, count, all);
        // No more directions are independent than there are coordinates.
        let most_held = self.plant.places.mechanisms[m].coordinates;
        if basis.len() > most_held {
            row.refuse();
        }
        let most = self.plant.most_facets(m);
        if let Some(length) = row.length(facets.len(), most) {
            facets.resize_with(length, || Facet { span: Vec::new(), along: Vec::new(), block: Vec::new() });
        }
        let mut none = Facet { span: Vec::new(), along: Vec::new(), block: Vec::new() };
        for place in 0..most {
            let Facet { span, along, block } = facets.get_mut(place).unwrap_or(&mut none);
            [&mut *span, along, block].into_iter().for_each(|list| row.indices(list, count, all));
            if span.len() > most_held || (!span.is_empty() && along.len() + 1 != span.len()) {
                row.refuse();
            }
        }
        let lists = facets.iter().flat_map(|Facet { span, along, block }| [span, along, block]);
        if lists.chain([&*basis]).flatten().any(|member| !members.contains(member)) {
            row.refuse();
        }
    }
}
