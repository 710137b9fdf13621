//! `mckibben linearize`: a scenario near an operating point, as matrices, poles and a Bode plot.
//!
//! | part | what |
//! |---|---|
//! | `found` | the model of whatever the scenario describes |
//! | `given` | the quantities of the command line, and the point that they ask for |
//! | `told` | the model as text for people |
//! | `export` | the model as JSON and as a MATLAB or Octave script |
//! | `bode` | the figure |
//! | `joint` | all of this for an antagonistic joint |
//! | `plant` | all of this for a file of many actuators |
//!
//! Everything is computed by [`mckibben::linearize`]. Checked by `tests/linearize.rs`.

mod bode;
mod export;
mod found;
mod given;
mod joint;
mod plant;
mod told;

use crate::failure::Failure;
use crate::output::{self, Pending};
use crate::plot::{Figure, PRINT_SCALE, PlotError, Theme};
use crate::settings::Setting;
use crate::terminal;
use clap::FromArgMatches as _;
pub use found::Found;
use given::{Measure, angle, length, load, pressure, stiffness, temperature};
use mckibben::linearize::{Controllability, Linearization, Pole, StateSpace};
use mckibben_scenario::{Assumed, Document};
use std::path::{Path, PathBuf};

/// What `mckibben linearize` is asked.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben linearize muscle.toml
  mckibben linearize muscle.toml --pressure '60 psi' --output model.m
  mckibben linearize muscle.toml --length '85 mm' --load '10 lb' --output model.json
  mckibben linearize muscle.toml --duty 0.4 --plot bode.svg
  mckibben linearize muscle.toml --pressure '50 psi' --pwm

The point:
  Two of --pressure, --length and --load give the third; what is not given is that of the scenario.
  --duty gives the pressure by the valve's mean flow; so does the scenario's own PWM when neither --pressure nor
  --length is given, and the last set point of a regulator or the last position of a spool. With --pwm the command
  follows from the pressure. Otherwise the valve is held shut, and the mass flow into the actuator is the input.
  Of a file of many actuators pulsed and proportional valves are taken by their commands; where there are none, or with
  controllers, all valves are held shut at the initial pressures. With --pwm the commands are those that hold these.

Exit codes:
  0  done
  2  the input is wrong: arguments, a missing file, the scenario, no such point; nothing was written
  4  a file could not be written; nothing was left behind")]
pub struct LinearizeArguments {
    /// The scenario file; `mckibben init` writes one to start from.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Gauge pressure at the point, such as `60 psi`.
    #[arg(long, value_name = "QUANTITY", value_parser = pressure, allow_hyphen_values = true)]
    pub pressure: Option<f64>,
    /// Distance between the attachments at the point, such as `85 mm`.
    #[arg(long, value_name = "QUANTITY", value_parser = length)]
    pub length: Option<f64>,
    /// The load: a mass that hangs, such as `10 lb`, or a force, such as `40 N`.
    #[arg(long, value_name = "QUANTITY", value_parser = load)]
    pub load: Option<Measure>,
    /// Commanded duty at the point: the valve by its mean flow under PWM.
    #[arg(long, value_name = "PART", conflicts_with = "pressure")]
    pub duty: Option<f64>,
    /// The valve by its mean flow under PWM, at the duty that holds the pressure.
    #[arg(long, conflicts_with = "duty")]
    pub pwm: bool,
    /// Temperature of the air at the point; else the scenario's air, brought there by its process.
    #[arg(long, value_name = "QUANTITY", value_parser = temperature)]
    pub temperature: Option<f64>,
    /// Angle of a joint at the point, such as `20 deg`.
    #[arg(long, value_name = "QUANTITY", value_parser = angle, allow_hyphen_values = true, requires = "stiffness")]
    pub angle: Option<f64>,
    /// Stiffness that the two actuators give a joint at that angle, such as `2 N*m/rad`; the pressures follow.
    #[arg(long, value_name = "QUANTITY", value_parser = stiffness, requires = "angle")]
    pub stiffness: Option<f64>,
    /// Replace Coulomb friction by the viscous damping that takes as much from an oscillation of this amplitude.
    #[arg(long, value_name = "QUANTITY", value_parser = length)]
    pub amplitude: Option<f64>,
    /// Keep the air mass as a state where it follows from the others; its pole is zero.
    #[arg(long)]
    pub all_states: bool,
    /// Write the model: .json, or .m for MATLAB and Octave.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the frequency response: .svg or .png.
    #[arg(short, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// The input of the figure: duty, mass_flow or force, of a joint agonist_duty and so on; the valve's unless given.
    #[arg(long, value_name = "INPUT", requires = "plot")]
    pub input: Option<String>,
    /// Set a value of the scenario, such as `actuator.turns=2.2`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
}

/// A linear model with what is known about it.
struct Model {
    /// The name of the scenario file.
    name: String,
    linear: Linearization,
    /// All states, or those that are needed.
    system: StateSpace,
    poles: Vec<Pole>,
    /// What each input reaches.
    reach: Vec<Controllability>,
    /// Amplitude in m, and the angular frequency in rad/s at which Coulomb friction was replaced.
    oscillation: Option<(f64, f64)>,
    /// Numbers of the actuator that no source states.
    assumed: Vec<Assumed>,
}

