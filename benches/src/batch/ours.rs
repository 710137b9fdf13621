//! Our engine on the work.

use crate::work::{Row, STEP};
use mckibben::simulation::{FixedStepper, Method, State};
use std::time::Instant;

/// What a run took and where it ended.
pub struct Run {
    /// Time in s from the start of the threads to the last one's end.
    pub seconds: f64,
    /// The last state of each row.
    pub states: Vec<[f64; 4]>,
}

/// Takes every row through `steps` steps, the rows divided over `threads`.
///
/// # Errors
/// When a row leaves the physics.
pub fn ours(rows: &[Row], steps: u64, threads: usize) -> Result<Run, String> {
    let mut lots: Vec<Lot> = rows.chunks(rows.len().div_ceil(threads)).map(Lot::new).collect();
    let until = steps as f64 * STEP;
    let start = Instant::now();
    match &mut lots[..] {
        [lot] => lot.advance(until, steps),
        lots => std::thread::scope(|scope| {
            for lot in lots {
                scope.spawn(move || lot.advance(until, steps));
            }
        }),
    }
    let seconds = start.elapsed().as_secs_f64();
    let states = lots.iter().map(Lot::states).collect::<Result<Vec<_>, _>>()?.concat();
    Ok(Run { seconds, states })
}

/// The rows of one thread.
struct Lot<'a> {
    steppers: Vec<FixedStepper<'a>>,
    stopped: Option<String>,
}

impl<'a> Lot<'a> {
    fn new(rows: &'a [Row]) -> Self {
        let steppers = rows.iter().map(|row| FixedStepper::new(&row.rig, row.start, Method::Rk4)).collect();
        Self { steppers, stopped: None }
    }

    fn advance(&mut self, until: f64, steps: u64) {
        for stepper in &mut self.steppers {
            for step in 1..=steps {
                if let Err(error) = stepper.advance_to(until * step as f64 / steps as f64) {
                    self.stopped = Some(error.to_string());
                }
            }
        }
    }

    fn states(&self) -> Result<Vec<[f64; 4]>, String> {
        if let Some(reason) = &self.stopped {
            return Err(reason.clone());
        }
        let numbers = |State { length, velocity, pressure, air_mass }| [length, velocity, pressure.0, air_mass];
        Ok(self.steppers.iter().map(|stepper| numbers(stepper.state())).collect())
    }
}
