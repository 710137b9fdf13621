//! `mckibben simulate`: runs a scenario, prints its results, and writes the requested files.
//!
//! Everything that can be refused is refused before anything is simulated, and every file is complete before any of
//! them takes its name. A run of which no figure and no events are wanted is written as it is made and not kept.

use crate::commands::compare;
use crate::settings::{Setting, axis};
use crate::summary::{self, Common, Summary};
use crate::{events, files, terminal, warnings};
use mckibben_plot::Format;
use mckibben_run::axis::TrajectoryAxis;
use mckibben_run::engine;
use mckibben_run::failure::Failure;
use mckibben_run::figure::{self, Request};
use mckibben_run::output::{self, Pending};
use mckibben_run::progress::Progress;
use mckibben_run::record::{self, Provenance, Target};
use mckibben_run::run::{Figures, Finished, Ready};
use mckibben_run::settle::End;
use mckibben_run::warnings::of_run;
use mckibben_scenario::Scenario;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `mckibben simulate`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben simulate muscle.toml
  mckibben simulate muscle.toml --output run.csv --plot run.svg
  mckibben simulate muscle.toml --set command.duty=0.3 --set 'load.mass=10 lb' -o run.parquet
  mckibben simulate muscle.toml --plot air.svg --columns gauge_pressure_pa,temperature_k
  mckibben simulate light.toml heavy.toml --plot both.svg
  mckibben simulate muscle.toml --set run.engine=fixed-step --set 'run.step=0.5 ms'
  mckibben simulate muscle.toml --settle --units imperial
  mckibben simulate muscle.toml --format json | jq .numbers.length_final_m
  generate-scenario | mckibben simulate - --strict

A run whose samples alone are wanted is written as it is made, in memory that does not grow with it; under a controller \
what was decided is kept, some 50 bytes a sample. For a figure or events every step is kept, about a kilobyte each: \
past 256 MB a note says how much it will be. A run may have 1e9 samples, steps, pulses and samples of its controller.

What cannot be meant is a warning, at the end of the summary: a valve that never opens or closes under its pulses, a pressure, \
tension or length that no braid holds, a load thrown above its attachment, a start below actuator.min_length, a set \
point that is never reached, an effectiveness above 2, a law of force beyond its table or of another muscle. With --quiet it goes to standard error. --strict makes an error of it.

Exit codes:
  0  done
  2  the input is wrong: arguments, a missing file, the scenario, with --strict a warning; nothing was written
  3  the simulation could not go on; nothing was written
  4  a file could not be written; nothing was left behind")]
pub struct SimulateArguments {
    /// The scenario file, or - for standard input; `mckibben init` writes one to start from. Several are compared: --plot draws their
    /// runs over each other.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Write the run, one row for each sample interval: .csv, .parquet or .mat.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the run: .svg, .png, .pdf, or .html for a page to zoom in.
    #[arg(short, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// What the figure is drawn over.
    #[arg(long, value_parser = axis::<TrajectoryAxis>(), default_value = "time", value_name = "QUANTITY", requires = "plot")]
    pub over: TrajectoryAxis,
    /// Columns that the figure shows in place of the usual ones, such as `hose_gauge_pressure_pa,temperature_k`.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "plot", conflicts_with = "over")]
    pub columns: Vec<String>,
    /// Set a value of the scenario, such as `command.duty=0.3` or `load.mass=10 lb`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
    /// Run on behind the end to the periodic orbit, or the equilibrium, and tell its means and ripples; files and figures end at
    /// run.duration as ever.
    #[arg(long)]
    pub settle: bool,
    /// Tell everything: all states, engine and cost, energy and exergy; without it the ten lines that matter most.
    #[arg(short, long)]
    pub verbose: bool,
    /// Print every event after the summary.
    #[arg(long)]
    pub events: bool,
    /// Write every event: .csv.
    #[arg(long, value_name = "FILE")]
    pub events_output: Option<PathBuf>,
    /// How the summary is printed: as text for people, or as one JSON object with numbers in SI, events, warnings and assumed values.
    #[arg(long, value_name = "FORMAT", value_parser = ["text", "json"], default_value = "text")]
    pub format: String,
    /// Make errors of warnings: exit code 2, and nothing is written.
    #[arg(long)]
    pub strict: bool,
    /// Print no summary.
    #[arg(short, long)]
    pub quiet: bool,
}

