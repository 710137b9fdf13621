//! Reading, copying and freeing a plant; its names, units and counts.
//!
//! What never changes (names, counts) lies apart from what changes, and is read without a lock.
//!
//! Checked by `tests/interface/boundary.rs`.

use crate::memory::{reference, text, text_if_any, write};
use crate::status::{Refusal, Status, c_text, status, value};
use mckibben_run::failure::Failure;
use mckibben_run::host::{COMMAND_MODES, CommandInput, HostOptions, HostPlant};
use mckibben_scenario::Document;
use std::ffi::{CString, c_char};
use std::sync::{Mutex, TryLockError};

/// What moves the ends of the actuators.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(C)]
pub enum Motion {
    /// The host: it integrates masses and joints, passes distances and takes tensions.
    Host = 0,
    /// The scenario: its loads and mechanisms.
    Scenario = 1,
}

/// Options for reading a plant. All zero is the default: `mckibben_options options = {0};`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Options {
    /// What moves the ends: `MCKIBBEN_MOTION_HOST` (0) or `MCKIBBEN_MOTION_SCENARIO` (1).
    pub motion: i32,
    /// What the numbers are that valves are commanded by, of all valves: "duty", "request", "position" or "set-point"; NULL for each
    /// valve's own: positions of a spool, set points of a pressure regulator, of other valves duty cycles where the scenario or
    /// `pulse_frequency` says how often they are pulsed, otherwise requests.
    pub command_mode: *const c_char,
    /// Frequency in Hz of the pulses of a duty cycle, above zero; 0 for that of the scenario.
    pub pulse_frequency: f64,
    /// Longest part of a step in s, above zero. Where the host moves the ends, a step is divided into equal parts no longer than this;
    /// 0 for one part. Where the scenario moves, its steps are no longer than this; 0 for `run.step`, or for the longest step that
    /// `run.accuracy` allows.
    pub max_step: f64,
}

/// A valve that is commanded by a number.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CommandInfo {
    /// Name of the actuator, or of all that the valve feeds with "+" between them, a dot, and the mode with "_" for "-":
    /// "biceps.duty", "agonist+antagonist.request", "actuator.set_point". A scenario of one actuator calls it "actuator".
    pub name: *const c_char,
    /// What the number is: "duty", "request", "position" or "set-point".
    pub mode: *const c_char,
    /// Unit of the number: "Pa" of a set point, otherwise empty.
    pub unit: *const c_char,
    /// Least number: -1 of every request, though a valve of two positions has two of the three: see `mckibben_command_accepts`.
    pub minimum: f64,
    /// Greatest number; of a set point what feeds the valve, infinity where this is not known.
    pub maximum: f64,
    /// Frequency of the pulses in Hz; 0 where there are none.
    pub pulse_frequency: f64,
}

/// A number that is read of a plant.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct OutputInfo {
    /// Name of the part and of the quantity, without a unit: "biceps.gauge_pressure" where a run has the column
    /// "biceps.gauge_pressure_pa". A scenario of one actuator calls it "actuator", a joint its actuators "agonist" and "antagonist" and
    /// itself "joint", and both their supply "supply", where runs have "gauge_pressure_pa", "antagonist_gauge_pressure_pa",
    /// "angle_rad" and "supply_gauge_pressure_pa".
    pub name: *const c_char,
    /// SI unit, such as "Pa", "m/s", "m3" or "N*m"; empty of a pure number.
    pub unit: *const c_char,
}

/// A scenario as a plant that a host steps.
#[derive(Debug)]
pub struct Plant {
    pub(crate) names: Names,
    pub(crate) state_size: usize,
    pub(crate) distance_count: usize,
    moving: Mutex<Moving>,
}

/// The part of a plant that changes.
#[derive(Clone, Debug)]
pub(crate) struct Moving {
    pub(crate) host: HostPlant,
    /// Memory for the responses of all actuators.
    pub(crate) responses: Vec<mckibben::Response>,
}

#[derive(Clone, Debug)]
pub(crate) struct Names {
    pub(crate) actuators: Vec<CString>,
    pub(crate) commands: Vec<Commanded>,
    /// Names and units.
    pub(crate) outputs: Vec<(CString, CString)>,
}

