//! Where steps are, as numbers in the caller's memory: for a host that keeps states in its own arrays, in a file, or
//! in another process.
//!
//! Checked by `tests/plant_saved.rs`: what is restored goes on to the same bits.

use super::{PlantRow, PlantSteps};
use crate::error::Error;
use crate::instantiate::Instantiate;

impl<R: Instantiate> PlantSteps<R> {
    /// How many numbers a state is that is saved as numbers: as many for every state of the plant.
    pub fn state_size(&mut self) -> usize {
        R::size_plant_steps(self)
    }

    pub(crate) fn generic_state_size(&mut self) -> usize {
        let Self { row, before, state_size, .. } = self;
        *state_size.get_or_insert_with(|| {
            before.clone_from(&row.reached);
            row.system.saved_size(before)
        })
    }

    /// Saves where the steps are as [`PlantSteps::state_size`] numbers: time, states, modes, what a hysteresis remembers, valves
    /// with what they have been set to. SI units, infinity for an instant that does not come; their order may change from one
    /// version to the next. Over dual numbers each has its derivatives, so that a state that is restored from numbers with derivatives
    /// and saved after a step gives the Jacobian of the step.
    ///
    /// # Errors
    /// [`Error::Misuse`] for more or fewer numbers; [`Error::NotImplemented`] where drivers command valves, and where more than
    /// 64 commands of one valve are on their way.
    pub fn save_to(&mut self, numbers: &mut [R]) -> Result<(), Error> {
        R::save_plant_steps(self, numbers)
    }

    pub(crate) fn generic_save_to(&mut self, numbers: &mut [R]) -> Result<(), Error> {
        let size = self.state_size();
        self.row.system.save_to(&mut self.row.reached, numbers, size)
    }

    /// Returns to where steps of an equal plant were, from the numbers that they saved; from there the steps go on bit
    /// for bit.
    ///
    /// # Errors
    /// [`Error::Misuse`] for numbers that are no state of the plant; [`Error::NotImplemented`] where drivers command valves. The
    /// steps then stay where they are.
    pub fn restore_from(&mut self, numbers: &[R]) -> Result<(), Error> {
        R::restore_plant_steps(self, numbers)
    }

    pub(crate) fn generic_restore_from(&mut self, numbers: &[R]) -> Result<(), Error> {
        let Self { row, before, work, .. } = self;
        let PlantRow { system, reached, course, .. } = &mut **row;
        before.clone_from(reached);
        system.restore_from(before, numbers, &mut work.at)?;
        core::mem::swap(before, reached);
        // Those of the mode that has been left.
        course.forget_guards();
        Ok(())
    }
}
