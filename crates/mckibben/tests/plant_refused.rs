//! What no plant can have is refused where it is stated, with its reason.

use crate::common::{ATMOSPHERE, GRAVITY, Paper, ROOM};
use mckibben::Error;
use mckibben::line::Leakage;
use mckibben::mechanism::{Arm, Chain, ChainSegment, Coupling, JointStops, Mechanism, Revolute};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{Mounted, Plant};

fn segment([length, mass, distance, inertia]: [f64; 4]) -> ChainSegment {
    ChainSegment { length, mass, distance, inertia }
}

fn chain(segments: Vec<ChainSegment>) -> Result<Chain, Error> {
    let free = JointStops { ends: [None, None], stiffness: 1.0, damping: 0.0 };
    let joints = segments.iter().map(|_| Revolute { torque: 0.0, damping: 0.0, stops: free }).collect();
    Chain::new(segments, joints, [GRAVITY, 0.0], None)
}

fn mounted(coupling: Coupling) -> Mounted {
    Mounted { actuator: Paper::sealed().actuator(), mechanism: 0, coupling, tendon: None, pressure: None }
}

fn on(chain: Chain, couplings: Vec<Coupling>) -> Result<Plant, Error> {
    let actuators = couplings.into_iter().map(mounted).collect();
    Plant::new(actuators, Network::new(&Paper::sealed().air()), vec![Mechanism::Chain(chain)])
}

#[test]
fn an_angle_is_no_distance() {
    let chain = chain(vec![segment([0.2, 1.0, 0.1, 1e-3])]).expect("a chain");
    let error = on(chain, vec![Coupling::Direct { coordinate: 0 }]).expect_err("it is refused").to_string();
    assert!(error.contains("angles") && error.contains("moment arms"), "{error}");
}

/// The mass matrix of two segments, in angles against a fixed direction, is
/// `[[I₁ + m₁d₁² + m₂L², m₂Ld₂ cos φ], [m₂Ld₂ cos φ, I₂ + m₂d₂²]]`; its determinant is least where they are in line.
#[test]
fn two_segments_without_inertia_are_refused_and_no_others() {
    let (length, mass) = (0.25, 2.0);
    let mut refused = 0;
    for case in 0..16 {
        let part = |bit: usize, value: f64| if case >> bit & 1 == 1 { value } else { 0.0 };
        let [d1, i1, d2, i2] = [part(0, 0.125), part(1, 0.5), part(2, 0.25), part(3, 0.125)];
        let off = mass * length * d2;
        let least = (i1 + mass * d1 * d1 + mass * length * length) * (i2 + mass * d2 * d2) - off * off;
        let made = chain(vec![segment([length, mass, d1, i1]), segment([0.0, mass, d2, i2])]);
        assert_eq!(made.is_err(), least == 0.0, "{d1} {i1} {d2} {i2}: {least}");
        if let Err(error) = made {
            let text = error.to_string();
            assert!(matches!(error, Error::Inconsistent { .. }) && text.contains("inertia"), "{text}");
            refused += 1;
        }
    }
    assert!(refused > 1);
}

#[test]
fn more_facets_than_a_mode_keeps_are_refused() {
    let spanning = |count: usize| {
        let segments = (0..6).map(|_| segment([0.2, 1.0, 0.1, 1e-3])).collect();
        let arms = |i: usize| {
            let arm = |joint: usize| Arm {
                joint,
                sign: 1.0,
                arm: mckibben::load::MomentArm::pulley(0.01 + 1e-3 * (i * joint) as f64).expect("an arm"),
            };
            Coupling::arms(0.09, (0..6).map(arm).collect()).expect("a coupling")
        };
        on(chain(segments).expect("a chain"), (0..count).map(arms).collect())
    };
    // Five of eleven are 462, five of twelve 792.
    spanning(11).expect("a plant");
    let error = spanning(12).expect_err("it is refused").to_string();
    assert!(error.contains("512 facets") && error.contains("span several joints"), "{error}");
}

#[test]
fn air_flows_nowhere_without_an_actuator() {
    let mut network = Network::new(&Paper::sealed().air());
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let source = network.node(NodeKind::Source, ATMOSPHERE, ROOM);
    network.branch(outside, source, BranchKind::Leak(Leakage::new(1e-10).expect("a leak")));
    let error = Plant::new(vec![], network, vec![Mechanism::Fixed]).expect_err("it is refused").to_string();
    assert!(error.contains("without an actuator"), "{error}");
}
