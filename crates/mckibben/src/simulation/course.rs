//! From one instant to the next: a load slides, turns, sticks, breaks away, falls slack and comes taut.
//!
//! With Coulomb friction the direction of sliding is held over a step, and so is the extent: slack, taut, or free, which is
//! between the limits of the length or beyond the longest without pull. Where the velocity has changed its sign by the end
//! of the step, friction can no longer hold a load at rest, or the length or the force of the taut braid has left the
//! extent, the point within the step where that first happens is searched for by the method's own step; the load then
//! turns, sticks or breaks away, or the extent changes, and the rest of the step follows.
//!
//! At rest the load sticks while its pull lies between the least and the largest tension that friction can hold,
//! `F_s + F_limit ± Q k_sec`, (12).
//!
//! A compressor that comes to one of its two pressures starts or stops there in the same way.
//!
//! Checked by `tests/fixed_step.rs`.

use super::kernel::{Held, Method, leaves_enough};
use super::piped::{OUTLET, PLAIN, RESERVOIR, Stepped, flow, of_rig, volume};
use super::rig::Rig;
use crate::force::Statics;
use crate::line::HoseKind;
use crate::load::Load;
use crate::root::Search;
use crate::scalar::{Mask, Real, Scalar};

/// What may cease to hold: the direction of sliding, the extent, whether the compressor runs.
pub(crate) const MARGINS: usize = 3;
const SLIDING: usize = 0;
const EXTENT: usize = 1;
const COMPRESSOR: usize = 2;
/// Parts of a step between two instants that may end at a turn before the rest is taken as it is.
const MAX_TURNS: usize = 4;
/// Parts of a step that takes more air than there is, at most.
const MOST_PARTS: u32 = 256;
/// Part of a step that the last look moves a turn by: what is left of its error is smaller by the errors of those before.
const TURN_TOLERANCE: f64 = 1e-5;
/// Part of a step that a load which starts from rest, or on a limit, moves before a turn is looked for.
const FROM_REST: f64 = 1e-3;
/// Looks after which a turn is taken to be where the last one was.
const MOST_LOOKS: usize = 60;

/// Where a rig is, and what it holds to until the next instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course<R: Real> {
    pub(crate) time: R::Time,
    pub(crate) state: Stepped<R>,
    pub(crate) held: Held<R>,
}

impl<R: Real> Course<R> {
    /// Goes on to `until` with the same passages open. The end of the whole step is given where it is known already.
    pub(crate) fn advance(&mut self, rig: &Rig<R>, method: Method, until: R::Time, mut end: Option<Stepped<R>>) {
        for _ in 0..MAX_TURNS {
            let Some(turn) = self.attempt(rig, method, until, end.take()) else { return };
            self.turn(rig, &turn);
        }
        self.arrive(rig, until, self.take(rig, method, self.step_to(until)));
        self.stretch(rig);
        if rig.keeps_compressor(&self.held, &self.state).lt(R::zero()) {
            self.held.compressor = !self.held.compressor;
        }
    }

    /// Takes the whole step, or says where in it something ceases to hold.
    fn attempt(&mut self, rig: &Rig<R>, method: Method, until: R::Time, end: Option<Stepped<R>>) -> Option<Turn<R>> {
        let step = self.step_to(until);
        let end = match end {
            Some(end) => self.tenable(rig, method, step, end),
            None => self.take(rig, method, step),
        };
        let ceases = rig.keeps(&self.held, &end).map(|keeps| keeps.lt(R::zero()));
        if R::zero().lt(step) && ceases.contains(&true) {
            return Some(self.locate(rig, method, step, end, ceases));
        }
        self.arrive(rig, until, end);
        None
    }

    fn arrive(&mut self, rig: &Rig<R>, until: R::Time, end: Stepped<R>) {
        self.state = end;
        rig.actuator().remember(&mut self.held.memory, end[0], end[1]);
        self.time = self.time.larger(until);
        if rig.load().inertia().is_none() {
            self.slide(rig);
        }
    }

    fn step_to(&self, until: R::Time) -> R {
        R::of_time((until - self.time).larger(R::Time::zero()))
    }

    fn take(&self, rig: &Rig<R>, method: Method, step: R) -> Stepped<R> {
        let end = rig.take(method, R::of_time(self.time), &self.state, step, &self.held);
        self.tenable(rig, method, step, end)
    }

    /// The end of a step, or of another where the stable method would take more air than there is: in as few parts as leave
    /// some. One does, unless so much heat comes in meanwhile that the pressure stays while the air goes.
    fn tenable(&self, rig: &Rig<R>, method: Method, step: R, end: Stepped<R>) -> Stepped<R> {
        if method == Method::Rk4 || rig.leaves_air(&self.state, &end) {
            return end;
        }
        let (mut parts, mut part) = (1, step);
        loop {
            let (mut state, mut time, mut leaves) = (self.state, R::of_time(self.time), true);
            for _ in 0..parts {
                let before = state;
                state = rig.take_firm(time, &before, part, &self.held);
                leaves = leaves && rig.leaves_air(&before, &state);
                time = time + part;
            }
            if leaves || parts == MOST_PARTS {
                return state;
            }
            (parts, part) = (2 * parts, R::constant(0.5) * part);
        }
    }

