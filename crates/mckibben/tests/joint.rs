//! The antagonistic joint: symmetry, a closed-form period, sticking torque and restitution, the energy balance, the reduction
//! to the hanging mass, derivatives, and random joints.

use crate::common::joint::{Pair, pairs};
use crate::common::laws;
use crate::common::random;
use crate::common::{ATMOSPHERE, GRAVITY, PSI, Paper, assert_close, assert_within, bisect};
use mckibben::Scalar as _;
use mckibben::friction::{Hysteresis, MaxwellSlip};
use mckibben::load::{Limb, MomentArm, Stops, Tendon};
use mckibben::plant::{JointPlant, JointTrajectory, Turning};
use mckibben::simulation::{EventKind, InitialAngle, InitialLength, JointInitial};
use mckibben::valve::{Command, Request};
use mckibben::{Error, GaugePressure, Real};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use random::{Accounted, falling_power, runner};
use std::f64::consts::PI;

fn pulses(frequency: f64, duty: f64) -> Command {
    Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command")
}

#[test]
fn a_symmetric_pair_stays_at_zero() {
    for (viscous, width) in [(0.0, 0.0), (3.5, 0.0), (3.5, 1e-4)] {
        let pair = Pair::of(Paper::driven(pulses(25.0, 0.4)).friction(viscous, width));
        let run = pair.run(1.0, 1e-8);
        for sample in run.samples(0.01) {
            assert_within(sample.angle, 0.0, 1e-9);
            assert_within(sample.actuators[0].pressure.0, sample.actuators[1].pressure.0, 1e-3);
        }
        assert!(run.at(1.0).actuators[0].pressure.0 > 2.0 * ATMOSPHERE, "the valves have filled both");
    }
}

/// Stiffness in N/m of a sealed ideal actuator, (7) and the first term of (5), written out again.
fn sealed_stiffness(paper: &Paper, length: f64) -> f64 {
    let (b, n) = (paper.thread_length, paper.turns);
    let area = 4.0 * PI * n * n;
    let volume = length * (b * b - length * length) / area + paper.external_volume;
    let slope = (b * b - 3.0 * length * length) / area;
    let per_pressure = -slope;
    6.0 * paper.gauge * length / area
        - paper.heat_capacity_ratio * (paper.gauge + ATMOSPHERE) * slope / volume * per_pressure
}

#[test]
fn small_oscillations_have_the_period_of_both_sealed_stiffnesses_and_gravity() {
    let pair = Pair::of(Paper::sealed().friction(0.0, 0.0).gauge(40.0 * PSI)).with(|pair| {
        pair.limb.distance = 0.1;
        pair.angle = InitialAngle::At(1e-4);
    });
    let k = sealed_stiffness(&pair.papers[0], 0.082);
    let inertia = 1e-3 + 0.3 * 0.01;
    let stiffness = 2.0 * 0.015 * 0.015 * k + 0.3 * GRAVITY * 0.1;
    let period = 2.0 * PI * (inertia / stiffness).sqrt();
    let run = pair.run(10.5 * period, 1e-11);
    let angle = |time: f64| run.at(time).angle;
    let crossing = |count: f64| bisect((count - 0.05) * period, (count + 0.05) * period, angle);
    assert_close((crossing(10.25) - crossing(0.25)) / 10.0, period, 1e-6);
}

