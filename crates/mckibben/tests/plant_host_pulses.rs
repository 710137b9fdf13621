//! One actuator whose ends a host moves and whose valve it pulses, against the fixed-step engine, the event-located engine and
//! itself: pulses at their instants, long moves in parts, derivatives, flows through hoses.

use crate::common::{self, GRAVITY, LB, Paper, assert_close, between};
use crate::plant_saved::bits;
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::load::{Load, Motion};
use mckibben::plant::{Plant, PlantRun, PlantStart, PlantSteps};
use mckibben::simulation::{Method, Rig};
use mckibben::valve::{Request, RuntimeCommand};
use mckibben::{Dual, Error, GaugePressure, Over, parameter};

const FREQUENCY: f64 = 25.0;

fn pulses_at<R>(frequency: R, duty: R) -> RuntimeCommand<R> {
    RuntimeCommand::Pulses { frequency, duty, pulse: Request::Fill, rest: Request::Exhaust }
}

fn pulses(duty: f64) -> RuntimeCommand {
    pulses_at(FREQUENCY, duty)
}

/// The actuator of a rig with its air, whose valve and ends belong to a host.
fn of_host(rig: &Rig, paper: &Paper) -> (Plant, PlantStart) {
    let state = rig.start(&paper.initial()).expect("a start");
    let plant = Plant::of_rig(rig).without_commands(&[0]);
    plant.to_external(&Plant::start_of_rig(rig, &state)).expect("a host's")
}

fn hosted(paper: &Paper) -> PlantSteps {
    let (plant, start) = of_host(&paper.rig(), paper);
    PlantRun::new(&plant, &start, 1e-9).expect("a start").steps(Method::Stable)
}

/// Pressure in Pa and mass of the air in kg.
fn air(steps: &PlantSteps) -> [f64; 2] {
    let here = steps.plant().indices().actuators[0];
    [steps.state()[here.pressure], steps.state()[here.mass()]]
}

/// Lengths of a mass that hangs from it, at each 20th of the time, by steps of the simplest kind.
fn hang(paper: &Paper, duty: f64, mass: f64, duration: f64, steps: u32) -> Vec<f64> {
    let mut actuator = hosted(paper);
    actuator.set(0, pulses(duty)).expect("pulses");
    let (mut length, mut velocity, step) = (paper.start().length, 0.0, duration / f64::from(steps));
    let mut lengths = Vec::new();
    for count in 1..=steps {
        let mut response = [actuator.compute(0).expect("one")];
        actuator.compute_at(&[length], &[velocity], &mut response).expect("one");
        velocity += (GRAVITY - response[0].tension / mass) * step;
        length += velocity * step;
        actuator.move_to(duration * f64::from(count) / f64::from(steps), &[length]).expect("a step");
        if count % (steps / 20) == 0 {
            lengths.push(length);
        }
    }
    lengths
}

#[test]
fn moved_along_a_table_it_is_the_run_of_that_motion() {
    let (step, duty) = (1.3e-3, 0.37);
    let times: Vec<f64> = (0..=400).map(|k| f64::from(k) * step).collect();
    let lengths: Vec<f64> = (0..=400).map(|k| between(k, 0, 0.075, 0.098)).collect();
    let paper = Paper::pwm(FREQUENCY, duty).with(|rig| {
        let motion = Motion::table(times.clone(), lengths.clone(), rig.thread_length).expect("a motion");
        rig.load = Load::Prescribed(motion);
    });
    let (plant, start) = (Plant::of_rig(&paper.rig()), Plant::start_of_rig(&paper.rig(), &paper.start()));
    let mut given = PlantRun::new(&plant, &start, 1e-9).expect("a start").steps(Method::Stable);
    let mut actuator = hosted(&paper);
    actuator.set(0, pulses(duty)).expect("pulses");
    for (time, length) in times.iter().zip(&lengths).skip(1) {
        given.advance_to(*time).expect("a step");
        actuator.move_to(*time, &[*length]).expect("a step");
        let (ours, engine) = (actuator.sample(), given.sample());
        assert_close(ours.actuators[0].pressure.0, engine.actuators[0].pressure.0, 1e-12);
        assert_close(ours.actuators[0].air_mass, engine.actuators[0].air_mass, 1e-12);
        assert_eq!(ours.valves, engine.valves, "at {time} s");
    }
}

#[test]
fn a_mass_in_a_host_s_loop_approaches_the_event_located_run() {
    let (mass, duration, duty) = (5.0 * LB, 0.32, 0.5);
    let paper = Paper::pwm(FREQUENCY, duty).friction(100.0, 0.0).mass(mass).gauge(3e5);
    let run = paper.run(duration, 1e-10);
    let errors = [1600, 3200, 6400].map(|steps| {
        let lengths = hang(&paper, duty, mass, duration, steps);
        let off = |(length, k): (f64, i32)| (length - run.at(duration * f64::from(k) / 20.0).length).abs();
        lengths.into_iter().zip(1..).map(off).fold(0.0, f64::max)
    });
    // The loop is of first order at least: half the step, no more than half the error.
    assert!(errors[2] < 5e-6 && errors.windows(2).all(|pair| pair[0] > 2.0 * pair[1]), "{errors:?}");
}

