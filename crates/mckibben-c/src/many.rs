//! Many plants in one call, on the caller's arrays: a batch.
//!
//! The plants of a batch are stepped side by side in the vector registers of the processor. Each is bit-identical to one that is
//! stepped alone, on any number of threads. The threads belong to the batch, and end when it is freed.
//!
//! Checked by `tests/interface/many.rs`.

use crate::memory::{array, array_mut, check, reference, write};
use crate::plant::{Moving, Plant, locked};
use crate::status::{Refusal, Status, status, value};
use crate::step::Response;
use mckibben_run::failure::Failure;
use mckibben_run::host::HostBatch;
use mckibben_run::sweep::schedule::STACK;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::Mutex;
use std::thread::JoinHandle;

/// Plants that are stepped together.
#[derive(Debug)]
pub struct Batch {
    counts: Counts,
    moving: Mutex<HostBatch>,
    threads: Option<Threads>,
}

/// How many numbers each plant takes and has.
#[derive(Clone, Copy, Debug)]
struct Counts {
    plants: usize,
    commands: usize,
    distances: usize,
    actuators: usize,
    outputs: usize,
}

/// Threads that end with the batch.
#[derive(Debug)]
struct Threads {
    pool: Option<ThreadPool>,
    handles: Vec<JoinHandle<()>>,
}

impl Threads {
    /// Does work on the threads.
    fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    fn start(count: usize) -> Result<Self, Refusal> {
        let mut handles = Vec::new();
        let start = |thread: rayon::ThreadBuilder| {
            handles.push(std::thread::Builder::new().stack_size(STACK).spawn(|| thread.run())?);
            Ok(())
        };
        match ThreadPoolBuilder::new().num_threads(count).spawn_handler(start).build() {
            Ok(pool) => Ok(Self { pool: Some(pool), handles }),
            Err(error) => Err(Refusal::input(format!("threads cannot be started: {error}"), "ask for fewer threads")),
        }
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        // Without its pool a thread comes to its end.
        self.pool = None;
        for handle in self.handles.drain(..) {
            // What a thread has come to does not matter any more.
            let _ = handle.join();
        }
    }
}

/// One step of a batch. Arrays have a row for each plant, one after the other; each row has as many elements as its count says.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Step {
    /// The time in s that all plants go on to, as in `mckibben_advance`.
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
}

/// The arrays of a step.
struct Arrays<'a> {
    until: f64,
    commands: &'a [f64],
    distances: &'a [f64],
    responses: &'a mut [Response],
    outputs: &'a mut [f64],
}

impl Batch {
    fn of(plants: Vec<&Plant>, threads: usize) -> Result<Self, Refusal> {
        let hosts = plants.iter().map(|plant| plant.with(|moving| Ok(moving.host.clone())));
        let hosts = hosts.collect::<Result<Vec<_>, _>>()?;
        // More threads than plants would have nothing to do.
        let threads = threads.min(hosts.len());
        // A batch is divided for as many threads as there are here. Outside a pool this would start threads that stay.
        let started = Threads::start(threads.max(1))?;
        let mut batch = started.install(|| HostBatch::new(hosts))?;
        let model = batch.model();
        let counts = Counts {
            plants: batch.count(),
            commands: model.commands().len(),
            distances: model.distance_count(),
            actuators: model.actuators().len(),
            outputs: model.outputs().len(),
        };
        batch.keep_to_thread(threads < 2);
        let threads = (threads > 1).then_some(started);
        Ok(Self { counts, moving: Mutex::new(batch), threads })
    }

    /// Does work on the plants, on the threads of the batch.
    fn with<T: Send>(&self, work: impl FnOnce(&mut HostBatch) -> Result<T, Refusal> + Send) -> Result<T, Refusal> {
        locked(&self.moving, "batch", |batch| match &self.threads {
            Some(threads) => threads.install(|| work(batch)),
            None => work(batch),
        })
    }

