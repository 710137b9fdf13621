//! A scenario of any kind as one plant with names.

use crate::failure::Failure;
use mckibben::Error;
use mckibben::network::{BranchKind, NodeKind};
use mckibben::plant::Plant;
use mckibben_scenario::{Document, Engine, MechanismNames, PlantExperiment, PlantNames, Scenario};

/// The plant that a scenario of any kind describes; of one actuator or of a joint as [`experiment_of_one`] has it.
///
/// # Errors
/// Every mistake in the scenario, with its place.
pub fn experiment_of(document: &Document) -> Result<PlantExperiment, Failure> {
    match document.plant_experiment()? {
        Some(experiment) => Ok(experiment),
        None => experiment_in(document, &document.scenario()?),
    }
}

/// The plant as [`experiment_of`] has it, and the document that describes it: of one actuator or of a joint with the values of its presets.
pub(super) fn described(document: &Document) -> Result<(PlantExperiment, Document), Failure> {
    if let Some(experiment) = document.plant_experiment()? {
        return Ok((experiment, document.clone()));
    }
    let scenario = document.scenario()?;
    Ok((experiment_in(document, &scenario)?, Document::parse(&scenario.to_toml(), document.source().name())?))
}

/// The plant of a scenario of one actuator or of a joint that was read from a document.
fn experiment_in(document: &Document, scenario: &Scenario) -> Result<PlantExperiment, Failure> {
    experiment_of_one(&open(scenario)).map_err(|error| Failure::of_core(&error, document))
}

/// The plant of a scenario of one actuator, which is called `actuator`, or of a joint: `agonist` and `antagonist` on the mechanism
/// `load` with its joint `joint`. Controllers are left out.
///
/// A supply whose pressure changes is called `supply`; of a joint with separate supplies `agonist_supply` and `antagonist_supply`.
/// Where it has reservoir and regulator both, the reservoir is `supply.reservoir`, as in files with named supplies.
///
/// # Errors
/// What the core finds contradictory.
pub fn experiment_of_one(scenario: &Scenario) -> Result<PlantExperiment, Error> {
    let (plant, start, run, actuators, mechanisms, has_own_supplies);
    if let Some(joint) = scenario.joint_experiment()? {
        plant = Plant::of_joint(&joint.rig)?;
        (start, run) = (Plant::start_of_joint(&joint.rig, &joint.start), joint.run);
        actuators = vec!["agonist".to_owned(), "antagonist".to_owned()];
        has_own_supplies = joint.rig.shared_supply().is_none();
        mechanisms = vec![MechanismNames { name: Some("load".to_owned()), joints: vec!["joint".to_owned()] }];
    } else {
        let alone = scenario.experiment()?;
        plant = Plant::of_rig(&alone.rig);
        (start, run) = (Plant::start_of_rig(&alone.rig, &alone.start), alone.run);
        actuators = vec!["actuator".to_owned()];
        has_own_supplies = false;
        mechanisms = vec![MechanismNames::default(); plant.mechanisms().len()];
    }
    let network = plant.network();
    let is_first =
        |node: usize| matches!(network.nodes[node].kind, NodeKind::Hose(_)) && network.hose_start(node) == node;
    let hoses: Vec<usize> = (0..network.nodes.len()).filter(|node| is_first(*node)).collect();
    let count = actuators.len();
    let names = PlantNames {
        hoses: (0..count).map(|actuator| hoses.get(actuator).copied()).collect(),
        actuators,
        mechanisms,
        ..PlantNames::default()
    };
    let mut experiment = PlantExperiment { plant, start, run, names, controls: Vec::new() };
    experiment.names.nodes = supplies(&experiment, has_own_supplies);
    experiment.names.valves = experiment.names.actuators.iter().map(|name| valve_of(&experiment, name)).collect();
    Ok(experiment)
}

/// The valve through which an actuator is fed, if there is one.
fn valve_of(of: &PlantExperiment, actuator: &str) -> Option<usize> {
    of.plant.network().branches.iter().find_map(|branch| match branch.kind {
        BranchKind::Path { valve, .. } if of.owner_of_node(branch.to) == actuator => Some(valve),
        _ => None,
    })
}

/// The names of the nodes that are supplies whose pressure changes; each is called after its actuator where that shares it with no other.
fn supplies(of: &PlantExperiment, has_own_supplies: bool) -> Vec<(String, usize)> {
    let network = of.plant.network();
    let reservoir_of = |node: usize| match network.nodes[node].kind {
        NodeKind::Outlet { inlet, .. } => inlet,
        _ => None,
    };
    let is_supply = |node: &usize| {
        let changes = matches!(network.nodes[*node].kind, NodeKind::Reservoir(_) | NodeKind::Outlet { .. });
        changes && !(0..network.nodes.len()).any(|other| reservoir_of(other) == Some(*node))
    };
    let mut names = Vec::new();
    for node in (0..network.nodes.len()).filter(is_supply) {
        let owner = Some(of.owner_of_node(node)).filter(|owner| has_own_supplies && !owner.is_empty());
        let name = owner.map_or_else(|| "supply".to_owned(), |owner| format!("{owner}_supply"));
        names.extend(reservoir_of(node).map(|tank| (format!("{name}.reservoir"), tank)));
        names.push((name, node));
    }
    names
}

/// A scenario whose valves are commanded at run time.
pub fn open(scenario: &Scenario) -> Scenario {
    let mut open = scenario.open_loop();
    // What runs of fixed steps leave out is no limit here: the plant's steps take every part.
    open.run.engine = Engine::EventLocated;
    open
}
