//! A tank that is charged or discharged: C and b of the valve, or the volume.

use super::super::outcome::{self, Outcome, WARNED};
use super::super::prediction::Prediction;
use super::super::{Material, pressure_over_time, values};
use super::steady::{CURVE, curve_plate};
use super::{Stems, actuator_of, at_its_end, failed, flow_path_of, law_of, named};
use super::{put, says_its_end, valve_of, with_conductance, with_interval};
use crate::failure::Failure;
use crate::quantities::{counted, digits, plain, quantity};
use crate::report::{Data, Plate, Section, Table};
use mckibben::valve::{REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use mckibben::{AbsolutePressure, parameter};
use mckibben_identify::least_squares::Estimate;
use mckibben_identify::study::clean::{STUCK, longest_at_the_end};
use mckibben_identify::study::{ColumnEntry, Direction, Quantity, Recording, TankEntry, TankTarget};
use mckibben_identify::valve::{
    FlowCurve, Scatter, SteadyPoint, Tank, TankFit, TankRecord, TankUnknown, Transfer, ValveError,
};
use mckibben_plot::{Axis, Colour, Figure, Legend, Panel, Series};
use mckibben_scenario::{ExhaustTemperature, Process, Scenario};

/// Largest pressure ratio of a window: nearer to equal pressures the flow falls too fast for its cubic.
const LARGEST_RATIO: f64 = 0.9;
/// Standard deviations of a reading by which a trajectory may be off before it is reported.
const MISFIT: f64 = 1.5;
/// Part of the record's time by which the first reading may come later than the valve opens before it is reported.
const GAP: f64 = 0.1;
/// An absolute pressure in Pa that no tank has.
const VACUUM: f64 = 1e3;

/// The files of the runs' pressures; a page has no more.
pub(super) const PRESSURES: Stems = ["tank-1", "tank-2", "tank-3", "tank-4", "tank-5", "tank-6"];

/// A run, and the tank that it is of.
struct Experiment<'a> {
    run: &'a str,
    scenario: Scenario,
    entry: &'a TankEntry,
    tank: Tank,
    /// Times in s and absolute pressures in Pa from the valve's opening on.
    times: Vec<f64>,
    pressures: Vec<f64>,
    record: TankRecord,
}

/// What the runs come to together.
struct Found {
    /// Of each run.
    scenarios: Vec<Scenario>,
    numbers: Vec<Estimate>,
    words: String,
    plates: Vec<Plate>,
    /// Of each run that was simulated.
    predictions: Vec<Prediction>,
    /// Residual of each run.
    left: Table,
}

/// C and b, or the volume, common to all runs.
pub(in super::super) fn tank(material: &Material) -> Result<Outcome, Failure> {
    let Some(entry) = &material.study.tank else {
        return Err(Failure::input("the study does not say what tank it is", "add `[tank]`"));
    };
    let mut warnings = material.notes();
    let (runs, failed) = outcome::of_each(material.recordings.iter(), &mut warnings, |recording, warnings| {
        experiment(material, recording, entry, warnings)
    })?;
    let found = match entry.windows {
        Some(windows) => by_windows(&runs, windows, &mut warnings)?,
        None => by_trajectory(&runs, &mut warnings)?,
    };
    let numbers = values::of("Numbers with their 95 % intervals".to_owned(), &found.numbers);
    let scenarios = outcome::files(runs.iter().map(|run| run.run).zip(found.scenarios.iter().map(Scenario::to_toml)));
    let left = if runs.len() > 1 { found.left } else { Table::default() };
    let tables = [&numbers, &left].into_iter().filter(|table| !table.head.is_empty()).cloned().collect();
    let sections = vec![
        outcome::numbers(tables, &scenarios),
        Section { id: "tank", label: "Tank", title: "Measured and fitted", plates: found.plates, ..Section::default() },
    ];
    Ok(Outcome {
        title: format!("Tank of {}", material.name()),
        introduction: vec![found.words],
        sections,
        table: left,
        values: numbers,
        estimates: found.numbers,
        predictions: found.predictions,
        warnings,
        scenarios,
        failed,
        ..Outcome::default()
    })
}