    /// The arrays of a step.
    ///
    /// # Safety
    /// Each array has a row for each plant, of as many elements as its count says.
    unsafe fn arrays<'a>(&self, step: &Step) -> Result<Arrays<'a>, Refusal> {
        let Counts { plants, commands, distances, actuators, outputs } = self.counts;
        let length = |name: &str, given: usize, due: usize, function: &str| match given == due {
            true => Ok(plants * due),
            false => Err(Refusal::count(name, given, due, function)),
        };
        let if_any = |count: usize, length: Result<usize, Refusal>| if count == 0 { Ok(0) } else { length };
        let (commands, distances, responses, outputs) = (
            if_any(step.command_count, length("commands", step.command_count, commands, "mckibben_command_count"))?,
            length("distances", step.distance_count, distances, "mckibben_distance_count")?,
            if_any(
                step.response_count,
                length("responses", step.response_count, actuators, "mckibben_actuator_count"),
            )?,
            if_any(step.output_count, length("outputs", step.output_count, outputs, "mckibben_output_count"))?,
        );
        // SAFETY: the caller's promise.
        unsafe {
            Ok(Arrays {
                until: step.until,
                commands: array(step.commands, commands, "commands")?,
                distances: array(step.distances, distances, "distances")?,
                responses: array_mut(step.responses, responses, "responses")?,
                outputs: array_mut(step.outputs, outputs, "outputs")?,
            })
        }
    }
}

impl Arrays<'_> {
    /// Steps the plants; why those have stopped that have.
    fn step(self, batch: &mut HostBatch) -> Result<Vec<(usize, Failure)>, Refusal> {
        let Self { until, commands, distances, responses, outputs } = self;
        if !commands.is_empty() {
            batch.command(commands)?;
        }
        batch.advance(until, distances)?;
        if !responses.is_empty() {
            batch.compute()?;
            let each = responses.len() / batch.count();
            for (row, into) in responses.chunks_mut(each).enumerate() {
                match batch.responses(row) {
                    Ok(its) => into.iter_mut().zip(its).for_each(|(into, its)| *into = its.into()),
                    Err(_) => into.fill(Response::NONE),
                }
            }
        }
        if !outputs.is_empty() {
            outputs.fill(f64::NAN);
            batch.read_outputs(outputs)?;
        }
        Ok((0..batch.count()).filter_map(|row| batch.failure(row).map(|failure| (row, failure))).collect())
    }
}

/// Makes a batch of `plant_count` plants, each from where its plant is; the plants themselves stay, and one may stand in the array
/// many times. `threads` threads step them; 0 and 1 leave all to the caller's. On success `*batch` is a batch to be freed by
/// `mckibben_batch_free`; otherwise it is NULL.
///
/// The plants are of one scenario, or of scenarios that differ in numbers. All must agree in these: the time; the motion and
/// `options.max_step`; names of actuators, commands and outputs; modes of commands, and of duty cycles the frequency and the requests
/// in pulses and between them; the number of numbers of a state, which differs where a valve has a dead time and another has none;
/// and where the scenario moves, `run.method` and the step. Give one `run.step` to all, or an `options.max_step` no longer than the step
/// of any, and one `options.pulse_frequency`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_batch_from_plants(
    plants: *const *const Plant,
    plant_count: usize,
    threads: usize,
    batch: *mut *mut Batch,
) -> Status {
    status(|| {
        // SAFETY: memory for a pointer, by the caller's promise.
        unsafe { write(batch, "batch", std::ptr::null_mut()) }?;
        // SAFETY: so many pointers, by the caller's promise.
        let plants = unsafe { array(plants, plant_count, "plants") }?;
        let plants = plants.iter().enumerate();
        // SAFETY: each is NULL or a plant, by the caller's promise.
        let plants = plants.map(|(index, plant)| unsafe { reference(*plant, &format!("plants[{index}]")) });
        let made = Batch::of(plants.collect::<Result<_, _>>()?, threads)?;
        // SAFETY: as at the head.
        unsafe { write(batch, "batch", Box::into_raw(Box::new(made))) }
    })
}

