//! Valves that never open or never close under PWM.
//!
//! A path that the command requests is open a share of each period; the core's [`actual_duty_cycle`] says which, delays
//! and ramps included. A share of zero is a path that never opens, a share of one a path that never closes.

use super::{Parts, Warning};
use crate::quantities::given;
use mckibben::simulation::Actuation;
use mckibben::valve::{Command, Request, ValveKind, actual_duty_cycle};

/// A path that is open for this share of a period is open all the time: the shares of its intervals add up to one but for rounding.
const WHOLE: f64 = 1.0 - 1e-12;

pub(super) fn warnings(of: &Parts<'_>) -> Vec<Warning> {
    let valves = of.plant.network().valves.iter().zip(&of.valves);
    valves.filter_map(|(valve, name)| of_valve(valve, name)).collect()
}

fn of_valve(of: &Actuation, name: &str) -> Option<Warning> {
    let Command::Pwm { frequency, duty, pulse, rest } = of.command else { return None };
    let shares = actual_duty_cycle(&of.solenoid, &of.command)?;
    // What is commanded all the time is meant.
    if pulse == rest || duty <= 0.0 || duty >= 1.0 {
        return None;
    }
    let lasting = [duty, 1.0 - duty].map(|share| share / frequency);
    for (port, request, where_to) in [(0, Request::Fill, "supply"), (1, Request::Exhaust, "exhaust")] {
        let (requested, during_pulse) = match (pulse == request, rest == request) {
            (true, false) => (lasting[0], true),
            (false, true) => (lasting[1], false),
            _ => continue,
        };
        let (names, unasked) =
            if during_pulse { (["pulse", "pause"], lasting[1]) } else { (["pause", "pulse"], lasting[0]) };
        let [more, less] = if during_pulse { ["raise", "lower"] } else { ["lower", "raise"] };
        let [opens, closes] = delays(of, request);
        if shares[port] <= 0.0 {
            let text = format!(
                "the valve never opens to the {where_to}: a {} of {} is shorter than {} = {}; {more} command.duty or lower \
                 command.frequency",
                names[0],
                given(requested, "s"),
                opens.0,
                given(opens.1, "s"),
            );
            return Some(Warning::new("valve-never-opens", name, text));
        }
        if shares[port] >= WHOLE {
            let text = format!(
                "the valve never closes to the {where_to}: a {} of {} is shorter than {} = {}; {less} command.duty or lower \
                 command.frequency",
                names[1],
                given(unasked, "s"),
                closes.0,
                given(closes.1, "s"),
            );
            return Some(Warning::new("valve-never-closes", name, text));
        }
    }
    None
}

/// The delays after which the path of a request opens and closes, with their keys.
fn delays(of: &Actuation, request: Request) -> [(&'static str, f64); 2] {
    let [opening, closing] = of.solenoid.delays();
    let (energised, released) = (("valve.opening_delay", opening), ("valve.closing_delay", closing));
    let by_coil = match of.solenoid.kind() {
        ValveKind::TwoWay | ValveKind::ThreeWay => request == Request::Fill,
        ValveKind::ThreeWayNormallyOpen => request == Request::Exhaust,
        ValveKind::FillHoldExhaust => true,
    };
    if by_coil { [energised, released] } else { [released, energised] }
}
