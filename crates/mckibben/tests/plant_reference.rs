//! Plants that no rig and no joint is, against the independent program of `validation/`, state by state.
//!
//! The numbers of each plant stand here and in `validation/plants.py`, which integrates it in Python and SciPy without sight
//! of this code, and determines by brute force which actuators stick. Its runs are computed beforehand into the folder that the
//! environment variable `MCKIBBEN_REFERENCE` names.

use crate::common::{GRAVITY, INCH, LB, PSI, Paper, ROOM};
use mckibben::GaugePressure;
use mckibben::line::{Hose, HoseKind, Reservoir};
use mckibben::load::{MomentArm, SeriesTendon};
use mckibben::mechanism::{Arm, Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{InitialAir, Mounted, Plant, PlantStart, PlantTrajectory, simulate_plant};
use mckibben::simulation::Actuation;
use mckibben::valve::{Command, FlowStandard, Port, Request, Solenoid, ValveKind};

use Request::{Exhaust, Fill, Hold};

/// What an error may be at a relative tolerance of 1e-10, as a part of the state's range over the run.
const PART_OF_RANGE: f64 = 1e-6;
/// Distance of the ends of a muscle of a joint at angles zero.
const REST: f64 = 3.3 * INCH;

/// The reference run of a plant: names of the columns, rows.
fn reference(name: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let folder = std::env::var("MCKIBBEN_REFERENCE").unwrap_or_else(|_| {
        panic!(
            "MCKIBBEN_REFERENCE does not name the folder with the reference's runs. `cargo xtask test` computes them and \
             sets it; by hand: `python validation/plants.py FOLDER/plants`, then set MCKIBBEN_REFERENCE=FOLDER"
        )
    });
    let path = std::path::Path::new(&folder).join("plants").join(format!("{name}.csv"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines();
    let header = lines.next().expect("a header").split(',').map(str::to_owned).collect();
    let number = |text: &str| text.parse::<f64>().expect("a number");
    (header, lines.map(|line| line.split(',').map(number).collect()).collect())
}

/// The place of a column's state in the plant.
fn place(plant: &Plant, column: &str) -> usize {
    let places = plant.indices();
    let nodes = &plant.network().nodes;
    let (what, index) = column.rsplit_once('_').map_or((column, 0), |(what, index)| (what, index.parse().unwrap_or(0)));
    // Coordinates are counted through all mechanisms.
    let coordinate = || {
        let mut left = index;
        places.mechanisms.iter().find_map(|its| {
            let found = (left < its.coordinates).then_some((its, left));
            left = left.wrapping_sub(its.coordinates);
            found
        })
    };
    match what {
        "position" => coordinate().map(|(its, k)| its.position(k)).expect("a coordinate"),
        "rate" => coordinate().map(|(its, k)| its.rate(k)).expect("a coordinate"),
        "pressure" => places.actuators[index].pressure,
        "air_mass" => places.actuators[index].mass(),
        "reservoir" => {
            let tank = nodes.iter().position(|node| matches!(node.kind, NodeKind::Reservoir(_))).expect("a reservoir");
            places.nodes[tank].expect("a state")
        }
        _ => panic!("no state is called {column}"),
    }
}

/// Holds a plant to its reference run; the run.
fn compare(name: &str, plant: &Plant, start: &PlantStart) -> PlantTrajectory {
    let (header, rows) = reference(name);
    let duration = rows.last().expect("rows")[0];
    let run = simulate_plant(plant, start, duration, 1e-10).unwrap_or_else(|error| panic!("{name}: {error}"));
    let states: Vec<Vec<f64>> = rows.iter().map(|row| run.at(row[0]).0).collect();
    let mut faults = Vec::new();
    for (column, title) in header.iter().enumerate().skip(1) {
        let state = place(plant, title);
        let (mut low, mut high, mut worst, mut at) = (f64::MAX, f64::MIN, 0.0_f64, 0.0);
        for (row, ours) in rows.iter().zip(&states) {
            (low, high) = (low.min(row[column]), high.max(row[column]));
            let gap = (row[column] - ours[state]).abs();
            if gap > worst || gap.is_nan() {
                (worst, at) = (gap, row[0]);
            }
        }
        println!("{name}: {title} is off by {:.1e} of its range", worst / (high - low));
        if worst.is_nan() || worst > PART_OF_RANGE * (high - low) {
            faults.push(format!("{title} is off by {worst:.1e} at {at} s, range {:.3e}", high - low));
        }
    }
    assert!(faults.is_empty(), "{name}:\n{}", faults.join("\n"));
    run
}

fn paper(viscous: f64, width: f64) -> Paper {
    Paper::driven(Command::Constant(Hold)).with(|it| (it.viscous, it.coulomb_width) = (viscous, width))
}

fn table(rows: &[(f64, Request)]) -> Command {
    let (times, requests) = rows.iter().copied().unzip();
    Command::table(times, requests).expect("a command")
}

fn mounted(paper: &Paper, mechanism: usize, coupling: Coupling, tendon: Option<SeriesTendon>) -> Mounted {
    Mounted { actuator: paper.actuator().without_valve(), mechanism, coupling, tendon, pressure: None }
}

/// Joins an actuator through a valve to the node `feed`; through a hose if there is one.
fn join(
    network: &mut Network,
    index: usize,
    paper: &Paper,
    feed: usize,
    kind: ValveKind,
    command: Command,
    hose: Option<Hose>,
) {
    let solenoid = Solenoid::new(kind, paper.delays.0, paper.delays.1).expect("a solenoid");
    let valve = network.valve(Actuation { solenoid, command });
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let chamber = network.chamber(index, ROOM);
    let into = hose.map_or(chamber, |hose| network.hose(hose, chamber, 0.0));
    for (from, port) in [(feed, Port::Supply), (outside, Port::Exhaust)] {
        let kind = BranchKind::Path { law: paper.flow_law(), valve, port, ambient: false, copies: 1.0 };
        network.branch(from, into, kind);
    }
}

fn air(psi: &[f64]) -> Vec<InitialAir> {
    psi.iter().map(|psi| InitialAir { gauge_pressure: GaugePressure(psi * PSI), temperature: ROOM }).collect()
}

/// A pulley of a signed radius about a joint: above zero it turns the joint towards greater angles.
fn pulley(joint: usize, radius: f64) -> Arm {
    Arm { joint, sign: radius.signum(), arm: MomentArm::Pulley(radius.abs()) }
}

fn arms(rest_length: f64, arms: Vec<Arm>) -> Coupling {
    Coupling::arms(rest_length, arms).expect("arms")
}

fn chain(segments: Vec<ChainSegment>, damping: &[f64]) -> Mechanism {
    let stops = JointStops { ends: [None, None], stiffness: 500.0, damping: 1.0 };
    let joints = damping.iter().map(|&damping| Revolute { torque: 0.0, damping, stops }).collect();
    Mechanism::Chain(Chain::new(segments, joints, [GRAVITY, 0.0], None).expect("a chain"))
}

/// The limb of the joints.
fn limb() -> Mechanism {
    chain(vec![ChainSegment { length: 0.0, mass: 0.5, distance: 0.1, inertia: 1e-3 }], &[0.02])
}

/// The commands of the joints' two valves.
fn two_commands() -> [Command; 2] {
    [
        table(&[(0.0, Fill), (0.05, Hold), (0.15, Exhaust), (0.18, Hold)]),
        table(&[(0.0, Hold), (0.15, Fill), (0.19, Hold)]),
    ]
}

#[test]
fn a_joint_with_a_hose_on_each_muscle() {
    let paper = Paper::driven(Command::Constant(Hold));
    let mut network = Network::new(&paper.air());
    let hose = |kind, size, index| Hose::new(kind, size, [1.82e-5, ROOM, index], &paper.air()).expect("a hose");
    let hoses =
        [hose(HoseKind::Lumped, [1.0, 2.5e-3], 1.0), hose(HoseKind::Distributed { cells: 2 }, [1.5, 3e-3], 1.2)];
    for ((index, command), hose) in two_commands().into_iter().enumerate().zip(hoses) {
        let feed = network.node(NodeKind::Source, 60.0 * PSI, ROOM);
        join(&mut network, index, &paper, feed, ValveKind::FillHoldExhaust, command, Some(hose));
    }
    let actuators = [0.015, -0.015].map(|r| mounted(&paper, 0, arms(REST, vec![pulley(0, r)]), None));
    let plant = Plant::new(actuators.to_vec(), network, vec![limb()]).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![0.0]],
        rates: vec![vec![0.0]],
        air: air(&[20.0, 20.0]),
        lengths: vec![None; 2],
        ..PlantStart::default()
    };
    compare("joint-with-hoses", &plant, &start);
}

#[test]
fn three_unlike_muscles_on_one_bottle() {
    let first = Paper::driven(Command::Constant(Hold));
    let iso = FlowStandard::Iso6358 { sonic_conductance: 3e-9, critical_ratio: 0.3 };
    let second = first.clone().friction(5.0, 5e-5).with(|it| (it.turns, it.standard, it.efficiency) = (2.2, iso, 1.0));
    let third =
        first.clone().friction(8.0, 1e-4).with(|it| (it.thread_length, it.turns, it.max_length) = (0.2, 4.0, 0.18));
    let mut network = Network::new(&first.air());
    let bottle = Reservoir::new([80e-6, 1.2, ROOM], GaugePressure(90.0 * PSI), None, &first.air()).expect("a bottle");
    let feed = network.node(NodeKind::Reservoir(bottle), 0.0, ROOM);
    let pwm = |frequency, duty| Command::pwm(frequency, duty, Fill, Exhaust).expect("pulses");
    let last = table(&[(0.0, Hold), (0.02, Fill), (0.1, Hold), (0.2, Exhaust)]);
    join(&mut network, 0, &first, feed, ValveKind::ThreeWay, pwm(25.0, 0.5), None);
    join(&mut network, 1, &second, feed, ValveKind::ThreeWay, pwm(10.0, 0.4), None);
    join(&mut network, 2, &third, feed, ValveKind::FillHoldExhaust, last, None);
    let papers = [first, second, third];
    let direct = Coupling::Direct { coordinate: 0 };
    let actuators = papers.iter().enumerate().map(|(k, its)| mounted(its, k, direct.clone(), None)).collect();
    let load = |mass| Mechanism::Mass(Mass::new(mass, Pull::Gravity(GRAVITY), None).expect("a mass"));
    let plant = Plant::new(actuators, network, [5.0 * LB, 3.0, 4.0].map(load).to_vec()).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![0.09], vec![0.088], vec![0.16]],
        rates: vec![vec![0.0]; 3],
        air: air(&[20.0, 25.0, 30.0]),
        lengths: vec![None; 3],
        ..PlantStart::default()
    };
    compare("unlike-on-a-bottle", &plant, &start);
}

