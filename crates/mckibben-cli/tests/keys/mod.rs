//! Every key of a scenario file matters: each is set to another valid value where it applies, and the run changes.
//!
//! The cases are in `cases.rs`. A key without a case fails, so that a new key gets one. What is compared is what the program
//! writes, so that a key which is read and then lost on its way to the engine is found too. That each number also goes to its
//! own place, and not to that of its neighbour, is tested in `mckibben-scenario`, `tests/each_parameter.rs`.

mod cases;

use crate::common::Folder;
use cases::{Case, GIVEN_JOINT_LOAD, JOINT_LOAD, OF_JOINTS, Setting, WORDS, cases, set};
use mckibben_scenario::keys::{ANTAGONIST, KEYS, is_of_antagonist};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The least change of a column, as a part of its largest magnitude, that counts as one. The runs are located to 1e-8.
const CHANGE: f64 = 1e-6;
/// The least change in the unit of the column: the largest magnitude of a column may itself be rounding.
const LEAST: f64 = 1e-10;

/// What the program writes for a scenario: the numbers of each column, or its message.
type Written = Result<BTreeMap<String, Vec<f64>>, String>;

fn written(folder: &Folder, name: &str, pieces: &[&str], settings: &[Setting]) -> Written {
    let text = pieces.concat();
    let file = format!("{name}.toml");
    folder.file(&file, &text);
    let output = format!("{name}.csv");
    let command = if text.contains("[sweep]") { "sweep" } else { "simulate" };
    let settings = settings.iter().flat_map(|(key, value)| ["-s".to_owned(), format!("{key}={value}")]);
    let settings: Vec<String> = settings.collect();
    let done = folder.mckibben().args([command, &file, "-o", &output]).args(&settings).output().expect("it runs");
    if !done.status.success() {
        return Err(String::from_utf8_lossy(&done.stderr).into_owned());
    }
    let mut reader = csv::Reader::from_path(folder.path(&output)).expect("a CSV file");
    let names: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let mut columns: BTreeMap<String, Vec<f64>> = names.iter().map(|name| (name.clone(), Vec::new())).collect();
    for record in reader.records() {
        for (name, cell) in names.iter().zip(record.expect("a line").iter()) {
            columns.get_mut(name).expect("a column").push(cell.parse().unwrap_or(0.0));
        }
    }
    if command == "sweep" {
        // In a folder the result is in parts.
        let parts = format!("{name}-parts");
        let done = folder.mckibben().args([command, &file, "-o", &parts]).args(settings).output().expect("it runs");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let count = std::fs::read_dir(folder.path(&parts)).expect("a folder").count();
        columns.insert("parts".to_owned(), vec![count as f64]);
    }
    Ok(columns)
}

/// Whether two runs differ by more than their accuracy; of the keys that say how to run, whether they differ at all.
fn differ(key: &str, before: &BTreeMap<String, Vec<f64>>, after: &BTreeMap<String, Vec<f64>>) -> bool {
    if before.keys().ne(after.keys()) || key.starts_with("run.") || key.starts_with("sweep.") {
        return before != after;
    }
    before.iter().any(|(name, before)| {
        let after = &after[name];
        let largest = before.iter().chain(after).fold(0.0_f64, |largest, number| largest.max(number.abs()));
        let change = before.iter().zip(after).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        before.len() != after.len() || change > (CHANGE * largest).max(LEAST)
    })
}

/// What is wrong with a case, if anything is.
fn fault(folder: &Folder, name: &str, case: &Case<'_>) -> Option<String> {
    let before = written(folder, &format!("{name}-before"), &case.pieces, &case.before);
    let after = written(folder, &format!("{name}-after"), &case.pieces, &case.after);
    match (before, after) {
        (Ok(before), Ok(after)) if differ(case.key, &before, &after) => None,
        (Ok(_), Ok(_)) => Some(format!("{}: nothing changes from {:?} to {:?}", case.name(), case.before, case.after)),
        (Err(message), _) | (_, Err(message)) => Some(format!("{}: {message}", case.name())),
    }
}

/// Tries cases on all cores; what is wrong with them.
fn faults(folder: &Folder, cases: &[Case<'_>]) -> Vec<String> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut found = Vec::new();
        while let Some((index, case)) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, cases.get(at)?)))
        {
            found.extend(fault(folder, &index.to_string(), case));
        }
        found
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a worker")).collect()
    })
}

#[test]
fn every_key_has_a_case_and_every_case_a_key() {
    let cases = cases();
    for key in KEYS {
        assert!(cases.iter().any(|case| case.key == key.path), "`{}` has no case: add one to cases.rs", key.path);
    }
    for case in &cases {
        assert!(KEYS.iter().any(|key| key.path == case.key), "{} is no key", case.key);
        assert_ne!(case.before, case.after, "{}", case.key);
    }
}

#[test]
fn every_key_changes_the_run() {
    let found = faults(&Folder::new("keys"), &cases());
    assert!(found.is_empty(), "{} faults:\n{}", found.len(), found.join("\n"));
}

/// Each key of the second actuator of a joint, in the joint of two actuators as the first's case has one.
#[test]
fn every_key_of_the_antagonist_changes_the_run() {
    let mut tried = Vec::new();
    for case in cases().into_iter().filter(|case| is_of_antagonist(case.key)) {
        // The start of one actuator has no meaning in a joint.
        let kept = |of: &[Setting]| -> Vec<Setting> {
            let start = |key: &str| matches!(key, "initial.length" | "initial.velocity");
            of.iter().filter(|(key, _)| !start(key)).cloned().collect()
        };
        let of_second = |of: &[Setting]| -> Vec<Setting> {
            let of_actuator = kept(of).into_iter().filter(|(key, _)| is_of_antagonist(key));
            of_actuator.map(|(key, value)| (format!("{ANTAGONIST}.{key}"), value)).collect()
        };
        let load = if case.key.starts_with("pressure.") { GIVEN_JOINT_LOAD } else { JOINT_LOAD };
        let other_load = |piece: &str| piece.contains("[load]") && !piece.contains("antagonistic-joint");
        let pieces = case.pieces.iter().map(|piece| if other_load(piece) { load } else { piece }).collect();
        // Keys of the second that belong together are given together; a word with separate keys is given for the second only.
        let alone = WORDS.iter().any(|(key, ..)| *key == case.key);
        let first = if alone { Vec::new() } else { kept(&case.before) };
        let extra = OF_JOINTS.iter().filter(|(keys, _)| keys.contains(&case.key)).flat_map(|(_, extra)| set(extra));
        let first: Vec<Setting> = first.into_iter().chain(extra).collect();
        let [before, after] = [&case.before, &case.after].map(|of| [first.clone(), of_second(of)].concat());
        tried.push(Case { key: case.key, pieces, before, after });
    }
    let folder = Folder::new("keys-antagonist");
    let found = faults(&folder, &tried);
    assert!(found.is_empty(), "{} faults:\n{}", found.len(), found.join("\n"));
}
