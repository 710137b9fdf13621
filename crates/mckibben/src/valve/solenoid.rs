//! The solenoid: when the poppet moves after the coil is driven.
//!
//! ```text
//! coil energised at t  →  poppet moves at t + t_open,  unless the coil is released before
//! coil released  at t  →  poppet returns at t + t_close, unless the coil is energised before
//! ```
//!
//! A pulse shorter than `t_open` never opens the valve, a gap shorter than `t_close` never shuts it. Under PWM the
//! actual duty cycle is `d − (t_open − t_close) f`: 42.5 % at 25 Hz and 35 % at 50 Hz for a commanded 50 %, where the
//! paper measured 43 and 35. Every motion is an exact instant. Of two motions in one instant, the poppet's comes before
//! the coil's: a pulse as long as `t_open` does open.
//!
//! | kind | coils | energised | released |
//! |---|---|---|---|
//! | two-way | one | supply | shut |
//! | three-way | one | supply | exhaust |
//! | three-way-normally-open | one | exhaust | supply |
//! | fill-hold-exhaust | two two-way valves | its flow path open | its flow path shut |
//!
//! A dead time t_dead comes before both delays: the command acts t_dead later, whatever its length, so that it shifts a pulse
//! and never shortens it. It is that of the driver's electronics and of pilot stages.
//!
//! A poppet may take its time once it moves ([`Ramp`]); the coil acts on it then as before, and it turns where it is.
//!
//! A request drives the coil that brings it about: `fill` releases the coil of a normally open valve, so that its flow
//! path to the supply opens after `t_close`. A five-way valve is two of these kinds on the same coils
//! ([`FiveWay`](super::FiveWay)). A [`Regulator`] takes the place of the coil: its flow path is open all the time, to a
//! pressure that follows set points ([`Solenoid::regulating`]). A proportional [`Spool`] takes the place of the poppets
//! ([`Solenoid::proportional`]).
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.3 and Fig. 10. Checked by `tests/solenoid.rs`.

use super::command::{Command, Request};
use super::opening::Openings;
use super::ramp::{Ramp, Stroke};
use super::regulator::Regulator;
use super::spool::Spool;
use crate::convert::Convert;
use crate::error::Error;
#[cfg(feature = "alloc")]
use crate::numbered::Row;
use crate::parameter;
use crate::scalar::{Real, Scalar};

/// How the flow paths are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValveKind {
    /// The actuator is joined to the supply when energised and sealed when not.
    TwoWay,
    /// The actuator is joined to the supply when energised and to the exhaust when not.
    ThreeWay,
    /// The actuator is joined to the exhaust when energised and to the supply when not.
    ThreeWayNormallyOpen,
    /// A two-way valve to the supply and another to the exhaust.
    FillHoldExhaust,
}

impl ValveKind {
    /// Openings of the flow paths to the supply and to the atmosphere, by those of the poppets.
    #[inline(always)]
    pub fn shares<T: Scalar>(self, [first, second]: [T; 2]) -> [T; 2] {
        match self {
            Self::TwoWay => [first, T::zero()],
            Self::ThreeWay => [first, T::one() - first],
            Self::ThreeWayNormallyOpen => [T::one() - first, first],
            Self::FillHoldExhaust => [first, second],
        }
    }
}

/// A pressure regulator has a command that only a poppet can carry out.
const NO_POPPET: Error = Error::Misuse {
    what: "a pressure regulator neither fills, holds nor exhausts on request: it takes set points of pressure",
    remedy: "set command.kind = \"set-points\", or choose a valve with seats such as valve.kind = \"three-way\"",
};

/// A proportional spool has a command that only a poppet can carry out.
const NO_REQUEST: Error = Error::Misuse {
    what: "a proportional spool neither fills, holds nor exhausts on request: it takes positions",
    remedy: "set command.kind = \"positions\", or choose a valve with seats such as valve.kind = \"three-way\"",
};

/// A valve without a spool has a command for a position.
pub(super) const NO_SPOOL: Error = Error::Misuse {
    what: "positions are given, but the valve is no proportional spool",
    remedy: "set valve.kind = \"proportional-spool\", or ask for fill, hold or exhaust",
};

/// A valve without a regulator has a command for a pressure.
pub(super) const NO_REGULATOR: Error = Error::Misuse {
    what: "set points of pressure are given, but the valve is no pressure regulator",
    remedy: "set valve.kind = \"pressure-regulator\", or ask for fill, hold or exhaust",
};

