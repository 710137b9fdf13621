//! Where each quantity of a scenario file stands in the plain scenario, so that it can be set without text.
//!
//! Checked by `tests/sweep.rs`: for every key that holds one quantity, setting it here and reading it from text give
//! equal scenarios.

use crate::scenario::{
    Command, Compressor, Effectiveness, InitialLength, Load, Motion, Passage, Process, Regulator, Reservoir, Scenario,
};
use mckibben::parameter::{self as p, Parameter};

/// The place of a number in a scenario, or `None` when the scenario has no such number.
pub(super) type Field = fn(&mut Scenario) -> Option<&mut f64>;

/// Every quantity and its place.
static FIELDS: &[(&Parameter, Field)] = &[
    (&p::THREAD_LENGTH, |s| Some(&mut s.actuator.thread_length)),
    (&p::TURNS, |s| Some(&mut s.actuator.turns)),
    (&p::MAX_LENGTH, |s| Some(&mut s.actuator.max_length)),
    (&p::MIN_LENGTH, |s| Some(&mut s.actuator.min_length)),
    (&p::EXTERNAL_VOLUME, |s| Some(&mut s.actuator.external_volume)),
    (&p::LEAKAGE, |s| s.actuator.leakage.as_mut()),
    (&p::EFFECTIVENESS, |s| match &mut s.actuator.effectiveness {
        Effectiveness::Constant(ratio) => Some(ratio),
        _ => None,
    }),
    (&p::VISCOUS, |s| Some(&mut s.actuator.friction.viscous)),
    (&p::COULOMB_WIDTH, |s| Some(&mut s.actuator.friction.coulomb_width)),
    (&p::LIMIT_STIFFNESS, |s| Some(&mut s.actuator.limit.stiffness)),
    (&p::LIMIT_DAMPING, |s| Some(&mut s.actuator.limit.damping)),
    (&p::POLYTROPIC_INDEX, |s| match &mut s.air.process {
        Process::Polytropic { index } => Some(index),
        _ => None,
    }),
    (&p::HEAT_TRANSFER, |s| match &mut s.air.process {
        Process::EnergyBalance { heat_transfer, .. } => Some(heat_transfer),
        _ => None,
    }),
    (&p::WALL_TEMPERATURE, |s| match &mut s.air.process {
        Process::EnergyBalance { wall_temperature, .. } => Some(wall_temperature),
        _ => None,
    }),
    (&p::ATMOSPHERIC_PRESSURE, |s| Some(&mut s.air.atmospheric_pressure)),
    (&p::GAS_CONSTANT, |s| Some(&mut s.air.gas_constant)),
    (&p::HEAT_CAPACITY_RATIO, |s| Some(&mut s.air.heat_capacity_ratio)),
    (&p::SUPPLY_GAUGE_PRESSURE, |s| Some(&mut s.supply.as_mut()?.gauge_pressure)),
    (&p::SUPPLY_TEMPERATURE, |s| Some(&mut s.supply.as_mut()?.temperature)),
    (&p::RESERVOIR_VOLUME, |s| Some(&mut reservoir(s)?.volume)),
    (&p::RESERVOIR_PRESSURE, |s| reservoir(s)?.gauge_pressure.as_mut()),
    (&p::RESERVOIR_INDEX, |s| Some(&mut reservoir(s)?.polytropic_index)),
    (&p::DISPLACEMENT, |s| Some(&mut compressor(s)?.displacement)),
    (&p::CLEARANCE, |s| Some(&mut compressor(s)?.clearance)),
    (&p::CUT_IN, |s| Some(&mut compressor(s)?.cut_in)),
    (&p::CUT_OUT, |s| Some(&mut compressor(s)?.cut_out)),
    (&p::LAG, |s| Some(&mut regulator(s)?.lag)),
    (&p::DROOP, |s| Some(&mut regulator(s)?.droop)),
    (&p::DEAD_BAND, |s| Some(&mut regulator(s)?.dead_band)),
    (&p::ACTUATORS, |s| Some(&mut s.supply.as_mut()?.actuators)),
    (&p::HOSE_LENGTH, |s| Some(&mut s.hose.as_mut()?.length)),
    (&p::HOSE_DIAMETER, |s| Some(&mut s.hose.as_mut()?.diameter)),
    (&p::HOSE_VISCOSITY, |s| Some(&mut s.hose.as_mut()?.viscosity)),
    (&p::HOSE_INDEX, |s| Some(&mut s.hose.as_mut()?.polytropic_index)),
    (&p::FLOW_AREA, |s| match &mut s.valve.as_mut()?.passage {
        Passage::FlowArea(area) => Some(area),
        Passage::Iso6358 { .. } => None,
    }),
    (&p::SONIC_CONDUCTANCE, |s| match &mut s.valve.as_mut()?.passage {
        Passage::Iso6358 { sonic_conductance, .. } => Some(sonic_conductance),
        Passage::FlowArea(_) => None,
    }),
    (&p::CRITICAL_RATIO, |s| match &mut s.valve.as_mut()?.passage {
        Passage::Iso6358 { critical_ratio, .. } => Some(critical_ratio),
        Passage::FlowArea(_) => None,
    }),
    (&p::EFFICIENCY, |s| Some(&mut s.valve.as_mut()?.efficiency)),
    (&p::OPENING_DELAY, |s| Some(&mut s.valve.as_mut()?.opening_delay)),
    (&p::CLOSING_DELAY, |s| Some(&mut s.valve.as_mut()?.closing_delay)),
    (&p::LAMINAR_RATIO, |s| Some(&mut s.valve.as_mut()?.laminar_ratio)),
    (&p::PWM_FREQUENCY, |s| match &mut s.command {
        Some(Command::Pwm { frequency, .. }) => Some(frequency),
        _ => None,
    }),
    (&p::DUTY, |s| match &mut s.command {
        Some(Command::Pwm { duty, .. }) => Some(duty),
        _ => None,
    }),
    (&p::MASS, |s| match &mut s.load {
        Load::HangingMass { mass, .. } | Load::ConstantForce { mass, .. } => Some(mass),
        _ => None,
    }),
    (&p::GRAVITY, |s| match &mut s.load {
        Load::HangingMass { gravity, .. } => Some(gravity),
        _ => None,
    }),
    (&p::LOAD_FORCE, |s| match &mut s.load {
        Load::ConstantForce { force, .. } => Some(force),
        _ => None,
    }),
    (&p::MOTION_LENGTH, |s| match &mut s.load {
        Load::PrescribedMotion(Motion::Sinusoid { length, .. }) => Some(length),
        _ => None,
    }),
    (&p::MOTION_AMPLITUDE, |s| match &mut s.load {
        Load::PrescribedMotion(Motion::Sinusoid { amplitude, .. }) => Some(amplitude),
        _ => None,
    }),
    (&p::MOTION_FREQUENCY, |s| match &mut s.load {
        Load::PrescribedMotion(Motion::Sinusoid { frequency, .. }) => Some(frequency),
        _ => None,
    }),
    (&p::MOTION_PHASE, |s| match &mut s.load {
        Load::PrescribedMotion(Motion::Sinusoid { phase, .. }) => Some(phase),
        _ => None,
    }),
    (&p::INITIAL_GAUGE_PRESSURE, |s| Some(&mut s.initial.gauge_pressure)),
    (&p::INITIAL_TEMPERATURE, |s| Some(&mut s.initial.temperature)),
    (&p::INITIAL_LENGTH, |s| match &mut s.initial.length {
        InitialLength::At(length) => Some(length),
        _ => None,
    }),
    (&p::INITIAL_VELOCITY, |s| Some(&mut s.initial.velocity)),
    (&p::DURATION, |s| Some(&mut s.run.duration)),
    (&p::SAMPLE_INTERVAL, |s| Some(&mut s.run.sample_interval)),
    (&p::RELATIVE_TOLERANCE, |s| Some(&mut s.run.relative_tolerance)),
    (&p::STEP, |s| s.run.step.as_mut()),
    (&p::ACCURACY, |s| Some(&mut s.run.accuracy)),
];

fn reservoir(s: &mut Scenario) -> Option<&mut Reservoir> {
    s.supply.as_mut()?.reservoir.as_mut()
}

fn compressor(s: &mut Scenario) -> Option<&mut Compressor> {
    reservoir(s)?.compressor.as_mut()
}

fn regulator(s: &mut Scenario) -> Option<&mut Regulator> {
    s.supply.as_mut()?.regulator.as_mut()
}

/// The place of a quantity.
pub(super) fn field_of(parameter: &Parameter) -> Option<Field> {
    FIELDS.iter().find(|(of, _)| of.key == parameter.key).map(|(_, field)| *field)
}
