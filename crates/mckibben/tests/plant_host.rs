//! The external mechanism, whose ends a host moves: tensions with their derivatives, tendons, friction that holds, a shared
//! bottle, and steps that fail or are only tried.

use crate::common::plants::{external, on_a_bottle, requested};
use crate::common::{ATMOSPHERE, Paper, ROOM, assert_close, assert_within, bisect};
use mckibben::force::{Characteristic, ForceMap, Law, StaticForce};
use mckibben::friction::{BoucWen, Hysteresis, MaxwellSlip};
use mckibben::load::SeriesTendon;
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::network::{Network, NodeKind};
use mckibben::plant::{InitialAir, Mounted, Plant, PlantRun, PlantStart, PlantSteps};
use mckibben::simulation::{Method, PressureSeries};
use mckibben::valve::Request;
use mckibben::{Error, GaugePressure, Response};

const STIFFNESS: f64 = 2e4;
const REST: f64 = 0.05;

/// Actuators whose ends a host moves, without valves.
fn sealed(papers: &[Paper], tendon: Option<SeriesTendon>, mechanism: Mechanism) -> (Plant, PlantStart) {
    let mounted = papers.iter().enumerate().map(|(coordinate, paper)| Mounted {
        actuator: paper.actuator(),
        mechanism: 0,
        coupling: Coupling::Direct { coordinate },
        tendon,
        pressure: None,
    });
    let plant = Plant::new(mounted.collect(), Network::new(&papers[0].air()), vec![mechanism]).expect("a plant");
    let air = |paper: &Paper| InitialAir { gauge_pressure: GaugePressure(paper.gauge), temperature: ROOM };
    let start = PlantStart {
        positions: vec![papers.iter().map(|_| 0.085).collect()],
        rates: vec![vec![0.0; papers.len()]],
        air: papers.iter().map(air).collect(),
        lengths: vec![None; papers.len()],
        ..PlantStart::default()
    };
    (plant, start)
}

fn steps(plant: &Plant, start: &PlantStart) -> PlantSteps {
    PlantRun::new(plant, start, 1e-9).expect("a start").steps(Method::Stable)
}

/// A sealed muscle of 3 bar on a tendon of 20 kN/m and 50 mm, at a length of 85 mm without friction, and its distance.
fn on_tendon(viscous: f64, coulomb: f64) -> (Paper, PlantSteps, f64) {
    let paper = Paper::sealed().friction(viscous, coulomb).gauge(3e5).from(0.085, 0.0);
    let tendon = SeriesTendon::new(STIFFNESS, REST).expect("a tendon");
    let (plant, mut start) = sealed(std::slice::from_ref(&paper), Some(tendon), external(1));
    let distance = 0.085 + REST + paper.actuator().static_force(0.085, ATMOSPHERE + 3e5) / STIFFNESS;
    start.positions = vec![vec![distance]];
    start.lengths = vec![Some(0.085)];
    (paper, steps(&plant, &start), distance)
}

fn length(steps: &PlantSteps) -> f64 {
    steps.sample().actuators[0].length
}

/// What is computed with the ends elsewhere is what a straight move there leads to, for friction whose memory knows no time: back
/// beyond where it turned, on past it, and then standing or turning there.
#[test]
fn hysteresis_elsewhere_is_that_after_a_move_there() {
    let slip = MaxwellSlip::new(&[1e-4, 4e-4, 1e-3], &[0.2, 0.3, 0.1]).expect("elements");
    let bouc_wen = BoucWen::new(3.5e-4, 2000.0, 1000.0).expect("a hysteresis");
    for hysteresis in [Hysteresis::MaxwellSlip(slip), Hysteresis::BoucWen(bouc_wen)] {
        let paper = Paper::sealed().friction(0.0, 1e-4).gauge(3e5).from(0.085, 0.0);
        let paper = paper.with(|rig| rig.hysteresis = Some(hysteresis));
        let (plant, start) = sealed(std::slice::from_ref(&paper), None, external(1));
        let mut mounted = plant.actuators().to_vec();
        mounted[0].pressure = PressureSeries::new(&[0.0], &[3e5]).ok();
        let plant = Plant::new(mounted, plant.network().clone(), vec![external(1)]).expect("a plant");
        for before in [0.085, 0.0853, 0.0848] {
            let mut here = steps(&plant, &start);
            here.move_to(0.1, &[before]).expect("a step");
            for target in [0.0835, 0.0845, 0.08495, 0.0851, 0.0854, 0.086] {
                let mut moved = here.clone();
                moved.move_to(0.2, &[target]).expect("a step");
                for rate in [-0.01, 0.0, 0.01] {
                    let [mut expected, mut found] = [[Response::default()]; 2];
                    moved.compute_at(&[target], &[rate], &mut expected).expect("a response");
                    here.compute_at(&[target], &[rate], &mut found).expect("a response");
                    let [expected, found] = [expected[0].tension, found[0].tension];
                    assert!(
                        (found - expected).abs() < 1e-6 * expected,
                        "{before} to {target} at {rate}: {found} for {expected}"
                    );
                }
            }
        }
    }
}

