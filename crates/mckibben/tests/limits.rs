//! End effects: slack below the shortest length, a taut braid beyond the longest, and a tendon that only pulls.

use crate::common::{ATMOSPHERE, PSI, Paper, assert_close, assert_within};
use mckibben::force::LengthLimits;
use mckibben::{Braid, Dual, Error};
use proptest::prelude::*;

#[test]
fn the_shortest_length_defaults_to_the_neutral_one() {
    let actuator = Paper::sealed().actuator();
    assert_eq!(actuator.limits().min_length(), actuator.law().law.braid.neutral_length());
}

#[test]
fn a_slack_tendon_pulls_nothing_and_the_actuator_rests_at_its_shortest() {
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    let shortest = actuator.limits().min_length();
    let resting: f64 = actuator.volume(shortest);
    for distance in [0.99999 * shortest, 0.5 * shortest, 0.01 * shortest, -0.01] {
        for velocity in [-3.0, 0.0, 3.0] {
            let tension: f64 = actuator.tension(distance, velocity, ATMOSPHERE + 100.0 * PSI);
            assert_eq!(tension, 0.0, "at {distance} m and {velocity} m/s");
            let volume: f64 = actuator.volume(distance);
            assert_eq!(volume, resting);
            let slack = actuator.limits().is_slack(distance);
            let chamber = actuator.chamber(distance, velocity, 3e5, 1e-5, slack);
            assert_eq!((chamber.volume, chamber.volume_rate), (resting, 0.0));
        }
    }
    // The shortest length itself is not slack.
    assert!(!actuator.limits().is_slack(shortest));
}

#[test]
fn the_taut_braid_adds_a_spring_and_a_damper() {
    let paper = Paper::sealed().friction(0.0, 0.0);
    let actuator = paper.actuator();
    let (pressure, stretch) = (ATMOSPHERE + 2e5, 3e-5);
    let distance = paper.max_length + stretch;
    let inside: f64 = actuator.static_force(distance, pressure);
    for velocity in [-0.04, 0.0, 0.7] {
        let tension: f64 = actuator.tension(distance, velocity, pressure);
        // (14) literally; the stretch itself is the difference of two lengths, good to 1e-17 m of 3e-5 m.
        let literal = inside + paper.limit_stiffness * stretch + paper.limit_damping * velocity;
        assert_close(tension, literal, 1e-12);
    }
    // Rebound: K x + C v is below zero, and the braid does not push; the gas still pulls.
    let tension: f64 = actuator.tension(distance, -0.06, pressure);
    assert_eq!(tension, inside);
    // Not yet taut: nothing is added, however fast it goes.
    let tension: f64 = actuator.tension(paper.max_length, 5.0, pressure);
    assert_eq!(tension, actuator.static_force::<f64>(paper.max_length, pressure));
}

#[test]
fn the_stored_energy_is_what_the_spring_took() {
    let actuator = Paper::sealed().actuator();
    let limits = actuator.limits();
    let longest = limits.max_length();
    for stretch in [1e-6, 1e-5, 3e-4] {
        let energy = limits.stored_energy(Dual::<f64, 1>::variable(longest + stretch, 0));
        let force: f64 = limits.force(longest + stretch, 0.0);
        assert_close(energy.slope[0], force, 1e-13);
        assert_close(energy.value, 0.5 * limits.stiffness() * stretch * stretch, 1e-9);
    }
    assert_eq!(limits.stored_energy::<f64>(longest), 0.0);
    assert_eq!(limits.stored_energy::<f64>(0.5 * longest), 0.0);
}

#[test]
fn limits_out_of_order_are_refused() {
    let braid = Braid::new(0.11, 2.5).expect("a braid");
    let refuse = |min: Option<f64>, max: f64| match LengthLimits::new(&braid, min, max, 1e5, 100.0) {
        Err(Error::Inconsistent { parameter, requirement, .. }) => (parameter.key, requirement.other),
        other => panic!("{other:?}"),
    };
    assert_eq!(refuse(None, 0.11), ("actuator.max_length", "actuator.thread_length"));
    assert_eq!(refuse(None, 0.12), ("actuator.max_length", "actuator.thread_length"));
    assert_eq!(refuse(Some(0.1), 0.1), ("actuator.min_length", "actuator.max_length"));
    assert_eq!(refuse(None, 0.06), ("actuator.max_length", "actuator.thread_length/sqrt(3)"));
    for (min, max, stiffness, damping) in
        [(Some(0.0), 0.1, 1e5, 0.0), (None, -0.1, 1e5, 0.0), (None, 0.1, 0.0, 0.0), (None, 0.1, 1e5, -1.0)]
    {
        let result = LengthLimits::new(&braid, min, max, stiffness, damping);
        assert!(matches!(result, Err(Error::OutOfRange { .. })), "{result:?}");
    }
    assert!(LengthLimits::new(&braid, Some(0.05), 0.1, 1e5, 0.0).is_ok());
}

proptest! {
    #[test]
    fn the_tension_is_never_negative_and_the_braid_never_pushes(
        distance in 0.0..0.1097_f64, velocity in -20.0..20.0_f64, pressure in 1e3..1e6_f64, shortest in 0.03..0.09_f64,
    ) {
        let paper = Paper::sealed().with(|rig| rig.min_length = Some(shortest));
        let actuator = paper.actuator();
        let tension: f64 = actuator.tension(distance, velocity, pressure);
        prop_assert!(tension >= 0.0);
        let limit: f64 = actuator.limits().force(distance, velocity);
        prop_assert!(limit >= 0.0);
        // Taking the braid's limit away can only lessen the tension.
        let soft = paper.with(|rig| (rig.limit_stiffness, rig.limit_damping) = (1e-9, 0.0)).actuator();
        prop_assert!(soft.tension::<f64>(distance, velocity, pressure) <= tension + 1e-9);
    }

    #[test]
    fn the_tension_is_continuous_at_the_longest_length_on_the_way_back(velocity in -1.0..0.0_f64, gauge in 0.0..6e5_f64) {
        let actuator = Paper::sealed().actuator();
        let longest = actuator.limits().max_length();
        let at = |distance: f64| -> f64 { actuator.tension(distance, velocity, ATMOSPHERE + gauge) };
        // The slope beyond is 1.75e5 N/m at most: 1e-12 m make less than a micronewton.
        assert_within(at(longest + 1e-12), at(longest), 1e-6);
    }
}
