//! Commands, steps, responses and outputs of one plant; saving and restoring.
//!
//! Steady steps, commands, responses, outputs and states allocate nothing on success. What happens for the first time may allocate: a
//! first command, its first change, the first restored state, the first event of a kind. `mckibben_begin_at` allocates. Where the
//! scenario moves, calls that find an actuator at rest under friction allocate, and steps in which one sticks or breaks away.
//!
//! Checked by `tests/interface/boundary.rs` and `tests/allocation.rs`.

use crate::memory::{array, array_mut, reference, write};
use crate::plant::{Moving, Plant, entry};
use crate::status::{Refusal, Status, status};
use mckibben::{Error, limit};
use mckibben_run::failure::Failure;

/// How an actuator responds where its ends are, and how its air changes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Response {
    /// Tension in N, zero or more; it pulls the ends together.
    pub tension: f64,
    /// Partial derivative of the tension with respect to the distance in N/m, at constant pressure.
    pub per_length: f64,
    /// Partial derivative of the tension with respect to the rate of the distance in N·s/m.
    pub per_velocity: f64,
    /// Partial derivative of the tension with respect to the pressure in m² (N/Pa).
    pub per_pressure: f64,
    /// Rate of the pressure in Pa/s, positive where it rises.
    pub pressure_rate: f64,
    /// Mass flow of air in kg/s, positive into the actuator.
    pub mass_flow: f64,
    /// Temperature of the air in K.
    pub temperature: f64,
    /// Volume of the air in braid and fittings (`actuator.external_volume`) in m³, without that of a hose.
    pub volume: f64,
}

impl Response {
    /// A response that says that there is none.
    pub(crate) const NONE: Self = Self {
        tension: f64::NAN,
        per_length: f64::NAN,
        per_velocity: f64::NAN,
        per_pressure: f64::NAN,
        pressure_rate: f64::NAN,
        mass_flow: f64::NAN,
        temperature: f64::NAN,
        volume: f64::NAN,
    };
}

impl From<&mckibben::Response> for Response {
    fn from(of: &mckibben::Response) -> Self {
        Self {
            tension: of.tension,
            per_length: of.per_length,
            per_velocity: of.per_velocity,
            per_pressure: of.per_pressure,
            pressure_rate: of.pressure_rate,
            mass_flow: of.mass_flow,
            temperature: of.temperature,
            volume: of.volume,
        }
    }
}

/// That as many distances are given as the plant takes.
fn check_distances(given: usize, due: usize) -> Result<(), Refusal> {
    if given == due { Ok(()) } else { Err(Refusal::count("distances", given, due, "mckibben_distance_count")) }
}

impl Plant {
    pub(crate) fn advance(&self, moving: &mut Moving, until: f64, distances: &[f64]) -> Result<(), Refusal> {
        check_distances(distances.len(), self.distance_count)?;
        Ok(moving.host.advance(until, distances)?)
    }

    /// Responses with the ends at distances and moving at rates, or where they are.
    pub(crate) fn respond(
        &self,
        moving: &mut Moving,
        ends: Option<(&[f64], &[f64])>,
        into: &mut [Response],
    ) -> Result<(), Refusal> {
        let Moving { host, responses } = moving;
        if into.len() != responses.len() {
            return Err(Refusal::count("responses", into.len(), responses.len(), "mckibben_actuator_count"));
        }
        if let Some((distances, rates)) = ends {
            check_distances(distances.len(), self.distance_count)?;
            host.compute_at(distances, rates, responses)?;
        } else {
            for (actuator, response) in responses.iter_mut().enumerate() {
                *response = host.steps_mut().compute(actuator).map_err(Failure::from)?;
            }
        }
        into.iter_mut().zip(&*responses).for_each(|(into, response)| *into = response.into());
        Ok(())
    }

    pub(crate) fn outputs(&self, moving: &mut Moving, into: &mut [f64]) -> Result<(), Refusal> {
        if into.len() != self.names.outputs.len() {
            return Err(Refusal::count("outputs", into.len(), self.names.outputs.len(), "mckibben_output_count"));
        }
        Ok(moving.host.read_outputs(into)?)
    }
}

