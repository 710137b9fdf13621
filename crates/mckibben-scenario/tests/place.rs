//! Numbers by their path: what is set is what is differentiated by, for every number of many scenarios.

use mckibben::plant::JointPlant;
use mckibben::simulation::{JointState, simulate};
use mckibben::valve::Ports;
use mckibben::{AbsolutePressure, Actuator, ActuatorState, Dual, Over, Real};
use mckibben_scenario::keys::KEYS;
use mckibben_scenario::{Document, Place, Scenario, Seeds};
use std::path::{Path, PathBuf};

fn examples(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(folder);
    let files = std::fs::read_dir(folder).expect("examples").map(|file| file.expect("a file").path());
    let mut files: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    files.sort();
    files
}

/// Every number of a scenario that has a path.
fn places(scenario: &mut Scenario) -> Vec<Place> {
    let mut found = Vec::new();
    for path in KEYS.iter().flat_map(|key| [key.path.to_owned(), format!("antagonist.{}", key.path)]) {
        found.extend(Place::find(&path, scenario));
        found.extend((0..).map_while(|index| Place::find(&format!("{path}[{index}]"), scenario).ok()));
    }
    found
}

/// What an actuator shows of its parameters without a run, at a length in m and an absolute pressure in Pa: static force,
/// volume, Coulomb friction, and the answer to ends that move with both ports open.
fn shown<S: Real>(actuator: &Actuator<S>, length: f64, pressure: f64) -> [S; 6] {
    let of = S::constant;
    let (length, pressure) = (of(length), of(pressure));
    let mut state = ActuatorState::new(AbsolutePressure(pressure), of(1e-4), length);
    let (further, velocity) = (length * of(1.001), of(0.02));
    actuator.remember(&mut state.memory, further, velocity);
    let answer = actuator.respond(&state, further, velocity, Ports { supply: true, exhaust: true });
    [
        actuator.static_force(length, pressure),
        actuator.volume(length),
        actuator.coulomb_bound(length, pressure),
        answer.tension,
        answer.pressure_rate,
        answer.mass_flow,
    ]
}

/// The central difference of a function of one number of a scenario, and how far it can be trusted.
fn difference<const N: usize>(scenario: &Scenario, place: &Place, of: impl Fn(&Scenario) -> [f64; N]) -> [f64; N] {
    let value = place.value(&mut scenario.clone()).expect("a number");
    let step = if value == 0.0 { 1e-6 } else { 1e-5 * value.abs() };
    let at = |value: f64| {
        let mut scenario = scenario.clone();
        assert!(place.set(&mut scenario, value).unwrap_or_else(|error| panic!("{error}")));
        of(&scenario)
    };
    // A number at the end of its range has one side.
    let inside = |value: f64| place.parameter().range.contains(value);
    let below = if inside(value - step) { value - step } else { value };
    let above = if inside(value + step) { value + step } else { value };
    let (low, high) = (at(below), at(above));
    std::array::from_fn(|of| (high[of] - low[of]) / (above - below))
}

/// Asserts that derivatives are those of differences, to a part of the quantity over the number.
fn compare(
    name: &str,
    place: &Place,
    value: f64,
    sizes: &[f64],
    exact: &[f64],
    differences: &[f64],
    relative: f64,
) -> bool {
    let mut sensitive = false;
    for (of, ((exact, difference), size)) in exact.iter().zip(differences).zip(sizes).enumerate() {
        let scale = size.abs() / if value == 0.0 { 1.0 } else { value.abs() };
        let allowed = relative * scale.max(difference.abs());
        let off = (exact - difference).abs();
        assert!(off <= allowed, "{name}, {}, quantity {of}: {exact:e} is not {difference:e}", place.path());
        sensitive |= exact.abs() > 1e-9 * scale;
    }
    sensitive
}

