//! Writes a scenario as a file: every value in SI with its unit, nothing left to a preset or a default.
//!
//! The text reads back to an equal [`Scenario`], bit for bit: numbers are written in the shortest digits that
//! identify them, in units of size 1. Checked by `tests/scenario.rs`.

mod document;

use crate::choice::{
    BladderForm, CommandKind, ControllerKind, ForceLaw, HoseKind, HysteresisLaw, LoadKind, ProcessKind, SetPointTable,
};
use crate::keys::{BALANCED, EQUILIBRIUM, PRESSURE_AT};
use crate::quantity;
use crate::read::flow_path;
use crate::scenario::{
    Actuator, Aim, Command, Controller, Effectiveness, FlowPath, Force, Friction, Hysteresis, InitialAngle,
    InitialLength, Load, MomentArm, Motion, Process, Regulator, Scenario, Supply, Tendon, Viscoelastic,
};
use mckibben::control::{Quantity, SetPoint};
use mckibben::parameter::{self as p, Parameter};
use std::fmt::Write;

/// A file in the making: sections with the keys that are written into them.
#[derive(Default)]
struct Writer {
    text: String,
    section: String,
    /// What stands before every path, with its point.
    prefix: &'static str,
    /// Whether the engine is left to what reads the file.
    leaves_engine: bool,
}

impl Writer {
    /// Writes a line at a path, after the header of its section when that is a new one.
    fn line(&mut self, path: &str, value: &str) {
        let path = format!("{}{path}", self.prefix);
        let (section, name) = path.rsplit_once('.').unwrap_or(("", &path));
        if section != self.section {
            let gap = if self.text.is_empty() { "" } else { "\n" };
            self.put(format_args!("{gap}[{section}]\n"));
            section.clone_into(&mut self.section);
        }
        self.put(format_args!("{name} = {value}\n"));
    }

    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(text);
    }

    fn number(&mut self, row: &Parameter, value: f64) {
        self.line(row.key, &literal(row, value));
    }

    fn list(&mut self, row: &Parameter, values: &[f64]) {
        let items: Vec<String> = values.iter().map(|value| literal(row, *value)).collect();
        self.line(row.key, &format!("[{}]", items.join(", ")));
    }

    fn word(&mut self, path: &str, word: &str) {
        self.line(path, &format!("\"{word}\""));
    }
}

/// A value as TOML: a string with the unit, or a number.
fn literal(row: &Parameter, value: f64) -> String {
    // The debug form always has a point or an exponent, which TOML wants of a float.
    if row.unit.is_empty() { format!("{value:?}") } else { format!("\"{}\"", quantity::format(value, row.unit)) }
}

impl Scenario {
    /// The scenario as the text of a file, every value in SI.
    pub fn to_toml(&self) -> String {
        self.written(Writer::default())
    }

    fn written(&self, mut writer: Writer) -> String {
        let w = &mut writer;
        actuator(w, self);
        air(w, self);
        supply(w, self);
        drive(w, self);
        load(w, &self.load);
        initial_and_run(w, self);
        if let (Load::AntagonisticJoint(joint), Some(second)) = (&self.load, self.of_antagonist()) {
            w.prefix = "antagonist.";
            actuator(w, &second);
            if !self.shares_supply() {
                supply(w, &second);
            }
            drive(w, &second);
            tendon(w, &joint.antagonist.tendon);
            if let Some(gauge_pressure) = second.initial.gauge_pressure {
                w.number(&p::INITIAL_GAUGE_PRESSURE, gauge_pressure);
            }
            w.number(&p::INITIAL_TEMPERATURE, second.initial.temperature);
        }
        writer.text
    }
}

