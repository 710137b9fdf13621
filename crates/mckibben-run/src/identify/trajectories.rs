//! Parameters of a scenario from time series: tables, figures and words.

use super::outcome::{self, Outcome, Stems, WARNED};
use super::prediction::Prediction;
use super::sensors::{self, OfSensor};
use super::unknowns::{self, OfRun, Stands};
use super::{Material, minima, plant, pressure_of, remedied, responses, units, values, without_times};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::quantities::{counted, quantity};
use crate::report::{Data, Plate, Section, Table};
use mckibben::parameter;
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::least_squares::{Ending, Search, Unknown};
use mckibben_identify::study::{Column, ColumnEntry, Input, Quantity, Recording};
use mckibben_identify::trajectories::{
    Described, Drift, HeldOutRun, Horizon, Identified, Observed, Recorded, Task, TimeSeries, TrajectoryError,
    Understated, Unexplained,
};
use mckibben_plot::{Axis, Colour, Figure, Legend, Panel, Series};
use mckibben_scenario::{Document, Load, Place, PressurePlace, PressureSeries, Scenario};

/// More starts than the first, unless the study says how many: so many are evaluated once, and the search goes from so many of
/// them, those of least cost.
const SCREENED: usize = 16;
const REFINED: usize = 2;

/// The figures of the runs; the table speaks of all.
pub(super) const STEMS: Stems = ["run-1", "run-2", "run-3", "run-4", "run-5", "run-6"];

pub(super) fn outcome(material: &Material) -> Result<Outcome, Failure> {
    let mut warnings = material.notes();
    let task = task(material, &mut warnings)?;
    let progress = Progress::begin("fitting", None);
    let found = task.identify().map_err(|error| match error {
        TrajectoryError::Fit(_) => Failure::stopped(error.to_string()),
        _ => remedied(
            &error.to_string(),
            "start where the run can be simulated: change the scenario, or give the parameters of [fit] a `start`",
        ),
    })?;
    let held_out = task.held_out(&found);
    let step_responses = responses::of(&task, &found, &held_out);
    let responses = responses::table(&step_responses);
    drop(progress);
    warnings.extend(values::warnings(&found.found.fit, &task.unknowns));
    warnings.extend(material.stopped().filter(|_| !found.found.fit.ending.is_early()));
    let minima = minima::of(&found.found, &task.unknowns);
    warnings.extend(minima.words());
    if let Some(every) = found.segments {
        warnings.push(format!(
            "{WARNED}the runs are too sensitive to be fitted whole: a small change of a parameter gives another trajectory in the end. They were \
             fitted in segments of {} that join, and are drawn so; a simulation of the whole run with the values found leaves the \
             measured trajectory after a while.",
            quantity(every, "s")
        ));
    }
    let is_doubted = !units::doubts(material).is_empty();
    warnings.extend(task.drifts(&found).iter().map(|drift| drifting(drift, is_doubted)));
    let has_intervals = found.found.fit.ending == Ending::Minimum;
    let rest = task.unexplained(&found);
    warnings.extend(rest.iter().map(|rest| unexplained(rest, has_intervals, is_doubted)));
    if found.weighed_by_spans {
        warnings.push(format!(
            "{WARNED}the search ended in its first, rough pass, in which each quantity is weighed by the span of its readings and not by its \
             scatter: the scales are these spans. Give it more time, or begin nearer (`start` in [fit])."
        ));
    }
    warnings.extend(found.unsettled.iter().map(|of| unsettled(of, &found)));
    let understated = task.understated(&found);
    let understated = understated.iter().filter(|of| !rest.iter().any(|rest| rest.observed == of.observed));
    warnings.extend(understated.map(|Understated { observed, left, deviation }| {
        values::understated(&observed.words(), observed.unit(), [*left, *deviation], has_intervals)
    }));
    let scenarios = outcome::files(
        task.runs.iter().map(|run| run.name.as_str()).zip(found.scenarios.iter().map(Described::to_toml)),
    );
    let numbers = values::table("Numbers with their 95 % intervals".to_owned(), &found.found.fit);
    let table = left(&found, &held_out);
    let sections = sections(&task, &found, [&numbers, &table, &responses, &minima.table], &scenarios);
    Ok(Outcome {
        title: format!("{} from time series", material.name()),
        introduction: introduction(&task, &found),
        sections,
        table,
        values: numbers,
        predictions: predictions(&task, &found),
        correlations: values::matrix(&found.found.fit),
        estimates: found.found.fit.estimates,
        minima: minima.table,
        other_minima: minima.others,
        responses,
        step_responses,
        warnings,
        scenarios,
        ..Outcome::default()
    })
}

