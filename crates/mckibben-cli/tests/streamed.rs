//! Event-located runs of `mckibben simulate` that are written as they are made: the bytes of a run that is kept, in memory that
//! does not grow with the run; what has no measure is refused with its count, and what is not finite is an error.

use crate::common::{Folder, PULSES, of_repository};
use std::path::Path;
use std::process::Output;

fn simulate(folder: &Folder, arguments: &[&str]) -> Output {
    folder.mckibben().arg("simulate").args(arguments).output().expect("the program runs")
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The summary but for how long it took and what was written.
fn figures(output: &Output) -> Vec<String> {
    assert!(output.status.success(), "{}", said(output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let same = |line: &&str| !line.trim_start().starts_with("cost") && !line.starts_with("wrote");
    text.lines().filter(same).map(str::to_owned).collect()
}

/// With a figure a run is kept, and without one it is not: that is all that differs.
#[test]
fn a_run_that_is_not_kept_has_the_bytes_and_the_figures_of_one_that_is() {
    let folder = Folder::new("streamed");
    let files = [
        "paper/fig-12.toml",
        "line/hanging-mass.toml",
        "tendon.toml",
        "antagonistic-joint.toml",
        "line/joint.toml",
        "control/pid.toml",
        "control/joint-bang-bang.toml",
        "control/joint-air-mass.toml",
        "plant/bottle.toml",
        "plant/controlled.toml",
    ];
    for file in files {
        let text = std::fs::read_to_string(of_repository("examples").join(file)).expect("an example");
        folder.file("it.toml", &text);
        let short = ["it.toml", "-s", "run.duration=0.25 s", "-s", "run.sample_interval=0.7 ms"];
        let short = [&short[..], &["-s", "run.engine=event-located"]].concat();
        for ending in ["csv", "parquet"] {
            let [streamed, kept] = ["streamed", "kept"].map(|name| format!("{name}.{ending}"));
            let first = simulate(&folder, &[&short[..], &["-o", &streamed]].concat());
            let second = simulate(&folder, &[&short[..], &["-o", &kept, "-p", "figure.svg"]].concat());
            assert_eq!(figures(&first), figures(&second), "{file}");
            let [streamed, kept] = [streamed, kept].map(|name| std::fs::read(folder.path(&name)).expect("written"));
            assert!(kept.len() > 10_000 && streamed == kept, "{file}: {ending} differs");
        }
    }
}

/// The address space that a process may have, in KiB, is what a run of any length makes do with. Ten thousand pulses keep about
/// four times as much, where they are kept.
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_run() {
    const KIBIBYTES: u32 = 128 * 1024;
    let folder = Folder::new("memory");
    folder.file("muscle.toml", PULSES);
    let program = Path::new(env!("CARGO_BIN_EXE_mckibben"));
    let simulate = |more: &str| {
        let command = format!(
            "ulimit -v {KIBIBYTES} && exec '{}' simulate muscle.toml -s 'run.duration=400 s' -s 'run.sample_interval=0.1 s' {more}",
            program.display()
        );
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", &command]).current_dir(folder.path("")).output().expect("a shell")
    };
    for (file, more) in [("run.csv", ""), ("run.parquet", ""), ("run.csv", "\n[actuators.muscle]\n")] {
        folder.file("muscle.toml", &format!("{PULSES}{more}"));
        let done = simulate(&format!("-o {file}"));
        assert!(done.status.success(), "{file}: {}", said(&done));
        assert!(said(&done).contains("4001 rows"), "{}", said(&done));
    }
    // The limit is one: what keeps every step does not get by with it.
    assert!(!simulate("--events -q").status.success());
}

#[test]
fn counts_without_measure_are_refused_with_the_count() {
    let folder = Folder::new("counts");
    folder.file("muscle.toml", PULSES);
    for (name, file) in [("control.toml", "control/pid.toml"), ("joint.toml", "antagonistic-joint.toml")] {
        let text = std::fs::read_to_string(of_repository("examples").join(file)).expect("an example");
        folder.file(name, &text);
    }
    let fixed = "run.engine=fixed-step";
    let cases: [(&str, &[&str], &str, &str); 9] = [
        ("muscle.toml", &["run.sample_interval=1e-22 s"], "run.sample_interval", "3.000e21 samples"),
        ("muscle.toml", &["run.sample_interval=1e-300 s"], "run.sample_interval", "3.000e299 samples"),
        ("muscle.toml", &["run.sample_interval=1e-22 s", fixed], "run.sample_interval", "3.000e21 samples"),
        ("muscle.toml", &["run.sample_interval=0.1 ns"], "run.sample_interval", "3.000e9 samples"),
        ("muscle.toml", &["run.step=1e-12 s", fixed], "run.step", "3.000e11 steps"),
        ("muscle.toml", &["command.frequency=1e15 Hz"], "command.frequency", "3.000e14 pulses"),
        ("muscle.toml", &["command.frequency=1e15 Hz", fixed], "command.frequency", "3.000e14 pulses"),
        ("joint.toml", &["run.duration=1 s", "run.sample_interval=1e-22 s"], "run.sample_interval", "1.000e22 samples"),
        ("joint.toml", &["run.duration=1 s", "run.step=1e-12 s", fixed], "run.step", "1.000e12 steps"),
    ];
    for (file, settings, key, count) in cases {
        let set: Vec<&str> = settings.iter().flat_map(|setting| ["-s", setting]).collect();
        let refused = simulate(&folder, &[&[file, "-o", "run.csv"], &set[..]].concat());
        let words = said(&refused);
        assert_eq!(refused.status.code(), Some(2), "{settings:?}: {words}");
        assert!(words.contains(key) && words.contains(count), "{settings:?}: {words}");
        assert!(!folder.path("run.csv").exists());
    }
    let rate = ["control.toml", "-s", "run.duration=1 s", "-s", "controller.rate=1e12 Hz"];
    let words = said(&simulate(&folder, &rate));
    assert!(words.contains("controller.rate") && words.contains("1.000e12 samples of the controller"), "{words}");
}

/// The exergy of air from an impossibly hot supply overflows: it was printed as `NaN J`, with success.
#[test]
fn what_is_not_finite_is_an_error_and_nothing_is_written() {
    let folder = Folder::new("finite");
    folder.file("muscle.toml", PULSES);
    for kept in [&[][..], &["-p", "run.svg"]] {
        let hot = ["muscle.toml", "-s", "supply.temperature=1e300 K", "-o", "run.csv"];
        let failed = simulate(&folder, &[&hot[..], kept].concat());
        assert_eq!(failed.status.code(), Some(3), "{}", said(&failed));
        assert!(said(&failed).contains("is not a finite number"), "{}", said(&failed));
        assert_eq!(folder.names(), ["muscle.toml"]);
    }
}

/// A muscle that is held sealed at one length exchanges nothing: what is left of nothing is no share of a turnover.
#[test]
fn a_turnover_that_is_rounding_is_called_so() {
    let folder = Folder::new("rounding");
    let held = "[load]\nkind = \"isometric\"\n[initial]\nlength = \"3.5 in\"\ngauge_pressure = \"3 bar\"\n";
    folder.file("held.toml", &format!("{held}[run]\nduration = \"0.2 s\""));
    let done = simulate(&folder, &["held.toml", "--verbose"]);
    let words = said(&done);
    assert!(done.status.success() && words.contains("within rounding, which may leave"), "{words}");
    assert!(!words.contains("of the turnover") && !words.contains("last bit"), "{words}");
}