#[test]
fn a_chain_of_two_joints_with_four_muscles_that_stick() {
    let paper = paper(3.0, 8e-3);
    let mut network = Network::new(&paper.air());
    let commands = [
        table(&[(0.0, Hold), (0.05, Fill), (0.09, Hold), (0.35, Exhaust), (0.37, Hold)]),
        table(&[(0.0, Hold), (0.3, Fill), (0.33, Hold)]),
        table(&[(0.0, Hold), (0.05, Exhaust), (0.1, Hold), (0.4, Fill), (0.41, Hold)]),
        table(&[(0.0, Hold), (0.45, Fill), (0.48, Hold)]),
    ];
    for (index, command) in commands.into_iter().enumerate() {
        let feed = network.node(NodeKind::Source, 80.0 * PSI, ROOM);
        join(&mut network, index, &paper, feed, ValveKind::FillHoldExhaust, command, None);
    }
    let couplings = [
        vec![pulley(0, 0.015)],
        vec![pulley(0, -0.015)],
        vec![pulley(1, 0.012)],
        vec![pulley(0, -0.010), pulley(1, -0.012)],
    ];
    let actuators = couplings.map(|its| mounted(&paper, 0, arms(REST, its), None)).to_vec();
    let segments = vec![
        ChainSegment { length: 0.3, mass: 1.0, distance: 0.15, inertia: 0.01 },
        ChainSegment { length: 0.25, mass: 0.6, distance: 0.12, inertia: 0.004 },
    ];
    let plant = Plant::new(actuators, network, vec![chain(segments, &[0.02, 0.01])]).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![0.1, -0.2]],
        rates: vec![vec![0.0, 0.0]],
        air: air(&[40.0, 35.0, 40.0, 30.0]),
        lengths: vec![None; 4],
        ..PlantStart::default()
    };
    compare("chain-that-sticks", &plant, &start);
}

#[test]
fn a_joint_one_of_whose_muscles_pulls_by_a_tendon() {
    let paper = Paper::driven(Command::Constant(Hold));
    let mut network = Network::new(&paper.air());
    for (index, command) in two_commands().into_iter().enumerate() {
        let feed = network.node(NodeKind::Source, 60.0 * PSI, ROOM);
        join(&mut network, index, &paper, feed, ValveKind::FillHoldExhaust, command, None);
    }
    let tendon = SeriesTendon::new(12e3, 0.04).expect("a tendon");
    let actuators = vec![
        mounted(&paper, 0, arms(REST + 0.04, vec![pulley(0, 0.015)]), Some(tendon)),
        mounted(&paper, 0, arms(REST, vec![pulley(0, -0.015)]), None),
    ];
    let plant = Plant::new(actuators, network, vec![limb()]).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![0.0]],
        rates: vec![vec![0.0]],
        air: air(&[20.0, 20.0]),
        lengths: vec![Some(0.0825), None],
        ..PlantStart::default()
    };
    compare("tendon-on-a-joint", &plant, &start);
}
