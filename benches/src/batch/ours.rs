//! Our engine on the work: [`PlantBatch`] by instructions and method.

use crate::work::{Row, STEP};
use mckibben::plant::{Plant, PlantRun, PlantSteps};
use mckibben::simulation::Method;
use mckibben_batch::{PlantBatch, Precision, Width};
use std::fmt::{Display, Formatter, Result as Formatted};
use std::time::Instant;

/// One of the forms of the batch engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Engine {
    /// Its instructions.
    pub width: Width,
    /// Its method.
    pub method: Method,
}

/// What a run took and where it ended.
pub struct Run {
    /// Time in s from the first step to the last thread's end.
    pub seconds: f64,
    /// Time in s that the threads of this process had on a core meanwhile, in hundredths.
    pub processor_seconds: f64,
    /// The last state of each row: length, velocity, pressure and air mass.
    pub states: Vec<[f64; 4]>,
}

impl Engine {
    /// The one that a batch has unless another is requested.
    pub fn usual() -> Self {
        Self { width: Width::widest(), method: Method::Rk4 }
    }

    /// All that this machine has, the widest first.
    pub fn all() -> Vec<Self> {
        let of = |method| Width::available().into_iter().rev().map(move |width| Self { width, method });
        [Method::Rk4, Method::Stable].into_iter().flat_map(of).collect()
    }

    /// Takes every row through `steps` steps on `threads` threads.
    ///
    /// # Errors
    /// When a row leaves the physics.
    pub fn run(self, rows: Vec<Row>, steps: u64, threads: usize) -> Result<Run, String> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
        let begin = |row: &Row| -> Result<PlantSteps, mckibben::Error> {
            let (plant, start) = (Plant::of_rig(&row.rig), Plant::start_of_rig(&row.rig, &row.start));
            Ok(PlantRun::new(&plant, &start, 1e-9)?.steps(self.method))
        };
        let text = |error: mckibben::Error| error.to_string();
        pool.install(|| {
            let rows = rows.iter().map(begin).collect::<Result<Vec<_>, _>>().map_err(text)?;
            let mut batch = PlantBatch::with_lanes(rows, self.width, Precision::Double).map_err(text)?;
            let (start, processor) = (Instant::now(), processor_seconds());
            batch.advance(steps as f64 * STEP, steps).map_err(text)?;
            let (seconds, processor_seconds) = (start.elapsed().as_secs_f64(), processor_seconds() - processor);
            let mut states = vec![[0.0; 4]; batch.len()];
            for (row, state) in states.iter_mut().enumerate() {
                batch.read(row, state).map_err(text)?;
            }
            Ok(Run { seconds, processor_seconds, states })
        })
    }
}

impl Display for Engine {
    fn fmt(&self, text: &mut Formatter<'_>) -> Formatted {
        let method = if self.method == Method::Rk4 { "RK4" } else { "ROS2" };
        text.pad(&format!("{method} {:?}", self.width))
    }
}

/// Time in s that all threads of this process have had on a core; nothing where the system does not say.
fn processor_seconds() -> f64 {
    let line = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // After the name in brackets: the 12th and 13th words are user and system time, in hundredths of a second.
    let words = line.rsplit(')').next().unwrap_or_default().split_whitespace();
    words.skip(11).take(2).filter_map(|word| word.parse::<f64>().ok()).sum::<f64>() / 100.0
}
