//! Batches: many rigs, each with its own parameters, command and start, stepped together by the fixed-step engine.
//!
//! ```
//! # fn main() -> Result<(), mckibben::Error> {
//! use mckibben::batch::{Batch, Row};
//! use mckibben::simulation::Method;
//! # use mckibben::simulation::{Initial, InitialLength, Rig};
//! # use mckibben::{Actuator, Braid, GaugePressure, air, force, friction, load};
//! # let rig = |mass: f64| -> Result<Rig, mckibben::Error> {
//! #     let braid = Braid::new(0.11, 2.5)?;
//! #     let limits = force::LengthLimits::new(&braid, None, 0.098, 1.75e5, 100.0)?;
//! #     let law = force::Effective { law: force::IdealBraid { braid }, effectiveness: force::Effectiveness::constant(1.0)? };
//! #     let air = air::Air::standard(air::Process::Isentropic)?;
//! #     let actuator = Actuator::new(law, limits, friction::Friction::new(3.5, 1e-4)?, 3e-6, air)?;
//! #     Rig::new(actuator, None, load::Load::hanging_mass(mass, 9.80665)?)
//! # };
//! # let start = |rig: &Rig| rig.start(&Initial {
//! #     gauge_pressure: GaugePressure(4e5), temperature: 293.15, length: InitialLength::At(0.09), velocity: 0.0 });
//! let mut rows = Vec::new();
//! for mass in [1.0, 2.0, 5.0] {
//!     let rig = rig(mass)?;
//!     let start = start(&rig)?;
//!     rows.push(Row { rig, start });
//! }
//! let mut batch: Batch = Batch::new(rows, Method::Rk4);
//! batch.advance(0.1, 1000); // to 0.1 s in steps of 0.1 ms
//! for sample in batch.samples() {
//!     println!("{} m", sample?.length);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! It is the physics of every other engine, over a vector of rows for its scalar: as many rows in a block as two registers
//! of this machine have lanes. Blocks share nothing, so they are stepped on all cores; a step allocates nothing. The
//! instructions are chosen when the program runs ([`Width`]).
//!
//! What holds for row i of any batch:
//!
//! - it is the fixed-step engine's run ([`FixedStepper`](crate::simulation::FixedStepper)), bit for bit: whatever the
//!   number of rows, its place among them, the number of threads, and the width of the instructions. In `f32` it is the
//!   same method with states and parameters rounded to `f32`, and time to `f64`;
//! - when it leaves the physics it has an error of its own from then on, and touches no other row.
//!
//! A row may have a controller of its own ([`Batch::controlled`]): it is asked by itself at its sampling instants, and between
//! them the rows go together as any others do.
//!
//! What the valve of a row is to do may come from outside at any time ([`Batch::tell`]), and a row may begin anew with other
//! numbers while the rest go on ([`Batch::restart`]), as in an environment for learning.
//!
//! What no lane takes goes row by row, on all cores too: in a batch a rig with a tendon in series, always in `f64`; joints, legs
//! and whatever else is a [`Stepper`](crate::simulation::Stepper) in a batch of their own kind, [`RowByRow`].
//!
//! Checked by `tests/batch.rs`, `tests/batch_control.rs`, `tests/told.rs` and `tests/row_by_row.rs`.

mod alone;
mod baseline;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod block;
mod engine;
mod gather;
mod lane;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod member;
mod row_by_row;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod rows;
mod span;

pub use crate::lanes::Width;
pub use row_by_row::RowByRow;

use crate::control::{Controller, Sampling, Sensors};
use crate::error::Error;
use crate::plant::NO_ROW;
use crate::simulation::closed_loop::own_loop;
use crate::simulation::{ControlledStepper, Decision, Method, Rig, Sample, State, ToldStepper};
use crate::valve::Demand;
use alloc::boxed::Box;
use alloc::vec::Vec;
use alone::Alone;
use core::fmt::Debug;
use core::marker::PhantomData;
use engine::{Engine, Show};
use lane::OTHER_FORM;
use span::Span;

/// A rig and its start.
#[derive(Clone, Debug)]
pub struct Row {
    /// The actuator, what drives its valve, and its load.
    pub rig: Rig,
    /// The state at t = 0.
    pub start: State,
}

