//! Poles, responses, ripple and controllability of plants' linear models: those of rigs, and a chain's frequencies.

use crate::common::{GRAVITY, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::GaugePressure;
use mckibben::linearize::{Aim, Balance, Content, linearize, linearize_driven};
use mckibben::mechanism::{Chain, ChainSegment, JointStops, Mechanism, Revolute};
use mckibben::network::Network;
use mckibben::plant::{Plant, PlantAir, PlantBalance, PlantInput, PlantOutput, PlantStart, linearize_plant};

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
