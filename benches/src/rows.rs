//! What a step costs of rows of a batch: one alone, and many on one thread and on two.
//!
//! `cargo run --release --bin rows -- ../examples/antagonistic-joint.toml ../examples/control/joint-bang-bang.toml ../examples/tendon.toml`
//!
//! Rows of a file are alike, and go through 0.1 s in steps of 0.1 ms by the stable method; a leg on six actuators of the first
//! file with one actuator is measured besides, its numbers those of `crates/mckibben-cli/examples/leg.rs`. The least of several
//! repeats counts.

use mckibben::batch::RowByRow;
use mckibben::command::Driver;
use mckibben::control::Drive;
use mckibben::load::leg::{Leg, LegState, STRANDS};
use mckibben::plant::{JointPlant, PlantBatch, PlantRun, PlantSteps, PlantView, RigPlant};
use mckibben::simulation::{LegStepper, Method, Rig, Stepper};
use mckibben::valve::Request;
use mckibben::{Error, GaugePressure};
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
    println!("ns/step of a row, {ROWS} rows alike, {STEPS} steps of 0.1 ms by the stable method, least of {REPEATS}");
    println!("{:<48}{:>12}{:>12}{:>12}", "file", "alone", "one thread", "two threads");
    let mut leg = None;
    for file in std::env::args().skip(1) {
        match of_file(&file, &mut leg) {
            Ok(cost) => tell(&file, cost),
            Err(text) => {
                eprintln!("{file}: {text}");
                return ExitCode::FAILURE;
            }
        }
    }
    match leg.map(|rig| measure(|| of_leg(&rig))) {
        Some(Ok(cost)) => tell("a leg on six of the actuators", cost),
        Some(Err(text)) => {
            eprintln!("{text}");
            return ExitCode::FAILURE;
        }
        None => {}
    }
    ExitCode::SUCCESS
}

fn tell(name: &str, cost: [f64; 3]) {
    println!("{name:<48}{}", cost.map(|value| format!("{value:>12.0}")).concat());
}

/// The costs of a file's rows; its rig serves for a leg if there is none yet.
fn of_file(file: &str, leg: &mut Option<Rig>) -> Result<[f64; 3], String> {
    let document = Document::load(Path::new(file)).map_err(|error| error.to_string())?;
    let told = |error: Diagnostics| error.to_string();
    if let Some(of) = document.controlled_joint_experiment().map_err(told)? {
        return measure_plants(|| {
            let joint = JointPlant::new(&of.experiment.rig)?;
            steps(&joint, &of.experiment.start, Some(of.driver(&joint)?))
        });
    }
    if let Some(of) = document.joint_experiment().map_err(told)? {
        return measure_plants(|| steps(&JointPlant::new(&of.rig)?, &of.start, None));
    }
    if let Some(of) = document.controlled_experiment().map_err(told)? {
        return measure_plants(|| {
            let plant = RigPlant::new(&of.experiment.rig);
            steps(&plant, &of.experiment.start, Some(of.driver(&plant)?))
        });
    }
    let of = document.experiment().map_err(told)?;
    let cost = measure_plants(|| steps(&RigPlant::new(&of.rig), &of.start, None));
    if of.rig.actuation().is_some() && of.rig.tendon().is_none() {
        leg.get_or_insert(of.rig);
    }
    cost
}

/// Steps of a plant from its start.
fn steps<V: PlantView>(view: &V, start: &V::State, driver: Option<Driver>) -> Result<PlantSteps, Error> {
    let drivers = driver.into_iter().collect();
    Ok(PlantRun::with_drivers(view.plant(), &view.start(start), 1e-9, drivers)?.steps(METHOD))
}

/// Nanoseconds a step of a row of plants: alone, among many on one thread, and on two.
fn measure_plants(begin: impl Fn() -> Result<PlantSteps, Error>) -> Result<[f64; 3], String> {
    let batch = |rows: usize| PlantBatch::new((0..rows).map(|_| begin()).collect::<Result<_, Error>>()?);
    measure_batches(batch, |batch| {
        for step in 1..=STEPS {
            batch.advance_to(DURATION * step as f64 / STEPS as f64)?;
        }
        (0..batch.len()).try_for_each(|row| batch.row(row).map(drop))
    })
}

/// Nanoseconds a step of a row that steps by itself: alone, among many on one thread, and on two.
fn measure<S: Stepper + Send>(begin: impl Fn() -> Result<S, Error> + Sync) -> Result<[f64; 3], String> {
    let batch = |rows: usize| RowByRow::new((0..rows).map(|_| begin()).collect::<Result<Vec<S>, Error>>()?);
    measure_batches(batch, |batch| {
        batch.advance(DURATION, STEPS);
        batch.samples().into_iter().try_for_each(|sample| sample.map(drop))
    })
}

/// Nanoseconds a step of a row: alone, among many on one thread, and on two.
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

fn of_leg(rig: &Rig) -> Result<LegStepper, Error> {
    let leg = Leg { belt: None, ..Leg::small_dog() };
    let start = LegState { angles: [0.1, -0.5], rates: [0.0; 2] };
    let mut stepper = LegStepper::new(leg, start, [(rig, GaugePressure(1e5)); STRANDS], 293.15, 25.0)?;
    stepper.drive([0.5, 0.4, 0.3, 0.4, 0.25, 0.25].map(|duty| Drive::Pulses {
        duty,
        pulse: Request::Fill,
        rest: Request::Exhaust,
    }))?;
    Ok(stepper)
}
