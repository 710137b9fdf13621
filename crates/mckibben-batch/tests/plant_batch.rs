//! Plants side by side: each is bit-identical to a scalar instance, on any width of instructions.

use crate::common::joint::Pair;
use crate::common::laws::measured;
use crate::common::plants::{leg_on_its_belt, on_a_bottle, requested, unlike_muscles_on_one_tank};
use crate::common::random::runner;
use crate::common::random_plants::{drawn, numbered, plant};
use crate::common::tendon::on_tendon;
use crate::common::{PSI, Paper, ROOM, spread};
use crate::single::{self, Singles};
use mckibben::control::{Output, Pid, Quantity, Regulator, Sampling, Sensors, SetPoint, Tracker};
use mckibben::force::Effectiveness;
use mckibben::friction::{Hysteresis, LuGre, Viscoelastic};
use mckibben::line::Line;
use mckibben::network::{Network, NodeKind};
use mckibben::plant::{Plant, PlantRun, PlantStart, PlantSteps, RigPlant};
use mckibben::simulation::{Actuation, Method, Rig};
use mckibben::valve::{self, Command, FlowStandard, Request, RuntimeCommand, Solenoid, ValveKind};
use mckibben::{Error, GaugePressure, parameter};
use mckibben_batch::{PlantBatch, Precision, Width};

/// The numbers of a state, to the bit.
pub(crate) fn bits(state: &[f64]) -> Vec<u64> {
    state.iter().map(|number| number.to_bits()).collect()
}

/// A row's own numbers: each has another mass, another volume, and another valve, whose poppets are under way for another time.
pub(crate) fn varied(plant: &Plant, row: usize) -> Plant {
    let share = 1.0 - 0.01 * row as f64;
    let varied = [
        parameter::MASS.key,
        parameter::EFFICIENCY.key,
        parameter::EXTERNAL_VOLUME.key,
        parameter::OPENING_TIME.key,
        parameter::CLOSING_TIME.key,
    ];
    plant.map(|_, row, value| if varied.contains(&row.key) { value * share } else { value })
}

/// Rows of a plant with different parameters, at their start.
pub(crate) fn rows(plant: &Plant, start: &PlantStart, method: Method, count: usize) -> Result<Vec<PlantSteps>, Error> {
    (0..count).map(|row| Ok(PlantRun::new(&varied(plant, row), start, 1e-9)?.steps(method))).collect()
}

/// What the first valve of a plant can be set to, at every second step.
pub(crate) fn commands_of(row: &PlantSteps) -> impl Fn(usize, usize) -> Option<RuntimeCommand> + Sync + use<> {
    let any = |share: f64| {
        let request = if share < 0.5 { Request::Fill } else { Request::Exhaust };
        let set = RuntimeCommand::SetPoint(GaugePressure(5e5 * share));
        [request.into(), RuntimeCommand::Position(2.0 * share - 1.0), set]
    };
    let takes = |kind: usize| row.clone().set(0, any(1.0)[kind]).is_ok();
    let kind = (!row.plant().network().valves.is_empty()).then(|| (0..3).find(|kind| takes(*kind))).flatten();
    move |row, count| {
        let is_set = (row + count).is_multiple_of(2);
        kind.filter(|_| is_set).map(|kind| any(spread(row + 37 * count, 6))[kind])
    }
}

/// Steps a batch of every width and a scalar instance of each row, which have to agree; returns the scalar instances.
pub(crate) fn agree(rows: &[PlantSteps], step: f64, steps: u32) {
    step_by_step(rows, step, steps, (Some(Singles::new(rows)), |_, _| None));
}