/// Ends that jump over pieces of a measured law take the piece where they are: without friction a tension is that of the law, as near
/// the start as far from it. The piece of the start, continued to there, may push.
#[test]
fn ends_that_jump_take_the_piece_of_a_map_where_they_are() {
    let paper = Paper::sealed().friction(0.0, 0.0).gauge(2.57e5).from(0.084, 0.0);
    let tensions = [0.0, 0.0, 0.0, 2.0, 0.0, 5.0, 10.0, 30.0, 0.0, 20.0, 40.0, 90.0];
    let map = ForceMap::new(&[0.0, 1e5, 3e5], &[0.07, 0.076, 0.08, 0.087], &tensions).expect("a map");
    let law = Characteristic::new(paper.braid(), Law::Map(map.clone()));
    let paper = paper.with(|rig| rig.characteristic = Some(law));
    let (plant, mut start) = sealed(std::slice::from_ref(&paper), None, external(1));
    start.positions = vec![vec![0.084]];
    let mut here = steps(&plant, &start);
    for length in [0.0705, 0.0735, 0.075, 0.078, 0.0835, 0.086] {
        let mut response = [Response::default()];
        here.compute_at(&[length], &[0.0], &mut response).expect("a response");
        let expected = map.force(length, GaugePressure(2.57e5));
        assert!(expected > 1.0);
        assert_close(response[0].tension, expected, 1e-9);
    }
}

/// The tension is the law's, and its derivatives are differences of the law; the sealed air follows `P V^γ`.
#[test]
fn the_tension_of_a_sealed_actuator_and_its_derivatives_are_those_of_its_law() {
    let paper = Paper::sealed().friction(50.0, 0.0).gauge(3e5).from(0.085, 0.0);
    let (plant, start) = sealed(std::slice::from_ref(&paper), None, external(1));
    let mut steps = steps(&plant, &start);
    let actuator = paper.actuator();
    let gas = (ATMOSPHERE + 3e5) * actuator.volume(0.085_f64).powf(1.4);
    let mut before = 0.085;
    for count in 1..=200 {
        let time = 1e-3 * f64::from(count);
        let distance = 0.085 + 2e-3 * (20.0 * time).sin();
        steps.move_to(time, &[distance]).expect("a step");
        let velocity = (distance - before) / 1e-3;
        before = distance;
        let here = steps.compute(0).expect("an actuator");
        let pressure = steps.state()[plant.indices().actuators[0].pressure];
        // Second order in the step: within 10⁻⁵ of the closed form.
        assert_close(pressure, gas / actuator.volume(distance).powf(1.4), 1e-5);
        let force =
            |length: f64, velocity: f64, pressure: f64| actuator.static_force(length, pressure) + 50.0 * velocity;
        assert_close(here.tension, force(distance, velocity, pressure), 1e-9);
        let slope = |function: &dyn Fn(f64) -> f64, step: f64| (function(step) - function(-step)) / (2.0 * step);
        assert_close(here.per_length, slope(&|d| force(distance + d, velocity, pressure), 1e-6), 1e-6);
        assert_close(here.per_velocity, 50.0, 1e-9);
        assert_close(here.per_pressure, slope(&|d| force(distance, velocity, pressure + d), 10.0), 1e-6);
    }
}

