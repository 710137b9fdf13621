//! A plant's state as numbers in the caller's memory: what has gone through them is bit-identical and goes on so.

use crate::common::joint::Pair;
use crate::common::plants::{on_a_bottle, requested};
use crate::common::{PSI, Paper, ROOM, spread};
use mckibben::command::{Driver, PlantMeasurement, PlantSensors};
use mckibben::control::Sampling;
use mckibben::friction::{BoucWen, Coulomb, Hysteresis, LuGre, MaxwellSlip};
use mckibben::line::{Compressor, Hose, HoseKind, Line, Regulator, Reservoir, SupplyLine};
use mckibben::load::SeriesTendon;
use mckibben::plant::{Plant, PlantRun, PlantStart, PlantSteps};
use mckibben::simulation::{Actuation, Method, Rig};
use mckibben::valve::{self, Command, Ramp, Request, RuntimeCommand, Solenoid, Spool, ValveKind};
use mckibben::{Error, GaugePressure};

const STEP: f64 = 1e-3;

fn paper() -> Paper {
    Paper::pwm(25.0, 0.5).gauge(30.0 * PSI)
}

fn with_hysteresis(law: Hysteresis) -> Rig {
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

fn driven_by(solenoid: Solenoid, command: Command) -> Rig {
    Rig::new(paper().actuator(), Some(Actuation { solenoid, command }), paper().load).expect("a rig")
}

fn valve(kind: ValveKind, dead_time: f64) -> Rig {
    let ramp = Ramp::new(6e-3, 4e-3).expect("a ramp");
    let solenoid = Solenoid::new(kind, 4e-3, 1e-3).expect("a solenoid").with_ramp(ramp);
    driven_by(solenoid.with_dead_time(dead_time).expect("a dead time"), Command::Constant(Request::Fill))
}

/// Requests that a valve accepts.
#[derive(Clone, Copy)]
enum Takes {
    Requests,
    SetPoints,
    Positions,
}

/// Plants whose ends a host moves, that have between them all that a state may hold.
fn plants() -> Vec<(Plant, PlantStart, Takes)> {
    let slip = MaxwellSlip::new(&[2e-4, 1e-3], &[0.3, 0.1]).expect("elements");
    let bristles = LuGre::new(2e-4, 2e-4).and_then(|law| law.with_velocity(1.5, 5e-3, 1e-2)).expect("bristles");
    let regulator = valve::Regulator::new(0.02, 5e-3, 2e6).expect("a regulator");
    let spool = Spool::new(40.0, 0.4, 0.05, -0.1).expect("a spool");
    let tendon = SeriesTendon::new(2e4, 0.02).expect("a tendon");
    let rigs = [
        paper().rig(),
        paper().with(|rig| rig.coulomb = Coulomb::new(1e-4).ok()).rig(),
        with_hysteresis(Hysteresis::MaxwellSlip(slip)),
        with_hysteresis(Hysteresis::BoucWen(BoucWen::new(2e-4, 2e3, 5e2).expect("a loop"))),
        with_hysteresis(Hysteresis::LuGre(bristles)),
        behind(hose(HoseKind::Lumped)),
        behind(hose(HoseKind::Distributed { cells: 5 })),
        behind(supply()),
        valve(ValveKind::ThreeWay, 0.0),
        valve(ValveKind::ThreeWayNormallyOpen, 0.02),
        valve(ValveKind::FillHoldExhaust, 7e-3),
        paper().friction(20.0, 1e-4).rig().with_tendon(tendon),
    ];
    let mut all: Vec<(Rig, Takes)> = rigs.into_iter().map(|rig| (rig, Takes::Requests)).collect();
    let points = Command::set_points(vec![0.0], vec![1e5]).expect("a set point");
    all.push((driven_by(Solenoid::regulating(regulator), points), Takes::SetPoints));
    let positions = Command::positions(vec![0.0], vec![0.2]).expect("a position");
    let late = Solenoid::proportional(spool).with_dead_time(5e-3).expect("a dead time");
    all.push((driven_by(late, positions), Takes::Positions));
    let of_host = |(rig, takes): (Rig, Takes)| {
        let state = rig.start(&paper().initial()).expect("a start");
        let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &state));
        let (plant, start) = plant.to_external(&start).expect("a host's");
        (plant, start, takes)
    };
    all.into_iter().map(of_host).collect()
}

