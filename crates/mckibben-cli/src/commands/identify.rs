//! `mckibben identify`: from measured data to a scenario file that runs, with how sure its numbers are.
//!
//! Everything is done by [`mckibben_run::identify`]. Ctrl-C ends a search with the best values so far, which are written. Checked by
//! `tests/identify.rs`, `tests/identify_valve.rs` and `tests/identify_ends.rs`.

use crate::{interrupt, terminal};
use mckibben_run::failure::Failure;
use mckibben_run::identify::{Monitor, Outcome, Request, WARNED, identified};
use std::path::PathBuf;

/// Arguments of `mckibben identify`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben identify study.toml
  mckibben identify study.toml --output muscle-7
  mckibben identify validation/martens-boblan-2017/dmsp-20-300-study.toml

A study file:
  [study]
  kind = \"force-map\"                      # or \"hysteresis\", \"ring-down\", \"trajectories\", and of a valve
                                          # \"flow-curve\", \"steady-flow\", \"tank\", \"pulse-train\"
  scenario = \"muscle.toml\"                # the muscle and the rig as far as they are known
  input = \"gauge-pressure\"                # of trajectories: driven by the measured pressure, whatever made it;
                                          # of a plant the actuators whose pressure was measured

  [columns.gauge_pressure]                # also length, tension, time, absolute_pressure; of a joint angle,
                                          # angular_velocity, torque, and antagonist_length and the like; of a
                                          # part of a plant [columns.\"flexor.length\"], [columns.\"knee.angle\"]
  name = \"P_bar\"
  unit = \"bar\"
  [columns.length]
  name = \"L_mm\"
  unit = \"mm\"
  [columns.tension]
  name = \"F\"
  unit = \"N\"
  slack = \"0 N\"                           # at or below this no tension was held

  [[run]]
  file = \"data.csv\"                       # .csv or .parquet
  set = { \"load.mass\" = \"5 lb\" }          # keys of the scenario that differ in this run

  [fit.\"actuator.friction.viscous\"]       # of trajectories: what is looked for, by the path that --set takes;
                                          # of a plant also \"actuators.flexor.turns\", \"mechanism.joints.knee.damping\"
  from = \"0 N*s/m\"
  to = \"50 N*s/m\"
  per_run = true                          # each run has a value of its own

  [search]                                # of trajectories, hysteresis and force maps
  more_starts = 8                         # searches from so many more starts; of trajectories unless given from 2 of 16
  most_steps = 500                        # after which a search ends with the best values so far
  time_limit = \"600 s\"                    # likewise; Ctrl-C does so at once

Of a valve:
  kind = \"flow-curve\" finds C and b of ISO 6358, \"steady-flow\" the efficiency, from the columns upstream_absolute_pressure, \
  downstream_absolute_pressure (or _gauge_pressure), temperature, and mass_flow or volume_flow (\"L/min ANR\")
  [flow]
  scatter = \"constant\"                    # of the flow: the same for all readings, or \"proportional\" to each
  flow_path = \"supply\"                      # the one that was measured, or \"exhaust\"
  area = \"3 mm^2\"                         # of \"steady-flow\": the flow coefficient of this area in place of the efficiency

  kind = \"tank\" finds C and b, or a volume, from absolute_pressure (or gauge_pressure) over time
  [tank]
  find = \"valve\"                          # or \"volume\"
  transfer = \"discharge\"                  # to the atmosphere, or \"charge\" from the scenario's supply
  volume = \"0.5 L\"                        # line included; where it is estimated, a guess
  temperature = \"20 degC\"                 # of air and wall at the start; begins, ends, heat, windows, length: docs/identify.md

  kind = \"pulse-train\" finds the delays from such pressures; the edges are those of [columns.command] or of the scenario's PWM
  [pulses]
  begins = \"0 s\"                          # the first pulse of that PWM
  threshold = 2.5                         # of that column

Exit codes:
  0  done
  2  the input is wrong: arguments, the study, its data or scenario; nothing was written
  3  no fit was found, or not of every run; the report has what there is, and says what failed
  4  a file could not be written; files that were finished before stay
  130  the search was interrupted (Ctrl-C); the best values so far are written")]
pub struct IdentifyArguments {
    /// The study file: what was measured, and what is to be found.
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    /// The folder for the report, the scenario and the numbers; it is made if it is not there.
    #[arg(short, long, value_name = "DIR", default_value = "identified")]
    pub output: PathBuf,
}

/// Fits the unknowns of the study and writes the estimates.
///
/// # Errors
/// The input is wrong, something failed, or a file could not be written.
pub fn run(arguments: &IdentifyArguments) -> Result<(), Failure> {
    let monitor = Monitor::default();
    let request = Request::load(&arguments.study)?.followed_by(monitor.clone());
    let ending = request.ends_at_any_time().then(|| interrupt::ending(move || monitor.stop()));
    let outcome = identified(request, Some(&arguments.output))?;
    drop(ending);
    let page = outcome.write(&arguments.output)?;
    terminal::print(&format!("{}\n{}", report_text(&outcome), terminal::wrote(&page, "")))?;
    outcome.verdict(Some(&page))
}

/// What was found, for the terminal.
fn report_text(outcome: &Outcome) -> String {
    let wide = terminal::width();
    let mut text = String::new();
    for paragraph in &outcome.introduction {
        text.push_str(&format!("{}\n", terminal::wrap(&paragraph.replace('`', ""), "")));
    }
    for table in [&outcome.table, &outcome.responses, &outcome.values] {
        if !table.head.is_empty() {
            let caption = terminal::wrap(&table.caption, "");
            text.push_str(&format!("\n{caption}\n\n{}", table.to_text_within(wide)).replace('`', ""));
        }
    }
    if !outcome.warnings.is_empty() {
        text.push('\n');
    }
    for warning in &outcome.warnings {
        let (mark, words) = match warning.strip_prefix(WARNED) {
            Some(words) => (terminal::styled(terminal::NOTABLE, "!"), words),
            None => (" ".to_owned(), warning.as_str()),
        };
        let words = terminal::wrap(&words.replace('`', ""), "  ");
        text.push_str(&format!("{mark} {}\n", words.trim_start()));
    }
    text
}
