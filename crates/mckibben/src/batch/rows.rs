//! Rows side by side in a block: how they go through time together.
//!
//! The numbers of the rows lie lane by lane in one rig over lanes. A step of all rows is one step of the method. Where instants
//! come within it, valves' or controllers', each row goes to its own next instant in one step of the method, each lane with a
//! length of its own, passes it by itself, and so on until all have come to the end.
//!
//! A row to which something else happens within a step (a turn, the end of the physics) takes that step again by itself as the
//! fixed-step engine does, from where it was. So do rows whose passages are under way or lead to a regulated pressure, and the
//! last few that have not come to the end. So every row goes the fixed-step engine's way, bit for bit.

use super::Row;
use super::lane::Lane;
use super::member::{Kept, Member};
use super::span::Span;
use crate::error::Error;
use crate::force::Statics;
use crate::friction::{Hysteresis, Memory};
use crate::lanes::wide::Wide;
use crate::load::Line;
use crate::scalar::{Mask, Real, Scalar};
use crate::simulation::closed_loop::Control;
use crate::simulation::course::Course;
use crate::simulation::fixed_step::{Walk, compressor_starts, stepped};
use crate::simulation::kernel::Held;
use crate::simulation::piped::{PIPED, PLAIN, Stepped as States, of_rig, volume};
use crate::simulation::sample::Sample;
use crate::simulation::{Method, Rig, State};
use crate::valve::is_due;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use pulp::{Simd, WithSimd};

/// How far beyond the time that is asked for instants are looked up, in spans of the same length.
const SPANS_AHEAD: f64 = 64.0;

/// Rows that have not come to the end of a step go on side by side; where they are fewer than this, each by itself, which
/// is less work.
const FEW: usize = 4;

/// Rows with `N` states each, of which the law is an `L`.
#[derive(Debug)]
pub(super) struct Rows<W: Wide, L, const N: usize> {
    /// One rig over lanes, shared by all blocks of a batch whose rows have the same numbers: it then stays in the cache.
    pub(super) rig: Arc<Rig<W, L>>,
    method: Method,
    /// The time in s that all have come to.
    pub(super) time: f64,
    pub(super) state: States<W, N>,
    held: Held<W>,
    /// How many elements of the memory are in use.
    elements: usize,
    alive: W::Mask,
    /// Rows whose passages are not whole.
    under_way: W::Mask,
    /// Instants up to this time in s are known.
    known_until: f64,
    /// The first of the instants of all lanes; infinite when none is known.
    soonest: f64,
    pub(super) members: Vec<Member<W::Lane>>,
}

impl<W: Wide, L: Statics<W>, const N: usize> Rows<W, L, N> {
    /// Rows at t = 0; `like` is the rig of one that may have the same numbers as the first of them.
    pub(super) fn new(rig: Arc<Rig<W, L>>, rows: &[&Row], method: Method, mut like: Option<Arc<Rig<W::Lane>>>) -> Self {
        let begin = |row: &&Row| {
            let lane = Lane::new(row, like.as_ref());
            like = Some(lane.rig.clone());
            let walk = lane.begin(row, 0.0);
            Member::new(lane, &walk)
        };
        let members = rows.iter().map(begin).collect();
        // Lanes without a row hold no number.
        let starts: Vec<_> = rows.iter().map(|row| stepped(&row.rig, row.start)).collect();
        let start =
            |place: usize| W::from_lanes(|lane| W::Lane::constant(starts.get(lane).map_or(f64::NAN, |it| it[place])));
        let state = core::array::from_fn(start);
        let runs = |lane: usize| rows.get(lane).is_some_and(|row| compressor_starts(&row.rig, &starts[lane]));
        let actuator = rig.actuator();
        let elements = actuator.friction().hysteresis().map_or(0, Hysteresis::count);
        let memory = Memory::relaxed(actuator.limits().actuator_length(state[0]));
        let mut block = Self {
            rig,
            method,
            time: 0.0,
            state,
            held: Held { memory, compressor: W::mask(runs), ..Held::nothing() },
            elements,
            alive: W::mask(|lane| rows.get(lane).is_some_and(|row| row.rig.check_fixed_steps().is_ok())),
            under_way: W::Mask::splat(false),
            known_until: 0.0,
            soonest: f64::INFINITY,
            members,
        };
        block.pass(|member| member.lives);
        block
    }

    /// Other rows with the same numbers at t = 0.
    pub(super) fn of_others(&self, rows: &[&Row]) -> Self {
        let like = self.members.first().map(|member| member.kept.lane.rig.clone());
        Self::new(self.rig.clone(), rows, self.method, like)
    }

