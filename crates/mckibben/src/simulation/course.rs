//! From one instant to the next, in any number of lanes: each slides, turns, sticks, breaks away, falls slack and comes
//! taut by itself.
//!
//! With Coulomb friction the direction of sliding is held over a step, and so is the extent: slack, taut, or free, which is
//! between the limits of the length or beyond the longest without pull. Where the velocity has changed its sign by the end
//! of the step, friction can no longer hold a load at rest, or the length or the force of the taut braid has left the
//! extent, the point within the step where that first happens is found by bracketed secants on the method's own step; the
//! load then turns, sticks or breaks away, or the extent changes, and the rest of the step follows. Lanes in which nothing
//! happens have arrived; lanes that turned go on.
//!
//! At rest the load sticks while its pull lies between the least and the largest tension that friction can hold,
//! `F_s + F_limit ± Q k_sec`, (12).
//!
//! Checked by `tests/fixed_step.rs` and `tests/batch.rs`.

use super::kernel::{Held, Method};
use super::rig::Rig;
use crate::load::Load;
use crate::scalar::{Mask, Scalar, Vector};

/// Parts of a step between two instants that may end at a turn before the rest is taken as it is.
const MAX_TURNS: usize = 4;
/// Part of a step to which a turn is located: the last secant before is closer than that, and each squares the error.
const TURN_TOLERANCE: f64 = 1e-9;
/// Part of a step that a load which starts from rest, or on a limit, moves before a turn is looked for.
const FROM_REST: f64 = 1e-3;
/// Secants and bisections after which a turn is taken where the bracket is.
const MAX_SECANTS: usize = 60;

/// How work is compiled: a kernel that is run by one of these uses its instructions throughout.
pub(crate) trait Instructions: Copy {
    /// Runs a kernel.
    fn run<K: Kernel>(self, kernel: K) -> K::Output;
}

/// Work that is worth a compilation of its own.
pub(crate) trait Kernel {
    /// What comes out of it.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}

/// The instructions that the whole program is compiled for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ordinary;

impl Instructions for Ordinary {
    #[inline(always)]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run()
    }
}

/// Where each lane is, and what it holds to until the next instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course<S: Vector> {
    pub(crate) time: S::Time,
    pub(crate) state: [S; 4],
    pub(crate) held: Held<S>,
}

impl<S: Vector> Course<S> {
    /// Goes on to `until` with the same passages open.
    #[inline(always)]
    pub(crate) fn advance(&mut self, instructions: impl Instructions, rig: &Rig<S>, method: Method, until: S::Time) {
        let may_turn = !matches!(rig.load(), Load::Isometric);
        let mut turns = 0;
        loop {
            let step = S::of_time((until - self.time).larger(S::Time::zero()));
            let end = instructions.run(Take { course: self, rig, method, step });
            if may_turn && turns < MAX_TURNS {
                let keeps = rig.keeps(&self.held, &end);
                let turned = keeps[0].smaller(keeps[1]).lt(S::zero()) & S::zero().lt(step);
                if turned.any() {
                    instructions.run(Turn { instructions, course: self, rig, method, until, step, end, keeps, turned });
                    turns += 1;
                    continue;
                }
            }
            self.state = end;
            self.time = self.time.larger(until);
            if turns == MAX_TURNS {
                self.stretch(rig, S::zero().lt(step));
            }
            break;
        }
        if rig.load().inertia().is_none() {
            self.slide(rig, S::Mask::splat(true));
        }
    }

    /// Decides anew what follows an instant in the lanes of `which`.
    #[inline(always)]
    pub(crate) fn enter(&mut self, rig: &Rig<S>, which: S::Mask) {
        self.slide(rig, which);
        self.stretch(rig, which);
    }

    /// Decides anew the extent in those lanes of `which` where it does not hold.
    #[inline(always)]
    fn stretch(&mut self, rig: &Rig<S>, which: S::Mask) {
        let limits = rig.actuator().limits();
        let [length, velocity, ..] = self.state;
        let left = which & rig.keeps_extent(&self.held, &self.state).lt(S::zero());
        let slack = limits.is_slack(length);
        let taut = !slack & S::zero().lt(limits.force(length, velocity));
        self.held.slack = chosen(left, slack, self.held.slack);
        self.held.taut = chosen(left, taut, self.held.taut);
    }

    /// Decides anew how the lanes of `which` slide.
    #[inline(always)]
    fn slide(&mut self, rig: &Rig<S>, which: S::Mask) {
        let (direction, stuck) = rig.slides(&self.state);
        self.held.sliding = S::select(which, direction, self.held.sliding);
        self.held.stuck = chosen(which, stuck, self.held.stuck);
    }

