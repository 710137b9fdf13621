//! `mckibben simulate` for a joint that two actuators turn.

use super::{Files, SimulateArguments};
use crate::engine;
use crate::failure::Failure;
use crate::joint::outcome;
use crate::joint::summary::Summary;
use crate::joint::{control, events, portrait};
use crate::progress::Progress;
use crate::record;
use crate::terminal;
use mckibben_scenario::{ControlledJointExperiment, Document, Engine, JointExperiment, Scenario};
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
    let run = match joint {
        Joint::Open(experiment) => &experiment.run,
        Joint::Controlled(of) => &of.experiment.run,
    };
    if arguments.events_output.is_some() && run.engine == Engine::FixedStep {
        return Err(Failure::input(
            "--events-output: the fixed-step engine keeps no log of events",
            "set run.engine = \"event-located\", or leave --events-output out",
        ));
    }
    files.probe()?;
    let started = Instant::now();
    let (outcome, closed) = match joint {
        Joint::Open(of) => outcome::run(of).map(|outcome| (outcome, None)),
        Joint::Controlled(of) => {
            let progress = Progress::begin("simulating", Some(PARTS as u64));
            let watch = |time: f64| progress.at((PARTS * time / run.duration) as u64);
            control::close(of, None, watch).map(|(outcome, closed)| (outcome, Some(closed)))
        }
    }
    .map_err(|error| Failure::of_core(&error, document))?;
    let goals = closed.as_ref().map_or(&[][..], |closed| &closed.goals);
    let elapsed = started.elapsed();
    let interval = run.sample_interval;
    files.write_with(
        arguments,
        (document, scenario),
        |provenance, target, out| record::write_joint(&outcome, goals, interval, provenance, target, out),
        |title, target| portrait::draw(&outcome, goals, interval, title, target),
        |path, out| events::write(outcome.events(), path, out),
    )?;
    let mut text = String::new();
    if !arguments.quiet {
        let antagonist = scenario.of_antagonist();
        let summary = Summary {
            name: &arguments.file.display().to_string(),
            scenarios: [scenario, antagonist.as_ref().unwrap_or(scenario)],
            outcome: &outcome,
            control: closed.as_ref(),
            elapsed,
            assumed: &document.assumed(),
        };
        text.push_str(&summary.render());
        text.push_str(&files.told(engine::rows(run)));
    }
    if arguments.events {
        text.push_str(if text.is_empty() { "" } else { "\n" });
        text.push_str(&match outcome.located() {
            Some(trajectory) => events::table(trajectory.events()),
            None => "the fixed-step engine keeps no log of events\n".to_owned(),
        });
    }
    if text.is_empty() { Ok(()) } else { terminal::print(&text) }
}
