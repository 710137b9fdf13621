//! Plants that several tests run: muscles on one tank or bottle, and a leg on its belt.

use super::{GRAVITY, INCH, Paper, ROOM};
use mckibben::GaugePressure;
use mckibben::air::Process;
use mckibben::force::Effectiveness;
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Regulator, Reservoir};
use mckibben::load::{Load, MomentArm};
use mckibben::mechanism::{Arm, Belt, Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{InitialAir, Mounted, Plant, PlantStart};
use mckibben::simulation::{Actuation, InitialLength};
use mckibben::valve::{Command, Port, Request, RuntimeCommand, Solenoid, ValveKind};

/// A muscle of a plant on one tank.
pub(crate) struct Muscle {
    pub(crate) paper: Paper,
    pub(crate) hose: Option<Hose>,
    pub(crate) leak: Option<Leakage>,
    pub(crate) copies: f64,
}

impl Muscle {
    pub(crate) fn of(paper: Paper) -> Self {
        Self { paper, hose: None, leak: None, copies: 1.0 }
    }
}

/// Where the tank stands among the nodes of a plant on it.
pub(crate) const TANK: usize = 1;

/// Muscles with a load each, on one tank behind a regulator if there is one.
pub(crate) fn on_one_tank(tank: Reservoir, regulator: Option<Regulator>, muscles: &[Muscle]) -> (Plant, PlantStart) {
    let mut network = Network::new(&muscles[0].paper.air());
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let inlet = network.node(NodeKind::Reservoir(tank), 0.0, ROOM);
    if tank.compressor().is_some() {
        network.branch(outside, inlet, BranchKind::Compressor);
    }
    let set = 4e5;
    let feed = match regulator {
        Some(regulator) => network.node(NodeKind::Outlet { regulator, set, inlet: Some(inlet) }, set, ROOM),
        None => inlet,
    };
    let (mut actuators, mut mechanisms) = (Vec::new(), Vec::new());
    let mut start = PlantStart::default();
    for (index, Muscle { paper, hose, leak, copies }) in muscles.iter().enumerate() {
        let solenoid = Solenoid::new(paper.kind, paper.delays.0, paper.delays.1).expect("a solenoid");
        let command = paper.command.clone().unwrap_or(Command::Constant(Request::Hold));
        let valve = network.valve(Actuation { solenoid, command });
        let chamber = network.chamber(index, ROOM);
        let into = hose.map_or(chamber, |hose| network.hose(hose, chamber, 0.0));
        for (from, port) in [(feed, Port::Supply), (outside, Port::Exhaust)] {
            let law = *paper.valve().law_of(port);
            let copies = if port == Port::Supply { *copies } else { 1.0 };
            network.branch(from, into, BranchKind::Path { law, valve, port, ambient: false, copies });
        }
        if let Some(leak) = leak {
            network.branch(outside, chamber, BranchKind::Leak(*leak));
        }
        mechanisms.push(match paper.load {
            Load::HangingMass { mass, gravity } => {
                Mechanism::Mass(Mass::new(mass, Pull::Gravity(gravity), None).expect("a mass"))
            }
            _ => Mechanism::Fixed,
        });
        actuators.push(Mounted {
            actuator: paper.actuator().without_valve(),
            mechanism: index,
            coupling: Coupling::Direct { coordinate: 0 },
            tendon: None,
            pressure: None,
        });
        let own = paper.start();
        start.positions.push(vec![own.length]);
        start.rates.push(vec![own.velocity]);
        start.air.push(InitialAir { gauge_pressure: GaugePressure(paper.gauge), temperature: paper.temperature });
        start.lengths.push(None);
    }
    (Plant::new(actuators, network, mechanisms).expect("a plant"), start)
}

pub(crate) fn reservoir([volume, index]: [f64; 2], gauge: f64, compressor: Option<Compressor>) -> Reservoir {
    let air = Paper::sealed().air();
    Reservoir::new([volume, index, ROOM], GaugePressure(gauge), compressor, &air).expect("a reservoir")
}

/// Unlike muscles on one bottle or tank, with and without a regulator: laws, loads, processes, hoses and leaks by a row of
/// numbers that look random.
pub(crate) fn unlike_muscles_on_one_tank(seed: usize) -> (Plant, PlantStart) {
    let number = |column: usize, low: f64, high: f64| {
        let any = (12.9898 * (1 + seed) as f64 + 78.233 * column as f64).sin() * 43_758.545_3;
        low + (high - low) * (any - any.floor())
    };
    let air = Paper::sealed().air();
    let process = [
        Process::Isentropic,
        Process::Isothermal,
        Process::Polytropic { index: 1.15 },
        Process::EnergyBalance { heat_transfer: 0.3, wall_temperature: 300.0 },
    ];
    let muscles: Vec<Muscle> = (0..1 + seed % 5)
        .map(|i| {
            let at = |column: usize, low: f64, high: f64| number(20 * i + column, low, high);
            let command = Command::pwm(at(0, 5.0, 40.0), at(1, 0.2, 0.8), Request::Fill, Request::Exhaust);
            let paper = Paper::driven(command.expect("a command"))
                .mass(at(2, 1.0, 6.0))
                .process(process[(seed + i) % 4])
                .gauge(at(3, 1e5, 4e5))
                .with(|it| {
                    it.viscous = at(4, 0.0, 10.0);
                    it.coulomb_width = if at(5, 0.0, 1.0) < 0.3 { 0.0 } else { at(6, 1e-5, 2e-4) };
                    it.external_volume = at(7, 1e-6, 1e-5);
                    it.effectiveness = Effectiveness::Constant(at(8, 0.8, 1.0));
                    it.temperature = at(9, 280.0, 320.0);
                    it.length = InitialLength::At(at(10, 3.2, 3.9) * INCH);
                });
            let kind = [HoseKind::Lumped, HoseKind::Distributed { cells: 2 }][i % 2];
            let hose = Hose::new(kind, [at(11, 0.1, 1.5), 3e-3], [1.8e-5, at(12, 280.0, 310.0), 1.1], &air);
            Muscle {
                paper,
                hose: (at(13, 0.0, 1.0) < 0.5).then(|| hose.expect("a hose")),
                leak: (at(14, 0.0, 1.0) < 0.5).then(|| Leakage::new(1e-11).expect("a leak")),
                copies: if at(15, 0.0, 1.0) < 0.2 { 3.0 } else { 1.0 },
            }
        })
        .collect();
    let switch = [GaugePressure(5e5), GaugePressure(6e5)];
    let compressor = Compressor::new([number(101, 1e-5, 5e-4), 0.03], switch, &air).expect("a compressor");
    let with_compressor = seed.is_multiple_of(3).then_some(compressor);
    let tank = reservoir([number(102, 2e-5, 2e-3), number(103, 1.0, 1.4)], 5.5e5, with_compressor);
    let regulator = seed.is_multiple_of(2).then(|| Regulator::new(2e7, 1e3, 0.01).expect("a regulator"));
    on_one_tank(tank, regulator, &muscles)
}

/// Two joints with gravity, stops and a belt, and four muscles like that of a paper, sealed.
pub(crate) fn leg_on_its_belt(paper: &Paper) -> (Plant, PlantStart) {
    let stops = JointStops { ends: [Some(-0.6), Some(0.6)], stiffness: 50.0, damping: 0.3 };
    let joint = Revolute { torque: 0.1, damping: 0.01, stops };
    let segment = |mass| ChainSegment { length: 0.22, mass, distance: 0.1, inertia: 1e-3 };
    let belt = Belt { depth: 0.43, velocity: -0.3, stiffness: 2e4, damping: 30.0, friction: 0.5, slipping_speed: 0.02 };
    let chain = Chain::new(vec![segment(0.4), segment(0.3)], vec![joint, joint], [GRAVITY, 0.0], Some(belt));
    let pulleys: [[f64; 2]; 4] = [[0.018, 0.0], [-0.018, 0.0], [0.0, 0.015], [-0.008, -0.008]];
    let mounted = pulleys.map(|radii| {
        let arms = radii.iter().enumerate().filter(|(_, radius)| **radius != 0.0).map(|(joint, radius)| Arm {
            joint,
            sign: radius.signum(),
            arm: MomentArm::Pulley(radius.abs()),
        });
        Mounted {
            actuator: paper.actuator(),
            mechanism: 0,
            coupling: Coupling::arms(0.085, arms.collect()).expect("a coupling"),
            tendon: None,
            pressure: None,
        }
    });
    let network = Network::new(&paper.air());
    let mechanism = Mechanism::Chain(chain.expect("a chain"));
    let plant = Plant::new(mounted.to_vec(), network, vec![mechanism]).expect("a plant");
    let air = |gauge| InitialAir { gauge_pressure: GaugePressure(gauge), temperature: ROOM };
    let start = PlantStart {
        positions: vec![vec![0.5, -0.5]],
        rates: vec![vec![-3.0, 2.0]],
        air: [2e5, 1e5, 5e4, 1.5e5].map(air).to_vec(),
        lengths: vec![None; 4],
        ..PlantStart::default()
    };
    (plant, start)
}

/// Two unlike actuators with their valves on one bottle, and a mass that a third one carries.
pub(crate) fn on_a_bottle() -> (Plant, PlantStart, usize) {
    let papers =
        [Paper::sealed().gauge(1e5), Paper::sealed().gauge(2e5).friction(20.0, 1e-4), Paper::sealed().gauge(3e5)];
    let air = papers[0].air();
    let mut network = Network::new(&air);
    let bottle = Reservoir::new([3e-4, 1.4, ROOM], GaugePressure(7e5), None, &air).expect("a bottle");
    let bottle = network.node(NodeKind::Reservoir(bottle), 0.0, ROOM);
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    for index in 0..papers.len() {
        let solenoid = Solenoid::new(ValveKind::FillHoldExhaust, 4e-3, 2e-3).expect("a solenoid");
        let valve = network.valve(Actuation { solenoid, command: Command::Constant(Request::Hold) });
        let chamber = network.chamber(index, ROOM);
        for (from, port) in [(bottle, Port::Supply), (outside, Port::Exhaust)] {
            let law = *papers[0].valve().law_of(port);
            network.branch(from, chamber, BranchKind::Path { law, valve, port, ambient: false, copies: 1.0 });
        }
    }
    let mounted = papers.iter().enumerate().map(|(index, paper)| Mounted {
        actuator: paper.actuator().without_valve(),
        mechanism: usize::from(index == 2),
        coupling: Coupling::Direct { coordinate: index % 2 },
        tendon: None,
        pressure: None,
    });
    let mass = Mechanism::Mass(Mass::new(3.0, Pull::Gravity(9.81), None).expect("a mass"));
    let plant = Plant::new(mounted.collect(), network, vec![external(2), mass]).expect("a plant");
    let start = PlantStart {
        positions: vec![vec![0.085, 0.088], vec![0.086]],
        rates: vec![vec![0.0; 2], vec![0.0]],
        air: papers
            .iter()
            .map(|paper| InitialAir { gauge_pressure: GaugePressure(paper.gauge), temperature: ROOM })
            .collect(),
        lengths: vec![None; 3],
        ..PlantStart::default()
    };
    (plant, start, bottle)
}

/// What a host commands the three valves in a step of 1 ms, if anything, and where it moves the ends.
pub(crate) fn requested(count: i32) -> (Option<[RuntimeCommand; 3]>, [f64; 2]) {
    let phase = f64::from(count) * 0.05;
    let pulses = RuntimeCommand::Pulses { frequency: 25.0, duty: 0.4, pulse: Request::Fill, rest: Request::Exhaust };
    let second = if count % 80 == 0 { Request::Fill } else { Request::Exhaust };
    let commands = [pulses, second.into(), Request::Fill.into()];
    ((count % 40 == 0).then_some(commands), [0.085 + 2e-3 * phase.sin(), 0.088 - 1e-3 * phase.cos() + 1e-3])
}

pub(crate) fn external(distances: usize) -> Mechanism {
    Mechanism::External { distances }
}
