//! Whether readings can be those of the scenario: a unit that was mistaken puts them far outside what it can have.
//!
//! | of | is far | then |
//! |---|---|---|
//! | a length | half of the readings above five times the greatest length of the muscle, or below a fifth of the least | refused |
//! | a pressure | a reading above five times the highest supply, or all within a hundredth of it about nothing; without a supply the pressure at which the sealed muscle of trajectories begins stands for it | reported |
//! | a gauge pressure of trajectories | begins about the atmosphere's pressure above the scenario's initial gauge pressure | reported |
//! | the times of trajectories | last a hundred times as long as the run of the scenario, or a hundredth of it; begin after its end | reported |
//! | the times of trajectories | begin ten thousand times as late as the run of the scenario or the record is long | refused |
//! | tensions with length and pressure | half of them below zero where the ideal braid pulls, or pulling where it pushes | refused |
//! | tensions with length and pressure | not in proportion to the ideal braid's, and another unit puts that right | refused |
//! | tensions of a force map | a twentieth of the ideal braid's or twenty times them | refused |
//! | tensions of a force map | vanish at a gauge pressure that is about the atmosphere's, or as far below it | reported |
//! | a pressure of a valve or a tank on a bench | a reading above five times the highest supply; before a valve all below a fifth of the atmosphere | refused |
//! | a temperature of air before a valve | a reading above 400 K | refused |
//!
//! A pressure that swings about zero is that of a muscle without air, and no doubt. One warning for each column; none where
//! the study says `units_are_right`, and nothing is refused there.
//!
//! Checked by the program's `tests/identify/units.rs`, and by the tests below.

use super::Material;
use super::outcome::WARNED;
use crate::failure::Failure;
use crate::quantities::{digits, plain, quantity};
use mckibben_identify::statics::units::{Misdirected, Suspicion, misdirected, suspect, vanishes_at_atmosphere};
use mckibben_identify::statics::{ForceMap, Point};
use mckibben_identify::study::{ColumnEntry, Input, Kind, Quantity, Recording, Sheet};
use mckibben_scenario::{Document, Scenario};

/// How many times the greatest value, or part of the least, is far.
const FAR: f64 = 5.0;
/// Part of the highest supply that is far below it.
const SMALL: f64 = 0.01;
/// Part of the largest reading by which readings fall below zero where they swing about it.
const SWINGS: f64 = 0.1;
/// How many times as long as the run of the scenario a record is that was taken in another unit of time.
const LASTING: f64 = 100.0;
/// How many times as late as the run of the scenario and the record are long a record begins whose times are those of a clock.
const LATE: f64 = 1e4;
/// How near, as a part of it, a difference is to the pressure of the atmosphere.
const ABOUT: f64 = 0.1;
/// An absolute pressure in Pa below which the fit of a valve says that it is hardly more than a vacuum.
const VACUUM: f64 = 1e3;
/// The highest temperature in K of air before a valve.
const HOTTEST: f64 = 400.0;
/// Readings that are compared with the braid at most.
const MOST_POINTS: usize = 500;

/// What comes first where units are in doubt and a fit is bad.
pub(super) const FIRST: &str = "first see to the units that are in doubt above";

/// A warning for each column whose readings lie far outside what the scenario can have.
pub(super) fn doubts(material: &Material) -> Vec<String> {
    if is_silent(material) {
        return Vec::new();
    }
    let documents = documents(material);
    let columns = || material.study.columns.iter();
    let of_columns = columns().filter_map(|entry| doubt(entry, &readings(material, entry), &documents, material));
    let warned = of_columns.map(|doubt| format!("{WARNED}{}: {}.", doubt.title, doubt.help));
    let trajectories = material.study.kind == Kind::Trajectories;
    let of_runs = material.recordings.iter().zip(&documents).filter(|_| trajectories);
    let of_runs = of_runs.flat_map(|(recording, document)| {
        columns().filter_map(|entry| begins_elsewhere(material, entry, recording, document)).collect::<Vec<_>>()
    });
    warned.chain(of_runs).collect()
}