    /// A lane by itself, at the time in s that it has come to.
    fn walk(&self, index: usize, time: f64) -> Walk<W::Lane> {
        let (held, number) = (&self.held, |wide: &W| wide.lane(index));
        let held = Held {
            supply: W::holds(held.supply, index),
            exhaust: W::holds(held.exhaust, index),
            openings: self.members[index].openings().map(W::Lane::of_time),
            sliding: number(&held.sliding),
            stuck: W::holds(held.stuck, index),
            slack: W::holds(held.slack, index),
            taut: W::holds(held.taut, index),
            compressor: W::holds(held.compressor, index),
            line: Line {
                time: number(&held.line.time),
                length: number(&held.line.length),
                slope: number(&held.line.slope),
            },
            memory: self.memory_of(index),
        };
        let state = whole(&self.state, index);
        let Kept { progress, ports, .. } = *self.members[index].kept;
        Walk { course: Course { time, state, held }, progress, ports }
    }

    /// The memory of a lane.
    fn memory_of(&self, index: usize) -> Memory<W::Lane> {
        let Memory { at, elements } = &self.held.memory;
        let mut memory = Memory::relaxed(at.lane(index));
        for element in 0..self.elements {
            memory.elements[element] = elements[element].lane(index);
        }
        memory
    }

    /// Takes a lane back; its state into that of the block at the end of a step.
    fn take_back(&mut self, index: usize, walk: &Walk<W::Lane>, end: &mut States<W, N>) {
        let Course { state, held: of_lane, .. } = &walk.course;
        for (wide, number) in end.iter_mut().zip(state) {
            wide.put(index, *number);
        }
        let only = W::mask(|lane| lane == index);
        let set = |mask: &mut W::Mask, value: bool| *mask = if value { *mask | only } else { *mask & !only };
        let held = &mut self.held;
        set(&mut held.supply, of_lane.supply);
        set(&mut held.exhaust, of_lane.exhaust);
        set(&mut held.stuck, of_lane.stuck);
        set(&mut held.slack, of_lane.slack);
        set(&mut held.taut, of_lane.taut);
        set(&mut held.compressor, of_lane.compressor);
        held.sliding.put(index, of_lane.sliding);
        held.line.time.put(index, of_lane.line.time);
        held.line.length.put(index, of_lane.line.length);
        held.line.slope.put(index, of_lane.line.slope);
        held.memory.at.put(index, of_lane.memory.at);
        for element in 0..self.elements {
            held.memory.elements[element].put(index, of_lane.memory.elements[element]);
        }
        let member = &mut self.members[index];
        (member.kept.progress, member.kept.ports) = (walk.progress, walk.ports);
        member.look_ahead(self.known_until);
    }

    /// Does something with a lane by itself, and takes it back; its state into that of the block at the end of a step.
    fn by_itself(
        &mut self,
        index: usize,
        time: f64,
        end: &mut States<W, N>,
        does: impl FnOnce(&mut Lane<W::Lane>, &mut Walk<W::Lane>) -> Result<(), Error>,
    ) {
        let mut walk = self.walk(index, time);
        match does(&mut self.members[index].kept.lane, &mut walk) {
            Ok(()) => self.take_back(index, &walk, end),
            Err(fault) => self.fail(index, fault, end),
        }
    }

    /// Takes lanes through what is due where all are.
    #[inline(never)]
    fn pass(&mut self, which: impl Fn(&Member<W::Lane>) -> bool) {
        let mut end = self.state;
        for index in 0..self.members.len() {
            if which(&self.members[index]) {
                self.by_itself(index, self.time, &mut end, Lane::pass);
            }
        }
        self.state = end;
        self.sort();
    }

    /// Puts a controller in place of a lane's command, at t = 0.
    pub(super) fn control(&mut self, index: usize, control: Box<dyn Control>) {
        let member = &mut self.members[index];
        member.kept.lane.control = Some(control);
        if member.lives {
            let mut end = self.state;
            self.by_itself(index, self.time, &mut end, Lane::sample_due);
            self.state = end;
            self.sort();
        }
    }

    /// Other rows in some lanes begin where their walks are.
    pub(super) fn begin_anew(&mut self, walks: Vec<(usize, Walk<W::Lane>)>) {
        let mut end = self.state;
        for (index, mut walk) in walks {
            self.alive = self.alive | W::mask(|lane| lane == index);
            match self.members[index].kept.lane.pass(&mut walk) {
                Ok(()) => self.take_back(index, &walk, &mut end),
                Err(fault) => self.fail(index, fault, &mut end),
            }
        }
        self.state = end;
        self.sort();
    }

    /// The lanes of `which` by themselves from where all are to `until`.
    #[inline(never)]
    fn walk_to(&mut self, which: W::Mask, until: f64, end: &mut States<W, N>) {
        let method = self.method;
        for index in (0..self.members.len()).filter(|index| W::holds(which, *index)) {
            // The step of all lanes knows whole passages only.
            let known = (!self.members[index].under_way).then(|| whole(end, index));
            self.by_itself(index, self.time, end, |lane, walk| lane.go(walk, method, until, known));
        }
        self.sort();
    }

