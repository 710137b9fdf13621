//! Runs of plants go on: they neither crawl nor stop where nothing is wrong, and where something is they say what.

use crate::common::{ATMOSPHERE, GRAVITY, INCH, Paper, ROOM, assert_close};
use mckibben::air::Process;
use mckibben::friction::{Hysteresis, LuGre, MaxwellSlip};
use mckibben::line::{Hose, HoseKind, Line, Regulator, Reservoir};
use mckibben::load::{Motion, SeriesTendon};
use mckibben::mechanism::{Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute};
use mckibben::network::{Network, NodeKind};
use mckibben::plant::{InitialAir, Mounted, Plant, PlantRun, PlantStart, simulate_plant};
use mckibben::simulation::Actuation;
use mckibben::valve::{Command, FlowStandard, Request, Solenoid, ValveKind};
use mckibben::{Error, GaugePressure};
use std::f64::consts::PI;

fn mounted(paper: &Paper, mechanism: usize) -> Mounted {
    Mounted {
        actuator: paper.actuator().without_valve(),
        mechanism,
        coupling: Coupling::Direct { coordinate: 0 },
        tendon: None,
        pressure: None,
    }
}

fn air(gauge: f64) -> InitialAir {
    InitialAir { gauge_pressure: GaugePressure(gauge), temperature: ROOM }
}

/// A start of some actuators on one mechanism, each with as much air.
fn start(count: usize, [position, rate]: [f64; 2], gauge: f64) -> PlantStart {
    PlantStart {
        positions: vec![vec![position]],
        rates: vec![vec![rate]],
        air: vec![air(gauge); count],
        lengths: vec![None; count],
        ..PlantStart::default()
    }
}

fn always(request: Request) -> Actuation {
    let solenoid = Solenoid::new(ValveKind::ThreeWay, 0.0, 0.0).expect("a solenoid");
    Actuation { solenoid, command: Command::Constant(request) }
}

/// What a run may take without progress counts from where it was, not from where it was taken up again.
#[test]
fn a_run_in_many_short_steps_does_not_crawl() {
    let paper = Paper::sealed();
    let rig = paper.rig();
    let plant = Plant::of_rig(&rig);
    let start = Plant::start_of_rig(&rig, &paper.start());
    let mut run = PlantRun::new(&plant, &start, 1e-6).expect("a run");
    for count in 1..=100_500_u32 {
        run.advance_to(f64::from(count) * 1e-6).expect("it goes on");
    }
    let counts = run.statistics();
    assert!(counts.explicit_steps + counts.implicit_steps > 100_000, "{counts:?}");
    run.advance_to(0.1105).expect("it goes on");
}

/// Alike on one mass, two muscles come to the ends of their branches together, and are one on half of it.
#[test]
fn elements_that_slip_together_do_so_once_each() {
    let law = MaxwellSlip::new(&[1e-5, 1e-4, 4e-4], &[0.5, 0.3, 0.2]).expect("elements");
    let paper = Paper::sealed().with(|it| {
        (it.coulomb_width, it.viscous) = (0.0, 0.0);
        it.hysteresis = Some(Hysteresis::MaxwellSlip(law));
    });
    let run = |count: usize| {
        let mass = Mass::new(0.5 * count as f64, Pull::Force(20.0 * count as f64), None).expect("a mass");
        let actuators = (0..count).map(|_| mounted(&paper, 0)).collect();
        let plant = Plant::new(actuators, Network::new(&paper.air()), vec![Mechanism::Mass(mass)]).expect("a plant");
        simulate_plant(&plant, &start(count, [3.4 * INCH, 0.3], 1.5e5), 0.2, 1e-9).expect("it runs")
    };
    let (one, two) = (run(1), run(2));
    assert!(one.events().len() > 8, "{}", one.events().len());
    for step in 1..=20 {
        let time = f64::from(step) * 0.01;
        assert_close(two.at(time).0[0], one.at(time).0[0], 1e-7);
    }
}

