//! Sweeps: many rows, each the scenario of the file with some keys set to other values.
//!
//! `[sweep]` says how many rows there are and what is recorded of each, `[sweep.vary]` what varies: lists, ranges and
//! distributions, combined by a design. A row is a function of its number alone, so rows can be computed in any order, on
//! any number of machines, and again after a stop.
//!
//! | module | what it holds |
//! |---|---|
//! | `read`, `vary` | the sections `[sweep]` and `[sweep.vary]` with their mistakes |
//! | `left_out` | keys that rows leave out under a word that varies |
//! | `axis` | one key that varies, and its value in a row |
//! | `design` | which part of an axis a row takes: grid, random, Latin hypercube, Sobol' |
//! | `random`, `permutation`, `sobol`, `directions` | numbers for these at any position |
//! | `distribution`, `spacing` | from the unit interval to values |
//! | `field` | where a quantity stands in the scenario |
//! | `reduction` | the numbers that a run is reduced to |
//! | `plant` | rows that are plants, and what their runs are reduced to |
//!
//! A file is read once for each combination of words and whole numbers; the other numbers of a row are then set in the plain
//! scenario, without text. Checked by `tests/sweep.rs`: both ways agree for every key.

mod axis;
mod design;
mod directions;
mod distribution;
pub(crate) mod field;
mod left_out;
mod permutation;
pub(crate) mod plant;
mod random;
mod read;
pub(crate) mod reduction;
mod sobol;
mod spacing;
mod vary;

pub use axis::{Axis, AxisKind, AxisValue, column_of};
pub use left_out::LeftOut;
pub use plant::{PlantReduced, PlantReduction};
pub use reduction::{Quantity, Reduction, Statistic};

use crate::choice::{DesignKind, Engine, StatisticsOver};
use crate::keys::in_antagonist;
use crate::muscle::{Fault, Stated};
use crate::plant::{PlantColumn, PlantExperiment};
use crate::quantity;
use crate::scenario::{Aim, Command, Load, Scenario};
use field::exchange;
use mckibben::control::SetPoint;
use mckibben::parameter as p;
use mckibben::{Error, Requirement};
use std::fmt::{self, Write};

pub(crate) use design::MOST_ROWS;

/// What a file's `[sweep]` says: which rows there are, and what is recorded of each.
#[derive(Clone, Debug)]
pub struct Sweep {
    axes: Vec<Axis>,
    design: DesignKind,
    rows: u64,
    seed: u64,
    record: Record,
    over: StatisticsOver,
    part_rows: u64,
    /// A scenario for each combination of words and whole numbers, the last axis of these changing first; none of a plant.
    bases: Vec<Base>,
    plant: Option<Box<plant::Swept>>,
    left_out: Vec<LeftOut>,
}

/// What rows start from.
#[derive(Clone, Debug)]
struct Base {
    scenario: Scenario,
    /// Whether each axis sets the second actuator of a joint: one of its own keys, or one that it takes over from the first.
    sets_second: Vec<bool>,
    /// What is stated of the braid of the first actuator and of the second, where an axis is of it: the rest follows in each row.
    braids: [Option<Stated>; 2],
}

/// What is recorded of each row.
#[derive(Clone, Debug, PartialEq)]
pub enum Record {
    /// These numbers.
    Reductions(Vec<Reduction>),
    /// These numbers of a plant.
    PlantReductions(Vec<PlantReduction>),
    /// What holds at these times in s, which increase.
    Samples(Vec<f64>),
    /// What holds at every `run.sample_interval`.
    Trajectories,
}

/// A number that each run is reduced to, as a column of a table.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct ReducedColumn {
    /// The name of the reduction, such as `length.final`.
    pub name: String,
    /// SI unit; empty for a pure number.
    pub unit: &'static str,
    /// The name of the column, such as `length_final_m`.
    pub column: String,
}

impl Record {
    /// The numbers that each run is reduced to; none where samples are recorded.
    pub fn reduced(&self) -> Option<Vec<ReducedColumn>> {
        Some(match self {
            Self::Reductions(list) => {
                let of =
                    |of: &Reduction| ReducedColumn { name: of.name().to_owned(), unit: of.unit(), column: of.column() };
                list.iter().map(of).collect()
            }
            Self::PlantReductions(list) => {
                let of =
                    |of: &PlantReduction| ReducedColumn { name: of.name.clone(), unit: of.unit, column: of.column() };
                list.iter().map(of).collect()
            }
            Self::Samples(_) | Self::Trajectories => return None,
        })
    }
}

