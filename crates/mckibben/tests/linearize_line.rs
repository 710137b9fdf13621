//! Linear models of one actuator and of a joint with all that may feed them: each against the difference of two simulated
//! trajectories, against the point at which a long run rests, and against the plant that a file of many actuators states.

use crate::common::joint::Pair;
use crate::common::{GRAVITY, LB, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::friction::{Hysteresis, LuGre};
use mckibben::line::{Hose, HoseKind, Leakage, Line, Regulator as SupplyRegulator, Reservoir, SupplyLine};
use mckibben::linearize::{
    Aim, Balance, Content, JointBalance, Linearization, StateSpace, linearize, linearize_driven,
    linearize_driven_joint, linearize_joint,
};
use mckibben::load::{Joint, Load};
use mckibben::plant::{JointPlant, PlantAir, RigTrajectory};
use mckibben::simulation::{
    Actuation, Fittings, JointRig, JointSample, JointSupply, PressureSeries, Rig, SeriesTendon, State, simulate,
};
use mckibben::valve::{Command, Regulator, Request, Solenoid, ValveKind};
use mckibben::{AbsolutePressure, GaugePressure};

fn hose(kind: HoseKind) -> Hose {
    Hose::new(kind, [1.0, 4e-3], [1.82e-5, ROOM, 1.0], &Paper::sealed().air()).expect("a hose")
}

fn leak() -> Option<Leakage> {
    Some(Leakage::new(2e-10).expect("a leak"))
}

fn supply(reservoir: bool, regulator: bool) -> Option<SupplyLine> {
    let air = Paper::sealed().air();
    let tank =
        reservoir.then(|| Reservoir::new([0.2, 1.0, ROOM], GaugePressure(120.0 * PSI), None, &air).expect("a tank"));
    let set = regulator.then(|| SupplyRegulator::new(2e7, 0.0, 0.02).expect("a regulator"));
    Some(SupplyLine::new(tank, set, 1.0).expect("a supply"))
}

/// Held shut by a valve with a centre position, or always open to the supply.
fn requested(request: Request) -> Paper {
    Paper::driven(Command::Constant(request))
        .with(|rig| rig.kind = ValveKind::FillHoldExhaust)
        .friction(6.0, 0.0)
        .gauge(60.0 * PSI)
}

fn with_line(paper: &Paper, line: Line) -> Rig {
    paper.rig().with_line(line).expect("a rig")
}

/// The states of a model at a time in s of a run, by their names.
fn numbers(system: &StateSpace, run: &RigTrajectory, time: f64) -> Vec<f64> {
    let (sample, line) = (run.at(time), run.line_at(time));
    let count = |start: &str| system.states.iter().filter(|state| state.name.starts_with(start)).count();
    let (nodes, flows) = (count("hose_pressure"), count("hose_flow"));
    let of = |name: &str| match name {
        "length" => sample.length,
        "velocity" => sample.velocity,
        "load_distance" => sample.load_distance,
        "load_velocity" => sample.load_velocity,
        "pressure" => sample.pressure.0,
        "air_mass" => sample.air_mass,
        "bristles" => run.bristles_at(time).expect("bristles"),
        "hose_pressure" | "hose_pressure_1" => line[0],
        "hose_pressure_2" => line[1],
        "hose_pressure_3" => line[2],
        "hose_flow" | "hose_flow_1" => line[nodes],
        "hose_flow_2" => line[nodes + 1],
        "hose_flow_3" => line[nodes + 2],
        "reservoir_pressure" => line[nodes + flows],
        "supply_pressure" | "regulated_pressure" => line[nodes + flows + count("reservoir_pressure")],
        other => panic!("{other}"),
    };
    system.states.iter().map(|state| of(&state.name)).collect()
}

/// `x(t)` of `dx/dt = A x` by the classical Runge–Kutta method.
fn follow(a: &[Vec<f64>], start: &[f64], duration: f64) -> Vec<f64> {
    let steps = 200_000;
    let h = duration / f64::from(steps);
    let rate = |x: &[f64]| -> Vec<f64> { a.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect() };
    let ahead = |x: &[f64], h: f64, k: &[f64]| -> Vec<f64> { x.iter().zip(k).map(|(x, k)| x + h * k).collect() };
    (0..steps).fold(start.to_vec(), |x, _| {
        let k1 = rate(&x);
        let k2 = rate(&ahead(&x, h / 2.0, &k1));
        let k3 = rate(&ahead(&x, h / 2.0, &k2));
        let k4 = rate(&ahead(&x, h, &k3));
        (0..x.len()).map(|n| x[n] + h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n])).collect()
    })
}