/// Where a motion is given, each muscle on it is as if it were alone.
#[test]
fn all_bristles_reverse_with_a_prescribed_motion() {
    let law = LuGre::new(0.05, 1e-4).and_then(|law| law.with_velocity(1.4, 0.02, 1e-3)).expect("a law");
    let paper = Paper::sealed().with(|it| {
        it.coulomb_width = 0.0;
        it.hysteresis = Some(Hysteresis::LuGre(law));
    });
    let run = |count: usize| {
        let motion = Motion::sinusoid(3.2 * INCH, 0.2 * INCH, 10.0, 0.3, 4.3 * INCH).expect("a motion");
        let actuators = (0..count).map(|_| mounted(&paper, 0)).collect();
        let motions = vec![Mechanism::Prescribed(motion)];
        let plant = Plant::new(actuators, Network::new(&paper.air()), motions).expect("a plant");
        simulate_plant(&plant, &start(count, [3.2 * INCH, 0.0], 2e5), 0.3, 1e-9).expect("it runs")
    };
    let (one, three) = (run(1), run(3));
    for (alone, together) in one.samples(0.01).zip(three.samples(0.01)) {
        for muscle in &together.actuators {
            assert_close(muscle.tension, alone.actuators[0].tension, 1e-6);
        }
    }
}

/// On its shortest length an end on a tendon rests by its mode: its length is one of the numbers that round.
#[test]
fn an_end_rests_on_its_shortest_length() {
    for step in 0..24 {
        let shortest = (2.5 + 0.013 * f64::from(step)) * INCH;
        let paper = Paper::sealed().friction(5.0, 1e-4).with(|it| it.min_length = Some(shortest));
        let mut actuator = mounted(&paper, 0);
        actuator.tendon = Some(SeriesTendon::new(2e4, 0.05).expect("a tendon"));
        let mass = Mass::new(0.5, Pull::Force(15.0), None).expect("a mass");
        let plant =
            Plant::new(vec![actuator], Network::new(&paper.air()), vec![Mechanism::Mass(mass)]).expect("a plant");
        let mut begin = start(1, [shortest + 0.055, -0.1], 5e5);
        begin.lengths = vec![Some(shortest + 2e-4)];
        let run = simulate_plant(&plant, &begin, 0.3, 1e-8).expect("it runs");
        assert!(run.events().len() < 100, "{} events at {shortest}", run.events().len());
    }
}

/// The period of a pendulum: `2π √(I/(m g d))/agm(1, cos(θ₀/2))`.
#[test]
fn a_mechanism_without_an_actuator_swings_as_a_pendulum() {
    let (mass, distance, inertia, from): (f64, f64, f64, f64) = (2.0, 0.3, 0.02, 1.2);
    let segment = ChainSegment { length: 0.0, mass, distance, inertia };
    let stops = |ends| JointStops { ends, stiffness: 500.0, damping: 0.0 };
    let chain = |ends| {
        let joint = Revolute { torque: 0.0, damping: 0.0, stops: stops(ends) };
        Mechanism::Chain(Chain::new(vec![segment], vec![joint], [GRAVITY, 0.0], None).expect("a chain"))
    };
    let (mut a, mut g) = (1.0, (0.5 * from).cos());
    while (a - g).abs() > 1e-15 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    let about = inertia + mass * distance * distance;
    let period = 2.0 * PI * (about / (mass * GRAVITY * distance)).sqrt() / a;
    let paper = Paper::sealed();
    for has_muscle in [false, true] {
        let mut mechanisms = vec![chain([None, None]), chain([Some(-0.3), None])];
        let mut begin = start(0, [from, 0.0], 0.0);
        begin.positions.push(vec![from]);
        begin.rates.push(vec![0.0]);
        let mut actuators = vec![];
        if has_muscle {
            mechanisms.push(Mechanism::Fixed);
            begin.positions.push(vec![0.08]);
            begin.rates.push(vec![0.0]);
            (begin.air, begin.lengths) = (vec![air(1e5)], vec![None]);
            actuators.push(mounted(&paper, 2));
        }
        let plant = Plant::new(actuators, Network::new(&paper.air()), mechanisms).expect("a plant");
        let run = simulate_plant(&plant, &begin, period, 1e-10).expect("it runs");
        let state = run.at(period).0;
        assert_close(state[0], from, 1e-7);
        // Against the stop it comes back with the energy that it had.
        let energy = |[angle, rate]: [f64; 2]| {
            let pressed = (-0.3 - angle).max(0.0);
            0.5 * about * rate * rate - mass * GRAVITY * distance * angle.cos() + 250.0 * pressed * pressed
        };
        assert_close(energy([state[2], state[3]]), energy([from, 0.0]), 1e-7);
        assert!(run.events().len() >= 2);
    }
}

