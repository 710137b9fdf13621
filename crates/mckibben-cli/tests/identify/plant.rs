//! Plants whose actuators have names: parts are found, some by measured pressures, and what is wrong is refused in words.

use super::{Folder, cell, identify, of_repository, printed, read};
use mckibben_scenario::Document;

/// A file of the repository's examples.
fn example(name: &str) -> String {
    std::fs::read_to_string(of_repository(&format!("examples/{name}"))).expect("an example")
}

/// The 95 % interval of a number among the values.
fn interval(csv: &str, name: &str) -> [f64; 2] {
    let mut lines = csv::Reader::from_reader(csv.as_bytes());
    let place = lines.headers().expect("a head").iter().position(|head| head == "95 % interval").expect("a column");
    let found = lines.records().map(|line| line.expect("a line")).find(|line| &line[0] == name).expect("a row");
    let (low, high) = found[place].split_once(" to ").unwrap_or_else(|| panic!("{name} has no interval\n{csv}"));
    [low, high].map(|end| end.parse().expect("a number"))
}

#[test]
fn an_arm_is_identified_from_its_motion() {
    let folder = Folder::new("identify-arm");
    let printed = printed(&identify(&folder, &of_repository("examples/identify/arm.toml")));
    let values = read(&folder, "out/values.csv");
    let found = Document::load(folder.path("out/scenario.toml")).expect("a scenario");
    // What `examples/identify/data.sh` has put in; the file that the search began with has the value in the third place.
    for (name, truth, drawn) in [
        ("mechanism.joints.shoulder.inertia", 6e-3, 5e-3),
        ("mechanism.joints.elbow.damping", 0.05, 0.04),
        ("actuators.biceps.turns", 2.7, 2.5),
        ("supplies.tank.reservoir_volume", 250e-6, 300e-6),
    ] {
        let value = cell(&values, name, "value");
        let [low, high] = interval(&values, name);
        assert!(low < truth && truth < high && high - low < 0.05 * truth, "{name}: {value}, not {truth}\n{printed}");
        let written = found.find_in_plant(name).expect("a parameter").value();
        assert!((written - value).abs() <= 0.5 * (high - low) && (written - drawn).abs() > 0.05 * drawn, "{written}");
    }
    assert!(!printed.contains('!'), "{printed}");
    for file in ["run-1.svg", "run-1.png", "run-1.csv", "index.html", "comparison.csv"] {
        assert!(folder.path("out").join(file).exists(), "{file}");
    }
    let page = read(&folder, "out/index.html");
    let figure = read(&folder, "out/run-1.svg");
    for words in ["angle of shoulder", "gauge pressure of biceps", "gauge pressure of tank"] {
        assert!(page.contains(words) && printed.contains(words), "{words}\n{printed}");
        // A label may take two lines.
        let part = words.rsplit(' ').next().expect("a part");
        assert!(figure.contains(part), "{words}");
    }
    // What was written runs, and differs from the drawing in these four numbers alone.
    let run = folder.mckibben().args(["simulate", "out/scenario.toml", "--output", "run.csv"]).output();
    let run = run.expect("the program runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(read(&folder, "run.csv").lines().next().expect("a head").contains("shoulder.angle_rad"));
    let drawn = Document::load(of_repository("examples/plant/arm.toml")).expect("a scenario");
    let same =
        |name: &str| found.find_in_plant(name).expect("one").value() == drawn.find_in_plant(name).expect("one").value();
    assert!(
        ["mechanism.joints.elbow.inertia", "actuators.triceps.turns", "supplies.manifold.reservoir_volume"]
            .iter()
            .all(|name| same(name))
    );
}

/// A parameter at the top of the file is one of all actuators that have no other, also where the file does not have its section.
#[test]
fn parameters_of_all_actuators_are_estimated() {
    let folder = Folder::new("identify-arm-all");
    folder.file("arm.toml", &example("plant/arm.toml"));
    folder.file("arm.csv", &example("identify/arm.csv"));
    let study = example("identify/arm.toml").replace("../plant/arm.toml", "arm.toml");
    let more = "[fit.\"actuator.turns\"]\nstart = 2.4\n[fit.\"valve.opening_delay\"]\nstart = \"5 ms\"\n[fit.\"actuators.triceps.command.time[0]\"]\n";
    let printed = printed(&identify(&folder, &folder.file("study.toml", &(study + "\n" + more))));
    let values = read(&folder, "out/values.csv");
    // Those of the preset, of the valve's data sheet, and of the file.
    for (name, truth) in [
        ("actuator.turns", 2.5),
        ("actuators.biceps.turns", 2.7),
        ("valve.opening_delay", 4e-3),
        ("actuators.triceps.command.time[0]", 0.7),
    ] {
        let [low, high] = interval(&values, name);
        assert!(low < truth && truth < high && high - low < 0.02 * truth, "{name}: {low} to {high}\n{printed}");
    }
    let run = folder.mckibben().args(["simulate", "out/scenario.toml"]).output().expect("the program runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// The measured pressure of one actuator drives it, whatever its valve in the file; the others go on by theirs.
#[test]
fn measured_pressures_drive_some_actuators() {
    let folder = Folder::new("identify-arm-pressure");
    let drawn = example("plant/arm.toml");
    folder.file("arm.toml", &format!("{drawn}\n[actuators.deltoid.valve]\nefficiency = 0.4\n"));
    folder.file("truth.toml", &drawn);
    let set = [
        "-s",
        "run.duration=0.6 s",
        "-s",
        "run.sample_interval=0.5 ms",
        "-s",
        "mechanism.joints.shoulder.inertia=6e-3 kg*m^2",
    ];
    let set = [&set[..], &["-s", "actuators.latissimus.turns=2.7"]].concat();
    let made =
        folder.mckibben().args(["simulate", "truth.toml", "-o", "moves.csv"]).args(set).output().expect("it runs");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let column = |name: &str, of: &str, unit: &str| format!("[columns.{name}]\nname = \"{of}\"\nunit = \"{unit}\"\n");
    let pressure = column("\"deltoid.absolute_pressure\"", "deltoid.absolute_pressure_pa", "Pa");
    let study = [
        "[study]\nkind = \"trajectories\"\nscenario = \"arm.toml\"\ninput = \"gauge-pressure\"\n".to_owned(),
        column("time", "time_s", "s"),
        column("\"shoulder.angle\"", "shoulder.angle_rad", "rad"),
        column("\"elbow.angular_velocity\"", "elbow.angular_velocity_rad_s", "rad/s"),
        column("\"latissimus.tension\"", "latissimus.tension_n", "N"),
        pressure.clone(),
        "[[run]]\nfile = \"moves.csv\"\n[fit.\"mechanism.joints.shoulder.inertia\"]\n[fit.\"actuators.latissimus.turns\"]\n".to_owned(),
        "[fit.\"columns.deltoid.absolute_pressure.offset\"]\nstart = \"2 kPa\"\n".to_owned(),
    ]
    .concat();
    let printed = printed(&identify(&folder, &folder.file("study.toml", &study)));
    assert!(printed.contains("the pressure of deltoid is the measured one"), "{printed}");
    let values = read(&folder, "out/values.csv");
    for (name, truth) in [("mechanism.joints.shoulder.inertia", 6e-3), ("actuators.latissimus.turns", 2.7)] {
        let value = cell(&values, name, "value");
        // Straight lines through a pressure every 0.5 ms.
        assert!((value / truth - 1.0).abs() < 2e-3, "{name}: {value} is not {truth}\n{printed}");
    }
    // The sensor that drives it has no offset.
    assert!(cell(&values, "columns.deltoid.absolute_pressure.offset", "value").abs() < 300.0, "{values}");
    // Of the quantities that are fitted the pressure is none.
    assert!(!read(&folder, "out/comparison.csv").contains("pressure of deltoid"));
    let found = Document::load(folder.path("out/scenario.toml")).expect("a scenario");
    let its = found.plant_experiment().expect("a file that runs").expect("a plant");
    assert!(its.plant.actuators()[0].pressure.is_some() && its.names.valves[0].is_none());
    assert!(its.plant.actuators()[1..].iter().all(|of| of.pressure.is_none()));
    assert!(its.names.valves[1..].iter().all(Option::is_some));
    let run = folder.mckibben().args(["simulate", "out/scenario.toml"]).output().expect("the program runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let output = identify(
        &folder,
        &folder.file(
            "study.toml",
            &study
                .replace(&pressure, "")
                .replace("columns.deltoid.absolute_pressure.offset", "actuators.deltoid.turns"),
        ),
    );
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && error.contains("columns.\"deltoid.gauge_pressure\""), "{error}");
}

#[test]
fn mistakes_in_a_study_of_a_plant_are_refused_in_words() {
    let folder = Folder::new("identify-arm-mistakes");
    folder.file("arm.toml", &example("plant/arm.toml"));
    folder.file("arm.csv", &example("identify/arm.csv"));
    let one = "[actuator]\npreset = \"colbrunn-2001\"\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[initial]\ngauge_pressure = \"60 psi\"\n[run]\nduration = \"0.1 s\"\n";
    folder.file("muscle.toml", one);
    let study = example("identify/arm.toml").replace("../plant/arm.toml", "arm.toml");
    let unnamed = "[columns.time]\nname = \"t\"\nunit = \"s\"\n[columns.angle]\nname = \"elbow\"\nunit = \"deg\"\n";
    let unnamed =
        format!("[study]\nkind = \"ring-down\"\nscenario = \"arm.toml\"\n{unnamed}[[run]]\nfile = \"arm.csv\"\n");
    let not_implemented = "where one actuator or joint is due";
    for (from, to, words) in [
        ("\"elbow.angle\"", "\"elbw.angle\"", &["the plant has no `elbw`", "shoulder, elbow, wrist, tank"][..]),
        ("\"elbow.angle\"", "\"elbow.tension\"", &["`deg` is no unit of tension"]),
        (
            "\"elbow.angle\"]\nname = \"elbow\"\nunit = \"deg\"",
            "\"elbow.velocity\"]\nname = \"elbow\"\nunit = \"m/s\"",
            &["`elbow` of the plant has no `velocity`", "it has angle, angular_velocity, torque"],
        ),
        ("\"elbow.angle\"", "\"elbow.angel\"", &["`angel` is no quantity of a plant's part", "angular_velocity"]),
        ("\"elbow.angle\"", "angle", &["a column of no part of the plant: angle", "[columns.\"shoulder.angle\"]"]),
        (
            "[columns.time]\nname = \"t\"\nunit = \"s\"\n",
            "",
            &["no gauge pressure of biceps over time", "[columns.time]"],
        ),
        ("actuators.biceps.turns", "actuators.bicep.turns", &["`actuators.bicep.turns`", "`biceps`"]),
        ("actuators.biceps.turns", "biceps.turns", &["did you mean `actuators.biceps.turns`?"]),
        ("actuators.biceps.turns", "actuators.biceps.turn", &["is no key of a plant"]),
        ("supplies.tank.reservoir_volume", "supplies.bottle.reservoir_volume", &["supplies.bottle", "`tank`"]),
        ("supplies.tank.reservoir_volume", "actuators.triceps.command.state[0]", &["is no"]),
        ("[[run]]", "[search]\nsegments = \"0.1 s\"\n[[run]]", &["not implemented", "search.horizon"]),
        ("kind = \"trajectories\"", "kind = \"ring-down\"", &["of a part of a plant", "set kind = \"trajectories\""]),
        ("\"arm.toml\"", "\"muscle.toml\"", &["its scenario names no parts", "[columns.length]"]),
    ] {
        assert!(study.contains(from), "{from}");
        let output = identify(&folder, &folder.file("study.toml", &study.replace(from, to)));
        refused(&folder, &output, words);
    }
    for kind in ["ring-down", "force-map", "hysteresis", "flow-curve", "steady-flow", "pulse-train"] {
        let output = identify(&folder, &folder.file("study.toml", &unnamed.replace("ring-down", kind)));
        refused(&folder, &output, &[not_implemented, "`identify` of trajectories"]);
    }
}

fn refused(folder: &Folder, output: &std::process::Output, words: &[&str]) {
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{error}");
    for words in words {
        assert!(error.contains(words), "`{words}` is not in\n{error}");
    }
    assert!(!folder.path("out").exists(), "something was written");
}
