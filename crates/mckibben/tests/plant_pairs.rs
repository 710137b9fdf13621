//! Random joints.

use crate::common::joint::Pair;
use crate::common::random::{Case, cases};
use crate::common::{GRAVITY, Paper};
use mckibben::load::{Limb, MomentArm, Stops, Tendon};
use mckibben::simulation::InitialAngle;
use proptest::prelude::*;

/// A pulley, or an arm that goes up and down about its radius.
fn moment_arm(radius: f64, varies: bool) -> MomentArm {
    let arms = [1.0, 1.3, 0.8, 1.2].map(|part| part * radius);
    let table = || MomentArm::table(&[-0.5, -0.1, 0.2, 0.6], &arms).expect("a table");
    if varies { table() } else { MomentArm::Pulley(radius) }
}

pub(crate) fn pairs() -> impl Strategy<Value = (Pair, f64, f64)> {
    let share = || 0.5..1.0_f64;
    let radius = || 0.02..0.6_f64;
    let start = prop_oneof![1 => Just(None), 2 => (-0.5..0.5_f64).prop_map(Some)];
    let limb = (0.01..5.0_f64, 0.0..0.5_f64, 1e-4..1e-1_f64, -3.0..3.0_f64);
    let stops = (prop::option::of(-0.5..0.0_f64), prop::option::of(0.01..0.5_f64), 0.0..3.0_f64, any::<bool>());
    ((cases(), cases()), (share(), share(), radius(), radius()), limb, stops, start, -3.0..3.0_f64).prop_map(
        |(
            (first, second),
            (rest, other_rest, radius, other),
            (mass, distance, inertia, hanging),
            stops,
            start,
            speed,
        )| {
            let Case { duration, tolerance, .. } = first;
            let pulley = |paper: &Paper, share: f64, radius: f64| Tendon {
                arm: moment_arm(radius * paper.thread_length, stops.3),
                rest_length: share * paper.max_length,
            };
            let tendons = [pulley(&first.paper, rest, radius), pulley(&second.paper, other_rest, other)];
            let pair = Pair {
                solenoids: [None, None],
                papers: [first.paper, second.paper],
                limb: Limb { mass, distance, inertia, gravity: GRAVITY, hanging_angle: hanging },
                tendons,
                torque: 0.0,
                damping: 1e-3,
                stops: Stops { ends: [stops.0, stops.1], stiffness: 500.0, damping: stops.2 },
                angle: start.map_or(InitialAngle::Equilibrium, InitialAngle::At),
                angular_velocity: if start.is_some() { speed } else { 0.0 },
            };
            (pair, duration, tolerance)
        },
    )
}
