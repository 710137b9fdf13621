//! The model as files: JSON for programs, a script for MATLAB and Octave.

use super::Model;
use super::joint::JointModel;
use super::plant::{Damping, PlantModel};
use mckibben::linearize::{Controllability, Pole, Signal, StateSpace};
use mckibben::load::Load;
use mckibben::plant::ValveAverage;
use mckibben_scenario::Assumed;
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Version of the JSON's shape; it grows when a name changes its meaning or goes.
const VERSION: u32 = 1;

/// The values at the operating point, each name with its unit at the end.
pub(super) fn point(model: &Model) -> Vec<(&'static str, f64)> {
    let point = &model.linear.point;
    let state = point.state;
    let [less, more] = model.linear.plant.coulomb_bounds(0);
    let mut values = vec![
        ("length_m", state.length),
        ("velocity_m_s", state.velocity),
        ("absolute_pressure_pa", state.pressure.0),
        ("gauge_pressure_pa", point.gauge_pressure().0),
        ("air_mass_kg", state.air_mass),
        ("temperature_k", point.temperature()),
        ("tension_n", point.tension()),
        ("coulomb_bound_n", more),
        ("coulomb_bound_below_n", less),
    ];
    values.extend(point.load_distance().map(|distance| ("load_distance_m", distance)));
    if let Load::HangingMass { mass, .. } | Load::ConstantForce { mass, .. } = point.rig.load() {
        values.push(("load_mass_kg", *mass));
    }
    if let Some(averaged) = model.linear.averaged() {
        values.push(("duty", averaged.duty));
    }
    for (signal, value) in model.linear.inputs() {
        let key = match signal.name.as_str() {
            "set_point" => "set_point_pa",
            "spool_command" => "spool_command",
            // What keeps a pressure against a leak, or a bottle full.
            "mass_flow" if value != 0.0 => "mass_flow_kg_s",
            "reservoir_mass_flow" if value != 0.0 => "reservoir_mass_flow_kg_s",
            _ => continue,
        };
        values.push((key, value));
    }
    values
}

fn kind(model: &Model) -> &'static str {
    match model.linear.averaged() {
        Some(_) => "averaged-pwm",
        None if model.linear.is_driven() => "driven-valve",
        None => "held-valve",
    }
}

/// What every model has, as JSON with what one of its kind adds. A number without a bound is `null`.
fn document(
    (name, kind): (&str, &str),
    point: Vec<(String, f64)>,
    (system, delays, poles, reach): (&StateSpace, &[f64], &[Pole], &[Controllability]),
    assumed: &[Assumed],
    more: &[(&str, Value)],
) -> String {
    let reach = system.inputs.iter().zip(reach);
    let mut inputs = signals(&system.inputs);
    inputs.iter_mut().zip(delays).for_each(|(input, delay)| input["delay_s"] = json!(delay));
    let mut document = json!({
        "format": "mckibben-linear-model",
        "version": VERSION,
        "program": concat!("mckibben ", env!("CARGO_PKG_VERSION")),
        "scenario": name,
        "model": kind,
        "operating_point": point.into_iter().map(|(name, value)| (name, json!(value))).collect::<Map<String, Value>>(),
        "states": signals(&system.states),
        "inputs": inputs,
        "outputs": signals(&system.outputs),
        "A": system.a, "B": system.b, "C": system.c, "D": system.d,
        "poles": poles.iter().map(pole).collect::<Vec<_>>(),
        "controllability": reach.map(|(input, reach)| controllability(&input.name, reach)).collect::<Vec<_>>(),
        "assumed": assumptions(assumed),
    });
    for (key, value) in more {
        document[*key] = value.clone();
    }
    format!("{document:#}\n")
}

/// The model as JSON.
pub(super) fn json(model: &Model) -> String {
    let equivalent = model.oscillation.map(|(amplitude, frequency)| {
        let damping = model.linear.equivalent_damping(amplitude, frequency).ok();
        as_damping(amplitude, frequency, damping)
    });
    let pulses = model.linear.averaged().map(|averaged| {
        let more = [
            (OVER_FASTEST, over_fastest(averaged, &model.poles)),
            ("length_ripple_m", model.linear.ripple("length")),
            ("actuator_pressure_ripple_pa", model.linear.ripple("pressure")),
            ("tension_ripple_n", model.linear.ripple("tension")),
        ];
        pwm("", averaged, &more)
    });
    let more = [
        ("taut", json!(model.linear.point.is_taut())),
        ("coulomb_friction_as_damping", json!(equivalent)),
        ("pwm", json!(pulses)),
    ];
    let parts = (&model.system, &model.delays[..], &model.poles[..], &model.reach[..]);
    document((&model.name, kind(model)), owned(point(model)), parts, &model.assumed, &more)
}