    /// Decides anew what follows an instant.
    pub(crate) fn enter(&mut self, rig: &Rig<R>) {
        // The velocity may have jumped.
        rig.actuator().remember(&mut self.held.memory, self.state[0], self.state[1]);
        self.slide(rig);
        self.stretch(rig);
    }

    /// Decides anew the extent where it does not hold.
    fn stretch(&mut self, rig: &Rig<R>) {
        if rig.keeps_extent(&self.held, &of_rig(&self.state)).lt(R::zero()) {
            let limits = rig.actuator().limits();
            let [length, velocity, ..] = self.state;
            self.held.slack = limits.is_slack(length);
            self.held.taut = !self.held.slack && R::zero().lt(limits.force(length, velocity));
        }
    }

    /// Decides anew how the load slides.
    fn slide(&mut self, rig: &Rig<R>) {
        (self.held.sliding, self.held.stuck) = rig.slides(&self.held, &of_rig(&self.state));
    }

    /// Goes to a turn and through it.
    fn turn(&mut self, rig: &Rig<R>, turn: &Turn<R>) {
        self.state = turn.state;
        rig.actuator().remember(&mut self.held.memory, self.state[0], self.state[1]);
        self.time = self.time + turn.part.to_time();
        if turn.what == COMPRESSOR {
            self.held.compressor = !self.held.compressor;
            return;
        }
        if turn.what == EXTENT {
            let limits = rig.actuator().limits();
            let middle = R::constant(0.5) * (limits.min_length() + limits.max_length());
            let (was_free, short) = (!(self.held.slack || self.held.taut), self.state[0].lt(middle));
            (self.held.slack, self.held.taut) = (was_free && short, was_free && !short);
            return;
        }
        let was_stuck = self.held.stuck;
        if !was_stuck {
            self.state[1] = R::zero();
        }
        self.slide(rig);
        // A load that broke away does not stick in the same instant, whatever the last rounding of the margin.
        if was_stuck
            && self.held.stuck
            && let Some(inertia) = rig.load().inertia()
        {
            let (least, most) = rig.held_tensions(&self.held, &of_rig(&self.state));
            let longer = (most - inertia.pull).lt(inertia.pull - least);
            self.held.sliding = R::select(longer, R::one(), -R::one());
            self.held.stuck = false;
        }
    }

    /// The point within a step where sliding or extent first ceases to hold.
    ///
    /// What holds at the end of the step is taken to hold throughout. Of two that do not, the one that is nil at the turn
    /// has ceased to hold first.
    ///
    /// Each look is a step of the method from the start.
    fn locate(&self, rig: &Rig<R>, method: Method, step: R, end: Stepped<R>, ceases: [bool; MARGINS]) -> Turn<R> {
        let margin = |state: &Stepped<R>| {
            let margins = rig.keeps(&self.held, state);
            let mut least = (R::constant(f64::INFINITY), SLIDING);
            for what in 0..MARGINS {
                if ceases[what] && margins[what].lt(least.0) {
                    least = (margins[what], what);
                }
            }
            least
        };
        let look = |theta: R| {
            let part = theta * step;
            let state = self.take(rig, method, part);
            let (value, what) = margin(&state);
            // What is not a number is beyond as well.
            (value, !R::zero().le(value), Turn { part, state, what })
        };
        let ((at_start, _), (at_end, what)) = (margin(&self.state), margin(&end));
        // From rest or from a limit the margin starts at zero, or a rounding below: look away from the start, and at the margin
        // over the part of the step, which has no root there.
        let from_rest = at_start.le(R::zero());
        let over = |theta: R, value: R| if from_rest { value / theta } else { value };
        let mut search = if from_rest {
            let theta = R::constant(FROM_REST);
            let (value, is_beyond, turn) = look(theta);
            if is_beyond {
                return turn;
            }
            Search::between([theta, over(theta, value)], at_end)
        } else {
            Search::between([R::zero(), at_start], at_end)
        };
        let mut turn = Turn { part: step, state: end, what };
        for _ in 0..MOST_LOOKS {
            let theta = search.proposal();
            let (value, is_beyond, of_look) = look(theta);
            turn = of_look;
            let is_nil = value.le(R::zero()) && R::zero().le(value);
            if is_nil || search.away(theta).le(R::constant(TURN_TOLERANCE)) {
                break;
            }
            search.learn([theta, over(theta, value)], is_beyond);
        }
        turn
    }
}

