//! Sensors of a study: what is wrong with readings is found with the parameters, for all runs, each session or each run.

use super::{cell, identify, printed, read};
use crate::common::Folder;

const SCENARIO: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"100 psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
    [command]\nkind = \"pwm\"\nfrequency = \"12 Hz\"\nduty = 0.45\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
    [initial]\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"0.4 s\"\nsample_interval = \"1 ms\"\n";

const STUDY: &str = "[study]\nkind = \"trajectories\"\nscenario = \"muscle.toml\"\n[columns.time]\nname = \"t\"\nunit = \"s\"\n\
    [columns.length]\nname = \"L\"\nunit = \"mm\"\n[columns.absolute_pressure]\nname = \"P\"\nunit = \"Pa\"\nshift = \"2 ms\"\n\
    [[run]]\nfile = \"a.csv\"\nsession = \"one\"\n[[run]]\nfile = \"b.csv\"\nsession = \"one\"\nset = { \"load.mass\" = \"7 lb\" }\n\
    [[run]]\nfile = \"c.csv\"\nsession = \"two\"\nset = { \"load.mass\" = \"8 lb\" }\n\
    [fit.\"actuator.friction.viscous\"]\nstart = \"5 N*s/m\"\nfrom = \"0.1 N*s/m\"\nto = \"50 N*s/m\"\n\
    [fit.\"columns.length.offset\"]\nper_session = true\n[fit.\"columns.absolute_pressure.scale\"]\n\
    [fit.\"columns.length.shift\"]\nprior = { mean = \"2 ms\", deviation = \"5 ms\" }\n";

/// Records runs of three masses, whose lengths are off by session and late, and whose pressures are scaled and late.
fn record(folder: &Folder) {
    folder.file("muscle.toml", SCENARIO);
    for (file, mass, offset) in [("a", "5 lb", 1.5), ("b", "7 lb", 1.5), ("c", "8 lb", -0.5)] {
        let set = format!("load.mass=\"{mass}\"");
        let simulate = ["simulate", "muscle.toml", "--set", &set, "--output", "clean.csv"];
        let output = folder.mckibben().args(simulate).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let mut reader = csv::Reader::from_path(folder.path("clean.csv")).expect("a table");
        let head: Vec<String> = reader.headers().expect("a head").iter().map(str::to_owned).collect();
        let place = |name: &str| head.iter().position(|column| column == name).expect("a column");
        let rows: Vec<Vec<f64>> = reader
            .records()
            .map(|row| row.expect("a row").iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
            .collect();
        let at = |row: usize, late: usize, name: &str| rows[row.saturating_sub(late)][place(name)];
        let mut table = "t,L,P\n".to_owned();
        for row in 0..rows.len() {
            let (length, pressure) = (at(row, 3, "length_m"), at(row, 2, "absolute_pressure_pa"));
            table += &format!("{},{},{}\n", at(row, 0, "time_s"), 1e3 * length + offset, 1.03 * pressure);
        }
        folder.file(&format!("{file}.csv"), &table);
    }
}

#[test]
fn sensors_are_estimated_with_the_parameters() {
    let folder = Folder::new("identify-sensors");
    record(&folder);
    let output = identify(&folder, &folder.file("study.toml", STUDY));
    let printed = printed(&output);
    let values = read(&folder, "out/values.csv");
    for (name, expected, within) in [
        ("actuator.friction.viscous", 3.502_536_705, 1e-3),
        ("columns.length.offset [one]", 1.5e-3, 1e-6),
        ("columns.length.offset [two]", -0.5e-3, 1e-6),
        ("columns.absolute_pressure.scale", 1.03, 1e-5),
        ("columns.length.shift", 3e-3, 1e-6),
    ] {
        let value = cell(&values, name, "value");
        assert!((value - expected).abs() < within, "{name}: {value} is not {expected}\n{printed}");
    }
    assert!(
        values.contains("columns.length.shift,") && printed.contains("columns.length.offset [two]"),
        "{values}\n{printed}"
    );
}

#[test]
fn sensors_that_are_none_are_refused_in_words() {
    let folder = Folder::new("identify-sensors-refused");
    record(&folder);
    for (from, to, words) in [
        ("columns.length.shift", "columns.length.shifts", "offset, drift, scale, shift, lag"),
        ("columns.length.shift", "columns.tension.shift", "name one of absolute_pressure, length"),
        ("session = \"two\"\n", "", "has no session"),
        ("shift = \"2 ms\"\n", "hold = \"0 s\"\n", "`hold` of a sensor"),
        ("shift = \"2 ms\"\n", "drift = \"1 mm/s\"\n", "is no absolute pressure per second"),
        ("per_session = true", "per_session = true\nper_run = true", "leave out `per_run` or `per_session`"),
        ("kind = \"trajectories\"", "kind = \"ring-down\"", "trajectories"),
    ] {
        let study = STUDY.replace(from, to);
        assert_ne!(study, STUDY, "{from}");
        let output = identify(&folder, &folder.file("study.toml", &study));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(words), "`{words}` is not in\n{error}");
    }
}
