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
    let text = model_description(&unit.model, "muscle", Version::Three, Interfaces::Both);
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
    assert!(distance.contains("unit=\"m\" displayUnit=\"mm\" min=\"0.0\" max=\"0.109"), "{distance}");
    assert!(distance.contains("start=\"0.09\""), "{distance}");
    let mass = line("load.mass");
    assert!(mass.contains("causality=\"parameter\" variability=\"tunable\" initial=\"exact\" unit=\"kg\""), "{mass}");
    assert!(line("initial.length").contains("causality=\"parameter\" variability=\"fixed\" initial=\"exact\""));
    assert!(line("actuator.tension").contains("causality=\"output\""));
    assert!(!text.contains("\"run.duration\"") && !text.contains("\"command.duty\""), "how it is run is the host's");
    let co_simulation = model_description(&unit.model, "muscle", Version::Two, Interfaces::CoSimulation);
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
    let bytes =
        unit(&model, "muscle", Version::Three, Interfaces::Both, std::slice::from_ref(&library)).expect("a unit");
    let holds = |name: &str| bytes.windows(name.len()).any(|window| window == name.as_bytes());
    assert!(bytes.starts_with(b"PK\x03\x04") && holds("binaries/x86_64-linux/mckibben.so") && holds("resources/"));
    let bytes = unit(&model, "muscle", Version::Two, Interfaces::Both, &[library]).expect("a unit");
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

/// The range of a set point ends at the supply.
#[test]
fn the_range_of_a_set_point_ends_at_the_supply() {
    let unit = Unit::new(REGULATED, &UnitOptions::default());
    let all = &unit.model.variables().all;
    let of = all.iter().find(|its| its.name == "actuator.set_point").expect("an input");
    assert_eq!((of.min, of.start.as_slice()), (Some(0.0), &[0.0][..]));
    assert!(of.max.is_some_and(|most| (most - 6e5).abs() < 1e-6), "{:?}", of.max);
}
