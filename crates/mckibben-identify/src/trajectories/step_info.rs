//! Characteristics of a step-like run: overshoot, first peak, frequency and settling, each of the readings and of the
//! model.
//!
//! ```text
//! stroke     Y = y₁ − y₀        y₀: the median of the first readings, y₁: that of the last tenth
//! overshoot  (y_p − y₁)/Y       y_p: the first extreme beyond y₁, by a parabola about it
//! frequency  (n − 1)/(2 (t_n − t_1))       t_1 … t_n: where the time series passes y₁ for good, by straight lines
//! settling   the last time at which |y − y₁| > 0.05 |Y|
//! ```
//!
//! A run is step-like where its time series comes to rest: where the last tenth stays within 3 % of the stroke, and the
//! stroke is many times the noise. A time series passes y₁ for good where it goes on to leave a band about it, of three
//! deviations of the noise or a hundredth of the stroke, so that noise about the end is no oscillation.
//!
//! Checked by `tests/step_info.rs`: the closed form of a damped oscillation, and of one that is damped beyond it.

use crate::series::{self, Polynomial};

/// Of the stroke: how far the end of a step-like run may move.
const AT_REST: f64 = 0.03;
/// The least stroke, in standard deviations of the noise.
const STROKE: f64 = 20.0;
/// Of the stroke: the band in which a time series has settled.
const SETTLED: f64 = 0.05;
/// The band about the end that an oscillation leaves: in standard deviations of the noise, and in parts of the stroke.
const BAND: [f64; 2] = [3.0, 0.01];
/// Readings that determine the first level at most: a step may begin with the first of them.
const FIRST: usize = 3;
/// Readings that a step-like run has at least.
const LEAST: usize = 20;

/// A time series that goes from one level to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInfo {
    /// From the first level to the last, in the SI unit of the time series.
    pub stroke: f64,
    /// How far the first extreme lies beyond the last level, in parts of the stroke; zero where none does.
    pub overshoot: f64,
    /// When that extreme is, in s.
    pub first_peak: Option<f64>,
    /// The frequency of the oscillation about the last level in Hz, where it passes that three times.
    pub frequency: Option<f64>,
    /// When the time series last leaves the band of 5 % of the stroke about its last level, in s.
    pub settling: f64,
}

impl StepInfo {
    /// Of readings, where they are step-like.
    pub fn of_readings(times: &[f64], values: &[f64]) -> Option<Self> {
        series::check(times, values, "the value", LEAST).ok()?;
        let noise = series::noise(times, values);
        let (levels, last) = levels(values)?;
        let stroke = levels[1] - levels[0];
        let spread = last.iter().fold(0.0_f64, |spread, value| spread.max((value - levels[1]).abs()));
        let at_rest = spread <= AT_REST * stroke.abs() + BAND[0] * noise;
        (stroke.abs() > STROKE * noise && stroke != 0.0 && at_rest).then(|| Self::between(times, values, levels, noise))
    }

    /// Of a model at the times of readings that are step-like, by the same rules.
    pub fn of_model(times: &[f64], values: &[f64]) -> Option<Self> {
        series::check(times, values, "the value", LEAST).ok()?;
        let (levels, _) = levels(values)?;
        (levels[1] != levels[0]).then(|| Self::between(times, values, levels, 0.0))
    }

    fn between(times: &[f64], values: &[f64], [first, last]: [f64; 2], noise: f64) -> Self {
        let stroke = last - first;
        let band = (BAND[0] * noise).max(BAND[1] * stroke.abs());
        let passes = passes(times, values, last, band);
        let peak = passes.first().and_then(|from| {
            let to = passes.get(1).copied().unwrap_or(f64::INFINITY);
            peak(times, values, last, [*from, to])
        });
        let frequency = match passes.as_slice() {
            [begin, .., end] if passes.len() > 2 => Some((passes.len() - 1) as f64 / (2.0 * (end - begin))),
            _ => None,
        };
        let outside = |value: &f64| (value - last).abs() > SETTLED * stroke.abs();
        let settling = values.iter().rposition(outside).map_or(times[0], |place| times[place]);
        Self {
            stroke,
            overshoot: peak.map_or(0.0, |[_, value]| ((value - last) / stroke).max(0.0)),
            first_peak: peak.map(|[time, _]| time),
            frequency,
            settling,
        }
    }
}

/// The first and the last level of a time series, and its last tenth.
fn levels(values: &[f64]) -> Option<([f64; 2], &[f64])> {
    let last = values.get(values.len() - values.len() / 10..).filter(|last| !last.is_empty())?;
    let first = values.get(..(values.len() / 100).clamp(1, FIRST))?;
    Some(([median(first), median(last)], last))
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    0.5 * (sorted[sorted.len() / 2] + sorted[(sorted.len() - 1) / 2])
}

/// When a time series passes a level for good: from beyond the band on one side to beyond the band on the other.
fn passes(times: &[f64], values: &[f64], level: f64, band: f64) -> Vec<f64> {
    let mut passes = Vec::new();
    // The side that the time series has last been on, and the last time that it has left the level on it.
    let mut side = 0.0;
    let mut crossed = None;
    for place in 0..values.len() {
        let off = values[place] - level;
        if place > 0 && (values[place - 1] - level) * side > 0.0 && off * side <= 0.0 {
            let before = values[place - 1] - level;
            crossed = Some(times[place - 1] + (times[place] - times[place - 1]) * before / (before - off));
        }
        if off.abs() > band {
            if off * side < 0.0 {
                passes.extend(crossed.take());
            }
            side = off.signum();
        }
    }
    passes
}

/// Time and value of the extreme between two times, farthest from a level, by a parabola about it.
fn peak(times: &[f64], values: &[f64], level: f64, [from, to]: [f64; 2]) -> Option<[f64; 2]> {
    let within = series::between(times, from, to);
    let farthest = |a: &usize, b: &usize| (values[*a] - level).abs().total_cmp(&(values[*b] - level).abs());
    let place = within.clone().max_by(farthest)?;
    let rough = [times[place], values[place]];
    // A twelfth of a period to either side, where a sine is a parabola to a hundredth of its size.
    let reach = if to.is_finite() { (to - from) / 6.0 } else { 0.5 * (times[place] - from) };
    let about = series::between(times, times[place] - reach, times[place] + reach);
    let fitted = Polynomial::fit(&times[about.clone()], &values[about], times[place], 2);
    let refined = fitted.map(|of| {
        let [c, b, a] = [of.coefficients[0], of.coefficients[1], of.coefficients[2]];
        let shift = -b / (2.0 * a);
        [times[place] + shift, c - b * b / (4.0 * a), shift]
    });
    match refined {
        Some([time, value, shift]) if shift.abs() <= reach && value.is_finite() => Some([time, value]),
        _ => Some(rough),
    }
}
