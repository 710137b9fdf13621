//! A joint near an operating point: the six states, by exact derivatives.
//!
//! ```text
//! x = (δθ, δω, δP₁, δm₁, δP₂, δm₂)        y = (δθ, δω, δP₁, δP₂, τ)
//!
//! held valves    u = (ṁ₁, ṁ₂, W)
//! averaged PWM   u = (d₁, d₂, ṁ₁, ṁ₂, W)        each valve by its mean flow over its own period
//! ```
//!
//! ṁ is a mass flow into each actuator beside that of its valve, which your own valve model may supply, W a torque on the
//! joint beside its own, d the commanded duty of each valve. τ is the torque of both actuators. The rates are those that the
//! simulation steps, at dual numbers. The validity of each average is that of [`Averaged`].
//!
//! As for [one actuator](super), every process but the energy balance keeps `P (V/m)^κ` of each, so four states serve. The
//! joint slides without Coulomb friction: within ± [`JointLinearization::coulomb_bound`] it sticks. Neither actuator may be
//! slack or at its shortest at the point; a taut braid and a pressed stop are part of the model as long as they last.
//!
//! Source: differentiation of `load::Joint` and of (12) to (21) of Colbrunn, Nelson & Quinn (2001). Checked by
//! `tests/linearize_joint.rs`.

use super::averaged::{Aim, Averaged, average};
use super::point::Content;
use super::rates::mean_flow;
use super::state_space::{Signal, StateSpace};
use crate::air::{Flow, Process};
use crate::control::{AntagonisticPair, Held};
use crate::dual::Dual;
use crate::error::Error;
use crate::limit;
use crate::load::Load;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::Scalar;
use crate::simulation::{Driven, InitialAngle, JointInitial, JointRig, JointState, Rig};
use crate::valve::Command;

/// The directions of differentiation: six states, then five inputs.
type Slopes = Dual<f64, 11>;
/// The direction of the agonist's duty, of its mass flow, and of the torque; the antagonist's follow.
const DUTY: usize = 6;
const MASS_FLOW: usize = 8;
const TORQUE_INPUT: usize = 10;

const STATES: [Signal; 6] = [
    Signal { name: "angle", symbol: "θ", unit: "rad" },
    Signal { name: "angular_velocity", symbol: "ω", unit: "rad/s" },
    Signal { name: "agonist_pressure", symbol: "P₁", unit: "Pa" },
    Signal { name: "agonist_air_mass", symbol: "m₁", unit: "kg" },
    Signal { name: "antagonist_pressure", symbol: "P₂", unit: "Pa" },
    Signal { name: "antagonist_air_mass", symbol: "m₂", unit: "kg" },
];
const INPUTS: [Signal; 5] = [
    Signal { name: "agonist_duty", symbol: "d₁", unit: "" },
    Signal { name: "antagonist_duty", symbol: "d₂", unit: "" },
    Signal { name: "agonist_mass_flow", symbol: "ṁ₁", unit: "kg/s" },
    Signal { name: "antagonist_mass_flow", symbol: "ṁ₂", unit: "kg/s" },
    Signal { name: "torque", symbol: "W", unit: "N*m" },
];
const TORQUE: Signal = Signal { name: "actuator_torque", symbol: "τ", unit: "N*m" };

/// What holds a joint in balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointBalance {
    /// Gauge pressures of agonist and antagonist; the angle follows.
    AtPressures([GaugePressure; 2]),
    /// An angle in rad and the stiffness in N·m/rad that the two actuators give it at kept pressures; the pressures follow,
    /// for the ideal braid.
    AtStiffness {
        /// Angle in rad.
        angle: f64,
        /// Stiffness in N·m/rad.
        stiffness: f64,
    },
}

/// A joint near an operating point.
#[derive(Clone, Debug)]
pub struct JointLinearization {
    /// The joint.
    pub rig: JointRig,
    /// The point; the angular velocity is zero.
    pub state: JointState,
    /// All six states.
    pub system: StateSpace,
    /// The mean flows of agonist's and antagonist's valve, if they are part of the model.
    pub averaged: Option<[Averaged; 2]>,
}

