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

/// `C(3, j) C(4, i − j)/C(7, i)`: the control points of a cubic as those of degree 7.
const RAISED: [[f64; 4]; POINTS] = [
    [1.0, 0.0, 0.0, 0.0],
    [4.0 / 7.0, 3.0 / 7.0, 0.0, 0.0],
    [2.0 / 7.0, 4.0 / 7.0, 1.0 / 7.0, 0.0],
    [4.0 / 35.0, 18.0 / 35.0, 12.0 / 35.0, 1.0 / 35.0],
    [1.0 / 35.0, 12.0 / 35.0, 18.0 / 35.0, 4.0 / 35.0],
    [0.0, 1.0 / 7.0, 4.0 / 7.0, 2.0 / 7.0],
    [0.0, 0.0, 3.0 / 7.0, 4.0 / 7.0],
    [0.0, 0.0, 0.0, 1.0],
];

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

    /// Sets the straight line between two states.
    pub(crate) fn set_line(&mut self, from: &[R], to: &[R]) {
        let states = from.len();
        for (index, points) in self.points.chunks_exact_mut(states).enumerate() {
            let part = R::constant(index as f64 / (POINTS - 1) as f64);
            for n in 0..states {
                points[n] = (to[n] - from[n]).multiply_add(part, from[n]);
            }
        }
        self.points[(POINTS - 1) * states..].copy_from_slice(to);
    }

    /// Sets the cubic that has two states and their rates at its ends.
    pub(crate) fn set_cubic(&mut self, [from, rate_from]: [&[R]; 2], [to, rate_to]: [&[R]; 2]) {
        let states = from.len();
        let third = self.step * R::constant(1.0 / 3.0);
        for (index, points) in self.points.chunks_exact_mut(states).enumerate() {
            // The cubic's own control points, of a degree raised by four.
            let weights = RAISED[index].map(R::constant);
            for n in 0..states {
                let of_cubic = [from[n], from[n] + third * rate_from[n], to[n] - third * rate_to[n], to[n]];
                points[n] = weights.iter().zip(of_cubic).fold(R::zero(), |sum, (weight, point)| sum + *weight * point);
            }
        }
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

/// The rate of a state over `θ` by the control points of so many states.
pub(crate) fn slope(points: &[f64], states: usize, index: usize, theta: f64) -> f64 {
    // A Bernstein polynomial of one degree less, by de Casteljau.
    let point = |i: usize| points[i * states + index];
    let mut steps: [f64; POINTS - 1] = core::array::from_fn(|i| point(i + 1) - point(i));
    for last in (0..POINTS - 2).rev() {
        for i in 0..=last {
            steps[i] += theta * (steps[i + 1] - steps[i]);
        }
    }
    (POINTS - 1) as f64 * steps[0]
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