impl SimulateArguments {
    /// Where runs end.
    pub(super) fn end(&self) -> End {
        if self.settle { End::Orbit } else { End::Duration }
    }
}

/// Runs the scenario.
///
/// # Errors
/// The input is wrong, the simulation could not go on, or a file could not be written.
pub fn run(arguments: &SimulateArguments) -> Result<(), Failure> {
    let as_json = arguments.format == "json";
    if as_json && (arguments.quiet || arguments.events) {
        let (title, help) = ("--format json prints one JSON object and nothing else", "leave --quiet and --events out");
        return Err(Failure::input(title, help));
    }
    let [file] = arguments.files.as_slice() else { return compare::simulate(arguments) };
    let files = Files::of(arguments)?;
    let mut document = files::document(file)?;
    for setting in &arguments.set {
        setting.apply(&mut document)?;
    }
    let scenario = if document.is_plant() { None } else { Some(document.scenario()?) };
    let ready = Ready::of(&document)?;
    over_time(&ready, arguments.over)?;
    let known = ready.warnings();
    if arguments.strict {
        warnings::refuse(&known)?;
    }
    files.probe()?;
    let note = warnings::idle_steps(&document, ready.plan().engine, "").filter(|_| !arguments.quiet);
    note.iter().for_each(|note| terminal::print_error(note));

    let (name, set) = (document.source().name().to_owned(), arguments.set.iter().map(Setting::to_string));
    let set: Vec<String> = set.collect();
    let provenance = Provenance { document: &document, set: &set, scenario: scenario.as_ref() };
    let (plan, rows) = (*ready.plan(), engine::rows(ready.plan()));

    let started = Instant::now();
    let (figures, settled, elapsed, pending, table) = if !files.keep(arguments) {
        let begun = |(path, format)| Ok::<_, Failure>((path, format, Pending::create(path)?));
        let mut output = files.output.map(begun).transpose()?;
        let target = output.as_mut().map(|(path, format, file)| Target {
            provenance: &provenance,
            path,
            format: *format,
            out: file.writer(),
        });
        let (figures, settled) = ready.stream(&document, target, arguments.end())?;
        let pending = output.into_iter().map(|(.., file)| file).collect();
        (figures, settled, started.elapsed(), pending, None)
    } else {
        let (finished, settled) = ready.run(&document, arguments.end(), &mut |_| Ok(()))?;
        let elapsed = started.elapsed();
        let pending = files.write(arguments, &provenance, &finished)?;
        (finished.figures()?, settled, elapsed, pending, Some(events::table(&finished.log())))
    };

    // Also what the short summary leaves out must be a number.
    figures.summary().check()?;
    let found = of_run(known, &figures);
    if arguments.strict {
        warnings::refuse(&found)?;
    }
    let mut text = String::new();
    if as_json {
        text.push_str(&figures.summary().json(&document, &plan, settled.as_ref(), &found)?);
    } else if !arguments.quiet {
        let (muscles, assumed) = (&document.muscles()[..], &document.assumed()[..]);
        let (settled, verbose) = (settled.as_ref(), arguments.verbose);
        let common = Common { name: &name, elapsed, muscles, assumed, settled, verbose };
        text.push_str(&report_text(&figures, common, scenario.as_ref())?);
        text.push_str(&warnings::section(&found));
    }
    // The files take their names when nothing can fail any more.
    pending.into_iter().try_for_each(Pending::commit)?;
    if arguments.quiet {
        warnings::print(&found);
    }
    if arguments.quiet && !arguments.events {
        return Ok(());
    }
    if !arguments.quiet && !as_json {
        text.push_str(&files.written(rows));
    }
    if arguments.events {
        let gap = if text.is_empty() { "" } else { "\n" };
        text.push_str(gap);
        text.push_str(&table.unwrap_or_default());
    }
    terminal::print(&text)
}

/// Refuses to draw several actuators over one length.
///
/// # Errors
/// [`Failure::input`].
pub(super) fn over_time(ready: &Ready, over: TrajectoryAxis) -> Result<(), Failure> {
    if !ready.has_several() || over == TrajectoryAxis::Time {
        return Ok(());
    }
    let title = "--over: several actuators have several lengths, so they are drawn over time";
    Err(Failure::input(title, "leave --over out, or name columns by --columns"))
}