fn begun(plant: &Plant, start: &PlantStart) -> PlantSteps {
    PlantRun::new(plant, start, 1e-9).expect("a start").steps(Method::Stable)
}

/// A step to and fro, with another demand of the valve now and then.
fn step(steps: &mut PlantSteps, takes: Takes, count: usize) {
    let pulses = |duty| RuntimeCommand::Pulses { frequency: 25.0, duty, pulse: Request::Fill, rest: Request::Exhaust };
    let commanded = match (takes, count % 23) {
        (Takes::Requests, 5 | 9) => Some(pulses(spread(count, 0))),
        (Takes::Requests, 17) => Some(Request::Exhaust.into()),
        (Takes::Requests, 21) => Some(Request::Fill.into()),
        (Takes::SetPoints, 5 | 17 | 21) => Some(RuntimeCommand::SetPoint(GaugePressure(4e5 * spread(count, 0)))),
        (Takes::Positions, 2 | 5 | 17 | 19) => Some(RuntimeCommand::Position(2.0 * spread(count, 0) - 1.0)),
        _ => None,
    };
    commanded.map_or(Ok(()), |commanded| steps.set(0, commanded)).expect("a demand");
    let place = steps.plant().indices().mechanisms[0].position(0);
    let there = steps.state()[place] + 1e-4 * (spread(count, 1) - 0.5);
    steps.move_to(steps.time() + STEP, &[there]).expect("a step");
}

fn saved(steps: &mut PlantSteps) -> Vec<f64> {
    let mut numbers = vec![f64::NAN; steps.state_size()];
    steps.save_to(&mut numbers).expect("a state");
    numbers
}

pub(crate) fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn what_has_gone_through_numbers_goes_on_to_the_same_bits() {
    for (index, (plant, start, takes)) in plants().into_iter().enumerate() {
        // The third is never saved: to save changes nothing.
        let [mut one, mut other, mut apart] = [(); 3].map(|()| begun(&plant, &start));
        for count in 0..150 {
            let numbers = saved(&mut one);
            other.restore_from(&numbers).expect("a state");
            assert_eq!(bits(&saved(&mut other)), bits(&numbers), "plant {index}, step {count}");
            assert_eq!(other.sample(), one.sample(), "plant {index}, step {count}");
            for steps in [&mut one, &mut other, &mut apart] {
                step(steps, takes, count);
            }
            assert_eq!(other.sample(), one.sample(), "plant {index} after step {count}");
            assert_eq!(apart.sample(), one.sample(), "plant {index} after step {count}");
            // It goes back too, from wherever it is.
            if count % 11 == 0 {
                step(&mut other, takes, count + 7);
            }
        }
    }
}

/// A host that gives a command in every step gives what one that gives it once does: the same numbers, and no events.
#[test]
fn a_command_that_holds_changes_nothing_when_it_is_given_again() {
    for (index, (plant, start, takes)) in plants().into_iter().enumerate() {
        let command = match takes {
            Takes::Requests => Request::Exhaust.into(),
            Takes::SetPoints => RuntimeCommand::SetPoint(GaugePressure(2.3e5)),
            Takes::Positions => RuntimeCommand::Position(-0.4),
        };
        let [mut once, mut always] = [(); 2].map(|()| begun(&plant, &start));
        once.set(0, command).expect("a command");
        for count in 0..40 {
            always.set(0, command).expect("a command");
            for steps in [&mut once, &mut always] {
                let place = steps.plant().indices().mechanisms[0].position(0);
                let there = steps.state()[place] + 1e-4 * (spread(count, 1) - 0.5);
                steps.move_to(steps.time() + STEP, &[there]).expect("a step");
            }
            assert_eq!(bits(&saved(&mut always)), bits(&saved(&mut once)), "plant {index} after step {count}");
        }
        assert_eq!(always.events(), once.events(), "plant {index}");
    }
}

