//! A run of a plant that is read while it is made: each accepted step goes to a consumer and nothing is kept.
//!
//! Samples and the ledger are those that a kept [`PlantTrajectory`] gives, number for number.
//!
//! Checked by `tests/plant_stream.rs`.

use super::bookkeeping::{Bookkeeper, GAUSS};
use super::crossing::Part;
use super::ledger::PlantLedger;
use super::mode::PlantMode;
use super::run::PlantRun;
use super::sample::{Observer, PlantSample};
use super::steps::TimeStepping;
use super::trajectory::{PieceView, PlantTrajectory};
use super::{Plant, PlantEvent};
use crate::command::PlantDecision;
use crate::error::Error;
use crate::parameter;
use crate::simulation::Readable;
use crate::valve::SIMULTANEOUS;
use alloc::vec;
use alloc::vec::Vec;
use core::cell::RefCell;
use core::fmt;

/// Evaluates steps, with room that is used again.
struct Room {
    observer: Observer<f64>,
    state: Vec<f64>,
}

/// Reads steps of one plant, whatever that borrows.
trait ReadsSteps {
    fn plant(&self) -> &Plant;

    fn read_into(&self, view: PieceView<'_>, time: f64, sample: &mut PlantSample);
}

/// The plant is kept apart from what is borrowed while a step is read.
struct Shared<'p>(&'p Plant, RefCell<Room>);

impl ReadsSteps for Shared<'_> {
    fn plant(&self) -> &Plant {
        self.0
    }

    fn read_into(&self, view: PieceView<'_>, time: f64, sample: &mut PlantSample) {
        let Room { observer, state } = &mut *self.1.borrow_mut();
        let time = view.state(time, state);
        observer.read(time, state, view.mode, sample);
    }
}

/// An accepted step of a run of a plant: every sample within it, and the event that ended it.
pub struct PlantStep<'s> {
    view: PieceView<'s>,
    event: Option<PlantEvent>,
    after: Option<&'s PlantMode>,
    reads: &'s dyn ReadsSteps,
}

impl fmt::Debug for PlantStep<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { view, event, .. } = self;
        f.debug_struct("PlantStep").field("start", &view.start).field("end", &view.end).field("event", event).finish()
    }
}

/// Takes each accepted step of a run of a plant in order of time; its error ends the run.
pub type PlantConsumer<'c> = dyn FnMut(&PlantStep<'_>) -> Result<(), Error> + 'c;

impl PlantStep<'_> {
    /// Its start in s.
    pub fn start(&self) -> f64 {
        self.view.start
    }

    /// Its end in s, where the event is.
    pub fn end(&self) -> f64 {
        self.view.end
    }

    /// The discrete state within it.
    pub fn mode(&self) -> &PlantMode {
        self.view.mode
    }

    /// The event that ended it.
    pub fn event(&self) -> Option<&PlantEvent> {
        self.event.as_ref()
    }

    /// The discrete state after that event.
    pub fn mode_after(&self) -> Option<&PlantMode> {
        self.after
    }

    /// What a driver decided at its end, with the index of the driver.
    pub fn decision(&self) -> Option<(usize, &PlantDecision)> {
        let Part::Driver(driver) = self.event.as_ref()?.kind.part else { return None };
        Some((driver, self.after?.drivers.get(driver)?.last()?))
    }

    /// Writes the sample at a time in s, kept within the step, to `sample`, which was made for the same plant.
    pub fn read_into(&self, time: f64, sample: &mut PlantSample) {
        self.reads.read_into(self.view, time, sample);
    }
}

impl PlantStep<'_> {
    /// Calls `visit` with the weight in s and the sample at the Gauss points of the step: `Σ weight · f` over all steps is the
    /// integral of f over the run, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(f64, &PlantSample)) {
        let length = self.end() - self.start();
        if length <= 0.0 {
            return;
        }
        let mut sample = PlantSample::new(self.reads.plant());
        for (node, weight) in GAUSS {
            self.read_into(self.start() + length * node, &mut sample);
            visit(length * weight, &sample);
        }
    }
}

impl Readable for PlantStep<'_> {
    type Sample = PlantSample;

    fn holds(&self, time: f64) -> bool {
        self.view.end > time * (1.0 + SIMULTANEOUS)
    }

    fn read(&self, time: f64) -> PlantSample {
        let mut sample = PlantSample::new(self.reads.plant());
        self.read_into(time, &mut sample);
        sample
    }
}

impl PlantRun {
    /// Goes on to `until` in s and hands each accepted step to `consumer`; nothing is kept.
    ///
    /// # Errors
    /// As [`PlantRun::advance_to`], and those of the consumer, such as [`Error::Interrupted`].
    pub fn stream_to(&mut self, until: f64, consumer: &mut PlantConsumer<'_>) -> Result<(), Error> {
        parameter::DURATION.check(until)?;
        let plant = self.shared_plant().clone();
        let observer = Observer::new(&plant, self.stepping());
        let room = Room { observer, state: vec![0.0; plant.indices().states] };
        let reads = Shared(&plant, RefCell::new(room));
        let mut mode = self.mode().clone();
        self.extend(until, &mut |piece| {
            let (start, step, points) = (piece.arc.start, piece.arc.step, &piece.arc.points[..]);
            let view = PieceView { start, step, end: piece.end, points, mode: &mode };
            let event = piece.event.as_ref().map(|(kind, _)| PlantEvent { time: piece.end, kind: *kind });
            let after = piece.event.as_ref().map(|(_, after)| *after);
            consumer(&PlantStep { view, event, after, reads: &reads })?;
            if let Some(after) = after {
                mode.clone_from(after);
            }
            Ok(())
        })
    }

    /// The sample at the time that has been reached, after any event there.
    pub fn sample(&self) -> PlantSample {
        let mut sample = PlantSample::new(self.plant());
        let mut observer = Observer::new(self.shared_plant(), self.stepping());
        observer.read(self.time(), &mut self.state().to_vec(), self.mode(), &mut sample);
        sample
    }
}

impl PlantTrajectory {
    /// Hands the steps of the run to `consumer` as [`PlantRun::stream_to`] did or would.
    ///
    /// # Errors
    /// Those of the consumer.
    pub fn replay(&self, consumer: &mut PlantConsumer<'_>) -> Result<(), Error> {
        let plant = self.shared_plant();
        let observer = Observer::new(plant, self.stepping());
        let room = Room { observer, state: vec![0.0; plant.indices().states] };
        let reads = Shared(plant, RefCell::new(room));
        self.each_piece_with_event(|view, event| {
            let after = event.map(|(_, after)| after);
            consumer(&PlantStep { view, event: event.map(|(event, _)| event.clone()), after, reads: &reads })
        })
    }
}

/// Keeps the ledger of a run that is streamed.
#[derive(Debug)]
pub struct PlantLedgerKeeper<'p>(Bookkeeper<'p>);

impl<'p> PlantLedgerKeeper<'p> {
    /// Before the first step of a run of a plant that goes through time as said, for instance with a relative tolerance.
    pub fn new(plant: &'p Plant, stepping: impl Into<TimeStepping>) -> Self {
        Self(Bookkeeper::new(plant, stepping.into()))
    }

    /// Adds a step.
    pub fn step(&mut self, step: &PlantStep<'_>) {
        self.0.add(step.view);
    }

    /// The ledger of the run, which has come to its end.
    pub fn finish(self, run: &PlantRun) -> PlantLedger {
        self.0.finish(run.time(), run.state(), run.mode())
    }
}
