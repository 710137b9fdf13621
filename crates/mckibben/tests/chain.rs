//! A chain of two segments in the plane, a leg, on six actuators: Newton's equations for both centres of mass, the work of the
//! actuators, energy, statics in closed form, and the belt under its foot.

use crate::common::{ATMOSPHERE, GRAVITY, PSI, Paper, ROOM, assert_close, assert_within, between, slope};
use mckibben::GaugePressure;
use mckibben::load::MomentArm;
use mckibben::mechanism::{Arm, Attachment, Belt, Chain, ChainSegment, Coupling, JointStops, Mechanism, Revolute};
use mckibben::network::Network;
use mckibben::plant::{InitialAir, Mounted, Plant, PlantRun, PlantSample, PlantStart, simulate_plant};
use mckibben::simulation::{Method, PressureSeries};
use std::f64::consts::PI;

const THIGH: ChainSegment = ChainSegment { length: 0.3, mass: 0.9, distance: 0.13, inertia: 0.008 };
const SHANK: ChainSegment = ChainSegment { length: 0.28, mass: 0.5, distance: 0.12, inertia: 0.004 };
/// Moment arms in m of six actuators about hip and knee, positive where they turn the joint forward.
const ARMS: [[f64; 2]; 6] = [[0.015, 0.0], [-0.015, 0.0], [0.0, 0.012], [0.0, -0.012], [0.01, 0.008], [-0.01, -0.008]];
/// Distance in m between the attachments with both joints at zero.
const REST: f64 = 0.083;

/// A joint that swings freely, but for its torque in N·m and its damping in N·m·s/rad.
fn joint(torque: f64, damping: f64) -> Revolute {
    Revolute { torque, damping, stops: JointStops { ends: [None; 2], stiffness: 1.0, damping: 0.0 } }
}

fn chain(joints: [Revolute; 2], hanging: f64, belt: Option<Belt>) -> Chain {
    Chain::new(vec![THIGH, SHANK], joints.to_vec(), [GRAVITY, hanging], belt).expect("a chain")
}

fn coupling(arms: [f64; 2]) -> Coupling {
    let arm = |(joint, arm): (usize, f64)| Arm { joint, sign: arm.signum(), arm: MomentArm::Pulley(arm.abs()) };
    let spanned = arms.into_iter().enumerate().filter(|(_, arm)| *arm != 0.0);
    Coupling::arms(REST, spanned.map(arm).collect()).expect("a coupling")
}

/// Six equal actuators on a chain, sealed or at given gauge pressures in Pa.
fn on(chain: Chain, paper: &Paper, given: Option<[f64; 6]>) -> Plant {
    let mounted = (0..6).map(|i| Mounted {
        actuator: paper.actuator(),
        mechanism: 0,
        coupling: coupling(ARMS[i]),
        tendon: None,
        pressure: given.map(|gauges| PressureSeries::new(&[0.0], &[gauges[i]]).expect("a pressure")),
    });
    Plant::new(mounted.collect(), Network::new(&paper.air()), vec![Mechanism::Chain(chain)]).expect("a plant")
}

fn start(angles: [f64; 2], rates: [f64; 2], gauges: [f64; 6]) -> PlantStart {
    let air = |gauge| InitialAir { gauge_pressure: GaugePressure(gauge), temperature: ROOM };
    PlantStart {
        positions: vec![angles.to_vec()],
        rates: vec![rates.to_vec()],
        air: gauges.map(air).to_vec(),
        lengths: vec![None; 6],
        ..PlantStart::default()
    }
}

fn at_start(plant: &Plant, start: &PlantStart) -> PlantSample {
    PlantRun::new(plant, start, 1e-9).expect("a start").steps(Method::Stable).sample()
}

/// Knee and foot, across and up from the hip.
fn places(angles: [f64; 2], hanging: f64) -> [[f64; 2]; 2] {
    let (first, second) = (angles[0] - hanging, angles[0] + angles[1] - hanging);
    let knee = [THIGH.length * first.sin(), -THIGH.length * first.cos()];
    [knee, [knee[0] + SHANK.length * second.sin(), knee[1] - SHANK.length * second.cos()]]
}

/// Places of both centres of mass, each with the inclination of its segment.
fn bodies(angles: [f64; 2], hanging: f64) -> [[f64; 3]; 2] {
    let (first, second) = (angles[0] - hanging, angles[0] + angles[1] - hanging);
    let ([knee, _], of_thigh, of_shank) = (places(angles, hanging), THIGH.distance, SHANK.distance);
    let middle = [of_thigh * first.sin(), -of_thigh * first.cos(), first];
    [middle, [knee[0] + of_shank * second.sin(), knee[1] - of_shank * second.cos(), second]]
}

