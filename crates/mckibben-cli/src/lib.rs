//! The program `mckibben`, as a library so that its parts are tested.
//!
//! | module | what it holds |
//! |---|---|
//! | [`arguments`] | the command line |
//! | [`commands`] | one module for each command |
//! | [`settings`] | values of the scenario from the command line |
//! | [`finished`] | whatever a scenario describes, run |
//! | [`engine`], [`closed_loop`] | a run by the engine that the scenario names, and a controller's part in it |
//! | [`observation`] | the figures of a run |
//! | [`summary`], [`describe`], [`events`] | a run in words |
//! | [`record`] | a run as columns, as CSV or Parquet |
//! | [`joint`] | the same for a joint of two actuators |
//! | [`portrait`], [`plot`] | a run as a figure, and figures in general |
//! | [`sweep`] | many runs of one scenario |
//! | [`output`] | files that are whole or not there |
//! | [`temporary`], [`interrupt`] | files under way, and what becomes of them when the program is stopped |
//! | [`terminal`], [`progress`], [`quantities`] | words, bars and numbers for people |
//! | [`failure`] | why a command failed, and the exit code that says so |

#![forbid(unsafe_code)]

pub(crate) mod alone;
pub mod arguments;
pub mod closed_loop;
pub mod commands;
pub mod describe;
pub mod engine;
pub mod events;
pub mod failure;
pub mod finished;
pub mod interrupt;
pub mod joint;
pub mod observation;
pub mod output;
pub mod plant;
pub mod plot;
pub mod portrait;
pub mod progress;
pub mod quantities;
pub mod record;
pub mod report;
pub mod settings;
pub mod summary;
pub mod sweep;
pub mod temporary;
pub mod terminal;

use clap::Parser as _;
use std::process::ExitCode;

/// Runs the program on the process's arguments; the exit code is that of [`failure`].
pub fn run() -> ExitCode {
    let arguments = arguments::Arguments::parse();
    interrupt::listen();
    match commands::run(&arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let failure = match output::stays(temporary::finished()) {
                None => failure,
                Some(stays) => failure.staying(|| stays),
            };
            failure.print();
            ExitCode::from(failure.code())
        }
    }
}
