//! The unknowns of a study: their places, bounds, priors and starts.

use super::Material;
use super::outcome::WARNED;
use super::sensors::{self, OfSensor};
use crate::failure::Failure;
use crate::quantities;
use mckibben::parameter::{self, Parameter};
use mckibben_identify::least_squares::Unknown;
use mckibben_identify::study::{FitEntry, Input, Study};
use mckibben_scenario::keys::in_antagonist;
use mckibben_scenario::{Document, InitialLength, Place, PlaceError, Scenario, quantity as grammar};

/// All of them, in the scenario of the study.
pub(super) fn all(material: &Material) -> Result<(Vec<Place>, Vec<Unknown>), Failure> {
    let mut scenario = material.document.scenario()?;
    let mut found = (Vec::new(), Vec::new());
    for entry in entries(material)? {
        let place = place(material, entry, (&material.document, &mut scenario), None)?;
        found.1.push(unknown(&material.study, entry, place.parameter(), place.value(&mut scenario).unwrap_or(0.0))?);
        found.0.push(place);
    }
    Ok(found)
}

/// The numbers of one run: their places in its scenario, and which unknown each of them is; those of its sensors likewise.
pub(super) struct OfRun<P> {
    pub(super) places: Vec<P>,
    pub(super) unknowns: Vec<usize>,
    pub(super) sensors: Vec<(OfSensor, usize)>,
}

/// A number in a scenario: its place, its row in the table of parameters, and the value that it has there.
pub(super) type InScenario<P> = (P, &'static Parameter, f64);

/// Where a number of [fit] stands.
pub(super) enum Stands<P> {
    /// In the scenario.
    Scenario(InScenario<P>),
    /// In the sensor of a time series that is compared.
    Sensor(OfSensor),
}

/// All of them in the scenarios of runs; `find` finds that of an entry, which may name a number of a sensor, in a run by its index. A
/// number that is each run's or each session's own is an unknown for each, named behind its path; a common one starts at the first
/// run's value, and runs that state different values of it are refused.
pub(super) fn of_runs<P>(
    (material, warnings): (&Material, &mut Vec<String>),
    mut find: impl FnMut(usize, &FitEntry, Option<OfSensor>) -> Result<Stands<P>, Failure>,
) -> Result<(Vec<Unknown>, Vec<OfRun<P>>), Failure> {
    let mut unknowns: Vec<Unknown> = Vec::new();
    let nothing = || OfRun { places: Vec::new(), unknowns: Vec::new(), sensors: Vec::new() };
    let mut numbers: Vec<OfRun<P>> = material.recordings.iter().map(|_| nothing()).collect();
    for entry in entries(material)? {
        let of_sensor = sensors::named(material, entry)?;
        // The owners that the number has had so far, each with its unknown.
        let mut owners: Vec<(&str, usize)> = Vec::new();
        let mut stated: Vec<Stated> = Vec::new();
        for (run, of) in numbers.iter_mut().enumerate() {
            let owner = owner(material, entry, run)?;
            let known = owners.iter().find(|(other, _)| *other == owner).map(|(_, unknown)| *unknown);
            let begin = |own: Unknown, unknowns: &mut Vec<Unknown>| {
                let name = if owner.is_empty() { own.name.clone() } else { format!("{} [{owner}]", entry.path) };
                unknowns.push(Unknown { name, ..own });
                unknowns.len() - 1
            };
            let stands = find(run, entry, of_sensor)?;
            let unknown = match (known, of_sensor, &stands) {
                (Some(unknown), ..) => unknown,
                (_, Some(its), _) => begin(sensors::unknown(material, entry, its)?, &mut unknowns),
                (_, None, Stands::Sensor(its)) => begin(sensors::unknown(material, entry, *its)?, &mut unknowns),
                (_, None, Stands::Scenario((_, row, value))) => {
                    begin(self::unknown(&material.study, entry, row, *value)?, &mut unknowns)
                }
            };
            // Where the search starts, unless [fit] says so or the value lies outside the bounds.
            let first = match (of_sensor, &stands) {
                (Some(its), _) => sensors::stated(material, its).map(|value| (value, "its column")),
                (None, Stands::Sensor(its)) => sensors::stated(material, *its).map(|value| (value, "its column")),
                (None, Stands::Scenario((_, _, value))) => Some((*value, "the scenario")),
            };
            match stands {
                Stands::Sensor(its) => of.sensors.push((its, unknown)),
                Stands::Scenario((place, row, value)) => {
                    stated.push(Stated { owner, run, value, unit: row.unit });
                    of.unknowns.push(unknown);
                    of.places.push(place);
                }
            }
            if known.is_none() {
                warnings.extend(moved(entry, &unknowns[unknown], first));
                owners.push((owner, unknown));
            }
        }
        warnings.extend(of_set(material, entry, &stated)?);
    }
    Ok((unknowns, numbers))
}

/// That the search does not start at the value which the study or its scenario has, since that is outside the bounds.
fn moved(entry: &FitEntry, unknown: &Unknown, first: Option<(f64, &str)>) -> Option<String> {
    let (first, place) = first?;
    if entry.start.is_some() || !first.is_finite() || first == unknown.start {
        return None;
    }
    let [first, start] = [first, unknown.start].map(|value| quantities::given(value, unknown.unit));
    Some(format!(
        "{WARNED}`{}` is {first} in {place}, outside `from` and `to` in [fit]: the search starts at {start}. Widen the \
         bounds, or give a `start` within them.",
        unknown.name
    ))
}

/// What is said of the starts of a study whose runs have one scenario: see [`of_runs`].
pub(super) fn moved_starts(material: &Material) -> Result<Vec<String>, Failure> {
    let mut scenario = material.document.scenario()?;
    let (places, unknowns) = all(material)?;
    let of = |((entry, unknown), place): ((&FitEntry, &Unknown), &Place)| {
        moved(entry, unknown, place.value(&mut scenario).map(|value| (value, "the scenario")))
    };
    Ok(material.study.fit_entries.iter().zip(&unknowns).zip(&places).filter_map(of).collect())
}

/// The value that a number of [fit] has in the scenario of a run.
struct Stated<'m> {
    owner: &'m str,
    run: usize,
    value: f64,
    unit: &'static str,
}

