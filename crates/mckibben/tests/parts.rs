//! The laws and the tables, each separately.
//!
//! One program: what the tests share, the engines above all, is compiled once. `cargo test --test parts NAME::` runs one file.

mod common;

mod actuator;
mod braid;
mod control;
mod equilibrium;
mod five_way;
mod force;
mod inverse;
mod limits;
mod line_friction;
mod line_hose;
mod measured_muscles;
mod parameter;
mod pid;
mod ramp;
mod regulator;
mod ring_down;
mod scalar;
mod spool;
mod valve;
mod valve_coefficients;

/// A file in this folder that no program names would never be compiled.
#[test]
fn every_file_is_in_a_program() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests");
    let programs = ["inner", "parts", "plant", "runs"];
    let text = |name: &str| std::fs::read_to_string(format!("{folder}/{name}.rs")).expect("a program");
    let named = programs.map(text).concat();
    for entry in std::fs::read_dir(folder).expect("the tests") {
        let file = entry.expect("an entry").file_name().into_string().expect("a name");
        if let Some(name) = file.strip_suffix(".rs").filter(|name| !programs.contains(name)) {
            assert!(named.contains(&format!("mod {name};\n")), "tests/{file} is in no program");
        }
    }
}
