//! A tank that is charged or discharged: C and b of the valve, or the volume.

use super::super::outcome::{self, Outcome, WARNED, file};
use super::super::{Material, pressure_over_time, values};
use super::steady::curve_plate;
use super::{Stems, actuator_of, at_its_end, conductance, failed, law_of, named, passage_of};
use super::{put, says_its_end, told, valve_of, with_conductance};
use crate::failure::Failure;
use crate::plot::{Axis, Colour, Figure, Legend, Panel, Series};
use crate::quantities::quantity;
use crate::report::{Data, Plate, Section, Table};
use mckibben::valve::{REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use mckibben::{AbsolutePressure, parameter};
use mckibben_identify::least_squares::Estimate;
use mckibben_identify::study::clean::{STUCK, longest_at_the_end};
use mckibben_identify::study::{Direction, Quantity, Recording, TankEntry, TankTarget};
use mckibben_identify::valve::{FlowCurve, Scatter, Sought, SteadyPoint, Tank, TankFit, TankRecord, Transfer};
use mckibben_scenario::{ExhaustTemperature, Process, Scenario};

/// Largest pressure ratio of a window: nearer to equal pressures the flow falls too fast for its cubic.
const LARGEST_RATIO: f64 = 0.9;
/// Deviations of a reading by which a trajectory may be off before it is told.
const MISFIT: f64 = 1.5;

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

/// What a run comes to.
struct Found {
    scenario: Scenario,
    numbers: Vec<Estimate>,
    words: String,
    plates: Vec<Plate>,
}

/// C and b, or the volume, of every run.
pub(in super::super) fn tank(material: &Material) -> Result<Outcome, Failure> {
    let Some(entry) = &material.study.tank else {
        return Err(Failure::input("the study does not say what tank it is", "add `[tank]`"));
    };
    let mut warnings = material.notes();
    let (mut introduction, mut plates, mut scenarios) = (Vec::new(), Vec::new(), Vec::new());
    let mut numbers = values::of("Numbers with their 95 % intervals".to_owned(), &[]);
    let several = material.recordings.len() > 1;
    if several {
        numbers.head.insert(0, "run".to_owned());
    }
    let pressures: Stems = ["tank-1", "tank-2", "tank-3", "tank-4", "tank-5", "tank-6"];
    let curves: Stems =
        ["flow-curve-1", "flow-curve-2", "flow-curve-3", "flow-curve-4", "flow-curve-5", "flow-curve-6"];
    for (place, recording) in material.recordings.iter().enumerate() {
        let stems = pressures.get(place).zip(curves.get(place)).map(|(pressure, curve)| [*pressure, *curve]);
        let experiment = experiment(material, recording, entry, &mut warnings)?;
        let found = match entry.windows {
            Some(windows) => by_windows(&experiment, windows, stems, &mut warnings)?,
            None => by_trajectory(&experiment, stems, &mut warnings)?,
        };
        introduction.push(format!("`{}`: {}", recording.name, found.words));
        numbers.rows.extend(found.numbers.iter().map(|estimate| {
            let of_run = several.then(|| recording.name.clone());
            of_run.into_iter().chain(values::row(estimate)).collect()
        }));
        plates.extend(found.plates);
        let name = if several { format!("scenario-{}.toml", recording.name) } else { "scenario.toml".to_owned() };
        scenarios.push((name, file(&found.scenario)));
    }
    let sections = vec![
        outcome::numbers(vec![numbers.clone()], &scenarios),
        Section { id: "tank", label: "Tank", title: "Measured and fitted", plates, ..Section::default() },
    ];
    Ok(Outcome {
        title: format!("Tank of {}", material.document.source().name()),
        introduction,
        sections,
        table: Table::default(),
        values: numbers,
        warnings,
        scenarios,
    })
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
    let record = TankRecord::new(times.clone(), pressures.clone()).map_err(|error| failed(run, &error))?;
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
                "the {words} falls to {} absolute, but the surroundings to which it is discharged have {}",
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
                "{WARNED}`{run}`: the tank begins at {} absolute, below the surroundings’ {}: it was evacuated, or {wrong_kind}.",
                quantity(first, "Pa"),
                quantity(atmosphere, "Pa")
            ));
            Ok(())
        }
        _ => Ok(()),
    }
}

