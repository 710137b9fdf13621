//! Warnings of `simulate`, `check`, `sweep`, `design` and `linearize`; `--strict`; the summary as JSON; a scenario from standard input.

use crate::common::{Folder, PULSES, of_repository};
use std::process::Output;

/// The pulsed muscle for a tenth of a second.
fn muscle() -> String {
    PULSES.replace("0.3 s", "0.1 s")
}

/// The valve of this muscle opens 4 ms after its coil is energised, and a duty of 0.05 at 25 Hz lasts 2 ms.
const NEVER_OPENS: &str =
    "the valve never opens to the supply: a pulse of 2 ms is shorter than valve.opening_delay = 4 ms";

fn run(folder: &Folder, arguments: &[&str]) -> Output {
    folder.mckibben().args(arguments).output().expect("the program runs")
}

/// Text without its line breaks.
fn flat(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).split_whitespace().collect::<Vec<_>>().join(" ")
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", flat(&output.stderr)))
}

#[test]
fn a_warning_stands_in_the_summary_and_of_a_quiet_run_on_standard_error() {
    let folder = Folder::new("warnings-where");
    folder.file("muscle.toml", &muscle());
    let short = ["simulate", "muscle.toml", "--set", "command.duty=0.05"];
    let output = run(&folder, &short);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", flat(&output.stderr));
    let text = flat(&output.stdout);
    assert!(text.contains(&format!("Warnings {NEVER_OPENS}")), "{text}");
    let output = run(&folder, &[&short[..], &["--quiet"]].concat());
    assert!(output.status.success() && output.stdout.is_empty());
    assert!(flat(&output.stderr).starts_with(&format!("warning: {NEVER_OPENS}")), "{}", flat(&output.stderr));
    // A plain run has none.
    assert!(!flat(&run(&folder, &["simulate", "muscle.toml"]).stdout).contains("Warnings"));
}

#[test]
fn strict_makes_errors_of_warnings_and_nothing_is_written() {
    let folder = Folder::new("warnings-strict");
    folder.file("muscle.toml", &muscle());
    // The first is known before the run, the second after it.
    for set in ["command.duty=0.05", "supply.gauge_pressure=280 psi"] {
        for plot in [&[][..], &["--plot", "run.svg"]] {
            let arguments = ["simulate", "muscle.toml", "--set", set, "--strict", "--output", "run.csv"];
            let output = run(&folder, &[&arguments[..], plot].concat());
            let message = flat(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.starts_with("warning: ") && message.contains("--strict makes errors"), "{message}");
            assert!(output.stdout.is_empty());
            assert_eq!(folder.names(), ["muscle.toml"], "{set}");
        }
    }
    let output = run(&folder, &["simulate", "muscle.toml", "--strict", "--output", "run.csv"]);
    assert!(output.status.success(), "{}", flat(&output.stderr));
}

