//! The command line.
//!
//! Mistakes in it are reported by `clap`, with exit code 2, as every other mistake in the input.

use crate::commands::check::CheckArguments;
use crate::commands::completions::CompletionsArguments;
use crate::commands::curves::CurvesArguments;
use crate::commands::design::DesignArguments;
use crate::commands::fmu::FmuArguments;
use crate::commands::gallery::GalleryArguments;
use crate::commands::identify::IdentifyArguments;
use crate::commands::init::InitArguments;
use crate::commands::keys::KeysArguments;
use crate::commands::linearize::LinearizeArguments;
use crate::commands::man::ManArguments;
use crate::commands::presets::PresetsArguments;
use crate::commands::reproduce::ReproduceArguments;
use crate::commands::schema::SchemaArguments;
use crate::commands::simulate::SimulateArguments;
use crate::commands::size::SizeArguments;
use crate::commands::sweep::SweepArguments;
use crate::terminal::HELP;
use clap::{Parser, Subcommand};
use mckibben_run::units::Units;

/// Simulate braided pneumatic actuators (McKibben muscles) from scenario files.
#[derive(Debug, Parser)]
#[command(
    name = "mckibben",
    version,
    styles = HELP,
    max_term_width = 110,
    after_help = "\
Examples:
  mckibben init muscle.toml
  mckibben simulate muscle.toml --output run.csv --plot run.svg

Exit codes:
  0  done
  2  the input is wrong: arguments, a missing file, a scenario; nothing was written
  3  the simulation could not go on; nothing was written but the report of identify
  4  the output could not be written; what was finished before stays
  129, 130, 143  stopped by SIGHUP, SIGINT, SIGTERM: what was under way was removed, what was finished stays"
)]
pub struct Arguments {
    /// Units of what is printed and written: metric, si or imperial, and units for single quantities, as in
    /// `imperial` or `pressure=psi,angle=rad`. Without it, summaries and figures are metric and files in SI.
    #[arg(long, global = true, value_name = "UNITS", long_help = units_help())]
    pub units: Option<Units>,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The help of `--units`, with the quantities that it knows.
fn units_help() -> String {
    format!(
        "Units of what is printed and written: metric, si or imperial, and units for single quantities, as in `imperial` or \
         `pressure=psi,angle=rad`, which change these quantities alone. Summaries, figures, reports and the columns of files \
         follow. Without it, summaries and \
         figures are metric and files in SI; parts of a sweep in a folder are always in SI. Quantities: {}",
        Units::names()
    )
}

/// What the program does.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario: print what it came to, write the run, draw it
    Simulate(SimulateArguments),
    /// Run a scenario many times with varied values, on all cores, into Parquet or CSV
    Sweep(SweepArguments),
    /// Check scenario files and show every mistake where it is
    Check(CheckArguments),
    /// Write a commented scenario file to start from
    Init(InitArguments),
    /// Show the named actuators and valves: values, sources, what is assumed
    Presets(PresetsArguments),
    /// Show what a key of a scenario file means: unit, range, default, source
    Keys(KeysArguments),
    /// Print the JSON Schema of scenario files, for editors
    Schema(SchemaArguments),
    /// Draw static curves of an actuator
    Curves(CurvesArguments),
    /// Find muscles, valves and hoses that move a load over a stroke
    Size(SizeArguments),
    /// Search for the best values of keys under constraints
    Design(DesignArguments),
    /// Linearise a scenario near an operating point: matrices, poles, Bode plot
    Linearize(LinearizeArguments),
    /// Find the numbers of a muscle from measured data, with their uncertainty
    Identify(IdentifyArguments),
    /// Write a functional mock-up unit (FMI 2.0 or 3.0) that other simulators run
    Fmu(FmuArguments),
    /// Reproduce the experiments of the paper
    Reproduce(ReproduceArguments),
    /// Draw every scenario file of a folder and show them on one page
    Gallery(GalleryArguments),
    /// Print a completion script for a shell
    Completions(CompletionsArguments),
    /// Print a manual page
    Man(ManArguments),
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    /// Options of numbers and quantities, whose values may begin with a minus sign.
    const NUMBERS: [&str; 3] = ["QUANTITY", "LIST", "PART"];

    /// The terminal's width breaks the lines of a paragraph: one that the source has broken as well would be torn.
    #[test]
    fn paragraphs_of_the_help_are_one_line_each() {
        for command in Arguments::command().get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let lines: Vec<&str> = help.lines().collect();
            for pair in lines.windows(2) {
                let is_prose = |line: &str| !line.is_empty() && !line.starts_with(' ');
                let is_torn = is_prose(pair[0]) && is_prose(pair[1]);
                assert!(!is_torn, "{}: {:?}", command.get_name(), pair);
            }
        }
    }

    /// A negative value comes to the message about the range of its option, which `clap` would take for another option.
    #[test]
    fn options_of_quantities_take_negative_values() {
        let mut count = 0;
        for command in Arguments::command().get_subcommands() {
            for option in command.get_arguments() {
                let is_number =
                    option.get_value_names().into_iter().flatten().any(|name| NUMBERS.contains(&name.as_str()));
                if is_number && option.get_possible_values().is_empty() {
                    let name = option.get_long().unwrap_or_default();
                    assert!(option.is_allow_hyphen_values_set(), "{} --{name}", command.get_name());
                    count += 1;
                }
            }
        }
        assert!(count >= 20, "{count} options");
    }
}