/// Refuses readings that the scenario cannot have, whatever its parameters: lengths that its muscle cannot have by far, and tensions
/// that are not its braid's.
///
/// # Errors
/// [`Failure::input`], which names the column and what to do.
pub(super) fn check(material: &Material) -> Result<(), Failure> {
    if material.study.units_are_right {
        return Ok(());
    }
    let documents: Vec<Document> =
        material.recordings.iter().map(|recording| material.document_of(recording)).collect::<Result<_, _>>()?;
    let kind = material.study.kind;
    let refused = material.study.columns.iter().filter(|entry| is_of_bench(kind) || is_length(entry));
    if let Some(Doubt { title, help }) =
        refused.filter_map(|entry| doubt(entry, &readings(material, entry), &documents, material)).next()
    {
        return Err(Failure::input(title, help));
    }
    let of_runs = material.recordings.iter().zip(&documents).filter(|_| kind == Kind::Trajectories);
    for (recording, document) in of_runs {
        if let Some(Late { title, help, .. }) = late(recording, document).filter(|late| late.is_clock) {
            return Err(Failure::input(title, help));
        }
    }
    // A force map is compared as a whole; a plant has no single muscle.
    if !matches!(material.study.kind, Kind::Hysteresis | Kind::Trajectories) || material.document.is_plant() {
        return Ok(());
    }
    for (recording, document) in material.recordings.iter().zip(&documents) {
        let scenario = document.scenario()?;
        let points = points(recording, scenario.air.atmospheric_pressure);
        if scenario.has_joint() || points.is_empty() {
            continue;
        }
        check_signs(material, &points, &scenario)?;
        let held = points.into_iter().map(|point| Point { slack: point.slack || point.tension <= 0.0, ..point });
        let Ok(map) = ForceMap::new(held.collect()) else { continue };
        if let Some((title, help)) = mistaken(material, &map, &scenario)? {
            return Err(Failure::input(title, help));
        }
    }
    Ok(())
}

/// Whether nothing is reported: the units are said to be right, or they are refused where they are in doubt.
fn is_silent(material: &Material) -> bool {
    material.study.units_are_right || is_of_bench(material.study.kind)
}

/// Whether a study is of a valve on a bench, which another supply may feed than the scenario's.
fn is_of_bench(kind: Kind) -> bool {
    matches!(kind, Kind::FlowCurve | Kind::SteadyFlow | Kind::Tank)
}

/// The scenario of each run.
fn documents(material: &Material) -> Vec<Document> {
    material.recordings.iter().filter_map(|recording| material.document_of(recording).ok()).collect()
}

/// Of at most [`MOST_POINTS`] readings with a pressure, a length and a tension in one table, evenly chosen, those above half of the
/// greatest pressure.
fn points(recording: &Recording, atmosphere: f64) -> Vec<Point> {
    let complete = |sheet: &&Sheet| {
        let pressure = sheet.column(Quantity::GaugePressure).or(sheet.column(Quantity::AbsolutePressure));
        pressure.is_some() && [Quantity::Length, Quantity::Tension].iter().all(|of| sheet.column(*of).is_some())
    };
    let Some(sheet) = recording.sheets.iter().find(complete) else { return Vec::new() };
    let value = |of: Quantity, row: usize| sheet.column(of).map(|column| column.values[row]);
    let point = |row: usize| {
        let absolute = || value(Quantity::AbsolutePressure, row).map(|pressure| pressure - atmosphere);
        let gauge_pressure = value(Quantity::GaugePressure, row).or_else(absolute)?;
        let (length, tension) = (value(Quantity::Length, row)?, value(Quantity::Tension, row)?);
        let is_whole = [gauge_pressure, length, tension].iter().all(|number| number.is_finite());
        is_whole.then_some(Point { gauge_pressure, length, tension, slack: false, run: 0 })
    };
    let points: Vec<Point> =
        (0..sheet.rows).step_by(sheet.rows.div_ceil(MOST_POINTS).max(1)).filter_map(point).collect();
    let fold =
        |first: f64, pick: fn(f64, f64) -> f64| points.iter().map(|point| point.gauge_pressure).fold(first, pick);
    let (least, greatest) = (fold(f64::INFINITY, f64::min), fold(0.0, f64::max));
    // At no pressure the braid says nothing of a tension.
    let counts = |point: &Point| -least <= SWINGS * greatest && point.gauge_pressure > 0.5 * greatest;
    points.iter().copied().filter(counts).collect()
}

/// What to do where the direction or the size of tensions is wrong.
const MEND: &str = "correct `unit` in [columns], or the geometry in the scenario; if all of it is right, set `units_are_right = true` in \
                    [study]";

