//! Time series: parameters put in come back out, with honest intervals, and what cannot be found says so.

use crate::noise::{Noise, holds};
use mckibben::plant::JointPlant;
use mckibben::simulation::{JointSample, simulate};
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::least_squares::{Ending, Loss, Search, Unknown};
use mckibben_identify::trajectories::{
    Horizon, Identified, Observed, Recorded, Sampling, Sensor, Subject, Task, TimeSeries, TrajectoryError,
};
use mckibben_scenario::{Effectiveness, Load, Place, PressurePlace, PressureSensor, PressureSeries, Scenario};

/// The paper's muscle under pulses at a pressure of the supply in psi, from 40 psi.
fn scenario(supply: f64) -> Scenario {
    pulsed(supply, 12.0, 0.45)
}

/// A scenario under pulses at a frequency in Hz and a duty cycle.
fn pulsed(supply: f64, frequency: f64, duty: f64) -> Scenario {
    let text = format!(
        "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"{supply} psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
         [command]\nkind = \"pwm\"\nfrequency = \"{frequency} Hz\"\nduty = {duty}\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
         [initial]\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"0.4 s\"\n"
    );
    Scenario::from_str(&text, "muscle.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// A run as a rig would record it, with noise in m and Pa.
fn recorded(truth: &Scenario, paths: &[&str], deviations: [f64; 2], duration: f64) -> Recorded {
    let experiment = truth.experiment().unwrap_or_else(|error| panic!("{error}"));
    let run = simulate(&experiment.rig, experiment.start, duration, 1e-10).expect("a run");
    let times: Vec<f64> = (1..=200).map(|step| duration * f64::from(step) / 200.0).collect();
    let [length, pressure] = deviations;
    let mut noise = Noise::new(1);
    let lengths: Vec<f64> = times.iter().map(|time| run.at(*time).length).collect();
    let gauge = |time: f64| run.at(time).pressure.0 - truth.air.atmospheric_pressure;
    let pressures: Vec<f64> = times.iter().map(|time| gauge(*time)).collect();
    let series = |observed, values: Vec<f64>| TimeSeries {
        observed,
        times: times.clone(),
        values,
        deviation: None,
        sensor: Sensor::default(),
    };
    let time_series = vec![
        series(Observed::Length, noise.added_to(&lengths, length)),
        series(Observed::GaugePressure, noise.added_to(&pressures, pressure)),
    ];
    let mut base = truth.clone();
    let places: Vec<Place> = paths.iter().map(|path| Place::find(path, &mut base).expect("a number")).collect();
    Recorded {
        name: format!("{} Pa", truth.supply.map_or(0.0, |supply| supply.gauge_pressure)),
        subject: Adjustable::new(base, places, [false; 2]).into(),
        unknowns: (0..paths.len()).collect(),
        time_series,
    }
}

/// The scenario of a run.
fn base_of(run: &Recorded) -> Scenario {
    match &run.subject {
        Subject::Scenario(of) => of.base().clone(),
        Subject::Plant(_) => panic!("a scenario"),
    }
}

/// Looks for numbers from `factor` times their true values.
fn task(runs: Vec<Recorded>, paths: &[&str], factor: f64) -> Task {
    let mut base = base_of(&runs[0]);
    let unknown = |path: &&str| {
        let value = Place::find(path, &mut base).expect("a number").value(&mut base).expect("a value");
        Unknown::new(*path, "", factor * value).between(0.05 * value, 20.0 * value)
    };
    let unknowns = paths.iter().map(unknown).collect();
    Task { runs, unknowns, starts: Vec::new(), horizon: Horizon::Whole, search: Search::default(), tolerance: 1e-9 }
}

const UNKNOWNS: [&str; 4] =
    ["actuator.friction.viscous", "actuator.friction.coulomb_width", "valve.flow_area", "valve.opening_delay"];

fn truth_of(task: &Task) -> Vec<f64> {
    let mut base = base_of(&task.runs[0]);
    task.unknowns
        .iter()
        .map(|unknown| Place::find(&unknown.name, &mut base).expect("one").value(&mut base).expect("a value"))
        .collect()
}

fn identified(task: &Task) -> Identified {
    task.identify().unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn numbers_put_in_come_back_out() {
    let runs = [100.0, 70.0].map(|psi| recorded(&scenario(psi), &UNKNOWNS, [0.0; 2], 0.4));
    let task = task(runs.to_vec(), &UNKNOWNS, 1.3);
    let found = identified(&task);
    for (estimate, truth) in found.found.fit.estimates.iter().zip(truth_of(&task)) {
        // The recording is good to a relative 1e-10 a step, the fit to 1e-9.
        assert!((estimate.value / truth - 1.0).abs() < 1e-5, "{}: {} is not {truth}", estimate.name, estimate.value);
    }
    assert!(found.found.fit.unidentifiable.is_empty());
    assert_eq!(found.scenarios.len(), 2);
    found.scenarios[1].scenario().expect("one").experiment().expect("a scenario that runs");
}

#[test]
fn noise_is_estimated_for_each_quantity_and_intervals_contain_the_truth() {
    let deviations = [5e-5, 2e3];
    let runs = [100.0, 70.0].map(|psi| recorded(&scenario(psi), &UNKNOWNS, deviations, 0.4));
    let task = task(runs.to_vec(), &UNKNOWNS, 1.2);
    let found = identified(&task);
    for (estimate, truth) in found.found.fit.estimates.iter().zip(truth_of(&task)) {
        let off = (estimate.value - truth).abs() / estimate.standard_error.expect("a deviation");
        assert!(off < 4.0, "{}: {off} deviations", estimate.name);
        assert!(estimate.standard_error.expect("one") < 0.2 * truth, "{estimate:?}");
    }
    for ((observed, left), deviation) in found.left.iter().zip(deviations) {
        // Of 400 readings: a twentieth is one and a half standard deviations.
        assert!((left / deviation - 1.0).abs() < 0.1, "{observed:?}: {left}, not {deviation}");
    }
}

/// From some starts the fit by spans ends in one valley and the next in another, which leaves other residuals: from twice the mass a
/// seventh. Quantities are weighed until the scales are what is left, in whatever valley a search ends.
#[test]
fn weights_follow_what_is_left() {
    for factor in [0.3, 1.0, 2.0, 4.0] {
        let runs = vec![recorded(&scenario(100.0), &["load.mass"], [3e-5, 300.0], 0.4)];
        let found = identified(&task(runs, &["load.mass"], factor));
        assert!(found.unsettled.is_empty(), "{factor}: {:?}", found.unsettled);
        for ((observed, left), (_, scale)) in found.left.iter().zip(&found.scales) {
            assert!((left / scale - 1.0).abs() < 0.11, "{factor}: {observed:?} leaves {left}, weighed by {scale}");
        }
    }
}

/// Mass, turns, flow and friction are not identifiable from length and pressure alone: all of them scale with 1/n²
/// together.
#[test]
fn what_scales_together_is_named() {
    let paths = ["load.mass", "actuator.turns", "actuator.friction.viscous", "valve.flow_area"];
    let mut truth = scenario(100.0);
    // Other parts with a fixed scale are removed: hose, taut braid.
    truth.actuator.friction.coulomb_width = 0.0;
    truth.actuator.external_volume = 1e-12;
    let run = recorded(&truth, &paths, [0.0; 2], 0.4);
    let found =
        identified(&Task { search: Search { most_steps: 400, ..Search::default() }, ..task(vec![run], &paths, 1.0) });
    let names: Vec<&str> = found
        .found
        .fit
        .unidentifiable
        .iter()
        .flat_map(|direction| &direction.shares)
        .map(|(name, _)| name.as_str())
        .collect();
    for name in paths {
        assert!(names.contains(&name), "{name} is not among {names:?}; condition {}", found.found.fit.condition);
    }
    assert!(found.found.fit.estimates.iter().all(|estimate| estimate.confidence_interval.is_none()));
}

#[test]
fn a_growing_horizon_finds_what_the_whole_does_not() {
    // A sealed muscle swings: with turns that are far off the oscillation falls out of step.
    let text = "[actuator]\npreset = \"colbrunn-2001\"\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
                [initial]\ngauge_pressure = \"60 psi\"\nlength = \"88 mm\"\n[run]\nduration = \"0.4 s\"\n";
    let truth = Scenario::from_str(text, "muscle.toml").unwrap_or_else(|error| panic!("{error}"));
    let paths = ["load.mass", "actuator.friction.viscous"];
    let mut far = task(vec![recorded(&truth, &paths, [0.0; 2], 0.4)], &paths, 1.0);
    far.unknowns[0].start *= 6.0;
    let value = truth_of(&far);
    let whole = far.identify().map(|found| found.found.fit.values());
    let lost = whole.as_ref().map_or(true, |values| (values[0] / value[0] - 1.0).abs() > 0.01);
    assert!(lost, "the whole is found from afar too: {whole:?}");
    far.horizon = Horizon::Growing(vec![0.03, 0.08, 0.2]);
    let values = identified(&far).found.fit.values();
    for (found, value) in values.iter().zip(value) {
        assert!((found / value - 1.0).abs() < 1e-4, "{found} is not {value}");
    }
}

#[test]
fn what_cannot_be_fitted_says_why() {
    let run = recorded(&scenario(100.0), &UNKNOWNS, [0.0; 2], 0.4);
    let with = |change: fn(&mut Task)| {
        let mut task = task(vec![run.clone()], &UNKNOWNS, 1.1);
        change(&mut task);
        task.identify().expect_err("bad")
    };
    assert_eq!(with(|task| task.runs[0].time_series.clear()), TrajectoryError::NoReadings);
    let error = with(|task| task.runs[0].time_series[1].times[3] = 0.0);
    assert!(error.to_string().contains("gauge pressure of the run"), "{error}");
    let error = with(|task| task.runs[0].time_series[0].values[3] = f64::NAN);
    assert!(error.to_string().contains("length of sample 4 is not a finite number"), "{error}");
    let error = with(|task| task.unknowns[0].start = -1.0);
    assert!(
        matches!(error, TrajectoryError::AtStart { .. }) && error.to_string().contains("actuator.friction.viscous"),
        "{error}"
    );
    let paths = ["actuator.wall_thickness"];
    let mut silent = task(vec![recorded(&scenario(100.0), &paths, [0.0; 2], 0.4)], &paths, 1.0);
    silent.unknowns[0] = Unknown::new(paths[0], "m", 0.0);
    let error = silent.identify().expect_err("silent").to_string();
    assert!(
        error.contains("`actuator.wall_thickness` = 0 m switches its part off") && error.contains("such as 1e-6 m"),
        "{error}"
    );
    // Pulses of 37 ms vanish behind a delay of 60 ms.
    let paths = ["valve.opening_delay"];
    let mut vanished = task(vec![recorded(&scenario(100.0), &paths, [0.0; 2], 0.4)], &paths, 1.0);
    vanished.unknowns[0] = Unknown::new(paths[0], "s", 0.06);
    let error = vanished.identify().expect_err("no pulse").to_string();
    assert!(error.contains("longer than its pulses never moves; start below the shortest pulse"), "{error}");
}

/// Whenever a search is ended from another thread, it returns the best values so far, with what is drawn of them.
/// Two readings of each quantity, of which the first is that of the start, let a search end anywhere.
#[test]
fn fewer_readings_than_parameters_are_refused() {
    let paths = ["actuator.friction.viscous", "valve.flow_area"];
    let mut run = recorded(&scenario(100.0), &paths, [0.0; 2], 0.4);
    for series in &mut run.time_series {
        // At 0.1 s the muscle moves; a reading at zero is that of the start.
        series.times = vec![0.0, series.times[49]];
        series.values = vec![series.values[0], series.values[49]];
    }
    let error = task(vec![run.clone()], &paths, 1.2).identify().expect_err("two of four readings").to_string();
    assert!(error.contains("2 of 4 readings depend on the 2 parameters of [fit]"), "{error}");
    assert!(error.contains("readings end at 0.1 s"), "{error}");
    for series in &mut run.time_series {
        series.times.truncate(1);
        series.values.truncate(1);
    }
    let error = task(vec![run], &paths, 1.2).identify().expect_err("only the start").to_string();
    assert!(error.contains("readings end at 0 s: there are no readings after the start"), "{error}");
}

#[test]
fn an_interrupted_search_has_values_no_worse_than_its_start() {
    let run = recorded(&scenario(100.0), &UNKNOWNS, [5e-5, 2e3], 0.4);
    let horizons = [Horizon::Whole, Horizon::Growing(vec![0.1, 0.2]), Horizon::Segments(0.1)];
    for (horizon, evaluations) in horizons.into_iter().flat_map(|of| [3, 12].map(|count| (of.clone(), count))) {
        let mut paths = task(vec![run.clone()], &UNKNOWNS, 1.3);
        paths.horizon = horizon.clone();
        paths.starts = vec![vec![1.0; UNKNOWNS.len()]; 1000];
        let monitor = paths.search.monitor.clone();
        let found = std::thread::scope(|scope| {
            scope.spawn(|| {
                while monitor.evaluations() < evaluations {
                    std::thread::yield_now();
                }
                monitor.stop();
            });
            identified(&paths)
        });
        assert_eq!(found.stopped, Some(Ending::Interrupted));
        // A thousand starts are still searched from by the spans of the readings.
        assert!(horizon != Horizon::Whole || found.weighed_by_spans, "{evaluations}");
        assert_eq!(found.simulated.len(), 1);
        assert!(paths.held_out(&found).is_empty());
        let start: Vec<f64> = paths.unknowns.iter().map(|unknown| unknown.start).collect();
        let of = |values: &[f64]| -> f64 {
            let built = run.subject.clone();
            let sampling =
                Sampling { observed: vec![Observed::Length], times: run.time_series[0].times.clone(), tolerance: 1e-9 };
            let lengths = sampling.values(&built, values, &|_| Ok(())).expect("a run");
            lengths.iter().zip(&run.time_series[0].values).map(|(a, b)| (a - b).powi(2)).sum()
        };
        // In segments the joints give way first: there the values are only those that had been reached.
        let values = found.found.fit.values();
        let is_whole = horizon == Horizon::Whole;
        assert!(!is_whole || of(&values) <= 1.01 * of(&start), "{horizon:?}: {values:?}");
        assert!(values.iter().all(|value| value.is_finite() && *value > 0.0));
    }
}

/// A load that goes slack and bounces at every pulse: a change of its mass by 10⁻⁴ gives another trajectory after a
/// second.
fn bouncing() -> Recorded {
    let truth = pulsed(100.0, 10.0, 0.35);
    let deviations = [1e-4, 1.5e3];
    let mut run = recorded(&truth, &BOUNCING, deviations, 1.5);
    for (series, deviation) in run.time_series.iter_mut().zip(deviations) {
        series.deviation = Some(deviation);
    }
    run
}

const BOUNCING: [&str; 4] = ["actuator.friction.viscous", "valve.flow_area", "load.mass", "actuator.external_volume"];

#[test]
fn segments_find_what_a_whole_run_hides() {
    let mut paths = task(vec![bouncing()], &BOUNCING, 1.1);
    // The whole run: a valley far from the truth, which may have a kink for a bottom; both are said.
    let whole = identified(&paths);
    assert!(whole.left[0].1 > 1e-3, "{:?}", whole.left);
    let unexplained = paths.unexplained(&whole);
    assert!(unexplained.iter().any(|rest| rest.observed == Observed::Length), "{unexplained:?}");
    let has_intervals = whole.found.fit.estimates.iter().any(|of| of.confidence_interval.is_some());
    assert_eq!(has_intervals, whole.found.fit.ending == Ending::Minimum, "{:?}", whole.found.fit);
    paths.horizon = Horizon::Segments(0.1);
    let found = paths.identify().unwrap_or_else(|error| panic!("{error}"));
    for (estimate, unknown) in found.found.fit.estimates.iter().zip(&paths.unknowns) {
        let (truth, deviation) = (unknown.start / 1.1, estimate.standard_error.expect("a deviation"));
        assert!((estimate.value - truth).abs() < 4.0 * deviation, "{estimate:?}: {truth}");
        assert!(deviation < 0.02 * truth, "{estimate:?}");
    }
    assert!(paths.unexplained(&found).is_empty());
    paths.horizon = Horizon::Segments(2.0);
    let refused = paths.identify().expect_err("longer than the run");
    assert!(refused.to_string().contains("segments of 2 s do not divide a run of 1.5 s"), "{refused}");
}

/// A load that is lifted and let down once, from rest to rest: a small change of its mass is a small change of the end.
fn calm() -> Recorded {
    let text = "[actuator]\npreset = \"colbrunn-2001\"\n[actuator.friction]\nviscous = \"4 N*s/m\"\ncoulomb_width = \"0.1 mm\"\n\
                [supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"fill-hold-exhaust\"\nflow_area = \"0.2 mm^2\"\n\
                opening_delay = \"4 ms\"\nclosing_delay = \"1 ms\"\n[command]\nkind = \"table\"\n\
                time = [\"0 s\", \"0.08 s\", \"0.3 s\", \"0.33 s\"]\nstate = [\"fill\", \"hold\", \"exhaust\", \"hold\"]\n\
                [load]\nkind = \"hanging-mass\"\nmass = \"3 kg\"\n[initial]\ngauge_pressure = \"2 bar\"\n[run]\nduration = \"0.6 s\"\n";
    let truth = Scenario::from_str(text, "rig.toml").unwrap_or_else(|error| panic!("{error}"));
    recorded(&truth, &CALM, [2e-5, 300.0], 0.6)
}

const CALM: [&str; 2] = ["actuator.friction.viscous", "load.mass"];

/// Twelve initial states of four segments explain 1.4 % more of this noise than the whole run; by chance they explain 12 of 400 parts.
#[test]
fn initial_states_that_explain_no_more_than_chance_are_not_taken() {
    for known in [true, false] {
        let mut run = calm();
        for (series, deviation) in run.time_series.iter_mut().zip([2e-5, 300.0]) {
            series.deviation = known.then_some(deviation);
        }
        let mut paths = task(vec![run], &CALM, 1.1);
        let whole = identified(&paths);
        paths.horizon = Horizon::Segments(0.15);
        let found = identified(&paths);
        assert_eq!(found.segments, None);
        for (of, expected) in found.found.fit.estimates.iter().zip(&whole.found.fit.estimates) {
            let error = expected.standard_error.expect("a standard error");
            assert!((of.value - expected.value).abs() < 0.01 * error, "{of:?}: {expected:?}");
            assert!((of.standard_error.expect("one") / error - 1.0).abs() < 0.01, "{of:?}: {expected:?}");
        }
    }
}

#[test]
fn a_sensor_that_drifts_is_named() {
    let mut run = recorded(&scenario(100.0), &UNKNOWNS, [2e-5, 1e3], 0.4);
    let pressure = &mut run.time_series[1];
    let ramp = pressure.times.iter().map(|time| 2e4 * time / 0.4);
    pressure.values = pressure.values.iter().zip(ramp).map(|(value, drift)| value + drift).collect();
    let paths = task(vec![run], &UNKNOWNS, 1.0);
    let found = paths.identify().unwrap_or_else(|error| panic!("{error}"));
    let drifts = paths.drifts(&found);
    assert!(drifts.iter().any(|drift| drift.observed == Observed::GaugePressure && drift.change > 5e3), "{drifts:?}");
    let steady = task(vec![recorded(&scenario(100.0), &UNKNOWNS, [2e-5, 1e3], 0.4)], &UNKNOWNS, 1.0);
    let found = steady.identify().unwrap_or_else(|error| panic!("{error}"));
    assert!(steady.drifts(&found).is_empty() && steady.unexplained(&found).is_empty());
}

#[test]
fn a_run_that_was_left_out_is_predicted() {
    let deviations = [2e-5, 1e3];
    let runs = [100.0, 85.0, 70.0].map(|psi| recorded(&scenario(psi), &UNKNOWNS, deviations, 0.4));
    let right = task(runs.to_vec(), &UNKNOWNS, 1.0);
    let found = right.identify().unwrap_or_else(|error| panic!("{error}"));
    let held_out = right.held_out(&found);
    assert_eq!(held_out.len(), 3);
    for (observed, [inside, outside]) in held_out.iter().flat_map(|run| &run.errors) {
        let noise = deviations[observed.index().expect("one of two")];
        // The noise of 200 readings has a standard deviation of 5 %; a run that was left out is not predicted better than its noise.
        assert!((0.8..1.2).contains(&(inside / noise)), "{observed:?} {inside}");
        assert!((0.8..1.5).contains(&(outside / noise)), "{observed:?} {outside}");
    }
    assert!(task(runs[..1].to_vec(), &UNKNOWNS, 1.0).held_out(&found).is_empty());
}

const STATIC: [&str; 2] = ["actuator.friction.viscous", "actuator.effectiveness.constant"];

/// A run of a muscle on a valve whose pressure was measured, with noise in m and Pa; the scenario knows nothing of the valve.
fn driven_by_its_pressure(supply: f64, [length, pressure]: [f64; 2]) -> Recorded {
    let mut truth = scenario(supply);
    truth.actuator.effectiveness = Effectiveness::Constant(0.87);
    let mut run = recorded(&truth, &STATIC, [length, 0.0], 0.4);
    let experiment = truth.experiment().expect("an experiment");
    let series = simulate(&experiment.rig, experiment.start, 0.4, 1e-10).expect("a run");
    let time: Vec<f64> = (0..=3200).map(|step| 0.4 * f64::from(step) / 3200.0).collect();
    let gauge = |time: &f64| series.at(*time).pressure.0 - truth.air.atmospheric_pressure;
    let gauges: Vec<f64> = time.iter().map(gauge).collect();
    let gauge_pressure = Noise::new(5).added_to(&gauges, pressure);
    (truth.valve, truth.supply, truth.command) = (None, None, None);
    truth.pressure =
        Some(PressureSeries { at: PressurePlace::Muscle, time, gauge_pressure, sensor: PressureSensor::default() });
    run.time_series.retain(|series| series.observed == Observed::Length);
    let places: Vec<Place> = STATIC.iter().map(|path| Place::find(path, &mut truth).expect("a number")).collect();
    Recorded { subject: Adjustable::new(truth, places, [false; 2]).into(), ..run }
}

#[test]
fn a_measured_pressure_stands_for_the_valve_that_made_it() {
    let runs = [100.0, 70.0].map(|psi| driven_by_its_pressure(psi, [2e-5, 0.0]));
    let task = task(runs.to_vec(), &STATIC, 1.2);
    let found = identified(&task);
    for (estimate, truth) in found.found.fit.estimates.iter().zip(truth_of(&task)) {
        let deviation = estimate.standard_error.expect("a deviation");
        assert!((estimate.value - truth).abs() < 4.0 * deviation && deviation < 0.02 * truth, "{estimate:?}: {truth}");
    }
    // Noise of the pressure goes into the force, of which the intervals do not know.
    let noisy = self::task(vec![driven_by_its_pressure(100.0, [2e-5, 3e2])], &STATIC, 1.2);
    for (estimate, truth) in identified(&noisy).found.fit.estimates.iter().zip(truth_of(&noisy)) {
        assert!((estimate.value / truth - 1.0).abs() < 0.02, "{estimate:?}: {truth}");
    }
}

#[test]
fn each_run_may_have_a_separate_parameter() {
    let paths = ["actuator.friction.viscous", "load.mass"];
    let deviations = [2e-5, 1e3];
    let masses = [1.8, 2.2, 2.7];
    let runs = masses.map(|mass| {
        let mut truth = scenario(100.0);
        truth.load = Load::HangingMass { mass, gravity: 9.80665 };
        recorded(&truth, &paths, deviations, 0.4)
    });
    let mut task = task(runs.to_vec(), &paths, 1.2);
    let mass = task.unknowns.remove(1);
    for (place, run) in (1..).zip(&mut task.runs) {
        task.unknowns.push(Unknown { name: format!("load.mass [{place}]"), ..mass.clone() });
        run.unknowns = vec![0, place];
    }
    let found = identified(&task);
    let viscous = truth_of(&self::task(runs.to_vec(), &paths[..1], 1.0))[0];
    let truths = [viscous, masses[0], masses[1], masses[2]];
    for (estimate, truth) in found.found.fit.estimates.iter().zip(truths) {
        let deviation = estimate.standard_error.expect("a deviation");
        assert!((estimate.value - truth).abs() < 4.0 * deviation && deviation < 0.03 * truth, "{estimate:?}: {truth}");
    }
    for (scenario, mass) in found.scenarios.iter().zip(&found.found.fit.values()[1..]) {
        assert!(matches!(&scenario.scenario().expect("one").load, Load::HangingMass { mass: own, .. } if own == mass));
    }
    // A run that was left out determines its own mass, and the others the friction.
    let held_out = task.held_out(&found);
    assert_eq!(held_out.len(), 3);
    for (observed, [_, outside]) in held_out.iter().flat_map(|run| &run.errors) {
        assert!(
            (0.8..1.5).contains(&(outside / deviations[observed.index().expect("one of two")])),
            "{observed:?} {outside}"
        );
    }
}

/// A forearm between two of the paper's muscles, each with a separate valve, from a gauge pressure in the antagonist in psi.
fn joint(antagonist: f64) -> Scenario {
    let text = format!(
        "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"60 psi\"\n\
         [valve]\npreset = \"matrix-eight-channel\"\nkind = \"fill-hold-exhaust\"\n\
         [command]\nkind = \"table\"\ntime = [\"0 s\", \"60 ms\", \"0.25 s\", \"0.31 s\"]\nstate = [\"fill\", \"hold\", \"exhaust\", \"hold\"]\n\
         [load]\nkind = \"antagonistic-joint\"\npulley_radius = \"15 mm\"\nrest_length = \"3.3 in\"\nmass = \"0.5 kg\"\n\
         distance = \"100 mm\"\ninertia = \"2e-3 kg*m^2\"\ndamping = \"0.02 N*m*s/rad\"\n[initial]\ngauge_pressure = \"20 psi\"\n\
         [antagonist]\ninitial.gauge_pressure = \"{antagonist} psi\"\nactuator.turns = 2.4\n\
         [antagonist.command]\nkind = \"table\"\ntime = [\"0 s\", \"0.25 s\", \"0.31 s\"]\nstate = [\"hold\", \"fill\", \"hold\"]\n\
         [run]\nduration = \"0.5 s\"\n"
    );
    Scenario::from_str(&text, "joint.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// The readings of a joint, with the standard deviation of each.
const OF_JOINT: [(Observed, f64); 3] =
    [(Observed::Angle, 1e-3), (Observed::GaugePressure, 1e3), (Observed::AntagonistGaugePressure, 1e3)];

const OF_BOTH: [&str; 4] = ["load.inertia", "load.damping", "actuator.turns", "antagonist.actuator.turns"];

/// A run of a joint as a rig would record it.
fn recorded_joint(truth: &Scenario, paths: &[&str], seed: u64) -> Recorded {
    let of = truth.joint_experiment().unwrap_or_else(|error| panic!("{error}")).expect("a joint");
    let run = JointPlant::new(&of.rig).and_then(|joint| joint.simulate(&of.start, 0.5, 1e-10)).expect("a run");
    let times: Vec<f64> = (1..=200).map(|step| 2.5e-3 * f64::from(step)).collect();
    let mut noise = Noise::new(seed);
    let gauge = |sample: &JointSample, i: usize| sample.actuators[i].pressure.0 - truth.air.atmospheric_pressure;
    let time_series = OF_JOINT.map(|(observed, deviation)| {
        let of = |time: &f64| match (&observed, run.at(*time)) {
            (Observed::Angle, sample) => sample.angle,
            (Observed::GaugePressure, sample) => gauge(&sample, 0),
            (_, sample) => gauge(&sample, 1),
        };
        let values: Vec<f64> = times.iter().map(of).collect();
        TimeSeries {
            observed,
            times: times.clone(),
            values: noise.added_to(&values, deviation),
            deviation: None,
            sensor: Sensor::default(),
        }
    });
    let mut base = truth.clone();
    let places: Vec<Place> = paths.iter().map(|path| Place::find(path, &mut base).expect("a number")).collect();
    Recorded {
        name: format!("seed {seed}"),
        subject: Adjustable::new(base, places, [false; 2]).into(),
        unknowns: (0..paths.len()).collect(),
        time_series: time_series.to_vec(),
    }
}

#[test]
fn a_joint_gives_back_its_limb_and_both_braids() {
    let paths: Vec<&str> = OF_BOTH.into_iter().chain(["antagonist.initial.gauge_pressure"]).collect();
    let starts = [20.0, 26.0];
    let runs = [0, 1].map(|run| recorded_joint(&joint(starts[run]), &paths, 11 + run as u64));
    // The antagonist's pressure at the start is each run's own.
    let mut task = task(runs.to_vec(), &paths, 1.25);
    task.unknowns[3].start /= 1.4;
    let own = task.unknowns.pop().expect("a pressure");
    for (place, run) in (4..).zip(&mut task.runs) {
        task.unknowns.push(Unknown { name: format!("{} [{place}]", own.name), ..own.clone() });
        run.unknowns = vec![0, 1, 2, 3, place];
    }
    let found = identified(&task);
    let psi = 6_894.757_293_168;
    let mut first = joint(starts[0]);
    let value = |path: &&str| Place::find(path, &mut first).expect("a number").value(&mut first).expect("a value");
    let truths: Vec<f64> = OF_BOTH.iter().map(value).chain(starts.map(|of| of * psi)).collect();
    for (estimate, truth) in found.found.fit.estimates.iter().zip(&truths) {
        assert!(holds(estimate, *truth), "{estimate:?}: {truth}");
        assert!((estimate.value / truth - 1.0).abs() < 0.02, "{estimate:?}: {truth}");
    }
    assert!(
        found.found.fit.unidentifiable.is_empty()
            && task.drifts(&found).is_empty()
            && task.unexplained(&found).is_empty()
    );
    let [angle, agonist, antagonist] = OF_JOINT;
    for ((observed, left), (of, deviation)) in found.left.iter().zip([agonist, angle, antagonist]) {
        assert!(*observed == of && (left / deviation - 1.0).abs() < 0.1, "{observed:?}: {left}, not {deviation}");
    }
    for (scenario, simulated) in found.scenarios.iter().zip(&found.simulated) {
        let of =
            scenario.scenario().expect("a joint's").joint_experiment().expect("a scenario that runs").expect("a joint");
        let again =
            JointPlant::new(&of.rig).and_then(|joint| joint.simulate(&of.start, 0.5, 1e-9)).expect("a run").at(0.4);
        assert!((simulated.read(&Observed::Angle, 0.4) - again.angle).abs() < 1e-7);
        assert!((simulated.read(&Observed::AntagonistLength, 0.4) - again.actuators[1].length).abs() < 1e-8);
        assert!((simulated.read(&Observed::Torque, 0.4) - again.torque).abs() < 1e-5);
    }
    // Each run is predicted from the parameters of the other and its own pressure at the start.
    let held_out = task.held_out(&found);
    assert_eq!(held_out.len(), 2);
    for (observed, [_, outside]) in held_out.iter().flat_map(|run| &run.errors) {
        let (_, noise) = OF_JOINT.into_iter().find(|(of, _)| of == observed).expect("what was read");
        assert!((0.8..1.5).contains(&(outside / noise)), "{observed:?} {outside}");
    }
}

#[test]
fn a_number_of_both_actuators_is_fitted_as_one() {
    let mut truth = joint(20.0);
    let path = "actuator.thread_length";
    let thread = Place::find(path, &mut truth).expect("a number").of_both();
    let mut run = recorded_joint(&truth, &[path], 3);
    run.subject = Adjustable::new(truth.clone(), vec![thread], [false, true]).into();
    let mut paths = task(vec![run], &[path], 1.05);
    paths.search = Search { loss: Loss::Huber(2.5), ..paths.search };
    for (series, (_, deviation)) in paths.runs[0].time_series.iter_mut().zip(OF_JOINT) {
        series.deviation = Some(deviation);
    }
    let value = thread.value(&mut truth).expect("a value");
    // A reading that is far off: a robust loss spares it.
    paths.runs[0].time_series[0].values[50] += 0.2;
    let found = identified(&paths);
    let estimate = &found.found.fit.estimates[0];
    assert!(holds(estimate, value) && (estimate.value / value - 1.0).abs() < 1e-3, "{estimate:?}: {value}");
    let Load::AntagonisticJoint(joint) = &found.scenarios[0].scenario().expect("a joint's").load else {
        panic!("a joint")
    };
    let (first, second) = (&found.scenarios[0].scenario().expect("a joint's").actuator, &joint.antagonist.actuator);
    assert_eq!([first.thread_length, second.thread_length], [estimate.value; 2]);
    // Where the file does not give the least length it follows.
    let least = estimate.value / 3_f64.sqrt();
    assert!((first.min_length / least - 1.0).abs() < 1e-12, "{}", first.min_length);
    assert_eq!(second.min_length, truth.actuator.min_length);
}

#[test]
fn what_a_joint_cannot_do_says_why() {
    let rig = recorded(&scenario(100.0), &UNKNOWNS, [0.0; 2], 0.4);
    let mut paths = task(vec![rig], &UNKNOWNS, 1.0);
    paths.runs[0].time_series[0].observed = Observed::Angle;
    let error = paths.identify().expect_err("a rig has no angle").to_string();
    assert!(error.contains("readings of the angle") && error.contains("\"antagonistic-joint\""), "{error}");
    let mut paths = task(vec![recorded_joint(&joint(20.0), &OF_BOTH, 1)], &OF_BOTH, 1.0);
    paths.horizon = Horizon::Segments(0.1);
    let error = paths.identify().expect_err("segments").to_string();
    assert!(
        error.contains("a run in segments is not implemented for an antagonistic joint")
            && error.contains("search.horizon"),
        "{error}"
    );
    paths.horizon = Horizon::Whole;
    paths.unknowns[0].start = -1.0;
    let error = paths.identify().expect_err("no inertia").to_string();
    assert!(error.contains("load.inertia"), "{error}");
}
