//! The linear model of one actuator with its load: the point, and the plant's model in its words.
//!
//! | requested | the valve | the point |
//! |---|---|---|
//! | a [`Balance`] | held shut | two of gauge pressure, length and load |
//! | [`Aim::Duty`], [`Aim::Command`] | by its command, pulses on average | the pressure that it makes, then the length or the load |
//! | [`Aim::Balance`] | by the command that holds it | as held shut |
//!
//! Air flows by pressures and densities alone, so what a command makes of the pressure is found first, and the load is brought to
//! balance there. With heat exchanged on the way the temperature follows from the flow.
//!
//! Checked by `tests/linearize.rs`, `tests/linearize_pwm.rs`, `tests/linearize_tendon.rs` and `tests/linearize_line.rs`.

use super::RigPlant;
use super::point::{Balance, Content, OperatingPoint, balanced};
use crate::error::Error;
use crate::linearize::{Signal, StateSpace};
use crate::parameter;
use crate::plant::linear::{PlantAir, PlantBalance, PlantLinearization, ValveAverage, linearize_plant, steady_air};
use crate::plant::named::{ALONE, Words};
use crate::simulation::{Rig, State};
use crate::valve::{period, with_duty};
use alloc::vec;
use alloc::vec::Vec;

/// What of a driven valve is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// The rig's own command, which gives the pressure: the duty of a PWM on average, the last set point of a regulator, the
    /// last position of a spool, the last request of a schedule. The length follows from the rig's load.
    Command,
    /// The rig's own command and a length in m; the load follows, unless both ends are held.
    CommandAtLength(f64),
    /// The duty of a PWM, which gives the pressure; the length follows from the rig's load.
    Duty(f64),
    /// The duty of a PWM and a length in m; the load follows, unless both ends are held.
    DutyAtLength(f64, f64),
    /// A balance, which gives the pressure; the duty, the set point or the position of the spool follows.
    Balance(Balance),
}

/// A rig near an operating point.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// Where.
    pub point: OperatingPoint,
    /// All states but a length that both tensions of a tendon give: length, velocity, pressure and air mass, as far as they can
    /// move; on a tendon those of the load in addition to the actuator's; behind these the states of hose, supply,
    /// regulator and spool.
    pub system: StateSpace,
    /// The model of the rig's plant.
    pub plant: PlantLinearization,
    view: RigPlant,
    driven: bool,
}

/// Linearises a rig with its valve held shut; the mass flow into the actuator is an input, and how far the paths of the valve are
/// open.
///
/// # Errors
/// As [`OperatingPoint::held`] and [`linearize_plant`].
pub fn linearize(rig: &Rig, balance: Balance, content: Content) -> Result<Linearization, Error> {
    let point = OperatingPoint::held(rig, balance, content)?;
    let how = PlantBalance::Shut(vec![point.gauge_pressure()]);
    Linearization::at(point, &how)
}

/// Linearises a rig with its valve as commanded, pulses on average; the command is the first input.
///
/// # Errors
/// [`Error::Misuse`] when there is no such command, and for a temperature that is given under the energy balance, where it follows
/// from the flow; [`Error::NoSolution`] when no air ever flows, or no command that the valve can follow holds the pressure; and as
/// [`OperatingPoint::held`] and [`linearize_plant`].
pub fn linearize_driven(rig: &Rig, aim: Aim, content: Content) -> Result<Linearization, Error> {
    if !OperatingPoint::keeps_content(rig) && matches!(content, Content::Temperature(_)) {
        return Err(Error::Misuse {
            what: "under the energy balance the temperature follows from the flow: it cannot be given",
            remedy: "leave the temperature out",
        });
    }
    let length = match aim {
        Aim::CommandAtLength(length) | Aim::DutyAtLength(_, length) => Some(length),
        _ => None,
    };
    let rig = match aim {
        Aim::Duty(duty) | Aim::DutyAtLength(duty, _) => pulsed(rig, parameter::DUTY.check(duty)?)?,
        _ => rig.clone(),
    };
    if let Aim::Balance(balance) = aim {
        if !is_followed(&rig) {
            return Err(Error::Misuse {
                what: "there is no PWM, no set point and no position that could hold a pressure: the command is another",
                remedy: "set command.kind = \"pwm\", or linearise with the valve held",
            });
        }
        let (rig, pressure, length) = balanced(&rig, balance)?;
        let point = OperatingPoint::filled(rig, pressure, length, content)?;
        let how = PlantBalance::DrivenAt(vec![point.gauge_pressure()]);
        return Linearization::at(point, &how);
    }
    let steady = steady(&rig, content)?;
    let gauge = steady.pressure.gauge(rig.actuator().air().atmosphere());
    let balance = length.map_or(Balance::AtPressure(gauge), |length| Balance::AtBoth(gauge, length));
    let (rig, pressure, length) = balanced(&rig, balance)?;
    let point = OperatingPoint::filled(rig, pressure, length, Content::Of(steady))?;
    Linearization::at(point, &PlantBalance::Driven)
}

fn is_followed(rig: &Rig) -> bool {
    rig.actuation()
        .is_some_and(|actuation| actuation.command.is_continuous() || actuation.solenoid.regulator().is_some())
}

