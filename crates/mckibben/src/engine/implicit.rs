//! The linearly implicit method for stiff phases: Rodas5P, order 5(4), L-stable, eight stages.
//!
//! A chamber that is joined to a port at nearly its own pressure settles in a time far below any step that accuracy
//! would need. An explicit method crawls there; a Newton iteration fails on the kinks of the flow law. A Rosenbrock
//! method needs neither: each stage solves one linear system with the exact Jacobian, which dual numbers give.
//!
//! ```text
//! (I/(hγ) − J) kᵢ = f(t + cᵢh, y + Σ aᵢⱼ kⱼ) + Σ Cᵢⱼ kⱼ/h + h dᵢ ∂f/∂t
//! ```
//!
//! Source: G. Steinebach, "Construction of Rosenbrock–Wanner method Rodas5P", BIT 63, 27 (2023); published coefficients.

use super::Hybrid;
use super::allowed::Allowed;
use super::arc::{Arc, POINTS};
use crate::dual::Dual;
use crate::scalar::{Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;

const STAGES: usize = 8;
const GAMMA: f64 = 0.21193756319429014;

#[rustfmt::skip]
const A: [[f64; 5]; 6] = [
    [0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0, 0.0, 0.0, 0.0, 0.0],
    [2.849394379747939, 0.45842242204463923, 0.0, 0.0, 0.0],
    [-6.954028509809101, 2.489845061869568, -10.358996098473584, 0.0, 0.0],
    [2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641, 0.0],
    [-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946],
];

#[rustfmt::skip]
const C: [[f64; 7]; STAGES] = [
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-14.155112264123755, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-17.97296035885952, -2.859693295451294, 0.0, 0.0, 0.0, 0.0, 0.0],
    [147.12150275711716, -1.41221402718213, 71.68940251302358, 0.0, 0.0, 0.0, 0.0],
    [165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306, 0.0, 0.0, 0.0],
    [24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471, 0.0, 0.0],
    [30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
     -28.087943162872662, 0.0],
    [37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
     -54.66780262877968, -9.48861652309627],
];

const NODES: [f64; STAGES] =
    [0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0];

const TIME_WEIGHTS: [f64; STAGES] = [
    0.21193756319429014,
    -0.42387512638858027,
    -0.3384627126235924,
    1.8046452872882734,
    2.325825639765069,
    0.0,
    0.0,
    0.0,
];

#[rustfmt::skip]
const DENSE: [[f64; STAGES]; 3] = [
    [25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073,
     1.1241088310450404, 0.4272876194431874, -0.17202221070155493],
    [-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044,
     15.98066361424651, -6.789040303419874, -6.710236069923372],
    [11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643, -52.072871366152654,
     -59.78993625266729, -0.15582684282751913, 4.883087185713722],
];

/// Evaluations of a step besides those of the Jacobian.
pub(super) const EVALUATIONS: u64 = STAGES as u64;

/// An attempted step, with the rates' derivatives at its start; kept from step to step.
#[derive(Clone, Debug)]
pub(super) struct Attempt<R> {
    states: usize,
    /// `∂f/∂y`, row by row, and `∂f/∂t`.
    jacobian: Vec<R>,
    per_time: Vec<R>,
    /// `I/(hγ) − J` as triangular factors, and the order of its rows.
    rows: Vec<R>,
    order: Vec<usize>,
    /// Increments of the stages.
    stages: Vec<R>,
    state: Vec<R>,
    right: Vec<R>,
    /// The states at the end of the step.
    pub(super) end: Vec<R>,
    /// Error over the tolerance; NaN when the step is not physical or the matrix is singular.
    pub(super) error: f64,
}

impl<R: Real> Attempt<R> {
    /// Room for so many states.
    pub(super) fn new(states: usize) -> Self {
        let zeros = |count: usize| vec![R::zero(); count];
        Self {
            states,
            jacobian: zeros(states * states),
            per_time: zeros(states),
            rows: zeros(states * states),
            order: (0..states).collect(),
            stages: zeros(STAGES * states),
            state: zeros(states),
            right: zeros(states),
            end: zeros(states),
            error: f64::NAN,
        }
    }

    /// Computes the exact Jacobian and `∂f/∂t`.
    pub(super) fn linearise<S: Hybrid<R>>(
        &mut self,
        system: &S,
        time: R,
        state: &[R],
        mode: &S::Mode,
        (seeded, along): (&mut [Dual<R, 1>], &mut S::Work<Dual<R, 1>>),
        rates: &mut [Dual<R, 1>],
    ) {
        let count = self.states;
        let constant = |number: R| Dual::<R, 1> { value: number, slope: [R::zero()] };
        for (seeded, value) in seeded.iter_mut().zip(state) {
            *seeded = constant(*value);
        }
        for column in 0..count {
            seeded[column] = Dual::variable(state[column], 0);
            system.rates(constant(time), seeded, mode, along, rates);
            seeded[column] = constant(state[column]);
            for row in 0..count {
                self.jacobian[row * count + column] = rates[row].slope[0];
            }
        }
        system.rates(Dual::variable(time, 0), seeded, mode, along, rates);
        for row in 0..count {
            self.per_time[row] = rates[row].slope[0];
        }
    }

    /// A bound on the fastest rate in 1/s: the largest row sum with each state in its own scale.
    pub(super) fn fastest_rate(&self, scale: &[f64]) -> f64 {
        let count = self.states;
        let row_sum = |row: usize| -> f64 {
            (0..count).map(|k| self.jacobian[row * count + k].value().abs() * scale[k] / scale[row]).sum()
        };
        (0..count).map(row_sum).fold(0.0, f64::max)
    }

