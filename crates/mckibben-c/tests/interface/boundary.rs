//! One plant: names, steps, saving; and what wrong use returns.

use super::common::{MUSCLE, Owned, last_error, muscle, options, read, text};
use mckibben_c::plant::*;
use mckibben_c::status::{Status, mckibben_version};
use mckibben_c::step::*;
use mckibben_run::host::{HostOptions, HostPlant};
use mckibben_scenario::Document;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};

fn output(plant: &Owned, name: &std::ffi::CStr) -> f64 {
    let (mut index, mut all) = (0, vec![0.0; unsafe { mckibben_output_count(plant.0) }]);
    unsafe {
        assert_eq!(mckibben_output_index(plant.0, name.as_ptr(), &raw mut index), Status::Ok, "{}", last_error());
        assert_eq!(mckibben_outputs(plant.0, all.as_mut_ptr(), all.len()), Status::Ok, "{}", last_error());
    }
    all[index]
}

/// A loop through C has the bits of the loop through the host interface in Rust.
#[test]
fn a_plant_steps_as_the_host_interface() {
    let plant = muscle();
    let document = Document::parse(MUSCLE, "muscle.toml").expect("TOML");
    let mut host = HostPlant::read(&document, &HostOptions::default()).expect("a plant");
    let mut response = [Response { ..unsafe { MaybeUninit::zeroed().assume_init() } }];
    let mut expected = [host.steps_mut().compute(0).expect("a response")];
    for k in 1..=200_u32 {
        let (until, distance, rate) = (f64::from(k) * 1e-3, 0.09 - 1e-5 * f64::from(k % 40), -0.01);
        let duty = if k < 100 { 0.7 } else { 0.3 };
        host.command(0, duty).expect("a duty cycle");
        host.advance(until, &[distance]).expect("a step");
        host.compute_at(&[distance], &[rate], &mut expected).expect("a response");
        unsafe {
            assert_eq!(mckibben_command(plant.0, 0, duty), Status::Ok);
            assert_eq!(mckibben_advance(plant.0, until, &raw const distance, 1), Status::Ok);
            let computed = mckibben_compute(plant.0, &raw const distance, &raw const rate, 1, response.as_mut_ptr(), 1);
            assert_eq!(computed, Status::Ok);
        }
        assert_eq!(response[0].tension.to_bits(), expected[0].tension.to_bits(), "step {k}");
        assert_eq!(response[0].per_pressure.to_bits(), expected[0].per_pressure.to_bits());
    }
    let mut outputs = vec![0.0; host.outputs().len()];
    host.read_outputs(&mut outputs).expect("as many");
    let mut own = vec![0.0; outputs.len()];
    assert_eq!(unsafe { mckibben_outputs(plant.0, own.as_mut_ptr(), own.len()) }, Status::Ok);
    assert_eq!(own, outputs);
}

#[test]
fn names_units_and_counts_are_those_of_the_scenario() {
    let plant = muscle();
    let (mut command, mut out) = (MaybeUninit::<CommandInfo>::uninit(), MaybeUninit::<OutputInfo>::uninit());
    unsafe {
        assert_eq!(mckibben_actuator_count(plant.0), 1);
        assert_eq!(text(mckibben_actuator_name(plant.0, 0)), "actuator");
        assert_eq!((mckibben_command_count(plant.0), mckibben_distance_count(plant.0)), (1, 1));
        assert_eq!(mckibben_command_describe(plant.0, 0, command.as_mut_ptr()), Status::Ok);
        let command = command.assume_init();
        let texts = [text(command.name), text(command.mode), text(command.unit)];
        assert_eq!(texts, ["actuator.duty", "duty", ""]);
        assert_eq!((command.minimum, command.maximum, command.pulse_frequency), (0.0, 1.0, 25.0));
        let mut index = 0;
        assert_eq!(mckibben_output_index(plant.0, c"actuator.gauge_pressure".as_ptr(), &raw mut index), Status::Ok);
        assert_eq!(mckibben_output_describe(plant.0, index, out.as_mut_ptr()), Status::Ok);
        assert_eq!(text(out.assume_init().unit), "Pa");
    }
    assert_eq!(text(mckibben_version()), env!("CARGO_PKG_VERSION"));
    assert!((output(&plant, c"actuator.gauge_pressure") / (40.0 * 6_894.757_293_168_361) - 1.0).abs() < 1e-12);
}

