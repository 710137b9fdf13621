//! Both engines with a controller in the loop.

use crate::common;
use common::{PSI, Paper, assert_close, assert_within};
use mckibben::control::{
    Between, Controller, Drive, Measurement, Output, Pid, Quantity, Regulator, Relay, Sampling, Sensors, SetPoint,
    Tracker,
};
use mckibben::plant::{RigPlant, RigTrajectory, TimeStepping};
use mckibben::simulation::{EventKind, Method, Rig, simulate};
use mckibben::valve::{Command, FlowStandard, Request, ValveKind};
use mckibben::{Error, Over};
use std::fmt::Debug;

/// A constant command.
#[derive(Clone, Debug)]
struct Fixed(Drive);

impl Controller for Fixed {
    type Memory = ();

    fn begin(&self) {}

    fn decide(&self, _seen: &Measurement, (): &mut ()) -> Drive {
        self.0
    }
}

fn fill_hold_exhaust() -> Paper {
    Paper::pwm(50.0, 0.5).gauge(20.0 * PSI).with(|rig| rig.kind = ValveKind::FillHoldExhaust)
}

fn pressure_pid(target: f64) -> Tracker {
    let pid = Pid::new(Quantity::Pressure, 60.0 * PSI, Output::FillHoldExhaust).and_then(|pid| pid.with_integral(0.2));
    let set_point = SetPoint::constant(Quantity::Pressure, target).expect("a set point");
    Tracker::new(Quantity::Pressure, set_point, Regulator::Pid(pid.expect("a controller"))).expect("a tracker")
}

fn sampling(rate: f64, delay: usize) -> Sampling {
    Sampling::new(rate, delay).expect("a rate")
}

fn run<C>(paper: &Paper, duration: f64, controller: &C, sampling: Sampling) -> RigTrajectory
where
    C: Controller<Memory: Send + Sync> + Clone + Debug + Send + Sync + 'static,
{
    let of = RigPlant::new(&paper.rig());
    let driver = of.driver(controller.clone(), (sampling, Sensors::perfect())).expect("a driver");
    of.record(&paper.start(), (duration, 1e-9), Some(driver), &mut |_| Ok(())).expect("a run")
}

#[test]
fn a_constant_duty_is_the_open_loop_with_seats_at_the_same_instants() {
    let paper = Paper::pwm(25.0, 0.4).gauge(20.0 * PSI);
    let pulses = Fixed(Drive::Pulses { duty: 0.4, pulse: Request::Fill, rest: Request::Exhaust });
    let closed = run(&paper, 0.5, &pulses, sampling(25.0, 0));
    let open = paper.run(0.5, 1e-9);
    let seats = |events: &[mckibben::plant::RigEvent]| -> Vec<f64> {
        events.iter().filter(|event| event.kind == EventKind::Valve).map(|event| event.time).collect()
    };
    assert_eq!(seats(closed.events()), seats(open.events()));
    // The poppet follows the coil: opens 4 ms after k/25 s, shuts 1 ms after (k + 0.4)/25 s.
    for (index, time) in seats(closed.events()).into_iter().enumerate() {
        let period = (index / 2) as f64;
        assert_within(time, if index % 2 == 0 { period / 25.0 + 4e-3 } else { (period + 0.4) / 25.0 + 1e-3 }, 1e-15);
    }
    for sample in open.samples(0.01) {
        assert_close(closed.at(sample.time).length, sample.length, 1e-7);
        assert_close(closed.at(sample.time).pressure.0, sample.pressure.0, 1e-7);
    }
}

#[test]
fn samples_are_exact_instants_and_effects_come_after_the_delay() {
    for (rate, delay) in [(100.0, 0), (30.0, 1), (100.0, 3)] {
        let controlled = run(&fill_hold_exhaust(), 0.2, &Fixed(Drive::Steady(Request::Fill)), sampling(rate, delay));
        let times: Vec<f64> = controlled.decisions().iter().map(|decision| decision.seen.time).collect();
        let expected: Vec<f64> = (0..=(0.2 * rate) as u32).map(|k| f64::from(k) / rate).collect();
        assert_eq!(times, expected);
        let events = controlled.events();
        let opened = events.iter().find(|event| event.kind == EventKind::Valve).expect("the valve opens");
        assert_within(opened.time, delay as f64 / rate + 4e-3, 1e-15);
    }
}