/// Which flow paths are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ports {
    /// The flow path to the supply.
    pub supply: bool,
    /// The flow path to the atmosphere.
    pub exhaust: bool,
}

impl Ports {
    /// Both flow paths shut.
    pub const CLOSED: Self = Self { supply: false, exhaust: false };

    /// The name in the `valve` column: `supply`, `exhaust`, `closed`, or `supply+exhaust` while two poppets overlap.
    pub fn name(self) -> &'static str {
        match (self.supply, self.exhaust) {
            (true, false) => "supply",
            (false, true) => "exhaust",
            (false, false) => "closed",
            (true, true) => "supply+exhaust",
        }
    }
}

/// A solenoid valve's kind and delays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solenoid<S = f64> {
    kind: ValveKind,
    opening_delay: S,
    closing_delay: S,
    /// What it does on a request to hold.
    hold: Request,
    ramp: Ramp<S>,
    /// By how much the command acts late, in s; that of a pressure regulator is its own.
    dead_time: S,
    /// By how much the poppets take effect late where it counts, in s.
    transport: S,
    /// What makes the pressure beyond the flow path, which then has no poppet.
    regulator: Option<Regulator<S>>,
    /// What moves instead of poppets.
    spool: Option<Spool<S>>,
}

impl Solenoid {
    /// A valve whose poppet moves `opening_delay` s after its coil is energised, and back `closing_delay` s after it is
    /// released; both zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a delay that is negative or not finite.
    pub fn new(kind: ValveKind, opening_delay: f64, closing_delay: f64) -> Result<Self, Error> {
        Ok(Self {
            kind,
            opening_delay: parameter::OPENING_DELAY.check(opening_delay)?,
            closing_delay: parameter::CLOSING_DELAY.check(closing_delay)?,
            hold: Request::Hold,
            ramp: Ramp::none(),
            dead_time: 0.0,
            transport: 0.0,
            regulator: None,
            spool: None,
        })
    }

    /// An output of a valve that does `hold` on a request to hold.
    pub(super) fn holding_by(self, hold: Request) -> Self {
        Self { hold, ..self }
    }

    /// Gives the valve's poppets a travel time.
    pub fn with_ramp(self, ramp: Ramp) -> Self {
        Self { ramp, ..self }
    }

    /// Delays the effect of the command by `dead_time` s, zero or more, whatever the kind of valve; for a pressure
    /// regulator this replaces its own dead time.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is negative or not finite.
    pub fn with_dead_time(self, dead_time: f64) -> Result<Self, Error> {
        let dead_time = parameter::VALVE_DEAD_TIME.check(dead_time)?;
        Ok(match self.regulator {
            Some(regulator) => Self { regulator: Some(regulator.with_dead_time(dead_time)), ..self },
            None => Self { dead_time, ..self },
        })
    }

    /// No solenoid, but a pressure regulator: the flow path is open all the time, and air comes from and goes to the
    /// pressure that follows the set points of a [`Command::SetPoints`].
    pub fn regulating(regulator: Regulator) -> Self {
        let regulator = Some(regulator);
        // Released, its one flow path is open.
        let kind = ValveKind::ThreeWayNormallyOpen;
        let (ramp, spool) = (Ramp::none(), None);
        let ([opening_delay, closing_delay, dead_time, transport], hold) = ([0.0; 4], Request::Hold);
        Self { kind, opening_delay, closing_delay, hold, ramp, dead_time, transport, regulator, spool }
    }

    /// No solenoid, but a proportional spool that follows the positions of a [`Command::Positions`].
    pub fn proportional(spool: Spool) -> Self {
        let (ramp, spool) = (Ramp::none(), Some(spool));
        let kind = ValveKind::FillHoldExhaust;
        let ([opening_delay, closing_delay, dead_time, transport], hold) = ([0.0; 4], Request::Hold);
        Self { kind, opening_delay, closing_delay, hold, ramp, dead_time, transport, regulator: None, spool }
    }

