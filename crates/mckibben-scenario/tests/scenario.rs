//! What files mean: the specification's example, presets and defaults, every kind of valve, command, load and process,
//! and that what is written reads back to the same.

use mckibben_scenario::{
    Command, CommandState, Document, Effectiveness, Engine, FlowPath, InitialLength, Load, Method, MomentArm, Motion,
    PressurePlace, PressureSensor, PressureSeries, Process, Scenario, Starter, ValveKind,
};
use proptest::prelude::*;

/// The example of the specification of the file format, with all of its keys.
const EXAMPLE: &str = r#"
[actuator]
preset = "colbrunn-2001"
thread_length = "4.3218 in"
turns = 2.5
max_length = "3.85 in"
min_length = "2.4952 in"
external_volume = "3 cm^3"

[actuator.effectiveness]
constant = 0.9
[actuator.friction]
viscous = "0.02 lbf*s/in"
coulomb_width = "0.0044 in"

[actuator.limit]
stiffness = "1.75e5 N/m"
damping = "100 N*s/m"

[air]
process = "isentropic"
atmospheric_pressure = "101325 Pa"
gas_constant = "286.99 J/(kg*K)"
heat_capacity_ratio = 1.4

[supply]
gauge_pressure = "100 psi"
temperature = "293.15 K"

[valve]
kind = "three-way"
flow_area = "1.8e-5 ft^2"
efficiency = 0.85
opening_delay = "4 ms"
closing_delay = "1 ms"
laminar_ratio = 0.999
exhaust_temperature = "actuator"

