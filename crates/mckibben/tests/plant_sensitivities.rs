//! Derivatives of runs of plants with respect to every parameter and every number of the start, against differences of runs:
//! through pulses, sticking, hoses, a tendon, stops and what else happens on the way.

use crate::common::{GRAVITY, PSI, Paper, ROOM, toward};
use mckibben::force::Effectiveness;
use mckibben::friction::{Hysteresis, MaxwellSlip};
use mckibben::line::{self, Compressor, Hose, HoseKind, Leakage, Reservoir};
use mckibben::load::{MomentArm, SeriesTendon};
use mckibben::mechanism::{
    Arm, Attachment, Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute, Spring,
};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::parameter::Parameter;
use mckibben::plant::{InitialAir, Mounted, Part, Plant, PlantStart, StartNumber, TimeStepping, simulate_plant};
use mckibben::simulation::{Actuation, EventKind, Method};
use mckibben::valve::{Command, Port, Regulator, Request, Solenoid, Spool, ValveKind};
use mckibben::{GaugePressure, Scalar};

type D = mckibben::Seeded;

const FREE: JointStops = JointStops { ends: [None; 2], stiffness: 500.0, damping: 1.0 };
const LOCATED: TimeStepping = TimeStepping::Located { relative_tolerance: 1e-11 };
const PULSED: (f64, f64) = (40.0, 0.45);

fn mounted(paper: &Paper, mechanism: usize, coupling: Coupling) -> Mounted {
    Mounted { actuator: paper.actuator().without_valve(), mechanism, coupling, tendon: None, pressure: None }
}

fn pulley(joint: usize, sign: f64, radius: f64) -> Arm {
    Arm { joint, sign, arm: MomentArm::Pulley(radius) }
}

/// A chain of two joints and three muscles, one of them over both joints and one between points, on pulsed valves behind a
/// regulator and a tank with a compressor: a lumped hose, a line of cells and none.
fn arm() -> (Plant, PlantStart) {
    let paper = Paper::sealed().friction(6.0, 2e-5);
    let table = MomentArm::table(&[-0.6, 0.0, 0.7], &[0.011, 0.014, 0.012]).expect("a table");
    let slip = MaxwellSlip::new(&[1e-4, 4e-4], &[0.2, 0.1]).expect("a law");
    let hysteretic = paper.clone().friction(6.0, 0.0).with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(slip)));
    let (air, law) = (paper.air(), paper.flow_law());
    let mut network = Network::new(&air);
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let compressor = Compressor::new([2e-4, 0.05], [5.2e5, 6e5].map(GaugePressure), &air).expect("a compressor");
    let tank = Reservoir::new([1e-3, 1.1, ROOM], GaugePressure(5.5e5), Some(compressor), &air).expect("a tank");
    let tank = network.node(NodeKind::Reservoir(tank), 0.0, ROOM);
    network.branch(outside, tank, BranchKind::Compressor);
    let regulator = line::Regulator::new(2e7, 0.0, 0.03).expect("a regulator");
    let feed = network.node(NodeKind::Outlet { regulator, set: 4e5, inlet: Some(tank) }, 4e5, ROOM);
    let hose = |kind| Hose::new(kind, [0.4, 3e-3], [1.8e-5, ROOM, 1.05], &air).expect("a hose");
    let hoses = [Some(hose(HoseKind::Lumped)), Some(hose(HoseKind::Distributed { cells: 2 })), None];
    for (i, hose) in hoses.into_iter().enumerate() {
        let solenoid = Solenoid::new(ValveKind::ThreeWay, 4e-3, 1e-3).expect("a solenoid");
        let command = Command::pwm(PULSED.0 + 7.0 * i as f64, PULSED.1, Request::Fill, Request::Exhaust);
        let valve = network.valve(Actuation { solenoid, command: command.expect("a command") });
        let chamber = network.chamber(i, ROOM);
        let into = hose.map_or(chamber, |hose| network.hose(hose, chamber, 0.0));
        for (from, port) in [(feed, Port::Supply), (outside, Port::Exhaust)] {
            network.branch(from, into, BranchKind::Path { law, valve, port, ambient: false, copies: 1.0 });
        }
    }
    let chamber = network.chamber(2, ROOM);
    network.branch(outside, chamber, BranchKind::Leak(Leakage::new(2e-13).expect("a leak")));
    let segment = |length, mass, distance| ChainSegment { length, mass, distance, inertia: 2e-3 };
    let segments = vec![segment(0.25, 0.6, 0.12), segment(0.2, 0.4, 0.1)];
    let joints = vec![
        Revolute { torque: 0.05, damping: 4e-3, stops: FREE },
        Revolute {
            torque: 0.0,
            damping: 4e-3,
            stops: JointStops { ends: [None, Some(0.12)], stiffness: 60.0, damping: 0.1 },
        },
    ];
    let chain = Chain::new(segments, joints, [GRAVITY, 0.2], None).expect("a chain");
    let points =
        [Attachment { segment: None, place: [-0.02, -0.03] }, Attachment { segment: Some(0), place: [0.07, -0.01] }];
    let actuators = vec![
        mounted(&paper, 0, Coupling::Arms { rest_length: 0.088, arms: vec![Arm { joint: 0, sign: 1.0, arm: table }] }),
        mounted(
            &hysteretic,
            0,
            Coupling::Arms { rest_length: 0.086, arms: vec![pulley(0, -1.0, 0.01), pulley(1, 1.0, 0.012)] },
        ),
        mounted(&paper.clone().friction(6.0, 0.0), 0, Coupling::Points(points)),
    ];
    let plant = Plant::new(actuators, network, vec![Mechanism::Chain(chain)]).expect("a plant");
    let air = |gauge| InitialAir { gauge_pressure: GaugePressure(gauge), temperature: ROOM };
    let start = PlantStart {
        positions: vec![vec![0.1, -0.05]],
        rates: vec![vec![0.3, 0.2]],
        air: vec![air(1.5e5), air(1e5), air(1.2e5)],
        lengths: vec![None; 3],
        ..PlantStart::default()
    };
    (plant, start)
}

