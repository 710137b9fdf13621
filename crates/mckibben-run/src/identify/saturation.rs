//! Readings at an end of a sensor's range that no column states: they pass for what was measured, and pull every fit.
//!
//! | found | then |
//! |---|---|
//! | `saturates` of a column leaves none of its readings | refused: it is an upper end |
//! | tensions of a force map that are exactly the largest, where the ideal braid pulls differently | refused |
//! | readings over time that stay at exactly their largest or least, between others that scatter | reported |
//!
//! Over time an end is seen between other readings alone: at the beginning and at the end of a record a rig rests. Where a sensor has
//! steps or holds its samples, equal readings say nothing. A length that rests at a limit of its muscle, and a tension of zero, are no
//! ends. That lengths and tensions over time stay at their largest is refused where they are read (`study`).
//!
//! Checked by the tests below, and by the program's `tests/identify/units.rs`.

use super::Material;
use super::outcome::WARNED;
use super::units::lengths;
use crate::failure::Failure;
use crate::quantities::{digits, quantity};
use mckibben_identify::statics::ForceMap;
use mckibben_identify::statics::units::saturated;
use mckibben_identify::study::clean::STUCK;
use mckibben_identify::study::{Column, ColumnEntry, Kind, Quantity, Sheet};
use mckibben_identify::trajectories::sample;
use mckibben_scenario::{Document, Scenario};

/// Part of the readings that are at an end from which on it is reported.
const PART: f64 = 0.02;
/// Part of the other readings that repeat the one before, above which a sensor has steps.
const STEPS: f64 = 0.1;
/// Part of the fourth differences whose sign changes, above which readings have noise: of a smooth series few do.
const NOISY: f64 = 0.3;
/// Part of the range of a length within which it rests at a limit.
const AT_LIMIT: f64 = 0.01;

/// Refuses a `saturates` that leaves none of the readings of a run.
///
/// # Errors
/// [`Failure::input`], which names the column.
pub(super) fn check(material: &Material) -> Result<(), Failure> {
    for (run, _, column) in columns(material) {
        let Some((entry, end)) = entry(material, column).and_then(|entry| Some((entry, entry.rules.saturates?))) else {
            continue;
        };
        if column.values.iter().any(|value| value.is_finite()) {
            continue;
        }
        let title = format!(
            "`saturates` in {} leaves none of the readings of the run `{run}`: those at or above {} are left out",
            section(entry),
            quantity(end, column.quantity.unit())
        );
        let help = "give the upper end of the sensor; where it is at its lower end, empty these cells in the table";
        return Err(Failure::input(title, help));
    }
    Ok(())
}

/// Refuses a force map whose load cell is at its end, unless its column says where it ends.
///
/// # Errors
/// [`Failure::input`], which says how to leave these readings out.
pub(super) fn check_map(material: &Material, map: &ForceMap, base: &Scenario) -> Result<(), Failure> {
    let states = |entry: &ColumnEntry| entry.quantity == Quantity::Tension && entry.rules.saturates.is_some();
    if material.study.columns.iter().any(states) {
        return Ok(());
    }
    let found = saturated(map, base).map_err(|error| Failure::of_core(&error, &material.document))?;
    let Some(found) = found else { return Ok(()) };
    let tension = found.tension;
    let title = format!(
        "{} of {} tensions are exactly {tension} N, the largest, at places where those of the ideal braid differ by a factor of {}: the \
         sensor is at its end",
        found.count,
        found.of,
        digits(found.ratio)
    );
    let help = format!(
        "set `saturates = \"{tension} N\"` in [columns.tension] to leave these readings out, or a larger value to keep them"
    );
    Err(Failure::input(title, help))
}

