//! `mckibben simulate`: runs a scenario, tells what it came to, and writes what is asked for.
//!
//! Everything that can be refused is refused before anything is simulated, and every file is complete before any of
//! them takes its name.

use crate::closed_loop;
use crate::engine::{self, Outcome};
use crate::events;
use crate::failure::Failure;
use crate::observation::Observer;
use crate::output::{self, Pending};
use crate::portrait;
use crate::progress::Progress;
use crate::record::{self, Provenance};
use crate::settings::Setting;
use crate::summary::Summary;
use crate::terminal;
use mckibben_scenario::{Document, Engine, Experiment, Scenario};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

mod joint;

/// What `mckibben simulate` is asked.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben simulate muscle.toml
  mckibben simulate muscle.toml --output run.csv --plot run.svg
  mckibben simulate muscle.toml --set command.duty=0.3 --set 'load.mass=10 lb' -o run.parquet
  mckibben simulate muscle.toml --set run.engine=fixed-step --set 'run.step=0.5 ms'

Exit codes:
  0  done
  2  the input is wrong: arguments, a missing file, the scenario; nothing was written
  3  the simulation could not go on; nothing was written
  4  a file could not be written; nothing was left behind")]
pub struct SimulateArguments {
    /// The scenario file; `mckibben init` writes one to start from.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Write the run, one row for each sample interval: .csv or .parquet.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the run: .svg or .png.
    #[arg(short, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// What the figure is drawn over.
    #[arg(long, value_enum, default_value_t, value_name = "QUANTITY", requires = "plot")]
    pub over: portrait::Over,
    /// Set a value of the scenario, such as `command.duty=0.3` or `load.mass=10 lb`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
    /// Print every event after the summary.
    #[arg(long)]
    pub events: bool,
    /// Write every event: .csv.
    #[arg(long, value_name = "FILE")]
    pub events_output: Option<PathBuf>,
    /// Print no summary.
    #[arg(short, long)]
    pub quiet: bool,
}

/// Runs the scenario.
///
/// # Errors
/// The input is wrong, the simulation could not go on, or a file could not be written.
pub fn run(arguments: &SimulateArguments) -> Result<(), Failure> {
    let files = Files::of(arguments)?;
    let mut document = Document::load(&arguments.file)?;
    for setting in &arguments.set {
        setting.apply(&mut document)?;
    }
    let scenario = document.scenario()?;
    let joint = match document.controlled_joint_experiment()? {
        Some(controlled) => Some(joint::Joint::Controlled(Box::new(controlled))),
        None => document.joint_experiment()?.map(Box::new).map(joint::Joint::Open),
    };
    if let Some(joint) = joint {
        if arguments.over != portrait::Over::Time {
            return Err(Failure::input(
                "--over: an antagonistic joint has two lengths, so it is drawn over time",
                "leave --over out, and take the columns of --output for another figure",
            ));
        }
        return joint::run(arguments, &files, &document, &scenario, &joint);
    }
    let controlled = document.controlled_experiment()?;
    let experiment = match &controlled {
        Some(of) => of.experiment.clone(),
        None => document.experiment()?,
    };
    if arguments.events_output.is_some() && experiment.run.engine == Engine::FixedStep {
        return Err(Failure::input(
            "--events-output: the fixed-step engine keeps no log of events",
            "set run.engine = \"event-located\", or leave --events-output out",
        ));
    }
    files.probe()?;

    let started = Instant::now();
    let failed = |error| Failure::of_core(&error, &document);
    let closed = controlled.as_ref().map(closed_loop::close).transpose().map_err(failed)?;
    let experiment = closed.as_ref().map_or(experiment, |closed| closed.experiment.clone());
    let mut observer = Observer::new(&experiment);
    let mut watch = |sample: &_| observer.see(sample);
    let outcome = match &closed {
        Some(closed) => closed.outcome(&experiment, &mut watch),
        None => engine::run(&experiment, &mut watch),
    }
    .map_err(failed)?;
    let elapsed = started.elapsed();

    let interval = experiment.run.sample_interval;
    match &closed {
        Some(closed) => files.write_with(
            arguments,
            (&document, &scenario),
            |provenance, target, out| {
                record::write_controlled(&outcome, &closed.goals, interval, provenance, target, out)
            },
            |title, target| portrait::draw(&experiment, &outcome, &closed.goals, arguments.over, title, target),
            |path, out| events::of(&outcome).map_or(Ok(()), |log| events::write(log, path, out)),
        )?,
        None => files.write(arguments, &document, &scenario, &experiment, &outcome)?,
    }
    if arguments.quiet && !arguments.events {
        return Ok(());
    }
    let mut text = String::new();
    if !arguments.quiet {
        let observation = observer.finish(&outcome);
        let assumed = document.assumed();
        let name = arguments.file.display().to_string();
        let summary = Summary {
            name: &name,
            scenario: &scenario,
            experiment: &experiment,
            outcome: &outcome,
            control: closed.as_ref(),
            observation: &observation,
            elapsed,
            assumed: &assumed,
        };
        text.push_str(&summary.render());
        text.push_str(&files.told(engine::rows(&experiment.run)));
    }
    if arguments.events {
        let gap = if text.is_empty() { "" } else { "\n" };
        text.push_str(gap);
        text.push_str(&match events::of(&outcome) {
            Some(log) => events::table(log),
            None => "the fixed-step engine keeps no log of events\n".to_owned(),
        });
    }
    terminal::print(&text)
}