#[test]
fn every_number_of_an_actuator_is_differentiated_by_as_it_is_set() {
    let (mut sensitive, mut names) = (0, Vec::new());
    for path in ["laws", "friction", "valves", ""].into_iter().flat_map(examples) {
        let name = path.display().to_string();
        let scenario = Scenario::load(&path).unwrap_or_else(|error| panic!("{error}"));
        if scenario.driven().is_err() || scenario.of_antagonist().is_some() {
            continue; // Two actuators, or a controller.
        }
        let (length, pressure) = (0.93 * scenario.actuator.max_length, 4e5);
        let of = |scenario: &Scenario| {
            let driven = scenario.driven().unwrap_or_else(|error| panic!("{name}: {error}"));
            shown(&driven.actuator, length, pressure)
        };
        let sizes = of(&scenario);
        for place in places(&mut scenario.clone()) {
            let value = place.value(&mut scenario.clone()).expect("a number");
            let mut seeds = Seeds::new([place]);
            let actuator = scenario.driven().expect("an actuator").actuator;
            let seeded = actuator.map(|parameter, value| seeds.over::<{ mckibben::DIRECTIONS }>(parameter, value));
            // Numbers of solenoid, command, load and start; and parts that are absent at zero.
            if seeds.missed().count() > 0 {
                continue;
            }
            let exact = shown::<mckibben::Seeded>(&seeded, length, pressure).map(|number| number.slope[0]);
            // A zero may stand for a part that is absent: no friction has no direction.
            if value == 0.0 {
                continue;
            }
            if compare(&name, &place, value, &sizes, &exact, &difference(&scenario, &place, of), 1e-5) {
                sensitive += 1;
                names.push(place.path());
            }
        }
    }
    names.sort();
    names.dedup();
    // So many numbers move something; what moves nothing here belongs to solenoid, command, load or start.
    assert!(sensitive > 300 && names.len() > 60, "{sensitive}, {}: {names:?}", names.len());
}

#[test]
fn numbers_of_a_whole_run_are_differentiated_by_as_they_are_set() {
    let text = r#"
[actuator]
max_length = "3.85 in"
thread_length = "4.3218 in"
turns = 2.5
[actuator.effectiveness]
gauge_pressure = ["20 psi", "60 psi", "100 psi"]
value = [0.8, 0.9, 0.93]
[actuator.friction]
viscous = "3.5 N*s/m"
coulomb_width = "0.1 mm"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.4
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "25 psi"
[run]
duration = "0.11 s"
"#;
    let scenario = Scenario::from_str(text, "muscle.toml").unwrap_or_else(|error| panic!("{error}"));
    let of = |scenario: &Scenario| {
        let experiment = scenario.experiment().unwrap_or_else(|error| panic!("{error}"));
        let end = simulate(&experiment.rig, experiment.start, 0.11, 1e-12).expect("a run").at(0.11);
        [end.length, end.velocity, end.pressure.0, end.air_mass]
    };
    let sizes = of(&scenario);
    let mut names = Vec::new();
    for place in places(&mut scenario.clone()) {
        // How long and how exactly to run is no number of the model.
        if place.path().starts_with("run.") {
            continue;
        }
        let mut seeds = Seeds::new([place]);
        let experiment = scenario.experiment().expect("an experiment");
        let rig = experiment.rig.map(|parameter, value| seeds.over::<{ mckibben::DIRECTIONS }>(parameter, value));
        let start = scenario.initial().map(|parameter, value| seeds.over::<{ mckibben::DIRECTIONS }>(parameter, value));
        if seeds.missed().count() > 0 {
            continue;
        }
        let start = rig.begin(&start).expect("a start");
        let end = simulate(&rig, start, Dual::of(0.11), 1e-12).expect("a run").at(Dual::of(0.11));
        let exact = [end.length, end.velocity, end.pressure.0, end.air_mass].map(|number| number.slope[0]);
        let value = place.value(&mut scenario.clone()).expect("a number");
        if value == 0.0 {
            continue;
        }
        if compare("a run", &place, value, &sizes, &exact, &difference(&scenario, &place, of), 2e-4) {
            names.push(place.path());
        }
    }
    for expected in
        ["valve.opening_delay", "valve.closing_delay", "command.duty", "initial.gauge_pressure", "load.mass"]
    {
        assert!(names.iter().any(|name| name == expected), "{expected} is not among {names:?}");
    }
    assert!(names.len() >= 24, "{}: {names:?}", names.len());
}

