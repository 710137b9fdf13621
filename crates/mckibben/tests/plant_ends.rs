//! Where ends may start: lengths that an actuator can have, and ends on tendons, which have no mass.

use crate::common::{ATMOSPHERE, INCH, Paper, ROOM, assert_within};
use mckibben::force::{Characteristic, Law, MartensBoblan};
use mckibben::friction::Coulomb;
use mckibben::load::SeriesTendon;
use mckibben::mechanism::{Attachment, Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute};
use mckibben::network::Network;
use mckibben::plant::{InitialAir, Mounted, Part, Plant, PlantEventKind, PlantRun, PlantStart, simulate_plant};
use mckibben::simulation::{EventKind, Method};
use mckibben::{Error, GaugePressure};
use std::f64::consts::PI;

const STIFFNESS: f64 = 2e4;
const REST: f64 = 0.05;
const GAUGE: f64 = 3e5;

/// A sealed muscle on a weight, over a tendon if there is one, that starts at a distance in m.
fn on_a_weight(paper: &Paper, has_tendon: bool, distance: f64, length: Option<f64>) -> (Plant, PlantStart) {
    let mounted = Mounted {
        actuator: paper.actuator(),
        mechanism: 0,
        coupling: Coupling::Direct { coordinate: 0 },
        tendon: has_tendon.then(|| SeriesTendon::new(STIFFNESS, REST).expect("a tendon")),
        pressure: None,
    };
    let weight = Mechanism::Mass(Mass::new(2.0, Pull::Force(30.0), None).expect("a mass"));
    let plant = Plant::new(vec![mounted], Network::new(&paper.air()), vec![weight]).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![distance]],
        rates: vec![vec![0.0]],
        air: vec![InitialAir { gauge_pressure: GaugePressure(GAUGE), temperature: ROOM }],
        lengths: vec![length],
        ..PlantStart::default()
    };
    (plant, start)
}

fn refusal((plant, start): (Plant, PlantStart)) -> String {
    let error: Error = simulate_plant(&plant, &start, 0.01, 1e-8).expect_err("it is refused");
    assert!(!matches!(error, Error::Stopped { .. }), "{error}");
    error.to_string()
}

#[test]
fn no_actuator_starts_longer_than_its_threads() {
    let paper = Paper::sealed();
    let error = refusal(on_a_weight(&paper, false, 1.1 * paper.thread_length, None));
    assert!(error.contains("initial.length") && error.contains("actuator.thread_length"), "{error}");
}

/// By (3), `P_g (3 L² − b²)/(4πn²) = k (x − ℓ − L)`.
#[test]
fn an_end_without_a_length_starts_where_both_tensions_are_equal() {
    let paper = Paper::sealed().friction(0.0, 0.0);
    let distance = REST + 3.7 * INCH;
    let (plant, start) = on_a_weight(&paper, true, distance, None);
    let state = plant.start(&start).expect("a start");
    let here = plant.indices().actuators[0];
    let length = state[here.length.expect("a state")];
    let (b, n) = (paper.thread_length, paper.turns);
    let gauge = state[here.pressure] - ATMOSPHERE;
    let pull = gauge * (3.0 * length * length - b * b) / (4.0 * PI * n * n);
    assert!(pull > 10.0, "{pull} N at {length} m");
    assert_within(STIFFNESS * (distance - REST - length), pull, 1e-8 * pull);
    simulate_plant(&plant, &start, 0.05, 1e-8).expect("a run");
}

/// Without viscous friction an end that is out of balance would jump.
#[test]
fn an_end_out_of_balance_needs_viscous_friction() {
    let (distance, length) = (REST + 3.7 * INCH, Some(3.4 * INCH));
    let error = refusal(on_a_weight(&Paper::sealed().friction(0.0, 0.0), true, distance, length));
    assert!(error.contains("initial.length") && error.contains("viscous"), "{error}");
    let (plant, start) = on_a_weight(&Paper::sealed().friction(5.0, 0.0), true, distance, length);
    simulate_plant(&plant, &start, 0.01, 1e-8).expect("a run");
}

/// A force F_c that falls by `(ρ − 1) exp(−(v/v_s)²)` falls at most by `√(2/e) (ρ − 1) F_c/v_s`.
#[test]
fn falling_friction_on_a_tendon_needs_the_viscous_one_that_outweighs_it() {
    let (force, excess, velocity) = (4.0, 0.5, 0.02);
    let least = (2.0 / 1.0_f64.exp()).sqrt() * excess * force / velocity;
    let with = |viscous: f64| {
        let law = Coulomb::new(0.0).and_then(|law| law.with_force(force, 0.0));
        let law = law.and_then(|law| law.with_stribeck(1.0 + excess, velocity)).expect("a law");
        let paper = Paper::sealed().friction(viscous, 0.0).with(|it| it.coulomb = Some(law));
        on_a_weight(&paper, true, REST + 3.7 * INCH, None)
    };
    let error = refusal(with(0.99 * least));
    assert!(error.contains("actuator.friction.viscous"), "{error}");
    let (plant, start) = with(1.01 * least);
    simulate_plant(&plant, &start, 0.02, 1e-8).expect("a run");
}

