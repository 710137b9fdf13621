//! Plants near an operating point: the models of rigs, tendons and joints, entry by entry; manifolds and the edges of spools;
//! what has no point.

use crate::common::joint::Pair;
use crate::common::tendon::{STIFFNESS, on_tendon};
use crate::common::{ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::GaugePressure;
use mckibben::air::Process;
use mckibben::friction::{BoucWen, Hysteresis, LuGre, MaxwellSlip};
use mckibben::line::Reservoir;
use mckibben::linearize::{
    Aim, Balance, Content, JointBalance, StateSpace, linearize, linearize_driven, linearize_driven_joint,
    linearize_joint,
};
use mckibben::load::{Load, MomentArm, Tendon};
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::plant::{
    InitialAir, Mounted, Plant, PlantAir, PlantBalance, PlantInput, PlantLinearization, PlantOutput, PlantStart,
    PlantState, PlantStateSpace, linearize_plant, simulate_plant,
};
use mckibben::simulation::{Actuation, Rig};
use mckibben::valve::{Command, FlowLaw, FlowStandard, Port, Request, Solenoid, Spool, ValveKind, flow_parameter};

const PROCESSES: [Process; 4] = [
    Process::Isentropic,
    Process::Isothermal,
    Process::Polytropic { index: 1.2 },
    Process::EnergyBalance { heat_transfer: 0.05, wall_temperature: ROOM },
];

/// What a state of a rig's plant is called in the rig's own model.
fn old_state(rig: &Rig, state: PlantState) -> &'static str {
    match (state, rig.tendon().is_some()) {
        (PlantState::Position { .. }, true) => "load_distance",
        (PlantState::Velocity { .. }, true) => "load_velocity",
        (PlantState::Position { .. }, false) | (PlantState::Length { .. }, _) => "length",
        (PlantState::Velocity { .. }, false) => "velocity",
        (PlantState::Pressure { .. }, _) => "pressure",
        (PlantState::AirMass { .. }, _) => "air_mass",
        (other, _) => panic!("{other:?}"),
    }
}

fn old_input(input: PlantInput) -> Option<&'static str> {
    match input {
        PlantInput::Duty { .. } => Some("duty"),
        PlantInput::MassFlow { .. } => Some("mass_flow"),
        PlantInput::Force { .. } => Some("force"),
        PlantInput::Opening { port: Port::Supply, .. } => Some("supply_opening"),
        PlantInput::Opening { port: Port::Exhaust, .. } => Some("exhaust_opening"),
        PlantInput::SupplyPressure { .. } => Some("supply_pressure"),
        _ => None,
    }
}

fn old_output(output: PlantOutput) -> Option<&'static str> {
    match output {
        PlantOutput::Length { .. } => Some("length"),
        PlantOutput::LengthRate { .. } => Some("velocity"),
        PlantOutput::Pressure { .. } => Some("pressure"),
        PlantOutput::Tension { .. } => Some("tension"),
        _ => None,
    }
}

