//! Many plants that a host steps together: each is the plant alone, to the bit.

use super::plant::{MUSCLE, document, host};
use mckibben::Response;
use mckibben_run::host::{HostBatch, HostOptions, HostPlant, Motion};
use mckibben_scenario::Document;

/// One block of vector lanes on any machine, and some more.
const COUNT: usize = 21;

/// Muscles on supplies of different pressures.
fn muscles() -> Vec<HostPlant> {
    let of = |row: usize| MUSCLE.replace("100 psi", &format!("{} psi", 80 + row));
    (0..COUNT).map(|row| host(&of(row), &HostOptions::default())).collect()
}

fn arms(count: usize, motion: Motion) -> Vec<HostPlant> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plant/arm.toml");
    let options = HostOptions { motion, command_mode: Some("request"), ..HostOptions::default() };
    vec![HostPlant::read(&Document::load(path).expect("an example"), &options).expect("an arm"); count]
}

/// Compares what is known of a plant of a batch with a plant that was stepped alone.
fn compare(batch: &mut HostBatch, row: usize, alone: &mut HostPlant) {
    let count = alone.actuators().len();
    let responses: Vec<Response> = (0..count).map(|i| alone.steps_mut().compute(i).expect("a response")).collect();
    assert_eq!(batch.responses(row).expect("responses"), responses, "plant {row}");
    let width = alone.outputs().len();
    let (mut outputs, mut all) = (vec![0.0; width], vec![0.0; width * batch.count()]);
    alone.read_outputs(&mut outputs).expect("outputs");
    batch.read_outputs(&mut all).expect("outputs");
    assert_eq!(all[width * row..width * (row + 1)], outputs, "plant {row}");
    let its = batch.plant(row).expect("a plant");
    assert_eq!((its.steps().time(), its.steps().state()), (alone.steps().time(), alone.steps().state()), "plant {row}");
}

#[test]
fn muscles_whose_ends_the_host_moves_are_those_alone() {
    let mut alone = muscles();
    let mut batch = HostBatch::new(muscles()).expect("a batch");
    assert_eq!((batch.count(), batch.distances().len(), batch.model().commands().len()), (COUNT, COUNT, 1));
    for k in 1..=120_u32 {
        let until = f64::from(k) * 1e-3;
        let duty: Vec<f64> = (0..COUNT).map(|row| ((k / 30) as usize * 7 + row) as f64 % 11.0 / 11.0).collect();
        let distances: Vec<f64> =
            (0..COUNT).map(|row| 0.09 - 2e-3 * (f64::from(k) * 0.05 + row as f64).sin().powi(2)).collect();
        batch.command(&duty).expect("duty cycles");
        batch.advance(until, &distances).expect("a step");
        batch.compute().expect("responses");
        for (row, alone) in alone.iter_mut().enumerate() {
            alone.command(0, duty[row]).expect("a duty cycle");
            alone.advance(until, &distances[row..=row]).expect("a step");
            if k % 40 == 7 {
                compare(&mut batch, row, alone);
            }
        }
    }
    // With the ends elsewhere.
    let (distances, rates) = (vec![0.088; COUNT], vec![-0.02; COUNT]);
    batch.compute_at(&distances, &rates).expect("responses");
    for (row, alone) in alone.iter_mut().enumerate() {
        let mut response = [Response::default()];
        alone.compute_at(&[0.088], &[-0.02], &mut response).expect("a response");
        assert_eq!(batch.responses(row).expect("a response"), response);
    }
}

#[test]
fn arms_that_their_scenario_moves_are_those_alone() {
    let mut alone = arms(5, Motion::Scenario);
    let mut batch = HostBatch::new(arms(5, Motion::Scenario)).expect("a batch");
    let inputs = batch.model().commands().len();
    for k in 1..=4_u32 {
        // Not a multiple of the scenario's own step.
        let until = f64::from(k) * 33.3e-3;
        let requests: Vec<f64> = (0..5 * inputs).map(|at| f64::from((at as u32 * 5 + k) % 3) - 1.0).collect();
        batch.command(&requests).expect("requests");
        batch.advance(until, &[]).expect("steps");
        batch.compute().expect("responses");
        for (row, (alone, requests)) in alone.iter_mut().zip(requests.chunks(inputs)).enumerate() {
            requests.iter().enumerate().for_each(|(input, its)| alone.command(input, *its).expect("a request"));
            alone.advance(until, &[]).expect("steps");
            compare(&mut batch, row, alone);
        }
    }
}

