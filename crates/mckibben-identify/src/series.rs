//! Samples of one quantity over time: what they must be, how noisy they are, and a polynomial through a few of them.

use crate::median::deviation;
use nalgebra::{DMatrix, DVector};
use thiserror::Error;

/// Why samples over time are no series.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SeriesError {
    /// Not as many values as times.
    #[error("there are {times} times and {values} values; give one value for each time")]
    Lengths {
        /// How many times there are.
        times: usize,
        /// How many values.
        values: usize,
    },
    /// A number that is none.
    #[error("{what} of sample {sample} is not a finite number; leave that sample out")]
    NotFinite {
        /// What it is: the time, or the quantity.
        what: &'static str,
        /// Which sample, counted from 1.
        sample: usize,
    },
    /// A time that is not later than the one before.
    #[error("sample {sample} at {time} s is not later than the one before; sort the samples and leave out duplicates")]
    NotLater {
        /// Which sample, counted from 1.
        sample: usize,
        /// Its time in s.
        time: f64,
    },
    /// Fewer samples than it takes.
    #[error("there are {samples} samples; it takes at least {least}: record longer or sample faster")]
    TooFew {
        /// How many there are.
        samples: usize,
        /// The least number that will do.
        least: usize,
    },
}

/// Checks that there are `least` samples or more, finite and in order of time.
pub(crate) fn check(time: &[f64], value: &[f64], what: &'static str, least: usize) -> Result<(), SeriesError> {
    if time.len() != value.len() {
        return Err(SeriesError::Lengths { times: time.len(), values: value.len() });
    }
    if time.len() < least {
        return Err(SeriesError::TooFew { samples: time.len(), least });
    }
    for (what, numbers) in [("the time", time), (what, value)] {
        if let Some(place) = numbers.iter().position(|number| !number.is_finite()) {
            return Err(SeriesError::NotFinite { what, sample: place + 1 });
        }
    }
    match time.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(place) => Err(SeriesError::NotLater { sample: place + 2, time: time[place + 1] }),
        None => Ok(()),
    }
}

/// Part of the samples that repeat the one before from which on a sensor is taken to hold them.
const HELD: f64 = 1.0 / 3.0;
/// Differences of samples that it takes to see the steps of a sensor, the part of them that must be whole steps, and by what part of
/// a step each may miss.
const WHOLE_STEPS: (usize, f64, f64) = (8, 0.9, 0.1);
/// Steps of a sensor within the range of its samples at most: more are no wider than rounding.
const MOST_STEPS: f64 = 1e4;

/// Standard errors of their correlation above which one residual depends on the next.
const CORRELATED: f64 = 3.0;
/// Residuals over the noise of readings above which they are no noise.
pub(crate) const BEYOND_NOISE: f64 = 3.0;

/// Whether residuals in the order of time are those of independent readings with outliers: most are no larger than noise makes them, and
/// none says anything of the next. Intervals hold with these as they do with normal noise.
pub(crate) fn are_outliers(residuals: &[f64], noise: f64) -> bool {
    let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
    let products: f64 = residuals.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let is_white = products.abs() <= CORRELATED * squares / (residuals.len() as f64).sqrt();
    is_white && deviation(residuals.iter().copied()) <= BEYOND_NOISE * noise
}

/// Pooled noise of several time series, where so much is left of them that it is no noise: the model lacks something, or a search has
/// ended away from the best values.
pub(crate) fn beyond_noise<'s>(left: f64, series: impl Iterator<Item = (&'s [f64], &'s [f64])>) -> Option<f64> {
    let noise = pooled_noise(series);
    (left > BEYOND_NOISE * noise).then_some(noise)
}

/// Root mean square of the noise of the readings of several time series.
pub(crate) fn pooled_noise<'s>(series: impl Iterator<Item = (&'s [f64], &'s [f64])>) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for (times, values) in series {
        let readings = times.len() as f64;
        squares += readings * noise(times, values).powi(2);
        count += readings;
    }
    (squares / count).sqrt()
}

/// Standard deviation of the noise of a sample, at least that of the sensor's steps, `q/√12`. Samples that a sensor holds count once:
/// their repetitions know nothing of its noise.
pub(crate) fn noise(time: &[f64], value: &[f64]) -> f64 {
    visible_noise(time, value).max(resolution(value) / 12.0_f64.sqrt())
}

/// Standard deviation of the noise that readings show. At rest, and at a constant speed, a sensor whose steps are larger than its noise shows
/// none.
pub(crate) fn visible_noise(time: &[f64], value: &[f64]) -> f64 {
    let is_new = |place: &usize| *place == 0 || value[*place] != value[*place - 1];
    let new: Vec<usize> = (0..value.len()).filter(is_new).collect();
    let repeated = (value.len() - new.len()) as f64;
    if repeated > HELD * value.len() as f64 {
        let of = |numbers: &[f64]| -> Vec<f64> { new.iter().map(|place| numbers[*place]).collect() };
        scatter(&of(time), &of(value))
    } else {
        scatter(time, value)
    }
}

/// The step of a sensor whose samples differ by whole steps; zero where they do not.
pub(crate) fn resolution(value: &[f64]) -> f64 {
    let differences = value.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|difference| *difference > 0.0);
    let differences: Vec<f64> = differences.collect();
    let (least, part, miss) = WHOLE_STEPS;
    let step = differences.iter().copied().fold(f64::INFINITY, f64::min);
    let range =
        value.iter().copied().fold(f64::NEG_INFINITY, f64::max) - value.iter().copied().fold(f64::INFINITY, f64::min);
    if differences.len() < least || range > MOST_STEPS * step {
        return 0.0;
    }
    let is_whole = |difference: &&f64| (**difference / step - (**difference / step).round()).abs() < miss;
    let whole = differences.iter().filter(is_whole).count() as f64;
    if whole >= part * differences.len() as f64 { step } else { 0.0 }
}

