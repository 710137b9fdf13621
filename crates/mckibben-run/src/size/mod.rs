//! Which muscles move a load over a stroke: braids of free size and the presets, and the valve that is quick enough.
//!
//! The load F pulls all the way. The muscles hang on it at rest, at their greatest length and without pressure; at the pressure P
//! they hold it where `F_s(L, P) = F`, and the stroke is how much shorter they are there. Everything but the size of a free braid
//! is computed by the core from the scenario of each candidate, friction aside: it is what `mckibben simulate` would have at rest.
//!
//! | file | its idea |
//! |---|---|
//! | `free` | the smallest braid of a braid angle |
//! | `valve` | how much a valve must let through for a time, by simulation |
//! | `ripple` | how fast it must be pulsed so that the muscle keeps still, by the linear model |
//!
//! Checked by the tests of `free` and by the program's `tests/size.rs`.

mod free;
mod ripple;
mod valve;

use crate::failure::Failure;
use crate::linearize::Measure;
use crate::quantities::{self, digits};
use crate::report::{Data, Table, number};
use crate::table::{Cell, Column, Writer};
use crate::warnings::EFFECTIVENESS;
use mckibben::{Actuator, GaugePressure};
use mckibben_plot::{Axis, Colour, Figure, Panel, Series};
use mckibben_scenario::{Document, presets};
pub use ripple::Pulses;
use std::path::Path;
use std::str::FromStr;
pub use valve::{Hose, Quickness, ValveTime};

/// More muscles side by side than anybody mounts.
const MOST_SIDE_BY_SIDE: usize = 8;
/// Temperature in K at which air is counted.
const ROOM: f64 = 293.15;
/// Standard gravity in m/s², by which a load has its mass.
const GRAVITY: f64 = 9.80665;
/// Points of a curve in the figure.
const POINTS: usize = 80;
/// What to do where a time is missing.
const NO_TIME: &str = "say with --time within which time nine tenths of the stroke are to be done";
/// How much of a stroke may be missing by rounding of the sizes.
const ROUNDING: f64 = 1e-6;

/// Called now and then with a time in s that a run has reached; its error, such as [`mckibben::Error::Interrupted`], ends the work.
pub type Check<'a> = dyn Fn(f64) -> Result<(), mckibben::Error> + 'a;

/// The check of a caller that waits for the end.
pub const UNCHECKED: &Check<'static> = &|_| Ok(());

/// The force in N of a load: of a mass its weight.
pub fn force_of(load: Measure) -> f64 {
    match load {
        Measure::Mass(mass) => mass * GRAVITY,
        Measure::Force(force) => force,
    }
}

/// Braid angles in rad, written as in `20,25,30` or `0.4,0.5rad`; without a unit they are in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct BraidAngles(pub Vec<f64>);

impl FromStr for BraidAngles {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let read = quantities::read_list(text, ["angle", "rad", "deg or rad"], Some("deg"))?;
        Ok(Self(read.into_iter().map(|(angle, _)| angle).collect()))
    }
}

/// What is to be moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// Force in N that pulls on the muscles all the way.
    pub load: f64,
    /// How far in m the load is lifted.
    pub stroke: f64,
    /// Gauge pressure in Pa that there is.
    pub gauge_pressure: f64,
    /// Braid angles in rad at rest of the braids that are made to measure.
    pub braid_angles: Vec<f64>,
    /// Measured force over that of the ideal braid, for braids that are made to measure.
    pub effectiveness: f64,
    /// The greatest length in m that a muscle may have at rest.
    pub most_length: Option<f64>,
    /// The greatest diameter in m that a braid may have at rest.
    pub most_diameter: Option<f64>,
    /// Time in s within which nine tenths of the stroke are to be done.
    pub time: Option<f64>,
    /// Peak to peak swing of the length in m that pulses may leave in the middle of the stroke; with a time.
    pub ripple: Option<f64>,
}

