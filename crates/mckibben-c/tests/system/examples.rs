//! The examples compile without a warning, run, and have the numbers of the host interface in Rust.

use super::common::{arm, compile, here, library, run, scratch, shared};
use mckibben_run::host::{HostOptions, HostPlant, Motion};
use mckibben_scenario::Document;
use std::path::PathBuf;
use std::process::Command;

const SOURCES: [&str; 3] = ["hanging_mass.c", "arm.cpp", "ros2_node.cpp"];

/// Flags of programs that are checked while they run.
const SANITIZED: [&str; 2] = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// Compiles an example; more flags than those of the shared library come first.
fn built(source: &str, folder: &str, flags: &[&str]) -> PathBuf {
    let program = scratch(&format!("{folder}-{}", source.replace('.', "-"))).join("program");
    let shared = shared();
    let flags: Vec<&str> = flags.iter().copied().chain(shared.iter().map(String::as_str)).collect();
    compile(source, &program, &flags);
    program
}

/// The number after a word of a line.
fn after(text: &str, word: &str) -> f64 {
    let rest = text.split(word).nth(1).unwrap_or_else(|| panic!("no {word} in {text}"));
    rest.split_whitespace().next().and_then(|number| number.parse().ok()).expect("a number")
}

/// The scenario within the C example.
fn scenario_of_example() -> String {
    let source = std::fs::read_to_string(here().join("examples/hanging_mass.c")).expect("the example");
    let (_, rest) = source.split_once("scenario[] =").expect("a scenario");
    let (literal, _) = rest.split_once(';').expect("its end");
    literal.split('"').skip(1).step_by(2).collect::<String>().replace("\\n", "\n")
}

#[test]
fn the_mass_in_c_moves_as_in_rust() {
    let printed = run(&mut Command::new(built("hanging_mass.c", "shared", &[])));
    let document = Document::parse(&scenario_of_example(), "hanging_mass.c").expect("TOML");
    let mut host = HostPlant::read(&document, &HostOptions::default()).expect("a plant");
    let (mut length, mut velocity, step) = (0.09, 0.0, 1e-4);
    let mut response = [host.steps_mut().compute(0).expect("a response")];
    for k in 1..=20_000_u32 {
        host.command(0, if k <= 10_000 { 0.5 } else { 1.0 }).expect("a duty cycle");
        host.compute_at(&[length], &[velocity], &mut response).expect("a response");
        velocity += (9.80665 - response[0].tension / 2.267_961_85) * step;
        length += velocity * step;
        host.advance(f64::from(k) * step, &[length]).expect("a step");
    }
    let tension = host.steps_mut().compute(0).expect("a response").tension;
    assert_eq!((after(&printed, "length "), after(&printed, "tension ")), (length, tension), "{printed}");
    assert!((0.06..0.09).contains(&length), "it has been lifted: {length} m");
    // Linked into the program, the library is the same.
    let program = scratch("static").join("program");
    let archive = library().join("libmckibben_c.a").display().to_string();
    compile("hanging_mass.c", &program, &[&archive, "-lpthread", "-ldl", "-lm"]);
    assert_eq!(run(&mut Command::new(program)), printed);
}

#[test]
fn the_arm_in_cpp_moves_as_in_rust() {
    let printed = run(Command::new(built("arm.cpp", "shared", &[])).arg(arm()));
    let document = Document::load(arm()).expect("the example");
    let options = HostOptions { motion: Motion::Scenario, command_mode: Some("request"), ..HostOptions::default() };
    let elbow = |biceps: f64| {
        let mut host = HostPlant::read(&document, &options).expect("a plant");
        let index = |name: &str| host.commands().iter().position(|its| its.name == format!("{name}.request"));
        let (deltoid, other) = (index("deltoid").expect("a command"), index("biceps").expect("a command"));
        host.command(deltoid, 1.0).expect("a request");
        host.advance(0.1, &[]).expect("a step");
        host.command(other, biceps).expect("a request");
        host.advance(0.3, &[]).expect("a step");
        let mut outputs = vec![0.0; host.outputs().len()];
        host.read_outputs(&mut outputs).expect("as many");
        outputs[host.outputs().iter().position(|column| column.name == "elbow.angle").expect("an angle")]
    };
    let due = (elbow(1.0), elbow(0.0));
    assert_eq!((after(&printed, "elbow "), after(&printed, "bent, ")), due, "{printed}");
    assert!(due.0 > due.1 && printed.trim_end().ends_with("again equal"), "{printed}");
}

#[test]
fn the_node_keeps_its_rate() {
    let begun = std::time::Instant::now();
    let printed = run(Command::new(built("ros2_node.cpp", "shared", &[])).arg(arm()));
    assert!(begun.elapsed().as_secs_f64() >= 0.495, "a hundred periods of 5 ms");
    assert!(printed.lines().count() == 3 && printed.contains("at 0.500 s"), "{printed}");
    assert!(after(&printed, "shoulder ") > 0.01, "{printed}");
}

/// Three-way valves cannot hold: the node commands them numbers that they accept.
#[test]
fn the_node_commands_what_valves_of_two_positions_accept() {
    let text = std::fs::read_to_string(arm()).expect("the example");
    let text = text.replace("\"fill-hold-exhaust\"", "\"three-way\"").replace("\"hold\"", "\"exhaust\"");
    let scenario = scratch("three-way").join("arm.toml");
    std::fs::write(&scenario, text).expect("a file");
    let done = Command::new(built("ros2_node.cpp", "three-way", &[])).arg(scenario).output().expect("the node");
    assert!(done.status.success() && done.stderr.is_empty(), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn the_examples_run_under_valgrind() {
    for source in SOURCES {
        let program = built(source, "valgrind", &[]);
        let mut valgrind = Command::new("valgrind");
        valgrind.args(["--quiet", "--error-exitcode=1", "--leak-check=full", "--show-leak-kinds=all"]);
        // As in `interface/boundary.rs`: optimised code reads an enumeration's contents before its tag.
        valgrind.args(["--errors-for-leak-kinds=all", "--undef-value-errors=no"]);
        run(valgrind.arg(program).arg(arm()));
    }
}

#[test]
fn the_examples_run_with_sanitizers() {
    for source in SOURCES {
        let program = built(source, "sanitized", &SANITIZED);
        run(Command::new(program).arg(arm()).env("ASAN_OPTIONS", "detect_leaks=1"));
    }
}
