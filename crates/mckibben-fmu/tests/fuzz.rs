//! Random calls with random arguments: each has a status, none ends the process.
//!
//! A longer run: `MCKIBBEN_FUZZ=1000000 cargo test --package mckibben-fmu --test fuzz`.

mod common;

use common::*;
use mckibben_fmu::options::UnitOptions;
use mckibben_run::host::Motion;

/// Random numbers by SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    /// A number that a host may give, or should not.
    fn number(&mut self) -> f64 {
        match self.below(8) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => f64::from_bits(self.next()),
            3 => 0.0,
            4 => 0.09 + 1e-4 * self.below(100) as f64,
            _ => self.below(1000) as f64 / 1000.0,
        }
    }
}

#[test]
fn random_calls_have_a_status() {
    let calls = std::env::var("MCKIBBEN_FUZZ").ok().and_then(|text| text.parse().ok()).unwrap_or(6_000_u64);
    let messages = Messages::default();
    let units = [
        Unit::new(MUSCLE, &UnitOptions::default()),
        Unit::new(MUSCLE, &UnitOptions { motion: Motion::Scenario, ..UnitOptions::default() }),
    ];
    let mut random = Random(calls);
    let mut handles = Vec::new();
    let (mut state, mut done) = (NULL, [0_u64; 4]);
    for _ in 0..calls {
        if handles.len() < 3 || random.below(200) == 0 {
            let unit = &units[random.below(2) as usize];
            let handle = match random.below(3) {
                0 => unit.co_simulation(&messages, false),
                1 => unit.co_simulation(&messages, true),
                _ => unit.model_exchange(&messages),
            };
            handles.push((handle, unit));
        }
        let place = random.below(handles.len() as u64) as usize;
        let (handle, unit) = handles[place];
        let all = &unit.model.variables().all;
        let variable = &all[random.below(all.len() as u64) as usize];
        let reference = if random.below(20) == 0 { random.next() as u32 } else { variable.reference };
        let size = if random.below(10) == 0 { 4 } else { variable.dimension.unwrap_or(1) };
        let states = unit.model.variables().states.len();
        let mut numbers: Vec<f64> = (0..200).map(|_| random.number()).collect();
        let (mut now, mut flags) = (0.0, [false; 5]);
        let [a, b, c, d, e] = &mut flags;
        // SAFETY: what is given is there, or null, or no handle; lists are longer than the request.
        let status = unsafe {
            match random.below(22) {
                0 => fmi3EnterInitializationMode(handle, false, 0.0, 0.0, false, 0.0),
                1 => fmi3EnterInitializationMode(handle, true, numbers[0], numbers[1], true, numbers[2]),
                2 | 3 => fmi3ExitInitializationMode(handle),
                4 => fmi3EnterEventMode(handle),
                5 => fmi3EnterStepMode(handle),
                6 => fmi3EnterContinuousTimeMode(handle),
                7 => fmi3GetFloat64(handle, &reference, 1, numbers.as_mut_ptr(), size),
                8..10 => fmi3SetFloat64(handle, &reference, 1, numbers.as_ptr(), size),
                10 => {
                    fmi3GetFloat64(handle, &0, 1, &mut now, 1);
                    fmi3DoStep(handle, now, 1e-3, true, a, b, c, &mut numbers[0])
                }
                11 => fmi3DoStep(handle, numbers[0], numbers[1].min(0.01), true, a, b, c, std::ptr::null_mut()),
                12 => fmi3UpdateDiscreteStates(handle, a, b, c, d, e, &mut numbers[0]),
                13 => fmi3SetTime(handle, numbers[0]),
                14 => fmi3SetContinuousStates(handle, numbers.as_ptr(), states),
                15 => fmi3GetContinuousStateDerivatives(handle, numbers.as_mut_ptr(), states),
                16 => fmi3GetEventIndicators(handle, numbers.as_mut_ptr(), unit.model.variables().indicators),
                17 => fmi3GetFMUState(handle, &mut state),
                18 => fmi3SetFMUState(handle, state),
                19 => {
                    let bytes: Vec<u8> = (0..400).map(|_| random.next() as u8).collect();
                    fmi3DeserializeFMUState(handle, bytes.as_ptr(), random.below(400) as usize, &mut state)
                }
                20 if random.below(4) == 0 => fmi3Reset(handle),
                20 => fmi3GetDirectionalDerivative(
                    handle,
                    &reference,
                    1,
                    &variable.reference,
                    1,
                    numbers.as_ptr().add(10),
                    size,
                    numbers.as_mut_ptr(),
                    size,
                ),
                _ if random.below(30) == 0 => {
                    fmi3FreeInstance(handle);
                    handles.swap_remove(place);
                    fmi3Terminate(handle)
                }
                _ => fmi3CompletedIntegratorStep(handle, true, a, std::ptr::null_mut()),
            }
        };
        assert!((0..4).contains(&status), "{status}");
        done[status as usize] += 1;
        let said = messages.take();
        assert!(!said.contains("the library failed"), "{said}");
    }
    assert!(done[0] > calls / 10 && done[3] > calls / 10, "both kinds are met: {done:?}");
    // SAFETY: instances.
    handles.iter().for_each(|(handle, _)| unsafe { fmi3FreeInstance(*handle) });
}
