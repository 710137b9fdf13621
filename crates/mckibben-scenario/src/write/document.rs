//! Writes a document as a file that runs, and sweeps, as the document does.
//!
//! Values are those of the [scenario](super) that is read from it, where no value depends on another that varies. Else each key stands
//! as it was written, and numbers that a program gave have their units.

use super::Writer;
use crate::document::{Document, Entry, Node, Table, Value, list_and_entry};
use crate::keys::{COUNT, FACTOR, Key, SWEEP, VARY, key_for};
use crate::quantity;
use crate::scenario::Scenario;

impl Document {
    /// This document as text from which a run, and a sweep, are the ones of this document; `scenario` is what was read from it, or none
    /// of several actuators with names.
    ///
    /// Every value of the scenario is in SI, as [`Scenario::to_toml`] writes it, but there is an engine only where the document names
    /// one: a sweep chooses it else. With a section `[sweep]`, and of several actuators, each key stands as it was written,
    /// since a value that varies may replace the preset or the number from which others follow.
    pub fn to_toml_with(&self, scenario: Option<&Scenario>) -> String {
        match scenario.filter(|_| !self.contains(SWEEP)) {
            Some(scenario) => {
                scenario.written(Writer { leaves_engine: !self.contains("run.engine"), ..Writer::default() })
            }
            None => self.with_units().to_toml(),
        }
    }

    /// A copy in which numbers that a program gave for quantities have their SI units, those that vary too.
    fn with_units(&self) -> Self {
        let mut whole = self.clone();
        for Entry { name, key, node } in &self.root().0 {
            whole.put(name, key, &with_units(name, "", node));
        }
        whole
    }
}

/// A value in which each number that a program gave for a quantity has its SI unit; `above` is that of a range or a distribution that
/// the value is in.
fn with_units(path: &str, above: &str, node: &Node) -> Node {
    let key = path.strip_prefix(VARY).and_then(|rest| rest.strip_prefix('.')).unwrap_or(path);
    let key = list_and_entry(key).map_or(key, |(list, _)| list);
    let unit = key_for(key).and_then(Key::parameter).map_or(above, |row| row.unit);
    let value = match &node.value {
        Value::Number(number) if !unit.is_empty() && node.place.source().numbers_are_si() => {
            Value::String(quantity::format(*number, unit))
        }
        Value::List(items) => Value::List(items.iter().map(|item| with_units(path, above, item)).collect()),
        Value::Table(table) => {
            let of = |entry: &Entry| {
                let is_pure = !path.starts_with(VARY) || [COUNT.key, FACTOR.key].contains(&entry.name.as_str());
                let inner = format!("{path}.{}", entry.name);
                Entry { node: with_units(&inner, if is_pure { "" } else { unit }, &entry.node), ..entry.clone() }
            };
            Value::Table(Table(table.0.iter().map(of).collect()))
        }
        other => other.clone(),
    };
    Node { value, ..node.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MUSCLE: &str = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = 2.0\n";

    /// A document read from the text of another.
    fn again(document: &Document) -> Document {
        let scenario = document.scenario().unwrap_or_else(|error| panic!("{error}"));
        let text = document.to_toml_with(Some(&scenario));
        Document::parse(&text, "again.toml").unwrap_or_else(|error| panic!("{error}"))
    }

    /// A sweep chooses the engine where none is given, so none may be in the text.
    #[test]
    fn an_engine_is_written_where_one_is_given() {
        for (engine, is_given) in [("", false), ("engine = \"event-located\"\n", true)] {
            let document = Document::parse_in_si(&format!("{MUSCLE}{engine}"), "muscle.toml").expect("TOML");
            let again = again(&document);
            assert_eq!(again.contains("run.engine"), is_given);
            assert_eq!(again.scenario(), document.scenario());
        }
    }

    /// Every row is that of the document: the least length follows a thread that varies, which it would not in the text of a scenario.
    #[test]
    fn a_document_with_a_sweep_is_written_as_one() {
        let sweep = "[actuator]\npreset = \"colbrunn-2001\"\n[sweep]\nreductions = [\"length.final\"]\n\
                     [sweep.vary]\n\"load.mass\" = [1.0, 2.0]\n\
                     \"actuator.thread_length\" = { from = 0.112, to = 0.115, count = 2 }\n";
        let document = Document::parse_in_si(&format!("{MUSCLE}{sweep}"), "muscle.toml").expect("TOML");
        let again = again(&document);
        let [one, other] = [&document, &again].map(|of| of.sweep().unwrap_or_else(|why| panic!("{why}")).expect("one"));
        assert_eq!((one.rows(), other.rows()), (4, 4));
        let mut least = Vec::new();
        for row in 0..4 {
            let [one, other] = [&one, &other].map(|of| of.scenario(row).unwrap_or_else(|why| panic!("{why}")));
            least.push(one.actuator.min_length);
            assert_eq!(one, other, "row {row}");
        }
        least.dedup();
        assert!(least.len() > 1, "{least:?}");
        assert_eq!(again.to_toml_with(again.scenario().ok().as_ref()), document.to_toml_with(None));
    }
}
