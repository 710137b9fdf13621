//! `mckibben simulate` with a controller: what it writes, prints and draws.

use crate::common::{Folder, of_repository};
use std::collections::HashMap;
use std::path::Path;

/// The numbers of a CSV file by column.
fn columns(path: &Path) -> HashMap<String, Vec<f64>> {
    let mut reader = csv::Reader::from_path(path).expect("a CSV file");
    let names: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let mut columns: HashMap<String, Vec<f64>> = HashMap::new();
    for record in reader.records() {
        for (name, field) in names.iter().zip(record.expect("a row").iter()) {
            columns.entry(name.clone()).or_default().extend(field.parse::<f64>());
        }
    }
    columns
}

fn run(folder: &Folder, example: &str, more: &[&str]) -> (String, HashMap<String, Vec<f64>>) {
    let file = of_repository(&format!("examples/control/{example}.toml"));
    let mut program = folder.mckibben();
    program.arg("simulate").arg(file).args(["--output", "run.csv"]).args(more);
    let output = program.output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    (String::from_utf8(output.stdout).expect("UTF-8"), columns(&folder.path("run.csv")))
}

const PSI: f64 = 6894.757293168361;

#[test]
fn a_relay_keeps_the_pressure_of_the_file_within_its_dead_band() {
    let folder = Folder::new("control-relay");
    let (summary, of) = run(&folder, "bang-bang", &["--plot", "run.svg"]);
    for (row, time) in of["time_s"].iter().enumerate() {
        let wanted = if *time < 1.0 {
            40.0
        } else if *time < 2.0 {
            60.0
        } else {
            30.0
        };
        assert!((of["set_point_pa"][row] - wanted * PSI).abs() < 1e-6, "{time}");
        // What is measured was so at the last sampling instant, to half the resolution.
        if (row % 2) == 0 {
            assert!(
                (of["measured_pa"][row] - (of["absolute_pressure_pa"][row] - 101_325.0)).abs() < 0.0501 * PSI,
                "{time}"
            );
        }
    }
    let last = of["absolute_pressure_pa"].last().expect("a row") - 101_325.0;
    assert!((last - 30.0 * PSI).abs() < 1.1 * PSI, "{last}");
    assert!(summary.contains("bang-bang control of gauge pressure at 500 Hz"), "{summary}");
    assert!(summary.contains("rms error") && summary.contains("air used"), "{summary}");
    let figure = std::fs::read_to_string(folder.path("run.svg")).expect("a figure");
    assert!(figure.contains("set point"));
}

#[test]
fn a_goal_that_is_not_regulated_is_written_and_reported() {
    let folder = Folder::new("control-model");
    let (summary, of) = run(&folder, "air-mass", &[]);
    let names = ["set_point_kg", "measured_kg", "set_point_m", "set_point_n"];
    assert!(names.iter().all(|name| of[*name].len() == 6001), "{:?}", of.keys());
    assert!(!of.contains_key("measured_m"));
    // The model's mass for the load at a length by (3) and the ideal gas law, from the numbers of the preset.
    let (thread, turns, length) = (4.3218 * 0.0254f64, 2.5f64, 0.089);
    let per_turns = 1.0 / (4.0 * std::f64::consts::PI * turns * turns);
    let gauge = 22.24 / ((3.0 * length * length - thread * thread) * per_turns);
    let volume = length * (thread * thread - length * length) * per_turns + 3e-6;
    let mass = (gauge + 101_325.0) * volume / (286.99 * 293.15);
    let last = *of["set_point_kg"].last().expect("a row");
    assert!((last / mass - 1.0).abs() < 1e-4, "{last} {mass}");
    assert!((of["air_mass_kg"].last().expect("a row") - last).abs() < 0.6e-6);
    assert!(summary.contains("mass of air") && summary.contains("length"), "{summary}");
}

#[test]
fn the_fixed_step_engine_closes_the_same_loop() {
    let folder = Folder::new("control-steps");
    let (_, located) = run(&folder, "pid", &[]);
    let fixed = ["--set", "run.engine=fixed-step", "--set", "run.step=50 us", "--quiet"];
    let (_, stepped) = run(&folder, "pid", &fixed);
    assert_eq!(located["set_point_m"], stepped["set_point_m"]);
    let difference =
        |name: &str| located[name].iter().zip(&stepped[name]).map(|(a, b)| (a - b).abs()).fold(0.0f64, f64::max);
    // A count of the sensor's 10 µm that falls the other way moves a pulse's end by 10/15000 of a period.
    assert!(difference("length_m") < 1e-4, "{}", difference("length_m"));
}

