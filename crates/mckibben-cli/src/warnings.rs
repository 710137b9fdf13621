//! Warnings in words, and `--strict`, which makes errors of them.

use crate::terminal::{self, NOTABLE, styled};
use mckibben_run::failure::Failure;
use mckibben_run::warnings::Warning;

/// The section of a summary; empty without warnings.
pub(crate) fn section(warnings: &[Warning]) -> String {
    if warnings.is_empty() {
        return String::new();
    }
    let lines = warnings.iter().map(|warning| terminal::wrap(&warning.to_string(), "  ") + "\n");
    format!("\n{}\n{}", styled(NOTABLE, "Warnings"), lines.collect::<String>())
}

/// A warning on a line, with the file that it is of where there may be several.
pub(crate) fn line(warning: &Warning, file: &str) -> String {
    let file = if file.is_empty() { String::new() } else { format!("{file}: ") };
    format!("{}: {file}{warning}\n", styled(NOTABLE, "warning"))
}

/// Prints warnings on standard error, each on a line.
pub(crate) fn print(warnings: &[Warning]) {
    warnings.iter().for_each(|warning| terminal::print_error(&line(warning, "")));
}

/// Refuses to go on where there are warnings, which are printed.
///
/// # Errors
/// [`Failure::input`] for any warning.
pub(crate) fn refuse(warnings: &[Warning]) -> Result<(), Failure> {
    if warnings.is_empty() {
        return Ok(());
    }
    print(warnings);
    let title = format!("{}, and --strict makes errors of warnings", plural(warnings.len()));
    Err(Failure::input(title, "change what is named above, or leave --strict out; nothing was written"))
}

/// How many warnings, in words.
pub(crate) fn plural(warnings: usize) -> String {
    if warnings == 1 { "one warning".to_owned() } else { format!("{warnings} warnings") }
}
