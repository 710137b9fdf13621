//! What drives the actuator: supply, valve and command.
//!
//! A valve needs a supply and a command; a command needs a valve. `hold` and a choice of the states of a pulse need a
//! valve that can close.

use super::flow_path::{EXHAUST, Rows, SUPPLY, flow_path};
use super::{columns, controller, gauge_pressure, line};
use crate::choice::{CommandKind, CommandState, ExhaustTemperature, ValveKind, Word};
use crate::diagnostic::{Class, Diagnostic, Place};
use crate::keys::CONTROLLER;
use crate::presets::{self, Preset};
use crate::reader::Reader;
use crate::scenario::{Air, Command, FlowPath, ProportionalRegulator, Spool, Supply, Valve};
use mckibben::parameter::{self as p, Parameter};

/// Keys of a valve with seats.
pub(crate) const SEATS: &[&str] =
    &[p::OPENING_DELAY.key, p::CLOSING_DELAY.key, p::OPENING_TIME.key, p::CLOSING_TIME.key];

/// Supply, valve and command, which belong together.
pub(super) fn drive(r: &mut Reader<'_>, air: &Air) -> (Option<Supply>, Option<Valve>, Option<Command>) {
    let supply = r.has("supply").then(|| supply(r, air));
    let valve = r.has("valve").then(|| valve(r));
    if valve.is_some() && supply.is_none() {
        r.missing_section("supply", Some("valve"));
    }
    let feeds = supply.as_ref().map(|supply| supply.gauge_pressure);
    let command = match (valve.flatten(), r.key_place("command")) {
        (Some(valve), Some(_)) => command(r, valve.kind, feeds),
        (None, Some(place)) if valve.is_none() => {
            let title = "there is a [command] but no [valve], so nothing obeys it";
            r.note(
                Diagnostic::at(Class::NotApplicable, place, title, "commands no valve")
                    .help("add a section `[valve]`, or remove `[command]` to seal the actuator"),
            );
            None
        }
        (_, Some(_)) => command(r, ValveKind::FillHoldExhaust, feeds),
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
    if let Some(preset) = preset {
        check_reaches(r, preset);
    }
    let own = SUPPLY.begun(|row| r.has(row.key));
    let exhaust = flow_path(r, &EXHAUST, preset.filter(|_| !own));
    let flow_path = flow_path(r, &SUPPLY, preset).unwrap_or_else(|| {
        if !misspelt {
            let because = "; `sonic_conductance` and `critical_ratio`, `kv` or `cv` would do as well";
            r.missing(p::FLOW_AREA.key, because);
        }
        FlowPath::FlowArea(1.0)
    });
    let efficiency = r.value(&p::EFFICIENCY, preset);
    let regulator = (kind == Some(ValveKind::PressureRegulator)).then(|| regulator(r));
    let spool = (kind == Some(ValveKind::ProportionalSpool)).then(|| spool(r));
    if regulator.is_none() && !r.has("valve.kind") {
        of_regulator_only(r);
    }
    let dead_time = r.value(&p::VALVE_DEAD_TIME, preset);
    let opening_delay = r.value(&p::OPENING_DELAY, preset);
    let closing_delay = r.value(&p::CLOSING_DELAY, preset);
    let opening_time = r.value(&p::OPENING_TIME, preset);
    let closing_time = r.value(&p::CLOSING_TIME, preset);
    let laminar_ratio = r.value(&p::LAMINAR_RATIO, preset);
    let exhaust_temperature = r.word("valve.exhaust_temperature").unwrap_or(ExhaustTemperature::Actuator);
    Some(Valve {
        kind: kind?,
        flow_path,
        exhaust,
        efficiency,
        regulator,
        spool,
        dead_time,
        opening_delay,
        closing_delay,
        opening_time,
        closing_time,
        laminar_ratio,
        exhaust_temperature,
    })
}

/// Notes a preset that a user sets in addition to the file, as by `--set`, and of which the file replaces every value.
fn check_reaches(r: &mut Reader<'_>, preset: &Preset) {
    let Some(key) = r.key_place("valve.preset").filter(|place| place.source().is_setting()) else { return };
    let begun = |rows: &Rows| rows.begun(|row| r.has(row.key));
    // A flow path is replaced as a whole, and that to the supply replaces the exhaust of a preset too.
    let (own, exhaust) = (begun(&SUPPLY), begun(&EXHAUST));
    let is_replaced = |row: &Parameter| {
        r.has(row.key) || (own && (SUPPLY.has(row) || EXHAUST.has(row))) || (exhaust && EXHAUST.has(row))
    };
    let of_values = preset.values.iter().all(|value| is_replaced(value.parameter));
    if of_values && preset.words.iter().all(|(path, _)| r.has(path)) {
        let title =
            format!("`valve.preset` = \"{}\" is set, and the file states every value that it gives", preset.name);
        let help = "leave it out, or remove from [valve] in the file the values that the preset is to give";
        r.note(Diagnostic::at(Class::NotApplicable, key, title, "reaches nothing").help(help));
    }
}

/// Notes what only a pressure regulator has, where a preset says that the valve is another.
fn of_regulator_only(r: &mut Reader<'_>) {
    for row in [&p::REGULATOR_TIME_CONSTANT, &p::REGULATOR_RATE_LIMIT] {
        if let Some(place) = r.key_place(row.key) {
            let title = format!("`{}` is for a pressure regulator", row.key);
            r.note(
                Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                    .related(r.value_place("valve.preset"), "chosen here")
                    .help("set `valve.kind` to `pressure-regulator`, or remove it"),
            );
        }
    }
}

/// Notes keys that do not apply to a kind of valve.
fn not_of(r: &mut Reader<'_>, paths: &[&str], kind: &str, help: &str) {
    for path in paths {
        if let Some(place) = r.key_place(path) {
            let title = format!("`{path}` does not apply to {kind}");
            r.note(
                Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                    .related(r.value_place("valve.kind"), "chosen here")
                    .help(help),
            );
        }
    }
}

/// A proportional spool has no seats.
fn spool(r: &mut Reader<'_>) -> Spool {
    not_of(
        r,
        SEATS,
        "a proportional spool, which has no seats",
        "remove it; what is slow in a spool is its own motion, and what is late is `valve.dead_time`",
    );
    Spool {
        natural_frequency: r.value(&p::SPOOL_FREQUENCY, None),
        damping_ratio: r.value(&p::SPOOL_DAMPING_RATIO, None),
        supply_overlap: r.value(&p::SUPPLY_OVERLAP, None),
        exhaust_overlap: r.value(&p::EXHAUST_OVERLAP, None),
    }
}

/// A pressure regulator has no seats, and one flow path.
fn regulator(r: &mut Reader<'_>) -> ProportionalRegulator {
    let (kind, help) = (
        "a pressure regulator, which has no seats and one flow path",
        "remove it; the delay of a regulator is `valve.dead_time`",
    );
    not_of(r, SEATS, kind, help);
    not_of(r, &["valve.exhaust"], kind, help);
    ProportionalRegulator {
        time_constant: r.value(&p::REGULATOR_TIME_CONSTANT, None),
        rate_limit: r.value(&p::REGULATOR_RATE_LIMIT, None),
    }
}

fn command(r: &mut Reader<'_>, valve: ValveKind, supply: Option<f64>) -> Option<Command> {
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
    let without_seats = [CommandKind::SetPoints, CommandKind::Positions];
    let own = match valve {
        ValveKind::PressureRegulator => Some(CommandKind::SetPoints),
        ValveKind::ProportionalSpool => Some(CommandKind::Positions),
        _ => None,
    };
    if kind.is_some_and(|kind| own.is_some_and(|own| own != kind) || (own.is_none() && without_seats.contains(&kind))) {
        wrong_kind(r, own, kind);
        return None;
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
        CommandKind::SetPoints => {
            for path in [p::COMMAND_TIME.key, p::COMMAND_GAUGE_PRESSURE.key] {
                if !r.has(path) {
                    r.missing(path, "");
                }
            }
            let (time, gauges) = (r.list(&p::COMMAND_TIME), r.list(&p::COMMAND_GAUGE_PRESSURE));
            within_supply(r, gauges.as_deref(), supply);
            let (time, gauge_pressure) = columns(r, &p::COMMAND_TIME, time, p::COMMAND_GAUGE_PRESSURE.key, gauges);
            Some(Command::SetPoints { time, gauge_pressure })
        }
        CommandKind::Positions => {
            for path in [p::COMMAND_TIME.key, p::COMMAND_POSITION.key] {
                if !r.has(path) {
                    r.missing(path, "");
                }
            }
            let (time, position) = (r.list(&p::COMMAND_TIME), r.list(&p::COMMAND_POSITION));
            let (time, position) = columns(r, &p::COMMAND_TIME, time, p::COMMAND_POSITION.key, position);
            Some(Command::Positions { time, position })
        }
        CommandKind::Controllers if !r.has(CONTROLLER) => {
            r.missing_section(CONTROLLER, Some("command"));
            None
        }
        CommandKind::Controllers => controller::controller(r).map(|of| Command::Controller(Box::new(of))),
    }
}

/// Notes a command that the kind of valve does not take.
fn wrong_kind(r: &mut Reader<'_>, own: Option<CommandKind>, kind: Option<CommandKind>) {
    let Some(place) = r.value_place("command.kind") else { return };
    let chosen = r.value_place("valve.kind").or_else(|| r.value_place("valve.preset"));
    let (title, label, help) = if own == Some(CommandKind::Positions) {
        (
            "a proportional spool takes positions",
            "commands something else",
            "set `command.kind` to `positions`, or `valve.kind` to `three-way`",
        )
    } else if kind == Some(CommandKind::Positions) {
        (
            "positions are for a proportional spool",
            "needs a proportional spool",
            "set `valve.kind` to `proportional-spool`, or `command.kind` to what the valve takes",
        )
    } else if own == Some(CommandKind::SetPoints) {
        (
            "a pressure regulator takes set points of pressure",
            "commands seats to move",
            "set `command.kind` to `set-points`, or `valve.kind` to `three-way`",
        )
    } else {
        (
            "set points of pressure are for a pressure regulator",
            "needs a pressure regulator",
            "set `valve.kind` to `pressure-regulator`; to regulate the pressure by a valve with seats, set `command.kind` \
             to `controllers`",
        )
    };
    r.note(Diagnostic::at(Class::NotApplicable, place, title, label).related(chosen, "the valve").help(help));
}

/// Notes the first set point beyond the supply.
fn within_supply(r: &mut Reader<'_>, gauges: Option<&[f64]>, supply: Option<f64>) {
    let (Some(gauges), Some(supply)) = (gauges, supply) else { return };
    let beyond = gauges.iter().position(|gauge| *gauge > supply);
    if let Some(place) = beyond.and_then(|at| r.item_place(p::COMMAND_GAUGE_PRESSURE.key, at)) {
        let title = "a regulator cannot give more than feeds it";
        r.note(
            Diagnostic::at(Class::Inconsistent, place, title, "beyond the supply")
                .related(r.value_place(p::SUPPLY_GAUGE_PRESSURE.key), "the supply")
                .help("lower the set point, or raise `supply.gauge_pressure`"),
        );
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
        ("a two-way valve cannot exhaust", "needs a flow path to the exhaust", "two-way valve", help)
    } else if valve == ValveKind::FiveWay {
        let help = "set `valve.kind` to `five-way-closed`, or command `fill` and `exhaust` only";
        ("a 5/2 valve cannot hold", "needs a valve that closes", "five-way valve of two positions", help)
    } else {
        let help = "set `valve.kind` to `fill-hold-exhaust`, or command `fill` and `exhaust` only";
        ("a three-way valve cannot hold", "needs a valve that closes", "three-way valve", help)
    };
    r.note(Diagnostic::at(Class::NotApplicable, place, title, label).related(chosen, kind).help(help));
}
