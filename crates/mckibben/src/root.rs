//! A bracketed root, by interpolation that can never be slower than bisection by more than a factor.
//!
//! [`bracketed`] is the ITP method (Oliveira & Takahashi 2020): a secant step, truncated towards the middle and projected onto
//! the interval that bisection would still allow. Used for equilibria and for the instants of events.
//!
//! [`Search`] is for smooth functions that cost much and may carry derivatives: it interpolates the inverse by all that is
//! known of the last few points, and bisects where that does not converge (as Brent 1973 does with three points). Each error is
//! of the order of the product of those before, so that three to five evaluations do.
//!
//! [`lowest`] finds where a function turns, which needs values alone.

#[cfg(feature = "alloc")]
use crate::scalar::Real;

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

/// How many points the inverse is interpolated by.
#[cfg(feature = "alloc")]
const POINTS: usize = 4;

/// A search between zero and one for the point at which a function that is above zero ceases to be.
#[cfg(feature = "alloc")]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search<R> {
    low: R,
    high: R,
    /// The points that are known with the function's values, the latest first.
    known: [[R; 2]; POINTS],
    count: usize,
    /// By how much the last two proposals were away from those before, the latest first.
    moves: [R; 2],
}

#[cfg(feature = "alloc")]
impl<R: Real> Search<R> {
    /// A search from a point, zero or above, to one, by the values there.
    pub(crate) fn between(low: [R; 2], at_high: R) -> Self {
        let (high, far) = ([R::one(), at_high], R::constant(2.0));
        Self { low: low[0], high: high[0], known: [high, low, low, low], count: 2, moves: [far; 2] }
    }

    /// Where to look next.
    pub(crate) fn proposal(&self) -> R {
        let (next, half) = (self.interpolated(), R::constant(0.5));
        // What is not a number lies nowhere.
        let within = self.low.lt(next) && next.lt(self.high);
        let converges = within && self.away(next).lt(half * self.moves[1]);
        if converges { next } else { half * (self.low + self.high) }
    }

    /// By how much a point is away from the one that was looked at last.
    pub(crate) fn away(&self, point: R) -> R {
        (point - self.known[0][0]).magnitude()
    }

    /// Takes up the value at a point, and whether the root has been passed there.
    pub(crate) fn learn(&mut self, [point, value]: [R; 2], is_beyond: bool) {
        self.moves = [self.away(point), self.moves[0]];
        *(if is_beyond { &mut self.high } else { &mut self.low }) = point;
        self.known.rotate_right(1);
        self.known[0] = [point, value];
        self.count = (self.count + 1).min(POINTS);
    }

    /// The argument at which the polynomial through the arguments, as a function of the values, has the value zero (Neville's
    /// scheme).
    fn interpolated(&self) -> R {
        let mut at = self.known.map(|[point, _]| point);
        for width in 1..self.count {
            for first in 0..self.count - width {
                let [value, other] = [first, first + width].map(|place| self.known[place][1]);
                at[first] = (value * at[first + 1] - other * at[first]) / (value - other);
            }
        }
        at[0]
    }
}

/// Where a function that falls and then rises is lowest between two numbers, by golden section: each of the `sections` leaves
/// 0.618 of the range. Near the place values of a smooth function differ by rounding alone, so it is found to about 1e-8 of the
/// range.
pub fn lowest([mut low, mut high]: [f64; 2], sections: u32, function: impl Fn(f64) -> f64) -> f64 {
    /// The golden ratio less one.
    const PART: f64 = 0.618_033_988_749_894_9;
    let [mut a, mut b] = [high - PART * (high - low), low + PART * (high - low)];
    let [mut at_a, mut at_b] = [function(a), function(b)];
    for _ in 0..sections {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - PART * (high - low);
            at_a = function(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + PART * (high - low);
            at_b = function(b);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::{Search, bracketed, lowest};

    #[test]
    fn the_lowest_point_of_a_parabola_and_of_a_kink() {
        assert!((lowest([-1.0, 3.0], 60, |x| (x - 0.7) * (x - 0.7)) - 0.7).abs() < 1e-7);
        assert!((lowest([-1.0, 3.0], 80, |x| (x - 0.7).abs()) - 0.7).abs() < 1e-15);
        assert!((lowest([0.0, 1.0], 80, |x| x)).abs() < 1e-15);
    }

    /// The root, and how often the function was evaluated.
    fn searched(function: fn(f64) -> f64) -> (f64, usize) {
        let mut search = Search::between([0.0, function(0.0)], function(1.0));
        for count in 1..100_usize {
            let next = search.proposal();
            let (value, moved) = (function(next), search.away(next));
            if value == 0.0 || moved < 1e-5 {
                return (next, count);
            }
            search.learn([next, value], value < 0.0);
        }
        panic!("no root was found")
    }

    #[test]
    fn a_search_needs_few_evaluations_of_what_is_smooth() {
        type Case = (fn(f64) -> f64, f64);
        let cases: [Case; 3] = [
            (|x| 0.3_f64.exp() - x.exp(), 0.3),
            (|x| (0.8 - x) * (1.0 + 0.3 * x), 0.8),
            (|x| (0.5 - x) * (1.0 + 0.1 * x * x), 0.5),
        ];
        for (function, exact) in cases {
            let (root, count) = searched(function);
            assert!((root - exact).abs() < 1e-9, "{root} is not {exact}");
            assert!(count <= 5, "{count} evaluations");
        }
    }

    #[test]
    fn a_search_finds_what_interpolation_does_not() {
        let (root, count) = searched(|x| if x < 0.3 { 1e-9 } else { -1e9 });
        assert!((root - 0.3).abs() < 1e-4 && count < 30, "{root} after {count} evaluations");
    }

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
