//! Linear models of plants in closed form: tanks through a leak, chains of pendulums, a hose's resonance, spools, regulators;
//! and small signals of simulated plants.

use crate::common::{ATMOSPHERE, GRAVITY, Paper, ROOM, assert_close, assert_within, bisect, slope};
use mckibben::air::Process;
use mckibben::line::{self, Hose, HoseKind, Leakage, Reservoir};
use mckibben::load::MomentArm;
use mckibben::mechanism::{Arm, Chain, ChainSegment, Coupling, JointStops, Mass, Mechanism, Pull, Revolute};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{
    InitialAir, Mounted, Plant, PlantAir, PlantBalance, PlantInput, PlantLinearization, PlantStart, PlantState,
    PlantStateSpace, linearize_plant, simulate_plant,
};
use mckibben::simulation::Actuation;
use mckibben::valve::{Command, Port, Regulator, Request, Solenoid, Spool, ValveKind};
use mckibben::{Actuator, GaugePressure};
use std::f64::consts::PI;

const FREE: JointStops = JointStops { ends: [None; 2], stiffness: 500.0, damping: 1.0 };

fn on(actuator: Actuator, coupling: Coupling) -> Mounted {
    Mounted { actuator: actuator.without_valve(), mechanism: 0, coupling, tendon: None, pressure: None }
}

fn held(actuator: Actuator) -> Mounted {
    on(actuator, Coupling::Direct { coordinate: 0 })
}

/// A start at positions and gauge pressures, at rest and room temperature.
fn start(positions: Vec<Vec<f64>>, gauges: &[f64]) -> PlantStart {
    let air = |gauge: &f64| InitialAir { gauge_pressure: GaugePressure(*gauge), temperature: ROOM };
    PlantStart {
        rates: positions.iter().map(|its| vec![0.0; its.len()]).collect(),
        positions,
        air: gauges.iter().map(air).collect(),
        lengths: vec![None; gauges.len()],
        ..PlantStart::default()
    }
}

fn input(model: &PlantStateSpace, of: PlantInput) -> usize {
    model.inputs.iter().position(|it| *it == of).unwrap_or_else(|| panic!("{of:?} of {:?}", model.inputs))
}

fn state(model: &PlantStateSpace, of: PlantState) -> usize {
    model.states.iter().position(|it| *it == of).unwrap_or_else(|| panic!("{of:?} of {:?}", model.states))
}

/// A bottle and an actuator held at a length, joined by a laminar leak: `ṁ = k (P₁² − P²)/(2RT)`.
#[test]
fn two_tanks_through_a_laminar_leak() {
    let paper = Paper::sealed().process(Process::Isothermal).isometric(0.09);
    let (air, actuator) = (paper.air(), paper.actuator());
    let (volume, conductance) = (2e-4, 3e-13);
    let gauge = 200e3;
    let bottle = Reservoir::new([volume, 1.0, ROOM], GaugePressure(gauge), None, &air).expect("a bottle");
    let mut network = Network::new(&air);
    let tank = network.node(NodeKind::Reservoir(bottle), 0.0, ROOM);
    let chamber = network.chamber(0, ROOM);
    network.branch(tank, chamber, BranchKind::Leak(Leakage::new(conductance).expect("a leak")));
    let room = actuator.volume(0.09);
    let plant = Plant::new(vec![held(actuator)], network, vec![Mechanism::Fixed]).expect("a plant");
    let start = start(vec![vec![0.09]], &[gauge]);
    let shut = PlantBalance::Shut(vec![GaugePressure(gauge)]);
    let model = linearize_plant(&plant, &start, &shut, &PlantAir::Temperatures(vec![ROOM])).expect("a model");
    let system = model.minimal();
    assert_eq!(system.states, [PlantState::Pressure { actuator: 0 }, PlantState::NodePressure { node: tank }]);
    // dṁ = k P (δP₁ − δP)/RT;  dP/dt = RT/V ṁ.
    let pressure = gauge + ATMOSPHERE;
    let of = |room: f64| conductance * pressure / room;
    let expected = [[-of(room), of(room)], [of(volume), -of(volume)]];
    for (row, expected) in system.a.iter().zip(expected) {
        for (entry, expected) in row.iter().zip(expected) {
            assert_close(*entry, expected, 1e-9);
        }
    }
    let flow = input(&system, PlantInput::NodeFlow { node: tank });
    assert_close(system.b[1][flow], 286.99 * ROOM / volume, 1e-12);
    // At another pressure the leak's flow is what holds both.
    let shut = PlantBalance::Shut(vec![GaugePressure(100e3)]);
    let model = linearize_plant(&plant, &start, &shut, &PlantAir::Temperatures(vec![ROOM])).expect("a model");
    let [high, low] = [pressure, 100e3 + ATMOSPHERE];
    let flow = conductance * (high * high - low * low) / (2.0 * 286.99 * ROOM);
    assert_close(model.point.input(PlantInput::MassFlow { actuator: 0 }).expect("a flow"), -flow, 1e-9);
    assert_close(model.point.input(PlantInput::NodeFlow { node: tank }).expect("a flow"), flow, 1e-9);
}

