//! Stand-in for `mckibben::batch` with its interface, on one [`FixedStepper`] for each row; to be deleted with it.

use mckibben::Error;
use mckibben::simulation::{FixedStepper, Method, Rig, Sample, State};

/// A row of a batch.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// What is simulated.
    pub(super) rig: Rig,
    /// Its state at t = 0.
    pub(super) start: State,
}

/// Rows that go through time together.
#[derive(Debug)]
pub(super) struct Batch {
    rows: Vec<Result<FixedStepper<'static>, Error>>,
    time: f64,
}

impl Batch {
    /// Starts all rows at t = 0.
    pub(super) fn new(rows: Vec<Row>, method: Method) -> Self {
        // The stepper borrows its rig; here the rig is never given back.
        let begin = |row: Row| Ok(FixedStepper::new(Box::leak(Box::new(row.rig)), row.start, method));
        Self { rows: rows.into_iter().map(begin).collect(), time: 0.0 }
    }

    /// The time in s that has been reached.
    pub(super) fn time(&self) -> f64 {
        self.time
    }

    /// Takes every living row to `until` in equal steps.
    pub(super) fn advance(&mut self, until: f64, steps: u64) {
        let from = self.time;
        for row in &mut self.rows {
            for step in 1..=steps {
                let Ok(stepper) = row else { break };
                let to = if step == steps { until } else { from + (until - from) * (step as f64 / steps as f64) };
                if let Err(error) = stepper.advance_to(to) {
                    *row = Err(error);
                }
            }
        }
        self.time = until;
    }

    /// What holds now, or why the row stopped.
    ///
    /// # Errors
    /// Why the row stopped.
    pub(super) fn sample(&self, row: usize) -> Result<Sample, Error> {
        self.rows[row].as_ref().map(FixedStepper::sample).map_err(Clone::clone)
    }
}
