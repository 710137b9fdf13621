//! The figures of the documentation, drawn again: each by the command that stands under it on its page.
//!
//! A command is what a page shows between backticks, or on a line of its own, that begins with `mckibben` and draws a file of
//! `docs/`. Figures that need more than one command (the schematic, measured data, the leg's sticks) are named by their pages.

use crate::steps::{cargo, command, root, succeed};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

/// Draws all figures, or those whose names contain one of some words.
pub(crate) fn figures(words: &[String]) -> ExitCode {
    match drawn(&root(), words) {
        Ok(count) => {
            println!("{count} figures: look at them before they are committed");
            ExitCode::SUCCESS
        }
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

fn drawn(root: &Path, words: &[String]) -> Result<usize, String> {
    let all = commands(root)?;
    let chosen = || all.iter().filter(|(figure, _)| words.is_empty() || words.iter().any(|word| figure.contains(word)));
    succeed(cargo(root).args(["build", "--release", "--locked", "--package", "mckibben-cli"]))?;
    // What else a command writes stays here.
    let folder = root.join("target/figures");
    crate::dist::empty(&folder)?;
    for shared in ["docs", "examples"] {
        link(&root.join(shared), &folder.join(shared))?;
    }
    let programs = std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).collect::<Vec<_>>();
    let path = std::env::join_paths(std::iter::once(root.join("target/release")).chain(programs));
    let path = path.map_err(|error| format!("PATH: {error}"))?;
    for (figure, line) in chosen() {
        println!("docs/{figure}");
        let mut drawing = command(root, "sh");
        drawing.args(["-c", line]).current_dir(&folder).env("PATH", &path);
        // The summaries of the runs are not of interest.
        succeed(drawing.stdout(std::process::Stdio::null()))?;
    }
    Ok(chosen().count())
}

#[cfg(unix)]
fn link(from: &Path, to: &Path) -> Result<(), String> {
    std::os::unix::fs::symlink(from, to).map_err(|error| format!("{}: {error}", to.display()))
}

#[cfg(not(unix))]
fn link(_: &Path, to: &Path) -> Result<(), String> {
    Err(format!("{}: figures are drawn where there are symbolic links", to.display()))
}

/// The command of each figure by the name of its file.
fn commands(root: &Path) -> Result<BTreeMap<String, String>, String> {
    let docs = root.join("docs");
    let listed = fs::read_dir(&docs).map_err(|error| format!("{}: {error}", docs.display()))?;
    let pages = listed.filter_map(|entry| Some(entry.ok()?.path())).chain([root.join("README.md")]);
    let mut found = BTreeMap::new();
    for page in pages.filter(|path| path.extension().is_some_and(|its| its == "md")) {
        let text = fs::read_to_string(&page).map_err(|error| format!("{}: {error}", page.display()))?;
        found.extend(shown(&text));
    }
    Ok(found)
}

/// The commands that a page shows, by the names of their figures.
fn shown(page: &str) -> Vec<(String, String)> {
    let between_backticks =
        page.split('`').skip(1).step_by(2).map(|span| span.split_whitespace().collect::<Vec<_>>().join(" "));
    // A line that ends with a backslash goes on in the next.
    let page = page.replace("\\\n", " ");
    let lines = page.lines().map(|line| line.split('#').next().unwrap_or_default());
    let lines = lines.map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "));
    let of = |command: String| {
        let figure = command.split_once("--plot docs/")?.1.split_whitespace().next()?.to_owned();
        command.starts_with("mckibben ").then_some((figure, command))
    };
    between_backticks.chain(lines).filter(|command| !command.contains('`')).filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_stand_between_backticks_or_on_lines_of_their_own() {
        let page = "![A](a.svg)\n\n*`mckibben simulate a.toml\n--plot docs/a.svg`: what it shows*\n\n    mckibben sweep b.toml \\\n        --plot docs/b.svg # all\n\n\
                    `mckibben simulate c.toml --plot run.svg`\n";
        let found: Vec<(String, String)> = shown(page);
        let expected = [
            ("a.svg", "mckibben simulate a.toml --plot docs/a.svg"),
            ("b.svg", "mckibben sweep b.toml --plot docs/b.svg"),
        ];
        assert_eq!(found, expected.map(|(figure, command)| (figure.to_owned(), command.to_owned())));
    }
}
