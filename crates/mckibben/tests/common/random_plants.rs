//! Random plants: muscles alike or not with every law of force and friction, on random trees of air and random mechanisms.

use super::joint::moment_arm;
use super::random::{Case, cases, seeded_runner};
use super::{ATMOSPHERE, GRAVITY, INCH, Paper, ROOM, laws};
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir};
use mckibben::load::{Load, Motion, SeriesTendon};
use mckibben::mechanism::{
    Arm, Attachment, Belt, Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute, Spring,
};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{InitialAir, InitialFriction, Mounted, Plant, PlantStart};
use mckibben::simulation::{Actuation, PressureSeries};
use mckibben::valve::{self, Command, Ramp, Request, Solenoid, Spool, ValveKind};
use mckibben::{Error, GaugePressure};
use proptest::prelude::*;
use proptest::strategy::ValueTree;

/// Numbers from 0 to 1 that are read one after the other, from the first again after the last.
struct Draws<'d> {
    numbers: &'d [f64],
    next: usize,
}

impl Draws<'_> {
    fn number(&mut self) -> f64 {
        self.next += 1;
        self.numbers[(self.next - 1) % self.numbers.len()]
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.number()
    }

    fn decades(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.number())
    }

    fn chance(&mut self, share: f64) -> bool {
        self.number() < share
    }

    fn pick(&mut self, count: usize) -> usize {
        ((self.number() * count as f64) as usize).min(count - 1)
    }
}

/// A muscle, and what is drawn for it besides.
type Muscle = (Case, Vec<f64>);

#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    muscles: Vec<Muscle>,
    shared: Vec<f64>,
}

pub(crate) fn drawn() -> impl Strategy<Value = Drawn> {
    let numbers = |count: usize| prop::collection::vec(0.0..1.0_f64, count);
    let muscles = prop::collection::vec((cases(), numbers(61)), 1..=6);
    (muscles, numbers(83)).prop_map(|(muscles, shared)| Drawn { muscles, shared })
}

/// The plant of a number.
pub(crate) fn numbered(number: u64) -> Drawn {
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&number.wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes());
    drawn().new_tree(&mut seeded_runner(1, seed)).expect("a case").current()
}

/// All lengths of a braid times a factor.
fn scaled(paper: Paper, factor: f64) -> Paper {
    paper.with(|it| {
        it.thread_length *= factor;
        it.max_length *= factor;
        it.min_length = it.min_length.map(|length| length * factor);
    })
}

/// Now and then the paper's braid with one of the laws of force that are fitted to it.
fn with_law(paper: &Paper, at: &mut Draws<'_>) -> Paper {
    if !at.chance(0.4) {
        return paper.clone();
    }
    let own = Paper::sealed();
    let weight = 20.0 * 50.0 * GRAVITY;
    let braid = paper.clone().with(|it| {
        (it.thread_length, it.turns, it.max_length) = (own.thread_length, own.turns, own.max_length);
        it.min_length = Some(2.7 * INCH);
        it.limit_stiffness = it.limit_stiffness.max(weight / (own.thread_length - own.max_length));
    });
    let mut laws = laws::all(&braid);
    laws.push(("measured", laws::measured(&braid)));
    let law = laws.swap_remove(at.pick(laws.len())).1;
    braid.with(|it| it.characteristic = Some(law))
}

/// The node that a muscle draws from, out of what several share.
fn feeds(network: &mut Network, outside: usize, paper: &Paper, at: &mut Draws<'_>) -> Vec<usize> {
    let air = paper.air();
    let gauge = at.between(5e4, 9e5);
    let reservoir = |volume: f64, gauge: f64, compressor, index: f64| {
        Reservoir::new([volume, index, ROOM], GaugePressure(gauge), compressor, &air).expect("a reservoir")
    };
    let index = at.between(1.0, 1.4);
    let kind = at.pick(3);
    let tank = match kind {
        0 => None,
        1 => Some(reservoir(at.decades(1e-5, 1e-2), gauge, None, index)),
        _ => {
            let ends = [at.between(0.7, 1.2), at.between(1.25, 1.6)].map(|part| GaugePressure(part * gauge));
            let its = [at.decades(1e-6, 1e-3), at.between(0.0, 0.1)];
            let compressor = Compressor::new(its, ends, &air).expect("a compressor");
            Some(reservoir(at.decades(1e-5, 1e-2), gauge, Some(compressor), index))
        }
    };
    let regulator = at.chance(0.4).then(|| {
        let droop = if at.chance(0.3) { 0.0 } else { at.decades(1e6, 1e9) };
        let band = if at.chance(0.4) { 0.0 } else { at.decades(10.0, 2e4) };
        Regulator::new(droop, band, at.decades(1e-3, 0.1)).expect("a regulator")
    });
    let set = if regulator.is_some() { at.between(0.3, 1.1) * gauge } else { gauge };
    let supply = network.supply([set, ROOM], tank.as_ref(), regulator.as_ref(), None, outside);
    let mut feeds = vec![supply.outlet];
    if at.chance(0.4) {
        let manifold =
            reservoir(at.decades(1e-6, 1e-3), at.between(0.0, 0.9) * gauge, None, 1.0 + at.between(0.0, 0.4));
        let manifold = network.node(NodeKind::Reservoir(manifold), 0.0, ROOM);
        let into = if at.chance(0.5) { network.hose(hose(paper, at), manifold, 0.5 * gauge) } else { manifold };
        let law = paper.flow_law();
        network.branch(supply.outlet, into, BranchKind::Check { law });
        feeds.push(manifold);
    }
    feeds
}