/// Two actuators that differ in law, friction, valve and arm, on a limb that meets a stop.
const JOINT: &str = r#"
[actuator]
max_length = "3.85 in"
thread_length = "4.3218 in"
turns = 2.5
[actuator.effectiveness]
gauge_pressure = ["20 psi", "60 psi", "100 psi"]
value = [0.8, 0.9, 0.93]
[actuator.friction]
viscous = "3.5 N*s/m"
coulomb_width = "0.1 mm"
[supply]
gauge_pressure = "60 psi"
[valve]
preset = "matrix-eight-channel"
kind = "fill-hold-exhaust"
[command]
kind = "table"
time = ["0 s", "60 ms"]
state = ["fill", "hold"]
[load]
kind = "antagonistic-joint"
pulley_radius = "15 mm"
rest_length = "3.3 in"
mass = "0.5 kg"
distance = "100 mm"
inertia = "1e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
torque = "0.05 N*m"
hanging_angle = "3 deg"
min_angle = "-40 deg"
max_angle = "9 deg"
[initial]
gauge_pressure = "22 psi"
[antagonist]
initial.gauge_pressure = "25 psi"
load.moment_arm_angle = ["-30 deg", "0 deg", "30 deg"]
load.moment_arm = ["13 mm", "15 mm", "14 mm"]
load.rest_length = "3.32 in"
[antagonist.actuator]
turns = 2.4
[antagonist.actuator.effectiveness]
constant = 0.9
[antagonist.actuator.bladder]
form = "linear"
force = "20 N"
[antagonist.supply]
gauge_pressure = "50 psi"
[antagonist.valve]
opening_delay = "3 ms"
[antagonist.command]
kind = "pwm"
frequency = "30 Hz"
duty = 0.4
pulse = "exhaust"
rest = "hold"
[run]
duration = "0.11 s"
"#;

