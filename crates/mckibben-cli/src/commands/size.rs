//! `mckibben size`: which muscles move a load over a stroke, and which valves and hoses are quick enough.
//!
//! Checked by `tests/size.rs`.

use crate::files;
use crate::settings::measured;
use crate::terminal;
use mckibben_run::failure::Failure;
use mckibben_run::linearize::Measure;
use mckibben_run::output;
use mckibben_run::quantities::{given, read_share};
use mckibben_run::report::{Table, number};
use mckibben_run::size::{BraidAngles, Pulses, Requirement, Sizes, UNCHECKED, ValveTime, force_of};
use mckibben_run::units;
use std::path::PathBuf;

/// Arguments of `mckibben size`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben size --load '5 kg' --stroke '30 mm' --gauge-pressure '4 bar'
  mckibben size --load '80 N' --stroke '40 mm' --gauge-pressure '5 bar' --most-diameter '20 mm' --plot sizes.svg
  mckibben size --load '5 kg' --stroke '30 mm' --gauge-pressure '4 bar' --time '0.3 s' --hose '2 m'
  mckibben size --load '5 kg' --stroke '30 mm' --gauge-pressure '4 bar' --time '0.3 s' --scenario muscle.toml
  mckibben size --load '5 kg' --stroke '30 mm' --gauge-pressure '4 bar' --time '0.3 s' --ripple '0.2 mm'

A muscle hangs under the load at rest, at its greatest length and without pressure. Its stroke is how much shorter it \
is where it holds the load at the whole pressure. Friction is left out. A braid that is made to measure is the ideal \
one unless --effectiveness says how much of its force a real one has. With --time the valve opens at once and the load \
is lifted from rest; the time is that of nine tenths of the stroke. With --ripple the valve is pulsed in the middle of \
the stroke, at the duty whose mean flow holds the load there; the ripple is that of the linear model. The scenario that \
is written then starts there. A named valve is too slow where its delays are longer than the pulses.")]
pub struct SizeArguments {
    /// What is moved: a mass that hangs, such as `5 kg`, or a force, such as `40 N`.
    #[arg(long, value_name = "QUANTITY", value_parser = Measure::read, allow_hyphen_values = true)]
    pub load: Measure,
    /// How far, such as `30 mm`.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("length", "m", "30 mm"), allow_hyphen_values = true)]
    pub stroke: f64,
    /// The gauge pressure that there is, such as `4 bar`.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("pressure", "Pa", "4 bar"), allow_hyphen_values = true)]
    pub gauge_pressure: f64,
    /// Braid angles at rest of the braids that are made to measure, as in `20,25,30` or `0.4,0.5rad`; without a unit in degrees.
    #[arg(long, value_name = "LIST", default_value = "15,20,25,30,35", allow_hyphen_values = true)]
    pub braid_angles: BraidAngles,
    /// Force over that of the ideal braid, of the braids that are made to measure, such as `0.8` or `80%`.
    #[arg(long, value_name = "PART", value_parser = read_share, default_value = "1", allow_hyphen_values = true)]
    pub effectiveness: f64,
    /// The greatest length that a muscle may have at rest.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("length", "m", "30 mm"), allow_hyphen_values = true)]
    pub most_length: Option<f64>,
    /// The greatest diameter that a braid may have at rest.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("length", "m", "30 mm"), allow_hyphen_values = true)]
    pub most_diameter: Option<f64>,
    /// Within which time nine tenths of the stroke are to be done: the valve follows.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("time", "s", "0.3 s"), allow_hyphen_values = true)]
    pub time: Option<f64>,
    /// How much pulses may make the length swing in the middle of the stroke, peak to peak: their frequency follows.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("length", "m", "0.2 mm"), requires = "time", allow_hyphen_values = true)]
    pub ripple: Option<f64>,
    /// The length of the hose from the valve: its diameter follows.
    #[arg(long, value_name = "QUANTITY", value_parser = measured("length", "m", "30 mm"), requires = "time", allow_hyphen_values = true)]
    pub hose: Option<f64>,
    /// For which candidate valves and hoses are listed and the scenario is written, by its place in the table.
    #[arg(long, value_name = "PLACE", default_value_t = 1, allow_negative_numbers = true)]
    pub pick: usize,
    /// Write the candidates as a table: .csv.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the forces over the shortening: .svg, .png, .pdf, or .html for a page to zoom in.
    #[arg(short, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a scenario file of the muscle that is picked: .toml.
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
}

