//! A rig: one actuator, what drives its valve, and its load. The paper's four-state system.
//!
//! ```text
//! dL/dt = v
//! dv/dt = (W − F(L, v, P))/M                         (16)
//! dP/dt = by the process of the air                  (19)
//! dm/dt = flow through the open paths             (21)
//! ```
//!
//! | state | name in code | unit |
//! |---|---|---|
//! | L | `length`, the distance between the attachments | m |
//! | v | `velocity`, positive when it grows | m/s |
//! | P | `pressure`, absolute | Pa |
//! | m | `air_mass` | kg |

use super::pressure_series::PressureSeries;
use crate::actuator::Actuator;
use crate::convert::{Convert, ConvertEach};
use crate::error::{Error, Requirement};
use crate::force::Statics;
use crate::friction::SlidingState;
use crate::line::Line;
use crate::load::{Load, SeriesTendon};
use crate::parameter::{self, Parameter};
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::{Over, Real, Scalar};
use crate::valve::{Command, Regulator, Solenoid, Valve};

/// What drives the valve.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuation<S = f64> {
    /// The solenoid and its delays.
    pub solenoid: Solenoid<S>,
    /// Its command over time.
    pub command: Command<S>,
}

/// One actuator, what drives its valve, and its load.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig<S = f64> {
    actuator: Actuator<S>,
    actuation: Option<Actuation<S>>,
    load: Load<S>,
    line: Line<S>,
    tendon: Option<SeriesTendon<S>>,
    pressure: Option<PressureSeries<S>>,
}

/// The four states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S = f64> {
    /// Distance between the attachments in m.
    pub length: S,
    /// Its rate in m/s, positive when the actuator lengthens.
    pub velocity: S,
    /// Absolute pressure of the air.
    pub pressure: AbsolutePressure<S>,
    /// Mass of the air in kg.
    pub air_mass: S,
}

impl<S: Scalar> State<S> {
    /// Length in m, velocity in m/s, absolute pressure in Pa and mass of the air in kg.
    pub fn to_array(self) -> [S; 4] {
        [self.length, self.velocity, self.pressure.0, self.air_mass]
    }

    /// The state of these four, in the order and the units of [`State::to_array`].
    pub fn from_array([length, velocity, pressure, air_mass]: [S; 4]) -> Self {
        Self { length, velocity, pressure: AbsolutePressure(pressure), air_mass }
    }
}

/// Where the length starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialLength<S = f64> {
    /// Where the load balances the static force at the initial pressure, on the taut braid if need be.
    Equilibrium,
    /// A distance between the attachments in m.
    At(S),
}

/// The start of an experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Initial<S = f64> {
    /// Gauge pressure in the actuator.
    pub gauge_pressure: GaugePressure<S>,
    /// Temperature in K, which fixes the mass of air.
    pub temperature: S,
    /// Distance between the attachments.
    pub length: InitialLength<S>,
    /// Velocity of lengthening in m/s.
    pub velocity: S,
}

