//! The actual duty cycle of pulsed valves: the paper's formula, its ends, poppets that take their time, two coils, derivatives.

use crate::common::{Paper, assert_close, assert_within, slope, toward};
use mckibben::network::Network;
use mckibben::plant::Plant;
use mckibben::simulation::Actuation;
use mckibben::valve::{Command, Ramp, Request, Solenoid, ValveKind, actual_duty_cycle};

const DELAYS: (f64, f64) = (4e-3, 1e-3);

fn solenoid(kind: ValveKind) -> Solenoid {
    Solenoid::new(kind, DELAYS.0, DELAYS.1).expect("a solenoid")
}

fn pulses(frequency: f64, duty: f64, rest: Request) -> Command {
    Command::pwm(frequency, duty, Request::Fill, rest).expect("a command")
}

/// `d − (t_open − t_close) f` between `t_open f` and `1 − t_close f`: 42.5 % at 25 Hz and 35 % at 50 Hz for 50 %.
#[test]
fn a_three_way_valve_has_the_papers_duty_cycle() {
    for frequency in [5.0, 25.0, 50.0] {
        for duty in [0.0, 0.05, 0.19, 0.21, 0.3, 0.5, 0.7, 0.94, 0.96, 0.99, 1.0] {
            let literal = if duty < DELAYS.0 * frequency {
                0.0
            } else if duty > 1.0 - DELAYS.1 * frequency {
                1.0
            } else {
                duty - (DELAYS.0 - DELAYS.1) * frequency
            };
            let [supply, exhaust] =
                actual_duty_cycle(&solenoid(ValveKind::ThreeWay), &pulses(frequency, duty, Request::Exhaust))
                    .expect("pulses");
            assert_within(supply, literal, 1e-11);
            assert_within(supply + exhaust, 1.0, 1e-11);
            let two_way = actual_duty_cycle(&solenoid(ValveKind::TwoWay), &pulses(frequency, duty, Request::Hold));
            assert_within(two_way.expect("pulses")[0], literal, 1e-11);
            assert_eq!(two_way.expect("pulses")[1], 0.0);
        }
    }
    let of = |frequency| {
        actual_duty_cycle(&solenoid(ValveKind::ThreeWay), &pulses(frequency, 0.5, Request::Exhaust)).expect("pulses")[0]
    };
    assert_close(of(25.0), 0.425, 1e-12);
    assert_close(of(50.0), 0.35, 1e-12);
}

/// A dead time shifts pulses: the duty cycle and its derivative are those without it, however many periods it lasts.
#[test]
fn a_dead_time_changes_no_duty_cycle() {
    let delays = (2e-4, 1e-4);
    let valve = Solenoid::new(ValveKind::ThreeWay, delays.0, delays.1).expect("a solenoid");
    for (frequency, dead_time) in [(200.0, 20e-3), (1000.0, 3.8e-3), (1000.0, 4.2e-3), (25.0, 1.0)] {
        let late = valve.with_dead_time(dead_time).expect("a dead time");
        for duty in [0.3, 0.4, 0.7] {
            let of = |duty| actual_duty_cycle(&late, &pulses(frequency, duty, Request::Exhaust)).expect("pulses");
            let literal = duty - (delays.0 - delays.1) * frequency;
            assert_within(of(duty)[0], literal, 1e-11);
            assert_within(of(duty)[1], 1.0 - literal, 1e-11);
            assert_within(slope(1e-5, |by| of(duty + by)[0]), 1.0, 1e-8);
        }
    }
}

/// Each coil of a pair of two-way valves opens late and shuts late: paths overlap, and neither sum is one.
#[test]
fn two_coils_have_a_duty_cycle_each() {
    let (frequency, duty) = (40.0, 0.5);
    let valve = Solenoid::new(ValveKind::FillHoldExhaust, 2e-3, 3e-3).expect("a solenoid");
    let [supply, exhaust] = actual_duty_cycle(&valve, &pulses(frequency, duty, Request::Exhaust)).expect("pulses");
    assert_close(supply, 0.5 + 1e-3 * frequency, 1e-11);
    assert_close(exhaust, 0.5 + 1e-3 * frequency, 1e-11);
}

/// A poppet that opens in `t_rise` and shuts in `t_fall` passes as much as one that jumps half of each later.
#[test]
fn a_seat_that_takes_its_time_passes_the_area_of_its_strokes() {
    let (frequency, rise, fall) = (20.0, 3e-3, 5e-3);
    let valve = solenoid(ValveKind::ThreeWay).with_ramp(Ramp::new(rise, fall).expect("a ramp"));
    let of = |duty| actual_duty_cycle(&valve, &pulses(frequency, duty, Request::Exhaust)).expect("pulses")[0];
    for duty in [0.3, 0.5, 0.7] {
        let expected = duty - (DELAYS.0 - DELAYS.1 + 0.5 * (rise - fall)) * frequency;
        assert_close(of(duty), expected, 1e-11);
    }
    // A pulse that ends while the poppet is under way: two lines up to λ = w/t_rise, and their areas.
    let duty: f64 = 0.1;
    let open = duty / frequency - DELAYS.0 + DELAYS.1;
    let top = open / rise;
    assert!(top < 1.0);
    assert_close(of(duty), (0.5 * top * open + 0.5 * top * top * fall) * frequency, 1e-10);
}

