//! What a law costs: the scenario files of the command line in batches and by the event-located engine, relative to the
//! first.
//!
//! `cargo run --release --bin laws -- ../examples/paper/fig-12.toml ../examples/friction/stribeck.toml`
//!
//! Each file is run as 64 equal rows on one core, at steps of 0.1 ms up to at most one second, by both methods, and once by
//! the event-located engine at its own tolerance, whose end the rows must come to: how near is printed, and a row that is
//! further off than a thousandth of the muscle's length fails the benchmark. Lengths are distances between the ends.

use mckibben::plant::{Plant, PlantRun};
use mckibben::simulation::{Method, simulate};
use mckibben_batch::PlantBatch;
use mckibben_scenario::{Document, Experiment};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

const ROWS: usize = 64;
const STEP: f64 = 1e-4;
const LONGEST: f64 = 1.0;
const REPEATS: usize = 5;
/// Difference of the lengths at the end, over the longest length, that is refused.
const REFUSED: f64 = 1e-3;

fn main() -> ExitCode {
    let files: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "{:<44} {:>10} {:>6} {:>10} {:>6} {:>12} {:>9}",
        "file", "RK4 ns", "ratio", "stable ns", "ratio", "located us/s", "apart"
    );
    let mut first = None;
    for file in &files {
        match measure(file) {
            Ok(cost) => {
                let base = *first.get_or_insert(cost.steps);
                let [rk4, stable] = cost.steps;
                println!(
                    "{file:<44} {rk4:>10.1} {:>6.2} {stable:>10.1} {:>6.2} {:>12.0} {:>9.1e}",
                    rk4 / base[0],
                    stable / base[1],
                    cost.located,
                    cost.apart
                );
            }
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
    /// Nanoseconds a step and row, by RK4 and by the stable method.
    steps: [f64; 2],
    /// Microseconds of the event-located engine for a second.
    located: f64,
    /// How far apart the engines are at the end, as a part of the longest length.
    apart: f64,
}

fn measure(file: &str) -> Result<Cost, String> {
    let document = Document::load(Path::new(file)).map_err(|failure| failure.to_string())?;
    let Experiment { rig, start, run } = document.experiment().map_err(|failure| failure.to_string())?;
    let duration = run.duration.min(LONGEST);
    let steps = (duration / STEP).round().max(1.0) as u64;
    let mut located = f64::INFINITY;
    let mut reference = f64::NAN;
    for _ in 0..REPEATS {
        let began = Instant::now();
        let trajectory = simulate(&rig, start, duration, run.relative_tolerance).map_err(|error| error.to_string())?;
        located = located.min(began.elapsed().as_secs_f64());
        reference = trajectory.at(duration).load_distance;
    }
    let mut cost = Cost { steps: [f64::INFINITY; 2], located: located / duration * 1e6, apart: 0.0 };
    for (place, method) in [Method::Rk4, Method::Stable].into_iter().enumerate() {
        for _ in 0..REPEATS {
            let (plant, begin) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
            let row = PlantRun::new(&plant, &begin, 1e-9).map_err(|error| error.to_string())?.steps(method);
            let mut batch = PlantBatch::new(vec![row; ROWS]).map_err(|error| error.to_string())?;
            let began = Instant::now();
            batch.advance(duration, steps).map_err(|error| error.to_string())?;
            let each = began.elapsed().as_secs_f64() / (steps as f64 * ROWS as f64);
            cost.steps[place] = cost.steps[place].min(each * 1e9);
            let end = batch.row(0).map_err(|error| error.to_string())?.sample();
            let apart = (end.actuators[0].distance - reference).abs() / rig.actuator().limits().max_length();
            if apart.is_nan() || apart > REFUSED {
                return Err(format!("the {method:?} method ends {apart:e} of the longest length off"));
            }
            cost.apart = cost.apart.max(apart);
        }
    }
    Ok(cost)
}
