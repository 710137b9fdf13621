//! What a step of many modular actuators costs in Rust: what `mckibben.Actuators` of the Python package is measured beside.
//!
//! `cargo run --release --bin modular -- ../examples/paper/fig-12.toml 4096 200`
//!
//! As many actuators of the file as asked for are stepped on all cores (`RAYON_NUM_THREADS` says how many) as
//! `benches/python/overhead.py` does: steps of 1 ms, a duty cycle and a length for each row, the ends going to and fro. The
//! least of several repeats is printed in ns for a row; for one actuator also with what a state that is a value costs: going
//! back to a snapshot before the step, and taking one after it; and as a plant whose ends a host moves (`PlantSteps::move_to`).

use mckibben::control::Drive;
use mckibben::plant::{Plant, PlantRun};
use mckibben::simulation::{Method, ModularActuator, Rig, State};
use mckibben::valve::{Command, Demand, Request};
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
        Ok((plain, alone)) => {
            let [kept, plant] = [0, 1].map(|k| alone.map_or_else(|| "null".into(), |alone| format!("{:.3}", alone[k])));
            println!("{{\"ns\": {plain:.3}, \"ns_with_snapshots\": {kept}, \"ns_as_plant\": {plant}}}");
            ExitCode::SUCCESS
        }
        Err(text) => {
            eprintln!("{text}");
            ExitCode::FAILURE
        }
    }
}

/// What is asked of a row, and where its ends go: the same in `benches/python/overhead.py`.
struct Row {
    duty: f64,
    length: [f64; 2],
}

impl Row {
    fn of(place: usize) -> Self {
        let length = 0.075 + 0.015 * (place % 61) as f64 / 60.0;
        Self { duty: 0.2 + 0.6 * (place % 97) as f64 / 96.0, length: [length, length + 2e-5] }
    }

    fn velocity(&self, turn: usize) -> f64 {
        let [short, long] = self.length;
        let way = if turn == 0 { short - long } else { long - short };
        way / STEP
    }
}

/// Nanoseconds for a row's step; for a row alone also with snapshots before and after, and as a plant.
fn measure(file: &str, count: usize, steps: usize) -> Result<(f64, Option<[f64; 2]>), String> {
    let document = Document::load(Path::new(file)).map_err(|error| error.to_string())?;
    let experiment = document.experiment().map_err(|error| error.to_string())?;
    let Some(Command::Pwm { frequency, pulse, rest, .. }) = experiment.rig.actuation().map(|drive| &drive.command)
    else {
        return Err(format!("{file}: this measurement pulses the valve, so the file needs command.kind = \"pwm\""));
    };
    let (pulse, rest): (Request, Request) = (*pulse, *rest);
    let actuator =
        ModularActuator::new(&experiment.rig, experiment.start, *frequency).map_err(|error| error.to_string())?;
    let rows: Vec<Row> = (0..count).map(Row::of).collect();
    let drive = |duty: f64| Drive::Pulses { duty, pulse, rest };
    let mut least = f64::INFINITY;
    for _ in 0..REPEATS {
        let mut actuators = vec![actuator.clone(); count];
        let mut tension = vec![0.0; count];
        let began = Instant::now();
        for step in 0..steps {
            let turn = step % 2;
            let one = |(actuator, (row, tension)): (&mut ModularActuator, (&Row, &mut f64))| {
                actuator.drive(drive(row.duty))?;
                actuator.move_to(actuator.time() + STEP, row.length[turn])?;
                *tension = actuator.respond(row.velocity(turn)).tension;
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
        least = least.min(1e9 * spent / (count * steps) as f64);
    }
    let alone = match rows.as_slice() {
        [row] => {
            let demand = Demand::Pulses { frequency: *frequency, duty: row.duty, pulse, rest };
            let both = with_snapshots(&actuator, row, steps, drive)
                .and_then(|kept| Ok([kept, as_plant(&experiment.rig, &experiment.start, row, steps, demand)?]));
            Some(both.map_err(|error| error.to_string())?)
        }
        _ => None,
    };
    Ok((least, alone))
}

/// The actuator as a plant whose ends a host moves. Its pulses are set once: they come from the first on until it is set anew.
fn as_plant(rig: &Rig, start: &State, row: &Row, steps: usize, demand: Demand) -> Result<f64, mckibben::Error> {
    let (plant, start) = Plant::of_rig(rig).to_external(&Plant::start_of_rig(rig, start))?;
    let begun = PlantRun::new(&plant, &start, 1e-9)?.steps(Method::Stable);
    let mut least = f64::INFINITY;
    for _ in 0..REPEATS {
        let mut host = begun.clone();
        host.set(0, demand)?;
        let began = Instant::now();
        for step in 0..steps {
            host.move_to(host.time() + STEP, &[row.length[step % 2]])?;
            black_box(host.compute(0)?.tension);
        }
        least = least.min(1e9 * began.elapsed().as_secs_f64() / steps as f64);
    }
    Ok(least)
}

/// The same of one actuator whose state somebody else keeps.
fn with_snapshots(
    actuator: &ModularActuator,
    row: &Row,
    steps: usize,
    drive: impl Fn(f64) -> Drive,
) -> Result<f64, mckibben::Error> {
    let mut least = f64::INFINITY;
    for _ in 0..REPEATS {
        let mut desk = actuator.clone();
        let mut kept = Box::new(desk.snapshot());
        let began = Instant::now();
        for step in 0..steps {
            let turn = step % 2;
            desk.restore(&kept);
            desk.drive(drive(row.duty))?;
            desk.move_to(desk.time() + STEP, row.length[turn])?;
            black_box(desk.respond(row.velocity(turn)).tension);
            kept = black_box(Box::new(desk.snapshot()));
        }
        black_box(&kept);
        least = least.min(1e9 * began.elapsed().as_secs_f64() / steps as f64);
    }
    Ok(least)
}
