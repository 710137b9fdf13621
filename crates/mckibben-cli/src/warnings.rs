//! Warnings in words, and `--strict`, which makes errors of them; a note is neither.

use crate::terminal::{self, NOTABLE, styled};
use mckibben_run::failure::Failure;
use mckibben_run::warnings::Warning;
use mckibben_scenario::{Document, Engine};

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

/// A note on a line about the steps of hosts, of which a run that locates its events makes no use. Sweeps take them.
pub(crate) fn idle_steps(document: &Document, engine: Engine, file: &str) -> Option<String> {
    let given: Vec<&str> = ["run.step", "run.accuracy"].into_iter().filter(|key| document.contains(key)).collect();
    if given.is_empty() || engine == Engine::FixedStep || document.contains("sweep") {
        return None;
    }
    let file = if file.is_empty() { String::new() } else { format!("{file}: ") };
    let verb = if given.len() == 1 { "takes" } else { "take" };
    let note = format!(
        "{file}{} {verb} no part in `mckibben simulate`, which locates events here; actuators in Python, functional mock-up units and \
         MuJoCo go by that. To simulate in such steps set run.engine = \"fixed-step\".",
        given.join(" and ")
    );
    Some(format!("{}: {note}\n", styled(NOTABLE, "note")))
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