#[test]
fn the_joint_sticks_within_the_torque_of_both_frictions() {
    let (gauge, length, width) = (50.0 * PSI, 0.082, 1.1e-4);
    let paper = Paper::sealed().friction(1.0, width).gauge(gauge);
    let (b, n) = (paper.thread_length, paper.turns);
    let secant = |gauge: f64| 3.0 * gauge * (length + b / 3_f64.sqrt()) / (4.0 * PI * n * n);
    let force = |gauge: f64| gauge * (3.0 * length * length - b * b) / (4.0 * PI * n * n);
    // Unequal pressures and tendons, so that neither the balance nor the bound is symmetric.
    let (other, radii) = (35.0 * PSI, [0.015, 0.02]);
    let bound = radii[0] * width * secant(gauge) + radii[1] * width * secant(other);
    let balance = radii[1] * force(other) - radii[0] * force(gauge);
    let pair = Pair::of(paper).with(|pair| {
        pair.papers[1].gauge = other;
        for i in 0..2 {
            pair.tendons[i].arm = MomentArm::Pulley(radii[i]);
        }
    });
    for sign in [-1.0, 1.0] {
        let held = pair.clone().with(|pair| pair.torque = balance + sign * 0.9999 * bound).run(0.1, 1e-9);
        assert_eq!(held.at(0.1).angle, 0.0);
        assert!(held.events().is_empty(), "{:?}", held.events());
        // What both hold balances the torque on the joint.
        assert_close(held.at(0.05).torque, -(balance + sign * 0.9999 * bound), 1e-12);
        let freed = pair.clone().with(|pair| pair.torque = balance + sign * 1.0001 * bound).run(0.1, 1e-9);
        assert!(sign * freed.at(0.1).angle > 1e-7, "{}", freed.at(0.1).angle);
    }
}

#[test]
fn energy_and_air_balance_with_everything_at_work() {
    let agonist = Paper::driven(pulses(20.0, 0.6));
    let pair = Pair::of(agonist).with(|pair| {
        pair.papers[1].command = Some(pulses(7.0, 0.3));
        pair.limb.distance = 0.12;
        pair.damping = 2e-3;
        pair.stops = Stops { ends: [Some(-0.2), Some(0.25)], stiffness: 300.0, damping: 0.3 };
        pair.tendons[1].arm = MomentArm::Pulley(0.012);
    });
    let run = pair.run(1.0, 1e-9);
    let kinds: Vec<EventKind> = run.events().iter().map(|event| event.kind.kind).collect();
    for kind in [EventKind::Valve, EventKind::StopReached, EventKind::Reversal] {
        assert!(kinds.contains(&kind), "{kind:?} does not happen");
    }
    let ledger = run.ledger();
    let (work, air) = (ledger.work(), ledger.air());
    assert_within(work.residual, 0.0, 1e-6 * work.turnover);
    assert_within(air.residual, 0.0, 1e-6 * air.turnover);
    assert_within(ledger.mechanism_residual(0, &[0, 1]), 0.0, 1e-6 * work.turnover);
    for of in &ledger.actuators {
        assert_within(of.work_residual(), 0.0, 1e-6 * work.turnover);
        assert!(of.dissipated() > 0.0, "{of:?}");
    }
    assert!(ledger.mechanisms[0].damping > 0.0 && ledger.mechanisms[0].stops > 0.0);
}

/// Each law on the agonist, another on the antagonist; the lines of a force map are events of the actuator that has it.
#[test]
fn energy_and_air_balance_on_every_law_of_force() {
    let paper = Paper::driven(pulses(20.0, 0.6));
    let map = laws::measured(&paper);
    for (name, law) in laws::all(&paper) {
        let pair = Pair::of(paper.clone()).with(|pair| {
            pair.papers[0].characteristic = Some(law);
            pair.papers[1].characteristic = Some(map.clone());
            pair.papers[1].command = Some(pulses(7.0, 0.3));
        });
        let run = pair.run(0.4, 1e-9);
        let lines = |of: usize| {
            let is_line = |kind: EventKind| kind == EventKind::ForceMap;
            run.events().iter().filter(|event| event.kind.actuator == Some(of) && is_line(event.kind.kind)).count()
        };
        assert!(lines(0) == 0 && lines(1) > 4, "{name}: {} and {} lines", lines(0), lines(1));
        let ledger = run.ledger();
        let work = ledger.work();
        assert!(work.residual.abs() < 1e-6 * work.turnover, "{name}: {ledger:?}");
        for of in &ledger.actuators {
            assert!(of.work_residual().abs() < 1e-6 * work.turnover, "{name}: {of:?}");
        }
    }
}