#[test]
fn numbers_of_a_joint_are_differentiated_by_as_they_are_set() {
    fn numbers<S>(state: JointState<S>) -> [S; 6] {
        let JointState { angle, angular_velocity, pressure: [first, second], air_mass: [mass, other] } = state;
        [angle, angular_velocity, first.0, second.0, mass, other]
    }
    let scenario = Scenario::from_str(JOINT, "joint.toml").unwrap_or_else(|error| panic!("{error}"));
    let experiment =
        |scenario: &Scenario| scenario.joint_experiment().unwrap_or_else(|error| panic!("{error}")).expect("a joint");
    let of = |scenario: &Scenario| {
        let of = experiment(scenario);
        numbers(
            JointPlant::new(&of.rig)
                .and_then(|joint| joint.simulate(&of.start, 0.11, 1e-12))
                .expect("a run")
                .at(0.11)
                .state(),
        )
    };
    let (sizes, plain) = (of(&scenario), experiment(&scenario).rig);
    let mut names = Vec::new();
    // Each actuator's own, and what both have in one.
    let own = places(&mut scenario.clone());
    let both = own.iter().filter(|place| place.path().starts_with("actuator.")).map(|place| place.of_both());
    let both: Vec<Place> = both.filter(|place| place.path().ends_with("thread_length")).collect();
    for (place, of_both) in own.into_iter().map(|of| (of, false)).chain(both.into_iter().map(|of| (of, true))) {
        let value = place.value(&mut scenario.clone()).expect("a number");
        // How long and how exactly to run is no number of the model; what is absent at zero is no part.
        if place.path().starts_with("run.") || value == 0.0 {
            continue;
        }
        let mut seeds = Seeds::new([place]);
        let rig =
            plain.map_of_each(|actuator, row, value| seeds.over_of::<{ mckibben::DIRECTIONS }>(actuator, row, value));
        let initial = scenario.joint_initial().expect("a joint");
        let initial =
            initial.map_of_each(|actuator, row, value| seeds.over_of::<{ mckibben::DIRECTIONS }>(actuator, row, value));
        if seeds.missed().count() > 0 {
            continue;
        }
        let start = rig.begin(&initial).expect("a start");
        let end = JointPlant::new(&rig)
            .and_then(|joint| joint.simulate(&start, Dual::of(0.11), 1e-12))
            .expect("a run")
            .at(Dual::of(0.11));
        let exact = numbers(end.state()).map(|number| number.slope[0]);
        if compare("a joint", &place, value, &sizes, &exact, &difference(&scenario, &place, of), 2e-4) {
            names.push(if of_both { format!("both {}", place.path()) } else { place.path() });
        }
    }
    for expected in [
        "load.inertia",
        "load.damping",
        "load.max_angle",
        "load.pulley_radius",
        "antagonist.load.moment_arm[1]",
        "antagonist.load.rest_length",
        "actuator.turns",
        "antagonist.actuator.turns",
        "both actuator.thread_length",
        "antagonist.actuator.effectiveness.constant",
        "antagonist.actuator.bladder.force",
        "antagonist.valve.opening_delay",
        "antagonist.command.duty",
        "command.time[1]",
        "antagonist.initial.gauge_pressure",
        "air.atmospheric_pressure",
    ] {
        assert!(names.iter().any(|name| name == expected), "{expected} is not among {names:?}");
    }
    assert!(names.len() >= 50, "{}: {names:?}", names.len());
}

#[test]
fn what_is_said_of_both_actuators_is_one_number_of_both() {
    let document = Document::parse(JOINT, "joint.toml").unwrap_or_else(|error| panic!("{error}"));
    for (path, both) in [
        ("actuator.thread_length", true),
        ("actuator.friction.viscous", true),
        ("actuator.wall_thickness", true),
        ("valve.closing_delay", true),
        ("initial.temperature", true),
        ("load.inertia", true),
        ("actuator.turns", false),
        ("actuator.effectiveness.value[1]", false),
        ("valve.opening_delay", false),
        ("supply.gauge_pressure", false),
        ("load.pulley_radius", false),
        ("initial.gauge_pressure", false),
    ] {
        assert_eq!(document.says_of_both(path), both, "{path}");
    }
    assert_eq!(document.says_of_each("actuator.bladder.force"), [false, true]);
    let mut scenario = document.scenario().unwrap_or_else(|error| panic!("{error}"));
    let second = |scenario: &mut Scenario| {
        Place::find("antagonist.actuator.turns", scenario).expect("a number").value(scenario).expect("a value")
    };
    let turns = Place::find("actuator.turns", &mut scenario).expect("a number");
    assert!(turns.set(&mut scenario, 2.6).expect("turns") && second(&mut scenario) == 2.4);
    assert!(turns.of_both().set(&mut scenario, 2.7).expect("turns") && second(&mut scenario) == 2.7);
    for (path, words) in [
        ("antagonist.actuator.turn", "`antagonist.actuator.turn` is no number"),
        ("antagonist.actuator.turn", "did you mean `antagonist.actuator.turns`?"),
        ("antagonist.load.mass", "is no number of one actuator alone; write `load.mass`"),
        ("antagonist.load.pulley_radius", "is no number of this scenario"),
        ("antagonist.load.moment_arm", "as in `antagonist.load.moment_arm[0]`"),
    ] {
        let error = Place::find(path, &mut scenario).expect_err(path).to_string();
        assert!(error.contains(words), "{error}");
    }
    let mut rig = Scenario::load(examples("friction").remove(2)).unwrap_or_else(|error| panic!("{error}"));
    let error = Place::find("antagonist.actuator.turns", &mut rig).expect_err("no joint").to_string();
    assert!(error.contains("load.kind = \"antagonistic-joint\""), "{error}");
}