/// Sizes of disturbances that a run distinguishes from its own errors, in the unit of each state.
fn usual(name: &str) -> f64 {
    match name {
        name if name.contains("flow") => 1e-7,
        name if name.contains("pressure") => 20.0,
        name if name.contains("air_mass") => 1e-9,
        name if name.contains("velocity") => 1e-3,
        _ => 1e-5,
    }
}

/// Half the difference of two runs follows `dx/dt = A x` between two times.
fn assert_follows(system: &StateSpace, [begun, ended]: [&[f64]; 2], duration: f64, tolerance: f64, what: &str) {
    let expected = follow(&system.a, begun, duration);
    let sizes: Vec<f64> = system.states.iter().map(|state| usual(&state.name)).collect();
    // Each state by the largest of all, in its own usual size.
    let largest = expected.iter().chain(begun).zip(sizes.iter().cycle()).map(|(x, size)| (x / size).abs());
    let largest = largest.fold(0.0, f64::max);
    assert!(largest > 1e-3, "{what}: nothing moves");
    for (n, state) in system.states.iter().enumerate() {
        let apart = (ended[n] - expected[n]).abs() / (largest * sizes[n]);
        assert!(apart <= tolerance, "{what}, {}: {:e} is not {:e}", state.name, ended[n], expected[n]);
    }
}

/// A linear model against runs from both sides of its point, compared from a time on at which air and hose have settled.
fn assert_is_of_runs(linear: &Linearization, settle: f64, what: &str) {
    let State { length, velocity, pressure, air_mass } = linear.point.state;
    for disturbed in 0..4 {
        let run = |sign: f64| {
            let mut state = [length, velocity, pressure.0, air_mass];
            state[disturbed] += sign * [1e-5, 1e-3, 20.0, 1e-9][disturbed];
            let [length, velocity, pressure, air_mass] = state;
            let start = State { length, velocity, pressure: AbsolutePressure(pressure), air_mass };
            simulate(&linear.point.rig, start, settle + 0.05, 1e-12).expect("a run")
        };
        let runs = [run(1.0), run(-1.0)];
        let apart = |time: f64| -> Vec<f64> {
            let [plus, minus] = runs.each_ref().map(|run| numbers(&linear.system, run, time));
            plus.iter().zip(&minus).map(|(plus, minus)| 0.5 * (plus - minus)).collect()
        };
        let (begun, ended) = (apart(settle), apart(settle + 0.05));
        let what = format!("{what}, state {disturbed}");
        assert_follows(&linear.system, [&begun, &ended], 0.05, 2e-3, &what);
    }
}

fn names(of: &[mckibben::linearize::Signal]) -> Vec<&str> {
    of.iter().map(|signal| signal.name.as_str()).collect()
}

/// With the valve shut, air in the hose moves with the actuator's.
#[test]
fn a_hose_behind_a_shut_valve_follows_two_runs() {
    let balance = Balance::AtPressure(GaugePressure(60.0 * PSI));
    let paper = requested(Request::Hold);
    for (kind, states) in [(HoseKind::Lumped, 5), (HoseKind::Distributed { cells: 3 }, 10)] {
        let rig = with_line(&paper, Line { hose: Some(hose(kind)), ..Line::NONE });
        let linear = linearize(&rig, balance, Content::Temperature(ROOM)).expect("a model");
        assert_eq!(linear.system.states.len(), states, "{:?}", names(&linear.system.states));
        assert_eq!(names(&linear.system.inputs)[..2], ["mass_flow", "force"]);
        assert!(linear.system.input("supply_opening").is_some() && linear.system.output("supply_pressure").is_none());
        assert_is_of_runs(&linear, 0.0, "hose");
        // On a tendon too, with bristles.
        let law = LuGre::new(1e-4, 3e-4).expect("a law");
        let bristly = paper.clone().with(|rig| rig.hysteresis = Some(Hysteresis::LuGre(law)));
        let rig = with_line(&bristly, Line { hose: Some(hose(kind)), ..Line::NONE });
        let linear = linearize(&rig, balance, Content::Temperature(ROOM)).expect("a model");
        assert!(names(&linear.system.states).contains(&"bristles"));
        assert_eq!(linear.minimal().states.len(), states - 1);
        let rig = with_line(&paper, Line { hose: Some(hose(kind)), ..Line::NONE });
        let rig = rig.with_tendon(SeriesTendon::new(8e3, 0.05).expect("a tendon"));
        let linear = linearize(&rig, balance, Content::Temperature(ROOM)).expect("a model");
        assert_eq!(names(&linear.system.states)[..3], ["load_distance", "load_velocity", "length"]);
        assert_is_of_runs(&linear, 0.0, "hose and tendon");
    }
}

