//! `mckibben sweep`: the runs of `[sweep]` on all cores, into files that need no merge.
//!
//! Everything that can be refused is refused before anything is simulated.

mod summary;

use crate::files;
use crate::interrupt;
use crate::settings::Setting;
use crate::terminal;
use mckibben_plot::{PlotError, Theme};
use mckibben_run::failure::Failure;
use mckibben_run::output;
use mckibben_run::record;
use mckibben_run::sweep::counts::SweepCounts;
use mckibben_run::sweep::destination::Place;
use mckibben_run::sweep::folder::{FinishedPart, Folder};
use mckibben_run::sweep::plan::{Plan, Shard};
use mckibben_run::sweep::prepared::Prepared;
use mckibben_run::sweep::step::Choice;
use mckibben_run::sweep::{chart, read};
use mckibben_scenario::{Document, StatisticsOver, Sweep};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `mckibben sweep`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben sweep muscle.toml --output results
  mckibben sweep muscle.toml --output results.csv --plot results.svg
  mckibben sweep muscle.toml --output results --shard $SLURM_ARRAY_TASK_ID/64 --jobs 16
  mckibben sweep muscle.toml --output traces --record trajectories --set 'run.duration=1 s'

The section [sweep] says what varies:
  [sweep]
  reductions = [\"length.final\", \"length.ripple\", \"tension.peak\", \"air.used\"]
  [sweep.vary]
  \"load.mass\" = [\"3 lb\", \"5 lb\", \"15 lb\"]
  \"supply.gauge_pressure\" = { from = \"20 psi\", to = \"100 psi\", count = 9 }

Reductions are taken over the samples at every run.sample_interval; what happens between two samples is not seen. \
A ripple is that of the last PWM period, or of the last tenth of a run without PWM. `air.used` sums the gains of air \
between samples while the supply is open; of an event-located run it is the integral of the flow.

With --settle, or sweep.over = \"orbit\", each run goes on until its states return after a period of the pulses. Statistics of \
a quantity are then those of the orbit, and empty where a run has none; settling_time, overshoot, air.used and errors of \
controllers stay those of the run. The orbit is that of the event-located engine, whatever the run took up to its end; \
without run.engine the run takes that engine too.

Without run.engine and --engine a plant takes the event-located engine, as in `mckibben simulate`, and one actuator or a joint \
the fixed-step engine, except with --settle and under a controller without run.step.

The fixed-step engine takes run.step; without it, one step for all runs: the least that eight of them, evenly spread, need \
for run.accuracy. One of them that no step is short enough for, as when it bounces without end, is named in the summary; \
the event-located engine has no such choice to make. If run.accuracy varies, each run has the step it needs.

A sweep that was stopped goes on where it was when the same command is given again: finished parts are kept, once each was \
held to the checksum in it. Shards are counted from 1; shard I of N does the parts I, I + N, I + 2 N, ... and can share the \
folder with the others, also when all begin at once. \
A run that fails has its reason in the column `error` and no numbers; it does not stop the others. The summary counts the \
runs with each warning and names the first; the column `warnings` has the codes of each run. They follow from the start of a run and \
from its samples.

Exit codes:
  0  done; some runs may have failed, and the summary says so
  2  the input is wrong: arguments, a missing file, the scenario, a folder of another sweep; nothing was written
  3  every run failed; the files say why
  4  a file could not be written; parts that were finished stay
  130, 143  stopped by SIGINT (Ctrl-C), SIGTERM; parts that were finished stay")]
pub struct SweepArguments {
    /// The scenario file with a section `[sweep]`, or - for standard input.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Write the runs: into a folder of Parquet parts, or one file .csv, .parquet or .mat.
    #[arg(short, long, value_name = "FOLDER or FILE")]
    pub output: Option<PathBuf>,
    /// Draw the reductions: .svg, .png, .pdf, or .html for a page to zoom in. One varied key gives lines, a grid of two gives maps, more give scatter plots.
    #[arg(short, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Set a value of the scenario, such as `command.duty=0.3` or `sweep.rows=1000`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
    /// What to write of each run, in place of sweep.record.
    #[arg(long, value_name = "WHAT", value_parser = ["reductions", "samples", "trajectories"])]
    pub record: Option<String>,
    /// The engine, in place of run.engine; without either, of a plant event-located, else fixed-step, but event-located with
    /// --settle and under a controller without run.step.
    #[arg(long, value_name = "ENGINE", value_parser = ["event-located", "fixed-step"])]
    pub engine: Option<String>,
    /// Run on behind the end to the periodic orbit, or the equilibrium, and take final, mean, min, max, ripple, drift and peak
    /// there, in place of sweep.over.
    #[arg(long)]
    pub settle: bool,
    /// Do one of N shares of the parts, counted from 1: 1/8, 2/8, ... 8/8.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    pub shard: Shard,
    /// Threads, at most 256, or four for each core where that is more; without it, one for each core.
    #[arg(short, long, value_name = "N", value_parser = jobs, allow_negative_numbers = true)]
    pub jobs: Option<NonZeroUsize>,
    /// Print no summary.
    #[arg(short, long)]
    pub quiet: bool,
}

/// Runs the sweep.
///
/// # Errors
/// The input is wrong, every run failed, or a file could not be written.
pub fn run(arguments: &SweepArguments) -> Result<(), Failure> {
    let figure = files::figure(arguments.plot.as_deref())?;
    let target = Target::of(arguments)?;
    let jobs = threads(arguments.jobs)?;
    let (document, set) = document(arguments)?;
    let prepared = Prepared::of(&document, &set)?.ok_or_else(|| {
        let title = format!("`{}` has no section [sweep]", document.source().name());
        Failure::input(title, "say what varies under [sweep.vary]; `mckibben sweep --help` has an example")
    })?;
    let (sweep, plan) = (prepared.sweep(), prepared.plan());
    if figure.is_some() && sweep.record().reduced().is_none() {
        let title = "--plot draws reductions, which are not recorded here";
        return Err(Failure::input(title, "set sweep.record = \"reductions\", or leave --plot out"));
    }
    figure.map_or(Ok(()), |(path, _)| output::probe(path))?;

    let started = Instant::now();
    let mut totals = SweepCounts::new(sweep, figure.is_some());
    let mut parts = plan.parts_of(arguments.shard)?;
    let place = match target {
        Target::Nothing => Place::Nowhere,
        Target::File(path, format) => Place::file(path, format, prepared.columns())?,
        Target::Folder(path) => {
            let folder = prepared.folder(path)?;
            let finished = keep(&folder, &plan, &parts, sweep, &mut totals)?;
            parts.retain(|part| !finished.contains(part));
            let of_program = folder.clone();
            interrupt::on_end(move || of_program.stays(&plan));
            Place::Folder(folder)
        }
    };
    let kept = totals.runs();
    let written = parts.len() as u64;
    // More threads than rows would have nothing to do.
    let jobs = usize::try_from(plan.rows).map_or(jobs, |rows| jobs.min(rows.max(1)));
    let choice = if parts.is_empty() { None } else { Choice::of(sweep, jobs)? };
    prepared.simulate(choice.as_ref(), parts, jobs, place, &mut totals)?;
    let elapsed = started.elapsed();

    if let Some((path, format)) = figure {
        let set: Vec<String> = arguments.set.iter().map(ToString::to_string).collect();
        let title = mckibben_run::figure::title::of_sweep(&document, sweep, &set);
        let bytes = chart::draw(sweep, &totals, &title, (path, format))?;
        output::write(path, &bytes)?;
    }
    if !arguments.quiet {
        terminal::print(&summary::summary(
            arguments,
            &plan,
            (sweep, choice.as_ref()),
            &totals,
            (kept, written, elapsed),
        ))?;
    }
    match totals.first_reason() {
        Some(reason) if totals.failed() == totals.runs() => {
            Err(Failure::stopped(format!("every run failed; the first because {reason}")))
        }
        _ => Ok(()),
    }
}

/// A number of threads as users write it.
fn jobs(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "give a whole number from 1, or leave --jobs out for one thread for each core".to_owned())
}

