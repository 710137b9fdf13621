//! The sections of a study of a valve.
//!
//! ```toml
//! [flow]                        # of "flow-curve" and "steady-flow"
//! scatter = "constant"          # of the flow: the same for all readings, or "proportional" to each
//! flow_path = "supply"            # the one that was measured, or "exhaust"
//! area = "3.1 mm^2"             # of "steady-flow": C_q of this area is found, in place of the efficiency
//!
//! [tank]                        # of "tank"
//! find = "valve"                # or "volume"
//! transfer = "discharge"        # to the atmosphere, or "charge" from the supply
//! volume = "0.5 L"              # line included; where it is unknown, a guess
//! temperature = "20 degC"       # of the air at the start and of the wall; else the scenario's at its start
//! begins = "0.1 s"              # when the valve opens; else the first reading
//! ends = "1.5 s"                # up to which readings count; else the last
//! heat = true                   # whether the heat transfer is found too
//! windows = 40                  # by the slopes of so many windows, as ISO 6358-2 does, in place of the trajectory
//! length = "98 mm"              # the actuator is part of the volume, held at this length
//!
//! [pulses]                      # of "pulse-train"
//! begins = "0.2 s"              # the first pulse of the scenario's PWM, in the record's time; else 0 s
//! threshold = 2.5               # of `[columns.command]`: above it the coil is energised; else the middle of its range
//! ```

use super::StudyError;
use super::file::{Kind, Within, in_si};
use crate::valve::Scatter;
use mckibben_scenario::Dimension;
use serde::Deserialize;
use toml::Spanned;

/// Which of two flow paths, or the direction of flow through it.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// From the supply into the actuator: a charge.
    #[default]
    #[serde(alias = "charge")]
    Supply,
    /// To the atmosphere: a discharge.
    #[serde(alias = "discharge")]
    Exhaust,
}

/// `[flow]`: steady flow through a flow path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowEntry {
    /// How the scatter of the flow goes with its size.
    pub scatter: Scatter,
    /// The flow path.
    pub flow_path: Direction,
    /// Its area A_p in m², whose flow coefficient is found.
    pub area: Option<f64>,
}

/// What is found of a tank.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub enum TankTarget {
    /// C and b of the valve.
    Valve,
    /// The volume.
    Volume,
}

/// `[tank]`: a volume that is charged or discharged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TankEntry {
    /// What is found.
    pub find: TankTarget,
    /// Which way the air goes.
    pub transfer: Direction,
    /// The volume in m³, or a guess of it.
    pub volume: f64,
    /// Temperature in K of the air at the start and of the wall, where it is not the scenario's.
    pub temperature: Option<f64>,
    /// When the valve opens, in s.
    pub begins: Option<f64>,
    /// Up to when readings count, in s.
    pub ends: Option<f64>,
    /// Whether the heat transfer is found too.
    pub heat: bool,
    /// In how many windows slopes are taken, in place of a trajectory.
    pub windows: Option<usize>,
    /// Length in m of the actuator, where that is part of the volume.
    pub length: Option<f64>,
}

