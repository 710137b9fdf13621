//! Where friction starts: on a branch of its loop, or with a force that it holds.

use crate::common::{PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::friction::{BoucWen, Coulomb, Hysteresis, LuGre, MaxwellSlip};
use mckibben::load::Motion;
use mckibben::mechanism::{Coupling, Mass, Mechanism, Pull};
use mckibben::network::Network;
use mckibben::plant::{InitialAir, InitialFriction, Mounted, Plant, PlantRun, PlantStart};
use mckibben::simulation::PressureSeries;
use mckibben::{Error, GaugePressure};
use std::f64::consts::PI;

const GAUGE: f64 = 40.0 * PSI;
const LENGTH: f64 = 0.088;

fn laws() -> Vec<(&'static str, Hysteresis, f64)> {
    let slip = MaxwellSlip::new(&[2e-4, 6e-4], &[0.3, 0.1]).expect("elements");
    let rounded = BoucWen::new(1.2e-4, 3e3, 1e3).expect("a loop");
    let bristles = LuGre::new(1.2e-4, 3e-4).and_then(|law| law.with_velocity(1.5, 0.01, 0.0)).expect("bristles");
    // The force at rest after a long way, over the secant stiffness: Σ w r, W, and ρ W.
    vec![
        ("Maxwell slip", Hysteresis::MaxwellSlip(slip), 0.3 * 2e-4 + 0.1 * 6e-4),
        ("Bouc-Wen", Hysteresis::BoucWen(rounded), 1.2e-4),
        ("LuGre", Hysteresis::LuGre(bristles), 1.5 * 1.2e-4),
    ]
}

fn paper(law: Option<Hysteresis>, coulomb: f64) -> Paper {
    Paper::sealed().friction(0.0, coulomb).with(|paper| paper.hysteresis = law)
}

/// The actuator at a pressure that stays, on a mechanism.
fn plant(paper: &Paper, mechanism: Mechanism) -> Plant {
    let mounted = Mounted {
        actuator: paper.actuator(),
        mechanism: 0,
        coupling: Coupling::Direct { coordinate: 0 },
        tendon: None,
        pressure: Some(PressureSeries::new(&[0.0, 100.0], &[GAUGE, GAUGE]).expect("a pressure")),
    };
    Plant::new(vec![mounted], Network::new(&paper.air()), vec![mechanism]).expect("a plant")
}

fn start(friction: InitialFriction) -> PlantStart {
    PlantStart {
        positions: vec![vec![LENGTH]],
        rates: vec![vec![0.0]],
        air: vec![InitialAir { gauge_pressure: GaugePressure(GAUGE), temperature: ROOM }],
        lengths: vec![None],
        friction: vec![friction],
    }
}

fn tension(run: &PlantRun) -> f64 {
    run.measurement().actuators[0].tension
}

/// (1)(3) and the secant stiffness of (13), at the paper's effectiveness of one.
fn by_hand(paper: &Paper, length: f64) -> (f64, f64) {
    let per_turns = 1.0 / (4.0 * PI * paper.turns * paper.turns);
    let force = GAUGE * (3.0 * length * length - paper.thread_length * paper.thread_length) * per_turns;
    let shortest = paper.min_length.unwrap_or(paper.thread_length / 3.0_f64.sqrt());
    (force, 3.0 * GAUGE * (length + shortest) * per_turns)
}

#[test]
fn each_law_starts_on_its_branch_or_with_a_force() {
    for (name, law, most) in laws() {
        let paper = paper(Some(law), 0.0);
        let (force, stiffness) = by_hand(&paper, LENGTH);
        let plant = plant(&paper, Mechanism::Fixed);
        let at = |friction| tension(&PlantRun::new(&plant, &start(friction), 1e-9).expect(name));
        assert_close(at(InitialFriction::Relaxed), force, 1e-12);
        assert_close(at(InitialFriction::Loading), force + stiffness * most, 1e-11);
        assert_close(at(InitialFriction::Unloading), force - stiffness * most, 1e-11);
        for part in [-0.99, -0.4, 0.0, 0.3, 0.8, 0.999] {
            let held = part * stiffness * most;
            assert_close(at(InitialFriction::Held(held)), force + held, 1e-10);
        }
        // Beyond what it holds: the range is in the message.
        let beyond = PlantRun::new(&plant, &start(InitialFriction::Held(1.01 * stiffness * most)), 1e-9);
        match beyond {
            Err(Error::Inconsistent { parameter, requirement, .. }) => {
                assert_eq!(parameter.key, "initial.friction_force");
                assert_close(requirement.value, stiffness * most, 1e-10);
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// A branch that was given is that which a long way leads to, and what follows from there is the same.
#[test]
fn a_branch_is_that_of_a_long_way() {
    for (name, law, _) in laws() {
        let paper = paper(Some(law), 0.0);
        for (friction, from) in [(InitialFriction::Loading, -0.008), (InitialFriction::Unloading, 0.004)] {
            let lengths = vec![LENGTH + from, LENGTH, LENGTH - 3e-4, LENGTH + 1e-4, LENGTH + 1e-4];
            let times = vec![0.0, 10.0, 10.5, 11.0, 12.0];
            let whole = Motion::table(times, lengths.clone(), paper.thread_length).expect("a motion");
            let later = Motion::table(vec![0.0, 0.5, 1.0, 2.0], lengths[1..].to_vec(), paper.thread_length);
            let whole = plant(&paper, Mechanism::Prescribed(whole));
            let mut relaxed = start(InitialFriction::Relaxed);
            relaxed.positions = vec![vec![LENGTH + from]];
            let mut history = PlantRun::new(&whole, &relaxed, 1e-10).expect(name);
            let later = plant(&paper, Mechanism::Prescribed(later.expect("a motion")));
            let mut given = PlantRun::new(&later, &start(friction), 1e-10).expect(name);
            for k in 1..=40 {
                let time = 2.0 * f64::from(k) / 40.0;
                history.advance_to(10.0 + time).expect(name);
                given.advance_to(time).expect(name);
                // LuGre's bristles were bent by a slow motion, not by one at rest: they slide a little lower.
                let close = if name == "LuGre" { 2e-3 } else { 1e-8 };
                assert_close(tension(&given), tension(&history), close);
            }
        }
    }
}

/// Masing: from the loading branch back, the force over the secant stiffness falls by twice the virgin curve of half the way.
#[test]
fn from_the_loading_branch_it_unloads_by_masings_rule() {
    let (name, law, most) = laws().remove(0);
    let paper = paper(Some(law), 0.0);
    let motion = Motion::table(vec![0.0, 1.0], vec![LENGTH, LENGTH - 1.5e-3], paper.thread_length).expect("a motion");
    let plant = plant(&paper, Mechanism::Prescribed(motion));
    let mut run = PlantRun::new(&plant, &start(InitialFriction::Loading), 1e-10).expect(name);
    let virgin = |way: f64| 0.3 * way.min(2e-4) + 0.1 * way.min(6e-4);
    for k in 1..20 {
        let time = f64::from(k) / 20.0;
        run.advance_to(time).expect(name);
        let way = 1.5e-3 * time;
        let (force, stiffness) = by_hand(&paper, LENGTH - way);
        assert_close(tension(&run), force + stiffness * (most - 2.0 * virgin(0.5 * way)), 1e-9);
    }
}

/// A mass that the held force balances stays where it is; with another start of friction it moves.
#[test]
fn a_mass_that_friction_balances_stays() {
    let (name, law, most) = laws().remove(1);
    let paper = paper(Some(law), 0.0).with(|paper| paper.viscous = 5.0);
    let (force, stiffness) = by_hand(&paper, LENGTH);
    let held = 0.6 * stiffness * most;
    let mass = |pull: f64| Mechanism::Mass(Mass::new(2.0, Pull::Force(pull), None).expect("a mass"));
    let plant = plant(&paper, mass(force + held));
    let moved = |friction, duration: f64| {
        let mut run = PlantRun::new(&plant, &start(friction), 1e-10).expect(name);
        run.advance_to(duration).expect(name);
        run.state()[0] - LENGTH
    };
    assert_within(moved(InitialFriction::Held(held), 0.5), 0.0, 1e-9);
    // What is not balanced accelerates it: ½ ΔF/M t², before the spring of the actuator has an effect.
    let (mass, time) = (2.0, 1e-3);
    let way = |force: f64| 0.5 * force / mass * time * time;
    assert_close(moved(InitialFriction::Relaxed, time), way(held), 0.01);
    assert_close(moved(InitialFriction::Loading, time), way(held - stiffness * most), 0.01);
    assert_close(moved(InitialFriction::Unloading, time), way(held + stiffness * most), 0.01);
}

#[test]
fn what_remembers_nothing_is_refused() {
    let refused = |paper: &Paper, friction: Vec<InitialFriction>| {
        let plant = plant(paper, Mechanism::Fixed);
        let start = PlantStart { friction, ..start(InitialFriction::Relaxed) };
        PlantRun::new(&plant, &start, 1e-9).expect_err("refused")
    };
    for friction in [InitialFriction::Loading, InitialFriction::Unloading, InitialFriction::Held(1.0)] {
        let error = refused(&paper(None, 1e-4), vec![friction]);
        assert!(matches!(error, Error::Misuse { .. }), "{error}");
        assert!(error.to_string().contains("remembers nothing"), "{error}");
    }
    let law = laws().remove(0).1;
    let error = refused(&paper(Some(law), 0.0), vec![InitialFriction::Held(f64::NAN)]);
    assert!(matches!(error, Error::OutOfRange { .. }), "{error}");
    let error = refused(&paper(Some(law), 0.0), vec![InitialFriction::Relaxed; 2]);
    assert!(matches!(error, Error::Table { .. }), "{error}");
    // In addition to dry friction the hysteresis has its start.
    let both = paper(Some(law), 0.0).with(|paper| paper.coulomb = Coulomb::new(1e-4).ok());
    PlantRun::new(&plant(&both, Mechanism::Fixed), &start(InitialFriction::Loading), 1e-9).expect("a run");
}
