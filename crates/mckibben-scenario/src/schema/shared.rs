//! What a schema says more than once, said once: equal parts go to `$defs` and stand as `$ref` where they were.
//!
//! A key has one schema, and many places: its section, the section of a second actuator or of each of several, and what a sweep may
//! vary. Editors read every line of a schema at each start; it is a third as long this way. Checked by `tests/tables.rs`,
//! which validates files by it.

use serde_json::{Map, Value, json};
use std::collections::HashMap;

/// Parts of a schema that hold schemas by name, and those that hold a list of them or one.
const BY_NAME: [&str; 3] = ["properties", "patternProperties", "$defs"];
const ONE_OR_MORE: [&str; 8] =
    ["items", "anyOf", "allOf", "oneOf", "additionalProperties", "propertyNames", "then", "else"];
/// Characters below which a reference would be no shorter.
const SHORTEST: usize = 60;

/// A schema in which equal parts are shared.
pub(super) fn shared(mut schema: Value) -> Value {
    let mut counts = HashMap::new();
    each_part(&schema, &mut |part| *counts.entry(part.to_string()).or_insert(0_u32) += 1);
    let mut parts = Parts { counts, definitions: Map::new(), names: HashMap::new() };
    parts.replace_inside(&mut schema);
    if let Some(Value::Object(own)) = schema.get_mut("$defs") {
        own.append(&mut parts.definitions);
    }
    schema
}

/// Calls `see` with each schema within a schema, outer ones first.
fn each_part(schema: &Value, see: &mut dyn FnMut(&Value)) {
    let Value::Object(members) = schema else { return };
    for (name, member) in members {
        match member {
            Value::Object(inner) if BY_NAME.contains(&name.as_str()) => inner.values().for_each(|part| {
                see(part);
                each_part(part, see);
            }),
            Value::Array(parts) if ONE_OR_MORE.contains(&name.as_str()) => parts.iter().for_each(|part| {
                see(part);
                each_part(part, see);
            }),
            Value::Object(_) if ONE_OR_MORE.contains(&name.as_str()) => {
                see(member);
                each_part(member, see);
            }
            _ => {}
        }
    }
}

struct Parts {
    /// How often each part stands in the schema, by its text.
    counts: HashMap<String, u32>,
    definitions: Map<String, Value>,
    /// The name of each part that has become a definition.
    names: HashMap<String, String>,
}

impl Parts {
    fn replace_inside(&mut self, schema: &mut Value) {
        let Value::Object(members) = schema else { return };
        for (name, member) in members.iter_mut() {
            match member {
                Value::Object(inner) if BY_NAME.contains(&name.as_str()) => {
                    inner.values_mut().for_each(|part| self.replace(part));
                }
                Value::Array(parts) if ONE_OR_MORE.contains(&name.as_str()) => {
                    parts.iter_mut().for_each(|part| self.replace(part));
                }
                Value::Object(_) if ONE_OR_MORE.contains(&name.as_str()) => self.replace(member),
                _ => {}
            }
        }
    }

    fn replace(&mut self, part: &mut Value) {
        let text = part.to_string();
        let is_shared =
            part.is_object() && text.len() >= SHORTEST && self.counts.get(&text).is_some_and(|count| *count > 1);
        if !is_shared {
            return self.replace_inside(part);
        }
        let name = match self.names.get(&text) {
            Some(name) => name.clone(),
            None => {
                let name = format!("shared-{}", self.names.len() + 1);
                self.names.insert(text, name.clone());
                let mut whole = part.clone();
                self.replace_inside(&mut whole);
                self.definitions.insert(name.clone(), whole);
                name
            }
        };
        *part = json!({ "$ref": format!("#/$defs/{name}") });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A schema with every reference replaced by what it refers to.
    fn resolved(value: &Value, definitions: &Value) -> Value {
        match value {
            Value::Object(members) => match members.get("$ref").and_then(Value::as_str) {
                Some(reference) if reference.contains("shared-") => {
                    resolved(&definitions[reference.rsplit('/').next().unwrap()], definitions)
                }
                _ => members.iter().map(|(name, inner)| (name.clone(), resolved(inner, definitions))).collect(),
            },
            Value::Array(values) => values.iter().map(|inner| resolved(inner, definitions)).collect(),
            other => other.clone(),
        }
    }

    #[test]
    fn what_is_shared_is_what_stood_there() {
        let long = |of: &str| json!({ "type": "string", "description": format!("{of} {}", "words ".repeat(20)) });
        let inner = json!({ "type": "object", "properties": { "a": long("a"), "b": long("b") } });
        let whole = json!({
            "properties": { "one": inner, "two": inner, "three": { "type": "array", "items": long("a") } },
            "else": { "properties": { "four": inner } },
            "$defs": { "own": long("c") },
        });
        let short = shared(whole.clone());
        assert!(short.to_string().len() < whole.to_string().len() * 2 / 3, "{short:#}");
        let mut back = resolved(&short, &short["$defs"]);
        let definitions = back["$defs"].as_object_mut().unwrap();
        definitions.retain(|name, _| !name.starts_with("shared-"));
        assert_eq!(back, whole);
    }
}