/// Muscles that do it.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// `braid of 25°`, or the name of a preset.
    pub name: String,
    /// How many there are side by side.
    pub count: usize,
    /// Length in m at rest.
    pub length: f64,
    /// Diameter in m of the braid at rest.
    pub diameter: f64,
    /// Thread length in m and turns.
    pub thread: [f64; 2],
    /// Contraction under the load at the whole pressure, over the length at rest.
    pub contraction: f64,
    /// Gauge pressure in Pa at which the stroke is done.
    pub needed_pressure: f64,
    /// Force in N of all at rest length and the whole pressure.
    pub force_at_rest: f64,
    /// Mass in kg of the air that a stroke takes at a temperature of 293.15 K, all muscles together: from the greatest length without
    /// pressure to the end of the stroke. Air that is warmer, as in the isentropic process of a scenario, is less.
    pub air: f64,
    /// How quick a valve makes it, where a time was requested.
    pub quickness: Option<Quickness>,
    /// The slowest pulses that keep it still, where a ripple was requested.
    pub pulses: Option<Pulses>,
    /// The scenario of one of them, without a valve.
    scenario: String,
    actuator: Actuator,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Sizes {
    requirement: Requirement,
    /// Muscles that do it, those that take the least air first.
    pub candidates: Vec<Candidate>,
    /// What does not do it, and why.
    pub left_out: Vec<String>,
}

/// Numbers of the candidates, each row with the name of its muscle.
#[derive(Clone, Debug)]
pub struct NamedData {
    names: Vec<String>,
    data: Data,
}

impl Requirement {
    /// That it can be met at all.
    ///
    /// # Errors
    /// A number outside its range.
    pub fn check(&self) -> Result<(), Failure> {
        let positive = [
            ("--load", Some(self.load), "N"),
            ("--stroke", Some(self.stroke), "m"),
            ("--gauge-pressure", Some(self.gauge_pressure), "Pa"),
            ("--effectiveness", Some(self.effectiveness), ""),
            ("--most-length", self.most_length, "m"),
            ("--most-diameter", self.most_diameter, "m"),
            ("--time", self.time, "s"),
            ("--ripple", self.ripple, "m"),
        ];
        for (name, value, unit) in positive {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                let title = format!("`{name}` is {}, which is not above zero", quantities::given(value, unit));
                return Err(Failure::input(title, "give a value above zero"));
            }
        }
        if self.effectiveness > EFFECTIVENESS {
            let title = format!(
                "`--effectiveness` is {}: no braid pulls with more than {} times the force of the ideal one",
                digits(self.effectiveness),
                quantities::plain(&digits(EFFECTIVENESS)),
            );
            return Err(Failure::input(title, "give a share of that force: 80 % is 0.8"));
        }
        if self.ripple.is_some() && self.time.is_none() {
            return Err(Failure::input("a ripple is that of a valve, which is chosen by a time", NO_TIME));
        }
        let neutral = free::neutral_angle();
        if let Some(angle) = self.braid_angles.iter().find(|angle| !(5f64.to_radians()..neutral).contains(*angle)) {
            let title = format!("a braid angle is {}°", digits(angle.to_degrees()));
            let remedy = "give angles from 5 deg to less than 54.7 deg, where a braid no longer contracts";
            return Err(Failure::input(title, remedy));
        }
        Ok(())
    }
}

impl Sizes {
    /// Looks for muscles; `check` may end it.
    ///
    /// # Errors
    /// As [`Requirement::check`]; what the core refuses of a candidate; those of `check`.
    pub fn of(requirement: Requirement, check: &Check<'_>) -> Result<Self, Failure> {
        requirement.check()?;
        let (mut candidates, mut left_out) = (Vec::new(), Vec::new());
        for angle in &requirement.braid_angles {
            match free::braid(&requirement, *angle) {
                Ok((count, text)) => {
                    let name = format!("braid of {}°", digits_of(angle.to_degrees()));
                    match Candidate::of(name.clone(), count, &text, &requirement)? {
                        Ok(candidate) => candidates.push(candidate),
                        Err(reached) => {
                            left_out.push(format!("the {name} shortens by {}", quantities::given(reached, "m")));
                        }
                    }
                }
                Err(why) => left_out.push(why),
            }
        }
        for preset in presets::ACTUATORS {
            match of_preset(preset.name, &requirement)? {
                Ok(candidate) => candidates.push(candidate),
                Err(why) => left_out.push(why),
            }
        }
        candidates.sort_by(|one, other| one.air.total_cmp(&other.air));
        if let Some(time) = requirement.time {
            for candidate in &mut candidates {
                let quickness = valve::quickness(&candidate.scenario, &requirement, time, None, check)?;
                if let (Some(least), Some(swing)) = (quickness.conductance(), requirement.ripple) {
                    let valve = valve::valve_of(least);
                    candidate.pulses = ripple::pulses(&candidate.scenario, &requirement, &valve, swing, check)?;
                }
                candidate.quickness = Some(quickness);
            }
        }
        Ok(Self { requirement, candidates, left_out })
    }

