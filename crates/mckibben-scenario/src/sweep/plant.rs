//! Sweeps of plants: each row is read from the file with the row's values in it.
//!
//! A run of a plant costs more than a reading, so that every row is read as a file would be, with all that the reading
//! refuses. Reductions name a column and a statistic: `elbow.angle.max`, `flexor.gauge_pressure.final`; of the error of a
//! controller `flexor.length_error.rms`; `air.used` is what valves let in from whatever feeds them, less what went back,
//! `exergy.efficiency` the work on all mechanisms over the exergy that was supplied.

use super::Record;
use super::axis::{AxisValue, column_of};
use super::left_out::LeftOut;
use super::reduction::Statistic;
use super::vary::{self, Varied};
use crate::diagnostic::{Class, Diagnostic, Diagnostics, Place};
use crate::document::{Document, Node, Value};
use crate::keys::{self, SWEEP};
use crate::nearest::{nearest, nearest_few};
use crate::plant::{PlantColumn, PlantControl, PlantExperiment, PlantQuantity};
use crate::quantity;
use crate::reader::{Reader, list_of};
use crate::scenario::Run;
use mckibben::control;
use mckibben::parameter as p;

/// Columns that are printed in place of one that is unknown.
const NEAREST: usize = 8;

/// The rows of a sweep as plants.
#[derive(Clone, Debug)]
pub(crate) struct Swept {
    /// The file without its section `[sweep]`.
    document: Document,
    /// Path of each axis, where it stands, and the unit of its numbers.
    axes: Vec<(String, Place, &'static str)>,
    /// The keys that rows of a word leave out.
    left_out: Vec<LeftOut>,
    /// The columns of a run, the same in all rows.
    pub(crate) columns: Vec<PlantColumn>,
    /// How long the first row runs and what it records.
    pub(crate) run: Run,
}

/// What of a plant is reduced to a number.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum PlantReduced {
    /// A quantity of its samples.
    Quantity(PlantQuantity),
    /// How far the controller of this index misses a quantity.
    Error(usize, control::Quantity),
    /// The air in kg that was used: what valves let in from whatever feeds them, less what went back.
    Air,
    /// Work on the mechanisms over the exergy that was supplied.
    Efficiency,
}

/// A statistic of something of a plant.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PlantReduction {
    /// Its name, such as `flexor.gauge_pressure.final`.
    pub name: String,
    /// SI unit; empty for a pure number.
    pub unit: &'static str,
    /// What is reduced, with the indices of the first row: [`PlantReduction::in_row`].
    pub of: PlantReduced,
    /// How.
    pub statistic: Statistic,
}

impl PlantReduction {
    /// Name of the column in a table, such as `flexor_pressure_final_pa`.
    pub fn column(&self) -> String {
        column_of(&self.name, self.unit)
    }

    /// What is reduced in a row, whose plant may hold it at other indices than the first row.
    pub fn in_row(&self, of: &PlantExperiment) -> PlantReduced {
        // Not reached: rows with other columns than the first are refused.
        named(&self.name, of).map_or(self.of, |found| found.of)
    }
}

