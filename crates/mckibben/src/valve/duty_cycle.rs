//! The actual duty cycle of a pulsed valve: how long its flow paths are open in a period, delays and ramps included.
//!
//! ```text
//! s_supply = d − (t_open − t_close) f                       three-way valve, t_open f ≤ d ≤ 1 − t_close f
//! s_port   = f ∫ λ_port dt over a period                    any kind, any delays, poppets that take their time
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | d, f | `duty` as commanded, `frequency` | –, Hz |
//! | t_open, t_close | delays of the [`Solenoid`] | s |
//! | λ | opening of a flow path | – |
//! | s | actual duty cycle | – |
//!
//! A pulse shorter than `t_open` never opens the valve and a gap shorter than `t_close` never shuts it, so the actual duty
//! cycle is 0 below `t_open f` and 1 above `1 − t_close f`. A dead time, and the delay of a lumped hose behind the valve, shift
//! pulses and do not change it: both are left out.
//!
//! The openings come from the solenoid's own clock ([`PoppetClock`]) in a period long after the start, over any scalar, so the
//! derivative with respect to the commanded duty is exact.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.3: 42.5 % at 25 Hz and 35 % at 50 Hz for a commanded 50 %. Checked by
//! `tests/plant_linear_pulses.rs`, and by `tests/linearize_pwm.rs`.

use super::{Command, Openings, PoppetClock, Ports, Solenoid, ValveKind};
use crate::scalar::{Real, Scalar};
use alloc::vec::Vec;

/// A part of the period between two motions of the poppets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<S = f64> {
    /// Which flow paths are open.
    pub ports: Ports,
    /// The part of the period that it lasts.
    pub share: S,
    /// Mean openings of the flow paths to the supply and to the atmosphere during it, from 0 to 1.
    pub openings: [S; 2],
}

/// The actual duty cycles of the flow paths to the supply and to the atmosphere, each from 0 to 1: the mean openings
/// over a period. `None` unless the command is a PWM and the valve has seats.
pub fn actual_duty_cycle<S: Real>(solenoid: &Solenoid<S>, command: &Command<S>) -> Option<[S; 2]> {
    let intervals = period(solenoid, command)?;
    Some([0, 1].map(|port| intervals.iter().fold(S::zero(), |sum, part| sum + part.share * part.openings[port])))
}

/// The intervals of a period, in order from the instant at which the pulse is commanded, without dead time and the delay of a
/// hose; `None` unless the command is a PWM and the valve has seats.
pub(crate) fn period<S: Real>(solenoid: &Solenoid<S>, command: &Command<S>) -> Option<Vec<Interval<S>>> {
    let Command::Pwm { frequency, .. } = command else { return None };
    if !solenoid.has_poppets() {
        return None;
    }
    // Both shift all pulses: without them the first periods are soon over, however late the valve acts.
    let solenoid = &solenoid.seen_late(S::zero() - solenoid.dead_time());
    let ([opening, closing], [rise, fall]) = (solenoid.delays(), solenoid.ramp().times());
    // After so many periods nothing is left of the start.
    let slow = (opening + closing + rise + fall) * *frequency;
    let begun = slow.value() as u64 + 3;
    let at = |period: u64| S::constant(period as f64) / *frequency;
    let (mut time, end) = (at(begun), at(begun + 1));
    let mut clock = PoppetClock::released();
    clock.advance(time, solenoid, command);
    let mut intervals = Vec::new();
    loop {
        let next = clock.next_motion(solenoid, command, end).unwrap_or(end);
        let ports = clock.ports(solenoid);
        let openings = clock.openings(solenoid);
        let [from, to] = [time, next].map(|time| shares(&openings, ports, time));
        let half = S::constant(0.5);
        let openings = [0, 1].map(|port| half * (from[port] + to[port]));
        intervals.push(Interval { ports, share: (next - time) * *frequency, openings });
        if end.value() <= next.value() {
            return Some(intervals);
        }
        clock.advance(next, solenoid, command);
        time = next;
    }
}

/// The openings of both paths at a time in s: straight lines until the next motion.
fn shares<S: Scalar>(openings: &Openings<S>, ports: Ports, time: S) -> [S; 2] {
    let whole = |open: bool| if open { S::one() } else { S::zero() };
    openings.at(time).unwrap_or([whole(ports.supply), whole(ports.exhaust)])
}

/// A PWM with another duty, over the duty's scalar; `None` for any other command.
pub(crate) fn with_duty<S: Scalar>(command: &Command, duty: S) -> Option<Command<S>> {
    let Command::Pwm { frequency, pulse, rest, .. } = *command else { return None };
    Some(Command::Pwm { frequency: S::constant(frequency), duty, pulse, rest })
}

/// The commanded duties between which every pulse and every gap moves the poppets; `None` unless the command is a PWM.
pub(crate) fn duty_range(solenoid: &Solenoid, command: &Command) -> Option<(f64, f64)> {
    let Command::Pwm { frequency, pulse, rest, .. } = *command else { return None };
    let [opening, closing] = solenoid.delays().map(|delay| delay * frequency);
    let coils = match solenoid.kind() {
        ValveKind::TwoWay | ValveKind::ThreeWay | ValveKind::ThreeWayNormallyOpen => 1,
        ValveKind::FillHoldExhaust => 2,
    };
    let (of_pulse, of_rest) = (solenoid.coils(pulse), solenoid.coils(rest));
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