/// Where both points lie on one line with the axis the distance rests, and the limb swings through: each of two muscles reverses
/// at its dead centre, and the work of their friction closes.
#[test]
fn a_limb_swings_through_the_dead_centres_of_its_muscles() {
    const DEAD_CENTRES: [f64; 2] = [0.0, 0.12];
    let paper = Paper::sealed();
    assert!(paper.coulomb_width > 0.0);
    let stops = JointStops { ends: [None; 2], stiffness: 500.0, damping: 1.0 };
    let joint = Revolute { torque: 0.0, damping: 0.0, stops };
    let limb = ChainSegment { length: 0.0, mass: 1.0, distance: 0.1, inertia: 1e-3 };
    let chain = Chain::new(vec![limb], vec![joint], [0.0, 0.0], None).expect("a chain");
    let mounted = DEAD_CENTRES.map(|angle: f64| {
        let fixed = Attachment { segment: None, place: [-0.06 * angle.cos(), -0.06 * angle.sin()] };
        let moved = Attachment { segment: Some(0), place: [0.03, 0.0] };
        let coupling = Coupling::Points([fixed, moved]);
        Mounted { actuator: paper.actuator(), mechanism: 0, coupling, tendon: None, pressure: None }
    });
    let network = Network::new(&paper.air());
    let plant = Plant::new(mounted.to_vec(), network, vec![Mechanism::Chain(chain)]).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![-0.3]],
        rates: vec![vec![5.0]],
        air: vec![InitialAir { gauge_pressure: GaugePressure(2e4), temperature: ROOM }; 2],
        lengths: vec![None; 2],
        ..PlantStart::default()
    };
    let run = simulate_plant(&plant, &start, 0.15, 1e-8).expect("a run");
    let sample = run.sample(0.15);
    let (angle, rate) = (sample.mechanisms[0].position[0], sample.mechanisms[0].rate[0]);
    assert!(angle > 0.2 && rate > 2.0, "{angle} rad at {rate} rad/s");
    for (actuator, dead_centre) in DEAD_CENTRES.into_iter().enumerate() {
        let its = PlantEventKind { part: Part::Actuator(actuator), kind: EventKind::Reversal };
        let times: Vec<f64> = run.events().iter().filter(|event| event.kind == its).map(|event| event.time).collect();
        let [time] = times[..] else { panic!("{actuator} reverses at {times:?}") };
        assert_within(run.sample(time).mechanisms[0].position[0], dead_centre, 1e-6);
    }
    let work = run.ledger().work();
    assert!(work.closes(1e-6), "{work:?}");
}

/// A law that falls below zero again before the end of the thread: the end starts where it and the tendon balance, not at the end.
#[test]
fn an_end_starts_at_the_balance_of_a_law_that_falls_again() {
    let paper = Paper::sealed().friction(0.0, 0.0);
    let (plant, start) = {
        let (plant, start) = on_a_weight(&paper, true, REST + 3.9 * INCH, None);
        let actuator = paper.clone().with(|paper| paper.characteristic = Some(falling(paper))).actuator();
        let mounted = Mounted { actuator, ..plant.actuators()[0].clone() };
        let weight = plant.mechanisms()[0].clone();
        (Plant::new(vec![mounted], Network::new(&paper.air()), vec![weight]).expect("a plant"), start)
    };
    let actuator = &plant.actuators()[0].actuator;
    let end = paper.thread_length;
    let state = plant.start(&start).expect("a start");
    let here = plant.indices().actuators[0];
    let (length, pressure) = (state[here.length.expect("a state")], state[here.pressure]);
    assert!(length < 0.98 * end, "{length} of {end}");
    let force: f64 = actuator.static_force(length, pressure);
    assert_within(force, STIFFNESS * (3.9 * INCH - length), 1e-6);
}

/// An ideal braid within a membrane whose modulus is far below zero near the end of the thread.
fn falling(paper: &Paper) -> Characteristic {
    let (end, rest) = (paper.thread_length, 3.6 * INCH);
    let cube = -4e7 / (end - rest).powi(3);
    let modulus = [-cube * rest.powi(3), 3.0 * cube * rest * rest, -3.0 * cube * rest, cube];
    let law = MartensBoblan::new(&paper.braid(), rest, 1e-3, modulus).expect("a law");
    Characteristic::new(paper.braid(), Law::MartensBoblan(law))
}

/// A tendon that is pulled half a metre in one step: no muscle stands that, and no pressure of millions of bars comes of it.
#[test]
fn no_step_leaves_the_physics_in_silence() {
    let (plant, start) = on_a_weight(&Paper::sealed(), true, REST + 3.7 * INCH, None);
    let (plant, start) = plant.to_external(&start).expect("a host's");
    for pulled in [0.1, 0.2, 0.3, 0.5, 1.0, 10.0] {
        let mut steps = PlantRun::new(&plant, &start, 1e-9).expect("a start").steps(Method::Stable);
        if steps.move_to(1e-2, &[REST + 3.7 * INCH + pulled]).is_ok() {
            let pressure = steps.state()[plant.indices().actuators[0].pressure];
            assert!(pressure < 1e9, "{pressure} Pa at {pulled} m");
        }
    }
}
