//! A scenario of any kind as one plant with names.

use crate::failure::Failure;
use mckibben::Error;
use mckibben::network::NodeKind;
use mckibben::plant::Plant;
use mckibben_scenario::{Document, Engine, MechanismNames, PlantExperiment, PlantNames, Scenario};

/// The plant that a scenario of any kind describes; of one actuator or of a joint as [`experiment_of_one`] has it.
///
/// # Errors
/// Every mistake in the scenario, with its place.
pub fn experiment_of(document: &Document) -> Result<PlantExperiment, Failure> {
    if let Some(experiment) = document.plant_experiment()? {
        return Ok(experiment);
    }
    experiment_of_one(&open(&document.scenario()?)).map_err(|error| Failure::of_core(&error, document))
}

/// The plant of a scenario of one actuator, which is called `actuator`, or of a joint: `agonist` and `antagonist` on the mechanism
/// `load` with its joint `joint`. Controllers are left out.
///
/// # Errors
/// What the core finds contradictory.
pub fn experiment_of_one(scenario: &Scenario) -> Result<PlantExperiment, Error> {
    let (plant, start, run, actuators, mechanisms);
    if let Some(joint) = scenario.joint_experiment()? {
        plant = Plant::of_joint(&joint.rig)?;
        (start, run) = (Plant::start_of_joint(&joint.rig, &joint.start), joint.run);
        actuators = vec!["agonist".to_owned(), "antagonist".to_owned()];
        mechanisms = vec![MechanismNames { name: Some("load".to_owned()), joints: vec!["joint".to_owned()] }];
    } else {
        let alone = scenario.experiment()?;
        plant = Plant::of_rig(&alone.rig);
        (start, run) = (Plant::start_of_rig(&alone.rig, &alone.start), alone.run);
        actuators = vec!["actuator".to_owned()];
        mechanisms = vec![MechanismNames::default(); plant.mechanisms().len()];
    }
    let network = plant.network();
    // One valve drives both actuators of a joint where it has five ways.
    let valve_of = |actuator: usize| match network.valves.len() {
        0 => None,
        1 => Some(0),
        _ => Some(actuator),
    };
    let is_hose = |node: &mckibben::network::Node| matches!(node.kind, NodeKind::Hose(_));
    let hoses: Vec<usize> = (0..network.nodes.len()).filter(|node| is_hose(&network.nodes[*node])).collect();
    let count = actuators.len();
    let names = PlantNames {
        valves: (0..count).map(valve_of).collect(),
        hoses: (0..count).map(|actuator| hoses.get(actuator).copied()).collect(),
        actuators,
        mechanisms,
        ..PlantNames::default()
    };
    Ok(PlantExperiment { plant, start, run, names, controls: Vec::new() })
}

/// A scenario whose valves are commanded at run time.
pub fn open(scenario: &Scenario) -> Scenario {
    let mut open = scenario.open_loop();
    // What runs of fixed steps leave out is no limit here: the plant's steps take every part.
    open.run.engine = Engine::EventLocated;
    open
}
