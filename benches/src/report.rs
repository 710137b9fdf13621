//! The tables.

use crate::ours::{Ours, Profile, shortest, steps};
use crate::peer::{Measurement, Peer, tolerance_for};
use crate::problem::Problem;
use mckibben::simulation::simulate;
use mckibben_scenario::Document;
use std::path::Path;

/// Error at [`crate::TOLERANCE`] below which two answers are the same answer: a peer that took another path through the
/// modes is off by far more.
const AGREEMENT: f64 = 1e-4;

/// Every peer at one tolerance, and at the tolerance that gives our error; the ratio is at equal error.
///
/// # Errors
/// When a peer does not agree, or ours fails.
pub fn comparison(problem: &Problem, peers: &[Box<dyn Peer>], tolerance: f64) -> Result<(), String> {
    println!("error: the largest of length and pressure, each over its range; ratio: time at equal error over ours");
    println!(
        "{:<30} {:>8} {:>9} {:>11} {:>12} {:>7} {:>7} {:>7}",
        "", "rtol", "error", "us/sim-s", "evaluations", "steps", "events", "ratio"
    );
    let ours = Measurement::take(&Ours, problem, tolerance, Ours.repeats())?;
    row(problem, &Ours.name(), &ours, "1");
    let mut disagree = Vec::new();
    let mut best: Option<(String, f64)> = None;
    for peer in peers {
        let name = peer.name();
        match Measurement::take(peer.as_ref(), problem, tolerance, peer.repeats()) {
            Ok(same) => {
                row(problem, &name, &same, "");
                if same.error > AGREEMENT {
                    disagree.push(format!("{name} at {tolerance:.0e} is {:.1e} off", same.error));
                }
            }
            Err(message) => {
                println!("{name:<30} {tolerance:>8.0e} failed: {message}");
                disagree.push(format!("{name} at {tolerance:.0e} fails: {message}"));
            }
        }
        match tolerance_for(peer.as_ref(), problem, ours.error) {
            Ok(tolerance) => {
                let equal = Measurement::take(peer.as_ref(), problem, tolerance, peer.repeats())?;
                let ratio = equal.cost(problem) / ours.cost(problem);
                row(problem, "  at our error", &equal, &format!("{ratio:.2}"));
                if best.as_ref().is_none_or(|(_, least)| ratio < *least) {
                    best = Some((name, ratio));
                }
            }
            Err(message) => {
                println!("{:<30} {message}", "  at our error");
                disagree.push(format!("{name} does not come near our answer: {message}"));
            }
        }
    }
    if let Some((name, ratio)) = best {
        println!("the fastest peer at our error is {name}: {ratio:.2} times our time");
    }
    if disagree.is_empty() { Ok(()) } else { Err(disagree.join("\n")) }
}

fn row(problem: &Problem, name: &str, taken: &Measurement, ratio: &str) {
    let solution = &taken.solution;
    println!(
        "{name:<30} {:>8.1e} {:>9.1e} {:>11.1} {:>12} {:>7} {:>7} {ratio:>7}",
        taken.tolerance,
        taken.error,
        taken.cost(problem),
        solution.evaluations,
        solution.steps,
        solution.events
    );
}

/// Where our own time goes.
///
/// # Errors
/// When a run fails.
pub fn profile(problem: &Problem, tolerance: f64) -> Result<(), String> {
    let profile = Profile::take(problem, tolerance)?;
    let (counts, microseconds) = (profile.counts, 1e6 / problem.duration());
    let evaluations = counts.evaluations as f64;
    println!("mckibben at {tolerance:.0e}: {counts:?}");
    println!("  simulate alone          {:>8.1} us/sim-s", profile.simulation * microseconds);
    println!("  rows each ms            {:>8.1} us/sim-s", profile.rows * microseconds);
    println!("  time per evaluation     {:>8.1} ns", profile.simulation * 1e9 / evaluations);
    println!("  time per step           {:>8.2} us", profile.simulation * 1e6 / steps(&counts) as f64);
    Ok(())
}

/// Ours on several scenarios and tolerances.
///
/// # Errors
/// When a run fails.
pub fn scenarios(folder: &Path, names: &[&str]) -> Result<(), String> {
    println!("mckibben, simulate alone, us/sim-s and (evaluations per simulated second)");
    println!("{:<20} {:>20} {:>20} {:>20}", "", "1e-6", "1e-8", "1e-10");
    for name in names {
        let path = folder.join(format!("{name}.toml"));
        let document = Document::load(path).map_err(|error| error.to_string())?;
        let experiment = document.experiment().map_err(|error| error.to_string())?;
        let duration = experiment.run.duration;
        let mut line = format!("{name:<20}");
        for tolerance in [1e-6, 1e-8, 1e-10] {
            let run = || simulate(&experiment.rig, experiment.start, duration, tolerance);
            let counts = run().map_err(|error| error.to_string())?.statistics();
            let cost = shortest(Ours.repeats(), run) * 1e6 / duration;
            line += &format!(" {:>20}", format!("{cost:.1} ({:.0})", counts.evaluations as f64 / duration));
        }
        println!("{line}");
    }
    Ok(())
}
