//! Fixed steps of plants: the orders of their errors with edges, reversals, limits of the length, stops and tendons inside the
//! steps; true sticking; agreement with the event-located engine for whatever a plant is made of.

use crate::common::tendon::on_tendon;
use crate::common::{GRAVITY, PSI, Paper, assert_within};
use mckibben::friction::Coulomb;
use mckibben::load::{Load, Motion};
use mckibben::mechanism::{Mass, Mechanism, Pull, Spring};
use mckibben::plant::{Plant, PlantRun, PlantSampler, PlantStart, PlantTrajectory, TimeStepping, simulate_plant};
use mckibben::simulation::{EventKind, Method, PressureSeries};
use mckibben::valve::Request;
use std::f64::consts::FRAC_PI_2;

/// The states at the end of so many equal steps.
fn stepped(plant: &Plant, start: &PlantStart, method: Method, duration: f64, steps: u32) -> Vec<f64> {
    let run = PlantRun::new(plant, start, 1e-9).expect("a start");
    let mut steps_of = run.steps(method);
    for index in 1..=steps {
        steps_of.advance_to(duration * f64::from(index) / f64::from(steps)).expect("a step");
    }
    steps_of.state().to_vec()
}

/// The states at the end of an event-located run.
fn located(plant: &Plant, start: &PlantStart, duration: f64) -> Vec<f64> {
    let mut run = PlantRun::new(plant, start, 1e-12).expect("a start");
    run.advance_to(duration).expect("a run");
    run.state().to_vec()
}

/// The usual sizes of the states.
fn sizes(plant: &Plant) -> Vec<f64> {
    let places = plant.indices();
    let mut sizes = vec![0.1; places.states];
    for here in &places.mechanisms {
        (0..here.coordinates).for_each(|k| sizes[here.rate(k)] = 1.0);
    }
    for here in &places.actuators {
        (sizes[here.pressure], sizes[here.mass()]) = (1e5, 1e-4);
        here.bristles.into_iter().for_each(|place| sizes[place] = 1e-3);
    }
    places.nodes.iter().flatten().for_each(|place| sizes[*place] = 1e5);
    places.branches.iter().flatten().for_each(|place| sizes[*place] = 1e-3);
    sizes
}

/// Largest difference of two states, each in units of its usual size.
pub(crate) fn difference(plant: &Plant, ours: &[f64], theirs: &[f64]) -> f64 {
    let parts = ours.iter().zip(theirs).zip(sizes(plant)).map(|((ours, theirs), size)| (ours - theirs).abs() / size);
    parts.fold(0.0, f64::max)
}

/// The slope of a straight line through the logarithms of the errors at so many steps, each number twice the one before.
fn order(plant: &Plant, start: &PlantStart, method: Method, duration: f64, steps: u32) -> f64 {
    let exact = located(plant, start, duration);
    let errors: Vec<f64> = (0..4)
        .map(|halving| difference(plant, &stepped(plant, start, method, duration, steps << halving), &exact))
        .collect();
    eprintln!("{errors:?}");
    assert!(errors.iter().all(|error| *error > 1e-12), "errors have reached rounding: {errors:?}");
    let logs: Vec<f64> = errors.iter().map(|error| error.log2()).collect();
    (3.0 * (logs[0] - logs[3]) + (logs[1] - logs[2])) / 10.0
}

fn as_plant(paper: &Paper) -> (Plant, PlantStart) {
    let rig = paper.rig();
    (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &paper.start()))
}

/// A rig whose flow is choked throughout, so that the rates are smooth between edges: a big volume between a strong
/// supply and the atmosphere, moving between its limits.
fn smooth(coulomb_width: f64) -> Paper {
    Paper::pwm(20.0, 0.5).gauge(45.0 * PSI).friction(3.5, coulomb_width).with(|rig| {
        rig.external_volume = 1e-3;
        rig.supply_gauge = 250.0 * PSI;
        rig.delays = (4.3e-3, 1.1e-3);
    })
}

#[test]
fn rk4_is_of_order_four_with_edges_and_reversals_inside_its_steps() {
    for width in [0.0, 1.1e-4] {
        let (plant, start) = as_plant(&smooth(width));
        let order = order(&plant, &start, Method::Rk4, 0.3, 75);
        assert!((order - 4.0).abs() < 0.15, "width {width}: order {order}");
    }
}

