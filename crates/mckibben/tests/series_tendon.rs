//! An elastic tendon in series with a modular actuator.

use crate::common::{Paper, assert_close, assert_within, bisect};
use mckibben::control::Drive;
use mckibben::simulation::{ModularActuator, SeriesTendon, TendonActuator};
use mckibben::valve::Request;

const FREQUENCY: f64 = 25.0;

/// A sealed muscle of 3 bar without dry friction, on a tendon of 20 kN/m and 50 mm.
fn sealed(viscous: f64) -> (Paper, TendonActuator) {
    let paper = Paper::sealed().friction(viscous, 0.0).gauge(3e5).from(0.085, 0.0);
    let tendon = SeriesTendon::new(2e4, 0.05).expect("a tendon");
    let actuator = TendonActuator::new(&paper.rig(), paper.start(), FREQUENCY, tendon).expect("an actuator");
    (paper, actuator)
}

#[test]
fn both_springs_share_what_the_ends_are_moved() {
    const STEPS: i32 = 20;
    let (paper, mut pulled) = sealed(0.0);
    let (actuator, start) = (paper.actuator(), paper.start());
    let from = pulled.distance();
    assert_close(pulled.tension(), actuator.static_force(start.length, start.pressure.0), 1e-12);
    for (visit, change) in [(0, 2e-3), (1, -4e-3), (2, 1e-3)] {
        let (begin, distance) = (pulled.distance(), from + change);
        for step in 1..=STEPS {
            let time = f64::from(visit * STEPS + step) * 1e-3;
            pulled.move_to(time, begin + (distance - begin) * f64::from(step) / f64::from(STEPS)).expect("a step");
        }
        // P V^γ of the sealed air, and equal tensions.
        let gas = start.pressure.0 * actuator.volume(start.length).powf(1.4);
        let tension = |length: f64| actuator.static_force(length, gas / actuator.volume(length).powf(1.4));
        let length = bisect(0.07, 0.1, |length| tension(length) - 2e4 * (distance - 0.05 - length));
        // The engine's pressure follows the volume by the stable method, of order 2 in the motion of a step: the whole way
        // in one would be 4 µm off.
        assert_within(pulled.actuator().state().length, length, 2e-8);
        let state = pulled.actuator().state();
        assert_close(pulled.tension(), actuator.static_force(state.length, state.pressure.0), 1e-9);
    }
}

#[test]
fn a_stiff_tendon_is_none() {
    let paper = Paper::pwm(FREQUENCY, 0.5).friction(50.0, 0.0).gauge(2e5).from(0.085, 0.0);
    let pulses = Drive::Pulses { duty: 0.5, pulse: Request::Fill, rest: Request::Exhaust };
    let mut alone = ModularActuator::new(&paper.rig(), paper.start(), FREQUENCY).expect("an actuator");
    let tendon = SeriesTendon::new(1e9, 0.0).expect("a tendon");
    let mut pulled = TendonActuator::new(&paper.rig(), paper.start(), FREQUENCY, tendon).expect("an actuator");
    alone.drive(pulses).expect("pulses");
    pulled.drive(pulses).expect("pulses");
    let offset = pulled.distance() - alone.state().length;
    for step in 1..=200 {
        let (time, change) = (f64::from(step) * 1e-3, 3e-3 * (f64::from(step) * 0.05).sin());
        alone.move_to(time, 0.085 + change).expect("a step");
        pulled.move_to(time, 0.085 + offset + change).expect("a step");
        // At most 100 N on 1e9 N/m is 0.1 µm, of a stiffness of some 10 kN/m: a millinewton, and 50 N·s/m of its rate.
        assert_within(pulled.actuator().state().length, alone.state().length, 1e-7);
        assert_close(pulled.actuator().state().pressure.0, alone.state().pressure.0, 1e-5);
    }
}

#[test]
fn dry_friction_holds_the_actuator_while_the_tendon_gives() {
    let paper = Paper::sealed().friction(0.0, 4e-4).gauge(3e5).from(0.085, 0.0);
    let tendon = SeriesTendon::new(2e4, 0.05).expect("a tendon");
    let mut pulled = TendonActuator::new(&paper.rig(), paper.start(), FREQUENCY, tendon).expect("an actuator");
    let start = pulled.actuator().state();
    let friction = paper.actuator().coulomb_bound(start.length, start.pressure.0);
    let (from, tension) = (pulled.distance(), pulled.tension());
    for (step, part) in [0.5, -0.5, 0.9, 0.0].into_iter().enumerate() {
        let change = part * friction / 2e4;
        pulled.move_to((step + 1) as f64 * 1e-3, from + change).expect("a step");
        assert_within(pulled.actuator().state().length, start.length, 1e-12);
        assert_within(pulled.tension() - tension, 2e4 * change, 1e-6);
    }
    pulled.move_to(5e-3, from + 1.5 * friction / 2e4).expect("a step");
    assert!(pulled.actuator().state().length > start.length + 1e-6);
}

#[test]
fn a_viscous_actuator_relaxes_at_the_rate_of_both_springs_on_its_damper() {
    let (viscous, change) = (500.0, 1e-6);
    let (paper, _) = sealed(viscous);
    let start = paper.start();
    let own = paper.actuator().sealed_stiffness(start.length, start.pressure);
    let (rate, duration) = ((2e4 + own) / viscous, 0.02);
    let lag = |steps: u32| {
        let (_, mut pulled) = sealed(viscous);
        let distance = pulled.distance() + change;
        for step in 1..=steps {
            pulled.move_to(duration * f64::from(step) / f64::from(steps), distance).expect("a step");
        }
        let share = 2e4 / (2e4 + own);
        1.0 - (pulled.actuator().state().length - start.length) / (share * change)
    };
    // The implicit Euler method on a linear relaxation, to the nonlinearity of a micrometre and the air's own error.
    let euler = |steps: u32| (1.0 + rate * duration / f64::from(steps)).powi(-(steps as i32));
    for steps in [10, 40] {
        assert_within(lag(steps), euler(steps), 1e-3);
    }
    let error = |steps| (lag(steps) - (-rate * duration).exp()).abs();
    let order = (error(20) / error(80)).log2() / 2.0;
    assert!((0.8..1.2).contains(&order), "{order}");
}

#[test]
fn a_tendon_that_is_let_go_hangs_loose() {
    let (paper, mut pulled) = sealed(0.0);
    let rest = paper.balance(0.0);
    pulled.move_to(1e-3, 0.05 + 0.5 * rest).expect("a step");
    assert_eq!(pulled.tension(), 0.0);
}

#[test]
fn numbers_outside_their_range_are_named_and_a_step_that_fails_changes_nothing() {
    let error = SeriesTendon::new(0.0, 0.1).expect_err("no stiffness").to_string();
    assert!(error.contains("tendon.stiffness"), "{error}");
    let error = SeriesTendon::new(1e4, f64::NAN).expect_err("no length").to_string();
    assert!(error.contains("tendon.rest_length"), "{error}");
    let (_, mut pulled) = sealed(10.0);
    let (before, distance) = (pulled.actuator().state(), pulled.distance());
    assert!(pulled.move_to(0.0, distance).is_err());
    assert_eq!((pulled.actuator().state(), pulled.distance()), (before, distance));
}
