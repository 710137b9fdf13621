//! Characteristics of step-like runs, measured and predicted: overshoot, first peak, frequency, settling, and the root
//! mean square error in parts of the stroke.

use crate::quantities::quantity;
use crate::report::Table;
use mckibben_identify::study::Quantity;
use mckibben_identify::trajectories::{HeldOutRun, Identified, Recorded, Simulated, StepInfo, Task, TimeSeries};

/// A step-like time series: of the readings, of the fit, and of the fit to all other runs.
#[derive(Clone, Debug, PartialEq)]
pub struct StepResponse {
    /// The run.
    pub run: String,
    /// What was read, in words.
    pub quantity: String,
    /// Its SI unit.
    pub unit: &'static str,
    /// That of the readings.
    pub measured: StepInfo,
    /// That of the fit, with its root mean square error in parts of the stroke; then that of the fit to all other runs.
    pub predicted: [Option<(StepInfo, f64)>; 2],
}

/// The step-like time series of a fit.
pub(super) fn of(task: &Task, found: &Identified, held_out: &[HeldOutRun]) -> Vec<StepResponse> {
    let (mut all, values) = (Vec::new(), found.found.fit.values());
    for (run, simulated) in task.runs.iter().zip(&found.simulated) {
        let out = held_out.iter().find(|of| of.name == run.name).map(|of| (&of.simulated, &of.values[..]));
        let predictions = [Some((simulated, &values[..])), out];
        all.extend(run.time_series.iter().filter_map(|series| compared(run, series, predictions)));
    }
    all
}

/// Step-like time series as a table; empty where there are none.
pub(super) fn table(all: &[StepResponse]) -> Table {
    if all.is_empty() {
        return Table::default();
    }
    let mut head = vec!["run", "quantity", "of the step", "measured", "predicted"];
    if all.iter().any(|of| of.predicted[1].is_some()) {
        head.push("held out");
    }
    let rows = all.iter().flat_map(rows).map(|mut row| {
        row.truncate(head.len());
        row
    });
    Table {
        caption: "Runs that come to rest, measured and predicted. Overshoot and error are in percent of the stroke; settled: from when on \
                  the quantity stays within 5 % of the stroke about its end."
            .to_owned(),
        rows: rows.collect(),
        head: head.into_iter().map(String::from).collect(),
    }
}

/// A run with values of all unknowns.
type Predicted<'a> = (&'a Simulated, &'a [f64]);

fn compared(run: &Recorded, series: &TimeSeries, predictions: [Option<Predicted<'_>>; 2]) -> Option<StepResponse> {
    let moves =
        [Quantity::Length, Quantity::Angle, Quantity::AntagonistLength, Quantity::Position, Quantity::LoadDistance];
    if !moves.contains(&series.observed.quantity()) {
        return None;
    }
    let measured = StepInfo::of_readings(&series.times, &series.values)?;
    let predicted = predictions.map(|simulated| {
        let values = run.readings(series, simulated?, &series.times);
        let squares: f64 = values.iter().zip(&series.values).map(|(a, b)| (a - b) * (a - b)).sum();
        let error = (squares / values.len() as f64).sqrt() / measured.stroke.abs();
        Some((StepInfo::of_model(&series.times, &values)?, error))
    });
    let (quantity, unit) = (series.observed.words(), series.observed.unit());
    Some(StepResponse { run: run.name.clone(), quantity, unit, measured, predicted })
}

/// A row for each property.
fn rows(of: &StepResponse) -> Vec<Vec<String>> {
    let none = || "–".to_owned();
    let percent = |part: f64| format!("{:.2} %", 100.0 * part);
    let time = |time: Option<f64>| time.map_or_else(none, |time| quantity(time, "s"));
    let frequency = |of: &StepInfo| of.frequency.map_or_else(none, |frequency| quantity(frequency, "Hz"));
    let row = |name: &str, value: &dyn Fn(&StepInfo) -> String| {
        let predicted = of.predicted.iter().map(|of| of.as_ref().map_or_else(none, |(of, _)| value(of)));
        let head = [format!("`{}`", of.run), of.quantity.clone(), name.to_owned(), value(&of.measured)];
        head.into_iter().chain(predicted).collect::<Vec<String>>()
    };
    let errors = of.predicted.iter().map(|of| of.as_ref().map_or_else(none, |(_, error)| percent(*error)));
    let error = [format!("`{}`", of.run), of.quantity.clone(), "error, root mean square".to_owned(), none()];
    vec![
        row("overshoot", &|of| percent(of.overshoot)),
        row("first peak at", &|of| time(of.first_peak)),
        row("frequency", &frequency),
        row("settled at", &|of| time(Some(of.settling))),
        error.into_iter().chain(errors).collect(),
    ]
}
