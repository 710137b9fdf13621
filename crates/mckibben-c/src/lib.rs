//! The C library: a scenario as a plant that a host in C or C++ steps, and whole runs of scenarios.
//!
//! Each function adapts [`HostPlant`](mckibben_run::host::HostPlant), [`HostBatch`](mckibben_run::host::HostBatch) or [`Ready`](mckibben_run::run::Ready) to C; there is no
//! physics here. `include/mckibben.h` is the interface in C, generated from this crate; `docs/c.md` introduces it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`status`] | what functions return, the text of the last error, and the barrier that no panic crosses |
//! | [`plant`] | reading, copying and freeing a plant; names, units and counts |
//! | [`step`] | commands, steps, responses, outputs, saving and restoring |
//! | [`many`] | many plants side by side, on the caller's arrays |
//! | [`simulation`] | a whole run of a scenario as columns |
//!
//! # What a caller promises
//!
//! The functions are unsafe in Rust because a pointer from C cannot be checked in full. Each pointer is checked for NULL and for
//! alignment, and each count against the plant's. What remains is the caller's part, once for all functions:
//!
//! - a plant, a batch or a run comes from this library and has not been freed;
//! - an array has as many elements as the count says, and no array that is written overlaps another argument;
//! - text ends with a zero byte and does not change during the call.
//!
//! A plant that two threads use at once is safe: the second call returns [`Status::Busy`](status::Status::Busy). A plant must
//! not be freed while another thread uses it.
//!
//! Checked by `tests/system/examples.rs` in C and C++ under Valgrind and with sanitizers, by `tests/interface/boundary.rs` and by `tests/interface/fuzz.rs`.

// The contract of all pointers is stated once, above.
#![allow(clippy::missing_safety_doc)]
#![deny(clippy::undocumented_unsafe_blocks)]

pub mod many;
mod memory;
pub mod plant;
pub mod simulation;
pub mod status;
pub mod step;
