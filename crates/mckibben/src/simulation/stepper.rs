//! What goes through time at fixed steps, whatever it is: a [batch](crate::batch) of any of these is stepped row by row.

use super::controlled::ControlledStepper;
use super::fixed_step::FixedStepper;
use super::joint::{ControlledJointStepper, JointCourse, JointSample, JointStepper};
use super::leg::{LegSample, LegStepper};
use super::sample::Sample;
use super::told::ToldStepper;
use crate::control::{Controller, JointController};
use crate::error::Error;
use crate::scalar::Real;
use alloc::boxed::Box;
use core::borrow::Borrow;

/// Something that goes through time at fixed steps.
///
/// For an actuator, a joint, either of them with a controller, and a leg. A joint is a pair of a [`JointStepper`], its own,
/// borrowed or shared, and a [`JointCourse`].
pub trait Stepper {
    /// What it shows.
    type Sample;

    /// The time in s that has been reached.
    fn time(&self) -> f64;

    /// Goes on to `until` s in one step, divided where something switches.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step was so long that it left the physics; others where a controller asks what cannot be.
    fn advance_to(&mut self, until: f64) -> Result<(), Error>;

    /// Everything that is known at the time that has been reached.
    fn sample(&self) -> Self::Sample;
}

/// A stepper that knows its time, steps and samples by itself.
macro_rules! stepper {
    ([$($of:tt)*], $stepper:ty, $sample:ty) => {
        impl<R: Real<Time = R>, $($of)*> Stepper for $stepper {
            type Sample = $sample;

            fn time(&self) -> f64 {
                Self::time(self).value()
            }

            fn advance_to(&mut self, until: f64) -> Result<(), Error> {
                Self::advance_to(self, R::constant(until))
            }

            fn sample(&self) -> $sample {
                Self::sample(self)
            }
        }
    };
}
stepper!([], FixedStepper<'_, R>, Sample<R>);
stepper!([C: Controller<R>], ControlledStepper<R, C>, Sample<R>);
stepper!([C: JointController<R>], ControlledJointStepper<R, C>, JointSample<R>);
stepper!([], LegStepper<R>, LegSample<R>);
stepper!([], ToldStepper<R>, Sample<R>);

impl<R: Real<Time = R>, S: Borrow<JointStepper<R>>> Stepper for (S, JointCourse<R>) {
    type Sample = JointSample<R>;

    fn time(&self) -> f64 {
        self.1.time().value()
    }

    fn advance_to(&mut self, until: f64) -> Result<(), Error> {
        let (stepper, course) = self;
        (*stepper).borrow().advance_to(course, R::constant(until))
    }

    fn sample(&self) -> JointSample<R> {
        self.0.borrow().sample(&self.1)
    }
}

impl<S: Stepper + ?Sized> Stepper for Box<S> {
    type Sample = S::Sample;

    fn time(&self) -> f64 {
        S::time(self)
    }

    fn advance_to(&mut self, until: f64) -> Result<(), Error> {
        S::advance_to(self, until)
    }

    fn sample(&self) -> S::Sample {
        S::sample(self)
    }
}
