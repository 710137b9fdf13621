//! Delays of a poppet from the pressure under pulse trains.

use super::super::outcome::{self, Outcome, WARNED, file};
use super::super::{Material, Prediction, pressure_over_time, values};
use super::{Stems, at_its_end, failed, named, put, says_its_end, valve_of, with_interval};
use crate::failure::Failure;
use crate::figure::symbols;
use crate::quantities::counted;
use crate::report::{Data, Plate, Section, Table};
use mckibben::parameter::{self, Parameter};
use mckibben_identify::least_squares::Estimate;
use mckibben_identify::study::clean::{STUCK, longest_at_the_end};
use mckibben_identify::study::{PulsesEntry, Quantity, Recording};
use mckibben_identify::valve::{Delays, DutyPoint, Onset, PulseTrain, delay_difference};
use mckibben_plot::{Axis, Colour, Figure, Legend, Panel, Series, Span};
use mckibben_scenario::{Command, CommandState, Scenario, ValveKind};

/// The figures of the runs, and that of all of them.
pub(super) const STEMS: Stems = ["pulses-1", "pulses-2", "pulses-3", "pulses-4", "pulses-5", "pulses-6"];
pub(super) const DUTY: &str = "duty";

/// Periods in a figure: enough to see the onsets.
const SHOWN: f64 = 4.0;

/// A run with the edges of its coil and what came of them.
struct Run<'a> {
    name: &'a str,
    times: Vec<f64>,
    pressures: Vec<f64>,
    quantity: Quantity,
    train: PulseTrain,
    found: Delays,
}

/// Opening and closing delay over all runs, and duty against effective duty.
pub(in super::super) fn pulse_train(material: &Material) -> Result<Outcome, Failure> {
    let scenario = material.document.scenario()?;
    let mut warnings = material.notes();
    let (runs, failed) = outcome::of_each(material.recordings.iter(), &mut warnings, |recording, warnings| {
        run(material, recording, warnings)
    })?;
    let records: Vec<Delays> = runs.iter().map(|run| run.found.clone()).collect();
    let Some(delays) = Delays::over_all(&records) else { return Err(Failure::stopped("nothing was found")) };
    let rows: [&Parameter; 2] = [&parameter::OPENING_DELAY, &parameter::CLOSING_DELAY];
    let numbers: Vec<Estimate> = rows.iter().zip(&delays).map(|(row, delay)| named(delay, row)).collect();
    let text = file(&with_delays(&scenario, rows, &delays, &mut warnings)?);
    let points = duties(&runs);
    let mut introduction = vec![format!(
        "From energised to the opening {}, from released to the closing {}, over {} of {}.",
        with_interval(&delays[0]),
        with_interval(&delays[1]),
        counted(runs.iter().map(|run| run.found.onsets.len() as u64).sum(), "onset"),
        counted(runs.len() as u64, "run")
    )];
    // With one frequency and duty alone the duties repeat what the onsets say.
    if points.len() > 1 {
        let difference = delay_difference(&points).map_err(|error| super::failed("all", &error))?;
        introduction.push(format!(
            "The paper’s way, by what the effective duty lacks over the frequency: the opening takes {} longer than the closing.",
            with_interval(&difference)
        ));
    }
    let mut plates: Vec<Plate> = runs.iter().zip(STEMS).map(|(run, stem)| onset_plate(run, stem)).collect();
    plates.extend(duty_plate(&points, &delays));
    let estimates = numbers;
    let numbers = values::of("Numbers with their 95 % intervals".to_owned(), &estimates);
    let table = table(&runs);
    let scenarios = vec![("scenario.toml".to_owned(), text)];
    let sections = vec![
        outcome::numbers(vec![numbers.clone(), table.clone()], &scenarios),
        Section { id: "pulses", label: "Pulses", title: "Onsets, and duties", plates, ..Section::default() },
    ];
    Ok(Outcome {
        title: format!("Pulse trains of {}", material.name()),
        introduction,
        sections,
        table,
        values: numbers,
        estimates: estimates.to_vec(),
        predictions: predictions(&runs, &delays),
        warnings,
        scenarios,
        failed,
        ..Outcome::default()
    })
}

