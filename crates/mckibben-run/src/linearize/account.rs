//! A linear model in words and tables.

use super::Model;
use super::export::over_fastest;
use crate::quantities::{digits, given, percent, quantity};
use crate::report::{Table, typeset};
use crate::units::{chosen_scale_of_differences, readable};
use crate::warnings;
use mckibben::air::Process;
use mckibben::linearize::{Controllability, Pole, Signal, StateSpace};
use mckibben::load::Load;
use mckibben::plant::{PlantInput, PlantLinearization, RigPlant, ValveAverage};
use mckibben::simulation::State;
use mckibben::valve::Ports;
use mckibben::{Actuator, ActuatorState};
use std::f64::consts::TAU;

/// What is printed of a model.
#[derive(Clone, Debug, Default)]
pub struct Account {
    /// The scenario's name, and how its valves are taken.
    pub title: String,
    /// The operating point, then the model.
    pub blocks: Vec<Block>,
    /// What the model leaves out, and what is assumed.
    pub notes: Vec<String>,
}

/// Lines or a table under a heading.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// The heading; may be empty.
    pub heading: String,
    /// Values with names.
    pub lines: Vec<Line>,
    /// A table; without a head where there is none.
    pub table: Table,
}

/// A value with its name.
#[derive(Clone, Debug, Default)]
pub struct Line {
    /// Its name.
    pub name: String,
    /// The value in words.
    pub value: String,
    /// What casts doubt on it; empty for nothing.
    pub warning: String,
}

impl Account {
    /// What casts doubt on the model, each with what it is about.
    pub fn warnings(&self) -> Vec<String> {
        let lines = self.blocks.iter().flat_map(|block| &block.lines).filter(|line| !line.warning.is_empty());
        lines.map(|line| format!("{}: {}; {}", line.name, line.value, line.warning)).collect()
    }
}

impl Line {
    pub(super) fn new(name: impl Into<String>, value: String) -> Self {
        Self { name: name.into(), value, warning: String::new() }
    }

    /// The line with a warning where something does not hold.
    fn unless(self, holds: bool, warning: &str) -> Self {
        let warning = if holds { String::new() } else { warning.to_owned() };
        Self { warning, ..self }
    }
}

impl Block {
    pub(super) fn of_lines(heading: &str, lines: Vec<Line>) -> Self {
        Self { heading: heading.to_owned(), lines, ..Self::default() }
    }

    pub(super) fn of_table(heading: &str, table: Table) -> Self {
        Self { heading: heading.to_owned(), table, ..Self::default() }
    }
}

/// Of an actuator on its load.
pub(super) fn of_actuator(model: &Model) -> Account {
    let valve = match model.linear.averaged() {
        Some(averaged) => format!("PWM at {} on average", quantity(averaged.frequency, "Hz")),
        None if model.linear.is_driven() => "valve by its command".to_owned(),
        None => "valve held shut".to_owned(),
    };
    let mut blocks = vec![Block::of_lines("", point(model))];
    if let Some(averaged) = model.linear.averaged() {
        blocks.push(Block::of_lines("Mean flow", pwm(averaged, &model.poles, swings(model))));
    }
    blocks.push(Block::of_table("Model", matrices(&model.system)));
    blocks.extend(dynamics(&model.system, &model.poles, &model.reach));
    Account { title: format!("{}, {valve}", model.name), blocks, notes: notes(model) }
}

/// The poles, and what the inputs reach.
pub(super) fn dynamics(system: &StateSpace, poles: &[Pole], reach: &[Controllability]) -> [Block; 2] {
    [Block::of_table("Poles", of_poles(poles)), Block::of_table("Controllability", of_reach(system, reach))]
}

