//! A pressure that was read at the valve's end of a hose drives a run through the hose.

use super::{cell, identify, printed, read};
use crate::common::Folder;

const SCENARIO: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"100 psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
    [hose]\nlength = \"1.5 m\"\ndiameter = \"2.5 mm\"\nkind = \"distributed\"\ncells = 4\n\
    [command]\nkind = \"pwm\"\nfrequency = \"10 Hz\"\nduty = 0.45\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
    [initial]\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"0.4 s\"\nsample_interval = \"0.2 ms\"\n";

const STUDY: &str = "[study]\nkind = \"trajectories\"\nscenario = \"muscle.toml\"\ninput = \"gauge-pressure\"\n\
    [columns.time]\nname = \"time_s\"\nunit = \"s\"\n[columns.length]\nname = \"length_m\"\nunit = \"m\"\n\
    [columns.hose_gauge_pressure]\nname = \"hose_gauge_pressure_pa\"\nunit = \"Pa\"\n\
    [columns.gauge_pressure]\nname = \"gauge_pressure_pa\"\nunit = \"Pa\"\n[[run]]\nfile = \"run.csv\"\n\
    [fit.\"actuator.friction.viscous\"]\nstart = \"5 N*s/m\"\nfrom = \"0.1 N*s/m\"\nto = \"50 N*s/m\"\n\
    [fit.\"hose.diameter\"]\nstart = \"3 mm\"\nfrom = \"1 mm\"\nto = \"6 mm\"\n";

/// A folder with a scenario, a record of it, and a study.
fn recorded(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.file("muscle.toml", SCENARIO);
    let simulate = ["simulate", "muscle.toml", "--output", "run.csv"];
    let output = folder.mckibben().args(simulate).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

#[test]
fn friction_and_hose_are_estimated_from_the_pressure_at_the_valve() {
    let folder = recorded("identify-hose");
    let output = identify(&folder, &folder.file("study.toml", STUDY));
    let report = printed(&output);
    let values = read(&folder, "out/values.csv");
    for (name, expected) in [("actuator.friction.viscous", 3.502_536_705), ("hose.diameter", 2.5e-3)] {
        let value = cell(&values, name, "value");
        assert!((value / expected - 1.0).abs() < 5e-3, "{name}: {value} is not {expected}\n{report}");
    }
    assert!(report.contains("the pressure at the end of the hose is the measured one"), "{report}");
}

/// The sensor at the valve shows 4 kPa too much. The muscle starts at what the scenario says, or at what the hose really had, and
/// not at the reading.
#[test]
fn the_offset_of_the_pressure_at_the_valve_is_found() {
    let folder = recorded("identify-hose-offset");
    let record = std::fs::read_to_string(folder.path("run.csv")).expect("a record");
    let place = record.lines().next().and_then(|head| head.split(',').position(|its| its == "hose_gauge_pressure_pa"));
    let place = place.expect("a pressure in the hose");
    let shifted = record.lines().enumerate().map(|(row, line)| {
        let cells = line.split(',').enumerate().map(|(column, cell)| match (row, column == place) {
            (1.., true) => (cell.parse::<f64>().expect("a number") + 4e3).to_string(),
            _ => cell.to_owned(),
        });
        cells.collect::<Vec<_>>().join(",") + "\n"
    });
    folder.file("run.csv", &shifted.collect::<String>());
    let study = STUDY.replace("[columns.gauge_pressure]\nname = \"gauge_pressure_pa\"\nunit = \"Pa\"\n", "").replace(
        "[fit.\"hose.diameter\"]\nstart = \"3 mm\"\nfrom = \"1 mm\"\nto = \"6 mm\"\n",
        "[fit.\"columns.hose_gauge_pressure.offset\"]\nstart = \"0 Pa\"\n",
    );
    let study = folder.file("study.toml", &study);
    for scenario in [SCENARIO.to_owned(), SCENARIO.replace("[initial]\ngauge_pressure = \"40 psi\"\n", "")] {
        folder.file("muscle.toml", &scenario);
        let report = printed(&identify(&folder, &study));
        let offset = cell(&read(&folder, "out/values.csv"), "columns.hose_gauge_pressure.offset", "value");
        assert!((offset - 4e3).abs() < 20.0, "{offset} Pa is not 4000 Pa\n{report}");
    }
}

#[test]
fn a_pressure_in_a_hose_needs_a_hose() {
    let folder = recorded("identify-hose-none");
    let without =
        SCENARIO.replace("[hose]\nlength = \"1.5 m\"\ndiameter = \"2.5 mm\"\nkind = \"distributed\"\ncells = 4\n", "");
    assert_ne!(without, SCENARIO);
    folder.file("muscle.toml", &without);
    let study = STUDY.replace("[fit.\"hose.diameter\"]\nstart = \"3 mm\"\nfrom = \"1 mm\"\nto = \"6 mm\"\n", "");
    let output = identify(&folder, &folder.file("study.toml", &study));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && error.contains("its scenario has no hose"), "{error}");
}
