//! A load on an elastic tendon with a controller in the loop, by both engines: what is seen, the run of the requests, the
//! order at which fixed steps come to events located, and a tension that is kept, in closed form.

use crate::common::tendon::{REST, STIFFNESS, on_tendon};
use crate::common::{ATMOSPHERE, PSI, Paper, assert_close, assert_within};
use mckibben::control::{
    Between, Controller, Output, Pid, Quantity, Regulator, Relay, Sampling, Sensors, SetPoint, Tracker,
};
use mckibben::plant::{RigPlant, RigTrajectory, TimeStepping};
use mckibben::simulation::{Decision, Method, Rig, Sample, simulate};
use mckibben::valve::{FlowStandard, ValveKind};
use std::f64::consts::PI;
use std::fmt::Debug;

const DURATION: f64 = 0.3;

/// With dry friction and without, on a valve that can hold.
fn paper(coulomb_width: f64) -> Paper {
    let paper = Paper::pwm(50.0, 0.5).gauge(30.0 * PSI).friction(60.0, coulomb_width);
    paper.with(|rig| {
        rig.kind = ValveKind::FillHoldExhaust;
        rig.standard = FlowStandard::Orifice { flow_area: 4e-7 };
    })
}

fn tracker(quantity: Quantity, value: f64, regulator: Regulator) -> Tracker {
    Tracker::new(quantity, SetPoint::constant(quantity, value).expect("a set point"), regulator).expect("a tracker")
}

/// Keeps the length at 88 mm.
fn length() -> Tracker {
    let pid = Pid::new(Quantity::Length, 0.01, Output::FillHoldExhaust).and_then(|pid| pid.with_integral(0.2));
    tracker(Quantity::Length, 0.088, Regulator::Pid(pid.expect("a controller")))
}

fn set_up(rate: f64, delay: usize) -> (Sampling, Sensors) {
    (Sampling::new(rate, delay).expect("a rate"), Sensors::perfect())
}

fn located<C>(rig: &Rig, paper: &Paper, controller: &C, set_up: (Sampling, Sensors)) -> RigTrajectory
where
    C: Controller<Memory: Send + Sync> + Clone + Debug + Send + Sync + 'static,
{
    let of = RigPlant::new(rig);
    let driver = of.driver(controller.clone(), set_up).expect("a driver");
    of.record(&paper.start(), (DURATION, 1e-9), Some(driver), &mut |_| Ok(())).unwrap_or_else(|error| panic!("{error}"))
}

fn stepped<C>((rig, paper): (&Rig, &Paper), controller: C, set_up: (Sampling, Sensors), steps: u32) -> RigTrajectory
where
    C: Controller<Memory: Send + Sync> + Clone + Debug + Send + Sync + 'static,
{
    let of = RigPlant::new(rig);
    let driver = of.driver(controller, set_up).expect("a driver");
    let span = (DURATION, TimeStepping::Fixed { method: Method::Stable, step: DURATION / f64::from(steps) });
    of.record(&paper.start(), span, Some(driver), &mut |_| Ok(())).unwrap_or_else(|error| panic!("{error}"))
}

/// Asserts that a decision saw a sample's actuator, and the tension of its tendon.
fn assert_seen(decision: &Decision, truth: &Sample) {
    let seen = &decision.seen;
    assert_close(seen.length, truth.length, 1e-12);
    assert_within(seen.velocity, truth.velocity, 1e-9);
    assert_close(seen.tension, STIFFNESS * (truth.load_distance - REST - truth.length), 1e-7);
    assert!((truth.load_distance - REST - truth.length) > 1e-3, "the tendon gives");
}

#[test]
fn the_sensors_are_at_the_actuator() {
    let paper = paper(1e-4);
    let rig = on_tendon(&paper, STIFFNESS);
    let trajectory = located(&rig, &paper, &length(), set_up(50.0, 0));
    let decisions = trajectory.decisions();
    assert_eq!(decisions.len(), 16);
    for decision in &decisions {
        assert_seen(decision, &trajectory.at(decision.seen.time));
    }
    let stepped = stepped((&rig, &paper), length(), set_up(50.0, 0), 300);
    assert_eq!(stepped.decisions().len(), 16);
    for decision in &stepped.decisions() {
        assert_seen(decision, &stepped.at(decision.seen.time));
    }
}

#[test]
fn the_requested_command_reproduces_the_run_without_the_controller() {
    let paper = paper(1e-4);
    let rig = on_tendon(&paper, STIFFNESS);
    let closed = located(&rig, &paper, &length(), set_up(40.0, 1));
    assert!(closed.rig().tendon().is_some());
    let open = simulate(closed.rig(), paper.start(), DURATION, 1e-9).expect("a run");
    for sample in open.samples(0.005) {
        assert_close(closed.at(sample.time).length, sample.length, 1e-6);
        assert_close(closed.at(sample.time).load_distance, sample.load_distance, 1e-6);
    }
    // At fixed steps which the samples divide no further, bit for bit.
    let closed = stepped((&rig, &paper), length(), set_up(50.0, 0), 300);
    let span = TimeStepping::Fixed { method: Method::Stable, step: DURATION / 300.0 };
    let open = RigPlant::new(closed.rig()).simulate(&paper.start(), DURATION, span).expect("a run");
    assert_eq!(open.at(DURATION), closed.at(DURATION));
}

#[test]
fn fixed_steps_come_to_the_located_run() {
    for (rate, delay, width) in [(50.0, 0, 0.0), (33.0, 2, 1e-4)] {
        let paper = paper(width);
        let rig = on_tendon(&paper, STIFFNESS);
        let exact = located(&rig, &paper, &length(), set_up(rate, delay));
        let errors = [600, 2400].map(|steps| {
            let run = stepped((&rig, &paper), length(), set_up(rate, delay), steps);
            assert_eq!(run.decisions().len(), exact.decisions().len());
            let (last, exact) = (run.at(DURATION), exact.at(DURATION));
            (last.length / exact.length - 1.0).abs().max((last.load_distance / exact.load_distance - 1.0).abs())
        });
        // Of order 1, with viscous friction.
        assert!(errors[1] < 3e-4 && errors[1] < 0.4 * errors[0], "{errors:?}");
    }
}

/// Between held ends a relay keeps the tension within its band, by (3) at the length that the tendon leaves.
#[test]
fn a_tension_is_kept_by_what_the_tendon_leaves_of_the_length() {
    let band = 2.0;
    let relay = Relay::new(Quantity::Force, band, 0.0, Between::Hold).expect("a relay");
    let paper = paper(0.0).isometric(0.09).with(|rig| rig.standard = FlowStandard::Orifice { flow_area: 3e-8 });
    let rig = on_tendon(&paper, STIFFNESS);
    let start = simulate(&rig, paper.start(), 1e-3, 1e-9).expect("a run").at(0.0);
    let law = tracker(Quantity::Force, start.tension + 12.0, Regulator::Relay(relay));
    let run = located(&rig, &paper, &law, set_up(500.0, 0)).at(DURATION);
    let by_steps = stepped((&rig, &paper), law, set_up(500.0, 0), 600).at(DURATION);
    for last in [run, by_steps] {
        assert_within(last.tension, start.tension + 12.0, band);
        assert_eq!(last.load_distance, start.load_distance);
        assert_close(last.length, last.load_distance - REST - last.tension / STIFFNESS, 1e-9);
        let (b, n) = (paper.thread_length, paper.turns);
        let gauge = last.pressure.0 - ATMOSPHERE;
        assert_close(last.tension, gauge * (3.0 * last.length * last.length - b * b) / (4.0 * PI * n * n), 1e-6);
    }
}