/// A rig, its start, and the controller that takes the place of its command.
#[derive(Clone, Debug)]
pub struct ControlledRow<C> {
    /// The actuator, its valve and its load.
    pub rig: Rig,
    /// The state at t = 0.
    pub start: State,
    /// The controller.
    pub controller: C,
    /// When it samples, and when what it decides takes effect.
    pub sampling: Sampling,
    /// What it sees with.
    pub sensors: Sensors,
}

/// Many rows, stepped together in numbers of `F`: `f64` or `f32`.
#[derive(Debug)]
pub struct Batch<F: Float = f64> {
    width: Width,
    method: Method,
    time: f64,
    blocks: Box<dyn Engine>,
    alone: RowByRow<Box<dyn Alone>>,
    places: Vec<Place>,
    /// The rows of each block, lane by lane, and those that go by themselves.
    members: Vec<Vec<usize>>,
    loners: Vec<usize>,
    /// Whether lane after lane, and block after block, lies row after row, so that places in a list of all rows can be dealt
    /// to the blocks.
    in_order: bool,
    number: PhantomData<F>,
}

/// Where a row is.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// In a block, in a lane of it.
    Lane(usize, usize),
    /// By itself.
    Alone(usize),
}

impl<F: Float> Batch<F> {
    /// A batch at t = 0 with the widest instructions of this machine.
    pub fn new(rows: Vec<Row>, method: Method) -> Self {
        Self::with_width(rows, method, Width::widest())
    }

    /// A batch at t = 0 with given instructions; where the machine has not got them, others with the same results.
    pub fn with_width(rows: Vec<Row>, method: Method, width: Width) -> Self {
        let on_tendon = rows.iter().filter(|row| row.rig.tendon().is_some()).cloned();
        let alone =
            on_tendon.map(|row| Box::new(ToldStepper::new(row.rig, row.start, method)) as Box<dyn Alone>).collect();
        Self::of(&rows, alone, method, width)
    }

    /// Rows, of which those that go by themselves are given.
    fn of(rows: &[Row], alone: Vec<Box<dyn Alone>>, method: Method, width: Width) -> Self {
        let (mut places, mut members) = (Vec::new(), Vec::new());
        let mut in_order = false;
        let mut deal = |lanes: usize| {
            (places, members) = arrange(rows, lanes);
            in_order = members.iter().flatten().copied().eq(0..rows.len())
                && members.iter().rev().skip(1).all(|block| block.len() == lanes);
            members.clone()
        };
        let blocks = F::build(rows, &mut deal, method, width);
        let alone = RowByRow::at(0.0, alone);
        let is_alone = |(row, place): (usize, &Place)| matches!(place, Place::Alone(_)).then_some(row);
        let loners = places.iter().enumerate().filter_map(is_alone).collect();
        let width = width.or_widest();
        Self { width, method, time: 0.0, blocks, alone, places, members, loners, in_order, number: PhantomData }
    }

    /// A batch at t = 0 whose rows have a controller each, with the widest instructions of this machine. Each row is the run of
    /// [`ControlledStepper`], bit for bit.
    ///
    /// # Errors
    /// [`Error::Misuse`] when a rig has no valve, or one without seats.
    pub fn controlled<C>(rows: Vec<ControlledRow<C>>, method: Method) -> Result<Self, Error>
    where
        C: Controller<Memory: Send + Sync> + Debug + Send + Sync + 'static,
    {
        Self::controlled_with_width(rows, method, Width::widest())
    }

    /// The same with given instructions; where the machine has not got them, others with the same results.
    ///
    /// # Errors
    /// As [`Batch::controlled`].
    pub fn controlled_with_width<C>(rows: Vec<ControlledRow<C>>, method: Method, width: Width) -> Result<Self, Error>
    where
        C: Controller<Memory: Send + Sync> + Debug + Send + Sync + 'static,
    {
        let (mut loops, mut alone, mut faults) = (Vec::with_capacity(rows.len()), Vec::new(), Vec::new());
        let mut plain = Vec::with_capacity(rows.len());
        for ControlledRow { rig, start, controller, sampling, sensors } in rows {
            if rig.tendon().is_some() {
                let mut stepper = ControlledStepper::begin(&rig, start, method, controller, (sampling, sensors))?;
                faults.extend(stepper.take_due().err().map(|fault| (alone.len(), fault)));
                alone.push(Box::new(stepper) as Box<dyn Alone>);
                loops.push(None);
                plain.push(Row { rig, start });
            } else {
                let (control, rig) = own_loop(&rig, controller, (sampling, sensors))?;
                loops.push(Some(control));
                plain.push(Row { rig, start });
            }
        }
        let mut batch = Self::of(&plain, alone, method, width);
        for (place, control) in batch.places.iter().zip(loops) {
            if let (Place::Lane(block, lane), Some(control)) = (*place, control) {
                batch.blocks.control(block, lane, control);
            }
        }
        faults.into_iter().for_each(|(row, fault)| batch.alone.stop(row, fault));
        Ok(batch)
    }

