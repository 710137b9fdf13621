//! The joint at fixed steps: its orders against the event-located engine with edges, reversals, stops, slack and taut inside
//! the steps; true sticking against the closed form; the rig on a line as a limiting case; valves that are set against the
//! tabled command; and what leaves the physics.

use crate::common::joint::{Pair, on_a_line};
use crate::common::random::runner;
use crate::common::steps::{JointSteps, RigSteps};
use crate::common::{PSI, Paper, assert_close, assert_within};
use mckibben::load::{Joint, MomentArm, Stops, Tendon};
use mckibben::plant::{JointPlant, plant_step_for_accuracy};
use mckibben::simulation::{
    Actuation, Driven, EventKind, InitialAngle, JointRig, JointState, Method, Rig, SampleTimes, Sliding,
};
use mckibben::valve::{Command, FlowStandard, Ramp, Regulator, Request, RuntimeCommand, Solenoid, Spool, ValveKind};
use proptest::prelude::*;
use std::f64::consts::PI;

fn pulses(frequency: f64, duty: f64) -> Command {
    Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command")
}

/// A pair whose flows are choked throughout, so that the rates are smooth between edges.
fn smooth(coulomb_width: f64) -> Pair {
    let paper = Paper::driven(pulses(20.0, 0.5)).gauge(45.0 * PSI).friction(3.5, coulomb_width).with(|rig| {
        rig.external_volume = 1e-3;
        rig.supply_gauge = 250.0 * PSI;
        rig.delays = (4.3e-3, 1.1e-3);
    });
    Pair::of(paper).with(|pair| {
        pair.papers[1].command = Some(pulses(13.0, 0.4));
        pair.limb.distance = 0.1;
        pair.angle = InitialAngle::At(0.2);
        pair.damping = 2e-3;
    })
}

fn end_of(pair: &Pair, method: Method, step: f64, duration: f64) -> JointState {
    let mut stepper = begun(pair, method);
    let steps = (duration / step).round() as u32;
    for index in 1..=steps {
        stepper.advance_to(duration * f64::from(index) / f64::from(steps)).expect("a step");
    }
    stepper.state()
}

fn begun(pair: &Pair, method: Method) -> JointSteps {
    let rig = pair.rig().expect("a rig");
    JointSteps::new(&rig, rig.start(&pair.initial()).expect("a start"), method)
}

/// All six states.
fn numbers(state: JointState) -> [f64; 6] {
    let JointState { angle, angular_velocity, pressure: [first, second], air_mass: [mass, other] } = state;
    [angle, angular_velocity, first.0, mass, second.0, other]
}

/// Largest difference of two states, each in units of its usual size.
fn difference(a: JointState, b: JointState) -> f64 {
    let pressure = |i: usize| (a.pressure[i].0 - b.pressure[i].0) / 1e5;
    let mass = |i: usize| (a.air_mass[i] - b.air_mass[i]) / 1e-4;
    let parts = [
        a.angle - b.angle,
        0.1 * (a.angular_velocity - b.angular_velocity),
        pressure(0),
        pressure(1),
        mass(0),
        mass(1),
    ];
    parts.into_iter().fold(0.0, |most: f64, part| most.max(part.abs()))
}

fn located(pair: &Pair, duration: f64) -> JointState {
    let last = pair.run(duration, 1e-13).at(duration);
    JointState {
        angle: last.angle,
        angular_velocity: last.angular_velocity,
        pressure: last.actuators.map(|of| of.pressure),
        air_mass: last.actuators.map(|of| of.air_mass),
    }
}

/// The order fitted to errors at halved steps: the slope of a straight line in the logarithms.
fn order(pair: &Pair, method: Method, step: f64, duration: f64) -> f64 {
    let exact = located(pair, duration);
    let steps = [step, step / 2.0, step / 4.0, step / 8.0];
    let errors = steps.map(|step| difference(end_of(pair, method, step, duration), exact));
    assert!(errors.iter().all(|error| *error > 1e-13), "errors have reached rounding: {errors:?}");
    let logarithms = errors.map(f64::log2);
    (3.0 * (logarithms[0] - logarithms[3]) + logarithms[1] - logarithms[2]) / 10.0
}

