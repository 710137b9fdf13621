//! The explicit method: Dormand & Prince's pair of order 8 with error estimates of orders 5 and 3 (DOP853).
//!
//! Twelve evaluations a step, the thirteenth is the next step's first; three more make the dense output of order 7. Its
//! control points are sums of the stages with constant weights: those at both ends are the states and slopes there.
//! Source: Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I* (1993), section II.10; the coefficients
//! are the published ones, rounded to `f64`.

use super::allowed::Allowed;
use super::arc::{Arc, POINTS};
use crate::scalar::{Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// Stages of a step, and those that the dense output adds.
const STAGES: usize = 12;
const ALL_STAGES: usize = 16;

/// A stage: its node, the first stage other than the zeroth that it uses, and the weights of the zeroth and of the stages from
/// that one up to itself.
struct Stage<const N: usize> {
    node: f64,
    from: usize,
    weights: [f64; N],
}

/// Stages 1 to 15; the twelfth is the solution itself.
#[rustfmt::skip]
const STAGE_1: Stage<1> = Stage { node: 0.05260015195876773, from: 1, weights: [
        0.05260015195876773,
] };
#[rustfmt::skip]
const STAGE_2: Stage<2> = Stage { node: 0.0789002279381516, from: 1, weights: [
        0.0197250569845379, 0.0591751709536137,
] };
#[rustfmt::skip]
const STAGE_3: Stage<2> = Stage { node: 0.1183503419072274, from: 2, weights: [
        0.02958758547680685, 0.08876275643042054,
] };
#[rustfmt::skip]
const STAGE_4: Stage<3> = Stage { node: 0.2816496580927726, from: 2, weights: [
        0.2413651341592667, -0.8845494793282861, 0.924834003261792,
] };
#[rustfmt::skip]
const STAGE_5: Stage<3> = Stage { node: 0.3333333333333333, from: 3, weights: [
        0.037037037037037035, 0.17082860872947386, 0.12546768756682242,
] };
#[rustfmt::skip]
const STAGE_6: Stage<4> = Stage { node: 0.25, from: 3, weights: [
        0.037109375, 0.17025221101954405, 0.06021653898045596, -0.017578125,
] };
#[rustfmt::skip]
const STAGE_7: Stage<5> = Stage { node: 0.3076923076923077, from: 3, weights: [
        0.03709200011850479, 0.17038392571223998, 0.10726203044637328, -0.015319437748624402, 0.008273789163814023,
] };
#[rustfmt::skip]
const STAGE_8: Stage<6> = Stage { node: 0.6512820512820513, from: 3, weights: [
        0.6241109587160757, -3.3608926294469414, -0.868219346841726, 27.59209969944671, 20.154067550477894,
        -43.48988418106996,
] };
#[rustfmt::skip]
const STAGE_9: Stage<7> = Stage { node: 0.6, from: 3, weights: [
        0.47766253643826434, -2.4881146199716677, -0.590290826836843, 21.230051448181193, 15.279233632882423,
        -33.28821096898486, -0.020331201708508627,
] };
#[rustfmt::skip]
const STAGE_10: Stage<8> = Stage { node: 0.8571428571428571, from: 3, weights: [
        -0.9371424300859873, 5.186372428844064, 1.0914373489967295, -8.149787010746927, -18.52006565999696,
        22.739487099350505, 2.4936055526796523, -3.0467644718982196,
] };
#[rustfmt::skip]
const STAGE_11: Stage<9> = Stage { node: 1.0, from: 3, weights: [
        2.273310147516538, -10.53449546673725, -2.0008720582248625, -17.9589318631188, 27.94888452941996,
        -2.8589982771350235, -8.87285693353063, 12.360567175794303, 0.6433927460157636,
] };
#[rustfmt::skip]
const STAGE_12: Stage<8> = Stage { node: 1.0, from: 5, weights: [
        0.054293734116568765, 4.450312892752409, 1.8915178993145003, -5.801203960010585, 0.3111643669578199,
        -0.1521609496625161, 0.20136540080403034, 0.04471061572777259,
] };
#[rustfmt::skip]
const STAGE_13: Stage<8> = Stage { node: 0.1, from: 6, weights: [
        0.056167502283047954, 0.25350021021662483, -0.2462390374708025, -0.12419142326381637, 0.15329179827876568,
        0.00820105229563469, 0.007567897660545699, -0.008298,
] };
#[rustfmt::skip]
const STAGE_14: Stage<10> = Stage { node: 0.2, from: 5, weights: [
        0.03183464816350214, 0.028300909672366776, 0.053541988307438566, -0.05492374857139099, 0.0, 0.0,
        -0.00010834732869724932, 0.0003825710908356584, -0.00034046500868740456, 0.1413124436746325,
] };
#[rustfmt::skip]
const STAGE_15: Stage<11> = Stage { node: 0.7777777777777778, from: 5, weights: [
        -0.42889630158379194, -4.697621415361164, 7.683421196062599, 4.06898981839711, 0.3567271874552811, 0.0, 0.0,
        0.0, -0.0013990241651590145, 2.9475147891527724, -9.15095847217987,
] };

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

/// Weights of one of the control points 2 to 5.
#[derive(Clone, Copy, Debug)]
struct Weights {
    start: f64,
    rise: f64,
    /// Of stage 0 and of stages 5 to 15.
    stages: [f64; 12],
}

/// Evaluations of an attempted step, of its end, and of its dense output.
pub(super) const EVALUATIONS: [u64; 3] = [11, 1, 3];

/// Rates of [`LANES`] states at all stages.
type Block<R> = [[R; LANES]; ALL_STAGES];

/// An attempted step; kept from step to step, so that nothing is moved.
#[derive(Clone, Debug)]
pub(super) struct Attempt<R> {
    blocks: Vec<Block<R>>,
    /// The states of a stage and their rates, padded to whole lanes.
    stage: Vec<R>,
    rates: Vec<R>,
    /// The states at the end of the step, padded likewise.
    pub(super) end: Vec<R>,
    /// Error over the tolerance; at most 1 for a step that may be kept. NaN when the step is not physical.
    pub(super) error: f64,
    weights: [Weights; 4],
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
fn weights() -> [Weights; 4] {
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
    core::array::from_fn(|i| {
        let terms = form.points[i + 2];
        let mut stages = [0.0; 12];
        stages.copy_from_slice(&terms[4..]);
        stages[0] += terms[2];
        stages[1 + STAGES - LATE] += terms[3];
        Weights { start: terms[0], rise: terms[1], stages }
    })
}

/// `w₀ k₀ + Σ wᵢ kᵢ`, the sum over the stages from `from` on.
#[inline(always)]
fn weighted<R: Real, const N: usize>(block: &Block<R>, from: usize, weights: &[f64; N]) -> [R; LANES] {
    // Two sums, so that one need not wait for the other; loops over states inside, so that they go side by side.
    let mut sums = [[R::zero(); LANES]; 2];
    for n in 0..LANES {
        sums[0][n] = R::constant(weights[0]) * block[0][n];
    }
    for i in 1..N {
        let (sum, rates) = (&mut sums[i % 2], &block[from + i - 1]);
        for n in 0..LANES {
            sum[n] = sum[n] + R::constant(weights[i]) * rates[n];
        }
    }
    let [mut even, odd] = sums;
    for n in 0..LANES {
        even[n] = even[n] + odd[n];
    }
    even
}

/// `start + step · slope` of each block.
#[inline(always)]
fn combine<R: Real, const N: usize>(blocks: &[Block<R>], start: &[R], step: R, stage: &Stage<N>, into: &mut [R]) {
    for ((block, start), into) in blocks.iter().zip(start.chunks_exact(LANES)).zip(into.chunks_exact_mut(LANES)) {
        let slope = weighted(block, stage.from, &stage.weights);
        for n in 0..LANES {
            into[n] = start[n] + step * slope[n];
        }
    }
}

/// Keeps rates as those of a stage.
#[inline(always)]
fn keep<R: Real>(blocks: &mut [Block<R>], index: usize, rates: &[R]) {
    for (block, rates) in blocks.iter_mut().zip(rates.chunks_exact(LANES)) {
        block[index].copy_from_slice(rates);
    }
}

/// A step: where it starts, and its length.
#[derive(Clone, Copy)]
struct Step<'s, R> {
    time: R,
    start: &'s [R],
    length: R,
    states: usize,
}

impl<R: Real> Attempt<R> {
    /// Room for so many states.
    pub(super) fn new(states: usize) -> Self {
        let blocks = states.div_ceil(LANES);
        let zeros = || vec![R::zero(); blocks * LANES];
        Self {
            blocks: vec![[[R::zero(); LANES]; ALL_STAGES]; blocks],
            stage: zeros(),
            rates: zeros(),
            end: zeros(),
            error: f64::NAN,
            weights: weights(),
        }
    }

    /// Copies the rates at the end of the step, which are those of the next step's start.
    pub(super) fn last(&self, into: &mut [R]) {
        for (block, into) in self.blocks.iter().zip(into.chunks_exact_mut(LANES)) {
            into.copy_from_slice(&block[STAGES]);
        }
    }

    /// Computes the rates of a stage.
    #[inline(always)]
    fn stage<const N: usize>(
        &mut self,
        Step { time, start, length, states }: Step<'_, R>,
        index: usize,
        stage: &Stage<N>,
        rates: &mut impl FnMut(R, &[R], &mut [R]),
    ) {
        combine(&self.blocks, start, length, stage, &mut self.stage);
        rates(time + length * R::constant(stage.node), &self.stage[..states], &mut self.rates[..states]);
        keep(&mut self.blocks, index, &self.rates);
    }

    /// Attempts a step of length `length` from `start`, where the rates are `slope`; `allowed` are the errors that the states
    /// may have. `rates` computes the rates of a stage.
    pub(super) fn attempt(
        &mut self,
        time: R,
        start: &[R],
        slope: &[R],
        length: R,
        allowed: &Allowed,
        mut rates: impl FnMut(R, &[R], &mut [R]),
    ) {
        let states = allowed.states.len();
        keep(&mut self.blocks, 0, slope);
        let step = Step { time, start, length, states };
        self.stage(step, 1, &STAGE_1, &mut rates);
        self.stage(step, 2, &STAGE_2, &mut rates);
        self.stage(step, 3, &STAGE_3, &mut rates);
        self.stage(step, 4, &STAGE_4, &mut rates);
        self.stage(step, 5, &STAGE_5, &mut rates);
        self.stage(step, 6, &STAGE_6, &mut rates);
        self.stage(step, 7, &STAGE_7, &mut rates);
        self.stage(step, 8, &STAGE_8, &mut rates);
        self.stage(step, 9, &STAGE_9, &mut rates);
        self.stage(step, 10, &STAGE_10, &mut rates);
        self.stage(step, 11, &STAGE_11, &mut rates);
        combine(&self.blocks, start, length, &STAGE_12, &mut self.end);
        let of_values = self.error_of(length, &allowed.states, R::value);
        let of_slopes = |direction| self.error_of(length, &allowed.states, |number| number.slope(direction));
        self.error = allowed.largest(of_values, &self.end[..states], of_slopes);
    }

    /// The error of a part of the states over what is allowed.
    fn error_of(&self, length: R, allowed: &[f64], part: impl Fn(R) -> f64) -> f64 {
        let (mut fifth, mut third) = (0.0, 0.0);
        for (block, allowed) in self.blocks.iter().zip(allowed.chunks(LANES)) {
            let five = weighted(block, LATE, &ORDER_5);
            let three = weighted(block, LATE, &ORDER_3);
            for ((five, three), allowed) in five.iter().zip(&three).zip(allowed) {
                let (five, three) = (part(*five) / allowed, part(*three) / allowed);
                fifth += five * five;
                third += three * three;
            }
        }
        let denominator = fifth + 0.01 * third;
        if denominator == 0.0 {
            return 0.0;
        }
        length.value().abs() * fifth / Scalar::sqrt(denominator * allowed.len() as f64)
    }

    /// Computes the rates at the end of the step.
    pub(super) fn finish(&mut self, time: R, length: R, states: usize, mut rates: impl FnMut(R, &[R], &mut [R])) {
        rates(time + length, &self.end[..states], &mut self.rates[..states]);
        keep(&mut self.blocks, STAGES, &self.rates);
    }

    /// The dense output.
    pub(super) fn dense(
        &mut self,
        time: R,
        start: &[R],
        length: R,
        arc: &mut Arc<R>,
        mut rates: impl FnMut(R, &[R], &mut [R]),
    ) {
        let states = arc.points.len() / POINTS;
        let step = Step { time, start, length, states };
        self.stage(step, 13, &STAGE_13, &mut rates);
        self.stage(step, 14, &STAGE_14, &mut rates);
        self.stage(step, 15, &STAGE_15, &mut rates);
        (arc.start, arc.step) = (time, length);
        let seventh = length * R::constant(1.0 / 7.0);
        let ends = start.chunks_exact(LANES).zip(self.end.chunks_exact(LANES));
        for (lane, (block, (start, end))) in self.blocks.iter().zip(ends).enumerate() {
            let mut points = [[R::zero(); LANES]; POINTS];
            for n in 0..LANES {
                points[0][n] = start[n];
                points[1][n] = start[n] + seventh * block[0][n];
                points[6][n] = end[n] - seventh * block[STAGES][n];
                points[7][n] = end[n];
            }
            for (point, weights) in points[2..6].iter_mut().zip(&self.weights) {
                let sum = weighted(block, LATE, &weights.stages);
                for n in 0..LANES {
                    let between =
                        R::constant(weights.start) * start[n] + R::constant(weights.rise) * (end[n] - start[n]);
                    point[n] = between + length * sum[n];
                }
            }
            let from = lane * LANES;
            let count = LANES.min(states - from);
            for (place, point) in points.iter().enumerate() {
                arc.points[place * states + from..place * states + from + count].copy_from_slice(&point[..count]);
            }
        }
    }
}