/// The column of the study that a quantity was read from.
fn of_column(material: &Material, quantity: Quantity) -> Option<&ColumnEntry> {
    material.study.columns.iter().find(|entry| entry.quantity == quantity)
}

fn experiment<'a>(
    material: &Material,
    recording: &'a Recording,
    entry: &'a TankEntry,
    warnings: &mut Vec<String>,
) -> Result<Experiment<'a>, Failure> {
    let run = recording.name.as_str();
    let mut scenario = as_stated(material.document_of(recording)?.scenario()?, entry);
    valve_of(&scenario)?;
    if let Some(valve) =
        scenario.valve.as_mut().filter(|valve| valve.exhaust_temperature != ExhaustTemperature::Actuator)
    {
        valve.exhaust_temperature = ExhaustTemperature::Actuator;
        warnings.push(format!(
            "{WARNED}`{run}`: air leaves the tank at its own temperature; `valve.exhaust_temperature` of the scenario is \"actuator\" now."
        ));
    }
    let atmosphere = scenario.air.atmospheric_pressure;
    let air = *actuator_of(&scenario)?.air();
    let transfer = match entry.transfer {
        Direction::Exhaust => Transfer::Discharge,
        Direction::Supply => {
            let Some(supply) = &scenario.supply else {
                return Err(Failure::input("the scenario has no supply", "add `[supply]` with its gauge pressure"));
            };
            if supply.reservoir.is_some() || supply.regulator.is_some() {
                let title = "the scenario’s supply changes as air is drawn from it";
                return Err(Failure::input(
                    title,
                    "measure behind a supply that holds its pressure, or fit `trajectories`",
                ));
            }
            Transfer::Charge {
                supply: AbsolutePressure(supply.gauge_pressure + atmosphere),
                temperature: supply.temperature,
            }
        }
    };
    let (measured, times, values) = pressure_over_time(recording)?;
    let shift = if measured == Quantity::GaugePressure { atmosphere } else { 0.0 };
    let [from, to] = [entry.begins.unwrap_or(f64::NEG_INFINITY), entry.ends.unwrap_or(f64::INFINITY)];
    let counts = |(time, _): &(f64, f64)| (from..=to).contains(time);
    let (times, pressures): (Vec<f64>, Vec<f64>) =
        times.into_iter().zip(values).filter(counts).map(|(time, value)| (time, value + shift)).unzip();
    let least = pressures.iter().copied().fold(f64::INFINITY, f64::min);
    if let Some(column) =
        of_column(material, measured).filter(|_| measured == Quantity::AbsolutePressure && least < VACUUM)
    {
        let title = format!(
            "the run `{run}`: the column `{}` with the absolute pressure reads {} {}, which is below the pressure of any atmosphere",
            column.name,
            plain(&digits((least - column.zero) / column.scale)),
            column.unit
        );
        let help = "if it is a gauge pressure, name it `[columns.gauge_pressure]`; else correct `unit` in [columns.absolute_pressure]";
        return Err(Failure::input(title, help));
    }
    let record = TankRecord::new(times.clone(), pressures.clone()).map_err(|error| failed(run, &error))?;
    let record = match entry.begins {
        Some(begins) => record.opened_at(begins).map_err(|error| failed(run, &error))?,
        None => record,
    };
    if let Some(gap) =
        entry.begins.map(|begins| times[0] - begins).filter(|gap| *gap > GAP * (times[times.len() - 1] - times[0]))
    {
        warnings.push(format!(
            "{WARNED}`{run}`: the first reading comes {} after the valve opens (`tank.begins`), and nothing was read of what happens \
             there: check that `begins` is a time of the record.",
            quantity(gap, "s")
        ));
    }
    let silent = !says_its_end(material, measured);
    possible(run, (measured, silent), &pressures, transfer, atmosphere, warnings)?;
    let tank = Tank { volume: entry.volume, temperature: scenario.initial.temperature, air, transfer };
    Ok(Experiment { run, scenario, entry, tank, times, pressures, record })
}

