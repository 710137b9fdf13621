//! What a linear model does: its poles, its frequency response, and what its inputs reach.
//!
//! ```text
//! poles             det(λ I − A) = 0        ω_n = |λ|, ζ = −Re λ/|λ|, τ = −1/Re λ
//! response          G(jω) = C (jω I − A)⁻¹ B + D
//! part of a mode    |c v w b|/|c b|       w A = λ w, A v = λ v, w v = 1:  c v w b = 1/(2πi) ∮ c (s I − A)⁻¹ b ds around λ
//! controllability   singular values of [b, A b, A² b, …], states over their usual size, time over 1/max |λ|
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | λ | [`Pole`] | 1/s |
//! | ω_n, ζ, τ | `natural_frequency`, `damping_ratio`, `time_constant` | rad/s, –, s |
//! | G | [`Phasor`] | output over input |
//!
//! The states have sizes from 1e-6 to 1e6, so the matrix is balanced (Parlett & Reinsch) before anything is computed from
//! it. A pole below a part 1e-12 of the balanced matrix is zero: that is what rounding leaves of an integrator.
//!
//! The part that a mode has in a motion is that of participation factors (Pérez-Arriaga, Verghese & Schweppe, IEEE Trans. Power
//! Apparatus and Systems 101, 1982), to which it reduces where c and b have one entry each. By the integral it needs no
//! eigenvectors, which equal poles do not determine one by one.
//!
//! The rank of controllability is that of the staircase form (Paige, IEEE Trans. Automatic Control 26, 1981): of one input the
//! balanced `A` with orthogonal transformations to upper Hessenberg form, the first of which turns `b` into the first state. Each
//! state moves the next one by an entry below the diagonal; the first that is rounding ends what the input reaches. Powers of `A`,
//! which grow apart as the poles do, have no part in it. The condition has them: how many times harder the least reachable combination
//! of states is to reach than the most reachable one, in times of the fastest pole.
//!
//! Eigenvalues, singular values and linear equations are those of the crate `nalgebra`. Source: Franklin, Powell &
//! Emami-Naeini, Feedback Control of Dynamic Systems. Checked by `tests/linearize_analysis.rs`: closed forms, the
//! characteristic polynomial, ring-downs in simulation.

use super::StateSpace;
use crate::error::Error;
use alloc::vec::Vec;
use core::f64::consts::TAU;
use nalgebra::linalg::{Hessenberg, Schur, balancing::balance_parlett_reinsch};
use nalgebra::{Complex, DMatrix, DVector, Dyn};

/// A pole of a linear model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pole {
    /// Real part in 1/s.
    pub real: f64,
    /// Imaginary part in rad/s.
    pub imaginary: f64,
}

impl Pole {
    /// Natural frequency `|λ|` in rad/s.
    pub fn natural_frequency(&self) -> f64 {
        self.real.hypot(self.imaginary)
    }

    /// Damping ratio `−Re λ/|λ|`, 1 for a real pole that decays; `None` for a pole at zero.
    pub fn damping_ratio(&self) -> Option<f64> {
        (!self.is_zero()).then(|| -self.real / self.natural_frequency())
    }

    /// Time in s in which it decays by the factor e, negative when it grows; `None` when it does neither.
    pub fn time_constant(&self) -> Option<f64> {
        (self.real != 0.0).then(|| -1.0 / self.real)
    }

    /// Whether it is an integrator.
    pub fn is_zero(&self) -> bool {
        self.real == 0.0 && self.imaginary == 0.0
    }
}

/// An output over an input at a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phasor {
    /// Real part, in the unit of the output over that of the input.
    pub real: f64,
    /// Imaginary part.
    pub imaginary: f64,
}

impl Phasor {
    /// Its size.
    pub fn magnitude(&self) -> f64 {
        self.real.hypot(self.imaginary)
    }

    /// Its angle in rad, from −π to π.
    pub fn phase(&self) -> f64 {
        self.imaginary.atan2(self.real)
    }
}

