//! `mckibben design`: optima that closed forms give, constraints that are active, and what is refused.

use crate::common::{Folder, is_ignored, of_repository};
use serde_json::Value;
use std::f64::consts::PI;
use std::process::Output;

/// A braid of 120 mm thread and 1.5 turns at 100 mm, filled until its pressure is the supply's.
const ISOMETRIC: &str = "\
# A muscle on a bench.
[actuator]
thread_length = \"120 mm\"
turns = 1.5
max_length = \"110 mm\"
friction = { viscous = \"20 N*s/m\", coulomb_width = \"0 mm\" } # assumed

[supply]
gauge_pressure = \"6 bar\"            # of the workshop

[valve]
kind = \"three-way\"
flow_area = \"3 mm^2\"

[command]
kind = \"fill\"

[load]
kind = \"isometric\"

[initial]
length = \"100 mm\"

[run]
duration = \"0.5 s\"
";
const THREAD: f64 = 0.12;
const TURNS: f64 = 1.5;

/// The paper's (3) for the gauge pressure in Pa at which the braid pulls with a force in N at a length in m.
fn pressure_of(force: f64, length: f64) -> f64 {
    force * 4.0 * PI * TURNS * TURNS / (3.0 * length * length - THREAD * THREAD)
}

fn design(folder: &Folder, arguments: &[&str]) -> Output {
    folder.mckibben().arg("design").args(arguments).output().expect("the program runs")
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn value(of: &Value, key: usize) -> f64 {
    of["values"][key]["value"].as_f64().expect("a number")
}

/// The numbers of a run with some values set.
fn simulated(folder: &Folder, file: &str, set: &[String]) -> Value {
    let set = set.iter().flat_map(|set| ["--set", set]);
    let output = folder.mckibben().args(["simulate", file, "--format", "json"]).args(set).output().expect("it runs");
    json(&output)["numbers"].clone()
}

#[test]
fn the_least_pressure_of_a_tension_is_that_of_the_paper() {
    let folder = Folder::new("design-tension");
    folder.file("muscle.toml", ISOMETRIC);
    let options =
        ["--vary", "supply.gauge_pressure=1..8 bar", "--minimize", "gauge_pressure.final", "--evaluations", "50"];
    let more = ["--subject-to", "tension.final>=250 N", "--format", "json", "--output", "best.toml", "muscle.toml"];
    let found = json(&design(&folder, &[&options[..], &more].concat()));
    let due = pressure_of(250.0, 0.1);
    assert!((1e5 * value(&found, 0) / due - 1.0).abs() < 1e-4, "{found}: {due} Pa");
    let constraint = &found["constraints"][0];
    assert!(constraint["met"] == true && constraint["active"] == true && found["values"][0]["at_end"].is_null());
    assert!(constraint["margin"].as_f64().expect("a margin").abs() < 250.0 * 1e-4, "{constraint}");
    assert!(found["evaluations"].as_u64() <= Some(50) && found["failed"] == 0 && found["converged"] == true);
    // The file is the scenario with one value changed, and its run has the number that was found.
    let text = std::fs::read_to_string(folder.path("best.toml")).expect("a scenario");
    let unchanged = |line: &&str| !line.starts_with("gauge_pressure");
    assert!(text.lines().filter(unchanged).eq(ISOMETRIC.lines().filter(unchanged)), "{text}");
    assert!(text.contains("# of the workshop"), "{text}");
    let numbers = simulated(&folder, "best.toml", &[]);
    assert_eq!(numbers["gauge_pressure_final_pa"], found["value"]);
}

/// The names that `simulate --format json` prints are those of the same numbers; what is found has the name with points.
#[test]
fn names_as_json_has_them_are_taken() {
    let folder = Folder::new("design-names");
    folder.file("muscle.toml", ISOMETRIC);
    let options = ["muscle.toml", "--vary", "supply.gauge_pressure=1..8 bar", "--evaluations", "6", "--format", "json"];
    let of = |objective: &str, constraint: &str| {
        let more = ["--minimize", objective, "--subject-to", constraint];
        json(&design(&folder, &[&options[..], &more].concat()))
    };
    let found = of("exergy_drawn_j", "tension_final_n>=100 N");
    assert_eq!(found, of("exergy.drawn", "tension.final>=100 N"));
    assert_eq!(
        (&found["objective"], &found["constraints"][0]["name"]),
        (&"exergy.drawn".into(), &"tension.final".into())
    );
}

/// Where a hanging mass comes to rest is the balance of (3) with its weight; the numbers of the orbit are those of the rest.
#[test]
fn the_least_pressure_of_a_rest_is_that_of_the_paper() {
    let folder = Folder::new("design-settle");
    let hanging = ISOMETRIC.replace("kind = \"isometric\"", "kind = \"hanging-mass\"\nmass = \"10 kg\"");
    folder.file("muscle.toml", &hanging);
    let options = ["muscle.toml", "--settle", "--vary", "supply.gauge_pressure=1..8 bar", "--minimize"];
    let more = ["settled.gauge_pressure.mean", "--subject-to", "settled.length.mean<=90 mm", "--evaluations", "40"];
    let found = json(&design(&folder, &[&options[..], &more, &["--format", "json"]].concat()));
    let due = pressure_of(10.0 * 9.80665, 0.09);
    assert!((1e5 * value(&found, 0) / due - 1.0).abs() < 1e-3, "{found}: {due} Pa");
    assert_eq!(found["constraints"][0]["active"], true);
}

/// At an optimum under an active constraint no neighbour is better and meets the constraint.
#[test]
fn no_neighbour_of_the_best_is_better() {
    let folder = Folder::new("design-neighbours");
    folder.file("muscle.toml", ISOMETRIC);
    let options = ["muscle.toml", "--vary", "supply.gauge_pressure=1..7 bar", "--vary", "initial.length=80..108 mm"];
    let more = ["--minimize", "air.used", "--subject-to", "tension.final>=150 N", "--evaluations", "90"];
    let found = json(&design(&folder, &[&options[..], &more, &["--format", "json"]].concat()));
    assert_eq!(found["constraints"][0]["active"], true, "{found}");
    let least = found["value"].as_f64().expect("a number");
    let (pressure, length) = (value(&found, 0), value(&found, 1));
    let mut compared = 0;
    for (sideways, up) in [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02), (0.02, -0.02), (-0.02, 0.02)] {
        let (pressure, length) = (pressure + 6.0 * sideways, length + 28.0 * up);
        if !(80.0..=108.0).contains(&length) {
            continue;
        }
        compared += 1;
        let set = [format!("supply.gauge_pressure={pressure} bar"), format!("initial.length={length} mm")];
        let numbers = simulated(&folder, "muscle.toml", &set);
        let [tension, air] = ["tension_final_n", "air_used_kg"].map(|name| numbers[name].as_f64().expect("a number"));
        assert!(tension < 150.0 || air > least, "{set:?} has {tension} N for {air} kg, and the best takes {least} kg");
    }
    assert!(compared >= 4);
}

#[test]
fn an_infeasible_constraint_is_reported_with_the_nearest_point() {
    let folder = Folder::new("design-infeasible");
    folder.file("muscle.toml", ISOMETRIC);
    let options =
        ["muscle.toml", "--vary", "supply.gauge_pressure=1..2 bar", "--minimize", "air.used", "--evaluations", "12"];
    let more = ["--subject-to", "tension.final>=250 N", "--output", "best.toml", "--plot", "search.svg"];
    let output = design(&folder, &[&options[..], &more].concat());
    assert_eq!(output.status.code(), Some(3), "{}", error(&output));
    // At the greatest pressure, by (3).
    let due = 250.0 * 2e5 / pressure_of(250.0, 0.1);
    let words = format!("tension.final = {due:.1} N, not >= 250 N");
    assert!(error(&output).contains("no values within --vary meet every constraint"), "{}", error(&output));
    assert!(error(&output).contains(&words), "{}, not {words}", error(&output));
    let output = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.contains("at its upper end: widen --vary") && output.contains("broken"), "{output}");
    assert_eq!(folder.names(), ["muscle.toml", "search.svg"]);
}

