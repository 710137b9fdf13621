//! `--units`: one choice for summaries, files and curves, and what is refused.

use crate::common::{Folder, PULSES, of_repository};
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

/// `--columns` takes the names of `--output` with the units that were chosen, also of those that a figure converts no further.
#[test]
fn columns_are_named_as_they_are_written() {
    let folder = Folder::new("units-columns");
    folder.file("muscle.toml", PULSES);
    let of = |units: &[&str], columns: &str| {
        output(
            &folder,
            &[&["simulate", "muscle.toml", "-q", "--plot", "it.svg", "--columns", columns][..], units].concat(),
        )
    };
    assert!(of(&["--units", "imperial"], "gauge_pressure_psi,volume_in3").status.success());
    assert!(of(&["--units", "pressure=psi"], "gauge_pressure_psi,volume_m3").status.success());
    assert!(of(&[], "gauge_pressure_pa,volume_m3").status.success());
    for (units, columns, words) in [
        (&["--units", "imperial"][..], "gauge_pressure_pa", "gauge_pressure_psi"),
        (&[], "gauge_pressure_psi", "gauge_pressure_pa"),
    ] {
        let refused = of(units, columns);
        let message = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && message.contains(words), "{message}");
    }
    let loops = ["simulate", "muscle.toml", "-q", "--plot", "loops.svg", "--over", "length", "--units", "imperial"];
    text(&folder, &loops);
    let drawn = std::fs::read_to_string(folder.path("loops.svg")).expect("a figure");
    assert!(drawn.contains("tension less secant"), "a figure of loops");
}

/// Columns of a plant, its volumes among them, and those of a sweep of it: 1 in = 25.4 mm.
#[test]
fn volumes_of_plants_and_of_their_sweeps_are_converted() {
    let folder = Folder::new("units-plant");
    let sweep = "[actuators.a]\n[sweep]\nreductions = [\"a.volume.final\"]\n[sweep.vary]\n\"load.mass\" = [\"5 lb\"]\n";
    folder.file("plant.toml", &format!("{PULSES}[actuators.a]\n"));
    folder.file("sweep.toml", &format!("{PULSES}{sweep}"));
    for units in [&[][..], &["--units", "imperial"]] {
        let name = if units.is_empty() { "si" } else { "own" };
        text(&folder, &[&["simulate", "plant.toml", "-o", &format!("{name}.csv")][..], units].concat());
        text(&folder, &[&["sweep", "sweep.toml", "-o", &format!("{name}-sweep.csv")][..], units].concat());
    }
    for (si, own) in [("a.volume_m3", "a.volume_in3"), ("a_volume_final_m3", "a_volume_final_in3")] {
        let kind = if si.contains("final") { "-sweep" } else { "" };
        let (si, own) =
            (column(&folder, &format!("si{kind}.csv"), si), column(&folder, &format!("own{kind}.csv"), own));
        assert!(!si.is_empty() && si.len() == own.len());
        assert!(si.iter().zip(&own).all(|(si, own)| (si - own * 0.0254_f64.powi(3)).abs() <= 1e-12 * si), "{own:?}");
    }
}

#[test]
fn an_angle_comes_in_degrees_unless_radians_are_requested() {
    let folder = Folder::new("angle");
    let joint = of_repository("examples/antagonistic-joint.toml");
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
fn a_file_to_start_from_has_the_units_that_are_chosen() {
    let folder = Folder::new("init-units");
    let of = |more: &[&str]| text(&folder, &[&["init", "-"][..], more].concat());
    let (paper, metric) = (of(&[]), of(&["--metric"]));
    assert!(paper.contains("\"100 psi\"") && !metric.contains("gauge_pressure = \"100 psi\""), "{metric}");
    assert_eq!(of(&["--units", "metric"]), metric);
    assert_eq!(of(&["--units", "si"]), metric);
    assert_eq!(of(&["--units", "imperial"]), paper);
}

#[test]
fn what_is_no_choice_is_refused_before_anything_runs() {
    let folder = Folder::new("refused");
    folder.file("muscle.toml", PULSES);
    for (units, part) in [
        ("furlong", "metric, si or imperial"),
        ("pressure=mm", "is no unit of pressure"),
        ("pressure=psi,pressure=bar", "`pressure` stands twice"),
    ] {
        let output = output(&folder, &["simulate", "muscle.toml", "--units", units]);
        assert_eq!(output.status.code(), Some(2));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains(part), "{error}");
    }
}

/// The numbers of a table on the terminal by the words of its head, which stand above them.
fn cells(text: &str, head: &str) -> Vec<f64> {
    let lines: Vec<&str> = text.lines().collect();
    let rule = lines.iter().position(|line| line.starts_with('─')).expect("a table");
    let end = lines[rule - 1].find(head).unwrap_or_else(|| panic!("{head}: {text}")) + head.len();
    let end = lines[rule - 1][..end].chars().count();
    let cell = |line: &&str| {
        let before: String = line.chars().take(end).collect();
        before.split_whitespace().next_back().and_then(|cell| cell.parse().ok())
    };
    lines[rule + 1..].iter().map_while(cell).collect()
}

