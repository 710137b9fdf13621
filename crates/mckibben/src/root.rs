//! A bracketed root, by interpolation that can never be slower than bisection by more than a factor.
//!
//! The ITP method (Oliveira & Takahashi 2020): a secant step, truncated towards the middle and projected onto the
//! interval that bisection would still allow. Used for equilibria and for the instants of events.

/// A point between `low` and `high` at which `function` changes sign, to `tolerance` in the argument.
///
/// `function(low)` and `function(high)` must differ in sign or be zero; the end with the smaller value is returned
/// otherwise. The result is the end of the last bracket on the side of `high`, so that the sign there is `high`'s.
pub(crate) fn bracketed(mut low: f64, mut high: f64, tolerance: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    let (mut at_low, mut at_high) = (function(low), function(high));
    if at_high == 0.0 {
        return high;
    }
    if at_low == 0.0 {
        return low;
    }
    if (at_low > 0.0) == (at_high > 0.0) {
        return if at_low.abs() < at_high.abs() { low } else { high };
    }
    let truncation = 0.2 / (high - low);
    let mut allowed = high - low;
    while high - low > 2.0 * tolerance {
        let middle = 0.5 * (low + high);
        let half = 0.5 * (high - low);
        let secant = (at_high * low - at_low * high) / (at_high - at_low);
        let towards_middle = if secant < middle { 1.0 } else { -1.0 };
        let cut = truncation * (high - low) * (high - low);
        let truncated = if cut <= (middle - secant).abs() { secant + towards_middle * cut } else { middle };
        let radius = (allowed - half).max(0.0);
        let next = if (truncated - middle).abs() <= radius { truncated } else { middle - towards_middle * radius };
        // Rounding may put the proposal on an end: the middle still divides the bracket, until nothing lies between.
        let next = if low < next && next < high { next } else { middle };
        if !(low < next && next < high) {
            break;
        }
        let value = function(next);
        if (value > 0.0) == (at_high > 0.0) && value != 0.0 {
            (high, at_high) = (next, value);
        } else if value == 0.0 {
            return next;
        } else {
            (low, at_low) = (next, value);
        }
        allowed *= 0.5;
        allowed = allowed.max(tolerance);
    }
    high
}

#[cfg(test)]
mod tests {
    use super::bracketed;

    #[test]
    fn finds_roots_of_easy_and_awkward_functions() {
        type Case = (fn(f64) -> f64, f64, f64, f64);
        let cases: [Case; 4] = [
            (|x| x * x - 2.0, 0.0, 2.0, 2.0_f64.sqrt()),
            (|x| x.powi(9) - 1e-9, 0.0, 1.0, 0.1),
            (|x| if x < 0.3 { -1.0 } else { 1.0 }, 0.0, 1.0, 0.3),
            (|x| 5.0 - x, 0.0, 5.0, 5.0),
        ];
        for (function, low, high, exact) in cases {
            let root = bracketed(low, high, 1e-14, function);
            assert!((root - exact).abs() < 1e-12, "{root} is not {exact}");
        }
    }

    #[test]
    fn needs_few_more_evaluations_than_bisection_at_worst() {
        let mut count = 0;
        bracketed(0.0, 1.0, 1e-12, |x| {
            count += 1;
            if x < 0.123456 { -1e-9 } else { 1e9 }
        });
        assert!(count < 60, "{count} evaluations");
    }
}
