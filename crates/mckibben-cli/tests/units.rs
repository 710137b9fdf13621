//! `--units`: one choice for summaries, files and curves, and what is refused.

mod common;

use common::{Folder, PULSES};
use std::process::Output;

fn output(folder: &Folder, arguments: &[&str]) -> Output {
    folder.mckibben().args(arguments).output().expect("the program runs")
}

fn text(folder: &Folder, arguments: &[&str]) -> String {
    let output = output(folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The head and the numbers of a column of a CSV file.
fn column(folder: &Folder, file: &str, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(folder.path(file)).expect("a CSV file");
    let place = reader.headers().expect("a header").iter().position(|head| head == name);
    let place = place.unwrap_or_else(|| panic!("no {name} in {:?}", reader.headers()));
    reader.records().map(|record| record.expect("a row")[place].parse().expect("a number")).collect()
}

#[test]
fn summary_and_file_have_the_units_that_are_chosen() {
    let folder = Folder::new("units");
    folder.file("muscle.toml", PULSES);
    let metric = text(&folder, &["simulate", "muscle.toml", "-o", "si.csv"]);
    assert!(metric.contains(" bar") && metric.contains(" mm") && !metric.contains("psi"), "{metric}");
    let imperial = text(&folder, &["simulate", "muscle.toml", "-o", "own.csv", "--units", "imperial"]);
    for unit in [" psi", " in ", " lbf", " lb)"] {
        assert!(imperial.contains(unit.trim_end_matches(')')), "{unit}: {imperial}");
    }
    assert!(![" bar", " mm", " N ", " kg"].iter().any(|unit| imperial.contains(unit)), "{imperial}");
    // Files without a choice are in SI, and hold the same numbers.
    for (si, own, factor) in [
        ("length_m", "length_in", 0.0254),
        ("gauge_pressure_pa", "gauge_pressure_psi", 6_894.757_293_168_361),
        ("tension_n", "tension_lbf", 4.448_221_615_260_5),
        ("time_s", "time_s", 1.0),
    ] {
        for (si, own) in column(&folder, "si.csv", si).into_iter().zip(column(&folder, "own.csv", own)) {
            assert!((si - own * factor).abs() <= 1e-12 * si.abs(), "{own}: {si}");
        }
    }
    let kelvin = column(&folder, "si.csv", "temperature_k")[0];
    let fahrenheit = column(&folder, "own.csv", "temperature_degf")[0];
    assert!((kelvin - (fahrenheit + 459.67) / 1.8).abs() < 1e-9, "{fahrenheit}");
}

#[test]
fn an_angle_comes_in_degrees_unless_radians_are_asked_for() {
    let folder = Folder::new("angle");
    let joint = common::of_repository("examples/antagonistic-joint.toml");
    let file = joint.to_str().expect("a path");
    let short = ["--set", "run.duration=0.2 s"];
    let line = |units: &[&str]| {
        let text = text(&folder, &[&["simulate", file][..], &short[..], units].concat());
        text.lines().find(|line| line.trim_start().starts_with("angle")).expect("an angle").to_owned()
    };
    assert!(line(&[]).contains('°'), "{}", line(&[]));
    assert!(line(&["--units", "si"]).contains("rad") && !line(&["--units", "angle=rad"]).contains('°'));
}

#[test]
fn what_is_no_choice_is_refused_before_anything_runs() {
    let folder = Folder::new("refused");
    folder.file("muscle.toml", PULSES);
    for (units, part) in [("furlong", "metric, si or imperial"), ("pressure=mm", "is no unit of pressure")] {
        let output = output(&folder, &["simulate", "muscle.toml", "--units", units]);
        assert_eq!(output.status.code(), Some(2));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains(part), "{error}");
    }
}
