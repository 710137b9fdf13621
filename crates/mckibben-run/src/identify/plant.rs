//! The runs of trajectories of a plant: its file with what a run changes, and columns behind the names of parts.

use super::sensors::{self, OfSensor};
use super::trajectories::held_at_its_end;
use super::unknowns::{self, OfRun, Stands};
use super::{Material, without_times};
use crate::failure::Failure;
use mckibben::network::NodeKind;
use mckibben_identify::least_squares::Unknown;
use mckibben_identify::study::{Column, Input, Quantity, Recording, Sheet};
use mckibben_identify::trajectories::{AdjustablePlant, Observed, Recorded, Subject, TimeSeries};
use mckibben_scenario::{Document, PlantExperiment, PlantQuantity, PressurePlace, PressureSeries};

/// The runs, and the numbers that are looked for in them.
pub(super) fn runs(material: &Material, warnings: &mut Vec<String>) -> Result<(Vec<Recorded>, Vec<Unknown>), Failure> {
    let mut plants = Vec::new();
    for recording in &material.recordings {
        let mut document = material.document_of(recording)?;
        let mut experiment = read(&document)?;
        if material.study.input == Input::GaugePressure {
            give_pressures(&mut document, &experiment, (material, recording), warnings)?;
            experiment = read(&document)?;
        }
        plants.push((document, experiment));
    }
    let (unknowns, numbers) = unknowns::of_runs((material, warnings), |run, entry, sensor| {
        let (document, experiment) = &plants[run];
        let path = match sensor {
            None => entry.path.clone(),
            Some(of) => match driven_by(material, of, experiment) {
                None => return Ok(Stands::Sensor(of)),
                Some(actuator) => {
                    let section = format!("actuators.{actuator}.pressure");
                    sensors::key_of_given(material, of, &section)?
                }
            },
        };
        let found = document.find_in_plant(&path);
        let place = found.map_err(|error| unknowns::misplaced(&error, Some(&material.recordings[run].name)))?;
        let (row, value) = (place.parameter(), place.value());
        Ok(Stands::Scenario((place, row, value)))
    })?;
    let mut runs = Vec::new();
    for ((recording, (document, experiment)), OfRun { places, unknowns, sensors }) in
        material.recordings.iter().zip(plants).zip(numbers)
    {
        let time_series = time_series(material, (recording, &sensors), &experiment)?;
        let subject = Subject::Plant(AdjustablePlant { document, places });
        runs.push(Recorded { name: recording.name.clone(), subject, unknowns, time_series });
    }
    Ok((runs, unknowns))
}

/// The actuator that a pressure drives, if it is one that is given.
fn driven(of: &PlantExperiment, quantity: PlantQuantity) -> Option<usize> {
    match quantity {
        PlantQuantity::Pressure(actuator) => of.plant.actuators()[actuator].pressure.is_some().then_some(actuator),
        PlantQuantity::NodePressure(node) | PlantQuantity::NodeGaugePressure(node) => {
            let is_given = matches!(of.plant.network().nodes[node].kind, NodeKind::Given { .. });
            of.names.hoses.iter().position(|hose| *hose == Some(node)).filter(|_| is_given)
        }
        _ => None,
    }
}

/// The name of the actuator that the column of a sensor drives, if it drives one.
fn driven_by<'e>(material: &Material, of: OfSensor, experiment: &'e PlantExperiment) -> Option<&'e str> {
    let column = &material.study.columns[of.column];
    match Observed::of_part(experiment, column.part.as_deref()?, column.quantity)? {
        Observed::Column(found) => {
            driven(experiment, found.quantity).map(|actuator| experiment.names.actuators[actuator].as_str())
        }
        _ => None,
    }
}

/// The plant of a file.
fn read(document: &Document) -> Result<PlantExperiment, Failure> {
    document
        .plant_experiment()?
        .ok_or_else(|| Failure::input("the scenario names no actuators", "add `[actuators.NAME]`"))
}

/// The time series of a run; a pressure that is given is none.
fn time_series(
    material: &Material,
    (recording, sensors): (&Recording, &[(OfSensor, usize)]),
    of: &PlantExperiment,
) -> Result<Vec<TimeSeries>, Failure> {
    let of_no_part = |column: &&Column| column.part.is_none() && column.quantity != Quantity::Time;
    if let Some(column) = recording.sheets.iter().flat_map(|sheet| &sheet.columns).find(of_no_part) {
        let title = format!("the run `{}` has a column of no part of the plant: {}", recording.name, column.words());
        let having = parts(of).into_iter().find(|part| Observed::of_part(of, part, column.quantity).is_some());
        let help = match having {
            Some(part) => format!("name the part: `[columns.\"{part}.{}\"]`", column.quantity.name()),
            None => "name a part and what was measured of it, as in `[columns.\"flexor.length\"]`".to_owned(),
        };
        return Err(Failure::input(title, help));
    }
    let columns = of.columns();
    let mut series = Vec::new();
    for (sheet, column) in recording.of_parts() {
        let (observed, quantity) = observed(of, column)?;
        let place = columns.iter().position(|column| column.quantity() == Some(quantity));
        if driven(of, quantity).is_none() {
            let (times, values) = over_time(recording, sheet, column)?;
            let sensor = sensors::sensor(material, (column.quantity, column.part.as_deref()), 0.0, sensors);
            let read = TimeSeries { observed, times, values, deviation: column.deviation, sensor };
            series.push((place, read.without_repetitions()));
        }
    }
    // In the order of a run's table: by the parts, as the file has them.
    series.sort_by_key(|(place, _)| *place);
    Ok(series.into_iter().map(|(_, series)| series).collect())
}