fn hose(paper: &Paper, at: &mut Draws<'_>) -> Hose {
    let kind = if at.chance(0.5) { HoseKind::Lumped } else { HoseKind::Distributed { cells: 1 + at.pick(5) } };
    let size = [at.decades(0.05, 5.0), at.decades(1e-3, 8e-3)];
    Hose::new(kind, size, [1.8e-5, at.between(270.0, 320.0), at.between(1.0, 1.4)], &paper.air()).expect("a hose")
}

/// A command and the valve that follows it, of any kind.
fn actuation(paper: &Paper, duration: f64, at: &mut Draws<'_>) -> Option<Actuation> {
    let times = [0.0, at.between(0.1, 0.4), at.between(0.45, 0.9)].map(|part| part * duration).to_vec();
    let solenoid = || Solenoid::new(paper.kind, paper.delays.0, paper.delays.1);
    let seats = |command: Command| Actuation { solenoid: solenoid().expect("a solenoid"), command };
    Some(match at.pick(10) {
        0 => {
            let set = [at.between(0.0, 6e5), at.between(0.0, 6e5), at.between(0.0, 6e5)].to_vec();
            let regulator = valve::Regulator::new(at.decades(2e-3, 0.2), at.between(0.0, 0.02), at.decades(1e5, 1e8));
            Actuation {
                solenoid: Solenoid::regulating(regulator.expect("a regulator")),
                command: Command::set_points(times, set).expect("set points"),
            }
        }
        1 => {
            let overlap = [at.between(-0.3, 0.3), at.between(-0.3, 0.3)];
            let spool = Spool::new(at.decades(5.0, 100.0), at.decades(0.2, 2.0), overlap[0], overlap[1]);
            let positions = [at.between(-1.0, 1.0), at.between(-1.0, 1.0), at.between(-1.0, 1.0)].to_vec();
            Actuation {
                solenoid: Solenoid::proportional(spool.expect("a spool")),
                command: Command::positions(times, positions).expect("positions"),
            }
        }
        2 => {
            let requests = match paper.kind {
                ValveKind::FillHoldExhaust => [Request::Fill, Request::Hold, Request::Exhaust],
                _ => [Request::Fill, Request::Exhaust, Request::Fill],
            };
            seats(Command::table(times, requests.to_vec()).expect("a table"))
        }
        3 => {
            let ramp = Ramp::new(at.between(0.0, 5e-3), at.between(0.0, 5e-3)).expect("a ramp");
            let solenoid = solenoid().and_then(|it| it.with_ramp(ramp).with_dead_time(at.between(0.0, 5e-3)));
            Actuation { solenoid: solenoid.expect("a solenoid"), command: paper.command.clone()? }
        }
        _ => seats(paper.command.clone()?),
    })
}