/// What is saved, restored, copied, reset and begun elsewhere.
#[test]
fn a_state_is_saved_copied_and_left() {
    let (plant, mut copy, mut time) = (muscle(), null_mut(), 0.0);
    let mut numbers = vec![0.0; unsafe { mckibben_state_size(plant.0) }];
    let step = |plant: &Owned, range: std::ops::RangeInclusive<u32>| {
        for k in range {
            let distance = 0.09 - 1e-5 * f64::from(k % 40);
            unsafe {
                assert_eq!(mckibben_command(plant.0, 0, 0.7), Status::Ok);
                assert_eq!(mckibben_advance(plant.0, f64::from(k) * 1e-3, &raw const distance, 1), Status::Ok);
            }
        }
        output(plant, c"actuator.gauge_pressure")
    };
    step(&plant, 1..=60);
    unsafe {
        assert_eq!(mckibben_save(plant.0, numbers.as_mut_ptr(), numbers.len()), Status::Ok);
        assert_eq!(mckibben_plant_clone(plant.0, &raw mut copy), Status::Ok);
    }
    let copy = Owned(copy);
    let there = step(&plant, 61..=150);
    assert_eq!(step(&copy, 61..=150), there);
    let other = muscle();
    unsafe {
        assert_eq!(mckibben_restore(other.0, numbers.as_ptr(), numbers.len()), Status::Ok);
        assert_eq!(step(&other, 61..=150), there);
        assert_eq!(mckibben_reset(other.0), Status::Ok);
        assert_eq!(mckibben_time(other.0, &raw mut time), Status::Ok);
        assert_eq!(time, 0.0);
        let mut distance = 0.085;
        assert_eq!(mckibben_begin_at(other.0, &raw const distance, &raw const time, 1), Status::Ok);
        distance = 0.0;
        assert_eq!(mckibben_distances(other.0, &raw mut distance, 1), Status::Ok);
        assert_eq!(distance, 0.085);
        // Saved where it was reset, too.
        assert_eq!(mckibben_save(other.0, numbers.as_mut_ptr(), numbers.len()), Status::Ok);
    }
}

