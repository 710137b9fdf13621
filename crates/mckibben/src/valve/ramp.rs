//! A poppet that takes its time: dead time, then a straight line from shut to open.
//!
//! ```text
//! coil energised at t  →  at t + t_open the poppet starts, and is open t_rise later:   λ̇ = +1/t_rise  while λ < 1
//! coil released  at t  →  at t + t_close it starts back, shut t_fall later:          λ̇ = −1/t_fall  while λ > 0
//!
//! ṁ = λ · ṁ(open)            of a three-way valve  λ to the supply, 1 − λ to the exhaust
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | λ | `opening`, effective area over that of the open flow path | – |
//! | t_open, t_close | delays of the [`Solenoid`](super::Solenoid) | s |
//! | t_rise, t_fall | `opening_time`, `closing_time` | s |
//!
//! A poppet that is sent back under way reverses where it is. The opening of a poppet is then a straight line between
//! instants that are known beforehand, as a prescribed motion by a table is, and no equation is to be solved for it.
//!
//! A pulse of `w ≥ t_open + t_rise` and a gap as long pass as much as one of `w − t_open + t_close − (t_rise − t_fall)/2`
//! would through a poppet without ramp, at a constant pressure. With both times zero the poppet jumps, as in the paper.
//!
//! Source: elementary; the area of a poppet grows with its lift until the lift is a quarter of the seat's diameter.
//! Checked by `tests/ramp.rs`: the line, its ends, turning under way, the area of a pulse; by `tests/ramped_rig.rs` in the
//! engines.

use crate::convert::Convert;
use crate::error::Error;
#[cfg(feature = "alloc")]
use crate::numbered::Row;
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};

/// How long the poppet is under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp<S = f64> {
    opening_time: S,
    closing_time: S,
}

/// The opening of a poppet as a function of time, until it is sent elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke<S = f64> {
    /// When the poppet starts, in s.
    pub start: S,
    /// When it arrives, in s; before all time of one that rests, as its start.
    pub end: S,
    /// Its opening then.
    pub from: S,
    /// Where it goes.
    pub to: S,
}

impl Ramp {
    /// A poppet that opens in `opening_time` s and shuts in `closing_time` s, each zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is negative or not finite.
    pub fn new(opening_time: f64, closing_time: f64) -> Result<Self, Error> {
        Ok(Self {
            opening_time: parameter::OPENING_TIME.check(opening_time)?,
            closing_time: parameter::CLOSING_TIME.check(closing_time)?,
        })
    }
}

impl<S: Scalar> Ramp<S> {
    /// A poppet that jumps.
    pub fn none() -> Self {
        Self { opening_time: S::zero(), closing_time: S::zero() }
    }

    /// Times in s from shut to open and back.
    pub fn times(&self) -> [S; 2] {
        [self.opening_time, self.closing_time]
    }

    /// Converts the ramp to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Ramp<T> {
        Ramp {
            opening_time: convert.parameter(&parameter::OPENING_TIME, self.opening_time),
            closing_time: convert.parameter(&parameter::CLOSING_TIME, self.closing_time),
        }
    }

    /// The stroke of a poppet that is sent at `time` (s) to open or to shut, from where `before` has it then.
    pub fn send(&self, before: &Stroke<S>, time: S, open: bool) -> Stroke<S> {
        let from = before.opening(time);
        let (to, share, whole) =
            if open { (S::one(), S::one() - from, self.opening_time) } else { (S::zero(), from, self.closing_time) };
        Stroke { start: time, end: time + share * whole, from, to }
    }
}

impl<S: Scalar> Stroke<S> {
    /// A poppet at rest, open or shut.
    pub fn resting(open: bool) -> Self {
        let at = if open { S::one() } else { S::zero() };
        Self { start: -S::one(), end: -S::one(), from: at, to: at }
    }

    /// The opening λ at a time in s, not before the stroke's start.
    #[inline(always)]
    pub fn opening<T: Over<S>>(&self, time: T) -> T {
        let (start, end) = (T::of(self.start), T::of(self.end));
        let share = (time - start) / (end - start);
        // On the line up to and with its end: a derivative there is that of the stroke, which lasts until its end has been passed.
        let is_over = end.lt(time) | !start.lt(end);
        T::select(is_over, T::of(self.to), T::of(self.from) + T::of(self.to - self.from) * share)
    }

    /// Slope of the opening in 1/s while the poppet is under way.
    pub fn slope(&self) -> S {
        S::select(self.start.lt(self.end), (self.to - self.from) / (self.end - self.start), S::zero())
    }
}

#[cfg(feature = "alloc")]
impl<S: Real> Stroke<S> {
    /// As numbers in a row.
    pub(super) fn each_number(&mut self, row: &mut impl Row<S>) {
        let Self { start, end, from, to } = self;
        [start, end, from, to].into_iter().for_each(|number| row.number(number));
    }
}

impl<S: Real> Ramp<S> {
    /// Whether the poppet jumps both ways.
    pub fn is_none(&self) -> bool {
        self.times().into_iter().all(|time| time.value() <= 0.0)
    }
}

impl<S: Real> Stroke<S> {
    /// When it ends in s, if it takes any time.
    pub(super) fn end(&self) -> Option<S> {
        self.arrival(self.start)
    }

    /// The instant in s at which the poppet arrives, if it is under way at `time`.
    pub fn arrival(&self, time: S) -> Option<S> {
        (time.value() < self.end.value()).then_some(self.end)
    }
}
