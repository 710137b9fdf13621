//! One step of a method in one mode, divided nowhere.
//!
//! | method | order | for |
//! |---|---|---|
//! | [`Method::Rk4`] | 4 | the paper's Runge–Kutta; needs `h` below the time constant of the air near equal pressure |
//! | [`Method::Stable`] | 2 | any `h` that a robot simulator uses: ROS2 |
//!
//! ROS2 is Verwer's two-stage Rosenbrock method, of order 2 for whatever matrix `A` stands in for the Jacobian:
//!
//! ```text
//! (I − γhA) k₁ = f(y)        (I − γhA) k₂ = f(y + h k₁) − 2 k₁        y⁺ = y + h (3k₁ + k₂)/2        γ = 1 + 1/√2
//! ```
//!
//! That freedom is used: `A` holds what is stiff ([`implicit`](super::implicit)), and for pressures the steeper of the tangent
//! and the secant of a flow, so that no flow overshoots the pressure beyond. With this γ the first stage goes at most 0.59 of
//! the way.
//!
//! A stage of RK4 without air in a chamber leaves what the laws describe: the step is too long, whatever it ends with.
//!
//! The second stage of ROS2 may still draw more air than there is, where a flow path empties a chamber many times over within the
//! step. A step that would leave less than an eighth of a pressure or of the air is replaced by backward Euler, linearly
//! implicit with γ = 1, in as few parts as stay positive.
//!
//! Source: Verwer, Spee, Blom & Hundsdorfer, SIAM J. Sci. Comput. 20 (1999). Checked by `tests/plant_steps.rs`.

use super::super::Plant;
use super::super::evaluation::{Evaluation, System};
use super::super::formulas::Formulas;
use super::super::mode::PlantMode;
use super::implicit::Implicit;
use crate::engine::Arc;
use crate::error::Error;
use crate::network::formulas::FlowFormulas;
use crate::scalar::{Mask, Real, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// How a step is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The classical Runge–Kutta method of order 4, as in the paper.
    Rk4,
    /// A linearly implicit method of order 2 that is stable at any step.
    Stable,
}

/// Part of a pressure and of the air that a step of ROS2 leaves at least, or is not believed. From the paper's supply to the
/// atmosphere at a constant temperature it is more than this.
const LEAST_SHARE: f64 = 0.125;
/// Parts of a step by backward Euler, at most.
const MOST_PARTS: u32 = 256;

/// The stages of a step.
#[derive(Clone, Debug)]
pub struct Stages<R: Scalar> {
    /// The slopes of up to four stages.
    slopes: [Vec<R>; 4],
    /// The state that a stage is evaluated at.
    state: Vec<R>,
    implicit: Implicit<R>,
    /// The evaluation of a second stage.
    second: Evaluation<R>,
}

/// A step's start in s and length in s.
type Span<R> = (R, R);

impl<R: Scalar> Stages<R> {
    /// Room for a plant.
    pub fn new(plant: &Plant<R>) -> Self {
        let zeros = vec![R::zero(); plant.indices().states];
        let slopes = core::array::from_fn(|_| zeros.clone());
        Self { slopes, state: zeros, implicit: Implicit::new(plant), second: Evaluation::new(plant) }
    }

    /// Takes on the numbers of another plant of equal structure.
    #[inline(always)]
    pub fn adapt(&mut self, plant: &Plant<R>) {
        self.second.adapt(plant);
        self.implicit.adapt(plant);
    }

