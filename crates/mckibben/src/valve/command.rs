//! The commands to a valve, as exact instants.
//!
//! A command is a sequence of changes `(time, request)`. Times are computed from the index of the change, never summed,
//! so the millionth pulse of a PWM starts exactly at its period.

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Mask, Real, Scalar};
#[cfg(feature = "alloc")]
use crate::valve::RuntimeCommand;
use crate::valve::is_due;

/// A request to the valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Join the actuator to the supply.
    Fill,
    /// Shut both flow paths; a two-way and a fill-hold-exhaust valve can.
    Hold,
    /// Join the actuator to the atmosphere.
    Exhaust,
}

impl Request {
    /// Exhaust for fill and fill for exhaust; hold stays.
    pub fn opposite(self) -> Self {
        match self {
            Self::Fill => Self::Exhaust,
            Self::Hold => Self::Hold,
            Self::Exhaust => Self::Fill,
        }
    }
}

/// The command to the valve over time, from t = 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Command<S = f64> {
    /// A constant request.
    Constant(Request),
    /// Pulse-width modulation: the pulse starts each period.
    Pwm {
        /// Frequency in Hz.
        frequency: S,
        /// Commanded share of each period in which `pulse` is requested.
        duty: S,
        /// The request during the pulse.
        pulse: Request,
        /// The request during the rest of the period.
        rest: Request,
    },
    /// Requests that start at given times; before the first, the coils are released.
    #[cfg(feature = "alloc")]
    Table {
        /// Times in s, strictly rising, zero or more.
        time: alloc::vec::Vec<S>,
        /// The request from each time on.
        request: alloc::vec::Vec<Request>,
    },
    /// Set points of a pressure regulator, whose flow path stays open; it keeps what it had until the first.
    #[cfg(feature = "alloc")]
    SetPoints {
        /// Times in s, strictly rising, zero or more.
        time: alloc::vec::Vec<S>,
        /// The gauge pressure in Pa from each time on, zero or more.
        gauge_pressure: alloc::vec::Vec<S>,
    },
    /// Positions of a proportional spool, which rests in the middle until the first.
    #[cfg(feature = "alloc")]
    Positions {
        /// Times in s, strictly rising, zero or more.
        time: alloc::vec::Vec<S>,
        /// The position from each time on, from −1 (exhaust open) to 1 (supply open).
        position: alloc::vec::Vec<S>,
    },
}

impl Command {
    /// Pulse-width modulation at `frequency` (Hz, above zero) with the commanded `duty` (0 to 1).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn pwm(frequency: f64, duty: f64, pulse: Request, rest: Request) -> Result<Self, Error> {
        let frequency = parameter::PWM_FREQUENCY.check(frequency)?;
        Ok(Self::Pwm { frequency, duty: parameter::DUTY.check(duty)?, pulse, rest })
    }

    /// Requests that start at the given times in s.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists are empty, differ in length, or the times are negative or do not rise.
    #[cfg(feature = "alloc")]
    pub fn table(time: alloc::vec::Vec<f64>, request: alloc::vec::Vec<Request>) -> Result<Self, Error> {
        let fault = |name, problem, entry, remedy| Err(Error::Table { name, problem, entry, remedy });
        if time.len() != request.len() || time.is_empty() {
            let entry = time.len().min(request.len()) + 1;
            return fault(
                "command.state",
                "there is not one state for each time",
                entry,
                "give as many states as times",
            );
        }
        check_times("command.time", &time)?;
        Ok(Self::Table { time, request })
    }

    /// Set points of a pressure regulator: gauge pressures in Pa, zero or more, that start at the given times in s.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists are empty, differ in length, or the times are negative or do not rise;
    /// [`Error::OutOfRange`] for a gauge pressure below zero.
    #[cfg(feature = "alloc")]
    pub fn set_points(time: alloc::vec::Vec<f64>, gauge_pressure: alloc::vec::Vec<f64>) -> Result<Self, Error> {
        if time.len() != gauge_pressure.len() || time.is_empty() {
            return Err(Error::Table {
                name: parameter::COMMAND_GAUGE_PRESSURE.key,
                problem: "there is not one set point for each time",
                entry: time.len().min(gauge_pressure.len()) + 1,
                remedy: "give as many set points as times",
            });
        }
        check_times("command.time", &time)?;
        gauge_pressure.iter().try_for_each(|gauge| parameter::COMMAND_GAUGE_PRESSURE.check(*gauge).map(drop))?;
        Ok(Self::SetPoints { time, gauge_pressure })
    }
}

