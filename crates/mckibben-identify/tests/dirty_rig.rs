//! A rig as rigs are: a muscle that creeps, lengths that are late, off by session and rounded to the steps of a sensor, pressures
//! that are held and noisy. What is looked for lies within its interval in 95 of 100 records.

use crate::noise::{HITS, Noise, TRIALS, coverage, holds};
use mckibben::simulation::simulate;
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::least_squares::{Search, Unknown};
use mckibben_identify::trajectories::{Amount, Horizon, Observed, Recorded, Sensor, Task, TimeSeries};
use mckibben_scenario::{Place, Scenario};

const DURATION: f64 = 0.4;
const ATMOSPHERE: f64 = 101_325.0;
/// Noise of a length in m and a pressure in Pa; the step of the length's sensor, the interval of the pressure's, and how late lengths are.
const NOISE: [f64; 2] = [4e-5, 500.0];
const STEP: f64 = 2e-5;
const HOLD: f64 = 0.01;
const SHIFT: f64 = 5e-3;
const OFFSETS: [f64; 2] = [1.2e-3, -0.7e-3];
const UNKNOWNS: [&str; 2] = ["actuator.friction.viscous", "actuator.friction.viscoelastic.stiffness_ratio[0]"];
const TRUTH: [f64; 2] = [6.0, 0.2];

fn scenario(session: usize) -> Scenario {
    let (supply, duty) = [(100, 0.35), (80, 0.45)][session];
    let text = format!(
        "[actuator]\npreset = \"colbrunn-2001\"\n[actuator.friction]\nviscous = \"6 N*s/m\"\ncoulomb_width = \"0 m\"\n\
         [actuator.friction.viscoelastic]\nrelaxation_time = [\"0.2 s\"]\nstiffness_ratio = [0.2]\n\
         [supply]\ngauge_pressure = \"{supply} psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
         [command]\nkind = \"pwm\"\nfrequency = \"5 Hz\"\nduty = {duty}\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
         [initial]\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"0.4 s\"\n"
    );
    Scenario::from_str(&text, "muscle.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// The run of a session, recorded without noise: lengths and gauge pressures.
fn clean(session: usize) -> (Vec<f64>, [Vec<f64>; 2]) {
    let experiment = scenario(session).experiment().expect("an experiment");
    let run = simulate(&experiment.rig, experiment.start, DURATION, 1e-10).expect("a run");
    let times: Vec<f64> = (1..=80).map(|step| DURATION * f64::from(step) / 80.0).collect();
    let length = |time: &f64| run.at((time - SHIFT).max(0.0)).length + OFFSETS[session];
    let pressure = |time: &f64| run.at(HOLD * (time / HOLD + 1e-9).floor()).pressure.0 - ATMOSPHERE;
    let time_series = [times.iter().map(length).collect(), times.iter().map(pressure).collect()];
    (times, time_series)
}

fn recorded(session: usize, (times, [lengths, pressures]): &(Vec<f64>, [Vec<f64>; 2]), noise: &mut Noise) -> Recorded {
    let mut base = scenario(session);
    let places: Vec<Place> = UNKNOWNS.iter().map(|path| Place::find(path, &mut base).expect("a number")).collect();
    let shown: Vec<f64> =
        noise.added_to(lengths, NOISE[0]).into_iter().map(|length| STEP * (length / STEP).round()).collect();
    let late = Sensor { offset: Amount::Unknown(3 + session), shift: Amount::Unknown(2), ..Sensor::default() };
    let held = Sensor { hold: Some(HOLD), ..Sensor::default() };
    let series =
        |observed, values, sensor| TimeSeries { observed, times: times.clone(), values, deviation: None, sensor };
    Recorded {
        name: format!("session {session}"),
        subject: Adjustable::new(base, places, [false; 2]).into(),
        unknowns: vec![0, 1],
        time_series: vec![
            series(Observed::Length, shown, late),
            series(Observed::GaugePressure, noise.added_to(pressures, NOISE[1]), held),
        ],
    }
}

#[test]
fn intervals_hold_the_truth_of_a_dirty_rig() {
    let records = [0, 1].map(clean);
    let hits = coverage(|seed| {
        let mut noise = Noise::new(1000 + seed);
        let runs = (0..2).map(|session| recorded(session, &records[session], &mut noise)).collect();
        let unknown = |name: &str, start: f64, low: f64, high: f64| Unknown::new(name, "", start).between(low, high);
        let unknowns = vec![
            unknown(UNKNOWNS[0], 5.0, 0.1, 50.0),
            unknown(UNKNOWNS[1], 0.15, 0.0, 2.0),
            unknown("shift", 3e-3, -0.05, 0.05),
            unknown("offset of one", 0.0, -0.02, 0.02),
            unknown("offset of two", 0.0, -0.02, 0.02),
        ];
        let search = Search::default();
        let task = Task { runs, unknowns, starts: Vec::new(), horizon: Horizon::Whole, search, tolerance: 1e-7 };
        let estimates = task.identify().unwrap_or_else(|error| panic!("{seed}: {error}")).found.fit.estimates;
        let truth = [TRUTH[0], TRUTH[1], SHIFT, OFFSETS[0], OFFSETS[1]];
        std::array::from_fn::<bool, 5, _>(|place| holds(&estimates[place], truth[place]))
    });
    for (place, hits) in hits.into_iter().enumerate() {
        assert!(HITS.contains(&hits), "{place}: {hits} of {TRIALS}");
    }
}
