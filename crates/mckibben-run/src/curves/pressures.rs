//! A list of gauge pressures: `35,45,55psi`, `2 bar, 400 kPa`.

use crate::failure::Failure;
use crate::quantities;
use crate::units::units;
use mckibben_scenario::Scenario;
use std::str::FromStr;

/// One gauge pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct Pressure {
    /// Gauge pressure in Pa.
    pub gauge: f64,
    /// As it was given, with its unit.
    pub label: String,
}

/// Several gauge pressures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pressures(Vec<Pressure>);

impl FromStr for Pressures {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let read = quantities::read_list(text, ["pressure", "Pa", "psi, bar or kPa"], None)?;
        Ok(Self(read.into_iter().map(|(gauge, label)| Pressure { gauge, label }).collect()))
    }
}

/// Gauge pressures in psi of the paper's Fig. 3.
const OF_THE_PAPER: [f64; 7] = [35.0, 45.0, 55.0, 65.0, 75.0, 85.0, 95.0];
/// A pound-force per square inch in Pa.
const PSI: f64 = 6_894.757_293_168_361;
/// Pressures of a scenario at least.
const LEAST: f64 = 4.0;

impl Pressures {
    /// Round pressures up to the greatest that a scenario has: that of its supply, else of its given pressure, else that of its
    /// start. A scenario without any has those of the paper's Fig. 3.
    pub fn of_scenario(scenario: &Scenario) -> Self {
        let supply = scenario.supply.as_ref().map(|supply| supply.gauge_pressure);
        let given = || Some(scenario.pressure.as_ref()?.values().fold(f64::NEG_INFINITY, f64::max));
        let greatest = supply.or_else(given).unwrap_or(scenario.first_gauge_pressure());
        if !(greatest.is_finite() && greatest >= 1.0) {
            return Self::of_pascals(&OF_THE_PAPER.map(|psi| psi * PSI));
        }
        let shown = units().shown("Pa", greatest);
        let most = shown.number(greatest);
        // The largest of 1, 2 or 5 times a power of ten that divides the range into enough steps.
        let ten = 10f64.powf((most / LEAST).log10().floor());
        let step = [5.0, 2.0, 1.0].map(|factor| factor * ten).into_iter().find(|step| step * LEAST <= most);
        let step = step.unwrap_or(ten);
        let count = (most / step * (1.0 + 1e-9)).floor();
        let mut numbers: Vec<f64> = (1..=count as u32).map(|k| step * f64::from(k)).collect();
        // The greatest has a separate curve unless the last is nearly there.
        if most - step * count > 0.1 * step {
            numbers.push(most);
        }
        let pressure = |number: f64| Pressure {
            gauge: number / shown.factor,
            label: shown.with(quantities::plain(&quantities::digits(number))),
        };
        Self(numbers.into_iter().map(pressure).collect())
    }

    /// Gauge pressures in Pa.
    pub fn of_pascals(numbers: &[f64]) -> Self {
        Self(numbers.iter().map(|gauge| Pressure { gauge: *gauge, label: quantities::given(*gauge, "Pa") }).collect())
    }

    /// The pressures, when all of them are above vacuum in this atmosphere, in Pa.
    ///
    /// # Errors
    /// [`Failure::input`] for one that is not.
    pub fn above_vacuum(&self, atmosphere: f64) -> Result<&[Pressure], Failure> {
        match self.0.iter().find(|pressure| pressure.gauge <= -atmosphere) {
            Some(pressure) => Err(Failure::input(
                format!("a gauge pressure of {} is below vacuum", pressure.label),
                format!("give pressures above {} Pa", -atmosphere),
            )),
            None => Ok(&self.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_holds_for_the_numbers_before_it() {
        let read: Pressures = "35, 45psi,2 bar ,1e5Pa".parse().unwrap();
        let labels: Vec<&str> = read.0.iter().map(|pressure| pressure.label.as_str()).collect();
        assert_eq!(labels, ["35 psi", "45 psi", "2 bar", "1e5 Pa"]);
        assert!((read.0[0].gauge - 241_316.505).abs() < 0.01 && read.0[2].gauge == 2e5 && read.0[3].gauge == 1e5);
    }

    #[test]
    fn a_scenario_has_round_pressures_up_to_its_own() {
        let of = |gauge: &str| {
            let text = format!(
                "[load]\nkind = \"isometric\"\n[initial]\nlength = \"85 mm\"\ngauge_pressure = \"{gauge}\"\n[run]\nduration = \"1 s\""
            );
            let scenario = mckibben_scenario::Document::parse(&text, "muscle.toml").unwrap().scenario().unwrap();
            let labels = Pressures::of_scenario(&scenario).0.into_iter().map(|pressure| pressure.label);
            labels.collect::<Vec<_>>().join(", ")
        };
        assert_eq!(of("6 bar"), "1 bar, 2 bar, 3 bar, 4 bar, 5 bar, 6 bar");
        assert_eq!(of("100 psi"), "1 bar, 2 bar, 3 bar, 4 bar, 5 bar, 6 bar, 6.895 bar");
        assert_eq!(of("0.5 bar"), "0.1 bar, 0.2 bar, 0.3 bar, 0.4 bar, 0.5 bar");
        assert_eq!(of("0 bar").split(", ").count(), 7);
    }

    #[test]
    fn what_is_no_pressure_is_refused() {
        for text in ["", "35", "35,psi", "35 mm", "35 psi,", "nan psi", "35 quux"] {
            assert!(text.parse::<Pressures>().is_err(), "{text}");
        }
        assert!("-15 psi".parse::<Pressures>().unwrap().above_vacuum(101_325.0).is_err());
    }
}