fn pendulum(lengths: &[f64], masses: &[f64], torque: f64) -> Plant {
    let segments = lengths.iter().zip(masses).map(|(length, mass)| ChainSegment {
        length: *length,
        mass: *mass,
        distance: *length,
        inertia: 0.0,
    });
    let joints = lengths.iter().map(|_| Revolute { torque, damping: 0.0, stops: FREE }).collect();
    let chain = Chain::new(segments.collect(), joints, [GRAVITY, 0.0], None).expect("a chain");
    Plant::new(vec![], Network::new(&Paper::sealed().air()), vec![Mechanism::Chain(chain)]).expect("a plant")
}

/// Two point masses on equal rods: `ω² = (2 ± √2) g/l`.
#[test]
fn a_double_pendulum_has_its_two_frequencies() {
    let (length, mass) = (0.3, 0.7);
    let plant = pendulum(&[length; 2], &[mass; 2], 0.0);
    let model = linearize_plant(
        &plant,
        &start(vec![vec![0.3, -0.2]], &[]),
        &PlantBalance::Shut(vec![]),
        &PlantAir::Temperatures(vec![]),
    )
    .expect("a model");
    for angle in &model.point.state[..2] {
        assert_within(*angle, 0.0, 1e-12);
    }
    // x″ = A₂₁ x: the sum and the product of ω².
    let a = &model.system.a;
    let (trace, determinant) = (-(a[2][0] + a[3][1]), a[2][0] * a[3][1] - a[2][1] * a[3][0]);
    let unit = GRAVITY / length;
    assert_close(trace, 4.0 * unit, 1e-12);
    assert_close(determinant, 2.0 * unit * unit, 1e-12);
    // A torque at a joint turns it by M⁻¹: of the hanging pair [[1, −2], [−2, 5]]/(m l²) in these angles.
    let force = |coordinate| input(&model.system, PlantInput::Force { mechanism: 0, coordinate });
    let per = 1.0 / (mass * length * length);
    for (row, expected) in [[1.0, -2.0], [-2.0, 5.0]].into_iter().enumerate() {
        for (column, expected) in expected.into_iter().enumerate() {
            assert_close(model.system.b[2 + row][force(column)], expected * per, 1e-12);
        }
    }
}

/// A pendulum that stands on its head is a point too, with a growing pole.
#[test]
fn a_start_in_balance_stays_whether_stable_or_not() {
    let plant = pendulum(&[0.3], &[0.7], 0.0);
    let model = linearize_plant(
        &plant,
        &start(vec![vec![PI]], &[]),
        &PlantBalance::Shut(vec![]),
        &PlantAir::Temperatures(vec![]),
    )
    .expect("a model");
    assert_within(model.point.state[0], PI, 1e-12);
    assert_close(model.system.a[1][0], GRAVITY / 0.3, 1e-9);
}

#[test]
fn a_torque_that_nothing_balances_has_no_point() {
    let plant = pendulum(&[0.3], &[0.7], 3.0);
    let error = linearize_plant(
        &plant,
        &start(vec![vec![0.0]], &[]),
        &PlantBalance::Shut(vec![]),
        &PlantAir::Temperatures(vec![]),
    );
    assert!(matches!(error, Err(mckibben::Error::NoSolution { .. })), "{error:?}");
}

