//! Values that a plant's file says of all actuators and that none of them has, since each replaces them.
//!
//! No reading of an actuator sees them, so that word, unit and range are checked here, as the table of keys states them. In a file
//! such a value may stand for actuators to come. One that a user sets in addition to a file, as by `--set`, is meant to change
//! something, and is refused.
//!
//! Checked by `tests/plant.rs`.

use super::Reader;
use crate::choice::Choice;
use crate::diagnostic::{Class, Diagnostic};
use crate::document::{Document, Entry, Table, Value};
use crate::keys::{self, ACTUATORS, Kind};

/// The values that are said of all actuators and that no actuator read so far has, each with its path.
pub(crate) struct Unread<'d>(Vec<(String, &'d Entry)>);

impl<'d> Unread<'d> {
    /// All values that a document says of all actuators. What belongs to the plant, and the supplies, are read once each.
    pub(crate) fn of(document: &'d Document) -> Self {
        let mut found = Vec::new();
        let of_all = keys::OF_ACTUATOR.iter().filter(|section| !["air", "supply"].contains(section));
        for section in of_all.copied().chain(["actuator"]) {
            if let Some(Value::Table(table)) = document.entry(section).map(|entry| &entry.node.value) {
                collect(table, section, &mut found);
            }
        }
        Self(found)
    }

    /// Each value with its path.
    pub(crate) fn into_entries(self) -> Vec<(String, &'d Entry)> {
        self.0
    }

    /// Takes out what the document as it stands for one actuator still has.
    pub(crate) fn read_in(&mut self, part: &Document) {
        let is_there =
            |path: &str, entry: &Entry| part.entry(path).is_some_and(|its| its.node.place.is(&entry.node.place));
        self.0.retain(|(path, entry)| !is_there(path, entry));
    }

    /// Takes out the value at a path, or those of the section there, which the caller checks; says whether there were any.
    pub(crate) fn take_out(&mut self, path: &str) -> bool {
        let is_there = |of: &str| of.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        let count = self.0.len();
        self.0.retain(|(of, _)| !is_there(of));
        self.0.len() < count
    }
}

fn collect<'d>(table: &'d Table, section: &str, found: &mut Vec<(String, &'d Entry)>) {
    for entry in &table.0 {
        let path = format!("{section}.{}", entry.name);
        match &entry.node.value {
            Value::Table(inner) => collect(inner, &path, found),
            _ => found.push((path, entry)),
        }
    }
}

impl<'d> Reader<'d> {
    /// Notes what is wrong with values that nothing reads.
    pub(crate) fn check_unread(&mut self, unread: Unread<'d>) {
        // An actuator with a mistake may not have been read to its end.
        let are_all_read = !self.has_mistakes();
        for (path, entry) in unread.0 {
            // A key that there is not has been refused.
            let Some(key) = keys::key_at(&keys::stands_for(&path)) else { continue };
            let first = self.mistakes();
            self.check_value(&path, entry, key.kind);
            self.name_from(first, key.path, &path);
            if are_all_read && self.mistakes() == first && entry.key.source().is_setting() {
                self.reaches_none(&path, entry);
            }
        }
    }

    /// Notes a value that a user has set for all actuators, and that none of them takes.
    fn reaches_none(&mut self, path: &str, entry: &Entry) {
        let section = path.rsplit_once('.').map_or("", |(section, _)| section);
        let section = if section == "actuator" { "" } else { section.strip_prefix("actuator.").unwrap_or(section) };
        let title = format!("`{path}` is set for all actuators, and none of them takes it");
        let named = self.document().named(ACTUATORS);
        let own = named.first().map_or_else(String::new, |(name, _)| match section {
            "" => format!(", such as [{ACTUATORS}.{name}]"),
            section => format!(", such as [{ACTUATORS}.{name}.{section}]"),
        });
        let help = format!(
            "give `{}` in the file, in the section of an actuator{own}, which replaces the value for all; or leave it out",
            entry.name
        );
        self.note(Diagnostic::at(Class::NotApplicable, entry.key.clone(), title, "reaches nothing").help(help));
    }

    fn check_value(&mut self, path: &str, entry: &'d Entry, kind: Kind) {
        let node = &entry.node;
        let is_list = matches!(node.value, Value::List(_));
        match kind {
            Kind::QuantityOr(_, word) if self.says(path, word.name) => {}
            Kind::QuantityOr(row, word) => drop(self.quantity_or(node, row, word.name)),
            Kind::Quantities(row) => drop(self.list_of(entry, row)),
            Kind::TimeSeries(row) if is_list => drop(self.list_of(entry, row)),
            Kind::Quantity(row) | Kind::TimeSeries(row) => drop(self.quantity(node, row)),
            Kind::Whole(row) => drop(self.whole_of(node, row)),
            Kind::Unit(like) => drop(self.unit_of(node, path, like)),
            // Its unit is that of what the controller regulates; a controller that drives no valve is refused as a whole.
            Kind::Regulated => {}
            Kind::Name => drop(self.name(path)),
            Kind::Choice(choices) => drop(self.one_of(node, path, choices)),
            Kind::Choices(choices) => self.check_words(path, entry, choices),
        }
    }

    fn check_words(&mut self, path: &str, entry: &'d Entry, choices: &[Choice]) {
        for item in self.items_of(&entry.node, &entry.name).into_iter().flatten() {
            self.one_of(item, path, choices);
        }
    }
}