#[test]
fn both_springs_share_what_the_ends_are_moved() {
    const STEPS: i32 = 20;
    let (paper, mut pulled, from) = on_tendon(0.0, 0.0);
    let (actuator, pressure) = (paper.actuator(), ATMOSPHERE + 3e5);
    assert_close(pulled.compute(0).expect("one").tension, actuator.static_force(0.085, pressure), 1e-9);
    let mut begin = from;
    for (visit, change) in [(0, 2e-3), (1, -4e-3), (2, 1e-3)] {
        for step in 1..=STEPS {
            let time = f64::from(visit * STEPS + step) * 1e-3;
            let distance = begin + (from + change - begin) * f64::from(step) / f64::from(STEPS);
            pulled.move_to(time, &[distance]).expect("a step");
        }
        begin = from + change;
        // P V^γ of the sealed air, and equal tensions.
        let gas = pressure * actuator.volume(0.085_f64).powf(1.4);
        let tension = |length: f64| actuator.static_force(length, gas / actuator.volume(length).powf(1.4));
        let balance = bisect(0.07, 0.1, |length| tension(length) - STIFFNESS * (begin - REST - length));
        // The pressure follows the volume by the stable method, of order 2 in the motion of a step.
        assert_within(length(&pulled), balance, 5e-7);
        let here = pulled.compute(0).expect("one");
        assert_close(here.tension, STIFFNESS * (begin - REST - length(&pulled)), 1e-9);
        assert_eq!([here.per_length, here.per_velocity, here.per_pressure], [STIFFNESS, 0.0, 0.0]);
    }
}

#[test]
fn dry_friction_holds_the_actuator_while_the_tendon_gives() {
    let (paper, mut pulled, from) = on_tendon(1.0, 4e-4);
    let friction = paper.actuator().coulomb_bound(0.085, ATMOSPHERE + 3e5);
    let tension = pulled.compute(0).expect("one").tension;
    for (step, part) in [0.5, -0.5, 0.9, 0.0].into_iter().enumerate() {
        let change = part * friction / STIFFNESS;
        pulled.move_to((step + 1) as f64 * 1e-3, &[from + change]).expect("a step");
        assert_within(length(&pulled), 0.085, 1e-12);
        assert_within(pulled.compute(0).expect("one").tension - tension, STIFFNESS * change, 1e-6);
    }
    pulled.move_to(5e-3, &[from + 1.5 * friction / STIFFNESS]).expect("a step");
    assert!(length(&pulled) > 0.085 + 1e-6);
}

/// A linear relaxation, `e^{−(k + k_own) t/c}`, to the nonlinearity of a micrometre; the error falls with the square of the step.
#[test]
fn a_viscous_actuator_relaxes_at_the_rate_of_both_springs_on_its_damper() {
    let (viscous, change) = (500.0, 1e-6);
    let (paper, mut moved, distance) = on_tendon(viscous, 0.0);
    let own = paper.actuator().sealed_stiffness(0.085, mckibben::AbsolutePressure(ATMOSPHERE + 3e5));
    let (rate, duration, share) = ((STIFFNESS + own) / viscous, 0.02, STIFFNESS / (STIFFNESS + own));
    // A ramp of a microsecond, and then at rest.
    moved.move_to(1e-6, &[distance + change]).expect("a step");
    let begun = moved.save();
    let mut lag = |count: u32| {
        moved.restore(&begun).expect("the same plant");
        for step in 1..=count {
            let time = 1e-6 + duration * f64::from(step) / f64::from(count);
            moved.move_to(time, &[distance + change]).expect("a step");
        }
        1.0 - (length(&moved) - 0.085) / (share * change)
    };
    let exact = (-rate * (duration + 0.5e-6)).exp();
    assert_within(lag(320), exact, 1e-3);
    let finest = lag(1280);
    let order = ((lag(20) - finest) / (lag(80) - finest)).abs().log2() / 2.0;
    assert!((1.7..2.3).contains(&order), "{order}");
}

#[test]
fn a_tendon_that_is_let_go_hangs_loose() {
    let (paper, mut pulled, _) = on_tendon(5.0, 0.0);
    pulled.move_to(0.2, &[REST + 0.5 * paper.balance(0.0)]).expect("a step");
    let here = pulled.compute(0).expect("one");
    assert_eq!([here.tension, here.per_length], [0.0, 0.0]);
}

fn driven(steps: &mut PlantSteps, from: i32, until: i32) {
    for count in from..until {
        let (commands, distances) = requested(count);
        for (valve, command) in commands.into_iter().flatten().enumerate() {
            steps.set(valve, command).expect("a demand");
        }
        steps.move_to(f64::from(count + 1) * 1e-3, &distances).expect("a step");
    }
}

