//! A valve from measurements: what the kinds of study have in common.
//!
//! | file | its idea |
//! |---|---|
//! | `steady` | C and b, efficiency or flow coefficient, from steady flow |
//! | `tank` | C and b, or a volume, from the pressure in a tank |
//! | `pulses` | delays from the pressure under a pulse train |

mod pulses;
mod steady;
mod tank;

pub(super) use pulses::pulse_train;
pub(super) use steady::{flow_curve, steady_flow};
pub(super) use tank::tank;

use super::outcome::{Stems, WARNED};
use super::values::with_interval;
use super::{Material, column, remedied};
use crate::failure::Failure;
use crate::quantities::digits;
use mckibben::Actuator;
use mckibben::parameter::{self, Parameter};
use mckibben::valve::FlowLaw;
use mckibben_identify::least_squares::Estimate;
use mckibben_identify::study::{Direction, Quantity, Recording};
use mckibben_identify::valve::ValveError;
use mckibben_scenario::{FlowPath, Place, Scenario, Valve};

/// What the figures of all studies of a valve are called.
pub(super) const STEMS: [&[&str]; 4] = [&pulses::STEMS, &[pulses::DUTY], &tank::PRESSURES, &steady::STEMS];

fn valve_of(scenario: &Scenario) -> Result<&Valve, Failure> {
    scenario.valve.as_ref().ok_or_else(|| {
        Failure::input(
            "the scenario has no valve",
            "add `[valve]`, `[supply]` and `[command]` as far as they are known",
        )
    })
}

/// The actuator with its air, whatever drives it.
fn actuator_of(scenario: &Scenario) -> Result<Actuator, Failure> {
    let bare = Scenario { valve: None, supply: None, command: None, hose: None, ..scenario.clone() };
    Ok(bare.driven().map_err(|error| Failure::input(error.to_string(), "mend the scenario"))?.actuator)
}

/// The flow path that the air takes.
fn flow_path_of(valve: &Valve, direction: Direction) -> FlowPath {
    match direction {
        Direction::Supply => valve.flow_path,
        Direction::Exhaust => valve.exhaust.unwrap_or(valve.flow_path),
    }
}

fn law_of(flow_path: FlowPath, efficiency: f64, valve: &Valve, actuator: &Actuator) -> Result<FlowLaw, Failure> {
    FlowLaw::new(flow_path.standard(), efficiency, valve.laminar_ratio, actuator.air())
        .map_err(|error| Failure::input(error.to_string(), "mend `[valve]` of the scenario"))
}

/// What to do where a study of a valve has no result and its error does not say more.
const MEND: &str = "look at the units in [columns], and at valve, supply and air in the scenario";

/// Why nothing can be estimated from a run.
fn failed(run: &str, error: &ValveError) -> Failure {
    let title = format!("the run `{run}`: {error}");
    match error {
        ValveError::Fit(_) => Failure::stopped(title),
        _ => remedied(&title, MEND),
    }
}

/// Absolute pressures in Pa from whichever was measured, and what they were measured as.
fn absolute_pressures(
    recording: &Recording,
    [gauge, absolute]: [Quantity; 2],
    atmosphere: f64,
) -> Result<(Vec<f64>, Quantity), Failure> {
    match recording.column(gauge) {
        Some(measured) => Ok((measured.values.iter().map(|pressure| pressure + atmosphere).collect(), gauge)),
        None => Ok((column(recording, absolute)?.values.clone(), absolute)),
    }
}

/// An estimate under the path of the number that it is of.
fn named(estimate: &Estimate, row: &Parameter) -> Estimate {
    Estimate { name: row.key.to_owned(), unit: row.unit, ..estimate.clone() }
}

/// Sets numbers of a scenario by their paths.
fn put(scenario: &mut Scenario, numbers: &[(&Parameter, f64)]) -> Result<(), Failure> {
    for (row, value) in numbers {
        let wrong = |error: String| Failure::stopped(format!("what was found is no `{}`: {error}", row.key));
        let place = Place::find(row.key, scenario).map_err(|error| wrong(error.to_string()))?;
        place.set(scenario, *value).map_err(|error| wrong(error.to_string()))?;
    }
    Ok(())
}

/// The rows of a flow path's size: C and b, and the flow area.
fn rows(direction: Direction, of: &Valve) -> [&'static Parameter; 3] {
    match direction == Direction::Exhaust && of.exhaust.is_some() {
        true => {
            [&parameter::EXHAUST_SONIC_CONDUCTANCE, &parameter::EXHAUST_CRITICAL_RATIO, &parameter::EXHAUST_FLOW_AREA]
        }
        false => [&parameter::SONIC_CONDUCTANCE, &parameter::CRITICAL_RATIO, &parameter::FLOW_AREA],
    }
}

/// The scenario with another flow path, whose flow is the measured one: the efficiency is 1, and the flow path that
/// stays lets through what it did. Where the scenario states one for both ways and `split` is not requested, it is that
/// of both.
fn with_flow_path(
    scenario: &Scenario,
    direction: Direction,
    flow_path: FlowPath,
    split: bool,
    warnings: &mut Vec<String>,
) -> Result<Scenario, Failure> {
    let mut scenario = scenario.clone();
    let Some(valve) = scenario.valve.as_mut() else { return Ok(scenario) };
    let efficiency = valve.efficiency;
    match direction {
        Direction::Exhaust if valve.exhaust.is_some() || split => {
            valve.flow_path = valve.flow_path.scaled(efficiency);
            valve.exhaust = Some(flow_path);
        }
        _ => {
            if valve.exhaust.is_none() {
                warnings
                    .push("the flow path is taken for both ways, as the scenario has no `[valve.exhaust]`.".to_owned());
            }
            valve.flow_path = flow_path;
            valve.exhaust = valve.exhaust.map(|exhaust| exhaust.scaled(efficiency));
        }
    }
    if efficiency != 1.0 {
        warnings.push(format!(
            "`valve.efficiency` was {efficiency} and is 1 now: what was found is of the measured flow. A flow path that was not \
             measured lets through what it did."
        ));
        put(&mut scenario, &[(&parameter::EFFICIENCY, 1.0)])?;
    }
    Ok(scenario)
}