    /// What is to be moved.
    pub fn requirement(&self) -> &Requirement {
        &self.requirement
    }

    /// The scenario file of a candidate: one of its muscles, that lifts its share of the load with the valve that is needed.
    ///
    /// # Errors
    /// There is no such candidate.
    pub fn scenario(&self, place: usize) -> Result<String, Failure> {
        let candidate = self.candidate(place)?;
        Ok(valve::written(candidate, &self.requirement))
    }

    /// What hoses of a length (m) require of the valve of a candidate: the widest first. `check` may end it.
    ///
    /// # Errors
    /// There is no such candidate, or no time was requested; those of `check`.
    pub fn hoses(&self, place: usize, length: f64, check: &Check<'_>) -> Result<Vec<Hose>, Failure> {
        let candidate = self.candidate(place)?;
        let time = self.time()?;
        valve::hoses(&candidate.scenario, &self.requirement, time, length, check)
    }

    /// How quick valves that can be bought make a candidate; `check` may end it.
    ///
    /// # Errors
    /// There is no such candidate, or no time was requested; those of `check`.
    pub fn valves(&self, place: usize, check: &Check<'_>) -> Result<Vec<ValveTime>, Failure> {
        let candidate = self.candidate(place)?;
        valve::of_presets(&candidate.scenario, &self.requirement, self.time()?, check)
    }

    fn candidate(&self, place: usize) -> Result<&Candidate, Failure> {
        let count = self.candidates.len();
        self.candidates.get(place).ok_or_else(|| {
            if count == 0 {
                let help = "lower the load or the stroke, raise the pressure, or allow longer or wider muscles";
                return Failure::input("no muscle does it", help);
            }
            let places = if count == 1 { "one place".to_owned() } else { format!("{count} places") };
            let title = format!("the table has {places}, and none of them is place {}", place.wrapping_add(1));
            Failure::input(
                title,
                if count == 1 { "give place 1".to_owned() } else { format!("give a place from 1 to {count}") },
            )
        })
    }

    /// Why there is no valve for a candidate, in a sentence without its point; none where there is one, or no time was requested.
    ///
    /// # Errors
    /// There is no such candidate.
    pub fn without_valve(&self, place: usize) -> Result<Option<String>, Failure> {
        let candidate = self.candidate(place)?;
        let why = match candidate.quickness {
            None | Some(Quickness::Conductance(_)) => return Ok(None),
            Some(Quickness::NoStart) => {
                "it does not hold the load without pressure, so no lift starts at rest".to_owned()
            }
            Some(Quickness::TooSlow(Some(time))) => {
                format!("through a valve of any width the lift takes at least {}", quantities::given(time, "s"))
            }
            Some(Quickness::TooSlow(None)) => "no valve is wide enough for this time".to_owned(),
        };
        Ok(Some(format!("there is no valve for place {}, {}: {why}", place.wrapping_add(1), candidate.name)))
    }

    fn time(&self) -> Result<f64, Failure> {
        self.requirement.time.ok_or_else(|| Failure::input("valves and hoses are chosen by a time", NO_TIME))
    }

    /// The candidates for people.
    pub fn table(&self) -> Table {
        let mut head =
            vec!["", "muscle", "side by side", "length mm", "diameter mm", "thread mm", "turns", "contraction %"];
        head.extend(["pressure bar", "force at rest N", "air mg"]);
        if self.requirement.time.is_some() {
            head.push("valve C L/(min·bar)");
        }
        if self.requirement.ripple.is_some() {
            head.extend(["PWM Hz", "duty"]);
        }
        let rows = self.candidates.iter().enumerate().map(|(place, its)| {
            let mut row = vec![
                (place + 1).to_string(),
                its.name.clone(),
                its.count.to_string(),
                number(1e3 * its.length, 1),
                number(1e3 * its.diameter, 1),
                number(1e3 * its.thread[0], 1),
                number(its.thread[1], 3),
                number(100.0 * its.contraction, 1),
                number(1e-5 * its.needed_pressure, 2),
                number(its.force_at_rest, 1),
                number(1e6 * its.air, 1),
            ];
            row.extend(its.quickness.as_ref().map(Quickness::words));
            if self.requirement.ripple.is_some() {
                row.extend(match &its.pulses {
                    Some(Pulses { frequency, duty, .. }) => [number(*frequency, 1), number(*duty, 3)],
                    None => ["none", "–"].map(String::from),
                });
            }
            row
        });
        let rows = rows.collect();
        let each = match self.requirement.time {
            Some(time) => format!(
                "; C is the least sonic conductance of each muscle's valve for nine tenths of the stroke in {}",
                quantities::given(time, "s")
            ),
            None => String::new(),
        };
        let still = match self.requirement.ripple {
            Some(swing) => format!(
                "; PWM at that frequency and duty holds the middle of the stroke within {}, peak to peak",
                quantities::given(swing, "m")
            ),
            None => String::new(),
        };
        let caption = format!(
            "Muscles for {} over {} at {} gauge, the least air first, air at {ROOM} K{each}{still}:",
            quantities::given(self.requirement.load, "N"),
            quantities::given(self.requirement.stroke, "m"),
            quantities::given(self.requirement.gauge_pressure, "Pa"),
        );
        Table { caption, head: head.into_iter().map(String::from).collect(), rows }
    }

