//! Plants of equal structure side by side: their states in lanes, and how they go through time together.
//!
//! A block keeps where its rows are. What it computes with is a [`Workspace`], which blocks use one after the other, so that many
//! rows stay in the cache.
//!
//! A step of all rows is one step of the method in lanes, after which [`Watch`] says which rows have kept their mode. A row that
//! has not, or for which something is due within the step, repeats the step as a scalar instance, from where it was: so each row is
//! bit-identical to [`PlantSteps`]. What is evaluated individually is the mode of each element, and only where that
//! changes.

use crate::deal::{Blank, Deal, List};
use crate::held::{self, Held};
use crate::kept::{keep_contents, keep_given, keep_rates, stay};
use crate::motion::HostEnds;
use crate::row::{BlockRows, Change, Row};
use crate::span::Span;
use crate::watch::Watch;
use crate::wide::{Compiled, Wide, compiled};
use mckibben::air::Process;
use mckibben::internals::{Evaluation, Stages, System, is_due};
use mckibben::plant::{Plant, PlantSteps};
use mckibben::scalar::Mask;
use mckibben::simulation::Method;
use mckibben::{Error, Response};
use pulp::Simd;
use std::fmt::Debug;
use std::sync::Arc;

/// Of a row whose step in lanes is believed and has kept its mode; 1 is believed, 0 is not.
const KEEPS: f64 = 2.0;
/// How far beyond the end of a span instants are looked up, in spans of the same length.
const SPANS_AHEAD: f64 = 64.0;

/// A plant with all its numbers zero: two plants of equal structure are equal.
pub(crate) fn structure(plant: &Plant) -> Plant {
    without_commands(plant).convert(&mut Blank)
}

/// The plants of rows, with their numbers in lanes.
#[inline(always)]
fn deal<W: Wide>(rows: &[Row], known: &mut Known<W>) -> Arc<System<W>> {
    // Rows that share their numbers have them all from the first.
    let shares = rows.iter().all(|row| row.steps.shares_with(&rows[0].steps));
    let list = |row: &Row| {
        let mut list = List(Vec::new());
        without_commands(row.steps.plant()).convert(&mut list);
        list.0
    };
    let lists: Vec<Vec<f64>> = rows.iter().take(if shares { 1 } else { rows.len() }).map(list).collect();
    let are_equal =
        |list: &[f64], other: &[f64]| list.iter().map(|its| its.to_bits()).eq(other.iter().map(|its| its.to_bits()));
    let is_common = lists.iter().all(|list| are_equal(list, &lists[0]));
    match known {
        Some((list, system)) if is_common && are_equal(list, &lists[0]) => system.clone(),
        _ => {
            let plant = without_commands(rows[0].steps.plant()).convert(&mut Deal::new(&lists));
            let system = Arc::new(System::in_lanes(plant));
            if is_common {
                *known = lists.into_iter().next().map(|list| (list, system.clone()));
            }
            system
        }
    }
}

/// Commands differ from row to row, and no stage needs them.
fn without_commands(plant: &Plant) -> Plant {
    let valves: Vec<usize> = (0..plant.network().valves.len()).collect();
    plant.clone().without_commands(&valves)
}

/// Rows in lanes.
#[derive(Clone, Debug)]
pub(crate) struct Block<W: Wide> {
    pub(crate) method: Method,
    /// The time in s that all rows have reached.
    pub(crate) time: f64,
    /// The plants with their numbers, in common with other blocks where all are of one plant.
    pub(crate) system: Arc<System<W>>,
    pub(crate) state: Vec<W>,
    pub(crate) end: Vec<W>,
    pub(crate) held: Held<W>,
    pub(crate) watch: Watch<W>,
    pub(crate) hosts: HostEnds<W>,
    /// Which of the coordinates of all rows that a host moves is the first of each lane.
    pub(crate) firsts: Vec<usize>,
    /// 1 in lanes whose row has another state at the time that it has itself.
    pub(crate) behind: W,
    /// 1 in lanes whose row has not stopped, and where it takes its steps with the others; 0 elsewhere.
    pub(crate) lives: W,
    pub(crate) goes: W,
    /// Rows that look themselves whether a step has met an event.
    looks: Vec<bool>,
    any_looks: bool,
    /// `P V/m` of isothermal air, 0 where there is none.
    contents: Vec<W>,
    is_isothermal: bool,
    /// Whether a mode has changed since the last step.
    pub(crate) is_changed: bool,
    /// Instants up to this time in s are known, and the first of them; infinite when there is none.
    known_until: f64,
    soonest: f64,
    /// Where times in lanes are counted from, in s.
    pub(crate) origin: f64,
}