/// C and b from the slopes of windows, in an isothermal tank.
fn by_windows(
    of: &Experiment<'_>,
    windows: usize,
    stems: Option<[&'static str; 2]>,
    warnings: &mut Vec<String>,
) -> Result<Found, Failure> {
    if of.scenario.air.process != Process::Isothermal {
        let title = "`tank.windows` is of an isothermal tank, which `air.process` of the scenario is not";
        let help =
            "say `process = \"isothermal\"` in `[air]` of a tank stuffed with metal wool, or leave `windows` out";
        return Err(Failure::input(title, help));
    }
    let wrong = |error| failed(of.run, &error);
    let points = of.tank.isothermal_flow(&of.record, windows).map_err(wrong)?;
    let points: Vec<SteadyPoint> = points.into_iter().filter(|point| point.ratio() < LARGEST_RATIO).collect();
    let found = FlowCurve::fit(&points, &of.tank.air, Scatter::Constant).map_err(wrong)?;
    let both = [&found.sonic_conductance, &found.critical_ratio];
    let (scenario, numbers) = with_conductance(&of.scenario, of.entry.transfer, both, false, warnings)?;
    let words = format!(
        "C = {} and b = {} from the slopes of {} windows with a pressure ratio below {LARGEST_RATIO}, as of an isothermal tank.",
        conductance(&found.sonic_conductance),
        told(&found.critical_ratio, 1.0, ""),
        points.len()
    );
    let plates = match stems {
        Some([pressure, curve]) => {
            vec![pressure_plate(of, None, pressure), curve_plate(&points, &found, &of.tank.air, curve)?]
        }
        None => Vec::new(),
    };
    Ok(Found { scenario, numbers, words, plates })
}

/// The valve or the volume from the whole trajectory.
fn by_trajectory(
    of: &Experiment<'_>,
    stems: Option<[&'static str; 2]>,
    warnings: &mut Vec<String>,
) -> Result<Found, Failure> {
    let found = of.tank.fit(&of.record, sought(of)?, of.entry.heat).map_err(|error| failed(of.run, &error))?;
    if found.fit.scatter > MISFIT {
        warnings.push(format!(
            "{WARNED}`{}`: the trajectory is {} off (root mean square), {:.1} times the noise of the readings: check `air.process`, \
             `begins`, and the temperature. The intervals do not know of it.",
            of.run,
            quantity(found.scatter, "Pa"),
            found.fit.scatter
        ));
    }
    warnings.extend(values::warnings(&found.fit));
    let (mut scenario, mut numbers, mut words) = match (&found.sonic_conductance, &found.critical_ratio, &found.volume)
    {
        (Some(c), Some(b), _) => {
            let (scenario, numbers) = with_conductance(&of.scenario, of.entry.transfer, [c, b], false, warnings)?;
            (scenario, numbers, format!("C = {} and b = {}", conductance(c), told(b, 1.0, "")))
        }
        (_, _, Some(volume)) => with_volume(of, volume)?,
        _ => return Err(Failure::stopped("nothing was found")),
    };
    if let Some(heat) = &found.heat_transfer {
        put(&mut scenario, &[(&parameter::HEAT_TRANSFER, heat.value)])?;
        words.push_str(&format!(", h A = {}", told(heat, 1.0, "W/K")));
        numbers.push(named(heat, &parameter::HEAT_TRANSFER));
    }
    words.push_str(&format!(
        ", from {} readings that scatter by {} about the trajectory.",
        of.times.len(),
        quantity(found.scatter, "Pa")
    ));
    let plates = stems.map(|[pressure, _]| pressure_plate(of, Some(&found), pressure)).into_iter().collect();
    Ok(Found { scenario, numbers, words, plates })
}

/// What is unknown; guesses of C and b are those of the scenario's passage.
fn sought(of: &Experiment<'_>) -> Result<Sought, Failure> {
    let valve = valve_of(&of.scenario)?;
    let passage = passage_of(valve, of.entry.transfer);
    if of.entry.find == TankTarget::Volume {
        return Ok(Sought::Volume { standard: passage.standard(), efficiency: valve.efficiency });
    }
    let law = law_of(passage, valve.efficiency, valve, &actuator_of(&of.scenario)?)?;
    Ok(Sought::Valve {
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
    let words = format!("a volume of {}", told(volume, 1e6, "cm³"));
    let (braid, words) = match of.entry.length {
        None => (0.0, words),
        Some(length) => {
            let braid = actuator_of(&scenario)?.volume(length) - scenario.actuator.external_volume;
            (braid, format!("{words}, of which the actuator has {}", told_volume(braid)))
        }
    };
    let external = volume.value - braid;
    if external <= 0.0 {
        let title = format!("the run `{}`: {words} at that length; nothing is left for hose and fittings", of.run);
        return Err(Failure::input(title, "check `tank.length`, and `thread_length` and `turns` in the scenario"));
    }
    put(&mut scenario, &[(&parameter::EXTERNAL_VOLUME, external)])?;
    let interval = volume.interval.map(|ends| ends.map(|end| end - braid));
    let number = Estimate { value: external, interval, ..named(volume, &parameter::EXTERNAL_VOLUME) };
    Ok((scenario, vec![number], words))
}

fn told_volume(volume: f64) -> String {
    format!("{:.3} cm³", 1e6 * volume)
}

/// Pressure over time, measured and fitted.
fn pressure_plate(of: &Experiment<'_>, found: Option<&TankFit>, stem: &'static str) -> Plate {
    let measured = Series::dots("measured", of.times.clone(), of.pressures.clone()).colour(Colour::Category(1));
    let mut top =
        Panel::new(Axis::new("absolute pressure", "Pa")).legend(Legend::Above).height_mm(55.0).series(measured);
    let mut panels = Vec::new();
    let mut data = Data::new(&["time_s", "measured_pa", "fitted_pa"]);
    let mut caption = format!("`{}`: the pressure in the tank", of.run);
    let off: Vec<f64> = match found {
        Some(found) => {
            let noise = found.scatter / found.fit.scatter.max(f64::MIN_POSITIVE);
            found.fit.residuals.iter().map(|residual| residual * noise).collect()
        }
        None => vec![f64::NAN; of.times.len()],
    };
    let fitted: Vec<f64> = of.pressures.iter().zip(&off).map(|(pressure, off)| pressure + off).collect();
    data.rows = (0..of.times.len()).map(|row| vec![of.times[row], of.pressures[row], fitted[row]]).collect();
    if found.is_some() {
        top = top.series(Series::line("fitted", of.times.clone(), fitted));
        panels.push(outcome::off("off", "Pa", Series::dots("", of.times.clone(), off)));
        caption.push_str(", measured and fitted, and the one less the other");
    }
    panels.insert(0, top);
    let figure = Figure { width_mm: 130.0, x: Axis::new("time", "s"), panels, ..Figure::default() };
    Plate { stem, caption: format!("{caption}."), figure, data }
}
