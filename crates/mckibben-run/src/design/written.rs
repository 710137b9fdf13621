//! A scenario file with values set in it, everything else as it stands: comments, order, spaces.

use mckibben_scenario::list_and_entry;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// The text of a scenario file, to be changed.
#[derive(Clone, Debug)]
pub(super) struct Written(DocumentMut);

impl Written {
    /// Of the text of a file; `None` where it is no TOML.
    pub(super) fn of(text: &str) -> Option<Self> {
        text.parse().ok().map(Self)
    }

    /// The texts of the entries of a list at a path.
    pub(super) fn entries(&self, path: &str) -> Option<Vec<String>> {
        let mut names = path.split('.');
        let item = names.try_fold(self.0.as_item(), |item, name| item.as_table_like()?.get(name))?;
        Some(item.as_array()?.iter().map(|entry| entry.to_string().trim().to_owned()).collect())
    }

    /// Sets a value of a key: TOML where it reads as one value, and a string where it does not. A comment behind the value stays.
    /// An entry of a list has its place behind its path. Where the way is barred by something that is no section nothing is set: a
    /// reading of the scenario has refused it.
    pub(super) fn set(&mut self, path: &str, text: &str) {
        if let Some((list, entry)) = list_and_entry(path) {
            self.set_entry(list, entry, text);
            return;
        }
        let value = text.parse::<Value>().unwrap_or_else(|_| Value::from(text));
        let names: Vec<&str> = path.split('.').collect();
        if let Some((name, sections)) = names.split_last() {
            put(self.0.as_table_mut(), sections, name, value);
        }
    }

    fn set_entry(&mut self, path: &str, place: &str, text: &str) {
        let (Some(mut entries), Ok(place)) = (self.entries(path), place.parse::<usize>()) else { return };
        if let Some(entry) = entries.get_mut(place) {
            *entry = text.parse::<Value>().unwrap_or_else(|_| Value::from(text)).to_string();
            self.set(path, &format!("[{}]", entries.join(", ")));
        }
    }

    /// The text.
    pub(super) fn text(&self) -> String {
        self.0.to_string()
    }
}

fn put(table: &mut dyn TableLike, sections: &[&str], name: &str, mut value: Value) {
    let Some((section, rest)) = sections.split_first() else {
        match table.get_mut(name) {
            Some(Item::Value(known)) => {
                *value.decor_mut() = known.decor().clone();
                *known = value;
            }
            Some(other) => *other = Item::Value(value),
            None => {
                table.insert(name, Item::Value(value));
            }
        }
        return;
    };
    if table.get(section).is_none() {
        let mut inner = Table::new();
        // A section that holds only sections needs no head.
        inner.set_implicit(!rest.is_empty());
        table.insert(section, Item::Table(inner));
    }
    if let Some(inner) = table.get_mut(section).and_then(Item::as_table_like_mut) {
        put(inner, rest, name, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_order_stay() {
        let text = "# A muscle.\n[supply]\ngauge_pressure = \"6 bar\" # as in the shop\n\n[load] # hangs\nmass = \"2 kg\"\n\
                    lag.of = 1\n[a]\ntimes = [\"1 s\", \"2 s\"] # two\n";
        let mut written = Written::of(text).unwrap();
        written.set("supply.gauge_pressure", "\"4 bar\"");
        written.set("load.mass", "3 kg");
        written.set("load.lag.of", "2");
        written.set("command.duty", "0.3");
        written.set("actuators.flexor.turns", "1.5");
        written.set("a.times[1]", "3 s");
        let due = "# A muscle.\n[supply]\ngauge_pressure = \"4 bar\" # as in the shop\n\n[load] # hangs\nmass = \"3 kg\"\n\
                   lag.of = 2\n[a]\ntimes = [\"1 s\", \"3 s\"] # two\n\n[command]\nduty = 0.3\n\n[actuators.flexor]\n\
                   turns = 1.5\n";
        assert_eq!(written.text(), due);
        assert_eq!(written.entries("a.times").unwrap(), ["\"1 s\"", "\"3 s\""]);
        assert!(written.entries("load.mass").is_none() && Written::of("a = ").is_none());
    }
}
