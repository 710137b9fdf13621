//! What is observed of each plant: the columns of a run that are states, and what little else a file of one actuator has.

use mckibben::Error;
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::plant::Plant;
use mckibben_batch::PlantBatch;
use mckibben_scenario::{PlantExperiment, PlantQuantity};

/// A column with where its number is.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub(super) name: String,
    source: Source,
}

/// Where a number is.
#[derive(Clone, Copy, Debug)]
enum Source {
    State(usize),
    /// In a sample, which takes an evaluation.
    Sample(PlantQuantity),
}

/// Those of a file of one actuator or of a joint, by the names of its runs.
pub(super) fn of_short(plant: &Plant) -> Vec<Column> {
    use PlantQuantity as Q;
    let is_joint = matches!(plant.mechanisms(), [Mechanism::Chain(_)]);
    let columns: &[(&str, Q)] = if is_joint {
        &[
            ("angle_rad", Q::Position(0, 0)),
            ("angular_velocity_rad_s", Q::Rate(0, 0)),
            ("absolute_pressure_pa", Q::Pressure(0)),
            ("air_mass_kg", Q::AirMass(0)),
            ("antagonist_absolute_pressure_pa", Q::Pressure(1)),
            ("antagonist_air_mass_kg", Q::AirMass(1)),
        ]
    } else {
        &[
            ("length_m", Q::Length(0)),
            ("velocity_m_s", Q::Velocity(0)),
            ("absolute_pressure_pa", Q::Pressure(0)),
            ("air_mass_kg", Q::AirMass(0)),
        ]
    };
    let column = |&(name, quantity): &(&str, Q)| Column {
        name: name.to_owned(),
        source: state(plant, quantity).map_or(Source::Sample(quantity), Source::State),
    };
    columns.iter().map(column).collect()
}

/// Those of a file in which actuators have names: the columns of its runs that are states.
pub(super) fn of_named(experiment: &PlantExperiment) -> Vec<Column> {
    let columns = experiment.columns();
    let column = |column: &mckibben_scenario::PlantColumn| {
        let place = state(&experiment.plant, column.quantity()?)?;
        Some(Column { name: column.title(), source: Source::State(place) })
    };
    columns.iter().filter_map(column).collect()
}

/// The place of a quantity among the states, if it is one.
fn state(plant: &Plant, quantity: PlantQuantity) -> Option<usize> {
    use PlantQuantity as Q;
    let places = plant.indices();
    let spans = |actuator: usize| {
        let mounted = &plant.actuators()[actuator];
        let Coupling::Direct { coordinate } = mounted.coupling else { return None };
        Some((&places.mechanisms[mounted.mechanism], coordinate))
    };
    let is_rigid = |actuator: usize| plant.actuators()[actuator].tendon.is_none();
    match quantity {
        Q::Length(actuator) if !is_rigid(actuator) => places.actuators[actuator].length,
        Q::Length(actuator) | Q::LoadDistance(actuator) => spans(actuator).map(|(its, of)| its.position(of)),
        Q::Velocity(actuator) if !is_rigid(actuator) => None,
        Q::Velocity(actuator) | Q::LoadVelocity(actuator) => spans(actuator).map(|(its, of)| its.rate(of)),
        Q::Pressure(actuator) => Some(places.actuators[actuator].pressure),
        Q::AirMass(actuator) => Some(places.actuators[actuator].mass()),
        Q::Position(mechanism, of) => Some(places.mechanisms[mechanism].position(of)),
        Q::Rate(mechanism, of) => Some(places.mechanisms[mechanism].rate(of)),
        Q::NodePressure(node) => places.nodes[node],
        Q::GaugePressure(_)
        | Q::Contraction(_)
        | Q::NodeGaugePressure(_)
        | Q::Temperature(_)
        | Q::Volume(_)
        | Q::Tension(_)
        | Q::MassFlow(_)
        | Q::Force(..)
        | Q::SetPoint(..) => None,
    }
}

/// Writes the columns of a plant of a batch where it is now; `state` has room for its states.
///
/// # Errors
/// What stopped it.
pub(super) fn write(
    columns: &[Column],
    (batch, row): (&mut PlantBatch, usize),
    state: &mut [f64],
    into: &mut [f64],
) -> Result<(), Error> {
    batch.read(row, state)?;
    for (into, column) in into.iter_mut().zip(columns) {
        if let Source::State(place) = column.source {
            *into = state[place];
        }
    }
    if columns.iter().any(|column| matches!(column.source, Source::Sample(_))) {
        let steps = batch.row(row)?;
        let sample = steps.sample();
        for (into, column) in into.iter_mut().zip(columns) {
            if let Source::Sample(quantity) = column.source {
                *into = quantity.of(steps.plant(), &sample);
            }
        }
    }
    Ok(())
}
