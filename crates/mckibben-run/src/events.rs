//! The log of events in words, and as CSV.
//!
//! The columns of the CSV are `time_s,event,valve,supply_flow,exhaust_flow,length_regime,sliding,tension_clamped`; after the name
//! of the event they say what holds from then on.
//!
//! [`Log`] holds the same in memory, of an actuator, a joint or a plant.

use crate::failure::Failure;
use crate::table::{Cell, Column, Writer};
use mckibben::plant::RigEvent;
use mckibben::simulation::{EventKind, LengthRegime, Mode, Sliding};
use mckibben::valve::FlowZone;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

/// The columns of the CSV that say what holds of an actuator.
pub const OF_ACTUATOR: [&str; 6] =
    ["valve", "supply_flow", "exhaust_flow", "length_regime", "sliding", "tension_clamped"];

/// How many events of each kind there are.
pub fn counts(events: &[RigEvent]) -> BTreeMap<EventKind, u64> {
    let mut counts = BTreeMap::new();
    for event in events {
        *counts.entry(event.kind).or_insert(0) += 1;
    }
    counts
}

/// A log of events in words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// The names of the words, the first of them `event`.
    pub columns: Vec<String>,
    /// The times of the events in s, in order.
    pub times: Vec<f64>,
    /// The words of each event.
    pub rows: Vec<Vec<Cow<'static, str>>>,
}

impl Log {
    /// The log of an actuator's run.
    pub fn new(events: &[RigEvent]) -> Self {
        let columns = ["event"].into_iter().chain(OF_ACTUATOR).map(str::to_owned).collect();
        let row =
            |event: &RigEvent| [event.kind.name()].into_iter().chain(words(&event.after)).map(Cow::Borrowed).collect();
        let times = events.iter().map(|event| event.time).collect();
        Self { columns, times, rows: events.iter().map(row).collect() }
    }

    /// Writes the log as CSV, with the time of each event before its words.
    ///
    /// # Errors
    /// [`Failure::output`], which names `path`, when writing fails.
    pub fn write(&self, path: &Path, out: &mut (dyn Write + Send)) -> Result<(), Failure> {
        let words = self.columns.iter().map(Column::word);
        let columns = [Column::number("time_s", "s")].into_iter().chain(words).collect();
        let mut writer = Writer::csv(columns, path, out)?;
        for (time, words) in self.times.iter().zip(&self.rows) {
            let words = words.iter().map(|word| Cell::Word(word));
            let cells: Vec<Cell<'_>> = [Cell::Number(*time)].into_iter().chain(words).collect();
            writer.row(&cells)?;
        }
        writer.finish(&[]).map(drop)
    }
}

/// What holds of an actuator, in the order of [`OF_ACTUATOR`].
pub(crate) fn words<'w>(mode: &Mode) -> [&'w str; 6] {
    let [supply, exhaust] = [mode.supply_zone, mode.exhaust_zone].map(|flow| flow.map_or("", zone));
    let clamped = if mode.clamped { "true" } else { "false" };
    [mode.ports.name(), supply, exhaust, length_regime(mode.length_regime), sliding(mode.sliding), clamped]
}

/// The name of a piece of the flow law.
pub(crate) fn zone(zone: FlowZone) -> &'static str {
    match zone {
        FlowZone::ChokedIn => "choked-in",
        FlowZone::SubsonicIn => "subsonic-in",
        FlowZone::LaminarIn => "laminar-in",
        FlowZone::LaminarOut => "laminar-out",
        FlowZone::SubsonicOut => "subsonic-out",
        FlowZone::ChokedOut => "choked-out",
    }
}

pub(crate) fn length_regime(length_regime: LengthRegime) -> &'static str {
    match length_regime {
        LengthRegime::Slack => "slack",
        LengthRegime::Free => "free",
        LengthRegime::Taut => "taut",
        LengthRegime::Rebound => "rebound",
    }
}

fn sliding(sliding: Sliding) -> &'static str {
    match sliding {
        Sliding::Lengthening => "lengthening",
        Sliding::Shortening => "shortening",
        Sliding::Stuck => "stuck",
        Sliding::Held => "held",
        Sliding::Frictionless => "frictionless",
    }
}
