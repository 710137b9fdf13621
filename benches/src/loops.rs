//! What a joint and a loop cost: scenario files one row at a time at fixed steps, and by the event-located engine.
//!
//! `cargo run --release --bin loops -- ../examples/antagonistic-joint.toml ../examples/control/pid.toml`
//!
//! Each file is run at steps of 0.1 ms up to at most one second, by both methods, and by the event-located engine at its own
//! tolerance. A file with a controller is run with it, and then by the command that it made: the difference is what sampling,
//! the law and the command that grows cost. Both must end in the same place: the steps of the first are
//! divided at the sampling instants besides, so the two differ by rounding.

use mckibben::command::Driver;
use mckibben::plant::{JointPlant, PlantRun, PlantView, RigPlant, TimeStepping};
use mckibben::simulation::{JointRig, JointState, Method, Rig, State, simulate};
use mckibben_scenario::{ControlledExperiment, ControlledJointExperiment, Document, Run};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

const STEP: f64 = 1e-4;
const LONGEST: f64 = 1.0;
const REPEATS: usize = 5;
const METHODS: [Method; 2] = [Method::Rk4, Method::Stable];

fn main() -> ExitCode {
    let columns = ["RK4 ns", "stable ns", "loop RK4", "loop stable", "located us/s"];
    println!("{:<44}{}", "file", columns.map(|name| format!("{name:>14}")).concat());
    for file in std::env::args().skip(1) {
        match measure(&file) {
            Ok(cost) => println!("{file:<44}{}", cost.map(|value| format!("{value:>14.1}")).concat()),
            Err(text) => {
                eprintln!("{file}: {text}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

/// Nanoseconds a step by RK4 and by the stable method, the same with the controller (not a number without one), and
/// microseconds of the event-located engine for a second.
fn measure(file: &str) -> Result<[f64; 5], String> {
    let document = Document::load(Path::new(file)).map_err(|error| error.to_string())?;
    let message = |error: mckibben_scenario::Diagnostics| error.to_string();
    if let Some(of) = document.controlled_joint_experiment().map_err(message)? {
        return controlled_joint(&of);
    }
    if let Some(of) = document.joint_experiment().map_err(message)? {
        let open = of_joint(&of.rig, of.start, &of.run)?;
        let joint = JointPlant::new(&of.rig).map_err(|error| error.to_string())?;
        let located = located(&of.run, |until| joint.simulate(&of.start, until, of.run.relative_tolerance).map(drop))?;
        return Ok(row(open.map(|(cost, _)| cost), [f64::NAN; 2], located));
    }
    if let Some(of) = document.controlled_experiment().map_err(message)? {
        return controlled(&of);
    }
    let of = document.experiment().map_err(message)?;
    let open = of_rig(&of.rig, of.start, &of.run)?;
    let located = located(&of.run, |until| simulate(&of.rig, of.start, until, of.run.relative_tolerance).map(drop))?;
    Ok(row(open.map(|(cost, _)| cost), [f64::NAN; 2], located))
}

fn controlled(of: &ControlledExperiment) -> Result<[f64; 5], String> {
    let ControlledExperiment { experiment, .. } = of;
    let (start, run) = (experiment.start, &experiment.run);
    let plant = RigPlant::new(&experiment.rig);
    let (mut open, mut closed) = ([f64::NAN; 2], [f64::NAN; 2]);
    for (place, method) in METHODS.into_iter().enumerate() {
        let (cost, end) = least(run, |times| stepped(&plant, &start, method, Some(of.driver(&plant)?), times))?;
        // What it made as a command, from a run that is kept.
        let fixed = TimeStepping::Fixed { method, step: STEP };
        let duration = run.duration.min(LONGEST);
        let made =
            of.driver(&plant).and_then(|driver| plant.record(&start, (duration, fixed), Some(driver), &mut |_| Ok(())));
        let replayed = of_rig(made.map_err(|error| error.to_string())?.rig(), start, run)?[place];
        // The controller's own sampling instants divide its steps, so the two ends agree to rounding alone.
        same(end, replayed.1)?;
        (closed[place], open[place]) = (cost, replayed.0);
    }
    let located = located(run, |until| {
        let driver = of.driver(&plant)?;
        plant.record(&start, (until, run.relative_tolerance), Some(driver), &mut |_| Ok(())).map(drop)
    })?;
    Ok(row(open, closed, located))
}

fn controlled_joint(of: &ControlledJointExperiment) -> Result<[f64; 5], String> {
    let ControlledJointExperiment { experiment, .. } = of;
    let (start, run) = (experiment.start, &experiment.run);
    let joint = JointPlant::new(&experiment.rig).map_err(|error| error.to_string())?;
    let (mut open, mut closed) = ([f64::NAN; 2], [f64::NAN; 2]);
    for (place, method) in METHODS.into_iter().enumerate() {
        let (cost, end) = least(run, |times| stepped(&joint, &start, method, Some(of.driver(&joint)?), times))?;
        let fixed = TimeStepping::Fixed { method, step: STEP };
        let duration = run.duration.min(LONGEST);
        let made =
            of.driver(&joint).and_then(|driver| joint.record(&start, (duration, fixed), Some(driver), &mut |_| Ok(())));
        let replayed = of_joint(made.map_err(|error| error.to_string())?.rig(), start, run)?[place];
        same(end, replayed.1)?;
        (closed[place], open[place]) = (cost, replayed.0);
    }
    let located = located(run, |until| {
        let driver = of.driver(&joint)?;
        joint.record(&start, (until, run.relative_tolerance), Some(driver), &mut |_| Ok(())).map(drop)
    })?;
    Ok(row(open, closed, located))
}

/// Seconds through the ends of the steps, and the first state at the end.
fn stepped<V: PlantView>(
    view: &V,
    start: &V::State,
    method: Method,
    driver: Option<Driver>,
    times: Times<'_>,
) -> Result<(f64, f64), mckibben::Error> {
    let fixed = TimeStepping::Fixed { method, step: STEP };
    let drivers = driver.into_iter().collect();
    let mut steps = PlantRun::with_drivers(view.plant(), &view.start(start), fixed, drivers)?.steps(method);
    let began = Instant::now();
    for time in times {
        steps.advance_to(time)?;
    }
    Ok((began.elapsed().as_secs_f64(), steps.state()[0]))
}

/// Nanoseconds a step and the first state at the end, by both methods.
fn of_rig(rig: &Rig, start: State, run: &Run) -> Result<[(f64, f64); 2], String> {
    let plant = RigPlant::new(rig);
    let of = |method| least(run, |times| stepped(&plant, &start, method, None, times));
    Ok([of(METHODS[0])?, of(METHODS[1])?])
}

/// Nanoseconds a step and the first state at the end, by both methods.
fn of_joint(rig: &JointRig, start: JointState, run: &Run) -> Result<[(f64, f64); 2], String> {
    let joint = JointPlant::new(rig).map_err(|error| error.to_string())?;
    let of = |method| least(run, |times| stepped(&joint, &start, method, None, times));
    Ok([of(METHODS[0])?, of(METHODS[1])?])
}

type Times<'t> = &'t mut dyn Iterator<Item = f64>;

/// The least nanoseconds a step of several runs through the ends of the steps, and what a run ends with.
fn least(
    run: &Run,
    mut go: impl FnMut(Times<'_>) -> Result<(f64, f64), mckibben::Error>,
) -> Result<(f64, f64), String> {
    let duration = run.duration.min(LONGEST);
    let steps = (duration / STEP).round().max(1.0) as u64;
    let (mut cost, mut end) = (f64::INFINITY, f64::NAN);
    for _ in 0..REPEATS {
        let mut times = (1..=steps).map(|step| duration * (step as f64 / steps as f64));
        let (spent, reached) = go(&mut times).map_err(|error| error.to_string())?;
        cost = cost.min(spent / steps as f64 * 1e9);
        end = reached;
    }
    Ok((cost, end))
}

/// The least microseconds of the event-located engine for a second.
fn located(run: &Run, mut go: impl FnMut(f64) -> Result<(), mckibben::Error>) -> Result<f64, String> {
    let duration = run.duration.min(LONGEST);
    let mut cost = f64::INFINITY;
    for _ in 0..REPEATS {
        let began = Instant::now();
        go(duration).map_err(|error| error.to_string())?;
        cost = cost.min(began.elapsed().as_secs_f64() / duration * 1e6);
    }
    Ok(cost)
}

fn row([rk4, stable]: [f64; 2], [loop_rk4, loop_stable]: [f64; 2], located: f64) -> [f64; 5] {
    [rk4, stable, loop_rk4, loop_stable, located]
}

/// Refuses a replay that ends elsewhere.
fn same(closed: f64, replayed: f64) -> Result<(), String> {
    let apart = (closed - replayed).abs();
    if apart <= 1e-9 { Ok(()) } else { Err(format!("the replayed command ends {apart:e} off")) }
}