/// Two masses: one on a muscle with a tendon and a spool, one on a pressure regulator, with a spring, from a source.
fn masses() -> (Plant, PlantStart) {
    let paper = Paper::sealed().friction(12.0, 1e-4);
    let effective = paper.clone().friction(8.0, 3e-5).with(|rig| rig.effectiveness = Effectiveness::Constant(0.9));
    let (air, law) = (paper.air(), paper.flow_law());
    let mut network = Network::new(&air);
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let source = network.node(NodeKind::Source, 5e5, ROOM);
    let spool = Spool::new(60.0, 0.7, 0.05, 0.05).expect("a spool");
    let commands = [
        (Solenoid::proportional(spool), Command::positions(vec![0.0, 0.02, 0.05], vec![0.4, -0.3, 0.2])),
        (
            Solenoid::regulating(Regulator::new(0.01, 2e-3, 8e6).expect("a regulator")),
            Command::set_points(vec![0.0, 0.03], vec![2.5e5, 1.5e5]),
        ),
    ];
    for (i, (solenoid, command)) in commands.into_iter().enumerate() {
        let valve = network.valve(Actuation { solenoid, command: command.expect("a command") });
        let mut from = source;
        if let Some(regulator) = solenoid.regulator() {
            from = network.node(NodeKind::Port { regulator: *regulator, valve, feed: 5e5 }, 0.0, ROOM);
        }
        let chamber = network.chamber(i, ROOM);
        for (from, port) in [(from, Port::Supply), (outside, Port::Exhaust)] {
            network.branch(from, chamber, BranchKind::Path { law, valve, port, ambient: false, copies: 1.0 });
        }
    }
    let spring = Spring { stiffness: 300.0, rest_length: 0.08 };
    let mechanisms = vec![
        Mechanism::Mass(Mass::new(2.0, Pull::Gravity(GRAVITY), None).expect("a mass")),
        Mechanism::Mass(Mass::new(1.5, Pull::Force(20.0), Some(spring)).expect("a mass")),
    ];
    let direct = Coupling::Direct { coordinate: 0 };
    let mut actuators = vec![mounted(&effective, 0, direct.clone()), mounted(&paper, 1, direct)];
    actuators[0].tendon = Some(SeriesTendon::new(1.5e4, 0.05).expect("a tendon"));
    let plant = Plant::new(actuators, network, mechanisms).expect("a plant");
    let air = |gauge| InitialAir { gauge_pressure: GaugePressure(gauge), temperature: ROOM };
    let start = PlantStart {
        positions: vec![vec![0.1425], vec![0.091]],
        rates: vec![vec![0.01], vec![0.0]],
        air: vec![air(2e5), air(2e5)],
        lengths: vec![Some(0.0905), None],
        ..PlantStart::default()
    };
    (plant, start)
}