/// What one input reaches.
#[derive(Clone, Debug, PartialEq)]
pub struct Controllability {
    /// Singular values of the scaled controllability matrix, falling, as parts of the largest.
    pub singular_values: Vec<f64>,
    /// How many states the input can move independently.
    pub rank: usize,
    /// The largest over the smallest; infinite where the rank is not full, or the smallest is rounding.
    pub condition: f64,
}

/// How large a state usually is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UsualSize {
    /// Its size in its own unit, or for a rate in that of what it is the rate of.
    pub(crate) size: f64,
    /// Whether it is the rate of another: its size is then that in a time of the fastest pole.
    pub(crate) is_rate: bool,
}

/// A balanced matrix.
struct Balanced {
    schur: Schur<f64, Dyn>,
    /// What balances it: `x = sizes · z`.
    sizes: DVector<f64>,
    /// The size below which part of a pole is zero.
    small: f64,
}

impl Balanced {
    /// As [`StateSpace::poles`].
    fn poles(&self) -> Vec<Pole> {
        let values = self.schur.complex_eigenvalues();
        let kept = |part: f64| if part.abs() <= self.small { 0.0 } else { part };
        let mut poles: Vec<Pole> =
            values.iter().map(|value| Pole { real: kept(value.re), imaginary: kept(value.im) }).collect();
        poles.sort_by(|a, b| {
            let fastest = b.natural_frequency().total_cmp(&a.natural_frequency());
            let near = (a.natural_frequency() - b.natural_frequency()).abs() <= 1e-9 * a.natural_frequency();
            if near { b.imaginary.total_cmp(&a.imaginary) } else { fastest }
        });
        poles
    }
}

/// Part of the balanced matrix below which a pole is zero.
const ZERO: f64 = 1e-12;
/// Part of the largest singular value below which one is rounding.
const ROUNDING: f64 = 1e-12;
/// Part of the balanced matrix below which what a state adds to the next one in the staircase form is rounding: that of the
/// transformations is some 1e-15 for each state, and stiff plants that reach it have 1e-6 or more.
const UNMOVED: f64 = 1e-11;
/// Steps of the eigenvalue iteration, which needs about two for each state.
const STEPS: usize = 1000;
/// By how much a search for eigenvalues that does not end is made coarser, and the coarsest: parts of its neighbours from which on an
/// element is no zero. Equal poles of 30 1/s beside one of 10⁴ 1/s need some hundreds of roundings.
const COARSER: f64 = 32.0;
const COARSEST: f64 = 1e-11;
/// Part of its size within which poles count as one mode.
const ONE_MODE: f64 = 1e-6;
/// Points of the integral around a pole, halfway to the nearest other: it is right but for about 2⁻²⁴.
const AROUND: usize = 24;

impl<X, U, Y> StateSpace<X, U, Y> {
    /// `A`, and the sizes that balance it: `x = sizes · z`.
    fn balanced(&self) -> (DMatrix<f64>, DVector<f64>) {
        let n = self.states.len();
        let mut a = DMatrix::from_fn(n, n, |row, column| self.a[row][column]);
        let sizes = balance_parlett_reinsch(&mut a);
        (a, sizes)
    }

    /// The real Schur form of the balanced `A`.
    fn schur(&self) -> Result<Balanced, Error> {
        let (a, sizes) = self.balanced();
        let small = ZERO * a.norm();
        // What counts as zero is a part of its neighbours, which beside far faster poles is below the rounding of the whole.
        let mut part = f64::EPSILON;
        let schur = loop {
            if let Some(schur) = Schur::try_new(a.clone(), part, STEPS) {
                break schur;
            }
            part *= COARSER;
            if part > COARSEST {
                return Err(Error::NoSolution {
                    what: "the poles of the linear model cannot be found",
                    remedy: "check that masses, volumes and pressures are of usual size",
                });
            }
        };
        Ok(Balanced { schur, sizes, small })
    }