/// What blocks of equal structure compute with.
#[derive(Clone, Debug)]
pub(crate) struct Workspace<W: Wide> {
    /// Whose numbers it has.
    adapted_to: Arc<System<W>>,
    stages: Stages<W>,
    pub(crate) at: Evaluation<W>,
    /// Within a step in which something is due: where each row is and where it goes next, in s, and whether it has arrived.
    from: Vec<f64>,
    goal: Vec<f64>,
    arrived: Vec<bool>,
    /// The states of a row.
    row: Vec<f64>,
}

/// The last numbers that all rows of a block had, and the plants with them in lanes.
pub(crate) type Known<W> = Option<(Vec<f64>, Arc<System<W>>)>;

/// What a new block is made of.
struct Create<'a, W: Wide>(&'a mut [Row], &'a mut Known<W>);

/// The block for which a workspace is made.
struct Room<'a, W: Wide>(&'a Block<W>);

/// A block's way through a span.
struct Advance<'a, W: Wide>(&'a mut Block<W>, &'a mut Workspace<W>, BlockRows<'a>, Span<'a>);

/// What a block's rows answer with their ends at given distances and rates.
struct Answer<'a, W: Wide>(&'a mut Block<W>, &'a mut Workspace<W>, BlockRows<'a>, [&'a [f64]; 2], &'a mut [Response]);

impl<W: Wide> Workspace<W> {
    /// For blocks whose plants have the structure of this one's.
    pub(crate) fn new(block: &Block<W>) -> Self {
        compiled(Room(block))
    }

    /// Takes on the numbers of a block's plants.
    #[inline(always)]
    fn adapt(&mut self, system: &Arc<System<W>>) {
        if !Arc::ptr_eq(&self.adapted_to, system) {
            self.stages.adapt(&system.plant);
            self.at.adapt(&system.plant);
            self.adapted_to = system.clone();
        }
    }
}

impl<W: Wide> Block<W> {
    /// A block of rows of equal structure, as many as there are lanes at most. Where all have the numbers that are known, it has them
    /// in common with the blocks before.
    pub(crate) fn new(rows: &mut [Row], known: &mut Known<W>) -> Self {
        compiled(Create::<W>(rows, known))
    }

    /// Takes the rows, whose lanes these are, through a span.
    pub(crate) fn advance(&mut self, work: &mut Workspace<W>, rows: BlockRows<'_>, span: Span<'_>) {
        compiled(Advance(self, work, rows, span));
    }

    /// Brings a row to where its lane is.
    pub(crate) fn bring(&mut self, lane: usize, row: &mut Row, desk: &mut PlantSteps) {
        if row.is_alive() && (self.behind.lane(lane) > 0.0 || row.steps.time() != self.time) {
            self.put(lane, row, desk, self.time);
        }
    }

    /// Takes the numbers of the rows again.
    pub(crate) fn gather(&mut self, BlockRows { list, desk }: BlockRows<'_>) {
        for (lane, row) in list.iter_mut().enumerate() {
            self.bring(lane, row, desk);
        }
        // A row that has stopped does not know the time.
        *self = Self { time: self.time, origin: self.origin, ..Self::new(list, &mut None) };
    }

    /// Computes what the actuators of all rows answer, row after row, with the ends that a host moves at these distances in m and
    /// rates in m/s.
    ///
    /// # Errors
    /// Those of a row.
    pub(crate) fn compute_at(
        &mut self,
        work: &mut Workspace<W>,
        rows: BlockRows<'_>,
        ends: [&[f64]; 2],
        responses: &mut [Response],
    ) -> Result<(), Error> {
        compiled(Answer(self, work, rows, ends, responses))
    }
}

