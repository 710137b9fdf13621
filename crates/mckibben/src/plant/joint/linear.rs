//! The linear model of a joint: the point, and the plant's model in its words.
//!
//! ```text
//! x = (δθ, δω, δP₁, δm₁, δP₂, δm₂)        y = (δθ, δω, δP₁, δP₂, τ)
//!
//! held valves    u = (ṁ₁, ṁ₂, W)
//! driven         u = (d₁, d₂, ṁ₁, ṁ₂, W)        each valve by its mean flow over its own period
//! ```
//!
//! ṁ is a mass flow into each actuator in addition to that of its valve, which a custom valve model may supply, W a
//! torque on the joint in addition to its own, d the commanded duty of each valve. τ is the torque of both actuators.
//! Behind these stands what hoses, leaks, supplies, regulators, spools, tendons and given pressures add.
//!
//! As for [one actuator](crate::linearize), every process but the energy balance keeps `P (V/m)^κ` of each, so four states serve.
//! The joint slides without Coulomb friction: within [`JointLinearization::coulomb_bounds`] it sticks. Neither actuator may be
//! slack or at its shortest at the point; a taut braid and a pressed stop are part of the model as long as they last.
//!
//! Checked by `tests/linearize_joint.rs` and `tests/linearize_line.rs`.

use super::JointPlant;
use crate::air::Process;
use crate::control::{AntagonisticPair, Held};
use crate::dual::Dual;
use crate::error::Error;
use crate::linearize::{Signal, StateSpace};
use crate::parameter;
use crate::plant::linear::{PlantAir, PlantBalance, PlantLinearization, ValveAverage, linearize_plant, steady_air};
use crate::plant::named::{PAIR, Words};
use crate::pressure::GaugePressure;
use crate::simulation::{InitialAngle, JointInitial, JointRig, JointState};
use alloc::vec::Vec;

/// What holds a joint in balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointBalance {
    /// Gauge pressures of agonist and antagonist; the angle follows.
    AtPressures([GaugePressure; 2]),
    /// An angle in rad and the stiffness in N·m/rad that the two actuators, with their tendons in series, give it at kept
    /// pressures; the pressures follow.
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
    /// All states but lengths that both tensions of a tendon give: angle, angular velocity, and pressure and air mass of each;
    /// behind these those of tendons, hoses, supplies, regulators and spools.
    pub system: StateSpace,
    /// The model of the joint's plant.
    pub plant: PlantLinearization,
    view: JointPlant,
}

/// Linearises a joint in balance with both valves held shut; the air of each has a temperature in K there, or under heat
/// transfer that of the wall.
///
/// # Errors
/// [`Error::OutOfRange`] or [`Error::Inconsistent`] for numbers outside the physics or a stiffness that no two pressures
/// give; [`Error::NoSolution`] when there is no balance, or an actuator is slack or at its shortest there; and as
/// [`linearize_plant`].
pub fn linearize_joint(
    rig: &JointRig,
    balance: JointBalance,
    temperature: [f64; 2],
) -> Result<JointLinearization, Error> {
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
    let gauge = [0, 1].map(|i| state.pressure[i].gauge(rig.driven()[i].actuator.air().atmosphere()));
    JointLinearization::at(rig, state, &PlantBalance::Shut(gauge.to_vec()))
}

/// Linearises a joint with its valves as commanded, pulses on average: the commands give the pressures, these the angle. The air
/// is as a [`PlantAir`] says, coming from a start.
///
/// # Errors
/// [`Error::Misuse`] when neither command is a PWM, a set point or a position; [`Error::NoSolution`] when the air comes to no
/// steady state; and as [`linearize_joint`].
pub fn linearize_driven_joint(rig: &JointRig, start: &JointState, air: &PlantAir) -> Result<JointLinearization, Error> {
    let view = JointPlant::new(rig)?;
    if !view.plant().network().valves.iter().any(|valve| valve.command.is_continuous()) {
        return Err(Error::Misuse {
            what: "there is no PWM to average, no set point and no position on either actuator of the joint",
            remedy: "set command.kind = \"pwm\", or linearise with the valves held",
        });
    }
    let found = steady_air(view.plant(), &view.start(start), &PlantBalance::Driven, air)?;
    let pressure = [found[0].0, found[1].0];
    let angle = rig.equilibrium(pressure)?;
    let lengths = rig.lengths(angle, pressure);
    let air_mass = [0, 1].map(|i| {
        let actuator = &rig.driven()[i].actuator;
        actuator.air().mass(pressure[i], actuator.volume(lengths[i]), found[i].1)
    });
    let state = JointState { angle, angular_velocity: 0.0, pressure, air_mass };
    JointLinearization::at(rig, state, &PlantBalance::Driven)
}

/// Refuses a point at which an actuator is slack or at its shortest.
fn check(rig: &JointRig, state: &JointState) -> Result<(), Error> {
    let lengths = rig.lengths(state.angle, state.pressure);
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
    let actuators = rig.driven().each_ref().map(|driven| &driven.actuator);
    let on_tendons = rig.fittings().iter().any(|of| of.tendon.is_some());
    if on_tendons || actuators.iter().any(|actuator| actuator.law().law.ideal().is_none()) {
        return searched_pressures(rig, angle, parameter::SET_STIFFNESS.check(stiffness)?);
    }
    let leverage = rig.joint().leverage(Dual::<f64, 1>::variable(angle, 0));
    let (lengths, arms) = (leverage.lengths.map(|length| length.value), leverage.arms.map(|arm| arm.value));
    let pair =
        AntagonisticPair::new(actuators, lengths, arms)?.with_arm_slopes(leverage.arms.map(|arm| arm.slope[0]))?;
    pair.pressures(-rig.joint().other_torque(angle, 0.0), stiffness, Held::Pressures)
}

