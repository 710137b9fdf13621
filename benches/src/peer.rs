//! What a peer is, and how two of them are compared: at equal error.

use crate::problem::Problem;

/// One way to solve the problem.
pub trait Peer {
    /// Name in the table.
    fn name(&self) -> String;

    /// Solves the problem `repeats` times and keeps the shortest time.
    ///
    /// # Errors
    /// When the peer cannot run or cannot reach the end.
    fn solve(&self, problem: &Problem, tolerance: f64, repeats: u32) -> Result<Solution, String>;

    /// How often to repeat a run whose time is quoted.
    fn repeats(&self) -> u32 {
        40
    }
}

/// An answer and what it cost.
#[derive(Clone, Debug, Default)]
pub struct Solution {
    /// Shortest time of the repeats in s.
    pub seconds: f64,
    /// Evaluations of the right-hand side.
    pub evaluations: u64,
    /// Steps, the rejected ones included where the peer counts them.
    pub steps: u64,
    /// Ends of modes, valve edges included.
    pub events: u64,
    /// Length in m and absolute pressure in Pa at each sample.
    pub samples: Vec<[f64; 2]>,
}

/// A run with its error.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Requested relative tolerance.
    pub tolerance: f64,
    /// As [`Problem::error`].
    pub error: f64,
    /// What it cost.
    pub solution: Solution,
}

impl Measurement {
    /// Runs a peer.
    ///
    /// # Errors
    /// As [`Peer::solve`].
    pub fn take(peer: &dyn Peer, problem: &Problem, tolerance: f64, repeats: u32) -> Result<Self, String> {
        let solution = peer.solve(problem, tolerance, repeats)?;
        Ok(Self { tolerance, error: problem.error(&solution.samples), solution })
    }

    /// Microseconds of computing for each simulated second.
    pub fn cost(&self, problem: &Problem) -> f64 {
        self.solution.seconds * 1e6 / problem.duration()
    }
}

/// The loosest tolerance, in quarters of a decade, at which a peer's error is at most `error`; the ladder ends at 1e-13.
///
/// # Errors
/// When no tolerance of the ladder gives that error.
pub fn tolerance_for(peer: &dyn Peer, problem: &Problem, error: f64) -> Result<f64, String> {
    let mut reached = (f64::INFINITY, 0.0);
    for quarter in 20..=52 {
        let tolerance = 10.0_f64.powf(-0.25 * f64::from(quarter));
        // A run that fails at a loose tolerance does not say that a tighter one does.
        let Ok(measurement) = Measurement::take(peer, problem, tolerance, 1) else { continue };
        if measurement.error <= error {
            return Ok(tolerance);
        }
        if measurement.error < reached.0 {
            reached = (measurement.error, tolerance);
        }
    }
    Err(format!("its error is never below {:.1e}, which it has at {:.1e}", reached.0, reached.1))
}
