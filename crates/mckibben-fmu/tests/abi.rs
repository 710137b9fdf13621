//! Units as C calls them: the trajectory of the core, states that are saved, and wrong use that is refused.

mod common;

use common::*;
use mckibben_fmu::options::{Interfaces, UnitOptions, Version};
use mckibben_fmu::variables::Causality;
use mckibben_run::host::{HostPlant, Motion};
use mckibben_scenario::Document;
use std::ffi::CStr;

fn scenario() -> UnitOptions {
    UnitOptions { motion: Motion::Scenario, ..UnitOptions::default() }
}

/// The outputs of a plant.
fn outputs(plant: &mut HostPlant) -> Vec<f64> {
    let mut all = vec![0.0; plant.outputs().len()];
    plant.read_outputs(&mut all).expect("as many");
    all
}

/// Steps of co-simulation are those of the host's plant, to the bit, where the host moves the ends.
#[test]
fn a_host_that_moves_has_the_trajectory_of_the_core() {
    let (unit, messages) = (Unit::new(MUSCLE, &UnitOptions::default()), Messages::default());
    let handle = unit.co_simulation(&messages, false);
    let (duty, distance) = (unit.reference("actuator.duty"), unit.reference("actuator.distance"));
    assert_eq!(set(handle, duty, 0.8), OK);
    initialise(handle);
    let mut plant = unit.model.plant().clone();
    plant.command(0, 0.8).expect("a duty cycle");
    let columns: Vec<u32> = plant.outputs().iter().map(|column| unit.reference(&column.name)).collect();
    for k in 0..200_u32 {
        let (time, length) = (f64::from(k) * 1e-3, 0.09 - 1e-5 * f64::from(k % 40));
        assert_eq!(set(handle, distance, length), OK);
        assert_eq!(step(handle, time, 1e-3), (OK, time + 1e-3, false));
        plant.advance(time + 1e-3, &[length]).expect("a step");
    }
    let found: Vec<f64> = columns.iter().map(|column| get(handle, *column)).collect();
    assert_eq!(found, outputs(&mut plant));
    assert_eq!(get(handle, unit.reference("tensions")), get(handle, unit.reference("actuator.tension")));
    // SAFETY: an instance.
    unsafe {
        assert_eq!(fmi3Terminate(handle), OK);
        fmi3FreeInstance(handle);
    }
}

/// A scenario that moves has the trajectory of the core by FMI 3.0 and by FMI 2.0, from any start time.
#[test]
fn a_scenario_that_moves_has_the_trajectory_of_the_core() {
    let (unit, messages) = (Unit::new(MUSCLE, &scenario()), Messages::default());
    let (duty, length) = (unit.reference("actuator.duty"), unit.reference("actuator.length"));
    let mut plant = unit.model.plant().clone();
    plant.command(0, 0.8).expect("a duty cycle");
    let handle = unit.co_simulation(&messages, false);
    assert_eq!(set(handle, duty, 0.8), OK);
    initialise(handle);
    let callbacks =
        Callbacks { logger: None, allocate: 0, free: 0, step_finished: 0, environment: std::ptr::null_mut() };
    let resources = std::ffi::CString::new(format!("file://{}", unit.folder.display())).expect("a text");
    // SAFETY: texts and functions that live, references and values.
    let second =
        unsafe { fmi2Instantiate(c"muscle".as_ptr(), 1, unit.token.as_ptr(), resources.as_ptr(), &callbacks, 0, 0) };
    assert!(!second.is_null());
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi2SetupExperiment(second, 1, 1e-6, 10.0, 0, 0.0), OK);
        assert_eq!(fmi2EnterInitializationMode(second), OK);
        assert_eq!(fmi2SetReal(second, &duty, 1, &0.8), OK);
        assert_eq!(fmi2ExitInitializationMode(second), OK);
    }
    let mut now = 0.0;
    for k in 0..150_u32 {
        let h = [1e-3, 0.3e-3, 2e-3][k as usize % 3];
        plant.advance(now + h, &[]).expect("a step");
        assert_eq!(step(handle, now, h).0, OK);
        // SAFETY: as above.
        assert_eq!(unsafe { fmi2DoStep(second, 10.0 + now, h, 1) }, OK);
        now += h;
    }
    let place = plant.outputs().iter().position(|column| column.name == "actuator.length").expect("a length");
    assert_eq!(get(handle, length), outputs(&mut plant)[place]);
    let mut value = 0.0;
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi2GetReal(second, &length, 1, &mut value), OK);
        assert_eq!(fmi2Terminate(second), OK);
        fmi2FreeInstance(second);
        fmi3FreeInstance(handle);
    }
    assert!((value - outputs(&mut plant)[place]).abs() < 1e-9, "by FMI 2.0, at times that are rounded otherwise");
}

/// A state that was saved, also as bytes, goes on to the same bits in another instance.
#[test]
fn a_saved_state_goes_on_bit_for_bit() {
    let (unit, messages) = (Unit::new(MUSCLE, &UnitOptions::default()), Messages::default());
    let [first, second] = [(); 2].map(|()| unit.co_simulation(&messages, false));
    let (duty, tension) = (unit.reference("actuator.duty"), unit.reference("actuator.tension"));
    initialise(first);
    assert_eq!(set(first, duty, 0.7), OK);
    let go = |handle, from: u32, to: u32| {
        (from..to).for_each(|k| assert_eq!(step(handle, f64::from(k) * 1e-3, 1e-3).0, OK));
    };
    go(first, 0, 60);
    let (mut state, mut other, mut size) = (NULL, NULL, 0);
    // SAFETY: room for handles, sizes and bytes.
    unsafe {
        assert_eq!(fmi3GetFMUState(first, &mut state), OK);
        assert_eq!(fmi3SerializedFMUStateSize(first, state, &mut size), OK);
        let mut bytes = vec![0_u8; size];
        assert_eq!(fmi3SerializeFMUState(first, state, bytes.as_mut_ptr(), size), OK);
        assert_eq!(fmi3SerializeFMUState(first, state, bytes.as_mut_ptr(), size - 1), ERROR);
        go(first, 60, 150);
        assert_eq!(fmi3DeserializeFMUState(second, bytes.as_ptr(), size, &mut other), OK);
        assert_eq!(fmi3SetFMUState(second, other), OK);
        go(second, 60, 150);
        let there = get(first, tension);
        assert_eq!(get(second, tension), there);
        assert_eq!(fmi3SetFMUState(first, state), OK);
        go(first, 60, 150);
        assert_eq!(get(first, tension), there);
        bytes[20] ^= 1;
        assert_eq!(fmi3DeserializeFMUState(second, bytes.as_ptr(), size, &mut other), ERROR);
        assert_eq!(fmi3DeserializeFMUState(second, bytes.as_ptr(), size / 2, &mut other), ERROR);
        assert_eq!(fmi3FreeFMUState(first, &mut state), OK);
        assert!(state.is_null());
        assert_eq!(fmi3SetFMUState(first, state), ERROR);
        for handle in [first, second] {
            fmi3FreeInstance(handle);
        }
    }
}

/// An example of the repository.
fn example(path: &str) -> Document {
    Document::load(format!("{}/../../examples/{path}", env!("CARGO_MANIFEST_DIR"))).expect("an example")
}

/// The core's plant where a parameter has another value, in SI.
fn core_with(unit: &Unit, path: &str, value: f64) -> HostPlant {
    let mut document = unit.model.document().clone();
    document.set_in_si("parameter", path, &format!("{value:?}")).expect("a path");
    HostPlant::read(&document, &unit.model.options().of_host()).expect("a plant")
}