/// The coefficients 1, a₁, a₂, … of det(λ I − A), by Faddeev and Le Verrier.
fn characteristic(a: &[Vec<f64>]) -> Vec<f64> {
    let n = a.len();
    let mut coefficients = vec![1.0];
    let mut m = vec![vec![0.0; n]; n];
    for k in 1..=n {
        let last = coefficients[k - 1];
        m = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| (0..n).map(|l| a[i][l] * m[l][j]).sum::<f64>() + if i == j { last } else { 0.0 })
                    .collect()
            })
            .collect();
        let trace: f64 = (0..n).map(|i| (0..n).map(|l| a[i][l] * m[l][i]).sum::<f64>()).sum();
        coefficients.push(-trace / k as f64);
    }
    coefficients
}

/// One cell of hose before a held actuator, its valve shut: a Helmholtz resonator,
/// `ω² = A/l (S_hose + S_actuator)` with the stiffness S of each volume to mass.
#[test]
fn a_hose_cell_before_a_volume_is_a_helmholtz_resonator() {
    let paper = Paper::sealed().process(Process::Isothermal).isometric(0.09);
    let (air, actuator) = (paper.air(), paper.actuator());
    let (length, diameter) = (0.5, 4e-3);
    let tube = |cells| {
        Hose::new(HoseKind::Distributed { cells }, [length, diameter], [1.8e-5, ROOM, 1.0], &air).expect("a hose")
    };
    let model = |cells: usize| {
        let mut network = Network::new(&air);
        let chamber = network.chamber(0, ROOM);
        network.hose(tube(cells), chamber, 0.0);
        let plant = Plant::new(vec![held(actuator.clone())], network, vec![Mechanism::Fixed]).expect("a plant");
        let shut = PlantBalance::Shut(vec![GaugePressure(3e5)]);
        linearize_plant(&plant, &start(vec![vec![0.09]], &[3e5]), &shut, &PlantAir::Temperatures(vec![ROOM]))
            .expect("a model")
    };
    let area = PI * diameter * diameter / 4.0;
    let gas = 286.99 * ROOM;
    let room = actuator.volume(0.09);
    let polynomial = characteristic(&model(1).minimal().a);
    assert_eq!(polynomial.len(), 4);
    let squared = area / length * (gas / (area * length) + gas / room);
    assert_close(polynomial[2], squared, 1e-9);
    assert_within(polynomial[3], 0.0, 1e-6 * squared);
    // Laminar loss: Δp = 8πμ/(ρA²) l w, and so a damping of 8πμ/(ρA).
    let density = (3e5 + ATMOSPHERE) / gas;
    assert_close(polynomial[1], 8.0 * PI * 1.8e-5 / (density * area), 1e-9);
    // Eight cells: every pressure of the line is the actuator's at the point.
    let eight = model(8);
    let system = eight.minimal();
    assert_eq!(system.states.len(), 17);
    for cell in 0..8 {
        let place = eight.point.plant.indices().nodes[1 + cell].expect("a state");
        assert_close(eight.point.state[place], 3e5 + ATMOSPHERE, 1e-12);
    }
    // Waves in the cells, P_i ~ cos((i − ½)φ) with ω² = 4 c²/Δx² sin²(φ/2), end in the actuator's volume:
    // sin nφ = −2 (V/V_cell) sin(φ/2) cos((n + ½)φ), the lowest between π/2n and π/n.
    let cell = area * length / 8.0;
    let left = |phi: f64| (8.0 * phi).sin() + 2.0 * room / cell * (0.5 * phi).sin() * (8.5 * phi).cos();
    let omega = 2.0 * gas.sqrt() * 8.0 / length * (0.5 * bisect(PI / 17.0, PI / 8.0, left)).sin();
    // The loss takes less than 1e-5 of it.
    assert_close(lowest_swing(&system.a, omega * 1.01), omega, 2e-5);
}