/// What a column is of the plant.
fn observed(of: &PlantExperiment, column: &Column) -> Result<(Observed, PlantQuantity), Failure> {
    let part = column.part.as_deref().unwrap_or_default();
    match Observed::of_part(of, part, column.quantity) {
        Some(Observed::Column(found)) => {
            let quantity = found.quantity;
            Ok((Observed::Column(found), quantity))
        }
        _ => {
            let has = |quantity: &Quantity| Observed::of_part(of, part, *quantity).is_some();
            let known: Vec<&str> = Quantity::OF_PARTS.iter().filter(|of| has(of)).map(|of| of.name()).collect();
            Err(match known.is_empty() {
                true => {
                    let title = format!("the plant has no `{part}`, of which there is a column");
                    Failure::input(title, format!("its parts with columns are {}", parts(of).join(", ")))
                }
                false => {
                    let title = format!("`{part}` of the plant has no `{}`", column.quantity.name());
                    Failure::input(title, format!("it has {}", known.join(", ")))
                }
            })
        }
    }
}

/// The names of the parts that have columns.
fn parts(of: &PlantExperiment) -> Vec<String> {
    let columns = of.columns().into_iter().filter(|column| column.quantity().is_some());
    let mut parts: Vec<String> =
        columns.filter_map(|column| Some(column.name.rsplit_once('.')?.0.to_owned())).collect();
    parts.dedup();
    parts
}

/// Times and values of a column.
fn over_time(recording: &Recording, sheet: &Sheet, column: &Column) -> Result<(Vec<f64>, Vec<f64>), Failure> {
    sheet.channel(column).ok_or_else(|| without_times(recording, &column.words()))
}

/// Drives each actuator whose pressure was measured by that in place of what the file says; the others go on as it says.
fn give_pressures(
    document: &mut Document,
    of: &PlantExperiment,
    (material, recording): (&Material, &Recording),
    warnings: &mut Vec<String>,
) -> Result<(), Failure> {
    let atmosphere = of.plant.network().atmosphere;
    // Of actuators, in the muscle and at the end of its hose.
    let [mut in_muscle, mut in_hose]: [Vec<(usize, PressureSeries)>; 2] = [Vec::new(), Vec::new()];
    let mut until: f64 = 0.0;
    for (sheet, column) in recording.of_parts() {
        let (time, mut values) = over_time(recording, sheet, column)?;
        match observed(of, column)?.1 {
            PlantQuantity::Pressure(actuator) => {
                if column.quantity == Quantity::AbsolutePressure {
                    values.iter_mut().for_each(|pressure| *pressure -= atmosphere);
                }
                let its = (column.quantity, column.part.as_deref());
                in_muscle.push((actuator, sensors::recorded(material, its, PressurePlace::Muscle, [time, values])?));
            }
            PlantQuantity::NodePressure(node) | PlantQuantity::NodeGaugePressure(node)
                if let Some(actuator) = of.names.hoses.iter().position(|hose| *hose == Some(node)) =>
            {
                if column.quantity == Quantity::HosePressure {
                    values.iter_mut().for_each(|pressure| *pressure -= atmosphere);
                }
                let its = (column.quantity, column.part.as_deref());
                in_hose.push((actuator, sensors::recorded(material, its, PressurePlace::Hose, [time, values])?));
            }
            _ => until = until.max(time.last().copied().unwrap_or(0.0)),
        }
    }
    if in_muscle.is_empty() && in_hose.is_empty() {
        let title = format!("the run `{}` has no pressure of an actuator", recording.name);
        let part = of.names.actuators.first().map_or("flexor", String::as_str);
        return Err(Failure::input(title, format!("add `[columns.\"{part}.gauge_pressure\"]`")));
    }
    for (actuator, name) in of.names.actuators.iter().enumerate() {
        let of_it = |readings: &[(usize, PressureSeries)]| {
            readings.iter().find(|(its, _)| *its == actuator).map(|(_, series)| series.clone())
        };
        // At the end of its hose it drives the muscle, which starts at what was read in it first.
        let (series, first) = match (of_it(&in_hose), of_it(&in_muscle)) {
            (Some(in_hose), in_muscle) => (in_hose, in_muscle.map(|series| series.start())),
            (None, Some(in_muscle)) => (in_muscle, None),
            (None, None) => continue,
        };
        if of.names.valves[actuator].is_some() {
            let (where_, hose) = match series.at {
                PressurePlace::Muscle => ("", ", hose"),
                PressurePlace::Hose => (" at the end of its hose", ""),
            };
            let words = format!(
                "the pressure of `{name}`{where_} is the measured one: what the scenario says of its valve{hose} and command takes no part, \
                 and no supply loses the air that it takes."
            );
            if !warnings.contains(&words) {
                warnings.push(words);
            }
        }
        held_at_its_end(recording, &format!("the pressure of `{name}`"), (&series.time, until), warnings);
        document.give_pressure(name, &series, first)?;
    }
    Ok(())
}