fn task(material: &Material, warnings: &mut Vec<String>) -> Result<Task, Failure> {
    material.recordings.iter().try_for_each(|recording| check_times(material, recording))?;
    let (runs, unknowns) = match material.document.is_plant() {
        true => plant::runs(material, warnings)?,
        false => runs(material, warnings)?,
    };
    let horizon = material.study.search.horizon.clone();
    let (count, refined) = match (material.study.search.more_starts, &horizon) {
        (Some(count), _) => (count, None),
        // In segments a search goes from one start.
        (None, Horizon::Segments(_)) => (0, None),
        (None, _) => (SCREENED, Some(REFINED)),
    };
    let starts = unknowns::more_starts(&material.study, &unknowns, count);
    Ok(Task { runs, unknowns, starts, horizon, search: Search { refined, ..material.search() }, tolerance: 1e-8 })
}

/// Refuses readings of a table that has no times: they can be compared with nothing.
fn check_times(material: &Material, recording: &Recording) -> Result<(), Failure> {
    let is_read = |column: &&Column| {
        let is_it = |entry: &ColumnEntry| entry.quantity == column.quantity && entry.part == column.part;
        column.quantity != Quantity::Time && material.study.columns.iter().any(is_it)
    };
    let timeless = recording.sheets.iter().filter(|sheet| sheet.column(Quantity::Time).is_none());
    let Some(column) = timeless.flat_map(|sheet| &sheet.columns).find(is_read) else { return Ok(()) };
    Err(without_times(recording, &column.words()))
}

/// The runs of one actuator or a joint, and the numbers that are looked for in them.
fn runs(material: &Material, warnings: &mut Vec<String>) -> Result<(Vec<Recorded>, Vec<Unknown>), Failure> {
    let mut scenarios = Vec::new();
    let mut documents = Vec::new();
    for recording in &material.recordings {
        let document = material.document_of(recording)?;
        let mut scenario = document.scenario()?;
        if material.study.input == Input::GaugePressure {
            give_pressure((&document, &mut scenario), (material, recording), warnings)?;
        }
        if let Some((_, column)) = recording.of_parts().next() {
            let title =
                format!("the run `{}` has the {}, but its scenario names no parts", recording.name, column.words());
            return Err(Failure::input(title, "name the quantity alone, as in `[columns.length]`"));
        }
        scenarios.push((recording.name.clone(), scenario));
        documents.push(document);
    }
    let (unknowns, numbers) = unknowns::of_runs((material, warnings), |run, entry, sensor| {
        let (name, scenario) = &mut scenarios[run];
        match (sensor, sensor.and_then(|of| sensors::of_driving(material, of))) {
            (None, _) => unknowns::in_run(material, entry, (&documents[run], name, scenario)).map(Stands::Scenario),
            (Some(of), None) => Ok(Stands::Sensor(of)),
            (Some(of), Some(section)) => {
                let path = sensors::key_of_given(material, of, section)?;
                let place = Place::find(&path, scenario).map_err(|error| unknowns::misplaced(&error, Some(name)))?;
                Ok(Stands::Scenario((place, place.parameter(), place.value(scenario).unwrap_or(0.0))))
            }
        }
    })?;
    let mut runs = Vec::new();
    for (((name, scenario), OfRun { places, unknowns, sensors }), (recording, document)) in
        scenarios.into_iter().zip(numbers).zip(material.recordings.iter().zip(documents))
    {
        let given = document.says_of_each(parameter::MIN_LENGTH.key);
        let mut time_series = time_series(material, (recording, &sensors), scenario.air.atmospheric_pressure)?;
        let others = scenario.of_antagonist();
        // A pressure that drives the run is not compared with it.
        let driven = scenario.pressure.as_ref().map(|given| match given.at {
            PressurePlace::Muscle => Observed::GaugePressure,
            PressurePlace::Hose => Observed::HoseGaugePressure,
        });
        let driven_too = others.and_then(|of| of.pressure).map(|_| Observed::AntagonistGaugePressure);
        for pressure in driven.into_iter().chain(driven_too) {
            time_series.retain(|recorded| recorded.observed != pressure);
        }
        runs.push(Recorded { name, subject: Adjustable::new(scenario, places, given).into(), unknowns, time_series });
    }
    Ok((runs, unknowns))
}

