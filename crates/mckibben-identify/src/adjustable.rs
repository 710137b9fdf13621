//! A scenario some of whose numbers are looked for: set to values, and differentiated by them.
//!
//! Derivatives are exact and come in blocks of [`WIDTH`] directions, each a separate pass. What the scenario leaves out and follows
//! from a number follows it here too, in its value and in its derivative ([`Seeds::with_followers`]).
//!
//! A part that is switched off is not built, and so has no slope by the number that switches it: [`SwitchedOff`].
//!
//! Checked by `tests/follow.rs`: by every number of some short runs, against differences of runs.

use mckibben::Error;
use mckibben::parameter::{self as p, Parameter};
pub use mckibben::{DIRECTIONS as WIDTH, Seeded};
use mckibben_scenario::{Hysteresis, Load, Place, Scenario, Seeds, quantity};
use std::fmt;

/// A scenario and the numbers of it that are looked for.
#[derive(Clone, Debug)]
pub struct Adjustable {
    base: Scenario,
    places: Vec<Place>,
    /// Whether the least length follows from a thread length among the places: of the actuator, and of a joint's second.
    least_follows: [bool; 2],
}

/// A number at the value at which its part is switched off, where there is no derivative by it.
#[derive(Clone, Debug, PartialEq)]
pub struct SwitchedOff {
    /// The path of the number.
    pub path: String,
    /// The value at which the part is off.
    pub off: f64,
    /// One near it, at which the part is there.
    pub near: f64,
    /// The SI unit of both.
    pub unit: &'static str,
}

impl fmt::Display for SwitchedOff {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [off, near] = [self.off, self.near].map(|value| quantity::format(value, self.unit));
        let side = if self.near > self.off { "above" } else { "below" };
        write!(
            f,
            "`{}` = {off} switches its part off, and a part that is switched off has no derivative: give a value {side} {}, such as \
             {near}, or leave the key out",
            self.path,
            if self.off == 0.0 { "zero" } else { &off }
        )
    }
}

impl std::error::Error for SwitchedOff {}