/// A ripple is a difference: 80 °C would be 353 K of it. Kelvins are taken.
#[test]
fn a_bound_on_a_difference_has_a_unit_without_an_offset() {
    let folder = Folder::new("design-difference");
    folder.file("muscle.toml", ISOMETRIC);
    let options = ["muscle.toml", "--settle", "--vary", "supply.gauge_pressure=1..8 bar", "--evaluations", "2"];
    let of = |bound: &str| {
        let more = ["--minimize", "gauge_pressure.final", "--subject-to", bound];
        design(&folder, &[&options[..], &more].concat())
    };
    for (unit, linear) in [("degC", "`K`"), ("degF", "`degR`")] {
        let refused = of(&format!("settled.temperature.ripple<=80 {unit}"));
        let words = error(&refused);
        assert!(refused.status.code() == Some(2) && words.contains("a difference is due"), "{words}");
        assert!(words.contains(linear), "{words}");
    }
    assert!(of("settled.temperature.ripple<=80 K").status.success());
    assert!(of("settled.temperature.max<=300 degC").status.success());
}

#[test]
fn what_cannot_be_searched_is_refused_in_words() {
    let folder = Folder::new("design-refused");
    folder.file("muscle.toml", ISOMETRIC);
    let pressure = "supply.gauge_pressure=1..2 bar";
    for (more, words) in [
        (&["--vary", pressure, "--minimize", "pressure.max"][..], "no number `pressure.max`"),
        (&["--vary", pressure, "--minimize", "pressure.max"], "gauge_pressure.max"),
        (&["--vary", pressure, "--minimize", "air.used", "--subject-to", "lenght.final<=80 mm"], "length.final"),
        (&["--vary", pressure, "--minimize", "settled.tension.mean"], "give --settle"),
        (
            &["--vary", pressure, "--minimize", "air.used", "--subject-to", "tension.max<=3 bar"],
            "is a force, but 3 bar",
        ),
        (
            &["--vary", pressure, "--minimize", "air.used", "--subject-to", "tension.max<=3"],
            "is a force, but 3 is a pure",
        ),
        (&["--vary", pressure, "--minimize", "air.used", "--subject-to", "tension.max=3 N"], "NAME<=VALUE UNIT"),
        (&["--vary", pressure], "--minimize"),
        (&["--vary", pressure, "--minimize", "air.used", "--maximize", "air.used"], "cannot be used with"),
        (&["--vary", pressure, "--vary", pressure, "--minimize", "air.used"], "varies twice"),
        (&["--vary", "supply.gauge_pressure=2..1 bar", "--minimize", "air.used"], "the lower value stands first"),
        (&["--vary", "supply.gauge_pressure=1..x bar", "--minimize", "air.used"], "begins with no number"),
        (&["--vary", "supply.gauge_pressure=1..2 mm", "--minimize", "air.used"], "which is a pressure"),
        (&["--vary", "supply.gauge_pressure=1..2", "--minimize", "air.used"], "which is a pressure"),
        (&["--vary", "supply.gauge_presure=1..2 bar", "--minimize", "air.used"], "did you mean `gauge_pressure`"),
        (&["--vary", "valve.flow_area=0..2 mm^2", "--minimize", "air.used"], "its end 0 mm^2"),
        (&["--vary", "command.kind=1..2", "--minimize", "air.used"], "takes a word"),
        (&["--vary", "command.time[0]=1..2 s", "--minimize", "air.used"], "there is no `command.time[0]`"),
        (&["--vary", "supply.gauge_pressure[0]=1..2 bar", "--minimize", "air.used"], "is no list"),
        (
            &["--vary", pressure, "--minimize", "air.used", "--output", "best.csv"],
            "end the name of --output with .toml",
        ),
        (&["--vary", pressure, "--minimize", "air.used", "--output", "muscle.toml"], "names of their own"),
        (&["--vary", pressure, "--minimize", "air.used", "--evaluations", "0"], "--evaluations"),
    ] {
        let output = design(&folder, &[&["muscle.toml"], more].concat());
        let message = error(&output);
        assert!(output.status.code() == Some(2) && message.contains(words), "{more:?}: {message}");
    }
    assert_eq!(folder.names(), ["muscle.toml"]);
}

