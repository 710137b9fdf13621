//! A plant between its steps: what it is and where it is, without what a step computes with.
//!
//! A batch keeps one for each row, and computes all rows of one structure with the memory of one [`PlantSteps`]. A row is then a
//! small part of what steps alone are, so that many rows stay in the cache.

use super::super::evaluation::System;
use super::super::guard::PlantGuard;
use super::super::run::PlantRun;
use super::super::run::PlantSnapshot;
use super::super::sample::PlantSample;
use super::super::{Plant, PlantMode};
use super::part::Course;
use super::{Method, NARROW, PlantSampler, PlantSteps};
use crate::engine::GuardForm;
use crate::error::Error;
use crate::instantiate::Instantiate;
use crate::valve::RuntimeCommand;
use alloc::boxed::Box;
use alloc::sync::Arc;

/// What is known of a plant between its steps: [`PlantSteps`] take it on.
#[derive(Clone, Debug)]
pub struct PlantRow<R: Instantiate = f64> {
    pub(super) system: Arc<System<R>>,
    pub(super) method: Method,
    pub(super) reached: PlantSnapshot<R>,
    pub(super) course: Course<R>,
    /// Where the steps began.
    pub(super) start: Arc<PlantSnapshot<R>>,
    /// In s; infinite where moves are not divided.
    pub(super) longest_part: f64,
}

impl<R: Instantiate> PlantRun<R> {
    /// A row of a batch, which begins where the run is and is stepped by a method; the run itself stays there.
    pub fn row(&self, method: Method) -> PlantRow<R> {
        R::begin_plant_row(self, method)
    }
}

impl<R: Instantiate> PlantRow<R> {
    pub(crate) fn generic_begin(run: &PlantRun<R>, method: Method) -> Self {
        let system = Arc::new(System::new(run.shared_plant(), NARROW));
        let (reached, start) = (run.save(), Arc::new(run.save()));
        let (course, longest_part) = (Course::default(), f64::INFINITY);
        Self { system, method, reached, course, start, longest_part }
    }

    /// The plant.
    pub fn plant(&self) -> &Plant<R> {
        &self.system.plant
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.reached.time()
    }

    /// The states at that time, in the places that [`Plant::indices`] says.
    pub fn state(&self) -> &[R] {
        self.reached.state()
    }

    /// The discrete state at that time.
    pub fn mode(&self) -> &PlantMode<R> {
        self.reached.mode()
    }

    /// Where the steps are; a run or steps of the same plant can be restored to it.
    pub fn save(&self) -> PlantSnapshot<R> {
        self.reached.clone()
    }

    /// Steps that go on from here, with memory to compute with.
    pub fn to_steps(&self) -> PlantSteps<R> {
        self.clone().into()
    }

    /// How a step is taken.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Edges in a second of the pulses that valves have been set to.
    #[doc(hidden)]
    pub fn edge_rate(&self) -> f64 {
        let valves = self.mode().network.valves.iter();
        valves.filter_map(|valve| valve.pulse_frequency()).map(|frequency| 2.0 * frequency.value()).sum()
    }

    /// Sets what a valve does from now on: see [`PlantSteps::set`].
    #[doc(hidden)]
    pub fn set(&mut self, valve: usize, command: RuntimeCommand<R>) -> Result<(), Error> {
        self.reached.set(&self.system.plant, valve, command)
    }

    /// Notes that its mode has been changed.
    pub(super) fn forget_guards(&mut self) {
        self.course.forget_guards();
    }
}

impl PlantRow {
    /// Everything that is known at the time that has been reached.
    pub fn sample(&self) -> PlantSample {
        let mut sampler = PlantSampler::new(self);
        sampler.read(self, self.time());
        sampler.into_sample()
    }

    /// Lays pulses out to `until` in s.
    #[doc(hidden)]
    pub fn lay_out(&mut self, until: f64) -> Result<(), Error> {
        self.reached.pulse(&self.system.plant, until)
    }

    /// Sets a valve to what needs nothing of where the steps are: the command that holds, or another duty cycle of the pulses that
    /// go on. Whether it is that; else nothing has changed.
    #[doc(hidden)]
    pub fn set_on(&mut self, valve: usize, command: &RuntimeCommand) -> Result<bool, Error> {
        self.reached.set_on(&self.system.plant, valve, command)
    }

    /// The next instant in s up to `until`; infinite when there is none.
    #[doc(hidden)]
    pub fn next_instant(&self, until: f64) -> f64 {
        self.system.next_instant(self.reached.mode(), until).unwrap_or(f64::INFINITY)
    }

    /// When in s pulses have to be laid out next; infinite when never.
    #[doc(hidden)]
    pub fn pulse_edge(&self) -> f64 {
        self.reached.mode().network.pulse_edge()
    }

    /// What watches the mode that holds: the plant, the mode, and the guards that end it with an event.
    #[doc(hidden)]
    pub fn watched(&mut self) -> (&System<f64>, &PlantMode, &[(PlantGuard, GuardForm)]) {
        let Self { system, reached, course, .. } = self;
        (system, reached.mode(), course.guards(system, reached.mode()))
    }

    /// Events since the steps began.
    #[doc(hidden)]
    pub fn events(&self) -> u64 {
        self.course.statistics.events
    }

    /// Whether it has the numbers of its plant in memory that it shares with another row.
    #[doc(hidden)]
    pub fn shares_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.system, &other.system)
    }

    /// Takes on the memory of another row for the numbers of its plant, if the plants are equal; whether they are.
    #[doc(hidden)]
    pub fn share(&mut self, other: &Self) -> bool {
        let is_equal = self.shares_with(other) || self.plant() == other.plant();
        if is_equal {
            self.system = other.system.clone();
        }
        is_equal
    }
}

impl<R: Instantiate> core::ops::Deref for PlantSteps<R> {
    type Target = PlantRow<R>;

    fn deref(&self) -> &PlantRow<R> {
        &self.row
    }
}

/// Steps of a row, with memory to compute with.
impl<R: Instantiate> From<PlantRow<R>> for PlantSteps<R> {
    fn from(row: PlantRow<R>) -> Self {
        R::take_on_plant_row(row)
    }
}

/// Where steps are, without that memory.
impl<R: Instantiate> From<PlantSteps<R>> for PlantRow<R> {
    fn from(steps: PlantSteps<R>) -> Self {
        *steps.row
    }
}

impl<R: Instantiate> PlantSteps<R> {
    /// Does something with another row, whose plant must be of equal structure.
    #[doc(hidden)]
    pub fn visit<T>(&mut self, row: &mut Box<PlantRow<R>>, does: impl FnOnce(&mut Self) -> T) -> T {
        core::mem::swap(&mut self.row, row);
        if !Arc::ptr_eq(&self.row.system, &self.adapted_to) {
            R::adapt_plant_steps(self);
        }
        let done = does(self);
        core::mem::swap(&mut self.row, row);
        done
    }

    /// Takes on the numbers of its row's plant.
    pub(crate) fn generic_adapt(&mut self) {
        self.work.adapt(&self.row.system.plant);
        self.adapted_to = self.row.system.clone();
    }
}
