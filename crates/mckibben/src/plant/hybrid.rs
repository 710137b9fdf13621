//! The plant as a hybrid system of the event-located engine.

use super::crossing::PlantEventKind;
use super::evaluation::{Evaluation, System};
use super::guard::PlantGuard;
use super::mode::PlantMode;
use crate::engine::GuardForm;
use crate::engine::{Halt, Hybrid};
use crate::error::Error;
use crate::scalar::{Differentiable, Over, Real, Scalar};
use crate::simulation::Guard;
use alloc::vec::Vec;

impl<R: Real> Hybrid<R> for System<R> {
    type Mode = PlantMode<R>;
    type Guard = PlantGuard;
    type Kind = PlantEventKind;
    type Work<T: Scalar> = Evaluation<T>;

    fn states(&self) -> usize {
        self.plant.places.states
    }

    fn work<T: Over<R>>(&self) -> Evaluation<T> {
        Evaluation::new(&self.plant)
    }

    // The stages of a step call it in as many places.
    #[inline(never)]
    fn rates<T: Differentiable<R>>(
        &self,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        work: &mut Evaluation<T>,
        rates: &mut [T],
    ) {
        System::rates(self, time, state, mode, work, rates);
    }

    fn settling_rate(&self, state: &[R], mode: &PlantMode<R>, work: &mut Evaluation<R>) -> f64 {
        System::settling_rate(self, state, mode, work)
    }

    fn scales(&self, state: &[R], mode: &PlantMode<R>, scales: &mut [f64]) {
        System::scales(self, state, mode, scales);
    }

    fn influences(&self) -> &[f64] {
        &self.influences
    }

    fn next_instant(&self, mode: &PlantMode<R>, until: R) -> Option<R> {
        System::next_instant(self, mode, until)
    }

    fn pass_instant(
        &self,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        work: &mut Evaluation<R>,
    ) -> Result<PlantEventKind, Error> {
        System::pass_instant(self, time, state, mode, work)
    }

    fn guards(&self, mode: &PlantMode<R>, guards: &mut Vec<(PlantGuard, GuardForm<R>)>) {
        System::guards(self, mode, guards);
    }

    fn guard<T: Differentiable<R>>(
        &self,
        guard: PlantGuard,
        time: T,
        state: &[T],
        mode: &PlantMode<R>,
        work: &mut Evaluation<T>,
    ) -> T {
        System::guard(self, guard, time, state, mode, work)
    }

    fn is_smooth(&self, guard: PlantGuard) -> bool {
        match guard {
            PlantGuard::Of(_, Guard::PieceDown | Guard::PieceUp) | PlantGuard::Arm { .. } => true,
            PlantGuard::Of(i, Guard::MapShorter | Guard::MapLonger | Guard::MapDown | Guard::MapUp) => {
                // The slope of a map jumps there, from which the velocity of an end without a mass may follow.
                self.plant.actuators[i].tendon.is_none()
            }
            _ => false,
        }
    }

    fn cross(
        &self,
        guard: PlantGuard,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        work: &mut Evaluation<R>,
    ) -> Result<PlantEventKind, Error> {
        let kind = System::cross(self, guard, time, state, mode, work)?;
        self.check_balanced(time, state, mode, work)?;
        Ok(kind)
    }

    fn project(&self, time: R, state: &mut [R], mode: &PlantMode<R>, work: &mut Evaluation<R>) {
        System::project(self, time, state, mode, work);
    }

    fn halts(&self, time: R, state: &[R], why: Halt, event: Option<PlantEventKind>) -> Error {
        System::halts(self, time, state, why, event)
    }
}