/// A parameter may move the start. Distances that the host has not set follow it, and those that it has set, be it to the start of
/// the description, are where the plant begins: either way the run is that of the core from there.
#[test]
fn the_run_begins_at_the_distances_that_the_inputs_show() {
    let mut regulated = example("valves/pressure-regulator.toml");
    regulated.set_in_si("--set", "initial.gauge_pressure", "1e5").expect("a path");
    for (document, path, value) in [
        (example("fill-hold-exhaust.toml"), "load.mass", 1.0),
        (regulated, "initial.gauge_pressure", 2e5),
        (example("tendon.toml"), "load.mass", 2.0),
        (example("plant/arm.toml"), "mechanism.joints.elbow.angle", 0.6),
    ] {
        let (unit, messages) = (Unit::of_document(document, &UnitOptions::default()), Messages::default());
        let names = unit.model.plant().actuators();
        let of = |what: &str| names.iter().map(|name| unit.reference(&format!("{name}.{what}"))).collect::<Vec<u32>>();
        let (references, array) = (of("distance"), unit.reference("distances"));
        let distances = |plant: &HostPlant| (0..names.len()).map(|its| plant.distance(its)).collect::<Vec<f64>>();
        let described = distances(unit.model.plant());
        for (is_set, is_exchange) in [(false, false), (true, false), (false, true), (true, true)] {
            let mut core = core_with(&unit, path, value);
            assert_ne!(distances(&core), described, "{path} moves the start");
            if is_set {
                core.begin_at(&described, &vec![0.0; names.len()]).expect("distances");
            }
            let begin = distances(&core);
            let handle =
                if is_exchange { unit.model_exchange(&messages) } else { unit.co_simulation(&messages, false) };
            let shown = || references.iter().map(|its| get(handle, *its)).collect::<Vec<f64>>();
            if is_set && is_exchange {
                references.iter().zip(&described).for_each(|(its, start)| assert_eq!(set(handle, *its, *start), OK));
            } else if is_set {
                // SAFETY: one reference and as many values as the array has.
                let status = unsafe { fmi3SetFloat64(handle, &array, 1, described.as_ptr(), names.len()) };
                assert_eq!(status, OK);
            }
            assert_eq!(set(handle, unit.reference(path), value), OK, "{}", messages.take());
            assert_eq!(shown(), begin, "{path}, set: {is_set}");
            for index in 0..core.commands().len() {
                let input = core.commands()[index].name.clone();
                core.command(index, get(handle, unit.reference(&input))).expect("a command");
            }
            initialise(handle);
            if is_exchange {
                update(handle);
                let expected = outputs(&mut core);
                let columns = core.outputs().iter().map(|column| column.name.as_str()).zip(expected);
                for (name, length) in columns.filter(|(name, _)| name.ends_with(".length")) {
                    let found = get(handle, unit.reference(name));
                    assert!((found - length).abs() < 1e-12, "{path}, set: {is_set}: {name} is {found} for {length} m");
                }
            } else {
                assert_eq!(step(handle, 0.0, 1e-3).0, OK, "{}", messages.take());
                core.advance(1e-3, &begin).expect("a step");
                let columns = core.outputs().iter().map(|column| get(handle, unit.reference(&column.name)));
                assert_eq!(columns.collect::<Vec<f64>>(), outputs(&mut core), "{path}, set: {is_set}");
            }
            assert_eq!(shown(), begin, "{path}, set: {is_set}");
            // SAFETY: an instance.
            unsafe { fmi3FreeInstance(handle) };
        }
    }
}

/// Which distances the host has set is part of a saved state, and is forgotten by a reset.
#[test]
fn distances_that_are_set_stay_in_a_saved_state() {
    let (unit, messages) =
        (Unit::of_document(example("fill-hold-exhaust.toml"), &UnitOptions::default()), Messages::default());
    let (mass, distance) = (unit.reference("load.mass"), unit.reference("actuator.distance"));
    let start = unit.model.plant().distance(0);
    let moved = core_with(&unit, "load.mass", 1.0).distance(0);
    let [first, second] = [(); 2].map(|()| unit.co_simulation(&messages, false));
    let (mut state, mut other, mut size) = (NULL, NULL, 0);
    assert_eq!(set(first, distance, start), OK);
    // SAFETY: room for handles, sizes and bytes.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(first, false, 0.0, 0.0, false, 0.0), OK);
        assert_eq!(fmi3GetFMUState(first, &mut state), OK);
        assert_eq!(fmi3SerializedFMUStateSize(first, state, &mut size), OK);
        let mut bytes = vec![0_u8; size];
        assert_eq!(fmi3SerializeFMUState(first, state, bytes.as_mut_ptr(), size), OK);
        assert_eq!(fmi3DeserializeFMUState(second, bytes.as_ptr(), size, &mut other), OK, "{}", messages.take());
        assert_eq!(fmi3Reset(first), OK);
        assert_eq!(set(first, mass, 1.0), OK);
        assert_eq!(get(first, distance), moved, "nothing is set after a reset");
        for (handle, state) in [(first, state), (second, other)] {
            assert_eq!(fmi3SetFMUState(handle, state), OK, "{}", messages.take());
            assert_eq!(set(handle, mass, 1.0), OK);
            assert_eq!(get(handle, distance), start, "as it was set");
            fmi3FreeInstance(handle);
        }
    }
    let callbacks =
        Callbacks { logger: None, allocate: 0, free: 0, step_finished: 0, environment: std::ptr::null_mut() };
    for kind in [0, 1] {
        let mut value = 0.0;
        // SAFETY: texts and functions that live, references and values.
        unsafe {
            let (token, resources) = (unit.token.as_ptr(), unit.resources.as_ptr());
            let handle = fmi2Instantiate(c"muscle".as_ptr(), kind, token, resources, &callbacks, 0, 0);
            assert_eq!(fmi2SetReal(handle, &mass, 1, &1.0), OK);
            assert_eq!(fmi2GetReal(handle, &distance, 1, &mut value), OK);
            fmi2FreeInstance(handle);
        }
        assert_eq!(value, moved, "by FMI 2.0");
    }
}

/// The unit is not computed beyond the stop time of its run, but for rounding; an integrator may evaluate a little beyond it.
#[test]
fn the_stop_time_is_kept() {
    let (unit, messages) = (Unit::new(MUSCLE, &UnitOptions::default()), Messages::default());
    let handle = unit.co_simulation(&messages, false);
    // SAFETY: an instance.
    unsafe {
        for (start, stop, word) in
            [(f64::NAN, 1.0, "start time NaN s"), (0.0, f64::NAN, "NaN s is none"), (2.0, 1.0, "before")]
        {
            assert_eq!(fmi3EnterInitializationMode(handle, false, 0.0, start, true, stop), ERROR);
            let message = messages.take();
            assert!(message.contains(word) && !message.contains("Some"), "{message}");
        }
        assert_eq!(fmi3EnterInitializationMode(handle, false, 0.0, 0.0, true, 0.01), OK);
        assert_eq!(fmi3ExitInitializationMode(handle), OK);
    }
    assert_eq!(step(handle, 0.0, 0.009).0, OK);
    assert_eq!(step(handle, 0.009, 2e-3).0, ERROR);
    assert!(messages.take().contains("beyond the stop time of 0.01 s"));
    assert_eq!(step(handle, 0.009, 1e-3 * (1.0 + 1e-12)).0, OK, "{}", messages.take());
    assert_eq!(step(handle, 0.01, 1e-3).0, ERROR);
    let integrated = unit.model_exchange(&messages);
    let [mut again, mut end, mut nominals, mut values, mut has_next] = [false; 5];
    let mut next = 0.0;
    // SAFETY: instances, and room for each.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(integrated, false, 0.0, 1.0, true, 1.1), OK);
        assert_eq!(fmi3ExitInitializationMode(integrated), OK);
        update(integrated);
        assert_eq!(fmi3EnterContinuousTimeMode(integrated), OK);
        assert_eq!(fmi3SetTime(integrated, 1.105), OK, "{}", messages.take());
        assert_eq!(fmi3SetTime(integrated, 1.2), ERROR);
        assert_eq!(fmi3EnterEventMode(integrated), OK);
        let status = fmi3UpdateDiscreteStates(
            integrated,
            &mut again,
            &mut end,
            &mut nominals,
            &mut values,
            &mut has_next,
            &mut next,
        );
        assert_eq!(status, ERROR, "no event lies beyond the stop time");
        assert_eq!(fmi3SetTime(integrated, 1.1), OK);
        update(integrated);
        fmi3FreeInstance(integrated);
        fmi3FreeInstance(handle);
    }
    let callbacks =
        Callbacks { logger: None, allocate: 0, free: 0, step_finished: 0, environment: std::ptr::null_mut() };
    // SAFETY: texts and functions that live.
    unsafe {
        let (token, resources) = (unit.token.as_ptr(), unit.resources.as_ptr());
        let second = fmi2Instantiate(c"muscle".as_ptr(), 1, token, resources, &callbacks, 0, 0);
        assert_eq!(fmi2SetupExperiment(second, 0, 0.0, 10.0, 1, 9.0), ERROR);
        assert_eq!(fmi2SetupExperiment(second, 0, 0.0, 10.0, 1, 10.002), OK);
        assert_eq!(fmi2EnterInitializationMode(second), OK);
        assert_eq!(fmi2ExitInitializationMode(second), OK);
        assert_eq!(fmi2DoStep(second, 10.0, 1e-3, 1), OK);
        assert_eq!(fmi2DoStep(second, 10.001, 2e-3, 1), ERROR);
        assert_eq!(fmi2DoStep(second, 10.001, 1e-3, 1), OK);
        fmi2FreeInstance(second);
    }
}

