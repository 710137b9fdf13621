//! A block: as many rows as a vector has lanes, with laws of the same form.
//!
//! The numbers of the rows lie lane by lane in one rig over lanes. A step of all rows is one step of the method. Rows to
//! which something happens within it (an instant of their own, a turn, the end of the physics) take that step again by
//! themselves as the fixed-step engine does, from where they were, and so do rows whose passages are under way or lead to a
//! regulated pressure; an instant that all rows share divides the step of the block, and so does a sampling instant of their
//! controllers, which each row's own controller then sees. So every row goes the fixed-step engine's way, bit for bit.

use super::Row;
use super::gather::gather;
use super::lane::Lane;
use super::wide::{Compiled, Wide};
use crate::error::Error;
use crate::force::{Characteristic, IdealBraid, Statics};
use crate::friction::{Hysteresis, Memory};
use crate::load::Line;
use crate::scalar::{Mask, Real, Scalar};
use crate::simulation::closed_loop::Control;
use crate::simulation::course::Course;
use crate::simulation::fixed_step::{Walk, compressor_starts, stepped};
use crate::simulation::kernel::Held;
use crate::simulation::piped::{PIPED, PLAIN, SHORT, Stepped as States, of_rig, volume};
use crate::simulation::sample::Sample;
use crate::simulation::{Decision, Method, Rig, State};
use crate::valve::{Demand, Openings, is_due};
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::marker::PhantomData;
use pulp::{Simd, WithSimd};

/// How far beyond the time that is asked for instants are looked up, in spans of the same length.
const SPANS_AHEAD: f64 = 64.0;

/// Equal steps from one time in s to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) until: f64,
    pub(super) steps: u64,
}

impl Span {
    /// The time in s at the end of a step.
    pub(super) fn end_of(&self, step: u64) -> f64 {
        if step == self.steps {
            self.until
        } else {
            self.from + (self.until - self.from) * (step as f64 / self.steps as f64)
        }
    }
}

/// Rows side by side. The law is named where it is the ideal braid, so that no stage has to ask for it, and there is room for
/// the states of an air line, and of its cells, where there are any: most rows need not carry that.
#[derive(Debug)]
pub(super) enum Block<W: Wide> {
    Ideal(Box<Rows<W, IdealBraid<W>, PLAIN>>),
    Plain(Box<Rows<W, Characteristic<W>, PLAIN>>),
    Piped(Box<Rows<W, Characteristic<W>, SHORT>>),
    Celled(Box<Rows<W, Characteristic<W>, PIPED>>),
}

/// Does the same with the rows of a block of any kind.
macro_rules! with_rows {
    ($block:expr, $rows:ident => $done:expr) => {
        match $block {
            Block::Ideal($rows) => $done,
            Block::Plain($rows) => $done,
            Block::Piped($rows) => $done,
            Block::Celled($rows) => $done,
        }
    };
}

/// Rows with `N` states each, of which the law is an `L`.
#[derive(Debug)]
pub(super) struct Rows<W: Wide, L, const N: usize> {
    /// One rig over lanes.
    rig: Rig<W, L>,
    method: Method,
    time: f64,
    state: States<W, N>,
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
    /// Whether that is the next instant of every living lane.
    shared: bool,
    lanes: Vec<Lane<W::Lane>>,
}

impl<W: Wide> Block<W> {
    /// At most as many rows of the same form as there are lanes, at t = 0.
    pub(super) fn new(rows: &[&Row], method: Method) -> Self {
        let rigs: Vec<&Rig> = rows.iter().map(|row| &row.rig).collect();
        let rig: Rig<W> = gather(&rigs);
        // One with an air line is not taken for ideal.
        match rig.ideal() {
            Some(ideal) => Self::Ideal(Box::new(Rows::new(ideal, rows, method))),
            None if rig.has_cells() => Self::Celled(Box::new(Rows::new(rig, rows, method))),
            None if rig.is_piped() => Self::Piped(Box::new(Rows::new(rig, rows, method))),
            None => Self::Plain(Box::new(Rows::new(rig, rows, method))),
        }
    }
}

impl<W: Wide> Block<W> {
    /// What the controller of a lane has decided; nothing where there is none.
    pub(super) fn decisions(&self, index: usize) -> &[Decision] {
        let control = with_rows!(self, rows => &rows.lanes[index].control);
        control.as_ref().map_or(&[], |control| control.decisions())
    }

