//! The functions of FMI as C calls them: pointers to slices, results to statuses.
//!
//! A host never holds a pointer into this library: what it gets is a number that [`Table`] knows, so that an instance that
//! was freed, or never was, is an error and no crash. No panic crosses the border: it becomes an error of the instance, which
//! then refuses everything but to be reset or freed. What a host must keep to is only this: a pointer that is not null points
//! to as many elements as the call says, and texts end in a null byte.

#[macro_use]
mod shared;
mod fmi2;
mod fmi3;

use crate::instance::{Instance, Kind, Refusal, Saved, Status};
use crate::model::Model;
use std::collections::HashMap;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

/// References and values in one call at most: beyond lies no list, but a count that was never set.
const MOST: usize = 1 << 24;

/// The instances of hosts, by their handles.
struct Table<T> {
    next: usize,
    entries: Option<HashMap<usize, T>>,
}

impl<T> Table<T> {
    const fn new() -> Self {
        // Numbers that no address has: odd, and low.
        Self { next: 1, entries: None }
    }

    fn add(&mut self, entry: T) -> *mut c_void {
        let number = self.next;
        self.next += 2;
        self.entries.get_or_insert_default().insert(number, entry);
        std::ptr::without_provenance_mut(number)
    }

    fn get(&self, handle: *const c_void) -> Option<&T> {
        self.entries.as_ref()?.get(&handle.addr())
    }

    fn remove(&mut self, handle: *const c_void) -> Option<T> {
        self.entries.as_mut()?.remove(&handle.addr())
    }
}

/// An instance as its host has it.
struct Held {
    instance: Instance,
    /// A panic has left it in an unknown state.
    is_broken: bool,
}

static INSTANCES: RwLock<Table<Arc<Mutex<Held>>>> = RwLock::new(Table::new());
static STATES: RwLock<Table<Arc<Saved>>> = RwLock::new(Table::new());

/// Hands an instance to its host.
fn hold(instance: Instance) -> *mut c_void {
    let held = Arc::new(Mutex::new(Held { instance, is_broken: false }));
    INSTANCES.write().unwrap_or_else(PoisonError::into_inner).add(held)
}

/// Frees an instance; nothing where there is none.
fn free(handle: *mut c_void) {
    let held = INSTANCES.write().unwrap_or_else(PoisonError::into_inner).remove(handle);
    // What a host does in its log must not end the process.
    let _ = catch_unwind(AssertUnwindSafe(|| drop(held)));
}

/// Calls a verb of an instance, and logs why it refuses.
fn call(handle: *mut c_void, verb: &str, act: impl FnOnce(&mut Instance) -> Result<(), Refusal>) -> c_int {
    call_any(handle, verb, false, act)
}

/// As [`call`]; a verb that `repairs` an instance is called even where a panic has left it.
fn call_any(
    handle: *mut c_void,
    verb: &str,
    repairs: bool,
    act: impl FnOnce(&mut Instance) -> Result<(), Refusal>,
) -> c_int {
    let held = INSTANCES.read().unwrap_or_else(PoisonError::into_inner).get(handle).cloned();
    let Some(held) = held else { return Status::Error as c_int };
    // A host that calls from within its own log, or from two threads at once, must not wait for itself.
    let Some(mut held) = try_lock(&held) else { return Status::Error as c_int };
    let Held { instance, is_broken } = &mut *held;
    let done = catch_unwind(AssertUnwindSafe(|| {
        if *is_broken && !repairs {
            return Err(Refusal::error("the instance failed before: reset or free it"));
        }
        act(instance)
    }));
    let refusal = match done {
        Ok(Ok(())) => {
            *is_broken &= !repairs;
            return Status::Ok as c_int;
        }
        Ok(Err(refusal)) => refusal,
        Err(_) => {
            *is_broken = true;
            Refusal::error("the library failed: report it with the unit; the instance can be reset or freed")
        }
    };
    let message = format!("{verb}: {}", refusal.message);
    let _ = catch_unwind(AssertUnwindSafe(|| instance.log().refused(refusal.status, &message)));
    refusal.status as c_int
}

