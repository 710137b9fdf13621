//! The interface, called from Rust as C calls it. Each call is unsafe for its pointers: here they point to variables of the test
//! that live as long as the call, or are such as the library refuses.

mod boundary;
mod common;
mod fuzz;
mod header;
mod many;
mod simulation;