/// The one that stops says why and touches no other; it begins again while the others go on.
#[test]
fn a_plant_that_stops_leaves_the_others() {
    let mut batch = HostBatch::new(muscles()).expect("a batch");
    let mut distances = vec![0.09; COUNT];
    distances[4] = 0.5;
    batch.advance(1e-3, &distances).expect("a step of the others");
    assert!(batch.failure(4).expect("a failure").to_string().contains("plant 4"));
    assert_eq!(batch.first_failure().map(|its| its.to_string()), batch.failure(4).map(|its| its.to_string()));
    assert!(batch.responses(4).is_err() && batch.plant(4).is_err());
    let states = vec![0.0; COUNT * batch.state_size()];
    assert!(batch.save(&mut states.clone()).is_err(), "one has no state");
    let mut alone = muscles();
    alone[5].advance(1e-3, &[0.09]).expect("a step");
    assert_eq!(batch.plant(5).expect("a plant").steps().state(), alone[5].steps().state());
    batch.begin_row(4, &[0.088], &[0.0]).expect("a start");
    distances[4] = 0.088;
    batch.advance(2e-3, &distances).expect("a step");
    let again = batch.plant(4).expect("a plant");
    assert!(batch.first_failure().is_none() && again.steps().time() == 2e-3);
    // Its air has had 1 ms, as that of one that has just begun.
    alone[4].begin_at(&[0.088], &[0.0]).expect("a start");
    alone[4].advance(1e-3, &[0.088]).expect("a step");
    let relative = |one: &[f64], other: &[f64]| {
        one.iter().zip(other).map(|(one, other)| (one - other).abs() / other.abs().max(1e-9)).fold(0.0, f64::max)
    };
    assert!(relative(again.steps().state(), alone[4].steps().state()) < 1e-9);
}

/// A plant that is taken out of a batch divides its moves as those of the batch, also after these have begun again.
#[test]
fn a_plant_of_a_batch_keeps_the_longest_part_of_a_move() {
    let options = HostOptions { max_step: Some(0.5e-3), ..HostOptions::default() };
    let mut alone = HostPlant::read(&document(MUSCLE), &options).expect("a plant");
    let mut batch = HostBatch::new(vec![alone.clone(); 5]).expect("a batch");
    batch.begin_at(&[0.09; 5], &[0.0; 5]).expect("a start");
    alone.begin_at(&[0.09], &[0.0]).expect("a start");
    batch.begin_row(2, &[0.09], &[0.0]).expect("a start");
    for row in [0, 2] {
        let mut out = batch.plant(row).expect("a plant");
        let mut alone = alone.clone();
        for plant in [&mut out, &mut alone] {
            plant.advance(8e-3, &[0.085]).expect("a step");
        }
        assert_eq!(out.steps().state(), alone.steps().state(), "plant {row}");
    }
}

#[test]
fn states_go_on_where_they_were_saved() {
    let mut batch = HostBatch::new(arms(5, Motion::Host)).expect("a batch");
    let distances = batch.distances().to_vec();
    let (requests, mut states) = (vec![1.0; 5 * batch.model().commands().len()], vec![0.0; 5 * batch.state_size()]);
    let on = |batch: &mut HostBatch, until: f64| {
        batch.command(&requests).expect("requests");
        batch.advance(until, &distances).expect("a step");
    };
    on(&mut batch, 0.05);
    batch.save(&mut states).expect("states");
    on(&mut batch, 0.1);
    let mut there = states.clone();
    batch.save(&mut there).expect("states");
    batch.restore(&states).expect("states");
    assert_eq!(batch.time(), 0.05);
    on(&mut batch, 0.1);
    batch.save(&mut states).expect("states");
    assert_eq!(states, there);
    let rates = vec![0.0; distances.len()];
    batch.begin_at(&distances, &rates).expect("a start");
    assert_eq!((batch.time(), batch.distances()), (0.0, &distances[..]));
}

