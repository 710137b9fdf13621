//! The Python side: a separate environment, the reference trajectories made in it, and the package with its tests.

use crate::c;
use crate::counts::{Counts, pytest};
use crate::dist::empty;
use crate::steps::{cargo, command, succeed};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The stubs of what is compiled of the package: made from it, and kept with it for users who install the package.
const STUBS: &str = "python/mckibben/_mckibben.pyi";
/// The crate that is compiled of the package.
const PACKAGE: &str = "mckibben-python";
/// The oldest MuJoCo that is tested.
const OLDEST_MUJOCO: &str = "3.2.7";
/// As the tests are compiled: then everything but the package's own crate is there already.
pub(crate) const AS_TESTS: [(&str, &str); 2] = [("CARGO_PROFILE_DEV_OPT_LEVEL", "1"), ("CARGO_INCREMENTAL", "0")];

/// Where the reference trajectories lie.
pub(crate) fn reference_folder(root: &Path) -> PathBuf {
    root.join("target/reference")
}

/// Computes the reference trajectory of every scenario under `validation/reference`, and of the plants that no scenario
/// describes.
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
    succeed(command(root, &python).arg(&script).args(&scenarios).arg("--folder").arg(&folder))?;
    succeed(command(root, &python).arg(root.join("validation/plants.py")).arg(folder.join("plants")))?;
    println!("{} reference trajectories", scenarios.len());
    Ok(())
}

/// Builds the package and runs its tests. Those marked `blas` run with each of OpenBLAS's kernels that the processor has:
/// what they claim must not depend on how a matrix product is rounded.
pub(crate) fn package(root: &Path) -> Result<Counts, String> {
    c::tools(root)?;
    let python = environment(root, "python/tests/requirements.txt")?;
    let stubs = || std::fs::read_to_string(root.join(STUBS)).unwrap_or_default();
    let kept = stubs();
    check_features(root)?;
    let mut build = command(root, &python);
    build.args(["-m", "maturin", "develop", "--locked", "--generate-stubs", "--features", "as-tests"]);
    build.envs(AS_TESTS);
    succeed(build.env("VIRTUAL_ENV", root.join(".venv")))?;
    if stubs() != kept {
        return Err(format!("{STUBS} was not what the package is now: it has been rewritten, and is to be committed"));
    }
    // Before Cargo alone builds, for which the bindings to Python would be compiled again.
    let wheels = root.join("target/wheels-tried");
    empty(&wheels)?;
    let mut build = command(root, &python);
    build.args(["-m", "maturin", "build", "--locked", "--profile", "dev", "--features", "as-tests", "--out"]);
    succeed(build.arg(&wheels).envs(AS_TESTS))?;
    installs(root, &wheels)?;
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
    // The plugin as a separate library, which registers itself; with the package, so that all else is compiled already.
    let mut plugin = cargo(root);
    plugin.args(["build", "--locked", "--package", "mckibben-mujoco", "--package", "mckibben-python", "--features"]);
    succeed(plugin.arg("mckibben-mujoco/register-on-load,mckibben-python/as-tests").envs(AS_TESTS))?;
    let name = format!("{}mckibben_mujoco{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let plugin = target_folder(root).join("debug").join(name);
    let program = target_folder(root).join("debug/mckibben").with_extension(std::env::consts::EXE_EXTENSION);
    let tests = || {
        let mut tests = command(root, &python);
        tests
            .args(["-m", "pytest", "--quiet", "--durations=5", "--numprocesses=auto"])
            .env("MCKIBBEN_PROGRAM", &program);
        tests.env("MCKIBBEN_MUJOCO", &plugin);
        tests
    };
    let mut counts = pytest(&mut tests())?;
    for kernel in blas_kernels() {
        println!("\nwith OPENBLAS_CORETYPE={kernel}");
        let again = pytest(tests().args(["-m", "blas"]).env("OPENBLAS_CORETYPE", kernel))?;
        // What was skipped has been counted.
        (counts.passed, counts.failed) = (counts.passed + again.passed, counts.failed + again.failed);
    }
    counts.passed += oldest_mujoco(root, &python, &mut tests())?.passed;
    counts.passed += 1;
    counts.notes.push(format!("OpenBLAS kernels: the default, {}", blas_kernels().join(", ")));
    Ok(counts)
}

/// That the package needs no crate with other features than the tests have compiled it with: each would be compiled again, with
/// all that uses it.
fn check_features(root: &Path) -> Result<(), String> {
    let features_of = |arguments: &[&str]| -> Result<BTreeMap<String, BTreeSet<String>>, String> {
        let mut tree = cargo(root);
        tree.args(["tree", "--locked", "--prefix", "none", "--no-dedupe", "--format", "{p}|{f}"]).args(arguments);
        let printed = tree.output().map_err(|error| format!("`cargo tree` could not be started: {error}"))?;
        let mut features: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (package, its) in String::from_utf8_lossy(&printed.stdout).lines().filter_map(|line| line.split_once('|')) {
            features.entry(package.to_owned()).or_default().insert(its.to_owned());
        }
        Ok(features)
    };
    let tests = features_of(&["--workspace", "--edges", "normal,build,dev"])?;
    let package = features_of(&["--package", PACKAGE, "--features", "as-tests", "--edges", "normal,build"])?;
    let is_other = |(package, its): &(&String, &BTreeSet<String>)| {
        !package.starts_with(PACKAGE) && tests.get(*package).is_some_and(|compiled| !its.is_subset(compiled))
    };
    let others: Vec<String> =
        package.iter().filter(is_other).map(|(package, its)| format!("{package} {its:?}")).collect();
    if others.is_empty() {
        return Ok(());
    }
    Err(format!("the feature `as-tests` of {PACKAGE} is to ask for what the tests ask of {}", others.join(", ")))
}

/// Runs the tests in MuJoCo with the oldest version that the plugin knows; those before have run with the newest.
fn oldest_mujoco(root: &Path, python: &Path, tests: &mut Command) -> Result<Counts, String> {
    let folder = root.join("target/mujoco").join(OLDEST_MUJOCO);
    if !folder.exists() {
        let mut install = command(root, python);
        install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--target"]);
        succeed(install.arg(&folder).arg(format!("mujoco=={OLDEST_MUJOCO}")))?;
    }
    println!("\nwith MuJoCo {OLDEST_MUJOCO}");
    pytest(tests.arg("python/tests/test_mujoco.py").env("PYTHONPATH", &folder))
}

/// Installs the wheel that lies in a folder into a separate environment, on a path without Cargo, and tries it there.
pub(crate) fn installs(root: &Path, folder: &Path) -> Result<(), String> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| format!("{} could not be read: {error}", folder.display()))?;
    let mut wheels = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let wheel = wheels.find(|path| path.extension().is_some_and(|ending| ending == "whl"));
    let wheel = wheel.ok_or_else(|| format!("there is no wheel in {}", folder.display()))?;
    let clean = root.join("target/clean-environment");
    empty(&clean)?;
    succeed(command(root, system_python()).args(["-m", "venv"]).arg(&clean))?;
    let (python, path) = (interpreter(&clean), without_cargo());
    let here = || {
        let mut here = command(&clean, &python);
        here.env("PATH", &path);
        here
    };
    succeed(here().args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).arg(&wheel))?;
    let (script, scenario) = (root.join("python/tests/installed.py"), root.join("examples/paper/fig-12.toml"));
    succeed(here().arg(script).arg(scenario))
}

