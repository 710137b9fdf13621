//! Plants near an operating point: the models of rigs, tendons and joints, entry by entry; closed forms of tanks, chains and
//! hoses; simulated small signals; what has no point.

use crate::common::joint::Pair;
use crate::common::tendon::{STIFFNESS, on_tendon};
use crate::common::{INCH, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::GaugePressure;
use mckibben::air::Process;
use mckibben::friction::{BoucWen, Hysteresis, LuGre, MaxwellSlip};
use mckibben::linearize::{
    Aim, Balance, Content, JointBalance, StateSpace, linearize, linearize_driven, linearize_driven_joint,
    linearize_joint,
};
use mckibben::load::{Load, MomentArm, Tendon};
use mckibben::plant::{
    Plant, PlantAir, PlantBalance, PlantInput, PlantLinearization, PlantOutput, PlantState, PlantStateSpace,
    linearize_plant,
};
use mckibben::simulation::Rig;
use mckibben::valve::{Command, FlowStandard, Port, Request, ValveKind};

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
    assert_within(new.coulomb_bound(0), old.point.coulomb_bound(), 1e-9 * old.point.coulomb_bound());
    if old.point.coulomb_bound() > 0.0 {
        let old = old.with_equivalent_damping(1e-4, 50.0).expect("a model");
        let new = new.with_equivalent_damping(&[1e-4], 50.0).expect("a model");
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
