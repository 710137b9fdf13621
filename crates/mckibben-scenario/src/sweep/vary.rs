//! Reads `[sweep.vary]`: for the path of each key a list, a range or a distribution, with every mistake in them.
//!
//! A path may be quoted (`"load.mass" = ...`), dotted (`load.mass = ...`) or a section (`[sweep.vary.load]`), and that of an entry
//! of a list that the file has (`"command.time[1]" = ...`).

use super::axis::{AxisKind, Target, Values, column_of};
use super::distribution::Distribution;
use super::field::field_of;
use super::plant;
use super::spacing::Ends;
use crate::choice::{DesignKind, Spacing, Word};
use crate::diagnostic::{Class, Diagnostic, Place};
use crate::document::{Document, Entry, Node, Table, Value, list_and_entry};
use crate::keys::{self, COUNT, FACTOR, KEYS, Key, Kind, SWEEP, VARY};
use crate::nearest::nearest;
use crate::place::list_of as place_of_list;
use crate::read::controller::{regulated, row_in_its_unit};
use crate::reader::{Reader, list_of};
use mckibben::control::Quantity;
use mckibben::parameter::{Parameter, Range};

/// A key that varies, as the file has it.
pub(super) struct Varied<'d> {
    pub(super) path: String,
    pub(super) key: Place,
    pub(super) values: Values,
    pub(super) row: &'static Key,
    /// The parameter that its numbers are of.
    parameter: Option<&'static Parameter>,
    /// The values one by one, or the one that stands for all of them in a first reading of the scenario.
    nodes: Vec<&'d Node>,
    /// Whether it is an entry of a list that no row of one actuator can set: the scenario is read again with each value.
    is_reread: bool,
}

/// A document without its section `[sweep]`, with the first value of every key that varies.
pub(super) fn first(document: &Document, varied: &[Varied<'_>]) -> Document {
    let mut whole = document.clone();
    whole.remove(SWEEP);
    for varied in varied {
        whole.put_at(&varied.path, &varied.key, varied.first());
    }
    whole
}

impl<'d> Varied<'d> {
    /// The value with which the scenario is first read.
    pub(super) fn first(&self) -> &'d Node {
        self.nodes[0]
    }

    /// How many values there are for each of which the scenario is read again: words, whole numbers, and entries of some lists.
    pub(super) fn read_each_row(&self) -> Option<u64> {
        let whole = matches!(self.row.kind, Kind::Whole(_));
        let is_due = whole || self.is_reread || matches!(self.values, Values::Words(_));
        is_due.then_some(self.nodes.len() as u64)
    }

    /// One of these values where it stands.
    pub(super) fn value(&self, index: u64) -> &'d Node {
        self.nodes[index as usize]
    }

    /// Whether it is of the second actuator of a joint alone.
    pub(super) fn is_of_antagonist(&self) -> bool {
        keys::in_antagonist(&self.path).is_some()
    }

    /// Whether its numbers are of this parameter.
    pub(super) fn is(&self, row: &Parameter) -> bool {
        self.parameter.is_some_and(|of| of.key == row.key)
    }

    /// The values where they stand.
    pub(super) fn nodes(&self) -> impl Iterator<Item = &'d Node> {
        self.nodes.iter().copied()
    }

    pub(super) fn kind(&self) -> AxisKind {
        match (&self.values, self.parameter) {
            (Values::Words(_), _) | (_, None) => AxisKind::Word,
            (_, Some(row)) => AxisKind::Quantity { unit: row.unit, column: column_of(&self.path, row.unit) },
        }
    }

    /// The unit of its numbers; empty for pure ones and for words.
    pub(super) fn unit(&self) -> &'static str {
        self.parameter.map_or("", |row| row.unit)
    }

    pub(super) fn target(&self) -> Option<Target> {
        let parameter = self.parameter.filter(|_| self.read_each_row().is_none())?;
        let index = list_and_entry(&self.path).and_then(|(_, entry)| entry.parse().ok());
        let entry = index.and_then(|index| Some((place_of_list(parameter)?, index)));
        Some(Target { parameter, field: field_of(parameter).filter(|_| index.is_none()), entry })
    }
}

