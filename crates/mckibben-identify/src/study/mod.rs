//! Measured data: a small file that says what was measured and how, tables in CSV or Parquet, and what was found
//! wrong with them.
//!
//! ```toml
//! [study]
//! kind = "force-map"                 # or "hysteresis", "ring-down", "trajectories", "flow-curve", …
//! scenario = "muscle.toml"           # the muscle and the rig as far as they are known
//! input = "gauge-pressure"           # of trajectories: the runs are driven by the pressure that was measured
//!
//! [columns.gauge_pressure]           # also length, tension, time, absolute_pressure, and of a joint angle, antagonist_length …
//! name = "P_bar"                     # in the table's head
//! unit = "bar"
//! [columns.tension]                  # of a plant behind the name of a part: [columns."flexor.tension"], [columns."knee.angle"]
//! name = "F"
//! unit = "N"
//! slack = "0.3 N"                    # at or below this no tension was held; three times the noise, unless given
//! saturates = "500 N"                # at or above this the sensor was at its end
//! deviation = "0.5 N"                # of one reading, where it is known
//!
//! [[run]]
//! file = "slow.csv"
//! held = { length = "250 mm" }       # what has no column
//! set = { "load.mass" = "5 lb" }     # keys of the scenario that differ in this run
//!
//! [fit."load.mass"]                  # a number that is looked for
//! per_run = true                     # of trajectories: each run has its own
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | `file` | the file with its mistakes |
//! | `syntax` | brackets and dots that are not meant |
//! | `valve` | the sections of a study of a valve: `[flow]`, `[tank]`, `[pulses]` |
//! | `table` | CSV and Parquet to columns of numbers |
//! | [`clean`] | the rules by which dirty data are handled or refused, and the notes about them |
//!
//! Checked by `tests/study.rs`: every rule by data that break it, and both formats.

pub mod clean;
mod file;
mod search;
mod sensors;
mod syntax;
mod table;
mod valve;

pub use clean::{Note, Severity};
pub use file::{ColumnEntry, FitEntry, Input, Kind, RunEntry, Study, as_file_name};
pub use search::SearchEntry;
pub use sensors::SensorEntry;
pub use table::Table;
pub use valve::{Direction, FlowEntry, PulsesEntry, TankEntry, TankTarget};

use mckibben_scenario::Dimension;
use std::fmt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What a column measures.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Quantity {
    /// Time in s.
    Time,
    /// Gauge pressure in the actuator or the tank, in Pa.
    GaugePressure,
    /// Absolute pressure in the actuator or the tank, in Pa: the gauge pressure plus the scenario's atmospheric
    /// pressure.
    AbsolutePressure,
    /// Distance between the attachments in m.
    Length,
    /// Tension in N.
    Tension,
    /// Angle of a joint in rad.
    Angle,
    /// Its rate in rad/s.
    AngularVelocity,
    /// Torque of both actuators on a joint in N·m.
    Torque,
    /// Gauge pressure in a joint's antagonist in Pa; the quantities of one actuator are the agonist's.
    AntagonistGaugePressure,
    /// Absolute pressure in a joint's antagonist, in Pa.
    AntagonistAbsolutePressure,
    /// Distance between the antagonist's attachments in m.
    AntagonistLength,
    /// Its tension in N.
    AntagonistTension,
    /// Gauge pressure before the valve, in Pa.
    UpstreamGaugePressure,
    /// Absolute pressure before the valve, in Pa.
    UpstreamAbsolutePressure,
    /// Gauge pressure behind the valve, in Pa.
    DownstreamGaugePressure,
    /// Absolute pressure behind the valve, in Pa.
    DownstreamAbsolutePressure,
    /// Temperature of the air before the valve, in K.
    Temperature,
    /// Mass flow in kg/s.
    MassFlow,
    /// Volume flow in m³/s, counted as air of the reference atmosphere (ANR).
    VolumeFlow,
    /// The command to the coil, a number: it is energised while this is above a threshold.
    Command,
    /// Velocity of lengthening of an actuator, or rate of a mechanism's position, in m/s; this and what follows of a plant's part.
    Velocity,
    /// Mass of the air in an actuator in kg.
    AirMass,
    /// Volume of the air in an actuator in m³.
    Volume,
    /// Absolute pressure behind the valve in Pa, where a hose leads to the actuator.
    HosePressure,
    /// Gauge pressure there.
    HoseGaugePressure,
    /// Absolute pressure in Pa that a pressure regulator makes.
    RegulatedPressure,
    /// Gauge pressure in Pa that a pressure regulator makes.
    RegulatedGaugePressure,
    /// Gauge pressure in Pa that such a regulator is set to.
    SetPoint,
    /// Distance in m that an actuator and its tendon span.
    LoadDistance,
    /// Rate of that distance in m/s.
    LoadVelocity,
    /// Position of a mechanism in m.
    Position,
    /// Force of the actuators along it in N.
    Force,
}

