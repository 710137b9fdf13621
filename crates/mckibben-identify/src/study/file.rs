//! The study file, by `serde`; quantities are text with a unit, as in scenario files.

use super::clean::{self, Rules};
use super::search::{RawSearch, SearchEntry};
use super::sensors::{RawSensor, SensorEntry};
use super::table::{self, Table};
use super::valve::{FlowEntry, PulsesEntry, RawFlow, RawPulses, RawTank, Sections, TankEntry};
use super::{Quantity, Recording, StudyError, words_of};
use mckibben_scenario::{Dimension, quantity};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// What is to be found.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Laws of static force from tensions at held pressures and lengths.
    ForceMap,
    /// Hysteresis from loops in length at held pressures.
    Hysteresis,
    /// Friction from a mass that swings.
    RingDown,
    /// Any parameters of a scenario from time series.
    Trajectories,
    /// C and b of a valve from steady flow over the pressure ratio.
    FlowCurve,
    /// The factor on a valve's calculated flow from steady flow.
    SteadyFlow,
    /// A valve, or a volume, from the pressure in a tank that is charged or discharged.
    Tank,
    /// Delays of a poppet from the pressure under a pulse train.
    PulseTrain,
}

impl Kind {
    /// Those that are found by a search that may take long, and have a result whenever it is ended.
    pub(super) const SEARCHED: [Self; 3] = [Self::ForceMap, Self::Hysteresis, Self::Trajectories];
    /// Those whose unknowns are the study's; the others follow from the kind.
    pub(super) const OF_NUMBERS: [Self; 2] = [Self::Hysteresis, Self::Trajectories];

    /// Whether it is found by a search that may take long, and has a result whenever it is ended.
    pub fn has_search(self) -> bool {
        Self::SEARCHED.contains(&self)
    }

    /// As it is written in a study.
    pub fn name(self) -> &'static str {
        match self {
            Self::ForceMap => "force-map",
            Self::Hysteresis => "hysteresis",
            Self::RingDown => "ring-down",
            Self::Trajectories => "trajectories",
            Self::FlowCurve => "flow-curve",
            Self::SteadyFlow => "steady-flow",
            Self::Tank => "tank",
            Self::PulseTrain => "pulse-train",
        }
    }
}

/// What drives the runs of trajectories.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub enum Input {
    /// What the scenario says: its valve under its command, or nothing.
    #[default]
    Scenario,
    /// The pressure that was measured.
    GaugePressure,
}

/// A study file as it was read.
#[derive(Clone, Debug)]
pub struct Study {
    /// Where it stands.
    pub path: PathBuf,
    /// What is to be found.
    pub kind: Kind,
    /// The scenario file.
    pub scenario: PathBuf,
    /// What drives the runs of trajectories.
    pub input: Input,
    /// What the columns measure.
    pub columns: Vec<ColumnEntry>,
    /// The runs.
    pub runs: Vec<RunEntry>,
    /// The numbers that are looked for, in rising order of their paths; those of a force map follow from its laws.
    pub fit_entries: Vec<FitEntry>,
    /// How it is searched.
    pub search: SearchEntry,
    /// Whether units that seem wrong are right.
    pub units_are_right: bool,
    /// `[flow]` of steady flow.
    pub flow: FlowEntry,
    /// `[tank]`; there exactly for a tank.
    pub tank: Option<TankEntry>,
    /// `[pulses]` of a pulse train.
    pub pulses: PulsesEntry,
    /// Whether a number without a unit is in SI, as in a study that a program hands over; in a file units are due.
    pub numbers_are_si: bool,
    /// Tables in memory, which runs name as they name files.
    pub tables: Vec<Table>,
}

/// What a column measures and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnEntry {
    /// What it measures.
    pub quantity: Quantity,
    /// The part of a plant that it is measured of, as the plant's file calls it.
    pub part: Option<String>,
    /// Its name in the table's head.
    pub name: String,
    /// Its unit, as the study has it; the SI unit where it has none.
    pub unit: String,
    /// Size of its unit in SI.
    pub scale: f64,
    /// What 0 of its unit is in SI: zero but of degC and degF.
    pub zero: f64,
    /// Its rules.
    pub rules: Rules,
    /// What is known of its sensor.
    pub sensor: SensorEntry,
}

