//! The only threads that the library starts are those of a batch, and they end with it. In a program apart: the threads are counted.
#![cfg(target_os = "linux")]

use mckibben_c::many::*;
use mckibben_c::plant::*;
use mckibben_c::status::Status;
use std::ffi::CString;
use std::ptr::{null, null_mut};

const SCENARIO: &str = "
[supply]
gauge_pressure = '100 psi'
[valve]
preset = 'matrix-eight-channel'
[command]
kind = 'pwm'
frequency = '25 Hz'
duty = 0.5
[load]
kind = 'isometric'
[initial]
length = '90 mm'
[run]
duration = '1 s'
";

/// So many plants are divided among the threads that there are.
const COUNT: usize = 1000;

fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").expect("the threads of this program").count()
}

/// Whether so many threads are left; one that has been joined may be listed for a moment.
fn are_left(count: usize) -> bool {
    (0..100).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(10));
        threads() == count
    })
}

#[test]
fn threads_end_with_their_batch() {
    let (text, mut plant) = (CString::new(SCENARIO).expect("text"), null_mut());
    let read = unsafe { mckibben_plant_from_text(text.as_ptr(), null(), null(), &raw mut plant) };
    assert_eq!(read, Status::Ok);
    let (before, plants, distances) = (threads(), [plant.cast_const(); COUNT], [0.09; COUNT]);
    for (given, started) in [(0, 0), (1, 0), (3, 3)] {
        let mut batch = null_mut();
        let made = unsafe { mckibben_batch_from_plants(plants.as_ptr(), COUNT, given, &raw mut batch) };
        assert_eq!(made, Status::Ok);
        assert!(are_left(before + started), "{given} threads: {} after {before}", threads());
        let step = Step {
            until: 1e-3,
            commands: null(),
            command_count: 0,
            distances: distances.as_ptr(),
            distance_count: 1,
            responses: null_mut(),
            response_count: 0,
            outputs: null_mut(),
            output_count: 0,
        };
        assert_eq!(unsafe { mckibben_batch_step(batch, &raw const step, null_mut()) }, Status::Ok);
        assert!(are_left(before + started), "{given} threads: {} after {before}", threads());
        unsafe { mckibben_batch_free(batch) };
        assert!(are_left(before), "{given} threads: {} after {before}", threads());
    }
    unsafe { mckibben_plant_free(plant) };
}
