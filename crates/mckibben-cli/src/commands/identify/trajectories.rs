//! Courses in time to numbers of a scenario: tables, figures and words.

use super::outcome::Outcome;
use super::{Material, values};
use crate::failure::Failure;
use crate::plot::{Axis, Colour, Figure, Legend, Panel, Series};
use crate::progress::Progress;
use crate::quantities::quantity;
use crate::report::{Data, Plate, Section, Table};
use mckibben::parameter;
use mckibben::simulation::{Trajectory, simulate};
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::least_squares::{Loss, Search, Unknown};
use mckibben_identify::study::{Quantity, Recording, SoughtEntry};
use mckibben_identify::trajectories::{Course, Horizon, Identified, Observed, Recorded, Task, TrajectoryError};
use mckibben_scenario::{Document, Place, Scenario, quantity as grammar};

pub(super) fn outcome(material: &Material) -> Result<Outcome, Failure> {
    if material.study.sought.is_empty() {
        let help = "add for instance `[fit.\"actuator.friction.viscous\"]` with `from` and `to`";
        return Err(Failure::input("the study does not say what to look for", help));
    }
    let task = task(material)?;
    let progress = Progress::begin("fitting", None);
    let found = task.identify().map_err(|error| match error {
        TrajectoryError::Fit(_) => Failure::stopped(error.to_string()),
        _ => Failure::input(error.to_string(), "see `mckibben identify --help`"),
    })?;
    drop(progress);
    let mut warnings = material.notes();
    warnings.extend(values::warnings(&found.found.fit));
    if found.found.tried > 1 {
        let (tried, agreeing) = (found.found.tried, found.found.agreeing);
        warnings.push(format!("{agreeing} of {tried} starts led to this minimum."));
    }
    let scenarios = scenarios(&task, &found);
    let numbers = values::table("Numbers with their 95 % intervals".to_owned(), &found.found.fit);
    let sections = sections(&task, &found, &numbers, &warnings, &scenarios)?;
    Ok(Outcome {
        title: format!("{} from courses in time", material.document.source().name()),
        introduction: introduction(&task, &found),
        sections,
        table: left(&found),
        values: numbers,
        warnings,
        scenarios,
    })
}

/// The scenario of a run: the file's, with what the run says of its own.
fn document_of(material: &Material, recording: &Recording) -> Result<Document, Failure> {
    let mut document = material.document.clone();
    for (key, value) in &recording.set {
        document.set_text_from(&format!("run `{}`", recording.name), key, value)?;
    }
    Ok(document)
}

fn task(material: &Material) -> Result<Task, Failure> {
    let mut first = material.document.scenario()?;
    let mut unknowns = Vec::new();
    for entry in &material.study.sought {
        let place = Place::find(&entry.path, &mut first).map_err(|error| Failure::input(error.to_string(), "mend [fit]"))?;
        unknowns.push(unknown(entry, &place, place.value(&mut first).unwrap_or(0.0))?);
    }
    let mut runs = Vec::new();
    for recording in &material.recordings {
        let document = document_of(material, recording)?;
        let mut scenario = document.scenario()?;
        let place = |entry: &SoughtEntry| {
            Place::find(&entry.path, &mut scenario).map_err(|error| Failure::input(error.to_string(), format!("of the run `{}`", recording.name)))
        };
        let places = material.study.sought.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        let given = document.contains(parameter::MIN_LENGTH.key);
        let courses = courses(recording, scenario.air.atmospheric_pressure);
        let adjustable = Adjustable::new(scenario, places, given);
        runs.push(Recorded { name: recording.name.clone(), adjustable, unknowns: (0..unknowns.len()).collect(), courses });
    }
    let starts = more_starts(&unknowns, material.study.more_starts);
    let loss = material.study.robust.map_or(Loss::Squares, Loss::Huber);
    Ok(Task {
        runs,
        unknowns,
        starts,
        horizon: material.study.horizon.clone().map_or(Horizon::Whole, Horizon::Growing),
        search: Search { loss, ..Search::default() },
        tolerance: 1e-8,
    })
}

