//! The figure of a scenario file: that of its sweep, its static curves, its linear model or its run.

use crate::commands::sweep;
use mckibben::load::Load;
use mckibben_plot::Theme;
use mckibben_run::axis::{CurveAxis, TrajectoryAxis};
use mckibben_run::curves::Curves;
use mckibben_run::failure::Failure;
use mckibben_run::linearize::{LinearModel, Request};
use mckibben_run::run::{Finished, Ready};
use mckibben_run::settle::End;
use mckibben_run::sweep::prepared::Prepared;
use mckibben_scenario::{Document, Record};
use std::path::Path;

/// Runs of a sweep above which it is left to `mckibben sweep`.
const RUNS: u64 = 100;

/// A figure, and how to make it without this page.
pub(super) struct Picture {
    /// The figure.
    pub(super) svg: String,
    /// The command that draws it.
    pub(super) command: String,
    /// What else is to be said; empty for nothing.
    pub(super) note: String,
}

/// The figure of the scenario `file`, which holds `text`.
pub(super) fn of(file: &Path, text: &str) -> Result<Picture, Failure> {
    let document = Document::load(file)?;
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let picture = |svg: Result<String, _>, what: &str, options: &str| {
        let svg = svg.map_err(Failure::from)?;
        let command = format!("mckibben {what} {} --plot {stem}.svg{options}", file.display());
        Ok(Picture { svg, command, note: String::new() })
    };
    let mut note = String::new();
    if let Some(prepared) = Prepared::of(&document, &[])? {
        let rows = prepared.plan().rows;
        match prepared.sweep().record() {
            Record::Reductions(_) | Record::PlantReductions(_) if rows <= RUNS => {
                return picture(sweep::svg(&prepared, Theme::Auto)?, "sweep", "");
            }
            _ => note = format!("One run; mckibben sweep {} does the {rows} of its sweep.", file.display()),
        }
    }
    match first_command(text) {
        Some("curves") => {
            let figure = Curves::of(&document, None)?.figure(CurveAxis::Length);
            return picture(figure.to_svg(Theme::Auto), "curves", "");
        }
        Some("linearize") => {
            let model = LinearModel::of(&file.display().to_string(), &document, &Request::default())?;
            return picture(model.figure(None)?.to_svg(Theme::Auto), "linearize", "");
        }
        _ => {}
    }
    let (finished, _) = Ready::of(&document)?.run(&document, End::Duration, &mut |_| Ok(()))?;
    // A given motion is not worth a curve; what it costs in force is.
    let (over, options) = match &finished {
        Finished::Actuator(of) if of.control.is_none() && matches!(of.trajectory.rig().load(), Load::Prescribed(_)) => {
            (TrajectoryAxis::Length, " --over length")
        }
        _ => (TrajectoryAxis::Time, ""),
    };
    let figure = finished.figure(over, "")?;
    Ok(Picture { note, ..picture(figure.to_svg(Theme::Auto), "simulate", options)? })
}

/// The first command of this program that the comments of a file name.
fn first_command(text: &str) -> Option<&str> {
    let comments = text.lines().map_while(|line| line.strip_prefix('#'));
    let mut commands = comments.filter_map(|comment| comment.split_once("mckibben ")).map(|(_, after)| after);
    commands.next()?.split_whitespace().next()
}

#[cfg(test)]
mod tests {
    use super::first_command;

    #[test]
    fn the_comments_at_the_head_name_the_command() {
        assert_eq!(first_command("# `mckibben curves a.toml` draws\n#  mckibben simulate a.toml\n"), Some("curves"));
        assert_eq!(first_command("# Words.\n\n[run]\n# mckibben curves a.toml\n"), None);
    }
}