/// A muscle at a valve of a size (m²), fed by a regulator behind a bottle (m³), which fills it from the start on.
fn behind_a_bottle(area: f64, volume: f64, regulator: [f64; 3], into: f64, process: Process) -> (Plant, PlantStart) {
    let paper = Paper::sealed().with(|it| {
        it.standard = FlowStandard::Orifice { flow_area: area };
        (it.external_volume, it.process, it.efficiency) = (into, process, 1.0);
    });
    let mut network = Network::new(&paper.air());
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let bottle = Reservoir::new([volume, 1.0, ROOM], GaugePressure(5e5), None, &paper.air()).expect("a bottle");
    let [droop, band, lag] = regulator;
    let regulator = Regulator::new(droop, band, lag).expect("a regulator");
    let supply = network.supply([4e5, ROOM], Some(&bottle), Some(&regulator), None, outside);
    let actuator = paper.actuator().with_valve(paper.valve());
    network.draw(0, &actuator, (Some(&always(Request::Fill)), None), &Line::NONE, [supply.outlet, outside], 1.0);
    let plant = Plant::new(vec![mounted(&paper, 0)], network, vec![Mechanism::Fixed]).expect("a plant");
    (plant, start(1, [3.5 * INCH, 0.0], -0.999 * ATMOSPHERE))
}

/// While the valve is choked, bottle and outlet follow `P₁' = −a P₂`, `τ P₂' = P₁ − P₂`, which swings through zero where
/// `4 a τ > 1` and never does otherwise.
#[test]
fn only_a_slow_regulator_lets_a_bottle_run_empty() {
    let (area, volume) = (2e-6, 2e-5);
    let gas = 286.99 * ROOM;
    let choked = (1.4_f64).sqrt() * (2.0 / 2.4_f64).powf(3.0) * area / gas.sqrt();
    let drain = gas / volume * choked;
    let run = |slowness: f64| {
        let (plant, start) =
            behind_a_bottle(area, volume, [0.0, 0.0, 0.25 * slowness / drain], 1.0, Process::Isothermal);
        simulate_plant(&plant, &start, 3.0 / drain, 1e-8)
    };
    run(0.9).expect("it runs");
    let error = run(4.0).expect_err("it stops");
    assert!(matches!(error, Error::Stopped { reason, .. } if reason.contains("reservoir empty")), "{error}");
}

/// What a regulator goes to has a kink where its bottle comes to limit it, and its dead band two more.
#[test]
fn a_regulator_with_a_dead_band_keeps_the_order_of_the_method() {
    let run = |tolerance: f64| {
        let (plant, start) = behind_a_bottle(1.6e-6, 6e-5, [1e7, 2e3, 8e-3], 3e-5, Process::Isentropic);
        let run = simulate_plant(&plant, &start, 0.3, tolerance).expect("it runs");
        let states: Vec<Vec<f64>> = (1..=30).map(|step| run.at(0.01 * f64::from(step)).0).collect();
        (states, run.events().len())
    };
    let (exact, events) = run(1e-12);
    assert!(events >= 4, "{events}");
    for (state, exact) in run(1e-10).0.iter().zip(&exact) {
        // Pressure and mass of the muscle's air, bottle and outlet.
        for place in 2..6 {
            assert_close(state[place], exact[place], 1e-7);
        }
    }
}

