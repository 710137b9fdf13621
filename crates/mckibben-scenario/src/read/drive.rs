//! What drives the actuator: supply, valve and command.
//!
//! A valve needs a supply and a command; a command needs a valve. `hold` and a choice of the states of a pulse need a
//! valve that can close.

use super::{alternative, columns, gauge_pressure, line};
use crate::choice::{CommandKind, CommandState, ExhaustTemperature, ValveKind, Word};
use crate::diagnostic::{Class, Diagnostic, Place};
use crate::presets;
use crate::reader::Reader;
use crate::scenario::{Air, Command, Passage, Supply, Valve};
use mckibben::parameter as p;

/// Supply, valve and command, which belong together.
pub(super) fn drive(r: &mut Reader<'_>, air: &Air) -> (Option<Supply>, Option<Valve>, Option<Command>) {
    let supply = r.has("supply").then(|| supply(r, air));
    let valve = r.has("valve").then(|| valve(r));
    if valve.is_some() && supply.is_none() {
        r.missing_section("supply", Some("valve"));
    }
    let command = match (valve.flatten(), r.key_place("command")) {
        (Some(valve), Some(_)) => command(r, valve.kind),
        (None, Some(place)) if valve.is_none() => {
            let title = "there is a [command] but no [valve], so nothing obeys it";
            r.note(
                Diagnostic::at(Class::NotApplicable, place, title, "commands no valve")
                    .help("add a section `[valve]`, or remove `[command]` to seal the actuator"),
            );
            None
        }
        (_, Some(_)) => command(r, ValveKind::FillHoldExhaust),
        (_, None) => {
            if valve.is_some() {
                r.missing_section("command", Some("valve"));
            }
            None
        }
    };
    (supply, valve.flatten(), command)
}

fn supply(r: &mut Reader<'_>, air: &Air) -> Supply {
    Supply {
        gauge_pressure: gauge_pressure(r, &p::SUPPLY_GAUGE_PRESSURE, air),
        temperature: r.value(&p::SUPPLY_TEMPERATURE, None),
        reservoir: line::reservoir(r, air),
        regulator: line::regulator(r),
        actuators: line::actuators(r),
    }
}

fn valve(r: &mut Reader<'_>) -> Option<Valve> {
    let preset = r.chosen("valve.preset", presets::VALVE_CHOICES).and_then(presets::valve);
    let misspelt = r.has("valve.preset") && preset.is_none();
    let kind = match preset.and_then(|preset| preset.word("valve.kind")) {
        Some(word) if !r.has("valve.kind") => ValveKind::from_name(word),
        _ => r.word("valve.kind"),
    };
    if kind.is_none() && !r.has("valve.kind") && !misspelt {
        r.missing("valve.kind", "");
    }
    let iso = [p::SONIC_CONDUCTANCE.key, p::CRITICAL_RATIO.key];
    let passage = match alternative(r, &[&[p::FLOW_AREA.key], &iso]) {
        Some(1) => Passage::Iso6358 {
            sonic_conductance: r.noted(&p::SONIC_CONDUCTANCE),
            critical_ratio: r.noted(&p::CRITICAL_RATIO),
        },
        None if misspelt => Passage::FlowArea(1.0),
        None if preset.is_none() => {
            let because = "; `sonic_conductance` and `critical_ratio` would do as well";
            r.missing(p::FLOW_AREA.key, because);
            Passage::FlowArea(1.0)
        }
        _ => Passage::FlowArea(r.value(&p::FLOW_AREA, preset)),
    };
    let efficiency = r.value(&p::EFFICIENCY, preset);
    let opening_delay = r.value(&p::OPENING_DELAY, preset);
    let closing_delay = r.value(&p::CLOSING_DELAY, preset);
    let laminar_ratio = r.value(&p::LAMINAR_RATIO, preset);
    let exhaust_temperature = r.word("valve.exhaust_temperature").unwrap_or(ExhaustTemperature::Actuator);
    Some(Valve { kind: kind?, passage, efficiency, opening_delay, closing_delay, laminar_ratio, exhaust_temperature })
}

fn command(r: &mut Reader<'_>, valve: ValveKind) -> Option<Command> {
    let kind: Option<CommandKind> = r.word("command.kind");
    if !r.has("command.kind") {
        r.missing("command.kind", "");
    }
    let three_way = valve == ValveKind::ThreeWay;
    match kind? {
        CommandKind::Pwm => {
            for path in ["command.pulse", "command.rest"] {
                if let Some(place) = r.key_place(path).filter(|_| three_way) {
                    let title = format!("`{path}` is for a fill-hold-exhaust valve");
                    let chosen = r.value_place("valve.kind");
                    r.note(
                        Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                            .related(chosen, "chosen here")
                            .help("remove it: a three-way valve fills during the pulse and exhausts between pulses"),
                    );
                }
            }
            Some(Command::Pwm {
                frequency: r.value(&p::PWM_FREQUENCY, None),
                duty: r.value(&p::DUTY, None),
                pulse: r.word("command.pulse").unwrap_or(CommandState::Fill),
                rest: r.word("command.rest").unwrap_or(CommandState::Exhaust),
            })
        }
        CommandKind::Fill => Some(Command::Constant(CommandState::Fill)),
        CommandKind::Exhaust => Some(Command::Constant(CommandState::Exhaust)),
        CommandKind::Hold => {
            if let Some(place) = r.value_place("command.kind").filter(|_| three_way) {
                cannot_hold(r, place);
            }
            Some(Command::Constant(CommandState::Hold))
        }
        CommandKind::Table => {
            for path in [p::COMMAND_TIME.key, "command.state"] {
                if !r.has(path) {
                    r.missing(path, "");
                }
            }
            let time = r.list(&p::COMMAND_TIME);
            let state: Option<Vec<CommandState>> = r.words("command.state");
            let hold = state.iter().flatten().position(|state| *state == CommandState::Hold);
            if let Some(place) = hold.filter(|_| three_way).and_then(|at| r.item_place("command.state", at)) {
                cannot_hold(r, place);
            }
            let (time, state) = columns(r, &p::COMMAND_TIME, time, "command.state", state);
            Some(Command::Table { time, state })
        }
    }
}

fn cannot_hold(r: &mut Reader<'_>, place: Place) {
    let chosen = r.value_place("valve.kind").or_else(|| r.value_place("valve.preset"));
    r.note(
        Diagnostic::at(Class::NotApplicable, place, "a three-way valve cannot hold", "needs a valve that closes")
            .related(chosen, "three-way valve")
            .help("set `valve.kind` to `fill-hold-exhaust`, or command `fill` and `exhaust` only"),
    );
}
