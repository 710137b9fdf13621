//! Properties of any admissible rig: it comes to its end or says why not, nothing in it is impossible, and its energy closes.
//!
//! The rigs are the same in every run. `MCKIBBEN_SEED` (a number) draws others and `MCKIBBEN_CASES` sets how many; `MCKIBBEN_CASES=20000 cargo test --release --test runs properties::` is a long run.

use crate::common::ATMOSPHERE;
use crate::common::accounts::Audited;
use crate::common::random;
use mckibben::Error;
use mckibben::air::Process;
use mckibben::load::Load;
use mckibben::plant::RigTrajectory;
use mckibben::simulation::simulate;
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use random::{Accounted, Case, cases, falling_power, runner};
use std::cell::RefCell;

/// Rigs that are tried when `MCKIBBEN_CASES` is not set: ten to twenty seconds in the test profile.
const CASES: u32 = 30_000;

fn check_samples(case: &Case, run: &RigTrajectory) -> Result<(), TestCaseError> {
    let paper = &case.paper;
    // Between the pressures that air can come from or go to. With heat from the wall a shut chamber may pass them, and a
    // moving wall compresses: the bound is for both ends held and no heat, where pressure is a rising function of air.
    let heated = matches!(paper.process, Process::EnergyBalance { heat_transfer, .. } if heat_transfer > 0.0);
    let bounded = paper.load == Load::Isometric && !heated;
    let mut sources = vec![paper.gauge + ATMOSPHERE];
    if paper.command.is_some() {
        sources.extend([ATMOSPHERE, paper.supply_gauge + ATMOSPHERE]);
    }
    let (least, most) = sources.iter().fold((f64::MAX, 0.0_f64), |(low, high), p| (low.min(*p), high.max(*p)));
    let room = 20.0 * case.tolerance * ATMOSPHERE.max(most);
    for sample in run.samples(case.duration / 97.0) {
        let numbers = [
            sample.time,
            sample.length,
            sample.velocity,
            sample.pressure.0,
            sample.air_mass,
            sample.temperature,
            sample.volume,
            sample.tension,
            sample.mass_flow,
        ];
        prop_assert!(numbers.iter().all(|number| number.is_finite()), "{sample:?}");
        prop_assert!(sample.air_mass > 0.0 && sample.pressure.0 > 0.0 && sample.temperature > 0.0, "{sample:?}");
        prop_assert!(sample.volume > 0.0 && sample.tension >= 0.0, "{sample:?}");
        prop_assert!(sample.length < paper.thread_length, "{sample:?}");
        if bounded {
            let pressure = sample.pressure.0;
            prop_assert!(pressure > least - room && pressure < most + room, "{pressure} outside {least}..{most}");
        }
    }
    for pair in run.events().windows(2) {
        prop_assert!(pair[0].time <= pair[1].time, "{pair:?}");
    }
    Ok(())
}

/// Where the work of the gas went is accounted for, to the tolerance of each step.
fn check_energy(case: &Case, run: &RigTrajectory) -> Result<(), TestCaseError> {
    let (audit, counts) = (run.audit(), run.statistics());
    let (mass, pull) = match case.paper.load {
        Load::HangingMass { mass, gravity } => (mass, mass * gravity),
        Load::ConstantForce { mass, force } => (mass, force.abs()),
        _ => (0.0, 0.0),
    };
    let [mut gas, mut speed, mut length, mut pressure] = [0.0_f64; 4];
    for sample in run.samples(case.duration / 97.0) {
        gas = gas.max(sample.pressure.0 * sample.volume);
        speed = speed.max(sample.velocity.abs());
        length = length.max(sample.length);
        pressure = pressure.max(sample.pressure.0);
    }
    let accounted = Accounted {
        states: 4,
        steps: (counts.explicit_steps + counts.implicit_steps, case.tolerance),
        energy: audit.turnover() + gas + pull * length + 0.5 * mass * speed * speed,
        falling: (falling_power(run.rig().actuator(), length, pressure), case.duration),
    };
    let (residual, allowed) = (audit.residual(), accounted.allowed());
    prop_assert!(residual.abs() <= allowed, "{residual:e} J, allowed {allowed:e} J: {audit:?} {accounted:?}");
    Ok(())
}

#[test]
fn any_admissible_rig_comes_to_its_end_and_nothing_in_it_is_impossible() {
    let worst: RefCell<Vec<(u64, String)>> = RefCell::new(Vec::new());
    let tried = RefCell::new([0_u32; 3]);
    let result = runner(CASES).run(&cases(), |case| {
        let rig = case.paper.rig();
        let start = match rig.start(&case.paper.initial()) {
            Ok(start) => start,
            // No equilibrium for this load, or a start beyond the thread: said, not guessed.
            Err(Error::NoSolution { .. } | Error::Inconsistent { .. }) => {
                tried.borrow_mut()[0] += 1;
                return Ok(());
            }
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        match (
            simulate(&rig, start, case.duration, case.tolerance),
            simulate(&rig, start, case.duration, case.tolerance),
        ) {
            (Ok(run), Ok(again)) => {
                tried.borrow_mut()[2] += 1;
                check_samples(&case, &run)?;
                check_energy(&case, &run)?;
                // Bit for bit the same: states, events and cost.
                prop_assert_eq!(run.statistics(), again.statistics());
                prop_assert_eq!(run.events(), again.events());
                for (a, b) in run.samples(case.duration / 13.0).zip(again.samples(case.duration / 13.0)) {
                    prop_assert_eq!(a, b);
                }
                let mut worst = worst.borrow_mut();
                let rate = (run.statistics().evaluations as f64 / case.duration) as u64;
                worst.push((
                    rate,
                    format!("{:?} in {} s at {:e}: {:?}", run.statistics(), case.duration, case.tolerance, case.paper),
                ));
                worst.sort_by_key(|(rate, _)| std::cmp::Reverse(*rate));
                worst.truncate(4);
                Ok(())
            }
            // A load heavy and fast enough for the braid to be pulled straight: the one good reason to stop.
            (Err(first), Err(second)) if first == second && first.to_string().contains("straight") => {
                tried.borrow_mut()[1] += 1;
                Ok(())
            }
            (one, other) => Err(TestCaseError::fail(format!(
                "{:?} and {:?}",
                one.map(|r| r.statistics()),
                other.map(|r| r.statistics())
            ))),
        }
    });
    let [no_start, straight, ended] = *tried.borrow();
    println!("{ended} ended, {straight} pulled straight, {no_start} without a start; evaluations a second at worst:");
    for (rate, what) in worst.borrow().iter() {
        println!("{rate}: {what}");
    }
    if let Err(error) = result {
        panic!("{error}");
    }
    assert!(ended > 8 * (no_start + straight) / 10, "too few of the rigs say anything");
}