/// With a slack antagonist, a limb of inertia M r² and the constant torque −M g r the joint is the rig of the paper.
#[test]
fn with_a_slack_antagonist_it_is_the_hanging_mass() {
    let elements = MaxwellSlip::new(&[5e-5, 4e-4], &[0.8, 0.1]).expect("elements");
    for hysteresis in [None, Some(Hysteresis::MaxwellSlip(elements))] {
        compare_with_the_hanging_mass(hysteresis);
    }
}

fn compare_with_the_hanging_mass(hysteresis: Option<Hysteresis>) {
    let (mass, radius, rest) = (2.0, 0.02, 0.09);
    let paper = Paper::pwm(10.0, 0.5).mass(mass).with(|rig| {
        rig.length = InitialLength::Equilibrium;
        rig.hysteresis = hysteresis;
    });
    let line = paper.run(0.8, 1e-11);
    let pair = Pair::of(paper.clone()).with(|pair| {
        pair.papers[1] = Paper::sealed();
        pair.limb = Limb { mass, distance: 0.0, inertia: mass * radius * radius, gravity: GRAVITY, hanging_angle: 0.0 };
        pair.tendons = [
            Tendon { arm: MomentArm::Pulley(radius), rest_length: rest },
            Tendon { arm: MomentArm::Pulley(1e-3), rest_length: 0.02 },
        ];
        pair.torque = -mass * GRAVITY * radius;
        pair.angle = InitialAngle::Equilibrium;
    });
    let turn = pair.run(0.8, 1e-11);
    for (on_line, on_pulley) in line.samples(1e-3).zip(turn.samples(1e-3)) {
        let agonist = on_pulley.actuators[0];
        assert_within(rest - radius * on_pulley.angle, on_line.length, 1e-9);
        assert_within(agonist.length, on_line.length, 1e-9);
        assert_within(agonist.velocity, on_line.velocity, 1e-6);
        assert_close(agonist.pressure.0, on_line.pressure.0, 1e-7);
        assert_close(agonist.air_mass, on_line.air_mass, 1e-7);
        assert_eq!(on_pulley.actuators[1].tension, 0.0);
    }
    assert_eq!(hysteresis.is_some(), line.events().iter().any(|event| event.kind == EventKind::Slip));
    // The same story, apart from events between formulas that agree.
    let mechanical_or_valve = |kind: &EventKind| matches!(kind, EventKind::Stick | EventKind::Slip | EventKind::Valve);
    let of_line = line.events().iter().map(|event| event.kind).filter(mechanical_or_valve);
    let of_turn = turn.events().iter().map(|event| event.kind.kind).filter(mechanical_or_valve);
    assert!(of_line.eq(of_turn));
}

/// Two muscles whose friction remembers: it slips, and energy closes.
#[test]
fn a_joint_with_hysteresis_balances_its_energy() {
    let elements = MaxwellSlip::new(&[2e-5, 2e-4, 1e-3], &[0.8, 0.2, 0.05]).expect("elements");
    let paper = Paper::driven(pulses(20.0, 0.6)).friction(2.0, 0.0);
    let pair = Pair::of(paper.with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(elements)))).with(|pair| {
        pair.papers[1].command = Some(pulses(7.0, 0.3));
        pair.limb.distance = 0.12;
    });
    let ledger = pair.run(1.0, 1e-9).ledger();
    let work = ledger.work();
    assert_within(work.residual, 0.0, 1e-6 * work.turnover);
    for of in &ledger.actuators {
        assert_within(of.work_residual(), 0.0, 1e-6 * work.turnover);
        assert!(of.slip > 0.0 && of.coulomb == 0.0, "{of:?}");
    }
}

