//! What a host commands a valve by one number.
//!
//! | mode | the number | of a valve with |
//! |---|---|---|
//! | duty | duty cycle, 0 to 1, of pulses that the valve makes itself, with its delays | poppets |
//! | request | 1 to fill, 0 to hold, −1 to exhaust; what `hold` is in a scenario, it is here | poppets |
//! | position | position of the spool, −1 (exhaust open) to 1 (supply open) | a proportional spool |
//! | set-point | gauge pressure in Pa, from zero to that of what feeds the valve | a pressure regulator |
//!
//! Checked by `tests/host/`.

use crate::failure::Failure;
use mckibben::valve::{Command, Request, RuntimeCommand, Solenoid};
use mckibben::{Error, GaugePressure, parameter};

/// How often pulses come, and what is requested in them and between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulses {
    /// Frequency in Hz.
    pub frequency: f64,
    /// The request during the pulse.
    pub pulse: Request,
    /// The request during the rest of the period.
    pub rest: Request,
}

impl Pulses {
    /// Pulses at a frequency in Hz, or at that of a scenario's PWM; `command` is the scenario's, if there is a valve.
    ///
    /// # Errors
    /// When the frequency is not above zero, and when neither says one.
    pub fn of(command: Option<&Command>, frequency: Option<f64>) -> Result<Self, Failure> {
        let (own, pulse, rest) = match command {
            Some(Command::Pwm { frequency, pulse, rest, .. }) => (Some(*frequency), *pulse, *rest),
            _ => (None, Request::Fill, Request::Exhaust),
        };
        if let Some(given) = frequency.filter(|given| !(given.is_finite() && *given > 0.0)) {
            return Err(Failure::input(
                format!("pulse_frequency = {given:?} Hz is out of range"),
                "give a frequency in Hz above zero, such as 25.0",
            ));
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
    pub fn of_duty(&self, duty: f64) -> RuntimeCommand {
        RuntimeCommand::Pulses { frequency: self.frequency, duty, pulse: self.pulse, rest: self.rest }
    }
}

/// What a number stands for that a valve is commanded by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CommandMode {
    /// A duty cycle, 0 to 1.
    Duty(Pulses),
    /// 1 for fill, 0 for hold, −1 for exhaust.
    Request,
    /// A position of a proportional spool, −1 to 1.
    Position,
    /// A set point of a pressure regulator in Pa, gauge: from zero to that of what feeds it.
    SetPoint {
        /// Gauge pressure in Pa of what feeds the regulator, which cannot give more; infinite where it is not known.
        feed: f64,
    },
}

/// Names of the modes.
pub const COMMAND_MODES: [&str; 4] = ["duty", "request", "position", "set-point"];

impl CommandMode {
    /// The mode of a name; `pulses` says how a duty cycle is pulsed, if numbers are duty cycles; `key` is how the host calls the
    /// choice, in messages.
    ///
    /// # Errors
    /// When there is no such mode, and those of `pulses`.
    pub fn named(key: &str, name: &str, pulses: impl FnOnce() -> Result<Pulses, Failure>) -> Result<Self, Failure> {
        match name {
            "duty" => pulses().map(Self::Duty),
            "request" => Ok(Self::Request),
            "position" => Ok(Self::Position),
            "set-point" => Ok(Self::SetPoint { feed: f64::INFINITY }),
            other => Err(Failure::input(
                format!("{key} = \"{other}\" is no {key}"),
                "say \"duty\", \"request\", \"position\" or \"set-point\"",
            )),
        }
    }

    /// The mode that a valve takes where none is chosen: duty cycles of a valve with poppets whose pulses have a frequency.
    pub fn of(valve: &Solenoid, pulses: impl FnOnce() -> Result<Pulses, Failure>) -> Self {
        match (valve.spool(), valve.regulator()) {
            (Some(_), _) => Self::Position,
            (None, Some(_)) => Self::SetPoint { feed: f64::INFINITY },
            (None, None) => pulses().map_or(Self::Request, Self::Duty),
        }
    }

    /// Refuses a mode, by its name, that a valve does not take, whatever the number; `key` is how the host calls the choice.
    ///
    /// # Errors
    /// With what the valve takes.
    pub fn check(key: &str, name: &str, valve: &Solenoid) -> Result<(), Failure> {
        let (valve, takes): (_, &[&str]) = match (valve.spool(), valve.regulator()) {
            (Some(_), _) => ("proportional spool", &["position"]),
            (None, Some(_)) => ("pressure regulator", &["set-point"]),
            (None, None) => ("valve with seats", &["duty", "request"]),
        };
        if takes.contains(&name) || !COMMAND_MODES.contains(&name) {
            return Ok(());
        }
        let takes = takes.iter().map(|name| format!("{key}=\"{name}\"")).collect::<Vec<_>>().join(" or ");
        Err(Failure::input(
            format!("{key}=\"{name}\" is nothing that the scenario's valve takes, which is a {valve}"),
            format!("give {takes}, or a scenario with another valve.kind"),
        ))
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Duty(_) => COMMAND_MODES[0],
            Self::Request => COMMAND_MODES[1],
            Self::Position => COMMAND_MODES[2],
            Self::SetPoint { .. } => COMMAND_MODES[3],
        }
    }

