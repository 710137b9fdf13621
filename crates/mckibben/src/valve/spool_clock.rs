//! What a proportional spool does over time: the instants at which its motion becomes another known function.
//!
//! | instant | what follows |
//! |---|---|
//! | a commanded position takes effect | the closed form goes on from where the spool is, to the new position |
//! | an edge is passed | its flow path opens or shuts |
//! | a stop is met | the spool stands still there, and is drawn back where the command lies inside |
//! | nothing is left of the motion | the openings stay the same |
//!
//! Between turns the spool goes one way, so that each instant is the one root of the closed form between two of them. Until
//! the first command the spool rests in the middle.
//!
//! Checked by `tests/spool_rig.rs`.

use super::Command;
use super::opening::Openings;
use super::solenoid::{Ports, Solenoid, is_due};
use super::spool::{Spool, SpoolMotion};
#[cfg(feature = "alloc")]
use crate::numbered::Row;
use crate::root::bracketed;
use crate::scalar::Real;

/// Where a spool is and what comes next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpoolClock<S = f64> {
    /// How many commands have taken effect.
    taken: u64,
    motion: SpoolMotion<S>,
    /// Which edges the spool has uncovered; known from the start on.
    open: Option<[bool; 2]>,
    next: Option<(S, Ends)>,
}

/// What ends a piece of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ends {
    /// The edge of a flow path is passed.
    Edge(usize),
    /// A stop is met, on the side of +1 or −1.
    Stop(f64),
    /// Nothing is left of the motion.
    Rest,
}

impl<S: Real> SpoolClock<S> {
    /// Before t = 0: at rest in the middle.
    pub fn resting() -> Self {
        let nil = S::zero();
        let motion = SpoolMotion { time: nil, position: nil, velocity: nil, command: nil };
        Self { taken: 0, motion, open: None, next: None }
    }

    /// How many commands have taken effect.
    #[cfg(feature = "alloc")]
    pub(crate) fn passed(&mut self) -> &mut u64 {
        &mut self.taken
    }

    /// Which flow paths are open.
    pub fn ports(&self, spool: &Spool<S>) -> Ports {
        let [supply, exhaust] = self.open.unwrap_or_else(|| Self::uncovered(spool, self.motion.position));
        Ports { supply, exhaust }
    }

    fn uncovered(spool: &Spool<S>, position: S) -> [bool; 2] {
        spool.openings(position).map(|share| share.value() > 0.0)
    }

    /// How far the flow paths are open, until the next instant.
    pub fn openings(&self, spool: &Spool<S>) -> Openings<S> {
        let SpoolMotion { position, velocity, command, .. } = self.motion;
        if velocity.value() != 0.0 || position.value() != command.value() {
            return Openings::Spool { spool: *spool, motion: self.motion };
        }
        let (shares, Ports { supply, exhaust }) = (spool.openings(position), self.ports(spool));
        let whole = |open: bool, share: S| !open || share.value() == 1.0;
        if whole(supply, shares[0]) && whole(exhaust, shares[1]) { Openings::Whole } else { Openings::Shares(shares) }
    }

    /// The next instant in s, up to and with `until`, at which the openings become another function of time.
    pub fn next(&self, solenoid: &Solenoid<S>, command: &Command<S>, until: S) -> Option<S> {
        let commanded = command.position(self.taken).map(|(time, _)| time + solenoid.latency());
        let own = self.next.map(|(instant, _)| instant);
        let first = [commanded, own].into_iter().flatten().min_by(|a, b| a.value().total_cmp(&b.value()))?;
        is_due(first, until).then_some(first)
    }

    /// Passes everything up to and with `time`, in order; how many instants that were.
    pub fn advance(&mut self, time: S, spool: &Spool<S>, solenoid: &Solenoid<S>, command: &Command<S>) -> u64 {
        self.open.get_or_insert_with(|| Self::uncovered(spool, self.motion.position));
        let mut passed = 0;
        while let Some(instant) = self.next(solenoid, command, time) {
            passed += 1;
            match self.next.filter(|(own, _)| is_due(*own, instant)) {
                Some((own, ends)) => self.pass(own, ends, spool),
                None => {
                    if let Some((_, position)) = command.position(self.taken) {
                        self.taken += 1;
                        let [from, velocity] = self.at(spool, instant);
                        self.motion = SpoolMotion { time: instant, position: from, velocity, command: position };
                    }
                }
            }
            self.next = self.find(spool, instant);
        }
        passed
    }

