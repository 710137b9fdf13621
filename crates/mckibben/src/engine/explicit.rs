//! The explicit method: Dormand & Prince's pair of order 8 with error estimates of orders 5 and 3 (DOP853).
//!
//! Twelve evaluations a step, the thirteenth is the next step's first; three more make the dense output of order 7. Its
//! control points are sums of the stages with constant weights: those at both ends are the states and slopes there.
//! Source: Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I* (1993), section II.10; the coefficients
//! are the published ones, rounded to `f64`.

use super::arc::{Arc, POINTS};
use crate::scalar::{Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// Stages of a step, and those that the dense output adds.
const STAGES: usize = 12;
const ALL_STAGES: usize = 16;

/// A stage: its node, the first stage other than the zeroth that it uses, and the weights of the zeroth and of the stages from
/// that one up to itself.
struct Stage {
    node: f64,
    from: usize,
    weights: &'static [f64],
}

/// Stages 1 to 15; the twelfth is the solution itself.
#[rustfmt::skip]
const TABLEAU: [Stage; ALL_STAGES - 1] = [
    Stage { node: 0.05260015195876773, from: 1, weights: &[
        0.05260015195876773,
    ] },
    Stage { node: 0.0789002279381516, from: 1, weights: &[
        0.0197250569845379, 0.0591751709536137,
    ] },
    Stage { node: 0.1183503419072274, from: 2, weights: &[
        0.02958758547680685, 0.08876275643042054,
    ] },
    Stage { node: 0.2816496580927726, from: 2, weights: &[
        0.2413651341592667, -0.8845494793282861, 0.924834003261792,
    ] },
    Stage { node: 0.3333333333333333, from: 3, weights: &[
        0.037037037037037035, 0.17082860872947386, 0.12546768756682242,
    ] },
    Stage { node: 0.25, from: 3, weights: &[
        0.037109375, 0.17025221101954405, 0.06021653898045596, -0.017578125,
    ] },
    Stage { node: 0.3076923076923077, from: 3, weights: &[
        0.03709200011850479, 0.17038392571223998, 0.10726203044637328, -0.015319437748624402, 0.008273789163814023,
    ] },
    Stage { node: 0.6512820512820513, from: 3, weights: &[
        0.6241109587160757, -3.3608926294469414, -0.868219346841726, 27.59209969944671, 20.154067550477894,
        -43.48988418106996,
    ] },
    Stage { node: 0.6, from: 3, weights: &[
        0.47766253643826434, -2.4881146199716677, -0.590290826836843, 21.230051448181193, 15.279233632882423,
        -33.28821096898486, -0.020331201708508627,
    ] },
    Stage { node: 0.8571428571428571, from: 3, weights: &[
        -0.9371424300859873, 5.186372428844064, 1.0914373489967295, -8.149787010746927, -18.52006565999696,
        22.739487099350505, 2.4936055526796523, -3.0467644718982196,
    ] },
    Stage { node: 1.0, from: 3, weights: &[
        2.273310147516538, -10.53449546673725, -2.0008720582248625, -17.9589318631188, 27.94888452941996,
        -2.8589982771350235, -8.87285693353063, 12.360567175794303, 0.6433927460157636,
    ] },
    Stage { node: 1.0, from: 5, weights: &[
        0.054293734116568765, 4.450312892752409, 1.8915178993145003, -5.801203960010585, 0.3111643669578199,
        -0.1521609496625161, 0.20136540080403034, 0.04471061572777259,
    ] },
    Stage { node: 0.1, from: 6, weights: &[
        0.056167502283047954, 0.25350021021662483, -0.2462390374708025, -0.12419142326381637, 0.15329179827876568,
        0.00820105229563469, 0.007567897660545699, -0.008298,
    ] },
    Stage { node: 0.2, from: 5, weights: &[
        0.03183464816350214, 0.028300909672366776, 0.053541988307438566, -0.05492374857139099, 0.0, 0.0,
        -0.00010834732869724932, 0.0003825710908356584, -0.00034046500868740456, 0.1413124436746325,
    ] },
    Stage { node: 0.7777777777777778, from: 5, weights: &[
        -0.42889630158379194, -4.697621415361164, 7.683421196062599, 4.06898981839711, 0.3567271874552811, 0.0,
        0.0, 0.0, -0.0013990241651590145, 2.9475147891527724, -9.15095847217987,
    ] },
];

/// Error estimate of order 5: weights of stage 0 and of stages 5 to 11.
#[rustfmt::skip]
const ORDER_5: [f64; 8] = [
    0.01312004499419488, -1.2251564463762044, -0.4957589496572502, 1.6643771824549864, -0.35032884874997366,
    0.3341791187130175, 0.08192320648511571, -0.022355307863886294,
];
/// Error estimate of order 3, likewise.
#[rustfmt::skip]
const ORDER_3: [f64; 8] = [
    -0.18980075407240762, 4.450312892752409, 1.8915178993145003, -5.801203960010585, -0.4226823213237919,
    -0.1521609496625161, 0.20136540080403034, 0.02265179219836082,
];
/// Dense output: weights of stage 0 and of stages 5 to 15.
#[rustfmt::skip]
const DENSE: [[f64; 12]; 4] = [
    [
        -8.428938276109013, 0.5667149535193777, -3.0689499459498917, 2.38466765651207, 2.117034582445028,
        -0.871391583777973, 2.2404374302607883, 0.6315787787694688, -0.08899033645133331, 18.148505520854727,
        -9.194632392478356, -4.436036387594894,
    ],
    [
        10.427508642579134, 242.28349177525817, 165.20045171727028, -374.5467547226902, -22.113666853125306,
        7.733432668472264, -30.674084731089398, -9.332130526430229, 15.697238121770845, -31.139403219565178,
        -9.35292435884448, 35.81684148639408,
    ],
    [
        19.985053242002433, -387.0373087493518, -189.17813819516758, 527.8081592054236, -11.57390253995963,
        6.8812326946963, -1.0006050966910838, 0.7777137798053443, -2.778205752353508, -60.19669523126412,
        84.32040550667716, 11.99229113618279,
    ],
    [
        -25.69393346270375, -154.18974869023643, -231.5293791760455, 357.6391179106141, 93.40532418362432,
        -37.45832313645163, 104.0996495089623, 29.8402934266605, -43.53345659001114, 96.32455395918828,
        -39.17726167561544, -149.72683625798564,
    ],
];

/// First of the stages, other than the zeroth, that the estimates and the dense output use.
const LATE: usize = 5;
/// Terms of a control point: start, rise, first and last stage, and the stages of the dense output.
const TERMS: usize = 4 + 12;
/// States that a sum takes together: what fits into registers.
const LANES: usize = 4;

/// Weights of the control points 2 to 5.
type Weights = [[f64; TERMS]; 4];

/// Evaluations of an attempted step, of its end, and of its dense output.
pub(super) const EVALUATIONS: [u64; 3] = [11, 1, 3];

/// An attempted step; kept from step to step, so that nothing is moved.
#[derive(Clone, Debug)]
pub(super) struct Attempt<R> {
    /// Rates of the stages, each in a row of `stride`.
    stages: Vec<R>,
    stride: usize,
    stage: Vec<R>,
    /// The states at the end of the step.
    pub(super) end: Vec<R>,
    /// Error over the tolerance; at most 1 for a step that may be kept. NaN when the step is not physical.
    pub(super) error: f64,
    weights: Weights,
}

/// The polynomial in the Bernstein basis whose coefficients are sums of the terms.
struct Form {
    degree: usize,
    points: [[f64; TERMS]; POINTS],
}

impl Form {
    fn times_theta(&mut self) {
        self.degree += 1;
        for i in (1..=self.degree).rev() {
            let weight = i as f64 / self.degree as f64;
            self.points[i] = self.points[i - 1].map(|term| weight * term);
        }
        self.points[0] = [0.0; TERMS];
    }

    fn times_rest(&mut self) {
        self.degree += 1;
        for i in 0..self.degree {
            let weight = (self.degree - i) as f64 / self.degree as f64;
            self.points[i] = self.points[i].map(|term| weight * term);
        }
        self.points[self.degree] = [0.0; TERMS];
    }

    fn plus(&mut self, term: [f64; TERMS]) {
        for point in &mut self.points[..=self.degree] {
            for (sum, term) in point.iter_mut().zip(term) {
                *sum += term;
            }
        }
    }
}

/// `y(θ) = y₀ + θ(rise + (1 − θ)(bend + θ(twist + (1 − θ)(d₀ + θ(d₁ + (1 − θ)(d₂ + θ d₃))))))` as control points.
fn weights() -> Weights {
    let term = |place: usize, value: f64| {
        let mut term = [0.0; TERMS];
        term[place] = value;
        term
    };
    let dense = |row: usize| {
        let mut term = [0.0; TERMS];
        term[4..].copy_from_slice(&DENSE[row]);
        term
    };
    let mut bend = term(1, -1.0);
    bend[2] = 1.0;
    // rise − h k₁₂ − bend
    let mut twist = term(1, 2.0);
    (twist[2], twist[3]) = (-1.0, -1.0);
    let mut form = Form { degree: 0, points: [dense(3); POINTS] };
    form.times_theta();
    form.plus(dense(2));
    form.times_rest();
    form.plus(dense(1));
    form.times_theta();
    form.plus(dense(0));
    form.times_rest();
    form.plus(twist);
    form.times_theta();
    form.plus(bend);
    form.times_rest();
    form.plus(term(1, 1.0));
    form.times_theta();
    form.plus(term(0, 1.0));
    debug_assert!(form.degree == POINTS - 1);
    core::array::from_fn(|i| form.points[i + 2])
}

impl<R: Real> Attempt<R> {
    /// Room for so many states.
    pub(super) fn new(states: usize) -> Self {
        let stride = states.div_ceil(LANES) * LANES;
        let zeros = || vec![R::zero(); stride];
        Self {
            stages: vec![R::zero(); ALL_STAGES * stride],
            stride,
            stage: zeros(),
            end: zeros(),
            error: f64::NAN,
            weights: weights(),
        }
    }

    /// Rates at the end of the step, which are those of the next step's start.
    pub(super) fn last(&self) -> &[R] {
        &self.stages[(STAGES) * self.stride..(STAGES + 1) * self.stride]
    }

    /// `w₀ k₀ + Σ wᵢ kᵢ` for [`LANES`] states from `lane` on, the sum over the stages from `from` on.
    #[inline(always)]
    fn weighted(&self, lane: usize, from: usize, weights: &[f64]) -> [R; LANES] {
        let row = |stage: usize| &self.stages[stage * self.stride + lane..stage * self.stride + lane + LANES];
        let (first, weight) = (row(0), R::constant(weights[0]));
        let mut even: [R; LANES] = core::array::from_fn(|n| weight * first[n]);
        let mut odd = [R::zero(); LANES];
        let mut stage = from;
        for pair in weights[1..].chunks(2) {
            let (near, weight) = (row(stage), R::constant(pair[0]));
            for n in 0..LANES {
                even[n] = even[n] + weight * near[n];
            }
            if let [_, weight] = pair {
                let (next, weight) = (row(stage + 1), R::constant(*weight));
                for n in 0..LANES {
                    odd[n] = odd[n] + weight * next[n];
                }
            }
            stage += 2;
        }
        core::array::from_fn(|n| even[n] + odd[n])
    }

    /// The states at a stage, from `start`.
    #[inline(always)]
    fn combine(&mut self, start: &[R], step: R, stage: &Stage, is_end: bool) {
        for lane in (0..self.stride).step_by(LANES) {
            let slope = self.weighted(lane, stage.from, stage.weights);
            let into = if is_end { &mut self.end } else { &mut self.stage };
            for n in 0..LANES {
                into[lane + n] = start[lane + n] + step * slope[n];
            }
        }
    }

    /// Attempts a step of length `step` from `start`, where the rates are `slope`; `allowed` are the errors that the states
    /// may have. `rates` computes the rates of a stage into its row.
    #[inline]
    pub(super) fn attempt(
        &mut self,
        time: R,
        start: &[R],
        slope: &[R],
        step: R,
        allowed: &[f64],
        mut rates: impl FnMut(R, &[R], &mut [R]),
    ) {
        self.stages[..slope.len()].copy_from_slice(slope);
        let states = allowed.len();
        for (index, stage) in (1..STAGES).zip(&TABLEAU) {
            self.combine(start, step, stage, false);
            let row = index * self.stride;
            rates(time + step * R::constant(stage.node), &self.stage[..states], &mut self.stages[row..row + states]);
        }
        self.combine(start, step, &TABLEAU[STAGES - 1], true);
        let (mut fifth, mut third) = (0.0, 0.0);
        for lane in (0..self.stride).step_by(LANES) {
            let five = self.weighted(lane, LATE, &ORDER_5);
            let three = self.weighted(lane, LATE, &ORDER_3);
            for n in 0..LANES.min(states - lane) {
                let (five, three) = (five[n].value() / allowed[lane + n], three[n].value() / allowed[lane + n]);
                fifth += five * five;
                third += three * three;
            }
        }
        let denominator = fifth + 0.01 * third;
        self.error = if denominator == 0.0 {
            0.0
        } else {
            step.value().abs() * fifth / Scalar::sqrt(denominator * states as f64)
        };
    }

    /// Computes the rates at the end of the step.
    #[inline]
    pub(super) fn finish(&mut self, time: R, step: R, states: usize, mut rates: impl FnMut(R, &[R], &mut [R])) {
        let row = STAGES * self.stride;
        rates(time + step, &self.end[..states], &mut self.stages[row..row + states]);
    }

    /// The dense output.
    #[inline]
    pub(super) fn dense(
        &mut self,
        time: R,
        start: &[R],
        step: R,
        arc: &mut Arc<R>,
        mut rates: impl FnMut(R, &[R], &mut [R]),
    ) {
        let states = arc.points.len() / POINTS;
        for (index, stage) in (STAGES + 1..ALL_STAGES).zip(&TABLEAU[STAGES..]) {
            self.combine(start, step, stage, false);
            let row = index * self.stride;
            rates(time + step * R::constant(stage.node), &self.stage[..states], &mut self.stages[row..row + states]);
        }
        (arc.start, arc.step) = (time, step);
        let seventh = step * R::constant(1.0 / 7.0);
        let last = STAGES * self.stride;
        for n in 0..states {
            let (from, to) = (start[n], self.end[n]);
            arc.points[n] = from;
            arc.points[states + n] = from + seventh * self.stages[n];
            arc.points[6 * states + n] = to - seventh * self.stages[last + n];
            arc.points[7 * states + n] = to;
        }
        for point in 0..4 {
            let weights = self.weights[point];
            for lane in (0..self.stride).step_by(LANES) {
                let dense: [f64; 12] =
                    core::array::from_fn(|i| if i == 0 { weights[4] + weights[2] } else { weights[4 + i] });
                let mut sum = self.weighted(lane, LATE, &dense);
                let row = &self.stages[last + lane..last + lane + LANES];
                for n in 0..LANES {
                    sum[n] = sum[n] + R::constant(weights[3]) * row[n];
                }
                for n in 0..LANES.min(states.saturating_sub(lane)) {
                    let (from, to) = (start[lane + n], self.end[lane + n]);
                    let ends = R::constant(weights[0]) * from + R::constant(weights[1]) * (to - from);
                    arc.points[(point + 2) * states + lane + n] = ends + step * sum[n];
                }
            }
        }
    }
}
