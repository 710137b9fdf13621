//! A joint with a controller in the loop.

use crate::common::{GRAVITY, PSI, Paper, assert_close, assert_within, slope};
use mckibben::air::Process;
use mckibben::control::{
    AirMass, Between, Controller, Drive, FeedForward, Held, JointAim, JointController, JointMeasurement, JointSensors,
    JointTracker, Measurement, Output, Pid, Quantity, Regulator, Relay, Sampling, Sensor, SetPoint,
};
use mckibben::load::{Joint, Limb, MomentArm, Stops, Tendon};
use mckibben::plant::{JointEvent, JointPlant, JointTrajectory, TimeStepping};
use mckibben::simulation::{Actuation, Driven, EventKind, InitialAngle, JointInitial, JointRig, JointState, Method};
use mckibben::valve::{Command, FlowStandard, Ramp, Request, Solenoid, ValveKind};
use mckibben::{Error, GaugePressure};
use std::fmt::Debug;

const RADIUS: f64 = 0.015;
const REST: f64 = 0.082;
const LIMB: Limb = Limb { mass: 0.3, distance: 0.05, inertia: 1e-3, gravity: GRAVITY, hanging_angle: 0.0 };

/// Actuators without Coulomb friction and with isothermal air behind a small valve that can hold.
fn paper() -> Paper {
    Paper::driven(Command::Table { time: Vec::new(), request: Vec::new() })
        .gauge(30.0 * PSI)
        .friction(3.5, 0.0)
        .process(Process::Isothermal)
        .with(|rig| {
            rig.kind = ValveKind::FillHoldExhaust;
            rig.delays = (1e-3, 1e-3);
            rig.standard = FlowStandard::Orifice { flow_area: 4e-8 };
        })
}

fn joint() -> Joint {
    let pulley = Tendon { arm: MomentArm::Pulley(RADIUS), rest_length: REST };
    let stops = Stops { ends: [None; 2], stiffness: 500.0, damping: 1.0 };
    Joint::new(LIMB, [pulley; 2], 0.0, 0.03, stops).expect("a joint")
}

fn rig(papers: &[Paper; 2]) -> JointRig {
    ramped(papers, [0.0; 2])
}

/// On poppets that take times in s to open and to close.
fn ramped(papers: &[Paper; 2], [rise, fall]: [f64; 2]) -> JointRig {
    let ramp = Ramp::new(rise, fall).expect("a ramp");
    let driven = papers.each_ref().map(|paper| Driven {
        actuator: paper.actuator(),
        actuation: paper.command.clone().map(|command| Actuation {
            solenoid: Solenoid::new(paper.kind, paper.delays.0, paper.delays.1).expect("a solenoid").with_ramp(ramp),
            command,
        }),
    });
    JointRig::new(driven, joint()).expect("a rig")
}

fn initial(papers: &[Paper; 2]) -> JointInitial {
    JointInitial {
        gauge_pressure: papers.each_ref().map(|paper| GaugePressure(paper.gauge)),
        temperature: papers.each_ref().map(|paper| paper.temperature),
        angle: InitialAngle::Equilibrium,
        angular_velocity: 0.0,
    }
}

/// A controller that a driver can have.
trait Law: JointController<Memory: Send + Sync> + Clone + Debug + Send + Sync + 'static {}

impl<C: JointController<Memory: Send + Sync> + Clone + Debug + Send + Sync + 'static> Law for C {}

/// The open loop.
fn simulate(rig: &JointRig, start: &JointState, duration: f64, tolerance: f64) -> JointTrajectory {
    JointPlant::new(rig).and_then(|joint| joint.simulate(start, duration, tolerance)).expect("a run")
}

/// The closed loop.
fn simulate_controlled(
    rig: &JointRig,
    start: &JointState,
    span: (f64, impl Into<TimeStepping>),
    controller: &impl Law,
    set_up: (Sampling, JointSensors),
) -> Result<JointTrajectory, Error> {
    let joint = JointPlant::new(rig)?;
    let driver = joint.driver(controller.clone(), set_up)?;
    joint.record(start, span, Some(driver), &mut |_| Ok(()))
}

