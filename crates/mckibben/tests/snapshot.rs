//! Where an actuator is, as numbers: what has gone through them is the same to the last bit and goes on so.

use crate::common;
use common::{PSI, Paper, ROOM, spread};
use mckibben::control::Drive;
use mckibben::friction::{BoucWen, Coulomb, Hysteresis, LuGre, MaxwellSlip};
use mckibben::line::{Compressor, Hose, HoseKind, Line, Regulator, Reservoir, SupplyLine};
use mckibben::simulation::{Actuation, ModularActuator, Rig, Snapshot};
use mckibben::valve::{Command, Ramp, Request, Solenoid, ValveKind};
use mckibben::{Error, GaugePressure};

const FREQUENCY: f64 = 25.0;
const STEP: f64 = 1e-3;

fn paper() -> Paper {
    Paper::pwm(FREQUENCY, 0.5).gauge(30.0 * PSI)
}

fn rubbing(law: Hysteresis) -> Rig {
    paper().with(|rig| rig.hysteresis = Some(law)).rig()
}

fn behind(line: Line) -> Rig {
    paper().rig().with_line(line).expect("a line")
}

fn hose(kind: HoseKind) -> Line {
    let hose = Hose::new(kind, [1.0, 3e-3], [1.82e-5, ROOM, 1.0], &paper().air()).expect("a hose");
    Line { hose: Some(hose), ..Line::NONE }
}

/// A tank whose compressor starts and stops all the time, with a regulator behind it.
fn supply() -> Line {
    let bounds = [GaugePressure(60.0 * PSI), GaugePressure(60.5 * PSI)];
    let compressor = Compressor::new([5e-3, 0.03], bounds, &paper().air()).expect("a compressor");
    let tank = Reservoir::new([3e-4, 1.2, ROOM], bounds[0], Some(compressor), &paper().air()).expect("a tank");
    let regulator = Regulator::new(1e7, 500.0, 4e-3).expect("a regulator");
    let supply = SupplyLine::new(Some(tank), Some(regulator), 1.0).expect("a supply");
    Line { supply: Some(supply), ..hose(HoseKind::Lumped) }
}

fn valve(kind: ValveKind) -> Rig {
    let ramp = Ramp::new(6e-3, 4e-3).expect("a ramp");
    let solenoid = Solenoid::new(kind, 4e-3, 1e-3).expect("a solenoid").with_ramp(ramp);
    let actuation = Actuation { solenoid, command: Command::Constant(Request::Fill) };
    Rig::new(paper().actuator(), Some(actuation), paper().load).expect("a rig")
}

/// Rigs that have between them all that a state may hold.
fn rigs() -> Vec<Rig> {
    let slip = MaxwellSlip::new(&[2e-4, 1e-3], &[0.3, 0.1]).expect("elements");
    let bristles = LuGre::new(2e-4, 2e-4).and_then(|law| law.with_velocity(1.5, 5e-3, 1e-2)).expect("bristles");
    vec![
        paper().rig(),
        paper().with(|rig| rig.coulomb = Coulomb::new(1e-4).ok()).rig(),
        rubbing(Hysteresis::MaxwellSlip(slip)),
        rubbing(Hysteresis::BoucWen(BoucWen::new(2e-4, 2e3, 5e2).expect("a loop"))),
        rubbing(Hysteresis::LuGre(bristles)),
        behind(hose(HoseKind::Lumped)),
        behind(hose(HoseKind::Distributed { cells: 5 })),
        behind(supply()),
        valve(ValveKind::ThreeWay),
        valve(ValveKind::ThreeWayNormallyOpen),
        valve(ValveKind::FillHoldExhaust),
    ]
}

fn actuator(rig: &Rig) -> ModularActuator {
    let start = rig.start(&paper().initial()).expect("a start");
    ModularActuator::new(rig, start, FREQUENCY).expect("an actuator")
}

/// A step to and fro, with something else asked of the valve now and then.
fn step(actuator: &mut ModularActuator, count: usize) {
    let drive = match count % 23 {
        5 => Some(Drive::Pulses { duty: spread(count, 0), pulse: Request::Fill, rest: Request::Exhaust }),
        17 => Some(Drive::Steady(Request::Exhaust)),
        21 => Some(Drive::Steady(Request::Fill)),
        _ => None,
    };
    drive.map_or(Ok(()), |drive| actuator.drive(drive)).expect("a command");
    let there = actuator.state().length + 1e-4 * (spread(count, 1) - 0.5);
    actuator.move_to(actuator.time() + STEP, there).expect("a step");
}

#[test]
fn what_has_gone_through_numbers_goes_on_to_the_same_bits() {
    for (number, rig) in rigs().iter().enumerate() {
        let (mut one, mut other) = (actuator(rig), actuator(rig));
        for count in 0..150 {
            let snapshot = one.snapshot();
            let again = Snapshot::of_numbers(&snapshot.numbers()).expect("a state");
            assert_eq!(again.numbers(), snapshot.numbers());
            assert_eq!((again.time(), again.state(), again.ports()), (one.time(), one.state(), one.ports()));
            // Every field of it, by the name and to the last digit.
            other.restore(&again);
            assert_eq!(format!("{:?}", other.snapshot()), format!("{snapshot:?}"), "rig {number}, step {count}");
            step(&mut one, count);
            step(&mut other, count);
            assert_eq!(other.sample(), one.sample(), "rig {number}, step {count}");
        }
    }
}

/// Without this the test above would show little.
#[test]
fn the_states_hold_what_they_may() {
    let seen = |what: &dyn Fn(&str) -> bool| {
        rigs().iter().any(|rig| {
            let mut actuator = actuator(rig);
            (0..150).any(|count| {
                step(&mut actuator, count);
                what(&format!("{:?}", actuator.snapshot()))
            })
        })
    };
    for words in [
        "openings: Seats",
        "due: [Some",
        "drive: None",
        "drive: Some(Steady",
        "drive: Some(Pulses",
        "end: Some",
        "compressor: true",
        "seat: [false, true]",
    ] {
        assert!(seen(&|state| state.contains(words)), "{words}");
    }
    assert!(seen(&|state| !state.contains("compressor: true")));
}

#[test]
fn numbers_that_are_no_state_are_refused() {
    let mut actuator = actuator(&rigs()[5]);
    (0..30).for_each(|count| step(&mut actuator, count));
    let numbers = actuator.snapshot().numbers();
    let refused = |numbers: &[f64]| {
        let error = Snapshot::of_numbers(numbers).expect_err("no state");
        assert!(matches!(error, Error::Misuse { .. }), "{error}");
    };
    refused(&[]);
    refused(&numbers[1..]);
    refused(&[&numbers[..], &[0.0]].concat());
    for place in 0..numbers.len() {
        for wrong in [f64::NAN, f64::NEG_INFINITY] {
            let mut numbers = numbers.clone();
            numbers[place] = wrong;
            refused(&numbers);
        }
        let mut numbers = numbers.clone();
        numbers[place] = -0.5;
        // Whatever it is, it is a state or it is refused.
        if let Ok(snapshot) = Snapshot::of_numbers(&numbers) {
            assert_eq!(snapshot.numbers(), numbers);
        }
    }
}