/// Every entry of the old model against that of the plant's: each measured by the largest of its row.
fn assert_same(
    old: &StateSpace,
    new: &PlantStateSpace,
    state: &dyn Fn(PlantState) -> &'static str,
    input: &dyn Fn(PlantInput) -> Option<&'static str>,
    output: &dyn Fn(PlantOutput) -> Option<&'static str>,
    tolerance: f64,
) {
    let mut compared = 0;
    let places: Vec<usize> = new
        .states
        .iter()
        .map(|it| old.states.iter().position(|signal| signal.name == state(*it)).expect("a state of the rig"))
        .collect();
    assert_eq!(places.len(), old.states.len(), "{:?}", new.states);
    let columns: Vec<Option<usize>> = new.inputs.iter().map(|it| input(*it).and_then(|name| old.input(name))).collect();
    assert_eq!(columns.iter().flatten().count(), old.inputs.len(), "{:?}", new.inputs);
    // The effect of a usual change of each state or input on a row, relative to which less is rounding.
    let usual = |name: &str| match name {
        "pressure" | "agonist_pressure" | "antagonist_pressure" => 1e5,
        "air_mass" | "agonist_air_mass" | "antagonist_air_mass" => 1e-5,
        "length" | "load_distance" => 0.1,
        "mass_flow" | "agonist_mass_flow" | "antagonist_mass_flow" => 1e-3,
        _ => 1.0,
    };
    let size = |row: &[f64], signals: &[mckibben::linearize::Signal]| {
        row.iter().zip(signals).fold(0.0_f64, |most, (entry, signal)| most.max((entry * usual(&signal.name)).abs()))
    };
    let mut entry = |mine: f64, theirs: f64, of_row: f64, name: &str, what: &str| {
        let own = theirs.abs().max(1e-6 * of_row / usual(name));
        assert!((mine - theirs).abs() <= tolerance * own, "{what}: {mine:e} is not {theirs:e}");
        compared += 1;
    };
    for (i, row) in places.iter().enumerate() {
        for (j, column) in places.iter().enumerate() {
            entry(
                new.a[i][j],
                old.a[*row][*column],
                size(&old.a[*row], &old.states),
                &old.states[*column].name,
                &format!("A {:?} {:?}", new.states[i], new.states[j]),
            );
        }
        for (j, column) in columns.iter().enumerate() {
            if let Some(column) = column {
                entry(
                    new.b[i][j],
                    old.b[*row][*column],
                    size(&old.b[*row], &old.inputs),
                    &old.inputs[*column].name,
                    &format!("B {:?} {:?}", new.states[i], new.inputs[j]),
                );
            }
        }
    }
    for (i, shown) in new.outputs.iter().enumerate() {
        let Some(row) = output(*shown).and_then(|name| old.output(name)) else { continue };
        for (j, column) in places.iter().enumerate() {
            entry(
                new.c[i][j],
                old.c[row][*column],
                size(&old.c[row], &old.states),
                &old.states[*column].name,
                &format!("C {shown:?} {:?}", new.states[j]),
            );
        }
        for (j, column) in columns.iter().enumerate() {
            if let Some(column) = column {
                entry(
                    new.d[i][j],
                    old.d[row][*column],
                    size(&old.d[row], &old.inputs),
                    &old.inputs[*column].name,
                    &format!("D {shown:?} {:?}", new.inputs[j]),
                );
            }
        }
    }
    assert!(compared >= old.states.len() * old.states.len());
}

/// The plant of a rig at a gauge pressure with its valve shut.
fn plant_at(rig: &Rig, start: &mckibben::simulation::State, gauge: f64) -> PlantLinearization {
    let plant = Plant::of_rig(rig);
    let start = Plant::start_of_rig(rig, start);
    let balance = PlantBalance::Shut(vec![GaugePressure(gauge)]);
    linearize_plant(&plant, &start, &balance, &PlantAir::Temperatures(vec![ROOM])).expect("a model")
}

fn compare_rig(paper: &Paper, rig: &Rig, balance: Balance, gauge: f64) {
    let old = linearize(rig, balance, Content::Temperature(ROOM)).expect("a model of the rig");
    let new = plant_at(rig, &paper.start(), gauge);
    assert_close(new.point.lengths[0], old.point.state.length, 1e-12);
    let mass = new.point.state[new.point.plant.indices().actuators[0].mass()];
    assert_close(mass, old.point.state.air_mass, 1e-11);
    let state = |it| old_state(rig, it);
    assert_same(&old.system, &new.system, &state, &old_input, &old_output, 1e-8);
    assert_same(&old.minimal(), &new.minimal(), &state, &old_input, &old_output, 1e-8);
    assert_within(new.coulomb_bounds(0)[1], old.point.coulomb_bound(), 1e-9 * old.point.coulomb_bound());
    if old.point.coulomb_bound() > 0.0 {
        let old = old.with_equivalent_damping(1e-4, 50.0).expect("a model");
        let new = new.with_equivalent_damping(&[Some((1e-4, 50.0))]).expect("a model");
        assert_same(&old.system, &new.system, &state, &old_input, &old_output, 1e-8);
    }
}

