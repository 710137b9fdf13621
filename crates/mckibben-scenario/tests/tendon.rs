//! A tendon in series in a scenario: what is read, written and built, and mistakes.

use mckibben_scenario::{Document, Engine, Scenario, SeriesTendon};

const TENDON: &str = "[tendon]\nstiffness = \"12 N/mm\"\n";
const LOAD: &str = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n";
const RUN: &str = "[run]\nduration = \"1 s\"\nengine = \"fixed-step\"\nstep = \"0.1 ms\"\n";

fn document(parts: &[&str]) -> Document {
    Document::parse(&parts.concat(), "test.toml").expect("it is TOML")
}

fn mistakes(parts: &[&str]) -> String {
    document(parts).experiment().expect_err("a mistake").to_string()
}

#[test]
fn it_is_read_built_and_written() {
    let read = |text: &str| -> Scenario { document(&[text]).scenario().unwrap_or_else(|error| panic!("{error}")) };
    let long = TENDON.to_owned() + "rest_length = \"60 mm\"\n";
    for (tendon, rest_length) in [(TENDON, 0.0), (long.as_str(), 0.06)] {
        let scenario = read(&[tendon, LOAD, RUN].concat());
        assert_eq!(scenario.tendon, Some(SeriesTendon { stiffness: 12e3, rest_length }));
        let rig = scenario.rig().expect("a rig");
        let of_rig = rig.tendon().map(|tendon| [tendon.stiffness(), tendon.rest_length()]);
        assert_eq!(of_rig, Some([12e3, rest_length]));
        assert_eq!(read(&scenario.to_toml()), scenario);
    }
    assert_eq!(read(&[LOAD, RUN].concat()).tendon, None);
}

#[test]
fn mistakes_are_reported() {
    let cases = [
        (mistakes(&["[tendon]\n", LOAD, RUN]), "tendon.stiffness"),
        (mistakes(&[&TENDON.replace("12", "0"), LOAD, RUN]), "tendon.stiffness"),
        (mistakes(&[TENDON, "rest_length = \"-1 mm\"\n", LOAD, RUN]), "tendon.rest_length"),
    ];
    for (said, word) in cases {
        assert!(said.contains(word), "{word}:\n{said}");
    }
}

/// A prescribed motion is that of actuator and tendon together: longer than the braid's thread, every event located.
#[test]
fn a_prescribed_motion_is_that_of_both() {
    let moved =
        "[load]\nkind = \"prescribed-motion\"\nlength = \"15 cm\"\namplitude = \"1 mm\"\nfrequency = \"1 Hz\"\n";
    let run = "[run]\nduration = \"0.1 s\"\n";
    let of = document(&[TENDON, "rest_length = \"60 mm\"\n", moved, run]).experiment();
    let of = of.unwrap_or_else(|error| panic!("{error}"));
    let run = mckibben::plant::simulate(&of.rig, of.start, 0.1, 1e-8).expect("a run");
    let sample = run.at(0.05);
    let distance = 0.15 + 1e-3 * (std::f64::consts::TAU * 0.05).sin();
    assert!((sample.load_distance - distance).abs() < 1e-9);
    assert!((sample.tension - (12e3 * (distance - 0.06 - sample.length)).max(0.0)).abs() < 1e-6);
}

/// Without an engine its events are located; the fixed-step engine chooses its step.
#[test]
fn both_engines_take_it() {
    let of = |run: &str| document(&[TENDON, LOAD, run]).experiment().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(of("[run]\nduration = \"1 s\"\n").run.engine, Engine::EventLocated);
    let without = "[run]\nduration = \"0.2 s\"\nengine = \"fixed-step\"\nsample_interval = \"1 ms\"\naccuracy = 1e-2\n";
    let moving = LOAD.to_owned() + "[initial]\ngauge_pressure = \"40 psi\"\nvelocity = \"0.1 m/s\"\n";
    let (step, error) =
        document(&[TENDON, &moving, without]).experiment().expect("an experiment").step().expect("a step");
    let error = error.expect("measured");
    assert!(step <= 1e-3 && error.greatest <= 1e-2, "{step} s: {error:?}");
}