/// The end of a run, and usual sizes of what changes.
fn end<S: mckibben::Instantiate>(plant: &Plant<S>, start: &PlantStart<S>, time: f64, by: TimeStepping) -> Vec<S> {
    simulate_plant(plant, start, S::constant(time), by).expect("a run").at(S::constant(time)).0
}

/// What a derivative may be off, and the part of a number by which it is changed for a difference. In fixed steps an event
/// divides a step, and how depends on the number: differences are good over short ways alone, and where valves open together the
/// order in which they do counts.
fn accuracy(by: TimeStepping) -> [f64; 2] {
    match by {
        TimeStepping::Located { .. } => [1e-4, 1e-4],
        TimeStepping::Fixed { .. } => [1e-2, 1e-6],
    }
}

/// Derivative by differences of two lengths, and how far they are apart.
fn difference(step: f64, at: impl Fn(f64) -> Vec<f64>) -> Vec<[f64; 2]> {
    let pair = |h: f64| -> Vec<f64> { at(h).iter().zip(at(-h)).map(|(plus, minus)| plus - minus).collect() };
    let (near, far) = (pair(step), pair(2.0 * step));
    near.iter()
        .zip(&far)
        .map(|(near, far)| [(8.0 * near - far) / (12.0 * step), (2.0 * near - far).abs() / (4.0 * step)])
        .collect()
}

/// A number's name and size, and how each state at the end changes with it: exactly, and by differences with their spread.
type Compared = (String, f64, Vec<f64>, Vec<[f64; 2]>);

