//! The JSON Schema (draft 2020-12) of scenario files, made from the table of keys.
//!
//! Editors that know JSON Schema for TOML complete keys and words with it and show each key's sentence, symbol, unit,
//! range, default and source. It accepts every valid file; it cannot judge what takes units or other keys' values (a
//! length below the thread length), which the reading does.

mod shared;

use crate::choice::{Choice, Spacing};
use crate::keys::{
    ACTUATORS, ANTAGONIST, CONTROLLER, COUNT, FACTOR, KEYS, Key, Kind, MECHANISM, MECHANISMS, OF_ACTUATOR, OF_SUPPLY,
    SECTIONS, SUPPLIES, SWEEP, Section, VARY, all_keys, all_sections, is_of_antagonist, is_section_of_antagonist,
    key_at, section_at,
};
use crate::place::list_of;
use crate::starter::{default_of, preset_may_give};
use mckibben::parameter::{Parameter, Range};
use serde_json::{Map, Value, json};

/// A number with a unit behind it, such as `60 psi` or `85 %`; the grammar itself is in [`crate::quantity`].
const WITH_UNIT: &str = r"^\s*[-+\u2212]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*(1/)?[^\s0-9.,+\-]";

/// A unit.
const UNIT: &str = r"^\s*(1/)?[^\s0-9.,+\-]";

/// The schema of a scenario file.
pub fn schema() -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    let varying = KEYS.iter().filter(|key| key.varies()).map(|key| (key.path.to_owned(), of_axis(key)));
    let definitions: Map<String, Value> = varying.collect();
    for section in SECTIONS.iter().filter(|section| !section.path.contains('.')) {
        properties.insert(section.path.to_owned(), of_section(section));
        if section.required {
            required.push(section.path);
        }
    }
    let mut names = Map::new();
    for section in SECTIONS.iter().filter(|section| !section.path.contains('.')) {
        // A plant's file may say in a section what only some of its actuators have.
        let of_any = match section.path {
            SWEEP => sweep_in_plant(section),
            ANTAGONIST => of_section(section),
            _ => in_plant(section),
        };
        names.insert(section.path.to_owned(), of_any);
    }
    names.extend(of_plant());
    let is_plant: Vec<Value> = PLANT.iter().map(|section| json!({ "required": [section] })).collect();
    shared::shared(json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "mckibben scenario",
        "description": "One experiment with braided pneumatic actuators. Quantities are strings with units.",
        "type": "object",
        "properties": names,
        "if": { "anyOf": is_plant },
        "then": { "required": ["actuators", "run"] },
        "else": {
            "properties": properties,
            "not": { "required": ["coupling"] },
            "required": required,
            "dependentRequired": { "valve": ["supply", "command"], "command": ["valve"], "hose": ["valve"] },
        },
        "additionalProperties": false,
        "$defs": definitions,
    }))
}

/// The sections that make a file one of a plant.
const PLANT: [&str; 4] = [ACTUATORS, SUPPLIES, MECHANISM, MECHANISMS];

/// A name that the file chooses.
const NAME: &str = "^[A-Za-z_][A-Za-z0-9_-]*$";

/// The sections of a plant.
fn of_plant() -> Map<String, Value> {
    let one = |path: &str| section_at(path).map_or_else(|| json!({}), in_plant);
    let object = |meaning: &str, properties: Map<String, Value>| json!({ "description": meaning, "type": "object", "properties": properties, "additionalProperties": false });
    let named = |path: &str, entry: Value| {
        let meaning = section_at(path).map_or("", |section| section.meaning);
        json!({
            "description": meaning,
            "type": "object",
            "propertyNames": { "pattern": NAME },
            "additionalProperties": entry,
        })
    };
    let meaning = |path: &str| section_at(path).map_or("", |section| section.meaning);
    let mut coupling = properties_in_plant("coupling");
    let arm = key_at("coupling.arms.*").map_or_else(|| json!({}), of_key);
    coupling.insert("arms".to_owned(), named("coupling.arms", json!({ "anyOf": [arm, one("coupling.arms.*")] })));
    let coupling = object(meaning("coupling"), coupling);
    let mut mechanism = properties_in_plant(MECHANISM);
    let mut joint = properties_in_plant("mechanism.joints.*");
    let mut controller = properties_in_plant(CONTROLLER);
    controller.extend(properties_in_plant("mechanism.joints.*.controller"));
    joint.insert(CONTROLLER.to_owned(), object(meaning("mechanism.joints.*.controller"), controller));
    mechanism.insert("joints".to_owned(), named("mechanism.joints", object(meaning("mechanism.joints.*"), joint)));
    let mechanism = object(meaning(MECHANISM), mechanism);
    let mut supply = properties_in_plant("supply");
    supply.extend(properties_in_plant("supplies.*"));
    supply.extend(OF_SUPPLY.iter().map(|path| ((*path).to_owned(), one(path))));
    let supply = object(meaning("supplies.*"), supply);
    let mut actuator = properties_in_plant("actuator");
    actuator.extend(OF_ACTUATOR.iter().map(|path| ((*path).to_owned(), one(path))));
    actuator.insert("coupling".to_owned(), coupling.clone());
    let name = key_at("actuators.*.supply").map_or_else(|| json!({}), of_key);
    actuator.insert("supply".to_owned(), json!({ "anyOf": [name, one("supply")] }));
    let actuator = object(meaning("actuators.*"), actuator);
    [
        (ACTUATORS, named(ACTUATORS, actuator)),
        ("coupling", coupling),
        (SUPPLIES, named(SUPPLIES, supply)),
        (MECHANISM, mechanism.clone()),
        (MECHANISMS, named(MECHANISMS, mechanism)),
    ]
    .map(|(name, schema)| (name.to_owned(), schema))
    .into_iter()
    .collect()
}