/// Refuses a number that runs have in common, and of which `set` gives them different values: the estimate would take the place of each.
/// Where they have one value, what is said of it.
fn of_set(material: &Material, entry: &FitEntry, stated: &[Stated]) -> Result<Option<String>, Failure> {
    let path = &entry.path;
    let leads_there =
        |key: &str| path.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
    let is_set = |of: &&Stated| material.recordings[of.run].set.iter().any(|(key, _)| leads_there(key));
    // The value of a run is where the search for that run's own number starts.
    let mut set = stated.iter().filter(is_set).filter(|_| !entry.per_run).peekable();
    if set.peek().is_none() {
        return Ok(None);
    }
    for of in set {
        if let Some(other) = stated.iter().find(|other| other.owner == of.owner && other.value != of.value) {
            let [one, another] = [of, other].map(|of| {
                format!("{} in the run `{}`", quantities::given(of.value, of.unit), material.recordings[of.run].name)
            });
            let title =
                format!("`{path}` in [fit] is one parameter of several runs, and by `set` it is {one} and {another}");
            let remedy = format!(
                "add `per_run = true` to [fit.\"{path}\"] to estimate it for each run, or leave it out of [fit] where it is known, and out \
                 of `set` where it is not"
            );
            return Err(Failure::input(title, remedy));
        }
    }
    Ok(Some(format!(
        "`{path}` is in `set` and in [fit]: it is estimated, and the value of `set` is where the search starts."
    )))
}

