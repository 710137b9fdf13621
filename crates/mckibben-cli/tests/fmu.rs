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
        (&["--output", "arm.fmu", "--command-mode", "position"], "give --command-mode duty or --command-mode request"),
        (&["--output", "arm.fmu", "--command-mode", "duty"], "give --pulse-frequency, such as '25 Hz'"),
        (&["--output", "arm.fmu", "--pulse-frequency", "0 Hz"], "`0 Hz` is not above zero"),
        (&["--output", "arm.fmu", "--max-step", "-1 ms"], "`-1 ms` is not above zero"),
        (&["--output", "arm.fmu", "--max-step", "1 ms", "--kind", "me"], "leave out --max-step"),
        (
            &["--output", "arm.fmu", "--pulse-frequency", "25 Hz", "--command-mode", "request"],
            "leave out --pulse-frequency",
        ),
        (&["--output", "arm.fmu", "--set", "initial.gauge_pressure=-20 bar"], "gauge_pressure"),
        (&["--output", "arm.fmu", "--fmi", "1"], "--fmi"),
    ] {
        let (code, printed) = run(&folder, arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {printed}");
        let printed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(printed.contains(words), "{arguments:?}: {printed}");
    }
    assert!(folder.names().is_empty());
}

/// What is left out is printed, the units for display are those that were chosen, and model exchange needs no step.
#[test]
fn a_unit_says_what_it_leaves_out_and_takes_units() {
    let folder = Folder::new("fmu-words");
    let write = |file: &str, arguments: &[&str]| {
        let output = folder.mckibben().arg("fmu").arg(of_repository(file)).args(arguments).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let printed = write("examples/plant/controlled.toml", &["--output", "controlled.fmu", "--units", "imperial"]);
    let printed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(printed.contains("are left out: the host commands the valves."), "{printed}");
    let description = first_entry(&std::fs::read(folder.path("controlled.fmu")).expect("written"));
    let pressure =
        description.lines().find(|line| line.contains("name=\"gripper.gauge_pressure\"")).expect("an output");
    assert!(pressure.contains("unit=\"Pa\" displayUnit=\"psi\""), "{pressure}");
    assert!(description.contains("name=\"degF\" factor=\"1.8\" offset=\"-459.67\""), "short numbers");
    let printed =
        write("examples/friction/lugre.toml", &["--output", "lugre.fmu", "--kind", "me", "--motion", "scenario"]);
    assert!(!printed.contains("left out"), "{printed}");
    let description = first_entry(&std::fs::read(folder.path("lugre.fmu")).expect("written"));
    assert!(description.contains("<ModelExchange") && !description.contains("<CoSimulation"), "{description}");
    let pressure =
        description.lines().find(|line| line.contains("name=\"actuator.gauge_pressure\"")).expect("an output");
    assert!(pressure.contains("displayUnit=\"bar\""), "{pressure}");
}