    /// The least and the greatest number, and their unit.
    pub fn range(&self) -> (f64, f64, &'static str) {
        match self {
            Self::Duty(_) => (0.0, 1.0, ""),
            Self::Request | Self::Position => (-1.0, 1.0, ""),
            // Where a vacuum feeds it, the core takes no set point at all.
            Self::SetPoint { feed } => (0.0, feed.max(0.0), "Pa"),
        }
    }

    /// The mode of a valve that is fed at a gauge pressure in Pa: set points end there.
    #[must_use]
    pub fn fed_at(self, gauge: f64) -> Self {
        match self {
            Self::SetPoint { .. } => Self::SetPoint { feed: gauge },
            Self::Duty(_) | Self::Request | Self::Position => self,
        }
    }

    /// Whether numbers of both modes mean the same, in ranges that may differ.
    pub(super) fn is_alike(&self, other: &Self) -> bool {
        matches!((self, other), (Self::SetPoint { .. }, Self::SetPoint { .. })) || self == other
    }

    /// The numbers that a valve takes, in words: `0 to 1`, `1 (fill) or -1 (exhaust)`; `requests` are those that it can
    /// do.
    pub(super) fn words(&self, requests: &[f64]) -> String {
        let (low, high, unit) = self.range();
        match self {
            Self::Request => {
                let word = |number: &f64| match *number {
                    1.0 => "1 (fill)",
                    0.0 => "0 (hold)",
                    _ => "-1 (exhaust)",
                };
                let words: Vec<&str> = requests.iter().rev().map(word).collect();
                words.join(" or ")
            }
            Self::SetPoint { .. } if high.is_infinite() => format!("{low:?} {unit} or more"),
            Self::SetPoint { .. } => {
                format!("{low:?} to {high:?} {unit}: a regulator cannot give more than feeds it")
            }
            Self::Duty(_) | Self::Position => format!("{low} to {high}"),
        }
    }

    /// The name of the command of an actuator: `biceps.set_point`.
    pub fn title(&self, actuator: &str) -> String {
        format!("{actuator}.{}", self.name().replace('-', "_"))
    }

    /// A number that a valve which takes this mode can be commanded; `requests` are the requests that it can do.
    pub fn least(&self, requests: &[f64]) -> f64 {
        match self {
            Self::Request => requests.first().copied().unwrap_or_default(),
            Self::Duty(_) | Self::Position | Self::SetPoint { .. } => 0.0,
        }
    }

    /// The numbers of the requests that every one of these valves can do.
    pub fn requests_of<'v>(valves: impl Iterator<Item = &'v Solenoid> + Clone) -> Vec<f64> {
        let can =
            |number: f64, valve: &Solenoid| request(number).and_then(|request| valve.check_request(request)).is_ok();
        [-1.0, 0.0, 1.0].into_iter().filter(|number| valves.clone().all(|valve| can(*number, valve))).collect()
    }

    /// How often pulses come, in Hz, where there are any.
    pub fn pulse_frequency(&self) -> Option<f64> {
        match self {
            Self::Duty(pulses) => Some(pulses.frequency),
            Self::Request | Self::Position | Self::SetPoint { .. } => None,
        }
    }

    /// The command of a number.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] and [`Error::Misuse`] for a number that is none.
    pub fn command(&self, number: f64) -> Result<RuntimeCommand, Error> {
        match self {
            Self::Duty(pulses) => Ok(pulses.of_duty(parameter::DUTY.check(number)?)),
            Self::Request => request(number).map(RuntimeCommand::Request),
            Self::Position => parameter::COMMAND_POSITION.check(number).map(RuntimeCommand::Position),
            Self::SetPoint { .. } => {
                let gauge = parameter::COMMAND_GAUGE_PRESSURE.check(number)?;
                Ok(RuntimeCommand::SetPoint(GaugePressure(gauge)))
            }
        }
    }
}

fn request(number: f64) -> Result<Request, Error> {
    match number {
        1.0 => Ok(Request::Fill),
        0.0 => Ok(Request::Hold),
        -1.0 => Ok(Request::Exhaust),
        _ => Err(Error::Misuse {
            what: "a request is none of 1 (fill), 0 (hold) and -1 (exhaust)",
            remedy: "give one of these three numbers",
        }),
    }
}