/// An open valve feeds a leak through a hose, from each kind of supply: the run rests at the point.
#[test]
fn a_leak_that_is_fed_follows_two_runs() {
    for (reservoir, regulator) in [(false, false), (true, false), (false, true), (true, true)] {
        let line = Line { hose: Some(hose(HoseKind::Lumped)), leakage: leak(), supply: supply(reservoir, regulator) };
        let rig =
            with_line(&requested(Request::Fill).with(|rig| rig.supply_gauge = 60.0 * PSI).friction(20.0, 0.0), line);
        let from = requested(Request::Fill).start();
        let linear = linearize_driven(&rig, Aim::Command, Content::Of(from)).expect("a model");
        let what = format!("reservoir {reservoir}, regulator {regulator}");
        let given: Vec<&str> = names(&linear.system.states).split_off(4);
        let mut expected = vec!["reservoir_pressure", "supply_pressure", "hose_pressure"];
        expected.retain(|name| match *name {
            "reservoir_pressure" => reservoir && regulator,
            "supply_pressure" => reservoir || regulator,
            _ => true,
        });
        assert_eq!(given, expected, "{what}");
        if !reservoir {
            let run = simulate(&linear.point.rig, linear.point.state, 12.0, 1e-10).expect("a run").at(12.0);
            assert_close(run.pressure.0, linear.point.state.pressure.0, 1e-7);
            assert_close(run.length, linear.point.state.length, 1e-6);
        }
        assert_is_of_runs(&linear, 1.0, &what);
        // What keeps a bottle full is a flow from outside.
        let flow = linear.inputs().into_iter().find(|(signal, _)| signal.name == "reservoir_mass_flow");
        assert_eq!(flow.is_some_and(|(_, flow)| flow > 1e-5), reservoir, "{what}");
    }
}

/// A valve that makes a pressure: its set point is the first input, and moves the point as `−A⁻¹ B` says.
#[test]
fn a_pressure_regulator_makes_its_set_point() {
    let rig = |set: f64| {
        let command = Command::set_points(vec![0.0], vec![set]).expect("a set point");
        let paper = Paper::sealed().friction(6.0, 0.0).with(|rig| rig.command = Some(command.clone()));
        let solenoid = Solenoid::regulating(Regulator::new(0.03, 0.0, 1e9).expect("a regulator"));
        Rig::new(paper.actuator(), Some(Actuation { solenoid, command }), paper.load.clone()).expect("a rig")
    };
    let start = Paper::sealed().gauge(3e5).start();
    let line = Line { leakage: leak(), ..Line::NONE };
    let at = |set: f64| {
        let rig = rig(set).with_line(line).expect("a rig");
        linearize_driven(&rig, Aim::Command, Content::Of(start)).expect("a model")
    };
    let linear = at(4e5);
    assert_eq!(names(&linear.system.inputs)[0], "set_point");
    assert_eq!(names(&linear.system.states)[4..], ["regulated_pressure"]);
    assert_is_of_runs(&linear, 0.4, "a regulator");
    // The set point that holds a pressure is the one that makes it.
    let balance = Balance::AtPressure(linear.point.gauge_pressure());
    let held = linearize_driven(&linear.point.rig, Aim::Balance(balance), Content::Of(start)).expect("a set point");
    assert_close(held.inputs()[0].1, 4e5, 1e-8);
    // One pascal more of the set point is one more in the valve's port, whatever leaks.
    let system = linear.minimal();
    let row = system.states.iter().position(|state| state.name == "regulated_pressure").expect("a state");
    assert_close(-system.b[row][0] / system.a[row][row], 1.0, 1e-12);
}

