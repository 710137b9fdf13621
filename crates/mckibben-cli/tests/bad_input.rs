//! Every mistake that a person makes: exit code 2, the place, the name, the value, the remedy, and nothing written.

use crate::common::Folder;

const GOOD: &str = r#"[actuator]
preset = "colbrunn-2001"
external_volume = "3 cm^3"
[supply]
gauge_pressure = "60 psi"
[valve]
preset = "matrix-eight-channel"
efficiency = 0.85
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
length = "equilibrium"
[run]
duration = "0.1 s"
sample_interval = "1 ms"
"#;

const COMMAND: &str = "[command]\nkind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5\n";
const VALVE: &str = "[valve]\npreset = \"matrix-eight-channel\"\nefficiency = 0.85\n";

/// Runs the program with every output requested; it must fail with a code and leave only the scenario behind.
fn fails(folder: &Folder, arguments: &[&str], code: i32) -> String {
    let before = folder.names();
    let output = folder
        .mckibben()
        .args(arguments)
        .args(["--output", "run.csv", "--plot", "run.svg", "--events-output", "events.csv"])
        .output()
        .expect("the program runs");
    let message = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    assert!(message.starts_with("error: ") && message.contains("= help: "), "{message}");
    assert!(!message.contains('\x1b'), "colours in {message}");
    assert_eq!(folder.names(), before, "something was written");
    message
}

/// The good file with one text replaced must be refused at `line:column` with these words; `check` says the same.
#[track_caller]
fn refused(name: &str, from: &str, to: &str, at: &str, words: &[&str]) {
    let folder = Folder::new(&format!("bad-{name}"));
    assert!(GOOD.contains(from), "{from}");
    folder.file("muscle.toml", &GOOD.replacen(from, to, 1));
    let message = fails(&folder, &["simulate", "muscle.toml"], 2);
    if !at.is_empty() {
        assert!(message.contains(&format!("muscle.toml:{at}")), "no {at} in\n{message}");
    }
    for word in words {
        assert!(message.contains(word), "`{word}` is not in\n{message}");
    }
    let check = folder.mckibben().args(["check", "muscle.toml"]).output().expect("the program runs");
    assert_eq!(check.status.code(), Some(2));
    let checked = String::from_utf8(check.stderr).expect("UTF-8");
    assert!(checked.starts_with(message.trim_end()), "{checked}\n{message}");
}

#[test]
fn the_good_file_is_good() {
    let folder = Folder::new("good");
    folder.file("muscle.toml", GOOD);
    folder.mckibben().args(["simulate", "muscle.toml", "--output", "run.csv"]).assert().success();
    folder.mckibben().args(["check", "muscle.toml"]).assert().success();
    assert_eq!(folder.names(), ["muscle.toml", "run.csv"]);
}

#[test]
fn a_missing_file() {
    let folder = Folder::new("missing");
    let message = fails(&folder, &["simulate", "absent.toml"], 2);
    assert!(
        message.contains("`absent.toml` cannot be read") && message.contains("path of a scenario file"),
        "{message}"
    );
}

#[test]
fn not_toml() {
    refused("toml", "duty = 0.5", "duty = = 0.5", "12:8", &["this is not TOML", "values are strings"]);
}

#[test]
fn an_unknown_key() {
    refused(
        "key",
        "external_volume",
        "extrenal_volume",
        "3:1",
        &["`extrenal_volume` is not a key of [actuator]", "did you mean `external_volume`?"],
    );
}

#[test]
fn a_wrong_unit() {
    refused(
        "unit",
        "\"5 lb\"",
        "\"5 lbf\"",
        "15:8",
        &["\"5 lbf\" is a force, but `load.mass` is a mass", "mass = \"5 lb\""],
    );
}

#[test]
fn a_number_without_its_unit() {
    let help = "write the unit that it is in, as \"5 lb\" or \"5 kg\"";
    refused("number", "\"5 lb\"", "5", "15:8", &["`load.mass` is a mass and needs a unit", help]);
}

#[test]
fn a_length_outside_the_thread() {
    refused(
        "long",
        "\"equilibrium\"",
        "\"5 in\"",
        "17:10",
        &["`initial.length` = 5 in", "must be less than actuator.thread_length", "between 0 and the thread length"],
    );
    refused("short", "\"equilibrium\"", "\"-1 in\"", "17:10", &["`initial.length`", "-1 in", "0"]);
}