/// Ends the threads of a batch and frees it; nothing for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_batch_free(batch: *mut Batch) {
    value((), || {
        if !batch.is_null() {
            // SAFETY: a batch that has not been freed, by the caller's promise.
            drop(unsafe { Box::from_raw(batch) });
        }
        Ok(())
    });
}

/// Returns the number of plants of a batch; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_batch_count(batch: *const Batch) -> usize {
    // SAFETY: NULL or a batch, by the caller's promise.
    value(0, || unsafe { reference(batch, "batch") }.map(|batch| batch.counts.plants))
}

/// Steps all plants of a batch: commands their valves, goes on to `step->until`, and writes responses and outputs. Where an argument
/// is wrong no plant moves and nothing is written. A wrong pointer, count or command leaves the valves as they were; where a time or a
/// distance is refused, they have been commanded. A plant that leaves the physics stops,
/// while the others go on: its status says so, in this step and in later ones, and its responses and outputs are not numbers (NaN).
/// `statuses` has one status for each plant, or is NULL. Returns the status of the first plant that has stopped, with its text.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_batch_step(batch: *mut Batch, step: *const Step, statuses: *mut Status) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let (batch, arrays) = unsafe {
            let batch = reference::<Batch>(batch, "batch")?;
            (batch, batch.arrays(reference(step, "step")?)?)
        };
        if !statuses.is_null() {
            check(statuses, "statuses")?;
        }
        let stopped = batch.with(|batch| arrays.step(batch))?;
        if !statuses.is_null() {
            let mut left = stopped.iter().peekable();
            for row in 0..batch.counts.plants {
                let its = left.next_if(|(stopped, _)| *stopped == row).map_or(Status::Ok, |_| Status::Stopped);
                // SAFETY: one status for each plant, by the caller's promise.
                unsafe { write(statuses.wrapping_add(row), "statuses", its) }?;
            }
        }
        match stopped.into_iter().next() {
            Some((_, failure)) => Err(Refusal { status: Status::Stopped, ..failure.into() }),
            None => Ok(()),
        }
    })
}

/// A plant of a batch, counted from 0, begins again at the time of the batch, with its ends at `distances` in m and moving at `rates`
/// in m/s, `count` of each, and all else as the scenario starts. Its valves are commanded nothing. Allocates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_batch_begin_at(
    batch: *mut Batch,
    plant: usize,
    distances: *const f64,
    rates: *const f64,
    count: usize,
) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let (batch, distances, rates) = unsafe {
            let batch = reference::<Batch>(batch, "batch")?;
            if count != batch.counts.distances {
                return Err(Refusal::count("distances", count, batch.counts.distances, "mckibben_distance_count"));
            }
            (batch, array(distances, count, "distances")?, array(rates, count, "rates")?)
        };
        batch.with(|batch| Ok(batch.begin_row(plant, distances, rates)?))
    })
}

/// Makes a plant from where a plant of a batch is, counted from 0: to save it, or to step it alone. `mckibben_batch_from_plants` takes
/// it back. On success `*plant` is a plant to be freed by `mckibben_plant_free`; otherwise it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_batch_plant(batch: *mut Batch, index: usize, plant: *mut *mut Plant) -> Status {
    status(|| {
        // SAFETY: memory for a pointer, by the caller's promise.
        unsafe { write(plant, "plant", std::ptr::null_mut()) }?;
        // SAFETY: the caller's promise.
        let batch = unsafe { reference::<Batch>(batch, "batch") }?;
        let host = batch.with(|batch| Ok(batch.plant(index)?))?;
        let responses = vec![mckibben::Response::default(); batch.counts.actuators];
        let made = Plant::of(Moving { host, responses });
        // SAFETY: as at the head.
        unsafe { write(plant, "plant", Box::into_raw(Box::new(made))) }
    })
}
