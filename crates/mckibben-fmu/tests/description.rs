//! What a description says: every variable with its unit, range and start, and references that stay.

mod common;

use common::{MUSCLE, REGULATED, Unit};
use mckibben_fmu::description::model_description;
use mckibben_fmu::export::{Library, unit};
use mckibben_fmu::model::Model;
use mckibben_fmu::options::{Interfaces, UnitOptions, Version};
use mckibben_fmu::variables::{BLOCK, Causality};
use mckibben_scenario::Document;

#[test]
fn variables_have_units_ranges_and_starts() {
    let unit = Unit::new(MUSCLE, &UnitOptions::default());
    let text = model_description(&unit.model, "muscle", Version::Three);
    let line = |name: &str| {
        let of = format!("name=\"{name}\"");
        text.lines().find(|line| line.contains(&of)).unwrap_or_else(|| panic!("no {name}")).trim().to_owned()
    };
    let duty = line("actuator.duty");
    assert!(
        duty.contains("causality=\"input\" variability=\"discrete\" min=\"0.0\" max=\"1.0\" start=\"0.0\""),
        "{duty}"
    );
    let distance = line("actuator.distance");
    assert!(distance.contains("unit=\"m\" displayUnit=\"mm\" max=\"0.109"), "{distance}");
    assert!(distance.contains("Must be greater than 0 m."), "zero is no distance: {distance}");
    assert!(distance.contains("start=\"0.09\""), "{distance}");
    let mass = line("load.mass");
    assert!(mass.contains("causality=\"parameter\" variability=\"tunable\" initial=\"exact\" unit=\"kg\""), "{mass}");
    assert!(line("initial.length").contains("causality=\"parameter\" variability=\"fixed\" initial=\"exact\""));
    assert!(line("actuator.tension").contains("causality=\"output\""));
    assert!(!text.contains("\"run.duration\"") && !text.contains("\"command.duty\""), "how it is run is the host's");
    let alone = UnitOptions { interfaces: Interfaces::CoSimulation, ..UnitOptions::default() };
    let co_simulation = model_description(&Unit::new(MUSCLE, &alone).model, "muscle", Version::Two);
    assert!(!co_simulation.contains("ModelExchange") && !co_simulation.contains("der("));
}

#[test]
fn references_stay_where_other_variables_come() {
    let unit = Unit::new(MUSCLE, &UnitOptions::default());
    assert_eq!(unit.reference("time"), 0);
    assert_eq!(unit.reference("actuator.duty"), BLOCK);
    assert_eq!(unit.reference("actuator.distance"), 2 * BLOCK);
    assert_eq!(unit.reference("actuator.length"), 4 * BLOCK);
    assert_eq!(unit.reference("tensions"), 9 * BLOCK + 3);
    let references: Vec<u32> = unit.model.variables().all.iter().map(|its| its.reference).collect();
    assert!(references.windows(2).all(|pair| pair[0] < pair[1]), "unique and in order");
}

/// An example of the repository.
fn example(path: &str) -> Document {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    Document::load(format!("{root}/{path}")).expect("an example")
}

/// No two continuous states share a name, and each is called after the part of the file that it is of.
#[test]
fn states_are_called_after_parts_of_the_file() {
    let hose = "[hose]\nlength = \"1 m\"\ndiameter = \"2.5 mm\"\nkind = \"distributed\"\ncells = 2\n";
    let unit = Unit::new(&format!("{hose}{MUSCLE}"), &UnitOptions::default());
    let names = unit.model.variables().all.iter().filter_map(|its| its.name.strip_prefix("state."));
    let names: Vec<&str> = names.collect();
    let air = ["hose_absolute_pressure_1", "hose_absolute_pressure_2", "hose_mass_flow_1", "hose_mass_flow_2"];
    for of in air {
        assert!(names.contains(&format!("actuator.{of}").as_str()), "{names:?}");
    }
    let distinct: std::collections::BTreeSet<&str> = names.iter().copied().collect();
    assert_eq!(distinct.len(), names.len(), "{names:?}");
}

