//! Failures as Python exceptions: the classes of `mckibben.errors`.

use mckibben_run::failure::{Failure, Reason};
use mckibben_scenario::Style;
use pyo3::PyErr;

mod classes {
    pyo3::import_exception!(mckibben.errors, InputError);
    pyo3::import_exception!(mckibben.errors, OutputError);
    pyo3::import_exception!(mckibben.errors, SimulationError);
}

/// Converts failures to exceptions of Python.
pub(crate) trait OrException<T> {
    /// The value, or the exception for why there is none.
    fn or_exception(self) -> Result<T, PyErr>;

    /// As [`OrException::or_exception`], with names of arguments in place of the command line's options in the message.
    fn or_exception_of_arguments(self) -> Result<T, PyErr>;
}

impl<T, E: Into<Failure>> OrException<T> for Result<T, E> {
    fn or_exception(self) -> Result<T, PyErr> {
        self.map_err(|error| exception(&error.into()))
    }

    fn or_exception_of_arguments(self) -> Result<T, PyErr> {
        self.map_err(|error| {
            let failure: Failure = error.into();
            raise(&failure, with_arguments(&failure.render(Style::Plain)))
        })
    }
}

/// A text with the names of arguments in place of options: `subject_to` for --subject-to. A command between backticks stays.
fn with_arguments(text: &str) -> String {
    let part = |(place, part): (usize, &str)| match (place % 2, part.strip_prefix("--")) {
        (1, Some(option)) if !option.contains(' ') => option.replace('-', "_"),
        (1, _) => part.to_owned(),
        _ => {
            let mut words = String::new();
            let mut rest = part;
            while let Some((before, behind)) = rest.split_once("--") {
                words += before;
                rest = behind.trim_start_matches('-');
                let dashes = behind.len() - rest.len();
                if dashes == 0 && rest.starts_with(|c: char| c.is_ascii_lowercase()) {
                    let end = rest.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(rest.len());
                    words = words + "`" + &rest[..end].replace('-', "_") + "`";
                    rest = &rest[end..];
                } else {
                    // The arrow in front of a place, or a line under words, is no option.
                    words = words + "--" + &"-".repeat(dashes);
                }
            }
            words + rest
        }
    };
    text.split('`').enumerate().map(part).collect::<Vec<_>>().join("`")
}

/// The exception for a failure.
pub(crate) fn exception(failure: &Failure) -> PyErr {
    raise(failure, failure.render(Style::Plain))
}

/// The exception for a failure with its words.
fn raise(failure: &Failure, words: String) -> PyErr {
    match failure.reason() {
        Reason::Input => classes::InputError::new_err(words),
        Reason::Stopped => classes::SimulationError::new_err(words),
        Reason::Output => classes::OutputError::new_err(words),
    }
}

#[cfg(test)]
mod tests {
    use super::with_arguments;

    #[test]
    fn options_are_arguments_and_the_arrow_of_a_place_stays() {
        let written =
            "error: no such key\n --> --vary:1:1\n  | ------ here\nuse --subject-to; or `mckibben size --load '5 kg'`";
        let read =
            "error: no such key\n --> `vary`:1:1\n  | ------ here\nuse `subject_to`; or `mckibben size --load '5 kg'`";
        assert_eq!(with_arguments(written), read);
    }
}
