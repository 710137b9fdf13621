//! Friction: the law of (12), and what it does to a ring-down.
//!
//! The decrement in closed form. A sealed muscle of tangent stiffness `k_t` that carries a mass swings about its
//! equilibrium; Coulomb friction `Q k_sec` shifts the centre of each half cycle by `Q k_sec/k_t` against the motion, so
//! a half cycle ends `2 Q k_sec/k_t` nearer. The paper's `4Q` a cycle is the case `k_sec = k_t`. The limit is that of
//! small amplitudes `a`, in which k_sec and k_t are constant: the error is of the order `a/L`.

use crate::common::{ATMOSPHERE, GRAVITY, LB, LBF, PSI, Paper, assert_close, assert_within, bisect};
use mckibben::force::StaticForce;
use mckibben::friction::Friction;
use mckibben::simulation::{EventKind, Sliding};
use mckibben::{Error, GaugePressure};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// `3 P_g Eff (L + L_min)/(4πn²)`, the secant stiffness of (13) without its 0/0.
fn secant(paper: &Paper, length: f64, gauge: f64) -> f64 {
    let shortest = paper.thread_length / 3.0_f64.sqrt();
    3.0 * gauge * (length + shortest) / (4.0 * PI * paper.turns.powi(2))
}

#[test]
fn the_law_is_viscous_plus_coulomb() {
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    for (length, velocity, gauge) in [(0.08, 0.3, 2e5), (0.09, -0.3, 4e5), (0.075, -1e-9, 6e5)] {
        let resting: f64 = actuator.static_force(length, ATMOSPHERE + gauge);
        let moving: f64 = actuator.tension(length, velocity, ATMOSPHERE + gauge);
        let literal =
            paper.viscous * velocity + paper.coulomb_width * secant(&paper, length, gauge) * velocity.signum();
        assert_within(moving - resting, literal, 1e-13 * resting.abs() + 1e-13);
        // At rest: the middle of the set.
        assert_eq!(actuator.tension::<f64>(length, 0.0, ATMOSPHERE + gauge), resting);
    }
}

#[test]
fn the_papers_secant_is_that_of_the_force() {
    // (13) literally, away from its 0/0.
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    let shortest = actuator.limits().min_length();
    let gauge = 60.0 * PSI;
    for length in [0.07, 0.08, 0.097] {
        let force = |length: f64| -> f64 { actuator.law().force(length, GaugePressure(gauge)) };
        let literal = (force(length) - force(shortest)) / (length - shortest);
        assert_close(actuator.coulomb_bound(length, ATMOSPHERE + gauge), paper.coulomb_width * literal, 1e-12);
    }
    // At the shortest length the step of (12) does not vanish.
    let bound: f64 = actuator.coulomb_bound(shortest, ATMOSPHERE + gauge);
    assert_close(bound, paper.coulomb_width * secant(&paper, shortest, gauge), 1e-13);
    assert!(bound > 0.0);
}

#[test]
fn a_bladder_under_vacuum_is_off_the_braid_and_has_no_friction() {
    let actuator = Paper::sealed().actuator();
    assert_eq!(actuator.coulomb_bound::<f64>(0.09, 0.5 * ATMOSPHERE), 0.0);
    assert_eq!(actuator.coulomb_bound::<f64>(0.09, ATMOSPHERE), 0.0);
    assert!(actuator.coulomb_bound::<f64>(0.09, 1.5 * ATMOSPHERE) > 0.0);
}

