//! Many plants in one call, on the caller's arrays.
//!
//! Plants are independent and may differ; each goes on as if it were stepped alone, on any number of threads. The threads are
//! started and joined within the call, so that the library leaves none behind.
//!
//! Checked by `tests/interface/many.rs`: bit-identical to single calls, on any number of threads.

use crate::memory::{array, array_mut, reference, write};
use crate::plant::Plant;
use crate::status::{Refusal, Status, caught, status};
use crate::step::Response;

/// One step of many plants. Arrays have a row for each plant, one after the other; each row has as many elements as its count says.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Step {
    /// The time in s that all plants go on to.
    pub until: f64,
    /// Numbers that valves are commanded by, as in `mckibben_command`; NULL to leave valves as they are.
    pub commands: *const f64,
    /// Commands of each plant: `mckibben_command_count`; 0 with NULL.
    pub command_count: usize,
    /// Distances in m, as in `mckibben_advance`; NULL where scenarios move.
    pub distances: *const f64,
    /// Distances of each plant: `mckibben_distance_count`; 0 with NULL.
    pub distance_count: usize,
    /// Where responses are written that the plants have after the step; NULL for none.
    pub responses: *mut Response,
    /// Responses of each plant: `mckibben_actuator_count`; 0 with NULL.
    pub response_count: usize,
    /// Where outputs are written that the plants have after the step; NULL for none.
    pub outputs: *mut f64,
    /// Outputs of each plant: `mckibben_output_count`; 0 with NULL.
    pub output_count: usize,
    /// Threads to use; 0 and 1 use that of the caller alone. More than there are plants are not used.
    pub threads: usize,
}

/// A plant with its rows of the arrays.
struct Instance<'a> {
    plant: Result<&'a Plant, Refusal>,
    until: f64,
    commands: &'a [f64],
    distances: &'a [f64],
    responses: &'a mut [Response],
    outputs: &'a mut [f64],
}

impl Instance<'_> {
    /// Steps the plant; what it does not reach is not a number.
    fn step(&mut self) {
        let stepped = match std::mem::replace(&mut self.plant, Err(Refusal::new(Status::Ok, ""))) {
            Ok(plant) => caught(|| self.go_on(plant)).map(|()| plant),
            Err(refusal) => Err(refusal),
        };
        if stepped.is_err() {
            self.responses.fill(Response::NONE);
            self.outputs.fill(f64::NAN);
        }
        self.plant = stepped;
    }

    fn go_on(&mut self, plant: &Plant) -> Result<(), Refusal> {
        let due = plant.names.commands.len();
        if !self.commands.is_empty() && self.commands.len() != due {
            return Err(Refusal::count("commands", self.commands.len(), due, "mckibben_command_count"));
        }
        plant.with(|moving| {
            for (input, number) in self.commands.iter().enumerate() {
                moving.host.command(input, *number)?;
            }
            plant.advance(moving, self.until, self.distances)?;
            if !self.responses.is_empty() {
                plant.respond(moving, None, self.responses)?;
            }
            if self.outputs.is_empty() { Ok(()) } else { plant.outputs(moving, self.outputs) }
        })
    }
}

/// The length of an array with a row for each of so many plants.
fn length(rows: usize, each: usize, name: &str) -> Result<usize, Refusal> {
    rows.checked_mul(each).ok_or_else(|| {
        Refusal::new(
            Status::Count,
            format!(
                "error: {rows} rows of {each} {name} are more than memory can hold\n = help: give their true count"
            ),
        )
    })
}

/// Cuts one row after the other off an array that has one for each plant.
fn row<'a, T>(left: &mut &'a [T], each: usize) -> &'a [T] {
    left.split_off(..each).unwrap_or_default()
}

/// Cuts one row after the other off an array that is written.
fn row_mut<'a, T>(left: &mut &'a mut [T], each: usize) -> &'a mut [T] {
    left.split_off_mut(..each).unwrap_or_default()
}

/// Steps `plant_count` plants: commands their valves, goes on to `step->until`, and writes responses and outputs. The plants are
/// independent: where one fails, the others go on, its status says why, and its responses and outputs are not numbers (NaN); valves
/// may then have been commanded, but its time has not changed. `statuses` has one status for each plant, or is NULL. Returns the
/// status of the first plant that failed, with its text. Allocates. The caller may as well call `mckibben_command` and
/// `mckibben_advance` from separate threads: the numbers are the same.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_step_all(
    plants: *const *mut Plant,
    plant_count: usize,
    step: *const Step,
    statuses: *mut Status,
) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let (plants, step) = unsafe { (array(plants, plant_count, "plants")?, reference(step, "step")?) };
        let Step { until, command_count, distance_count, response_count, output_count, threads, .. } = *step;
        // SAFETY: the caller's promise; each array has a row for each plant.
        let (mut commands, mut distances, mut responses, mut outputs) = unsafe {
            (
                array(step.commands, length(plant_count, command_count, "commands")?, "commands")?,
                array(step.distances, length(plant_count, distance_count, "distances")?, "distances")?,
                array_mut(step.responses, length(plant_count, response_count, "responses")?, "responses")?,
                array_mut(step.outputs, length(plant_count, output_count, "outputs")?, "outputs")?,
            )
        };
        let instance = |plant: &*mut Plant| Instance {
            // SAFETY: NULL or a plant, by the caller's promise. The same plant twice is safe: it has a lock.
            plant: unsafe { reference(*plant, "plants[…]") },
            until,
            commands: row(&mut commands, command_count),
            distances: row(&mut distances, distance_count),
            responses: row_mut(&mut responses, response_count),
            outputs: row_mut(&mut outputs, output_count),
        };
        let mut instances: Vec<Instance<'_>> = plants.iter().map(instance).collect();
        let each = plant_count.div_ceil(threads.clamp(1, plant_count.max(1))).max(1);
        if each >= plant_count {
            instances.iter_mut().for_each(Instance::step);
        } else {
            std::thread::scope(|scope| {
                for part in instances.chunks_mut(each) {
                    scope.spawn(|| part.iter_mut().for_each(Instance::step));
                }
            });
        }
        let mut first = Ok(());
        for (index, instance) in instances.into_iter().enumerate() {
            let its = instance.plant.as_ref().map_or_else(|refusal| refusal.status, |_| Status::Ok);
            if !statuses.is_null() {
                // SAFETY: one status for each plant, by the caller's promise; the pointer is checked for alignment.
                unsafe { write(statuses.wrapping_add(index), "statuses", its) }?;
            }
            if let (Ok(()), Err(refusal)) = (&first, instance.plant) {
                first = Err(refusal.of(format_args!("plant {index}")));
            }
        }
        first
    })
}
