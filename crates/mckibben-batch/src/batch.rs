//! Rows, dealt to blocks of equal structure, and their way through time on all cores.

mod reading;

use crate::block;
use crate::group::{Arranged, Group, arrange};
use crate::held;
use crate::precision::Precision;
use crate::row::{Change, Row};
use crate::span::Span;
use crate::width::Width;
use mckibben::internals::{check_longest_part, check_move, part_end, parts_of};
use mckibben::plant::{Plant, PlantRow, PlantSteps};
use mckibben::valve::RuntimeCommand;
use mckibben::{Error, parameter};
use rayon::prelude::*;

/// How long work must take in ns for other threads to share it: a good deal longer than to wake them.
const WAKES: f64 = 8e4;
/// About how long a row takes in ns, for each of its states: to step, to answer, to be set.
const STEP: f64 = 25.0;
const ANSWER: f64 = 10.0;
const SETTING: f64 = 5.0;

/// Plants that are stepped together.
///
/// ```
/// use mckibben::plant::{Plant, PlantRow, PlantRun, PlantStart};
/// use mckibben_batch::PlantBatch;
/// use mckibben::simulation::Method;
/// use mckibben::valve::Request;
///
/// # fn learns(plants: &[Plant], start: &PlantStart) -> Result<(), mckibben::Error> {
/// let begin = |plant| Ok(PlantRun::new(plant, start, 1e-6)?.row(Method::Stable));
/// let rows: Vec<PlantRow> = plants.iter().map(begin).collect::<Result<_, mckibben::Error>>()?;
/// let mut batch = PlantBatch::new(rows)?;
/// for count in 1..=1000 {
///     for row in 0..batch.len() {
///         let fill = batch.row(row)?.state()[0] > 0.09;
///         batch.set(row, 0, if fill { Request::Fill } else { Request::Exhaust })?;
///     }
///     batch.advance_to(f64::from(count) * 1e-3)?;
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct PlantBatch {
    width: Width,
    precision: Precision,
    time: f64,
    groups: Vec<Group>,
    /// The group of each row, and its lane there.
    places: Vec<[usize; 2]>,
    /// How many coordinates of all rows a host moves.
    coordinates: usize,
    /// The longest part of a move in s; infinite where moves are not divided.
    longest_part: f64,
    /// Edges of pulses in a second that a row has been set to, at most.
    edges: f64,
    /// The ends of the parts of a move.
    ends: Vec<f64>,
    /// Whether the caller's own thread does all.
    keeps_to_thread: bool,
}

/// An element is reset with a plant that does not fit the others.
const OTHER_STRUCTURE: Error = Error::Misuse {
    what: "an element of a batch is reset with a plant of another structure: with other parts or laws",
    remedy: "give it a plant that differs in numbers alone, or make another batch for plants of that structure",
};

impl PlantBatch {
    /// A batch of plants that have reached the same time and are stepped by the same method, with the widest instructions of
    /// this machine. They are taken one by one: from an iterator that begins each when it is asked for it, no more memory is needed
    /// than that of the batch.
    ///
    /// # Errors
    /// [`Error::Misuse`] where times or methods differ.
    pub fn new(rows: impl IntoIterator<Item: Into<PlantRow>>) -> Result<Self, Error> {
        Self::with_precision(rows, Precision::Double)
    }

    /// A batch as in [`PlantBatch::new`], whose lanes hold numbers of a precision.
    ///
    /// # Errors
    /// As [`PlantBatch::new`], and [`Error::Misuse`] where this program is built without that precision.
    pub fn with_precision(rows: impl IntoIterator<Item: Into<PlantRow>>, precision: Precision) -> Result<Self, Error> {
        Self::with_lanes(rows, Width::widest(), precision)
    }

    /// A batch with given instructions and numbers. Where the machine has not got the instructions, others do the work; rows that are
    /// stepped individually are in double precision.
    ///
    /// # Errors
    /// As [`PlantBatch::with_precision`].
    pub fn with_lanes(
        rows: impl IntoIterator<Item: Into<PlantRow>>,
        width: Width,
        precision: Precision,
    ) -> Result<Self, Error> {
        Self::of(&mut rows.into_iter().map(Into::into), width, precision)
    }