#[test]
fn rk4_keeps_its_order_where_the_braid_comes_taut_and_the_muscle_slack() {
    let heavy = Paper::sealed().mass(4.5).gauge(1e5).from(0.085, 0.0);
    let light = Paper::sealed().mass(0.5).gauge(1e4).friction(3.5, 0.0).from(0.060, 0.5);
    for (paper, name) in [(heavy, "a fall onto the taut braid"), (light, "a muscle that comes tight and then taut")] {
        let (plant, start) = as_plant(&paper);
        let order = order(&plant, &start, Method::Rk4, 0.3, 1500);
        assert!(order > 3.5, "{name}: order {order}");
    }
}

#[test]
fn the_stable_method_is_of_order_two_with_edges_and_reversals_inside_its_steps() {
    for width in [0.0, 1.1e-4] {
        let (plant, start) = as_plant(&smooth(width));
        let order = order(&plant, &start, Method::Stable, 0.3, 300);
        assert!((order - 2.0).abs() < 0.15, "width {width}: order {order}");
    }
}

#[test]
fn the_stable_method_keeps_its_order_where_the_braid_comes_taut_and_the_muscle_slack() {
    let heavy = Paper::sealed().mass(4.5).gauge(1e5).from(0.085, 0.0);
    let light = Paper::sealed().mass(0.5).gauge(1e4).friction(3.5, 0.0).from(0.060, 0.5);
    for (paper, name) in [(heavy, "a fall onto the taut braid"), (light, "a muscle that comes tight and then taut")] {
        let (plant, start) = as_plant(&paper);
        let order = order(&plant, &start, Method::Stable, 0.3, 8000);
        assert!(order > 1.8, "{name}: order {order}");
    }
}

/// A run by fixed steps that is kept has dense output of its method's order, events, and a ledger that closes as far as the steps
/// are exact.
#[test]
fn a_kept_run_is_read_like_one_of_the_other_engine() {
    let (plant, start) = as_plant(&smooth(1.1e-4));
    let exact = simulate_plant(&plant, &start, 0.3, 1e-11).expect("a run");
    let mut misses = Vec::new();
    for (method, step) in [(Method::Rk4, 1e-3), (Method::Rk4, 5e-4), (Method::Stable, 1e-3), (Method::Stable, 5e-4)] {
        let run = simulate_plant(&plant, &start, 0.3, TimeStepping::Fixed { method, step }).expect("a run");
        let times = (0..1000).map(|index| 2.99e-4 * f64::from(index));
        misses.push(times.map(|time| difference(&plant, &run.at(time).0, &exact.at(time).0)).fold(0.0, f64::max));
        let kinds = |of: &PlantTrajectory| -> Vec<_> {
            let seams = [EventKind::Flow, EventKind::Effectiveness, EventKind::Press];
            of.events().iter().map(|event| event.kind).filter(|kind| !seams.contains(&kind.kind)).collect()
        };
        assert_eq!(kinds(&run), kinds(&exact), "{method:?}");
        let counts = run.statistics();
        let steps = if method == Method::Rk4 { counts.explicit_steps } else { counts.implicit_steps };
        assert!(steps >= (0.3 / step) as u64 && counts.events == run.events().len() as u64, "{counts:?}");
        let balance = run.ledger().energy();
        assert!(balance.residual.abs() < 1e-3 * balance.turnover, "{method:?} at {step}: {balance:?}");
    }
    let [rk4, ros2] = [misses[0] / misses[1], misses[2] / misses[3]];
    assert!(rk4 > 12.0 && ros2 > 3.5, "{misses:?}");
}

/// A kept run that is read where a step ends, whatever its rounding, is what steps of a host show there, to the bit.
#[test]
fn samples_at_the_ends_of_steps_are_those_of_steps() {
    let (plant, start) = as_plant(&smooth(1.1e-4));
    for method in [Method::Rk4, Method::Stable] {
        let stepping = TimeStepping::Fixed { method, step: 1e-3 / 3.0 };
        let kept = simulate_plant(&plant, &start, 0.1, stepping).expect("a run");
        let mut steps = PlantRun::new(&plant, &start, stepping).expect("a start").steps(method);
        steps.pass_due().expect("nothing fails");
        let mut sampler = PlantSampler::new(&steps);
        for index in 0..=100 {
            let time = 1e-3 * f64::from(index);
            while time - steps.time() > 1e-9 {
                steps.advance_to(stepping.step_end(steps.time(), 0.1)).expect("a step");
            }
            assert_eq!(*sampler.read(&steps, time), kept.sample(time), "{method:?} at {time} s");
        }
    }
}

