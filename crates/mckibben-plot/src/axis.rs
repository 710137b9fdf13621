//! Axes: what is measured along them, their limits, and their scale.
//!
//! The unit of an axis stands apart from its label, so that ticks can choose an SI prefix for it. Values are given in
//! their own unit whatever the scale: no caller takes a logarithm before drawing.

use super::PlotError;

/// How distances along an axis grow with the value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences are equally long.
    #[default]
    Linear,
    /// Equal ratios are equally long. Only positive values have a place: zero and negative values are gaps, as values
    /// that are not finite are on every axis. Spans that begin at zero or below begin at the edge of the axes.
    Logarithmic,
}

impl Scale {
    /// A value on the scale: itself, or its decimal logarithm. Zero and negative values lie below every logarithm.
    pub(super) fn coordinate(self, value: f64) -> f64 {
        match self {
            Scale::Linear => value,
            Scale::Logarithmic if value <= 0.0 => f64::NEG_INFINITY,
            Scale::Logarithmic => value.log10(),
        }
    }

    /// The value at a coordinate.
    pub(super) fn value(self, coordinate: f64) -> f64 {
        match self {
            Scale::Linear => coordinate,
            Scale::Logarithmic => 10_f64.powf(coordinate),
        }
    }

    /// Whether a value has a place on the scale.
    pub(super) fn admits(self, value: f64) -> bool {
        self.coordinate(value).is_finite()
    }
}

/// An axis: its words, its scale, and its range where the data should not decide.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// The quantity, such as `length`.
    pub label: String,
    /// The unit of the values as given, such as `mm`. Empty for none.
    pub unit: String,
    /// The scale, linear by default.
    pub scale: Scale,
    /// The lower end, where the data should not decide. Positive on a logarithmic axis.
    pub min: Option<f64>,
    /// The upper end, where the data should not decide. Positive on a logarithmic axis.
    pub max: Option<f64>,
    /// Words in place of numbers: `[(0.0, "closed"), (1.0, "open")]`.
    pub words: Vec<(f64, String)>,
}

impl Axis {
    /// A linear axis whose range the data decide.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), ..Self::default() }
    }

    /// A logarithmic axis whose range the positive data decide.
    pub fn logarithmic(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::new(label, unit) }
    }

    /// Returns the axis with a lower end.
    #[must_use]
    pub fn starting_at(mut self, min: f64) -> Self {
        self.min = Some(min);
        self
    }

    /// Returns the axis with an upper end.
    #[must_use]
    pub fn ending_at(mut self, max: f64) -> Self {
        self.max = Some(max);
        self
    }

    /// Returns the axis with words in place of numbers.
    #[must_use]
    pub fn words<S: Into<String>>(mut self, words: impl IntoIterator<Item = (f64, S)>) -> Self {
        self.words = words.into_iter().map(|(at, word)| (at, word.into())).collect();
        self
    }

    pub(super) fn validate(&self) -> Result<(), PlotError> {
        let (min, max) = (self.min.unwrap_or(f64::MIN), self.max.unwrap_or(f64::MAX));
        if !(min.is_finite() && max.is_finite() && min < max) {
            return Err(PlotError::Range { axis: self.label.clone(), min, max });
        }
        match [self.min, self.max].into_iter().flatten().find(|end| !self.scale.admits(*end)) {
            Some(end) => Err(PlotError::Logarithm { axis: self.label.clone(), end }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_positive_finite_values_have_a_place_on_a_logarithmic_scale() {
        for value in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!Scale::Logarithmic.admits(value), "{value}");
            assert_eq!(Scale::Linear.admits(value), value.is_finite());
        }
        assert!(Scale::Logarithmic.admits(5e-324) && Scale::Logarithmic.admits(f64::MAX));
    }

    #[test]
    fn ends_that_have_no_logarithm_are_refused() {
        let refused = |axis: Axis| axis.validate().unwrap_err().to_string();
        let message = refused(Axis::logarithmic("gain", "").starting_at(0.0));
        assert_eq!(message, r#"the logarithmic axis "gain" has an end at 0; give a positive one"#);
        assert!(refused(Axis::logarithmic("gain", "").starting_at(-2.0).ending_at(-1.0)).contains("-2"));
        assert!(matches!(Axis::new("gain", "").starting_at(0.0).validate(), Ok(())));
    }
}