/// Refuses tensions that have not the direction of the braid's.
///
/// # Errors
/// [`Failure::input`], which says what may be the cause.
pub(super) fn check_signs(material: &Material, points: &[Point], scenario: &Scenario) -> Result<(), Failure> {
    if material.study.units_are_right {
        return Ok(());
    }
    let found = misdirected(points, scenario).map_err(|error| Failure::of_core(&error, &material.document))?;
    let (title, help) = match found {
        None => return Ok(()),
        Some(Misdirected::Negative) => (
            "most tensions are below zero where the braid of the scenario pulls: is their sign reversed?",
            "give tensions that are above zero where the muscle pulls; if all of it is right, set `units_are_right = true` in [study]",
        ),
        Some(Misdirected::Pulling) => (
            "most tensions pull at lengths at which the braid of the scenario cannot pull: are the columns of length and tension swapped?",
            MEND,
        ),
    };
    Err(Failure::input(title, help))
}

/// The tensions of a force map compared with the ideal braid's: what is odd about them, in words.
///
/// # Errors
/// [`Failure::input`] where a wrong unit explains them, or no muscle has them.
pub(super) fn tensions(material: &Material, map: &ForceMap, base: &Scenario) -> Result<Option<String>, Failure> {
    if material.study.units_are_right {
        return Ok(None);
    }
    if let Some((title, help)) = mistaken(material, map, base)? {
        return Err(Failure::input(title, help));
    }
    let failed = |error: mckibben::Error| Failure::of_core(&error, &material.document);
    if let Some(found) = suspect(map, base).map_err(failed)? {
        let ratio = digits(found.ratio);
        if found.is_impossible() {
            let title = format!("the tensions are {ratio} of the ideal braid's, which no muscle is");
            return Err(Failure::input(title, MEND));
        }
        return Ok(Some(format!(
            "{WARNED}the tensions are {ratio} of the ideal braid's of `thread_length` and `turns` in the scenario: check units and \
             geometry. Fitted turns take up any such factor."
        )));
    }
    let has = |of: Quantity| material.study.columns.iter().any(|entry| entry.quantity == of);
    Ok(vanishes_at_atmosphere(map, base).map_err(failed)?.and_then(|pressure| {
        let (said, is_it, other) = match pressure > 0.0 {
            true => (Quantity::GaugePressure, "absolute", Quantity::AbsolutePressure),
            false => (Quantity::AbsolutePressure, "gauge", Quantity::GaugePressure),
        };
        let words = if pressure > 0.0 { "which is about that of the atmosphere" } else { "which is about a vacuum" };
        has(said).then(|| {
            format!(
                "{WARNED}the tensions vanish at a gauge pressure of {}, {words}: if the pressure is {is_it}, name it [columns.{}].",
                quantity(pressure, "Pa"),
                other.name()
            )
        })
    }))
}

/// That a wrong unit explains the tensions, if one does, and what to do.
fn mistaken(material: &Material, map: &ForceMap, base: &Scenario) -> Result<Option<(String, &'static str)>, Failure> {
    let found = suspect(map, base).map_err(|error| Failure::of_core(&error, &material.document))?;
    let Some(Suspicion { ratio, causes }) = found else { return Ok(None) };
    // A cause in the unit that the study says comes first.
    let columns = || {
        material.study.columns.iter().filter(|entry| {
            matches!(entry.quantity, Quantity::GaugePressure | Quantity::AbsolutePressure | Quantity::Tension)
        })
    };
    let said = |cause: &str| columns().any(|entry| cause.ends_with(&format!("where {} was said", entry.unit)));
    let cause = causes.iter().find(|(cause, _)| said(cause)).or(causes.first());
    Ok(cause.map(|(cause, left)| {
        let title = format!(
            "the tensions are {} of the ideal braid's, which no muscle is; it seems that {cause}: that would leave {left:.2}",
            digits(ratio)
        );
        (title, MEND)
    }))
}

/// Readings of a column in all runs in SI, in rising order.
fn readings(material: &Material, entry: &ColumnEntry) -> Vec<f64> {
    let sheets = material.recordings.iter().flat_map(|recording| &recording.sheets);
    let columns = sheets.flat_map(|sheet| &sheet.columns);
    let own = columns.filter(|column| column.quantity == entry.quantity && column.part == entry.part);
    let mut readings: Vec<f64> =
        own.flat_map(|column| &column.values).copied().filter(|value| value.is_finite()).collect();
    readings.sort_by(f64::total_cmp);
    readings
}

