//! The solenoid: every motion of the poppet is an exact instant, and pulses too short are not followed.

use crate::common;
use common::{Paper, assert_within};
use mckibben::Error;
use mckibben::simulation::EventKind;
use mckibben::valve::{Command, PoppetClock, Ports, Request, Solenoid, ValveKind};
use proptest::prelude::*;

const OPEN: f64 = 4e-3;
const CLOSE: f64 = 1e-3;
const SUPPLY: Ports = Ports { supply: true, exhaust: false };
const EXHAUST: Ports = Ports { supply: false, exhaust: true };
const BOTH: Ports = Ports { supply: true, exhaust: true };

/// The paper's delays in a valve of one kind.
fn solenoid(kind: ValveKind) -> Solenoid {
    Solenoid::new(kind, OPEN, CLOSE).expect("a solenoid")
}

fn pwm(frequency: f64, duty: f64) -> Command {
    Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command")
}

fn table(time: &[f64], request: &[Request]) -> Command {
    Command::table(time.to_vec(), request.to_vec()).expect("a command")
}

/// The flow paths at t = 0 and each motion until `until`.
fn motions(solenoid: &Solenoid, command: &Command, until: f64) -> Vec<(f64, Ports)> {
    let mut clock = PoppetClock::released();
    clock.advance(0.0, solenoid, command);
    let mut list = vec![(0.0, clock.ports(solenoid))];
    while let Some(time) = clock.next_motion(solenoid, command, until) {
        clock.advance(time, solenoid, command);
        list.push((time, clock.ports(solenoid)));
    }
    list
}

/// Share of a stretch of time in which the supply is open.
fn duty(list: &[(f64, Ports)], from: f64, until: f64) -> f64 {
    let ends = list.iter().skip(1).map(|(time, _)| *time).chain([f64::INFINITY]);
    let open: f64 = list
        .iter()
        .zip(ends)
        .filter(|((_, ports), _)| ports.supply)
        .map(|((start, _), end)| (end.min(until) - start.max(from)).max(0.0))
        .sum();
    open / (until - from)
}

#[test]
fn the_actual_duty_is_what_the_paper_measured() {
    for (frequency, expected, measured) in [(25.0, 0.425, 0.43), (50.0, 0.35, 0.35)] {
        let list = motions(&solenoid(ValveKind::ThreeWay), &pwm(frequency, 0.5), 2.0);
        // Whole periods, after the first pulse. Instants are rounded to 1e-16.
        assert_within(duty(&list, 0.2, 1.8), expected, 1e-14);
        assert_within(expected, measured, 0.0051);
    }
}

#[test]
fn a_simulation_logs_the_same_instants() {
    for (frequency, expected) in [(25.0, 0.425), (50.0, 0.35)] {
        let run = Paper::pwm(frequency, 0.5).run(0.5, 1e-6);
        let logged: Vec<(f64, Ports)> = run
            .events()
            .iter()
            .filter(|event| event.kind == EventKind::Valve)
            .map(|event| (event.time, event.after.ports))
            .collect();
        let list = motions(&solenoid(ValveKind::ThreeWay), &pwm(frequency, 0.5), 0.5);
        assert_eq!(logged, list[1..], "the events are the clock's motions, to the bit");
        assert_within(duty(&logged, 0.08, 0.48), expected, 1e-14);
    }
}

proptest! {
    #[test]
    fn the_actual_duty_follows_the_delays(f in 1.0..60.0_f64, d in 0.3..0.7_f64, open in 0.0..4e-3_f64, close in 0.0..4e-3_f64) {
        // d − (t_open − t_close) f, whenever the pulse outlasts t_open and the gap t_close: 0.3/60 = 5 ms.
        let solenoid = Solenoid::new(ValveKind::ThreeWay, open, close).expect("a solenoid");
        let list = motions(&solenoid, &pwm(f, d), 20.0 / f);
        prop_assert!((duty(&list, 5.0 / f, 15.0 / f) - (d - (open - close) * f)).abs() < 1e-12);
    }
}

#[test]
fn duty_cycles_of_zero_and_one_stay_put() {
    let valve = solenoid(ValveKind::ThreeWay);
    assert_eq!(motions(&valve, &pwm(25.0, 0.0), 10.0), [(0.0, EXHAUST)]);
    assert_eq!(motions(&valve, &pwm(25.0, 1.0), 10.0), [(0.0, EXHAUST), (OPEN, SUPPLY)]);
    assert_eq!(motions(&valve, &Command::Constant(Request::Exhaust), 10.0), [(0.0, EXHAUST)]);
    assert_eq!(motions(&valve, &Command::Constant(Request::Fill), 10.0), [(0.0, EXHAUST), (OPEN, SUPPLY)]);
    // Without delays the poppet is at the supply from the very start.
    let quick = Solenoid::new(ValveKind::ThreeWay, 0.0, 0.0).expect("a solenoid");
    assert_eq!(motions(&quick, &Command::Constant(Request::Fill), 10.0), [(0.0, SUPPLY)]);
}