#[derive(Clone, Debug)]
pub(crate) struct Commanded {
    name: CString,
    mode: CString,
    unit: CString,
    range: (f64, f64),
    pulse_frequency: f64,
}

impl Commanded {
    fn of(input: &CommandInput) -> Self {
        let (least, greatest, unit) = input.mode.range();
        Self {
            name: c_text(&input.name),
            mode: c_text(input.mode.name()),
            unit: c_text(unit),
            range: (least, greatest),
            pulse_frequency: input.mode.pulse_frequency().unwrap_or_default(),
        }
    }
}

impl Plant {
    fn read(document: &Document, options: &HostOptions<'_>) -> Result<Self, Refusal> {
        let read = HostPlant::read(document, options).map_err(Refusal::from);
        let mut host = read.map_err(|refusal| in_words_of_c(refusal, options))?;
        let responses = (0..host.actuators().len()).map(|actuator| host.steps_mut().compute(actuator));
        let responses = responses.collect::<Result<_, _>>().map_err(Failure::from)?;
        Ok(Self::of(Moving { host, responses }))
    }

    pub(crate) fn of(mut moving: Moving) -> Self {
        let host = &mut moving.host;
        let names = Names {
            actuators: host.actuators().iter().map(|name| c_text(name)).collect(),
            commands: host.commands().iter().map(Commanded::of).collect(),
            outputs: host.outputs().iter().map(|column| (c_text(&column.name), c_text(column.unit))).collect(),
        };
        // A mark of the plant stands before the numbers of its state.
        let (state_size, distance_count) = (1 + host.state_size(), host.distance_count());
        Self { names, state_size, distance_count, moving: Mutex::new(moving) }
    }

    /// Works on the part that changes, unless another thread does.
    pub(crate) fn with<T>(&self, work: impl FnOnce(&mut Moving) -> Result<T, Refusal>) -> Result<T, Refusal> {
        locked(&self.moving, "plant", work)
    }
}

/// Works on what a lock guards, unless another thread does.
pub(crate) fn locked<M, T>(
    lock: &Mutex<M>,
    what: &str,
    work: impl FnOnce(&mut M) -> Result<T, Refusal>,
) -> Result<T, Refusal> {
    match lock.try_lock() {
        Ok(mut guarded) => work(&mut guarded),
        Err(TryLockError::WouldBlock) => Err(Refusal::new(
            Status::Busy,
            format!("error: another thread uses the {what}\n = help: give each thread its own, or wait"),
        )),
        Err(TryLockError::Poisoned(_)) => Err(Refusal::new(
            Status::Defect,
            format!(
                "error: a defect of the library has left the {what} half stepped\n = help: free it and make it again"
            ),
        )),
    }
}

/// The options as the host interface has them.
///
/// # Safety
/// The mode is NULL or text.
unsafe fn chosen<'a>(options: Option<&Options>) -> Result<HostOptions<'a>, Refusal> {
    let Some(Options { motion, command_mode, pulse_frequency, max_step }) = options else {
        return Ok(HostOptions::default());
    };
    let motion = match *motion {
        0 => mckibben_run::host::Motion::Host,
        1 => mckibben_run::host::Motion::Scenario,
        other => {
            return Err(Refusal::input(
                format!("options.motion = {other} is no motion"),
                "give MCKIBBEN_MOTION_HOST or MCKIBBEN_MOTION_SCENARIO",
            ));
        }
    };
    // SAFETY: NULL or text, as the caller promises.
    let command_mode = unsafe { text_if_any(*command_mode, "options.command_mode") }?;
    if let Some(other) = command_mode.filter(|mode| !COMMAND_MODES.contains(mode)) {
        return Err(Refusal::input(
            format!("options.command_mode = \"{other}\" is no mode of a command"),
            "give \"duty\", \"request\", \"position\" or \"set-point\", or NULL for each valve's own",
        ));
    }
    let if_any = |number: f64, name: &str, unit: &str, remedy: &str| match number {
        0.0 => Ok(None),
        _ if number.is_finite() && number > 0.0 => Ok(Some(number)),
        _ => Err(Refusal::input(format!("options.{name} = {number:?} {unit} is out of range"), remedy)),
    };
    Ok(HostOptions {
        motion,
        command_mode,
        pulse_frequency: if_any(
            *pulse_frequency,
            "pulse_frequency",
            "Hz",
            "give a frequency in Hz above zero, or 0 for that of the scenario",
        )?,
        max_step: if_any(
            *max_step,
            "max_step",
            "s",
            "give a time in s above zero, or 0 for steps that are not divided",
        )?,
        host_integrates: false,
    })
}