/// A supply may be lower than the set points of the scenario, which the unit leaves out: for one actuator, and where it has a name.
#[test]
fn set_points_of_the_scenario_are_no_limit() {
    let named = REGULATED.replace("[command]", "[actuators.flexor.command]");
    // Named supplies are outputs as well.
    let rows = [(REGULATED, "actuator", "supply.gauge_pressure"), (&named, "flexor", "scenario.supply.gauge_pressure")];
    for (text, name, supply) in rows {
        let (unit, messages) = (Unit::new(text, &UnitOptions::default()), Messages::default());
        let (point, supply) = (unit.reference(&format!("{name}.set_point")), unit.reference(supply));
        let handle = unit.co_simulation(&messages, false);
        assert_eq!(set(handle, supply, 1e5), OK);
        assert_eq!(set(handle, point, 0.5e5), OK);
        initialise(handle);
        assert_eq!(set(handle, supply, 0.8e5), OK, "{}", messages.take());
        assert_eq!(set(handle, supply, 0.4e5), ERROR, "the set point of the host is above");
        assert_eq!(step(handle, 0.0, 1.0).0, OK, "{}", messages.take());
        let gauge = get(handle, unit.reference(&format!("{name}.gauge_pressure")));
        assert!((gauge - 0.5e5).abs() < 1e3, "{gauge} Pa");
        // SAFETY: an instance.
        unsafe { fmi3FreeInstance(handle) };
    }
}

/// Commands that have not taken effect are part of a state; of too many of them the message is in the words of the unit.
#[test]
fn too_many_commands_within_a_dead_time_are_not_saved() {
    let text = REGULATED.replace("time_constant", "dead_time = \"500 ms\"\ntime_constant");
    let (unit, messages) = (Unit::new(&text, &UnitOptions::default()), Messages::default());
    let (handle, point) = (unit.co_simulation(&messages, false), unit.reference("actuator.set_point"));
    initialise(handle);
    let mut state = NULL;
    for k in 0..80_u32 {
        assert_eq!(set(handle, point, 1e5 + 100.0 * f64::from(k)), OK);
        assert_eq!(step(handle, 1e-3 * f64::from(k), 1e-3).0, OK, "{}", messages.take());
    }
    // SAFETY: room for a handle.
    unsafe {
        assert_eq!(fmi3GetFMUState(handle, &mut state), ERROR);
        let message = messages.take();
        assert!(message.contains("within its dead time") && !message.contains("PlantSteps"), "{message}");
        fmi3FreeInstance(handle);
    }
}

/// A pressure or a mass of air that is not above zero is discarded, so that an integrator takes a shorter step; the states stay.
#[test]
fn states_without_air_are_discarded() {
    let (unit, messages) = (Unit::new(MUSCLE, &scenario()), Messages::default());
    let handle = unit.model_exchange(&messages);
    initialise(handle);
    update(handle);
    let count = unit.model.variables().states.len();
    let [mut before, mut after] = [vec![0.0; count], vec![0.0; count]];
    // SAFETY: room for the states.
    unsafe {
        assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
        assert_eq!(fmi3GetContinuousStates(handle, before.as_mut_ptr(), count), OK);
        for name in ["state.actuator.absolute_pressure", "state.actuator.air_mass"] {
            let mut states = before.clone();
            states[unit.reference(name) as usize % 65_536] *= -1.0;
            assert_eq!(fmi3SetContinuousStates(handle, states.as_ptr(), count), DISCARD);
            assert!(messages.take().contains(name));
            assert_eq!(fmi3GetContinuousStates(handle, after.as_mut_ptr(), count), OK);
            assert_eq!(after, before);
        }
        fmi3FreeInstance(handle);
    }
}

/// A parameter that is set before the run is that of the scenario; after initialisation it is refused.
#[test]
fn parameters_are_those_of_the_scenario() {
    let (unit, messages) = (Unit::new(MUSCLE, &UnitOptions::default()), Messages::default());
    let handle = unit.co_simulation(&messages, false);
    let pressure = unit.reference("initial.gauge_pressure");
    let gauge = unit.reference("actuator.gauge_pressure");
    assert_eq!(set(handle, pressure, 3e5), OK);
    let mass = unit.reference("load.mass");
    assert_eq!(set(handle, mass, -1.0), ERROR);
    assert!(messages.take().contains("load.mass"), "named");
    initialise(handle);
    assert!((get(handle, gauge) - 3e5).abs() < 1e-6);
    assert_eq!(set(handle, pressure, 2e5), ERROR);
    assert!(messages.take().contains("is fixed"));
    // SAFETY: an instance.
    unsafe {
        assert_eq!(fmi3Reset(handle), OK);
        assert_eq!(set(handle, pressure, -9e9), OK, "in range alone");
        assert_eq!(fmi3EnterInitializationMode(handle, false, 0.0, 0.0, false, 0.0), ERROR);
        assert!(messages.take().contains("initial.gauge_pressure"), "named");
        assert_eq!(fmi3Reset(handle), OK);
        initialise(handle);
        assert!((get(handle, gauge) - 40.0 * 6_894.757_293_168_361).abs() < 1e-6);
        fmi3FreeInstance(handle);
    }
}

/// Tunable parameters change while the unit runs: the pressure becomes that of the new supply, and the length that of a unit which
/// has had the new mass from the beginning. Fixed ones are refused, and a saved state has its own values.
#[test]
fn tunable_parameters_change_during_a_run() {
    let text = format!(
        "{MUSCLE}[actuator.friction]\nviscous = \"0.5 lbf*s/in\"\ncoulomb_width = \"0 m\"\n\
                        coulomb_force = \"0 N\"\n"
    );
    let (unit, messages) = (Unit::new(&text, &scenario()), Messages::default());
    let [mass, supply, damping] =
        ["load.mass", "supply.gauge_pressure", "actuator.friction.viscous"].map(|name| unit.reference(name));
    let (gauge, length) = (unit.reference("actuator.gauge_pressure"), unit.reference("actuator.length"));
    let [tuned, fixed] = [(); 2].map(|()| {
        let handle = unit.co_simulation(&messages, false);
        assert_eq!(set(handle, unit.reference("actuator.duty"), 1.0), OK);
        handle
    });
    assert_eq!(set(fixed, mass, 3.5), OK);
    assert_eq!(set(fixed, supply, 3e5), OK);
    let go = |handle, from: u32, to: u32| {
        (from..to).for_each(|k| assert_eq!(step(handle, f64::from(k) * 1e-2, 1e-2).0, OK, "{}", messages.take()));
    };
    for handle in [tuned, fixed] {
        initialise(handle);
        go(handle, 0, 30);
    }
    assert!((get(tuned, length) - get(fixed, length)).abs() > 1e-3);
    let mut saved = NULL;
    // SAFETY: room for a handle.
    assert_eq!(unsafe { fmi3GetFMUState(tuned, &mut saved) }, OK);
    let (before, mass_before) = (get(tuned, length), get(tuned, mass));
    let (references, values) = ([mass, supply], [3.5, 3e5]);
    // SAFETY: two references and two values.
    assert_eq!(unsafe { fmi3SetFloat64(tuned, references.as_ptr(), 2, values.as_ptr(), 2) }, OK);
    assert_eq!(get(tuned, length), before, "the states stay");
    for (name, value, word) in [
        ("load.mass", -1.0, "load.mass"),
        ("initial.gauge_pressure", 2e5, "is fixed"),
        ("actuator.friction.coulomb_force", 5.0, "cannot gain"),
    ] {
        assert_eq!(set(tuned, unit.reference(name), value), ERROR);
        assert!(messages.take().contains(word), "{name}");
    }
    assert_eq!(set(tuned, damping, 200.0), OK);
    go(tuned, 30, 400);
    go(fixed, 30, 400);
    assert!((get(tuned, gauge) - 3e5).abs() < 1.0, "{} Pa", get(tuned, gauge));
    assert!((get(tuned, length) - get(fixed, length)).abs() < 1e-8, "{} m", get(tuned, length) - get(fixed, length));
    // SAFETY: a state and instances.
    unsafe {
        assert_eq!(fmi3SetFMUState(tuned, saved), OK);
        assert_eq!(get(tuned, length), before);
        assert_eq!(get(tuned, mass), mass_before);
        assert_eq!(fmi3FreeFMUState(tuned, &mut saved), OK);
        fmi3FreeInstance(tuned);
        fmi3FreeInstance(fixed);
    }
}

