//! `mckibben identify` where something is wrong: what it reads is safe, what it has is written, and what failed is said in words.

use crate::common::{Folder, PULSES, of_repository};
use std::path::Path;
use std::process::Output;

/// Copies a study of the repository with its scenario and data into a folder.
fn copied(folder: &Folder, study: &str, others: &[&str]) {
    for name in others.iter().chain([&study]) {
        let text = std::fs::read_to_string(of_repository(name)).expect("a file");
        let name = Path::new(name).file_name().expect("a name").to_string_lossy().into_owned();
        folder.file(&name, &text);
    }
}

fn identify(folder: &Folder, study: &str, output: &str) -> Output {
    folder.mckibben().args(["identify", study, "--output", output]).output().expect("the program runs")
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// That no name or form of a library's or of Rust's own reaches the user.
fn in_words(text: &str) {
    for word in [
        "TRF",
        "panicked",
        "Termination",
        "NumericalFailure",
        "Converged(",
        "Failed(",
        "Some(",
        "RUST_BACKTRACE",
        "NaN",
    ] {
        assert!(!text.contains(word), "{word} is in {text}");
    }
}

#[cfg(unix)]
#[test]
fn what_is_read_is_not_written_over() {
    let folder = Folder::new("identify-inputs");
    copied(&folder, "examples/identify/tank.toml", &["examples/identify/rig.toml", "examples/identify/discharge.csv"]);
    let read = |name: &str| std::fs::read_to_string(folder.path(name)).expect("there");
    let study = read("tank.toml");
    // The figure of the first run, the scenario, and the numbers; each by another way to the folder.
    std::fs::create_dir(folder.path("sub")).expect("made");
    for (data, scenario, output) in [
        ("tank-1.csv", "rig.toml", "."),
        ("discharge.csv", "scenario.toml", "sub/.."),
        ("values.csv", "rig.toml", "."),
        ("measured-1.csv", "scenario-discharge.toml", "./sub/../"),
    ] {
        folder.file(data, &read("discharge.csv"));
        folder.file(scenario, &read("rig.toml"));
        folder.file("study.toml", &study.replace("discharge.csv", data).replace("rig.toml", scenario));
        let before: Vec<_> = folder.names().into_iter().map(|name| std::fs::read(folder.path(&name)).ok()).collect();
        let output = identify(&folder, "study.toml", output);
        assert_eq!(output.status.code(), Some(2), "{data}: {}", error(&output));
        let clash = if data == "discharge.csv" { scenario } else { data };
        assert!(error(&output).contains(clash) && error(&output).contains("another folder"), "{}", error(&output));
        let after: Vec<_> = folder.names().into_iter().map(|name| std::fs::read(folder.path(&name)).ok()).collect();
        assert_eq!(before, after);
        for name in [data, scenario].into_iter().filter(|name| !["discharge.csv", "rig.toml"].contains(name)) {
            std::fs::remove_file(folder.path(name)).expect("there");
        }
    }
    // By a link, too; and without a clash the folder of the study will do.
    std::os::unix::fs::symlink(folder.path("discharge.csv"), folder.path("flow-curve.csv")).expect("linked");
    folder.file("study.toml", &study.replace("discharge.csv", "flow-curve.csv"));
    assert_eq!(identify(&folder, "study.toml", ".").status.code(), Some(2));
    std::fs::remove_file(folder.path("flow-curve.csv")).expect("there");
    let output = identify(&folder, "tank.toml", ".");
    assert!(output.status.success(), "{}", error(&output));
}

/// A force map of an ideal braid in a bladder, 4 pressures and 5 lengths, with one cell in another's place.
fn map(cell: Option<(usize, usize, &str)>) -> String {
    let mut text = "P,L,F\n".to_owned();
    for row in 0..20 {
        let (bar, mm) = (1.0 + (row / 5) as f64, 300.0 - 12.0 * (row % 5) as f64);
        // b = 0.342 m and n = 2.6, and a bladder.
        let (length, thread, turns) = (1e-3 * mm, 0.342_f64, 2.6_f64);
        let ideal =
            1e5 * bar * (3.0 * length * length - thread * thread) / (4.0 * std::f64::consts::PI * turns * turns);
        let force = ideal - 60.0 * (1.0 - (-(300.0 - mm) / 20.0).exp());
        let mut cells = [bar.to_string(), mm.to_string(), format!("{force:.3}")];
        if let Some((_, column, value)) = cell.filter(|(of, ..)| *of == row) {
            cells[column] = value.to_owned();
        }
        text += &(cells.join(",") + "\n");
    }
    text
}

const MAP_STUDY: &str = "[study]\nkind = \"force-map\"\nscenario = \"muscle.toml\"\n[columns.gauge_pressure]\nname = \"P\"\nunit = \"bar\"\n\
     [columns.length]\nname = \"L\"\nunit = \"mm\"\n[columns.tension]\nname = \"F\"\nunit = \"N\"\nslack = \"0 N\"\n[[run]]\nfile = \"map.csv\"\n";
const MUSCLE: &str = "[actuator]\nthread_length = \"0.342 m\"\nturns = 2.6\nmax_length = \"301 mm\"\n\
     [load]\nkind = \"hanging-mass\"\nmass = \"5 kg\"\n[initial]\ngauge_pressure = \"3 bar\"\n[run]\nduration = \"1 s\"\n";

#[test]
fn one_bad_cell_of_a_force_map_is_named_or_harmless() {
    let folder = Folder::new("identify-cell");
    folder.file("muscle.toml", MUSCLE);
    folder.file("study.toml", MAP_STUDY);
    folder.file("map.csv", &map(None));
    let output = identify(&folder, "study.toml", "out");
    assert!(output.status.success(), "{}", error(&output));
    for (row, column, value, refused) in [
        (7, 2, "1e8", true),
        (7, 2, "-1e8", true),
        (19, 1, "1e3", false),
        (19, 1, "1e5", true),
        (3, 1, "1e-3", true),
        (3, 1, "0", true),
        (12, 0, "1e9", true),
        (7, 2, "9e3", false),
        (7, 2, "1e999", true),
        (7, 2, "-40", false),
        (12, 0, "-3", false),
        (0, 2, "0", false),
        (0, 2, "", false),
        (5, 1, "", false),
        (5, 2, "oops", true),
    ] {
        folder.file("map.csv", &map(Some((row, column, value))));
        let output = identify(&folder, "study.toml", "out");
        let text = error(&output) + &String::from_utf8_lossy(&output.stdout);
        in_words(&text);
        let code = output.status.code();
        assert!(if refused { code == Some(2) } else { matches!(code, Some(0 | 2 | 3)) }, "{value}: {code:?} {text}");
        if refused {
            assert!(text.contains(&format!("line {}", row + 2)), "{value}: {text}");
            assert!(text.contains(["P", "L", "F"][column]), "{value}: {text}");
        }
    }
    // A reading that may be, but is far from all others, is named.
    folder.file("map.csv", &map(Some((7, 2, "380"))));
    let output = identify(&folder, "study.toml", "out");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.contains("line 9 of the run map"), "{text}");
}