/// The duty, or the set point, that holds a pressure at the muscle of a leaking hose in cells is the one that makes it.
#[test]
fn a_command_holds_a_pressure_behind_a_leaking_hose_in_cells() {
    for leak in [1e-17, 5e-14, 1e-12] {
        let leakage = Some(Leakage::new(leak).expect("a leak"));
        let line = Line { hose: Some(hose(HoseKind::Distributed { cells: 4 })), leakage, supply: None };
        let pulsed = |duty: f64| {
            let paper = Paper::pwm(100.0, duty).with(|rig| rig.delays = (1e-3, 1e-3)).friction(6.0, 0.0);
            (with_line(&paper, line), Content::Of(paper.start()))
        };
        let (rig, content) = pulsed(0.5);
        let made = linearize_driven(&rig, Aim::Command, content).expect("a balance of flows");
        let balance = Aim::Balance(Balance::AtPressure(made.point.gauge_pressure()));
        let (rig, content) = pulsed(0.3);
        let held = linearize_driven(&rig, balance, content).expect("a duty");
        assert_close(held.averaged().expect("averaged").duty, 0.5, 1e-8);
        let regulated = |set: f64| {
            let command = Command::set_points(vec![0.0], vec![set]).expect("a set point");
            let paper = Paper::sealed().friction(6.0, 0.0).with(|rig| rig.command = Some(command.clone()));
            let solenoid = Solenoid::regulating(Regulator::new(0.03, 0.0, 1e9).expect("a regulator"));
            let rig = Rig::new(paper.actuator(), Some(Actuation { solenoid, command }), paper.load.clone());
            rig.expect("a rig").with_line(line).expect("a rig")
        };
        let content = Content::Of(Paper::sealed().gauge(3e5).start());
        let made = linearize_driven(&regulated(4e5), Aim::Command, content).expect("a model");
        let balance = Aim::Balance(Balance::AtPressure(made.point.gauge_pressure()));
        let held = linearize_driven(&regulated(3e5), balance, content).expect("a set point");
        assert_close(held.inputs()[0].1, 4e5, 1e-8);
    }
}

/// The plant of a chain of one joint is what a file of many actuators states: the same numbers under other names.
#[test]
fn pulses_through_a_hose_from_a_bottle_have_the_model_of_the_plant() {
    use mckibben::plant::{Plant, PlantBalance, PlantInput, linearize_plant};
    let line = Line { hose: Some(hose(HoseKind::Lumped)), leakage: leak(), supply: supply(true, true) };
    let paper = Paper::pwm(100.0, 0.5).with(|rig| rig.delays = (1e-3, 1e-3)).friction(6.0, 0.0);
    let rig = with_line(&paper, line);
    let start = paper.start();
    let linear = linearize_driven(&rig, Aim::Command, Content::Of(start)).expect("a model");
    let plant = linearize_plant(
        &Plant::of_rig(&rig),
        &Plant::start_of_rig(&rig, &start),
        &PlantBalance::Driven,
        &PlantAir::Start,
    )
    .expect("a model");
    assert_close(linear.point.state.pressure.0, plant.point.gauge_pressure(0).0 + 101_325.0, 1e-9);
    assert_close(linear.point.state.length, plant.point.lengths[0], 1e-9);
    let duty = plant.system.inputs.iter().position(|input| matches!(input, PlantInput::Duty { .. })).expect("a duty");
    assert_eq!(linear.system.inputs[0].name, "duty");
    let columns = |column: usize, b: &[Vec<f64>]| {
        let mut column: Vec<f64> = b.iter().map(|row| row[column]).collect();
        column.sort_by(f64::total_cmp);
        column
    };
    for (ours, theirs) in columns(0, &linear.system.b).iter().zip(columns(duty, &plant.system.b)) {
        assert_within(*ours, theirs, 1e-6 * theirs.abs());
    }
    let trace = |a: &[Vec<f64>]| (0..a.len()).map(|n| a[n][n]).sum::<f64>();
    assert_close(trace(&linear.system.a), trace(&plant.system.a), 1e-7);
    assert_eq!(linear.averaged().expect("averaged").duty, 0.5);
    // The duty that holds that pressure is the one that made it.
    let balance = Balance::AtPressure(linear.point.gauge_pressure());
    let held = linearize_driven(&rig, Aim::Balance(balance), Content::Of(start)).expect("a duty");
    assert_close(held.averaged().expect("averaged").duty, 0.5, 1e-8);
}

