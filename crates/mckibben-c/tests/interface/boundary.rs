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

/// A state of another plant is refused, though it has as many numbers: its valves, its air and its law need not have such a state.
/// What the host itself does, and where the plant began, is no other plant.
#[test]
fn a_state_of_another_plant_is_refused() {
    const TANK: &str = "reservoir_volume = \"200 cm^3\"";
    let base = format!(
        "{}[hose]\nlength = \"0.5 m\"\ndiameter = \"3 mm\"\n[actuator.friction]\ncoulomb_force = \"4 N\"\n",
        MUSCLE.replace("[supply]", &format!("[supply]\n{TANK}"))
    );
    let others = [
        ("200 cm^3", "300 cm^3", [true, true]),
        ("100 psi", "90 psi", [true, true]),
        ("0.5 m\"", "0.6 m\"", [true, true]),
        ("4 N", "8 N", [true, true]),
        ("eight-channel\"", "eight-channel\"\nopening_delay = \"9 ms\"", [true, true]),
        // The pulses are the host's, at the frequency of the file.
        ("25 Hz", "30 Hz", [true, true]),
        // Where the host moves the ends there is no load.
        ("5 lb", "6 lb", [false, true]),
        ("duty = 0.5", "duty = 0.6", [false, false]),
        ("40 psi", "50 psi", [false, false]),
        ("0.1 s", "0.2 s", [false, false]),
    ];
    for (which, motion) in [Motion::Host, Motion::Scenario].into_iter().enumerate() {
        let plant = read(&base, &options(motion));
        let size = unsafe { mckibben_state_size(plant.0) };
        let (mut state, mut before) = (vec![0.0; size], vec![0.0; size]);
        assert_eq!(unsafe { mckibben_save(plant.0, state.as_mut_ptr(), size) }, Status::Ok, "{}", last_error());
        for (old, new, is_other) in others {
            assert_eq!(base.matches(old).count(), 1, "{old}");
            let other = read(&base.replace(old, new), &options(motion));
            assert_eq!(unsafe { mckibben_state_size(other.0) }, size, "{new}");
            let restored = unsafe {
                assert_eq!(mckibben_save(other.0, before.as_mut_ptr(), size), Status::Ok);
                mckibben_restore(other.0, state.as_ptr(), size)
            };
            if !is_other[which] {
                assert_eq!(restored, Status::Ok, "{new}: {}", last_error());
                continue;
            }
            assert_eq!(restored, Status::Input, "{new}");
            assert!(last_error().contains("the state is of another plant"), "{}", last_error());
            let mut after = vec![0.0; size];
            assert_eq!(unsafe { mckibben_save(other.0, after.as_mut_ptr(), size) }, Status::Ok);
            assert_eq!(after, before, "{new}: where it was");
        }
    }
}

/// A reset returns to where the plant began, and a copy to where the copied plant did.
#[test]
fn a_reset_returns_to_where_the_plant_began() {
    let plant = muscle();
    let (began, rate) = (0.0905, 0.0);
    let place = |plant: *const Plant| {
        let mut place = [f64::NAN; 2];
        let [time, distance] = &mut place;
        unsafe {
            assert_eq!(mckibben_time(plant, time), Status::Ok);
            assert_eq!(mckibben_distances(plant, distance, 1), Status::Ok);
        }
        place
    };
    let step = |until: f64| {
        let distance = 0.0895;
        assert_eq!(unsafe { mckibben_advance(plant.0, until, &raw const distance, 1) }, Status::Ok, "{}", last_error());
    };
    step(1e-3);
    let mut copy = null_mut();
    unsafe {
        assert_eq!(mckibben_plant_clone(plant.0, &raw mut copy), Status::Ok);
        let copy = Owned(copy);
        assert_eq!(place(copy.0), [1e-3, 0.0895]);
        assert_eq!(mckibben_reset(copy.0), Status::Ok);
        assert_eq!(place(copy.0), [0.0, 0.09]);
        assert_eq!(mckibben_begin_at(plant.0, &raw const began, &raw const rate, 1), Status::Ok, "{}", last_error());
        step(1e-3);
        assert_eq!(mckibben_reset(plant.0), Status::Ok);
        assert_eq!(place(plant.0), [0.0, began]);
    }
}