#[test]
fn both_methods_have_their_order_with_edges_of_both_valves_inside_the_steps() {
    let of = order(&smooth(0.0), Method::Rk4, 4e-3, 0.3);
    assert!((of - 4.0).abs() < 0.15, "Rk4: fitted order {of}");
    let of = order(&smooth(0.0), Method::Stable, 1e-3, 0.3);
    assert!((of - 2.0).abs() < 0.1, "stable: fitted order {of}");
}

#[test]
fn both_methods_keep_their_order_through_reversals_with_coulomb_friction() {
    let pair = smooth(1.1e-4).with(|pair| pair.limb.distance = 0.0);
    let turns = pair.run(0.3, 1e-9).events().iter().filter(|event| event.kind.kind == EventKind::Reversal).count();
    assert!(turns > 1, "{turns} reversals");
    let of = order(&pair, Method::Rk4, 2e-3, 0.3);
    assert!((of - 4.0).abs() < 0.2, "Rk4: fitted order {of}");
    let of = order(&pair, Method::Stable, 1e-3, 0.3);
    assert!((of - 2.0).abs() < 0.1, "stable: fitted order {of}");
}

/// Errors of steps and half steps over the whole of a run.
fn halves(pair: &Pair, step: f64, duration: f64) -> [f64; 2] {
    let exact = located(pair, duration);
    [step, 0.5 * step].map(|step| difference(end_of(pair, Method::Stable, step, duration), exact))
}

#[test]
fn the_stable_method_keeps_its_order_with_stops_slack_taut_and_rows_of_arms() {
    let swing = |change: fn(&mut Pair)| smooth(0.0).with(change);
    let stops = swing(|pair| pair.stops = Stops { ends: [Some(-0.05), Some(0.1)], stiffness: 300.0, damping: 0.3 });
    let slack = swing(|pair| {
        pair.papers[0].min_length = Some(0.0805);
        (pair.angle, pair.angular_velocity) = (InitialAngle::At(0.0), 2.0);
    });
    let taut = swing(|pair| {
        pair.papers[1].max_length = 0.0855;
        pair.papers[1].limit_stiffness = 5e4;
        (pair.papers[1].command, pair.papers[1].gauge, pair.angular_velocity) = (None, 5.0 * PSI, 3.0);
    });
    let arms = swing(|pair| {
        let arm = |arms: [f64; 4]| MomentArm::table(&[-0.3, -0.05, 0.15, 0.4], &arms).expect("a table");
        pair.tendons = [[0.012, 0.014, 0.016, 0.015], [0.016, 0.016, 0.014, 0.012]]
            .map(|arms| Tendon { arm: arm(arms), rest_length: 0.082 });
    });
    for (name, pair, kind) in [
        ("stops", stops, EventKind::StopReached),
        ("slack", slack, EventKind::Slack),
        ("taut", taut, EventKind::Taut),
        ("rows of arms", arms, EventKind::MomentArm),
    ] {
        let run = pair.run(0.25, 1e-9);
        assert!(run.events().iter().any(|event| event.kind.kind == kind), "{name} does not happen");
        let [coarse, fine] = halves(&pair, 4e-5, 0.25);
        let of = (coarse / fine).log2();
        assert!(of > 1.8 && fine < 1e-4, "{name}: order {of}, {coarse:e} and {fine:e}");
    }
}

