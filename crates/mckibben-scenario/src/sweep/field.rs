//! Where each quantity of a scenario file stands in the plain scenario, so that it can be set without text.
//!
//! Checked by `tests/sweep.rs`: for every key that holds one quantity, setting it here and reading it from text give
//! equal scenarios.

mod control;
mod joint;

use crate::choice::BladderForm;
use crate::scenario::{
    Command, Compressor, Effectiveness, FlowPath, Force, Hysteresis, InitialLength, Load, Motion, PressureRegulator,
    Process, Reservoir, Scenario, TonduLopezCoefficients,
};
use mckibben::parameter::{self as p, Parameter};

/// The place of a number in a scenario, or `None` when the scenario has no such number.
pub(crate) type Field = fn(&mut Scenario) -> Option<&mut f64>;

/// Every quantity and its place.
static FIELDS: &[(&Parameter, Field)] = &[
    (&p::THREAD_LENGTH, |s| Some(&mut s.actuator.thread_length)),
    (&p::TURNS, |s| Some(&mut s.actuator.turns)),
    (&p::MAX_LENGTH, |s| Some(&mut s.actuator.max_length)),
    (&p::MIN_LENGTH, |s| Some(&mut s.actuator.min_length)),
    (&p::EXTERNAL_VOLUME, |s| Some(&mut s.actuator.external_volume)),
    (&p::LEAKAGE, |s| s.actuator.leakage.as_mut()),
    (&p::WALL_THICKNESS, |s| Some(&mut s.actuator.wall_thickness)),
    (&p::END_FACTOR, |s| match &mut s.actuator.force {
        Force::TonduLopez { end_factor, .. } => Some(end_factor),
        _ => None,
    }),
    (&p::END_FACTOR_RISE, |s| match &mut s.actuator.force {
        Force::TonduLopez { end_factor_rise, .. } => Some(end_factor_rise),
        _ => None,
    }),
    (&p::END_FACTOR_PRESSURE, |s| match &mut s.actuator.force {
        Force::TonduLopez { end_factor_pressure, .. } => Some(end_factor_pressure),
        _ => None,
    }),
    (&p::INITIAL_RADIUS, |s| Some(&mut tondu_lopez(s)?.radius)),
    (&p::TONDU_LOPEZ_A, |s| Some(&mut tondu_lopez(s)?.a)),
    (&p::TONDU_LOPEZ_B, |s| Some(&mut tondu_lopez(s)?.b)),
    (&p::MEMBRANE_THICKNESS, |s| match &mut s.actuator.force {
        Force::MartensBoblan { membrane_thickness, .. } => Some(membrane_thickness),
        _ => None,
    }),
    (&p::THREAD_STIFFNESS, |s| match &mut s.actuator.force {
        Force::ExtensibleBraid { thread_stiffness } => Some(thread_stiffness),
        _ => None,
    }),
    (&p::MAX_FORCE, |s| match &mut s.actuator.force {
        Force::Bolen { max_force, .. } => Some(max_force),
        _ => None,
    }),
    (&p::MAX_PRESSURE, |s| match &mut s.actuator.force {
        Force::Bolen { max_pressure, .. } => Some(max_pressure),
        _ => None,
    }),
    (&p::MAX_CONTRACTION, |s| match &mut s.actuator.force {
        Force::Bolen { max_contraction, .. } => Some(max_contraction),
        _ => None,
    }),
    (&p::TAPER_END_RADIUS, |s| Some(&mut s.actuator.taper.as_mut()?.end_radius)),
    (&p::TAPER_LENGTH_RATIO, |s| Some(&mut s.actuator.taper.as_mut()?.length_ratio)),
    (&p::BLADDER_FORCE, |s| Some(&mut s.actuator.bladder.as_mut()?.force)),
    (&p::BLADDER_SCALE, |s| {
        let bladder = s.actuator.bladder.as_mut().filter(|bladder| bladder.form != BladderForm::Linear)?;
        Some(&mut bladder.scale)
    }),
    (&p::EFFECTIVENESS, |s| match &mut s.actuator.effectiveness {
        Effectiveness::Constant(ratio) => Some(ratio),
        _ => None,
    }),
    (&p::VISCOUS, |s| Some(&mut s.actuator.friction.viscous)),
    (&p::STRUCTURAL_DAMPING, |s| Some(&mut s.actuator.friction.structural_damping)),
    (&p::COULOMB_WIDTH, |s| Some(&mut s.actuator.friction.coulomb_width)),
    (&p::COULOMB_FORCE, |s| Some(&mut s.actuator.friction.coulomb_force)),
    (&p::COULOMB_FORCE_PER_PRESSURE, |s| Some(&mut s.actuator.friction.coulomb_force_per_pressure)),
    (&p::STATIC_RATIO, |s| Some(&mut s.actuator.friction.static_ratio)),
    (&p::STRIBECK_VELOCITY, |s| Some(&mut s.actuator.friction.stribeck_velocity)),
    (&p::LIMIT_STIFFNESS, |s| Some(&mut s.actuator.limit.stiffness)),
    (&p::LIMIT_DAMPING, |s| Some(&mut s.actuator.limit.damping)),
    (&p::POLYTROPIC_INDEX, |s| match &mut s.air.process {
        Process::Polytropic { index } => Some(index),
        _ => None,
    }),
    (&p::HYSTERESIS_WIDTH, |s| match &mut s.actuator.friction.hysteresis {
        Some(Hysteresis::BoucWen { width, .. } | Hysteresis::LuGre { width, .. }) => Some(width),
        _ => None,
    }),
    (&p::HYSTERESIS_BETA, |s| bouc_wen(s).map(|[beta, _]| beta)),
    (&p::HYSTERESIS_GAMMA, |s| bouc_wen(s).map(|[_, gamma]| gamma)),
    (&p::BRISTLE_REACH, |s| bristles(s).map(|[reach, ..]| reach)),
    (&p::BRISTLE_STATIC_RATIO, |s| bristles(s).map(|[_, ratio, ..]| ratio)),
    (&p::BRISTLE_STRIBECK_VELOCITY, |s| bristles(s).map(|[_, _, velocity, _]| velocity)),
    (&p::BRISTLE_DAMPING_TIME, |s| bristles(s).map(|[.., time]| time)),
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
    (&p::SERIES_OFFSET, |s| Some(&mut s.pressure.as_mut()?.sensor.offset)),
    (&p::SERIES_SCALE, |s| Some(&mut s.pressure.as_mut()?.sensor.scale)),
    (&p::SERIES_SHIFT, |s| Some(&mut s.pressure.as_mut()?.sensor.shift)),
    (&p::LAG, |s| Some(&mut regulator(s)?.lag)),
    (&p::DROOP, |s| Some(&mut regulator(s)?.droop)),
    (&p::DEAD_BAND, |s| Some(&mut regulator(s)?.dead_band)),
    (&p::ACTUATORS, |s| Some(&mut s.supply.as_mut()?.actuators)),
    (&p::HOSE_LENGTH, |s| Some(&mut s.hose.as_mut()?.length)),
    (&p::HOSE_DIAMETER, |s| Some(&mut s.hose.as_mut()?.diameter)),
    (&p::HOSE_VISCOSITY, |s| Some(&mut s.hose.as_mut()?.viscosity)),
    (&p::HOSE_INDEX, |s| Some(&mut s.hose.as_mut()?.polytropic_index)),
    (&p::FLOW_AREA, |s| flow_area(supply(s)?)),
    (&p::SONIC_CONDUCTANCE, |s| sonic_conductance(supply(s)?)),
    (&p::CRITICAL_RATIO, |s| critical_ratio(supply(s)?)),
    (&p::KV, |s| kv(supply(s)?)),
    (&p::CV, |s| cv(supply(s)?)),
    (&p::PRESSURE_DROP_RATIO, |s| pressure_drop_ratio(supply(s)?)),
    (&p::EXHAUST_FLOW_AREA, |s| flow_area(exhaust(s)?)),
    (&p::EXHAUST_SONIC_CONDUCTANCE, |s| sonic_conductance(exhaust(s)?)),
    (&p::EXHAUST_CRITICAL_RATIO, |s| critical_ratio(exhaust(s)?)),
    (&p::EXHAUST_KV, |s| kv(exhaust(s)?)),
    (&p::EXHAUST_CV, |s| cv(exhaust(s)?)),
    (&p::EXHAUST_PRESSURE_DROP_RATIO, |s| pressure_drop_ratio(exhaust(s)?)),
    (&p::EFFICIENCY, |s| Some(&mut s.valve.as_mut()?.efficiency)),
    (&p::OPENING_DELAY, |s| Some(&mut s.valve.as_mut()?.opening_delay)),
    (&p::CLOSING_DELAY, |s| Some(&mut s.valve.as_mut()?.closing_delay)),
    (&p::OPENING_TIME, |s| Some(&mut s.valve.as_mut()?.opening_time)),
    (&p::CLOSING_TIME, |s| Some(&mut s.valve.as_mut()?.closing_time)),
    (&p::REGULATOR_TIME_CONSTANT, |s| Some(&mut s.valve.as_mut()?.regulator.as_mut()?.time_constant)),
    (&p::VALVE_DEAD_TIME, |s| Some(&mut s.valve.as_mut()?.dead_time)),
    (&p::REGULATOR_RATE_LIMIT, |s| Some(&mut s.valve.as_mut()?.regulator.as_mut()?.rate_limit)),
    (&p::SPOOL_FREQUENCY, |s| Some(&mut s.valve.as_mut()?.spool.as_mut()?.natural_frequency)),
    (&p::SPOOL_DAMPING_RATIO, |s| Some(&mut s.valve.as_mut()?.spool.as_mut()?.damping_ratio)),
    (&p::SUPPLY_OVERLAP, |s| Some(&mut s.valve.as_mut()?.spool.as_mut()?.supply_overlap)),
    (&p::EXHAUST_OVERLAP, |s| Some(&mut s.valve.as_mut()?.spool.as_mut()?.exhaust_overlap)),
    (&p::LAMINAR_RATIO, |s| Some(&mut s.valve.as_mut()?.laminar_ratio)),
    (&p::PWM_FREQUENCY, |s| match &mut s.command {
        Some(Command::Pwm { frequency, .. }) => Some(frequency),
        _ => None,
    }),
    (&p::DUTY, |s| match &mut s.command {
        Some(Command::Pwm { duty, .. }) => Some(duty),
        _ => None,
    }),
    (&p::TENDON_STIFFNESS, |s| Some(&mut s.tendon.as_mut()?.stiffness)),
    (&p::TENDON_REST_LENGTH, |s| Some(&mut s.tendon.as_mut()?.rest_length)),
    (&p::MASS, |s| match &mut s.load {
        Load::HangingMass { mass, .. } | Load::ConstantForce { mass, .. } => Some(mass),
        Load::AntagonisticJoint(joint) => Some(&mut joint.mass),
        _ => None,
    }),
    (&p::GRAVITY, |s| match &mut s.load {
        Load::HangingMass { gravity, .. } => Some(gravity),
        Load::AntagonisticJoint(joint) => Some(&mut joint.gravity),
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
    (&p::INITIAL_GAUGE_PRESSURE, |s| {
        let first = s.first_gauge_pressure();
        Some(s.initial.gauge_pressure.get_or_insert(first))
    }),
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

/// β and γ of a hysteresis with rounded corners.
fn bouc_wen(s: &mut Scenario) -> Option<[&mut f64; 2]> {
    match &mut s.actuator.friction.hysteresis {
        Some(Hysteresis::BoucWen { beta, gamma, .. }) => Some([beta, gamma]),
        _ => None,
    }
}

/// Reach, static ratio, Stribeck velocity and damping time of LuGre's bristles.
fn bristles(s: &mut Scenario) -> Option<[&mut f64; 4]> {
    match &mut s.actuator.friction.hysteresis {
        Some(Hysteresis::LuGre { reach, static_ratio, stribeck_velocity, damping_time, .. }) => {
            Some([reach, static_ratio, stribeck_velocity, damping_time])
        }
        _ => None,
    }
}

fn regulator(s: &mut Scenario) -> Option<&mut PressureRegulator> {
    s.supply.as_mut()?.regulator.as_mut()
}

/// The coefficients of the law of Tondu & Lopez, where they are given.
fn tondu_lopez(scenario: &mut Scenario) -> Option<&mut TonduLopezCoefficients> {
    match &mut scenario.actuator.force {
        Force::TonduLopez { coefficients, .. } => coefficients.as_mut(),
        _ => None,
    }
}

fn supply(scenario: &mut Scenario) -> Option<&mut FlowPath> {
    Some(&mut scenario.valve.as_mut()?.flow_path)
}

fn exhaust(scenario: &mut Scenario) -> Option<&mut FlowPath> {
    scenario.valve.as_mut()?.exhaust.as_mut()
}

fn flow_area(flow_path: &mut FlowPath) -> Option<&mut f64> {
    if let FlowPath::FlowArea(area) = flow_path { Some(area) } else { None }
}

fn sonic_conductance(flow_path: &mut FlowPath) -> Option<&mut f64> {
    if let FlowPath::Iso6358 { sonic_conductance, .. } = flow_path { Some(sonic_conductance) } else { None }
}

fn critical_ratio(flow_path: &mut FlowPath) -> Option<&mut f64> {
    if let FlowPath::Iso6358 { critical_ratio, .. } = flow_path { Some(critical_ratio) } else { None }
}

fn kv(flow_path: &mut FlowPath) -> Option<&mut f64> {
    if let FlowPath::Kv { kv, .. } = flow_path { Some(kv) } else { None }
}

fn cv(flow_path: &mut FlowPath) -> Option<&mut f64> {
    if let FlowPath::Cv { cv, .. } = flow_path { Some(cv) } else { None }
}

fn pressure_drop_ratio(flow_path: &mut FlowPath) -> Option<&mut f64> {
    match flow_path {
        FlowPath::Kv { pressure_drop_ratio, .. } | FlowPath::Cv { pressure_drop_ratio, .. } => {
            Some(pressure_drop_ratio)
        }
        FlowPath::FlowArea(_) | FlowPath::Iso6358 { .. } => None,
    }
}

pub(crate) use joint::exchange;

/// The place of a quantity.
pub(crate) fn field_of(parameter: &Parameter) -> Option<Field> {
    let here = FIELDS.iter().find(|(of, _)| of.key == parameter.key).map(|(_, field)| *field);
    here.or_else(|| control::field_of(parameter.key)).or_else(|| joint::field_of(parameter.key))
}
