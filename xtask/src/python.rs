//! The Python side: an environment of its own, and the reference trajectories made in it.

use crate::steps::succeed;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the reference trajectories lie.
pub(crate) fn reference_folder(root: &Path) -> PathBuf {
    root.join("target/reference")
}

/// Computes the reference trajectory of every scenario under `validation/reference`.
pub(crate) fn reference(root: &Path) -> Result<(), String> {
    let python = environment(root)?;
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

/// The interpreter of `.venv`, which is made if it is not there, with the packages of `validation/requirements.txt`.
fn environment(root: &Path) -> Result<PathBuf, String> {
    let folder = root.join(".venv");
    let scripts = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = scripts.join(if cfg!(windows) { "python.exe" } else { "python" });
    if !python.exists() {
        let system = if cfg!(windows) { "python" } else { "python3" };
        succeed(Command::new(system).args(["-m", "venv"]).arg(&folder))?;
    }
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"]);
    succeed(install.arg(root.join("validation/requirements.txt")))?;
    Ok(python)
}