/// The sweep of a plant's file: what varies are paths with names in them, and so are reductions.
fn sweep_in_plant(section: &Section) -> Value {
    let mut properties = properties_in_plant(SWEEP);
    let meaning = section_at(VARY).map_or("", |section| section.meaning);
    properties.insert("vary".to_owned(), json!({ "description": meaning, "type": "object", "minProperties": 1 }));
    let of_names = "The numbers that each run is reduced to: a quantity and a statistic, as in `length.final`; of a plant the column \
                    of a sample and a statistic, as in `flexor.gauge_pressure.max`. `mckibben keys sweep.reductions` lists all.";
    let names = json!({ "description": of_names, "type": "array", "minItems": 1, "items": { "type": "string" } });
    properties.insert("reductions".to_owned(), names);
    json!({ "description": section.meaning, "type": "object", "properties": properties, "additionalProperties": false })
}

/// A section of which a part may be said: each key may be left out.
fn in_plant(section: &Section) -> Value {
    let properties = properties_in_plant(section.path);
    json!({ "description": section.meaning, "type": "object", "properties": properties, "additionalProperties": false })
}

fn properties_in_plant(path: &str) -> Map<String, Value> {
    let keys = all_keys().filter(|key| key.section() == path && key.name() != "*");
    let mut properties: Map<String, Value> = keys.map(|key| (key.name().to_owned(), of_key(key))).collect();
    for inner in all_sections() {
        if let Some((_, name)) = inner.path.rsplit_once('.').filter(|(above, name)| *above == path && *name != "*") {
            properties.insert(name.to_owned(), in_plant(inner));
        }
    }
    properties
}

/// What a key takes in `[sweep.vary]`: a list, and if it is a quantity a range or a distribution.
fn of_axis(key: &Key) -> Value {
    let mut ways = vec![json!({ "type": "array", "minItems": 1, "items": of_key(key) })];
    let quantity = match key.kind {
        Kind::Quantity(row) | Kind::QuantityOr(row, _) | Kind::TimeSeries(row) => {
            Some((of_quantity(row), of_quantity(&Parameter { range: Range::POSITIVE, ..*row })))
        }
        Kind::Regulated => Some((of_key(key), of_key(key))),
        _ => None,
    };
    if let Some((quantity, deviation)) = quantity {
        let spacing = of_words(Spacing::CHOICES);
        let table = |names: Value, required: &[&str]| json!({ "type": "object", "properties": names, "required": required, "additionalProperties": false });
        let ends = json!({ "from": quantity, "to": quantity, "spacing": spacing });
        let mut range = ends.clone();
        range["count"] = of_whole(&COUNT);
        let uniform = table(ends, &["from", "to"]);
        let normal = table(json!({ "mean": quantity, "deviation": deviation }), &["mean", "deviation"]);
        let log_normal = table(json!({ "median": quantity, "factor": of_quantity(&FACTOR) }), &["median", "factor"]);
        ways.push(table(range, &["from", "to"]));
        ways.push(table(json!({ "uniform": uniform }), &["uniform"]));
        ways.push(table(json!({ "normal": normal }), &["normal"]));
        ways.push(table(json!({ "log-normal": log_normal }), &["log-normal"]));
    }
    json!({ "description": describe(key), "anyOf": ways })
}

