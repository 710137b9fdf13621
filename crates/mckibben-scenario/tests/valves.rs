//! The section `[valve]`: the ways to state its flow paths, presets and what overrides them, and every kind of valve.

use mckibben::valve::{PoppetClock, Ports};
use mckibben_scenario::{Command, CommandState, Document, FlowPath, Scenario, Valve, ValveKind};

const AROUND: &str = "[supply]\ngauge_pressure = \"6 bar\"\n[command]\nkind = \"fill\"\n\
                      [load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"1 s\"\n";

fn document(valve: &str) -> Document {
    Document::parse(&format!("{AROUND}[valve]\n{valve}"), "valve.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn scenario(valve: &str) -> Scenario {
    document(valve).scenario().unwrap_or_else(|error| panic!("{error}"))
}

fn valve(text: &str) -> Valve {
    scenario(text).valve.expect("a valve")
}

fn refused(text: &str) -> String {
    match document(text).scenario() {
        Err(found) => found.to_string(),
        Ok(scenario) => panic!("{scenario:?}"),
    }
}

#[test]
fn a_flow_path_is_stated_in_one_of_four_ways() {
    let of = |text: &str| valve(&format!("kind = \"three-way\"\n{text}")).flow_path;
    // 0.36 m³/h are 1e-4 m³/s, and 6 L/min the same.
    let FlowPath::Kv { kv, pressure_drop_ratio } = of("kv = \"0.36 m^3/h\"") else { panic!("not by Kv") };
    assert!((kv / 1e-4 - 1.0).abs() < 1e-15);
    assert_eq!(pressure_drop_ratio, 0.7);
    let FlowPath::Kv { kv, .. } = of("kv = \"6 L/min\"") else { panic!("not by Kv") };
    assert!((kv / 1e-4 - 1.0).abs() < 1e-15);
    assert_eq!(of("cv = 0.3\npressure_drop_ratio = 0.6"), FlowPath::Cv { cv: 0.3, pressure_drop_ratio: 0.6 });
    assert!(matches!(of("flow_area = \"1 mm^2\""), FlowPath::FlowArea(_)));
    assert!(matches!(of("sonic_conductance = \"1 L/(s*bar)\"\ncritical_ratio = 0.3"), FlowPath::Iso6358 { .. }));
}

#[test]
fn two_ways_half_a_way_and_strays_are_refused() {
    let of = |text: &str| refused(&format!("kind = \"three-way\"\n{text}"));
    for (text, words) in [
        ("kv = \"1 m^3/h\"\ncv = 1", "two ways"),
        ("kv = 0.3", "needs a unit"),
        ("cv = \"0.3 m^3/h\"", "pure number"),
        ("sonic_conductance = \"1 L/(s*bar)\"", "`valve.critical_ratio`"),
        ("flow_area = \"1 mm^2\"\npressure_drop_ratio = 0.7", "goes with `kv` or `cv`"),
        ("", "`kv` or `cv` would do as well"),
        ("cv = 1\nexhaust.kv = \"1 m^3/h\"\nexhaust.cv = 1", "two ways"),
        ("cv = 1\nexhaust.critical_ratio = 0.3", "`valve.exhaust.sonic_conductance`"),
        ("cv = 1\nexhaust.pressure_drop_ratio = 0.6", "goes with `kv` or `cv`"),
        ("cv = 1\nexhaust.cv = 1\nexhaust.pressure_drop_ratio = 1.5", "out of range"),
    ] {
        let found = of(text);
        assert!(found.contains(words), "{text}:\n{found}");
    }
}

#[test]
fn flow_paths_of_the_file_replace_those_of_the_preset() {
    let preset = "preset = \"ckd-m4ga2r\"\n";
    let whole = valve(preset);
    let iso = |c: f64, b: f64| FlowPath::Iso6358 { sonic_conductance: c * 1e-8, critical_ratio: b };
    let close = |a: FlowPath, b: FlowPath| match (a, b) {
        (
            FlowPath::Iso6358 { sonic_conductance: a, critical_ratio: x },
            FlowPath::Iso6358 { sonic_conductance: b, critical_ratio: y },
        ) => (a / b - 1.0).abs() < 1e-14 && x == y,
        _ => false,
    };
    assert!(close(whole.flow_path, iso(2.3, 0.36)) && close(whole.exhaust.expect("its own"), iso(2.9, 0.24)));
    assert_eq!((whole.kind, whole.opening_delay, whole.closing_delay), (ValveKind::ThreeWay, 0.019, 0.019));
    // A part of what the preset states so.
    let part = valve(&format!("{preset}exhaust.critical_ratio = 0.5"));
    assert!(close(part.flow_path, iso(2.3, 0.36)) && close(part.exhaust.expect("its own"), iso(2.9, 0.5)));
    // Another way: of the exhaust alone, or of both.
    let throttled = valve(&format!("{preset}exhaust.cv = 0.1"));
    assert_eq!(throttled.exhaust, Some(FlowPath::Cv { cv: 0.1, pressure_drop_ratio: 0.7 }));
    assert!(close(throttled.flow_path, iso(2.3, 0.36)));
    let own = valve(&format!("{preset}cv = 0.1"));
    assert_eq!((own.flow_path, own.exhaust), (FlowPath::Cv { cv: 0.1, pressure_drop_ratio: 0.7 }, None));
}

#[test]
fn assumptions_about_a_flow_path_are_reported_while_in_force() {
    let of = |text: &str| -> Vec<&str> {
        let assumed = document(text).assumed();
        assumed.iter().map(|one| one.parameter.key).filter(|key| key.starts_with("valve.")).collect()
    };
    let preset = "preset = \"smc-vt307\"\n";
    assert_eq!(
        of(preset),
        [
            "valve.pressure_drop_ratio",
            "valve.opening_delay",
            "valve.closing_delay",
            "valve.laminar_ratio",
            "valve.exhaust.critical_ratio"
        ]
    );
    assert_eq!(
        of(&format!("{preset}flow_area = \"1 mm^2\"\nopening_delay = \"5 ms\"")),
        ["valve.closing_delay", "valve.laminar_ratio"]
    );
    assert_eq!(
        of("kind = \"two-way\"\nkv = \"1 m^3/h\""),
        ["valve.pressure_drop_ratio", "valve.opening_delay", "valve.closing_delay", "valve.laminar_ratio"]
    );
    let delays = "opening_delay = \"4 ms\"\nclosing_delay = \"1 ms\"";
    assert_eq!(of(&format!("kind = \"two-way\"\nflow_area = \"1 mm^2\"\n{delays}")), ["valve.laminar_ratio"]);
}

#[test]
fn every_way_reads_back_as_it_was_written() {
    for text in [
        "kind = \"two-way\"\nkv = \"0.05 m^3/h\"",
        "kind = \"three-way-normally-open\"\ncv = 0.07\npressure_drop_ratio = 0.61",
        "preset = \"ckd-m4ga1r\"",
        "preset = \"smc-vt307\"",
        "kind = \"five-way-closed\"\nflow_area = \"1 mm^2\"\nexhaust.kv = \"2 L/min\"",
    ] {
        // A valve of two positions without exhaust cannot vent, so all are commanded to fill.
        let first = scenario(text);
        let again = Scenario::from_str(&first.to_toml(), "again.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(first, again, "{text}");
    }
}

#[test]
fn each_kind_takes_the_commands_that_it_can_follow() {
    let with = |kind: &str, command: &str| {
        let text = format!("{AROUND}[valve]\nkind = \"{kind}\"\ncv = 0.1\n").replace("kind = \"fill\"", command);
        Document::parse(&text, "valve.toml").expect("TOML").experiment()
    };
    let kinds = ValveKind::CHOICES.iter().map(|choice| choice.name);
    let requests = ["fill", "hold", "exhaust"].map(|request| format!("kind = \"{request}\""));
    // They follow set points or positions, and no requests.
    let without_seats = ["pressure-regulator", "proportional-spool"];
    assert!(without_seats.iter().all(|kind| requests.iter().all(|request| with(kind, request).is_err())));
    for kind in kinds.filter(|kind| !without_seats.contains(kind)) {
        let holds = kind == "two-way" || kind == "fill-hold-exhaust" || kind.starts_with("five-way-");
        assert!(with(kind, "kind = \"fill\"").is_ok(), "{kind}");
        assert_eq!(with(kind, "kind = \"hold\"").is_ok(), holds, "{kind}");
        assert_eq!(with(kind, "kind = \"exhaust\"").is_ok(), kind != "two-way", "{kind}");
        let table = "kind = \"table\"\ntime = [\"1 ms\", \"2 ms\"]\nstate = [\"fill\", \"hold\"]";
        assert_eq!(with(kind, table).is_ok(), holds, "{kind}");
        let rests = "kind = \"pwm\"\nfrequency = \"10 Hz\"\nduty = 0.5\nrest = \"hold\"";
        assert_eq!(with(kind, rests).is_ok(), holds && kind != "two-way", "{kind}");
    }
    let two_way = with("two-way", "kind = \"pwm\"\nfrequency = \"10 Hz\"\nduty = 0.5").expect("an experiment");
    let actuation = two_way.rig.actuation().expect("a valve");
    let mut clock = PoppetClock::released();
    clock.advance(0.06, &actuation.solenoid, &actuation.command);
    assert_eq!(clock.ports(&actuation.solenoid), Ports::CLOSED);
}

const JOINT: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"60 psi\"\n\
    [valve]\nkind = \"five-way\"\ncv = 0.05\nopening_delay = \"4 ms\"\nclosing_delay = \"1 ms\"\n\
    [command]\nkind = \"pwm\"\nfrequency = \"5 Hz\"\nduty = 0.3\n\
    [load]\nkind = \"antagonistic-joint\"\npulley_radius = \"15 mm\"\nrest_length = \"3.3 in\"\nmass = \"0.5 kg\"\n\
    distance = \"100 mm\"\ninertia = \"1e-3 kg*m^2\"\n[initial]\ngauge_pressure = \"20 psi\"\n[run]\nduration = \"1 s\"\n";

#[test]
fn a_five_way_valve_drives_both_actuators_of_a_joint() {
    let document = Document::parse(JOINT, "joint.toml").expect("TOML");
    let joint = document.joint_experiment().unwrap_or_else(|error| panic!("{error}")).expect("a joint");
    let [a, b] = [0, 1].map(|member| joint.rig.driven()[member].actuation.clone().expect("a valve"));
    let (mut of_a, mut of_b) = (PoppetClock::released(), PoppetClock::released());
    for step in 1..400 {
        let time = 2.5e-3 * f64::from(step) + 1e-5;
        of_a.advance(time, &a.solenoid, &a.command);
        of_b.advance(time, &b.solenoid, &b.command);
        let (a, b) = (of_a.ports(&a.solenoid), of_b.ports(&b.solenoid));
        assert_eq!((a.supply, a.exhaust), (b.exhaust, b.supply), "at {time}");
    }
    // Its flow path may be throttled on one side; a separate command is a contradiction.
    let with =
        |extra: &str| Document::parse(&format!("{JOINT}{extra}"), "joint.toml").expect("TOML").joint_experiment();
    assert!(with("[antagonist.valve]\nkv = \"0.02 m^3/h\"\n").is_ok());
    let error = with("[antagonist.command]\nkind = \"fill\"\n").expect_err("two commands").to_string();
    assert!(error.contains("one five-way valve"), "{error}");
    let other = "[antagonist.valve]\nkind = \"three-way\"\ncv = 0.05\n[antagonist.command]\nkind = \"fill\"\n";
    assert!(with(other).is_ok());
    let second = Document::parse(JOINT, "joint.toml").expect("TOML").scenario().expect("a scenario").of_antagonist();
    assert_eq!(
        second.expect("a joint").command,
        Some(Command::Pwm { frequency: 5.0, duty: 0.3, pulse: CommandState::Fill, rest: CommandState::Exhaust })
    );
}