impl Swept {
    /// Reads the first row; the rows are plants.
    pub(super) fn read(
        document: &Document,
        varied: &[Varied<'_>],
        left_out: &[LeftOut],
    ) -> Result<(Self, PlantExperiment), Diagnostics> {
        Diagnostics::check(varied.iter().filter_map(|varied| document.nameless(&varied.path, &varied.key)).collect())?;
        let mut bare = document.clone();
        bare.remove(SWEEP);
        let mut first = vary::first(document, varied);
        left_out.iter().for_each(|of| of.leave_out(&mut first));
        let Some(experiment) = first.plant_experiment()? else {
            let title = "the rows of this sweep are no plants";
            return Err(Diagnostic::whole(Class::Missing, document.source().name(), title).into());
        };
        let axes = varied.iter().map(|varied| (varied.path.clone(), varied.key.clone(), varied.unit())).collect();
        let (columns, run) = (experiment.columns(), experiment.run);
        Ok((Self { document: bare, axes, left_out: left_out.to_vec(), columns, run }, experiment))
    }

    /// The plant of a row by the values of its axes.
    pub(super) fn experiment<'v>(
        &self,
        values: impl Iterator<Item = AxisValue<'v>>,
    ) -> Result<PlantExperiment, String> {
        let mut document = self.document.clone();
        for ((path, place, unit), value) in self.axes.iter().zip(values) {
            let value = match value {
                AxisValue::Word(word) => Value::String(word.to_owned()),
                AxisValue::Number(number) if unit.is_empty() => Value::Number(number),
                AxisValue::Number(number) => Value::String(quantity::format(number, unit)),
            };
            document.put_at(path, place, &Node { place: place.clone(), value });
        }
        self.left_out.iter().for_each(|of| of.leave_out(&mut document));
        match document.plant_experiment() {
            Ok(Some(experiment)) if have_equal_titles(&experiment.columns(), &self.columns) => Ok(experiment),
            Ok(Some(_)) => Err("this row has other columns than the first; run one sweep for each".to_owned()),
            Ok(None) => Err("this row describes no plant".to_owned()),
            Err(found) => Err(found.iter().next().map_or_else(String::new, |first| first.title().to_owned())),
        }
    }

    /// What identifies it: the keys of the file with their values.
    pub(super) fn text(&self) -> String {
        self.document.to_toml()
    }
}

/// Whether two rows fill one table. Where the values stand within each plant may differ: an inlet that is always open is a valve
/// of the air network, and one that opens one way is not.
fn have_equal_titles(one: &[PlantColumn], other: &[PlantColumn]) -> bool {
    let title = |of: &PlantColumn| (of.name.clone(), of.unit);
    one.iter().map(title).eq(other.iter().map(title))
}

/// What is recorded of a plant, by the words of the file; `given` says whether the file names reductions.
pub(super) fn record(document: &Document, record: Option<Record>, of: &PlantExperiment) -> Result<Record, Diagnostics> {
    match record {
        Some(Record::Reductions(_)) | None => reductions(document, of).map(Record::PlantReductions),
        Some(other) => Ok(other),
    }
}

/// The numbers that each run is reduced to.
fn reductions(document: &Document, of: &PlantExperiment) -> Result<Vec<PlantReduction>, Diagnostics> {
    let path = "sweep.reductions";
    let Some(entry) = document.entry(path) else { return Ok(by_default(of)) };
    let mut reader = Reader::of_section(document, "sweep.reductions");
    let Some(items) = reader.items_of(&entry.node, path) else {
        reader.finish()?;
        return Ok(Vec::new());
    };
    let mut found = Vec::new();
    for item in items {
        let Value::String(name) = &item.value else {
            let title = "a reduction is a name in quotes";
            reader.note(Diagnostic::at(Class::WrongType, item.place.clone(), title, "not a name"));
            continue;
        };
        match named(name, of) {
            Ok(reduction) => found.push((reduction, item.place.clone())),
            Err((title, help)) => {
                reader
                    .note(Diagnostic::at(Class::InvalidChoice, item.place.clone(), title, "no row has it").help(help));
            }
        }
    }
    let named: Vec<(&str, Place)> =
        found.iter().map(|(of, place): &(PlantReduction, Place)| (of.name.as_str(), place.clone())).collect();
    super::read::check_each_once(&mut reader, &named);
    reader.finish()?;
    Ok(found.into_iter().map(|(of, _)| of).collect())
}

