//! The measured error of the fixed-step engine, and the step that a requested accuracy needs.

use crate::common::steps::RigSteps;
use crate::common::{PSI, Paper};
use mckibben::Error;
use mckibben::plant::{PILOT, PlantReference, PlantStepError, RigPlant, SHORTEST, plant_step_for_accuracy};
use mckibben::simulation::{Method, SampleTimes, simulate};

const METHODS: [Method; 2] = [Method::Rk4, Method::Stable];

fn ring_down() -> Paper {
    Paper::sealed().gauge(60.0 * PSI).friction(3.5, 1.1e-4).from(0.088, 0.0)
}

fn drop_onto_the_taut_braid() -> Paper {
    Paper::sealed().mass(4.5).gauge(1e5).from(0.085, 0.0)
}

fn chosen(paper: &Paper, times: (f64, f64), method: Method, accuracy: f64) -> Result<PlantStepError, Error> {
    let of = RigPlant::new(&paper.rig());
    plant_step_for_accuracy((of.plant(), &of.start(&paper.start())), &Vec::new, times, method, accuracy)
}

/// The errors of length, velocity, pressure and air mass of one step, against a run at a tolerance of 1e-12.
fn errors(paper: &Paper, duration: f64, method: Method, step: f64) -> Result<[f64; 4], Error> {
    let of = RigPlant::new(&paper.rig());
    let start = of.start(&paper.start());
    let errors = PlantReference::new((of.plant(), &start), &Vec::new, duration, 1e-12)?.errors(method, step)?;
    let (mechanism, actuator) = (of.plant().indices().mechanisms[0], &of.plant().indices().actuators[0]);
    let places = [mechanism.position(0), mechanism.rate(0), actuator.pressure, actuator.mass()];
    Ok(places.map(|place| errors[place]))
}

/// The error as its definition says, by plain loops over samples of a run at a tolerance that the module never uses.
fn error_by_definition(paper: &Paper, (duration, interval): (f64, f64), method: Method, step: f64) -> f64 {
    let (rig, start) = (paper.rig(), paper.start());
    let exact = simulate(&rig, start, duration, 3e-13).expect("a trajectory");
    let states = |time: f64| {
        let sample = exact.at(time);
        [sample.length, sample.velocity, sample.pressure.0, sample.air_mass]
    };
    let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 4];
    for index in 0..=20_000 {
        for (range, value) in ranges.iter_mut().zip(states(duration * f64::from(index) / 2e4)) {
            *range = (range.0.min(value), range.1.max(value));
        }
    }
    let mut stepper = RigSteps::new(&rig, start, method);
    let mut worst: f64 = 0.0;
    for (time, _) in SampleTimes::new(duration, interval).steps(step) {
        stepper.advance_to(time).expect("a step");
        let (ours, theirs) = (stepper.state(), states(time));
        let ours = [ours.length, ours.velocity, ours.pressure.0, ours.air_mass];
        for n in 0..4 {
            let range = ranges[n].1 - ranges[n].0;
            // A state that hardly moves counts by its usual size; the cases have none with an error.
            if ours[n] != theirs[n] && range > 1e-9 * theirs[n].abs() {
                worst = worst.max((ours[n] - theirs[n]).abs() / range);
            }
        }
    }
    worst
}

#[test]
fn the_error_of_the_chosen_step_is_at_most_the_accuracy() {
    let cases = [
        ("25 Hz PWM", Paper::pwm(25.0, 0.5), 0.3),
        ("ring-down", ring_down(), 0.5),
        ("drop", drop_onto_the_taut_braid(), 0.3),
        ("isometric", Paper::pwm(5.0, 0.5).isometric(0.09), 0.3),
    ];
    for (name, paper, duration) in cases {
        for method in METHODS {
            for accuracy in [1e-2, 1e-3, 1e-4] {
                let times = (duration, 1e-3);
                let error = chosen(&paper, times, method, accuracy).expect("a step");
                let independent = error_by_definition(&paper, times, method, error.step);
                let described = format!("{name}, {method:?}, {accuracy:e}: {error:?}, by definition {independent:e}");
                assert!(error.greatest <= accuracy && error.compared == duration, "{described}");
                // The two may differ by how well a range is sampled, and by what the module's reference errs.
                assert!(independent <= 1.01 * accuracy, "{described}");
                assert!((independent - error.greatest).abs() <= 0.01 * independent + 0.01 * accuracy, "{described}");
            }
        }
    }
}

#[test]
fn the_next_longer_step_would_not_do() {
    let paper = Paper::pwm(25.0, 0.5);
    let interval = 1e-3;
    for method in METHODS {
        let step = chosen(&paper, (0.3, interval), method, 1e-4).expect("a step").step;
        let parts = (interval / step).round();
        // Of 1, 2, 5, 10, … parts the next fewer.
        let fewer = if [5.0, 50.0, 500.0].contains(&parts) { 0.4 * parts } else { 0.5 * parts };
        assert!(error_by_definition(&paper, (0.3, interval), method, interval / fewer) > 1e-4, "{method:?}, {parts}");
    }
}

