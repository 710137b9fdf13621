//! Hysteresis by elastic elements that slip, and dry friction other than Coulomb's.
//!
//! The pressure is that of a chamber so large that it does not change, so that the static force and the secant stiffness
//! depend on the length alone and every loop has a closed form.

use crate::common::accounts::Audited;
use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, GRAVITY, LB, Paper, assert_close, assert_within, slope, stable_error};
use mckibben::air::Process;
use mckibben::friction::{Coulomb, Hysteresis, MaxwellSlip};
use mckibben::load::{Load, Motion};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{EventKind, Method, Sample, SampleTimes, simulate};
use mckibben::{Dual, Error, Over};
use std::f64::consts::PI;

const REACH: [f64; 4] = [2e-5, 1e-4, 3e-4, 1e-3];
const RATIO: [f64; 4] = [1.5, 0.4, 0.2, 0.05];
const GAUGE: f64 = 4e5;
const MIDDLE: f64 = 0.08;

fn elements() -> Hysteresis {
    Hysteresis::MaxwellSlip(MaxwellSlip::new(&REACH, &RATIO).expect("elements"))
}

/// A muscle that nothing but the elements damps, at a pressure that does not change.
fn muscle() -> Paper {
    Paper::sealed().process(Process::Isothermal).friction(0.0, 0.0).gauge(GAUGE).with(|rig| {
        rig.external_volume = 1e6;
        rig.hysteresis = Some(elements());
    })
}

fn moved_along(path: &[(f64, f64)]) -> Paper {
    let (time, length) = path.iter().map(|(time, offset)| (*time, MIDDLE + offset)).unzip();
    let motion = Motion::table(time, length, Paper::sealed().thread_length).expect("a path");
    muscle().with(|rig| rig.load = Load::Prescribed(motion))
}

/// The virgin curve `Σ w min(x, r)`.
fn virgin(x: f64) -> f64 {
    x.signum() * REACH.iter().zip(RATIO).map(|(reach, ratio)| ratio * x.abs().min(*reach)).sum::<f64>()
}

/// Tension less the static force, over the secant stiffness (13).
fn width_at(paper: &Paper, run: &RigTrajectory, time: f64) -> f64 {
    width(paper, &run.at(time))
}

fn width(paper: &Paper, sample: &Sample) -> f64 {
    let actuator = paper.actuator();
    let resting: f64 = actuator.static_force(sample.length, sample.pressure.0);
    (sample.tension - resting) / actuator.secant_stiffness::<f64>(sample.length, sample.pressure.0)
}

#[test]
fn the_outer_loop_is_the_virgin_curve_twice_as_large() {
    // Masing's rule, for each of the stretches that has begun with another turn.
    let largest = 7e-4;
    let paper = moved_along(&[(0.0, 0.0), (1.0, largest), (2.0, -largest), (3.0, largest), (4.0, 0.0)]);
    let run = paper.run(4.0, 1e-9);
    let at = |time| (run.at(time).length - MIDDLE, width_at(&paper, &run, time));
    for k in 1..40 {
        let part = f64::from(k) / 40.0;
        let (x, width) = at(part);
        assert_within(width, virgin(x), 1e-13);
        let (x, width) = at(1.0 + part);
        assert_within(width, virgin(largest) - 2.0 * virgin((largest - x) / 2.0), 1e-13);
        let (x, width) = at(2.0 + part);
        assert_within(width, 2.0 * virgin((x + largest) / 2.0) - virgin(largest), 1e-13);
    }
    // Three elements slip in each stretch; the fourth is out of reach.
    let slips = run.events().iter().filter(|event| event.kind == EventKind::Slip).count();
    assert_eq!(slips, 4 * 3);
}

#[test]
fn an_inner_loop_closes_and_is_forgotten() {
    let plain = moved_along(&[(0.0, 0.0), (1.0, 5e-4), (2.0, -2e-4), (3.0, 6e-4)]);
    let looped = moved_along(&[(0.0, 0.0), (1.0, 5e-4), (2.0, -2e-4), (2.5, 1.5e-4), (3.0, -2e-4), (4.0, 6e-4)]);
    let (run, with_loop) = (plain.run(3.0, 1e-9), looped.run(4.0, 1e-9));
    assert_within(width_at(&looped, &with_loop, 3.0), width_at(&looped, &with_loop, 2.0), 1e-15);
    for part in [0.1, 0.4, 0.9, 1.0] {
        assert_within(width_at(&looped, &with_loop, 3.0 + part), width_at(&plain, &run, 2.0 + part), 1e-15);
    }
}

