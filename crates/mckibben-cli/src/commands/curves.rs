//! `mckibben curves`: force, stiffness and volume of a scenario's actuator over length, for a range of pressures.
//!
//! How good (6) is, which leaves out what the air's compression adds, is printed at the operating point: where the scenario's load
//! balances the actuator at each pressure, with the scenario's volume outside and with one as large as the largest
//! inside, which the paper holds to be enough.
//!
//! Checked by `tests/curves.rs`.

use crate::commands::compare;
use crate::files;
use crate::settings::{Setting, axis};
use crate::terminal;
use mckibben_run::axis::CurveAxis;
use mckibben_run::curves::{Curves, Pressures};
use mckibben_run::failure::Failure;
use mckibben_run::output;
use std::path::PathBuf;

/// Arguments of `mckibben curves`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben curves muscle.toml
  mckibben curves muscle.toml --gauge-pressures 2,4,6bar --plot curves.svg --over contraction
  mckibben curves muscle.toml --set actuator.turns=2.2 --output curves.csv")]
pub struct CurvesArguments {
    /// The scenario file, or - for standard input; its actuator is drawn, its load says where the operating points are. Several are
    /// compared: --plot draws their curves over each other.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Gauge pressures, as in `35,45,55psi`; a number without a unit has that of the next. Without it, round ones up to the greatest of
    /// the scenario: that of its supply, its given pressure or its start.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub gauge_pressures: Option<Pressures>,
    /// Write the curves as a table: .csv.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the curves: .svg, .png, .pdf, or .html for a page to zoom in.
    #[arg(short, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// What the figure is drawn over.
    #[arg(long, value_parser = axis::<CurveAxis>(), default_value = "length")]
    pub over: CurveAxis,
    /// Set a value of the scenario, such as `actuator.turns=2.2`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
}

/// Draws the curves.
///
/// # Errors
/// The input is wrong, or a file could not be written.
pub fn run(arguments: &CurvesArguments) -> Result<(), Failure> {
    let [file] = arguments.files.as_slice() else { return compare::curves(arguments) };
    let output =
        arguments.output.as_deref().map(|path| files::ending(path, "--output", &["csv"]).map(|_| path)).transpose()?;
    let plot = files::figure(arguments.plot.as_deref())?;
    let mut document = files::document(file)?;
    arguments.set.iter().try_for_each(|setting| setting.apply(&mut document))?;
    let curves = Curves::of(&document, arguments.gauge_pressures.as_ref())?;
    let data = curves.data()?;
    if let Some(path) = output {
        output::write(path, &data.to_csv(path)?)?;
    }
    if let Some((path, format)) = plot {
        let figure = curves.figure(arguments.over).title(Curves::title(arguments.over));
        let bytes = figure.bytes(format).map_err(|error| Failure::output(path, error))?;
        output::write(path, &bytes)?;
    }
    let mut text = report_text(&curves)?;
    for path in output.into_iter().chain(plot.map(|(path, _)| path)) {
        text.push_str(&terminal::wrote(path, ""));
    }
    terminal::print(&text)
}

/// The tables of an actuator's curves.
///
/// # Errors
/// None but those of the core.
pub(super) fn report_text(curves: &Curves) -> Result<String, Failure> {
    let (points, words) = curves.operating_points()?;
    let mut text = format!("{}\n{}\n", curves.table().to_text_with_caption(), points.to_text_with_caption());
    for words in [&words, curves.notes()].into_iter().filter(|words| !words.is_empty()) {
        text.push_str(&format!("{}\n\n", terminal::wrap(words, "")));
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    Ok(text)
}