    fn of(rows: &mut dyn Iterator<Item = PlantRow>, width: Width, precision: Precision) -> Result<Self, Error> {
        precision.check()?;
        let width = width.or_widest();
        let Arranged { groups, places, coordinates } = arrange(rows, width, precision)?;
        let time = groups.first().map_or(0.0, |group| group.rows.list[0].steps.time());
        let rows = groups.iter().flat_map(|group| &group.rows.list);
        let edges = rows.map(|row| row.steps.edge_rate()).fold(0.0, f64::max);
        let (longest_part, ends) = (f64::INFINITY, Vec::new());
        let keeps_to_thread = false;
        Ok(Self { width, precision, time, groups, places, coordinates, longest_part, edges, ends, keeps_to_thread })
    }

    /// Puts other rows in the place of all: all at one time and stepped by one method. Precision, instructions, threads and the
    /// parts of moves stay.
    ///
    /// # Errors
    /// As [`PlantBatch::new`]. Then nothing has changed.
    pub fn replace(&mut self, rows: impl IntoIterator<Item: Into<PlantRow>>) -> Result<(), Error> {
        let (longest_part, keeps_to_thread) = (self.longest_part, self.keeps_to_thread);
        *self = Self { longest_part, keeps_to_thread, ..Self::with_lanes(rows, self.width, self.precision)? };
        Ok(())
    }

    /// Does something with every plant where it is, given its number; those that have stopped go on from where they were last well.
    /// Afterwards all are at one time again, which may be another.
    ///
    /// # Errors
    /// The first that this meets, and as [`PlantBatch::new`]. Then nothing has changed.
    pub fn change<E: From<Error>>(
        &mut self,
        mut does: impl FnMut(usize, &mut PlantSteps) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut rows = Vec::with_capacity(self.len());
        for (index, &[group, lane]) in self.places.iter().enumerate() {
            let group = &mut self.groups[group];
            let mut row = group.bring(lane).steps.clone();
            group.rows.desk.visit(&mut row, |steps| does(index, steps))?;
            rows.push(*row);
        }
        Ok(self.replace(rows)?)
    }