/// Works on a plant.
///
/// # Safety
/// The pointer is NULL or a plant.
unsafe fn on(plant: *const Plant, work: impl FnOnce(&Plant, &mut Moving) -> Result<(), Refusal>) -> Status {
    status(|| {
        // SAFETY: as the caller promises.
        let plant = unsafe { reference(plant, "plant") }?;
        plant.with(|moving| work(plant, moving))
    })
}

/// Commands a valve by a number until the next command; commands are counted from 0. The range and the unit of `number` are those of
/// `mckibben_command_describe`: a duty cycle from 0 to 1; a request 1 (fill), 0 (hold) or -1 (exhaust), where the valve has it: see
/// `mckibben_command_accepts`; a position of a spool from -1 (exhaust) to 1 (supply); a set point in Pa, gauge, from zero to what
/// feeds the valve. A number that is set already changes nothing. A request, a position or a set point takes effect now, after the
/// delays of the valve. A duty cycle takes effect at the next pulse: pulse p begins at p/f on the clock of the plant. Before
/// its first command a valve rests: coils are released, so that a normally open valve fills and a three-way valve exhausts; a spool
/// is in the middle; a pressure regulator gives the actuator's initial pressure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_command(plant: *mut Plant, command: usize, number: f64) -> Status {
    // SAFETY: the caller's promise.
    unsafe { on(plant, |_, moving| Ok(moving.host.command(command, number)?)) }
}

/// Writes to `accepts` whether a valve takes a number as its command, 1 or 0; commands are counted from 0. A two-way valve holds and
/// does not exhaust, and a three-way valve exhausts and does not hold: both take two of the three requests.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_command_accepts(
    plant: *const Plant,
    command: usize,
    number: f64,
    accepts: *mut i32,
) -> Status {
    let find = |its: &Plant, moving: &mut Moving| {
        entry(&its.names.commands, command, "command")?;
        // SAFETY: the caller's promise.
        unsafe { write(accepts, "accepts", i32::from(moving.host.accepts(command, number))) }
    };
    // SAFETY: the caller's promise.
    unsafe { on(plant, find) }
}

/// Advances the plant to the time `until` in s, later than `mckibben_time`; a time in the past is refused.
///
/// Where the host moves the ends, they go in straight lines to `distances` in m, `count` of them: one for each actuator between its
/// ends, with its tendon. The air takes one step for the call, or equal parts no longer than `options.max_step`; `run.step`,
/// `run.accuracy` and `run.sample_interval` are not used. Events of valves and friction are at their instants within a step.
///
/// Where the scenario moves, `distances` is NULL and `count` 0, and the plant takes steps of `run.step`, or of the longest that
/// `run.accuracy` allows for the scenario's own run, never longer than `options.max_step`. An `until` that is equal to
/// `mckibben_time` changes nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_advance(
    plant: *mut Plant,
    until: f64,
    distances: *const f64,
    count: usize,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { on(plant, |its, moving| its.advance(moving, until, array(distances, count, "distances")?)) }
}

/// Writes the responses of all actuators, one for each, with the ends at `distances` in m and moving at `rates` in m/s (positive
/// where a distance grows), `count` of each. Both NULL, with a `count` of 0, mean where the ends are. The state of the plant stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_compute(
    plant: *mut Plant,
    distances: *const f64,
    rates: *const f64,
    count: usize,
    responses: *mut Response,
    response_count: usize,
) -> Status {
    let compute = |its: &Plant, moving: &mut Moving| {
        // SAFETY: the caller's promise.
        let (distances, rates, responses) = unsafe {
            (
                array(distances, count, "distances")?,
                array(rates, count, "rates")?,
                array_mut(responses, response_count, "responses")?,
            )
        };
        its.respond(moving, (count > 0).then_some((distances, rates)), responses)
    };
    // SAFETY: the caller's promise.
    unsafe { on(plant, compute) }
}

/// Writes all outputs where the plant is, `count` of them, in SI units: the columns of a run that are numbers, without the time and
/// the set points of valves, then the contraction of each actuator. Their names differ from those of columns: see
/// `mckibben_output_describe`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_outputs(plant: *mut Plant, outputs: *mut f64, count: usize) -> Status {
    // SAFETY: the caller's promise.
    unsafe { on(plant, |its, moving| its.outputs(moving, array_mut(outputs, count, "outputs")?)) }
}

/// Writes the time in s that the plant has reached, from 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_time(plant: *const Plant, time: *mut f64) -> Status {
    // SAFETY: the caller's promise.
    unsafe { on(plant, |_, moving| write(time, "time", moving.host.steps().time())) }
}