/// The folders in which programs are looked for, without those that have Cargo.
fn without_cargo() -> OsString {
    let cargo = format!("cargo{}", std::env::consts::EXE_SUFFIX);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::env::split_paths(&path).filter(|folder| !folder.join(&cargo).exists());
    std::env::join_paths(folders).unwrap_or_default()
}

/// Where what is compiled lies.
pub(crate) fn target_folder(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}

fn system_python() -> &'static str {
    if cfg!(windows) { "python" } else { "python3" }
}

/// The interpreter of an environment.
fn interpreter(environment: &Path) -> PathBuf {
    environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" })
}

/// The kernels of OpenBLAS that this processor can run, of those that sum in another order.
fn blas_kernels() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    let found = [
        ("Nehalem", is_x86_feature_detected!("sse4.2")),
        ("Haswell", is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")),
        ("SkylakeX", is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512vl")),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let found: [(&str, bool); 0] = [];
    found.into_iter().filter_map(|(name, there)| there.then_some(name)).collect()
}

/// The interpreter of `.venv`, which is made if it is not there, with the packages that a file lists.
pub(crate) fn environment(root: &Path, requirements: &str) -> Result<PathBuf, String> {
    let folder = root.join(".venv");
    let python = interpreter(&folder);
    if !python.exists() {
        succeed(command(root, system_python()).args(["-m", "venv"]).arg(&folder))?;
    }
    let mut install = command(root, &python);
    install.args(["-m", "pip", "install", "--quiet", "--no-compile", "--disable-pip-version-check", "--requirement"]);
    succeed(install.arg(root.join(requirements)))?;
    Ok(python)
}
