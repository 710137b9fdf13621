//! A list of gauge pressures: `35,45,55psi`, `2 bar, 400 kPa`.

use crate::failure::Failure;
use crate::quantities;
use mckibben_scenario::quantity;
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
#[derive(Clone, Debug, PartialEq)]
pub struct Pressures(Vec<Pressure>);

impl FromStr for Pressures {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut pressures = Vec::new();
        let mut unit = "";
        // From the right, because a number without a unit has that of the next.
        for item in text.rsplit(',').map(str::trim) {
            let (number, own) =
                split(item).ok_or_else(|| format!("`{item}` is not a number with a unit of pressure"))?;
            unit = if own.is_empty() { unit } else { own };
            let label = format!("{number} {unit}");
            let read = quantity::parse(&label).map_err(|error| error.message)?;
            let pascal = quantity::parse_unit("Pa").map_err(|error| error.message)?.0;
            if read.dimension != pascal {
                return Err(format!(
                    "`{item}` is no pressure; write a unit such as psi, bar or kPa behind the last number"
                ));
            }
            pressures.push(Pressure { gauge: read.value, label });
        }
        pressures.reverse();
        Ok(Self(pressures))
    }
}

/// The number at the beginning of a text and what follows it.
fn split(item: &str) -> Option<(&str, &str)> {
    let mut ends = item.char_indices().map(|(at, c)| at + c.len_utf8());
    let end = ends.rfind(|end| item[..*end].trim_end().parse::<f64>().is_ok_and(f64::is_finite))?;
    Some((item[..end].trim_end(), item[end..].trim_start()))
}

impl Pressures {
    /// Gauge pressures in Pa.
    pub fn of_pascals(numbers: &[f64]) -> Self {
        Self(numbers.iter().map(|gauge| Pressure { gauge: *gauge, label: quantities::given(*gauge, "Pa") }).collect())
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
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
    fn what_is_no_pressure_is_refused() {
        for text in ["", "35", "35,psi", "35 mm", "35 psi,", "nan psi", "35 quux"] {
            assert!(text.parse::<Pressures>().is_err(), "{text}");
        }
        assert!("-15 psi".parse::<Pressures>().unwrap().above_vacuum(101_325.0).is_err());
    }
}
