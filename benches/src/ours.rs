//! Our own integrator, and where its time goes.

use crate::peer::{Peer, Solution};
use crate::problem::{Problem, SAMPLE_INTERVAL};
use mckibben::simulation::system::HybridSystem;
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{Counts, Integrator, RigSystem, simulate};
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
pub fn steps(counts: &Counts) -> u64 {
    counts.explicit_steps + counts.implicit_steps + counts.rejected_steps
}

/// Where the time of one run goes.
pub struct Profile {
    /// `simulate` alone, in s.
    pub simulation: f64,
    /// The rows at the samples, in s.
    pub rows: f64,
    /// Right-hand sides alone, at the states along the run: s for each.
    pub rates: f64,
    /// What the integrator counted.
    pub counts: Counts,
}

impl Profile {
    /// Takes the times of the parts of one run.
    ///
    /// # Errors
    /// When the run fails.
    pub fn take(problem: &Problem, tolerance: f64) -> Result<Self, String> {
        let trajectory = run(problem, tolerance)?;
        let simulation = shortest(Ours.repeats(), || run(problem, tolerance));
        Ok(Self {
            simulation,
            rows: shortest(Ours.repeats(), || rows(&trajectory)),
            rates: rates_alone(problem, tolerance)?,
            counts: trajectory.statistics(),
        })
    }
}

/// Time in s of one evaluation of the rates, over the states and modes of a run, each one waiting for the one before
/// as the stages of a step do.
fn rates_alone(problem: &Problem, tolerance: f64) -> Result<f64, String> {
    let experiment = &problem.experiment;
    let system = RigSystem::new(&experiment.rig, tolerance);
    let start = experiment.start;
    let state = [start.length, start.velocity, start.pressure.0, start.air_mass];
    let duration = experiment.run.duration;
    let mut integrator = Integrator::new(&system, 0.0, state, system.begin(&state), duration, tolerance);
    let mut places = Vec::new();
    while let Some(piece) = integrator.advance().map_err(|error| error.to_string())? {
        places.push((piece.arc.at(0.5), piece.mode));
    }
    const CHAIN: u32 = 12;
    let seconds = shortest(100, || {
        for (state, mode) in &places {
            let mut state = *state;
            for _ in 0..CHAIN {
                let slope: [f64; 4] = system.rates(0.0, &state, mode);
                for (value, slope) in state.iter_mut().zip(slope) {
                    *value += 1e-30 * slope;
                }
            }
            black_box(state);
        }
    });
    Ok(seconds / (places.len() as f64 * f64::from(CHAIN)))
}