/// Drives a run by the pressure that was measured, of a joint by both, in place of what the scenario says: by that at the end of
/// the hose where it was measured there, so that the hose takes part.
fn give_pressure(
    (document, scenario): (&Document, &mut Scenario),
    (material, recording): (&Material, &Recording),
    warnings: &mut Vec<String>,
) -> Result<(), Failure> {
    let had_valve = scenario.valve.is_some() || scenario.of_antagonist().is_some_and(|of| of.valve.is_some());
    let in_muscle = [Quantity::GaugePressure, Quantity::AbsolutePressure];
    let in_hose = [Quantity::HoseGaugePressure, Quantity::HosePressure];
    let at_hose = in_hose.iter().any(|quantity| recording.column(*quantity).is_some());
    if at_hose && (scenario.hose.is_none() || scenario.has_joint()) {
        let title = format!("the run `{}` has a pressure in a hose, but its scenario has no hose", recording.name);
        let help = "describe the hose in `[hose]`, in a joint as a plant with `[actuators.NAME]`, or call it `[columns.gauge_pressure]`";
        return Err(Failure::input(title, help));
    }
    let at = if at_hose { PressurePlace::Hose } else { PressurePlace::Muscle };
    let of = (material, recording);
    let its = measured_series(of, if at_hose { in_hose } else { in_muscle }, (scenario, at), warnings)?;
    let of_other = [Quantity::AntagonistGaugePressure, Quantity::AntagonistAbsolutePressure];
    let others = match scenario.has_joint() {
        true => Some(measured_series(of, of_other, (scenario, at), warnings)?),
        false => None,
    };
    let words = match at {
        PressurePlace::Muscle => {
            "the pressure is the measured one: valve, supply, hose and command of the scenario take no part."
        }
        PressurePlace::Hose => {
            "the pressure at the end of the hose is the measured one: valve, supply and command of the scenario take no part."
        }
    };
    if had_valve && !warnings.iter().any(|warning| warning == words) {
        warnings.push(words.to_owned());
    }
    (scenario.valve, scenario.command, scenario.supply) = (None, None, None);
    if at_hose {
        // The muscle starts at what was read in it first, else at what the scenario says, else at what was read in the hose:
        // then no air flows at the start.
        if in_muscle.iter().any(|quantity| recording.column(*quantity).is_some()) {
            scenario.initial.gauge_pressure = Some(measured_series(of, in_muscle, (scenario, at), warnings)?.start());
        } else if !document.contains(parameter::INITIAL_GAUGE_PRESSURE.key) {
            scenario.initial.gauge_pressure = None;
        }
    } else {
        scenario.hose = None;
        scenario.initial.gauge_pressure = None;
    }
    scenario.pressure = Some(its);
    if let Load::AntagonisticJoint(joint) = &mut scenario.load {
        let second = &mut *joint.antagonist;
        (second.valve, second.command, second.hose, second.supply) = (None, None, None, None);
        second.has_own_supply = false;
        second.gauge_pressure = None;
        second.pressure = others;
    }
    Ok(())
}

