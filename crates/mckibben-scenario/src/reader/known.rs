//! Whether every section and key is known, and has a meaning with what else is chosen.

use super::{Reader, list_of};
use crate::choice::LoadKind;
use crate::diagnostic::{Class, Diagnostic};
use crate::document::{Entry, Table, Value};
use crate::keys::{self, KEYS, Key};
use crate::nearest::nearest;

impl<'d> Reader<'d> {
    /// Refuses keys and sections that there are not, and values where a section belongs.
    pub(super) fn known(&mut self, table: &'d Table, path: &str) {
        for entry in &table.0 {
            let child = if path.is_empty() { entry.name.clone() } else { format!("{path}.{}", entry.name) };
            let (is_key, section) = match keys::in_antagonist(&child) {
                Some(of_first) => (
                    keys::key_at(of_first).is_some() && keys::is_of_antagonist(of_first),
                    keys::section_at(of_first).filter(|_| keys::is_section_of_antagonist(of_first)),
                ),
                None => {
                    let is_table = matches!(entry.node.value, Value::Table(_));
                    let path = match self.of_plant {
                        true if is_table => keys::section_for(&child),
                        true => keys::stands_for(&child),
                        false => child.clone(),
                    };
                    let (key, section) = (keys::key_at(&path), keys::section_at(&path));
                    let own = |path: &str| self.of_plant || !keys::is_of_plant(path);
                    (key.is_some() && own(&path) && !(is_table && section.is_some()), section.filter(|_| own(&path)))
                }
            };
            if is_key {
                continue;
            }
            if self.of_plant && keys::names_its_entries(&keys::stands_for(path)) && !self.may_name(entry) {
                continue;
            }
            match (section, &entry.node.value) {
                // What varies is named by paths; the reading of a sweep checks them.
                (Some(_), Value::Table(_)) if child == keys::VARY => {}
                (Some(_), Value::Table(inner)) => self.known(inner, &child),
                (Some(_), other) => {
                    let title = format!("`{child}` is a section, not {}", other.noun());
                    let place = entry.node.place.clone();
                    let help = format!("write `[{child}]` on a separate line and its keys below");
                    self.note(Diagnostic::at(Class::WrongType, place, title, "a section is expected").help(help));
                }
                (None, _) => self.unknown(entry, path),
            }
        }
    }

    /// Whether a name that the file chooses is one that columns can carry.
    fn may_name(&mut self, entry: &Entry) -> bool {
        let mut letters = entry.name.chars();
        let begins = letters.next().is_some_and(|first| first.is_ascii_alphabetic() || first == '_');
        let sound = begins && letters.all(|letter| letter.is_ascii_alphanumeric() || matches!(letter, '_' | '-'));
        if !sound {
            let title = format!("`{}` is no name", entry.name);
            let help = "begin with a letter and go on with letters, digits, `_` or `-`";
            self.note(Diagnostic::at(Class::UnknownKey, entry.key.clone(), title, "not a name").help(help));
        }
        sound
    }