fn step_by_step(
    rows: &[PlantSteps],
    step: f64,
    steps: u32,
    (mut singles, command): (Option<Singles>, impl Fn(usize, usize) -> Option<RuntimeCommand> + Sync),
) {
    let mut scalar = rows.to_vec();
    let mut faults: Vec<Option<Error>> = vec![None; rows.len()];
    let mut batches: Vec<PlantBatch> = Vec::new();
    for width in Width::available() {
        batches.push(PlantBatch::with_lanes(rows.to_vec(), width, Precision::Double).expect("rows at one time"));
    }
    for count in 1..=steps {
        let until = step * f64::from(count);
        for (index, (row, fault)) in scalar.iter_mut().zip(&mut faults).enumerate() {
            if fault.is_none() {
                if let Some(command) = command(index, count as usize) {
                    row.set(0, command).expect("a command");
                }
                *fault = row.advance_to(until).err();
            }
        }
        for batch in &mut batches {
            if !batch.plant(0).is_some_and(|plant| plant.network().valves.is_empty()) {
                batch.set_each(0, |row| command(row, count as usize)).expect("commands");
            }
            batch.advance_to(until).expect("a time");
            let width = batch.width();
            for (index, (row, fault)) in scalar.iter().zip(&faults).enumerate() {
                match (batch.row(index), fault) {
                    (Ok(found), None) => {
                        let same = bits(found.state()) == bits(row.state());
                        let [ours, theirs] = [found.state().to_vec(), row.state().to_vec()];
                        assert!(same, "row {index} at {until} s, {width:?}: {ours:?}, {theirs:?}");
                    }
                    // As text: what is no number equals nothing.
                    (Err(found), Some(fault)) => assert_eq!(format!("{found:?}"), format!("{fault:?}")),
                    (found, fault) => panic!("row {index} at {until} s: {:?}, {fault:?}", found.err()),
                }
            }
        }
        if let Some(singles) = &mut singles {
            singles.go_on(until, &scalar, &faults);
        }
    }
    if let Some(singles) = singles {
        singles.check(&scalar, &faults);
    }
}

fn as_plant(paper: &Paper) -> (Plant, PlantStart) {
    let rig = paper.rig();
    (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &paper.start()))
}

#[test]
fn pulsed_actuators_with_dry_friction_equal_scalar_instances() {
    for coulomb in [0.0, 1e-4] {
        let paper = Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).friction(3.5, coulomb);
        let (plant, start) = as_plant(&paper);
        assert!(PlantBatch::covers(&plant), "it goes in lanes");
        for (method, step) in [(Method::Rk4, 5e-5), (Method::Stable, 1e-3)] {
            agree(&rows(&plant, &start, method, 37).expect("rows"), step, 300);
        }
    }
}

/// Joints with muscles that stick and with stops.
#[test]
fn joints_of_two_muscles_equal_scalar_instances() {
    for coulomb in [0.0, 1e-4] {
        let paper = Paper::pwm(25.0, 0.4).gauge(25.0 * PSI).friction(3.5, coulomb);
        let pair = Pair::of(paper);
        let rig = pair.rig().expect("a joint");
        let state = rig.start(&pair.initial()).expect("a start");
        let plant = Plant::of_joint(&rig).expect("a plant");
        let start = Plant::start_of_joint(&rig, &state);
        assert!(PlantBatch::covers(&plant), "it goes in lanes");
        for (method, step) in [(Method::Rk4, 5e-5), (Method::Stable, 1e-3)] {
            agree(&rows(&plant, &start, method, 21).expect("rows"), step, 300);
        }
    }
}

/// Legs that step on their belts and against their stops, with muscles that stick and without.
#[test]
fn legs_on_belts_equal_scalar_instances() {
    for coulomb in [0.0, 1e-4] {
        let (plant, start) = leg_on_its_belt(&Paper::sealed().friction(3.5, coulomb));
        assert!(PlantBatch::covers(&plant), "it goes in lanes");
        for (method, step) in [(Method::Rk4, 1e-4), (Method::Stable, 1e-3)] {
            agree(&rows(&plant, &start, method, 19).expect("rows"), step, 500);
        }
    }
}

