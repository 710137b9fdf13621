//! The air line: the hose, and what makes a supply change.
//!
//! A hose needs a valve. What describes a reservoir's start or its compressor needs the reservoir; what describes the
//! switch or the clearance needs the compressor, and the figures of a regulator need its lag.

use super::gauge_pressure;
use crate::choice::HoseKind;
use crate::diagnostic::{Class, Diagnostic};
use crate::reader::Reader;
use crate::scenario::{Air, Compressor, Hose, PressureRegulator, Reservoir};
use mckibben::parameter::{self as p, Parameter};

/// The hose, if the file has one.
pub(super) fn hose(r: &mut Reader<'_>) -> Option<Hose> {
    let place = r.key_place("hose")?;
    if !r.has("valve") && !r.has("pressure") {
        let title = "there is a [hose] but no [valve], so nothing flows through it";
        r.note(
            Diagnostic::at(Class::NotApplicable, place, title, "joins no valve")
                .help("add a section `[valve]`, or remove `[hose]` to seal the actuator"),
        );
    }
    hose_of_any(r)
}

/// The hose of an actuator or a supply.
pub(super) fn hose_of_any(r: &mut Reader<'_>) -> Option<Hose> {
    r.key_place("hose")?;
    let kind = r.word("hose.kind").unwrap_or(HoseKind::Lumped);
    let cells = match kind {
        HoseKind::Lumped => 1,
        // The range of the row is far below the largest whole number of any machine.
        HoseKind::Distributed => r.whole(&p::HOSE_CELLS).or_else(|| Some(p::HOSE_CELLS.default? as u64)).unwrap_or(1),
    };
    let [length, diameter] = [&p::HOSE_LENGTH, &p::HOSE_DIAMETER].map(|row| r.value(row, None));
    let [viscosity, polytropic_index] = [&p::HOSE_VISCOSITY, &p::HOSE_INDEX].map(|row| r.value(row, None));
    Some(Hose { kind, cells: cells as usize, length, diameter, viscosity, polytropic_index })
}

/// The reservoir of the supply, if it has one.
pub(super) fn reservoir(r: &mut Reader<'_>, air: &Air) -> Option<Reservoir> {
    let of_compressor = [&p::CLEARANCE, &p::CUT_IN, &p::CUT_OUT];
    for row in [&p::RESERVOIR_PRESSURE, &p::RESERVOIR_INDEX, &p::DISPLACEMENT] {
        needs(r, row, &p::RESERVOIR_VOLUME);
    }
    for row in of_compressor {
        needs(r, row, &p::DISPLACEMENT);
    }
    let volume = r.number(&p::RESERVOIR_VOLUME)?;
    let start = r.has(p::RESERVOIR_PRESSURE.key).then(|| gauge_pressure(r, &p::RESERVOIR_PRESSURE, air));
    let compressor = r.number(&p::DISPLACEMENT).map(|displacement| {
        for row in [&p::CUT_IN, &p::CUT_OUT] {
            if !r.has(row.key) {
                r.missing(row.key, ", between which the compressor runs");
            }
        }
        Compressor {
            displacement,
            clearance: r.value(&p::CLEARANCE, None),
            cut_in: r.noted(&p::CUT_IN),
            cut_out: r.noted(&p::CUT_OUT),
        }
    });
    Some(Reservoir { volume, gauge_pressure: start, polytropic_index: r.value(&p::RESERVOIR_INDEX, None), compressor })
}

/// The regulator of the supply, if it has one.
pub(super) fn regulator(r: &mut Reader<'_>) -> Option<PressureRegulator> {
    for row in [&p::DROOP, &p::DEAD_BAND] {
        needs(r, row, &p::LAG);
    }
    let lag = r.number(&p::LAG)?;
    Some(PressureRegulator { lag, droop: r.value(&p::DROOP, None), dead_band: r.value(&p::DEAD_BAND, None) })
}

/// How many actuators draw from the supply.
pub(super) fn actuators(r: &mut Reader<'_>) -> f64 {
    r.value(&p::ACTUATORS, None)
}

/// Refuses a key without another that it describes more closely.
fn needs(r: &mut Reader<'_>, row: &'static Parameter, other: &'static Parameter) {
    let Some(place) = r.key_place(row.key).filter(|_| !r.has(other.key)) else { return };
    let title = format!("`{}` is not used without `{}`", row.key, other.key);
    let help = format!("remove it, or add `{}`", other.key);
    r.note(Diagnostic::at(Class::NotApplicable, place, title, "does not apply").help(help));
}