/// The section whose entries are paths of keys: each as one quoted name, or as sections in sections. Of the second actuator
/// of a joint the keys that it takes.
fn of_vary(section: &str, of_antagonist: bool) -> Map<String, Value> {
    let mut properties = Map::new();
    let refer = |key: &Key| json!({ "$ref": format!("#/$defs/{}", key.path) });
    let takes = |key: &&Key| key.varies() && (!of_antagonist || is_of_antagonist(key.path));
    for key in KEYS.iter().filter(takes).filter(|key| section.is_empty() || key.section() == section) {
        let name = if section.is_empty() { key.path } else { key.name() };
        properties.insert(name.to_owned(), refer(key));
        if section.is_empty() && !of_antagonist && is_of_antagonist(key.path) {
            properties.insert(format!("{ANTAGONIST}.{name}"), refer(key));
        }
    }
    let inside = |section: &str, of_antagonist: bool| {
        json!({
            "type": "object",
            "properties": of_vary(section, of_antagonist),
            "patternProperties": of_entries(section, of_antagonist),
            "additionalProperties": false,
        })
    };
    let takes = |of: &&Section| match of_antagonist {
        true => is_section_of_antagonist(of.path),
        false => !of.path.starts_with(SWEEP) && of.path != ANTAGONIST,
    };
    for inner in SECTIONS.iter().filter(takes) {
        let (above, name) = inner.path.rsplit_once('.').unwrap_or(("", inner.path));
        if above == section {
            properties.insert(name.to_owned(), inside(inner.path, of_antagonist));
        }
    }
    if section.is_empty() && !of_antagonist {
        properties.insert(ANTAGONIST.to_owned(), inside("", true));
    }
    properties
}

/// The entries of lists that vary in a section, by a pattern of their names: the list with the place of the entry.
fn of_entries(section: &str, of_antagonist: bool) -> Map<String, Value> {
    let entry = |key: &Key| match key.kind {
        Kind::Quantities(row) => list_of(row).map(|_| Kind::Quantity(row)),
        Kind::Choices(choices) => Some(Kind::Choice(choices)),
        _ => None,
    };
    let mut patterns = Map::new();
    let takes = |key: &&Key| key.section() != SWEEP && (!of_antagonist || is_of_antagonist(key.path));
    for key in KEYS.iter().filter(takes).filter(|key| section.is_empty() || key.section() == section) {
        let Some(kind) = entry(key) else { continue };
        let name = if section.is_empty() { key.path } else { key.name() };
        let before = if section.is_empty() && !of_antagonist && is_of_antagonist(key.path) {
            format!("({ANTAGONIST}\\.)?")
        } else {
            String::new()
        };
        let pattern = format!("^{before}{}\\[[0-9]+\\]$", name.replace('.', "\\."));
        patterns.insert(pattern, of_axis(&Key { kind, ..*key }));
    }
    patterns
}

