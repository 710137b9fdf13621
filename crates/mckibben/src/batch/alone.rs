//! Rows of a batch that go by themselves: rigs with a tendon in series.

use super::Row;
use crate::control::Controller;
use crate::error::Error;
use crate::simulation::fixed_step::Journey;
use crate::simulation::{ControlledStepper, Decision, Method, Rig, Sample, Stepper};
use core::fmt::Debug;

/// A row by itself, with a controller or without.
pub(super) trait Alone: Stepper<Sample = Sample> + Debug + Send + Sync {
    /// What its controller has decided, in order of time.
    fn decisions(&self) -> &[Decision];
}

impl<C> Alone for ControlledStepper<f64, C>
where
    C: Controller<Memory: Send + Sync> + Debug + Send + Sync,
{
    fn decisions(&self) -> &[Decision] {
        Self::decisions(self)
    }
}

/// The fixed-step engine with a rig of its own.
#[derive(Debug)]
pub(super) struct Uncontrolled {
    rig: Rig,
    method: Method,
    journey: Journey<f64>,
}

impl Uncontrolled {
    pub(super) fn new(Row { rig, start }: Row, method: Method) -> Self {
        let journey = Journey::begin(&rig, start);
        Self { rig, method, journey }
    }
}

impl Stepper for Uncontrolled {
    type Sample = Sample;

    fn time(&self) -> f64 {
        self.journey.time()
    }

    fn advance_to(&mut self, until: f64) -> Result<(), Error> {
        self.journey.advance_to(&self.rig, self.method, until)
    }

    fn sample(&self) -> Sample {
        self.journey.sample(&self.rig)
    }
}

impl Alone for Uncontrolled {
    fn decisions(&self) -> &[Decision] {
        &[]
    }
}
