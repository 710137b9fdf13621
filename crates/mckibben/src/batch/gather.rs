//! Rows side by side: the numbers of several rigs, lane by lane, in one rig over lanes.
//!
//! Rigs whose laws are of the same kind hand out their numbers in the same order, so the numbers of each row are listed
//! once and then dealt to the lanes. What drives the valve stays with each row: its instants differ.

use crate::convert::Convert;
use crate::parameter::Parameter;
use crate::scalar::Vector;
use crate::simulation::Rig;
use alloc::vec::Vec;

/// A rig with all its numbers zero: two rigs of the same form are equal.
pub(super) fn form(rig: &Rig) -> Rig {
    rig.undriven(&mut Blank)
}

/// One rig over lanes from rows of the same form; the last row also fills the lanes that are left.
pub(super) fn gather<S: Vector<Lane = f64>>(rows: &[&Rig]) -> Rig<S> {
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
    fn deal<S: Vector<Lane = f64>>(&mut self) -> S {
        let number = self.next;
        self.next += 1;
        S::from_lanes(|lane| self.lists[lane.min(self.last)][number])
    }
}

impl<S: Vector<Lane = f64>> Convert<f64, S> for Deal<'_> {
    fn parameter(&mut self, _: &'static Parameter, _: f64) -> S {
        self.deal()
    }
    fn carry(&mut self) -> Option<impl FnMut(f64) -> S> {
        Some(|_| self.deal())
    }
}
