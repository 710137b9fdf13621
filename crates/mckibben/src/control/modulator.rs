//! The modulator: the request to the valve at every instant, from commands that arrive on sampling instants.
//!
//! ```text
//! steady    the request at once, and until the next command
//! pulses    period p begins at p/f; its pulse ends at (p + duty)/f, with the duty that holds when it begins
//! ```
//!
//! A duty cycle is taken up when the next period begins, which is at once where the pulses have the rate of the samples; a
//! command in the middle of a period leaves its pulse as it is. At one instant commands come before pulses. A duty of zero
//! or less is all rest, of one or more all pulse.

use super::Drive;
#[cfg(feature = "alloc")]
use crate::numbered::Row;
use crate::scalar::Real;
use crate::valve::{Request, is_due};

/// The state of the modulation. It belongs to the time stepper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulator<R = f64> {
    drive: Option<Drive<R>>,
    next_period: u64,
    /// When the pulse ends, and what follows.
    end: Option<(R, Request)>,
}

impl<R: Real> Modulator<R> {
    /// Before the first command.
    pub fn idle() -> Self {
        Self { drive: None, next_period: 0, end: None }
    }

    /// The command that holds.
    pub fn drive(&self) -> Option<Drive<R>> {
        self.drive
    }

    /// A command arrives at `time` in s; the request that changes at once, if one does.
    #[inline]
    pub fn command(&mut self, drive: Drive<R>, time: R, frequency: R) -> Option<Request> {
        let was_pulsing = matches!(self.drive, Some(Drive::Pulses { .. }));
        self.drive = Some(drive);
        match drive {
            Drive::Steady(request) => {
                self.end = None;
                Some(request)
            }
            Drive::Pulses { .. } => {
                if !was_pulsing {
                    self.next_period = first_period(time, frequency);
                }
                None
            }
        }
    }

    /// Pulses that are under way have another duty cycle from the next period on.
    #[cfg(feature = "alloc")]
    pub(crate) fn go_on(&mut self, pulses: Drive<R>) {
        self.drive = Some(pulses);
    }

    /// From `time` in s on periods have another frequency in Hz. A pulse under way ends as it was to.
    #[cfg(feature = "alloc")]
    pub(crate) fn recount(&mut self, time: R, frequency: R) {
        self.next_period = first_period(time, frequency);
    }

    /// The next instant in s at which the request changes without a new command.
    pub fn next(&self, frequency: R) -> Option<R> {
        let period = matches!(self.drive, Some(Drive::Pulses { .. })).then(|| begin(self.next_period, frequency));
        [period, self.end.map(|(time, _)| time)].into_iter().flatten().min_by(|a, b| a.value().total_cmp(&b.value()))
    }

    /// Passes what [`Modulator::next`] says, at `time` in s; the request from then on. Of a pulse that ends and a period
    /// that begins in one instant, the period counts.
    pub fn pass(&mut self, time: R, frequency: R) -> Option<Request> {
        let ended = self.end.take_if(|(end, _)| is_due(*end, time)).map(|(_, rest)| rest);
        let Some(Drive::Pulses { duty, pulse, rest }) = self.drive else { return ended };
        if !is_due(begin(self.next_period, frequency), time) {
            return ended;
        }
        let until = (R::constant(self.next_period as f64) + duty) / frequency;
        self.next_period += 1;
        let (some, all) = (duty.value() > 0.0, duty.value() >= 1.0);
        self.end = (some && !all).then_some((until, rest));
        Some(if some { pulse } else { rest })
    }
}

#[cfg(feature = "alloc")]
impl<R: Real> Modulator<R> {
    /// As numbers in a row.
    pub(crate) fn each_number(&mut self, row: &mut impl Row<R>) {
        let (mut kind, mut duty, mut pulse, mut rest) = match self.drive {
            None => (0, R::zero(), Request::Fill, Request::Fill),
            Some(Drive::Steady(request)) => (1, R::zero(), request, request),
            Some(Drive::Pulses { duty, pulse, rest }) => (2, duty, pulse, rest),
        };
        row.choice(&mut kind, [0, 1, 2]);
        row.duty(&mut duty);
        row.request(&mut pulse);
        row.request(&mut rest);
        self.drive = match kind {
            0 => None,
            1 => Some(Drive::Steady(pulse)),
            _ => Some(Drive::Pulses { duty, pulse, rest }),
        };
        row.count(&mut self.next_period);
        let (mut end, mut after) = self.end.map_or((None, Request::Fill), |(end, after)| (Some(end), after));
        row.instant(&mut end);
        row.request(&mut after);
        self.end = end.map(|end| (end, after));
    }
}

/// When a period begins, in s.
fn begin<R: Real>(period: u64, frequency: R) -> R {
    R::constant(period as f64) / frequency
}

/// The first period that does not begin before `time` in s.
fn first_period<R: Real>(time: R, frequency: R) -> u64 {
    let period = (time * frequency).value() as u64;
    // The product may lie a rounding to either side of a whole number. Beyond the periods that can be counted none begins.
    let near = period.saturating_sub(1)..=period.saturating_add(2);
    near.into_iter().find(|period| is_due(time, begin(*period, frequency))).unwrap_or(period)
}
