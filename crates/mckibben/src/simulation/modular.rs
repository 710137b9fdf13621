//! The modular actuator in a loop of one's own: what is asked of the valve and where the ends are in, force out.
//!
//! ```text
//! drive     what is asked of the valve from now on: a request, or pulses of a duty cycle
//! move_to   the ends go in a straight line to where they are at the end of the step; air, seats and memory follow,
//!           with every motion of a seat and every edge of a pulse at its instant within the step
//! respond   the tension and its derivatives there
//! ```
//!
//! A robot's simulator knows how long each actuator is and wants to know how hard it pulls; everything else is kept here.
//! A step allocates nothing and costs the same whatever its length; the air is stable at any.
//!
//! ```
//! use mckibben::control::Drive;
//! use mckibben::simulation::{ModularActuator, Rig, State};
//! use mckibben::valve::Request;
//!
//! # fn lifts(rig: &Rig, start: State) -> Result<(), mckibben::Error> {
//! let (mut actuator, mass) = (ModularActuator::new(rig, start, 25.0)?, 2.0);
//! let [mut length, mut velocity, step] = [start.length, 0.0, 1e-3];
//! actuator.drive(Drive::Pulses { duty: 0.6, pulse: Request::Fill, rest: Request::Exhaust })?;
//! for count in 1..=1000 {
//!     let tension = actuator.respond(velocity).tension;
//!     velocity += (9.81 - tension / mass) * step;
//!     length += velocity * step;
//!     actuator.move_to(f64::from(count) * step, length)?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! At rest the dry friction of (12) is set-valued and the response has its middle, zero: a load that it would hold creeps,
//! until whoever owns the load treats it as stuck. A Maxwell-slip hysteresis holds by itself.
//!
//! Checked by `tests/modular.rs`.

use super::course::Course;
use super::fixed_step::{Walk, check_plumbing, stepped};
use super::hosed::of_rig;
use super::kernel::Method;
use super::rig::{Rig, State};
use super::sample::Sample;
use crate::actuator::{ActuatorState, Response};
use crate::control::{Drive, Modulator};
use crate::error::Error;
use crate::load::Line;
use crate::pressure::AbsolutePressure;
use crate::scalar::Real;
use crate::valve::{Ports, Request, is_due};

/// One actuator with its air, its valve and its air line, whose ends somebody else moves.
#[derive(Clone, Debug)]
pub struct ModularActuator<R: Real<Time = R> = f64> {
    rig: Rig<R>,
    walk: Walk<R>,
    modulator: Modulator<R>,
    pulse_frequency: R,
}

impl<R: Real<Time = R>> ModularActuator<R> {
    /// The actuator of a rig at t = 0 in a state, with its coils released; pulses come at `pulse_frequency` in Hz. The
    /// rig's load and command do not count.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the frequency is above zero and finite; [`Error::Unsupported`] for a line that fixed
    /// steps cannot take, and for a valve without seats.
    pub fn new(rig: &Rig<R>, start: State<R>, pulse_frequency: R) -> Result<Self, Error> {
        crate::parameter::PWM_FREQUENCY.check(pulse_frequency.value())?;
        check_plumbing(rig)?;
        if rig.actuation().is_some_and(|drive| !drive.solenoid.has_seats()) {
            return Err(Error::Unsupported {
                what: "a modular actuator is driven by requests, which neither a pressure regulator nor a proportional spool takes",
                remedy: "choose a valve with seats such as valve.kind = \"three-way\"",
            });
        }
        let rig = rig.clone().guided();
        let mut walk = Walk::new(&rig, stepped(start));
        walk.course.held.line = Line::resting(start.length);
        walk.pass(&rig, &rig.seats());
        Ok(Self { rig, walk, modulator: Modulator::idle(), pulse_frequency })
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.walk.course.time
    }

    /// Length, velocity of the last step, pressure and air mass at that time.
    pub fn state(&self) -> State<R> {
        State::from_array(of_rig(&self.walk.course.state))
    }

    /// Which passages are open at that time.
    pub fn ports(&self) -> Ports {
        self.walk.ports
    }

    /// Everything that is known at that time, the tension with the velocity of the last step.
    pub fn sample(&self) -> Sample<R> {
        self.walk.sample(&self.rig)
    }

