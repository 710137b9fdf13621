//! What the commands print and write.
//!
//! One program: what the tests share is compiled and linked once. `cargo test --test commands NAME::` runs one file.

mod accuracy_table;
mod common;

mod accuracy;
mod architecture;
mod bad_input;
mod completions;
mod control;
mod curves;
mod design;
mod figure;
mod fmu;
mod gallery;
mod identify;
mod identify_ends;
mod identify_failures;
mod identify_valve;
mod keys;
mod linearize;
mod output;
mod pages;
mod plant;
mod regulator;
mod reproduce;
mod settle;
mod simulate;
mod size;
mod streamed;
mod sweep;
mod sweep_folder;
mod tendon;
mod units;
mod validation;
mod warnings;