    /// Passes the limit of the length that ends the extent in the lanes of `which`.
    #[inline(always)]
    fn pass_limit(&mut self, rig: &Rig<S>, which: S::Mask) {
        let limits = rig.actuator().limits();
        let middle = S::constant(0.5) * (limits.min_length() + limits.max_length());
        let (was_free, short) = (!(self.held.slack | self.held.taut), self.state[0].lt(middle));
        self.held.slack = chosen(which, was_free & short, self.held.slack);
        self.held.taut = chosen(which, was_free & !short, self.held.taut);
    }
}

/// One or the other, lane by lane.
#[inline(always)]
fn chosen<M: Mask>(which: M, yes: M, no: M) -> M {
    (which & yes) | (!which & no)
}

/// One step of the method from where the lanes are.
struct Take<'a, S: Vector> {
    course: &'a Course<S>,
    rig: &'a Rig<S>,
    method: Method,
    step: S,
}

impl<S: Vector> Kernel for Take<'_, S> {
    type Output = [S; 4];

    #[inline(always)]
    fn run(self) -> [S; 4] {
        let Course { time, state, held } = self.course;
        self.rig.take(self.method, S::of_time(*time), state, self.step, held)
    }
}

/// The part of a step up to the turn in some lanes, and the whole step in the others.
struct Turn<'a, S: Vector, I> {
    instructions: I,
    course: &'a mut Course<S>,
    rig: &'a Rig<S>,
    method: Method,
    until: S::Time,
    step: S,
    end: [S; 4],
    /// By how much sliding and extent hold at the end.
    keeps: [S; 2],
    turned: S::Mask,
}

impl<S: Vector, I: Instructions> Kernel for Turn<'_, S, I> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let (part, at_turn, at_limit) = self.locate();
        let Self { course, rig, until, end, turned, .. } = self;
        let (at_rest, at_limit) = (turned & !at_limit, turned & at_limit);
        let was_stuck = course.held.stuck;
        for n in 0..4 {
            course.state[n] = S::select(turned, at_turn[n], end[n]);
        }
        course.state[1] = S::select(at_rest & !was_stuck, S::zero(), course.state[1]);
        let reached = course.time + part.to_time();
        course.time = S::Time::select(turned, reached, course.time.larger(until));
        course.pass_limit(rig, at_limit);
        course.slide(rig, at_rest);
        // A load that broke away does not stick in the same instant, whatever the last rounding of the margin.
        let broke = at_rest & was_stuck & course.held.stuck;
        if broke.any()
            && let Some(inertia) = rig.load().inertia()
        {
            let (least, most) = rig.holdable(course.state[0], course.state[2]);
            let longer = (most - inertia.pull).lt(inertia.pull - least);
            course.held.sliding = S::select(broke, S::select(longer, S::one(), -S::one()), course.held.sliding);
            course.held.stuck = course.held.stuck & !broke;
        }
    }
}

impl<S: Vector, I: Instructions> Turn<'_, S, I> {
    /// How much of the step is taken up to the turn, the state there, and where it is the extent that ends.
    ///
    /// What holds at the end of the step is taken to hold throughout. Of two that do not, the one that is nil at the turn
    /// has ceased to hold first.
    ///
    /// Secants with the older end's value halved when it stays twice (the Illinois rule), and a bisection now and then so
    /// that the bracket shrinks whatever the function.
    #[inline(always)]
    fn locate(&self) -> (S, [S; 4], S::Mask) {
        let Self { instructions, rig, method, step, end, turned, .. } = *self;
        let course = &*self.course;
        let tolerance = S::constant(TURN_TOLERANCE);
        let (mut low, mut high) = (S::zero(), S::one());
        let [sliding, extent] = self.ceasing(&rig.keeps(&course.held, &course.state));
        let mut at_low = sliding.smaller(extent);
        let [sliding, extent] = self.ceasing(&self.keeps);
        let mut at_high = sliding.smaller(extent);
        let (mut theta, mut at_turn, mut at_limit) = (S::one(), end, extent.lt(sliding));
        let mut open = turned;
        for count in 0..MAX_SECANTS {
            // From rest or from a limit the function starts at zero, or a rounding below: look away from the start.
            let from_rest = at_low.le(S::zero());
            let secant = (high - low).multiply_add(at_low / (at_low - at_high), low);
            let half = S::constant(0.5) * (low + high);
            let inside = if count % 4 == 3 { half } else { secant };
            let next = S::select(from_rest, S::constant(FROM_REST), inside);
            let state = instructions.run(Take { course, rig, method, step: next * step });
            let [sliding, extent] = self.ceasing(&rig.keeps(&course.held, &state));
            let value = sliding.smaller(extent);
            let is_beyond = value.lt(S::zero());
            let change = (next - theta).magnitude();
            theta = S::select(open, next, theta);
            at_limit = chosen(open, extent.lt(sliding), at_limit);
            for n in 0..4 {
                at_turn[n] = S::select(open, state[n], at_turn[n]);
            }
            let found = change.le(tolerance) | (value.le(S::zero()) & S::zero().le(value)) | (from_rest & is_beyond);
            open = open & !found;
            if !open.any() {
                break;
            }
            let halved = S::constant(0.5);
            (low, high) = (S::select(is_beyond, low, next), S::select(is_beyond, next, high));
            (at_low, at_high) = (
                S::select(is_beyond, S::select(from_rest, at_low, halved * at_low), value),
                S::select(is_beyond, value, halved * at_high),
            );
        }
        (theta * step, at_turn, at_limit)
    }

    /// By how much sliding and extent hold, as far as they do not hold at the end of the step.
    #[inline(always)]
    fn ceasing(&self, &[sliding, extent]: &[S; 2]) -> [S; 2] {
        let endless = S::constant(f64::INFINITY);
        [
            S::select(self.keeps[0].lt(S::zero()), sliding, endless),
            S::select(self.keeps[1].lt(S::zero()), extent, endless),
        ]
    }
}

