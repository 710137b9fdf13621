//! Parts of a scenario as the core has them: air and its lines, valves and commands, friction, what an actuator moves.

use crate::choice::{CommandState, ExhaustTemperature, HoseKind, ValveKind};
use crate::scenario::{
    self, Command, FlowPath, Friction, Hysteresis, Joint, MomentArm, Motion, Process, ProportionalRegulator, Supply,
    Tendon, Valve, Viscoelastic,
};
use mckibben::simulation::Actuation;
use mckibben::{AbsolutePressure, Error, GaugePressure, air, friction, line, load, valve};

/// The air as the core has it.
pub(crate) fn core_air(of: &scenario::Air) -> Result<air::Air, Error> {
    let process = match of.process {
        Process::Isentropic => air::Process::Isentropic,
        Process::Isothermal => air::Process::Isothermal,
        Process::Polytropic { index } => air::Process::Polytropic { index },
        Process::EnergyBalance { heat_transfer, wall_temperature } => {
            air::Process::EnergyBalance { heat_transfer, wall_temperature }
        }
    };
    let atmosphere = AbsolutePressure(of.atmospheric_pressure);
    air::Air::new(of.gas_constant, of.heat_capacity_ratio, atmosphere, process)
}

/// A hose whose air is near a temperature in K.
pub(crate) fn core_hose(hose: &scenario::Hose, temperature: f64, air: &air::Air) -> Result<line::Hose, Error> {
    let kind = match hose.kind {
        HoseKind::Lumped => line::HoseKind::Lumped,
        HoseKind::Distributed => line::HoseKind::Distributed { cells: hose.cells },
    };
    let gas = [hose.viscosity, temperature, hose.polytropic_index];
    line::Hose::new(kind, [hose.length, hose.diameter], gas, air)
}

/// A motion whose lengths are below `end_length` m.
pub(crate) fn core_motion(motion: &Motion, end_length: f64) -> Result<load::Motion, Error> {
    match motion {
        Motion::Sinusoid { length, amplitude, frequency, phase } => {
            load::Motion::sinusoid(*length, *amplitude, *frequency, *phase, end_length)
        }
        Motion::Table { time, length } => load::Motion::table(time.clone(), length.clone(), end_length),
    }
}

/// What makes a supply change, if anything does.
pub(crate) fn core_supply_line(supply: &Supply, air: &air::Air) -> Result<Option<line::SupplyLine>, Error> {
    let reservoir = supply.reservoir.map(|reservoir| {
        let compressor = reservoir.compressor.map(|compressor| {
            let switch = [compressor.cut_in, compressor.cut_out].map(GaugePressure);
            line::Compressor::new([compressor.displacement, compressor.clearance], switch, air)
        });
        let start = GaugePressure(supply.reservoir_start());
        let numbers = [reservoir.volume, reservoir.polytropic_index, supply.temperature];
        line::Reservoir::new(numbers, start, compressor.transpose()?, air)
    });
    let regulator =
        supply.regulator.map(|regulator| line::Regulator::new(regulator.droop, regulator.dead_band, regulator.lag));
    let line = line::SupplyLine::new(reservoir.transpose()?, regulator.transpose()?, supply.actuators)?;
    Ok((line.reservoir().is_some() || line.regulator().is_some()).then_some(line))
}