/// A call that is refused returns its status and says why, and the plant stays as it was.
#[test]
fn wrong_use_is_refused_and_changes_nothing() {
    let plant = muscle();
    let mut before = vec![0.0; unsafe { mckibben_state_size(plant.0) }];
    let (mut numbers, size, nan, far) = (before.clone(), before.len(), f64::NAN, 0.5);
    let d = [0.09, 0.0];
    let (mut two, mut index) = ([Response { ..unsafe { MaybeUninit::zeroed().assume_init() } }; 2], 0);
    let refused = |status: Status, due: Status, words: &str| {
        assert_eq!(status, due, "{}", last_error());
        assert!(last_error().contains(words), "{words}: {}", last_error());
    };
    let odd = |array: &[f64]| array.as_ptr().wrapping_byte_add(1);
    unsafe {
        assert_eq!(mckibben_save(plant.0, before.as_mut_ptr(), size), Status::Ok);
        refused(mckibben_command(plant.0, 0, 1.5), Status::Input, "1.5");
        refused(mckibben_command(plant.0, 0, nan), Status::Input, "NaN");
        refused(mckibben_command(plant.0, 7, 0.5), Status::Input, "no command 7");
        refused(mckibben_command(null_mut(), 0, 0.5), Status::Pointer, "`plant` is NULL");
        refused(mckibben_advance(plant.0, 1e-3, null(), 1), Status::Pointer, "`distances` is NULL");
        refused(mckibben_advance(plant.0, 1e-3, odd(&d), 1), Status::Pointer, "not aligned");
        refused(mckibben_advance(plant.0, 1e-3, null(), 0), Status::Count, "it takes 1");
        refused(mckibben_advance(plant.0, 1e-3, d.as_ptr(), 2), Status::Count, "mckibben_distance_count");
        refused(mckibben_advance(plant.0, 1e-3, d.as_ptr(), usize::MAX), Status::Count, "more than memory can hold");
        refused(mckibben_advance(plant.0, 1e-3, &raw const nan, 1), Status::Input, "NaN");
        refused(mckibben_advance(plant.0, -1.0, d.as_ptr(), 1), Status::Input, "later");
        refused(mckibben_advance(plant.0, nan, d.as_ptr(), 1), Status::Input, "");
        refused(mckibben_compute(plant.0, d.as_ptr(), null(), 1, two.as_mut_ptr(), 1), Status::Pointer, "`rates`");
        refused(mckibben_compute(plant.0, d.as_ptr(), d.as_ptr(), 1, two.as_mut_ptr(), 2), Status::Count, "responses");
        refused(mckibben_compute(plant.0, null(), null(), 0, null_mut(), 1), Status::Pointer, "`responses`");
        refused(
            mckibben_compute(plant.0, &raw const nan, &raw const nan, 1, two.as_mut_ptr(), 1),
            Status::Input,
            "NaN",
        );
        refused(mckibben_outputs(plant.0, numbers.as_mut_ptr(), 1), Status::Count, "mckibben_output_count");
        refused(mckibben_time(plant.0, null_mut()), Status::Pointer, "`time`");
        refused(mckibben_distances(plant.0, numbers.as_mut_ptr(), 2), Status::Count, "distances");
        refused(mckibben_begin_at(plant.0, &raw const far, &raw const d[1], 1), Status::Input, "");
        refused(mckibben_begin_at(plant.0, null(), null(), 0), Status::Count, "distances");
        refused(mckibben_save(plant.0, numbers.as_mut_ptr(), 1), Status::Count, "mckibben_state_size");
        refused(mckibben_restore(plant.0, numbers.as_ptr(), size + 1), Status::Count, "mckibben_state_size");
        refused(mckibben_restore(plant.0, vec![nan; size].as_ptr(), size), Status::Input, "no state");
        refused(mckibben_output_index(plant.0, c"pressure".as_ptr(), &raw mut index), Status::Input, "give one of");
        refused(mckibben_output_index(plant.0, c"\xff".as_ptr(), &raw mut index), Status::Input, "UTF-8");
        refused(mckibben_command_describe(plant.0, 1, null_mut()), Status::Input, "no command 1");
        refused(mckibben_command_describe(plant.0, 0, null_mut()), Status::Pointer, "`info`");
        refused(mckibben_output_describe(plant.0, usize::MAX, null_mut()), Status::Input, "no output");
        refused(mckibben_plant_clone(plant.0, null_mut()), Status::Pointer, "`copy`");
        assert_eq!(mckibben_save(plant.0, numbers.as_mut_ptr(), size), Status::Ok);
        assert_eq!(numbers, before);
        assert!(mckibben_actuator_name(plant.0, 1).is_null() && last_error().contains("no actuator 1"));
        assert_eq!((mckibben_actuator_count(null()), mckibben_state_size(null())), (0, 0));
        mckibben_plant_free(null_mut());
    }
}

/// A mistake in a scenario is shown in it; `*plant` is then NULL.
#[test]
fn a_plant_that_cannot_be_read_is_none() {
    let good = std::ffi::CString::new(MUSCLE).expect("text");
    let bad = std::ffi::CString::new(MUSCLE.replace("5 lb", "5 lbf")).expect("text");
    let (mode, mut wrong) = (options(Motion::Host), options(Motion::Scenario));
    let refused = |text: *const std::ffi::c_char, options: *const Options, words: &str, due: Status| {
        let mut plant = std::ptr::dangling_mut::<Plant>();
        let status = unsafe { mckibben_plant_from_text(text, c"arm.toml".as_ptr(), options, &raw mut plant) };
        assert!(plant.is_null());
        assert_eq!(status, due, "{}", last_error());
        assert!(last_error().contains(words), "{}", last_error());
    };
    refused(bad.as_ptr(), &raw const mode, "arm.toml:1", Status::Input);
    refused(null(), null(), "`text` is NULL", Status::Pointer);
    refused(c"\xff\xfe".as_ptr(), null(), "UTF-8", Status::Input);
    wrong.motion = 2;
    refused(good.as_ptr(), &raw const wrong, "MCKIBBEN_MOTION_HOST", Status::Input);
    for (motion, mode, frequency, step) in [
        (0, c"duty".as_ptr(), -1.0, 0.0),
        (0, c"set-point".as_ptr(), 0.0, 0.0),
        (0, c"".as_ptr(), 0.0, 0.0),
        (1, null(), 0.0, f64::NAN),
        (0, null(), 0.0, -1.0),
    ] {
        let wrong = Options { motion, command_mode: mode, pulse_frequency: frequency, max_step: step };
        refused(good.as_ptr(), &raw const wrong, "help", Status::Input);
    }
    unsafe {
        assert_eq!(mckibben_plant_from_text(good.as_ptr(), null(), null(), null_mut()), Status::Pointer);
        let mut plant = null_mut();
        assert_eq!(mckibben_plant_from_file(c"no such file".as_ptr(), null(), &raw mut plant), Status::Input);
        assert!(plant.is_null() && last_error().contains("no such file"));
    }
}

