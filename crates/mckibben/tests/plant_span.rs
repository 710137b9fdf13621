//! Actuators between two points of a chain: distance, rate and torque against the law of cosines and finite differences.

use crate::common::{GRAVITY, PSI, Paper, ROOM, assert_close, assert_within, slope};
use mckibben::GaugePressure;
use mckibben::load::MomentArm;
use mckibben::mechanism::{Arm, Attachment, Chain, ChainSegment, Coupling, JointStops, Mechanism, Revolute};
use mckibben::network::Network;
use mckibben::plant::{InitialAir, Mounted, Plant, PlantSample, PlantStart, simulate_plant};

/// Height in m of the upper attachment over the first joint.
const HEIGHT: f64 = 0.06;

fn on_segment(segment: usize, place: [f64; 2]) -> Attachment {
    Attachment { segment: Some(segment), place }
}

/// From above the first joint to a point.
fn from_above(lower: Attachment) -> Coupling {
    Coupling::Points([Attachment { segment: None, place: [-HEIGHT, 0.0] }, lower])
}

/// Samples of a swing from rest: a sealed muscle on a chain of as many links as angles.
fn swing(angles: &[f64], coupling: &Coupling) -> (Mechanism, Vec<PlantSample>) {
    let segment = ChainSegment { length: 0.03, mass: 0.4, distance: 0.015, inertia: 1e-4 };
    let stops = JointStops { ends: [None; 2], stiffness: 500.0, damping: 1.0 };
    let joint = Revolute { torque: 0.0, damping: 1e-3, stops };
    let (segments, joints) = (vec![segment; angles.len()], vec![joint; angles.len()]);
    let mechanism = Mechanism::Chain(Chain::new(segments, joints, [GRAVITY, 0.0], None).expect("a chain"));
    let paper = Paper::sealed();
    let mounted =
        Mounted { actuator: paper.actuator(), mechanism: 0, coupling: coupling.clone(), tendon: None, pressure: None };
    let plant = Plant::new(vec![mounted], Network::new(&paper.air()), vec![mechanism.clone()]).expect("a plant");
    let start = PlantStart {
        positions: vec![angles.to_vec()],
        rates: vec![vec![0.0; angles.len()]],
        air: vec![InitialAir { gauge_pressure: GaugePressure(10.0 * PSI), temperature: ROOM }],
        lengths: vec![None],
        friction: vec![],
    };
    let run = simulate_plant(&plant, &start, 0.3, 1e-10).expect("the run reaches its end");
    let samples = run.samples(0.01).collect();
    (mechanism, samples)
}

/// `x² = s² + h² + 2 s h cos θ`, and the torque is the tension times `s h sin θ/x`.
#[test]
fn between_a_link_and_the_ground_it_is_the_law_of_cosines() {
    let along = 0.04;
    let (_, samples) = swing(&[0.7], &from_above(on_segment(0, [along, 0.0])));
    let mut moved = 0.0_f64;
    for sample in &samples {
        let (muscle, link) = (&sample.actuators[0], &sample.mechanisms[0]);
        let angle = link.position[0];
        let distance = (along * along + HEIGHT * HEIGHT + 2.0 * along * HEIGHT * angle.cos()).sqrt();
        let lever = along * HEIGHT * angle.sin() / distance;
        assert_close(muscle.distance, distance, 1e-13);
        assert_within(muscle.rate, -lever * link.rate[0], 1e-13);
        assert_within(link.actuator_force[0], lever * muscle.tension, 1e-12);
        moved = moved.max((angle - 0.7).abs());
    }
    assert!(moved > 0.05, "it moves by {moved} rad");
}

/// The gradient of the distance at a sample, by finite differences; the muscle's rate and torques are those by it.
fn agree_with_differences(coupling: &Coupling, (mechanism, samples): &(Mechanism, Vec<PlantSample>)) {
    for sample in samples {
        let (muscle, chain) = (&sample.actuators[0], &sample.mechanisms[0]);
        let gradient: Vec<f64> = (0..chain.position.len())
            .map(|joint| {
                slope(1e-4, |h| {
                    let mut angles = chain.position.clone();
                    angles[joint] += h;
                    coupling.span(mechanism, &angles)
                })
            })
            .collect();
        let rate: f64 = gradient.iter().zip(&chain.rate).map(|(lever, rate)| lever * rate).sum();
        assert_within(muscle.rate, rate, 1e-9);
        for (torque, lever) in chain.actuator_force.iter().zip(&gradient) {
            assert_within(*torque, -lever * muscle.tension, 1e-9 * (1.0 + muscle.tension));
        }
    }
}

/// Over two joints to a point beside the second link: the distance is that of the corners of the figure.
#[test]
fn over_two_joints_moment_arms_are_derivatives_of_the_distance() {
    let coupling = from_above(on_segment(1, [0.012, 0.004]));
    let swung = swing(&[0.5, 0.4], &coupling);
    agree_with_differences(&coupling, &swung);
    for sample in &swung.1 {
        let (muscle, chain) = (&sample.actuators[0], &sample.mechanisms[0]);
        // The corners: the first link, the second, and across it.
        let [first, second] = [chain.position[0], chain.position[0] + chain.position[1]];
        let across = 0.03 * first.sin() + 0.012 * second.sin() + 0.004 * second.cos();
        let up = -0.03 * first.cos() - 0.012 * second.cos() + 0.004 * second.sin();
        assert_close(muscle.distance, across.hypot(up - HEIGHT), 1e-13);
    }
}

/// From beside the first link to beside the third: what turns both ends alike changes no distance.
#[test]
fn between_two_links_only_the_joints_between_have_moment_arms() {
    let coupling = Coupling::Points([on_segment(0, [-0.012, 0.01]), on_segment(2, [0.025, 0.008])]);
    let swung = swing(&[0.5, 0.4, -0.3], &coupling);
    agree_with_differences(&coupling, &swung);
    let turns =
        |sample: &PlantSample| sample.mechanisms[0].actuator_force[0].abs() / sample.actuators[0].tension.max(1.0);
    let most = swung.1.iter().map(turns).fold(0.0, f64::max);
    assert!(most < 1e-15, "the first joint has an arm of {most} m");
    let pulled = swung.1.iter().map(|sample| sample.mechanisms[0].actuator_force[1].abs()).fold(0.0, f64::max);
    assert!(pulled > 0.01, "the second joint is turned by at most {pulled} N·m");
}

/// Two pulleys of one muscle about one joint, and none about the other.
#[test]
fn arms_about_one_joint_add_up() {
    let arm = |radius: f64, sign: f64| Arm { joint: 0, sign, arm: MomentArm::Pulley(radius) };
    let coupling = Coupling::arms(0.09, vec![arm(0.012, 1.0), arm(0.004, -1.0)]).expect("a coupling");
    let swung = swing(&[0.5, 0.4], &coupling);
    agree_with_differences(&coupling, &swung);
    for sample in &swung.1 {
        let (muscle, chain) = (&sample.actuators[0], &sample.mechanisms[0]);
        assert_close(muscle.distance, 0.09 - 0.008 * chain.position[0], 1e-13);
        assert_within(chain.actuator_force[0], 0.008 * muscle.tension, 1e-12);
        assert_eq!(chain.actuator_force[1], 0.0);
    }
}
