//! A valve that receives commands at run time.
//!
//! A command at run time continues the command of the valve. The run is bit-identical to one with the whole command known
//! beforehand: poppets move at the same exact instants, and no step is divided where a command only arrives. Entries that have
//! taken effect are dropped, so that memory is bounded however many commands arrive.
//!
//! | command at t | effect |
//! |---|---|
//! | request, set point, position | replaces all entries from t on; the one that holds goes on |
//! | pulses, during other pulses | the current pulse ends as before; the next period has the new duty |
//! | pulses, without other pulses | the previous command goes on until a period begins |
//!
//! Of two commands at one instant the later counts.
//!
//! Checked by `crates/mckibben-batch/tests/plant_set.rs`: against the command known beforehand, bit for bit.

use super::progress::Progress;
use crate::control::{Drive, Modulator};
use crate::numbered::Row;
use crate::pressure::GaugePressure;
use crate::scalar::Real;
use crate::simulation::Actuation;
use crate::valve::{Request, RuntimeCommand, Solenoid, is_due};

/// The commands that a valve has received at run time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RuntimeCommands<R> {
    last: Option<RuntimeCommand<R>>,
    modulator: Modulator<R>,
    pulse_frequency: R,
    /// When in s the modulator next changes its request without a command; infinite when it does not.
    edge: R,
    /// A command has arrived since the last one took effect.
    is_pending: bool,
}

impl<R: Real> RuntimeCommands<R> {
    /// No command yet.
    pub(crate) fn nothing() -> Self {
        let never = R::constant(f64::INFINITY);
        Self { last: None, modulator: Modulator::idle(), pulse_frequency: R::one(), edge: never, is_pending: false }
    }

    /// Takes a command that changes nothing before the next period: the one that holds, or another duty cycle of the current
    /// pulses. Returns whether the command is one of these.
    #[inline]
    pub(super) fn follow(&mut self, commanded: &RuntimeCommand<R>) -> bool {
        match (&self.last, commanded) {
            (
                Some(RuntimeCommand::Pulses { frequency: before, pulse: pulse_before, rest: rest_before, .. }),
                RuntimeCommand::Pulses { frequency, duty, pulse, rest },
            ) => {
                let goes_on = before.value() == frequency.value() && (pulse_before, rest_before) == (pulse, rest);
                if goes_on {
                    self.last = Some(*commanded);
                    self.modulator.go_on(Drive::Pulses { duty: *duty, pulse: *pulse, rest: *rest });
                }
                goes_on
            }
            (Some(before), now) => before == now,
            (None, _) => false,
        }
    }

    /// Applies a command from `time` in s on, to which the valve has advanced; the command has been checked.
    #[inline]
    pub(crate) fn apply(
        &mut self,
        actuation: &mut Actuation<R>,
        progress: &mut Progress<R>,
        time: R,
        commanded: RuntimeCommand<R>,
    ) {
        if !self.follow(&commanded) {
            self.change(actuation, progress, time, commanded);
        }
    }

    fn change(
        &mut self,
        actuation: &mut Actuation<R>,
        progress: &mut Progress<R>,
        time: R,
        commanded: RuntimeCommand<R>,
    ) {
        let drive = match commanded {
            RuntimeCommand::Request(request) => Some((Drive::Steady(request), self.pulse_frequency)),
            RuntimeCommand::Pulses { frequency, duty, pulse, rest } => {
                Some((Drive::Pulses { duty, pulse, rest }, frequency))
            }
            RuntimeCommand::SetPoint(_) | RuntimeCommand::Position(_) => None,
        };
        let go_on =
            matches!((self.last, commanded), (Some(RuntimeCommand::Pulses { .. }), RuntimeCommand::Pulses { .. }));
        progress.settle(actuation, time, if go_on { R::constant(f64::INFINITY) } else { time });
        match drive {
            Some((drive, frequency)) => {
                if frequency.value() != self.pulse_frequency.value() {
                    self.modulator.recount(time, frequency);
                    self.pulse_frequency = frequency;
                }
                if let Some(request) = self.modulator.command(drive, time, frequency) {
                    actuation.command.append(time, RuntimeCommand::Request(request));
                }
            }
            None => actuation.command.append(time, commanded),
        }
        (self.last, self.is_pending) = (Some(commanded), true);
        self.look_ahead();
    }