/// Where within a step something ceases to hold.
struct Turn<R> {
    /// How much of the step is taken up to there.
    part: R,
    state: Stepped<R>,
    /// Which of the margins ends.
    what: usize,
}

impl<S: Scalar, L: Statics<S>> Rig<S, L> {
    /// By how much the direction of sliding, the extent and the compressor's state hold, each negative where it has ceased to.
    #[inline(always)]
    pub(crate) fn keeps<const N: usize>(&self, held: &Held<S>, state: &Stepped<S, N>) -> [S; MARGINS] {
        let compressor = self.keeps_compressor(held, state);
        match self.load() {
            Load::Isometric => [S::constant(f64::INFINITY), S::constant(f64::INFINITY), compressor],
            _ => {
                let four = of_rig(state);
                [self.keeps_sliding(held, &four), self.keeps_extent(held, &four), compressor]
            }
        }
    }

    /// Negative in Pa where a compressor has come to the pressure at which it starts or stops.
    #[inline(always)]
    fn keeps_compressor<const N: usize>(&self, held: &Held<S>, state: &Stepped<S, N>) -> S {
        if N > PLAIN
            && let Some(supply) = &self.line().supply
            && let Some(reservoir) = supply.reservoir()
            && let Some([starts, stops]) = reservoir.switch_pressures()
        {
            let pressure = state[RESERVOIR];
            return S::select(held.compressor, stops - pressure, pressure - starts);
        }
        S::constant(f64::INFINITY)
    }

    /// The least and the largest tension in N that can be held at rest in a state.
    #[inline(always)]
    fn held_tensions(&self, held: &Held<S>, state: &[S; 4]) -> (S, S) {
        self.holdable(state[0], state[2], self.rubbing(state[0], state[1], held))
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
        let (least, most) = self.held_tensions(held, state);
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
    pub(crate) fn slides(&self, held: &Held<S>, state: &[S; 4]) -> (S, S::Mask) {
        let [length, velocity, ..] = *state;
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
        let (least, most) = self.held_tensions(held, state);
        let (longer, shorter) = (most.lt(inertia.pull), inertia.pull.lt(least));
        let slack = self.actuator().limits().is_slack(length);
        let falling = S::select(inertia.pull.lt(S::zero()), -S::one(), S::one());
        let when_slack = S::select(slack, falling, S::zero());
        let from_rest = S::select(longer, S::one(), S::select(shorter, -S::one(), when_slack));
        (S::select(at_rest, from_rest, by_velocity), at_rest & !(longer | shorter | slack))
    }

    /// Where a step from one state to another leaves pressure and air enough to be believed.
    #[inline(always)]
    pub(crate) fn leaves_air<const N: usize>(&self, from: &Stepped<S, N>, to: &Stepped<S, N>) -> S::Mask {
        let holds = leaves_enough([from[2], from[3]], [to[2], to[3]]);
        if N > PLAIN { holds & self.line_is_admissible(to) } else { holds }
    }

    /// Where the state is one that the laws hold for.
    #[expect(clippy::eq_op, reason = "what is not a number differs from itself")]
    #[inline(always)]
    pub(crate) fn admissible<const N: usize>(&self, state: &Stepped<S, N>) -> S::Mask {
        let [length, velocity, pressure, mass] = of_rig(state);
        let thread = self.actuator().law().law.end_length();
        // What is infinite or not a number makes the sum so, and that less itself is not zero.
        let sum = (length + velocity) + (pressure + mass);
        let holds = (sum - sum).le(S::zero()) & length.lt(thread) & S::zero().lt(pressure) & S::zero().lt(mass);
        if N > PLAIN { holds & self.line_is_admissible(state) } else { holds }
    }

    /// Where the pressures of the line are above zero and its flows finite.
    #[expect(clippy::eq_op, reason = "what is not a number differs from itself")]
    #[inline(always)]
    fn line_is_admissible<const N: usize>(&self, state: &Stepped<S, N>) -> S::Mask {
        let mut holds = S::Mask::splat(true);
        let line = self.line();
        if let Some(hose) = &line.hose {
            let inertia = hose.kind() != HoseKind::Lumped;
            for cell in 0..hose.cells() {
                let pressure = state[volume(cell)];
                let sum = if inertia { pressure + state[flow(cell)] } else { pressure };
                holds = holds & (sum - sum).le(S::zero()) & S::zero().lt(pressure);
            }
        }
        if let Some(supply) = &line.supply {
            let there = [supply.reservoir().is_some(), supply.regulator().is_some()];
            for (there, place) in there.into_iter().zip([RESERVOIR, OUTLET]) {
                if there {
                    let pressure = state[place];
                    holds = holds & (pressure - pressure).le(S::zero()) & S::zero().lt(pressure);
                }
            }
        }
        holds
    }
}