/// Where a poppet reaches one end only in a period that repeats, its strokes away from that end and back are a triangle. It is the
/// end towards which it drifts from period to period.
#[test]
fn a_poppet_that_drifts_over_periods_has_the_duty_cycle_of_those_that_repeat() {
    let (opening, closing) = (1e-3, 0.5e-3);
    let cases: [([f64; 2], f64, &[f64]); 3] = [
        ([10e-3, 10e-3], 100.0, &[0.5, 0.54, 0.551, 0.56, 0.6, 0.7]),
        ([6e-3, 3e-3], 200.0, &[0.6, 0.74, 0.77, 0.78]),
        ([3e-3, 6e-3], 200.0, &[0.3, 0.4, 0.45, 0.5]),
    ];
    for ([rise, fall], frequency, duties) in cases {
        let valve = |kind| {
            let jumps = Solenoid::new(kind, opening, closing).expect("a solenoid");
            jumps.with_ramp(Ramp::new(rise, fall).expect("a ramp"))
        };
        // The mean opening, and its derivative with respect to the duty of the coil.
        let literal = |duty: f64| {
            let pulse = duty / frequency - opening + closing;
            let gap = 1.0 / frequency - pulse;
            let (up, down) = (pulse / rise, gap / fall);
            assert!(up <= 1.0 || down <= 1.0);
            if up > down {
                let whole = 1.0 + rise / fall;
                (1.0 - 0.5 * frequency * gap * down * whole, down * whole)
            } else {
                let whole = 1.0 + fall / rise;
                (0.5 * frequency * pulse * up * whole, up * whole)
            }
        };
        for duty in duties.iter().copied() {
            let (expected, derivative) = literal(duty);
            let of = |kind, duty: f64| {
                actual_duty_cycle(&valve(kind), &pulses(frequency, duty, Request::Exhaust)).expect("pulses")
            };
            let [supply, exhaust] = of(ValveKind::ThreeWay, duty);
            assert_within(supply, expected, 1e-11);
            assert_within(supply + exhaust, 1.0, 1e-11);
            assert_close(slope(1e-5, |by| of(ValveKind::ThreeWay, duty + by)[0]), derivative, 1e-6);
            assert_close(by_duty(valve(ValveKind::ThreeWay), frequency, duty), derivative, 1e-9);
            // The coil of a normally open valve is energised for the gap, and the coils of two poppets for one each.
            assert_within(of(ValveKind::ThreeWayNormallyOpen, 1.0 - duty)[1], expected, 1e-11);
            let both = of(ValveKind::FillHoldExhaust, duty);
            assert_within(both[0], expected, 1e-11);
            assert_within(both[1], literal(1.0 - duty).0, 1e-11);
        }
    }
    // Where nothing drifts, a poppet that starts shut stays off the open end.
    let still = Solenoid::new(ValveKind::ThreeWay, 1e-3, 0.5e-3).expect("a solenoid");
    let still = still.with_ramp(Ramp::new(10e-3, 10e-3).expect("a ramp"));
    let [supply, _] = actual_duty_cycle(&still, &pulses(100.0, 0.55, Request::Exhaust)).expect("pulses");
    assert_within(supply, 0.25, 1e-9);
}

/// The derivative of the duty cycle of the path to the supply with respect to the commanded duty, by dual numbers.
fn by_duty(valve: Solenoid, frequency: f64, duty: f64) -> f64 {
    let mut network = Network::new(&Paper::sealed().air());
    network.valve(Actuation { solenoid: valve, command: pulses(frequency, duty, Request::Exhaust) });
    let plant = Plant::new(vec![], network, vec![]).expect("a plant");
    let wide = plant.map(|_, row, value| toward(value, f64::from(u8::from(row.key == "command.duty"))));
    let Actuation { solenoid, command } = &wide.network().valves[0];
    actual_duty_cycle(solenoid, command).expect("pulses")[0].slope[0]
}

/// Over dual numbers it carries its derivative with respect to the commanded duty.
#[test]
fn its_derivative_is_exact() {
    let valve = solenoid(ValveKind::ThreeWay);
    let frequency = 25.0;
    for (duty, expected) in [(0.05, 0.0), (0.4, 1.0), (0.99, 0.0)] {
        let measured = slope(1e-5, |by| {
            actual_duty_cycle(&valve, &pulses(frequency, duty + by, Request::Exhaust)).expect("pulses")[0]
        });
        assert_within(measured, expected, 1e-8);
        assert_within(by_duty(valve, frequency, duty), expected, 1e-12);
    }
    assert_eq!(actual_duty_cycle(&valve, &Command::Constant(Request::Fill)), None);
}