/// Whose a number is in a run: the run's, its session's, or, with an empty name, that of all.
fn owner<'m>(material: &'m Material, entry: &FitEntry, run: usize) -> Result<&'m str, Failure> {
    let name = &material.recordings[run].name;
    match (entry.per_run, entry.per_session) {
        (true, _) => Ok(name),
        (_, false) => Ok(""),
        (_, true) => material.study.runs[run].session.as_deref().ok_or_else(|| {
            Failure::input(
                format!("`{}` in [fit] is each session’s own, but the run `{name}` has no session", entry.path),
                "add `session = \"…\"` to every [[run]]",
            )
        }),
    }
}

/// A number of the scenario of a run.
pub(super) fn in_run(
    material: &Material,
    entry: &FitEntry,
    (document, name, scenario): (&Document, &str, &mut Scenario),
) -> Result<InScenario<Place>, Failure> {
    let place = place(material, entry, (document, scenario), Some(name))?;
    Ok((place, place.parameter(), place.value(scenario).unwrap_or(0.0)))
}

fn entries(material: &Material) -> Result<&[FitEntry], Failure> {
    let entries = &material.study.fit_entries;
    if entries.is_empty() {
        let help = "add for instance `[fit.\"actuator.friction.viscous\"]` with `from` and `to`";
        return Err(Failure::input("the study does not say what to look for", help));
    }
    Ok(entries)
}

fn place(
    material: &Material,
    entry: &FitEntry,
    (document, scenario): (&Document, &mut Scenario),
    run: Option<&str>,
) -> Result<Place, Failure> {
    let all = material.study.fit_entries.iter().map(|other| other.path.as_str());
    document.find(&entry.path, all, scenario).map_err(|error| match absent(&material.study, entry, scenario) {
        Some((why, remedy)) => Failure::input(format!("`{}` in [fit]: {why}{}", entry.path, in_run_named(run)), remedy),
        None => misplaced(&error, run),
    })
}

/// Why a scenario has no number that a study of it might look for, and what to do: the start of a run at equilibrium, and what
/// a given pressure stands for.
fn absent(study: &Study, entry: &FitEntry, scenario: &Scenario) -> Option<(&'static str, &'static str)> {
    let path = in_antagonist(&entry.path).unwrap_or(entry.path.as_str());
    if path == parameter::INITIAL_LENGTH.key && scenario.initial.length == InitialLength::Equilibrium {
        return Some((
            "the run starts at the equilibrium, whose length follows from load and pressure",
            "leave it out of [fit], or give `length` in [initial] of the scenario a value at which the search starts, such as \"90 mm\"",
        ));
    }
    let is_behind = ["valve.", "supply.", "command.", "hose."].iter().any(|part| path.starts_with(part));
    match (is_behind && scenario.pressure.is_some(), study.input) {
        (false, _) => None,
        (true, Input::GaugePressure) => Some((
            "the run follows the measured pressure, and what the scenario says of this part takes no part",
            "leave it out of [fit], or leave `input` out of [study], so that the valve drives the run and the pressure is compared",
        )),
        (true, _) => Some((
            "the run follows the pressure that [pressure] of the scenario gives, and has no such part",
            "leave it out of [fit], or describe valve, supply and command in place of [pressure]",
        )),
    }
}

/// Of which run a scenario is, behind what is said of it.
fn in_run_named(run: Option<&str>) -> String {
    run.map(|run| format!(", in the scenario of the run `{run}`")).unwrap_or_default()
}

/// That a path of [fit] leads to no parameter of the study's scenario, or of a run's.
pub(super) fn misplaced(error: &PlaceError, run: Option<&str>) -> Failure {
    Failure::input(format!("{}{}", error.what(), in_run_named(run)), error.remedy())
}

/// Bounds are those of the study within those of the parameter.
fn unknown(study: &Study, entry: &FitEntry, row: &Parameter, first: f64) -> Result<Unknown, Failure> {
    read(study, entry, (row.unit, [row.range.low, row.range.high]), first)
}

