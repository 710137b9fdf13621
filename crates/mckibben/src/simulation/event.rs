//! Events: the one home of their rules, and their search on the dense output.
//!
//! # The contract
//!
//! 1. **Interval.** A mode lasts from the event that began it, excluded, to the event that ends it, included. A sample at
//!    the instant of an event shows what holds after it. An event at the final time is found, logged and crossed.
//! 2. **Side.** A guard is positive while its mode lasts. Which side is armed is the mode's knowledge; it is never read off
//!    the sign at the start, which is zero after every reset and may be off by a rounding.
//! 3. **Direction.** A guard fires where it comes down through zero and goes below. Touching zero and leaving again is none.
//! 4. **Re-arming.** A guard that starts at zero does not fire there. It fires at its next descent, even when that lies in
//!    the same first step: the search is on the whole polynomial of the step, not on the signs at its ends.
//! 5. **Ties.** Of several guards in one step the earliest is crossed, the step is cut there, and the search starts again
//!    in the new mode. Guards that fire in the same instant follow one by one, at the same time, in the order in which the
//!    mode lists them. An instant known in advance comes after a guard that fires at it.
//! 6. **Modes that last.** Where two formulas agree at their border (the pieces of the flow law, tension at zero), the
//!    mode is kept until the border is passed by the tolerance: rounding does not switch it, and the difference is below
//!    what the tolerance allows. A mass at rest sticks until the load exceeds what friction can hold by the same token.
//! 7. **Chatter.** A hundred events that do not advance time are an error that names the guard's quantity.
//!
//! The tolerance of rule 6 is the function `band` below; no law contains an epsilon.
//!
//! Checked by `tests/events.rs`, one test for each rule, and by the tests of the arc's polynomial.

use super::arc::{Arc, Bernstein, POINTS};
use super::system::{GuardForm, Guards, HybridSystem};
use crate::dual::Dual;
use crate::root;
use crate::scalar::{Differentiable, Real};

/// Events in a row without progress in time that are taken for chatter.
pub(crate) const MAX_EVENTS_IN_AN_INSTANT: u32 = 100;

/// The width by which a border between two agreeing formulas must be passed, relative to the quantity's magnitude.
///
/// It lies above the noise of a step that is controlled to `relative_tolerance`, and its effect is below it: the two
/// formulas differ by a fraction of the width there.
pub(crate) fn band(relative_tolerance: f64) -> f64 {
    relative_tolerance.max(1e-12)
}

/// A guard that fires within a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing<G, R> {
    pub(crate) guard: G,
    /// Where in the step, from 0 to 1.
    pub(crate) theta: R,
}

/// A guard has no value somewhere in a step: the step has left the physics, and a shorter one may not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoValue;

/// The first guard that fires on `arc`, if any.
pub(crate) fn first_crossing<R: Real, const N: usize, S: HybridSystem<R, N>>(
    system: &S,
    mode: &S::Mode,
    guards: &Guards<S::Guard>,
    arc: &Arc<R, N>,
) -> Result<Option<Crossing<S::Guard, R>>, NoValue> {
    if !arc.is_finite() {
        return Err(NoValue);
    }
    let mut first: Option<(S::Guard, f64)> = None;
    for (guard, form) in guards.iter() {
        let value_at = |theta: f64| value::<R, R, N, S>(system, mode, guard, arc, R::constant(theta)).value();
        let descent = match form {
            GuardForm::Above { index, bound } => arc.linear(index, bound, 1.0).first_descent(),
            GuardForm::Below { index, bound } => arc.linear(index, bound, -1.0).first_descent(),
            GuardForm::Function if is_far_from_zero(system, mode, guard, arc) => None,
            GuardForm::Function => descent_between(0.0, 1.0, MAX_HALVINGS, &value_at)?,
        };
        let Some((low, high)) = descent else { continue };
        let theta = root::bracketed(low, high, 1e-15, value_at).clamp(0.0, 1.0);
        if first.is_none_or(|(_, earlier)| theta < earlier) {
            first = Some((guard, theta));
        }
    }
    let differentiable = |(guard, theta)| Crossing { guard, theta: differentiable(system, mode, guard, arc, theta) };
    Ok(first.map(differentiable))
}

/// The place of a crossing with its derivatives, by the implicit function theorem; its value stays as it was found.
fn differentiable<R: Real, const N: usize, S: HybridSystem<R, N>>(
    system: &S,
    mode: &S::Mode,
    guard: S::Guard,
    arc: &Arc<R, N>,
    theta: f64,
) -> R {
    let place = R::constant(theta);
    let there: Dual<R, 1> = value(system, mode, guard, arc, Dual::variable(place, 0));
    if there.slope[0].value() == 0.0 {
        return place;
    }
    let shift = there.value / there.slope[0];
    place - (shift - R::constant(shift.value()))
}

fn value<R: Real, T: Differentiable<R>, const N: usize, S: HybridSystem<R, N>>(
    system: &S,
    mode: &S::Mode,
    guard: S::Guard,
    arc: &Arc<R, N>,
    theta: T,
) -> T {
    let time = T::of(arc.start) + theta * T::of(arc.step);
    system.guard(guard, time, &arc.at(theta), mode)
}

/// Whether a guard that is not linear in the state is far from zero over the whole step.
fn is_far_from_zero<R: Real, const N: usize, S: HybridSystem<R, N>>(
    system: &S,
    mode: &S::Mode,
    guard: S::Guard,
    arc: &Arc<R, N>,
) -> bool {
    // The guard at the control points varies at least about as much as on the curve between them.
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, point) in arc.points.iter().enumerate() {
        let time = arc.start + arc.step * R::constant(i as f64 / (POINTS - 1) as f64);
        let value = system.guard(guard, time, point, mode).value();
        least = least.min(value);
        most = most.max(value);
    }
    least > 0.5 * (most - least)
}

/// How often a step is halved in search of a descent that the polynomial of a guard shows and the guard has not.
const MAX_HALVINGS: u32 = 12;

/// Brackets the first descent of a guard that is not linear in the state, between two places in the step.
///
/// The guard is looked at as the polynomial through eight of its values. Where that shows a descent and the guard itself
/// is not below zero after it, the polynomial errs, and each half is looked at by itself.
fn descent_between(
    low: f64,
    high: f64,
    halvings: u32,
    value_at: &impl Fn(f64) -> f64,
) -> Result<Option<(f64, f64)>, NoValue> {
    let at = |part: f64| low + (high - low) * part;
    let values: [f64; POINTS] = core::array::from_fn(|i| value_at(at(i as f64 / (POINTS - 1) as f64)));
    if !values.iter().all(|value| value.is_finite()) {
        return Err(NoValue);
    }
    let Some((first, last)) = Bernstein::through(values).first_descent() else { return Ok(None) };
    if value_at(at(last)) < 0.0 {
        return Ok(Some((at(first), at(last))));
    }
    if halvings == 0 {
        return Ok((values[POINTS - 1] < 0.0).then_some((low, high)));
    }
    let middle = at(0.5);
    match descent_between(low, middle, halvings - 1, value_at)? {
        None => descent_between(middle, high, halvings - 1, value_at),
        found => Ok(found),
    }
}