    /// The candidates with all numbers in SI.
    ///
    /// # Errors
    /// As [`Data::check`].
    pub fn data(&self) -> Result<NamedData, Failure> {
        let columns = [
            "rank",
            "count",
            "braid_angle_rad",
            "length_m",
            "diameter_m",
            "thread_length_m",
            "turns",
            "contraction",
            "needed_gauge_pressure_pa",
            "force_at_rest_n",
            "air_kg",
            "sonic_conductance_m3_s_pa",
            "pwm_frequency_hz",
            "pwm_duty",
        ];
        let mut data = Data::new(&columns).lacking(&columns[columns.len() - 3..]);
        for (place, its) in self.candidates.iter().enumerate() {
            let least = its.quickness.as_ref().and_then(Quickness::conductance).unwrap_or(f64::NAN);
            let [thread, turns] = its.thread;
            let (length, diameter) = (its.length, its.diameter);
            let angle = (length / thread).min(1.0).acos();
            let sizes = [(place + 1) as f64, its.count as f64, angle, length, diameter, thread, turns];
            let [frequency, duty] = its.pulses.as_ref().map_or([f64::NAN; 2], |of| [of.frequency, of.duty]);
            let rest = [its.contraction, its.needed_pressure, its.force_at_rest, its.air, least, frequency, duty];
            data.rows.push(sizes.into_iter().chain(rest).collect());
        }
        data.check()?;
        Ok(NamedData { names: self.candidates.iter().map(|its| its.name.clone()).collect(), data })
    }

    /// The force of each candidate over its shortening, at the whole pressure, with the load and the stroke.
    pub fn figure(&self) -> Figure {
        let mut panel = Panel::new(Axis::new("force", "N"));
        let last = self.candidates.len().max(2) - 1;
        let stroke = self.requirement.stroke;
        for (place, its) in self.candidates.iter().enumerate() {
            let actuator = &its.actuator;
            let pressure = GaugePressure(self.requirement.gauge_pressure).absolute(actuator.air().atmosphere()).0;
            let [shortest, longest] = [actuator.limits().min_length(), actuator.limits().max_length()];
            let furthest = (longest - shortest).min(2.0 * stroke);
            let way: Vec<f64> = (0..=POINTS).map(|k| furthest * k as f64 / POINTS as f64).collect();
            let force = |way: &f64| its.count as f64 * actuator.static_force(longest - way, pressure);
            let forces: Vec<f64> = way.iter().map(force).collect();
            let here: Vec<(f64, f64)> = way.into_iter().zip(forces).filter(|(_, force)| *force >= 0.0).collect();
            let (x, y) = here.into_iter().map(|(way, force)| (1e3 * way, force)).unzip();
            let side = if its.count > 1 { format!("{} × ", its.count) } else { String::new() };
            let colour = Colour::Ramp(place as f64 / last as f64);
            panel = panel.series(Series::line(format!("{side}{}", its.name), x, y).colour(colour));
        }
        let panel = panel.horizontal(self.requirement.load, "load").vertical(1e3 * stroke, "stroke");
        let caption = format!(
            "Force at rest at {} gauge over the shortening from the greatest length; muscles side by side together.",
            quantities::given(self.requirement.gauge_pressure, "Pa")
        );
        Figure::new(Axis::new("shortening", "mm"))
            .title("Muscles that lift the load over the stroke")
            .caption(caption)
            .size_mm(120.0, 70.0)
            .panel(panel)
    }
}

