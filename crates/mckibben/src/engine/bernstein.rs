//! A quantity over a step as a polynomial in the Bernstein basis: where it first comes down through zero.

/// Control points of a polynomial of degree 7.
pub(crate) const POINTS: usize = 8;
/// Binomial coefficients of degree 7.
pub(crate) const BINOMIAL: [f64; POINTS] = [1.0, 7.0, 21.0, 35.0, 35.0, 21.0, 7.0, 1.0];

/// Control points of one quantity of degree 7 on `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bernstein(pub(crate) [f64; POINTS]);

impl Bernstein {
    /// The polynomial through values at `θ = i/7`.
    pub(crate) fn through(values: [f64; POINTS]) -> Self {
        let node = |i: usize| i as f64 / (POINTS - 1) as f64;
        let mut difference = values;
        for order in 1..POINTS {
            for i in (order..POINTS).rev() {
                difference[i] = (difference[i] - difference[i - 1]) / (node(i) - node(i - order));
            }
        }
        let mut polynomial = Self([difference[POINTS - 1]; POINTS]);
        for (degree, i) in (1..POINTS).zip((0..POINTS - 1).rev()) {
            polynomial.times_linear(degree, node(i));
            for point in &mut polynomial.0[..=degree] {
                *point += difference[i];
            }
        }
        polynomial
    }

    /// `(θ − root) · p` to become of degree `degree`, in place.
    fn times_linear(&mut self, degree: usize, root: f64) {
        for i in (0..=degree).rev() {
            let raised = if i > 0 { i as f64 / degree as f64 * (1.0 - root) * self.0[i - 1] } else { 0.0 };
            let kept = if i < degree { (degree - i) as f64 / degree as f64 * root * self.0[i] } else { 0.0 };
            self.0[i] = raised - kept;
        }
    }

    /// The value at `θ`.
    pub(crate) fn at(&self, theta: f64) -> f64 {
        let rest = 1.0 - theta;
        let (mut power, mut sum) = (1.0, self.0[0] * rest);
        for i in 1..POINTS - 1 {
            power *= theta;
            sum = (sum + BINOMIAL[i] * power * self.0[i]) * rest;
        }
        sum + power * theta * self.0[POINTS - 1]
    }

    /// Whether no control point is below zero, and so the polynomial is not on `[0, 1]`.
    #[inline(always)]
    pub(crate) fn is_never_negative(&self) -> bool {
        self.0.iter().all(|point| *point >= 0.0)
    }

    /// The two halves, each on its own `[0, 1]` (de Casteljau).
    fn split(&self) -> (Self, Self) {
        let mut right = self.0;
        let mut left = [right[0]; POINTS];
        for level in 1..POINTS {
            for i in 0..POINTS - level {
                right[i] = 0.5 * (right[i] + right[i + 1]);
            }
            left[level] = right[0];
        }
        (Self(left), Self(right))
    }

    /// Brackets the first place where the polynomial goes from zero or above to below zero; `None` when it never does.
    ///
    /// A first control point at or below zero counts as zero: the armed side is the mode's, not the sign's at the start.
    /// A touching zero, which is only reached and left again, is none.
    pub(crate) fn first_descent(mut self) -> Option<(f64, f64)> {
        if self.is_never_negative() {
            return None;
        }
        self.0[0] = self.0[0].max(0.0);
        self.descent_within(0.0, 1.0)
    }

    fn descent_within(&self, low: f64, high: f64) -> Option<(f64, f64)> {
        if self.is_never_negative() {
            return None;
        }
        let falls = self.0.windows(2).all(|pair| pair[1] <= pair[0]);
        let width = high - low;
        if falls || width < MIN_BRACKET {
            return (self.0[POINTS - 1] < 0.0).then_some((low, high));
        }
        let (left, right) = self.split();
        let middle = low + 0.5 * width;
        left.descent_within(low, middle).or_else(|| right.descent_within(middle, high))
    }
}

/// Below this width in θ a bracket is not divided further: a touching zero ends here.
const MIN_BRACKET: f64 = 1e-13;

#[cfg(test)]
mod tests {
    use super::*;

    /// Control points of the product of factors `(θ − root)`, its degree raised to 7.
    fn with_roots(roots: &[f64]) -> Bernstein {
        let mut product = Bernstein([1.0; POINTS]);
        for (i, root) in roots.iter().enumerate() {
            product.times_linear(i + 1, *root);
        }
        for degree in roots.len() + 1..POINTS {
            product.0[degree] = product.0[degree - 1];
            for i in (1..degree).rev() {
                let share = i as f64 / degree as f64;
                product.0[i] += share * (product.0[i - 1] - product.0[i]);
            }
        }
        product
    }

    #[test]
    fn evaluation_splitting_and_interpolation_agree() {
        let polynomial = with_roots(&[-0.2, 0.3, 0.5, 0.9, 1.4]);
        let exact = |x: f64| (x + 0.2) * (x - 0.3) * (x - 0.5) * (x - 0.9) * (x - 1.4);
        for x in [0.0, 0.1, 0.37, 0.5, 0.99, 1.0] {
            assert!((polynomial.at(x) - exact(x)).abs() < 1e-15, "at {x}");
        }
        let through = Bernstein::through(core::array::from_fn(|i| exact(i as f64 / 7.0)));
        for (a, b) in through.0.iter().zip(polynomial.0) {
            assert!((a - b).abs() < 1e-13);
        }
    }

    #[test]
    fn the_first_descent_is_found_even_between_two_roots_close_together() {
        // Falls below zero only between 0.6180 and 0.6181.
        let (low, high) = with_roots(&[0.6180, 0.6181]).first_descent().expect("a descent");
        assert!(low <= 0.6180 && 0.6180 <= high, "{low} {high}");
        // Of three roots the second is a descent.
        let (low, high) = with_roots(&[0.1, 0.4, 0.8]).first_descent().expect("a descent");
        assert!(low <= 0.4 && 0.4 <= high);
    }

    #[test]
    fn a_start_at_zero_is_none_but_the_next_crossing_is_found() {
        // Zero at 0 going up, then down through 0.25.
        let mut polynomial = with_roots(&[0.0, 0.25]);
        polynomial.0 = polynomial.0.map(|p| -p);
        let (low, high) = polynomial.first_descent().expect("a descent");
        assert!(low <= 0.25 && 0.25 <= high && low > 0.0);
        assert_eq!(with_roots(&[0.0]).first_descent(), None);
    }

    #[test]
    fn a_touching_zero_is_none() {
        assert_eq!(with_roots(&[0.5, 0.5]).first_descent(), None);
        assert_eq!(with_roots(&[1.0 / 3.0, 1.0 / 3.0]).first_descent(), None);
        // Touches at one third, and falls through seven tenths.
        let mut polynomial = with_roots(&[1.0 / 3.0, 1.0 / 3.0, 0.7]);
        polynomial.0 = polynomial.0.map(|p| -p);
        let (low, high) = polynomial.first_descent().expect("a descent");
        assert!(low <= 0.7 && 0.7 <= high && low > 0.4, "{low} {high}");
    }
}
