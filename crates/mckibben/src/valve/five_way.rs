//! A five-way valve: two outputs in opposition, from one command.
//!
//! ```text
//!                 output A                      output B
//! fill            supply                        exhaust
//! exhaust         exhaust                       supply
//! hold (5/3)      closed, exhaust or supply     the same
//! ```
//!
//! It drives the two actuators of a joint against each other. Each output, seen alone, is a valve of a simpler kind on the
//! same coils with the same delays, so the laws of [`Solenoid`] serve unchanged and the poppets of both outputs move at the
//! same instants:
//!
//! | valve | coils | output A | output B |
//! |---|---|---|---|
//! | 5/2, spring return | one | three-way | three-way, normally open |
//! | 5/3, closed centre | two | fill-hold-exhaust | fill-hold-exhaust, coils exchanged |
//! | 5/3, exhausted centre | two | three-way on the first | three-way on the second |
//! | 5/3, pressurised centre | two | normally open on the second | normally open on the first |
//!
//! An exchanged coil is the mirrored command: fill for exhaust and exhaust for fill. The two outputs share no flow: a supply
//! that sags under both is outside this law.
//!
//! Source: the port functions of 5/2 and 5/3 valves, ISO 1219-1. Checked by `tests/five_way.rs`.

use super::command::{Command, Request};
use super::solenoid::{Solenoid, ValveKind};
use crate::error::Error;
use crate::parameter;

/// Where a five-way valve stands while no coil is energised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FiveWayRest {
    /// 5/2: a spring returns it, output A is exhausted and output B supplied.
    Returned,
    /// 5/3: all ports are shut.
    Closed,
    /// 5/3: both outputs are exhausted.
    Exhausted,
    /// 5/3: both outputs are supplied.
    Pressurised,
}

/// A five-way valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiveWay {
    rest: FiveWayRest,
    opening_delay: f64,
    closing_delay: f64,
    dead_time: f64,
}

/// One output of a five-way valve: a valve of a simpler kind, and its command.
#[derive(Clone, Debug, PartialEq)]
pub struct FiveWayOutput {
    /// The kind and delays of the output.
    pub solenoid: Solenoid,
    /// The command as the output sees it.
    pub command: Command,
}

impl FiveWay {
    /// A valve that moves `opening_delay` s after a coil is energised and back `closing_delay` s after it is released; both
    /// zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a delay that is negative or not finite.
    pub fn new(rest: FiveWayRest, opening_delay: f64, closing_delay: f64) -> Result<Self, Error> {
        Solenoid::new(ValveKind::ThreeWay, opening_delay, closing_delay)?;
        Ok(Self { rest, opening_delay, closing_delay, dead_time: 0.0 })
    }

    /// Delays the effect of the command by `dead_time` s, zero or more, at both outputs.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is negative or not finite.
    pub fn with_dead_time(self, dead_time: f64) -> Result<Self, Error> {
        Ok(Self { dead_time: parameter::VALVE_DEAD_TIME.check(dead_time)?, ..self })
    }

    /// What the outputs A and B do under a command, in which `fill` and `exhaust` are those of output A.
    ///
    /// # Errors
    /// [`Error::Misuse`] for `hold` on a 5/2 valve, which has no third position.
    pub fn outputs(&self, command: &Command) -> Result<[FiveWayOutput; 2], Error> {
        use ValveKind::{FillHoldExhaust, ThreeWay, ThreeWayNormallyOpen};
        let (kinds, hold) = match self.rest {
            FiveWayRest::Returned => ([ThreeWay, ThreeWayNormallyOpen], Request::Hold),
            FiveWayRest::Closed => ([FillHoldExhaust; 2], Request::Hold),
            FiveWayRest::Exhausted => ([ThreeWay; 2], Request::Exhaust),
            FiveWayRest::Pressurised => ([ThreeWayNormallyOpen; 2], Request::Fill),
        };
        if self.rest == FiveWayRest::Returned && command.has_request(Request::Hold) {
            return Err(Error::Misuse {
                what: "a 5/2 valve cannot hold: it has two positions",
                remedy: "take a 5/3 valve, or ask for fill and exhaust only",
            });
        }
        let output = |kind, command| -> Result<FiveWayOutput, Error> {
            let solenoid = Solenoid::new(kind, self.opening_delay, self.closing_delay)?;
            Ok(FiveWayOutput { solenoid: solenoid.holding_by(hold).with_dead_time(self.dead_time)?, command })
        };
        Ok([output(kinds[0], command.clone())?, output(kinds[1], command.map_requests(mirrored))?])
    }
}

/// The request at the opposite output.
fn mirrored(request: Request) -> Request {
    match request {
        Request::Fill => Request::Exhaust,
        Request::Hold => Request::Hold,
        Request::Exhaust => Request::Fill,
    }
}