/// How many threads a sweep may have.
///
/// # Errors
/// [`Failure::input`] for more than the machine can use: each has its own stack and rows that wait.
fn threads(wanted: Option<NonZeroUsize>) -> Result<usize, Failure> {
    /// The most for each core, and on any machine.
    const MOST: [usize; 2] = [4, 256];
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let (jobs, most) = (wanted.map_or(cores, NonZeroUsize::get), MOST[1].max(MOST[0] * cores));
    if jobs > most {
        let title = format!("--jobs = {jobs} is more threads than the {cores} cores here can use: at most {most}");
        return Err(Failure::input(title, "give fewer, or leave --jobs out for one thread for each core"));
    }
    Ok(jobs)
}

/// Where the runs are to be written.
#[derive(Clone, Copy, Debug)]
enum Target<'a> {
    Nothing,
    File(&'a Path, record::Format),
    Folder(&'a Path),
}

impl<'a> Target<'a> {
    fn of(arguments: &'a SweepArguments) -> Result<Self, Failure> {
        let target = match arguments.output.as_deref() {
            None => Self::Nothing,
            Some(path) if path.is_dir() => Self::Folder(path),
            Some(path) if record::ending(path).is_none() => {
                // Looked at once: another sweep may begin this folder meanwhile.
                if path.metadata().is_ok_and(|its| !its.is_dir()) {
                    let title = format!("`{}` is there and is no folder", path.display());
                    let help = "give --output a folder, or a name with .csv, .parquet or .mat at its end for one file";
                    return Err(Failure::input(title, help));
                }
                Self::Folder(path)
            }
            Some(path) => match record::Format::of(path) {
                Ok(format) => Self::File(path, format),
                Err(_) => {
                    let title = format!("`{}` does not say how to write the runs", path.display());
                    let help = "end the name of --output with .csv, .parquet or .mat for one file, or give a folder";
                    return Err(Failure::input(title, help));
                }
            },
        };
        if arguments.shard != Shard::WHOLE && !matches!(target, Self::Folder(_)) {
            let help = "give --output a folder that the shards share, or leave --shard out";
            return Err(Failure::input("--shard does some of the parts, which only a folder has", help));
        }
        if arguments.shard != Shard::WHOLE && arguments.plot.is_some() {
            let help = "draw when all shards are done: the same command without --shard keeps their parts";
            return Err(Failure::input("--plot draws the whole sweep, and --shard does a share of it", help));
        }
        let written = [&arguments.output, &arguments.plot].into_iter().flatten().map(PathBuf::as_path);
        output::distinct([arguments.file.as_path()], written, "give --output and --plot names of their own")?;
        Ok(target)
    }
}

/// The scenario with what the command line sets in it, and that as `KEY=VALUE`.
fn document(arguments: &SweepArguments) -> Result<(Document, Vec<String>), Failure> {
    let mut document = files::document(&arguments.file)?;
    let mut set: Vec<String> = arguments.set.iter().map(Setting::to_string).collect();
    for setting in &arguments.set {
        setting.apply(&mut document)?;
    }
    // What the file says about another record does not apply to this one.
    let idle: &[&str] = match arguments.record.as_deref() {
        None => &[],
        Some("reductions") => &["sweep.sample_times"],
        Some("samples") => &["sweep.reductions", "sweep.over"],
        Some(_) => &["sweep.reductions", "sweep.over", "sweep.sample_times"],
    };
    for key in idle {
        document.remove(key);
    }
    let over = arguments.settle.then(|| StatisticsOver::Orbit.name().to_owned());
    for (option, key, value) in [
        ("--engine", "run.engine", arguments.engine.clone()),
        ("--record", "sweep.record", arguments.record.clone()),
        ("--settle", "sweep.over", over),
    ] {
        if let Some(value) = value {
            document.set_text_from(option, key, &format!("\"{value}\""))?;
            set.push(format!("{key}={value}"));
        }
    }
    Ok((document, set))
}

/// Does all runs of a sweep, on all cores, and draws them.
pub(crate) fn svg(prepared: &Prepared, theme: Theme) -> Result<Result<String, PlotError>, Failure> {
    let jobs = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let (sweep, parts) = (prepared.sweep(), prepared.plan().parts_of(Shard::WHOLE)?);
    let choice = Choice::of(sweep, jobs)?;
    let mut totals = SweepCounts::new(sweep, true);
    prepared.simulate(choice.as_ref(), parts, jobs, Place::Nowhere, &mut totals)?;
    match totals.first_reason() {
        Some(reason) if totals.failed() == totals.runs() => {
            Err(Failure::stopped(format!("every run failed; the first because {reason}")))
        }
        _ => Ok(chart::svg(sweep, &totals, theme)),
    }
}

/// Finds the parts that are finished, and takes up what is in them.
fn keep(
    folder: &Folder,
    plan: &Plan,
    parts: &[u64],
    sweep: &Sweep,
    totals: &mut SweepCounts,
) -> Result<Vec<u64>, Failure> {
    let mut finished = Vec::new();
    for part in parts {
        let Some(FinishedPart { failed, warned }) = folder.finished(plan, *part)? else { continue };
        totals.warn(&warned);
        match sweep.record().reduced() {
            Some(reductions) => {
                let results: Vec<String> = reductions.into_iter().map(|reduction| reduction.column).collect();
                read::reductions(&folder.part(*part), &results, &mut |row, outcome| totals.see(row, outcome))?;
            }
            None => {
                let rows = plan.rows_of(*part);
                totals.count(rows.end - rows.start, failed);
            }
        }
        finished.push(*part);
    }
    Ok(finished)
}