/// Linearises a joint in balance with both valves held shut; the air of each has a temperature in K there, or under heat
/// transfer that of the wall.
///
/// # Errors
/// [`Error::OutOfRange`] or [`Error::Inconsistent`] for numbers outside the physics or a stiffness that no two pressures
/// give; [`Error::NoSolution`] when there is no balance, or an actuator is slack or at its shortest there;
/// [`Error::NotImplemented`] for actuators with [`Fittings`](crate::simulation::Fittings).
pub fn linearize_joint(
    rig: &JointRig,
    balance: JointBalance,
    temperature: [f64; 2],
) -> Result<JointLinearization, Error> {
    rig.check_bare(&limit::JOINT_LINEAR)?;
    let gauge_pressure = match balance {
        JointBalance::AtPressures(gauge) => gauge,
        JointBalance::AtStiffness { angle, stiffness } => pressures(rig, angle, stiffness)?,
    };
    let at_rest = |i: usize| match rig.driven()[i].actuator.air().process() {
        Process::EnergyBalance { heat_transfer, wall_temperature } if heat_transfer > 0.0 => wall_temperature,
        _ => temperature[i],
    };
    let angle = InitialAngle::Equilibrium;
    let temperature = [at_rest(0), at_rest(1)];
    let state = rig.start(&JointInitial { gauge_pressure, temperature, angle, angular_velocity: 0.0 })?;
    JointLinearization::at(rig, state, None)
}

/// Linearises a joint under PWM by the mean flows of its valves at the duties that are commanded: these give the pressures, the
/// pressures the angle. Each actuator has as much air as its content says.
///
/// # Errors
/// As [`average`] of either valve, and as [`linearize_joint`].
pub fn average_joint(rig: &JointRig, content: [Content; 2]) -> Result<JointLinearization, Error> {
    rig.check_bare(&limit::JOINT_LINEAR)?;
    // A mean flow depends on the pressure alone, so each valve is averaged on its actuator held at some length.
    let of = |i: usize, length: f64| {
        let Driven { actuator, actuation } = rig.driven()[i].clone();
        let duty = match actuation.as_ref().map(|of| &of.command) {
            Some(Command::Pwm { duty, .. }) => *duty,
            _ => return Err(without_pwm()),
        };
        average(&Rig::new(actuator, actuation, Load::Isometric)?, Aim::DutyAtLength(duty, length), content[i])
    };
    let both = |lengths: [f64; 2]| Ok::<_, Error>([of(0, lengths[0])?, of(1, lengths[1])?]);
    let limits = rig.driven().each_ref().map(|driven| driven.actuator.limits());
    let somewhere = both(limits.map(|limits| 0.5 * (limits.min_length() + limits.max_length())))?;
    let pressure = somewhere.map(|of| of.point.state.pressure);
    let angle = rig.equilibrium(pressure)?;
    let there = both(rig.joint().lengths(angle))?;
    let air_mass = there.each_ref().map(|of| of.point.state.air_mass);
    let state = JointState { angle, angular_velocity: 0.0, pressure, air_mass };
    match there.map(|of| of.averaged) {
        [Some(first), Some(second)] => JointLinearization::at(rig, state, Some([first, second])),
        _ => Err(without_pwm()),
    }
}

fn without_pwm() -> Error {
    Error::Misuse {
        what: "there is no PWM to average on both actuators of the joint",
        remedy: "set command.kind = \"pwm\" for both, or linearise with the valves held",
    }
}

