//! Dead time of a valve: a request acts so much later, whatever its length, and is never shortened.

use crate::common::steps::RigSteps;
use crate::common::{INCH, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::parameter;
use mckibben::plant::{Part, Plant, PlantRun, PlantStart, PlantTrajectory, simulate_plant};
use mckibben::simulation::{Actuation, EventKind, Method, Rig, State, simulate};
use mckibben::valve::{
    Command, FiveWay, FiveWayRest, PoppetClock, Ramp, Regulator, Request, Solenoid, Spool, ValveKind,
};
use mckibben::{GaugePressure, Scalar};

const OPEN: f64 = 4e-3;
const CLOSE: f64 = 1e-3;

/// An isometric rig: with its valve shut nothing changes.
fn rig(solenoid: Solenoid, command: Command) -> (Rig, State) {
    let paper = Paper::driven(Command::Constant(Request::Exhaust)).gauge(20.0 * PSI).isometric(3.4 * INCH);
    let rig = Rig::new(paper.actuator(), Some(Actuation { solenoid, command }), paper.load.clone()).expect("a rig");
    let start = rig.start(&paper.initial()).expect("a start");
    (rig, start)
}

fn plant(solenoid: Solenoid, command: Command) -> (Plant, PlantStart) {
    let (rig, start) = rig(solenoid, command);
    (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start))
}

fn seats(run: &PlantTrajectory) -> Vec<f64> {
    let moves = run.events().iter().filter(|event| event.kind.part == Part::Valve(0));
    moves.filter(|event| event.kind.kind == EventKind::Valve).map(|event| event.time).collect()
}

fn solenoid(kind: ValveKind, dead_time: f64) -> Solenoid {
    Solenoid::new(kind, OPEN, CLOSE).and_then(|valve| valve.with_dead_time(dead_time)).expect("a solenoid")
}

#[test]
fn seats_move_later_by_the_dead_time_whatever_the_length_of_a_pulse() {
    let pwm = || Command::pwm(25.0, 0.5, Request::Fill, Request::Exhaust).expect("a command");
    for dead_time in [0.0, 2e-3, 13e-3, 0.11] {
        let valve = solenoid(ValveKind::ThreeWay, dead_time);
        let (plant, start) = plant(valve, pwm());
        let moved = seats(&simulate_plant(&plant, &start, 0.5, 1e-8).expect("a run"));
        let expected = (0..).flat_map(|k| {
            let begin = f64::from(k) / 25.0;
            [begin + dead_time + OPEN, (f64::from(k) + 0.5) / 25.0 + dead_time + CLOSE]
        });
        let expected: Vec<f64> = expected.take_while(|time| *time <= 0.5).collect();
        assert_eq!(moved.len(), expected.len(), "{dead_time}");
        for (one, other) in moved.iter().zip(&expected) {
            assert_within(*one, *other, 1e-15);
        }
        // By the engine of rigs they are the same.
        let (rig, start) = rig(valve, pwm());
        let old = simulate(&rig, start, 0.5, 1e-8).expect("a run");
        let valves = old.events().iter().filter(|event| event.kind == EventKind::Valve);
        assert_eq!(valves.map(|event| event.time).collect::<Vec<f64>>(), moved);
    }
}

#[test]
fn dead_time_never_swallows_a_pulse_and_an_opening_delay_does() {
    let pulse = |width: f64| {
        let times = vec![0.0, 0.1, 0.1 + width];
        Command::table(times, vec![Request::Exhaust, Request::Fill, Request::Exhaust]).expect("a table")
    };
    let moved = |width: f64, dead_time: f64| {
        let (plant, start) = plant(solenoid(ValveKind::ThreeWay, dead_time), pulse(width));
        seats(&simulate_plant(&plant, &start, 0.4, 1e-8).expect("a run"))
    };
    // Far shorter than the dead time, and longer than the opening delay.
    let opened = moved(OPEN + 0.5e-3, 0.05);
    assert_eq!(opened.len(), 2);
    assert_within(opened[0], 0.1 + 0.05 + OPEN, 1e-15);
    assert_within(opened[1], 0.1 + OPEN + 0.5e-3 + 0.05 + CLOSE, 1e-15);
    for dead_time in [0.0, 0.05] {
        assert_eq!(moved(OPEN - 0.5e-3, dead_time), [] as [f64; 0]);
    }
    // Many pulses on their way at once.
    let times: Vec<f64> = (0..40).map(|k| f64::from(k) * 6e-3).collect();
    let requests = (0..40).map(|k| if k % 2 == 0 { Request::Fill } else { Request::Exhaust }).collect();
    let (plant, start) =
        plant(solenoid(ValveKind::ThreeWay, 0.1), Command::table(times.clone(), requests).expect("a table"));
    let run = simulate_plant(&plant, &start, 0.4, 1e-8).expect("a run");
    for (k, (moved, time)) in seats(&run).into_iter().zip(times).enumerate() {
        assert_within(moved, time + 0.1 + if k % 2 == 0 { OPEN } else { CLOSE }, 1e-15);
    }
}

