//! One accepted step as a polynomial: the dense output.
//!
//! A step from `t` to `t + h` is kept as a polynomial of degree 7 in `θ = (t′ − t)/h`, in the Bernstein basis:
//!
//! ```text
//! y(θ) = Σ Cᵢ θⁱ (1 − θ)⁷⁻ⁱ pᵢ,     Cᵢ = 7!/(i! (7−i)!)
//! ```
//!
//! The control points `pᵢ` bound the polynomial on `[0, 1]` from both sides (the hull property): a quantity whose control
//! points are all on one side of a threshold does not cross it, anywhere in the step and however briefly.

pub(crate) use super::bernstein::POINTS;
use super::bernstein::{BINOMIAL, Bernstein};
use crate::scalar::{Over, Real};
use alloc::vec;
use alloc::vec::Vec;

/// One step of several states as polynomials in time.
#[derive(Clone, Debug)]
pub struct Arc<R> {
    /// Start of the step in s.
    pub start: R,
    /// Length of the step in s over which θ goes from 0 to 1.
    pub step: R,
    /// Control points, those of all states one after the other, point by point.
    pub(crate) points: Vec<R>,
}

impl<R: Real> Arc<R> {
    /// Room for so many states.
    pub(crate) fn new(states: usize) -> Self {
        Self { start: R::zero(), step: R::one(), points: vec![R::zero(); POINTS * states] }
    }

    /// States at a control point.
    pub(crate) fn point(&self, index: usize) -> &[R] {
        let states = self.points.len() / POINTS;
        &self.points[index * states..(index + 1) * states]
    }

    pub(crate) fn point_mut(&mut self, index: usize) -> &mut [R] {
        let states = self.points.len() / POINTS;
        &mut self.points[index * states..(index + 1) * states]
    }

    /// The states at `θ`, from 0 at the start to 1 at the end of the step.
    pub fn at<T: Over<R>>(&self, theta: T, state: &mut [T]) {
        at(&self.points, theta, state);
    }

    /// Whether every control point is a finite number.
    pub(crate) fn is_finite(&self) -> bool {
        self.points.iter().all(|point| point.value().is_finite())
    }

    /// Whether all control points of a state hold to something.
    #[inline(always)]
    pub(crate) fn all_points(&self, index: usize, holds: impl Fn(f64) -> bool) -> bool {
        let states = self.points.len() / POINTS;
        // No early end: it costs more than it saves.
        self.points[index..].iter().step_by(states).fold(true, |all, point| all & holds(point.value()))
    }

    /// Control points of the linear form `sign · (y[index] − bound)`, values only.
    pub(crate) fn linear(&self, index: usize, bound: f64, sign: f64) -> Bernstein {
        let states = self.points.len() / POINTS;
        Bernstein(core::array::from_fn(|i| sign * (self.points[i * states + index].value() - bound)))
    }
}

/// The states at `θ` by their control points.
pub(crate) fn at<R: Real, T: Over<R>>(points: &[R], theta: T, state: &mut [T]) {
    let states = state.len();
    let rest = T::one() - theta;
    // Weights Cᵢ θⁱ (1 − θ)⁷⁻ⁱ, shared by all states.
    let mut weights = [T::one(); POINTS];
    let mut power = T::one();
    for (weight, binomial) in weights.iter_mut().zip(BINOMIAL) {
        *weight = power * T::constant(binomial);
        power = power * theta;
    }
    power = T::one();
    for weight in weights.iter_mut().rev() {
        *weight = *weight * power;
        power = power * rest;
    }
    for (n, state) in state.iter_mut().enumerate() {
        let mut sum = weights[0] * T::of(points[n]);
        for i in 1..POINTS {
            sum = sum + weights[i] * T::of(points[i * states + n]);
        }
        *state = sum;
    }
}
