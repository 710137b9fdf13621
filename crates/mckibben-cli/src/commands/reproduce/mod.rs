//! `mckibben reproduce`: the paper's experiments as one report.
//!
//! Every experiment is run from a scenario file of `examples/paper`, which the program carries with it. Each figure is
//! written as SVG, PNG and CSV, and all of them with what was found stand in one page that needs no other file.
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
//! Checked by `tests/reproduce.rs`.

mod duty;
mod files;
mod pulses;
mod quasi_static;
mod rings;
mod sealed;
mod statics;
mod units;

use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use crate::report::{Report, Section, Table, typeset};
use crate::terminal;
use mckibben_scenario::presets;
use std::path::PathBuf;

/// What `mckibben reproduce` is asked.
#[derive(Clone, Debug, clap::Args)]
pub struct ReproduceArguments {
    /// The folder for the report; it is made if it is not there
    #[arg(short, long, value_name = "DIR", default_value = "reproduction")]
    pub output: PathBuf,
}

/// The parts of the report.
const PARTS: [fn() -> Result<Section, Failure>; 5] =
    [statics::section, sealed::section, rings::section, duty::section, pulses::section];

/// Runs the paper's experiments and writes the report.
///
/// # Errors
/// When the folder or a file in it cannot be written, or an experiment cannot go on.
pub fn run(arguments: &ReproduceArguments) -> Result<(), Failure> {
    let folder = &arguments.output;
    std::fs::create_dir_all(folder).map_err(|error| Failure::output(folder, error))?;
    // As many steps for the experiments as for their figures, which take about as long.
    let parts = PARTS.len() as u64;
    let progress = Progress::begin("reproducing", Some(2 * parts));
    let mut report = frame();
    for (part, done) in PARTS.into_iter().zip(1..) {
        report.sections.push(part()?);
        progress.at(done);
    }
    for (section, done) in report.sections.iter().zip(parts + 1..) {
        for plate in &section.plates {
            plate.write(folder)?;
        }
        progress.at(done);
    }
    report.check()?;
    let numbers = report.numbers_csv();
    let numbers_path = folder.join("numbers.csv");
    output::write(&numbers_path, &numbers.map_err(|error| Failure::output(&numbers_path, error))?)?;
    // The page comes last, so that where it stands everything that it refers to stands too.
    let path = folder.join("index.html");
    let page = report.to_html().map_err(|error| Failure::output(&path, error))?;
    output::write(&path, page.as_bytes())?;
    drop(progress);
    let wrote = terminal::styled(terminal::GOOD, "wrote");
    terminal::print(&format!("{}\n{wrote} {}\n", report.summary(), path.display()))
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
        colophon: format!("Made by mckibben {} with `mckibben reproduce`.", env!("CARGO_PKG_VERSION")),
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