fn run<'a>(material: &Material, recording: &'a Recording, warnings: &mut Vec<String>) -> Result<Run<'a>, Failure> {
    let name = recording.name.as_str();
    let scenario = material.document_of(recording)?.scenario()?;
    // Only changes count, so either pressure will do as it stands.
    let (quantity, times, pressures) = pressure_over_time(recording)?;
    let (stuck, largest) = longest_at_the_end(&pressures);
    let silent = !says_its_end(material, quantity);
    if silent && stuck >= STUCK && 50 * stuck >= pressures.len() {
        return Err(at_its_end(name, quantity.words(), (stuck, largest), "while the valve is pulsed"));
    }
    let train = train(recording, &scenario, material.study.pulses, &times, warnings)?;
    let found = Delays::find(&times, &pressures, &train).map_err(|error| failed(name, &error))?;
    if found.missed > 0 {
        let edges = train.edges().len();
        warnings.push(format!(
            "{WARNED}`{name}`: after {} of {edges} edges the pressure does not respond; they were left out. A pulse \
             shorter than its delay does not move the seat, and nothing is seen near equal pressures.",
            found.missed
        ));
    }
    for (which, windows) in ["opening", "closing"].iter().zip(&found.windows).filter(|(_, of)| of.unconfirmed) {
        warnings.push(format!(
            "{WARNED}`{name}`: too few samples lie between the bends of the pressure: the {which} delay differs by {:.3} ms between the \
             narrowest windows about an edge, {} samples on a side, and the next wider ones. Its interval holds that; sample faster, or \
             pulse so that the pressure comes near neither the supply’s nor the atmosphere’s.",
            1e3 * windows.model_error,
            windows.samples
        ));
    }
    Ok(Run { name, times, pressures, quantity, train, found })
}

/// The edges of the coil: from the column of the command, or of the scenario's PWM.
fn train(
    recording: &Recording,
    scenario: &Scenario,
    entry: PulsesEntry,
    times: &[f64],
    warnings: &mut Vec<String>,
) -> Result<PulseTrain, Failure> {
    let name = recording.name.as_str();
    if recording.column(Quantity::Command).is_some() {
        let Some((times, command)) = recording.channel(Quantity::Command) else {
            let title = format!("the run `{name}` has no command over time");
            return Err(Failure::input(title, "add `[columns.time]`, in the same table"));
        };
        let ends = command
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(*value), high.max(*value)]);
        let threshold = entry.threshold.unwrap_or(0.5 * (ends[0] + ends[1]));
        if !(ends[0]..ends[1]).contains(&threshold) {
            let title = format!(
                "the run `{name}`: the command lies between {} and {} and never crosses the threshold {threshold}",
                ends[0], ends[1]
            );
            return Err(Failure::input(
                title,
                "give `threshold` in `[pulses]` between the two, and a record with pulses",
            ));
        }
        let step = times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        warnings.push(format!(
            "`{name}`: the edges are those of the sampled command, each to half a step of {:.3} ms, which the intervals do not \
             know of.",
            1e3 * step
        ));
        return PulseTrain::of_command(&times, &command, threshold).map_err(|error| failed(name, &error));
    }
    let refused = |title: String, help: &str| Failure::input(format!("the run `{name}`: {title}"), help);
    let Some(Command::Pwm { frequency, duty, pulse, rest }) = &scenario.command else {
        let help = "add `[columns.command]`, or give `[command]` of the scenario `kind = \"pwm\"`, `frequency` and `duty`, \
                    per run by `set`";
        return Err(refused("nothing says when the coil was energised".to_owned(), help));
    };
    let of_column = "add `[columns.command]` with the command to the coil";
    let inverted = match (valve_of(scenario)?.kind, pulse, rest) {
        (ValveKind::TwoWay | ValveKind::ThreeWay, CommandState::Fill, _) => false,
        (ValveKind::FillHoldExhaust, CommandState::Fill, CommandState::Hold) => false,
        (ValveKind::FillHoldExhaust, CommandState::Exhaust, CommandState::Hold) => false,
        (ValveKind::ThreeWayNormallyOpen, CommandState::Fill, _) => true,
        _ => {
            let title =
                "the scenario’s valve and command do not pulse one coil between energised in the pulse and released"
                    .to_owned();
            return Err(refused(title, of_column));
        }
    };
    let [first, last] = [times.first(), times.last()].map(|time| time.copied().unwrap_or(0.0));
    let pulses = (frequency * (last - entry.begins).max(0.0)).floor() as usize + 1;
    let train = PulseTrain::pwm(*frequency, *duty, pulses).map_err(|error| failed(name, &error))?;
    // An edge counts where the record goes on for half of the shorter of pulse and pause.
    let least = duty.min(1.0 - duty) / frequency;
    let train = train.within(entry.begins, [first, last - 0.5 * least]);
    Ok(if inverted { train.turned() } else { train })
}

