//! How much a valve must let through for a stroke in a time, by simulation of one muscle that lifts its share of the load.
//!
//! The valve opens at t = 0, at the supply's pressure; the muscle starts at rest without pressure. The time is that at which nine
//! tenths of the stroke are done for the first time: the last tenth goes as slowly as the pressures meet.

use super::ripple::{self, Pulses};
use super::{Candidate, Check, Requirement};
use crate::failure::Failure;
use crate::quantities;
use crate::report::number;
use mckibben::plant::{RigPlant, RigReader};
use mckibben_scenario::{Document, presets};

/// How much of the stroke is to be done.
const DONE: f64 = 0.9;
/// Conductances in m³/(s·Pa) between which a valve is looked for: 0.006 to 60 000 L/(min·bar).
const CONDUCTANCES: [f64; 2] = [1e-12, 1e-5];
/// Critical pressure ratio of a valve of which nothing is known: ISO 6358 names 0.2 to 0.5.
const CRITICAL_RATIO: f64 = 0.3;
/// Inner diameters in m of hoses that are sold.
const DIAMETERS: [f64; 8] = [10e-3, 8e-3, 6e-3, 5e-3, 4e-3, 3e-3, 2.5e-3, 2e-3];
/// Where in a run the way is looked at, and to which part the conductance is found.
const LOOKS: usize = 400;
const WITHIN: f64 = 1e-3;
const TOLERANCE: f64 = 1e-6;

/// How quick the muscle can be.
#[derive(Clone, Debug, PartialEq)]
pub enum Quickness {
    /// The least sonic conductance in m³/(s·Pa) of the valve.
    Conductance(f64),
    /// No valve is wide enough: with one that throttles nothing it takes this time in s, or longer than was looked at.
    TooSlow(Option<f64>),
    /// The muscle does not hold the load without pressure, so that it has no start at rest.
    NoStart,
}

/// What a hose requires of the valve.
#[derive(Clone, Debug, PartialEq)]
pub struct Hose {
    /// Inner diameter in m.
    pub diameter: f64,
    /// What the valve must let through then.
    pub quickness: Quickness,
}

/// How many times the time that is due a lift through the widest valve is looked for.
const LONGEST: f64 = 1000.0;

/// How quick a valve that can be bought is.
#[derive(Clone, Debug, PartialEq)]
pub struct ValveTime {
    /// Name of the preset.
    pub name: &'static str,
    /// Time in s; none if it takes longer than was looked at.
    pub time: Option<f64>,
    /// The slowest pulses that keep the muscle still, where a ripple was requested; none where there are no such.
    pub pulses: Option<Pulses>,
}

impl Quickness {
    /// The conductance in m³/(s·Pa), if one is enough.
    pub fn conductance(&self) -> Option<f64> {
        match self {
            Self::Conductance(least) => Some(*least),
            Self::TooSlow(_) | Self::NoStart => None,
        }
    }

    /// In L/(min·bar), or that there is none.
    pub fn words(&self) -> String {
        match self {
            Self::Conductance(least) => number(litres_per_minute_and_bar(*least), 2),
            Self::TooSlow(Some(time)) => format!("none: {} at best", quantities::given(*time, "s")),
            Self::TooSlow(None) => format!("none: over {LONGEST:.0} times as long"),
            Self::NoStart => "cannot hang unfilled".to_owned(),
        }
    }
}

fn litres_per_minute_and_bar(conductance: f64) -> f64 {
    conductance * 1e3 * 60.0 * 1e5
}

/// A valve by its sonic conductance, as keys of a file.
pub(super) fn valve_of(conductance: f64) -> String {
    format!(
        "[valve]\nkind = \"three-way\"\nsonic_conductance = \"{:.4} L/(min*bar)\"\ncritical_ratio = {CRITICAL_RATIO}\n",
        litres_per_minute_and_bar(conductance)
    )
}

fn hose_of(length: f64, diameter: f64) -> String {
    format!("[hose]\nlength = \"{length} m\"\ndiameter = \"{diameter} m\"\n")
}

/// The command of a valve that opens to the supply, and stays open.
const FILL: &str = "[command]\nkind = \"fill\"\n";

/// A scenario with what feeds its muscle: valve, command and hose.
pub(super) fn fed(scenario: &str, requirement: &Requirement, [valve, command, hose]: [&str; 3]) -> String {
    let pressure = requirement.gauge_pressure;
    format!("{scenario}\n[supply]\ngauge_pressure = \"{pressure} Pa\"\n\n{valve}\n{command}\n{hose}")
}

