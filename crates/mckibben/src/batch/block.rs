//! A block: as many rows as a vector has lanes, with laws of the same form.
//!
//! The numbers of the rows lie lane by lane in one rig over lanes. While no lane has an instant, a turn or a fault before
//! it, a step costs one step of the kernel for all of them. A lane that has an instant goes to it first, alone in time
//! but not in work: every lane has its own step, zero for those that have arrived.

use super::gather::gather;
use super::width::Work;
use crate::error::Error;
use crate::load::{Line, Load};
use crate::scalar::{Mask, Scalar, Vector};
use crate::simulation::course::{Course, Instructions, Kernel};
use crate::simulation::fixed_step::outside;
use crate::simulation::kernel::Held;
use crate::simulation::rig::Actuation;
use crate::simulation::sample::Sample;
use crate::simulation::timetable::{Progress, Timetable};
use crate::simulation::{Method, Rig, State};
use crate::valve::{Ports, SIMULTANEOUS};
use alloc::vec::Vec;

/// How far beyond the time that is asked for instants are looked up, in spans of the same length.
const SPANS_AHEAD: f64 = 64.0;

/// Equal steps from one time in s to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) until: f64,
    pub(super) steps: u64,
}

/// Rows side by side.
#[derive(Debug)]
pub(super) struct Block<S: Vector> {
    rig: Rig<S>,
    method: Method,
    course: Course<S>,
    alive: S::Mask,
    /// The next instant of each lane; infinite when none is known.
    next: S::Time,
    /// Instants up to this time in s are known.
    known_until: f64,
    lanes: Vec<Lane>,
}

/// What a row keeps for itself.
#[derive(Debug)]
struct Lane {
    actuation: Option<Actuation>,
    load: Load,
    thread_length: f64,
    progress: Progress<f64>,
    ports: Ports,
    fault: Option<Error>,
}

impl Lane {
    fn timetable(&self) -> Timetable<'_, f64> {
        Timetable { actuation: self.actuation.as_ref(), load: &self.load }
    }
}

impl<S: Vector<Lane = f64>> Block<S> {
    /// At most as many rows of the same form as there are lanes, at t = 0.
    pub(super) fn new(rows: &[(&Rig, State)], method: Method) -> Self {
        let rigs: Vec<&Rig> = rows.iter().map(|(rig, _)| *rig).collect();
        let lane = |(rig, _): &(&Rig, State)| Lane {
            actuation: rig.actuation().cloned(),
            load: rig.load().clone(),
            thread_length: rig.actuator().law().law.braid.thread_length(),
            progress: Progress::none(),
            ports: Ports::CLOSED,
            fault: None,
        };
        let held = Held {
            supply: S::Mask::splat(false),
            exhaust: S::Mask::splat(false),
            sliding: S::zero(),
            stuck: S::Mask::splat(false),
            line: Line::resting(S::zero()),
        };
        // Lanes without a row hold no number, so that nothing ever happens in them.
        let start = |number: usize| {
            S::from_lanes(|lane| rows.get(lane).map_or(f64::NAN, |(_, state)| state.to_array()[number]))
        };
        let course = Course { time: S::Time::zero(), state: core::array::from_fn(start), held };
        let mut block = Self {
            rig: gather(&rigs),
            method,
            course,
            alive: S::mask(|lane| lane < rows.len()),
            next: S::Time::constant(f64::INFINITY),
            known_until: 0.0,
            lanes: rows.iter().map(lane).collect(),
        };
        block.pass(block.alive);
        block
    }

    /// Takes the lanes of `which` through what is due at their time.
    #[inline(always)]
    fn pass(&mut self, which: S::Mask) {
        let time = self.course.time;
        for (index, lane) in self.lanes.iter_mut().enumerate() {
            if S::holds(which, index) {
                let mut progress = lane.progress;
                lane.ports = lane.timetable().pass(&mut progress, time.lane(index));
                lane.progress = progress;
            }
        }
        let lanes = &self.lanes;
        let lines = |number: fn(Line) -> f64| {
            S::from_lanes(|index| lanes.get(index).map_or(0.0, |lane| number(lane.timetable().line(&lane.progress))))
        };
        let held = &mut self.course.held;
        held.line =
            Line { time: lines(|line| line.time), length: lines(|line| line.length), slope: lines(|line| line.slope) };
        held.supply = S::mask(|index| lanes.get(index).is_some_and(|lane| lane.ports.supply));
        held.exhaust = S::mask(|index| lanes.get(index).is_some_and(|lane| lane.ports.exhaust));
        self.course.slide(&self.rig, which);
        self.look_ahead(which);
    }

