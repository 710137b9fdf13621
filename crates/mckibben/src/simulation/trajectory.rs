//! A stored trajectory: samples at any time, the log of events, and what it cost.

use super::hybrid::{Phase, RigSystem};
use super::integrator::{Counts, Integrator, Piece};
use super::kernel::Observed;
use super::mode::{EventKind, Extent, Mode};
use super::rig::{Rig, State};
use super::sample::{Sample, SampleTimes};
use crate::error::Error;
use crate::parameter;
use crate::scalar::Real;
use crate::simulation::system::HybridSystem;
use crate::valve::SIMULTANEOUS;
use alloc::vec::Vec;

/// A change of mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event<R = f64> {
    /// When, in s.
    pub time: R,
    /// What happened.
    pub kind: EventKind,
    /// The mode before.
    pub before: Mode,
    /// The mode after.
    pub after: Mode,
}

/// A simulated stretch of time.
#[derive(Clone, Debug)]
pub struct Trajectory<R: Real = f64> {
    rig: Rig<R>,
    relative_tolerance: f64,
    pieces: Vec<Piece<R, Phase<R>, EventKind, 4>>,
    events: Vec<Event<R>>,
    last: (R, [R; 4], Phase<R>),
    counts: Counts,
}

/// Steps that a stored trajectory may have: about two gigabytes.
const MAX_PIECES: usize = 4_000_000;

/// Simulates a rig from a state at t = 0 for `duration` s, every event located, with `relative_tolerance` for each step.
///
/// # Errors
/// [`Error::OutOfRange`] for a duration or tolerance outside its range; [`Error::Stopped`] when the simulation cannot
/// reach its end: it says when, where and what to change.
pub fn simulate<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
) -> Result<Trajectory<R>, Error> {
    simulate_watched(rig, start, duration, relative_tolerance, |_| ())
}

/// Pieces between two calls of a watcher: a fraction of a millisecond.
const WATCHED: usize = 256;

/// The same as [`simulate`], calling `watch` with the time in s that has been reached, now and then.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_watched<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
    mut watch: impl FnMut(f64),
) -> Result<Trajectory<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
    let system = RigSystem::new(rig, relative_tolerance);
    let state = start.to_array();
    let phase = system.begin(&state);
    let mut integrator = Integrator::new(&system, R::zero(), state, phase, duration, relative_tolerance);
    let mut pieces = Vec::new();
    let mut events = Vec::new();
    while let Some(piece) = integrator.advance()? {
        if let Some((kind, after)) = piece.event {
            events.push(Event { time: piece.end, kind, before: piece.mode.mode, after: after.mode });
        }
        pieces.push(piece);
        if pieces.len().is_multiple_of(WATCHED) {
            watch(integrator.time().value());
        }
        if pieces.len() > MAX_PIECES {
            return Err(Error::Stopped {
                time: integrator.time().value(),
                reason: "the run takes more steps than a stored trajectory may have",
                quantity: "steps",
                value: MAX_PIECES as f64,
                unit: "",
                remedy: "shorten run.duration, loosen run.relative_tolerance, or use the fixed-step engine",
            });
        }
    }
    let last = (integrator.time(), *integrator.state(), *integrator.mode());
    let counts = integrator.counts();
    Ok(Trajectory { rig: rig.clone(), relative_tolerance, pieces, events, last, counts })
}

impl<R: Real> Trajectory<R> {
    /// The rig that was simulated.
    pub fn rig(&self) -> &Rig<R> {
        &self.rig
    }

    /// The events in order of time.
    pub fn events(&self) -> &[Event<R>] {
        &self.events
    }

    /// Steps, evaluations and events.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// End of the trajectory in s.
    pub fn duration(&self) -> R {
        self.last.0
    }