#[test]
fn check_warns_of_what_is_known_before_a_run() {
    let folder = Folder::new("warnings-check");
    folder.file("good.toml", &muscle());
    folder.file("short.toml", &muscle().replace("duty = 0.5", "duty = 0.05"));
    let output = run(&folder, &["check", "good.toml", "short.toml"]);
    assert!(output.status.success());
    assert!(
        flat(&output.stderr).starts_with(&format!("warning: short.toml: {NEVER_OPENS}")),
        "{}",
        flat(&output.stderr)
    );
    let output = run(&folder, &["check", "--strict", "good.toml", "short.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(flat(&output.stderr).contains("1 of 2 files wrong, one warning"), "{}", flat(&output.stderr));
    assert!(flat(&output.stdout).contains("ok good.toml") && !flat(&output.stdout).contains("short.toml"));
}

/// The measured preset pushes where it is shorter than at rest and has no pressure: the warning says what to change of the run, and of
/// a law that is wrong.
#[test]
fn a_measured_muscle_that_is_pressed_together_is_warned_of() {
    let folder = Folder::new("warnings-pressed");
    let text = "[actuator]\npreset = \"festo-dmsp-20-300\"\n[load]\nkind = \"isometric\"\n[initial]\nlength = \"290 mm\"\n\
                [run]\nduration = \"50 ms\"\n";
    folder.file("pressed.toml", text);
    let output = run(&folder, &["simulate", "pressed.toml"]);
    let printed = flat(&output.stdout);
    assert!(output.status.success(), "{}", flat(&output.stderr));
    assert!(printed.contains("keep the muscle longer or its pressure higher there"), "{printed}");
    assert!(printed.contains("where the law does not hold there, raise actuator.min_length"), "{printed}");
    // Rounding of the atmosphere is no pressure in a small unit.
    assert!(printed.contains("gauge pressure 0 bar 0 bar 0 bar"), "{printed}");
}

/// Values are set before the check, as before a run: what they make wrong or doubtful is reported, and the file stays.
#[test]
fn check_sets_values_first() {
    let folder = Folder::new("check-set");
    folder.file("good.toml", &muscle());
    let output = run(&folder, &["check", "good.toml", "--set", "command.duty=0.05"]);
    assert!(output.status.success() && flat(&output.stderr).contains(NEVER_OPENS), "{}", flat(&output.stderr));
    for (set, words) in [
        ("load.mass=5 mm", "\"5 mm\" is a length"),
        ("load.mas=5 lb", "did you mean"),
        ("load.mass", "write KEY=VALUE"),
    ] {
        let output = run(&folder, &["check", "good.toml", "--set", set]);
        assert!(output.status.code() == Some(2) && flat(&output.stderr).contains(words), "{}", flat(&output.stderr));
    }
    assert_eq!(std::fs::read_to_string(folder.path("good.toml")).expect("there"), muscle());
}

#[test]
fn a_sweep_counts_the_runs_with_warnings() {
    let folder = Folder::new("warnings-sweep");
    let sweep = "[sweep]\nreductions = [\"length.final\"]\n[sweep.vary]\n\"command.duty\" = [0.5, 0.08, 0.05, 0.6]\n";
    folder.file("sweep.toml", &format!("{}step = \"0.5 ms\"\n{sweep}", muscle()));
    let output = run(&folder, &["sweep", "sweep.toml"]);
    let text = flat(&output.stdout);
    assert!(output.status.success(), "{}", flat(&output.stderr));
    assert!(
        text.contains(
            "Warnings valve-never-opens: 2 runs, the first 1: the valve never opens to the supply: a pulse of 3.2 ms"
        ),
        "{text}"
    );
}

/// A load of 0.05 lb is thrown above the attachment by 100 psi, which only the run shows: counted side by side, individually and from
/// finished parts, with the code in the line of the run.
#[test]
fn a_sweep_counts_what_its_runs_reach() {
    let folder = Folder::new("warnings-sweep-reached");
    let muscle = muscle().replace("0.1 s", "0.3 s");
    let vary = "[sweep]\nreductions = [\"length.final\"]\npart_rows = 2\n[sweep.vary]\n\
                \"load.mass\" = [\"5 lb\", \"0.05 lb\", \"6 lb\", \"0.04 lb\"]\n";
    folder.file("sweep.toml", &format!("{muscle}step = \"0.5 ms\"\n{vary}"));
    let words = "Warnings thrown: 2 runs, the first 1: the load is thrown above the attachment";
    let sweep = |arguments: &[&str]| {
        let output = run(&folder, &[&["sweep", "sweep.toml"], arguments].concat());
        assert!(output.status.success(), "{}", flat(&output.stderr));
        flat(&output.stdout)
    };
    for engine in ["fixed-step", "event-located"] {
        let text = sweep(&["--engine", engine, "-o", "runs.csv"]);
        assert!(text.contains(words), "{engine}: {text}");
        let table = std::fs::read_to_string(folder.path("runs.csv")).expect("written");
        let ends: Vec<&str> = table.lines().filter_map(|line| line.rsplit(',').nth(1)).collect();
        assert_eq!(ends, ["warnings", "", "thrown", "", "thrown"], "{engine}: {table}");
    }
    let fresh = sweep(&["-o", "runs"]);
    let kept = sweep(&["-o", "runs"]);
    assert!(fresh.contains(words) && kept.contains(words) && kept.contains("kept 4 runs"), "{fresh}\n{kept}");
    let samples = sweep(&["-o", "samples", "--record", "trajectories"]);
    assert!(samples.contains(words), "{samples}");
    assert!(sweep(&["-o", "samples", "--record", "trajectories"]).contains(words));
}

/// The least length of this muscle is that of a load which 400 bar throw: the warnings of that run are printed.
#[test]
fn a_design_warns_of_its_best_run() {
    let folder = Folder::new("warnings-design");
    let muscle = of_repository("examples/own-muscle.toml").display().to_string();
    let design = |most: &str, format: &str| {
        let vary = format!("supply.gauge_pressure=0.5..{most} bar");
        let options = ["--minimize", "length.min", "--evaluations", "12", "--format", format];
        let output = run(&folder, &[&["design", &muscle, "--vary", &vary], &options[..]].concat());
        assert!(output.status.success(), "{}", flat(&output.stderr));
        output
    };
    let text = flat(&design("400", "text").stdout);
    for words in ["Warnings", "the load is thrown above the attachment", "400 bar"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let found = json(&design("400", "json"));
    let codes: Vec<&str> =
        found["warnings"].as_array().expect("a list").iter().filter_map(|one| one["code"].as_str()).collect();
    assert!(codes.contains(&"thrown") && codes.contains(&"pressure"), "{codes:?}");
    // At 1 bar the muscle lifts 5 kg by little, and nothing is wrong.
    assert_eq!(json(&design("1", "json"))["warnings"].as_array().map(Vec::len), Some(0));
    assert!(!flat(&design("1", "text").stdout).contains("Warnings"));
}

#[test]
fn a_linear_model_warns_of_a_pressure_that_the_supply_cannot_make() {
    let folder = Folder::new("warnings-linearize");
    let joint = of_repository("examples/linearize-joint.toml").display().to_string();
    let stiffness = |value: &str| {
        let output = run(&folder, &["linearize", &joint, "--angle", "0 deg", "--stiffness", value]);
        assert!(output.status.success(), "{}", flat(&output.stderr));
        flat(&output.stdout)
    };
    assert!(!stiffness("1 N*m/rad").contains("exceeds supply"));
    assert!(stiffness("8 N*m/rad").contains("exceeds supply.gauge_pressure = "), "{}", stiffness("8 N*m/rad"));
}

#[test]
fn the_summary_as_json_has_numbers_with_units_events_warnings_and_assumed_values() {
    let folder = Folder::new("summary-json");
    folder.file("muscle.toml", &muscle());
    let arguments =
        ["simulate", "muscle.toml", "--format", "json", "--output", "run.csv", "--set", "command.duty=0.05"];
    let output = run(&folder, &arguments);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", flat(&output.stderr));
    let found = json(&output);
    assert_eq!((&found["scenario"], &found["duration_s"]), (&"muscle.toml".into(), &0.1.into()));
    // The last row of the file has the same length.
    let text = std::fs::read_to_string(folder.path("run.csv")).expect("written");
    let last: f64 =
        text.lines().last().and_then(|row| row.split(',').nth(1)).expect("a length").parse().expect("a number");
    assert_eq!(found["numbers"]["length_final_m"].as_f64(), Some(last));
    assert!(found["numbers"]["gauge_pressure_max_pa"].is_f64() && found["events"].is_object());
    let warnings = found["warnings"].as_array().expect("a list");
    assert_eq!(
        (warnings.len(), &warnings[0]["code"], &warnings[0]["part"]),
        (1, &"valve-never-opens".into(), &"".into())
    );
    assert!(warnings[0]["text"].as_str().is_some_and(|text| text.starts_with(NEVER_OPENS)));
    let assumed = found["assumed"].as_array().expect("a list");
    assert!(assumed.iter().any(|of| of["key"] == "actuator.turns" && of["value"] == "2.5"), "{assumed:?}");
    // Joints and plants have one too, and equal runs have equal bytes.
    for file in ["examples/antagonistic-joint.toml", "examples/plant/arm.toml"] {
        let file = of_repository(file).display().to_string();
        let arguments = ["simulate", &file, "--format", "json", "--set", "run.duration=0.1 s"];
        let first = run(&folder, &arguments);
        assert!(json(&first)["numbers"].as_object().is_some_and(|numbers| numbers.len() > 10));
        assert_eq!(first.stdout, run(&folder, &arguments).stdout);
    }
    for option in ["--quiet", "--events"] {
        assert_eq!(run(&folder, &["simulate", "muscle.toml", "--format", "json", option]).status.code(), Some(2));
    }
}

#[test]
fn a_scenario_comes_from_standard_input() {
    let folder = Folder::new("standard-input");
    folder.file("muscle.toml", &muscle());
    let given = |arguments: &[&str], text: &str| {
        folder.mckibben().args(arguments).write_stdin(text).output().expect("the program runs")
    };
    let output = given(&["simulate", "-", "--output", "streamed.csv"], &muscle());
    assert!(output.status.success(), "{}", flat(&output.stderr));
    assert!(flat(&output.stdout).starts_with("standard input"));
    assert!(run(&folder, &["simulate", "muscle.toml", "--output", "read.csv"]).status.success());
    let bytes = |name: &str| std::fs::read(folder.path(name)).expect("written");
    assert!(bytes("streamed.csv") == bytes("read.csv"));
    assert!(given(&["check", "-"], &muscle()).status.success());
    let output = given(&["check", "-"], &muscle().replace("duty", "dutie"));
    assert_eq!(output.status.code(), Some(2));
    assert!(flat(&output.stderr).contains("standard input:8:1"), "{}", flat(&output.stderr));
}

#[test]
fn a_table_or_a_binary_file_in_place_of_a_scenario_is_one_message() {
    let folder = Folder::new("no-scenario");
    folder.file("muscle.toml", &muscle());
    for (output, words) in [("run.csv", "is a table of 11 columns in CSV"), ("run.parquet", "is a Parquet file")] {
        assert!(run(&folder, &["simulate", "muscle.toml", "--output", output]).status.success());
        for command in ["simulate", "check", "sweep", "linearize", "curves"] {
            let found = run(&folder, &[command, output]);
            let message = String::from_utf8_lossy(&found.stderr).into_owned();
            assert_eq!(found.status.code(), Some(2), "{command}: {message}");
            assert!(message.contains(words) && message.lines().count() < 8, "{command}: {message}");
        }
    }
}

/// Keys of the steps of hosts: a note and no warning, of files that are run by located events alone.
#[test]
fn steps_that_no_run_takes_are_noted() {
    let folder = Folder::new("warnings-steps");
    let steps = muscle().replace("[run]\n", "[run]\nstep = \"0.1 ms\"\naccuracy = 1e-3\n");
    folder.file("muscle.toml", &steps);
    folder.file("sweep.toml", &format!("{steps}[sweep.vary]\n\"load.mass\" = [\"5 lb\"]\n"));
    let noted = |arguments: &[&str]| {
        let output = run(&folder, arguments);
        assert!(output.status.success(), "{}", flat(&output.stderr));
        flat(&output.stderr)
    };
    let words = "run.step and run.accuracy take no part in `mckibben simulate`";
    for strict in [&[][..], &["--strict"]] {
        let of = |command: &[&str]| noted(&[command, strict].concat());
        assert!(of(&["simulate", "muscle.toml"]).starts_with(&format!("note: {words}")));
        assert!(of(&["check", "muscle.toml"]).starts_with(&format!("note: muscle.toml: {words}")));
    }
    let fixed = ["--set", "run.engine=fixed-step"];
    for silent in [
        vec!["simulate", "muscle.toml", "--quiet"],
        [&["simulate", "muscle.toml"][..], &fixed].concat(),
        [&["check", "muscle.toml"][..], &fixed].concat(),
        vec!["check", "sweep.toml"],
    ] {
        assert!(!noted(&silent).contains("note:"), "{silent:?}");
    }
    folder.file("plain.toml", &muscle());
    assert!(!noted(&["check", "plain.toml"]).contains("note:"));
}
