//! The functions of FMI 2.0. Source: `fmi2Functions.h`, `fmi2FunctionTypes.h` and `fmi2TypesPlatform.h` of FMI 2.0.4.
//!
//! All variables are of type Real. Steps are done when `fmi2DoStep` returns, so that nothing is pending or cancelled.

// The names are those of the standard.
#![allow(non_snake_case)]

use super::{call, call_any, free, free_saved, hand_out, hold, list, list_mut, put, read_model, saved, to_c, words};
use crate::instance::{Instance, Kind, Logger, Phase, Refusal, Sink, Status};
use std::ffi::{c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

type Handle = *mut c_void;

/// `fmi2CallbackFunctions`.
#[repr(C)]
struct Callbacks {
    logger: Option<unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...)>,
    allocate: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    free: Option<unsafe extern "C" fn(*mut c_void)>,
    step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    environment: *mut c_void,
}

/// `fmi2EventInfo`.
#[repr(C)]
struct EventInfo {
    needs_update: c_int,
    terminates: c_int,
    nominals_changed: c_int,
    values_changed: c_int,
    has_next: c_int,
    next: f64,
}

/// A sink over the host's function, whose message is a format: a percent sign is doubled.
fn sink(callbacks: Option<&Callbacks>, name: &str) -> Option<Sink> {
    let callbacks = callbacks?;
    let (log, environment, name) = (callbacks.logger?, callbacks.environment.expose_provenance(), to_c(name));
    Some(Box::new(move |status, category, message| {
        let (category, message) = (to_c(category), to_c(&message.replace('%', "%%")));
        let environment = std::ptr::with_exposed_provenance_mut(environment);
        // SAFETY: the host's own function with the environment that it gave for it, texts that outlive the call, and a format
        // without arguments.
        unsafe { log(environment, name.as_ptr(), status as c_int, category.as_ptr(), message.as_ptr()) };
    }))
}

