//! What a fit costs: six numbers from ten runs of two seconds, here and by SciPy's `least_squares` around `solve_ivp`.
//!
//! `cargo run --release --bin identify`
//!
//! Ten runs of the paper's muscle under PWM of 25 Hz, at three supply pressures and several duties, are recorded every 10 ms
//! with noise. Their load neither bounces nor goes slack: else no search of whole runs would find anything from afar. Both fit
//! viscous damping, Coulomb width, flow area, external volume, load and thread length, from the same start within the same
//! bounds, on two cores. The turns are known: with them, forces, masses, volumes and flow would share a factor that neither length
//! nor pressure determines. The benchmark fails when the two optima lie further apart than [`APART`] standard
//! deviations, or their sums of squares differ.

#[expect(dead_code, reason = "the benchmark of single runs holds their errors to it")]
#[path = "problem.rs"]
mod problem;

use mckibben::simulation::simulate;
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::least_squares::{Search, Unknown};
use mckibben_identify::trajectories::{Horizon, Observed, Recorded, Sensor, Task, TimeSeries};
use mckibben_scenario::{Place, Scenario};
use problem::Problem;
use std::io::Write;
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

/// The numbers as scenario files name them, in the peer's order.
const UNKNOWNS: [&str; 6] = [
    "actuator.friction.viscous",
    "actuator.friction.coulomb_width",
    "valve.flow_area",
    "actuator.external_volume",
    "load.mass",
    "actuator.thread_length",
];
/// Start over truth.
const START: [f64; 6] = [1.5, 0.6, 1.2, 1.3, 1.05, 1.01];
/// Bounds over truth; a thread is longer than the braid.
const WITHIN: [[f64; 2]; 6] = [[0.2, 5.0], [0.2, 5.0], [0.2, 5.0], [0.2, 5.0], [0.2, 5.0], [0.95, 1.2]];
/// Readings every so many milliseconds.
const EVERY: usize = 10;
/// Noise of length in m and pressure in Pa.
const NOISE: [f64; 2] = [1e-4, 1.5e3];
/// Relative tolerance of a run, here and there.
const TOLERANCE: f64 = 1e-8;
/// How many standard deviations the optima may lie apart: SciPy's derivatives are differences of runs, and it stops that early.
const APART: f64 = 0.1;
/// By which part of itself the sum of squares may be larger there.
const WORSE: f64 = 2e-4;
const REPEATS: usize = 5;