/// The files that are asked for.
#[derive(Debug)]
struct Files<'a> {
    output: Option<(&'a Path, record::Format)>,
    plot: Option<(&'a Path, portrait::Format)>,
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
        let scenario = Some(arguments.file.as_path());
        let same = |a: Option<&Path>, b: Option<&Path>| a.is_some() && a.map(output::settled) == b.map(output::settled);
        if same(output, events) || same(output, scenario) || same(events, scenario) || same(plot, scenario) {
            return Err(Failure::input(
                "two of the files that are to be read and written are the same",
                "give --output, --plot and --events-output names of their own",
            ));
        }
        let output = output.map(|path| record::Format::of(path).map(|format| (path, format))).transpose()?;
        let plot = plot.map(|path| portrait::Format::of(path).map(|format| (path, format))).transpose()?;
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

    fn write(
        &self,
        arguments: &SimulateArguments,
        document: &Document,
        scenario: &Scenario,
        experiment: &Experiment,
        outcome: &Outcome<'_>,
    ) -> Result<(), Failure> {
        let interval = experiment.run.sample_interval;
        self.write_with(
            arguments,
            (document, scenario),
            |provenance, target, out| record::write(outcome, interval, provenance, target, out),
            |title, target| portrait::draw(experiment, outcome, &[], arguments.over, title, target),
            |path, out| events::of(outcome).map_or(Ok(()), |log| events::write(log, path, out)),
        )
    }

    /// Writes what is asked for by three functions, of the output, the figure's bytes and the events, and lets all files
    /// take their names when the last is complete.
    fn write_with(
        &self,
        arguments: &SimulateArguments,
        (document, scenario): (&Document, &Scenario),
        output: impl FnOnce(&Provenance<'_>, (&Path, record::Format), &mut (dyn Write + Send)) -> Result<(), Failure>,
        plot: impl FnOnce(&str, (&Path, portrait::Format)) -> Result<Vec<u8>, Failure>,
        events: impl FnOnce(&Path, &mut dyn Write) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let _progress = Progress::begin("writing", None);
        let mut pending = Vec::new();
        if let Some((path, format)) = self.output {
            let set: Vec<String> = arguments.set.iter().map(Setting::to_string).collect();
            let provenance = Provenance { document, set: &set, scenario };
            let mut file = Pending::create(path)?;
            output(&provenance, (path, format), file.writer())?;
            pending.push(file);
        }
        if let Some((path, format)) = self.plot {
            let title = arguments.file.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let bytes = plot(&title, (path, format))?;
            let mut file = Pending::create(path)?;
            file.writer().write_all(&bytes).map_err(|error| Failure::output(path, error))?;
            pending.push(file);
        }
        if let Some(path) = self.events {
            let mut file = Pending::create(path)?;
            events(path, file.writer())?;
            pending.push(file);
        }
        pending.into_iter().try_for_each(Pending::commit)
    }

    /// What was written, as the end of the summary.
    fn told(&self, rows: u64) -> String {
        let mut text = String::new();
        for path in self.paths() {
            let is_output = self.output.is_some_and(|(output, _)| output == path);
            let rows = if is_output { format!(", {} rows", crate::quantities::count(rows)) } else { String::new() };
            text.push_str(&format!("{} {}{rows}\n", terminal::styled(terminal::GOOD, "wrote"), path.display()));
        }
        if text.is_empty() { text } else { format!("\n{text}") }
    }
}