#[test]
fn a_sealed_rig_has_the_model_of_its_plant() {
    let gauge = 60.0 * PSI;
    for process in PROCESSES {
        let heat = matches!(process, Process::EnergyBalance { .. });
        let paper = Paper::sealed().process(process);
        // Of a sealed actuator's energy balance the rig's model has no temperature of the mass flow.
        if !heat {
            compare_rig(&paper, &paper.rig(), Balance::AtPressure(GaugePressure(gauge)), gauge);
        }
        let valve = Paper::pwm(25.0, 0.5).process(process);
        compare_rig(&valve, &valve.rig(), Balance::AtPressure(GaugePressure(gauge)), gauge);
    }
    // Taut, pulled by a force, held.
    let paper = Paper::sealed();
    compare_rig(&paper, &paper.rig(), Balance::AtPressure(GaugePressure(0.0)), 0.0);
    let pulled = paper.clone().with(|rig| rig.load = Load::ConstantForce { mass: 2.0, force: 25.0 });
    compare_rig(&pulled, &pulled.rig(), Balance::AtPressure(GaugePressure(gauge)), gauge);
    let held = paper.isometric(3.5 * INCH);
    compare_rig(&held, &held.rig(), Balance::AtBoth(GaugePressure(gauge), 3.5 * INCH), gauge);
}

#[test]
fn hysteresis_is_relaxed_at_the_point() {
    let gauge = 60.0 * PSI;
    let laws = [
        Hysteresis::MaxwellSlip(MaxwellSlip::new(&[0.3, 0.2], &[1e-4, 5e-4]).expect("a law")),
        Hysteresis::BoucWen(BoucWen::new(1e-4, 3e3, 1e3).expect("a law")),
    ];
    for law in laws {
        let paper = Paper::sealed().with(|rig| rig.hysteresis = Some(law));
        compare_rig(&paper, &paper.rig(), Balance::AtPressure(GaugePressure(gauge)), gauge);
    }
}

#[test]
fn bristles_at_rest_follow_the_length() {
    let gauge = 60.0 * PSI;
    let law = LuGre::new(1e-4, 3e-4).and_then(|law| law.with_velocity(1.3, 0.02, 1e-4)).expect("a law");
    let paper = Paper::sealed().with(|rig| rig.hysteresis = Some(Hysteresis::LuGre(law)));
    let rig = paper.rig();
    let old = linearize(&rig, Balance::AtPressure(GaugePressure(gauge)), Content::Temperature(ROOM)).expect("a model");
    let new = plant_at(&rig, &paper.start(), gauge);
    assert!(new.system.states.contains(&PlantState::Bristles { actuator: 0 }));
    let state = |it| old_state(&rig, it);
    assert_same(&old.minimal(), &new.minimal(), &state, &old_input, &old_output, 1e-8);
}

#[test]
fn a_tendon_in_series_has_the_model_of_its_plant() {
    for process in &PROCESSES[..3] {
        for (viscous, coulomb) in [(0.0, 0.0), (3.5, 0.0), (80.0, 0.0), (3.5, 1e-4), (0.0, 1e-4)] {
            let paper = Paper::sealed().friction(viscous, coulomb).process(*process);
            let rig = on_tendon(&paper, STIFFNESS);
            compare_rig(&paper, &rig, Balance::AtPressure(GaugePressure(60.0 * PSI)), 60.0 * PSI);
        }
    }
}