/// A limb against a stop, with both tendons slack: the coefficient of restitution of a damped linear contact that does not
/// hold back (Schwager & Pöschel 2007).
#[test]
fn a_stop_returns_the_limb_with_the_restitution_of_a_damped_spring() {
    let (inertia, stiffness, damping) = (2e-3, 400.0, 0.5);
    let pair = Pair::of(Paper::sealed()).with(|pair| {
        pair.limb.inertia = inertia;
        pair.tendons = [Tendon { arm: MomentArm::Pulley(1e-3), rest_length: 0.05 }; 2];
        pair.stops = Stops { ends: [Some(-0.1), Some(0.1)], stiffness, damping };
        pair.angular_velocity = 2.0;
    });
    let ratio = damping / (2.0 * (stiffness * inertia).sqrt());
    let restitution = (-ratio / (1.0 - ratio * ratio).sqrt() * (2.0 * ratio * ratio - 1.0).acos()).exp();
    let run = pair.run(0.3, 1e-10);
    let left: Vec<_> = run.events().iter().filter(|event| event.kind.kind == EventKind::StopLeft).collect();
    assert_close(run.at(left[0].time).angular_velocity, -2.0 * restitution, 1e-8);
    assert_close(run.at(left[1].time).angular_velocity, 2.0 * restitution * restitution, 1e-8);
}

/// An agonist that pulls harder than the load even at its shortest holds the joint there, without bouncing for ever.
#[test]
fn the_joint_rests_where_an_actuator_is_at_its_shortest() {
    for width in [0.0, 1e-4] {
        let paper = Paper::sealed().friction(5.0, width).gauge(60.0 * PSI).with(|rig| rig.min_length = Some(0.078));
        let pair = Pair::of(paper).with(|pair| {
            pair.papers[1].gauge = 0.0;
            pair.torque = -0.1;
            pair.damping = 2e-3;
            pair.angle = InitialAngle::Equilibrium;
        });
        let at_shortest = (0.082 - 0.078) / 0.015;
        let rig = pair.rig().expect("a rig");
        assert_close(rig.start(&pair.initial()).expect("a start").angle, at_shortest, 1e-14);
        let run = pair.clone().with(|pair| pair.angle = InitialAngle::At(at_shortest + 0.02)).run(20.0, 1e-8);
        assert_close(run.at(20.0).angle, at_shortest, 1e-6);
        assert_eq!(run.events().last().map(|event| event.after.turning), Some(Turning::Stuck));
    }
}

#[test]
fn derivatives_by_a_parameter_are_those_of_finite_differences() {
    type Number = mckibben::Seeded;
    let pair = Pair::of(Paper::driven(pulses(20.0, 0.5))).with(|pair| {
        pair.papers[1].command = Some(pulses(15.0, 0.35));
        pair.limb.distance = 0.1;
    });
    let at = |mass: f64| pair.clone().with(|pair| pair.limb.mass = mass).run(0.2, 1e-11).at(0.2).angle;
    let rig = pair.rig().expect("a rig").map(|parameter, value| {
        let mut number = Number::constant(value);
        number.slope[0] = f64::from(u8::from(parameter.key == "load.mass"));
        number
    });
    let plain = pair.initial();
    let constant = |value: f64| Number::constant(value);
    let initial = JointInitial {
        gauge_pressure: plain.gauge_pressure.map(|gauge| GaugePressure(constant(gauge.0))),
        temperature: plain.temperature.map(constant),
        angle: InitialAngle::At(constant(0.0)),
        angular_velocity: constant(0.0),
    };
    let start = rig.begin(&initial).expect("a start");
    let joint = JointPlant::new(&rig).expect("a plant");
    let run = joint.simulate(&start, constant(0.2), 1e-11).expect("runs");
    let angle = run.at(constant(0.2)).angle;
    assert_close(angle.value(), at(0.3), 1e-9);
    let step = 1e-4;
    assert_close(angle.slope[0], (at(0.3 + step) - at(0.3 - step)) / (2.0 * step), 1e-4);
}

/// Joints that are tried when `MCKIBBEN_CASES` is not set.
const CASES: u32 = 3000;