/// Viscous damping in place of Coulomb friction, and the oscillation for which it holds.
fn as_damping(amplitude: f64, frequency: f64, damping: Option<f64>) -> Value {
    json!({ "amplitude_m": amplitude, "angular_frequency_rad_s": frequency, "damping_n_s_m": damping })
}

fn pole(pole: &Pole) -> Value {
    json!({
        "real_1_s": pole.real,
        "imaginary_rad_s": pole.imaginary,
        "natural_frequency_rad_s": pole.natural_frequency(),
        "damping_ratio": pole.damping_ratio(),
        "time_constant_s": pole.time_constant(),
    })
}

fn controllability(input: &str, reach: &Controllability) -> Value {
    json!({
        "input": input,
        "rank": reach.rank,
        "condition": reach.condition,
        "singular_values": reach.singular_values,
    })
}

/// A valve under PWM on average, by its name, which is empty for one actuator; `more` of its validity is what the kind of the model adds.
fn pwm(name: &str, averaged: &ValveAverage, more: &[(&str, Option<f64>)]) -> Value {
    let intervals = averaged.intervals.iter();
    let intervals: Vec<Value> =
        intervals.map(|interval| json!({ "valve": interval.ports.name(), "share": interval.share })).collect();
    let mut validity = json!({
        "duty_from": averaged.duty_range.0,
        "duty_to": averaged.duty_range.1,
        "seats_follow": averaged.follows(),
        "pressure_ripple_pa": averaged.pressure_ripple,
        "pressure_margin_pa": averaged.pressure_margin,
        "ripple_is_small": averaged.ripple_is_small(),
    });
    for (name, number) in more {
        validity[*name] = json!(number);
    }
    // Mean openings: intervals alone do not give them, as a poppet with a stroke is partly open in some of them.
    let [supply, exhaust] = averaged.shares;
    json!({
        "of": name,
        "frequency_hz": averaged.frequency,
        "duty": averaged.duty,
        "supply_share": supply,
        "exhaust_share": exhaust,
        "intervals": intervals,
        "mean_inflow_kg_s": averaged.flow.inward,
        "mean_outflow_kg_s": averaged.flow.outward,
        "validity": validity,
    })
}

/// Key of the ratio of the pulses' frequency to that of the fastest pole.
const OVER_FASTEST: &str = "frequency_over_fastest_pole";

/// The PWM's angular frequency over the natural frequency of the fastest pole.
pub(super) fn over_fastest(averaged: &ValveAverage, poles: &[Pole]) -> Option<f64> {
    let fastest = poles.iter().map(Pole::natural_frequency).fold(0.0, f64::max);
    (fastest > 0.0).then(|| TAU * averaged.frequency / fastest)
}

/// The model of a joint as JSON.
pub(super) fn joint_json(model: &JointModel) -> String {
    let pulsed = |of: &ValveAverage| pwm(model.whose(of.valve), of, &[(OVER_FASTEST, over_fastest(of, &model.poles))]);
    let all = Some(model.linear.averages()).filter(|all| !all.is_empty());
    let pulses = all.map(|all| all.iter().map(pulsed).collect::<Vec<_>>());
    let kind = if model.is_driven() { "joint-averaged-pwm" } else { "joint-held-valves" };
    let parts = (&model.system, &model.delays[..], &model.poles[..], &model.reach[..]);
    document((&model.name, kind), owned(model.point()), parts, &model.assumed, &[("pwm", json!(pulses))])
}

