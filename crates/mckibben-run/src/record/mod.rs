//! The columns of a run: in memory, and in a file.
//!
//! A Parquet file says about itself:
//!
//! | key of the metadata | value |
//! |---|---|
//! | `mckibben.version` | version of this program |
//! | `mckibben.units` | JSON: the unit of each column of numbers |
//! | `mckibben.scenario_file` | name of the scenario file |
//! | `mckibben.scenario` | its text |
//! | `mckibben.set` | JSON: what was set on the command line in addition to it |
//! | `mckibben.resolved` | the scenario as it was understood: every value in SI, no preset, no default; not of a plant |

mod field;
mod memory;

pub use crate::table::{Format, ending};

use crate::failure::Failure;
use crate::table::{Column, Layout, Writer};
pub(crate) use field::{Field, goal_fields, number, of_actuator, of_controlled, of_joint, of_joint_alone, word};
use mckibben_scenario::{Document, Scenario};
pub(crate) use memory::filled;
pub use memory::{Filled, Values};
use std::io::Write;
use std::path::Path;

/// The Parquet files of runs.
const LAYOUT: Layout = Layout { schema: "run", group: 1 << 17, sealed: false };

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

/// Where the columns of a run are written, and what is stored with them.
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

impl Provenance<'_> {
    /// What is said in a file.
    fn notes(&self) -> Vec<(String, String)> {
        let resolved = self.scenario.map(|scenario| ("mckibben.resolved".to_owned(), scenario.to_toml()));
        notes(self.document, self.set).into_iter().chain(resolved).collect()
    }
}

/// What every file of results says about the scenario that it comes from.
pub(crate) fn notes(document: &Document, set: &[String]) -> Vec<(String, String)> {
    let source = document.source();
    // Only the file's name: where it lies on the machine is private and would change the bytes.
    let name = Path::new(source.name()).file_name();
    let pairs = [
        ("mckibben.version", env!("CARGO_PKG_VERSION").to_owned()),
        ("mckibben.scenario_file", name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())),
        ("mckibben.scenario", source.text().to_owned()),
        ("mckibben.set", serde_json::Value::from(set).to_string()),
    ];
    pairs.map(|(key, value)| (key.to_owned(), value)).to_vec()
}

/// Writes the columns of a run whose samples come from `rows`, which may make the run on the way.
///
/// # Errors
/// [`Failure::output`], which names the path, when writing fails; [`Failure::not_finite`]; and those of `rows`.
pub(crate) fn write<S>(fields: &[Field<S>], rows: Rows<'_, S>, target: Target<'_>) -> Result<(), Failure> {
    let Target { provenance, path, format, out } = target;
    let columns: Vec<Column> = fields.iter().map(|field| field.column.clone()).collect();
    let notes = provenance.notes();
    let mut writer = Writer::begin(format, columns, LAYOUT, path, out)?;
    let mut cells = Vec::with_capacity(fields.len());
    rows(&mut |sample| {
        cells.clear();
        cells.extend(fields.iter().map(|field| (field.cell)(sample)));
        writer.row(&cells)
    })?;
    writer.finish(&notes).map(drop)
}