/// The summary of a run in words.
///
/// # Errors
/// None but those of the engine.
pub(super) fn report_text(
    figures: &Figures,
    common: Common<'_>,
    scenario: Option<&Scenario>,
) -> Result<String, Failure> {
    match (figures, scenario) {
        (Figures::Plant(run), _) => summary::plant::Summary { common, run }.render(),
        // Not reached: what is no plant has been read as a scenario. Said rather than assumed.
        (_, None) => Err(Failure::stopped("the run has no scenario")),
        (Figures::Actuator(of), Some(scenario)) => {
            let (rig, observation, control) = (&of.rig, &of.observation, of.control.as_ref());
            Summary { common, scenario, rig, control, observation }.render()
        }
        (Figures::Joint(of), Some(scenario)) => {
            let antagonist = scenario.of_antagonist();
            let scenarios = [scenario, antagonist.as_ref().unwrap_or(scenario)];
            let (rig, observation, control) = (&of.rig, &of.observation, of.control.as_ref());
            summary::joint::Summary { common, scenarios, rig, observation, control }.render()
        }
    }
}

/// The requested files.
#[derive(Debug)]
struct Files<'a> {
    output: Option<(&'a Path, record::Format)>,
    plot: Option<(&'a Path, Format)>,
    events: Option<&'a Path>,
}

impl<'a> Files<'a> {
    /// The files with their formats, all different.
    fn of(arguments: &'a SimulateArguments) -> Result<Self, Failure> {
        let output = arguments.output.as_deref();
        let plot = arguments.plot.as_deref();
        let events = arguments.events_output.as_deref();
        if let Some(path) = events.filter(|path| record::ending(path).as_deref() != Some("csv")) {
            let title = format!("`{}` does not say how to write the events", path.display());
            return Err(Failure::input(title, "end the name of --events-output with .csv"));
        }
        let help = "give --output, --plot and --events-output names of their own";
        output::distinct(
            arguments.files.iter().map(PathBuf::as_path),
            output.into_iter().chain(plot).chain(events),
            help,
        )?;
        let output = output.map(|path| record::Format::of(path).map(|format| (path, format))).transpose()?;
        let plot = files::figure(plot)?;
        Ok(Self { output, plot, events })
    }

    fn paths(&self) -> impl Iterator<Item = &'a Path> {
        let output = self.output.map(|(path, _)| path);
        let plot = self.plot.map(|(path, _)| path);
        output.into_iter().chain(plot).chain(self.events)
    }

    fn probe(&self) -> Result<(), Failure> {
        self.paths().try_for_each(output::probe)
    }

    /// Whether a request needs more of a run than its samples in order.
    fn keep(&self, arguments: &SimulateArguments) -> bool {
        self.plot.is_some() || self.events.is_some() || arguments.events
    }

    /// Writes the requested files of a run that was kept; the files have no names yet.
    fn write(
        &self,
        arguments: &SimulateArguments,
        provenance: &Provenance<'_>,
        finished: &Finished,
    ) -> Result<Vec<Pending>, Failure> {
        let _progress = Progress::begin("writing", None);
        let mut pending = Vec::new();
        if let Some((path, format)) = self.output {
            let mut file = Pending::create(path)?;
            finished.write(provenance, (path, format), file.writer())?;
            pending.push(file);
        }
        if let Some(target) = self.plot {
            let title = figure::title::of(provenance.document, provenance.set);
            let (path, format) = target;
            let request = Request { over: arguments.over, title: &title, columns: &arguments.columns };
            let figure = figure::draw(&[("", finished)], &request)?;
            pending.push(files::pending(path, &figure.bytes(format).map_err(|error| Failure::output(path, error))?)?);
        }
        if let Some(path) = self.events {
            let mut file = Pending::create(path)?;
            finished.log().write(path, file.writer())?;
            pending.push(file);
        }
        Ok(pending)
    }

    /// What was written, as the end of the summary.
    fn written(&self, rows: u64) -> String {
        let mut text = String::new();
        for path in self.paths() {
            let is_output = self.output.is_some_and(|(output, _)| output == path);
            let rows =
                if is_output { format!(", {}", mckibben_run::quantities::counted(rows, "row")) } else { String::new() };
            text.push_str(&terminal::wrote(path, &rows));
        }
        if text.is_empty() { text } else { format!("\n{text}") }
    }
}
