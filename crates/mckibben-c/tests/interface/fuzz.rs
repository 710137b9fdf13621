//! Calls in any order with any values: each returns a status or a text, and none crashes, panics or hangs.
//!
//! Values are such as hosts pass by mistake: not a number, infinite, far out of range, NULL, misaligned, wrong counts; scenarios are
//! truncated and mutated, byte by byte and line by line. Two seconds of it here; for longer, and with other values:
//!
//! ```text
//! MCKIBBEN_FUZZ_SECONDS=600 MCKIBBEN_FUZZ_SEED=7 cargo test --package mckibben-c --test interface fuzz
//! ```

use super::common::{MUSCLE, last_error};
use mckibben_c::many::*;
use mckibben_c::plant::*;
use mckibben_c::simulation::*;
use mckibben_c::status::Status;
use mckibben_c::step::*;
use std::ffi::{CString, c_char, c_void};
use std::ptr::{null, null_mut};
use std::time::{Duration, Instant};

/// Scenarios to mutate; each says its step, so that none is searched for.
const SCENARIOS: [&str; 3] = [MUSCLE, JOINT, TANK];

const JOINT: &str = r#"
[supply]
gauge_pressure = "60 psi"
[valve]
preset = "matrix-eight-channel"
kind = "fill-hold-exhaust"
[command]
kind = "table"
time = ["0 s", "20 ms"]
state = ["fill", "hold"]
[load]
kind = "antagonistic-joint"
pulley_radius = "15 mm"
rest_length = "3.3 in"
mass = "0.5 kg"
distance = "100 mm"
inertia = "1e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-40 deg"
max_angle = "40 deg"
[initial]
gauge_pressure = "20 psi"
[antagonist.command]
kind = "hold"
[run]
duration = "50 ms"
engine = "fixed-step"
step = "0.5 ms"
"#;

const TANK: &str = r#"
[supplies.tank]
gauge_pressure = "6 bar"
reservoir_volume = "300 cm^3"
[valve]
preset = "matrix-eight-channel"
kind = "fill-hold-exhaust"
[command]
kind = "hold"
[initial]
gauge_pressure = "1 bar"
[mechanism]
kind = "chain"
[mechanism.joints.elbow]
length = "24 cm"
mass = "0.5 kg"
distance = "10 cm"
inertia = "2.5e-3 kg*m^2"
[coupling]
rest_length = "3.4 in"
[actuators.biceps]
coupling.arms.elbow = "15 mm"
[actuators.triceps]
coupling.arms.elbow = "-12 mm"
[run]
duration = "50 ms"
engine = "fixed-step"
step = "0.5 ms"
"#;

/// A generator of random numbers (xorshift64*).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() >> 11) as usize % end
    }

    fn chance(&mut self, one_in: usize) -> bool {
        self.below(one_in) == 0
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// A number that no host means, or `good`.
    fn number(&mut self, good: f64) -> f64 {
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, 0.0, 1e300, -1e300, 5e-324, -1.0, 1.0, 2.0];
        match self.below(8) {
            0 => self.of(&odd),
            1 => f64::from_bits(self.next()),
            _ => good,
        }
    }

    /// A count that is wrong now and then; `most` is what memory holds.
    fn count(&mut self, due: usize, most: usize) -> usize {
        if self.chance(8) { self.below(most + 1) } else { due.min(most) }
    }

    /// A pointer to an array, or one that the library refuses.
    fn pointer<T>(&mut self, good: *mut T) -> *mut T {
        match self.below(24) {
            0 => null_mut(),
            1 => good.wrapping_byte_add(1),
            _ => good,
        }
    }

    /// A scenario, as it is or mutated.
    fn scenario(&mut self) -> CString {
        let mut text = self.of(&SCENARIOS).as_bytes().to_vec();
        for _ in 0..self.below(4) {
            self.mutate(&mut text);
        }
        text.retain(|byte| *byte != 0);
        CString::new(text).expect("no zero byte")
    }

    fn mutate(&mut self, text: &mut Vec<u8>) {
        let at = self.below(text.len().max(1)).min(text.len());
        let inserted: &[&[u8]] =
            &[b"\"", b"[", b"]]", b"=", b"\n", b"nan", b"-", b"1e999", b"{", b"0x", b".", b"9", b"\xff", b"'''"];
        match self.below(7) {
            0 => text.truncate(at),
            1 if at < text.len() => text[at] = self.next() as u8,
            2 if at < text.len() => drop(text.remove(at)),
            3 => drop(text.splice(at..at, self.of(inserted).iter().copied())),
            4 => {
                let deep = b"[".repeat(self.below(3000));
                drop(text.splice(at..at, deep));
            }
            _ => {
                let mut lines: Vec<Vec<u8>> = text.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
                let (from, to) = (self.below(lines.len()), self.below(lines.len()));
                if self.chance(2) {
                    lines.swap(from, to)
                } else {
                    lines[to] = lines[from].clone()
                }
                *text = lines.join(&b'\n');
            }
        }
    }
}