/// Tables of sizes and the findings of the paper's report follow, with as many digits as before.
#[test]
fn tables_and_findings_have_the_units_that_are_chosen() {
    let folder = Folder::new("tables");
    let options = ["size", "--load", "5 kg", "--stroke", "30 mm", "--gauge-pressure", "4 bar"];
    let (plain, imperial) =
        (text(&folder, &options), text(&folder, &[&options[..], &["--units", "imperial"]].concat()));
    for (own, other, factor) in [
        ("length mm", "length in", 25.4),
        ("pressure bar", "pressure psi", 0.068_947_572_931_683_6),
        ("force at rest N", "force at rest lbf", 4.448_221_615_260_5),
        ("contraction %", "contraction %", 1.0),
    ] {
        let (before, after) = (cells(&plain, own), cells(&imperial, other));
        assert!(before.len() > 4 && before.len() == after.len(), "{own}: {before:?} {after:?}");
        for (before, after) in before.iter().zip(&after) {
            assert!((after * factor - before).abs() < 3e-3 * before.abs(), "{own}: {before}, {other}: {after}");
        }
    }
    text(&folder, &["reproduce", "--output", "si", "--units", "si"]);
    let findings = std::fs::read_to_string(folder.path("si/numbers.csv")).expect("findings");
    let mut reader = csv::Reader::from_reader(findings.as_bytes());
    let place = reader.headers().expect("a head").iter().position(|head| head == "unit").expect("a column");
    let units: Vec<String> = reader.records().map(|row| row.expect("a row")[place].to_owned()).collect();
    assert!(units.iter().any(|unit| unit == "kPa") && units.iter().any(|unit| unit.ends_with('m')), "{units:?}");
    assert!(!units.iter().any(|unit| ["psi", "in", "lbf", "lb"].contains(&unit.as_str())), "{units:?}");
}

/// A value that the file gives in a unit comes back in it, not a rounding beside it.
#[test]
fn values_of_the_file_come_back_in_their_unit() {
    let folder = Folder::new("units-back");
    let sweep = "[sweep]\ndesign = \"grid\"\nrecord = \"reductions\"\nreductions = [\"length.final\"]\n[sweep.vary]\n\
                 \"load.mass\" = [\"3 lb\", \"7 lb\"]\n";
    folder.file("sweep.toml", &format!("{PULSES}{sweep}"));
    text(&folder, &["sweep", "sweep.toml", "-o", "runs.csv", "--units", "imperial"]);
    assert_eq!(column(&folder, "runs.csv", "load_mass_lb"), [3.0, 7.0]);
}

/// The summary keeps a blank between a name and a value that fill their columns.
#[test]
fn columns_of_the_summary_do_not_touch() {
    let folder = Folder::new("units-gap");
    let file = of_repository("examples/fill-hold-exhaust.toml");
    let printed = text(&folder, &["simulate", file.to_str().expect("a path")]);
    let line = printed.lines().find(|line| line.trim_start().starts_with("gauge pressure")).expect("a pressure");
    assert!(line.trim_start().starts_with("gauge pressure "), "{line}");
}

/// Matrices on the terminal in other units are a similar system: the rate of the length for the velocity is 1, and stiffnesses go by
/// 1 lbf/in = 175.126 835 N/m.
#[test]
fn matrices_have_the_units_that_are_chosen() {
    let folder = Folder::new("units-linear");
    let file = of_repository("examples/linearize-pwm.toml");
    let entries = |units: &str| -> Vec<(String, Vec<f64>)> {
        let printed = text(&folder, &["linearize", file.to_str().expect("a path"), "--units", units]);
        let lines = printed.lines().filter(|line| line.starts_with("dL/dt") || line.starts_with("F "));
        let row = |line: &str| {
            let numbers = line.split_whitespace().filter_map(|word| word.replace('−', "-").parse().ok());
            (line.split_whitespace().next().expect("a name").to_owned(), numbers.collect())
        };
        lines.map(row).collect()
    };
    let (si, imperial) = (entries("si"), entries("imperial"));
    assert!(si.len() >= 2 && si.len() == imperial.len(), "{si:?} {imperial:?}");
    assert!(si[0].1.contains(&1.0) && imperial[0].1.contains(&1.0), "{imperial:?}");
    let (si, imperial) = (si[1].1[0], imperial[1].1[0]);
    assert!((si / 175.126_835 - imperial).abs() < 2e-4 * imperial.abs(), "{si} N/m, {imperial} lbf/in");
}
