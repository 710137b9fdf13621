//! The C peer: built here with the system's compiler, one entry for each method.

use crate::process::Process;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Methods of ARKODE and CVODE that are tried.
pub const METHODS: [&str; 5] = ["erk-dormand-prince-5", "erk-verner-6", "erk-fehlberg-8", "cvode-adams", "cvode-bdf"];

/// Flags of the C compiler, as they are printed.
pub const FLAGS: [&str; 6] = ["-std=gnu11", "-O3", "-march=native", "-flto", "-fno-math-errno", "-Wall"];

/// Builds the program into `folder` and gives its path and SUNDIALS' version.
///
/// # Errors
/// With what to install, when the compiler or the library is missing.
pub fn build(sources: &Path, folder: &Path) -> Result<(PathBuf, String), String> {
    let program = folder.join("sundials_peer");
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let output = Command::new(&compiler)
        .args(FLAGS)
        .arg("-o")
        .arg(&program)
        .args([sources.join("sundials_peer.c"), sources.join("muscle.c")])
        .args(["-lsundials_arkode", "-lsundials_cvode", "-lsundials_nvecserial", "-lm"])
        .output()
        .map_err(|error| format!("{compiler}: {error}; a C compiler is needed: apt-get install -y gcc libc6-dev"))?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr);
        return Err(if message.contains("arkode") || message.contains("sundials/") {
            "SUNDIALS is not installed: apt-get install -y libsundials-dev".into()
        } else {
            format!("the C peer does not compile:\n{message}")
        });
    }
    let version = Command::new(&program).arg("--version").output().map_err(|error| error.to_string())?;
    Ok((program, String::from_utf8_lossy(&version.stdout).trim().to_owned()))
}

/// The peers of a program that has been built.
pub fn peers(program: &Path) -> impl Iterator<Item = Process> {
    METHODS
        .map(|method| Process {
            name: format!("SUNDIALS {method}"),
            program: program.to_owned(),
            arguments: Vec::new(),
            method: method.into(),
            repeats: 60,
        })
        .into_iter()
}
