//! A bound on a number of a run: `length.final<=80 mm`.

use super::vary::{UnitScale, number_and_unit};
use mckibben_scenario::Dimension;
use std::fmt;
use std::str::FromStr;

/// On which side of its bound a number must stay.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Relation {
    /// At or below it.
    AtMost,
    /// At or above it.
    AtLeast,
}

impl Relation {
    /// As it is written: `<=` or `>=`.
    pub fn sign(self) -> &'static str {
        match self {
            Self::AtMost => "<=",
            Self::AtLeast => ">=",
        }
    }
}

/// A bound on a number of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Name of the number, such as `length.final` or `settled.length.ripple`.
    pub name: String,
    /// On which side of the bound it must stay.
    pub relation: Relation,
    /// The bound in the unit.
    pub bound: f64,
    /// The unit as it was written; empty for a pure number.
    pub unit: String,
    /// The dimension of the unit.
    pub(super) dimension: Dimension,
    scale: UnitScale,
}

impl Constraint {
    /// The bound in SI.
    pub(super) fn bound_in_si(&self) -> f64 {
        self.scale.to_si(self.bound)
    }

    /// By how much a value in SI breaks the bound, in SI; at or below zero where it does not.
    pub(super) fn excess(&self, value: f64) -> f64 {
        match self.relation {
            Relation::AtMost => value - self.bound_in_si(),
            Relation::AtLeast => self.bound_in_si() - value,
        }
    }

    /// A value in SI in the unit of the bound.
    pub fn in_unit(&self, value: f64) -> f64 {
        self.scale.number(value)
    }

    /// The unit of differences from the bound: its own, and K where that has an offset zero as °C has.
    pub fn unit_of_margin(&self) -> &str {
        self.scale.unit_of_differences(&self.unit)
    }

    /// How far a value in SI is from the bound, in [`Constraint::unit_of_margin`]; below zero where the bound is broken.
    pub fn margin(&self, value: f64) -> f64 {
        // A difference of zero has no sign.
        self.scale.difference(-self.excess(value)) + 0.0
    }

    /// The bound with its unit.
    pub fn limit(&self) -> String {
        if self.unit.is_empty() { format!("{}", self.bound) } else { format!("{} {}", self.bound, self.unit) }
    }
}

impl FromStr for Constraint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const WRITE: &str = "write NAME<=VALUE UNIT or NAME>=VALUE UNIT, as in 'length.final<=80 mm'";
        let relations = [Relation::AtMost, Relation::AtLeast];
        let found = relations.into_iter().find_map(|relation| Some((text.split_once(relation.sign())?, relation)));
        let ((name, limit), relation) = found.ok_or(WRITE)?;
        if name.trim().is_empty() {
            return Err(format!("a name must stand before the {}: {WRITE}", relation.sign()));
        }
        let read = number_and_unit(limit);
        let (bound, unit) = read.ok_or_else(|| format!("`{}` begins with no number: {WRITE}", limit.trim()))?;
        let (scale, dimension) = UnitScale::of(unit)?;
        Ok(Self { name: name.trim().to_owned(), relation, bound, unit: unit.to_owned(), dimension, scale })
    }
}

impl fmt::Display for Constraint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}{}", self.name, self.relation.sign(), self.limit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_are_in_the_unit_and_below_zero_outside() {
        let least: Constraint = "tension.max >= 100 N".parse().unwrap();
        let most: Constraint = "length.final<=80 mm".parse().unwrap();
        assert_eq!((most.to_string(), least.to_string()), ("length.final<=80 mm".into(), "tension.max>=100 N".into()));
        assert!((most.margin(0.079) - 1.0).abs() < 1e-12 && (most.margin(0.082) + 2.0).abs() < 1e-12);
        assert_eq!([least.margin(101.0), least.margin(98.0), least.excess(98.0)], [1.0, -2.0, 2.0]);
        assert!((most.in_unit(0.079) - 79.0).abs() < 1e-12);
        let warm: Constraint = "temperature.max<=40 degC".parse().unwrap();
        assert!((warm.margin(303.15) - 10.0).abs() < 1e-9 && (warm.in_unit(303.15) - 30.0).abs() < 1e-9);
        let hot: Constraint = "temperature.max<=100 degF".parse().unwrap();
        assert_eq!([warm, hot, most].each_ref().map(Constraint::unit_of_margin), ["K", "degR", "mm"]);
        assert_eq!("exergy.efficiency>=0.2".parse::<Constraint>().unwrap().limit(), "0.2");
    }

    #[test]
    fn what_is_no_constraint_is_refused_with_the_remedy() {
        for (text, words) in [
            ("length.final=80 mm", "NAME<=VALUE UNIT"),
            ("<=80 mm", "a name must stand before"),
            ("length.final<=short", "`short` begins with no number"),
            ("length.final<=80 mmm", "mmm"),
        ] {
            let found = text.parse::<Constraint>().expect_err(text);
            assert!(found.contains(words), "{text}: {found}");
        }
    }
}
