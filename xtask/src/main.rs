//! `cargo xtask test`: the whole check, the same on a laptop and in CI.
//!
//! It sets up what it needs: a Python environment in `.venv` with SciPy, from which the independent reference
//! trajectories are computed, and with the package that is built and tested in it; on Debian and Ubuntu, compilers and Valgrind for
//! the C library; and for the book mdBook, in `target`. Nothing is skipped because something is missing.

mod book;
mod c;
mod counts;
mod dist;
mod figures;
mod fmi_sim;
mod python;
mod steps;
mod tools;
mod words;

use std::process::ExitCode;

const HELP: &str = "\
usage: cargo xtask test [STEP...]
       cargo xtask accuracy
       cargo xtask figures [WORD...]
       cargo xtask rows [COUNT]
       cargo xtask fmi-sim
       cargo xtask dist

test      runs every check, or only the named ones: format, lint, docs, no-std, reference, test,
          package, python, book.
accuracy  measures the fixed-step engine against the event-located one and writes docs/accuracy.md and its figure.
figures   draws the figures of the pages again, each by the command under it; or those whose names contain a word.
rows      steps COUNT random rows in batches, ten million unless given: each goes on or says why not (ten minutes).
fmi-sim   runs functional mock-up units in the importer fmi-sim, which it builds (five minutes).
dist      makes what a release carries, in target/release-files, and tries it: the program and the C library in an archive,
          a wheel, its source, checksums (ten minutes).
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        Some((command, chosen)) if command == "test" => steps::run(chosen),
        Some((command, [])) if command == "accuracy" => steps::accuracy(),
        Some((command, words)) if command == "figures" => figures::figures(words),
        Some((command, rest)) if command == "rows" && rest.len() < 2 => steps::rows(rest.first()),
        Some((command, [])) if command == "fmi-sim" => fmi_sim::fmi_sim(),
        Some((command, [])) if command == "dist" => dist::run(),
        _ => {
            eprint!("{HELP}");
            ExitCode::from(2)
        }
    }
}
