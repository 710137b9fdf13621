//! Friction from ring-downs: all estimators, for comparison.

use super::Material;
use super::outcome::{self, Outcome, Stems, WARNED};
use super::prediction::Prediction;
use super::values::give_or_take;
use crate::failure::Failure;
use crate::figure::symbols;
use crate::quantities::quantity;
use crate::report::{Data, Plate, Section, Table};
use mckibben::parameter::{self, Parameter};
use mckibben::simulation::EventKind;
use mckibben_identify::least_squares::Estimate;
use mckibben_identify::ring_down::{Comparison, Estimator, Free, Record, Row, Waveform, compare};
use mckibben_identify::study::{Quantity, Recording};
use mckibben_plot::{Axis, Colour, Figure, Legend, Panel, Series};
use mckibben_scenario::Scenario;

/// The figures of the runs.
pub(super) const STEMS: Stems =
    ["ring-down-1", "ring-down-2", "ring-down-3", "ring-down-4", "ring-down-5", "ring-down-6"];

pub(super) fn outcome(material: &Material) -> Result<Outcome, Failure> {
    let mut warnings = material.notes();
    let (mut rows, mut plates, mut scenarios) = (Vec::new(), Vec::new(), Vec::new());
    let (mut estimates, mut predictions) = (Vec::new(), Vec::new());
    let alone = material.recordings.len() == 1;
    let (runs, failed) = outcome::of_each(material.recordings.iter(), &mut warnings, |recording, _| {
        let mut scenario = material.document_of(recording)?.scenario()?;
        if let Some(pressure) = pressure_at_start(recording, scenario.air.atmospheric_pressure) {
            scenario.initial.gauge_pressure = Some(pressure);
        }
        let record = record(recording)?;
        let found = compared(&scenario, &record)
            .map_err(|why| Failure::input(format!("the run `{}`: {why}", recording.name), "see docs/identify.md"))?;
        Ok((recording, scenario, record, found))
    })?;
    for (place, (recording, scenario, record, found)) in runs.iter().enumerate() {
        rows.extend(found.rows.iter().map(|row| cells(&recording.name, row)));
        let refused = found
            .refused
            .iter()
            .map(|(estimator, error)| format!("{WARNED}`{}`, {}: {error}", recording.name, name(*estimator)));
        warnings.extend(refused);
        if let Some(stem) = STEMS.get(place) {
            plates.push(plate(&recording.name, record, found, stem));
        }
        predictions.extend(prediction(&recording.name, record, found));
        if let Some((best, friction)) = best(found) {
            let file = if alone { "scenario.toml".to_owned() } else { outcome::scenario_of(&recording.name) };
            scenarios.push((file, scenario_of(scenario, best, &friction)));
            let behind = if alone { String::new() } else { format!(" [{}]", recording.name) };
            estimates
                .extend(friction.map(|estimate| Estimate { name: format!("{}{behind}", estimate.name), ..estimate }));
        }
    }
    let table = Table {
        caption: "Friction by every estimator, with 95 % intervals. Q of (12) where the actuator is known; ‘shown’ is that of an equal linear spring."
            .to_owned(),
        head: ["run", "estimator", "Q of (12) mm", "Q shown mm", "c N·s/m", "ζ", "scatter"].map(String::from).to_vec(),
        rows,
    };
    let files = scenarios.iter().map(|(name, text)| (name.clone().into(), text.clone().into())).collect();
    let sections = vec![Section {
        id: "friction",
        label: "Friction",
        title: "Every estimator",
        tables: vec![table.clone()],
        plates,
        files,
        ..Section::default()
    }];
    let introduction = "Two cycles are the first and the last; the waveform is the whole record, by a trajectory with every stop located. Where they \
                        disagree by more than their intervals, the spring is not linear or friction is not what the estimator takes it for."
        .to_owned();
    Ok(Outcome {
        title: format!("Ring-downs of {}", material.name()),
        introduction: vec![introduction],
        sections,
        table,
        values: Table::default(),
        estimates,
        predictions,
        warnings,
        scenarios,
        failed,
        ..Outcome::default()
    })
}

fn record(recording: &Recording) -> Result<Record, Failure> {
    let Some((times, lengths)) = recording.channel(Quantity::Length) else {
        let title = format!("the run `{}` has no length over time", recording.name);
        return Err(Failure::input(title, "add `[columns.time]` and `[columns.length]`"));
    };
    Record::new(times, lengths)
        .map_err(|error| Failure::input(format!("the run `{}`: {error}", recording.name), "mend the table"))
}

/// The gauge pressure in Pa with which the air was sealed, where the recording has a pressure or states the one that was held.
fn pressure_at_start(recording: &Recording, atmosphere: f64) -> Option<f64> {
    let first = |quantity| recording.column(quantity)?.values.iter().copied().find(|value| value.is_finite());
    first(Quantity::GaugePressure).or_else(|| Some(first(Quantity::AbsolutePressure)? - atmosphere))
}

