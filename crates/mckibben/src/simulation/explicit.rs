//! The explicit method: Dormand & Prince's pair of order 8 with error estimates of orders 5 and 3 (DOP853).
//!
//! Twelve evaluations a step, the thirteenth is the next step's first; three more make the dense output of order 7.
//! Source: Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I* (1993), section II.10; the coefficients
//! are the published ones, rounded to `f64`.
//! Checked by `tests/integrator.rs`: order 8 of the solution and of the dense output fitted on a problem in closed form.

use super::arc::{Arc, Nested};
use crate::scalar::{Real, Scalar};

/// An attempted step; kept from step to step, so that nothing is moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attempt<R, const N: usize> {
    stages: [[R; N]; 16],
    /// The states at the end of the step.
    pub(super) end: [R; N],
    /// Error over the tolerance; at most 1 for a step that may be kept. NaN when the step left the physics.
    pub(super) error: f64,
}

/// Evaluations of an attempted step, and those that accepting it adds.
pub(super) const EVALUATIONS: (u64, u64) = (11, 4);

// The sums are formed in two halves that run side by side: each is a chain of additions.
macro_rules! weighted {
    ($stages:ident, $n:ident; $($stage:literal: $weight:expr),+) => {
        R::zero() $(+ R::constant($weight) * $stages[$stage][$n])+
    };
}

macro_rules! advance {
    ($stages:ident, $start:ident, $step:ident; $($stage:literal: $weight:expr),+) => {
        core::array::from_fn(|n| $start[n] + $step * weighted!($stages, n; $($stage: $weight),+))
    };
    ($stages:ident, $start:ident, $step:ident; $($stage:literal: $weight:expr),+; $($second:literal: $other:expr),+) => {
        core::array::from_fn(|n| {
            let first = weighted!($stages, n; $($stage: $weight),+);
            $start[n] + $step * (first + weighted!($stages, n; $($second: $other),+))
        })
    };
}

macro_rules! combine {
    ($stages:ident, $step:ident; $($stage:literal: $weight:expr),+; $($second:literal: $other:expr),+) => {
        core::array::from_fn(|n| {
            let first = weighted!($stages, n; $($stage: $weight),+);
            $step * (first + weighted!($stages, n; $($second: $other),+))
        })
    };
}

macro_rules! difference {
    ($stages:ident, $n:ident; $($stage:literal: $weight:expr),+) => {
        0.0 $(+ $weight * $stages[$stage][$n].value())+
    };
}

impl<R: Real, const N: usize> Attempt<R, N> {
    /// No step yet.
    pub(super) fn new() -> Self {
        Self { stages: [[R::zero(); N]; 16], end: [R::zero(); N], error: f64::NAN }
    }

