//! Many plants in one call.

use super::common::{MUSCLE, Owned, last_error, muscle, options, read, step};
use mckibben_c::many::*;
use mckibben_c::plant::{Motion, Options, Plant, mckibben_output_count, mckibben_state_size};
use mckibben_c::status::Status;
use mckibben_c::step::*;
use std::ptr::{null, null_mut};

/// One block of vector lanes, and some more.
const COUNT: usize = 19;

/// A batch that is freed at the end of its scope.
struct Together(*mut Batch);

impl Drop for Together {
    fn drop(&mut self) {
        unsafe { mckibben_batch_free(self.0) };
    }
}

fn batch(plants: &[*const Plant], threads: usize) -> Together {
    let mut batch = null_mut();
    let made = unsafe { mckibben_batch_from_plants(plants.as_ptr(), plants.len(), threads, &raw mut batch) };
    assert_eq!(made, Status::Ok, "{}", last_error());
    assert_eq!(unsafe { mckibben_batch_count(batch) }, plants.len());
    Together(batch)
}

fn state(plant: &Owned) -> Vec<u64> {
    let mut numbers = vec![0.0; unsafe { mckibben_state_size(plant.0) }];
    assert_eq!(unsafe { mckibben_save(plant.0, numbers.as_mut_ptr(), numbers.len()) }, Status::Ok);
    numbers.into_iter().map(f64::to_bits).collect()
}

fn state_in(batch: &Together, index: usize) -> Vec<u64> {
    let mut plant = null_mut();
    assert_eq!(unsafe { mckibben_batch_plant(batch.0, index, &raw mut plant) }, Status::Ok, "{}", last_error());
    state(&Owned(plant))
}

#[test]
fn each_plant_is_bit_identical_to_a_scalar_instance_on_any_number_of_threads() {
    let plants: Vec<Owned> = (0..COUNT).map(|_| muscle()).collect();
    let handles: Vec<*const Plant> = plants.iter().map(|plant| plant.0.cast_const()).collect();
    let commands: Vec<f64> = (0..COUNT).map(|i| i as f64 / COUNT as f64).collect();
    let distances: Vec<f64> = (0..COUNT).map(|i| 0.09 - 1e-4 * i as f64).collect();
    let batches: Vec<Together> = [0, 1, 2, 3, 100].into_iter().map(|threads| batch(&handles, threads)).collect();
    // The plants themselves stay, and go on alone.
    for (i, plant) in plants.iter().enumerate() {
        for k in 1..=50 {
            unsafe {
                assert_eq!(mckibben_command(plant.0, 0, commands[i]), Status::Ok);
                assert_eq!(mckibben_advance(plant.0, f64::from(k) * 1e-3, &raw const distances[i], 1), Status::Ok);
            }
        }
    }
    let output_count = unsafe { mckibben_output_count(plants[0].0) };
    for batch in &batches {
        let (mut outputs, mut statuses) = (vec![0.0; COUNT * output_count], [Status::Defect; COUNT]);
        let mut responses: Vec<Response> = vec![unsafe { std::mem::zeroed() }; COUNT];
        for k in 1..=50 {
            let step = Step {
                commands: commands.as_ptr(),
                command_count: 1,
                responses: responses.as_mut_ptr(),
                response_count: 1,
                outputs: outputs.as_mut_ptr(),
                output_count,
                ..step(f64::from(k) * 1e-3, &distances)
            };
            let status = unsafe { mckibben_batch_step(batch.0, &raw const step, statuses.as_mut_ptr()) };
            assert_eq!(status, Status::Ok, "{}", last_error());
            assert_eq!(statuses, [Status::Ok; COUNT]);
        }
        for (i, plant) in plants.iter().enumerate() {
            let (mut own, mut response) = (vec![0.0; output_count], [responses[0]]);
            unsafe {
                assert_eq!(mckibben_outputs(plant.0, own.as_mut_ptr(), output_count), Status::Ok);
                assert_eq!(mckibben_compute(plant.0, null(), null(), 0, response.as_mut_ptr(), 1), Status::Ok);
            }
            assert_eq!(own, outputs[i * output_count..(i + 1) * output_count]);
            assert_eq!(response[0], responses[i]);
            assert_eq!(state_in(batch, i), state(plant));
        }
    }
}

