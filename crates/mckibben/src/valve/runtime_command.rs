//! Commands to a valve at run time, by a caller that does not know them beforehand.
//!
//! It says of one instant what a [`Command`](super::Command) says of all: a request of poppets for the present, pulses that
//! follow a duty cycle, a set point of a pressure regulator, a position of a proportional spool.
//!
//! Checked by `crates/mckibben-batch/tests/plant_set.rs`.

use super::Request;
use super::solenoid::{NO_REGULATOR, NO_SPOOL, Solenoid};
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::Real;

/// A command to a valve from now on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RuntimeCommand<S = f64> {
    /// A constant request.
    Request(Request),
    /// Pulse-width modulation; period p begins at p/f. A duty cycle takes effect when the next period begins; the
    /// previous command goes on until then.
    Pulses {
        /// Frequency f in Hz, above zero.
        frequency: S,
        /// Share of each period in which `pulse` is requested, 0 to 1.
        duty: S,
        /// The request during the pulse.
        pulse: Request,
        /// The request during the rest of the period.
        rest: Request,
    },
    /// A set point of a pressure regulator, zero or more.
    SetPoint(GaugePressure<S>),
    /// A position of a proportional spool, from −1 (exhaust open) to 1 (supply open).
    Position(S),
}

impl<S> From<Request> for RuntimeCommand<S> {
    fn from(request: Request) -> Self {
        Self::Request(request)
    }
}

impl<S: Real> Solenoid<S> {
    /// Checks that the valve can do what is demanded.
    ///
    /// # Errors
    /// As [`Solenoid::check_request`]; [`Error::Misuse`] for a set point of a valve that is no pressure regulator and a
    /// position of one that is no proportional spool; [`Error::OutOfRange`] for a number outside its range.
    pub fn check_command(&self, command: &RuntimeCommand<S>) -> Result<(), Error> {
        let within = |parameter: &'static parameter::Parameter, value: S| parameter.check(value.value()).map(drop);
        match command {
            RuntimeCommand::Request(request) => self.check_request(*request),
            RuntimeCommand::Pulses { frequency, duty, pulse, rest } => {
                within(&parameter::PWM_FREQUENCY, *frequency)?;
                within(&parameter::DUTY, *duty)?;
                self.check_request(*pulse)?;
                self.check_request(*rest)
            }
            RuntimeCommand::SetPoint(_) if self.regulator().is_none() => Err(NO_REGULATOR),
            RuntimeCommand::SetPoint(gauge) => within(&parameter::COMMAND_GAUGE_PRESSURE, gauge.0),
            RuntimeCommand::Position(_) if self.spool().is_none() => Err(NO_SPOOL),
            RuntimeCommand::Position(position) => within(&parameter::COMMAND_POSITION, *position),
        }
    }
}
