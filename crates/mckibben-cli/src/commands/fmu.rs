//! `mckibben fmu`: a scenario as a functional mock-up unit for other simulators.
//!
//! Everything is done by [`mckibben_fmu`]. Checked by `tests/fmu.rs`.

use crate::files;
use crate::settings::Setting;
use crate::terminal;
use clap::ValueEnum;
use mckibben_fmu::description::left_out;
use mckibben_fmu::export::{Library, write_fmu};
use mckibben_fmu::model::Model;
use mckibben_fmu::options::{Interfaces, UnitOptions, Version};
use mckibben_run::failure::Failure;
use mckibben_run::host::{COMMAND_MODES, Motion};
use mckibben_run::output;
use mckibben_run::quantities::read;
use std::path::{Path, PathBuf};

/// Arguments of `mckibben fmu`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben fmu muscle.toml --output muscle.fmu
  mckibben fmu muscle.toml --output muscle.fmu --fmi 2 --kind me
  mckibben fmu arm.toml --output arm.fmu --motion scenario --command-mode request
  mckibben fmu muscle.toml --output muscle.fmu --pulse-frequency '50 Hz'

The unit:
  With --motion host the host owns masses and joints: `NAME.distance` and `NAME.rate` are inputs, `NAME.tension` is an \
  output. With --motion scenario loads and mechanisms of the file move. Valves are commanded by `NAME.duty`, \
  `NAME.request`, `NAME.position` or `NAME.set_point`. Controllers of the file are left out.
  The numbers that the file says are parameters, which a host may change before the run.
  Values are in SI. --units chooses the units in which hosts display them.
  With --kind me no step is chosen: the host integrates. With --kind cs or both and --motion scenario the step is
  run.step, or the longest that run.accuracy allows.

Exit codes:
  0  done
  2  the input is wrong: arguments, a missing file, the scenario; nothing was written
  4  the file could not be written; nothing was left behind")]
pub struct FmuArguments {
    /// The scenario file, or - for standard input; `mckibben init` writes one to start from.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The unit, which ends in .fmu.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// The version of FMI.
    #[arg(long, value_name = "VERSION", default_value = "3")]
    pub fmi: FmiVersion,
    /// Co-simulation, with the unit's own engine; model exchange, where the host integrates; or both.
    #[arg(long, value_name = "KIND", default_value = "both")]
    pub kind: UnitKind,
    /// Who moves the ends of the actuators.
    #[arg(long, value_name = "WHO", default_value = "host")]
    pub motion: UnitMotion,
    /// What the numbers are that valves are commanded by: duty, request, position or set-point; else each valve's own.
    #[arg(long, value_name = "MODE", value_parser = COMMAND_MODES)]
    pub command_mode: Option<String>,
    /// Frequency of the pulses of a duty cycle, such as `25 Hz`; else that of the scenario's PWM.
    #[arg(long, value_name = "QUANTITY", value_parser = frequency, allow_hyphen_values = true)]
    pub pulse_frequency: Option<f64>,
    /// The longest part of a step that is taken in one go, such as `0.1 ms`.
    #[arg(long, value_name = "QUANTITY", value_parser = time, allow_hyphen_values = true)]
    pub max_step: Option<f64>,
    /// Set a value of the scenario, such as `actuator.turns=2.2`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
}

/// A version of FMI.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum FmiVersion {
    /// FMI 3.0
    #[value(name = "3", alias = "3.0")]
    Three,
    /// FMI 2.0
    #[value(name = "2", alias = "2.0")]
    Two,
}

/// What a unit offers.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum UnitKind {
    /// co-simulation: the unit has its own engine
    Cs,
    /// model exchange: the host integrates
    Me,
    /// both
    Both,
}

/// Who moves the ends.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum UnitMotion {
    /// the host: distances and rates are inputs
    Host,
    /// the scenario: its loads and mechanisms
    Scenario,
}

