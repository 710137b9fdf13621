//! A TOML document whose every key and value knows its place.
//!
//! The `toml` crate parses; this module keeps what a reading needs: owned values with their bytes in the text, look-up
//! by path (`valve.efficiency`), and values set from outside (a sweep, a command-line option), which carry a small
//! separate text so that an error about them prints what was set.
//!
//! Checked by `tests/scenario.rs and tests/diagnostics.rs`.

use crate::diagnostic::{Class, Diagnostic, Diagnostics, Place, Source};
use crate::keys;
use crate::nearest::nearest;
use crate::quantity;
use crate::reader::list_of;
use crate::text;
use mckibben::parameter as p;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use toml::de::{DeTable, DeValue};

/// A value and its place.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) place: Place,
    pub(crate) value: Value,
}

/// A TOML value. What no key accepts (truth values, dates) is kept by the name of its type.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    String(String),
    /// A number, finite or not.
    Number(f64),
    List(Vec<Node>),
    Table(Table),
    Other(&'static str),
}

impl Value {
    /// The type with its article, for messages.
    pub(crate) fn noun(&self) -> &'static str {
        match self {
            Self::String(_) => "a string",
            Self::Number(_) => "a number",
            Self::List(_) => "a list",
            Self::Table(_) => "a section",
            Self::Other(noun) => noun,
        }
    }
}

/// Keys in the order of the text.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table(pub(crate) Vec<Entry>);

/// A key with its value.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) name: String,
    /// Where the name stands.
    pub(crate) key: Place,
    pub(crate) node: Node,
}

impl Table {
    pub(crate) fn get(&self, name: &str) -> Option<&Entry> {
        self.0.iter().find(|entry| entry.name == name)
    }
}

/// A scenario file that is TOML, before its meaning is read.
#[derive(Clone, Debug)]
pub struct Document {
    source: Arc<Source>,
    root: Table,
}

impl Document {
    /// Parses text; `name` is the file's name in messages.
    ///
    /// # Errors
    /// Everything that keeps the text from being TOML.
    pub fn parse(text: &str, name: &str) -> Result<Self, Diagnostics> {
        Self::of(Source::new(name, text))
    }

    /// Parses text that a program has made: a number where a quantity is due is in SI.
    ///
    /// # Errors
    /// As [`Document::parse`].
    pub fn parse_in_si(text: &str, name: &str) -> Result<Self, Diagnostics> {
        Self::of(Source::in_si(name, text))
    }

    fn of(source: Arc<Source>) -> Result<Self, Diagnostics> {
        if let Some(refused) = text::refused(source.name(), source.text()) {
            return Err(refused.into());
        }
        let root = table_of(&source)?;
        Ok(Self { source, root })
    }

