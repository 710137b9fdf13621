//! `mckibben fmu`: a unit is written whole, and what cannot be one is refused.

use crate::common::{Folder, of_repository};
use std::io::Read as _;

fn run(folder: &Folder, arguments: &[&str]) -> (Option<i32>, String) {
    let file = of_repository("examples/plant/arm.toml");
    let output = folder.mckibben().arg("fmu").arg(file).args(arguments).output().expect("the program runs");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// The text of the first entry of a ZIP file, which is deflated: after a header of 30 bytes and the name.
fn first_entry(bytes: &[u8]) -> String {
    let name = usize::from(u16::from_le_bytes([bytes[26], bytes[27]]));
    let mut text = String::new();
    flate2::read::DeflateDecoder::new(&bytes[30 + name..]).read_to_string(&mut text).expect("a deflated text");
    text
}

#[test]
fn a_unit_is_written() {
    let folder = Folder::new("fmu");
    let (code, printed) =
        run(&folder, &["--output", "arm.fmu", "--fmi", "2", "--kind", "cs", "--command-mode", "request"]);
    assert_eq!(code, Some(0), "{printed}");
    let bytes = std::fs::read(folder.path("arm.fmu")).expect("written");
    let holds = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    assert!(holds("binaries/linux64/mckibben.so") || !cfg!(all(target_os = "linux", target_arch = "x86_64")));
    let description = first_entry(&bytes);
    let holds = |text: &str| description.contains(text);
    assert!(holds("fmiVersion=\"2.0\"") && holds(".request\"") && !holds("<ModelExchange"), "{description}");
    assert_eq!(folder.names(), ["arm.fmu"]);
}

#[test]
fn what_is_no_unit_is_refused() {
    let folder = Folder::new("fmu-refused");
    for (arguments, words) in [
        (&["--output", "arm.zip"][..], ".fmu"),
        (&["--output", "arm.fmu", "--command-mode", "position"], "command_mode"),
        (&["--output", "arm.fmu", "--pulse-frequency", "0 Hz"], "pulse_frequency"),
        (&["--output", "arm.fmu", "--set", "initial.gauge_pressure=-20 bar"], "gauge_pressure"),
        (&["--output", "arm.fmu", "--fmi", "1"], "--fmi"),
    ] {
        let (code, printed) = run(&folder, arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {printed}");
        assert!(printed.contains(words), "{arguments:?}: {printed}");
    }
    assert!(folder.names().is_empty());
}