/// The air in a chamber of nothing but the muscle's own, at a valve far too large for it.
#[test]
fn a_tiny_isothermal_muscle_keeps_its_air() {
    let paper =
        Paper::driven(Command::pwm(20.0, 0.4, Request::Fill, Request::Exhaust).expect("a command")).with(|it| {
            (it.thread_length, it.max_length) = (0.011, 0.0098);
            it.standard = FlowStandard::Orifice { flow_area: 2e-5 };
            (it.external_volume, it.process) = (1e-9, Process::Isothermal);
        });
    let paper = paper.isometric(0.009);
    let rig = paper.rig();
    let plant = Plant::of_rig(&rig);
    let run = simulate_plant(&plant, &Plant::start_of_rig(&rig, &paper.start()), 0.2, 1.6e-6).expect("it runs");
    let ledger = run.ledger();
    for balance in [ledger.air(), ledger.energy(), ledger.exergy()] {
        assert!(balance.closes(1e-5), "{balance:?}");
    }
}

/// Without a limit the inertia of a cell would swing `P₁` through zero where it starts above twice what it flows into.
#[test]
fn no_cell_of_a_hose_loses_more_air_than_it_has() {
    let paper = Paper::sealed();
    let hose = |cells: usize| {
        Hose::new(HoseKind::Distributed { cells }, [0.4, 8e-3], [1.8e-5, ROOM, 1.0], &paper.air()).expect("a hose")
    };
    for cells in [1, 2, 5] {
        let mut network = Network::new(&paper.air());
        let into = Reservoir::new([1e-2, 1.0, ROOM], GaugePressure(-5e4), None, &paper.air()).expect("a bottle");
        let into = network.node(NodeKind::Reservoir(into), 0.0, ROOM);
        network.hose(hose(cells), into, 9e5);
        let plant = Plant::new(vec![mounted(&paper, 0)], network, vec![Mechanism::Fixed]).expect("a plant");
        let run = simulate_plant(&plant, &start(1, [3.5 * INCH, 0.0], 0.0), 0.05, 1e-8).expect("it runs");
        let mut least = f64::INFINITY;
        for sample in run.samples(2e-5) {
            least = sample.nodes.iter().fold(least, |least, node| least.min(node.pressure.0));
        }
        assert!(least > 0.0 && least < 0.5 * ATMOSPHERE, "{cells} cells: {least}");
        let ledger = run.ledger();
        assert!(ledger.air().closes(1e-7) && ledger.energy().closes(1e-6), "{:?} {:?}", ledger.air(), ledger.energy());
    }
}

/// Air below the atmosphere's pressure pushes an end out, which dry friction alone holds: as its tendon comes tight, it goes at
/// once, however small the tendon's pull.
#[test]
fn an_end_that_nothing_holds_is_said_to_jump() {
    let run = |viscous: f64| {
        let paper = Paper::sealed().friction(viscous, 1e-4);
        let mut muscle = mounted(&paper, 0);
        muscle.tendon = Some(SeriesTendon::new(2e4, 0.05).expect("a tendon"));
        let mass = Mechanism::Mass(Mass::new(1.0, Pull::Gravity(GRAVITY), None).expect("a mass"));
        let plant = Plant::new(vec![muscle], Network::new(&paper.air()), vec![mass]).expect("a plant");
        let length = 3.3 * INCH;
        let mut begin = start(1, [length + 0.048, 0.0], -5e4);
        begin.lengths = vec![Some(length)];
        simulate_plant(&plant, &begin, 0.2, 1e-8).map(|run| run.ledger())
    };
    let ledger = run(2.0).expect("it runs");
    assert!(ledger.energy().closes(1e-6), "{:?}", ledger.energy());
    let error = run(0.0).expect_err("it stops").to_string();
    assert!(error.contains("jumps") && error.contains("actuator.friction.viscous"), "{error}");
    assert!(!error.contains("tolerance"), "{error}");
}
