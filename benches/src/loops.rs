//! What a joint and a loop cost: scenario files one row at a time at fixed steps, and by the event-located engine.
//!
//! `cargo run --release --bin loops -- ../examples/antagonistic-joint.toml ../examples/control/pid.toml`
//!
//! Each file is run at steps of 0.1 ms up to at most one second, by both methods, and by the event-located engine at its own
//! tolerance. A file with a controller is run with it, and then by the command that it made: the difference is what sampling,
//! the law and the command that grows cost. Both must end in the same place: the steps of the first are
//! divided at the sampling instants besides, so the two differ by rounding.

use mckibben::plant::{JointPlant, RigPlant};
use mckibben::simulation::{
    ControlledJointStepper, ControlledStepper, FixedStepper, JointRig, JointState, JointStepper, Method, Rig, State,
    simulate,
};
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
    let told = |error: mckibben_scenario::Diagnostics| error.to_string();
    if let Some(of) = document.controlled_joint_experiment().map_err(told)? {
        return controlled_joint(&of);
    }
    if let Some(of) = document.joint_experiment().map_err(told)? {
        let open = open_joint(&of.rig, of.start, &of.run)?;
        let joint = JointPlant::new(&of.rig).map_err(|error| error.to_string())?;
        let located = located(&of.run, |until| joint.simulate(&of.start, until, of.run.relative_tolerance).map(drop))?;
        return Ok(row(open.map(|(cost, _)| cost), [f64::NAN; 2], located));
    }
    if let Some(of) = document.controlled_experiment().map_err(told)? {
        return controlled(&of);
    }
    let of = document.experiment().map_err(told)?;
    let open = open_one(&of.rig, of.start, &of.run)?;
    let located = located(&of.run, |until| simulate(&of.rig, of.start, until, of.run.relative_tolerance).map(drop))?;
    Ok(row(open.map(|(cost, _)| cost), [f64::NAN; 2], located))
}

fn controlled(of: &ControlledExperiment) -> Result<[f64; 5], String> {
    let ControlledExperiment { experiment, law, sampling, sensors, .. } = of;
    let (rig, start, run) = (&experiment.rig, experiment.start, &experiment.run);
    let (mut open, mut closed) = ([f64::NAN; 2], [f64::NAN; 2]);
    for (place, method) in METHODS.into_iter().enumerate() {
        let mut made = None;
        let (cost, end) = least(run, |times| {
            let mut stepper = ControlledStepper::new(rig, start, method, law, (*sampling, *sensors))?;
            let began = Instant::now();
            for time in times {
                stepper.advance_to(time)?;
            }
            let spent = began.elapsed().as_secs_f64();
            made = Some(stepper.rig().clone());
            Ok((spent, stepper.sample().length))
        })?;
        let replayed = open_one(&made.unwrap_or_else(|| rig.clone()), start, run)?[place];
        // The controller's own sampling instants divide its steps, so the two ends agree to rounding alone.
        same(end, replayed.1)?;
        (closed[place], open[place]) = (cost, replayed.0);
    }
    let plant = RigPlant::new(rig);
    let located = located(run, |until| {
        let driver = plant.driver(law.clone(), (*sampling, *sensors))?;
        plant.record(&start, (until, run.relative_tolerance), Some(driver), &mut |_| Ok(())).map(drop)
    })?;
    Ok(row(open, closed, located))
}

fn controlled_joint(of: &ControlledJointExperiment) -> Result<[f64; 5], String> {
    let ControlledJointExperiment { experiment, law, sampling, sensors, .. } = of;
    let (rig, start, run) = (&experiment.rig, experiment.start, &experiment.run);
    let (mut open, mut closed) = ([f64::NAN; 2], [f64::NAN; 2]);
    for (place, method) in METHODS.into_iter().enumerate() {
        let mut made = None;
        let (cost, end) = least(run, |times| {
            let mut stepper = ControlledJointStepper::new(rig, start, method, law, (*sampling, *sensors))?;
            let began = Instant::now();
            for time in times {
                stepper.advance_to(time)?;
            }
            let spent = began.elapsed().as_secs_f64();
            made = Some(stepper.rig().clone());
            Ok((spent, stepper.sample().angle))
        })?;
        let replayed = open_joint(&made.unwrap_or_else(|| rig.clone()), start, run)?[place];
        same(end, replayed.1)?;
        (closed[place], open[place]) = (cost, replayed.0);
    }
    let joint = JointPlant::new(rig).map_err(|error| error.to_string())?;
    let located = located(run, |until| {
        let driver = joint.driver(law.clone(), (*sampling, *sensors))?;
        joint.record(&start, (until, run.relative_tolerance), Some(driver), &mut |_| Ok(())).map(drop)
    })?;
    Ok(row(open, closed, located))
}

/// Nanoseconds a step and the length in m at the end, by both methods.
fn open_one(rig: &Rig, start: State, run: &Run) -> Result<[(f64, f64); 2], String> {
    let of = |method| {
        least(run, |times| {
            let mut stepper = FixedStepper::new(rig, start, method);
            let began = Instant::now();
            for time in times {
                stepper.advance_to(time)?;
            }
            Ok((began.elapsed().as_secs_f64(), stepper.sample().length))
        })
    };
    Ok([of(METHODS[0])?, of(METHODS[1])?])
}

/// Nanoseconds a step and the angle in rad at the end, by both methods.
fn open_joint(rig: &JointRig, start: JointState, run: &Run) -> Result<[(f64, f64); 2], String> {
    let of = |method| {
        let stepper = JointStepper::new(rig.clone(), method).map_err(|error| error.to_string())?;
        least(run, |times| {
            let mut course = stepper.begin(start);
            let began = Instant::now();
            for time in times {
                stepper.advance_to(&mut course, time)?;
            }
            Ok((began.elapsed().as_secs_f64(), course.state().angle))
        })
    };
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
