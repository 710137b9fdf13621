//! A recorded ring-down, and what makes it useless.

use super::RingDownError;
use crate::series;

/// Fewer samples than this show no two cycles.
const LEAST_SAMPLES: usize = 20;
/// Samples of one value at the end of the range that may be a sensor's.
const PLATEAU: usize = 3;

/// Length over time of a mass that rings down.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    time: Vec<f64>,
    length: Vec<f64>,
}

impl Record {
    /// Samples of the `length` in m at each `time` in s, at any rate. What comes before the release may be there.
    ///
    /// # Errors
    /// [`RingDownError::Series`] for fewer than twenty samples, a number that is not finite, or times out of order.
    pub fn new(time: Vec<f64>, length: Vec<f64>) -> Result<Self, RingDownError> {
        series::check(&time, &length, "the length", LEAST_SAMPLES)?;
        Ok(Self { time, length })
    }

    /// Times in s.
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// Lengths in m.
    pub fn length(&self) -> &[f64] {
        &self.length
    }

    /// Standard deviation of the noise in m, from how far samples lie off parabolas through their neighbours.
    pub fn noise(&self) -> f64 {
        series::noise(&self.time, &self.length)
    }

    /// The least and the largest length in m.
    pub(super) fn range(&self) -> [f64; 2] {
        let fold = |end: f64, pick: fn(f64, f64) -> f64| self.length.iter().copied().fold(end, pick);
        [fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Checks that no peak is cut off. A peak stays at its outermost value for no longer than a parabola of its
    /// curvature stays within the sensor's resolution; a sensor at the end of its range does.
    pub(super) fn check_saturation(&self, period: f64) -> Result<(), RingDownError> {
        let [least, largest] = self.range();
        let amplitude = 0.5 * (largest - least);
        let mut sorted = self.length.clone();
        sorted.sort_by(f64::total_cmp);
        let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
        let resolution = steps.fold(f64::INFINITY, f64::min);
        for limit in [least, largest] {
            let mut first = 0;
            while first < self.length.len() {
                let run = self.length[first..].iter().take_while(|length| **length == limit).count();
                let (last, inside) = (first + run.max(1) - 1, first > 0 && first + run < self.length.len());
                let angle = std::f64::consts::PI / period * (self.time[last] - self.time[first]);
                if run >= PLATEAU && inside && 0.5 * amplitude * angle * angle > 3.0 * resolution {
                    return Err(RingDownError::Saturated { limit, samples: run, time: self.time[first] });
                }
                first = last + 1;
            }
        }
        Ok(())
    }
}