    /// Stops a lane where all are.
    pub(super) fn stop(&mut self, index: usize, fault: Error) {
        let mut end = self.state;
        self.fail(index, fault, &mut end);
        self.state = end;
        self.sort();
    }

    /// Gives a lane its fault; it holds no number from here on.
    fn fail(&mut self, index: usize, fault: Error, end: &mut States<W, N>) {
        self.members[index].stop(fault);
        self.alive = self.alive & !W::mask(|lane| lane == index);
        for number in end {
            number.put(index, W::Lane::constant(f64::NAN));
        }
    }

    /// Hears what has been told up to the end of the span, and looks up instants.
    fn look_ahead(&mut self, span: &Span) {
        let all = self.known_until < span.until;
        if all {
            self.known_until = span.until + SPANS_AHEAD * (span.until - span.from);
        }
        let mut changed = false;
        for member in self.members.iter_mut().filter(|member| member.lives) {
            if member.hear([span.from, span.until]) || all {
                member.look_ahead(self.known_until);
                changed = true;
            }
        }
        if changed {
            self.sort();
        }
    }

    /// Finds the first of all instants, and the rows whose passages are not whole.
    fn sort(&mut self) {
        self.under_way = W::mask(|index| self.members.get(index).is_some_and(|member| member.under_way));
        self.soonest = self.members.iter().map(|member| member.next).fold(f64::INFINITY, f64::min);
    }

    #[inline(always)]
    pub(super) fn advance<S: Simd>(&mut self, simd: S, span: Span) {
        self.look_ahead(&span);
        // What has just been told may move a seat at once.
        while is_due(self.soonest, self.time) {
            let now = self.time;
            self.pass(|member| is_due(member.next, now));
        }
        for part in 1..=span.steps {
            let to = span.end_of(part);
            match is_due(self.soonest, to) {
                false => self.step(simd, to),
                true => self.step_apart(simd, to),
            }
            self.time = to;
        }
    }

    /// One step of all rows, in which no instant comes.
    #[inline(always)]
    fn step<S: Simd>(&mut self, simd: S, until: f64) {
        let (time, step) = (W::constant(self.time), W::constant((until - self.time).larger(0.0)));
        let Stepped { mut end, sliding, happens } = simd.vectorize(Take { rows: self, time, step });
        let alone = (happens | self.under_way) & self.alive;
        if alone.any() {
            self.held.sliding = W::select(alone, self.held.sliding, sliding);
            self.walk_to(alone, until, &mut end);
        } else {
            self.held.sliding = sliding;
        }
        // Rows that went by themselves have come to where their memory is: this does not change it.
        self.rig.actuator().remember(&mut self.held.memory, end[0], end[1]);
        self.state = end;
    }

    /// One step of all rows with instants in it: each goes from one of its own instants to the next, and to the end.
    #[inline(always)]
    fn step_apart<S: Simd>(&mut self, simd: S, until: f64) {
        let from = self.time;
        self.members.iter_mut().for_each(|member| member.time = from);
        while self.set_out(until) {
            let of = |number: fn(&Member<W::Lane>) -> f64| {
                W::from_lanes(|lane| W::Lane::of_time(self.members.get(lane).map_or(from, number)))
            };
            let (time, step) = (of(|member| member.time), of(|member| member.goal - member.time));
            let goes = W::mask(|lane| self.members.get(lane).is_some_and(|member| member.goes));
            let Stepped { mut end, sliding, happens } = simd.vectorize(Take { rows: self, time, step });
            let alone = (happens | self.under_way) & goes;
            let together = goes & !alone;
            for (end, state) in end.iter_mut().zip(self.state) {
                *end = W::select(together, *end, state);
            }
            self.held.sliding = W::select(together, sliding, self.held.sliding);
            if alone.any() {
                self.walk_left(until, &mut end, |index, _| W::holds(alone, index));
            }
            // It does not change the memory of rows that have come to where it is.
            self.rig.actuator().remember(&mut self.held.memory, end[0], end[1]);
            self.state = end;
            self.arrive(until);
        }
    }

    /// Gives every row that has not come to `until` its goal; whether there are enough of them to go on side by side. If not,
    /// they have gone there by themselves.
    #[inline(never)]
    fn set_out(&mut self, until: f64) -> bool {
        let (mut going, mut left) = (0, false);
        for member in self.members.iter_mut().filter(|member| member.lives) {
            member.goes = member.time < until || is_due(member.next, until);
            member.goal = until.smaller(member.next).larger(member.time);
            going += usize::from(member.goes && !member.under_way);
            left |= member.goes;
        }
        if going >= FEW {
            return true;
        }
        if left {
            let mut end = self.state;
            self.walk_left(until, &mut end, |_, _| true);
            self.state = end;
            self.sort();
        }
        false
    }