impl<S: Scalar> Initial<S> {
    /// Converts the start to another scalar type.
    pub fn map<T: Scalar>(&self, mut convert: impl FnMut(&'static Parameter, S) -> T) -> Initial<T> {
        Initial {
            gauge_pressure: GaugePressure(convert(&parameter::INITIAL_GAUGE_PRESSURE, self.gauge_pressure.0)),
            temperature: convert(&parameter::INITIAL_TEMPERATURE, self.temperature),
            length: match self.length {
                InitialLength::Equilibrium => InitialLength::Equilibrium,
                InitialLength::At(length) => InitialLength::At(convert(&parameter::INITIAL_LENGTH, length)),
            },
            velocity: convert(&parameter::INITIAL_VELOCITY, self.velocity),
        }
    }
}

/// Checks that something drives the valve if there is one, and that the valve can carry out its command.
pub(super) fn check_drive(actuator: &Actuator, actuation: Option<&Actuation>) -> Result<(), Error> {
    match (actuation, actuator.valve()) {
        (None, Some(_)) => Err(Error::Misuse {
            what: "the actuator has a valve, but no command drives it",
            remedy: "give a command, or leave the valve out for a sealed actuator",
        }),
        (Some(_), None) => Err(Error::Misuse {
            what: "a command is given, but the actuator has no valve",
            remedy: "give the actuator a valve, or leave the command out",
        }),
        (Some(Actuation { solenoid, command }), Some(valve)) => {
            solenoid.check(command)?;
            check_set_points(command, valve)
        }
        (None, None) => Ok(()),
    }
}

/// That what feeds an actuator has a valve to feed it through, and that this is none that makes a pressure itself.
pub(super) fn check_line(actuator: &Actuator, actuation: Option<&Actuation>, line: &Line) -> Result<(), Error> {
    if actuator.valve().is_none() && (line.hose.is_some() || line.supply.is_some()) {
        return Err(Error::Misuse {
            what: "a hose or a reservoir is given, but the actuator has no valve",
            remedy: "give the actuator a valve or, before a hose, a pressure over time, or leave the hose and the reservoir out",
        });
    }
    let regulates = actuation.is_some_and(|actuation| actuation.solenoid.regulator().is_some());
    if regulates && line.supply.is_some() {
        return Err(Error::NotImplemented(&crate::limit::REGULATOR_SUPPLY));
    }
    Ok(())
}

/// That no set point lies above the supply.
fn check_set_points(command: &Command, valve: &Valve) -> Result<(), Error> {
    let supply = valve.supply.gauge_pressure().0;
    let mut set_points = (0..).map_while(|index| command.set_point(index));
    set_points.try_for_each(|(_, gauge)| Regulator::check_set_point(gauge, supply))
}

impl<S: Real> Actuation<S> {
    /// That the command has no more than [`MAX_COUNT`](parameter::MAX_COUNT) pulses in a run of `duration` s.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    pub fn check_counts(&self, duration: f64) -> Result<(), Error> {
        if let Command::Pwm { frequency, .. } = &self.command {
            let frequency = frequency.value();
            parameter::PWM_FREQUENCY.check_count(frequency, frequency * duration, "pulses")?;
        }
        Ok(())
    }
}

impl<S: Real> Rig<S> {
    /// That the command and the motion of the ends have no more than [`MAX_COUNT`](parameter::MAX_COUNT) pulses and periods in
    /// a run of `duration` s.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    pub fn check_counts(&self, duration: f64) -> Result<(), Error> {
        self.load.motion().map_or(Ok(()), |motion| motion.check_counts(duration))?;
        self.actuation.as_ref().map_or(Ok(()), |actuation| actuation.check_counts(duration))
    }
}

impl<S: Scalar> Actuation<S> {
    /// Converts the valve and its command to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Actuation<T> {
        Actuation { solenoid: self.solenoid.convert(convert), command: self.command.convert(convert) }
    }
}

/// That an initial gauge pressure and temperature (K) are physical.
pub(super) fn check_air(actuator: &Actuator, gauge: GaugePressure, temperature: f64) -> Result<(), Error> {
    parameter::INITIAL_GAUGE_PRESSURE.check(gauge.0)?;
    parameter::INITIAL_TEMPERATURE.check(temperature)?;
    let air = actuator.air();
    if gauge.absolute(air.atmosphere()).0 <= 0.0 {
        return Err(crate::valve::below_vacuum(&parameter::INITIAL_GAUGE_PRESSURE, gauge, air));
    }
    Ok(())
}

impl Rig {
    /// An actuator with its load, and with what drives its valve if it has one.
    ///
    /// # Errors
    /// [`Error::Misuse`] when the actuator has a valve and nothing drives it, the other way round, or the valve
    /// cannot carry out the command; [`Error::Inconsistent`] for a set point beyond the supply.
    pub fn new(actuator: Actuator, actuation: Option<Actuation>, load: Load) -> Result<Self, Error> {
        check_drive(&actuator, actuation.as_ref())?;
        Ok(Self { actuator, actuation, load, line: Line::NONE, tendon: None, pressure: None })
    }