fn point(model: &Model) -> Vec<Line> {
    let point = &model.linear.point;
    let state = point.state;
    let actuator = point.rig.actuator();
    let longest = actuator.limits().max_length();
    let taut = if point.is_taut() { ", on the taut braid" } else { "" };
    let load = match point.rig.load() {
        Load::HangingMass { mass, .. } => {
            format!("{} hangs, {}", quantity(*mass, "kg"), quantity(point.tension(), "N"))
        }
        Load::ConstantForce { mass, force } => format!("{} pulls {}", quantity(*force, "N"), quantity(*mass, "kg")),
        _ => format!("the ends are held with {}", quantity(point.tension(), "N")),
    };
    let mut lines = vec![
        ("gauge pressure", quantity(point.gauge_pressure().0, "Pa")),
        (
            "length",
            format!(
                "{}, contracted by {}{taut}",
                quantity(state.length, "m"),
                percent((longest - state.length) / longest)
            ),
        ),
        ("load", load),
    ];
    if let Some(distance) = point.load_distance() {
        lines.push(("tendon", format!("the load is at {}", quantity(distance, "m"))));
    }
    let temperature = quantity(point.temperature(), "K");
    lines.push(("air", format!("{} at {temperature}", quantity(state.air_mass, "kg"))));
    if point.rig.load().inertia().is_some() {
        let constant = actuator.stiffness(state.length, state.pressure);
        let sealed = actuator.sealed_stiffness(state.length, state.pressure);
        lines.push((
            "stiffness",
            format!(
                "{}, with the valve shut {}{}",
                quantity(constant, "N/m"),
                quantity(sealed, "N/m"),
                without_hysteresis([actuator])
            ),
        ));
    }
    let mut lines: Vec<Line> = lines.into_iter().map(|(name, value)| Line::new(name, value)).collect();
    let view = RigPlant::new(&point.rig);
    lines[0].warning = doubts(warnings::feed_of(view.plant(), 0, point.gauge_pressure().0), actuator);
    lines.extend(of_spools(&model.linear.plant, |_| "spool".to_owned()));
    lines
}

/// What casts doubt on an actuator in a linear model: the warning of what feeds it, and hysteresis, of which the model has the
/// stiffness about the point alone.
pub(super) fn doubts(feed: Option<String>, actuator: &Actuator) -> String {
    let hysteresis = actuator.friction().hysteresis().map(|_| {
        "the model has the hysteresis of friction as its stiffness for small signals: larger ones, beyond its width, meet a \
         softer muscle and lose energy"
            .to_owned()
    });
    feed.into_iter().chain(hysteresis).collect::<Vec<_>>().join("; ")
}

/// What a stiffness leaves out that the matrices have: the hysteresis of friction, where any of the actuators has it.
pub(super) fn without_hysteresis<'a>(actuators: impl IntoIterator<Item = &'a Actuator>) -> &'static str {
    match actuators.into_iter().any(|of| of.friction().hysteresis().is_some()) {
        true => ", both without the hysteresis of friction, which is in the matrices",
        false => "",
    }
}

/// The spools whose one gain in a linear model says little, each by the name of its valve: at an edge, or in a dead zone.
pub(super) fn of_spools(linear: &PlantLinearization, name: impl Fn(usize) -> String) -> Vec<Line> {
    let line = |(input, position): &(PlantInput, f64)| {
        let PlantInput::SpoolCommand { valve } = *input else { return None };
        let [below, above] = linear.spool_gains(valve)?;
        let at = digits(*position);
        let (value, warning) = if linear.is_in_dead_zone(valve) {
            (
                format!("spool at {at}"),
                "the spool rests in its dead zone, where its gain is zero: commands that leave it there move nothing",
            )
        } else if (above - below).abs() > EQUAL_GAINS * above.abs().max(below.abs()) {
            (
                format!(
                    "spool at {at}, with gains of {} per stroke towards the exhaust and {} towards the supply",
                    quantity(below, "Pa/s"),
                    quantity(above, "Pa/s"),
                ),
                "the spool rests at an edge: the model has the mean of both gains, which holds for small signals to both \
                 sides; a signal to one side meets the gain of that side",
            )
        } else {
            return None;
        };
        Some(Line { warning: warning.to_owned(), ..Line::new(name(valve), value) })
    };
    linear.point.inputs.iter().filter_map(line).collect()
}

