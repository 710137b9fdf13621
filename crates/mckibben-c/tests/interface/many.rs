//! Many plants in one call.

use super::common::{Owned, last_error, muscle};
use mckibben_c::many::{Step, mckibben_step_all};
use mckibben_c::plant::{Plant, mckibben_output_count, mckibben_state_size};
use mckibben_c::status::Status;
use mckibben_c::step::*;
use std::ptr::{null, null_mut};

const COUNT: usize = 7;

fn handles(plants: &[Owned]) -> Vec<*mut Plant> {
    plants.iter().map(|plant| plant.0).collect()
}

fn state(plant: &Owned) -> Vec<u64> {
    let mut numbers = vec![0.0; unsafe { mckibben_state_size(plant.0) }];
    assert_eq!(unsafe { mckibben_save(plant.0, numbers.as_mut_ptr(), numbers.len()) }, Status::Ok);
    numbers.into_iter().map(f64::to_bits).collect()
}

/// Steps one after the other, each by its own calls.
fn alone(steps: u32) -> Vec<Vec<u64>> {
    let plants: Vec<Owned> = (0..COUNT).map(|_| muscle()).collect();
    for (i, plant) in plants.iter().enumerate() {
        for k in 1..=steps {
            let distance = 0.09 - 1e-4 * i as f64;
            unsafe {
                assert_eq!(mckibben_command(plant.0, 0, 0.1 * i as f64), Status::Ok);
                assert_eq!(mckibben_advance(plant.0, f64::from(k) * 1e-3, &raw const distance, 1), Status::Ok);
            }
        }
    }
    plants.iter().map(state).collect()
}

#[test]
fn each_plant_is_bit_identical_to_a_scalar_instance_on_any_number_of_threads() {
    let expected = alone(50);
    for threads in [0, 1, 2, 3, 100] {
        let plants: Vec<Owned> = (0..COUNT).map(|_| muscle()).collect();
        let commands: Vec<f64> = (0..COUNT).map(|i| 0.1 * i as f64).collect();
        let distances: Vec<f64> = (0..COUNT).map(|i| 0.09 - 1e-4 * i as f64).collect();
        let output_count = unsafe { mckibben_output_count(plants[0].0) };
        let (mut outputs, mut statuses) = (vec![0.0; COUNT * output_count], [Status::Defect; COUNT]);
        let mut responses: Vec<Response> = vec![unsafe { std::mem::zeroed() }; COUNT];
        for k in 1..=50 {
            let step = Step {
                until: f64::from(k) * 1e-3,
                commands: commands.as_ptr(),
                command_count: 1,
                distances: distances.as_ptr(),
                distance_count: 1,
                responses: responses.as_mut_ptr(),
                response_count: 1,
                outputs: outputs.as_mut_ptr(),
                output_count,
                threads,
            };
            let handles = handles(&plants);
            let status = unsafe { mckibben_step_all(handles.as_ptr(), COUNT, &raw const step, statuses.as_mut_ptr()) };
            assert_eq!(status, Status::Ok, "{}", last_error());
            assert_eq!(statuses, [Status::Ok; COUNT]);
        }
        assert_eq!(plants.iter().map(state).collect::<Vec<_>>(), expected, "{threads} threads");
        for (i, plant) in plants.iter().enumerate() {
            let (mut own, mut response) = (vec![0.0; output_count], [responses[0]]);
            unsafe {
                assert_eq!(mckibben_outputs(plant.0, own.as_mut_ptr(), output_count), Status::Ok);
                assert_eq!(mckibben_compute(plant.0, null(), null(), 0, response.as_mut_ptr(), 1), Status::Ok);
            }
            assert_eq!(own, outputs[i * output_count..(i + 1) * output_count]);
            assert_eq!(response[0], responses[i]);
        }
    }
}

/// One that fails says so, and what it does not reach is no number; the others go on.
#[test]
fn a_plant_that_fails_leaves_the_others() {
    let plants: Vec<Owned> = (0..3).map(|_| muscle()).collect();
    let distances = [0.09, 0.5, 0.09];
    let mut responses: Vec<Response> = vec![unsafe { std::mem::zeroed() }; 4];
    let mut statuses = [Status::Defect; 4];
    let step = Step {
        until: 1e-3,
        commands: null(),
        command_count: 0,
        distances: distances.as_ptr(),
        distance_count: 1,
        responses: responses.as_mut_ptr(),
        response_count: 1,
        outputs: null_mut(),
        output_count: 0,
        threads: 2,
    };
    let handles = handles(&plants);
    let status = unsafe { mckibben_step_all(handles.as_ptr(), 3, &raw const step, statuses.as_mut_ptr()) };
    assert_eq!(statuses, [Status::Ok, status, Status::Ok, Status::Defect]);
    assert!(matches!(status, Status::Input | Status::Stopped) && last_error().starts_with("plant 1: "));
    assert!(responses[1].tension.is_nan() && responses[0].tension > 0.0 && responses[0] == responses[2]);
    let times = plants.iter().map(|plant| {
        let mut time = f64::NAN;
        assert_eq!(unsafe { mckibben_time(plant.0, &raw mut time) }, Status::Ok);
        time
    });
    assert_eq!(times.collect::<Vec<_>>(), [1e-3, 0.0, 1e-3]);
}

/// One plant twice, no plant, and arrays of the wrong size.
#[test]
fn wrong_arrays_are_refused() {
    let plant = muscle();
    let handles = [plant.0, plant.0, null_mut()];
    let numbers = [0.09; 6];
    let mut statuses = [Status::Defect; 3];
    let step = Step {
        until: 1e-3,
        commands: null(),
        command_count: 0,
        distances: numbers.as_ptr(),
        distance_count: 1,
        responses: null_mut(),
        response_count: 0,
        outputs: null_mut(),
        output_count: 0,
        threads: 0,
    };
    let mut all = |plants: *const *mut Plant, count, step: *const Step| unsafe {
        mckibben_step_all(plants, count, step, statuses.as_mut_ptr())
    };
    // A second step to the same time is none.
    assert_eq!(all(handles.as_ptr(), 3, &raw const step), Status::Input, "{}", last_error());
    assert_eq!(all(null(), 1, &raw const step), Status::Pointer);
    assert_eq!(all(handles.as_ptr(), 1, null()), Status::Pointer);
    assert_eq!(all(handles.as_ptr(), usize::MAX, &raw const step), Status::Count);
    assert_eq!(all(null(), 0, &raw const step), Status::Ok);
    for wrong in [
        Step { distance_count: 2, ..step },
        Step { distance_count: usize::MAX, ..step },
        Step { commands: numbers.as_ptr(), command_count: 2, ..step },
        Step { distances: null(), distance_count: 0, ..step },
    ] {
        assert_eq!(all(handles.as_ptr(), 3, &raw const wrong), Status::Count, "{}", last_error());
    }
    let later = Step { until: 2e-3, ..step };
    assert_eq!(all(handles.as_ptr(), 1, &raw const later), Status::Ok, "{}", last_error());
    assert_eq!(statuses[2], Status::Pointer);
}