    /// The poles, fastest first; the two of a pair one after the other, the one above the real axis first.
    ///
    /// # Errors
    /// [`Error::NoSolution`] when the eigenvalues cannot be found, which only numbers of absurd size bring about.
    pub fn poles(&self) -> Result<Vec<Pole>, Error> {
        self.schur().map(|balanced| balanced.poles())
    }

    /// `G(jω)` from one input to one output at an angular frequency in rad/s; `None` on an undamped pole, where it has no
    /// bound.
    pub fn response(&self, input: usize, output: usize, angular_frequency: f64) -> Option<Phasor> {
        let (a, sizes) = self.balanced();
        let n = a.nrows();
        let left = DMatrix::from_fn(n, n, |row, column| {
            Complex::new(-a[(row, column)], if row == column { angular_frequency } else { 0.0 })
        });
        let right = DVector::from_fn(n, |row, _| Complex::new(self.b[row][input] / sizes[row], 0.0));
        let state = left.lu().solve(&right)?;
        let sum: Complex<f64> = (0..n).map(|n| state[n] * (self.c[output][n] * sizes[n])).sum();
        let value = sum + self.d[output][input];
        value.is_finite().then_some(Phasor { real: value.re, imaginary: value.im })
    }

    /// The part that each oscillating mode has in the first value of the motion `c x` that starts from `x = b`: each with its pole
    /// above the real axis. Of equal poles each has the part of all. There is none where that value is zero.
    ///
    /// # Errors
    /// As [`StateSpace::poles`].
    pub fn oscillating_parts(&self, b: &[f64], c: &[f64]) -> Result<Vec<(Pole, f64)>, Error> {
        let whole: f64 = c.iter().zip(b).map(|(c, b)| c * b).sum();
        if whole == 0.0 {
            return Ok(Vec::new());
        }
        let balanced = self.schur()?;
        let poles = balanced.poles();
        let Balanced { schur, sizes, .. } = balanced;
        let (basis, triangle) = schur.unpack();
        let left = basis.tr_mul(&DVector::from_fn(sizes.len(), |row, _| c[row] * sizes[row]));
        let right = basis.tr_mul(&DVector::from_fn(sizes.len(), |row, _| b[row] / sizes[row]));
        let part = |pole: &Pole| -> f64 {
            let nearest = poles
                .iter()
                .map(|other| (other.real - pole.real).hypot(other.imaginary - pole.imaginary))
                .filter(|distance| *distance > ONE_MODE * pole.natural_frequency())
                .fold(pole.natural_frequency(), f64::min);
            let at = |point: usize| {
                let (sine, cosine) = (TAU * point as f64 / AROUND as f64).sin_cos();
                let offset = Complex::new(cosine, sine) * (0.5 * nearest);
                let state = resolvent(&triangle, Complex::new(pole.real, pole.imaginary) + offset, &right);
                let sum: Complex<f64> = state.iter().zip(left.iter()).map(|(state, left)| state * *left).sum();
                sum * offset
            };
            let residue: Complex<f64> = (0..AROUND).map(at).sum();
            residue.re.hypot(residue.im) / (AROUND as f64 * whole.abs())
        };
        Ok(poles.iter().filter(|pole| pole.imaginary > 0.0).map(|pole| (*pole, part(pole))).collect())
    }

    /// How many states an input moves independently, at least zero and at most all.
    ///
    /// # Panics
    /// If the input has no column.
    pub fn reached(&self, input: usize) -> usize {
        // What no chain of entries leads to is left out: beside slow states that are moved, fast ones that are not would be rounding.
        let mut moved: Vec<usize> = (0..self.states.len()).filter(|row| self.b[*row][input] != 0.0).collect();
        let mut next = 0;
        while let Some(&by) = moved.get(next) {
            next += 1;
            for row in 0..self.states.len() {
                if self.a[row][by] != 0.0 && !moved.contains(&row) {
                    moved.push(row);
                }
            }
        }
        let n = moved.len();
        let a = DMatrix::from_fn(n, n, |row, column| self.a[moved[row]][moved[column]]);
        rank(a, DVector::from_fn(n, |row, _| self.b[moved[row]][input]))
    }