/// A pressure that was measured, gauge or absolute, over time.
fn measured_series(
    (material, recording): (&Material, &Recording),
    of: [Quantity; 2],
    (scenario, at): (&Scenario, PressurePlace),
    warnings: &mut Vec<String>,
) -> Result<PressureSeries, Failure> {
    let (measured, time, mut gauge_pressure) = pressure_of(recording, of)?;
    if measured == of[1] {
        gauge_pressure.iter_mut().for_each(|pressure| *pressure -= scenario.air.atmospheric_pressure);
    }
    let last = |(times, _): (Vec<f64>, Vec<f64>)| times.last().copied();
    let others = FOLLOWING.into_iter().filter_map(|of| last(recording.channel(of)?));
    held_at_its_end(recording, "the pressure", (&time, others.fold(0.0, f64::max)), warnings);
    sensors::recorded(material, (measured, None), at, [time, gauge_pressure])
}

/// That a measured pressure ends before what follows it, which goes on until a time in s.
pub(super) fn held_at_its_end(
    recording: &Recording,
    pressure: &str,
    (time, until): (&[f64], f64),
    warnings: &mut Vec<String>,
) {
    let ends = time.last().copied().unwrap_or(0.0);
    if until > ends {
        warnings.push(format!(
            "{WARNED}`{}`: {pressure} was read up to {}, the others up to {}; it is held at its last value.",
            recording.name,
            quantity(ends, "s"),
            quantity(until, "s")
        ));
    }
}

/// What follows the pressure.
const FOLLOWING: [Quantity; 9] = [
    Quantity::Length,
    Quantity::Tension,
    Quantity::Angle,
    Quantity::AngularVelocity,
    Quantity::Torque,
    Quantity::AntagonistLength,
    Quantity::AntagonistTension,
    Quantity::Temperature,
    Quantity::MassFlow,
];

/// The quantities of one actuator or a joint that are compared: what each is read as, and whether it counts from the vacuum there and
/// from the atmosphere in the comparison.
const COMPARED: [(Quantity, Observed, bool); 15] = [
    (Quantity::Length, Observed::Length, false),
    (Quantity::GaugePressure, Observed::GaugePressure, false),
    (Quantity::AbsolutePressure, Observed::GaugePressure, true),
    (Quantity::Tension, Observed::Tension, false),
    (Quantity::Angle, Observed::Angle, false),
    (Quantity::AngularVelocity, Observed::AngularVelocity, false),
    (Quantity::Torque, Observed::Torque, false),
    (Quantity::AntagonistLength, Observed::AntagonistLength, false),
    (Quantity::AntagonistGaugePressure, Observed::AntagonistGaugePressure, false),
    (Quantity::AntagonistAbsolutePressure, Observed::AntagonistGaugePressure, true),
    (Quantity::AntagonistTension, Observed::AntagonistTension, false),
    (Quantity::HoseGaugePressure, Observed::HoseGaugePressure, false),
    (Quantity::HosePressure, Observed::HoseGaugePressure, true),
    (Quantity::Temperature, Observed::Temperature, false),
    (Quantity::MassFlow, Observed::MassFlow, false),
];

fn time_series(
    material: &Material,
    (recording, sensors): (&Recording, &[(OfSensor, usize)]),
    atmosphere: f64,
) -> Result<Vec<TimeSeries>, Failure> {
    let is_compared = |of: Quantity| of == Quantity::Time || COMPARED.iter().any(|(quantity, ..)| *quantity == of);
    if let Some(entry) = material.study.columns.iter().find(|entry| !is_compared(entry.quantity)) {
        let title =
            format!("`[columns.{}]`: trajectories have no {} to compare it with", entry.quantity.name(), entry.words());
        let help = match entry.quantity {
            Quantity::VolumeFlow => {
                "give the mass flow into the actuator as `[columns.mass_flow]`: a volume flow ANR times 1.185 kg/m^3"
            }
            Quantity::Command => {
                "leave it out, and give the command by `[command]` of the scenario, as by `kind = \"table\"`"
            }
            Quantity::UpstreamGaugePressure | Quantity::UpstreamAbsolutePressure => {
                "leave it out, and state `supply.gauge_pressure` in the scenario or by `set` of each run"
            }
            _ => {
                "leave it out; the pressure in the actuator is `[columns.gauge_pressure]` or `[columns.absolute_pressure]`"
            }
        };
        return Err(Failure::input(title, help));
    }
    let of = |(quantity, observed, is_absolute): (Quantity, Observed, bool)| {
        let shift = if is_absolute { atmosphere } else { 0.0 };
        let (times, values) = recording.channel(quantity)?;
        let deviation = recording.column(quantity).and_then(|column| column.deviation);
        let sensor = sensors::sensor(material, (quantity, None), shift, sensors);
        let values = values.into_iter().map(|value| value - shift).collect();
        Some(TimeSeries { observed, times, values, deviation, sensor }.without_repetitions())
    };
    Ok(COMPARED.into_iter().filter_map(of).collect())
}

