//! One number of a scenario by its path: to be set, and to be differentiated by.
//!
//! A path is a key as the file has it, `actuator.friction.viscous`, or an entry of a list, counted from zero:
//! `actuator.friction.hysteresis.stiffness_ratio[2]`. The value is in SI, whatever units the file was written in; of the
//! coefficients that a file gives over its own units, in those of the plain [`Scenario`].
//!
//! Of a joint, `actuator.turns` are the agonist's and `antagonist.actuator.turns` the antagonist's alone; what a file says of
//! both is one number of both, [`Place::of_both`].
//!
//! ```
//! use mckibben::{Dual, Over};
//! use mckibben_scenario::{Document, Place, Scenario, Seeds};
//!
//! let text = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[initial]\ngauge_pressure = \"60 psi\"\n[run]\nduration = \"1 s\"";
//! let mut scenario = Scenario::from_str(text, "muscle.toml")?;
//! let turns = Place::find("actuator.turns", &mut scenario)?;
//! assert!(turns.set(&mut scenario, 2.0)?);
//!
//! // The static force goes with 1/n².
//! let actuator = scenario.driven()?.actuator;
//! let mut seeds = Seeds::new([turns]);
//! let seeded = actuator.map(|parameter, value| seeds.over::<1>(parameter, value));
//! let force = seeded.static_force(Dual::of(0.09), Dual::of(3e5));
//! assert!((force.slope[0] + force.value).abs() < 1e-12 * force.value);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Checked by `tests/place.rs`: for every key, the derivative that is seeded is that of setting the value.

use crate::document::{Document, Node, Value, list_and_entry};
use crate::follow::Follower;
use crate::keys::{ANTAGONIST, KEYS, in_antagonist, is_of_antagonist};
use crate::muscle::AT_REST;
use crate::nearest::nearest;
use crate::scenario::{Command, Effectiveness, Force, Hysteresis, Load, MomentArm, Motion, Scenario};
use crate::sweep::field::{Field, exchange, field_of};
use mckibben::parameter::{self as p, Parameter};
use mckibben::{Dual, Error, Over};
use std::fmt;

/// A number of a scenario.
#[derive(Clone, Copy)]
pub struct Place {
    parameter: &'static Parameter,
    at: At,
    /// Whether it is of the first actuator and of the second of a joint; what is of neither alone counts as of both.
    of: [bool; 2],
}

#[derive(Clone, Copy)]
enum At {
    Single(Field),
    /// A list, and which of its entries.
    Entry(List, usize),
}

/// The place of a list in a scenario, or `None` when the scenario has no such list.
pub(crate) type List = fn(&mut Scenario) -> Option<&mut [f64]>;

/// The lists whose numbers a scenario has in other units than the file.
static CONVERTED: [&Parameter; 7] = [
    &p::EFFECTIVENESS_POLYNOMIAL,
    &p::SAROSI_COEFFICIENTS,
    &p::MEMBRANE_MODULUS,
    &p::BOLEN_SHAPE,
    &p::PRESSURE_COEFFICIENTS,
    &p::PASSIVE_COEFFICIENTS,
    &p::MAP_TENSION,
];

/// The place of a list of quantities, where the scenario has them as the file does.
pub(crate) fn list_of(parameter: &Parameter) -> Option<List> {
    let converted = CONVERTED.iter().any(|row| row.key == parameter.key);
    LISTS.iter().find(|(row, _)| row.key == parameter.key && !converted).map(|(_, list)| *list)
}