/// A refusal of options with their names in C, for messages that all hosts share.
fn in_words_of_c(refusal: Refusal, options: &HostOptions<'_>) -> Refusal {
    const WORDS: [(&str, &str); 3] = [
        ("command_mode=\"", "options.command_mode = \""),
        (", or a scenario with another", ", NULL for each valve's own mode, or a scenario with another"),
        ("give pulse_frequency in Hz", "give options.pulse_frequency in Hz"),
    ];
    if options.command_mode.is_none() {
        return refusal;
    }
    let text = WORDS.iter().fold(refusal.text, |text, (from, to)| text.replace(from, to));
    Refusal { text, ..refusal }
}

/// Reads a plant and hands it over.
///
/// # Safety
/// As the crate's documentation says of `options` and `plant`.
unsafe fn create(
    document: impl FnOnce() -> Result<Document, Refusal>,
    options: *const Options,
    plant: *mut *mut Plant,
) -> Result<(), Refusal> {
    // SAFETY: memory for a pointer, by the caller's promise.
    unsafe { write(plant, "plant", std::ptr::null_mut()) }?;
    let read = {
        // SAFETY: NULL or options, by the caller's promise.
        let options = if options.is_null() { None } else { Some(unsafe { reference(options, "options") }?) };
        // SAFETY: the mode is NULL or text, by the caller's promise.
        Plant::read(&document()?, &unsafe { chosen(options) }?)?
    };
    // SAFETY: as at the head.
    unsafe { write(plant, "plant", Box::into_raw(Box::new(read))) }
}

/// Reads the plant of a scenario from its text in TOML: one actuator, a joint, or many actuators on one air network. Its own
/// commands and controllers are not used. Where the scenario moves and has no `run.step`, reading runs it several times to find the
/// longest step that `run.accuracy` allows, which can take minutes. `name` stands for a file's name in messages; NULL for
/// "scenario.toml". `options` may be NULL. On success `*plant` is a plant to be freed by `mckibben_plant_free`; otherwise it is
/// NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_plant_from_text(
    text: *const c_char,
    name: *const c_char,
    options: *const Options,
    plant: *mut *mut Plant,
) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        unsafe { create(|| document_of(text, name), options, plant) }
    })
}

/// Reads the plant of a scenario from a file, whose path is UTF-8; otherwise as `mckibben_plant_from_text`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_plant_from_file(
    path: *const c_char,
    options: *const Options,
    plant: *mut *mut Plant,
) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        unsafe { create(|| document_at(path), options, plant) }
    })
}

/// The document of a text.
///
/// # Safety
/// The text is NULL or text, and so is its name.
pub(crate) unsafe fn document_of(content: *const c_char, name: *const c_char) -> Result<Document, Refusal> {
    // SAFETY: as the caller promises.
    let (content, name) = unsafe { (text(content, "text")?, text_if_any(name, "name")?) };
    Ok(Document::parse(content, name.unwrap_or("scenario.toml")).map_err(Failure::from)?)
}

/// The document of a file.
///
/// # Safety
/// The path is NULL or text.
pub(crate) unsafe fn document_at(path: *const c_char) -> Result<Document, Refusal> {
    // SAFETY: as the caller promises.
    Ok(Document::load(unsafe { text(path, "path") }?).map_err(Failure::from)?)
}

/// Copies a plant with the state that it is in; the copy is independent. On success `*copy` is to be freed by
/// `mckibben_plant_free`; otherwise it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_plant_clone(plant: *const Plant, copy: *mut *mut Plant) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let plant = unsafe {
            write(copy, "copy", std::ptr::null_mut())?;
            reference(plant, "plant")?
        };
        let moving = plant.with(|moving| Ok(moving.clone()))?;
        // SAFETY: as above.
        unsafe { write(copy, "copy", Box::into_raw(Box::new(Plant::of(moving)))) }
    })
}

/// Frees a plant, with the names that it has handed out. NULL is no mistake. A plant that has been freed, or that another thread
/// uses, must not be given: that cannot be checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_plant_free(plant: *mut Plant) {
    value((), || {
        if !plant.is_null() {
            // SAFETY: it was made by `Box::into_raw` here and has not been freed, by the caller's promise.
            drop(unsafe { Box::from_raw(plant) });
        }
        Ok(())
    });
}