#[test]
fn what_flows_in_is_what_the_response_says_also_through_a_hose() {
    let paper = Paper::pwm(FREQUENCY, 1.0).isometric(0.085);
    let hose = Hose::new(HoseKind::Lumped, [0.5, 2e-3], [1.81e-5, 293.15, 1.0], &paper.air()).expect("a hose");
    for line in [Line::NONE, Line { hose: Some(hose), ..Line::NONE }] {
        let rig = paper.rig().with_line(line).expect("a line");
        let (plant, start) = of_host(&rig, &paper);
        let mut actuator = PlantRun::new(&plant, &start, 1e-9).expect("a start").steps(Method::Stable);
        actuator.set(0, Request::Fill).expect("a request");
        actuator.move_to(0.02, &[0.085]).expect("a step");
        let step = 1e-7;
        let before = (actuator.compute(0).expect("one"), air(&actuator));
        actuator.move_to(0.02 + step, &[0.085]).expect("a step");
        let after = (actuator.compute(0).expect("one"), air(&actuator));
        // The mean of both ends errs by the square of the step.
        let mean = |one: f64, other: f64| 0.5 * (one + other);
        let flow = mean(before.0.mass_flow, after.0.mass_flow);
        assert_close((after.1[1] - before.1[1]) / step, flow, 1e-5);
        let rise = mean(before.0.pressure_rate, after.0.pressure_rate);
        assert_close((after.1[0] - before.1[0]) / step, rise, 1e-5);
    }
}

#[test]
fn dual_numbers_carry_derivatives_through_pulses_and_motion() {
    let paper = Paper::pwm(FREQUENCY, 0.4);
    let (plant, start) = of_host(&paper.rig(), &paper);
    let end = |change: f64| {
        let varied =
            plant.map(|_, its, value| if its.key == parameter::EFFICIENCY.key { value + change } else { value });
        let mut actuator = PlantRun::new(&varied, &start, 1e-9).expect("a start").steps(Method::Stable);
        actuator.set(0, pulses(0.4)).expect("pulses");
        (1..=50).for_each(|k| actuator.move_to(f64::from(k) * 2e-3, &[0.09]).expect("a step"));
        air(&actuator)[0]
    };
    let seeded: Plant<mckibben::Seeded> =
        plant.map(
            |_, its, value| {
                if its.key == parameter::EFFICIENCY.key { Dual::variable(value, 0) } else { Dual::of(value) }
            },
        );
    let start = start.map(|_, value| Dual::of(value));
    let mut actuator = PlantRun::new(&seeded, &start, 1e-9).expect("a start").steps(Method::Stable);
    actuator.set(0, pulses_at(Dual::of(FREQUENCY), Dual::of(0.4))).expect("pulses");
    (1..=50).for_each(|k| actuator.move_to(Dual::of(f64::from(k) * 2e-3), &[Dual::of(0.09)]).expect("a step"));
    let slope = common::slope(1e-4, end);
    assert_close(actuator.state()[plant.indices().actuators[0].pressure].slope[0], slope, 1e-7);
}

#[test]
fn what_cannot_be_done_is_refused_and_changes_nothing() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let mut actuator = hosted(&paper);
    actuator.set(0, pulses(0.5)).expect("pulses");
    actuator.move_to(0.05, &[0.09]).expect("a step");
    let before = actuator.sample();
    let refused = |result: Result<(), Error>, text: &str| {
        let said = result.expect_err("refused").to_string();
        assert!(said.contains(text), "{said}");
    };
    refused(actuator.set(0, Request::Hold), "three-way valve cannot hold");
    refused(actuator.set(0, pulses(1.2)), "duty");
    refused(actuator.set(0, pulses_at(0.0, 0.5)), "command.frequency");
    refused(actuator.move_to(0.05, &[0.091]), "back in time");
    assert!(matches!(actuator.move_to(f64::NAN, &[0.091]), Err(Error::OutOfRange { .. })));
    refused(actuator.move_to(0.1, &[0.2]), "pulled a braid straight");
    assert!(actuator.move_to(0.1, &[f64::NAN]).is_err());
    assert_eq!(actuator.sample(), before);
    actuator.move_to(0.1, &[0.091]).expect("it goes on");
    assert!(matches!(hosted(&Paper::sealed()).set(0, Request::Fill), Err(Error::Misuse { .. })));
}

