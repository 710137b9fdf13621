//! Ends that a host moves, of many plants at once: each row goes and answers as its own steps do, bit for bit, on any width.

use crate::common::plants::on_a_bottle;
use crate::common::random::runner;
use crate::common::random_plants::{drawn, plant};
use crate::common::{INCH, PSI, Paper, between, spread};
use crate::plant_batch::{bits, commands_of, rows};
use mckibben::air::Process;
use mckibben::friction::Viscoelastic;
use mckibben::load::SeriesTendon;
use mckibben::plant::{Plant, PlantRun, PlantStart, PlantSteps};
use mckibben::simulation::Method;
use mckibben::valve::{Request, RuntimeCommand};
use mckibben::{Error, Response};
use mckibben_batch::{PlantBatch, Precision, Width};

const STEP: f64 = 1e-3;

/// A muscle of the paper whose ends a host moves.
fn hosted(paper: &Paper, tendon: Option<SeriesTendon>) -> (Plant, PlantStart) {
    let rig = paper.rig();
    let rig = match tendon {
        Some(tendon) => rig.with_tendon(tendon),
        None => rig,
    };
    let plant = Plant::of_rig(&rig).without_commands(&[0]);
    plant.to_external(&Plant::start_of_rig(&rig, &paper.start())).expect("external")
}

fn pulses(duty: f64) -> RuntimeCommand {
    RuntimeCommand::Pulses { frequency: 25.0, duty, pulse: Request::Fill, rest: Request::Exhaust }
}

/// The numbers of a response, to the bit.
fn numbers(response: &Response) -> Vec<u64> {
    let Response { tension, per_length, per_velocity, per_pressure, .. } = *response;
    let Response { pressure_rate, mass_flow, temperature, volume, .. } = *response;
    bits(&[tension, per_length, per_velocity, per_pressure, pressure_rate, mass_flow, temperature, volume])
}

/// Where the ends of a row go: on to a random place, or not at all.
fn goals(from: &[f64], row: usize, count: usize, reach: f64) -> Vec<f64> {
    let goal = |(k, distance): (usize, &f64)| match spread(7 * count + 31 * row + k, 3) {
        rests if rests < 0.15 => *distance,
        _ => distance + between(11 * count + 17 * row + k, 4, -reach, reach),
    };
    from.iter().enumerate().map(goal).collect()
}

/// Moves a batch of every width and a scalar instance of each row, which have to agree in states, answers and faults.
fn agree(
    made: &[PlantSteps],
    (reach, longest): (f64, f64),
    steps: usize,
    command: impl Fn(usize, usize) -> Option<RuntimeCommand> + Sync,
) {
    let mut scalar = made.to_vec();
    let mut faults: Vec<Option<Error>> = vec![None; made.len()];
    let widths = Width::available().into_iter();
    let mut batches: Vec<PlantBatch> = widths
        .map(|width| PlantBatch::with_lanes(made.to_vec(), width, Precision::Double).expect("rows at one time"))
        .collect();
    batches.iter_mut().for_each(|batch| batch.limit_step(longest).expect("a limit"));
    scalar.iter_mut().for_each(|row| row.limit_step(longest).expect("a limit"));
    let places: Vec<Vec<usize>> = made
        .iter()
        .map(|row| {
            let plant = row.plant();
            let hosts = plant.mechanisms().iter().zip(&plant.indices().mechanisms);
            let hosts = hosts.filter(|(its, _)| matches!(its, mckibben::mechanism::Mechanism::External { .. }));
            hosts.flat_map(|(_, here)| (0..here.coordinates).map(|k| here.position(k))).collect()
        })
        .collect();
    let mut at: Vec<Vec<f64>> = scalar
        .iter()
        .zip(&places)
        .map(|(row, places)| places.iter().map(|place| row.state()[*place]).collect())
        .collect();
    for count in 0..steps {
        let until = batches[0].time() + STEP;
        for (row, at) in at.iter_mut().enumerate() {
            *at = goals(at, row, count, reach);
        }
        let distances = at.concat();
        // Responses are evaluated at rates that differ from those of the ends.
        let rates: Vec<f64> = (0..distances.len()).map(|k| between(count * 13 + k, 7, -0.05, 0.05)).collect();
        for (index, row) in scalar.iter_mut().enumerate() {
            if faults[index].is_some() {
                continue;
            }
            if let Some(command) = command(index, count) {
                row.set(0, command).expect("a command");
            }
            faults[index] = row.move_to(until, &at[index]).err();
        }
        let mut first = 0;
        let mut answers: Vec<Vec<Response>> = Vec::new();
        for (row, at) in scalar.iter_mut().zip(&at) {
            let mut own = (0..row.plant().actuators().len()).map(|i| row.compute(i).expect("one")).collect::<Vec<_>>();
            if at.iter().all(|distance| *distance > 0.0) {
                row.compute_at(at, &rates[first..first + at.len()], &mut own).expect("answers");
            }
            first += at.len();
            answers.push(own);
        }
        for batch in &mut batches {
            let width = batch.width();
            batch.set_each(0, |row| command(row, count)).expect("commands");
            batch.move_to(until, &distances).expect("a move");
            batch.compute_at(&distances, &rates).expect("answers");
            for (index, (row, fault)) in scalar.iter().zip(&faults).enumerate() {
                match (batch.responses(index).map(<[Response]>::to_vec), fault) {
                    (Ok(found), None) => {
                        for (i, (ours, theirs)) in found.iter().zip(&answers[index]).enumerate() {
                            let same = numbers(ours) == numbers(theirs);
                            assert!(same, "{i} of row {index}, move {count}, {width:?}: {ours:?}, {theirs:?}");
                        }
                        let found = batch.row(index).expect("it goes on");
                        let same = bits(found.state()) == bits(row.state());
                        let [ours, theirs] = [found.state().to_vec(), row.state().to_vec()];
                        assert!(same, "row {index}, move {count}, {width:?}: {ours:?}, {theirs:?}");
                    }
                    // As text: what is no number equals nothing.
                    (Err(found), Some(fault)) => assert_eq!(format!("{found:?}"), format!("{fault:?}")),
                    (found, fault) => panic!("row {index}, move {count}, {width:?}: {found:?}, {fault:?}"),
                }
            }
        }
    }
}