/// The scenario with the temperature that the study states.
fn as_stated(mut scenario: Scenario, entry: &TankEntry) -> Scenario {
    if let Some(stated) = entry.temperature {
        scenario.initial.temperature = stated;
        if let Process::EnergyBalance { wall_temperature, .. } = &mut scenario.air.process {
            *wall_temperature = stated;
        }
    }
    scenario
}

/// Refuses a pressure that no tank has on this way: a sensor at its end where the study is `silent` about that, another kind of
/// pressure, the other way.
fn possible(
    run: &str,
    (measured, silent): (Quantity, bool),
    pressures: &[f64],
    transfer: Transfer,
    atmosphere: f64,
    warnings: &mut Vec<String>,
) -> Result<(), Failure> {
    let words = measured.words();
    let (least, most) =
        pressures.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), value| (least.min(*value), most.max(*value)));
    let (first, last) = (pressures[0], pressures[pressures.len() - 1]);
    let (stuck, largest) = longest_at_the_end(pressures);
    // What the sensor reads: the largest value in the unit of its column.
    let reads = if measured == Quantity::GaugePressure { largest - atmosphere } else { largest };
    let refuse = |what: String, remedy: &str| Err(Failure::input(format!("the run `{run}`: {what}"), remedy));
    let wrong_kind = match measured {
        Quantity::GaugePressure => "check the unit, and `air.atmospheric_pressure` of the scenario",
        _ => "check the unit; if it is a gauge pressure, name its column `gauge_pressure`",
    };
    match transfer {
        Transfer::Discharge if last >= first => refuse(
            "the pressure does not fall, but the study says discharge".to_owned(),
            "say `transfer = \"charge\"`, or mend `begins` and `ends`",
        ),
        Transfer::Discharge if least < 0.9 * atmosphere => refuse(
            format!(
                "the {words} falls to {} absolute, but the atmosphere to which it is discharged has {}",
                quantity(least, "Pa"),
                quantity(atmosphere, "Pa")
            ),
            wrong_kind,
        ),
        Transfer::Discharge if silent && stuck >= STUCK && pressures.len() > 2 * stuck => {
            let why = "while the tank is discharged (or its valve opens later: mend `begins`)";
            Err(at_its_end(run, words, (stuck, reads), why))
        }
        Transfer::Charge { .. } if last <= first => refuse(
            "the pressure does not rise, but the study says charge".to_owned(),
            "say `transfer = \"discharge\"`, or mend `begins` and `ends`",
        ),
        Transfer::Charge { supply, .. } if most > 1.05 * supply.0 => refuse(
            format!(
                "the {words} rises to {} absolute, but the supply that charges it has {}",
                quantity(most, "Pa"),
                quantity(supply.0, "Pa")
            ),
            match measured {
                Quantity::GaugePressure => {
                    "check the unit and `supply.gauge_pressure`; if it is an absolute pressure, name its column `absolute_pressure`"
                }
                _ => "check the unit, and `supply.gauge_pressure` of the scenario, which is a gauge pressure",
            },
        ),
        Transfer::Charge { supply, .. } if silent && stuck >= STUCK && largest < 0.95 * supply.0 => {
            let why = format!("below the supply’s {} absolute", quantity(supply.0, "Pa"));
            Err(at_its_end(run, words, (stuck, reads), &why))
        }
        Transfer::Charge { .. } if first < 0.9 * atmosphere => {
            warnings.push(format!(
                "{WARNED}`{run}`: the tank begins at {} absolute, below the atmosphere’s {}: it was evacuated, or {wrong_kind}.",
                quantity(first, "Pa"),
                quantity(atmosphere, "Pa")
            ));
            Ok(())
        }
        _ => Ok(()),
    }
}

/// Why nothing fits the pressure of a tank, with what bends it as a wrong b does.
fn misfit(names: &str, error: &ValveError) -> Failure {
    let failure = failed(names, error);
    match error {
        ValveError::CriticalRatio { .. } => failure.advised(
            "if the units are right, check `air.process` of the scenario: air that warms or cools in the tank is not \"isothermal\", and in \
             metal wool it is; then `tank.begins`, `tank.ends` and `tank.volume`",
        ),
        _ => failure,
    }
}

