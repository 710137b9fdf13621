//! Measurements compared with what the fitted model predicts for them.

/// The readings of one quantity in one run, with the predictions of the fitted model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prediction {
    /// The name of the run; empty where the readings of all runs are taken together.
    pub run: String,
    /// What was measured, in words: of pulse trains the delays, each from an edge of the coil to the onset that followed.
    pub quantity: String,
    /// The SI unit of the readings; empty for a pure number.
    pub unit: &'static str,
    /// At what each reading was taken, such as `time_s`, `length_m` or `pressure_ratio`: names with their units, and a number for
    /// each reading.
    pub coordinates: Vec<(&'static str, Vec<f64>)>,
    /// The readings.
    pub measured: Vec<f64>,
    /// The predictions. A residual is the prediction less the reading.
    pub predicted: Vec<f64>,
}

impl Prediction {
    /// The predictions less the readings.
    pub fn residuals(&self) -> impl Iterator<Item = f64> + '_ {
        self.predicted.iter().zip(&self.measured).map(|(predicted, measured)| predicted - measured)
    }
}