/// Part of the larger of two gains up to which both are equal.
const EQUAL_GAINS: f64 = 1e-9;

/// How far length, pressure in the actuator and tension swing under the pulses, as far as the model has them.
fn swings(model: &Model) -> Vec<String> {
    let swing = |(name, unit): &(&str, &str)| Some(format!("{name} {}", quantity(model.linear.ripple(name)?, unit)));
    [("length", "m"), ("pressure", "Pa"), ("tension", "N")].iter().filter_map(swing).collect()
}

/// A valve under PWM on average, and how far that holds.
pub(super) fn pwm(averaged: &ValveAverage, poles: &[Pole], swings: Vec<String>) -> Vec<Line> {
    let (duty, share) = (percent(averaged.duty), percent(averaged.supply_share()));
    let ripple = format!(
        "{} peak to peak at a fixed length, {} from supply or exhaust",
        quantity(averaged.pressure_ripple, "Pa"),
        quantity(averaged.pressure_margin, "Pa"),
    );
    let mut lines = vec![
        Line::new("duty", format!("{duty} commanded, open to the supply for {share} of the period")),
        Line { warning: unanswered(averaged), ..Line::new("the poppets follow", followed(averaged)) },
        Line::new("air used", quantity(averaged.flow.outward, "kg/s")),
        Line {
            warning: of_ripple(averaged, "too large for the mean flow to be trusted"),
            ..Line::new("ripple", ripple)
        },
    ];
    if !swings.is_empty() {
        lines.push(Line::new("", format!("of the outputs, peak to peak: {}", swings.join(", "))));
    }
    if let Some(ratio) = over_fastest(averaged, poles) {
        let slow = "slow: the model does not describe what happens within a period";
        let ratio_text = format!("{} times the fastest pole", digits(ratio));
        lines.push(Line::new("frequency", ratio_text).unless(ratio > 3.0, slow));
    }
    lines
}

/// The duty cycles at which the poppets follow.
fn followed(averaged: &ValveAverage) -> String {
    match averaged.duty_range {
        (from, to) if from > to => format!("no duty cycle at {}", given(averaged.frequency, "Hz")),
        (from, to) => format!("from {} to {}", percent(from), percent(to)),
    }
}

/// What keeps the poppets from following; empty where they do.
pub(super) fn unanswered(averaged: &ValveAverage) -> String {
    let (from, to) = averaged.duty_range;
    if averaged.follows() {
        return String::new();
    }
    if from > to {
        // Delays that take the shares `from` and `1 − to` of a period fill it at this frequency.
        let highest = averaged.frequency / (from + 1.0 - to);
        return format!(
            "the valve does not answer to the duty: a period is too short for the delays of opening and closing; lower \
             command.frequency below {}",
            given(highest, "Hz")
        );
    }
    "not here: the valve does not answer to the duty".to_owned()
}

/// Distance in Pa from the pressure beyond a port below which the pressure stands there.
const AT_REST: f64 = 1.0;

/// What the ripple of the pressure, or its distance from the pressures beyond the ports, casts doubt on: `too_large` is said of the ripple.
pub(super) fn of_ripple(averaged: &ValveAverage, too_large: &str) -> String {
    if averaged.ripple_is_small() || !averaged.follows() {
        return String::new();
    }
    if averaged.pressure_margin < AT_REST {
        return "the pressure stands at that beyond an open port, where no air flows and the mean flow says nothing of the \
                valve; give `gauge_pressure` or `length` for a model with the valve held shut"
            .to_owned();
    }
    too_large.to_owned()
}

pub(super) fn matrices(system: &StateSpace) -> Table {
    matrices_in(system, chosen_scale_of_differences)
}

