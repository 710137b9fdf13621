//! The typed reader: takes values out of a document and collects every mistake on the way.
//!
//! Each method returns what it could read and notes what it could not. A caller may go on with a stand-in after a
//! mistake has been noted, because [`Reader::finish`] then returns the mistakes and the stand-ins are dropped; so
//! one reading finds all there is to mend.
//!
//! Checked by `tests/diagnostics.rs`, one test for each class of mistake.

mod known;
mod unread;

use crate::choice::{Choice, Word};
use crate::diagnose::rounded;
use crate::diagnostic::{Class, Diagnostic, Diagnostics, Place};
use crate::dimension::Dimension;
use crate::document::{Document, Entry, Node, Value};
use crate::keys::{self, KEYS, Key, SECTIONS};
use crate::nearest::nearest;
use crate::presets::Preset;
use crate::quantity;
use mckibben::parameter::{self, Parameter, Range};
pub(crate) use unread::Unread;

/// What a method returns in place of a value whose mistake has been noted.
const STAND_IN: f64 = 1.0;

pub(crate) struct Reader<'d> {
    document: &'d Document,
    found: Vec<Diagnostic>,
    /// Paths that misspelt keys stand for; their absence is no second mistake.
    meant: Vec<String>,
    /// Whether the document is of a plant, which has more sections.
    of_plant: bool,
}

impl<'d> Reader<'d> {
    /// Starts a reading: checks that every section and key is known, then that every key applies.
    pub(crate) fn new(document: &'d Document) -> Self {
        let mut reader = Self { document, found: Vec::new(), meant: Vec::new(), of_plant: document.is_plant() };
        reader.known(document.root(), "");
        reader.applies(|_| true);
        reader
    }

    /// Starts a reading of what a document says of one part of a plant: `whole` has checked that every key is known.
    pub(crate) fn of_part(document: &'d Document, whole: &Reader<'_>) -> Self {
        let meant = whole.meant.iter().map(|path| keys::stands_for(path)).collect();
        let mut reader = Self { document, found: Vec::new(), meant, of_plant: true };
        reader.applies(|_| true);
        reader
    }

    /// Starts a reading of one section: checks its keys and no others.
    pub(crate) fn of_section(document: &'d Document, section: &str) -> Self {
        let mut reader = Self { document, found: Vec::new(), meant: Vec::new(), of_plant: false };
        if let Some(Value::Table(table)) = reader.entry(section).map(|entry| &entry.node.value) {
            reader.known(table, section);
        }
        reader.applies(|key| key.section() == section);
        reader
    }

    /// Ends the reading.
    pub(crate) fn finish(self) -> Result<(), Diagnostics> {
        Diagnostics::check(self.found)
    }

    /// Notes a mistake.
    pub(crate) fn note(&mut self, diagnostic: Diagnostic) {
        self.found.push(diagnostic);
    }

