//! What a step costs of rows of a batch: a scalar instance, and many rows on one thread and on two.
//!
//! `cargo run --release --bin rows -- ../examples/antagonistic-joint.toml ../examples/control/joint-bang-bang.toml ../examples/tendon.toml`
//!
//! Rows of a file are alike, and go through 0.1 s in steps of 0.1 ms by ROS2. The least of several repeats counts.

use mckibben::Error;
use mckibben::command::Driver;
use mckibben::plant::{JointPlant, PlantRun, PlantSteps, PlantView, RigPlant};
use mckibben::simulation::Method;
use mckibben_batch::PlantBatch;
use mckibben_scenario::{Diagnostics, Document};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

const METHOD: Method = Method::Stable;
const DURATION: f64 = 0.1;
const STEPS: u64 = 1000;
const ROWS: usize = 64;
const REPEATS: usize = 7;

fn main() -> ExitCode {
    println!("ns/step of a row, {ROWS} rows alike, {STEPS} steps of 0.1 ms by ROS2, least of {REPEATS}");
    println!("{:<48}{:>12}{:>12}{:>12}", "file", "alone", "one thread", "two threads");
    for file in std::env::args().skip(1) {
        match of_file(&file) {
            Ok(cost) => print_cost(&file, cost),
            Err(text) => {
                eprintln!("{file}: {text}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

fn print_cost(name: &str, cost: [f64; 3]) {
    println!("{name:<48}{}", cost.map(|value| format!("{value:>12.0}")).concat());
}

/// The costs of a file's rows.
fn of_file(file: &str) -> Result<[f64; 3], String> {
    let document = Document::load(Path::new(file)).map_err(|error| error.to_string())?;
    let message = |error: Diagnostics| error.to_string();
    if let Some(of) = document.controlled_joint_experiment().map_err(message)? {
        return measure_plants(|| {
            let joint = JointPlant::new(&of.experiment.rig)?;
            steps(&joint, &of.experiment.start, Some(of.driver(&joint)?))
        });
    }
    if let Some(of) = document.joint_experiment().map_err(message)? {
        return measure_plants(|| steps(&JointPlant::new(&of.rig)?, &of.start, None));
    }
    if let Some(of) = document.controlled_experiment().map_err(message)? {
        return measure_plants(|| {
            let plant = RigPlant::new(&of.experiment.rig);
            steps(&plant, &of.experiment.start, Some(of.driver(&plant)?))
        });
    }
    if let Some(of) = document.plant_experiment().map_err(message)? {
        return measure_plants(|| Ok(PlantRun::new(&of.plant, &of.start, 1e-9)?.steps(METHOD)));
    }
    let of = document.experiment().map_err(message)?;
    measure_plants(|| steps(&RigPlant::new(&of.rig), &of.start, None))
}

/// Steps of a plant from its start.
fn steps<V: PlantView>(view: &V, start: &V::State, driver: Option<Driver>) -> Result<PlantSteps, Error> {
    let drivers = driver.into_iter().collect();
    Ok(PlantRun::with_drivers(view.plant(), &view.start(start), 1e-9, drivers)?.steps(METHOD))
}

/// Nanoseconds a step of a row of plants: as a scalar instance, among many on one thread, and on two.
fn measure_plants(begin: impl Fn() -> Result<PlantSteps, Error>) -> Result<[f64; 3], String> {
    let batch = |rows: usize| PlantBatch::new((0..rows).map(|_| begin()).collect::<Result<_, Error>>()?);
    measure_batches(batch, |batch| {
        batch.advance(DURATION, STEPS)?;
        (0..batch.len()).try_for_each(|row| batch.row(row).map(drop))
    })
}

/// Nanoseconds a step of a row: as a scalar instance, among many on one thread, and on two.
fn measure_batches<B: Send>(
    begin: impl Fn(usize) -> Result<B, Error>,
    go: impl Fn(&mut B) -> Result<(), Error> + Sync,
) -> Result<[f64; 3], String> {
    let mut cost = [f64::INFINITY; 3];
    for (least, (rows, threads)) in cost.iter_mut().zip([(1, 1), (ROWS, 1), (ROWS, 2)]) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
        for _ in 0..REPEATS {
            let mut batch = begin(rows).map_err(|error| error.to_string())?;
            let spent = pool.install(|| {
                let began = Instant::now();
                go(&mut batch).map(|()| began.elapsed().as_secs_f64())
            });
            let spent = spent.map_err(|error| error.to_string())?;
            *least = least.min(spent / (rows as f64 * STEPS as f64) * 1e9);
        }
    }
    Ok(cost)
}