/// Muscles on tendons that come loose and tight, whose ends slide by viscous friction, by the stiffness of their air alone, and
/// with bristles; with a table of effectiveness and a measured map.
#[test]
fn actuators_on_tendons_equal_scalar_instances() {
    let pulsed = |viscous, coulomb| Paper::pwm(25.0, 0.5).gauge(40.0 * PSI).friction(viscous, coulomb);
    let lugre = LuGre::new(1e-4, 3e-5).map(Hysteresis::LuGre);
    let papers = [
        pulsed(3.5, 0.0),
        pulsed(3.5, 1e-4),
        pulsed(0.0, 0.0),
        pulsed(0.0, 1e-4),
        Paper { hysteresis: Some(lugre.expect("a law")), ..pulsed(3.5, 0.0) },
        Paper { viscoelastic: Some(branches([0.1, 0.02])), structural: 1e-3, ..pulsed(3.5, 1e-4) },
        Paper { viscoelastic: Some(branches([0.1, 0.02])), ..pulsed(0.0, 0.0) },
        Paper { effectiveness: table(), ..pulsed(3.5, 1e-4) },
        Paper { characteristic: Some(measured(&pulsed(0.0, 0.0))), ..pulsed(3.5, 1e-4) },
    ];
    for paper in papers {
        let rig = on_tendon(&paper, 1e4);
        let start = rig.start(&paper.initial()).expect("a start");
        let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
        assert!(PlantBatch::covers(&plant), "it goes in lanes");
        for (method, step) in [(Method::Rk4, 2e-5), (Method::Stable, 1e-3)] {
            agree(&rows(&plant, &start, method, 19).expect("rows"), step, 300);
        }
    }
}

fn branches(relaxation_time: [f64; 2]) -> Viscoelastic {
    Viscoelastic::new(&[100.0, 0.0], &[0.1, 0.2], &relaxation_time).expect("branches")
}

/// Muscles that creep, with different parameters in each row: they are stepped side by side, each as its scalar instance.
#[test]
fn muscles_that_creep_equal_scalar_instances_and_have_one_structure() {
    let steps = |time: f64, method: Method| {
        let paper = Paper { viscoelastic: Some(branches([time, 0.02])), structural: 1e-3, ..Paper::pwm(25.0, 0.5) };
        let rig = paper.gauge(40.0 * PSI).rig();
        let start = rig.start(&Paper::pwm(25.0, 0.5).gauge(40.0 * PSI).initial()).expect("a start");
        let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &start));
        assert!(PlantBatch::covers(&plant), "it goes in lanes");
        PlantRun::new(&plant, &start, 1e-9).expect("a run").steps(method)
    };
    for (method, step) in [(Method::Rk4, 2e-5), (Method::Stable, 1e-3)] {
        let rows: Vec<PlantSteps> = (1..=19).map(|row| steps(0.02 * f64::from(row), method)).collect();
        agree(&rows, step, 300);
        let mut batch = PlantBatch::new(rows).expect("a batch");
        batch.restart(3, steps(7.0, method)).expect("a plant that differs in numbers alone");
    }
}

fn table() -> Effectiveness {
    Effectiveness::table(&[0.0, 1e5, 40.0 * PSI, 5e5], &[0.7, 0.85, 0.95, 1.0]).expect("a table")
}

/// Muscles on a tank that a compressor fills, behind a regulator with a dead band that the tank may limit.
#[test]
fn muscles_on_regulated_tanks_equal_scalar_instances() {
    for seed in [0, 6, 12, 18] {
        let (plant, start) = unlike_muscles_on_one_tank(seed);
        assert!(PlantBatch::covers(&plant), "it goes in lanes");
        for (method, step) in [(Method::Rk4, 2e-5), (Method::Stable, 1e-3)] {
            agree(&rows(&plant, &start, method, 19).expect("rows"), step, 300);
        }
    }
}