/// Ends a run at its hundredth report.
unsafe extern "C" fn hundredth(_: f64, data: *mut c_void) -> i32 {
    let count = unsafe { &mut *data.cast::<u32>() };
    *count += 1;
    i32::from(*count > 100)
}

/// Numbers that a caller owns.
const ROOM: usize = 512;

/// What has been returned.
#[derive(Debug, Default)]
struct Seen {
    calls: u64,
    done: u64,
    refused: u64,
    read: u64,
}

impl Seen {
    fn note(&mut self, status: Status, call: &str) -> bool {
        self.calls += 1;
        assert!(status != Status::Defect && status != Status::Busy, "{call}: {status:?}: {}", last_error());
        let done = status == Status::Ok;
        if done {
            self.done += 1
        } else {
            self.refused += 1
        }
        assert!(done || !last_error().is_empty(), "{call}: {status:?} without words");
        done
    }
}

fn read(random: &mut Random, seen: &mut Seen) -> Option<*mut Plant> {
    let (text, mut plant) = (random.scenario(), null_mut());
    let modes: [*const c_char; 7] =
        [null(), null(), null(), c"duty".as_ptr(), c"request".as_ptr(), c"\xff".as_ptr(), c"".as_ptr()];
    // Steps and pulses that are short but not refused take up to a minute.
    let rarely = |number: f64, [least, most]: [f64; 2]| if (least..most).contains(&number) { most } else { number };
    let options = Options {
        motion: if random.chance(10) { random.next() as i32 } else { random.below(2) as i32 },
        command_mode: random.of(&modes),
        pulse_frequency: if random.chance(4) { 1.0 / rarely(1.0 / random.number(25.0), [1e-12, 1e-4]) } else { 0.0 },
        max_step: if random.chance(4) { rarely(random.number(1e-3), [1e-12, 1e-5]) } else { 0.0 },
    };
    let options = if random.chance(8) { null() } else { random.pointer((&raw const options).cast_mut()).cast_const() };
    let text = if random.chance(40) { null() } else { text.as_ptr() };
    let status = unsafe { mckibben_plant_from_text(text, null(), options, &raw mut plant) };
    let done = seen.note(status, "plant_from_text");
    assert_eq!(done, !plant.is_null());
    seen.read += u64::from(done);
    done.then_some(plant)
}

/// A batch of copies of a plant, and calls on it.
fn in_batch(random: &mut Random, [its, plant]: [*mut Plant; 2], step: &Step, ends: [*const f64; 2]) -> Status {
    let all = [its.cast_const(), plant.cast_const(), if random.chance(9) { null() } else { plant.cast_const() }];
    let (mut batch, mut copy, mut statuses) = (null_mut(), null_mut(), [Status::Ok; 3]);
    unsafe {
        let (count, threads) = (random.below(4), random.below(3));
        let made = mckibben_batch_from_plants(all.as_ptr(), count, threads, &raw mut batch);
        assert_eq!(made == Status::Ok, !batch.is_null());
        assert_eq!(mckibben_batch_count(batch), if batch.is_null() { 0 } else { count });
        let stepped = mckibben_batch_step(batch, step, random.pointer(&raw mut statuses[0]));
        mckibben_batch_begin_at(batch, random.below(4), ends[0], ends[1], step.distance_count);
        mckibben_batch_step(batch, step, null_mut());
        mckibben_batch_plant(batch, random.below(4), &raw mut copy);
        mckibben_plant_free(copy);
        mckibben_batch_free(batch);
        if made == Status::Ok { stepped } else { made }
    }
}