    /// Reads and parses a file.
    ///
    /// # Errors
    /// When the file cannot be read, or is not UTF-8 or not TOML; one message where it is plainly no scenario, as a table or a
    /// picture.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Diagnostics> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let file = std::fs::File::open(path).map_err(|error| {
            Diagnostic::whole(Class::Unreadable, name.as_str(), format!("`{name}` cannot be read: {error}"))
                .help("give the path of a scenario file in UTF-8")
        })?;
        Self::read(file, &name)
    }

    /// Reads a stream to its end and parses it; `name` stands in messages where a file's name would.
    ///
    /// # Errors
    /// As [`Document::load`].
    pub fn read(reader: impl std::io::Read, name: &str) -> Result<Self, Diagnostics> {
        Self::parse(&text::read(reader, name)?, name)
    }

    /// The file's name and text.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Sets the value at a path such as `valve.efficiency`, in place of the file's own or in addition to the other
    /// keys.
    ///
    /// Sections on the way are made when absent. The value is checked when the scenario is read; until then any
    /// path is accepted.
    ///
    /// # Errors
    /// When the path is not one or more bare keys with points between, or runs through something that is no section.
    pub fn set(&mut self, path: &str, value: &toml::Value) -> Result<(), Diagnostics> {
        self.set_text(path, &value.to_string())
    }

    /// As [`Document::set`], from the value's TOML text, for instance `"\"60 psi\""` or `0.85`.
    ///
    /// # Errors
    /// When the text is no TOML value, and as for [`Document::set`].
    pub fn set_text(&mut self, path: &str, value: &str) -> Result<(), Diagnostics> {
        self.set_text_from("value set from outside", path, value)
    }

    /// As [`Document::set_text`]; `name` stands in messages where a file's name would, for instance `--set`.
    ///
    /// # Errors
    /// As for [`Document::set_text`].
    pub fn set_text_from(&mut self, name: &str, path: &str, value: &str) -> Result<(), Diagnostics> {
        self.graft_from(|text| Source::new(name, text), path, value)
    }

    /// As [`Document::set_text_from`], from what people write without a second pair of quotes: TOML where it reads as one value
    /// (`0.5`, `["0 s", "1 s"]`), and a string where it does not (`10 lb`, `exhaust`).
    ///
    /// In a file of many actuators a value that reaches none of its parts is refused when the scenario is read: one for all
    /// actuators that each of them replaces, and one of a supply from which nothing draws.
    ///
    /// # Errors
    /// When the path is no path, as for [`Document::set`].
    pub fn set_plain_from(&mut self, name: &str, path: &str, value: &str) -> Result<(), Diagnostics> {
        let source = |text: String| Source::setting(name, text);
        // A line end could begin a second key, which TOML would read without notice.
        if !value.contains('\n') {
            let mut changed = self.clone();
            if changed.graft_from(source, path, value).is_ok() {
                *self = changed;
                return Ok(());
            }
        }
        self.graft_from(source, path, &text_on_one_line(value))
    }

    /// As [`Document::set_text_from`], from a program: a number where a quantity is due is in SI.
    ///
    /// # Errors
    /// As for [`Document::set_text`].
    pub fn set_in_si(&mut self, name: &str, path: &str, value: &str) -> Result<(), Diagnostics> {
        self.graft_from(|text| Source::in_si(name, text), path, value)
    }

    /// Puts the value of a source in place at its path, which may be that of an entry of a list: `command.time[1]`.
    fn graft_from(
        &mut self,
        source: impl Fn(String) -> Arc<Source>,
        path: &str,
        value: &str,
    ) -> Result<(), Diagnostics> {
        if let Some(names) = path.strip_prefix("sweep.vary.").map(|varied| self.names_of_varied(varied)) {
            let quoted: Vec<String> = names.iter().map(|name| quoted(name)).collect();
            let root = table_of(&source(format!("sweep.vary.{} = {value}", quoted.join("."))))?;
            let names: Vec<&str> = ["sweep", "vary"].into_iter().chain(names.iter().map(String::as_str)).collect();
            return graft(&mut self.root, root, &names);
        }
        match list_and_entry(path) {
            Some((list, entry)) => {
                let source = source(format!("{list} = {value}"));
                let node = self.with_entry(&source, (list, entry))?;
                let place = node.place.clone();
                self.put(list, &place, &node);
                Ok(())
            }
            None => self.graft_value(source(format!("{path} = {value}")), path),
        }
    }

    /// The names under which a path stands in `[sweep.vary]`, or is to stand there. The path may be quoted (`"load.mass"`) or not, and
    /// lead into its range (`load.mass.count`); the way in which the document has it comes first.
    fn names_of_varied(&self, path: &str) -> Vec<String> {
        let unquoted = |quote: char| {
            let (head, tail) = path.strip_prefix(quote)?.split_once(quote)?;
            Some((head, tail.strip_prefix('.').unwrap_or(tail)))
        };
        let (head, tail) = unquoted('"').or_else(|| unquoted('\'')).unwrap_or((path, ""));
        let is_quoted = head != path || path.contains('[');
        let whole = if tail.is_empty() { head.to_owned() } else { format!("{head}.{tail}") };
        let split = |path: &str| path.split('.').filter(|name| !name.is_empty()).map(str::to_owned).collect::<Vec<_>>();
        let under = |name: &str, rest: &str| [vec![name.to_owned()], split(rest)].concat();
        // What stands there in quotes, whole or up to a part of its range.
        if let Some(Value::Table(table)) = self.entry(keys::VARY).map(|entry| &entry.node.value) {
            let quoted = table.0.iter().map(|entry| entry.name.as_str()).filter(|name| name.contains('.'));
            let found = quoted.filter_map(|name| Some((name, whole.strip_prefix(name)?)));
            if let Some((name, rest)) = found.into_iter().find(|(_, rest)| rest.is_empty() || rest.starts_with('.')) {
                return under(name, rest);
            }
        }
        if is_quoted && !self.contains(&format!("{}.{head}", keys::VARY)) {
            return under(head, tail);
        }
        split(&whole)
    }

    /// The list at a path with the value of a source for one of its entries.
    fn with_entry(&self, source: &Arc<Source>, (list, entry): (&str, &str)) -> Result<Node, Diagnostics> {
        let place = Place::new(source.clone(), 0..list.len());
        let alone = Self { source: source.clone(), root: table_of(source)? };
        let new = alone.entry(list).map(|entry| entry.node.clone());
        if let Some((title, help)) = self.no_entry((list, entry)) {
            return Err(Diagnostic::at(Class::UnknownKey, place, title, "names no entry").help(help).into());
        }
        let (Some(new), Some(Entry { node: Node { place: at, value: Value::List(items) }, .. }), Ok(index)) =
            (new, self.entry(list), entry.parse::<usize>())
        else {
            // Not reached: the list has been found. Refused rather than assumed.
            return Err(Diagnostic::at(Class::UnknownKey, place, "this is no path to a key", "names no entry").into());
        };
        let mut items = items.clone();
        items[index] = new;
        Ok(Node { place: at.clone(), value: Value::List(items) })
    }

    /// Puts the value of a source in place at its path.
    fn graft_value(&mut self, source: Arc<Source>, path: &str) -> Result<(), Diagnostics> {
        let names: Vec<&str> = path.split('.').collect();
        let bare =
            |name: &&str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
        if !names.iter().all(bare) {
            let place = Place::new(source, 0..path.len());
            return Err(Diagnostic::at(
                Class::UnknownKey,
                place,
                "this is no path to a key",
                "keys with points between",
            )
            .help("write it as in `valve.efficiency`")
            .into());
        }
        if let Some(found) = self.nameless(path, &Place::new(source.clone(), 0..path.len())) {
            return Err(found.into());
        }
        let root = table_of(&source)?;
        graft(&mut self.root, root, &names)
    }

    /// That a path leads through a part that the document does not name among those that it does: a value there would
    /// add that part.
    pub(crate) fn nameless(&self, path: &str, place: &Place) -> Option<Diagnostic> {
        let names: Vec<&str> = path.split('.').collect();
        let fault = (1..names.len()).find(|end| {
            let above = names[..*end].join(".");
            let section = keys::stands_for(&above);
            // Arms stand under the names of joints, which the reading looks for.
            let names_parts = section != "coupling.arms" && keys::names_its_entries(&section) && self.contains(&above);
            names_parts && !self.contains(&names[..=*end].join("."))
        })?;
        let known: Vec<&str> = self.named(&names[..fault].join(".")).into_iter().map(|(name, _)| name).collect();
        let title = format!("the file has no `{}`", names[..=fault].join("."));
        let found = Diagnostic::at(Class::UnknownKey, place.clone(), title, "names no part of the plant");
        Some(match nearest(names[fault], known.iter().copied()) {
            Some(meant) => found.help(format!("did you mean `{meant}`?")),
            None => found.help(format!("known here: {}", list_of(known.into_iter()))),
        })
    }

    /// Removes the key or section at a path; says whether it was there.
    pub fn remove(&mut self, path: &str) -> bool {
        let (sections, name) = path.rsplit_once('.').map_or((None, path), |(sections, name)| (Some(sections), name));
        let mut table = &mut self.root;
        for section in sections.into_iter().flat_map(|sections| sections.split('.')) {
            match table.0.iter_mut().find(|entry| entry.name == section).map(|entry| &mut entry.node.value) {
                Some(Value::Table(inner)) => table = inner,
                _ => return false,
            }
        }
        let before = table.0.len();
        table.0.retain(|entry| entry.name != name);
        table.0.len() < before
    }

    /// Whether something stands at a path.
    pub fn contains(&self, path: &str) -> bool {
        self.entry(path).is_some()
    }

    /// The place of the key at a path.
    pub fn place(&self, path: &str) -> Option<&Place> {
        self.entry(path).map(|entry| &entry.key)
    }

    /// Puts a value of this document, or of another, at a path, with its own place. Where the way is barred by something
    /// that is no section nothing is put; a reading finds that mistake.
    pub(crate) fn put(&mut self, path: &str, key: &Place, node: &Node) {
        let (sections, name) = path.rsplit_once('.').unwrap_or(("", path));
        let mut table = &mut self.root;
        for section in sections.split('.').filter(|section| !section.is_empty()) {
            let at = table.0.iter().position(|entry| entry.name == section).unwrap_or(table.0.len());
            if at == table.0.len() {
                let node = Node { place: key.clone(), value: Value::Table(Table::default()) };
                table.0.push(Entry { name: section.to_owned(), key: key.clone(), node });
            }
            match &mut table.0[at].node.value {
                Value::Table(inner) => table = inner,
                _ => return,
            }
        }
        let entry = Entry { name: name.to_owned(), key: key.clone(), node: node.clone() };
        match table.0.iter_mut().find(|entry| entry.name == name) {
            Some(known) => *known = entry,
            None => table.0.push(entry),
        }
    }

    /// As [`Document::put`], at a path that may be that of an entry of a list, such as `command.time[1]`, which is put where the list
    /// has that entry.
    pub(crate) fn put_at(&mut self, path: &str, key: &Place, node: &Node) {
        let Some((list, entry)) = list_and_entry(path) else { return self.put(path, key, node) };
        let found = self.entry(list).map(|found| (found.key.clone(), found.node.clone()));
        let (Some((key, mut whole)), Ok(index)) = (found, entry.parse::<usize>()) else { return };
        if let Value::List(items) = &mut whole.value
            && let Some(item) = items.get_mut(index)
        {
            *item = node.clone();
            self.put(list, &key, &whole);
        }
    }

    /// The value at a path, which may be that of an entry of a list.
    pub(crate) fn node_at(&self, path: &str) -> Option<&Node> {
        let Some((list, entry)) = list_and_entry(path) else { return self.entry(path).map(|entry| &entry.node) };
        match &self.entry(list)?.node.value {
            Value::List(items) => items.get(entry.parse::<usize>().ok()?),
            _ => None,
        }
    }

    /// Why the file has no entry of a list at a path: what is wrong and what to do, or `None` where it has one.
    pub(crate) fn no_entry(&self, (list, entry): (&str, &str)) -> Option<(String, &'static str)> {
        match self.entry(list).map(|entry| &entry.node.value) {
            Some(Value::List(items)) => {
                let is_there = entry.parse::<usize>().is_ok_and(|index| index < items.len());
                let title = || format!("`{list}` has {} entries, and none `[{entry}]`", items.len());
                (!is_there).then(|| (title(), "count from 0, as in `[0]`"))
            }
            _ => {
                let help = "write the path of a list of the file, with the place of its entry from 0";
                Some((format!("the file has no list `{list}`"), help))
            }
        }
    }

    /// Every key with its value as TOML in its section, the keys of a section before its sections and else in the order of the
    /// file: documents with equal text say the same.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        sections_of(&self.root, "", &mut text);
        text
    }

    pub(crate) fn root(&self) -> &Table {
        &self.root
    }

    /// Single quantities of the keys that `is_one` takes, in SI, wherever the file gives them: of all, of a part of a plant or of the
    /// antagonist of a joint. What is no quantity is left out.
    pub(crate) fn quantities(&self, is_one: impl Fn(&str) -> bool) -> Vec<(String, &Node, f64)> {
        let mut found = Vec::new();
        let mut tables = vec![(String::new(), &self.root)];
        while let Some((above, table)) = tables.pop() {
            for entry in &table.0 {
                let path = if above.is_empty() { entry.name.clone() } else { format!("{above}.{}", entry.name) };
                let value = match &entry.node.value {
                    Value::Table(inner) => {
                        tables.push((path, inner));
                        continue;
                    }
                    Value::String(text) => quantity::parse(text).ok().map(|read| read.value),
                    Value::Number(value) => Some(*value),
                    Value::List(_) | Value::Other(_) => None,
                };
                let key = keys::stands_for(path.strip_prefix("antagonist.").unwrap_or(&path));
                if let Some(value) = value.filter(|_| is_one(&key)) {
                    found.push((path, &entry.node, value));
                }
            }
        }
        found
    }

    /// The highest gauge pressure in Pa that the file gives of a supply, or none.
    pub fn highest_supply(&self) -> Option<f64> {
        let rows = [&p::SUPPLY_GAUGE_PRESSURE, &p::RESERVOIR_PRESSURE, &p::CUT_OUT];
        let found = self.quantities(|key| rows.iter().any(|row| row.key == key));
        found.into_iter().map(|(_, _, gauge)| gauge).reduce(f64::max)
    }

    /// The absolute pressure of the atmosphere in Pa that the file gives, or the usual one.
    pub fn atmosphere(&self) -> f64 {
        let row = &p::ATMOSPHERIC_PRESSURE;
        let given = self.quantities(|key| key == row.key).first().map(|(_, _, pressure)| *pressure);
        given.or(row.default).unwrap_or(0.0)
    }

    pub(crate) fn entry(&self, path: &str) -> Option<&Entry> {
        let mut names = path.split('.');
        let mut entry = self.root.get(names.next()?)?;
        for name in names {
            let Value::Table(table) = &entry.node.value else { return None };
            entry = table.get(name)?;
        }
        Some(entry)
    }
}

