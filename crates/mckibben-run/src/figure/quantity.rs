//! What a column of a run is of: its quantity, its part and its place, read from the column's name; and how a quantity is
//! shown.
//!
//! A name is `PART.PLACE_QUANTITY_UNIT` of a plant, `antagonist_PLACE_QUANTITY_UNIT` of a joint's second actuator and
//! `PLACE_QUANTITY_UNIT` else: `flexor.hose_gauge_pressure_pa` is the gauge pressure in the hose of the flexor.
//!
//! The tolerance of a quantity is the least difference that a figure shows: what varies by less is constant. It is the larger of
//! [`RELATIVE`] times the largest magnitude and a floor, which lies above the error of a run at its usual accuracy and below what
//! a sensor of the field resolves.

use crate::record::Filled;
use crate::units::{Shown, stem, units};

/// The part of a magnitude below which a difference is not shown.
pub(crate) const RELATIVE: f64 = 1e-6;

/// A quantity that a column may be of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Known {
    /// Its words with `_` in place of spaces, as in names of columns.
    pub(crate) name: &'static str,
    /// Its SI unit.
    pub(crate) unit: &'static str,
    /// The least difference that is shown, in that unit.
    pub(crate) floor: f64,
}

const fn known(name: &'static str, unit: &'static str, floor: f64) -> Known {
    Known { name, unit, floor }
}

/// The quantities, those that move first: panels stand in this order.
pub(crate) const KNOWN: [Known; 20] = [
    known("angle", "rad", 1e-6),
    known("position", "m", 1e-6),
    known("length", "m", 1e-6),
    known("load_distance", "m", 1e-6),
    known("angular_velocity", "rad/s", 1e-5),
    known("velocity", "m/s", 1e-5),
    known("load_velocity", "m/s", 1e-5),
    known("stiffness", "N*m/rad", 1e-4),
    known("gauge_pressure", "Pa", 10.0),
    known("absolute_pressure", "Pa", 10.0),
    known("air_mass", "kg", 1e-10),
    known("temperature", "K", 1e-3),
    known("volume", "m^3", 1e-12),
    known("mass_flow", "kg/s", 1e-9),
    known("tension", "N", 1e-3),
    known("force", "N", 1e-3),
    known("torque", "N*m", 1e-5),
    known("contraction", "", 1e-6),
    known("opening", "", 1e-6),
    known("power", "W", 1e-5),
];

/// What the set point of a controller is of, by its unit.
const CONTROLLED: [(&str, &str); 7] = [
    ("Pa", "gauge_pressure"),
    ("m", "length"),
    ("kg", "air_mass"),
    ("N", "tension"),
    ("rad", "angle"),
    ("N*m", "torque"),
    ("N*m/rad", "stiffness"),
];

/// The places of columns that say where a controller was to be and what it saw.
pub(crate) const SET_POINT: &str = "set point";
pub(crate) const MEASURED: &str = "measured";

/// What a column is of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Of {
    /// The part, such as `flexor`; empty for the only actuator and for the joint of two.
    pub(crate) part: String,
    /// Where in it, such as `hose`; empty for the part itself.
    pub(crate) place: String,
    /// The words of the quantity, such as `gauge pressure`.
    pub(crate) quantity: String,
    /// Its SI unit.
    pub(crate) unit: String,
    /// The least difference that is shown, in that unit.
    pub(crate) floor: f64,
}