    /// What one input reaches, with the usual size of each state.
    pub(crate) fn controllability(&self, input: usize, usual: &[UsualSize]) -> Result<Controllability, Error> {
        let n = self.states.len();
        let fastest = self.poles()?.first().map_or(0.0, Pole::natural_frequency);
        let rate = if fastest > 0.0 { fastest } else { 1.0 };
        let size = |state: usize| {
            let UsualSize { size, is_rate } = usual[state];
            if is_rate { size * rate } else { size }
        };
        let a = DMatrix::from_fn(n, n, |row, column| self.a[row][column] * size(column) / (size(row) * rate));
        let mut column = DVector::from_fn(n, |row, _| self.b[row][input] / size(row));
        let mut reach = DMatrix::zeros(n, n);
        let largest = column.norm();
        for power in 0..n {
            reach.set_column(power, &column);
            column = &a * column;
        }
        if largest == 0.0 {
            return Ok(Controllability { singular_values: alloc::vec![0.0; n], rank: 0, condition: f64::INFINITY });
        }
        let mut singular: Vec<f64> = reach.singular_values().iter().copied().collect();
        singular.sort_by(|a, b| b.total_cmp(a));
        let largest = singular.first().copied().unwrap_or(0.0);
        let singular_values: Vec<f64> = singular.iter().map(|value| value / largest).collect();
        let rank = self.reached(input);
        let condition = match singular_values.last() {
            Some(least) if rank == n && *least > ROUNDING => 1.0 / least,
            _ => f64::INFINITY,
        };
        Ok(Controllability { singular_values, rank, condition })
    }
}

/// How many states of `x' = A x + b u` the input moves independently: one and the leading entries below the diagonal of the staircase
/// form. States that differ much in size are balanced first.
fn rank(mut a: DMatrix<f64>, mut b: DVector<f64>) -> usize {
    if a.nrows() < 2 {
        return a.nrows();
    }
    let sizes = balance_parlett_reinsch(&mut a);
    b.component_div_assign(&sizes);
    let length = b.norm();
    // The reflection that turns b into the first axis, of the two the one without cancellation.
    b[0] += if b[0] < 0.0 { -length } else { length };
    let length = b.norm();
    b /= length;
    let by_rows = &a - (&b * 2.0) * b.tr_mul(&a);
    let turned = &by_rows - (&by_rows * &b) * (b.transpose() * 2.0);
    let small = UNMOVED * turned.norm();
    let staircase = Hessenberg::new(turned).unpack_h();
    let moved = (1..staircase.nrows()).take_while(|row| staircase[(*row, row - 1)].abs() > small);
    1 + moved.count()
}

/// `(s I − T)⁻¹ b` for a real Schur form T: upper triangular but for blocks of two rows on the diagonal.
fn resolvent(triangle: &DMatrix<f64>, s: Complex<f64>, b: &DVector<f64>) -> Vec<Complex<f64>> {
    let mut x: Vec<Complex<f64>> = b.iter().map(|value| Complex::new(*value, 0.0)).collect();
    let mut left = x.len();
    while left > 0 {
        let last = left - 1;
        let first = if last > 0 && triangle[(last, last - 1)] != 0.0 { last - 1 } else { last };
        if first == last {
            x[last] /= s - triangle[(last, last)];
        } else {
            let [own, other] = [s - triangle[(first, first)], s - triangle[(last, last)]];
            let [above, below] = [triangle[(first, last)], triangle[(last, first)]];
            let determinant = own * other - above * below;
            let [upper, lower] = [x[first], x[last]];
            x[first] = (upper * other + lower * above) / determinant;
            x[last] = (lower * own + upper * below) / determinant;
        }
        for row in 0..first {
            for column in first..left {
                let by = x[column] * triangle[(row, column)];
                x[row] += by;
            }
        }
        left = first;
    }
    x
}
