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

/// Standard deviation of the noise: how far each sample lies from the parabola through three neighbours, by the median, so
/// that a kink or an outlier does not count. Of normal and independent noise; zero for fewer than four samples.
pub(crate) fn noise(time: &[f64], value: &[f64]) -> f64 {
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
    /// Of a degree, about a time; `None` when the samples do not tell it.
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

    /// Standard deviation of a function of the coefficients with this gradient, over that of a sample.
    pub(crate) fn deviation(&self, gradient: &[f64]) -> f64 {
        let part = |i: usize, j: usize| gradient[i] * self.covariance[(i, j)] * gradient[j];
        let all = (0..gradient.len()).flat_map(|i| (0..gradient.len()).map(move |j| (i, j)));
        all.map(|(i, j)| part(i, j)).sum::<f64>().max(0.0).sqrt()
    }
}
