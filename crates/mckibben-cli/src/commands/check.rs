//! `mckibben check`: reads scenario files with their sweeps and builds what they describe, without simulating.

use crate::settings::Setting;
use crate::terminal::{self, GOOD, styled};
use crate::{describe, files, warnings};
use mckibben_run::engine;
use mckibben_run::failure::Failure;
use mckibben_run::quantities::{counted, given};
use mckibben_run::run::Ready;
use mckibben_run::warnings::Warning;
use mckibben_scenario::diagnostic::Class;
use mckibben_scenario::{Diagnostic, Diagnostics, Document, PlantExperiment, Scenario, Style, Sweep};
use std::path::{Path, PathBuf};

/// Arguments of `mckibben check`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben check muscle.toml
  mckibben check scenarios/*.toml
  mckibben check --strict - < muscle.toml
  mckibben check muscle.toml --set 'load.mass=10 lb'

Warnings are those that are known before a run: `mckibben simulate --help` lists them. Of a sweep the file's own values are \
looked at.

Exit codes: 0 every file is good; 2 at least one is not, or with --strict has a warning.")]
pub struct CheckArguments {
    /// The scenario files; - is standard input.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Set a value of each scenario before it is checked, such as `command.duty=0.3`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
    /// Make errors of warnings.
    #[arg(long)]
    pub strict: bool,
}

/// Checks the files, all of them, whatever is found.
///
/// # Errors
/// [`Failure::input`] when one of the files is wrong; what is wrong has then been printed.
pub fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let (mut wrong, mut mistakes, mut warned) = (0, 0, 0);
    for path in &arguments.files {
        match check(path, &arguments.set) {
            Ok((summary, found, note)) => {
                let file = path.display().to_string();
                note.iter().for_each(|note| terminal::print_error(note));
                found.iter().for_each(|one| terminal::print_error(&warnings::line(one, &file)));
                if arguments.strict && !found.is_empty() {
                    wrong += 1;
                    warned += found.len();
                } else {
                    terminal::print(&format!("{} {file}: {summary}\n", styled(GOOD, "ok")))?;
                }
            }
            Err(found) => {
                wrong += 1;
                mistakes += found.len();
                found.iter().for_each(|one| terminal::print_error(&format!("{}\n\n", one.render(Style::Coloured))));
            }
        }
    }
    if wrong == 0 {
        return Ok(());
    }
    let files = arguments.files.len();
    let of_how_many =
        if files == 1 { "the file is wrong".to_owned() } else { format!("{wrong} of {files} files wrong") };
    let counts = [(mistakes, plural(mistakes)), (warned, warnings::plural(warned))];
    let counts: Vec<String> = counts.into_iter().filter(|(count, _)| *count > 0).map(|(_, words)| words).collect();
    let help = match mistakes {
        0 => "change what is warned of above, or leave --strict out",
        _ => "correct the mistakes above and check again",
    };
    Err(Failure::input(format!("{of_how_many}, {}", counts.join(" and ")), help))
}

/// Reads a file, sets values and builds what it describes; a few words about it with its warnings and a note, or its mistakes.
fn check(path: &Path, set: &[Setting]) -> Result<(String, Vec<Warning>, Option<String>), Vec<Diagnostic>> {
    let mut document = files::document(path).map_err(listed)?;
    set.iter().try_for_each(|setting| setting.set_in(&mut document)).map_err(listed)?;
    let summary = words(&document)?;
    // A scenario that the sweep completes describes nothing without it.
    let ready = Ready::of(&document).ok();
    let found = ready.as_ref().map(Ready::warnings).unwrap_or_default();
    let file = path.display().to_string();
    let note = ready.and_then(|ready| warnings::idle_steps(&document, ready.plan().engine, &file));
    Ok((summary, found, note))
}

fn listed(found: Diagnostics) -> Vec<Diagnostic> {
    found.iter().cloned().collect()
}

/// A few words about what a document describes, or its mistakes.
fn words(document: &Document) -> Result<String, Vec<Diagnostic>> {
    let single = if document.is_plant() {
        document
            .plant_experiment()
            .map(|plant| plant.as_ref().map(summary_of_plant).unwrap_or_default() + &braids(document))
    } else {
        document.scenario().and_then(|scenario| {
            let controlled =
                document.controlled_joint_experiment()?.is_some() || document.controlled_experiment()?.is_some();
            if !controlled && document.joint_experiment()?.is_none() {
                document.experiment()?;
            }
            Ok(summary_of_scenario(&scenario) + &braids(document))
        })
    };
    let (sweep, mut mistakes) = match document.sweep() {
        Ok(None) => return single.map_err(listed),
        Ok(Some(sweep)) => (sweep_summary(&sweep), Vec::new()),
        Err(found) => (String::new(), listed(found)),
    };
    // What is missing outside the section [sweep] may be what it varies; if not, the sweep has missed it too.
    let is_known = |new: &Diagnostic, known: &Diagnostic| (known.place(), known.title()) == (new.place(), new.title());
    for new in single.as_ref().err().into_iter().flatten().filter(|new| new.class() != Class::Missing) {
        if !mistakes.iter().any(|known| is_known(new, known)) {
            mistakes.push(new.clone());
        }
    }
    match (mistakes.is_empty(), single) {
        (false, _) => Err(mistakes),
        (true, Ok(single)) => {
            // The braids stand below.
            let (first, rest) = single.split_once('\n').map_or((single.as_str(), ""), |(first, rest)| (first, rest));
            let gap = if rest.is_empty() { "" } else { "\n" };
            Ok(format!("{first}; {sweep}{gap}{rest}"))
        }
        (true, Err(_)) => Ok(sweep),
    }
}

fn summary_of_scenario(scenario: &Scenario) -> String {
    let (load, drive) = (describe::load(&scenario.load), describe::drive(scenario));
    let (duration, samples) = (given(scenario.run.duration, "s"), counted(engine::rows(&scenario.run), "sample"));
    format!("{load}; {drive}; {duration}, {samples}")
}

/// The braids of the file, each on a line.
fn braids(document: &Document) -> String {
    let lines = describe::muscles(&document.muscles());
    lines.into_iter().map(|(names, text)| format!("\n   {names}: {text}")).collect()
}

fn summary_of_plant(plant: &PlantExperiment) -> String {
    let actuators = plant.names.actuators.join(", ");
    let (duration, samples) = (given(plant.run.duration, "s"), counted(engine::rows(&plant.run), "sample"));
    format!("a plant of {actuators}; {duration}, {samples}")
}

fn sweep_summary(sweep: &Sweep) -> String {
    let varied: Vec<&str> = sweep.axes().iter().map(|axis| axis.path.as_str()).collect();
    format!("sweep of {} over {} ({})", counted(sweep.rows(), "run"), varied.join(", "), sweep.design().name())
}

fn plural(mistakes: usize) -> String {
    if mistakes == 1 { "one mistake".to_owned() } else { format!("{mistakes} mistakes") }
}