fn introduction(task: &Task, found: &Identified) -> Vec<String> {
    let readings: usize = task.runs.iter().flat_map(|run| &run.time_series).map(|recorded| recorded.values.len()).sum();
    let numbers = counted(task.unknowns.len() as u64, "parameter");
    let (runs, readings) = (counted(task.runs.len() as u64, "run"), counted(readings as u64, "reading"));
    let condition = match found.found.fit.ending {
        Ending::Minimum => format!(" Condition number {:.1e}.", found.found.fit.condition),
        _ => String::new(),
    };
    vec![format!(
        "{numbers} from {readings} of {runs}, by trajectories with every event located and their exact derivatives.{condition}"
    )]
}

fn drifting(drift: &Drift, is_doubted: bool) -> String {
    let (words, unit) = (drift.observed.words(), drift.observed.unit());
    let advice = match is_doubted {
        true => units::FIRST,
        false => "a sensor that drifts (`zero` takes off what you know of it), or something that the scenario lacks",
    };
    format!(
        "{WARNED}`{}`: what the model leaves of the {words} changes by {} from the first reading to the last, where readings scatter by {}: \
         {advice}.",
        drift.run,
        quantity(drift.change, unit),
        quantity(drift.scatter, unit)
    )
}

fn unexplained(rest: &Unexplained, has_intervals: bool, is_doubted: bool) -> String {
    let advice = match is_doubted {
        true => units::FIRST,
        false => {
            "the scenario lacks something, or the search has ended away from the best values (`more_starts`, `horizon` or `segments` in \
             [search] help there)"
        }
    };
    let (words, unit) = (rest.observed.words(), rest.observed.unit());
    values::beyond_noise(&words, unit, [rest.left, rest.noise], has_intervals, advice)
}

/// That a quantity is not weighed by its scatter, and what to do.
fn unsettled(of: &Observed, found: &Identified) -> String {
    let [left, scale] = [&found.left, &found.scales].map(|all| {
        let value = all.iter().find(|(its, _)| its == of).map_or(f64::NAN, |(_, value)| *value);
        quantity(value, of.unit())
    });
    format!(
        "{WARNED}the weights did not settle: the model leaves {left} of the {}, which was weighed by {scale}. Values and intervals may be \
         off by more than they say: state the `deviation` of each column in [columns], or begin nearer (`start` in [fit]).",
        of.words()
    )
}

/// Residuals of each quantity over all runs, and of each run with and without it in the fit.
fn left(found: &Identified, held_out: &[HeldOutRun]) -> Table {
    let row = |(left, scale): (&(Observed, f64), &(Observed, f64))| {
        let (words, unit) = (left.0.words(), left.0.unit());
        let mut row = vec!["all".to_owned(), words, quantity(left.1, unit), quantity(scale.1, unit)];
        row.resize(if held_out.is_empty() { 4 } else { 5 }, "–".to_owned());
        row
    };
    let of_run = |of: &HeldOutRun| -> Vec<Vec<String>> {
        let row = |(observed, [inside, outside]): &(Observed, [f64; 2])| {
            let unit = observed.unit();
            let [inside, outside] = [inside, outside].map(|error| quantity(*error, unit));
            vec![format!("`{}`", of.name), observed.words(), inside, "–".to_owned(), outside]
        };
        of.errors.iter().map(row).collect()
    };
    let mut head = vec!["run", "quantity", "left", "scale"];
    let mut caption = "Residual of each quantity, root mean square, and the scale by which it was weighed.".to_owned();
    if !held_out.is_empty() {
        head.push("held out");
        caption.push_str(" Held out: each run in turn is left out of the fit, and the error is taken there.");
    }
    let rows = found.left.iter().zip(&found.scales).map(row).chain(held_out.iter().flat_map(of_run));
    Table { caption, head: head.into_iter().map(String::from).collect(), rows: rows.collect() }
}