/// A chain of one to three joints for a muscle of a thread length.
fn chain(thread: f64, at: &mut Draws<'_>) -> Chain {
    let count = 1 + at.pick(3);
    let mut length = 0.0;
    let (mut segments, mut joints) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let segment = ChainSegment {
            length: at.between(0.5, 3.0) * thread,
            mass: at.decades(0.01, 5.0),
            distance: at.between(0.0, 1.5) * thread,
            inertia: at.decades(1e-4, 1e-1),
        };
        length += segment.length;
        let low = at.chance(0.4).then(|| at.between(-0.6, -0.01));
        let high = at.chance(0.4).then(|| at.between(0.01, 0.6));
        let stops = JointStops { ends: [low, high], stiffness: at.decades(10.0, 1e4), damping: at.between(0.0, 3.0) };
        let damping = if at.chance(0.3) { 0.0 } else { at.decades(1e-4, 1.0) };
        let torque = if at.chance(0.7) { 0.0 } else { at.between(-1.0, 1.0) };
        segments.push(segment);
        joints.push(Revolute { torque, damping, stops });
    }
    let belt = at.chance(0.2).then(|| Belt {
        depth: at.between(0.9, 1.0) * length,
        velocity: at.between(-1.0, 1.0),
        stiffness: at.decades(1e3, 1e5),
        damping: at.between(0.0, 100.0),
        friction: at.between(0.0, 1.0),
        slipping_speed: at.decades(1e-3, 0.1),
    });
    let hanging = if at.chance(0.5) { 0.0 } else { at.between(-3.0, 3.0) };
    Chain::new(segments, joints, [if at.chance(0.2) { 0.0 } else { GRAVITY }, hanging], belt).expect("a chain")
}

/// How a muscle spans a chain, and its braid, of a size that fits.
fn on_chain(paper: Paper, chain: &Chain, angles: &[f64], at: &mut Draws<'_>) -> (Coupling, Paper) {
    let count = chain.joints().len();
    if paper.characteristic.is_none() && at.chance(0.3) {
        let segment = at.pick(count);
        let ground = [at.between(-1.0, 1.0), at.between(0.1, 0.5)].map(|part| part * paper.thread_length);
        let place = [at.between(0.2, 1.0), at.between(-0.2, 0.2)].map(|part| part * paper.thread_length);
        let from = (segment > 0 && at.chance(0.5)).then(|| segment - 1);
        let ends = [Attachment { segment: from, place: ground }, Attachment { segment: Some(segment), place }];
        let coupling = Coupling::Points(ends);
        let span = coupling.span(&Mechanism::Chain(chain.clone()), angles);
        let share = at.between(0.6, 1.0);
        let factor = span / (share * paper.max_length);
        return (coupling, scaled(paper, factor));
    }
    let first = at.pick(count);
    let several = at.chance(0.3);
    let arms = (0..count).filter(|joint| *joint == first || several).map(|joint| Arm {
        joint,
        sign: if at.chance(0.5) { 1.0 } else { -1.0 },
        arm: moment_arm(at.between(0.02, 0.4) * paper.thread_length, at.chance(0.4)),
    });
    let arms = arms.collect();
    let rest = at.between(0.5, 1.0) * paper.max_length;
    (Coupling::arms(rest, arms).expect("a coupling"), paper)
}

/// The mechanism that begins with a muscle, with its coordinates and rates at the start.
fn mechanism(paper: &Paper, at: &mut Draws<'_>) -> (Mechanism, Vec<f64>, Vec<f64>) {
    let length = at.between(0.45, 1.0) * paper.max_length;
    let rate = if at.chance(0.5) { 0.0 } else { at.between(-0.5, 0.5) };
    let spring = at.chance(0.2).then(|| Spring { stiffness: at.decades(10.0, 1e5), rest_length: length });
    if at.chance(0.4) {
        let chain = chain(paper.thread_length, at);
        let angles: Vec<f64> = chain.joints().iter().map(|_| at.between(-0.5, 0.5)).collect();
        let at_rest = at.chance(0.4);
        let rates = angles.iter().map(|_| if at_rest { 0.0 } else { at.between(-3.0, 3.0) }).collect();
        return (Mechanism::Chain(chain), angles, rates);
    }
    let mass = |mass: f64, pull: Pull| Mechanism::Mass(Mass::new(mass, pull, spring).expect("a mass"));
    let mechanism = match &paper.load {
        Load::HangingMass { mass: kg, gravity } => mass(*kg, Pull::Gravity(*gravity)),
        Load::ConstantForce { mass: kg, force } => mass(*kg, Pull::Force(*force)),
        Load::Isometric if at.chance(0.5) => Mechanism::External { distances: 1 },
        Load::Isometric => Mechanism::Fixed,
        Load::Prescribed(_) => {
            let b = paper.thread_length;
            let its = [at.between(0.4, 0.7) * b, at.between(0.0, 0.25) * b, at.between(0.5, 20.0)];
            let motion = Motion::sinusoid(its[0], its[1], its[2], 0.3, b);
            Mechanism::Prescribed(motion.expect("a motion"))
        }
    };
    (mechanism, vec![length], vec![rate])
}