/// The bound of both frictions in closed form, as for the event-located engine.
#[test]
fn it_sticks_within_the_torque_of_both_frictions_and_does_not_creep() {
    let (gauge, other, length, width) = (50.0 * PSI, 35.0 * PSI, 0.082, 1.1e-4);
    let paper = Paper::sealed().friction(1.0, width).gauge(gauge);
    let (b, n) = (paper.thread_length, paper.turns);
    let secant = |gauge: f64| 3.0 * gauge * (length + b / 3_f64.sqrt()) / (4.0 * PI * n * n);
    let force = |gauge: f64| gauge * (3.0 * length * length - b * b) / (4.0 * PI * n * n);
    let radii = [0.015, 0.02];
    let bound = radii[0] * width * secant(gauge) + radii[1] * width * secant(other);
    let balance = radii[1] * force(other) - radii[0] * force(gauge);
    let pair = Pair::of(paper).with(|pair| {
        pair.papers[1].gauge = other;
        for i in 0..2 {
            pair.tendons[i].arm = MomentArm::Pulley(radii[i]);
        }
    });
    for method in [Method::Stable, Method::Rk4] {
        for sign in [-1.0, 1.0] {
            let at = |share: f64| pair.clone().with(|pair| pair.torque = balance + sign * share * bound);
            assert_eq!(end_of(&at(0.9999), method, 1e-3, 10.0).angle, 0.0);
            assert!(sign * end_of(&at(1.0001), method, 1e-3, 0.1).angle > 1e-7);
            let stepper = begun(&at(0.9999), method);
            assert!(stepper.steps.mode().actuators.iter().all(|its| its.mode.sliding == Sliding::Stuck));
            assert_close(stepper.sample().torque, -(balance + sign * 0.9999 * bound), 1e-12);
        }
    }
}

/// Poppets that take their time, a spool and a pressure regulator move the air as they do in the rig, step by step, whose own
/// tests hold them against the event-located engine.
#[test]
fn valves_without_a_jump_are_those_of_the_hanging_mass() {
    let ramp = Ramp::new(3e-3, 5e-3).expect("a ramp");
    let seats = Solenoid::new(ValveKind::ThreeWay, 4e-3, 1e-3).expect("a valve").with_ramp(ramp);
    let spool = Solenoid::proportional(Spool::new(40.0, 0.4, 0.05, -0.1).expect("a spool"));
    let regulator = Solenoid::regulating(Regulator::new(0.02, 5e-3, 2e6).expect("a regulator"));
    let times = || vec![0.0, 0.1, 0.25];
    let positions = Command::positions(times(), vec![0.6, -0.4, 0.2]).expect("positions");
    let points = Command::set_points(times(), vec![4e5, 2e5, 2.3e5]).expect("set points");
    for (solenoid, command) in [(seats, pulses(10.0, 0.5)), (spool, positions), (regulator, points)] {
        let (paper, pair) = on_a_line(command.clone());
        let actuation = Some(Actuation { solenoid, command });
        let line = Rig::new(paper.actuator(), actuation.clone(), paper.load.clone()).expect("a rig");
        let sealed = Driven { actuator: pair.papers[1].actuator(), actuation: None };
        let joint = Joint::new(pair.limb, pair.tendons, pair.torque, pair.damping, pair.stops).expect("a joint");
        let rig = JointRig::new([Driven { actuator: paper.actuator(), actuation }, sealed], joint).expect("a rig");
        let begun = rig.start(&pair.initial()).expect("a start");
        for method in [Method::Stable, Method::Rk4] {
            let mut on_line = RigSteps::new(&line, line.start(&paper.initial()).expect("a start"), method);
            let mut stepper = JointSteps::new(&rig, begun, method);
            for step in 1..=400 {
                let time = f64::from(step) * 1e-3;
                on_line.advance_to(time).expect("a step");
                stepper.advance_to(time).expect("a step");
                let (a, b) = (on_line.sample(), stepper.sample().actuators[0]);
                assert_within(b.length, a.length, 1e-7);
                assert_close(b.pressure.0, a.pressure.0, 1e-5);
                assert_within(b.mass_flow, a.mass_flow, 1e-7);
                assert_eq!(b.ports, a.ports);
                let beyond = [a, b].map(|sample| sample.supply_pressure.map_or(0.0, |pressure| pressure.0));
                assert_close(beyond[0], beyond[1], 1e-12);
            }
        }
    }
}