/// The event-located run of an equal motion is met, and what is restored goes on to the same bits.
#[test]
fn actuators_on_one_bottle_are_one_system() {
    let (plant, start, bottle) = on_a_bottle();
    let mut host = steps(&plant, &start);
    driven(&mut host, 0, 100);
    let there = host.save();
    driven(&mut host, 100, 200);
    let end = host.save();
    driven(&mut host, 200, 300);
    host.restore(&there).expect("the same plant");
    driven(&mut host, 100, 200);
    assert_eq!(host.state(), end.state());

    let mut run = PlantRun::new(&plant, &start, 1e-10).expect("a run");
    let mut before = [0.085, 0.088];
    for count in 0..200 {
        let (commands, distances) = requested(count);
        for (valve, command) in commands.into_iter().flatten().enumerate() {
            run.set(valve, command).expect("a demand");
        }
        let rates = [0, 1].map(|k| (distances[k] - before[k]) / 1e-3);
        before = distances;
        run.set_rates(0, &rates).expect("rates");
        run.advance_to(f64::from(count + 1) * 1e-3).expect("on");
    }
    let places = plant.indices();
    let tank = places.nodes[bottle].expect("a state");
    assert!(run.state()[tank] < ATMOSPHERE + 6.8e5, "the bottle sags");
    let error = |parts: f64| {
        let mut host = steps(&plant, &start);
        host.limit_step(1e-3 / parts).expect("a length");
        driven(&mut host, 0, 200);
        let pressures = places.actuators.iter().map(|here| here.pressure).chain([tank]);
        let all = pressures.chain([places.mechanisms[1].position(0)]);
        all.map(|k| (host.state()[k] / run.state()[k] - 1.0).abs()).fold(0.0, f64::max)
    };
    let errors = [1.0, 4.0, 16.0].map(error);
    // Where a chamber has nearly the bottle's pressure it is stiff, and the order less than two.
    assert!(errors[1] < errors[0] / 3.0 && errors[2] < errors[1] / 6.0 && errors[2] < 2e-4, "{errors:?}");
}

/// Valves that only fill let nothing out: bottle and chambers hold the air that was there, wherever it has gone.
#[test]
fn no_air_is_lost_between_the_bottle_and_what_it_fills() {
    let (plant, start, bottle) = on_a_bottle();
    let mut host = steps(&plant, &start);
    let places = plant.indices();
    let tank = places.nodes[bottle].expect("a state");
    let NodeKind::Reservoir(reservoir) = &plant.network().nodes[bottle].kind else { panic!("it is a bottle") };
    // What a unit of air adds to the pressure of the bottle is a constant.
    let per_mass = reservoir.pressure_rate(1.0);
    let content =
        |state: &[f64]| state[tank] / per_mass + places.actuators.iter().map(|here| state[here.mass()]).sum::<f64>();
    let (all, full) = (content(host.state()), host.state()[tank]);
    for valve in 0..3 {
        host.set(valve, Request::Fill).expect("a request");
    }
    for count in 1..=300 {
        let (_, distances) = requested(count - 1);
        host.move_to(f64::from(count) * 1e-3, &distances).expect("a step");
        assert_close(content(host.state()), all, 1e-12);
    }
    assert!(host.state()[tank] < full - 2e4, "the bottle has given air");
}

/// A rest distance is the longest at which an actuator on its tendon does not pull.
#[test]
fn an_actuator_does_not_pull_up_to_its_rest_distance() {
    let (paper, tendon) = (Paper::sealed().gauge(2e5), SeriesTendon::new(5e4, 0.04).expect("a tendon"));
    let (plant, mut start) = sealed(&[paper], Some(tendon), external(1));
    start.lengths = vec![None];
    let rest = plant.rest_distance(0, GaugePressure(2e5)).expect("a distance");
    for (beyond, pulls) in [(-1e-4, false), (1e-4, true)] {
        start.positions = vec![vec![rest + beyond]];
        let tension = steps(&plant, &start).compute(0).expect("one").tension;
        assert_eq!(tension > 0.0, pulls, "{tension} N at {beyond} m beyond");
    }
    let bare = Plant::new(
        vec![Mounted { tendon: None, ..plant.actuators()[0].clone() }],
        plant.network().clone(),
        vec![external(1)],
    );
    let alone = bare.expect("a plant").rest_distance(0, GaugePressure(2e5)).expect("a length");
    assert_close(rest - alone, 0.04, 1e-12);
    assert!(matches!(plant.rest_distance(1, GaugePressure(2e5)), Err(Error::Misuse { .. })));
    assert!(plant.rest_distance(0, GaugePressure(-2e5)).is_err(), "no air has less than no pressure");
}

