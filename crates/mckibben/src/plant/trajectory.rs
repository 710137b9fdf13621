//! A run of a plant: its steps kept, the state at any time, samples and events.

use super::Plant;
use super::crossing::{Part, PlantEventKind};
use super::evaluation::{Evaluation, System};
use super::mode::PlantMode;
use super::run::PlantRun;
use super::start::PlantStart;
use super::steps::TimeStepping;
use crate::command::PlantDecision;
use crate::engine::{Statistics, arc};
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::parameter;
use crate::valve::SIMULTANEOUS;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// An event of a plant.
#[derive(Clone, Debug)]
pub struct PlantEvent<R = f64> {
    /// When, in s.
    pub time: R,
    /// What happened, and to which part.
    pub kind: PlantEventKind,
}

/// Control points of a step and the segment that it belongs to.
#[derive(Clone, Copy, Debug)]
struct Kept<R> {
    start: R,
    step: R,
    end: R,
    segment: usize,
    /// The event that ended it, which began the next segment.
    event: Option<usize>,
}

/// A step of a run: its control points, from `start` for `step` s, valid up to `end`, and the mode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PieceView<'t, R: Instantiate = f64> {
    pub(crate) start: R,
    pub(crate) step: R,
    pub(crate) end: R,
    pub(crate) points: &'t [R],
    pub(crate) mode: &'t PlantMode<R>,
}

impl<R: Instantiate> PieceView<'_, R> {
    /// Reads the states at a time in s, kept within the step, and returns that. A time that differs from the start by rounding has
    /// the states of the start, to the bit.
    pub(crate) fn state(&self, time: R, state: &mut [R]) -> R {
        let Self { start, step, end, points, .. } = *self;
        if begins_by(start, time.value()) && time.value() <= start.value() * (1.0 + SIMULTANEOUS) {
            let theta = (time - start) / step;
            arc::at(points, theta - R::constant(theta.value()), state);
            return time;
        }
        let time = R::constant(time.value().clamp(start.value(), end.value().max(start.value())));
        arc::at(points, (time - start) / step, state);
        time
    }
}

/// A run of a plant.
#[derive(Clone, Debug)]
pub struct PlantTrajectory<R: Instantiate = f64> {
    plant: Arc<Plant<R>>,
    stepping: TimeStepping,
    /// The modes, each stored once.
    segments: Vec<PlantMode<R>>,
    pieces: Vec<Kept<R>>,
    points: Vec<R>,
    events: Vec<PlantEvent<R>>,
    decisions: Vec<(usize, PlantDecision<R>)>,
    statistics: Statistics,
    last: (R, Vec<R>, PlantMode<R>),
}

/// Steps after which the watcher of a run that keeps them is called.
pub const STEPS_WATCHED: usize = 256;
/// Numbers that a kept run may have: about two gigabytes.
const MOST_NUMBERS: usize = 250_000_000;

/// Simulates a plant from a start for `duration` s: by the event-located engine with a relative tolerance for each step, or by
/// another [`TimeStepping`].
///
/// # Errors
/// As [`Plant::start`]; [`Error::OutOfRange`] for a duration outside its range; [`Error::Stopped`] when the plant leaves
/// what the model describes or no step is short enough.
pub fn simulate_plant<R: Instantiate>(
    plant: &Plant<R>,
    start: &PlantStart<R>,
    duration: R,
    stepping: impl Into<TimeStepping>,
) -> Result<PlantTrajectory<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    PlantRun::new(plant, start, stepping)?.record_to(duration, &mut |_| Ok(()))
}

