//! Sensors of a study: what its columns say is known of them, and which of their numbers are looked for.

use super::Material;
use super::unknowns::{check_order, check_start, read};
use crate::failure::Failure;
use mckibben_identify::least_squares::Unknown;
use mckibben_identify::study::{Column, ColumnEntry, FitEntry, Input, Quantity, SensorEntry};
use mckibben_identify::trajectories::{AMOUNTS, Amount, Sensor};
use mckibben_scenario::{PressurePlace, PressureSensor, PressureSeries};

/// How the path of a number of a sensor begins in [fit].
const COLUMNS: &str = "columns.";
/// Part of the longest run that a shift or a lag is at most, unless the study says more.
const LATEST: f64 = 0.25;
/// Readings over the quantity, unless the study says more.
const SCALES: [f64; 2] = [0.1, 10.0];

/// A number of a sensor that is looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct OfSensor {
    /// The column, by its place in the study.
    pub(super) column: usize,
    /// Which of [`AMOUNTS`].
    pub(super) amount: usize,
}

/// The number of a sensor that a path of [fit] names, if it names one.
pub(super) fn named(material: &Material, entry: &FitEntry) -> Result<Option<OfSensor>, Failure> {
    let Some(path) = entry.path.strip_prefix(COLUMNS) else { return Ok(None) };
    let columns = &material.study.columns;
    let found = path.rsplit_once('.').and_then(|(column, amount)| {
        let amount = AMOUNTS.iter().position(|known| *known == amount)?;
        Some((columns.iter().position(|entry| key(entry) == column), amount))
    });
    match found {
        Some((Some(column), amount)) => Ok(Some(OfSensor { column, amount })),
        Some((None, _)) => {
            let known: Vec<String> = columns.iter().filter(|entry| entry.quantity != Quantity::Time).map(key).collect();
            Err(Failure::input(
                format!("`{}` in [fit] names no column of the study", entry.path),
                format!("name one of {}", known.join(", ")),
            ))
        }
        None => Err(Failure::input(
            format!("`{}` in [fit] names no number of a sensor", entry.path),
            format!("end it with one of {}", AMOUNTS.join(", ")),
        )),
    }
}

/// A column as [columns] names it.
fn key(entry: &ColumnEntry) -> String {
    match &entry.part {
        Some(part) => format!("{part}.{}", entry.quantity.name()),
        None => entry.quantity.name().to_owned(),
    }
}

/// The unknown of such a number, between bounds that follow from the readings where the study gives none.
pub(super) fn unknown(material: &Material, entry: &FitEntry, of: OfSensor) -> Result<Unknown, Failure> {
    let column = &material.study.columns[of.column];
    let quantity = column.quantity;
    let [least, most] = range(material, |its| its.quantity == quantity && its.part == column.part);
    let [_, last] = range(material, |its| its.quantity == Quantity::Time);
    let span = if most > least { most - least } else { 1.0 };
    let last = if last > 0.0 { last } else { 1.0 };
    let (unit, range) = match of.amount {
        0 => (quantity.unit(), [-span, span]),
        1 => (quantity.rate_unit(), [-span / last, span / last]),
        2 => ("", SCALES),
        3 => ("s", [-LATEST * last, LATEST * last]),
        _ => ("s", [0.0, LATEST * last]),
    };
    let first = match known(column, of.amount) {
        // A lag begins where readings show it.
        0.0 if of.amount == 4 => 1e-3 * last,
        number => number,
    };
    let mut unknown = read(&material.study, entry, (unit, [f64::NEG_INFINITY, f64::INFINITY]), first)?;
    for (bound, own) in unknown.bounds.iter_mut().zip(range) {
        if bound.is_infinite() {
            *bound = own;
        }
    }
    check_order(entry, unit, unknown.bounds)?;
    if entry.start.is_some() {
        check_start(entry, unit, unknown.start, unknown.bounds)?;
    }
    unknown.start = unknown.start.clamp(unknown.bounds[0], unknown.bounds[1]);
    Ok(unknown)
}

/// The least and the largest reading of columns in all runs.
fn range(material: &Material, is_of: impl Fn(&Column) -> bool) -> [f64; 2] {
    let columns = material.recordings.iter().flat_map(|recording| &recording.sheets).flat_map(|sheet| &sheet.columns);
    let readings = columns.filter(|its| is_of(its)).flat_map(|its| its.values.iter().copied());
    let readings = readings.filter(|reading| reading.is_finite());
    readings.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], of| [least.min(of), most.max(of)])
}

/// What a study says of a number of a sensor.
fn known(column: &ColumnEntry, amount: usize) -> f64 {
    let sensor = &column.sensor;
    [0.0, sensor.drift, 1.0, sensor.shift, sensor.lag][amount]
}

