//! What is read of a run: a quantity of one actuator or joint, or a column of a plant.

use crate::study::Quantity;
use mckibben::Scalar;
use mckibben::mechanism::Mechanism;
use mckibben::network::NodeKind;
use mckibben::plant::Plant;
use mckibben_scenario::{PlantExperiment, PlantQuantity};
use std::sync::Arc;

/// The quantity of a time series; length, pressure, tension, temperature and mass flow of a joint are its agonist's.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub enum Observed {
    /// Distance between the attachments in m.
    Length,
    /// Gauge pressure in Pa.
    GaugePressure,
    /// Tension in N.
    Tension,
    /// Angle of a joint in rad.
    Angle,
    /// Its rate in rad/s.
    AngularVelocity,
    /// Torque of both actuators on a joint in N·m.
    Torque,
    /// Distance between the attachments of a joint's antagonist in m.
    AntagonistLength,
    /// Its gauge pressure in Pa.
    AntagonistGaugePressure,
    /// Its tension in N.
    AntagonistTension,
    /// Gauge pressure in Pa at the end of the hose that the valve opens into.
    HoseGaugePressure,
    /// Temperature of the air in the actuator in K.
    Temperature,
    /// Mass flow into it in kg/s.
    MassFlow,
    /// A column of a plant whose parts have names.
    Column(Arc<ObservedColumn>),
}

/// A column of a plant.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub struct ObservedColumn {
    /// The part.
    pub part: String,
    /// What was measured of it.
    pub measured: Quantity,
    /// Where that is in the plant.
    pub quantity: PlantQuantity,
}

impl Observed {
    /// Those of one actuator or joint.
    pub const ALL: [Self; 12] = [
        Self::Length,
        Self::GaugePressure,
        Self::Tension,
        Self::Angle,
        Self::AngularVelocity,
        Self::Torque,
        Self::AntagonistLength,
        Self::AntagonistGaugePressure,
        Self::AntagonistTension,
        Self::HoseGaugePressure,
        Self::Temperature,
        Self::MassFlow,
    ];

    /// A column of a plant, as its file calls the part, if there is one.
    pub fn of_part(of: &PlantExperiment, part: &str, measured: Quantity) -> Option<Self> {
        let name = format!("{part}.{}", measured.column()?);
        let quantity = of.columns().iter().find(|column| column.name == name)?.quantity()?;
        Some(Self::Column(Arc::new(ObservedColumn { part: part.to_owned(), measured, quantity })))
    }

    /// What it is in a study.
    pub fn quantity(&self) -> Quantity {
        match self {
            Self::Length => Quantity::Length,
            Self::GaugePressure => Quantity::GaugePressure,
            Self::Tension => Quantity::Tension,
            Self::Angle => Quantity::Angle,
            Self::AngularVelocity => Quantity::AngularVelocity,
            Self::Torque => Quantity::Torque,
            Self::AntagonistLength => Quantity::AntagonistLength,
            Self::AntagonistGaugePressure => Quantity::AntagonistGaugePressure,
            Self::AntagonistTension => Quantity::AntagonistTension,
            Self::HoseGaugePressure => Quantity::HoseGaugePressure,
            Self::Temperature => Quantity::Temperature,
            Self::MassFlow => Quantity::MassFlow,
            Self::Column(column) => column.measured,
        }
    }

    /// In words.
    pub fn words(&self) -> String {
        let words = self.quantity().words();
        match self {
            Self::Column(column) => format!("{words} of {}", column.part),
            _ => words.to_owned(),
        }
    }

    /// SI unit.
    pub fn unit(&self) -> &'static str {
        self.quantity().unit()
    }

    /// Its place among [`Observed::ALL`], if it is one of these.
    pub fn index(&self) -> Option<usize> {
        Self::ALL.iter().position(|of| of == self)
    }

    /// Whether it is of one actuator or joint, and only a joint has it.
    pub fn is_of_joint(&self) -> bool {
        self.index().is_some_and(|index| (3..9).contains(&index))
    }

    /// Where it is in a plant, and whether it counts from the atmosphere; none where the plant has none such.
    pub(super) fn place<S: Scalar>(&self, plant: &Plant<S>) -> Option<(PlantQuantity, bool)> {
        use PlantQuantity as Q;
        let actuator = usize::from(self.index().is_some_and(|index| (6..9).contains(&index)));
        let has_joint = matches!(plant.mechanisms().first(), Some(Mechanism::Chain(_)));
        if plant.actuators().len() <= actuator || self.is_of_joint() && !has_joint {
            return None;
        }
        Some(match self {
            Self::Length | Self::AntagonistLength => (Q::Length(actuator), false),
            Self::GaugePressure | Self::AntagonistGaugePressure => (Q::Pressure(actuator), true),
            Self::Tension | Self::AntagonistTension => (Q::Tension(actuator), false),
            Self::HoseGaugePressure => {
                let is_hose = |kind: &NodeKind<S>| matches!(kind, NodeKind::Hose(_) | NodeKind::Given { .. });
                let first = plant.network().nodes.iter().position(|node| is_hose(&node.kind))?;
                (Q::NodePressure(first), true)
            }
            Self::Temperature => (Q::Temperature(actuator), false),
            Self::MassFlow => (Q::MassFlow(actuator), false),
            Self::Angle => (Q::Position(0, 0), false),
            Self::AngularVelocity => (Q::Rate(0, 0), false),
            Self::Torque => (Q::Force(0, 0), false),
            Self::Column(column) => (column.quantity, column.measured == Quantity::GaugePressure),
        })
    }
}