fn of_section(section: &Section) -> Value {
    if section.path == VARY {
        return json!({
            "description": section.meaning,
            "type": "object",
            "properties": of_vary("", false),
            "patternProperties": of_entries("", false),
            "minProperties": 1,
            "additionalProperties": false,
        });
    }
    if section.path == ANTAGONIST {
        return of_antagonist("", section.meaning);
    }
    let mut properties = Map::new();
    let keys: Vec<&Key> = KEYS.iter().filter(|key| key.section() == section.path).collect();
    for key in &keys {
        properties.insert(key.name().to_owned(), of_key(key));
    }
    for inner in SECTIONS {
        if let Some((_, name)) = inner.path.rsplit_once('.').filter(|(parent, _)| *parent == section.path) {
            properties.insert(name.to_owned(), of_section(inner));
        }
    }
    let required: Vec<&str> =
        keys.iter().filter(|key| key.required && key.when.is_none()).map(|key| key.name()).collect();
    let mut schema = json!({
        "description": section.meaning,
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    let rules: Vec<Value> = keys.iter().flat_map(|selector| rules(selector, &keys)).collect();
    if !rules.is_empty() {
        schema["allOf"] = json!(rules);
    }
    schema
}

/// What the second actuator of a joint takes in a section: each key may be left out, and is then as of the first.
fn of_antagonist(section: &str, meaning: &str) -> Value {
    let mut properties = Map::new();
    for key in KEYS.iter().filter(|key| key.section() == section && is_of_antagonist(key.path)) {
        properties.insert(key.name().to_owned(), of_key(key));
    }
    for inner in SECTIONS.iter().filter(|inner| is_section_of_antagonist(inner.path)) {
        let (above, name) = inner.path.rsplit_once('.').unwrap_or(("", inner.path));
        if above == section {
            properties.insert(name.to_owned(), of_antagonist(inner.path, inner.meaning));
        }
    }
    json!({ "description": meaning, "type": "object", "properties": properties, "additionalProperties": false })
}

/// For each word of a choice: the keys that it requires and those that have no meaning with it.
fn rules(selector: &Key, keys: &[&Key]) -> Vec<Value> {
    let Kind::Choice(choices) = selector.kind else { return Vec::new() };
    let ruled: Vec<(&Key, &[&str])> = keys
        .iter()
        .filter_map(|key| key.when.filter(|when| when.key == selector.path).map(|when| (*key, when.words)))
        .collect();
    if ruled.is_empty() {
        return Vec::new();
    }
    let rule = |choice: &Choice| {
        let applies = |words: &[&str]| words.contains(&choice.name);
        let needed = ruled.iter().filter(|(key, words)| key.required && applies(words)).map(|(key, _)| key.name());
        let barred =
            ruled.iter().filter(|(_, words)| !applies(words)).map(|(key, _)| (key.name().to_owned(), json!(false)));
        // An absent choice is its default word, if it has one, and then the condition holds as well.
        let mut condition = json!({ "properties": { selector.name(): { "const": choice.name } } });
        if selector.default != Some(choice.name) {
            condition["required"] = json!([selector.name()]);
        }
        json!({
            "if": condition,
            "then": { "required": needed.collect::<Vec<_>>(), "properties": barred.collect::<Map<_, _>>() },
        })
    };
    choices.iter().map(rule).collect()
}

fn of_key(key: &Key) -> Value {
    let mut schema = match key.kind {
        Kind::Quantity(row) => of_quantity(row),
        Kind::QuantityOr(row, word) => {
            json!({ "anyOf": [of_quantity(row), { "const": word.name, "description": word.meaning }] })
        }
        Kind::Quantities(row) => json!({ "type": "array", "minItems": 1, "items": of_quantity(row) }),
        Kind::TimeSeries(row) => {
            let one = of_quantity(row);
            json!({ "anyOf": [one, { "type": "array", "minItems": 1, "items": one }] })
        }
        Kind::Regulated => json!({ "type": "string", "pattern": WITH_UNIT }),
        Kind::Whole(row) => of_whole(row),
        Kind::Unit(_) => json!({ "type": "string", "pattern": UNIT }),
        Kind::Name => json!({ "type": "string", "pattern": NAME }),
        Kind::Choice(choices) => of_words(choices),
        Kind::Choices(choices) => json!({ "type": "array", "minItems": 1, "items": of_words(choices) }),
    };
    schema["description"] = json!(describe(key));
    // A default is given as the file would have it.
    if let Some(default) = default_of(key) {
        let pure = key.parameter().is_some_and(|row| row.unit.is_empty());
        let number = key.parameter().and_then(|row| row.default).filter(|_| pure);
        schema["default"] = number.map_or_else(|| json!(default), |number| json!(number));
    }
    if let Ok(example) = format!("value = {}", key.example).parse::<toml::Table>() {
        schema["examples"] = json!([example.get("value")]);
    }
    schema
}

/// A whole number in its range.
fn of_whole(row: &Parameter) -> Value {
    json!({ "type": "integer", "minimum": row.range.low, "maximum": row.range.high })
}

/// A string with a unit, or a number in its range.
fn of_quantity(row: &Parameter) -> Value {
    if !row.unit.is_empty() {
        return json!({ "type": "string", "pattern": WITH_UNIT });
    }
    let mut number = json!({ "type": "number" });
    let ends = [
        (row.range.low, if row.range.low_included { "minimum" } else { "exclusiveMinimum" }),
        (row.range.high, if row.range.high_included { "maximum" } else { "exclusiveMaximum" }),
    ];
    for (end, word) in ends.into_iter().filter(|(end, _)| end.is_finite()) {
        number[word] = json!(end);
    }
    json!({ "anyOf": [number, { "type": "string", "pattern": WITH_UNIT }] })
}

/// One of several words, each with its sentence.
fn of_words(choices: &[Choice]) -> Value {
    let words: Vec<Value> =
        choices.iter().map(|choice| json!({ "const": choice.name, "description": choice.meaning })).collect();
    json!({ "type": "string", "oneOf": words })
}

/// Sentence, symbol, unit, range, default and source in one text.
fn describe(key: &Key) -> String {
    let mut parts = vec![key.meaning.to_owned()];
    if let Some(row) = key.parameter() {
        let unit = if row.unit.is_empty() { "none" } else { row.unit };
        parts.push(
            format!("Symbol: {}. Unit: {unit}. Range: {} {}", row.symbol, row.range, row.unit).trim_end().to_owned()
                + ".",
        );
    }
    if let Some(when) = key.when {
        parts.push(format!("Only with {} = {}.", when.key, when.words.join(" or ")));
    }
    if let Some(default) = default_of(key) {
        parts
            .push(format!("{}: {default}.", if preset_may_give(key) { "Default without a preset" } else { "Default" }));
    }
    if let Some(row) = key.parameter() {
        parts.push(format!("Source: {}.", row.source));
    }
    parts.join(" ")
}