    /// Takes a step to `end` without looking what comes of it; where the end is to be believed.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    pub fn take_unchecked(
        &mut self,
        system: &System<R>,
        method: Method,
        span: Span<R>,
        state: &[R],
        mode: &mut impl Formulas<R>,
        at: &mut Evaluation<R>,
        end: &mut [R],
    ) -> R::Mask {
        match method {
            Method::Rk4 => self.take_rk4(system, span, state, mode, at, end),
            Method::Stable => {
                self.take_ros2(system, span, state, mode, at, end);
                system.is_positive(state, end)
            }
        }
    }

    /// The slopes at the beginning of the last step of RK4 and at its end.
    pub(super) fn slopes_at_ends(
        &mut self,
        system: &System<R>,
        time: R,
        end: &[R],
        mode: &impl Formulas<R>,
        at: &mut Evaluation<R>,
    ) -> [&[R]; 2] {
        let [first, .., last] = &mut self.slopes;
        system.rates(time, end, mode, at, last);
        [first, last]
    }

    /// The classical Runge–Kutta method; whether every stage has air in all chambers and nodes. Where none has, the end is that
    /// stage, which leaves the physics.
    #[inline(always)]
    fn take_rk4(
        &mut self,
        system: &System<R>,
        (time, step): Span<R>,
        state: &[R],
        mode: &mut impl Formulas<R>,
        at: &mut Evaluation<R>,
        end: &mut [R],
    ) -> R::Mask {
        let (half, mut ahead) = (R::constant(0.5) * step, R::zero());
        let mut physical = R::Mask::splat(true);
        for stage in 0..4_usize {
            match stage.checked_sub(1) {
                None => self.state.copy_from_slice(state),
                Some(before) => axpy(&mut self.state, state, ahead, &self.slopes[before]),
            }
            physical = physical & system.has_air(&self.state);
            if !physical.any() {
                end.copy_from_slice(&self.state);
                return physical;
            }
            mode.enter_pieces(system, time + ahead, &self.state, at);
            system.rates(time + ahead, &self.state, mode, at, &mut self.slopes[stage]);
            ahead = if stage < 2 { half } else { step };
        }
        let (sixth, two) = (step * R::constant(1.0 / 6.0), R::constant(2.0));
        let [k1, k2, k3, k4] = &self.slopes;
        for n in 0..end.len() {
            let (outer, inner) = (k1[n] + k4[n], k2[n] + k3[n]);
            end[n] = inner.multiply_add(two, outer).multiply_add(sixth, state[n]);
        }
        physical
    }

    /// Verwer's Rosenbrock method of order 2.
    #[inline(always)]
    fn take_ros2(
        &mut self,
        system: &System<R>,
        (time, step): Span<R>,
        state: &[R],
        mode: &mut impl Formulas<R>,
        at: &mut Evaluation<R>,
        end: &mut [R],
    ) -> u64 {
        let gamma_h = step * R::constant(1.0 + core::f64::consts::FRAC_1_SQRT_2);
        let [first, k1, second, k2] = &mut self.slopes;
        mode.enter_pieces(system, time, state, at);
        system.rates(time, state, mode, at, first);
        self.implicit.factor(system, (time, gamma_h), state, mode, at);
        self.implicit.solve(system, mode, at, first, k1);
        axpy(&mut self.state, state, step, k1);
        mode.enter_pieces(system, time + step, &self.state, &mut self.second);
        system.rates(time + step, &self.state, mode, &mut self.second, second);
        for (second, k1) in second.iter_mut().zip(&*k1) {
            *second = k1.multiply_add(R::constant(-2.0), *second);
        }
        // Where poppets move, the second stage has the matrix of how far they have come: the order stays.
        let mut evaluations = 2;
        let under_way = mode.flows().is_under_way(time);
        if under_way.any() {
            // Others of a batch keep the matrix that they have.
            let late = R::select(under_way, time + step, time);
            mode.enter_pieces(system, late, state, at);
            system.evaluate(late, state, mode, at);
            self.implicit.factor(system, (late, gamma_h), state, mode, at);
            evaluations += 1;
        }
        self.implicit.solve(system, mode, at, second, k2);
        let half = step * R::constant(0.5);
        for n in 0..end.len() {
            end[n] = k1[n].multiply_add(R::constant(3.0), k2[n]).multiply_add(half, state[n]);
        }
        evaluations
    }
}

impl<R: Real> Stages<R> {
    /// Takes a step in a state to `end`; how many evaluations it took.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn take(
        &mut self,
        system: &System<R>,
        method: Method,
        span: Span<R>,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
        end: &mut [R],
    ) -> u64 {
        if method == Method::Rk4 {
            self.take_rk4(system, span, state, mode, at, end);
            return 4;
        }
        let evaluations = self.take_ros2(system, span, state, mode, at, end);
        if system.is_positive(state, end) {
            return evaluations;
        }
        evaluations + self.take_backward_euler(system, span, state, mode, at, end)
    }

    /// Backward Euler, linearly implicit, of order 1: a flow comes nearer to the pressure beyond and never passes it. One part
    /// stays positive, unless so much heat comes in meanwhile that the pressure stays while the air goes.
    fn take_backward_euler(
        &mut self,
        system: &System<R>,
        (time, step): Span<R>,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
        end: &mut [R],
    ) -> u64 {
        let (mut parts, mut part, mut evaluations) = (1, step, 0);
        loop {
            let (mut positive, mut now) = (true, time);
            self.state.copy_from_slice(state);
            for _ in 0..parts {
                let [first, slope, ..] = &mut self.slopes;
                system.enter_pieces(now, &self.state, mode, at);
                system.rates(now, &self.state, mode, at, first);
                self.implicit.factor(system, (now, part), &self.state, mode, at);
                self.implicit.solve(system, mode, at, first, slope);
                axpy(end, &self.state, part, slope);
                positive = positive && system.is_positive(&self.state, end);
                self.state.copy_from_slice(end);
                now = now + part;
                evaluations += 1;
            }
            if positive || parts == MOST_PARTS {
                return evaluations;
            }
            (parts, part) = (2 * parts, R::constant(0.5) * part);
        }
    }
}