/// `s² + (c/M) s + k/M`, k at a kept pressure; the pressure pulls with `dF/dP`.
#[test]
fn a_given_pressure_is_an_input() {
    let paper = Paper::sealed().friction(6.0, 0.0);
    let series = PressureSeries::new(&[0.0, 1.0], &[60.0 * PSI, 60.0 * PSI]).expect("a time series");
    let rig = paper.rig().with_pressure(series).expect("a rig");
    let balance = Balance::AtPressure(GaugePressure(60.0 * PSI));
    let linear = linearize(&rig, balance, Content::Temperature(ROOM)).expect("a model");
    let system = &linear.system;
    assert_eq!(
        (names(&system.states), names(&system.inputs)),
        (vec!["length", "velocity"], vec!["given_pressure", "force"])
    );
    let State { length, pressure, .. } = linear.point.state;
    let (actuator, mass) = (paper.actuator(), 5.0 * LB);
    assert_close(actuator.static_force(length, pressure.0), mass * GRAVITY, 1e-12);
    assert_close(system.a[1][0], -actuator.stiffness(length, pressure) / mass, 1e-12);
    assert_close(system.a[1][1], -6.0 / mass, 1e-12);
    let slope = actuator.law().law.braid.volume_slope(length);
    assert_close(system.b[1][0], slope / mass, 1e-12);
    let Load::HangingMass { .. } = linear.point.rig.load() else { panic!("another load") };
}

/// Two unlike muscles, shut, with a limb beside the axis; on tendons the rest length is 50 mm more.
fn pair(command: impl Fn(usize) -> Command) -> Pair {
    Pair::of(Paper::sealed().friction(6.0, 0.0).gauge(40.0 * PSI)).with(|pair| {
        for (i, paper) in pair.papers.iter_mut().enumerate() {
            paper.command = Some(command(i));
            paper.kind = ValveKind::FillHoldExhaust;
        }
        pair.papers[1].gauge = 30.0 * PSI;
        pair.papers[1].external_volume = 9e-6;
        (pair.limb.distance, pair.limb.hanging_angle, pair.damping) = (0.05, 0.4, 1e-3);
    })
}

fn fitted(pair: &Pair, fittings: [Fittings; 2], supply: JointSupply) -> JointRig {
    let bare = pair.rig().expect("a rig");
    let mut tendons = pair.tendons;
    for (over, its) in tendons.iter_mut().zip(&fittings) {
        over.rest_length += its.tendon.map_or(0.0, |tendon| tendon.rest_length());
    }
    let joint = Joint::new(pair.limb, tendons, pair.torque, pair.damping, pair.stops).expect("a joint");
    JointRig::fitted(bare.driven().clone(), joint, fittings, supply).expect("a rig")
}

fn joint_numbers(system: &StateSpace, sample: &JointSample) -> Vec<f64> {
    let [agonist, antagonist] = &sample.actuators;
    let of = |name: &str| match name {
        "angle" => sample.angle,
        "angular_velocity" => sample.angular_velocity,
        "agonist_pressure" => agonist.pressure.0,
        "agonist_air_mass" => agonist.air_mass,
        "agonist_length" => agonist.length,
        "agonist_hose_pressure" => agonist.hose_pressure.0,
        "antagonist_pressure" => antagonist.pressure.0,
        "antagonist_air_mass" => antagonist.air_mass,
        "antagonist_length" => antagonist.length,
        "antagonist_hose_pressure" => antagonist.hose_pressure.0,
        other => panic!("{other}"),
    };
    system.states.iter().map(|state| of(&state.name)).collect()
}

#[test]
fn a_joint_with_hoses_and_tendons_follows_two_runs() {
    let line = Line { hose: Some(hose(HoseKind::Lumped)), ..Line::NONE };
    let tendon = || Some(SeriesTendon::new(8e3, 0.05).expect("a tendon"));
    let hosed = Fittings { line, ..Fittings::NONE };
    let both = [Fittings { line, tendon: tendon(), pressure: None }, hosed.clone()];
    for (fittings, states) in [([hosed.clone(), hosed.clone()], 8), (both, 9)] {
        let rig = fitted(&pair(|_| Command::Constant(Request::Hold)), fittings, JointSupply::Separate);
        let gauge = [40.0, 30.0].map(|psi| GaugePressure(psi * PSI));
        let model = linearize_joint(&rig, JointBalance::AtPressures(gauge), [ROOM; 2]).expect("a model");
        assert_eq!(model.system.states.len(), states, "{:?}", names(&model.system.states));
        assert_eq!(model.minimal().states.len(), states - 2);
        let joint = JointPlant::new(&rig).expect("a plant");
        for disturbed in 0..4 {
            let run = |sign: f64| {
                let mut start = model.state;
                match disturbed {
                    0 => start.angle += sign * 1e-4,
                    1 => start.angular_velocity += sign * 1e-2,
                    2 => start.pressure[0].0 += sign * 20.0,
                    _ => start.pressure[1].0 += sign * 20.0,
                }
                joint.simulate(&start, 0.05, 1e-12).expect("a run")
            };
            let runs = [run(1.0), run(-1.0)];
            let apart = |time: f64| -> Vec<f64> {
                let [plus, minus] = runs.each_ref().map(|run| joint_numbers(&model.system, &run.at(time)));
                plus.iter().zip(&minus).map(|(plus, minus)| 0.5 * (plus - minus)).collect()
            };
            let what = format!("joint of {states} states, {disturbed}");
            assert_follows(&model.system, [&apart(0.0), &apart(0.05)], 0.05, 2e-3, &what);
        }
    }
}

