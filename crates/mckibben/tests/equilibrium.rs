//! The pressure at which an actuator bears a pull, and the length: against the closed form of the ideal braid, against SciPy, and at
//! the edges of its reach.

use crate::common::Paper;
use mckibben::GaugePressure;
use mckibben::force::{Characteristic, Effectiveness, Law, MartensBoblan};

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

/// The 20 mm muscle of Martens & Boblan (2017), table 1, whose membrane softens where it is long, so that its force falls with the
/// length on a part of its range. At 4 bar it bears 3 kg at 238.07 mm and, unstable, at 202.69 mm: roots of (11) there by Brent's
/// method in SciPy.
#[test]
fn the_longest_length_at_which_the_force_rises_bears_the_pull() {
    let (rest, diameter, angle) = (0.3, 0.026_444, f64::to_radians(30.007));
    let thread = rest / angle.cos();
    let turns = thread * angle.sin() / (std::f64::consts::PI * diameter);
    let muscle = Paper::sealed().with(|rig| {
        (rig.thread_length, rig.turns, rig.max_length) = (thread, turns, rest);
        rig.min_length = Some(0.58 * thread);
    });
    let modulus = [1_279.299_36e6, -13_723.543_96e6, 49_023.326_6e6, -58_017.709_3e6];
    let law = MartensBoblan::new(&muscle.braid(), rest, 1.8e-3, modulus).expect("a law");
    let law = Characteristic::new(muscle.braid(), Law::MartensBoblan(law));
    let actuator = muscle.with(|rig| rig.characteristic = Some(law)).actuator();
    let at = |bar: f64| GaugePressure(1e5 * bar).absolute(actuator.air().atmosphere());
    let length = actuator.length_under(3.0 * 9.806_65, at(4.0)).expect("a length");
    assert!((length - 0.238_07).abs() < 1e-5, "{length}");
    // Without pressure it hangs on the taut braid.
    let length = actuator.length_under(5.0 * 9.806_65, at(0.0)).expect("a length");
    let taut = actuator.static_force(length, at(0.0).0) + actuator.limits().force(length, 0.0);
    assert!(length > rest && length < 0.301, "{length}");
    assert!((taut - 5.0 * 9.806_65).abs() < 1e-6, "{taut}");
}