impl Of {
    /// Reads the name of a column. `first` is the part that names without a prefix belong to, where they are of an actuator.
    pub(crate) fn column(column: &Filled, first: &str) -> Self {
        let unit = column.unit.replace("m3", "m^3");
        let (part, rest) = match column.name.rsplit_once('.') {
            Some((part, rest)) => (part.to_owned(), rest),
            None => match column.name.strip_prefix("antagonist_") {
                Some(rest) => ("antagonist".to_owned(), rest),
                None => (first.to_owned(), column.name.as_str()),
            },
        };
        let name = stem(rest, &unit);
        let controlled = CONTROLLED.iter().find(|(of, _)| *of == unit).map_or("", |(_, name)| *name);
        let (place, quantity) = match name {
            "set_point" => (SET_POINT, controlled),
            "measured" => (MEASURED, controlled),
            name => {
                // `load_distance` is a separate quantity, so the longest name decides.
                let fits =
                    KNOWN.iter().filter(|known| name == known.name || name.ends_with(&format!("_{}", known.name)));
                let quantity = fits.map(|known| known.name).max_by_key(|known| known.len()).unwrap_or(name);
                (name.strip_suffix(quantity).unwrap_or("").trim_end_matches('_'), quantity)
            }
        };
        // The joint of two actuators has no name.
        let is_joints = ["angle", "angular_velocity", "torque", "stiffness"].contains(&quantity);
        let part = if is_joints && !column.name.contains('.') { String::new() } else { part };
        let floor = KNOWN.iter().find(|known| known.name == quantity).map_or(0.0, |known| known.floor);
        let words = |name: &str| name.replace('_', " ");
        Self { part, place: words(place), quantity: words(quantity), unit, floor }
    }

    /// Where its panel stands among others.
    pub(crate) fn rank(&self) -> usize {
        KNOWN.iter().position(|known| known.name.replace('_', " ") == self.quantity).unwrap_or(KNOWN.len())
    }
}

/// The least difference that is shown of a quantity whose largest magnitude is given, in its unit.
pub(crate) fn tolerance(floor: f64, largest: f64) -> f64 {
    floor.max(RELATIVE * largest)
}

/// The unit that values are shown in, where the largest magnitude is given in SI.
pub(crate) fn shown(unit: &str, largest: f64) -> Shown {
    units().shown(unit, largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Values;

    fn of(name: &str, unit: &str) -> [String; 3] {
        let column = Filled { name: name.to_owned(), unit: unit.to_owned(), values: Values::Numbers(Vec::new()) };
        let of = Of::column(&column, "agonist");
        [of.part, of.place, of.quantity]
    }

    #[test]
    fn names_of_columns_say_of_what_they_are() {
        let cases = [
            ("gauge_pressure_pa", "Pa", ["agonist", "", "gauge pressure"]),
            ("hose_gauge_pressure_pa", "Pa", ["agonist", "hose", "gauge pressure"]),
            ("antagonist_supply_absolute_pressure_pa", "Pa", ["antagonist", "supply", "absolute pressure"]),
            ("flexor.hose_gauge_pressure_pa", "Pa", ["flexor", "hose", "gauge pressure"]),
            ("tank.reservoir.gauge_pressure_pa", "Pa", ["tank.reservoir", "", "gauge pressure"]),
            ("load_distance_m", "m", ["agonist", "", "load distance"]),
            ("volume_m3", "m^3", ["agonist", "", "volume"]),
            ("flexor.volume_m3", "m3", ["flexor", "", "volume"]),
            ("set_point_pa", "Pa", ["agonist", "set point", "gauge pressure"]),
            ("antagonist_set_point_kg", "kg", ["antagonist", "set point", "air mass"]),
            ("measured_n_m_rad", "N*m/rad", ["", "measured", "stiffness"]),
            ("set_point_rad", "rad", ["", "set point", "angle"]),
            ("knee.angular_velocity_rad_s", "rad/s", ["knee", "", "angular velocity"]),
            ("mass_flow_kg_s", "kg/s", ["agonist", "", "mass flow"]),
        ];
        for (name, unit, expected) in cases {
            assert_eq!(of(name, unit), expected.map(str::to_owned), "{name}");
        }
    }

    #[test]
    fn every_quantity_has_a_floor_and_a_unit_to_be_shown_in() {
        for Known { name, unit, floor } in KNOWN {
            assert!(floor > 0.0, "{name}");
            let shown = shown(unit, 1.0);
            assert!(shown.factor > 0.0 && !shown.text.contains(['*', '^']), "{name}: {}", shown.text);
        }
        assert!((tolerance(1e-6, 100.0) / 1e-4 - 1.0).abs() < 1e-12);
        assert_eq!(tolerance(1e-6, 1e-3), 1e-6);
    }
}
