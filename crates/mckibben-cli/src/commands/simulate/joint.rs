//! `mckibben simulate` for a joint that two actuators turn.

use super::{Files, SimulateArguments};
use crate::engine;
use crate::failure::Failure;
use crate::joint::summary::Summary;
use crate::joint::{events, portrait};
use crate::progress::Progress;
use crate::record;
use crate::terminal;
use mckibben::simulation::simulate_joint_watched;
use mckibben_scenario::{Document, JointExperiment, Scenario};
use std::time::Instant;

/// Runs the joint, tells what it came to, and writes what is asked for.
pub(super) fn run(
    arguments: &SimulateArguments,
    files: &Files<'_>,
    document: &Document,
    scenario: &Scenario,
    experiment: &JointExperiment,
) -> Result<(), Failure> {
    const PARTS: f64 = 1000.0;
    files.probe()?;
    let run = &experiment.run;
    let started = Instant::now();
    let trajectory = {
        let progress = Progress::begin("simulating", Some(PARTS as u64));
        let watch = |time: f64| progress.at((PARTS * time / run.duration) as u64);
        simulate_joint_watched(&experiment.rig, experiment.start, run.duration, run.relative_tolerance, watch)
            .map_err(|error| Failure::of_core(&error, document))?
    };
    let elapsed = started.elapsed();
    let interval = run.sample_interval;
    files.write_with(
        arguments,
        (document, scenario),
        |provenance, target, out| record::write_joint(&trajectory, interval, provenance, target, out),
        |title, target| portrait::draw(&trajectory, interval, title, target),
        |path, out| events::write(trajectory.events(), path, out),
    )?;
    let mut text = String::new();
    if !arguments.quiet {
        let antagonist = scenario.of_antagonist();
        let summary = Summary {
            name: &arguments.file.display().to_string(),
            scenarios: [scenario, antagonist.as_ref().unwrap_or(scenario)],
            trajectory: &trajectory,
            elapsed,
            assumed: &document.assumed(),
        };
        text.push_str(&summary.render());
        text.push_str(&files.told(engine::rows(run)));
    }
    if arguments.events {
        text.push_str(if text.is_empty() { "" } else { "\n" });
        text.push_str(&events::table(trajectory.events()));
    }
    if text.is_empty() { Ok(()) } else { terminal::print(&text) }
}