    /// What the controller of a row has decided, in order of time; nothing of a row that has none.
    pub fn decisions(&self, row: usize) -> &[Decision] {
        match self.places.get(row) {
            Some(Place::Lane(block, lane)) => self.blocks.decisions(*block, *lane),
            Some(Place::Alone(row)) => self.alone.row(*row).map_or(&[], |row| row.decisions()),
            None => &[],
        }
    }

    /// From the time that has been reached on a row's valve is asked for this, in place of whatever was to come: a
    /// [`Request`](crate::valve::Request) as it is, or any other [`Demand`]. It takes effect through the valve's delays, exactly
    /// as a command at that instant would have done; seats that move at once are seen to have moved after the next step.
    /// Memory does not grow with what is told.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no such row, when it has no valve or a controller, or its valve cannot do what is
    /// asked; [`Error::OutOfRange`] for a number outside its range; what [`Batch::samples`] says of a row that has stopped.
    /// Then nothing has changed.
    pub fn tell(&mut self, row: usize, demand: impl Into<Demand>) -> Result<(), Error> {
        match self.place(row)? {
            Place::Lane(block, lane) => self.blocks.tell(block, lane, demand.into()),
            Place::Alone(row) => self.alone.running(row)?.tell(demand.into()),
        }
    }

    /// Another rig and start in the place of a row, at the time that has been reached: of the old one nothing is left, and if it
    /// had stopped the row lives again. The time of the batch goes on. Nothing is asked of the valve until it is told something:
    /// the rig's own command does not count.
    ///
    /// # Errors
    /// [`Error::Misuse`] when there is no such row, or it has a controller; for a rig of another form than the row's, with
    /// other laws or parts than it had, which no numbers make of it; for a load or a pressure that is given over time. Then
    /// nothing has changed.
    pub fn restart(&mut self, row: usize, anew: Row) -> Result<(), Error> {
        match self.place(row)? {
            Place::Lane(block, lane) => self.blocks.restart(block, &[(lane, &anew)]),
            Place::Alone(row) if anew.rig.tendon().is_some() => {
                let Some(alone) = self.alone.row(row) else { return Err(NO_ROW) };
                let alone = alone.anew(self.time, anew, self.method)?;
                self.alone.restart(row, alone)
            }
            Place::Alone(_) => Err(OTHER_FORM),
        }
    }

    /// The same of many rows, on all cores: where they lie together it costs little more than one of them.
    ///
    /// # Errors
    /// As [`Batch::restart`], of any row that cannot begin anew; others may have.
    pub fn restart_all(&mut self, rows: Vec<(usize, Row)>) -> Result<(), Error> {
        let mut of_blocks: Vec<Vec<(usize, &Row)>> = self.members.iter().map(|_| Vec::new()).collect();
        let mut alone = Vec::new();
        for (row, anew) in &rows {
            match self.place(*row)? {
                Place::Lane(block, lane) => of_blocks[block].push((lane, anew)),
                Place::Alone(_) => alone.push((*row, anew.clone())),
            }
        }
        self.blocks.restart_all(&of_blocks)?;
        alone.into_iter().try_for_each(|(row, anew)| self.restart(row, anew))
    }

    /// Where a row is now, or why it has stopped: of its [`Sample`] what costs nothing.
    ///
    /// # Errors
    /// As [`Batch::samples`]; [`Error::Misuse`] when there is no such row.
    pub fn state(&self, row: usize) -> Result<State, &Error> {
        match self.places.get(row) {
            Some(Place::Lane(block, lane)) => self.blocks.state(*block, *lane),
            Some(Place::Alone(row)) => self.alone.alive(*row).map(|row| row.state()),
            None => Err(&NO_ROW),
        }
    }

