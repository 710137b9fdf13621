//! What drives the actuator: supply, valve and command.
//!
//! A valve needs a supply and a command; a command needs a valve. `hold` and a choice of the states of a pulse need a
//! valve that can close.

use super::passage::{EXHAUST, SUPPLY, passage};
use super::{columns, controller, gauge_pressure, line};
use crate::choice::{CommandKind, CommandState, ExhaustTemperature, ValveKind, Word};
use crate::diagnostic::{Class, Diagnostic, Place};
use crate::keys::CONTROLLER;
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
    let own = SUPPLY.begun(|row| r.has(row.key));
    let exhaust = passage(r, &EXHAUST, preset.filter(|_| !own));
    let passage = passage(r, &SUPPLY, preset).unwrap_or_else(|| {
        if !misspelt {
            let because = "; `sonic_conductance` and `critical_ratio`, `kv` or `cv` would do as well";
            r.missing(p::FLOW_AREA.key, because);
        }
        Passage::FlowArea(1.0)
    });
    let efficiency = r.value(&p::EFFICIENCY, preset);
    let opening_delay = r.value(&p::OPENING_DELAY, preset);
    let closing_delay = r.value(&p::CLOSING_DELAY, preset);
    let laminar_ratio = r.value(&p::LAMINAR_RATIO, preset);
    let exhaust_temperature = r.word("valve.exhaust_temperature").unwrap_or(ExhaustTemperature::Actuator);
    Some(Valve {
        kind: kind?,
        passage,
        exhaust,
        efficiency,
        opening_delay,
        closing_delay,
        laminar_ratio,
        exhaust_temperature,
    })
}

fn command(r: &mut Reader<'_>, valve: ValveKind) -> Option<Command> {
    let kind: Option<CommandKind> = r.word("command.kind");
    if let Some(place) = r.key_place(CONTROLLER).filter(|_| kind.is_some_and(|kind| kind != CommandKind::Controllers)) {
        let title = "there is a [controller], but `command.kind` does not ask for it";
        r.note(
            Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                .related(r.value_place("command.kind"), "chosen here")
                .help("set `command.kind` to `controllers`, or remove the section"),
        );
    }
    if !r.has("command.kind") {
        r.missing("command.kind", "");
    }
    let chooses = valve.has_three_positions();
    let impossible = match valve {
        ValveKind::TwoWay => Some(CommandState::Exhaust),
        _ if chooses => None,
        _ => Some(CommandState::Hold),
    };
    match kind? {
        CommandKind::Pwm => {
            for path in ["command.pulse", "command.rest"] {
                if let Some(place) = r.key_place(path).filter(|_| !chooses) {
                    let title = format!("`{path}` is for a valve with a third position, such as fill-hold-exhaust");
                    let chosen = r.value_place("valve.kind");
                    let help = match valve {
                        ValveKind::TwoWay => {
                            "remove it: a two-way valve fills during the pulse and holds between pulses"
                        }
                        _ => "remove it: this valve fills during the pulse and exhausts between pulses",
                    };
                    r.note(
                        Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                            .related(chosen, "chosen here")
                            .help(help),
                    );
                }
            }
            let rest = if valve == ValveKind::TwoWay { CommandState::Hold } else { CommandState::Exhaust };
            Some(Command::Pwm {
                frequency: r.value(&p::PWM_FREQUENCY, None),
                duty: r.value(&p::DUTY, None),
                pulse: r.word("command.pulse").unwrap_or(CommandState::Fill),
                rest: r.word("command.rest").unwrap_or(rest),
            })
        }
        CommandKind::Fill => Some(Command::Constant(CommandState::Fill)),
        CommandKind::Exhaust => constant(r, CommandState::Exhaust, valve, impossible),
        CommandKind::Hold => constant(r, CommandState::Hold, valve, impossible),
        CommandKind::Table => {
            for path in [p::COMMAND_TIME.key, "command.state"] {
                if !r.has(path) {
                    r.missing(path, "");
                }
            }
            let time = r.list(&p::COMMAND_TIME);
            let state: Option<Vec<CommandState>> = r.words("command.state");
            let fault = state.iter().flatten().position(|state| Some(*state) == impossible);
            if let Some(place) = fault.and_then(|at| r.item_place("command.state", at)) {
                cannot(r, place, valve);
            }
            let (time, state) = columns(r, &p::COMMAND_TIME, time, "command.state", state);
            Some(Command::Table { time, state })
        }
        CommandKind::Controllers if !r.has(CONTROLLER) => {
            r.missing_section(CONTROLLER, Some("command"));
            None
        }
        CommandKind::Controllers => controller::controller(r).map(|of| Command::Controller(Box::new(of))),
    }
}

fn constant(
    r: &mut Reader<'_>,
    state: CommandState,
    valve: ValveKind,
    impossible: Option<CommandState>,
) -> Option<Command> {
    if let Some(place) = r.value_place("command.kind").filter(|_| Some(state) == impossible) {
        cannot(r, place, valve);
    }
    Some(Command::Constant(state))
}

/// Notes a state that the valve has not.
fn cannot(r: &mut Reader<'_>, place: Place, valve: ValveKind) {
    let chosen = r.value_place("valve.kind").or_else(|| r.value_place("valve.preset"));
    let (title, label, kind, help) = if valve == ValveKind::TwoWay {
        let help = "set `valve.kind` to `three-way` or `fill-hold-exhaust`, or command `fill` and `hold` only";
        ("a two-way valve cannot exhaust", "needs a passage to the exhaust", "two-way valve", help)
    } else if valve == ValveKind::FiveWay {
        let help = "set `valve.kind` to `five-way-closed`, or command `fill` and `exhaust` only";
        ("a 5/2 valve cannot hold", "needs a valve that closes", "five-way valve of two positions", help)
    } else {
        let help = "set `valve.kind` to `fill-hold-exhaust`, or command `fill` and `exhaust` only";
        ("a three-way valve cannot hold", "needs a valve that closes", "three-way valve", help)
    };
    r.note(Diagnostic::at(Class::NotApplicable, place, title, label).related(chosen, kind).help(help));
}