    /// Those of the rows that have not come to `until` go there by themselves.
    #[inline(never)]
    fn walk_left(&mut self, until: f64, end: &mut States<W, N>, which: impl Fn(usize, &Member<W::Lane>) -> bool) {
        let method = self.method;
        for index in 0..self.members.len() {
            let member = &mut self.members[index];
            if member.goes && which(index, member) {
                let time = core::mem::replace(&mut member.time, until);
                member.goes = false;
                self.by_itself(index, time, end, |lane, walk| lane.go(walk, method, until, None));
            }
        }
    }

    /// Rows have come to their goals and pass what is due there; a few that have not come to `until` go there at once.
    #[inline(never)]
    fn arrive(&mut self, until: f64) {
        let (mut end, method) = (self.state, self.method);
        let finish = self.members.iter().filter(|member| member.goes && member.goal < until).count() < FEW;
        for index in 0..self.members.len() {
            let member = &mut self.members[index];
            if member.goes {
                let goal = member.goal;
                let finishes = finish && goal < until;
                member.time = if finishes { until } else { goal };
                if is_due(member.next, goal) {
                    self.by_itself(index, goal, &mut end, |lane, walk| {
                        lane.pass(walk)?;
                        if finishes { lane.go(walk, method, until, None) } else { Ok(()) }
                    });
                }
            }
        }
        self.state = end;
        self.sort();
    }

    #[inline(never)]
    fn under_way(&self, index: usize, sample: Sample) -> Sample {
        self.members[index].kept.lane.under_way(&self.walk(index, self.time), sample)
    }

    /// Where a lane is, or why it has stopped.
    #[inline(always)]
    pub(super) fn state_of(&self, index: usize) -> Result<State, &Error> {
        let number = |place: usize| self.state[place].lane(index).value();
        let state = State::from_array([number(0), number(1), number(2), number(3)]);
        // A lane that has stopped holds no number: those that live need not be looked at themselves.
        match state.length.is_nan() {
            true => self.members[index].kept.lane.fault.as_ref().map_or(Ok(state), Err),
            false => Ok(state),
        }
    }

    /// What each row shows now, or why it has stopped.
    #[inline(always)]
    pub(super) fn samples(&self) -> Vec<Result<Sample, Error>> {
        let time = W::constant(self.time);
        let observed = self.rig.observe(time, &self.state, &self.held);
        let (air, supply) = (self.rig.hose_content(&self.state), self.rig.feed(&self.state));
        let hose = air.map(|air| [self.state[volume(0)], air]);
        let sample = |(index, member): (usize, &Member<_>)| match &member.kept.lane.fault {
            Some(fault) => Err(fault.clone()),
            None => {
                let sample = Sample::of_lane(
                    self.time,
                    of_rig(&self.state),
                    &observed,
                    index,
                    (member.kept.ports, hose, supply),
                );
                Ok(match member.under_way {
                    false => sample,
                    true => self.under_way(index, sample),
                })
            }
        };
        self.members.iter().enumerate().map(sample).collect()
    }
}

/// All states of a lane; those that no row has room for are zero.
fn whole<W: Wide, const N: usize>(states: &States<W, N>, lane: usize) -> States<W::Lane> {
    let mut of_lane = [W::Lane::zero(); PIPED];
    for (number, wide) in of_lane.iter_mut().zip(states) {
        *number = wide.lane(lane);
    }
    of_lane
}

/// The end of a step for each lane, and where something happens before it.
struct Stepped<W: Wide, const N: usize> {
    end: States<W, N>,
    sliding: W,
    happens: W::Mask,
}

/// One step of the method, compiled once for wherever it is taken.
struct Take<'a, W: Wide, L, const N: usize> {
    rows: &'a Rows<W, L, N>,
    /// Where the step begins and how long it is, both in s.
    time: W,
    step: W,
}

impl<W: Wide, L: Statics<W>, const N: usize> WithSimd for Take<'_, W, L, N> {
    type Output = Stepped<W, N>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Stepped<W, N> {
        let Self { rows: Rows { rig, method, state, held, .. }, time, step } = self;
        let end = rig.take(*method, time, state, step, held);
        let [sliding, extent, compressor] = rig.keeps(held, &end);
        let least = if N > PLAIN { sliding.smaller(extent).smaller(compressor) } else { sliding.smaller(extent) };
        let ceases = least.lt(W::zero()) & W::zero().lt(step);
        let sliding = if rig.load().inertia().is_none() { rig.slides(held, &of_rig(&end)).0 } else { held.sliding };
        let mut holds = rig.admissible(&end);
        if *method == Method::Stable {
            holds = holds & rig.leaves_air(state, &end);
        }
        Stepped { end, sliding, happens: ceases | !holds }
    }
}
