//! The single numbers that a document says, each with its row of the parameter table: what a host may change.

use crate::document::{Document, Table, Value};
use crate::keys::{self, Kind};
use crate::quantity;
use mckibben::parameter::Parameter;

/// A number of a document.
#[derive(Clone, Debug, PartialEq)]
pub struct DocumentNumber {
    /// Its path in the file, such as `actuators.flexor.friction.viscous`.
    pub path: String,
    /// The path of its key, such as `actuator.friction.viscous`.
    pub key: &'static str,
    /// What it is.
    pub parameter: &'static Parameter,
    /// The value in the SI unit of the parameter.
    pub value: f64,
}

impl Document {
    /// The single quantities that the document says, in the order of the file; lists, words and whole numbers are left out.
    pub fn numbers(&self) -> Vec<DocumentNumber> {
        let mut numbers = Vec::new();
        collect(self.root(), "", &mut numbers);
        numbers
    }
}

fn collect(table: &Table, section: &str, numbers: &mut Vec<DocumentNumber>) {
    for entry in &table.0 {
        let path = if section.is_empty() { entry.name.clone() } else { format!("{section}.{}", entry.name) };
        let value = match &entry.node.value {
            Value::Table(inner) => {
                collect(inner, &path, numbers);
                continue;
            }
            Value::Number(number) => Some(*number),
            Value::String(text) => quantity::parse(text).ok().map(|read| read.value),
            Value::List(_) | Value::Other(_) => None,
        };
        let key = keys::key_at(&keys::stands_for(&path));
        if let (Some(value), Some(key)) = (value, key)
            && let Kind::Quantity(parameter) | Kind::QuantityOr(parameter, _) | Kind::TimeSeries(parameter) = key.kind
        {
            numbers.push(DocumentNumber { path, key: key.path, parameter, value });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_paths_and_si_values() {
        let text = "[supply]\ngauge_pressure = \"1 bar\"\n[load]\nkind = \"isometric\"\n[actuators.a.friction]\n\
                    viscous = \"2 N*s/m\"\n[run]\nrelative_tolerance = 1e-8\n";
        let numbers = Document::parse(text, "muscle.toml").expect("TOML").numbers();
        let found: Vec<_> = numbers.iter().map(|its| (its.path.as_str(), its.key, its.value)).collect();
        let expected = [
            ("supply.gauge_pressure", "supply.gauge_pressure", 1e5),
            ("actuators.a.friction.viscous", "actuator.friction.viscous", 2.0),
            ("run.relative_tolerance", "run.relative_tolerance", 1e-8),
        ];
        assert_eq!(found, expected);
    }
}