impl JointLinearization {
    fn at(rig: &JointRig, state: JointState, averaged: Option<[Averaged; 2]>) -> Result<Self, Error> {
        check(rig, &state)?;
        let at = state.to_array();
        let wide: [Slopes; 6] = core::array::from_fn(|n| Dual::variable(at[n], n));
        let leverage = rig.joint().leverage(wide[0]);
        let flow = core::array::from_fn(|i| {
            let given = Flow { inward: Slopes::variable(0.0, MASS_FLOW + i), outward: Slopes::constant(0.0) };
            let Some(averaged) = &averaged else { return given };
            let actuator = &rig.driven()[i].actuator;
            let (pressure, mass) = (wide[2 + 2 * i], wide[3 + 2 * i]);
            let chamber = actuator.chamber(leverage.lengths[i], leverage.slopes()[i] * wide[1], pressure, mass, false);
            mean_flow(actuator, &chamber, &averaged[i].seats(DUTY + i)).and(given)
        });
        let (rates, torque) = rig.rates_near(&state, &wide, flow, Slopes::variable(0.0, TORQUE_INPUT));
        let outputs =
            [(STATES[0], wide[0]), (STATES[1], wide[1]), (STATES[2], wide[2]), (STATES[4], wide[4]), (TORQUE, torque)];
        let first = if averaged.is_some() { DUTY } else { MASS_FLOW };
        let system = StateSpace {
            a: rates.iter().map(|rate| rate.slope[..6].to_vec()).collect(),
            b: rates.iter().map(|rate| rate.slope[first..].to_vec()).collect(),
            c: outputs.iter().map(|(_, value)| value.slope[..6].to_vec()).collect(),
            d: outputs.iter().map(|(_, value)| value.slope[first..].to_vec()).collect(),
            states: STATES.to_vec(),
            inputs: INPUTS[first - DUTY..].to_vec(),
            outputs: outputs.iter().map(|(signal, _)| *signal).collect(),
        };
        Ok(Self { rig: rig.clone(), state, system, averaged })
    }
}

/// Refuses a point at which an actuator is slack or at its shortest.
fn check(rig: &JointRig, state: &JointState) -> Result<(), Error> {
    let lengths = rig.joint().lengths(state.angle);
    for (i, driven) in rig.driven().iter().enumerate() {
        let (actuator, length) = (&driven.actuator, lengths[i]);
        let pull = actuator.static_force(length, state.pressure[i].0) + actuator.limits().force(length, 0.0);
        // A joint that rests where an actuator is at its shortest lies there but for rounding.
        if length <= actuator.limits().min_length() * (1.0 + 1e-12) || pull <= 0.0 {
            return Err(Error::NoSolution {
                what: "an actuator of the joint is slack or at its shortest at this point: nothing is linear there",
                remedy: "give other pressures, a longer rest_length or another load",
            });
        }
    }
    Ok(())
}

/// The gauge pressures that hold a joint at an angle in rad with a stiffness in N·m/rad.
fn pressures(rig: &JointRig, angle: f64, stiffness: f64) -> Result<[GaugePressure; 2], Error> {
    let angle = parameter::INITIAL_ANGLE.check(angle)?;
    let leverage = rig.joint().leverage(Dual::<f64, 1>::variable(angle, 0));
    let actuators = rig.driven().each_ref().map(|driven| &driven.actuator);
    let (lengths, arms) = (leverage.lengths.map(|length| length.value), leverage.arms.map(|arm| arm.value));
    let pair =
        AntagonisticPair::new(actuators, lengths, arms)?.with_arm_slopes(leverage.arms.map(|arm| arm.slope[0]))?;
    pair.pressures(-rig.joint().other_torque(angle, 0.0), stiffness, Held::Pressures)
}

impl JointLinearization {
    /// The model without each air mass that follows from pressure and angle, because the process keeps `P (V/m)^κ`: the same
    /// inputs, outputs and poles, less the invariants' at zero.
    pub fn minimal(&self) -> StateSpace {
        let leverage = self.rig.joint().leverage(Dual::<f64, 1>::variable(self.state.angle, 0));
        let names = [["agonist_air_mass", "agonist_pressure"], ["antagonist_air_mass", "antagonist_pressure"]];
        (0..2).fold(self.system.clone(), |system, i| {
            let actuator = &self.rig.driven()[i].actuator;
            if matches!(actuator.air().process(), Process::EnergyBalance { .. }) {
                return system;
            }
            let volume = actuator.volume(leverage.lengths[i]);
            let [of_mass, of_pressure] = names[i];
            let mass = self.state.air_mass[i];
            system.without(of_mass, |name| match name {
                "angle" => mass * volume.slope[0] / volume.value,
                name if name == of_pressure => mass / (actuator.air().index() * self.state.pressure[i].0),
                _ => 0.0,
            })
        })
    }

    /// Torque in N·m that the Coulomb friction of both actuators holds at the point, either way.
    pub fn coulomb_bound(&self) -> f64 {
        let leverage = self.rig.joint().leverage(self.state.angle);
        let of = |i: usize| {
            let actuator = &self.rig.driven()[i].actuator;
            leverage.arms[i] * actuator.coulomb_bound(leverage.lengths[i], self.state.pressure[i].0)
        };
        of(0) + of(1)
    }
}