#[test]
fn halved_steps_divide_the_error_by_two_to_the_order() {
    // So small a swing leaves the tendon tight, and nothing has a kink.
    let paper = ring_down().friction(3.5, 0.0).from(0.079, 0.0);
    for (method, step, order) in [(Method::Rk4, 2e-3, 4.0), (Method::Stable, 2e-4, 2.0)] {
        let [coarse, fine] = [step, 0.5 * step].map(|step| errors(&paper, 0.5, method, step).expect("a run"));
        for n in 0..3 {
            let observed = (coarse[n] / fine[n]).log2();
            assert!((observed - order).abs() < 0.1, "{method:?}, state {n}: {observed}");
        }
        assert!(coarse[3] < 1e-11, "it is sealed");
    }
}

#[test]
fn what_cannot_be_reached_is_refused_with_what_can() {
    let error = chosen(&Paper::pwm(25.0, 0.5), (0.06, 1e-3), Method::Stable, 1e-9).expect_err("too much");
    let Error::Inconsistent { parameter, value, requirement, .. } = &error else { panic!("{error}") };
    assert_eq!((parameter.key, *value), ("run.accuracy", 1e-9));
    assert!(requirement.value > 1e-9 && requirement.value < 1e-4, "{error}");
    let message = error.to_string();
    assert!(message.contains("loosen run.accuracy") && message.contains("shortest step"), "{message}");
}

#[test]
fn no_step_is_tried_below_the_shortest() {
    // Of the parts of 30 µs, 1.5 µs is the last that is long enough.
    let paper = Paper::pwm(25.0, 0.5);
    let reached = chosen(&paper, (0.06, 30e-6), Method::Stable, 1e-9).expect_err("too much");
    let Error::Inconsistent { requirement, .. } = reached else { panic!("{reached}") };
    let expected = error_by_definition(&paper, (0.06, 30e-6), Method::Stable, 1.5 * SHORTEST);
    assert!((requirement.value / expected - 1.0).abs() < 0.01, "{} and {expected}", requirement.value);
}

#[test]
fn an_accuracy_or_a_step_outside_its_range_is_refused() {
    let paper = ring_down();
    for accuracy in [0.0, -1e-3, 0.2, f64::NAN, 1e-10] {
        let error = chosen(&paper, (0.1, 1e-3), Method::Rk4, accuracy).expect_err("out of range");
        assert!(matches!(error, Error::OutOfRange { parameter, .. } if parameter.key == "run.accuracy"), "{error}");
    }
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = errors(&paper, 0.1, Method::Rk4, step).expect_err("out of range");
        assert!(matches!(error, Error::OutOfRange { parameter, .. } if parameter.key == "run.step"), "{error}");
    }
}

#[test]
fn a_run_in_which_nothing_happens_has_no_error() {
    let paper = Paper::sealed().gauge(3e5).isometric(0.09);
    let error = chosen(&paper, (1.0, 0.1), Method::Stable, 1e-6).expect("a step");
    // The dense output of the event-located engine rounds.
    assert!(error.step == 0.1 && error.greatest < 1e-11, "{error:?}");
}

#[test]
fn a_long_run_is_compared_over_its_beginning() {
    let paper = ring_down();
    let long = chosen(&paper, (1e4, 5e-3), Method::Rk4, 1e-3).expect("a step");
    let short = chosen(&paper, (PILOT, 5e-3), Method::Rk4, 1e-3).expect("a step");
    assert_eq!((long, long.compared), (short, PILOT));
}

#[test]
fn steps_divide_every_interval_and_end_on_every_sample() {
    for (duration, interval, step) in [(1.0, 0.1, 0.03), (0.35, 0.1, 0.1), (0.3, 0.1, 0.1 / 3.0), (0.05, 0.1, 1.0)] {
        let times = SampleTimes::new(duration, interval);
        let mut before = 0.0;
        let mut row = 0;
        for (time, recorded) in times.steps(step) {
            assert!(time > before && time - before <= step * (1.0 + 1e-9), "{time} after {before}");
            before = time;
            if recorded {
                row += 1;
                assert_eq!(time, times.time(row));
            }
        }
        assert_eq!((row, before), (times.last(), duration));
    }
    // The least number: three tenths of a tenth need four parts, a third of it three, though the quotient is rounded.
    let parts = |step| SampleTimes::new(0.1, 0.1).steps(step).count();
    assert_eq!([parts(0.03), parts(0.1 / 3.0), parts(0.1), parts(0.05)], [4, 3, 1, 2]);
}
