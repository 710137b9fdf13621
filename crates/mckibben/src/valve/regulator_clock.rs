//! What a pressure regulator does over time: the instants at which its pressure becomes another known function.
//!
//! | instant | what follows |
//! |---|---|
//! | a set point takes effect | the closed form goes on from where the pressure is, to the new set point |
//! | the rate falls below its limit | the straight line becomes an exponential |
//!
//! Until the first set point takes effect the pressure rests where it starts.
//!
//! Checked by `tests/regulated_rig.rs`.

use super::Command;
use super::opening::Openings;
use super::regulator::{Regulated, Regulator};
use super::solenoid::{Solenoid, is_due};
use crate::pressure::AbsolutePressure;
use crate::scalar::Real;

/// Where a regulated pressure is and what comes next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegulatorClock<S = f64> {
    /// How many set points have taken effect.
    taken: u64,
    course: Regulated<S>,
    /// When the rate falls below its limit, in s, while it is at it.
    limit_end: Option<S>,
    atmosphere: S,
}

impl<S: Real> RegulatorClock<S> {
    /// Before t = 0: at rest at a pressure, with that of the surroundings.
    pub fn resting(pressure: AbsolutePressure<S>, atmosphere: AbsolutePressure<S>) -> Self {
        let course = Regulated { time: S::zero(), pressure, setpoint: pressure };
        Self { taken: 0, course, limit_end: None, atmosphere: atmosphere.0 }
    }

    /// How many set points have taken effect.
    #[cfg(feature = "alloc")]
    pub(crate) fn passed(&mut self) -> &mut u64 {
        &mut self.taken
    }

    /// The pressure beyond the passage, until the next instant.
    pub fn openings(&self, regulator: &Regulator<S>) -> Openings<S> {
        Openings::Regulated { regulator: *regulator, course: self.course }
    }

    /// The next instant in s, up to and with `until`, at which the pressure becomes another function of time.
    pub fn next(&self, solenoid: &Solenoid<S>, command: &Command<S>, until: S) -> Option<S> {
        let told = command.set_point(self.taken).map(|(time, _)| time + solenoid.latency());
        let first = [told, self.limit_end].into_iter().flatten().min_by(|a, b| a.value().total_cmp(&b.value()))?;
        is_due(first, until).then_some(first)
    }

    /// Passes everything up to and with `time`, in order.
    pub fn advance(&mut self, time: S, regulator: &Regulator<S>, solenoid: &Solenoid<S>, command: &Command<S>) {
        while let Some(instant) = self.next(solenoid, command, time) {
            if self.limit_end.is_some_and(|end| is_due(end, instant)) {
                self.limit_end = None;
            } else if let Some((_, gauge)) = command.set_point(self.taken) {
                self.taken += 1;
                self.course = regulator.turn(&self.course, instant, AbsolutePressure(gauge + self.atmosphere));
                let straight = regulator.straight(&self.course);
                self.limit_end = (straight.value() > 0.0).then_some(instant + straight);
            }
        }
    }
}