/// In model exchange tunable parameters take effect at events: then the rates are those of the new values.
#[test]
fn tunable_parameters_of_model_exchange_change_at_events() {
    let (unit, messages) = (Unit::new(MUSCLE, &scenario()), Messages::default());
    let (mass, rate) = (unit.reference("load.mass"), unit.reference("der(state.actuator.load.rate)"));
    let handle = unit.model_exchange(&messages);
    initialise(handle);
    update(handle);
    // The mass hangs: g minus the tension over the mass.
    let tension = get(handle, unit.reference("actuator.tension"));
    let (of, to) = (get(handle, mass), 4.0);
    let acceleration = |mass: f64| 9.806_65 - tension / mass;
    assert!((get(handle, rate) - acceleration(of)).abs() < 1e-9, "{}", get(handle, rate));
    assert_eq!(set(handle, mass, to), OK);
    update(handle);
    assert!((get(handle, rate) - acceleration(to)).abs() < 1e-9, "{}", get(handle, rate));
    // SAFETY: an instance.
    unsafe {
        assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
        assert_eq!(set(handle, mass, of), OK);
        assert!((get(handle, rate) - acceleration(to)).abs() < 1e-9, "in continuous time nothing jumps");
        assert_eq!(fmi3EnterEventMode(handle), OK);
        update(handle);
        assert!((get(handle, rate) - acceleration(of)).abs() < 1e-9);
        fmi3FreeInstance(handle);
    }
}

/// With event mode a step ends where a valve moves, at the instants of the pulses.
#[test]
fn steps_return_early_at_the_valve() {
    let (unit, messages) = (Unit::new(MUSCLE, &UnitOptions::default()), Messages::default());
    let handle = unit.co_simulation(&messages, true);
    assert_eq!(set(handle, unit.reference("actuator.duty"), 0.5), OK);
    initialise(handle);
    update(handle);
    // SAFETY: an instance.
    assert_eq!(unsafe { fmi3EnterStepMode(handle) }, OK);
    let (mut time, mut edges) = (0.0, Vec::new());
    while time < 0.1 {
        let (status, reached, early) = step(handle, time, 0.1 - time);
        assert_eq!(status, OK, "{}", messages.take());
        time = reached;
        if early {
            edges.push(reached);
            // SAFETY: an instance.
            unsafe {
                assert_eq!(fmi3EnterEventMode(handle), OK);
                update(handle);
                assert_eq!(fmi3EnterStepMode(handle), OK);
            }
        }
    }
    assert!((4..=8).contains(&edges.len()), "{edges:?}");
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// A duty cycle that is set at an early return is that of the next period, however long the step was to be.
#[test]
fn a_command_at_an_early_return_counts_from_the_next_period() {
    let fine = UnitOptions { max_step: Some(5e-5), ..UnitOptions::default() };
    let (unit, messages) = (Unit::new(MUSCLE, &fine), Messages::default());
    let duty = unit.reference("actuator.duty");
    let pressure = |longest: f64| {
        let handle = unit.co_simulation(&messages, true);
        assert_eq!(set(handle, duty, 0.5), OK);
        initialise(handle);
        update(handle);
        // SAFETY: an instance.
        assert_eq!(unsafe { fmi3EnterStepMode(handle) }, OK);
        let (mut time, mut is_set) = (0.0, false);
        while time < 0.2 {
            let (status, reached, early) = step(handle, time, longest.min(0.2 - time));
            assert_eq!(status, OK, "{}", messages.take());
            time = reached;
            if early {
                // SAFETY: an instance.
                assert_eq!(unsafe { fmi3EnterEventMode(handle) }, OK);
                if time > 0.03 && !is_set {
                    assert_eq!(set(handle, duty, 0.9), OK);
                    is_set = true;
                }
                update(handle);
                // SAFETY: an instance.
                assert_eq!(unsafe { fmi3EnterStepMode(handle) }, OK);
            }
        }
        let found = get(handle, unit.reference("actuator.gauge_pressure"));
        // SAFETY: an instance.
        unsafe { fmi3FreeInstance(handle) };
        found
    };
    let (long, short) = (pressure(0.2), pressure(3.7e-3));
    assert!((long - short).abs() < 200.0, "{long} Pa by long steps, {short} Pa by short ones");
}

/// A step that ends where a poppet arrives reports the event as one that returns early there does: 4 ms after the command.
#[test]
fn an_event_at_the_end_of_a_step_is_reported() {
    let options = UnitOptions { command_mode: Some("request".to_owned()), ..scenario() };
    let (unit, messages) = (Unit::new(DELAYED, &options), Messages::default());
    for (size, count, is_early) in [(1e-3, 4, false), (4e-3, 1, false), (3e-3, 2, true)] {
        let handle = unit.co_simulation(&messages, true);
        assert_eq!(set(handle, unit.reference("actuator.request"), 1.0), OK);
        initialise(handle);
        update(handle);
        // SAFETY: an instance.
        assert_eq!(unsafe { fmi3EnterStepMode(handle) }, OK);
        let mut time = 0.0;
        for k in 1..=count {
            let (status, reached, early, event) = step_to_event(handle, time, size);
            assert_eq!(status, OK, "{}", messages.take());
            assert_eq!((early, event), (is_early && k == count, k == count), "step {k} of {size} s");
            time = reached;
        }
        assert!((time - 4e-3).abs() < 1e-12, "{time} s");
        // SAFETY: an instance.
        unsafe {
            assert_eq!(fmi3EnterEventMode(handle), OK);
            update(handle);
            assert_eq!(fmi3EnterStepMode(handle), OK);
        }
        let (_, _, early, event) = step_to_event(handle, time, size);
        assert!(!early && !event, "it is reported once");
        // SAFETY: an instance.
        unsafe { fmi3FreeInstance(handle) };
    }
}

/// The event indicators of an instance.
fn indicators(handle: Handle, unit: &Unit) -> Vec<f64> {
    let mut values = vec![f64::NAN; unit.model.variables().indicators];
    // SAFETY: room for them.
    assert_eq!(unsafe { fmi3GetEventIndicators(handle, values.as_mut_ptr(), values.len()) }, OK);
    values
}

/// A poppet that arrives at an instant has arrived for what the host sets at that instant: the valve fills, and shuts after its
/// closing delay alone. So it does with a dead time, and where the opening delay changes then.
#[test]
fn what_is_set_at_an_instant_comes_after_what_is_due_there() {
    let options = UnitOptions { command_mode: Some("request".to_owned()), ..scenario() };
    let late = DELAYED.replace("opening_delay", "dead_time = \"2 ms\"\nopening_delay");
    for (text, arrival) in [(DELAYED, 4e-3), (late.as_str(), 6e-3)] {
        let (unit, messages) = (Unit::new(text, &options), Messages::default());
        let [request, delay, flow] =
            ["actuator.request", "valve.opening_delay", "actuator.mass_flow"].map(|name| unit.reference(name));
        for (reference, value) in [(request, 0.0), (delay, 6e-3)] {
            let handle = unit.model_exchange(&messages);
            assert_eq!(set(handle, request, 1.0), OK);
            initialise(handle);
            let mut next = update(handle);
            // SAFETY: an instance.
            let go = |next: f64| unsafe {
                assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
                assert_eq!(fmi3SetTime(handle, next), OK, "{}", messages.take());
                assert_eq!(fmi3EnterEventMode(handle), OK);
            };
            while next < arrival - 1e-9 {
                go(next);
                next = update(handle);
            }
            assert!((next - arrival).abs() < 1e-12, "it arrives at {next} s");
            go(next);
            assert_eq!(get(handle, flow), 0.0, "not before the update");
            assert_eq!(set(handle, reference, value), OK, "{}", messages.take());
            next = update(handle);
            assert!(get(handle, flow) > 0.0, "it fills");
            while reference == request && next < f64::INFINITY {
                assert!(next <= arrival + 6e-3 + 1e-12, "{next} s");
                assert!(get(handle, flow) > 0.0, "it fills until it shuts");
                go(next);
                next = update(handle);
            }
            assert_eq!(get(handle, flow) > 0.0, reference == delay);
            // SAFETY: an instance.
            unsafe { fmi3FreeInstance(handle) };
        }
    }
}

/// Where the host moves the ends, a rate that leaves zero after the start has an event, at which the tension jumps by the dry
/// friction of the scenario, 5 N. No indicator is zero.
#[test]
fn a_rate_that_leaves_zero_has_an_event() {
    let (unit, messages) = (Unit::new(DRY, &UnitOptions::default()), Messages::default());
    let (rate, tension) = (unit.reference("actuator.rate"), unit.reference("actuator.tension"));
    for velocity in [1e-3, -1e-3] {
        let handle = unit.model_exchange(&messages);
        initialise(handle);
        update(handle);
        // SAFETY: an instance.
        assert_eq!(unsafe { fmi3EnterContinuousTimeMode(handle) }, OK);
        assert!(indicators(handle, &unit).iter().all(|value| *value > 0.0));
        let rest = get(handle, tension);
        assert_eq!(set(handle, rate, velocity), OK);
        assert!((get(handle, tension) - rest).abs() < 1e-9, "the mode holds until the event");
        assert_eq!(indicators(handle, &unit).iter().filter(|value| **value < 0.0).count(), 1);
        // SAFETY: an instance.
        unsafe {
            assert_eq!(fmi3EnterEventMode(handle), OK);
            update(handle);
            assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
        }
        let jump = get(handle, tension) - rest;
        assert!((jump - 5.0 * velocity.signum()).abs() < 1e-9, "{jump} N");
        assert!(indicators(handle, &unit).iter().all(|value| *value > 0.0));
        // SAFETY: an instance.
        unsafe { fmi3FreeInstance(handle) };
    }
}

/// Numbers from 0 to 1 that are alike in each run, by Knuth's linear congruential generator.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn of(&mut self, all: &[f64]) -> f64 {
        all[self.between(0.0, all.len() as f64) as usize]
    }
}