/// A duty cycle that is commanded where a pulse begins is that pulse's, as one that was commanded during the pulse before.
#[test]
fn a_command_where_a_pulse_begins_comes_before_it() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let (length, period) = (paper.start().length, 1.0 / FREQUENCY);
    let after = |commands: [(f64, f64); 2]| {
        let mut actuator = hosted(&paper);
        for count in 0..8 {
            let now = f64::from(count) * 0.5 * period;
            for (_, duty) in commands.iter().filter(|(time, _)| (time - now).abs() < 1e-9) {
                actuator.set(0, pulses(*duty)).expect("pulses");
            }
            actuator.move_to(f64::from(count + 1) * 0.5 * period, &[length]).expect("a step");
        }
        bits(actuator.state())
    };
    for count in 1..4 {
        let begin = f64::from(count) * period;
        let at_once = after([(0.0, 0.3), (begin, 0.7)]);
        assert_eq!(at_once, after([(0.0, 0.3), (begin - 0.5 * period, 0.7)]));
        assert_ne!(at_once, after([(0.0, 0.3), (begin + 0.5 * period, 0.7)]));
    }
}

#[test]
fn parts_of_a_step_take_its_error_away() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let at_end = |steps: u32, longest: f64| {
        let mut actuator = hosted(&paper);
        actuator.limit_step(longest).expect("a limit");
        actuator.set(0, pulses(0.5)).expect("pulses");
        let begin = paper.start().length;
        for step in 1..=steps {
            let share = f64::from(step) / f64::from(steps);
            actuator.move_to(0.1 * share, &[begin - 0.008 * share]).expect("a step");
        }
        air(&actuator)[0]
    };
    let exact = at_end(20_000, f64::INFINITY);
    let off = |steps, longest| (at_end(steps, longest) - exact).abs() / exact;
    let (coarse, divided, fine) = (off(10, f64::INFINITY), off(10, 1e-4), off(1000, f64::INFINITY));
    assert!(divided < 1e-2 * coarse && divided < 1.1 * fine + 1e-12, "{coarse:e} {divided:e} {fine:e}");
}

#[test]
fn it_pulls_nothing_up_to_its_rest_length() {
    let paper = Paper::sealed();
    let actuator = paper.actuator();
    let (plant, _) = of_host(&paper.rig(), &paper);
    let (end, thread) = plant.end_distance(0).expect("an actuator").expect("no tendon");
    assert_eq!(end, "actuator.thread_length");
    assert!(matches!(plant.end_distance(1), Err(Error::Misuse { .. })));
    // Of a braid that alone decides the force comes from the angle: none at thread/sqrt(3), at any pressure.
    let neutral = thread / 3.0_f64.sqrt();
    for gauge in [2e4, 2e5, 6e5] {
        assert_close(actuator.rest_length(GaugePressure(gauge)).expect("a length"), neutral, 1e-9);
    }
    // Without pressure it pulls nothing until it is taut.
    let taut = actuator.limits().max_length();
    assert_close(actuator.rest_length(GaugePressure(0.0)).expect("a length"), taut, 1e-12);
    let below = actuator.rest_length(GaugePressure(-2e5)).expect_err("a vacuum");
    assert!(below.to_string().contains("initial.gauge_pressure"), "{below}");
    assert!(actuator.rest_length(GaugePressure(f64::NAN)).is_err());
}

/// Parts and pulses without end are counted before they are taken.
#[test]
fn what_would_never_end_is_refused() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let refused = |mut actuator: PlantSteps, until: f64| {
        let before = actuator.sample();
        let said = actuator.move_to(until, &[0.09]).expect_err("refused").to_string();
        assert!(until > 1e6 || said.contains("ten million"), "{said}");
        assert_eq!(actuator.sample(), before);
    };
    for (frequency, until) in [(FREQUENCY, f64::INFINITY), (FREQUENCY, 1e300), (1e300, 1e-3), (1e13, 1e-3)] {
        let mut actuator = hosted(&paper);
        actuator.set(0, pulses_at(frequency, 0.5)).expect("pulses");
        assert!(actuator.parts_until(until) > 1e7);
        refused(actuator, until);
    }
    let mut actuator = hosted(&paper);
    actuator.limit_step(1e-300).expect("a limit");
    refused(actuator, 1e-3);
    // As many pulses as can be counted later on, and none that can.
    let mut actuator = hosted(&paper);
    actuator.move_to(1.0, &[0.09]).expect("no pulses yet");
    actuator.set(0, pulses_at(1e300, 0.5)).expect("pulses");
    refused(actuator, 1.001);
    for wrong in [0.0, f64::NAN, -1.0] {
        assert!(hosted(&paper).limit_step(wrong).is_err());
    }
    let mut actuator = hosted(&paper);
    actuator.set(0, pulses(0.5)).expect("pulses");
    actuator.limit_step(1e-3).expect("a limit");
    // Ten parts and half a pulse.
    assert_close(actuator.parts_until(0.01), 10.5, 1e-12);
}