/// When in s nine tenths of the stroke are done; none up to `until`.
fn time_of(text: &str, requirement: &Requirement, until: f64, check: &Check<'_>) -> Result<Option<f64>, Failure> {
    let experiment = Document::parse(text, "the candidate")?.experiment()?;
    let end = experiment.rig.actuator().limits().max_length() - DONE * requirement.stroke;
    let run = RigPlant::new(&experiment.rig)
        .record(&experiment.start, (until, TOLERANCE), None, &mut |time| check(time))
        .map_err(|error| Failure::stopped(error.to_string()))?;
    let mut reader = RigReader::new(&run);
    let mut is_there = |time: f64| reader.read(time).length <= end;
    let mut instants = (1..=LOOKS).map(|k| until * k as f64 / LOOKS as f64);
    let Some(after) = instants.find(|time| is_there(*time)) else { return Ok(None) };
    let (mut low, mut high) = (after - until / LOOKS as f64, after);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if is_there(middle) { high = middle } else { low = middle }
    }
    Ok(Some(high))
}

/// The least valve that is quick enough, behind a hose of a length and diameter in m if there is one.
pub(super) fn quickness(
    scenario: &str,
    requirement: &Requirement,
    time: f64,
    hose: Option<[f64; 2]>,
    check: &Check<'_>,
) -> Result<Quickness, Failure> {
    let hose = hose.map_or(String::new(), |[length, diameter]| hose_of(length, diameter));
    let of = |conductance: f64, until: f64| {
        time_of(&fed(scenario, requirement, [&valve_of(conductance), FILL, &hose]), requirement, until, check)
    };
    let [mut low, mut high] = CONDUCTANCES.map(f64::ln);
    let first = fed(scenario, requirement, [&valve_of(CONDUCTANCES[1]), FILL, &hose]);
    if Document::parse(&first, "the candidate")?.experiment().is_err() {
        return Ok(Quickness::NoStart);
    }
    if of(high.exp(), time)?.is_none() {
        // Further and further, so that the interval that is looked at stays fine for one that is only a little too slow.
        let mut times = 10.0;
        loop {
            let found = of(high.exp(), times * time)?;
            if found.is_some() || times >= LONGEST {
                return Ok(Quickness::TooSlow(found));
            }
            times *= 10.0;
        }
    }
    while high - low > WITHIN {
        let middle = 0.5 * (low + high);
        if of(middle.exp(), time)?.is_some() { high = middle } else { low = middle }
    }
    Ok(Quickness::Conductance(high.exp()))
}

/// What hoses of a length in m require of the valve.
pub(super) fn hoses(
    scenario: &str,
    requirement: &Requirement,
    time: f64,
    length: f64,
    check: &Check<'_>,
) -> Result<Vec<Hose>, Failure> {
    if !(length > 0.0 && length.is_finite()) {
        return Err(Failure::input("the hose has no length", "give --hose a length above zero, such as \"2 m\""));
    }
    let of = |diameter: &f64| {
        let quickness = quickness(scenario, requirement, time, Some([length, *diameter]), check)?;
        Ok(Hose { diameter: *diameter, quickness })
    };
    DIAMETERS.iter().map(of).collect()
}

/// How quick valves that can be bought are. Those that only follow set points or positions are left out.
pub(super) fn of_presets(
    scenario: &str,
    requirement: &Requirement,
    time: f64,
    check: &Check<'_>,
) -> Result<Vec<ValveTime>, Failure> {
    let mut found = Vec::new();
    for preset in presets::VALVES {
        let valve = format!("[valve]\npreset = \"{}\"\n", preset.name);
        let text = fed(scenario, requirement, [&valve, FILL, ""]);
        let is_filled = Document::parse(&text, preset.name).is_ok_and(|document| document.experiment().is_ok());
        if is_filled {
            let pulses = match requirement.ripple {
                Some(swing) => ripple::pulses(scenario, requirement, &valve, swing, check)?,
                None => None,
            };
            found.push(ValveTime { name: preset.name, time: time_of(&text, requirement, 10.0 * time, check)?, pulses });
        }
    }
    found.sort_by(|one, other| {
        let of = |its: &ValveTime| its.time.unwrap_or(f64::INFINITY);
        of(one).total_cmp(&of(other))
    });
    Ok(found)
}

/// A scenario file of one muscle of a candidate.
pub(super) fn written(candidate: &Candidate, requirement: &Requirement) -> String {
    let head = format!(
        "# {}: {}, by `mckibben size`. Friction is none: state it under [actuator].\n\n",
        candidate.name,
        match candidate.count {
            1 => "one muscle with the load".to_owned(),
            count => format!("one of {count} muscles side by side, with its share of the load"),
        }
    );
    let least = candidate.quickness.as_ref().and_then(Quickness::conductance);
    match (least, &candidate.pulses) {
        (Some(least), Some(Pulses { frequency, duty, gauge_pressure, .. })) => {
            let start = ripple::start(*gauge_pressure);
            let command = ripple::command(*frequency, *duty);
            head + &fed(&candidate.scenario, requirement, [&valve_of(least), &command, &start])
        }
        (Some(least), None) => head + &fed(&candidate.scenario, requirement, [&valve_of(least), FILL, ""]),
        (None, _) => head + &candidate.scenario + "\n" + &ripple::start(candidate.needed_pressure),
    }
}