#[test]
fn a_pulse_as_long_as_the_opening_delay_opens_and_a_shorter_one_does_not() {
    let valve = solenoid(ValveKind::ThreeWay);
    let pulse = |length: f64| table(&[0.1, 0.1 + length], &[Request::Fill, Request::Exhaust]);
    // The poppet moves before the coil at one instant: it opens, and t_close later shuts.
    let list = motions(&valve, &pulse(OPEN), 1.0);
    assert_eq!(list.iter().map(|(_, ports)| *ports).collect::<Vec<_>>(), [EXHAUST, SUPPLY, EXHAUST]);
    assert_within(list[1].0, 0.104, 2e-17);
    assert_within(list[2].0, 0.105, 2e-17);
    for shorter in [OPEN * (1.0 - 1e-9), 0.5 * OPEN, 1e-9] {
        assert_eq!(motions(&valve, &pulse(shorter), 1.0), [(0.0, EXHAUST)], "a pulse of {shorter} s");
    }
    // The same under PWM: 4 ms of 40 ms are a duty of exactly one tenth, at every period.
    let list = motions(&valve, &pwm(25.0, 0.1), 40.0);
    assert_eq!(list.iter().filter(|(_, ports)| *ports == SUPPLY).count(), 1000);
    assert_eq!(motions(&valve, &pwm(25.0, 0.0999), 40.0), [(0.0, EXHAUST)]);
}

#[test]
fn a_gap_shorter_than_the_closing_delay_never_shuts() {
    let valve = solenoid(ValveKind::ThreeWay);
    let gap = |length: f64| table(&[0.0, 0.1, 0.1 + length], &[Request::Fill, Request::Exhaust, Request::Fill]);
    for shorter in [CLOSE * (1.0 - 1e-9), 0.5 * CLOSE, 1e-9] {
        assert_eq!(motions(&valve, &gap(shorter), 1.0), [(0.0, EXHAUST), (OPEN, SUPPLY)], "a gap of {shorter} s");
    }
    let ports: Vec<Ports> = motions(&valve, &gap(CLOSE), 1.0).iter().map(|(_, ports)| *ports).collect();
    assert_eq!(ports, [EXHAUST, SUPPLY, EXHAUST, SUPPLY]);
    // 99 % of 40 ms leave a gap of 0.4 ms: open for good.
    assert_eq!(motions(&valve, &pwm(25.0, 0.99), 10.0), [(0.0, EXHAUST), (OPEN, SUPPLY)]);
}

#[test]
fn a_pulse_that_was_not_followed_leaves_nothing_behind() {
    // 3 ms on, 3 ms off, 3 ms on: each too short to open. Then a long one opens 4 ms after its own start.
    let command = table(
        &[0.010, 0.013, 0.016, 0.019, 0.030],
        &[Request::Fill, Request::Exhaust, Request::Fill, Request::Exhaust, Request::Fill],
    );
    let list = motions(&solenoid(ValveKind::ThreeWay), &command, 1.0);
    assert_eq!(list, [(0.0, EXHAUST), (0.030 + OPEN, SUPPLY)]);
}

/// Without an end in time: of pulses and gaps that no poppet follows none is looked for in vain, and a motion that a delay of
/// many periods puts off is found.
#[test]
fn pulses_that_are_never_followed_have_no_next_motion() {
    let next = |valve: &Solenoid, command: &Command| {
        let mut clock = PoppetClock::released();
        clock.advance(1.003, valve, command);
        clock.next_motion(valve, command, f64::INFINITY)
    };
    let seats = Solenoid::new(ValveKind::FillHoldExhaust, 25e-3, CLOSE).expect("a solenoid");
    assert_eq!(next(&solenoid(ValveKind::ThreeWay), &pwm(25.0, 0.09)), None);
    assert_eq!(next(&solenoid(ValveKind::ThreeWay), &pwm(25.0, 0.99)), None);
    assert_eq!(next(&seats, &pwm(25.0, 0.5)), None);
    // The coil stays on from the first pulse on: 40 periods of 25 ms pass before the poppet follows.
    let late = Solenoid::new(ValveKind::TwoWay, 1.0, CLOSE).expect("a solenoid");
    let always = Command::pwm(40.0, 0.5, Request::Fill, Request::Fill).expect("a command");
    let clock = PoppetClock::released();
    assert_eq!(clock.next_motion(&late, &always, f64::INFINITY), Some(1.0));
}

#[test]
fn the_millionth_pulse_starts_exactly_at_its_period() {
    let (valve, command) = (solenoid(ValveKind::ThreeWay), pwm(30.0, 0.5));
    let mut clock = PoppetClock::released();
    let period = |index: f64| index / 30.0;
    clock.advance(period(999_999.0) - 1e-6, &valve, &command);
    assert_eq!(clock.ports(&valve), EXHAUST);
    let opens = clock.next_motion(&valve, &command, 1e9).expect("it goes on");
    assert_eq!(opens, period(999_999.0) + OPEN, "to the bit: times come from the index, they are not summed");
    clock.advance(opens, &valve, &command);
    assert_eq!(clock.ports(&valve), SUPPLY);
    assert_eq!(clock.next_motion(&valve, &command, 1e9), Some((999_999.0 + 0.5) / 30.0 + CLOSE));
    assert_eq!(command.change(2 * 999_999), Some((period(999_999.0), Request::Fill)));
}