/// Reads the keys that vary, in the order of the file.
pub(super) fn read<'d>(r: &mut Reader<'d>, design: DesignKind) -> Vec<Varied<'d>> {
    let Some(entry) = r.entry(VARY) else {
        if let Some(place) = r.key_place(SWEEP) {
            r.note(
                Diagnostic::at(Class::Missing, place, "the sweep does not say what varies", "needs [sweep.vary]")
                    .help("add `[sweep.vary]` with for instance `\"load.mass\" = [\"3 lb\", \"5 lb\"]`"),
            );
        }
        return Vec::new();
    };
    // What is no section has been refused.
    let Value::Table(table) = &entry.node.value else { return Vec::new() };
    if table.0.is_empty() {
        let place = entry.key.clone();
        r.note(
            Diagnostic::at(Class::Missing, place, "[sweep.vary] is empty", "at least one key is expected")
                .help("add for instance `\"load.mass\" = [\"3 lb\", \"5 lb\"]`"),
        );
    }
    let mut found: Vec<Found<'d>> = Vec::new();
    paths(r, table, "", &mut found);
    // Dotted keys of one section stand together in the parsed file, wherever they were written.
    found.sort_by_key(|of| of.entry.key.span().start);
    let regulated = regulated_by(r, &found);
    let mut varied: Vec<Varied<'d>> = Vec::new();
    for Found { path, row, entry } in found {
        if let Some(before) = varied.iter().find(|varied| are_equal(&varied.path, &path)) {
            let title = format!("`{path}` varies twice");
            r.note(
                Diagnostic::at(Class::Conflict, entry.key.clone(), title, "second time")
                    .related(Some(before.key.clone()), "first time")
                    .help("keep one of them"),
            );
            continue;
        }
        let regulated = if r.document().is_plant() { regulated_at(r.document(), &path) } else { regulated };
        let parameter = row.parameter().or_else(|| row_in_its_unit(regulated, row.path));
        let is_reread = !r.document().is_plant()
            && list_and_entry(&path).is_some()
            && parameter.is_some_and(|row| place_of_list(row).is_none());
        if is_reread && matches!(entry.node.value, Value::Table(_)) {
            let title = format!("`{path}` varies by a list of values: the scenario is read again with each of them");
            let place = entry.node.place.clone();
            let help = format!("write the values one by one, as in `\"{path}\" = [.., ..]`");
            r.note(Diagnostic::at(Class::NotApplicable, place, title, "no range or distribution here").help(help));
            continue;
        }
        let before = r.mistakes();
        let values = values(r, (row, parameter), &entry.node, design);
        // A controller's row in the unit of what it regulates has the path of the key.
        r.name_from(before, row.path, &path);
        if let Some((values, nodes)) = values.filter(|(_, nodes)| !nodes.is_empty()) {
            varied.push(Varied { path, key: entry.key.clone(), values, row, parameter, nodes, is_reread });
        }
    }
    varied
}

/// Whether two paths are of one key, or of one entry of a list: `[1]` and `[01]`.
fn are_equal(one: &str, other: &str) -> bool {
    let entry = |path| list_and_entry(path).and_then(|(list, place)| Some((list, place.parse::<usize>().ok()?)));
    one == other || entry(one).is_some_and(|of| entry(other) == Some(of))
}

/// An entry that is a key.
struct Found<'d> {
    path: String,
    row: &'static Key,
    entry: &'d Entry,
}

/// What the controller regulates, in whose unit some of its keys are: by what is said of it here or in the scenario.
fn regulated_by(r: &Reader<'_>, found: &[Found<'_>]) -> Quantity {
    let varies = |path: &str| found.iter().find(|of| of.path == path).map(|of| &of.entry.node.value);
    let said = |path: &str| match varies(path) {
        Some(Value::List(items)) => items.first().map(|item| &item.value),
        Some(_) => None,
        None => r.entry(path).map(|entry| &entry.node.value),
    };
    let is = |path: &str, word: &str| matches!(said(path), Some(Value::String(said)) if said == word);
    regulated(is, |path| varies(path).is_some() || r.has(path))
}