#[test]
fn any_number_of_threads_finds_the_same() {
    let folder = Folder::new("design-threads");
    folder.file("muscle.toml", ISOMETRIC);
    let options = ["muscle.toml", "--vary", "supply.gauge_pressure=1..7 bar", "--vary", "initial.length=80..108 mm"];
    let more = ["--maximize", "tension.final", "--subject-to", "air.used<=60 mg", "--evaluations", "60"];
    let run = |threads: &str| {
        let mut command = folder.mckibben();
        command.arg("design").args(options).args(more).args(["--format", "json"]).env("RAYON_NUM_THREADS", threads);
        let output = command.output().expect("it runs");
        assert!(output.status.success(), "{}", error(&output));
        output.stdout
    };
    assert_eq!(run("1"), run("4"));
}

/// An explicit method with steps of 1 ms blows up through a wide valve: such runs count as infeasible, and the others are searched.
#[test]
fn runs_that_fail_are_reported_and_the_search_goes_on() {
    let folder = Folder::new("design-failures");
    let stepped = format!("{ISOMETRIC}engine = \"fixed-step\"\nmethod = \"rk4\"\nstep = \"1 ms\"\n");
    folder.file("muscle.toml", &stepped);
    let options =
        ["muscle.toml", "--vary", "valve.flow_area=1..10000 mm^2", "--maximize", "air.used", "--evaluations", "20"];
    let output = design(&folder, &options);
    assert!(output.status.success(), "{}", error(&output));
    let output = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.contains("failed and counted as infeasible") && output.contains("the simulation stopped"),
        "{output}"
    );
    assert!(output.contains("1..10000 mm^2, logarithmic"), "{output}");
}

