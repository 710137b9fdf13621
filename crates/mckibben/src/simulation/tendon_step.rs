//! Fixed steps of a rig whose actuator pulls its load by an elastic tendon.
//!
//! ```text
//! M ẍ = W − T          T = k max(0, x − ℓ − L)          F(L, L̇, P) = T
//!
//! x⁺ = x + h v + h²/4 (a + a⁺)          v⁺ = v + h/2 (a + a⁺)          a⁺ = (W − T⁺)/M
//! F(L⁺, (L⁺ − L)/h, P⁺(L⁺)) = T⁺        for L⁺, with T⁺ = k max(0, x̂ − ℓ − L⁺)/(1 + k h²/4M)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | x, v, a | `distance`, `velocity`, `acceleration` of the load | m, m/s, m/s² |
//! | L, F, P | the actuator's length, force, pressure | m, N, Pa |
//! | W, M | pull and mass of the [`Load`](crate::load::Load) | N, kg |
//! | x̂ | where the load would be without the tension at the end | m |
//!
//! Nothing has a mass between actuator and tendon, so that the actuator's length follows from the balance of both tensions.
//! Each step searches for it, with the air, the seats and the memory of hysteresis taken along a straight line of the length
//! to there by the engine's own step. The load goes by the trapezoidal rule, which keeps the energy of a linear spring, at any
//! stiffness of the tendon; where the actuator has viscous friction its rate is that of the implicit Euler method, of order 1
//! in the step. Held ends are a load that does not move.
//!
//! Dry friction holds: while T lies between the least and the largest tension that can be held, the actuator stays where it
//! is, and on its shortest length it bears any. A step is divided where a seat moves; where the tendon comes loose or tight,
//! the braid taut, or the sliding turns, it is not.
//!
//! The search is for values; one step of Newton's carries the derivatives.
//!
//! Checked by `tests/tendon_rig.rs`: two springs in series, an independent integration, energy, sticking, flight, a stiff tendon.

use super::fixed_step::Walk;
use super::kernel::Method;
use super::rig::Rig;
use super::sample::Sample;
use super::timetable::Timetable;
use crate::error::Error;
use crate::load::{Inertia, Line, Load, Motion, SeriesTendon};
use crate::root;
use crate::scalar::Real;

/// Part of the actuator's length to which the balance is searched for, before the step of Newton's.
const SEARCHED: f64 = 1e-9;
/// Part of the actuator's length over which the slope for that step is taken.
const SLOPE: f64 = 1e-7;
/// Doublings of a step away from the last length within which the balance must lie.
const MOST_DOUBLINGS: u32 = 60;

/// The load at the far end of a tendon, and the actuator with its ends moved to where the tendon has them.
#[derive(Clone, Debug)]
pub(super) struct FarEnd<R> {
    guided: Rig<R>,
    tendon: SeriesTendon<R>,
    inertia: Option<Inertia<R>>,
    distance: R,
    velocity: R,
    tension: R,
}

impl<R: Real<Time = R>> FarEnd<R> {
    /// The far end of a rig that has a tendon, at the start of a walk: the load pulls with what can be held there, as far as
    /// it does. The walk's velocity becomes that of the load.
    pub(super) fn begin(rig: &Rig<R>, walk: &mut Walk<R>) -> Option<Self> {
        let (tendon, inertia) = (*rig.tendon()?, rig.load().inertia());
        let [length, velocity, pressure, ..] = walk.course.state;
        let guided = rig.clone().with_load_of(Load::Prescribed(Motion::Guided));
        let (least, most) = guided.holdable(length, pressure, guided.rubbing(length, R::zero(), &walk.course.held));
        let middle = R::constant(0.5) * (least + most);
        let tension = inertia.map_or(middle, |inertia| inertia.pull.larger(least).smaller(most));
        let distance = length + tendon.rest_length() + tension / tendon.stiffness();
        walk.course.state[1] = R::zero();
        walk.course.held.line = Line::resting(length);
        let velocity = if inertia.is_some() { velocity } else { R::zero() };
        Some(Self { guided, tendon, inertia, distance, velocity, tension })
    }

    /// The actuator's rig, whose ends somebody else moves.
    pub(super) fn guided(&self) -> &Rig<R> {
        &self.guided
    }

