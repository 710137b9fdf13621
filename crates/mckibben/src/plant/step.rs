//! A run of a plant as it is made: each accepted step goes to a consumer, and nothing is kept.
//!
//! A step gives every sample within it, by dense output, and the event that ended it. What a consumer reads on the way is what a
//! kept trajectory gives, bit by bit.
//!
//! Checked by `tests/plant_stream.rs`.

use super::Plant;
use super::bookkeeping::GAUSS;
use super::crossing::PlantEventKind;
use super::mode::PlantMode;
use super::sample::{Observer, PlantSample};
use super::trajectory::{PieceView, PlantEvent};
use crate::engine::arc;
use crate::error::Error;
use crate::scalar::Real;
use crate::valve::SIMULTANEOUS;
use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::cell::RefCell;

/// Takes each accepted step of a plant's run in order of time; its error ends the run.
pub type PlantConsumer<'c, R = f64> = dyn FnMut(&PlantStep<'_, '_, R>) -> Result<(), Error> + 'c;

/// Room in which samples are computed.
#[derive(Debug)]
struct Work<'a, R: Real> {
    observer: Observer<'a, R>,
    state: Vec<R>,
    sample: PlantSample<R>,
}

/// The plant of a run with room to read samples of its steps.
#[derive(Debug)]
pub(crate) struct StepReading<'a, R: Real> {
    plant: &'a Plant<R>,
    relative_tolerance: f64,
    work: RefCell<Option<Box<Work<'a, R>>>>,
}

impl<'a, R: Real> StepReading<'a, R> {
    pub(crate) fn new(plant: &'a Plant<R>, relative_tolerance: f64) -> Self {
        Self { plant, relative_tolerance, work: RefCell::new(None) }
    }

    /// Does something with room to compute samples in. A sample may be read while another one is looked at, which then has
    /// room of its own.
    fn with<T>(&self, read: impl FnOnce(&mut Work<'a, R>) -> T) -> T {
        let taken = self.work.take();
        let mut work = taken.unwrap_or_else(|| {
            let observer = Observer::new(self.plant, self.relative_tolerance);
            let (state, sample) = (vec![R::zero(); self.plant.places().states], PlantSample::new(self.plant));
            Box::new(Work { observer, state, sample })
        });
        let result = read(&mut work);
        self.work.replace(Some(work));
        result
    }
}

impl<R: Real> Work<'_, R> {
    /// The sample at a time in s within a step.
    fn read(&mut self, view: &PieceView<'_, R>, time: R) -> &PlantSample<R> {
        let Self { observer, state, sample } = self;
        arc::at(view.points, (time - view.start) / view.step, state);
        observer.system.project(time, state, view.mode, &mut observer.at);
        observer.observe(time, state, view.mode, sample);
        sample
    }
}

/// An accepted step of a plant's run: every sample within it, by dense output, and the event that ended it.
#[derive(Debug)]
pub struct PlantStep<'s, 'p, R: Real = f64> {
    view: PieceView<'s, R>,
    event: Option<(PlantEventKind, &'s PlantMode<R>)>,
    reading: &'s StepReading<'p, R>,
}

impl<'s, 'p, R: Real> PlantStep<'s, 'p, R> {
    pub(crate) fn new(
        view: PieceView<'s, R>,
        event: Option<(PlantEventKind, &'s PlantMode<R>)>,
        reading: &'s StepReading<'p, R>,
    ) -> Self {
        Self { view, event, reading }
    }

    pub(crate) fn view(&self) -> PieceView<'_, R> {
        self.view
    }

    /// The plant. Valves that a driver has have their own commands here, and not what it asked for.
    pub fn plant(&self) -> &Plant<R> {
        self.reading.plant
    }

    /// Start of the step in s.
    pub fn start(&self) -> R {
        self.view.start
    }

    /// End of the step in s.
    pub fn end(&self) -> R {
        self.view.end
    }

    /// The mode throughout the step.
    pub fn mode(&self) -> &PlantMode<R> {
        self.view.mode
    }

    /// The event that ended the step, if one did, and the mode after it.
    pub fn event(&self) -> Option<(PlantEvent<R>, &PlantMode<R>)> {
        self.event.map(|(kind, after)| (PlantEvent { time: self.view.end, kind }, after))
    }

    /// Whether the step holds what a trajectory gives at a time in s that no earlier step holds: the next one begins later.
    /// The last step holds no sample at the end of the run: that is what the run has reached.
    pub fn holds(&self, time: f64) -> bool {
        time * (1.0 + SIMULTANEOUS) < self.view.end.value()
    }

    /// The sample at `time` in s, kept within the step.
    pub fn at(&self, time: R) -> PlantSample<R> {
        let PieceView { start, end, .. } = self.view;
        let time = R::constant(time.value().clamp(start.value(), end.value().max(start.value())));
        self.reading.with(|work| work.read(&self.view, time).clone())
    }

    /// Calls `visit` with the weight in s and the sample at the Gauss points of the step: `Σ weight · f` over all steps is the
    /// integral of f over the run, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &PlantSample<R>)) {
        let length = self.view.end - self.view.start;
        if length.value() <= 0.0 {
            return;
        }
        self.reading.with(|work| {
            for (node, weight) in GAUSS {
                let time = self.view.start + length * R::constant(node);
                visit(length * R::constant(weight), work.read(&self.view, time));
            }
        });
    }
}