/// That a run begins elsewhere than its scenario: after its end, or about an atmosphere above its pressure.
fn begins_elsewhere(
    material: &Material,
    entry: &ColumnEntry,
    recording: &Recording,
    document: &Document,
) -> Option<String> {
    let name = &recording.name;
    match entry.quantity {
        Quantity::Time => {
            let Late { title, help, .. } = late(recording, document)?;
            Some(format!("{WARNED}{title}; {help}."))
        }
        Quantity::GaugePressure if entry.part.is_none() && material.study.input == Input::Scenario => {
            let scenario = document.scenario().ok()?;
            let initial = scenario.initial.gauge_pressure.unwrap_or(0.0);
            let values = &recording.column(Quantity::GaugePressure)?.values;
            let (first, atmosphere) =
                (*values.iter().find(|value| value.is_finite())?, scenario.air.atmospheric_pressure);
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let is_above = |value: f64| (value - initial - atmosphere).abs() < ABOUT * atmosphere;
            (is_above(first) && least > (1.0 - ABOUT) * atmosphere).then(|| {
                format!(
                    "{WARNED}are the units right? `{name}`: the gauge pressure begins at {}, where the scenario begins at {}. The difference \
                     is about the atmosphere: if the pressure is absolute, name it [columns.absolute_pressure].",
                    quantity(first, "Pa"),
                    quantity(initial, "Pa")
                )
            })
        }
        _ => None,
    }
}

/// That the times of a run begin after the end of its scenario's.
struct Late {
    title: String,
    help: String,
    /// Whether they begin so late that they are those of a clock: nothing is simulated until then.
    is_clock: bool,
}

fn late(recording: &Recording, document: &Document) -> Option<Late> {
    let times = &recording.column(Quantity::Time)?.values;
    let (first, last, duration) = (*times.first()?, *times.last()?, duration(document)?);
    (first > duration).then(|| Late {
        title: format!(
            "`{}`: times begin at {}, after the end of the scenario's run of {}, which begins at zero",
            recording.name,
            quantity(first, "s"),
            quantity(duration, "s")
        ),
        help: format!(
            "if the record begins with the run, set `offset = \"{first:?} s\"` in [columns.time], which is taken off"
        ),
        is_clock: first > LATE * duration.max(last - first),
    })
}

/// Duration in s of the run of a scenario.
fn duration(document: &Document) -> Option<f64> {
    match document.is_plant() {
        true => Some(document.plant_experiment().ok()??.run.duration),
        false => Some(document.scenario().ok()?.run.duration),
    }
}

fn is_length(entry: &ColumnEntry) -> bool {
    matches!(entry.quantity, Quantity::Length | Quantity::AntagonistLength)
}

/// That a column is far from what the scenario can have.
struct Doubt {
    title: String,
    help: String,
}

/// That a column is far from what the scenario can have, if it is.
fn doubt(entry: &ColumnEntry, readings: &[f64], documents: &[Document], material: &Material) -> Option<Doubt> {
    let kind = material.study.kind;
    let (least, greatest) = (*readings.first()?, *readings.last()?);
    let typical = readings[readings.len() / 2];
    let has = match entry.quantity {
        of if is_of_bench(kind) => of_bench(of, [least, greatest], documents),
        Quantity::Time if kind == Kind::Trajectories => {
            let durations = || documents.iter().filter_map(duration);
            let [shortest, longest] = [durations().reduce(f64::min)?, durations().reduce(f64::max)?];
            let span = greatest - least;
            let is_far = span > LASTING * longest || (span > 0.0 && span * LASTING < shortest);
            is_far.then(|| format!("in the scenario the run lasts {}", quantity(longest, "s")))
        }
        Quantity::Length | Quantity::AntagonistLength => {
            let [shortest, longest] = lengths(entry, documents)?;
            let is_far = typical > FAR * longest || typical < shortest / FAR;
            let whose = entry.part.as_ref().map_or_else(|| "the muscle".to_owned(), |part| format!("`{part}`"));
            is_far.then(|| {
                format!("in the scenario {whose} is {} to {} long", quantity(shortest, "m"), quantity(longest, "m"))
            })
        }
        of => {
            let is_absolute = is_absolute(of)?;
            let atmosphere = documents.iter().map(Document::atmosphere).reduce(f64::max)?;
            let supply = documents.iter().filter_map(Document::highest_supply).reduce(f64::max);
            let reference = supply.or_else(|| begins_at(documents, material))?;
            let highest = if is_absolute { reference + atmosphere } else { reference };
            let swings = -least > SWINGS * greatest;
            let is_small = greatest > 0.0 && greatest < SMALL * highest && !swings;
            let is_far = reference > 0.0 && (greatest > FAR * highest || is_small);
            is_far.then(|| match supply {
                Some(_) => supplied(highest, is_absolute),
                None => format!(
                    "in the scenario the sealed muscle begins at {} {}",
                    quantity(highest, "Pa"),
                    kind_of(is_absolute)
                ),
            })
        }
    };
    let in_unit = |value: f64| plain(&digits((value - entry.zero) / entry.scale)).to_owned();
    let section = match &entry.part {
        Some(part) => format!("[columns.\"{part}.{}\"]", entry.quantity.name()),
        None => format!("[columns.{}]", entry.quantity.name()),
    };
    has.map(|has| Doubt {
        title: format!(
            "are the units right? The column `{}` with the {} reads {} to {} {}, but {has}",
            entry.name,
            entry.words(),
            in_unit(least),
            in_unit(greatest),
            entry.unit
        ),
        help: format!("correct `unit` in {section} or the scenario, or set `units_are_right = true` in [study]"),
    })
}