/// The scenario with the delays; one that scatters below zero is zero.
fn with_delays(
    scenario: &Scenario,
    rows: [&Parameter; 2],
    delays: &[Estimate; 2],
    warnings: &mut Vec<String>,
) -> Result<Scenario, Failure> {
    let mut scenario = scenario.clone();
    let valve = valve_of(&scenario)?;
    if matches!(valve.kind, ValveKind::PressureRegulator | ValveKind::ProportionalSpool) {
        let title = "the scenario’s valve has no seats, and so no delays";
        return Err(Failure::input(title, "fit `trajectories` to its own numbers"));
    }
    if valve.opening_time > 0.0 || valve.closing_time > 0.0 {
        warnings.push(format!(
            "{WARNED}the scenario’s seat takes its time: an onset is where two curves cross, somewhat behind the delay."
        ));
    }
    for (row, delay) in rows.iter().zip(delays) {
        if delay.value < 0.0 {
            warnings.push(format!("{WARNED}`{}` comes out as {}; the scenario has 0.", row.key, with_interval(delay)));
        }
        put(&mut scenario, &[(*row, delay.value.max(0.0))])?;
    }
    Ok(scenario)
}

/// The duties of the runs that have whole periods.
fn duties(runs: &[Run<'_>]) -> Vec<DutyPoint> {
    let point = |run: &Run<'_>| {
        let [frequency, commanded] = run.train.frequency_and_duty()?;
        Some(DutyPoint { frequency, commanded, effective: run.found.effective_duty.as_ref()?.value })
    };
    runs.iter().filter_map(point).collect()
}

/// The delay of each onset of a run, and that over all runs: openings and closings separately.
fn predictions(runs: &[Run<'_>], delays: &[Estimate; 2]) -> Vec<Prediction> {
    let of_run = |run: &Run<'_>| {
        let seats = [("opening delay", true), ("closing delay", false)].into_iter().zip(delays);
        let seats = seats.map(|((quantity, energised), delay)| {
            let onsets: Vec<&Onset> = run.found.onsets.iter().filter(|onset| onset.energised == energised).collect();
            Prediction {
                run: run.name.to_owned(),
                quantity: quantity.to_owned(),
                unit: "s",
                coordinates: vec![("edge_s", onsets.iter().map(|onset| onset.edge).collect())],
                measured: onsets.iter().map(|onset| onset.time - onset.edge).collect(),
                predicted: vec![delay.value; onsets.len()],
            }
        });
        seats.filter(|prediction| !prediction.measured.is_empty()).collect::<Vec<_>>()
    };
    runs.iter().flat_map(of_run).collect()
}

fn table(runs: &[Run<'_>]) -> Table {
    let row = |run: &Run<'_>| {
        let [frequency, duty] = match run.train.frequency_and_duty() {
            Some([frequency, duty]) => [format!("{frequency:.3}"), format!("{duty:.4}")],
            None => ["–", "–"].map(String::from),
        };
        let effective =
            run.found.effective_duty.as_ref().map_or("–".to_owned(), |duty| values::give_or_take(duty, 1.0));
        let onsets = format!("{} of {}", run.found.onsets.len(), run.train.edges().len());
        let [opening, closing] = [&run.found.opening, &run.found.closing].map(|delay| values::give_or_take(delay, 1e3));
        vec![run.name.to_owned(), frequency, duty, effective, opening, closing, onsets]
    };
    Table {
        caption: "Run by run, with 95 % intervals".to_owned(),
        head: ["run", "frequency Hz", "duty", "effective duty", "opening delay ms", "closing delay ms", "onsets"]
            .map(String::from)
            .to_vec(),
        rows: runs.iter().map(row).collect(),
    }
}