/// The keys of a section, then the sections in it: in this order TOML writes a table, so that what is read from either says the
/// same.
fn sections_of(table: &Table, path: &str, text: &mut String) {
    let inner = |entry: &Entry| matches!(entry.node.value, Value::Table(_));
    if !path.is_empty() && (table.0.is_empty() || !table.0.iter().all(inner)) {
        let gap = if text.is_empty() { "" } else { "\n" };
        text.push_str(&format!("{gap}[{path}]\n"));
    }
    for Entry { name, node, .. } in table.0.iter().filter(|entry| !inner(entry)) {
        text.push_str(&format!("{} = {}\n", quoted(name), said(node, unit_at(path, name))));
    }
    for Entry { name, node, .. } in &table.0 {
        if let Value::Table(inner) = &node.value {
            let name = quoted(name);
            sections_of(inner, &if path.is_empty() { name } else { format!("{path}.{name}") }, text);
        }
    }
}

/// A key, in quotes where it needs them.
fn quoted(name: &str) -> String {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
    if bare { name.to_owned() } else { toml::Value::from(name).to_string() }
}

/// The unit of a key of a section; empty where its values are no quantities.
fn unit_at(section: &str, name: &str) -> &'static str {
    let path = if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") };
    keys::key_at(&keys::stands_for(&path)).and_then(keys::Key::parameter).map_or("", |row| row.unit)
}