impl<W: Wide> Compiled for Create<'_, W> {
    type Wide = W;
    type Output = Block<W>;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Block<W> {
        let Self(rows, known) = self;
        let system = deal(rows, known);
        let plant = &system.plant;
        let (states, zero) = (plant.indices().states, W::zero());
        let is_isothermal =
            plant.actuators().iter().any(|mounted| matches!(mounted.actuator.air().process(), Process::Isothermal));
        let mut firsts = Vec::with_capacity(rows.len());
        for row in rows.iter_mut() {
            row.change = Change::All;
            firsts.push(row.coordinates.start);
        }
        Block {
            method: rows[0].steps.method(),
            time: rows[0].steps.time(),
            state: vec![zero; states],
            end: vec![zero; states],
            held: Held::new(&system),
            watch: Watch::new(&system),
            hosts: HostEnds::new(&system),
            firsts,
            behind: zero,
            lives: zero,
            goes: zero,
            looks: vec![false; W::LANES],
            any_looks: false,
            contents: vec![zero; plant.actuators().len()],
            is_isothermal,
            is_changed: true,
            known_until: f64::NEG_INFINITY,
            soonest: f64::INFINITY,
            origin: 0.0,
            system,
        }
    }
}

impl<W: Wide> Compiled for Room<'_, W> {
    type Wide = W;
    type Output = Workspace<W>;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Workspace<W> {
        let system = &self.0.system;
        Workspace {
            stages: Stages::new(&system.plant),
            at: Evaluation::new(&system.plant),
            adapted_to: system.clone(),
            from: vec![0.0; W::LANES],
            goal: vec![0.0; W::LANES],
            arrived: vec![false; W::LANES],
            row: vec![0.0; system.plant.indices().states],
        }
    }
}

impl<W: Wide> Compiled for Advance<'_, W> {
    type Wide = W;
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self(block, work, mut rows, span) = self;
        work.adapt(&block.system);
        block.set_out(&mut rows, &span);
        if let Some(distances) = span.distances {
            block.set_off(work, &mut rows, distances, &span);
        }
        for end in span.ends {
            block.step(work, &mut rows, *end);
        }
        if span.distances.is_some() {
            block.arrive();
        }
    }
}

impl<W: Wide> Compiled for Answer<'_, W> {
    type Wide = W;
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Result<(), Error> {
        let Self(block, work, mut rows, ends, responses) = self;
        work.adapt(&block.system);
        block.answer(work, &mut rows, ends, responses)
    }
}

impl<W: Wide> Block<W> {
    /// Makes masks of modes that have changed.
    #[inline(always)]
    pub(crate) fn update(&mut self) {
        if self.is_changed {
            self.held.update();
            self.is_changed = false;
        }
    }

    /// Takes a row to a time in s and to the state of its lane.
    fn put(&mut self, lane: usize, row: &mut Row, desk: &mut PlantSteps, time: f64) {
        desk.visit(&mut row.steps, |steps| {
            steps.put(time, |place| self.state[place].lane(lane));
            if self.hosts.are_any() {
                steps.turn();
            }
        });
        self.behind.put(lane, 0.0);
    }

    /// One step of all rows to a time in s. Where something is due within it each row goes to its own next instant.
    #[inline(always)]
    fn step(&mut self, work: &mut Workspace<W>, rows: &mut BlockRows<'_>, until: f64) {
        let (zero, one) = (W::zero(), W::one());
        if until - self.origin > W::LONGEST {
            self.count_times_from(rows, self.time);
        }
        let is_divided = is_due(self.soonest, until);
        if is_divided {
            self.set_goals(work, rows.list, until);
        }
        loop {
            self.update();
            let Self { system, state, end, held, watch, origin, .. } = self;
            let Workspace { stages, at, from, goal, .. } = work;
            let mut together = zero.lt(self.goes);
            let mut believed = together;
            if together.any() {
                let [start, length, time] = if is_divided {
                    spans(from, goal, *origin)
                } else {
                    [W::constant(self.time - *origin), W::constant(until - self.time), W::constant(until - *origin)]
                };
                believed = believed & stages.take_unchecked(system, self.method, (start, length), state, held, at, end);
                keep_given(system, time, held, end);
                keep_rates(system, time, held, at, end);
                for i in 0..system.wires.len() {
                    system.keep_balance(i, time, end, held, at);
                }
                if self.is_isothermal {
                    keep_contents(system, time, &self.contents, held, at, end);
                }
                if is_divided {
                    stay(length, state, end);
                }
                together = believed & watch.holds(system, (time, end), held, at);
            }
            // How far the lanes of a row are good for.
            let come = || W::select(together, W::constant(KEEPS), W::select(believed, one, zero));
            if is_divided {
                match self.pass_goals(work, rows, come(), until) {
                    true => continue,
                    false => break,
                }
            }
            let apart = zero.lt(self.lives) & !together;
            if apart.any() || self.any_looks {
                self.part(&mut work.row, rows, come(), until);
            }
            std::mem::swap(&mut self.state, &mut self.end);
            break;
        }
        self.time = until;
    }