/// `y + h k`.
#[inline(always)]
fn axpy<R: Scalar>(end: &mut [R], state: &[R], step: R, slope: &[R]) {
    for (end, (from, slope)) in end.iter_mut().zip(state.iter().zip(slope)) {
        *end = slope.multiply_add(step, *from);
    }
}

impl<R: Scalar> System<R> {
    /// Whether a step from one state to another leaves enough of every pressure and of all air to be believed.
    #[inline(always)]
    fn is_positive(&self, from: &[R], to: &[R]) -> R::Mask {
        let mut enough = R::Mask::splat(true);
        // No closures: they would be compiled separately, without the instructions of a batch.
        for here in &self.plant.places.actuators {
            enough = enough & (R::constant(LEAST_SHARE) * from[here.pressure]).lt(to[here.pressure]);
            enough = enough & (R::constant(LEAST_SHARE) * from[here.mass()]).lt(to[here.mass()]);
        }
        for &[_, place] in &self.plant.places.state_nodes {
            enough = enough & (R::constant(LEAST_SHARE) * from[place]).lt(to[place]);
        }
        enough
    }

    /// Whether a state has air in every chamber and node.
    #[inline(always)]
    fn has_air(&self, state: &[R]) -> R::Mask {
        let (zero, mut has) = (R::zero(), R::Mask::splat(true));
        for here in &self.plant.places.actuators {
            has = has & zero.lt(state[here.pressure]) & zero.lt(state[here.mass()]);
        }
        for &[_, place] in &self.plant.places.state_nodes {
            has = has & zero.lt(state[place]);
        }
        has
    }
}

/// Absolute pressure in Pa, or mass in kg, that the air of no state reaches: ten thousand atmospheres. Chosen.
pub const MOST_AIR: f64 = 1e9;

impl<R: Real> System<R> {
    /// The places of pressures and masses of air.
    pub fn places_of_air(&self) -> impl Iterator<Item = usize> + '_ {
        let places = &self.plant.places;
        let air = places.actuators.iter().flat_map(|here| [here.pressure, here.mass()]);
        air.chain(places.nodes.iter().flatten().copied())
    }

    /// Whether the polynomial of a step has air in every chamber and node: it lies within the hull of its control points.
    pub(super) fn holds_air(&self, arc: &Arc<R>) -> bool {
        self.places_of_air().all(|place| arc.all_points(place, |point| point > 0.0))
    }

    /// That a step has produced a physical state: numbers everywhere, air in every chamber and node, a length for every end on a
    /// tendon, braids that are not straight.
    pub(in super::super) fn check_step(&self, time: R, state: &[R]) -> Result<(), Error> {
        let lacks_air = |place: &usize| !(0.0 < state[*place].value() && state[*place].value() < MOST_AIR);
        let lacks_length = |place: &usize| state[*place].value() <= 0.0;
        let lost = state.iter().position(|number| !number.value().is_finite());
        let without = lost.or_else(|| self.places_of_air().find(lacks_air));
        let mut ends = self.plant.places.actuators.iter().filter_map(|its| its.length);
        if let Some(place) = without.or_else(|| ends.find(lacks_length)) {
            return Err(self.step_too_long(time, state, place));
        }
        let straight = self.wires.iter().find_map(|wire| {
            let length = state[wire.length_place()?];
            (length.value() >= wire.member.thread_length().value()).then_some(length)
        });
        straight.map_or(Ok(()), |length| Err(Self::straight(time, length)))
    }
}
