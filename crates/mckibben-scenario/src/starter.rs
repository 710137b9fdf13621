//! The file that `mckibben init` writes: a complete, commented scenario, made from the table of keys.
//!
//! It is the pulse-width-modulation experiment of the paper: 5 lb hang from the default actuator, and a valve at 100
//! psi is switched at 25 Hz. Keys that this experiment does not need stand as comments, with a value that would be
//! valid.

use crate::keys::{ANTAGONIST, KEYS, Key, Kind, SECTIONS, VARY};
use crate::presets::{ACTUATORS, VALVES};
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
pub fn starter() -> String {
    let mut text = String::from(
        "# A scenario of mckibben: what is built, what drives it, what is recorded.\n\
         #\n\
         # A quantity with a dimension is a string with its unit (\"60 psi\", \"3.85 in\", \"0.02 lbf*s/in\"); pure\n\
         # numbers have none. Lines that begin with `#` are not in force; remove the `#` from a key to set it.\n",
    );
    for section in SECTIONS {
        let keys = || KEYS.iter().filter(|key| key.section() == section.path);
        let set = keys().any(|key| SET.contains(&key.path));
        let mark = if set { "" } else { "# " };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n# {}\n{mark}[{}]", section.meaning, section.path);
        for key in keys() {
            let mark = if SET.contains(&key.path) { "" } else { "# " };
            let line = format!("{mark}{} = {}", key.name(), key.example);
            let _ = writeln!(text, "{line:<44}# {}", remark(key));
        }
        if section.path == ANTAGONIST {
            text.push_str(SECOND);
        }
        if section.path == VARY {
            text.push_str(VARIED);
        }
    }
    text
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
pub(crate) fn default_of(key: &Key) -> Option<String> {
    let number = || key.parameter().and_then(|row| Some(crate::quantity::format(row.default?, row.unit)));
    key.default.map(str::to_owned).or_else(number)
}
