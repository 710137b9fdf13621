//! Programs from the registry that checks use, in a folder of `target`.

use crate::dist::create;
use crate::steps::{cargo, succeed};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Name, version, and arguments that choose features.
pub(crate) type Tool = (&'static str, &'static str, &'static [&'static str]);

/// Installs the tools that are not in a folder, with these variables; the folder of the programs.
pub(crate) fn install(
    root: &Path,
    folder: &str,
    tools: &[Tool],
    variables: &[(&str, OsString)],
) -> Result<PathBuf, String> {
    let folder = root.join(folder);
    create(&folder)?;
    let build = folder.join("build");
    for (name, version, features) in tools {
        let mark = folder.join(format!("{name}-{version}"));
        if mark.exists() {
            continue;
        }
        let mut install = cargo(root);
        let version = format!("={version}");
        install.args(["install", name, "--version", &version, "--locked", "--force", "--debug", "--root"]);
        install.arg(&folder).args(*features).env("CARGO_TARGET_DIR", &build).env("CARGO_PROFILE_DEV_DEBUG", "0");
        succeed(install.envs(variables.iter().map(|(name, value)| (name, value))))?;
        fs::write(&mark, "").map_err(|error| format!("{}: {error}", mark.display()))?;
    }
    if build.exists() {
        fs::remove_dir_all(&build).map_err(|error| format!("{}: {error}", build.display()))?;
    }
    Ok(folder.join("bin"))
}