/// One run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunEntry {
    /// Its name: that in the study, else the stem of its first file, with the folder where stems are equal. No two runs have
    /// one name.
    pub name: String,
    /// Its tables.
    pub files: Vec<PathBuf>,
    /// Quantities without a column, in SI.
    pub held: Vec<(Quantity, f64)>,
    /// Keys of the scenario that are other here, as TOML.
    pub set: Vec<(String, String)>,
    /// The session that it belongs to, in which numbers may be its own.
    pub session: Option<String>,
}

/// A number that is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct FitEntry {
    /// Its path in the scenario.
    pub path: String,
    /// Text of start, bounds and prior (mean and standard deviation), as far as they are given.
    pub start: Option<String>,
    /// The least value.
    pub from: Option<String>,
    /// The largest value.
    pub to: Option<String>,
    /// Mean and standard deviation of what is known beforehand.
    pub prior: Option<[String; 2]>,
    /// Whether each run has its own value.
    pub per_run: bool,
    /// Whether each session has its own value.
    pub per_session: bool,
}

/// How the path of a number of a sensor begins in [fit].
const OF_COLUMNS: &str = "columns.";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    study: Spanned<Head>,
    #[serde(default)]
    columns: BTreeMap<String, Spanned<RawColumn>>,
    #[serde(default)]
    run: Vec<Spanned<RawRun>>,
    #[serde(default)]
    fit: BTreeMap<String, RawUnknown>,
    #[serde(default)]
    search: RawSearch,
    flow: Option<Spanned<RawFlow>>,
    tank: Option<Spanned<RawTank>>,
    pulses: Option<Spanned<RawPulses>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    kind: Kind,
    scenario: PathBuf,
    #[serde(default)]
    input: Input,
    #[serde(default)]
    units_are_right: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawColumn {
    name: String,
    unit: Option<Spanned<String>>,
    slack: Option<Spanned<String>>,
    saturates: Option<Spanned<String>>,
    deviation: Option<Spanned<String>>,
    offset: Option<Spanned<String>>,
    zero: Option<Vec<RawZero>>,
    #[serde(default)]
    drop_outliers: bool,
    drift: Option<Spanned<String>>,
    shift: Option<Spanned<String>>,
    lag: Option<Spanned<String>>,
    hold: Option<Spanned<String>>,
}