fn sections(task: &Task, found: &Identified, tables: [&Table; 4], scenarios: &[(String, String)]) -> Vec<Section> {
    let tables = tables.into_iter().cloned().chain([values::correlations(&found.found.fit)]);
    let tables = tables.filter(|table| !table.head.is_empty()).collect();
    let plates = (0..task.runs.len()).zip(STEMS);
    vec![
        outcome::numbers(tables, scenarios),
        Section {
            id: "runs",
            label: "Runs",
            title: "Measured and simulated",
            plates: plates.map(|(run, stem)| plate(task, found, run, stem)).collect(),
            ..Section::default()
        },
    ]
}

/// Every reading of every run.
fn predictions(task: &Task, found: &Identified) -> Vec<Prediction> {
    let values = found.found.fit.values();
    let of_course = |run: usize, recorded: &TimeSeries| Prediction {
        run: task.runs[run].name.clone(),
        quantity: recorded.observed.words(),
        unit: recorded.observed.unit(),
        coordinates: vec![("time_s", recorded.times.clone())],
        measured: recorded.values.clone(),
        predicted: task.runs[run].readings(recorded, (&found.simulated[run], &values), &recorded.times),
    };
    let of_run =
        |run: usize| task.runs[run].time_series.iter().map(|recorded| of_course(run, recorded)).collect::<Vec<_>>();
    (0..task.runs.len()).flat_map(of_run).collect()
}

fn plate(task: &Task, found: &Identified, index: usize, stem: &'static str) -> Plate {
    let run = &task.runs[index];
    let values = found.found.fit.values();
    let fitted = (&found.simulated[index], &values[..]);
    let last = fitted.0.duration();
    let mut data = Data::new(&["quantity", "time_s", "measured", "simulated"]);
    let mut panels = Vec::new();
    // Many quantities take lower panels, so that a figure stays on one page.
    let [height, height_off] = if run.time_series.len() > 3 { [24.0, 15.0] } else { [32.0, 16.0] };
    for (place, recorded) in run.time_series.iter().enumerate() {
        let kind = recorded.observed.index().unwrap_or(Observed::ALL.len() + place);
        let times: Vec<f64> = (0..=600).map(|part| last * f64::from(part) / 600.0).collect();
        let curve = run.readings(recorded, fitted, &times);
        let predicted = run.readings(recorded, fitted, &recorded.times);
        let off: Vec<f64> =
            predicted.iter().zip(&recorded.values).map(|(predicted, value)| predicted - value).collect();
        let (words, unit) = (recorded.observed.words(), recorded.observed.unit());
        let panel =
            Panel::new(Axis::new(words, unit)).legend(if panels.is_empty() { Legend::Above } else { Legend::Hidden });
        panels.push(
            panel
                .height_mm(height)
                .series(
                    Series::dots("measured", recorded.times.clone(), recorded.values.clone())
                        .colour(Colour::Category(1)),
                )
                .series(Series::line("simulated", times, curve)),
        );
        data.rows.extend(
            recorded
                .times
                .iter()
                .zip(&recorded.values)
                .zip(&off)
                .map(|((time, value), off)| vec![kind as f64, *time, *value, value + off]),
        );
        panels.push(outcome::off("off", unit, Series::dots("", recorded.times.clone(), off)).height_mm(height_off));
    }
    let figure = Figure { width_mm: 150.0, x: Axis::new("time", "s"), panels, ..Figure::default() };
    let caption = format!("`{}`: measured and simulated, and the one less the other.", run.name);
    Plate { stem, caption, figure, data }
}