/// Valves of each kind with a command that leaves them shut, or at rest, until a tenth of a second.
fn kinds() -> Vec<(&'static str, Solenoid, Command)> {
    let times = || vec![0.1, 0.13, 0.2, 0.21, 0.26];
    let requests = vec![Request::Fill, Request::Hold, Request::Exhaust, Request::Fill, Request::Hold];
    let table = Command::table(times(), requests).expect("a table");
    let seats = Solenoid::new(ValveKind::FillHoldExhaust, OPEN, CLOSE).expect("a solenoid");
    let ramp = Ramp::new(3e-3, 5e-3).expect("a ramp");
    let spool = Solenoid::proportional(Spool::new(60.0, 0.6, 0.05, 0.05).expect("a spool"));
    let regulator = Solenoid::regulating(Regulator::new(0.02, 0.0, 5e6).expect("a regulator"));
    let positions = Command::positions(times(), vec![0.5, -0.3, 0.0, 0.9, 0.0]).expect("positions");
    let points = Command::set_points(times(), vec![3e5, 1e5, 2e5, 4e5, 1.5e5]).expect("set points");
    vec![
        ("seats", seats, table.clone()),
        ("ramped", seats.with_ramp(ramp), table),
        ("spool", spool, positions),
        ("regulator", regulator, points),
    ]
}

#[test]
fn a_shifted_run_is_the_unshifted_one_later() {
    let dead_time = 0.03125;
    for (name, valve, command) in kinds() {
        let late = valve.with_dead_time(dead_time).expect("a time");
        assert_eq!(late.dead_time(), dead_time, "{name}");
        let run = |valve: Solenoid| {
            let (plant, start) = plant(valve, command.clone());
            let run = simulate_plant(&plant, &start, 0.5, 1e-10).expect(name);
            let here = plant.indices().actuators[0];
            move |time: f64| [run.at(time).0[here.pressure], run.at(time).0[here.mass()]]
        };
        let (before, after) = (run(valve), run(late));
        let mut moved: f64 = 0.0;
        for k in 0..=400 {
            let time = 0.46 * f64::from(k) / 400.0;
            for (one, other) in after(time + dead_time).into_iter().zip(before(time)) {
                assert_close(one, other, 1e-8);
            }
            moved = moved.max((before(time)[0] / before(0.0)[0] - 1.0).abs());
        }
        assert!(moved > 0.1, "{name} does nothing");
        // By fixed steps as well, of which the dead time is a whole number.
        let stepped = |valve: Solenoid, from: f64| {
            let (rig, start) = rig(valve, command.clone());
            let mut stepper = RigSteps::new(&rig, start, Method::Stable);
            let step = 1.0 / 1024.0;
            let first = (from / step) as usize;
            (1..=first + 400)
                .map(|k| {
                    stepper.advance_to(k as f64 * step).expect(name);
                    stepper.sample().pressure.0
                })
                .skip(first)
                .collect::<Vec<f64>>()
        };
        for (one, other) in stepped(late, dead_time).into_iter().zip(stepped(valve, 0.0)) {
            assert_close(one, other, 1e-9);
        }
    }
}

#[test]
fn both_outputs_of_a_five_way_valve_are_late() {
    let command = Command::pwm(20.0, 0.4, Request::Fill, Request::Exhaust).expect("a command");
    for rest in [FiveWayRest::Returned, FiveWayRest::Closed, FiveWayRest::Exhausted, FiveWayRest::Pressurised] {
        let motions = |dead_time: f64| {
            let valve = FiveWay::new(rest, OPEN, CLOSE).and_then(|valve| valve.with_dead_time(dead_time)).expect("one");
            valve.outputs(&command).expect("outputs").map(|output| {
                let mut clock = PoppetClock::released();
                let mut times = vec![];
                while let Some(time) = clock.next_motion(&output.solenoid, &output.command, 0.4 + dead_time) {
                    clock.advance(time, &output.solenoid, &output.command);
                    times.push(time);
                }
                times
            })
        };
        let (before, after) = (motions(0.0), motions(0.017));
        for (before, after) in before.iter().zip(&after) {
            assert!(before.len() > 5);
            assert_eq!(before.len(), after.len());
            for (one, other) in before.iter().zip(after) {
                assert_within(*other, one + 0.017, 1e-15);
            }
        }
    }
}