/// A unit of [`MAPPED`] for model exchange, at its start, with its states and the places in them of the pressures of muscle and hose
/// and of the mass of air.
fn mapped(messages: &Messages) -> (Unit, Handle, Vec<f64>, [usize; 3]) {
    let options = UnitOptions { command_mode: Some("request".to_owned()), ..UnitOptions::default() };
    let unit = Unit::new(MAPPED, &options);
    let handle = unit.model_exchange(messages);
    initialise(handle);
    update(handle);
    let mut states = vec![0.0; unit.model.variables().states.len()];
    // SAFETY: room for the states.
    unsafe {
        assert_eq!(fmi3GetContinuousStates(handle, states.as_mut_ptr(), states.len()), OK);
        assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
    }
    let names = ["absolute_pressure", "hose_absolute_pressure", "air_mass"];
    let places = names.map(|name| unit.reference(&format!("state.actuator.{name}")) as usize % 65_536);
    (unit, handle, states, places)
}

fn put(handle: Handle, states: &[f64]) {
    // SAFETY: an instance and its states.
    assert_eq!(unsafe { fmi3SetContinuousStates(handle, states.as_ptr(), states.len()) }, OK);
}

/// A step of a host may pass several borders at once. After one update no indicator lies below zero by more than rounding, the
/// tension is that of a plant whose laws take the pieces of its state, and the mass of air changes by the flow; a second update
/// changes nothing.
#[test]
fn one_update_crosses_all_borders_that_were_passed() {
    let messages = Messages::default();
    let (unit, handle, mut states, [pressure, hose, mass]) = mapped(&messages);
    let [distance, rate, request] =
        ["distance", "rate", "request"].map(|name| unit.reference(&format!("actuator.{name}")));
    let read = ["actuator.tension", "actuator.mass_flow", "der(state.actuator.air_mass)", "actuator.gauge_pressure"];
    let read = |handle| read.map(|name| get(handle, unit.reference(name)));
    let mut core = unit.model.plant().clone();
    let (mut random, mut passed) = (Random(3), 0);
    for jump in 0..200 {
        let factor = random.between(1.1e5, 7.5e5) / states[pressure];
        states[pressure] *= factor;
        states[mass] *= factor;
        states[hose] = states[pressure] * (1.0 + random.of(&[1e-4, 1e-2, 0.3]) * random.between(-1.0, 1.0));
        put(handle, &states);
        // SAFETY: an instance.
        assert_eq!(unsafe { fmi3EnterEventMode(handle) }, OK);
        let ends = [random.between(0.069, 0.09), random.of(&[-0.5, -0.01, 0.01, 0.3, 0.5])];
        for (input, value) in [(distance, ends[0]), (rate, ends[1]), (request, random.of(&[-1.0, 0.0, 1.0]))] {
            assert_eq!(set(handle, input, value), OK, "{}", messages.take());
        }
        passed += indicators(handle, &unit).iter().filter(|value| **value < 0.0).count();
        update(handle);
        let guards = indicators(handle, &unit);
        let size = guards.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
        assert!(guards.iter().all(|value| *value > -1e-12 * size), "jump {jump}: {guards:?}");
        let found = read(handle);
        let [tension, flow, change, gauge] = found;
        core.steps_mut().set_pressure(0, mckibben::GaugePressure(gauge)).expect("a pressure");
        let mut response = [core.steps_mut().compute(0).expect("a response")];
        core.compute_at(&[ends[0]], &[ends[1]], &mut response).expect("a response");
        let expected = response[0].tension;
        assert!((tension - expected).abs() <= 1e-6 * (1.0 + expected), "jump {jump}: {tension} for {expected} N");
        assert!((flow - change).abs() <= 1e-6 * flow.abs() + 1e-12, "jump {jump}: {change} for {flow} kg/s");
        update(handle);
        for (again, found) in read(handle).into_iter().zip(found) {
            assert!((again - found).abs() <= 1e-6 * found.abs() + 1e-12, "jump {jump}: {again} after {found}");
        }
        // SAFETY: an instance.
        assert_eq!(unsafe { fmi3EnterContinuousTimeMode(handle) }, OK);
    }
    assert!(passed > 200, "{passed} borders");
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// An integrator may find a border by its steps where the rates of the unit lead back from it. The flow in a hose that settles behind a
/// shut valve falls: where a host has it above the border of laminar flow by a rounding, the update still enters the next piece, and
/// no indicator stays below zero.
#[test]
fn a_border_that_is_found_is_crossed_whatever_the_rates() {
    let messages = Messages::default();
    let (unit, handle, mut states, [pressure, hose, mass]) = mapped(&messages);
    let event = |states: &[f64]| {
        put(handle, states);
        // SAFETY: an instance.
        unsafe {
            assert_eq!(fmi3EnterEventMode(handle), OK);
            update(handle);
            assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
        }
    };
    let calm = 3e5;
    states[mass] *= calm / states[pressure];
    (states[pressure], states[hose]) = (calm, calm * (1.0 + 1e-6));
    event(&states);
    // The least drop in pressure, to rounding, at which an indicator is below zero.
    let [mut low, mut high] = [0.0, 3e4];
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        states[hose] = calm + middle;
        put(handle, &states);
        if indicators(handle, &unit).iter().any(|value| *value < 0.0) { high = middle } else { low = middle }
    }
    states[hose] = calm + high;
    put(handle, &states);
    let before: Vec<usize> = (0..).zip(indicators(handle, &unit)).filter(|its| its.1 < 0.0).map(|its| its.0).collect();
    assert_eq!(before.len(), 1, "the border of laminar flow alone");
    assert!(get(handle, unit.reference("der(state.actuator.hose_absolute_pressure)")) < 0.0, "the flow falls");
    event(&states);
    let guards = indicators(handle, &unit);
    assert!(guards.iter().all(|value| *value > 0.0), "{before:?}: {guards:?}");
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// Distances and rates that are set in event mode act at once, as they do in continuous time: in outputs and in derivatives.
#[test]
fn ends_that_move_in_event_mode_act_at_once() {
    let (unit, messages) = (Unit::new(MUSCLE, &UnitOptions::default()), Messages::default());
    let inputs = ["actuator.distance", "actuator.rate"].map(|name| unit.reference(name));
    let found = ["actuator.length", "actuator.velocity", "actuator.tension", "der(state.actuator.absolute_pressure)"];
    let read = |handle| found.map(|name| get(handle, unit.reference(name)));
    let go = |handle, values: [f64; 2]| {
        inputs.iter().zip(values).for_each(|(its, value)| assert_eq!(set(handle, *its, value), OK));
    };
    let handle = unit.model_exchange(&messages);
    initialise(handle);
    go(handle, [0.09, 0.02]);
    update(handle);
    // SAFETY: an instance.
    assert_eq!(unsafe { fmi3EnterContinuousTimeMode(handle) }, OK);
    go(handle, [0.0895, 0.03]);
    let expected = read(handle);
    assert!((expected[0] - 0.0895).abs() < 1e-12 && (expected[1] - 0.03).abs() < 1e-12, "{expected:?}");
    go(handle, [0.09, 0.02]);
    // SAFETY: an instance.
    assert_eq!(unsafe { fmi3EnterEventMode(handle) }, OK);
    assert_ne!(read(handle), expected);
    go(handle, [0.0895, 0.03]);
    assert_eq!(read(handle), expected);
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// In continuous time no time lies before the last event.
#[test]
fn continuous_time_does_not_go_back_beyond_an_event() {
    let (unit, messages) = (Unit::new(MUSCLE, &scenario()), Messages::default());
    let handle = unit.model_exchange(&messages);
    initialise(handle);
    update(handle);
    // SAFETY: an instance.
    unsafe {
        assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
        assert_eq!(fmi3SetTime(handle, -1e-3), ERROR);
        assert!(messages.take().contains("before the last event"));
        assert_eq!(fmi3SetTime(handle, 1e-3), OK);
        assert_eq!(fmi3SetTime(handle, 0.5e-3), OK, "an integrator interpolates back: {}", messages.take());
        assert_eq!(fmi3SetTime(handle, 1e-3), OK);
        assert_eq!(fmi3EnterEventMode(handle), OK);
        update(handle);
        assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
        assert_eq!(fmi3SetTime(handle, 0.5e-3), ERROR);
        fmi3FreeInstance(handle);
    }
}

/// A parameter that is refused is named as the variable that was set, where its key stands in many sections.
#[test]
fn a_refused_parameter_is_named_as_the_variable() {
    let (unit, messages) = (Unit::of_document(example("plant/arm.toml"), &UnitOptions::default()), Messages::default());
    let handle = unit.co_simulation(&messages, false);
    let mut refused = 0;
    for its in &unit.model.variables().all {
        if matches!(its.causality, Causality::Parameter { .. }) && set(handle, its.reference, f64::NAN) == ERROR {
            let message = messages.take();
            assert!(message.contains(&format!(": `{}` = NaN", its.name)), "{}: {message}", its.name);
            refused += usize::from(its.name.contains('.'));
        }
    }
    assert!(refused > 10, "{refused}");
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// Wrong use is an error with a message, and changes nothing.
#[test]
fn wrong_use_is_refused() {
    let (unit, messages) = (Unit::new(MUSCLE, &UnitOptions::default()), Messages::default());
    let handle = unit.co_simulation(&messages, false);
    let (duty, tension) = (unit.reference("actuator.duty"), unit.reference("actuator.tension"));
    let mut value = 0.0;
    // SAFETY: what is given is there, or null, or no handle.
    unsafe {
        assert_eq!(CStr::from_ptr(fmi3GetVersion()), c"3.0");
        for stranger in [NULL, std::ptr::without_provenance_mut(8), std::ptr::without_provenance_mut(usize::MAX)] {
            assert_eq!(fmi3Terminate(stranger), ERROR);
            fmi3FreeInstance(stranger);
        }
        assert_eq!(step(handle, 0.0, 1e-3).0, ERROR);
        assert!(messages.take().contains("called in the phase Instantiated; call it in the phase Step"));
        assert_eq!(fmi3ExitInitializationMode(handle), ERROR);
        initialise(handle);
        assert_eq!(fmi3EnterInitializationMode(handle, false, 0.0, 0.0, false, 0.0), ERROR);
        assert_eq!(fmi3EnterEventMode(handle), ERROR);
        for (references, count, values, places) in [
            (std::ptr::null(), 1, &raw mut value, 1),
            (&raw const tension, 1, std::ptr::null_mut(), 1),
            (&raw const tension, 1, &raw mut value, 0),
            (&raw const tension, 1 << 40, &raw mut value, 1),
            (&raw const tension, 1, &raw mut value, usize::MAX),
        ] {
            assert_eq!(fmi3GetFloat64(handle, references, count, values, places), ERROR);
            assert!(!messages.take().is_empty());
        }
        assert_eq!(fmi3GetFloat64(handle, &u32::MAX, 1, &mut value, 1), ERROR);
        assert_eq!(fmi3GetInt32(handle, std::ptr::null(), 0, std::ptr::null_mut(), 0), OK);
        assert_eq!(fmi3GetInt32(handle, &tension, 1, std::ptr::null_mut(), 1), ERROR);
        messages.take();
        for wrong in [1.5, -0.1, f64::NAN, f64::INFINITY] {
            assert_eq!(set(handle, duty, wrong), ERROR);
            assert!(messages.take().contains("actuator.duty"));
        }
        for wrong in [1e308, -1e308, f64::NAN] {
            assert_eq!(set(handle, unit.reference("actuator.rate"), wrong), ERROR, "the friction is no finite number");
            assert!(messages.take().contains("actuator.rate"));
        }
        assert_eq!(set(handle, tension, 1.0), ERROR);
        for (time, size) in [(1.0, 1e-3), (0.0, -1e-3), (0.0, f64::NAN), (f64::NAN, 1e-3), (0.0, f64::INFINITY)] {
            assert_eq!(step(handle, time, size).0, ERROR, "{time} {size}");
        }
        assert_eq!(fmi3SetTime(handle, 0.0), ERROR);
        assert!(messages.take().contains("made for co-simulation"));
        let before = get(handle, tension);
        assert_eq!(set(handle, unit.reference("actuator.distance"), 0.5), OK);
        assert_ne!(step(handle, 0.0, 1e-3).0, OK, "longer than the thread");
        assert_eq!(get(handle, tension), before);
        assert_eq!(set(handle, unit.reference("actuator.distance"), 0.09), OK);
        // Both directions lead where no plant goes; a shorter step leads nearer.
        messages.take();
        for (rate, words) in [(100.0, "braid straight"), (-100.0, "lead to a distance of -0.01")] {
            assert_eq!(set(handle, unit.reference("actuator.rate"), rate), OK);
            assert_eq!(step(handle, 0.0, 1e-3).0, DISCARD, "{rate} m/s");
            let message = messages.take();
            assert!(message.contains(words) && message.contains("logStatusDiscard"), "{message}");
            assert_eq!(get(handle, tension), before);
        }
        assert_eq!(set(handle, unit.reference("actuator.rate"), 0.0), OK);
        assert_eq!(step(handle, 0.0, 1e-3).0, OK, "{}", messages.take());
        fmi3FreeInstance(handle);
        assert_eq!(fmi3Terminate(handle), ERROR, "freed");
        fmi3FreeInstance(handle);
        let refused = fmi3InstantiateModelExchange(
            c"muscle".as_ptr(),
            c"{another}".as_ptr(),
            unit.resources.as_ptr(),
            false,
            false,
            messages.pointer(),
            Some(log),
        );
        assert!(refused.is_null() && messages.take().contains("of two units"));
    }
}

/// The tables of allowed calls of FMI 2.0.4 and 3.0.2: states, their rates, event indicators and directional derivatives are there from
/// initialisation on. Until it ends they are those of the parameters and inputs that have been set.
#[test]
fn states_and_derivatives_are_read_from_initialisation_on() {
    let text = format!("{MUSCLE}[actuator]\npreset = \"colbrunn-2001\"\nturns = 2.5\n");
    let (unit, messages) = (Unit::new(&text, &UnitOptions::default()), Messages::default());
    let [turns, distance, tension] =
        ["actuator.turns", "actuator.distance", "actuator.tension"].map(|name| unit.reference(name));
    let variables = unit.model.variables();
    let (count, indicators) = (variables.states.len(), variables.indicators);
    let [mut states, mut guards] = [count, indicators].map(|count| vec![0.0; count]);
    let alike = |one: f64, two: f64| (one - two).abs() <= 1e-12 * one.abs();
    // SAFETY: instances, and room for what is written.
    unsafe {
        // The stiffness in N/m of the muscle at its length.
        let stiffness = |handle: Handle| {
            let (mut slope, seed) = (0.0, 1.0);
            let status = fmi3GetDirectionalDerivative(handle, &tension, 1, &distance, 1, &seed, 1, &mut slope, 1);
            (status, slope)
        };
        let handle = unit.model_exchange(&messages);
        for status in [
            fmi3GetContinuousStates(handle, states.as_mut_ptr(), count),
            fmi3GetContinuousStateDerivatives(handle, states.as_mut_ptr(), count),
            fmi3GetEventIndicators(handle, guards.as_mut_ptr(), indicators),
            stiffness(handle).0,
        ] {
            assert_eq!(status, ERROR);
        }
        assert_eq!(messages.take().matches("called in the phase Instantiated").count(), 4);
        assert_eq!(fmi3EnterInitializationMode(handle, false, 0.0, 0.0, false, 0.0), OK);
        let (status, first) = stiffness(handle);
        assert_eq!(status, OK, "{}", messages.take());
        assert_eq!(set(handle, turns, 2.2), OK);
        let mut read = || {
            let status = fmi3GetEventIndicators(handle, guards.as_mut_ptr(), indicators);
            assert_eq!(status, OK, "{}", messages.take());
            assert_eq!(fmi3GetContinuousStates(handle, states.as_mut_ptr(), count), OK);
            let (status, slope) = stiffness(handle);
            assert_eq!(status, OK, "{}", messages.take());
            (states.clone(), slope)
        };
        let within = read();
        assert!(!alike(within.1, first), "{first} N/m, whatever the turns");
        let air_mass = unit.reference("state.actuator.air_mass") as usize % 65_536;
        assert!(within.0[air_mass] > 0.0);
        assert_eq!(fmi3ExitInitializationMode(handle), OK);
        let after = read();
        assert!(after.0 == within.0 && alike(after.1, within.1), "{after:?} {within:?}");
        assert_eq!(fmi3Terminate(handle), OK);
        assert_eq!(read(), after);
        fmi3FreeInstance(handle);
        // In co-simulation derivatives follow the parameters too.
        let stepped = unit.co_simulation(&messages, false);
        assert_eq!(stiffness(stepped).0, ERROR);
        assert_eq!(fmi3EnterInitializationMode(stepped, false, 0.0, 0.0, false, 0.0), OK);
        assert!(alike(stiffness(stepped).1, first));
        assert_eq!(set(stepped, turns, 2.2), OK);
        assert!(alike(stiffness(stepped).1, within.1), "the turns that are set");
        assert_eq!(fmi3ExitInitializationMode(stepped), OK);
        assert!(alike(stiffness(stepped).1, within.1));
        fmi3FreeInstance(stepped);
    }
}

/// Directional derivatives are those of differences, also where the pressure of the air is known from its mass and volume as
/// well.
#[test]
fn directional_derivatives_are_exact() {
    check_derivatives(MUSCLE);
    check_derivatives(&format!("{MUSCLE}\n[air]\nprocess = \"isothermal\"\n"));
}

fn check_derivatives(text: &str) {
    let (unit, messages) = (Unit::new(text, &scenario()), Messages::default());
    let handle = unit.model_exchange(&messages);
    assert_eq!(set(handle, unit.reference("actuator.duty"), 0.8), OK);
    initialise(handle);
    update(handle);
    let mut count = 0;
    // SAFETY: room for what is written.
    unsafe {
        assert_eq!(fmi3EnterContinuousTimeMode(handle), OK);
        assert_eq!(fmi3GetNumberOfContinuousStates(handle, &mut count), OK);
    }
    let (mut states, mut nominals) = (vec![0.0; count], vec![0.0; count]);
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi3GetContinuousStates(handle, states.as_mut_ptr(), count), OK);
        assert_eq!(fmi3GetNominalsOfContinuousStates(handle, nominals.as_mut_ptr(), count), OK);
    }
    let of = |block: u32| (0..count as u32).map(|index| block * 65536 + index).collect::<Vec<u32>>();
    let (knowns, mut unknowns) = (of(6), of(7));
    for name in ["actuator.tension", "actuator.gauge_pressure", "actuator.temperature", "actuator.length"] {
        unknowns.push(unit.reference(name));
    }
    let values = |states: &[f64]| {
        let mut values = vec![0.0; unknowns.len()];
        // SAFETY: as above.
        unsafe {
            assert_eq!(fmi3SetContinuousStates(handle, states.as_ptr(), count), OK);
            let status = fmi3GetFloat64(handle, unknowns.as_ptr(), unknowns.len(), values.as_mut_ptr(), unknowns.len());
            assert_eq!(status, OK);
        }
        values
    };
    for k in 0..count {
        let mut seed = vec![0.0; count];
        seed[k] = 1.0;
        let mut exact = vec![0.0; unknowns.len()];
        values(&states);
        // SAFETY: as above.
        let status = unsafe {
            fmi3GetDirectionalDerivative(
                handle,
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                count,
                seed.as_ptr(),
                count,
                exact.as_mut_ptr(),
                unknowns.len(),
            )
        };
        assert_eq!(status, OK, "{}", messages.take());
        let h = 1e-6 * nominals[k];
        let at = |sign: f64| {
            let mut there = states.clone();
            there[k] += sign * h;
            values(&there)
        };
        let (up, down) = (at(1.0), at(-1.0));
        for (place, exact) in exact.iter().enumerate() {
            let rise = (up[place] - down[place]) / (2.0 * h);
            let size = up[place].abs().max(down[place].abs()) / nominals[k];
            assert!((rise - exact).abs() <= 1e-4 * exact.abs() + 1e-8 * size, "{place} by {k}: {rise} for {exact}");
        }
    }
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// Many muscles on one network are one instance; so are instances of two units in one process.
#[test]
fn an_arm_is_one_instance() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plant/arm.toml");
    let text = Document::load(path).expect("an example").to_toml();
    let options = UnitOptions { command_mode: Some("request".to_owned()), ..UnitOptions::default() };
    let (unit, messages) = (Unit::new(&text, &options), Messages::default());
    let handle = unit.co_simulation(&messages, false);
    initialise(handle);
    let name = unit.model.plant().actuators()[0].clone();
    let gauge = unit.reference(&format!("{name}.gauge_pressure"));
    let begin = get(handle, gauge);
    let count = unit.model.plant().commands().len();
    let (reference, mut all) = (unit.reference("commands"), vec![0.0; count]);
    all[0] = 1.0;
    // SAFETY: one reference and as many values as the array has.
    unsafe {
        assert_eq!(fmi3SetFloat64(handle, &reference, 1, all.as_ptr(), count), OK);
        assert_eq!(fmi3SetFloat64(handle, &reference, 1, all.as_ptr(), count - 1), ERROR);
    }
    let message = messages.take();
    assert!(message.contains("5 values are given for `commands`, which has 6"), "{message}");
    assert_eq!(step(handle, 0.0, 0.2).0, OK, "{}", messages.take());
    assert!(get(handle, gauge) > begin + 1e4);
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// A regulator gives no more than feeds it: a set point above the supply is refused, in any order of setting the two.
#[test]
fn a_set_point_above_the_supply_is_refused() {
    let (unit, messages) = (Unit::new(REGULATED, &UnitOptions::default()), Messages::default());
    let (of, supply) = (unit.reference("actuator.set_point"), unit.reference("supply.gauge_pressure"));
    // SAFETY: instances.
    unsafe {
        let beyond = unit.co_simulation(&messages, false);
        assert_eq!(set(beyond, of, -1.0), ERROR);
        assert_eq!(set(beyond, of, 30e5), OK, "the supply may follow");
        assert_eq!(fmi3EnterInitializationMode(beyond, false, 0.0, 0.0, false, 0.0), OK);
        assert_eq!(fmi3ExitInitializationMode(beyond), ERROR);
        let message = messages.take();
        assert!(message.contains("`actuator.set_point` = 3000000.0 Pa"), "{message}");
        assert!(message.contains("more than feeds it"), "{message}");
        fmi3FreeInstance(beyond);

        let handle = unit.co_simulation(&messages, false);
        assert_eq!(set(handle, of, 7e5), OK);
        assert_eq!(set(handle, supply, 8e5), OK);
        initialise(handle);
        assert_eq!(step(handle, 0.0, 0.5).0, OK, "{}", messages.take());
        let gauge = get(handle, unit.reference("actuator.gauge_pressure"));
        assert!((gauge - 7e5).abs() < 5e3, "{gauge} Pa");
        assert_eq!(set(handle, of, 9e5), ERROR);
        assert_eq!(set(handle, supply, 6e5), ERROR, "the set point in force is above");
        let references = [of, supply];
        assert_eq!(fmi3SetFloat64(handle, references.as_ptr(), 2, [9e5, 10e5].as_ptr(), 2), OK, "both at once");
        assert_eq!(fmi3SetFloat64(handle, references.as_ptr(), 2, [3e5, 4e5].as_ptr(), 2), OK);
        assert_eq!(step(handle, 0.5, 0.5).0, OK, "{}", messages.take());
        fmi3FreeInstance(handle);
    }
}

/// A request that a valve does not have is refused with those that it has.
#[test]
fn a_request_that_the_valve_does_not_have_is_refused() {
    let options = UnitOptions { command_mode: Some("request".to_owned()), ..UnitOptions::default() };
    let (unit, messages) = (Unit::new(MUSCLE, &options), Messages::default());
    let handle = unit.co_simulation(&messages, false);
    assert_eq!(set(handle, unit.reference("actuator.request"), 0.0), ERROR);
    let message = messages.take();
    assert!(message.contains("`actuator.request` = 0.0 is not among what the valve takes"), "{message}");
    assert!(message.contains("1 (fill) or -1 (exhaust)"), "{message}");
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// The attribute of an element.
fn attribute<'t>(element: &'t str, key: &str) -> Option<&'t str> {
    element.split_once(&format!(" {key}=\""))?.1.split('"').next()
}

/// Scalars of a description of FMI 3.0: name, value reference, causality and start.
fn scalars(text: &str) -> Vec<(&str, u32, &str, Option<f64>)> {
    let elements = text.lines().filter(|line| line.trim_start().starts_with("<Float64") && line.ends_with("/>"));
    let of = |element| {
        let reference = attribute(element, "valueReference").and_then(|text| text.parse().ok()).expect("a reference");
        let start = attribute(element, "start").map(|text| text.parse().expect("a number"));
        let [name, causality] = ["name", "causality"].map(|key| attribute(element, key).expect("an attribute"));
        (name, reference, causality, start)
    };
    elements.map(of).collect()
}

/// Every start of the description is what the library returns under that reference, and outputs have the order of the library's.
fn check_starts(document: Document, options: &UnitOptions, name: &str) {
    let (unit, messages) = (Unit::of_document(document, options), Messages::default());
    let text = mckibben_fmu::description::model_description(&unit.model, "unit", Version::Three);
    let scalars = scalars(&text);
    assert!(scalars.iter().filter(|its| its.2 == "parameter").count() > 3, "{name}: parameters");
    let library = mckibben_fmu::model::Model::read(&unit.folder).expect("the resources");
    let outputs = library.plant().outputs().iter().map(|column| column.name.as_str());
    let described = scalars.iter().filter(|its| its.2 == "output").map(|its| its.0);
    assert!(described.eq(outputs), "{name}: the order of the outputs");
    let is_exchange = options.interfaces == Interfaces::ModelExchange;
    let handle = if is_exchange { unit.model_exchange(&messages) } else { unit.co_simulation(&messages, false) };
    for (variable, reference, causality, start) in &scalars {
        let own = library.variables().find(*reference).unwrap_or_else(|| panic!("{name}: {variable}"));
        assert_eq!(own.name, *variable, "{name}: the library calls {reference} otherwise");
        if let Some(start) = start {
            let found = get(handle, *reference);
            assert_eq!(found.to_bits(), start.to_bits(), "{name}: {variable} ({causality}) is {found} and not {start}");
        }
    }
    // SAFETY: an instance.
    unsafe { fmi3FreeInstance(handle) };
}

/// Description and library number the parameters alike, whatever the order of the keys in the file: those of the examples, values
/// that are set from outside, and dotted keys before plain ones.
#[test]
fn starts_of_the_description_are_those_of_the_library() {
    for motion in [Motion::Host, Motion::Scenario] {
        // No step is searched for, which takes long.
        let interfaces = if motion == Motion::Host { Interfaces::Both } else { Interfaces::ModelExchange };
        let options = UnitOptions { motion, interfaces, ..UnitOptions::default() };
        for path in [
            "plant/leg.toml",
            "plant/arm.toml",
            "plant/bottle.toml",
            "plant/controlled.toml",
            "antagonistic-joint.toml",
            "own-muscle.toml",
            "valves/cv-exhaust.toml",
        ] {
            check_starts(example(path), &options, path);
        }
        let mut set = example("paper/fig-12.toml");
        set.set_plain_from("--set", "actuator.friction.viscous", "5 N*s/m").expect("a path");
        set.set_plain_from("--set", "actuator.turns", "2.2").expect("a path");
        check_starts(set, &options, "fig-12 with --set");
    }
}

/// Shuffled keys: sub-tables and dotted keys stand before plain keys, and sections in several orders.
#[test]
fn the_order_of_keys_does_not_change_what_a_reference_means() {
    let actuator = [
        "actuator.friction.viscous = \"0.5 lbf*s/in\"",
        "actuator.turns = 2.1",
        "actuator.limit.stiffness = \"2e5 N/m\"",
        "actuator.preset = \"colbrunn-2001\"",
        "actuator.friction.coulomb_force = \"1 N\"",
        "actuator.external_volume = \"4 mL\"",
        "actuator.friction.coulomb_width = \"0 m\"",
    ];
    let mut meanings = Vec::new();
    for rotation in 0..actuator.len() {
        for is_reversed in [false, true] {
            let mut lines = actuator.to_vec();
            lines.rotate_left(rotation);
            if is_reversed {
                lines.reverse();
            }
            let text = format!("{}\n{MUSCLE}", lines.join("\n"));
            let document = Document::parse(&text, "shuffled.toml").expect("TOML");
            check_starts(document.clone(), &UnitOptions::default(), &text);
            let unit = Unit::of_document(document, &UnitOptions::default());
            let parameters = unit.model.variables().parameters.iter();
            let mut named: Vec<(String, u64)> =
                parameters.map(|number| (number.path.clone(), number.value.to_bits())).collect();
            named.sort();
            meanings.push(named);
        }
    }
    assert!(meanings.windows(2).all(|pair| pair[0] == pair[1]), "values by their names");
}

/// A unit of one interface cannot be made for the other.
#[test]
fn a_unit_of_one_interface_is_not_made_for_the_other() {
    let options = UnitOptions { interfaces: Interfaces::ModelExchange, ..scenario() };
    let (unit, messages) = (Unit::new(MUSCLE, &options), Messages::default());
    let handle = unit.model_exchange(&messages);
    // SAFETY: an instance; texts and a function that live.
    let refused = unsafe {
        fmi3FreeInstance(handle);
        fmi3InstantiateCoSimulation(
            c"muscle".as_ptr(),
            unit.token.as_ptr(),
            unit.resources.as_ptr(),
            false,
            true,
            false,
            false,
            std::ptr::null(),
            0,
            messages.pointer(),
            Some(log),
            std::ptr::null(),
        )
    };
    assert!(refused.is_null());
    let message = messages.take();
    assert!(message.contains("written for model-exchange alone"), "{message}");
}

/// Mass and damping of the joints of a chain are tunable: the rates are those of the new values.
#[test]
fn the_numbers_of_a_joint_are_tunable() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plant/leg.toml");
    let options = UnitOptions { interfaces: Interfaces::ModelExchange, ..scenario() };
    let document = Document::load(path).expect("an example");
    let heavier = {
        let mut document = document.clone();
        document.set_plain_from("--set", "mechanism.joints.knee.mass", "0.5 kg").expect("a path");
        Unit::of_document(document, &options)
    };
    let (unit, messages) = (Unit::of_document(document, &options), Messages::default());
    let rate = |unit: &Unit, handle| get(handle, unit.reference("der(state.knee.rate)"));
    let [tuned, expected] = [&unit, &heavier].map(|unit| {
        let handle = unit.model_exchange(&messages);
        initialise(handle);
        update(handle);
        handle
    });
    let before = rate(&unit, tuned);
    assert_eq!(set(tuned, unit.reference("mechanism.joints.knee.mass"), 0.5), OK, "{}", messages.take());
    assert_eq!(set(tuned, unit.reference("mechanism.joints.knee.length"), 0.5), ERROR);
    assert!(messages.take().contains("is fixed"));
    update(tuned);
    let (after, of_heavier) = (rate(&unit, tuned), rate(&heavier, expected));
    assert!((after - of_heavier).abs() <= 1e-9 * of_heavier.abs(), "{after} for {of_heavier} rad/s²");
    assert!((after - before).abs() > 1e-3, "{before} rad/s² before");
    // SAFETY: instances.
    unsafe {
        fmi3FreeInstance(tuned);
        fmi3FreeInstance(expected);
    }
}
