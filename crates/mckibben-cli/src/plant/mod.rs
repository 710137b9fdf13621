//! The run of a plant of several actuators: its columns, its events, its figure, and what it came to.
//!
//! | file | its idea |
//! |---|---|
//! | `columns` | columns with the names of the file: `flexor.pressure_pa`, `knee.angle_rad`, `tank.pressure_pa` |
//! | `events` | the log of events |
//! | `portrait` | the figure |
//! | `summary` | the summary |
//!
//! Checked by `tests/plant.rs`.

pub(crate) mod columns;
pub(crate) mod events;
pub(crate) mod portrait;
pub(crate) mod summary;

use crate::engine::Way;
use crate::failure::Failure;
use mckibben::Error;
use mckibben::mechanism::Mechanism;
use mckibben::network::{Network, NodeKind};
use mckibben::parameter;
use mckibben::plant::{self, Part, PlantSample, PlantTrajectory};
use mckibben_scenario::PlantExperiment;

/// The run of a plant.
#[derive(Clone, Debug)]
pub struct PlantRun {
    /// What was simulated.
    pub experiment: PlantExperiment,
    /// The run.
    pub trajectory: PlantTrajectory,
}

impl PlantRun {
    /// Hands the sample at t = 0, at every sample interval and at the end to `each`.
    pub(crate) fn each_sample(&self, each: &mut dyn FnMut(&PlantSample) -> Result<(), Failure>) -> Result<(), Failure> {
        self.trajectory.samples(self.experiment.run.sample_interval).try_for_each(|sample| each(&sample))
    }
}

/// Runs a plant and keeps every step. `reached` hears the time in s now and then, and may end the run.
///
/// # Errors
/// What the core finds.
pub fn run(of: PlantExperiment, reached: &mut dyn FnMut(f64) -> Result<(), Error>) -> Result<PlantRun, Error> {
    let mut way = Way::begin(&of.run);
    let (duration, tolerance) = (of.run.duration, of.run.relative_tolerance);
    parameter::DURATION.check(duration)?;
    let mut run = plant::PlantRun::new(&of.plant, &of.start, tolerance)?;
    let trajectory = run.record_to(duration, &mut |time| {
        way.at(time);
        reached(time)
    })?;
    Ok(PlantRun { experiment: of, trajectory })
}

/// A coordinate of a mechanism with the name that it has in columns and figures.
pub(crate) struct Coordinate {
    pub(crate) name: String,
    pub(crate) mechanism: usize,
    pub(crate) index: usize,
    pub(crate) is_angle: bool,
}

/// The coordinates that have names: of every mechanism but the loads of single actuators, whose length says it.
pub(crate) fn coordinates(of: &PlantExperiment) -> Vec<Coordinate> {
    let mut coordinates = Vec::new();
    for (mechanism, (names, its)) in of.names.mechanisms.iter().zip(of.plant.mechanisms()).enumerate() {
        let Some(name) = &names.name else { continue };
        match its {
            Mechanism::Chain(_) => {
                coordinates.extend(names.joints.iter().enumerate().map(|(index, joint)| Coordinate {
                    name: joint.clone(),
                    mechanism,
                    index,
                    is_angle: true,
                }))
            }
            _ => coordinates.push(Coordinate { name: name.clone(), mechanism, index: 0, is_angle: false }),
        }
    }
    coordinates
}

/// The node that a regulating valve makes its pressure in.
pub(crate) fn port_of(network: &Network, valve: usize) -> Option<usize> {
    network.nodes.iter().position(|node| matches!(node.kind, NodeKind::Port { valve: its, .. } if its == valve))
}

/// What the file calls a part; of what it does not name, what that belongs to.
pub(crate) fn name_of(of: &PlantExperiment, part: Part) -> &str {
    let names = &of.names;
    let actuator = |index: usize| names.actuators.get(index).map_or("", String::as_str);
    let network = of.plant.network();
    let node = |mut node: usize| {
        // A hose or a regulating valve belongs to what it leads to.
        for _ in 0..=network.branches.len() {
            if let Some((name, _)) = names.nodes.iter().find(|(_, its)| *its == node) {
                return name.as_str();
            }
            if let NodeKind::Chamber { actuator: index } = network.nodes[node].kind {
                return actuator(index);
            }
            match network.branches.iter().find(|branch| branch.from == node) {
                Some(branch) => node = branch.to,
                None => return "",
            }
        }
        ""
    };
    match part {
        Part::Actuator(index) => actuator(index),
        Part::Mechanism(index) => {
            let alone = || of.plant.actuators().iter().position(|mounted| mounted.mechanism == index);
            let named = names.mechanisms.get(index).and_then(|its| its.name.as_deref());
            named.or_else(|| Some(actuator(alone()?))).unwrap_or("")
        }
        Part::Joint(index, joint) => {
            names.mechanisms.get(index).and_then(|its| its.joints.get(joint)).map_or("", String::as_str)
        }
        Part::Valve(valve) => match names.valves.iter().position(|its| *its == Some(valve)) {
            Some(index) => actuator(index),
            None => names.supply_valves.iter().find(|(_, its)| *its == valve).map_or("", |(name, _)| name.as_str()),
        },
        Part::Node(index) => node(index),
        Part::Branch(index) => network.branches.get(index).map_or("", |branch| node(branch.to)),
        // A file of a plant has none.
        Part::Driver(_) => "",
    }
}