    pub(crate) fn document(&self) -> &'d Document {
        self.document
    }

    pub(crate) fn entry(&self, path: &str) -> Option<&'d Entry> {
        self.document.entry(path)
    }

    pub(crate) fn has(&self, path: &str) -> bool {
        self.document.contains(path)
    }

    /// The key's place, for mistakes that are about its presence.
    pub(crate) fn key_place(&self, path: &str) -> Option<Place> {
        self.document.place(path).cloned()
    }

    /// The value's place, for mistakes that are about what it is.
    pub(crate) fn value_place(&self, path: &str) -> Option<Place> {
        self.entry(path).map(|entry| entry.node.place.clone())
    }

    /// The place of one entry of a list, or of the whole value.
    pub(crate) fn item_place(&self, path: &str, index: usize) -> Option<Place> {
        match &self.entry(path)?.node.value {
            Value::List(items) => items.get(index).map(|item| item.place.clone()),
            _ => None,
        }
        .or_else(|| self.value_place(path))
    }

    /// Notes that a key is absent, at the header of its section. `because` says why it must be there.
    pub(crate) fn missing(&mut self, path: &str, because: &str) {
        self.missing_or(path, because, None);
    }

    /// As [`Reader::missing`]; `instead` says what else would do.
    fn missing_or(&mut self, path: &str, because: &str, instead: Option<&str>) {
        if self.is_meant(path) {
            return;
        }
        let (section, name) = path.rsplit_once('.').unwrap_or(("", path));
        let example = keys::key_at(path).map(|key| format!("add for instance `{name} = {}`", key.example));
        let parameter = keys::key_at(path).and_then(Key::parameter);
        let what = parameter.map_or(String::new(), |row| format!(" ({})", row.symbol));
        let diagnostic = match self.entry(section) {
            // A section that is no section has been refused already.
            Some(entry) if !matches!(entry.node.value, Value::Table(_)) => return,
            Some(entry) => {
                let title = format!("`{path}`{what} is missing{because}");
                Diagnostic::at(Class::Missing, entry.key.clone(), title, format!("`{name}` is expected here"))
            }
            None => {
                let title = format!("`{path}`{what} is missing{because}");
                Diagnostic::whole(Class::Missing, self.document.source().name(), title)
                    .help(format!("add a section `[{section}]`"))
            }
        };
        let remedies = example.into_iter().chain(instead.map(str::to_owned));
        self.note(remedies.fold(diagnostic, Diagnostic::help));
    }

    /// Notes that a whole section is absent, at the section that requires it or at the end.
    pub(crate) fn missing_section(&mut self, section: &str, wanted_by: Option<&str>) {
        if self.meant.iter().any(|meant| meant == section) {
            return;
        }
        let place = wanted_by.and_then(|path| self.key_place(path));
        let diagnostic = match (place, wanted_by) {
            (Some(place), Some(by)) => {
                let title = format!("the section [{section}] is missing, which [{by}] needs");
                Diagnostic::at(Class::Missing, place, title, format!("needs [{section}]"))
            }
            _ => {
                let title = format!("the section [{section}] is missing");
                Diagnostic::whole(Class::Missing, self.document.source().name(), title)
            }
        };
        let needed = KEYS.iter().filter(|key| key.section() == section && key.required && key.when.is_none());
        let by_controller = section == "command" && self.has("controller");
        let example = |key: &Key| if by_controller && key.name() == "kind" { "\"controllers\"" } else { key.example };
        let lines: Vec<String> = needed.map(|key| format!("`{} = {}`", key.name(), example(key))).collect();
        self.note(diagnostic.help(format!("add `[{section}]` with at least {}", lines.join(" and "))));
    }

    /// The key's value, or `None` when it is absent or its mistake has been noted.
    pub(crate) fn number(&mut self, row: &'static Parameter) -> Option<f64> {
        let entry = self.entry(row.key)?;
        self.quantity(&entry.node, row)
    }

    /// As [`Reader::number`], for a key that also takes a word, which the caller has ruled out.
    pub(crate) fn number_or(&mut self, row: &'static Parameter, word: &str) -> Option<f64> {
        self.quantity_or(&self.entry(row.key)?.node, row, word)
    }

    /// A value that may also be a word, which the caller has ruled out.
    fn quantity_or(&mut self, node: &Node, row: &Parameter, word: &str) -> Option<f64> {
        match &node.value {
            // What starts with a letter is a word gone wrong, not a quantity.
            Value::String(text) if text.trim_start().starts_with(|c: char| c.is_alphabetic()) => {
                let title = format!("\"{text}\" is not a valid value of `{}`", row.key);
                let diagnostic = Diagnostic::at(Class::InvalidChoice, node.place.clone(), title, "unknown word");
                let meant = nearest(text, [word]).map(|name| format!("did you mean \"{name}\"?"));
                let valid = format!("valid: `{word}`, or {}", dimension_of(row.unit).noun());
                self.note(meant.into_iter().fold(diagnostic, Diagnostic::help).help(valid));
                None
            }
            _ => self.quantity(node, row),
        }
    }

    /// The key's value, else the preset's, else the table's default; when there is none the key is missing.
    pub(crate) fn value(&mut self, row: &'static Parameter, preset: Option<&Preset>) -> f64 {
        if self.has(row.key) {
            return self.number(row).unwrap_or(STAND_IN);
        }
        let given = preset.and_then(|preset| preset.get(row)).and_then(|value| value.value());
        given.or(row.default).unwrap_or_else(|| {
            self.missing(row.key, "");
            STAND_IN
        })
    }

    /// The key's value, which the caller has read, else the table's default; when there is none the key is missing, and `instead` says
    /// what else would do.
    pub(crate) fn value_or(&mut self, row: &'static Parameter, read: Option<f64>, instead: Option<&str>) -> f64 {
        match read.or(row.default) {
            Some(value) => value,
            // Its mistake has been noted.
            None if self.has(row.key) => STAND_IN,
            None => {
                self.missing_or(row.key, "", instead);
                STAND_IN
            }
        }
    }

    /// Whether a misspelt key stands for the one at a path.
    pub(crate) fn is_meant(&self, path: &str) -> bool {
        self.meant.iter().any(|meant| meant == path)
    }

    /// The value of a key whose absence the caller has noted.
    pub(crate) fn noted(&mut self, row: &'static Parameter) -> f64 {
        self.number(row).unwrap_or(STAND_IN)
    }

    /// The name of a part of the file, or `None` when it is absent or is no string.
    pub(crate) fn name(&mut self, path: &str) -> Option<&'d str> {
        let node = &self.entry(path)?.node;
        match &node.value {
            Value::String(name) => Some(name),
            other => {
                let title = format!("`{path}` is a name, not {}", other.noun());
                let help = "write the name in quotes";
                self.note(Diagnostic::at(Class::WrongType, node.place.clone(), title, "a name is expected").help(help));
                None
            }
        }
    }

    /// Notes a name that no part of the file has; `what` is what it should be the name of.
    pub(crate) fn no_such(&mut self, place: Place, name: &str, what: &str, known: &[&str]) {
        let title = format!("there is no {what} `{name}`");
        let diagnostic = Diagnostic::at(Class::InvalidChoice, place, title, "unknown name");
        let meant = nearest(name, known.iter().copied()).map(|name| format!("did you mean \"{name}\"?"));
        let valid = match known {
            [] => format!("the file names no {what}"),
            known => format!("known: {}", list_of(known.iter().copied())),
        };
        self.note(meant.into_iter().fold(diagnostic, Diagnostic::help).help(valid));
    }

    /// Takes over the mistakes of the reading of a part, with the paths that they have in the whole file; says whether there is
    /// none.
    pub(crate) fn take(&mut self, part: Reader<'_>, name: impl Fn(&str) -> Option<String>) -> bool {
        self.take_all(part.into_mistakes(), name)
    }

    /// As [`Reader::take`], of a reading that has ended.
    pub(crate) fn take_all(&mut self, found: Vec<Diagnostic>, name: impl Fn(&str) -> Option<String>) -> bool {
        let sound = found.is_empty();
        self.found.extend(found.into_iter().map(|diagnostic| diagnostic.renamed(&name)));
        sound
    }

    /// Ends the reading of a part with what it noted.
    pub(crate) fn into_mistakes(self) -> Vec<Diagnostic> {
        self.found
    }

    /// How many mistakes have been noted.
    pub(crate) fn mistakes(&self) -> usize {
        self.found.len()
    }

    /// Names a key of which mistakes from one on were noted by its path in the file, as in `mechanism.joints.elbow.damping` for
    /// `mechanism.joints.*.damping`.
    pub(crate) fn name_from(&mut self, first: usize, key: &str, path: &str) {
        let last = |of: &str| of.rsplit('.').next().unwrap_or_default().to_owned();
        let named = |words: &str| match words.strip_prefix("* = ") {
            Some(value) => Some(format!("{} = {value}", last(path))),
            None if words.starts_with(path) => None,
            None => words.contains(key).then(|| words.replacen(key, path, 1)),
        };
        let noted = self.found.split_off(first);
        self.found.extend(noted.into_iter().map(|diagnostic| diagnostic.renamed(named)));
    }

    /// Whether a mistake has been noted.
    pub(crate) fn has_mistakes(&self) -> bool {
        !self.found.is_empty()
    }

    /// A list of quantities, or `None` when it is absent or has a mistake.
    pub(crate) fn list(&mut self, row: &'static Parameter) -> Option<Vec<f64>> {
        self.list_of(self.entry(row.key)?, row)
    }

    fn list_of(&mut self, entry: &'d Entry, row: &Parameter) -> Option<Vec<f64>> {
        let items = self.items(entry)?;
        if let Some(inner) = items.iter().find(|item| matches!(item.value, Value::List(_))) {
            let title = format!("`{}` is one list of numbers, not a list of lists", row.key);
            let help = match row.key == parameter::MAP_TENSION.key {
                true => {
                    "give the rows one after the other, a row for each pressure with a tension for each length: of an array of that \
                     shape, `ravel()`"
                }
                false => "give all entries one after the other, without brackets within the list",
            };
            self.note(Diagnostic::at(Class::WrongType, inner.place.clone(), title, "a list in the list").help(help));
            return None;
        }
        let read: Vec<Option<f64>> = items.iter().map(|item| self.quantity(item, row)).collect();
        read.into_iter().collect()
    }

    /// A list, which must have at least one entry.
    fn items(&mut self, entry: &'d Entry) -> Option<&'d [Node]> {
        self.items_of(&entry.node, &entry.name)
    }

    /// The entries of a value that is a list; `name` is its key's.
    pub(crate) fn items_of(&mut self, node: &'d Node, name: &str) -> Option<&'d [Node]> {
        let place = node.place.clone();
        match &node.value {
            Value::List(items) if items.is_empty() => {
                let title = format!("the list `{name}` is empty");
                self.note(
                    Diagnostic::at(Class::BadList, place, title, "at least one entry is expected")
                        .help("give one entry or more, or remove the key"),
                );
                None
            }
            Value::List(items) => Some(items),
            other => {
                let title = format!("`{name}` is a list, not {}", other.noun());
                let help = "write the entries between `[` and `]` with commas between";
                self.note(Diagnostic::at(Class::WrongType, place, title, "a list is expected").help(help));
                None
            }
        }
    }

    /// One word, or `None` when it is absent or its mistake has been noted.
    pub(crate) fn word<W: Word>(&mut self, path: &str) -> Option<W> {
        let entry = self.entry(path)?;
        W::from_name(self.one_of(&entry.node, path, W::CHOICES)?)
    }

    /// One word, of the file or of its preset.
    pub(crate) fn word_or<W: Word>(&mut self, path: &str, preset: Option<&Preset>) -> Option<W> {
        match preset.and_then(|preset| preset.word(path)).filter(|_| !self.has(path)) {
            Some(word) => W::from_name(word),
            None => self.word(path),
        }
    }

    /// A list of words, or `None` when it is absent or has a mistake.
    pub(crate) fn words<W: Word>(&mut self, path: &str) -> Option<Vec<W>> {
        let entry = self.entry(path)?;
        let items = self.items(entry)?;
        let read: Vec<Option<&str>> = items.iter().map(|item| self.one_of(item, path, W::CHOICES)).collect();
        read.into_iter().map(|name| name.and_then(W::from_name)).collect()
    }

    /// The string at a path when it is one of `choices`.
    pub(crate) fn chosen(&mut self, path: &str, choices: &[Choice]) -> Option<&'static str> {
        let entry = self.entry(path)?;
        self.one_of(&entry.node, path, choices)
    }

    pub(crate) fn one_of(&mut self, node: &Node, path: &str, choices: &[Choice]) -> Option<&'static str> {
        let names = || choices.iter().map(|choice| choice.name);
        let valid = format!("valid: {}", list_of(names()));
        match &node.value {
            Value::String(word) => {
                let found = names().find(|name| name == word);
                if found.is_none() {
                    let title = format!("\"{word}\" is not a valid value of `{path}`");
                    let diagnostic = Diagnostic::at(Class::InvalidChoice, node.place.clone(), title, "unknown word");
                    let meant = nearest(word, names()).map(|name| format!("did you mean \"{name}\"?"));
                    self.note(meant.into_iter().fold(diagnostic, Diagnostic::help).help(valid));
                }
                found
            }
            other => {
                let title = format!("`{path}` is one of several words, not {}", other.noun());
                let label = "a word in quotes is expected";
                self.note(Diagnostic::at(Class::WrongType, node.place.clone(), title, label).help(valid));
                None
            }
        }
    }

    /// Whether the value at a path is this very string.
    pub(crate) fn says(&self, path: &str, word: &str) -> bool {
        matches!(self.entry(path).map(|entry| &entry.node.value), Some(Value::String(said)) if said == word)
    }

    /// The size in SI of the unit named at a path.
    pub(crate) fn unit(&mut self, path: &str, like: &str) -> Option<f64> {
        self.unit_of(&self.entry(path)?.node, path, like)
    }

    /// The size in SI of the unit that a value names.
    pub(crate) fn unit_of(&mut self, node: &Node, path: &str, like: &str) -> Option<f64> {
        let name = path.rsplit('.').next().unwrap_or(path);
        let expected = dimension_of(like);
        let Value::String(text) = &node.value else {
            let title = format!("`{path}` is a unit, not {}", node.value.noun());
            let place = node.place.clone();
            let help = format!("write it as in `{name} = \"{like}\"`");
            self.note(Diagnostic::at(Class::WrongType, place, title, "a string is expected").help(help));
            return None;
        };
        match quantity::parse_unit(text) {
            Ok((dimension, size)) if dimension == expected => return Some(size),
            Ok((dimension, _)) => {
                let (found, due) = (dimension.noun(), noun_of(path, like));
                let title = format!("\"{text}\" is a unit of {found}, but `{path}` is one of {due}");
                let place = node.place.clone();
                let help = format!("write it as in `{name} = \"{like}\"`");
                self.note(Diagnostic::at(Class::WrongDimension, place, title, "wrong dimension").help(help));
            }
            Err(error) => self.bad(node, text, error),
        }
        None
    }

    fn bad(&mut self, node: &Node, text: &str, error: quantity::QuantityError) {
        let place = inside(&node.place, text, error.span);
        let diagnostic = Diagnostic::at(Class::BadQuantity, place, error.message, "here");
        self.note(error.help.into_iter().fold(diagnostic, Diagnostic::help));
    }

    /// A whole number, or `None` when it is absent or its mistake has been noted.
    pub(crate) fn whole(&mut self, row: &'static Parameter) -> Option<u64> {
        let entry = self.entry(row.key)?;
        self.whole_of(&entry.node, row)
    }

    /// A value that is a whole number.
    pub(crate) fn whole_of(&mut self, node: &Node, row: &Parameter) -> Option<u64> {
        let value = self.quantity(node, row)?;
        if value.fract() != 0.0 {
            self.note(out_of_range(node.place.clone(), row, value, "a whole number"));
            return None;
        }
        Some(value as u64)
    }

    /// A difference of quantities, in which `degC` and `degF` have no meaning.
    pub(crate) fn difference(&mut self, node: &Node, row: &Parameter) -> Option<f64> {
        if let Value::String(text) = &node.value
            && let Some(error) = quantity::with_own_zero(text)
        {
            self.bad(node, text, error);
            return None;
        }
        self.quantity(node, row)
    }

    /// A quantity in the parameter's unit and range.
    pub(crate) fn quantity(&mut self, node: &Node, row: &Parameter) -> Option<f64> {
        let expected = dimension_of(row.unit);
        let place = || node.place.clone();
        let pure = expected == Dimension::NONE;
        let value = match &node.value {
            Value::Number(value) if pure || node.place.source().numbers_are_si() => *value,
            Value::Number(_) => {
                self.note(without_unit(place(), row, expected, node.place.text()));
                return None;
            }
            Value::String(text) => match quantity::parse(text) {
                Err(error) => {
                    self.bad(node, text, error);
                    return None;
                }
                Ok(read) if !read.has_unit && pure => {
                    let title = format!("`{}` is a number, not a string", row.key);
                    let help = format!("write `{}` without quotes", text.trim());
                    self.note(Diagnostic::at(Class::WrongType, place(), title, "a number is expected").help(help));
                    return None;
                }
                Ok(read) if !read.has_unit => {
                    self.note(without_unit(place(), row, expected, text.trim()));
                    return None;
                }
                Ok(read) if read.dimension != expected => {
                    self.note(wrong_dimension(place(), row, expected, read.dimension, text));
                    return None;
                }
                Ok(read) => read.value,
            },
            other => {
                let title = format!("`{}` is {}, not {}", row.key, noun_of(row.key, row.unit), other.noun());
                let label = if pure { "a number is expected" } else { "a string with number and unit is expected" };
                let diagnostic = Diagnostic::at(Class::WrongType, place(), title, label);
                self.note(example_of(row, expected).into_iter().fold(diagnostic, Diagnostic::help));
                return None;
            }
        };
        if row.range.contains(value) {
            return Some(value);
        }
        self.note(match &node.value {
            Value::String(text) if row.unit == "rad" && text.contains(['d', '°']) && !text.contains("rad") => {
                angle_out_of_range(place(), row, text)
            }
            _ => out_of_range(place(), row, value, &format!("{} {}", row.range, row.unit)),
        });
        None
    }
}

