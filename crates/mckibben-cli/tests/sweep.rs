//! `mckibben sweep`: every run against `mckibben simulate` of its row, and the files whatever happens on the way.

use crate::common::{Folder, of_repository};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

const BASE: &str = r#"[actuator]
preset = "colbrunn-2001"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[load]
kind = "hanging-mass"
mass = "5 lb"
[run]
duration = "0.12 s"
step = "0.1 ms"
"#;

const GRID: &str = r#"
[sweep]
reductions = [
    "length.final", "length.mean", "length.min", "length.max", "length.ripple", "length.settling_time",
    "length.overshoot", "absolute_pressure.max", "tension.peak", "velocity.peak", "air.used",
]
part_rows = 5
[sweep.vary]
"load.mass" = ["3 lb", "5 lb", "15 lb"]
"supply.gauge_pressure" = ["20 psi", "60 psi", "80 psi", "100 psi"]
"#;

fn run(folder: &Folder, arguments: &[&str]) -> String {
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The program must fail with a code; what it says.
fn fails(folder: &Folder, arguments: &[&str], code: i32) -> String {
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    message
}

/// The lines of a CSV file by column.
fn csv_lines(path: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).expect("a CSV file");
    let header: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let line = |record: csv::StringRecord| header.iter().cloned().zip(record.iter().map(str::to_owned)).collect();
    reader.records().map(|record| line(record.expect("a line"))).collect()
}

fn number(line: &BTreeMap<String, String>, column: &str) -> f64 {
    line[column].parse().unwrap_or_else(|_| panic!("{column} is `{}`", line[column]))
}

/// The lines of Parquet files by column, as the CSV writes them.
fn parquet_lines(paths: &[std::path::PathBuf]) -> Vec<BTreeMap<String, String>> {
    let mut lines = Vec::new();
    for path in paths {
        let reader = SerializedFileReader::new(std::fs::File::open(path).expect("there")).expect("a Parquet file");
        for row in reader.get_row_iter(None).expect("rows") {
            let row = row.expect("a row");
            let cells = row.get_column_iter().map(|(name, field)| {
                let text = match field {
                    Field::Null => String::new(),
                    Field::ULong(count) => count.to_string(),
                    Field::Double(number) => format!("{number:?}"),
                    Field::Str(text) => text.clone(),
                    other => panic!("{name} is {other:?}"),
                };
                (name.clone(), text)
            });
            lines.push(cells.collect());
        }
    }
    lines
}

/// All files of a folder with their bytes, hidden ones too.
fn bytes(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), std::fs::read(entry.path()).expect("read")))
        .collect()
}

fn parts(folder: &Path) -> Vec<std::path::PathBuf> {
    let names = bytes(folder).into_keys().filter(|name| name.ends_with(".parquet"));
    names.map(|name| folder.join(name)).collect()
}

#[test]
fn reductions_are_those_of_the_samples_that_simulate_writes() {
    let folder = Folder::new("sweep-reductions");
    let file = folder.file("muscle.toml", &format!("{BASE}{GRID}"));
    let file = file.to_string_lossy();
    for engine in ["fixed-step", "event-located"] {
        run(&folder, &["sweep", &file, "-o", "sweep.csv", "--engine", engine]);
        let lines = csv_lines(&folder.path("sweep.csv"));
        assert_eq!(lines.len(), 12);
        // One row of each mass.
        for (row, mass, pressure) in [(1, "3 lb", "60 psi"), (7, "5 lb", "100 psi"), (8, "15 lb", "20 psi")] {
            let line = &lines[row];
            assert_eq!((line["run"].as_str(), line["error"].as_str()), (row.to_string().as_str(), ""));
            let set = [format!("load.mass={mass}"), format!("supply.gauge_pressure={pressure}")];
            let engine_set = format!("run.engine={engine}");
            run(&folder, &["simulate", &file, "-o", "run.csv", "-s", &set[0], "-s", &set[1], "-s", &engine_set]);
            let samples = csv_lines(&folder.path("run.csv"));
            let column = |name: &str| samples.iter().map(|sample| number(sample, name)).collect::<Vec<f64>>();
            let (time, length) = (column("time_s"), column("length_m"));
            let greatest = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
            let peak = |name: &str| column(name).iter().fold(0.0, |peak: f64, value| peak.max(value.abs()));
            let (first, last) = (length[0], length[length.len() - 1]);
            for (name, value) in [
                ("length_final_m", last),
                ("length_min_m", least(&length)),
                ("length_max_m", greatest(&length)),
                ("absolute_pressure_max_pa", greatest(&column("absolute_pressure_pa"))),
                ("tension_peak_n", peak("tension_n")),
                ("velocity_peak_m_s", peak("velocity_m_s")),
            ] {
                assert_eq!(number(line, name), value, "{name} of row {row} by {engine}");
            }
            let mut integral = 0.0;
            for i in 1..time.len() {
                integral += (time[i] - time[i - 1]) * (length[i] + length[i - 1]) / 2.0;
            }
            assert!((number(line, "length_mean_m") - integral / 0.12).abs() < 1e-12);
            // The last period of 25 Hz is that from 0.08 s on, in samples of 1 ms.
            let period = &length[80..];
            let ripple = greatest(period) - least(period);
            assert_eq!(number(line, "length_ripple_m"), ripple, "ripple of row {row} by {engine}");
            let change = last - first;
            let settled =
                (0..time.len()).find(|from| length[*from..].iter().all(|l| (l - last).abs() <= 0.02 * change.abs()));
            assert_eq!(number(line, "length_settling_time_s"), time[settled.expect("the end is settled")]);
            let beyond = length.iter().map(|l| (l - last) * change.signum()).fold(f64::NEG_INFINITY, f64::max);
            let overshoot = number(line, "length_overshoot");
            assert!((overshoot - beyond / change.abs()).abs() < 1e-9 * overshoot.max(1.0), "{overshoot}");
        }
    }
}

#[test]
fn the_engines_agree_within_the_error_of_the_fixed_step() {
    let folder = Folder::new("sweep-engines");
    folder.file("muscle.toml", &format!("{BASE}{GRID}"));
    let of = |engine: &str, step: &str| {
        run(&folder, &["sweep", "muscle.toml", "-o", "sweep.csv", "--engine", engine, "-s", step]);
        csv_lines(&folder.path("sweep.csv"))
    };
    let exact = of("event-located", "run.step=0.1 ms");
    let [coarse, fine] = ["run.step=0.1 ms", "run.step=0.025 ms"].map(|step| of("fixed-step", step));
    let error = |lines: &[BTreeMap<String, String>], name: &str| {
        let relative = |(line, exact)| (number(line, name) / number(exact, name) - 1.0).abs();
        lines.iter().zip(&exact).map(relative).fold(0.0, f64::max)
    };
    // The method has order 2: a quarter of the step leaves a sixteenth of the error, and both runs together
    // extrapolate to a step of zero. With an error a h² + b h³, whose second term is no larger than the whole, that is b h³/20.
    let extrapolated = |name: &str| {
        let row = |((coarse, fine), exact)| {
            let [coarse, fine, exact] = [coarse, fine, exact].map(|line| number(line, name));
            ((16.0 * fine - coarse) / (15.0 * exact) - 1.0).abs()
        };
        coarse.iter().zip(&fine).zip(&exact).map(row).fold(0.0, f64::max)
    };
    for (name, allowed) in [("length_final_m", 2e-2), ("length_mean_m", 1e-3)] {
        let left = extrapolated(name);
        let (coarse, fine) = (error(&coarse, name), error(&fine, name));
        assert!(coarse < allowed && fine < coarse / 8.0, "{name}: {coarse:e} at 0.1 ms, {fine:e} at 0.025 ms");
        assert!(left < coarse / 20.0, "{name}: {left:e} extrapolated, {coarse:e} at 0.1 ms");
    }
    // An extreme between two samples is not seen. A flow near equal pressures errs by the root of their difference.
    for (name, allowed) in [("absolute_pressure_max_pa", 1e-4), ("air_used_kg", 1e-2)] {
        assert!(error(&coarse, name) < allowed, "{name}: {:e}", error(&coarse, name));
    }
    let [coarse, fine] = [&coarse, &fine].map(|lines| error(lines, "air_used_kg"));
    assert!(fine < coarse / 3.0, "{coarse:e} at 0.1 ms, {fine:e} at 0.025 ms");
}

