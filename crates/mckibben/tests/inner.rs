//! Modules that no user sees, with the tests inside them. They are compiled here separately: a test build of the whole core
//! would take minutes for them.

#[allow(dead_code, unreachable_pub, reason = "what only the engines use")]
#[path = "../src/engine/bernstein.rs"]
mod bernstein;
// What it takes from the core by `crate::scalar`.
use mckibben::scalar;

#[allow(unreachable_pub, reason = "what the fits use")]
#[path = "../src/root.rs"]
mod root;
