//! The Python side: an environment of its own, the reference trajectories made in it, and the package with its tests.

use crate::steps::{cargo, counted, succeed};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The stubs of what is compiled of the package: made from it, and kept beside it for who installs the package.
const STUBS: &str = "python/mckibben/_mckibben.pyi";
/// As the tests are compiled: then everything but the package's own crate is there already.
const AS_TESTS: [(&str, &str); 2] = [("CARGO_PROFILE_DEV_OPT_LEVEL", "2"), ("CARGO_INCREMENTAL", "0")];

/// Where the reference trajectories lie.
pub(crate) fn reference_folder(root: &Path) -> PathBuf {
    root.join("target/reference")
}

/// Computes the reference trajectory of every scenario under `validation/reference`.
pub(crate) fn reference(root: &Path) -> Result<(), String> {
    let python = environment(root, "validation/requirements.txt")?;
    let folder = reference_folder(root);
    std::fs::create_dir_all(&folder).map_err(|error| format!("{} could not be made: {error}", folder.display()))?;
    let script = root.join("validation/reference.py");
    let mut scenarios: Vec<PathBuf> = std::fs::read_dir(root.join("validation/reference"))
        .map_err(|error| format!("validation/reference could not be read: {error}"))?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    scenarios.sort();
    for scenario in &scenarios {
        let name = scenario.file_stem().unwrap_or_default();
        let output = folder.join(name).with_extension("csv");
        succeed(Command::new(&python).arg(&script).arg(scenario).arg("--output").arg(output))?;
    }
    println!("{} reference trajectories", scenarios.len());
    Ok(())
}

/// Builds the package and runs its tests; how many passed and how many failed.
pub(crate) fn package(root: &Path) -> Result<(u64, u64), String> {
    let python = environment(root, "python/tests/requirements.txt")?;
    let stubs = || std::fs::read_to_string(root.join(STUBS)).unwrap_or_default();
    let kept = stubs();
    let mut build = Command::new(&python);
    build.current_dir(root).args([
        "-m",
        "maturin",
        "develop",
        "--locked",
        "--generate-stubs",
        "--features",
        "as-tests",
    ]);
    build.envs(AS_TESTS);
    succeed(build.env("VIRTUAL_ENV", root.join(".venv")))?;
    if stubs() != kept {
        return Err(format!("{STUBS} was not what the package is now: it has been made anew, and is to be committed"));
    }
    // What its runs are compared with.
    let mut program = cargo(root);
    program.args([
        "build",
        "--locked",
        "--bin",
        "mckibben",
        "--package",
        "mckibben-cli",
        "--package",
        "mckibben-python",
    ]);
    succeed(program.args(["--features", "mckibben-python/as-tests"]).envs(AS_TESTS))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let mut tests = Command::new(&python);
    tests.current_dir(root).args(["-m", "pytest", "--quiet", "--durations=5"]);
    counted(
        tests.env("MCKIBBEN_PROGRAM", target.join("debug/mckibben").with_extension(std::env::consts::EXE_EXTENSION)),
    )
}

/// The interpreter of `.venv`, which is made if it is not there, with the packages that a file lists.
fn environment(root: &Path, requirements: &str) -> Result<PathBuf, String> {
    let folder = root.join(".venv");
    let scripts = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = scripts.join(if cfg!(windows) { "python.exe" } else { "python" });
    if !python.exists() {
        let system = if cfg!(windows) { "python" } else { "python3" };
        succeed(Command::new(system).args(["-m", "venv"]).arg(&folder))?;
    }
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"]);
    succeed(install.arg(root.join(requirements)))?;
    Ok(python)
}
