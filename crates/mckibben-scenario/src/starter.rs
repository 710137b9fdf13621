//! The file that `mckibben init` writes: a complete, commented scenario, made from the table of keys.
//!
//! It is the pulse-width-modulation experiment of the paper: 5 lb hang from the default actuator, and a valve at 100
//! psi is switched at 25 Hz. Keys that this experiment does not need stand as comments, with a value that would be
//! valid.

use crate::keys::{ANTAGONIST, KEYS, Key, Kind, SECTIONS, VARY};
use crate::presets::{ACTUATORS, VALVES};
use crate::quantity;
use std::fmt::Write;

/// The keys that the experiment sets; every other key is a comment.
const SET: &[&str] = &[
    "actuator.preset",
    "air.process",
    "supply.gauge_pressure",
    "supply.temperature",
    "valve.kind",
    "valve.flow_area",
    "valve.efficiency",
    "valve.opening_delay",
    "valve.closing_delay",
    "command.kind",
    "command.frequency",
    "command.duty",
    "load.kind",
    "load.mass",
    "load.gravity",
    "initial.gauge_pressure",
    "initial.temperature",
    "initial.length",
    "run.duration",
    "run.sample_interval",
];

/// What may stand in the section of keys that vary.
const VARIED: &str = "\
# \"load.mass\" = [\"3 lb\", \"5 lb\", \"15 lb\"]
# \"supply.gauge_pressure\" = { from = \"20 psi\", to = \"100 psi\", count = 9 }
# \"valve.opening_delay\" = { normal = { mean = \"4 ms\", deviation = \"0.5 ms\" } }
# \"valve.efficiency\" = { uniform = { from = 0.8, to = 0.9 } }
# \"actuator.friction.viscous\" = { log-normal = { median = \"0.02 lbf*s/in\", factor = 1.5 } }
";

/// What may stand in the section of a joint's second actuator.
const SECOND: &str = "\
# command.duty = 0.3
# initial.gauge_pressure = \"30 psi\"
";

/// A complete scenario file to start from.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Starter {
    /// Whether the file has only the keys that are in force; without it every other key stands as a comment.
    pub minimal: bool,
    /// Whether quantities are metric, with two digits; without it they are in the units of the paper.
    pub metric: bool,
}

impl Starter {
    /// The text of the file.
    pub fn text(self) -> String {
        let mut text = String::from(
            "#:schema mckibben.schema.json\n\
             # A scenario of mckibben: what is built, what drives it, what is recorded. Editors complete keys by the schema that\n\
             # `mckibben schema > mckibben.schema.json` writes; `mckibben keys PATH` prints what a key means.\n\
             #\n\
             # A quantity with a dimension is a string with its unit (\"60 psi\", \"3.85 in\", \"0.02 lbf*s/in\"); pure\n\
             # numbers have none.",
        );
        if !self.minimal {
            text.push_str(" Lines that begin with `#` are not in force; remove the `#` from a key to set it.");
        }
        if self.metric {
            text.push_str("\n# The numbers are those of the paper's experiment, rounded to two digits.");
        }
        text.push('\n');
        for section in SECTIONS {
            let keys = || KEYS.iter().filter(|key| key.section() == section.path);
            let set = keys().any(|key| SET.contains(&key.path));
            if self.minimal && !set {
                continue;
            }
            let mark = if set { "" } else { "# " };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "\n# {}\n{mark}[{}]", section.meaning, section.path);
            for key in keys().filter(|key| !self.minimal || SET.contains(&key.path)) {
                let mark = if SET.contains(&key.path) { "" } else { "# " };
                let line = format!("{mark}{} = {}", key.name(), self.written(key.example));
                let _ = writeln!(text, "{line:<44}# {}", remark(key));
            }
            if section.path == ANTAGONIST {
                text.push_str(&self.written(SECOND));
            }
            if section.path == VARY {
                text.push_str(&self.written(VARIED));
            }
        }
        text
    }

    /// A text with its quantities in quotes as they are to be written.
    fn written(self, text: &str) -> String {
        if !self.metric {
            return text.to_owned();
        }
        // What stands between two quotes has an odd place.
        let parts = text.split('"').enumerate();
        let part = |(place, part): (usize, &str)| match place % 2 {
            1 => metric(part).unwrap_or_else(|| part.to_owned()),
            _ => part.to_owned(),
        };
        parts.map(part).collect::<Vec<_>>().join("\"")
    }
}

/// Metric units of quantities that the paper has in others, each with a unit of the dimension.
const METRIC: [&str; 9] = ["mm", "bar", "N", "kg", "N*s/m", "mm^2", "K", "cm^3", "L/min"];

/// A quantity in a metric unit with two digits; none of what is no quantity or is metric already.
fn metric(text: &str) -> Option<String> {
    const IMPERIAL: [&str; 6] = ["in", "ft", "psi", "lb", "lbf", "cfm"];
    let (_, unit) = text.split_once(' ')?;
    if !unit.split(['*', '/', '^', ' ']).any(|factor| IMPERIAL.contains(&factor)) {
        return None;
    }
    let read = quantity::parse(text).ok()?;
    let fits = |unit: &&&str| quantity::parse_unit(unit).is_ok_and(|(dimension, _)| dimension == read.dimension);
    let unit = METRIC.iter().find(fits)?;
    let number = read.value / quantity::parse_unit(unit).ok()?.1;
    let rounded: f64 = format!("{number:.1e}").parse().ok()?;
    Some(format!("{rounded} {unit}"))
}

/// What is said behind a key: its sentence, symbol, words and default.
fn remark(key: &Key) -> String {
    let mut remark = key.meaning.trim_end_matches('.').to_owned();
    let words = |choices: &[crate::Choice]| choices.iter().map(|choice| choice.name).collect::<Vec<_>>().join(" | ");
    let mut notes = Vec::new();
    match key.kind {
        Kind::Choice(choices) | Kind::Choices(choices) => notes.push(words(choices)),
        Kind::Quantity(row)
        | Kind::QuantityOr(row, _)
        | Kind::Quantities(row)
        | Kind::Whole(row)
        | Kind::TimeSeries(row) => notes.push(row.symbol.to_owned()),
        Kind::Regulated | Kind::Unit(_) | Kind::Name => {}
    }
    if let Some(when) = key.when {
        notes.push(format!("with {} = {}", when.key, when.words.join(" or ")));
    }
    if let Some(default) = default_of(key) {
        notes.push(format!("{} {default}", if preset_may_give(key) { "default without a preset" } else { "default" }));
    }
    let notes = notes.join("; ");
    if !notes.is_empty() {
        let _ = write!(remark, " ({notes})");
    }
    remark
}

/// Whether some preset gives the key, so that the table's default may not be what holds.
pub(crate) fn preset_may_give(key: &Key) -> bool {
    let presets = || ACTUATORS.iter().chain(VALVES);
    key.parameter().is_some_and(|row| presets().any(|preset| preset.get(row).is_some()))
}

/// The value that stands in for an absent key, as text.
pub fn default_of(key: &Key) -> Option<String> {
    let number = || key.parameter().and_then(|row| Some(quantity::format(row.default?, row.unit)));
    key.default.map(str::to_owned).or_else(number)
}
