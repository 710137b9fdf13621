//! Events: the one home of their rules, and their search on the dense output.
//!
//! # The contract
//!
//! 1. **Interval.** A mode lasts from the event that began it, excluded, to the event that ends it, included. A sample at
//!    the instant of an event reports what holds after it. An event at the final time is found, logged and crossed.
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

use super::arc::{Arc, POINTS};
use super::bernstein::Bernstein;
use super::{GuardForm, Hybrid};
use crate::dual::Dual;
use crate::root;
use crate::scalar::Real;
use alloc::vec::Vec;

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

/// A guard has no value somewhere in a step: the step has left what is physical, and a shorter one may not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoValue;

/// Room for the search: a state, and evaluations over values and derivatives.
pub(crate) struct Room<'w, R: Real, S: Hybrid<R>> {
    pub(crate) state: &'w mut Vec<R>,
    /// The states at the places where each guard is looked at first, computed once for all guards of a step.
    pub(crate) nodes: &'w mut Vec<R>,
    pub(crate) work: &'w mut S::Work<R>,
    pub(crate) seeded: &'w mut Vec<Dual<R, 1>>,
    pub(crate) along: &'w mut S::Work<Dual<R, 1>>,
}

/// How often a step is halved in search of a descent that the polynomial of a guard shows and the guard has not.
const MAX_HALVINGS: u32 = 12;

/// The first guard that fires on `arc`, if any.
pub(crate) fn first<R: Real, S: Hybrid<R>>(
    system: &S,
    mode: &S::Mode,
    guards: &[(S::Guard, GuardForm<R>)],
    arc: &Arc<R>,
    room: Room<'_, R, S>,
) -> Result<Option<Crossing<S::Guard, R>>, NoValue> {
    let Room { state, nodes, work, seeded, along } = room;
    nodes.clear();
    let mut first: Option<(S::Guard, f64)> = None;
    for &(guard, form) in guards {
        let theta = match form {
            GuardForm::Above { index, bound } if arc.all_points(index, |point| point >= bound.value()) => None,
            GuardForm::Below { index, bound } if arc.all_points(index, |point| point <= bound.value()) => None,
            GuardForm::Above { index, bound } => linear_crossing(&arc.linear(index, bound.value(), 1.0)),
            GuardForm::Below { index, bound } => linear_crossing(&arc.linear(index, bound.value(), -1.0)),
            GuardForm::Function => {
                if is_far_from_zero(system, mode, guard, arc, work) {
                    continue;
                }
                let mut value_at = |theta: f64| {
                    let place = R::constant(theta);
                    let there = match node_at(theta) {
                        Some(node) => {
                            if nodes.is_empty() {
                                enter_nodes(arc, state.len(), nodes);
                            }
                            &nodes[node * state.len()..(node + 1) * state.len()]
                        }
                        None => {
                            arc.at(place, state);
                            &state[..]
                        }
                    };
                    system.guard(guard, arc.start + place * arc.step, there, mode, work).value()
                };
                let descent = descent_between(0.0, 1.0, MAX_HALVINGS, &mut value_at)?;
                // What begins to descend after the first crossing is not the first.
                let descent = descent.filter(|(low, _)| first.is_none_or(|(_, earlier)| *low < earlier));
                descent.map(|(low, high)| root::bracketed(low, high, 1e-15, value_at).clamp(0.0, 1.0))
            }
        };
        let Some(theta) = theta else { continue };
        if first.is_none_or(|(_, earlier)| theta < earlier) {
            first = Some((guard, theta));
        }
    }
    let Some((guard, theta)) = first else { return Ok(None) };
    // The place of the crossing with its derivatives, by the implicit function theorem; its value stays as it was found. Near rest
    // they are large, and where the rates are continuous what follows from them is rounding alone.
    let place = R::constant(theta);
    if !R::HAS_DERIVATIVES || system.is_smooth(guard) {
        return Ok(Some(Crossing { guard, theta: place }));
    }
    let theta = Dual::<R, 1>::variable(place, 0);
    let constant = |number: R| Dual::<R, 1> { value: number, slope: [R::zero()] };
    arc.at(theta, seeded);
    let there = system.guard(guard, constant(arc.start) + theta * constant(arc.step), seeded, mode, along);
    let slope = there.slope[0];
    if slope.value() == 0.0 {
        return Ok(Some(Crossing { guard, theta: place }));
    }
    let shift = there.value / slope;
    Ok(Some(Crossing { guard, theta: place - (shift - R::constant(shift.value())) }))
}

/// The place of the i-th of eight values of a guard over a step.
fn node(i: usize) -> f64 {
    i as f64 / (POINTS - 1) as f64
}

/// Which of the eight values a place is of, if it is.
fn node_at(theta: f64) -> Option<usize> {
    (0..POINTS).find(|i| node(*i) == theta)
}

/// Computes the states where guards are looked at first.
fn enter_nodes<R: Real>(arc: &Arc<R>, states: usize, nodes: &mut Vec<R>) {
    nodes.resize(POINTS * states, R::zero());
    for (i, state) in nodes.chunks_exact_mut(states).enumerate() {
        arc.at(R::constant(node(i)), state);
    }
}

/// Where a polynomial first goes below zero.
fn linear_crossing(polynomial: &Bernstein) -> Option<f64> {
    let (low, high) = polynomial.first_descent()?;
    Some(root::bracketed(low, high, 1e-15, |theta| polynomial.at(theta)).clamp(0.0, 1.0))
}

/// Whether a guard that is not linear in the state is far from zero over the whole step.
fn is_far_from_zero<R: Real, S: Hybrid<R>>(
    system: &S,
    mode: &S::Mode,
    guard: S::Guard,
    arc: &Arc<R>,
    work: &mut S::Work<R>,
) -> bool {
    // The guard at the control points varies at least about as much as on the curve between them. Four of them are enough
    // where it is twice as far.
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (count, i) in (1..).zip([0, 7, 2, 5, 1, 3, 4, 6]) {
        let time = arc.start + arc.step * R::constant(node(i));
        let value = system.guard(guard, time, arc.point(i), mode, work).value();
        least = least.min(value);
        most = most.max(value);
        let far = match count {
            4 => 1.0,
            POINTS => 0.5,
            _ => continue,
        };
        if least > far * (most - least) {
            return true;
        }
    }
    false
}

/// Brackets the first descent of a guard that is not linear in the state, between two places in the step.
///
/// The guard is taken as the polynomial through eight of its values. Where that shows a descent and the guard itself is not
/// below zero after it, the polynomial errs, and each half is searched separately.
fn descent_between(
    low: f64,
    high: f64,
    halvings: u32,
    value_at: &mut impl FnMut(f64) -> f64,
) -> Result<Option<(f64, f64)>, NoValue> {
    let at = |part: f64| low + (high - low) * part;
    let mut values = [0.0; POINTS];
    for (i, value) in values.iter_mut().enumerate() {
        *value = value_at(at(node(i)));
    }
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
