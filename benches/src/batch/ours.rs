//! Our engine on the work: [`Batch`] by instructions, numbers and method.

use crate::work::STEP;
use mckibben::batch::{Batch, Float, Row, Width};
use mckibben::simulation::Method;
use std::fmt::{Display, Formatter, Result as Formatted};
use std::time::Instant;

/// The numbers that a row is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `f64`.
    Double,
    /// `f32`.
    Single,
}

/// One of the forms of the batch engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Engine {
    /// Its instructions.
    pub width: Width,
    /// Its numbers.
    pub precision: Precision,
    /// Its method.
    pub method: Method,
}

/// What a run took and where it ended.
pub struct Run {
    /// Time in s from the first step to the last thread's end.
    pub seconds: f64,
    /// Time in s that the threads of this process had on a core meanwhile, in hundredths.
    pub processor_seconds: f64,
    /// The last state of each row.
    pub states: Vec<[f64; 4]>,
}

impl Engine {
    /// The one that a batch has unless another is asked for.
    pub fn usual() -> Self {
        Self { width: Width::widest(), precision: Precision::Double, method: Method::Rk4 }
    }

    /// All that this machine has, the widest first.
    pub fn all() -> Vec<Self> {
        let mut engines = Vec::new();
        for method in [Method::Rk4, Method::Stable] {
            for precision in [Precision::Double, Precision::Single] {
                let widths = Width::available().into_iter().rev();
                engines.extend(widths.map(|width| Self { width, precision, method }));
            }
        }
        engines
    }

    /// Takes every row through `steps` steps on `threads` threads.
    ///
    /// # Errors
    /// When a row leaves the physics.
    pub fn run(self, rows: Vec<Row>, steps: u64, threads: usize) -> Result<Run, String> {
        match self.precision {
            Precision::Double => self.run_in::<f64>(rows, steps, threads),
            Precision::Single => self.run_in::<f32>(rows, steps, threads),
        }
    }

    fn run_in<F: Float>(self, rows: Vec<Row>, steps: u64, threads: usize) -> Result<Run, String> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
        pool.install(|| {
            let mut batch: Batch<F> = Batch::with_width(rows, self.method, self.width);
            let (start, processor) = (Instant::now(), processor_seconds());
            batch.advance(steps as f64 * STEP, steps);
            let (seconds, processor_seconds) = (start.elapsed().as_secs_f64(), processor_seconds() - processor);
            let end = |sample: Result<mckibben::simulation::Sample, mckibben::Error>| match sample {
                Ok(sample) => Ok([sample.length, sample.velocity, sample.pressure.0, sample.air_mass]),
                Err(error) => Err(error.to_string()),
            };
            let states = batch.samples().into_iter().map(end).collect::<Result<_, _>>()?;
            Ok(Run { seconds, processor_seconds, states })
        })
    }
}

impl Display for Engine {
    fn fmt(&self, text: &mut Formatter<'_>) -> Formatted {
        let numbers = if self.precision == Precision::Double { "f64" } else { "f32" };
        let method = if self.method == Method::Rk4 { "RK4" } else { "stable" };
        text.pad(&format!("{method} {numbers} {:?}", self.width))
    }
}

/// Time in s that all threads of this process have had on a core; nothing where the system does not say.
fn processor_seconds() -> f64 {
    let line = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // After the name in brackets: the 12th and 13th words are user and system time, in hundredths of a second.
    let words = line.rsplit(')').next().unwrap_or_default().split_whitespace();
    words.skip(11).take(2).filter_map(|word| word.parse::<f64>().ok()).sum::<f64>() / 100.0
}