    /// Tells the valve of a lane what it is to do from now on.
    pub(super) fn tell(&mut self, index: usize, demand: Demand) -> Result<(), Error> {
        with_rows!(self, rows => rows.tell(index, demand))
    }

    /// Where a lane is, or why it has stopped.
    pub(super) fn state(&self, index: usize) -> Result<State, &Error> {
        with_rows!(self, rows => match &rows.lanes[index].fault {
            Some(fault) => Err(fault),
            None => Ok(State::from_array([0, 1, 2, 3].map(|place| rows.state[place].lane(index).value()))),
        })
    }

    /// The same of every lane that has not stopped, of which something is asked.
    pub(super) fn tell_all(&mut self, demand: impl Fn(usize) -> Option<Demand>) -> Result<(), Error> {
        with_rows!(self, rows => {
            let living = |rows: &Rows<W, _, _>, lane: &usize| rows.lanes[*lane].fault.is_none();
            (0..rows.lanes.len()).try_for_each(|lane| match demand(lane).filter(|_| living(rows, &lane)) {
                Some(demand) => rows.tell(lane, demand),
                None => Ok(()),
            })
        })
    }

    /// Puts other rows in the place of lanes, from now on.
    #[inline(always)]
    fn restart(&mut self, anew: &[(usize, &Row)]) -> Result<(), Error> {
        let (walks, rigs) = with_rows!(self, rows => {
            let of_lane = |(index, row): &(usize, &Row)| Ok((*index, rows.lanes[*index].anew(row, rows.time)?));
            let begun: Vec<_> = anew.iter().map(of_lane).collect::<Result<_, Error>>()?;
            let put = |(index, (lane, walk))| {
                rows.lanes[index] = lane;
                (index, walk)
            };
            let walks: Vec<(usize, Walk<W::Lane>)> = begun.into_iter().map(put).collect();
            (walks, rows.lanes.iter().map(|lane| &lane.rig).collect::<Vec<_>>())
        });
        let rig: Rig<W> = gather(&rigs);
        match self {
            Self::Ideal(rows) => {
                if let Some(ideal) = rig.ideal() {
                    rows.begin_anew(ideal, walks);
                }
            }
            Self::Plain(rows) => rows.begin_anew(rig, walks),
            Self::Piped(rows) => rows.begin_anew(rig, walks),
            Self::Celled(rows) => rows.begin_anew(rig, walks),
        }
        Ok(())
    }
}

