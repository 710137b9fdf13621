//! Friction from ring-downs: all estimators, for comparison.

use super::outcome::{self, Outcome, Stems, WARNED};
use super::prediction::Prediction;
use super::values::give_or_take;
use super::{Material, remedied};
use crate::failure::Failure;
use crate::figure::symbols;
use crate::quantities::quantity;
use crate::report::{Data, Plate, Section, Table};
use mckibben::parameter::{self, Parameter};
use mckibben::simulation::{EventKind, InitialLength};
use mckibben_identify::least_squares::{Ending, Estimate};
use mckibben_identify::ring_down::{Comparison, Estimator, Free, Record, Row, Waveform, compare};
use mckibben_identify::study::{Quantity, Recording};
use mckibben_plot::{Axis, Colour, Figure, Legend, Panel, Series};
use mckibben_scenario::Scenario;

/// The figures of the runs.
pub(super) const STEMS: Stems =
    ["ring-down-1", "ring-down-2", "ring-down-3", "ring-down-4", "ring-down-5", "ring-down-6"];

/// Standard deviations of a reading by which a waveform may be off before it is reported, and the part of the swing below which it
/// is not: readings that were computed have no noise.
const MISFIT: f64 = 1.5;
const EXACT: f64 = 1e-4;
/// Part of the absolute pressure by which the one that fits may differ from the measured one.
const APART: f64 = 0.1;

/// What to do where a ring-down has no friction and its error does not say more.
const MEND: &str =
    "look at the load, the pressure and the geometry in the scenario: a mass that hangs on the sealed muscle is due";

