//! The modular actuator, whose ends somebody else moves.

use crate::common;
use common::{GRAVITY, LB, Paper, assert_close, between};
use mckibben::control::Drive;
use mckibben::friction::{Hysteresis, MaxwellSlip};
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::load::{Load, Motion};
use mckibben::simulation::{FixedStepper, Method, ModularActuator, Rig};
use mckibben::valve::Request;
use mckibben::{Dual, Error, GaugePressure, Over};

const FREQUENCY: f64 = 25.0;

fn pulses(duty: f64) -> Drive {
    Drive::Pulses { duty, pulse: Request::Fill, rest: Request::Exhaust }
}

fn modular(paper: &Paper) -> ModularActuator {
    ModularActuator::new(&paper.rig(), paper.start(), FREQUENCY).expect("an actuator")
}

/// Lengths of a mass that hangs from it, at each 20th of the time, by steps of the simplest kind.
fn hang(paper: &Paper, duty: f64, mass: f64, duration: f64, steps: u32) -> Vec<f64> {
    let mut actuator = modular(paper);
    actuator.drive(pulses(duty)).expect("pulses");
    let (mut length, mut velocity, step) = (paper.start().length, 0.0, duration / f64::from(steps));
    let mut lengths = Vec::new();
    for count in 1..=steps {
        velocity += (GRAVITY - actuator.respond(velocity).tension / mass) * step;
        length += velocity * step;
        actuator.move_to(duration * f64::from(count) / f64::from(steps), length).expect("a step");
        if count % (steps / 20) == 0 {
            lengths.push(length);
        }
    }
    lengths
}

#[test]
fn moved_along_a_table_it_is_the_fixed_step_engine() {
    let (step, duty) = (1.3e-3, 0.37);
    let times: Vec<f64> = (0..=400).map(|k| f64::from(k) * step).collect();
    let lengths: Vec<f64> = (0..=400).map(|k| between(k, 0, 0.075, 0.098)).collect();
    let paper = Paper::pwm(FREQUENCY, duty).with(|rig| {
        let motion = Motion::table(times.clone(), lengths.clone(), rig.thread_length).expect("a motion");
        rig.load = Load::Prescribed(motion);
    });
    let rig = paper.rig();
    let mut stepper = FixedStepper::new(&rig, paper.start(), Method::Stable);
    let mut actuator = modular(&paper);
    actuator.drive(pulses(duty)).expect("pulses");
    for (time, length) in times.iter().zip(&lengths).skip(1) {
        stepper.advance_to(*time).expect("a step");
        actuator.move_to(*time, *length).expect("a step");
        let (ours, engine) = (actuator.sample(), stepper.sample());
        assert_close(ours.pressure.0, engine.pressure.0, 1e-13);
        assert_close(ours.air_mass, engine.air_mass, 1e-13);
        assert_eq!(ours.ports, engine.ports, "at {time} s");
    }
}

#[test]
fn a_mass_in_a_loop_of_one_s_own_approaches_the_event_located_run() {
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
        let mut actuator = ModularActuator::new(&rig, paper.start(), FREQUENCY).expect("an actuator");
        actuator.drive(Drive::Steady(Request::Fill)).expect("a request");
        actuator.move_to(0.02, 0.085).expect("a step");
        let step = 1e-7;
        let before = (actuator.respond(0.0), actuator.state());
        actuator.move_to(0.02 + step, 0.085).expect("a step");
        let after = (actuator.respond(0.0), actuator.state());
        // The mean of both ends errs by the square of the step.
        let mean = |one: f64, other: f64| 0.5 * (one + other);
        let flow = mean(before.0.mass_flow, after.0.mass_flow);
        assert_close((after.1.air_mass - before.1.air_mass) / step, flow, 1e-5);
        let rise = mean(before.0.pressure_rate, after.0.pressure_rate);
        assert_close((after.1.pressure.0 - before.1.pressure.0) / step, rise, 1e-5);
    }
}