impl Command {
    /// Positions of a proportional spool, from −1 (exhaust open) to 1 (supply open), that start at the given times in s.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists are empty, differ in length, or the times are negative or do not rise;
    /// [`Error::OutOfRange`] for a position beyond the stroke.
    #[cfg(feature = "alloc")]
    pub fn positions(time: alloc::vec::Vec<f64>, position: alloc::vec::Vec<f64>) -> Result<Self, Error> {
        if time.len() != position.len() || time.is_empty() {
            return Err(Error::Table {
                name: parameter::COMMAND_POSITION.key,
                problem: "there is not one position for each time",
                entry: time.len().min(position.len()) + 1,
                remedy: "give as many positions as times",
            });
        }
        check_times("command.time", &time)?;
        position.iter().try_for_each(|position| parameter::COMMAND_POSITION.check(*position).map(drop))?;
        Ok(Self::Positions { time, position })
    }
}

/// Checks that times are finite, not negative and strictly rising.
#[cfg(feature = "alloc")]
pub(crate) fn check_times(name: &'static str, time: &[f64]) -> Result<(), Error> {
    let fault = |problem, entry, remedy| Err(Error::Table { name, problem, entry, remedy });
    if let Some(row) = time.iter().position(|t| !(t.is_finite() && *t >= 0.0)) {
        return fault("a time is negative or not finite", row + 1, "give times of zero or more");
    }
    match time.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(row) => fault("the times do not rise", row + 2, "sort the rows by time and drop repeats"),
        None => Ok(()),
    }
}

impl<S: Scalar> Command<S> {
    /// Whether it can be changed a little: the duty of a PWM, a set point or a position. A linear model has such as an input.
    #[cfg(feature = "alloc")]
    pub fn is_continuous(&self) -> bool {
        matches!(self, Self::Pwm { .. } | Self::SetPoints { .. } | Self::Positions { .. })
    }