impl<W: Wide, L: Statics<W>, const N: usize> Rows<W, L, N> {
    fn new(rig: Rig<W, L>, rows: &[&Row], method: Method) -> Self {
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
            alive: W::mask(|lane| rows.get(lane).is_some_and(|row| row.rig.check_pressure_is_free().is_ok())),
            under_way: W::Mask::splat(false),
            known_until: 0.0,
            soonest: f64::INFINITY,
            shared: false,
            lanes: rows.iter().map(|row| Lane::new(row)).collect(),
        };
        block.pass(f64::INFINITY);
        block
    }

    /// A lane by itself.
    fn walk(&self, index: usize) -> Walk<W::Lane> {
        let (held, number) = (&self.held, |wide: &W| wide.lane(index));
        let held = Held {
            supply: W::holds(held.supply, index),
            exhaust: W::holds(held.exhaust, index),
            openings: self.lanes[index].openings(&self.lanes[index].progress).map(W::Lane::of_time),
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
        let Lane { progress, ports, .. } = self.lanes[index];
        Walk { course: Course { time: self.time, state, held }, progress, ports }
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
        let lane = &mut self.lanes[index];
        (lane.progress, lane.ports) = (walk.progress, walk.ports);
        lane.look_ahead(self.known_until);
    }

    /// Takes every living lane whose next instant is `instant` through what is due now.
    #[inline(never)]
    fn pass(&mut self, instant: f64) {
        let mut end = self.state;
        for index in 0..self.lanes.len() {
            if self.lanes[index].fault.is_none() && self.lanes[index].next == instant {
                let mut walk = self.walk(index);
                match self.lanes[index].pass(&mut walk) {
                    Ok(()) => self.take_back(index, &walk, &mut end),
                    Err(fault) => self.stop(index, fault, &mut end),
                }
            }
        }
        self.state = end;
        self.sort();
    }

    /// Puts a controller in place of a lane's command, at t = 0.
    fn control(&mut self, index: usize, control: Box<dyn Control>) {
        self.lanes[index].control = Some(control);
        if self.lanes[index].fault.is_none() {
            let (mut walk, mut end) = (self.walk(index), self.state);
            match self.lanes[index].sample_due(&mut walk) {
                Ok(()) => self.take_back(index, &walk, &mut end),
                Err(fault) => self.stop(index, fault, &mut end),
            }
            self.state = end;
            self.sort();
        }
    }

    /// Tells the valve of a lane what it is to do from now on.
    fn tell(&mut self, index: usize, demand: Demand) -> Result<(), Error> {
        let lane = &mut self.lanes[index];
        if let Some(fault) = &lane.fault {
            return Err(fault.clone());
        }
        let mut progress = lane.progress;
        lane.tell(&mut progress, self.time, demand)?;
        lane.progress = progress;
        Ok(())
    }

    /// The rig over lanes with other rows in some of them, which begin where their walks are.
    fn begin_anew(&mut self, rig: Rig<W, L>, walks: Vec<(usize, Walk<W::Lane>)>) {
        self.rig = rig;
        let mut end = self.state;
        for (index, mut walk) in walks {
            self.alive = self.alive | W::mask(|lane| lane == index);
            match self.lanes[index].pass(&mut walk) {
                Ok(()) => self.take_back(index, &walk, &mut end),
                Err(fault) => self.stop(index, fault, &mut end),
            }
        }
        self.state = end;
        self.sort();
    }

    /// The lanes of `which` by themselves from where they are to `until`.
    #[inline(never)]
    fn walk_to(&mut self, which: W::Mask, until: f64, end: &mut States<W, N>) {
        for index in 0..self.lanes.len() {
            if !W::holds(which, index) {
                continue;
            }
            let mut walk = self.walk(index);
            // The step of all lanes knows whole passages only.
            let known = (!W::holds(self.under_way, index)).then(|| whole(end, index));
            match self.lanes[index].go(&mut walk, self.method, until, known) {
                Ok(()) => self.take_back(index, &walk, end),
                Err(fault) => self.stop(index, fault, end),
            }
        }
        self.sort();
    }

    /// Gives a lane its fault; it holds no number from here on.
    fn stop(&mut self, index: usize, fault: Error, end: &mut States<W, N>) {
        let lane = &mut self.lanes[index];
        (lane.fault, lane.next) = (Some(fault), f64::INFINITY);
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
        for lane in self.lanes.iter_mut().filter(|lane| lane.fault.is_none()) {
            let Lane { told, actuation, progress, .. } = lane;
            if told.hear(actuation.as_mut(), progress, [span.from, span.until]) || all {
                lane.look_ahead(self.known_until);
                changed = true;
            }
        }
        if changed {
            self.sort();
        }
    }

    /// Finds the first of all instants, and the rows whose passages are not whole.
    fn sort(&mut self) {
        let lanes = &self.lanes;
        self.under_way = W::mask(|index| {
            lanes.get(index).is_some_and(|lane| !matches!(lane.openings(&lane.progress), Openings::Whole))
        });
        self.soonest = self.lanes.iter().map(|lane| lane.next).fold(f64::INFINITY, f64::min);
        self.shared = self.lanes.iter().all(|lane| lane.fault.is_some() || lane.next == self.soonest);
    }

    /// One step of all rows; those of `alone` go by themselves.
    #[inline(always)]
    fn step<S: Simd>(&mut self, simd: S, until: f64, alone: impl FnOnce(&Self) -> W::Mask) {
        let step = W::Lane::of_time((until - self.time).larger(0.0));
        let Stepped { mut end, sliding, happens } = simd.vectorize(Take { rows: self, step });
        let alone = (happens | self.under_way | alone(self)) & self.alive;
        if alone.any() {
            self.walk_to(alone, until, &mut end);
            self.held.sliding = W::select(alone, self.held.sliding, sliding);
        } else {
            self.held.sliding = sliding;
        }
        // Rows that went by themselves have come to where their memory is: this does not change it.
        self.rig.actuator().remember(&mut self.held.memory, end[0], end[1]);
        self.state = end;
        self.time = until;
    }

    #[inline(always)]
    fn advance<S: Simd>(&mut self, simd: S, span: Span) {
        self.look_ahead(&span);
        // What has just been told may move a seat at once.
        while is_due(self.soonest, self.time) {
            self.pass(self.soonest);
        }
        for part in 1..=span.steps {
            let to = span.end_of(part);
            while self.shared && is_due(self.soonest, to) {
                let instant = self.soonest;
                self.step(simd, to.smaller(instant), |_| W::Mask::splat(false));
                self.pass(instant);
            }
            if is_due(self.soonest, to) {
                self.step(simd, to, |block| {
                    W::mask(|lane| block.lanes.get(lane).is_some_and(|lane| is_due(lane.next, to)))
                });
            } else {
                self.step(simd, to, |_| W::Mask::splat(false));
            }
        }
    }

    #[inline(never)]
    fn under_way(&self, index: usize, sample: Sample) -> Sample {
        self.lanes[index].under_way(&self.walk(index), sample)
    }

    /// What each row shows now, or why it has stopped.
    #[inline(always)]
    fn samples(&self) -> Vec<Result<Sample, Error>> {
        let time = W::constant(self.time);
        let observed = self.rig.observe(time, &self.state, &self.held);
        let (air, supply) = (self.rig.hose_content(&self.state), self.rig.feed(&self.state));
        let hose = air.map(|air| [self.state[volume(0)], air]);
        let sample = |(index, lane): (usize, &Lane<_>)| match &lane.fault {
            Some(fault) => Err(fault.clone()),
            None => {
                let sample =
                    Sample::of_lane(self.time, of_rig(&self.state), &observed, index, (lane.ports, hose, supply));
                Ok(match W::holds(self.under_way, index) {
                    false => sample,
                    true => self.under_way(index, sample),
                })
            }
        };
        self.lanes.iter().enumerate().map(sample).collect()
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
    step: W::Lane,
}

impl<W: Wide, L: Statics<W>, const N: usize> WithSimd for Take<'_, W, L, N> {
    type Output = Stepped<W, N>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Stepped<W, N> {
        let Rows { rig, method, state, held, .. } = self.rows;
        let (time, step) = (W::constant(self.rows.time), W::constant(self.step.value()));
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

/// A new block.
pub(super) struct Create<'a, W> {
    rows: &'a [&'a Row],
    method: Method,
    block: PhantomData<W>,
}