/// What cannot be is said with its place, and changes nothing.
/// States that are refused leave the batch where it was, also where each of them is a state of its plant.
#[test]
fn states_of_different_times_change_nothing() {
    let mut batch = HostBatch::new(muscles()).expect("a batch");
    let size = batch.state_size();
    let mut states = vec![0.0; COUNT * size];
    batch.save(&mut states).expect("states");
    batch.advance(1e-3, &[0.088; COUNT]).expect("a step");
    let mut later = vec![0.0; COUNT * size];
    batch.save(&mut later).expect("states");
    batch.advance(2e-3, &[0.087; COUNT]).expect("a step");
    states[size..].copy_from_slice(&later[size..]);
    let refused = batch.restore(&states).expect_err("two times").to_string();
    assert!(refused.contains("different times"), "{refused}");
    assert_eq!((batch.time(), batch.distances()), (2e-3, &[0.087; COUNT][..]));
}

#[test]
fn what_cannot_be_is_refused() {
    let (mut batch, distances) = (HostBatch::new(muscles()).expect("a batch"), vec![0.09; COUNT]);
    let (size, mut wrong) = (batch.state_size(), distances.clone());
    wrong[3] = f64::NAN;
    let (mut states, mut duty) = (vec![0.0; COUNT * size], vec![0.5; COUNT]);
    batch.save(&mut states).expect("states");
    duty[3] = 1.5;
    for (refused, place) in [
        (batch.command(&duty), "plant 3"),
        (batch.advance(1e-3, &wrong), "plant 3"),
        (batch.compute_at(&wrong, &distances), "plant 3"),
        (batch.begin_at(&wrong, &distances), "plant 3"),
        (batch.command(&[0.5]), "21"),
        (batch.advance(1e-3, &[]), "21"),
        (batch.advance(0.0, &distances), "time"),
        (batch.advance(f64::NAN, &distances), ""),
        (batch.compute_at(&distances, &[]), "21"),
        (batch.begin_row(99, &[0.09], &[0.0]), "99"),
        (batch.begin_row(0, &[0.5], &[0.0]), "plant 0"),
        (batch.begin_row(0, &[], &[]), "0"),
        (batch.read_outputs(&mut []), "outputs"),
        (batch.save(&mut []), "states"),
        (batch.restore(&vec![0.5; COUNT * size]), "plant 0"),
    ] {
        let said = refused.expect_err("refused").to_string();
        assert!(said.contains(place), "{said}");
    }
    let mut after = states.clone();
    batch.save(&mut after).expect("states");
    assert_eq!(after, states);
    assert!(batch.failure(0).is_none() && batch.failure(99).is_some());
    assert!(HostBatch::new(Vec::new()).is_err());
    let mixed = [muscles(), arms(1, Motion::Host)].concat();
    assert!(HostBatch::new(mixed).expect_err("of another kind").to_string().contains("plant 21"));
    let host = |text: &str, options: &HostOptions<'_>| HostPlant::read(&document(text), options).expect("a plant");
    let (of_host, faster) = (HostOptions::default(), MUSCLE.replace("25 Hz", "50 Hz"));
    let pair = HostBatch::new([host(MUSCLE, &of_host), host(&faster, &of_host)]);
    let said = pair.expect_err("other pulses").to_string();
    assert!(said.contains("25.0 Hz") && said.contains("50.0 Hz") && said.contains("pulse_frequency"), "{said}");
    let whole = HostOptions { motion: Motion::Scenario, ..HostOptions::default() };
    let shorter = MUSCLE.replace("0.5 ms", "0.25 ms");
    let said = HostBatch::new([host(MUSCLE, &whole), host(&shorter, &whole)]).expect_err("other steps").to_string();
    assert!(said.contains("0.0005 s") && said.contains("run.step"), "{said}");
    let mut whole = HostBatch::new(vec![HostPlant::read(&document(MUSCLE), &whole).expect("a plant")]).expect("one");
    assert!(whole.advance(1e-3, &[0.09]).is_err() && whole.begin_at(&[0.09], &[0.0]).is_err());
    assert!(whole.advance(f64::INFINITY, &[]).is_err());
}
