//! The sentences that describe variables: each names the quantity and the part that it is of.

use mckibben::parameter::Parameter;
use mckibben_run::host::HostPlant;
use mckibben_scenario::{PlantColumn, PlantQuantity};

/// An actuator in words; the only one of a file has no name there.
pub(super) fn actuator(name: &str) -> String {
    if name == "actuator" { "the actuator".to_owned() } else { format!("the actuator `{name}`") }
}

/// The sentence of an output.
pub(super) fn column(plant: &HostPlant, column: &PlantColumn) -> String {
    use PlantQuantity as Q;
    let named = |index: usize| actuator(&plant.actuators()[index]);
    let part = column.name.rsplit_once('.').map_or("", |(part, _)| part);
    match column.quantity() {
        Some(Q::Length(i)) => format!("Length of {}, between its attachments.", named(i)),
        Some(Q::Contraction(i)) => format!("Contraction of {}: its shortening over its greatest length.", named(i)),
        Some(Q::Velocity(i)) => format!("Velocity of {}, positive when it lengthens.", named(i)),
        Some(Q::Pressure(i)) => format!("Absolute pressure of the air in {}.", named(i)),
        Some(Q::GaugePressure(i)) => format!("Gauge pressure of the air in {}.", named(i)),
        Some(Q::AirMass(i)) => format!("Mass of the air in {}.", named(i)),
        Some(Q::Temperature(i)) => format!("Temperature of the air in {}.", named(i)),
        Some(Q::Volume(i)) => format!("Volume of the air in {}.", named(i)),
        Some(Q::Tension(i)) => format!("Tension of {}, positive when it pulls.", named(i)),
        Some(Q::MassFlow(i)) => format!("Mass flow of air into {}.", named(i)),
        Some(Q::LoadDistance(i)) => format!("Distance that {} spans with its tendon.", named(i)),
        Some(Q::LoadVelocity(i)) => format!("Rate of the distance that {} spans with its tendon.", named(i)),
        Some(Q::Position(..)) if column.unit == "rad" => format!("Angle of the joint `{part}`."),
        Some(Q::Position(..)) => format!("Position of `{part}`."),
        Some(Q::Rate(..)) if column.unit == "rad/s" => format!("Angular velocity of the joint `{part}`."),
        Some(Q::Rate(..)) => format!("Velocity of `{part}`."),
        Some(Q::Force(..)) if column.unit == "N*m" => format!("Torque of the actuators on the joint `{part}`."),
        Some(Q::Force(..)) => format!("Force of the actuators on `{part}`."),
        Some(Q::NodePressure(_) | Q::NodeGaugePressure(_) | Q::SetPoint(..)) | None => of_air(plant, &column.name),
    }
}

/// The sentence of what a name of the air network stands for, such as `flexor.hose_absolute_pressure_1`.
pub(super) fn of_air(plant: &HostPlant, name: &str) -> String {
    let (part, what) = name.rsplit_once('.').unwrap_or(("", name));
    let numbered = what.rsplit_once('_').filter(|(_, cell)| cell.parse::<u32>().is_ok());
    let (what, cell) = numbered.map_or((what, None), |(what, cell)| (what, Some(cell)));
    let place = ["hose", "regulated", "supply", "reservoir"].into_iter().find_map(|place| {
        let rest = what.strip_prefix(place)?.strip_prefix('_')?;
        Some((place, rest))
    });
    let part = match plant.actuators().iter().any(|name| name == part) {
        true => actuator(part),
        false => format!("`{part}`"),
    };
    let (what, owner) = match place {
        Some(("hose", what)) => (what, format!("the hose of {part}")),
        Some(("regulated", what)) => (what, format!("the outlet of the regulator of {part}")),
        Some((place, what)) => (what, format!("the {place} of {part}")),
        None => (what, part),
    };
    let owner = cell.map_or(owner.clone(), |cell| format!("cell {cell} of {owner}"));
    let words = match what {
        "absolute_pressure" => "Absolute pressure of the air in".to_owned(),
        "gauge_pressure" => "Gauge pressure of the air in".to_owned(),
        "mass_flow" => "Mass flow of air out of".to_owned(),
        other => format!("{} of", capital(&other.replace('_', " "))),
    };
    format!("{words} {owner}.")
}

/// The sentence of a parameter, with its range where that excludes an end, which a range of FMI cannot.
pub(super) fn parameter(of: &Parameter) -> String {
    let Parameter { unit, range, meaning, .. } = of;
    let is_open = |end: f64, is_included: bool| end.is_finite() && !is_included;
    if !is_open(range.low, range.low_included) && !is_open(range.high, range.high_included) {
        return (*meaning).to_owned();
    }
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    format!("{meaning} Must be {range}{unit}.")
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
