//! `modelDescription.xml`: what a host knows of a unit before it loads it.
//!
//! Checked by `tests/description.rs`, and by FMPy's validation in `python/tests/test_fmu.py`.

mod fmi2;
mod fmi3;
mod units;

use crate::model::Model;
use crate::options::Version;
use std::fmt::Write as _;

/// The description of a unit. Units for display are those that the process has chosen, in front of the usual ones.
pub fn model_description(model: &Model, name: &str, version: Version) -> String {
    let interfaces = model.options().interfaces;
    match version {
        Version::Two => fmi2::description(model, name, interfaces),
        Version::Three => fmi3::description(model, name, interfaces),
    }
}

/// One sentence on the model, and one on the controllers that it leaves out.
fn sentence(model: &Model) -> String {
    let mut sentence = "Braided pneumatic actuators (McKibben muscles) with their air network.".to_owned();
    if let Some(left_out) = left_out(model) {
        sentence.push(' ');
        sentence.push_str(&left_out);
    }
    sentence
}

/// That the controllers of the scenario are left out, by the names of what they control; none where it has none.
pub fn left_out(model: &Model) -> Option<String> {
    let names: Vec<String> = model.controllers().iter().map(|name| format!("`{name}`")).collect();
    let of = names.join(", ");
    match names.len() {
        0 => None,
        1 => Some(format!("The controller of {of} is left out: the host commands the valves.")),
        _ => Some(format!("The controllers of {of} are left out: the host commands the valves.")),
    }
}

/// What is alike in both versions and stands before the variables: units, categories of messages, the run of the scenario.
fn begin(xml: &mut Xml, model: &Model) {
    units::definitions(xml, model.variables());
    xml.within("LogCategories", &[], |xml| {
        for (name, sentence) in CATEGORIES {
            xml.element("Category", &[("name", name), ("description", sentence)]);
        }
    });
    let run = &model.plant().experiment().run;
    let (stop, step) = (format!("{:?}", run.duration), format!("{:?}", run.sample_interval));
    xml.element("DefaultExperiment", &[("startTime", "0.0"), ("stopTime", &stop), ("stepSize", &step)]);
}

/// XML under way.
#[derive(Debug)]
struct Xml {
    text: String,
    depth: usize,
}

impl Xml {
    fn new() -> Self {
        Self { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(), depth: 0 }
    }

    /// An element without content.
    fn element(&mut self, name: &str, attributes: &[(&str, &str)]) {
        self.begin(name, attributes, "/>\n");
    }

    /// An element with what `fill` puts into it.
    fn within(&mut self, name: &str, attributes: &[(&str, &str)], fill: impl FnOnce(&mut Self)) {
        self.begin(name, attributes, ">\n");
        self.depth += 1;
        fill(self);
        self.depth -= 1;
        let _ = writeln!(self.text, "{:1$}</{name}>", "", 2 * self.depth);
    }

    fn begin(&mut self, name: &str, attributes: &[(&str, &str)], end: &str) {
        let _ = write!(self.text, "{:1$}<{name}", "", 2 * self.depth);
        for (key, value) in attributes {
            let _ = write!(self.text, " {key}=\"{}\"", escaped(value));
        }
        self.text.push_str(end);
    }
}

/// Text as it stands in an attribute.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            // No XML has them, escaped or not.
            control if control.is_control() => escaped.push(' '),
            plain => escaped.push(plain),
        }
    }
    escaped
}

/// Numbers as XML has them, with blanks between.
fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(" ")
}

/// Names of the categories of log messages, and what they are.
const CATEGORIES: [(&str, &str); 3] = [
    ("logStatusError", "What was refused, and why."),
    ("logStatusDiscard", "Steps and values from which the unit cannot go on."),
    ("logEvents", "Instances that begin and end."),
];