/// The imaginary part of the eigenvalue nearest to `jω`, by inverse iteration over the complex numbers.
fn lowest_swing(a: &[Vec<f64>], omega: f64) -> f64 {
    let n = a.len();
    // Pressures and flows in like sizes.
    let size: Vec<f64> = (0..n).map(|k| if a[k].iter().any(|entry| entry.abs() > 1e6) { 1e5 } else { 1e-4 }).collect();
    let mut x = vec![[1.0, 0.3]; n];
    let mut shift = [0.0, omega];
    for _ in 0..40 {
        let mut rows: Vec<Vec<[f64; 2]>> = (0..n)
            .map(|i| {
                let mut row: Vec<[f64; 2]> = (0..n)
                    .map(|j| {
                        let entry = a[i][j] * size[j] / size[i];
                        if i == j { [entry - shift[0], -shift[1]] } else { [entry, 0.0] }
                    })
                    .collect();
                row.push(x[i]);
                row
            })
            .collect();
        let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
        let over = |a: [f64; 2], b: [f64; 2]| {
            let square = b[0] * b[0] + b[1] * b[1];
            [(a[0] * b[0] + a[1] * b[1]) / square, (a[1] * b[0] - a[0] * b[1]) / square]
        };
        for column in 0..n {
            let pivot = (column..n)
                .max_by(|a, b| {
                    let of = |row: usize| rows[row][column][0].hypot(rows[row][column][1]);
                    of(*a).total_cmp(&of(*b))
                })
                .expect("rows");
            rows.swap(column, pivot);
            for row in (0..n).filter(|row| *row != column) {
                let factor = over(rows[row][column], rows[column][column]);
                for place in column..=n {
                    let by = times(factor, rows[column][place]);
                    rows[row][place] = [rows[row][place][0] - by[0], rows[row][place][1] - by[1]];
                }
            }
        }
        let y: Vec<[f64; 2]> = (0..n).map(|k| over(rows[k][n], rows[k][k])).collect();
        let largest =
            (0..n).max_by(|a, b| y[*a][0].hypot(y[*a][1]).total_cmp(&y[*b][0].hypot(y[*b][1]))).expect("some");
        let grown = over(y[largest], x[largest]);
        let step = over([1.0, 0.0], grown);
        let norm = y[largest];
        x = y.iter().map(|entry| over(*entry, norm)).collect();
        if step[0].hypot(step[1]) < 1e-9 * omega {
            return shift[1];
        }
        if step[0].hypot(step[1]).is_finite() && step[0].hypot(step[1]) < 0.2 * omega {
            shift = [shift[0] + step[0], shift[1] + step[1]];
        }
    }
    shift[1]
}

/// The states at the start and at a time in s of a run from the point with the states of the model moved by `by`, in the order
/// of the model's; of the plant's states only those that a start can give may be moved.
fn moved(model: &PlantLinearization, plant: &Plant, by: &[f64], time: f64, tolerance: f64) -> [Vec<f64>; 2] {
    let mut start = model.point.start();
    let places = plant.indices();
    let system = &model.system;
    let slot = |it: &PlantState| match *it {
        PlantState::Position { mechanism, coordinate } => places.mechanisms[mechanism].position(coordinate),
        PlantState::Velocity { mechanism, coordinate } => places.mechanisms[mechanism].rate(coordinate),
        PlantState::Pressure { actuator } => places.actuators[actuator].pressure,
        PlantState::AirMass { actuator } => places.actuators[actuator].mass(),
        PlantState::Length { actuator } => places.actuators[actuator].length.expect("a length"),
        PlantState::NodePressure { node } => places.nodes[node].expect("a pressure"),
        PlantState::BranchFlow { branch } => places.branches[branch].expect("a flow"),
        other => panic!("{other:?}"),
    };
    for (it, by) in system.states.iter().zip(by) {
        match *it {
            PlantState::Position { mechanism, coordinate } => start.positions[mechanism][coordinate] += by,
            PlantState::Velocity { mechanism, coordinate } => start.rates[mechanism][coordinate] += by,
            _ => assert!(*by == 0.0, "{it:?} cannot be moved"),
        }
    }
    let run = simulate_plant(plant, &start, time, tolerance).expect("a run");
    [0.0, time].map(|time| {
        let state = run.at(time).0;
        system.states.iter().map(|it| state[slot(it)]).collect()
    })
}

