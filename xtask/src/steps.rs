//! The steps of the check, in order, and the summary at the end.

use crate::book;
use crate::c;
use crate::counts::{Counts, rust_tests};
use crate::python;
use crate::words as vocabulary;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

/// A step's name and what it does; an error says in words what went wrong.
type Step = (&'static str, fn(&Path) -> Result<Counts, String>);

/// Variables that change what a test does: nothing that the shell happens to hold may change the check.
const CLEARED: [&str; 2] = ["MCKIBBEN_", "PROPTEST_"];

const STEPS: [Step; 9] = [
    ("format", format),
    ("lint", lint),
    ("docs", docs),
    ("no-std", no_std),
    ("reference", reference),
    ("test", test),
    ("package", package),
    ("python", python_package),
    ("book", book::book),
];

/// Runs the chosen steps, or all of them, and prints what ran.
pub(crate) fn run(chosen: &[String]) -> ExitCode {
    if let Some(unknown) = chosen.iter().find(|name| !STEPS.iter().any(|(step, _)| step == name)) {
        eprintln!("there is no step `{unknown}`");
        return ExitCode::from(2);
    }
    let root = root();
    for (name, _) in set_outside() {
        println!("{} is set, and ignored: it would change what is tested", name.to_string_lossy());
    }
    let mut report: Vec<(&str, Duration, Result<Counts, String>)> = Vec::new();
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

fn summary(report: &[(&str, Duration, Result<Counts, String>)]) -> ExitCode {
    println!("\n{:<12}{:>9}  outcome", "step", "time");
    let mut total = Counts::NONE;
    for (name, time, outcome) in report {
        let words = match outcome {
            Ok(Counts { passed: 0, failed: 0, .. }) => {
                total.passed += 1;
                "passed".to_owned()
            }
            Ok(counts) => {
                total.add(counts);
                format!("{} tests passed, {} failed, {} not run", counts.passed, counts.failed, counts.skipped)
            }
            Err(problem) => {
                total.failed += 1;
                format!("FAILED: {problem}")
            }
        };
        println!("{name:<12}{:>7.1} s  {words}", time.as_secs_f64());
        for note in outcome.iter().flat_map(|counts| &counts.notes) {
            println!("{:<23}{note}", "");
        }
    }
    println!("\n{} passed, {} failed, {} skipped", total.passed, total.failed, total.skipped);
    if total.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

pub(crate) fn cargo(root: &Path) -> Command {
    command(root, std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// A program that runs in the repository, without the variables that would change what is tested.
pub(crate) fn command(root: &Path, program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.current_dir(root);
    for (name, _) in set_outside() {
        command.env_remove(name);
    }
    command
}

fn set_outside() -> impl Iterator<Item = (OsString, OsString)> {
    std::env::vars_os().filter(|(name, _)| CLEARED.iter().any(|prefix| name.to_string_lossy().starts_with(prefix)))
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

pub(crate) fn words(command: &Command) -> String {
    let name = Path::new(command.get_program()).file_name().unwrap_or_default().to_string_lossy().into_owned();
    command.get_args().fold(name, |line, word| format!("{line} {}", word.to_string_lossy()))
}

fn format(root: &Path) -> Result<Counts, String> {
    succeed(cargo(root).args(["fmt", "--all", "--check"]))?;
    succeed(cargo(root).args(["fmt", "--all", "--check"]).current_dir(root.join("benches"))).map(|()| Counts::NONE)
}

fn lint(root: &Path) -> Result<Counts, String> {
    vocabulary::check(root)?;
    let mut command = cargo(root);
    command.args(["clippy", "--workspace", "--all-targets", "--locked", "--", "--deny", "warnings"]);
    succeed(&mut command)?;
    // The benchmark is a separate workspace; it must go on fitting the core.
    let mut benchmark = cargo(&root.join("benches"));
    benchmark.args(["clippy", "--all-targets", "--locked", "--", "--deny", "warnings"]);
    succeed(benchmark.env("CARGO_TARGET_DIR", root.join("target"))).map(|()| Counts::NONE)
}

fn docs(root: &Path) -> Result<Counts, String> {
    let mut command = cargo(root);
    command.args(["doc", "--workspace", "--no-deps", "--locked"]).env("RUSTDOCFLAGS", "--deny warnings");
    succeed(&mut command).map(|()| Counts::NONE)
}

/// The core without the standard library: with and without an allocator it compiles, and its laws and tables keep their
/// tests with the mathematics of `libm`.
fn no_std(root: &Path) -> Result<Counts, String> {
    let core = |verb: &str, features: &str| {
        let mut command = cargo(root);
        command.args([verb, "--package", "mckibben", "--no-default-features", "--features", features, "--locked"]);
        command.env("RUSTFLAGS", "--deny warnings").env("CARGO_TARGET_DIR", root.join("target/no-std"));
        // Its tests take seconds without optimisation, which takes a minute.
        command.env("CARGO_INCREMENTAL", "0").env("CARGO_PROFILE_TEST_OPT_LEVEL", "0");
        command
    };
    succeed(&mut core("check", "libm"))?;
    succeed(&mut core("check", "libm,alloc"))?;
    rust_tests(core("test", "libm,alloc").args(["--test", "parts"]))
}

/// The independent reference trajectories, computed again.
fn reference(root: &Path) -> Result<Counts, String> {
    python::reference(root).map(|()| Counts::NONE)
}

/// The Python package: built, its stubs as they are kept, its tests and its types.
fn python_package(root: &Path) -> Result<Counts, String> {
    python::package(root)
}

/// Every crate that would be published makes a package, and includes nothing from outside itself. `cargo xtask dist` compiles them
/// from their packages, which takes a quarter of an hour.
fn package(root: &Path) -> Result<Counts, String> {
    succeed(packages(root).arg("--no-verify"))?;
    let crates = std::fs::read_dir(root.join("crates")).map_err(|error| format!("crates: {error}"))?;
    for folder in crates.filter_map(|entry| Some(entry.ok()?.path())) {
        included_within(&folder, &folder.join("src"))?;
    }
    Ok(Counts::NONE)
}

/// Packs every crate that would be published.
pub(crate) fn packages(root: &Path) -> Command {
    let mut command = cargo(root);
    command.args(["package", "--workspace", "--exclude", "xtask", "--exclude", "mckibben-python"]);
    command.args(["--locked", "--allow-dirty", "--quiet"]);
    command
}

/// That what the files of a folder include lies within their crate.
fn included_within(its: &Path, folder: &Path) -> Result<(), String> {
    let listed = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for path in listed.filter_map(|entry| Some(entry.ok()?.path())) {
        if path.is_dir() {
            included_within(its, &path)?;
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let included = text.lines().filter(|line| line.contains("include_str!") || line.contains("include_bytes!"));
        for file in included.filter_map(|line| line.split('"').nth(1)) {
            let depth = folder.strip_prefix(its).map_or(0, |inside| inside.components().count());
            if file.matches("../").count() > depth {
                return Err(format!("{} includes `{file}`, which its package does not hold", path.display()));
            }
        }
    }
    Ok(())
}

/// Every test of the workspace, the examples in the documentation included.
fn test(root: &Path) -> Result<Counts, String> {
    c::tools(root)?;
    let mut command = cargo(root);
    command.args(["test", "--workspace", "--locked", "--no-fail-fast"]);
    command.env("MCKIBBEN_REFERENCE", python::reference_folder(root));
    // What is compiled once keeps nothing for the next time.
    rust_tests(command.env("CARGO_INCREMENTAL", "0"))
}

/// Writes the page on the accuracy of the fixed-step engine: the test that holds it to what is measured does so on
/// request.
pub(crate) fn accuracy() -> ExitCode {
    let mut command = cargo(&root());
    command.args([
        "test",
        // As the check compiles it: then all is there already.
        "--workspace",
        "--test",
        "commands",
        "--locked",
        "--",
        "--nocapture",
        "accuracy::the_page",
    ]);
    ended(succeed(command.env("MCKIBBEN_WRITE", "1")))
}

pub(crate) fn rows(count: Option<&String>) -> ExitCode {
    let count = count.map_or("10000000", String::as_str);
    let mut command = cargo(&root());
    command.args(["test", "--release", "--package", "mckibben-batch", "--locked", "--"]);
    command.args(["--nocapture", "plant_rows::any_admissible_row"]);
    ended(succeed(command.env("MCKIBBEN_CASES", count)))
}

/// The exit code of an outcome, whose problem is printed.
pub(crate) fn ended(outcome: Result<(), String>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}