/// One call on a plant.
fn call(random: &mut Random, seen: &mut Seen, plant: *mut Plant, saved: &mut Vec<f64>) {
    let mut numbers: Vec<f64> = (0..ROOM).map(|_| 0.0).collect();
    let mut responses: Vec<Response> = vec![unsafe { std::mem::zeroed() }; 8];
    let mut time = 0.0;
    unsafe { mckibben_time(plant, &raw mut time) };
    let counts = unsafe {
        [
            mckibben_actuator_count(plant),
            mckibben_command_count(plant),
            mckibben_output_count(plant),
            mckibben_distance_count(plant),
            mckibben_state_size(plant),
        ]
    };
    let [actuators, commands, outputs, distances, size] = counts;
    assert!(size <= ROOM && outputs <= ROOM && actuators <= responses.len());
    let its = if random.chance(50) { null_mut() } else { plant };
    let near = random.chance(2);
    for number in &mut numbers {
        let good = if near { 0.088 + 0.004 * random.unit() } else { 0.09 };
        *number = if random.chance(6) { random.number(good) } else { good };
    }
    let mut rates = vec![0.0; ROOM];
    rates.fill_with(|| random.number(0.01));
    let soon = time + 0.005 * random.unit();
    let until = random.number(soon);
    // What is far but not refused would take minutes.
    let until = if until > time + 0.01 && until < 1e12 { time + 1e-3 } else { until };
    let count = random.count(distances, ROOM);
    let given = random.pointer(numbers.as_mut_ptr());
    let status = unsafe {
        match random.below(14) {
            0 | 1 => {
                let good = random.of(&[0.0, 1.0, -1.0, 0.5, 2e5]);
                mckibben_command(its, random.count(commands.saturating_sub(1), 9), random.number(good))
            }
            2..=4 => mckibben_advance(its, until, given, count),
            5 => {
                let many = random.count(actuators, responses.len());
                let (into, rates) = (random.pointer(responses.as_mut_ptr()), random.pointer(rates.as_mut_ptr()));
                mckibben_compute(its, given, rates, if random.chance(4) { 0 } else { count }, into, many)
            }
            6 => mckibben_outputs(its, given, random.count(outputs, ROOM)),
            7 => mckibben_begin_at(its, given, random.pointer(rates.as_mut_ptr()), count),
            8 => mckibben_reset(its),
            9 => {
                let status = mckibben_save(its, given, random.count(size, ROOM));
                if status == Status::Ok {
                    *saved = numbers[..size].to_vec();
                }
                status
            }
            10 => {
                // What was saved, with a few numbers of it changed.
                numbers[..saved.len().min(ROOM)].copy_from_slice(&saved[..saved.len().min(ROOM)]);
                for _ in 0..random.below(3) {
                    let place = random.below(size.max(1));
                    numbers[place] = random.number(1.0);
                }
                // A time far ahead is a state, but its next step from a short one is not looked at.
                mckibben_restore(its, given, random.count(size, ROOM))
            }
            11 => mckibben_distances(its, given, count),
            12 => {
                let (mut info, index) = (std::mem::MaybeUninit::uninit(), random.below(40));
                mckibben_actuator_name(its, index);
                let (number, mut accepts) = (random.number(1.0), 0);
                mckibben_command_accepts(its, random.below(9), number, random.pointer(&raw mut accepts));
                mckibben_output_describe(its, index, random.pointer(info.as_mut_ptr()))
            }
            _ => {
                let step = Step {
                    until,
                    commands: random.pointer(numbers.as_mut_ptr()),
                    command_count: random.count(commands, 100),
                    distances: given,
                    distance_count: count.min(100),
                    responses: random.pointer(responses.as_mut_ptr()),
                    response_count: random.count(actuators, 2),
                    outputs: random.pointer(rates.as_mut_ptr()),
                    output_count: random.count(outputs, 100),
                };
                let moved = [numbers.as_ptr(), rates.as_ptr()];
                in_batch(random, [its, plant], &step, moved)
            }
        }
    };
    seen.note(status, "a call");
}