/// The scenario with the efficiency by which the flow of a path was measured: the size of the other path makes up for it, so that it
/// lets through what it did. An exhaust that was measured has its own section then.
fn with_efficiency(
    scenario: &Scenario,
    direction: Direction,
    efficiency: f64,
    warnings: &mut Vec<String>,
) -> Result<Scenario, Failure> {
    let mut scenario = scenario.clone();
    let Some(valve) = scenario.valve.as_mut() else { return Ok(scenario) };
    let kept = valve.efficiency / efficiency;
    let of_both = direction == Direction::Supply && valve.exhaust.is_none();
    match direction {
        Direction::Supply => valve.exhaust = valve.exhaust.map(|exhaust| exhaust.scaled(kept)),
        Direction::Exhaust => {
            valve.exhaust = Some(flow_path_of(valve, direction));
            valve.flow_path = valve.flow_path.scaled(kept);
        }
    }
    warnings.push(match of_both {
        true => "the efficiency is taken for both ways, as the scenario has no `[valve.exhaust]`.".to_owned(),
        false => format!(
            "`valve.efficiency` multiplies the flow of both flow paths, and was {}: the size of the path that was not measured is {} \
             times what it was, so that it lets through what it did.",
            digits(valve.efficiency),
            digits(kept)
        ),
    });
    put(&mut scenario, &[(&parameter::EFFICIENCY, efficiency)])?;
    Ok(scenario)
}

/// The scenario with C and b of a flow path, and these under their paths. A b below zero is that of a flow path with a
/// b near zero.
fn with_conductance(
    scenario: &Scenario,
    direction: Direction,
    [conductance, ratio]: [&Estimate; 2],
    split: bool,
    warnings: &mut Vec<String>,
) -> Result<(Scenario, Vec<Estimate>), Failure> {
    if ratio.value < 0.0 {
        let b = with_interval(ratio);
        warnings.push(format!("{WARNED}b comes out as {b}; the scenario has 0, the least that a flow path has."));
    }
    let [sonic_conductance, critical_ratio] = [conductance.value, ratio.value.max(0.0)];
    let flow_path = FlowPath::Iso6358 { sonic_conductance, critical_ratio };
    let mut scenario = with_flow_path(scenario, direction, flow_path, split, warnings)?;
    let [of_conductance, of_ratio, _] = rows(direction, valve_of(&scenario)?);
    put(&mut scenario, &[(of_conductance, sonic_conductance), (of_ratio, critical_ratio)])?;
    Ok((scenario, vec![named(conductance, of_conductance), named(ratio, of_ratio)]))
}

/// Whether the study says of a quantity where its sensor ends: the rest is then intended.
fn says_its_end(material: &Material, quantity: Quantity) -> bool {
    material.study.columns.iter().any(|entry| entry.quantity == quantity && entry.rules.saturates.is_some())
}

/// The refusal of a sensor at its end.
fn at_its_end(run: &str, words: &str, (count, largest): (usize, f64), why: &str) -> Failure {
    Failure::input(
        format!(
            "the run `{run}`: the {words} reads {largest} Pa, its largest value, {count} times on end, {why}: the sensor is at its end"
        ),
        format!(
            "say `saturates = \"{largest} Pa\"` in its column to leave these readings out, or a larger value to keep them"
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// C times the efficiency of either path, before and after the exhaust, or the supply, was measured to have seven tenths of it.
    #[test]
    fn a_measured_efficiency_leaves_the_other_flow_path_as_it_was() {
        let rig = |more: &str| {
            let text = format!(
                "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"three-way\"\nsonic_conductance = \"0.6 L/(s*bar)\"\n\
                 critical_ratio = 0.32\nefficiency = 0.9\n{more}[command]\nkind = \"fill\"\n[load]\nkind = \"isometric\"\n[initial]\n\
                 gauge_pressure = \"0 bar\"\nlength = \"90 mm\"\n[run]\nduration = \"1 s\"\n"
            );
            Scenario::from_str(&text, "rig.toml").expect("a scenario")
        };
        let flows = |scenario: &Scenario| {
            let valve = scenario.valve.as_ref().expect("a valve");
            let conductance = |flow_path: FlowPath| match flow_path {
                FlowPath::Iso6358 { sonic_conductance, .. } => 1e9 * valve.efficiency * sonic_conductance,
                _ => panic!("C"),
            };
            [valve.flow_path, valve.exhaust.unwrap_or(valve.flow_path)].map(conductance)
        };
        let own = "[valve.exhaust]\nsonic_conductance = \"0.4 L/(s*bar)\"\ncritical_ratio = 0.3\n";
        for (more, direction, expected) in [
            ("", Direction::Exhaust, [5.4, 4.2]),
            (own, Direction::Exhaust, [5.4, 2.8]),
            (own, Direction::Supply, [4.2, 3.6]),
            ("", Direction::Supply, [4.2, 4.2]),
        ] {
            let found = with_efficiency(&rig(more), direction, 0.7, &mut Vec::new()).expect("a scenario");
            for (flow, expected) in flows(&found).into_iter().zip(expected) {
                assert!((flow - expected).abs() < 1e-12, "{more}{direction:?}: {flow}, not {expected}");
            }
            assert_eq!(found.valve.expect("a valve").exhaust.is_some(), expected[0] != expected[1]);
        }
    }
}