impl<'a, W: Wide> Create<'a, W> {
    pub(super) fn new(rows: &'a [&'a Row], method: Method) -> Self {
        Self { rows, method, block: PhantomData }
    }
}

impl<W: Wide> Compiled for Create<'_, W> {
    type Wide = W;
    type Output = Block<W>;
    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Block<W> {
        Block::new(self.rows, self.method)
    }
}

/// A controller for a lane of a block.
pub(super) struct Attach<'a, W: Wide>(pub(super) &'a mut Block<W>, pub(super) usize, pub(super) Box<dyn Control>);

impl<W: Wide> Compiled for Attach<'_, W> {
    type Wide = W;
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        with_rows!(self.0, rows => rows.control(self.1, self.2))
    }
}

/// Other rows for lanes of a block.
pub(super) struct Restart<'a, W: Wide>(pub(super) &'a mut Block<W>, pub(super) &'a [(usize, &'a Row)]);

impl<W: Wide> Compiled for Restart<'_, W> {
    type Wide = W;
    type Output = Result<(), Error>;
    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Self::Output {
        self.0.restart(self.1)
    }
}

/// A block's way through a span.
pub(super) struct Advance<'a, W: Wide>(pub(super) &'a mut Block<W>, pub(super) Span);

impl<W: Wide> Compiled for Advance<'_, W> {
    type Wide = W;
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        with_rows!(self.0, rows => rows.advance(simd, self.1))
    }
}

/// A block's samples.
pub(super) struct Samples<'a, W: Wide>(pub(super) &'a Block<W>);

impl<W: Wide> Compiled for Samples<'_, W> {
    type Wide = W;
    type Output = Vec<Result<Sample, Error>>;
    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Self::Output {
        with_rows!(self.0, rows => rows.samples())
    }
}
