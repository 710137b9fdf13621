//! `mckibben simulate` and `mckibben sweep` with a tendon in series: columns, the summary, the figure, a sweep's rows.

use crate::common::{Folder, of_repository};

const STIFFNESS: f64 = 16e3;

fn run(folder: &Folder, arguments: &[&str]) -> String {
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_load_on_a_tendon_is_simulated_drawn_and_swept() {
    let folder = Folder::new("tendon");
    let file = of_repository("examples/tendon.toml").display().to_string();
    let printed = run(&folder, &["simulate", &file, "-o", "run.csv", "-p", "run.svg"]);
    for words in ["16 kN/m in series", "stretched by"] {
        assert!(printed.contains(words), "{words}:\n{printed}");
    }
    let svg = std::fs::read_to_string(folder.path("run.svg")).expect("written");
    assert!(svg.contains("load distance"));

    let mut reader = csv::Reader::from_path(folder.path("run.csv")).expect("a CSV file");
    let header = reader.headers().expect("a header").iter().collect::<Vec<_>>().join(",");
    assert!(header.ends_with("valve,load_distance_m,load_velocity_m_s"), "{header}");
    let mut last = String::new();
    for record in reader.records() {
        let record = record.expect("a row");
        let number = |column: usize| record[column].parse::<f64>().expect("a number");
        let stretch = number(11) - 0.06 - number(1);
        assert!((number(8) - STIFFNESS * stretch.max(0.0)).abs() < 1e-6, "at {} s", number(0));
        last = record[1].to_owned();
    }

    let text = std::fs::read_to_string(&file).expect("the example");
    let vary = "engine = \"event-located\"\n[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n\"tendon.stiffness\" = [\"16 kN/m\", \"40 kN/m\"]\n";
    let swept = folder.file("swept.toml", &(text + vary)).display().to_string();
    run(&folder, &["sweep", &swept, "-o", "swept.csv"]);
    let lines = std::fs::read_to_string(folder.path("swept.csv")).expect("written");
    assert!(lines.contains(&last), "{last}:\n{lines}");
}

/// A controller closes the loop on a tendon by both engines, and a sweep's row is that of `mckibben simulate`.
#[test]
fn a_load_on_a_tendon_is_controlled_and_swept() {
    let folder = Folder::new("tendon-control");
    let text = std::fs::read_to_string(of_repository("examples/control/pid.toml")).expect("the example");
    let (before, _) = text.split_once("[run]").expect("a section");
    for (place, engine) in ["event-located\"", "fixed-step\"\nstep = \"0.5 ms\""].into_iter().enumerate() {
        let tendon = "[tendon]\nstiffness = \"16 kN/m\"\nrest_length = \"60 mm\"\n";
        let run_of = format!("{before}{tendon}[run]\nduration = \"0.5 s\"\nengine = \"{engine}\n");
        let out = format!("swept-{place}.csv");
        let file = folder.file("loop.toml", &run_of).display().to_string();
        run(&folder, &["simulate", &file, "-o", "run.csv"]);
        let lines = std::fs::read_to_string(folder.path("run.csv")).expect("written");
        let last = lines.lines().last().and_then(|line| line.split(',').nth(1)).expect("a length").to_owned();
        let vary = "[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n\"tendon.stiffness\" = [\"16 kN/m\", \"40 kN/m\"]\n";
        let swept = folder.file("swept.toml", &(run_of + vary)).display().to_string();
        run(&folder, &["sweep", &swept, "-o", &out]);
        let rows = std::fs::read_to_string(folder.path(&out)).expect("written");
        assert!(rows.contains(&last), "{last}:\n{rows}");
    }
}

#[test]
fn a_load_on_a_tendon_is_linearised() {
    let folder = Folder::new("tendon-linear");
    let file = of_repository("examples/tendon.toml").display().to_string();
    let printed = run(&folder, &["linearize", &file, "-o", "model.json"]);
    assert!(printed.contains("the load is at"), "{printed}");
    let model = std::fs::read_to_string(folder.path("model.json")).expect("written");
    for name in ["load_distance_m", "\"load_velocity\"", "\"length\""] {
        assert!(model.contains(name), "{name}:\n{model}");
    }
}
