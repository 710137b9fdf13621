//! Whole runs.

use super::common::{MUSCLE, last_error, options, read, text};
use mckibben_c::plant::*;
use mckibben_c::simulation::*;
use mckibben_c::status::Status;
use mckibben_run::record::Values;
use mckibben_run::run::Ready;
use mckibben_run::settle::End;
use mckibben_scenario::Document;
use std::ffi::{CString, c_void};
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

unsafe extern "C" fn stop_late(time: f64, data: *mut c_void) -> i32 {
    let last = unsafe { &mut *data.cast::<f64>() };
    *last = time;
    i32::from(time > 0.05)
}

/// The columns are those of a run in Rust, to the same bits.
#[test]
fn a_run_has_the_columns_of_one_in_rust() {
    let document = Document::parse(MUSCLE, "muscle.toml").expect("TOML");
    let finished =
        Ready::of(&document).expect("a run").run(&document, End::Duration, &mut |_| Ok(())).expect("an end").0;
    let expected = finished.columns().expect("columns");
    let (scenario, mut run) = (CString::new(MUSCLE).expect("text"), null_mut());
    unsafe {
        let status = mckibben_simulate_text(scenario.as_ptr(), null(), None, null_mut(), &raw mut run);
        assert_eq!(status, Status::Ok, "{}", last_error());
        let rows = mckibben_run_row_count(run);
        assert_eq!(mckibben_run_column_count(run), expected.len());
        for (index, column) in expected.iter().enumerate() {
            let mut info = MaybeUninit::<ColumnInfo>::uninit();
            assert_eq!(mckibben_run_column_describe(run, index, info.as_mut_ptr()), Status::Ok);
            let info = info.assume_init();
            assert_eq!((text(info.name), text(info.unit)), (column.name.clone(), column.unit.clone()));
            let mut own = vec![f64::NAN; rows];
            let status = mckibben_run_column(run, index, own.as_mut_ptr(), rows);
            match &column.values {
                Values::Numbers(numbers) => assert_eq!((status, info.has_words, &own), (Status::Ok, 0, numbers)),
                Values::Words(words) => {
                    assert_eq!((status, info.has_words), (Status::Input, 1));
                    let own: Vec<String> = (0..rows).map(|row| text(mckibben_run_word(run, index, row))).collect();
                    assert_eq!(own, *words);
                }
            }
            assert!(mckibben_run_word(run, index, rows).is_null());
        }
        assert!(expected.iter().any(|column| matches!(column.values, Values::Words(_))));
        let mut one = 0.0;
        assert_eq!(mckibben_run_column(run, 0, &raw mut one, 1), Status::Count, "{}", last_error());
        assert_eq!(mckibben_run_column(run, 999, &raw mut one, 1), Status::Input);
        assert_eq!(mckibben_run_column(null(), 0, &raw mut one, 1), Status::Pointer);
        assert!(mckibben_run_word(null(), 0, 0).is_null());
        mckibben_run_free(run);
        mckibben_run_free(null_mut());
    }
}

/// Outputs are the columns of a run that are numbers, without the time and set points, then contractions; under the names of parts.
#[test]
fn outputs_are_columns_under_the_names_of_parts() {
    let examples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let regulator = std::fs::read_to_string(examples.join("valves/pressure-regulator.toml")).expect("the example");
    let joint = std::fs::read_to_string(examples.join("valves/five-way-joint.toml")).expect("the example");
    let joint = joint.replace("[run]", "[run]\nstep = \"0.5 ms\"");
    for (scenario, parts) in [
        (MUSCLE, [("actuator.", "")].as_slice()),
        (&regulator, &[("actuator.", "")]),
        (&joint, &[("agonist.", ""), ("antagonist.", "antagonist_"), ("joint.", "")]),
    ] {
        // Only the joint moves itself, so that its angle is an output.
        let motion = if parts.len() == 1 { Motion::Host } else { Motion::Scenario };
        let plant = read(scenario, &options(motion));
        let document = Document::parse(scenario, "scenario.toml").expect("TOML");
        let finished = Ready::of(&document).and_then(|ready| ready.run(&document, End::Duration, &mut |_| Ok(())));
        let columns = finished.expect("an end").0.columns().expect("columns");
        let numbers = columns.iter().filter(|column| matches!(column.values, Values::Numbers(_)));
        let mut expected: Vec<&str> = numbers.map(|column| column.name.as_str()).collect();
        assert_eq!(expected.remove(0), "time_s");
        expected.retain(|name| !name.starts_with("set_point"));
        for index in 0..unsafe { mckibben_output_count(plant.0) } {
            let mut info = MaybeUninit::<OutputInfo>::uninit();
            assert_eq!(unsafe { mckibben_output_describe(plant.0, index, info.as_mut_ptr()) }, Status::Ok);
            let info = unsafe { info.assume_init() };
            let (name, unit) = (text(info.name), text(info.unit));
            if name.ends_with(".contraction") {
                assert_eq!(unit, "");
                continue;
            }
            let (part, column) = parts.iter().find(|(part, _)| name.starts_with(part)).expect("a part");
            let ending = unit.to_lowercase().replace(['/', '*'], "_");
            let due = format!("{column}{}_{ending}", &name[part.len()..]);
            let place = expected.iter().position(|its| *its == due).unwrap_or_else(|| panic!("{name} [{unit}]: {due}"));
            expected.remove(place);
        }
        assert!(expected.is_empty(), "columns that are no outputs: {expected:?}");
    }
}

/// A caller ends a run by its progress function.
#[test]
fn a_run_can_be_ended() {
    let (scenario, mut last) = (CString::new(MUSCLE.replace("0.1 s", "100 s")).expect("text"), 0.0_f64);
    let mut run = std::ptr::dangling_mut();
    let data = (&raw mut last).cast::<c_void>();
    let status = unsafe { mckibben_simulate_text(scenario.as_ptr(), null(), Some(stop_late), data, &raw mut run) };
    assert_eq!(status, Status::Stopped, "{}", last_error());
    assert!(run.is_null() && last > 0.05 && last < 100.0);
    let missing = unsafe { mckibben_simulate_file(c"no such file".as_ptr(), None, null_mut(), &raw mut run) };
    assert_eq!(missing, Status::Input);
}
