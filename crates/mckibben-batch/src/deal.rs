//! Numbers of several systems of equal structure, dealt to lanes.
//!
//! Systems whose parts are of the same kind hand out their numbers in the same order, so that the numbers of each are listed once
//! and then dealt to the lanes.

use crate::wide::Wide;
use mckibben::internals::Convert;
use mckibben::parameter::Parameter;

/// All numbers zero.
pub(crate) struct Blank;

impl Convert<f64, f64> for Blank {
    fn parameter(&mut self, _: &'static Parameter, _: f64) -> f64 {
        0.0
    }
    fn carry(&mut self) -> Option<impl FnMut(f64) -> f64> {
        Some(|_| 0.0)
    }
}

/// The numbers one after the other.
pub(crate) struct List(pub(crate) Vec<f64>);

impl Convert<f64, f64> for List {
    fn parameter(&mut self, _: &'static Parameter, value: f64) -> f64 {
        self.0.push(value);
        value
    }
    fn carry(&mut self) -> Option<impl FnMut(f64) -> f64> {
        Some(|value| {
            self.0.push(value);
            value
        })
    }
}

/// The numbers of several, lane by lane.
pub(crate) struct Deal<'a> {
    lists: &'a [Vec<f64>],
    last: usize,
    next: usize,
}

impl<'a> Deal<'a> {
    /// From lists of equal length, the last of which also fills the lanes that are left.
    pub(crate) fn new(lists: &'a [Vec<f64>]) -> Self {
        Self { lists, last: lists.len() - 1, next: 0 }
    }

    fn deal<W: Wide>(&mut self) -> W {
        let number = self.next;
        self.next += 1;
        W::from_lanes(|lane| self.lists[lane.min(self.last)][number])
    }
}

impl<W: Wide> Convert<f64, W> for Deal<'_> {
    fn parameter(&mut self, _: &'static Parameter, _: f64) -> W {
        self.deal()
    }
    fn carry(&mut self) -> Option<impl FnMut(f64) -> W> {
        Some(|_| self.deal())
    }
}
