//! The columns of a run: in memory, and in the two formats of a file.

mod csv;
mod field;
mod memory;
mod parquet;

use crate::failure::Failure;
pub(crate) use field::{Field, Value, goal_fields, number, of_actuator, of_controlled, of_joint, of_joint_alone, word};
use mckibben::simulation::Sample;
use mckibben_scenario::{Document, Scenario};
pub(crate) use memory::filled;
pub use memory::{Filled, Values};
use std::io::Write;
use std::path::Path;

/// A column of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name, with the unit at its end.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its value; the number is the absolute pressure of the atmosphere in Pa, from which gauge pressures count.
    pub value: fn(&Sample, f64) -> f64,
}

/// The columns of numbers in their order; the name of the open ports follows them as [`VALVE`], and the columns of an air
/// line, a pressure regulator or a tendon in series if there is one.
pub const COLUMNS: [Column; 10] = [
    column("time_s", "s", |sample, _| sample.time),
    column("length_m", "m", |sample, _| sample.length),
    column("velocity_m_s", "m/s", |sample, _| sample.velocity),
    column("absolute_pressure_pa", "Pa", |sample, _| sample.pressure.0),
    column("gauge_pressure_pa", "Pa", |sample, atmosphere| sample.pressure.0 - atmosphere),
    column("air_mass_kg", "kg", |sample, _| sample.air_mass),
    column("temperature_k", "K", |sample, _| sample.temperature),
    column("volume_m3", "m^3", |sample, _| sample.volume),
    column("tension_n", "N", |sample, _| sample.tension),
    column("mass_flow_kg_s", "kg/s", |sample, _| sample.mass_flow),
];

/// The column of words.
pub const VALVE: &str = "valve";

const fn column(name: &'static str, unit: &'static str, value: fn(&Sample, f64) -> f64) -> Column {
    Column { name, unit, value }
}

/// How a run is written.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Format {
    /// Text with commas, each number in the shortest digits that identify it.
    Csv,
    /// Apache Parquet.
    Parquet,
}

impl Format {
    /// The format that a file's ending asks for.
    ///
    /// # Errors
    /// [`Failure::input`] for another ending.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        match ending(path).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            _ => Err(Failure::input(
                format!("`{}` does not say how to write the run", path.display()),
                "end its name with .csv or .parquet",
            )),
        }
    }
}

/// The ending of a file's name in small letters.
pub fn ending(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

/// What a file says about itself, where its format has a place for it.
#[derive(Clone, Debug)]
pub struct Provenance<'a> {
    /// The scenario as it was written.
    pub document: &'a Document,
    /// What was set on the command line, as `KEY=VALUE`.
    pub set: &'a [String],
    /// The scenario as it was understood; none of a plant.
    pub scenario: Option<&'a Scenario>,
}

/// Hands every sample of a run to what it is given.
pub(crate) type Rows<'r, S> = &'r mut dyn FnMut(&mut dyn FnMut(&S) -> Result<(), Failure>) -> Result<(), Failure>;

/// Where the columns of a run are written, and what stands beside them.
pub struct Target<'t> {
    /// What the file says about itself.
    pub provenance: &'t Provenance<'t>,
    /// Its name, which stands in messages.
    pub path: &'t Path,
    /// How it is written.
    pub format: Format,
    /// Its bytes.
    pub out: &'t mut (dyn Write + Send),
}

/// Writes the columns of a run whose samples come from `rows`, which may make the run on the way.
///
/// # Errors
/// [`Failure::output`], which names the path, when writing fails; [`Failure::not_finite`]; and those of `rows`.
pub(crate) fn write<S>(fields: &[Field<S>], rows: Rows<'_, S>, target: Target<'_>) -> Result<(), Failure> {
    let Target { provenance, path, format, out } = target;
    match format {
        Format::Csv => csv::write(fields, rows, path, out),
        Format::Parquet => parquet::write(fields, rows, provenance, path, out),
    }
}