/// One that fails says so, and what it does not reach is no number; the others go on, and it begins again.
#[test]
fn a_plant_that_fails_leaves_the_others() {
    let plant = muscle();
    let together = batch(&[plant.0.cast_const(); 3], 2);
    let mut distances = [0.09, 0.5, 0.09];
    let mut responses: Vec<Response> = vec![unsafe { std::mem::zeroed() }; 4];
    let mut statuses = [Status::Defect; 4];
    let into = responses.as_mut_ptr();
    let mut go = |until: f64, distances: &[f64]| unsafe {
        let step = Step { responses: into, response_count: 1, ..step(until, distances) };
        let status = mckibben_batch_step(together.0, &raw const step, statuses.as_mut_ptr());
        (status, statuses)
    };
    let (status, statuses) = go(1e-3, &distances);
    assert_eq!((status, statuses), (Status::Stopped, [Status::Ok, status, Status::Ok, Status::Defect]));
    assert!(last_error().starts_with("error: plant 1"), "{}", last_error());
    assert!(responses[1].tension.is_nan() && responses[0].tension > 0.0 && responses[0] == responses[2]);
    let mut none = null_mut();
    assert_ne!(unsafe { mckibben_batch_plant(together.0, 1, &raw mut none) }, Status::Ok);
    assert!(none.is_null());
    // It stays so until it begins again.
    distances[1] = 0.09;
    assert_eq!(go(2e-3, &distances).0, Status::Stopped);
    let begun = unsafe { mckibben_batch_begin_at(together.0, 1, &raw const distances[1], [0.0].as_ptr(), 1) };
    assert_eq!(begun, Status::Ok, "{}", last_error());
    assert_eq!(go(3e-3, &distances).0, Status::Ok, "{}", last_error());
    assert!(responses[1].tension > 0.0);
}

/// No plant, plants of other kinds, and arrays of the wrong size; no plant moves then.
#[test]
fn wrong_arguments_are_refused() {
    let (plant, whole) = (muscle(), read(MUSCLE, &options(Motion::Scenario)));
    let make = |plants: *const *const Plant, count| unsafe {
        let mut batch = null_mut();
        let status = mckibben_batch_from_plants(plants, count, 0, &raw mut batch);
        assert!(batch.is_null());
        status
    };
    let [one, other, none]: [*const Plant; 3] = [plant.0, whole.0, null()];
    assert_eq!(make([one, other].as_ptr(), 2), Status::Input, "{}", last_error());
    assert_eq!(make([one, none].as_ptr(), 2), Status::Pointer);
    assert!(last_error().contains("`plants[1]` is NULL"), "{}", last_error());
    assert_eq!(make(null(), 2), Status::Pointer);
    assert_eq!(make([one].as_ptr(), usize::MAX), Status::Count);
    assert_eq!(make(null(), 0), Status::Input);
    assert_eq!(unsafe { mckibben_batch_count(null()) }, 0);
    let numbers = [0.09; 6];
    let (together, its, mut statuses) = (batch(&[one; 3], 0), step(1e-3, &numbers), [Status::Defect; 3]);
    let mut go = |batch, step: *const Step| unsafe { mckibben_batch_step(batch, step, statuses.as_mut_ptr()) };
    assert_eq!(go(null_mut(), &raw const its), Status::Pointer);
    assert_eq!(go(together.0, null()), Status::Pointer);
    for (wrong, status) in [
        (Step { distance_count: 2, ..its }, Status::Count),
        (Step { distance_count: usize::MAX, ..its }, Status::Count),
        (Step { commands: numbers.as_ptr(), command_count: 2, ..its }, Status::Count),
        (Step { distances: null(), distance_count: 0, ..its }, Status::Count),
        (Step { distances: null(), ..its }, Status::Pointer),
        (Step { until: 0.0, ..its }, Status::Input),
        (Step { until: f64::NAN, ..its }, Status::Input),
        (step(1e-3, &[0.09, f64::NAN, 0.09]), Status::Input),
    ] {
        assert_eq!(go(together.0, &raw const wrong), status, "{}", last_error());
    }
    assert_eq!(state_in(&together, 2), state(&plant));
    let mut copy = null_mut();
    for wrong in [
        unsafe { mckibben_batch_begin_at(together.0, 3, numbers.as_ptr(), numbers.as_ptr(), 1) },
        unsafe { mckibben_batch_begin_at(together.0, 0, numbers.as_ptr(), null(), 1) },
        unsafe { mckibben_batch_begin_at(together.0, 0, numbers.as_ptr(), numbers.as_ptr(), 2) },
        unsafe { mckibben_batch_plant(together.0, 3, &raw mut copy) },
        unsafe { mckibben_batch_plant(together.0, 0, null_mut()) },
    ] {
        assert_ne!(wrong, Status::Ok);
    }
    assert_eq!(go(together.0, &raw const its), Status::Ok, "{}", last_error());
    let scenario = batch(&[other; 3], 0);
    let by_itself = Step { distances: null(), distance_count: 0, ..its };
    assert_eq!(go(scenario.0, &raw const by_itself), Status::Ok, "{}", last_error());
    assert_eq!(statuses, [Status::Ok; 3]);
}

