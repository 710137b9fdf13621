//! Actions: commands of valves as numbers in an array.

use crate::pulses::Pulses;
use mckibben::valve::{Request, RuntimeCommand, Solenoid};
use mckibben::{Error, GaugePressure, parameter};
use mckibben_run::failure::Failure;

/// What a number in the array stands for.
#[derive(Clone, Copy, Debug)]
pub(super) enum ActionMode {
    /// A duty cycle, 0 to 1.
    Duty(Pulses),
    /// 1 for fill, 0 for hold, -1 for exhaust.
    Request,
    /// A position of a proportional spool, -1 to 1.
    Position,
    /// A set point of a pressure regulator in Pa, gauge.
    SetPoint,
}

/// Names of the kinds.
const NAMES: [&str; 4] = ["duty", "request", "position", "set-point"];

impl ActionMode {
    /// By its name; `pulses` says how a duty cycle is pulsed, if actions are duty cycles.
    pub(super) fn named(name: &str, pulses: impl FnOnce() -> Result<Pulses, Failure>) -> Result<Self, Failure> {
        match name {
            "duty" => pulses().map(Self::Duty),
            "request" => Ok(Self::Request),
            "position" => Ok(Self::Position),
            "set-point" => Ok(Self::SetPoint),
            other => Err(Failure::input(
                format!("action_mode = \"{other}\" is no action_mode"),
                "say \"duty\", \"request\", \"position\" or \"set-point\"",
            )),
        }
    }

    /// Refuses a kind of action, by its name, that a valve does not take, whatever the number.
    pub(super) fn check(name: &str, valve: &Solenoid) -> Result<(), Failure> {
        let (valve, takes): (_, &[&str]) = match (valve.spool(), valve.regulator()) {
            (Some(_), _) => ("proportional spool", &["position"]),
            (None, Some(_)) => ("pressure regulator", &["set-point"]),
            (None, None) => ("valve with seats", &["duty", "request"]),
        };
        if takes.contains(&name) || !NAMES.contains(&name) {
            return Ok(());
        }
        let takes = takes.iter().map(|name| format!("action_mode=\"{name}\"")).collect::<Vec<_>>().join(" or ");
        Err(Failure::input(
            format!("action_mode=\"{name}\" is nothing that the scenario's valve takes, which is a {valve}"),
            format!("give {takes}, or a scenario with another valve.kind"),
        ))
    }

    /// A number that a valve which takes this kind of action can be commanded; `requests` are the requests that it can do.
    pub(super) fn least(&self, requests: &[f64]) -> f64 {
        match self {
            Self::Request => requests.first().copied().unwrap_or_default(),
            Self::Duty(_) | Self::Position | Self::SetPoint => 0.0,
        }
    }

    /// The numbers of the requests that every one of these valves can do.
    pub(super) fn requests_of<'v>(valves: impl Iterator<Item = &'v Solenoid> + Clone) -> Vec<f64> {
        let can =
            |number: f64, valve: &Solenoid| request(number).and_then(|request| valve.check_request(request)).is_ok();
        [-1.0, 0.0, 1.0].into_iter().filter(|number| valves.clone().all(|valve| can(*number, valve))).collect()
    }

    /// How often pulses come, in Hz, where there are any.
    pub(super) fn pulse_frequency(&self) -> Option<f64> {
        match self {
            Self::Duty(pulses) => Some(pulses.frequency),
            Self::Request | Self::Position | Self::SetPoint => None,
        }
    }

    /// The command of a number.
    pub(super) fn demand(&self, number: f64) -> Result<RuntimeCommand, Error> {
        match self {
            Self::Duty(Pulses { frequency, pulse, rest }) => {
                let duty = parameter::DUTY.check(number)?;
                Ok(RuntimeCommand::Pulses { frequency: *frequency, duty, pulse: *pulse, rest: *rest })
            }
            Self::Request => request(number).map(RuntimeCommand::Request),
            Self::Position => parameter::COMMAND_POSITION.check(number).map(RuntimeCommand::Position),
            Self::SetPoint => {
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