#[test]
fn with_a_slack_antagonist_its_steps_are_those_of_the_hanging_mass() {
    let (paper, pair) = on_a_line(pulses(10.0, 0.5));
    let (line, rig) = (paper.rig(), pair.rig().expect("a rig"));
    for method in [Method::Stable, Method::Rk4] {
        let mut on_line = RigSteps::new(&line, paper.start(), method);
        let mut stepper = JointSteps::new(&rig, rig.start(&pair.initial()).expect("a start"), method);
        for step in 1..=400 {
            let time = f64::from(step) * 1e-3;
            on_line.advance_to(time).expect("a step");
            stepper.advance_to(time).expect("a step");
            let (a, b) = (on_line.sample(), stepper.sample());
            assert_within(b.actuators[0].length, a.length, 1e-8);
            assert_within(b.actuators[0].velocity, a.velocity, 1e-5);
            assert_close(b.actuators[0].pressure.0, a.pressure.0, 1e-6);
            assert_close(b.actuators[0].air_mass, a.air_mass, 1e-6);
            assert_eq!(b.actuators[0].ports, a.ports);
        }
    }
}

/// What is set on the way is the command of a table of the same requests, bit for bit; steps that are set aside and
/// taken up again go on to the same bits.
#[test]
fn what_is_set_is_the_tabled_command_and_steps_are_values() {
    let pair = smooth(1.1e-4);
    let times = vec![0.0, 0.0307, 0.0811];
    let [fill, exhaust] = [Request::Fill, Request::Exhaust];
    let requests = [[fill, exhaust, fill], [exhaust, fill, exhaust]];
    let tabled = pair.clone().with(|pair| {
        for i in 0..2 {
            pair.papers[i].command = Some(Command::table(times.clone(), requests[i].to_vec()).expect("a table"));
        }
    });
    let (mut follows, mut set) = (begun(&tabled, Method::Stable), begun(&pair, Method::Stable));
    for step in 0..1500 {
        let time = f64::from(step) * 1e-4;
        if let Some(row) = times.iter().position(|at| (at - time).abs() < 1e-9) {
            for (valve, requests) in requests.iter().enumerate() {
                set.steps.set(valve, requests[row]).expect("a request");
            }
        }
        for steps in [&mut follows, &mut set] {
            steps.advance_to(time + 1e-4).expect("a step");
        }
        assert_eq!(set.sample(), follows.sample(), "{time}");
    }
    let on = |mut steps: JointSteps| {
        for step in 1500..1700 {
            steps.advance_to(f64::from(step + 1) * 1e-4).expect("a step");
        }
        steps.sample()
    };
    assert_eq!(on(set.clone()), on(set));
}

fn duty(duty: f64) -> RuntimeCommand {
    RuntimeCommand::Pulses { frequency: 25.0, duty, pulse: Request::Fill, rest: Request::Exhaust }
}

/// Pulses that are set are those of the command of the same frequency and duty cycle.
#[test]
fn pulses_are_those_of_the_command() {
    let pair = smooth(0.0).with(|pair| {
        pair.papers[0].command = Some(pulses(25.0, 0.6));
        pair.papers[1].command = Some(pulses(25.0, 0.3));
    });
    let (mut follows, mut set) = (begun(&pair, Method::Stable), begun(&pair, Method::Stable));
    for (valve, its) in [0.6, 0.3].into_iter().enumerate() {
        set.steps.set(valve, duty(its)).expect("pulses");
    }
    for step in 1..=300 {
        let until = f64::from(step) * 1e-3;
        for steps in [&mut follows, &mut set] {
            steps.advance_to(until).expect("a step");
        }
        // The instants of the poppets differ by roundings.
        assert!(difference(follows.state(), set.state()) < 1e-9, "{until}: {:?} {:?}", follows.state(), set.state());
    }
}