/// The folder of a URI such as `file:///tmp/unit/resources`, or of a plain path.
fn folder(location: &str) -> Option<PathBuf> {
    let path = match location.strip_prefix("file:") {
        // An authority is empty or names this machine.
        Some(rest) => match rest.strip_prefix("//") {
            Some(behind) => behind.find('/').map(|from| &behind[from..])?,
            None => rest,
        },
        None if location.contains("://") => return None,
        None => return Some(PathBuf::from(location)),
    };
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.as_bytes();
    while let Some((first, behind)) = rest.split_first() {
        let digits = behind.get(..2).filter(|_| *first == b'%').and_then(|digits| std::str::from_utf8(digits).ok());
        match digits.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &behind[2..];
            }
            None => {
                bytes.push(*first);
                rest = behind;
            }
        }
    }
    let path = String::from_utf8(bytes).ok()?;
    // On Windows a drive comes behind the first slash.
    let path = if cfg!(windows) { path.trim_start_matches('/').to_owned() } else { path };
    Some(PathBuf::from(path))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetDebugLogging(
    handle: Handle,
    is_on: c_int,
    count: usize,
    categories: *const *const c_char,
) -> c_int {
    call(handle, "fmi2SetDebugLogging", |instance| {
        // SAFETY: as FMI promises: `count` texts.
        let names = unsafe { list(categories, count) }?;
        // SAFETY: as above.
        let names = names.iter().filter_map(|name| unsafe { words(*name) }).collect();
        instance.log().set(is_on != 0, names).map_err(Refusal::error)
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    is_logging: c_int,
) -> Handle {
    // SAFETY: as FMI promises: texts and functions, or null.
    let (name, guid, resources, callbacks) =
        unsafe { (words(name), words(guid), words(resources), list(callbacks, usize::from(!callbacks.is_null()))) };
    let name = name.unwrap_or_else(|| "instance".to_owned());
    let log = Logger::new(sink(callbacks.ok().and_then(<[_]>::first), &name), is_logging != 0);
    let made = catch_unwind(AssertUnwindSafe(|| {
        let kind = match kind {
            0 => Kind::ModelExchange,
            1 => Kind::CoSimulation { event_mode: false, early_return: false },
            other => return Err(Refusal::error(format!("the type {other} of a unit is none"))),
        };
        Ok((read_model(resources.as_deref().and_then(folder), guid.as_deref(), kind)?, kind))
    }));
    match made.unwrap_or_else(|_| Err(Refusal::error("the library failed: report it with the unit"))) {
        Ok((model, kind)) => {
            catch_unwind(AssertUnwindSafe(|| Instance::new(model, kind, log))).ok().map_or(std::ptr::null_mut(), hold)
        }
        Err(refusal) => {
            log.refused(Status::Error, &format!("{name}: {}", refusal.message));
            std::ptr::null_mut()
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn fmi2FreeInstance(handle: Handle) {
    free(handle);
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetupExperiment(
    handle: Handle,
    has_tolerance: c_int,
    tolerance: f64,
    start: f64,
    has_stop: c_int,
    stop: f64,
) -> c_int {
    call(handle, "fmi2SetupExperiment", |instance| {
        instance.set_up((has_tolerance != 0).then_some(tolerance), start, (has_stop != 0).then_some(stop))
    })
}

verbs! {
    fmi2EnterInitializationMode => enter_initialization,
    fmi2ExitInitializationMode => exit_initialization,
    fmi2EnterEventMode => enter_event_mode,
    fmi2EnterContinuousTimeMode => enter_continuous,
    fmi2Terminate => terminate,
}

#[unsafe(no_mangle)]
extern "C" fn fmi2Reset(handle: Handle) -> c_int {
    call_any(handle, "fmi2Reset", true, Instance::reset)
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetReal(handle: Handle, references: *const u32, count: usize, values: *mut f64) -> c_int {
    call(handle, "fmi2GetReal", |instance| {
        // SAFETY: as FMI promises: `count` references and room for as many values.
        let (references, values) = unsafe { (list(references, count)?, list_mut(values, count)?) };
        instance.get(references, values)
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetReal(handle: Handle, references: *const u32, count: usize, values: *const f64) -> c_int {
    call(handle, "fmi2SetReal", |instance| {
        // SAFETY: as FMI promises: `count` references and as many values.
        let (references, values) = unsafe { (list(references, count)?, list(values, count)?) };
        instance.set(references, values)
    })
}

/// Getters and setters of types that no variable has.
macro_rules! typed {
    ($($what:literal: $type:ty, $get:ident, $set:ident;)*) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $get(handle: Handle, _references: *const u32, count: usize, _values: *mut $type) -> c_int {
            none_of(handle, stringify!($get), concat!("variables of type ", $what), count)
        }

        #[unsafe(no_mangle)]
        extern "C" fn $set(handle: Handle, _references: *const u32, count: usize, _values: *const $type) -> c_int {
            none_of(handle, stringify!($set), concat!("variables of type ", $what), count)
        }
    )*};
}

typed! {
    "Integer": c_int, fmi2GetInteger, fmi2SetInteger;
    "Boolean": c_int, fmi2GetBoolean, fmi2SetBoolean;
    "String": *const c_char, fmi2GetString, fmi2SetString;
}

/// Refuses what the unit has none of.
fn none_of(handle: Handle, function: &str, what: &str, count: usize) -> c_int {
    call(handle, function, |_| if count == 0 { Ok(()) } else { Err(Refusal::error(format!("the unit has no {what}"))) })
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetRealInputDerivatives(
    handle: Handle,
    _references: *const u32,
    count: usize,
    _orders: *const c_int,
    _values: *const f64,
) -> c_int {
    none_of(handle, "fmi2SetRealInputDerivatives", "derivatives of inputs: set the rates", count)
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetRealOutputDerivatives(
    handle: Handle,
    _references: *const u32,
    count: usize,
    _orders: *const c_int,
    _values: *mut f64,
) -> c_int {
    none_of(handle, "fmi2GetRealOutputDerivatives", "derivatives of outputs", count)
}

state_functions! {
    get: fmi2GetFMUstate,
    set: fmi2SetFMUstate,
    free: fmi2FreeFMUstate,
    size: fmi2SerializedFMUstateSize,
    serialize: fmi2SerializeFMUstate,
    deserialize: fmi2DeSerializeFMUstate,
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetDirectionalDerivative(
    handle: Handle,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    sensitivity: *mut f64,
) -> c_int {
    call(handle, "fmi2GetDirectionalDerivative", |instance| {
        // SAFETY: as FMI promises: as many references, seeds and places as the counts say.
        let (unknowns, knowns, seed, sensitivity) = unsafe {
            (
                list(unknowns, unknown_count)?,
                list(knowns, known_count)?,
                list(seed, known_count)?,
                list_mut(sensitivity, unknown_count)?,
            )
        };
        instance.directional((unknowns, knowns), seed, sensitivity)
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetTime(handle: Handle, time: f64) -> c_int {
    call(handle, "fmi2SetTime", |instance| instance.set_time(time))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetContinuousStates(handle: Handle, states: *const f64, count: usize) -> c_int {
    // SAFETY: as FMI promises: `count` states.
    call(handle, "fmi2SetContinuousStates", |instance| instance.set_states(unsafe { list(states, count) }?))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2NewDiscreteStates(handle: Handle, info: *mut EventInfo) -> c_int {
    call(handle, "fmi2NewDiscreteStates", |instance| {
        let update = instance.update()?;
        let has_next = update.next.is_finite();
        let said = EventInfo {
            needs_update: 0,
            terminates: 0,
            nominals_changed: c_int::from(update.events > 0),
            values_changed: c_int::from(update.has_moved),
            has_next: c_int::from(has_next),
            next: if has_next { update.next } else { 0.0 },
        };
        // SAFETY: as FMI promises: room for it, or null.
        unsafe { put(info, said) };
        Ok(())
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2CompletedIntegratorStep(
    handle: Handle,
    _no_set_state: c_int,
    enter_event_mode: *mut c_int,
    terminates: *mut c_int,
) -> c_int {
    call(handle, "fmi2CompletedIntegratorStep", |instance| {
        instance.completed_step()?;
        // SAFETY: as FMI promises: room for each, or null.
        unsafe {
            put(enter_event_mode, 0);
            put(terminates, 0);
        }
        Ok(())
    })
}

lists! {
    fmi2GetDerivatives => write_rates,
    fmi2GetEventIndicators => indicators,
    fmi2GetContinuousStates => states,
    fmi2GetNominalsOfContinuousStates => nominals,
}

#[unsafe(no_mangle)]
extern "C" fn fmi2DoStep(handle: Handle, time: f64, step: f64, _no_set_state: c_int) -> c_int {
    // A discarded step makes a host of FMI 2.0 try a shorter one; many do not, and would try the same step without end.
    let refused = |refusal: Refusal| Refusal::error(refusal.message);
    call(handle, "fmi2DoStep", |instance| instance.do_step(time, step).map(drop).map_err(refused))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2CancelStep(handle: Handle) -> c_int {
    none_of(handle, "fmi2CancelStep", "step under way: every step is done when it returns", 1)
}

/// `fmi2GetStatus` and its kin: kinds 0 and 1 are of steps that are pending, 2 is the last time that was reached, 3 whether
/// the unit has ended.
#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetStatus(handle: Handle, _kind: c_int, _value: *mut c_int) -> c_int {
    none_of(handle, "fmi2GetStatus", "step under way", 1)
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetRealStatus(handle: Handle, kind: c_int, value: *mut f64) -> c_int {
    call(handle, "fmi2GetRealStatus", |instance| {
        if kind != 2 {
            return Err(Refusal::error(format!("no status of kind {kind} is a number")));
        }
        // SAFETY: as FMI promises: room for a number.
        unsafe { list_mut(value, 1) }?[0] = instance.time();
        Ok(())
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetIntegerStatus(handle: Handle, _kind: c_int, _value: *mut c_int) -> c_int {
    none_of(handle, "fmi2GetIntegerStatus", "status that is a whole number", 1)
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetBooleanStatus(handle: Handle, kind: c_int, value: *mut c_int) -> c_int {
    call(handle, "fmi2GetBooleanStatus", |instance| {
        if kind != 3 {
            return Err(Refusal::error(format!("no status of kind {kind} is a truth value")));
        }
        // SAFETY: as FMI promises: room for a truth value.
        unsafe { list_mut(value, 1) }?[0] = c_int::from(instance.phase() == Phase::Terminated);
        Ok(())
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetStringStatus(handle: Handle, _kind: c_int, _value: *mut *const c_char) -> c_int {
    none_of(handle, "fmi2GetStringStatus", "status in words", 1)
}

#[cfg(test)]
mod tests {
    use super::folder;
    use std::path::Path;

    #[test]
    fn a_uri_is_a_folder() {
        for (uri, path) in [
            ("file:///tmp/a%20b/resources", Some("/tmp/a b/resources")),
            ("file:/tmp/r", Some("/tmp/r")),
            ("file://localhost/tmp/r", Some("/tmp/r")),
            ("/tmp/100%/r", Some("/tmp/100%/r")),
            ("file:///tmp/%zz", Some("/tmp/%zz")),
            ("https://example.org/r", None),
            ("file://nowhere", None),
        ] {
            assert_eq!(folder(uri).as_deref(), path.map(Path::new), "{uri}");
        }
    }
}
