//! Random plants reach their end, close, converge, and go on from numbers.

use crate::common::random::runner;
use crate::common::random_plants::{Drawn, drawn, numbered, plant};
use mckibben::Error;
use mckibben::mechanism::Mechanism;
use mckibben::plant::{Plant, PlantRun, PlantStart, PlantTrajectory, TimeStepping, simulate_plant};
use mckibben::simulation::Method;
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// Plants that are tried. `MCKIBBEN_CASES` and `MCKIBBEN_SEED` set their number and seed: 5000 take some minutes.
const CASES: u32 = 300;
/// Steps and events that a run may take beyond those of its pulses.
const MOST_STEPS: u64 = 200_000;

/// Whether physics ends a run: a load that pulls a braid straight, what no braid can follow, or a reservoir without air.
fn is_physics(reason: &str) -> bool {
    reason.ends_with("straight")
        || reason.starts_with("dry friction falls with velocity")
        || reason.starts_with("the end of an actuator on a tendon jumps")
        || reason.starts_with("a regulator draws its reservoir empty")
}

fn check(run: &PlantTrajectory, duration: f64) -> Result<(), TestCaseError> {
    let counts = run.statistics();
    let steps = counts.explicit_steps + counts.implicit_steps + counts.rejected_steps + counts.events;
    prop_assert!(steps < MOST_STEPS, "{counts:?} in {duration} s");
    for sample in run.samples(duration / 23.0) {
        for one in &sample.actuators {
            let numbers = [one.distance, one.rate, one.velocity, one.mass_flow, one.heat_flow, one.tension];
            prop_assert!(numbers.iter().all(|number| number.is_finite()), "{one:?}");
            let above = [one.length, one.pressure.0, one.air_mass, one.temperature, one.volume];
            prop_assert!(above.iter().all(|number| number.is_finite() && *number > 0.0), "{one:?}");
            prop_assert!(one.tension >= 0.0 && one.bristles.is_none_or(f64::is_finite), "{one:?}");
        }
        for one in &sample.mechanisms {
            let mut numbers = one.position.iter().chain(&one.rate).chain(&one.acceleration).chain(&one.actuator_force);
            prop_assert!(numbers.all(|number| number.is_finite()), "{one:?}");
        }
        for one in &sample.nodes {
            prop_assert!(one.pressure.0 > 0.0 && one.pressure.0.is_finite(), "{one:?}");
            prop_assert!(one.air_mass >= 0.0 && one.mass_flow.is_finite() && one.temperature > 0.0, "{one:?}");
        }
        prop_assert!(sample.branches.iter().all(|one| one.mass_flow.is_finite()), "{:?}", sample.branches);
    }
    let ledger = run.ledger();
    let sums =
        [("work", ledger.work()), ("energy", ledger.energy()), ("exergy", ledger.exergy()), ("air", ledger.air())];
    for (sum, balance) in sums {
        let numbers = [balance.residual, balance.turnover, balance.rounding, balance.resolution];
        prop_assert!(numbers.iter().all(|number| number.is_finite()), "{sum}: {balance:?}");
        prop_assert!(balance.closes(1e-6), "{sum} leaves {:e}: {balance:?} of {ledger:?}", balance.imbalance());
    }
    Ok(())
}

/// Runs to its end or to where physics ends it; whether it ran at all.
fn runs(drawn: &Drawn) -> Result<bool, TestCaseError> {
    let (plant, start, duration) = plant(drawn);
    let Ok(plant) = plant else { return Ok(false) };
    match simulate_plant(&plant, &start, duration, 1e-8) {
        Ok(run) => check(&run, duration).map(|()| true),
        Err(Error::Stopped { reason, .. }) if is_physics(reason) => Ok(true),
        Err(error @ Error::Stopped { .. }) => Err(TestCaseError::fail(error.to_string())),
        // A start that the plant cannot have.
        Err(_) => Ok(false),
    }
}