/// Duty cycles that change now and then.
fn duty(row: usize, count: usize) -> Option<RuntimeCommand> {
    (count == 0 || (count + row).is_multiple_of(7)).then(|| pulses(spread(row + 5 * count, 6)))
}

/// Requests at every move.
fn request(row: usize, count: usize) -> Option<RuntimeCommand> {
    Some(if spread(row + 37 * count, 6) < 0.5 { Request::Fill } else { Request::Exhaust }.into())
}

/// With and without dry friction, within the lengths, beyond the longest, and below the shortest.
#[test]
fn muscles_that_a_host_moves_equal_scalar_instances() {
    for (coulomb, from, reach) in [(0.0, 3.4, 4e-5), (1e-4, 3.4, 4e-5), (1e-4, 3.7, 2e-4), (1e-4, 2.5, 4e-4)] {
        let paper = Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).friction(3.5, coulomb).from(from * INCH, 0.0);
        let (plant, start) = hosted(&paper, None);
        assert!(PlantBatch::covers(&plant), "it goes in lanes");
        for method in [Method::Stable, Method::Rk4] {
            let longest = if method == Method::Rk4 { 5e-5 } else { f64::INFINITY };
            agree(&rows(&plant, &start, method, 37).expect("rows"), (reach, longest), 150, duty);
        }
    }
}

/// What remembers more than its mode says: hysteresis, tendons, branches that creep; and moves that are divided.
#[test]
fn muscles_with_memory_that_a_host_moves_equal_scalar_instances() {
    let paper = Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).friction(3.5, 1e-4).from(3.4 * INCH, 0.0);
    let branches = Viscoelastic::new(&[100.0], &[0.1], &[0.05]).expect("a branch");
    let creeping = Paper { viscoelastic: Some(branches), ..paper.clone() };
    let tendon = SeriesTendon::new(2e4, 0.05).expect("a tendon");
    for (plant, start) in [hosted(&paper, Some(tendon)), hosted(&creeping, None)] {
        agree(&rows(&plant, &start, Method::Stable, 19).expect("rows"), (4e-5, 3e-4), 100, duty);
    }
}

/// What a step knows exactly is not found again where a valve is set and no time passes: the length of an end on a tendon without
/// viscous friction, and the pressure of isothermal air.
#[test]
fn muscles_whose_valves_are_set_before_a_move_equal_scalar_instances() {
    let paper = Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).friction(3.5, 1e-4).from(3.4 * INCH, 0.0);
    let tendon = SeriesTendon::new(2e4, 0.05).expect("a tendon");
    let isothermal = paper.clone().process(Process::Isothermal);
    let mut plants = vec![hosted(&isothermal, None), hosted(&isothermal, Some(tendon))];
    for coulomb in [0.0, 1e-4] {
        plants.push(hosted(&paper.clone().friction(0.0, coulomb), Some(tendon)));
        plants.push(hosted(&isothermal.clone().friction(0.0, coulomb), Some(tendon)));
    }
    for (plant, start) in plants {
        assert!(PlantBatch::covers(&plant), "it goes in lanes");
        for (longest, command) in [(f64::INFINITY, duty as fn(usize, usize) -> _), (3e-4, request)] {
            agree(&rows(&plant, &start, Method::Stable, 19).expect("rows"), (4e-5, longest), 100, command);
        }
    }
}

