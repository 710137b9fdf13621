//! Functional mock-up units in fmi-sim, an importer that is written in Rust: too long to build for every check.

use crate::python::{AS_TESTS, environment, target_folder};
use crate::steps::{cargo, command, ended, root, succeed};
use crate::tools::{Tool, install};
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

const TOOL: [Tool; 1] = [("fmi-sim", "0.7.0", &[])];

/// Installs fmi-sim, and runs units in it.
pub(crate) fn fmi_sim() -> ExitCode {
    ended(run(&root()))
}

fn run(root: &Path) -> Result<(), String> {
    let python = environment(root, "python/tests/requirements.txt")?;
    succeed(command(root, &python).args(["-m", "pip", "install", "--quiet", "libclang"]))?;
    // Its bindings are made by libclang, which PyPI has, and which does not find the compiler's own headers.
    let print = |program: &mut std::process::Command| -> Result<String, String> {
        let printed = program.output().map_err(|error| format!("{program:?} could not be started: {error}"))?;
        Ok(String::from_utf8_lossy(&printed.stdout).trim().to_owned())
    };
    let native = "import clang, pathlib; print(pathlib.Path(clang.__path__[0]) / 'native')";
    let libclang = print(command(root, &python).args(["-c", native]))?;
    let headers = print(command(root, "gcc").arg("-print-file-name=include"))?;
    let variables = [
        ("LIBCLANG_PATH", OsString::from(libclang)),
        ("BINDGEN_EXTRA_CLANG_ARGS", OsString::from(format!("-I{headers}"))),
    ];
    let bin = install(root, "target/fmi-sim", &TOOL, &variables)?;
    let mut build = cargo(root);
    build.args(["build", "--locked", "--package", "mckibben-cli", "--package", "mckibben-python", "--features"]);
    succeed(build.arg("mckibben-python/as-tests").envs(AS_TESTS))?;
    let script = root.join("validation/fmi_sim.py");
    succeed(command(root, &python).arg(script).arg(target_folder(root).join("debug/mckibben")).arg(bin.join("fmi-sim")))
}
