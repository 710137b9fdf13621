//! The parts of a sweep when many processes begin at once, and when a byte of one is damaged.

use crate::common::Folder;
use mckibben_run::table::{Seal, seal};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Twelve runs in as many parts.
const SWEEP: &str = r#"[actuator]
preset = "colbrunn-2001"
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
[run]
duration = "0.02 s"
step = "0.1 ms"
[sweep]
reductions = ["length.final", "tension.peak"]
part_rows = 1
[sweep.vary]
"load.mass" = ["3 lb", "5 lb", "15 lb"]
"supply.gauge_pressure" = ["20 psi", "60 psi", "80 psi", "100 psi"]
"#;

/// All files of a folder with their bytes, hidden ones too.
fn bytes(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), std::fs::read(entry.path()).expect("read")))
        .collect()
}

fn begin(folder: &Folder, arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mckibben"));
    command.current_dir(folder.path("")).args(["sweep", "sweep.toml", "--quiet", "--jobs", "1"]).args(arguments);
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program runs")
}

/// Begins all at once and waits for all of them; each must succeed.
fn together(folder: &Folder, all: &[Vec<&str>]) {
    let children: Vec<Child> = all.iter().map(|arguments| begin(folder, arguments)).collect();
    for child in children {
        let output = child.wait_with_output().expect("ended");
        assert!(output.status.success(), "{:?}: {}", output.status, String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn many_processes_that_begin_a_folder_at_once_all_succeed_with_the_bytes_of_one() {
    let folder = Folder::new("folder-many");
    folder.file("sweep.toml", SWEEP);
    together(&folder, &[vec!["-o", "one"]]);
    let one = bytes(&folder.path("one"));
    assert_eq!(one.len(), 13);
    let shards: Vec<String> = (1..=32).map(|shard| format!("{shard}/32")).collect();
    for round in 0..4 {
        // Shards, most of which have no part and only begin; and equal sweeps, each of which does all of it.
        let [shared, equal] = ["shared", "equal"].map(|name| format!("{name}-{round}"));
        let of_shards: Vec<_> = shards.iter().map(|shard| vec!["-o", shared.as_str(), "--shard", shard]).collect();
        together(&folder, &of_shards);
        together(&folder, &vec![vec!["-o", equal.as_str()]; 32]);
        for name in [shared, equal] {
            let found = bytes(&folder.path(&name));
            assert_eq!(found.keys().collect::<Vec<_>>(), one.keys().collect::<Vec<_>>(), "{name}");
            assert!(found == one, "{name} has other bytes");
        }
    }
}

#[test]
fn of_two_sweeps_that_begin_a_folder_at_once_one_has_it_and_the_other_is_refused() {
    let folder = Folder::new("folder-two");
    folder.file("sweep.toml", SWEEP);
    for round in 0..8 {
        let name = format!("out-{round}");
        let of = |gravity: &'static str| vec!["-o", name.as_str(), "--set", gravity];
        let both: Vec<_> = (0..16)
            .map(|of_both| if of_both % 2 == 0 { "load.gravity=9.8 m/s^2" } else { "load.gravity=9.7 m/s^2" })
            .collect();
        let children: Vec<Child> = both.iter().map(|gravity| begin(&folder, &of(gravity))).collect();
        let mut codes: BTreeMap<&str, Vec<Option<i32>>> = BTreeMap::new();
        for (gravity, child) in both.iter().zip(children) {
            let output = child.wait_with_output().expect("ended");
            let error = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success() || error.contains("holds another sweep"), "{error}");
            codes.entry(gravity).or_default().push(output.status.code());
        }
        let mut codes: Vec<_> = codes.into_values().collect();
        codes.sort();
        assert_eq!(codes, [vec![Some(0); 8], vec![Some(2); 8]]);
    }
}

#[test]
fn a_live_temporary_file_of_another_process_is_not_touched() {
    let folder = Folder::new("folder-live");
    folder.file("sweep.toml", SWEEP);
    std::fs::create_dir(folder.path("out")).expect("made");
    // Of another machine, of an earlier version, and without an owner.
    let names =
        [".sweep.json.0123456789abcdef-1-99999-0.tmp", ".part-00003.parquet.4242.tmp", ".part-00003.parquet.x-1-0.tmp"];
    names.iter().for_each(|name| std::fs::write(folder.path("out").join(name), "half").expect("written"));
    together(&folder, &[vec!["-o", "out"]]);
    together(&folder, &[vec!["-o", "out"]]);
    assert!(names.iter().all(|name| folder.path("out").join(name).exists()), "{:?}", bytes(&folder.path("out")).keys());
}

#[test]
fn a_damaged_byte_of_a_part_is_found_wherever_it_is() {
    let folder = Folder::new("folder-damaged");
    folder.file("sweep.toml", &SWEEP.replace("part_rows = 1", "part_rows = 6"));
    together(&folder, &[vec!["-o", "out"]]);
    let whole = bytes(&folder.path("out"));
    let path = folder.path("out/part-00001.parquet");
    let content = &whole["part-00001.parquet"];
    let sealed = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("written");
        seal(&mut File::open(&path).expect("there")).expect("read")
    };
    assert_eq!(sealed(content), Seal::Whole);
    let mut missing = 0;
    for place in 0..content.len() {
        let mut bytes = content.clone();
        bytes[place] ^= 1 << (place % 8);
        match sealed(&bytes) {
            Seal::Whole => panic!("byte {place} of {}", content.len()),
            // The name of the key itself is damaged: the part is done again.
            Seal::Missing => missing += 1,
            Seal::Damaged => {}
        }
    }
    assert!(missing < 24, "{missing}");
    for length in [0, 3, 8, 100, content.len() / 2, content.len() - 1] {
        assert_ne!(sealed(&content[..length]), Seal::Whole, "{length} bytes");
    }
    // The program refuses each of them, or does the part again.
    let (mut refused, mut done_again) = (0, 0);
    for place in (0..content.len()).step_by(97) {
        let mut bytes = content.clone();
        bytes[place] ^= 0xff;
        std::fs::write(&path, &bytes).expect("written");
        let output = begin(&folder, &["-o", "out"]).wait_with_output().expect("ended");
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        match output.status.code() {
            Some(0) => {
                assert_eq!(std::fs::read(&path).expect("there"), *content, "byte {place}");
                done_again += 1;
            }
            Some(2) => {
                assert!(error.contains("part-00001.parquet` is damaged") && error.contains("delete it"), "{error}");
                refused += 1;
            }
            other => panic!("byte {place}: {other:?}, {error}"),
        }
    }
    assert!(refused > 20 && refused > 20 * done_again, "{refused} {done_again}");
    std::fs::remove_file(&path).expect("there");
    together(&folder, &[vec!["-o", "out"]]);
    assert!(bytes(&folder.path("out")) == whole);
}

#[test]
fn a_part_without_a_checksum_is_done_again() {
    let folder = Folder::new("folder-earlier");
    folder.file("sweep.toml", SWEEP);
    together(&folder, &[vec!["-o", "out"]]);
    let whole = bytes(&folder.path("out"));
    let path = folder.path("out/part-00004.parquet");
    // As an earlier version wrote it: the same without this key.
    let key = b"mckibben.crc32";
    let mut bytes_of_it = whole["part-00004.parquet"].clone();
    let at = bytes_of_it.windows(key.len()).position(|bytes| bytes == key).expect("a checksum");
    bytes_of_it[at..][..key.len()].copy_from_slice(b"mckibben.other");
    std::fs::write(&path, &bytes_of_it).expect("written");
    together(&folder, &[vec!["-o", "out"]]);
    assert!(bytes(&folder.path("out")) == whole);
}
