//! The document as it stands for one part of a plant.
//!
//! Each part is read from a separate document: what the file says of all, with what it says of that part laid over it. So one
//! reading serves a file of one actuator and each actuator of a plant, and a mistake is reported where it stands.

use crate::diagnostic::Place;
use crate::document::{Document, Entry, Node, Table, Value};
use crate::keys::{self, ACTUATORS, MECHANISM, MECHANISMS, SUPPLIES};
use crate::read::describes_whole_braid;
use mckibben::parameter::Parameter;

/// The supply that `[supply]` is.
pub(crate) const SUPPLY: &str = "supply";

impl Document {
    /// The entries of a section, as far as they are sections: by names that the file chooses.
    pub(crate) fn named(&self, section: &str) -> Vec<(&str, &Place)> {
        match self.entry(section).map(|entry| &entry.node.value) {
            Some(Value::Table(table)) => table.0.iter().map(|entry| (entry.name.as_str(), &entry.key)).collect(),
            _ => Vec::new(),
        }
    }

    /// Without what is said of single parts.
    fn of_all(&self) -> Self {
        let mut document = self.clone();
        for section in [ACTUATORS, SUPPLIES, MECHANISM, MECHANISMS, "sweep"] {
            document.remove(section);
        }
        document
    }

    /// As it stands for one actuator, without its supply where that is named.
    pub(crate) fn of_actuator(&self, name: &str) -> Self {
        let mut document = self.of_all();
        let Some(Entry { key, node, .. }) = self.entry(&format!("{ACTUATORS}.{name}")) else { return document };
        let Value::Table(table) = &node.value else { return document };
        let is_section = |entry: &&Entry| keys::OF_ACTUATOR.contains(&entry.name.as_str());
        let own: Vec<Entry> = table.0.iter().filter(|entry| !is_section(entry)).cloned().collect();
        if !own.is_empty() {
            let own = Table(own);
            let gives = |row: &Parameter| row.key.rsplit('.').next().is_some_and(|name| own.get(name).is_some());
            if !describes_whole_braid(gives) {
                document.name_default_preset(self, key);
            }
            document.lay_over(&own, "actuator");
        }
        document.make_way(table);
        for entry in table.0.iter().filter(is_section) {
            match &entry.node.value {
                Value::Table(inner) => document.lay_over(inner, &entry.name),
                // The name of a supply.
                _ => continue,
            }
            // An empty section is there as well.
            if !document.contains(&entry.name) {
                document.put(&entry.name, &entry.key, &entry.node);
            }
        }
        document
    }

    /// As it stands for one supply: what is said of it in the place of `[supply]`, and its own valve, hose and command.
    pub(crate) fn of_supply(&self, name: &str) -> Self {
        if !self.contains(&format!("{SUPPLIES}.{name}")) {
            let mut document = self.of_all();
            for section in ["valve", "hose", "command", keys::CONTROLLER] {
                document.remove(section);
            }
            return document;
        }
        let mut document = self.of_all();
        for section in [SUPPLY, "valve", "hose", "command", keys::CONTROLLER] {
            document.remove(section);
        }
        let Some(Entry { key, node, .. }) = self.entry(&format!("{SUPPLIES}.{name}")) else { return document };
        let Value::Table(table) = &node.value else { return document };
        document.put(SUPPLY, key, &Node { place: node.place.clone(), value: Value::Table(Table::default()) });
        for entry in &table.0 {
            let path = match entry.name.as_str() {
                own @ ("from" | "inlet") => format!("{SUPPLIES}.*.{own}"),
                section if keys::OF_SUPPLY.contains(&section) => section.to_owned(),
                key => format!("{SUPPLY}.{key}"),
            };
            document.put(&path, &entry.key, &entry.node);
        }
        document
    }

    /// As it stands for one mechanism: `[mechanism]`, or one of several in its place.
    pub(crate) fn of_mechanism(&self, name: Option<&str>) -> Self {
        let mut document = self.of_all();
        let path = name.map_or_else(|| MECHANISM.to_owned(), |name| format!("{MECHANISMS}.{name}"));
        if let Some(Entry { key, node, .. }) = self.entry(&path) {
            document.put(MECHANISM, key, node);
        }
        document
    }

    /// As [`Document::of_mechanism`] made it, for one joint.
    pub(crate) fn of_joint(&self, name: &str) -> Self {
        let mut document = self.clone();
        let joint = self.entry(&format!("mechanism.joints.{name}")).cloned();
        document.remove("mechanism.joints");
        if let Some(Entry { key, node, .. }) = joint {
            document.put("mechanism.joints.*", &key, &node);
        }
        document
    }

    /// As [`Document::of_actuator`] made it, for its moment arm about one joint.
    pub(crate) fn of_arm(&self, joint: &str) -> Self {
        let mut document = self.clone();
        let arm = self.entry(&format!("coupling.arms.{joint}")).cloned();
        document.remove("coupling.arms");
        if let Some(Entry { key, node, .. }) = arm {
            document.put("coupling.arms.*", &key, &node);
        }
        document
    }

    /// Whether a word stands at a path.
    pub(crate) fn is_word(&self, path: &str, word: &str) -> bool {
        matches!(self.entry(path).map(|entry| &entry.node.value), Some(Value::String(said)) if said == word)
    }

    /// Puts a word that follows from another part of the file, at the place that says so.
    pub(crate) fn put_word(&mut self, path: &str, place: &Place, word: &str) {
        let value = Value::String(word.to_owned());
        self.put(path, place, &Node { place: place.clone(), value });
    }

    /// Puts a quantity that follows from another part of the file, at the place that says so.
    pub(crate) fn put_value(&mut self, path: &str, place: &Place, value: f64, unit: &str) {
        let value = Value::String(format!("{value} {unit}"));
        self.put(path, place, &Node { place: place.clone(), value });
    }
}
