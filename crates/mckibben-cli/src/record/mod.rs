//! The columns of a run: in memory, and in the two formats of a file.

mod csv;
mod field;
mod memory;
mod parquet;

use crate::closed_loop::Goal;
use crate::engine::Outcome;
use crate::failure::Failure;
use crate::joint;
pub(crate) use field::{Field, Value, of_controlled, of_joint};
use mckibben::simulation::{JointSample, Sample};
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
    /// Its value.
    pub value: fn(&Sample) -> f64,
}

/// The columns of numbers in their order; the name of the open ports follows them as [`VALVE`], and the columns of an air
/// line, a pressure regulator or a tendon in series if there is one.
pub const COLUMNS: [Column; 9] = [
    column("time_s", "s", |sample| sample.time),
    column("length_m", "m", |sample| sample.length),
    column("velocity_m_s", "m/s", |sample| sample.velocity),
    column("pressure_pa", "Pa", |sample| sample.pressure.0),
    column("air_mass_kg", "kg", |sample| sample.air_mass),
    column("temperature_k", "K", |sample| sample.temperature),
    column("volume_m3", "m^3", |sample| sample.volume),
    column("tension_n", "N", |sample| sample.tension),
    column("mass_flow_kg_s", "kg/s", |sample| sample.mass_flow),
];

/// The column of words.
pub const VALVE: &str = "valve";

const fn column(name: &'static str, unit: &'static str, value: fn(&Sample) -> f64) -> Column {
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
                "end the name of --output with .csv or .parquet",
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
    /// The scenario as it was understood.
    pub scenario: &'a Scenario,
}

/// Writes a run; under a controller with the set points and what was measured after the columns of the run.
///
/// # Errors
/// [`Failure::output`], which names `path`, when writing fails.
pub fn write(
    outcome: &Outcome,
    goals: &[Goal],
    interval: f64,
    provenance: &Provenance<'_>,
    (path, format): (&Path, Format),
    out: &mut (dyn Write + Send),
) -> Result<(), Failure> {
    let rows: Rows<'_, Sample> = &mut |each| outcome.each_sample(interval, each);
    write_fields(&of_controlled(outcome.rig(), goals), rows, provenance, (path, format), out)
}

/// Writes the run of a joint: the columns of the agonist, then the joint's, then the antagonist's, then what a
/// controller was to reach.
///
/// # Errors
/// [`Failure::output`], which names `path`, when writing fails.
pub fn write_joint(
    outcome: &joint::outcome::Outcome,
    goals: &[Goal],
    interval: f64,
    provenance: &Provenance<'_>,
    (path, format): (&Path, Format),
    out: &mut (dyn Write + Send),
) -> Result<(), Failure> {
    let rows: Rows<'_, JointSample> = &mut |each| outcome.samples(interval).try_for_each(|sample| each(&sample));
    write_fields(&of_joint(goals), rows, provenance, (path, format), out)
}

/// Hands every sample of a run to what it is given.
pub(crate) type Rows<'r, S> = &'r mut dyn FnMut(&mut dyn FnMut(&S) -> Result<(), Failure>) -> Result<(), Failure>;

fn write_fields<S>(
    fields: &[Field<S>],
    rows: Rows<'_, S>,
    provenance: &Provenance<'_>,
    (path, format): (&Path, Format),
    out: &mut (dyn Write + Send),
) -> Result<(), Failure> {
    match format {
        Format::Csv => csv::write(fields, rows, path, out),
        Format::Parquet => parquet::write(fields, rows, provenance, path, out),
    }
}