#[test]
fn what_is_seen_is_the_trajectory_at_the_instant() {
    let trajectory = run(&fill_hold_exhaust(), 0.4, &pressure_pid(40.0 * PSI), sampling(50.0, 1));
    let atmosphere = trajectory.rig().actuator().air().atmosphere();
    for decision in &trajectory.decisions() {
        let truth = trajectory.at(decision.seen.time);
        assert_close(decision.seen.length, truth.length, 1e-12);
        assert_close(decision.seen.pressure.0, truth.pressure.gauge(atmosphere).0, 1e-9);
        assert_eq!(decision.aim, Some((Quantity::Pressure, 40.0 * PSI)));
    }
}

#[test]
fn the_requested_command_reproduces_the_run_without_the_controller() {
    let paper = fill_hold_exhaust();
    let sampling = sampling(40.0, 1).with_pulse_frequency(70.0).expect("a frequency");
    let closed = run(&paper, 0.6, &pressure_pid(45.0 * PSI), sampling);
    let rig = closed.rig().clone();
    let Some(Command::Table { time, .. }) = rig.actuation().map(|drive| &drive.command) else { panic!("a table") };
    assert!(time.len() > 20 && time.windows(2).all(|pair| pair[0] < pair[1]), "{time:?}");
    let open = simulate(&rig, paper.start(), 0.6, 1e-9).expect("a run");
    for sample in open.samples(0.005) {
        assert_close(closed.at(sample.time).length, sample.length, 1e-6);
        assert_close(closed.at(sample.time).air_mass, sample.air_mass, 1e-6);
    }
}

#[test]
fn integral_action_brings_the_pressure_to_its_set_point() {
    let paper = fill_hold_exhaust().with(|rig| rig.delays = (0.0, 0.0));
    let controlled = run(&paper, 4.0, &pressure_pid(45.0 * PSI), sampling(100.0, 0));
    let decisions = controlled.decisions();
    let late = decisions.iter().filter(|decision| decision.seen.time > 3.0);
    for decision in late {
        assert_close(decision.seen.pressure.0, 45.0 * PSI, 5e-3);
    }
}

#[test]
fn a_relay_rests_within_its_dead_band() {
    // A small valve: at full flow a sample and the closing delay move less than the band.
    let paper =
        fill_hold_exhaust().isometric(0.09).with(|rig| rig.standard = FlowStandard::Orifice { flow_area: 8e-8 });
    let band = 3.0 * PSI;
    let relay = Relay::new(Quantity::Pressure, band, 0.0, Between::Hold).expect("a relay");
    let set_point = SetPoint::constant(Quantity::Pressure, 45.0 * PSI).expect("a set point");
    let tracker = Tracker::new(Quantity::Pressure, set_point, Regulator::Relay(relay)).expect("a tracker");
    let controlled = run(&paper, 3.0, &tracker, sampling(500.0, 0));
    let decisions = controlled.decisions();
    let last = decisions.last().expect("a decision");
    assert_eq!(last.drive, Drive::Steady(Request::Hold));
    assert_within(last.seen.pressure.0, 45.0 * PSI, band);
    // At rest nothing is requested any more: with the valve shut the air stays.
    let early = controlled.at(2.5);
    assert_close(controlled.at(3.0).air_mass, early.air_mass, 1e-13);
}

/// The fixed-step engine with a controller, in so many steps.
fn stepped<C>(paper: &Paper, controller: &C, sampling: Sampling, (duration, steps): (f64, u32)) -> RigTrajectory
where
    C: Controller<Memory: Send + Sync> + Clone + Debug + Send + Sync + 'static,
{
    let of = RigPlant::new(&paper.rig());
    let driver = of.driver(controller.clone(), (sampling, Sensors::perfect())).expect("a driver");
    let span = (duration, TimeStepping::Fixed { method: Method::Rk4, step: duration / f64::from(steps) });
    of.record(&paper.start(), span, Some(driver), &mut |_| Ok(())).expect("a run")
}