fn try_lock(held: &Mutex<Held>) -> Option<MutexGuard<'_, Held>> {
    match held.try_lock() {
        Ok(guard) => Some(guard),
        Err(std::sync::TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
        Err(std::sync::TryLockError::WouldBlock) => None,
    }
}

/// Calls a verb that returns a saved state.
fn hand_out(saved: Saved) -> *mut c_void {
    STATES.write().unwrap_or_else(PoisonError::into_inner).add(Arc::new(saved))
}

/// The saved state of a handle.
fn saved(handle: *const c_void) -> Result<Arc<Saved>, Refusal> {
    let states = STATES.read().unwrap_or_else(PoisonError::into_inner);
    states.get(handle).cloned().ok_or_else(|| Refusal::error("there is no such saved state"))
}

fn free_saved(handle: *mut c_void) {
    drop(STATES.write().unwrap_or_else(PoisonError::into_inner).remove(handle));
}

/// The elements of a host's array.
///
/// # Safety
/// Unless it is null, `pointer` points to `count` elements that no other code writes to during the call.
unsafe fn list<'a, T>(pointer: *const T, count: usize) -> Result<&'a [T], Refusal> {
    check(pointer, count)?;
    if count == 0 {
        return Ok(&[]);
    }
    // SAFETY: not null, aligned and of a length that fits memory, by the check; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// The elements of a host's array, to be written.
///
/// # Safety
/// Unless it is null, `pointer` points to `count` initialised elements that no other code uses during the call.
unsafe fn list_mut<'a, T>(pointer: *mut T, count: usize) -> Result<&'a mut [T], Refusal> {
    check(pointer, count)?;
    if count == 0 {
        return Ok(&mut []);
    }
    // SAFETY: as in `list`.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

fn check<T>(pointer: *const T, count: usize) -> Result<(), Refusal> {
    if count == 0 {
        return Ok(());
    }
    if pointer.is_null() {
        return Err(Refusal::error(format!("a null pointer is given for {count} elements")));
    }
    if count > MOST {
        return Err(Refusal::error(format!("{count} elements are given, which is no list of this unit's")));
    }
    if !pointer.is_aligned() {
        return Err(Refusal::error("a pointer is not aligned to its elements"));
    }
    Ok(())
}

/// Writes one value of a host; nothing to a null pointer.
///
/// # Safety
/// Unless it is null, `pointer` can be written to.
unsafe fn put<T>(pointer: *mut T, value: T) {
    if !pointer.is_null() && pointer.is_aligned() {
        // SAFETY: neither null nor unaligned; the rest is the caller's promise.
        unsafe { pointer.write(value) };
    }
}

/// A host's text; none where it is null.
///
/// # Safety
/// Unless it is null, `text` ends in a null byte.
unsafe fn words(text: *const c_char) -> Option<String> {
    if text.is_null() {
        return None;
    }
    // SAFETY: not null; that it ends is the caller's promise.
    Some(unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned())
}

/// A text as C has it.
fn to_c(text: &str) -> std::ffi::CString {
    std::ffi::CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// Reads the model of a unit whose resources are in a folder, and checks that it is the one that the host has described and has
/// the interface that the host uses.
fn read_model(resources: Option<PathBuf>, token: Option<&str>, kind: Kind) -> Result<Model, Refusal> {
    let resources = resources.ok_or_else(|| Refusal::error("no folder of resources is given"))?;
    let model = Model::read(&resources)?;
    if token != Some(model.token()) {
        return Err(Refusal::error(format!(
            "the token is {}, but that of the unit is {}: description and resources are of two units",
            token.unwrap_or("none"),
            model.token()
        )));
    }
    let interfaces = model.options().interfaces;
    let is_offered = match kind {
        Kind::ModelExchange => interfaces.has_model_exchange(),
        Kind::CoSimulation { .. } => interfaces.has_co_simulation(),
    };
    if !is_offered {
        return Err(Refusal::error(format!("the unit was written for {} alone", interfaces.name())));
    }
    Ok(model)
}
