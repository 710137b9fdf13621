//! A row in a lane of a block: what the block knows of it beside the numbers in its vectors.

use super::Row;
use super::lane::Lane;
use crate::error::Error;
use crate::lanes::wide::Number;
use crate::simulation::fixed_step::Walk;
use crate::simulation::timetable::Progress;
use crate::simulation::told::Told;
use crate::valve::{Demand, Openings, Ports};
use alloc::boxed::Box;

/// What a block keeps of a row by itself. What every step asks for is in two lines of the cache, and those of all rows of a
/// block lie one after the other: of many rows nothing else is looked at most of the time, and fetching it is what a step
/// costs.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct Member<R> {
    /// Whether it has not stopped.
    pub(super) lives: bool,
    /// Whether a passage is not whole, after the instants that have been passed.
    pub(super) under_way: bool,
    /// Within a step that has instants in it: whether the row has not come to its end, the time in s that it has come to, and
    /// where it goes next.
    pub(super) goes: bool,
    pub(super) time: f64,
    pub(super) goal: f64,
    /// The next instant in s; infinite when none is known.
    pub(super) next: f64,
    told: Told<f64>,
    pub(super) kept: Box<Kept<R>>,
}

const _: () = assert!(size_of::<Member<f64>>() == 128, "a member is in two lines of the cache");

/// What is looked at only where something happens to a row.
#[derive(Debug)]
pub(super) struct Kept<R> {
    pub(super) ports: Ports,
    pub(super) progress: Progress<f64>,
    pub(super) lane: Lane<R>,
}

impl<R: Number> Member<R> {
    /// A row whose walk begins, before what is due then has been passed.
    pub(super) fn new(lane: Lane<R>, walk: &Walk<R>) -> Self {
        let time = walk.course.time;
        Self {
            lives: lane.fault.is_none(),
            under_way: false,
            goes: false,
            time,
            goal: time,
            next: f64::INFINITY,
            told: Told::nothing(),
            kept: Box::new(Kept { ports: walk.ports, progress: walk.progress, lane }),
        }
    }

    /// A row of the same form in the place of this one, with nothing asked of its valve, and its walk at a time in s.
    pub(super) fn anew(&self, row: &Row, time: f64) -> Result<(Self, Walk<R>), Error> {
        let (lane, walk) = self.kept.lane.anew(row, time)?;
        Ok((Self::new(lane, &walk), walk))
    }

    /// How far the passages are open, after the instants that have been passed.
    pub(super) fn openings(&self) -> Openings<f64> {
        self.kept.lane.openings(&self.kept.progress)
    }

    /// Tells the valve what it is to do from `time` in s on.
    #[inline]
    pub(super) fn tell(&mut self, time: f64, demand: Demand) -> Result<(), Error> {
        if !self.lives {
            return self.kept.lane.fault.clone().map_or(Ok(()), Err);
        }
        let Kept { lane, progress, .. } = &mut *self.kept;
        self.told.tell(|| Ok((lane.valve_mut()?, progress)), time, demand)
    }

    /// Hears what the valve has been told between two times in s; whether its instants are others than before.
    #[inline]
    pub(super) fn hear(&mut self, span: [f64; 2]) -> bool {
        let Kept { lane, progress, .. } = &mut *self.kept;
        self.told.hear(|| (lane.actuation.as_mut(), progress), span)
    }

    /// Finds the next instant up to `until` in s, and whether the passages are whole.
    pub(super) fn look_ahead(&mut self, until: f64) {
        self.under_way = !matches!(self.openings(), Openings::Whole);
        self.next = self.kept.lane.next(&self.kept.progress, until).unwrap_or(f64::INFINITY);
    }

    /// Stops.
    pub(super) fn stop(&mut self, fault: Error) {
        (self.kept.lane.fault, self.lives) = (Some(fault), false);
        (self.next, self.goes) = (f64::INFINITY, false);
    }
}
