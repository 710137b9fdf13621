//! `mckibben simulate` for a joint that two actuators turn.

use super::{Files, SimulateArguments};
use crate::engine;
use crate::failure::Failure;
use crate::joint::summary::Summary;
use crate::joint::{control, events, portrait};
use crate::progress::Progress;
use crate::record;
use crate::terminal;
use mckibben::simulation::simulate_joint_watched;
use mckibben_scenario::{ControlledJointExperiment, Document, JointExperiment, Scenario};
use std::time::Instant;

/// A joint with its own commands, or with a controller.
pub(super) enum Joint {
    /// With its own commands.
    Open(Box<JointExperiment>),
    /// With a controller.
    Controlled(Box<ControlledJointExperiment>),
}

/// Runs the joint, tells what it came to, and writes what is asked for.
pub(super) fn run(
    arguments: &SimulateArguments,
    files: &Files<'_>,
    document: &Document,
    scenario: &Scenario,
    joint: &Joint,
) -> Result<(), Failure> {
    const PARTS: f64 = 1000.0;
    files.probe()?;
    let run = match joint {
        Joint::Open(experiment) => &experiment.run,
        Joint::Controlled(of) => &of.experiment.run,
    };
    let started = Instant::now();
    let (trajectory, closed) = {
        let progress = Progress::begin("simulating", Some(PARTS as u64));
        let watch = |time: f64| progress.at((PARTS * time / run.duration) as u64);
        match joint {
            Joint::Open(of) => simulate_joint_watched(&of.rig, of.start, run.duration, run.relative_tolerance, watch)
                .map(|trajectory| (trajectory, None)),
            Joint::Controlled(of) => control::close(of, watch).map(|closed| (closed.trajectory.clone(), Some(closed))),
        }
        .map_err(|error| Failure::of_core(&error, document))?
    };
    let goals = closed.as_ref().map_or(&[][..], |closed| &closed.goals);
    let elapsed = started.elapsed();
    let interval = run.sample_interval;
    files.write_with(
        arguments,
        (document, scenario),
        |provenance, target, out| record::write_joint(&trajectory, goals, interval, provenance, target, out),
        |title, target| portrait::draw(&trajectory, goals, interval, title, target),
        |path, out| events::write(trajectory.events(), path, out),
    )?;
    let mut text = String::new();
    if !arguments.quiet {
        let antagonist = scenario.of_antagonist();
        let summary = Summary {
            name: &arguments.file.display().to_string(),
            scenarios: [scenario, antagonist.as_ref().unwrap_or(scenario)],
            trajectory: &trajectory,
            control: closed.as_ref(),
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
