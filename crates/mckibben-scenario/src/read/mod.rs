//! Reads a document into a [`Scenario`]: the rules that join sections, and what several sections share.
//!
//! One function for each section, in the modules below, says what the section may hold, which keys exclude each other
//! and what stands in for absent ones: the file, then the preset, then the parameter table's default.
//!
//! | module | sections |
//! |---|---|
//! | `body` | actuator, air |
//! | `drive` | supply, valve, command |
//! | `controller` | controller |
//! | `line` | hose, reservoir and regulator of the supply |
//! | `flow_path` | how much the valve's flow paths let through |
//! | `conditions` | pressure, tendon, load, initial, run |
//! | `joint` | load and antagonist of an antagonistic joint |
//! | `plant` | actuators and supplies of a plant |
//! | `mechanism` | its mechanisms, and how actuators span them |
//!
//! Checked by `tests/scenario.rs` and `tests/diagnostics.rs`.

mod body;
mod conditions;
pub(crate) mod controller;
mod drive;
pub(crate) mod flow_path;
mod friction;
mod joint;
mod line;
mod mechanism;
mod plant;

pub(crate) use body::{describes_braid, describes_whole_braid, gives_braid, gives_law};
pub(crate) use drive::SEATS;

use crate::diagnostic::{Class, Diagnostic, Diagnostics, Place};
use crate::document::Document;
use crate::keys;
use crate::quantity;
use crate::reader::{Reader, list_of, out_of_range, required_sections};
use crate::scenario::{Air, Scenario};
use mckibben::parameter::{self as p, Parameter};

impl Document {
    /// Reads what the document says.
    ///
    /// # Errors
    /// Every mistake that can be found in one reading.
    pub fn scenario(&self) -> Result<Scenario, Diagnostics> {
        if let Some(place) = [keys::ACTUATORS, keys::SUPPLIES, keys::MECHANISM, keys::MECHANISMS]
            .iter()
            .find_map(|section| self.place(section))
        {
            let limit = &mckibben::limit::PLANT_HERE;
            return Err(Diagnostic::at(
                Class::NotImplemented,
                place.clone(),
                limit.title().to_string(),
                "names actuators",
            )
            .help(limit.remedy)
            .into());
        }
        let mut reader = Reader::new(self);
        let r = &mut reader;
        for section in required_sections().filter(|section| !self.contains(section)) {
            r.missing_section(section, None);
        }
        let actuator = body::actuator(r);
        let air = body::air(r);
        let driven = drive::drive(r, &air);
        let hose = line::hose(r);
        let pressure = conditions::pressure(r);
        let tendon = conditions::tendon(r);
        let load = if self.contains("load") { conditions::load(r, &air) } else { None };
        let initial = conditions::initial(r, load.as_ref(), pressure.as_ref(), &air, conditions::Owner::Single);
        let run = if self.contains("run") { Some(conditions::run(r)) } else { None };
        reader.finish()?;
        match (load, run) {
            (Some(load), Some(run)) => {
                let (supply, valve, command) = driven;
                Ok(Scenario { actuator, air, supply, valve, hose, command, pressure, tendon, load, initial, run })
            }
            // Not reached: a part that could not be read has been noted. Said rather than assumed.
            _ => Err(Diagnostic::whole(Class::Missing, self.source().name(), "the scenario is incomplete").into()),
        }
    }
}

/// A gauge pressure, which cannot be below vacuum.
pub(super) fn gauge_pressure(r: &mut Reader<'_>, row: &'static Parameter, air: &Air) -> f64 {
    let value = r.value(row, None);
    if let Some(place) = r.value_place(row.key).filter(|_| value <= -air.atmospheric_pressure) {
        let vacuum = quantity::format(-air.atmospheric_pressure, row.unit);
        let atmosphere = r.value_place(p::ATMOSPHERIC_PRESSURE.key);
        r.note(
            out_of_range(place, row, value, &format!("greater than {vacuum}, which is vacuum"))
                .related(atmosphere, "the atmosphere is given here"),
        );
    }
    value
}

/// Which of several groups of keys is given: at most one may be, and it must be complete.
pub(super) fn alternative(r: &mut Reader<'_>, groups: &[&[&str]]) -> Option<usize> {
    let given = |r: &Reader<'_>, group: &[&str]| group.iter().find_map(|path| r.key_place(path));
    let mut chosen: Option<(usize, Place)> = None;
    for (index, group) in groups.iter().enumerate() {
        let Some(place) = given(r, group) else { continue };
        if let Some((_, first)) = &chosen {
            let names = |group: &[&str]| list_of(group.iter().map(|path| path.rsplit('.').next().unwrap_or(path)));
            let ways: Vec<String> = groups.iter().map(|group| names(group)).collect();
            let section = group[0].rsplit_once('.').map_or("", |(section, _)| section);
            let title = format!("[{section}] says the same thing in two ways");
            r.note(
                Diagnostic::at(Class::Conflict, place, title, "second way")
                    .related(Some(first.clone()), "first way")
                    .help(format!("keep exactly one of: {}", ways.join("; "))),
            );
            continue;
        }
        for path in group.iter().filter(|path| !r.has(path)).collect::<Vec<_>>() {
            let partner = group.iter().find(|path| r.has(path)).and_then(|path| path.rsplit('.').next());
            r.missing(path, &format!(", which `{}` needs in addition", partner.unwrap_or_default()));
        }
        chosen = Some((index, place));
    }
    chosen.map(|(index, _)| index)
}

/// Two lists that are the columns of one table: equally long, the first strictly increasing. The absence of either
/// has been noted by the caller.
pub(super) fn columns<T>(
    r: &mut Reader<'_>,
    row: &Parameter,
    first: Option<Vec<f64>>,
    second_path: &str,
    second: Option<Vec<T>>,
) -> (Vec<f64>, Vec<T>) {
    let (Some(first), Some(second)) = (first, second) else { return (Vec::new(), Vec::new()) };
    let falls = first.windows(2).position(|pair| pair[1] <= pair[0]);
    if let Some((before, place)) = falls.and_then(|at| Some((at, r.item_place(row.key, at + 1)?))) {
        let title = format!("`{}` must increase from entry to entry", row.key);
        let label = format!("entry {} is not above the one before", before + 2);
        r.note(
            Diagnostic::at(Class::BadList, place, title, label)
                .related(r.item_place(row.key, before), "the one before")
                .help("sort the table and keep one row for each value"),
        );
    }
    if let Some(place) = r.value_place(second_path).filter(|_| first.len() != second.len()) {
        let title = format!("`{}` has {} entries, but `{second_path}` has {}", row.key, first.len(), second.len());
        r.note(
            Diagnostic::at(Class::BadList, place, title, "the lists must be equally long")
                .related(r.value_place(row.key), format!("{} entries", first.len()))
                .help("give one entry of each for every row of the table"),
        );
    }
    (first, second)
}