    /// Converts the command to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Command<T> {
        match self {
            Self::Constant(request) => Command::Constant(*request),
            Self::Pwm { frequency, duty, pulse, rest } => Command::Pwm {
                frequency: convert.parameter(&parameter::PWM_FREQUENCY, *frequency),
                duty: convert.parameter(&parameter::DUTY, *duty),
                pulse: *pulse,
                rest: *rest,
            },
            #[cfg(feature = "alloc")]
            Self::Table { time, request } => Command::Table {
                time: time.iter().map(|&time| convert.parameter(&parameter::COMMAND_TIME, time)).collect(),
                request: request.clone(),
            },
            #[cfg(feature = "alloc")]
            Self::SetPoints { time, gauge_pressure } => Command::SetPoints {
                time: time.iter().map(|&time| convert.parameter(&parameter::COMMAND_TIME, time)).collect(),
                gauge_pressure: gauge_pressure
                    .iter()
                    .map(|&gauge| convert.parameter(&parameter::COMMAND_GAUGE_PRESSURE, gauge))
                    .collect(),
            },
            #[cfg(feature = "alloc")]
            Self::Positions { time, position } => Command::Positions {
                time: time.iter().map(|&time| convert.parameter(&parameter::COMMAND_TIME, time)).collect(),
                position: position.iter().map(|&at| convert.parameter(&parameter::COMMAND_POSITION, at)).collect(),
            },
        }
    }

    /// No command at any time.
    #[cfg(feature = "alloc")]
    pub(crate) fn nothing() -> Self {
        Self::Table { time: alloc::vec::Vec::new(), request: alloc::vec::Vec::new() }
    }

    /// No command at any time, in the kind that a valve takes.
    #[cfg(feature = "alloc")]
    pub(crate) fn nothing_of(solenoid: &crate::valve::Solenoid<S>) -> Self {
        let (time, values) = (alloc::vec::Vec::new(), alloc::vec::Vec::new());
        match (solenoid.spool(), solenoid.regulator()) {
            (Some(_), _) => Self::Positions { time, position: values },
            (None, Some(_)) => Self::SetPoints { time, gauge_pressure: values },
            (None, None) => Self::nothing(),
        }
    }

    /// Whether it holds set points of a pressure regulator, and no requests.
    pub fn has_set_points(&self) -> bool {
        #[cfg(feature = "alloc")]
        let has = matches!(self, Self::SetPoints { .. });
        #[cfg(not(feature = "alloc"))]
        let has = false;
        has
    }

    /// Whether it holds positions of a proportional spool, and no requests.
    pub fn has_positions(&self) -> bool {
        #[cfg(feature = "alloc")]
        let has = matches!(self, Self::Positions { .. });
        #[cfg(not(feature = "alloc"))]
        let has = false;
        has
    }

    /// The position of index `index` (from 0, in order of time): when in s, and where; `None` when there is none.
    pub fn position(&self, index: u64) -> Option<(S, S)> {
        match self {
            #[cfg(feature = "alloc")]
            Self::Positions { time, position } => {
                let row = usize::try_from(index).ok()?;
                Some((*time.get(row)?, *position.get(row)?))
            }
            _ => {
                let _ = index;
                None
            }
        }
    }

    /// The set point of index `index` (from 0, in order of time): when in s, and the gauge pressure in Pa; `None` when there
    /// is none.
    pub fn set_point(&self, index: u64) -> Option<(S, S)> {
        match self {
            #[cfg(feature = "alloc")]
            Self::SetPoints { time, gauge_pressure } => {
                let row = usize::try_from(index).ok()?;
                Some((*time.get(row)?, *gauge_pressure.get(row)?))
            }
            _ => {
                let _ = index;
                None
            }
        }
    }

    /// The gauge pressure in Pa that was last given as a set point at a time in s, that instant included; `None` before the
    /// first.
    pub fn set_point_at(&self, time: S) -> Option<S>
    where
        S: Real,
    {
        let given = (0..).map_while(|index| self.set_point(index)).take_while(|(from, _)| is_due(*from, time));
        given.last().map(|(_, gauge)| gauge)
    }

    /// Whether any request in the command is `wanted`.
    pub fn has_request(&self, wanted: Request) -> bool {
        match self {
            Self::Constant(request) => *request == wanted,
            Self::Pwm { pulse, rest, .. } => *pulse == wanted || *rest == wanted,
            #[cfg(feature = "alloc")]
            Self::Table { request, .. } => request.contains(&wanted),
            #[cfg(feature = "alloc")]
            Self::SetPoints { .. } | Self::Positions { .. } => false,
        }
    }

    /// Replaces each request of the command by another.
    pub fn map_requests(&self, answer: impl Fn(Request) -> Request) -> Self {
        match self.clone() {
            Self::Constant(request) => Self::Constant(answer(request)),
            Self::Pwm { frequency, duty, pulse, rest } => {
                Self::Pwm { frequency, duty, pulse: answer(pulse), rest: answer(rest) }
            }
            #[cfg(feature = "alloc")]
            Self::Table { time, request } => Self::Table { time, request: request.into_iter().map(answer).collect() },
            #[cfg(feature = "alloc")]
            points @ (Self::SetPoints { .. } | Self::Positions { .. }) => points,
        }
    }

    /// The change of index `index` (from 0, in order of time): when, and to what; `None` when there is none.
    pub fn change(&self, index: u64) -> Option<(S, Request)> {
        match self {
            Self::Constant(request) => (index == 0).then_some((S::zero(), *request)),
            Self::Pwm { frequency, duty, pulse, rest } => {
                let never = duty.le(S::zero());
                let always = S::one().le(*duty);
                if (never | always).any() {
                    let request = if never.any() { *rest } else { *pulse };
                    return (index == 0).then_some((S::zero(), request));
                }
                let period = S::constant((index / 2) as f64);
                Some(if index.is_multiple_of(2) {
                    (period / *frequency, *pulse)
                } else {
                    ((period + *duty) / *frequency, *rest)
                })
            }
            #[cfg(feature = "alloc")]
            Self::Table { time, request } => {
                let row = usize::try_from(index).ok()?;
                Some((*time.get(row)?, *request.get(row)?))
            }
            #[cfg(feature = "alloc")]
            Self::SetPoints { .. } | Self::Positions { .. } => None,
        }
    }
}