fn actuator(w: &mut Writer, scenario: &Scenario) {
    let actuator = &scenario.actuator;
    w.number(&p::THREAD_LENGTH, actuator.thread_length);
    w.number(&p::TURNS, actuator.turns);
    w.number(&p::MAX_LENGTH, actuator.max_length);
    w.number(&p::MIN_LENGTH, actuator.min_length);
    w.number(&p::EXTERNAL_VOLUME, actuator.external_volume);
    if let Some(leakage) = actuator.leakage {
        w.number(&p::LEAKAGE, leakage);
    }
    w.number(&p::WALL_THICKNESS, actuator.wall_thickness);
    force(w, actuator);
    match &actuator.effectiveness {
        Effectiveness::Constant(ratio) => w.number(&p::EFFECTIVENESS, *ratio),
        Effectiveness::Polynomial(coefficients) => {
            w.list(&p::EFFECTIVENESS_POLYNOMIAL, coefficients);
            w.word("actuator.effectiveness.pressure_unit", "Pa");
        }
        Effectiveness::Table { gauge_pressure, value } => {
            w.list(&p::EFFECTIVENESS_PRESSURE, gauge_pressure);
            w.list(&p::EFFECTIVENESS_VALUE, value);
        }
    }
    friction(w, &actuator.friction);
    w.number(&p::LIMIT_STIFFNESS, actuator.limit.stiffness);
    w.number(&p::LIMIT_DAMPING, actuator.limit.damping);
}

fn friction(w: &mut Writer, friction: &Friction) {
    w.number(&p::VISCOUS, friction.viscous);
    w.number(&p::STRUCTURAL_DAMPING, friction.structural_damping);
    w.number(&p::COULOMB_WIDTH, friction.coulomb_width);
    w.number(&p::COULOMB_FORCE, friction.coulomb_force);
    w.number(&p::COULOMB_FORCE_PER_PRESSURE, friction.coulomb_force_per_pressure);
    w.number(&p::STATIC_RATIO, friction.static_ratio);
    w.number(&p::STRIBECK_VELOCITY, friction.stribeck_velocity);
    match &friction.hysteresis {
        Some(Hysteresis::MaxwellSlip { reach, stiffness_ratio }) => {
            w.word("actuator.friction.hysteresis.law", HysteresisLaw::MaxwellSlip.name());
            w.list(&p::HYSTERESIS_REACH, reach);
            w.list(&p::HYSTERESIS_STIFFNESS_RATIO, stiffness_ratio);
        }
        Some(Hysteresis::BoucWen { width, beta, gamma }) => {
            w.word("actuator.friction.hysteresis.law", HysteresisLaw::BoucWen.name());
            w.number(&p::HYSTERESIS_WIDTH, *width);
            w.number(&p::HYSTERESIS_BETA, *beta);
            w.number(&p::HYSTERESIS_GAMMA, *gamma);
        }
        Some(Hysteresis::LuGre { width, reach, static_ratio, stribeck_velocity, damping_time }) => {
            w.word("actuator.friction.hysteresis.law", HysteresisLaw::LuGre.name());
            w.number(&p::HYSTERESIS_WIDTH, *width);
            w.number(&p::BRISTLE_REACH, *reach);
            w.number(&p::BRISTLE_STATIC_RATIO, *static_ratio);
            w.number(&p::BRISTLE_STRIBECK_VELOCITY, *stribeck_velocity);
            w.number(&p::BRISTLE_DAMPING_TIME, *damping_time);
        }
        None => {}
    }
    if let Some(Viscoelastic { relaxation_time, stiffness, stiffness_ratio, initial_stretch }) = &friction.viscoelastic
    {
        w.list(&p::BRANCH_RELAXATION_TIME, relaxation_time);
        for (row, list) in [
            (&p::BRANCH_STIFFNESS, stiffness),
            (&p::BRANCH_STIFFNESS_RATIO, stiffness_ratio),
            (&p::BRANCH_INITIAL_STRETCH, initial_stretch),
        ] {
            if !list.is_empty() {
                w.list(row, list);
            }
        }
    }
}

