//! Noise that looks random and is the same in every run, and what coverage it may show.

use mckibben_identify::least_squares::Estimate;

/// Trials of an interval.
pub(crate) const TRIALS: u64 = 200;
/// How many of them hold the truth: binomial with 0.95, 190 with a standard deviation of 3.08, by 2.5 of these to either side, which
/// chance leaves once in seventy.
pub(crate) const HITS: std::ops::RangeInclusive<u32> = 183..=197;

/// A source of numbers.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        let mut noise = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x2545_f491_4f6c_dd1d);
        for _ in 0..8 {
            noise.uniform();
        }
        noise
    }

    /// Between 0 and 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (self.0 ^ (self.0 >> 31)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((mixed >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Of mean 0 and standard deviation 1.
    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    pub(crate) fn added_to(&mut self, values: &[f64], deviation: f64) -> Vec<f64> {
        values.iter().map(|value| value + deviation * self.normal()).collect()
    }
}

/// Whether the interval of an estimate holds a value.
pub(crate) fn holds(estimate: &Estimate, truth: f64) -> bool {
    estimate.confidence_interval.is_some_and(|[low, high]| low <= truth && truth <= high)
}

/// How many of the trials hold each truth, on two threads.
pub(crate) fn coverage<const N: usize>(trial: impl Fn(u64) -> [bool; N] + Sync) -> [u32; N] {
    let half = |from: u64| {
        let mut hits = [0; N];
        for seed in (from..TRIALS).step_by(2) {
            for (hits, hit) in hits.iter_mut().zip(trial(seed)) {
                *hits += u32::from(hit);
            }
        }
        hits
    };
    std::thread::scope(|scope| {
        let other = scope.spawn(|| half(1));
        let mine = half(0);
        let other = other.join().expect("a trial panicked");
        std::array::from_fn(|place| mine[place] + other[place])
    })
}