/// A step into the past is refused with either motion, and the message has both times.
#[test]
fn a_step_into_the_past_is_refused() {
    for motion in [Motion::Host, Motion::Scenario] {
        let plant = read(MUSCLE, &options(motion));
        let (d, mut time) = (0.09, f64::NAN);
        unsafe {
            let given = if mckibben_distance_count(plant.0) == 0 { null() } else { &raw const d };
            let count = mckibben_distance_count(plant.0);
            assert_eq!(mckibben_advance(plant.0, 2e-3, given, count), Status::Ok, "{}", last_error());
            for past in [1.5e-3, -1.0, f64::NEG_INFINITY] {
                assert_eq!(mckibben_advance(plant.0, past, given, count), Status::Input, "{past} s: {}", last_error());
                assert!(last_error().contains(&format!("a step to {past:?} s")), "{}", last_error());
                assert!(past.is_infinite() || last_error().contains("is at 0.002 s"), "{}", last_error());
            }
            assert_eq!(mckibben_time(plant.0, &raw mut time), Status::Ok);
            assert_eq!(time, 2e-3);
            // Where the scenario moves, there is nothing to do up to the present.
            let due = if motion == Motion::Scenario { Status::Ok } else { Status::Input };
            assert_eq!(mckibben_advance(plant.0, 2e-3, given, count), due);
        }
    }
}

/// A valve accepts the numbers that it can be commanded, and no others.
#[test]
fn what_a_valve_accepts_is_what_it_can_be_commanded() {
    for (kind, requests) in [
        ("two-way", &[0.0, 1.0] as &[f64]),
        ("three-way", &[-1.0, 1.0]),
        ("three-way-normally-open", &[-1.0, 1.0]),
        ("fill-hold-exhaust", &[-1.0, 0.0, 1.0]),
    ] {
        let of_kind = MUSCLE.replace("[command]", &format!("kind = \"{kind}\"\n[command]"));
        for (mode, due) in [(c"request", requests), (c"duty", &[0.0, 0.5, 1.0])] {
            let options = Options { command_mode: mode.as_ptr(), ..options(Motion::Host) };
            let plant = read(&of_kind, &options);
            for number in [-1.0, -0.5, 0.0, 0.5, 1.0, 2.0, f64::NAN, f64::INFINITY] {
                let mut accepts = -1;
                unsafe {
                    assert_eq!(mckibben_command_accepts(plant.0, 0, number, &raw mut accepts), Status::Ok);
                    assert_eq!(accepts == 1, due.contains(&number), "{kind}, {mode:?}: {number}");
                    assert_eq!(mckibben_command(plant.0, 0, number) == Status::Ok, accepts == 1, "{kind}: {number}");
                }
                assert!(matches!(accepts, 0 | 1));
            }
        }
    }
    let (plant, mut accepts) = (muscle(), 7);
    unsafe {
        assert_eq!(mckibben_command_accepts(plant.0, 1, 0.0, &raw mut accepts), Status::Input);
        assert!(last_error().contains("no command 1"), "{}", last_error());
        assert_eq!(mckibben_command_accepts(plant.0, 0, 0.0, null_mut()), Status::Pointer);
        assert_eq!(mckibben_command_accepts(null(), 0, 0.0, &raw mut accepts), Status::Pointer);
    }
    assert_eq!(accepts, 7, "nothing is written where the call is refused");
}

/// A duty cycle takes effect at the next pulse of the plant's clock, and a valve rests before its first command.
#[test]
fn a_duty_cycle_waits_for_the_next_pulse() {
    let three_way = MUSCLE.replace("[command]", "kind = \"three-way\"\n[command]");
    let plant = read(&three_way, &options(Motion::Host));
    let mut step = |until: f64| {
        let distance = 0.09;
        assert_eq!(unsafe { mckibben_advance(plant.0, until, &raw const distance, 1) }, Status::Ok, "{}", last_error());
        output(&plant, c"actuator.gauge_pressure")
    };
    // The three-way valve exhausts.
    let [begin, rested] = [0.001, 0.01].map(&mut step);
    assert!(rested < 0.9 * begin, "{begin} Pa to {rested} Pa");
    assert_eq!(unsafe { mckibben_command(plant.0, 0, 1.0) }, Status::Ok);
    // Pulses are 40 ms apart; the valve opens 4 ms after a pulse begins.
    let [waiting, before, filled] = [0.02, 0.04, 0.07].map(&mut step);
    assert!(before < waiting && waiting < rested, "{rested} Pa, {waiting} Pa, {before} Pa");
    assert!(filled > before + 1e4, "{before} Pa to {filled} Pa");
}

/// A state with more commands on their way than it has numbers for names the call that copies it.
#[test]
fn a_state_that_has_no_numbers_is_copied_by_a_clone() {
    let late = MUSCLE.replace("[command]", "dead_time = \"100 ms\"\n[command]");
    let plant = read(&late, &Options { command_mode: c"request".as_ptr(), ..options(Motion::Host) });
    let mut numbers = vec![0.0; unsafe { mckibben_state_size(plant.0) }];
    let (distance, mut copy) = (0.09, null_mut());
    let saved: Vec<Status> = (1..=80_u32)
        .map(|k| unsafe {
            assert_eq!(mckibben_command(plant.0, 0, if k % 2 == 0 { 1.0 } else { -1.0 }), Status::Ok);
            assert_eq!(mckibben_advance(plant.0, f64::from(k) * 1e-3, &raw const distance, 1), Status::Ok);
            mckibben_save(plant.0, numbers.as_mut_ptr(), numbers.len())
        })
        .collect();
    assert_eq!((saved[59], saved[79]), (Status::Ok, Status::Input), "{}", last_error());
    assert!(last_error().contains("mckibben_plant_clone") && last_error().contains("64"), "{}", last_error());
    assert!(!last_error().contains("PlantSteps"), "{}", last_error());
    assert_eq!(unsafe { mckibben_plant_clone(plant.0, &raw mut copy) }, Status::Ok);
    let copy = Owned(copy);
    let ends = [&plant, &copy].map(|its| unsafe {
        assert_eq!(mckibben_advance(its.0, 0.25, &raw const distance, 1), Status::Ok);
        output(its, c"actuator.gauge_pressure").to_bits()
    });
    assert_eq!(ends[0], ends[1]);
}

