//! The modular actuator in a loop of one's own: what is asked of the valve and where the ends are in, force out.
//!
//! ```text
//! drive     what is asked of the valve from now on: a request, or pulses of a duty cycle
//! move_to   the ends go in a straight line to where they are at the end of the step; air, seats and memory follow,
//!           with every motion of a seat and every edge of a pulse at its instant within the step; an edge where the
//!           step ends belongs to the next, so that a command that is given there comes before it
//! respond   the tension and its derivatives there
//!
//! limit_step    the longest part of a step that the air is integrated over in one go
//! rest_length   the length at which it pulls nothing
//!
//! snapshot  where it is now
//! restore   back to there, as for a step that is only tried
//! ```
//!
//! A robot's simulator knows how long each actuator is and wants to know how hard it pulls; everything else is kept here.
//! A step allocates nothing and costs the same whatever its length, but for pulses within it; the air is stable at any.
//!
//! The air's error grows with the square of the step. [`ModularActuator::limit_step`] divides each step into equal parts, along
//! which the length is interpolated linearly and the velocity is constant, so that a host with long steps has the air of a
//! host with short ones that moves the ends in the same straight lines.
//!
//! A host asks for the force where the ends are, takes its own step with it, and moves the ends to where they are then. A host
//! that moves first, to where the ends were, has forces that lag its lengths by a step, which makes a stiff end unstable.
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
//! until whoever owns the load treats it as stuck. A Maxwell-slip hysteresis holds by itself. Requests take effect without the
//! delay of a hose.
//!
//! Several on one supply are a [plant](crate::plant) whose ends a host [moves](crate::plant::PlantSteps::move_to).
//!
//! Checked by `tests/modular.rs`.

use super::course::Course;
use super::fixed_step::{Walk, stepped};
use super::kernel::Method;
use super::piped::of_rig;
use super::rig::{Rig, State};
use super::sample::Sample;
use super::snapshot::Snapshot;
use crate::actuator::{ActuatorState, Response};
use crate::air::Chamber;
use crate::control::{Drive, Modulator};
use crate::error::Error;
use crate::force::Statics;
use crate::load::Line;
use crate::parameter;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::Real;
use crate::valve::{Ports, Request, is_due};

/// One actuator with its air, its valve and its air line, whose ends somebody else moves.
#[derive(Clone, Debug)]
pub struct ModularActuator<R: Real<Time = R> = f64> {
    rig: Rig<R>,
    walk: Walk<R>,
    modulator: Modulator<R>,
    pulse_frequency: R,
    /// In s; infinite where steps are not divided.
    longest_part: R,
}

/// Parts of a step, and edges of pulses within it, at most: more would take minutes, and nobody means them.
pub const MOST_PARTS: f64 = 1e7;
/// Pulses from t = 0 on that can be counted.
const MOST_PULSES: f64 = 9e15;
/// A part that is this much longer than the longest is as long.
const ROUNDING: f64 = 1e-9;

/// Where an actuator is, to go back to.
pub(super) type Place<R> = (Walk<R>, Modulator<R>);

impl<R: Real<Time = R>> ModularActuator<R> {
    /// The actuator of a rig at t = 0 in a state, with its coils released; pulses come at `pulse_frequency` in Hz. The
    /// rig's load and command do not count.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the frequency is above zero and finite; [`Error::Misuse`] for a tendon in
    /// series, and for a valve without seats.
    pub fn new(rig: &Rig<R>, start: State<R>, pulse_frequency: R) -> Result<Self, Error> {
        parameter::PWM_FREQUENCY.check(pulse_frequency.value())?;
        if rig.tendon().is_some() {
            return Err(Error::NotImplemented(&crate::limit::MODULAR_TENDON));
        }
        rig.check_fixed_steps()?;
        if rig.actuation().is_some_and(|drive| !drive.solenoid.has_seats()) {
            return Err(Error::NotImplemented(&crate::limit::MODULAR_VALVE));
        }
        let rig = rig.clone().guided();
        let mut walk = Walk::new(&rig, stepped(&rig, start));
        walk.course.held.line = Line::resting(start.length);
        walk.pass(&rig, &rig.seats());
        let longest_part = R::constant(f64::INFINITY);
        Ok(Self { rig, walk, modulator: Modulator::idle(), pulse_frequency, longest_part })
    }