/// A host repeats the motion of a free run: the air is that of the run.
#[test]
fn any_plant_becomes_one_whose_ends_a_host_moves() {
    let (plant, start, bottle) = on_a_bottle();
    let mut run = PlantRun::new(&plant, &start, 1e-10).expect("a run");
    run.set(2, Request::Fill).expect("a request");
    let (ours, of_host) = plant.to_external(&start).expect("a plant");
    assert_eq!(of_host.positions, vec![vec![0.085, 0.088, 0.086]]);
    let mut host = steps(&ours, &of_host);
    host.set(2, Request::Fill).expect("a request");
    for count in 1..=2000 {
        let time = 1e-4 * f64::from(count);
        run.advance_to(time).expect("on");
        let distance = run.state()[plant.indices().mechanisms[1].position(0)];
        host.move_to(time, &[0.085, 0.088, distance]).expect("a step");
    }
    let pressures = |plant: &Plant, state: &[f64]| {
        [state[plant.indices().actuators[2].pressure], state[plant.indices().nodes[bottle].expect("a state")]]
    };
    let (found, exact) = (pressures(&ours, host.state()), pressures(&plant, run.state()));
    let lifted = run.state()[plant.indices().mechanisms[1].position(0)];
    assert!((lifted - 0.086).abs() > 1e-3, "it moves to {lifted}");
    for (found, exact) in found.into_iter().zip(exact) {
        assert_close(found, exact, 1e-4);
    }
}

/// Moves that are divided have the air of a host with short steps.
#[test]
fn a_long_move_in_parts_is_many_short_ones() {
    let (plant, start, _) = on_a_bottle();
    let [mut long, mut short] = [(); 2].map(|()| steps(&plant, &start));
    long.limit_step(1e-3).expect("a length");
    for host in [&mut long, &mut short] {
        host.set(0, Request::Fill).expect("a request");
    }
    long.move_to(8e-3, &[0.087, 0.084]).expect("a step");
    for part in 1..=8 {
        let along = f64::from(part) / 8.0;
        short.move_to(8e-3 * along, &[0.085 + 2e-3 * along, 0.088 - 4e-3 * along]).expect("a step");
    }
    for (ours, theirs) in long.state().iter().zip(short.state()) {
        assert_within(*ours, *theirs, 1e-9 * theirs.abs() + 1e-12);
    }
    assert!(long.limit_step(0.0).is_err());
    long.limit_step(1e-9).expect("a length");
    assert!(matches!(long.move_to(1.0, &[0.087, 0.084]), Err(Error::Misuse { .. })));
}

#[test]
fn what_cannot_be_is_named_and_changes_nothing() {
    let (plant, start, _) = on_a_bottle();
    let mut host = steps(&plant, &start);
    driven(&mut host, 0, 30);
    let (before, tension) = (host.save(), host.compute(1).expect("one").tension);
    assert!(matches!(host.move_to(0.03, &[0.085, 0.088]), Err(Error::Misuse { .. })));
    assert!(matches!(host.move_to(f64::NAN, &[0.085, 0.088]), Err(Error::OutOfRange { .. })));
    assert!(matches!(host.move_to(f64::INFINITY, &[0.085, 0.088]), Err(Error::OutOfRange { .. })));
    assert!(matches!(host.move_to(0.031, &[0.085]), Err(Error::Table { entry: 2, .. })));
    assert!(matches!(host.move_to(0.031, &[0.085, 0.088, 0.09]), Err(Error::Table { entry: 3, .. })));
    assert!(matches!(host.move_to(0.031, &[f64::NAN, 0.088]), Err(Error::OutOfRange { .. })));
    assert!(matches!(host.compute(3), Err(Error::Misuse { .. })));
    // Longer than its threads.
    assert!(matches!(host.move_to(0.031, &[0.5, 0.088]), Err(Error::Stopped { .. })));
    assert_eq!((host.time(), host.state()), (before.time(), before.state()));
    assert_eq!(host.compute(1).expect("one").tension, tension);
}