/// The matrices in units, given by the SI unit with their symbol and how many of them are one: signals are differences, so offsets
/// have no part. An entry is a row's quantity over a column's, and its number is multiplied by the factor of the one over that of the
/// other: the poles stay.
fn matrices_in(system: &StateSpace, scale: impl Fn(&str) -> Option<(String, f64, f64)>) -> Table {
    let unit = |signal: &Signal| match scale(signal.unit) {
        Some((symbol, factor, _)) => (readable(&symbol), factor),
        None => (signal.unit.to_owned(), 1.0),
    };
    let titled = |signal: &Signal| match unit(signal).0 {
        unit if unit.is_empty() => signal.symbol.clone(),
        unit => format!("{} {unit}", signal.symbol),
    };
    let factors: Vec<f64> = system.states.iter().chain(&system.inputs).map(|signal| unit(signal).1).collect();
    let columns = system.states.iter().chain(&system.inputs).map(titled);
    let sizes: Vec<f64> = system.states.iter().chain(&system.inputs).map(|signal| usual_size(signal.unit)).collect();
    let row = |name: String, factor: f64, of_states: &[f64], of_inputs: &[f64]| -> Vec<String> {
        let entries: Vec<f64> = of_states.iter().chain(of_inputs).copied().collect();
        let entries = without_rounding(&entries, &sizes).into_iter().zip(&factors).map(|(entry, of)| match entry {
            0.0 => "0".to_owned(),
            entry => minus(format!("{:.4e}", entry * factor / of)),
        });
        std::iter::once(name).chain(entries).collect()
    };
    let mut rows = Vec::new();
    for (state, (a, b)) in system.states.iter().zip(system.a.iter().zip(&system.b)) {
        rows.push(row(format!("d{}/dt", state.symbol), unit(state).1, a, b));
    }
    for (output, (c, d)) in
        system.outputs.iter().zip(system.c.iter().zip(&system.d)).filter(|(o, _)| is_tension(&o.name))
    {
        rows.push(row(titled(output), unit(output).1, c, d));
    }
    let head = std::iter::once(String::new()).chain(columns).collect();
    Table { caption: "rates and tension by states and inputs, as differences from the point".to_owned(), head, rows }
}

/// The part of the largest effect in a row below which an entry is rounding of terms that cancel.
const ROUNDING: f64 = 1e-13;

/// The entries of a row, each with the usual size of its column: zero where what it does is rounding of what the largest does.
fn without_rounding(entries: &[f64], sizes: &[f64]) -> Vec<f64> {
    let effects = || entries.iter().zip(sizes).map(|(entry, size)| (entry * size).abs());
    let fine = ROUNDING * effects().fold(0.0, f64::max);
    entries.iter().zip(effects()).map(|(entry, effect)| if effect < fine { 0.0 } else { *entry }).collect()
}

/// The usual order of size of a signal in its unit.
fn usual_size(unit: &str) -> f64 {
    match unit {
        "m" => 1e-2,
        "m/s" | "rad" => 1e-1,
        "Pa" => 1e5,
        "kg" => 1e-5,
        "kg/s" => 1e-4,
        "K" => 1e2,
        "N" => 1e1,
        _ => 1.0,
    }
}

/// Whether an output is the tension of an actuator.
fn is_tension(name: &str) -> bool {
    name.rsplit('.').next() == Some("tension")
}

fn of_poles(poles: &[Pole]) -> Table {
    let row = |pole: &Pole| {
        let value = match pole.imaginary {
            0.0 => digits(pole.real),
            imaginary => format!("{} ± {} i", digits(pole.real), digits(imaginary)),
        };
        let or = |number: Option<String>| number.unwrap_or_else(|| "–".to_owned());
        let kind = match pole {
            pole if pole.is_zero() => "integrator",
            pole if pole.real > 0.0 => "grows",
            pole if pole.imaginary != 0.0 => "swings",
            _ => "decays",
        };
        let frequency = (!pole.is_zero()).then(|| quantity(pole.natural_frequency() / TAU, "Hz"));
        vec![
            minus(value),
            or(frequency),
            or(pole.damping_ratio().map(digits).map(minus)),
            or(pole.time_constant().map(|time| minus(quantity(time, "s")))),
            kind.to_owned(),
        ]
    };
    let head = ["1/s", "natural frequency", "damping ratio", "time constant", ""].map(String::from).to_vec();
    Table {
        caption: "each decays as exp(λ t)".to_owned(),
        head,
        rows: poles.iter().filter(|pole| pole.imaginary >= 0.0).map(row).collect(),
    }
}