#[test]
fn random_plants_reach_their_end_and_close() {
    let ran = std::cell::Cell::new((0, 0));
    let result = runner(CASES).run(&drawn(), |drawn| {
        let (count, tried) = ran.get();
        let it_ran = runs(&drawn)?;
        ran.set((count + u32::from(it_ran), tried + 1));
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    let (count, tried) = ran.get();
    assert!(2 * count > tried, "{count} of {tried} plants ran");
}

/// An end without a mass or viscous friction that hysteresis holds starts where all of that balances, at the pressure of its air.
#[test]
fn an_end_starts_where_its_hysteresis_balances() {
    let (plant, start, duration) = plant(&numbered(20_080));
    let plant = plant.expect("a plant");
    let run = simulate_plant(&plant, &start, duration, 1e-8).expect("a run");
    let [here, given] = [run.sample(0.0).actuators[4].pressure.0, start.air[4].gauge_pressure.0];
    assert!((here - 101_325.0 - given).abs() < 1e-6 * given, "{here} of {given}");
    check(&run, duration).unwrap_or_else(|error| panic!("{error}"));
}

/// An end without a mass or viscous friction that nothing holds any more jumps, and no ledger knows where its work goes: the run
/// says so. One rebounds from its end length with its tendon loose, the other leaves a stop that the braid pushes away from.
/// What a load has pulled straight says that too, though its last air resists.
#[test]
fn what_cannot_go_on_says_why() {
    let expected = [
        (20_854, "the end of an actuator on a tendon jumps: nothing holds it"),
        (20_393, "the end of an actuator on a tendon jumps: nothing holds it"),
        (21_242, "the load pulled a braid straight"),
    ];
    for (number, expected) in expected {
        let (plant, start, duration) = plant(&numbered(number));
        match simulate_plant(&plant.expect("a plant"), &start, duration, 1e-8) {
            Err(Error::Stopped { reason, .. }) => assert!(reason.starts_with(expected), "{number}: {reason}"),
            other => panic!("{number}: {:?}", other.map(|run| run.statistics())),
        }
    }
}

/// Plants of which some air comes to rest a hundred times faster at the end of a step than at its beginning: the implicit method takes
/// over, where the explicit one would have a part of its steps refused, in millions of them.
#[test]
fn air_that_settles_at_once_takes_few_steps() {
    for number in [2663_u64, 2780, 11_290] {
        let (plant, start, duration) = plant(&numbered(number));
        let run = simulate_plant(&plant.expect("a plant"), &start, duration, 1e-8).expect("a run");
        let counts = run.statistics();
        assert!(counts.explicit_steps + counts.implicit_steps + counts.rejected_steps < 30_000, "{number}: {counts:?}");
        check(&run, duration).unwrap_or_else(|error| panic!("{number}: {error}"));
    }
}

/// An actuator with bristles on a limb of two joints comes to rest, where it holds nothing, and turns once: where it heads follows from
/// its acceleration, not from what rounding leaves of its rate.
#[test]
fn an_actuator_that_comes_to_rest_on_a_limb_turns_once() {
    let (plant, start, duration) = plant(&numbered(792));
    let run = simulate_plant(&plant.expect("a plant"), &start, duration, 1e-7).expect("a run");
    assert!(run.statistics().events < 1000, "{:?}", run.statistics());
}

/// Plants whose air is stiff through a tendon or the wall's heat: at a host's millisecond their pressures stay near those of
/// the event-located engine.
#[test]
fn stiff_air_stays_near_located_events_at_one_millisecond() {
    for number in [120, 609, 756] {
        let (plant, start, duration) = plant(&numbered(number));
        let plant = plant.expect("a plant");
        let exact = simulate_plant(&plant, &start, duration, 1e-7).expect("a run");
        let mut run = PlantRun::new(&plant, &start, 1e-9).expect("a start").steps(Method::Stable);
        for step in 1..=(duration / 1e-3) as u32 {
            run.advance_to(1e-3 * f64::from(step)).unwrap_or_else(|error| panic!("{number}: {error}"));
            let sample = exact.sample(run.time());
            for (one, here) in sample.actuators.iter().zip(&plant.indices().actuators) {
                let (found, pressure) = (run.state()[here.pressure], one.pressure.0);
                assert!((found - pressure).abs() < 0.3 * pressure, "{number} at {step} ms: {found}, {pressure}");
            }
        }
    }
}

/// Fixed steps of random plants that the event-located engine brings to their end.
const STEPPED: u32 = 60;

/// The largest difference of the states at the end from those of the event-located engine, with steps of a length in s; none where
/// the steps stop.
fn miss(of: (&Plant, &PlantStart, f64), exact: &[f64], method: Method, step: f64) -> Option<f64> {
    let (plant, start, duration) = of;
    let mut run = PlantRun::new(plant, start, TimeStepping::Fixed { method, step }).expect("a start");
    run.advance_to(duration).ok()?;
    let miss = crate::plant_steps::difference(plant, run.state(), exact);
    assert!(miss.is_finite(), "{method:?}, {step} s: {miss}");
    Some(miss)
}

/// Whatever a plant is made of, ROS2 takes it to its end at the millisecond of a host, and both methods come nearer to the
/// event-located engine as the steps shorten. Waves in short hoses and bristles take far shorter steps than these to be resolved:
/// they are why not all converge here.
#[test]
fn random_plants_converge_at_fixed_steps() {
    let counts = std::cell::Cell::new([0; 4]);
    let result = runner(STEPPED).run(&drawn(), |drawn| {
        let (plant, start, duration) = plant(&drawn);
        let Ok(plant) = plant else { return Ok(()) };
        let Ok(mut exact) = PlantRun::new(&plant, &start, 1e-9) else { return Ok(()) };
        let Ok(()) = exact.advance_to(duration) else { return Ok(()) };
        let of = (&plant, &start, duration);
        let at_host = miss(of, exact.state(), Method::Stable, 1e-3).is_some();
        let [coarse, fine] = [3.2e-5, 8e-6].map(|step| miss(of, exact.state(), Method::Stable, step));
        let ros2 = coarse.zip(fine).is_some_and(|(coarse, fine)| fine < 1e-6 || fine < 0.4 * coarse);
        let rk4 = miss(of, exact.state(), Method::Rk4, 4e-6).is_some_and(|miss| miss < 1e-3);
        let [all, reach, second, fourth] = counts.get();
        counts.set([all + 1, reach + u32::from(at_host), second + u32::from(ros2), fourth + u32::from(rk4)]);
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    let [all, reach, second, fourth] = counts.get();
    assert!(all > 0, "no plant ran");
    let share = |count: u32| f64::from(count) / f64::from(all);
    let shares = [share(reach), share(second), share(fourth)];
    assert!(shares[0] > 0.98 && shares[1] > 0.85 && shares[2] > 0.85, "{shares:?} of {all}");
}

/// Whatever a plant is made of, what has gone through numbers goes on to the same bits.
#[test]
fn random_plants_go_on_from_numbers_to_the_same_bits() {
    let count = std::cell::Cell::new([0; 2]);
    let result = runner(STEPPED).run(&drawn(), |drawn| {
        let [ran, tried] = count.get();
        count.set([ran, tried + 1]);
        let (plant, start, _) = plant(&drawn);
        let Ok(plant) = plant else { return Ok(()) };
        let Ok(run) = PlantRun::new(&plant, &start, 1e-9) else { return Ok(()) };
        let mut one = run.steps(Method::Stable);
        let mut other = one.clone();
        let mut numbers = vec![0.0; one.state_size()];
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        for step in 1..=60 {
            one.save_to(&mut numbers).expect("a state");
            let until = 1e-3 * f64::from(step);
            if other.restore_from(&numbers).is_err() {
                // Ends that a host would move, which here go on as they began, have met.
                let mut mechanisms = plant.mechanisms().iter().zip(&plant.indices().mechanisms);
                let met = mechanisms.any(|(mechanism, its)| {
                    matches!(mechanism, Mechanism::External { .. })
                        && (0..its.coordinates).any(|k| one.state()[its.position(k)] <= 0.0)
                });
                prop_assert!(met, "step {}", step);
                break;
            }
            let (went, follows) = (one.advance_to(until), other.advance_to(until));
            prop_assert_eq!(&went, &follows);
            prop_assert_eq!(bits(one.state()), bits(other.state()), "after step {}", step);
            if went.is_err() {
                break;
            }
        }
        count.set([ran + 1, tried + 1]);
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    let [ran, tried] = count.get();
    assert!(2 * ran > tried, "{ran} plants of {tried} ran");
}