/// An unknown in a unit, its bounds those of the study, and the range where the study gives none.
pub(super) fn read(
    study: &Study,
    entry: &FitEntry,
    (unit, range): (&'static str, [f64; 2]),
    first: f64,
) -> Result<Unknown, Failure> {
    let read = |text: &Option<String>| -> Result<Option<f64>, Failure> {
        let Some(text) = text else { return Ok(None) };
        if let Some(number) = study.in_si(text) {
            return Ok(Some(number));
        }
        let wrong = |why: String| {
            Failure::input(
                format!("\"{text}\" of `{}` in [fit]: {why}", entry.path),
                format!("give it as in \"1 {}\"", unit),
            )
        };
        let read = grammar::parse(text).map_err(|error| wrong(error.message.clone()))?;
        let (dimension, _) = grammar::parse_unit(unit).unwrap_or_default();
        if read.dimension != dimension {
            Err(wrong(format!("a value in {} is due", unit)))
        } else {
            Ok(Some(read.value))
        }
    };
    // An infinite bound is none.
    let given = [("from", read(&entry.from)?), ("to", read(&entry.to)?)];
    let given = given.map(|(key, bound)| (key, bound.filter(|bound| !bound.is_infinite())));
    for (key, bound) in given {
        if let Some(bound) = bound.filter(|bound| !(range[0]..=range[1]).contains(bound)) {
            let title = format!("`{key}` of `{}` in [fit] is {}", entry.path, quantities::given(bound, unit));
            let [low, high] = range.map(|end| quantities::given(end, unit));
            let values = match range.map(f64::is_finite) {
                [true, false] => format!("from {low} on"),
                [false, true] => format!("up to {high}"),
                _ => format!("from {low} to {high}"),
            };
            return Err(Failure::input(title, format!("the key has values {values}: give a bound among them")));
        }
    }
    let (least, largest) = (given[0].1.unwrap_or(range[0]), given[1].1.unwrap_or(range[1]));
    check_order(entry, unit, [least, largest])?;
    let start = read(&entry.start)?;
    // What is outside the range of its key is refused where the run is built.
    if let Some(start) = start.filter(|start| (range[0]..=range[1]).contains(start)) {
        check_start(entry, unit, start, [least, largest])?;
    }
    let start = start.unwrap_or_else(|| first.clamp(least, largest));
    let prior = match &entry.prior {
        Some([mean, deviation]) => read(&Some(mean.clone()))?.zip(read(&Some(deviation.clone()))?),
        None => None,
    };
    if prior.is_some_and(|(_, deviation)| deviation <= 0.0) {
        return Err(Failure::input(
            format!("the prior of `{}` has a deviation that is not above zero", entry.path),
            "give one above zero",
        ));
    }
    let unknown = Unknown::new(entry.path.clone(), unit, start).between(least, largest);
    Ok(Unknown { prior: prior.map(|(mean, deviation)| [mean, deviation]), ..unknown })
}

/// That the bounds of an unknown are in order and apart.
pub(super) fn check_order(entry: &FitEntry, unit: &str, [least, largest]: [f64; 2]) -> Result<(), Failure> {
    if least < largest {
        return Ok(());
    }
    let [least, largest] = [least, largest].map(|bound| quantities::given(bound, unit));
    let title = format!("`{}` in [fit] lies from {least} to {largest}", entry.path);
    Err(Failure::input(title, "give `from` below `to`; a value that is known stands in the scenario, and not in [fit]"))
}

/// That a start which the study gives is within its bounds.
pub(super) fn check_start(entry: &FitEntry, unit: &str, start: f64, [least, largest]: [f64; 2]) -> Result<(), Failure> {
    let (side, bound) = match start {
        _ if start < least => ("below its least value", least),
        _ if start > largest => ("above its largest value", largest),
        _ => return Ok(()),
    };
    let [start, bound] = [start, bound].map(|value| quantities::given(value, unit));
    let title = format!("`start` of `{}` in [fit] is {start}, {side} of {bound}", entry.path);
    Err(Failure::input(title, "give a start within the bounds `from` and `to`, or wider bounds"))
}

/// So many starts, spread evenly in the ranges of [`spread`]: a separate sequence for each unknown.
pub(super) fn more_starts(study: &Study, unknowns: &[Unknown], count: usize) -> Vec<Vec<f64>> {
    let primes: [f64; 8] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0];
    let start = |row: usize| {
        let of = |(place, unknown): (usize, &Unknown)| {
            let part = ((row + 1) as f64 * primes[place % primes.len()].sqrt()).fract();
            spread(study, unknown, part).clamp(unknown.bounds[0], unknown.bounds[1])
        };
        unknowns.iter().enumerate().map(of).collect()
    };
    (0..count).map(start).collect()
}

