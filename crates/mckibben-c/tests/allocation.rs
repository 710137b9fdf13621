//! Commands, responses, outputs and states of a plant allocate nothing once each has happened, nor do steps whose ends the host moves.
//!
//! What happens for the first time may allocate, so the first hundred steps are not counted; in them the command changes and a state is
//! restored. Where the scenario moves, allocations of steps are printed: those in which friction sticks or slides otherwise have some, and
//! so have all calls that find an actuator at rest under friction, which the mass here never is.

use mckibben_c::plant::*;
use mckibben_c::status::Status;
use mckibben_c::step::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::CString;
use std::ptr::{null, null_mut};

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: the system's allocator does the work.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) };
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

const RUN: &str = "
[supply]
gauge_pressure = '100 psi'
[valve]
preset = 'matrix-eight-channel'
[command]
kind = 'pwm'
frequency = '25 Hz'
duty = 0.5
[load]
kind = 'hanging-mass'
mass = '5 lb'
[initial]
length = '90 mm'
gauge_pressure = '40 psi'
[run]
duration = '1 s'
engine = 'fixed-step'
step = '0.5 ms'
";

/// Steps after which memory has its size.
const FIRST: u32 = 100;

/// Allocations of a thousand steps with either motion: of the steps themselves, and of all other calls.
fn allocations(motion: Motion) -> [u64; 2] {
    let (text, mut plant) = (CString::new(RUN).expect("text"), null_mut());
    let options = Options { motion: motion as i32, command_mode: null(), pulse_frequency: 0.0, max_step: 0.0 };
    let read = unsafe { mckibben_plant_from_text(text.as_ptr(), null(), &raw const options, &raw mut plant) };
    assert_eq!(read, Status::Ok);
    let (count, size) = unsafe { (mckibben_distance_count(plant), mckibben_state_size(plant)) };
    let mut outputs = vec![0.0; unsafe { mckibben_output_count(plant) }];
    let (mut state, mut response) = (vec![0.0; size], [unsafe { std::mem::zeroed::<Response>() }]);
    let mut counted = [0; 2];
    for k in 1..=1000 + FIRST {
        let (until, distance, rate) = (f64::from(k) * 1e-3, 0.09 - 1e-5 * f64::from(k % 40), 0.0);
        let (given, moving) = if count == 0 { (null(), null()) } else { (&raw const distance, &raw const rate) };
        let before = ALLOCATIONS.get();
        let commanded = unsafe { mckibben_command(plant, 0, f64::from(k % 10) * 0.1) };
        let step = ALLOCATIONS.get();
        let advanced = unsafe { mckibben_advance(plant, until, given, count) };
        let after = ALLOCATIONS.get();
        let statuses = unsafe {
            [
                mckibben_compute(plant, given, moving, count, response.as_mut_ptr(), 1),
                mckibben_outputs(plant, outputs.as_mut_ptr(), outputs.len()),
                mckibben_save(plant, state.as_mut_ptr(), size),
                mckibben_restore(plant, state.as_ptr(), size),
            ]
        };
        assert_eq!((commanded, advanced, statuses), (Status::Ok, Status::Ok, [Status::Ok; 4]));
        if k > FIRST {
            counted[0] += after - step;
            counted[1] += ALLOCATIONS.get() - after + step - before;
        }
    }
    unsafe { mckibben_plant_free(plant) };
    counted
}

#[test]
fn a_plant_that_has_begun_allocates_nothing() {
    assert_eq!(allocations(Motion::Host), [0, 0]);
    let [steps, others] = allocations(Motion::Scenario);
    assert_eq!(others, 0);
    println!("{steps} allocations in a thousand steps of the scenario");
}