    /// Takes the step of those rows that have not kept their mode, each as a scalar instance.
    #[inline(never)]
    fn part(&mut self, own: &mut [f64], rows: &mut BlockRows<'_>, come: W, until: f64) {
        let mut changed = false;
        let BlockRows { list, desk } = rows;
        for (lane, row) in list.iter_mut().enumerate() {
            if !row.is_alive() || (come.lane(lane) == KEEPS && !self.looks[lane]) {
                continue;
            }
            self.bring(lane, row, desk);
            let events = row.steps.events();
            let done = if come.lane(lane) > 0.0 {
                read(&self.end, lane, own);
                desk.visit(&mut row.steps, |steps| steps.advance_to_end(until, own))
            } else {
                desk.visit(&mut row.steps, |steps| steps.advance_to(until))
            };
            changed |= self.take_back(lane, row, (events, done));
            write(row.steps.state(), lane, &mut self.end);
        }
        if changed {
            self.sum_up(list);
        }
    }

    /// Takes back a row that was stepped as a scalar instance, and has had so many events before; whether its mode has changed.
    fn take_back(&mut self, lane: usize, row: &mut Row, (events, done): (u64, Result<(), Error>)) -> bool {
        match done {
            Err(fault) => {
                self.stop(lane, row, fault);
                true
            }
            Ok(()) if row.steps.events() != events => {
                self.enter(lane, row);
                true
            }
            Ok(()) => false,
        }
    }

    pub(crate) fn stop(&mut self, lane: usize, row: &mut Row, fault: Error) {
        row.stop(fault);
        self.lives.put(lane, 0.0);
        self.goes.put(lane, 0.0);
        self.looks[lane] = false;
    }

    /// Sets where the rows go that are on the way to `until` in s.
    fn set_goals(&self, work: &mut Workspace<W>, rows: &[Row], until: f64) {
        for lane in 0..W::LANES {
            let next = rows.get(lane).map_or(f64::INFINITY, |row| row.next);
            work.from[lane] = self.time;
            work.goal[lane] = until.min(next).max(self.time);
        }
        work.arrived.fill(false);
    }

    /// Passes what is due where the rows have come to; those that have not kept their mode continue as scalar instances. Whether
    /// enough rows have not come to `until` in s to go on side by side.
    #[inline(never)]
    fn pass_goals(&mut self, work: &mut Workspace<W>, rows: &mut BlockRows<'_>, come: W, until: f64) -> bool {
        let mut left = 0;
        let Workspace { from, goal, arrived, row: own, .. } = work;
        let BlockRows { list, desk } = rows;
        for (lane, row) in list.iter_mut().enumerate() {
            if arrived[lane] || !row.is_alive() {
                continue;
            }
            let events = row.steps.events();
            let done = if come.lane(lane) == KEEPS && !self.looks[lane] {
                read(&self.end, lane, own);
                write(own, lane, &mut self.state);
                from[lane] = goal[lane];
                if !is_due(row.next, until) {
                    arrived[lane] = true;
                    continue;
                }
                self.put(lane, row, desk, goal[lane]);
                desk.visit(&mut row.steps, |steps| steps.pass_on_the_way(until))
            } else {
                self.put(lane, row, desk, from[lane]);
                desk.visit(&mut row.steps, |steps| steps.advance_to(until))
            };
            self.take_back(lane, row, (events, done));
            write(row.steps.state(), lane, &mut self.state);
            arrived[lane] = row.steps.time() >= until && !is_due(row.next, until);
            left += usize::from(!arrived[lane] && row.is_alive());
        }
        let is_together = left >= W::FEW;
        for (lane, row) in list.iter_mut().enumerate() {
            if arrived[lane] || !row.is_alive() {
                continue;
            }
            if is_together {
                goal[lane] = until.min(row.next).max(from[lane]);
                continue;
            }
            let events = row.steps.events();
            let done = desk.visit(&mut row.steps, |steps| steps.advance_to(until));
            self.take_back(lane, row, (events, done));
            write(row.steps.state(), lane, &mut self.state);
        }
        self.sum_up(list);
        is_together
    }