#[test]
fn negative_friction_is_refused() {
    for (viscous, width, key) in [
        (-1.0, 0.0, "actuator.friction.viscous"),
        (0.0, -1e-9, "actuator.friction.coulomb_width"),
        (f64::NAN, 0.0, "actuator.friction.viscous"),
    ] {
        match Friction::new(viscous, width) {
            Err(Error::OutOfRange { parameter, .. }) => assert_eq!(parameter.key, key),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(Friction::new(0.0, 0.0), Ok(Friction::NONE));
    assert!(!Friction::NONE.has_coulomb());
}

#[test]
fn the_area_of_a_quasi_static_loop_is_the_coulomb_loss() {
    // ∮F dL at constant pressure between two lengths: 2 Q ∫k_sec dL, and k_sec is linear in L.
    let paper = Paper::sealed().friction(0.0, 1.1e-4);
    let actuator = paper.actuator();
    let (gauge, low, high) = (3e5, 0.07, 0.095);
    let at = |length: f64, sliding: f64| -> f64 { actuator.tension_sliding(length, 0.0, ATMOSPHERE + gauge, sliding) };
    let middle = 0.5 * (low + high);
    let simpson = |f: &dyn Fn(f64) -> f64| (high - low) / 6.0 * (f(low) + 4.0 * f(middle) + f(high));
    let area = simpson(&|length| at(length, 1.0) - at(length, -1.0));
    let expected = 2.0 * 1.1e-4 * secant(&paper, middle, gauge) * (high - low);
    assert_close(area, expected, 1e-12);
}

proptest! {
    #[test]
    fn friction_never_gives_energy(
        length in 0.065..0.0975_f64, velocity in -5.0..5.0_f64, pressure in 1e4..1e6_f64, c in 0.0..50.0_f64, q in 0.0..1e-3_f64,
    ) {
        let actuator = Paper::sealed().friction(c, q).actuator();
        let factors: [f64; 2] = actuator.factors(length, pressure);
        let resting: f64 = actuator.signed_force([length, 0.0, pressure], 0.0, false, factors);
        let moving: f64 = actuator.signed_force([length, velocity, pressure], f64::signum(velocity), false, factors);
        prop_assert!((moving - resting) * velocity >= -1e-12);
        // Odd in the velocity.
        let back: f64 = actuator.signed_force([length, -velocity, pressure], -f64::signum(velocity), false, factors);
        prop_assert!((moving + back - 2.0 * resting).abs() <= 1e-12 * (1.0 + resting.abs()));
    }
}

/// A sealed muscle at 60 psi under 6 lb, and its static length in closed form.
fn ring_down(viscous: f64, width: f64) -> (Paper, f64) {
    let paper = Paper::sealed().friction(viscous, width).mass(6.0 * LB).gauge(60.0 * PSI);
    let middle = paper.balance(6.0 * LBF);
    (paper, middle)
}

/// (5) at an isentropic sealed chamber, by hand.
fn sealed_stiffness(paper: &Paper, length: f64) -> f64 {
    let (b, n, gauge) = (paper.thread_length, paper.turns, paper.gauge);
    let volume = length * (b * b - length * length) / (4.0 * PI * n * n) + paper.external_volume;
    let slope = (b * b - 3.0 * length * length) / (4.0 * PI * n * n);
    3.0 * gauge * length / (2.0 * PI * n * n) + 1.4 * (gauge + ATMOSPHERE) * slope * slope / volume
}

#[test]
fn coulomb_friction_takes_the_same_length_each_cycle() {
    let width = 1e-7;
    let (paper, middle) = ring_down(0.0, width);
    let tangent = sealed_stiffness(&paper, middle);
    let friction = width * secant(&paper, middle, paper.gauge);
    let shift = friction / tangent;
    // Neither stiffness is the other: the paper's 4Q would be off by this much.
    assert!((shift / width - 1.0).abs() > 0.1, "k_sec/k_t = {}", shift / width);
    // Starts 12.5 shifts away; the pressure there follows the volume from the equilibrium's, as the closed form has it.
    let amplitude = 12.5 * shift;
    let start = middle + amplitude;
    let volume = |length: f64| -> f64 { paper.actuator().volume(length) };
    let gauge = (paper.gauge + ATMOSPHERE) * (volume(middle) / volume(start)).powf(1.4) - ATMOSPHERE;
    let paper = paper.gauge(gauge).from(start, 0.0);
    let run = paper.run(2.0, 1e-13);
    let turns: Vec<f64> = run
        .events()
        .iter()
        .filter(|event| matches!(event.kind, EventKind::Reversal | EventKind::Stick))
        .map(|event| run.at(event.time).length - middle)
        .collect();
    // 12.5 → 10.5 → 8.5 → … → 0.5, where k_t x < Q k_sec and friction holds it.
    assert_eq!(turns.len(), 6, "{turns:?}");
    // a/L is 1.5e-5; of a full cycle's drop that is an error of the same order.
    for cycle in [[start - middle, turns[1]], [turns[1], turns[3]], [turns[3], turns[5]]] {
        assert_close(cycle[0] - cycle[1], 4.0 * shift, 1e-4);
    }
    for half in [[turns[0], turns[2]], [turns[2], turns[4]]] {
        assert_close(half[1] - half[0], 4.0 * shift, 1e-4);
    }
    let last = run.events().last().expect("an event");
    assert_eq!((last.kind, last.after.sliding), (EventKind::Stick, Sliding::Stuck));
    // Each half cycle lasts half a period of the frictionless oscillator.
    let period = TAU / (tangent / (6.0 * LB)).sqrt();
    assert_close(last.time, 3.0 * period, 1e-4);
    // At rest it pulls as much as the load.
    assert_close(run.at(2.0).tension, 6.0 * LB * GRAVITY, 1e-15);
}

#[test]
fn viscous_friction_takes_the_same_share_each_cycle() {
    let viscous = 3.5;
    let (paper, middle) = ring_down(viscous, 0.0);
    let mass = 6.0 * LB;
    let (rate, decay) = (sealed_stiffness(&paper, middle) / mass, viscous / (2.0 * mass));
    let period = TAU / (rate - decay * decay).sqrt();
    // x is 1e-4 m/s over 50/s, 2e-6 m: the error of the linear oscillator is of the order x/L = 2e-5 in one
    // direction and, as both directions alternate, of its square over a full cycle.
    let paper = paper.from(middle, 1e-4);
    let run = paper.run(3.5 * period, 1e-13);
    let crossing = |cycle: f64| {
        let near = (cycle + 0.25) * period;
        bisect(near - 0.1 * period, near + 0.1 * period, |time| -run.at(time).velocity)
    };
    let peaks: Vec<(f64, f64)> =
        [0.0, 1.0, 2.0, 3.0].map(|k| (crossing(k), run.at(crossing(k)).length - middle)).to_vec();
    for pair in peaks.windows(2) {
        assert_close(pair[1].0 - pair[0].0, period, 1e-6);
        assert_close(pair[1].1 / pair[0].1, (-decay * period).exp(), 1e-5);
    }
}
