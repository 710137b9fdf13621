//! Rows side by side: the numbers of several rigs, lane by lane, in one rig over lanes.
//!
//! Rigs whose laws are of the same kind hand out their numbers in the same order, so the numbers of each row are listed
//! once and then dealt to the lanes. What drives the valve stays with each row: its instants differ.

use crate::convert::Convert;
use crate::lanes::deal::{Blank, Deal, List};
use crate::lanes::wide::{Number, Wide};
use crate::parameter::Parameter;
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