/// What the scenario of a valve on a bench has in place of readings between two values, if these are far from it.
fn of_bench(of: Quantity, [least, greatest]: [f64; 2], documents: &[Document]) -> Option<String> {
    let is_absolute = match of {
        Quantity::Temperature => {
            return (greatest > HOTTEST).then(|| format!("air before a valve has at most {HOTTEST} K"));
        }
        Quantity::UpstreamAbsolutePressure | Quantity::AbsolutePressure => true,
        Quantity::UpstreamGaugePressure | Quantity::GaugePressure => false,
        _ => return None,
    };
    let atmosphere = documents.iter().map(Document::atmosphere).reduce(f64::max)?;
    if of == Quantity::UpstreamAbsolutePressure && least > VACUUM && greatest < atmosphere / FAR {
        return Some(format!("in the scenario the atmosphere has {}", quantity(atmosphere, "Pa")));
    }
    let supply = documents.iter().filter_map(Document::highest_supply).reduce(f64::max)?;
    let highest = if is_absolute { supply + atmosphere } else { supply };
    (highest > 0.0 && greatest > FAR * highest).then(|| supplied(highest, is_absolute))
}

/// The pressure in Pa of the highest supply, in words.
fn supplied(highest: f64, is_absolute: bool) -> String {
    format!("in the scenario the highest supply has {} {}", quantity(highest, "Pa"), kind_of(is_absolute))
}

fn kind_of(is_absolute: bool) -> &'static str {
    if is_absolute { "absolute" } else { "gauge" }
}

/// The highest gauge pressure in Pa at which a muscle of trajectories begins whose pressure follows from the scenario.
fn begins_at(documents: &[Document], material: &Material) -> Option<f64> {
    let follows = material.study.kind == Kind::Trajectories && material.study.input == Input::Scenario;
    if !follows || material.document.is_plant() {
        return None;
    }
    let scenarios = || documents.iter().filter_map(|document| document.scenario().ok());
    let others = scenarios().filter_map(|scenario| scenario.of_antagonist()?.initial.gauge_pressure);
    scenarios().filter_map(|scenario| scenario.initial.gauge_pressure).chain(others).reduce(f64::max)
}

/// Whether a pressure is absolute; `None` of what is no pressure in the air of muscles.
fn is_absolute(of: Quantity) -> Option<bool> {
    match of {
        Quantity::GaugePressure
        | Quantity::AntagonistGaugePressure
        | Quantity::HoseGaugePressure
        | Quantity::RegulatedGaugePressure
        | Quantity::SetPoint => Some(false),
        Quantity::AbsolutePressure
        | Quantity::AntagonistAbsolutePressure
        | Quantity::HosePressure
        | Quantity::RegulatedPressure => Some(true),
        _ => None,
    }
}