fn run(duration: f64, controller: &impl Law, sampling: Sampling) -> JointTrajectory {
    run_with(paper(), duration, controller, sampling)
}

fn run_with(paper: Paper, duration: f64, controller: &impl Law, sampling: Sampling) -> JointTrajectory {
    let papers = [paper.clone(), paper];
    let rig = rig(&papers);
    let start = rig.start(&initial(&papers)).expect("a start");
    let set_up = (sampling, JointSensors::perfect());
    simulate_controlled(&rig, &start, (duration, 1e-9), controller, set_up).expect("a run")
}

fn sampling(rate: f64, delay: usize) -> Sampling {
    Sampling::new(rate, delay).expect("a rate")
}

fn seats(events: &[JointEvent]) -> Vec<(f64, Option<usize>)> {
    let seats = events.iter().filter(|event| event.kind.kind == EventKind::Valve);
    seats.map(|event| (event.time, event.kind.actuator)).collect()
}

/// Requests what a table requests.
#[derive(Clone, Debug)]
struct Replay(Vec<(f64, Request)>);

impl Controller for Replay {
    type Memory = ();

    fn begin(&self) {}

    fn decide(&self, seen: &Measurement, (): &mut ()) -> Drive {
        let begun = self.0.iter().rfind(|(time, _)| *time <= seen.time + 1e-9);
        Drive::Steady(begun.map_or(Request::Hold, |(_, request)| *request))
    }
}

#[test]
fn a_replayed_timetable_is_the_open_loop() {
    let tables = [
        vec![(0.05, Request::Fill), (0.12, Request::Hold), (0.31, Request::Exhaust), (0.4, Request::Hold)],
        vec![(0.02, Request::Exhaust), (0.09, Request::Hold), (0.31, Request::Fill), (0.45, Request::Hold)],
    ];
    let papers = tables.each_ref().map(|table| {
        let (time, request) = table.iter().copied().unzip();
        paper().with(|paper| paper.command = Some(Command::table(time, request).expect("a table")))
    });
    let open_rig = rig(&papers);
    let start = open_rig.start(&initial(&papers)).expect("a start");
    let open = simulate(&open_rig, &start, 0.7, 1e-10);
    let sensors = JointSensors::perfect();
    let closed =
        simulate_controlled(&open_rig, &start, (0.7, 1e-10), &tables.map(Replay), (sampling(100.0, 0), sensors))
            .expect("a run");
    let (a, b) = (seats(open.events()), seats(closed.events()));
    assert_eq!((a.len(), b.len()), (8, 8));
    for ((time, actuator), (other, of)) in a.into_iter().zip(b) {
        assert_eq!(actuator, of);
        assert_within(other, time, 1e-15);
    }
    for sample in open.samples(0.01) {
        let other = closed.at(sample.time);
        assert_within(other.angle, sample.angle, 1e-8);
        for i in 0..2 {
            assert_close(other.actuators[i].pressure.0, sample.actuators[i].pressure.0, 1e-8);
            assert_close(other.actuators[i].air_mass, sample.actuators[i].air_mass, 1e-8);
        }
    }
}

#[test]
fn samples_are_exact_instants_and_show_the_trajectory() {
    let regulator = Regulator::Pid(Pid::new(Quantity::Angle, 0.4, Output::FillHoldExhaust).expect("a controller"));
    let angle = SetPoint::constant(Quantity::Angle, 0.3).expect("a set point");
    let trajectory = run(0.5, &JointTracker { angle, regulator }, sampling(70.0, 1));
    let decisions = trajectory.decisions();
    let times: Vec<f64> = decisions.iter().map(|decision| decision.seen.time).collect();
    assert_eq!(times, (0..=35).map(|k| f64::from(k) / 70.0).collect::<Vec<_>>());
    for decision in &decisions {
        let truth = trajectory.at(decision.seen.time);
        assert_within(decision.seen.angle, truth.angle, 1e-12);
        for i in 0..2 {
            let atmosphere = trajectory.rig().driven()[i].actuator.air().atmosphere();
            let seen = &decision.seen.actuators[i];
            assert_close(seen.pressure.0, truth.actuators[i].pressure.gauge(atmosphere).0, 1e-9);
            assert_close(seen.air_mass, truth.actuators[i].air_mass, 1e-12);
        }
        assert_eq!(decision.drive[1], decision.drive[0].mirrored());
        assert_eq!(decision.aim, [Some((Quantity::Angle, 0.3)), None]);
    }
    // Nothing is requested before the second sample: the first poppet moves an opening delay later.
    let first = seats(trajectory.events())[0].0;
    assert_within(first, 1.0 / 70.0 + 1e-3, 1e-15);
    // The angle comes from where it was to where it is wanted.
    assert!(trajectory.at(0.5).angle > 0.2, "{}", trajectory.at(0.5).angle);
}