fn force(w: &mut Writer, actuator: &Actuator) {
    let law = match &actuator.force {
        Force::IdealBraid => ForceLaw::IdealBraid,
        Force::TonduLopez { .. } => ForceLaw::TonduLopez,
        Force::Sarosi(_) => ForceLaw::Sarosi,
        Force::MartensBoblan { .. } => ForceLaw::MartensBoblan,
        Force::ExtensibleBraid { .. } => ForceLaw::ExtensibleBraid,
        Force::Bolen { .. } => ForceLaw::Bolen,
        Force::Polynomial { .. } => ForceLaw::Polynomial,
        Force::Map { .. } => ForceLaw::Map,
    };
    w.word("actuator.force.law", law.name());
    match &actuator.force {
        Force::IdealBraid => {}
        Force::TonduLopez { end_factor, end_factor_rise, end_factor_pressure, coefficients } => {
            w.number(&p::END_FACTOR, *end_factor);
            w.number(&p::END_FACTOR_RISE, *end_factor_rise);
            w.number(&p::END_FACTOR_PRESSURE, *end_factor_pressure);
            if let Some(given) = coefficients {
                w.number(&p::INITIAL_RADIUS, given.radius);
                w.number(&p::TONDU_LOPEZ_A, given.a);
                w.number(&p::TONDU_LOPEZ_B, given.b);
            }
        }
        Force::Sarosi(coefficients) => {
            w.list(&p::SAROSI_COEFFICIENTS, coefficients);
            w.word("actuator.force.pressure_unit", "Pa");
            w.word("actuator.force.force_unit", "N");
        }
        Force::MartensBoblan { membrane_thickness, modulus } => {
            w.number(&p::MEMBRANE_THICKNESS, *membrane_thickness);
            w.list(&p::MEMBRANE_MODULUS, modulus);
            w.word("actuator.force.modulus_unit", "Pa");
            w.word("actuator.force.length_unit", "m");
        }
        Force::ExtensibleBraid { thread_stiffness } => w.number(&p::THREAD_STIFFNESS, *thread_stiffness),
        Force::Bolen { max_force, max_pressure, max_contraction, shape } => {
            w.number(&p::MAX_FORCE, *max_force);
            w.number(&p::MAX_PRESSURE, *max_pressure);
            w.number(&p::MAX_CONTRACTION, *max_contraction);
            w.list(&p::BOLEN_SHAPE, shape);
        }
        Force::Polynomial { pressure, passive } => {
            w.list(&p::PRESSURE_COEFFICIENTS, pressure);
            if !passive.is_empty() {
                w.list(&p::PASSIVE_COEFFICIENTS, passive);
            }
            w.word("actuator.force.pressure_unit", "Pa");
            w.word("actuator.force.force_unit", "N");
        }
        Force::Map { gauge_pressure, length, tension } => {
            w.list(&p::MAP_PRESSURE, gauge_pressure);
            w.list(&p::MAP_LENGTH, length);
            w.list(&p::MAP_TENSION, tension);
        }
    }
    if let Some(taper) = actuator.taper {
        w.number(&p::TAPER_END_RADIUS, taper.end_radius);
        w.number(&p::TAPER_LENGTH_RATIO, taper.length_ratio);
    }
    if let Some(bladder) = &actuator.bladder {
        w.word("actuator.bladder.form", bladder.form.name());
        w.number(&p::BLADDER_FORCE, bladder.force);
        if bladder.form != BladderForm::Linear {
            w.number(&p::BLADDER_SCALE, bladder.scale);
        }
    }
}

fn air(w: &mut Writer, scenario: &Scenario) {
    let air = &scenario.air;
    let kind = match air.process {
        Process::Isentropic => ProcessKind::Isentropic,
        Process::Isothermal => ProcessKind::Isothermal,
        Process::Polytropic { .. } => ProcessKind::Polytropic,
        Process::EnergyBalance { .. } => ProcessKind::EnergyBalance,
    };
    w.word("air.process", kind.name());
    match air.process {
        Process::Isentropic | Process::Isothermal => {}
        Process::Polytropic { index } => w.number(&p::POLYTROPIC_INDEX, index),
        Process::EnergyBalance { heat_transfer, wall_temperature } => {
            w.number(&p::HEAT_TRANSFER, heat_transfer);
            w.number(&p::WALL_TEMPERATURE, wall_temperature);
        }
    }
    w.number(&p::ATMOSPHERIC_PRESSURE, air.atmospheric_pressure);
    w.number(&p::GAS_CONSTANT, air.gas_constant);
    w.number(&p::HEAT_CAPACITY_RATIO, air.heat_capacity_ratio);
}

