//! What functions return, the text of the last error of a thread, and the barrier that no panic crosses.
//!
//! Checked by `tests/interface/boundary.rs`.

use mckibben_run::failure::{Failure, Reason};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a function returns. `mckibben_last_error` has the text of every status but `MCKIBBEN_STATUS_OK`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(C)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// The scenario, a value, an index or an option is wrong. Nothing has changed, but for commands of a batch's step: see
    /// `mckibben_batch_step`.
    Input = 2,
    /// The simulation could not go on. The plant is where it was; of a batch it has stopped.
    Stopped = 3,
    /// A pointer is NULL or not aligned for what it points to. Nothing has changed.
    Pointer = 5,
    /// An array has more or fewer elements than the plant needs. Nothing has changed.
    Count = 6,
    /// Another thread uses the plant or the batch at this moment. Nothing has changed.
    Busy = 7,
    /// A defect of the library, which its text describes. Free the plant; no other function accepts it any more.
    Defect = 8,
}

/// A status other than [`Status::Ok`], with its text.
#[derive(Debug)]
pub(crate) struct Refusal {
    pub(crate) status: Status,
    pub(crate) text: String,
}

impl Refusal {
    pub(crate) fn new(status: Status, text: impl Into<String>) -> Self {
        Self { status, text: text.into() }
    }

    /// A wrong value, and what to do about it.
    pub(crate) fn input(what: impl std::fmt::Display, remedy: &str) -> Self {
        Failure::input(what.to_string(), remedy).into()
    }

    /// An array of another size than the plant's.
    pub(crate) fn count(what: &str, given: usize, due: usize, function: &str) -> Self {
        Self::new(
            Status::Count,
            format!("error: {what}: {given} given, but it takes {due}\n = help: give as many as {function} returns"),
        )
    }
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        let status = match failure.reason() {
            Reason::Input => Status::Input,
            Reason::Stopped | Reason::Output => Status::Stopped,
        };
        Self::new(status, failure.to_string())
    }
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Text for C: a zero byte within it, which would end it, is replaced.
pub(crate) fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default()
}

/// Keeps the text of a refusal for [`mckibben_last_error`].
pub(crate) fn keep(refusal: &Refusal) {
    // A thread that is ending keeps none.
    let _ = LAST.try_with(|last| last.replace(c_text(&refusal.text)));
}

/// Does the work of a function; a panic becomes a refusal.
pub(crate) fn caught<T>(work: impl FnOnce() -> Result<T, Refusal>) -> Result<T, Refusal> {
    // What a panic left half done stays behind a poisoned lock.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<String>().map(String::as_str);
        let words = words.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no text");
        Err(Refusal::new(
            Status::Defect,
            format!("error: a defect of the library: {words}\n = help: free the plant, and report what led to this"),
        ))
    })
}

/// Does the work of a function that returns a status.
pub(crate) fn status(work: impl FnOnce() -> Result<(), Refusal>) -> Status {
    match caught(work) {
        Ok(()) => Status::Ok,
        Err(refusal) => {
            keep(&refusal);
            refusal.status
        }
    }
}

/// Does the work of a function that returns a value, or `otherwise` where it is refused.
pub(crate) fn value<T>(otherwise: T, work: impl FnOnce() -> Result<T, Refusal>) -> T {
    caught(work).unwrap_or_else(|refusal| {
        keep(&refusal);
        otherwise
    })
}

/// Returns the version of the library, such as "0.1.0". The text is constant.
#[unsafe(no_mangle)]
pub extern "C" fn mckibben_version() -> *const c_char {
    const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => c"",
    };
    VERSION.as_ptr()
}

/// Returns what the last function that failed in this thread refused, and what to do about it, in UTF-8: several lines for a
/// mistake in a scenario, which show its place. Empty where none has failed, never NULL. Valid until the next failure in this
/// thread; a success leaves it as it is.
#[unsafe(no_mangle)]
pub extern "C" fn mckibben_last_error() -> *const c_char {
    LAST.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}