/// The value at a part of an unknown's range of starts: two standard deviations about the mean of its prior; else its bounds where the study
/// says how large it may be, or where they lie within ten times its start, in equal ratios where they are positive and a
/// hundred times apart; else from 0.3 of its start to its start over 0.3.
fn spread(study: &Study, unknown: &Unknown, part: f64) -> f64 {
    let [least, largest] = unknown.bounds;
    let entry = study.fit_entries.iter().find(|entry| match unknown.name.strip_prefix(entry.path.as_str()) {
        Some(run) => run.is_empty() || run.starts_with(" ["),
        None => false,
    });
    let says = entry.is_some_and(|entry| entry.to.is_some());
    let near = [least, largest].iter().all(|bound| bound.abs() <= 10.0 * unknown.start.abs());
    match unknown.prior {
        Some([mean, deviation]) => mean + 2.0 * deviation * (2.0 * part - 1.0),
        None if least.is_finite() && largest.is_finite() && (says || near) => {
            match least > 0.0 && largest / least >= 100.0 {
                true => least * (largest / least).powf(part),
                false => least + (largest - least) * part,
            }
        }
        None => unknown.start * (0.3_f64).powf(1.0 - 2.0 * part),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unknown of a damping from 0 N·s/m on, or why there is none.
    fn of(bounds: &str) -> Result<Unknown, String> {
        let text = format!(
            "[study]\nkind = \"trajectories\"\nscenario = \"rig.toml\"\n[columns.time]\nname = \"t\"\n[columns.length]\nname = \"L\"\n\
             [[run]]\nfile = \"run\"\n[fit.\"actuator.friction.viscous\"]\n{bounds}"
        );
        let study = Study::in_memory(&text, "the study", Vec::new()).expect("a study");
        let found = read(&study, &study.fit_entries[0], ("N*s/m", [0.0, f64::INFINITY]), 4.0);
        found.map_err(|failure| failure.sentence())
    }

    #[test]
    fn bounds_are_apart_and_within_the_range_of_the_key() {
        assert_eq!(of("from = 1.0\nto = 50.0\n").expect("bounds").bounds, [1.0, 50.0]);
        assert_eq!(of("from = 0.0\n").expect("bounds").bounds, [0.0, f64::INFINITY]);
        for (bounds, words) in [
            ("from = 5.0\nto = 5.0\n", "in [fit] lies from 5"),
            ("from = 6.0\nto = 5.0\n", "give `from` below `to`"),
            ("from = -5.0\nto = 50.0\n", "`from` of `actuator.friction.viscous` in [fit] is"),
            ("to = -1.0\n", "the key has values from 0"),
            ("from = nan\n", "`from` of `actuator.friction.viscous` in [fit]"),
        ] {
            let said = of(bounds).expect_err("no bounds");
            assert!(said.contains(words), "{bounds}: {said}");
        }
    }
}