#[test]
fn threads_shards_and_formats_change_nothing() {
    let folder = Folder::new("sweep-same");
    folder.file("muscle.toml", &format!("{BASE}{GRID}"));
    run(&folder, &["sweep", "muscle.toml", "-o", "one", "--jobs", "1"]);
    let whole = bytes(&folder.path("one"));
    let names: Vec<&str> = whole.keys().map(String::as_str).collect();
    assert_eq!(names, ["part-00000.parquet", "part-00001.parquet", "part-00002.parquet", "sweep.json"]);
    for jobs in ["2", "5"] {
        run(&folder, &["sweep", "muscle.toml", "-o", jobs, "--jobs", jobs]);
        assert_eq!(bytes(&folder.path(jobs)), whole, "{jobs} jobs");
    }
    for shard in ["2/2", "1/2"] {
        run(&folder, &["sweep", "muscle.toml", "-o", "shards", "--shard", shard]);
    }
    assert_eq!(bytes(&folder.path("shards")), whole);
    // More shards than parts: the last has nothing to do.
    run(&folder, &["sweep", "muscle.toml", "-o", "empty", "--shard", "7/7"]);
    assert_eq!(folder.path("empty").read_dir().expect("made").count(), 1);

    run(&folder, &["sweep", "muscle.toml", "-o", "all.csv"]);
    run(&folder, &["sweep", "muscle.toml", "-o", "all.parquet"]);
    let lines = csv_lines(&folder.path("all.csv"));
    assert_eq!(lines, parquet_lines(&parts(&folder.path("one"))));
    assert_eq!(lines, parquet_lines(&[folder.path("all.parquet")]));
    let masses: Vec<f64> = lines.iter().map(|line| number(line, "load_mass_kg")).collect();
    assert_eq!((masses[0], masses[4], masses[11]), (1.360_777_11, 2.267_961_85, 6.803_885_55));
}

