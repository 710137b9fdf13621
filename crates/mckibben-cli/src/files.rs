//! Files that arguments and options name: the scenario, what the ending of a name stands for, and files that are
//! written together.

use mckibben_plot::Format;
use mckibben_run::failure::Failure;
use mckibben_run::output::Pending;
use mckibben_run::record;
use mckibben_scenario::{Diagnostics, Document};
use std::path::Path;

/// The name by which a scenario comes from standard input.
const STANDARD_INPUT: &str = "-";

/// The scenario of a file, or of standard input for the name `-`.
///
/// # Errors
/// As [`Document::load`].
pub(crate) fn document(path: &Path) -> Result<Document, Diagnostics> {
    if path == Path::new(STANDARD_INPUT) {
        return Document::read(std::io::stdin().lock(), "standard input");
    }
    Document::load(path)
}

/// The ending of a name, if it is one of some.
///
/// # Errors
/// [`Failure::input`] for another, with the option that gave the name.
pub(crate) fn ending(path: &Path, option: &str, endings: &[&str]) -> Result<String, Failure> {
    let found = record::ending(path).filter(|ending| endings.contains(&ending.as_str()));
    found.ok_or_else(|| {
        let known: Vec<String> = endings.iter().map(|ending| format!(".{ending}")).collect();
        let title = format!("`{}` does not say how to write it", path.display());
        Failure::input(title, format!("end the name of {option} with {}", known.join(" or ")))
    })
}

/// The figure that `--plot` requests, if any.
///
/// # Errors
/// [`Failure::input`] for another ending than .svg, .png, .pdf and .html.
pub(crate) fn figure(path: Option<&Path>) -> Result<Option<(&Path, Format)>, Failure> {
    let of = |path| {
        let format = Format::of(path).map_err(|error| {
            Failure::input(error.to_string(), "end the name of --plot with .svg, .png, .pdf or .html")
        })?;
        Ok((path, format))
    };
    path.map(of).transpose()
}

/// A file of bytes that has no name yet.
///
/// # Errors
/// [`Failure::output`] where it cannot be written.
pub(crate) fn pending(path: &Path, bytes: &[u8]) -> Result<Pending, Failure> {
    let mut file = Pending::create(path)?;
    file.writer().write_all(bytes).map_err(|error| Failure::output(path, error))?;
    Ok(file)
}