/// At rest on an actuator's shortest length, and at steps far too long for the stops, every number stays one.
#[test]
fn it_rests_where_an_actuator_is_at_its_shortest() {
    for width in [0.0, 1e-4] {
        let paper = Paper::sealed().friction(5.0, width).gauge(60.0 * PSI).with(|rig| rig.min_length = Some(0.078));
        let pair = Pair::of(paper).with(|pair| {
            pair.papers[1].gauge = 0.0;
            pair.torque = -0.1;
            pair.damping = 2e-3;
            pair.angle = InitialAngle::At((0.082 - 0.078) / 0.015 + 0.02);
        });
        let end = end_of(&pair, Method::Stable, 1e-3, 20.0);
        assert_within(end.angle, (0.082 - 0.078) / 0.015, 1e-5);
        // A step spans many bounces of the last: it moves the joint by no more than that.
        assert_within(end.angular_velocity * 1e-3, 0.0, 1e-5);
    }
}

#[test]
fn random_joints_near_the_event_located_engine() {
    let cases = (5.0..35.0_f64, 0.1..0.9_f64, 5.0..35.0_f64, 0.1..0.9_f64, 0.0..2e-4_f64, -0.3..0.3_f64, 0.0..0.12_f64);
    let result = runner(60).run(&cases, |(first, duty, second, other, width, angle, distance)| {
        let pair = Pair::of(Paper::driven(pulses(first, duty)).friction(3.0, width)).with(|pair| {
            pair.papers[1].command = Some(pulses(second, other));
            pair.limb.distance = distance;
            pair.damping = 2e-2;
            pair.angle = InitialAngle::At(angle);
            pair.stops = Stops { ends: [Some(-0.5), Some(0.5)], stiffness: 100.0, damping: 0.3 };
        });
        let rig = pair.rig().expect("a rig");
        let start = rig.start(&pair.initial()).expect("a start");
        let exact = JointPlant::new(&rig).and_then(|joint| joint.simulate(&start, 0.5, 1e-10)).expect("a run");
        // Each state's largest error as a part of the range that it covers.
        let states: Vec<[f64; 6]> = exact.samples(1e-3).map(|sample| numbers(sample.state())).collect();
        let range: [f64; 6] = std::array::from_fn(|n| {
            let values = states.iter().map(|state| state[n]);
            let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
            high - low
        });
        let worst = |step: f64| {
            let mut stepper = JointSteps::new(&rig, start, Method::Stable);
            (1..=(0.5 / step).round() as u32).fold([0.0; 6], |worst: [f64; 6], count| {
                stepper.advance_to(f64::from(count) * step).expect("a step");
                let (ours, theirs) = (numbers(stepper.state()), numbers(exact.at(f64::from(count) * step).state()));
                std::array::from_fn(|n| worst[n].max((ours[n] - theirs[n]).abs() / range[n]))
            })
        };
        let (coarse, fine) = (worst(2e-4), worst(2.5e-5));
        // A short pulse moves a pressure by little, of which its edges are more.
        // At 25 µs a free swing of 60 1/s errs by c (ωh)² ωT = 1e-4 of itself (`stable_error`). Against a stop, of
        // √(K/J) = 316 1/s, that is 1.4e-2, but for less than a twentieth of the time; and a velocity errs by its ω over that
        // of the whole swing, five times as much. Steps eight times as long err by 64 times as much, of order 2; where edges and
        // stops are many to a coarse step they have not come to that, but to more than order 1.5.
        for (n, allowed) in [7e-4, 3.5e-3, 2e-3, 7e-4, 2e-3, 7e-4].into_iter().enumerate() {
            prop_assert!(fine[n] < allowed && coarse[n] > 8_f64.powf(1.5) * fine[n], "{n}: {coarse:?} {fine:?}");
        }
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
}

/// The step that an accuracy needs has no larger error, measured again, and a tighter accuracy no longer step.
#[test]
fn a_step_is_chosen_for_an_accuracy() {
    let pair = smooth(1.1e-4);
    let rig = pair.rig().expect("a rig");
    let start = rig.start(&pair.initial()).expect("a start");
    let of = JointPlant::new(&rig).expect("a plant");
    let chosen = |accuracy| {
        let start = of.start(&start);
        plant_step_for_accuracy((of.plant(), &start), &Vec::new, (0.2, 5e-3), Method::Stable, accuracy)
    };
    let run = pair.run(0.2, 1e-11);
    let mut before = f64::INFINITY;
    for accuracy in [1e-2, 1e-3, 1e-4] {
        let chosen = chosen(accuracy).expect("a step");
        assert!(chosen.step <= before && chosen.greatest <= accuracy, "{chosen:?}");
        before = chosen.step;
        let mut steps = JointSteps::new(&rig, start, Method::Stable);
        let angles: Vec<f64> = run.samples(5e-3).map(|sample| sample.angle).collect();
        let range = angles.iter().copied().fold(f64::MIN, f64::max) - angles.iter().copied().fold(f64::MAX, f64::min);
        for (time, _) in SampleTimes::new(0.2, 5e-3).steps(chosen.step) {
            steps.advance_to(time).expect("a step");
            let off = (steps.state().angle - run.at(time).angle).abs();
            assert!(off <= 1.01 * accuracy * range, "{time}: {off:e}");
        }
    }
    let error = chosen(1e-12).expect_err("refused").to_string();
    assert!(error.contains("run.accuracy"), "{error}");
}

#[test]
fn what_cannot_be_stepped_is_refused_and_changes_nothing() {
    let mut stepper = begun(&smooth(0.0), Method::Stable);
    let before = stepper.sample();
    let error = stepper.steps.set(1, duty(1.5)).expect_err("refused").to_string();
    assert!(error.contains("command.duty"), "{error}");
    // The paper's three-way valve holds nothing.
    for valve in 0..2 {
        assert!(stepper.steps.set(valve, Request::Hold).is_err());
    }
    assert!(stepper.steps.set(2, Request::Fill).is_err());
    assert_eq!(stepper.sample(), before);
    stepper.advance_to(0.01).expect("a step");
    let end = stepper.sample();
    let mut alone = begun(&smooth(0.0), Method::Stable);
    alone.advance_to(0.01).expect("a step");
    assert_eq!(end, alone.sample());

    let sealed = Pair::of(Paper::sealed()).with(|pair| pair.torque = -50.0);
    let mut stepper = begun(&sealed, Method::Rk4);
    let before = stepper.sample();
    let error = stepper.advance_to(0.5).expect_err("refused").to_string();
    assert!(
        error.contains("fixed-step engine left the physics") || error.contains("pulled a braid straight"),
        "{error}"
    );
    assert_eq!(stepper.sample(), before);
}

/// Valves so large that a step empties an actuator many times over.
#[test]
fn a_step_takes_no_more_air_than_there_is() {
    for (size, step) in [(12.0, 4e-3), (120.0, 20e-3), (1e4, 20e-3)] {
        let paper = Paper::driven(pulses(20.0, 0.5)).gauge(80.0 * PSI).with(|rig| {
            rig.standard = FlowStandard::Orifice { flow_area: size * 1.8e-5 * 0.3048 * 0.3048 };
        });
        let pair = Pair::of(paper).with(|pair| {
            pair.papers[1].command = Some(pulses(13.0, 0.4));
            pair.damping = 5.0;
        });
        let state = end_of(&pair, Method::Stable, step, 50.0 * step);
        assert!(state.air_mass.iter().all(|mass| *mass > 1e-6), "{size}: {state:?}");
    }
}