    /// Adds an air line to the rig. A lumped hose lets the valve's poppets take effect later by its delay.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a hose with neither a valve nor a given pressure at its end, for a supply line without a valve, and
    /// for one that feeds a pressure regulator.
    pub fn with_line(self, line: Line) -> Result<Self, Error> {
        #[cfg(feature = "alloc")]
        if let Some(series) = &self.pressure {
            series.check(&self.actuator, &line)?;
            return Ok(Self { line, ..self });
        }
        check_line(&self.actuator, self.actuation.as_ref(), &line)?;
        Ok(Self { line, ..self }.with_transport())
    }

    /// The rig with an elastic tendon between actuator and load. A prescribed motion is that of both ends together.
    pub fn with_tendon(self, tendon: SeriesTendon) -> Self {
        Self { tendon: Some(tendon), ..self }
    }

    /// Sets the pressure that is given.
    #[cfg(feature = "alloc")]
    pub(super) fn driven_at(self, series: PressureSeries) -> Self {
        Self { pressure: Some(series), ..self }
    }

    /// Replaces the load of the rig.
    pub fn with_load(self, load: Load) -> Self {
        Self { load, ..self }
    }

    /// The state at the start.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::Inconsistent`] for a start outside the physics; [`Error::Misuse`] when an
    /// equilibrium is requested and there is none.
    pub fn start(&self, initial: &Initial) -> Result<State, Error> {
        check_air(&self.actuator, initial.gauge_pressure, initial.temperature)?;
        parameter::INITIAL_VELOCITY.check(initial.velocity)?;
        if let InitialLength::At(length) = initial.length {
            parameter::INITIAL_LENGTH.check(length)?;
            let law = &self.actuator.law().law;
            let end_length = law.end_length();
            if length >= end_length {
                return Err(Error::Inconsistent {
                    parameter: &parameter::INITIAL_LENGTH,
                    value: length,
                    requirement: Requirement {
                        relation: "must be less than",
                        other: law.end_name(),
                        value: end_length,
                        unit: "m",
                    },
                    remedy: "start between 0 and the thread length, or at \"equilibrium\"",
                });
            }
        }
        self.begin(initial)
    }
}