/// Bounds are those of the study within those of the parameter.
fn unknown(entry: &SoughtEntry, place: &Place, first: f64) -> Result<Unknown, Failure> {
    let row = place.parameter();
    let read = |text: &Option<String>| -> Result<Option<f64>, Failure> {
        let Some(text) = text else { return Ok(None) };
        let wrong = |why: String| Failure::input(format!("\"{text}\" of `{}` in [fit]: {why}", entry.path), format!("give it as in \"1 {}\"", row.unit));
        let read = grammar::parse(text).map_err(|error| wrong(error.message.clone()))?;
        let (dimension, _) = grammar::parse_unit(row.unit).unwrap_or_default();
        if read.dimension != dimension { Err(wrong(format!("a value in {} is due", row.unit))) } else { Ok(Some(read.value)) }
    };
    let (least, largest) = (read(&entry.from)?.unwrap_or(row.range.low), read(&entry.to)?.unwrap_or(row.range.high));
    let start = read(&entry.start)?.unwrap_or_else(|| first.clamp(least, largest));
    let prior = match &entry.prior {
        Some([mean, deviation]) => read(&Some(mean.clone()))?.zip(read(&Some(deviation.clone()))?),
        None => None,
    };
    if prior.is_some_and(|(_, deviation)| deviation <= 0.0) {
        return Err(Failure::input(format!("the prior of `{}` has a deviation that is not above zero", entry.path), "give one above zero"));
    }
    let unit = if place.path().ends_with(']') { "" } else { row.unit };
    let unknown = Unknown::new(entry.path.clone(), unit, start).between(least, largest);
    Ok(Unknown { prior: prior.map(|(mean, deviation)| [mean, deviation]), ..unknown })
}

/// Starts spread evenly over what is bounded on both sides, one sequence for each unknown.
fn more_starts(unknowns: &[Unknown], count: usize) -> Vec<Vec<f64>> {
    let primes: [f64; 8] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0];
    let start = |row: usize| {
        let of = |(place, unknown): (usize, &Unknown)| {
            let part = ((row + 1) as f64 * primes[place % primes.len()].sqrt()).fract();
            let [least, largest] = unknown.bounds;
            match (least.is_finite(), largest.is_finite()) {
                (true, true) => least + (largest - least) * part,
                _ => unknown.start * (0.3_f64).powf(1.0 - 2.0 * part),
            }
        };
        unknowns.iter().enumerate().map(of).collect()
    };
    (0..count).map(start).collect()
}

