//! What a step of many actuators whose ends a host moves costs in Rust: each as a scalar instance (`PlantSteps::move_to`), and all in lanes
//! (`PlantBatch::move_to`), the reference for `mckibben.Actuators` of the Python package.
//!
//! `cargo run --release --bin modular -- ../examples/paper/fig-12.toml 4096 200`
//!
//! A requested number of actuators of the file is stepped on all cores (`RAYON_NUM_THREADS` says how many) as
//! `benches/python/overhead.py` does: steps of 1 ms, a duty cycle and a length for each row, the ends going to and fro. The
//! least of several repeats is printed in ns for a row; for one actuator also with what a state that is a value costs: going
//! back to a state before the step, and saving one after it.

use mckibben::plant::{Plant, PlantRun, PlantSteps};
use mckibben::simulation::Method;
use mckibben::valve::{Command, RuntimeCommand};
use mckibben_batch::PlantBatch;
use mckibben_scenario::Document;
use rayon::prelude::*;
use std::hint::black_box;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

/// Step in s.
const STEP: f64 = 1e-3;
/// Rows that a thread takes together at least.
const TOGETHER: usize = 32;
const REPEATS: usize = 5;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Option<Vec<usize>> = arguments.iter().skip(1).map(|word| word.parse().ok()).collect();
    let (Some(file), Some([count, steps])) = (arguments.first(), numbers.as_deref()) else {
        eprintln!("usage: modular FILE ROWS STEPS");
        return ExitCode::from(2);
    };
    match measure(file, *count, *steps) {
        Ok(Measured { plain, lanes, kept }) => {
            let kept = kept.map_or_else(|| "null".into(), |kept| format!("{kept:.3}"));
            println!("{{\"ns\": {plain:.3}, \"ns_in_lanes\": {lanes:.3}, \"ns_with_snapshots\": {kept}}}");
            ExitCode::SUCCESS
        }
        Err(text) => {
            eprintln!("{text}");
            ExitCode::FAILURE
        }
    }
}

/// The command to a row, and where its ends go: the same in `benches/python/overhead.py`.
struct Row {
    commanded: RuntimeCommand,
    length: [f64; 2],
}

impl Row {
    fn of(place: usize, pulses: impl Fn(f64) -> RuntimeCommand) -> Self {
        let length = 0.075 + 0.015 * (place % 61) as f64 / 60.0;
        Self { commanded: pulses(0.2 + 0.6 * (place % 97) as f64 / 96.0), length: [length, length + 2e-5] }
    }

    /// Takes one step; the tension in N after it, at the velocity of the ends.
    fn step(&self, actuator: &mut PlantSteps, turn: usize) -> Result<f64, mckibben::Error> {
        actuator.set(0, self.commanded)?;
        actuator.move_to(actuator.time() + STEP, &[self.length[turn]])?;
        Ok(actuator.compute(0)?.tension)
    }
}

/// Nanoseconds for a row's step: as scalar instances, in lanes, and as a scalar instance whose state the caller keeps.
struct Measured {
    plain: f64,
    lanes: f64,
    kept: Option<f64>,
}

