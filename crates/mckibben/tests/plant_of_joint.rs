//! The plant of a joint moves as the joint does by the engine of joints.

use crate::common::joint::Pair;
use crate::common::random::runner;
use crate::common::{GRAVITY, PSI, Paper};
use crate::plant_pairs::pairs;
use mckibben::Error;
use mckibben::load::{Limb, Stops};
use mckibben::plant::{Plant, simulate_plant};
use mckibben::simulation::{InitialAngle, JointRig, JointState, simulate_joint};
use proptest::strategy::{Strategy, ValueTree};

fn largest_difference(
    rig: &JointRig,
    start: JointState,
    duration: f64,
    tolerance: f64,
) -> Result<(f64, String), Error> {
    let old = simulate_joint(rig, start, duration, tolerance)?;
    let plant = Plant::of_joint(rig)?;
    let new = simulate_plant(&plant, &Plant::start_of_joint(rig, &start), duration, tolerance)?;
    let mut most: f64 = 0.0;
    let samples: Vec<_> = old.samples(duration / 400.0).collect();
    let range = |of: &dyn Fn(usize) -> f64| {
        let values = (0..samples.len()).map(of);
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        (high - low).max(1e-3 * high.abs()).max(1e-3)
    };
    let angles = range(&|k| samples[k].angle);
    let rates = range(&|k| samples[k].angular_velocity);
    for sample in &samples {
        let (state, _) = new.at(sample.time);
        most = most.max((state[0] - sample.angle).abs() / angles);
        most = most.max((state[1] - sample.angular_velocity).abs() / rates);
        for (i, actuator) in sample.actuators.iter().enumerate() {
            let here = plant.places().actuators[i];
            let pressures = range(&|k| samples[k].actuators[i].pressure.0);
            most = most.max((state[here.pressure] - actuator.pressure.0).abs() / pressures);
        }
    }
    if std::env::var_os("ONLY").is_some() {
        for event in old.events().iter().take(30) {
            println!("old {:.9} {:?}", event.time, event.kind);
        }
        for event in new.events().iter().take(40) {
            println!("new {:.9} {:?}", event.time, event.kind);
        }
        for k in 0..=10 {
            let t = duration * f64::from(k) / 10.0;
            println!("{t:.5} {:?} | {:?}", old.at(t), new.at(t).0);
        }
    }
    Ok((most, format!("{:?} | {:?}", old.counts(), new.statistics())))
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
        let (most, words) = largest_difference(&rig, start, duration, 1e-8).expect(name);
        println!("{name}: {most:.1e} {words}");
        assert!(most < 1e-6, "{name}: {most}");
    }
}

#[test]
fn random_joints() {
    let mut runner = runner(300);
    let (mut worst, mut ran): (f64, u32) = (0.0, 0);
    let mut failures = Vec::new();
    for case in 0..300_usize {
        let (pair, duration, _) = pairs().new_tree(&mut runner).expect("a case").current();
        let Ok(rig) = pair.rig() else { continue };
        if let Some(only) = std::env::var("ONLY").ok().and_then(|only| only.parse::<usize>().ok())
            && only != case
        {
            continue;
        }
        let Ok(start) = rig.start(&pair.initial()) else { continue };
        match largest_difference(&rig, start, duration, 1e-8) {
            Ok((most, words)) => {
                (worst, ran) = (worst.max(most), ran + 1);
                if most > 1e-5 {
                    failures.push(format!("case {case}: {most:.1e} {words}"));
                }
            }
            Err(Error::Stopped { reason, .. }) if reason.ends_with("straight") => {}
            Err(error) => failures.push(format!("case {case}: {error}")),
        }
    }
    println!("worst {worst:.1e} of {ran}");
    for failure in &failures {
        println!("{failure}");
    }
    assert!(failures.is_empty());
}