#[test]
fn a_cycle_costs_what_its_elements_slip() {
    // ∮ F dL of element i between ∓ A: each way it slips over 2(A − r) of the path, and what it stores comes back. With a
    // secant stiffness K (L + L_min) the two ways together are 4 K (L_0 + L_min) w r (A − r).
    let largest = 6e-4;
    let motion = Motion::sinusoid(MIDDLE, largest, 1.0, 0.0, Paper::sealed().thread_length).expect("a motion");
    let paper = muscle().with(|rig| rig.load = Load::Prescribed(motion));
    let run = |duration| paper.run(duration, 1e-11).audit();
    let (one, two) = (run(1.25), run(2.25));
    let sum: f64 = REACH.iter().zip(RATIO).map(|(reach, w)| w * reach * (largest - reach).max(0.0)).sum();
    let per_length = 3.0 * GAUGE / (4.0 * PI * paper.turns * paper.turns);
    let expected = 4.0 * per_length * (MIDDLE + paper.thread_length / 3.0_f64.sqrt()) * sum;
    assert_close(two.slip - one.slip, expected, 1e-9);
    assert_within(two.hysteresis_storage, one.hysteresis_storage, 1e-9 * expected);
    assert_within(two.load - one.load, -expected, 1e-9 * expected);
    assert_within(two.residual(), 0.0, 1e-10 * two.turnover());
}

#[test]
fn one_element_of_no_reach_is_coulomb_friction() {
    // w r = Q as r goes to zero. From a turn the load takes a time that goes as √r to pass the reach, in which it is braked
    // less: the ring-downs meet as √r.
    let width = 1e-4;
    let swing = |paper: Paper| {
        let paper = paper.mass(5.0 * LB).gauge(GAUGE);
        let length = paper.balance(5.0 * LB * GRAVITY) + 2e-3;
        let run = paper.from(length, 0.0).run(0.3, 1e-10);
        move |time: f64| run.at(time).length
    };
    let coulomb = swing(muscle().with(|rig| rig.hysteresis = None).friction(0.0, width));
    let off = |reach: f64| {
        let one = MaxwellSlip::new(&[reach], &[width / reach]).expect("an element");
        let soft = swing(muscle().with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(one))));
        // While it swings; where Coulomb friction holds it, the elements go on trembling within their reach.
        (1..30).map(|k| (soft(0.003 * f64::from(k)) - coulomb(0.003 * f64::from(k))).abs()).fold(0.0, f64::max)
    };
    let (far, near) = (off(2e-5), off(2e-6));
    assert!(near < 1e-5 && (2.8..3.5).contains(&(far / near)), "{far:e} {near:e}");
}

#[test]
fn a_fixed_step_comes_to_the_event_located_run() {
    let paper = muscle().mass(5.0 * LB).from(0.083, 0.0);
    let (rig, start) = (paper.rig(), paper.start());
    let reference = simulate(&rig, start, 0.2, 1e-11).expect("a run");
    let error = |method, step: f64| {
        let mut stepper = RigSteps::new(&rig, start, method);
        let mut largest = 0.0_f64;
        for (time, _) in SampleTimes::new(0.2, step).steps(step) {
            stepper.advance_to(time).expect("a step");
            largest = largest.max((stepper.state().length - reference.at(time).length).abs());
        }
        largest
    };
    // The force has corners where elements slip, at which a step is divided: the method keeps its order.
    let (coarse, fine) = (error(Method::Rk4, 2e-3), error(Method::Rk4, 1e-3));
    assert!((14.0..18.0).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
    // The stable method has order 2. No spring is stiffer than the muscle's own, 6 P L/(4πn²) where it is longest, with
    // elements that all stick.
    let (coarse, fine) = (error(Method::Stable, 1e-3), error(Method::Stable, 5e-4));
    let lengths: Vec<f64> = reference.samples(1e-3).map(|sample| sample.length).collect();
    let (shortest, longest) = lengths.iter().fold((f64::MAX, 0.0_f64), |(low, high), l| (low.min(*l), high.max(*l)));
    let per_length = 3.0 * GAUGE / (4.0 * PI * paper.turns * paper.turns);
    let tangent = RATIO.iter().sum::<f64>();
    let stiffness = per_length * (2.0 * longest + tangent * (longest + paper.thread_length / 3.0_f64.sqrt()));
    let allowed = stable_error((stiffness / (5.0 * LB)).sqrt(), 1e-3, 0.2, 0.5 * (longest - shortest));
    assert!(coarse < allowed && (3.8..4.2).contains(&(coarse / fine)), "{coarse:e} {fine:e} {allowed:e}");
}

/// Masing's rule at steps of any length, with the turns inside them.
#[test]
fn the_memory_of_a_step_is_that_of_the_path() {
    let (up, down) = (5e-4, 7e-4);
    let paper = moved_along(&[(0.0, 0.0), (1.0, up), (2.0, up - down)]);
    for method in [Method::Rk4, Method::Stable] {
        for times in [&[0.3, 1.0, 1.1, 1.7, 2.0][..], &[1.5, 2.0], &[2.0]] {
            let mut steps = RigSteps::new(&paper.rig(), paper.start(), method);
            for time in times {
                steps.advance_to(*time).expect("a step");
                let sample = steps.sample();
                let expected = match sample.length - MIDDLE {
                    x if *time <= 1.0 => virgin(x),
                    x => virgin(up) - 2.0 * virgin((up - x) / 2.0),
                };
                assert_within(width(&paper, &sample), expected, 1e-13);
            }
        }
    }
}

#[test]
fn derivatives_pass_through_slips() {
    let at = |ratio: f64| -> f64 {
        let law = MaxwellSlip::new(&[2e-4], &[ratio]).expect("an element");
        let paper =
            muscle().mass(5.0 * LB).from(0.083, 0.0).with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(law)));
        paper.run(0.15, 1e-12).at(0.15).length
    };
    let law = MaxwellSlip::new(&[2e-4], &[0.3]).expect("an element");
    let paper =
        muscle().mass(5.0 * LB).from(0.083, 0.0).with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(law)));
    let key = mckibben::parameter::HYSTERESIS_STIFFNESS_RATIO.key;
    let seed = |parameter: &'static mckibben::parameter::Parameter, value: f64| -> crate::common::Seeded {
        if parameter.key == key { Dual::variable(value, 0) } else { Dual::of(value) }
    };
    let (rig, initial) = (paper.rig().map(seed), paper.initial().map(seed));
    let start = rig.begin(&initial).expect("a start");
    let run = simulate(&rig, start, Dual::of(0.15), 1e-12).expect("a run");
    let exact = run.at(Dual::of(0.15)).length;
    assert_within(exact.value, at(0.3), 1e-13);
    let numeric = slope(1e-4, |h| at(0.3 + h));
    assert_close(exact.slope[0], numeric, 2e-6);
}