#[test]
fn a_study_that_fails_leaves_a_report_with_what_was_measured() {
    let folder = Folder::new("identify-nothing");
    folder.file("m.toml", "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[initial]\ngauge_pressure = \"60 psi\"\n[run]\nduration = \"0.1 s\"\n");
    // Two readings and two unknowns: no degree of freedom is left.
    folder.file("d.csv", "t,L\n0,0.09\n0.05,0.091\n");
    folder.file(
        "study.toml",
        "[study]\nkind = \"trajectories\"\nscenario = \"m.toml\"\n[columns.time]\nname = \"t\"\nunit = \"s\"\n[columns.length]\nname = \"L\"\nunit = \"m\"\n\
         [[run]]\nfile = \"d.csv\"\n[fit.\"load.mass\"]\n[fit.\"actuator.turns\"]\n",
    );
    let output = identify(&folder, "study.toml", "out");
    assert_eq!(output.status.code(), Some(3), "{}", error(&output));
    assert!(
        error(&output).contains("2 measurements") && error(&output).contains("out/index.html"),
        "{}",
        error(&output)
    );
    in_words(&error(&output));
    let read = |name: &str| std::fs::read_to_string(folder.path("out").join(name)).expect("there");
    let page = read("index.html");
    assert!(
        page.contains("Nothing was found") && page.contains("2 measurements") && page.contains("measured-1"),
        "{page}"
    );
    // The readings, in SI.
    assert!(read("measured-1.csv").contains("0.091"), "{}", read("measured-1.csv"));
    assert!(!folder.path("out/scenario.toml").exists() && !folder.path("out/values.csv").exists());
}

#[test]
fn of_several_runs_those_that_succeed_are_written() {
    let folder = Folder::new("identify-some");
    copied(
        &folder,
        "examples/identify/pulse-train.toml",
        &[
            "examples/identify/rig.toml",
            "examples/identify/pulses-10hz.csv",
            "examples/identify/pulses-20hz.csv",
            "examples/identify/pulses-40hz.csv",
        ],
    );
    let whole = identify(&folder, "pulse-train.toml", "whole");
    assert!(whole.status.success(), "{}", error(&whole));
    // The pressure of one run does not answer to its pulses.
    let data = std::fs::read_to_string(folder.path("pulses-20hz.csv")).expect("there");
    let flat: String = data.lines().enumerate().fold(String::new(), |text, (row, line)| {
        let time = line.split(',').next().expect("a cell");
        let line = if row == 0 { line.to_owned() } else { format!("{time},{}", 300.0 + 1e-3 * (row % 7) as f64) };
        text + &line + "\n"
    });
    folder.file("pulses-20hz.csv", &flat);
    let output = identify(&folder, "pulse-train.toml", "some");
    assert_eq!(output.status.code(), Some(3), "{}", error(&output));
    assert!(error(&output).contains("pulses-20hz") && error(&output).contains("some/index.html"), "{}", error(&output));
    in_words(&error(&output));
    let page = std::fs::read_to_string(folder.path("some/index.html")).expect("there");
    assert!(page.contains("failed: the run") && page.contains("pulses-10hz") && page.contains("pulses-40hz"), "{page}");
    assert!(folder.path("some/scenario.toml").exists() && folder.path("some/values.csv").exists());
}