#[test]
fn the_requested_commands_reproduce_the_run_without_the_controller() {
    let regulator = Regulator::Pid(Pid::new(Quantity::Angle, 0.4, Output::FillHoldExhaust).expect("a controller"));
    let angle = SetPoint::constant(Quantity::Angle, 0.25).expect("a set point");
    let closed = run(0.6, &JointTracker { angle, regulator }, sampling(50.0, 1));
    let papers = [paper(), paper()];
    let start = closed.rig().start(&initial(&papers)).expect("a start");
    let open = simulate(closed.rig(), &start, 0.6, 1e-9);
    for sample in open.samples(0.01) {
        assert_within(closed.at(sample.time).angle, sample.angle, 1e-6);
    }
}

/// So many steps of RK4 in 0.4 s.
fn fixed(steps: u32) -> (f64, TimeStepping) {
    (0.4, TimeStepping::Fixed { method: Method::Rk4, step: 0.4 / f64::from(steps) })
}

/// At fixed steps, which do not fall on the samples.
fn stepped(controller: &impl Law, sampling: Sampling, steps: u32) -> JointTrajectory {
    let papers = [paper(), paper()];
    let rig = rig(&papers);
    let start = rig.start(&initial(&papers)).expect("a start");
    let with = (sampling, JointSensors::perfect());
    simulate_controlled(&rig, &start, fixed(steps), controller, with).expect("a run")
}

fn swing() -> JointTracker {
    let regulator = Regulator::Pid(Pid::new(Quantity::Angle, 0.4, Output::FillHoldExhaust).expect("a controller"));
    JointTracker { angle: SetPoint::constant(Quantity::Angle, 0.25).expect("a set point"), regulator }
}

#[test]
fn fixed_steps_come_to_the_same_run() {
    for (rate, delay) in [(50.0, 0), (33.0, 2)] {
        let located = run(0.4, &swing(), sampling(rate, delay));
        let errors = [250, 1_000].map(|steps| {
            let run = stepped(&swing(), sampling(rate, delay), steps);
            assert_eq!(run.decisions().len(), located.decisions().len());
            let (last, exact) = (run.at(0.4), located.at(0.4));
            let pressure = |i: usize| (last.actuators[i].pressure.0 / exact.actuators[i].pressure.0 - 1.0).abs();
            (last.angle - exact.angle).abs().max(pressure(0)).max(pressure(1))
        });
        assert!(errors[1] < 1e-4 && errors[1] < (0.5 * errors[0]).max(1e-6), "{errors:?}");
    }
}

/// Slow poppets close the loop by both engines, to the same run and to that of the requested commands.
#[test]
fn slow_seats_are_controlled_by_both_engines() {
    let papers = [paper(), paper()];
    let rig = ramped(&papers, [6e-3, 9e-3]);
    let start = rig.start(&initial(&papers)).expect("a start");
    let (law, with) = (swing(), (sampling(33.0, 1), JointSensors::perfect()));
    let closed = simulate_controlled(&rig, &start, (0.4, 1e-10), &law, with).expect("a run");
    let open = simulate(closed.rig(), &start, 0.4, 1e-10);
    assert_within(closed.at(0.4).angle, open.at(0.4).angle, 1e-7);
    let errors = [250, 1_000].map(|steps| {
        let run = simulate_controlled(&rig, &start, fixed(steps), &law, with).expect("a run");
        (run.at(0.4).angle - open.at(0.4).angle).abs()
    });
    assert!(errors[1] < 1e-5 && errors[1] < (0.5 * errors[0]).max(1e-7), "{errors:?}");
}