    /// Checks that the valve can carry out the command.
    ///
    /// # Errors
    /// As [`Solenoid::check_request`]; [`Error::Misuse`] for set points of a valve that is no pressure regulator, for
    /// positions of one that is no proportional spool, and for requests of one that is either.
    pub fn check(&self, command: &Command) -> Result<(), Error> {
        match (self.spool, command.has_positions()) {
            (None, true) => return Err(NO_SPOOL),
            (Some(_), false) => return Err(NO_REQUEST),
            (Some(_), true) => return Ok(()),
            (None, false) => {}
        }
        match (self.regulator, command.has_set_points()) {
            (None, true) => return Err(NO_REGULATOR),
            (Some(_), false) => return Err(NO_POPPET),
            (Some(_), true) => return Ok(()),
            (None, false) => {}
        }
        let requests = [Request::Fill, Request::Hold, Request::Exhaust];
        requests.into_iter().filter(|request| command.has_request(*request)).try_for_each(|one| self.check_request(one))
    }
}

impl<S: Scalar> Solenoid<S> {
    /// Checks that the valve can carry out the request.
    ///
    /// # Errors
    /// [`Error::Misuse`] for `hold` on a three-way valve of two positions, for `exhaust` on a two-way valve, and for any request of a
    /// pressure regulator or a proportional spool.
    pub fn check_request(&self, request: Request) -> Result<(), Error> {
        if self.regulator.is_some() {
            return Err(NO_POPPET);
        }
        if self.spool.is_some() {
            return Err(NO_REQUEST);
        }
        let (impossible, what, remedy) = match self.kind {
            ValveKind::ThreeWay | ValveKind::ThreeWayNormallyOpen => (
                Request::Hold,
                "a three-way valve cannot hold: it is joined to the supply or to the exhaust at all times",
                "set valve.kind = \"fill-hold-exhaust\", or ask for fill and exhaust only",
            ),
            ValveKind::TwoWay => (
                Request::Exhaust,
                "a two-way valve cannot exhaust: it joins the actuator to the supply or seals it",
                "set valve.kind = \"three-way\" or \"fill-hold-exhaust\", or ask for fill and hold only",
            ),
            ValveKind::FillHoldExhaust => return Ok(()),
        };
        if self.answer(request) == impossible { Err(Error::Misuse { what, remedy }) } else { Ok(()) }
    }

    /// Converts the solenoid to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Solenoid<T> {
        Solenoid {
            kind: self.kind,
            opening_delay: convert.parameter(&parameter::OPENING_DELAY, self.opening_delay),
            closing_delay: convert.parameter(&parameter::CLOSING_DELAY, self.closing_delay),
            hold: self.hold,
            ramp: self.ramp.convert(convert),
            dead_time: match self.regulator {
                Some(_) => T::zero(),
                None => convert.parameter(&parameter::VALVE_DEAD_TIME, self.dead_time),
            },
            transport: T::zero(),
            regulator: self.regulator.as_ref().map(|regulator| regulator.convert(convert)),
            spool: self.spool.as_ref().map(|spool| spool.convert(convert)),
        }
    }

    /// The pressure regulator in place of a solenoid, if that is what the valve is.
    pub fn regulator(&self) -> Option<&Regulator<S>> {
        self.regulator.as_ref()
    }

    /// How long the poppets are under way.
    pub fn ramp(&self) -> &Ramp<S> {
        &self.ramp
    }

    /// The proportional spool in place of poppets, if that is what the valve is.
    pub fn spool(&self) -> Option<&Spool<S>> {
        self.spool.as_ref()
    }

    /// Whether it has seats, which coils move on request.
    pub fn has_poppets(&self) -> bool {
        self.regulator.is_none() && self.spool.is_none()
    }

    /// By how much the command acts late, in s.
    pub fn dead_time(&self) -> S {
        self.regulator.as_ref().map_or(self.dead_time, Regulator::dead_time)
    }

    /// By how much it is seen late, in s.
    #[cfg(feature = "alloc")]
    pub(crate) fn transport(&self) -> S {
        self.transport
    }

    /// Delay in s from a command until anything of the valve moves: the dead time, and by how much
    /// it is seen late.
    pub(crate) fn latency(&self) -> S {
        self.dead_time() + self.transport
    }

    /// How the flow paths are arranged.
    pub fn kind(&self) -> ValveKind {
        self.kind
    }

    /// Opening and closing delay in s.
    pub fn delays(&self) -> [S; 2] {
        [self.opening_delay, self.closing_delay]
    }

    /// The valve as the end of a line opposite to it sees it: coil and poppets act `transport` s late.
    pub(crate) fn seen_late(self, transport: S) -> Self {
        Self { transport, ..self }
    }

    /// What the valve does on a request: where a five-way valve fills or exhausts its outputs at rest, that is what each of them
    /// does on a request to hold.
    pub fn answer(&self, request: Request) -> Request {
        if request == Request::Hold { self.hold } else { request }
    }

    /// Which coils a request energises; every kind but fill-hold-exhaust has the first only.
    pub(crate) fn coils(&self, request: Request) -> [bool; 2] {
        let request = self.answer(request);
        match self.kind {
            ValveKind::TwoWay | ValveKind::ThreeWay => [request == Request::Fill, false],
            ValveKind::ThreeWayNormallyOpen => [request == Request::Exhaust, false],
            ValveKind::FillHoldExhaust => [request == Request::Fill, request == Request::Exhaust],
        }
    }
}