/// What the controller of a plant that a path is of regulates, as the file says it.
fn regulated_at(document: &Document, path: &str) -> Quantity {
    let names: Vec<&str> = path.split('.').collect();
    let document = match names.as_slice() {
        [keys::ACTUATORS, name, ..] => document.of_actuator(name),
        [above @ .., joint, keys::CONTROLLER, _] if above.last() == Some(&"joints") => {
            let mut of_joint = document.clone();
            let section = [above, &[joint, keys::CONTROLLER]].concat().join(".");
            if let Some(Entry { key, node, .. }) = document.entry(&section) {
                of_joint.put(keys::CONTROLLER, key, node);
            }
            of_joint
        }
        _ => document.clone(),
    };
    regulated(|path, word| document.is_word(path, word), |path| document.contains(path))
}

/// Finds the entries that are keys, through the sections above them.
fn paths<'d>(r: &mut Reader<'d>, table: &'d Table, above: &str, found: &mut Vec<Found<'d>>) {
    for entry in &table.0 {
        let path = if above.is_empty() { entry.name.clone() } else { format!("{above}.{}", entry.name) };
        // Of the second actuator the same keys, as far as it has them.
        let entry_of = list_and_entry(&path).map(|(list, place)| (list.to_owned(), place.to_owned()));
        let name = entry_of.as_ref().map_or(path.as_str(), |(list, _)| list);
        let (key, is_section) = match keys::in_antagonist(name) {
            Some(of) => (keys::key_at(of).filter(|_| keys::is_of_antagonist(of)), keys::is_section_of_antagonist(of)),
            None if r.document().is_plant() => {
                let section = keys::section_at(&keys::section_for(&path));
                (plant::key_of(name), section.is_some_and(|of| !of.path.starts_with(SWEEP)))
            }
            None => (keys::key_at(name), keys::section_at(&path).is_some_and(|of| !of.path.starts_with(SWEEP))),
        };
        match (key, &entry.node.value) {
            (Some(row), _) if entry_of.is_some() && row.section() != SWEEP => {
                let of = entry_of.as_ref().map(|(list, place)| (list.as_str(), place.as_str())).unwrap_or_default();
                match r.document().no_entry(of) {
                    Some((title, help)) => {
                        r.note(Diagnostic::at(Class::UnknownKey, entry.key.clone(), title, "cannot vary").help(help))
                    }
                    None => found.push(Found { path, row, entry }),
                }
            }
            (Some(row), _) if row.varies() => found.push(Found { path, row, entry }),
            (Some(row), _) => fixed(r, row, entry),
            (None, Value::Table(inner)) if is_section => paths(r, inner, &path, found),
            (None, _) => unknown(r, &path, entry),
        }
    }
}

/// Notes a key that does not vary.
fn fixed(r: &mut Reader<'_>, key: &Key, entry: &Entry) {
    let (title, help) = if key.section() == SWEEP {
        (format!("`{}` describes the sweep itself", key.path), "remove it")
    } else {
        (
            format!("`{}` is a list, which does not vary as a whole", key.path),
            "vary one of its entries, counted from 0, as in `\"command.time[1]\"`; or run one sweep for each list",
        )
    };
    r.note(Diagnostic::at(Class::NotApplicable, entry.key.clone(), title, "cannot vary").help(help));
}