    /// Divides every step from now on into equal parts no longer than `longest` in s; infinity leaves steps whole.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless `longest` is above zero. Then nothing has changed.
    pub fn limit_step(&mut self, longest: R) -> Result<(), Error> {
        if longest.value() != f64::INFINITY {
            parameter::STEP.check(longest.value())?;
        }
        self.longest_part = longest;
        Ok(())
    }

    /// Parts that a move to `until` in s takes, counted before they are taken: those of [`ModularActuator::limit_step`], and
    /// the edges of the pulses. More than [`MOST_PARTS`] are refused.
    pub fn parts_until(&self, until: R) -> f64 {
        self.parts_of(until - self.time()) + self.edges_until(until)
    }

    /// Edges of pulses up to `until` in s, give or take one period.
    pub fn edges_until(&self, until: R) -> f64 {
        match self.modulator.drive() {
            Some(Drive::Pulses { .. }) => 2.0 * ((until - self.time()) * self.pulse_frequency).value(),
            _ => 0.0,
        }
    }

    /// Parts of a span in s without edges.
    fn parts_of(&self, span: R) -> f64 {
        let parts = (span / self.longest_part).value() - ROUNDING;
        // Without the standard library: up to the next whole number, as long as there are others.
        let whole = parts as u64 as f64;
        let next = if whole < parts { whole + 1.0 } else { whole };
        (if parts < MOST_PARTS { next } else { parts }).max(1.0)
    }

    /// What the distance between the ends must be less than in m, and the name of that limit: the length of a thread, where
    /// no wall and no fitting comes before it.
    pub fn end_length(&self) -> (&'static str, R) {
        let law = &self.rig.actuator().law().law;
        (law.end_name(), law.end_length())
    }

    /// The longest distance in m between the ends at which the actuator, at rest at a gauge pressure and without friction,
    /// does not pull; its shortest length where it pulls even there.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::Inconsistent`] for a pressure that air cannot have; [`Error::Misuse`] where the
    /// braid pushes up to the length at which its law ends.
    pub fn rest_length(&self, gauge: GaugePressure<R>) -> Result<R, Error> {
        self.rig.actuator().rest_length(gauge)
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.walk.course.time
    }

    /// Length, velocity of the last step, pressure and air mass at that time.
    pub fn state(&self) -> State<R> {
        State::from_array(of_rig(&self.walk.course.state))
    }

    /// Where the actuator is.
    pub fn snapshot(&self) -> Snapshot<R> {
        Snapshot(self.going())
    }

    /// Goes to where an actuator of the same rig was.
    pub fn restore(&mut self, snapshot: &Snapshot<R>) {
        self.back_to(snapshot.0);
        // Numbers do not say them, for they follow from where the seats are.
        self.walk.course.held.openings = self.rig.seats().openings(&self.walk.progress);
    }

    /// Which passages are open at that time.
    pub fn ports(&self) -> Ports {
        self.walk.ports
    }

    /// Everything that is known at that time, the tension with the velocity of the last step.
    pub fn sample(&self) -> Sample<R> {
        self.walk.sample(&self.rig)
    }