    /// Whether plants of a structure go side by side. Left out are tendons of actuators whose dry friction falls with velocity: such
    /// plants are stepped as scalar instances, with the same results.
    pub fn covers(plant: &Plant) -> bool {
        held::covers_structure(plant)
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The time in s that every living row has reached.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The instructions that are used.
    pub fn width(&self) -> Width {
        self.width
    }

    /// The numbers that lanes hold.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Whether the caller's own thread does all, also of many rows. Otherwise, as in a new batch, the threads of rayon's current
    /// pool share what takes much longer than to wake them.
    pub fn keep_to_thread(&mut self, keeps: bool) {
        self.keeps_to_thread = keeps;
    }

    /// Whether it does: see [`PlantBatch::keep_to_thread`].
    pub fn keeps_to_thread(&self) -> bool {
        self.keeps_to_thread
    }

    /// Whether so many steps of all rows take much longer than to wake other threads.
    pub fn is_much(&self, steps: usize) -> bool {
        self.takes(STEP) * steps as f64 > WAKES
    }

    /// About how long all rows take in ns, of which each takes so long for each state.
    fn takes(&self, each: f64) -> f64 {
        let states = self.groups.first().map_or(0, |group| group.rows.list[0].steps.state().len());
        each * (states * self.len()) as f64
    }

    /// What comes out of work of every group, which takes about `long` in ns for all, joined in any order.
    fn of_all<T: Clone + Send + Sync>(
        &mut self,
        long: f64,
        nothing: &T,
        work: impl Fn(&mut Group) -> T + Sync + Send,
        join: impl Fn(T, T) -> T + Sync + Send,
    ) -> T {
        let may_share = !self.keeps_to_thread && self.groups.len() > 1;
        let is_shared = may_share && long > WAKES && rayon::current_num_threads() > 1;
        if is_shared {
            self.groups.par_iter_mut().map(work).reduce(|| nothing.clone(), join)
        } else {
            self.groups.iter_mut().map(work).fold(nothing.clone(), join)
        }
    }

    /// Work of every group, which takes about `long` in ns for all.
    fn each(&mut self, long: f64, work: impl Fn(&mut Group) + Sync + Send) {
        self.of_all(long, &(), work, |(), ()| ());
    }

    /// The plant of a row, if there is such a row.
    pub fn plant(&self, row: usize) -> Option<&Plant> {
        let [group, lane] = self.place(row).ok()?;
        Some(self.groups[group].rows.list[lane].steps.plant())
    }

    /// Sets what a valve of a row does from now on, in place of all that was to come.
    ///
    /// # Errors
    /// As [`PlantSteps::set`] and [`PlantBatch::row`].
    pub fn set(&mut self, row: usize, valve: usize, command: impl Into<RuntimeCommand>) -> Result<(), Error> {
        let [group, lane] = self.place(row)?;
        self.edges = self.edges.max(self.groups[group].set(lane, valve, command.into())?);
        Ok(())
    }

    /// Sets what a valve of every living row does from now on, on all cores; rows for which there is no command go on as they are.
    ///
    /// # Errors
    /// The number of the first row whose valve does not take its command, which goes on as it is, as [`PlantBatch::set`] has it.
    pub fn set_each(
        &mut self,
        valve: usize,
        command: impl Fn(usize) -> Option<RuntimeCommand> + Sync,
    ) -> Result<(), (usize, Error)> {
        let set = |group: &mut Group| {
            let (mut edges, mut fault): (f64, Option<(usize, Error)>) = (0.0, None);
            for lane in 0..group.rows.list.len() {
                let index = group.rows.list[lane].index;
                match command(index).map(|command| group.set(lane, valve, command)) {
                    Some(Ok(its)) => edges = edges.max(its),
                    Some(Err(error)) if group.rows.list[lane].is_alive() => fault = fault.or(Some((index, error))),
                    Some(Err(_)) | None => {}
                }
            }
            (edges, fault)
        };
        let first = |one: (f64, Option<(usize, Error)>), other: (f64, Option<(usize, Error)>)| {
            let fault = match (one.1, other.1) {
                (Some(one), Some(other)) => Some(if one.0 < other.0 { one } else { other }),
                (one, other) => one.or(other),
            };
            (one.0.max(other.0), fault)
        };
        let (edges, fault) = self.of_all(self.takes(SETTING), &(0.0, None), set, first);
        self.edges = self.edges.max(edges);
        fault.map_or(Ok(()), Err)
    }

    /// Divides every move from now on into equal parts no longer than `longest` in s; infinity leaves moves whole.
    ///
    /// # Errors
    /// As [`PlantSteps::limit_step`].
    pub fn limit_step(&mut self, longest: f64) -> Result<(), Error> {
        check_longest_part(longest)?;
        self.longest_part = longest;
        Ok(())
    }

    /// Parts that a move to `until` in s takes, counted before they are taken, with the edges of the pulses of the row that has
    /// the most.
    pub fn parts_until(&self, until: f64) -> f64 {
        let span = until - self.time;
        parts_of(span, self.longest_part) as f64 + self.edges * span
    }

    /// The ends that a host moves go in straight lines to `distances` in m at `until` in s: one distance for each coordinate of
    /// each row, row after row. A row that cannot go on, or go there, stops, and touches no other.
    ///
    /// # Errors
    /// As [`PlantSteps::move_to`] for the time and for the number of distances; nothing has changed then.
    pub fn move_to(&mut self, until: f64, distances: &[f64]) -> Result<(), Error> {
        let span = until - self.time;
        check_move(span, || self.parts_until(until))?;
        self.check_count("distances", distances)?;
        let mut ends = std::mem::take(&mut self.ends);
        let parts = parts_of(span, self.longest_part);
        ends.clear();
        ends.extend((1..=parts).map(|part| part_end(self.time, span, (part, parts))));
        self.go(Span { from: self.time, ends: &ends, distances: Some(distances) });
        self.ends = ends;
        Ok(())
    }

    /// Computes what the actuators of every living row answer, with the ends that a host moves at `distances` in m and moving at
    /// `rates` in m/s: as [`PlantSteps::compute_at`]. [`PlantBatch::responses`] has them.
    ///
    /// # Errors
    /// As there; nothing has been computed then.
    pub fn compute_at(&mut self, distances: &[f64], rates: &[f64]) -> Result<(), Error> {
        self.check_count("distances", distances)?;
        self.check_count("rates", rates)?;
        distances.iter().try_for_each(|its| parameter::INITIAL_LENGTH.check(*its).map(drop))?;
        rates.iter().try_for_each(|its| parameter::INITIAL_VELOCITY.check(*its).map(drop))?;
        self.of_all(self.takes(ANSWER), &Ok(()), |group| group.compute_at([distances, rates]), Result::and)
    }

    /// That there is one number for each coordinate that a host moves.
    fn check_count(&self, name: &'static str, given: &[f64]) -> Result<(), Error> {
        if given.len() == self.coordinates {
            return Ok(());
        }
        Err(Error::Table {
            name,
            problem: "there is not one for each coordinate of the external mechanisms of all rows",
            entry: given.len().min(self.coordinates) + 1,
            remedy: "give as many as the external mechanisms of all rows have coordinates, row after row",
        })
    }

    /// Sets the rates (m/s or rad/s) of a mechanism of a row whose motion a host gives.
    ///
    /// # Errors
    /// As [`PlantSteps::set_rates`] and [`PlantBatch::row`].
    pub fn set_rates(&mut self, row: usize, mechanism: usize, rates: &[f64]) -> Result<(), Error> {
        let (row, desk) = self.living(row)?;
        row.changes(Change::All);
        desk.visit(&mut row.steps, |steps| steps.set_rates(mechanism, rates))
    }

    /// Another plant in the place of a row, which lives again if it had stopped.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no such row, for a plant of another structure, method or time. Then nothing has changed.
    pub fn restart(&mut self, row: usize, steps: impl Into<PlantRow>) -> Result<(), Error> {
        self.put(row, steps.into())
    }

    fn put(&mut self, row: usize, steps: PlantRow) -> Result<(), Error> {
        let [group, lane] = self.place(row)?;
        let Group { rows, lanes, commands, .. } = &mut self.groups[group];
        let old = &rows.list[lane].steps;
        if steps.time() != self.time || steps.method() != old.method() {
            return Err(Error::Misuse {
                what: "an element is reset at another time than the batch has reached, or with another method",
                remedy: "give it the time of the batch, and its method",
            });
        }
        let mut begun = Row::new(steps, row, rows.list[lane].coordinates.start);
        let is_same = begun.steps.share(old);
        if !is_same && block::structure(begun.steps.plant()) != block::structure(old.plant()) {
            return Err(OTHER_STRUCTURE);
        }
        let edges = begun.steps.edge_rate();
        rows.list[lane] = begun;
        commands.clear();
        self.edges = self.edges.max(edges);
        if let Some(lanes) = lanes {
            lanes.forget(lane);
            if !is_same {
                lanes.gather(lane, rows);
            }
        }
        Ok(())
    }

    /// Takes every living row to `until` in s in one step, divided where something switches in the row, on all cores. A row that
    /// cannot go on stops, and touches no other.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not finite. Nothing happens where `until` has been reached.
    pub fn advance_to(&mut self, until: f64) -> Result<(), Error> {
        self.advance(until, 1)
    }

    /// Takes every living row to `until` in s as [`PlantBatch::advance_to`] does, in so many equal steps.
    ///
    /// # Errors
    /// As [`PlantBatch::advance_to`]; nothing happens where there are no steps.
    pub fn advance(&mut self, until: f64, steps: u64) -> Result<(), Error> {
        if until <= self.time || steps == 0 {
            return Ok(());
        }
        let (from, length) = (self.time, until - self.time);
        let end = |step: u64| if step == steps { until } else { from + length * (step as f64 / steps as f64) };
        self.advance_through(&(1..=steps).map(end).collect::<Vec<f64>>())
    }

    /// Takes every living row as [`PlantBatch::advance_to`] does through steps that end at these times in s.
    ///
    /// # Errors
    /// As [`PlantBatch::advance_to`]; [`Error::Table`] where the times do not rise from the time that has been reached.
    pub fn advance_through(&mut self, ends: &[f64]) -> Result<(), Error> {
        let mut before = self.time;
        for (place, end) in ends.iter().enumerate() {
            parameter::DURATION.check(end - before)?;
            if *end <= before {
                return Err(Error::Table {
                    name: "ends",
                    problem: "the times at which steps end do not rise",
                    entry: place + 1,
                    remedy: "give rising times, all of them later than the time of the batch",
                });
            }
            before = *end;
        }
        self.go(Span { from: self.time, ends, distances: None });
        Ok(())
    }

    /// Takes every living row through a span.
    fn go(&mut self, span: Span<'_>) {
        self.each(self.takes(STEP) * span.ends.len() as f64, |group| group.advance(span));
        self.time = span.until();
    }
}
