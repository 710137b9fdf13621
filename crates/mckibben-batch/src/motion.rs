//! Ends that a host moves, in lanes.
//!
//! At the beginning of a move the rates of all ends jump, and each row would enter its mode again. Where an actuator is within
//! its lengths and pulls or does not pull as before, that is the mode that it has but for the way that it slides: such rows go on
//! in their lanes, and only the others enter theirs.
//!
//! | what the mode says | |
//! |---|---|
//! | free | stays where the distance lies within the lengths |
//! | kept from pushing | stays where the sum of the forces has the sign that it had |
//! | slides longer or shorter, or is held | the sign of the rate |
//!
//! Tendons and hysteresis that follows the length alone remember more than that: rows that have them enter their modes.

use crate::held::Held;
use crate::wide::Wide;
use mckibben::internals::{Evaluation, Formulas, System, host_mechanisms};
use mckibben::scalar::{Mask, Over};
use mckibben::{Dual, Response};

/// Part of the shortest length by which a distance must exceed it, or the row enters its mode.
const OFF_THE_STOP: f64 = 1e-12;

/// The ends that a host moves.
#[derive(Clone, Debug)]
pub(crate) struct HostEnds<W> {
    /// Where distance and rate of each coordinate stand among the states.
    pub(crate) places: Vec<[usize; 2]>,
    /// Where the ends go, in m.
    pub(crate) goals: Vec<W>,
    /// The actuators whose ends they are.
    members: Vec<usize>,
    /// Whether the mode of a row says all that it has to enter, and whether that holds for its answers as well: then all of its
    /// actuators are the host's.
    side_by_side: bool,
    all: bool,
}

impl<W: Wide> HostEnds<W> {
    /// Of a plant.
    #[inline(always)]
    pub(crate) fn new(system: &System<W>) -> Self {
        let plant = &system.plant;
        let (mut places, mut members, mut side_by_side) = (Vec::new(), Vec::new(), true);
        for (m, here) in host_mechanisms(plant) {
            for k in 0..here.coordinates {
                places.push([here.position(k), here.rate(k)]);
            }
            members.extend_from_slice(&plant.indices().members[m]);
        }
        for wire in &system.wires {
            let friction = wire.member.actuator.friction();
            let follows_length = friction.hysteresis().is_some() && friction.lugre().is_none();
            side_by_side &= wire.places.length.is_none() && !follows_length;
        }
        let all = side_by_side && members.len() == system.wires.len();
        Self { goals: vec![W::zero(); places.len()], places, members, side_by_side, all }
    }

    /// Where the mode of a row is the one that it would enter in a state whose distances and rates are those of the host, but for
    /// the way that its actuators slide; the masks have that way then.
    #[inline(always)]
    pub(crate) fn turn(
        &self,
        system: &System<W>,
        (time, state): (W, &[W]),
        held: &mut Held<W>,
        at: &mut Evaluation<W>,
    ) -> W::Mask {
        let mut keep = W::Mask::splat(self.side_by_side);
        if !self.side_by_side {
            return keep;
        }
        for [position, rate] in &self.places {
            keep = keep & state[*position].magnitude().le(W::constant(W::LARGEST));
            keep = keep & state[*rate].magnitude().le(W::constant(W::LARGEST));
        }
        for &i in &self.members {
            system.enter_ends_of(i, time, state, held, at);
            let (wire, unit) = (&system.wires[i], at.units[i]);
            let limits = wire.member.actuator.limits();
            let shortest = limits.min_length() * W::constant(1.0 + OFF_THE_STOP);
            keep = keep & shortest.lt(unit.distance) & unit.distance.lt(limits.max_length());
            keep = keep & held.turn(i, unit.rate);
            let ends = [unit.length, unit.velocity, state[wire.places.pressure]];
            let pushes = held.signed_force(wire, ends, system.deflections(i, state)).lt(W::zero());
            keep = keep & held.is_kept_from_pushing(i, pushes);
        }
        keep
    }

    /// Where that is so and lanes have all that a row answers.
    #[inline(always)]
    pub(crate) fn can_answer(
        &self,
        system: &System<W>,
        at_time: (W, &[W]),
        held: &mut Held<W>,
        at: &mut Evaluation<W>,
    ) -> W::Mask {
        match self.all {
            true => self.turn(system, at_time, held, at),
            false => W::Mask::splat(false),
        }
    }

    /// Enters the ways that the masks have, of the rows that go on in their lanes.
    #[inline(always)]
    pub(crate) fn enter_turns(&self, kept: W::Mask, held: &mut Held<W>) {
        for &i in &self.members {
            held.enter_turn(i, kept);
        }
    }

    /// Whether there are any.
    pub(crate) fn are_any(&self) -> bool {
        !self.places.is_empty()
    }

    /// Whether a state is the rate of an end, which stays as long as a move lasts.
    pub(crate) fn is_rate(&self, place: usize) -> bool {
        self.places.iter().any(|[_, rate]| *rate == place)
    }
}

/// What an actuator of an evaluated plant answers in every lane: as `PlantSteps::compute` has it.
#[inline(always)]
pub(crate) fn answer<W: Wide>(
    system: &System<W>,
    i: usize,
    state: &[W],
    held: &Held<W>,
    at: &Evaluation<W>,
) -> Response<W> {
    let (wire, unit, chamber) = (&system.wires[i], at.units[i], at.chambers[i]);
    let ([length, velocity, pressure], deflections) =
        ([unit.length, unit.velocity, chamber.pressure], system.deflections(i, state));
    let ends = [Dual::<W, 2>::variable(length, 0), Dual::variable(velocity, 1), Dual::of(pressure)];
    let air = [Dual::<W, 1>::of(length), Dual::of(velocity), Dual::variable(pressure, 0)];
    let [per_length, per_velocity] = held.tension(wire, ends, deflections.constant()).slope;
    let [per_pressure] = held.tension(wire, air, deflections.constant()).slope;
    Response {
        tension: unit.tension.larger(W::zero()),
        per_length,
        per_velocity,
        per_pressure,
        pressure_rate: unit.pressure_rate,
        mass_flow: unit.flow.net(),
        temperature: system.plant.actuators()[i].actuator.air().temperature(&chamber),
        volume: chamber.volume,
    }
}

/// A lane of answers.
pub(crate) fn of_lane<W: Wide>(answers: &Response<W>, lane: usize) -> Response {
    Response {
        tension: answers.tension.lane(lane),
        per_length: answers.per_length.lane(lane),
        per_velocity: answers.per_velocity.lane(lane),
        per_pressure: answers.per_pressure.lane(lane),
        pressure_rate: answers.pressure_rate.lane(lane),
        mass_flow: answers.mass_flow.lane(lane),
        temperature: answers.temperature.lane(lane),
        volume: answers.volume.lane(lane),
    }
}
