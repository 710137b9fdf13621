//! `mckibben identify` where a search ends elsewhere than at a minimum: the best values are written and the report says so.

use crate::common::{Folder, is_ignored};
use std::process::Output;
use std::time::{Duration, Instant};

fn identify(folder: &Folder, study: &str) -> Output {
    folder.file("study.toml", study);
    folder.mckibben().args(["identify", "study.toml", "--output", "out"]).output().expect("the program runs")
}

fn words(output: &Output) -> String {
    // Lines of the terminal are broken anywhere.
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn read(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A column of the row of a CSV file that begins with a cell.
fn cell(csv: &str, row: &str, column: &str) -> String {
    let mut lines = csv::Reader::from_reader(csv.as_bytes());
    let place = lines.headers().expect("a head").iter().position(|head| head == column).expect("a column");
    let found = lines.records().map(|line| line.expect("a line")).find(|line| &line[0] == row);
    found.unwrap_or_else(|| panic!("{row} is not in\n{csv}"))[place].to_owned()
}

/// A load that goes slack and bounces at each pulse: its sum of squares is a mountain range with kinks.
const BOUNCING: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"100 psi\"\n[valve]\n\
     preset = \"matrix-eight-channel\"\n[command]\nkind = \"pwm\"\nfrequency = \"10 Hz\"\nduty = 0.35\n[load]\n\
     kind = \"hanging-mass\"\nmass = \"5 lb\"\n[initial]\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"1 s\"\n\
     sample_interval = \"5 ms\"\n";

/// A mass that swings on a sealed muscle.
const SWING: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[initial]\n\
     gauge_pressure = \"60 psi\"\nlength = \"88 mm\"\n[run]\nduration = \"0.5 s\"\nsample_interval = \"2 ms\"\n";

fn recorded(folder: &Folder, scenario: &str) {
    folder.file("rig.toml", scenario);
    let run = folder.mckibben().args(["simulate", "rig.toml", "--output", "run.csv"]).output().expect("it runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

const STUDY: &str = "[study]\nkind = \"trajectories\"\nscenario = \"rig.toml\"\n[columns.time]\nname = \"time_s\"\nunit = \"s\"\n\
     [columns.length]\nname = \"length_m\"\nunit = \"m\"\n[[run]]\nfile = \"run.csv\"\n";

/// A mass that sticks rests the longer the larger its friction, up to where it sticks a half swing earlier: there the length at rest
/// has a kink. Readings of a length beyond it are fitted best at the kink.
#[test]
fn a_search_that_ends_at_a_kink_writes_the_best_values() {
    let folder = Folder::new("ends-kink");
    let rig = SWING.replace("length = \"88 mm\"", "length = \"86 mm\"").replace("\"0.5 s\"", "\"1.5 s\"");
    folder.file("rig.toml", &rig);
    folder.file("run.csv", "time_s,length_m\n1.1,0.087\n1.2,0.087\n1.3,0.087\n1.4,0.087\n1.5,0.087\n");
    let fit = "[fit.\"actuator.friction.coulomb_width\"]\nfrom = \"0.3 mm\"\nto = \"0.6 mm\"\nstart = \"0.35 mm\"\n";
    let output = identify(&folder, &format!("{STUDY}{fit}[search]\nmore_starts = 0\n"));
    let printed = words(&output);
    assert!(output.status.success(), "{printed}");
    assert!(printed.contains("the search ended at a kink") && printed.contains("they have no intervals"), "{printed}");
    let values = read(&folder, "out/values.csv");
    assert_eq!(cell(&values, "actuator.friction.coulomb_width", "95 % interval"), "none: no minimum", "{values}");
    for file in ["index.html", "scenario.toml", "run-1.svg"] {
        assert!(folder.path("out").join(file).exists(), "{file}");
    }
    // The length at rest, by the simulator: it falls off to both sides of the value.
    let width: f64 = cell(&values, "actuator.friction.coulomb_width", "value").parse().expect("a number");
    let [below, at, above] = [0.99, 1.0, 1.01].map(|part| {
        let set = format!("actuator.friction.coulomb_width=\"{} m\"", part * width);
        let run = folder.mckibben().args(["simulate", "rig.toml", "--set", &set, "--output", "rest.csv"]).output();
        assert!(run.expect("it runs").status.success());
        let text = read(&folder, "rest.csv");
        text.lines().last().and_then(|line| line.split(',').nth(1)?.parse::<f64>().ok()).expect("a length")
    });
    assert!(at > below + 1e-6 && at > above + 1e-6, "{below} {at} {above} at {width}");
}

/// Steps by derivatives go to and fro across a kink here, 500 times, with 18.6 mm left; steps without derivatives lead on from there.
#[test]
fn steps_without_derivatives_lead_on_from_a_kink() {
    let folder = Folder::new("ends-kinks");
    recorded(&folder, BOUNCING);
    let fit = "[fit.\"load.mass\"]\nstart = \"2.2 kg\"\nfrom = \"1.5 kg\"\nto = \"3.5 kg\"\n\
               [fit.\"actuator.friction.viscous\"]\nstart = \"4 N*s/m\"\nfrom = \"1 N*s/m\"\nto = \"10 N*s/m\"\n";
    let output = identify(&folder, &format!("{STUDY}{fit}[search]\nmore_starts = 0\n"));
    let printed = words(&output);
    assert!(output.status.success() && !printed.contains("took all its"), "{printed}");
    let left = cell(&read(&folder, "out/comparison.csv"), "all", "left");
    let left: f64 = left.split_whitespace().next().and_then(|of| of.parse().ok()).expect("a length in mm");
    assert!(left < 18.0, "{left}\n{printed}");
}

/// From one start the search for a mass that bounces ends in one of many minima; the starts that are taken unless the study says how
/// many find the mass that was recorded from all of them, and the report names the other minima.
#[test]
fn the_start_does_not_decide_and_other_minima_are_named() {
    let folder = Folder::new("ends-starts");
    recorded(&folder, BOUNCING);
    let study = |start: f64, search: &str| {
        format!("{STUDY}[fit.\"load.mass\"]\nstart = \"{start} kg\"\nfrom = \"1.5 kg\"\nto = \"3.5 kg\"\n{search}")
    };
    let truth = 5.0 * 0.453_592_37;
    let mass = |output: &Output| -> f64 {
        assert!(output.status.success(), "{}", words(output));
        cell(&read(&folder, "out/values.csv"), "load.mass", "value").parse().expect("a number")
    };
    let starts = [2.0, 2.1, 2.3, 2.5, 2.8, 3.2];
    let alone = starts.map(|start| mass(&identify(&folder, &study(start, "[search]\nmore_starts = 0\n"))));
    let lost = alone.iter().filter(|mass| (*mass / truth - 1.0).abs() > 2e-3).count();
    assert!(lost >= 4, "one start finds it from everywhere: {alone:?}");
    for start in starts {
        let output = identify(&folder, &study(start, ""));
        let (found, printed) = (mass(&output), words(&output));
        assert!((found / truth - 1.0).abs() < 1e-5, "{found} from {start}\n{printed}");
        assert!(printed.contains("of 16 more starts that were evaluated"), "{printed}");
        let minima = read(&folder, "out/minima.csv");
        assert!(minima.starts_with("load.mass (kg),") && minima.lines().count() > 2, "{minima}");
        let page = read(&folder, "out/index.html");
        assert!(page.contains("Where searches from several starts ended"), "{printed}");
    }
}

#[test]
fn limits_of_steps_and_time_write_the_best_values() {
    let folder = Folder::new("ends-limits");
    recorded(&folder, SWING);
    let fit = "[fit.\"load.mass\"]\nstart = \"3 kg\"\nfrom = \"1 kg\"\nto = \"6 kg\"\n[fit.\"actuator.friction.viscous\"]\nstart = \"20 N*s/m\"\n\
               from = \"0 N*s/m\"\nto = \"50 N*s/m\"\n";
    let output = identify(&folder, &format!("{STUDY}{fit}[search]\nmost_steps = 1\nmore_starts = 0\n"));
    assert!(
        output.status.success() && words(&output).contains("took all its 1 steps (most_steps in [search])"),
        "{}",
        words(&output)
    );
    assert!(folder.path("out/scenario.toml").exists() && folder.path("out/index.html").exists());
    // So many starts take far longer than the limit.
    let begun = Instant::now();
    let output = identify(&folder, &format!("{STUDY}{fit}[search]\nmore_starts = 100000\ntime_limit = \"2 s\"\n"));
    assert!(output.status.success() && words(&output).contains("time_limit in [search]"), "{}", words(&output));
    assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", begun.elapsed());
    for (search, said) in [
        ("most_steps = 0", "line 15"),
        ("time_limit = \"0 s\"", "not above zero"),
        ("time_limit = \"2 kg\"", "is no time"),
        ("time_limit = \"-1 s\"", "not above zero"),
    ] {
        let output = identify(&folder, &format!("{STUDY}{fit}[search]\n{search}\n"));
        let printed = words(&output);
        assert!(
            output.status.code() == Some(2) && (printed.contains(said) || printed.contains("most_steps")),
            "{said}: {printed}"
        );
    }
    let valve = STUDY.replace("trajectories", "pulse-train");
    let output = identify(&folder, &format!("{valve}[search]\ntime_limit = \"1 s\"\n"));
    assert!(output.status.code() == Some(2) && words(&output).contains("leave them out"), "{}", words(&output));
}

#[cfg(unix)]
#[test]
fn an_interrupted_search_writes_the_best_values() {
    let folder = Folder::new("ends-interrupt");
    recorded(&folder, SWING);
    let study =
        format!("{STUDY}[fit.\"load.mass\"]\nfrom = \"1 kg\"\nto = \"6 kg\"\n[search]\nmore_starts = 1000000\n");
    folder.file("study.toml", &study);
    for (signal, name, code) in [(2, "SIGINT", 130), (15, "SIGTERM", 143)] {
        if is_ignored(signal) {
            continue;
        }
        let output = folder.interrupted(&["identify", "study.toml", "--output", name], name, Duration::from_secs(3));
        let printed = words(&output);
        assert_eq!(output.status.code(), Some(code), "{printed}");
        assert!(printed.contains(&format!("{name}: the search ends with the best values so far")), "{printed}");
        assert!(printed.contains("the search was interrupted: these are the best values so far"), "{printed}");
        let values = read(&folder, &format!("{name}/values.csv"));
        let mass: f64 = cell(&values, "load.mass", "value").parse().expect("a number");
        assert!((mass / (5.0 * 0.453_592_37) - 1.0).abs() < 1e-3, "{mass}");
        assert!(folder.path(name).join("scenario.toml").exists() && folder.path(name).join("index.html").exists());
    }
}

/// A swing that comes to rest has an overshoot, a frequency and a settling time, measured and predicted, and a run that
/// was left out has those that the other predicts.
#[test]
fn step_like_runs_have_what_an_owner_looks_at() {
    let folder = Folder::new("ends-responses");
    let scenario = SWING.replace("duration = \"0.5 s\"", "duration = \"1.5 s\"");
    folder.file("rig.toml", &scenario.replace("[load]", "[actuator.friction]\nviscous = \"20 N*s/m\"\n[load]"));
    for (length, file) in [("88 mm", "run.csv"), ("86 mm", "other.csv")] {
        let set = format!("initial.length=\"{length}\"");
        let run = folder.mckibben().args(["simulate", "rig.toml", "--set", &set, "--output", file]).output();
        assert!(run.expect("it runs").status.success());
    }
    let fit = "[[run]]\nfile = \"other.csv\"\nset = { \"initial.length\" = \"86 mm\" }\n[fit.\"actuator.friction.viscous\"]\n\
               start = \"10 N*s/m\"\nfrom = \"1 N*s/m\"\nto = \"50 N*s/m\"\n";
    let output = identify(&folder, &format!("{STUDY}{fit}"));
    let printed = words(&output);
    assert!(output.status.success() && printed.contains("Runs that come to rest"), "{printed}");
    let table = read(&folder, "out/responses.csv");
    let rows: Vec<csv::StringRecord> =
        csv::Reader::from_reader(table.as_bytes()).records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 10, "{table}");
    for row in &rows {
        let name = &row[2];
        // The data have no noise: in sample and out of it the model is what was measured.
        match name {
            "error, root mean square" => assert!(row[4] == *"0.00 %" && row[5] == *"0.00 %", "{table}"),
            _ => assert!(row[3] == row[4] && row[4] == row[5] && &row[3] != "–", "{name}\n{table}"),
        }
    }
}

/// A valve behind a long thin line, whose scenario has no line: the critical ratio goes to zero, and the report offers the hose. With the
/// hose the ratio that was put in comes back out.
#[test]
fn a_critical_ratio_on_zero_offers_the_hose() {
    let folder = Folder::new("ends-hose");
    let rig = "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"three-way\"\n\
               sonic_conductance = \"0.6 L/(s*bar)\"\ncritical_ratio = 0.3\nopening_delay = \"2 ms\"\nclosing_delay = \"2 ms\"\n[command]\n\
               kind = \"pwm\"\nfrequency = \"1 Hz\"\nduty = 0.5\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[initial]\n\
               gauge_pressure = \"1 bar\"\n[run]\nduration = \"0.5 s\"\nsample_interval = \"1 ms\"\n";
    let study = STUDY.replace("columns.length", "columns.gauge_pressure").replace("length_m", "gauge_pressure_pa");
    let study = study.replace("unit = \"m\"", "unit = \"Pa\"");
    let fit = "[fit.\"valve.critical_ratio\"]\n[fit.\"valve.sonic_conductance\"]\nfrom = \"0.01 L/(s*bar)\"\nto = \"2 L/(s*bar)\"\n";
    let hose = "[hose]\nkind = \"lumped\"\nlength = \"0.3 m\"\ndiameter = \"0.5 mm\"\n";
    recorded(&folder, &format!("{rig}{hose}"));
    folder.file("rig.toml", rig);
    let printed = words(&identify(&folder, &format!("{study}{fit}")));
    assert!(printed.contains("valve.critical_ratio rests on its least value, 0:"), "{printed}");
    assert!(printed.contains("is that of a line, not of a valve") && printed.contains("by [hose]"), "{printed}");
    let wide = hose.replace("0.5 mm", "2.5 mm");
    recorded(&folder, &format!("{rig}{wide}"));
    folder.file("rig.toml", &format!("{rig}{wide}").replace("critical_ratio = 0.3", "critical_ratio = 0.5"));
    let output = identify(&folder, &format!("{study}{fit}"));
    assert!(output.status.success(), "{}", words(&output));
    let found: f64 = cell(&read(&folder, "out/values.csv"), "valve.critical_ratio", "value").parse().expect("a number");
    assert!((found - 0.3).abs() < 1e-3, "{}", words(&output));
}