    /// Enters rows that have changed, lays out pulses and looks up instants.
    #[inline(never)]
    fn set_out(&mut self, rows: &mut BlockRows<'_>, span: &Span<'_>) {
        let until = span.until();
        let all = self.known_until < until;
        if all {
            self.known_until = until + SPANS_AHEAD * (until - span.from);
        }
        let mut changed = false;
        let BlockRows { list, desk } = rows;
        for (lane, row) in list.iter_mut().enumerate() {
            let pulses = !is_due(until, row.edge);
            if !row.is_alive() || !(all || pulses || row.change != Change::None) {
                continue;
            }
            changed = true;
            if pulses || row.change != Change::None {
                self.bring(lane, row, desk);
                if let Err(fault) = row.steps.lay_out(until) {
                    self.stop(lane, row, fault);
                    continue;
                }
            }
            if row.change == Change::All {
                write(row.steps.state(), lane, &mut self.state);
                self.lives.put(lane, 1.0);
                self.enter(lane, row);
            } else {
                row.look_ahead(self.known_until);
            }
            row.change = Change::None;
        }
        if changed {
            self.sum_up(list);
        }
    }

    /// Enters the mode of a row.
    pub(crate) fn enter(&mut self, lane: usize, row: &mut Row) {
        let Row { steps, .. } = row;
        let (system, mode, guards) = steps.watched();
        self.looks[lane] = !self.watch.enter(lane, (system, mode), guards, &self.hosts);
        self.held.enter(lane, &system.plant, mode, self.origin);
        self.goes.put(lane, if held::covers_mode(mode) { 1.0 } else { 0.0 });
        for (content, its) in self.contents.iter_mut().zip(&mode.actuators) {
            content.put(lane, its.isothermal.unwrap_or(0.0));
        }
        row.look_ahead(self.known_until);
        self.is_changed = true;
    }

    /// Counts the times of lanes from another origin in s.
    #[inline(never)]
    fn count_times_from(&mut self, rows: &mut BlockRows<'_>, origin: f64) {
        self.origin = origin;
        let BlockRows { list, desk } = rows;
        for (lane, row) in list.iter_mut().enumerate() {
            if row.is_alive() {
                self.bring(lane, row, desk);
                self.enter(lane, row);
            }
        }
        self.sum_up(list);
    }

    pub(crate) fn sum_up(&mut self, rows: &[Row]) {
        self.any_looks = self.looks.contains(&true);
        self.soonest = rows.iter().filter(|row| row.is_alive()).map(|row| row.next).fold(f64::INFINITY, f64::min);
    }
}

/// Where each row is, how long its step is and where it ends, in s, of times that are counted from an origin.
#[inline(always)]
fn spans<W: Wide>(from: &[f64], goal: &[f64], origin: f64) -> [W; 3] {
    [
        W::from_lanes(|lane| from[lane] - origin),
        W::from_lanes(|lane| goal[lane] - from[lane]),
        W::from_lanes(|lane| goal[lane] - origin),
    ]
}

/// Reads the numbers of a lane.
pub(crate) fn read<W: Wide>(lanes: &[W], lane: usize, numbers: &mut [f64]) {
    for (number, of_lanes) in numbers.iter_mut().zip(lanes) {
        *number = of_lanes.lane(lane);
    }
}

/// Writes the numbers of a lane.
pub(crate) fn write<W: Wide>(numbers: &[f64], lane: usize, lanes: &mut [W]) {
    for (number, of_lanes) in numbers.iter().zip(lanes) {
        of_lanes.put(lane, *number);
    }
}
