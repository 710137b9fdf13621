//! Pointers from C, checked as far as they can be and turned into references.
//!
//! Each function here is unsafe for one reason: what lies behind a pointer that is neither NULL nor misaligned is the caller's
//! promise, which the documentation of the crate states.

use crate::status::{Refusal, Status};
use std::ffi::{CStr, c_char};

/// That a pointer can point to something.
pub(crate) fn check<T>(pointer: *const T, name: &str) -> Result<(), Refusal> {
    let what = match (pointer.is_null(), pointer.is_aligned()) {
        (true, _) => "is NULL",
        (_, false) => "is not aligned for what it points to",
        _ => return Ok(()),
    };
    Err(Refusal::new(
        Status::Pointer,
        format!("error: `{name}` {what}\n = help: give the address of what `{name}` is in mckibben.h"),
    ))
}

/// That an array can lie in memory.
fn check_array<T>(pointer: *const T, count: usize, name: &str) -> Result<(), Refusal> {
    check(pointer, name)?;
    if count.checked_mul(size_of::<T>()).is_none_or(|bytes| bytes > isize::MAX as usize) {
        return Err(Refusal::new(
            Status::Count,
            format!("error: `{name}` has {count} elements, more than memory can hold\n = help: give its true size"),
        ));
    }
    Ok(())
}

/// What a pointer points to.
///
/// # Safety
/// Unless it is NULL or misaligned, it points to a live `T` that no other code writes during `'a`.
pub(crate) unsafe fn reference<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Refusal> {
    check(pointer, name)?;
    // SAFETY: neither NULL nor misaligned, and live by the caller's promise.
    Ok(unsafe { &*pointer })
}

/// An array that is read; empty for a count of zero, whatever the pointer.
///
/// # Safety
/// Unless it is NULL or misaligned, it points to `count` elements that no other code writes during `'a`.
pub(crate) unsafe fn array<'a, T>(pointer: *const T, count: usize, name: &str) -> Result<&'a [T], Refusal> {
    if count == 0 {
        return Ok(&[]);
    }
    check_array(pointer, count, name)?;
    // SAFETY: neither NULL nor misaligned, no longer than memory, and so many elements by the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// An array that is written; empty for a count of zero, whatever the pointer.
///
/// # Safety
/// Unless it is NULL or misaligned, it points to `count` elements, of any value, that no other code uses during `'a`.
pub(crate) unsafe fn array_mut<'a, T: Plain>(
    pointer: *mut T,
    count: usize,
    name: &str,
) -> Result<&'a mut [T], Refusal> {
    if count == 0 {
        return Ok(&mut []);
    }
    check_array(pointer, count, name)?;
    // SAFETY: neither NULL nor misaligned, no longer than memory, and so many elements, used by no other code, by the
    // caller's promise; any bits are a value of a `Plain` type.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// Types of which any bits are a value.
pub(crate) trait Plain {}

impl Plain for f64 {}
impl Plain for crate::step::Response {}

/// Writes a result to where the caller wants it.
///
/// # Safety
/// Unless it is NULL or misaligned, it points to memory for a `T` that no other code uses.
pub(crate) unsafe fn write<T>(pointer: *mut T, name: &str, result: T) -> Result<(), Refusal> {
    check(pointer, name)?;
    // SAFETY: neither NULL nor misaligned, and memory for a `T` by the caller's promise.
    unsafe { pointer.write(result) };
    Ok(())
}

/// Text in UTF-8.
///
/// # Safety
/// Unless it is NULL, it points to text with a zero byte at its end that no other code writes during `'a`.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str, Refusal> {
    check(pointer, name)?;
    // SAFETY: not NULL, and text with a zero byte at its end by the caller's promise.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|error| Refusal::input(format!("`{name}` is no UTF-8: {error}"), "give text in UTF-8"))
}

/// Text in UTF-8, or none for NULL.
///
/// # Safety
/// As [`text`].
pub(crate) unsafe fn text_if_any<'a>(pointer: *const c_char, name: &str) -> Result<Option<&'a str>, Refusal> {
    // SAFETY: as the caller promises.
    if pointer.is_null() { Ok(None) } else { unsafe { text(pointer, name) }.map(Some) }
}