/// `exp(A t) x` by its series on small steps.
fn flow(a: &[Vec<f64>], start: &[f64], time: f64, steps: usize) -> Vec<f64> {
    let step = time / steps as f64;
    (0..steps).fold(start.to_vec(), |x, _| {
        let (mut sum, mut term) = (x.clone(), x);
        for k in 1..16 {
            term =
                a.iter().map(|row| row.iter().zip(&term).map(|(a, x)| a * x).sum::<f64>() * step / k as f64).collect();
            sum.iter_mut().zip(&term).for_each(|(sum, term)| *sum += term);
        }
        sum
    })
}

/// A joint of two muscles, each on a hose behind a valve, both fed by one bottle.
fn joint_on_a_bottle(kind: HoseKind, command: impl Fn(usize) -> (Solenoid, Command)) -> (Plant, Vec<usize>) {
    let paper = Paper::sealed().friction(4.0, 0.0);
    let (air, law) = (paper.air(), paper.flow_law());
    let mut network = Network::new(&air);
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let bottle = Reservoir::new([5e-4, 1.0, ROOM], GaugePressure(6e5), None, &air).expect("a bottle");
    let tank = network.node(NodeKind::Reservoir(bottle), 0.0, ROOM);
    let mut valves = vec![];
    for i in 0..2 {
        let (solenoid, command) = command(i);
        let valve = network.valve(Actuation { solenoid, command });
        let chamber = network.chamber(i, ROOM);
        let hose = Hose::new(kind, [0.4, 3e-3], [1.8e-5, ROOM, 1.0], &air).expect("a hose");
        let into = network.hose(hose, chamber, 0.0);
        for (from, port) in [(tank, Port::Supply), (outside, Port::Exhaust)] {
            network.branch(from, into, BranchKind::Path { law, valve, port, ambient: false, copies: 1.0 });
        }
        valves.push(valve);
    }
    let segment = ChainSegment { length: 0.0, mass: 0.4, distance: 0.05, inertia: 1e-3 };
    let revolute = Revolute { torque: 0.0, damping: 2e-3, stops: FREE };
    let chain = Chain::new(vec![segment], vec![revolute], [GRAVITY, 0.3], None).expect("a chain");
    let muscle = |sign: f64, radius: f64| {
        let arms = vec![Arm { joint: 0, sign, arm: MomentArm::Pulley(radius) }];
        on(paper.actuator(), Coupling::Arms { rest_length: 0.085, arms })
    };
    let actuators = vec![muscle(1.0, 0.015), muscle(-1.0, 0.012)];
    (Plant::new(actuators, network, vec![Mechanism::Chain(chain)]).expect("a plant"), valves)
}

/// Both muscles with shut valves swing, as the simulated joint does.
#[test]
fn a_joint_with_hoses_swings_as_the_simulated_joint_does() {
    for kind in [HoseKind::Lumped, HoseKind::Distributed { cells: 3 }] {
        let shut = |_| {
            let solenoid = Solenoid::new(ValveKind::FillHoldExhaust, 4e-3, 1e-3).expect("a solenoid");
            (solenoid, Command::Constant(Request::Hold))
        };
        let (plant, _) = joint_on_a_bottle(kind, shut);
        let gauges = [2.5e5, 2e5].map(GaugePressure);
        let start = start(vec![vec![0.0]], &[2.5e5, 2e5]);
        let balance = PlantBalance::Shut(gauges.to_vec());
        let model = linearize_plant(&plant, &start, &balance, &PlantAir::Temperatures(vec![ROOM; 2])).expect("a model");
        let system = &model.system;
        for disturbed in 0..2 {
            let size = [1e-5, 1e-3][disturbed];
            let mut by = vec![0.0; system.states.len()];
            by[disturbed] = size;
            let minus: Vec<f64> = by.iter().map(|by| -by).collect();
            let time = 0.05;
            let ends = [&by, &minus].map(|by| moved(&model, &plant, by, time, 1e-12));
            // A start at another length has other air there: what began is read from the run.
            let half = |at: usize, k: usize| 0.5 * (ends[0][at][k] - ends[1][at][k]);
            let begun: Vec<f64> = (0..by.len()).map(|k| half(0, k)).collect();
            let linear = flow(&system.a, &begun, time, 2000);
            for (k, it) in system.states.iter().enumerate() {
                let simulated = half(1, k);
                let scale = match it {
                    PlantState::Position { .. } => size.max(1e-5),
                    PlantState::Velocity { .. } => 1e-3,
                    PlantState::Pressure { .. } | PlantState::NodePressure { .. } => 20.0,
                    _ => 1e-9,
                };
                assert_within(linear[k], simulated, 1e-3 * scale);
            }
        }
    }
}