#[test]
fn dual_numbers_carry_derivatives_through_pulses_and_motion() {
    let paper = Paper::pwm(FREQUENCY, 0.4);
    let end = |area: f64| {
        let mut paper = paper.clone();
        paper.efficiency = area;
        let mut actuator = modular(&paper);
        actuator.drive(pulses(0.4)).expect("pulses");
        (1..=50).for_each(|k| actuator.move_to(f64::from(k) * 2e-3, 0.09).expect("a step"));
        actuator.state().pressure.0
    };
    let seeded: Rig<Dual<f64, 1>> = paper.rig().map(|parameter, value| {
        let dual = Dual::of(value);
        if parameter.key == "valve.efficiency" { Dual::variable(value, 0) } else { dual }
    });
    let initial = paper.initial().map(|_, value| Dual::of(value));
    let start = seeded.begin(&initial).expect("a start");
    let mut actuator = ModularActuator::new(&seeded, start, Dual::of(FREQUENCY)).expect("an actuator");
    let drive = Drive::Pulses { duty: Dual::of(0.4), pulse: Request::Fill, rest: Request::Exhaust };
    actuator.drive(drive).expect("pulses");
    (1..=50).for_each(|k| actuator.move_to(Dual::of(f64::from(k) * 2e-3), Dual::of(0.09)).expect("a step"));
    let slope = common::slope(1e-4, |change| end(0.85 + change));
    assert_close(actuator.state().pressure.0.slope[0], slope, 1e-7);
}

#[test]
fn from_a_snapshot_it_goes_on_as_it_did() {
    let law = MaxwellSlip::new(&[2e-4], &[0.3]).expect("an element");
    let paper = Paper::pwm(FREQUENCY, 0.5).with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(law)));
    let mut actuator = modular(&paper);
    actuator.drive(pulses(0.4)).expect("a duty cycle");
    let go_on = |actuator: &mut ModularActuator| {
        (0..50)
            .map(|_| {
                let (until, length) = (actuator.time() + 1e-3, actuator.state().length - 2e-5);
                actuator.move_to(until, length).expect("a step");
                actuator.sample()
            })
            .collect::<Vec<_>>()
    };
    go_on(&mut actuator);
    let there = actuator.snapshot();
    let first = go_on(&mut actuator);
    let mut other = modular(&paper);
    for twin in [&mut actuator, &mut other] {
        twin.restore(&there);
        assert_eq!(go_on(twin), first);
    }
}

#[test]
fn what_cannot_be_done_is_refused_and_changes_nothing() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let mut actuator = modular(&paper);
    actuator.drive(pulses(0.5)).expect("pulses");
    actuator.move_to(0.05, 0.09).expect("a step");
    let before = actuator.sample();
    let refused = |result: Result<(), Error>, text: &str| {
        let said = result.expect_err("refused").to_string();
        assert!(said.contains(text), "{said}");
    };
    refused(actuator.drive(Drive::Steady(Request::Hold)), "three-way valve cannot hold");
    refused(actuator.drive(pulses(1.2)), "duty");
    refused(actuator.move_to(0.05, 0.091), "back in time");
    refused(actuator.move_to(f64::NAN, 0.091), "back in time");
    refused(actuator.move_to(0.1, 0.2), "left the physics");
    refused(actuator.move_to(0.1, f64::NAN), "left the physics");
    assert_eq!(actuator.sample(), before);
    actuator.move_to(0.1, 0.091).expect("it goes on");

    let sealed = Paper::sealed();
    let mut actuator = ModularActuator::new(&sealed.rig(), sealed.start(), FREQUENCY).expect("an actuator");
    refused(actuator.drive(Drive::Steady(Request::Fill)), "has none");
    let error = ModularActuator::new(&sealed.rig(), sealed.start(), 0.0).expect_err("no frequency");
    assert!(error.to_string().contains("command.frequency"), "{error}");
    let guided = Rig::new(sealed.actuator(), None, Load::Prescribed(Motion::Guided)).expect_err("nobody moves it");
    assert!(guided.to_string().contains("guided"), "{guided}");
}

/// A duty cycle that is commanded where a pulse begins is that pulse's, as one that was commanded during the pulse before.
#[test]
fn a_command_where_a_pulse_begins_comes_before_it() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let (length, period) = (paper.start().length, 1.0 / FREQUENCY);
    let after = |commands: [(f64, f64); 2]| {
        let mut actuator = modular(&paper);
        for count in 0..8 {
            let now = f64::from(count) * 0.5 * period;
            for (_, duty) in commands.iter().filter(|(time, _)| (time - now).abs() < 1e-9) {
                actuator.drive(pulses(*duty)).expect("pulses");
            }
            actuator.move_to(f64::from(count + 1) * 0.5 * period, length).expect("a step");
        }
        actuator.state()
    };
    for count in 1..4 {
        let begin = f64::from(count) * period;
        let at_once = after([(0.0, 0.3), (begin, 0.7)]);
        assert_eq!(at_once, after([(0.0, 0.3), (begin - 0.5 * period, 0.7)]));
        assert_ne!(at_once, after([(0.0, 0.3), (begin + 0.5 * period, 0.7)]));
    }
}