/// Writes the distances in m between the ends, `count` of them: one for each actuator whose ends the host moves.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_distances(plant: *const Plant, distances: *mut f64, count: usize) -> Status {
    let read = |its: &Plant, moving: &mut Moving| {
        check_distances(count, its.distance_count)?;
        // SAFETY: the caller's promise.
        let into = unsafe { array_mut(distances, count, "distances") }?;
        into.iter_mut().enumerate().for_each(|(actuator, distance)| *distance = moving.host.distance(actuator));
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { on(plant, read) }
}

/// Begins the plant again at time 0 with the ends at `distances` in m and moving at `rates` in m/s, `count` of each, and all else as the
/// scenario starts; valves are to be commanded again. Allocates. Refused where the scenario moves.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_begin_at(
    plant: *mut Plant,
    distances: *const f64,
    rates: *const f64,
    count: usize,
) -> Status {
    let begin = |its: &Plant, moving: &mut Moving| {
        // SAFETY: the caller's promise.
        let (distances, rates) = unsafe { (array(distances, count, "distances")?, array(rates, count, "rates")?) };
        if its.distance_count > 0 {
            check_distances(count, its.distance_count)?;
        }
        Ok(moving.host.begin_at(distances, rates)?)
    };
    // SAFETY: the caller's promise.
    unsafe { on(plant, begin) }
}

/// Returns to where the plant began: the start of the scenario at time 0, or where `mckibben_begin_at` or `mckibben_batch_begin_at` has
/// put it last. A copy, also one out of a batch, returns to where the copied plant began. Valves are to be commanded again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_reset(plant: *mut Plant) -> Status {
    let reset = |_: &Plant, moving: &mut Moving| {
        moving.host.reset();
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { on(plant, reset) }
}

/// The mark of a state, and the numbers behind it.
fn marked<M, N>(state: Option<(M, N)>) -> Result<(M, N), Refusal> {
    state.ok_or_else(|| Refusal::count("numbers of a state", 0, 1, "mckibben_state_size"))
}

/// That as many numbers are given as a state is.
fn check_state(given: usize, due: usize) -> Result<(), Refusal> {
    if given == due { Ok(()) } else { Err(Refusal::count("numbers of a state", given, due, "mckibben_state_size")) }
}

/// Why a state is not saved.
fn not_saved(error: Error) -> Refusal {
    match error {
        Error::NotImplemented(its) if *its == limit::SAVE_COMMANDS => Refusal::input(
            its.title(),
            "copy the plant by mckibben_plant_clone, command the valve less often, or shorten valve.dead_time",
        ),
        other => Failure::from(other).into(),
    }
}

/// Saves the whole state as `count` numbers: a mark of the scenario and of how its valves are commanded, time, air, valves with their
/// commands, and what friction remembers. Their meaning may change from one version to the next. Refused where more than 64 commands of one valve are within its dead time:
/// `mckibben_plant_clone` copies such a plant.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_save(plant: *mut Plant, numbers: *mut f64, count: usize) -> Status {
    let save = |its: &Plant, moving: &mut Moving| {
        check_state(count, its.state_size)?;
        // SAFETY: the caller's promise.
        let (mark, numbers) = marked(unsafe { array_mut(numbers, count, "numbers") }?.split_first_mut())?;
        moving.host.steps_mut().save_to(numbers).map_err(not_saved)?;
        *mark = moving.host.mark();
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { on(plant, save) }
}

/// Restores a state that a plant of an equal scenario saved, as `count` numbers; from there the plant continues bit-identically. A state of
/// another scenario, command mode, pulse frequency or motion is refused. Only the commands, controllers, start and run of the scenario
/// may differ, and where the host moves the ends its load and mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_restore(plant: *mut Plant, numbers: *const f64, count: usize) -> Status {
    let restore = |its: &Plant, moving: &mut Moving| {
        check_state(count, its.state_size)?;
        // SAFETY: the caller's promise.
        let (mark, numbers) = marked(unsafe { array(numbers, count, "numbers") }?.split_first())?;
        moving.host.check_mark("the state", *mark)?;
        Ok(moving.host.restore(numbers)?)
    };
    // SAFETY: the caller's promise.
    unsafe { on(plant, restore) }
}