fn courses(recording: &Recording, atmosphere: f64) -> Vec<Course> {
    let of = |quantity: Quantity, observed: Observed, shift: f64| {
        let (times, values) = recording.channel(quantity)?;
        let deviation = recording.column(quantity).and_then(|column| column.deviation);
        Some(Course { observed, times, values: values.into_iter().map(|value| value - shift).collect(), deviation })
    };
    [
        of(Quantity::Length, Observed::Length, 0.0),
        of(Quantity::GaugePressure, Observed::GaugePressure, 0.0),
        of(Quantity::AbsolutePressure, Observed::GaugePressure, atmosphere),
        of(Quantity::Tension, Observed::Tension, 0.0),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn introduction(task: &Task, found: &Identified) -> Vec<String> {
    let readings: usize = task.runs.iter().flat_map(|run| &run.courses).map(|course| course.values.len()).sum();
    let (numbers, runs) = (task.unknowns.len(), task.runs.len());
    vec![format!(
        "{numbers} numbers from {readings} readings of {runs} runs, by trajectories with every event located and their exact derivatives. \
         Condition number {:.1e}.",
        found.found.fit.condition
    )]
}

fn left(found: &Identified) -> Table {
    let row = |(left, scale): (&(Observed, f64), &(Observed, f64))| {
        let unit = left.0.unit();
        vec![left.0.words().to_owned(), quantity(left.1, unit), quantity(scale.1, unit)]
    };
    Table {
        caption: "What is left of each quantity, root mean square, and by what it was weighed".to_owned(),
        head: ["quantity", "left", "scale"].map(String::from).to_vec(),
        rows: found.left.iter().zip(&found.scales).map(row).collect(),
    }
}

/// A scenario file for each run whose scenario differs, or one for all.
fn scenarios(task: &Task, found: &Identified) -> Vec<(String, String)> {
    let text = |scenario: &Scenario| format!("# By `mckibben identify`.\n\n{}", scenario.to_toml());
    let texts: Vec<String> = found.scenarios.iter().map(text).collect();
    match texts.windows(2).all(|pair| pair[0] == pair[1]) {
        true => texts.into_iter().take(1).map(|text| ("scenario.toml".to_owned(), text)).collect(),
        false => task.runs.iter().zip(texts).map(|(run, text)| (format!("scenario-{}.toml", run.name), text)).collect(),
    }
}

fn sections(
    task: &Task,
    found: &Identified,
    numbers: &Table,
    warnings: &[String],
    files: &[(String, String)],
) -> Result<Vec<Section>, Failure> {
    let notes = if warnings.is_empty() { vec!["Nothing odd was found in the data.".to_owned()] } else { warnings.to_vec() };
    let mut plates = Vec::new();
    // A page of the first few runs is enough to see how they fit; the table speaks of all.
    let stems = ["run-1", "run-2", "run-3", "run-4", "run-5", "run-6"];
    for ((run, scenario), stem) in task.runs.iter().zip(&found.scenarios).zip(stems) {
        plates.push(plate(run, scenario, stem)?);
    }
    Ok(vec![
        Section { id: "data", label: "Data", title: "What was measured", paragraphs: notes, ..Section::default() },
        Section {
            id: "numbers",
            label: "Numbers",
            title: "What was found",
            tables: vec![numbers.clone(), left(found), values::correlations(&found.found.fit)],
            files: files.iter().map(|(name, text)| (name.clone().into(), text.clone().into())).collect(),
            ..Section::default()
        },
        Section { id: "runs", label: "Runs", title: "Measured and simulated", plates, ..Section::default() },
    ])
}

fn simulated(trajectory: &Trajectory, observed: Observed, time: f64) -> f64 {
    let sample = trajectory.at(time);
    match observed {
        Observed::Length => sample.length,
        Observed::GaugePressure => sample.pressure.0 - trajectory.rig().actuator().air().atmosphere().0,
        Observed::Tension => sample.tension,
    }
}

fn plate(run: &Recorded, scenario: &Scenario, stem: &'static str) -> Result<Plate, Failure> {
    let failed = |error: mckibben::Error| Failure::stopped(error.to_string());
    let rig = scenario.rig().map_err(failed)?;
    let start = rig.start(&scenario.initial()).map_err(failed)?;
    let last = run.courses.iter().filter_map(|course| course.times.last()).fold(0.0_f64, |last, time| last.max(*time));
    let trajectory = simulate(&rig, start, last, 1e-8).map_err(failed)?;
    let mut data = Data::new(&["quantity", "time_s", "measured", "simulated"]);
    let mut panels = Vec::new();
    for course in &run.courses {
        let times: Vec<f64> = (0..=600).map(|part| last * f64::from(part) / 600.0).collect();
        let curve = times.iter().map(|time| simulated(&trajectory, course.observed, *time)).collect();
        let off: Vec<f64> = course.times.iter().zip(&course.values).map(|(time, value)| simulated(&trajectory, course.observed, *time) - value).collect();
        let unit = course.observed.unit();
        let panel = Panel::new(Axis::new(course.observed.words(), unit)).legend(if panels.is_empty() { Legend::Above } else { Legend::Hidden });
        panels.push(
            panel
                .series(Series::dots("measured", course.times.clone(), course.values.clone()).colour(Colour::Category(1)))
                .series(Series::line("simulated", times, curve)),
        );
        let rest = Panel::new(Axis::new("off", unit)).horizontal(0.0, "").height_mm(16.0).legend(Legend::Hidden);
        data.rows.extend(course.times.iter().zip(&course.values).zip(&off).map(|((time, value), off)| vec![f64::from(course.observed as u8), *time, *value, value + off]));
        panels.push(rest.series(Series::dots("", course.times.clone(), off)));
    }
    let figure = Figure { width_mm: 150.0, x: Axis::new("time", "s"), panels, ..Figure::default() };
    let caption = format!("`{}`: measured and simulated, and the one less the other.", run.name);
    Ok(Plate { stem, caption, figure, data })
}
