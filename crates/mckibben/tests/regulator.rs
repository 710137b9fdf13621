//! The proportional pressure regulator: its equation, the limit of its rate, dead time, and what flows through it.

use crate::common::{ATMOSPHERE, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Chamber;
use mckibben::valve::{Port, Regulated, Regulator};
use mckibben::{AbsolutePressure, Dual, Error};

const TAU: f64 = 0.03;
const LIMIT: f64 = 2e6;

fn regulator() -> Regulator {
    Regulator::new(TAU, 5e-3, LIMIT).expect("a regulator")
}

fn course(pressure: f64, setpoint: f64) -> Regulated {
    Regulated { time: 0.1, pressure: AbsolutePressure(pressure), setpoint: AbsolutePressure(setpoint) }
}

#[test]
fn the_pressure_obeys_its_equation() {
    for (pressure, setpoint) in [(1e5, 1.3e5), (1e5, 5e5), (6e5, 1e5), (3e5, 3e5)] {
        let course = course(pressure, setpoint);
        assert_close(regulator().pressure(&course, 0.1_f64), pressure, 1e-15);
        for n in 1..300 {
            let time = 0.1 + 1.037e-3 * f64::from(n);
            let at: Dual<f64, 1> = regulator().pressure(&course, Dual::variable(time, 0));
            assert_within(at.slope[0], regulator().rate(at.value, setpoint), 1e-9 * LIMIT);
            assert!(at.slope[0].abs() <= LIMIT * (1.0 + 1e-12));
        }
        assert_close(regulator().pressure(&course, 3.0_f64), setpoint, 1e-12);
    }
}

#[test]
fn a_small_step_is_first_order_and_a_large_one_starts_straight() {
    // Within q τ = 0.6 bar the limit is never reached.
    let small = course(2e5, 2.5e5);
    assert_close(regulator().pressure(&small, 0.1 + TAU), 2.5e5 - 5e4 / std::f64::consts::E, 1e-12);
    // Beyond, a line until 0.6 bar are left: 4 bar up take (4 − 0.6)/20 s.
    let large = course(1e5, 5e5);
    let straight = 3.4e5 / LIMIT;
    assert_close(regulator().pressure(&large, 0.1 + 0.5 * straight), 1e5 + 0.5 * 3.4e5, 1e-12);
    assert_close(regulator().pressure(&large, 0.1 + straight), 5e5 - 6e4, 1e-12);
    assert_close(regulator().pressure(&large, 0.1 + straight + TAU), 5e5 - 6e4 / std::f64::consts::E, 1e-12);
}

#[test]
fn a_setpoint_acts_after_the_dead_time_and_within_the_supply() {
    let valve = Paper::pwm(25.0, 0.5).valve();
    let before = course(2e5, 3e5);
    let next = regulator().set(&before, 0.2, AbsolutePressure(4e5), &valve);
    assert_close(next.time, 0.205, 1e-15);
    assert_eq!(next.pressure.0, regulator().pressure(&before, next.time));
    assert_eq!(next.setpoint.0, 4e5);
    let supply = valve.port_pressure(Port::Supply);
    assert_eq!(regulator().set(&before, 0.2, AbsolutePressure(9e9), &valve).setpoint.0, supply);
    assert_eq!(regulator().set(&before, 0.2, AbsolutePressure(1.0), &valve).setpoint.0, ATMOSPHERE);
}

#[test]
fn air_flows_to_and_from_the_regulated_pressure() {
    let valve = Paper::pwm(25.0, 0.5).valve();
    let chamber = |pressure: f64| Chamber::new(pressure, pressure * 1e-5 / (286.99 * ROOM), 1e-5, 0.0);
    let flow = |at: f64| regulator().flow(&valve, 4e5, &chamber(at));
    assert_eq!(flow(4e5).net(), 0.0);
    assert!(flow(3e5).inward > 0.0 && flow(3e5).outward == 0.0);
    assert!(flow(5e5).outward > 0.0 && flow(5e5).inward == 0.0);
    // Set to the pressure of a port it is a passage to that port.
    for port in [Port::Supply, Port::Exhaust] {
        let there = valve.port_pressure(port);
        assert_eq!(regulator().flow(&valve, there, &chamber(3e5)), valve.flow(port, &chamber(3e5)));
    }
    // The limit of the flow: choked by the paper's constant, 0.04042 s·√K/m.
    assert_close(flow(1e5).inward, 0.85 * 1.8e-5 * 0.3048 * 0.3048 * 4e5 * 0.040_42 / ROOM.sqrt(), 2e-4);
}

#[test]
fn regulators_outside_physics_are_refused() {
    let cases = [
        ((0.0, 0.0, 1.0), "valve.time_constant"),
        ((1.0, -1.0, 1.0), "valve.dead_time"),
        ((1.0, 0.0, 0.0), "valve.rate_limit"),
    ];
    for ((time_constant, dead_time, limit), key) in cases {
        match Regulator::new(time_constant, dead_time, limit) {
            Err(Error::OutOfRange { parameter, .. }) => assert_eq!(parameter.key, key),
            other => panic!("{other:?}"),
        }
    }
}