/// What drives one output of a valve.
pub(crate) fn core_actuation(valve: &Valve, command: &Command, output: usize) -> Result<Actuation, Error> {
    let command = core_command(command)?;
    let (opening, closing) = (valve.opening_delay, valve.closing_delay);
    let ramp = valve::Ramp::new(valve.opening_time, valve.closing_time)?;
    let one = |kind| valve::Solenoid::new(kind, opening, closing).map(|solenoid| solenoid.with_ramp(ramp));
    let five_way = |rest| {
        let [a, b] = valve::FiveWay::new(rest, opening, closing)?.with_dead_time(valve.dead_time)?.outputs(&command)?;
        let valve::FiveWayOutput { solenoid, command } = if output == 0 { a } else { b };
        Ok(Actuation { solenoid: solenoid.with_ramp(ramp), command })
    };
    let solenoid = match valve.kind {
        ValveKind::TwoWay => one(valve::ValveKind::TwoWay)?,
        ValveKind::ThreeWay => one(valve::ValveKind::ThreeWay)?,
        ValveKind::ThreeWayNormallyOpen => one(valve::ValveKind::ThreeWayNormallyOpen)?,
        ValveKind::FillHoldExhaust => one(valve::ValveKind::FillHoldExhaust)?,
        ValveKind::PressureRegulator => regulating(valve)?,
        ValveKind::ProportionalSpool => proportional(valve)?,
        ValveKind::FiveWay => return five_way(valve::FiveWayRest::Returned),
        ValveKind::FiveWayClosed => return five_way(valve::FiveWayRest::Closed),
        ValveKind::FiveWayExhausted => return five_way(valve::FiveWayRest::Exhausted),
        ValveKind::FiveWayPressurised => return five_way(valve::FiveWayRest::Pressurised),
    };
    Ok(Actuation { solenoid: solenoid.with_dead_time(valve.dead_time)?, command })
}

/// A proportional spool in place of a solenoid.
fn proportional(valve: &Valve) -> Result<valve::Solenoid, Error> {
    let Some(of) = valve.spool else {
        return Err(Error::Misuse {
            what: "the valve is a proportional spool, but nothing says how it moves",
            remedy: "give valve.spool.natural_frequency and valve.spool.damping_ratio",
        });
    };
    let spool = valve::Spool::new(of.natural_frequency, of.damping_ratio, of.supply_overlap, of.exhaust_overlap);
    spool.map(valve::Solenoid::proportional)
}

/// A pressure regulator in place of a solenoid.
fn regulating(valve: &Valve) -> Result<valve::Solenoid, Error> {
    let Some(ProportionalRegulator { time_constant, rate_limit }) = valve.regulator else {
        return Err(Error::Misuse {
            what: "the valve is a pressure regulator, but nothing says how it regulates",
            remedy: "give valve.time_constant and valve.rate_limit",
        });
    };
    valve::Regulator::new(time_constant, valve.dead_time, rate_limit).map(valve::Solenoid::regulating)
}

pub(crate) fn core_valve(valve: &Valve, supply: &Supply, air: &air::Air) -> Result<valve::Valve, Error> {
    let law = |port, flow_path: FlowPath| {
        valve::FlowLaw::of_flow_path(port, flow_path.standard(), valve.efficiency, valve.laminar_ratio, air)
    };
    let inlet = law(valve::Port::Supply, valve.flow_path)?;
    let outlet = valve.exhaust.map(|flow_path| law(valve::Port::Exhaust, flow_path)).transpose()?;
    let supply = valve::Supply::new(GaugePressure(supply.gauge_pressure), supply.temperature, air)?;
    let exhaust_temperature = match valve.exhaust_temperature {
        ExhaustTemperature::Actuator => valve::ExhaustTemperature::Actuator,
        ExhaustTemperature::Ambient => valve::ExhaustTemperature::Ambient,
    };
    let built = valve::Valve::new(inlet, supply, exhaust_temperature, air);
    Ok(outlet.map_or(built, |outlet| built.with_exhaust(outlet)))
}

impl FlowPath {
    /// As the core has it.
    pub fn standard(self) -> valve::FlowStandard {
        match self {
            Self::FlowArea(flow_area) => valve::FlowStandard::Orifice { flow_area },
            Self::Iso6358 { sonic_conductance, critical_ratio } => {
                valve::FlowStandard::Iso6358 { sonic_conductance, critical_ratio }
            }
            Self::Kv { kv, pressure_drop_ratio } => valve::FlowStandard::Kv { kv, pressure_drop_ratio },
            Self::Cv { cv, pressure_drop_ratio } => valve::FlowStandard::Cv { cv, pressure_drop_ratio },
        }
    }

    /// Scales the flow path: it lets through `factor` times as much.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::FlowArea(area) => Self::FlowArea(factor * area),
            Self::Iso6358 { sonic_conductance, critical_ratio } => {
                Self::Iso6358 { sonic_conductance: factor * sonic_conductance, critical_ratio }
            }
            Self::Kv { kv, pressure_drop_ratio } => Self::Kv { kv: factor * kv, pressure_drop_ratio },
            Self::Cv { cv, pressure_drop_ratio } => Self::Cv { cv: factor * cv, pressure_drop_ratio },
        }
    }
}