/// A number, the value at which it switches its part off, one near that at which it does not, and numbers of the same part that are
/// zero by default: where one of these is above zero, the part is there.
type Switch = (&'static Parameter, f64, f64, &'static [&'static Parameter]);

/// Every number at which a part is switched off.
static SWITCHES: [Switch; 14] = [
    (&p::WALL_THICKNESS, 0.0, 1e-6, &[]),
    (&p::TAPER_LENGTH_RATIO, 0.0, 1e-6, &[]),
    (&p::END_FACTOR_RISE, 0.0, 1e-6, &[]),
    (&p::STRUCTURAL_DAMPING, 0.0, 1e-6, &[]),
    (&p::COULOMB_WIDTH, 0.0, 1e-6, &[&p::COULOMB_FORCE, &p::COULOMB_FORCE_PER_PRESSURE]),
    (&p::COULOMB_FORCE, 0.0, 1e-6, &[&p::COULOMB_FORCE_PER_PRESSURE]),
    (&p::COULOMB_FORCE_PER_PRESSURE, 0.0, 1e-12, &[&p::COULOMB_FORCE]),
    (&p::STATIC_RATIO, 1.0, 1.000_001, &[]),
    (&p::OPENING_DELAY, 0.0, 1e-6, &[]),
    (&p::CLOSING_DELAY, 0.0, 1e-6, &[]),
    (&p::OPENING_TIME, 0.0, 1e-6, &[]),
    (&p::CLOSING_TIME, 0.0, 1e-6, &[]),
    // Pulses that never come, or never end.
    (&p::DUTY, 0.0, 1e-6, &[]),
    (&p::DUTY, 1.0, 0.999_999, &[]),
];

impl Adjustable {
    /// A scenario and its numbers. The least length of the actuator follows from a thread length that is looked for,
    /// unless it was given (`min_length_given`, for the actuator and for a joint's second).
    pub fn new(base: Scenario, places: Vec<Place>, min_length_given: [bool; 2]) -> Self {
        let least_follows = [0, 1].map(|actuator| {
            let has = |row: &Parameter| {
                places.iter().any(|place| place.parameter().key == row.key && place.of_each()[actuator])
            };
            has(&p::THREAD_LENGTH) && !has(&p::MIN_LENGTH) && !min_length_given[actuator]
        });
        Self { base, places, least_follows }
    }

    /// The subject at these values, with only the parameters of these indices unknown.
    ///
    /// # Errors
    /// As [`Adjustable::at`].
    pub(crate) fn only(&self, numbers: &[usize], values: &[f64]) -> Result<Self, Error> {
        let places = numbers.iter().map(|number| self.places[*number]).collect();
        Ok(Self::new(self.at(values)?, places, self.least_follows.map(|follows| !follows)))
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
    /// [`Error::OutOfRange`] when one is outside its parameter's range; [`Error::Table`] when entries that a file must have in rising
    /// order are not.
    pub fn at(&self, values: &[f64]) -> Result<Scenario, Error> {
        let mut scenario = self.base.clone();
        for (place, value) in self.places.iter().zip(values) {
            place.set(&mut scenario, *value)?;
        }
        check_order(&scenario)?;
        scenario.let_least_lengths_follow(self.least_follows);
        Ok(scenario)
    }

    /// That there is a derivative by every number at these values.
    ///
    /// # Errors
    /// [`SwitchedOff`] for the first whose part is not there.
    pub fn check_derivatives(&self, values: &[f64]) -> Result<(), SwitchedOff> {
        let mut scenario = self.base.clone();
        for (place, value) in self.places.iter().zip(values) {
            // A value outside its range is refused where the scenario is built.
            let _ = place.set(&mut scenario, *value);
        }
        let found = self.places.iter().zip(values).find_map(|(place, value)| {
            let is_here = |(row, off, ..): &&Switch| row.key == place.parameter().key && off == value;
            let (_, off, near, others) = SWITCHES.iter().find(is_here)?;
            let second = !place.of_each()[0];
            let keeps = |row: &&Parameter| {
                let path = if second { format!("antagonist.{}", row.key) } else { row.key.to_owned() };
                let other = Place::find(&path, &mut scenario).ok();
                other.and_then(|other| other.value(&mut scenario)).is_some_and(|other| other > 0.0)
            };
            let is_off = !others.iter().any(keeps);
            is_off.then(|| SwitchedOff { path: place.path(), off: *off, near: *near, unit: place.parameter().unit })
        });
        found.map_or(Ok(()), Err)
    }

    /// The first unknown of each pass.
    pub fn passes(&self) -> impl Iterator<Item = usize> {
        (0..self.places.len()).step_by(WIDTH)
    }

    /// The seeds of the pass that begins with an unknown, for the parts of an actuator, which do not depend on the values.
    pub fn seeds(&self, first: usize) -> Seeds {
        self.seeds_at(first, &self.base)
    }

    /// The seeds of the pass that begins with an unknown, for all parts and the start of this scenario with other values.
    pub fn seeds_at(&self, first: usize, scenario: &Scenario) -> Seeds {
        let block = self.places.iter().skip(first).take(WIDTH).copied();
        Seeds::new(block).with_followers(scenario, self.least_follows)
    }

    /// Puts the derivatives of a pass into the row of a residual, each times a factor.
    pub fn spread(&self, first: usize, slope: &[f64; WIDTH], factor: f64, row: &mut [f64]) {
        spread(first, slope, factor, row);
    }
}

/// That the lists which a file must have in rising order have it. The parts that they describe could be built in any order, and a search
/// could exchange two entries: the scenario that it would write is refused.
fn check_order(scenario: &Scenario) -> Result<(), Error> {
    let second = match &scenario.load {
        Load::AntagonisticJoint(joint) => Some(&joint.antagonist.actuator),
        _ => None,
    };
    for friction in std::iter::once(&scenario.actuator).chain(second).map(|actuator| &actuator.friction) {
        let times = friction.viscoelastic.as_ref().map(|branches| branches.relaxation_time.as_slice());
        let reaches = match &friction.hysteresis {
            Some(Hysteresis::MaxwellSlip { reach, .. }) => Some(reach.as_slice()),
            _ => None,
        };
        for (row, list) in [(&p::BRANCH_RELAXATION_TIME, times), (&p::HYSTERESIS_REACH, reaches)] {
            let Some(before) = list.unwrap_or_default().windows(2).position(|pair| pair[0] >= pair[1]) else {
                continue;
            };
            let (problem, remedy) = ("it is not above the one before", "give entries that increase");
            return Err(Error::Table { name: row.key, problem, entry: before + 2, remedy });
        }
    }
    Ok(())
}

/// Puts the derivatives with respect to the unknowns from `first` on into the row of a residual, each times a factor.
pub(crate) fn spread(first: usize, slope: &[f64; WIDTH], factor: f64, row: &mut [f64]) {
    for (into, slope) in row.iter_mut().skip(first).zip(slope) {
        *into = factor * slope;
    }
}