/// d'Alembert: over each virtual turn of a joint the inertial forces of both centres of mass do the work of all others.
#[test]
fn its_accelerations_are_newton_s_for_both_centres_of_mass() {
    let belt = Belt { depth: 0.4, velocity: -0.5, stiffness: 2e3, damping: 20.0, friction: 0.7, slipping_speed: 0.05 };
    let mut pressed = 0;
    for belt in [None, Some(belt)] {
        for row in 0..40 {
            let joints = [joint(between(row, 4, -1.0, 1.0), 0.1), joint(between(row, 5, -1.0, 1.0), 0.02)];
            let hanging = between(row, 6, -0.2, 0.2);
            let plant = on(chain(joints, hanging, belt), &Paper::sealed(), None);
            let angles = [between(row, 0, -0.4, 0.4), between(row, 1, -0.5, 0.3)];
            let rates = [between(row, 2, -3.0, 3.0), between(row, 3, -4.0, 4.0)];
            let gauges = std::array::from_fn(|i| between(row + 100 * i, 7, 0.0, 4e5));
            let sample = at_start(&plant, &start(angles, rates, gauges));
            let turns = &sample.mechanisms[0].acceleration;
            let at = |time: f64| [0, 1].map(|k| angles[k] + rates[k] * time + 0.5 * turns[k] * time * time);
            let foot = |axis: usize| slope(1e-4, |time| places(at(time), hanging)[1][axis]);
            let force = belt.map_or([0.0; 2], |belt| {
                let below = -places(angles, hanging)[1][1] - belt.depth;
                let normal = (belt.stiffness * below - belt.damping * foot(1)).max(0.0);
                let normal = if below > 0.0 { normal } else { 0.0 };
                let slip = belt.velocity - foot(0);
                [belt.friction * normal * slip / slip.hypot(belt.slipping_speed), normal]
            });
            pressed += usize::from(force[1] > 0.0);
            for k in 0..2 {
                let turned = |by: f64| {
                    let mut angles = angles;
                    angles[k] += by;
                    angles
                };
                let pulls = ARMS.iter().zip(&sample.actuators).map(|(arms, its)| arms[k] * its.tension);
                let mut work = pulls.sum::<f64>() + joints[k].torque - joints[k].damping * rates[k];
                for (axis, force) in force.into_iter().enumerate() {
                    work += force * slope(1e-3, |by| places(turned(by), hanging)[1][axis]);
                }
                let mut inertial = 0.0;
                for (body, segment) in [THIGH, SHANK].iter().enumerate() {
                    let weights = [segment.mass, segment.mass, segment.inertia];
                    for (axis, weight) in weights.into_iter().enumerate() {
                        let per_turn = slope(1e-3, |by| bodies(turned(by), hanging)[body][axis]);
                        let place = |time: f64| bodies(at(time), hanging)[body][axis];
                        let acceleration = slope(2e-4, |time| slope(2e-4, |more| place(time + more)));
                        let gravity = if axis == 1 { GRAVITY } else { 0.0 };
                        inertial += weight * (acceleration + gravity) * per_turn;
                    }
                }
                assert_within(inertial, work, 1e-6 * (1.0 + work.abs()));
            }
        }
    }
    assert!(pressed > 10, "{pressed}");
}

/// `−Σ F ∂L/∂θ`, where the distance falls by the arm for each rad.
#[test]
fn an_actuator_does_the_work_that_it_loses_by_shortening() {
    let plant = on(chain([joint(0.0, 0.0); 2], 0.0, None), &Paper::sealed(), None);
    for row in 0..20 {
        let angles = [between(row, 0, -0.4, 0.4), between(row, 1, -0.5, 0.3)];
        let rates = [between(row, 2, -3.0, 3.0), between(row, 3, -4.0, 4.0)];
        let gauges = std::array::from_fn(|i| between(row + 100 * i, 7, 1e4, 4e5));
        let sample = at_start(&plant, &start(angles, rates, gauges));
        for (arms, its) in ARMS.iter().zip(&sample.actuators) {
            assert_close(its.distance, REST - arms[0] * angles[0] - arms[1] * angles[1], 1e-14);
            assert_within(its.rate, -arms[0] * rates[0] - arms[1] * rates[1], 1e-14);
        }
        for k in 0..2 {
            let pulls: f64 = ARMS.iter().zip(&sample.actuators).map(|(arms, its)| arms[k] * its.tension).sum();
            assert_within(sample.mechanisms[0].actuator_force[k], pulls, 1e-12);
        }
    }
}

