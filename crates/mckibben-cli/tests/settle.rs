//! `mckibben simulate --settle`: what a run settles to, with what `linearize` says of it, and that a swing is
//! distinguished from a ripple.

use crate::common::{Folder, PULSES, of_repository};

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

/// A controller follows a set point of 90 mm ± 3 mm at 0.25 Hz: its orbit takes 4 s, and the length has the mean of the set point, which
/// its integral part reaches whatever the lag.
#[test]
fn a_controller_settles_to_the_orbit_of_its_set_point() {
    let folder = Folder::new("controlled");
    let example = of_repository("examples/control/pid.toml");
    let file = example.to_str().expect("UTF-8");
    let all = json(&folder, &["simulate", file, "--settle", "--format", "json"]);
    let settled = &all["settled"];
    assert_eq!((&settled["settled"], &settled["period_s"]), (&true.into(), &4.0.into()), "{settled}");
    let number = |name: &str| settled["numbers"][name].as_f64().unwrap_or_else(|| panic!("{name}: {settled}"));
    assert!((number("length_mean_m") - 0.09).abs() < 1e-4, "{settled}");
    assert!((5e-3..9e-3).contains(&number("length_ripple_m")), "{settled}");
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
    // In words it is an equilibrium, and no orbit.
    let text = run(&folder, &["simulate", "still.toml", "--settle", still[0], still[1], still[2], still[3]]);
    assert!(text.contains("\n  equilibrium") && !text.contains("\n  orbit"), "{text}");
    assert!(text.contains("after the end of the run"), "{text}");
    let text = run(&folder, &["simulate", "muscle.toml", "--settle"]);
    assert!(text.contains("\n  orbit") && !text.contains("equilibrium"), "{text}");
}

/// A run comes to one orbit, whether it is kept for a figure or not, and by whichever engine it came to its end: behind that it takes
/// located steps.
#[test]
fn the_orbit_does_not_depend_on_what_is_kept_of_the_run() {
    let folder = Folder::new("kept");
    folder.file("muscle.toml", UNDAMPED);
    let arguments = ["simulate", "muscle.toml", "--settle", "--format", "json", "--set", "run.duration=0.3 s"];
    let of = |more: &[&str]| json(&folder, &[&arguments[..], more].concat())["settled"].clone();
    let settled = of(&[]);
    assert_eq!(settled["settled"], true);
    assert_eq!(settled, of(&["--plot", "run.svg"]));
    let stepped = of(&["--set", "run.engine=fixed-step", "--set", "run.step=0.1 ms"]);
    assert_eq!(stepped["settled"], true, "{stepped}");
    // The orbit keeps the P (V/m)^n of the air at the end of the run, which has the error of its steps.
    for name in ["length_mean_m", "length_ripple_m", "gauge_pressure_ripple_pa"] {
        let [orbit, again] = [&settled, &stepped].map(|of| of["numbers"][name].as_f64().expect("a number"));
        assert!((again - orbit).abs() < 1e-3 * orbit, "{name}: {again} for {orbit}");
    }
}

/// The columns of a table by their names.
fn columns(table: &str) -> std::collections::BTreeMap<String, Vec<f64>> {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    let column = |place: usize| rows.iter().map(|row| row[place]).collect();
    names.iter().enumerate().map(|(place, name)| ((*name).to_owned(), column(place))).collect()
}

