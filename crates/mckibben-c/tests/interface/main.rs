//! The interface, called from Rust as C calls it.

mod boundary;
mod common;
mod fuzz;
mod header;
mod many;
mod simulation;
