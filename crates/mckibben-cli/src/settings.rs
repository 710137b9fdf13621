//! Values of options: `--set KEY=VALUE`, a value of the scenario, and the horizontal axis of a figure.
//!
//! The value of a key needs no second pair of quotes: [`Document::set_plain_from`].

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use mckibben_run::axis::HorizontalAxis;
use mckibben_run::failure::Failure;
use mckibben_run::quantities;
use mckibben_scenario::{Diagnostics, Document};
use std::fmt;
use std::str::FromStr;

/// Parser of the horizontal axis of a figure.
pub(crate) fn axis<A: HorizontalAxis>() -> impl TypedValueParser<Value = A> {
    let value = |axis: &A| PossibleValue::new(axis.name()).help(axis.meaning());
    PossibleValuesParser::new(A::ALL.iter().map(value)).try_map(|name| name.parse::<A>())
}

/// Parser of a quantity with a unit, in the SI unit that it must have the dimension of: [`quantities::read`].
pub(crate) fn measured(
    what: &'static str,
    unit: &'static str,
    example: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text: &str| quantities::read(text, what, unit, example)
}

/// A key of the scenario and its new value.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Setting {
    /// Path of the key, such as `command.duty`.
    pub key: String,
    /// The value as it was given.
    pub value: String,
}

impl FromStr for Setting {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (key, value) = text.split_once('=').ok_or("write KEY=VALUE, as in command.duty=0.3")?;
        let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
        match (key.is_empty(), value.is_empty()) {
            (true, _) => Err("a key must stand before the =, as in command.duty=0.3"),
            (_, true) => Err("a value must stand behind the =, as in command.duty=0.3"),
            _ => Ok(Self { key, value }),
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.value)
    }
}

impl Setting {
    /// Sets the value in a document.
    ///
    /// # Errors
    /// When the key is no path; what the value is worth is found out when the scenario is read.
    pub fn apply(&self, document: &mut Document) -> Result<(), Failure> {
        Ok(self.set_in(document)?)
    }

    /// As [`Setting::apply`], with the mistakes as they are.
    pub(crate) fn set_in(&self, document: &mut Document) -> Result<(), Diagnostics> {
        document.set_plain_from(NAME, &self.key, &self.value)
    }
}

/// What messages about such a value show in place of a file.
const NAME: &str = "--set";

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"1 s\"\n";

    #[test]
    fn values_need_no_second_pair_of_quotes() {
        for (setting, mass) in [("load.mass=2 kg", 2.0), ("load.mass=\"3 kg\"", 3.0), ("load.mass = 4kg", 4.0)] {
            let mut document = Document::parse(TEXT, "muscle.toml").unwrap();
            setting.parse::<Setting>().unwrap().apply(&mut document).unwrap();
            let mckibben_scenario::Load::HangingMass { mass: found, .. } = document.scenario().unwrap().load else {
                panic!("another load")
            };
            assert_eq!(found, mass, "{setting}");
        }
    }

    #[test]
    fn what_is_no_setting_is_refused() {
        for text in ["load.mass", "=5", "load.mass="] {
            assert!(text.parse::<Setting>().is_err(), "{text}");
        }
        let mut document = Document::parse(TEXT, "muscle.toml").unwrap();
        assert!("load mass=5 lb".parse::<Setting>().unwrap().apply(&mut document).is_err());
        assert!("load.mass=5 lb\nx=1".parse::<Setting>().unwrap().apply(&mut document).is_ok());
        assert!(document.scenario().is_err());
    }
}
