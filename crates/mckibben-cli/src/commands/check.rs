//! `mckibben check`: reads scenario files and builds what they describe, without simulating.

use crate::describe;
use crate::engine;
use crate::failure::Failure;
use crate::quantities::{count, given};
use crate::terminal::{self, GOOD, styled};
use mckibben_scenario::{Diagnostics, Document, Style};
use std::path::{Path, PathBuf};

/// What `mckibben check` is asked.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben check muscle.toml
  mckibben check scenarios/*.toml

Exit codes: 0 every file is good; 2 at least one is not.")]
pub struct CheckArguments {
    /// The scenario files.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
}

/// Checks the files, all of them, whatever is found.
///
/// # Errors
/// [`Failure::input`] when one of the files is wrong; what is wrong has then been printed.
pub fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let (mut wrong, mut mistakes) = (0, 0);
    for path in &arguments.files {
        match check(path) {
            Ok(told) => terminal::print(&format!("{} {}: {told}\n", styled(GOOD, "ok"), path.display()))?,
            Err(found) => {
                wrong += 1;
                mistakes += found.count();
                terminal::print_error(&format!("{}\n\n", found.render(Style::Coloured)));
            }
        }
    }
    if wrong == 0 {
        return Ok(());
    }
    let files = arguments.files.len();
    let of_how_many =
        if files == 1 { "the file is wrong".to_owned() } else { format!("{wrong} of {files} files wrong") };
    Err(Failure::input(format!("{of_how_many}, {}", plural(mistakes)), "mend what is shown above and check again"))
}

/// Reads a file and builds the experiment; a few words about it.
fn check(path: &Path) -> Result<String, Diagnostics> {
    let document = Document::load(path)?;
    let scenario = document.scenario()?;
    let experiment = document.experiment()?;
    let (load, drive) = (describe::load(&scenario.load), describe::drive(&scenario));
    let (duration, rows) = (given(scenario.run.duration, "s"), count(engine::rows(&experiment)));
    Ok(format!("{load}; {drive}; {duration}, {rows} samples"))
}

fn plural(mistakes: usize) -> String {
    if mistakes == 1 { "one mistake".to_owned() } else { format!("{mistakes} mistakes") }
}
