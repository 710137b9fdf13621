//! The actual duty cycle of a pulsed valve: how long its flow paths are open in a period, delays and ramps included.
//!
//! ```text
//! s_supply = d − (t_open − t_close) f                       three-way valve, t_open f ≤ d ≤ 1 − t_close f
//! s_port   = f ∫ λ_port dt over a period                    any kind, any delays, poppets that take their time
//!
//! λ(T) = g(λ(0)) = min(max(λ(0) + δ, g(0)), g(1))           over a period T, δ the strokes up less those down
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
//! The instants at which coils send the poppets come from the solenoid's own clock ([`PoppetClock`]) in a period long after the
//! start, over any scalar, so the derivative with respect to the commanded duty is exact. Strokes begin where a period repeats.
//! A poppet whose strokes take longer than pulse and gap drifts by δ in each period, until it meets an end: after many periods
//! it begins at g(1) where it drifts open, else at g(0), since it starts shut. Between the two the duty cycle jumps.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.3: 42.5 % at 25 Hz and 35 % at 50 Hz for a commanded 50 %. Checked by
//! `tests/plant_linear_pulses.rs`, and by `tests/linearize_pwm.rs`.

use super::{Command, PoppetClock, Ports, Ramp, Solenoid, Stroke, ValveKind};
use crate::convert::ConvertEach;
use crate::parameter::{self, Parameter};
use crate::scalar::{Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// The drift in a period, as a part of the whole stroke, up to which a poppet stays where it started.
const NO_DRIFT: f64 = 1e-9;

/// A part of the period between two motions of the poppets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<S = f64> {
    /// Which flow paths are open.
    pub ports: Ports,
    /// The part of the period that it lasts.
    pub share: S,
    /// Mean openings of the flow paths to the supply and to the atmosphere during it, from 0 to 1.
    pub openings: [S; 2],
    /// These openings as it begins and as it ends, with a straight line between.
    pub ends: [[S; 2]; 2],
}

/// Which way each poppet is sent, and from when on in s.
type Sent<S> = (S, [bool; 2]);

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
    let (sent, end) = sent(solenoid, command, *frequency);
    let mut intervals = Vec::new();
    let mut strokes = [0, 1].map(|side| resting_at(begins(solenoid.ramp(), &sent, end, side), sent[0].0));
    for (index, (since, open)) in sent.iter().enumerate() {
        strokes = [0, 1].map(|side| solenoid.ramp().send(&strokes[side], *since, open[side]));
        let (mut time, until) = (*since, until(&sent, index, end));
        loop {
            let arrivals = strokes.iter().filter_map(|stroke| stroke.arrival(time));
            let sooner = |first: S, arrival: S| if arrival.value() < first.value() { arrival } else { first };
            let next = arrivals.fold(until, sooner);
            let ends = [time, next].map(|at| solenoid.kind().shares(strokes.map(|stroke| stroke.opening(at))));
            let openings = [0, 1].map(|port| S::constant(0.5) * (ends[0][port] + ends[1][port]));
            let [supply, exhaust] = openings.map(|opening| opening.value() > 0.0);
            let share = (next - time) * *frequency;
            intervals.push(Interval { ports: Ports { supply, exhaust }, share, openings, ends });
            if until.value() <= next.value() {
                break;
            }
            time = next;
        }
    }
    Some(intervals)
}

/// Which way the poppets are sent in a period, first as it begins, and when in s it ends.
fn sent<S: Real>(solenoid: &Solenoid<S>, command: &Command<S>, frequency: S) -> (Vec<Sent<S>>, S) {
    // Strokes do not change when coils send poppets. A dead time shifts all pulses: without it the first periods are soon over,
    // however late the valve acts.
    let left_out = [&parameter::OPENING_TIME, &parameter::CLOSING_TIME, &parameter::VALVE_DEAD_TIME].map(|row| row.key);
    let at_once = |row: &'static Parameter, value: S| if left_out.contains(&row.key) { S::zero() } else { value };
    let solenoid = solenoid.convert(&mut ConvertEach(at_once));
    let [opening, closing] = solenoid.delays();
    // After so many periods nothing is left of the start.
    let begun = ((opening + closing) * frequency).value() as u64 + 3;
    let at = |period: u64| S::constant(period as f64) / frequency;
    let (begin, end) = (at(begun), at(begun + 1));
    let mut clock = PoppetClock::released();
    clock.advance(begin, &solenoid, command);
    let mut sent = vec![(begin, open(&solenoid, &clock))];
    while let Some(next) = clock.next_motion(&solenoid, command, end).filter(|next| next.value() < end.value()) {
        clock.advance(next, &solenoid, command);
        sent.push((next, open(&solenoid, &clock)));
    }
    (sent, end)
}

/// Which poppets are open, by the flow paths of a valve whose poppets jump.
fn open<S: Real>(solenoid: &Solenoid<S>, clock: &PoppetClock<S>) -> [bool; 2] {
    let Ports { supply, exhaust } = clock.ports(solenoid);
    match solenoid.kind() {
        ValveKind::TwoWay | ValveKind::ThreeWay => [supply, false],
        ValveKind::ThreeWayNormallyOpen => [exhaust, false],
        ValveKind::FillHoldExhaust => [supply, exhaust],
    }
}

/// Until when in s a poppet is sent one way.
fn until<S: Real>(sent: &[Sent<S>], index: usize, end: S) -> S {
    sent.get(index + 1).map_or(end, |(next, _)| *next)
}

/// A poppet that is at an opening from a time in s on.
fn resting_at<S: Scalar>(opening: S, time: S) -> Stroke<S> {
    Stroke { start: time, end: time, from: opening, to: opening }
}

/// The opening of a poppet as a period begins, when periods repeat.
fn begins<S: Real>(ramp: &Ramp<S>, sent: &[Sent<S>], end: S, side: usize) -> S {
    let after = |opening: S| -> S {
        let start = resting_at(opening, sent[0].0);
        sent.iter().fold(start, |stroke, (since, open)| ramp.send(&stroke, *since, open[side])).opening(end)
    };
    let [rise, fall] = ramp.times().map(|time| time.value());
    let drift = sent.iter().enumerate().map(|(index, (since, open))| {
        let lasting = (until(sent, index, end) - *since).value();
        if open[side] { lasting / rise } else { -lasting / fall }
    });
    // Without a stroke one way there may be no number here; then both ends lead to one opening.
    if drift.sum::<f64>() > NO_DRIFT { after(S::one()) } else { after(S::zero()) }
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