/// Actuators that stick together on a joint, stops, several valves on one bottle, and a mass.
#[test]
fn restored_runs_without_a_host_are_bit_identical() {
    let pair = Pair::of(Paper::pwm(25.0, 0.4).gauge(25.0 * PSI).friction(3.5, 1e-4));
    let rig = pair.rig().expect("a joint");
    let state = rig.start(&pair.initial()).expect("a start");
    let joint = (Plant::of_joint(&rig).expect("a plant"), Plant::start_of_joint(&rig, &state));
    let (bottle, bottle_start, _) = on_a_bottle();
    for (plant, start) in [joint, (bottle, bottle_start)] {
        let [mut one, mut other] = [(); 2].map(|()| begun(&plant, &start));
        for count in 0..300 {
            let numbers = saved(&mut one);
            other.restore_from(&numbers).expect("a state");
            assert_eq!(bits(&saved(&mut other)), bits(&numbers), "step {count}");
            for steps in [&mut one, &mut other] {
                let (commands, distances) = requested(count);
                if steps.plant().actuators().len() == 3 {
                    for (valve, commanded) in commands.into_iter().flatten().enumerate() {
                        steps.set(valve, commanded).expect("a demand");
                    }
                    steps.move_to(f64::from(count + 1) * STEP, &distances).expect("a step");
                } else {
                    steps.advance_to(f64::from(count + 1) * STEP).expect("a step");
                }
            }
            assert_eq!(other.sample(), one.sample(), "after step {count}");
        }
    }
}

/// From wherever the steps are, they go back to what they saved and on to the same bits, although another mode holds by then.
#[test]
fn steps_go_back_from_another_mode() {
    let pair = Pair::of(Paper::pwm(25.0, 0.4).gauge(25.0 * PSI).friction(3.5, 1e-4));
    let rig = pair.rig().expect("a joint");
    let state = rig.start(&pair.initial()).expect("a start");
    let (plant, start) = (Plant::of_joint(&rig).expect("a plant"), Plant::start_of_joint(&rig, &state));
    let mut steps = begun(&plant, &start);
    let mut reached = vec![(saved(&mut steps), steps.sample())];
    for count in 1..=300 {
        steps.advance_to(f64::from(count) * STEP).expect("a step");
        reached.push((saved(&mut steps), steps.sample()));
    }
    for count in (1..=300).rev() {
        steps.restore_from(&reached[count - 1].0).expect("a state");
        steps.advance_to(count as f64 * STEP).expect("a step");
        assert_eq!(steps.sample(), reached[count].1, "step {count}");
        // Into yet another mode.
        steps.restore_from(&reached[(count * 97) % 300].0).expect("a state");
    }
    for count in [300, 150] {
        steps.restore_from(&reached[count].0).expect("a state");
        steps.reset();
        steps.advance_to(STEP).expect("a step");
        assert_eq!(steps.sample(), reached[1].1, "from step {count}");
    }
}

#[test]
fn numbers_that_are_no_state_are_refused_and_change_nothing() {
    let plants = plants();
    for index in [2, 7, 10, 12, 13] {
        let (plant, start, takes) = &plants[index];
        let mut steps = begun(plant, start);
        (0..30).for_each(|count| step(&mut steps, *takes, count));
        let (numbers, before) = (saved(&mut steps), steps.sample());
        let mut refused = |numbers: &[f64]| {
            let error = steps.restore_from(numbers).expect_err("no state");
            assert!(matches!(error, Error::Misuse { .. }), "{error}");
            assert_eq!(steps.sample(), before);
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
        }
        for place in 0..numbers.len() {
            for changed in [-0.5, 1e9] {
                let mut numbers = numbers.clone();
                numbers[place] = changed;
                // Whatever it is, it is a state or it is refused, and nothing breaks.
                let mut steps = begun(plant, start);
                if steps.restore_from(&numbers).is_ok() {
                    let again = saved(&mut steps);
                    let mut other = begun(plant, start);
                    other.restore_from(&again).expect("a state");
                    assert_eq!(bits(&saved(&mut other)), bits(&again), "plant {index}, number {place}");
                }
            }
        }
        assert!(matches!(steps.save_to(&mut vec![0.0; numbers.len() - 1]), Err(Error::Misuse { .. })));
        steps.restore_from(&numbers).expect("a state");
    }
}