#[test]
fn the_fixed_step_engine_comes_to_the_same_run() {
    let (paper, controller) = (fill_hold_exhaust(), pressure_pid(45.0 * PSI));
    // Steps that do and do not fall on the samples.
    for (rate, delay) in [(50.0, 0), (33.0, 2)] {
        let located = run(&paper, 0.5, &controller, sampling(rate, delay));
        let errors = [1_000, 4_000].map(|steps| {
            let run = stepped(&paper, &controller, sampling(rate, delay), (0.5, steps));
            let (last, exact) = (run.at(0.5), located.at(0.5));
            let seen = run.decisions().last().expect("a decision").seen;
            assert_eq!(seen.time, located.decisions().last().expect("a decision").seen.time);
            (last.length / exact.length - 1.0).abs().max((last.pressure.0 / exact.pressure.0 - 1.0).abs())
        });
        assert!(errors[1] < 1e-4 && errors[1] < (0.5 * errors[0]).max(1e-6), "{errors:?}");
    }
}

#[test]
fn a_fixed_step_run_is_bit_identical_to_the_open_loop_with_its_command() {
    let (paper, controller) = (fill_hold_exhaust(), pressure_pid(45.0 * PSI));
    let closed = stepped(&paper, &controller, sampling(50.0, 0), (0.5, 500));
    let again = stepped(&paper, &controller, sampling(50.0, 0), (0.5, 500));
    assert_eq!(closed.at(0.5), again.at(0.5));
    let span = TimeStepping::Fixed { method: Method::Rk4, step: 0.5 / 500.0 };
    let open = RigPlant::new(closed.rig()).simulate(&paper.start(), 0.5, span).expect("a run");
    for index in 0..=100 {
        let time = 5e-3 * f64::from(index);
        assert_eq!(open.at(time), closed.at(time));
    }
}

#[test]
fn dual_numbers_carry_the_derivative_by_a_set_point_through_the_loop() {
    type D = crate::common::Seeded;
    let paper = fill_hold_exhaust();
    let (rig, start, target) = (paper.rig(), paper.start(), 45.0 * PSI);
    let wide = rig.map(|_, value| D::of(value));
    let begin = wide.begin(&paper.initial().map(|_, value| D::of(value))).expect("a start");
    let tracker = pressure_pid(target)
        .map(|row, value| if row.key == "controller.gauge_pressure" { D::variable(value, 0) } else { D::of(value) });
    let timing = sampling(50.0, 1).map(|_, value| D::of(value));
    let of = RigPlant::new(&wide);
    let driver = of.driver(tracker, (timing, Sensors::perfect())).expect("a driver");
    let controlled = of.record(&begin, (D::of(0.3), 1e-11), Some(driver), &mut |_| Ok(())).expect("a run");
    let slope = controlled.at(D::of(0.3)).pressure.0.slope[0];
    let at = |target: f64| {
        let of = RigPlant::new(&rig);
        let driver = of.driver(pressure_pid(target), (sampling(50.0, 1), Sensors::perfect())).expect("a driver");
        let run = of.record(&start, (0.3, 1e-11), Some(driver), &mut |_| Ok(())).expect("a run");
        run.at(0.3).pressure.0
    };
    let step = 20.0;
    let difference = common::slope(step, |by| at(target + by));
    assert!(slope.abs() > 0.1, "{slope}");
    assert_close(slope, difference, 1e-4);
}

#[test]
fn what_cannot_be_controlled_is_refused() {
    let refused = |rig: &Rig, paper: &Paper, requested: Request, part: &str| {
        let loop_of = (sampling(50.0, 0), Sensors::perfect());
        let controller = Fixed(Drive::Steady(requested));
        let of = RigPlant::new(rig);
        let run = of
            .driver(controller.clone(), loop_of)
            .and_then(|driver| of.record(&paper.start(), (0.1, 1e-8), Some(driver), &mut |_| Ok(())));
        let error = run.expect_err("refused");
        assert!(matches!(error, Error::Misuse { .. }) && error.to_string().contains(part), "{error}");
    };
    let sealed = Paper::sealed();
    refused(&sealed.rig(), &sealed, Request::Fill, "no valve");
    let three_way = Paper::pwm(25.0, 0.5);
    refused(&three_way.rig(), &three_way, Request::Hold, "three-way valve cannot hold");
}
