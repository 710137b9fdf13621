//! Rows of a batch that go by themselves: rigs with a tendon in series.

use super::Row;
use crate::control::Controller;
use crate::error::Error;
use crate::simulation::{ControlledStepper, Decision, Method, Sample, State, Stepper, ToldStepper};
use crate::valve::Demand;
use alloc::boxed::Box;
use core::fmt::Debug;

/// A row has a controller of its own, and somebody else wants to drive its valve.
pub(super) const CONTROLLED: Error = Error::Misuse {
    what: "a row with a controller of its own is told what to do, or begun anew",
    remedy: "make the batch without controllers and tell its rows what theirs decide, or make a new batch",
};

/// A row by itself, with a controller or without.
pub(super) trait Alone: Stepper<Sample = Sample> + Debug + Send + Sync {
    /// What its controller has decided, in order of time.
    fn decisions(&self) -> &[Decision];
    /// Where it is.
    fn state(&self) -> State;
    /// What its valve is to do from now on.
    fn tell(&mut self, demand: Demand) -> Result<(), Error>;
    /// The same with another rig and start at a time in s.
    fn anew(&self, time: f64, row: Row, method: Method) -> Result<Box<dyn Alone>, Error>;
}

impl<C> Alone for ControlledStepper<f64, C>
where
    C: Controller<Memory: Send + Sync> + Debug + Send + Sync,
{
    fn decisions(&self) -> &[Decision] {
        Self::decisions(self)
    }

    fn state(&self) -> State {
        Self::state(self)
    }

    fn tell(&mut self, _: Demand) -> Result<(), Error> {
        Err(CONTROLLED)
    }

    fn anew(&self, _: f64, _: Row, _: Method) -> Result<Box<dyn Alone>, Error> {
        Err(CONTROLLED)
    }
}

impl Alone for ToldStepper {
    fn decisions(&self) -> &[Decision] {
        &[]
    }

    fn state(&self) -> State {
        Self::state(self)
    }

    fn tell(&mut self, demand: Demand) -> Result<(), Error> {
        Self::tell(self, demand)
    }

    fn anew(&self, time: f64, Row { rig, start }: Row, method: Method) -> Result<Box<dyn Alone>, Error> {
        Ok(Box::new(Self::begin_at(time, rig, start, method)?))
    }
}