/// Linearises the scenario.
///
/// # Errors
/// The input is wrong, there is no such point, or a file could not be written.
pub fn run(arguments: &LinearizeArguments) -> Result<(), Failure> {
    endings(arguments)?;
    let mut document = Document::load(&arguments.file)?;
    for setting in &arguments.set {
        setting.apply(&mut document)?;
    }
    let found = Found::of(&arguments.file.display().to_string(), &document, arguments)?;
    let mut pending = Vec::new();
    if let Some(path) = &arguments.output {
        let text = if ending(path) == "json" { found.json() } else { found.matlab() };
        pending.push((path.as_path(), text.into_bytes()));
    }
    if let Some(path) = &arguments.plot {
        pending.push((path.as_path(), bytes(path, &found.figure(arguments.input.as_deref())?)?));
    }
    finish(pending, found.text())
}

impl LinearizeArguments {
    /// What is asked by options as on the command line, without a file: the same words mean the same and are refused alike.
    ///
    /// # Errors
    /// [`Failure::input`] with what is wrong, for other options and for values that they cannot have.
    pub fn of_options(options: impl IntoIterator<Item = String>) -> Result<Self, Failure> {
        let words = ["linearize", "scenario.toml"].map(str::to_owned).into_iter().chain(options);
        let command = <Self as clap::Args>::augment_args(clap::Command::new("linearize"));
        let read = command.try_get_matches_from(words).and_then(|found| Self::from_arg_matches(&found));
        read.map_err(|error| {
            let told = error.render().to_string();
            // What is wrong may take several lines, as where options are missing; an empty one ends it.
            let lines = told.strip_prefix("error: ").unwrap_or(&told).lines().map(str::trim);
            let title = lines.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
            Failure::input(title, "see `mckibben linearize --help`")
        })
    }
}

/// A figure in the format that the name of its file asks for.
fn bytes(path: &Path, figure: &Figure) -> Result<Vec<u8>, Failure> {
    let failed = |error: PlotError| Failure::output(path, error);
    match ending(path).as_str() {
        "png" => figure.to_png(Theme::Light, PRINT_SCALE).map_err(failed),
        _ => figure.to_svg(Theme::Light).map(String::into_bytes).map_err(failed),
    }
}

/// Writes the files, each taking its name when all are complete, and tells the text.
fn finish(pending: Vec<(&Path, Vec<u8>)>, mut text: String) -> Result<(), Failure> {
    let files = pending.iter().map(|(path, bytes)| {
        let mut file = Pending::create(path)?;
        file.writer().write_all(bytes).map_err(|error| Failure::output(path, error))?;
        Ok(file)
    });
    files.collect::<Result<Vec<Pending>, Failure>>()?.into_iter().try_for_each(Pending::commit)?;
    for (path, _) in &pending {
        text.push_str(&format!("{} {}\n", terminal::styled(terminal::GOOD, "wrote"), path.display()));
    }
    terminal::print(&text)
}

/// The Bode plot of a scenario at its own point.
pub(crate) fn figure(file: &Path, document: &Document) -> Result<Figure, Failure> {
    Found::of(&file.display().to_string(), document, &LinearizeArguments::default())?.figure(None)
}

impl Model {
    fn new(
        name: &str,
        linear: Linearization,
        arguments: &LinearizeArguments,
        assumed: Vec<Assumed>,
    ) -> Result<Self, Failure> {
        let oscillation = match arguments.amplitude {
            Some(amplitude) => Some((amplitude, oscillation(&linear)?)),
            None => None,
        };
        let linear = match oscillation {
            Some((amplitude, frequency)) => linear.with_equivalent_damping(amplitude, frequency)?,
            None => linear,
        };
        let system = if arguments.all_states { linear.system.clone() } else { linear.minimal() };
        let reach = (0..system.inputs.len()).map(|input| linear.controllability(&system, input));
        let reach = reach.collect::<Result<_, _>>()?;
        Ok(Self { name: name.to_owned(), poles: system.poles()?, system, reach, linear, oscillation, assumed })
    }
}

/// The angular frequency in rad/s at which the model swings.
fn oscillation(linear: &Linearization) -> Result<f64, Failure> {
    let poles = linear.minimal().poles()?;
    let slowest = poles.iter().filter(|pole| pole.imaginary > 0.0).min_by(|a, b| {
        let damping = |pole: &Pole| pole.damping_ratio().unwrap_or(1.0);
        damping(a).total_cmp(&damping(b))
    });
    slowest.map(|pole| pole.imaginary).ok_or_else(|| {
        Failure::input("--amplitude: the model does not swing, so no oscillation has an amplitude", "leave it out")
    })
}

/// The ending of a file's name in small letters.
fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Refuses a name whose ending does not say what to write, and a folder that cannot be written to.
fn endings(arguments: &LinearizeArguments) -> Result<(), Failure> {
    if let Some(path) = arguments.output.as_deref().filter(|path| !matches!(ending(path).as_str(), "json" | "m")) {
        let title = format!("`{}` does not say how to write the model", path.display());
        return Err(Failure::input(title, "end the name of --output with .json or .m"));
    }
    if let Some(path) = arguments.plot.clone().filter(|path| !matches!(ending(path).as_str(), "svg" | "png")) {
        let title = PlotError::Ending { path }.to_string();
        return Err(Failure::input(title, "end the name of --plot with .svg or .png"));
    }
    arguments.output.iter().chain(&arguments.plot).try_for_each(|path| output::probe(path))
}
