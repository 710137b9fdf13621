//! The errors that a step may have: of each state a part of its scale, and of the derivatives of the states that part of their size.
//!
//! A direction of derivatives has one size: the root mean square over the states of derivative over scale, the largest that
//! there has been, and at least the part by which a number of the system changes with it: what is far less is rounding.
//! Derivatives grow and oscillate where the values rest, as those of a mass in its balance by its first velocity, so that the
//! errors of values alone would let steps grow until the derivatives are noise.

use crate::scalar::{Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// The errors that states may have, and the sizes that their derivatives have had in each direction.
#[derive(Clone, Debug)]
pub(super) struct Allowed {
    /// Of each state, `relative_tolerance · scale`.
    pub(super) states: Vec<f64>,
    relative_tolerance: f64,
    sizes: Vec<f64>,
}

impl Allowed {
    /// For so many states, and derivatives of at least such sizes.
    pub(super) fn new<R: Real>(states: usize, relative_tolerance: f64, influences: &[f64]) -> Self {
        let mut sizes = influences.to_vec();
        sizes.resize(R::SLOPES, 0.0);
        Self { states: vec![0.0; states], relative_tolerance, sizes }
    }

    /// Enters the scales of the states.
    pub(super) fn enter<R: Real>(&mut self, scales: &[f64], state: &[R]) {
        for (allowed, scale) in self.states.iter_mut().zip(scales) {
            *allowed = self.relative_tolerance * scale;
        }
        for direction in 0..R::SLOPES {
            self.sizes[direction] = self.sizes[direction].max(self.size(state, direction));
        }
    }

    /// The error of a step to a state over what is allowed: that of the values, or the largest of the derivatives, of which
    /// `of` is the error in a direction over what is allowed for derivatives of size one.
    pub(super) fn largest<R: Real>(&self, of_values: f64, end: &[R], of: impl Fn(usize) -> f64) -> f64 {
        (0..R::SLOPES).fold(of_values, |error, direction| {
            let size = self.sizes[direction].max(self.size(end, direction));
            if size > 0.0 && error.is_finite() { error.max(of(direction) / size) } else { error }
        })
    }

    fn size<R: Real>(&self, state: &[R], direction: usize) -> f64 {
        let ratios = state.iter().zip(&self.states).map(|(state, allowed)| state.slope(direction) / allowed);
        let sum: f64 = ratios.map(|ratio| ratio * ratio).sum();
        self.relative_tolerance * Scalar::sqrt(sum / self.states.len() as f64)
    }
}
