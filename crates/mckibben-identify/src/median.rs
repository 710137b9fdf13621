//! Robust estimates: the median, and the deviation from the median of the distances to it.

/// A standard deviation over the median distance from the middle, of normal errors: one over the median of |z|.
const OVER_MEDIAN_DISTANCE: f64 = 1.482_602_218_505_602;

/// The middle value, or the mean of the two in the middle; `None` where there are none.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (half, odd) = (sorted.len() / 2, sorted.len() % 2 == 1);
    match (sorted.is_empty(), odd) {
        (true, _) => None,
        (_, true) => Some(sorted[half]),
        (_, false) => Some(0.5 * (sorted[half - 1] + sorted[half])),
    }
}

/// Standard deviation of normal errors by the median of their sizes; zero where there are none.
pub(crate) fn deviation(errors: impl IntoIterator<Item = f64>) -> f64 {
    let sizes: Vec<f64> = errors.into_iter().map(f64::abs).collect();
    OVER_MEDIAN_DISTANCE * median(&sizes).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::{deviation, median};

    #[test]
    fn an_outlier_moves_neither() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[3.0, 1.0, 2.0, 1e9]), Some(2.5));
        // Quantiles of the standard normal distribution, and one reading far off.
        let quantiles = [-1.281_551_6, -0.524_400_5, 0.0, 0.524_400_5, 1.281_551_6, 0.841_621_2, -0.841_621_2];
        let with_outlier = quantiles.into_iter().chain([1e6]);
        assert!((deviation(with_outlier) - 1.0).abs() < 0.3);
    }
}
