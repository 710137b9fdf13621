//! The columns of a file as functions of a sample, for an actuator, and for each of several.

use crate::closed_loop::{Goal, Goals};
use crate::table::{Cell, Column};
use crate::units;
use mckibben::control::Quantity;
use mckibben::simulation::{Fittings, JointRig, JointSample, Rig, Sample};

/// A column of a file over samples `S`.
pub(crate) struct Field<S> {
    pub(crate) column: Column,
    /// What it has of a sample.
    pub(crate) cell: Box<dyn Fn(&S) -> Cell<'static>>,
}

/// A column of numbers that every run of one actuator has: name, unit and value, for which the absolute pressure of the atmosphere
/// in Pa is given, from which gauge pressures count.
type Common = (&'static str, &'static str, fn(&Sample, f64) -> f64);

/// The columns of numbers that every run of one actuator has, in their order.
const COMMON: [Common; 10] = [
    ("time_s", "s", |sample, _| sample.time),
    ("length_m", "m", |sample, _| sample.length),
    ("velocity_m_s", "m/s", |sample, _| sample.velocity),
    ("absolute_pressure_pa", "Pa", |sample, _| sample.pressure.0),
    ("gauge_pressure_pa", "Pa", |sample, atmosphere| sample.pressure.0 - atmosphere),
    ("air_mass_kg", "kg", |sample, _| sample.air_mass),
    ("temperature_k", "K", |sample, _| sample.temperature),
    ("volume_m3", "m^3", |sample, _| sample.volume),
    ("tension_n", "N", |sample, _| sample.tension),
    ("mass_flow_kg_s", "kg/s", |sample, _| sample.mass_flow),
];

/// The column of the open ports.
const VALVE: &str = "valve";

/// Two times that differ by less than this part of themselves are one.
const ROUNDING: f64 = 1e-14;

/// The columns that every run of one actuator has, in their order. The absolute pressure of the atmosphere is in Pa.
pub(crate) fn of_actuator(atmosphere: f64) -> Vec<Field<Sample>> {
    let numbers = COMMON
        .into_iter()
        .map(|(name, unit, value)| number(name, unit, move |sample: &Sample| value(sample, atmosphere)));
    numbers.chain([word(VALVE, |sample: &Sample| sample.ports.name())]).collect()
}

/// The columns of a pressure in Pa: absolute, then gauge.
fn of_pressure<S>(name: &str, atmosphere: f64, value: impl Fn(&S) -> f64 + Copy + 'static) -> [Field<S>; 2] {
    [
        number(&format!("{name}absolute_pressure_pa"), "Pa", value),
        number(&format!("{name}gauge_pressure_pa"), "Pa", move |sample: &S| value(sample) - atmosphere),
    ]
}

/// The columns of one actuator: those that every run has, then those of its rig's air line, pressure regulator and tendon in
/// series.
fn of_rig(rig: &Rig) -> Vec<Field<Sample>> {
    let (line, atmosphere) = (rig.line(), rig.actuator().air().atmosphere().0);
    let mut fields = of_actuator(atmosphere);
    fields.extend(of_line(line.hose.is_some(), line.supply.is_some(), atmosphere));
    if let (Some(_), Some(actuation)) = (rig.regulator(), rig.actuation()) {
        let regulated = |sample: &Sample| sample.supply_pressure.unwrap_or(sample.pressure).0;
        let command = actuation.command.clone();
        // Until the first set point it keeps what it has.
        let regulator_input =
            move |sample: &Sample| command.set_point_at(sample.time).unwrap_or_else(|| regulated(sample) - atmosphere);
        fields.extend(of_pressure("regulated_", atmosphere, regulated));
        fields.push(number("set_point_pa", "Pa", regulator_input));
    }
    if rig.tendon().is_some() {
        fields.extend(of_tendon());
    }
    fields
}

/// The columns of an air line with a hose, and with a supply whose pressure changes.
fn of_line(hose: bool, supply: bool, atmosphere: f64) -> impl Iterator<Item = Field<Sample>> {
    let of_hose = hose.then(|| of_pressure("hose_", atmosphere, |sample: &Sample| sample.hose_pressure.0));
    let own = |sample: &Sample| sample.supply_pressure.unwrap_or(sample.pressure).0;
    of_hose.into_iter().chain(supply.then(|| of_pressure("supply_", atmosphere, own))).flatten()
}

/// The columns of a tendon in series.
fn of_tendon() -> [Field<Sample>; 2] {
    [
        number("load_distance_m", "m", |sample: &Sample| sample.load_distance),
        number("load_velocity_m_s", "m/s", |sample: &Sample| sample.load_velocity),
    ]
}

/// The columns of one actuator under a controller: its goals follow.
pub(crate) fn of_controlled(rig: &Rig, goals: &Goals) -> Vec<Field<Sample>> {
    let mut fields = of_rig(rig);
    fields.extend(of_goals(goals, |sample: &Sample| sample.time));
    fields
}