    /// Attempts a step of length `step` from `start`, where the rates are `slope`.
    pub(super) fn attempt(
        &mut self,
        time: R,
        start: &[R],
        slope: &[R],
        step: R,
        allowed: &Allowed,
        mut rates: impl FnMut(R, &[R], &mut [R]),
    ) {
        let count = self.states;
        self.error = f64::NAN;
        if !self.factor(R::one() / (step * R::constant(GAMMA))) {
            return;
        }
        let per_step = R::one() / step;
        self.state.copy_from_slice(&start[..count]);
        for stage in 0..STAGES {
            if stage == 0 {
                self.right.copy_from_slice(&slope[..count]);
            } else {
                // The last two stages start from the one before with its increment added.
                if stage < A.len() {
                    for n in 0..count {
                        self.state[n] = (0..stage)
                            .fold(start[n], |sum, j| sum + R::constant(A[stage][j]) * self.stages[j * count + n]);
                    }
                } else {
                    for n in 0..count {
                        self.state[n] = self.state[n] + self.stages[(stage - 1) * count + n];
                    }
                }
                rates(time + step * R::constant(NODES[stage]), &self.state, &mut self.right);
            }
            for n in 0..count {
                let history =
                    (0..stage).fold(R::zero(), |sum, j| sum + R::constant(C[stage][j]) * self.stages[j * count + n]);
                self.right[n] =
                    self.right[n] + history * per_step + step * R::constant(TIME_WEIGHTS[stage]) * self.per_time[n];
            }
            self.solve(stage);
        }
        let last = (STAGES - 1) * count;
        for n in 0..count {
            self.end[n] = self.state[n] + self.stages[last + n];
        }
        let of_values = self.error_of(&allowed.states, R::value);
        let of_slopes = |direction| self.error_of(&allowed.states, |number| number.slope(direction));
        self.error = allowed.largest(of_values, &self.end, of_slopes);
    }

    /// The error of a part of the states over what is allowed.
    fn error_of(&self, allowed: &[f64], part: impl Fn(R) -> f64) -> f64 {
        let errors = &self.stages[(STAGES - 1) * self.states..];
        let ratios = errors.iter().zip(allowed).map(|(error, allowed)| part(*error) / allowed);
        Scalar::sqrt(ratios.map(|ratio| ratio * ratio).sum::<f64>() / self.states as f64)
    }

    /// The dense output, of order 4, as control points.
    pub(super) fn dense(&self, time: R, start: &[R], step: R, arc: &mut Arc<R>) {
        let count = self.states;
        (arc.start, arc.step) = (time, step);
        for n in 0..count {
            let [first, second, third] = DENSE.map(|row| {
                (0..STAGES).fold(R::zero(), |sum, j| sum + R::constant(row[j]) * self.stages[j * count + n])
            });
            let rise = self.end[n] - start[n];
            // y = y₀ + θ(rise + (1 − θ)(first + θ(second + θ third))): a polynomial of degree 4 in powers of θ.
            let powers = [start[n], rise + first, second - first, third - second, -third];
            for i in 0..POINTS {
                // Power k contributes C(i, k)/C(7, k) to control point i.
                let mut sum = powers[0];
                let mut share = 1.0;
                for (k, power) in powers.iter().enumerate().skip(1) {
                    share *= (i as f64 - (k as f64 - 1.0)) / (7.0 - (k as f64 - 1.0));
                    sum = sum + R::constant(share) * *power;
                }
                arc.points[i * count + n] = sum;
            }
            arc.points[7 * count + n] = self.end[n];
        }
    }

    /// Factors `shift · I − J`; whether it is regular and finite.
    fn factor(&mut self, shift: R) -> bool {
        let count = self.states;
        for (row, entry) in self.rows.iter_mut().zip(&self.jacobian) {
            *row = -*entry;
        }
        for n in 0..count {
            self.rows[n * count + n] = shift + self.rows[n * count + n];
            self.order[n] = n;
        }
        for column in 0..count {
            let size = |row: usize| self.rows[row * count + column].value().abs();
            let largest = (column..count).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(column);
            if largest != column {
                for k in 0..count {
                    self.rows.swap(column * count + k, largest * count + k);
                }
                self.order.swap(column, largest);
            }
            let pivot = self.rows[column * count + column];
            if !(pivot.value().is_finite() && pivot.value() != 0.0) {
                return false;
            }
            let per_pivot = R::one() / pivot;
            for row in column + 1..count {
                let factor = self.rows[row * count + column] * per_pivot;
                self.rows[row * count + column] = factor;
                for k in column + 1..count {
                    self.rows[row * count + k] = self.rows[row * count + k] - factor * self.rows[column * count + k];
                }
            }
        }
        true
    }

    /// Solves for the increment of a stage.
    fn solve(&mut self, stage: usize) {
        let count = self.states;
        let x = &mut self.stages[stage * count..(stage + 1) * count];
        for i in 0..count {
            x[i] = self.right[self.order[i]];
            for j in 0..i {
                x[i] = x[i] - self.rows[i * count + j] * x[j];
            }
        }
        for i in (0..count).rev() {
            for j in i + 1..count {
                x[i] = x[i] - self.rows[i * count + j] * x[j];
            }
            x[i] = x[i] / self.rows[i * count + i];
        }
    }
}
