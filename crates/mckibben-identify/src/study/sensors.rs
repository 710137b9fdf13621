//! What a study says of the sensors behind its columns.

use super::file::Within;
use super::{Quantity, StudyError};
use mckibben_scenario::quantity;
use toml::Spanned;

/// What is known of the sensor of a column. Offset and scale that are known are taken off the readings before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorEntry {
    /// What the readings grow by in a second, in the unit of the quantity per second.
    pub drift: f64,
    /// By how much readings come late, in s.
    pub shift: f64,
    /// Time constant in s of a lag of first order.
    pub lag: f64,
    /// Interval in s at which it takes samples and holds them.
    pub hold: Option<f64>,
}

/// The keys of a column that speak of its sensor.
pub(super) struct RawSensor {
    pub(super) drift: Option<Spanned<String>>,
    pub(super) shift: Option<Spanned<String>>,
    pub(super) lag: Option<Spanned<String>>,
    pub(super) hold: Option<Spanned<String>>,
}

impl Quantity {
    /// SI unit of what it changes by in a second.
    pub fn rate_unit(self) -> &'static str {
        match self.unit() {
            "m" => "m/s",
            "m/s" => "m/s^2",
            "Pa" => "Pa/s",
            "N" => "N/s",
            "N*m" => "N*m/s",
            "rad" => "rad/s",
            "rad/s" => "rad/s^2",
            "K" => "K/s",
            "m^3" => "m^3/s",
            "kg" => "kg/s",
            "kg/s" => "kg/s^2",
            "s" => "",
            _ => "s^-1",
        }
    }
}

impl RawSensor {
    pub(super) fn read(&self, within: &Within<'_>, of: Quantity) -> Result<SensorEntry, StudyError> {
        let time = |text: &Option<Spanned<String>>| match text {
            Some(text) => within.si(text, Quantity::Time).map(Some),
            None => Ok(None),
        };
        let above = |name: &str, text: &Option<Spanned<String>>, least: f64| match (text, time(text)?) {
            (Some(text), Some(number)) if number < least => {
                let what = format!("`{name}` of a sensor is below zero, or zero where it means nothing");
                Err(within.fault(Some(text.span().start), what, "give a time such as \"5 ms\", or leave it out"))
            }
            (_, number) => Ok(number),
        };
        let drift = match &self.drift {
            Some(text) => rate(within, text, of)?,
            None => 0.0,
        };
        Ok(SensorEntry {
            drift,
            shift: time(&self.shift)?.unwrap_or(0.0),
            lag: above("lag", &self.lag, 0.0)?.unwrap_or(0.0),
            hold: above("hold", &self.hold, f64::MIN_POSITIVE)?,
        })
    }
}

/// What a quantity changes by in a second, in SI.
fn rate(within: &Within<'_>, text: &Spanned<String>, of: Quantity) -> Result<f64, StudyError> {
    if let Some(number) = within.in_si(text.as_ref()) {
        return Ok(number);
    }
    let such = || format!("write it as in \"1 {}\"", of.rate_unit());
    let fault = |what: String, remedy: String| within.fault(Some(text.span().start), what, remedy);
    let read = quantity::parse(text.as_ref())
        .map_err(|error| fault(error.message.clone(), error.help.clone().unwrap_or_else(such)))?;
    match quantity::parse_unit(of.rate_unit()) {
        Ok((dimension, _)) if dimension == read.dimension => Ok(read.value),
        _ => Err(fault(format!("\"{}\" is no {} per second", text.as_ref(), of.words()), such())),
    }
}

#[cfg(test)]
mod tests {
    use super::{Quantity, quantity};

    #[test]
    fn a_rate_has_the_unit_of_its_quantity_over_time() {
        // Air that is counted in litres of another state has no trajectory.
        for of in Quantity::ALL.into_iter().filter(|of| *of != Quantity::VolumeFlow) {
            let parsed = |text: &str| quantity::parse(text).unwrap_or_else(|error| panic!("{of:?}: {}", error.message));
            let rate = parsed(&format!("1 {}", of.rate_unit()));
            let over_time = parsed(&match of.unit() {
                "" => "1 s^-1".to_owned(),
                "s" => "1".to_owned(),
                unit => format!("1 {unit}/s"),
            });
            assert_eq!((rate.dimension, rate.value), (over_time.dimension, over_time.value), "{of:?}");
        }
    }
}