/// The columns of goals of one actuator, or of a joint.
fn of_goals<S: 'static>(goals: &Goals, time_of: fn(&S) -> f64) -> Vec<Field<S>> {
    let whose: Vec<_> = goals.borrow().iter().map(|goal| goal.whose).collect();
    goal_fields(goals, |index| if whose[index] == Some(1) { "antagonist_" } else { "" }.to_owned(), time_of)
}

/// The set points, and what was measured of those that are regulated, as of the last sampling instant; a prefix says what each
/// goal is of.
pub(crate) fn goal_fields<S: 'static>(
    goals: &Goals,
    prefix: impl Fn(usize) -> String,
    time_of: fn(&S) -> f64,
) -> Vec<Field<S>> {
    let mut fields = Vec::new();
    for (index, goal) in goals.borrow().iter().enumerate() {
        let unit = goal.quantity.rows().set_point.unit;
        let ending = units::ending(unit);
        let whose = prefix(index);
        let column = |name: &str, values: fn(&Goal) -> &[f64]| {
            let goals = goals.clone();
            number(&format!("{whose}{name}{ending}"), unit, move |sample: &S| {
                let goal = &goals.borrow()[index];
                // A sampling instant and the sample's time that differ by rounding are one; the first is at 0.
                let begun = goal.time.partition_point(|time| *time <= time_of(sample) * (1.0 + ROUNDING));
                values(goal).get(begun.max(1) - 1).copied().unwrap_or(f64::NAN)
            })
        };
        fields.push(column("set_point", |goal| &goal.target));
        // No column of the run has a stiffness.
        if goal.regulated || goal.quantity == Quantity::Stiffness {
            fields.push(column("measured", |goal| &goal.measured));
        }
    }
    fields
}

/// The columns that every run of a joint has, in their order.
pub(crate) fn of_joint_alone(atmosphere: f64) -> Vec<Field<JointSample>> {
    of_both([of_actuator(atmosphere), of_actuator(atmosphere)])
}

/// The columns of a joint: each actuator's with those of its air line and tendon, then its goals. A supply of both has its
/// columns with the first actuator that draws from it.
pub(crate) fn of_joint(rig: &JointRig, goals: &Goals) -> Vec<Field<JointSample>> {
    let atmosphere = rig.driven()[0].actuator.air().atmosphere().0;
    let own = |i: usize| {
        let mut fields = of_actuator(atmosphere);
        let Fittings { line, tendon, .. } = &rig.fittings()[i];
        let has_valve = |i: usize| rig.driven()[i].actuation.is_some();
        let supply = match rig.shared_supply() {
            Some(_) => has_valve(i) && (i == 0 || !has_valve(0)),
            None => line.supply.is_some(),
        };
        fields.extend(of_line(line.hose.is_some(), supply, atmosphere));
        fields.extend(tendon.iter().flat_map(|_| of_tendon()));
        fields
    };
    let mut fields = of_both([own(0), own(1)]);
    fields.extend(of_goals(goals, |sample: &JointSample| sample.time));
    fields
}

/// The columns of a joint from those of its actuators.
fn of_both([agonist, antagonist]: [Vec<Field<Sample>>; 2]) -> Vec<Field<JointSample>> {
    let mut fields = member("", agonist, |sample: &JointSample| sample.actuators[0]);
    fields.extend([
        number("angle_rad", "rad", |sample: &JointSample| sample.angle),
        number("angular_velocity_rad_s", "rad/s", |sample: &JointSample| sample.angular_velocity),
        number("torque_n_m", "N*m", |sample: &JointSample| sample.torque),
    ]);
    // The time stands in front already.
    let second = |sample: &JointSample| sample.actuators[1];
    fields.extend(member("antagonist_", antagonist, second).into_iter().skip(1));
    fields
}

/// The columns of one actuator of several, which `its` takes out of a sample of all; their names with a prefix.
fn member<S>(prefix: &str, fields: Vec<Field<Sample>>, its: impl Fn(&S) -> Sample + Copy + 'static) -> Vec<Field<S>> {
    let of = move |Field { column, cell }: Field<Sample>| Field {
        column: Column { name: format!("{prefix}{}", column.name), ..column },
        cell: Box::new(move |sample: &S| cell(&its(sample))),
    };
    fields.into_iter().map(of).collect()
}

pub(crate) fn number<S>(name: &str, unit: &'static str, value: impl Fn(&S) -> f64 + 'static) -> Field<S> {
    Field { column: Column::number(name, unit), cell: Box::new(move |sample| Cell::Number(value(sample))) }
}

pub(crate) fn word<S>(name: &str, value: impl Fn(&S) -> &'static str + 'static) -> Field<S> {
    Field { column: Column::word(name), cell: Box::new(move |sample| Cell::Word(value(sample))) }
}