    fn place(&self, row: usize) -> Result<Place, Error> {
        self.places.get(row).copied().ok_or(NO_ROW)
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

    /// Takes every living row to `until` (s) in `steps` equal steps, each divided where something switches in the row.
    /// Does nothing when `until` is not later than now or there are no steps.
    pub fn advance(&mut self, until: f64, steps: u64) {
        if steps > 0 && until > self.time && until.is_finite() {
            self.blocks.advance(Span { from: self.time, until, steps });
            self.alone.advance(until, steps);
            self.time = until;
        }
    }

    /// [`Batch::tell`], [`Batch::advance`] and [`Batch::state`] of all rows in one, on all cores, as who drives many rows from
    /// outside wants it span by span: each row is told what is asked of it by its number, if anything, goes on to `until` (s) in
    /// `steps` equal steps, and `shown` is where it is then: length (m), velocity (m/s), absolute pressure (Pa), mass of the air
    /// (kg). With `steps` of zero, or `until` not later than now, rows are told and shown without going on.
    ///
    /// A row whose valve cannot do what is asked stops with that error. Of rows that have stopped, `stopped` is true and `shown`
    /// stays as it is; [`Batch::state`] says why.
    ///
    /// # Errors
    /// [`Error::Misuse`] when `shown` or `stopped` has not one entry for each row. Then nothing has changed.
    pub fn go(
        &mut self,
        until: f64,
        steps: u64,
        demand: impl Fn(usize) -> Option<Demand> + Sync,
        (shown, stopped): (&mut [[f64; 4]], &mut [bool]),
    ) -> Result<(), Error> {
        if shown.len() != self.len() || stopped.len() != self.len() {
            return Err(Error::Misuse {
                what: "the states of a batch are asked for in a place that has not as many entries as there are rows",
                remedy: "give as many entries as rows",
            });
        }
        let until = if steps > 0 && until > self.time && until.is_finite() { until } else { self.time };
        let span = Span { from: self.time, until, steps: if until > self.time { steps } else { 0 } };
        let Self { blocks, alone, members, loners, in_order, .. } = self;
        let show = in_order.then_some(Show { states: &mut *shown, stopped: &mut *stopped });
        blocks.go(span, &|block, lane| demand(members[block][lane]), show);
        alone.for_each_living(|row, stepper| demand(loners[row]).map_or(Ok(()), |demand| stepper.tell(demand)));
        alone.advance(span.until, span.steps);
        self.time = until;
        if !self.in_order {
            Show { states: shown, stopped }.where_are(|row| self.state(row));
        }
        Ok(())
    }

    /// What every row shows now, or why it has stopped, in the order of the rows.
    ///
    /// # Errors
    /// Each row's own: [`Error::Stopped`] when a step has led it out of the physics, others where a controller asked what
    /// cannot be.
    pub fn samples(&self) -> Vec<Result<Sample, Error>> {
        let (in_lanes, alone) = (self.blocks.samples(), self.alone.samples());
        let sample = |place: &Place| match *place {
            Place::Lane(block, lane) => in_lanes[block][lane].clone(),
            Place::Alone(row) => alone[row].clone(),
        };
        self.places.iter().map(sample).collect()
    }
}

/// Sorts rows into blocks of the same form: the place of each row, and the rows of each block. Those on a tendon are in none.
fn arrange(rows: &[Row], lanes: usize) -> (Vec<Place>, Vec<Vec<usize>>) {
    let mut open: Vec<(Rig, usize)> = Vec::new();
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut places = Vec::with_capacity(rows.len());
    let mut alone = 0..;
    for (row, Row { rig, .. }) in rows.iter().enumerate() {
        if rig.tendon().is_some() {
            places.extend(alone.next().map(Place::Alone));
            continue;
        }
        let form = gather::form(rig);
        let known = open.iter().position(|(known, _)| *known == form);
        let known = known.unwrap_or_else(|| {
            open.push((form, usize::MAX));
            open.len() - 1
        });
        let block = &mut open[known].1;
        if blocks.get(*block).is_none_or(|rows| rows.len() == lanes) {
            *block = blocks.len();
            blocks.push(Vec::with_capacity(lanes));
        }
        places.push(Place::Lane(*block, blocks[*block].len()));
        blocks[*block].push(row);
    }
    (places, blocks)
}

/// A number that batches are made of: `f64`, or `f32` with the feature `batch-single`.
pub trait Float: engine::Build {}

impl Float for f64 {}
#[cfg(feature = "batch-single")]
impl Float for f32 {}
