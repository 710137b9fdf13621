//! Locates an error of the core in the scenario file.
//!
//! The core names the parameter at fault by its scenario key. The place is the value at that key; where the file does
//! not give it, the description of a muscle at rest that it follows from, else the preset that did, else the section it
//! belongs to, else the file. The other side of a contradiction
//! is located too when the file gives it.

use crate::diagnostic::{Class, Diagnostic, Place};
use crate::document::{Document, Value};
use crate::keys;
use crate::muscle;
use crate::quantity;
use mckibben::parameter::{self as p, DURATION, MAX_COUNT, Parameter};
use mckibben::{Count, Error};

impl Document {
    /// The diagnostic of an error that the core returned for values of this document.
    pub fn diagnose(&self, error: &Error) -> Diagnostic {
        match error {
            Error::OutOfRange { parameter, value } => {
                let title = format!("`{}` = {} is out of range", parameter.key, in_unit(parameter, *value));
                let label = format!("must be {} {}", parameter.range, parameter.unit);
                self.shown(Class::OutOfRange, parameter.key, None, title, label.trim_end().to_owned())
                    .help(parameter.remedy)
            }
            Error::TooMany { parameter, value, count, counted, remedy } => {
                let value = in_unit(parameter, *value);
                let title = format!("`{}` = {value} makes {} {counted}", parameter.key, Count(*count));
                let label = format!("a run may have {} {counted}", Count(MAX_COUNT));
                let length = self.given(DURATION.key, parameter.key).filter(|_| self.entry(parameter.key).is_some());
                self.shown(Class::OutOfRange, parameter.key, None, title, label)
                    .related(length, "the run's duration")
                    .help(*remedy)
            }
            Error::Inconsistent { parameter, value, requirement, remedy } => {
                let other =
                    format!("{} = {}", requirement.other, quantity::format(requirement.value, requirement.unit));
                let value = in_unit(parameter, *value);
                let title = format!(
                    "`{}` = {value} contradicts the rule that it {} {other}",
                    parameter.key, requirement.relation
                );
                let label = format!("{} {other}", requirement.relation);
                self.shown(Class::Inconsistent, parameter.key, None, title, label)
                    .related(self.given(requirement.other, parameter.key), "the other value")
                    .help(*remedy)
            }
            Error::Table { name, problem, entry, remedy } => {
                let title = format!("`{name}`: {problem}");
                let label = format!("entry {entry}: {problem}");
                self.shown(Class::BadList, name, entry.checked_sub(1), title, label).help(*remedy)
            }
            Error::NotImplemented(limit) => {
                Diagnostic::whole(Class::NotImplemented, self.source().name(), limit.title().to_string())
                    .help(limit.remedy)
            }
            Error::NoSolution { what, remedy } => {
                Diagnostic::whole(Class::NoSolution, self.source().name(), *what).help(*remedy)
            }
            Error::Misuse { what, remedy } => {
                Diagnostic::whole(Class::NotApplicable, self.source().name(), *what).help(*remedy)
            }
            Error::Stopped { remedy, .. } => {
                // The remedy is printed as help and need not stand in the title as well.
                let text = error.to_string();
                let title = text.strip_suffix(&format!("; {remedy}")).unwrap_or(&text);
                Diagnostic::whole(Class::Stopped, self.source().name(), title).help(*remedy)
            }
            other => Diagnostic::whole(Class::Stopped, self.source().name(), other.to_string()),
        }
    }

    /// A diagnostic at the best place for a key.
    fn shown(&self, class: Class, key: &str, entry: Option<usize>, title: String, label: String) -> Diagnostic {
        let section = key.rsplit_once('.').map_or(key, |(section, _)| section);
        let root = key.split('.').next().unwrap_or(key);
        if let Some(found) = self.entry(key) {
            let item = match (&found.node.value, entry) {
                (Value::List(items), Some(at)) => items.get(at),
                _ => None,
            };
            return Diagnostic::at(class, item.unwrap_or(&found.node).place.clone(), title, label);
        }
        if muscle::BRAID.iter().any(|row| row.key == key) || [p::MAX_LENGTH.key, p::MIN_LENGTH.key].contains(&key) {
            // The angle is what most such rules are about.
            if let Some(rest) = muscle::AT_REST.iter().rev().find_map(|row| self.entry(row.key)) {
                let label = format!("{label}; `{key}` follows from the muscle at rest");
                return Diagnostic::at(class, rest.node.place.clone(), title, label);
            }
        }
        if let Some(preset) = self.entry(&format!("{root}.preset")) {
            return Diagnostic::at(
                class,
                preset.node.place.clone(),
                title,
                format!("{label}; the preset gives `{key}`"),
            );
        }
        match self.place(section).or_else(|| self.place(root)) {
            Some(place) => Diagnostic::at(class, place.clone(), title, format!("{label}; `{key}` is not given here")),
            None => Diagnostic::whole(class, self.source().name(), title),
        }
    }

    /// The value of the other quantity of a contradiction: a key, or the name of one in any section.
    fn given(&self, name: &str, beside: &str) -> Option<Place> {
        let section = beside.rsplit_once('.').map_or("", |(section, _)| section);
        let near = format!("{section}.{name}");
        let by_name = || keys::KEYS.iter().find(|key| key.name() == name).map(|key| key.path);
        let entry = self.entry(name).or_else(|| self.entry(&near)).or_else(|| self.entry(by_name()?))?;
        Some(entry.node.place.clone())
    }
}

fn in_unit(parameter: &Parameter, value: f64) -> String {
    quantity::format(value, parameter.unit)
}