    /// Attempts a step of length `step` from `start`, where the rates are `slope`.
    #[inline]
    #[allow(clippy::too_many_arguments)]
    pub(super) fn attempt(
        &mut self,
        time: R,
        start: &[R; N],
        slope: &[R; N],
        step: R,
        allowed: &[f64; N],
        mut rates: impl FnMut(R, &[R; N]) -> [R; N],
    ) {
        let k = &mut self.stages;
        k[0] = *slope;
        let mut state: [R; N];
        state = advance!(k, start, step;
        0: 0.05260015195876773);
        k[1] = rates(time + step * R::constant(0.05260015195876773), &state);
        state = advance!(k, start, step;
        0: 0.0197250569845379, 1: 0.0591751709536137);
        k[2] = rates(time + step * R::constant(0.0789002279381516), &state);
        state = advance!(k, start, step;
        0: 0.02958758547680685, 2: 0.08876275643042054);
        k[3] = rates(time + step * R::constant(0.1183503419072274), &state);
        state = advance!(k, start, step;
        0: 0.2413651341592667, 2: -0.8845494793282861, 3: 0.924834003261792);
        k[4] = rates(time + step * R::constant(0.2816496580927726), &state);
        state = advance!(k, start, step;
        0: 0.037037037037037035, 3: 0.17082860872947386, 4: 0.12546768756682242);
        k[5] = rates(time + step * R::constant(0.3333333333333333), &state);
        state = advance!(k, start, step;
            0: 0.037109375, 3: 0.17025221101954405;
            4: 0.06021653898045596, 5: -0.017578125);
        k[6] = rates(time + step * R::constant(0.25), &state);
        state = advance!(k, start, step;
            0: 0.03709200011850479, 3: 0.17038392571223998, 4: 0.10726203044637328;
            5: -0.015319437748624402, 6: 0.008273789163814023);
        k[7] = rates(time + step * R::constant(0.3076923076923077), &state);
        state = advance!(k, start, step;
            0: 0.6241109587160757, 3: -3.3608926294469414, 4: -0.868219346841726;
            5: 27.59209969944671, 6: 20.154067550477894, 7: -43.48988418106996);
        k[8] = rates(time + step * R::constant(0.6512820512820513), &state);
        state = advance!(k, start, step;
            0: 0.47766253643826434, 3: -2.4881146199716677, 4: -0.590290826836843, 5: 21.230051448181193;
            6: 15.279233632882423, 7: -33.28821096898486, 8: -0.020331201708508627);
        k[9] = rates(time + step * R::constant(0.6), &state);
        state = advance!(k, start, step;
            0: -0.9371424300859873, 3: 5.186372428844064, 4: 1.0914373489967295, 5: -8.149787010746927;
            6: -18.52006565999696, 7: 22.739487099350505, 8: 2.4936055526796523, 9: -3.0467644718982196);
        k[10] = rates(time + step * R::constant(0.8571428571428571), &state);
        state = advance!(k, start, step;
            0: 2.273310147516538, 3: -10.53449546673725, 4: -2.0008720582248625, 5: -17.9589318631188, 6: 27.94888452941996;
            7: -2.8589982771350235, 8: -8.87285693353063, 9: 12.360567175794303, 10: 0.6433927460157636);
        k[11] = rates(time + step * R::constant(1.0), &state);
        let end: [R; N] = advance!(k, start, step;
            0: 0.054293734116568765, 5: 4.450312892752409, 6: 1.8915178993145003, 7: -5.801203960010585;
            8: 0.3111643669578199, 9: -0.1521609496625161, 10: 0.20136540080403034, 11: 0.04471061572777259);
        let (mut fifth, mut third) = (0.0, 0.0);
        for n in 0..N {
            let scale = allowed[n];
            let of_order_5 = difference!(k, n;
            0: 0.01312004499419488, 5: -1.2251564463762044, 6: -0.4957589496572502, 7: 1.6643771824549864,
            8: -0.35032884874997366, 9: 0.3341791187130175, 10: 0.08192320648511571, 11: -0.022355307863886294);
            let of_order_3 = difference!(k, n;
            0: -0.18980075407240762, 5: 4.450312892752409, 6: 1.8915178993145003, 7: -5.801203960010585,
            8: -0.4226823213237919, 9: -0.1521609496625161, 10: 0.20136540080403034, 11: 0.02265179219836082);
            fifth += (of_order_5 / scale) * (of_order_5 / scale);
            third += (of_order_3 / scale) * (of_order_3 / scale);
        }
        let denominator = fifth + 0.01 * third;
        let error =
            if denominator == 0.0 { 0.0 } else { step.value().abs() * fifth / Scalar::sqrt(denominator * N as f64) };
        self.end = end;
        self.error = error;
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
        let k = &mut self.stages;
        k[12] = rates(time + step, &self.end);
        let mut state: [R; N];
        state = advance!(k, start, step;
            0: 0.056167502283047954, 6: 0.25350021021662483, 7: -0.2462390374708025, 8: -0.12419142326381637;
            9: 0.15329179827876568, 10: 0.00820105229563469, 11: 0.007567897660545699, 12: -0.008298);
        k[13] = rates(time + step * R::constant(0.1), &state);
        state = advance!(k, start, step;
            0: 0.03183464816350214, 5: 0.028300909672366776, 6: 0.053541988307438566, 7: -0.05492374857139099;
            10: -0.00010834732869724932, 11: 0.0003825710908356584, 12: -0.00034046500868740456, 13: 0.1413124436746325);
        k[14] = rates(time + step * R::constant(0.2), &state);
        state = advance!(k, start, step;
            0: -0.42889630158379194, 5: -4.697621415361164, 6: 7.683421196062599, 7: 4.06898981839711;
            8: 0.3567271874552811, 12: -0.0013990241651590145, 13: 2.9475147891527724, 14: -9.15095847217987);
        k[15] = rates(time + step * R::constant(0.7777777777777778), &state);
        let rise: [R; N] = core::array::from_fn(|n| self.end[n] - start[n]);
        let bend: [R; N] = core::array::from_fn(|n| step * k[0][n] - rise[n]);
        let twist: [R; N] = core::array::from_fn(|n| rise[n] - step * k[12][n] - bend[n]);
        let d0: [R; N] = combine!(k, step;
            0: -8.428938276109013, 5: 0.5667149535193777, 6: -3.0689499459498917, 7: 2.38466765651207, 8: 2.117034582445028, 9: -0.871391583777973;
            10: 2.2404374302607883, 11: 0.6315787787694688, 12: -0.08899033645133331, 13: 18.148505520854727, 14: -9.194632392478356, 15: -4.436036387594894);
        let d1: [R; N] = combine!(k, step;
            0: 10.427508642579134, 5: 242.28349177525817, 6: 165.20045171727028, 7: -374.5467547226902, 8: -22.113666853125306, 9: 7.733432668472264;
            10: -30.674084731089398, 11: -9.332130526430229, 12: 15.697238121770845, 13: -31.139403219565178, 14: -9.35292435884448, 15: 35.81684148639408);
        let d2: [R; N] = combine!(k, step;
            0: 19.985053242002433, 5: -387.0373087493518, 6: -189.17813819516758, 7: 527.8081592054236, 8: -11.57390253995963, 9: 6.8812326946963;
            10: -1.0006050966910838, 11: 0.7777137798053443, 12: -2.778205752353508, 13: -60.19669523126412, 14: 84.32040550667716, 15: 11.99229113618279);
        let d3: [R; N] = combine!(k, step;
            0: -25.69393346270375, 5: -154.18974869023643, 6: -231.5293791760455, 7: 357.6391179106141, 8: 93.40532418362432, 9: -37.45832313645163;
            10: 104.0996495089623, 11: 29.8402934266605, 12: -43.53345659001114, 13: 96.32455395918828, 14: -39.17726167561544, 15: -149.72683625798564);
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
        (arc, self.stages[12])
    }
}
