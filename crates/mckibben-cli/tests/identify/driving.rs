//! The sensor of a pressure that drives a run: its offset, scale and shift are estimated with the rest.

use super::{cell, identify, printed, read};
use crate::common::Folder;

const SCENARIO: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
    [run]\nduration = \"1 s\"\nsample_interval = \"1 ms\"\n";

/// Steps with corners at whole milliseconds, so that readings each millisecond are the pressure.
const PRESSURE: &str = "[pressure]\ntime = [\"0.1 s\", \"0.12 s\", \"0.4 s\", \"0.43 s\", \"0.7 s\", \"0.71 s\"]\n\
    gauge_pressure = [\"30 psi\", \"70 psi\", \"70 psi\", \"40 psi\", \"40 psi\", \"55 psi\"]\n";

const STUDY: &str = "[study]\nkind = \"trajectories\"\nscenario = \"muscle.toml\"\ninput = \"gauge-pressure\"\n[search]\nmore_starts = 0\n\
    [columns.time]\nname = \"time_s\"\nunit = \"s\"\n[columns.length]\nname = \"length_m\"\nunit = \"m\"\n\
    [columns.gauge_pressure]\nname = \"gauge_pressure_pa\"\nunit = \"Pa\"\n[[run]]\nfile = \"run.csv\"\n\
    [fit.\"actuator.friction.viscous\"]\nstart = \"5 N*s/m\"\nfrom = \"0.1 N*s/m\"\nto = \"50 N*s/m\"\n";

/// Readings that come 4 ms late, 3 % too high, with a zero of 6 kPa.
fn shown(table: &str) -> String {
    const LATE: usize = 4;
    let lines: Vec<Vec<&str>> =
        table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect()).collect();
    let place = lines[0].iter().position(|name| *name == "gauge_pressure_pa").expect("a column");
    let pressure = |row: usize| lines[row][place].parse::<f64>().expect("a number");
    let mut text = format!("{}\n", lines[0].join(","));
    for row in 1..lines.len() {
        let reading = (1.03 * pressure(row.saturating_sub(LATE).max(1)) + 6e3).to_string();
        let mut cells = lines[row].clone();
        cells[place] = &reading;
        text.push_str(&format!("{}\n", cells.join(",")));
    }
    text
}

/// A rig whose pressure sensor is off; what the scenario says of the pressure is not known.
fn recorded(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.file("truth.toml", &format!("{SCENARIO}{PRESSURE}"));
    let simulate = ["simulate", "truth.toml", "--output", "run.csv"];
    let output = folder.mckibben().args(simulate).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.file("run.csv", &shown(&read(&folder, "run.csv")));
    folder.file("muscle.toml", &format!("{SCENARIO}[initial]\ngauge_pressure = \"30 psi\"\n"));
    folder
}

#[test]
fn offset_scale_and_shift_of_a_pressure_that_drives_are_estimated() {
    let folder = recorded("identify-driving");
    let of_sensor: String =
        ["offset", "scale", "shift"].map(|amount| format!("[fit.\"columns.gauge_pressure.{amount}\"]\n")).concat();
    let report = printed(&identify(&folder, &folder.file("study.toml", &format!("{STUDY}{of_sensor}"))));
    let values = read(&folder, "out/values.csv");
    for (name, expected, within) in [
        ("actuator.friction.viscous", 3.502_536_705, 2e-3),
        ("columns.gauge_pressure.offset", 6e3, 2e-2),
        ("columns.gauge_pressure.scale", 1.03, 1e-3),
        ("columns.gauge_pressure.shift", 4e-3, 1e-2),
    ] {
        let value = cell(&values, name, "value");
        assert!((value / expected - 1.0).abs() < within, "{name}: {value} is not {expected}\n{report}");
    }
    // The scenario that is written has the sensor, and gives the run that was recorded.
    let scenario = read(&folder, "out/scenario.toml");
    assert!(["offset = ", "scale = ", "shift = "].iter().all(|key| scenario.contains(key)), "{scenario}");
    let again =
        folder.mckibben().args(["simulate", "out/scenario.toml", "--output", "again.csv"]).output().expect("it runs");
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
}

/// What is known stands in the column: then nothing of the sensor is estimated.
#[test]
fn a_known_sensor_of_a_pressure_that_drives_is_taken_off() {
    let folder = recorded("identify-driving-known");
    let study = STUDY.replace("unit = \"Pa\"\n", "unit = \"Pa\"\nshift = \"4 ms\"\noffset = \"6 kPa\"\n");
    let study = format!("{study}[fit.\"columns.gauge_pressure.scale\"]\n");
    let report = printed(&identify(&folder, &folder.file("study.toml", &study)));
    let values = read(&folder, "out/values.csv");
    for (name, expected) in [("actuator.friction.viscous", 3.502_536_705), ("columns.gauge_pressure.scale", 1.03)] {
        let value = cell(&values, name, "value");
        assert!((value / expected - 1.0).abs() < 2e-3, "{name}: {value} is not {expected}\n{report}");
    }
}

#[test]
fn what_cannot_be_estimated_of_it_is_refused() {
    let folder = recorded("identify-driving-refused");
    let lagging = STUDY.replace("unit = \"Pa\"\n", "unit = \"Pa\"\nlag = \"5 ms\"\n");
    let absolute = STUDY
        .replace("columns.gauge_pressure]", "columns.absolute_pressure]")
        .replace("gauge_pressure_pa", "absolute_pressure_pa");
    for (study, words) in [
        (format!("{STUDY}[fit.\"columns.gauge_pressure.lag\"]\n"), "has an offset, a scale and a shift to estimate"),
        (lagging, "its sensor lags or holds"),
        (format!("{absolute}[fit.\"columns.absolute_pressure.scale\"]\n"), "and no scale"),
    ] {
        let output = identify(&folder, &folder.file("study.toml", &study));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(words), "{error}");
    }
}