#[test]
fn two_seats_overlap_or_leave_a_gap_as_their_delays_say() {
    let command = table(&[0.0, 0.1, 0.2], &[Request::Fill, Request::Exhaust, Request::Hold]);
    // Slow to open, quick to shut: closed in between.
    let slow = motions(&solenoid(ValveKind::FillHoldExhaust), &command, 1.0);
    let expected = [
        (0.0, Ports::CLOSED),
        (OPEN, SUPPLY),
        (0.1 + CLOSE, Ports::CLOSED),
        (0.1 + OPEN, EXHAUST),
        (0.2 + CLOSE, Ports::CLOSED),
    ];
    assert_eq!(slow, expected);
    // Quick to open, slow to shut: both open for a while.
    let quick = Solenoid::new(ValveKind::FillHoldExhaust, CLOSE, OPEN).expect("a solenoid");
    let expected = [
        (0.0, Ports::CLOSED),
        (CLOSE, SUPPLY),
        (0.1 + CLOSE, BOTH),
        (0.1 + OPEN, EXHAUST),
        (0.2 + OPEN, Ports::CLOSED),
    ];
    assert_eq!(motions(&quick, &command, 1.0), expected);
    // Equal delays: both poppets move at one instant, which is one motion.
    let even = Solenoid::new(ValveKind::FillHoldExhaust, CLOSE, CLOSE).expect("a solenoid");
    let ports: Vec<Ports> = motions(&even, &command, 1.0).iter().map(|(_, ports)| *ports).collect();
    assert_eq!(ports, [Ports::CLOSED, SUPPLY, EXHAUST, Ports::CLOSED]);
}

#[test]
fn an_overlap_lets_the_supply_blow_through() {
    // With both flow paths open the pressure settles where inflow and outflow are equal, between the two ports.
    let command = table(&[0.0, 0.1], &[Request::Fill, Request::Exhaust]);
    let paper = Paper::driven(command)
        .with(|rig| (rig.kind, rig.delays) = (ValveKind::FillHoldExhaust, (0.0, 0.2)))
        .isometric(0.085);
    let run = paper.run(0.35, 1e-9);
    assert_eq!(run.at(0.05).ports.name(), "supply");
    let steady = run.at(0.29);
    assert_eq!(steady.ports.name(), "supply+exhaust");
    assert_within(steady.mass_flow, 0.0, 1e-9);
    assert!(steady.pressure.0 > 2.0 * common::ATMOSPHERE && steady.pressure.0 < 7.5e5, "{steady:?}");
    assert_eq!(run.at(0.31).ports.name(), "exhaust");
    assert!(run.at(0.35).pressure.0 < 0.5 * steady.pressure.0);
}

#[test]
fn a_table_leaves_the_coils_released_before_its_first_row() {
    let list = motions(&solenoid(ValveKind::ThreeWay), &table(&[0.5], &[Request::Fill]), 1.0);
    assert_eq!(list, [(0.0, EXHAUST), (0.5 + OPEN, SUPPLY)]);
    let list = motions(&solenoid(ValveKind::FillHoldExhaust), &table(&[0.5], &[Request::Exhaust]), 1.0);
    assert_eq!(list, [(0.0, Ports::CLOSED), (0.5 + OPEN, EXHAUST)]);
}

#[test]
fn commands_that_make_no_sense_are_refused() {
    let hold = Command::Constant(Request::Hold);
    assert!(matches!(solenoid(ValveKind::ThreeWay).check(&hold), Err(Error::Misuse { .. })));
    assert_eq!(solenoid(ValveKind::FillHoldExhaust).check(&hold), Ok(()));
    let fault = |time: &[f64], request: &[Request]| match Command::table(time.to_vec(), request.to_vec()) {
        Err(Error::Table { entry, .. }) => entry,
        other => panic!("{other:?}"),
    };
    assert_eq!(fault(&[], &[]), 1);
    assert_eq!(fault(&[0.0, 1.0], &[Request::Fill]), 2);
    assert_eq!(fault(&[0.0, 0.0], &[Request::Fill; 2]), 2);
    assert_eq!(fault(&[0.0, -1.0], &[Request::Fill; 2]), 2);
    assert_eq!(fault(&[f64::NAN], &[Request::Fill]), 1);
    for (frequency, duty) in [(0.0, 0.5), (25.0, 1.1), (25.0, -0.1), (f64::INFINITY, 0.5)] {
        let result = Command::pwm(frequency, duty, Request::Fill, Request::Exhaust);
        assert!(matches!(result, Err(Error::OutOfRange { .. })), "{result:?}");
    }
    assert!(Solenoid::new(ValveKind::ThreeWay, -1e-9, 0.0).is_err());
}