/// The model of a plant as JSON.
pub(super) fn plant_json(model: &PlantModel) -> String {
    let pulses = model.linear.averages.iter().map(|of| pwm(&model.valve(of.valve), of, &[]));
    let dampings = model.dampings().map(|all| {
        let of = |Damping { of, amplitude, frequency, damping }: Damping<'_>| {
            let mut value = as_damping(amplitude, frequency, Some(damping));
            value["of"] = json!(of);
            value
        };
        all.into_iter().map(of).collect::<Vec<_>>()
    });
    let more = [("coulomb_friction_as_damping", json!(dampings)), ("pwm", Value::Array(pulses.collect()))];
    let parts = (&model.system, &model.delays[..], &model.poles[..], &model.reach[..]);
    document((&model.name, model.kind()), model.point(), parts, &model.assumed, &more)
}

fn signals(signals: &[Signal]) -> Vec<Value> {
    signals.iter().map(|s| json!({ "name": s.name, "symbol": s.symbol, "unit": s.unit })).collect()
}

fn assumptions(assumed: &[Assumed]) -> Vec<Value> {
    assumed.iter().map(|value| json!({ "key": value.parameter.key, "value": value.text })).collect()
}

/// The model as a script that MATLAB and Octave run, and that can be read without either.
pub(super) fn matlab(model: &Model) -> String {
    let kind = match kind(model) {
        "averaged-pwm" => "valve under PWM on average",
        "driven-valve" => "valve by its command",
        _ => "valve held shut",
    };
    let mut values = point(model);
    values.extend(model.linear.averaged().map(|averaged| ("frequency_hz", averaged.frequency)));
    script((&model.name, kind), &owned(values), (&model.system, &model.delays), &model.poles)
}

/// A model, the values at its point, the delays of its inputs and its poles as a script.
pub(super) fn script(
    (name, kind): (&str, &str),
    point: &[(String, f64)],
    (system, delays): (&StateSpace, &[f64]),
    poles: &[Pole],
) -> String {
    let mut text = String::new();
    let mut line = |words: &str| {
        text.push_str(words);
        text.push('\n');
    };
    line("% Linear model of a braided pneumatic actuator: dx/dt = A x + B u, y = C x + D u.");
    line("% x, u and y are differences from the operating point, in SI units.");
    line(&format!("% Scenario: {}; {kind}.", name.replace(['\n', '\r'], " ")));
    line(&format!("% Written by mckibben {}.", env!("CARGO_PKG_VERSION")));
    line("");
    for (name, value) in point {
        // A name of a file may have a hyphen, which a script would take for a minus.
        line(&format!("point.{} = {value:e};", name.replace('-', "_")));
    }
    line("");
    for (name, signals) in [("states", &system.states), ("inputs", &system.inputs), ("outputs", &system.outputs)] {
        let names = |of: fn(&Signal) -> &str| -> String {
            signals.iter().map(|signal| format!("'{}'", of(signal))).collect::<Vec<_>>().join(", ")
        };
        line(&format!("{name} = {{{}}};", names(|signal| &signal.name)));
        line(&format!("{name}_units = {{{}}};", names(|signal| signal.unit)));
    }
    line("% In s, by how much later than each input its effect begins; the matrices leave it out.");
    let delays: Vec<String> = delays.iter().map(|delay| format!("{delay:e}")).collect();
    line(&format!("delay = [{}];", delays.join(" ")));
    line("");
    for (name, rows) in [("A", &system.a), ("B", &system.b), ("C", &system.c), ("D", &system.d)] {
        line(&matrix(name, rows));
    }
    let poles: Vec<Vec<f64>> = poles.iter().map(|pole| vec![pole.real, pole.imaginary]).collect();
    line(&matrix("poles", &poles).replace("poles = [", "poles = [ % real and imaginary part in 1/s"));
    line("poles = complex(poles(:, 1), poles(:, 2));");
    line("");
    line("if exist('ss') % with the Control System Toolbox, or Octave's package control loaded");
    line("  model = ss(A, B, C, D);");
    line("end");
    text
}

/// Values with their names.
pub(super) fn owned(values: Vec<(&'static str, f64)>) -> Vec<(String, f64)> {
    values.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

fn matrix(name: &str, rows: &[Vec<f64>]) -> String {
    let mut text = format!("{name} = [\n");
    for row in rows {
        let entries: Vec<String> = row.iter().map(|value| format!("{value:e}")).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {}", entries.join(" "));
    }
    text + "];"
}
