//! How much a flow path lets through, stated in one of four ways: by the file, else by the preset.

use super::alternative;
use crate::diagnostic::{Class, Diagnostic};
use crate::presets::Preset;
use crate::reader::Reader;
use crate::scenario::FlowPath;
use mckibben::parameter::{self as p, Parameter};

/// The rows that state a flow path.
pub(crate) struct Rows {
    pub(crate) flow_area: &'static Parameter,
    pub(crate) sonic_conductance: &'static Parameter,
    pub(crate) critical_ratio: &'static Parameter,
    pub(crate) kv: &'static Parameter,
    pub(crate) cv: &'static Parameter,
    pub(crate) pressure_drop_ratio: &'static Parameter,
}

/// Of the flow path to the supply, and of both where the exhaust has no separate one.
pub(crate) static SUPPLY: Rows = Rows {
    flow_area: &p::FLOW_AREA,
    sonic_conductance: &p::SONIC_CONDUCTANCE,
    critical_ratio: &p::CRITICAL_RATIO,
    kv: &p::KV,
    cv: &p::CV,
    pressure_drop_ratio: &p::PRESSURE_DROP_RATIO,
};
/// Of the flow path to the atmosphere.
pub(crate) static EXHAUST: Rows = Rows {
    flow_area: &p::EXHAUST_FLOW_AREA,
    sonic_conductance: &p::EXHAUST_SONIC_CONDUCTANCE,
    critical_ratio: &p::EXHAUST_CRITICAL_RATIO,
    kv: &p::EXHAUST_KV,
    cv: &p::EXHAUST_CV,
    pressure_drop_ratio: &p::EXHAUST_PRESSURE_DROP_RATIO,
};

impl Rows {
    /// The ways to state a flow path, each by the rows that must be given.
    pub(crate) fn ways(&self) -> [Vec<&'static Parameter>; 4] {
        [vec![self.flow_area], vec![self.sonic_conductance, self.critical_ratio], vec![self.kv], vec![self.cv]]
    }

    /// Whether a row is one of these.
    pub(super) fn has(&self, row: &Parameter) -> bool {
        let ways = self.ways();
        ways.iter().flatten().chain([&self.pressure_drop_ratio]).any(|own| own.key == row.key)
    }

    /// Whether any of the ways is begun.
    pub(crate) fn begun(&self, gives: impl Fn(&Parameter) -> bool) -> bool {
        self.ways().iter().flatten().any(|row| gives(row))
    }
}

/// The flow path, or `None` when neither the file nor the preset states it.
pub(super) fn flow_path(r: &mut Reader<'_>, rows: &Rows, preset: Option<&Preset>) -> Option<FlowPath> {
    let by_preset = |row: &Parameter| preset.is_some_and(|preset| preset.get(row).is_some());
    let ways = rows.ways();
    let whole = |way: &[&Parameter]| way.iter().all(|row| by_preset(row));
    // Of what the preset gives whole, the file may give a part.
    let groups = ways.each_ref().map(|way| {
        let needed = way.iter().filter(|row| r.has(row.key) || !whole(way));
        needed.map(|row| row.key).collect::<Vec<_>>()
    });
    let chosen =
        alternative(r, &groups.each_ref().map(Vec::as_slice)).or_else(|| ways.iter().position(|way| whole(way)));
    let by_water = matches!(chosen, Some(2 | 3));
    if let Some(place) = r.key_place(rows.pressure_drop_ratio.key).filter(|_| !by_water) {
        let title = format!("`{}` goes with `kv` or `cv`", rows.pressure_drop_ratio.key);
        r.note(Diagnostic::at(Class::NotApplicable, place, title, "does not apply").help("remove it"));
    }
    let mut number = |row| if by_preset(row) { r.value(row, preset) } else { r.noted(row) };
    Some(match chosen? {
        0 => FlowPath::FlowArea(number(rows.flow_area)),
        1 => FlowPath::Iso6358 {
            sonic_conductance: number(rows.sonic_conductance),
            critical_ratio: number(rows.critical_ratio),
        },
        way => {
            let coefficient = number(if way == 2 { rows.kv } else { rows.cv });
            let pressure_drop_ratio = r.value(rows.pressure_drop_ratio, preset);
            match way {
                2 => FlowPath::Kv { kv: coefficient, pressure_drop_ratio },
                _ => FlowPath::Cv { cv: coefficient, pressure_drop_ratio },
            }
        }
    })
}