    /// The instants of that rig: those of its valve.
    pub(super) fn timetable(&self) -> Timetable<'_, R> {
        Timetable { actuation: self.guided.actuation(), motion: None, pressure: None }
    }

    /// A sample of the actuator with the tension of the tendon, and where the load is.
    pub(super) fn seen(&self, sample: Sample<R>) -> Sample<R> {
        Sample { tension: self.tension, load_distance: self.distance, load_velocity: self.velocity, ..sample }
    }

    /// Goes on to `until`, with a step to each instant of the valve up to then.
    pub(super) fn advance_to(&mut self, walk: &mut Walk<R>, method: Method, until: R) -> Result<(), Error> {
        while let Some(instant) = self.timetable().next(&walk.progress, until) {
            self.step_to(walk, method, instant.smaller(until))?;
        }
        self.step_to(walk, method, until)
    }

    fn step_to(&mut self, walk: &mut Walk<R>, method: Method, until: R) -> Result<(), Error> {
        let step = until - walk.course.time;
        if step.le(R::zero()) {
            return walk.advance_to(&self.guided, &self.timetable(), method, until, None);
        }
        let go = self.foreseen(step);
        let length = self.balance(walk, method, until, &go)?;
        *walk = self.taken(walk, method, until, length)?;
        self.tension = go.tension(length);
        if let Some(inertia) = self.inertia {
            let mean = R::constant(0.5) * (go.acceleration + (inertia.pull - self.tension) / inertia.mass);
            let half = R::constant(0.5) * step;
            self.distance = self.distance + step * (self.velocity + half * mean);
            self.velocity = self.velocity + step * mean;
        }
        Ok(())
    }

    /// Where the load goes in a step, as far as the length at its end does not matter.
    fn foreseen(&self, step: R) -> Foreseen<R> {
        let Self { tendon, inertia, distance, velocity, tension, .. } = self;
        let rest_length = tendon.rest_length();
        let Some(Inertia { mass, pull }) = *inertia else {
            let free = *distance - rest_length;
            return Foreseen { acceleration: R::zero(), free, stiffness: tendon.stiffness() };
        };
        let reach = R::constant(0.25) * step * step;
        let acceleration = (pull - *tension) / mass;
        let free = *distance + step * *velocity + reach * (acceleration + pull / mass) - rest_length;
        Foreseen { acceleration, free, stiffness: tendon.stiffness() / (R::one() + tendon.stiffness() * reach / mass) }
    }

    /// The actuator taken to a length in m at `until`.
    fn taken(&self, walk: &Walk<R>, method: Method, until: R, length: R) -> Result<Walk<R>, Error> {
        let mut walk = *walk;
        let course = &mut walk.course;
        let slope = (length - course.state[0]) / (until - course.time);
        course.held.line = Line { time: course.time, length: course.state[0], slope };
        course.state[1] = slope;
        course.enter(&self.guided);
        walk.advance_to(&self.guided, &self.timetable(), method, until, None)?;
        // Whatever the rounding of the line.
        walk.course.state[0] = length;
        Ok(walk)
    }

    /// By how much in N the actuator pulls harder than the tendon if it ends at a length in m; rises with the length.
    fn excess(&self, walk: &Walk<R>, method: Method, until: R, go: &Foreseen<R>, length: R) -> Result<R, Error> {
        let course = self.taken(walk, method, until, length)?.course;
        let (rig, [_, velocity, pressure, ..]) = (&self.guided, course.state);
        let actuator = rig.actuator();
        let taut = R::zero().lt(actuator.limits().force(length, velocity));
        let rubbing = rig.rubbing(length, velocity, &course.held);
        let factors = actuator.factors(length, pressure);
        Ok(actuator.signed_force([length, velocity, pressure], rubbing, taut, factors) - go.tension(length))
    }

    /// The length in m of the actuator at `until` at which both tensions are equal.
    fn balance(&self, walk: &Walk<R>, method: Method, until: R, go: &Foreseen<R>) -> Result<R, Error> {
        let (start, shortest) = (walk.course.state[0], self.guided.actuator().limits().min_length());
        if self.guided.actuator().friction().has_coulomb() {
            let stays = self.taken(walk, method, until, start)?.course;
            let rubbing = self.guided.rubbing(start, R::zero(), &stays.held);
            let (least, most) = self.guided.holdable(start, stays.state[2], rubbing);
            let pull = go.tension(start);
            if least.le(pull) && pull.le(most) && R::zero().lt(pull) {
                return Ok(start);
            }
        }
        let excess = |length: R| self.excess(walk, method, until, go, length);
        let at = |length: f64| excess(R::constant(length)).map(R::value);
        let (from, least) = (start.value(), shortest.value());
        let at_start = at(from)?;
        let (mut near, mut far) = (from, from);
        let mut reach = (at_start.abs() / go.stiffness.value()).max(SEARCHED * from);
        for _ in 0..MOST_DOUBLINGS {
            far = if at_start > 0.0 { (from - reach).max(least) } else { from + reach };
            match at(far) {
                // Where the braid would be pulled straight no tendon could hold it.
                Err(_) if at_start <= 0.0 => break,
                Err(error) => return Err(error),
                Ok(excess) if at_start > 0.0 && excess > 0.0 => {
                    // On its shortest length the actuator bears any pull.
                    if far <= least {
                        return Ok(shortest);
                    }
                    near = far;
                }
                Ok(excess) if at_start <= 0.0 && excess < 0.0 => near = far,
                Ok(_) => break,
            }
            reach *= 2.0;
        }
        let (low, high) = if near < far { (near, far) } else { (far, near) };
        let beyond = go.stiffness.value() * (high - low) + at_start.abs();
        let found = root::bracketed(low, high, SEARCHED * from, |length| at(length).unwrap_or(beyond));
        let there = R::constant(found);
        let value = excess(there)?;
        let slope = (at(found - SLOPE * from).map_or(value.value(), |below| value.value() - below)) / (SLOPE * from);
        let better = (there - value / R::constant(slope)).larger(shortest);
        // Not across a corner of the force.
        let moves = (better.value() - found).abs();
        Ok(if moves <= 4.0 * SEARCHED * from { better } else { there })
    }
}

/// What a step does to the load, but for the tension at its end.
struct Foreseen<R> {
    /// At its start in m/s².
    acceleration: R,
    /// `x̂ − ℓ` in m.
    free: R,
    /// Stiffness in N/m by which the tension at the end falls with the actuator's length.
    stiffness: R,
}

impl<R: Real> Foreseen<R> {
    /// Tension in N at the end, with the actuator at a length in m then.
    fn tension(&self, length: R) -> R {
        self.stiffness * (self.free - length).larger(R::zero())
    }
}
