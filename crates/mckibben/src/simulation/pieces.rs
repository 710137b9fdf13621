//! The pieces of a tabulated effectiveness and of a force map as components of the mode: which one holds, and when the state
//! leaves it.

use super::member::Member;
use super::mode::{Guard, Mode};
use crate::force::Piece;
use crate::scalar::Real;

impl<R: Real> Member<R> {
    /// The piece of the effectiveness at an absolute pressure.
    pub(crate) fn effectiveness_piece(&self, pressure: R) -> usize {
        let actuator = &self.actuator;
        let gauge = actuator.gauge(pressure).0.value();
        piece_of(gauge, |piece| actuator.law().effectiveness.piece_bounds(piece).1)
    }

    /// The piece of a force map at a length and an absolute pressure.
    pub(crate) fn force_piece(&self, length: R, pressure: R) -> Piece {
        let (law, gauge) = (&self.actuator.law().law, self.actuator.gauge(pressure));
        Piece {
            length: piece_of(length.value(), |piece| law.length_bounds(piece).1),
            pressure: piece_of(gauge.0.value(), |piece| law.pressure_bounds(piece).1),
        }
    }

    /// The absolute pressure in Pa that ends a mode by a guard, passed by the band, and whether the mode lasts above it;
    /// `None` where there is no such end.
    pub(crate) fn pressure_limit(&self, guard: Guard, mode: &Mode) -> Option<(R, bool)> {
        let law = self.actuator.law();
        let piece = |up| self.passed(self.absolute(law.effectiveness.piece_bounds(mode.effectiveness_piece)), up);
        let of_map = |up| self.passed(self.absolute(law.law.pressure_bounds(mode.force_piece.pressure)), up);
        let press = |up| {
            let atmosphere = Some(self.actuator.air().atmosphere().0);
            let ends = self.actuator.friction().follows_normal_load() && mode.pressed != up;
            ends.then(|| self.passed((atmosphere, atmosphere), up)).flatten()
        };
        let (bound, lasts_above) = match guard {
            Guard::PieceDown => (piece(false), true),
            Guard::PieceUp => (piece(true), false),
            Guard::MapDown => (of_map(false), true),
            Guard::MapUp => (of_map(true), false),
            Guard::PressDown => (press(false), true),
            Guard::PressUp => (press(true), false),
            _ => return None,
        };
        bound.map(|bound| (bound, lasts_above))
    }

    /// The length in m that ends a piece of a force map by a guard, passed by the band, and whether the piece lasts above it;
    /// `None` where there is no such end.
    pub(crate) fn map_length_limit(&self, guard: Guard, mode: &Mode) -> Option<(R, bool)> {
        let up = match guard {
            Guard::MapShorter => false,
            Guard::MapLonger => true,
            _ => return None,
        };
        let bounds = self.actuator.law().law.length_bounds(mode.force_piece.length);
        self.passed(bounds, up).map(|bound| (bound, !up))
    }

    /// One of two bounds, passed by the band.
    fn passed(&self, (low, high): (Option<R>, Option<R>), up: bool) -> Option<R> {
        let factor = if up { 1.0 + self.band } else { 1.0 - self.band };
        let bound = if up { high } else { low };
        bound.map(|bound| bound * R::constant(factor))
    }

    /// Absolute pressures in Pa from gauge pressures.
    fn absolute(&self, (low, high): (Option<R>, Option<R>)) -> (Option<R>, Option<R>) {
        let absolute = |gauge: R| gauge + self.actuator.air().atmosphere().0;
        (low.map(absolute), high.map(absolute))
    }

    /// Whether the gas presses the threads together at an absolute pressure, as far as that matters.
    pub(crate) fn pressed(&self, pressure: R) -> bool {
        !self.actuator.friction().follows_normal_load()
            || pressure.value() >= self.actuator.air().atmosphere().0.value()
    }
}

/// The first piece that a number lies in, by the upper ends of the pieces.
fn piece_of<R: Real>(number: f64, end: impl Fn(usize) -> Option<R>) -> usize {
    (0..).find(|&piece| end(piece).is_none_or(|end| number <= end.value())).unwrap_or(0)
}
