//! The explicit method: Dormand & Prince's pair of order 8 with error estimates of orders 5 and 3 (DOP853).
//!
//! Twelve evaluations a step, the thirteenth is the next step's first; three more make the dense output of order 7.
//! Source: Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I* (1993), section II.10; the coefficients
//! are the published ones, rounded to `f64`.
//! Checked by `tests/integrator.rs`: order 8 of the solution and of the dense output fitted on a problem in closed form.

use super::arc::{Arc, Nested};
use crate::scalar::{Real, Scalar};

/// Stages of a step, and those that the dense output adds.
const STAGES: usize = 12;
const ALL_STAGES: usize = 16;

/// A stage: its node, the first stage beside the zeroth that it uses, and the weights of the zeroth and of the stages from
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

/// First of the stages beside the zeroth that the estimates and the dense output use.
const LATE: usize = 5;

/// An attempted step; kept from step to step, so that nothing is moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attempt<R, const N: usize> {
    stages: [[R; N]; ALL_STAGES],
    /// The states at the end of the step.
    pub(super) end: [R; N],
    /// Error over the tolerance; at most 1 for a step that may be kept. NaN when the step left the physics.
    pub(super) error: f64,
}

/// Evaluations of an attempted step, and those that accepting it adds.
pub(super) const EVALUATIONS: (u64, u64) = (11, 4);

/// `w₀ k₀ + Σ wᵢ kᵢ`, the sum over the stages from `from` on; in two halves that run side by side.
#[inline(always)]
fn weighted<R: Real, const N: usize>(stages: &[[R; N]; ALL_STAGES], from: usize, weights: &[f64]) -> [R; N] {
    let mut even = stages[0].map(|rate| R::constant(weights[0]) * rate);
    let mut odd = [R::zero(); N];
    let (weights, used) = (&weights[1..], &stages[from..]);
    for (weight, rate) in weights.chunks(2).zip(used.chunks(2)) {
        for n in 0..N {
            even[n] = even[n] + R::constant(weight[0]) * rate[0][n];
        }
        if let ([_, weight], [_, rate, ..]) = (weight, rate) {
            for n in 0..N {
                odd[n] = odd[n] + R::constant(*weight) * rate[n];
            }
        }
    }
    core::array::from_fn(|n| even[n] + odd[n])
}

impl<R: Real, const N: usize> Attempt<R, N> {
    /// No step yet.
    pub(super) fn new() -> Self {
        Self { stages: [[R::zero(); N]; ALL_STAGES], end: [R::zero(); N], error: f64::NAN }
    }

    /// The states at a stage.
    #[inline(always)]
    fn state(&self, start: &[R; N], step: R, stage: &Stage) -> [R; N] {
        let slope = weighted(&self.stages, stage.from, stage.weights);
        core::array::from_fn(|n| start[n] + step * slope[n])
    }

    /// Attempts a step of length `step` from `start`, where the rates are `slope`; `allowed` are the errors that the states
    /// with a meaning may have.
    #[inline]
    pub(super) fn attempt(
        &mut self,
        time: R,
        start: &[R; N],
        slope: &[R; N],
        step: R,
        allowed: &[f64],
        mut rates: impl FnMut(R, &[R; N]) -> [R; N],
    ) {
        self.stages[0] = *slope;
        for (index, stage) in (1..STAGES).zip(&TABLEAU) {
            let state = self.state(start, step, stage);
            self.stages[index] = rates(time + step * R::constant(stage.node), &state);
        }
        self.end = self.state(start, step, &TABLEAU[STAGES - 1]);
        let of_order_5 = weighted(&self.stages, LATE, &ORDER_5);
        let of_order_3 = weighted(&self.stages, LATE, &ORDER_3);
        let (mut fifth, mut third) = (0.0, 0.0);
        for n in 0..allowed.len() {
            let (five, three) = (of_order_5[n].value() / allowed[n], of_order_3[n].value() / allowed[n]);
            fifth += five * five;
            third += three * three;
        }
        let denominator = fifth + 0.01 * third;
        self.error = if denominator == 0.0 {
            0.0
        } else {
            step.value().abs() * fifth / Scalar::sqrt(denominator * allowed.len() as f64)
        };
    }

    /// Accepts the step: its dense output, and the rates at its end.
    #[inline]
    pub(super) fn accept(
        &mut self,
        time: R,
        start: &[R; N],
        step: R,
        mut rates: impl FnMut(R, &[R; N]) -> [R; N],
    ) -> (Arc<R, N>, [R; N]) {
        for (index, stage) in (STAGES..ALL_STAGES).zip(&TABLEAU[STAGES - 1..]) {
            let state = if index == STAGES { self.end } else { self.state(start, step, stage) };
            self.stages[index] = rates(time + step * R::constant(stage.node), &state);
        }
        let (first, last) = (self.stages[0], self.stages[STAGES]);
        let rise: [R; N] = core::array::from_fn(|n| self.end[n] - start[n]);
        let bend: [R; N] = core::array::from_fn(|n| step * first[n] - rise[n]);
        let twist: [R; N] = core::array::from_fn(|n| rise[n] - step * last[n] - bend[n]);
        let [d0, d1, d2, d3] = DENSE.map(|weights| weighted(&self.stages, LATE, &weights).map(|slope| step * slope));
        let mut nested = Nested::constant(d3);
        let arc = nested
            .times_theta()
            .plus(d2)
            .times_rest()
            .plus(d1)
            .times_theta()
            .plus(d0)
            .times_rest()
            .plus(twist)
            .times_theta()
            .plus(bend)
            .times_rest()
            .plus(rise)
            .times_theta()
            .plus(*start)
            .arc(time, step);
        (arc, last)
    }
}