fn of_reach(system: &StateSpace, reach: &[Controllability]) -> Table {
    let rows = system.inputs.iter().zip(reach).map(|(input, reach)| {
        let condition = match reach.condition {
            condition if condition.is_finite() => digits(condition),
            _ if reach.rank < system.states.len() => "∞".to_owned(),
            // The least singular value is lost to rounding.
            _ => "above 1e12".to_owned(),
        };
        let values: Vec<String> = reach.singular_values.iter().map(|value| format!("{value:.1e}")).collect();
        vec![
            input.name.replace('_', " "),
            format!("{} of {}", reach.rank, system.states.len()),
            condition,
            values.join("  "),
        ]
    });
    let head = ["input", "reaches", "condition", "singular values"].map(String::from).to_vec();
    Table { caption: "states by their usual size, time by the fastest pole".to_owned(), head, rows: rows.collect() }
}

/// Whether dry friction holds anything, by how much less or more than the balance.
pub(super) fn is_held([less, more]: [f64; 2]) -> bool {
    less > 0.0 || more > 0.0
}

/// A range about a balance, by how much less and more: below no tension a muscle holds less than it may hold more.
pub(super) fn around([less, more]: [f64; 2], unit: &'static str) -> String {
    match (less - more).abs() > 1e-9 * more.abs() {
        true => format!("−{} and +{}", quantity(less, unit), quantity(more, unit)),
        false => format!("± {}", quantity(more, unit)),
    }
}

/// What the model leaves out, and what is assumed.
fn notes(model: &Model) -> Vec<String> {
    let point = &model.linear.point;
    let keeps = !matches!(point.rig.actuator().air().process(), Process::EnergyBalance { .. });
    let mut notes = Vec::new();
    if keeps && model.poles.len() == model.linear.system.states.len() {
        notes.push(
            "The process keeps P (V/m)^κ whatever the valve does: one pole at zero that no input reaches. In the \
             model of the states that are needed the air mass follows from pressure and length, and that pole is gone."
                .to_owned(),
        );
    } else if keeps {
        notes.push(
            "The air mass is no state: it follows from pressure and length by P (V/m)^κ. The model of all states keeps it."
                .to_owned(),
        );
    }
    let bounds = model.linear.plant.coulomb_bounds(0);
    if is_held(bounds) && point.rig.load().inertia().is_some() {
        let (actuator, State { length, pressure, air_mass, .. }) = (point.rig.actuator(), point.state);
        let air = ActuatorState::new(pressure, air_mass, length);
        let per_pressure = actuator.respond(&air, length, 0.0, Ports::CLOSED).per_pressure;
        let sealed = actuator.sealed_stiffness(length, pressure);
        let sliding = if model.oscillation.is_some() { "" } else { " The model is about sliding without it." };
        notes.push(format!(
            "Coulomb friction holds the load at rest within {}: that is {} with the valve shut, or {} of pressure.{sliding}",
            around(bounds, "N"),
            around(bounds.map(|bound| bound / sealed), "m"),
            around(bounds.map(|bound| (bound / per_pressure).abs()), "Pa"),
        ));
    }
    if let Some((amplitude, frequency)) = model.oscillation {
        let damping = model.linear.equivalent_damping(amplitude, frequency).unwrap_or_default();
        notes.push(format!(
            "Coulomb friction is in the model as {} of viscous damping, right for an amplitude of {} at {}.",
            quantity(damping, "N*s/m"),
            quantity(amplitude, "m"),
            quantity(frequency / TAU, "Hz"),
        ));
    }
    notes.extend(of_delays(&model.system, &model.delays));
    if !model.assumed.is_empty() {
        let values = model.assumed.iter().map(|each| format!("{} = {}", each.parameter.symbol, typeset(&each.text)));
        notes.push(format!("Assumed, stated by no source: {}.", values.collect::<Vec<_>>().join(", ")));
    }
    notes
}