#[test]
fn a_run_at_fixed_steps_is_bit_identical_to_the_open_loop_with_its_commands() {
    let closed = stepped(&swing(), sampling(50.0, 0), 400);
    let papers = [paper(), paper()];
    let start = closed.rig().start(&initial(&papers)).expect("a start");
    let (duration, how) = fixed(400);
    let open = JointPlant::new(closed.rig()).expect("a plant").simulate(&start, duration, how).expect("a run");
    for index in 0..=100 {
        let time = 4e-3 * f64::from(index);
        assert_eq!(open.at(time), closed.at(time));
    }
}

/// Torque of one actuator about the joint at an angle, with its air sealed at a temperature: (3) and the gas law.
fn torque_of(actuator: usize, mass: f64, angle: f64) -> f64 {
    let paper = paper();
    let sign = [-1.0, 1.0][actuator];
    let (b, n) = (paper.thread_length, paper.turns);
    let length: f64 = REST + sign * RADIUS * angle;
    let per_turns = 1.0 / (4.0 * std::f64::consts::PI * n * n);
    let volume = length * (b * b - length * length) * per_turns + paper.external_volume;
    let gauge = mass * paper.gas_constant * 293.15 / volume - 101_325.0;
    -sign * RADIUS * gauge * (3.0 * length * length - b * b) * per_turns
}

#[test]
fn two_masses_of_air_set_angle_and_stiffness() {
    for (angle, stiffness) in [(0.2, 0.8), (0.2, 1.2), (-0.25, 1.0)] {
        let regulator = Regulator::Relay(Relay::new(Quantity::AirMass, 2e-8, 0.0, Between::Hold).expect("a relay"));
        let rig = rig(&[paper(), paper()]);
        let actuators = rig.driven().each_ref().map(|driven| driven.actuator.clone());
        let set_points = [
            SetPoint::constant(Quantity::Angle, angle).expect("an angle"),
            SetPoint::constant(Quantity::Stiffness, stiffness).expect("a stiffness"),
        ];
        let aim = JointAim::new(actuators, joint(), set_points, GaugePressure(95.0 * PSI)).expect("within reach");
        let masses = aim.masses(0.0, 293.15);
        // The masses are those at which the torques balance, and the slope of the torque is the stiffness.
        let torque = |angle: f64| torque_of(0, masses[0], angle) + torque_of(1, masses[1], angle);
        let weight = LIMB.mass * LIMB.gravity * LIMB.distance;
        assert_within(torque(angle), weight * angle.sin(), 1e-10);
        assert_close(-slope(1e-4, |step| torque(angle + step)), stiffness, 1e-6);
        // The closed loop comes to rest there.
        let law = AirMass::new(aim, 293.15, regulator).expect("a controller");
        // A valve so small that a sample lets in less than the dead band.
        let fine = paper().with(|paper| {
            paper.delays = (0.0, 0.0);
            paper.standard = FlowStandard::Orifice { flow_area: 1e-8 };
        });
        let trajectory = run_with(fine, 6.0, &law, sampling(2000.0, 0));
        let decisions = trajectory.decisions();
        let last = trajectory.at(6.0);
        let seen = &decisions.last().expect("a decision").seen;
        for i in 0..2 {
            assert_within(seen.actuators[i].air_mass, masses[i], 2e-8);
        }
        // What the dead bands leave, over the whole slope of the torque.
        let whole = stiffness + weight * angle.cos();
        let leaves: f64 = (0..2).map(|i| 2e-8 * slope(1e-8, |more| torque_of(i, masses[i] + more, angle)).abs()).sum();
        assert_within(last.angle, angle, 1.05 * leaves / whole);
        assert!(leaves / whole < 0.01, "{}", leaves / whole);
        assert_within(last.angular_velocity, 0.0, 1e-4);
        let pressure = last.actuators.map(|sample| sample.pressure);
        assert_close(rig.stiffness(last.angle, pressure, Held::AirMasses), stiffness, 0.01);
    }
}