fn core_command(command: &Command) -> Result<valve::Command, Error> {
    match command {
        Command::Constant(state) => Ok(valve::Command::Constant(request(*state))),
        Command::Pwm { frequency, duty, pulse, rest } => {
            valve::Command::pwm(*frequency, *duty, request(*pulse), request(*rest))
        }
        Command::Table { time, state } => {
            valve::Command::table(time.clone(), state.iter().copied().map(request).collect())
        }
        Command::SetPoints { time, gauge_pressure } => valve::Command::set_points(time.clone(), gauge_pressure.clone()),
        Command::Positions { time, position } => valve::Command::positions(time.clone(), position.clone()),
        Command::Controller(_) => Err(Error::NotImplemented(&mckibben::limit::CONTROLLER_HERE)),
    }
}

fn request(state: CommandState) -> valve::Request {
    match state {
        CommandState::Fill => valve::Request::Fill,
        CommandState::Hold => valve::Request::Hold,
        CommandState::Exhaust => valve::Request::Exhaust,
    }
}

pub(super) fn core_friction(of: &Friction) -> Result<friction::Friction, Error> {
    let coulomb = friction::Coulomb::new(of.coulomb_width)?
        .with_force(of.coulomb_force, of.coulomb_force_per_pressure)?
        .with_stribeck(of.static_ratio, of.stribeck_velocity)?;
    let mut friction =
        friction::Friction::with_coulomb(of.viscous, coulomb)?.with_structural_damping(of.structural_damping)?;
    if let Some(Viscoelastic { relaxation_time, stiffness, stiffness_ratio, initial_stretch }) = &of.viscoelastic {
        let branches = friction::Viscoelastic::new(stiffness, stiffness_ratio, relaxation_time)?;
        let branches = branches.with_initial_stretch(initial_stretch)?;
        friction = friction.with_viscoelastic(branches);
    }
    match &of.hysteresis {
        Some(Hysteresis::MaxwellSlip { reach, stiffness_ratio }) => {
            let elements = friction::MaxwellSlip::new(reach, stiffness_ratio)?;
            Ok(friction.with_hysteresis(friction::Hysteresis::MaxwellSlip(elements)))
        }
        Some(Hysteresis::BoucWen { width, beta, gamma }) => {
            let law = friction::BoucWen::new(*width, *beta, *gamma)?;
            Ok(friction.with_hysteresis(friction::Hysteresis::BoucWen(law)))
        }
        Some(Hysteresis::LuGre { width, reach, static_ratio, stribeck_velocity, damping_time }) => {
            let law = friction::LuGre::new(*width, *reach)?;
            let law = law.with_velocity(*static_ratio, *stribeck_velocity, *damping_time)?;
            Ok(friction.with_hysteresis(friction::Hysteresis::LuGre(law)))
        }
        None => Ok(friction),
    }
}

pub(super) fn core_joint(joint: &Joint) -> Result<load::Joint, Error> {
    let limb = load::Limb {
        mass: joint.mass,
        distance: joint.distance,
        inertia: joint.inertia,
        gravity: joint.gravity,
        hanging_angle: joint.hanging_angle,
    };
    let stops = load::Stops {
        ends: [joint.min_angle, joint.max_angle],
        stiffness: joint.stop_stiffness,
        damping: joint.stop_damping,
    };
    let tendons = [core_lead(&joint.tendon)?, core_lead(&joint.antagonist.tendon)?];
    load::Joint::new(limb, tendons, joint.torque, joint.damping, stops)
}

fn core_lead(tendon: &Tendon) -> Result<load::Tendon, Error> {
    let arm = match &tendon.arm {
        MomentArm::Pulley(radius) => load::MomentArm::pulley(*radius)?,
        MomentArm::Table { angle, arm } => load::MomentArm::table(angle, arm)?,
    };
    Ok(load::Tendon { arm, rest_length: tendon.rest_length })
}
