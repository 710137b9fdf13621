//! A controller in a file: read, written, built, and refused where it cannot be run.

use mckibben::control::{Quantity, SetPoint};
use mckibben_scenario::{Aim, Command, Document, Regulator, Scenario};

const START: &str = "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"KIND\"\nflow_area = \"0.2 mm^2\"\n\
    [command]\nkind = \"controllers\"\n[load]\nkind = \"hanging-mass\"\nmass = \"2 kg\"\n\
    [run]\nduration = \"1 s\"\n[controller]\nrate = \"100 Hz\"\n";

fn document(controller: &str, kind: &str) -> Document {
    Document::parse(&(START.replace("KIND", kind) + controller), "controller.toml").expect("TOML")
}

const LAWS: [&str; 6] = [
    "kind = \"bang-bang\"\ngauge_pressure = \"2 bar\"\ndead_band = \"0.1 bar\"\nhysteresis = \"0.05 bar\"",
    "kind = \"pid\"\nlength = \"9 cm\"\namplitude = \"2 mm\"\nfrequency = \"1 Hz\"\nproportional_band = \"1 cm\"\ndelay = 2",
    "kind = \"pid\"\nforce = [\"9 N\", \"12 N\"]\ntime = [\"0 s\", \"1 s\"]\ntable = \"lines\"\nproportional_band = \"1 N\"\n\
     integral_time = \"1 s\"\npulse_frequency = \"50 Hz\"",
    "kind = \"feed-forward\"\nforce = \"20 N\"\nlength = \"9 cm\"\nhighest_gauge_pressure = \"5 bar\"\n\
     proportional_band = \"2 bar\"",
    "kind = \"air-mass\"\nforce = \"20 N\"\nhighest_gauge_pressure = \"5 bar\"\ndead_band = \"1 mg\"",
    "kind = \"bang-bang\"\nlength = [\"9 cm\", \"85 mm\"]\ntime = [\"0 s\", \"1 s\"]\ndead_band = \"1 mm\"\nresolution = \"10 um\"",
];

#[test]
fn what_is_written_reads_back_the_same_and_can_be_run() {
    for law in LAWS {
        let scenario = document(law, "fill-hold-exhaust").scenario().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Scenario::from_str(&scenario.to_toml(), "again.toml"), Ok(scenario.clone()), "{law}");
        for kind in ["fill-hold-exhaust", "three-way"] {
            let built = document(law, kind).controlled_experiment().unwrap_or_else(|error| panic!("{law}\n{error}"));
            assert_eq!(built.expect("a controller").sampling.rate(), 100.0);
        }
    }
}

#[test]
fn numbers_arrive_in_the_unit_of_what_is_regulated() {
    let scenario = document(LAWS[1], "three-way").scenario().expect("a scenario");
    let Some(Command::Controller(of)) = scenario.command else { panic!("a controller") };
    let set_point = SetPoint::Sinusoid { mean: 0.09, amplitude: 0.002, frequency: 1.0, phase: 0.0 };
    assert_eq!(of.aim, Aim::Track { quantity: Quantity::Length, set_point });
    assert!(matches!(of.regulator, Regulator::Pid { proportional_band: 0.01, integral_time: None, .. }));
    assert_eq!((of.delay, of.rate, of.resolution), (2, 100.0, 0.0));
}

#[test]
fn what_is_wrong_is_said() {
    let pid = "kind = \"pid\"\n";
    for (kind, text, part) in [
        ("three-way", pid.to_owned() + "proportional_band = \"1 bar\"", "`controller.gauge_pressure`"),
        ("three-way", pid.to_owned() + "length = \"9 cm\"\nproportional_band = \"1 bar\"", "is a pressure"),
        ("three-way", pid.to_owned() + "length = \"9 cm\"\nforce = \"1 N\"\nproportional_band = \"1 cm\"", "two ways"),
        ("three-way", pid.to_owned() + "length = \"9 cm\"", "`controller.proportional_band`"),
        ("three-way", LAWS[0].replace("0.05 bar", "1 bar"), "controller.hysteresis"),
        ("three-way", LAWS[1].replace("2 mm", "10 cm"), "controller.length"),
        ("three-way", LAWS[4].to_owned() + "\nbias = 0.1", "`controller.bias` is not used"),
        ("three-way", LAWS[0].to_owned() + "\ndelay = 17", "must be at least 0 and at most 16"),
        (
            "three-way",
            LAWS[0].to_owned() + "\nproportional_band = \"1 bar\"",
            "`controller.proportional_band` is not used",
        ),
        ("three-way", LAWS[2].replace("\"0 s\", \"1 s\"", "\"1 s\", \"0 s\""), "must increase from entry to entry"),
        ("three-way", LAWS[2].replace(", \"1 s\"", ""), "`controller.time` has 1 entries"),
        ("three-way", LAWS[3].replace("\"5 bar\"", "\"-5 bar\""), "give at most the gauge pressure of the supply"),
        ("two-way", LAWS[0].to_owned(), "neither three-way nor fill-hold-exhaust"),
    ] {
        let error = document(&text, kind).controlled_experiment().expect_err("refused").to_string();
        assert!(error.contains(part), "{part}:\n{error}");
    }
}