/// A joint under PWM of two frequencies: the mean pressures of simulated cycles are those of the point. The bottle
/// gives what the point says it must be given, and so loses it.
#[test]
fn simulated_pulses_lie_about_the_point_of_a_joint_on_a_bottle() {
    let pulses = |i: usize| {
        let solenoid = Solenoid::new(ValveKind::ThreeWay, 0.2e-3, 0.1e-3).expect("a solenoid");
        let command = Command::pwm([300.0, 420.0][i], [0.3, 0.25][i], Request::Fill, Request::Exhaust);
        (solenoid, command.expect("a command"))
    };
    let (plant, valves) = joint_on_a_bottle(HoseKind::Lumped, pulses);
    let start = start(vec![vec![0.0]], &[2e5, 2e5]);
    let model = linearize_plant(&plant, &start, &PlantBalance::Driven, &PlantAir::Start).expect("a model");
    assert_eq!(model.averages.iter().map(|it| it.valve).collect::<Vec<_>>(), valves);
    assert!(model.averages.iter().all(|it| it.follows() && it.ripple_is_small()), "{:?}", model.averages);
    // What the bottle gives: both fills, and both are vented again.
    let lost = model.point.input(PlantInput::NodeFlow { node: 1 }).expect("a flow");
    assert!(lost > 0.0);
    let time = 0.06;
    let run = simulate_plant(&plant, &model.point.start(), time, 1e-8).expect("a run");
    let places = plant.indices();
    let tank = places.nodes[1].expect("a tank");
    let [begun, ended] = [0.0, time].map(|time| run.at(time).0[tank]);
    let gone = (begun - ended) * 5e-4 / (286.99 * ROOM);
    // The bottle sags by a percent or so in that time, and the mean flow with it.
    assert_close(gone, lost * time, 0.05);
    for i in 0..2 {
        let samples =
            (0..4000).map(|n| run.at(time * (0.2 + 0.2 * f64::from(n) / 4000.0)).0[places.actuators[i].pressure]);
        let mean = samples.sum::<f64>() / 4000.0;
        let there = model.point.state[places.actuators[i].pressure];
        assert_within(mean, there, 0.2 * model.averages[i].pressure_ripple + 0.02 * there);
    }
}

/// `−A⁻¹ B` of an input: how far the balance moves; by elimination with row exchange.
fn moves(system: &PlantStateSpace, input: usize) -> Vec<f64> {
    let n = system.a.len();
    let size: Vec<f64> = system
        .states
        .iter()
        .map(|it| match it {
            PlantState::Pressure { .. } | PlantState::NodePressure { .. } => 1e5,
            PlantState::AirMass { .. } => 1e-4,
            PlantState::BranchFlow { .. } => 1e-4,
            _ => 1.0,
        })
        .collect();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row: Vec<f64> = (0..n).map(|j| system.a[i][j] * size[j]).collect();
            row.push(-system.b[i][input]);
            let most = row.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            row.iter().map(|entry| entry / most).collect()
        })
        .collect();
    for column in 0..n {
        let pivot = (column..n).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs())).expect("rows");
        rows.swap(column, pivot);
        for row in (0..n).filter(|row| *row != column) {
            let factor = rows[row][column] / rows[column][column];
            for place in column..=n {
                rows[row][place] -= factor * rows[column][place];
            }
        }
    }
    (0..n).map(|row| size[row] * rows[row][n] / rows[row][row]).collect()
}

