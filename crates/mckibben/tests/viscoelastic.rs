//! Viscoelastic branches and structural damping, against closed forms and characteristic polynomials.

use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, GRAVITY, LB, PSI, Paper, assert_close, assert_within, slope};
use mckibben::air::Process;
use mckibben::friction::Viscoelastic;
use mckibben::linearize::{Balance, Content, linearize};
use mckibben::load::{Load, Motion};
use mckibben::parameter;
use mckibben::plant::{Plant, PlantTrajectory, simulate_plant};
use mckibben::simulation::{Method, Rig, simulate};
use mckibben::{Dual, GaugePressure, Over, Scalar};
use std::f64::consts::PI;

const GAUGE: f64 = 4e5;
const MIDDLE: f64 = 0.08;
/// Stiffness in N/m and ratio, and relaxation time in s, of each branch.
const BRANCHES: [(f64, f64, f64); 3] = [(200.0, 0.0, 0.05), (0.0, 0.3, 0.4), (80.0, 0.1, 2.0)];

fn branches(of: &[(f64, f64, f64)]) -> Viscoelastic {
    let list = |part: fn(&(f64, f64, f64)) -> f64| of.iter().map(part).collect::<Vec<f64>>();
    Viscoelastic::new(&list(|its| its.0), &list(|its| its.1), &list(|its| its.2)).expect("branches")
}

/// A muscle without friction but for what a test gives it, at a pressure that does not change.
fn muscle() -> Paper {
    Paper::sealed().process(Process::Isothermal).friction(0.0, 0.0).gauge(GAUGE).with(|rig| rig.external_volume = 1e6)
}

fn creeping() -> Paper {
    muscle().with(|rig| rig.viscoelastic = Some(branches(&BRANCHES)))
}

fn moved_along(paper: Paper, time: Vec<f64>, length: Vec<f64>) -> Paper {
    let motion = Motion::table(time, length, paper.thread_length).expect("a path");
    paper.with(|rig| rig.load = Load::Prescribed(motion))
}

/// Secant stiffness (13) of the ideal braid in N/m at a length and a gauge pressure.
fn secant(paper: &Paper, length: f64, gauge: f64) -> f64 {
    3.0 * gauge * (length + paper.thread_length / 3.0_f64.sqrt()) / (4.0 * PI * paper.turns * paper.turns)
}

/// What the tension is above the static force.
fn excess(paper: &Paper, length: f64, tension: f64) -> f64 {
    let resting: f64 = paper.actuator().static_force(length, ATMOSPHERE + paper.gauge);
    tension - resting
}

/// Force of the branches at a time along a ramp of `velocity` that ends at `until`: each stretch is `v τ (1 − e^{−t/τ})`, and
/// decays from there.
fn after_a_ramp(paper: &Paper, (velocity, until): (f64, f64), time: f64) -> f64 {
    let ramp = time.min(until);
    let stiffness = secant(paper, MIDDLE + velocity * ramp, GAUGE);
    let of = |&(absolute, ratio, tau): &(f64, f64, f64)| {
        let stretch = -velocity * tau * (-ramp / tau).exp_m1() * (-(time - ramp) / tau).exp();
        (absolute + ratio * stiffness) * stretch
    };
    BRANCHES.iter().map(of).sum()
}

#[test]
fn the_force_relaxes_after_a_ramp_as_its_closed_form_says() {
    let (velocity, until) = (0.05, 0.1);
    let paper = moved_along(
        creeping(),
        vec![0.0, until, 5.0],
        vec![MIDDLE, MIDDLE + velocity * until, MIDDLE + velocity * until],
    );
    let run = paper.run(5.0, 1e-10);
    for time in [0.02, 0.07, 0.15, 0.4, 1.3, 4.0] {
        let sample = run.at(time);
        let expected = after_a_ramp(&paper, (velocity, until), time);
        assert_within(excess(&paper, sample.length, sample.tension), expected, 1e-7);
    }
    assert!(after_a_ramp(&paper, (velocity, until), 0.1) > 1.5, "the force is to be seen");
    // By steps, with the order of each method.
    for (method, order, step) in [(Method::Rk4, 4, 0.02), (Method::Stable, 2, 0.002)] {
        let missed = |step: f64| {
            let mut stepper = RigSteps::new(&paper.rig(), paper.start(), method);
            let count = (0.4 / step).round() as u32;
            for k in 1..=count {
                stepper.advance_to(f64::from(k) * step).expect("a step");
            }
            let sample = stepper.sample();
            (excess(&paper, sample.length, sample.tension) - after_a_ramp(&paper, (velocity, until), 0.4)).abs()
        };
        let (coarse, fine) = (missed(step), missed(0.5 * step));
        let halved = (coarse / fine).log2();
        assert!(fine < 1e-2 && (halved - f64::from(order)).abs() < 0.35, "{method:?}: {coarse:e} {fine:e} {halved}");
    }
}

