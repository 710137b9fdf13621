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
pub(super) fn form<R: Number>(rig: &Rig<R>) -> Rig<R> {
    rig.undriven(&mut Blank)
}

/// Whether two rigs are the same to the bit, whatever drives their valves.
pub(super) fn are_same<R: Number>(one: &Rig<R>, other: &Rig<R>) -> bool {
    let bits = |rig| numbers(rig).into_iter().map(f64::to_bits);
    form(one) == form(other) && bits(one).eq(bits(other))
}

/// The numbers of a rig, in an order that depends on its form alone.
fn numbers<R: Number>(rig: &Rig<R>) -> Vec<f64> {
    let mut list = List(Vec::new());
    rig.undriven(&mut list);
    list.0
}

/// One rig over lanes from rows of the same form; the last row also fills the lanes that are left.
pub(super) fn gather<R: Number, W: Wide>(rows: &[&Rig<R>]) -> Rig<W> {
    let lists: Vec<Vec<f64>> = rows.iter().map(|rig| numbers(rig)).collect();
    rows[0].undriven(&mut Deal::new(&lists))
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

/// All numbers zero.
pub(crate) struct Blank;

impl<R: Number> Convert<R, R> for Blank {
    fn parameter(&mut self, _: &'static Parameter, _: R) -> R {
        R::zero()
    }
    fn carry(&mut self) -> Option<impl FnMut(R) -> R> {
        Some(|_| R::zero())
    }
}

/// The numbers one after the other.
pub(crate) struct List(pub(crate) Vec<f64>);

impl<R: Number> Convert<R, f64> for List {
    fn parameter(&mut self, _: &'static Parameter, value: R) -> f64 {
        self.0.push(value.value());
        value.value()
    }
    fn carry(&mut self) -> Option<impl FnMut(R) -> f64> {
        Some(|value: R| {
            self.0.push(value.value());
            value.value()
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
        W::from_lanes(|lane| W::Lane::constant(self.lists[lane.min(self.last)][number]))
    }
}

impl<R: Number, W: Wide> Convert<R, W> for Deal<'_> {
    fn parameter(&mut self, _: &'static Parameter, _: R) -> W {
        self.deal()
    }
    fn carry(&mut self) -> Option<impl FnMut(R) -> W> {
        Some(|_| self.deal())
    }
}
