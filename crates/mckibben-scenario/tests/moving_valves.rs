//! Poppets that take their time and proportional spools in a scenario: what is read, written and built, and mistakes.

use mckibben_scenario::{Command, Document, Scenario, Spool, ValveKind};

const AROUND: &str = "[supply]\ngauge_pressure = \"6 bar\"\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
                      [run]\nduration = \"1 s\"\n";
const FILL: &str = "[command]\nkind = \"fill\"\n";
const SEATS: &str =
    "[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\nopening_time = \"3 ms\"\nclosing_time = \"5 ms\"\n";
const SPOOL: &str = "[valve]\nkind = \"proportional-spool\"\nflow_area = \"1 mm^2\"\nspool.natural_frequency = \"80 Hz\"\n\
                     spool.damping_ratio = 0.6\nspool.supply_overlap = 0.05\n";
const POSITIONS: &str = "[command]\nkind = \"positions\"\ntime = [\"0 s\", \"0.5 s\"]\nposition = [0.4, -1]\n";

fn document(parts: &[&str]) -> Document {
    Document::parse(&[AROUND, parts.concat().as_str()].concat(), "test.toml").expect("it is TOML")
}

fn scenario(parts: &[&str]) -> Scenario {
    document(parts).scenario().unwrap_or_else(|error| panic!("{error}"))
}

/// What is said of a mistake.
fn mistakes(parts: &[&str]) -> String {
    document(parts).experiment().expect_err("a mistake").to_string()
}

fn read_again(scenario: &Scenario) -> Scenario {
    let text = scenario.to_toml();
    let again = Document::parse(&text, "again.toml").expect("it is TOML").scenario();
    again.unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn seats_that_take_their_time_are_read_built_and_written() {
    let read = scenario(&[SEATS, FILL]);
    let valve = read.valve.expect("a valve");
    assert_eq!([valve.opening_time, valve.closing_time], [3e-3, 5e-3]);
    assert_eq!(read.rig().expect("a rig").actuation().expect("driven").solenoid.ramp().times(), [3e-3, 5e-3]);
    assert_eq!(read_again(&read), read);
    // Both outputs of a five-way valve are such.
    let five = scenario(&[&SEATS.replace("three-way", "five-way"), FILL]);
    assert_eq!(five.rig().expect("a rig").actuation().expect("driven").solenoid.ramp().times(), [3e-3, 5e-3]);
    // Left out they jump, without a message.
    let plain = document(&["[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n", FILL]);
    assert_eq!(plain.scenario().expect("a scenario").valve.map(|valve| valve.opening_time), Some(0.0));
    assert!(!plain.assumed().iter().any(|value| value.parameter.key.ends_with("ing_time")));
}

#[test]
fn a_spool_is_read_built_and_written() {
    let read = scenario(&[SPOOL, POSITIONS]);
    let valve = read.valve.expect("a valve");
    assert_eq!(valve.kind, ValveKind::ProportionalSpool);
    let expected = Spool { natural_frequency: 80.0, damping_ratio: 0.6, supply_overlap: 0.05, exhaust_overlap: 0.0 };
    assert_eq!(valve.spool, Some(expected));
    assert_eq!(read.command, Some(Command::Positions { time: vec![0.0, 0.5], position: vec![0.4, -1.0] }));
    assert!(read.rig().expect("a rig").actuation().expect("driven").solenoid.spool().is_some());
    assert!(!read.to_toml().contains("opening_delay"));
    assert_eq!(read_again(&read), read);
    // A separate flow path to the atmosphere, and fixed steps.
    let own = SPOOL.replace("spool.damping", "exhaust.flow_area = \"2 mm^2\"\nspool.damping");
    let around = AROUND.replace("[run]\n", "[run]\nengine = \"fixed-step\"\nstep = \"1 ms\"\n");
    let text = [around.as_str(), &own, POSITIONS].concat();
    let document = Document::parse(&text, "test.toml").expect("it is TOML");
    assert!(document.experiment().is_ok());
}

#[test]
fn mistakes_are_reported() {
    let cases = [
        (mistakes(&[&SEATS.replace("3 ms", "-3 ms"), FILL]), "out of range"),
        (mistakes(&[&SEATS.replace("\"3 ms\"", "3"), FILL]), "needs a unit"),
        (mistakes(&[SPOOL, FILL]), "takes positions"),
        (mistakes(&["[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n", POSITIONS]), "proportional-spool"),
        (mistakes(&[SPOOL, &POSITIONS.replace("0.4", "1.4")]), "out of range"),
        (mistakes(&[SPOOL, &POSITIONS.replace(", -1", "")]), "equally long"),
        (mistakes(&[SPOOL, "[command]\nkind = \"positions\"\ntime = [\"0 s\"]\n"]), "command.position"),
        (mistakes(&[&SPOOL.replace("spool.damping_ratio = 0.6\n", ""), POSITIONS]), "damping_ratio"),
        (mistakes(&[&SPOOL.replace("0.05", "1"), POSITIONS]), "out of range"),
        (mistakes(&[&SPOOL.replace("flow_area", "opening_time = \"1 ms\"\nflow_area"), POSITIONS]), "no seats"),
        (
            mistakes(&[&SEATS.replace("closing_time", "spool.damping_ratio = 0.6\nclosing_time"), FILL]),
            "is not used when `valve.kind`",
        ),
    ];
    for (said, word) in cases {
        assert!(said.contains(word), "{word}:\n{said}");
    }
}

#[test]
fn a_joint_takes_them_by_both_engines() {
    let joint = "kind = \"antagonistic-joint\"\npulley_radius = \"15 mm\"\nrest_length = \"3.3 in\"\nmass = \"0.5 kg\"\n\
                 distance = \"100 mm\"";
    let around = AROUND.replace("kind = \"hanging-mass\"\nmass = \"5 lb\"", joint);
    let stepped = around.replace("[run]\n", "[run]\nengine = \"fixed-step\"\nstep = \"1 ms\"\n");
    let regulator = "[valve]\nkind = \"pressure-regulator\"\nflow_area = \"1 mm^2\"\ntime_constant = \"30 ms\"\n\
                     rate_limit = \"20 bar/s\"\n";
    let points = "[command]\nkind = \"set-points\"\ntime = [\"0 s\"]\ngauge_pressure = [\"4 bar\"]\n";
    for (valve, command) in [(SEATS, FILL), (SPOOL, POSITIONS), (regulator, points)] {
        let built = |around: &str| {
            let document = Document::parse(&[around, valve, command].concat(), "joint.toml").expect("it is TOML");
            document.joint_experiment()
        };
        for around in [&stepped, &around] {
            assert!(built(around).unwrap_or_else(|error| panic!("{error}")).is_some());
        }
    }
}
