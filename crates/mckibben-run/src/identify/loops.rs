//! Loops of tension over length to friction and hysteresis: tables, figures and words.

use super::outcome::{self, Outcome, Stems, WARNED};
use super::prediction::Prediction;
use super::{Material, column, gauge_pressures, minima, remedied, units, unknowns, values};
use crate::failure::Failure;
use crate::quantities::{counted, quantity};
use crate::report::{Data, Plate, Section, Table};
use mckibben::parameter;
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::least_squares::Ending;
use mckibben_identify::loops::{Loop, LoopError, LoopFit, LoopTask, Sample, tensions};
use mckibben_identify::study::{Quantity, Recording};
use mckibben_plot::{Axis, Colour, Figure, Legend, Panel, Series};

/// The figures of the loops.
pub(super) const STEMS: Stems = ["loop-1", "loop-2", "loop-3", "loop-4", "loop-5", "loop-6"];

/// Noise of a length in m below which it is that of rounded numbers.
const ROUNDING: f64 = 1e-10;
/// One reading in so many may be left out without a warning.
const MOST_LEFT_OUT: usize = 10;

pub(super) fn outcome(material: &Material) -> Result<Outcome, Failure> {
    let scenario = material.document.scenario()?;
    let (places, unknowns) = unknowns::all(material)?;
    let atmosphere = scenario.air.atmospheric_pressure;
    let loops =
        material.recordings.iter().map(|recording| read(recording, atmosphere)).collect::<Result<Vec<_>, _>>()?;
    let deviation = material.recordings.first().and_then(|recording| recording.column(Quantity::Tension)?.deviation);
    let given = material.document.says_of_each(parameter::MIN_LENGTH.key);
    let task = LoopTask {
        adjustable: Adjustable::new(scenario, places, given),
        starts: unknowns::more_starts(&material.study, &unknowns, material.study.search.more_starts.unwrap_or(0)),
        unknowns,
        loops,
        deviation,
        search: material.search(),
    };
    let found = task.identify().map_err(|error| match error {
        LoopError::Fit(_) => Failure::stopped(error.to_string()),
        _ => remedied(&error.to_string(), "change the study"),
    })?;
    let mut warnings = material.notes();
    warnings.extend(task.loops.iter().filter_map(left_out));
    warnings.extend(values::warnings(&found.found.fit, &task.unknowns));
    warnings.extend(material.stopped().filter(|_| found.found.fit.ending == Ending::Minimum));
    let minima = minima::of(&found.found, &task.unknowns);
    warnings.extend(minima.words());
    let has_intervals = found.found.fit.ending == Ending::Minimum;
    let unexplained = task.unexplained(&found);
    let understated = task.understated(&found).filter(|_| unexplained.is_none());
    warnings
        .extend(understated.map(|scale| values::understated("tension", "N", [found.typical, scale], has_intervals)));
    warnings.extend(unexplained.map(|noise| {
        let advice = match units::doubts(material).is_empty() {
            true => {
                "look at the units, the offsets and the geometry; the scenario lacks something, or the search has ended away from the best \
                 values (`more_starts` in [search] helps there)"
            }
            false => units::FIRST,
        };
        values::beyond_noise("tension", "N", [found.typical, noise], has_intervals, advice)
    }));
    let scenarios = vec![("scenario.toml".to_owned(), outcome::file(&found.scenario))];
    let numbers = values::table("Numbers with their 95 % intervals".to_owned(), &found.found.fit);
    let predictions = predictions(&task, &found)?;
    let table = compared(&task, &predictions);
    let sections = sections(&task, &found, [&table, &numbers, &minima.table], &scenarios)?;
    let readings = found.found.fit.residuals.len();
    let hidden: usize = task.loops.iter().map(Loop::left_out).sum();
    let introduction = format!(
        "{} from {} of {}, length and pressure taken as they were measured; {} near reversals and rests left out, where the direction \
         of the length is not known. Residual of the tension: {} root mean square.",
        counted(task.unknowns.len() as u64, "parameter"),
        counted(readings as u64, "tension"),
        counted(task.loops.len() as u64, "loop"),
        counted(hidden as u64, "reading"),
        quantity(found.left, "N")
    );
    Ok(Outcome {
        title: format!("Loops of {}", material.name()),
        introduction: vec![introduction],
        sections,
        table,
        values: numbers,
        predictions,
        correlations: values::matrix(&found.found.fit),
        estimates: found.found.fit.estimates,
        minima: minima.table,
        other_minima: minima.others,
        warnings,
        scenarios,
        ..Outcome::default()
    })
}