#[test]
fn a_negative_mass() {
    refused("mass", "\"5 lb\"", "\"-5 lb\"", "15:8", &["`load.mass`", "-5 lb", "give a mass above zero"]);
}

#[test]
fn a_duty_above_one() {
    refused("duty", "duty = 0.5", "duty = 1.2", "12:8", &["`command.duty`", "1.2", "from 0 to 1"]);
}

#[test]
fn no_volume_at_all() {
    refused("volume", "\"3 cm^3\"", "\"0 cm^3\"", "3:19", &["`actuator.external_volume`", "0 cm^3", "0.01 mL"]);
}

#[test]
fn an_interval_longer_than_the_run() {
    refused(
        "interval",
        "\"1 ms\"",
        "\"1 s\"",
        "20:19",
        &["`run.sample_interval` = 1 s is longer than the run", "0.1 s", "not above the duration"],
    );
}

#[test]
fn times_out_of_order() {
    let table = "[command]\nkind = \"table\"\ntime = [\"0 s\", \"20 ms\", \"10 ms\"]\nstate = [\"fill\", \"exhaust\", \"fill\"]\n";
    refused("times", COMMAND, table, "11:25", &["`command.time` must increase", "entry 3", "sort the table"]);
}

#[test]
fn a_three_way_valve_cannot_hold() {
    refused("hold", COMMAND, "[command]\nkind = \"hold\"\n", "10:8", &["hold", "three-way", "fill-hold-exhaust"]);
}

/// A hint has the unit that the key is usually written in, not any of its dimension: Kv is a flow of water in m³/h.
#[test]
fn a_hint_never_crosses_dimensions() {
    let folder = Folder::new("hints");
    folder.file("muscle.toml", GOOD);
    for (setting, hint) in [
        ("valve.kv=0.5", "as \"0.5 m^3/h\" or \"0.5 m^3/s\""),
        ("command.duty=30", "write \"30 %\" if 30 percent are meant"),
        ("supply.gauge_pressure=6", "as \"6 psi\" or \"6 Pa\""),
    ] {
        let message = fails(&folder, &["simulate", "muscle.toml", "--set", setting], 2);
        assert!(message.contains(hint), "{setting}: {message}");
    }
}

#[test]
fn a_command_without_a_valve() {
    refused("command", VALVE, "", "6:2", &["[command] but no [valve]", "add a section `[valve]`"]);
}

#[test]
fn every_mistake_at_once() {
    let folder = Folder::new("many");
    folder.file("muscle.toml", &GOOD.replace("0.5", "1.2").replace("\"5 lb\"", "5"));
    let message = fails(&folder, &["simulate", "muscle.toml"], 2);
    assert!(message.contains("command.duty") && message.contains("load.mass"), "{message}");
}

#[test]
fn mistakes_on_the_command_line() {
    let folder = Folder::new("arguments");
    folder.file("muscle.toml", GOOD);
    let message = fails(&folder, &["simulate", "muscle.toml", "--set", "load.mass=5"], 2);
    assert!(message.contains("--set:1:13") && message.contains("as \"5 lb\" or \"5 kg\""), "{message}");
    let message = fails(&folder, &["simulate", "muscle.toml", "--set", "load.mas=5 lb"], 2);
    assert!(message.contains("did you mean `mass`?"), "{message}");
    let run = |arguments: &[&str]| folder.mckibben().args(arguments).output().expect("the program runs");
    for arguments in [
        &["simulate", "muscle.toml", "--output", "run.txt"][..],
        &["simulate", "muscle.toml", "--output", "run"],
        &["simulate", "muscle.toml", "--plot", "run.jpg"],
        &["simulate", "muscle.toml", "--events-output", "events.parquet"],
        &["simulate", "muscle.toml", "--output", "same.csv", "--events-output", "same.csv"],
        &["simulate", "muscle.toml", "--set", "load.mass"],
        &["simulate"],
        &["presets", "nothing"],
        &["frobnicate"],
    ] {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: "), "{arguments:?}");
        assert_eq!(folder.names(), ["muscle.toml"], "{arguments:?}");
    }
}

