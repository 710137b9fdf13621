//! What a run is of, and the parameters that are looked for in it: a scenario of one actuator or joint, or the file of a plant.

use super::simulated::Built;
use crate::adjustable::{Adjustable, SwitchedOff, WIDTH, spread};
use mckibben::Error;
use mckibben_scenario::{AdjustedPlant, Diagnostics, Document, PlantPlace, Scenario};
use thiserror::Error as ThisError;

/// What a run is of, with the parameters that are looked for.
#[derive(Clone, Debug)]
pub enum Subject {
    /// One actuator with its load, or two that turn a joint against each other.
    Scenario(Box<Adjustable>),
    /// A plant whose actuators have names.
    Plant(AdjustablePlant),
}

/// The file of a plant and those of its parameters that are looked for.
#[derive(Clone, Debug)]
pub struct AdjustablePlant {
    /// The file.
    pub document: Document,
    /// The parameters.
    pub places: Vec<PlantPlace>,
}

/// What a run is of, with values of its parameters.
#[derive(Clone, Debug)]
pub enum Described {
    /// One actuator with its load, or a joint.
    Scenario(Box<Scenario>),
    /// The file of a plant.
    Plant(Document),
}

/// Why values of parameters describe nothing that can be run.
#[derive(Clone, Debug, PartialEq, ThisError)]
pub enum SubjectError {
    /// The core refuses them.
    #[error(transparent)]
    Core(#[from] Error),
    /// The file of a plant cannot say them.
    #[error("{0}")]
    File(String),
}

impl From<Diagnostics> for SubjectError {
    fn from(found: Diagnostics) -> Self {
        let sentence = found.iter().next().map(|first| {
            let help = first.remedies().first().map(|help| format!("; {help}")).unwrap_or_default();
            format!("{}{help}", first.title())
        });
        Self::File(sentence.unwrap_or_default())
    }
}

impl From<Adjustable> for Subject {
    fn from(of: Adjustable) -> Self {
        Self::Scenario(Box::new(of))
    }
}

impl Described {
    /// As a file.
    pub fn to_toml(&self) -> String {
        match self {
            Self::Scenario(scenario) => scenario.to_toml(),
            Self::Plant(document) => document.to_toml(),
        }
    }

    /// The scenario, where it is no plant.
    pub fn scenario(&self) -> Option<&Scenario> {
        match self {
            Self::Scenario(scenario) => Some(scenario),
            Self::Plant(_) => None,
        }
    }
}

impl Subject {
    /// How many parameters are looked for.
    pub(super) fn width(&self) -> usize {
        match self {
            Self::Scenario(of) => of.places().len(),
            Self::Plant(of) => of.places.len(),
        }
    }

    /// At these values, with only the parameters of these indices looked for.
    pub(super) fn only(&self, numbers: &[usize], values: &[f64]) -> Result<Self, Error> {
        Ok(match self {
            Self::Scenario(of) => Self::Scenario(Box::new(of.only(numbers, values)?)),
            Self::Plant(AdjustablePlant { document, places }) => Self::Plant(AdjustablePlant {
                document: document.with_plant_values(places, values)?,
                places: numbers.iter().map(|number| places[*number].clone()).collect(),
            }),
        })
    }

    /// What it is with other values.
    pub(super) fn at(&self, values: &[f64]) -> Result<Described, Error> {
        Ok(match self {
            Self::Scenario(of) => Described::Scenario(Box::new(of.at(values)?)),
            Self::Plant(of) => Described::Plant(of.document.with_plant_values(&of.places, values)?),
        })
    }

    /// What is run with other values.
    pub(super) fn built(&self, values: &[f64]) -> Result<Built, SubjectError> {
        match self {
            Self::Scenario(of) => Ok(Built::of(of.at(values)?)?),
            Self::Plant(AdjustablePlant { document, places }) => {
                // What is outside the range of its parameter is the core's to say, but for keys whose part has a name.
                for (place, value) in places.iter().zip(values) {
                    let row = place.parameter();
                    if let Err(error) = row.check(*value)
                        && row.key.contains('*')
                    {
                        return Err(SubjectError::File(error.to_string().replace(row.key, &place.path())));
                    }
                }
                document.with_plant_values(places, values)?;
                let plant = AdjustedPlant::new(document, places, values)?;
                if !plant.experiment().controls.is_empty() {
                    return Err(Error::NotImplemented(&mckibben::limit::CONTROLLER_HERE).into());
                }
                Ok(Built::Plant(Box::new(plant)))
            }
        }
    }

    /// That there is a derivative by every parameter at these values, as far as the file does not name its parts.
    pub(super) fn check_derivatives(&self, values: &[f64]) -> Result<(), SwitchedOff> {
        match self {
            Self::Scenario(of) => of.check_derivatives(values),
            // A number that no part of the plant has is differenced, and found silent.
            Self::Plant(_) => Ok(()),
        }
    }

    /// The first unknown of each pass.
    pub(super) fn passes(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.width()).step_by(WIDTH)
    }

    /// Puts the derivatives of a pass into the row of a residual.
    pub(super) fn spread(&self, first: usize, slope: &[f64; WIDTH], row: &mut [f64]) {
        spread(first, slope, 1.0, row);
    }
}