/// Notes a path that names no key.
fn unknown(r: &mut Reader<'_>, path: &str, entry: &Entry) {
    let known = || KEYS.iter().filter(|key| key.varies());
    let named = || known().find(|key| key.name() == path).map(|key| key.path);
    let meant = nearest(path, known().map(|key| key.path)).or_else(named);
    let title = match keys::section_at(path) {
        Some(section) => format!("`{}` is a section, not a key", section.path),
        None => format!("`{path}` is no path to a key"),
    };
    let diagnostic = Diagnostic::at(Class::UnknownKey, entry.key.clone(), title, "unknown key");
    r.note(match meant {
        Some(meant) => diagnostic.help(format!("did you mean `\"{meant}\"`?")),
        None => diagnostic.help("write the path of a key, as in `\"load.mass\" = [\"3 lb\", \"5 lb\"]`"),
    });
}

type Read<'d> = (Values, Vec<&'d Node>);

fn values<'d>(
    r: &mut Reader<'d>,
    (key, parameter): (&'static Key, Option<&'static Parameter>),
    node: &'d Node,
    design: DesignKind,
) -> Option<Read<'d>> {
    match (&node.value, key.kind) {
        (Value::List(_), _) => {
            let items = r.items_of(node, key.path)?;
            let values = match key.kind {
                Kind::Choice(choices) | Kind::Choices(choices) => {
                    words(items, |item| r.one_of(item, key.path, choices).is_some())?
                }
                Kind::Name => words(items, |item| matches!(item.value, Value::String(_)))?,
                Kind::Unit(like) => words(items, |item| r.unit_of(item, key.path, like).is_some())?,
                Kind::QuantityOr(row, word) if items.iter().any(|item| is(item, word.name)) => {
                    words(items, |item| is(item, word.name) || r.quantity(item, row).is_some())?
                }
                Kind::Whole(row) => {
                    let read: Vec<Option<u64>> = items.iter().map(|item| r.whole_of(item, row)).collect();
                    Values::Numbers(read.into_iter().map(|read| read.map(|whole| whole as f64)).collect::<Option<_>>()?)
                }
                _ => numbers(r, items, parameter?)?,
            };
            Some((values, items.iter().collect()))
        }
        (
            Value::Table(table),
            Kind::Quantity(_) | Kind::Quantities(_) | Kind::QuantityOr(..) | Kind::TimeSeries(_) | Kind::Regulated,
        ) => spread(r, table, node, parameter?, design),
        (other, kind) => {
            let what = match (kind, parameter) {
                (Kind::Whole(_), _) => "a list of whole numbers",
                (_, Some(_)) => "a list, a range or a distribution",
                (_, None) => "a list of words",
            };
            let title = format!("what `{}` takes is {what}, not {}", key.path, other.noun());
            let help = format!("write it as in `\"{}\" = [{}]`", key.path, key.example);
            r.note(Diagnostic::at(Class::WrongType, node.place.clone(), title, "cannot be varied so").help(help));
            None
        }
    }
}

fn is(node: &Node, word: &str) -> bool {
    matches!(&node.value, Value::String(said) if said == word)
}

fn numbers(r: &mut Reader<'_>, items: &[Node], row: &Parameter) -> Option<Values> {
    let read: Vec<Option<f64>> = items.iter().map(|item| r.quantity(item, row)).collect();
    read.into_iter().collect::<Option<_>>().map(Values::Numbers)
}

/// The items as words, when each of them is good.
fn words(items: &[Node], mut good: impl FnMut(&Node) -> bool) -> Option<Values> {
    let all: Vec<bool> = items.iter().map(&mut good).collect();
    let word = |item: &Node| match &item.value {
        Value::String(word) => word.clone(),
        _ => item.place.text().to_owned(),
    };
    all.iter().all(|good| *good).then(|| Values::Words(items.iter().map(word).collect()))
}

