//! A row in a lane of a block: what the block knows of it beside the numbers in its vectors.

use super::Row;
use super::lane::Lane;
use super::wide::Number;
use crate::error::Error;
use crate::simulation::fixed_step::Walk;
use crate::simulation::timetable::Progress;
use crate::simulation::told::Told;
use crate::valve::{Demand, Openings, Ports};

/// What a block keeps of a row by itself. What every step asks for comes first and begins a line of the cache: of many
/// rows nothing else is looked at most of the time, and fetching it is what a step costs.
#[derive(Debug)]
#[repr(C, align(64))]
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
            ports: walk.ports,
            progress: walk.progress,
            lane,
        }
    }

    /// A row of the same form in the place of this one, with nothing asked of its valve, and its walk at a time in s.
    pub(super) fn anew(&self, row: &Row, time: f64) -> Result<(Self, Walk<R>), Error> {
        let (lane, walk) = self.lane.anew(row, time)?;
        Ok((Self::new(lane, &walk), walk))
    }

    /// How far the passages are open, after the instants that have been passed.
    pub(super) fn openings(&self) -> Openings<f64> {
        self.lane.openings(&self.progress)
    }

    /// Tells the valve what it is to do from `time` in s on.
    pub(super) fn tell(&mut self, time: f64, demand: Demand) -> Result<(), Error> {
        if !self.lives {
            return self.lane.fault.clone().map_or(Ok(()), Err);
        }
        if self.told.follow(time, &demand) {
            return Ok(());
        }
        self.told.tell(self.lane.valve_mut()?, &mut self.progress, time, demand)
    }

    /// Hears what the valve has been told between two times in s; whether its instants are others than before.
    pub(super) fn hear(&mut self, span: [f64; 2]) -> bool {
        self.told.hear(|| self.lane.actuation.as_mut(), &mut self.progress, span)
    }

    /// Finds the next instant up to `until` in s, and whether the passages are whole.
    pub(super) fn look_ahead(&mut self, until: f64) {
        self.under_way = !matches!(self.openings(), Openings::Whole);
        self.next = self.lane.next(&self.progress, until).unwrap_or(f64::INFINITY);
    }

    /// Stops.
    pub(super) fn stop(&mut self, fault: Error) {
        (self.lane.fault, self.lives) = (Some(fault), false);
        (self.next, self.goes) = (f64::INFINITY, false);
    }
}