/// The lists whose entries are numbers of the model.
static LISTS: &[(&Parameter, List)] = &[
    (&p::EFFECTIVENESS_POLYNOMIAL, |s| match &mut s.actuator.effectiveness {
        Effectiveness::Polynomial(coefficients) => Some(coefficients),
        _ => None,
    }),
    (&p::EFFECTIVENESS_VALUE, |s| match &mut s.actuator.effectiveness {
        Effectiveness::Table { value, .. } => Some(value),
        _ => None,
    }),
    (&p::SAROSI_COEFFICIENTS, |s| match &mut s.actuator.force {
        Force::Sarosi(coefficients) => Some(coefficients),
        _ => None,
    }),
    (&p::MEMBRANE_MODULUS, |s| match &mut s.actuator.force {
        Force::MartensBoblan { modulus, .. } => Some(modulus),
        _ => None,
    }),
    (&p::BOLEN_SHAPE, |s| match &mut s.actuator.force {
        Force::Bolen { shape, .. } => Some(shape),
        _ => None,
    }),
    (&p::PRESSURE_COEFFICIENTS, |s| match &mut s.actuator.force {
        Force::Polynomial { pressure, .. } => Some(pressure),
        _ => None,
    }),
    (&p::PASSIVE_COEFFICIENTS, |s| match &mut s.actuator.force {
        Force::Polynomial { passive, .. } => Some(passive),
        _ => None,
    }),
    (&p::MAP_TENSION, |s| match &mut s.actuator.force {
        Force::Map { tension, .. } => Some(tension),
        _ => None,
    }),
    (&p::HYSTERESIS_REACH, |s| match &mut s.actuator.friction.hysteresis {
        Some(Hysteresis::MaxwellSlip { reach, .. }) => Some(reach),
        _ => None,
    }),
    (&p::HYSTERESIS_STIFFNESS_RATIO, |s| match &mut s.actuator.friction.hysteresis {
        Some(Hysteresis::MaxwellSlip { stiffness_ratio, .. }) => Some(stiffness_ratio),
        _ => None,
    }),
    (&p::BRANCH_STIFFNESS, |s| Some(&mut s.actuator.friction.viscoelastic.as_mut()?.stiffness)),
    (&p::BRANCH_STIFFNESS_RATIO, |s| Some(&mut s.actuator.friction.viscoelastic.as_mut()?.stiffness_ratio)),
    (&p::BRANCH_RELAXATION_TIME, |s| Some(&mut s.actuator.friction.viscoelastic.as_mut()?.relaxation_time)),
    (&p::BRANCH_INITIAL_STRETCH, |s| Some(&mut s.actuator.friction.viscoelastic.as_mut()?.initial_stretch)),
    (&p::MOMENT_ARM, |s| match &mut s.load {
        Load::AntagonisticJoint(joint) => match &mut joint.tendon.arm {
            MomentArm::Table { arm, .. } => Some(arm),
            MomentArm::Pulley(_) => None,
        },
        _ => None,
    }),
    (&p::COMMAND_TIME, |s| match &mut s.command {
        Some(Command::Table { time, .. } | Command::SetPoints { time, .. } | Command::Positions { time, .. }) => {
            Some(time)
        }
        _ => None,
    }),
    (&p::COMMAND_GAUGE_PRESSURE, |s| match &mut s.command {
        Some(Command::SetPoints { gauge_pressure, .. }) => Some(gauge_pressure),
        _ => None,
    }),
    (&p::COMMAND_POSITION, |s| match &mut s.command {
        Some(Command::Positions { position, .. }) => Some(position),
        _ => None,
    }),
    (&p::SERIES_TIME, |s| s.pressure.as_mut().map(|series| series.time.as_mut_slice())),
    (&p::SERIES_GAUGE_PRESSURE, |s| s.pressure.as_mut().map(|series| series.gauge_pressure.as_mut_slice())),
    (&p::MOTION_TIME, |s| match &mut s.load {
        Load::PrescribedMotion(Motion::Table { time, .. }) => Some(time),
        _ => None,
    }),
    (&p::MOTION_TABLE_LENGTH, |s| match &mut s.load {
        Load::PrescribedMotion(Motion::Table { length, .. }) => Some(length),
        _ => None,
    }),
];

/// Why a path is no number of a scenario.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PlaceError {
    path: String,
    why: String,
    remedy: String,
}

impl fmt::Display for PlaceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.what(), self.remedy)
    }
}

impl std::error::Error for PlaceError {}

impl PlaceError {
    pub(crate) fn new(path: &str, why: &str, remedy: String) -> Self {
        Self { path: path.to_owned(), why: why.to_owned(), remedy }
    }

    /// What is wrong with the path.
    pub fn what(&self) -> String {
        format!("`{}` {}", self.path, self.why)
    }