/// C and b from the slopes of windows, in isothermal tanks: one flow curve through the points of all runs.
fn by_windows(runs: &[Experiment<'_>], windows: usize, warnings: &mut Vec<String>) -> Result<Found, Failure> {
    let (mut points, mut rows) = (Vec::new(), Vec::new());
    for of in runs {
        if of.scenario.air.process != Process::Isothermal {
            let title = "`tank.windows` is of an isothermal tank, which `air.process` of the scenario is not";
            let help =
                "say `process = \"isothermal\"` in `[air]` of a tank stuffed with metal wool, or leave `windows` out";
            return Err(Failure::input(title, help));
        }
        let own = of.tank.isothermal_flow(&of.record, windows).map_err(|error| failed(of.run, &error))?;
        let own: Vec<SteadyPoint> = own.into_iter().filter(|point| point.ratio() < LARGEST_RATIO).collect();
        rows.push(vec![format!("`{}`", of.run), own.len().to_string()]);
        points.extend(own);
    }
    let (names, air) = (names(runs), runs[0].tank.air);
    let found = FlowCurve::fit(&points, &air, Scatter::Constant).map_err(|error| misfit(&names, &error))?;
    let both = [&found.sonic_conductance, &found.critical_ratio];
    let (scenarios, numbers) = with_both(runs, both, warnings)?;
    let words = format!(
        "C = {} and b = {} from the slopes of {} with a pressure ratio below {LARGEST_RATIO}, as of an isothermal tank.",
        with_interval(&found.sonic_conductance),
        with_interval(&found.critical_ratio),
        counted(points.len() as u64, "window")
    );
    let mut plates: Vec<Plate> = runs.iter().zip(PRESSURES).map(|(of, stem)| pressure_plate(of, None, stem)).collect();
    plates.push(curve_plate(&points, &found, &air, CURVE)?);
    let left = Table {
        caption: "The windows of each run that count.".to_owned(),
        head: ["run", "windows"].map(String::from).to_vec(),
        rows,
    };
    Ok(Found { scenarios, numbers, words, plates, predictions: Vec::new(), left })
}

/// The valve or the volume from the whole trajectories.
fn by_trajectory(runs: &[Experiment<'_>], warnings: &mut Vec<String>) -> Result<Found, Failure> {
    let names = names(runs);
    let records: Vec<(Tank, &TankRecord)> = runs.iter().map(|of| (of.tank, &of.record)).collect();
    let found =
        Tank::fit_together(&records, tank_unknown(&runs[0])?, runs[0].entry.heat).map_err(|e| misfit(&names, &e))?;
    for (of, [scatter, noise]) in runs.iter().zip(&found.of_records).filter(|(_, [left, noise])| *left > MISFIT * noise)
    {
        warnings.push(format!(
            "{WARNED}`{}`: the trajectory is {} off (root mean square), {:.1} times the noise of the readings: check `air.process`, \
             `begins`, and the temperature. The intervals do not know of it.",
            of.run,
            quantity(*scatter, "Pa"),
            scatter / noise
        ));
    }
    warnings.extend(values::warnings(&found.fit, &[]));
    let (mut scenarios, mut numbers, mut words) = match (&found.sonic_conductance, &found.critical_ratio, &found.volume)
    {
        (Some(c), Some(b), _) => {
            let (scenarios, numbers) = with_both(runs, [c, b], warnings)?;
            let words = match found.all_choked {
                true => format!("C = {} and b of {} or more", with_interval(c), digits(b.value)),
                false => format!("C = {} and b = {}", with_interval(c), with_interval(b)),
            };
            (scenarios, numbers, words)
        }
        (_, _, Some(volume)) => with_volumes(runs, volume)?,
        _ => return Err(Failure::stopped("nothing was found")),
    };
    if let Some(heat) = &found.heat_transfer {
        for scenario in &mut scenarios {
            put(scenario, &[(&parameter::HEAT_TRANSFER, heat.value)])?;
        }
        words.push_str(&format!(", h A = {}", with_interval(heat)));
        numbers.push(named(heat, &parameter::HEAT_TRANSFER));
    }
    words.push_str(&format!(
        ", from {}{} with a scatter of {} about the trajectory.",
        counted(runs.iter().map(|of| of.times.len() as u64).sum(), "reading"),
        if runs.len() > 1 { format!(" of {} runs together", runs.len()) } else { String::new() },
        quantity(found.scatter, "Pa")
    ));
    let predictions = runs.iter().enumerate().map(|(run, of)| Prediction {
        run: of.run.to_owned(),
        quantity: "absolute pressure".to_owned(),
        unit: "Pa",
        coordinates: vec![("time_s", of.times.clone())],
        measured: of.pressures.clone(),
        predicted: of.pressures.iter().zip(off(runs, &found, run)).map(|(pressure, off)| pressure + off).collect(),
    });
    let predictions = predictions.collect();
    let plates = runs.iter().enumerate().zip(PRESSURES);
    let plates = plates.map(|((run, of), stem)| pressure_plate(of, Some(off(runs, &found, run)), stem));
    let row = |(of, [scatter, noise]): (&Experiment<'_>, &[f64; 2])| {
        let [with_interval, of_noise] = [scatter, noise].map(|pressure| quantity(*pressure, "Pa"));
        vec![format!("`{}`", of.run), of.times.len().to_string(), with_interval, of_noise]
    };
    let left = Table {
        caption:
            "Residual of each run about its trajectory, and the noise of its readings, estimated from their neighbours."
                .to_owned(),
        head: ["run", "readings", "left", "noise"].map(String::from).to_vec(),
        rows: runs.iter().zip(&found.of_records).map(row).collect(),
    };
    let plates = plates.collect();
    Ok(Found { scenarios, numbers, words, plates, predictions, left })
}

/// The names of the runs, as a mistake names what it is of.
fn names(runs: &[Experiment<'_>]) -> String {
    runs.iter().map(|of| of.run).collect::<Vec<_>>().join("`, `")
}

/// Simulated less measured pressure in Pa of one of the runs.
fn off(runs: &[Experiment<'_>], found: &TankFit, run: usize) -> Vec<f64> {
    let before: usize = runs[..run].iter().map(|of| of.times.len()).sum();
    let own = &found.fit.residuals[before..][..runs[run].times.len()];
    own.iter().map(|residual| residual * found.of_records[run][1]).collect()
}

/// The scenario of each run with C and b; its warnings are given once.
fn with_both(
    runs: &[Experiment<'_>],
    both: [&Estimate; 2],
    warnings: &mut Vec<String>,
) -> Result<(Vec<Scenario>, Vec<Estimate>), Failure> {
    let (mut scenarios, mut numbers) = (Vec::new(), Vec::new());
    for of in runs {
        let mut with_interval = Vec::new();
        let (scenario, named) = with_conductance(&of.scenario, of.entry.transfer, both, false, &mut with_interval)?;
        scenarios.push(scenario);
        numbers = named;
        with_interval.retain(|warning| !warnings.contains(warning));
        warnings.extend(with_interval);
    }
    Ok((scenarios, numbers))
}

/// The scenario of each run with the external volume.
fn with_volumes(runs: &[Experiment<'_>], volume: &Estimate) -> Result<(Vec<Scenario>, Vec<Estimate>, String), Failure> {
    let mut all = (Vec::new(), Vec::new(), String::new());
    for of in runs {
        let (scenario, numbers, words) = with_volume(of, volume)?;
        all.0.push(scenario);
        (all.1, all.2) = (numbers, words);
    }
    Ok(all)
}

/// What is unknown; guesses of C and b are those of the scenario's flow path.
fn tank_unknown(of: &Experiment<'_>) -> Result<TankUnknown, Failure> {
    let valve = valve_of(&of.scenario)?;
    let flow_path = flow_path_of(valve, of.entry.transfer);
    if of.entry.find == TankTarget::Volume {
        return Ok(TankUnknown::Volume { standard: flow_path.standard(), efficiency: valve.efficiency });
    }
    let law = law_of(flow_path, valve.efficiency, valve, &actuator_of(&of.scenario)?)?;
    Ok(TankUnknown::Valve {
        sonic_conductance: law.conductance() / (REFERENCE_DENSITY * REFERENCE_TEMPERATURE.sqrt()),
        critical_ratio: law.critical_ratio().min(0.8),
    })
}

/// The scenario with the external volume that makes up what was found.
fn with_volume(of: &Experiment<'_>, volume: &Estimate) -> Result<(Scenario, Vec<Estimate>, String), Failure> {
    if of.scenario.hose.is_some() {
        let title = "the scenario has a `[hose]`, whose volume is part of the one that was found";
        return Err(Failure::input(title, "leave `[hose]` out, or fit `actuator.external_volume` to `trajectories`"));
    }
    let mut scenario = of.scenario.clone();
    let words = format!("a volume of {}", with_interval(volume));
    let (braid, words) = match of.entry.length {
        None => (0.0, words),
        Some(length) => {
            let braid = actuator_of(&scenario)?.volume(length) - scenario.actuator.external_volume;
            (braid, format!("{words}, of which the actuator has {}", volume_text(braid)))
        }
    };
    let external = volume.value - braid;
    if external <= 0.0 {
        let title = format!("the run `{}`: {words} at that length; nothing is left for hose and fittings", of.run);
        return Err(Failure::input(title, "check `tank.length`, and `thread_length` and `turns` in the scenario"));
    }
    put(&mut scenario, &[(&parameter::EXTERNAL_VOLUME, external)])?;
    let confidence_interval = volume.confidence_interval.map(|ends| ends.map(|end| end - braid));
    let number = Estimate { value: external, confidence_interval, ..named(volume, &parameter::EXTERNAL_VOLUME) };
    Ok((scenario, vec![number], words))
}

fn volume_text(volume: f64) -> String {
    format!("{:.3} cm³", 1e6 * volume)
}

/// Pressure over time, measured and, where it was simulated, fitted.
fn pressure_plate(of: &Experiment<'_>, off: Option<Vec<f64>>, stem: &'static str) -> Plate {
    let measured = Series::dots("measured", of.times.clone(), of.pressures.clone()).colour(Colour::Category(1));
    let mut top =
        Panel::new(Axis::new("absolute pressure", "Pa")).legend(Legend::Above).height_mm(55.0).series(measured);
    let mut panels = Vec::new();
    let mut data = Data::new(&["time_s", "measured_pa", "fitted_pa"]).lacking(&["fitted_pa"]);
    let mut caption = format!("`{}`: the pressure in the tank", of.run);
    let of_fit = off.clone().unwrap_or_else(|| vec![f64::NAN; of.times.len()]);
    let fitted: Vec<f64> = of.pressures.iter().zip(&of_fit).map(|(pressure, off)| pressure + off).collect();
    data.rows = (0..of.times.len()).map(|row| vec![of.times[row], of.pressures[row], fitted[row]]).collect();
    if let Some(off) = off {
        top = top.series(Series::line("fitted", of.times.clone(), fitted));
        panels.push(outcome::off("off", "Pa", Series::dots("", of.times.clone(), off)));
        caption.push_str(", measured and fitted, and the one less the other");
    }
    panels.insert(0, top);
    let figure = Figure { width_mm: 130.0, x: Axis::new("time", "s"), panels, ..Figure::default() };
    Plate { stem, caption: format!("{caption}."), figure, data }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_critical_ratio_that_no_valve_has_may_be_that_of_another_process() {
        let said = misfit("bottle", &ValveError::CriticalRatio { value: -0.4999 }).sentence();
        assert!(said.contains("`bottle`") && said.contains("check `air.process` of the scenario"), "{said}");
        let other = misfit("bottle", &ValveError::TooFewPoints { points: 1, least: 5 }).sentence();
        assert!(!other.contains("air.process"), "{other}");
    }
}