/// The pressure of a few periods with the times in which the coil was energised, and the onsets.
fn onset_plate(run: &Run<'_>, stem: &'static str) -> Plate {
    let edges = run.train.edges();
    let begin = edges.first().map_or(run.times[0], |edge| edge.0);
    let period = run.train.frequency_and_duty().map_or(f64::INFINITY, |[frequency, _]| 1.0 / frequency);
    let (from, to) = (begin - 0.5 * period, begin + SHOWN * period);
    let shown = |time: f64| (from..=to).contains(&time);
    let last = run.times[run.times.len() - 1];
    let ends = edges.iter().skip(1).map(|edge| edge.0).chain([last]);
    let energised = edges.iter().zip(ends).filter(|(edge, _)| edge.1 && shown(edge.0));
    let spans: Vec<(f64, f64)> = energised.map(|(edge, end)| (edge.0, end.min(to).min(last))).collect();
    let (times, pressures): (Vec<f64>, Vec<f64>) =
        run.times.iter().zip(&run.pressures).filter(|(time, _)| shown(**time)).map(|(t, p)| (*t, *p)).unzip();
    let onsets = |energised: bool| {
        run.found.onsets.iter().filter(move |onset| onset.energised == energised && shown(onset.time))
    };
    let at = |onset: &Onset| (onset.time, pressure_at(run, onset.time));
    let mut panel = Panel::new(Axis::new(run.quantity.words(), "Pa"))
        .legend(Legend::Above)
        .height_mm(55.0)
        .span(Span::intervals("coil energised", spans))
        .series(Series::dots("measured", times, pressures).colour(Colour::Category(1)));
    for (label, energised) in [("opens", true), ("closes", false)] {
        let (x, y) = onsets(energised).map(at).unzip();
        panel = panel.marks(symbols::valve(energised, label, x, y));
    }
    let mut data = Data::new(&["edge_s", "energised", "onset_s", "deviation_s"]);
    data.rows = run
        .found
        .onsets
        .iter()
        .map(|onset| vec![onset.edge, f64::from(u8::from(onset.energised)), onset.time, onset.deviation])
        .collect();
    let caption = format!("`{}`: the first pulses, and when the pressure begins to change.", run.name);
    let figure = Figure { width_mm: 150.0, x: Axis::new("time", "s"), panels: vec![panel], ..Figure::default() };
    Plate { stem, caption, figure, data }
}

/// The pressure on the straight line between the two samples about a time.
fn pressure_at(run: &Run<'_>, time: f64) -> f64 {
    let after = run.times.partition_point(|at| *at < time).clamp(1, run.times.len() - 1);
    let part = (time - run.times[after - 1]) / (run.times[after] - run.times[after - 1]);
    run.pressures[after - 1] + part * (run.pressures[after] - run.pressures[after - 1])
}

/// Duty against effective duty: over the frequency, or over the commanded duty where that was varied.
fn duty_plate(points: &[DutyPoint], delays: &[Estimate; 2]) -> Option<Plate> {
    let differ = |of: fn(&DutyPoint) -> f64| points.windows(2).any(|pair| (of(&pair[0]) - of(&pair[1])).abs() > 1e-3);
    let by_duty = differ(|point| point.commanded);
    if points.len() < 2 {
        return None;
    }
    let difference = delays[0].value - delays[1].value;
    let predicted = |point: &DutyPoint| point.commanded - difference * point.frequency;
    let over = |point: &DutyPoint| if by_duty { point.commanded } else { point.frequency };
    let x: Vec<f64> = points.iter().map(over).collect();
    let effective = points.iter().map(|point| point.effective).collect();
    let mut data = Data::new(&["frequency_hz", "commanded_duty", "effective_duty", "by_the_delays"]);
    data.rows =
        points.iter().map(|point| vec![point.frequency, point.commanded, point.effective, predicted(point)]).collect();
    let mut sorted: Vec<&DutyPoint> = points.iter().collect();
    sorted.sort_by(|a, b| over(a).total_cmp(&over(b)));
    let line = |of: &dyn Fn(&DutyPoint) -> f64| -> (Vec<f64>, Vec<f64>) {
        sorted.iter().map(|point| (over(point), of(point))).unzip()
    };
    let (commanded, by_delays) = (line(&|point| point.commanded), line(&predicted));
    let axis = if by_duty { Axis::new("commanded duty", "") } else { Axis::new("frequency", "Hz") };
    let panel = Panel::new(Axis::new("duty", ""))
        .legend(Legend::Above)
        .height_mm(55.0)
        .series(Series::line("commanded", commanded.0, commanded.1).colour(Colour::Category(2)))
        .series(Series::line("commanded, less the delays", by_delays.0, by_delays.1))
        .series(Series::points("effective, by the onsets", x, effective).colour(Colour::Category(1)));
    Some(Plate {
        stem: DUTY,
        caption: "Commanded and effective duty: d − (t_open − t_close) f by the delays, and the share of a period in which the valve was \
                  open by the onsets."
            .to_owned(),
        figure: Figure { width_mm: 130.0, x: axis, panels: vec![panel], ..Figure::default() },
        data,
    })
}