impl<S: Scalar> Rig<S> {
    /// Converts the rig to another scalar type; `function` receives each number with its parameter.
    pub fn map<T: Scalar>(&self, function: impl FnMut(&'static Parameter, S) -> T) -> Rig<T> {
        self.convert(&mut ConvertEach(function))
    }

    fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Rig<T> {
        let rig = Rig {
            actuator: self.actuator.convert(convert),
            load: self.load.convert(convert),
            line: self.line.convert(convert),
            tendon: self.tendon.as_ref().map(|tendon| tendon.convert(convert)),
            pressure: self.pressure.as_ref().map(|series| series.convert(convert)),
            actuation: self.actuation.as_ref().map(|actuation| actuation.convert(convert)),
        };
        rig.with_transport()
    }

    /// Delays the effect of the poppets by the transport delay of the line.
    fn with_transport(mut self) -> Self {
        let transport = self.line.hose.as_ref().map_or(S::zero(), |hose| hose.transport_delay());
        if let Some(actuation) = &mut self.actuation {
            actuation.solenoid = actuation.solenoid.seen_late(transport);
        }
        self
    }

    /// The air line.
    #[inline(always)]
    pub fn line(&self) -> &Line<S> {
        &self.line
    }

    /// The elastic tendon between actuator and load, if there is one.
    pub fn tendon(&self) -> Option<&SeriesTendon<S>> {
        self.tendon.as_ref()
    }

    /// The gauge pressure over time in the actuator, or at the inlet of its hose if it has one, where it is given.
    #[inline(always)]
    pub fn pressure_series(&self) -> Option<&PressureSeries<S>> {
        self.pressure.as_ref()
    }

    /// The pressure regulator in the valve's place, if there is one.
    pub fn regulator(&self) -> Option<&Regulator<S>> {
        self.actuation.as_ref()?.solenoid.regulator()
    }

    /// Whether there is an air line or a pressure regulator: most of them have states beyond the four.
    #[cfg(feature = "alloc")]
    pub(crate) fn has_air_network(&self) -> bool {
        !self.line.is_none() || self.regulator().is_some()
    }

    /// The actuator.
    #[inline(always)]
    pub fn actuator(&self) -> &Actuator<S> {
        &self.actuator
    }

    /// What drives the valve, unless the actuator is sealed.
    pub fn actuation(&self) -> Option<&Actuation<S>> {
        self.actuation.as_ref()
    }

    /// This rig with another command of its valve.
    #[cfg(feature = "alloc")]
    pub(crate) fn commanded(&self, command: Command<S>) -> Self {
        let mut rig = self.clone();
        if let Some(actuation) = &mut rig.actuation {
            actuation.command = command;
        }
        rig
    }

    /// The load.
    #[inline(always)]
    pub fn load(&self) -> &Load<S> {
        &self.load
    }

    /// The least and the largest tension in N that can be held at rest, at an actuator length and absolute pressure:
    /// `F_s + F_limit + F_h ± Q k_sec` with the hysteresis `F_h`, and any from zero up on the shortest length.
    #[inline(always)]
    pub fn holdable<T: Over<S>>(&self, length: T, pressure: T, sliding_state: impl Into<SlidingState<T>>) -> (T, T) {
        let on_the_stop = length.le(T::of(self.actuator.limits().min_length()));
        self.actuator.holdable(length, pressure, on_the_stop, sliding_state)
    }
}

impl<S: Real> Rig<S> {
    /// The state at a start that has been checked, over any scalar with one value.
    ///
    /// # Errors
    /// [`Error::NoSolution`] when an equilibrium is requested and there is none.
    pub fn begin(&self, initial: &Initial<S>) -> Result<State<S>, Error> {
        let air = self.actuator.air();
        let gauge = match self.pressure.as_ref().filter(|_| self.line.hose.is_none()) {
            Some(series) => GaugePressure(series.gauge_at(S::zero())),
            None => initial.gauge_pressure,
        };
        let pressure = gauge.absolute(air.atmosphere());
        let (length, velocity) = match (&self.load, initial.length) {
            (Load::Prescribed(motion), _) => {
                let [distance, velocity, _] = motion.at(S::zero(), 0);
                let balance = |tendon: &SeriesTendon<S>| tendon.balance(&self.actuator, distance, pressure.0);
                (self.tendon.as_ref().map_or(distance, balance), velocity)
            }
            (Load::Isometric, InitialLength::At(length)) => (length, S::zero()),
            (_, InitialLength::At(length)) => (length, initial.velocity),
            (_, InitialLength::Equilibrium) => (self.equilibrium(pressure)?, initial.velocity),
        };
        let air_mass = air.mass(pressure, self.actuator.volume(length), initial.temperature);
        Ok(State { length, velocity, pressure, air_mass })
    }

    /// The distance in m at which the load balances the static force at a pressure, without friction; on the taut braid
    /// if need be, and at the shortest length when the actuator pulls harder than the load even there.
    ///
    /// # Errors
    /// [`Error::NoSolution`] when the load has no equilibrium: an isometric one, or one that pushes.
    pub fn equilibrium(&self, pressure: AbsolutePressure<S>) -> Result<S, Error> {
        let Some(inertia) = self.load.inertia() else {
            return Err(Error::NoSolution {
                what: "an isometric load has no equilibrium length: it holds any length",
                remedy: "give initial.length a length",
            });
        };
        self.actuator.length_under(inertia.pull, pressure)
    }
}