#[test]
fn a_step_in_parts_is_as_many_steps_along_the_same_line() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let (dt, parts) = (0.01, 8);
    let (mut whole, mut divided) = (modular(&paper), modular(&paper));
    // A part that is a rounding longer than the limit is as long.
    divided.limit_step(dt / f64::from(parts) * (1.0 - 1e-15)).expect("a limit");
    let lengths = [0.0895, 0.0881, 0.0884, 0.086, 0.0871, 0.0899];
    for (actuator, of_step) in [(&mut whole, parts), (&mut divided, 1)] {
        actuator.drive(pulses(0.37)).expect("pulses");
        let mut begin = actuator.state().length;
        for (step, length) in (0..).zip(lengths) {
            for part in 1..=of_step {
                let share = f64::from(part) / f64::from(of_step);
                let until = (f64::from(step) + share) * dt;
                actuator
                    .move_to(until, if part < of_step { begin + share * (length - begin) } else { length })
                    .expect("a step");
            }
            begin = length;
        }
    }
    let (whole, divided) = (whole.state(), divided.state());
    assert_close(divided.pressure.0, whole.pressure.0, 1e-12);
    assert_close(divided.air_mass, whole.air_mass, 1e-12);
}

#[test]
fn parts_of_a_step_take_its_error_away() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let at_end = |steps: u32, longest: f64| {
        let mut actuator = modular(&paper);
        actuator.limit_step(longest).expect("a limit");
        actuator.drive(pulses(0.5)).expect("pulses");
        let begin = actuator.state().length;
        for step in 1..=steps {
            let share = f64::from(step) / f64::from(steps);
            actuator.move_to(0.1 * share, begin - 0.008 * share).expect("a step");
        }
        actuator.state().pressure.0
    };
    let exact = at_end(20_000, f64::INFINITY);
    let off = |steps, longest| (at_end(steps, longest) - exact).abs() / exact;
    let (coarse, divided, fine) = (off(10, f64::INFINITY), off(10, 1e-4), off(1000, f64::INFINITY));
    assert!(divided < 1e-2 * coarse && divided < 1.1 * fine + 1e-12, "{coarse:e} {divided:e} {fine:e}");
}

#[test]
fn it_pulls_nothing_up_to_its_rest_length() {
    let paper = Paper::sealed();
    let rig = paper.rig();
    let actuator = ModularActuator::new(&rig, paper.start(), FREQUENCY).expect("an actuator");
    let (end, thread) = actuator.end_length();
    assert_eq!(end, "actuator.thread_length");
    // Of a braid that alone decides the force comes from the angle: none at thread/sqrt(3), at any pressure.
    let neutral = thread / 3.0_f64.sqrt();
    for gauge in [2e4, 2e5, 6e5] {
        assert_close(actuator.rest_length(GaugePressure(gauge)).expect("a length"), neutral, 1e-9);
    }
    // Without pressure it pulls nothing until it is taut.
    let taut = rig.actuator().limits().max_length();
    assert_close(actuator.rest_length(GaugePressure(0.0)).expect("a length"), taut, 1e-12);
    let below = actuator.rest_length(GaugePressure(-2e5)).expect_err("a vacuum");
    assert!(below.to_string().contains("initial.gauge_pressure"), "{below}");
    assert!(actuator.rest_length(GaugePressure(f64::NAN)).is_err());
}

#[test]
fn what_would_never_end_is_refused() {
    let paper = Paper::pwm(FREQUENCY, 0.5);
    let rig = paper.rig();
    let begun = |frequency: f64| ModularActuator::new(&rig, paper.start(), frequency).expect("an actuator");
    let refused = |mut actuator: ModularActuator, until: f64| {
        let before = actuator.sample();
        let said = actuator.move_to(until, 0.09).expect_err("refused").to_string();
        assert!(said.contains("ten million"), "{said}");
        assert_eq!(actuator.sample(), before);
    };
    for (frequency, until) in [(FREQUENCY, f64::INFINITY), (FREQUENCY, 1e300), (1e300, 1e-3), (1e12, 1e-3)] {
        let mut actuator = begun(frequency);
        actuator.drive(pulses(0.5)).expect("pulses");
        refused(actuator, until);
    }
    let mut actuator = begun(FREQUENCY);
    actuator.limit_step(1e-300).expect("a limit");
    refused(actuator, 1e-3);
    let mut actuator = begun(FREQUENCY);
    assert!(
        actuator.limit_step(0.0).is_err()
            && actuator.limit_step(f64::NAN).is_err()
            && actuator.limit_step(-1.0).is_err()
    );
    // As many pulses as can be counted later on, and none that can: from there on `drive` has an end too.
    let mut actuator = begun(1e300);
    actuator.move_to(1.0, 0.09).expect("no pulses yet");
    actuator.drive(pulses(0.5)).expect("pulses");
    refused(actuator, 1.001);
}
