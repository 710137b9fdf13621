//! The pieces of a run, kept: the state at any time, and integrals over all of it. For any hybrid system.

use super::integrator::{Counts, Integrator, Piece, PieceOf};
use super::system::HybridSystem;
use crate::error::Error;
use crate::scalar::Real;
use crate::valve::SIMULTANEOUS;
use alloc::vec::Vec;

/// Steps that a stored run may have: about two gigabytes.
const MAX_PIECES: usize = 4_000_000;
/// Pieces between two calls of a watcher: a fraction of a millisecond.
const WATCHED: usize = 256;

/// A run of a system of `N` states with modes `M` and events of kind `K`.
#[derive(Clone, Debug)]
pub(super) struct Stored<R: Real, M, K, const N: usize> {
    pieces: Vec<Piece<R, M, K, N>>,
    last: (R, [R; N], M),
    counts: Counts,
}

impl<R: Real, M: Copy, K, const N: usize> Stored<R, M, K, N> {
    /// Nothing yet, at t = 0 in a state and mode.
    pub(super) fn begin(state: [R; N], mode: M) -> Self {
        Self { pieces: Vec::new(), last: (R::zero(), state, mode), counts: Counts::default() }
    }

    /// Goes on to `until` s with `relative_tolerance` for each step; `see` sees every piece, `watch` the time in s that has
    /// been reached, now and then; what it fails by ends the run.
    pub(super) fn extend<S: HybridSystem<R, N, Mode = M, Kind = K>>(
        &mut self,
        system: &S,
        until: R,
        relative_tolerance: f64,
        see: &mut dyn FnMut(&PieceOf<R, S, N>),
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let (time, state, mode) = self.last;
        let mut integrator = Integrator::new(system, time, state, mode, until, relative_tolerance);
        while let Some(piece) = integrator.advance()? {
            see(&piece);
            self.pieces.push(piece);
            if self.pieces.len().is_multiple_of(WATCHED) {
                watch(integrator.time().value())?;
            }
            if self.pieces.len() > MAX_PIECES {
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
        self.last = (integrator.time(), *integrator.state(), *integrator.mode());
        self.counts = self.counts.and(integrator.counts());
        Ok(())
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

    /// End of the run in s.
    pub(super) fn duration(&self) -> R {
        self.last.0
    }

    /// How many pieces have begun by a time in s, those of index `from` on.
    pub(super) fn begun_after(&self, from: usize, time: f64) -> usize {
        from + self.pieces[from..].iter().take_while(|piece| begins_by(piece, time)).count()
    }

    /// How many pieces have begun by a time in s.
    pub(super) fn begun(&self, time: f64) -> usize {
        self.pieces.partition_point(|piece| begins_by(piece, time))
    }

    /// The states and the mode at a time by which so many pieces have begun; the time itself, or the end of the run.
    pub(super) fn at<S>(&self, system: &S, begun: usize, time: R) -> (R, [R; N], M)
    where
        S: HybridSystem<R, N, Mode = M>,
    {
        let (end, ..) = &self.last;
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

    /// Calls `visit` with weight (s), time (s), states and mode at the Gauss points of each step.
    pub(super) fn quadrature<S>(&self, system: &S, mut visit: impl FnMut(R, R, &[R; N], &M))
    where
        S: HybridSystem<R, N, Mode = M>,
    {
        for piece in &self.pieces {
            let length = piece.end - piece.arc.start;
            if length.value() <= 0.0 {
                continue;
            }
            for (node, weight) in GAUSS {
                let time = piece.arc.start + length * R::constant(node);
                let mut state = piece.arc.at(piece.arc.theta(time));
                system.project(time, &mut state, &piece.mode);
                visit(length * R::constant(weight), time, &state, &piece.mode);
            }
        }
    }
}

/// Whether a piece has begun at a time. Two instants that differ by rounding are one.
fn begins_by<R: Real, M, K, const N: usize>(piece: &Piece<R, M, K, N>, time: f64) -> bool {
    piece.arc.start.value() <= time * (1.0 + SIMULTANEOUS)
}

/// Nodes and weights of Gauss–Legendre quadrature with five points on `[0, 1]`, exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];
