//! Failures as Python exceptions: the classes of `mckibben.errors`, the words of the command line.

use mckibben_cli::failure::{Failure, Reason};
use mckibben_scenario::Style;
use pyo3::PyErr;

mod classes {
    pyo3::import_exception!(mckibben.errors, InputError);
    pyo3::import_exception!(mckibben.errors, OutputError);
    pyo3::import_exception!(mckibben.errors, StoppedError);
}

/// A sentence of the command line in the words of Python: `--all-states` is the argument `all_states`, what `--set` sets is set by
/// `with_values`, and the help of a command is that of its function.
fn in_python(words: &str) -> String {
    let mut text = of_help(words);
    let mut from = 0;
    while let Some(at) = text[from..].find("--").map(|at| from + at) {
        let rest = &text[at + 2..];
        let length = rest.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(rest.len());
        let is_option = length > 1
            && rest.starts_with(|c: char| c.is_ascii_lowercase())
            && text[..at].chars().next_back().is_none_or(|c| c.is_whitespace() || "'`\"([".contains(c));
        if !is_option {
            from = at + 2;
            continue;
        }
        let name = match &rest[..length] {
            "set" => "with_values".to_owned(),
            name => name.replace('-', "_"),
        };
        // Of `'--load <QUANTITY>'` the kind of value and the quotation marks go.
        let mut end = at + 2 + length;
        if let Some(kind) = text[end..].strip_prefix(" <").and_then(|rest| rest.find('>')) {
            end += kind + 3;
        }
        let quoted = ["'", "`"].iter().any(|mark| text[..at].ends_with(mark) && text[end..].starts_with(mark));
        let (start, end) = if quoted { (at - 1, end + 1) } else { (at, end) };
        let argument = format!("`{name}`");
        text.replace_range(start..end, &argument);
        from = start + argument.len();
    }
    text
}

/// The page that says in Python what the help of a command says.
fn of_help(words: &str) -> String {
    let mut text = words.to_owned();
    for command in ["curves", "identify", "linearize", "simulate", "sweep"] {
        text = text.replace(
            &format!("`mckibben {command} --help`"),
            &format!("docs/{}.md, help(mckibben.{command})", page(command)),
        );
    }
    text
}

/// The page of the documentation on a command.
fn page(command: &str) -> &'static str {
    match command {
        "identify" => "identify",
        "linearize" => "linearize",
        _ => "python",
    }
}

/// What failed is raised in Python.
pub(crate) trait Raised<T> {
    /// The value, or the exception for why there is none.
    fn raised(self) -> Result<T, PyErr>;
}

impl<T, E: Into<Failure>> Raised<T> for Result<T, E> {
    fn raised(self) -> Result<T, PyErr> {
        self.map_err(|error| exception(&error.into()))
    }
}

/// The exception for a failure.
pub(crate) fn exception(failure: &Failure) -> PyErr {
    let words = failure.clone().in_words(in_python).render(Style::Plain);
    match failure.reason() {
        Reason::Input => classes::InputError::new_err(words),
        Reason::Stopped => classes::StoppedError::new_err(words),
        Reason::Output => classes::OutputError::new_err(words),
    }
}
