//! Hysteresis of Bouc and Wen with exponent one. As in `hysteresis.rs` the pressure does not change.

use crate::common::accounts::Audited;
use crate::common::steps::RigSteps;
use crate::common::{
    GRAVITY, LB, Paper, assert_close, assert_within, between, bisect, runge_kutta, slope, stable_error,
};
use mckibben::air::Process;
use mckibben::friction::{BoucWen, Hysteresis, Memory};
use mckibben::load::{Load, Motion};
use mckibben::simulation::{Method, SampleTimes, simulate};
use mckibben::{Dual, Error, Over};
use std::f64::consts::PI;

const GAUGE: f64 = 4e5;
const MIDDLE: f64 = 0.08;
const WIDTH: f64 = 1e-4;
const BETA: f64 = 4e3;
const GAMMA: f64 = -1.5e3;

fn law(beta: f64, gamma: f64) -> Hysteresis {
    Hysteresis::BoucWen(BoucWen::new(WIDTH, beta, gamma).expect("a law"))
}

fn muscle(hysteresis: Hysteresis) -> Paper {
    Paper::sealed().process(Process::Isothermal).friction(0.0, 0.0).gauge(GAUGE).with(|rig| {
        rig.external_volume = 1e6;
        rig.hysteresis = Some(hysteresis);
    })
}

/// `dz/dL = 1 − β s z − γ |z|` along a way, by many steps of the classical Runge–Kutta method.
fn integrated(beta: f64, gamma: f64, from: f64, way: f64) -> f64 {
    const STEPS: i32 = 4000;
    let (sign, step) = (way.signum(), way / f64::from(STEPS));
    let rate = |z: f64| 1.0 - beta * sign * z - gamma * z.abs();
    (0..STEPS).fold(from, |z, _| runge_kutta([z], step, |_, [z]| [rate(z)])[0])
}

#[test]
fn the_deflection_is_the_solution_of_its_equation() {
    for (beta, gamma) in [(BETA, GAMMA), (BETA, 0.0), (BETA, BETA), (BETA, 0.7 * BETA)] {
        let law = law(beta, gamma);
        let mut memory = Memory::relaxed(MIDDLE);
        let mut z = 0.0;
        for row in 0..60 {
            let way = between(row, 0, -6e-4, 6e-4);
            z = integrated(beta, gamma, z, way);
            // The same way in one and in three parts.
            let (mut parts, from) = (memory, memory.at);
            for part in [0.2, 0.55, 1.0] {
                law.moved(&mut parts, from + part * way, 0.0);
            }
            law.moved(&mut memory, from + way, 0.0);
            assert_within(parts.elements[0], memory.elements[0], 1e-13 / beta);
            // The corner at zero leaves the other method an error of second order in its step.
            assert_within(memory.elements[0], z, 1e-6 / beta);
            // No way leaves it as it is.
            assert_close(law.width(&memory, memory.at, 0.0), WIDTH * (beta + gamma) * memory.elements[0], 1e-14);
        }
    }
}

#[test]
fn dahl_s_law_and_straight_unloading_are_its_ends() {
    let mut dahl = Memory::relaxed(MIDDLE);
    law(BETA, 0.0).moved(&mut dahl, MIDDLE + 3e-4, 0.0);
    assert_close(dahl.elements[0], -(-BETA * 3e-4_f64).exp_m1() / BETA, 1e-14);
    let mut straight = Memory::relaxed(MIDDLE);
    let law = law(BETA, BETA);
    law.moved(&mut straight, MIDDLE + 1.0, 0.0);
    assert_close(straight.elements[0], 0.5 / BETA, 1e-15);
    law.moved(&mut straight, MIDDLE + 1.0 - 0.3 / BETA, 0.0);
    assert_close(straight.elements[0], 0.2 / BETA, 1e-12);
}

#[test]
fn a_steady_cycle_costs_the_area_of_its_loop() {
    // Each way: from −z over ℓ back to zero, on to z. μ ∫ζ dx is the way less the change of ζ.
    let largest = 6e-4;
    let (load, unload) = (BETA + GAMMA, BETA - GAMMA);
    let back = |z: f64| (unload * z).ln_1p() / unload;
    let turn = bisect(0.0, 1.0 / load, |z| z + (-load * (2.0 * largest - back(z))).exp_m1() / load);
    let integral = (back(turn) - turn) / unload + (2.0 * largest - back(turn) - turn) / load;
    let motion = Motion::sinusoid(MIDDLE, largest, 1.0, 0.0, Paper::sealed().thread_length).expect("a motion");
    let paper = muscle(law(BETA, GAMMA)).with(|rig| rig.load = Load::Prescribed(motion));
    let run = |duration| paper.run(duration, 1e-11).audit();
    let (before, after) = (run(6.25), run(7.25));
    let per_length = 3.0 * GAUGE / (4.0 * PI * paper.turns * paper.turns);
    let secant = per_length * (MIDDLE + paper.thread_length / 3.0_f64.sqrt());
    let expected = 2.0 * secant * WIDTH * load * integral;
    // The steps are long, since nothing but the motion bounds them; the quadrature over each leaves this.
    assert_close(after.slip - before.slip, expected, 1e-8);
    assert_within(after.hysteresis_storage, before.hysteresis_storage, 1e-8 * expected);
    assert_within(after.load - before.load, -expected, 1e-8 * expected);
    assert_within(after.residual(), 0.0, 1e-10 * after.turnover());
}