/// The reduction of a name; why there is none and what there is.
fn named(name: &str, of: &PlantExperiment) -> Result<PlantReduction, (String, String)> {
    let unknown = |help: String| Err((format!("`{name}` is no reduction of this plant"), help));
    let Some((what, statistic)) = name.rsplit_once('.') else {
        return unknown("write a column and a statistic, as in `flexor.gauge_pressure.final`".to_owned());
    };
    let made = |unit, reduced, statistic| {
        let unit = match statistic {
            Statistic::SettlingTime => "s",
            Statistic::Overshoot => "",
            _ => unit,
        };
        Ok(PlantReduction { name: name.to_owned(), unit, of: reduced, statistic })
    };
    if what == "air" {
        return match statistic {
            "used" => made("kg", PlantReduced::Air, Statistic::Used),
            _ => unknown("of `air` there is `air.used`".to_owned()),
        };
    }
    if what == "exergy" {
        return match statistic {
            "efficiency" => made("", PlantReduced::Efficiency, Statistic::Efficiency),
            _ => unknown("of `exergy` there is `exergy.efficiency`".to_owned()),
        };
    }
    let columns = of.columns();
    let errors = errors(of);
    if let Some((_, control, quantity)) = errors.iter().find(|(error, ..)| error == what) {
        let statistic = [Statistic::Rms, Statistic::Peak].into_iter().find(|known| known.name() == statistic);
        return match statistic {
            Some(statistic) => {
                made(quantity.rows().set_point.unit, PlantReduced::Error(*control, *quantity), statistic)
            }
            None => unknown(format!("of `{what}` there are `{what}.rms` and `{what}.peak`")),
        };
    }
    let column = columns.iter().find(|column| column.name == what);
    let Some((column, quantity)) = column.and_then(|column| Some((column, column.quantity()?))) else {
        let known = columns.iter().filter(|column| column.quantity().is_some()).map(|column| column.name.as_str());
        let known: Vec<&str> =
            known.chain(errors.iter().map(|(name, ..)| name.as_str())).chain(["air", "exergy"]).collect();
        return unknown(match nearest(what, known.iter().copied()) {
            Some(meant) => format!("did you mean `{meant}.{statistic}`?"),
            None => format!(
                "the nearest of its columns: {}; `mckibben simulate --output` writes all of them",
                list_of(nearest_few(what, known, NEAREST).into_iter())
            ),
        });
    };
    let known = Statistic::OF_SERIES.into_iter().find(|known| known.name() == statistic);
    match known {
        Some(statistic) => made(column.unit, PlantReduced::Quantity(quantity), statistic),
        None => unknown(format!("statistics are {}", list_of(Statistic::OF_SERIES.iter().map(|of| of.name())))),
    }
}

/// The errors of controllers, by names such as `flexor.pressure_error`.
fn errors(of: &PlantExperiment) -> Vec<(String, usize, control::Quantity)> {
    let mut errors = Vec::new();
    for (index, control) in of.controls.iter().enumerate() {
        let name = match control {
            PlantControl::Actuator(control) => of.names.actuators.get(control.actuator),
            PlantControl::Joint(control) => {
                let (mechanism, joint) = control.joint;
                of.names.mechanisms.get(mechanism).and_then(|names| names.joints.get(joint))
            }
        };
        let mut quantities = vec![control.regulated()];
        quantities.extend(control.set_points().iter().map(|(quantity, _)| *quantity));
        quantities.dedup();
        for quantity in quantities {
            errors.extend(name.map(|name| (format!("{name}.{}_error", quantity.name()), index, quantity)));
        }
    }
    errors
}

/// What is recorded of each run where the file does not say.
fn by_default(of: &PlantExperiment) -> Vec<PlantReduction> {
    let mut names = Vec::new();
    for of in of.coordinates() {
        let what = if of.is_angle { "angle" } else { "position" };
        names.extend(["final", "min", "max"].map(|statistic| format!("{}.{what}.{statistic}", of.name)));
    }
    for name in &of.names.actuators {
        names.extend(
            ["length.final", "gauge_pressure.final", "gauge_pressure.max", "tension.peak"]
                .map(|of| format!("{name}.{of}")),
        );
    }
    names.push("air.used".to_owned());
    names.iter().filter_map(|name| named(name, of).ok()).collect()
}

/// Refuses times beyond the end of the run, unless the run's duration varies.
pub(super) fn check_times(
    document: &Document,
    record: &Record,
    duration: f64,
    varied: &[Varied<'_>],
) -> Result<(), Diagnostics> {
    super::read::check_times_of(document, record, duration, varied.iter().any(|of| of.path == p::DURATION.key))
}

/// The key that a path in `[sweep.vary]` of a plant's file stands for.
pub(super) fn key_of(path: &str) -> Option<&'static keys::Key> {
    keys::key_at(&keys::stands_for(path))
}
