//! The functions of FMI 3.0. Source: `fmi3Functions.h`, `fmi3FunctionTypes.h` and `fmi3PlatformTypes.h` of FMI 3.0.2.
//!
//! All variables are of type Float64; there are no clocks and no structural parameters. The functions for those are there, as
//! a host may load all of them, and refuse everything but empty lists.

// The names are those of the standard.
#![allow(non_snake_case)]

use super::{call, call_any, free, free_saved, hand_out, hold, list, list_mut, put, read_model, saved, to_c, words};
use crate::instance::{Instance, Kind, Logger, Refusal, Sink, Status};
use std::ffi::{c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

type Handle = *mut c_void;
type LogMessage = Option<unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char)>;

/// A sink over the host's function.
fn sink(environment: *mut c_void, log: LogMessage) -> Option<Sink> {
    let (log, environment) = (log?, environment.expose_provenance());
    Some(Box::new(move |status, category, message| {
        let (category, message) = (to_c(category), to_c(message));
        let environment = std::ptr::with_exposed_provenance_mut(environment);
        // SAFETY: the host's own function with the environment that it gave for it, and texts that outlive the call.
        unsafe { log(environment, status as c_int, category.as_ptr(), message.as_ptr()) };
    }))
}

/// Makes an instance, or logs why not.
fn instantiate(
    (name, token, resources): (Option<String>, Option<String>, Option<String>),
    kind: Kind,
    is_logging: bool,
    sink: Option<Sink>,
) -> Handle {
    let log = Logger::new(sink, is_logging);
    let model = catch_unwind(AssertUnwindSafe(|| read_model(resources.map(PathBuf::from), token.as_deref(), kind)));
    let model = model.unwrap_or_else(|_| Err(Refusal::error("the library failed: report it with the unit")));
    match model {
        Ok(model) => {
            catch_unwind(AssertUnwindSafe(|| Instance::new(model, kind, log))).ok().map_or(std::ptr::null_mut(), hold)
        }
        Err(refusal) => {
            let message = format!("{}: {}", name.as_deref().unwrap_or("instance"), refusal.message);
            log.refused(Status::Error, &message);
            std::ptr::null_mut()
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetDebugLogging(
    handle: Handle,
    is_on: bool,
    count: usize,
    categories: *const *const c_char,
) -> c_int {
    call(handle, "fmi3SetDebugLogging", |instance| {
        // SAFETY: as FMI promises: `count` texts.
        let names = unsafe { list(categories, count) }?;
        // SAFETY: as above.
        let names = names.iter().filter_map(|name| unsafe { words(*name) }).collect();
        instance.log().set(is_on, names).map_err(Refusal::error)
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateModelExchange(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    is_logging: bool,
    environment: *mut c_void,
    log: LogMessage,
) -> Handle {
    // SAFETY: as FMI promises: texts, or null.
    let texts = unsafe { (words(name), words(token), words(resources)) };
    instantiate(texts, Kind::ModelExchange, is_logging, sink(environment, log))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateCoSimulation(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    is_logging: bool,
    event_mode: bool,
    early_return: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    log: LogMessage,
    _update: Option<unsafe extern "C" fn()>,
) -> Handle {
    // SAFETY: as FMI promises: texts, or null.
    let texts = unsafe { (words(name), words(token), words(resources)) };
    instantiate(texts, Kind::CoSimulation { event_mode, early_return }, is_logging, sink(environment, log))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _is_logging: bool,
    environment: *mut c_void,
    log: LogMessage,
    _update: Option<unsafe extern "C" fn()>,
    _lock: Option<unsafe extern "C" fn()>,
    _unlock: Option<unsafe extern "C" fn()>,
) -> Handle {
    // SAFETY: as FMI promises: a text, or null.
    let name = unsafe { words(name) }.unwrap_or_default();
    let log = Logger::new(sink(environment, log), false);
    log.refused(Status::Error, &format!("{name}: the unit has no scheduled execution"));
    std::ptr::null_mut()
}

#[unsafe(no_mangle)]
extern "C" fn fmi3FreeInstance(handle: Handle) {
    free(handle);
}

#[unsafe(no_mangle)]
extern "C" fn fmi3EnterInitializationMode(
    handle: Handle,
    has_tolerance: bool,
    tolerance: f64,
    start: f64,
    has_stop: bool,
    stop: f64,
) -> c_int {
    call(handle, "fmi3EnterInitializationMode", |instance| {
        instance.set_up(has_tolerance.then_some(tolerance), start, has_stop.then_some(stop))?;
        instance.enter_initialization()
    })
}

verbs! {
    fmi3ExitInitializationMode => exit_initialization,
    fmi3EnterEventMode => enter_event_mode,
    fmi3EnterStepMode => enter_step_mode,
    fmi3EnterContinuousTimeMode => enter_continuous,
    fmi3Terminate => terminate,
}

#[unsafe(no_mangle)]
extern "C" fn fmi3Reset(handle: Handle) -> c_int {
    call_any(handle, "fmi3Reset", true, Instance::reset)
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFloat64(
    handle: Handle,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> c_int {
    call(handle, "fmi3GetFloat64", |instance| {
        // SAFETY: as FMI promises: `count` references and room for `value_count` values.
        let (references, values) = unsafe { (list(references, count)?, list_mut(values, value_count)?) };
        instance.get(references, values)
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFloat64(
    handle: Handle,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> c_int {
    call(handle, "fmi3SetFloat64", |instance| {
        // SAFETY: as FMI promises: `count` references and `value_count` values.
        let (references, values) = unsafe { (list(references, count)?, list(values, value_count)?) };
        instance.set(references, values)
    })
}

/// Refuses what the unit has none of.
fn none_of(handle: Handle, function: &str, what: &str, count: usize) -> c_int {
    call(handle, function, |_| if count == 0 { Ok(()) } else { Err(Refusal::error(format!("the unit has no {what}"))) })
}

/// Getters and setters of types that no variable has.
macro_rules! typed {
    ($($what:literal: $type:ty, $get:ident, $set:ident;)*) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $get(handle: Handle, _references: *const u32, count: usize, _values: *mut $type, _: usize) -> c_int {
            none_of(handle, stringify!($get), concat!("variables of type ", $what), count)
        }

        #[unsafe(no_mangle)]
        extern "C" fn $set(handle: Handle, _references: *const u32, count: usize, _values: *const $type, _: usize) -> c_int {
            none_of(handle, stringify!($set), concat!("variables of type ", $what), count)
        }
    )*};
}

typed! {
    "Float32": f32, fmi3GetFloat32, fmi3SetFloat32;
    "Int8": i8, fmi3GetInt8, fmi3SetInt8;
    "UInt8": u8, fmi3GetUInt8, fmi3SetUInt8;
    "Int16": i16, fmi3GetInt16, fmi3SetInt16;
    "UInt16": u16, fmi3GetUInt16, fmi3SetUInt16;
    "Int32": i32, fmi3GetInt32, fmi3SetInt32;
    "UInt32": u32, fmi3GetUInt32, fmi3SetUInt32;
    "Int64": i64, fmi3GetInt64, fmi3SetInt64;
    "UInt64": u64, fmi3GetUInt64, fmi3SetUInt64;
    "Boolean": bool, fmi3GetBoolean, fmi3SetBoolean;
    "String": *const c_char, fmi3GetString, fmi3SetString;
}

/// Functions for what no unit has, with the place of the count among their arguments.
macro_rules! absent {
    ($($what:literal: $function:ident($($argument:ident: $type:ty),*), $count:expr;)*) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $function(handle: Handle, $($argument: $type),*) -> c_int {
            $(let _ = $argument;)*
            none_of(handle, stringify!($function), $what, $count)
        }
    )*};
}

absent! {
    "variables of type Binary": fmi3GetBinary(of: *const u32, count: usize, sizes: *mut usize, values: *mut *const u8, n: usize), count;
    "variables of type Binary": fmi3SetBinary(of: *const u32, count: usize, sizes: *const usize, values: *const *const u8, n: usize), count;
    "clocks": fmi3GetClock(of: *const u32, count: usize, values: *mut bool), count;
    "clocks": fmi3SetClock(of: *const u32, count: usize, values: *const bool), count;
    "clocks": fmi3GetIntervalDecimal(of: *const u32, count: usize, values: *mut f64, kinds: *mut c_int), count;
    "clocks": fmi3GetIntervalFraction(of: *const u32, count: usize, a: *mut u64, b: *mut u64, kinds: *mut c_int), count;
    "clocks": fmi3GetShiftDecimal(of: *const u32, count: usize, values: *mut f64), count;
    "clocks": fmi3GetShiftFraction(of: *const u32, count: usize, a: *mut u64, b: *mut u64), count;
    "clocks": fmi3SetIntervalDecimal(of: *const u32, count: usize, values: *const f64), count;
    "clocks": fmi3SetIntervalFraction(of: *const u32, count: usize, a: *const u64, b: *const u64), count;
    "clocks": fmi3SetShiftDecimal(of: *const u32, count: usize, values: *const f64), count;
    "clocks": fmi3SetShiftFraction(of: *const u32, count: usize, a: *const u64, b: *const u64), count;
    "derivatives of outputs": fmi3GetOutputDerivatives(of: *const u32, count: usize, orders: *const i32, values: *mut f64, n: usize), count;
    "structural parameters": fmi3EnterConfigurationMode(), 1;
    "structural parameters": fmi3ExitConfigurationMode(), 1;
    "clocks": fmi3ActivateModelPartition(clock: u32, time: f64), 1;
    "adjoint derivatives": fmi3GetAdjointDerivative(unknowns: *const u32, a: usize, knowns: *const u32, b: usize, seed: *const f64, c: usize, out: *mut f64, d: usize), 1;
    "list of dependencies": fmi3GetNumberOfVariableDependencies(of: u32, count: *mut usize), 1;
    "list of dependencies": fmi3GetVariableDependencies(of: u32, a: *mut usize, b: *mut u32, c: *mut usize, kinds: *mut c_int, n: usize), 1;
}

state_functions! {
    get: fmi3GetFMUState,
    set: fmi3SetFMUState,
    free: fmi3FreeFMUState,
    size: fmi3SerializedFMUStateSize,
    serialize: fmi3SerializeFMUState,
    deserialize: fmi3DeserializeFMUState,
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetDirectionalDerivative(
    handle: Handle,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> c_int {
    call(handle, "fmi3GetDirectionalDerivative", |instance| {
        // SAFETY: as FMI promises: as many references, seeds and places as the counts say.
        let (unknowns, knowns, seed, sensitivity) = unsafe {
            (
                list(unknowns, unknown_count)?,
                list(knowns, known_count)?,
                list(seed, seed_count)?,
                list_mut(sensitivity, sensitivity_count)?,
            )
        };
        instance.directional((unknowns, knowns), seed, sensitivity)
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3EvaluateDiscreteStates(handle: Handle) -> c_int {
    call(handle, "fmi3EvaluateDiscreteStates", |_| Ok(()))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3UpdateDiscreteStates(
    handle: Handle,
    needs_update: *mut bool,
    terminates: *mut bool,
    nominals_changed: *mut bool,
    values_changed: *mut bool,
    has_next: *mut bool,
    next: *mut f64,
) -> c_int {
    call(handle, "fmi3UpdateDiscreteStates", |instance| {
        let update = instance.update()?;
        // SAFETY: as FMI promises: room for each, or null.
        unsafe {
            put(needs_update, false);
            put(terminates, false);
            put(nominals_changed, update.events > 0);
            put(values_changed, update.has_moved);
            put(has_next, update.next.is_finite());
            put(next, if update.next.is_finite() { update.next } else { 0.0 });
        }
        Ok(())
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3CompletedIntegratorStep(
    handle: Handle,
    _no_set_state: bool,
    enter_event_mode: *mut bool,
    terminates: *mut bool,
) -> c_int {
    call(handle, "fmi3CompletedIntegratorStep", |instance| {
        instance.completed_step()?;
        // SAFETY: as FMI promises: room for each, or null.
        unsafe {
            put(enter_event_mode, false);
            put(terminates, false);
        }
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3SetTime(handle: Handle, time: f64) -> c_int {
    call(handle, "fmi3SetTime", |instance| instance.set_time(time))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetContinuousStates(handle: Handle, states: *const f64, count: usize) -> c_int {
    // SAFETY: as FMI promises: `count` states.
    call(handle, "fmi3SetContinuousStates", |instance| instance.set_states(unsafe { list(states, count) }?))
}

lists! {
    fmi3GetContinuousStateDerivatives => write_rates,
    fmi3GetEventIndicators => indicators,
    fmi3GetContinuousStates => states,
    fmi3GetNominalsOfContinuousStates => nominals,
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNumberOfEventIndicators(handle: Handle, count: *mut usize) -> c_int {
    call(handle, "fmi3GetNumberOfEventIndicators", |instance| {
        // SAFETY: as FMI promises: room for a count.
        unsafe { list_mut(count, 1) }?[0] = instance.indicator_count();
        Ok(())
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNumberOfContinuousStates(handle: Handle, count: *mut usize) -> c_int {
    call(handle, "fmi3GetNumberOfContinuousStates", |instance| {
        // SAFETY: as FMI promises: room for a count.
        unsafe { list_mut(count, 1) }?[0] = instance.state_count();
        Ok(())
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DoStep(
    handle: Handle,
    time: f64,
    step: f64,
    _no_set_state: bool,
    event_needed: *mut bool,
    terminates: *mut bool,
    is_early: *mut bool,
    reached: *mut f64,
) -> c_int {
    call(handle, "fmi3DoStep", |instance| {
        // SAFETY: as FMI promises: room for each, or null.
        let set_outputs = |needs_event: bool, early: bool, time: f64| unsafe {
            put(event_needed, needs_event);
            put(terminates, false);
            put(is_early, early);
            put(reached, time);
        };
        if step == 0.0 {
            return Err(Refusal::error("a step of 0 s is none; give one above zero"));
        }
        match instance.do_step(time, step) {
            Ok(end) => {
                set_outputs(end.is_event, end.is_early, end.time);
                Ok(())
            }
            Err(refusal) => {
                set_outputs(false, false, instance.time());
                Err(refusal)
            }
        }
    })
}
