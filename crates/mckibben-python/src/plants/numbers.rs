//! Numbers of a plant that differ from one to the next.

use crate::scenario::Scenario;
use mckibben::{Error, parameter};
use mckibben_cli::failure::Failure;
use mckibben_identify::adjustable::Adjustable;
use pyo3::prelude::*;

/// A scenario, nothing asked of its valves by itself, and those of its numbers that are given for each plant.
pub(super) struct Numbers {
    scenario: Py<Scenario>,
    adjustable: Adjustable,
    /// Which of all the values are this scenario's.
    which: Vec<usize>,
}

impl Numbers {
    /// The numbers at these paths; each stands with where its value is among all.
    pub(super) fn find(scenario: Py<Scenario>, by: &[(usize, &str)]) -> Result<Self, Failure> {
        let Scenario { document, .. } = scenario.get();
        let mut base = scenario.get().of_one()?.open_loop();
        let place = |(_, path): &(usize, &str)| {
            let place = document.find(path, by.iter().map(|(_, other)| *other), &mut base);
            place.map_err(|error| {
                Failure::input(error.to_string(), "name another in `by`, or in `randomize` of an environment")
            })
        };
        let places = by.iter().map(place).collect::<Result<_, _>>()?;
        let given = document.says_of_each(parameter::MIN_LENGTH.key);
        let which = by.iter().map(|(which, _)| *which).collect();
        Ok(Self { scenario, adjustable: Adjustable::new(base, places, given), which })
    }

    /// Whether all numbers are the scenario's, and none differs from plant to plant.
    pub(super) fn are_given(&self) -> bool {
        self.which.is_empty()
    }

    /// The scenario without values.
    pub(super) fn base(&self) -> &mckibben_scenario::Scenario {
        self.adjustable.base()
    }

    /// What the scenario has for each number, with where it is among all, in SI.
    pub(super) fn given(&self) -> impl Iterator<Item = (usize, f64)> {
        let mut base = self.base().clone();
        let value = move |place: &mckibben_scenario::Place| place.value(&mut base).unwrap_or(f64::NAN);
        self.which.iter().copied().zip(self.adjustable.places().iter().map(value))
    }

    /// What is made of the scenario with the values of one plant.
    pub(super) fn with<T>(
        &self,
        values: &[f64],
        make: impl FnOnce(&mckibben_scenario::Scenario) -> Result<T, Error>,
    ) -> Result<T, Failure> {
        if self.are_given() {
            return make(self.base()).map_err(|error| self.failed(&error));
        }
        let own: Vec<f64> = self.which.iter().map(|which| values[*which]).collect();
        // The values are the caller's: no line of the scenario is at fault.
        let refused =
            |error: Error| Failure::input(error.to_string(), "give another value, or draw from another range");
        self.adjustable.at(&own).and_then(|scenario| make(&scenario)).map_err(refused)
    }

    /// An error of the core: shown in the scenario, unless its values came from elsewhere.
    pub(super) fn failed(&self, error: &Error) -> Failure {
        match self.are_given() {
            true => Failure::of_core(error, &self.scenario.get().document),
            false => error.clone().into(),
        }
    }
}
