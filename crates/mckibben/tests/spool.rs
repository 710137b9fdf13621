//! The proportional spool: its equation of motion, the textbook's step response, stops and edges.

use crate::common::{assert_close, assert_within};
use mckibben::valve::{Spool, SpoolMotion};
use mckibben::{Dual, Error};
use std::f64::consts::{PI, TAU};

const FREQUENCY: f64 = 100.0;

fn spool(zeta: f64) -> Spool {
    Spool::new(FREQUENCY, zeta, 0.0, 0.0).expect("a spool")
}

fn step(command: f64) -> SpoolMotion {
    SpoolMotion { time: 0.0, position: 0.0, velocity: 0.0, command }
}

#[test]
fn the_motion_obeys_its_equation() {
    for zeta in [0.05, 0.5, 0.999_999, 1.0, 1.000_001, 1.3, 6.0] {
        let spool = spool(zeta);
        let motion = SpoolMotion { time: 0.2, position: -0.3, velocity: 150.0, command: 0.4 };
        let [position, velocity] = spool.at(&motion, 0.2_f64);
        assert_within(position, -0.3, 1e-15);
        assert_close(velocity, 150.0, 1e-15);
        for n in 1..200 {
            let time = 0.2 + 0.23e-3 * f64::from(n);
            let [x, v]: [Dual<f64, 1>; 2] = spool.at(&motion, Dual::variable(time, 0));
            // ẋ is the slope of x, and the slope of ẋ is the acceleration: to rounding of the terms that it sums.
            let scale = TAU * FREQUENCY * (1.0 + zeta);
            assert_within(x.slope[0], v.value, 1e-12 * scale);
            let acceleration = spool.acceleration(x.value, v.value, 0.4);
            assert_within(v.slope[0], acceleration, 1e-12 * scale * scale);
        }
    }
}

#[test]
fn the_motion_does_not_jump_at_the_critical_damping() {
    let motion = SpoolMotion { time: 0.0, position: 0.1, velocity: -20.0, command: -0.5 };
    for time in [1e-4, 1e-3, 1e-2, 0.05] {
        let at = |zeta: f64| spool(zeta).at(&motion, time)[0];
        for apart in [1e-3, 1e-6, 1e-9] {
            assert_within(at(1.0 + apart), at(1.0), 2.0 * apart);
            assert_within(at(1.0 - apart), at(1.0), 2.0 * apart);
        }
    }
}

#[test]
fn a_step_overshoots_as_the_textbook_says() {
    for zeta in [0.1, 0.3, 0.6, 0.8] {
        let root = f64::sqrt(1.0 - zeta * zeta);
        let peak = PI / (TAU * FREQUENCY * root);
        let overshoot = f64::exp(-PI * zeta / root);
        let [position, velocity] = spool(zeta).at(&step(0.5), peak);
        assert_close(position, 0.5 * (1.0 + overshoot), 1e-12);
        assert_within(velocity, 0.0, 1e-9 * TAU * FREQUENCY);
    }
    // Long after, it is where it was commanded.
    for zeta in [0.1, 1.0, 3.0] {
        assert_close(spool(zeta).at(&step(0.5), 2.0_f64)[0], 0.5, 1e-12);
    }
}

#[test]
fn a_swing_beyond_the_stroke_meets_the_stop() {
    // 0.8 (1 + overshoot) = 1 at an overshoot of a quarter, ζ = ln 4/√(π² + ln² 4) = 0.4037.
    let limit = {
        let log = 4.0_f64.ln();
        log / (PI * PI + log * log).sqrt()
    };
    assert_eq!(spool(limit * 1.001).meets_stop(&step(0.8)), None);
    let at = spool(limit * 0.999).meets_stop(&step(0.8)).expect("it meets the stop");
    let [position, velocity] = spool(limit * 0.999).at(&step(0.8), at);
    assert_within(position, 1.0, 1e-12);
    assert!(velocity > 0.0);
    let peak = PI / (TAU * FREQUENCY * (1.0 - limit * limit).sqrt());
    assert!(at < peak && peak < 1.1 * at, "{at} {peak}");
    // From rest at the stop it leaves when it is drawn back, and may swing to the other.
    let back = SpoolMotion { time: 1.0, position: 1.0, velocity: 0.0, command: -0.9 };
    let other = spool(0.2).meets_stop(&back).expect("the other stop");
    assert_within(spool(0.2).at(&back, other)[0], -1.0, 1e-12);
    assert!(other > 1.0);
    // What is commanded to stay stays; what creeps does not swing; what is thrown hits.
    assert_eq!(spool(0.2).meets_stop(&SpoolMotion { command: 1.0, ..back }), None);
    assert_eq!(spool(1.5).meets_stop(&back), None);
    let thrown = SpoolMotion { time: 0.0, position: 0.9, velocity: 5e3, command: 0.0 };
    let hit = spool(1.5).meets_stop(&thrown).expect("the stop");
    assert_within(spool(1.5).at(&thrown, hit)[0], 1.0, 1e-9);
    assert_eq!(spool(1.5).meets_stop(&SpoolMotion { velocity: 10.0, ..thrown }), None);
}

#[test]
fn the_edges_open_after_their_overlap() {
    let spool = Spool::new(FREQUENCY, 0.7, 0.05, 0.1).expect("a spool with a dead zone");
    for position in [-0.1, 0.0, 0.05] {
        assert_eq!(spool.openings(position), [0.0, 0.0], "{position}");
    }
    let [supply, exhaust] = spool.openings(0.525);
    assert_within(supply, 0.5, 1e-15);
    assert_eq!(exhaust, 0.0);
    assert_within(spool.openings(-0.55)[1], 0.5, 1e-15);
    assert_eq!((spool.openings(1.0), spool.openings(-1.0)), ([1.0, 0.0], [0.0, 1.0]));
    let edge: [Dual<f64, 1>; 2] = spool.openings(Dual::variable(0.4, 0));
    assert_close(edge[0].slope[0], 1.0 / 0.95, 1e-14);

    let under = Spool::new(FREQUENCY, 0.7, -0.25, -0.25).expect("an underlapped spool");
    let [supply, exhaust] = under.openings(0.0);
    assert_close(supply, 0.2, 1e-14);
    assert_close(exhaust, 0.2, 1e-14);
    assert_eq!(under.openings(0.25)[1], 0.0);
    assert_eq!(under.openings(1.0), [1.0, 0.0]);
}

#[test]
fn spools_outside_physics_are_refused() {
    let cases = [
        ((0.0, 0.7, 0.0, 0.0), "valve.spool.natural_frequency"),
        ((1.0, 0.0, 0.0, 0.0), "valve.spool.damping_ratio"),
        ((1.0, 0.7, 1.0, 0.0), "valve.spool.supply_overlap"),
        ((1.0, 0.7, 0.0, -1.0), "valve.spool.exhaust_overlap"),
    ];
    for ((frequency, zeta, supply, exhaust), key) in cases {
        match Spool::new(frequency, zeta, supply, exhaust) {
            Err(Error::OutOfRange { parameter, .. }) => assert_eq!(parameter.key, key),
            other => panic!("{other:?}"),
        }
    }
}