/// Every estimator, the waveform's on the scenario's sealed rig; or why there is none.
fn compared(scenario: &Scenario, record: &Record) -> Result<Comparison, String> {
    let rig = scenario.rig().map_err(|error| error.to_string())?;
    let Some(inertia) = rig.load().inertia() else {
        return Err("its load has no mass that swings".to_owned());
    };
    compare(record, inertia.mass, Some((&rig, &scenario.initial(), Free::ALL))).map_err(|error| error.to_string())
}

fn name(estimator: Estimator) -> &'static str {
    match estimator {
        Estimator::PaperTwoCycles => "two cycles, the paper’s (25)–(31)",
        Estimator::ExactTwoCycles => "two cycles, exact recursion",
        Estimator::AllTurns => "all turns",
        Estimator::Equivalent => "both frictions as one, (32)",
        Estimator::Waveform => "waveform",
    }
}

fn cells(run: &str, row: &Row) -> Vec<String> {
    vec![
        run.to_owned(),
        name(row.estimator).to_owned(),
        row.law_width.as_ref().map_or("–".to_owned(), |width| give_or_take(width, 1e3)),
        give_or_take(&row.coulomb_width, 1e3),
        give_or_take(&row.viscous, 1.0),
        give_or_take(&row.damping_ratio, 1.0),
        row.scatter.map_or("–".to_owned(), |scatter| quantity(scatter, "m")),
    ]
}

/// The friction of the waveform, or of all turns where there is none, under the names that a scenario has for it.
fn best(found: &Comparison) -> Option<(Estimator, [Estimate; 2])> {
    let of = |estimator: Estimator| found.rows.iter().find(|row| row.estimator == estimator);
    let best = of(Estimator::Waveform).or_else(|| of(Estimator::AllTurns))?;
    let named =
        |parameter: &Parameter, estimate: &Estimate| Estimate { name: parameter.key.to_owned(), ..estimate.clone() };
    let width = named(&parameter::COULOMB_WIDTH, best.law_width.as_ref()?);
    Some((best.estimator, [width, named(&parameter::VISCOUS, &best.viscous)]))
}

/// The scenario with the friction that was found.
fn scenario_of(base: &Scenario, by: Estimator, [width, viscous]: &[Estimate; 2]) -> String {
    let mut scenario = base.clone();
    scenario.actuator.friction.coulomb_width = width.value.max(0.0);
    scenario.actuator.friction.viscous = viscous.value.max(0.0);
    format!("# Friction by `mckibben identify`: {}.\n\n{}", name(by), scenario.to_toml())
}

/// How far the fitted waveform is off in m, reading by reading.
fn off(waveform: &Waveform) -> Vec<f64> {
    let unit = waveform.scatter / waveform.fit.scatter.max(f64::MIN_POSITIVE);
    waveform.fit.residuals.iter().map(|residual| residual * unit).collect()
}

/// The length with the fitted waveform, where there is one.
fn prediction(run: &str, record: &Record, found: &Comparison) -> Option<Prediction> {
    let off = off(found.waveform.as_ref()?);
    Some(Prediction {
        run: run.to_owned(),
        quantity: "length".to_owned(),
        unit: "m",
        coordinates: vec![("time_s", record.time().to_vec())],
        measured: record.length().to_vec(),
        predicted: record.length().iter().zip(off).map(|(length, off)| length + off).collect(),
    })
}

fn plate(run: &str, record: &Record, found: &Comparison, stem: &'static str) -> Plate {
    let (times, lengths) = (record.time().to_vec(), record.length().to_vec());
    let (at, turns) = found.turns.turns.iter().map(|turn| (turn.time, turn.length)).unzip();
    let mut panels = vec![
        Panel::new(Axis::new("length", "m"))
            .legend(Legend::Above)
            .series(Series::dots("measured", times.clone(), lengths.clone()).colour(Colour::Category(1)))
            .marks(symbols::marks(EventKind::Reversal, "turns", at, turns)),
    ];
    let mut data = Data::new(&["time_s", "length_m", "off_m"]).lacking(&["off_m"]);
    if let Some(waveform) = &found.waveform {
        let off = off(waveform);
        data.rows =
            times.iter().zip(&lengths).zip(&off).map(|((time, length), off)| vec![*time, *length, *off]).collect();
        panels.push(outcome::off("waveform off", "m", Series::dots("", times, off)));
    } else {
        data.rows = times.iter().zip(&lengths).map(|(time, length)| vec![*time, *length, f64::NAN]).collect();
    }
    let figure = Figure { width_mm: 150.0, x: Axis::new("time", "s"), panels, ..Figure::default() };
    Plate {
        stem,
        caption: format!("`{run}`: the record with its turns, and how far the fitted waveform is off."),
        figure,
        data,
    }
}
