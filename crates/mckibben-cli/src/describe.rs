//! A scenario in a few words.

use mckibben::control::Quantity;
use mckibben_run::quantities::{counted, digits, given, given_percent, plain};
use mckibben_scenario::{
    Aim, Command, CommandState, Controller, Engine, Load, Method, Motion, Muscle, PressurePlace, Process, Regulator,
    Run, Scenario, ValveKind,
};

/// The muscles of a file by their names, those of equal braids together.
pub fn muscles(muscles: &[(String, Muscle)]) -> Vec<(String, String)> {
    let mut lines: Vec<(String, String)> = Vec::new();
    for (name, its) in muscles {
        let text = muscle(its);
        match lines.iter_mut().find(|(_, known)| *known == text) {
            Some((names, _)) => {
                names.push_str(", ");
                names.push_str(name);
            }
            None => lines.push((name.clone(), text)),
        }
    }
    lines
}

/// The braid of a muscle: its thread, and what that makes at rest or, where nothing is said of rest, where the braid is taut.
fn muscle(of: &Muscle) -> String {
    let turns = if of.turns == 1.0 { "turn" } else { "turns" };
    let thread = format!("thread of {}, {} {turns}", given(of.thread_length, "m"), plain(&digits(of.turns)));
    let angle = given(of.braid_angle, "rad");
    let (length, diameter) = (given(of.length, "m"), given(of.diameter, "m"));
    let shape = format!("{length} long, {diameter} wide, braid angle {angle}");
    if !of.is_at_rest() {
        return format!("{thread}; taut {shape}");
    }
    let names: Vec<&str> = of.stated().filter_map(|row| row.key.rsplit('.').next()).collect();
    format!("{thread}; at rest {shape} (from {})", names.join(", "))
}

/// What the actuator pulls on.
pub fn load(load: &Load) -> String {
    match load {
        Load::HangingMass { mass, gravity } => {
            format!("hanging mass of {} ({})", given(*mass, "kg"), given(mass * gravity, "N"))
        }
        Load::ConstantForce { force, mass } => {
            format!("constant force of {} on {}", given(*force, "N"), given(*mass, "kg"))
        }
        Load::Isometric => "isometric".to_owned(),
        Load::PrescribedMotion(Motion::Sinusoid { amplitude, frequency, .. }) => {
            format!("prescribed motion, ±{} at {}", given(*amplitude, "m"), given(*frequency, "Hz"))
        }
        Load::PrescribedMotion(Motion::Table { time, .. }) => {
            format!("prescribed motion, table of {}", counted(time.len() as u64, "point"))
        }
        Load::AntagonisticJoint(joint) => {
            format!("antagonistic joint, limb of {} at {}", given(joint.mass, "kg"), given(joint.distance, "m"))
        }
    }
}

/// What drives the valve, or that there is none.
pub fn drive(scenario: &Scenario) -> String {
    if let Some(series) = &scenario.pressure {
        let place = if series.at == PressurePlace::Hose { " at the end of the hose" } else { "" };
        return format!("pressure{place} given at {}", counted(series.time.len() as u64, "instant"));
    }
    let (Some(valve), Some(command), Some(supply)) = (&scenario.valve, &scenario.command, &scenario.supply) else {
        return "sealed, no valve".to_owned();
    };
    let command = match command {
        Command::Pwm { frequency, duty, pulse, rest } => {
            let states = match (pulse, rest) {
                (CommandState::Fill, CommandState::Exhaust) => String::new(),
                (pulse, rest) => format!(" between {} and {}", pulse.name(), rest.name()),
            };
            format!("PWM of {} at {} duty{states}", given(*frequency, "Hz"), given_percent(*duty))
        }
        Command::Constant(state) => format!("{} all the time", state.name()),
        Command::SetPoints { time, .. } => counted(time.len() as u64, "set point"),
        Command::Positions { time, .. } => counted(time.len() as u64, "position"),
        Command::Table { time, .. } => format!("table of {}", counted(time.len() as u64, "command")),
        Command::Controller(of) => controller(of),
    };
    let supply = given(supply.gauge_pressure, "Pa");
    let kind = match valve.kind {
        ValveKind::PressureRegulator => "pressure regulator".to_owned(),
        ValveKind::ProportionalSpool => "proportional spool".to_owned(),
        seats => format!("{} valve", seats.name()),
    };
    format!("{kind}, {command}, supply at {supply} gauge")
}

/// What a controller does, and how often.
fn controller(of: &Controller) -> String {
    let regulator = match of.regulator {
        Regulator::Relay { .. } => "bang-bang",
        Regulator::Pid { .. } => "PID",
    };
    let regulated = controlled(of.aim.regulated());
    let by_model = match of.aim {
        Aim::Track { .. } => "",
        Aim::Model { .. } | Aim::Joint { .. } => " by the static model",
    };
    let delay = match of.delay {
        0 => String::new(),
        1 => ", one sample late".to_owned(),
        many => format!(", {many} samples late"),
    };
    format!("{regulator} control of {regulated}{by_model} at {}{delay}", given(of.rate, "Hz"))
}

/// What can be controlled, by its name.
pub fn controlled(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Pressure => "gauge pressure",
        Quantity::Length => "length",
        Quantity::AirMass => "mass of air",
        Quantity::Force => "tension",
        Quantity::Angle => "angle",
        Quantity::Torque => "torque",
        Quantity::Stiffness => "stiffness",
    }
}

/// The process of the air.
pub fn air(process: &Process) -> String {
    match process {
        Process::Isentropic => "isentropic".to_owned(),
        Process::Isothermal => "isothermal".to_owned(),
        Process::Polytropic { index } => format!("polytropic, index {index}"),
        Process::EnergyBalance { heat_transfer, .. } => {
            format!("energy balance, heat transfer {}", given(*heat_transfer, "W/K"))
        }
    }
}

/// The engine with what steers it.
pub fn engine(run: &Run) -> String {
    match (run.engine, run.method) {
        (Engine::EventLocated, _) => format!("event-located, relative tolerance {:e}", run.relative_tolerance),
        (Engine::FixedStep, method) => {
            let name = match method {
                Method::Stable => "stable method",
                Method::Rk4 => "Runge-Kutta 4",
            };
            format!("fixed-step, {name}")
        }
    }
}