/// Where the work of both gases went is accounted for, to the tolerance of each step.
fn check_energy(run: &JointTrajectory, duration: f64, tolerance: f64) -> Result<(), TestCaseError> {
    let (ledger, counts, joint) = (run.ledger(), run.statistics(), run.rig().joint());
    let work = ledger.work();
    let [mut gas, mut length, mut pressure] = [[0.0_f64; 2]; 3];
    let mut speed = 0.0_f64;
    for sample in run.samples(duration / 53.0) {
        speed = speed.max(sample.angular_velocity.abs());
        for (i, actuator) in sample.actuators.iter().enumerate() {
            gas[i] = gas[i].max(actuator.pressure.0 * actuator.volume);
            length[i] = length[i].max(actuator.length);
            pressure[i] = pressure[i].max(actuator.pressure.0);
        }
    }
    let falling = |i: usize| falling_power(&run.rig().driven()[i].actuator, length[i], pressure[i]);
    let accounted = Accounted {
        states: 6,
        steps: (counts.explicit_steps + counts.implicit_steps, tolerance),
        energy: work.turnover + gas[0] + gas[1] + 2.0 * joint.weight() + 0.5 * joint.inertia() * speed * speed,
        falling: (falling(0) + falling(1), duration),
    };
    let (residual, allowed) = (work.residual, accounted.allowed());
    prop_assert!(residual.abs() <= allowed, "{residual:e} J, allowed {allowed:e} J: {ledger:?} {accounted:?}");
    Ok(())
}

/// Every number is one, and possible, and the energy closes; a run ends or says that a braid was pulled straight.
#[test]
fn random_joints_reach_their_end() {
    let (tried, finished) = (std::cell::Cell::new(0), std::cell::Cell::new(0));
    let result = runner(CASES).run(&pairs(), |(pair, duration, tolerance)| {
        tried.set(tried.get() + 1);
        let run = match pair.try_run(duration, tolerance) {
            Ok(run) => run,
            Err(Error::Stopped { reason: "the load pulled a braid straight", .. }) => return Ok(()),
            Err(error @ Error::Stopped { .. }) => return Err(TestCaseError::fail(error.to_string())),
            // A start that the joint cannot have.
            Err(_) => return Ok(()),
        };
        finished.set(finished.get() + 1);
        for sample in run.samples(duration / 53.0) {
            prop_assert!(sample.angle.is_finite() && sample.angular_velocity.is_finite(), "{sample:?}");
            prop_assert!(sample.torque.is_finite(), "{sample:?}");
            for (actuator, paper) in sample.actuators.iter().zip(&pair.papers) {
                prop_assert!(actuator.tension >= 0.0 && actuator.tension.is_finite(), "{sample:?}");
                prop_assert!(actuator.pressure.0 > 0.0 && actuator.pressure.0.is_finite(), "{sample:?}");
                prop_assert!(actuator.air_mass > 0.0 && actuator.mass_flow.is_finite(), "{sample:?}");
                prop_assert!(actuator.length < paper.thread_length, "{sample:?}");
            }
        }
        check_energy(&run, duration, tolerance)
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    assert!(2 * finished.get() > tried.get(), "{} of {} joints ran", finished.get(), tried.get());
}

#[test]
fn what_cannot_be_is_refused_with_a_reason() {
    let pair = || Pair::of(Paper::sealed());
    let error_of = |pair: Pair| pair.try_run(0.1, 1e-6).expect_err("it is refused").to_string();
    let error = error_of(pair().with(|pair| pair.limb.inertia = 0.0));
    assert!(error.contains("load.inertia = 0 kg*m^2"), "{error}");
    let error = error_of(pair().with(|pair| pair.stops.ends = [Some(0.1), Some(0.1)]));
    assert!(
        error.contains("load.min_angle = 0.1 rad contradicts the rule that it must be less than load.max_angle"),
        "{error}"
    );
    let error = error_of(pair().with(|pair| pair.tendons[0].rest_length = 0.2));
    assert!(error.contains("load.rest_length"), "{error}");
    let error = error_of(pair().with(|pair| pair.angle = InitialAngle::At(4.0)));
    assert!(error.contains("initial.angle = 4 rad contradicts"), "{error}");
    let error = error_of(pair().with(|pair| pair.tendons[0].arm = MomentArm::Pulley(f64::NAN)));
    assert!(error.contains("load.pulley_radius"), "{error}");
}
