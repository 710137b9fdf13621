//! Sine and cosine with the same bits on every machine, alone and in lanes.
//!
//! ```text
//! x = n π/2 + r,  |r| ≤ π/4       n the nearest whole number, π/2 in three parts, of which n times each is exact
//! sin r, cos r                    by their power series, cut where the next term is below 10⁻¹⁷
//! ```
//!
//! Up to 10⁵ rad the error in double precision is at most two units in the last place; far beyond that the angle itself is not known to
//! better. In single precision the parts have 24 bits, and the error is 4·10⁻⁸ n rad.
//!
//! Source: the reduction of Cody & Waite, Software Manual for the Elementary Functions (1980). Checked by `tests/scalar.rs`.

use crate::scalar::Scalar;

/// π/2 in three parts: the first two have 33 bits.
const PARTS: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Terms of a series behind the first.
const TERMS: usize = 8;
/// `(−1)ᵏ/(2k + 1)!` and `(−1)ᵏ/(2k)!` for k from one on.
const SINE: [f64; TERMS] = series(1);
const COSINE: [f64; TERMS] = series(0);

const fn series(odd: usize) -> [f64; TERMS] {
    let (mut terms, mut factorial, mut k) = ([0.0; TERMS], 1.0, 1);
    while k <= TERMS {
        factorial *= -((2 * k + odd) as f64) * (2 * k + odd - 1) as f64;
        terms[k - 1] = 1.0 / factorial;
        k += 1;
    }
    terms
}

/// The sine of an angle in rad.
#[inline(always)]
pub fn sine<S: Scalar>(angle: S) -> S {
    let ([sine, cosine], quadrant) = reduced(angle);
    let magnitude = S::select(is_odd(quadrant), cosine, sine);
    S::select(S::constant(1.5).lt(quadrant), -magnitude, magnitude)
}

/// The cosine of an angle in rad.
#[inline(always)]
pub fn cosine<S: Scalar>(angle: S) -> S {
    let ([sine, cosine], quadrant) = reduced(angle);
    let magnitude = S::select(is_odd(quadrant), sine, cosine);
    let is_negative = S::constant(0.5).lt(quadrant) & quadrant.lt(S::constant(2.5));
    S::select(is_negative, -magnitude, magnitude)
}

/// Sine and cosine of the remainder of an angle in its quadrant, and the quadrant: 0, 1, 2 or 3.
#[inline(always)]
fn reduced<S: Scalar>(angle: S) -> ([S; 2], S) {
    let whole = nearest(angle * S::constant(core::f64::consts::FRAC_2_PI));
    let mut left = angle;
    for part in PARTS {
        left = left - whole * S::constant(part);
    }
    let rounds = nearest(whole * S::constant(0.25) - S::constant(0.375));
    let quadrant = whole - S::constant(4.0) * rounds;
    let square = left * left;
    let (mut sine, mut cosine) = (S::zero(), S::zero());
    for k in (0..TERMS).rev() {
        sine = sine.multiply_add(square, S::constant(SINE[k]));
        cosine = cosine.multiply_add(square, S::constant(COSINE[k]));
    }
    ([(sine * square).multiply_add(left, left), cosine.multiply_add(square, S::one())], quadrant)
}

#[inline(always)]
fn nearest<S: Scalar>(number: S) -> S {
    (number + S::constant(S::ROUNDS)) - S::constant(S::ROUNDS)
}

#[inline(always)]
fn is_odd<S: Scalar>(quadrant: S) -> S::Mask {
    let from_middle = (quadrant - S::constant(2.0)).magnitude();
    S::constant(0.5).lt(from_middle) & from_middle.lt(S::constant(1.5))
}
