//! How a valve is pulsed by a duty cycle.

use crate::arguments;
use mckibben::valve::{Command, Request, RuntimeCommand};
use mckibben_run::failure::Failure;

/// Frequency of pulses, and the requests during and between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pulses {
    /// Frequency in Hz.
    pub(crate) frequency: f64,
    pub(crate) pulse: Request,
    pub(crate) rest: Request,
}

impl Pulses {
    /// At a frequency in Hz, or that of a scenario's PWM; `command` is the scenario's, if there is a valve.
    pub(crate) fn of(command: Option<&Command>, frequency: Option<f64>) -> Result<Self, Failure> {
        let (own, pulse, rest) = match command {
            Some(Command::Pwm { frequency, pulse, rest, .. }) => (Some(*frequency), *pulse, *rest),
            _ => (None, Request::Fill, Request::Exhaust),
        };
        if let Some(given) = frequency {
            arguments::number(
                "pulse_frequency",
                given,
                "Hz",
                "a frequency in Hz above zero, such as 25.0",
                given > 0.0,
            )?;
        }
        // Without a valve there are no pulses, and any frequency will do.
        let frequency = frequency.or(own).or(command.is_none().then_some(1.0)).ok_or_else(|| {
            Failure::input(
                "the scenario has no PWM that says how often the valve is pulsed",
                "give pulse_frequency in Hz, or command.kind = \"pwm\" with its frequency",
            )
        })?;
        Ok(Self { frequency, pulse, rest })
    }

    /// Pulses of a duty cycle.
    pub(crate) fn of_duty(&self, duty: f64) -> RuntimeCommand {
        RuntimeCommand::Pulses { frequency: self.frequency, duty, pulse: self.pulse, rest: self.rest }
    }
}