/// A value as TOML, numbers in the digits that identify them; a number that a program gave for a
/// quantity has its SI unit.
fn said(node: &Node, unit: &str) -> String {
    let unit = if node.place.source().numbers_are_si() { unit } else { "" };
    match &node.value {
        Value::String(words) => toml::Value::from(words.as_str()).to_string(),
        Value::Number(number) if unit.is_empty() => toml::Value::from(*number).to_string(),
        Value::Number(number) => toml::Value::from(quantity::format(*number, unit)).to_string(),
        Value::List(items) => {
            let items: Vec<String> = items.iter().map(|item| said(item, unit)).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Table(table) => {
            let entries = table.0.iter().map(|entry| format!("{} = {}", quoted(&entry.name), said(&entry.node, unit)));
            format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
        }
        // What no key takes has been refused; its text says what it was.
        Value::Other(what) => toml::Value::from(*what).to_string(),
    }
}

/// What the parser of TOML says of a key or section that is there already.
const TWICE: &str = "duplicate key";

/// Parses a source and takes ownership of what is in it.
fn table_of(source: &Arc<Source>) -> Result<Table, Diagnostics> {
    let (parsed, errors) = DeTable::parse_recoverable(source.text());
    let found = errors.into_iter().map(|error| {
        let mut span = error.span().unwrap_or(0..0);
        // An error at a line's end is printed on that line, not below it.
        if span.is_empty() || source.text().get(span.clone()) == Some("\n") {
            span.end = span.start;
        }
        let place = Place::new(source.clone(), span);
        if error.message() == TWICE {
            let title = format!("`{}` stands in the file twice", place.text());
            return Diagnostic::at(Class::Syntax, place, title, "again here")
                .help("keep one of the two, or join the sections");
        }
        Diagnostic::at(Class::Syntax, place, format!("this is not TOML: {}", error.message()), "here")
            .help("values are strings such as \"60 psi\", numbers such as 0.85, or lists; see https://toml.io")
    });
    let found: Vec<Diagnostic> = found.collect();
    if let Some(first) = found.first().filter(|_| found.len() > text::MANY) {
        return Err(text::instead_of_many(source.name(), found.len(), first).into());
    }
    Diagnostics::check(found)?;
    Ok(owned_table(source, parsed.into_inner()))
}

fn owned_table(source: &Arc<Source>, table: DeTable<'_>) -> Table {
    let entries = table.into_iter().map(|(key, value)| {
        let place = Place::new(source.clone(), key.span());
        Entry { name: key.into_inner().into_owned(), key: place, node: owned(source, value.span(), value.into_inner()) }
    });
    let mut entries: Vec<Entry> = entries.collect();
    entries.sort_by_key(|entry| entry.key.span().start);
    Table(entries)
}

fn owned(source: &Arc<Source>, span: Range<usize>, value: DeValue<'_>) -> Node {
    let value = match value {
        DeValue::String(text) => Value::String(text.into_owned()),
        DeValue::Integer(number) => Value::Number(integer(number.as_str(), number.radix())),
        DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(_) => Value::Other("a truth value"),
        DeValue::Datetime(_) => Value::Other("a date"),
        DeValue::Array(list) => {
            Value::List(list.into_iter().map(|value| owned(source, value.span(), value.into_inner())).collect())
        }
        DeValue::Table(table) => Value::Table(owned_table(source, table)),
    };
    Node { place: Place::new(source.clone(), span), value }
}

/// The `f64` nearest to a whole number; not finite when even that is too small for it.
fn integer(text: &str, radix: u32) -> f64 {
    match radix {
        10 => text.parse().unwrap_or(f64::NAN),
        _ => i128::from_str_radix(text, radix).map_or(f64::NAN, |whole| whole as f64),
    }
}

/// Puts the value at `names` of `from` into the same place of `into`.
fn graft(into: &mut Table, from: Table, names: &[&str]) -> Result<(), Diagnostics> {
    let Some(entry) = from.0.into_iter().next() else { return Ok(()) };
    let found = into.0.iter().position(|known| known.name == entry.name);
    let Some(found) = found else {
        into.0.push(entry);
        return Ok(());
    };
    let known = &mut into.0[found];
    if names.len() < 2 {
        known.node = entry.node;
        known.key = entry.key;
        return Ok(());
    }
    match (&mut known.node.value, entry.node.value) {
        (Value::Table(into), Value::Table(from)) => graft(into, from, &names[1..]),
        (other, _) => {
            let title = format!("`{}` is {}, which holds no keys", entry.name, other.noun());
            Err(Diagnostic::at(Class::WrongType, entry.key, title, "not a section")
                .related(Some(known.key.clone()), "given here")
                .into())
        }
    }
}

/// The path of a list and what names its entry, of a path such as `command.time[1]`.
pub fn list_and_entry(path: &str) -> Option<(&str, &str)> {
    path.strip_suffix(']')?.split_once('[')
}

/// A text as a TOML string that stands on one line, whatever it holds.
fn text_on_one_line(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => quoted.extend(['\\', character]),
            control if control.is_control() => quoted.push_str(&format!("\\u{:04X}", control as u32)),
            plain => quoted.push(plain),
        }
    }
    quoted + "\""
}
