//! The program `mckibben`, as a library so that its parts are tested.
//!
//! | module | what it holds |
//! |---|---|
//! | [`arguments`] | the command line |
//! | [`commands`] | one module for each command |
//! | [`settings`] | values of the scenario from the command line |
//! | [`summary`], [`describe`], `events` | a run in words |
//! | `files`, `warnings` | files that options name; warnings and `--strict` |
//! | [`interrupt`] | what becomes of files when the program is stopped |
//! | [`terminal`], [`progress`] | words and bars for people |
//!
//! What the commands do is done by [`mckibben_run`].

#![forbid(unsafe_code)]

pub mod arguments;
pub mod commands;
pub mod describe;
mod events;
mod files;
pub mod interrupt;
pub mod progress;
pub mod settings;
pub mod summary;
pub mod terminal;
mod warnings;

use clap::Parser as _;
use mckibben_run::{output, progress as work, units};
use mckibben_scenario::Style;
use std::process::ExitCode;
use std::sync::Arc;

/// Runs the program on the process's arguments; the exit code is that of [`mckibben_run::failure`].
pub fn run() -> ExitCode {
    let arguments = arguments::Arguments::parse();
    if let Some(units) = &arguments.units {
        units::choose(units.clone());
    }
    interrupt::listen();
    match work::with_listener(Arc::new(progress::Bars), || commands::run(&arguments.command)) {
        Ok(()) => interrupt::code().map_or(ExitCode::SUCCESS, ExitCode::from),
        Err(failure) => {
            let failure = match interrupt::stays(output::finished()) {
                None => failure,
                Some(stays) => failure.staying(|| stays),
            };
            terminal::print_error(&format!("{}\n", failure.render(Style::Coloured)));
            ExitCode::from(interrupt::code().unwrap_or(failure.code()))
        }
    }
}