    /// What to do about it.
    pub fn remedy(&self) -> &str {
        &self.remedy
    }
}

impl Place {
    /// The number at a path; of a joint the agonist's, or the antagonist's under `antagonist`.
    ///
    /// # Errors
    /// When there is no such key, when it is no number, or when this scenario has no such number.
    pub fn find(path: &str, scenario: &mut Scenario) -> Result<Self, PlaceError> {
        let Some(of_first) = in_antagonist(path) else { return Self::found("", path, scenario) };
        let fault = |why: &str, remedy: String| PlaceError { path: path.to_owned(), why: why.to_owned(), remedy };
        if !scenario.has_joint() {
            let remedy = "leave it out, or set load.kind = \"antagonistic-joint\"".to_owned();
            return Err(fault("is of a joint's second actuator, and there is none", remedy));
        }
        exchange(scenario);
        let found = Self::found("antagonist.", of_first, scenario);
        exchange(scenario);
        match found? {
            of_one if is_of_antagonist(of_one.parameter.key) => Ok(Self { of: [false, true], ..of_one }),
            _ => Err(fault("is no number of one actuator alone", format!("write `{of_first}`"))),
        }
    }

    /// Paths of the entries of a list of numbers at a path, in their order; `None` where the scenario has no such list. Of a joint
    /// the agonist's, or the antagonist's under `antagonist`.
    pub fn entries(path: &str, scenario: &mut Scenario) -> Option<Vec<String>> {
        let key = in_antagonist(path).unwrap_or(path);
        let (_, list) = LISTS.iter().find(|(row, _)| row.key == key)?;
        let of_second = key != path;
        if of_second && !scenario.has_joint() {
            return None;
        }
        if of_second {
            exchange(scenario);
        }
        let length = list(scenario).map(|list| list.len());
        if of_second {
            exchange(scenario);
        }
        Some((0..length?).map(|index| format!("{path}[{index}]")).collect())
    }

    /// The number of the first actuator at a path, which stands behind a prefix in messages.
    fn found(prefix: &str, path: &str, scenario: &mut Scenario) -> Result<Self, PlaceError> {
        let fault = |why: String, remedy: String| PlaceError { path: format!("{prefix}{path}"), why, remedy };
        let (key, index) = match list_and_entry(path) {
            Some((key, digits)) => {
                let index = digits.parse::<usize>().map_err(|_| {
                    fault(format!("has `{digits}` for a place in its list"), "count from 0, as in `[0]`".to_owned())
                })?;
                (key, Some(index))
            }
            None => (path, None),
        };
        let list = LISTS.iter().find(|(row, _)| row.key == key);
        let place = match (list, index) {
            (Some((row, list)), Some(index)) => Self::of_first(row, At::Entry(*list, index)),
            (Some(_), None) => {
                let remedy = format!("name one of its entries, as in `{prefix}{key}[0]`");
                return Err(fault("is a list".to_owned(), remedy));
            }
            (None, index) => {
                let row = KEYS.iter().find(|row| row.path == key).and_then(|row| row.parameter());
                match (row.and_then(|row| Some((row, field_of(row)?))), index) {
                    (Some((row, field)), None) => Self::of_first(row, At::Single(field)),
                    (Some(_), Some(_)) => {
                        return Err(fault("is no list".to_owned(), format!("write `{prefix}{key}`")));
                    }
                    (None, _) if AT_REST.iter().any(|row| row.key == key) => {
                        return Err(fault(
                            "describes the muscle at rest, from which thread length and turns follow".to_owned(),
                            format!("name `{prefix}{}` or `{prefix}{}`", p::THREAD_LENGTH.key, p::TURNS.key),
                        ));
                    }
                    (None, _) => {
                        let known = KEYS.iter().map(|row| row.path);
                        let remedy = match nearest(key, known) {
                            Some(near) if near != key => format!("did you mean `{prefix}{near}`?"),
                            _ => "name a quantity of the actuator, its air, valve, load or start".to_owned(),
                        };
                        return Err(fault("is no number that can be set one by one".to_owned(), remedy));
                    }
                }
            }
        };
        match place.value(scenario) {
            Some(_) => Ok(place),
            None => {
                let remedy = "choose the law or part that has it, or another key".to_owned();
                Err(fault("is no number of this scenario".to_owned(), remedy))
            }
        }
    }

