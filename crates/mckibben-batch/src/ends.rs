//! What is watched of actuators on tendons, whose ends have no mass.
//!
//! | guard | quantity |
//! |---|---|
//! | the end comes to rest: with viscous friction | by how much the actuator's force outweighs the tendon's |
//! | without | the velocity of the end |
//! | the end breaks away | the tension of the tendon, conservatively |
//! | the taut braid lets go, or pulls again | the force of the taut braid |
//! | the tendon comes loose, or tight | its stretch |
//! | the end jumps | what holds it |

use crate::held::Held;
use crate::watch::{Range, holdable};
use crate::wide::Wide;
use mckibben::internals::{Evaluation, FASTEST, Formulas, System, tendon_tension};
use mckibben::plant::PlantMode;
use mckibben::scalar::{Mask, Work};
use mckibben::simulation::Guard;

/// The ranges of an end's quantities.
#[derive(Clone, Copy, Debug)]
struct EndRanges<W> {
    actuator: usize,
    excess: Range<W>,
    velocity: Range<W>,
    stretch: Range<W>,
    taut_force: Range<W>,
    /// Where friction holds it, and where it may jump; and whether any lane has such.
    held: W,
    jumps: W,
    is_held: bool,
    may_jump: bool,
    /// Whether any lane has a guard of it, and one for which flows have to be known.
    is_watched: bool,
    moves: bool,
}

/// The ranges of all ends in every lane.
#[derive(Clone, Debug)]
pub(crate) struct Ends<W> {
    ends: Vec<EndRanges<W>>,
}

/// Evaluates all of them, compiled once.
struct Hold<'a, W: Wide> {
    ends: &'a Ends<W>,
    system: &'a System<W>,
    time: W,
    end: &'a [W],
    held: &'a Held<W>,
    at: &'a mut Evaluation<W>,
}

impl<W: Wide> Ends<W> {
    /// Of a plant, before anything is watched.
    #[inline(always)]
    pub(crate) fn new(system: &System<W>) -> Self {
        let (all, zero) = (Range::all(), W::zero());
        let mut ends = Vec::new();
        for (actuator, mounted) in system.plant.actuators().iter().enumerate() {
            if mounted.tendon.is_some() {
                ends.push(EndRanges {
                    actuator,
                    excess: all,
                    velocity: all,
                    stretch: all,
                    taut_force: all,
                    held: zero,
                    jumps: zero,
                    is_held: false,
                    may_jump: false,
                    is_watched: false,
                    moves: false,
                });
            }
        }
        Self { ends }
    }

    /// Watches nothing of the row in a lane any more.
    pub(crate) fn leave(&mut self, lane: usize) {
        for its in &mut self.ends {
            for range in [&mut its.excess, &mut its.velocity, &mut its.stretch, &mut its.taut_force] {
                range.open(lane);
            }
            its.held.mark(lane, false);
            its.jumps.mark(lane, false);
        }
    }

    /// Enters a guard of an actuator in the mode of the row in a lane, or that it may jump; whether it is one of an end.
    pub(crate) fn enter(
        &mut self,
        lane: usize,
        system: &System<f64>,
        mode: &PlantMode,
        (i, guard): (usize, Option<Guard>),
    ) -> bool {
        let Some(its) = self.ends.iter_mut().find(|its| its.actuator == i) else { return false };
        let Some(tendon) = &system.plant.actuators()[i].tendon else { return false };
        let band = system.wires[i].member.force_band;
        let slack = system.stretch_band(i, tendon);
        match guard {
            None => its.jumps.mark(lane, true),
            Some(Guard::Rest) => {
                let is_longer = mode.direction(i) > 0.0;
                if mode.is_damped(system, i) {
                    its.excess.bound(lane, (if is_longer { band } else { -band }, !is_longer));
                } else {
                    let rest = system.rest_band(i);
                    its.velocity.bound(lane, (if is_longer { -rest } else { rest }, is_longer));
                }
            }
            Some(Guard::BreakLonger | Guard::BreakShorter) => its.held.mark(lane, true),
            Some(Guard::Rebound) => its.taut_force.above(lane, -band),
            Some(Guard::Retaut) => its.taut_force.below(lane, band),
            Some(Guard::TendonLoose) => its.stretch.above(lane, -slack),
            Some(Guard::TendonTight) => its.stretch.below(lane, slack),
            _ => return false,
        }
        true
    }

    /// Sums up what has been entered.
    pub(crate) fn update(&mut self) {
        for its in &mut self.ends {
            (its.is_held, its.may_jump) = (its.held.is_marked(), its.jumps.is_marked());
            its.moves = its.velocity.is_any() || its.taut_force.is_any() || its.may_jump;
            its.is_watched = its.moves || its.excess.is_any() || its.stretch.is_any() || its.is_held;
        }
    }

    /// Where every quantity is within its range at the end of a step.
    #[inline(always)]
    pub(crate) fn hold(
        &self,
        system: &System<W>,
        (time, end): (W, &[W]),
        held: &Held<W>,
        at: &mut Evaluation<W>,
    ) -> W::Mask {
        if self.ends.is_empty() {
            return W::Mask::splat(true);
        }
        W::apart(Hold { ends: self, system, time, end, held, at })
    }
}

impl<W: Wide> Work for Hold<'_, W> {
    type Output = W::Mask;

    #[inline(always)]
    fn done(self) -> W::Mask {
        let Self { ends, system, time, end, held, at } = self;
        let (mut within, zero) = (W::Mask::splat(true), W::zero());
        let mut moves = false;
        for its in &ends.ends {
            moves |= its.moves;
        }
        if moves {
            system.enter_air(time, end, held, at);
        }
        for its in &ends.ends {
            let i = its.actuator;
            let Some(tendon) = &system.plant.actuators()[i].tendon else { continue };
            if !its.is_watched {
                continue;
            }
            if !moves {
                system.enter_ends_of(i, time, end, held, at);
            }
            let (wire, unit, deflections) = (&system.wires[i], at.units[i], system.deflections(i, end));
            let pressure = end[wire.places.pressure];
            let pull = tendon_tension(tendon, held.is_loose(i), unit.distance, unit.length);
            let force = held.signed_force(wire, [unit.length, zero, pressure], deflections);
            within = within & its.excess.holds(force - pull);
            within = within & its.stretch.holds(unit.distance - unit.length - tendon.rest_length());
            if its.is_held {
                let (low, high) = holdable(system, i, end, held, at);
                let margin = W::constant(W::MARGIN) * (pull.magnitude() + high.magnitude());
                let is_held = (low + margin).le(pull) & pull.le(high - margin);
                within = within & (its.held.le(zero) | is_held);
            }
            if its.moves {
                let of_unit = (&at.units[i], &at.chambers[i]);
                let velocity = system.end_velocity(i, tendon, held, of_unit, deflections);
                let taut_force = wire.member.actuator.limits().taut_force(unit.length, velocity);
                within = within & its.velocity.holds(velocity) & its.taut_force.holds(taut_force);
                if its.may_jump {
                    let hold = system.hold_of_end(i, tendon, held, of_unit, deflections, FASTEST);
                    within = within & (its.jumps.le(zero) | zero.le(hold));
                }
            }
        }
        within
    }
}
