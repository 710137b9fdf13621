//! The pressure at which an actuator bears a pull: against the closed form of the ideal braid, and at the edges of its reach.

use crate::common::Paper;
use mckibben::GaugePressure;

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
