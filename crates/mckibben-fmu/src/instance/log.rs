//! Messages of an instance to its host: never by standard output, which belongs to the host.

use super::Status;
use std::fmt;

/// Takes a message: its status, its category and its words.
pub type Sink = Box<dyn Fn(Status, &str, &str) + Send>;

/// The log of a host.
pub struct Logger {
    sink: Option<Sink>,
    /// Whether events are logged; what is refused always is.
    is_on: bool,
    /// The categories that are logged; all where there is none.
    categories: Vec<String>,
}

impl fmt::Debug for Logger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Logger")
            .field("is_on", &self.is_on)
            .field("categories", &self.categories)
            .finish_non_exhaustive()
    }
}

impl Logger {
    /// To where a host takes messages, if it does.
    pub fn new(sink: Option<Sink>, is_on: bool) -> Self {
        Self { sink, is_on, categories: Vec::new() }
    }

    /// Switches the log of events; of categories that are named, or of all.
    ///
    /// # Errors
    /// The name of a category that there is not.
    pub fn set(&mut self, is_on: bool, categories: Vec<String>) -> Result<(), String> {
        let known = ["logStatusError", "logStatusDiscard", "logEvents"];
        if let Some(other) = categories.iter().find(|name| !known.contains(&name.as_str())) {
            return Err(format!("`{other}` is no category; known are {}", known.join(", ")));
        }
        (self.is_on, self.categories) = (is_on, categories);
        Ok(())
    }

    /// Logs why a call was refused.
    pub fn refused(&self, status: Status, message: &str) {
        let category = if status == Status::Discard { "logStatusDiscard" } else { "logStatusError" };
        self.say(status, category, message);
    }

    /// Logs an event.
    pub fn event(&self, message: impl FnOnce() -> String) {
        if self.is_on {
            self.say(Status::Ok, "logEvents", &message());
        }
    }

    fn say(&self, status: Status, category: &str, message: &str) {
        let is_wanted = self.categories.is_empty() || self.categories.iter().any(|name| name == category);
        if let (Some(sink), true) = (&self.sink, is_wanted) {
            sink(status, category, message);
        }
    }
}
