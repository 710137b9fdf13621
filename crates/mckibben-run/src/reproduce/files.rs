//! The paper's scenario files: the ones of `examples/paper`, in the library so that it works anywhere.

use crate::failure::Failure;
use mckibben::plant::RigTrajectory;
use mckibben::simulation::simulate;
use mckibben_scenario::{Document, Experiment};
use std::borrow::Cow;

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        /// Every file, as (name, text).
        pub(super) const FILES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../paper/", $name)))),*];
    };
}

files![
    "fig-03.toml",
    "fig-04-45psi.toml",
    "fig-04-60psi.toml",
    "fig-04-75psi.toml",
    "fig-04-90psi.toml",
    "fig-06-60psi.toml",
    "fig-06-90psi.toml",
    "fig-08.toml",
    "fig-09.toml",
    "fig-10.toml",
    "fig-11.toml",
    "fig-11-50hz.toml",
    "fig-12.toml",
    "fig-12-50hz.toml",
    "fig-13.toml",
    "fig-13-50hz.toml",
];

/// A file by its name.
fn file(name: &str) -> Result<(&'static str, &'static str), Failure> {
    let known = FILES.iter().find(|(known, _)| *known == name).copied();
    known.ok_or_else(|| Failure::stopped(format!("there is no scenario file `{name}`")))
}

/// The value as a report shows it.
pub(super) fn shown(name: &str) -> Result<(Cow<'static, str>, Cow<'static, str>), Failure> {
    file(name).map(|(name, text)| (name.into(), text.into()))
}

/// A parsed file.
pub(super) fn document(name: &str) -> Result<Document, Failure> {
    let (name, text) = file(name)?;
    Ok(Document::parse(text, &format!("examples/paper/{name}"))?)
}

/// What a file describes, ready to run.
pub(super) fn experiment(name: &str) -> Result<Experiment, Failure> {
    Ok(document(name)?.experiment()?)
}

/// Runs an experiment with every event located.
pub(super) fn run(experiment: &Experiment) -> Result<RigTrajectory, Failure> {
    let run = &experiment.run;
    simulate(&experiment.rig, experiment.start, run.duration, run.relative_tolerance).map_err(stopped)
}

/// The core's refusal as a failure of the program.
pub(super) fn stopped(error: mckibben::Error) -> Failure {
    Failure::stopped(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_holds_every_file_of_the_folder_and_each_can_be_run() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/paper");
        let mut there: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.ends_with(".toml"))
            .collect();
        there.sort();
        let mut here: Vec<&str> = FILES.iter().map(|(name, _)| *name).collect();
        here.sort_unstable();
        assert_eq!(here, there);
        for name in here {
            experiment(name).unwrap_or_else(|failure| panic!("{failure}"));
        }
    }
}