/// With sealed isentropic air, which is another spring, and without friction.
#[test]
fn energy_of_leg_and_sealed_air_stays_and_steps_keep_their_order() {
    let leg = chain([joint(0.0, 0.0); 2], 0.0, None);
    let plant = on(leg.clone(), &Paper::sealed().friction(0.0, 0.0), None);
    let start = start([0.25, -0.2], [0.0, 1.0], [30.0 * PSI; 6]);
    let run = simulate_plant(&plant, &start, 0.5, 1e-12).expect("a run");
    let exact = run.sample(0.5);
    let energy = |sample: &PlantSample| {
        let gas = sample.actuators.iter().map(|its| its.pressure.0 * its.volume / 0.4 + ATMOSPHERE * its.volume);
        let [kinetic, potential] = leg.energies(&sample.mechanisms[0].position, &sample.mechanisms[0].rate);
        kinetic + potential + gas.sum::<f64>()
    };
    let begin = at_start(&plant, &start);
    let of_swing = |sample: PlantSample| leg.energies(&sample.mechanisms[0].position, &sample.mechanisms[0].rate)[0];
    let kinetic = run.samples(5e-3).map(of_swing).fold(0.0, f64::max);
    assert!(kinetic > 0.05, "it swings: {kinetic} J");
    assert_within(energy(&exact), energy(&begin), 1e-8 * kinetic);
    for (method, order, counts) in [(Method::Stable, 2.0, [1000_u32, 2000]), (Method::Rk4, 4.0, [50, 100])] {
        let errors = counts.map(|count| {
            let mut steps = PlantRun::new(&plant, &start, 1e-9).expect("a start").steps(method);
            (1..=count).for_each(|k| steps.advance_to(0.5 * f64::from(k) / f64::from(count)).expect("a step"));
            let sample = steps.sample();
            let off = (sample.mechanisms[0].position[0] - exact.mechanisms[0].position[0]).abs();
            [off, (energy(&sample) - energy(&begin)).abs()]
        });
        for (what, coarse, fine) in [("angle", errors[0][0], errors[1][0]), ("energy", errors[0][1], errors[1][1])] {
            let fitted = (coarse / fine).log2();
            assert!(fitted > order - 0.3, "{method:?}, {what}: order {fitted}, {errors:?}");
        }
        assert!(errors[1][1] < 1e-3 * kinetic, "{method:?}: {errors:?}");
    }
}

/// At given pressures the leg comes to rest where `Σ R F = (m₁d₁ + m₂l₁) g sin a₁ + m₂d₂ g sin a₂` about the hip, and the last
/// term alone about the knee, with the braid's force (3).
#[test]
fn damped_it_comes_to_rest_where_the_torques_balance() {
    let paper = Paper::sealed().friction(0.0, 0.0);
    for gauges in [[4e5, 1e5, 0.5e5, 3e5, 1e5, 1e5], [1e5, 2e5, 2e5, 1e5, 2.5e5, 0.5e5]] {
        let plant = on(chain([joint(0.0, 0.5); 2], 0.0, None), &paper, Some(gauges));
        let run = simulate_plant(&plant, &start([0.0, -0.2], [0.0; 2], gauges), 30.0, 1e-10).expect("a run");
        let rest = run.sample(30.0);
        let [hip, knee] = [0, 1].map(|k| rest.mechanisms[0].position[k]);
        assert!(hip.abs() > 0.05 && knee.abs() > 0.05, "{hip} {knee}");
        let (b, n) = (paper.thread_length, paper.turns);
        let torque = |k: usize| -> f64 {
            let pull = |(arms, gauge): (&[f64; 2], f64)| {
                let length = REST - arms[0] * hip - arms[1] * knee;
                arms[k] * gauge * (3.0 * length * length - b * b) / (4.0 * PI * n * n)
            };
            ARMS.iter().zip(gauges).map(pull).sum()
        };
        let of_shank = SHANK.mass * SHANK.distance * GRAVITY * (hip + knee).sin();
        let of_thigh = (THIGH.mass * THIGH.distance + SHANK.mass * THIGH.length) * GRAVITY * hip.sin();
        assert_within(torque(0), of_thigh + of_shank, 1e-7);
        assert_within(torque(1), of_shank, 1e-7);
    }
}