    fn unknown(&mut self, entry: &Entry, section: &str) {
        let name = entry.name.as_str();
        let is_section = matches!(entry.node.value, Value::Table(_));
        let (title, label) = match (section, is_section) {
            ("", true) => (format!("there is no section [{name}]"), "unknown section"),
            ("", false) => (format!("`{name}` stands outside every section"), "unknown key"),
            (_, true) => (format!("there is no section [{section}.{name}]"), "unknown section"),
            (_, false) => (format!("`{name}` is not a key of [{section}]"), "unknown key"),
        };
        let valid: Vec<&str> = match self.of_plant {
            true => keys::names_in_plant(section),
            false => keys::names_in(section).collect(),
        };
        let child = if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") };
        let long = |known: &&str| known.len() > 3 && name.len() > 3;
        // A part of a key, or a key with more before it, such as `rest_length` for `length`.
        let part = valid.iter().copied().filter(long).find(|known| known.contains(name));
        let whole = || valid.iter().copied().filter(long).find(|known| name.ends_with(&format!("_{known}")));
        let within = part.or_else(whole);
        let elsewhere: Vec<String> =
            KEYS.iter().filter(|key| key.name() == name).map(|key| format!("[{}]", key.section())).collect();
        let of_plant = !self.of_plant && keys::is_of_plant(&child);
        // Keys of [actuator] stand in the section of an actuator without that name.
        let is_actuator = self.of_plant && name == "actuator" && keys::stands_for(section) == "actuators.*";
        let is_tank = (name.starts_with("tank") || ["reservoir", "bottle"].contains(&name))
            && keys::stands_for(section) == "supply";
        let help = if is_tank {
            format!("a tank is a supply with a volume: give `reservoir_volume` in [{section}]")
        } else if child == "study" {
            "this file is a study: fit it by `mckibben identify`, and give the scenario that it names here".to_owned()
        } else if is_actuator {
            let inner = match &entry.node.value {
                Value::Table(inner) => inner.0.first().map(|first| first.name.as_str()),
                _ => None,
            };
            let inner = inner.unwrap_or("turns");
            format!("keys of [actuator] stand in [{section}] without that name: write `{inner}` for `actuator.{inner}`")
        } else if of_plant {
            "this is for files in which actuators have names: add for instance `[actuators.muscle]`".to_owned()
        } else if let Some(meant) = nearest(name, valid.iter().copied()).or(within) {
            self.meant.push(if section.is_empty() { meant.to_owned() } else { format!("{section}.{meant}") });
            format!("did you mean `{meant}`?")
        } else if !elsewhere.is_empty() {
            format!("`{name}` is a key of {}", elsewhere.join(" and "))
        } else if let Some(meant) = nearest(name, KEYS.iter().map(Key::name)) {
            let of = KEYS.iter().find(|key| key.name() == meant).map_or("", Key::section);
            format!("did you mean `{meant}` of [{of}]?")
        } else {
            format!("known here: {}", list_of(valid.iter().copied()))
        };
        self.note(Diagnostic::at(Class::UnknownKey, entry.key.clone(), title, label).help(help));
    }

    /// Refuses keys that have no meaning under the choice that was made.
    pub(super) fn applies(&mut self, is_required: impl Fn(&Key) -> bool) {
        let joint = LoadKind::AntagonisticJoint.name();
        // A plant has no second actuator of a joint whatever its load; its reading refuses the section.
        let is_stray = !self.of_plant && !self.says("load.kind", joint);
        if let Some(place) = self.key_place(keys::ANTAGONIST).filter(|_| is_stray) {
            let title = format!("[{}] is not used without `load.kind` = \"{joint}\"", keys::ANTAGONIST);
            self.note(
                Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                    .related(self.value_place("load.kind"), "chosen here")
                    .help(format!("remove it, or set `load.kind` to `{joint}`")),
            );
        }
        for key in keys::all_keys().filter(|key| is_required(key)) {
            let (Some(when), Some(place)) = (key.when, self.key_place(key.path)) else { continue };
            let chosen = match self.entry(when.key).map(|entry| &entry.node.value) {
                Some(Value::String(word)) => Some(word.as_str()),
                Some(_) => None,
                None => {
                    let of_preset = self.document().preset_word(when.key);
                    of_preset.or_else(|| keys::key_at(when.key).and_then(|selector| selector.default))
                }
            };
            // A choice that is absent or no valid word is a separate mistake and says nothing about this key.
            let valid = |word: &&str| match keys::key_at(when.key).map(|selector| selector.kind) {
                Some(keys::Kind::Choice(choices)) => choices.iter().any(|choice| choice.name == *word),
                _ => false,
            };
            let Some(word) = chosen.filter(valid) else { continue };
            if !when.words.contains(&word) {
                let title = format!("`{}` is not used when `{}` = \"{word}\"", key.path, when.key);
                let words = list_of(when.words.iter().copied());
                let choice = self.value_place(when.key);
                self.note(
                    Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                        .related(choice, "chosen here")
                        .help(format!("remove it, or set `{}` to {words}", when.key)),
                );
            }
        }
    }
}