#[test]
fn the_fixed_step_engine_closes_the_loop_of_a_joint() {
    let folder = Folder::new("control-joint-steps");
    let (_, located) = run(&folder, "joint-bang-bang", &[]);
    let fixed = ["--set", "run.engine=fixed-step", "--set", "run.step=0.1 ms"];
    let (summary, stepped) = run(&folder, "joint-bang-bang", &fixed);
    assert_eq!(located["set_point_rad"], stepped["set_point_rad"]);
    assert!(summary.contains("rms error") && summary.contains("changes of the valve's command"), "{summary}");
    let difference =
        |name: &str| located[name].iter().zip(&stepped[name]).map(|(a, b)| (a - b).abs()).fold(0.0f64, f64::max);
    // Far below a count of the sensor, 1.7 mrad.
    assert!(difference("angle_rad") < 1e-4, "{}", difference("angle_rad"));
    assert!(difference("antagonist_absolute_pressure_pa") < 50.0, "{}", difference("antagonist_absolute_pressure_pa"));
}

#[test]
fn static_curves_need_no_controller() {
    let folder = Folder::new("control-others");
    let file = of_repository("examples/control/pid.toml");
    let curves = folder.mckibben().arg("curves").arg(&file).output().expect("runs");
    assert!(curves.status.success(), "{}", String::from_utf8_lossy(&curves.stderr));
}

#[test]
fn two_masses_of_air_bring_a_joint_to_angle_and_stiffness() {
    let folder = Folder::new("control-joint");
    let isothermal = ["--set", "air.process=isothermal", "--set", "actuator.friction.coulomb_width=0 in"];
    let file = of_repository("examples/control/joint-air-mass.toml");
    let text = std::fs::read_to_string(file).expect("an example");
    let line = text.lines().find(|line| line.starts_with("heat_transfer")).expect("a key");
    folder.file("joint.toml", &text.replace(line, ""));
    let mut program = folder.mckibben();
    program.args(["simulate", "joint.toml", "--output", "run.csv", "--plot", "run.svg"]).args(isothermal);
    let output = program.output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let of = columns(&folder.path("run.csv"));
    // At rest before the step of the stiffness, before the step back, before that of the angle, and at the end.
    for (row, angle, stiffness) in [(1999, 12.0, 0.8), (3999, 12.0, 1.4), (5999, 12.0, 0.8), (8000, -8.0, 0.8)] {
        assert!((of["set_point_rad"][row] - f64::to_radians(angle)).abs() < 1e-12);
        assert!((of["angle_rad"][row].to_degrees() - angle).abs() < 0.5, "{row}: {}", of["angle_rad"][row]);
        assert!((of["measured_n_m_rad"][row] - stiffness).abs() < 0.02, "{row}: {}", of["measured_n_m_rad"][row]);
        for prefix in ["", "antagonist_"] {
            let [set, mass] = ["set_point_kg", "air_mass_kg"].map(|name| of[&format!("{prefix}{name}")][row]);
            assert!((set - mass).abs() < 0.2e-6, "{row}: {set} {mass}");
        }
    }
    let summary = String::from_utf8(output.stdout).expect("UTF-8");
    for part in ["mass of air", "antagonist", "stiffness", "requests"] {
        assert!(summary.contains(part), "{summary}");
    }
}

#[test]
fn a_relay_on_both_actuators_rests_at_the_angle() {
    let folder = Folder::new("control-joint-relay");
    let (summary, of) = run(&folder, "joint-bang-bang", &["--plot", "run.svg"]);
    for (row, angle) in [(2499, 15.0), (4500, -10.0)] {
        assert!((of["angle_rad"][row].to_degrees() - angle).abs() < 2.1, "{row}: {}", of["angle_rad"][row]);
        assert!((of["measured_rad"][row] - of["angle_rad"][row]).abs() < f64::to_radians(0.051));
    }
    assert!(summary.contains("bang-bang control of angle at 200 Hz"), "{summary}");
    let figure = std::fs::read_to_string(folder.path("run.svg")).expect("a figure");
    assert!(figure.contains("set point"));
}
