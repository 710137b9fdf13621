//! Units of variables, as FMI defines them: exponents of base units, and units in which people read them.

use super::Xml;
use crate::variables::Variables;
use mckibben_run::units::chosen_scale;
use mckibben_scenario::quantity::parse_unit;

/// Names of a unit for display with the factor and the offset that give a value in it.
type Displays = &'static [(&'static str, f64, f64)];

/// The unit for display of a unit: the one that was chosen, or the usual one.
pub(super) fn display(unit: &str) -> Option<String> {
    let is_itself = chosen_scale(unit).is_some_and(|(symbol, ..)| symbol == unit);
    displays(unit).into_iter().next().filter(|_| !is_itself).map(|(name, ..)| name)
}

/// A number that differs from one of ten digits by rounding alone is that one.
fn short(number: f64) -> f64 {
    let rounded = format!("{number:.9e}").parse().unwrap_or(number);
    if (rounded - number).abs() <= 1e-12 * number.abs() { rounded } else { number }
}

/// The units for display of a unit: the one that was chosen, then the usual ones.
fn displays(unit: &str) -> Vec<(String, f64, f64)> {
    let chosen = chosen_scale(unit).map(|(symbol, factor, offset)| (symbol, short(factor), short(offset)));
    let mut all: Vec<_> = chosen.into_iter().filter(|(symbol, ..)| symbol != unit).collect();
    for (name, factor, offset) in usual(unit) {
        if !all.iter().any(|(known, ..)| known == name) {
            all.push(((*name).to_owned(), *factor, *offset));
        }
    }
    all
}

/// The usual units for display of a unit.
fn usual(unit: &str) -> Displays {
    match unit {
        "Pa" => &[("bar", 1e-5, 0.0), ("kPa", 1e-3, 0.0), ("psi", 1.0 / 6_894.757_293_168_361, 0.0)],
        "m" => &[("mm", 1e3, 0.0), ("in", 1.0 / 0.0254, 0.0)],
        "m/s" => &[("mm/s", 1e3, 0.0)],
        "m^3" => &[("mL", 1e6, 0.0), ("L", 1e3, 0.0)],
        "m^2" => &[("mm^2", 1e6, 0.0)],
        "kg" => &[("g", 1e3, 0.0)],
        "kg/s" => &[("g/s", 1e3, 0.0)],
        "s" => &[("ms", 1e3, 0.0)],
        "rad" => &[("deg", 180.0 / core::f64::consts::PI, 0.0)],
        "rad/s" => &[("deg/s", 180.0 / core::f64::consts::PI, 0.0)],
        "K" => &[("degC", 1.0, -273.15)],
        _ => &[],
    }
}

/// The exponents of m, kg, s, K and rad of a unit; none of one that is no product of them.
fn exponents(unit: &str) -> Option<[i8; 5]> {
    let (dimension, size) = parse_unit(unit).ok()?;
    (size == 1.0).then(|| dimension.exponents())
}

/// Writes the units of all variables.
pub(super) fn definitions(xml: &mut Xml, variables: &Variables) {
    let mut units: Vec<&str> = variables.all.iter().map(|its| its.unit).filter(|unit| !unit.is_empty()).collect();
    units.sort_unstable();
    units.dedup();
    xml.within("UnitDefinitions", &[], |xml| {
        for unit in units {
            xml.within("Unit", &[("name", unit)], |xml| {
                if let Some(exponents) = exponents(unit) {
                    let said: Vec<(&str, String)> = ["m", "kg", "s", "K", "rad"]
                        .into_iter()
                        .zip(exponents)
                        .filter(|(_, exponent)| *exponent != 0)
                        .map(|(base, exponent)| (base, exponent.to_string()))
                        .collect();
                    let said: Vec<(&str, &str)> = said.iter().map(|(base, number)| (*base, number.as_str())).collect();
                    xml.element("BaseUnit", &said);
                }
                for (name, factor, offset) in displays(unit) {
                    let (factor, shift) = (format!("{factor:?}"), format!("{offset:?}"));
                    let mut attributes = vec![("name", name.as_str()), ("factor", factor.as_str())];
                    if offset != 0.0 {
                        attributes.push(("offset", &shift));
                    }
                    xml.element("DisplayUnit", &attributes);
                }
            });
        }
    });
}
