//! What a step knows exactly, in lanes: given motions and pressures, what sticks, and isothermal air.

use crate::held::Held;
use crate::wide::Wide;
use mckibben::internals::{Evaluation, Formulas, System};
use mckibben::mechanism::Mechanism;
use mckibben::scalar::Mask;

/// Sets given motions and pressures to what they are at a time in s.
#[inline(always)]
pub(crate) fn keep_given<W: Wide>(system: &System<W>, time: W, held: &Held<W>, end: &mut [W]) {
    let (plant, places) = (&system.plant, system.plant.indices());
    for (m, mechanism) in plant.mechanisms().iter().enumerate() {
        if let Mechanism::Prescribed(motion) = mechanism {
            let [length, velocity, _] = held.motion(m, motion, time);
            (end[places.mechanisms[m].position(0)], end[places.mechanisms[m].rate(0)]) = (length, velocity);
        }
    }
    for (node, place) in places.nodes.iter().enumerate() {
        if let (Some(place), Some([pressure, _])) = (place, held.flows().given(plant.network(), node, time)) {
            end[*place] = pressure;
        }
    }
    for wire in &system.wires {
        if let Some(pressure) = held.given_pressure(system, wire.index, time) {
            end[wire.places.pressure] = pressure;
        }
    }
}

/// Sets the rates of chains to where what sticks on them rests.
#[inline(always)]
pub(crate) fn keep_rates<W: Wide>(system: &System<W>, time: W, held: &Held<W>, at: &mut Evaluation<W>, end: &mut [W]) {
    for m in 0..system.assemblies.len() {
        if held.held_count(m) > 0 {
            system.enter_distances(time, end, held, at);
            system.hold_rates(m, end, held, at);
        }
    }
}

/// Sets the pressures of isothermal air, whose `P V/m` nothing changes.
#[inline(always)]
pub(crate) fn keep_contents<W: Wide>(
    system: &System<W>,
    time: W,
    contents: &[W],
    held: &Held<W>,
    at: &mut Evaluation<W>,
    end: &mut [W],
) {
    system.enter_distances(time, end, held, at);
    for (wire, content) in system.wires.iter().zip(contents) {
        let (place, volume) = (wire.places.pressure, at.chambers[wire.index].volume);
        let is_isothermal = W::zero().lt(*content);
        if held.is_given(wire.index) {
            let mass = end[place] * volume / *content;
            end[place + 1] = W::select(is_isothermal, mass, end[place + 1]);
        } else {
            let kept = *content * end[place + 1] / volume;
            end[place] = W::select(is_isothermal, kept, end[place]);
        }
    }
}

/// Keeps lanes where they are whose step has no length, since something is due where they begin: to find what is known exactly again
/// would change its last digits, and a scalar instance does not.
#[inline(always)]
pub(crate) fn stay<W: Wide>(length: W, state: &[W], end: &mut [W]) {
    let stays = length.le(W::zero());
    if !stays.any() {
        return;
    }
    for (end, state) in end.iter_mut().zip(state) {
        *end = W::select(stays, *state, *end);
    }
}
