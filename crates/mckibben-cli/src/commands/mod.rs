//! One module for each command.

pub mod check;
mod compare;
pub mod completions;
pub mod curves;
pub mod design;
pub mod fmu;
pub mod gallery;
pub mod identify;
pub mod init;
pub mod keys;
pub mod linearize;
pub mod man;
pub mod presets;
pub mod reproduce;
pub mod schema;
pub mod simulate;
pub mod size;
pub mod sweep;

use crate::arguments::Command;
use mckibben_run::failure::Failure;

/// Runs a command.
///
/// # Errors
/// Why it could not be done.
pub fn run(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Simulate(arguments) => simulate::run(arguments),
        Command::Sweep(arguments) => sweep::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Init(arguments) => init::run(arguments),
        Command::Presets(arguments) => presets::run(arguments),
        Command::Keys(arguments) => keys::run(arguments),
        Command::Schema(arguments) => schema::run(arguments),
        Command::Curves(arguments) => curves::run(arguments),
        Command::Identify(arguments) => identify::run(arguments),
        Command::Size(arguments) => size::run(arguments),
        Command::Design(arguments) => design::run(arguments),
        Command::Linearize(arguments) => linearize::run(arguments),
        Command::Fmu(arguments) => fmu::run(arguments),
        Command::Gallery(arguments) => gallery::run(arguments),
        Command::Reproduce(arguments) => reproduce::run(arguments),
        Command::Completions(arguments) => completions::run(arguments),
        Command::Man(arguments) => man::run(arguments),
    }
}