#[test]
fn a_part_says_what_it_is() {
    let folder = Folder::new("sweep-metadata");
    let text = format!("{BASE}{GRID}");
    folder.file("muscle.toml", &text);
    run(&folder, &["sweep", "muscle.toml", "-o", "out", "--set", "command.duty=0.4"]);
    let file = std::fs::File::open(folder.path("out/part-00001.parquet")).expect("written");
    let reader = SerializedFileReader::new(file).expect("a Parquet file");
    let metadata = reader.metadata().file_metadata();
    let pairs = metadata.key_value_metadata().expect("metadata");
    let value = |key: &str| pairs.iter().find(|pair| pair.key == key).and_then(|pair| pair.value.clone()).expect(key);
    assert_eq!(value("mckibben.version"), env!("CARGO_PKG_VERSION"));
    assert_eq!(value("mckibben.scenario"), text);
    assert_eq!(value("mckibben.scenario_file"), "muscle.toml");
    assert_eq!(value("mckibben.set"), r#"["command.duty=0.4","run.engine=fixed-step"]"#);
    assert_eq!((value("mckibben.part"), value("mckibben.rows")), ("1".to_owned(), "5..10".to_owned()));
    assert_eq!(value("mckibben.failed"), "0");
    let units: serde_json::Value = serde_json::from_str(&value("mckibben.units")).expect("JSON");
    assert_eq!((&units["load_mass_kg"], &units["tension_peak_n"]), (&"kg".into(), &"N".into()));
    assert_eq!(metadata.num_rows(), 5);
}

/// A sweep that takes some seconds, in many parts.
fn long() -> String {
    let masses: Vec<String> = (0..60).map(|i| format!("\"{} lb\"", 3.0 + 0.2 * f64::from(i))).collect();
    format!(
        "{}\n[sweep]\nreductions = [\"length.final\", \"air.used\"]\npart_rows = 8\n[sweep.vary]\n\"load.mass\" = [{}]\n\"supply.gauge_pressure\" = [\"60 psi\", \"80 psi\"]\n",
        BASE.replace("0.12 s", "0.6 s"),
        masses.join(", ")
    )
}

#[test]
fn a_killed_sweep_goes_on_and_ends_with_the_same_bytes() {
    let folder = Folder::new("sweep-killed");
    folder.file("muscle.toml", &long());
    run(&folder, &["sweep", "muscle.toml", "-o", "whole"]);
    let whole = bytes(&folder.path("whole"));
    assert_eq!(whole.len(), 16);
    let finished = || {
        folder.path("killed").read_dir().map_or(0, |entries| {
            entries
                .filter(|entry| entry.as_ref().is_ok_and(|e| e.file_name().to_string_lossy().starts_with("part-")))
                .count()
        })
    };
    // Killed whenever another three parts are there, and at once.
    for wanted in [0, 3, 6, 9] {
        loop {
            let mut process = Command::new(env!("CARGO_BIN_EXE_mckibben"))
                .current_dir(folder.path(""))
                .args(["sweep", "muscle.toml", "-o", "killed"])
                .stdout(Stdio::null())
                .spawn()
                .expect("the program runs");
            while finished() < wanted && process.try_wait().expect("asked").is_none() {
                std::thread::sleep(Duration::from_millis(1));
            }
            // On Unix this is SIGKILL, which no program sees coming.
            process.kill().expect("killed");
            let status = process.wait().expect("ended");
            // Killed at once, it may not have made its folder.
            std::fs::create_dir_all(folder.path("killed")).expect("made");
            for (name, content) in bytes(&folder.path("killed")) {
                // What has its name is whole; what is hidden is under way.
                assert!(name.starts_with('.') || whole[&name] == content, "{name}");
            }
            if !status.success() {
                break;
            }
            // It ended before this test was given a turn: what it did is taken away, and it is killed another time.
            for part in wanted..15 {
                let _ = std::fs::remove_file(folder.path(&format!("killed/part-{part:05}.parquet")));
            }
        }
    }
    let before = finished();
    let printed = run(&folder, &["sweep", "muscle.toml", "-o", "killed"]);
    assert!(printed.contains(&format!("{} runs of parts that were finished before", 8 * before)), "{printed}");
    assert_eq!(bytes(&folder.path("killed")), whole);

    // Parts that are lost are done again, and those that are there are not touched.
    let kept = folder.path("killed/part-00003.parquet").metadata().expect("there").modified().expect("a time");
    for part in ["00000", "00007", "00014"] {
        std::fs::remove_file(folder.path(&format!("killed/part-{part}.parquet"))).expect("there");
    }
    let printed = run(&folder, &["sweep", "muscle.toml", "-o", "killed"]);
    assert!(printed.contains("wrote killed, 3 parts"), "{printed}");
    assert_eq!(bytes(&folder.path("killed")), whole);
    assert_eq!(folder.path("killed/part-00003.parquet").metadata().expect("there").modified().expect("a time"), kept);
    // A finished sweep has nothing to do, prints the same, and draws.
    let again = run(&folder, &["sweep", "muscle.toml", "-o", "killed", "-p", "all.svg"]);
    let table =
        |text: &str| text.split("Reductions").nth(1).and_then(|rest| rest.split("\n\n").next()).map(str::to_owned);
    assert_eq!(table(&again), table(&printed));
    let fresh = run(&folder, &["sweep", "muscle.toml", "-p", "fresh.svg"]);
    assert_eq!(table(&fresh), table(&printed));
    let read = |name: &str| std::fs::read(folder.path(name)).expect("drawn");
    assert_eq!(read("all.svg"), read("fresh.svg"));
}

#[test]
fn a_folder_of_another_sweep_is_refused() {
    let folder = Folder::new("sweep-other");
    folder.file("muscle.toml", &format!("{BASE}{GRID}"));
    run(&folder, &["sweep", "muscle.toml", "-o", "out"]);
    let before = bytes(&folder.path("out"));
    for set in ["load.gravity=9.8 m/s^2", "sweep.part_rows=6", "run.step=0.2 ms", "run.engine=event-located"] {
        let message = fails(&folder, &["sweep", "muscle.toml", "-o", "out", "--set", set], 2);
        assert!(message.contains("`out` holds another sweep") && message.contains("a folder of its own"), "{message}");
        assert_eq!(bytes(&folder.path("out")), before);
    }
    // A folder with other files is no place for parts.
    std::fs::create_dir(folder.path("thesis")).expect("made");
    folder.file("thesis/chapter.tex", "words");
    let message = fails(&folder, &["sweep", "muscle.toml", "-o", "thesis"], 2);
    assert!(message.contains("`thesis`") && message.contains("`chapter.tex`"), "{message}");
    assert_eq!(bytes(&folder.path("thesis")).len(), 1);
    // Nor is a damaged part taken for a good one.
    std::fs::write(folder.path("out/part-00001.parquet"), &before["part-00001.parquet"][..100]).expect("written");
    let message = fails(&folder, &["sweep", "muscle.toml", "-o", "out"], 2);
    assert!(message.contains("part-00001.parquet") && message.contains("delete it"), "{message}");
    std::fs::copy(folder.path("out/part-00000.parquet"), folder.path("out/part-00001.parquet")).expect("copied");
    fails(&folder, &["sweep", "muscle.toml", "-o", "out"], 2);
}

#[test]
fn a_run_that_fails_has_a_reason_and_no_numbers() {
    let folder = Folder::new("sweep-failed");
    // The thread is shorter than the muscle in every other row.
    let failing = r#"
[sweep]
reductions = ["length.final", "tension.peak"]
part_rows = 4
[sweep.vary]
"load.mass" = ["3 lb", "5 lb"]
"actuator.thread_length" = ["4.3218 in", "3 in", "4.4 in", "2 in"]
"#;
    folder.file("muscle.toml", &format!("{BASE}{failing}"));
    let printed = run(&folder, &["sweep", "muscle.toml", "-o", "out"]);
    assert!(printed.contains("4 of 8 runs failed") && printed.contains("run 1: "), "{printed}");
    let lines = parquet_lines(&parts(&folder.path("out")));
    for (row, line) in lines.iter().enumerate() {
        let failed = row % 2 == 1;
        assert_eq!(line["error"].is_empty(), !failed, "{line:?}");
        assert_eq!(line["length_final_m"].is_empty(), failed);
        assert_eq!(line["tension_peak_n"].is_empty(), failed);
        assert!(!failed || line["error"].contains("thread"), "{line:?}");
        assert!(number(line, "load_mass_kg") > 1.0 && number(line, "actuator_thread_length_m") > 0.05);
    }
    // The neighbours are those of a sweep without the faulty rows.
    folder.file("good.toml", &format!("{BASE}{}", failing.replace("\"3 in\", ", "").replace(", \"2 in\"", "")));
    run(&folder, &["sweep", "good.toml", "-o", "good.csv"]);
    let good: Vec<String> =
        csv_lines(&folder.path("good.csv")).iter().map(|line| line["length_final_m"].clone()).collect();
    let seen: Vec<String> = lines.iter().step_by(2).map(|line| line["length_final_m"].clone()).collect();
    assert_eq!(seen, good);
    // The parts know how many of their runs failed, so a finished sweep reports it too.
    let again = run(&folder, &["sweep", "muscle.toml", "-o", "out"]);
    assert!(again.contains("4 of 8 runs failed"), "{again}");
    // With nothing but failures there is no result.
    folder.file("bad.toml", &format!("{BASE}{}", failing.replace("4.3218", "2.2").replace("4.4", "2.3")));
    let message = fails(&folder, &["sweep", "bad.toml", "-o", "bad.csv"], 3);
    assert!(message.contains("every run failed"), "{message}");
    assert_eq!(csv_lines(&folder.path("bad.csv")).len(), 8);
}

#[test]
fn a_run_with_a_non_physical_state_stops_and_the_others_go_on() {
    let folder = Folder::new("sweep-stopped");
    // Through 20 cm² the actuator fills within microseconds: an explicit method with steps of 0.1 ms passes the supply
    // pressure a thousandfold, and empties the actuator below a vacuum in the next stage.
    let wide = |last: &str| {
        format!(
            "{BASE}method = \"rk4\"\n[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n\
             \"supply.gauge_pressure\" = [\"60 psi\", \"80 psi\"]\n\
             \"valve.flow_area\" = [\"1.5 mm^2\", \"2 mm^2\"{last}]\n"
        )
    };
    folder.file("wide.toml", &wide(", \"20 cm^2\""));
    let printed = run(&folder, &["sweep", "wide.toml", "-o", "wide.csv"]);
    assert!(
        printed.contains("2 of 6 runs failed") && printed.contains("run 2: the simulation stopped at t = "),
        "{printed}"
    );
    let lines = csv_lines(&folder.path("wide.csv"));
    for line in &lines {
        let failed = number(line, "valve_flow_area_m2") > 1e-4;
        assert_eq!(line["error"].contains("left the physics"), failed, "{line:?}");
        assert_eq!(line["length_final_m"].is_empty(), failed, "{line:?}");
    }
    // The other rows of the batch end as they do without the failed ones.
    folder.file("mild.toml", &wide(""));
    run(&folder, &["sweep", "mild.toml", "-o", "mild.csv"]);
    let final_of = |line: &BTreeMap<String, String>| line["length_final_m"].clone();
    let good: Vec<String> = lines.iter().filter(|line| line["error"].is_empty()).map(final_of).collect();
    assert_eq!(good, csv_lines(&folder.path("mild.csv")).iter().map(final_of).collect::<Vec<_>>());
}

#[test]
fn check_reads_the_sweep_too() {
    let folder = Folder::new("sweep-check");
    folder.file("muscle.toml", &format!("{BASE}{GRID}"));
    let printed = run(&folder, &["check", "muscle.toml"]);
    assert!(printed.contains("sweep of 12 runs over load.mass, supply.gauge_pressure (grid)"), "{printed}");
    // What the sweep gives need not stand outside it.
    folder.file("muscle.toml", &format!("{}{GRID}", BASE.replace("mass = \"5 lb\"\n", "")));
    let printed = run(&folder, &["check", "muscle.toml"]);
    assert!(printed.contains("sweep of 12 runs"), "{printed}");
    // Mistakes within the section and outside it are reported together, each once.
    let wrong = GRID.replace("\"15 lb\"", "\"15 lbf\"").replace("length.ripple", "length.riple");
    folder.file("muscle.toml", &format!("{}{wrong}", BASE.replace("\"100 psi\"", "\"100 N\"")));
    let message = fails(&folder, &["check", "muscle.toml"], 2);
    assert!(message.contains("15 lbf") && message.contains("length.riple") && message.contains("100 N"), "{message}");
    assert!(message.contains("3 mistakes"), "{message}");
    // A mistake of the scenario that it has with and without the sweep's values counts once.
    folder.file("muscle.toml", &format!("{}{GRID}", BASE.replace("duty = 0.5", "duty = 1.5")));
    let message = fails(&folder, &["check", "muscle.toml"], 2);
    assert!(message.contains("duty") && message.contains("one mistake"), "{message}");
    // So is what a word of the sweep contradicts, which no single scenario of the file shows.
    let words = "[sweep]\n[sweep.vary]\n\"load.kind\" = [\"hanging-mass\", \"isometric\"]\n";
    folder.file("muscle.toml", &format!("{BASE}{words}"));
    let message = fails(&folder, &["check", "muscle.toml"], 2);
    assert!(message.contains("so it is in the rows with `load.kind = \"isometric\"`"), "{message}");
}

#[test]
fn the_tail_of_a_distribution_fails_and_is_not_repaired() {
    let folder = Folder::new("sweep-tail");
    let drawn = r#"
[sweep]
design = "random"
rows = 60
seed = 3
reductions = ["length.final", "tension.peak"]
[sweep.vary]
"load.mass" = { normal = { mean = "2 kg", deviation = "2 kg" } }
"command.duty" = { uniform = { from = 0.3, to = 0.6 } }
"#;
    folder.file("muscle.toml", &format!("{BASE}[initial]\ngauge_pressure = \"10 psi\"\n{drawn}"));
    run(&folder, &["sweep", "muscle.toml", "-o", "all.csv"]);
    let lines = csv_lines(&folder.path("all.csv"));
    let negative = lines.iter().filter(|line| number(line, "load_mass_kg") <= 0.0).count();
    // One in six lies below zero.
    assert!((3..20).contains(&negative), "{negative}");
    for line in &lines {
        let failed = number(line, "load_mass_kg") <= 0.0;
        assert_eq!(line["length_final_m"].is_empty() && line["tension_peak_n"].is_empty(), failed, "{line:?}");
        assert_eq!(line["error"].contains("load.mass"), failed, "{line:?}");
    }
    // The others are what `simulate` says of their values.
    let line = lines.iter().find(|line| line["error"].is_empty()).expect("a good row");
    let set = [format!("load.mass={} kg", line["load_mass_kg"]), format!("command.duty={}", line["command_duty"])];
    let engine = "run.engine=fixed-step";
    run(&folder, &["simulate", "muscle.toml", "-o", "run.csv", "-s", engine, "-s", &set[0], "-s", &set[1]]);
    let samples = csv_lines(&folder.path("run.csv"));
    assert_eq!(line["length_final_m"], samples[samples.len() - 1]["length_m"]);
    // Another seed is another sweep.
    run(&folder, &["sweep", "muscle.toml", "-o", "out"]);
    fails(&folder, &["sweep", "muscle.toml", "-o", "out", "-s", "sweep.seed=4"], 2);
}

#[test]
fn samples_and_trajectories_are_those_of_simulate() {
    let folder = Folder::new("sweep-samples");
    folder.file("muscle.toml", &format!("{BASE}{GRID}"));
    for engine in ["fixed-step", "event-located"] {
        run(&folder, &["sweep", "muscle.toml", "-o", "all.csv", "--record", "trajectories", "--engine", engine]);
        let lines = csv_lines(&folder.path("all.csv"));
        assert_eq!(lines.len(), 12 * 121);
        let set = ["load.mass=5 lb", "supply.gauge_pressure=80 psi"];
        let engine_set = format!("run.engine={engine}");
        run(&folder, &["simulate", "muscle.toml", "-o", "run.csv", "-s", set[0], "-s", set[1], "-s", &engine_set]);
        let of_row: Vec<_> = lines.iter().filter(|line| line["run"] == "6").collect();
        let samples = csv_lines(&folder.path("run.csv"));
        for name in samples[0].keys() {
            for (line, sample) in of_row.iter().zip(&samples) {
                assert_eq!(line[name], sample[name], "{name} by {engine}");
            }
        }
        let times = ["-s", r#"sweep.sample_times=["0 s", "50 ms", "0.12 s"]"#];
        let set = ["sweep", "muscle.toml", "-o", "some", "--record", "samples", times[0], times[1], "-s", &engine_set];
        run(&folder, &set);
        let some = parquet_lines(&parts(&folder.path("some")));
        assert_eq!(some.len(), 36);
        for (sample, line) in some[18..21].iter().zip([0, 50, 120].map(|index| of_row[index])) {
            assert_eq!(sample["time_s"], line["time_s"]);
            for name in ["length_m", "absolute_pressure_pa", "air_mass_kg"] {
                // Steps between samples are cut at other instants, which differ by rounding.
                assert!((number(sample, name) / number(line, name) - 1.0).abs() < 1e-6, "{name}");
            }
        }
        std::fs::remove_dir_all(folder.path("some")).expect("removed");
    }
}

/// Three keys with their values.
type Varied = [(&'static str, &'static str); 3];

/// A pressure, a length and a mass of air under control, and what varies of each.
const CONTROLLED: [(&str, &str, Varied); 3] = [
    (
        "kind = \"pid\"\nlength = \"88 mm\"\nproportional_band = \"8 mm\"\nintegral_time = \"0.2 s\"\npulse_frequency = \"50 Hz\"",
        "length",
        [("controller.proportional_band", "6 mm"), ("controller.delay", "2"), ("controller.length", "90 mm")],
    ),
    (
        "kind = \"bang-bang\"\ngauge_pressure = \"40 psi\"\ndead_band = \"1 psi\"",
        "gauge_pressure",
        [("controller.dead_band", "2 psi"), ("controller.rate", "130 Hz"), ("load.mass", "8 lb")],
    ),
    (
        "kind = \"air-mass\"\nforce = \"22 N\"\nlength = \"88 mm\"\nhighest_gauge_pressure = \"90 psi\"\ndead_band = \"0.5 mg\"",
        "air_mass",
        [("controller.temperature", "300 K"), ("controller.resolution", "0.1 mg"), ("valve.opening_delay", "3 ms")],
    ),
];

fn under_control(controller: &str) -> String {
    BASE.replace("preset = \"matrix-eight-channel\"", "kind = \"fill-hold-exhaust\"\nflow_area = \"0.1 mm^2\"")
        .replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", "kind = \"controllers\"")
        .replace("[run]", &format!("[controller]\nrate = \"200 Hz\"\n{controller}\n[run]"))
}

#[test]
fn rows_with_a_controller_are_those_of_simulate() {
    let folder = Folder::new("sweep-controlled");
    for (controller, quantity, varied) in CONTROLLED {
        let text = under_control(controller);
        folder.file("plain.toml", &text);
        let literal = |value: &str| if value == "2" { value.to_owned() } else { format!("\"{value}\"") };
        let vary: Vec<String> =
            varied.iter().map(|(path, value)| format!("\"{path}\" = [{}]", literal(value))).collect();
        let reductions =
            format!("\"{quantity}.final\", \"{quantity}_error.rms\", \"{quantity}_error.peak\", \"air.used\"");
        folder.file(
            "muscle.toml",
            &format!("{text}[sweep]\nreductions = [{reductions}]\n[sweep.vary]\n{}\n", vary.join("\n")),
        );
        let set: Vec<String> = varied.iter().map(|(path, value)| format!("{path}={value}")).collect();
        for engine in ["fixed-step", "event-located"] {
            let engine_set = format!("run.engine={engine}");
            let mut simulate = vec!["simulate", "plain.toml", "-o", "run.csv", "-s", &engine_set];
            simulate.extend(set.iter().flat_map(|set| ["-s", set]));
            let printed = run(&folder, &simulate);
            let samples = csv_lines(&folder.path("run.csv"));
            run(&folder, &["sweep", "muscle.toml", "-o", "all.csv", "--record", "trajectories", "--engine", engine]);
            let lines = csv_lines(&folder.path("all.csv"));
            assert_eq!(lines.len(), samples.len());
            let columns: Vec<&String> = lines[0].keys().filter(|name| samples[0].contains_key(*name)).collect();
            assert_eq!(columns.len(), 11);
            for (line, sample) in lines.iter().zip(&samples) {
                assert!(columns.iter().all(|name| line[*name] == sample[*name]), "{quantity} by {engine}: {line:?}");
            }
            run(&folder, &["sweep", "muscle.toml", "-o", "sweep.csv", "--engine", engine]);
            let line = &csv_lines(&folder.path("sweep.csv"))[0];
            let [name, unit] = match quantity {
                "length" => ["length_m", "m"],
                "gauge_pressure" => ["gauge_pressure_pa", "pa"],
                _ => ["air_mass_kg", "kg"],
            };
            assert_eq!(line[&format!("{quantity}_final_{unit}")], samples[samples.len() - 1][name]);
            assert!(number(line, "air_used_kg") > 0.0);
            // The errors at the sampling instants, of which `simulate` writes those that stand at a recorded sample or before.
            let missed = |sample: &BTreeMap<String, String>| {
                (number(sample, &format!("set_point_{unit}")) - number(sample, &format!("measured_{unit}"))).abs()
            };
            let largest = samples.iter().map(missed).fold(0.0, f64::max);
            assert_eq!(number(line, &format!("{quantity}_error_peak_{unit}")), largest, "{printed}");
            let rms = number(line, &format!("{quantity}_error_rms_{unit}"));
            assert!(rms > 0.0 && rms <= largest);
        }
    }
}

#[test]
fn a_controller_without_a_step_takes_the_event_located_engine() {
    let folder = Folder::new("sweep-controlled-engine");
    let (controller, ..) = CONTROLLED[1];
    let vary = "[sweep]\nreductions = [\"gauge_pressure.final\"]\n[sweep.vary]\n\"controller.dead_band\" = [\"1 psi\", \"2 psi\"]\n";
    let text = under_control(controller) + vary;
    folder.file("muscle.toml", &text);
    assert!(run(&folder, &["sweep", "muscle.toml"]).contains("fixed"));
    folder.file("muscle.toml", &text.replace("step = \"0.1 ms\"\n", ""));
    assert!(run(&folder, &["sweep", "muscle.toml"]).contains("event-located"));
    // Words may lead to rows with a controller and without.
    let kinds = "\"command.kind\" = [\"controllers\", \"fill\"]\n";
    folder.file("both.toml", &(text.replace("\"controller.dead_band\" = [\"1 psi\", \"2 psi\"]\n", kinds)));
    fails(&folder, &["sweep", "both.toml"], 2);
    // Threads and shards change nothing.
    folder.file("muscle.toml", &text.replace("[sweep]\n", "[sweep]\npart_rows = 1\n"));
    run(&folder, &["sweep", "muscle.toml", "-o", "one", "--jobs", "1"]);
    for shard in ["2/2", "1/2"] {
        run(&folder, &["sweep", "muscle.toml", "-o", "shards", "--shard", shard]);
    }
    assert_eq!(bytes(&folder.path("shards")), bytes(&folder.path("one")));
}

/// `record = "samples"` under a controller: the run between listed times is that of the trajectory.
#[test]
fn listed_samples_under_a_controller() {
    let folder = Folder::new("sweep-controlled-samples");
    let (controller, ..) = CONTROLLED[0];
    let vary = "[sweep]\nrecord = \"samples\"\nsample_times = [\"0 s\", \"50 ms\", \"0.12 s\"]\n[sweep.vary]\n\"load.mass\" = [\"5 lb\"]\n";
    folder.file("muscle.toml", &(under_control(controller) + vary));
    run(&folder, &["simulate", "muscle.toml", "-o", "run.csv", "-s", "run.engine=fixed-step"]);
    let samples = csv_lines(&folder.path("run.csv"));
    run(&folder, &["sweep", "muscle.toml", "-o", "some.csv"]);
    for (line, index) in csv_lines(&folder.path("some.csv")).iter().zip([0, 50, 120]) {
        assert_eq!(line["time_s"], samples[index]["time_s"]);
        for name in ["length_m", "absolute_pressure_pa", "air_mass_kg"] {
            let (found, expected) = (number(line, name), number(&samples[index], name));
            // Steps are cut at other instants, which differ by rounding.
            assert!((found / expected - 1.0).abs() < 1e-6, "{name}: {found} for {expected}");
        }
    }
}

/// A joint whose agonist is filled and shut.
fn joint() -> String {
    let joint = "kind = \"antagonistic-joint\"\npulley_radius = \"15 mm\"\nrest_length = \"3.3 in\"\nmass = \"0.5 kg\"\n\
                 distance = \"100 mm\"\ninertia = \"1e-3 kg*m^2\"\ndamping = \"0.02 N*m*s/rad\"\n\
                 [initial]\ngauge_pressure = \"20 psi\"\n[antagonist]\ncommand.kind = \"hold\"";
    BASE.replace("preset = \"matrix-eight-channel\"", "kind = \"fill-hold-exhaust\"\nflow_area = \"0.3 mm^2\"")
        .replace(
            "kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5",
            "kind = \"table\"\ntime = [\"0 s\", \"40 ms\"]\nstate = [\"fill\", \"hold\"]",
        )
        .replace("kind = \"hanging-mass\"\nmass = \"5 lb\"", joint)
}

/// A joint under a controller of both valves.
fn joint_under_control(controller: &str) -> String {
    joint()
        .replace(
            "kind = \"table\"\ntime = [\"0 s\", \"40 ms\"]\nstate = [\"fill\", \"hold\"]",
            "kind = \"controllers\"",
        )
        .replace("command.kind = \"hold\"", "initial.temperature = \"293.15 K\"")
        .replace("[run]", &format!("[controller]\nrate = \"200 Hz\"\n{controller}\n[run]"))
}

/// Every row of a joint against `mckibben simulate`: the trajectory to the bit, and the reductions from its samples.
fn check_joint(name: &str, text: &str, varied: &[(&str, &str)], errors: &[&str]) {
    let folder = Folder::new(name);
    folder.file("plain.toml", text);
    let vary: Vec<String> = varied.iter().map(|(path, value)| format!("\"{path}\" = [\"{value}\"]")).collect();
    let reductions = [
        "angle.final",
        "angle.max",
        "torque.peak",
        "antagonist_absolute_pressure.final",
        "absolute_pressure.max",
        "air.used",
    ];
    let listed: Vec<String> = reductions.iter().chain(errors).map(|name| format!("\"{name}\"")).collect();
    let sweep = format!("{text}[sweep]\nreductions = [{}]\n[sweep.vary]\n{}\n", listed.join(", "), vary.join("\n"));
    folder.file("joint.toml", &sweep);
    let set: Vec<String> = varied.iter().map(|(path, value)| format!("{path}={value}")).collect();
    for engine in ["fixed-step", "event-located"] {
        let engine_set = format!("run.engine={engine}");
        let mut simulate = vec!["simulate", "plain.toml", "-o", "run.csv", "-s", &engine_set];
        simulate.extend(set.iter().flat_map(|set| ["-s", set]));
        run(&folder, &simulate);
        let samples = csv_lines(&folder.path("run.csv"));
        run(&folder, &["sweep", "joint.toml", "-o", "all.csv", "--record", "trajectories", "--engine", engine]);
        let lines = csv_lines(&folder.path("all.csv"));
        assert_eq!((lines.len(), samples.len()), (121, 121));
        let columns: Vec<&String> = lines[0].keys().filter(|name| samples[0].contains_key(*name)).collect();
        assert_eq!(columns.len(), 24);
        for (line, sample) in lines.iter().zip(&samples) {
            assert!(columns.iter().all(|name| line[*name] == sample[*name]), "{name} by {engine}: {line:?}");
        }
        run(&folder, &["sweep", "joint.toml", "-o", "sweep.csv", "--engine", engine]);
        let line = &csv_lines(&folder.path("sweep.csv"))[0];
        let last = &samples[samples.len() - 1];
        assert_eq!(line["angle_final_rad"], last["angle_rad"]);
        assert_eq!(line["antagonist_absolute_pressure_final_pa"], last["antagonist_absolute_pressure_pa"]);
        let column = |name: &str| samples.iter().map(|sample| number(sample, name)).collect::<Vec<f64>>();
        let greatest = |values: Vec<f64>| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(number(line, "angle_max_rad"), greatest(column("angle_rad")));
        assert_eq!(number(line, "absolute_pressure_max_pa"), greatest(column("absolute_pressure_pa")));
        assert_eq!(number(line, "torque_peak_n_m"), greatest(column("torque_n_m").into_iter().map(f64::abs).collect()));
        // Both valves shut but for filling: what came is what is there, of the actuators that were filled.
        assert!(number(line, "air_used_kg") > 0.0);
        for (error, unit) in errors.iter().zip(["rad", "n_m_rad"]) {
            let name = format!("{}_{unit}", error.replace('.', "_"));
            assert!(number(line, &name) > 0.0, "{name}");
        }
    }
}

#[test]
fn rows_of_a_joint_are_those_of_simulate() {
    let varied = [
        ("initial.gauge_pressure", "25 psi"),
        ("antagonist.initial.temperature", "300 K"),
        ("load.pulley_radius", "14 mm"),
        ("load.mass", "0.4 kg"),
        ("antagonist.load.rest_length", "3.35 in"),
    ];
    check_joint("sweep-joint", &joint(), &varied, &[]);
}

#[test]
fn rows_of_a_joint_with_a_controller_are_those_of_simulate() {
    let pid = "kind = \"pid\"\nangle = \"10 deg\"\nproportional_band = \"30 deg\"\npulse_frequency = \"50 Hz\"";
    let varied = [
        ("controller.proportional_band", "20 deg"),
        ("controller.angle", "12 deg"),
        ("load.damping", "0.03 N*m*s/rad"),
    ];
    check_joint("sweep-joint-pid", &joint_under_control(pid), &varied, &["angle_error.rms"]);
    let air_mass = "kind = \"air-mass\"\nangle = \"8 deg\"\nstiffness = \"1 N*m/rad\"\nhighest_gauge_pressure = \"60 psi\"\n\
                    dead_band = \"0.5 mg\"";
    let varied =
        [("controller.stiffness", "1.1 N*m/rad"), ("controller.dead_band", "1 mg"), ("valve.flow_area", "0.2 mm^2")];
    check_joint(
        "sweep-joint-mass",
        &joint_under_control(air_mass),
        &varied,
        &["angle_error.rms", "stiffness_error.peak"],
    );
}

/// The efficiency of rows is that of the summary of their runs, of every kind of run and by both engines.
#[test]
fn the_efficiency_is_that_of_the_summary() {
    let folder = Folder::new("sweep-efficiency");
    let arm = std::fs::read_to_string(of_repository("examples/plant/arm.toml"))
        .expect("an example")
        .replace("duration = \"2 s\"", "duration = \"0.2 s\"");
    let pressures = "[sweep.vary]\n\"supply.gauge_pressure\" = [\"60 psi\", \"80 psi\"]\n";
    let in_plant = "[sweep.vary]\n\"supplies.regulator.gauge_pressure\" = [\"4 bar\", \"5 bar\"]\n";
    for (name, text, vary, engines) in [
        ("muscle", BASE.to_owned(), pressures, &["fixed-step", "event-located"][..]),
        ("joint", joint(), pressures, &["fixed-step", "event-located"]),
        ("arm", arm, in_plant, &["event-located"]),
    ] {
        folder.file("plain.toml", &text);
        folder.file("sweep.toml", &format!("{text}\n[sweep]\nreductions = [\"exergy.efficiency\"]\n{vary}"));
        for engine in engines {
            run(&folder, &["sweep", "sweep.toml", "-o", "sweep.csv", "--engine", engine]);
            let lines = csv_lines(&folder.path("sweep.csv"));
            let key = if name == "arm" { "supplies.regulator.gauge_pressure" } else { "supply.gauge_pressure" };
            let column = format!("{}_pa", key.replace('.', "_"));
            let mut all = Vec::new();
            for line in &lines {
                let set = [format!("{key}={} Pa", line[&column]), format!("run.engine={engine}")];
                let arguments = ["simulate", "plain.toml", "--format", "json", "-s", &set[0], "-s", &set[1]];
                let summary: serde_json::Value = serde_json::from_str(&run(&folder, &arguments)).expect("JSON");
                let expected = summary["numbers"]["exergy_efficiency"].as_f64().expect("a number");
                let found = number(line, "exergy_efficiency");
                assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{name} by {engine}: {found} {expected}");
                all.push(found);
            }
            assert!(all.len() == 2 && all[0] != all[1], "{name} by {engine}: {all:?}");
        }
    }
    // What draws no exergy has none.
    let sealed = joint()
        .replace("kind = \"table\"\ntime = [\"0 s\", \"40 ms\"]\nstate = [\"fill\", \"hold\"]", "kind = \"hold\"");
    folder.file("sealed.toml", &format!("{sealed}\n[sweep]\nreductions = [\"exergy.efficiency\"]\n{pressures}"));
    run(&folder, &["sweep", "sealed.toml", "-o", "sealed.csv"]);
    assert!(csv_lines(&folder.path("sealed.csv")).iter().all(|line| line["exergy_efficiency"].is_empty()));
}

/// Two sealed actuators at rest: the balance and its sealed stiffness are those of the linear model.
#[test]
fn a_joint_at_rest_has_the_stiffness_of_its_linear_model() {
    let folder = Folder::new("sweep-joint-stiffness");
    let sealed = joint()
        .replace("kind = \"table\"\ntime = [\"0 s\", \"40 ms\"]\nstate = [\"fill\", \"hold\"]", "kind = \"hold\"");
    let vary = "[sweep]\nreductions = [\"angle.final\", \"stiffness.mean\", \"stiffness.final\", \"air.used\"]\n[sweep.vary]\n\
                \"initial.gauge_pressure\" = [\"20 psi\", \"50 psi\"]\n\"antagonist.initial.gauge_pressure\" = [\"20 psi\", \"40 psi\"]\n";
    folder.file("joint.toml", &format!("{sealed}{vary}"));
    run(&folder, &["sweep", "joint.toml", "-o", "all.csv"]);
    for line in csv_lines(&folder.path("all.csv")) {
        let set = [
            format!("initial.gauge_pressure={} Pa", line["initial_gauge_pressure_pa"]),
            format!("antagonist.initial.gauge_pressure={} Pa", line["antagonist_initial_gauge_pressure_pa"]),
        ];
        run(&folder, &["linearize", "joint.toml", "-o", "model.json", "-s", &set[0], "-s", &set[1]]);
        let model = std::fs::read_to_string(folder.path("model.json")).expect("written");
        let model: serde_json::Value = serde_json::from_str(&model).expect("JSON");
        let point = |name: &str| model["operating_point"][name].as_f64().expect("a number");
        let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        close(number(&line, "stiffness_final_n_m_rad"), point("sealed_stiffness_n_m_rad"));
        close(number(&line, "stiffness_mean_n_m_rad"), point("sealed_stiffness_n_m_rad"));
        assert!((number(&line, "angle_final_rad") - point("angle_rad")).abs() < 1e-6);
        assert_eq!(number(&line, "air_used_kg"), 0.0);
    }
}

/// Without a step the rows of a joint share the one that they need, as those of one actuator do.
#[test]
fn a_sweep_of_a_joint_chooses_its_step() {
    let folder = Folder::new("sweep-joint-step");
    let vary = "[sweep]\nrecord = \"samples\"\nsample_times = [\"0 s\", \"60 ms\", \"0.12 s\"]\n[sweep.vary]\n\"load.mass\" = [\"0.3 kg\", \"0.5 kg\"]\n";
    folder.file("joint.toml", &(joint().replace("step = \"0.1 ms\"\n", "") + vary));
    let printed = run(&folder, &["sweep", "joint.toml", "-o", "all"]);
    assert!(printed.contains("the least that 2 runs spread over the sweep need"), "{printed}");
    let step = step_of(&folder.path("all"))["longest_s"].as_f64().expect("a step");
    let lines = parquet_lines(&parts(&folder.path("all")));
    assert_eq!(lines.len(), 6);
    let set = format!("run.step={step} s");
    run(
        &folder,
        &[
            "simulate",
            "joint.toml",
            "-o",
            "run.csv",
            "-s",
            "run.engine=fixed-step",
            "-s",
            "load.mass=0.3 kg",
            "-s",
            &set,
        ],
    );
    let samples = csv_lines(&folder.path("run.csv"));
    for (line, index) in lines.iter().zip([0, 60, 120]) {
        for name in ["angle_rad", "antagonist_absolute_pressure_pa", "tension_n"] {
            let (found, expected) = (number(line, name), number(&samples[index], name));
            // Steps between samples are cut at other instants, but for rounding at the same: each step rounds once.
            let largest = samples.iter().fold(0.0_f64, |largest, sample| largest.max(number(sample, name).abs()));
            let rounding = 0.12 / step * f64::EPSILON * largest;
            assert!((found - expected).abs() <= rounding, "{name}: {found} for {expected}, allowed {rounding:e}");
        }
    }
}

#[test]
fn times_may_vary_too() {
    let folder = Folder::new("sweep-times");
    let times = r#"
[sweep]
reductions = ["length.final"]
[sweep.vary]
"run.duration" = ["50 ms", "80 ms", "120 ms"]
"run.step" = ["0.1 ms", "0.2 ms"]
"run.method" = ["stable", "rk4"]
"#;
    folder.file("muscle.toml", &format!("{BASE}{times}"));
    run(&folder, &["sweep", "muscle.toml", "-o", "all.csv"]);
    let lines = csv_lines(&folder.path("all.csv"));
    assert_eq!(lines.len(), 12);
    for line in [&lines[0], &lines[7], &lines[10]] {
        let set = [
            format!("run.duration={} s", line["run_duration_s"]),
            format!("run.step={} s", line["run_step_s"]),
            format!("run.method={}", line["run_method"]),
        ];
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        let engine = ["simulate", "muscle.toml", "-o", "run.csv", "--set", "run.engine=fixed-step"];
        run(&folder, &[&engine[..], &set].concat());
        let samples = csv_lines(&folder.path("run.csv"));
        assert_eq!(line["length_final_m"], samples[samples.len() - 1]["length_m"]);
    }
}

/// The scenario without a step, which an accuracy then chooses.
fn without_step() -> String {
    BASE.replace("step = \"0.1 ms\"\n", "")
}

/// What the parts of a folder say of the step, as one.
fn step_of(folder: &Path) -> serde_json::Value {
    let of_part = |path: &std::path::PathBuf| {
        let reader = SerializedFileReader::new(std::fs::File::open(path).expect("there")).expect("a Parquet file");
        let pairs = reader.metadata().file_metadata().key_value_metadata().expect("metadata").clone();
        pairs.into_iter().find(|pair| pair.key == "mckibben.step").and_then(|pair| pair.value)
    };
    let mut steps: Vec<_> = parts(folder).iter().map(of_part).collect();
    steps.dedup();
    assert_eq!(steps.len(), 1, "{steps:?}");
    steps[0].as_ref().map_or(serde_json::Value::Null, |step| serde_json::from_str(step).expect("JSON"))
}

#[test]
fn without_a_step_the_sweep_takes_the_least_that_the_rows_tried_need() {
    let folder = Folder::new("sweep-step");
    folder.file("muscle.toml", &format!("{}{GRID}", without_step()));
    let set = ["-s", "run.accuracy=1e-3"];
    let printed =
        run(&folder, &[&["sweep", "muscle.toml", "-o", "out", "--record", "trajectories"], &set[..]].concat());
    assert!(printed.contains("the least that 8 runs spread over the sweep need for an accuracy of 1e-3"), "{printed}");
    let lines = parquet_lines(&parts(&folder.path("out")));
    let chosen = step_of(&folder.path("out"));
    // Eight of twelve rows, as evenly as whole numbers allow.
    let tried = [0, 1, 3, 4, 6, 7, 9, 11];
    assert_eq!(chosen["enough_for_runs"], serde_json::json!(tried));
    assert_eq!((&chosen["accuracy"], &chosen["too_long_for_runs"]), (&1e-3.into(), &serde_json::json!([])));
    let (masses, pressures) = (["3 lb", "5 lb", "15 lb"], [20, 60, 80, 100]);
    let mut least = f64::INFINITY;
    for row in tried {
        let set = [
            format!("load.mass={}", masses[row / 4]),
            format!("supply.gauge_pressure={} psi", pressures[row % 4]),
            format!("run.step={} s", chosen["longest_s"]),
        ];
        let simulate = ["simulate", "muscle.toml", "-o", "run.csv", "-s", &set[0], "-s", &set[1], "-s"];
        // `simulate` prints the step that each needs.
        let printed = run(&folder, &[&simulate[..], &["run.engine=fixed-step"]].concat());
        let step = printed.split("at most ").nth(1).and_then(|rest| rest.split(" µs").next()).expect("a step in µs");
        least = least.min(step.parse::<f64>().expect("a number") * 1e-6);
        // With the step of the sweep its run is that of the sweep.
        run(&folder, &[&simulate[..], &["run.engine=fixed-step", "-s", &set[2]]].concat());
        let alone = csv_lines(&folder.path("run.csv"));
        let swept: Vec<_> = lines.iter().filter(|line| line["run"] == row.to_string()).collect();
        assert_eq!(swept.len(), alone.len());
        run(&folder, &[&simulate[..], &["run.relative_tolerance=1e-10"]].concat());
        let exact = csv_lines(&folder.path("run.csv"));
        for name in ["length_m", "velocity_m_s", "absolute_pressure_pa", "air_mass_kg"] {
            assert!(swept.iter().zip(&alone).all(|(swept, alone)| swept[name] == alone[name]), "{name} of row {row}");
            // And it has the requested accuracy.
            let values = || exact.iter().map(|line| number(line, name));
            let range = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
            let error = swept.iter().zip(values()).map(|(line, value)| (number(line, name) - value).abs());
            let error = error.fold(0.0, f64::max) / range;
            assert!(error < 1.05e-3, "{name} of row {row}: {error:e}");
        }
    }
    let step = chosen["longest_s"].as_f64().expect("a number");
    assert!((step / least - 1.0).abs() < 1e-9, "{step} and {least}");
}

#[test]
fn every_shard_and_a_resumed_sweep_take_the_same_step() {
    let folder = Folder::new("sweep-step-shards");
    folder.file("muscle.toml", &format!("{}{GRID}", without_step()));
    let sweep = |arguments: &[&str]| run(&folder, &[&["sweep", "muscle.toml"], arguments].concat());
    sweep(&["-o", "whole", "--jobs", "1"]);
    let whole = bytes(&folder.path("whole"));
    for shard in ["3/3", "1/3", "2/3"] {
        sweep(&["-o", "shards", "--shard", shard]);
    }
    assert_eq!(bytes(&folder.path("shards")), whole);
    std::fs::remove_file(folder.path("shards/part-00001.parquet")).expect("there");
    sweep(&["-o", "shards"]);
    assert_eq!(bytes(&folder.path("shards")), whole);
    let message = fails(&folder, &["sweep", "muscle.toml", "-o", "whole", "-s", "run.accuracy=1e-2"], 2);
    assert!(message.contains("another sweep") && message.contains("accuracy"), "{message}");
    // One that is given is no choice of the program.
    sweep(&["-o", "given", "-s", "run.step=0.2 ms"]);
    assert_eq!(step_of(&folder.path("given")), serde_json::Value::Null);
}

#[test]
fn an_accuracy_that_varies_gives_each_row_the_step_it_needs() {
    let folder = Folder::new("sweep-accuracy");
    let varied = "[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n\"run.accuracy\" = [1e-2, 1e-3, 1e-4]\n\
                  \"load.mass\" = [\"5 lb\", \"15 lb\"]\n";
    folder.file("muscle.toml", &format!("{}{varied}", without_step()));
    run(&folder, &["sweep", "muscle.toml", "-o", "all.csv"]);
    let lines = csv_lines(&folder.path("all.csv"));
    assert_eq!(lines.len(), 6);
    for line in &lines {
        let set = [format!("run.accuracy={}", line["run_accuracy"]), format!("load.mass={} kg", line["load_mass_kg"])];
        let engine = "run.engine=fixed-step";
        run(&folder, &["simulate", "muscle.toml", "-o", "run.csv", "-s", engine, "-s", &set[0], "-s", &set[1]]);
        let samples = csv_lines(&folder.path("run.csv"));
        assert_eq!(line["length_final_m"], samples[samples.len() - 1]["length_m"]);
    }
}

#[test]
fn rows_that_cannot_be_run_have_no_say_in_the_step() {
    let folder = Folder::new("sweep-step-failed");
    // The thread is shorter than the muscle in the second and the last row.
    let threads = "[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n\
                   \"actuator.thread_length\" = [\"4.3218 in\", \"3 in\", \"4.4 in\", \"2 in\"]\n";
    folder.file("muscle.toml", &format!("{}{threads}", without_step()));
    let printed = run(&folder, &["sweep", "muscle.toml", "-o", "some"]);
    assert!(printed.contains("the least that 2 runs") && printed.contains("2 of 4 runs failed"), "{printed}");
    assert_eq!(step_of(&folder.path("some"))["enough_for_runs"], serde_json::json!([0, 2]));
    // Where none can be run, or none reaches the accuracy, each has the reason of its individual run.
    folder.file("none.toml", &format!("{}{}", without_step(), threads.replace("4.3218", "2.5").replace("4.4", "2.6")));
    let reasons = |arguments: &[&str]| {
        fails(&folder, &[&["sweep"], arguments].concat(), 3);
        csv_lines(&folder.path("none.csv")).into_iter().map(|line| line["error"].clone()).collect::<Vec<_>>()
    };
    let short = reasons(&["none.toml", "-o", "none.csv"]);
    assert!(short.len() == 4 && short.iter().all(|reason| reason.contains("thread_length")), "{short:?}");
    folder
        .file("strict.toml", &format!("{}{}", without_step(), GRID.replace(r#""3 lb", "5 lb", "15 lb""#, r#""5 lb""#)));
    let strict = ["strict.toml", "-o", "none.csv", "-s", "run.accuracy=1e-9", "-s", "run.duration=42 ms"];
    let strict = reasons(&strict);
    assert!(strict.len() == 4 && strict.iter().all(|reason| reason.contains("loosen run.accuracy")), "{strict:?}");
}

#[test]
fn figures_are_drawn() {
    let folder = Folder::new("sweep-plot");
    folder.file("muscle.toml", &format!("{BASE}{GRID}"));
    run(&folder, &["sweep", "muscle.toml", "-p", "map.svg", "-q"]);
    let svg = std::fs::read_to_string(folder.path("map.svg")).expect("drawn");
    for word in ["load mass (kg)", "supply gauge pressure (bar)", "final length (mm)", "greatest absolute pressure"] {
        assert!(svg.contains(word), "{word}");
    }
    run(&folder, &["sweep", "muscle.toml", "-p", "map.png", "-q"]);
    assert!(std::fs::read(folder.path("map.png")).expect("drawn").starts_with(b"\x89PNG"));
    // Where every run of a value fails, its cells are there and crossed.
    let gap = r#"[sweep]
reductions = ["length.final"]
[sweep.vary]
"actuator.thread_length" = ["3 in", "4.3218 in", "4.4 in"]
"load.mass" = ["3 lb", "5 lb"]
"#;
    folder.file("gap.toml", &format!("{BASE}{gap}"));
    run(&folder, &["sweep", "gap.toml", "-p", "gap.svg"]);
    let svg = std::fs::read_to_string(folder.path("gap.svg")).expect("drawn");
    // The lowest colour is that of a cell too, not of the bar alone; crosses have a separate line.
    let is_lowest = svg.matches("fill=\"#2f174e\"").count() >= 2;
    assert!(svg.contains("Crossed cells") && is_lowest && svg.contains("stroke-width=\"0.5\""), "{svg}");
    let more = r#""load.mass" = ["3 lb", "5 lb"]
"air.process" = ["isentropic", "isothermal"]
"command.duty" = [0.4, 0.6]
"#;
    folder.file("more.toml", &format!("{BASE}[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n{more}"));
    run(&folder, &["sweep", "more.toml", "-p", "matrix.svg"]);
    let svg = std::fs::read_to_string(folder.path("matrix.svg")).expect("drawn");
    assert!(svg.matches("ρ = ").count() == 2 && svg.contains("isothermal"), "{svg}");
    assert_eq!(folder.names(), ["gap.svg", "gap.toml", "map.png", "map.svg", "matrix.svg", "more.toml", "muscle.toml"]);
}

#[test]
fn mistakes_are_reported_before_anything_is_simulated() {
    let folder = Folder::new("sweep-mistakes");
    folder.file("muscle.toml", &format!("{BASE}{GRID}"));
    folder.file("plain.toml", BASE);
    folder.file("taken", "");
    let before = folder.names();
    for (arguments, word) in [
        (&["plain.toml"][..], "has no section [sweep]"),
        (&["absent.toml"], "cannot be read"),
        (&["muscle.toml", "-o", "run.txt"], "does not say how to write"),
        (&["muscle.toml", "-p", "run.jpg"], "does not say how to draw"),
        (&["muscle.toml", "-o", "out", "--shard", "0/4"], "counted from 1"),
        (&["muscle.toml", "-o", "out", "--shard", "5/4"], "counted from 1"),
        (&["muscle.toml", "-o", "out", "--shard", "4"], "I/N"),
        (&["muscle.toml", "-o", "out.csv", "--shard", "1/4"], "only a folder has"),
        (&["muscle.toml", "-o", "out", "--shard", "1/4", "-p", "a.svg"], "the whole sweep"),
        (&["muscle.toml", "-o", "out", "--jobs", "0"], "--jobs"),
        (&["muscle.toml", "-o", "out", "--jobs", "1000000"], "leave --jobs out for one thread for each core"),
        (&["muscle.toml", "-o", "taken"], "`taken` is there and is no folder"),
        (&["muscle.toml", "-o", "out", "--engine", "magic"], "fixed-step"),
        (&["muscle.toml", "-o", "out", "--record", "trajectories", "-p", "a.svg"], "draws reductions"),
        (&["muscle.toml", "-o", "out", "--set", "load.gravity=5 lb"], "--set:1"),
        (&["muscle.toml", "-o", "a.svg", "-p", "a.svg"], "does not say how"),
        (&["muscle.toml", "-o", "muscle.toml"], "does not say how"),
    ] {
        let message = fails(&folder, &[&["sweep"], arguments].concat(), 2);
        assert!(message.starts_with("error: ") && message.contains(word), "{arguments:?}: {message}");
        assert_eq!(folder.names(), before, "{arguments:?}");
    }
    for arguments in [["-o", "absent/run.csv"], ["-p", "absent/run.svg"], ["-o", "muscle.toml/out"]] {
        let message = fails(&folder, &[&["sweep", "muscle.toml"], &arguments[..]].concat(), 4);
        assert!(message.contains("could not be written"), "{message}");
        assert_eq!(folder.names(), before, "{arguments:?}");
    }
    let help = run(&folder, &["sweep", "--help"]);
    for word in ["Examples:", "mckibben sweep", "[sweep.vary]", "counted from 1", "sample_interval", "Exit codes:"] {
        assert!(help.contains(word), "{word}");
    }
}

/// What varies is set on the command line as the file writes it, and the figure's title leaves it out.
/// An entry at fault has the name by which entries vary, counted from 0.
#[test]
fn an_entry_at_fault_is_counted_as_what_varies() {
    let folder = Folder::new("sweep-entry");
    let text = "[supply]\ngauge_pressure = \"5 bar\"\n[valve]\nkind = \"fill-hold-exhaust\"\nflow_area = \"1 mm^2\"\n[command]\n\
                kind = \"table\"\ntime = [\"0.1 s\", \"0.2 s\", \"0.3 s\"]\nstate = [\"fill\", \"hold\", \"exhaust\"]\n[load]\n\
                kind = \"isometric\"\n[initial]\nlength = \"90 mm\"\n[run]\nduration = \"20 ms\"\n[sweep]\n\
                reductions = [\"length.final\"]\n[sweep.vary]\n\"command.time[1]\" = [\"0.15 s\", \"1.2 s\"]\n";
    folder.file("entry.toml", text);
    let printed = run(&folder, &["sweep", "entry.toml"]).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(printed.contains("1 of 2 runs failed"), "{printed}");
    assert!(printed.contains("at command.time[2], the first entry being command.time[0]"), "{printed}");
}

#[test]
fn what_varies_is_set_on_the_command_line_and_no_part_of_the_title() {
    let folder = Folder::new("sweep-set-vary");
    folder.file(
        "muscle.toml",
        &format!(
            "{BASE}[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n\"load.mass\" = [\"3 lb\", \"4 lb\"]\n"
        ),
    );
    for set in ["sweep.vary.\"load.mass\"=[\"1 kg\", \"2 kg\"]", "sweep.vary.load.mass=[\"1 kg\", \"2 kg\"]"] {
        run(&folder, &["sweep", "muscle.toml", "-q", "-o", "runs.csv", "--set", set]);
        let lines = csv_lines(&folder.path("runs.csv"));
        let masses: Vec<f64> = lines.iter().map(|line| line["load_mass_kg"].parse().expect("a number")).collect();
        assert_eq!(masses, [1.0, 2.0], "{set}");
    }
    run(&folder, &["sweep", "muscle.toml", "-q", "-p", "runs.svg"]);
    let svg = std::fs::read_to_string(folder.path("runs.svg")).expect("drawn");
    assert!(svg.contains("A muscle under a load, pulsed at 25 Hz and 50 %") && !svg.contains("2.268 kg"), "{svg}");
    // How it varies is in the figure, and no TOML in its title.
    let set = ["--set", "sweep.vary.load.mass=[\"1 kg\", \"2 kg\"]", "--set", "command.duty=0.4"];
    run(&folder, &[&["sweep", "muscle.toml", "-q", "-p", "set.svg"][..], &set].concat());
    let svg = std::fs::read_to_string(folder.path("set.svg")).expect("drawn");
    assert!(svg.contains("command.duty = 0.4") && !svg.contains("sweep.vary"), "{svg}");
    let twice = fails(
        &folder,
        &["sweep", "muscle.toml", "-o", "twice.mat", "-s", "sweep.reductions=[\"length.final\", \"length.final\"]"],
        2,
    );
    assert!(twice.contains("the reduction `length.final` is named twice"), "{twice}");
    assert!(!folder.path("twice.mat").exists());
}