#[test]
fn where_controllers_are_not_supported_it_is_said() {
    let document = document(LAWS[0], "three-way");
    let error = document.experiment().expect_err("refused").to_string();
    assert!(error.contains("command.kind = \"controllers\" is not implemented"), "{error}");
    let start = START.replace("KIND", "three-way").replace("controllers", "fill");
    let error = Document::parse(&(start + LAWS[0]), "controller.toml").expect("TOML").scenario().expect_err("refused");
    assert!(error.to_string().contains("`command.kind` does not ask for it"), "{error}");
}

const JOINT: &str = "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"KIND\"\nflow_area = \"0.2 mm^2\"\n\
    [command]\nkind = \"controllers\"\n[load]\nkind = \"antagonistic-joint\"\nmass = \"0.3 kg\"\ndistance = \"5 cm\"\n\
    pulley_radius = \"15 mm\"\nrest_length = \"82 mm\"\n[initial]\ngauge_pressure = \"2 bar\"\n[run]\nduration = \"1 s\"\n\
    [controller]\nrate = \"100 Hz\"\n";

fn joint(controller: &str, kind: &str) -> Document {
    Document::parse(&(JOINT.replace("KIND", kind) + controller), "joint.toml").expect("TOML")
}

const LAWS_OF_JOINTS: [&str; 4] = [
    "kind = \"bang-bang\"\nangle = [\"0 deg\", \"10 deg\"]\ntime = [\"0 s\", \"1 s\"]\ndead_band = \"1 deg\"",
    "kind = \"pid\"\nangle = \"0 deg\"\namplitude = \"10 deg\"\nfrequency = \"1 Hz\"\nproportional_band = \"20 deg\"\n\
     resolution = \"0.1 deg\"",
    "kind = \"feed-forward\"\nangle = \"5 deg\"\nstiffness = \"0.6 N*m/rad\"\nhighest_gauge_pressure = \"5 bar\"\n\
     dead_band = \"0.1 bar\"",
    "kind = \"air-mass\"\nangle = \"5 deg\"\nstiffness = [\"0.8 N*m/rad\", \"1 N*m/rad\"]\ntime = [\"0 s\", \"1 s\"]\n\
     highest_gauge_pressure = \"5 bar\"\nproportional_band = \"10 mg\"",
];

#[test]
fn controllers_of_joints_read_back_the_same_and_can_be_run() {
    for law in LAWS_OF_JOINTS {
        let scenario = joint(law, "fill-hold-exhaust").scenario().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Scenario::from_str(&scenario.to_toml(), "again.toml"), Ok(scenario.clone()), "{law}");
        for kind in ["fill-hold-exhaust", "three-way"] {
            let document = joint(law, kind);
            let built = document.controlled_joint_experiment().unwrap_or_else(|error| panic!("{law}\n{error}"));
            assert_eq!(built.expect("a controller").sampling.rate(), 100.0);
            assert_eq!(document.controlled_experiment(), Ok(None));
        }
    }
}

#[test]
fn what_is_wrong_with_a_controller_of_a_joint_is_said() {
    let antagonist = "\n[antagonist.command]\nkind = \"hold\"";
    for (kind, text, part) in [
        ("three-way", LAWS[0].to_owned(), "`controller.gauge_pressure` is not used for a joint"),
        ("three-way", LAWS[4].to_owned(), "`controller.angle`"),
        ("three-way", LAWS_OF_JOINTS[3].replace("\"5 deg\"", "\"80 deg\""), "actuator.min_length"),
        ("three-way", LAWS_OF_JOINTS[2].replace("0.6 N*m/rad", "-1 N*m/rad"), "`controller.stiffness` = -1 N*m/rad"),
        ("fill-hold-exhaust", LAWS_OF_JOINTS[0].to_owned() + antagonist, "`command.kind` does not ask for it"),
        (
            "fill-hold-exhaust",
            LAWS_OF_JOINTS[0].to_owned() + "\n[antagonist.valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"",
            "valves are of different kinds",
        ),
        ("five-way", LAWS_OF_JOINTS[0].to_owned(), "neither three-way nor fill-hold-exhaust"),
    ] {
        let error = joint(&text, kind).controlled_joint_experiment().expect_err("refused").to_string();
        assert!(error.contains(part), "{part}:\n{error}");
    }
    let text = LAWS[0].replace("gauge_pressure = \"2 bar\"", "angle = \"2 deg\"");
    let error = document(&text, "three-way").controlled_experiment().expect_err("refused").to_string();
    assert!(error.contains("`controller.angle` is not used without a joint"), "{error}");
}