/// Readings over time that stay at an end which no column states.
pub(super) fn warnings(material: &Material) -> Vec<String> {
    if !matches!(material.study.kind, Kind::Trajectories | Kind::Hysteresis) {
        return Vec::new();
    }
    let documents: Vec<Document> =
        material.recordings.iter().filter_map(|recording| material.document_of(recording).ok()).collect();
    let mut warnings = Vec::new();
    for (run, sheet, column) in columns(material).filter(|(.., column)| may_end(column.quantity)) {
        let Some(entry) = entry(material, column) else { continue };
        let Some((times, values)) = sheet.channel(column) else { continue };
        let samples = samples(&times, &values, entry.sensor.hold);
        let limits = lengths(entry, &documents).filter(|_| column.quantity.unit() == "m").unwrap_or_default();
        for upper in [true, false] {
            let Some(stay) = stay(&samples, upper) else { continue };
            let near = |limit: f64| (stay.at - limit).abs() <= AT_LIMIT * (limits[1] - limits[0]);
            let is_slack = column.quantity.unit() == "N" && stay.at <= 0.0;
            if (upper && entry.rules.saturates.is_some()) || is_slack || limits.into_iter().any(near) {
                continue;
            }
            let (which, remedy) = match upper {
                true => ("largest", "set `saturates` there to leave them out"),
                false => ("least", "empty these cells in the table: `saturates` states an upper end"),
            };
            warnings.push(format!(
                "{WARNED}`{run}`: {} readings of the {} are exactly {}, the {which}, up to {} on end, and the others scatter: is the sensor of \
                 {} at its end? If it is, {remedy}.",
                stay.count,
                column.words(),
                quantity(stay.at, column.quantity.unit()),
                stay.longest,
                section(entry)
            ));
        }
    }
    warnings
}

/// Every column of every run, with its table and the name of the run.
fn columns(material: &Material) -> impl Iterator<Item = (&str, &Sheet, &Column)> {
    material.recordings.iter().flat_map(|recording| {
        let of_sheet = |sheet| (recording.name.as_str(), sheet);
        let sheets = recording.sheets.iter().map(of_sheet);
        sheets.flat_map(|(run, sheet)| sheet.columns.iter().map(move |column| (run, sheet, column)))
    })
}

/// What the study says of a column.
fn entry<'m>(material: &'m Material, column: &Column) -> Option<&'m ColumnEntry> {
    material.study.columns.iter().find(|entry| entry.quantity == column.quantity && entry.part == column.part)
}

/// A column as [columns] has it.
fn section(entry: &ColumnEntry) -> String {
    match &entry.part {
        Some(part) => format!("[columns.\"{part}.{}\"]", entry.quantity.name()),
        None => format!("[columns.{}]", entry.quantity.name()),
    }
}

/// Whether equal readings of a quantity are those of a sensor at its end: what is set, and angles at a stop, may well rest.
fn may_end(of: Quantity) -> bool {
    match of {
        Quantity::RegulatedPressure | Quantity::RegulatedGaugePressure | Quantity::SetPoint => false,
        of => matches!(of.unit(), "m" | "N" | "N*m" | "Pa"),
    }
}

/// The first reading of each sample that a sensor holds.
fn samples(times: &[f64], values: &[f64], hold: Option<f64>) -> Vec<f64> {
    let Some(interval) = hold else { return values.to_vec() };
    let sample = |place: usize| sample(interval, times[place]);
    let is_first = |place: &usize| *place == 0 || sample(*place) != sample(place - 1);
    (0..values.len()).filter(is_first).map(|place| values[place]).collect()
}

/// Readings that stay at their largest or least.
#[derive(Debug, PartialEq)]
struct Stay {
    at: f64,
    count: usize,
    longest: usize,
}