    /// Finds the next instant of the lanes of `which` as far as instants are known.
    #[inline(always)]
    fn look_ahead(&mut self, which: S::Mask) {
        let (lanes, next, until) = (&self.lanes, self.next, self.known_until);
        let found = |index: usize| match lanes.get(index) {
            Some(lane) if S::holds(which, index) => {
                lane.timetable().next(&lane.progress, until).unwrap_or(f64::INFINITY)
            }
            _ => next.lane(index),
        };
        self.next = S::Time::from_lanes(found);
    }

    /// Gives the lanes of `failed` their fault; they hold no number from here on.
    #[inline(always)]
    fn fail(&mut self, failed: S::Mask) {
        for (index, lane) in self.lanes.iter_mut().enumerate() {
            if S::holds(failed, index) {
                let state = self.course.state.map(|number| number.lane(index));
                lane.fault = Some(outside(lane.thread_length, self.course.time.lane(index), state));
            }
        }
        self.alive = self.alive & !failed;
        self.next = S::Time::select(failed, S::Time::constant(f64::INFINITY), self.next);
        for number in &mut self.course.state {
            *number = S::select(failed, S::constant(f64::NAN), *number);
        }
    }

    #[inline(always)]
    fn advance(&mut self, instructions: impl Instructions, span: Span) {
        if self.known_until < span.until {
            self.known_until = span.until + SPANS_AHEAD * (span.until - span.from);
            instructions.run(LookAhead(self));
        }
        let tolerance = S::Time::constant(1.0 + SIMULTANEOUS);
        for part in 1..=span.steps {
            let to = S::Time::constant(span.end_of(part));
            loop {
                let due = self.next.le(to * tolerance);
                let stops = due.any();
                let end = if stops { S::Time::select(due, self.next, to) } else { to };
                self.course.advance(instructions, &self.rig, self.method, end);
                let failed = self.alive & !self.rig.admissible(&self.course.state);
                if failed.any() {
                    instructions.run(Fail(self, failed));
                }
                if !stops {
                    break;
                }
                instructions.run(Pass(self, due & self.alive));
            }
        }
    }

    /// What each row shows now, or why it has stopped.
    #[inline(always)]
    fn samples(&self) -> Vec<Result<Sample, Error>> {
        let Course { time, state, held } = &self.course;
        let observed = self.rig.observe(state, held);
        let sample = |(index, lane): (usize, &Lane)| match &lane.fault {
            Some(fault) => Err(fault.clone()),
            None => Ok(Sample::of_lane(time.lane(index), state, &observed, index, lane.ports)),
        };
        self.lanes.iter().enumerate().map(sample).collect()
    }
}

impl Span {
    fn end_of(&self, step: u64) -> f64 {
        if step == self.steps {
            self.until
        } else {
            self.from + (self.until - self.from) * (step as f64 / self.steps as f64)
        }
    }
}

struct Pass<'a, S: Vector>(&'a mut Block<S>, S::Mask);

impl<S: Vector<Lane = f64>> Kernel for Pass<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.0.pass(self.1);
    }
}

struct Fail<'a, S: Vector>(&'a mut Block<S>, S::Mask);

impl<S: Vector<Lane = f64>> Kernel for Fail<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.0.fail(self.1);
    }
}

struct LookAhead<'a, S: Vector>(&'a mut Block<S>);

impl<S: Vector<Lane = f64>> Kernel for LookAhead<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.0.look_ahead(self.0.alive);
    }
}

/// A block's way through a span.
pub(super) struct Advance<'a, S: Vector>(pub(super) &'a mut Block<S>, pub(super) Span);

impl<S: Vector<Lane = f64>> Work for Advance<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run(self, instructions: impl Instructions) {
        self.0.advance(instructions, self.1);
    }
}

/// A block's samples.
pub(super) struct Samples<'a, S: Vector>(pub(super) &'a Block<S>);

impl<S: Vector<Lane = f64>> Work for Samples<'_, S> {
    type Output = Vec<Result<Sample, Error>>;
    #[inline(always)]
    fn run(self, _instructions: impl Instructions) -> Self::Output {
        self.0.samples()
    }
}