fn measure(file: &str, count: usize, steps: usize) -> Result<Measured, String> {
    let document = Document::load(Path::new(file)).map_err(|error| error.to_string())?;
    let experiment = document.experiment().map_err(|error| error.to_string())?;
    let rig = &experiment.rig;
    let Some(&Command::Pwm { frequency, pulse, rest, .. }) = rig.actuation().map(|drive| &drive.command) else {
        return Err(format!("{file}: this measurement pulses the valve, so the file needs command.kind = \"pwm\""));
    };
    let external = Plant::of_rig(rig).to_external(&Plant::start_of_rig(rig, &experiment.start));
    let begun = external.and_then(|(plant, start)| PlantRun::new(&plant, &start, 1e-9));
    let actuator = begun.map_err(|error| error.to_string())?.steps(Method::Stable);
    let pulses = |duty| RuntimeCommand::Pulses { frequency, duty, pulse, rest };
    let rows: Vec<Row> = (0..count).map(|place| Row::of(place, pulses)).collect();
    let mut least = f64::INFINITY;
    let mut alone = vec![0.0; count];
    for _ in 0..REPEATS {
        let mut actuators = vec![actuator.clone(); count];
        let mut tension = vec![0.0; count];
        let began = Instant::now();
        for step in 0..steps {
            let one = |(actuator, (row, tension)): (&mut PlantSteps, (&Row, &mut f64))| {
                *tension = row.step(actuator, step % 2)?;
                Ok(())
            };
            let done: Result<(), mckibben::Error> = if count == 1 {
                actuators.iter_mut().zip(rows.iter().zip(&mut tension)).try_for_each(one)
            } else {
                let together = actuators.par_iter_mut().zip(rows.par_iter().zip(&mut tension));
                together.with_min_len(TOGETHER).try_for_each(one)
            };
            done.map_err(|error| error.to_string())?;
        }
        let spent = began.elapsed().as_secs_f64();
        black_box(&tension);
        alone.copy_from_slice(&tension);
        least = least.min(1e9 * spent / (count * steps) as f64);
    }
    let (lanes, together) =
        in_lanes(&vec![actuator.clone(); count], &rows, steps).map_err(|error| error.to_string())?;
    assert!(alone == together, "lanes have the tensions of rows alone, to the bit");
    let kept = match rows.as_slice() {
        [row] => Some(with_snapshots(&actuator, row, steps).map_err(|error| error.to_string())?),
        _ => None,
    };
    Ok(Measured { plain: least, lanes, kept })
}

/// Nanoseconds for a row's step in lanes, and the tensions in N at the end.
fn in_lanes(actuators: &[PlantSteps], rows: &[Row], steps: usize) -> Result<(f64, Vec<f64>), mckibben::Error> {
    let (mut least, mut tension) = (f64::INFINITY, vec![0.0; rows.len()]);
    for _ in 0..REPEATS {
        let mut batch = PlantBatch::new(actuators.to_vec())?;
        let (mut distances, mut rates) = (vec![0.0; rows.len()], vec![0.0; rows.len()]);
        let mut before: Vec<f64> =
            (0..rows.len()).map(|row| batch.row(row).map(|row| row.state()[0])).collect::<Result<_, _>>()?;
        let began = Instant::now();
        for step in 0..steps {
            let until = batch.time() + STEP;
            for (row, distance) in distances.iter_mut().enumerate() {
                *distance = rows[row].length[step % 2];
                rates[row] = (*distance - before[row]) / (until - batch.time());
            }
            batch.set_each(0, |row| Some(rows[row].commanded)).map_err(|(_, error)| error)?;
            batch.move_to(until, &distances)?;
            batch.compute_at(&distances, &rates)?;
            for (row, tension) in tension.iter_mut().enumerate() {
                *tension = batch.responses(row)?[0].tension;
            }
            before.copy_from_slice(&distances);
        }
        least = least.min(1e9 * began.elapsed().as_secs_f64() / (rows.len() * steps) as f64);
    }
    Ok((least, tension))
}

/// Nanoseconds for a step of one actuator whose state the caller keeps.
fn with_snapshots(actuator: &PlantSteps, row: &Row, steps: usize) -> Result<f64, mckibben::Error> {
    let mut least = f64::INFINITY;
    for _ in 0..REPEATS {
        let mut desk = actuator.clone();
        let mut kept = Box::new(desk.save());
        let began = Instant::now();
        for step in 0..steps {
            desk.restore(&kept)?;
            black_box(row.step(&mut desk, step % 2)?);
            kept = black_box(Box::new(desk.save()));
        }
        black_box(&kept);
        least = least.min(1e9 * began.elapsed().as_secs_f64() / steps as f64);
    }
    Ok(least)
}
