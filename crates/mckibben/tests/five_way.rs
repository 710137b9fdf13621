//! The five-way valve: two outputs in opposition at the same instants; and the two-way and normally open kinds.

use crate::common::assert_within;
use mckibben::Error;
use mckibben::valve::{Command, FiveWay, FiveWayOutput, FiveWayRest, PoppetClock, Ports, Request, Solenoid, ValveKind};
use std::iter::successors;

const OPEN: f64 = 4e-3;
const CLOSE: f64 = 1e-3;
const SUPPLY: Ports = Ports { supply: true, exhaust: false };
const EXHAUST: Ports = Ports { supply: false, exhaust: true };

/// Instants at which the flow paths change up to `until`, each with the flow paths from then on; before them the first.
fn motions(solenoid: &Solenoid, command: &Command, until: f64) -> Vec<(f64, Ports)> {
    let mut clock = PoppetClock::released();
    let first = (0.0, clock.ports(solenoid));
    successors(Some(first), |_| {
        let next = clock.next_motion(solenoid, command, until)?;
        clock.advance(next, solenoid, command);
        Some((next, clock.ports(solenoid)))
    })
    .collect()
}

fn of(output: &FiveWayOutput) -> Vec<(f64, Ports)> {
    motions(&output.solenoid, &output.command, 1.0)
}

fn table(time: &[f64], request: &[Request]) -> Command {
    Command::table(time.to_vec(), request.to_vec()).expect("a table")
}

fn outputs(rest: FiveWayRest, command: &Command) -> [FiveWayOutput; 2] {
    FiveWay::new(rest, OPEN, CLOSE).and_then(|valve| valve.outputs(command)).expect("two outputs")
}

#[test]
fn the_outputs_of_a_spring_returned_valve_are_always_opposite() {
    let command = Command::pwm(25.0, 0.3, Request::Fill, Request::Exhaust).expect("a command");
    let [a, b] = outputs(FiveWayRest::Returned, &command).map(|output| of(&output));
    assert_eq!(a[0], (0.0, EXHAUST));
    assert!(a.len() > 40);
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert_eq!((a.0, a.1.supply, a.1.exhaust), (b.0, b.1.exhaust, b.1.supply));
    }
}

#[test]
fn the_middle_of_a_valve_of_three_positions() {
    let command = table(&[0.1, 0.2, 0.3], &[Request::Fill, Request::Hold, Request::Exhaust]);
    for (rest, middle) in
        [(FiveWayRest::Closed, Ports::CLOSED), (FiveWayRest::Exhausted, EXHAUST), (FiveWayRest::Pressurised, SUPPLY)]
    {
        let [a, b] = outputs(rest, &command);
        // Where each output stands in the middle of each stage: before, filled, held, exhausted.
        let at = |output: &FiveWayOutput, time: f64| {
            let list = of(output);
            list.iter().rev().find(|(since, _)| *since <= time).map(|(_, ports)| *ports).expect("from the start on")
        };
        for (time, of_a, of_b) in
            [(0.05, middle, middle), (0.15, SUPPLY, EXHAUST), (0.25, middle, middle), (0.35, EXHAUST, SUPPLY)]
        {
            assert_eq!((at(&a, time), at(&b, time)), (of_a, of_b), "{rest:?} at {time}");
        }
        // A coil pulls after the opening delay and lets go after the closing delay, for both outputs.
        for output in [&a, &b] {
            for (instant, _) in &of(output)[1..] {
                let delay = if [0.1, 0.3].iter().any(|t| (instant - t - OPEN).abs() < 1e-12) { OPEN } else { CLOSE };
                let commanded = ((instant - delay) * 10.0).round() / 10.0;
                assert_within(instant - delay, commanded, 1e-12);
            }
        }
    }
}

#[test]
fn a_valve_of_two_positions_cannot_hold() {
    let valve = FiveWay::new(FiveWayRest::Returned, OPEN, CLOSE).expect("a valve");
    assert!(matches!(valve.outputs(&Command::Constant(Request::Hold)), Err(Error::Misuse { .. })));
    assert!(FiveWay::new(FiveWayRest::Closed, -1.0, 0.0).is_err());
}

#[test]
fn a_two_way_valve_fills_or_seals() {
    let solenoid = Solenoid::new(ValveKind::TwoWay, OPEN, CLOSE).expect("a solenoid");
    let command = Command::pwm(10.0, 0.5, Request::Fill, Request::Hold).expect("a command");
    assert_eq!(solenoid.check(&command), Ok(()));
    let list = motions(&solenoid, &command, 0.12);
    let expected = [(0.0, Ports::CLOSED), (OPEN, SUPPLY), (0.05 + CLOSE, Ports::CLOSED), (0.1 + OPEN, SUPPLY)];
    assert_eq!(list.len(), expected.len());
    for (got, expected) in list.iter().zip(expected) {
        assert_within(got.0, expected.0, 1e-12);
        assert_eq!(got.1, expected.1);
    }
    let vents = Command::Constant(Request::Exhaust);
    assert!(matches!(solenoid.check(&vents), Err(Error::Misuse { .. })));
}

#[test]
fn a_normally_open_valve_fills_when_released() {
    let solenoid = Solenoid::new(ValveKind::ThreeWayNormallyOpen, OPEN, CLOSE).expect("a solenoid");
    let list = motions(&solenoid, &table(&[0.1, 0.2], &[Request::Exhaust, Request::Fill]), 1.0);
    let expected = [(0.0, SUPPLY), (0.1 + OPEN, EXHAUST), (0.2 + CLOSE, SUPPLY)];
    assert_eq!(list.len(), expected.len());
    for (got, expected) in list.iter().zip(expected) {
        assert_within(got.0, expected.0, 1e-12);
        assert_eq!(got.1, expected.1);
    }
    assert!(solenoid.check(&Command::Constant(Request::Hold)).is_err());
}