/// Asserts that derivatives agree with differences, each measured by the largest change of that state that any number of the
/// plant brings about, and a part of the state itself: what the tolerance of the runs leaves of a difference.
fn assert_alike(plant: &Plant, all: &[Compared], ends: &[f64], tolerance: f64, least: usize) {
    let states = all[0].2.len();
    let size: Vec<f64> = (0..states)
        .map(|k| all.iter().fold(0.0_f64, |most, (_, value, exact, _)| most.max((exact[k] * value).abs())))
        .collect();
    let is_flow = |k: usize| plant.indices().branches.contains(&Some(k));
    let (mut moved, mut wrong) = (0, Vec::new());
    for (name, value, exact, differences) in all {
        moved += usize::from(exact.iter().any(|slope| *slope != 0.0));
        for k in 0..states {
            // What differences of two lengths are apart is what they are good for.
            let [expected, apart] = differences[k];
            let off = (exact[k] - expected).abs() * value;
            let own = (expected.abs() * value).max(1e-3 * size[k]) + 3e-2 * ends[k].abs();
            // The loss of a cell turns a corner between laminar and turbulent flow, which no event marks.
            let own = if is_flow(k) { 30.0 * own } else { own };
            if off > tolerance * own + apart * value {
                wrong.push(format!("{name}, state {k}: {:e} is not {expected:e} ± {apart:e}", exact[k]));
            }
            if apart * value > 1e-2 * own {
                wrong.push(format!("{name}, state {k}: differences are {expected:e} ± {apart:e}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(moved >= least, "{moved} of {} numbers move anything", all.len());
}

/// Every number of a plant that [`Plant::map`] gives out, once for each part.
fn numbers(plant: &Plant) -> Vec<(Option<Part>, &'static Parameter, f64)> {
    let mut numbers: Vec<(Option<Part>, &'static Parameter, f64)> = Vec::new();
    let _ = plant.map(|part, row, value: f64| {
        if !numbers.iter().any(|(its, other, _)| *its == part && std::ptr::eq(*other, row)) {
            numbers.push((part, row, value));
        }
        value
    });
    numbers
}

fn check_parameters(plant: &Plant, start: &PlantStart, (time, by): (f64, TimeStepping), least: usize) {
    let mut all = Vec::new();
    let all_numbers = numbers(plant);
    for (place, &(part, row, value)) in all_numbers.iter().enumerate() {
        // What is alike of many parts is tried for two of them.
        let before = all_numbers[..place].iter().filter(|(_, other, _)| std::ptr::eq(*other, row)).count();
        // What is zero may be at the end of its range.
        if before > 1 || value == 0.0 {
            continue;
        }
        let is_it = |its: Option<Part>, other: &'static Parameter| its == part && std::ptr::eq(other, row);
        let seeded = plant.map(|its, other, value: f64| toward(value, f64::from(u8::from(is_it(its, other)))));
        let exact: Vec<f64> = end(&seeded, &start.map(|_, value| D::constant(value)), time, by)
            .into_iter()
            .map(|number| number.slope[0])
            .collect();
        let size = value.abs();
        let changed = |h: f64| {
            end(&plant.map(|its, other, value| if is_it(its, other) { value + h } else { value }), start, time, by)
        };
        all.push((format!("{} of {part:?}", row.key), size, exact, difference(accuracy(by)[1] * size, changed)));
    }
    assert_alike(plant, &all, &end(plant, start, time, by), accuracy(by)[0], least);
}

fn check_start(plant: &Plant, start: &PlantStart, (time, by): (f64, TimeStepping)) {
    let mut which = Vec::new();
    let _ = start.map(|number, value: f64| {
        which.push((number, value));
        value
    });
    let mut all = Vec::new();
    for (number, value) in which {
        let wide = plant.map(|_, _, value: f64| D::constant(value));
        let seeded = start.map(|its, value| toward(value, f64::from(u8::from(its == number))));
        let exact = end(&wide, &seeded, time, by).into_iter().map(|number| number.slope[0]).collect();
        let size = if value == 0.0 { 0.1 } else { value.abs() };
        let changed =
            |h: f64| end(plant, &start.map(|its, value| if its == number { value + h } else { value }), time, by);
        // At rest a velocity of either sign begins another motion.
        if matches!(number, StartNumber::Rate(..)) && value == 0.0 {
            continue;
        }
        all.push((format!("{number:?}"), size, exact, difference(accuracy(by)[1] * size, changed)));
    }
    let least = all.len() - 1;
    assert_alike(plant, &all, &end(plant, start, time, by), accuracy(by)[0], least);
}

#[test]
fn an_arm_on_a_manifold_by_all_of_its_parameters() {
    let (plant, start) = arm();
    check_parameters(&plant, &start, (0.036, LOCATED), 60);
}

#[test]
fn an_arm_on_a_manifold_by_its_start() {
    let (plant, start) = arm();
    check_start(&plant, &start, (0.036, LOCATED));
}

#[test]
fn masses_on_a_tendon_a_spool_and_a_regulator_by_all_of_their_parameters() {
    let (plant, start) = masses();
    check_parameters(&plant, &start, (0.07, LOCATED), 40);
}

#[test]
fn masses_by_their_start() {
    let (plant, start) = masses();
    check_start(&plant, &start, (0.07, LOCATED));
}

/// The borders of events, as the ends of joints and of a braid, move with the numbers that make them.
#[test]
fn an_arm_in_fixed_steps_by_all_of_its_parameters() {
    let (plant, start) = arm();
    for method in [Method::Rk4, Method::Stable] {
        check_parameters(&plant, &start, (0.036, TimeStepping::Fixed { method, step: 1e-4 }), 60);
    }
}

#[test]
fn masses_in_fixed_steps_by_all_of_their_parameters() {
    let (plant, start) = masses();
    check_parameters(&plant, &start, (0.07, TimeStepping::Fixed { method: Method::Stable, step: 1e-4 }), 40);
}

/// Two valves that open at one instant, of which a delay moves one alone: the state between the two counts.
#[test]
fn instants_of_one_value_differ_in_their_derivatives() {
    let ((plant, start), by) = (arm(), LOCATED);
    let of = |valve: usize, time: f64| {
        let is_it = |part: Option<Part>, row: &'static Parameter| {
            part == Some(Part::Valve(valve)) && row.key == "valve.opening_delay"
        };
        let seeded = plant.map(|part, row, value: f64| toward(value, f64::from(u8::from(is_it(part, row)))));
        let exact = end(&seeded, &start.map(|_, value| D::constant(value)), time, by);
        let changed = |h: f64| {
            end(&plant.map(|part, row, value| if is_it(part, row) { value + h } else { value }), &start, time, by)
        };
        (exact, difference(1e-7, changed))
    };
    for valve in 0..3 {
        let (exact, differences) = of(valve, 0.01);
        let own = plant.indices().actuators[valve].pressure;
        let [expected, _] = differences[own];
        assert!((exact[own].slope[0] - expected).abs() < 1e-3 * expected.abs(), "{valve}: {exact:?} {expected}");
        assert!(expected < -1e5, "{expected}");
    }
}

/// A hose is one part, whichever copies of it the network holds, and its delay goes with it.
#[test]
fn a_hose_is_given_out_as_its_first_node() {
    let (plant, _) = arm();
    let of = |key: &str| -> Vec<Option<Part>> {
        numbers(&plant).iter().filter(|(_, row, _)| row.key == key).map(|(part, ..)| *part).collect()
    };
    let hoses = of("hose.length");
    assert_eq!(hoses.len(), 2, "{hoses:?}");
    assert!(hoses.iter().all(|part| matches!(part, Some(Part::Node(_)))), "{hoses:?}");
    let same = plant.map(|_, _, value: f64| value);
    assert_eq!(plant, same);
}

/// A mass in its balance by its first velocity: the values rest while the derivatives swing, as a mass on the stiffness (5) of sealed
/// air with viscous friction does.
#[test]
fn a_mass_at_rest_by_its_first_velocity() {
    let viscous = 2.0;
    let paper = Paper::sealed().friction(viscous, 0.0).gauge(60.0 * PSI);
    let (rig, at) = (paper.rig(), paper.start());
    let mass = rig.load().inertia().expect("a mass").mass;
    let decay = 0.5 * viscous / mass;
    let swing = (rig.actuator().sealed_stiffness(at.length, at.pressure) / mass - decay * decay).sqrt();
    let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &at));
    let first = StartNumber::Rate(0, 0);
    let seeded = start.map(|its, value| toward(value, f64::from(u8::from(its == first))));
    let wide = plant.map(|_, _, value: f64| D::constant(value));
    let run = simulate_plant(&wide, &seeded, D::constant(2.0), 1e-8).expect("a run");
    for time in [0.02, 0.1, 0.5, 2.0] {
        let found = run.at(D::constant(time)).0[plant.indices().mechanisms[0].position(0)].slope[0];
        let closed = (-decay * time).exp() * (swing * time).sin() / swing;
        assert!((found - closed).abs() < 1e-6 / swing, "{time} s: {found} is not {closed}");
    }
}

/// The rates are continuous where an arm goes from one row of its table to the next: so are the derivatives of its angle.
#[test]
fn an_arm_that_passes_a_row_of_its_table_by_all_of_its_parameters() {
    let (plant, mut start) = arm();
    (start.positions[0][0], start.rates[0][0]) = (-0.02, 2.0);
    let run = simulate_plant(&plant, &start, 0.02, LOCATED).expect("a run");
    let passed = run.events().iter().find(|event| event.kind.kind == EventKind::MomentArm).expect("the row at zero");
    assert!(passed.time < 0.015, "{}", passed.time);
    check_parameters(&plant, &start, (0.02, LOCATED), 50);
    check_start(&plant, &start, (0.02, LOCATED));
}