#[test]
fn a_pulsed_rig_has_the_model_of_its_plant() {
    for process in PROCESSES {
        for (frequency, duty) in [(25.0, 0.3), (50.0, 0.5), (50.0, 0.7)] {
            let paper = Paper::pwm(frequency, duty).process(process);
            let rig = paper.rig();
            let start = paper.start();
            let old = linearize_driven(&rig, Aim::Duty(duty), Content::Of(start)).expect("a balance");
            let plant = Plant::of_rig(&rig);
            let plant_start = Plant::start_of_rig(&rig, &start);
            let new = linearize_plant(&plant, &plant_start, &PlantBalance::Driven, &PlantAir::Start).expect("a model");
            let pressure = new.point.gauge_pressure(0).0;
            assert_close(pressure, old.point.gauge_pressure().0, 1e-9);
            assert_close(new.point.temperature(0), old.point.temperature(), 1e-9);
            let state = |it| old_state(&rig, it);
            assert_same(&old.system, &new.system, &state, &old_input, &old_output, 1e-6);
            assert_same(&old.minimal(), &new.minimal(), &state, &old_input, &old_output, 1e-6);
            let (theirs, mine) = (old.averaged().expect("averaged"), &new.averages[0]);
            assert_close(mine.shares[0], theirs.supply_share(), 1e-12);
            assert_close(mine.pressure_ripple, theirs.pressure_ripple, 1e-8);
            assert_close(mine.pressure_margin, theirs.pressure_margin, 1e-8);
            assert_eq!(mine.duty_range, theirs.duty_range);
            // The duty for that pressure is the one that gave it.
            let gauge = vec![new.point.gauge_pressure(0)];
            let back = linearize_plant(&plant, &plant_start, &PlantBalance::DrivenAt(gauge), &PlantAir::Start);
            let back = back.expect("a duty");
            assert_close(back.averages[0].duty, duty, 1e-9);
            assert_close(back.point.temperature(0), old.point.temperature(), 1e-9);
        }
    }
}

/// Two unlike actuators with arms that change and a limb that hangs askew, as in `linearize_joint.rs`.
fn uneven(paper: Paper) -> Pair {
    Pair::of(paper).with(|pair| {
        pair.papers[0].gauge = 45.0 * PSI;
        pair.papers[1].gauge = 30.0 * PSI;
        pair.papers[1].external_volume = 9e-6;
        pair.limb.distance = 0.05;
        pair.limb.hanging_angle = 0.4;
        pair.damping = 1e-3;
        let arm = |arms: [f64; 2]| MomentArm::table(&[-0.6, 0.6], &arms).expect("a table");
        pair.tendons = [[0.012, 0.017], [0.016, 0.013]].map(|arms| Tendon { arm: arm(arms), rest_length: 0.082 });
    })
}

fn joint_state(state: PlantState) -> &'static str {
    match state {
        PlantState::Position { .. } => "angle",
        PlantState::Velocity { .. } => "angular_velocity",
        PlantState::Pressure { actuator } => ["agonist_pressure", "antagonist_pressure"][actuator],
        PlantState::AirMass { actuator } => ["agonist_air_mass", "antagonist_air_mass"][actuator],
        other => panic!("{other:?}"),
    }
}

fn joint_input(input: PlantInput) -> Option<&'static str> {
    match input {
        PlantInput::Duty { valve } => Some(["agonist_duty", "antagonist_duty"][valve]),
        PlantInput::MassFlow { actuator } => Some(["agonist_mass_flow", "antagonist_mass_flow"][actuator]),
        PlantInput::Force { .. } => Some("torque"),
        // The agonist's supply is the first source.
        PlantInput::SupplyPressure { node: 0 | 1 } => Some("agonist_supply_pressure"),
        PlantInput::SupplyPressure { .. } => Some("antagonist_supply_pressure"),
        _ => None,
    }
}

fn joint_output(output: PlantOutput) -> Option<&'static str> {
    match output {
        PlantOutput::Position { .. } => Some("angle"),
        PlantOutput::Velocity { .. } => Some("angular_velocity"),
        PlantOutput::Pressure { actuator } => Some(["agonist_pressure", "antagonist_pressure"][actuator]),
        PlantOutput::ActuatorForce { .. } => Some("actuator_torque"),
        _ => None,
    }
}

