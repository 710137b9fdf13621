//! Slopes at the knots of a cubic through measured values that does not overshoot them.
//!
//! The weighted harmonic mean of the secants on both sides, zero where they differ in sign, and at the ends the one-sided
//! three-point rule, kept from changing sign and from overshooting.
//!
//! Source: F. N. Fritsch & J. Butland, "A method for constructing local monotone piecewise cubic interpolants", SIAM J.
//! Sci. Stat. Comput. 5, 300–304 (1984), with the ends of SciPy's `PchipInterpolator`.
//! Checked by `tests/force.rs`, against SciPy's interpolant.

use crate::scalar::Scalar;

/// Measured values at rising places.
#[derive(Clone, Copy)]
pub(crate) struct Knots<P, V> {
    pub(crate) count: usize,
    pub(crate) place: P,
    pub(crate) value: V,
}

impl<P, V> Knots<P, V> {
    /// The slope at a knot; there are at least two.
    pub(crate) fn slope<S: Scalar>(&self, knot: usize) -> S
    where
        P: Fn(usize) -> S,
        V: Fn(usize) -> S,
    {
        let last = self.count - 1;
        if self.count == 2 {
            return self.secant(0);
        }
        if knot == 0 || knot == last {
            let (near, far) = if knot == 0 { (0, 1) } else { (last - 1, last - 2) };
            return end_slope(self.width(near), self.width(far), self.secant(near), self.secant(far));
        }
        let (left, right) = (self.secant(knot - 1), self.secant(knot));
        let (before, after) = (self.width(knot - 1), self.width(knot));
        let two = S::constant(2.0);
        let (w1, w2) = (two * after + before, after + two * before);
        let harmonic = (w1 + w2) / (w1 / left + w2 / right);
        S::select(S::zero().lt(left * right), harmonic, S::zero())
    }

    fn width<S: Scalar>(&self, interval: usize) -> S
    where
        P: Fn(usize) -> S,
    {
        (self.place)(interval + 1) - (self.place)(interval)
    }

    fn secant<S: Scalar>(&self, interval: usize) -> S
    where
        P: Fn(usize) -> S,
        V: Fn(usize) -> S,
    {
        ((self.value)(interval + 1) - (self.value)(interval)) / self.width(interval)
    }
}

fn end_slope<S: Scalar>(near: S, far: S, secant: S, next_secant: S) -> S {
    let two = S::constant(2.0);
    let slope = ((two * near + far) * secant - near * next_secant) / (near + far);
    let wrong_sign = (slope * secant).le(S::zero());
    let limit = S::constant(3.0) * secant;
    let too_steep = (secant * next_secant).le(S::zero()) & limit.magnitude().lt(slope.magnitude());
    S::select(wrong_sign, S::zero(), S::select(too_steep, limit, slope))
}