/// The plant that was drawn, how it starts, and how long it runs in s.
pub(crate) fn plant(drawn: &Drawn) -> (Result<Plant, Error>, PlantStart, f64) {
    let shared = &mut Draws { numbers: &drawn.shared, next: 0 };
    let (Case { paper: first, duration, .. }, _) = &drawn.muscles[0];
    let mut network = Network::new(&first.air());
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let feeds = feeds(&mut network, outside, first, shared);
    let (mut actuators, mut mechanisms) = (Vec::new(), Vec::<Mechanism>::new());
    let mut start = PlantStart::default();
    let mut begun = first.clone();
    for (index, (case, numbers)) in drawn.muscles.iter().enumerate() {
        let at = &mut Draws { numbers, next: 0 };
        let alike = index > 0 && shared.chance(0.2);
        let mut paper = with_law(if alike { first } else { &case.paper }, at);
        if index == 0 || shared.chance(0.4) {
            let (mechanism, positions, rates) = mechanism(&paper, at);
            mechanisms.push(mechanism);
            start.positions.push(positions);
            start.rates.push(rates);
            begun = paper.clone();
        }
        let m = mechanisms.len() - 1;
        let coupling = match &mechanisms[m] {
            Mechanism::Chain(chain) => {
                let (coupling, its) = on_chain(paper, chain, &start.positions[m], at);
                paper = its;
                coupling
            }
            // What pulls on one mass has one length.
            _ => {
                paper = paper.with(|it| {
                    (it.thread_length, it.turns, it.max_length) = (begun.thread_length, begun.turns, begun.max_length);
                    (it.min_length, it.limit_stiffness) = (begun.min_length, begun.limit_stiffness);
                    it.characteristic = begun.characteristic.clone();
                });
                Coupling::Direct { coordinate: 0 }
            }
        };
        let given = paper.characteristic.is_none() && at.chance(0.05);
        let mut tendon = None;
        let mut length = None;
        if !given && paper.characteristic.is_none() && at.chance(0.3) {
            let span = coupling.span(&mechanisms[m], &start.positions[m]);
            paper = scaled(paper, 0.7);
            let stretch = at.between(-2e-3, 4e-3) * span;
            tendon = Some(SeriesTendon::new(at.decades(1e3, 1e6), (0.3 * span - stretch).max(0.0)).expect("a tendon"));
            let viscous = at.decades(0.3, 30.0);
            paper.viscous = if at.chance(0.3) { 0.0 } else { paper.viscous.max(viscous) };
            if paper.viscous == 0.0 {
                paper.structural = 0.0;
            }
            length = at.chance(0.7).then_some(0.7 * span);
        }
        let line = Line {
            hose: at.chance(0.4).then(|| hose(&paper, at)),
            leakage: (!given && at.chance(0.25)).then(|| Leakage::new(at.decades(1e-13, 1e-9)).expect("a leak")),
            ..Line::NONE
        };
        let actuator = paper.actuator().with_valve(paper.valve());
        let copies = if at.chance(0.15) { 3.0 } else { 1.0 };
        let actuation = actuation(&paper, *duration, at).filter(|_| !given);
        let supply = paper.supply_gauge.max(-0.9 * ATMOSPHERE);
        let feed = match at.pick(3) {
            0 => network.node(NodeKind::Source, supply, paper.supply_temperature),
            _ => feeds[at.pick(feeds.len())],
        };
        let times = [0.0, 0.4 * duration, 0.8 * duration];
        let samples = PressureSeries::new(&times, &[at.between(0.0, 5e5), at.between(0.0, 5e5), at.between(-5e4, 5e5)]);
        // With a hose it stands at the end that a valve would open into.
        let series = given.then(|| samples.expect("a time series"));
        let driven = (actuation.as_ref(), series.as_ref());
        network.draw(index, &actuator, driven, &line, [feed, outside], copies);
        let friction = match (paper.hysteresis.is_some(), at.pick(4)) {
            (true, 0) => InitialFriction::Loading,
            (true, 1) => InitialFriction::Unloading,
            _ => InitialFriction::Relaxed,
        };
        actuators.push(Mounted {
            actuator: actuator.without_valve(),
            mechanism: m,
            coupling,
            tendon,
            pressure: series.filter(|_| line.hose.is_none()),
        });
        start.air.push(InitialAir { gauge_pressure: GaugePressure(paper.gauge), temperature: paper.temperature });
        start.lengths.push(length);
        start.friction.push(friction);
    }
    (Plant::new(actuators, network, mechanisms), start, *duration)
}