impl NamedData {
    /// The table as CSV, with the names behind the ranks; messages name `path`.
    ///
    /// # Errors
    /// [`Failure::output`] when the CSV cannot be made.
    pub fn to_csv(&self, path: &Path) -> Result<Vec<u8>, Failure> {
        let mut columns = self.data.columns.clone();
        columns.insert(1, Column::word("name"));
        let mut writer = Writer::csv(columns, path, Vec::new())?;
        for (name, numbers) in self.names.iter().zip(&self.data.rows) {
            let cell = |value: &f64| if value.is_nan() { Cell::Nothing } else { Cell::Number(*value) };
            let mut row: Vec<Cell<'_>> = numbers.iter().map(cell).collect();
            row.insert(1, Cell::Word(name));
            writer.row(&row)?;
        }
        writer.finish(&[])
    }
}

impl Candidate {
    /// Muscles side by side, each of which has a share of the load, by the keys of one of them; or how far in m they come where
    /// that is not the stroke.
    fn of(name: String, count: usize, actuator: &str, requirement: &Requirement) -> Result<Result<Self, f64>, Failure> {
        let share = requirement.load / count as f64;
        let scenario = format!(
            "{actuator}\n[load]\nkind = \"hanging-mass\"\nmass = \"{:.9} kg\"\n\n[run]\nduration = \"1 s\"\n",
            share / GRAVITY
        );
        let document = Document::parse(&scenario, &name)?;
        let rig = document
            .scenario()?
            .rig()
            .map_err(|error| Failure::input(format!("{name}: {error}"), "change the request"))?;
        let actuator = rig.actuator().clone();
        let atmosphere = actuator.air().atmosphere();
        let limits = *actuator.limits();
        // Where the load would pull the braid straight it does not go up at all.
        let way = |gauge: f64| match rig.equilibrium(GaugePressure(gauge).absolute(atmosphere)) {
            Ok(length) => limits.max_length() - length,
            Err(_) => f64::NEG_INFINITY,
        };
        let reached = way(requirement.gauge_pressure);
        if reached.is_nan() || reached < requirement.stroke * (1.0 - ROUNDING) {
            return Ok(Err(reached.max(0.0)));
        }
        let (mut low, mut high) = (0.0, requirement.gauge_pressure);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if way(middle) < requirement.stroke { low = middle } else { high = middle }
        }
        let braid = &actuator.law().law.braid;
        let content = |gauge: f64, length: f64| {
            actuator.air().mass(GaugePressure(gauge).absolute(atmosphere), actuator.volume(length), ROOM)
        };
        let end = limits.max_length() - way(high);
        let whole = GaugePressure(requirement.gauge_pressure).absolute(atmosphere).0;
        Ok(Ok(Self {
            count,
            length: limits.max_length(),
            diameter: braid.diameter(limits.max_length()),
            thread: [braid.thread_length(), braid.turns()],
            contraction: reached / limits.max_length(),
            needed_pressure: high,
            force_at_rest: count as f64 * actuator.static_force(limits.max_length(), whole),
            air: count as f64 * (content(high, end) - content(0.0, limits.max_length())),
            quickness: None,
            pulses: None,
            name,
            scenario,
            actuator,
        }))
    }
}

/// So many muscles of a preset that they do it, or why none do.
fn of_preset(name: &'static str, requirement: &Requirement) -> Result<Result<Candidate, String>, Failure> {
    let text = format!("[actuator]\npreset = \"{name}\"\n");
    let mut furthest = 0.0_f64;
    for count in 1..=MOST_SIDE_BY_SIDE {
        match Candidate::of(name.to_owned(), count, &text, requirement)? {
            Ok(candidate) => {
                let sizes =
                    [(candidate.length, requirement.most_length), (candidate.diameter, requirement.most_diameter)];
                if sizes.iter().any(|(size, most)| most.is_some_and(|most| *size > most)) {
                    return Ok(Err(format!("{name} is longer or wider than allowed")));
                }
                return Ok(Ok(candidate));
            }
            Err(reached) => furthest = furthest.max(reached),
        }
    }
    let way = quantities::given(furthest, "m");
    Ok(Err(format!("{name} shortens by {way} under the load, {MOST_SIDE_BY_SIDE} side by side")))
}

/// A number without zeros at its end.
fn digits_of(value: f64) -> String {
    quantities::plain(&digits(value)).to_owned()
}