#[test]
fn a_joint_has_the_model_of_its_plant() {
    let sealed = uneven(Paper::sealed().friction(2.0, 0.0));
    let pulsed = uneven(Paper::sealed().friction(2.0, 1e-4)).with(|pair| {
        // Unlike frequencies, each averaged over its own period.
        for (paper, (frequency, duty)) in pair.papers.iter_mut().zip([(400.0, 0.5), (270.0, 0.35)]) {
            paper.command = Some(Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command"));
            paper.delays = (0.2e-3, 0.1e-3);
            paper.standard = FlowStandard::Orifice { flow_area: 1e-6 };
        }
    });
    let gauge = [0, 1].map(|i| GaugePressure(sealed.papers[i].gauge));
    let rig = sealed.rig().expect("a rig");
    let old = linearize_joint(&rig, JointBalance::AtPressures(gauge), [ROOM; 2]).expect("a model");
    let model = |pair: &Pair, balance: PlantBalance| {
        let rig = pair.rig().expect("a rig");
        let start = Plant::start_of_joint(&rig, &rig.start(&pair.initial()).expect("a start"));
        let plant = Plant::of_joint(&rig).expect("a plant");
        linearize_plant(&plant, &start, &balance, &PlantAir::Temperatures(vec![ROOM; 2])).expect("a model")
    };
    let new = model(&sealed, PlantBalance::Shut(gauge.to_vec()));
    assert_within(new.point.state[0], old.state.angle, 1e-11);
    assert_same(&old.system, &new.system, &joint_state, &joint_input, &joint_output, 1e-7);
    assert_same(&old.minimal(), &new.minimal(), &joint_state, &joint_input, &joint_output, 1e-7);
    let rig = pulsed.rig().expect("a rig");
    let start = rig.start(&pulsed.initial()).expect("a start");
    let old = linearize_driven_joint(&rig, &start, &PlantAir::Temperatures(vec![ROOM; 2])).expect("a model");
    let new = model(&pulsed, PlantBalance::Driven);
    assert_within(new.point.state[0], old.state.angle, 1e-10);
    assert_same(&old.system, &new.system, &joint_state, &joint_input, &joint_output, 1e-6);
    assert_same(&old.minimal(), &new.minimal(), &joint_state, &joint_input, &joint_output, 1e-6);
    assert_eq!(new.averages.iter().map(|it| it.frequency).collect::<Vec<_>>(), [400.0, 270.0]);
}

#[test]
fn points_that_cannot_be_are_refused_with_a_remedy() {
    let refused = |paper: &Paper, balance: PlantBalance| {
        let rig = paper.rig();
        let plant = Plant::of_rig(&rig);
        let start = Plant::start_of_rig(&rig, &paper.start());
        match linearize_plant(&plant, &start, &balance, &PlantAir::Temperatures(vec![ROOM])) {
            Err(error) => error,
            Ok(model) => panic!("{:?}", model.point.state),
        }
    };
    let shut = |psi: f64| PlantBalance::Shut(vec![GaugePressure(psi * PSI)]);
    let paper = Paper::sealed();
    let short = paper.clone().with(|rig| rig.min_length = Some(0.08));
    let no_solution = |error: mckibben::Error| matches!(error, mckibben::Error::NoSolution { .. });
    assert!(no_solution(refused(&short, shut(200.0))));
    assert!(refused(&paper, shut(-20.0)).to_string().contains("vacuum"));
    assert!(refused(&paper, PlantBalance::Shut(vec![])).to_string().contains("one entry for each actuator"));
    let weightless = paper.clone().with(|rig| rig.load = Load::ConstantForce { mass: 1.0, force: 0.0 });
    assert!(no_solution(refused(&weightless, shut(60.0))));
    let high = Paper::pwm(25.0, 0.5);
    let too_high = PlantBalance::DrivenAt(vec![GaugePressure(150.0 * PSI)]);
    let error = refused(&high, too_high);
    assert!(error.to_string().contains("no command"), "{error}");
    // A two-way valve that is shut feeds nothing: the actuator keeps its pressure.
    let held =
        Paper::driven(Command::Constant(Request::Hold)).with(|rig| rig.kind = ValveKind::TwoWay).gauge(40.0 * PSI);
    let rig = held.rig();
    let model = linearize_plant(
        &Plant::of_rig(&rig),
        &Plant::start_of_rig(&rig, &held.start()),
        &PlantBalance::Driven,
        &PlantAir::Start,
    );
    assert_close(model.expect("a model").point.gauge_pressure(0).0, 40.0 * PSI, 1e-12);
}

/// Gauge pressure in Pa of what feeds; areas in m² of the paths of a valve and of an inlet.
const FEED: f64 = 6e5;
const AREA: f64 = 5e-6;
const INLET: f64 = 1e-6;
/// R and γ of the air, and the ratio above which the law is a straight line.
const GAS: f64 = 286.99;
const GAMMA: f64 = 1.4;
const LAMINAR: f64 = 0.999;

/// What feeds a muscle at a constant length, whose valve vents to the atmosphere.
#[derive(Clone, Copy)]
enum Feeder {
    /// A source.
    Source,
    /// A manifold of 40 cm³ with its gauge pressure at the start, behind a bottle or a source, by an orifice or a check valve.
    Manifold { gauge: f64, bottle: bool, one_way: bool },
}

/// The plant, the node of what feeds, and that of the manifold.
fn fed(paper: &Paper, feeder: Feeder, (solenoid, command): (Solenoid, Command)) -> (Plant, usize, usize) {
    let air = paper.air();
    let [wide, inlet] = [AREA, INLET]
        .map(|flow_area| FlowLaw::new(FlowStandard::Orifice { flow_area }, 1.0, LAMINAR, &air).expect("a law"));
    let path = |law, valve, port| BranchKind::Path { law, valve, port, ambient: false, copies: 1.0 };
    let reservoir = |volume, gauge| {
        let reservoir = Reservoir::new([volume, 1.0, ROOM], GaugePressure(gauge), None, &air);
        NodeKind::Reservoir(reservoir.expect("a reservoir"))
    };
    let mut network = Network::new(&air);
    let outside = network.node(NodeKind::Atmosphere, 0.0, ROOM);
    let valve = network.valve(Actuation { solenoid, command });
    let source = match feeder {
        Feeder::Manifold { bottle: true, .. } => network.node(reservoir(5e-4, FEED), 0.0, ROOM),
        _ => network.node(NodeKind::Source, FEED, ROOM),
    };
    let mut from = source;
    if let Feeder::Manifold { gauge, one_way, .. } = feeder {
        from = network.node(reservoir(4e-5, gauge), 0.0, ROOM);
        let always = Solenoid::new(ValveKind::TwoWay, 0.0, 0.0).expect("a solenoid");
        let kind = match one_way {
            true => BranchKind::Check { law: inlet },
            false => {
                let open = Actuation { solenoid: always, command: Command::Constant(Request::Fill) };
                path(inlet, network.valve(open), Port::Supply)
            }
        };
        network.branch(source, from, kind);
    }
    let chamber = network.chamber(0, ROOM);
    network.branch(from, chamber, path(wide, valve, Port::Supply));
    network.branch(outside, chamber, path(wide, valve, Port::Exhaust));
    let (actuator, coupling) = (paper.actuator().without_valve(), Coupling::Direct { coordinate: 0 });
    let mounted = Mounted { actuator, mechanism: 0, coupling, tendon: None, pressure: None };
    (Plant::new(vec![mounted], network, vec![Mechanism::Fixed]).expect("a plant"), source, from)
}

fn start_at(gauge: f64) -> PlantStart {
    PlantStart {
        positions: vec![vec![0.09]],
        rates: vec![vec![0.0]],
        air: vec![InitialAir { gauge_pressure: GaugePressure(gauge), temperature: ROOM }],
        lengths: vec![None],
        ..PlantStart::default()
    }
}

fn spool(overlap: f64, position: f64) -> (Solenoid, Command) {
    let spool = Spool::new(100.0, 0.7, overlap, overlap).expect("a spool");
    (Solenoid::proportional(spool), Command::positions(vec![0.0], vec![position]).expect("a position"))
}

fn isothermal() -> Paper {
    Paper::sealed().process(Process::Isothermal).isometric(0.09)
}

/// On the two sides of an edge the gain is that of one path or the other, `RT/V ṁ` by (23); the model has the mean of both.
#[test]
fn a_spool_at_an_edge_has_the_mean_of_both_gains() {
    let (paper, gauge) = (isothermal(), 5e5);
    let per_flow = GAS * ROOM / paper.actuator().volume(0.09);
    let flow = |up: f64, down: f64| AREA * flow_parameter(GAMMA, GAS, down / up) * up / ROOM.sqrt();
    let (supply, pressure) = (FEED + ATMOSPHERE, gauge + ATMOSPHERE);
    let [filling, exhausting] = [flow(supply, pressure), flow(pressure, ATMOSPHERE)].map(|flow| per_flow * flow);
    assert!(filling < 0.9 * exhausting, "the sides differ");
    for (overlap, position, gains) in [
        (0.0, 0.0, [exhausting, filling]),
        (0.05, 0.05, [0.0, filling / 0.95]),
        (0.05, -0.05, [exhausting / 0.95, 0.0]),
        (0.05, 0.0, [0.0; 2]),
        (0.05, 0.049, [0.0; 2]),
    ] {
        let (plant, ..) = fed(&paper, Feeder::Source, spool(overlap, position));
        let model = linearize_plant(&plant, &start_at(gauge), &PlantBalance::Driven, &PlantAir::Start);
        let model = model.expect("a model");
        let system = &model.system;
        let place = |of: PlantState| system.states.iter().position(|it| *it == of).expect("a state");
        let entry =
            system.a[place(PlantState::Pressure { actuator: 0 })][place(PlantState::SpoolPosition { valve: 0 })];
        let found = model.spool_gains(0).expect("a spool");
        for (found, expected) in found.into_iter().zip(gains) {
            assert_within(found, expected, 1e-9 * filling);
        }
        assert_within(entry, 0.5 * (gains[0] + gains[1]), 1e-9 * filling);
        assert_eq!(model.is_in_dead_zone(0), gains == [0.0; 2], "{overlap} {position}");
    }
    // Where both edges are open there is no corner: both paths change together, and at balance they pass as much.
    let (plant, ..) = fed(&paper, Feeder::Source, spool(-0.1, 0.0));
    let model = linearize_plant(&plant, &start_at(gauge), &PlantBalance::Driven, &PlantAir::Start).expect("a model");
    let [below, above] = model.spool_gains(0).expect("a spool");
    let vented = flow(model.point.gauge_pressure(0).0 + ATMOSPHERE, ATMOSPHERE);
    assert_close(below, per_flow * 2.0 * vented / 1.1, 1e-8);
    assert_close(above, below, 1e-12);
}

/// With the valves held shut an inlet stays open: the manifold is at the pressure of what feeds it, and goes back there as
/// `dṁ/dP = −A_p C_q C_m(r)/((1 − r) √T)` on the straight line says, r where that begins.
#[test]
fn an_inlet_without_a_valve_stays_open() {
    let paper = isothermal();
    // A two-way valve that is commanded to fill has a path to the atmosphere too: it is held shut.
    let muscle = || (Solenoid::new(ValveKind::TwoWay, 0.0, 0.0).expect("a solenoid"), Command::Constant(Request::Fill));
    let shut = PlantBalance::Shut(vec![GaugePressure(1e5)]);
    let rate = GAS * ROOM / 4e-5 * INLET * flow_parameter(GAMMA, GAS, LAMINAR) / ((1.0 - LAMINAR) * ROOM.sqrt());
    for (bottle, one_way) in [(false, false), (true, false), (false, true), (true, true)] {
        for gauge in [4e5, FEED, 7e5] {
            let (plant, source, manifold) = fed(&paper, Feeder::Manifold { gauge, bottle, one_way }, muscle());
            let model = linearize_plant(&plant, &start_at(1e5), &shut, &PlantAir::Start).expect("a model");
            let (system, nodes) = (&model.system, &model.point.plant.indices().nodes);
            let there = model.point.state[nodes[manifold].expect("a state")] - ATMOSPHERE;
            // What a check valve keeps from flowing back stays.
            let keeps = one_way && gauge > FEED;
            assert_close(there, if keeps { gauge } else { FEED }, 1e-8);
            let of = |node: usize| system.states.iter().position(|it| *it == PlantState::NodePressure { node });
            let row = of(manifold).expect("a state");
            let rate = if keeps { 0.0 } else { rate };
            assert_within(system.a[row][row], -rate, 1e-9 * rate);
            if bottle {
                assert_within(system.a[row][of(source).expect("a state")], rate, 1e-9 * rate);
                let kept = model.point.state[nodes[source].expect("a state")] - ATMOSPHERE;
                assert_close(kept, FEED, 1e-12);
            }
            for (input, value) in &model.point.inputs {
                match input {
                    PlantInput::NodeFlow { .. } | PlantInput::MassFlow { .. } => assert_within(*value, 0.0, 1e-9),
                    PlantInput::Opening { valve: 0, .. } => assert_eq!(*value, 0.0),
                    PlantInput::Opening { .. } => assert_eq!(*value, 1.0),
                    _ => {}
                }
            }
        }
    }
}

/// A manifold between its inlet and a spool that is open to both sides: a long run rests at the point, and small differences
/// of runs about it follow the model. A bottle in place of the source keeps its pressure by what is drawn.
#[test]
fn the_balance_of_commands_contains_the_manifold() {
    let paper = isothermal();
    let manifold_at = |gauge: f64| Feeder::Manifold { gauge, bottle: false, one_way: false };
    let build = |gauge: f64| fed(&paper, manifold_at(gauge), spool(-0.5, 0.0));
    let (plant, _, manifold) = build(FEED);
    let model = linearize_plant(&plant, &start_at(1e5), &PlantBalance::Driven, &PlantAir::Start).expect("a model");
    let places = plant.indices();
    let [chamber, node] = [places.actuators[0].pressure, places.nodes[manifold].expect("a state")];
    let there = [chamber, node].map(|slot| model.point.state[slot]);
    let run = simulate_plant(&plant, &start_at(1e5), 10.0, 1e-11).expect("a run");
    let rest = [chamber, node].map(|slot| run.at(10.0).0[slot]);
    assert!(rest[1] < 0.95 * (FEED + ATMOSPHERE), "{rest:?}");
    for (there, rest) in there.into_iter().zip(rest) {
        assert_close(there, rest, 1e-7);
    }
    assert_within(model.point.input(PlantInput::NodeFlow { node: manifold }).expect("an input"), 0.0, 1e-12);
    let (system, time) = (model.minimal(), 2e-3);
    let of = |wanted: PlantState| system.states.iter().position(|it| *it == wanted).expect("a state");
    let rows = [of(PlantState::Pressure { actuator: 0 }), of(PlantState::NodePressure { node: manifold })];
    for moved in 0..2 {
        let end = |sign: f64| {
            let mut gauges = there.map(|pressure| pressure - ATMOSPHERE);
            gauges[moved] += sign * 50.0;
            let (plant, ..) = build(gauges[1]);
            let run = simulate_plant(&plant, &start_at(gauges[0]), time, 1e-12).expect("a run");
            [chamber, node].map(|slot| run.at(time).0[slot])
        };
        let [plus, minus] = [end(1.0), end(-1.0)];
        // exp(A t) by its series.
        let mut term = [0.0; 2];
        term[moved] = 50.0;
        let mut expected = term;
        for k in 1..20 {
            let next = |row: usize| (0..2).map(|n| system.a[rows[row]][rows[n]] * term[n]).sum::<f64>() * time;
            term = [next(0), next(1)].map(|sum| sum / f64::from(k));
            expected = [expected[0] + term[0], expected[1] + term[1]];
        }
        for n in 0..2 {
            assert_within(0.5 * (plus[n] - minus[n]), expected[n], 1e-4 * 50.0);
        }
    }
    let bottled = Feeder::Manifold { gauge: FEED, bottle: true, one_way: false };
    let (plant, bottle, _) = fed(&paper, bottled, spool(-0.5, 0.0));
    let kept = linearize_plant(&plant, &start_at(1e5), &PlantBalance::Driven, &PlantAir::Start).expect("a model");
    assert_close(kept.point.gauge_pressure(0).0 + ATMOSPHERE, there[0], 1e-9);
    // All of it is vented at last, at the speed of sound.
    let vented = AREA / 3.0 * flow_parameter(GAMMA, GAS, ATMOSPHERE / there[0]) * there[0] / ROOM.sqrt();
    assert_close(kept.point.input(PlantInput::NodeFlow { node: bottle }).expect("an input"), vented, 1e-8);
}
