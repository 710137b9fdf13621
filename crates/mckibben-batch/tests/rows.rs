//! Plants side by side: each is the run of its own steps, bit for bit.
//!
//! One program: the engine of plants is compiled once. `cargo test -p mckibben-batch NAME::` runs one file.

#[path = "../../mckibben/tests/common/mod.rs"]
mod common;

mod plant_batch;
mod plant_rows;
mod plant_set;