    /// What is asked of the valve from now on. Pulses begin with the next period, which may be now.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no valve, it cannot do what is asked, or has a dead time; [`Error::OutOfRange`] for
    /// a duty cycle outside 0 to 1. Then nothing has changed.
    pub fn drive(&mut self, drive: Drive<R>) -> Result<(), Error> {
        let Some(actuation) = self.rig.actuation() else {
            return Err(Error::Misuse {
                what: "something is asked of a valve, but the actuator has none",
                remedy: "give the actuator a valve, or leave it sealed",
            });
        };
        actuation.solenoid.check_acts_at_once()?;
        match drive {
            Drive::Steady(request) => actuation.solenoid.check_request(request)?,
            Drive::Pulses { duty, pulse, rest } => {
                parameter::DUTY.check(duty.value())?;
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
    /// [`Error::Misuse`] for a time that is not later, and for more than [`MOST_PARTS`] parts and edges of pulses;
    /// [`Error::Stopped`] when that leaves the physics. The actuator is then where it was last.
    pub fn move_to(&mut self, until: R, length: R) -> Result<(), Error> {
        let (from, before) = (self.time(), self.going());
        if !from.lt(until) {
            return Err(Error::Misuse {
                what: "the ends of an actuator cannot be moved back in time or in no time",
                remedy: "give a time later than the last",
            });
        }
        let pulses = if self.modulator.drive().is_some() { (until * self.pulse_frequency).value() } else { 0.0 };
        if !(self.parts_until(until) <= MOST_PARTS && pulses <= MOST_PULSES && until.value().is_finite()) {
            return Err(Error::Misuse {
                what: "a step has more than ten million parts and edges of pulses",
                remedy: "take a shorter step, pulses of a lower frequency, or longer parts",
            });
        }
        let course = &mut self.walk.course;
        let slope = (length - course.state[0]) / (until - from);
        course.held.line = Line { time: from, length: course.state[0], slope };
        course.state[1] = slope;
        course.enter(&self.rig);
        // An edge where the step ends waits: a command that is given there comes before it.
        while let Some(edge) = self.modulator.next(self.pulse_frequency).filter(|edge| !is_due(until, *edge)) {
            // The air does not feel an edge, only the seats that move up to it.
            while let Some(instant) = self.rig.seats().next(&self.walk.progress, edge.smaller(until)) {
                self.go_to(instant.smaller(until), &before)?;
            }
            // A period that begins with the step may lie a rounding before it.
            let asked = self.modulator.pass(edge, self.pulse_frequency);
            self.ask(edge.larger(from), asked);
        }
        while let Some(instant) = self.rig.seats().next(&self.walk.progress, until) {
            self.go_to(instant.smaller(until), &before)?;
        }
        self.go_to(until, &before)
    }

    /// Goes on to `until`, before which no seat moves, in as many parts as that takes.
    fn go_to(&mut self, until: R, before: &Place<R>) -> Result<(), Error> {
        let from = self.time();
        let parts = self.parts_of(until - from);
        let mut part = 1.0;
        while part < parts {
            self.part_to(from + (until - from) * R::constant(part / parts), before)?;
            part += 1.0;
        }
        self.part_to(until, before)
    }

    /// Goes on to `until` in one part; where that leaves the physics, back to where everything was `before`.
    fn part_to(&mut self, until: R, before: &Place<R>) -> Result<(), Error> {
        let went = self.walk.advance_to(&self.rig, &self.rig.seats(), Method::Stable, until, None);
        went.map_err(|error| {
            self.back_to(*before);
            of_modular(error)
        })
    }

    /// All that a step changes.
    fn going(&self) -> Place<R> {
        (self.walk, self.modulator)
    }

    /// Back to before a step that was only tried.
    fn back_to(&mut self, before: Place<R>) {
        (self.walk, self.modulator) = before;
    }

    fn chamber(&self, [length, velocity, pressure, air_mass]: [R; 4]) -> Chamber<R> {
        let actuator = self.rig.actuator();
        actuator.chamber(length, velocity, pressure, air_mass, actuator.limits().is_slack(length))
    }

    /// The tension, its derivatives and the rates of the state, while the ends move apart at `velocity` in m/s.
    pub fn respond(&self, velocity: R) -> Response<R> {
        let Course { state, held, .. } = &self.walk.course;
        let [length, _, pressure, air_mass] = of_rig(state);
        let actuator = self.rig.actuator();
        let of_air = ActuatorState { pressure: AbsolutePressure(pressure), air_mass, memory: held.memory };
        let alone = actuator.respond(&of_air, length, velocity, self.ports());
        // The flow may come through a hose, and a leak takes some.
        let flow = self.rig.observe(self.time(), state, held).flow;
        let chamber = self.chamber([length, velocity, pressure, air_mass]);
        Response { pressure_rate: actuator.pressure_rate(&chamber, &flow), mass_flow: flow.net(), ..alone }
    }

    fn ask(&mut self, time: R, request: Option<Request>) {
        if let (Some(request), Some(actuation)) = (request, self.rig.actuation()) {
            self.walk.progress.ask(time, &actuation.solenoid, request);
        }
    }
}

/// The error of a step in the words of a host, which knows neither the keys of a scenario's run nor its engines.
fn of_modular(error: Error) -> Error {
    match error {
        Error::Stopped { time, quantity, value, unit, .. } => Error::Stopped {
            time,
            reason: "a step of the modular actuator left the physics",
            quantity,
            value,
            unit,
            remedy: match quantity {
                "length" => "keep the ends closer together than a thread is long",
                _ => "take a shorter step, or divide it into shorter parts",
            },
        },
        other => other,
    }
}