/// Proportional regulators at the limit of their rate and within it, whose set points are set on the way.
#[test]
fn proportional_regulators_equal_scalar_instances() {
    let paper = Paper::pwm(25.0, 0.5).gauge(10.0 * PSI).friction(3.5, 1e-4);
    let actuator = paper.actuator().with_valve(paper.valve());
    let regulator = valve::Regulator::new(0.02, 0.003, 4e6).expect("a regulator");
    let command = Command::SetPoints { time: vec![0.0, 0.1], gauge_pressure: vec![2e5, 1e5] };
    let actuation = Actuation { solenoid: Solenoid::regulating(regulator), command };
    let rig = Rig::new(actuator, Some(actuation), paper.load.clone()).expect("a rig");
    let (plant, start) = (Plant::of_rig(&rig), Plant::start_of_rig(&rig, &paper.start()));
    assert!(PlantBatch::covers(&plant), "it goes in lanes");
    for (method, step) in [(Method::Rk4, 5e-5), (Method::Stable, 1e-3)] {
        let mut made = rows(&plant, &start, method, 19).expect("rows");
        for (index, row) in made.iter_mut().enumerate() {
            row.set(0, RuntimeCommand::SetPoint(GaugePressure(5e4 + 3e4 * index as f64))).expect("a set point");
        }
        agree(&made, step, 300);
    }
}

/// Ends that a host moves, a shared bottle and a further mass: each row has a different motion.
#[test]
fn rows_on_bottles_whose_ends_hosts_move_equal_scalar_instances() {
    let (plant, start, _) = on_a_bottle();
    assert!(PlantBatch::covers(&plant), "it goes in lanes");
    let mut scalar = rows(&plant, &start, Method::Stable, 19).expect("rows");
    let mut batch = PlantBatch::new(scalar.clone()).expect("a batch");
    let mut before = [0.085, 0.088];
    for count in 0..200 {
        let (commands, distances) = requested(count);
        let rates = [0, 1].map(|k| (distances[k] - before[k]) / 1e-3);
        before = distances;
        for (index, row) in scalar.iter_mut().enumerate() {
            for (valve, commanded) in commands.into_iter().flatten().enumerate() {
                if (valve + index) % 3 != 0 {
                    row.set(valve, commanded).expect("a demand");
                    batch.set(index, valve, commanded).expect("a demand");
                }
            }
            let rates = rates.map(|rate| rate * (1.0 - 0.02 * index as f64));
            row.set_rates(0, &rates).expect("rates");
            batch.set_rates(index, 0, &rates).expect("rates");
            row.advance_to(f64::from(count + 1) * 1e-3).expect("on");
        }
        batch.advance_to(f64::from(count + 1) * 1e-3).expect("on");
        for (index, row) in scalar.iter().enumerate() {
            assert_eq!(bits(batch.row(index).expect("it goes on").state()), bits(row.state()), "{index} after {count}");
        }
    }
}

/// Blocks of many equal rows compute with the same memory, one after the other: what one leaves there does not reach another. The last
/// block has lanes without a row, and a row on the way has other numbers.
#[test]
fn many_equal_rows_equal_scalar_instances() {
    let (plant, start) = as_plant(&Paper::pwm(25.0, 0.5).gauge(40.0 * PSI).friction(3.5, 1e-4));
    // With more threads there would be fewer blocks in a group.
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for (method, step) in [(Method::Rk4, 2e-5), (Method::Stable, 1e-3)] {
        let first = PlantRun::new(&plant, &start, 1e-9).expect("a run");
        let mut scalar = vec![first.steps(method); 16 * Width::widest().rows() + 4];
        let rows = scalar.iter().map(|_| first.row(method));
        let mut batch = alone.install(|| PlantBatch::new(rows)).expect("rows at one time");
        for count in 1..=150_usize {
            for (index, row) in scalar.iter_mut().enumerate().filter(|(index, _)| (count + index) % 37 == 0) {
                let request = if index % 2 == 0 { Request::Fill } else { Request::Exhaust };
                row.set(0, request).expect("a request");
                batch.set(index, 0, request).expect("a request");
            }
            if count == 75 {
                let other = PlantRun::new(&varied(&plant, 30), &start, 1e-9).expect("a run");
                let other = other.begin_again(&start, batch.time()).expect("a start");
                scalar[9] = other.steps(method);
                batch.restart(9, other.row(method)).expect("equal structure");
            }
            let until = step * count as f64;
            alone.install(|| batch.advance_to(until)).expect("a time");
            for (index, row) in scalar.iter_mut().enumerate() {
                row.advance_to(until).expect("on");
                let found = batch.row(index).expect("a row").state();
                assert_eq!(bits(found), bits(row.state()), "row {index} at {until} s, {method:?}");
            }
        }
    }
}

