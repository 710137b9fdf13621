//! The log of a joint's events: as a table for people, and as CSV.
//!
//! The columns of the CSV are `time_s,event,actuator,turning,contact` and, for each actuator with its name before them,
//! `valve,supply_flow,exhaust_flow,extent,sliding,tension_clamped`; `actuator` is empty for what happens to the joint
//! itself and `supply` for what happens to a supply of both, and what stands behind it holds from then on.

use super::NAMES;
use crate::events::{Log, OF_ACTUATOR, extent, words, zone};
use crate::terminal::{FAINT, styled};
use mckibben::mechanism::Contact;
use mckibben::plant::{JointEvent, JointEventKind, JointMode, Turning};
use mckibben::simulation::EventKind;
use std::borrow::Cow;
use std::fmt::Write as _;

/// The log as a table for people.
pub fn table(events: &[JointEvent]) -> String {
    let mut text = styled(FAINT, format!("{:>16}  {:<12}  {:<10}  {}", "time (s)", "event", "of", "then")) + "\n";
    for event in events {
        let whose = whose(event.kind, "joint");
        let (kind, then) = (event.kind.kind.name(), then(event.kind.actuator, &event.after));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:>16.9}  {kind:<12}  {whose:<10}  {then}", event.time);
    }
    text
}

/// To what it happened; the joint itself as `joint`.
fn whose(of: JointEventKind, joint: &'static str) -> &'static str {
    match (of.actuator, of.kind) {
        (Some(index), _) => NAMES[index],
        // Both draw from it.
        (None, EventKind::Compressor | EventKind::Regulator) => "supply",
        (None, _) => joint,
    }
}

/// What holds after an event for whom it happened to.
fn then(actuator: Option<usize>, mode: &JointMode) -> String {
    let Some(index) = actuator else { return format!("{}, {}", turning(mode.turning), contact(mode.stops)) };
    let mode = &mode.actuators[index];
    let mut then = vec![mode.ports.name()];
    then.extend(mode.supply_zone.or(mode.exhaust_zone).map(zone));
    then.push(extent(mode.extent));
    then.extend(mode.clamped.then_some("tension kept at zero"));
    then.join(", ")
}

/// The log in words.
pub fn log(events: &[JointEvent]) -> Log {
    let own = ["event", "actuator", "turning", "contact"].map(str::to_owned);
    let names = NAMES.iter().flat_map(|name| OF_ACTUATOR.map(|column| format!("{name}_{column}")));
    let row = |event: &JointEvent| {
        let after = &event.after;
        let whose = whose(event.kind, "");
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