fn supply(w: &mut Writer, scenario: &Scenario) {
    if let Some(supply) = &scenario.supply {
        w.number(&p::SUPPLY_GAUGE_PRESSURE, supply.gauge_pressure);
        w.number(&p::SUPPLY_TEMPERATURE, supply.temperature);
        supply_line(w, supply);
    }
}

/// Everything else that makes the pressure, and the tendon that takes the force.
fn drive(w: &mut Writer, scenario: &Scenario) {
    valve(w, scenario);
    hose(w, scenario);
    command(w, scenario);
    if let Some(series) = &scenario.pressure {
        w.word(PRESSURE_AT, series.at.name());
        w.list(&p::SERIES_TIME, &series.time);
        w.list(&p::SERIES_GAUGE_PRESSURE, &series.gauge_pressure);
        w.number(&p::SERIES_OFFSET, series.sensor.offset);
        w.number(&p::SERIES_SCALE, series.sensor.scale);
        w.number(&p::SERIES_SHIFT, series.sensor.shift);
    }
    series_tendon(w, scenario);
}

fn supply_line(w: &mut Writer, supply: &Supply) {
    if let Some(reservoir) = &supply.reservoir {
        w.number(&p::RESERVOIR_VOLUME, reservoir.volume);
        if let Some(start) = reservoir.gauge_pressure {
            w.number(&p::RESERVOIR_PRESSURE, start);
        }
        w.number(&p::RESERVOIR_INDEX, reservoir.polytropic_index);
        if let Some(compressor) = &reservoir.compressor {
            w.number(&p::DISPLACEMENT, compressor.displacement);
            w.number(&p::CLEARANCE, compressor.clearance);
            w.number(&p::CUT_IN, compressor.cut_in);
            w.number(&p::CUT_OUT, compressor.cut_out);
        }
    }
    if let Some(regulator) = &supply.regulator {
        w.number(&p::LAG, regulator.lag);
        w.number(&p::DROOP, regulator.droop);
        w.number(&p::DEAD_BAND, regulator.dead_band);
    }
    w.number(&p::ACTUATORS, supply.actuators);
}

fn hose(w: &mut Writer, scenario: &Scenario) {
    let Some(hose) = &scenario.hose else { return };
    w.word("hose.kind", hose.kind.name());
    w.number(&p::HOSE_LENGTH, hose.length);
    w.number(&p::HOSE_DIAMETER, hose.diameter);
    w.number(&p::HOSE_VISCOSITY, hose.viscosity);
    w.number(&p::HOSE_INDEX, hose.polytropic_index);
    if hose.kind == HoseKind::Distributed {
        w.line(p::HOSE_CELLS.key, &hose.cells.to_string());
    }
}

fn series_tendon(w: &mut Writer, scenario: &Scenario) {
    let Some(tendon) = &scenario.tendon else { return };
    w.number(&p::TENDON_STIFFNESS, tendon.stiffness);
    w.number(&p::TENDON_REST_LENGTH, tendon.rest_length);
}

fn tendon(w: &mut Writer, tendon: &Tendon) {
    match &tendon.arm {
        MomentArm::Pulley(radius) => w.number(&p::PULLEY_RADIUS, *radius),
        MomentArm::Table { angle, arm } => {
            w.list(&p::MOMENT_ARM_ANGLE, angle);
            w.list(&p::MOMENT_ARM, arm);
        }
    }
    w.number(&p::REST_LENGTH, tendon.rest_length);
}