/// Readings that stay at their largest or least between others that scatter, if any do.
fn stay(values: &[f64], upper: bool) -> Option<Stay> {
    let pick = if upper { f64::max } else { f64::min };
    let at = values.iter().copied().reduce(pick)?;
    // Those at the beginning and at the end of a record are no stays.
    let pieces: Vec<&[f64]> = values.chunk_by(|one, other| (*one == at) == (*other == at)).collect();
    let inner = pieces.get(1..pieces.len().checked_sub(1)?).unwrap_or_default();
    let stays = || inner.iter().filter(|piece| piece[0] == at).map(|piece| piece.len());
    let (count, longest) = (stays().sum::<usize>(), stays().max()?);
    let others = || pieces.iter().filter(|piece| piece[0] != at);
    let (mut pairs, mut repeated, mut differences, mut changes) = (0, 0, 0, 0);
    for piece in others() {
        pairs += piece.len() - 1;
        repeated += piece.windows(2).filter(|pair| pair[0] == pair[1]).count();
        let fourth = piece.windows(5).map(|of| of[0] - 4.0 * of[1] + 6.0 * of[2] - 4.0 * of[3] + of[4]);
        let fourth: Vec<f64> = fourth.collect();
        differences += fourth.len().saturating_sub(1);
        changes += fourth.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    }
    let is_more = |part: usize, of: usize, limit: f64| part as f64 > limit * of as f64;
    let is_end = longest >= STUCK
        && is_more(count, values.len(), PART)
        && !is_more(repeated, pairs, STEPS)
        && is_more(changes, differences, NOISY);
    is_end.then_some(Stay { at, count, longest })
}

#[cfg(test)]
mod tests {
    use super::{samples, stay};

    /// An oscillation of unit amplitude with a period of 50 readings, and noise of a thousandth: a fixed sequence that is not smooth.
    fn record(noise: f64) -> Vec<f64> {
        let shake = |place: u32| (12.9898 * f64::from(place)).sin() * 43_758.545_3;
        let noise = |place: u32| noise * (shake(place) - shake(place).floor() - 0.5);
        (0..400_u32).map(|place| (0.04 * std::f64::consts::PI * f64::from(place)).cos() + noise(place)).collect()
    }

    #[test]
    fn either_end_of_a_sensor_is_seen_between_readings_that_scatter() {
        let noisy = record(1e-3);
        for upper in [true, false] {
            assert_eq!(stay(&noisy, upper), None);
            // cos x > 0.5 for a third of a period: 16 or 17 readings of 50, less half of the first period at the beginning.
            let clip = |value: &f64| if upper { value.min(0.5) } else { value.max(-0.5) };
            let clipped: Vec<f64> = noisy.iter().map(clip).collect();
            let found = stay(&clipped, upper).expect("an end");
            assert!(found.at.abs() == 0.5 && (16..=18).contains(&found.longest), "{found:?}");
            assert!((110..=136).contains(&found.count), "{found:?}");
            assert_eq!(stay(&clipped, !upper), None);
        }
    }

    #[test]
    fn what_rests_has_steps_or_holds_is_at_no_end() {
        // A smooth record that is cut is that of a mass at a stop.
        let smooth: Vec<f64> = record(0.0).iter().map(|value| value.min(0.5)).collect();
        assert_eq!(stay(&smooth, true), None);
        let stepped: Vec<f64> = record(1e-3).iter().map(|value| (10.0 * value).round() / 10.0).collect();
        assert_eq!(stay(&stepped, true), None);
        // A rest before the run.
        let rested: Vec<f64> = std::iter::repeat_n(2.0, 60).chain(record(1e-3)).collect();
        assert_eq!(stay(&rested, true), None);
        let held: Vec<f64> = record(1e-3).into_iter().step_by(20).flat_map(|value| [value; 20]).collect();
        let times: Vec<f64> = (0..400).map(|place| 1e-3 * f64::from(place)).collect();
        assert_eq!(samples(&times, &held, Some(0.02)).len(), 20);
        assert_eq!(stay(&samples(&times, &held, Some(0.02)), true), None);
        assert_eq!(stay(&[], true), None);
        assert_eq!(stay(&[1.0; 50], true), None);
    }
}