/// How far each sample lies from the parabola through three neighbours, by the median, so that a kink or an outlier does not count: the
/// standard deviation of normal and independent noise; zero for fewer than four samples.
fn scatter(time: &[f64], value: &[f64]) -> f64 {
    let distances = time.windows(4).zip(value.windows(4)).map(|(t, x)| {
        let others = [0, 2, 3];
        let weight = |of: usize| {
            others.iter().filter(|other| **other != of).map(|other| (t[1] - t[*other]) / (t[of] - t[*other])).product()
        };
        let weights: [f64; 3] = others.map(weight);
        let parabola: f64 = weights.iter().zip(others).map(|(weight, of)| weight * x[of]).sum();
        let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
        (x[1] - parabola) / (1.0 + squares).sqrt()
    });
    deviation(distances)
}

/// The samples from one time to another, ends included.
pub(crate) fn between(time: &[f64], from: f64, to: f64) -> std::ops::Range<usize> {
    let first = time.partition_point(|t| *t < from);
    first..time.partition_point(|t| *t <= to).max(first)
}

/// A polynomial through samples by least squares.
#[derive(Clone, Debug)]
pub(crate) struct Polynomial {
    /// In rising powers of the time from where it is about, in s.
    pub(crate) coefficients: Vec<f64>,
    /// Their covariance over the variance of a sample.
    covariance: DMatrix<f64>,
    /// Sum of squares of the residuals.
    pub(crate) squares: f64,
    /// Samples less coefficients.
    pub(crate) degrees_of_freedom: usize,
}

impl Polynomial {
    /// Of a degree, about a time; `None` when the samples do not determine it.
    pub(crate) fn fit(time: &[f64], value: &[f64], about: f64, degree: usize) -> Option<Self> {
        let (count, terms) = (time.len(), degree + 1);
        if count < terms {
            return None;
        }
        let reach = time.iter().map(|t| (t - about).abs()).fold(0.0, f64::max);
        let mean = value.iter().sum::<f64>() / count as f64;
        let design = DMatrix::from_fn(count, terms, |row, term| ((time[row] - about) / reach).powi(term as i32));
        let values = DVector::from_iterator(count, value.iter().map(|x| x - mean));
        let inverse = (design.transpose() * &design).cholesky()?.inverse();
        let solution = &inverse * (design.transpose() * &values);
        let squares = (values - design * &solution).norm_squared();
        let size = |term: usize| reach.powi(-(term as i32));
        let mut coefficients: Vec<f64> = (0..terms).map(|term| solution[term] * size(term)).collect();
        coefficients[0] += mean;
        let covariance = DMatrix::from_fn(terms, terms, |i, j| inverse[(i, j)] * size(i) * size(j));
        let finite = squares.is_finite() && coefficients.iter().all(|number| number.is_finite());
        finite.then_some(Self { coefficients, covariance, squares, degrees_of_freedom: count - terms })
    }

    /// Standard error of a function of the coefficients with this gradient, relative to the standard deviation of a sample.
    pub(crate) fn standard_error(&self, gradient: &[f64]) -> f64 {
        let part = |i: usize, j: usize| gradient[i] * self.covariance[(i, j)] * gradient[j];
        let all = (0..gradient.len()).flat_map(|i| (0..gradient.len()).map(move |j| (i, j)));
        all.map(|(i, j)| part(i, j)).sum::<f64>().max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::noise;

    /// Noise of standard deviation 1 that is equal in every run: a sum of twelve uniform numbers less six.
    fn normal(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    fn times(count: usize) -> Vec<f64> {
        (0..count).map(|place| 1e-3 * place as f64).collect()
    }

    #[test]
    fn noise_of_every_sample_is_estimated_about_a_smooth_series() {
        let time = times(4000);
        let value: Vec<f64> =
            normal(3, 4000).iter().zip(&time).map(|(noise, t)| (9.0 * t).sin() + 1e-3 * noise).collect();
        assert!((noise(&time, &value) / 1e-3 - 1.0).abs() < 0.06, "{}", noise(&time, &value));
    }

    #[test]
    fn the_steps_of_a_sensor_are_noise() {
        // Steps of 70 µm on a time series that moves by many of them, without other noise: q/√12.
        let (time, step) = (times(2000), 70e-6);
        let value: Vec<f64> = time.iter().map(|t| step * ((3e-3 * (7.0 * t).sin()) / step).round()).collect();
        assert!((noise(&time, &value) / (step / 12.0_f64.sqrt()) - 1.0).abs() < 0.3, "{}", noise(&time, &value));
        // At rest no noise is visible at all, and there is some.
        let still: Vec<f64> =
            time.iter().map(|t| if ((t * 50.0) as u32).is_multiple_of(2) { 0.0 } else { step }).collect();
        assert!(noise(&time, &still) >= 0.99 * step / 12.0_f64.sqrt());
    }

    #[test]
    fn held_samples_count_once() {
        let time = times(6000);
        let noises = normal(5, 600);
        let held = |place: usize| (2.0 * time[place / 10 * 10]).sin() + 1e-3 * noises[place / 10];
        let value: Vec<f64> = (0..6000).map(held).collect();
        assert!((noise(&time, &value) / 1e-3 - 1.0).abs() < 0.12, "{}", noise(&time, &value));
    }
}