fn valve(w: &mut Writer, scenario: &Scenario) {
    let Some(valve) = &scenario.valve else { return };
    w.word("valve.kind", valve.kind.name());
    flow_path(w, &flow_path::SUPPLY, valve.flow_path);
    w.number(&p::EFFICIENCY, valve.efficiency);
    w.number(&p::VALVE_DEAD_TIME, valve.dead_time);
    match valve.regulator {
        Some(regulator) => {
            w.number(&p::REGULATOR_TIME_CONSTANT, regulator.time_constant);
            w.number(&p::REGULATOR_RATE_LIMIT, regulator.rate_limit);
        }
        None if valve.spool.is_some() => {}
        None => {
            w.number(&p::OPENING_DELAY, valve.opening_delay);
            w.number(&p::CLOSING_DELAY, valve.closing_delay);
            w.number(&p::OPENING_TIME, valve.opening_time);
            w.number(&p::CLOSING_TIME, valve.closing_time);
        }
    }
    w.number(&p::LAMINAR_RATIO, valve.laminar_ratio);
    w.word("valve.exhaust_temperature", valve.exhaust_temperature.name());
    if let Some(exhaust) = valve.exhaust {
        flow_path(w, &flow_path::EXHAUST, exhaust);
    }
    if let Some(spool) = valve.spool {
        w.number(&p::SPOOL_FREQUENCY, spool.natural_frequency);
        w.number(&p::SPOOL_DAMPING_RATIO, spool.damping_ratio);
        w.number(&p::SUPPLY_OVERLAP, spool.supply_overlap);
        w.number(&p::EXHAUST_OVERLAP, spool.exhaust_overlap);
    }
}

fn flow_path(w: &mut Writer, rows: &flow_path::Rows, flow_path: FlowPath) {
    match flow_path {
        FlowPath::FlowArea(area) => w.number(rows.flow_area, area),
        FlowPath::Iso6358 { sonic_conductance, critical_ratio } => {
            w.number(rows.sonic_conductance, sonic_conductance);
            w.number(rows.critical_ratio, critical_ratio);
        }
        FlowPath::Kv { kv, pressure_drop_ratio } => {
            w.number(rows.kv, kv);
            w.number(rows.pressure_drop_ratio, pressure_drop_ratio);
        }
        FlowPath::Cv { cv, pressure_drop_ratio } => {
            w.number(rows.cv, cv);
            w.number(rows.pressure_drop_ratio, pressure_drop_ratio);
        }
    }
}

fn command(w: &mut Writer, scenario: &Scenario) {
    let chooses = scenario.valve.is_some_and(|valve| valve.kind.has_three_positions());
    match &scenario.command {
        None => {}
        Some(Command::Constant(state)) => w.word("command.kind", state.name()),
        Some(Command::Pwm { frequency, duty, pulse, rest }) => {
            w.word("command.kind", CommandKind::Pwm.name());
            w.number(&p::PWM_FREQUENCY, *frequency);
            w.number(&p::DUTY, *duty);
            if chooses {
                w.word("command.pulse", pulse.name());
                w.word("command.rest", rest.name());
            }
        }
        Some(Command::Table { time, state }) => {
            w.word("command.kind", CommandKind::Table.name());
            w.list(&p::COMMAND_TIME, time);
            let states: Vec<String> = state.iter().map(|state| format!("\"{}\"", state.name())).collect();
            w.line("command.state", &format!("[{}]", states.join(", ")));
        }
        Some(Command::SetPoints { time, gauge_pressure }) => {
            w.word("command.kind", CommandKind::SetPoints.name());
            w.list(&p::COMMAND_TIME, time);
            w.list(&p::COMMAND_GAUGE_PRESSURE, gauge_pressure);
        }
        Some(Command::Positions { time, position }) => {
            w.word("command.kind", CommandKind::Positions.name());
            w.list(&p::COMMAND_TIME, time);
            w.list(&p::COMMAND_POSITION, position);
        }
        // One controller drives both actuators of a joint and stands with the first.
        Some(Command::Controller(_)) if !w.prefix.is_empty() => {}
        Some(Command::Controller(of)) => {
            w.word("command.kind", CommandKind::Controllers.name());
            controller(w, of);
        }
    }
}