/// The least and the greatest length in m of the muscle of a column, over all runs.
pub(super) fn lengths(entry: &ColumnEntry, documents: &[Document]) -> Option<[f64; 2]> {
    let is_own = |name: &str| match (&entry.part, entry.quantity) {
        (Some(part), _) => name == part,
        (None, Quantity::AntagonistLength) => name == "antagonist",
        (None, _) => name == "muscle" || name == "agonist",
    };
    let muscles = documents.iter().flat_map(Document::muscles).filter(|(name, _)| is_own(name));
    let ranges = muscles.map(|(_, muscle)| [muscle.min_length, muscle.max_length]);
    ranges.reduce(|[least, most], [shortest, longest]| [least.min(shortest), most.max(longest)])
}

#[cfg(test)]
mod tests {
    use super::super::{Request, identified};
    use mckibben_identify::study::Table;
    use mckibben_scenario::Document;

    /// What a study of flows through a valve of 0.6 L/(s·bar) says, with pressures in bar and temperatures in °C as its columns have
    /// them; the pressures of the data are times a number, the temperatures plus another.
    fn said(kind: &str, more: &str, [scale, warmer]: [f64; 2]) -> String {
        let rig = "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"three-way\"\nsonic_conductance = \"0.6 L/(s*bar)\"\n\
                   critical_ratio = 0.32\n[command]\nkind = \"fill\"\n[load]\nkind = \"isometric\"\n[initial]\n\
                   gauge_pressure = \"0 bar\"\nlength = \"90 mm\"\n[run]\nduration = \"1 s\"\n";
        let study = format!(
            "[study]\nkind = \"{kind}\"\nscenario = \"rig.toml\"\n{more}[columns.upstream_absolute_pressure]\nname = \"P1\"\n\
             unit = \"bar\"\n[columns.downstream_absolute_pressure]\nname = \"P2\"\nunit = \"bar\"\n[columns.temperature]\n\
             name = \"T\"\nunit = \"degC\"\n[columns.mass_flow]\nname = \"m\"\nunit = \"g/s\"\n[[run]]\nfile = \"flow\"\n"
        );
        let ratios: Vec<f64> = (0..14).map(|place| 0.16 + 0.055 * f64::from(place)).collect();
        // The quarter ellipse of ISO 6358 from 7 bar at 20 °C, in g/s, with a ripple of a thousandth.
        let flow = |(place, ratio): (usize, &f64)| {
            let above = ((ratio - 0.32) / 0.68).max(0.0);
            4.977 * (1.0 - above * above).sqrt() * (1.0 + 1e-3 * [1.0, -1.0, -1.0, 1.0][place % 4])
        };
        let columns = vec![
            ("P1".to_owned(), vec![7.0 * scale; 14]),
            ("P2".to_owned(), ratios.iter().map(|ratio| 7.0 * scale * ratio).collect()),
            ("T".to_owned(), vec![20.0 + warmer; 14]),
            ("m".to_owned(), ratios.iter().enumerate().map(flow).collect()),
        ];
        let table = Table::new("flow", columns).expect("a table");
        let document = Document::parse(rig, "rig.toml").expect("a scenario");
        let request = Request::in_memory(&study, vec![table], document).expect("a study");
        match identified(request, None) {
            Ok(found) if found.estimates.is_empty() => "nothing".to_owned(),
            Ok(_) => "found".to_owned(),
            Err(failure) => failure.sentence(),
        }
    }

    #[test]
    fn flows_in_another_unit_of_pressure_or_temperature_are_refused() {
        for kind in ["flow-curve", "steady-flow"] {
            assert_eq!(said(kind, "", [1.0, 0.0]), "found");
            for (factors, column, words) in [
                // kPa and psi as bar.
                (
                    [100.0, 0.0],
                    "[columns.upstream_absolute_pressure]",
                    "`P1` with the upstream absolute pressure reads 700",
                ),
                (
                    [14.503_77, 0.0],
                    "[columns.upstream_absolute_pressure]",
                    "but in the scenario the highest supply has",
                ),
                // bar as kPa.
                ([0.01, 0.0], "[columns.upstream_absolute_pressure]", "but in the scenario the atmosphere has"),
                // K as °C.
                ([1.0, 273.15], "[columns.temperature]", "degC, but air before a valve has at most 400 K"),
            ] {
                let said = said(kind, "", factors);
                assert!(said.contains("are the units right?") && said.contains(words), "{kind}: {said}");
                assert!(said.contains(column) && said.contains("units_are_right = true"), "{kind}: {said}");
            }
            assert_eq!(said(kind, "units_are_right = true\n", [100.0, 0.0]), "found");
        }
    }
}
