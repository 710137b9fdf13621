//! Rows side by side: the numbers of several rigs, lane by lane, in one rig over lanes.
//!
//! Rigs whose laws are of the same kind hand out their numbers in the same order, so the numbers of each row are listed
//! once and then dealt to the lanes. What drives the valve stays with each row: its instants differ.

use super::wide::{Number, Wide};
use crate::convert::Convert;
use crate::parameter::Parameter;
use crate::scalar::Scalar;
use crate::simulation::Rig;
use alloc::vec::Vec;

/// A rig with all its numbers zero: two rigs of the same form are equal.
pub(super) fn form(rig: &Rig) -> Rig {
    rig.undriven(&mut Blank)
}

/// One rig over lanes from rows of the same form; the last row also fills the lanes that are left.
pub(super) fn gather<W: Wide>(rows: &[&Rig]) -> Rig<W> {
    let lists: Vec<Vec<f64>> = rows
        .iter()
        .map(|rig| {
            let mut list = List(Vec::new());
            rig.undriven(&mut list);
            list.0
        })
        .collect();
    let last = lists.len() - 1;
    rows[0].undriven(&mut Deal { lists: &lists, last, next: 0 })
}

/// A rig in the numbers of a lane.
pub(super) fn narrow<R: Number>(rig: &Rig) -> Rig<R> {
    rig.undriven(&mut Narrow)
}

struct Narrow;

impl<R: Number> Convert<f64, R> for Narrow {
    fn parameter(&mut self, _: &'static Parameter, value: f64) -> R {
        R::constant(value)
    }
    fn carry(&mut self) -> Option<impl FnMut(f64) -> R> {
        Some(R::constant)
    }
}

struct Blank;

impl Convert<f64, f64> for Blank {
    fn parameter(&mut self, _: &'static Parameter, _: f64) -> f64 {
        0.0
    }
    fn carry(&mut self) -> Option<impl FnMut(f64) -> f64> {
        Some(|_| 0.0)
    }
}

struct List(Vec<f64>);

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

struct Deal<'a> {
    lists: &'a [Vec<f64>],
    last: usize,
    next: usize,
}

impl Deal<'_> {
    fn deal<W: Wide>(&mut self) -> W {
        let number = self.next;
        self.next += 1;
        W::from_lanes(|lane| W::Lane::constant(self.lists[lane.min(self.last)][number]))
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