impl Quantity {
    /// Those of one actuator, a joint or a valve.
    pub const ALL: [Self; 22] = [
        Self::Time,
        Self::GaugePressure,
        Self::AbsolutePressure,
        Self::Length,
        Self::Tension,
        Self::Angle,
        Self::AngularVelocity,
        Self::Torque,
        Self::AntagonistGaugePressure,
        Self::AntagonistAbsolutePressure,
        Self::AntagonistLength,
        Self::AntagonistTension,
        Self::UpstreamGaugePressure,
        Self::UpstreamAbsolutePressure,
        Self::DownstreamGaugePressure,
        Self::DownstreamAbsolutePressure,
        Self::Temperature,
        Self::MassFlow,
        Self::VolumeFlow,
        Self::Command,
        Self::HosePressure,
        Self::HoseGaugePressure,
    ];

    /// Those of the parts of a plant.
    pub const OF_PARTS: [Self; 21] = [
        Self::Length,
        Self::Velocity,
        Self::GaugePressure,
        Self::AbsolutePressure,
        Self::AirMass,
        Self::Temperature,
        Self::Volume,
        Self::Tension,
        Self::MassFlow,
        Self::HosePressure,
        Self::HoseGaugePressure,
        Self::RegulatedPressure,
        Self::RegulatedGaugePressure,
        Self::SetPoint,
        Self::LoadDistance,
        Self::LoadVelocity,
        Self::Angle,
        Self::AngularVelocity,
        Self::Torque,
        Self::Position,
        Self::Force,
    ];

    /// What a column of a plant's table is called behind the name of the part, if parts have it.
    pub fn column(self) -> Option<&'static str> {
        match self {
            Self::GaugePressure | Self::AbsolutePressure => Some("absolute_pressure"),
            of => Self::OF_PARTS.contains(&of).then(|| of.name()),
        }
    }

    /// The quantity that a study calls so behind the name of a part.
    pub fn of_part(word: &str) -> Option<Self> {
        Self::OF_PARTS.into_iter().find(|of| of.name() == word)
    }

    /// As it is written in a study, in words, its SI unit, and its dimension.
    fn row(self) -> (&'static str, &'static str, &'static str, Dimension) {
        match self {
            Self::Time => ("time", "time", "s", Dimension::TIME),
            Self::GaugePressure => ("gauge_pressure", "gauge pressure", "Pa", Dimension::PRESSURE),
            Self::AbsolutePressure => ("absolute_pressure", "absolute pressure", "Pa", Dimension::PRESSURE),
            Self::Length => ("length", "length", "m", Dimension::LENGTH),
            Self::Tension => ("tension", "tension", "N", Dimension::FORCE),
            Self::Angle => ("angle", "angle", "rad", Dimension::ANGLE),
            Self::AngularVelocity => ("angular_velocity", "angular velocity", "rad/s", Dimension::ANGULAR_SPEED),
            Self::Torque => ("torque", "torque", "N*m", Dimension::ENERGY),
            Self::AntagonistGaugePressure => {
                ("antagonist_gauge_pressure", "antagonist's gauge pressure", "Pa", Dimension::PRESSURE)
            }
            Self::AntagonistAbsolutePressure => {
                ("antagonist_absolute_pressure", "antagonist's absolute pressure", "Pa", Dimension::PRESSURE)
            }
            Self::AntagonistLength => ("antagonist_length", "antagonist's length", "m", Dimension::LENGTH),
            Self::AntagonistTension => ("antagonist_tension", "antagonist's tension", "N", Dimension::FORCE),
            Self::UpstreamGaugePressure => {
                ("upstream_gauge_pressure", "upstream gauge pressure", "Pa", Dimension::PRESSURE)
            }
            Self::UpstreamAbsolutePressure => {
                ("upstream_absolute_pressure", "upstream absolute pressure", "Pa", Dimension::PRESSURE)
            }
            Self::DownstreamGaugePressure => {
                ("downstream_gauge_pressure", "downstream gauge pressure", "Pa", Dimension::PRESSURE)
            }
            Self::DownstreamAbsolutePressure => {
                ("downstream_absolute_pressure", "downstream absolute pressure", "Pa", Dimension::PRESSURE)
            }
            Self::Temperature => ("temperature", "temperature", "K", Dimension::TEMPERATURE),
            Self::MassFlow => ("mass_flow", "mass flow", "kg/s", Dimension::MASS_FLOW),
            Self::VolumeFlow => ("volume_flow", "volume flow", "m^3/s ANR", Dimension::VOLUME_FLOW),
            Self::Command => ("command", "command", "", Dimension::NONE),
            Self::Velocity => ("velocity", "velocity", "m/s", Dimension::VELOCITY),
            Self::AirMass => ("air_mass", "mass of the air", "kg", Dimension::MASS),
            Self::Volume => ("volume", "volume", "m^3", Dimension::VOLUME),
            Self::HoseGaugePressure => ("hose_gauge_pressure", "gauge pressure in the hose", "Pa", Dimension::PRESSURE),
            Self::RegulatedGaugePressure => {
                ("regulated_gauge_pressure", "gauge regulated pressure", "Pa", Dimension::PRESSURE)
            }
            Self::HosePressure => {
                ("hose_absolute_pressure", "absolute pressure in the hose", "Pa", Dimension::PRESSURE)
            }
            Self::RegulatedPressure => {
                ("regulated_absolute_pressure", "absolute regulated pressure", "Pa", Dimension::PRESSURE)
            }
            Self::SetPoint => ("set_point", "set point", "Pa", Dimension::PRESSURE),
            Self::LoadDistance => ("load_distance", "distance of the load", "m", Dimension::LENGTH),
            Self::LoadVelocity => ("load_velocity", "velocity of the load", "m/s", Dimension::VELOCITY),
            Self::Position => ("position", "position", "m", Dimension::LENGTH),
            Self::Force => ("force", "force", "N", Dimension::FORCE),
        }
    }

    /// As it is written in a study.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// In words.
    pub fn words(self) -> &'static str {
        self.row().1
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        self.row().2
    }

    /// Whether it is a tension, of which a slack muscle holds none.
    fn is_tension(self) -> bool {
        matches!(self, Self::Tension | Self::AntagonistTension)
    }

    fn dimension(self) -> Dimension {
        self.row().3
    }
}

