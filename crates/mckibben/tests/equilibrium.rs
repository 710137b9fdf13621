//! The pressure at which an actuator bears a pull: against the closed form of the ideal braid, and at the edges of its reach.

use crate::common::Paper;
use mckibben::GaugePressure;
use mckibben::force::Effectiveness;

#[test]
fn the_pressure_of_a_pull_is_that_of_the_ideal_braid() {
    let actuator = Paper::sealed().actuator();
    let limits = actuator.limits();
    let (thread, turns) = (actuator.law().law.braid.thread_length(), actuator.law().law.braid.turns());
    let most = GaugePressure(7e5);
    for share in [0.1, 0.5, 0.9] {
        let length = limits.min_length() + share * (limits.max_length() - limits.min_length());
        // (1): F = P (3 L² − b²)/(4 π n²).
        let area = (3.0 * length * length - thread * thread) / (4.0 * std::f64::consts::PI * turns * turns);
        for pull in [1.0, 20.0, 0.9 * area * most.0] {
            let found = actuator.pressure_under(length, pull, most);
            let closed = pull / area;
            match found {
                Some(GaugePressure(found)) => assert!((found / closed - 1.0).abs() < 1e-12, "{length} {pull} {found}"),
                None => assert!(closed > most.0, "{length} {pull}: {closed}"),
            }
        }
        assert_eq!(actuator.pressure_under(length, 1.01 * area * most.0, most), None, "more than the supply gives");
    }
}

#[test]
fn what_is_out_of_reach_has_no_pressure() {
    let actuator = Paper::sealed().actuator();
    let (shortest, longest) = (actuator.limits().min_length(), actuator.limits().max_length());
    let most = GaugePressure(7e5);
    assert_eq!(actuator.pressure_under(0.999 * shortest, 1.0, most), None);
    assert_eq!(actuator.pressure_under(1.001 * longest, 1.0, most), None);
    for pull in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(actuator.pressure_under(0.5 * (shortest + longest), pull, most), None, "{pull}");
    }
    assert_eq!(actuator.pressure_under(longest, 0.0, most), Some(GaugePressure(0.0)));
}

/// The effectiveness 1 - P/P0 makes the force of the ideal braid a parabola over the pressure: highest at half of P0, where it just
/// reaches a pull a billionth below.
#[test]
fn a_pull_that_the_force_just_reaches_has_its_least_pressure() {
    let zero = 5e5;
    let falling = Effectiveness::polynomial(&[1.0, -1.0 / zero]).expect("a law");
    let paper = Paper::sealed();
    let [ideal, actuator] =
        [paper.clone(), paper.with(|rig| rig.effectiveness = falling)].map(|paper| paper.actuator());
    let length = 0.5 * (ideal.limits().min_length() + ideal.limits().max_length());
    let per_pressure = ideal.static_force(length, GaugePressure(1e5).absolute(ideal.air().atmosphere()).0) / 1e5;
    for most in [3e5, 4.9e5, 7e6] {
        for below in [1e-9, 1e-4, 0.1, 0.9] {
            let pull = 0.25 * zero * per_pressure * (1.0 - below);
            let found = actuator.pressure_under(length, pull, GaugePressure(most)).expect("a pressure").0;
            let closed = 0.5 * zero * (1.0 - f64::sqrt(below));
            assert!((found / closed - 1.0).abs() < 1e-6, "{most} {below}: {found} is not {closed}");
        }
        assert_eq!(actuator.pressure_under(length, 0.2501 * zero * per_pressure, GaugePressure(most)), None);
    }
}