/// The samples of a recording that have a time, a length, a pressure and a tension.
fn read(recording: &Recording, atmosphere: f64) -> Result<Loop, Failure> {
    let values = |quantity: Quantity| column(recording, quantity).map(|column| &column.values);
    let [times, lengths, forces] = [values(Quantity::Time)?, values(Quantity::Length)?, values(Quantity::Tension)?];
    let pressures = gauge_pressures(recording, atmosphere)?;
    let sample = |place: usize| Sample {
        time: times[place],
        length: lengths[place],
        gauge_pressure: pressures[place],
        tension: forces[place],
    };
    let whole = |sample: &Sample| {
        [sample.time, sample.length, sample.gauge_pressure, sample.tension].iter().all(|number| number.is_finite())
    };
    let samples = (0..times.len()).map(sample).filter(whole).collect();
    let of_pressure = [Quantity::AbsolutePressure, Quantity::GaugePressure]
        .into_iter()
        .find_map(|pressure| recording.column(pressure))
        .and_then(|pressure| pressure.deviation);
    let deviations = [column(recording, Quantity::Length)?.deviation, of_pressure];
    Loop::new(recording.name.clone(), samples, deviations)
        .map_err(|error| remedied(&error.to_string(), "record the length to and fro"))
}

/// That more than a tenth of the readings of a loop does not count, and why.
fn left_out(of: &Loop) -> Option<String> {
    let hidden = of.left_out();
    let readings = hidden + of.counted();
    if hidden * MOST_LEFT_OUT <= readings {
        return None;
    }
    let what = format!(
        "{WARNED}`{}`: {hidden} of {readings} readings from the first reversal on were left out, because the direction of the length is not \
         known there:",
        of.name
    );
    Some(match of.window() {
        ..=3 => format!("{what} a reversal or a rest is too near. Read more often, or move farther between reversals."),
        window => format!(
            "{what} the length has noise of {}, and its direction is taken from {window} readings. Read the length with less noise, move \
             faster, or fit kind = \"trajectories\".",
            quantity(of.length_noise(), "m")
        ),
    })
}

/// What counts of each loop, and what is left of it.
fn compared(task: &LoopTask, predictions: &[Prediction]) -> Table {
    let row = |(of, prediction): (&Loop, &Prediction)| {
        let squares =
            prediction.measured.iter().zip(&prediction.predicted).map(|(measured, of)| (of - measured).powi(2));
        let left = (squares.sum::<f64>() / prediction.measured.len().max(1) as f64).sqrt();
        let counts = [of.counted(), of.left_out()].map(|count| count.to_string());
        let noise = match of.length_noise() {
            noise if noise < ROUNDING => "–".to_owned(),
            noise => quantity(noise, "m"),
        };
        let left = quantity(left, "N");
        [format!("`{}`", of.name)].into_iter().chain(counts).chain([noise, left]).collect()
    };
    Table {
        caption: "Readings from the first reversal on: those that count, and those left out because the direction of the length is not \
                  known there; the noise of the length; and the residual of the tension, root mean square."
            .to_owned(),
        head: ["run", "readings", "left out", "noise", "residual"].map(String::from).to_vec(),
        rows: task.loops.iter().zip(predictions).map(row).collect(),
    }
}