    /// What is asked of the valve from now on. Pulses begin with the next period.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when there is no valve, or it cannot do what is asked; [`Error::OutOfRange`] for a duty
    /// cycle outside 0 to 1. Then nothing has changed.
    pub fn drive(&mut self, drive: Drive<R>) -> Result<(), Error> {
        let Some(actuation) = self.rig.actuation() else {
            return Err(Error::Unsupported {
                what: "something is asked of a valve, but the actuator has none",
                remedy: "give the actuator a valve, or leave it sealed",
            });
        };
        match drive {
            Drive::Steady(request) => actuation.solenoid.check_request(request)?,
            Drive::Pulses { duty, pulse, rest } => {
                crate::parameter::DUTY.check(duty.value())?;
                actuation.solenoid.check_request(pulse)?;
                actuation.solenoid.check_request(rest)?;
            }
        }
        let time = self.time();
        let asked = self.modulator.command(drive, time, self.pulse_frequency);
        self.ask(time, asked);
        self.walk.pass(&self.rig, &self.rig.seats());
        Ok(())
    }

    /// The ends go in a straight line to a distance of `length` m at `until` s, later than the time that has been reached.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a time that is not later; [`Error::Stopped`] when that leaves the physics. The actuator is
    /// then where it was last.
    pub fn move_to(&mut self, until: R, length: R) -> Result<(), Error> {
        let (from, before) = (self.time(), (self.walk, self.modulator));
        if !from.lt(until) {
            return Err(Error::Unsupported {
                what: "the ends of an actuator cannot be moved back in time or in no time",
                remedy: "give move_to a time later than the last",
            });
        }
        let course = &mut self.walk.course;
        let slope = (length - course.state[0]) / (until - from);
        course.held.line = Line { time: from, length: course.state[0], slope };
        course.state[1] = slope;
        course.enter(&self.rig);
        while let Some(edge) = self.modulator.next(self.pulse_frequency).filter(|edge| is_due(*edge, until)) {
            // The air does not feel an edge, only the seats that move up to it.
            while let Some(instant) = self.rig.seats().next(&self.walk.progress, edge.smaller(until)) {
                self.advance_to(instant.smaller(until), &before)?;
            }
            // A period that begins with the step may lie a rounding before it.
            let asked = self.modulator.pass(edge, self.pulse_frequency);
            self.ask(edge.larger(from), asked);
        }
        self.advance_to(until, &before)
    }

    /// Goes on to `until` with what is asked; where that leaves the physics, back to where everything was `before`.
    fn advance_to(&mut self, until: R, before: &(Walk<R>, Modulator<R>)) -> Result<(), Error> {
        let went = self.walk.advance_to(&self.rig, &self.rig.seats(), Method::Stable, until, None);
        if went.is_err() {
            (self.walk, self.modulator) = *before;
        }
        went
    }

    /// All that a step changes.
    pub(super) fn going(&self) -> (Walk<R>, Modulator<R>) {
        (self.walk, self.modulator)
    }

    /// Back to before a step that was only tried.
    pub(super) fn back_to(&mut self, (walk, modulator): (Walk<R>, Modulator<R>)) {
        (self.walk, self.modulator) = (walk, modulator);
    }

    /// The tension, its derivatives and the rates of the state, while the ends move apart at `velocity` in m/s.
    pub fn respond(&self, velocity: R) -> Response<R> {
        let Course { state, held, .. } = &self.walk.course;
        let [length, _, pressure, air_mass, _] = *state;
        let actuator = self.rig.actuator();
        let of_air = ActuatorState { pressure: AbsolutePressure(pressure), air_mass, memory: held.memory };
        let alone = actuator.respond(&of_air, length, velocity, self.ports());
        // The flow may come through a hose, and a leak takes some.
        let flow = self.rig.observe(self.time(), state, held).flow;
        let slack = actuator.limits().is_slack(length);
        let chamber = actuator.chamber(length, velocity, pressure, air_mass, slack);
        Response { pressure_rate: actuator.pressure_rate(&chamber, &flow), mass_flow: flow.net(), ..alone }
    }

    fn ask(&mut self, time: R, request: Option<Request>) {
        if let (Some(request), Some(actuation)) = (request, self.rig.actuation()) {
            self.walk.progress.ask(time, &actuation.solenoid, request);
        }
    }
}