#[test]
fn what_follows_from_a_number_has_its_share() {
    let mut scenario = Scenario::load(examples("")[0].clone()).unwrap_or_else(|error| panic!("{error}"));
    let thread = Place::find("actuator.thread_length", &mut scenario).expect("a number");
    let rate = 1.0 / 3_f64.sqrt();
    let mut seeds = Seeds::new([thread]).with_followers(&scenario, [true; 2]);
    assert!((seeds.over::<1>(&mckibben::parameter::MIN_LENGTH, 0.06).slope[0] - rate).abs() < 1e-15);
    assert_eq!(seeds.over::<1>(&mckibben::parameter::TURNS, 2.0).slope, [0.0]);
    let mut seeds = Seeds::new([thread]).with_followers(&scenario, [false; 2]);
    assert_eq!(seeds.over::<1>(&mckibben::parameter::MIN_LENGTH, 0.06).slope, [0.0]);
}

#[test]
fn a_list_has_its_entries() {
    let valves = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/valves").join(name);
        Scenario::load(path).unwrap_or_else(|error| panic!("{error}"))
    };
    let mut regulator = valves("pressure-regulator.toml");
    let points = Place::entries("command.gauge_pressure", &mut regulator).expect("set points");
    let mut value = |path: &String| {
        let place = Place::find(path, &mut regulator).expect("a set point");
        (place.path(), place.value(&mut regulator).expect("a value"))
    };
    let values: Vec<_> = points.iter().map(&mut value).collect();
    let expected = [4e5, 4.3e5, 1.5e5, 5e5].into_iter().enumerate();
    assert_eq!(
        values,
        expected.map(|(at, value)| (format!("command.gauge_pressure[{at}]"), value)).collect::<Vec<_>>()
    );
    assert_eq!(Place::entries("command.time", &mut regulator).map(|entries| entries.len()), Some(4));
    for path in ["command.position", "command.duty", "load.table_length", "antagonist.command.time"] {
        assert_eq!(Place::entries(path, &mut regulator), None, "{path}");
    }
    let mut spool = valves("proportional-spool.toml");
    assert_eq!(Place::entries("command.position", &mut spool).map(|entries| entries.len()), Some(6));
    let mut joint = Scenario::from_str(JOINT, "joint.toml").unwrap_or_else(|error| panic!("{error}"));
    let arms = Place::entries("antagonist.load.moment_arm", &mut joint).expect("moment arms");
    assert_eq!(arms.last().map(String::as_str), Some("antagonist.load.moment_arm[2]"));
    assert_eq!(Place::entries("load.moment_arm", &mut joint), None, "the agonist has a pulley");
}

#[test]
fn paths_that_are_no_numbers_are_refused() {
    let mut scenario = Scenario::load(examples("friction").remove(2)).unwrap_or_else(|error| panic!("{error}"));
    for (path, words) in [
        ("actuator.turn", "did you mean `actuator.turns`?"),
        ("actuator.turns[0]", "is no list"),
        ("actuator.friction.hysteresis.reach", "`actuator.friction.hysteresis.reach[0]`"),
        ("actuator.friction.hysteresis.reach[6]", "is no number of this scenario"),
        ("actuator.friction.hysteresis.reach[x]", "count from 0"),
        ("actuator.friction.hysteresis.beta", "is no number of this scenario"),
        ("load.kind", "one by one"),
        ("", "one by one"),
    ] {
        let error = Place::find(path, &mut scenario).expect_err(path).to_string();
        assert!(error.contains(words), "{error}");
    }
    let viscous = Place::find("actuator.friction.viscous", &mut scenario).expect("a number");
    let error = viscous.set(&mut scenario, -1.0).expect_err("negative").to_string();
    assert!(error.contains("actuator.friction.viscous"), "{error}");
}