#[cfg(feature = "alloc")]
impl<S: Real> Command<S> {
    /// Drops what comes first, as many changes as have been `passed`, and all that comes at `before` s or later.
    pub(crate) fn keep(&mut self, passed: u64, before: S) {
        match self {
            Self::Constant(_) | Self::Pwm { .. } => {
                let pending = (passed..).map_while(|index| self.change(index));
                let (time, request) = pending.take_while(|(at, _)| !is_due(before, *at)).unzip();
                *self = Self::Table { time, request };
            }
            Self::Table { time, request } => cut(time, request, passed, before),
            Self::SetPoints { time, gauge_pressure } => cut(time, gauge_pressure, passed, before),
            Self::Positions { time, position } => cut(time, position, passed, before),
        }
    }

    /// Takes over what another command of its kind requests from `from` s on, in place of its own requests from then
    /// on.
    pub(crate) fn take_over(&mut self, other: &Self, from: S) {
        self.keep(0, from);
        let later = |at: &S| is_due(from, *at);
        let mut index = 0;
        while let Some((at, request)) = other.change(index) {
            if later(&at) {
                self.append(at, RuntimeCommand::Request(request));
            }
            index += 1;
        }
        let mut index = 0;
        while let Some((at, gauge)) = other.set_point(index) {
            if later(&at) {
                self.append(at, RuntimeCommand::SetPoint(crate::pressure::GaugePressure(gauge)));
            }
            index += 1;
        }
        let mut index = 0;
        while let Some((at, position)) = other.position(index) {
            if later(&at) {
                self.append(at, RuntimeCommand::Position(position));
            }
            index += 1;
        }
    }

    /// Adds a request from `at` s on, later than all before, to a list of its kind. Pulses are ignored.
    pub(crate) fn append(&mut self, at: S, command: RuntimeCommand<S>) {
        match (self, command) {
            (Self::Table { time, request }, RuntimeCommand::Request(appended)) => {
                time.push(at);
                request.push(appended);
            }
            (Self::SetPoints { time, gauge_pressure }, RuntimeCommand::SetPoint(gauge)) => {
                time.push(at);
                gauge_pressure.push(gauge.0);
            }
            (Self::Positions { time, position }, RuntimeCommand::Position(appended)) => {
                time.push(at);
                position.push(appended);
            }
            _ => {}
        }
    }
}

/// Leaves the rows after the first `passed` and before a time in s.
#[cfg(feature = "alloc")]
fn cut<S: Real, V>(time: &mut alloc::vec::Vec<S>, values: &mut alloc::vec::Vec<V>, passed: u64, before: S) {
    let end = time.partition_point(|at| !is_due(before, *at));
    let passed = usize::try_from(passed).map_or(end, |passed| passed.min(end));
    time.truncate(end);
    values.truncate(end);
    time.drain(..passed);
    values.drain(..passed);
}