#[test]
fn dry_friction_may_have_another_scale_and_fall_with_velocity() {
    let coulomb =
        Coulomb::new(1e-4).and_then(|law| law.with_force(0.5, 2e-6)).and_then(|law| law.with_stribeck(1.5, 0.02));
    let paper = Paper::sealed().with(|rig| (rig.coulomb, rig.viscous) = (Some(coulomb.expect("a law")), 0.0));
    let actuator = paper.actuator();
    let (length, pressure) = (0.09, ATMOSPHERE + GAUGE);
    let kinetic = 1e-4 * actuator.secant_stiffness::<f64>(length, pressure) + 0.5 + 2e-6 * GAUGE;
    let resting: f64 = actuator.static_force(length, pressure);
    for velocity in [1e-9, 0.02, -0.02, 0.3] {
        let falls = 1.0 + 0.5 * f64::exp(-(velocity / 0.02) * (velocity / 0.02));
        let force: f64 = actuator.tension(length, velocity, pressure) - resting;
        assert_within(force, velocity.signum() * kinetic * falls, 1e-13 * resting);
    }
    let (least, most) = actuator.holdable::<f64>(length, pressure, false, 0.0);
    assert_close(most - resting, 1.5 * kinetic, 1e-12);
    assert_close(resting - least, 1.5 * kinetic, 1e-12);
    // Sucked off the braid, only what does not depend on pressure is left.
    assert_within(actuator.coulomb_bound(length, 0.5 * ATMOSPHERE), 0.5, 1e-15);
    let refused = Coulomb::new(0.0).and_then(|law| law.with_stribeck(0.9, 0.02));
    assert!(matches!(refused, Err(Error::OutOfRange { parameter, .. }) if parameter.key.ends_with("static_ratio")));
}

#[test]
fn falling_friction_breaks_away_late_and_sticks_soon() {
    // The valve leaks the muscle's air before it opens to the supply: the load breaks away when the balance is ρ Q k_sec
    // out, not Q k_sec.
    let law = |ratio| Coulomb::new(1e-4).and_then(|law| law.with_stribeck(ratio, 0.01)).expect("a law");
    for ratio in [1.0, 1.6] {
        let paper = Paper::pwm(1.0, 1.0).mass(5.0 * LB).with(|rig| {
            (rig.coulomb, rig.gauge, rig.viscous) = (Some(law(ratio)), 1.5e5, 0.0);
        });
        let length = paper.balance(5.0 * LB * GRAVITY);
        let paper = paper.from(length, 0.0);
        let run = paper.run(0.05, 1e-10);
        let event = run.events().iter().find(|event| event.kind == EventKind::BreakAway).expect("it breaks away");
        let (actuator, pressure) = (paper.actuator(), run.at(event.time).pressure.0);
        let surplus = actuator.static_force::<f64>(length, pressure) - 5.0 * LB * GRAVITY;
        assert_close(surplus.abs(), ratio * 1e-4 * actuator.secant_stiffness::<f64>(length, pressure), 1e-6);
    }
}

#[test]
fn lists_that_are_no_elements_are_refused() {
    let problem = |reach: &[f64], ratio: &[f64]| MaxwellSlip::new(reach, ratio).expect_err("no elements").to_string();
    assert!(problem(&[], &[]).contains("has no entry"));
    assert!(problem(&[1e-4], &[1.0, 2.0]).contains("stiffness_ratio"));
    assert!(problem(&[1e-4; 13], &[1.0; 13]).contains("too many"));
    assert!(problem(&[0.0], &[1.0]).contains("reach"));
    assert!(problem(&[1e-4], &[-1.0]).contains("stiffness_ratio"));
}