/// The motion of the scenario takes no distances.
#[test]
fn a_scenario_moves_its_own_load() {
    let plant = read(MUSCLE, &options(Motion::Scenario));
    let d = [0.09];
    unsafe {
        assert_eq!(mckibben_distance_count(plant.0), 0);
        assert_eq!(mckibben_command(plant.0, 0, 1.0), Status::Ok);
        assert_eq!(mckibben_advance(plant.0, 0.1, null(), 0), Status::Ok, "{}", last_error());
        assert_eq!(mckibben_advance(plant.0, 0.2, d.as_ptr(), 1), Status::Count);
        assert_eq!(mckibben_begin_at(plant.0, d.as_ptr(), d.as_ptr(), 1), Status::Input);
        assert_eq!(mckibben_advance(plant.0, 1e300, null(), 0), Status::Input);
        assert!(last_error().contains("ten million"), "{}", last_error());
        assert_eq!(mckibben_distances(plant.0, null_mut(), 0), Status::Ok);
    }
    assert!(output(&plant, c"actuator.length") < 0.09);
}

/// A plant that one thread steps refuses the calls of another.
#[test]
fn a_plant_in_use_says_so() {
    let plant = read(MUSCLE, &options(Motion::Scenario));
    let (address, enough) = (plant.0 as usize, AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let (plant, mut until) = (address as *mut Plant, 0.5);
            while !enough.load(Ordering::Relaxed) {
                // It may meet the other's call as well.
                match unsafe { mckibben_advance(plant, until, null(), 0) } {
                    Status::Ok => until += 0.5,
                    status => assert_eq!(status, Status::Busy, "{}", last_error()),
                }
            }
        });
        let mut time = 0.0;
        let mut call = || unsafe { mckibben_time(plant.0, &raw mut time) };
        let mut once = |_| {
            // The other takes its turn.
            std::thread::yield_now();
            call()
        };
        let met = (0..10_000_000).map(&mut once).find(|status| *status != Status::Ok);
        enough.store(true, Ordering::Relaxed);
        assert_eq!(met, Some(Status::Busy));
        assert!(last_error().contains("another thread"), "{}", last_error());
    });
}

/// The texts of one thread are its own.
#[test]
fn the_last_error_belongs_to_a_thread() {
    assert_eq!(unsafe { mckibben_reset(null_mut()) }, Status::Pointer);
    std::thread::spawn(|| assert_eq!(last_error(), "")).join().expect("no error");
    assert!(last_error().contains("`plant` is NULL"));
}

/// The tests of this module again under Valgrind: no invalid access, no leak.
#[cfg(target_os = "linux")]
#[test]
fn nothing_is_wrong_under_valgrind() {
    let this = std::env::current_exe().expect("this program");
    let mut valgrind = std::process::Command::new("valgrind");
    valgrind.args([
        "--quiet",
        "--error-exitcode=1",
        // The optimiser reads the contents of an enumeration before its tag, and then selects: Valgrind takes that for a jump on
        // what was never written, which the safe code of the core cannot do.
        "--undef-value-errors=no",
        "--leak-check=full",
        "--show-leak-kinds=definite",
        "--errors-for-leak-kinds=definite",
    ]);
    // All but this test itself.
    valgrind.arg(this).args(["boundary::", "many::", "simulation::", "--skip", "valgrind", "--test-threads=1"]);
    let done = valgrind.output().expect("Valgrind: on Debian, apt-get install valgrind");
    let text = [done.stdout, done.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert!(done.status.success(), "{text}");
    assert!(text.contains("wrong_use_is_refused"), "{text}");
}