#[test]
fn what_numbers_cannot_hold_is_named() {
    let rig = valve(ValveKind::FillHoldExhaust, 0.5);
    let state = rig.start(&paper().initial()).expect("a start");
    let (plant, start) = Plant::of_rig(&rig).to_external(&Plant::start_of_rig(&rig, &state)).expect("a host's");
    let mut steps = begun(&plant, &start);
    for count in 1..=100 {
        let request = if count % 2 == 0 { Request::Fill } else { Request::Exhaust };
        steps.set(0, request).expect("a request");
        steps.move_to(f64::from(count) * STEP, &[start.positions[0][0]]).expect("a step");
    }
    let mut numbers = vec![0.0; steps.state_size()];
    let late = steps.save_to(&mut numbers).expect_err("too many");
    assert!(late.to_string().contains("64 commands"), "{late}");

    let decide = |_: &PlantMeasurement, _: &mut u32, commands: &mut [Option<RuntimeCommand>]| {
        commands[0] = Some(Request::Hold.into());
    };
    let sampling = Sampling::new(100.0, 0).expect("a rate");
    let driver = Driver::of_function(decide, 0, &[0], sampling, PlantSensors::perfect());
    let run = PlantRun::with_drivers(&plant, &start, 1e-9, vec![driver]).expect("a run");
    let mut steps = run.steps(Method::Stable);
    let mut numbers = vec![0.0; steps.state_size()];
    let said = steps.save_to(&mut numbers).expect_err("a driver");
    assert!(said.to_string().contains("drivers"), "{said}");
}

/// What a host requests in addition to its steps.
#[test]
fn rates_tensions_at_other_rates_and_the_way_back_to_the_start() {
    let (plant, start, takes) = plants().swap_remove(1);
    let mut steps = begun(&plant, &start);
    let begin = steps.sample();
    (0..40).for_each(|count| step(&mut steps, takes, count));
    let there = steps.sample();
    let places = plant.indices().actuators[0];
    let mut rates = vec![0.0; plant.indices().states];
    steps.derivative(&mut rates).expect("rates");
    let now = steps.compute(0).expect("one");
    assert_eq!([rates[places.pressure], rates[places.mass()]], [now.pressure_rate, now.mass_flow]);
    let rate = steps.state()[plant.indices().mechanisms[0].rate(0)];
    let distance = steps.state()[plant.indices().mechanisms[0].position(0)];
    let mut at = |distance: f64, rate: f64| {
        let mut responses = [now];
        steps.compute_at(&[distance], &[rate], &mut responses).map(|()| responses[0])
    };
    assert_eq!(at(distance, rate).expect("one"), now);
    let (back, longer) = (at(distance, -rate).expect("one"), at(distance + 1e-7, rate).expect("one"));
    let difference = (longer.tension - now.tension) / 1e-7;
    assert!((difference / now.per_length - 1.0).abs() < 1e-4, "{difference} for {} N/m", now.per_length);
    assert!((back.tension - now.tension) * rate < 0.0, "friction turns with the velocity");
    assert_eq!(steps.sample(), there, "to ask changes nothing");
    assert!(matches!(steps.derivative(&mut []), Err(Error::Table { .. })));
    assert!(matches!(steps.compute_at(&[distance], &[], &mut [now]), Err(Error::Table { .. })));
    assert!(matches!(steps.compute_at(&[], &[0.0], &mut [now]), Err(Error::Table { .. })));
    assert!(matches!(steps.compute_at(&[distance], &[0.0], &mut []), Err(Error::Table { .. })));
    assert!(matches!(steps.compute_at(&[distance], &[f64::NAN], &mut [now]), Err(Error::OutOfRange { .. })));
    assert!(matches!(steps.compute_at(&[0.0], &[0.0], &mut [now]), Err(Error::OutOfRange { .. })));
    assert_eq!(steps.sample(), there, "nor does what cannot be");
    steps.reset();
    assert_eq!(steps.sample(), begin);
}