/// Steps that are set by a host, saved and restored go on as if nothing had been: bit for bit, and by another engine from there.
#[test]
fn steps_of_a_host_are_saved_restored_and_set() {
    let (plant, start) = as_plant(&smooth(1.1e-4));
    let run = PlantRun::new(&plant, &start, 1e-9).expect("a start");
    let mut steps = run.steps(Method::Stable);
    let drive = |steps: &mut mckibben::plant::PlantSteps, from: u32| {
        for count in from..from + 50 {
            let request = if count % 20 < 10 { Request::Fill } else { Request::Exhaust };
            steps.set(0, request).expect("a request");
            steps.advance_to(1e-3 * f64::from(count + 1)).expect("a step");
        }
    };
    drive(&mut steps, 0);
    let saved = steps.save();
    drive(&mut steps, 50);
    let first = steps.state().to_vec();
    steps.restore(&saved).expect("its own");
    drive(&mut steps, 50);
    assert_eq!(steps.state(), first);
    // A step that fails leaves everything where it was.
    let before = (steps.time(), steps.state().to_vec());
    assert!(steps.advance_to(f64::NAN).is_err() || steps.time() == before.0);
    assert_eq!((steps.time(), steps.state().to_vec()), before);
    let mut located = PlantRun::new(&plant, &start, 1e-9).expect("a start");
    located.restore(&saved).expect("of the same plant");
    located.advance_to(0.06).expect("a run");
    assert!(located.time() == 0.06 && run.time() == 0.0);
}

#[test]
fn a_plant_that_begins_again_has_its_commands_where_they_are_at_that_time() {
    let (plant, start) = as_plant(&Paper::pwm(25.0, 0.5));
    let first = PlantRun::new(&plant, &start, 1e-9).expect("a run");
    let mut at_first = first.clone();
    at_first.advance_to(0.13).expect("a run");
    // Five periods of the pulses later all is as it was.
    let mut again = first.begin_again(&start, 0.2).expect("a run");
    again.advance_to(0.33).expect("a run");
    assert!(difference(&plant, again.state(), at_first.state()) < 1e-6);
    // Within a pulse it is not.
    let mut within = first.begin_again(&start, 0.21).expect("a run");
    within.advance_to(0.34).expect("a run");
    assert!(difference(&plant, within.state(), at_first.state()) > 1e-3);
    assert!(first.begin_again(&start, f64::NAN).is_err());
}

/// A motion and a pressure that are given over time are at the beginning where they are at that time, and so is the mass of air: as in a
/// plant whose motion and pressure begin there.
#[test]
fn a_plant_that_begins_again_has_what_is_given_over_time_where_it_is_then() {
    let begun = |phase: f64, times: [f64; 2], gauges: [f64; 2], again: Option<f64>| {
        let moved = Paper::sealed().with(|rig| {
            let motion = Motion::sinusoid(0.087, 5e-3, 2.0, phase, rig.thread_length).expect("a motion");
            rig.load = Load::Prescribed(motion);
        });
        let given = PressureSeries::new(&times, &gauges).expect("a time series");
        let rigs = [moved.clone().gauge(2e5).rig(), moved.rig().with_pressure(given).expect("a rig")];
        rigs.map(|rig| {
            let start = rig.start(&moved.initial()).expect("a start");
            let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
            let first = PlantRun::new(&plant, &start, 1e-9).expect("a run");
            let run = again.map_or(first.clone(), |time| first.begin_again(&start, time).expect("a run"));
            (plant, run.state().to_vec())
        })
    };
    // A quarter of a period of the motion, and a half of the way of the pressure.
    let again = begun(0.0, [0.0, 0.25], [1e5, 5e5], Some(0.125));
    let there = begun(FRAC_PI_2, [0.0, 0.125], [3e5, 5e5], None);
    for ((plant, again), (_, there)) in again.iter().zip(&there) {
        assert!(difference(plant, again, there) < 1e-12, "{again:?} is not {there:?}");
    }
    // Between the rows of a table.
    let run = |table: [[f64; 2]; 2], again: Option<f64>| {
        let paper = Paper::sealed().with(|rig| {
            let [time, length] = table.map(Vec::from);
            rig.load = Load::Prescribed(Motion::table(time, length, rig.thread_length).expect("a motion"));
        });
        let (plant, start) = as_plant(&paper);
        let first = PlantRun::new(&plant, &start, 1e-9).expect("a run");
        let mut run = again.map_or(first.clone(), |time| first.begin_again(&start, time).expect("a run"));
        run.advance_to(again.unwrap_or(0.0) + 0.2).expect("a run");
        run.state().to_vec()
    };
    let (again, there) = (run([[0.1, 0.5], [0.08, 0.09]], Some(0.3)), run([[0.0, 0.2], [0.085, 0.09]], None));
    let (plant, _) = as_plant(&Paper::sealed());
    assert!(difference(&plant, &again, &there) < 1e-9, "{again:?} is not {there:?}");
}