/// A row that is set, and one that is reset with other parameters, go on as their scalar instances.
#[test]
fn rows_are_set_and_restarted() {
    let (plant, start) = as_plant(&Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).friction(3.5, 1e-4));
    let mut scalar = rows(&plant, &start, Method::Stable, 20).expect("rows");
    let mut batch = PlantBatch::new(scalar.clone()).expect("a batch");
    let pulses = |duty| RuntimeCommand::Pulses { frequency: 40.0, duty, pulse: Request::Fill, rest: Request::Exhaust };
    for count in 1..=120 {
        let until = 1e-3 * f64::from(count);
        let row = count as usize % 20;
        let duty = f64::from(count % 7) / 7.0;
        scalar[row].set(0, pulses(duty)).expect("a demand");
        batch.set(row, 0, pulses(duty)).expect("a demand");
        scalar.iter_mut().for_each(|row| row.advance_to(until).expect("on"));
        batch.advance_to(until).expect("on");
        if count == 60 {
            let mut restarted = PlantRun::new(&varied(&plant, 30), &start, 1e-9).expect("a run");
            restarted.advance_to(until).expect("on");
            let restarted = restarted.steps(Method::Stable);
            scalar[3] = restarted.clone();
            batch.restart(3, restarted).expect("equal structure");
        }
        for (index, row) in scalar.iter().enumerate() {
            assert_eq!(bits(batch.row(index).expect("it goes on").state()), bits(row.state()), "{index} at {until} s");
        }
    }
}

/// Rows with separate controllers, whose samples fall on ends of steps and between them, some late.
#[test]
fn rows_with_controllers_equal_scalar_instances() {
    let paper = Paper::pwm(50.0, 0.5).gauge(20.0 * PSI).with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    let of = RigPlant::new(&paper.rig());
    let start = of.start(&paper.start());
    for method in [Method::Rk4, Method::Stable] {
        let row = |row: u32| {
            let pid = Pid::new(Quantity::Pressure, 20.0 * PSI, Output::FillHoldExhaust).expect("a controller");
            let target = (30.0 + f64::from(row)) * PSI;
            let target = SetPoint::constant(Quantity::Pressure, target).expect("a set point");
            let law = Tracker::new(Quantity::Pressure, target, Regulator::Pid(pid)).expect("a law");
            let sampling = Sampling::new(40.0 + f64::from(row % 4), row as usize % 3).expect("a rate");
            let driver = of.driver(law, (sampling, Sensors::perfect())).expect("a driver");
            PlantRun::with_drivers(of.plant(), &start, 1e-9, vec![driver]).expect("a start").steps(method)
        };
        agree(&(0..19).map(row).collect::<Vec<_>>(), 5e-4, 400);
    }
}