/// Every file that a study has written is one of those that it was checked for: no input of such a name is lost.
#[test]
fn every_file_that_is_written_is_known_beforehand() {
    for (study, others) in [
        ("examples/identify/tank.toml", &["examples/identify/rig.toml", "examples/identify/discharge.csv"][..]),
        ("examples/identify/flow-curve.toml", &["examples/identify/rig.toml", "examples/identify/flow.csv"]),
        ("examples/identify/steady-flow.toml", &["examples/identify/rig.toml", "examples/identify/flow.csv"]),
    ] {
        let folder = Folder::new(&format!("identify-known-{}", study.len()));
        copied(&folder, study, others);
        let name = Path::new(study).file_name().expect("a name").to_string_lossy().into_owned();
        let output = identify(&folder, &name, "out");
        assert!(output.status.success(), "{}", error(&output));
        let text = std::fs::read_to_string(folder.path(&name)).expect("there");
        let data = Path::new(others[1]).file_name().expect("a name").to_string_lossy().into_owned();
        let written = std::fs::read_dir(folder.path("out")).expect("a folder");
        let tables = written.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
        let tables: Vec<String> = tables.filter(|name| name.ends_with(".csv")).collect();
        assert!(!tables.is_empty());
        for table in tables {
            // The data under the name of a file that is written.
            std::fs::copy(folder.path(&data), folder.path(&table)).expect("copied");
            folder.file("clash.toml", &text.replace(&data, &table));
            let output = identify(&folder, "clash.toml", ".");
            assert_eq!(output.status.code(), Some(2), "{study}, {table}: {}", error(&output));
        }
    }
}

/// What the program prints, without the breaks of its lines.
fn words(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &error(output);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

const TIME: &str = "[columns.time]\nname = \"time_s\"\nunit = \"s\"\n";

/// A folder with the readings of a run under pulses, and a study of it: with more keys of [study], its column of times, and one parameter.
fn pulsed(name: &str) -> (Folder, impl Fn(&str, &str, &str) -> String) {
    let folder = Folder::new(name);
    folder.file(
        "rig.toml",
        &format!("{PULSES}[actuator]\npreset = \"colbrunn-2001\"\n[initial]\ngauge_pressure = \"40 psi\"\n"),
    );
    let run = folder.mckibben().args(["simulate", "rig.toml", "--output", "run.csv"]).output().expect("it runs");
    assert!(run.status.success(), "{}", error(&run));
    let study = |input: &str, time: &str, path: &str| {
        format!(
            "[study]\nkind = \"trajectories\"\nscenario = \"rig.toml\"\n{input}{time}[columns.length]\nname = \"length_m\"\nunit = \"m\"\n\
             [columns.absolute_pressure]\nname = \"absolute_pressure_pa\"\nunit = \"Pa\"\n[[run]]\nfile = \"run.csv\"\n[fit.\"{path}\"]\n"
        )
    };
    (folder, study)
}

/// No page is named in place of what to do.
#[test]
fn what_a_study_lacks_is_said_with_what_to_do() {
    let (folder, study) = pulsed("identify-lacks");
    let driven = "input = \"gauge-pressure\"\n";
    let long = format!("{}[search]\nsegments = \"9 s\"\n", study("", TIME, "load.mass"));
    for (text, what, remedy) in [
        (study("", TIME, "initial.length"), "the run starts at the equilibrium", "at which the search starts"),
        (
            study(driven, TIME, "valve.flow_area"),
            "the run follows the measured pressure",
            "so that the valve drives the run",
        ),
        (study("", "", "load.mass"), "has no absolute pressure over time", "in the same table"),
        (long, "segments of 9 s do not divide a run", "give a duration above zero"),
    ] {
        folder.file("study.toml", &text);
        let output = identify(&folder, "study.toml", "out");
        let printed = words(&output);
        assert!(!output.status.success() && printed.contains(what), "{printed}");
        assert!(printed.contains(remedy) && !printed.contains("docs/identify.md"), "{printed}");
    }
}

#[test]
fn a_start_outside_the_bounds_is_said_to_be_moved() {
    let (folder, study) = pulsed("identify-moved");
    let search = "[search]\nmore_starts = 0\n";
    let with = |bounds: &str| {
        let text = study("", TIME, "actuator.friction.viscous");
        folder.file("study.toml", &format!("{text}{bounds}{search}"));
        words(&identify(&folder, "study.toml", "out"))
    };
    // The preset has 3.503 N·s/m.
    let moved = with("from = \"6 N*s/m\"\nto = \"50 N*s/m\"\n");
    assert!(moved.contains("the search starts at 6 N·s/m"), "{moved}");
    let kept = with("from = \"1 N*s/m\"\nto = \"50 N*s/m\"\n");
    assert!(!kept.contains("the search starts at"), "{kept}");
}