/// A valve that is set at run time goes on with what it was set to within the dead time before.
#[test]
fn what_is_set_at_run_time_acts_after_the_dead_time() {
    let dead_time = 0.05;
    let valve = solenoid(ValveKind::FillHoldExhaust, dead_time);
    let (plant, start) = plant(valve, Command::Constant(Request::Hold));
    let mut run = PlantRun::new(&plant, &start, 1e-8).expect("a run");
    let set = [(0.01, Request::Fill), (0.02, Request::Hold), (0.04, Request::Exhaust), (0.047, Request::Hold)];
    let mut moved = vec![];
    for (k, (time, request)) in set.into_iter().enumerate() {
        moved.extend(seats(&run.record_to(time, &mut |_| Ok(())).expect("on")));
        run.set(0, request).expect("set");
        assert!(k > 0 || moved.is_empty());
    }
    moved.extend(seats(&run.record_to(0.3, &mut |_| Ok(())).expect("on")));
    let expected = [0.01 + OPEN, 0.02 + CLOSE, 0.04 + OPEN, 0.047 + CLOSE];
    assert_eq!(moved.len(), expected.len(), "{moved:?}");
    for (one, other) in moved.into_iter().zip(expected) {
        assert_within(one, other + dead_time, 1e-15);
    }
}

#[test]
fn instants_move_with_the_dead_time_and_errors_name_it() {
    let command = Command::pwm(25.0, 0.5, Request::Fill, Request::Exhaust).expect("a command");
    let (plant, start) = plant(solenoid(ValveKind::ThreeWay, 7e-3), command);
    type D = mckibben::Seeded;
    let of = |row: &'static parameter::Parameter, value: f64| {
        if row.key == parameter::VALVE_DEAD_TIME.key { D::variable(value, 0) } else { D::constant(value) }
    };
    let seeded = plant.map(|_, row, value| of(row, value));
    let constant = |number: &f64| D::constant(*number);
    let start = PlantStart {
        positions: start.positions.iter().map(|list| list.iter().map(constant).collect()).collect(),
        rates: start.rates.iter().map(|list| list.iter().map(constant).collect()).collect(),
        air: start
            .air
            .iter()
            .map(|air| mckibben::plant::InitialAir {
                gauge_pressure: GaugePressure(constant(&air.gauge_pressure.0)),
                temperature: constant(&air.temperature),
            })
            .collect(),
        lengths: vec![None],
        friction: vec![],
    };
    let run = simulate_plant(&seeded, &start, D::constant(0.2), 1e-8).expect("a run");
    let moved: Vec<D> =
        run.events().iter().filter(|event| event.kind.kind == EventKind::Valve).map(|event| event.time).collect();
    assert_eq!(moved.len(), 10);
    for time in moved {
        assert_eq!(time.slope[0], 1.0);
    }
    // So it is behind a hose, which lets the valve be seen later still, over any scalar.
    let (piped, state) = rig(solenoid(ValveKind::ThreeWay, 7e-3), Command::Constant(Request::Fill));
    let hose = Hose::new(HoseKind::Lumped, [1.5, 3e-3], [1.82e-5, ROOM, 1.4], piped.actuator().air()).expect("a hose");
    let piped = piped.with_line(Line { hose: Some(hose), ..Line::NONE }).expect("a rig");
    let plain = Plant::of_rig(&piped);
    let at_start = Plant::start_of_rig(&piped, &state);
    let opened = seats(&simulate_plant(&plain, &at_start, 0.05, 1e-8).expect("a run"));
    assert_within(opened[0], 7e-3 + OPEN + hose.transport_delay(), 1e-15);
    assert!(hose.transport_delay() > 3e-3);
    let same = plain.map(|_, _, value| value);
    assert_eq!(seats(&simulate_plant(&same, &at_start, 0.05, 1e-8).expect("a run")), opened);
    for wrong in [-1e-3, f64::NAN, f64::INFINITY] {
        let error = Solenoid::new(ValveKind::TwoWay, 0.0, 0.0).and_then(|valve| valve.with_dead_time(wrong));
        assert!(error.expect_err("refused").to_string().contains("valve.dead_time"));
    }
}