fn controller(w: &mut Writer, of: &Controller) {
    let kind = match (&of.aim, of.regulator) {
        (Aim::Model { temperature, .. } | Aim::Joint { temperature, .. }, _) => match temperature {
            Some(_) => ControllerKind::AirMass,
            None => ControllerKind::FeedForward,
        },
        (Aim::Track { .. }, Regulator::Relay { .. }) => ControllerKind::BangBang,
        (Aim::Track { .. }, Regulator::Pid { .. }) => ControllerKind::Pid,
    };
    w.word("controller.kind", kind.name());
    let rows = of.aim.regulated().rows();
    match &of.aim {
        Aim::Track { quantity, set_point } => set_point_series(w, *quantity, set_point, true),
        Aim::Model { force, length, highest_gauge_pressure, temperature } => {
            set_point_series(w, Quantity::Force, force, true);
            if let Some(length) = length {
                // Both lists have the times of one table.
                set_point_series(w, Quantity::Length, length, matches!(force, SetPoint::Constant(_)));
            }
            model(w, *highest_gauge_pressure, *temperature);
        }
        Aim::Joint { angle, stiffness, highest_gauge_pressure, temperature } => {
            set_point_series(w, Quantity::Angle, angle, true);
            set_point_series(w, Quantity::Stiffness, stiffness, matches!(angle, SetPoint::Constant(_)));
            model(w, *highest_gauge_pressure, *temperature);
        }
    }
    w.number(&p::CONTROL_RATE, of.rate);
    w.line(p::CONTROL_DELAY.key, &of.delay.to_string());
    if let Some(frequency) = of.pulse_frequency {
        w.number(&p::PULSE_FREQUENCY, frequency);
    }
    w.number(&rows.resolution, of.resolution);
    match of.regulator {
        Regulator::Relay { dead_band, hysteresis } => {
            w.number(&rows.dead_band, dead_band);
            w.number(&rows.hysteresis, hysteresis);
        }
        Regulator::Pid {
            proportional_band,
            integral_time,
            derivative_time,
            derivative_filter,
            set_point_weight,
            tracking_time,
            bias,
        } => {
            w.number(&rows.proportional_band, proportional_band);
            let times = [(&p::INTEGRAL_TIME, integral_time), (&p::TRACKING_TIME, tracking_time)];
            for (row, time) in times.into_iter().filter_map(|(row, time)| Some((row, time?))) {
                w.number(row, time);
            }
            w.number(&p::DERIVATIVE_TIME, derivative_time);
            w.number(&p::DERIVATIVE_FILTER, derivative_filter);
            w.number(&p::SET_POINT_WEIGHT, set_point_weight);
            w.number(&p::BIAS, bias);
        }
    }
}

fn model(w: &mut Writer, highest_gauge_pressure: f64, temperature: Option<f64>) {
    w.number(&p::HIGHEST_GAUGE_PRESSURE, highest_gauge_pressure);
    if let Some(temperature) = temperature {
        w.number(&p::CONTROL_TEMPERATURE, temperature);
    }
}

fn set_point_series(w: &mut Writer, quantity: Quantity, set_point: &SetPoint, with_times: bool) {
    let rows = quantity.rows();
    let (time, value, between) = match set_point {
        SetPoint::Constant(value) => return w.number(rows.set_point, *value),
        SetPoint::Sinusoid { mean, amplitude, frequency, phase } => {
            w.number(rows.set_point, *mean);
            w.number(&rows.amplitude, *amplitude);
            w.number(&p::SET_FREQUENCY, *frequency);
            return w.number(&p::SET_PHASE, *phase);
        }
        SetPoint::Lines { time, value } => (time, value, SetPointTable::Lines),
        SetPoint::Steps { time, value } => (time, value, SetPointTable::Steps),
    };
    w.list(rows.set_point, value);
    if with_times {
        w.list(&p::SET_TIME, time);
        w.word("controller.table", between.name());
    }
}