/// Writes the unit.
///
/// # Errors
/// The input is wrong, the library is not there, or the file could not be written.
pub fn run(arguments: &FmuArguments) -> Result<(), Failure> {
    let path = &arguments.output;
    files::ending(path, "--output", &["fmu"])?;
    let read = [arguments.file.as_path()];
    output::distinct(read, [path.as_path()], "give the unit another name")?;
    output::probe(path)?;
    let library = library()?;
    let mut document = files::document(&arguments.file)?;
    arguments.set.iter().try_for_each(|setting| setting.apply(&mut document))?;
    if let (Some(_), UnitKind::Me) = (arguments.max_step, arguments.kind) {
        let title = "--max-step is of the steps of co-simulation, and a unit of --kind me has none";
        return Err(Failure::input(title, "leave out --max-step, or give --kind cs or --kind both"));
    }
    let model = Model::new(document, arguments.options()).map_err(in_words_of_options)?;
    let is_pulsed = model.plant().commands().iter().any(|input| input.mode.pulse_frequency().is_some());
    if arguments.pulse_frequency.is_some() && !is_pulsed {
        let title = "--pulse-frequency is of duty cycles, and the unit commands no valve by one";
        return Err(Failure::input(
            title,
            "leave out --pulse-frequency, or command valves with seats by --command-mode duty",
        ));
    }
    let version = match arguments.fmi {
        FmiVersion::Three => Version::Three,
        FmiVersion::Two => Version::Two,
    };
    write_fmu(path, &model, version, &[library])?;
    let note = left_out(&model).map(|note| format!("{}\n", terminal::wrap(&note, "")));
    terminal::print(&format!("{}{}", terminal::wrote(path, ""), note.unwrap_or_default()))
}

impl FmuArguments {
    fn options(&self) -> UnitOptions {
        UnitOptions {
            motion: match self.motion {
                UnitMotion::Host => Motion::Host,
                UnitMotion::Scenario => Motion::Scenario,
            },
            interfaces: match self.kind {
                UnitKind::Cs => Interfaces::CoSimulation,
                UnitKind::Me => Interfaces::ModelExchange,
                UnitKind::Both => Interfaces::Both,
            },
            command_mode: self.command_mode.clone(),
            pulse_frequency: self.pulse_frequency,
            max_step: self.max_step,
        }
    }
}

/// The library that a unit carries: in the folder of the program, in `lib` beside that, or where Cargo has built it.
fn library() -> Result<Library, Failure> {
    let program = std::env::current_exe().and_then(std::fs::canonicalize).unwrap_or_default();
    let folder = program.parent().unwrap_or(Path::new("."));
    Library::find([folder, folder.join("../lib").as_path(), folder.join("deps").as_path()])
}

/// A refusal with the names of the options, for messages that all hosts share.
fn in_words_of_options(failure: Failure) -> Failure {
    let said = failure.sentence();
    let named = COMMAND_MODES.iter().fold(said.clone(), |said, mode| {
        said.replace(&format!("command_mode=\"{mode}\""), &format!("--command-mode {mode}"))
    });
    let named = named.replace("give pulse_frequency in Hz", "give --pulse-frequency, such as '25 Hz'");
    match named.split_once("; ") {
        Some((title, help)) if named != said => Failure::input(title, help),
        _ => failure,
    }
}

fn frequency(text: &str) -> Result<f64, String> {
    read(text, "frequency", "Hz", "25 Hz").and_then(|given| above_zero(text, given, "25 Hz"))
}

fn time(text: &str) -> Result<f64, String> {
    read(text, "time", "s", "0.1 ms").and_then(|given| above_zero(text, given, "0.1 ms"))
}

fn above_zero(text: &str, given: f64, example: &str) -> Result<f64, String> {
    if given.is_finite() && given > 0.0 {
        Ok(given)
    } else {
        Err(format!("`{text}` is not above zero; give for instance '{example}'"))
    }
}