/// The rig under a PWM of another duty.
fn pulsed(rig: &Rig, duty: f64) -> Result<Rig, Error> {
    const NO_PWM: Error = Error::Misuse {
        what: "there is no PWM to average: the command is another, or the actuator has no valve",
        remedy: "set command.kind = \"pwm\", or linearise with the valve held",
    };
    let actuation = rig.actuation().ok_or(NO_PWM)?;
    let command = with_duty(&actuation.command, duty).ok_or(NO_PWM)?;
    let intervals = period(&actuation.solenoid, &command).ok_or(NO_PWM)?;
    if intervals.iter().all(|part| part.openings == [0.0; 2]) && rig.line().leakage.is_none() {
        return Err(Error::NoSolution {
            what: "at this duty the valve never opens: any pressure stays as it is",
            remedy: "give a duty at which the pulse is longer than the opening delay, or hold the valve",
        });
    }
    Ok(rig.commanded(command))
}

/// A state in which as much air comes as goes under the rig's command, at some length.
fn steady(rig: &Rig, content: Content) -> Result<State, Error> {
    let limits = rig.actuator().limits();
    let air = rig.actuator().air();
    let (from, filled) = match content {
        Content::Of(state) => (state, PlantAir::Start),
        Content::Temperature(kelvin) => {
            let kelvin = parameter::INITIAL_TEMPERATURE.check(kelvin)?;
            let (length, pressure) = (0.5 * (limits.min_length() + limits.max_length()), air.atmosphere());
            let air_mass = air.mass(pressure, rig.actuator().volume(length), kelvin);
            (State { length, velocity: 0.0, pressure, air_mass }, PlantAir::Temperatures(vec![kelvin]))
        }
    };
    let view = RigPlant::new(rig);
    let found = steady_air(view.plant(), &view.start(&from), &PlantBalance::Driven, &filled)?;
    let (pressure, temperature) = found[0];
    let air_mass = air.mass(pressure, rig.actuator().volume(from.length), temperature);
    Ok(State { pressure, air_mass, ..from })
}

impl Linearization {
    /// The model of a point that is in balance.
    fn at(point: OperatingPoint, how: &PlantBalance) -> Result<Self, Error> {
        let view = RigPlant::new(&point.rig);
        let air = PlantAir::Temperatures(vec![point.temperature()]);
        let plant = linearize_plant(view.plant(), &view.start(&point.state), how, &air)?;
        let mut point = point;
        // What flows leave of the temperature is the plant's to say.
        if !OperatingPoint::keeps_content(&point.rig) {
            point.state.air_mass = plant.point.state[plant.point.plant.indices().actuators[0].mass()];
        }
        let driven = !matches!(how, PlantBalance::Shut(_));
        Ok(Self::of(point, view, (plant, driven)))
    }

    fn of(point: OperatingPoint, view: RigPlant, (plant, driven): (PlantLinearization, bool)) -> Self {
        let system = view.words().named(&plant.system);
        Self { point, system, plant, view, driven }
    }

    /// The valve under PWM on average, if that is part of the model.
    pub fn averaged(&self) -> Option<&ValveAverage> {
        self.plant.averages.first()
    }

    /// Whether the valve is as commanded, and not held shut.
    pub fn is_driven(&self) -> bool {
        self.driven
    }

    /// The model with Coulomb friction replaced by the viscous damping that takes as much energy from an oscillation of
    /// `amplitude` (m) at `angular_frequency` (rad/s), both above zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn with_equivalent_damping(&self, amplitude: f64, angular_frequency: f64) -> Result<Self, Error> {
        let plant = self.plant.with_equivalent_damping(&[Some((amplitude, angular_frequency))])?;
        Ok(Self::of(self.point.clone(), self.view.clone(), (plant, self.driven)))
    }

    /// `c_eq` in N·s/m, for an oscillation of `amplitude` (m) at `angular_frequency` (rad/s), both above zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn equivalent_damping(&self, amplitude: f64, angular_frequency: f64) -> Result<f64, Error> {
        self.plant.equivalent_damping(0, amplitude, angular_frequency)
    }

    /// The model without the air mass, where the process keeps `P (V/m)^κ` and the air mass follows from pressure and
    /// length, and without the bristles of LuGre's law: as [`PlantLinearization::minimal`].
    pub fn minimal(&self) -> StateSpace {
        self.view.words().named(&self.plant.minimal())
    }

    /// The values of the inputs at the point, each by its name, those that keep what is given included.
    pub fn inputs(&self) -> Vec<(Signal, f64)> {
        self.view.words().inputs(&self.plant)
    }

    /// What one input of a model of this linearisation reaches: [`Linearization::system`] or
    /// [`Linearization::minimal`], with the usual sizes of [`PlantLinearization::controllability`].
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

    /// How far one output swings, peak to peak, under the valve's switching: by 24 harmonics of its openings through the model.
    /// `None` without a PWM.
    #[cfg(feature = "analysis")]
    pub fn ripple(&self, output: &str) -> Option<f64> {
        let words = self.view.words();
        let of = self.plant.system.outputs.iter().find(|its| words.output(its).name == output)?;
        self.plant.ripple(self.averaged()?.valve, *of)
    }
}

impl RigPlant {
    /// What the parts of the plant are called.
    fn words(&self) -> Words<'_> {
        Words { plant: &self.plant, feeds: core::slice::from_ref(&self.feed), whose: ALONE }
    }
}
