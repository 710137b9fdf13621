//! The names of compared documents: the keys in which they differ, where these are few, or else the names of their files.

use super::title::base;
use mckibben_scenario::Document;
use std::collections::BTreeMap;

/// Differing keys up to this number are the name.
const FEW: usize = 2;
/// Letters of such a name at most.
const LONGEST: usize = 48;

/// A name for each of several documents, all different where the documents are.
pub fn labels(documents: &[Document]) -> Vec<String> {
    let keys: Vec<BTreeMap<String, String>> = documents.iter().map(|document| keys(&document.to_toml())).collect();
    let mut differing: Vec<&String> = keys.iter().flat_map(BTreeMap::keys).collect();
    differing.sort();
    differing.dedup();
    differing.retain(|key| keys.iter().any(|its| its.get(*key) != keys[0].get(*key)));
    let said = |its: &BTreeMap<String, String>| {
        let each = differing.iter().map(|key| {
            let value = its.get(*key).map_or("not given", |value| value.trim_matches('"'));
            format!("{key} = {value}")
        });
        each.collect::<Vec<_>>().join(", ")
    };
    let by_keys: Vec<String> = keys.iter().map(said).collect();
    if (1..=FEW).contains(&differing.len()) && by_keys.iter().all(|label| label.chars().count() <= LONGEST) {
        return by_keys;
    }
    let names: Vec<&str> = documents.iter().map(|document| document.source().name()).collect();
    let bases: Vec<&str> = names.iter().map(|name| base(name)).collect();
    let is_alone = |index: usize| bases.iter().filter(|base| **base == bases[index]).count() == 1;
    (0..names.len()).map(|index| if is_alone(index) { bases[index] } else { names[index] }.to_owned()).collect()
}

/// The keys of a document in its normal form with their values, each under its section.
fn keys(toml: &str) -> BTreeMap<String, String> {
    let (mut section, mut keys) = (String::new(), BTreeMap::new());
    for line in toml.lines() {
        if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
            section = format!("{name}.");
        } else if let Some((key, value)) = line.split_once(" = ") {
            keys.insert(format!("{section}{key}"), value.to_owned());
        }
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(name: &str, mass: &str, more: &str) -> Document {
        let text = format!("[load]\nkind = \"hanging-mass\"\nmass = \"{mass}\"\n{more}[run]\nduration = \"1 s\"\n");
        Document::parse(&text, name).unwrap()
    }

    #[test]
    fn few_differences_are_the_names() {
        let two = [document("a.toml", "5 lb", ""), document("b.toml", "2 kg", "")];
        assert_eq!(labels(&two), ["load.mass = 5 lb", "load.mass = 2 kg"]);
        let many = "gravity = \"9 m/s^2\"\n[initial]\nlength = \"80 mm\"\n";
        let two = [document("x/a.toml", "5 lb", ""), document("y/b.toml", "2 kg", many)];
        assert_eq!(labels(&two), ["a.toml", "b.toml"]);
        let same = [document("x/a.toml", "5 lb", ""), document("y/a.toml", "5 lb", "")];
        assert_eq!(labels(&same), ["x/a.toml", "y/a.toml"]);
    }
}