    fn of_first(parameter: &'static Parameter, at: At) -> Self {
        Self { parameter, at, of: [true, !is_of_antagonist(parameter.key)] }
    }

    /// The parameter of both actuators of a joint, which then have one value.
    #[must_use]
    pub fn of_both(self) -> Self {
        Self { of: [true; 2], ..self }
    }

    /// Whether it is of the first actuator, and of the second of a joint.
    pub fn of_each(&self) -> [bool; 2] {
        self.of
    }

    /// Its row in the table of parameters.
    pub fn parameter(&self) -> &'static Parameter {
        self.parameter
    }

    /// Its path.
    pub fn path(&self) -> String {
        let path = match self.at {
            At::Single(_) => self.parameter.key.to_owned(),
            At::Entry(_, index) => format!("{}[{index}]", self.parameter.key),
        };
        if self.of[0] { path } else { format!("{ANTAGONIST}.{path}") }
    }

    /// The value in a scenario, if that has such a number; of both actuators the first's.
    pub fn value(&self, scenario: &mut Scenario) -> Option<f64> {
        self.with(usize::from(!self.of[0]), scenario, |slot| *slot)
    }

    /// Sets the value; `false` when the scenario has no such number.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when the value is outside the parameter's range.
    pub fn set(&self, scenario: &mut Scenario, value: f64) -> Result<bool, Error> {
        let value = self.parameter.check(value)?;
        let mut set = false;
        for actuator in (0..2).filter(|actuator| self.of[*actuator]) {
            set |= self.with(actuator, scenario, |slot| *slot = value).is_some();
        }
        Ok(set)
    }

    /// Does something with the number of one actuator, if the scenario has it.
    fn with<T>(&self, actuator: usize, scenario: &mut Scenario, does: impl FnOnce(&mut f64) -> T) -> Option<T> {
        if actuator == 1 && !scenario.has_joint() {
            return None;
        }
        let slot = |scenario: &mut Scenario| match self.at {
            At::Single(field) => field(scenario).map(does),
            At::Entry(list, index) => list(scenario)?.get_mut(index).map(does),
        };
        if actuator == 0 {
            return slot(scenario);
        }
        exchange(scenario);
        let done = slot(scenario);
        exchange(scenario);
        done
    }
}

impl Document {
    /// The number at a path in its scenario, which is estimated together with `others`: what it says of both actuators
    /// of a joint is one number of both, unless the antagonist's is among these separately.
    ///
    /// # Errors
    /// As [`Place::find`].
    pub fn find<'p>(
        &self,
        path: &str,
        others: impl IntoIterator<Item = &'p str>,
        scenario: &mut Scenario,
    ) -> Result<Place, PlaceError> {
        let place = Place::find(path, scenario)?;
        let alone = others.into_iter().any(|other| in_antagonist(other) == Some(path));
        let shared = place.of_each()[0] && !alone && self.says_of_both(path);
        Ok(if shared { place.of_both() } else { place })
    }

    /// Whether what it says of the first actuator of a joint at a key holds for the second too, since `[antagonist]` says
    /// nothing else; a path to an entry of a list stands for the list.
    pub fn says_of_both(&self, path: &str) -> bool {
        let key = path.split_once('[').map_or(path, |(key, _)| key);
        let Some(section) = self.place(ANTAGONIST).cloned() else { return true };
        // A mark in its place is there for the second too, or something else is.
        let mut marked = self.clone();
        let node = Node { place: section.clone(), value: Value::Number(0.0) };
        marked.put(key, &section, &node);
        marked.antagonist().entry(key).is_some_and(|entry| entry.node.place.is(&section))
    }

    /// Whether it says a key of the first actuator, and of the second of a joint.
    pub fn says_of_each(&self, key: &str) -> [bool; 2] {
        [self.contains(key), self.antagonist().contains(key)]
    }
}