/// What is wrong with a study, where, and what to do about it.
#[derive(Clone, Debug, Eq, Error, PartialEq)]
pub struct StudyError {
    /// The file.
    pub file: PathBuf,
    /// The line, counted from 1, where it is one line's.
    pub line: Option<usize>,
    /// What is wrong.
    pub what: String,
    /// What to do.
    pub remedy: String,
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {}; {}", self.what, self.remedy)
    }
}

impl StudyError {
    fn new(file: &Path, line: Option<usize>, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { file: file.to_path_buf(), line, what: what.into(), remedy: remedy.into() }
    }
}

/// Columns of one table after cleaning, all of one length.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The columns in SI; NaN where there is no reading.
    pub columns: Vec<Column>,
    /// How many rows there are.
    pub rows: usize,
    /// The line of each row in its file, or its number in a file without lines.
    pub lines: Vec<usize>,
}

/// One column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// What it measures.
    pub quantity: Quantity,
    /// The part of a plant that it is measured of, as the plant's file calls it.
    pub part: Option<String>,
    /// Values in SI; NaN where there is no reading.
    pub values: Vec<f64>,
    /// Whether no tension was held.
    pub slack: Vec<bool>,
    /// Standard deviation of a reading, where it is known.
    pub deviation: Option<f64>,
}

/// A quantity in words, of a part of a plant.
fn words_of(quantity: Quantity, part: Option<&str>) -> String {
    part.map_or_else(|| quantity.words().to_owned(), |part| format!("{} of {part}", quantity.words()))
}

impl Column {
    /// What it measures, in words.
    pub fn words(&self) -> String {
        words_of(self.quantity, self.part.as_deref())
    }
}

impl Sheet {
    /// A column that is of no part of a plant, if it is there.
    pub fn column(&self, quantity: Quantity) -> Option<&Column> {
        self.columns.iter().find(|column| column.quantity == quantity && column.part.is_none())
    }

    /// Times and values of a column of it, where there are both.
    pub fn channel(&self, column: &Column) -> Option<(Vec<f64>, Vec<f64>)> {
        let times = &self.column(Quantity::Time)?.values;
        let both = times.iter().zip(&column.values).filter(|(time, value)| time.is_finite() && value.is_finite());
        Some(both.unzip())
    }
}

/// One run: its tables, what differs in its scenario, and what was found wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The one that the study gives, or that of its file; no two recordings of a study have one name.
    pub name: String,
    /// A table for each file.
    pub sheets: Vec<Sheet>,
    /// Keys of the scenario that are other here, with their values as TOML.
    pub set: Vec<(String, String)>,
    /// What was found and what was done about it.
    pub notes: Vec<Note>,
}

impl Recording {
    /// Times and values of a quantity, where there are both: each at its own rate.
    pub fn channel(&self, quantity: Quantity) -> Option<(Vec<f64>, Vec<f64>)> {
        let sheet = self.sheets.iter().find(|sheet| sheet.column(quantity).is_some())?;
        sheet.channel(sheet.column(quantity)?)
    }

    /// The columns of parts of a plant, each with its table.
    pub fn of_parts(&self) -> impl Iterator<Item = (&Sheet, &Column)> {
        let of_part = |column: &&Column| column.part.is_some();
        self.sheets
            .iter()
            .flat_map(move |sheet| sheet.columns.iter().filter(of_part).map(move |column| (sheet, column)))
    }

    /// The column of a quantity.
    pub fn column(&self, quantity: Quantity) -> Option<&Column> {
        self.sheets.iter().find_map(|sheet| sheet.column(quantity))
    }
}