/// A span of time in which a quantity is known.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawZero {
    from: Spanned<String>,
    to: Spanned<String>,
    value: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRun {
    name: Option<Spanned<String>>,
    file: Option<PathBuf>,
    #[serde(default)]
    files: Vec<PathBuf>,
    #[serde(default)]
    held: BTreeMap<String, Spanned<String>>,
    #[serde(default)]
    set: BTreeMap<String, toml::Value>,
    session: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawUnknown {
    start: Option<Text>,
    from: Option<Text>,
    to: Option<Text>,
    prior: Option<RawPrior>,
    #[serde(default)]
    per_run: bool,
    #[serde(default)]
    per_session: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPrior {
    mean: Text,
    deviation: Text,
}

/// A quantity: text with a unit, or a number.
#[derive(Deserialize)]
#[serde(untagged)]
enum Text {
    Words(String),
    Number(f64),
}

impl Text {
    fn text(self) -> String {
        match self {
            Self::Words(words) => words,
            Self::Number(number) => number.to_string(),
        }
    }
}

impl ColumnEntry {
    /// What it measures, in words.
    pub fn words(&self) -> String {
        words_of(self.quantity, self.part.as_deref())
    }
}

impl Study {
    /// Reads a study file; the scenario and the tables are not opened yet.
    ///
    /// # Errors
    /// The first mistake, with its line.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let text = std::fs::read_to_string(path).map_err(|error| {
            StudyError::new(
                path,
                None,
                format!("it cannot be read ({error})"),
                "give the path of a study file in UTF-8",
            )
        })?;
        Self::parse(&text, path)
    }

    /// Reads the text of a study file; `path` names it in messages, and paths in it are relative to its folder.
    ///
    /// # Errors
    /// As [`Study::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, StudyError> {
        Self::read(text, path, false)
    }

    /// A study whose tables are in memory: TOML as a file has it, in which numbers without a unit are in SI and a column
    /// without a unit too. `name` stands for it in messages.
    ///
    /// # Errors
    /// As [`Study::load`].
    pub fn in_memory(text: &str, name: &str, tables: Vec<Table>) -> Result<Self, StudyError> {
        Ok(Self { tables, ..Self::read(text, Path::new(name), true)? })
    }

    fn read(text: &str, path: &Path, numbers_are_si: bool) -> Result<Self, StudyError> {
        let within = Within { path, text, numbers_are_si };
        let file: File = toml::from_str(text).map_err(|error| {
            let at = error.span().map(|span| span.start);
            let help = match numbers_are_si {
                true => "see `help(mckibben.Study)`",
                false => "see `mckibben identify --help` for a study file",
            };
            let help = super::syntax::remedy(text).unwrap_or_else(|| help.to_owned());
            within.fault(at, error.message().to_owned(), help)
        })?;
        let head_at = file.study.span().start;
        let head = file.study.into_inner();
        let mut columns = Vec::new();
        for (name, raw) in file.columns {
            let at = raw.span().start;
            let entry = within.column(&name, raw)?;
            if entry.part.is_some() && head.kind != Kind::Trajectories {
                let what = format!("`{name}` is of a part of a plant, which only trajectories are fitted of");
                return Err(within.fault(Some(at), what, "set kind = \"trajectories\", or name the quantity alone"));
            }
            columns.push(entry);
        }
        if file.run.is_empty() {
            let remedy = "add `[[run]]` with `file = \"data.csv\"`";
            return Err(within.fault(Some(head_at), "it has no runs", remedy));
        }
        let names = within.names(&file.run)?;
        let mut runs = Vec::new();
        for (raw, name) in file.run.into_iter().zip(names) {
            runs.push(within.run(raw, name)?);
        }
        let fit_entries = file.fit.into_iter().map(|(path, raw)| FitEntry {
            path,
            start: raw.start.map(Text::text),
            from: raw.from.map(Text::text),
            to: raw.to.map(Text::text),
            prior: raw.prior.map(|prior| [prior.mean.text(), prior.deviation.text()]),
            per_run: raw.per_run,
            per_session: raw.per_session,
        });
        let mut fit_entries: Vec<FitEntry> = fit_entries.collect();
        for entry in fit_entries.iter_mut().filter(|entry| entry.path.starts_with(OF_COLUMNS)) {
            // A column of a part is in quotes in [columns], and may be so here.
            entry.path.retain(|letter| letter != '"');
        }
        fit_entries.sort_by(|one, other| one.path.cmp(&other.path));
        if let Some(pair) = fit_entries.windows(2).find(|pair| pair[0].path == pair[1].path) {
            let what = format!("`{}` is in [fit] twice, with and without quotes", pair[0].path);
            return Err(within.fault(None, what, "leave one of them out"));
        }
        let is_own = |entry: &&FitEntry| entry.per_run || entry.per_session;
        if let Some(entry) = fit_entries.iter().find(|entry| is_own(entry) && head.kind != Kind::Trajectories) {
            let owner = if entry.per_run { "per_run" } else { "per_session" };
            let what = format!("`{owner}` of `{}` in [fit] is of a study of the kind \"trajectories\"", entry.path);
            return Err(within.fault(None, what, "leave it out"));
        }
        if let Some(entry) = fit_entries.first() {
            within.read_by(&format!("[fit.\"{}\"]", entry.path), None, head.kind, &Kind::OF_NUMBERS)?;
        }
        let is_of_sensor = |entry: &&FitEntry| entry.path.starts_with(OF_COLUMNS);
        if let Some(entry) = fit_entries.iter().find(is_of_sensor).filter(|_| head.kind != Kind::Trajectories) {
            let what =
                format!("`{}` in [fit] is a parameter of a sensor, which only trajectories estimate", entry.path);
            let remedy = "leave it out, and take off what you know by `offset` or `zero` in the column; or set kind = \"trajectories\"";
            return Err(within.fault(None, what, remedy));
        }
        if let Some(entry) = fit_entries.iter().find(|entry| entry.per_run && entry.per_session) {
            let what = format!("`{}` in [fit] is each run’s and each session’s own at once", entry.path);
            return Err(within.fault(None, what, "leave out `per_run` or `per_session`"));
        }
        let strange = |column: &&ColumnEntry| column.sensor != SensorEntry::default();
        if let Some(column) = columns.iter().find(strange).filter(|_| head.kind != Kind::Trajectories) {
            let what = format!("a sensor of the {} is described, which only trajectories know", column.words());
            return Err(within.fault(None, what, "leave `shift`, `lag`, `drift` and `hold` out"));
        }
        if head.input == Input::GaugePressure {
            within.read_by("`input` in [study]", Some(head_at), head.kind, &[Kind::Trajectories])?;
        }
        let search = file.search.read(&within, head.kind)?;
        let sections = Sections { flow: file.flow, tank: file.tank, pulses: file.pulses };
        let of_valve = sections.read(&within, head.kind, head_at)?;
        Ok(Self {
            path: path.to_path_buf(),
            kind: head.kind,
            scenario: beside(path, &head.scenario),
            input: head.input,
            columns,
            runs,
            fit_entries,
            search,
            units_are_right: head.units_are_right,
            flow: of_valve.flow,
            tank: of_valve.tank,
            pulses: of_valve.pulses,
            numbers_are_si,
            tables: Vec::new(),
        })
    }

    /// The number of a text without a unit, where [`Study::numbers_are_si`].
    pub fn in_si(&self, text: &str) -> Option<f64> {
        in_si(self.numbers_are_si, text)
    }

    /// Reads the tables of all runs and cleans them.
    ///
    /// # Errors
    /// The first table that cannot be read, or whose data are refused; see [`clean`].
    pub fn recordings(&self) -> Result<Vec<Recording>, StudyError> {
        self.runs.iter().map(|run| self.recording(run)).collect()
    }

    fn recording(&self, run: &RunEntry) -> Result<Recording, StudyError> {
        let mut recording =
            Recording { name: run.name.clone(), sheets: Vec::new(), set: run.set.clone(), notes: Vec::new() };
        let named: Vec<&str> = self.columns.iter().map(|entry| entry.name.as_str()).collect();
        let table = |file: &PathBuf| match self.tables.iter().find(|table| table.file == *file) {
            Some(table) => Ok(table.clone()),
            None => table::read(file, &named),
        };
        let tables = run.files.iter().map(table).collect::<Result<Vec<_>, _>>()?;
        if let Some(entry) = self.columns.iter().find(|entry| !tables.iter().any(|table| table.has(&entry.name))) {
            let what = format!("no table of the run `{}` has a column `{}`", run.name, entry.name);
            let heads: Vec<String> = tables.into_iter().flat_map(Table::heads).collect();
            return Err(StudyError::new(&self.path, None, what, format!("the tables have: {}", heads.join(", "))));
        }
        for table in &tables {
            if let Some(entry) = self.columns.iter().find(|entry| table.count(&entry.name) > 1) {
                let (name, count) = (&entry.name, table.count(&entry.name));
                let what = format!("it has {count} columns `{name}`, and the {} is read from that", entry.words());
                return Err(StudyError::new(&table.file, None, what, "give each column of the table a different name"));
            }
            let entries: Vec<&ColumnEntry> = self.columns.iter().filter(|entry| table.has(&entry.name)).collect();
            recording.sheets.push(clean::sheet(table, &entries, &run.held, &mut recording.notes)?);
        }
        Ok(recording)
    }
}