/// Looks for muscles and shows them.
///
/// # Errors
/// The input is wrong, nothing does it, or a file could not be written.
pub fn run(arguments: &SizeArguments) -> Result<(), Failure> {
    let ending = |path: &Option<PathBuf>, option, ending| {
        path.as_deref().map(|path| files::ending(path, option, &[ending]).map(|_| ())).transpose()
    };
    ending(&arguments.output, "--output", "csv")?;
    ending(&arguments.scenario, "--scenario", "toml")?;
    let plot = files::figure(arguments.plot.as_deref())?;
    let requirement = Requirement {
        load: force_of(arguments.load),
        stroke: arguments.stroke,
        gauge_pressure: arguments.gauge_pressure,
        braid_angles: arguments.braid_angles.0.clone(),
        effectiveness: arguments.effectiveness,
        most_length: arguments.most_length,
        most_diameter: arguments.most_diameter,
        time: arguments.time,
        ripple: arguments.ripple,
    };
    let sizes = Sizes::of(requirement, UNCHECKED)?;
    let pick = arguments.pick.wrapping_sub(1);
    let scenario = sizes.scenario(pick)?;
    let without_valve = sizes.without_valve(pick)?;
    if let Some(why) = without_valve.as_ref().filter(|_| arguments.scenario.is_some()) {
        let help = "choose another muscle by --pick or allow more --time; without --time the file has no valve";
        return Err(Failure::input(format!("--scenario: {why}"), help));
    }
    let mut text = format!("{}\n", sizes.table().to_text_with_caption());
    for words in &sizes.left_out {
        text.push_str(&terminal::wrap(&format!("Left out: {words}."), ""));
        text.push('\n');
    }
    if arguments.time.is_some() {
        let named = valves(&sizes, pick)?;
        match without_valve.filter(|_| named.rows.is_empty()) {
            Some(why) => text.push_str(&format!("\n{}\n", terminal::wrap(&format!("No named valve: {why}."), ""))),
            None => text.push_str(&format!("\n{}\n", named.to_text_with_caption())),
        }
    }
    if let Some(length) = arguments.hose {
        text.push_str(&format!("\n{}\n", hoses(&sizes, pick, length)?.to_text_with_caption()));
    }
    if let Some(path) = &arguments.output {
        output::write(path, &sizes.data()?.to_csv(path)?)?;
        text.push_str(&terminal::wrote(path, ""));
    }
    if let Some((path, format)) = plot {
        let bytes = units::drawn(sizes.figure()).bytes(format).map_err(|error| Failure::output(path, error))?;
        output::write(path, &bytes)?;
        text.push_str(&terminal::wrote(path, ""));
    }
    if let Some(path) = &arguments.scenario {
        output::write(path, scenario.as_bytes())?;
        text.push_str(&terminal::wrote(path, ""));
    }
    terminal::print(&text)
}

/// How quick valves that can be bought are.
fn valves(sizes: &Sizes, pick: usize) -> Result<Table, Failure> {
    let is_pulsed = sizes.requirement().ripple.is_some();
    let row = |its: ValveTime| {
        let mut row = vec![its.name.to_owned(), its.time.map_or("longer".to_owned(), |time| number(1e3 * time, 1))];
        if is_pulsed {
            row.extend(match its.pulses {
                Some(Pulses { frequency, duty, follows: true, .. }) => [number(frequency, 1), number(duty, 3)],
                _ => ["too slow", "–"].map(String::from),
            });
        }
        row
    };
    let more: &[&str] = if is_pulsed { &["PWM Hz", "duty"] } else { &[] };
    Ok(Table {
        caption: format!("Named valves, one on each muscle of place {}:", pick + 1),
        head: ["valve", "time ms"].iter().chain(more).map(|head| (*head).to_owned()).collect(),
        rows: sizes.valves(pick, UNCHECKED)?.into_iter().map(row).collect(),
    })
}

/// What hoses of a length in m require of the valve.
fn hoses(sizes: &Sizes, pick: usize, length: f64) -> Result<Table, Failure> {
    let row = |its: mckibben_run::size::Hose| vec![number(1e3 * its.diameter, 1), its.quickness.words()];
    Ok(Table {
        caption: format!("Behind a hose of {} the valve must let through, at place {}:", given(length, "m"), pick + 1),
        head: ["hose, inner diameter mm", "valve C L/(min·bar)"].map(String::from).to_vec(),
        rows: sizes.hoses(pick, length, UNCHECKED)?.into_iter().map(row).collect(),
    })
}
