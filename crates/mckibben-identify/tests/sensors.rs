//! Sensors with an offset, a drift, a scale, a shift, a lag, and samples that are held: what is put in comes back out, with the
//! parameters of the scenario.

use crate::noise::{Noise, holds};
use mckibben::simulation::simulate;
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::least_squares::{Loss, Search, Unknown};
use mckibben_identify::trajectories::{
    AMOUNTS, Amount, Horizon, Identified, Observed, Recorded, Sensor, Task, TimeSeries,
};
use mckibben_scenario::{Place, Scenario};

const DURATION: f64 = 0.6;
const ATMOSPHERE: f64 = 101_325.0;

/// The paper's muscle that lifts a mass under pulses; without dry friction, so that nothing is hidden by sticking.
fn scenario(supply: f64) -> Scenario {
    let text = format!(
        "[actuator]\npreset = \"colbrunn-2001\"\n[actuator.friction]\nviscous = \"6 N*s/m\"\ncoulomb_width = \"0 m\"\n\
         [supply]\ngauge_pressure = \"{supply} psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
         [command]\nkind = \"pwm\"\nfrequency = \"6 Hz\"\nduty = 0.4\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
         [initial]\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"0.6 s\"\n"
    );
    Scenario::from_str(&text, "muscle.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// A sensor in plain numbers, by which a test dirties what it records; in the order of [`AMOUNTS`].
#[derive(Clone, Copy)]
struct Dirt {
    amounts: [f64; 5],
    hold: Option<f64>,
    base: f64,
}

const CLEAN: Dirt = Dirt { amounts: [0.0, 0.0, 1.0, 0.0, 0.0], hold: None, base: 0.0 };

impl Dirt {
    /// What is read at times of a quantity: the lag by backward Euler with a hundred thousand steps.
    fn read(&self, times: &[f64], of: impl Fn(f64) -> f64) -> Vec<f64> {
        let [offset, drift, scale, shift, lag] = self.amounts;
        let step = 1.5 * DURATION / 1e5;
        let mut lagged = vec![of(0.0)];
        for count in 1..=100_000_u32 {
            let last = lagged[count as usize - 1];
            let part = if lag > 0.0 { step / (lag + step) } else { 1.0 };
            lagged.push(last + part * (of(f64::from(count) * step) - last));
        }
        let read = |time: &f64| {
            let taken = self.hold.map_or(*time, |interval| interval * (time / interval + 1e-9).floor());
            let source = (taken - shift).max(0.0);
            let quantity = match lag > 0.0 {
                false => of(source),
                true => {
                    let place = (source / step) as usize;
                    let part = source / step - place as f64;
                    lagged[place] + part * (lagged[place + 1] - lagged[place])
                }
            };
            scale * (quantity + self.base) - self.base + offset + drift * time
        };
        times.iter().map(read).collect()
    }

    /// The sensor with some of its numbers looked for, from the unknown `first` on.
    fn sensor(&self, names: &[&str], first: usize) -> Sensor {
        let mut sensor = Sensor { hold: self.hold, base: self.base, ..Sensor::default() };
        for ((amount, name), number) in sensor.amounts_mut().into_iter().zip(AMOUNTS).zip(self.amounts) {
            *amount = match names.iter().position(|of| *of == name) {
                Some(place) => Amount::Unknown(first + place),
                None => Amount::Known(number),
            };
        }
        sensor
    }
}

/// Records a run by two sensors, with noise of standard deviations in m and Pa.
fn recorded(supply: f64, paths: &[&str], dirt: [(Dirt, Sensor); 2], deviations: [f64; 2]) -> Recorded {
    let mut truth = scenario(supply);
    let experiment = truth.experiment().expect("an experiment");
    let run = simulate(&experiment.rig, experiment.start, 1.5 * DURATION, 1e-11).expect("a run");
    let times: Vec<f64> = (1..=300).map(|step| DURATION * f64::from(step) / 300.0).collect();
    let mut noise = Noise::new(7 + supply as u64);
    let quantities: [(Observed, &dyn Fn(f64) -> f64); 2] = [
        (Observed::Length, &|time| run.at(time).length),
        (Observed::GaugePressure, &|time| run.at(time).pressure.0 - ATMOSPHERE),
    ];
    let time_series =
        quantities.into_iter().zip(dirt).zip(deviations).map(|(((observed, of), (dirt, sensor)), deviation)| {
            let values = noise.added_to(&dirt.read(&times, of), deviation);
            TimeSeries { observed, times: times.clone(), values, deviation: None, sensor }
        });
    let time_series = time_series.collect();
    let places: Vec<Place> = paths.iter().map(|path| Place::find(path, &mut truth).expect("a number")).collect();
    Recorded {
        name: format!("{supply} psi"),
        subject: Adjustable::new(truth, places, [false; 2]).into(),
        unknowns: (0..paths.len()).collect(),
        time_series,
    }
}

fn identified(runs: Vec<Recorded>, unknowns: Vec<Unknown>) -> Identified {
    let search = Search::default();
    let task = Task { runs, unknowns, starts: Vec::new(), horizon: Horizon::Whole, search, tolerance: 1e-9 };
    task.identify().unwrap_or_else(|error| panic!("{error}"))
}

fn unknown(name: &str, start: f64, bounds: [f64; 2]) -> Unknown {
    Unknown::new(name, "", start).between(bounds[0], bounds[1])
}

const VISCOUS: &str = "actuator.friction.viscous";

#[test]
fn what_a_sensor_does_comes_back_out_with_the_damping() {
    let length = Dirt { amounts: [2e-3, 1e-3, 1.02, 6e-3, 4e-3], ..CLEAN };
    let pressure = Dirt { amounts: [-3e3, 0.0, 1.0, -2e-3, 0.0], ..CLEAN };
    let sensors = [
        (length, length.sensor(&["offset", "drift", "scale", "shift", "lag"], 1)),
        (pressure, pressure.sensor(&["offset", "shift"], 6)),
    ];
    let runs = [100.0, 75.0].map(|supply| recorded(supply, &[VISCOUS], sensors, [0.0; 2])).to_vec();
    let unknowns = vec![
        unknown(VISCOUS, 4.0, [0.5, 50.0]),
        unknown("offset", 0.0, [-0.02, 0.02]),
        unknown("drift", 0.0, [-0.02, 0.02]),
        unknown("scale", 1.0, [0.5, 2.0]),
        unknown("shift", 0.0, [-0.05, 0.05]),
        unknown("lag", 1e-3, [0.0, 0.1]),
        unknown("pressure offset", 0.0, [-1e5, 1e5]),
        unknown("pressure shift", 0.0, [-0.05, 0.05]),
    ];
    let found = identified(runs, unknowns);
    let truth = [6.0, 2e-3, 1e-3, 1.02, 6e-3, 4e-3, -3e3, -2e-3];
    // What backward Euler of the test leaves of a lag is half a step, 4.5 µs.
    let within = [2e-2, 5e-6, 5e-6, 5e-5, 1e-5, 1e-5, 50.0, 1e-5];
    for ((estimate, truth), within) in found.found.fit.estimates.iter().zip(truth).zip(within) {
        assert!((estimate.value - truth).abs() < within, "{}: {} is not {truth}", estimate.name, estimate.value);
    }
}

#[test]
fn each_run_may_have_an_offset_and_intervals_cover_the_noise() {
    let dirt = |offset: f64| Dirt { amounts: [offset, 0.0, 1.0, 4e-3, 0.0], ..CLEAN };
    let run = |supply: f64, offset: f64, own: usize| {
        let dirt = dirt(offset);
        let mut sensor = dirt.sensor(&["shift"], 1);
        sensor.offset = Amount::Unknown(own);
        recorded(supply, &[VISCOUS], [(dirt, sensor), (CLEAN, Sensor::default())], [3e-5, 300.0])
    };
    let runs = vec![run(100.0, 1e-3, 2), run(75.0, -5e-4, 3)];
    let unknowns = vec![
        unknown(VISCOUS, 4.0, [0.5, 50.0]),
        unknown("shift", 0.0, [-0.05, 0.05]),
        unknown("offset [100 psi]", 0.0, [-0.02, 0.02]),
        unknown("offset [75 psi]", 0.0, [-0.02, 0.02]),
    ];
    let task = Task {
        runs: runs.clone(),
        unknowns: unknowns.clone(),
        starts: Vec::new(),
        horizon: Horizon::Whole,
        search: Search::default(),
        tolerance: 1e-9,
    };
    let found = task.identify().expect("a fit");
    for (estimate, truth) in found.found.fit.estimates.iter().zip([6.0, 4e-3, 1e-3, -5e-4]) {
        let error = estimate.standard_error.expect("a standard error");
        assert!((estimate.value - truth).abs() < 4.0 * error, "{}: {} is not {truth}", estimate.name, estimate.value);
    }
    // Each run left out in turn has its own offset from itself, and the shift from the other.
    let held_out = task.held_out(&found);
    assert_eq!(held_out.len(), 2);
    for of_run in &held_out {
        let (_, [inside, outside]) = &of_run.errors[0];
        assert!(*outside < 1.2 * inside && *inside < 4e-5, "{of_run:?}");
    }
    // What the model says that the sensor reads is within the noise of what it read.
    let series = &task.runs[0].time_series[0];
    let fitted = (&found.simulated[0], &found.found.fit.values()[..]);
    let predicted = task.runs[0].readings(series, fitted, &series.times);
    let squares: f64 = predicted.iter().zip(&series.values).map(|(one, other)| (one - other).powi(2)).sum();
    assert!((squares / predicted.len() as f64).sqrt() < 4e-5);
}

#[test]
fn held_samples_are_those_of_their_instants() {
    let held = Dirt { hold: Some(0.013), ..CLEAN };
    let sensors = |hold: Option<f64>| {
        let sensor = Sensor { hold, ..Sensor::default() };
        [(held, sensor), (CLEAN, Sensor::default())]
    };
    let fit = |hold: Option<f64>| {
        // Without noise the pressure alone would say what the friction is.
        let runs = vec![recorded(100.0, &[VISCOUS], sensors(hold), [0.0, 5e3])];
        identified(runs, vec![unknown(VISCOUS, 4.0, [0.5, 50.0])]).found.fit.estimates[0].value
    };
    assert!((fit(Some(0.013)) - 6.0).abs() < 1e-4, "{}", fit(Some(0.013)));
    // A fit that does not know of it is off.
    assert!((fit(None) - 6.0).abs() > 0.01, "{}", fit(None));
}

#[test]
fn an_absolute_sensor_scales_what_it_shows() {
    let absolute = Dirt { amounts: [0.0, 0.0, 1.05, 0.0, 0.0], hold: None, base: ATMOSPHERE };
    let sensors = [(CLEAN, Sensor::default()), (absolute, absolute.sensor(&["scale"], 1))];
    let runs = vec![recorded(100.0, &[VISCOUS], sensors, [0.0; 2])];
    let unknowns = vec![unknown(VISCOUS, 4.0, [0.5, 50.0]), unknown("scale", 1.0, [0.5, 2.0])];
    let found = identified(runs, unknowns);
    assert!((found.found.fit.estimates[1].value - 1.05).abs() < 1e-6, "{:?}", found.found.fit.estimates);
}

#[test]
fn only_a_sensor_may_be_looked_for() {
    let dirt = Dirt { amounts: [1e-3, 0.0, 1.0, 5e-3, 0.0], ..CLEAN };
    let sensors = [(dirt, dirt.sensor(&["offset", "shift"], 0)), (CLEAN, Sensor::default())];
    let runs = vec![recorded(100.0, &[], sensors, [0.0; 2])];
    let found = identified(runs, vec![unknown("offset", 0.0, [-0.02, 0.02]), unknown("shift", 0.0, [-0.05, 0.05])]);
    for (estimate, truth) in found.found.fit.estimates.iter().zip([1e-3, 5e-3]) {
        assert!((estimate.value - truth).abs() < 1e-6, "{}: {}", estimate.name, estimate.value);
    }
}

#[test]
fn in_segments_a_sensor_is_known() {
    let sensors = [(CLEAN, CLEAN.sensor(&["offset"], 1)), (CLEAN, Sensor::default())];
    let task = Task {
        runs: vec![recorded(100.0, &[VISCOUS], sensors, [0.0; 2])],
        unknowns: vec![unknown(VISCOUS, 4.0, [0.5, 50.0]), unknown("offset", 0.0, [-0.02, 0.02])],
        starts: Vec::new(),
        horizon: Horizon::Segments(0.1),
        search: Search::default(),
        tolerance: 1e-9,
    };
    let problem = task.identify().expect_err("no fit").to_string();
    assert!(problem.contains("segments") && problem.contains("[columns]"), "{problem}");
}

/// Small noise leaves an offset and a drift of zero nearly zero: they are as identifiable as others.
#[test]
fn an_offset_of_zero_is_identifiable() {
    let sensors = [(CLEAN, CLEAN.sensor(&["offset", "drift", "scale"], 0)), (CLEAN, Sensor::default())];
    let (mut hits, mut errors) = (0, Vec::new());
    for draw in 0..8 {
        let runs = vec![recorded(100.0 + f64::from(draw), &[], sensors, [5e-9, 300.0])];
        let unknowns = vec![
            unknown("offset", 0.0, [-0.02, 0.02]),
            unknown("drift", 0.0, [-0.02, 0.02]),
            unknown("scale", 1.0, [0.5, 2.0]),
        ];
        let found = identified(runs, unknowns).found.fit;
        assert!(found.unidentifiable.is_empty(), "{:?}", found.unidentifiable);
        for (estimate, truth) in found.estimates.iter().zip([0.0, 0.0, 1.0]) {
            hits += u32::from(holds(estimate, truth));
        }
        errors.extend(found.estimates[2].standard_error);
    }
    // The three of a draw miss together: four draws or more do so once in two thousand.
    assert!(hits > 12, "{hits}");
    let (least, most) =
        (errors.iter().copied().fold(f64::INFINITY, f64::min), errors.iter().copied().fold(0.0, f64::max));
    assert!(errors.len() == 8 && most < 2.0 * least, "{errors:?}");
}

/// The lengths of a run alone, with this noise in m.
fn lengths(deviation: f64) -> Recorded {
    let mut run =
        recorded(100.0, &[VISCOUS], [(CLEAN, Sensor::default()), (CLEAN, Sensor::default())], [deviation, 0.0]);
    run.time_series.truncate(1);
    run
}

fn of_length(run: Recorded, search: Search) -> (Task, Identified) {
    let unknowns = vec![unknown(VISCOUS, 4.0, [0.5, 50.0])];
    let task = Task { runs: vec![run], unknowns, starts: Vec::new(), horizon: Horizon::Whole, search, tolerance: 1e-9 };
    let found = task.identify().unwrap_or_else(|error| panic!("{error}"));
    (task, found)
}

/// A table that is sampled ten times as fast as its sensor has each sample ten times, and the intervals were a third of what they are.
#[test]
fn a_sample_that_is_held_counts_once() {
    let run = lengths(3e-5);
    let series = &run.time_series[0];
    // Times are 2 ms, 4 ms … 600 ms; the sensor samples at 20 ms, 40 ms … and holds.
    let every = |from: usize, step: usize| (from..300).step_by(step);
    let own = TimeSeries {
        times: every(9, 10).map(|place| series.times[place]).collect(),
        values: every(9, 10).map(|place| series.values[place]).collect(),
        ..series.clone()
    };
    let held = TimeSeries {
        times: every(9, 1).map(|place| series.times[place]).collect(),
        values: every(9, 1).map(|place| series.values[9 + 10 * ((place - 9) / 10)]).collect(),
        sensor: Sensor { hold: Some(0.02), ..Sensor::default() },
        ..series.clone()
    };
    let estimate = |time_series: TimeSeries| {
        let (_, found) = of_length(Recorded { time_series: vec![time_series], ..run.clone() }, Search::default());
        (found.found.fit.estimates[0].value, found.found.fit.estimates[0].standard_error.expect("a standard error"))
    };
    let once = held.clone().without_repetitions();
    assert_eq!(once.values.len(), 30);
    let ((own, own_error), (once, once_error), (_, repeated)) = (estimate(own), estimate(once), estimate(held));
    assert!((once / own - 1.0).abs() < 1e-6 && (once_error / own_error - 1.0).abs() < 1e-4, "{once} {own}");
    assert!(repeated < 0.4 * once_error, "{repeated} of {once_error}");
    // A sensor that follows has every reading.
    assert_eq!(series.clone().without_repetitions(), *series);
}

#[test]
fn a_deviation_that_is_stated_too_small_is_seen() {
    for (deviation, is_small) in [(Some(3e-7), true), (Some(3e-5), false), (Some(3e-4), false), (None, false)] {
        let mut run = lengths(3e-5);
        run.time_series[0].deviation = deviation;
        let (task, found) = of_length(run, Search::default());
        assert_eq!(task.understated(&found).len(), usize::from(is_small), "{deviation:?}");
        assert!(task.unexplained(&found).is_empty());
    }
}

/// A tenth of the readings is 30 deviations off. A search that spares them leaves them, and nothing else.
#[test]
fn outliers_that_are_spared_are_no_lack_of_the_model() {
    let mut run = lengths(3e-5);
    let values = &mut run.time_series[0].values;
    values
        .iter_mut()
        .step_by(10)
        .enumerate()
        .for_each(|(place, value)| *value += if place % 2 == 0 { 9e-4 } else { -9e-4 });
    let (task, found) = of_length(run.clone(), Search { loss: Loss::Huber(2.5), ..Search::default() });
    assert!(task.unexplained(&found).is_empty(), "{:?}", task.unexplained(&found));
    let (task, found) = of_length(run, Search::default());
    assert_eq!(task.unexplained(&found).len(), 1);
}

/// Outliers of the length do not take its weight away: a search that spares them weighs it by the noise of its other readings.
#[test]
fn outliers_do_not_spoil_the_weights() {
    let exact = (CLEAN, Sensor::default());
    let deviations = [3e-5, 300.0];
    let mut run = recorded(100.0, &[VISCOUS], [exact; 2], deviations);
    let values = &mut run.time_series[0].values;
    values
        .iter_mut()
        .step_by(10)
        .enumerate()
        .for_each(|(place, value)| *value += if place % 2 == 0 { 9e-4 } else { -9e-4 });
    let (_, found) = of_length(run, Search { loss: Loss::Huber(2.5), ..Search::default() });
    for ((observed, scale), deviation) in found.scales.iter().zip(deviations) {
        // The median of all sizes is the 0.556 quantile of nine tenths of them, 1.13 deviations; the root mean square is 9.5.
        assert!((0.85..1.35).contains(&(scale / deviation)), "{observed:?}: {scale}, not {deviation}");
    }
}

/// Readings without a lag. With x the length, its lag is found as that of a straight line through zero: the standard error is
/// σ/√Σẋ². In half of the draws it would be below zero: there it is zero, and its interval reaches as far up.
#[test]
fn a_lag_of_zero_has_an_interval() {
    let sensors = [(CLEAN, CLEAN.sensor(&["lag"], 0)), (CLEAN, Sensor::default())];
    let mut at_zero = 0;
    for draw in 0..4 {
        let supply = 100.0 + f64::from(draw);
        let clean = &recorded(supply, &[], sensors, [0.0; 2]).time_series[0];
        let rate =
            |at: usize| (clean.values[at + 1] - clean.values[at - 1]) / (clean.times[at + 1] - clean.times[at - 1]);
        let squares: f64 = (1..clean.times.len() - 1).map(|at| rate(at).powi(2)).sum();
        let error = 3e-5 / squares.sqrt();
        for known in [None, Some([3e-5, 300.0])] {
            let mut run = recorded(supply, &[], sensors, [3e-5, 300.0]);
            for (place, series) in run.time_series.iter_mut().enumerate() {
                series.deviation = known.map(|deviations| deviations[place]);
            }
            let found = identified(vec![run], vec![unknown("lag", 1e-3, [0.0, 0.1])]).found.fit;
            assert!(found.unidentifiable.is_empty(), "{:?}", found.unidentifiable);
            let lag = &found.estimates[0];
            let [low, high] = lag.confidence_interval.unwrap_or_else(|| panic!("{supply}: {found:?}"));
            assert!(lag.value < 4.0 * error && low <= lag.value, "{lag:?}: {error}");
            // Of 300 readings the noise is known to a twentieth.
            assert!(((high - lag.value) / (1.96 * error) - 1.0).abs() < 0.15, "{lag:?}: {error}");
            if lag.on_bound {
                assert_eq!([lag.value, low], [0.0; 2]);
                at_zero += 1;
            }
        }
    }
    assert!(at_zero > 0);
}