/// What the history has left in the springs relaxes, each with its time, at a length that stays; and the derivative by a
/// stretch at the start is that of the closed form.
#[test]
fn springs_that_are_stretched_at_the_start_relax() {
    let stretches = [2e-4, -5e-4, 1e-3];
    let stretched = branches(&BRANCHES).with_initial_stretch(&stretches).expect("branches");
    let paper = muscle().with(|rig| rig.viscoelastic = Some(stretched)).isometric(MIDDLE);
    let stiffness = secant(&paper, MIDDLE, GAUGE);
    let share = |k: usize, time: f64| {
        let (absolute, ratio, tau) = BRANCHES[k];
        (absolute + ratio * stiffness) * (-time / tau).exp()
    };
    let run = paper.run(3.0, 1e-10);
    for time in [0.0, 0.05, 0.3, 1.0, 3.0] {
        let expected: f64 = (0..3).map(|k| share(k, time) * stretches[k]).sum();
        let sample = run.at(time);
        assert_within(excess(&paper, sample.length, sample.tension), expected, 1e-7);
    }
    type One = crate::common::Seeded;
    let mut entry = 0;
    let seeded: Rig<One> = paper.rig().map(|row, value| {
        let is_second = row.key == parameter::BRANCH_INITIAL_STRETCH.key && entry == 1;
        entry += usize::from(row.key == parameter::BRANCH_INITIAL_STRETCH.key);
        if is_second { One::variable(value, 0) } else { One::constant(value) }
    });
    let start = seeded.begin(&paper.initial().map(|_, value| One::constant(value))).expect("a start");
    let sample = simulate(&seeded, start, One::constant(0.3), 1e-10).expect("a run").at(One::constant(0.3));
    assert_within(sample.tension.slope[0], share(1, 0.3), 1e-5);
    let one_too_few = branches(&BRANCHES).with_initial_stretch(&[1e-4]).expect_err("three branches");
    assert!(one_too_few.to_string().contains("entry 2"), "{one_too_few}");
}

#[test]
fn a_branch_that_relaxes_at_once_needs_no_short_steps() {
    let quick = muscle().friction(30.0, 0.0).with(|rig| rig.viscoelastic = Some(branches(&[(3e3, 0.5, 1e-6)])));
    let paper = quick.mass(5.0 * LB).from(0.083, 0.0);
    let mut stepper = RigSteps::new(&paper.rig(), paper.start(), Method::Stable);
    for step in 1..=2000 {
        stepper.advance_to(f64::from(step) * 2e-3).expect("a step");
        let sample = stepper.sample();
        assert!((0.05..0.12).contains(&sample.length), "{sample:?}");
    }
    // A branch as quick as that is a viscous damping of k τ, a thousandth of what there is: it rests.
    assert_within(stepper.sample().length, paper.balance(5.0 * LB * GRAVITY), 1e-6);
}

