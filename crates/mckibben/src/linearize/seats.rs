//! What the valve's seats do in one period of a PWM that has run for long: the solenoid's own clock, over any scalar.

use crate::convert::Anew;
use crate::scalar::Real;
use crate::simulation::Actuation;
use crate::valve::{Command, Ports, SeatClock, ValveKind};
use alloc::vec::Vec;

/// A part of the period in which the seats stand still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<S = f64> {
    /// Which passages are open.
    pub ports: Ports,
    /// The part of the period that it lasts.
    pub share: S,
}

/// The intervals of a period, in order from the instant at which the pulse is commanded; `None` unless the command is a
/// PWM. The commanded duty is in its place `duty`, so that the shares carry its derivative.
pub(super) fn period<S: Real<Time = S>>(actuation: &Actuation, duty: S) -> Option<Vec<Interval<S>>> {
    let Command::Pwm { frequency, pulse, rest, .. } = actuation.command else { return None };
    let mut constant = Anew(|_: &'static _, value: f64| S::constant(value));
    let solenoid = actuation.solenoid.convert(&mut constant);
    let command = Command::Pwm { frequency: S::constant(frequency), duty, pulse, rest };
    let [opening, closing] = actuation.solenoid.delays();
    // After so many periods nothing is left of the start.
    let begun = ((opening + closing) * frequency) as u64 + 3;
    let at = |period: u64| S::constant(period as f64) / S::constant(frequency);
    let (mut time, end) = (at(begun), at(begun + 1));
    let mut clock = SeatClock::released();
    clock.advance(time, &solenoid, &command);
    let mut intervals = Vec::new();
    loop {
        let next = clock.next_motion(&solenoid, &command, end).unwrap_or(end);
        let share = (next - time) * S::constant(frequency);
        intervals.push(Interval { ports: clock.ports(&solenoid), share });
        if end.value() <= next.value() {
            return Some(intervals);
        }
        clock.advance(next, &solenoid, &command);
        time = next;
    }
}

/// The commanded duties between which every pulse and every gap moves the seats.
pub(super) fn duty_range(actuation: &Actuation) -> Option<(f64, f64)> {
    let Command::Pwm { frequency, pulse, rest, .. } = actuation.command else { return None };
    let [opening, closing] = actuation.solenoid.delays().map(|delay| delay * frequency);
    let coils = match actuation.solenoid.kind() {
        ValveKind::TwoWay | ValveKind::ThreeWay | ValveKind::ThreeWayNormallyOpen => 1,
        ValveKind::FillHoldExhaust => 2,
    };
    let (of_pulse, of_rest) = (actuation.solenoid.coils(pulse), actuation.solenoid.coils(rest));
    let mut range = (0.0, 1.0);
    for coil in 0..coils {
        // A coil is energised for the pulse, for the rest of the period, or never lets go.
        let energised = match (of_pulse[coil], of_rest[coil]) {
            (true, false) => (opening, 1.0 - closing),
            (false, true) => (closing, 1.0 - opening),
            _ => continue,
        };
        range = (f64::max(range.0, energised.0), f64::min(range.1, energised.1));
    }
    Some(range)
}
