//! A polynomial through successive readings, by least squares.
//!
//! ```text
//! L(t) ≈ Σ_j c_j u^j,  u = (t − t₀)/τ        t₀: the middle of the readings in time, τ: half of their span, so that |u| ≤ 1
//! σ_v(t) = σ √(gᵀ C g),  g_j = j u^(j−1)/τ   C: the inverse of the normal matrix
//! Σ r² ≤ σ² χ²(ν)                            the readings scatter about it as their noise σ does
//! ```
//!
//! χ²(ν) is exceeded in one case of 740 (3 standard deviations to one side), by ν (1 − 2/(9ν) + 3 √(2/(9ν)))³ (Wilson and Hilferty 1931).

use nalgebra::{Matrix5, Vector5};
use std::ops::Range;

/// Standard deviations by which the scatter may be more than is expected.
const SCATTERED: f64 = 3.0;
/// Coefficients, at most.
const MOST: usize = 5;

/// Of a length in m over the time in s, of degree four or less.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polynomial {
    /// Middle and half span of the readings in s, and the length in m that is added.
    middle: f64,
    reach: f64,
    base: f64,
    coefficients: Vector5<f64>,
    inverse: Matrix5<f64>,
    /// Sum of the squared residuals in m².
    pub(crate) squares: f64,
    /// Readings less coefficients.
    pub(crate) freedom: usize,
}

impl Polynomial {
    /// Through the readings `within`; `None` where they are too few to determine it.
    pub(crate) fn through([time, length]: [&[f64]; 2], within: Range<usize>, degree: usize) -> Option<Self> {
        let [time, length] = [time.get(within.clone())?, length.get(within)?];
        let freedom = time.len().checked_sub(degree + 1)?;
        let (begin, end) = (time.first()?, time.last()?);
        let (middle, reach, base) = (0.5 * (begin + end), 0.5 * (end - begin), length[length.len() / 2]);
        let reach = if reach > 0.0 { reach } else { 1.0 };
        let pairs = || time.iter().zip(length).map(|(time, length)| ((time - middle) / reach, length - base));
        // Sums of the powers of the time from −1 to 1, and of these times the length.
        let (mut sums, mut right) = ([0.0; 2 * MOST - 1], Vector5::zeros());
        for (u, off) in pairs() {
            let mut power = 1.0;
            for (place, sum) in sums.iter_mut().take(2 * degree + 1).enumerate() {
                *sum += power;
                if place <= degree {
                    right[place] += power * off;
                }
                power *= u;
            }
        }
        let mut normal =
            Matrix5::from_fn(|row, column| if row.max(column) <= degree { sums[row + column] } else { 0.0 });
        // Coefficients that it lacks are zero, and certain.
        for power in degree + 1..MOST {
            normal[(power, power)] = 1.0;
        }
        let mut inverse = normal.cholesky()?.inverse();
        for power in degree + 1..MOST {
            inverse[(power, power)] = 0.0;
        }
        let coefficients = inverse * right;
        let mut found = Self { middle, reach, base, coefficients, inverse, squares: 0.0, freedom };
        found.squares = pairs().map(|(u, off)| (off - found.rise(u)).powi(2)).sum();
        found.squares.is_finite().then_some(found)
    }

    /// Length in m above the base at a time of −1 to 1.
    fn rise(&self, u: f64) -> f64 {
        let [c0, c1, c2, c3, c4] = self.coefficients.into();
        c0 + u * (c1 + u * (c2 + u * (c3 + u * c4)))
    }

    /// Length in m at a time in s.
    pub(crate) fn length(&self, time: f64) -> f64 {
        self.base + self.rise((time - self.middle) / self.reach)
    }

    /// Velocity in m/s at a time in s.
    pub(crate) fn velocity(&self, time: f64) -> f64 {
        let u = (time - self.middle) / self.reach;
        let [_, c1, c2, c3, c4] = self.coefficients.into();
        (c1 + u * (2.0 * c2 + u * (3.0 * c3 + 4.0 * u * c4))) / self.reach
    }

    /// Standard error of the velocity in m/s, by the noise of a reading in m.
    pub(crate) fn error_of_velocity(&self, time: f64, noise: f64) -> f64 {
        let u = (time - self.middle) / self.reach;
        let slope = Vector5::new(0.0, 1.0, 2.0 * u, 3.0 * u * u, 4.0 * u.powi(3));
        noise * slope.dot(&(self.inverse * slope)).max(0.0).sqrt() / self.reach
    }

    /// Whether the readings scatter about it as their noise in m does.
    pub(crate) fn fits(&self, noise: f64) -> bool {
        are_noise(self.squares, self.freedom, noise)
    }
}

/// Whether the sum of so many squared residuals in m² is that of readings with a noise in m.
pub(crate) fn are_noise(squares: f64, freedom: usize, noise: f64) -> bool {
    let freedom = freedom as f64;
    if freedom == 0.0 {
        return true;
    }
    let part = 2.0 / (9.0 * freedom);
    squares <= noise * noise * freedom * (1.0 - part + SCATTERED * part.sqrt()).powi(3)
}