/// Names of commands: the actuator, and the mode with an underscore.
#[test]
fn the_name_of_a_command_has_its_actuator_and_its_mode() {
    let valves = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/valves");
    for (file, due) in [
        ("pressure-regulator.toml", ["actuator.set_point", "set-point", "Pa"]),
        ("proportional-spool.toml", ["actuator.position", "position", ""]),
    ] {
        let (path, mut plant) = (valves.join(file).display().to_string(), null_mut());
        let path = std::ffi::CString::new(path).expect("a path");
        let mut info = MaybeUninit::<CommandInfo>::uninit();
        unsafe {
            let read = mckibben_plant_from_file(path.as_ptr(), null(), &raw mut plant);
            assert_eq!(read, Status::Ok, "{}", last_error());
            let plant = Owned(plant);
            assert_eq!(mckibben_command_describe(plant.0, 0, info.as_mut_ptr()), Status::Ok);
            let info = info.assume_init();
            assert_eq!([text(info.name), text(info.mode), text(info.unit)], due);
        }
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
        refused(mckibben_advance(plant.0, -1.0, d.as_ptr(), 1), Status::Input, "-1.0 s");
        refused(mckibben_advance(plant.0, nan, d.as_ptr(), 1), Status::Input, "");
        refused(mckibben_compute(plant.0, d.as_ptr(), null(), 1, two.as_mut_ptr(), 1), Status::Pointer, "`rates`");
        refused(mckibben_compute(plant.0, d.as_ptr(), d.as_ptr(), 1, two.as_mut_ptr(), 2), Status::Count, "responses");
        refused(mckibben_compute(plant.0, null(), null(), 0, null_mut(), 1), Status::Pointer, "`responses`");
        refused(
            mckibben_compute(plant.0, &raw const nan, &raw const nan, 1, two.as_mut_ptr(), 1),
            Status::Input,
            "NaN",
        );
        // The force of viscous friction at such a rate is no finite number.
        for fast in [1e308, -1e308] {
            let status = mckibben_compute(plant.0, d.as_ptr(), &raw const fast, 1, two.as_mut_ptr(), 1);
            refused(status, Status::Input, "cannot move at");
            refused(mckibben_begin_at(plant.0, d.as_ptr(), &raw const fast, 1), Status::Input, "cannot move at");
        }
        refused(mckibben_outputs(plant.0, numbers.as_mut_ptr(), 1), Status::Count, "mckibben_output_count");
        refused(mckibben_time(plant.0, null_mut()), Status::Pointer, "`time`");
        refused(mckibben_distances(plant.0, numbers.as_mut_ptr(), 2), Status::Count, "distances");
        refused(mckibben_begin_at(plant.0, &raw const far, &raw const d[1], 1), Status::Input, "");
        refused(mckibben_begin_at(plant.0, null(), null(), 0), Status::Count, "distances");
        refused(mckibben_save(plant.0, numbers.as_mut_ptr(), 1), Status::Count, "mckibben_state_size");
        refused(mckibben_restore(plant.0, numbers.as_ptr(), size + 1), Status::Count, "mckibben_state_size");
        refused(mckibben_restore(plant.0, vec![nan; size].as_ptr(), size), Status::Input, "of another plant");
        let behind_mark = [&before[..1], &vec![nan; size - 1]].concat();
        refused(mckibben_restore(plant.0, behind_mark.as_ptr(), size), Status::Input, "no state");
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

/// A scenario with a pressure regulator.
fn regulating() -> std::ffi::CString {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/valves/pressure-regulator.toml");
    std::ffi::CString::new(std::fs::read(path).expect("the example")).expect("text")
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
        assert!(last_error().contains("options."), "an option has its name in C: {}", last_error());
        assert!(!last_error().contains("_mode=\""), "{}", last_error());
    }
    let (regulates, duty) = (regulating(), Options { command_mode: c"duty".as_ptr(), ..mode });
    refused(regulates.as_ptr(), &raw const duty, "options.command_mode = \"set-point\", NULL for each", Status::Input);
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
