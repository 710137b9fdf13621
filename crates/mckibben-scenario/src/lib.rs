//! Scenario files of `mckibben`: TOML with units in, validated SI values out, and errors that show the place.
//!
//! ```
//! use mckibben_scenario::{Document, Scenario};
//!
//! let text = r#"
//! [load]
//! kind = "hanging-mass"
//! mass = "5 lb"
//! [initial]
//! gauge_pressure = "60 psi"
//! [run]
//! duration = "0.5 s"
//! "#;
//! let scenario = Scenario::from_str(text, "muscle.toml")?;
//! assert_eq!(scenario.actuator.max_length, 0.09779); // the default preset's 3.85 in
//!
//! // A sweep sets values by path, and mistakes are located.
//! let mut document = Document::parse(text, "muscle.toml")?;
//! document.set("load.mass", &"5 lbf".into())?;
//! let mistakes = document.scenario().unwrap_err();
//! assert!(mistakes.to_string().contains("\"5 lbf\" is a force, but `load.mass` is a mass"));
//! # Ok::<(), mckibben_scenario::Diagnostics>(())
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`quantity`] | the one grammar of numbers with units, on an exact table of units |
//! | [`keys`] | the one table of sections and keys, over the core's table of parameters |
//! | [`presets`] | named actuators and valves, each number with its source |
//! | [`diagnostic`] | errors that show file, line, column and remedy |
//! | [`Document`] | a file as parsed, with values set from outside, and the core's errors located in it |
//! | [`Muscle`] | the braid at rest, from whichever of its numbers a file states |
//! | [`Assumed`] | the numbers in force that no source states |
//! | [`Scenario`] | what a file says, as plain SI values; `to_toml` writes it back |
//! | [`sweep`] | many scenarios from one file: what varies, by which design, and what is recorded |
//! | [`Place`], [`Seeds`] | one number by its path, to be set and to be differentiated by |
//! | [`PlantPlace`], [`AdjustedPlant`] | the same of a file in which actuators have names |
//! | [`schema`], [`Starter`] | the JSON Schema and the first file of a newcomer, both made from the keys |

#![forbid(unsafe_code)]

mod assumed;
mod choice;
mod controlled;
mod controlled_joint;
mod diagnose;
pub mod diagnostic;
mod dimension;
mod document;
mod follow;
pub mod keys;
mod model;
mod muscle;
mod nearest;
mod numbers;
mod place;
mod plant;
pub mod presets;
pub mod quantity;
mod read;
mod reader;
mod scenario;
mod schema;
mod starter;
pub mod sweep;
mod text;
mod unit;
mod write;

pub use assumed::Assumed;
pub use choice::{
    BladderForm, Choice, CommandKind, CommandState, ControllerKind, DesignKind, Engine, ExhaustTemperature, ForceLaw,
    FrictionStart, HoseKind, HysteresisLaw, InletKind, LoadKind, MechanismKind, Method, PressurePlace, ProcessKind,
    RecordKind, SetPointTable, Spacing, StatisticsOver, ValveKind, ValveOutput,
};
pub use controlled::{ControlLaw, ControlledExperiment, GreatestRequest};
pub use controlled_joint::{ControlledJointExperiment, JointLaw};
pub use diagnostic::{Diagnostic, Diagnostics, Style};
pub use dimension::Dimension;
pub use document::{Document, list_and_entry};
pub use model::{Experiment, JointExperiment};
pub use muscle::{Muscle, TOLERANCE as MUSCLE_TOLERANCE};
pub use nearest::nearest_few;
pub use numbers::DocumentNumber;
pub use place::{Place, PlaceError, Seeds};
pub use plant::{
    ActuatorControl, AdjustedPlant, Coordinate, JointControl, MechanismNames, PlantColumn, PlantContent, PlantControl,
    PlantExperiment, PlantNames, PlantOver, PlantPlace, PlantQuantity,
};
pub use scenario::{
    Actuator, Aim, Air, Antagonist, Bladder, Command, Compressor, Controller, Effectiveness, FlowPath, Force, Friction,
    Hose, Hysteresis, Initial, InitialAngle, InitialLength, Joint, Limit, Load, MomentArm, Motion, PressureRegulator,
    PressureSensor, PressureSeries, Process, ProportionalRegulator, Regulator, Reservoir, Run, Scenario, SeriesTendon,
    Spool, Supply, Taper, Tendon, TonduLopezCoefficients, Valve, Viscoelastic,
};
pub use schema::schema;
pub use starter::{Starter, default_of};
pub use sweep::{
    Axis, AxisKind, AxisValue, PlantReduced, PlantReduction, Record, ReducedColumn, Reduction, RowError, Sweep,
};