    /// The sample at `time` in s, by dense output; at the instant of an event, after it. Times before the start and
    /// after the end give the first and the last sample.
    pub fn at(&self, time: R) -> Sample<R> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        self.sample_with(&system, self.pieces.partition_point(|piece| begins_by(piece, time.value())), time)
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = Sample<R>> + '_ {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        let times = SampleTimes::new(self.last.0.value(), interval);
        let mut place = 0;
        (0..=times.last()).map(move |index| {
            let time = times.time(index);
            while self.pieces.get(place).is_some_and(|piece| begins_by(piece, time)) {
                place += 1;
            }
            self.sample_with(&system, place, R::constant(time))
        })
    }

    /// Reads the four states at times in s that do not fall from one call to the next.
    pub(super) fn states(&self) -> impl FnMut(f64) -> [R; 4] + '_ {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        let mut place = 0;
        move |time| {
            place += self.pieces[place..].iter().take_while(|piece| begins_by(piece, time)).count();
            self.state_with(&system, place, R::constant(time)).1
        }
    }

    /// The least and the greatest value of each state, at five points of each step.
    pub(super) fn ranges(&self) -> [(f64, f64); 4] {
        const POINTS: usize = 5;
        let mut ranges = self.last.1.map(|value| (value.value(), value.value()));
        for piece in &self.pieces {
            let end = piece.arc.theta(piece.end);
            for point in 0..POINTS {
                let state = piece.arc.at(end * R::constant(point as f64 / (POINTS - 1) as f64));
                for (range, value) in ranges.iter_mut().zip(state) {
                    *range = (range.0.min(value.value()), range.1.max(value.value()));
                }
            }
        }
        ranges
    }

    fn sample_with(&self, system: &RigSystem<'_, R>, begun: usize, time: R) -> Sample<R> {
        let (time, state, phase) = self.state_with(system, begun, time);
        sample(system, time, &state, &phase)
    }

    /// The states and the phase at a time by which so many pieces have begun; the time itself, or the end of the run.
    fn state_with(&self, system: &RigSystem<'_, R>, begun: usize, time: R) -> (R, [R; 4], Phase<R>) {
        let (end, _, _) = &self.last;
        if time.value() >= end.value() * (1.0 - SIMULTANEOUS) {
            return self.last;
        }
        match begun.checked_sub(1).and_then(|index| self.pieces.get(index)).or(self.pieces.first()) {
            Some(piece) => {
                let at = R::constant(time.value().clamp(piece.arc.start.value(), piece.end.value()));
                let mut state = piece.arc.at(piece.arc.theta(at));
                system.project(at, &mut state, &piece.mode);
                (time, state, piece.mode)
            }
            None => self.last,
        }
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of each step: `Σ weight · f` is the
    /// integral of f over the trajectory, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &Sample<R>, &Mode)) {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        for piece in &self.pieces {
            let length = piece.end - piece.arc.start;
            if length.value() <= 0.0 {
                continue;
            }
            for (node, weight) in GAUSS {
                let time = piece.arc.start + length * R::constant(node);
                let mut state = piece.arc.at(piece.arc.theta(time));
                system.project(time, &mut state, &piece.mode);
                visit(length * R::constant(weight), &sample(&system, time, &state, &piece.mode), &piece.mode.mode);
            }
        }
    }
}

/// Whether a piece has begun at a time. Two instants that differ by rounding are one.
fn begins_by<R: Real>(piece: &Piece<R, Phase<R>, EventKind, 4>, time: f64) -> bool {
    piece.arc.start.value() <= time * (1.0 + SIMULTANEOUS)
}

fn sample<R: Real>(system: &RigSystem<'_, R>, time: R, state: &[R; 4], phase: &Phase<R>) -> Sample<R> {
    let actuator = system.rig().actuator();
    let slack = phase.mode.extent == Extent::Slack;
    let chamber = actuator.chamber(state[0], state[1], state[2], state[3], slack);
    let temperature = actuator.air().temperature(&chamber);
    let flow = system.flow(&chamber, &phase.mode);
    let tension = system.tension(state, &phase.mode);
    let observed = Observed { tension, volume: chamber.volume, temperature, flow };
    Sample::new(time, state, &observed, phase.mode.ports)
}

/// Nodes and weights of Gauss–Legendre quadrature with five points on `[0, 1]`, exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];