/// A count of a plant; 0 for NULL.
///
/// # Safety
/// The pointer is NULL or a plant.
unsafe fn count(plant: *const Plant, of: impl FnOnce(&Plant) -> usize) -> usize {
    value(0, || {
        // SAFETY: as the caller promises.
        unsafe { reference(plant, "plant") }.map(of)
    })
}

/// Returns how many actuators there are; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_actuator_count(plant: *const Plant) -> usize {
    // SAFETY: the caller's promise.
    unsafe { count(plant, |plant| plant.names.actuators.len()) }
}

/// Returns how many valves are commanded; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_command_count(plant: *const Plant) -> usize {
    // SAFETY: the caller's promise.
    unsafe { count(plant, |plant| plant.names.commands.len()) }
}

/// Returns how many numbers `mckibben_outputs` writes; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_output_count(plant: *const Plant) -> usize {
    // SAFETY: the caller's promise.
    unsafe { count(plant, |plant| plant.names.outputs.len()) }
}

/// Returns how many distances `mckibben_advance` takes: one for each actuator, or 0 where the scenario moves; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_distance_count(plant: *const Plant) -> usize {
    // SAFETY: the caller's promise.
    unsafe { count(plant, |plant| plant.distance_count) }
}

/// Returns how many numbers a state is, as many at all times; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_state_size(plant: *const Plant) -> usize {
    // SAFETY: the caller's promise.
    unsafe { count(plant, |plant| plant.state_size) }
}

/// The entry of an index.
pub(crate) fn entry<'a, T>(all: &'a [T], index: usize, what: &str) -> Result<&'a T, Refusal> {
    let missing = || format!("there is no {what} {index}: there are {}", all.len());
    all.get(index).ok_or_else(|| Refusal::input(missing(), "count from 0, in their order"))
}

/// Returns the name of an actuator, counted from 0; NULL where there is none. Valid while the plant lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_actuator_name(plant: *const Plant, actuator: usize) -> *const c_char {
    value(std::ptr::null(), || {
        // SAFETY: the caller's promise.
        let plant = unsafe { reference(plant, "plant") }?;
        entry(&plant.names.actuators, actuator, "actuator").map(|name| name.as_ptr())
    })
}

/// Writes what a command is, counted from 0. Its texts are valid while the plant lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_command_describe(
    plant: *const Plant,
    command: usize,
    info: *mut CommandInfo,
) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let plant = unsafe { reference(plant, "plant") }?;
        let Commanded { name, mode, unit, range, pulse_frequency } = entry(&plant.names.commands, command, "command")?;
        let described = CommandInfo {
            name: name.as_ptr(),
            mode: mode.as_ptr(),
            unit: unit.as_ptr(),
            minimum: range.0,
            maximum: range.1,
            pulse_frequency: *pulse_frequency,
        };
        // SAFETY: the caller's promise.
        unsafe { write(info, "info", described) }
    })
}

/// Writes what an output is, counted from 0. Its texts are valid while the plant lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_output_describe(plant: *const Plant, output: usize, info: *mut OutputInfo) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let plant = unsafe { reference(plant, "plant") }?;
        let (name, unit) = entry(&plant.names.outputs, output, "output")?;
        // SAFETY: the caller's promise.
        unsafe { write(info, "info", OutputInfo { name: name.as_ptr(), unit: unit.as_ptr() }) }
    })
}

/// Writes the index of the output of a name, such as "biceps.gauge_pressure".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_output_index(plant: *const Plant, name: *const c_char, index: *mut usize) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let (plant, name) = unsafe { (reference(plant, "plant")?, text(name, "name")?) };
        let found = plant.names.outputs.iter().position(|(its, _)| its.to_bytes() == name.as_bytes());
        let names = || plant.names.outputs.iter().map(|(its, _)| its.to_string_lossy()).collect::<Vec<_>>().join(", ");
        let found = found.ok_or_else(|| {
            Refusal::input(format!("there is no output `{name}`"), &format!("give one of {}", names()))
        })?;
        // SAFETY: the caller's promise.
        unsafe { write(index, "index", found) }
    })
}
