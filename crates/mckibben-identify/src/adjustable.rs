//! A scenario some of whose numbers are looked for: set to values, and differentiated by them.
//!
//! Derivatives are exact and come in blocks of [`WIDTH`] directions, each a pass of its own.

use mckibben::{Dual, Error, parameter};
use mckibben_scenario::{Place, Scenario, Seeds};

/// Directions of one pass.
pub const WIDTH: usize = 8;

/// A number with its derivatives by up to [`WIDTH`] unknowns.
pub type Seeded = Dual<f64, WIDTH>;

/// A scenario and the numbers of it that are looked for.
#[derive(Clone, Debug)]
pub struct Adjustable {
    base: Scenario,
    places: Vec<Place>,
    /// The thread length among the places, when the least length follows from it.
    thread: Option<usize>,
}

/// Least length over thread length, where the one follows from the other.
fn least_over_thread() -> f64 {
    1.0 / 3_f64.sqrt()
}

impl Adjustable {
    /// A scenario and its numbers. The least length of the actuator follows from a thread length that is looked for,
    /// unless it was given (`min_length_given`).
    pub fn new(base: Scenario, places: Vec<Place>, min_length_given: bool) -> Self {
        let is = |row: &parameter::Parameter| places.iter().position(|place| place.parameter().key == row.key);
        let thread =
            is(&parameter::THREAD_LENGTH).filter(|_| !min_length_given && is(&parameter::MIN_LENGTH).is_none());
        Self { base, places, thread }
    }

    /// The same at these values, with only the numbers of these indices looked for.
    ///
    /// # Errors
    /// As [`Adjustable::at`].
    pub(crate) fn only(&self, numbers: &[usize], values: &[f64]) -> Result<Self, Error> {
        let places = numbers.iter().map(|number| self.places[*number]).collect();
        Ok(Self::new(self.at(values)?, places, self.thread.is_none()))
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
        if self.thread.is_some() {
            scenario.actuator.min_length = least_over_thread() * scenario.actuator.thread_length;
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
        let seeds = Seeds::new(block.copied());
        match self.thread {
            Some(thread) if (first..first + WIDTH).contains(&thread) => {
                seeds.with_follower(&parameter::MIN_LENGTH, thread - first, least_over_thread())
            }
            _ => seeds,
        }
    }

    /// Puts the derivatives of a pass into the row of a residual, each times a factor.
    pub fn spread(&self, first: usize, slope: &[f64; WIDTH], factor: f64, row: &mut [f64]) {
        for (into, slope) in row.iter_mut().skip(first).zip(slope) {
            *into = factor * slope;
        }
    }
}