/// A time in the past is refused with either motion, and no plant moves.
#[test]
fn a_step_into_the_past_is_refused() {
    for motion in [Motion::Host, Motion::Scenario] {
        let plant = read(MUSCLE, &options(motion));
        let (together, numbers) = (batch(&[plant.0.cast_const(); 3], 0), [0.09; 3]);
        let go = |until: f64| unsafe {
            let step = match motion {
                Motion::Host => step(until, &numbers),
                Motion::Scenario => Step { distances: null(), distance_count: 0, ..step(until, &numbers) },
            };
            mckibben_batch_step(together.0, &raw const step, null_mut())
        };
        assert_eq!(go(2e-3), Status::Ok, "{}", last_error());
        let before = state_in(&together, 1);
        assert_eq!(go(1e-3), Status::Input);
        assert!(last_error().contains("0.001 s") && last_error().contains("0.002 s"), "{}", last_error());
        assert_eq!(state_in(&together, 1), before);
        assert_eq!(go(3e-3), Status::Ok, "{}", last_error());
        assert_ne!(state_in(&together, 1), before);
    }
}

/// Plants go together that differ in numbers; what else must agree.
#[test]
fn plants_of_a_batch_agree_in_what_the_header_says() {
    let slow = Options { pulse_frequency: 20.0, ..options(Motion::Host) };
    let short = |motion| Options { max_step: 4e-4, ..options(motion) };
    let requests = |motion| Options { command_mode: c"request".as_ptr(), ..options(motion) };
    let (host, scenario) = (options(Motion::Host), options(Motion::Scenario));
    let step = MUSCLE.replace("0.5 ms", "0.4 ms");
    let (mass, pulses) = (MUSCLE.replace("5 lb", "6 lb"), MUSCLE.replace("25 Hz", "20 Hz"));
    let late = |time: &str| MUSCLE.replace("[command]", &format!("dead_time = \"{time}\"\n[command]"));
    for (one, other, options, goes) in [
        (MUSCLE, &mass, [host, host], true),
        (MUSCLE, &mass, [scenario, scenario], true),
        // The host's motion does not use the scenario's step.
        (MUSCLE, &step, [host, host], true),
        (MUSCLE, &step, [scenario, scenario], false),
        (MUSCLE, &step, [short(Motion::Scenario); 2], true),
        (MUSCLE, &MUSCLE.to_owned(), [host, short(Motion::Host)], false),
        (MUSCLE, &pulses, [host, host], false),
        (MUSCLE, &pulses, [slow, slow], true),
        (MUSCLE, &pulses, [requests(Motion::Host); 2], true),
        (MUSCLE, &late("2 ms"), [host, host], false),
        (&late("1 ms"), &late("2 ms"), [host, host], true),
    ] {
        let plants = [read(one, &options[0]), read(other, &options[1])];
        let (handles, mut made) = (plants.each_ref().map(|plant| plant.0.cast_const()), null_mut());
        let status = unsafe { mckibben_batch_from_plants(handles.as_ptr(), 2, 0, &raw mut made) };
        unsafe { mckibben_batch_free(made) };
        assert_eq!(status == Status::Ok, goes, "{options:?}: {}\n{other}", last_error());
    }
}

/// A plant that is copied out of a batch returns to where it began: the scenario's start, or where it began again in the batch.
#[test]
fn a_copy_out_of_a_batch_returns_to_where_its_plant_began() {
    let plant = muscle();
    let (together, rate, began) = (batch(&[plant.0.cast_const(); 2], 0), 0.0, 0.0895);
    let go = |until: f64| {
        let step = step(until, &[0.0898, 0.0898]);
        assert_eq!(unsafe { mckibben_batch_step(together.0, &raw const step, null_mut()) }, Status::Ok);
    };
    go(1e-3);
    let begun = unsafe { mckibben_batch_begin_at(together.0, 1, &raw const began, &raw const rate, 1) };
    assert_eq!(begun, Status::Ok, "{}", last_error());
    go(2e-3);
    for (index, due) in [(0, [0.0, 0.09]), (1, [1e-3, began])] {
        let (mut copy, mut time, mut distance) = (null_mut(), f64::NAN, f64::NAN);
        unsafe {
            assert_eq!(mckibben_batch_plant(together.0, index, &raw mut copy), Status::Ok, "{}", last_error());
            let copy = Owned(copy);
            assert_eq!(mckibben_reset(copy.0), Status::Ok);
            assert_eq!(mckibben_time(copy.0, &raw mut time), Status::Ok);
            assert_eq!(mckibben_distances(copy.0, &raw mut distance, 1), Status::Ok);
        }
        assert_eq!([time, distance], due, "plant {index}");
    }
}