/// These pressures for any law of force and on tendons, by Newton steps from equal pressures: both equations are nearly linear.
fn searched_pressures(rig: &JointRig, angle: f64, stiffness: f64) -> Result<[GaugePressure; 2], Error> {
    /// Pressure in Pa at which it starts, the difference in Pa that gives a slope, and the part of a change that is rounding.
    const START: f64 = 2e5;
    const DIFFERENCE: f64 = 1.0;
    const ROUNDING: f64 = 1e-12;
    const MOST_STEPS: usize = 100;
    let arms = rig.joint().leverage(angle).arms;
    let other = rig.joint().other_torque(angle, 0.0);
    let air = rig.driven().each_ref().map(|driven| driven.actuator.air());
    let absolute = |gauge: [f64; 2]| [0, 1].map(|i| GaugePressure(gauge[i]).absolute(air[i].atmosphere()));
    let left = |gauge: [f64; 2]| {
        let pressure = absolute(gauge);
        let lengths = rig.lengths(angle, pressure);
        let pull = [0, 1].map(|i| arms[i] * rig.driven()[i].actuator.static_force(lengths[i], pressure[i].0).max(0.0));
        [pull[0] - pull[1] + other, rig.stiffness(angle, pressure, Held::Pressures) - stiffness]
    };
    let mut gauge = [START; 2];
    for _ in 0..MOST_STEPS {
        let now = left(gauge);
        let along = |i: usize| {
            let mut there = gauge;
            there[i] += DIFFERENCE;
            let there = left(there);
            [0, 1].map(|row| (there[row] - now[row]) / DIFFERENCE)
        };
        let [[a, c], [b, d]] = [along(0), along(1)];
        let determinant = a * d - b * c;
        if determinant == 0.0 {
            break;
        }
        let change = [(b * now[1] - d * now[0]) / determinant, (c * now[0] - a * now[1]) / determinant];
        // Pressures stay above the atmosphere's on the way.
        let part = (0..2).map(|i| if change[i] < 0.0 { -0.9 * gauge[i] / change[i] } else { 1.0 }).fold(1.0, f64::min);
        gauge = [0, 1].map(|i| gauge[i] + part * change[i]);
        if !gauge.iter().all(|gauge| gauge.is_finite() && *gauge > ROUNDING) {
            break;
        }
        if part == 1.0 && (0..2).all(|i| change[i].abs() <= ROUNDING * (gauge[i] + START)) {
            return Ok(gauge.map(GaugePressure));
        }
    }
    Err(Error::NoSolution {
        what: "no two pressures above the atmosphere's give the joint this stiffness at this angle",
        remedy: "give another stiffness or angle",
    })
}

impl JointLinearization {
    fn at(rig: &JointRig, state: JointState, how: &PlantBalance) -> Result<Self, Error> {
        check(rig, &state)?;
        let view = JointPlant::new(rig)?;
        let start = view.start(&state);
        let air = PlantAir::Temperatures(start.air.iter().map(|air| air.temperature).collect());
        let plant = linearize_plant(view.plant(), &start, how, &air)?;
        let system = view.words().named(&plant.system);
        Ok(Self { rig: rig.clone(), state, system, plant, view })
    }

    /// The pulsed valves that the model averages, of agonist and antagonist.
    pub fn averages(&self) -> &[ValveAverage] {
        &self.plant.averages
    }

    /// The model without each air mass that follows from pressure and angle, because the process keeps `P (V/m)^κ`: the same
    /// inputs, outputs and poles, less the invariants' at zero.
    pub fn minimal(&self) -> StateSpace {
        self.view.words().named(&self.plant.minimal())
    }

    /// The values of the inputs at the point, each by its name, those that keep what is given included.
    pub fn inputs(&self) -> Vec<(Signal, f64)> {
        self.view.words().inputs(&self.plant)
    }

    /// What one input of a model of this linearisation reaches: [`JointLinearization::system`] or
    /// [`JointLinearization::minimal`]. The usual size of a pressure or a mass of air is its value at the operating point, that
    /// of the angle a radian, and that of the angular velocity a radian in a time of the fastest pole.
    ///
    /// # Errors
    /// As [`StateSpace::poles`].
    #[cfg(feature = "analysis")]
    pub fn controllability(
        &self,
        system: &StateSpace,
        input: usize,
    ) -> Result<crate::linearize::Controllability, Error> {
        self.view.words().controllability(&self.plant, system, input)
    }

    /// By how much less and by how much more torque than that of the balance, in N·m, the Coulomb friction of both actuators
    /// holds at the point.
    pub fn coulomb_bounds(&self) -> [f64; 2] {
        let arms = self.rig.joint().leverage(self.state.angle).arms;
        let [agonist, antagonist] = [0, 1].map(|i| self.plant.coulomb_bounds(i).map(|bound| arms[i] * bound));
        [agonist[0] + antagonist[1], agonist[1] + antagonist[0]]
    }
}

impl JointPlant {
    /// What the parts of the plant are called.
    fn words(&self) -> Words<'_> {
        Words { plant: &self.plant, feeds: &self.feeds, whose: PAIR }
    }
}