[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5

[load]
kind = "hanging-mass"
mass = "5 lb"
gravity = "9.80665 m/s^2"

[initial]
gauge_pressure = "0 psi"
temperature = "293.15 K"
length = "equilibrium"
velocity = "0 m/s"

[run]
duration = "2 s"
sample_interval = "1 ms"
relative_tolerance = 1e-8
"#;

/// The least that a file must say.
const LEAST: &str = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"2 s\"\n";

fn read(text: &str) -> Scenario {
    Scenario::from_str(text, "test.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn round_trip(scenario: &Scenario) {
    let text = scenario.to_toml();
    assert_eq!(&read(&text), scenario, "{text}");
}

#[test]
fn the_specification_s_example() {
    let scenario = read(EXAMPLE);
    assert_eq!(scenario.actuator.max_length, 0.09779);
    assert_eq!(scenario.actuator.effectiveness, Effectiveness::Constant(0.9));
    assert_eq!(scenario.air.process, Process::Isentropic);
    let valve = scenario.valve.expect("a valve");
    assert_eq!((valve.kind, valve.flow_path), (ValveKind::ThreeWay, FlowPath::FlowArea(1.672_254_72e-6)));
    assert_eq!(scenario.initial.length, InitialLength::Equilibrium);
    let (pulse, rest) = (CommandState::Fill, CommandState::Exhaust);
    assert_eq!(scenario.command, Some(Command::Pwm { frequency: 25.0, duty: 0.5, pulse, rest }));
    assert_eq!((scenario.run.engine, scenario.run.method), (Engine::EventLocated, Method::Stable));
    round_trip(&scenario);
}

/// The starter is the same experiment, with the effectiveness left to the preset.
#[test]
fn the_starter_is_the_experiment_of_the_specification() {
    let mut expected = read(EXAMPLE);
    expected.actuator.effectiveness = Effectiveness::Constant(1.0);
    assert_eq!(read(&Starter::default().text()), expected);
    let minimal = Starter { minimal: true, ..Starter::default() }.text();
    assert_eq!(read(&minimal), expected);
    assert!(minimal.lines().count() < 60, "{minimal}");
    // Two digits are within 5 %, and no unit of the paper is left.
    let metric = Starter { minimal: true, metric: true }.text();
    let numbers: Vec<&str> = metric.lines().filter_map(|line| line.split('#').next()).collect();
    let numbers = numbers.join("\n");
    assert!(![" psi", " in\"", " lb", " ft"].iter().any(|unit| numbers.contains(unit)), "{numbers}");
    let (read, expected) = (read(&metric), expected);
    let gauge = |of: &Scenario| of.supply.as_ref().map_or(f64::NAN, |supply| supply.gauge_pressure);
    assert!((gauge(&read) / gauge(&expected) - 1.0).abs() < 0.05);
    let (Load::HangingMass { mass, .. }, Load::HangingMass { mass: own, .. }) = (read.load, expected.load) else {
        panic!("other loads");
    };
    assert!((mass / own - 1.0).abs() < 0.05, "{mass}");
}

#[test]
fn defaults_and_presets() {
    let least = read(LEAST);
    let preset = read(&format!("[actuator]\npreset = \"colbrunn-2001\"\n{LEAST}"));
    assert_eq!(least, preset);
    assert_eq!(least.actuator.min_length, 2.4952 * 0.0254);
    assert_eq!(least.actuator.friction.coulomb_width, 0.0044 * 0.0254);
    assert_eq!((least.valve, least.supply, least.command.clone()), (None, None, None));
    round_trip(&least);

    // Friction alone does not say how long the braid is, so the default preset stays.
    let friction = read(&format!("[actuator.friction]\nviscous = \"0 N*s/m\"\n{LEAST}"));
    assert_eq!((friction.actuator.turns, friction.actuator.friction.viscous), (2.5, 0.0));

    // Without a preset the parameter table's defaults hold, and L_min is b/√3.
    let own = "[actuator]\nthread_length = \"30 cm\"\nturns = 2\nmax_length = \"28 cm\"\n";
    let own = read(&format!("{own}{LEAST}")).actuator;
    assert_eq!((own.friction.viscous, own.external_volume, own.min_length), (0.0, 3e-6, 0.3 / 3_f64.sqrt()));

    // A preset's L_min goes with its thread.
    let longer = read(&format!("[actuator]\npreset = \"colbrunn-2001\"\nthread_length = \"5 in\"\n{LEAST}")).actuator;
    assert_eq!(longer.min_length, 0.127 / 3_f64.sqrt());
    let turned = read(&format!("[actuator]\npreset = \"colbrunn-2001\"\nturns = 2\n{LEAST}")).actuator;
    assert_eq!((turned.turns, turned.min_length), (2.0, 2.4952 * 0.0254));
}

#[test]
fn named_valve() {
    let drive = "[supply]\ngauge_pressure = \"100 psi\"\n[command]\nkind = \"fill\"\n";
    let text = format!("{drive}[valve]\npreset = \"matrix-eight-channel\"\n{LEAST}");
    let valve = read(&text).valve.expect("a valve");
    assert_eq!((valve.kind, valve.efficiency, valve.opening_delay), (ValveKind::ThreeWay, 0.85, 0.004));
    // Another way to state the flow path takes the place of the preset's.
    let iso = text.replace("[load]", "sonic_conductance = \"0.5 L/(s*bar) ANR\"\ncritical_ratio = 0.3\n[load]");
    let flow_path = read(&iso).valve.map(|valve| valve.flow_path);
    assert_eq!(flow_path, Some(FlowPath::Iso6358 { sonic_conductance: 5e-9, critical_ratio: 0.3 }));
    round_trip(&read(&iso));
}

#[test]
fn effectiveness() {
    let with = |lines: &str| read(&format!("[actuator.effectiveness]\n{lines}\n{LEAST}"));
    let psi = 6_894.757_293_168_362;
    let polynomial = with("polynomial = [0.7, 0.003, 1]\npressure_unit = \"psi\"");
    assert_eq!(polynomial.actuator.effectiveness, Effectiveness::Polynomial(vec![0.7, 0.003 / psi, 1.0 / (psi * psi)]));
    round_trip(&polynomial);
    let table = with("gauge_pressure = [\"20 psi\", \"60 psi\"]\nvalue = [0.8, 0.9]");
    let expected = Effectiveness::Table {
        gauge_pressure: vec![137_895.145_863_367_22, 413_685.437_590_101_7],
        value: vec![0.8, 0.9],
    };
    assert_eq!(table.actuator.effectiveness, expected);
    round_trip(&table);
}

#[test]
fn processes() {
    let with = |lines: &str| {
        let scenario = read(&format!("[air]\n{lines}\n{LEAST}"));
        round_trip(&scenario);
        scenario.air.process
    };
    assert_eq!(with("process = \"isothermal\""), Process::Isothermal);
    assert_eq!(with("process = \"polytropic\"\npolytropic_index = 1.2"), Process::Polytropic { index: 1.2 });
    let balance = "process = \"energy-balance\"\nwall_temperature = \"20 degC\"";
    assert_eq!(with(balance), Process::EnergyBalance { heat_transfer: 0.0, wall_temperature: 293.15 });
}

#[test]
fn commands() {
    let with = |kind: &str, lines: &str| {
        let valve =
            format!("[supply]\ngauge_pressure = \"1 bar\"\n[valve]\nkind = \"{kind}\"\nflow_area = \"1 mm^2\"\n");
        let scenario = read(&format!("{valve}[command]\n{lines}\n{LEAST}"));
        round_trip(&scenario);
        scenario.command.expect("a command")
    };
    use CommandState::{Exhaust, Fill, Hold};
    assert_eq!(with("three-way", "kind = \"exhaust\""), Command::Constant(Exhaust));
    assert_eq!(with("fill-hold-exhaust", "kind = \"hold\""), Command::Constant(Hold));
    let pwm = "kind = \"pwm\"\nfrequency = \"50 Hz\"\nduty = \"35 %\"\nrest = \"hold\"";
    let expected = Command::Pwm { frequency: 50.0, duty: 0.35, pulse: Fill, rest: Hold };
    assert_eq!(with("fill-hold-exhaust", pwm), expected);
    let table = "kind = \"table\"\ntime = [\"0 s\", \"100 ms\"]\nstate = [\"fill\", \"hold\"]";
    assert_eq!(with("fill-hold-exhaust", table), Command::Table { time: vec![0.0, 0.1], state: vec![Fill, Hold] });
}

#[test]
fn loads() {
    let with = |lines: &str| {
        let scenario = read(&format!("{lines}\n[run]\nduration = \"1 s\"\n"));
        round_trip(&scenario);
        scenario
    };
    let force = with("[load]\nkind = \"constant-force\"\nforce = \"5 lbf\"\nmass = \"1 kg\"").load;
    assert_eq!(force, Load::ConstantForce { force: 22.241_108_076_302_5, mass: 1.0 });
    let isometric = with("[load]\nkind = \"isometric\"\n[initial]\nlength = \"9 cm\"");
    assert_eq!((isometric.load, isometric.initial.length), (Load::Isometric, InitialLength::At(0.09)));
    let wave = "[load]\nkind = \"prescribed-motion\"\nlength = \"9 cm\"\namplitude = \"2 mm\"\nfrequency = \"2 Hz\"";
    let expected = Motion::Sinusoid { length: 0.09, amplitude: 0.002, frequency: 2.0, phase: 0.0 };
    assert_eq!(with(wave).load, Load::PrescribedMotion(expected));
    assert_eq!(with(wave).initial.length, InitialLength::OfMotion);
    with(&format!("{wave}\nphase = \"90 deg\""));
    let table = "[load]\nkind = \"prescribed-motion\"\ntime = [\"0 s\", \"1 s\"]\ntable_length = [\"9 cm\", \"8 cm\"]";
    let expected = Motion::Table { time: vec![0.0, 1.0], length: vec![0.09, 0.08] };
    assert_eq!(with(table).load, Load::PrescribedMotion(expected));
}

#[test]
fn values_set_and_removed_by_path() {
    let mut document = Document::parse(EXAMPLE, "test.toml").unwrap_or_else(|error| panic!("{error}"));
    document.set("valve.efficiency", &toml::Value::Float(0.5)).unwrap_or_else(|error| panic!("{error}"));
    document.set("load.mass", &"1 kg".into()).unwrap_or_else(|error| panic!("{error}"));
    document.set("run.engine", &"fixed-step".into()).unwrap_or_else(|error| panic!("{error}"));
    document.set_text("air.process", "\"isothermal\"").unwrap_or_else(|error| panic!("{error}"));
    assert!(document.remove("actuator.effectiveness"));
    assert!(!document.remove("actuator.effectiveness.constant"));
    let scenario = document.scenario().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scenario.valve.map(|valve| valve.efficiency), Some(0.5));
    assert_eq!(scenario.run.engine, Engine::FixedStep);
    assert_eq!(scenario.air.process, Process::Isothermal);
    assert_eq!(scenario.actuator.effectiveness, Effectiveness::Constant(1.0));
    assert!(matches!(scenario.load, Load::HangingMass { mass: 1.0, .. }));
    for path in ["", "valve.", "a b", "valve.kind = 1\nx", "load.mass.kg"] {
        assert!(document.set_text(path, "1").is_err(), "{path}");
    }
    assert!(document.set_text("load.mass", "1 kg").is_err());
}

/// One entry of a list is set by its place; the others stay, and what is no entry is refused with what there is.
#[test]
fn an_entry_of_a_list_is_set_by_its_place() {
    let text = "[command]\nkind = \"table\"\ntime = [\"0 s\", \"0.5 s\", \"1 s\"]\n\
                state = [\"fill\", \"hold\", \"exhaust\"]\n";
    let mut document = Document::parse(text, "muscle.toml").expect("TOML");
    document.set_plain_from("--set", "command.time[1]", "0.7 s").expect("an entry");
    document.set_plain_from("--set", "command.state[2]", "fill").expect("an entry");
    let said = document.to_toml();
    assert!(said.contains(r#"time = ["0 s", "0.7 s", "1 s"]"#), "{said}");
    assert!(said.contains(r#"state = ["fill", "hold", "fill"]"#), "{said}");
    for (path, words) in [
        ("command.time[3]", "has 3 entries, and none `[3]`"),
        ("command.time[one]", "none `[one]`"),
        ("command.kind[0]", "no list `command.kind`"),
        ("load.mass[0]", "no list `load.mass`"),
    ] {
        let error = document.set_plain_from("--set", path, "1 s").expect_err("no entry").to_string();
        assert!(error.contains(words), "{error}");
    }
    assert_eq!(document.to_toml(), said, "what is refused changes nothing");
}

/// A step that is given holds whatever the accuracy, and the file says both again; one that is not follows from it.
#[test]
fn the_step_is_given_or_follows_from_the_accuracy() {
    let with = |run: &str| read(&format!("{EXAMPLE}\n{run}"));
    let default = with("");
    assert_eq!((default.run.step, default.run.accuracy), (None, 1e-3));
    let given = with("step = \"3 ms\"\naccuracy = 1e-9");
    assert_eq!((given.run.step, given.run.accuracy), (Some(3e-3), 1e-9));
    round_trip(&given);
    let step = |scenario: &Scenario| scenario.experiment().and_then(|experiment| experiment.step()).expect("a step");
    assert_eq!(step(&given), (3e-3, None));
    let [coarse, fine] = ["accuracy = 1e-2", "accuracy = 1e-4"].map(|run| step(&with(run)));
    assert!(fine.0 < coarse.0, "{fine:?} and {coarse:?}");
    for ((step, error), accuracy) in [(coarse, 1e-2), (fine, 1e-4)] {
        let error = error.expect("it was chosen");
        assert!(error.step == step && error.greatest <= accuracy, "{error:?}");
    }
    for accuracy in ["0.0", "1.0", "1e-10"] {
        let text = format!("{EXAMPLE}\naccuracy = {accuracy}");
        assert!(Scenario::from_str(&text, "test.toml").is_err(), "{accuracy}");
    }
}

proptest! {
    /// No text makes the reading panic, and what it accepts it writes back.
    #[test]
    fn damaged_files_are_read_or_refused(cut in 0..EXAMPLE.len(), length in 0..40_usize, insert in "[ -~\n]{0,6}") {
        let mut text = EXAMPLE.to_owned();
        text.replace_range(cut..(cut + length).min(EXAMPLE.len()), &insert);
        match Scenario::from_str(&text, "damaged.toml") {
            Ok(scenario) => prop_assert_eq!(Scenario::from_str(&scenario.to_toml(), "again.toml"), Ok(scenario)),
            Err(mistakes) => prop_assert!(mistakes.to_string().contains("error: ")),
        }
    }

    #[test]
    fn numbers_survive_the_round_trip(mass in 1e-300_f64..1e300, turns in 1e-3_f64..1e3, pressure in -1e5_f64..1e9) {
        let mut scenario = read(EXAMPLE);
        scenario.load = Load::HangingMass { mass, gravity: -pressure };
        scenario.actuator.turns = turns;
        scenario.initial.gauge_pressure = Some(pressure);
        prop_assert_eq!(Scenario::from_str(&scenario.to_toml(), "again.toml"), Ok(scenario));
    }
}

const JOINT: &str = r#"
[supply]
gauge_pressure = "4 bar"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[load]
kind = "antagonistic-joint"
pulley_radius = "15 mm"
rest_length = "3.3 in"
mass = "0.5 kg"
distance = "100 mm"
max_angle = "40 deg"
[initial]
gauge_pressure = "1 bar"
[run]
duration = "1 s"
"#;

#[test]
fn an_antagonist_is_as_the_agonist_but_for_what_is_said_of_it() {
    let same = Scenario::from_str(JOINT, "joint.toml").unwrap_or_else(|error| panic!("{error}"));
    let Load::AntagonisticJoint(joint) = &same.load else { panic!("{:?}", same.load) };
    let second = &joint.antagonist;
    assert_eq!((&second.actuator, &second.valve, &second.command), (&same.actuator, &same.valve, &same.command));
    assert_eq!((&second.tendon, second.gauge_pressure), (&joint.tendon, Some(1e5)));
    assert_eq!((joint.min_angle, joint.max_angle), (None, Some(40_f64.to_radians())));

    let changed = format!(
        "{JOINT}[antagonist]\nactuator.turns = 3\nload.pulley_radius = \"20 mm\"\ninitial.gauge_pressure = \"2 bar\"\n\
         [antagonist.command]\nkind = \"table\"\ntime = [\"0.1 s\"]\nstate = [\"fill\"]\n[antagonist.supply]\ngauge_pressure = \"5 bar\"\n"
    );
    let scenario = Scenario::from_str(&changed, "joint.toml").unwrap_or_else(|error| panic!("{error}"));
    let Load::AntagonisticJoint(joint) = &scenario.load else { panic!("{:?}", scenario.load) };
    let second = &joint.antagonist;
    assert_eq!((second.actuator.turns, scenario.actuator.turns), (3.0, 2.5));
    assert_eq!((&second.tendon.arm, &joint.tendon.arm), (&MomentArm::Pulley(0.02), &MomentArm::Pulley(0.015)));
    assert_eq!(second.tendon.rest_length, 0.08382);
    assert_eq!((second.gauge_pressure, second.supply.map(|supply| supply.gauge_pressure)), (Some(2e5), Some(5e5)));
    assert_eq!(second.command, Some(Command::Table { time: vec![0.1], state: vec![CommandState::Fill] }));
    assert_eq!(second.valve, scenario.valve);

    let again = Scenario::from_str(&scenario.to_toml(), "again.toml").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again, scenario);
}

#[test]
fn a_moment_arm_is_a_radius_or_a_table_and_taken_whole_by_the_antagonist() {
    let table =
        "moment_arm_angle = [\"-30 deg\", \"0 deg\", \"30 deg\"]\nmoment_arm = [\"12 mm\", \"15 mm\", \"16 mm\"]";
    let read = |text: &str| Scenario::from_str(text, "joint.toml").unwrap_or_else(|error| panic!("{error}"));
    let by_table = JOINT.replace("pulley_radius = \"15 mm\"", table);
    let arms = |scenario: &Scenario| {
        let Load::AntagonisticJoint(joint) = &scenario.load else { panic!("{:?}", scenario.load) };
        [joint.tendon.arm.clone(), joint.antagonist.tendon.arm.clone()]
    };
    let right = 30_f64.to_radians();
    let tabled = MomentArm::Table { angle: vec![-right, 0.0, right], arm: vec![0.012, 0.015, 0.016] };
    let both = read(&by_table);
    assert_eq!(arms(&both), [tabled.clone(), tabled.clone()]);
    assert_eq!(read(&both.to_toml()), both);
    let pulley = read(&format!("{by_table}[antagonist.load]\npulley_radius = \"15 mm\"\n"));
    assert_eq!(arms(&pulley), [tabled.clone(), MomentArm::Pulley(0.015)]);
    let other = read(&format!("{JOINT}[antagonist.load]\n{table}\n"));
    assert_eq!(arms(&other), [MomentArm::Pulley(0.015), tabled]);

    let error_of = |text: &str| match Document::parse(text, "joint.toml").expect("TOML").joint_experiment() {
        Ok(_) => panic!("it is refused:\n{text}"),
        Err(found) => found.to_string(),
    };
    let error = error_of(&JOINT.replace("pulley_radius = \"15 mm\"", ""));
    assert!(error.contains("pulley_radius") && error.contains("`moment_arm`"), "{error}");
    let error = error_of(&JOINT.replace("rest_length", &format!("{table}\nrest_length")));
    assert!(error.contains("says the same thing in two ways"), "{error}");
    let error = error_of(&by_table.replace("\"12 mm\", ", ""));
    assert!(error.contains("equally long"), "{error}");
    let error = error_of(&by_table.replace("12 mm", "0 mm"));
    assert!(error.contains("load.moment_arm") && error.contains("greater than 0"), "{error}");
    let error = error_of(&by_table.replace("-30 deg", "10 deg"));
    assert!(error.contains("must increase"), "{error}");
}

#[test]
fn mistakes_in_a_joint_are_shown_where_they_are() {
    let error_of = |text: &str| match Document::parse(text, "joint.toml").expect("TOML").joint_experiment() {
        Ok(_) => panic!("it is refused:\n{text}"),
        Err(found) => found.to_string(),
    };
    let with = |more: &str| error_of(&format!("{JOINT}{more}\n"));
    let error = with("[antagonist]\nactuator.turn = 3");
    assert!(error.contains("`turn` is not a key of [antagonist.actuator]") && error.contains("`turns`"), "{error}");
    let error = with("[antagonist.load]\nmass = \"1 kg\"");
    assert!(error.contains("`mass` is not a key of [antagonist.load]"), "{error}");
    let error = with("[antagonist.actuator]\nturns = -1");
    assert!(error.contains("turns") && error.contains("joint.toml:22"), "{error}");
    let error = error_of(&JOINT.replace("[initial]", "[initial]\nlength = \"3 in\""));
    assert!(error.contains("give `initial.angle`"), "{error}");
    let error = error_of(&JOINT.replace("100 mm", "0 mm"));
    assert!(error.contains("load.inertia"), "{error}");
    let error = error_of(
        "[load]\nkind = \"isometric\"\n[initial]\nlength = \"9 cm\"\n[run]\nduration = \"1 s\"\n[antagonist]\nactuator.turns = 3",
    );
    assert!(error.contains("[antagonist] is not used"), "{error}");
}

#[test]
fn a_pressure_at_the_end_of_a_hose_is_read_built_and_written() {
    let file = "[pressure]\nat = \"hose\"\ntime = [\"0 s\", \"100 ms\"]\ngauge_pressure = [\"1 bar\", \"3 bar\"]\n\
                [hose]\nlength = \"1 m\"\ndiameter = \"3 mm\"\n[actuator]\nleakage = \"1e-12 m^3/(s*Pa)\"\n\
                [load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"0.2 s\"\n";
    for (more, start) in [("", 1e5), ("[initial]\ngauge_pressure = \"0.5 bar\"\n", 0.5e5)] {
        let read = Scenario::from_str(&format!("{file}{more}"), "test.toml").unwrap_or_else(|error| panic!("{error}"));
        let experiment = read.experiment().expect("an experiment");
        assert!((experiment.start.pressure.0 - 101_325.0 - start).abs() < 1e-6);
        assert!(experiment.rig.line().hose.is_some() && experiment.rig.pressure_series().is_some());
        let text = read.to_toml();
        let again = Scenario::from_str(&text, "again.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(again, read);
    }
    let error = Scenario::from_str(&file.replace("[hose]\nlength = \"1 m\"\ndiameter = \"3 mm\"\n", ""), "test.toml");
    assert!(error.expect_err("no hose").to_string().contains("there is no hose at whose end the pressure could be"));
}

#[test]
fn a_pressure_over_time_is_read_built_and_written() {
    let file = "[pressure]\ntime = [\"0 s\", \"100 ms\"]\ngauge_pressure = [\"1 bar\", \"3 bar\"]\n\
                [load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"0.2 s\"\n";
    let read = Scenario::from_str(file, "test.toml").unwrap_or_else(|error| panic!("{error}"));
    let series = PressureSeries {
        at: PressurePlace::Muscle,
        time: vec![0.0, 0.1],
        gauge_pressure: vec![1e5, 3e5],
        sensor: PressureSensor::default(),
    };
    assert_eq!(read.pressure, Some(series));
    let experiment = read.experiment().expect("an experiment");
    assert!((experiment.start.pressure.0 - 201_325.0).abs() < 1e-6);
    let text = read.to_toml();
    let again = Scenario::from_str(&text, "again.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(again, read);
    for (more, words) in [
        ("[initial]\ngauge_pressure = \"1 bar\"\n", "`initial.gauge_pressure` is not used where `[pressure]`"),
        (
            "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n[command]\nkind = \"fill\"\n",
            "`valve` is not used where `[pressure]`",
        ),
        ("[actuator]\nleakage = \"1e-12 m^3/(s*Pa)\"\n", "a valve or a leak would change it too"),
        ("[hose]\nlength = \"1 m\"\ndiameter = \"3 mm\"\n", "set `pressure.at = \"hose\"`"),
    ] {
        let document = Document::parse(&format!("{file}{more}"), "test.toml").expect("it is TOML");
        let error = document.experiment().expect_err("a mistake").to_string();
        assert!(error.contains(words), "{error}");
    }
    // A tendon goes with it.
    let tendon =
        Document::parse(&format!("{file}[tendon]\nstiffness = \"10 kN/m\"\n"), "test.toml").expect("it is TOML");
    let rig = tendon.experiment().unwrap_or_else(|error| panic!("{error}")).rig;
    assert!(rig.tendon().is_some() && rig.pressure_series().is_some());
    let short = file.replace(", \"3 bar\"", "");
    let error = Document::parse(&short, "test.toml").expect("it is TOML").experiment().expect_err("short").to_string();
    assert!(error.contains("equally long"), "{error}");
}