#[test]
fn a_slack_muscle_relaxes_at_its_shortest_length() {
    let shortest = Paper::sealed().thread_length / 3.0_f64.sqrt();
    let [one, two] = [0.02, 0.04];
    let paper = moved_along(
        creeping().from(shortest + 2e-3, 0.0),
        vec![0.0, one, one + two, 2.0 * one + two],
        vec![shortest + 2e-3, shortest - 2e-3, shortest - 2e-3, shortest + 2e-3],
    );
    let run =
        simulate_plant(&Plant::of_rig(&paper.rig()), &Plant::start_of_rig(&paper.rig(), &paper.start()), 0.08, 1e-10)
            .expect("a run");
    // From the ramp to the shortest length, at which it stays from half of the first ramp to half of the last.
    let (velocity, ramp) = (-4e-3 / one, one / 2.0);
    let slack = one / 2.0 + two + one / 2.0;
    let place = Plant::of_rig(&paper.rig()).indices().actuators[0].branches().start;
    for (branch, (_, _, tau)) in BRANCHES.into_iter().enumerate() {
        let stretch = -velocity * tau * (-ramp / tau).exp_m1() * (-slack / tau).exp();
        let (state, _) = run.at(ramp + slack);
        assert_within(shortest - state[place + branch], stretch, 1e-10);
    }
    assert_eq!(run.sample(0.03).actuators[0].branch_force, 0.0);
}

#[test]
fn poles_are_the_roots_of_the_characteristic_polynomial() {
    // M s² + K + Σ k s τ/(1 + s τ) = 0 at a pressure that is given by so large a volume.
    let paper = creeping().mass(5.0 * LB);
    let point =
        linearize(&paper.rig(), Balance::AtPressure(GaugePressure(GAUGE)), Content::Temperature(paper.temperature));
    let point = point.expect("a model");
    let length = paper.clone().gauge(GAUGE).balance(5.0 * LB * GRAVITY);
    let static_stiffness = paper.actuator().stiffness(length, mckibben::AbsolutePressure(ATMOSPHERE + GAUGE));
    let characteristic = |[re, im]: [f64; 2]| {
        let multiply = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
        let square = multiply([re, im], [re, im]);
        let mut sum = [5.0 * LB * square[0] + static_stiffness, 5.0 * LB * square[1]];
        for (absolute, ratio, tau) in BRANCHES {
            let stiffness = absolute + ratio * secant(&paper, length, GAUGE);
            let (top, bottom) = ([re * tau, im * tau], [1.0 + re * tau, im * tau]);
            let size = bottom[0] * bottom[0] + bottom[1] * bottom[1];
            let part = multiply(top, [bottom[0] / size, -bottom[1] / size]);
            sum = [sum[0] + stiffness * part[0], sum[1] + stiffness * part[1]];
        }
        sum
    };
    let poles = point.minimal().poles().expect("poles");
    let moving: Vec<_> = poles.iter().filter(|pole| pole.real.hypot(pole.imaginary) > 1e-3).collect();
    assert_eq!(moving.len(), 2 + BRANCHES.len(), "{poles:?}");
    for pole in moving {
        let left = characteristic([pole.real, pole.imaginary]);
        assert!(left[0].hypot(left[1]) < 1e-4 * static_stiffness, "{pole:?} leaves {left:?}");
        assert!(pole.real < 0.0, "{pole:?}");
    }
    let names: Vec<_> = point.system.states.iter().map(|signal| signal.name.as_str()).collect();
    assert!(names.contains(&"relaxed_length_3"), "{names:?}");
}

#[test]
fn structural_damping_is_a_viscous_one_by_the_stiffness() {
    let time = 3e-3;
    let damped = |paper: Paper| paper.with(|rig| rig.structural = time);
    for velocity in [0.03_f64, -0.05] {
        let path = vec![MIDDLE, MIDDLE + 0.2 * velocity];
        let paper = moved_along(damped(muscle()), vec![0.0, 0.2], path);
        let sample = paper.run(0.15, 1e-9).at(0.15);
        let expected = time * secant(&paper, sample.length, GAUGE) * sample.velocity;
        assert_within(excess(&paper, sample.length, sample.tension), expected, 1e-9);
    }
    // A ring-down about a balance: the damping of the linear model is c/(2M).
    let paper = damped(muscle()).mass(5.0 * LB);
    let model =
        linearize(&paper.rig(), Balance::AtPressure(GaugePressure(GAUGE)), Content::Temperature(paper.temperature));
    let poles = model.expect("a model").minimal().poles().expect("poles");
    let length = paper.balance(5.0 * LB * GRAVITY);
    let expected = -time * secant(&paper, length, GAUGE) / (2.0 * 5.0 * LB);
    assert!(poles.iter().any(|pole| (pole.real / expected - 1.0).abs() < 1e-6), "{poles:?} {expected}");
}

