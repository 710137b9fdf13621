//! Words on the terminal: colour where it is wanted, and a closed pipe is no mistake.
//!
//! Colour codes are always written and taken out again by `anstream` when the output is no terminal, or `NO_COLOR` is
//! set, or the terminal has none.

use clap::builder::styling::{AnsiColor, Style, Styles};
use mckibben_run::failure::Failure;
use mckibben_run::text;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Headings.
pub const HEADING: Style = Style::new().bold();
/// What matters less.
pub const FAINT: Style = Style::new().dimmed();
/// What is well.
pub const GOOD: Style = AnsiColor::Green.on_default().bold();
/// What deserves a look.
pub const NOTABLE: Style = AnsiColor::Yellow.on_default();

/// The colours of the help pages.
pub const HELP: Styles = Styles::styled()
    .header(HEADING)
    .usage(HEADING)
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

/// Some text in a style.
pub fn styled(style: Style, text: impl std::fmt::Display) -> String {
    format!("{style}{text}{style:#}")
}

/// Prints text on standard output.
///
/// # Errors
/// [`Failure::output`] when it cannot be written. That the reader went away (`| head`) is none.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::output(Path::new("standard output"), error))
        }
        _ => Ok(()),
    }
}

/// Prints text on standard error; that it could not be written has nowhere to be said.
pub fn print_error(text: &str) {
    let _ = anstream::stderr().lock().write_all(text.as_bytes());
}

/// The width of the terminal in characters, within reason; 100 where there is none.
pub fn width() -> usize {
    let by_shell = || std::env::var("COLUMNS").ok()?.parse().ok();
    let by_terminal = || terminal_size::terminal_size().map(|(width, _)| usize::from(width.0));
    by_shell().or_else(by_terminal).unwrap_or(100).clamp(60, 120)
}

/// Breaks text into the lines of the terminal, each after `indent`.
pub fn wrap(text: &str, indent: &str) -> String {
    text::wrap(text, indent, width())
}

/// A name in a column of `names` characters and text behind it, which is broken where the terminal ends.
pub fn entry(name: &str, names: usize, text: &str) -> String {
    text::entry(name, names, text, width())
}

/// The line that says that a file was written, with what is known of it.
pub(crate) fn wrote(path: &Path, what: &str) -> String {
    format!("{} {}{what}\n", styled(GOOD, "wrote"), path.display())
}
