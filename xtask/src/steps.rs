//! The steps of the check, in order, and the summary at the end.

use crate::python;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

/// Tests that passed and failed in a step; `None` for a step that runs no tests of its own.
type Tally = Option<(u64, u64)>;

/// A step's name and what it does; an error says in words what went wrong.
type Step = (&'static str, fn(&Path) -> Result<Tally, String>);

const STEPS: [Step; 7] = [
    ("format", format),
    ("lint", lint),
    ("docs", docs),
    ("no-std", no_std),
    ("reference", reference),
    ("test", test),
    ("python", python_package),
];

/// Runs the chosen steps, or all of them, and prints what ran.
pub(crate) fn run(chosen: &[String]) -> ExitCode {
    if let Some(unknown) = chosen.iter().find(|name| !STEPS.iter().any(|(step, _)| step == name)) {
        eprintln!("there is no step `{unknown}`");
        return ExitCode::from(2);
    }
    let root = root();
    let mut report: Vec<(&str, Duration, Result<Tally, String>)> = Vec::new();
    for (name, step) in STEPS {
        if !chosen.is_empty() && !chosen.iter().any(|wanted| wanted == name) {
            continue;
        }
        println!("\n== {name}");
        let begun = Instant::now();
        let outcome = step(&root);
        if let Err(problem) = &outcome {
            println!("{name}: {problem}");
        }
        report.push((name, begun.elapsed(), outcome));
    }
    summary(&report)
}

fn summary(report: &[(&str, Duration, Result<Tally, String>)]) -> ExitCode {
    println!("\n{:<12}{:>9}  outcome", "step", "time");
    let (mut passed, mut failed) = (0, 0);
    for (name, time, outcome) in report {
        let words = match outcome {
            Ok(Some((good, bad))) => {
                passed += good;
                failed += bad;
                format!("{good} tests passed, {bad} failed")
            }
            Ok(None) => {
                passed += 1;
                "passed".to_owned()
            }
            Err(problem) => {
                failed += 1;
                format!("FAILED: {problem}")
            }
        };
        println!("{name:<12}{:>7.1} s  {words}", time.as_secs_f64());
    }
    println!("\n{passed} passed, {failed} failed");
    if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

pub(crate) fn cargo(root: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root);
    command
}

/// Runs a command to its end; its output goes where ours goes.
pub(crate) fn succeed(command: &mut Command) -> Result<(), String> {
    let line = words(command);
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`{line}` ended with {status}")),
        Err(error) => Err(format!("`{line}` could not be started: {error}")),
    }
}

fn words(command: &Command) -> String {
    let name = Path::new(command.get_program()).file_name().unwrap_or_default().to_string_lossy().into_owned();
    command.get_args().fold(name, |line, word| format!("{line} {}", word.to_string_lossy()))
}

fn format(root: &Path) -> Result<Tally, String> {
    succeed(cargo(root).args(["fmt", "--all", "--check"]))?;
    succeed(cargo(root).args(["fmt", "--all", "--check"]).current_dir(root.join("benches"))).map(|()| None)
}

fn lint(root: &Path) -> Result<Tally, String> {
    let mut command = cargo(root);
    command.args(["clippy", "--workspace", "--all-targets", "--locked", "--", "--deny", "warnings"]);
    succeed(&mut command)?;
    // The benchmark is a workspace of its own; it must go on fitting the core.
    let mut benchmark = cargo(&root.join("benches"));
    benchmark.args(["clippy", "--all-targets", "--locked", "--", "--deny", "warnings"]);
    succeed(benchmark.env("CARGO_TARGET_DIR", root.join("target"))).map(|()| None)
}

fn docs(root: &Path) -> Result<Tally, String> {
    let mut command = cargo(root);
    command.args(["doc", "--workspace", "--no-deps", "--locked"]).env("RUSTDOCFLAGS", "--deny warnings");
    succeed(&mut command).map(|()| None)
}

