//! The paper's experiments as one report.
//!
//! Every experiment is run from a scenario file of `examples/paper`, which this library carries with it.
//!
//! The paper's curves are not at hand, only its text. So a finding says what the text states, what comes out here and
//! whether the two can be compared at all, and what was assumed is labelled wherever it matters.
//!
//! | file | its idea |
//! |---|---|
//! | `files` | the scenario files |
//! | `units` | the paper's units, and the words on what is assumed |
//! | `statics` | Fig. 3 |
//! | `quasi_static`, `sealed` | a sealed muscle under a slow load; Figs. 4–6 |
//! | `rings` | Figs. 8 and 9 |
//! | `duty` | Fig. 10 |
//! | `pulses` | Figs. 11–13 |
//!
//! Checked by the program's `tests/reproduce.rs`.

mod duty;
mod files;
mod pulses;
mod quasi_static;
mod rings;
mod sealed;
mod statics;
mod units;

use crate::failure::Failure;
use crate::progress::Progress;
use crate::report::{Report, Section, Table, typeset};
use mckibben_scenario::presets;

/// The parts of the report.
const PARTS: [fn() -> Result<Section, Failure>; 5] =
    [statics::section, sealed::section, rings::section, duty::section, pulses::section];

/// Runs the paper's experiments.
///
/// # Errors
/// When one of them cannot go on, or comes to a number that is not finite.
pub fn report() -> Result<Report, Failure> {
    let progress = Progress::begin("reproducing", Some(PARTS.len() as u64));
    let mut report = frame();
    for (part, done) in PARTS.into_iter().zip(1..) {
        report.sections.push(part()?);
        progress.at(done);
    }
    report.check()?;
    Ok(report)
}

/// The report before its sections.
fn frame() -> Report {
    let stated = "Colbrunn, Nelson & Quinn (2001), “Modeling of Braided Pneumatic Actuators for Robotic Control”";
    Report {
        title: "The experiments of Colbrunn, Nelson & Quinn (2001), simulated".into(),
        introduction: vec![
            format!(
                "This page repeats, figure by figure, the experiments of {stated}, from scenario files that are \
                 given in full below each section."
            ),
            "The paper’s text is at hand, the curves in its figures are not. Each finding therefore says what the text \
             states, what comes out here, and whether the two can be compared at all. No agreement with a \
             curve is claimed."
                .into(),
            "Figures are in the paper’s units; CSV files beside this page hold their numbers in SI.".into(),
        ],
        assumptions: assumptions(),
        sections: Vec::new(),
        colophon: format!("Made by mckibben {} from its scenario files.", env!("CARGO_PKG_VERSION")),
    }
}

/// The preset's values, with what is assumed among them.
fn assumptions() -> Table {
    let preset = &presets::COLBRUNN_2001;
    let rows = preset.values.iter().map(|value| {
        let parameter = value.parameter;
        let source = if value.assumed {
            let source = value.source.strip_prefix("assumed: ").unwrap_or(value.source);
            format!("ASSUMED: {source}")
        } else {
            value.source.to_owned()
        };
        vec![
            parameter.symbol.to_owned(),
            typeset(value.text),
            typeset(parameter.meaning.trim_end_matches('.')),
            typeset(&source),
        ]
    });
    Table {
        caption: format!(
            "The actuator of every experiment, preset `{}`. Beyond these, each scenario file says what it assumes: \
             initial displacement, nominal pressure, start.",
            preset.name
        ),
        head: ["Symbol", "Value", "Meaning", "Source"].map(String::from).to_vec(),
        rows: rows.collect(),
    }
}