/// Positions of coils and poppets and what moves next: the valve's discrete state, owned by the time stepper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoppetClock<S = f64> {
    next_change: u64,
    coil: [bool; 2],
    poppet: [bool; 2],
    due: [Option<S>; 2],
    strokes: [Stroke<S>; 2],
    /// How many strokes that take time have begun or ended.
    strokes_counted: u64,
}

impl<S: Real> PoppetClock<S> {
    /// The state before t = 0: coils released for long.
    pub fn released() -> Self {
        let strokes = [Stroke::resting(false); 2];
        Self { next_change: 0, coil: [false; 2], poppet: [false; 2], due: [None; 2], strokes, strokes_counted: 0 }
    }

    /// Which flow paths are open, those of a moving poppet included.
    pub fn ports(&self, solenoid: &Solenoid<S>) -> Ports {
        let [first, second] = [0, 1].map(|side| self.poppet[side] || self.strokes[side].end().is_some());
        let back = !self.poppet[0] || self.strokes[0].end().is_some();
        match solenoid.kind {
            ValveKind::TwoWay => Ports { supply: first, exhaust: false },
            ValveKind::ThreeWay => Ports { supply: first, exhaust: back },
            ValveKind::ThreeWayNormallyOpen => Ports { supply: back, exhaust: first },
            ValveKind::FillHoldExhaust => Ports { supply: first, exhaust: second },
        }
    }

    /// A number that differs once the openings are another function of time.
    #[cfg(feature = "alloc")]
    pub(crate) fn strokes_counted(&self) -> u64 {
        self.strokes_counted
    }

    /// How far the flow paths are open, until the next motion.
    pub fn openings(&self, solenoid: &Solenoid<S>) -> Openings<S> {
        if self.strokes.iter().all(|stroke| stroke.end().is_none()) {
            return Openings::Whole;
        }
        Openings::Poppets { kind: solenoid.kind, strokes: self.strokes }
    }

    /// The next instant in s at which a coil or a poppet moves, or a poppet arrives.
    pub fn next(&self, solenoid: &Solenoid<S>, command: &Command<S>) -> Option<S> {
        let change = command.change(self.next_change).map(|(time, _)| time + solenoid.latency());
        let others = [0, 1].into_iter().filter_map(|side| self.moves(side));
        others.fold(change, |soonest, time| soonest.filter(|soonest| soonest.value() <= time.value()).or(Some(time)))
    }

    /// Moves everything that is due up to and with `time`, in order; at one instant, poppets before coils.
    pub fn advance(&mut self, time: S, solenoid: &Solenoid<S>, command: &Command<S>) {
        self.pass(self.next(solenoid, command), time, solenoid, command);
    }

    /// When in s the poppet of a side moves next or arrives, if it does.
    fn moves(&self, side: usize) -> Option<S> {
        let instants = [self.due[side], self.strokes[side].end()].into_iter().flatten();
        instants.min_by(|a, b| a.value().total_cmp(&b.value()))
    }