/// The value that a column states of a number of its sensor, where it states one.
pub(super) fn stated(material: &Material, of: OfSensor) -> Option<f64> {
    let value = known(&material.study.columns[of.column], of.amount);
    let of_exact_sensor = if AMOUNTS[of.amount] == "scale" { 1.0 } else { 0.0 };
    (value != of_exact_sensor).then_some(value)
}

/// The section of a scenario that a column gives the pressure of, where it drives the run of one actuator or a joint.
pub(super) fn of_driving(material: &Material, of: OfSensor) -> Option<&'static str> {
    let columns = &material.study.columns;
    let in_hose = |entry: &ColumnEntry| matches!(entry.quantity, Quantity::HosePressure | Quantity::HoseGaugePressure);
    let column = &columns[of.column];
    if material.study.input != Input::GaugePressure || column.part.is_some() {
        return None;
    }
    match column.quantity {
        // Where it was measured in the hose too, that drives the run.
        Quantity::GaugePressure | Quantity::AbsolutePressure => (!columns.iter().any(in_hose)).then_some("pressure"),
        Quantity::HosePressure | Quantity::HoseGaugePressure => Some("pressure"),
        Quantity::AntagonistGaugePressure | Quantity::AntagonistAbsolutePressure => Some("antagonist.pressure"),
        _ => None,
    }
}

/// The key in the section of a given pressure that a number of the sensor is which recorded it.
pub(super) fn key_of_given(material: &Material, of: OfSensor, section: &str) -> Result<String, Failure> {
    let (column, amount) = (&material.study.columns[of.column], AMOUNTS[of.amount]);
    let title = |why: &str| format!("`{COLUMNS}{}.{amount}` in [fit]: {why}", key(column));
    match amount {
        "offset" | "shift" => Ok(format!("{section}.{amount}")),
        "scale" if !is_absolute(column.quantity) => Ok(format!("{section}.{amount}")),
        "scale" => Err(Failure::input(
            title("an absolute pressure that drives the run has an offset and a shift to estimate, and no scale"),
            "estimate its offset, or give gauge pressures",
        )),
        _ => Err(Failure::input(
            title("a pressure that drives the run has an offset, a scale and a shift to estimate"),
            "say what is known of its drift in the column, and filter readings that lag before",
        )),
    }
}

fn is_absolute(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::AbsolutePressure | Quantity::AntagonistAbsolutePressure | Quantity::HosePressure)
}

/// A pressure that drives a run, as its column recorded it: times in s and gauge pressures in Pa.
///
/// # Errors
/// [`Failure::input`] for a sensor that lags or holds.
pub(super) fn recorded(
    material: &Material,
    (quantity, part): (Quantity, Option<&str>),
    at: PressurePlace,
    [time, mut gauge_pressure]: [Vec<f64>; 2],
) -> Result<PressureSeries, Failure> {
    let is_it = |entry: &&ColumnEntry| entry.quantity == quantity && entry.part.as_deref() == part;
    let mut sensor = PressureSensor::default();
    if let Some(column) = material.study.columns.iter().find(is_it) {
        let SensorEntry { drift, shift, lag, hold } = column.sensor;
        if lag > 0.0 || hold.is_some() {
            let title = format!("`{COLUMNS}{}` drives the run, and its sensor lags or holds", key(column));
            return Err(Failure::input(
                title,
                "leave out `lag` and `hold`, and state a `shift` of half the hold and all of the lag",
            ));
        }
        sensor.shift = shift;
        for (reading, time) in gauge_pressure.iter_mut().zip(&time) {
            *reading -= drift * time;
        }
    }
    Ok(PressureSeries { at, time, gauge_pressure, sensor })
}

/// The sensor of a column whose zero of the quantity is at `base` on the sensor, with the numbers that are looked for.
pub(super) fn sensor(
    material: &Material,
    (quantity, part): (Quantity, Option<&str>),
    base: f64,
    unknowns: &[(OfSensor, usize)],
) -> Sensor {
    let mut sensor = Sensor { base, ..Sensor::default() };
    let columns = &material.study.columns;
    let is_it = |entry: &ColumnEntry| entry.quantity == quantity && entry.part.as_deref() == part;
    let Some(place) = columns.iter().position(is_it) else { return sensor };
    sensor.hold = columns[place].sensor.hold;
    for (amount, into) in sensor.amounts_mut().into_iter().enumerate() {
        *into = Amount::Known(known(&columns[place], amount));
        if let Some((_, unknown)) = unknowns.iter().find(|(of, _)| of.column == place && of.amount == amount) {
            *into = Amount::Unknown(*unknown);
        }
    }
    sensor
}