fn simulate(random: &mut Random, seen: &mut Seen) {
    let (text, mut run, mut count) = (random.scenario(), null_mut(), 0_u32);
    let data = (&raw mut count).cast::<c_void>();
    let status = unsafe { mckibben_simulate_text(text.as_ptr(), null(), Some(hundredth), data, &raw mut run) };
    let done = seen.note(status, "simulate");
    assert_eq!(done, !run.is_null());
    let mut numbers = vec![0.0; ROOM];
    unsafe {
        let (column, rows) = (random.below(60), mckibben_run_row_count(run));
        if rows <= ROOM {
            mckibben_run_column(run, column, random.pointer(numbers.as_mut_ptr()), random.count(rows, ROOM));
        }
        mckibben_run_word(run, column, random.below(1000));
        mckibben_run_free(run);
    }
}

/// A number from the environment.
fn chosen(name: &str, otherwise: u64) -> u64 {
    let read = |text: String| text.parse().unwrap_or_else(|_| panic!("{name} = {text:?} is no whole number"));
    std::env::var(name).map_or(otherwise, read)
}

/// What is mutated is a plant with either motion, and a run.
#[test]
fn the_scenarios_to_mutate_are_good() {
    for text in SCENARIOS {
        for motion in [Motion::Host, Motion::Scenario] {
            super::common::read(text, &super::common::options(motion));
        }
        let (text, mut run) = (CString::new(text).expect("text"), null_mut());
        let status = unsafe { mckibben_simulate_text(text.as_ptr(), null(), None, null_mut(), &raw mut run) };
        assert_eq!(status, Status::Ok, "{}", last_error());
        unsafe { mckibben_run_free(run) };
    }
}

/// Any number of a state of what sticks, changed, is refused or goes on; a list of more actuators that hold a joint than it has
/// coordinates was once taken, and broke the next step.
#[test]
fn a_state_with_any_number_changed_is_refused_or_goes_on() {
    for text in [JOINT, TANK] {
        let plant = super::common::read(text, &super::common::options(Motion::Scenario));
        let mut state = vec![0.0; unsafe { mckibben_state_size(plant.0) }];
        let (size, mut time) = (state.len(), 0.0);
        for until in [1e-3, 0.02, 0.5] {
            unsafe {
                assert_eq!(mckibben_advance(plant.0, until, null(), 0), Status::Ok, "{}", last_error());
                assert_eq!(mckibben_save(plant.0, state.as_mut_ptr(), size), Status::Ok);
            }
            for place in 0..size {
                for changed in [0.0, 1.0, 2.0, 3.0, -1.0] {
                    let mut numbers = state.clone();
                    numbers[place] = changed;
                    let restored = unsafe { mckibben_restore(plant.0, numbers.as_ptr(), size) };
                    unsafe { mckibben_time(plant.0, &raw mut time) };
                    let advanced = unsafe { mckibben_advance(plant.0, time + 2e-3, null(), 0) };
                    for status in [restored, advanced] {
                        assert!(!matches!(status, Status::Defect | Status::Busy), "number {place}: {}", last_error());
                    }
                }
            }
            assert_eq!(unsafe { mckibben_restore(plant.0, state.as_ptr(), size) }, Status::Ok);
        }
    }
}

#[test]
fn any_calls_with_any_values_return() {
    let limit = Duration::from_secs(chosen("MCKIBBEN_FUZZ_SECONDS", 2));
    let seed = chosen("MCKIBBEN_FUZZ_SEED", 1);
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let (begun, mut seen, mut slowest) = (Instant::now(), Seen::default(), Duration::ZERO);
    while begun.elapsed() < limit {
        if random.chance(4) {
            simulate(&mut random, &mut seen);
        }
        let Some(mut plant) = read(&mut random, &mut seen) else { continue };
        let mut saved = Vec::new();
        for _ in 0..random.below(60) {
            let at = Instant::now();
            call(&mut random, &mut seen, plant, &mut saved);
            slowest = slowest.max(at.elapsed());
        }
        let mut copy = null_mut();
        if seen.note(unsafe { mckibben_plant_clone(plant, &raw mut copy) }, "plant_clone") {
            unsafe { mckibben_plant_free(plant) };
            plant = copy;
            (0..5).for_each(|_| call(&mut random, &mut seen, plant, &mut saved));
        }
        unsafe { mckibben_plant_free(plant) };
    }
    println!("seed {seed}: {seen:?}, slowest call {slowest:?}");
    assert!(seen.read > 3 && seen.done > 20 && seen.refused > 20, "{seen:?}");
}
