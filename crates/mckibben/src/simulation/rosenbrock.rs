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
//! Checked by `tests/integrator.rs`: order 5 fitted in closed form, a stiff decay at a hundred thousand times its rate.

use super::arc::{Arc, Nested};
use crate::dual::Dual;
use crate::scalar::{Over, Real, Scalar};

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

/// The rates' derivatives at the start of a step.
pub(super) struct Linearisation<R, const N: usize> {
    /// How many of the states have a meaning.
    states: usize,
    jacobian: [[R; N]; N],
    per_time: [R; N],
}

impl<R: Real, const N: usize> Linearisation<R, N> {
    /// The exact Jacobian `∂f/∂y` and `∂f/∂t` over the first of the states, as many as have a meaning.
    pub(super) fn at(
        time: R,
        state: &[R; N],
        states: usize,
        rates: impl Fn(Dual<R, 1>, &[Dual<R, 1>; N]) -> [Dual<R, 1>; N],
    ) -> Self {
        let constants = state.map(Dual::of);
        let mut jacobian = [[R::zero(); N]; N];
        for column in 0..states {
            let mut seeded = constants;
            seeded[column] = Dual::variable(state[column], 0);
            for (row, rate) in rates(Dual::of(time), &seeded).iter().enumerate() {
                jacobian[row][column] = rate.slope[0];
            }
        }
        let per_time = rates(Dual::variable(time, 0), &constants).map(|rate| rate.slope[0]);
        Self { states, jacobian, per_time }
    }

    /// A bound on the fastest rate in 1/s: the largest row sum with each state in its own scale.
    pub(super) fn fastest_rate(&self, scale: &[f64; N]) -> f64 {
        let row_sum = |row: usize| {
            (0..self.states).map(|column| self.jacobian[row][column].value().abs() * scale[column] / scale[row]).sum()
        };
        (0..self.states).map(row_sum).fold(0.0, f64::max)
    }
}

/// An attempted step.
pub(super) struct Attempt<R, const N: usize> {
    /// The states at the end of the step.
    pub(super) end: [R; N],
    /// Error over the tolerance; NaN when the step left the physics or the matrix is singular.
    pub(super) error: f64,
    stages: [[R; N]; STAGES],
}

/// Attempts a step of length `step` from `start`, where the rates are `slope` and their derivatives `linear`.
#[allow(clippy::too_many_arguments)]
pub(super) fn attempt<R: Real, const N: usize>(
    time: R,
    start: &[R; N],
    slope: &[R; N],
    linear: &Linearisation<R, N>,
    step: R,
    allowed: &[f64; N],
    mut rates: impl FnMut(R, &[R; N]) -> [R; N],
) -> Attempt<R, N> {
    let failed = Attempt { end: *start, error: f64::NAN, stages: [[R::zero(); N]; STAGES] };
    let Some(matrix) = Factored::shifted(linear, R::one() / (step * R::constant(GAMMA))) else {
        return failed;
    };
    let mut k = [[R::zero(); N]; STAGES];
    let mut state = *start;
    for stage in 0..STAGES {
        let value = if stage == 0 {
            *slope
        } else {
            // The last two stages start from the one before with its increment added.
            state = if stage < A.len() {
                core::array::from_fn(|n| (0..stage).fold(start[n], |sum, j| sum + R::constant(A[stage][j]) * k[j][n]))
            } else {
                core::array::from_fn(|n| state[n] + k[stage - 1][n])
            };
            rates(time + step * R::constant(NODES[stage]), &state)
        };
        let right: [R; N] = core::array::from_fn(|n| {
            let history = (0..stage).fold(R::zero(), |sum, j| sum + R::constant(C[stage][j]) * k[j][n]);
            value[n] + history / step + step * R::constant(TIME_WEIGHTS[stage]) * linear.per_time[n]
        });
        k[stage] = matrix.solve(right);
    }
    let end: [R; N] = core::array::from_fn(|n| state[n] + k[STAGES - 1][n]);
    let mut sum = 0.0;
    for n in 0..linear.states {
        let ratio = k[STAGES - 1][n].value() / allowed[n];
        sum += ratio * ratio;
    }
    Attempt { end, error: Scalar::sqrt(sum / linear.states as f64), stages: k }
}

impl<R: Real, const N: usize> Attempt<R, N> {
    /// The dense output, of order 4.
    pub(super) fn arc(&self, time: R, start: &[R; N], step: R) -> Arc<R, N> {
        let [first, second, third]: [[R; N]; 3] = DENSE.map(|row| {
            core::array::from_fn(|n| {
                (0..STAGES).fold(R::zero(), |sum, j| sum + R::constant(row[j]) * self.stages[j][n])
            })
        });
        let mut nested = Nested::constant(third);
        nested
            .times_theta()
            .plus(second)
            .times_theta()
            .plus(first)
            .times_rest()
            .plus(core::array::from_fn(|n| self.end[n] - start[n]))
            .times_theta()
            .plus(*start)
            .arc(time, step)
    }
}

/// `s I − J` as triangular factors with row exchanges.
struct Factored<R, const N: usize> {
    states: usize,
    rows: [[R; N]; N],
    order: [usize; N],
}

impl<R: Real, const N: usize> Factored<R, N> {
    /// Factors `shift · I − J`; `None` when it is singular or not finite.
    fn shifted(linear: &Linearisation<R, N>, shift: R) -> Option<Self> {
        let states = linear.states;
        let mut rows = linear.jacobian;
        for (i, row) in rows.iter_mut().enumerate().take(states) {
            for entry in row.iter_mut().take(states) {
                *entry = -*entry;
            }
            row[i] = shift + row[i];
        }
        let mut order: [usize; N] = core::array::from_fn(|i| i);
        for column in 0..states {
            let largest = (column..states)
                .max_by(|&a, &b| rows[a][column].value().abs().total_cmp(&rows[b][column].value().abs()))?;
            rows.swap(column, largest);
            order.swap(column, largest);
            let pivot = rows[column][column];
            if !(pivot.value().is_finite() && pivot.value() != 0.0) {
                return None;
            }
            for row in column + 1..states {
                let factor = rows[row][column] / pivot;
                rows[row][column] = factor;
                for j in column + 1..states {
                    rows[row][j] = rows[row][j] - factor * rows[column][j];
                }
            }
        }
        Some(Self { states, rows, order })
    }

    fn solve(&self, right: [R; N]) -> [R; N] {
        let mut x: [R; N] = core::array::from_fn(|i| right[self.order[i]]);
        for i in 0..self.states {
            for j in 0..i {
                x[i] = x[i] - self.rows[i][j] * x[j];
            }
        }
        for i in (0..self.states).rev() {
            for j in i + 1..self.states {
                x[i] = x[i] - self.rows[i][j] * x[j];
            }
            x[i] = x[i] / self.rows[i][i];
        }
        x
    }
}