    fn look_ahead(&mut self) {
        self.edge = self.modulator.next(self.pulse_frequency).unwrap_or(R::constant(f64::INFINITY));
    }

    /// When in s the request changes next without a command; infinite when never, and any time where a command is
    /// pending.
    pub(crate) fn next_edge(&self) -> R {
        if self.is_pending { R::constant(f64::NEG_INFINITY) } else { self.edge }
    }

    /// The next edge of the pulses in s, if it comes before `until`: a command at `until` comes before a pulse that
    /// begins or ends there.
    #[inline]
    fn edge(&self, until: R) -> Option<R> {
        Some(self.edge).filter(|edge| !is_due(until, *edge))
    }

    /// About how many edges of pulses come before `until` in s.
    #[inline]
    pub(crate) fn edges_until(&self, until: R) -> f64 {
        self.edge(until).map_or(0.0, |edge| 2.0 * self.pulse_frequency.value() * (until - edge).value())
    }

    /// Continues the command of a valve that has come to `time` by the pulses before `until`, both in s.
    #[inline]
    pub(crate) fn advance(&mut self, actuation: &mut Actuation<R>, progress: &mut Progress<R>, [time, until]: [R; 2]) {
        if self.is_pending || self.edge(until).is_some() {
            self.go_on(actuation, progress, [time, until]);
        }
    }

    fn go_on(&mut self, actuation: &mut Actuation<R>, progress: &mut Progress<R>, [time, until]: [R; 2]) {
        let mut settled = core::mem::take(&mut self.is_pending);
        while let Some(edge) = self.edge(until) {
            if !settled {
                progress.settle(actuation, time, R::constant(f64::INFINITY));
                settled = true;
            }
            if let Some(request) = self.modulator.pass(edge, self.pulse_frequency) {
                actuation.command.append(edge, RuntimeCommand::Request(request));
            }
            self.look_ahead();
        }
    }
}

impl<R: Real> RuntimeCommands<R> {
    /// Saves or restores the commands as numbers of a row, for a valve that has advanced to `time` in s.
    pub(crate) fn each_number(&mut self, solenoid: &Solenoid<R>, time: R, row: &mut impl Row<R>) {
        let Self { last, modulator, pulse_frequency, edge, is_pending } = self;
        let (mut kind, mut number, mut duty, mut requests) = match *last {
            None => (0, R::zero(), R::zero(), [Request::Fill; 2]),
            Some(RuntimeCommand::Request(request)) => (1, R::zero(), R::zero(), [request; 2]),
            Some(RuntimeCommand::Pulses { frequency, duty, pulse, rest }) => (2, frequency, duty, [pulse, rest]),
            Some(RuntimeCommand::SetPoint(gauge)) => (3, gauge.0, R::zero(), [Request::Fill; 2]),
            Some(RuntimeCommand::Position(position)) => (4, position, R::zero(), [Request::Fill; 2]),
        };
        row.choice(&mut kind, [0, 1, 2, 3, 4]);
        row.number(&mut number);
        row.duty(&mut duty);
        requests.iter_mut().for_each(|request| row.request(request));
        *last = match kind {
            0 => None,
            1 => Some(RuntimeCommand::Request(requests[0])),
            2 => Some(RuntimeCommand::Pulses { frequency: number, duty, pulse: requests[0], rest: requests[1] }),
            3 => Some(RuntimeCommand::SetPoint(GaugePressure(number))),
            _ => Some(RuntimeCommand::Position(number)),
        };
        if row.puts_back() && last.is_some_and(|commanded| solenoid.check_command(&commanded).is_err()) {
            row.refuse();
        }
        modulator.each_number(row);
        row.number(pulse_frequency);
        if pulse_frequency.value() <= 0.0 {
            row.refuse();
        }
        let mut instant = Some(*edge).filter(|edge| edge.value() != f64::INFINITY);
        row.instant(&mut instant);
        *edge = instant.unwrap_or(R::constant(f64::INFINITY));
        // The edges of pulses up to now have been appended.
        if edge.value() != modulator.next(*pulse_frequency).map_or(f64::INFINITY, R::value) || !is_due(time, *edge) {
            row.refuse();
        }
        row.truth(is_pending);
    }
}