/// `[pulses]`: the command behind the pressure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PulsesEntry {
    /// When the first pulse of the scenario's PWM begins, in s of the record.
    pub begins: f64,
    /// The command above which the coil is energised.
    pub threshold: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum RawScatter {
    Constant,
    Proportional,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFlow {
    scatter: Option<RawScatter>,
    #[serde(default)]
    flow_path: Direction,
    area: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawTank {
    find: TankTarget,
    transfer: Direction,
    volume: Spanned<String>,
    temperature: Option<Spanned<String>>,
    begins: Option<Spanned<String>>,
    ends: Option<Spanned<String>>,
    #[serde(default)]
    heat: bool,
    windows: Option<Spanned<i64>>,
    length: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPulses {
    begins: Option<Spanned<String>>,
    threshold: Option<f64>,
}

/// The sections as they were read.
#[derive(Default)]
pub(super) struct Sections {
    pub(super) flow: Option<Spanned<RawFlow>>,
    pub(super) tank: Option<Spanned<RawTank>>,
    pub(super) pulses: Option<Spanned<RawPulses>>,
}

/// What they say.
pub(super) struct Entries {
    pub(super) flow: FlowEntry,
    pub(super) tank: Option<TankEntry>,
    pub(super) pulses: PulsesEntry,
}

impl Sections {
    /// Reads the sections of a kind of study, whose head stands at `head`.
    pub(super) fn read(self, within: &Within<'_>, kind: Kind, head: usize) -> Result<Entries, StudyError> {
        let starts = [
            ("flow", self.flow.as_ref().map(|flow| flow.span().start), [Kind::FlowCurve, Kind::SteadyFlow].as_slice()),
            ("tank", self.tank.as_ref().map(|tank| tank.span().start), &[Kind::Tank]),
            ("pulses", self.pulses.as_ref().map(|pulses| pulses.span().start), &[Kind::PulseTrain]),
        ];
        for (section, start, kinds) in starts {
            if let Some(start) = start.filter(|_| !kinds.contains(&kind)) {
                let kinds: Vec<String> = kinds.iter().map(|kind| format!("\"{}\"", kind.name())).collect();
                let what = format!("`[{section}]` belongs to a study of the kind {}", kinds.join(" or "));
                return Err(within.fault(Some(start), what, "leave it out, or mend `kind` of `[study]`"));
            }
        }
        let flow = within.flow(self.flow, kind)?;
        let tank = self.tank.map(|tank| within.tank(tank.into_inner())).transpose()?;
        if kind == Kind::Tank && tank.is_none() {
            let remedy = "add `[tank]` with `find`, `transfer` and `volume`, see `mckibben identify --help`";
            return Err(within.fault(Some(head), "the study does not say what tank it is", remedy));
        }
        let pulses = match self.pulses.map(Spanned::into_inner) {
            Some(RawPulses { begins, threshold }) => {
                let begins = begins.map(|begins| within.number("pulses.begins", &begins, TIME)).transpose()?;
                PulsesEntry { begins: begins.unwrap_or(0.0), threshold }
            }
            None => PulsesEntry::default(),
        };
        Ok(Entries { flow, tank, pulses })
    }
}

/// A dimension, and how a value of it is written.
type Sort = (Dimension, &'static str);
const AREA: Sort = (Dimension::AREA, "\"3 mm^2\"");
const VOLUME: Sort = (Dimension::VOLUME, "\"0.5 L\"");
const TEMPERATURE: Sort = (Dimension::TEMPERATURE, "\"293 K\" or \"20 degC\"");
const TIME: Sort = (Dimension::TIME, "\"0.1 s\"");
const LENGTH: Sort = (Dimension::LENGTH, "\"98 mm\"");

impl Within<'_> {
    /// A quantity of a dimension in SI, where a key of a section has one.
    fn number(&self, key: &str, text: &Spanned<String>, (dimension, example): Sort) -> Result<f64, StudyError> {
        let at = Some(text.span().start);
        if let Some(number) = in_si(self.numbers_are_si, text.as_ref()) {
            return Ok(number);
        }
        let wrong = |why: String| {
            self.fault(
                at,
                format!("`{key}` is \"{}\": {why}", text.as_ref()),
                format!("give {} such as {example}", dimension.noun()),
            )
        };
        let read = mckibben_scenario::quantity::parse(text.as_ref()).map_err(|error| wrong(error.message))?;
        match read.dimension == dimension {
            true => Ok(read.value),
            false => Err(wrong(format!("that is {}", read.dimension.noun()))),
        }
    }

    /// A quantity in SI that must be above zero.
    fn positive(&self, key: &str, text: &Spanned<String>, sort: Sort) -> Result<f64, StudyError> {
        match self.number(key, text, sort)? {
            value if value > 0.0 => Ok(value),
            _ => {
                let what = format!("`{key}` is \"{}\", which is not above zero", text.as_ref());
                Err(self.fault(Some(text.span().start), what, format!("give {} such as {}", sort.0.noun(), sort.1)))
            }
        }
    }

    fn flow(&self, raw: Option<Spanned<RawFlow>>, kind: Kind) -> Result<FlowEntry, StudyError> {
        let Some(raw) = raw.map(Spanned::into_inner) else {
            return Ok(FlowEntry { scatter: Scatter::Constant, flow_path: Direction::Supply, area: None });
        };
        if let Some(area) = raw.area.as_ref().filter(|_| kind != Kind::SteadyFlow) {
            let what = "`flow.area` belongs to a study of the kind \"steady-flow\"";
            return Err(self.fault(Some(area.span().start), what, "leave it out: C and b say nothing of an area"));
        }
        let scatter = match raw.scatter {
            Some(RawScatter::Proportional) => Scatter::Proportional,
            Some(RawScatter::Constant) | None => Scatter::Constant,
        };
        let area = raw.area.map(|area| self.positive("flow.area", &area, AREA)).transpose()?;
        Ok(FlowEntry { scatter, flow_path: raw.flow_path, area })
    }

    fn tank(&self, raw: RawTank) -> Result<TankEntry, StudyError> {
        let maybe = |key: &str, text: &Option<Spanned<String>>, sort: Sort| {
            text.as_ref().map(|text| self.positive(key, text, sort)).transpose()
        };
        let time = |key: &str, text: &Option<Spanned<String>>| {
            text.as_ref().map(|text| self.number(key, text, TIME)).transpose()
        };
        let windows = match &raw.windows {
            Some(count) if *count.as_ref() < 5 => {
                let what = format!("`tank.windows` is {}, which is below 5", count.as_ref());
                return Err(self.fault(Some(count.span().start), what, "give a number of windows such as 40"));
            }
            Some(count) => Some(*count.as_ref() as usize),
            None => None,
        };
        if let Some(count) = raw.windows.as_ref().filter(|_| raw.find == TankTarget::Volume || raw.heat) {
            let what = "`tank.windows` finds a valve behind a known volume, and no heat transfer";
            return Err(self.fault(Some(count.span().start), what, "leave it out: the trajectory finds either"));
        }
        let (begins, ends) = (time("tank.begins", &raw.begins)?, time("tank.ends", &raw.ends)?);
        if let (Some(from), Some(to), Some(text)) = (begins, ends, &raw.ends)
            && to <= from
        {
            let what = format!("`tank.ends` is \"{}\", not after `tank.begins`", text.as_ref());
            return Err(self.fault(Some(text.span().start), what, "give the end of the readings that count"));
        }
        if let Some(length) = raw.length.as_ref().filter(|_| raw.find == TankTarget::Valve) {
            let what = "`tank.length` is of a volume that is found";
            return Err(self.fault(Some(length.span().start), what, "leave it out: `volume` is all of the volume"));
        }
        Ok(TankEntry {
            find: raw.find,
            transfer: raw.transfer,
            volume: self.positive("tank.volume", &raw.volume, VOLUME)?,
            temperature: maybe("tank.temperature", &raw.temperature, TEMPERATURE)?,
            begins,
            ends,
            heat: raw.heat,
            windows,
            length: maybe("tank.length", &raw.length, LENGTH)?,
        })
    }
}
