//! A pressure regulator in a scenario: what is read, what is written, what is built, and mistakes.

use mckibben_scenario::{Command, Document, FlowPath, ProportionalRegulator, Scenario, ValveKind};

const LOAD: &str = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"1 s\"\n";
const SUPPLY: &str = "[supply]\ngauge_pressure = \"6 bar\"\n";
const VALVE: &str = "[valve]\nkind = \"pressure-regulator\"\nflow_area = \"1 mm^2\"\ntime_constant = \"30 ms\"\n\
                     dead_time = \"5 ms\"\nrate_limit = \"20 bar/s\"\n";
const COMMAND: &str =
    "[command]\nkind = \"set-points\"\ntime = [\"0 s\", \"0.5 s\"]\ngauge_pressure = [\"4 bar\", \"1 bar\"]\n";

fn document(parts: &[&str]) -> Document {
    Document::parse(&[parts.concat().as_str(), LOAD].concat(), "test.toml").expect("it is TOML")
}

fn scenario(parts: &[&str]) -> Scenario {
    document(parts).scenario().unwrap_or_else(|error| panic!("{error}"))
}

/// What is said of a mistake.
fn mistakes(parts: &[&str]) -> String {
    document(parts).experiment().expect_err("a mistake").to_string()
}

#[test]
fn a_regulator_is_read_built_and_written() {
    let read = scenario(&[SUPPLY, VALVE, COMMAND]);
    let valve = read.valve.expect("a valve");
    assert_eq!(valve.kind, ValveKind::PressureRegulator);
    assert_eq!(valve.flow_path, FlowPath::FlowArea(1e-6));
    let expected = ProportionalRegulator { time_constant: 0.03, rate_limit: 2e6 };
    assert_eq!((valve.regulator, valve.dead_time), (Some(expected), 5e-3));
    let points = Command::SetPoints { time: vec![0.0, 0.5], gauge_pressure: vec![4e5, 1e5] };
    assert_eq!(read.command, Some(points));
    let rig = read.rig().expect("a rig");
    assert_eq!(rig.regulator().map(|regulator| regulator.dead_time()), Some(5e-3));

    let text = read.to_toml();
    assert!(text.contains("set-points") && !text.contains("opening_delay"), "{text}");
    let again = Document::parse(&text, "again.toml").expect("it is TOML").scenario();
    assert_eq!(again.unwrap_or_else(|error| panic!("{error}\n{text}")), read);
}

#[test]
fn the_dead_time_is_zero_when_absent_and_assumed() {
    let short = VALVE.replace("dead_time = \"5 ms\"\n", "");
    let read = scenario(&[SUPPLY, &short, COMMAND]);
    assert_eq!(read.valve.map(|valve| valve.dead_time), Some(0.0));
    let assumed = document(&[SUPPLY, VALVE, COMMAND]).assumed();
    assert!(!assumed.iter().any(|value| value.parameter.key.ends_with("ing_delay")));
}

#[test]
fn mistakes_are_reported() {
    let with = |valve: &str| VALVE.to_owned() + valve;
    let cases = [
        (mistakes(&[SUPPLY, VALVE, &COMMAND.replace("4 bar", "7 bar")]), "cannot give more than feeds it"),
        (mistakes(&[SUPPLY, VALVE, &COMMAND.replace("4 bar", "7 bar")]), "or raise `supply.gauge_pressure`"),
        (mistakes(&[SUPPLY, VALVE, "[command]\nkind = \"fill\"\n"]), "takes set points of pressure"),
        (mistakes(&[SUPPLY, "[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n", COMMAND]), "pressure-regulator"),
        (mistakes(&[SUPPLY, VALVE, &COMMAND.replace(", \"1 bar\"", "")]), "equally long"),
        (mistakes(&[SUPPLY, VALVE, &COMMAND.replace("0.5 s", "0 s")]), "must increase"),
        (mistakes(&[SUPPLY, VALVE, "[command]\nkind = \"set-points\"\ntime = [\"0 s\"]\n"]), "command.gauge_pressure"),
        (mistakes(&[SUPPLY, &VALVE.replace("time_constant = \"30 ms\"\n", ""), COMMAND]), "valve.time_constant"),
        (
            mistakes(&[
                SUPPLY,
                "[valve]\npreset = \"matrix-821\"\nrate_limit = \"1 bar/s\"\n",
                "[command]\nkind = \"fill\"\n",
            ]),
            "is for a pressure regulator",
        ),
        (mistakes(&[SUPPLY, &with("opening_delay = \"1 ms\"\n"), COMMAND]), "no seats"),
        (mistakes(&[SUPPLY, &with("[valve.exhaust]\nflow_area = \"1 mm^2\"\n"), COMMAND]), "one flow path"),
        (mistakes(&[SUPPLY, "reservoir_volume = \"1 L\"\n", VALVE, COMMAND]), "behind a reservoir or a regulator"),
    ];
    for (said, word) in cases {
        assert!(said.contains(word), "{word}:\n{said}");
    }
}

#[test]
fn fixed_steps_and_sweeps_take_it() {
    let stepped = LOAD.to_owned() + "engine = \"fixed-step\"\nstep = \"1 ms\"\n";
    let vary =
        "[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n\"valve.rate_limit\" = [\"1 bar/s\", \"2 bar/s\"]\n";
    let text = [SUPPLY, VALVE, COMMAND, &stepped, vary].concat();
    let document = Document::parse(&text, "test.toml").expect("it is TOML");
    let rig = document.experiment().unwrap_or_else(|error| panic!("{error}")).rig;
    assert!(rig.regulator().is_some());
}
