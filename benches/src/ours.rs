//! Our own integrator, and where its time goes.

use crate::peer::{Peer, Solution};
use crate::problem::{Problem, SAMPLE_INTERVAL};
use mckibben::engine::Statistics;
use mckibben::plant::RigTrajectory;
use mckibben::simulation::simulate;
use std::hint::black_box;
use std::time::Instant;

/// `mckibben::simulation::simulate` and the rows of its trajectory at the sample instants.
pub struct Ours;

fn run(problem: &Problem, tolerance: f64) -> Result<RigTrajectory, String> {
    let experiment = &problem.experiment;
    simulate(&experiment.rig, experiment.start, experiment.run.duration, tolerance).map_err(|error| error.to_string())
}

fn rows(trajectory: &RigTrajectory) -> Vec<[f64; 2]> {
    trajectory.samples(SAMPLE_INTERVAL).map(|row| [row.length, row.pressure.0]).collect()
}

/// Shortest time in s of `repeats` calls.
pub fn shortest<T>(repeats: u32, mut work: impl FnMut() -> T) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..repeats {
        let start = Instant::now();
        black_box(work());
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

impl Peer for Ours {
    fn name(&self) -> String {
        "mckibben simulate".into()
    }

    fn repeats(&self) -> u32 {
        400
    }

    fn solve(&self, problem: &Problem, tolerance: f64, repeats: u32) -> Result<Solution, String> {
        let trajectory = run(problem, tolerance)?;
        let counts = trajectory.statistics();
        let samples = rows(&trajectory);
        let seconds = shortest(repeats, || run(problem, tolerance).map(|trajectory| rows(&trajectory)));
        Ok(Solution { seconds, evaluations: counts.evaluations, steps: steps(&counts), events: counts.events, samples })
    }
}

/// Steps taken, the rejected ones included.
pub fn steps(counts: &Statistics) -> u64 {
    counts.explicit_steps + counts.implicit_steps + counts.rejected_steps
}

/// Where the time of one run goes.
pub struct Profile {
    /// `simulate` alone, in s.
    pub simulation: f64,
    /// The rows at the samples, in s.
    pub rows: f64,
    /// What the integrator counted.
    pub counts: Statistics,
}

impl Profile {
    /// Takes the times of the parts of one run.
    ///
    /// # Errors
    /// When the run fails.
    pub fn take(problem: &Problem, tolerance: f64) -> Result<Self, String> {
        let trajectory = run(problem, tolerance)?;
        let simulation = shortest(Ours.repeats(), || run(problem, tolerance));
        Ok(Self { simulation, rows: shortest(Ours.repeats(), || rows(&trajectory)), counts: trajectory.statistics() })
    }
}