/// A range or a distribution.
fn spread<'d>(
    r: &mut Reader<'d>,
    table: &'d Table,
    node: &'d Node,
    row: &'static Parameter,
    design: DesignKind,
) -> Option<Read<'d>> {
    const KINDS: [&str; 3] = ["uniform", "normal", "log-normal"];
    let Some(kind) = table.0.iter().find(|entry| KINDS.contains(&entry.name.as_str())) else {
        // No part of a range is a table, so this is a distribution whose name is misspelt.
        let Some(entry) = table.0.iter().find(|entry| matches!(entry.node.value, Value::Table(_))) else {
            return range(r, table, node, row, design);
        };
        let title = format!("`{}` is no distribution", entry.name);
        let diagnostic = Diagnostic::at(Class::UnknownKey, entry.key.clone(), title, "unknown");
        let meant = nearest(&entry.name, KINDS).map(|name| format!("did you mean `{name}`?"));
        let known = format!("known here: {}", list_of(KINDS.into_iter()));
        r.note(diagnostic.help(meant.unwrap_or(known)));
        return None;
    };
    let others = table.0.iter().filter(|entry| entry.name != kind.name);
    let others: Vec<Diagnostic> = others
        .map(|entry| {
            let title = format!("`{}` cannot stand together with `{}`", entry.name, kind.name);
            Diagnostic::at(Class::Conflict, entry.key.clone(), title, "one too many")
                .related(Some(kind.key.clone()), "the distribution")
                .help("keep one distribution, or the range alone")
        })
        .collect();
    let alone = others.is_empty();
    others.into_iter().for_each(|diagnostic| r.note(diagnostic));
    if design == DesignKind::Grid {
        let title = format!("a grid has no use for the distribution of `{}`", row.key);
        r.note(
            Diagnostic::at(
                Class::NotApplicable,
                kind.key.clone(),
                title,
                "a grid takes every value of a list or range",
            )
            .related(r.value_place("sweep.design"), "chosen here")
            .help(
                "give a list or a range with `count`, or choose another design, such as `design = \"latin-hypercube\"`",
            ),
        );
    }
    let Value::Table(inner) = &kind.node.value else {
        let title = format!("`{}` is a table, not {}", kind.name, kind.node.value.noun());
        let place = kind.node.place.clone();
        r.note(Diagnostic::at(Class::WrongType, place, title, "a table is expected").help(example(&kind.name)));
        return None;
    };
    let read = match kind.name.as_str() {
        "uniform" => {
            let (ends, from) = ends(r, inner, &kind.node, row, &["from", "to", "spacing"])?;
            (Distribution::Uniform(ends), from)
        }
        "normal" => {
            let [mean, deviation] = parts(r, inner, &kind.node, ["mean", "deviation"], &[])?;
            let row_of_deviation = Parameter {
                key: "deviation",
                range: Range::POSITIVE,
                remedy: "give a standard deviation above zero",
                ..*row
            };
            let (value, deviation) = (r.quantity(mean, row), r.difference(deviation, &row_of_deviation));
            (Distribution::Normal { mean: value?, deviation: deviation? }, mean)
        }
        _ => {
            let [median, factor] = parts(r, inner, &kind.node, ["median", "factor"], &[])?;
            let (value, factor) = (r.quantity(median, row), r.quantity(factor, &FACTOR));
            (
                Distribution::LogNormal {
                    median: above_zero(r, median, value?, "the median of a log-normal distribution")?,
                    factor: factor?,
                },
                median,
            )
        }
    };
    alone.then(|| (Values::Continuous(read.0), vec![read.1]))
}

/// `{ from, to, count, spacing }`: steps, or without a count a uniform distribution.
fn range<'d>(
    r: &mut Reader<'d>,
    table: &'d Table,
    node: &'d Node,
    row: &'static Parameter,
    design: DesignKind,
) -> Option<Read<'d>> {
    const KNOWN: [&str; 4] = ["from", "to", "count", "spacing"];
    let read = ends(r, table, node, row, &KNOWN);
    let count = match table.get("count") {
        Some(entry) => Some(r.whole_of(&entry.node, &COUNT)?),
        None => None,
    };
    let (ends, from) = read?;
    match count {
        Some(count) => Some((Values::Steps(ends, count), vec![from])),
        // A misspelt part may be the count.
        None if table.0.iter().any(|entry| !KNOWN.contains(&entry.name.as_str())) => None,
        None if design == DesignKind::Grid => {
            let title = format!("the range of `{}` has no `count`, which a grid needs", row.key);
            r.note(
                Diagnostic::at(Class::Missing, node.place.clone(), title, "`count` is expected here")
                    .related(r.value_place("sweep.design"), "chosen here")
                    .help("add for instance `count = 9`, or choose another design, such as `design = \"latin-hypercube\"`"),
            );
            None
        }
        None => Some((Values::Continuous(Distribution::Uniform(ends)), vec![from])),
    }
}

