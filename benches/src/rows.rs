//! What a step of a scenario costs: alone, in a batch of 64 rows alike on one thread, there in single precision and on two threads,
//! by both methods, and a second of the event-located engine.
//!
//! `cargo run --release --bin rows -- ../examples/paper/fig-12.toml ../examples/leg.toml ../examples/control/pid.toml`
//!
//! Files of any kind, with their controllers, go through at most one second in steps of 0.1 ms. The least of several repeats
//! counts. Ratios are to the first file. Each batch must come to where the event-located engine comes: how near is printed,
//! and a file that is further off than the allowed part of the longest distance fails the benchmark.

use mckibben::Error;
use mckibben::command::Driver;
use mckibben::plant::{JointPlant, Plant, PlantRun, PlantStart, PlantView, RigPlant};
use mckibben::simulation::Method;
use mckibben_batch::{PlantBatch, Precision};
use mckibben_scenario::{Diagnostics, Document, PlantControl, Run};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

const ROWS: usize = 64;
const STEP: f64 = 1e-4;
const LONGEST: f64 = 1.0;
const REPEATS: usize = 5;
const METHODS: [(Method, &str); 2] = [(Method::Rk4, "RK4"), (Method::Stable, "stable")];
/// Rows, threads and numbers of a measurement.
const SIZES: [(usize, usize, Precision); 4] = [
    (1, 1, Precision::Double),
    (ROWS, 1, Precision::Double),
    (ROWS, 1, Precision::Single),
    (ROWS, 2, Precision::Double),
];
/// Difference of the distances at the end, over the longest of them, that is refused. Samplings and contacts that fall to the
/// other side of a step move the end of a loop or a leg.
const REFUSED: f64 = 2e-2;

