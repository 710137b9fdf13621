//! Distributions by their quantiles: a number of the unit interval in, a value out.
//!
//! The normal quantile is Φ⁻¹(p) = -√2 erfc⁻¹(2p), with the inverse error function of `statrs`, which stays accurate in
//! the tails. Checked by the tests below against values of 30 digits.

use super::spacing::Ends;
use statrs::function::erf::erfc_inv;
use std::f64::consts::SQRT_2;

/// How the values of a continuous axis are spread, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Distribution {
    /// Every value between the ends equally likely, or every value of its logarithm.
    Uniform(Ends),
    /// Gaussian.
    Normal {
        /// Mean and median.
        mean: f64,
        /// Standard deviation, above zero.
        deviation: f64,
    },
    /// The logarithm is Gaussian.
    LogNormal {
        /// The value that half of the draws exceed, above zero.
        median: f64,
        /// Geometric standard deviation, above 1.
        factor: f64,
    },
}

impl Distribution {
    /// The value that a share `p` of the draws, between 0 and 1 and neither of them, falls below.
    pub(super) fn quantile(&self, p: f64) -> f64 {
        match self {
            Self::Uniform(ends) => ends.at(p),
            Self::Normal { mean, deviation } => mean + deviation * standard(p),
            Self::LogNormal { median, factor } => median * factor.powf(standard(p)),
        }
    }
}

/// The quantile of the standard normal distribution.
fn standard(p: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::Spacing;

    /// Computed with mpmath at 30 digits.
    #[test]
    fn normal_quantiles() {
        let known = [
            (0.75, 0.674_489_750_196_081_7),
            (0.975, 1.959_963_984_540_054),
            (0.001, -3.090_232_306_167_813_5),
            (0.999_999, 4.753_424_308_817_088),
            (1e-10, -6.361_340_902_404_056),
            (1e-16, -8.222_082_216_130_435),
        ];
        assert!(standard(0.5).abs() < 1e-16);
        for (p, expected) in known {
            assert!((standard(p) / expected - 1.0).abs() < 4e-15, "{p}: {} is not {expected}", standard(p));
        }
    }

    #[test]
    fn quantiles_of_each_distribution() {
        let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected}");
        // 1.959963984540054 standard deviations above the mean.
        close(Distribution::Normal { mean: 4e-3, deviation: 5e-4 }.quantile(0.975), 4.979_981_992_270_027e-3);
        let log_normal = Distribution::LogNormal { median: 3.5, factor: 1.5 };
        close(log_normal.quantile(0.5), 3.5);
        // Φ(1) and Φ(-1): one factor above and below the median.
        close(log_normal.quantile(0.841_344_746_068_542_9), 5.25);
        close(log_normal.quantile(0.158_655_253_931_457_05), 3.5 / 1.5);
        let ends = |spacing| Ends { from: 0.1, to: 10.0, spacing };
        close(Distribution::Uniform(ends(Spacing::Linear)).quantile(0.25), 2.575);
        close(Distribution::Uniform(ends(Spacing::Logarithmic)).quantile(0.5), 1.0);
        close(Distribution::Uniform(ends(Spacing::Logarithmic)).quantile(0.75), 10_f64.sqrt());
    }
}