#[test]
fn the_resources_are_the_scenario() {
    let text = MUSCLE.replace("step = \"0.5 ms\"\n", "");
    let document = Document::parse(&text, "muscle.toml").expect("TOML");
    let options = UnitOptions { motion: mckibben_run::host::Motion::Scenario, ..UnitOptions::default() };
    let model = Model::new(document, options).expect("a scenario");
    assert!(model.document().contains("run.step"), "a step is chosen once");
    let again = Document::parse(&model.document().to_toml(), "scenario.toml").expect("TOML");
    let again = Model::new(again, model.options().clone()).expect("a scenario");
    assert_eq!(again.token(), model.token());
    let library = Library { architecture: "x86_64", system: "linux", bytes: b"library".to_vec() };
    let bytes = unit(&model, "muscle", Version::Three, std::slice::from_ref(&library)).expect("a unit");
    let holds = |name: &str| bytes.windows(name.len()).any(|window| window == name.as_bytes());
    assert!(bytes.starts_with(b"PK\x03\x04") && holds("binaries/x86_64-linux/mckibben.so") && holds("resources/"));
    let bytes = unit(&model, "muscle", Version::Two, &[library]).expect("a unit");
    let holds = |name: &str| bytes.windows(name.len()).any(|window| window == name.as_bytes());
    assert!(holds("binaries/linux64/mckibben.so"));
}

/// A supply whose pressure changes is an output and a state; the parameter of the same path has another name.
#[test]
fn a_supply_that_changes_is_an_output() {
    let text = MUSCLE.replace("[valve]", "reservoir_volume = \"50 mL\"\n[valve]");
    let unit = Unit::new(&text, &UnitOptions::default());
    let of = |name: &str| unit.model.variables().all.iter().find(|its| its.name == name).map(|its| its.causality);
    assert_eq!(of("supply.gauge_pressure"), Some(Causality::Output));
    assert_eq!(of("state.supply.absolute_pressure"), Some(Causality::Local));
    assert!(matches!(of("scenario.supply.gauge_pressure"), Some(Causality::Parameter { .. })));
    assert!(matches!(of("supply.reservoir_volume"), Some(Causality::Parameter { .. })));
}

/// The pressure of a supply is a start where air is stored at it, and tunable where mains or a regulator keep it.
#[test]
fn the_pressure_of_a_tank_is_a_start() {
    for (path, name, is_tunable) in [
        ("plant/arm.toml", "supplies.tank.gauge_pressure", false),
        ("plant/arm.toml", "supplies.regulator.gauge_pressure", true),
        ("plant/bottle.toml", "scenario.supply.gauge_pressure", false),
        ("line/tank.toml", "scenario.supply.gauge_pressure", true),
        ("paper/fig-12.toml", "supply.gauge_pressure", true),
    ] {
        let model = Model::new(example(path), UnitOptions::default()).expect("a scenario");
        let its = model.variables().all.iter().find(|its| its.name == name).expect("a parameter");
        assert_eq!(its.causality, Causality::Parameter { is_tunable }, "{path}: {name}");
    }
}

/// The range of a set point ends at the supply.
#[test]
fn the_range_of_a_set_point_ends_at_the_supply() {
    let unit = Unit::new(REGULATED, &UnitOptions::default());
    let all = &unit.model.variables().all;
    let of = all.iter().find(|its| its.name == "actuator.set_point").expect("an input");
    assert_eq!((of.min, of.start.as_slice()), (Some(0.0), &[0.0][..]));
    assert!(of.max.is_some_and(|most| (most - 6e5).abs() < 1e-6), "{:?}", of.max);
}

/// A set point starts at the initial gauge pressure of the actuator, which the regulator gives before its first command; at zero where
/// the supply cannot give that.
#[test]
fn a_set_point_starts_at_the_initial_pressure() {
    for (initial, start) in [("1.5 bar", 1.5e5), ("7 bar", 0.0)] {
        let text =
            REGULATED.replace("length = \"90 mm\"", &format!("length = \"90 mm\"\ngauge_pressure = \"{initial}\""));
        let unit = Unit::new(&text, &UnitOptions::default());
        for name in ["actuator.set_point", "commands"] {
            let its = unit.model.variables().all.iter().find(|its| its.name == name).expect("an input");
            assert!((its.start[0] - start).abs() < 1e-6, "{name} starts at {:?} Pa for {initial}", its.start);
        }
    }
}

/// The element of a variable in a description.
fn element<'t>(text: &'t str, name: &str) -> &'t str {
    let of = format!("name=\"{name}\"");
    text.lines().find(|line| line.contains(&of)).unwrap_or_else(|| panic!("no {name}")).trim()
}

