//! Why something could not be done, and the exit code by which a program says so.
//!
//! | code | meaning | made by |
//! |---|---|---|
//! | 0 | done | |
//! | 2 | the input is wrong: arguments, a missing file, a scenario; nothing was written | [`Failure::input`] |
//! | 3 | the simulation could not go on; nothing was written | [`Failure::stopped`] |
//! | 4 | the output could not be written; what was finished before stays, and the message names it | [`Failure::output`] |
//! | 129, 130, 143 | stopped by SIGHUP, SIGINT, SIGTERM | the program |
//!
//! Checked by the tests of the program, `tests/bad_input.rs` and `tests/simulate.rs`.

use mckibben_scenario::{Diagnostic, Diagnostics, Document, Style};
use std::fmt;
use std::path::Path;

/// What sort of failure it is; its number is the exit code.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u8)]
pub enum Reason {
    /// The arguments or the scenario are wrong.
    Input = 2,
    /// The simulation could not go on.
    Stopped = 3,
    /// The output could not be written.
    Output = 4,
}

impl Reason {
    /// What an error of the core is: a simulation that stopped, or values that contradict each other.
    fn of(error: &mckibben::Error) -> Self {
        if matches!(error, mckibben::Error::Stopped { .. } | mckibben::Error::Interrupted { .. }) {
            Self::Stopped
        } else {
            Self::Input
        }
    }
}

/// Why something could not be done.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Failure {
    reason: Reason,
    message: Message,
    /// What remains all the same, where output could not be written.
    stays: Option<String>,
}

/// What is said about it.
#[derive(Clone, Debug, Eq, PartialEq)]
enum Message {
    /// A sentence, and what to do about it.
    Words { title: String, help: Option<String> },
    /// Places in a file.
    Places(Diagnostics),
}

impl Failure {
    /// The input is wrong, with no place in a file.
    pub fn input(title: impl Into<String>, help: impl Into<String>) -> Self {
        Self::words(Reason::Input, title.into(), Some(help.into()))
    }

    /// The simulation could not go on, with no place in a file.
    pub fn stopped(title: impl Into<String>) -> Self {
        Self::words(Reason::Stopped, title.into(), None)
    }

    /// A number that came out of a run or a study is not finite: where it stands, with the number.
    pub fn not_finite(which: &str) -> Self {
        let title = format!("{which} is not a finite number, so nothing was written");
        let help =
            "a value of the input lies far outside what the model is made for: look for a unit that was mistaken";
        Self::words(Reason::Stopped, title, Some(help.into()))
    }

    /// An error of the core, located in the scenario that led to it.
    pub fn of_core(error: &mckibben::Error, document: &Document) -> Self {
        Self::places(Reason::of(error), document.diagnose(error).into())
    }

    /// A file could not be written, and nothing was left behind; [`Failure::staying`] names what was.
    pub fn output(path: &Path, error: impl fmt::Display) -> Self {
        let title = format!("`{}` could not be written: {error}", path.display());
        let help = "give a path in a folder that exists, has space left, and that you may write to";
        Self::words(Reason::Output, title, Some(help.into()))
    }

    /// Adds what was finished before and stays, as in `3 files stay`; only for output that could not be written, and
    /// unless that is said already.
    #[must_use]
    pub fn staying(self, what: impl FnOnce() -> String) -> Self {
        match self.reason {
            Reason::Output if self.stays.is_none() => Self { stays: Some(what()), ..self },
            _ => self,
        }
    }

    fn words(reason: Reason, title: String, help: Option<String>) -> Self {
        Self { reason, message: Message::Words { title, help }, stays: None }
    }

    fn places(reason: Reason, places: Diagnostics) -> Self {
        Self { reason, message: Message::Places(places), stays: None }
    }

    /// Names one thing among several, such as `actuator 7`, as the origin; places in a file say it themselves.
    pub fn of(self, whose: &str) -> Self {
        match self.message {
            Message::Words { title, help } => {
                let message = Message::Words { title: format!("{whose}: {title}"), help };
                Self { message, ..self }
            }
            Message::Places(_) => self,
        }
    }

    /// Adds a sentence to what to do about it; places in a file say what to do themselves.
    #[must_use]
    pub(crate) fn advised(self, advice: &str) -> Self {
        match self.message {
            Message::Words { title, help } => {
                let help = help.map_or_else(|| advice.to_owned(), |help| format!("{help}; {advice}"));
                Self { message: Message::Words { title, help: Some(help) }, ..self }
            }
            Message::Places(_) => self,
        }
    }

    /// What sort of failure it is.
    pub fn reason(&self) -> Reason {
        self.reason
    }

    /// The exit code.
    pub fn code(&self) -> u8 {
        self.reason as u8
    }

    /// The message as text for people, without a line end after it.
    pub fn render(&self, style: Style) -> String {
        match &self.message {
            Message::Places(places) => places.render(style),
            Message::Words { title, help } => {
                let (red, bold, reset) = match style {
                    Style::Plain => ("", "", ""),
                    Style::Coloured => ("\x1b[1m\x1b[91m", "\x1b[1m", "\x1b[0m"),
                };
                let behind = match (self.reason, &self.stays) {
                    (Reason::Output, None) => "; nothing was left behind",
                    (Reason::Output, Some(what)) => &format!("; {what}"),
                    _ => "",
                };
                let help = help.as_ref().map(|help| format!("\n {bold}= help{reset}: {help}{behind}"));
                let help = help.unwrap_or_default();
                format!("{red}error{reset}{bold}: {title}{reset}{help}")
            }
        }
    }

    /// What is wrong and what to do about it, in one line for a report.
    pub fn sentence(&self) -> String {
        match &self.message {
            Message::Places(places) => places.render(Style::Plain),
            Message::Words { title, help } => help.iter().fold(title.clone(), |title, help| format!("{title}; {help}")),
        }
    }
}

/// An error of the core without a scenario to locate it in; [`Failure::of_core`] locates it.
impl From<mckibben::Error> for Failure {
    fn from(error: mckibben::Error) -> Self {
        Self::words(Reason::of(&error), error.to_string(), None)
    }
}

impl From<mckibben_plot::PlotError> for Failure {
    fn from(error: mckibben_plot::PlotError) -> Self {
        Self::stopped(format!("the figure could not be drawn: {error}"))
    }
}

impl From<Diagnostics> for Failure {
    fn from(places: Diagnostics) -> Self {
        Self::places(Reason::Input, places)
    }
}

impl From<Diagnostic> for Failure {
    fn from(place: Diagnostic) -> Self {
        Diagnostics::from(place).into()
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(Style::Plain))
    }
}

impl std::error::Error for Failure {}