/// Of a plant: keys of its parts and an entry of a list, numbers with the names of parts, and the file that is written.
#[test]
fn a_plant_is_designed_by_the_keys_of_its_parts() {
    let folder = Folder::new("design-plant");
    let bottle = std::fs::read_to_string(of_repository("examples/plant/bottle.toml")).expect("an example");
    folder.file("bottle.toml", &bottle);
    let options =
        ["bottle.toml", "--set", "run.duration=0.5 s", "--vary", "actuators.thick.load.mass=20..30 lb", "--vary"];
    let more = [
        "command.time[1]=0.2..0.4 s",
        "--maximize",
        "thick.length.final",
        "--subject-to",
        "thick.gauge_pressure.max>=1.5 bar",
    ];
    let last = ["--evaluations", "24", "--format", "json", "--output", "best.toml", "--plot", "search.svg"];
    let found = json(&design(&folder, &[&options[..], &more, &last].concat()));
    assert_eq!((&found["feasible"], &found["unit"]), (&true.into(), &"m".into()));
    let text = std::fs::read_to_string(folder.path("best.toml")).expect("a scenario");
    assert!(text.starts_with("# Three unlike muscles") && text.contains("duration = \"0.5 s\""), "{text}");
    assert!(text.contains(&format!("load.mass = \"{} lb\"", value(&found, 0))), "{text}");
    let numbers = simulated(&folder, "best.toml", &[]);
    assert_eq!(numbers["thick_length_final_m"], found["value"]);
    // A heavier load hangs lower: the most that was allowed.
    assert_eq!(found["values"][0]["at_end"], "high", "{found}");
}

/// What was found before a signal is printed, written and meets the constraint: the least pressure is that of the paper's (3), which the
/// search has come near long before it has used its evaluations.
#[cfg(unix)]
#[test]
fn an_interrupted_search_writes_the_best_values() {
    let folder = Folder::new("design-interrupt");
    folder.file("muscle.toml", ISOMETRIC);
    let options =
        ["design", "muscle.toml", "--vary", "supply.gauge_pressure=1..8 bar", "--minimize", "gauge_pressure.final"];
    let more = ["--subject-to", "tension.final>=60 N", "--evaluations", "1000000", "--output"];
    for (signal, name, code) in [(2, "SIGINT", 130), (15, "SIGTERM", 143)] {
        if is_ignored(signal) {
            continue;
        }
        let file = format!("{name}.toml");
        let arguments = [&options[..], &more[..], &[&file]].concat();
        let output = folder.interrupted(&arguments, name, std::time::Duration::from_secs(2));
        let printed = String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(code), "{printed}{}", error(&output));
        assert!(error(&output).contains(&format!("{name}: the search ends with the best values so far")));
        assert!(printed.contains("The search was interrupted: these are the best values so far."), "{printed}");
        let run = folder.mckibben().args(["simulate", &file, "--format", "json"]).output().expect("it runs");
        let run = json(&run);
        let of = |name: &str| run["numbers"][name].as_f64().expect("a number");
        assert!(of("tension_final_n") >= 60.0 * (1.0 - 1e-6), "{run}");
        let least = pressure_of(60.0, 0.1);
        assert!((of("gauge_pressure_final_pa") / least - 1.0).abs() < 0.05, "{run} for {least} Pa");
    }
}
