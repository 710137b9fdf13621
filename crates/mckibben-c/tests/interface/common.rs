//! Plants of the tests.

use mckibben_c::many::Step;
use mckibben_c::plant::{Motion, Options, Plant, mckibben_plant_free, mckibben_plant_from_text};
use mckibben_c::status::{Status, mckibben_last_error};
use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

/// A muscle of the paper with a valve of two poppets, 25 Hz pulses, at 90 mm and 40 psi.
pub(crate) const MUSCLE: &str = r#"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
length = "90 mm"
gauge_pressure = "40 psi"
[run]
duration = "0.1 s"
engine = "fixed-step"
step = "0.5 ms"
"#;

/// A plant that is freed at the end of its scope.
pub(crate) struct Owned(pub(crate) *mut Plant);

impl Drop for Owned {
    fn drop(&mut self) {
        unsafe { mckibben_plant_free(self.0) };
    }
}

pub(crate) fn options(motion: Motion) -> Options {
    Options { motion: motion as i32, command_mode: null(), pulse_frequency: 0.0, max_step: 0.0 }
}

pub(crate) fn read(text: &str, options: &Options) -> Owned {
    let (text, mut plant) = (CString::new(text).expect("text"), null_mut());
    let status = unsafe { mckibben_plant_from_text(text.as_ptr(), null(), options, &raw mut plant) };
    assert_eq!(status, Status::Ok, "{}", last_error());
    Owned(plant)
}

pub(crate) fn muscle() -> Owned {
    read(MUSCLE, &options(Motion::Host))
}

pub(crate) fn last_error() -> String {
    text(mckibben_last_error())
}

pub(crate) fn text(pointer: *const std::ffi::c_char) -> String {
    assert!(!pointer.is_null(), "{}", text(mckibben_last_error()));
    unsafe { CStr::from_ptr(pointer) }.to_str().expect("UTF-8").to_owned()
}

/// A step to a time in s with these distances, and nothing else.
pub(crate) fn step(until: f64, distances: &[f64]) -> Step {
    Step {
        until,
        commands: null(),
        command_count: 0,
        distances: distances.as_ptr(),
        distance_count: 1,
        responses: null_mut(),
        response_count: 0,
        outputs: null_mut(),
        output_count: 0,
    }
}