/// Statistics of the orbit: momentum returns, so that the mean tension is the weight; the ripple is that of `simulate --settle`; nothing
/// drifts. What is said of the way there is that of a sweep without `--settle`, and files do not depend on threads.
#[test]
fn a_sweep_is_taken_over_the_orbit() {
    let folder = Folder::new("sweep");
    let sweep = "[sweep]\nreductions = [\"tension.mean\", \"length.mean\", \"length.ripple\", \"length.drift\", \
                 \"length.overshoot\", \"air.used\"]\n[sweep.vary]\n\"load.mass\" = [\"1.5 kg\", \"2 kg\"]\n";
    let muscle = UNDAMPED.replace("viscous = \"0 N*s/m\"", "viscous = \"5 N*s/m\"");
    folder.file("muscle.toml", &format!("{}{sweep}", muscle.replace("2 s", "0.3 s")));
    let table = |name: &str, more: &[&str]| {
        run(&folder, &[&["sweep", "muscle.toml", "--quiet", "--output", name][..], more].concat());
        std::fs::read_to_string(folder.path(name)).expect("a file")
    };
    let settled = table("settled.csv", &["--settle", "--jobs", "1"]);
    assert_eq!(settled, table("again.csv", &["--settle", "--jobs", "2"]));
    let rows = |table: &str| table.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(rows(&settled), rows(&table("key.csv", &["--set", "sweep.over=orbit"])));
    let (settled, plain) = (columns(&settled), columns(&table("plain.csv", &["--engine", "event-located"])));
    for (place, mass) in [1.5, 2.0].into_iter().enumerate() {
        let of = |name: &str| settled[name][place];
        let weight = mass * 9.80665;
        assert!((of("tension_mean_n") - weight).abs() < 1e-3 * weight, "{settled:?}");
        assert!((plain["tension_mean_n"][place] - weight).abs() > 1e-2 * weight, "the start swings: {plain:?}");
        assert!(of("length_drift_m") < 1e-3 * of("length_ripple_m"), "{settled:?}");
        for name in ["length_overshoot", "air_used_kg"] {
            assert_eq!(of(name), plain[name][place], "{name}");
        }
        let mass = format!("load.mass={mass} kg");
        let set = ["--set", &mass];
        let all = json(&folder, &[&["simulate", "muscle.toml", "--settle", "--format", "json"][..], &set].concat());
        for name in ["length_ripple_m", "length_mean_m"] {
            let orbit = all["settled"]["numbers"][name].as_f64().expect("a number");
            // Both read a thousand instants of the period, the sweep its start too.
            assert!((of(name) - orbit).abs() < 1e-5 * orbit, "{name}: {} for {orbit}", of(name));
        }
    }
    let refused = folder.mckibben().args(["sweep", "muscle.toml", "--settle", "--record", "trajectories"]).output();
    let refused = String::from_utf8(refused.expect("the program runs").stderr).expect("UTF-8");
    assert!(refused.contains("sweep.over") && refused.contains("reductions"), "{refused}");
}

/// Of a plant, in a folder: what a sweep that was stopped has is kept, and a folder of runs to `run.duration` is another's.
#[test]
fn a_sweep_of_a_plant_over_the_orbit_goes_on_in_its_folder() {
    let folder = Folder::new("plant");
    let arm = std::fs::read_to_string(of_repository("examples/plant/arm.toml")).expect("an example");
    let sweep = "\n[sweep]\npart_rows = 1\nreductions = [\"elbow.angle.mean\", \"elbow.angle.drift\", \"elbow.angle.overshoot\"]\n[sweep.vary]\n\
                 \"run.duration\" = [\"0.2 s\", \"0.4 s\"]\n";
    folder.file("arm.toml", &format!("{arm}{sweep}"));
    let sweep = |more: &[&str]| {
        let arguments = ["sweep", "arm.toml", "--output", "parts"];
        let output = folder.mckibben().args([&arguments[..], more].concat()).output().expect("the program runs");
        (output.status.code(), [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()))
    };
    assert_eq!(sweep(&["--settle", "--shard", "1/2"]).0, Some(0));
    let (code, [text, _]) = sweep(&["--settle"]);
    assert!(code == Some(0) && text.contains("1 run of parts that were finished before"), "{text}");
    let (code, [_, refused]) = sweep(&[]);
    assert!(code == Some(2) && refused.contains("another sweep"), "{refused}");
    // Both come to one rest, and the overshoot is that of the run.
    run(&folder, &["sweep", "arm.toml", "--settle", "--quiet", "--output", "all.csv"]);
    let all = columns(&std::fs::read_to_string(folder.path("all.csv")).expect("a file"));
    let [short, long] = [0, 1].map(|place| all["elbow_angle_mean_rad"][place]);
    assert!((short - long).abs() < 1e-3 && all["elbow_angle_drift_rad"].iter().all(|drift| *drift < 1e-4), "{all:?}");
    assert_ne!(all["elbow_angle_overshoot"][0], all["elbow_angle_overshoot"][1], "{all:?}");
}

/// What has no common period is named with its periods, and the frequency that the remedy gives settles.
#[test]
fn frequencies_without_a_common_period_are_named() {
    let folder = Folder::new("periods");
    let load = "kind = \"prescribed-motion\"\nlength = \"90 mm\"\namplitude = \"2 mm\"\nfrequency = \"1.2345678 Hz\"";
    let text = UNDAMPED.replace("kind = \"hanging-mass\"\nmass = \"2 kg\"", load).replace("2 s", "0.1 s");
    folder.file("muscle.toml", &text);
    let refused = folder.mckibben().args(["simulate", "muscle.toml", "--settle"]).output().expect("the program runs");
    let error = String::from_utf8_lossy(&refused.stderr).into_owned();
    for words in [
        "`command.frequency` has a period of 40 ms",
        "`load.frequency` has a period of 810 ms",
        "with `load.frequency` = \"1.25 Hz\" its period is 20 of those of `command.frequency`",
    ] {
        assert!(!refused.status.success() && error.contains(words), "{words}\n{error}");
    }
    let text = run(&folder, &["simulate", "muscle.toml", "--settle", "--set", "load.frequency=1.25 Hz"]);
    assert!(text.contains("of 800 ms"), "{text}");
}
