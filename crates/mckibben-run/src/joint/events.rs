//! The log of a joint's events.
//!
//! The columns of the CSV are `time_s,event,actuator,turning,contact` and, for each actuator with its name before them,
//! `valve,supply_flow,exhaust_flow,length_regime,sliding,tension_clamped`; `actuator` is empty for what happens to the joint
//! itself and `supply` for what happens to a supply of both, and what stands behind it holds from then on.

use super::NAMES;
use crate::events::{Log, OF_ACTUATOR, words};
use mckibben::mechanism::Contact;
use mckibben::plant::{JointEvent, JointEventKind, Turning};
use mckibben::simulation::EventKind;
use std::borrow::Cow;

/// To what it happened; nothing for the joint itself.
fn whose(of: JointEventKind) -> &'static str {
    match (of.actuator, of.kind) {
        (Some(index), _) => NAMES[index],
        // Both draw from it.
        (None, EventKind::Compressor | EventKind::Regulator) => "supply",
        (None, _) => "",
    }
}

/// The log in words.
pub fn log(events: &[JointEvent]) -> Log {
    let own = ["event", "actuator", "turning", "contact"].map(str::to_owned);
    let names = NAMES.iter().flat_map(|name| OF_ACTUATOR.map(|column| format!("{name}_{column}")));
    let row = |event: &JointEvent| {
        let after = &event.after;
        let whose = whose(event.kind);
        let own = [event.kind.kind.name(), whose, turning(after.turning), contact(after.stops)];
        own.into_iter().chain(after.actuators.iter().flat_map(words)).map(Cow::Borrowed).collect()
    };
    Log {
        columns: own.into_iter().chain(names).collect(),
        times: events.iter().map(|event| event.time).collect(),
        rows: events.iter().map(row).collect(),
    }
}

fn turning(turning: Turning) -> &'static str {
    match turning {
        Turning::Forward => "forward",
        Turning::Backward => "backward",
        Turning::Stuck => "stuck",
        Turning::Frictionless => "frictionless",
    }
}

fn contact(stops: [Contact; 2]) -> &'static str {
    match stops {
        [Contact::None, Contact::None] => "none",
        [Contact::Pressed, _] => "lower-pressed",
        [_, Contact::Pressed] => "upper-pressed",
        [Contact::Rebound, _] => "lower-rebound",
        [_, Contact::Rebound] => "upper-rebound",
    }
}
