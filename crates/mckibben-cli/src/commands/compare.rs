//! Several scenario files over each other: `mckibben simulate` and `mckibben curves` with more than one file.
//!
//! `--set` applies to all. What is written of one run alone, its table and its events, is refused. Checked by `tests/figure.rs`.

use super::curves::{self, CurvesArguments};
use super::simulate::{self, SimulateArguments};
use crate::files;
use crate::settings::Setting;
use crate::summary::Common;
use crate::{terminal, warnings};
use mckibben_run::curves::{Curves, Pressures, compare};
use mckibben_run::failure::Failure;
use mckibben_run::figure::{self, Request};
use mckibben_run::output;
use mckibben_run::run::{Finished, Ready};
use mckibben_run::warnings::of_run;
use mckibben_scenario::Document;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Refuses an option that is of one file.
fn refuse(option: &str, is_given: bool, of: &str) -> Result<(), Failure> {
    if !is_given {
        return Ok(());
    }
    let help = format!("leave {option} out, or give one file at a time: mckibben {of} FILE {option} …");
    Err(Failure::input(format!("{option} is of one file, and there are several"), help))
}

/// The documents of files, with what was set.
fn documents(files: &[PathBuf], set: &[Setting]) -> Result<Vec<Document>, Failure> {
    if files.iter().filter(|file| *file == Path::new("-")).count() > 1 {
        return Err(Failure::input("standard input is given twice", "give - once, and names of files else"));
    }
    let document = |file: &PathBuf| {
        let mut document = files::document(file)?;
        set.iter().try_for_each(|setting| setting.apply(&mut document))?;
        Ok(document)
    };
    files.iter().map(document).collect()
}

/// Runs several scenarios, prints their summaries one after another and draws their runs over each other.
///
/// # Errors
/// As of one, and [`Failure::input`] for what is of one file.
pub(super) fn simulate(arguments: &SimulateArguments) -> Result<(), Failure> {
    refuse("--output", arguments.output.is_some(), "simulate")?;
    refuse("--events-output", arguments.events_output.is_some(), "simulate")?;
    refuse("--events", arguments.events, "simulate")?;
    refuse("--format json", arguments.format == "json", "simulate")?;
    let plot = files::figure(arguments.plot.as_deref())?;
    let help = "give --plot a name of its own";
    output::distinct(arguments.files.iter().map(PathBuf::as_path), arguments.plot.as_deref(), help)?;
    let documents = documents(&arguments.files, &arguments.set)?;
    let mut ready = Vec::new();
    for document in &documents {
        let its = Ready::of(document)?;
        simulate::over_time(&its, arguments.over)?;
        if arguments.strict {
            warnings::refuse(&its.warnings())?;
        }
        ready.push(its);
    }
    if let Some((path, _)) = plot {
        output::probe(path)?;
    }
    let (mut text, mut kept) = (Vec::new(), Vec::new());
    for (document, ready) in documents.iter().zip(ready) {
        let scenario = if document.is_plant() { None } else { Some(document.scenario()?) };
        let (known, started) = (ready.warnings(), Instant::now());
        let (finished, settled) = ready.run(document, arguments.end(), &mut |_| Ok(()))?;
        let (elapsed, figures) = (started.elapsed(), finished.figures()?);
        let found = of_run(known, &figures);
        if arguments.strict {
            warnings::refuse(&found)?;
        }
        if arguments.quiet {
            warnings::print(&found);
        } else {
            let (muscles, assumed) = (&document.muscles()[..], &document.assumed()[..]);
            let (name, settled, verbose) = (document.source().name(), settled.as_ref(), arguments.verbose);
            let common = Common { name, elapsed, muscles, assumed, settled, verbose };
            let report_text = simulate::report_text(&figures, common, scenario.as_ref())?;
            text.push(format!("{report_text}{}", warnings::section(&found)));
        }
        kept.push(finished);
    }
    let mut text = text.join("\n");
    if let Some((path, format)) = plot {
        let labels = figure::labels(&documents);
        let runs: Vec<(&str, &Finished)> = labels.iter().map(String::as_str).zip(&kept).collect();
        let title = figure::title::of_several(&documents);
        let request = Request { over: arguments.over, title: &title, columns: &arguments.columns };
        let bytes = figure::draw(&runs, &request)?.bytes(format).map_err(|error| Failure::output(path, error))?;
        output::write(path, &bytes)?;
        if !arguments.quiet {
            text.push_str(&format!("\n{}", terminal::wrote(path, "")));
        }
    }
    if text.is_empty() { Ok(()) } else { terminal::print(&text) }
}

/// Prints the tables of several actuators one after another and draws their curves over each other.
///
/// # Errors
/// As of one, and [`Failure::input`] for what is of one file.
pub(super) fn curves(arguments: &CurvesArguments) -> Result<(), Failure> {
    refuse("--output", arguments.output.is_some(), "curves")?;
    let plot = files::figure(arguments.plot.as_deref())?;
    let help = "give --plot a name of its own";
    output::distinct(arguments.files.iter().map(PathBuf::as_path), arguments.plot.as_deref(), help)?;
    let documents = documents(&arguments.files, &arguments.set)?;
    // One list of pressures for all: the first file's where none is given.
    let pressures = match (&arguments.gauge_pressures, documents.first()) {
        (Some(given), _) => Some(given.clone()),
        (None, Some(first)) => Some(Pressures::of_scenario(&first.scenario()?)),
        (None, None) => None,
    };
    let of = |document: &Document| Curves::of(document, pressures.as_ref());
    let curves = documents.iter().map(of).collect::<Result<Vec<Curves>, Failure>>()?;
    let mut text = String::new();
    for (document, curves) in documents.iter().zip(&curves) {
        let gap = if text.is_empty() { "" } else { "\n" };
        text.push_str(&format!("{gap}{}\n\n{}", document.source().name(), curves::report_text(curves)?));
    }
    if let Some((path, format)) = plot {
        let labels = figure::labels(&documents);
        let each: Vec<(&str, &Curves)> = labels.iter().map(String::as_str).zip(&curves).collect();
        let bytes = compare(&each, arguments.over).bytes(format).map_err(|error| Failure::output(path, error))?;
        output::write(path, &bytes)?;
        text.push_str(&terminal::wrote(path, ""));
    }
    terminal::print(&text)
}
