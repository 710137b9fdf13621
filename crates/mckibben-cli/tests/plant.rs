//! Files of many actuators: columns, events, figures, summaries, and that a run is that of the older files where those say the
//! same. What else takes such files is in `features`.

mod features;

use crate::common::{Folder, of_repository};
use std::collections::HashMap;

fn run(folder: &Folder, arguments: &[&str]) -> String {
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn example(name: &str) -> String {
    of_repository(&format!("examples/{name}.toml")).display().to_string()
}

/// The columns of a CSV file by their names, words as NaN, and the names in their order.
fn columns(folder: &Folder, name: &str) -> (Vec<String>, HashMap<String, Vec<f64>>) {
    let mut reader = csv::Reader::from_path(folder.path(name)).expect("a CSV file");
    let header: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let mut columns: HashMap<String, Vec<f64>> = HashMap::new();
    for record in reader.records() {
        for (name, text) in header.iter().zip(record.expect("a row").iter()) {
            columns.entry(name.clone()).or_default().push(text.parse().unwrap_or(f64::NAN));
        }
    }
    (header, columns)
}

/// The largest difference of two columns over the range of the second.
fn apart(first: &[f64], second: &[f64]) -> f64 {
    assert_eq!(first.len(), second.len());
    let (low, high) = second.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    first.iter().zip(second).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / (high - low).max(1e-9 * high.abs())
}

#[test]
fn columns_carry_the_names() {
    let folder = Folder::new("plant-columns");
    let file = example("plant/arm");
    let printed = run(
        &folder,
        &[
            "simulate",
            &file,
            "--set",
            "run.duration=\"0.2 s\"",
            "-o",
            "run.csv",
            "-p",
            "run.svg",
            "--events-output",
            "events.csv",
        ],
    );
    for words in
        ["deltoid, latissimus, biceps", "a chain of 3 joints: shoulder, elbow, wrist", "tank, regulator, manifold"]
    {
        assert!(printed.contains(words), "{words}:\n{printed}");
    }
    let (header, columns) = columns(&folder, "run.csv");
    let of_one = "length_m,velocity_m_s,absolute_pressure_pa,gauge_pressure_pa,air_mass_kg,temperature_k,volume_m3,tension_n,mass_flow_kg_s,valve";
    let mut expected = vec!["time_s".to_owned()];
    for name in ["deltoid", "latissimus", "biceps", "triceps", "flexor", "extensor"] {
        expected.extend(of_one.split(',').map(|column| format!("{name}.{column}")));
    }
    for joint in ["shoulder", "elbow", "wrist"] {
        expected
            .extend(["angle_rad", "angular_velocity_rad_s", "torque_n_m"].map(|column| format!("{joint}.{column}")));
    }
    expected.extend(
        ["tank", "regulator", "manifold"]
            .iter()
            .flat_map(|name| ["absolute", "gauge"].map(|of| format!("{name}.{of}_pressure_pa"))),
    );
    assert_eq!(header, expected);
    assert_eq!(columns["time_s"].len(), 201);
    // The muscle over two joints shortens with both.
    for row in 0..201 {
        let length =
            3.4 * 0.0254 - 0.012 * columns["shoulder.angle_rad"][row] - 0.015 * columns["elbow.angle_rad"][row];
        assert!((columns["biceps.length_m"][row] - length).abs() < 1e-12);
        let torque = 0.012 * columns["biceps.tension_n"][row] + 0.02 * columns["deltoid.tension_n"][row]
            - 0.02 * columns["latissimus.tension_n"][row];
        assert!((columns["shoulder.torque_n_m"][row] - torque).abs() < 1e-9);
    }
    let svg = std::fs::read_to_string(folder.path("run.svg")).expect("written");
    for words in ["shoulder", "biceps", "manifold", "gauge pressure"] {
        assert!(svg.contains(words), "{words}");
    }
    let log = std::fs::read_to_string(folder.path("events.csv")).expect("written");
    assert!(log.starts_with("time_s,event,part,valve,length_regime,sliding,tension_clamped\n"), "{log}");
    assert!(log.lines().any(|line| line.contains(",valve,deltoid,supply,")), "{log}");
}

/// The joint of older files, as a chain of one joint.
#[test]
fn a_joint_is_that_of_the_older_form() {
    let folder = Folder::new("plant-joint");
    run(&folder, &["simulate", &example("antagonistic-joint"), "-o", "old.csv"]);
    let text = std::fs::read_to_string(example("plant/hose-joint")).expect("the example");
    let (before, after) = text.split_once("[hose]\nlength = \"1 m\"\ndiameter = \"2.5 mm\"\n").expect("a hose");
    let text = format!("{before}{after}").replace("hose.length = \"2 m\"\n", "");
    // The older file starts where the torques balance.
    let (_, old) = columns(&folder, "old.csv");
    let text = text.replace("[coupling]", &format!("angle = \"{} rad\"\n[coupling]", old["angle_rad"][0]));
    let file = folder.file("new.toml", &text).display().to_string();
    run(&folder, &["simulate", &file, "-o", "new.csv"]);
    let (_, new) = columns(&folder, "new.csv");
    for (ours, theirs) in [
        ("elbow.angle_rad", "angle_rad"),
        ("elbow.torque_n_m", "torque_n_m"),
        ("agonist.absolute_pressure_pa", "absolute_pressure_pa"),
        ("antagonist.absolute_pressure_pa", "antagonist_absolute_pressure_pa"),
        ("agonist.length_m", "length_m"),
        ("antagonist.tension_n", "antagonist_tension_n"),
        ("agonist.air_mass_kg", "air_mass_kg"),
    ] {
        let most = apart(&new[ours], &old[theirs]);
        assert!(most < 1e-5, "{ours}: {most:e}");
    }
}

/// One actuator by its name is the run of the file without the name; in Parquet and CSV the same.
#[test]
fn one_actuator_runs_as_without_a_name() {
    let folder = Folder::new("plant-one");
    for name in ["paper/fig-12", "line/hanging-mass", "tendon"] {
        let text = std::fs::read_to_string(example(name)).expect("the example").replace("engine = \"fixed-step\"", "");
        let (old, new) = (folder.file("old.toml", &text), folder.file("new.toml", &(text + "\n[actuators.muscle]\n")));
        let set = ["--set", "run.duration=\"0.3 s\"", "--set", "run.sample_interval=\"1 ms\""];
        for (file, output) in [(old, "old.csv"), (new, "new.csv")] {
            run(&folder, &[&["simulate", &file.display().to_string(), "-o", output], &set[..]].concat());
        }
        let (old_names, old) = columns(&folder, "old.csv");
        let (new_names, new) = columns(&folder, "new.csv");
        for column in old_names
            .iter()
            .filter(|column| !["time_s", "valve", "velocity_m_s", "mass_flow_kg_s"].contains(&column.as_str()))
        {
            let ours = format!("muscle.{column}");
            assert!(new_names.contains(&ours), "{name}: {ours} in {new_names:?}");
            let most = apart(&new[&ours], &old[column]);
            assert!(most < 1e-5, "{name}, {column}: {most:e}");
        }
    }
}

/// A mass that all three pull on, one by a tendon, one at a pressure that is given; and a valve that vents the manifold.
#[test]
fn every_part_combines_with_every_other() {
    let folder = Folder::new("plant-all");
    let text = r#"
[supply]
gauge_pressure = "5 bar"
[supplies.manifold]
from = "supply"
reservoir_volume = "100 cm^3"
hose = { length = "1 m", diameter = "4 mm" }
[supplies.manifold.valve]
kind = "three-way"
flow_area = "5 mm^2"
[supplies.manifold.command]
kind = "table"
time = ["0 s", "0.3 s"]
state = ["fill", "exhaust"]
[valve]
kind = "fill-hold-exhaust"
flow_area = "1.5 mm^2"
[command]
kind = "pwm"
frequency = "20 Hz"
duty = 0.4
[mechanism]
kind = "mass"
mass = "4 kg"
position = "92 mm"
[actuators.plain]
supply = "manifold"
leakage = "1e-12 m^3/(s*Pa)"
[actuators.sprung]
supply = "manifold"
tendon.stiffness = "20 kN/m"
[actuators.given.pressure]
time = ["0 s", "0.2 s"]
gauge_pressure = ["1 bar", "2 bar"]
[actuators.alone]
load = { kind = "constant-force", force = "20 N", mass = "2 kg" }
initial.length = "90 mm"
supply = { gauge_pressure = "3 bar", reservoir_volume = "1 L" }
[run]
duration = "0.5 s"
"#;
    let file = folder.file("all.toml", text).display().to_string();
    let printed = run(&folder, &["check", &file]);
    assert!(printed.contains("a plant of plain, sprung, given, alone"), "{printed}");
    run(&folder, &["simulate", &file, "-o", "run.csv"]);
    let (header, columns) = columns(&folder, "run.csv");
    for name in [
        "mechanism.position_m",
        "mechanism.force_n",
        "sprung.load_distance_m",
        "manifold.absolute_pressure_pa",
        "manifold.valve",
        "alone.supply.absolute_pressure_pa",
    ] {
        assert!(header.iter().any(|column| column == name), "{name}: {header:?}");
    }
    let manifold = &columns["manifold.absolute_pressure_pa"];
    assert!(manifold[300] > 1.05 * manifold[500], "it is let go at 0.3 s: {} {}", manifold[300], manifold[500]);
    assert!(columns["alone.supply.absolute_pressure_pa"][500] < 401_325.0, "it sags");
    for row in 0..501 {
        // What spans the mass without a tendon is as long as it says.
        let x = columns["mechanism.position_m"][row];
        assert!(
            (columns["plain.length_m"][row] - x).abs() < 1e-12 && (columns["given.length_m"][row] - x).abs() < 1e-12
        );
        let tension = 20e3 * (x - columns["sprung.length_m"][row]).max(0.0);
        assert!((columns["sprung.tension_n"][row] - tension).abs() < 1e-5, "{row}");
    }
    assert!((columns["given.absolute_pressure_pa"][500] - 301_325.0).abs() < 1e-6);
}

#[test]
fn a_mistake_is_shown_where_it_stands() {
    let folder = Folder::new("plant-mistake");
    let text = std::fs::read_to_string(example("plant/arm")).expect("the example");
    let file = folder
        .file("arm.toml", &text.replace("arms.wrist = \"-10 mm\"", "arms.wirst = \"-10 mm\""))
        .display()
        .to_string();
    let output = folder.mckibben().args(["simulate", &file]).output().expect("the program runs");
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    for words in ["there is no joint `wirst`", "did you mean \"wrist\"?", "arm.toml:"] {
        assert!(error.contains(words), "{words}\n{error}");
    }
    // Values are set by the paths of the file.
    let file = example("plant/arm");
    run(&folder, &["simulate", &file, "--set", "actuators.biceps.turns=2.2", "--set", "run.duration=\"50 ms\""]);
    // A name that the file has not is a mistake, and no actuator more.
    let output =
        folder.mckibben().args(["simulate", &file, "--set", "actuators.bicep.turns=2.2"]).output().expect("it runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && error.contains("did you mean `biceps`?"), "{error}");
    let output =
        folder.mckibben().args(["simulate", &file, "--over", "length", "-p", "a.svg"]).output().expect("it runs");
    assert_eq!(output.status.code(), Some(2));
}
