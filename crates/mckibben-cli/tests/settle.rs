//! `mckibben simulate --settle`: what a run settles to, with what `linearize` says of it, and that a swing is
//! distinguished from a ripple.

mod common;

use common::{Folder, PULSES};

/// A muscle without friction: nothing damps the swing of its load.
const UNDAMPED: &str = "\
[supply]
gauge_pressure = \"6 bar\"
[valve]
preset = \"matrix-eight-channel\"
[command]
kind = \"pwm\"
frequency = \"25 Hz\"
duty = 0.4
[load]
kind = \"hanging-mass\"
mass = \"2 kg\"
[actuator.friction]
viscous = \"0 N*s/m\"
coulomb_width = \"0 mm\"
[run]
duration = \"2 s\"
";

fn run(folder: &Folder, arguments: &[&str]) -> String {
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

fn json(folder: &Folder, arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&run(folder, arguments)).expect("JSON")
}

#[test]
fn a_swing_is_no_ripple_and_its_orbit_is_found() {
    let folder = Folder::new("swing");
    folder.file("muscle.toml", UNDAMPED);
    let text = run(&folder, &["simulate", "muscle.toml"]);
    assert!(text.contains("not settled: the length travels") && !text.contains("peak to peak"), "{text}");
    let all = json(&folder, &["simulate", "muscle.toml", "--settle", "--format", "json"]);
    let (numbers, settled) = (&all["numbers"], &all["settled"]);
    assert_eq!(numbers["length_settled"], 0.0);
    assert!(numbers.get("length_ripple_m").is_none() && numbers.get("length_mean_m").is_none());
    assert_eq!((&settled["settled"], &settled["period_s"]), (&true.into(), &0.04.into()));
    assert!(settled["guesses"].as_u64() > Some(0));
    // On an orbit momentum returns: the mean tension is the weight.
    let number = |name: &str| settled["numbers"][name].as_f64().unwrap_or_else(|| panic!("{name}: {settled}"));
    assert!((number("tension_mean_n") - 2.0 * 9.80665).abs() < 1e-3, "{settled}");
    assert!(number("length_ripple_m") < 0.3 * numbers["length_travel_m"].as_f64().expect("a number"));
}

/// Fast pulses are where the averaged model holds: the ripple that it says and that of the orbit differ by less than a tenth, and a
/// run that is long enough has the orbit's.
#[test]
fn linearize_and_simulate_agree_on_the_ripple() {
    let folder = Folder::new("agree");
    folder.file("muscle.toml", UNDAMPED);
    let set = ["--set", "actuator.friction.viscous=60 N*s/m", "--set", "command.frequency=60 Hz"];
    let simulate = ["simulate", "muscle.toml", "--settle", "--format", "json", "--set", "run.duration=4 s"];
    let all = json(&folder, &[&simulate[..], &set[..]].concat());
    let of =
        |values: &serde_json::Value, name: &str| values[name].as_f64().unwrap_or_else(|| panic!("{name}: {values}"));
    let orbit = of(&all["settled"]["numbers"], "length_ripple_m");
    assert!((of(&all["numbers"], "length_ripple_m") - orbit).abs() < 1e-3 * orbit, "{all}");
    run(&folder, &[&["linearize", "muscle.toml", "--output", "model.json"][..], &set[..]].concat());
    let model = std::fs::read_to_string(folder.path("model.json")).expect("a file");
    let model: serde_json::Value = serde_json::from_str(&model).expect("JSON");
    let linear = of(&model["pwm"]["validity"], "length_ripple_m");
    assert!((linear - orbit).abs() < 0.1 * orbit, "{linear} m by the model, {orbit} m on the orbit");
}

#[test]
fn what_comes_to_rest_settles_at_an_equilibrium_and_files_end_where_they_did() {
    let folder = Folder::new("rest");
    folder.file("muscle.toml", PULSES);
    let still = ["--set", "command.kind=fill", "--set", "run.duration=50 ms"];
    let text = PULSES.lines().filter(|line| !line.starts_with("frequency") && !line.starts_with("duty"));
    folder.file("still.toml", &text.collect::<Vec<_>>().join("\n"));
    let arguments = ["simulate", "still.toml", "--settle", "--format", "json", "--output", "run.csv"];
    let all = json(&folder, &[&arguments[..], &still[..]].concat());
    let rows = std::fs::read_to_string(folder.path("run.csv")).expect("a file").lines().count();
    assert_eq!(rows, 52, "a row for each of 50 ms, the start and the head");
    let of = |name: &str| all["settled"]["numbers"][name].as_f64().expect("a number");
    assert_eq!((of("length_ripple_m"), of("gauge_pressure_ripple_pa")), (0.0, 0.0));
    assert!((of("gauge_pressure_mean_pa") - of("gauge_pressure_max_pa")).abs() < 1.0);
}