fn load(w: &mut Writer, load: &Load) {
    let kind = match load {
        Load::HangingMass { .. } => LoadKind::HangingMass,
        Load::ConstantForce { .. } => LoadKind::ConstantForce,
        Load::Isometric => LoadKind::Isometric,
        Load::PrescribedMotion(_) => LoadKind::PrescribedMotion,
        Load::AntagonisticJoint(_) => LoadKind::AntagonisticJoint,
    };
    w.word("load.kind", kind.name());
    match load {
        Load::HangingMass { mass, gravity } => {
            w.number(&p::MASS, *mass);
            w.number(&p::GRAVITY, *gravity);
        }
        Load::ConstantForce { force, mass } => {
            w.number(&p::LOAD_FORCE, *force);
            w.number(&p::MASS, *mass);
        }
        Load::Isometric => {}
        Load::PrescribedMotion(Motion::Sinusoid { length, amplitude, frequency, phase }) => {
            w.number(&p::MOTION_LENGTH, *length);
            w.number(&p::MOTION_AMPLITUDE, *amplitude);
            w.number(&p::MOTION_FREQUENCY, *frequency);
            w.number(&p::MOTION_PHASE, *phase);
        }
        Load::PrescribedMotion(Motion::Table { time, length }) => {
            w.list(&p::MOTION_TIME, time);
            w.list(&p::MOTION_TABLE_LENGTH, length);
        }
        Load::AntagonisticJoint(joint) => {
            w.number(&p::MASS, joint.mass);
            w.number(&p::GRAVITY, joint.gravity);
            tendon(w, &joint.tendon);
            w.number(&p::LIMB_DISTANCE, joint.distance);
            w.number(&p::LIMB_INERTIA, joint.inertia);
            w.number(&p::HANGING_ANGLE, joint.hanging_angle);
            w.number(&p::JOINT_TORQUE, joint.torque);
            w.number(&p::JOINT_DAMPING, joint.damping);
            for (row, angle) in [(&p::MIN_ANGLE, joint.min_angle), (&p::MAX_ANGLE, joint.max_angle)] {
                if let Some(angle) = angle {
                    w.number(row, angle);
                }
            }
            w.number(&p::STOP_STIFFNESS, joint.stop_stiffness);
            w.number(&p::STOP_DAMPING, joint.stop_damping);
        }
    }
}

fn initial_and_run(w: &mut Writer, scenario: &Scenario) {
    let (initial, run) = (&scenario.initial, &scenario.run);
    if let Some(gauge_pressure) = initial.gauge_pressure {
        w.number(&p::INITIAL_GAUGE_PRESSURE, gauge_pressure);
    }
    w.number(&p::INITIAL_TEMPERATURE, initial.temperature);
    match initial.length {
        InitialLength::Equilibrium => w.word(p::INITIAL_LENGTH.key, EQUILIBRIUM.name),
        InitialLength::At(length) => w.number(&p::INITIAL_LENGTH, length),
        InitialLength::OfMotion | InitialLength::OfJoint => {}
    }
    if let Load::AntagonisticJoint(joint) = &scenario.load {
        match joint.angle {
            InitialAngle::Equilibrium => w.word(p::INITIAL_ANGLE.key, BALANCED.name),
            InitialAngle::At(angle) => w.number(&p::INITIAL_ANGLE, angle),
        }
        w.number(&p::INITIAL_ANGULAR_VELOCITY, joint.angular_velocity);
    }
    if !matches!(initial.length, InitialLength::OfMotion | InitialLength::OfJoint) {
        w.number(&p::INITIAL_VELOCITY, initial.velocity);
    }
    w.number(&p::DURATION, run.duration);
    w.number(&p::SAMPLE_INTERVAL, run.sample_interval);
    if !w.leaves_engine {
        w.word("run.engine", run.engine.name());
    }
    w.number(&p::RELATIVE_TOLERANCE, run.relative_tolerance);
    w.word("run.method", run.method.name());
    if let Some(step) = run.step {
        w.number(&p::STEP, step);
    }
    w.number(&p::ACCURACY, run.accuracy);
}
