//! `mckibben linearize`: a scenario near an operating point, as matrices, poles and a Bode plot.
//!
//! Everything is done by [`mckibben_run::linearize`]. Checked by `tests/linearize.rs`.

use crate::files;
use crate::settings::{Setting, measured};
use crate::terminal::{self, HEADING, NOTABLE, styled};
use mckibben_run::failure::Failure;
use mckibben_run::linearize::{Account, Line, LinearModel, Measure, Request};
use mckibben_run::output::{self, Pending};
use mckibben_run::quantities::read_share;
use std::path::PathBuf;

/// Arguments of `mckibben linearize`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben linearize muscle.toml
  mckibben linearize muscle.toml --gauge-pressure '60 psi' --output model.m
  mckibben linearize muscle.toml --length '85 mm' --load '10 lb' --output model.json
  mckibben linearize muscle.toml --duty 0.4 --plot bode.svg
  mckibben linearize muscle.toml --gauge-pressure '50 psi' --pwm

The point:
  Two of --gauge-pressure, --length and --load give the third; what is not given is that of the scenario.
  --duty gives the pressure by the valve's mean flow; so does the scenario's own PWM when neither --gauge-pressure nor \
  --length is given, and the last set point of a regulator or the last position of a spool. With --pwm the command \
  follows from the pressure. Otherwise the valve is held shut, and the mass flow into the actuator is the input.
  Of a file of many actuators pulsed and proportional valves are taken by their commands; where there are none, or with \
  controllers, all valves are held shut at the initial pressures. With --pwm the commands are those that hold these.

Exit codes:
  0  done
  2  the input is wrong: arguments, a missing file, the scenario, no such point; nothing was written
  4  a file could not be written; nothing was left behind")]
pub struct LinearizeArguments {
    /// The scenario file, or - for standard input; `mckibben init` writes one to start from.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Gauge pressure at the point, such as `60 psi`.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("pressure", "Pa", "60 psi"), allow_hyphen_values = true)]
    pub gauge_pressure: Option<f64>,
    /// Distance between the attachments at the point, such as `85 mm`.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("length", "m", "85 mm"), allow_hyphen_values = true)]
    pub length: Option<f64>,
    /// The load: a mass that hangs, such as `10 lb`, or a force, such as `40 N`.
    #[arg(long, value_name = "QUANTITY", value_parser = Measure::read, allow_hyphen_values = true)]
    pub load: Option<Measure>,
    /// Commanded duty at the point, such as `0.4` or `40%`: the valve by its mean flow under PWM.
    #[arg(long, value_name = "PART", value_parser = read_share, conflicts_with = "gauge_pressure", allow_hyphen_values = true)]
    pub duty: Option<f64>,
    /// The valve by its mean flow under PWM, at the duty that holds the pressure.
    #[arg(long, conflicts_with = "duty")]
    pub pwm: bool,
    /// Temperature of the air at the point; else the scenario's air, brought there by its process.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("temperature", "K", "293 K"), allow_hyphen_values = true)]
    pub temperature: Option<f64>,
    /// Angle of a joint at the point, such as `20 deg`.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("angle", "rad", "20 deg"), allow_hyphen_values = true, requires = "stiffness")]
    pub angle: Option<f64>,
    /// Stiffness that the two actuators give a joint at that angle, such as `2 N*m/rad`; the pressures follow.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("stiffness of a joint", "N*m/rad", "2 N*m/rad"), requires = "angle", allow_hyphen_values = true)]
    pub stiffness: Option<f64>,
    /// Replace Coulomb friction by the viscous damping that takes as much from an oscillation of this amplitude.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("length", "m", "85 mm"), allow_hyphen_values = true)]
    pub amplitude: Option<f64>,
    /// Keep the air mass as a state where it follows from the others; its pole is zero.
    #[arg(long)]
    pub all_states: bool,
    /// Write the model: .json, or .m for MATLAB and Octave.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the frequency response: .svg, .png, .pdf, or .html for a page to zoom in.
    #[arg(short, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// The input of the figure: duty, mass_flow or force, of a joint agonist_duty and so on; the valve's unless given.
    #[arg(long, value_name = "INPUT", requires = "plot")]
    pub input: Option<String>,
    /// Set a value of the scenario, such as `actuator.turns=2.2`; can be given again.
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
}

/// Linearises the scenario.
///
/// # Errors
/// The input is wrong, there is no such point, or a file could not be written.
pub fn run(arguments: &LinearizeArguments) -> Result<(), Failure> {
    let of_model = |path| Ok::<_, Failure>((path, files::ending(path, "--output", &["json", "m"])?));
    let model = arguments.output.as_deref().map(of_model).transpose()?;
    let plot = files::figure(arguments.plot.as_deref())?;
    arguments.output.iter().chain(&arguments.plot).try_for_each(|path| output::probe(path))?;
    let mut document = files::document(&arguments.file)?;
    arguments.set.iter().try_for_each(|setting| setting.apply(&mut document))?;
    let found = LinearModel::of(document.source().name(), &document, &arguments.request())?;
    let mut pending = Vec::new();
    if let Some((path, ending)) = &model {
        let text = if ending == "json" { found.json() } else { found.matlab() };
        pending.push(files::pending(path, text.as_bytes())?);
    }
    if let Some((path, format)) = plot {
        let figure = found.figure(arguments.input.as_deref())?;
        let bytes = figure.bytes(format).map_err(|error| Failure::output(path, error))?;
        pending.push(files::pending(path, &bytes)?);
    }
    // Each takes its name when all are complete.
    pending.into_iter().try_for_each(Pending::commit)?;
    let mut text = report_text(&found.account());
    for path in arguments.output.iter().chain(&arguments.plot) {
        text.push_str(&terminal::wrote(path, ""));
    }
    terminal::print(&text)
}

impl LinearizeArguments {
    /// The requested point and model.
    fn request(&self) -> Request {
        Request {
            gauge_pressure: self.gauge_pressure,
            length: self.length,
            load: self.load,
            duty: self.duty,
            pwm: self.pwm,
            temperature: self.temperature,
            angle: self.angle,
            stiffness: self.stiffness,
            amplitude: self.amplitude,
            all_states: self.all_states,
        }
    }
}

/// The model as text for people.
fn report_text(account: &Account) -> String {
    let mut text = format!("{}\n", styled(HEADING, &account.title));
    for block in &account.blocks {
        if !block.heading.is_empty() {
            text.push_str(&format!("\n{}", styled(HEADING, &block.heading)));
            let caption = &block.table.caption;
            text.push_str(&if caption.is_empty() { "\n".to_owned() } else { format!("  {caption}\n") });
        }
        block.lines.iter().for_each(|line| text.push_str(&report_line(line)));
        text.push_str(&block.table.to_text_unconverted());
    }
    for note in &account.notes {
        text.push_str(&format!("\n{}\n", terminal::wrap(note, "")));
    }
    text
}

/// A name in a column, and what it is.
fn report_line(Line { name, value, warning }: &Line) -> String {
    let warning = if warning.is_empty() { String::new() } else { format!("; {}", styled(NOTABLE, warning)) };
    terminal::entry(name, 16, &format!("{value}{warning}"))
}