/// On tendons the point for a stiffness has it: the slope of the torque at kept pressures.
#[test]
fn a_stiffness_on_tendons_has_its_point() {
    let tendon = || Some(SeriesTendon::new(8e3, 0.05).expect("a tendon"));
    let fittings = [(); 2].map(|()| Fittings { tendon: tendon(), ..Fittings::NONE });
    let rig = fitted(&pair(|_| Command::Constant(Request::Hold)), fittings, JointSupply::Separate);
    let balance = JointBalance::AtStiffness { angle: 0.1, stiffness: 0.8 };
    let model = linearize_joint(&rig, balance, [ROOM; 2]).expect("a model");
    assert_within(model.state.angle, 0.1, 1e-9);
    let torque = |angle: f64| {
        let lengths = rig.lengths(angle, model.state.pressure);
        let pull = |i: usize| rig.driven()[i].actuator.static_force(lengths[i], model.state.pressure[i].0);
        let arms = rig.joint().leverage(angle).arms;
        arms[0] * pull(0) - arms[1] * pull(1)
    };
    assert_close(-crate::common::slope(1e-4, |by| torque(0.1 + by)), 0.8, 1e-6);
    assert_within(torque(0.1) + rig.joint().other_torque(0.1, 0.0), 0.0, 1e-9);
}

/// One bottle feeds both pulsed valves through hoses: names, and means of a simulated run about the point.
#[test]
fn a_joint_on_one_bottle_is_averaged() {
    let pulses = |i: usize| {
        let (frequency, duty) = [(200.0, 0.5), (150.0, 0.4)][i];
        Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("pulses")
    };
    let pair = pair(pulses).with(|pair| {
        pair.papers.iter_mut().for_each(|paper| {
            paper.kind = ValveKind::ThreeWay;
            paper.delays = (0.3e-3, 0.2e-3);
        });
    });
    let line = Line { hose: Some(hose(HoseKind::Lumped)), supply: supply(true, true), ..Line::NONE };
    let bare = Line { supply: None, ..line };
    let fittings = [line, bare].map(|line| Fittings { line, ..Fittings::NONE });
    let rig = fitted(&pair, fittings, JointSupply::Shared);
    let start = rig.start(&pair.initial()).expect("a start");
    let model = linearize_driven_joint(&rig, &start, &PlantAir::Start).expect("a model");
    assert_eq!(names(&model.system.inputs)[..2], ["agonist_duty", "antagonist_duty"]);
    let states = names(&model.system.states);
    for name in ["reservoir_pressure", "supply_pressure", "agonist_hose_pressure", "antagonist_hose_pressure"] {
        assert_eq!(states.iter().filter(|its| **its == name).count(), 1, "{name}: {states:?}");
    }
    assert_eq!(model.averages().iter().map(|of| of.frequency).collect::<Vec<_>>(), [200.0, 150.0]);
    let run = JointPlant::new(&rig).expect("a plant").simulate(&model.state, 1.0, 1e-8).expect("a run");
    for i in 0..2 {
        let count = 4000;
        let pressure = |n: i32| run.at(0.8 + 0.2 * f64::from(n) / f64::from(count)).actuators[i].pressure.0;
        let mean = (0..count).map(pressure).sum::<f64>() / f64::from(count);
        assert_within(mean, model.state.pressure[i].0, 0.1 * model.averages()[i].pressure_ripple.max(2e4));
    }
}