impl fmt::Debug for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Place({})", self.path())
    }
}

impl PartialEq for Place {
    fn eq(&self, other: &Self) -> bool {
        self.of == other.of && self.path() == other.path()
    }
}

/// Seeds of derivatives with respect to some parameters, for the functions `map` of the core's parts: give each part
/// once.
#[derive(Clone, Debug)]
pub struct Seeds {
    places: Vec<Place>,
    /// How many entries of its list have passed, for each place and actuator.
    passed: Vec<[usize; 2]>,
    /// Whether its number has been met.
    met: Vec<bool>,
    /// Numbers that follow from those of places: each with its actuator and its derivative by each place.
    followers: Vec<(&'static Parameter, usize, Vec<f64>)>,
}

impl Seeds {
    /// One direction for each place, in their order.
    pub fn new(places: impl IntoIterator<Item = Place>) -> Self {
        let places: Vec<Place> = places.into_iter().collect();
        Self { passed: vec![[0; 2]; places.len()], met: vec![false; places.len()], followers: Vec::new(), places }
    }

    /// Has what a scenario leaves out follow from the places: the start of a reservoir, that of a muscle whose pressure over time
    /// is given, and of those actuators of which `least_follows` says so the least length.
    #[must_use]
    pub fn with_followers(mut self, of: &Scenario, least_follows: [bool; 2]) -> Self {
        self.follow(0, of, least_follows[0]);
        if let Some(second) = of.of_antagonist() {
            self.follow(1, &second, least_follows[1]);
        }
        self
    }

    fn follow(&mut self, actuator: usize, of: &Scenario, least_follows: bool) {
        for follower in Follower::ALL.into_iter().filter(|of| least_follows || *of != Follower::LeastLength) {
            let by = |place: &Place| {
                let number = |row: &'static Parameter, entry: usize, value: f64| {
                    let is_it = place.parameter.key == row.key && place.of[actuator];
                    let moves = is_it && !matches!(place.at, At::Entry(_, index) if index != entry);
                    Dual { value, slope: [f64::from(u8::from(moves))] }
                };
                follower.value(of, number).map(|Dual { slope: [slope], .. }| slope)
            };
            if let Some(shares) = self.places.iter().map(by).collect::<Option<Vec<f64>>>() {
                self.followers.push((follower.parameter(), actuator, shares));
            }
        }
    }

    /// The places whose numbers have not been met: the scenario has them, but not the parts that were mapped. A wall of no
    /// thickness is no part.
    pub fn missed(&self) -> impl Iterator<Item = &Place> {
        self.places.iter().zip(&self.met).filter(|(_, met)| !**met).map(|(place, _)| place)
    }

    /// The number with its derivatives. Directions from `K` on are left out.
    pub fn over<const K: usize>(&mut self, parameter: &'static Parameter, value: f64) -> Dual<f64, K> {
        self.over_of(None, parameter, value)
    }

    /// Dual numbers for a parameter of a joint's first or second actuator, 0 or 1, or of the joint itself.
    pub fn over_of<const K: usize>(
        &mut self,
        actuator: Option<usize>,
        parameter: &'static Parameter,
        value: f64,
    ) -> Dual<f64, K> {
        let (mut dual, of) = (Dual::of(value), actuator.unwrap_or(0));
        let here = |place: &Place| place.parameter.key == parameter.key && place.of[of];
        for (direction, place) in self.places.iter().enumerate().filter(|(_, place)| here(place)) {
            let met = match place.at {
                At::Single(_) => true,
                At::Entry(_, index) => {
                    let passed = &mut self.passed[direction][of];
                    *passed += 1;
                    *passed == index + 1
                }
            };
            self.met[direction] |= met;
            if let Some(slope) = dual.slope.get_mut(direction).filter(|_| met) {
                *slope = 1.0;
            }
        }
        let here = |(row, actuator, _): &&(&Parameter, usize, Vec<f64>)| row.key == parameter.key && *actuator == of;
        for (_, _, shares) in self.followers.iter().filter(here) {
            dual.slope.iter_mut().zip(shares).for_each(|(slope, share)| *slope += share);
        }
        dual
    }
}
