//! The accepted steps of a run, one after another: handed on as they are made, and kept. For any hybrid system.
//!
//! A [`Front`] is a run under way: it holds the states that have been reached and one accepted step, no more. Each step is
//! handed on once the next one has begun, for only then is it known which of the two a sample belongs to. A [`Stored`] run
//! keeps every step that it is handed.

use super::integrator::{Counts, Integrator, Piece};
use super::system::HybridSystem;
use crate::error::Error;
use crate::scalar::Real;
use crate::valve::SIMULTANEOUS;
use alloc::vec::Vec;

/// Steps that a stored run may have: about two gigabytes.
const MAX_PIECES: usize = 4_000_000;
/// Steps between two calls of a watcher of a run that is kept: a fraction of a millisecond.
pub const STEPS_WATCHED: usize = 256;

/// The front of a run of a system of `N` states with modes `M` and events of kind `K`.
#[derive(Clone, Debug)]
pub(super) struct Front<R: Real, M, K, const N: usize> {
    /// Time in s, states and mode that have been reached.
    last: (R, [R; N], M),
    counts: Counts,
    /// The last step, until the next one begins.
    waiting: Option<Piece<R, M, K, N>>,
}

/// An accepted step, and when the next one begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'a, R, M, K, const N: usize> {
    pub(super) piece: &'a Piece<R, M, K, N>,
    /// Start of the next step in s; none of the last.
    next: Option<f64>,
}

/// Takes each step of a run in order of time; its error ends the run.
pub(super) type Take<'t, R, M, K, const N: usize> = &'t mut dyn FnMut(&View<'_, R, M, K, N>) -> Result<(), Error>;

impl<R: Real, M: Copy, K: Copy, const N: usize> Front<R, M, K, N> {
    /// At t = 0 in a state and mode.
    pub(super) fn begin(state: [R; N], mode: M) -> Self {
        Self { last: (R::zero(), state, mode), counts: Counts::default(), waiting: None }
    }

    /// Goes on to `until` s with `relative_tolerance` for each step; `take` takes every step.
    pub(super) fn extend<S: HybridSystem<R, N, Mode = M, Kind = K>>(
        &mut self,
        system: &S,
        until: R,
        relative_tolerance: f64,
        take: Take<'_, R, M, K, N>,
    ) -> Result<(), Error> {
        let (time, state, mode) = self.last;
        let mut integrator = Integrator::new(system, time, state, mode, until, relative_tolerance);
        while let Some(piece) = integrator.advance()? {
            let next = Some(piece.arc.start.value());
            if let Some(before) = self.waiting.replace(piece) {
                take(&View { piece: &before, next })?;
            }
        }
        self.last = (integrator.time(), *integrator.state(), *integrator.mode());
        self.counts = self.counts.and(integrator.counts());
        Ok(())
    }

    /// Hands on the last step: none follows.
    pub(super) fn finish(&mut self, take: Take<'_, R, M, K, N>) -> Result<(), Error> {
        self.waiting.take().map_or(Ok(()), |piece| take(&View { piece: &piece, next: None }))
    }

    /// Goes on from another state and mode.
    pub(super) fn resume(&mut self, state: [R; N], mode: M) {
        (self.last.1, self.last.2) = (state, mode);
    }

    /// Time in s, states and mode that have been reached.
    pub(super) fn reached(&self) -> &(R, [R; N], M) {
        &self.last
    }

    pub(super) fn counts(&self) -> Counts {
        self.counts
    }
}

impl<R: Real, M: Copy, K, const N: usize> View<'_, R, M, K, N> {
    /// Whether the next step begins after a time in s. Of the steps that have begun by a time the last one holds it.
    pub(super) fn holds(&self, time: f64) -> bool {
        self.next.is_none_or(|next| !begins_by(next, time))
    }

    /// The states at a time in s, kept within the step.
    pub(super) fn at<S: HybridSystem<R, N, Mode = M>>(&self, system: &S, time: R) -> [R; N] {
        let piece = self.piece;
        let at = R::constant(time.value().clamp(piece.arc.start.value(), piece.end.value()));
        let mut state = piece.arc.at(piece.arc.theta(at));
        system.project(at, &mut state, &piece.mode);
        state
    }

    /// Calls `visit` with weight (s), time (s), states and mode at the Gauss points of the step.
    pub(super) fn quadrature<S>(&self, system: &S, mut visit: impl FnMut(R, R, &[R; N], &M))
    where
        S: HybridSystem<R, N, Mode = M>,
    {
        let piece = self.piece;
        let length = piece.end - piece.arc.start;
        if length.value() <= 0.0 {
            return;
        }
        for (node, weight) in GAUSS {
            let time = piece.arc.start + length * R::constant(node);
            let mut state = piece.arc.at(piece.arc.theta(time));
            system.project(time, &mut state, &piece.mode);
            visit(length * R::constant(weight), time, &state, &piece.mode);
        }
    }
}