/// The dimension of an SI unit of the parameter table.
pub(crate) fn dimension_of(unit: &str) -> Dimension {
    // A test reads every unit of the table, so the fallback is never seen.
    quantity::parse_unit(unit).map_or(Dimension::NONE, |(dimension, _)| dimension)
}

/// What a key is, with its article. Quantities of several kinds share some dimensions; there its unit and name decide.
pub(crate) fn noun_of(key: &str, unit: &str) -> String {
    let dimension = dimension_of(unit);
    let name = key.rsplit('.').next().unwrap_or(key);
    let noun = match dimension {
        Dimension::DAMPING if unit.contains('N') => "a damping coefficient",
        Dimension::MASS_FLOW => "a mass flow",
        Dimension::ENERGY if unit.contains('N') => "a torque",
        Dimension::ENERGY => "an energy",
        Dimension::CONDUCTANCE if name == "leakage" => "a volume flow over a pressure",
        Dimension::CONDUCTANCE => "a sonic conductance",
        Dimension::AREA if name == "coulomb_force_per_pressure" => "a force over a pressure",
        _ => return dimension.noun(),
    };
    noun.to_owned()
}

/// Words in quotes with commas between.
pub(crate) fn list_of<'w>(words: impl Iterator<Item = &'w str>) -> String {
    words.map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

/// A value outside what is admissible; `admissible` is words such as "greater than 0 Pa".
pub(crate) fn out_of_range(place: Place, row: &Parameter, value: f64, admissible: &str) -> Diagnostic {
    let title = format!("`{}` = {} is out of range", row.key, quantity::format(rounded(value), row.unit));
    if !value.is_finite() {
        return Diagnostic::at(Class::OutOfRange, place, title, "is no finite number").help("give a finite number");
    }
    let label = format!("must be {}", admissible.trim_end());
    let diagnostic = Diagnostic::at(Class::OutOfRange, place, title, label);
    // A share that is too large is often meant in percent.
    if row.unit.is_empty() && row.range.high == 1.0 && value > 1.0 && value <= 100.0 {
        return diagnostic.help(format!("write \"{value} %\" if {value} percent are meant; else {}", row.remedy));
    }
    diagnostic.help(row.remedy)
}

/// An angle that is given in degrees, outside its range, which is reported in degrees.
fn angle_out_of_range(place: Place, row: &Parameter, text: &str) -> Diagnostic {
    // Ends of ranges are whole degrees but for rounding.
    let degrees = |angle: f64| (angle.to_degrees() * 1e9).round() / 1e9;
    let range = Range { low: degrees(row.range.low), high: degrees(row.range.high), ..row.range };
    let title = format!("`{}` = {} is out of range", row.key, text.trim());
    Diagnostic::at(Class::OutOfRange, place, title, format!("must be {range} deg")).help(row.remedy)
}

fn example_of(row: &Parameter, expected: Dimension) -> Option<String> {
    let example =
        keys::key_at(row.key).filter(|key| key.parameter().is_some()).map(|key| key.example).or(expected.example())?;
    Some(format!("write it as in `{} = {example}`", row.key.rsplit('.').next().unwrap_or(row.key)))
}

fn without_unit(place: Place, row: &Parameter, expected: Dimension, number: &str) -> Diagnostic {
    let title = format!("`{}` is {} and needs a unit", row.key, noun_of(row.key, row.unit));
    // The unit that the key's own example has, which is the usual one of this quantity and not of its dimension alone.
    let example = keys::key_at(row.key).map(|key| key.example.trim_matches('"')).unwrap_or_default();
    let usual = example.split_once(' ').map(|(_, unit)| unit).filter(|unit| {
        *unit != row.unit && quantity::parse(&format!("1 {unit}")).is_ok_and(|read| read.dimension == expected)
    });
    let help = match usual {
        Some(unit) => format!("write the unit that it is in, as \"{number} {unit}\" or \"{number} {}\"", row.unit),
        None => format!("write \"{number} {}\" if SI is meant", row.unit),
    };
    Diagnostic::at(Class::MissingUnit, place, title, "a number without a unit").help(help)
}

fn wrong_dimension(place: Place, row: &Parameter, expected: Dimension, found: Dimension, text: &str) -> Diagnostic {
    if expected == Dimension::NONE {
        let title = format!("`{}` is a pure number, but \"{text}\" is {}", row.key, found.noun());
        let diagnostic = Diagnostic::at(Class::UnexpectedUnit, place, title, "a number without a unit is expected");
        return example_of(row, expected).into_iter().fold(diagnostic, Diagnostic::help);
    }
    let title = format!("\"{text}\" is {}, but `{}` is {}", found.noun(), row.key, noun_of(row.key, row.unit));
    let label = format!("expected a quantity in {}", row.unit);
    let diagnostic = Diagnostic::at(Class::WrongDimension, place, title, label);
    let hint = match (expected, found) {
        (Dimension::FORCE, Dimension::MASS) => Some("`lb`, `kg` are masses; forces are written in `lbf`, `kgf` or `N`"),
        (Dimension::MASS, Dimension::FORCE) => Some("`lbf`, `N` are forces; masses are written in `lb` or `kg`"),
        (Dimension::FREQUENCY, Dimension::ANGULAR_SPEED) => Some("a frequency counts periods: 60 rpm are \"1 Hz\""),
        (Dimension::CONDUCTANCE, Dimension::VOLUME_FLOW | Dimension::MASS_FLOW) if row.key.ends_with(".leakage") => {
            Some("divide the volume flow at the mean pressure by the gauge pressure at which it leaks")
        }
        (Dimension::CONDUCTANCE, Dimension::VOLUME_FLOW) => Some("divide the flow by the supply's absolute pressure"),
        _ => None,
    };
    let diagnostic = hint.into_iter().fold(diagnostic, Diagnostic::help);
    example_of(row, expected).into_iter().fold(diagnostic, Diagnostic::help)
}

/// The place of some bytes inside a string, or of the whole string when escapes make them differ from the text.
fn inside(place: &Place, value: &str, span: std::ops::Range<usize>) -> Place {
    let quoted = place.text();
    let plain = quoted.len() == value.len() + 2 && quoted.get(1..=value.len()) == Some(value);
    if !plain {
        return place.clone();
    }
    // Something missing at the end is reported at the closing quote.
    let start = place.span().start + 1;
    let end = if span.is_empty() { span.start + 1 } else { span.end };
    place.narrowed(start + span.start..start + end)
}

/// The sections whose absence is a mistake in any file.
pub(crate) fn required_sections() -> impl Iterator<Item = &'static str> {
    SECTIONS.iter().filter(|section| section.required).map(|section| section.path)
}