/// A step of RK4 with a stage without air ends a row in lanes as it ends its scalar instance, and no other row.
#[test]
fn rows_whose_steps_are_too_long_stop_individually() {
    let paper = |area| Paper::pwm(25.0, 0.5).with(|rig| rig.standard = FlowStandard::Orifice { flow_area: area });
    let begin = |area: f64| {
        let (plant, start) = as_plant(&paper(area));
        PlantRun::new(&plant, &start, 1e-9).expect("a start").steps(Method::Rk4)
    };
    let rows: Vec<PlantSteps> = (0..19).map(|row| begin(if row % 3 == 1 { 2e-3 } else { 2e-6 })).collect();
    agree(&rows, 1e-4, 300);
    let stops = |steps: &PlantSteps| {
        let mut steps = steps.clone();
        (1..=300).find_map(|count| steps.advance_to(1e-4 * f64::from(count)).err())
    };
    let error = stops(&rows[1]).expect("far too long").to_string();
    assert!(error.contains("left the physics") && stops(&rows[0]).is_none(), "{error}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let (plant, start) = as_plant(&Paper::pwm(25.0, 0.5));
    let begun = || PlantRun::new(&plant, &start, 1e-9).expect("a run").steps(Method::Stable);
    let mut late = begun();
    late.advance_to(0.01).expect("on");
    assert!(matches!(PlantBatch::new(vec![begun(), late.clone()]), Err(Error::Misuse { .. })));
    let mut batch = PlantBatch::new(vec![begun()]).expect("a batch");
    assert!(matches!(batch.restart(0, late), Err(Error::Misuse { .. })));
    assert!(matches!(batch.row(1), Err(Error::Misuse { .. })));
    let (other, its_start) = as_plant(&Paper::sealed());
    let other = PlantRun::new(&other, &its_start, 1e-9).expect("a run").steps(Method::Stable);
    assert!(matches!(batch.restart(0, other), Err(Error::Misuse { .. })));
    assert!(matches!(batch.advance_to(f64::NAN), Err(Error::OutOfRange { .. })));
    assert_eq!(batch.time(), 0.0);
}

/// Rates of a chain are not brought again to where its muscles stick, where a valve is set and no time passes.
#[test]
fn chains_whose_valves_are_set_before_a_step_equal_scalar_instances() {
    let paper = Paper::pwm(25.0, 0.5).friction(3.5, 1e-4);
    let (leg, start) = leg_on_its_belt(&Paper::sealed().friction(3.5, 1e-4));
    let mut network = Network::new(&paper.air());
    let [outside, source] =
        [(NodeKind::Atmosphere, 0.0), (NodeKind::Source, 4e5)].map(|(kind, gauge)| network.node(kind, gauge, ROOM));
    let rig = paper.rig();
    network.draw(0, &paper.actuator(), (rig.actuation(), None), &Line::NONE, [source, outside], 1.0);
    let plant = Plant::new(leg.actuators().to_vec(), network, leg.mechanisms().to_vec()).expect("a plant");
    let rows = rows(&plant, &start, Method::Stable, 19).expect("rows");
    step_by_step(&rows, 1e-3, 400, (None, commands_of(&rows[0])));
}

/// Isothermal air on a table of moment arms has its pressure by the piece of the table at the end of a step, in both.
#[test]
fn air_on_a_table_of_moment_arms_equals_scalar_instances() {
    for number in [229, 382] {
        let (plant, start, _) = plant(&numbered(number));
        let rows = rows(&plant.expect("a plant"), &start, Method::Stable, 9).expect("starts");
        step_by_step(&rows, 1e-3, 40, (None, |_, _| None));
    }
}

/// Random plants that are stepped.
const STEPPED: u32 = 60;

/// Plants of any structure in a batch are bit-identical to scalar instances, and in single precision they go on or say why not. Some of
/// these have parts that lanes leave out, so that their rows are stepped individually.
#[test]
fn random_plants_in_a_batch_equal_scalar_instances() {
    let count = std::cell::Cell::new(0);
    let result = runner(STEPPED).run(&drawn(), |drawn| {
        let (plant, start, _) = plant(&drawn);
        let Ok(plant) = plant else { return Ok(()) };
        for (method, step) in [(Method::Stable, 1e-3), (Method::Rk4, 2e-5)] {
            if let Ok(rows) = rows(&plant, &start, method, 18) {
                step_by_step(&rows, step, 60, (None, |_, _| None));
                step_by_step(&rows, step, 60, (None, commands_of(&rows[0])));
                single::go_on_or_stop(rows, step, 60);
                count.set(count.get() + 1);
            }
        }
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    assert!(count.get() > STEPPED, "{} batches of {STEPPED} plants ran", count.get());
}