/// The tensions of every loop.
fn predictions(task: &LoopTask, found: &LoopFit) -> Result<Vec<Prediction>, Failure> {
    let driven = found.scenario.driven().map_err(|error| Failure::stopped(error.to_string()))?;
    let of_loop = |of: &Loop| {
        let pairs = tensions(of, &driven.actuator);
        let column = |value: fn(&Sample) -> f64| pairs.iter().map(|(sample, _)| value(sample)).collect::<Vec<f64>>();
        Prediction {
            run: of.name.clone(),
            quantity: "tension".to_owned(),
            unit: "N",
            coordinates: vec![
                ("time_s", column(|sample| sample.time)),
                ("length_m", column(|sample| sample.length)),
                ("gauge_pressure_pa", column(|sample| sample.gauge_pressure)),
            ],
            measured: column(|sample| sample.tension),
            predicted: pairs.iter().map(|(_, tension)| *tension).collect(),
        }
    };
    Ok(task.loops.iter().map(of_loop).collect())
}

fn sections(
    task: &LoopTask,
    found: &LoopFit,
    tables: [&Table; 3],
    scenarios: &[(String, String)],
) -> Result<Vec<Section>, Failure> {
    let driven = found.scenario.driven().map_err(|error| Failure::stopped(error.to_string()))?;
    let tables = tables.into_iter().cloned().chain([values::correlations(&found.found.fit)]);
    let tables = tables.filter(|table| !table.head.is_empty()).collect();
    let plates = task.loops.iter().zip(STEMS).map(|(of, stem)| {
        let pairs = tensions(of, &driven.actuator);
        let lengths: Vec<f64> = pairs.iter().map(|(sample, _)| sample.length).collect();
        let measured: Vec<f64> = pairs.iter().map(|(sample, _)| sample.tension).collect();
        let fitted: Vec<f64> = pairs.iter().map(|(_, tension)| *tension).collect();
        let off = measured.iter().zip(&fitted).map(|(measured, fitted)| fitted - measured).collect();
        let mut data = Data::new(&["time_s", "length_m", "gauge_pressure_pa", "measured_n", "fitted_n"]);
        data.rows = pairs
            .iter()
            .map(|(sample, tension)| vec![sample.time, sample.length, sample.gauge_pressure, sample.tension, *tension])
            .collect();
        let top = Panel::new(Axis::new("tension", "N"))
            .legend(Legend::Above)
            .height_mm(60.0)
            .series(Series::dots("measured", lengths.clone(), measured).colour(Colour::Category(1)))
            .series(Series::line("fitted", lengths.clone(), fitted));
        let rest = outcome::off("off", "N", Series::dots("", lengths, off));
        let figure =
            Figure { width_mm: 130.0, x: Axis::new("length", "m"), panels: vec![top, rest], ..Figure::default() };
        Plate {
            stem,
            caption: format!("`{}`: measured and fitted, and the one less the other.", of.name),
            figure,
            data,
        }
    });
    Ok(vec![
        outcome::numbers(tables, scenarios),
        Section {
            id: "loops",
            label: "Loops",
            title: "Measured and fitted",
            plates: plates.collect(),
            ..Section::default()
        },
    ])
}

#[cfg(test)]
mod tests {
    use super::{Loop, Sample, left_out};

    /// Strokes of 2 mm by readings that are 40 µm apart, with noise of so many micrometres: a fixed sequence that is not smooth.
    fn strokes(noise: f64, readings: u32) -> Loop {
        let sample = |place: u32| {
            let phase = f64::from(place % (2 * readings)) / f64::from(readings);
            let way = if phase < 1.0 { phase } else { 2.0 - phase };
            let shake = (12.9898 * f64::from(place)).sin() * 43_758.545_3;
            let length = 86e-3 + 2e-3 * way + 1e-6 * noise * 3.46 * (shake - shake.floor() - 0.5);
            Sample { time: 0.02 * f64::from(place), length, gauge_pressure: 4e5, tension: 50.0 }
        };
        Loop::new("slow", (0..10 * readings).map(sample).collect(), [None; 2]).expect("a loop")
    }

    #[test]
    fn a_warning_says_why_readings_are_left_out() {
        assert_eq!(left_out(&strokes(0.0, 50)), None);
        let said = left_out(&strokes(60.0, 50)).expect("noise of more than a reading's way");
        assert!(said.contains("the length has noise of 6") && said.contains("less noise, move faster"), "{said}");
        let said = left_out(&strokes(0.0, 5)).expect("five readings of a stroke");
        assert!(said.contains("Read more often"), "{said}");
    }
}