/// Each description names the quantity and its part; none is shared by two scalars, and a power is written in one way.
#[test]
fn descriptions_name_the_part() {
    for (path, expected) in [
        ("paper/fig-12.toml", &[("actuator.temperature", "Temperature of the air in the actuator.")][..]),
        (
            "plant/leg.toml",
            &[
                ("hip-forward.gauge_pressure", "Gauge pressure of the air in the actuator `hip-forward`."),
                ("knee.angle", "Angle of the joint `knee`."),
                ("hip.torque", "Torque of the actuators on the joint `hip`."),
                ("state.knee.rate", "Angular velocity of the joint `knee`."),
                ("der(state.knee.rate)", "Time derivative of `state.knee.rate`."),
            ],
        ),
        ("line/hanging-mass.toml", &[]),
        ("plant/bottle.toml", &[]),
        ("friction/creep.toml", &[]),
    ] {
        let motion = mckibben_run::host::Motion::Scenario;
        let options = UnitOptions { motion, interfaces: Interfaces::ModelExchange, ..UnitOptions::default() };
        let model = Model::new(example(path), options).expect("a scenario");
        let text = model_description(&model, "unit", Version::Three);
        for (name, sentence) in expected {
            let element = element(&text, name);
            assert!(element.contains(&format!("description=\"{sentence}\"")), "{path}: {element}");
        }
        assert!(!text.contains("\"m3\"") && text.contains("unit=\"m^3\""), "{path}: one unit of volume");
        let computed = model
            .variables()
            .all
            .iter()
            .filter(|its| matches!(its.causality, Causality::Output | Causality::Local) && its.dimension.is_none());
        let mut sentences: Vec<(&str, &str)> =
            computed.map(|its| (its.description.as_str(), its.name.as_str())).collect();
        // A state that is an output too has its sentence there.
        sentences.retain(|(_, name)| !name.starts_with("state."));
        sentences.sort_unstable();
        for pair in sentences.windows(2) {
            assert_ne!(pair[0].0, pair[1].0, "{path}: {} and {}", pair[0].1, pair[1].1);
        }
    }
}

/// FMI's ranges include their ends: an end that a parameter excludes stands in its description alone.
#[test]
fn a_range_without_its_end_stands_in_the_description() {
    let unit = Unit::new(MUSCLE, &UnitOptions::default());
    let mut excluded = 0;
    for (number, its) in unit.model.variables().parameters.iter().map(|number| {
        (number, unit.model.variables().all.iter().find(|its| its.name == number.path).expect("a variable"))
    }) {
        let range = number.parameter.range;
        assert!(its.min.is_none_or(|min| number.parameter.check(min).is_ok()), "{}: {:?}", its.name, its.min);
        if range.low.is_finite() && !range.low_included {
            assert!(its.description.contains("Must be greater than"), "{}: {}", its.name, its.description);
            excluded += 1;
        }
    }
    assert!(excluded > 0, "load.mass excludes zero");
}

/// A unit says which controllers of the file it leaves out.
#[test]
fn controllers_that_are_left_out_are_named() {
    let text = |path| {
        let model = Model::new(example(path), UnitOptions::default()).expect("a scenario");
        model_description(&model, "unit", Version::Two)
    };
    let of_plant = text("plant/controlled.toml");
    let [elbow, gripper] = ["elbow", "gripper"].map(|name| of_plant.contains(&format!("`{name}`")));
    assert!(elbow && gripper && of_plant.contains("are left out: the host commands the valves."), "{of_plant}");
    assert!(text("control/pid.toml").contains("The controller of `load` is left out"));
    assert!(text("control/joint-bang-bang.toml").contains("The controller of `load` is left out"));
    assert!(!text("paper/fig-12.toml").contains("left out"));
}

/// Model exchange uses no step, so none is searched for, not even where none would be accurate enough.
#[test]
fn model_exchange_needs_no_step() {
    let motion = mckibben_run::host::Motion::Scenario;
    let options = UnitOptions { motion, interfaces: Interfaces::ModelExchange, ..UnitOptions::default() };
    let model = Model::new(example("friction/lugre.toml"), options.clone()).expect("no step is needed");
    assert!(!model.document().contains("run.step"), "none was chosen");
    let again = Document::parse(&model.document().to_toml(), "scenario.toml").expect("TOML");
    assert_eq!(Model::new(again, options).expect("the library needs none either").token(), model.token());
}