impl<R: Instantiate> PlantTrajectory<R> {
    /// Takes a run on to `until` in s and keeps it from here to there.
    pub(crate) fn record(
        run: &mut PlantRun<R>,
        until: R,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<Self, Error> {
        let mut kept = Self::begin(run);
        kept.keep(run, until, watch)?;
        Ok(kept)
    }

    /// Nothing yet of a run, from where that is.
    pub(crate) fn begin(run: &PlantRun<R>) -> Self {
        Self {
            plant: run.shared_plant().clone(),
            stepping: run.stepping(),
            segments: Vec::new(),
            pieces: Vec::new(),
            points: Vec::new(),
            events: Vec::new(),
            decisions: Vec::new(),
            statistics: run.statistics(),
            last: (run.time(), run.state().to_vec(), run.mode().clone()),
        }
    }

    /// Takes the run on to `until` in s, and keeps what it does from where it is.
    pub(crate) fn keep(
        &mut self,
        run: &mut PlantRun<R>,
        until: R,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        R::keep_plant_run(self, run, until, watch)
    }

    pub(crate) fn generic_keep(
        &mut self,
        run: &mut PlantRun<R>,
        until: R,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        self.segments.push(run.mode().clone());
        let Self { plant, segments, pieces, points, events, decisions, .. } = self;
        run.extend(until, &mut |piece| {
            points.extend_from_slice(&piece.arc.points);
            let (start, step) = (piece.arc.start, piece.arc.step);
            let event = piece.event.map(|_| events.len());
            pieces.push(Kept { start, step, end: piece.end, segment: segments.len() - 1, event });
            if let Some((kind, after)) = piece.event {
                events.push(PlantEvent { time: piece.end, kind });
                segments.push(after.clone());
                if let Part::Driver(driver) = kind.part {
                    Arc::make_mut(plant).network.record_settings(
                        after.drivers[driver].valves(),
                        piece.end,
                        &after.network,
                    );
                    decisions.extend(after.drivers[driver].last().map(|decision| (driver, decision.clone())));
                }
            }
            if pieces.len().is_multiple_of(STEPS_WATCHED) {
                watch(piece.end.value())?;
            }
            if points.len() > MOST_NUMBERS {
                return Err(Error::Stopped {
                    time: piece.end.value(),
                    reason: "the run takes more steps than a kept trajectory may have",
                    quantity: "steps",
                    value: pieces.len() as f64,
                    unit: "",
                    remedy: "shorten run.duration or loosen run.relative_tolerance",
                });
            }
            Ok(())
        })?;
        self.last = (run.time(), run.state().to_vec(), run.mode().clone());
        self.statistics = run.statistics();
        Ok(())
    }

    /// The plant that was simulated; the commands of valves that a driver had are the tables of all its requests.
    pub fn plant(&self) -> &Plant<R> {
        &self.plant
    }

    /// The plant, shared with its evaluation.
    pub(crate) fn shared_plant(&self) -> &Arc<Plant<R>> {
        &self.plant
    }

    /// The events in order of time.
    pub fn events(&self) -> &[PlantEvent<R>] {
        &self.events
    }

    /// What drivers decided, each with the index of its driver, in order of time.
    pub fn decisions(&self) -> &[(usize, PlantDecision<R>)] {
        &self.decisions
    }

    /// Steps, evaluations and events.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// End of the run in s.
    pub fn duration(&self) -> R {
        self.last.0
    }

    /// How it went through time.
    pub fn stepping(&self) -> TimeStepping {
        self.stepping
    }

    /// The relative tolerance of each step, at fixed steps that of borders alone: [`TimeStepping::tolerance`].
    pub fn relative_tolerance(&self) -> f64 {
        self.stepping.tolerance()
    }

    /// The states at `time` in s, by dense output, with the mode that holds; at the instant of an event, after it. Times before
    /// the start and after the end give the first and the last state.
    pub fn at(&self, time: R) -> (Vec<R>, &PlantMode<R>) {
        R::read_plant_state(self, time)
    }

    pub(crate) fn generic_at(&self, time: R) -> (Vec<R>, &PlantMode<R>) {
        let system = System::new(&self.plant, self.stepping.tolerance());
        let mut state = vec![R::zero(); self.plant.indices().states];
        let begun = self.begun(0, time.value());
        let (_, mode) = self.read(&system, begun, time, &mut state, &mut Evaluation::new(&self.plant));
        (state, mode)
    }

    /// Times in s at so many points of each step, both ends included.
    pub(crate) fn points(&self, count: usize) -> Vec<R> {
        let of_piece = |Kept { start, end, .. }: &Kept<R>| {
            let (start, length) = (*start, *end - *start);
            let part = move |point| R::constant(point as f64 / (count - 1) as f64);
            (0..count).map(move |point| start + part(point) * length)
        };
        self.pieces.iter().flat_map(of_piece).collect()
    }

    /// The modes: at the start, and after each event.
    pub fn modes(&self) -> &[PlantMode<R>] {
        &self.segments
    }

    /// Calls `visit` with each step in order of time.
    pub(crate) fn each_piece(&self, mut visit: impl FnMut(PieceView<'_, R>)) {
        // Nothing fails.
        let _ = self.each_piece_with_event(|view, _| {
            visit(view);
            Ok(())
        });
    }

    /// Calls `visit` with each step in order of time, the event that ended it and the mode after that.
    pub(crate) fn each_piece_with_event(
        &self,
        mut visit: impl FnMut(PieceView<'_, R>, Option<(&PlantEvent<R>, &PlantMode<R>)>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let size = arc_size(self.plant.indices().states);
        for (index, Kept { start, step, end, segment, event }) in self.pieces.iter().enumerate() {
            let points = &self.points[index * size..(index + 1) * size];
            let view = PieceView { start: *start, step: *step, end: *end, points, mode: &self.segments[*segment] };
            let event = event.and_then(|event| self.events.get(event).zip(self.segments.get(segment + 1)));
            visit(view, event)?;
        }
        Ok(())
    }

    /// Calls `visit` with each event in order of time, and the modes before and after it.
    pub(crate) fn each_event(&self, mut visit: impl FnMut(&PlantEvent<R>, [&PlantMode<R>; 2])) {
        for Kept { segment, event, .. } in &self.pieces {
            let event = event.and_then(|event| self.events.get(event));
            if let (Some(event), [before, after, ..]) = (event, &self.segments[*segment..]) {
                visit(event, [before, after]);
            }
        }
    }

    /// How many pieces have begun by a time in s; `near` is a guess.
    pub(crate) fn begun(&self, near: usize, time: f64) -> usize {
        let has_begun = |index: usize| self.pieces.get(index).is_none_or(|piece| begins_by(piece.start, time));
        let near = near.min(self.pieces.len());
        // From one sample to the next there are few.
        for begun in near..(near + 4).min(self.pieces.len()) {
            if (begun == 0 || has_begun(begun - 1)) && !has_begun(begun) {
                return begun;
            }
        }
        self.pieces.partition_point(|piece| begins_by(piece.start, time))
    }

    /// Reads the states at a time in s by which so many pieces have begun; the time kept within the run, and the mode.
    pub(crate) fn read(
        &self,
        system: &System<R>,
        begun: usize,
        time: R,
        state: &mut [R],
        work: &mut Evaluation<R>,
    ) -> (R, &PlantMode<R>) {
        let (end, last, mode) = &self.last;
        let piece = self.pieces.get(begun.saturating_sub(1));
        let Some(piece) = piece.filter(|_| time.value() < end.value() * (1.0 - SIMULTANEOUS)) else {
            state.copy_from_slice(last);
            system.project(*end, state, mode, work);
            return (*end, mode);
        };
        let size = arc_size(state.len());
        let first = begun.saturating_sub(1) * size;
        let (start, step, points) = (piece.start, piece.step, &self.points[first..first + size]);
        let mode = &self.segments[piece.segment];
        let view = PieceView { start, step, end: piece.end, points, mode };
        let time = view.state(time, state);
        system.project(time, state, mode, work);
        (time, mode)
    }
}

impl<R: Instantiate> Plant<R> {
    /// What a kept run of this plant takes in bytes for each step, its events not counted.
    pub fn bytes_per_step(&self) -> usize {
        size_of::<Kept<R>>() + arc_size(self.indices().states) * size_of::<R>()
    }
}

/// Numbers of an arc of so many states.
fn arc_size(states: usize) -> usize {
    arc::POINTS * states
}

/// Whether a piece with a start in s has begun at a time. Two instants that differ by rounding are one.
fn begins_by<R: Instantiate>(start: R, time: f64) -> bool {
    start.value() <= time * (1.0 + SIMULTANEOUS)
}