/// What of the inputs' delays the matrices leave out.
pub(super) fn of_delays(system: &StateSpace, delays: &[f64]) -> Option<String> {
    let late = system.inputs.iter().zip(delays).filter(|(_, delay)| **delay > 0.0);
    let late: Vec<String> = late.map(|(input, delay)| format!("{} by {}", input.name, quantity(*delay, "s"))).collect();
    let all = late.join(", ");
    let sentence = || {
        format!("Inputs act late, which the matrices leave out: {all}. A delay lowers the phase by ω times the delay.")
    };
    (!late.is_empty()).then(sentence)
}

/// The end of a figure's caption where it draws the response without delays.
pub(super) fn left_out(delays: &[f64]) -> &'static str {
    if delays.iter().any(|delay| *delay > 0.0) { ", without the delays of inputs" } else { "" }
}

/// A true minus sign.
fn minus(text: String) -> String {
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass on a spring: the rate of the length is the velocity in every system, a stiffness of 1 N/m is 0.00571015 lbf/in, and
    /// the eigenvalues, from trace and determinant, stay.
    #[test]
    fn matrices_in_other_units_are_a_similar_system() {
        let signal = |name: &str, unit| Signal::new(name, unit);
        let system = StateSpace {
            states: vec![signal("L", "m"), signal("v", "m/s"), signal("T", "K")],
            inputs: vec![signal("m_dot", "kg/s")],
            outputs: vec![signal("tension", "N")],
            a: vec![vec![0.0, 1.0, 0.0], vec![-400.0, -3.0, 0.0], vec![7.0, 0.0, -5.0]],
            b: vec![vec![0.0], vec![2.0], vec![0.0]],
            c: vec![vec![175.126_835_246_476_47, 0.0, 0.0]],
            d: vec![vec![0.0]],
        };
        for (choice, stiffness, head) in [
            ("metric", 175.126_835, "L m"),
            ("si", 175.126_835, "L m"),
            ("imperial", 1.0, "L in"),
            ("metric,length=mm,velocity=mm/s,temperature=degC", 0.175_126_835, "L mm"),
            ("length=in,velocity=in/s,force=lbf", 1.0, "L in"),
        ] {
            let units: crate::units::Units = choice.parse().unwrap();
            let table = matrices_in(&system, |si| units.of_differences().scale(si));
            let entry =
                |row: usize, column: usize| -> f64 { table.rows[row][column + 1].replace('−', "-").parse().unwrap() };
            let near =
                |found: f64, due: f64| assert!((found - due).abs() <= 2e-4 * due.abs(), "{choice}: {found} {due}");
            near(entry(0, 1), 1.0);
            near(entry(3, 0), stiffness);
            near(entry(0, 0) + entry(1, 1), -3.0);
            near(entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0), 400.0);
            near(entry(2, 2), -5.0);
            assert_eq!((table.head[1].as_str(), table.head[3].contains('C')), (head, false), "{choice}");
        }
    }

    /// Entries of one row have many units, so they are compared by what their columns usually do.
    #[test]
    fn rounding_in_a_row_is_printed_as_zero() {
        let sizes = ["m", "m/s", "Pa", "kg"].map(usual_size);
        let rate_of_pressure = [-3.725e-9, 3.0507e6, -1.1291e1, 4.6122e9];
        assert_eq!(without_rounding(&rate_of_pressure, &sizes), [0.0, 3.0507e6, -1.1291e1, 4.6122e9]);
        // A flow of mass by the pressure is small in its unit, and no rounding.
        let rate_of_mass = [-2.8456e-3, 0.0, -2.083e-9, -8.7741];
        assert_eq!(without_rounding(&rate_of_mass, &sizes), rate_of_mass);
        assert_eq!(without_rounding(&[0.0; 4], &sizes), [0.0; 4]);
    }
}