/// The ends of a range and how it is spaced; also where its first value stands.
fn ends<'d>(
    r: &mut Reader<'d>,
    table: &'d Table,
    node: &'d Node,
    row: &'static Parameter,
    known: &[&str],
) -> Option<(Ends, &'d Node)> {
    let [from, to] = parts(r, table, node, ["from", "to"], known)?;
    let read = (r.quantity(from, row), r.quantity(to, row));
    let spacing = match table.get("spacing") {
        Some(entry) => Spacing::from_name(r.one_of(&entry.node, "spacing", Spacing::CHOICES)?)?,
        None => Spacing::Linear,
    };
    let (mut first, mut last) = (read.0?, read.1?);
    if spacing == Spacing::Logarithmic {
        let (a, b) =
            (above_zero(r, from, first, "a logarithmic range"), above_zero(r, to, last, "a logarithmic range"));
        (first, last) = (a?, b?);
    }
    Some((Ends { from: first, to: last, spacing }, from))
}

/// Notes a value whose logarithm is wanted and does not exist.
fn above_zero(r: &mut Reader<'_>, node: &Node, value: f64, what: &str) -> Option<f64> {
    if value > 0.0 {
        return Some(value);
    }
    let title = format!("{what} needs values above zero");
    r.note(
        Diagnostic::at(Class::OutOfRange, node.place.clone(), title, "has no logarithm")
            .help("give a value above zero, or choose linear spacing or another distribution"),
    );
    None
}

/// Two parts that a range or distribution must have, and no part that is not known.
fn parts<'d>(
    r: &mut Reader<'d>,
    table: &'d Table,
    node: &'d Node,
    expected: [&str; 2],
    known: &[&str],
) -> Option<[&'d Node; 2]> {
    let known = if known.is_empty() { &expected[..] } else { known };
    let mut meant = None;
    for entry in table.0.iter().filter(|entry| !known.contains(&entry.name.as_str())) {
        let title = format!("`{}` is no part of this", entry.name);
        let diagnostic = Diagnostic::at(Class::UnknownKey, entry.key.clone(), title, "unknown");
        let near = nearest(&entry.name, known.iter().copied());
        meant = meant.or(near);
        r.note(match near {
            Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
            None => diagnostic.help(format!("known here: {}", list_of(known.iter().copied()))),
        });
    }
    let found = expected.map(|name| table.get(name).map(|entry| &entry.node));
    for (name, _) in expected.iter().zip(found).filter(|(name, part)| part.is_none() && meant != Some(**name)) {
        let title = format!("`{name}` is missing");
        let diagnostic =
            Diagnostic::at(Class::Missing, node.place.clone(), title, format!("`{name}` is expected here"));
        r.note(diagnostic.help(example(expected[0])));
    }
    let [first, second] = found;
    Some([first?, second?])
}

/// How a range or distribution is written.
fn example(part: &str) -> &'static str {
    match part {
        "normal" | "mean" => "write it as in `{ normal = { mean = \"4 ms\", deviation = \"0.5 ms\" } }`",
        "log-normal" | "median" => "write it as in `{ log-normal = { median = \"4 ms\", factor = 1.5 } }`",
        "uniform" => "write it as in `{ uniform = { from = \"3 ms\", to = \"5 ms\" } }`",
        _ => "write it as in `{ from = \"3 ms\", to = \"5 ms\", count = 5 }`",
    }
}