/// One muscle with a hose, fed by a spool or by a regulator behind an outlet that droops: a slow change of the command moves
/// the balance as two balances differ.
#[test]
fn a_slow_change_of_a_command_moves_the_point() {
    let paper = Paper::sealed().friction(4.0, 0.0);
    let (air, law) = (paper.air(), paper.flow_law());
    let plant = |solenoid: Solenoid, command: Command| {
        let mut network = Network::new(&air);
        let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
        let chamber = network.chamber(0, ROOM);
        let outlet = line::Regulator::new(2e7, 0.0, 0.02).expect("a regulator");
        let kind = NodeKind::Outlet { regulator: outlet, set: 6e5, inlet: None };
        let mut feed = network.node(kind, 6e5, ROOM);
        let valve = network.valve(Actuation { solenoid, command });
        if let Some(regulator) = solenoid.regulator() {
            feed = network.node(NodeKind::Port { regulator: *regulator, valve, feed: 6e5 }, 0.0, ROOM);
        }
        let hose = Hose::new(HoseKind::Lumped, [0.4, 3e-3], [1.8e-5, ROOM, 1.0], &air).expect("a hose");
        let into = network.hose(hose, chamber, 0.0);
        for (from, port) in [(feed, Port::Supply), (outside, Port::Exhaust)] {
            network.branch(from, into, BranchKind::Path { law, valve, port, ambient: false, copies: 1.0 });
        }
        network.branch(outside, chamber, BranchKind::Leak(Leakage::new(2e-13).expect("a leak")));
        let mass = Mass::new(2.0, Pull::Gravity(GRAVITY), None).expect("a mass");
        Plant::new(vec![held(paper.actuator())], network, vec![Mechanism::Mass(mass)]).expect("a plant")
    };
    let start = start(vec![vec![0.09]], &[2e5]);
    let spool = |by: f64| {
        let spool = Spool::new(60.0, 0.7, -0.1, -0.1).expect("a spool");
        let command = Command::positions(vec![0.0], vec![-0.02 + by]).expect("positions");
        plant(Solenoid::proportional(spool), command)
    };
    let regulator = |by: f64| {
        let regulator = Regulator::new(0.02, 0.0, 1e7).expect("a regulator");
        plant(Solenoid::regulating(regulator), Command::set_points(vec![0.0], vec![2.5e5 + by]).expect("set points"))
    };
    let model = |plant: &Plant| {
        linearize_plant(plant, &start, &PlantBalance::Driven, &PlantAir::Start)
            .unwrap_or_else(|error| panic!("{error}"))
    };
    type Case<'a> = (&'a dyn Fn(f64) -> Plant, f64, PlantInput);
    let cases: [Case; 2] =
        [(&spool, 1e-4, PlantInput::SpoolCommand { valve: 0 }), (&regulator, 10.0, PlantInput::SetPoint { valve: 0 })];
    for (plant, step, command) in cases {
        let here = model(&plant(0.0));
        let system = here.minimal();
        // The air from one balance to the next is the start's, in all of them.
        let moved = moves(&system, input(&system, command));
        let places = here.point.plant.indices().clone();
        let pressure = slope(step, |by| model(&plant(by)).point.state[places.actuators[0].pressure]);
        let length = slope(step, |by| model(&plant(by)).point.lengths[0]);
        assert_close(moved[state(&system, PlantState::Pressure { actuator: 0 })], pressure, 1e-6);
        assert_close(moved[state(&system, PlantState::Position { mechanism: 0, coordinate: 0 })], length, 1e-6);
        // So does the regulator of the supply, by its setting.
        let outlet = input(&system, PlantInput::SupplyPressure { node: 2 });
        let by_supply = moves(&system, outlet)[state(&system, PlantState::Pressure { actuator: 0 })];
        match command {
            PlantInput::SetPoint { .. } => assert_within(by_supply, 0.0, 1e-12),
            _ => assert!(by_supply > 0.1 && by_supply < 1.0, "{by_supply}"),
        }
    }
}
