//! `mckibben design`: which values of keys make a number of a run least or greatest, under constraints on others.
//!
//! Everything is done by [`mckibben_run::design`]. Checked by `tests/design.rs`.

use crate::settings::Setting;
use crate::{files, interrupt, terminal, warnings};
use mckibben_run::design::constraint::Constraint;
use mckibben_run::design::outcome::Outcome;
use mckibben_run::design::vary::Vary;
use mckibben_run::design::{Design, Goal, Request};
use mckibben_run::failure::Failure;
use mckibben_run::identify::Monitor;
use mckibben_run::output::{self, Pending};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Arguments of `mckibben design`.
#[derive(Clone, Debug, clap::Args)]
#[command(
    group = clap::ArgGroup::new("goal").required(true).args(["minimize", "maximize"]),
    after_help = "\
Examples:
  mckibben design muscle.toml --vary 'supply.gauge_pressure=3..7 bar' --minimize air.used \\
      --subject-to 'length.final<=80 mm'
  mckibben design muscle.toml --vary 'supply.gauge_pressure=3..7 bar' --vary 'command.duty=10..90 %' \\
      --minimize settled.length.ripple --subject-to 'settled.length.mean<=85 mm' --settle --output best.toml
  mckibben design arm.toml --vary 'coupling.rest_length=80..95 mm' --vary 'run.duration=1..2 s' \\
      --maximize elbow.angle.max --subject-to 'air.used<=2 g' --plot search.png --format json

Keys are those that --set takes, with a number and a unit; an entry of a list is KEY[0]. The unit may stand on either end \
of the range. A range above zero over more than a factor of ten is searched on a logarithmic scale. Names of numbers are \
length.final, tension.max, air.used, energy.gas_work, exergy.efficiency, of a plant with the part before them, \
flexor.gauge_pressure.max; the names that `simulate --format json` prints, such as length_final_m, are taken too. A name \
that does not exist is answered with the nearest ones. With --settle there are also settled.length.mean, .ripple, .min \
and .max, and so of every column.

The search screens the ranges on all cores and goes on from the best points by COBYLA, which needs no derivatives. It is \
deterministic, and equal on any number of cores. It finds a local optimum. A run that fails counts as infeasible. A \
constraint is met to a millionth of its bound. The warnings of the run at the best point are printed, as by `simulate`.

Exit codes:
  0  done
  2  the input is wrong: arguments, the scenario, a name; nothing was written
  3  nothing meets the constraints, or no run comes to its end: no scenario was written, the figure was
  4  a file could not be written; nothing was left behind
  130, 143  stopped by SIGINT (Ctrl-C), SIGTERM: the best values so far are printed and written"
)]
pub struct DesignArguments {
    /// The scenario file, or - for standard input.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// A key and its range, such as `supply.gauge_pressure=3..7 bar`; can be given again.
    #[arg(long, value_name = "KEY=LOW..HIGH UNIT", required = true)]
    pub vary: Vec<Vary>,
    /// The number that is made least, such as `air.used`.
    #[arg(long, value_name = "NAME")]
    pub minimize: Option<String>,
    /// The number that is made greatest, such as `exergy.efficiency`.
    #[arg(long, value_name = "NAME")]
    pub maximize: Option<String>,
    /// A bound on a number, such as `length.final<=80 mm` or `tension.max>=100 N`; can be given again.
    #[arg(long, value_name = "NAME<=VALUE UNIT")]
    pub subject_to: Vec<Constraint>,
    /// Run on behind the end to the periodic orbit, or the equilibrium, for the numbers that begin with `settled.`.
    #[arg(long)]
    pub settle: bool,
    /// Set a value of the scenario before the search, such as `load.mass=10 lb`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
    /// Runs at most.
    #[arg(long, value_name = "NUMBER", default_value = "200")]
    pub evaluations: NonZeroUsize,
    /// Write the scenario with the values found, its comments kept: .toml.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the search: .svg, .png or .pdf.
    #[arg(short, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// How the result is printed: as text for people, or as one JSON object.
    #[arg(long, value_name = "FORMAT", value_parser = ["text", "json"], default_value = "text")]
    pub format: String,
}

impl DesignArguments {
    fn request(&self) -> Request {
        let (goal, objective) = match (&self.minimize, &self.maximize) {
            (_, Some(name)) => (Goal::Maximize, name.clone()),
            (name, None) => (Goal::Minimize, name.clone().unwrap_or_default()),
        };
        Request {
            settings: self.set.iter().map(|of| (of.key.clone(), of.value.clone())).collect(),
            vary: self.vary.clone(),
            goal,
            objective,
            constraints: self.subject_to.clone(),
            settle: self.settle,
            evaluations: self.evaluations.get(),
        }
    }
}

/// Searches, prints the result, and writes the requested files.
///
/// # Errors
/// The input is wrong, nothing meets the constraints, or a file could not be written.
pub fn run(arguments: &DesignArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.output {
        files::ending(path, "--output", &["toml"])?;
    }
    let plot = files::figure(arguments.plot.as_deref())?;
    let written = || arguments.output.as_deref().into_iter().chain(arguments.plot.as_deref());
    output::distinct([arguments.file.as_path()], written(), "give --output and --plot names of their own")?;
    let document = files::document(&arguments.file)?;
    let design = Design::of(&document, arguments.request())?;
    written().try_for_each(output::probe)?;

    let monitor = Monitor::default();
    let of_signal = monitor.clone();
    let ending = interrupt::ending(move || of_signal.stop());
    let outcome = design.search(&monitor)?;
    drop(ending);
    let verdict = outcome.verdict();
    let mut pending = Vec::new();
    if let Some(path) = arguments.output.as_deref().filter(|_| verdict.is_ok()) {
        pending.push((path, files::pending(path, outcome.scenario().as_bytes())?));
    }
    if let Some((path, format)) = plot {
        let bytes = outcome.figure().bytes(format).map_err(|error| Failure::output(path, error))?;
        pending.push((path, files::pending(path, &bytes)?));
    }
    let as_json = arguments.format == "json";
    let mut text = if as_json { outcome.json() } else { found(&outcome) };
    if !as_json && !pending.is_empty() {
        text.push('\n');
    }
    for (path, file) in pending {
        Pending::commit(file)?;
        if !as_json {
            text.push_str(&terminal::wrote(path, ""));
        }
    }
    terminal::print(&text)?;
    verdict
}

/// What was found, for the terminal.
fn found(outcome: &Outcome) -> String {
    let wide = terminal::width();
    let mut text = String::new();
    for sentence in outcome.sentences() {
        text.push_str(&format!("{}\n", terminal::wrap(&sentence, "")));
    }
    for table in [outcome.values(), outcome.constraints()] {
        if !table.rows.is_empty() {
            text.push_str(&format!("\n{}", table.to_text_within(wide)));
        }
    }
    text.push_str(&warnings::section(outcome.warnings()));
    text
}