fn main() -> ExitCode {
    println!("ns for a row and step; {ROWS} rows alike on one thread and on two, and a row alone; steps of 0.1 ms");
    print!("{:<44}", "file");
    for (_, name) in METHODS {
        print!("{:>12} {:>9} {:>6} {:>9} {:>9}", format!("{name} alone"), "one", "ratio", "single", "two");
    }
    println!("{:>14} {:>9}", "located us/s", "apart");
    let mut first = None;
    for file in std::env::args().skip(1) {
        match Case::read(&file).and_then(|case| case.measure()) {
            Ok(cost) => cost.print(&file, first.get_or_insert(cost.steps)),
            Err(text) => {
                eprintln!("{file}: {text}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

/// What a file costs.
struct Cost {
    /// Nanoseconds for a row and step, by method and size.
    steps: [[f64; 4]; 2],
    /// Microseconds of the event-located engine for a second.
    located: f64,
    /// How far apart the engines are at the end, as a part of the longest distance.
    apart: f64,
}

impl Cost {
    fn print(&self, file: &str, base: &[[f64; 4]; 2]) {
        print!("{file:<44}");
        for ([alone, one, single, two], [_, of_first, ..]) in self.steps.iter().zip(base) {
            print!("{alone:>12.0} {one:>9.1} {:>6.2} {single:>9.1} {two:>9.1}", one / of_first);
        }
        println!("{:>14.0} {:>9.1e}", self.located, self.apart);
    }
}

/// A scenario of any kind as a plant at its start.
struct Case {
    plant: Plant,
    start: PlantStart,
    drivers: Vec<Driver>,
    run: Run,
}

impl Case {
    fn read(file: &str) -> Result<Self, String> {
        let document = Document::load(Path::new(file)).map_err(|error| error.to_string())?;
        let message = |error: Diagnostics| error.to_string();
        if let Some(of) = document.plant_experiment().map_err(message)? {
            let drivers = of.controls.iter().map(PlantControl::driver).collect();
            return Ok(Self { plant: of.plant, start: of.start, drivers, run: of.run });
        }
        let case = if let Some(of) = document.controlled_joint_experiment().map_err(message)? {
            let joint = JointPlant::new(&of.experiment.rig);
            joint.and_then(|joint| {
                let driver = of.driver(&joint)?;
                Ok(Self::of(&joint, &of.experiment.start, Some(driver), of.experiment.run))
            })
        } else if let Some(of) = document.joint_experiment().map_err(message)? {
            JointPlant::new(&of.rig).map(|joint| Self::of(&joint, &of.start, None, of.run))
        } else if let Some(of) = document.controlled_experiment().map_err(message)? {
            let plant = RigPlant::new(&of.experiment.rig);
            of.driver(&plant).map(|driver| Self::of(&plant, &of.experiment.start, Some(driver), of.experiment.run))
        } else {
            let of = document.experiment().map_err(message)?;
            Ok(Self::of(&RigPlant::new(&of.rig), &of.start, None, of.run))
        };
        case.map_err(|error| error.to_string())
    }

    fn of<V: PlantView>(view: &V, start: &V::State, driver: Option<Driver>, run: Run) -> Self {
        Self { plant: view.plant().clone(), start: view.start(start), drivers: driver.into_iter().collect(), run }
    }

    /// At the start, with borders as wide as this tolerance.
    fn begin(&self, tolerance: f64) -> Result<PlantRun, Error> {
        PlantRun::with_drivers(&self.plant, &self.start, tolerance, self.drivers.clone())
    }

    fn measure(&self) -> Result<Cost, String> {
        let duration = self.run.duration.min(LONGEST);
        let steps = (duration / STEP).round().max(1.0) as u64;
        let (located, expected) = self.located(duration).map_err(|error| error.to_string())?;
        let longest = expected.iter().copied().fold(0.0, f64::max);
        let mut cost = Cost { steps: [[f64::INFINITY; 4]; 2], located, apart: 0.0 };
        for ((method, name), costs) in METHODS.into_iter().zip(&mut cost.steps) {
            for ((rows, threads, precision), least) in SIZES.into_iter().zip(costs) {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let pool = pool.map_err(|error| error.to_string())?;
                let (spent, found) = pool.install(|| self.least((method, rows, precision), (duration, steps)))?;
                *least = spent / (rows as f64 * steps as f64) * 1e9;
                let apart = found.iter().zip(&expected).map(|(found, expected)| (found - expected).abs() / longest);
                // What is not a number stays.
                let apart = apart.fold(0.0, |most: f64, its| if its.is_nan() || its > most { its } else { most });
                if apart.is_nan() || apart > REFUSED {
                    return Err(format!("by {name} the distances end {apart:e} of the longest off"));
                }
                cost.apart = cost.apart.max(apart);
            }
        }
        Ok(cost)
    }

    /// The least microseconds of the event-located engine for a second, and the distances in m that it comes to.
    fn located(&self, duration: f64) -> Result<(f64, Vec<f64>), Error> {
        let (mut least, mut distances) = (f64::INFINITY, Vec::new());
        for _ in 0..REPEATS {
            let mut run = self.begin(self.run.relative_tolerance)?;
            let began = Instant::now();
            run.advance_to(duration)?;
            least = least.min(began.elapsed().as_secs_f64() / duration * 1e6);
            distances = run.steps(Method::Rk4).sample().actuators.iter().map(|its| its.distance).collect();
        }
        Ok((least, distances))
    }

    /// The least seconds of a batch, and the distances in m that its first row comes to.
    fn least(
        &self,
        (method, rows, precision): (Method, usize, Precision),
        (duration, steps): (f64, u64),
    ) -> Result<(f64, Vec<f64>), String> {
        let (mut least, mut distances) = (f64::INFINITY, Vec::new());
        for _ in 0..REPEATS {
            let stepped = || {
                let row = self.begin(1e-9)?.steps(method);
                let mut batch = PlantBatch::with_precision(vec![row; rows], precision)?;
                let began = Instant::now();
                batch.advance(duration, steps)?;
                let spent = began.elapsed().as_secs_f64();
                let sample = batch.row(0)?.sample();
                Ok((spent, sample.actuators.iter().map(|its| its.distance).collect()))
            };
            let (spent, reached) = stepped().map_err(|error: Error| error.to_string())?;
            (least, distances) = (least.min(spent), reached);
        }
        Ok((least, distances))
    }
}