fn main() -> ExitCode {
    match compare() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// A run's scenario: supply in psi, frequency in Hz, duty.
fn text([supply, frequency, duty]: [f64; 3]) -> String {
    format!(
        "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"{supply} psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
         [command]\nkind = \"pwm\"\nfrequency = \"{frequency} Hz\"\nduty = {duty}\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
         [initial]\ngauge_pressure = \"30 psi\"\nlength = \"92 mm\"\n[run]\nduration = \"2 s\"\n"
    )
}

const RUNS: [[f64; 3]; 10] = [
    [100.0, 25.0, 0.3],
    [100.0, 25.0, 0.4],
    [100.0, 25.0, 0.5],
    [100.0, 25.0, 0.6],
    [85.0, 25.0, 0.35],
    [85.0, 25.0, 0.55],
    [85.0, 25.0, 0.45],
    [70.0, 25.0, 0.4],
    [70.0, 25.0, 0.5],
    [70.0, 25.0, 0.6],
];

/// Of unit variance, nearly normal, the same every time.
fn noise(place: usize) -> f64 {
    let part = |root: f64| ((place as f64 + 1.0) * root.sqrt()).fract() - 0.5;
    [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0].map(part).iter().sum()
}

fn compare() -> Result<(), String> {
    let text_of = |error: &dyn std::fmt::Display| error.to_string();
    let folder = std::env::temp_dir().join(format!("mckibben-fit-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|error| text_of(&error))?;
    let (mut problems, mut runs) = (Vec::new(), Vec::new());
    for (number, run) in RUNS.into_iter().enumerate() {
        let path = folder.join("run.toml");
        std::fs::write(&path, text(run)).map_err(|error| text_of(&error))?;
        let problem = Problem::load(&path)?;
        runs.push(recorded(&problem.scenario, number)?);
        problems.push(problem);
    }
    let _ = std::fs::remove_dir_all(&folder);
    let mut base = problems[0].scenario.clone();
    let truth: Vec<f64> =
        UNKNOWNS.iter().filter_map(|path| Place::find(path, &mut base).ok()?.value(&mut base)).collect();
    let unknown = |place: usize| {
        Unknown::new(UNKNOWNS[place], "", START[place] * truth[place])
            .between(WITHIN[place][0] * truth[place], WITHIN[place][1] * truth[place])
    };
    let search = Search { known_scales: true, ..Search::default() };
    let unknowns: Vec<Unknown> = (0..UNKNOWNS.len()).map(unknown).collect();
    let task = Task { runs, unknowns, starts: Vec::new(), horizon: Horizon::Whole, search, tolerance: TOLERANCE };
    let mut best = f64::INFINITY;
    let mut found = None;
    for _ in 0..REPEATS {
        let before = Instant::now();
        found = Some(task.identify().map_err(|error| text_of(&error))?);
        best = best.min(before.elapsed().as_secs_f64());
    }
    let found = found.ok_or("no repeats")?.found.fit;
    eprintln!("here, best of {REPEATS}: {best:.3} s; now SciPy, which takes minutes");
    let (seconds, evaluations, cost, values) = peer(&problems, &task)?;
    println!("{:<34} {:>14} {:>14} {:>10}", "number", "here", "SciPy", "apart/dev");
    let mut furthest = 0.0_f64;
    for (place, estimate) in found.estimates.iter().enumerate() {
        let deviation = estimate.standard_error.ok_or_else(|| {
            format!("{} is not identifiable at {:e}: {:?}", estimate.name, estimate.value, found.unidentifiable)
        })?;
        let apart = (estimate.value - values[place]).abs() / deviation;
        furthest = furthest.max(apart);
        println!("{:<34} {:>14.6e} {:>14.6e} {apart:>10.1e}", estimate.name, estimate.value, values[place]);
    }
    println!("half the sum of squares            {:>14.6} {cost:>14.6}", found.cost);
    println!(
        "\nhere, best of {REPEATS}: {best:.3} s\nSciPy, {evaluations} evaluations of ten runs: {seconds:.1} s\nratio: {:.0}",
        seconds / best
    );
    if furthest > APART || (cost / found.cost - 1.0).abs() > WORSE {
        return Err(format!("the two do not come to one optimum: {furthest:.2e} deviations apart"));
    }
    Ok(())
}

fn recorded(scenario: &Scenario, number: usize) -> Result<Recorded, String> {
    let experiment = scenario.experiment().map_err(|error| error.to_string())?;
    let run = simulate(&experiment.rig, experiment.start, 2.0, 1e-11).map_err(|error| error.to_string())?;
    let times: Vec<f64> = (1..=2000 / EVERY).map(|place| 1e-3 * (EVERY * place) as f64).collect();
    let mut base = scenario.clone();
    let places = UNKNOWNS
        .map(|path| Place::find(path, &mut base))
        .into_iter()
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| error.to_string())?;
    let time_series = |observed, deviation: f64, read: &dyn Fn(f64) -> f64| {
        let offset = 10_000 * number + 5000 * usize::from(observed == Observed::Length);
        let values =
            times.iter().enumerate().map(|(place, time)| read(*time) + deviation * noise(offset + place)).collect();
        TimeSeries { observed, times: times.clone(), values, deviation: Some(deviation), sensor: Sensor::default() }
    };
    let atmosphere = scenario.air.atmospheric_pressure;
    let series = vec![
        time_series(Observed::Length, NOISE[0], &|time| run.at(time).length),
        time_series(Observed::GaugePressure, NOISE[1], &|time| run.at(time).pressure.0 - atmosphere),
    ];
    Ok(Recorded {
        name: format!("{number}"),
        subject: Adjustable::new(base, places, [true; 2]).into(),
        unknowns: (0..UNKNOWNS.len()).collect(),
        time_series: series,
    })
}

/// Seconds, evaluations, half the sum of squares and values of the peer.
fn peer(problems: &[Problem], task: &Task) -> Result<(f64, u64, f64, Vec<f64>), String> {
    let efficiency = problems[0].scenario.valve.as_ref().map_or(1.0, |valve| valve.efficiency);
    // The peer's area has the efficiency in it.
    let factor = |place: usize| if place == 2 { efficiency } else { 1.0 };
    let scaled = |of: &dyn Fn(&Unknown) -> f64| -> Vec<f64> {
        task.unknowns.iter().enumerate().map(|(place, unknown)| factor(place) * of(unknown)).collect()
    };
    let measured: Vec<Vec<[f64; 2]>> = task
        .runs
        .iter()
        .zip(problems)
        .map(|(run, problem)| {
            let atmosphere = problem.scenario.air.atmospheric_pressure;
            let pairs = run.time_series[0].values.iter().zip(&run.time_series[1].values);
            pairs.map(|(length, gauge)| [*length, gauge + atmosphere]).collect()
        })
        .collect();
    let input = serde_json::json!({
        "problems": problems.iter().map(Problem::text).collect::<Vec<_>>(),
        "measured": measured,
        "every": EVERY,
        "scales": NOISE,
        "start": scaled(&|unknown| unknown.start),
        "least": scaled(&|unknown| unknown.bounds[0]),
        "largest": scaled(&|unknown| unknown.bounds[1]),
    });
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let program = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/scipy_fit.py");
    let mut child = Command::new(&python)
        .arg(program)
        .args(["DOP853", &format!("{TOLERANCE:e}"), "2"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| format!("{python}: {error}; SciPy is needed: python3 -m pip install scipy"))?;
    if let Some(mut stdin) = child.stdin.take() {
        stdin.write_all(input.to_string().as_bytes()).map_err(|error| error.to_string())?;
    }
    let output = child.wait_with_output().map_err(|error| error.to_string())?;
    let text = String::from_utf8_lossy(&output.stdout);
    let mut lines = text.lines();
    let head: Vec<f64> = lines.next().unwrap_or_default().split(' ').filter_map(|word| word.parse().ok()).collect();
    let values: Vec<f64> = lines
        .filter_map(|line| line.parse().ok())
        .enumerate()
        .map(|(place, value): (usize, f64)| value / factor(place))
        .collect();
    match (&head[..], values.len() == UNKNOWNS.len()) {
        (&[seconds, evaluations, cost], true) => Ok((seconds, evaluations as u64, cost, values)),
        _ => Err("SciPy's answer cannot be read; is SciPy installed? python3 -m pip install scipy".to_owned()),
    }
}