#[test]
fn a_plant_without_commands_does_what_is_set() {
    let (plant, start) = as_plant(&Paper::pwm(25.0, 0.5));
    let still = plant.without_commands(&[0]);
    let first = PlantRun::new(&still, &start, 1e-9).expect("a run");
    let ends = [0.0, 0.37].map(|time| {
        let mut steps = first.begin_again(&start, time).expect("a run").steps(Method::Rk4);
        steps.set(0, Request::Fill).expect("a request");
        (1..=50).for_each(|step| steps.advance_to(time + f64::from(step) * 1e-3).expect("a step"));
        steps.state().to_vec()
    });
    assert!(difference(&still, &ends[0], &ends[1]) < 1e-9);
    let mut untouched = first;
    untouched.advance_to(0.05).expect("a run");
    let pressure = still.indices().actuators[0].pressure;
    assert!(ends[0][pressure] - untouched.state()[pressure] > 1e4);
}

/// A mass on a spring of which a step is one swing: the steps stay stable, and it comes to rest where its forces balance.
#[test]
fn a_light_mass_on_a_stiff_spring_comes_to_rest() {
    let (paper, start) = as_plant(&Paper::sealed().gauge(1e5).friction(3.5, 0.0));
    let spring = Spring { stiffness: 6e4, rest_length: start.positions[0][0] };
    let mass = Mass::new(2e-3, Pull::Gravity(GRAVITY), Some(spring)).expect("a mass");
    let plant = Plant::new(paper.actuators().to_vec(), paper.network().clone(), vec![Mechanism::Mass(mass)]);
    let plant = plant.expect("a plant");
    let (steps, exact) = (stepped(&plant, &start, Method::Stable, 0.2, 200), located(&plant, &start, 0.2));
    let [position, rate] = [plant.indices().mechanisms[0].position(0), plant.indices().mechanisms[0].rate(0)];
    // What the air has been through in a swing that steps do not resolve stays in its pressure, which moves the balance.
    assert_within(steps[position], exact[position], 1e-5);
    assert!(steps[rate].abs() < 1e-9, "{steps:?}");
}

/// Dry friction that falls with velocity, less than viscous friction grows: an end on a tendon goes on through its stops and
/// break-aways at any pressure, in long steps as with located events.
#[test]
fn an_end_whose_dry_friction_falls_goes_on() {
    for (psi, mass) in [20.0, 40.0, 60.0].into_iter().flat_map(|psi| [1.0, 1.7, 2.4, 3.1].map(|mass| (psi, mass))) {
        let falling = Coulomb::new(1e-4).and_then(|law| law.with_stribeck(1.2, 0.05)).expect("a law");
        let paper = Paper::pwm(25.0, 0.5).gauge(psi * PSI).friction(60.0, 0.0).mass(mass);
        let paper = paper.with(|paper| paper.coulomb = Some(falling));
        let rig = on_tendon(&paper, 1e4);
        let start = rig.start(&paper.initial()).expect("a start");
        let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
        let exact = located(&plant, &start, 0.3);
        let [coarse, fine] =
            [300, 2400].map(|steps| difference(&plant, &stepped(&plant, &start, Method::Stable, 0.3, steps), &exact));
        assert!(coarse < 0.3 && fine < 0.01, "{psi} psi, {mass} kg: {coarse}, {fine}");
    }
}
