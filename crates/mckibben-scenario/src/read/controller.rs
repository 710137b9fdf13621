//! The controller: what it regulates by the key of its set point, and how by the keys of a relay or of a PID controller.

use super::{alternative, columns};
use crate::choice::{ControllerKind, LoadKind, SetPointTable};
use crate::diagnostic::{Class, Diagnostic};
use crate::document::Value;
use crate::reader::Reader;
use crate::scenario::{Aim, Controller, Regulator};
use mckibben::control::{Quantity, Rows, SetPoint};
use mckibben::parameter::{self as p, Parameter};

/// Quantities of one actuator that can have a set point.
const OF_ACTUATOR: [Quantity; 4] = [Quantity::Pressure, Quantity::Length, Quantity::AirMass, Quantity::Force];

/// What a controller regulates, by its keys alone: `is` says whether a key holds a word, `has` whether it is there.
pub(crate) fn regulated(is: impl Fn(&str, &str) -> bool, has: impl Fn(&str) -> bool) -> Quantity {
    let kind = |kind: ControllerKind| is("controller.kind", kind.name());
    if kind(ControllerKind::AirMass) {
        return Quantity::AirMass;
    }
    if kind(ControllerKind::FeedForward) {
        return Quantity::Pressure;
    }
    let named = [&OF_ACTUATOR[..], &[Quantity::Angle]].concat();
    let named = named.into_iter().find(|quantity| has(quantity.rows().set_point.key));
    named.unwrap_or(Quantity::Pressure)
}

/// The row of a key that has the unit of what is regulated.
pub(crate) fn row_in_its_unit(regulated: Quantity, path: &str) -> Option<&'static Parameter> {
    let Rows { amplitude, dead_band, hysteresis, proportional_band, resolution, .. } = regulated.rows();
    [amplitude, dead_band, hysteresis, proportional_band, resolution].into_iter().find(|row| row.key == path)
}

pub(super) fn controller(r: &mut Reader<'_>) -> Option<Controller> {
    let kind: Option<ControllerKind> = r.word("controller.kind");
    if !r.has("controller.kind") {
        r.missing("controller.kind", "");
    }
    let kind = kind?;
    let of_joint = r.says("load.kind", LoadKind::AntagonisticJoint.name());
    refuse_foreign(r, of_joint);
    let tracked: &[Quantity] = if of_joint { &[Quantity::Angle] } else { &OF_ACTUATOR };
    let aim = match kind {
        ControllerKind::BangBang | ControllerKind::Pid => {
            let keys: Vec<[&str; 1]> = tracked.iter().map(|quantity| [quantity.rows().set_point.key]).collect();
            let ways: Vec<&[&str]> = keys.iter().map(|key| &key[..]).collect();
            let Some(index) = alternative(r, &ways) else {
                let others = if of_joint { "" } else { "; `length`, `air_mass` or `force` would do as well" };
                r.missing(keys[0][0], others);
                return None;
            };
            Aim::Track { quantity: tracked[index], set_point: set_point(r, tracked[index], true) }
        }
        ControllerKind::FeedForward | ControllerKind::AirMass => {
            let first = set_point(r, if of_joint { Quantity::Angle } else { Quantity::Force }, false);
            let stiffness = of_joint.then(|| set_point(r, Quantity::Stiffness, false));
            let length = (!of_joint && r.has(p::SET_LENGTH.key)).then(|| set_point(r, Quantity::Length, false));
            let highest_gauge_pressure = r.value(&p::HIGHEST_GAUGE_PRESSURE, None);
            let temperature = (kind == ControllerKind::AirMass).then(|| r.value(&p::CONTROL_TEMPERATURE, None));
            match stiffness {
                Some(stiffness) => Aim::Joint { angle: first, stiffness, highest_gauge_pressure, temperature },
                None => Aim::Model { force: first, length, highest_gauge_pressure, temperature },
            }
        }
    };
    let regulated = aim.regulated();
    let regulator = regulator(r, kind, regulated)?;
    Some(Controller {
        aim,
        regulator,
        rate: r.value(&p::CONTROL_RATE, None),
        delay: r.whole(&p::CONTROL_DELAY).unwrap_or(0) as usize,
        pulse_frequency: r.number(&p::PULSE_FREQUENCY),
        resolution: r.number(&regulated.rows().resolution).unwrap_or(0.0),
    })
}