fn run_of(paper: &Paper, duration: f64) -> PlantTrajectory {
    let rig = paper.rig();
    simulate_plant(&Plant::of_rig(&rig), &Plant::start_of_rig(&rig, &paper.start()), duration, 1e-9).expect("a run")
}

#[test]
fn the_ledger_knows_what_branches_store_and_lose() {
    // At a pressure that does not change, under a mass that falls into the muscle.
    let paper = creeping().mass(5.0 * LB).from(0.085, 0.0);
    let (run, plant) = (run_of(&paper, 0.7), Plant::of_rig(&paper.rig()));
    let ledger = run.ledger();
    let of = &ledger.actuators[0];
    let state = run.at(0.7).0;
    let length = run.sample(0.7).actuators[0].length;
    let stored: f64 = BRANCHES
        .iter()
        .zip(plant.indices().actuators[0].branches())
        .map(|((absolute, ratio, _), place)| {
            0.5 * (absolute + ratio * secant(&paper, length, GAUGE)) * (length - state[place]).powi(2)
        })
        .sum();
    assert!(of.branches > 1e-3 && stored > 1e-5, "{of:?}");
    // The secant stiffness follows the length too, so that something is exchanged.
    assert_close(of.branch_storage, stored, 1e-6);
    assert!(ledger.work().closes(1e-7), "{:?}", ledger.work());
    // Under pulses the pressure exchanges more.
    let pulsed = Paper::pwm(10.0, 0.5).with(|rig| rig.viscoelastic = Some(branches(&BRANCHES))).gauge(40.0 * PSI);
    let ledger = run_of(&pulsed, 0.5).ledger();
    let of = &ledger.actuators[0];
    assert!(of.branches > 0.0 && of.branch_exchange.abs() > 1e-4 && ledger.work().closes(1e-6), "{of:?}");
}

#[test]
fn derivatives_pass_through_the_branches() {
    let swing = |tau: f64| {
        let law = branches(&[(100.0, 0.2, tau)]);
        muscle().mass(5.0 * LB).from(0.083, 0.0).with(|rig| rig.viscoelastic = Some(law))
    };
    let at = |tau| swing(tau).run(0.15, 1e-12).at(0.15).length;
    let seed = |parameter: &'static mckibben::parameter::Parameter, value: f64| -> crate::common::Seeded {
        let seeded = parameter.key == mckibben::parameter::BRANCH_RELAXATION_TIME.key;
        if seeded { Dual::variable(value, 0) } else { Dual::of(value) }
    };
    let (rig, initial) = (swing(0.3).rig().map(seed), swing(0.3).initial().map(seed));
    let start = rig.begin(&initial).expect("a start");
    let exact = simulate(&rig, start, Dual::of(0.15), 1e-12).expect("a run").at(Dual::of(0.15)).length;
    assert_within(exact.value, at(0.3), 1e-13);
    assert_close(exact.slope[0], slope(1e-4, |change| at(0.3 + change)), 1e-6);
}

#[test]
fn lists_that_are_no_branches_are_refused() {
    let refused = |stiffness: &[f64], ratio: &[f64], time: &[f64]| {
        Viscoelastic::new(stiffness, ratio, time).expect_err("no branches").to_string()
    };
    assert!(refused(&[], &[], &[1.0]).contains("stiffness_ratio"));
    assert!(refused(&[1.0], &[], &[]).contains("relaxation_time"));
    assert!(refused(&[1.0, 2.0], &[], &[1.0]).contains("viscoelastic.stiffness"));
    assert!(refused(&[], &[0.1; 7], &[1.0; 7]).contains("too many"));
    assert!(refused(&[], &[-0.1], &[1.0]).contains("stiffness_ratio"));
    assert!(refused(&[], &[0.1], &[0.0]).contains("relaxation_time"));
    assert!(refused(&[f64::NAN], &[], &[1.0]).contains("viscoelastic.stiffness"));
}
