//! The only threads that the library starts are those of a batch, and they end with it. In a program apart: the threads are counted.
#![cfg(target_os = "linux")]

#[path = "interface/common.rs"]
mod common;

use common::{muscle, step};
use mckibben_c::many::*;
use mckibben_c::status::Status;
use std::ptr::null_mut;

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
    let plant = muscle();
    let (before, plants, distances) = (threads(), [plant.0.cast_const(); COUNT], [0.09; COUNT]);
    for (given, started) in [(0, 0), (1, 0), (3, 3)] {
        let mut batch = null_mut();
        let made = unsafe { mckibben_batch_from_plants(plants.as_ptr(), COUNT, given, &raw mut batch) };
        assert_eq!(made, Status::Ok);
        assert!(are_left(before + started), "{given} threads: {} after {before}", threads());
        let step = step(1e-3, &distances);
        assert_eq!(unsafe { mckibben_batch_step(batch, &raw const step, null_mut()) }, Status::Ok);
        assert!(are_left(before + started), "{given} threads: {} after {before}", threads());
        unsafe { mckibben_batch_free(batch) };
        assert!(are_left(before), "{given} threads: {} after {before}", threads());
    }
}
