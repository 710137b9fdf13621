//! A scenario some of whose numbers are looked for: set to values, and differentiated by them.
//!
//! Derivatives are exact and come in blocks of [`WIDTH`] directions, each a separate pass.

pub use mckibben::{DIRECTIONS as WIDTH, Seeded};
use mckibben::{Error, parameter};
use mckibben_scenario::{Load, Place, Scenario, Seeds};

/// A scenario and the numbers of it that are looked for.
#[derive(Clone, Debug)]
pub struct Adjustable {
    base: Scenario,
    places: Vec<Place>,
    /// The thread length among the places, when the least length follows from it: of the actuator, and of a joint's second.
    thread: [Option<usize>; 2],
}

/// Least length over thread length, where the one follows from the other.
fn least_over_thread() -> f64 {
    1.0 / 3_f64.sqrt()
}

impl Adjustable {
    /// A scenario and its numbers. The least length of the actuator follows from a thread length that is looked for,
    /// unless it was given (`min_length_given`, for the actuator and for a joint's second).
    pub fn new(base: Scenario, places: Vec<Place>, min_length_given: [bool; 2]) -> Self {
        let thread = [0, 1].map(|actuator| {
            let is = |row: &parameter::Parameter| {
                let is = |place: &Place| place.parameter().key == row.key && place.of_each()[actuator];
                places.iter().position(is)
            };
            let given = min_length_given[actuator] || is(&parameter::MIN_LENGTH).is_some();
            is(&parameter::THREAD_LENGTH).filter(|_| !given)
        });
        Self { base, places, thread }
    }

    /// The subject at these values, with only the parameters of these indices unknown.
    ///
    /// # Errors
    /// As [`Adjustable::at`].
    pub(crate) fn only(&self, numbers: &[usize], values: &[f64]) -> Result<Self, Error> {
        let places = numbers.iter().map(|number| self.places[*number]).collect();
        Ok(Self::new(self.at(values)?, places, self.thread.map(|thread| thread.is_none())))
    }

    /// The numbers that are looked for.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The scenario as it was given.
    pub fn base(&self) -> &Scenario {
        &self.base
    }

    /// The scenario with other values.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when one is outside its parameter's range.
    pub fn at(&self, values: &[f64]) -> Result<Scenario, Error> {
        let mut scenario = self.base.clone();
        for (place, value) in self.places.iter().zip(values) {
            place.set(&mut scenario, *value)?;
        }
        let second = match &mut scenario.load {
            Load::AntagonisticJoint(joint) => Some(&mut joint.antagonist.actuator),
            _ => None,
        };
        for (actuator, thread) in [Some(&mut scenario.actuator), second].into_iter().zip(self.thread) {
            if let (Some(actuator), Some(_)) = (actuator, thread) {
                actuator.min_length = least_over_thread() * actuator.thread_length;
            }
        }
        Ok(scenario)
    }

    /// The first unknown of each pass.
    pub fn passes(&self) -> impl Iterator<Item = usize> {
        (0..self.places.len()).step_by(WIDTH)
    }

    /// The seeds of the pass that begins with an unknown.
    pub fn seeds(&self, first: usize) -> Seeds {
        let block = self.places.iter().skip(first).take(WIDTH);
        let of_block = |thread: &usize| (first..first + WIDTH).contains(thread);
        (0..2).fold(Seeds::new(block.copied()), |seeds, actuator| match self.thread[actuator].filter(of_block) {
            Some(thread) => seeds.with_follower(&parameter::MIN_LENGTH, actuator, thread - first, least_over_thread()),
            None => seeds,
        })
    }

    /// Puts the derivatives of a pass into the row of a residual, each times a factor.
    pub fn spread(&self, first: usize, slope: &[f64; WIDTH], factor: f64, row: &mut [f64]) {
        spread(first, slope, factor, row);
    }
}

/// Puts the derivatives with respect to the unknowns from `first` on into the row of a residual, each times a factor.
pub(crate) fn spread(first: usize, slope: &[f64; WIDTH], factor: f64, row: &mut [f64]) {
    for (into, slope) in row.iter_mut().skip(first).zip(slope) {
        *into = factor * slope;
    }
}