    /// Moves what is due up to and with `time`, given what comes next; what comes next then.
    ///
    /// With derivatives two poppets that move at `time` are two instants, one behind the other, since each may move with a
    /// number in its own way: the second is left.
    fn pass(&mut self, mut upcoming: Option<S>, time: S, solenoid: &Solenoid<S>, command: &Command<S>) -> Option<S> {
        while let Some(next) = upcoming
            && is_due(next, time)
        {
            let (mut poppet_moved, mut is_left) = (false, false);
            let when = |side| self.moves(side).map_or(f64::INFINITY, S::value);
            let order = if when(1) < when(0) { [1, 0] } else { [0, 1] };
            for side in order {
                if S::HAS_DERIVATIVES && poppet_moved && self.moves(side).is_some_and(|time| is_due(time, next)) {
                    is_left = true;
                    continue;
                }
                if self.strokes[side].end().is_some_and(|end| is_due(end, next)) {
                    self.strokes[side] = Stroke::resting(self.poppet[side]);
                    self.strokes_counted += 1;
                    poppet_moved = true;
                }
                if self.due[side].is_some_and(|due| is_due(due, next)) {
                    self.due[side] = None;
                    self.poppet[side] = self.coil[side];
                    let was_moving = self.strokes[side].end().is_some();
                    let stroke = solenoid.ramp.send(&self.strokes[side], next, self.poppet[side]);
                    let takes_time = stroke.end().is_some();
                    self.strokes[side] = if takes_time { stroke } else { Stroke::resting(self.poppet[side]) };
                    // One that jumps back ends the stroke that it was on.
                    self.strokes_counted += u64::from(takes_time || was_moving);
                    poppet_moved = true;
                }
            }
            if !poppet_moved && let Some((when, request)) = command.change(self.next_change) {
                self.next_change += 1;
                self.drive(when + solenoid.latency(), solenoid, solenoid.coils(request));
            }
            upcoming = self.next(solenoid, command);
            if is_left && is_due(time, next) {
                break;
            }
        }
        upcoming
    }

    /// The next instant in s, up to and with `until`, at which a poppet moves or arrives and so the openings change.
    pub fn next_motion(&self, solenoid: &Solenoid<S>, command: &Command<S>, until: S) -> Option<S> {
        let (mut probe, mut upcoming) = (*self, self.next(solenoid, command));
        let last_change = self.next_change.saturating_add(Self::changes_that_count(solenoid, command));
        while probe.next_change <= last_change {
            let instant = upcoming.filter(|next| is_due(*next, until))?;
            upcoming = probe.pass(upcoming, instant, solenoid, command);
            if probe.ports(solenoid) != self.ports(solenoid) || probe.strokes_counted != self.strokes_counted {
                return Some(instant);
            }
        }
        None
    }

    /// After how many changes of a command without a motion of a poppet none is to come. Pulses of a PWM that are too short
    /// for the valve stay so: what is due is taken back within a period, or moves a poppet when its delay has passed.
    fn changes_that_count(solenoid: &Solenoid<S>, command: &Command<S>) -> u64 {
        let Command::Pwm { frequency, .. } = command else { return u64::MAX };
        let delay = solenoid.opening_delay.value().max(solenoid.closing_delay.value());
        2 * (delay * frequency.value()) as u64 + 6
    }

    /// How many changes of the command have been passed.
    #[cfg(feature = "alloc")]
    pub(crate) fn passed(&mut self) -> &mut u64 {
        &mut self.next_change
    }

    fn drive(&mut self, time: S, solenoid: &Solenoid<S>, coil: [bool; 2]) {
        for (side, &energised) in coil.iter().enumerate() {
            self.coil[side] = energised;
            if energised == self.poppet[side] {
                // Already there, or on the way out of it: the pulse or gap was too short to be followed.
                self.due[side] = None;
            } else if self.due[side].is_none() {
                self.due[side] = Some(time + if energised { solenoid.opening_delay } else { solenoid.closing_delay });
            }
        }
    }
}

#[cfg(feature = "alloc")]
impl<S: Real> PoppetClock<S> {
    /// As numbers in a row.
    pub(crate) fn each_number(&mut self, row: &mut impl Row<S>) {
        let Self { next_change, coil, poppet, due, strokes, strokes_counted } = self;
        row.count(next_change);
        coil.iter_mut().chain(poppet).for_each(|at| row.truth(at));
        due.iter_mut().for_each(|due| row.instant(due));
        strokes.iter_mut().for_each(|stroke| stroke.each_number(row));
        row.count(strokes_counted);
    }
}

/// Whether an instant has come. Two instants that differ by the rounding of their own computation are one.
pub fn is_due<S: Real>(instant: S, time: S) -> bool {
    let (instant, time) = (instant.value(), time.value());
    instant <= time + SIMULTANEOUS * time.abs()
}

/// Relative difference below which two instants are one: a few roundings of a sum and a quotient.
pub const SIMULTANEOUS: f64 = 8.0 * f64::EPSILON;