/// Why a row has no scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct RowError {
    /// The row, counted from 0.
    pub row: u64,
    /// What is wrong with its values.
    pub error: Error,
}

impl fmt::Display for RowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "row {}: {}", self.row, self.error)
    }
}

impl std::error::Error for RowError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.error)
    }
}

impl Sweep {
    /// Number of rows, at least 1.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The keys that vary, in the order of the file.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The value of an axis in a row, at a cost that depends on neither. From [`Sweep::rows`] on the rows begin again.
    ///
    /// # Panics
    /// When there is no such axis, as a slice does.
    pub fn value(&self, axis: usize, row: u64) -> AxisValue<'_> {
        self.axes[axis].value(row % self.rows)
    }

    /// What is recorded of each row.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// What statistics are taken over.
    pub fn over(&self) -> StatisticsOver {
        self.over
    }

    /// Number of rows in a part of the result, at least 1.
    pub fn part_rows(&self) -> u64 {
        self.part_rows
    }

    /// How the rows are chosen.
    pub fn design(&self) -> DesignKind {
        self.design
    }

    /// The seed of the random numbers.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Whether there are rows for an engine.
    pub fn uses_engine(&self, engine: Engine) -> bool {
        match &self.plant {
            Some(swept) => swept.run.engine == engine || self.varies("run.engine"),
            None => self.bases.iter().any(|base| base.scenario.run.engine == engine),
        }
    }

    /// Whether an axis has this path.
    fn varies(&self, path: &str) -> bool {
        self.axes.iter().any(|axis| axis.path == path)
    }

    /// The keys that rows leave out, each with the word under which it has no meaning.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// Whether every row is a plant of actuators with names; if not, none is.
    pub fn is_plant(&self) -> bool {
        self.plant.is_some()
    }

    /// Whether there are rows with a controller.
    pub fn has_controllers(&self) -> bool {
        self.bases.iter().any(|base| base.scenario.has_controller())
    }

    /// Whether every row is a joint of two actuators; if not, none is.
    pub fn has_joint(&self) -> bool {
        self.bases.iter().any(|base| base.scenario.has_joint())
    }

    /// The columns of a sample of a plant, behind that of the time; none of another sweep.
    pub fn plant_columns(&self) -> &[PlantColumn] {
        self.plant.as_ref().map_or(&[], |swept| &swept.columns)
    }

    /// The plant of a row, read from the file with the row's values; none of a sweep of something else.
    ///
    /// # Errors
    /// What is wrong with the row's values, as one line of text.
    pub fn plant(&self, row: u64) -> Option<Result<PlantExperiment, String>> {
        let swept = self.plant.as_ref()?;
        Some(swept.experiment((0..self.axes.len()).map(|axis| self.value(axis, row))))
    }

    /// Whether every row gives the step of the fixed-step engine, so that none follows from an accuracy.
    pub fn gives_step(&self) -> bool {
        match &self.plant {
            // An axis has put its first value there.
            Some(swept) => swept.run.step.is_some(),
            None => self.bases.iter().all(|base| base.scenario.run.step.is_some()),
        }
    }

    /// The scenario of a row. Tables in it are copied; everything else is a few numbers.
    ///
    /// # Errors
    /// When a value lies outside its parameter's range, which the tails of a distribution may do, or contradicts another.
    /// What takes the model to judge is judged by [`Scenario::experiment`], as for a file. [`Error::Misuse`] for a plant,
    /// which is no scenario of one actuator: see [`Sweep::plant`].
    pub fn scenario(&self, row: u64) -> Result<Scenario, RowError> {
        let row = row % self.rows;
        self.valid(row).map_err(|error| RowError { row, error })
    }

    fn valid(&self, row: u64) -> Result<Scenario, Error> {
        if self.is_plant() {
            return Err(Error::Misuse {
                what: "a row of a sweep of many actuators is no scenario of one",
                remedy: "take the row as a plant",
            });
        }
        let chosen = self.axes.iter().filter_map(|axis| Some((axis.base(row)?, axis.values.count()?)));
        let base = chosen.fold(0, |base, (value, count)| base * count + value);
        let Base { scenario, sets_second, braids } = &self.bases[base as usize];
        let (mut scenario, mut braids) = (scenario.clone(), *braids);
        for (axis, sets_second) in self.axes.iter().zip(sets_second) {
            let (Some(target), AxisValue::Number(value)) = (axis.target, axis.value(row)) else { continue };
            let set = |scenario: &mut Scenario, braid: &mut Option<Stated>| {
                let value = target.parameter.check(value)?;
                // A number without a place is not reached: the reading of the bases has refused it.
                if let Some(stated) = braid.as_mut().and_then(|braid| braid.slot(target.parameter)) {
                    *stated = Some(value);
                } else if let Some(place) = target.slot(scenario) {
                    *place = value;
                }
                Ok::<_, Error>(())
            };
            let [first, second] = &mut braids;
            if in_antagonist(&axis.path).is_none() {
                set(&mut scenario, first)?;
            }
            if *sets_second {
                exchange(&mut scenario);
                set(&mut scenario, second)?;
                exchange(&mut scenario);
            }
        }
        for braid in braids {
            if let Some(stated) = braid {
                let muscle = stated.muscle().map_err(Fault::error)?;
                let actuator = &mut scenario.actuator;
                (actuator.thread_length, actuator.turns) = (muscle.thread_length, muscle.turns);
                (actuator.max_length, actuator.min_length) = (muscle.max_length, muscle.min_length);
            }
            // Done twice this changes nothing.
            exchange(&mut scenario);
        }
        consistent(scenario)
    }

    /// Text of the base scenario and the sweep: two sweeps with equal text give equal results.
    pub fn fingerprint_text(&self) -> String {
        let mut text = String::new();
        let record = match &self.record {
            Record::Reductions(list) => list.iter().map(|reduction| reduction.name()).collect::<Vec<_>>().join(", "),
            Record::PlantReductions(list) => {
                list.iter().map(|reduction| reduction.name.clone()).collect::<Vec<_>>().join(", ")
            }
            Record::Samples(times) => {
                times.iter().map(|time| quantity::format(*time, "s")).collect::<Vec<_>>().join(", ")
            }
            Record::Trajectories => "trajectories".to_owned(),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "design {}\nrows {}\nseed {}", self.design.name(), self.rows, self.seed);
        let over = match self.over {
            StatisticsOver::Run => "",
            StatisticsOver::Orbit => " over the orbit",
        };
        let _ = writeln!(text, "record {record}{over}\npart_rows {}", self.part_rows);
        self.axes.iter().for_each(|axis| axis.fingerprint(&mut text));
        for base in &self.bases {
            // What follows in each row depends on what is stated.
            for stated in base.braids.iter().flatten() {
                let _ = writeln!(text, "\n{stated:?}");
            }
            let _ = writeln!(text, "\n{}", base.scenario.to_toml());
        }
        if let Some(swept) = &self.plant {
            let _ = writeln!(text, "\n{}", swept.text());
        }
        text
    }
}

/// Refuses what the reading of a file refuses as contradictory and the model does not check.
fn consistent(scenario: Scenario) -> Result<Scenario, Error> {
    let (run, velocity) = (scenario.run, scenario.initial.velocity);
    if run.sample_interval > run.duration {
        let unit = p::DURATION.unit;
        return Err(Error::Inconsistent {
            parameter: &p::SAMPLE_INTERVAL,
            value: run.sample_interval,
            requirement: Requirement { relation: "must be at most", other: p::DURATION.key, value: run.duration, unit },
            remedy: p::SAMPLE_INTERVAL.remedy,
        });
    }
    if let Some(Command::Controller(controller)) = &scenario.command
        && let Aim::Track { quantity, set_point: SetPoint::Sinusoid { mean, amplitude, frequency, phase } } =
            controller.aim
    {
        SetPoint::sinusoid(quantity, mean, amplitude, frequency, phase)?;
    }
    if scenario.load == Load::Isometric && velocity != 0.0 {
        return Err(Error::Misuse {
            what: "an isometric load does not move, so `initial.velocity` must be zero",
            remedy: "do not vary the key",
        });
    }
    Ok(scenario)
}