/// The number of a text without a unit, where such numbers are in SI.
pub(super) fn in_si(numbers_are_si: bool, text: &str) -> Option<f64> {
    numbers_are_si.then(|| text.parse().ok()).flatten()
}

/// A path in the folder of a file.
fn beside(file: &Path, path: &Path) -> PathBuf {
    file.parent().map_or_else(|| path.to_path_buf(), |folder| folder.join(path))
}

/// A text whose mistakes are reported with their lines.
pub(super) struct Within<'a> {
    path: &'a Path,
    text: &'a str,
    pub(super) numbers_are_si: bool,
}

impl Within<'_> {
    /// The number of a text without a unit, where such numbers are in SI.
    pub(super) fn in_si(&self, text: &str) -> Option<f64> {
        in_si(self.numbers_are_si, text)
    }

    pub(super) fn fault(&self, at: Option<usize>, what: impl Into<String>, remedy: impl Into<String>) -> StudyError {
        let line = at.map(|at| self.line(at));
        StudyError::new(self.path, line, what, remedy)
    }

    /// Refuses a key that a study of a kind does not read, since it would change nothing: only some kinds do.
    pub(super) fn read_by(&self, key: &str, at: Option<usize>, kind: Kind, kinds: &[Kind]) -> Result<(), StudyError> {
        if kinds.contains(&kind) {
            return Ok(());
        }
        let readers: Vec<String> = kinds.iter().map(|kind| format!("\"{}\"", kind.name())).collect();
        let what = format!("a study of the kind \"{}\" does not read {key}", kind.name());
        let remedy = format!(
            "keys without effect are refused, leave them out; this one is of the kind {}",
            readers.join(" or ")
        );
        Err(self.fault(at, what, remedy))
    }

    /// A quantity of a dimension, in SI.
    pub(super) fn si(&self, text: &Spanned<String>, of: Quantity) -> Result<f64, StudyError> {
        let at = Some(text.span().start);
        if let Some(number) = in_si(self.numbers_are_si, text.as_ref()) {
            return Ok(number);
        }
        let read = quantity::parse(text.as_ref()).map_err(|error| {
            self.fault(
                at,
                error.message.clone(),
                error.help.unwrap_or_else(|| format!("write it as in \"1 {}\"", of.unit())),
            )
        })?;
        if read.dimension != of.dimension() {
            let what = format!("\"{}\" is no {}", text.as_ref(), of.words());
            return Err(self.fault(at, what, format!("give it with a unit such as {}", of.unit())));
        }
        self.counted(of, text)?;
        Ok(read.value)
    }

    pub(super) fn maybe(&self, text: Option<&Spanned<String>>, of: Quantity) -> Result<Option<f64>, StudyError> {
        text.map(|text| self.si(text, of)).transpose()
    }

    /// A difference of two values; degC and degF have an offset zero, which is not meant.
    fn difference(&self, text: Option<&Spanned<String>>, of: Quantity) -> Result<Option<f64>, StudyError> {
        match text.filter(|text| of == Quantity::Temperature && text.as_ref().contains(['C', 'F', '℃', '℉'])) {
            Some(text) => {
                let what = format!("\"{}\" has an offset zero, but a difference is due", text.as_ref());
                Err(self.fault(Some(text.span().start), what, "give it in K or degR"))
            }
            None => self.maybe(text, of),
        }
    }

    /// Size and zero of a column's unit in SI.
    fn unit(&self, quantity: Quantity, text: &Spanned<String>) -> Result<(f64, f64), StudyError> {
        let (at, unit) = (Some(text.span().start), text.as_ref());
        let such = || format!("give a unit such as {}", quantity.unit());
        // What a number of this unit is; of degC and degF one alone does not determine it.
        let of = |number: &str| {
            quantity::parse(&format!("{number} {unit}"))
                .map_err(|error| self.fault(at, error.message, error.help.unwrap_or_else(such)))
        };
        let (dimension, scale, zero): (Dimension, f64, f64) = match quantity::parse_unit(unit) {
            Ok((dimension, scale)) => (dimension, scale, 0.0),
            Err(_) if quantity == Quantity::Temperature => {
                let [zero, one] = [of("0")?, of("1")?];
                (zero.dimension, one.value - zero.value, zero.value)
            }
            Err(error) => return Err(self.fault(at, error.message, error.help.unwrap_or_else(such))),
        };
        if dimension != quantity.dimension() {
            let what = format!("`{unit}` is no unit of {}", quantity.words());
            let remedy = match quantity {
                Quantity::Command => {
                    "give \"\" or \"%\": only whether it is above a threshold counts, volts too".to_owned()
                }
                _ => such(),
            };
            return Err(self.fault(at, what, remedy));
        }
        self.counted(quantity, text)?;
        Ok((scale, zero))
    }

    /// Refuses a volume flow that does not say which air it counts.
    fn counted(&self, of: Quantity, text: &Spanned<String>) -> Result<(), StudyError> {
        let says = ["ANR", "scfm"].iter().any(|word| text.as_ref().contains(word));
        if of != Quantity::VolumeFlow || says {
            return Ok(());
        }
        let what = format!("`{}` does not say at which pressure and temperature the air is counted", text.as_ref());
        let remedy = "write `L/min ANR` of air at 100 kPa, 20 °C and 65 % humidity (ISO 8778), or give the mass flow";
        Err(self.fault(Some(text.span().start), what, remedy))
    }

    fn quantity(&self, name: &str, at: usize) -> Result<Quantity, StudyError> {
        Quantity::ALL.into_iter().find(|quantity| quantity.name() == name).ok_or_else(|| {
            let known = Quantity::ALL.map(Quantity::name).join(", ");
            self.fault(Some(at), format!("`{name}` is no quantity of a study"), format!("known: {known}"))
        })
    }

    /// A quantity of a part of a plant, such as `flexor.gauge_pressure`, or one alone.
    fn of_part(&self, name: &str, at: usize) -> Result<(Quantity, Option<String>), StudyError> {
        let Some((part, word)) = name.rsplit_once('.') else { return Ok((self.quantity(name, at)?, None)) };
        let found = Quantity::of_part(word).ok_or_else(|| {
            let known = Quantity::OF_PARTS.map(Quantity::name).join(", ");
            self.fault(Some(at), format!("`{word}` is no quantity of a plant's part"), format!("known: {known}"))
        });
        Ok((found?, Some(part.to_owned())))
    }

    fn column(&self, name: &str, raw: Spanned<RawColumn>) -> Result<ColumnEntry, StudyError> {
        let (quantity, part) = self.of_part(name, raw.span().start)?;
        let (begins, raw) = (raw.span().start, raw.into_inner());
        let at = Some(raw.unit.as_ref().map_or(begins, |unit| unit.span().start));
        let (scale, zero) = match &raw.unit {
            Some(unit) => self.unit(quantity, unit)?,
            None if self.numbers_are_si => (1.0, 0.0),
            None => {
                return Err(self.fault(
                    at,
                    format!("`{name}` has no unit"),
                    format!("add `unit = \"{}\"`", quantity.unit()),
                ));
            }
        };
        let unit = raw.unit.as_ref().map_or_else(|| quantity.unit().to_owned(), |unit| unit.as_ref().clone());
        let mut zeros = Vec::new();
        for known in raw.zero.unwrap_or_default() {
            let span = [self.si(&known.from, Quantity::Time)?, self.si(&known.to, Quantity::Time)?];
            if span[0] >= span[1] {
                let at = Some(known.from.span().start);
                return Err(self.fault(at, "a span of `zero` ends before it begins", "give `from` below `to`"));
            }
            zeros.push((span, self.maybe(known.value.as_ref(), quantity)?.unwrap_or(0.0)));
        }
        let rules = Rules {
            slack: self.maybe(raw.slack.as_ref(), quantity)?,
            saturates: self.maybe(raw.saturates.as_ref(), quantity)?,
            deviation: self.difference(raw.deviation.as_ref(), quantity)?,
            offset: self.difference(raw.offset.as_ref(), quantity)?.unwrap_or(0.0),
            zeros,
            drop_outliers: raw.drop_outliers,
        };
        if let (Some(given), Some(deviation)) = (&raw.deviation, rules.deviation)
            && !(deviation > 0.0 && deviation.is_finite())
        {
            let what = format!("the deviation of `{name}` is {}, which is not above zero", given.as_ref());
            return Err(self.fault(
                Some(given.span().start),
                what,
                "give the standard deviation of a reading, or leave it out",
            ));
        }
        if rules.slack.is_some() && !quantity.is_tension() {
            return Err(self.fault(
                at,
                format!("`slack` is of a tension, not of a {}", quantity.words()),
                "leave it out",
            ));
        }
        let sensor = RawSensor { drift: raw.drift, shift: raw.shift, lag: raw.lag, hold: raw.hold };
        let sensor = sensor.read(self, quantity)?;
        Ok(ColumnEntry { quantity, part, name: raw.name, unit, scale, zero, rules, sensor })
    }

    /// The line of a place in the text, counted from 1.
    fn line(&self, at: usize) -> usize {
        self.text[..at.min(self.text.len())].matches('\n').count() + 1
    }

    /// The names of runs, no two equal: those that the study gives, else stems of files. Where stems are equal, the path without
    /// its ending; where that is equal too, a number behind it.
    fn names(&self, runs: &[Spanned<RawRun>]) -> Result<Vec<String>, StudyError> {
        let mut names: Vec<Option<String>> = vec![None; runs.len()];
        let mut given: Vec<(String, usize)> = Vec::new();
        for (run, name) in runs.iter().zip(&mut names) {
            let Some(text) = &run.as_ref().name else { continue };
            let at = text.span().start;
            if let Some((_, first)) = given.iter().find(|(other, _)| *other == as_file_name(text.as_ref())) {
                // A program that hands over a study has no lines.
                let also =
                    if self.numbers_are_si { String::new() } else { format!(", in line {} too", self.line(*first)) };
                let what = format!("`{}` is the name of two runs{also}", text.as_ref());
                return Err(self.fault(Some(at), what, "give each run a different name"));
            }
            given.push((as_file_name(text.as_ref()), at));
            *name = Some(text.as_ref().clone());
        }
        let file = |run: &Spanned<RawRun>| run.as_ref().file.iter().chain(&run.as_ref().files).next().cloned();
        let whole = |path: PathBuf| path.with_extension("").to_string_lossy().replace('\\', "/");
        let stem = |path: PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let unnamed = || runs.iter().filter(|run| run.as_ref().name.is_none()).filter_map(file);
        let is_single = |name: &str, of: &dyn Fn(PathBuf) -> String| {
            unnamed().filter(|path| as_file_name(&of(path.clone())) == as_file_name(name)).count() == 1
        };
        let mut taken: Vec<String> = given.into_iter().map(|(name, _)| name).collect();
        for (run, name) in runs.iter().zip(&mut names).filter(|(_, name)| name.is_none()) {
            // A run without a file is refused where it is read.
            let Some(path) = file(run) else { continue };
            let [short, long] = [stem(path.clone()), whole(path)];
            let is_free = |name: &str, taken: &[String]| !taken.contains(&as_file_name(name));
            let own = if is_single(&short, &stem) && is_free(&short, &taken) { short } else { long };
            let numbered = |number: usize| if number == 1 { own.clone() } else { format!("{own}-{number}") };
            let own = (1..).map(numbered).find(|name| is_free(name, &taken)).unwrap_or_default();
            taken.push(as_file_name(&own));
            *name = Some(own);
        }
        Ok(names.into_iter().map(Option::unwrap_or_default).collect())
    }

    fn run(&self, raw: Spanned<RawRun>, name: String) -> Result<RunEntry, StudyError> {
        let at = raw.span().start;
        let raw = raw.into_inner();
        let files: Vec<PathBuf> = raw.file.into_iter().chain(raw.files).map(|file| beside(self.path, &file)).collect();
        if files.is_empty() {
            return Err(self.fault(Some(at), "a run has no file", "give `file = \"data.csv\"`"));
        }
        let mut held = Vec::new();
        for (name, value) in raw.held {
            let quantity = self.quantity(&name, value.span().start)?;
            held.push((quantity, self.si(&value, quantity)?));
        }
        let set = raw.set.into_iter().map(|(key, value)| (key, value.to_string()));
        Ok(RunEntry { name, held, set: set.collect(), files, session: raw.session })
    }
}

/// The name of a run as part of the name of a file, without separators of folders.
pub fn as_file_name(run: &str) -> String {
    run.trim_start_matches(['/', '\\']).replace(['/', '\\', ':'], "-")
}
