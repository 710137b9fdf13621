//! Plants side by side: each is bit-identical to a scalar instance.
//!
//! One program: the engine of plants is compiled once. `cargo test -p mckibben-batch NAME::` runs one file.

#[path = "../../mckibben/tests/common/mod.rs"]
mod common;

mod plant_batch;
mod plant_given;
mod plant_moves;
mod plant_rows;
mod plant_set;
mod single;