#[test]
fn keys_are_listed_from_the_table() {
    let folder = Folder::new("keys");
    let printed = |path: &[&str]| {
        let output = folder.mckibben().arg("keys").args(path).output().expect("the program runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    assert!(printed(&[]).contains("[actuator.friction]") && printed(&[]).contains("[mechanism.joints.*]"));
    assert!(printed(&["valve"]).contains("closing_delay") && printed(&["actuator"]).contains("actuator.friction"));
    let key = printed(&["valve.kv"]);
    for part in ["Kv", "m^3/s", "greater than 0", "IEC 60534-2-1", "0.05 m^3/h"] {
        assert!(key.contains(part), "{part}: {key}");
    }
    assert!(printed(&["valve.kind"]).contains("fill-hold-exhaust"));
    let output = folder.mckibben().args(["keys", "valve.knd"]).output().expect("the program runs");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    assert!(message.contains("did you mean `valve.kind`?"), "{message}");
}

#[test]
fn init_does_not_overwrite() {
    let folder = Folder::new("init");
    folder.mckibben().args(["init", "new.toml"]).assert().success();
    let first = std::fs::read_to_string(folder.path("new.toml")).expect("written");
    folder.file("new.toml", "mine");
    folder.mckibben().args(["init", "new.toml"]).assert().code(2);
    assert_eq!(std::fs::read_to_string(folder.path("new.toml")).expect("there"), "mine");
    folder.mckibben().args(["init", "new.toml", "--force"]).assert().success();
    assert_eq!(std::fs::read_to_string(folder.path("new.toml")).expect("written"), first);
    folder.mckibben().args(["init", "-"]).assert().success().stdout(first);
    folder.mckibben().args(["check", "new.toml"]).assert().success();
}

#[test]
fn a_supply_below_the_atmosphere_is_no_mistake() {
    let folder = Folder::new("vacuum");
    folder.file("muscle.toml", &GOOD.replace("\"60 psi\"", "\"-0.5 bar\""));
    let run = folder.mckibben().args(["simulate", "muscle.toml", "--output", "run.csv"]).assert().success();
    assert!(String::from_utf8_lossy(&run.get_output().stdout).contains("to supply"));
    assert_eq!(folder.names(), ["muscle.toml", "run.csv"]);
    // Deeper than a vacuum there is nothing.
    folder.file("muscle.toml", &GOOD.replace("\"60 psi\"", "\"-1.1 bar\""));
    let message = fails(&folder, &["simulate", "muscle.toml"], 2);
    assert!(message.contains("muscle.toml:5:18") && message.contains("vacuum"), "{message}");
}

/// A negative quantity is read as the value of its option, and refused by its range where that excludes it.
#[test]
fn negative_quantities_are_values_of_their_options() {
    let folder = Folder::new("bad-negative");
    folder.file("muscle.toml", GOOD);
    for arguments in [
        &["linearize", "muscle.toml", "--temperature", "-20 degC"][..],
        &["linearize", "muscle.toml", "--load", "-40 N"],
        &["linearize", "muscle.toml", "--length", "-85 mm"],
        &["linearize", "muscle.toml", "--duty", "-0.5"],
        &["linearize", "muscle.toml", "--amplitude", "-1 mm"],
        &["curves", "muscle.toml", "--gauge-pressures", "-0.2,1bar"],
        &["size", "--load", "-5 kg", "--stroke", "30 mm", "--gauge-pressure", "4 bar"],
        &["size", "--load", "5 kg", "--stroke", "-30 mm", "--gauge-pressure", "4 bar"],
        &["size", "--load", "5 kg", "--stroke", "30 mm", "--gauge-pressure", "4 bar", "--effectiveness", "-1"],
        &["fmu", "muscle.toml", "--output", "muscle.fmu", "--pulse-frequency", "-5 Hz"],
        &["fmu", "muscle.toml", "--output", "muscle.fmu", "--max-step", "-1 ms"],
    ] {
        let output = folder.mckibben().args(arguments).output().expect("the program runs");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!message.contains("unexpected argument"), "{arguments:?}: {message}");
        match output.status.code() {
            Some(0) => {}
            code => assert!(code == Some(2) && message.contains("give "), "{arguments:?}: {message}"),
        }
    }
    // These lie outside of every range.
    for (arguments, word) in [
        (&["size", "--load", "5 kg", "--stroke", "-30 mm", "--gauge-pressure", "4 bar"][..], "stroke"),
        (&["linearize", "muscle.toml", "--duty", "-0.5"], "duty"),
        (&["linearize", "muscle.toml", "--length", "-85 mm"], "length"),
    ] {
        let output = folder.mckibben().args(arguments).output().expect("the program runs");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && message.contains(word), "{arguments:?}: {message}");
    }
}