pub(super) fn outcome(material: &Material) -> Result<Outcome, Failure> {
    let mut warnings = material.notes();
    let (mut rows, mut plates, mut scenarios) = (Vec::new(), Vec::new(), Vec::new());
    let (mut estimates, mut predictions) = (Vec::new(), Vec::new());
    let alone = material.recordings.len() == 1;
    let (runs, failed) = outcome::of_each(material.recordings.iter(), &mut warnings, |recording, _| {
        let mut scenario = material.document_of(recording)?.scenario()?;
        let measured = pressure_at_start(recording, scenario.air.atmospheric_pressure);
        scenario.initial.gauge_pressure = measured.or(scenario.initial.gauge_pressure);
        let record = record(recording)?;
        let found = compared(&scenario, &record)
            .map_err(|why| remedied(&format!("the run `{}`: {why}", recording.name), MEND))?;
        Ok((recording, (scenario, measured), record, found))
    })?;
    for (place, (recording, (scenario, measured), record, found)) in runs.iter().enumerate() {
        rows.extend(found.rows.iter().map(|row| cells(&recording.name, row)));
        let refused = found
            .refused
            .iter()
            .map(|(estimator, error)| format!("{WARNED}`{}`, {}: {error}", recording.name, name(*estimator)));
        warnings.extend(refused);
        if let Some(waveform) = &found.waveform {
            warnings.extend(
                doubts(waveform, record, (scenario, *measured))
                    .map(|text| format!("{WARNED}`{}`: {text}", recording.name)),
            );
        }
        if let Some(stem) = STEMS.get(place) {
            plates.push(plate(&recording.name, record, found, stem));
        }
        predictions.extend(prediction(&recording.name, record, found));
        if let Some((best, friction)) = best(found) {
            let file = if alone { "scenario.toml".to_owned() } else { outcome::scenario_of(&recording.name) };
            scenarios.push((file, scenario_of(scenario, found, best, &friction)));
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

/// What speaks against the model of a waveform: residuals beyond the noise, another pressure than the one that was measured,
/// friction at zero, a search without a minimum.
fn doubts(
    waveform: &Waveform,
    record: &Record,
    (scenario, measured): (&Scenario, Option<f64>),
) -> impl Iterator<Item = String> {
    let mut doubts = Vec::new();
    let noise = record.noise();
    let fold = |first: f64, pick: fn(f64, f64) -> f64| record.length().iter().copied().fold(first, pick);
    let swing = fold(f64::NEG_INFINITY, f64::max) - fold(f64::INFINITY, f64::min);
    if waveform.scatter > MISFIT * noise && waveform.scatter > EXACT * swing {
        doubts.push(format!(
            "the waveform is {} off (root mean square), {:.1} times the noise of the readings: check `load.mass`, the zero and the \
             direction of the length, and `thread_length` and `turns`. The intervals do not know of it.",
            quantity(waveform.scatter, "m"),
            waveform.scatter / noise
        ));
    }
    let fitted = waveform.start(&scenario.initial()).gauge_pressure.0;
    let atmosphere = scenario.air.atmospheric_pressure;
    let of_pressure = waveform.fit.estimates.iter().find(|estimate| estimate.name == "gauge_pressure");
    let interval = of_pressure.and_then(|estimate| estimate.confidence_interval);
    let is_apart = |measured: &f64| {
        let outside = interval.is_some_and(|[low, high]| !(low..=high).contains(measured));
        outside && (measured - fitted).abs() > APART * (fitted + atmosphere)
    };
    if let Some(measured) = measured.filter(is_apart) {
        doubts.push(format!(
            "the swing is that of a gauge pressure of {}, but {} was measured: check the unit of the pressure, whether it is gauge or \
             absolute, `load.mass`, and `thread_length` and `turns`. The scenario has the measured one.",
            quantity(fitted, "Pa"),
            quantity(measured, "Pa")
        ));
    }
    for (row, estimate) in
        [(&parameter::COULOMB_WIDTH, &waveform.coulomb_width), (&parameter::VISCOUS, &waveform.viscous)]
    {
        let contains_zero = estimate.confidence_interval.is_some_and(|[low, high]| low < 0.0 && high > 0.0);
        if estimate.on_bound {
            doubts.push(format!(
                "`{}` comes out as 0, the least that it can be, and has no interval: a wrong mass, geometry or length takes the place \
                 of friction, or the record is too short to separate both frictions.",
                row.key
            ));
        } else if contains_zero {
            doubts.push(format!(
                "the interval of `{}` contains zero: it is hardly identifiable from the record.",
                row.key
            ));
        }
    }
    if waveform.fit.ending != Ending::Minimum {
        doubts.push(
            "the search of the waveform ended before it was at a minimum, so its numbers have no intervals.".to_owned(),
        );
    }
    doubts.into_iter()
}

/// The scenario with the friction that was found, from the first reading on: at the length and the velocity that fit best there.
fn scenario_of(base: &Scenario, found: &Comparison, by: Estimator, [width, viscous]: &[Estimate; 2]) -> String {
    let mut scenario = base.clone();
    if let Some(waveform) = &found.waveform {
        let start = waveform.start(&base.initial());
        if let InitialLength::At(length) = start.length {
            scenario.initial.length = mckibben_scenario::InitialLength::At(length);
        }
        scenario.initial.velocity = start.velocity;
    }
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

#[cfg(test)]
mod tests {
    use super::super::{Request, identified};
    use super::Outcome;
    use mckibben::simulation::simulate;
    use mckibben_identify::study::Table;
    use mckibben_scenario::Document;

    fn rig(mass: f64) -> Document {
        let text = format!(
            "[actuator]\npreset = \"colbrunn-2001\"\n[actuator.friction]\nviscous = \"3.5 N*s/m\"\ncoulomb_width = \"0.11 mm\"\n\
             [load]\nkind = \"hanging-mass\"\nmass = \"{mass} kg\"\n[initial]\ngauge_pressure = \"4 bar\"\nlength = \"84 mm\"\n\
             [run]\nduration = \"0.9 s\"\n"
        );
        Document::parse(&text, "rig.toml").expect("a scenario")
    }

    /// What is found of a ring-down of 3 kg from 85 mm, with noise of 20 µm, by a study that says another mass and pressure.
    fn found(mass: f64, held: &str) -> Outcome {
        let scenario = rig(3.0).scenario().expect("a scenario");
        let simulated = scenario.rig().expect("a rig");
        let mut start = scenario.initial();
        start.length = mckibben::simulation::InitialLength::At(0.085);
        let run = simulate(&simulated, simulated.start(&start).expect("a start"), 0.9, 1e-9).expect("a run");
        // A sum of twelve uniform numbers less six is normal enough.
        let mut state = 7_u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let times: Vec<f64> = (0..450).map(|place| 2e-3 * f64::from(place)).collect();
        let mut noise = || 2e-5 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0);
        let lengths = times.iter().map(|time| run.at(*time).length + noise()).collect();
        let table = Table::new("swing", vec![("t".to_owned(), times), ("L".to_owned(), lengths)]).expect("a table");
        let study = format!(
            "[study]\nkind = \"ring-down\"\nscenario = \"rig.toml\"\n[columns.time]\nname = \"t\"\n[columns.length]\nname = \"L\"\n\
             [[run]]\nfile = \"swing\"\nheld = {{ gauge_pressure = \"{held}\" }}\n"
        );
        identified(Request::in_memory(&study, vec![table], rig(mass)).expect("a study"), None).expect("it is found")
    }

    #[test]
    fn a_ring_down_of_another_mass_or_pressure_is_doubted() {
        let right = found(3.0, "4 bar");
        let said = |of: &Outcome| of.warnings.join("\n");
        assert!(
            !said(&right).contains("times the noise") && !said(&right).contains("was measured"),
            "{}",
            said(&right)
        );
        // The scenario begins where the record does, 1 mm above the length in the file.
        let written = rig_of(&right);
        assert!((written - 0.085).abs() < 1e-4, "{written}");
        let heavy = said(&found(6.6, "4 bar"));
        assert!(heavy.contains("times the noise of the readings: check `load.mass`"), "{heavy}");
        let psi = said(&found(3.0, "58 bar"));
        assert!(psi.contains("was measured: check the unit of the pressure"), "{psi}");
    }

    /// The initial length in m of the scenario that was written.
    fn rig_of(found: &Outcome) -> f64 {
        let (name, text) = &found.scenarios[0];
        let scenario = Document::parse(text, name).expect("it is read").scenario().expect("a scenario");
        match scenario.initial.length {
            mckibben_scenario::InitialLength::At(length) => length,
            other => panic!("{other:?}"),
        }
    }
}