#[test]
fn nothing_that_it_does_yields_work() {
    for (beta, gamma) in [(BETA, GAMMA), (BETA, BETA), (BETA, -0.99 * BETA)] {
        let (time, length) = (0..40).map(|k| (0.1 * k as f64, MIDDLE + between(k, 1, -8e-4, 8e-4))).unzip();
        let motion = Motion::table(time, length, Paper::sealed().thread_length).expect("a path");
        let paper = muscle(law(beta, gamma)).with(|rig| rig.load = Load::Prescribed(motion));
        let slips = [0.5, 1.0, 2.0, 3.9].map(|duration| paper.run(duration, 1e-9).audit().slip);
        assert!(slips[0] > 0.0 && slips.windows(2).all(|pair| pair[0] < pair[1]), "{slips:?}");
    }
}

#[test]
fn a_fixed_step_comes_to_the_event_located_run() {
    let paper = muscle(law(BETA, GAMMA)).mass(5.0 * LB).from(0.083, 0.0);
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
    // Between two slips RK4 is as good as the reference already at coarse steps.
    let coarse = error(Method::Rk4, 2e-4);
    assert!(coarse < 1e-10, "{coarse:e}");
    // The stable method has order 2. No spring is stiffer than the muscle's own, 6 P L/(4πn²) where it is longest, with
    // a bristle that is bent the other way.
    let (coarse, fine) = (error(Method::Stable, 1e-3), error(Method::Stable, 5e-4));
    let lengths: Vec<f64> = reference.samples(1e-3).map(|sample| sample.length).collect();
    let (shortest, longest) = lengths.iter().fold((f64::MAX, 0.0_f64), |(low, high), l| (low.min(*l), high.max(*l)));
    let per_length = 3.0 * GAUGE / (4.0 * PI * paper.turns * paper.turns);
    let tangent = WIDTH * (BETA - GAMMA);
    let stiffness = per_length * (2.0 * longest + tangent * (longest + paper.thread_length / 3.0_f64.sqrt()));
    let allowed = stable_error((stiffness / (5.0 * LB)).sqrt(), 1e-3, 0.2, 0.5 * (longest - shortest));
    assert!(coarse < allowed && (3.8..4.2).contains(&(coarse / fine)), "{coarse:e} {fine:e} {allowed:e}");
}

#[test]
fn derivatives_pass_through_reversals_and_zeros() {
    let swing = |beta| muscle(law(beta, GAMMA)).mass(5.0 * LB).from(0.083, 0.0);
    let at = |beta| swing(beta).run(0.15, 1e-12).at(0.15).length;
    let seed = |parameter: &'static mckibben::parameter::Parameter, value: f64| -> crate::common::Seeded {
        let seeded = parameter.key == mckibben::parameter::HYSTERESIS_BETA.key;
        if seeded { Dual::variable(value, 0) } else { Dual::of(value) }
    };
    let (rig, initial) = (swing(BETA).rig().map(seed), swing(BETA).initial().map(seed));
    let start = rig.begin(&initial).expect("a start");
    let exact = simulate(&rig, start, Dual::of(0.15), 1e-12).expect("a run").at(Dual::of(0.15)).length;
    assert_within(exact.value, at(BETA), 1e-13);
    assert_close(exact.slope[0], slope(1.0, |change| at(BETA + change)), 2e-6);
}

#[test]
fn a_steep_law_is_coulomb_friction() {
    let swing = |paper: Paper| {
        let paper = paper.mass(5.0 * LB).gauge(GAUGE);
        let length = paper.balance(5.0 * LB * GRAVITY) + 2e-3;
        let run = paper.from(length, 0.0).run(0.1, 1e-10);
        move |time: f64| run.at(time).length
    };
    let coulomb = swing(muscle(law(BETA, 0.0)).with(|rig| rig.hysteresis = None).friction(0.0, WIDTH));
    let off = |beta: f64| {
        let bent = swing(muscle(law(beta, 0.0)));
        (1..30).map(|k| (bent(0.003 * f64::from(k)) - coulomb(0.003 * f64::from(k))).abs()).fold(0.0, f64::max)
    };
    let (far, near) = (off(1e5), off(1e6));
    assert!(near < 2e-5 && near < 0.5 * far, "{far:e} {near:e}");
}

#[test]
fn what_would_yield_work_is_refused() {
    let refused = |width, beta, gamma| BoucWen::new(width, beta, gamma).expect_err("no law");
    let outside = |error: Error, key: &str| assert!(error.to_string().contains(key), "{error}");
    outside(refused(0.0, 1e3, 0.0), "width");
    outside(refused(1e-4, 0.0, 0.0), "beta");
    outside(refused(1e-4, 1e3, f64::NAN), "gamma");
    outside(refused(1e-4, 1e3, 1.1e3), "beta");
    outside(refused(1e-4, 1e3, -1e3), "beta");
}