/// Notes what an actuator alone can reach where there is a joint, and the other way round.
fn refuse_foreign(r: &mut Reader<'_>, of_joint: bool) {
    let foreign: &[Quantity] = if of_joint { &OF_ACTUATOR } else { &[Quantity::Angle, Quantity::Stiffness] };
    for path in foreign.iter().map(|quantity| quantity.rows().set_point.key) {
        if let Some(place) = r.key_place(path) {
            let (title, help) = if of_joint {
                (format!("`{path}` is not used for a joint"), "give controller.angle in its place")
            } else {
                (format!("`{path}` is not used without a joint"), "remove it, or choose another load.kind")
            };
            let load = r.value_place("load.kind");
            let found = Diagnostic::at(Class::NotApplicable, place, title, "does not apply");
            r.note(found.related(load, "chosen here").help(help));
        }
    }
}

fn set_point(r: &mut Reader<'_>, quantity: Quantity, may_swing: bool) -> SetPoint {
    let rows = quantity.rows();
    let row = rows.set_point;
    if matches!(r.entry(row.key).map(|entry| &entry.node.value), Some(Value::List(_))) {
        if !r.has(p::SET_TIME.key) {
            r.missing(p::SET_TIME.key, ", which a list needs in addition");
        }
        let (time, value) = (r.list(&p::SET_TIME), r.list(row));
        let (time, value) = columns(r, &p::SET_TIME, time, row.key, value);
        return match r.word("controller.table") {
            Some(SetPointTable::Lines) => SetPoint::Lines { time, value },
            _ => SetPoint::Steps { time, value },
        };
    }
    let mean = r.value(row, None);
    if !(may_swing && r.has(rows.amplitude.key)) {
        return SetPoint::Constant(mean);
    }
    let amplitude = r.number(&rows.amplitude);
    let (frequency, phase) = (r.value(&p::SET_FREQUENCY, None), r.value(&p::SET_PHASE, None));
    let Some(amplitude) = amplitude else { return SetPoint::Constant(mean) };
    SetPoint::sinusoid(quantity, mean, amplitude, frequency, phase).unwrap_or_else(|error| {
        r.note(r.document().diagnose(&error));
        SetPoint::Constant(mean)
    })
}

fn regulator(r: &mut Reader<'_>, kind: ControllerKind, regulated: Quantity) -> Option<Regulator> {
    let rows = regulated.rows();
    let (relay, pid) = (rows.dead_band.key, rows.proportional_band.key);
    let chosen = match kind {
        ControllerKind::BangBang => r.has(relay).then_some(0),
        ControllerKind::Pid => r.has(pid).then_some(1),
        ControllerKind::FeedForward | ControllerKind::AirMass => alternative(r, &[&[relay], &[pid]]),
    };
    let by_pid = [&p::INTEGRAL_TIME, &p::DERIVATIVE_TIME, &p::DERIVATIVE_FILTER, &p::SET_POINT_WEIGHT];
    let by_pid = by_pid.into_iter().chain([&p::TRACKING_TIME, &p::BIAS]).map(|row| row.key);
    let idle: Vec<&str> = if chosen == Some(0) { by_pid.collect() } else { vec![rows.hysteresis.key] };
    for path in idle {
        // With a kind that has one regulator only, the key has been refused already.
        let free = matches!(kind, ControllerKind::FeedForward | ControllerKind::AirMass);
        if let Some(place) = r.key_place(path).filter(|_| free && chosen.is_some()) {
            let other = if chosen == Some(0) { "dead_band" } else { "proportional_band" };
            let title = format!("`{path}` is not used with `{other}`");
            r.note(Diagnostic::at(Class::NotApplicable, place, title, "does not apply").help("remove it"));
        }
    }
    match chosen {
        Some(0) => Some(Regulator::Relay {
            dead_band: r.noted(&rows.dead_band),
            hysteresis: r.number(&rows.hysteresis).unwrap_or(0.0),
        }),
        Some(_) => Some(Regulator::Pid {
            proportional_band: r.noted(&rows.proportional_band),
            integral_time: r.number(&p::INTEGRAL_TIME),
            derivative_time: r.value(&p::DERIVATIVE_TIME, None),
            derivative_filter: r.value(&p::DERIVATIVE_FILTER, None),
            set_point_weight: r.value(&p::SET_POINT_WEIGHT, None),
            tracking_time: r.number(&p::TRACKING_TIME),
            bias: r.value(&p::BIAS, None),
        }),
        None if kind == ControllerKind::Pid => {
            r.missing(pid, "");
            None
        }
        None => {
            let because = if kind == ControllerKind::BangBang { "" } else { "; `proportional_band` would do as well" };
            r.missing(relay, because);
            None
        }
    }
}