/// A run of a system of `N` states with modes `M` and events of kind `K`, kept.
#[derive(Clone, Debug)]
pub(super) struct Stored<R: Real, M, K, const N: usize> {
    pieces: Vec<Piece<R, M, K, N>>,
    last: (R, [R; N], M),
    counts: Counts,
}

impl<R: Real, M: Copy, K: Copy, const N: usize> Stored<R, M, K, N> {
    /// The steps that were kept of a run that has come to its end.
    pub(super) fn of(pieces: Vec<Piece<R, M, K, N>>, front: &Front<R, M, K, N>) -> Self {
        Self { pieces, last: front.last, counts: front.counts }
    }

    pub(super) fn counts(&self) -> Counts {
        self.counts
    }

    /// Time in s, states and mode at the end.
    pub(super) fn reached(&self) -> &(R, [R; N], M) {
        &self.last
    }

    /// The steps in order of time.
    pub(super) fn views(&self) -> impl Iterator<Item = View<'_, R, M, K, N>> {
        (0..self.pieces.len()).map(|index| self.view(index))
    }

    fn view(&self, index: usize) -> View<'_, R, M, K, N> {
        View { piece: &self.pieces[index], next: self.pieces.get(index + 1).map(|next| next.arc.start.value()) }
    }

    /// End of the run in s.
    pub(super) fn duration(&self) -> R {
        self.last.0
    }

    /// How many pieces have begun by a time in s, those of index `from` on.
    pub(super) fn begun_after(&self, from: usize, time: f64) -> usize {
        from + self.pieces[from..].iter().take_while(|piece| begins_by(piece.arc.start.value(), time)).count()
    }

    /// How many pieces have begun by a time in s.
    pub(super) fn begun(&self, time: f64) -> usize {
        self.pieces.partition_point(|piece| begins_by(piece.arc.start.value(), time))
    }

    /// The states and the mode at a time by which so many pieces have begun; the time itself, or the end of the run.
    pub(super) fn at<S>(&self, system: &S, begun: usize, time: R) -> (R, [R; N], M)
    where
        S: HybridSystem<R, N, Mode = M>,
    {
        let (end, ..) = &self.last;
        if is_end(time.value(), end.value()) {
            return self.last;
        }
        let index = begun.saturating_sub(1);
        match self.pieces.get(index) {
            Some(piece) => (time, self.view(index).at(system, time), piece.mode),
            None => self.last,
        }
    }

    /// The least and the greatest value of each state, at five points of each step.
    pub(super) fn ranges(&self) -> [(f64, f64); N] {
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
}

/// What one takes that keeps every step of a run: how often a watcher is called, and that there is an end to it.
///
/// `kept` counts the steps with this one, which ends at `time` s.
pub(super) fn keep_watch(kept: usize, time: f64, watch: &mut dyn FnMut(f64) -> Result<(), Error>) -> Result<(), Error> {
    if kept.is_multiple_of(STEPS_WATCHED) {
        watch(time)?;
    }
    if kept > MAX_PIECES {
        return Err(Error::Stopped {
            time,
            reason: "the run takes more steps than a stored trajectory may have",
            quantity: "steps",
            value: MAX_PIECES as f64,
            unit: "",
            remedy: "shorten run.duration, loosen run.relative_tolerance, use the fixed-step engine, or write the samples \
                     alone: a run of which no figure and no events are wanted keeps nothing",
        });
    }
    Ok(())
}

/// Whether a step that starts at `start` s has begun at a time. Two instants that differ by rounding are one.
fn begins_by(start: f64, time: f64) -> bool {
    start <= time * (1.0 + SIMULTANEOUS)
}

/// Whether a time in s is the end of a run, up to rounding.
pub(super) fn is_end(time: f64, end: f64) -> bool {
    time >= end * (1.0 - SIMULTANEOUS)
}

/// Nodes and weights of Gauss–Legendre quadrature with five points on `[0, 1]`, exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];