/// Two muscles on a bottle, and a further mass which no host moves.
#[test]
fn bottles_whose_ends_a_host_moves_equal_scalar_instances() {
    let (plant, start, _) = on_a_bottle();
    let command = |row: usize, count: usize| (count % 5 == row % 5).then_some(pulses(0.3));
    agree(&rows(&plant, &start, Method::Stable, 19).expect("rows"), (3e-5, f64::INFINITY), 150, command);
}

/// Whatever plants are made of, their actuators moved by a host, which sets a valve.
#[test]
fn random_plants_that_a_host_moves_equal_scalar_instances() {
    let count = std::cell::Cell::new(0);
    let result = runner(40).run(&drawn(), |drawn| {
        let (plant, start, _) = plant(&drawn);
        let Ok((plant, start)) = plant.and_then(|plant| plant.to_external(&start)) else { return Ok(()) };
        if let Ok(rows) = rows(&plant, &start, Method::Stable, 18) {
            agree(&rows, (5e-5, f64::INFINITY), 40, commands_of(&rows[0]));
            count.set(count.get() + 1);
        }
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    assert!(count.get() > 10, "{} plants", count.get());
}

/// A row that leaves the physics stops, others go on, and it lives again where it is begun again.
#[test]
fn a_row_with_an_unreachable_length_stops_and_the_others_go_on() {
    let (plant, start) = hosted(&Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).from(3.4 * INCH, 0.0), None);
    let made = rows(&plant, &start, Method::Stable, 20).expect("rows");
    let mut batch = PlantBatch::new(made.clone()).expect("a batch");
    let mut distances = vec![3.4 * INCH; 20];
    batch.move_to(STEP, &distances).expect("a move");
    distances[4] = f64::NAN;
    distances[7] = 1.0;
    batch.move_to(2.0 * STEP, &distances).expect("a move");
    assert!(
        matches!(batch.row(4), Err(Error::OutOfRange { .. })) && matches!(batch.row(7), Err(Error::Stopped { .. }))
    );
    assert!((0..20).filter(|row| batch.row(*row).is_ok()).count() == 18);
    let begun =
        PlantRun::new(&plant, &start, 1e-9).and_then(|run| run.begin_again(&start, batch.time())).expect("a run");
    batch.restart(7, begun.steps(Method::Stable)).expect("begun again");
    distances[7] = 3.4 * INCH;
    batch.move_to(3.0 * STEP, &distances).expect("a move");
    assert!(batch.row(7).is_ok() && batch.row(4).is_err());
}

#[test]
fn moves_that_do_not_fit_are_refused_and_change_nothing() {
    let (plant, start) = hosted(&Paper::pwm(25.0, 0.5).gauge(30.0 * PSI).from(3.4 * INCH, 0.0), None);
    let mut batch = PlantBatch::new(rows(&plant, &start, Method::Stable, 3).expect("rows")).expect("a batch");
    let there = [3.4 * INCH; 3];
    assert!(matches!(batch.move_to(STEP, &there[..2]), Err(Error::Table { entry: 3, .. })));
    assert!(matches!(batch.move_to(0.0, &there), Err(Error::Misuse { .. })));
    assert!(matches!(batch.move_to(f64::NAN, &there), Err(Error::OutOfRange { .. })));
    assert!(matches!(batch.compute_at(&there, &[0.0; 2]), Err(Error::Table { .. })));
    assert!(matches!(batch.compute_at(&[0.0; 3], &[0.0; 3]), Err(Error::OutOfRange { .. })));
    assert!(batch.limit_step(0.0).is_err());
    batch.limit_step(1e-12).expect("a limit");
    assert!(matches!(batch.move_to(1.0, &there), Err(Error::Misuse { .. })), "too many parts");
    batch.limit_step(f64::INFINITY).expect("no limit");
    batch.set(1, 0, pulses(0.5)).expect("a duty cycle");
    assert!((batch.parts_until(0.1) - 6.0).abs() < 1e-9);
    assert!(matches!(batch.set_each(0, |row| (row > 0).then(|| pulses(1.5))), Err((1, Error::OutOfRange { .. }))));
    assert_eq!(batch.time(), 0.0);
    assert_eq!(batch.responses(0).expect("a row").len(), 0, "none has been computed");
}