#[test]
fn a_regulator_of_the_pressures_holds_the_angle_too() {
    let rig = rig(&[paper(), paper()]);
    let actuators = rig.driven().each_ref().map(|driven| driven.actuator.clone());
    let set_points = [
        SetPoint::constant(Quantity::Angle, 0.2).expect("an angle"),
        SetPoint::constant(Quantity::Stiffness, 1.0).expect("a stiffness"),
    ];
    let aim = JointAim::new(actuators, joint(), set_points, GaugePressure(95.0 * PSI)).expect("within reach");
    let regulator = Regulator::Relay(Relay::new(Quantity::Pressure, 1.0 * PSI, 0.0, Between::Hold).expect("a relay"));
    let last = run(4.0, &FeedForward { aim, regulator }, sampling(500.0, 0)).at(4.0);
    let pressure = last.actuators.map(|sample| sample.pressure);
    assert_within(last.angle, 0.2, 0.03);
    assert_close(rig.stiffness(last.angle, pressure, Held::Pressures), 1.0, 0.03);
}

#[test]
fn a_relay_keeps_the_angle_in_its_dead_band() {
    let band = 0.03;
    let regulator = Regulator::Relay(Relay::new(Quantity::Angle, band, 0.0, Between::Hold).expect("a relay"));
    let angle = SetPoint::steps(Quantity::Angle, vec![0.0, 2.0], vec![0.25, -0.1]).expect("a set point");
    let trajectory = run(4.0, &JointTracker { angle, regulator }, sampling(200.0, 0));
    assert_within(trajectory.at(2.0).angle, 0.25, band + 1e-3);
    assert_within(trajectory.at(4.0).angle, -0.1, band + 1e-3);
}

#[test]
fn sensors_round_what_the_controller_sees() {
    let regulator = Regulator::Relay(Relay::new(Quantity::Angle, 0.02, 0.0, Between::Hold).expect("a relay"));
    let angle = SetPoint::constant(Quantity::Angle, 0.2).expect("a set point");
    let papers = [paper(), paper()];
    let rig = rig(&papers);
    let start = rig.start(&initial(&papers)).expect("a start");
    let step = 0.01;
    let mut sensors = JointSensors::perfect();
    sensors.angle = Sensor::new(Quantity::Angle, step, None).expect("a sensor");
    let law = JointTracker { angle, regulator };
    let of = simulate_controlled(&rig, &start, (0.5, 1e-9), &law, (sampling(100.0, 0), sensors)).expect("a run");
    for JointMeasurement { time, angle, .. } in of.decisions().into_iter().map(|decision| decision.seen) {
        assert_within(angle / step, (angle / step).round(), 1e-9);
        assert_within(angle, of.at(time).angle, 0.5 * step + 1e-12);
    }
}

#[test]
fn what_cannot_be_controlled_is_refused() {
    let regulator = Regulator::Relay(Relay::new(Quantity::Angle, 0.02, 0.0, Between::Hold).expect("a relay"));
    let law = JointTracker { angle: SetPoint::constant(Quantity::Angle, 0.2).expect("a set point"), regulator };
    let papers = [paper(), Paper::sealed()];
    let half = rig(&papers);
    let start = half.start(&initial(&papers)).expect("a start");
    let with = (sampling(100.0, 0), JointSensors::perfect());
    let error = simulate_controlled(&half, &start, (0.1, 1e-9), &law, with).expect_err("refused");
    assert!(error.to_string().contains("the actuator has no valve"), "{error}");
    let actuators = [paper().actuator(), paper().actuator()];
    let slack = SetPoint::sinusoid(Quantity::Angle, 0.0, 1.5, 1.0, 0.0).expect("a set point");
    let set_points = [slack, SetPoint::constant(Quantity::Stiffness, 2.0).expect("a stiffness")];
    let error = JointAim::new(actuators, joint(), set_points, GaugePressure(95.0 * PSI)).expect_err("refused");
    assert!(matches!(error, Error::Inconsistent { .. }), "{error}");
}