impl<S: Scalar> Rig<S> {
    /// By how much the direction of sliding and the extent hold, each negative where it has ceased to.
    #[inline(always)]
    fn keeps(&self, held: &Held<S>, state: &[S; 4]) -> [S; 2] {
        [self.keeps_sliding(held, state), self.keeps_extent(held, state)]
    }

    /// Negative where the direction of sliding has ceased to hold: the velocity has turned, or the load broke away.
    #[inline(always)]
    fn keeps_sliding(&self, held: &Held<S>, state: &[S; 4]) -> S {
        let endless = S::constant(f64::INFINITY);
        let Some(inertia) = self.load().inertia() else { return endless };
        if !self.actuator().friction().has_coulomb() {
            return endless;
        }
        let along = held.sliding * state[1];
        if !held.stuck.any() {
            return along;
        }
        let (least, most) = self.holdable(state[0], state[2]);
        S::select(held.stuck, (most - inertia.pull).smaller(inertia.pull - least), along)
    }

    /// The force in N by which a state is within its extent, negative beyond: a length counts by the force that the taut
    /// braid would make of it.
    #[inline(always)]
    fn keeps_extent(&self, held: &Held<S>, state: &[S; 4]) -> S {
        let limits = self.actuator().limits();
        let [length, velocity, ..] = *state;
        let above = limits.stiffness() * (length - limits.min_length());
        let stretched = limits.stiffness() * (length - limits.max_length());
        let taut = stretched.smaller(limits.taut_force(length, velocity));
        S::select(held.slack, -above, S::select(held.taut, taut, above.smaller(-taut)))
    }

    /// The direction of sliding (−1, 0 or +1) at a state, and whether friction holds the load at rest.
    #[inline(always)]
    fn slides(&self, state: &[S; 4]) -> (S, S::Mask) {
        let [length, velocity, pressure, _] = *state;
        let nowhere = S::Mask::splat(false);
        if !self.actuator().friction().has_coulomb() {
            return (S::zero(), nowhere);
        }
        let by_velocity = velocity.sign();
        let Some(inertia) = self.load().inertia() else { return (by_velocity, nowhere) };
        let at_rest = velocity.le(S::zero()) & S::zero().le(velocity);
        if !at_rest.any() {
            return (by_velocity, nowhere);
        }
        let (least, most) = self.holdable(length, pressure);
        let (longer, shorter) = (most.lt(inertia.pull), inertia.pull.lt(least));
        let slack = self.actuator().limits().is_slack(length);
        let falling = S::select(inertia.pull.lt(S::zero()), -S::one(), S::one());
        let when_slack = S::select(slack, falling, S::zero());
        let from_rest = S::select(longer, S::one(), S::select(shorter, -S::one(), when_slack));
        (S::select(at_rest, from_rest, by_velocity), at_rest & !(longer | shorter | slack))
    }

    /// Where the state is one that the laws hold for.
    #[inline(always)]
    pub(crate) fn admissible(&self, state: &[S; 4]) -> S::Mask {
        let [length, velocity, pressure, mass] = *state;
        let thread = self.actuator().law().law.braid.thread_length();
        let numbers = length.lt(thread) & S::zero().lt(pressure) & S::zero().lt(mass);
        // What is not a number is not less than anything either.
        let infinity = S::constant(f64::INFINITY);
        numbers & (-infinity).lt(length) & velocity.magnitude().lt(infinity) & pressure.lt(infinity) & mass.lt(infinity)
    }
}
