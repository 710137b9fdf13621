//! How far along its command a valve is, and the instants to come at which its poppets or its spool move: known beforehand, so
//! that both engines and the batches stop there exactly.

use crate::numbered::Row;
use crate::scalar::Real;
use crate::simulation::Actuation;
use crate::valve::{Openings, PoppetClock, Ports, SpoolClock};

/// How far along its command a valve is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress<S> {
    clock: PoppetClock<S>,
    spool: SpoolClock<S>,
    /// How many instants of the spool have been passed.
    spool_passed: u64,
}

impl<S: Real> Progress<S> {
    /// Before the first instant.
    pub(crate) fn none() -> Self {
        Self { clock: PoppetClock::released(), spool: SpoolClock::resting(), spool_passed: 0 }
    }

    /// The next instant in s, up to and with `until`, at which a poppet or a spool moves or arrives.
    pub(crate) fn next(&self, Actuation { solenoid, command }: &Actuation<S>, until: S) -> Option<S> {
        match solenoid.spool() {
            None => self.clock.next_motion(solenoid, command, until),
            Some(_) => self.spool.next(solenoid, command, until),
        }
    }

    /// Passes everything up to and with `time` (s); which flow paths are open then.
    pub(crate) fn pass(&mut self, Actuation { solenoid, command }: &Actuation<S>, time: S) -> Ports {
        match solenoid.spool() {
            None => {
                self.clock.advance(time, solenoid, command);
                self.clock.ports(solenoid)
            }
            Some(spool) => {
                self.spool_passed += self.spool.advance(time, spool, solenoid, command);
                self.spool.ports(spool)
            }
        }
    }

    /// How far the flow paths are open, until the next instant.
    pub(crate) fn openings(&self, Actuation { solenoid, .. }: &Actuation<S>) -> Openings<S> {
        match solenoid.spool() {
            None => self.clock.openings(solenoid),
            Some(spool) => self.spool.openings(spool),
        }
    }

    /// A number that differs once the openings are another function of time.
    pub(crate) fn openings_counted(&self) -> u64 {
        self.clock.strokes_counted() + self.spool_passed
    }

    /// Leaves of a command what has not been passed up to `time` and comes before `before`, both in s.
    pub(crate) fn settle(&mut self, actuation: &mut Actuation<S>, time: S, before: S) {
        self.drop_passed(actuation, before);
        let Actuation { solenoid, command } = actuation;
        if solenoid.has_poppets() {
            // Coils that have been driven without a poppet that moved.
            self.clock.advance(time, solenoid, command);
        }
    }

    /// Drops of a command all that has been passed up to `time` in s; coils that no poppet has followed are passed as well.
    pub(crate) fn forget_passed(&mut self, actuation: &mut Actuation<S>, time: S) {
        let Actuation { solenoid, command } = actuation;
        if solenoid.has_poppets() && self.clock.next_motion(solenoid, command, time).is_none() {
            self.clock.advance(time, solenoid, command);
        }
        self.drop_passed(actuation, S::constant(f64::INFINITY));
    }

    /// Leaves of a command what has not been passed and comes before `before` in s.
    fn drop_passed(&mut self, Actuation { solenoid, command }: &mut Actuation<S>, before: S) {
        let passed = if solenoid.spool().is_some() { self.spool.passed() } else { self.clock.passed() };
        command.keep(core::mem::take(passed), before);
    }
}

impl<S: Real> Progress<S> {
    /// Whether something of a command has been passed and is still in it.
    pub(crate) fn has_passed(&mut self) -> bool {
        *self.clock.passed() > 0 || *self.spool.passed() > 0
    }

    /// As numbers in a row.
    pub(crate) fn each_number(&mut self, row: &mut impl Row<S>) {
        self.clock.each_number(row);
        self.spool.each_number(row);
        row.count(&mut self.spool_passed);
    }
}
