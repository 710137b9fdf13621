//! Poles, responses, ripple and controllability of plants' linear models: those of rigs, and a chain's frequencies.

use crate::common::{ATMOSPHERE, GRAVITY, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::linearize::{Aim, Balance, Content, StateSpace, linearize, linearize_driven};
use mckibben::mechanism::{Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute};
use mckibben::network::Network;
use mckibben::plant::{
    InitialAir, Mounted, Plant, PlantAir, PlantBalance, PlantInput, PlantOutput, PlantStart, linearize_plant,
};
use mckibben::{AbsolutePressure, GaugePressure};

#[test]
fn a_rig_has_the_poles_ripple_and_reach_of_its_plant() {
    let paper = Paper::pwm(100.0, 0.6).friction(20.0, 0.0);
    let (rig, start) = (paper.rig(), paper.start());
    let old = linearize_driven(&rig, Aim::Duty(0.6), Content::Of(start)).expect("a model");
    let plant = Plant::of_rig(&rig);
    let plant_start = Plant::start_of_rig(&rig, &start);
    let new = linearize_plant(&plant, &plant_start, &PlantBalance::Driven, &PlantAir::Start).expect("a model");
    let (theirs, mine) = (old.minimal(), new.minimal());
    for (mine, theirs) in mine.poles().expect("poles").iter().zip(theirs.poles().expect("poles")) {
        assert_within(mine.real, theirs.real, 1e-8 * theirs.natural_frequency());
        assert_within(mine.imaginary, theirs.imaginary, 1e-8 * theirs.natural_frequency());
    }
    // The fundamental of a three-way valve's flow is that of its openings: at a constant pressure the flow is proportional.
    for (output, name) in [
        (PlantOutput::Pressure { actuator: 0 }, "pressure"),
        (PlantOutput::Length { actuator: 0 }, "length"),
        (PlantOutput::Tension { actuator: 0 }, "tension"),
    ] {
        assert_close(new.ripple(0, output).expect("a ripple"), old.ripple(name).expect("a ripple"), 1e-6);
    }
    let duty = mine.inputs.iter().position(|input| *input == PlantInput::Duty { valve: 0 }).expect("a duty");
    let reach = new.controllability(&mine, duty).expect("a rank");
    let expected = old.controllability(&theirs, theirs.input("duty").expect("a duty")).expect("a rank");
    assert_eq!(reach.rank, expected.rank);
    assert_close(reach.condition, expected.condition, 1e-6);
    // With the valve shut the air is an integrator.
    let held =
        linearize(&rig, Balance::AtPressure(GaugePressure(60.0 * PSI)), Content::Temperature(ROOM)).expect("a model");
    let shut = PlantBalance::Shut(vec![GaugePressure(60.0 * PSI)]);
    let new = linearize_plant(&plant, &plant_start, &shut, &PlantAir::Temperatures(vec![ROOM])).expect("a model");
    let zeros = |poles: Vec<mckibben::linearize::Pole>| poles.iter().filter(|pole| pole.is_zero()).count();
    assert_eq!(zeros(held.minimal().poles().expect("poles")), 1);
    assert_eq!(zeros(new.minimal().poles().expect("poles")), 1);
}

/// Three equal point masses on equal rods: ω² = g/l times the roots of Laguerre's polynomial L₃.
#[test]
fn a_triple_pendulum_has_the_roots_of_laguerres_polynomial() {
    let (length, mass) = (0.2, 0.5);
    let free = JointStops { ends: [None; 2], stiffness: 1.0, damping: 0.0 };
    let segment = ChainSegment { length, mass, distance: length, inertia: 0.0 };
    let revolute = Revolute { torque: 0.0, damping: 0.0, stops: free };
    let chain = Chain::new(vec![segment; 3], vec![revolute; 3], [GRAVITY, 0.0], None).expect("a chain");
    let network = Network::new(&Paper::sealed().air());
    let plant = Plant::new(vec![], network, vec![Mechanism::Chain(chain)]).expect("a plant");
    let start =
        PlantStart { positions: vec![vec![0.2, -0.1, 0.3]], rates: vec![vec![0.0; 3]], ..PlantStart::default() };
    let shut = PlantBalance::Shut(vec![]);
    let model = linearize_plant(&plant, &start, &shut, &PlantAir::Temperatures(vec![])).expect("a model");
    let poles = model.system.poles().expect("poles");
    // 6 − 18 x + 9 x² − x³ = 0.
    for (pole, root) in
        poles.iter().step_by(2).zip([6.289_945_082_937_479, 2.294_280_360_279_042, 0.415_774_556_783_479_1])
    {
        assert_close(pole.imaginary, f64::sqrt(root * GRAVITY / length), 1e-9);
        assert_within(pole.real, 0.0, 1e-9);
    }
}

/// Two equal masses on equal springs, with one spring between them: a push of one is half the mode in phase and half that in
/// opposition, and a pair of poles has half of each. Without the spring between, both modes are one.
#[test]
fn a_push_of_one_of_two_equal_masses_is_half_of_each_mode() {
    for (between, part) in [(0.3, 0.25), (1e-4, 0.25), (0.0, 0.5)] {
        let own = 1.0 + between;
        let system = StateSpace::<(), (), ()> {
            states: vec![(); 4],
            inputs: Vec::new(),
            outputs: Vec::new(),
            a: [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [-own, between, 0.0, 0.0], [between, -own, 0.0, 0.0]]
                .map(Vec::from)
                .to_vec(),
            b: vec![Vec::new(); 4],
            c: Vec::new(),
            d: Vec::new(),
        };
        let push = [0.0, 0.0, 1.0, 0.0];
        let parts = system.oscillating_parts(&push, &push).expect("poles");
        assert_eq!(parts.len(), 2);
        for ((pole, found), frequency) in parts.iter().zip([f64::sqrt(1.0 + 2.0 * between), 1.0]) {
            assert_close(pole.imaginary, frequency, 1e-9);
            assert_close(*found, part, 1e-6);
        }
    }
}

/// Loads that share nothing swing each at `√(k/m − (c/2m)²)`, with k the stiffness of the sealed muscle.
#[test]
fn each_of_two_loads_swings_in_its_own_mode() {
    const VISCOUS: f64 = 3.5;
    let (paper, gauge) = (Paper::sealed().friction(VISCOUS, 1e-4), GaugePressure(3e5));
    let masses = [2.0, 0.5];
    let mounted = [0, 1].map(|mechanism| Mounted {
        actuator: paper.actuator().without_valve(),
        mechanism,
        coupling: Coupling::Direct { coordinate: 0 },
        tendon: None,
        pressure: None,
    });
    let weights = masses.map(|mass| Mechanism::Mass(Mass::new(mass, Pull::Gravity(GRAVITY), None).expect("a mass")));
    let plant = Plant::new(mounted.to_vec(), Network::new(&paper.air()), weights.to_vec()).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![0.085]; 2],
        rates: vec![vec![0.0]; 2],
        air: vec![InitialAir { gauge_pressure: gauge, temperature: ROOM }; 2],
        lengths: vec![None; 2],
        ..PlantStart::default()
    };
    let (shut, air) = (PlantBalance::Shut(vec![gauge; 2]), PlantAir::Temperatures(vec![ROOM; 2]));
    let model = linearize_plant(&plant, &start, &shut, &air).expect("a model");
    let mut oscillations = Vec::new();
    for (i, mass) in masses.into_iter().enumerate() {
        let stiffness =
            paper.actuator().sealed_stiffness(model.point.lengths[i], AbsolutePressure(gauge.0 + ATMOSPHERE));
        let damped = f64::sqrt(stiffness / mass - (0.5 * VISCOUS / mass).powi(2));
        let found = model.oscillation(i).expect("poles").expect("it swings");
        assert_close(found, damped, 1e-3);
        oscillations.push(Some((1e-3, found)));
    }
    // Each takes the damping at its frequency: the row of its tension has it in the column of the velocity.
    let with = model.with_equivalent_damping(&oscillations).expect("a model");
    let place = |of: PlantOutput| model.system.outputs.iter().position(|its| *its == of).expect("an output");
    for (actuator, oscillation) in oscillations.iter().enumerate() {
        let row = place(PlantOutput::Tension { actuator });
        let rate = place(PlantOutput::LengthRate { actuator });
        let column = model.system.c[rate].iter().position(|entry| *entry != 0.0).expect("a velocity");
        let (amplitude, frequency) = oscillation.expect("it swings");
        let damping = 4.0 * model.coulomb_bounds(actuator)[1] / (std::f64::consts::PI * frequency * amplitude);
        assert_close(with.system.c[row][column] - model.system.c[row][column], damping, 1e-9);
    }
}