    /// Position and velocity (1/s) at a time in s; exactly those at the start of the motion.
    fn at(&self, spool: &Spool<S>, time: S) -> [S; 2] {
        let SpoolMotion { time: begun, position, velocity, command } = self.motion;
        let rests = velocity.value() == 0.0 && position.value() == command.value();
        if rests || time.value() <= begun.value() { [position, velocity] } else { spool.at(&self.motion, time) }
    }

    fn pass(&mut self, time: S, ends: Ends, spool: &Spool<S>) {
        let command = self.motion.command;
        let standing = |position| SpoolMotion { time, position, velocity: S::zero(), command };
        match ends {
            Ends::Edge(side) => {
                if let Some(open) = &mut self.open {
                    open[side] = !open[side];
                }
            }
            Ends::Stop(side) => self.motion = standing(S::constant(side)),
            Ends::Rest => {
                self.motion = standing(command);
                // A command on an edge is reached without end: what has never shut has shut now.
                self.open = Some(Self::uncovered(spool, command));
            }
        }
    }

    /// What ends the motion after a time in s, and when.
    fn find(&self, spool: &Spool<S>, after: S) -> Option<(S, Ends)> {
        let motion = &self.motion;
        if motion.velocity.value() == 0.0 && motion.position.value() == motion.command.value() {
            return None;
        }
        let open = self.open?;
        let at = |time: f64| spool.at(motion, S::constant(time))[0].value();
        // By how much the position is beyond an edge or a stop that is passed next.
        let [supply, exhaust] = spool.edges().map(S::value);
        let beyond = |ends: Ends, position: f64| match ends {
            Ends::Edge(0) => (position - supply) * if open[0] { -1.0 } else { 1.0 },
            Ends::Edge(_) => (position - exhaust) * if open[1] { 1.0 } else { -1.0 },
            Ends::Stop(side) => side * position - 1.0,
            Ends::Rest => -1.0,
        };
        let mut from = after.value();
        for turn in spool.turns(motion).filter(|turn| *turn > after.value()) {
            let there = at(turn);
            let candidates = [Ends::Edge(0), Ends::Edge(1), Ends::Stop(1.0), Ends::Stop(-1.0)];
            let root = |ends: Ends| bracketed(from, turn, 1e-15 * turn, |time| beyond(ends, at(time)));
            let passed =
                candidates.into_iter().filter(|ends| beyond(*ends, there) > 0.0).map(|ends| (root(ends), ends));
            if let Some((time, ends)) = passed.min_by(|(a, _), (b, _)| a.total_cmp(b)) {
                return Some((self.polished(spool, time, ends), ends));
            }
            from = turn;
        }
        Some((S::constant(spool.rest(motion)), Ends::Rest))
    }

    /// The instant over the scalar: one step of Newton's carries the derivatives.
    fn polished(&self, spool: &Spool<S>, time: f64, ends: Ends) -> S {
        let time = S::constant(time);
        let place = match ends {
            Ends::Edge(side) => spool.edges()[side],
            Ends::Stop(side) => S::constant(side),
            Ends::Rest => return time,
        };
        let [position, velocity] = spool.at(&self.motion, time);
        let step = (position - place) / velocity;
        if step.value().abs() <= 1e-9 * time.value() { time - step } else { time }
    }
}

#[cfg(feature = "alloc")]
impl<S: Real> SpoolClock<S> {
    /// As numbers in a row.
    pub(crate) fn each_number(&mut self, row: &mut impl Row<S>) {
        let Self { taken, motion, open, next } = self;
        row.count(taken);
        let SpoolMotion { time, position, velocity, command } = motion;
        [time, position, velocity, command].into_iter().for_each(|number| row.number(number));
        row.option(open, [[false, false], [false, true], [true, false], [true, true]]);
        let (mut instant, mut ends) = next.map_or((None, Ends::Rest), |(instant, ends)| (Some(instant), ends));
        row.instant(&mut instant);
        row.choice(&mut ends, [Ends::Rest, Ends::Edge(0), Ends::Edge(1), Ends::Stop(1.0), Ends::Stop(-1.0)]);
        *next = instant.map(|instant| (instant, ends));
    }
}
