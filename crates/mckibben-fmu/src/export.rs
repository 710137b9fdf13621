//! Writes a unit: one file with the description, the library of each platform, and the scenario.
//!
//! ```text
//! modelDescription.xml
//! binaries/x86_64-linux/mckibben.so      FMI 3.0; FMI 2.0 calls the folder linux64
//! documentation/index.html
//! resources/scenario.toml, options.txt
//! ```

use crate::MODEL_IDENTIFIER;
use crate::archive::Archive;
use crate::description::model_description;
use crate::model::{Model, OPTIONS, SCENARIO};
use crate::options::Version;
use mckibben_run::failure::Failure;
use mckibben_run::output;
use std::path::Path;

/// The file of this platform's library, as it is built.
pub const LIBRARY: &str = if cfg!(target_os = "windows") {
    "mckibben_fmu.dll"
} else if cfg!(target_os = "macos") {
    "libmckibben_fmu.dylib"
} else {
    "libmckibben_fmu.so"
};

/// A library with the platform that it is for.
#[derive(Clone, Debug)]
pub struct Library {
    /// The architecture, such as `x86_64`.
    pub architecture: &'static str,
    /// The system, such as `linux`.
    pub system: &'static str,
    /// The bytes of the library.
    pub bytes: Vec<u8>,
}

impl Library {
    /// Reads the library of this platform from the first of some folders that has it.
    ///
    /// # Errors
    /// When none has it, or it cannot be read.
    pub fn find<'f>(folders: impl IntoIterator<Item = &'f Path>) -> Result<Self, Failure> {
        for folder in folders {
            let path = folder.join(LIBRARY);
            if path.exists() {
                let bytes = std::fs::read(&path).map_err(|error| {
                    let title = format!("`{}` cannot be read: {error}", path.display());
                    Failure::input(title, "give the program a library that you may read")
                })?;
                return Ok(Self { architecture: std::env::consts::ARCH, system: std::env::consts::OS, bytes });
            }
        }
        Err(Failure::input(
            format!("the library `{LIBRARY}` that a unit carries is not in the folder of the program"),
            "run cargo build --release --package mckibben-fmu, or take both from the archive of a release",
        ))
    }

    /// Its path in a unit.
    fn path(&self, version: Version) -> String {
        let (system, ending) = match self.system {
            "windows" => ("windows", "dll"),
            "macos" => ("darwin", "dylib"),
            other => (other, "so"),
        };
        let folder = match (version, system, self.architecture) {
            (Version::Two, "linux", "x86_64") => "linux64".to_owned(),
            (Version::Two, "windows", "x86_64") => "win64".to_owned(),
            (Version::Two, "darwin", _) => "darwin64".to_owned(),
            (_, system, architecture) => format!("{architecture}-{system}"),
        };
        format!("binaries/{folder}/{MODEL_IDENTIFIER}.{ending}")
    }
}

/// The bytes of a unit.
///
/// # Errors
/// When it is beyond 4 GiB.
pub fn unit(model: &Model, name: &str, version: Version, libraries: &[Library]) -> Result<Vec<u8>, Failure> {
    let mut archive = Archive::default();
    let mut add = |path: &str, content: &[u8]| {
        archive.add(path, content).map_err(|why| Failure::input(why, "give libraries of fewer platforms"))
    };
    add("modelDescription.xml", model_description(model, name, version).as_bytes())?;
    for library in libraries {
        add(&library.path(version), &library.bytes)?;
    }
    add(&format!("resources/{SCENARIO}"), model.document().to_toml().as_bytes())?;
    add(&format!("resources/{OPTIONS}"), model.options().to_text().as_bytes())?;
    add("documentation/index.html", PAGE.as_bytes())?;
    archive.finish().map_err(|why| Failure::input(why, "give libraries of fewer platforms"))
}

/// Writes a unit, whole or not at all.
///
/// # Errors
/// As [`unit()`], and when the file cannot be written.
pub fn write_fmu(path: &Path, model: &Model, version: Version, libraries: &[Library]) -> Result<(), Failure> {
    let name = path.file_stem().map_or_else(|| "muscle".to_owned(), |stem| stem.to_string_lossy().into_owned());
    output::write(path, &unit(model, &name, version, libraries)?)
}

/// The page of the unit's documentation.
const PAGE: &str = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>mckibben</title></head>\n\
    <body><p>Braided pneumatic actuators with their air network, written by <code>mckibben fmu</code>. The scenario is \
    <code>resources/scenario.toml</code>; the chapter on functional mock-up units of the project's book says what each \
    variable is.</p></body></html>\n";
