//! What a step of each form of our engine costs, and how far it is from the truth.

use crate::ours::Engine;
use crate::peers::{ROWS, nanoseconds};
use crate::reference::{Error, Reference};
use crate::work::{STEPS, Work};
use mckibben::simulation::Method;
use std::time::{Duration, Instant};

/// Calls of which the shortest counts: as many as fit into this time, within the limits.
const PATIENCE: Duration = Duration::from_millis(1500);
const FEWEST: u32 = 3;
const MOST: u32 = 30;

/// What an engine took and gave.
pub struct Measurement {
    /// Shortest time in s for all rows and steps, on one thread and on two.
    pub seconds: [f64; 2],
    /// Mean time in s on a core, of the calls on one thread: other work on the machine does not lengthen it.
    pub processor_seconds: f64,
    /// Against the event-located engine.
    pub error: Error,
}

impl Measurement {
    /// Steps the rows of the comparison.
    ///
    /// # Errors
    /// When a row leaves the physics.
    pub fn take(engine: Engine, work: &Work, reference: &Reference) -> Result<Self, String> {
        let rows = work.rows(ROWS)?;
        let mut seconds = [f64::INFINITY; 2];
        let mut on_core = [0.0; 2];
        let mut states = Vec::new();
        for threads in [1, 2] {
            let start = Instant::now();
            let mut calls = 0;
            while calls < FEWEST || (calls < MOST && start.elapsed() < PATIENCE) {
                let run = engine.run(rows.clone(), STEPS, threads)?;
                let n = threads - 1;
                seconds[n] = run.seconds.min(seconds[n]);
                on_core[n] += run.processor_seconds;
                states = run.states;
                calls += 1;
            }
            on_core[threads - 1] /= f64::from(calls);
        }
        Ok(Self { seconds, processor_seconds: on_core[0], error: reference.error(&states) })
    }
}

/// Errors up to which an answer is right, of the middle row and of the worst: a heavy mass that bounces on the taut braid
/// magnifies any difference.
fn agreement(engine: Engine) -> Error {
    match engine.method {
        Method::Rk4 => Error { median: 1e-7, worst: 1e-5 },
        Method::Stable => Error { median: 1e-3, worst: 1e-1 },
    }
}

/// Prints the table.
///
/// # Errors
/// When a run fails or an answer is wrong.
pub fn print(work: &Work, reference: &Reference) -> Result<(), String> {
    println!("mckibben_batch::PlantBatch, {ROWS} rows, {STEPS} steps of 0.1 ms");
    println!("{:<22} {:>27} {:>8} {:>16} {:>19}", "", "ns/actuator-step", "speed-up", "million steps/s", "error");
    println!(
        "{:<22} {:>8} {:>8} {:>9} {:>8} {:>8} {:>7} {:>9} {:>9}",
        "", "one core", "two", "CPU", "", "one core", "two", "median", "worst"
    );
    let mut wrong = Vec::new();
    for engine in Engine::all() {
        let taken = Measurement::take(engine, work, reference)?;
        let [one, two] = taken.seconds.map(nanoseconds);
        let Error { median, worst } = taken.error;
        println!(
            "{engine:<22} {one:>8.2} {two:>8.2} {:>9.2} {:>8.2} {:>8.1} {:>7.1} {median:>9.1e} {worst:>9.1e}",
            nanoseconds(taken.processor_seconds),
            one / two,
            1e3 / one,
            1e3 / two,
        );
        if !taken.error.is_within(agreement(engine)) {
            wrong.push(format!("{engine} is off by {:?}", taken.error));
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}
