//! The plant of a joint moves as the joint does by the engine of joints.

use crate::common::joint::{Pair, pairs};
use crate::common::random::runner;
use crate::common::{GRAVITY, PSI, Paper};
use mckibben::Error;
use mckibben::load::{Limb, Stops};
use mckibben::plant::{Plant, simulate_plant};
use mckibben::simulation::{InitialAngle, JointRig, JointState, simulate_joint};
use proptest::prelude::*;

/// The largest difference in angle, angular velocity and pressures, over the range of each in the run; a joint that hardly
/// moves is measured by a tenth of a radian and of a radian a second, and a pressure by a tenth of the atmosphere.
fn largest_difference(rig: &JointRig, start: JointState, duration: f64, tolerance: f64) -> Result<f64, Error> {
    let old = simulate_joint(rig, start, duration, tolerance)?;
    let plant = Plant::of_joint(rig)?;
    let new = simulate_plant(&plant, &Plant::start_of_joint(rig, &start), duration, tolerance)?;
    let samples: Vec<_> = old.samples(duration / 400.0).collect();
    let states: Vec<_> = samples.iter().map(|sample| new.at(sample.time).0).collect();
    let places = plant.places();
    let of = |read: &dyn Fn(usize) -> [f64; 2], least: f64| {
        let pairs: Vec<[f64; 2]> = (0..samples.len()).map(read).collect();
        let (low, high) = pairs.iter().fold((f64::MAX, f64::MIN), |(low, high), [v, _]| (low.min(*v), high.max(*v)));
        let scale = (high - low).max(least);
        pairs.iter().fold(0.0_f64, |most, [one, other]| most.max((one - other).abs() / scale))
    };
    let mut most = of(&|k| [samples[k].angle, states[k][places.mechanisms[0].position(0)]], 0.1);
    most = most.max(of(&|k| [samples[k].angular_velocity, states[k][places.mechanisms[0].rate(0)]], 0.1));
    for (i, here) in places.actuators.iter().enumerate() {
        most = most.max(of(&|k| [samples[k].actuators[i].pressure.0, states[k][here.pressure]], 1e4));
    }
    Ok(most)
}

#[test]
fn joints_that_swing_and_stick() {
    let swing = Pair::of(Paper::sealed().gauge(40.0 * PSI)).with(|pair| {
        pair.limb = Limb { mass: 0.5, distance: 0.1, inertia: 1e-3, gravity: GRAVITY, hanging_angle: 0.2 };
        pair.angle = InitialAngle::At(0.5);
    });
    let driven = Pair::of(Paper::pwm(25.0, 0.5)).with(|pair| pair.papers[1] = Paper::pwm(25.0, 0.3));
    let stops = driven.clone().with(|pair| {
        pair.stops = Stops { ends: [Some(-0.1), Some(0.15)], stiffness: 500.0, damping: 1.0 };
    });
    for (name, pair, duration) in [("swing", swing, 2.0), ("driven", driven, 0.5), ("stops", stops, 0.5)] {
        let rig = pair.rig().expect(name);
        let start = rig.start(&pair.initial()).expect(name);
        let most = largest_difference(&rig, start, duration, 1e-8).expect(name);
        assert!(most < 1e-6, "{name}: {most}");
    }
}

/// Joints that are tried when `MCKIBBEN_CASES` is not set.
const CASES: u32 = 300;

#[test]
fn random_joints() {
    let ran = std::cell::Cell::new(0);
    let result = runner(CASES).run(&pairs(), |(pair, duration, _)| {
        let Ok(rig) = pair.rig() else { return Ok(()) };
        let Ok(start) = rig.start(&pair.initial()) else { return Ok(()) };
        match largest_difference(&rig, start, duration, 1e-8) {
            Ok(most) => {
                ran.set(ran.get() + 1);
                prop_assert!(most < 1e-4, "{most:e}");
                Ok(())
            }
            Err(Error::Stopped { reason, .. }) if reason.ends_with("straight") => Ok(()),
            Err(error) => Err(TestCaseError::fail(error.to_string())),
        }
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    assert!(ran.get() > CASES / 2, "{} of {CASES} joints ran", ran.get());
}