/// The core without the standard library, with and without an allocator.
fn no_std(root: &Path) -> Result<Tally, String> {
    for features in ["libm", "libm,alloc"] {
        let mut command = cargo(root);
        command.args(["check", "--package", "mckibben", "--no-default-features", "--features", features, "--locked"]);
        succeed(command.env("RUSTFLAGS", "--deny warnings").env("CARGO_TARGET_DIR", root.join("target/no-std")))?;
    }
    Ok(None)
}

/// The independent reference trajectories, computed anew.
fn reference(root: &Path) -> Result<Tally, String> {
    python::reference(root).map(|()| None)
}

/// The Python package: built, its stubs as they are kept, its tests and its types.
fn python_package(root: &Path) -> Result<Tally, String> {
    python::package(root).map(Some)
}

/// Runs pytest, and counts what it says of passed and failed tests.
pub(crate) fn counted(tests: &mut Command) -> Result<(u64, u64), String> {
    // The last line has the counts.
    tallied(tests, |(passed, failed), line| {
        (*passed, *failed) =
            (count_before(line, " passed"), count_before(line, " failed") + count_before(line, " error"));
    })
}

/// Runs tests, shows what they say, and counts by each line those that passed and those that failed.
fn tallied(tests: &mut Command, see: impl Fn(&mut (u64, u64), &str)) -> Result<(u64, u64), String> {
    let line = words(tests);
    let lost = |error| format!("`{line}` could not be run: {error}");
    let mut child = tests.stdout(Stdio::piped()).spawn().map_err(lost)?;
    let mut counts = (0, 0);
    if let Some(output) = child.stdout.take() {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            println!("{line}");
            see(&mut counts, &line);
        }
    }
    let status = child.wait().map_err(lost)?;
    if status.success() || counts.1 > 0 { Ok(counts) } else { Err(format!("`{line}` ended with {status}")) }
}

/// Every test of the workspace, the examples in the documentation included.
fn test(root: &Path) -> Result<Tally, String> {
    let mut command = cargo(root);
    command.args(["test", "--workspace", "--locked", "--no-fail-fast"]);
    command.env("MCKIBBEN_REFERENCE", python::reference_folder(root));
    // What is compiled once keeps nothing for the next time.
    command.env("CARGO_INCREMENTAL", "0");
    let tally = tallied(&mut command, |(passed, failed), line| {
        if let Some(counts) = line.strip_prefix("test result: ") {
            *passed += count_before(counts, " passed");
            *failed += count_before(counts, " failed");
        }
    });
    tally.map(Some)
}

/// Writes the page on the accuracy of the fixed-step engine: the test that holds it to what is measured does so when asked.
pub(crate) fn accuracy() -> ExitCode {
    let mut command = cargo(&root());
    command.args([
        "test",
        "--package",
        "mckibben-cli",
        "--test",
        "accuracy",
        "--locked",
        "--",
        "--nocapture",
        "the_page",
    ]);
    ended(succeed(command.env("MCKIBBEN_WRITE", "1")))
}

pub(crate) fn rows(count: Option<&String>) -> ExitCode {
    let count = count.map_or("10000000", String::as_str);
    let mut command = cargo(&root());
    command.args(["test", "--release", "--package", "mckibben", "--test", "runs", "--locked", "--"]);
    command.args(["--nocapture", "batch::any_admissible_row"]);
    ended(succeed(command.env("MCKIBBEN_CASES", count)))
}

fn ended(outcome: Result<(), String>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

/// The number that stands before a word: 12 for ` passed` in `ok. 12 passed; 0 failed`.
fn count_before(line: &str, word: &str) -> u64 {
    line.split_once(word)
        .and_then(|(before, _)| before.rsplit(|c: char| !c.is_ascii_digit()).next())
        .and_then(|digits| digits.parse().ok())
        .unwrap_or(0)
}