#[test]
fn a_belt_at_rest_presses_by_its_depth_and_drags_towards_where_it_runs() {
    let belt = Belt { depth: 0.578, velocity: 0.0, stiffness: 1e4, damping: 0.0, friction: 0.5, slipping_speed: 0.01 };
    // The leg straight down, pressed 2 mm into the belt: hip and knee bear what drags the foot, and not what presses it.
    for velocity in [-2.0_f64, -0.02, 0.0, 0.02, 2.0] {
        let leg = chain([joint(0.0, 0.0); 2], 0.0, Some(Belt { velocity, ..belt }));
        assert_close(leg.foot_press(&[0.0; 2], &[0.0; 2]), 20.0, 1e-12);
        let mut inertia = [0.0; 4];
        leg.mass_matrix(&[[0.0, 1.0]; 2], &mut inertia);
        let sample = at_start(&on(leg, &Paper::sealed(), None), &start([0.0; 2], [0.0; 2], [0.0; 6]));
        let turns = &sample.mechanisms[0].acceleration;
        let torques = [0, 2].map(|row| inertia[row] * turns[0] + inertia[row + 1] * turns[1]);
        let drag = 0.5 * 20.0 * velocity / velocity.hypot(0.01);
        assert_within(torques[0], 0.58 * drag, 1e-12);
        assert_within(torques[1], 0.28 * drag, 1e-12);
    }
}

#[test]
fn what_is_out_of_range_is_refused_by_name() {
    let made = |shank: ChainSegment, knee: Revolute, belt: Option<Belt>| {
        let made = Chain::new(vec![THIGH, shank], vec![joint(0.0, 0.0), knee], [GRAVITY, 0.0], belt);
        made.expect_err("refused").to_string()
    };
    let free = joint(0.0, 0.0);
    assert!(made(ChainSegment { mass: 0.0, ..SHANK }, free, None).contains("mass"));
    assert!(made(ChainSegment { length: -0.1, ..SHANK }, free, None).contains("mechanism.segment_length"));
    let ends = [Some(0.5), Some(0.5)];
    assert!(made(SHANK, Revolute { stops: JointStops { ends, ..free.stops }, ..free }, None).contains("min_angle"));
    let belt = Belt { depth: 0.5, velocity: 0.0, stiffness: 0.0, damping: 0.0, friction: 0.5, slipping_speed: 0.01 };
    assert!(made(SHANK, free, Some(belt)).contains("mechanism.belt_stiffness"));
    let plant = on(chain([free; 2], 0.0, None), &Paper::sealed(), None);
    let bent = PlantRun::new(&plant, &start([-3.0, 0.0], [0.0; 2], [0.0; 6]), 1e-9).expect_err("too long");
    assert!(bent.to_string().contains("thread"), "{bent}");
}

/// Where the points of a muscle meet its length has no slope, and it pulls nothing: the segment swings on as a pendulum, whose energy
/// stays.
#[test]
fn a_segment_swings_through_where_the_points_of_its_muscle_meet() {
    let place = [0.1, 0.0];
    let points = [Attachment { segment: None, place }, Attachment { segment: Some(0), place }];
    let paper = Paper::sealed();
    let mounted = Mounted {
        actuator: paper.actuator(),
        mechanism: 0,
        coupling: Coupling::Points(points),
        tendon: None,
        pressure: None,
    };
    let pendulum = Chain::new(vec![THIGH], vec![joint(0.0, 0.0)], [GRAVITY, 0.0], None).expect("a chain");
    let plant =
        Plant::new(vec![mounted], Network::new(&paper.air()), vec![Mechanism::Chain(pendulum)]).expect("a plant");
    let energy = |angle: f64, rate: f64| {
        let about_the_joint = THIGH.inertia + THIGH.mass * THIGH.distance * THIGH.distance;
        0.5 * about_the_joint * rate * rate - THIGH.mass * GRAVITY * THIGH.distance * angle.cos()
    };
    for (angle, rate) in [(0.0, 0.0), (0.0, 2.0), (0.3, 0.0)] {
        let start = PlantStart {
            positions: vec![vec![angle]],
            rates: vec![vec![rate]],
            air: vec![InitialAir { gauge_pressure: GaugePressure(5e4), temperature: ROOM }],
            lengths: vec![None],
            ..PlantStart::default()
        };
        let begin = || PlantRun::new(&plant, &start, 1e-10).expect("a start");
        let mut located = begin();
        located.advance_to(0.6).expect("a run");
        let mut ends = vec![located.steps(Method::Rk4).sample()];
        for method in [Method::Rk4, Method::Stable] {
            let mut steps = begin().steps(method);
            (1..=6000).for_each(|step| steps.advance_to(1e-4 * f64::from(step)).expect("a step"));
            ends.push(steps.sample());
        }
        for sample in ends {
            let its = &sample.mechanisms[0];
            assert_close(energy(its.position[0], its.rate[0]) + 1.0, energy(angle, rate) + 1.0, 1e-6);
            assert_eq!(sample.actuators[0].tension, 0.0);
        }
    }
}
